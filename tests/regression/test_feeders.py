#!/usr/bin/python3
"""Stretches that feed inflow sides: bodies and flow that pass their end come in again."""
import pathlib
import subprocess
import sys
import unittest

import h5py
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
sys.dont_write_bytecode = True
from scene_case import BINARY, SceneCase  # noqa: E402
from eulastic import Run  # noqa: E402

CHANNEL = ("-boundary_y wall -boundary_xmin inflow -boundary_xmax outflow -boundary_xmin_velocity 1 -boundary_xmin_profile "
           "developed -initial_velocity poiseuille -initial_velocity_amplitude 1.5 -species disc -disc_shape sphere "
           "-interface_scheme plic -series_interval .05").split()
SOLID = "-disc_shear_modulus 4".split()
MEMBRANE = "-disc_law membrane -disc_surface_shear_modulus 2 -disc_viscosity 2".split()
TRAIN = [*CHANNEL, *("-grid_cells 216,32,1 -grid_length 6.75,1,1 -boundary_xmin_generator_length 2 -fluid_viscosity .5 -disc_radius .25 "
                     "-disc_centre .8,.4,0 -time_end 4").split()]
CROWD = [*CHANNEL, *SOLID, *("-grid_cells 96,32,1 -grid_length 6,2,1 -boundary_xmin_generator_length 3 -fluid_viscosity .2 -disc_radius .25 "
                     "-disc_placement random -disc_hematocrit .12 -disc_gap .3 -time_end 2.4").split()]
TUBE = ("-grid_cells 40,16,16 -grid_length 2.5,1,1 -boundary_xmin inflow -boundary_xmax pressure -boundary_xmin_profile developed "
        "-boundary_xmin_flow_rate .4 -boundary_xmin_generator_length 1.25 -species pipe,cell -pipe_shape tube -pipe_axis x -pipe_law rigid "
        "-pipe_radius .42 -pipe_centre 0,.513,.487 -cell_shape sphere -cell_radius .2 -cell_centre .8,.55,.5 "
        "-interface_scheme plic -fluid_viscosity .5 -time_end .8").split()
BALL = "-cell_shear_modulus 4".split()
CAPSULE = ("-cell_law membrane -cell_membrane_law skalak -cell_surface_shear_modulus .5 -cell_bending_modulus .01 "
           "-cell_viscosity 2.5").split()


