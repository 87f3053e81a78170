#!/usr/bin/python3
"""-load_balance: other cuts between ranks, by what bodies cost and where they are; the same bits.

Needs EULASTIC=path of the binary and EULASTIC_MPIEXEC.
"""
import pathlib
import re
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from restart_case import OFTEN, Restart  # noqa: E402

BOX = "-grid_length 3,6,5 -boundary_y wall -fluid_viscosity .3 -series_interval .11".split()
FLOW = "-body_force .3,0,0 -initial_velocity_mean .2,0,.4 -time_end 100".split()
CORNER = [*BOX, *("-grid_cells 12,24,20 "
                  "-species cell,bead -cell_shape sphere -cell_radius .6 -cell_centre 1.5,1,1 -cell_shear_modulus 1 "
                  "-bead_shape sphere -bead_radius .5 -bead_centre .5,2.1,1.2 -bead_shear_modulus .5").split()]
LINE = re.compile(r"^balance: (the even split is kept, )?heaviest rank (\S+) (->|of the mean, at best) (\S+) "
                  r"(of the mean )?\(estimate\)(.*)$", re.M)


class Balance(Restart):
    def line(self, *arguments, ranks=0):
        """(before, whether ranks are cut anew, after) of a run in the directory `run`."""
        result = self.call(*arguments, "-load_balance", "-output_dir", "run", "-output_overwrite", ranks=ranks)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertEqual(result.stdout.count("balance: "), 1)
        even, before, _, after, _, self.rest = LINE.search(result.stdout).groups()
        return float(before), even is None, float(after)

    def hash(self):
        return self.summary("run")["state_hash"]

    def check(self, *options):
        case = [*CORNER, *FLOW, *options]
        self.run_case("whole", *case, "-time_steps_max", 8)
        whole = self.summary("whole")["state_hash"]
        for ranks in (2, 4):
            self.run_case("even", *case, "-time_steps_max", 8, "-output_overwrite", ranks=ranks)
            self.assertEqual(self.summary("even")["state_hash"], whole)
            before, moved, after = self.line(*case, "-time_steps_max", 8, ranks=ranks)
            self.assertTrue(moved)
            self.assertLess(after, 0.9 * before)
            self.assertGreaterEqual(after, 1)
            self.assertEqual(self.hash(), whole)
            self.assertEqual(self.series("run"), self.series("whole"))
        self.line(*case, "-time_steps_max", 4, *OFTEN, ranks=4)
        _, moved, _ = self.line(*case, "-time_steps_max", 8, "-restart", "run", ranks=2)
        self.assertTrue(moved)
        self.assertEqual(self.hash(), whole)
        self.assertEqual(self.series("run"), self.series("whole"))

    def test_fast(self):
        self.check()

    def test_classic(self):
        self.check("-method", "classic", "-time_step", ".01")

    def test_smac(self):
        self.check("-pressure_solver", "smac")

    def test_a_restart_goes_by_the_checkpoint(self):
        # The body is carried from the middle of one half to where the halves meet.
        case = ("-grid_cells 12,12,48 -grid_length 3,3,12 -fluid_viscosity .3 -initial_velocity_mean 0,0,1 -species cell "
                "-cell_shape sphere -cell_radius .5 -cell_centre 1.5,1.5,3 -cell_shear_modulus 1 -da_processors_z 2 "
                "-series_interval 1").split()
        before, moved, _ = self.line(*case, "-time_end", 3, "-checkpoint_interval", 1, ranks=2)
        self.assertTrue(moved)
        self.assertGreater(before, 1.4)
        later, moved, _ = self.line(*case, "-time_end", 3.1, "-restart", "run", ranks=2)
        self.assertFalse(moved)
        self.assertLess(later, 1.05)

    def test_ksp(self):
        case = [*CORNER, *FLOW, "-pressure_solver", "ksp", "-time_steps_max", 4]
        one = self.run_case("one", *case)
        self.assertTrue(self.line(*case, ranks=4)[1])
        many = self.summary("run")
        self.assertAlmostEqual(many["kinetic_energy"] / one["kinetic_energy"], 1, delta=1e-6)

    def test_nothing_to_gain(self):
        for cells in "12,24,20", "12,25,19":
            for ranks in (2, 3, 4):
                self.assertFalse(self.line(*BOX, *FLOW, "-grid_cells", cells, "-time_steps_max", 1, ranks=ranks)[1])
        result = self.call(*CORNER, *FLOW, "-time_steps_max", 1, "-load_balance", "-output_dir", "one")
        self.assertIn("\nbalance: one rank has all cells\n", result.stdout)

    def test_check_only_speaks_of_equal_parts(self):
        case = [*CORNER, *FLOW, "-check_only"]
        result = self.call(*case, "-load_balance", "-ranks", 4)
        self.assertEqual((result.returncode, result.stdout), (2, ""))
        self.assertRegex(result.stderr, r"^eulastic: error: -load_balance: .*; accepted: -load_balance false with -check_only\n$")
        for more in (["-load_balance"], ["-ranks", 4]):
            self.assertEqual(self.call(*case, *more).returncode, 0)

    def test_too_large_a_box(self):
        # Memory for even boxes alone.
        case = [*CORNER, *FLOW, "-time_steps_max", 1]
        result = self.call(*case, "-guard_memory", "1e-9", ranks=2)
        needed, limit = map(float, re.search(r"need about (\S+) GB .* has (\S+) GB", result.stderr).groups())
        self.assertTrue(self.line(*case, ranks=2)[1])
        self.assertEqual(self.rest, "")
        self.line(*case, "-guard_memory", 1.01 * needed / limit, ranks=2)
        self.assertRegex(self.rest, "^; the even split is kept: -grid_cells: the fields need about")


if __name__ == "__main__":
    unittest.main()
