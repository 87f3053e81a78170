#!/usr/bin/python3
"""Bounds that stop a run: the line, the exit code, what stays, and that 0 switches them off.

Needs EULASTIC=path of the binary and EULASTIC_MPIEXEC.
"""
import pathlib
import sys
import unittest

import h5py
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from restart_case import FLAT, OFTEN, Restart  # noqa: E402

CLASSIC = [*FLAT, "-method", "classic"]
FREE = ("-grid_cells 16,16,1 -initial_velocity shear_wave_xy -fluid_viscosity .01 -species a -a_shape sphere -a_radius "
        ".2 -a_shear_modulus 10 -time_end 2 -series_interval .01").split()
NONE = [word for name in ("cfl", "divergence", "mach", "volume_drift", "energy_growth")
        for word in (f"-guard_{name}", "0")]


class Guards(Restart):
    def stopped(self, *arguments, says, reason="guard", ranks=0):
        result = self.call(*arguments, "-output_dir", "run", "-output_overwrite", ranks=ranks)
        self.assertEqual(result.returncode, 3, result.stderr)
        lines = [line for line in result.stderr.splitlines() if line.startswith("eulastic: error:")]
        self.assertEqual(len(lines), 1, result.stderr)
        self.assertRegex(lines[0], r"error: step \d+, t = [0-9.e+-]+, near x, y, z = ")
        for piece in (*says, "-time_step"):
            self.assertIn(piece, lines[0])
        summary = self.summary("run")
        self.assertEqual(summary["exit_reason"], reason)
        self.assertIn(f"step {summary['steps']},", lines[0])
        return lines[0]

    def test_divergence(self):
        one_sweep = [*FLAT, "-acm_iterations_max", "1", "-acm_search_directions", "0", "-acm_coarse", "false"]
        bound = ["-guard_divergence", "1e-4"]
        line = self.stopped(*one_sweep, *bound, *OFTEN, says=["rms(div v)", "-guard_divergence 0.0001", "-acm_iterations_max"])
        self.assertEqual(self.stopped(*one_sweep, *bound, *OFTEN, ranks=2, says=[]), line)  # the same on any ranks

    def test_the_last_good_checkpoint_stays(self):
        bound = ["-guard_volume_drift", "2e-4"]
        self.stopped(*CLASSIC, *bound, *OFTEN, says=["volume of body", "-guard_volume_drift 0.0002"])
        last = self.summary("run")["steps"]
        kept = [int(path.stem.split("_")[1]) for path in self.checkpoints()]
        self.assertEqual(kept, [last - 2, last - 1])
        self.run_case("run", *CLASSIC, "-time_steps_max", last + 2, "-restart", "run")  # a bound may change
        self.assertGreater(self.summary("run")["volume_drift"], 2e-4)

    def test_mach(self):
        self.stopped(*CLASSIC, "-guard_mach", ".01", says=["Mach number", "-guard_mach 0.01"])
        self.assertGreater(self.summary("run")["mach_max"], .01)

    def test_a_divergence_that_passes_through_nothing_is_no_speed(self):
        # A shear wave along the diagonal of a box of solid: its divergence is truncation error, 1e-3 of U/h at most, and
        # passes through 0; beta of the rest says nothing.
        n = 64
        j, i = numpy.meshgrid(numpy.arange(n), numpy.arange(n), indexing="ij")
        wave = numpy.sin(2 * numpy.pi * (i + j + .5) / n)[None]
        with h5py.File(self.room / "wave.h5", "w") as file:
            file["velocity_x"], file["velocity_y"], file["solid_fraction"] = wave, -wave, numpy.ones((1, n, n))
        end = self.run_case("wave", "-grid_cells", f"{n},{n},1", "-fluid_viscosity", ".01", "-method", "classic",
                            "-initial_state", "wave.h5", "-species", "g", "-g_shear_modulus", "1", "-time_end", ".8")
        self.assertTrue(0 < end["mach_max"] < 1, end["mach_max"])

    def test_cfl(self):
        self.stopped(*FREE, "-method", "classic", "-time_step", ".1", says=["CFL number 1.5", "-guard_cfl 1;"])
        self.assertEqual(self.summary("run")["steps"], 0)

    def test_energy(self):
        says = ["the numerics have generated energy", "-guard_energy_growth 0.3"]
        case = [*FREE, "-time_step", ".03", *NONE[:-2]]
        for force in ("0,0,0", "1e-9,0,0"):  # driven or not
            self.stopped(*case, "-body_force", force, says=says)
            self.assertLess(self.summary("run")["steps"], 6)
        free = self.call(*case, "-guard_energy_growth", "0", "-output_dir", "free", "-time_steps_max", "5")
        self.assertEqual(free.returncode, 0, free.stderr)

    def test_not_finite(self):
        for base in (CLASSIC, [*FREE, "-method", "classic"]):
            self.stopped(*base, *NONE, "-time_step", "3" if base is CLASSIC else ".03", *OFTEN, reason="nonfinite",
                         says=["a field is not finite", "limit"])
            for path in self.checkpoints():
                with h5py.File(path) as file:
                    self.assertTrue(numpy.isfinite(file["velocity_x"][()]).all())

    def test_the_last_state_is_looked_at(self):
        self.stopped(*FREE, *NONE, "-method", "classic", "-time_step", ".03", "-time_steps_max", "10",
                     reason="nonfinite", says=["step 10,", "not finite"])

    def test_time_stands_still(self):
        self.refused(*FREE, "-time_step", "1e-17", says=["-time_step", "1e-17", "-time_end 2", "2.2"])

    def test_hardly_ever_ends(self):
        result = self.call(*FREE, "-time_step", "1e-12", "-time_steps_max", "2", "-output_dir", "short")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        process = self.start(*FREE[:-2], "-series_interval", "1e-11", "-time_step", "1e-12")
        process.terminate()
        self.assertIn("warning: -time_end 2 is 2e+12 steps", process.communicate(timeout=60)[1])


if __name__ == "__main__":
    unittest.main()
