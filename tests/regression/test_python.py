"""The Python package: runs, what a failure says, sweeps that repeat nothing, coordinates, the example of docs/python.md,
and the package as pip installs it. Needs EULASTIC."""
import decimal
import fractions
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import unittest

import matplotlib.image
import numpy

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "python"))
sys.dont_write_bytecode = True
import eulastic  # noqa: E402
from eulastic import running  # noqa: E402

CASE = ROOT / "options/disc_in_shear.opts"
SHORT = {"grid_cells": (16, 16, 1), "time_end": 0.5, "snapshot_interval": 0.5}


class WithRoom(unittest.TestCase):
    def setUp(self):
        room = tempfile.TemporaryDirectory()
        self.addCleanup(room.cleanup)
        self.room = pathlib.Path(room.name)


class OneRun(WithRoom):
    def test_results(self):
        said = []
        run = eulastic.run(CASE, self.room / "run", progress=said.append, disc_shear_modulus=numpy.float64(2), **SHORT)
        self.assertEqual((run.options["disc_shear_modulus"], run.cells), ("2", (16, 16, 1)))
        self.assertEqual(run.series.time[-1], 0.5)
        self.assertTrue(any("100.0 %" in line for line in said), said)
        self.assertIn("taylor_deformation", str(run))
        snapshot = run.snapshots[-1]
        for name, first in {"pressure": (0.5, 0.5), "velocity_x": (0, 0.5), "velocity_y": (0.5, 0)}.items():
            x, y, z = snapshot.coordinates(name)
            self.assertEqual(snapshot[name].shape, (len(z), len(y), len(x)))
            self.assertEqual((x[0], y[0], x[1] - x[0]), (*first, 1))
        y = snapshot.coordinates("velocity_x")[1]
        start = run.snapshots[0]["velocity_x"][0, :, 0]
        numpy.testing.assert_allclose(start, 0.05 * (y - 8), atol=1e-6)  # the Couette flow of the case
        before = (self.room / "run/summary.json").stat().st_mtime_ns
        self.assertEqual(eulastic.run(CASE, self.room / "run", progress=False, disc_shear_modulus=2, **SHORT).series.time[-1], 0.5)
        self.assertEqual((self.room / "run/summary.json").stat().st_mtime_ns, before)

    def test_options_as_the_program_reads_them(self):
        for value, text in ((True, "true"), (numpy.bool_(False), "false"), ((1, 2.5, 3.0), "1,2.5,3"), (0.1 + 0.2, repr(0.1 + 0.2)),
                            (numpy.array([1.0, 2.0]), "1,2"), (numpy.int64(3), "3"), ("wall", "wall"), (1e-7, "1e-07"),
                            ("state_1.0", "state_1.0"), (pathlib.Path("a b/c"), "a b/c"), (range(3), "0,1,2"), (1e22, "1e+22"),
                            (numpy.array(2.5), "2.5"), (fractions.Fraction(1, 4), "0.25"), (decimal.Decimal("1e-3"), "0.001"),
                            ([(0, 1, 2), numpy.array([3, 4.5, 5])], "0,1,2:3,4.5,5"), (["a", "b"], "a,b"), ((True, False), "true,false"),
                            ((x / 2 for x in (1, 2)), "0.5,1"), (numpy.ones((2, 3)), "1,1,1:1,1,1")):
            self.assertEqual(running.option_value(value), text)
        for wrong in ({"a": 1}, {1, 2}, 1j, object()):
            with self.assertRaisesRegex(TypeError, "radius: .* is no value of an option; accepted: numbers, texts"):
                running.option_words({"disc_radius": wrong})
        self.assertEqual(running.option_words({"a": None, "b": 2.0}), {"b": "2"})

    def test_values_of_all_types_reach_the_program(self):
        run = eulastic.run(CASE, self.room / "a b", progress=False, probe_points=numpy.array([[1, 2, 0], [3.5, 4, 0]]), threads=None,
                           snapshot_fields=("velocity", "pressure"), **SHORT)
        self.assertEqual((run.options["probe_points"], run.options["snapshot_fields"]), ("1,2,0:3.5,4,0", "velocity,pressure"))
        probes = eulastic.over_time(run.probes)
        numpy.testing.assert_array_equal(probes.x, [1, 3.5])
        self.assertEqual(probes.velocity_x.shape, (len(run.series), 2))

    def test_probes_that_moved_are_refused(self):
        case = dict(SHORT, probe_points="1,2,0:3,4,0")
        run = eulastic.run(CASE, self.room / "run", progress=False, **case)
        for n, (points, count) in enumerate((("1,2,0:3,5,0", 2), ("1,2,0:3,5,0:1,1,0", 3), ("6,1,0", 1))):
            case.update(probe_points=points, time_end=1 + n)
            last, run = run.series.time[-1], eulastic.run(CASE, self.room / "run", progress=False, **case)
            with self.assertRaisesRegex(ValueError, "positions change in time, as after a restart with other -probe_points"):
                eulastic.over_time(run.probes)
            self.assertEqual(eulastic.over_time(run.probes[run.probes.time > last]).velocity_x.shape[1], count)

    def test_what_is_wrong_is_said_by_the_program(self):
        with self.assertRaises(eulastic.RunError) as caught:
            eulastic.run(CASE, self.room / "run", progress=False, disc_radios=2)
        self.assertRegex(str(caught.exception), r"\Aunknown option -disc_radios; nearest known: -disc_radius[^\n]*\Z")
        self.assertEqual(caught.exception.exit_code, 2)
        self.assertFalse((self.room / "run").exists())
        with self.assertRaisesRegex(eulastic.RunError, "there is no case nosuch.opts"):
            eulastic.run("nosuch.opts", self.room / "run", progress=False)
        with self.assertRaisesRegex(FileNotFoundError, "no run here"):
            eulastic.read(self.room)
        with self.assertRaises(eulastic.RunError) as caught:
            eulastic.run(CASE, self.room / "guard", progress=False, guard_cfl=1e-9, **SHORT)
        self.assertEqual(caught.exception.exit_code, 3)
        self.assertIn("-guard_cfl", str(caught.exception))

    def test_an_interrupted_run_is_stopped_and_goes_on(self):
        steps = []

        def interrupt(line):
            steps.append(line)
            if "step 1 " in line:
                raise KeyboardInterrupt

        endless = {**SHORT, "time_step": 1e-5, "snapshot_interval": 0}  # mpiexec takes two seconds to tell the program
        with self.assertRaises(KeyboardInterrupt):
            eulastic.run(CASE, self.room / "run", ranks=1, progress=interrupt, **endless)
        half = eulastic.read(self.room / "run")
        self.assertFalse(eulastic.is_finished(self.room / "run"))
        self.assertLess(half.summary["time"], 0.5)
        said = []
        eulastic.run(CASE, self.room / "run", ranks=1, progress=said.append, **endless)
        self.assertTrue(eulastic.is_finished(self.room / "run"))


