#!/usr/bin/python3
"""docs/tutorial.md, typed from beginning to end by scripts/dev/tutorial; the runs are cut short from outside, through
PETSC_OPTIONS, which the commands do not say anything against."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import matplotlib.image
from PIL import Image

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "scripts"), str(ROOT / "scripts/lib")]
sys.dont_write_bytecode = True
from read_page import blocks, commands, file_name, is_python  # noqa: E402
from eulastic import Run  # noqa: E402

PAGE = ROOT / "docs/tutorial.md"


def pictures():
    return {path: path.stat().st_mtime_ns for path in (ROOT / "docs/images").iterdir()}


class Tutorial(unittest.TestCase):
    def test_every_command(self):
        with tempfile.TemporaryDirectory() as room:
            room = pathlib.Path(room)
            before = pictures()
            done = subprocess.run([ROOT / "scripts/dev/tutorial", "--folder", room / "clone"],
                                  env=dict(os.environ, PETSC_OPTIONS="-time_steps_max 2"), capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            self.assertEqual(pictures(), before, "scripts/dev/tutorial changed the clone")
            wanted = re.findall(r"images/(tutorial_\w+\.png)", PAGE.read_text())
            self.assertGreaterEqual(len(wanted), 5)
            self.assertEqual(sorted(path.name for path in (room / "clone/docs/images").iterdir()), sorted(wanted))
            for name in wanted:
                picture = matplotlib.image.imread(room / "clone/docs/images" / name)[..., :3]
                self.assertGreater((picture < 0.7).any(axis=2).sum(), 1000, name)
            runs = {name: Run(room / "clone/output" / name) for name in ("first", "pair", "vessel", "capillary")}
            self.assertEqual({run.summary["exit_reason"] for run in runs.values()}, {"steps"})
            self.assertEqual([len(runs[name].bodies.id) for name in ("first", "pair")], [16, 2])
            self.assertEqual(set(runs["vessel"].bodies.species), {"vessel", "platelet", "rbc"})
            cells = runs["capillary"].bodies.volume[0, runs["capillary"].bodies.species == "rbc"].sum()
            lumen = 3.14159265 * 12 ** 2 * runs["capillary"].length[0]
            self.assertAlmostEqual(cells / lumen, 0.2, delta=0.004)
            with Image.open(room / "clone/output/capillary.gif") as film:
                self.assertEqual(film.n_frames, 2)
            self.assertIn("flow rate:", done.stdout)

    def test_no_directory_of_the_readme(self):
        of = lambda page: set(re.findall(r"output/\w+", (ROOT / page).read_text()))  # noqa: E731
        self.assertLessEqual(of("README.md") & of("docs/tutorial.md"), {"output/channel_rbc"})  # scripts/quickstart's

    def test_the_page_is_read_as_it_is_meant(self):
        found = list(blocks(PAGE))
        self.assertEqual([name for before, _ in found if (name := file_name(before))], ["pair.csv", "pair.opts", "vessel.opts"])
        self.assertEqual(sum(is_python(block) for _, block in found), 1)
        typed = [line for before, block in found if not file_name(before) for line in commands(block)]
        self.assertEqual(sum(line.startswith("scripts/run ") for line in typed), 5)
        self.assertIn("scripts/quickstart", typed)


if __name__ == "__main__":
    unittest.main()
