#!/usr/bin/python3
"""-initial_state and probes: a run from a snapshot goes on, files by hand arrive where they should, wrong ones are
refused with what is wrong; B = I with any phi is the pure fluid; refusals of grids."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "scripts"), str(ROOT / "tests/support")]
sys.dont_write_bytecode = True
from eulastic import Run  # noqa: E402
from program import BINARY, launcher  # noqa: E402

GRID = "-grid_cells 24,20,1 -grid_length 1.2,1,1 -boundary_y wall -fluid_viscosity .05".split()
SOLID = "-species cell -cell_shear_modulus 1".split()
Z = (1, 20, 24)


class WithRoom(unittest.TestCase):
    def setUp(self):
        room = tempfile.TemporaryDirectory()
        self.addCleanup(room.cleanup)
        self.room = pathlib.Path(room.name)
        self.runs = 0

    def start(self, *options, ranks=1):
        self.runs += 1
        return subprocess.run([*launcher(ranks), BINARY, *options, "-output_dir", f"out{self.runs}"], cwd=self.room,
                              capture_output=True, text=True, timeout=120)

    def run_case(self, *options, ranks=1):
        done = self.start(*options, ranks=ranks)
        self.assertEqual(done.returncode, 0, done.stderr)
        return Run(self.room / f"out{self.runs}")

    def refused(self, *options, says, ranks=1):
        done = self.start(*options, ranks=ranks)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertEqual(done.stderr.count("eulastic: error:"), 1, done.stderr)
        for words in says:
            self.assertIn(words, done.stderr)
        self.assertFalse((self.room / f"out{self.runs}").exists())

    def file(self, name="state.h5", **datasets):
        with h5py.File(self.room / name, "w") as file:
            for dataset, values in datasets.items():
                file[dataset] = values
        return ["-initial_state", name]


class InitialState(WithRoom):
    def test_a_snapshot_is_read_back(self):
        for precision, tolerance in (("double", 0), ("single", 1e-6)):
            first = self.run_case(*GRID, *SOLID, "-cell_shape", "sphere", "-cell_radius", ".2", "-cell_centre",
                                  "1.15,.5,0", "-body_force", "1,0,0", "-time_end", ".1", "-snapshot_interval", ".1",
                                  "-snapshot_fields", "velocity,pressure,solid_fraction,body,left_cauchy_green",
                                  "-snapshot_precision", precision)
            again = self.run_case(*GRID, *SOLID, "-initial_state", str(first.snapshots[-1].path), "-time_end", "1e-9",
                                  "-snapshot_interval", "1", "-snapshot_precision", "double", "-snapshot_fields",
                                  "velocity,pressure,solid_fraction,body,left_cauchy_green", ranks=2)
            before, after = first.snapshots[-1], again.snapshots[0]
            for name in ("velocity_x", "pressure", "solid_fraction", "body"):
                numpy.testing.assert_allclose(after[name], before[name], atol=tolerance, err_msg=name)
            inside = before["solid_fraction"] > 0.99
            numpy.testing.assert_allclose(after["left_cauchy_green_xx"][inside],
                                          before["left_cauchy_green_xx"][inside], atol=tolerance)
            distance = again.bodies.centroid[0, 0, 0] - first.bodies.centroid[-1, 0, 0]  # begins in the box anew
            self.assertAlmostEqual(distance - 1.2 * round(distance / 1.2), 0, delta=1e-6)
            self.assertTrue(0 <= again.bodies.centroid[0, 0, 0] < 1.25)

    def test_without_body_series_a_solid_fraction_is_read_too(self):
        phi = numpy.zeros(Z)
        phi[:, 5:12, 4:20] = 1
        state = self.file(solid_fraction=phi)
        runs = [self.run_case(*GRID, *SOLID, *state, "-body_force", "1,0,0", "-time_end", ".05", "-body_series", series,
                              "-cell_contact", "merge", "-snapshot_interval", ".05", "-snapshot_precision", "double")
                for series in ("true", "false")]
        with_series, without = (run.snapshots[-1] for run in runs)
        for name in ("velocity_x", "solid_fraction"):
            numpy.testing.assert_array_equal(without[name], with_series[name])
        self.assertEqual(runs[1].summary["bodies"], [])

    def test_only_a_velocity_leaves_bodies_as_placed(self):
        u = numpy.broadcast_to(((numpy.arange(20) + 0.5) / 20)[:, None], Z).copy()
        run = self.run_case(*GRID, *SOLID, "-cell_shape", "sphere", "-cell_radius", ".2", *self.file(velocity_x=u),
                            "-time_end", "1e-9", "-snapshot_interval", "1", "-snapshot_precision", "double")
        numpy.testing.assert_array_equal(run.snapshots[0]["velocity_x"], u)
        self.assertAlmostEqual(run.summary["bodies"][0]["volume"], numpy.pi * 0.04, delta=1e-5)

    def test_a_membrane_is_placed_by_the_options_in_a_flow_of_a_file(self):
        u = numpy.broadcast_to(((numpy.arange(20) + 0.5) / 20)[:, None], Z).copy()
        membrane = ("-species cell -cell_shape sphere -cell_radius .3 -cell_law membrane -cell_surface_shear_modulus 1 -time_end 1e-9 "
                    "-snapshot_interval 1 -snapshot_precision double").split()
        run = self.run_case(*GRID, *membrane, *self.file(velocity_x=u))
        numpy.testing.assert_array_equal(run.snapshots[0]["velocity_x"], u)
        self.assertAlmostEqual(run.summary["bodies"][0]["volume"], numpy.pi * 0.09, delta=1e-4)
        self.refused(*GRID, *membrane, *self.file(solid_fraction=numpy.zeros(Z)), says=["state.h5", "shape at rest", "velocities"])
        del membrane[membrane.index("-cell_shape"):membrane.index("-cell_law")]
        self.refused(*GRID, *membrane, *self.file(velocity_x=u), says=["-cell_law", "-cell_shape sphere"])

    def test_two_bodies_of_a_file(self):
        phi, body = numpy.zeros(Z), numpy.zeros(Z, int)
        phi[0, 5:9, 5:9], phi[0, 12:16, 22:], phi[0, 12:16, :2] = 1, 1, 1  # the second across x = 0
        body[0, 5:9, 5:9], body[0, 12:16, 22:], body[0, 12:16, :2] = 1, 2, 2
        run = self.run_case(*GRID, *SOLID, *self.file(solid_fraction=phi, body=body), "-time_end", "1e-9")
        centroids = [b["centroid"] for b in run.summary["bodies"]]
        self.assertEqual(len(centroids), 2)
        numpy.testing.assert_allclose(numpy.array(centroids)[:, :2] % [1.2, 1], [[.35, .35], [0, .7]], atol=1e-9)

    def test_refusals(self):
        phi, nan = numpy.zeros(Z), numpy.zeros(Z)
        phi[0, 3, 4], nan[0, 2, 1] = 1.5, numpy.nan
        end = ["-time_end", "1"]
        for datasets, says in (({"velocity_x": numpy.zeros((1, 24, 20))}, ["velocity_x", "1 x 24 x 20", "1 x 20 x 24"]),
                               ({"vorticity": numpy.zeros(Z)}, ["unknown dataset vorticity", "velocity_x"]),
                               ({"solid_fraction": phi}, ["solid_fraction", "[0, 3, 4]", "1.5", "0 ... 1"]),
                               ({"velocity_y": nan}, ["velocity_y", "[0, 2, 1]", "finite"]),
                               ({"velocity_z": phi}, ["velocity_z", "2-D"]),
                               ({"velocity_x": numpy.zeros(Z)}, ["solid_fraction is missing", "-cell_shape"]),
                               ({"solid_fraction": 0 * phi, "left_cauchy_green_xx": 0 * phi}, ["positive"])):
            with self.subTest(sorted(datasets)):
                self.refused(*GRID, *SOLID, *end, *self.file(**datasets), says=["state.h5", *says])
        self.refused(*GRID, *SOLID, *end, *self.file(solid_fraction=phi), says=["[0, 3, 4]"], ranks=3)
        self.refused(*GRID, *end, *self.file(solid_fraction=0 * phi), says=["-species"])
        self.refused(*GRID, *end, "-initial_state", "none.h5", says=["none.h5", "not a file"])
        (self.room / "text.h5").write_text("text")
        self.refused(*GRID, *end, "-initial_state", "text.h5", says=["text.h5", "not an HDF5 file"])

    def test_a_strain_out_of_balance_relaxes_without_delay(self):
        # A box of solid sheared at rest, B_xy = k X cos ky: X'' + nu k^2 X' + (G/rho) k^2 X = 0 at any amplitude. Flow
        # and stress balance after a hundredth of mu/G; from then on X falls like exp(-G t/mu). A delay by 1.4 steps of
        # the usual size would leave .66 instead of .608.
        G, nu, n, k = 0.2, 1.0, 32, 2 * numpy.pi
        shear = 0.3 * numpy.cos(k * numpy.arange(n) / n)[:, None] * numpy.ones(4)  # edges are at y = j h
        centre = 1 + (0.3 * numpy.cos(k * (numpy.arange(n) + 0.5) / n)[:, None] * numpy.ones(4)) ** 2
        state = self.file(solid_fraction=numpy.ones((1, n, 4)), left_cauchy_green_xy=shear[None],
                          left_cauchy_green_xx=centre[None])
        run = self.run_case("-grid_cells", f"4,{n},1", "-grid_length", ".125,1,1", "-fluid_viscosity", str(nu), *state,
                            "-species", "gel", "-gel_shear_modulus", str(G), "-time_end", str(0.5 * nu / G),
                            "-snapshot_interval", str(0.5 * nu / G), "-snapshot_precision", "double",
                            "-snapshot_fields", "left_cauchy_green")
        fast, slow = numpy.roots([1, nu * k * k, G * k * k])
        t = run.snapshots[-1].time
        exact = (slow * numpy.exp(fast * t) - fast * numpy.exp(slow * t)) / (slow - fast)
        last = run.snapshots[-1]["left_cauchy_green_xy"][0, 0, 0] / 0.3
        self.assertAlmostEqual(last, exact, delta=0.006)

    def test_strained_slabs_pull_at_their_walls(self):
        for interval, wall, sign, rows in (("0,.5", "ymin", 1, 20), (".5,1", "ymax", -1, 20), (".5,1", "ymax", -1, 21)):
            with self.subTest(wall=wall, rows=rows):
                strain = self.file(left_cauchy_green_xy=numpy.full((1, rows, 24), 0.25))
                run = self.run_case(*GRID, "-species", "slab", "-slab_shape", "slab", "-slab_interval", interval,
                                    "-slab_shear_modulus", "2", *strain, "-time_end", "1e-9", "-snapshot_interval", "1")
                stress = run.snapshots[0]["wall_shear_stress_" + wall]
                numpy.testing.assert_allclose(stress[..., 0], sign * 0.5, rtol=1e-6)


class Scenes(WithRoom):
    BOX = ("-grid_cells 16,16,16 -grid_length 2,2,2 -boundary_y wall -time_step 1e-3 -time_steps_max 2 "
           "-time_end 1").split()

    def test_every_shape(self):
        volume = {"sphere -a_radius .5": numpy.pi / 6, "biconcave -a_diameter 1.6": 100.74 / 5 ** 3,
                  "ellipsoid -a_semi_axes .4,.5,.6 -a_orientation 0,0,30": 4 / 3 * numpy.pi * .12,
                  "cylinder -a_radius .5 -a_axis z": numpy.pi / 2, "slab -a_axis y -a_interval 0,.5": 2}
        for shape, expected in volume.items():
            with self.subTest(shape):
                run = self.run_case(*self.BOX, "-species", "a", "-a_shape", *shape.split(), "-a_shear_modulus", "1",
                                    "-a_initial_stretch", "1.1,1,.909090909090909")
                self.assertAlmostEqual(run.summary["bodies"][0]["volume"], expected, delta=2e-3 * expected)
                stretched = 0.5 * expected * (1.1 ** 2 + 1 / 1.1 ** 2 - 2)
                self.assertAlmostEqual(run.series.elastic_energy[0], stretched, delta=0.3 * stretched)

    def test_every_initial_flow(self):
        names = ("uniform taylor_green taylor_green_3d shear_layer couette poiseuille shear_wave_xy shear_wave_xz "
                 "shear_wave_yx shear_wave_yz shear_wave_zx shear_wave_zy random").split()
        for name in names:
            with self.subTest(name):
                takes = name not in ("uniform", "couette")
                run = self.run_case(*self.BOX, "-initial_velocity", name, "-initial_velocity_mean", "3,0,0",
                                    *(["-initial_velocity_amplitude", "0.5"] if takes else []))
                self.assertEqual(run.summary["exit_reason"], "steps")
                mean = 3 + 0.5 * {"poiseuille": 2 / 3, "shear_wave_xy": 2 / numpy.pi}.get(name, 0)
                self.assertAlmostEqual(run.series.bulk_velocity_x[0], mean, delta=0.01)

    def test_phase_of_a_wall(self):
        run = self.run_case(*self.BOX, "-boundary_ymax_velocity", "2,0,0", "-boundary_ymax_angular_frequency", "5", "-boundary_ymax_phase",
                            "0.7", "-probe_points", "1,2,1", "-series_interval", "1e-3")
        numpy.testing.assert_allclose(run.probes.velocity_x, 2 * numpy.cos(5 * run.probes.time + 0.7), atol=1e-12)


class Exact(WithRoom):
    def test_unstrained_marked_fluid_is_fluid(self):
        """S12: phi with G = 0 changes nothing; probes and profiles are the same on any ranks."""
        watch = ("-time_end .05 -body_force 1,.5,0 -initial_velocity random -probe_points .3,.2,0:0,1,0 "
                 "-profile_y mean -profile_x .5,0").split()
        disc = "-species cell -cell_shape sphere -cell_radius .2 -cell_shear_modulus 0".split()
        for method in ("classic", "fast"):
            fluid = self.run_case(*GRID, *watch, "-method", method)
            marked = self.run_case(*GRID, *watch, *disc, "-method", method, ranks=3)
            for name in ("time", "velocity_x", "velocity_y", "pressure"):
                for a, b in ((fluid.probes, marked.probes), (fluid.profile["y"], marked.profile["y"]),
                             (fluid.profile["x"], marked.profile["x"])):
                    numpy.testing.assert_array_equal(a[name], b[name], err_msg=f"{method} {name}")

    def test_double_shear_layer_only_loses_energy(self):
        """F7 at 64^2: monotone, and as in the spectral solution at t = .4 to what WENO5 dissipates."""
        for method in ("classic", "fast"):
            run = self.run_case(*("-grid_cells 64,64,1 -grid_length 1,1,1 -fluid_viscosity 1e-3 -initial_velocity "
                                  "shear_layer -time_end .4 -series_interval .02 -method").split(), method)
            energy = run.series.kinetic_energy
            self.assertTrue((numpy.diff(energy) < 0).all(), method)
            self.assertAlmostEqual(energy[-1], 0.4077905, delta=0.01)


class Grids(WithRoom):
    def test_refusals(self):
        end = ["-time_end", "1"]
        self.refused("-grid_cells", "2048,2048,2048", *end, says=["2147483647", "libpetsc64-real-dev"])
        self.refused("-grid_cells", "8,8,1", "-da_processors_y", "3", *end, ranks=3,
                     says=["3 ranks", "8 x 8 x 1", "0 x 3 x 0", "at least 3 cells"])
        self.refused("-grid_cells", "4,4,1", *end, ranks=2, says=["2 ranks", "4 x 4 x 1", "at least 3 cells"])
        self.refused("-grid_cells", "16,16,1", "-probe_points", "2,0,0", *end,
                     says=["-probe_points", "x = 2", "0 ... 1"])
        self.refused("-grid_cells", "16,16,1", "-probe_points", "2,0", *end, says=["-probe_points", "2 items"])
        self.refused("-grid_cells", "16,16,1", "-profile_z", "mean", *end, says=["-profile_z"])

    def test_processors_as_ordered(self):
        for order, ranks in ((["-da_processors_x", "2"], 2), (["-da_processors_y", "3", "-da_processors_x", "1"], 3)):
            run = self.run_case(*GRID, *order, "-time_end", "1e-9", "-initial_velocity", "random", ranks=ranks)
            self.assertEqual(run.summary["ranks"], ranks)


if __name__ == "__main__":
    unittest.main()
