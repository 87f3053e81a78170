#!/usr/bin/python3
"""Signals, a reader of the output that leaves, a disk that is full from the start: every end has one line and an exit code.

Needs EULASTIC and EULASTIC_MPIEXEC.
"""
import pathlib
import resource
import signal
import subprocess
import sys
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from restart_case import ENDLESS, FLAT, Restart  # noqa: E402

DISC = ("-grid_cells 24,16,1 -grid_length 1.5,1,1 -body_force 1,0,0 -species b -b_shape sphere -b_radius .2 -b_shear_modulus 1 "
        "-time_end 1 -output_dir run").split()


class Ends(Restart):
    def ends_with_a_checkpoint(self, process, name):
        self.assertEqual(process.wait(60), 0)
        self.assertRegex(process.stderr.read(), rf"\Aeulastic: {name}: ends after this step, with a checkpoint\n\Z")
        self.assertEqual(self.summary("run")["exit_reason"], "signal")
        self.assertEqual(len(self.checkpoints()), 1)
        for path in sorted((self.room / "run").iterdir()):
            path.unlink()

    def test_signals(self):
        for name in "SIGTERM", "SIGINT", "SIGHUP", "SIGPIPE", "SIGXCPU", "SIGUSR1", "SIGUSR2":
            with self.subTest(name):
                process = self.start(*FLAT[:-4], *ENDLESS, "-time_end", 100)
                process.send_signal(getattr(signal, name))
                self.ends_with_a_checkpoint(process, name)

    def test_a_reader_that_leaves(self):
        process = self.start(*FLAT[:-4], *ENDLESS, "-time_end", 100, stdout=subprocess.PIPE)
        process.stdout.close()
        self.assertEqual(process.wait(120), 0)
        self.assertIn("SIGPIPE: ends after this step", process.stderr.read())
        self.assertEqual(self.summary("run")["exit_reason"], "signal")

    def test_nohup(self):
        before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
        try:
            process = self.start(*FLAT[:-4], *ENDLESS, "-time_end", 100)
        finally:
            signal.signal(signal.SIGHUP, before)
        process.send_signal(signal.SIGHUP)
        time.sleep(.2)
        process.send_signal(signal.SIGTERM)  # the first that is heard has the word
        self.ends_with_a_checkpoint(process, "SIGTERM")

    def test_a_disk_that_is_full_from_the_start(self):
        for kilobytes in (20, 40, 8):
            with self.subTest(kilobytes=kilobytes):
                limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (kilobytes * 1024,) * 2)  # noqa: E731, B023
                result = self.call(*DISC, "-output_overwrite", preexec_fn=limit)
                self.assertEqual(result.returncode, 1, result.stderr)
                self.assertRegex(result.stderr, r"\Aeulastic: error: [^\n]+\n\Z")


if __name__ == "__main__":
    unittest.main()
