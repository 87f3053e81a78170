#!/usr/bin/python3
"""Checkpoints, restarts, signals and what a run does when something breaks.

Needs EULASTIC=path of the binary and EULASTIC_MPIEXEC.
"""
import contextlib
import json
import os
import pathlib
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import h5py
import numpy

BINARY = os.environ["EULASTIC"]
MPIEXEC = os.environ.get("EULASTIC_MPIEXEC", "mpiexec")
ROOT = pathlib.Path(__file__).resolve().parents[2]
FLAT = ("-grid_cells 20,16,1 -grid_length 5,4,1 -boundary_y wall -wall_ymax_velocity .4,0,0 -wall_ymax_frequency .9 "
        "-fluid_viscosity .3 -body_force .1,0,0 -species cell,bead -cell_shape sphere -cell_radius .8 "
        "-cell_centre .3,2.2,0 -cell_shear_modulus 1 -bead_shape sphere -bead_radius .6 -bead_centre 2.9,1.5,0 "
        "-bead_shear_modulus 2 -time_end 100 -series_interval .11").split()
SOLID = ("-grid_cells 12,10,9 -grid_length 3,2.5,2.2 -boundary_y wall -boundary_z wall -wall_zmax_velocity .3,.1,0 "
         "-fluid_viscosity .3 -initial_velocity_mean .5,0,0 -species cell -cell_shape sphere -cell_radius .7 "
         "-cell_centre .2,1.2,1 -cell_shear_modulus 1 -time_end 100 -series_interval .11").split()
SLAB = ("-species cell,plate -plate_shape slab -plate_axis y -plate_interval 0,.6 -plate_shear_modulus 2").split()
ATTACHED = [w for w in FLAT[:FLAT.index("-species")]] + SLAB + FLAT[FLAT.index("-cell_shape"):
                                                                 FLAT.index("-bead_shape")] + FLAT[-4:]
OFTEN = "-checkpoint_interval 1e-9".split()  # after every step
ENDLESS = "-time_step 1e-5 -series_interval 1".split()