class Feeders(SceneCase):
    def test_a_train_goes_on_where_it_came_in(self):
        """Each disc has the story of the one it was made like, a stretch behind: height and deformation. It keeps the volume."""
        for name, more in (("solid", SOLID), ("capsule", MEMBRANE)):
            with self.subTest(name):
                self.check_train(self.run_program(name, *TRAIN, *more).bodies)

    def check_train(self, bodies):
        self.assertGreaterEqual(len(bodies.id), 3)
        self.assertEqual(list(bodies.id), list(range(1, len(bodies.id) + 1)))
        there = bodies.volume > 0
        self.assertEqual(list(there[0]), [True] + [False] * (len(bodies.id) - 1))
        self.assertTrue(numpy.isnan(bodies.centroid[~there & (numpy.cumsum(there, 0) == 0)]).all())
        volume = bodies.volume[there]
        self.assertLess(volume.max() / volume.min() - 1, 1e-5)
        places = numpy.array([1.2, 2, 2.6])

        def story(body, values, shift):
            ok = there[:, body]
            return numpy.interp(places + shift, bodies.centroid[ok, body, 0], values[ok, body])

        for values, bound in ((bodies.centroid[:, :, 1], .004), (bodies.taylor_deformation, .012)):
            difference = abs(story(1, values, 0) - story(0, values, 2))
            print(f"    {difference.max():.4f}")
            self.assertLess(difference.max(), bound)
        self.assertGreater(story(0, bodies.taylor_deformation, 2)[0], .1, "there is something to hand on")

    def test_the_stretch_stays_as_full_as_it_was(self):
        run = self.run_program("crowd", *CROWD)
        bodies = run.bodies
        within = ((bodies.volume > 0) & (bodies.centroid[:, :, 0] < 3)).sum(axis=1)
        self.assertGreater(len(bodies.id), (bodies.volume[0] > 0).sum() + 3)
        self.assertLessEqual(abs(within[len(within) // 2:].mean() / within[0] - 1), .25)
        self.assertLess(abs(run.series.flow_rate_xmin - 2).max(), 1e-9)
        self.assertLess(abs(run.series.flow_rate_xmin + run.series.flow_rate_xmax).max(), 1e-5)

    def test_same_on_any_ranks_and_threads_and_after_a_restart(self):
        scenes = {"crowd": (CROWD, 4), "ball": ([*TUBE, *BALL], 3), "capsule": ([*TUBE, *CAPSULE], 2)}
        whole = self.run_together({name: (scene, {}) for name, (scene, _) in scenes.items()})
        others = {}
        for name, (scene, ranks) in scenes.items():
            others[f"{name}_ranks"] = scene, {"ranks": ranks}
            others[f"{name}_threads"] = [*scene, "-threads", "2"], {}
            others[f"{name}_half"] = [*scene, "-time_steps_max", whole[name].summary["steps"] * 2 // 3], {}
        others = self.run_together(others)
        for name, (scene, ranks) in scenes.items():
            one, half = whole[name], self.room / f"{name}_half"
            self.assertGreater(len(one.bodies.id), (one.bodies.volume[0] > 0).sum())
            for way in ("ranks", "threads"):
                self.assertEqual(others[f"{name}_{way}"].summary["state_hash"], one.summary["state_hash"], (name, way))
            done = subprocess.run([BINARY, half / "options.txt", "-restart", half, "-output_dir", half, "-time_steps_max", "0"],
                                  capture_output=True, text=True, timeout=300)
            self.assertEqual(done.returncode, 0, done.stderr)
            rest = Run(half)
            self.assertEqual(rest.summary["state_hash"], one.summary["state_hash"])
            self.assertEqual((half / "series.csv").read_text(), (one.directory / "series.csv").read_text())
            for column in ("centroid", "volume", "taylor_deformation"):
                self.assertTrue(numpy.array_equal(getattr(rest.bodies, column), getattr(one.bodies, column),
                                                  equal_nan=True), column)

    def test_flow_is_developed(self):
        """A pulse that comes in with the profile of a steady flow is not that of a channel; fed, it is, all along."""
        scene = ("-grid_cells 64,32,1 -grid_length 2,1,1 -boundary_y wall -boundary_xmin inflow -boundary_xmax outflow "
                 "-boundary_xmin_velocity 1 -boundary_xmin_profile developed -boundary_xmin_angular_frequency 6.283185307179586 "
                 "-fluid_viscosity .05 -time_end 2 -time_step .01 -pressure_solver smac -snapshot_interval 2 "
                 "-snapshot_precision double").split()
        difference = {}
        for length in ("0", "1"):
            run = self.run_program(f"pulse{length}", *scene, "-boundary_xmin_generator_length", length)
            with h5py.File(run.directory / "snapshot_000001.h5") as file:
                u = file["velocity_x"][0]
            difference[length] = abs(u[:, :40] - u[:, 40:41]).max()
        print(f"    {difference['0']:.4f} {difference['1']:.4f}")
        self.assertGreater(difference["0"], .1)
        self.assertLess(difference["1"], .006)

    def test_refusals(self):
        narrow = ("-species vessel -vessel_shape constricted_tube -vessel_axis x -vessel_law rigid -vessel_radius .4 "
                  "-vessel_throat_radius .2 -vessel_throat_length .5 -vessel_centre .6,.5,.5").split()
        flat = [*CHANNEL, *SOLID, "-grid_cells", "64,32,1", "-grid_length", "2,1,1", "-disc_radius", ".2", "-time_end", "1"]
        deep = [*TUBE[:TUBE.index("-species")], *narrow, "-time_end", "1"]
        for says, options in (
                ("2 is 64 cells; accepted: from 8 to 56", [*flat, "-boundary_xmin_generator_length", "2"]),
                ("0.52 is 16.64 cells; accepted: a whole number", [*flat, "-boundary_xmin_generator_length", ".52"]),
                ("bodies that enter must be labelled", [*flat, "-boundary_xmin_generator_length", "1", "-body_series", "false"]),
                ("-boundary_xmin_generator_length: the lumen changes along the inlet generator", deep),
                ("-boundary_xmax inflow", [*flat, "-boundary_xmax_generator_length", "1"])):
            done = subprocess.run([BINARY, *options, "-output_dir", self.room / "refused"], capture_output=True, text=True,
                                  timeout=60)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(says, done.stderr)
            self.assertFalse((self.room / "refused").exists())


if __name__ == "__main__":
    unittest.main()
