"""Scripts: syntax, -h of every one, and how scripts/test counts."""
import contextlib
import io
import os
import re
import runpy
import shutil
import sys
import unittest

from test_scripts import ROOT, SCRIPTS, WithFolder, load, start


class Shell(WithFolder):
    def shell_scripts(self):
        files = [path for path in [*SCRIPTS.rglob("*"), ROOT / ".ci/run"] if path.is_file() and path.suffix != ".pyc"]
        return [path for path in files if path.name == "environment" or path.read_text().startswith("#!/bin/bash")]

    def test_syntax(self):
        self.assertGreaterEqual(len(self.shell_scripts()), 6)
        for path in self.shell_scripts():
            self.assertEqual(start("bash", "-n", path).returncode, 0, path)

    def help_of(self, path):
        """Exit code and words of -h. Those in Python run in this process, which has imported what takes them their time."""
        if path.read_text().startswith("#!/bin/bash"):
            done = start(path, "-h", cwd=self.folder)
            return done.returncode, done.stdout
        keep, said = (os.getcwd(), sys.argv, sys.path[:]), io.StringIO()
        os.chdir(self.folder)
        sys.argv, sys.path[:] = [str(path), "-h"], [str(path.parent), *(p for p in sys.path if "/scripts" not in p)]
        try:
            with contextlib.redirect_stdout(said):
                runpy.run_path(str(path), run_name="__main__")
        except SystemExit as end:
            return end.code or 0, said.getvalue()
        finally:
            sys.argv, sys.path[:] = keep[1:]
            os.chdir(keep[0])
        return 0, said.getvalue()

    def test_help_from_anywhere(self):
        scripts = [path for path in SCRIPTS.rglob("*") if path.is_file() and os.access(path, os.X_OK)]
        self.assertGreaterEqual(len(scripts), 35)
        for path in scripts:
            code, said = self.help_of(path)
            self.assertEqual(code, 0, path)
            self.assertRegex(said, rf"usage: (scripts/)?(\w+/)*{path.name}\b")
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_unknown_option_of_test_is_refused(self):
        done = start(SCRIPTS / "test", "--quik")
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertIn("--quik", done.stderr)

    def count(self, cmake, *arguments):
        """scripts/test on a project of its own: exit status and last line."""
        shutil.copytree(SCRIPTS, self.folder / "scripts", dirs_exist_ok=True)
        (self.folder / "scripts/install").write_text("#!/bin/bash\n")  # a toy needs no packages
        shutil.copy(ROOT / "CMakePresets.json", self.folder)
        (self.folder / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.22)\nproject(toy LANGUAGES NONE)\nenable_testing()\n" + cmake)
        done = start(self.folder / "scripts/test", *arguments, cwd="/")
        return done.returncode, done.stdout.splitlines()[-1], done.stdout

    TOY = """
add_custom_target(quick)
add_test(NAME a COMMAND true)
add_test(NAME b COMMAND true)
add_test(NAME c COMMAND {})
add_test(NAME d COMMAND true)
add_test(NAME e COMMAND true)
set_tests_properties(a PROPERTIES LABELS unit)
set_tests_properties(b PROPERTIES LABELS "mpi;quick")
set_tests_properties(c PROPERTIES LABELS "convergence")
set_tests_properties(d PROPERTIES LABELS "full")
"""

    def test_every_test_is_counted_once(self):
        status, last, out = self.count(self.TOY.format("true"))
        self.assertEqual((status, last), (0, "4 passed, 0 failed"))
        self.assertRegex(out, r"(?m)^ten slowest tests")
        self.assertEqual(self.count(self.TOY.format("true"), "--quick")[:2], (0, "2 passed, 0 failed"))
        self.assertEqual(self.count(self.TOY.format("true"), "--full")[:2], (0, "5 passed, 0 failed"))

    def test_failures_count(self):
        status, last, out = self.count(self.TOY.format("false"))
        self.assertEqual((status, last), (1, "3 passed, 1 failed"))
        self.assertIn("failed: c", out.splitlines())

    def test_no_test_is_a_failure(self):
        self.assertEqual(self.count("")[:2], (1, "0 passed, 0 failed"))

    def test_a_broken_build_is_a_failure(self):
        broken = self.TOY.format("true") + "add_custom_target(broken ALL COMMAND false)\n"
        self.assertEqual(self.count(broken)[:2], (1, "0 passed, 1 failed"))
        self.assertEqual(self.count(broken, "--quick")[:2], (0, "2 passed, 0 failed"))  # builds only what it runs

    LOG = """
 1/4 Test  #9: unit.Grid.IsRead ..........   Passed    0.51 sec
 2/4 Test #10: mpi.Sums.Scenes/Exact/one ...***Failed    9.00 sec
 3/4 Test #11: cases.Cases ..............***Exception: SegFault  30.25 sec
 4/4 Test #12: docs.Docs ................***Skipped   0.10 sec
50% tests passed, 2 tests failed out of 4
"""

    def test_report(self):
        """Which tests failed, and which took more than twice their budget, of which two seconds are the least."""
        report = load("lib/test_report")
        results = report.read_results(self.LOG)
        self.assertEqual(results, [("unit.Grid.IsRead", True, .51), ("mpi.Sums.Scenes/Exact/one", False, 9),
                                   ("cases.Cases", False, 30.25), ("docs.Docs", True, .1)])
        self.assertEqual(report.over_budget(results, {"cases.Cases": 16}), [("mpi.Sums.Scenes/Exact/one", 9, 2)])
        self.assertEqual(report.over_budget(results, {"cases.Cases": 15})[1:], [("cases.Cases", 30.25, 15)])
        costs = dict(report.COST.findall(report.costs_text(results)))
        self.assertEqual(costs, {"mpi.Sums.Scenes/Exact/one": "9.0", "cases.Cases": "30.2"})

    def test_tests_of_a_change(self):
        choose = load("lib/tests_of_change").tests_of
        chosen = lambda path, test: bool(re.search("|".join(choose([path])), test))
        for path, tests, others in (("src/pressure/acm.cpp", ["mpi.AcmSweeps.X", "ksp.Ksp"], ["docs.Docs"]),
                                    ("tests/regression/test_ksp.py", ["ksp.Ksp"], ["unit.Grid.X", "cases.Cases"]),
                                    ("scripts/studies/stability/stability_map", ["stability.Judge", "full.stability"], ["cases.Cases"]),
                                    ("CMakeLists.txt", ["unit.Grid.X", "cases.Cases"], [])):
            for test in tests:
                self.assertTrue(chosen(path, test), (path, test))
            for test in others:
                self.assertFalse(chosen(path, test), (path, test))


if __name__ == "__main__":
    unittest.main()
