"""The study of adhesion in its short form, what Python reads of the bonds of its runs, and bonds in pictures. Needs EULASTIC."""
import pathlib
import re
import shutil
import sys
import unittest

import matplotlib.image
import numpy

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from full import full  # noqa: E402
from test_scripts import SCRIPTS, WithFolder, load, start  # noqa: E402
from eulastic import Run  # noqa: E402


class AdhesionStudy(WithFolder):
    def test_exact_drag(self):
        """Between the values of the table, at one of them, and far from the wall, where F* tends to 1 + 9/16 a/h."""
        study = load("studies/adhesion/adhesion_study")
        force, torque = study.exact(1.5431)
        self.assertAlmostEqual(force, 6 * numpy.pi * 1.5431 * study.SHEAR * 1.4391)
        self.assertAlmostEqual(torque, 4 * numpy.pi * study.SHEAR * 0.97419)
        for height, value in zip(study.H_OVER_A[-2:], study.FORCE[-2:]):
            self.assertLess(abs(value / (1 + 9 / 16 / height) - 1), 0.04)
        moving = study.exact(2.3524, 0.1)[0]
        self.assertAlmostEqual(study.exact(2.3524)[0] - moving, 6 * numpy.pi * 0.1 * 1.3079)

    @full
    def test_short_runs(self):
        made = start(SCRIPTS / "studies/adhesion/adhesion_study", "--quick", "--keep", self.folder).stdout
        tether = re.search(r"^\| 4 \| (\d+) \| ([\d.]+) \| ([\d.]+) \| ([\d.]+) \|", made, re.MULTILINE)
        self.assertGreater(int(tether[1]), 50)
        self.assertTrue(0.2 < float(tether[4]) < 1.2, made)  # still under way to the drag at rest
        rows = re.findall(r"^\| (2500|40000) \| 6 of 6 \| \d \| ([\d.]+) \| ([\d.]+) \| ([\d.]+) \|", made, re.MULTILINE)
        self.assertEqual([row[0] for row in rows], ["2500", "40000"], made)
        self.assertGreater(float(rows[1][1]), 5 * float(rows[0][1]))
        self.assertGreater(float(rows[1][3]), float(rows[0][3]))
        self.assertRegex(made, r"(?m)^\| 0.8 \| [\d.]+ \| \d+ \| holds \| holds \|$")
        broken = re.search(r"^\| 1.2 \| [\d.]+ \| \d+ \| (\d+) \| (\d+) \|$", made, re.MULTILINE)
        self.assertTrue(0.95 < int(broken[1]) / int(broken[2]) < 1.25, made)
        self.assertRegex(made, r"(?m)^\| 1 \| \d+ \| [\d.]+ % \|$")
        for name in ("tether", "threshold", "detachment", "arrest"):
            self.assertTrue((self.folder / f"adhesion_{name}.png").exists(), name)
        self.check_bonds(self.folder / "tether_4")

    @full
    def test_tethered_sphere_comes_to_rest(self):
        """With 4 cells per radius: held by its bonds the sphere neither slips nor turns, and they carry the drag and the torque of a
        rigid sphere within the error of this grid, of first order."""
        study = load("studies/adhesion/adhesion_study")
        case = study.sphere(4, self.folder / "held", study.START, *study.TETHERS.split(), "-time_end", "16")
        height, speed = case.bodies.centroid[-1, 0, 1], case.bodies.velocity[-1, 0, 0]
        fixed = study.sphere(4, self.folder / "fixed", height, "-ball_law", "rigid", "-time_end", "5")
        force, torque = study.pull(case)
        self.assertLess(abs(speed / (study.SHEAR * height)), 0.04)
        self.assertLess(abs(-force[0] / fixed.bodies.force[-1, 0, 0] - 1), 0.06)
        self.assertLess(abs(abs(torque[2] / fixed.bodies.torque[-1, 0, 2]) - 1), 0.1)

    def test_threshold_of_bell(self):
        """0.7178 N_0/x at k_on/k_off = 4; the rate equation without force keeps four fifths of the bonds, with far too much force none."""
        study = load("studies/adhesion/adhesion_study")
        self.assertAlmostEqual(study.largest_force(1000) * study.COMPLIANCE / 1000, 0.7178, places=4)
        self.assertEqual(study.rupture_time(1000, 0), numpy.inf)
        self.assertLess(study.rupture_time(1000, 3 * study.largest_force(1000)), study.PULSE / 4)

    def check_bonds(self, directory):
        """All tables agree with each other; without the bonds the picture is another one."""
        run = Run(directory)
        pull, _ = load("studies/adhesion/adhesion_study").pull(run)
        last = run.series[-1]
        self.assertEqual(len(run.snapshots[-1].bonds()), last.bonds)
        self.assertEqual(run.bodies.bonds[-1, 0], last.bonds)
        numpy.testing.assert_allclose(pull, [last.bond_force_x, last.bond_force_y, last.bond_force_z], rtol=1e-9, atol=1e-9)
        numpy.testing.assert_allclose(pull, run.bodies.bond_force[-1, 0], rtol=1e-9, atol=1e-9)
        formed, broken = ((run.adhesion_events.formed == value).sum() for value in (1, 0))
        self.assertEqual((formed, broken), (last.bonds_formed, last.bonds_broken))
        self.assertEqual((formed - broken, broken), (last.bonds, 0))
        self.assertEqual(len(run.snapshots[0].bonds()), 0)
        copy = self.folder / "without"
        shutil.copytree(directory, copy)
        (copy / "adhesion_bonds.csv").unlink()
        self.assertIsNone(Run(copy).snapshots[-1].bonds())
        pictures = []
        for folder in (directory, copy):
            start(SCRIPTS / "render", folder, "--size", 400, 300, "--plain")
            pictures.append(matplotlib.image.imread(folder / "bodies.png")[..., :3])
        self.assertGreater((abs(pictures[0] - pictures[1]).max(axis=-1) > 0.1).sum(), 20)


if __name__ == "__main__":
    unittest.main()
