#!/usr/bin/python3
"""-pressure_solver ksp from outside: what of -pressure_* is refused, recorded and counted; failures in one line.

Needs EULASTIC=path of the binary and EULASTIC_MPIEXEC.
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))

from program import BINARY, launcher  # noqa: E402

SCENE = "-grid_cells 16,16,1 -boundary_y wall -time_end 3e-3 -time_step 1e-3 -initial_velocity random".split()


class Ksp(unittest.TestCase):
    def setUp(self):
        room = tempfile.TemporaryDirectory()
        self.addCleanup(room.cleanup)
        self.room = pathlib.Path(room.name)

    def run_program(self, options, ranks=1, scene=SCENE):
        variables = {k: v for k, v in os.environ.items() if k != "PETSC_OPTIONS"}
        return subprocess.run([*launcher(ranks), BINARY, *scene, *options.split()], cwd=self.room, env=variables,
                              capture_output=True, text=True, timeout=120)

    def summary(self, options, directory, **more):
        result = self.run_program(f"{options} -output_dir {directory}", **more)
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads((self.room / directory / "summary.json").read_text())

    def test_equals_smac(self):
        smac = self.summary("-pressure_solver smac", "smac")
        for ranks in (1, 3):
            ksp = self.summary("-pressure_solver ksp", f"ksp{ranks}", ranks=ranks)
            self.assertEqual(ksp["pressure_solver"], "ksp")
            self.assertAlmostEqual(ksp["kinetic_energy"] / smac["kinetic_energy"], 1, delta=1e-10)
            self.assertLess(ksp["divergence_rms"], 1e-9)
            self.assertTrue(5 <= ksp["ksp_iterations_per_step"] <= 20, ksp["ksp_iterations_per_step"])
            self.assertEqual(ksp["acm_sweeps_per_step"], 0)

    def test_options_are_recorded(self):
        first = self.summary("-pressure_solver ksp -pressure_ksp_rtol 1e-3 -pressure_pc_type jacobi", "first")
        self.assertIn("\n-pressure_pc_type jacobi\n", (self.room / "first/options.txt").read_text())
        second = self.summary("first/options.txt", "second", scene=[])
        self.assertEqual(second["state_hash"], first["state_hash"])
        self.assertNotEqual(self.summary("-pressure_solver ksp", "third")["state_hash"], first["state_hash"])

    def test_what_shows_things(self):
        result = self.run_program("-pressure_solver ksp -pressure_ksp_monitor -pressure_ksp_view "
                                  "-pressure_ksp_converged_reason")
        self.assertEqual(result.returncode, 0, result.stderr)
        for text in ("KSP Residual norm", "KSP Object: (pressure_)", "converged due to CONVERGED_RTOL"):
            self.assertIn(text, result.stdout)

    def test_refusals(self):
        for options, says in [
                ("-pressure_ksp_rtol 1e-3", "-pressure_ksp_rtol: applies only with -pressure_solver ksp"),
                ("-pressure_solver ksp -pressure_ksp_rtoll 1e-3", "-pressure_ksp_rtoll: is unknown to PETSc"),
                ("-pressure_solver ksp -pressure_sub_pc_type ilu", "-pressure_sub_pc_type: is unknown to PETSc"),
                ("-pressure_solver ksp -pressure_ksp_type foo", "KSP type foo"),
                ("-pressure_solver ksp -pressure_pc_type foo", "PC type foo"),
                ("-pressure_solver ksp -pressure_ksp_rtol foo", "foo"),
                ("-pressure_solver ksp -pressure_foo 1", "unknown option -pressure_foo")]:
            for ranks in (1, 2):
                with self.subTest(options=options, ranks=ranks):
                    result = self.run_program(options, ranks)
                    self.assertEqual(result.returncode, 2)
                    self.assertIn(says, result.stderr)
                    self.assertEqual(result.stderr.count("eulastic: error:"), 1)
                    self.assertEqual(list(self.room.iterdir()), [], "something was written")

    def test_no_convergence(self):
        result = self.run_program("-pressure_solver ksp -pressure_ksp_max_it 3", ranks=2)
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stderr, r"eulastic: error: [^\n]*-pressure_ksp_max_it \(now 3\)")
        self.assertEqual(result.stderr.count("eulastic: error:"), 1)


if __name__ == "__main__":
    unittest.main()
