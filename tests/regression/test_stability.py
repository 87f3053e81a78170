#!/usr/bin/python3
"""The judge of scripts/studies/stability/stability_map: with moving walls, energy that is made is a death, energy that was paid for is not.

Needs EULASTIC.
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import types
import unittest

import numpy

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / folder) for folder in ("scripts", "scripts/studies/stability", "tests/support")]
sys.dont_write_bytecode = True
from eulastic import Run  # noqa: E402
from full import full  # noqa: E402
from stability_judge import MADE, energy_growth, energy_made, judge, surface_energy_made  # noqa: E402
from stability_scenes import contact, corner  # noqa: E402

TIME = numpy.linspace(0, 1, 101)


def driven(kinetic, elastic, power):
    """A run of fluid and a solid, G = 100, in a unit box with a wall at speed 1: the kinetic bound is 2."""
    series = types.SimpleNamespace(time=TIME, kinetic_energy=kinetic, elastic_energy=elastic, force_power=0 * TIME,
                                   wall_power=power + 0 * TIME)
    options = {"boundary_ymax_velocity": "1,0,0", "a_shear_modulus": "100", "body_force": "0,0,0"}
    return types.SimpleNamespace(series=series, options=options, length=(1, 1, 1), cells=(32, 32, 1))


class Map(unittest.TestCase):
    @full
    def test_scenes_shaken(self):
        """--shake, as docs/stability.md has it, of one group of the reduced set."""
        page = (ROOT / "docs/stability.md").read_text()
        done = subprocess.run([ROOT / "scripts/studies/stability/stability_map", "--quick", "--shake", "1", "--group", "flat_cells"],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertRegex(done.stdout, r"[1-9]\d* scenes at the automatic time step, 0 failed")
        self.assertEqual((ROOT / "docs/stability.md").read_text(), page)


class Judge(unittest.TestCase):
    def test_what_is_given_back_was_not_made(self):
        """A wall of power 20 stretches the solid to 13.5 until t = .7; half of it becomes motion at once, and is lost."""
        before = TIME < .7
        run = driven(numpy.where(before, .5, 7 * numpy.exp(-20 * (TIME - .7))), numpy.where(before, 20 * TIME - .5, 7), 20)
        self.assertLess(energy_made(run.series).max(), .6)  # the .5 that is there in the first row is not paid for
        self.assertGreater(run.series.kinetic_energy.max(), 2 * 2)
        self.assertLessEqual(energy_growth(run), 1)

    def test_what_membranes_make_counts_at_its_worst(self):
        """Membranes that make 3 of the 20 that come in, and lose it again."""
        lost = types.SimpleNamespace(energy_lost_elastic=numpy.where(TIME < .7, -3 * TIME / .7, 5))
        made = surface_energy_made(types.SimpleNamespace(series=lost, summary={"energy_supplied": 20}))
        self.assertAlmostEqual(made, 3 * TIME[TIME < .7].max() / .7 / 20)
        self.assertGreater(made, MADE)

    def test_motion_from_nothing_is_made(self):
        """The same motion without the solid, or from a solid that keeps what it has."""
        burst = numpy.where(TIME < .7, .5, 7 * numpy.exp(-20 * (TIME - .7)))
        self.assertGreater(energy_growth(driven(burst, 0 * TIME, .5)), 2.7)
        self.assertGreater(energy_growth(driven(burst, numpy.minimum(20 * TIME, 14), numpy.where(TIME < .7, 20, 0))), 2.7)

    def test_old_work_pays_for_nothing(self):
        """The wall has done work of 20, which viscosity has taken, before motion comes from nothing."""
        self.assertGreater(energy_growth(driven(numpy.where(TIME < .9, .5, 3), 0 * TIME, 20 * (TIME < .5))), 1.1)

    def test_slow_flow_is_not_looked_at(self):
        self.assertLessEqual(energy_growth(driven(1 + TIME, 0 * TIME, 0)), 1)


class Scenes(unittest.TestCase):
    """Two whose solids hold an energy of 20 and more, and give back enough to move all fluid faster than its wall."""

    def live(self, options, method):
        with tempfile.TemporaryDirectory() as room:
            words = [w for k, v in (options | {"method": method, "guard_volume_drift": 0}).items() for w in ("-" + k, str(v))]
            done = subprocess.run([os.environ["EULASTIC"], *words, "-output_dir", room + "/run", "-snapshot_precision", "double",
                                   "-snapshot_fields", "solid_fraction,left_cauchy_green", "-snapshot_interval", "1"],
                                  capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(judge(room + "/run", method)[0], "")
            series = Run(room + "/run").series
        energy = series.kinetic_energy + series.elastic_energy
        self.assertGreater(energy.max(), 10, "no such scene any more")
        fast = series.kinetic_energy > 2
        self.assertFalse((energy_made(series)[fast] > MADE * energy[fast]).any())

    def test_box_of_solid_under_a_lid(self):
        self.live(contact("box of solid, lid", 100), "fast")

    def test_disc_in_the_corner(self):
        self.live(corner(24, 100), "classic")


if __name__ == "__main__":
    unittest.main()
