#!/usr/bin/python3
"""Files that were made to harm: checkpoints whose checksums are right and whose numbers are not, FIFOs, endless files, options
that bring in one another, names that break a terminal, and PETSc's output over a file that is there.

Needs EULASTIC and EULASTIC_MPIEXEC.
"""
import os
import pathlib
import sys
import unittest

import h5py
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from checksum import change, checksum, content  # noqa: E402
from restart_case import FLAT, Restart  # noqa: E402

FEEDER = ("-grid_cells 48,24,1 -grid_length 3,1.5,1 -boundary_y wall -boundary_xmin inflow -boundary_xmax pressure "
          "-boundary_xmin_velocity 1 -boundary_xmin_profile developed -boundary_xmin_generator_length 1.5 -fluid_viscosity .1 -species a "
          "-a_shape sphere -a_radius .2 -a_law membrane -a_surface_shear_modulus .1 -a_placement random -a_count 2 "
          "-initial_velocity_mean 1,0,0 -guard_volume_drift 0 -time_end 100").split()

BOXES = ("-grid_cells 20,16,1 -grid_length 5,4,1 -boundary_y wall -fluid_viscosity .3 -body_force .1,0,0 -species cell "
         "-cell_shape sphere -cell_radius .6 -cell_shear_modulus 1 -cell_placement lattice -cell_count 2,1,1 -time_end 100").split()


class Numbers(Restart):
    def refuse_changed(self, case, path, name, index, value, says=None):
        good = path.read_bytes()

        def put(data):
            data.reshape(-1)[index] = value
            return data
        change(path, name, put)
        with self.subTest(name, index=index, value=value):
            self.refused(*case, "-restart", path, "-output_dir", "new", says=["-restart", says or name, "accepted"])
            self.assertFalse((self.room / "new").exists())
        path.write_bytes(good)

    def test_of_a_run(self):
        case = [*FLAT, "-time_steps_max", 9]
        self.run_case("run", *FLAT, "-time_steps_max", 4)
        path = self.checkpoints()[0]
        with h5py.File(path) as file:
            self.assertEqual(int(file["time"].attrs["checksum"], 16), checksum(file["time"][...]))
            self.assertEqual(int(file.attrs["content"], 16), content(file))
        nan, inf = numpy.nan, numpy.inf
        for name, index, value in (("time", 0, nan), ("time", 0, -1.), ("time", 0, inf), ("time_step", 0, nan), ("time_step", 0, 1e300),
                                   ("time_step", 0, -1e-3), ("time_step", 1, inf), ("time_step", 1, -1.), ("step", 0, -4),
                                   ("step", 0, 1 << 62), ("output_rows", 0, -1), ("output_rows", 2, 1 << 60), ("flow_scales", 0, nan),
                                   ("energy_budget", 1, inf), ("energy_made", 0, nan), ("mach_max", 0, -1.), ("wall_seconds", 0, -1.),
                                   ("stages_and_sweeps", 0, -5), ("output_times", 0, nan)):
            self.refuse_changed(case, path, name, index, value)
        self.refuse_changed(case, path, "bodies.references", 0, 1 << 40, says="cell of a body")
        self.refuse_changed(case, path, "bodies.first_volumes", 0, nan, says="first volume")
        self.refuse_changed(case, path, "bodies.first_volumes", 1, -1., says="first volume")

    def test_of_bodies_that_come_in(self):
        self.run_case("run", *FEEDER, "-time_steps_max", 4)
        path = self.checkpoints()[0]
        case = [*FEEDER, "-time_steps_max", 6]
        for value in (-1, 2, 1 << 40):
            self.refuse_changed(case, path, "bodies_in_feeders", 0, value)

    def test_of_markers_on_the_grid(self):
        case = [*MEMBRANE, "-time_steps_max", 6]
        self.run_case("run", *MEMBRANE, "-time_steps_max", 4)
        path = self.checkpoints()[0]
        for name in ("nan", "cell", "label", "phase"):
            index, value = {"nan": 7, "cell": 3, "label": 1, "phase": 2}[name], {"nan": numpy.nan, "cell": 1e9, "label": 77., "phase": -1.}[name]
            self.refuse_changed(case, path, "membrane_markers", index, value)

    def test_of_bodies_in_boxes(self):
        self.run_case("run", *BOXES, "-time_steps_max", 4)
        path = self.checkpoints()[0]
        # Of each body: its number, its species, where its box begins, how long that is, and how many markers there are.
        for index, value in ((0, 0.), (0, 3.), (9, 1.), (1, 1.), (1, -1.), (2, .5), (3, -1.), (3, numpy.nan), (4, 1.), (5, 0.), (6, 1e6), (7, 2.),
                             (8, -1.), (8, 1e6)):
            self.refuse_changed([*BOXES, "-time_steps_max", 6], path, "bodies_in_boxes", index, value)

    def test_of_receptors_in_boxes(self):
        case = [*BOXES, *("-adhesion cell-wall -adhesion_cell_wall_density 9 -adhesion_cell_wall_reach .5 -adhesion_cell_wall_rate_on 9 "
                          "-adhesion_cell_wall_rate_off 1 -adhesion_cell_wall_bond_stiffness .01").split()]
        self.run_case("run", *case, "-time_steps_max", 4)
        case += ["-time_steps_max", 6]
        for value in (-1., .5, numpy.nan, 1e12):
            self.refuse_changed(case, self.checkpoints()[0], "receptors_in_boxes", 0, value)
        # The last receptor: its place, its partner, the receptor of that, the pair.
        for part, value in ((0, numpy.nan), (3, 1e3), (3, -2.), (4, -1.), (5, 1.), (8, numpy.inf)):
            self.refuse_changed(case, self.checkpoints()[0], "values_in_boxes", part - 10, value, says="receptors_in_boxes")

    def test_of_markers_in_boxes(self):
        case = [*BOXES[:BOXES.index("-cell_shear_modulus")], *BOXES[BOXES.index("-cell_shear_modulus") + 2:],
                *"-cell_law membrane -cell_surface_shear_modulus .2".split()]
        self.run_case("run", *case, "-time_steps_max", 4)
        # The last marker: its number, label, phase, cell and place in it.
        for part, value in ((0, -1.), (1, 7.), (2, 4.), (3, 1e3), (4, -1e9), (6, 2.), (9, numpy.nan)):
            self.refuse_changed([*case, "-time_steps_max", 6], self.checkpoints()[0], "values_in_boxes", part - 21, value,
                                says="membrane_markers")


