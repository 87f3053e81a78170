"""scripts/compare_pressure_solvers on known data and on runs. Needs EULASTIC."""
import os
import pathlib
import sys
import unittest

import matplotlib.image

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from test_scripts import ROOT, SCRIPTS, Run, Units, WithFolder, load, start, synthetic_run  # noqa: E402


class Comparison(WithFolder):
    def test_comparison_takes_its_options_anywhere(self):
        echo = self.folder / "program"
        echo.write_text('#!/bin/sh\necho "got $*"; exit 1\n')
        echo.chmod(0o755)
        case = ROOT / "options/disc_in_channel.opts"
        done = start(SCRIPTS / "compare_pressure_solvers", case, "-body_force", "-1,0,0", "--output", "x", "-time_end", "1",
                     env=dict(os.environ, EULASTIC=str(echo)), cwd=self.folder)
        self.assertIn("compare_pressure_solvers: the run with acm failed", done.stderr)
        self.assertNotIn("error: unrecognized", done.stderr)
        self.assertFalse((self.folder / "output").exists())

    def test_comparison(self):
        faster = synthetic_run.write_run(self.folder / "faster", speed=1.01 * synthetic_run.SPEED, pressure_offset=3.0)
        other = Run(faster)
        compare = load("compare_pressure_solvers")
        run = Run(synthetic_run.write_run(self.folder / "run"))
        self.assertIn("travelled: 1.00e-02", compare.body_table(other, run)[-1])
        pressure = compare.field_table(other, run)[-1]
        self.assertIn("pressure", pressure)
        self.assertLess(float(pressure.split()[-1]), 1e-6)  # a constant is no difference
        compare.draw(other, run, [None, None], Units("")).savefig(self.folder / "comparison.png")

    def test_comparison_in_2d_and_at_rest(self):
        """Both solvers draw the disc and its speed; where nothing moves all differences are 0 or have no scale."""
        case = self.folder / "case.opts"
        case.write_text("-grid_cells 16,16,1\n-boundary_y wall\n-species disc\n-disc_shape sphere\n-disc_radius 0.25\n-disc_shear_modulus 1\n"
                        "-time_end 0.1\n-time_step 0.02\n-snapshot_interval 0.1\n-pressure_solver smac\n")
        for name, words in (("moves", ("-body_force", "1,0,0")), ("rests", ()), ("box", ("-grid_cells", "8,8,8"))):
            folder = self.folder / name
            done = start(SCRIPTS / "compare_pressure_solvers", case, *words, "--output", folder, cwd=self.folder)
            self.assertEqual((done.returncode, done.stderr), (0, ""), name)
            table = (folder / "comparison.txt").read_text()
            self.assertNotRegex(table, r"\b(nan|inf)\b")
            velocity = next(line for line in table.splitlines() if line.strip().startswith("velocity"))
            if name == "moves":
                self.assertLess(float(velocity.split()[-1]), 1e-3)
            else:
                self.assertLess(float(velocity.split()[2]), 1e-15)
                self.assertEqual(velocity.split()[-1], "-")  # round-off over round-off says nothing
                self.assertEqual(float(table.split("distance travelled: ")[1].split()[0]), 0)
            picture = matplotlib.image.imread(folder / "comparison.png")[..., :3]
            top = picture[:picture.shape[0] // 2]
            for half in (top[:, :top.shape[1] // 2], top[:, top.shape[1] // 2:]):
                self.assertGreater((half.max(axis=2) - half.min(axis=2) > 0.2).sum(), 10000, name)


if __name__ == "__main__":
    unittest.main()