class Restart(unittest.TestCase):
    def setUp(self):
        room = tempfile.TemporaryDirectory()
        self.addCleanup(room.cleanup)
        self.room = pathlib.Path(room.name)
        self.environment = {k: v for k, v in os.environ.items() if k != "PETSC_OPTIONS"}
        self.environment.update({"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"})

    def command(self, arguments, ranks):
        return [*([MPIEXEC, "--oversubscribe", "-n", str(ranks)] if ranks else []), BINARY, *map(str, arguments)]

    def call(self, *arguments, ranks=0, **more):
        return subprocess.run(self.command(arguments, ranks), cwd=self.room, env=self.environment, timeout=120,
                              capture_output=True, text=True, **more)

    def start(self, *arguments, ranks=0):
        """A run in the background, in its time loop."""
        process = subprocess.Popen(self.command([*arguments, "-output_dir", "run"], ranks), cwd=self.room,
                                   env=self.environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        self.wait_until(lambda: self.series("run").count("\n") > 1 or process.poll() is not None)
        self.assertIsNone(process.poll(), "ended too early")
        return process

    def wait_until(self, condition):
        limit = time.monotonic() + 60
        while not condition():
            self.assertLess(time.monotonic(), limit)
            time.sleep(0.01)

    def run_case(self, directory, *arguments, ranks=0):
        result = self.call(*arguments, "-output_dir", directory, ranks=ranks)
        self.assertEqual((result.returncode, result.stderr), (0, ""), arguments)
        return self.summary(directory)

    def refused(self, *arguments, says, code=2):
        result = self.call(*arguments)
        self.assertEqual(result.returncode, code, result.stderr)
        self.assertRegex(result.stderr, r"\Aeulastic: error: [^\n]+\n\Z")
        for piece in says:
            self.assertIn(piece, result.stderr)

    def summary(self, directory):
        return json.loads((self.room / directory / "summary.json").read_text())

    def series(self, directory):
        path = self.room / directory / "series.csv"
        return path.read_text() if path.exists() else ""

    def checkpoints(self, directory="run"):
        return sorted((self.room / directory).glob("checkpoint_*.h5"))

    def assert_same(self, one, other, outputs=True):
        """The same state, and the same rows in series.csv and bodies.h5."""
        a, b = self.summary(one), self.summary(other)
        for key in ("state_hash", "steps", "time", "bodies", "acm_sweeps_per_step", "rkl_stages_per_step"):
            self.assertEqual(a[key], b[key], key)
        if not outputs:
            return
        self.assertEqual(self.series(one), self.series(other))
        with h5py.File(self.room / one / "bodies.h5") as x, h5py.File(self.room / other / "bodies.h5") as y:
            for name in x:
                numpy.testing.assert_array_equal(x[name][()], y[name][()], name)
                self.assertEqual(x[name].attrs.get("checksum"), y[name].attrs.get("checksum"), name)


class SameBits(Restart):
    def check(self, case, options, before, after, steps=12):
        end = lambda n: ["-time_steps_max", n]
        self.run_case("whole", *case, *options, *end(2 * steps))
        self.run_case("run", *case, *options, *end(steps), *OFTEN, ranks=before)
        self.assertEqual(self.summary("run")["exit_reason"], "steps")
        shutil.copytree(self.room / "run", self.room / "first")
        self.run_case("run", *case, *options, *end(2 * steps), "-restart", "run", ranks=after)
        self.assert_same("whole", "run")
        # Elsewhere, with other intervals: the state does not care.
        self.run_case("other", *case[:-2], *options, *end(2 * steps), "-restart", "first", "-series_interval", ".05",
                      "-snapshot_interval", ".3")
        self.assert_same("whole", "other", outputs=False)

    def test_flat_fast_acm(self):
        self.check(FLAT, [], before=1, after=4)

    def test_flat_classic_smac(self):
        self.check(ATTACHED, "-method classic -pressure_solver smac".split(), before=3, after=2)

    def test_solid_fast_smac(self):
        self.check(SOLID, ["-pressure_solver", "smac"], before=2, after=3)

    def test_solid_classic_acm(self):
        self.check(SOLID, "-method classic -time_step .013".split(), before=2, after=1, steps=13)

    def test_solid_fast_acm(self):
        self.check(SOLID, [], before=3, after=2)

    def test_attached_fast_acm(self):
        self.check(ATTACHED, "-acm_coarse false -acm_sweeps_max 4".split(), before=0, after=0)

    def test_fluid_alone(self):
        case = FLAT[:FLAT.index("-species")] + FLAT[-4:]
        self.run_case("whole", *case, "-time_steps_max", 20)
        self.run_case("run", *case, "-time_steps_max", 10, *OFTEN)
        self.run_case("run", *case, "-time_steps_max", 20, "-restart", "run")
        self.assertEqual(self.summary("run")["state_hash"], self.summary("whole")["state_hash"])
        self.assertEqual(self.series("run"), self.series("whole"))

    def test_a_later_end(self):
        # The last step to the first end is shortened: the checkpoint is the state before it.
        case = [*FLAT[:-4], "-series_interval", ".11", "-snapshot_interval", ".23"]
        self.run_case("whole", *case, "-time_end", "1.5")
        self.run_case("run", *case, "-time_end", ".83", "-checkpoint_interval", ".5")
        first = self.summary("run")
        self.assertEqual((first["exit_reason"], first["time"]), ("time_end", 0.83))
        with h5py.File(self.checkpoints()[-1]) as file:
            self.assertEqual(file["step"][0], first["steps"] - 1)
            self.assertLess(file["time"][0], 0.83)
        self.run_case("run", *case, "-time_end", "1.5", "-restart", "run")
        self.assert_same("whole", "run")
        names = lambda directory: sorted(p.name for p in (self.room / directory).glob("snapshot*"))
        self.assertEqual(names("run"), names("whole"))
        self.assertEqual((self.room / "run/snapshots.xdmf").read_text(),
                         (self.room / "whole/snapshots.xdmf").read_text())
        self.assertNotIn("-restart", (self.room / "run/options.txt").read_text())

    def test_looking_and_keeping_do_not_touch_the_run(self):
        self.run_case("plain", *FLAT, "-time_steps_max", 15)
        self.run_case("busy", *FLAT[:-2], "-series_interval", ".03", "-snapshot_interval", ".1", "-checkpoint_keep", 3,
                      *OFTEN, "-time_steps_max", 15)
        self.assert_same("plain", "busy", outputs=False)
        self.assertEqual([p.name for p in self.checkpoints("busy")], [f"checkpoint_{n:08}.h5" for n in (13, 14, 15)])

    def test_older_one_by_name(self):
        self.run_case("whole", *FLAT, "-time_steps_max", 16)
        self.run_case("run", *FLAT, "-time_steps_max", 12, "-checkpoint_keep", 9, *OFTEN)
        self.run_case("run", *FLAT, "-time_steps_max", 16, "-restart", "run/checkpoint_00000007.h5")
        self.assert_same("whole", "run")
        # Those after step 7 belonged to a run that is no more.
        self.assertEqual([p.name for p in self.checkpoints()], [f"checkpoint_{n:08}.h5" for n in (4, 5, 6, 7)])
        # At its end already: nothing to do, and the summary says so.
        self.run_case("run", *FLAT, "-time_steps_max", 7, "-restart", "run")
        self.assertEqual((self.summary("run")["exit_reason"], self.summary("run")["steps"]), ("steps", 7))


class Refusals(Restart):
    def test_options(self):
        self.run_case("run", *SOLID, "-time_steps_max", 4, *OFTEN)
        def changed(name, value):
            case = list(SOLID)
            if name in case:
                case[case.index(name) + 1] = value
            else:
                case += [name, value]
            return [*case, "-restart", "run", "-output_dir", "new"]
        for name, value in [("-grid_cells", "12,10,10"), ("-grid_length", "3,2.5,2.3"), ("-boundary_y", "periodic"),
                            ("-cell_radius", ".6"), ("-cell_shear_modulus", "2"), ("-fluid_viscosity", ".4"),
                            ("-wall_zmax_velocity", "0,0,0"), ("-method", "classic"), ("-interface_scheme", "weno5"),
                            ("-cell_placement", "lattice")]:
            with self.subTest(name):
                case = changed(name, value)
                if name == "-cell_placement":
                    at = case.index("-cell_centre")
                    case[at:at + 2] = ["-cell_count", "2,1,1"]
                self.refused(*case, says=[name, "cannot change at a restart"])
        at = SOLID.index("-species")
        self.refused(*SOLID[:at], *SOLID[-4:], "-restart", "run", "-output_dir", "new", says=["-species", "not given"])
        self.refused(*changed("-time_steps_max", "3"), says=["-time_steps_max", "step 4"])
        self.refused(*changed("-time_end", "1e-3"), says=["-time_end", "already"])
        self.refused(*SOLID, "-restart", "nowhere", says=["-restart", "nowhere"])
        self.refused(*SOLID, "-restart", ".", "-output_dir", "new", says=["-restart", "no checkpoint"])
        self.assertFalse((self.room / "new").exists(), "something was written")
        for options in ("-pressure_solver smac", "-acm_memory 0", "-acm_memory 3", "-time_step .01", "-acm_sweeps_max 2"):
            with self.subTest(options):
                shutil.rmtree(self.room / "new", ignore_errors=True)
                self.run_case("new", *SOLID, *options.split(), "-time_steps_max", 6, "-restart", "run")

    def test_damage(self):
        case = [*FLAT, "-time_steps_max", "8", "-checkpoint_keep", "2"]
        self.run_case("whole", *FLAT, "-time_steps_max", 12)
        self.run_case("good", *case, *OFTEN)
        shutil.copytree(self.room / "good", self.room / "run")
        older, newest = self.checkpoints()
        good = newest.read_bytes()
        again = [*FLAT, "-time_steps_max", "12", "-output_dir"]

        def refuse(content, says):
            newest.write_bytes(content)
            self.refused(*again, "new", "-restart", newest, says=["-restart", newest.name, older.name, *says])

        refuse(good[:len(good) // 2], ["damaged or truncated"])
        refuse(b"", ["damaged or truncated"])
        refuse(b"once upon a time\n" * 400, ["not an HDF5 file"])
        with h5py.File(newest, "w") as file:
            file["velocity_x"] = numpy.zeros(3)
        refuse(newest.read_bytes(), ["not a checkpoint of this program"])
        newest.write_bytes(good)
        with h5py.File(newest, "r+") as file:
            file.attrs["format"] = 0
        refuse(newest.read_bytes(), ["format 0", "this program reads format 1"])
        newest.write_bytes(good)
        with h5py.File(newest, "r+") as file:
            file["velocity_x"][0, 3, 4] += 1e-15
        refuse(newest.read_bytes(), ["velocity_x", "checksum"])
        newest.write_bytes(good)
        with h5py.File(newest, "r+") as file:
            del file["pressure"].attrs["checksum"]
        refuse(newest.read_bytes(), ["pressure", "checksum"])

        # A directory: the older one, and it says so.
        result = self.call(*again, "run", "-restart", "run", ranks=2)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stderr, r"\Aeulastic: warning: -restart: [^\n]*" + newest.name + r"[^\n]*\n\Z")
        self.assertIn(older.name, result.stderr)
        self.assert_same("whole", "run")
        for path in self.checkpoints():
            path.unlink()
        newest.write_bytes(good[:5000])
        self.refused(*again, "run", "-restart", "run", says=[newest.name, "no older one"])

    def test_flipped_bits(self):
        self.run_case("whole", *FLAT, "-time_steps_max", 5)
        self.run_case("run", *FLAT, "-time_steps_max", 4, *OFTEN, "-checkpoint_keep", 1)
        path = self.checkpoints()[0]
        good = path.read_bytes()
        random.seed(3)
        refused = 0
        # The first two kilobytes and the names are metadata; anywhere else are mostly values.
        for at in [random.randrange(2048) for _ in range(9)] + [random.randrange(len(good)) for _ in range(9)]:
            bad = bytearray(good)
            bad[at] ^= 1 << random.randrange(8)
            path.write_bytes(bad)
            shutil.rmtree(self.room / "new", ignore_errors=True)
            result = self.call(*FLAT, "-time_steps_max", 5, "-restart", path, "-output_dir", "new")
            with self.subTest(byte=at):
                if result.returncode == 0:  # a bit that nobody reads
                    self.assert_same("whole", "new", outputs=False)
                else:
                    refused += 1
                    self.assertEqual(result.returncode, 2, result.stderr)
                    self.assertRegex(result.stderr, r"\Aeulastic: error: -restart: [^\n]+\n\Z")
        self.assertGreater(refused, 6)


class Ends(Restart):
    def check_stopped(self, process, reason="signal"):
        self.assertEqual(process.wait(60), 0, process.stderr.read())
        summary = self.summary("run")
        self.assertEqual(summary["exit_reason"], reason)
        with h5py.File(self.checkpoints()[-1]) as file:
            self.assertEqual((file["step"][0], file["time"][0]), (summary["steps"], summary["time"]))
        steps = summary["steps"] + 5
        self.run_case("run", *FLAT, *ENDLESS[:2], "-time_steps_max", steps, "-restart", "run")
        self.run_case("whole", *FLAT, *ENDLESS[:2], "-time_steps_max", steps)
        self.assert_same("whole", "run")

    def start_endless(self, ranks=0, options=()):
        return self.start(*FLAT[:-2], *ENDLESS[:2], *options, "-series_interval", ".11", ranks=ranks)

    def test_user_signal_to_mpiexec(self):
        process = self.start_endless(ranks=2)
        process.send_signal(signal.SIGUSR1)
        self.check_stopped(process)

    def test_term_to_one_rank(self):
        process = self.start_endless(ranks=2)
        children = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
        rank = [int(pid) for pid in children if os.readlink(f"/proc/{pid}/exe") == os.path.realpath(BINARY)][-1]
        os.kill(rank, signal.SIGTERM)
        self.check_stopped(process)

    def test_interrupt_without_mpiexec(self):
        process = self.start_endless()
        process.send_signal(signal.SIGINT)
        self.check_stopped(process)

    def test_wall_limit(self):
        process = self.start_endless(options=["-stop_after_minutes", ".01", "-checkpoint_wall_minutes", ".002"])
        self.check_stopped(process, "wall_limit")

    def test_not_finite(self):
        result = self.call(*FLAT, "-method", "classic", "-time_step", "3", *OFTEN, "-output_dir", "run")
        self.assertEqual(result.returncode, 3)
        self.assertIn("not finite", result.stderr)
        self.assertEqual(self.summary("run")["exit_reason"], "nonfinite")
        for path in self.checkpoints():
            with h5py.File(path) as file:
                self.assertTrue(numpy.isfinite(file["velocity_x"][()]).all())

    def test_one_run_per_directory(self):
        process = self.start_endless(options=OFTEN)
        self.wait_until(self.checkpoints)
        for more in (["-restart", "run"], ["-output_overwrite"]):
            self.refused(*FLAT, "-output_dir", "run", *more, says=["run", "in use by another run"])
        process.kill()
        process.wait()
        with h5py.File(self.checkpoints()[-1]) as file:
            step = int(file["step"][0])
        self.run_case("run", *FLAT, *ENDLESS[:2], "-time_steps_max", step + 3, "-restart", "run")


class BrokenPlaces(Restart):
    @contextlib.contextmanager
    def tmpfs(self, options):
        (self.room / "disk").mkdir()
        mount = subprocess.run(["mount", "-t", "tmpfs", "-o", options, "none", self.room / "disk"], capture_output=True,
                               text=True)
        if mount.returncode != 0:
            self.skipTest("cannot mount a tmpfs: " + mount.stderr.strip())
        try:
            yield
        finally:
            subprocess.run(["umount", self.room / "disk"], check=True)

    def check_full(self, returncode, errors):
        self.assertEqual(returncode, 1, errors)
        lines = [line for line in errors.splitlines() if line.startswith("eulastic: error:")]
        self.assertEqual(len(lines), 1, errors)
        self.assertRegex(lines[0], "No space left|disk full|File too large")

    def check_goes_on(self, directory, *options):
        steps = int(self.checkpoints(directory)[-1].stem.split("_")[1]) + 3
        self.run_case("whole", *FLAT, *options, "-time_steps_max", steps)
        self.run_case("new", *FLAT, *options, "-time_steps_max", steps, "-restart", directory)
        self.assert_same("whole", "new", outputs=False)

    def test_full_disk(self):
        with self.tmpfs("size=700k"):
            result = self.call(*FLAT, "-time_steps_max", 400, *OFTEN, "-snapshot_interval", ".02", "-output_dir",
                               "disk/run", ranks=2)
            self.check_full(result.returncode, result.stderr)
            self.check_goes_on("disk/run")

    def test_files_that_may_not_grow(self):
        process = self.start(*FLAT, *ENDLESS[:2], *OFTEN)
        self.wait_until(self.checkpoints)
        resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (10000, 10000))
        self.check_full(process.wait(60), process.stderr.read())
        self.assertEqual(self.summary("run")["exit_reason"], "output_failed")
        self.check_goes_on("run", *ENDLESS[:2])

    def test_read_only(self):
        with self.tmpfs("ro,size=1m"):
            self.refused(*FLAT, "-output_dir", "disk/run", says=["disk/run", "Read-only"])
        (self.room / "file").write_text("")
        self.refused(*FLAT, "-output_dir", "file", says=["file", "not a directory"])
        self.refused(*FLAT, "-output_dir", "file/run", says=["file/run"])

    def test_directory_goes_away(self):
        process = self.start(*FLAT, *ENDLESS[:2], "-checkpoint_wall_minutes", ".001")
        shutil.rmtree(self.room / "run")
        self.assertEqual(process.wait(60), 1)
        self.assertRegex(process.stderr.read(), r"\Aeulastic: error: [^\n]*run/[^\n]*No such file[^\n]*\n\Z")


class Kills(Restart):
    def test_semaphore_of_a_killed_run(self):
        # As Open MPI leaves it in shared memory: 32 bytes, locked.
        left = pathlib.Path("/dev/shm/sem.OMPIO_checkpoint_00000003.h5.tmp")
        if not left.parent.is_dir():
            self.skipTest("no /dev/shm")
        left.write_bytes(bytes(32))
        self.addCleanup(left.unlink)
        self.run_case("run", *FLAT, "-time_steps_max", 4, *OFTEN, ranks=2)

    def test_kills(self):
        result = subprocess.run([sys.executable, ROOT / "scripts/kill_test", "20", "--seed", "5"], env=self.environment,
                                capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertRegex(result.stdout, r"\A20 kills ")


if __name__ == "__main__":
    unittest.main()
