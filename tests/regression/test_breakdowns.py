#!/usr/bin/python3
"""Signals, limits and full disks: what a run does when something breaks.

Needs EULASTIC=path of the binary and EULASTIC_MPIEXEC.
"""
import contextlib
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import sys
import unittest

import h5py

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from program import BINARY, MPIEXEC  # noqa: E402
from restart_case import ENDLESS, FLAT, OFTEN, Restart  # noqa: E402


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

    def start_endless(self, ranks=0, options=(), **more):
        return self.start(*FLAT[:-2], *ENDLESS[:2], *options, "-series_interval", ".11", ranks=ranks, **more)

    def ranks(self, process):
        children = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
        return [int(pid) for pid in children if os.readlink(f"/proc/{pid}/exe") == os.path.realpath(BINARY)]

    def kill_all(self, process):
        """SIGKILL to mpiexec and its ranks; returns when none of them runs any more."""
        ranks = self.ranks(process)
        for pid in [process.pid, *ranks]:
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        process.wait(60)

        def ended(pid):
            try:
                return pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
            except OSError:
                return True

        self.wait_until(lambda: all(map(ended, ranks)))

    def test_user_signal_to_mpiexec(self):
        process = self.start_endless(ranks=2)
        process.send_signal(signal.SIGUSR1)
        self.check_stopped(process)

    def test_term_to_one_rank(self):
        process = self.start_endless(ranks=2)
        os.kill(self.ranks(process)[-1], signal.SIGTERM)
        self.check_stopped(process)

    def test_term_to_mpiexec(self):
        # Open MPI kills after about a second, whatever the ranks are at: what is complete must suffice.
        process = self.start_endless(ranks=2, options=OFTEN)
        self.wait_until(lambda: len(self.checkpoints()) == 2)
        process.terminate()
        process.wait(60)
        step = int(self.checkpoints()[-1].stem.split("_")[1])
        self.run_case("run", *FLAT, *ENDLESS[:2], "-time_steps_max", step + 5, "-restart", "run", ranks=2)
        self.run_case("whole", *FLAT, *ENDLESS[:2], "-time_steps_max", step + 5)
        self.assert_same("whole", "run")

    def test_interrupt_without_mpiexec(self):
        process = self.start_endless()
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.stderr.read(), "eulastic: SIGINT: ends after this step, with a checkpoint\n")
        self.check_stopped(process)

    def test_a_word_after_a_signal(self):
        """Under mpiexec, which sends SIGTERM to the ranks whatever it gets; the command it names goes on."""
        for number in signal.SIGINT, signal.SIGTERM, signal.SIGUSR1:
            with self.subTest(number):
                shutil.rmtree(self.room / "run", ignore_errors=True)
                with open(self.room / "log", "w") as log:
                    process = self.start_endless(ranks=2, stdout=log)
                    process.send_signal(number)
                    process.wait(60)
                summary, last = self.summary("run"), (self.room / "log").read_text().splitlines()[-1]
                self.assertEqual(summary["exit_reason"], "signal")
                self.assertEqual(summary["checkpoint"], self.checkpoints()[-1].name)
                self.assertIn(f"stopped by a signal at t = {summary['time']:.9g}, step {summary['steps']}; results: run; ", last)
                self.assertIn(": ends after this step, with a checkpoint\n", process.stderr.read())
                command = last.split(summary["checkpoint"] + ": ")[1].replace("mpiexec", MPIEXEC)
                again = subprocess.run(f"{command} -time_steps_max {summary['steps'] + 3}", shell=True, cwd=self.room,
                                       env=self.environment, capture_output=True, text=True, timeout=120)
                self.assertEqual((again.returncode, again.stderr), (0, ""))
                self.assertEqual(self.summary("run")["steps"], summary["steps"] + 3)

    def test_killed_at_any_moment(self):
        """SIGKILL leaves no time for a word: what is there already says that the run is unfinished, and what it has."""
        process = self.start_endless(ranks=2)
        self.wait_until(lambda: (self.room / "run/summary.json").exists())
        self.assertEqual((self.summary("run")["exit_reason"], self.summary("run")["checkpoint"]), ("unfinished", ""))
        # The ranks too: without mpiexec they live for a moment, in which they would write to the directory of the next run.
        self.kill_all(process)
        shutil.rmtree(self.room / "run")
        process = self.start_endless(ranks=2, options=["-checkpoint_interval", "1e-3"])
        self.wait_until(lambda: len(self.checkpoints()) == 2 and self.summary("run")["checkpoint"])
        self.kill_all(process)
        summary = self.summary("run")
        self.assertEqual(summary["exit_reason"], "unfinished")
        with h5py.File(self.room / "run" / summary["checkpoint"]) as file:
            self.assertEqual((file["step"][0], file["time"][0]), (summary["steps"], summary["time"]))
        self.run_case("run", *FLAT, *ENDLESS[:2], "-time_steps_max", summary["steps"] + 200, "-restart", "run")

    def test_wall_limit(self):
        process = self.start_endless(options=["-stop_after_minutes", ".01", "-checkpoint_wall_minutes", ".002"])
        self.check_stopped(process, "wall_limit")

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

    def check_full(self, returncode, errors, directory):
        self.assertEqual([path.name for path in (self.room / directory).glob("*.tmp")], [])
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
            self.check_full(result.returncode, result.stderr, "disk/run")
            self.check_goes_on("disk/run")

    def test_files_that_may_not_grow(self):
        process = self.start(*FLAT, *ENDLESS[:2], *OFTEN)
        self.wait_until(self.checkpoints)
        resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (10000, 10000))
        self.check_full(process.wait(60), process.stderr.read(), "run")
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
        (self.room / "run").rename(self.room / "gone")  # at once: while files are removed one by one, new ones come
        self.assertEqual(process.wait(60), 1)
        self.assertRegex(process.stderr.read(), r"\Aeulastic: error: [^\n]*run/[^\n]*No such file[^\n]*\n\Z")


if __name__ == "__main__":
    unittest.main()