MEMBRANE = ("-grid_cells 16,16,1 -grid_length 2,2,1 -boundary_xmin pressure -boundary_xmax pressure -boundary_xmax_windkessel 1,.1,2 "
            "-boundary_y wall -fluid_viscosity .5 -body_force 1,0,0 -species a,b -a_shape sphere -a_radius .4 -a_centre .9,1.2,0 "
            "-a_law membrane -a_surface_shear_modulus .1 -b_shape sphere -b_radius .3 -b_centre 1.3,.4,0 -b_shear_modulus 1 "
            "-b_viscosity 1 -time_end 100 -time_step .01 -guard_volume_drift 0").split()
# What a run has beside the state: clocks, counts, and what has been written of it.
BESIDE = {"options", "wall_seconds", "output_times", "output_rows", "energy_budget", "energy_made", "energy_largest", "mach_max", "stages_and_sweeps"}


class EveryDataset(Restart):
    """A change of one dataset changes the hash of the state that goes on; of what is beside the state, it is refused."""

    def check(self, case, expected, others=True):
        steps = ["-time_steps_max", 4]
        self.run_case("run", *case, *steps)
        path = self.checkpoints()[0]
        again = [*case, *steps, "-restart", path, "-output_dir", "new", "-output_overwrite"]
        good, whole = path.read_bytes(), self.summary("run")["state_hash"]

        def hash_of():
            result = self.call(*again)
            if result.returncode == 2:  # out of range
                self.assertRegex(result.stderr, r"\Aeulastic: error: -(restart|time_steps_max): [^\n]+\n\Z")
                return "refused"
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            return self.summary("new")["state_hash"]

        def flip(data):
            """The last bit of all reals that are not 0, or of the last integer: some are found anew at a restart, not all."""
            words = data.reshape(-1).view(f"u{data.dtype.itemsize}")
            held = numpy.flatnonzero(words) if words.any() else numpy.array([0])
            words[held if data.dtype.kind == "f" else held[-1:]] ^= words.dtype.type(1)
            return data
        self.assertEqual(hash_of(), whole)
        with h5py.File(path) as file:
            names = list(file)
        self.assertEqual(expected - set(names), set())
        for name in names if others else expected:
            path.write_bytes(good)
            with self.subTest(name):
                change(path, name, flip, whole=name not in BESIDE)
                if name in BESIDE:
                    self.refused(*again, says=["-restart", path.name, "damaged"])
                else:
                    self.assertNotEqual(hash_of(), whole)

    def test_of_bodies_in_a_flow(self):
        self.check(FLAT, {"velocity_y", "pressure", "advection_x", "pressure_increment_0", "left_cauchy_green_xy_cell", "body_bead", "time",
                          "step", "time_step", "flow_scales", "bodies.references", "bodies.first_volumes"} | BESIDE)

    def test_of_bodies_in_boxes(self):
        self.check(BOXES, {"bodies_in_boxes", "values_in_boxes"}, others=False)

    def test_of_membranes_viscosities_and_a_load(self):
        self.check(MEMBRANE, {"membrane_markers", "pressure_before", "pressure_interval", "outlet_loads", "left_cauchy_green_xx_a"}, others=False)

    def test_of_bodies_that_come_in(self):
        self.check([*FEEDER, "-time_step", ".01"], {"bodies_in_feeders"}, others=False)