class Sweep(WithRoom):
    def sweep(self, grid, **more):
        return eulastic.sweep(CASE, grid, jobs=2, output_dir=self.room / "sweep", progress=False, **{**SHORT, **more})

    def test_table(self):
        grid = {"disc_shear_modulus": [0.5, 2.0], "disc_radius": [3, 4]}
        table = self.sweep(grid)
        numpy.testing.assert_array_equal(table.disc_shear_modulus, [0.5, 0.5, 2, 2])
        numpy.testing.assert_array_equal(table.disc_radius, [3, 4, 3, 4])
        self.assertEqual(set(table.exit_reason), {"time_end"})
        self.assertTrue(numpy.issubdtype(table.steps.dtype, numpy.integer))
        volumes = [run.bodies.volume[-1, 0] for run in table.run]
        numpy.testing.assert_allclose(volumes, numpy.pi * table.disc_radius ** 2, rtol=0.01)
        at = {path: path.stat().st_mtime_ns for path in self.room.glob("sweep/*/summary.json")}
        self.assertEqual(len(at), 4)
        wider = self.sweep({**grid, "disc_radius": [3, 4, 2]})
        self.assertEqual({path: path.stat().st_mtime_ns for path in at}, at, "a finished run was repeated")
        numpy.testing.assert_array_equal(wider[[0, 1, 3, 4]].state_hash, table.state_hash)

    def test_lists_and_words(self):
        table = self.sweep({"grid_cells": [(16, 16, 1), (24, 24, 1)], "pressure_solver": ["acm", "smac"]}, time_steps_max=1)
        self.assertEqual(list(table.grid_cells), ["16,16,1"] * 2 + ["24,24,1"] * 2)
        self.assertEqual(list(table.pressure_solver), ["acm", "smac"] * 2)
        self.assertEqual([run.cells[0] for run in table.run], [16, 16, 24, 24])

    def test_numbers_of_numpy_and_options_that_are_not_given(self):
        table = self.sweep({"disc_radius": numpy.array([3, 4]), "disc_shear_modulus": [None, numpy.float32(0.5)]}, time_steps_max=1)
        self.assertTrue(numpy.issubdtype(table.disc_radius.dtype, numpy.integer))
        self.assertEqual(list(table.disc_shear_modulus), [None, 0.5] * 2)
        of_the_case = eulastic.read_options(CASE)["disc_shear_modulus"]
        self.assertEqual([float(run.options["disc_shear_modulus"]) for run in table.run], [float(of_the_case), 0.5] * 2)

    def test_one_that_fails_does_not_end_the_others(self):
        with self.assertRaises(eulastic.RunError) as caught:
            self.sweep({"disc_radius": [-1, 3, "x"]})
        said = str(caught.exception).splitlines()
        self.assertEqual(len(said), 2)
        self.assertIn('disc_radius=-1: -disc_radius: "-1" is out of range', said[0])
        self.assertEqual(list(caught.exception.table.disc_radius), [3])

    def test_a_grid_without_sense(self):
        for grid in {"disc_radius": []}, {"disc_radius": [1, 1.0]}:
            with self.assertRaisesRegex(ValueError, "grid"):
                self.sweep(grid)

    def test_an_interrupt_stops_all(self):
        """As Ctrl-C: the runs under way end, those that wait do not begin."""
        program = ("import sys; sys.path.insert(0, sys.argv[1]); import eulastic\n"
                   "eulastic.sweep(sys.argv[2], {'disc_radius': [2, 3, 4]}, jobs=2, output_dir=sys.argv[3], grid_cells=(16, 16, 1), "
                   "time_step=1e-6)")
        process = subprocess.Popen([sys.executable, "-B", "-c", program, ROOT / "python", CASE, self.room / "s"],
                                   stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
        self.addCleanup(process.kill)
        limit = time.monotonic() + 60
        while len(list(self.room.glob("s/*/series.csv"))) < 2:
            self.assertLess(time.monotonic(), limit)
            time.sleep(0.05)
        process.send_signal(2)
        _, errors = process.communicate(timeout=60)
        self.assertIn("KeyboardInterrupt", errors)
        self.assertEqual(len(list(self.room.glob("s/*/options.txt"))), 2)
        self.assertEqual(subprocess.run(["pgrep", "-f", self.room], capture_output=True, text=True).stdout, "")


class Example(WithRoom):
    def test_page(self):
        """The sweep of docs/python.md, on a coarse grid and to a tenth of its end."""
        page = (ROOT / "docs/python.md").read_text()
        block = re.search(r"(?m)(^    import sys\n(?:    .*\n|\n)*)", page)[1].replace("\n    ", "\n").strip()
        for name in ("options", "python", "scripts"):
            (self.room / name).symlink_to(ROOT / name)
        environment = dict(os.environ, PETSC_OPTIONS="-grid_cells 32,32,1 -grid_length 8,8,1 -time_end 4 -snapshot_interval 0")
        done = subprocess.run([sys.executable, "-B", "-c", block + "\nprint(*D)"], cwd=self.room, env=environment,
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        deformations = [float(word) for word in done.stdout.splitlines()[-1].split()]
        self.assertEqual(len(deformations), 6)
        self.assertTrue(all(numpy.diff(deformations) < 0), deformations)  # the stiffer the rounder
        picture = matplotlib.image.imread(self.room / "output/deformation.png")[..., :3]
        self.assertGreater((picture < 0.7).any(axis=2).sum(), 1000)


class Package(WithRoom):
    def test_installed_by_pip(self):
        if subprocess.run(["/usr/bin/python3", "-c", "import setuptools, pip"], capture_output=True).returncode:
            self.skipTest("python3-pip or python3-setuptools is not installed")
        source = self.room / "python"  # pip builds beside the source
        subprocess.run(["cp", "-rL", ROOT / "python", source], check=True)
        done = subprocess.run(["/usr/bin/python3", "-m", "pip", "install", "--target", self.room / "site", "--no-build-isolation",
                               "--no-index", "--no-deps", source], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        program = ("import eulastic; run = eulastic.run(sys.argv[1], 'out', progress=False, grid_cells=(16, 16, 1), time_steps_max=2)\n"
                   "print(eulastic.__file__, run.summary['steps'])")
        environment = dict(os.environ, PYTHONPATH=str(self.room / "site"))
        done = subprocess.run(["/usr/bin/python3", "-B", "-c", "import sys\n" + program, CASE], cwd=self.room, env=environment,
                              capture_output=True, text=True)
        self.assertEqual(done.stdout.split(), [str(self.room / "site/eulastic/__init__.py"), "2"], done.stderr)
        by_name = program.replace("'out'", "'by_name'")  # the cases are those of the clone in which EULASTIC was built
        done = subprocess.run(["/usr/bin/python3", "-B", "-c", "import sys\n" + by_name, pathlib.Path(CASE).stem], cwd=self.room,
                              env=environment, capture_output=True, text=True)
        self.assertEqual(done.stdout.split()[1:], ["2"], done.stderr)
        script = self.room / "site/eulastic/shell/run"
        for name, value, said in (("EULASTIC", None, "the program eulastic is missing; accepted: its path in EULASTIC, or its folder on PATH"),
                                  ("EULASTIC", "/nosuch", "EULASTIC: /nosuch is missing or no program; accepted: the path of the program eulastic"),
                                  ("OTHER", "", "there is no case nosuch; accepted: a file of options, "
                                   f"or the name of one in {ROOT}/options")):
            changed = {**environment, "PATH": "/usr/bin:/bin", name: value}
            done = subprocess.run(["bash", script, "nosuch", "out"], cwd=self.room, capture_output=True, text=True,
                                  env={name: text for name, text in changed.items() if text is not None})
            self.assertEqual((done.stdout, done.stderr), ("", f"run: {said}\n"))


if __name__ == "__main__":
    unittest.main()
