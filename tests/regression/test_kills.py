#!/usr/bin/python3
"""Kills: the last complete checkpoint suffices.

Needs EULASTIC=path of the binary and EULASTIC_MPIEXEC.
"""
import pathlib
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from full import FULL  # noqa: E402
from restart_case import ROOT, FLAT, OFTEN, Restart  # noqa: E402

KILLS = 20 if FULL else 5


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
        result = subprocess.run([sys.executable, ROOT / "scripts/dev/kill_test", str(KILLS), "--seed", "5"], env=self.environment,
                                capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertRegex(result.stdout, rf"\A{KILLS} kills ")


if __name__ == "__main__":
    unittest.main()