class Files(Restart):
    def test_no_regular_file(self):
        fifo = self.room / "fifo"
        os.mkfifo(fifo)
        scene = [word for word in FLAT if not word.startswith("none")]
        for path in (fifo, "/dev/zero"):
            self.refused(path, says=[str(path), "regular file"])
            self.refused(*scene, "-initial_state", path, says=["-initial_state"])
            self.refused(*scene, "-restart", path, says=["-restart"])
            self.refused(*FEEDER[:FEEDER.index("-boundary_xmin_velocity") + 1], path, *FEEDER[FEEDER.index("-boundary_xmin_velocity") + 2:],
                         says=["-boundary_xmin_velocity"])
        (self.room / "include.opts").write_text("-options_file fifo\n")
        self.refused(self.room / "include.opts", says=["fifo", "regular file"])

    def test_options_that_bring_in_one_another(self):
        for n in range(12):
            (self.room / f"{n}.opts").write_text(f"-options_file {n + 1}.opts\n" * 12)
        (self.room / "12.opts").write_text("-fluid_density 1\n")
        self.refused(self.room / "0.opts", says=["-options_file", "depth"])
        for n in (5, 10):  # 12^7 files, and 12^2
            self.refused(self.room / f"{n}.opts", says=["-options_file", "in all"])

    def test_messages_are_one_printable_line(self):
        for name in ("\x1b]0;title\x07\x1b[2J", "a\nb", "x" * 5000, "\x9b31m", "\u202e" + "y" * 3000):
            for words in ((name,), (*FLAT, "-" + name, "1"), (*FLAT, "-cell_radius", name), (*FLAT, "-restart", name)):
                result = self.call(*words)
                self.assertEqual(result.returncode, 2)
                self.assertRegex(result.stderr, r"\Aeulastic: error: [^\n]+\n\Z")
                self.assertFalse([c for c in result.stderr[:-1] if ord(c) < 32 or 127 <= ord(c) < 160], result.stderr)
                self.assertLess(len(result.stderr), 1100)

    def test_endless_snapshots(self):
        case = [*FLAT[:-4], "-time_end", ".2", "-snapshot_times", "exact", "-snapshot_interval"]
        self.refused(*case, "1e-300", says=["-snapshot_interval", "accepted: at least"])
        self.refused(*case, "1e-7", says=["-snapshot_interval", "accepted: at least 2e-06"])
        self.refused(*case, "1e-4", "-time_step", ".02", says=["-snapshot_interval", "accepted: at least 2e-04"])


class Logs(Restart):
    def test_petsc_does_not_write_over_a_file(self):
        self.run_case("run", *FLAT, "-time_steps_max", 2)
        mine = self.room / "mine.txt"
        mine.write_text("mine")
        (self.room / "info.0").write_text("mine")
        case = [*FLAT, "-time_steps_max", 2]
        for options in (["-log_trace", "mine.txt"], ["-citations", "mine.txt"], ["-malloc_view", "mine.txt"]):
            self.refused(*case, "-output_dir", "new", *options, says=["mine"])  # taken for a file of options
        for options in (["-log_view", ":mine.txt"], ["-log_view", "ascii:mine.txt:ascii_xml"], ["-info", "info"],
                        ["-log_trace", "info"], ["-citations", "./mine.txt:"],
                        ["-pressure_solver", "ksp", "-pressure_ksp_view", ":mine.txt"],
                        ["-pressure_solver", "ksp", "-pressure_ksp_monitor", "ascii:mine.txt"]):
            self.refused(*case, "-output_dir", "new", *options, says=[options[-2], "exists", "accepted: the name of a new file"])
        for name in "series.csv", "summary.json", "checkpoint_00000002.h5", "snapshot_000000.h5.tmp":
            self.refused(*case, "-output_dir", "new", "-log_view", f":new/{name}", says=["-log_view", "a file of the run"])
            self.refused(*case, "-output_dir", self.room / "new", "-log_view", f":./new/{name}", says=["-log_view", "a file of the run"])
        self.assertEqual(mine.read_text(), "mine")
        self.run_case("new", *case, "-log_view", ":log.txt")
        self.assertIn("EulMomentum", (self.room / "log.txt").read_text())
        self.refused(*case, "-output_dir", "newer", "-log_view", ":log.txt", says=["log.txt exists"])


if __name__ == "__main__":
    unittest.main()
