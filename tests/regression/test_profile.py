"""scripts/profile: every second of a step is in one share, two runs beside one another, kept runs are replaced. Needs EULASTIC."""
import importlib.machinery
import importlib.util
import pathlib
import subprocess
import sys
import tempfile
import unittest

import matplotlib.image
import numpy

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPTS = ROOT / "scripts"
sys.path.insert(0, str(SCRIPTS))
sys.dont_write_bytecode = True
loader = importlib.machinery.SourceFileLoader("profile_script", str(SCRIPTS / "profile"))
profile = importlib.util.module_from_spec(importlib.util.spec_from_loader("profile_script", loader))
loader.exec_module(profile)


def start(*command):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=300)


class Profile(unittest.TestCase):
    def setUp(self):
        room = tempfile.TemporaryDirectory()
        self.addCleanup(room.cleanup)
        self.room = pathlib.Path(room.name)

    def test_words(self):
        for event, text in (("EulLeftCauchy", "left Cauchy"), ("EulACM", "ACM"), ("EulWallGhosts", "wall ghosts")):
            self.assertEqual(profile.words(event), text)

    def test_shares_beside_another(self):
        case = ROOT / "options/disc_in_channel.opts"
        command = (SCRIPTS / "profile", case, "--output", self.room, "--steps", 6, "--beside", "-method classic",
                   "-grid_cells", "64,64,1")
        done = start(*command)
        self.assertEqual(done.returncode, 0, done.stderr)
        names = "disc_in_channel_-grid_cells_64,64,1", "disc_in_channel_-grid_cells_64,64,1_-method_classic"
        fast, classic = (profile.Profile(self.room / name, name) for name in names)
        for one in fast, classic:
            self.assertAlmostEqual(sum(part[0] for part in one.parts.values()), 1, places=12)
            self.assertEqual((one.ranks, one.run.summary["steps"]), (2, 6))
            self.assertGreater(one.parts["exchange"][3], 0)
            self.assertGreater(one.parts["waiting"][1], 0)
            wall = one.run.summary["wall_seconds"]  # without output, as the steps are
            self.assertAlmostEqual(one.seconds / wall, 1, delta=0.5)
        self.assertIn("viscous", fast.parts)
        self.assertNotIn("viscous", classic.parts)
        for text in "share", "waiting", "left Cauchy", "-method classic":
            self.assertIn(text, done.stdout)
        picture = matplotlib.image.imread(self.room / "profile.png")[..., :3]
        self.assertGreater((numpy.ptp(picture, axis=2) > 0.3).sum(), 10000)
        for steps in 8, 3:  # more or fewer than the run that is there
            again = start(*command[:-4], "--steps", steps, "--beside", self.room / names[1], "-grid_cells", "64,64,1")
            self.assertEqual(again.returncode, 0, again.stderr)
            one = profile.Profile(self.room / names[0], names[0])
            self.assertEqual(one.run.summary["steps"], steps)
            self.assertAlmostEqual(one.seconds / one.run.summary["wall_seconds"], 1, delta=0.5)
            self.assertIn(f" {steps} steps of {1e3 * one.seconds / steps:.3g} ms", again.stdout)
            self.assertIn(" 6 steps of ", again.stdout)
            self.assertNotIn("goes on", again.stderr)
        for wrong in ("--beside", self.room), ("--steps", "0"), ("-nonsense", "1"):
            done = start(SCRIPTS / "profile", case, "--output", self.room / "new", *wrong)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertFalse((self.room / "new").exists())


if __name__ == "__main__":
    unittest.main()
