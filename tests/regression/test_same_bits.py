#!/usr/bin/python3
"""The same bits on 1 to 4 ranks, with threads, after a restart, with nothing skipped and with AVX-512 or without: scenes that
together contain every pair of features (tests/support/scene_pairs.py), and scenes that are difficult in one respect.

Needs EULASTIC_RUN_MANY, EULASTIC_RUN_MANY_AVX2 and EULASTIC_MPIEXEC.
"""
import math
import pathlib
import sys
import tempfile
import unittest

import h5py

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path[:0] = [str(ROOT / "scripts"), str(ROOT / "tests/support")]
import scene_pairs  # noqa: E402
from eulastic import Run  # noqa: E402
from many_runs import Plan  # noqa: E402
from processor import has_avx512  # noqa: E402

CANDIDATES, SEED = 700, 1
STEPS = 4


class WithRoom(unittest.TestCase):
    def setUp(self):
        room = tempfile.TemporaryDirectory()
        self.addCleanup(room.cleanup)
        self.room = pathlib.Path(room.name)

    def results(self, outcomes, name):
        self.assertEqual(outcomes[name].code, 0, f"{name}: {outcomes[name].err}")
        return outcomes[name].results()

    def assert_same(self, outcomes, name, ways):
        """All results of `name` and of the ways, names of runs, are equal."""
        one = self.results(outcomes, name)
        for way in ways:
            other = self.results(outcomes, way)
            for what in one:
                self.assertEqual(other.get(what), one[what], f"{way}: {what}")
        return one


class PairedScenes(WithRoom):
    def chosen(self):
        """{name: (values, words)} of the scenes, and the number of pairs that they contain."""
        places = scene_pairs.files(self.room)
        plan = Plan(self.room)
        found = scene_pairs.candidates(CANDIDATES, SEED)
        for n, values in enumerate(found):
            plan.add(f"check{n}", *scene_pairs.words(values, places), "-check_only", output=False)
        outcomes = plan.execute()
        accepted = [values for n, values in enumerate(found) if outcomes[f"check{n}"].code == 0]
        self.assertGreater(len(accepted), CANDIDATES / 4)
        scenes = scene_pairs.cover(accepted)
        covered = set().union(*map(scene_pairs.pairs, scenes))
        self.assertEqual(covered, set().union(*map(scene_pairs.pairs, accepted)))
        for feature, values in scene_pairs.FEATURES.items():  # nothing that a table names is refused altogether
            for value in values:
                self.assertTrue(any((feature, value) in pair for pair in covered), f"{feature}: {value}")
        return {f"scene{n}": (values, scene_pairs.words(values, places)) for n, values in enumerate(scenes)}, len(covered)

    def test_every_pair(self):
        scenes, covered = self.chosen()
        whole = lambda words, *more: [*words, "-time_steps_max", STEPS, *more]
        plan, alone = Plan(self.room), Plan(self.room, ranks=1)
        for name, (_, words) in scenes.items():
            plan.add(name, *whole(words))
            for ranks in (2, 3, 4):
                plan.add(f"{name}_ranks{ranks}", *whole(words), ranks=ranks)
            plan.add(f"{name}_threads", *whole(words, "-threads", 3))
            plan.add(f"{name}_whole", *whole(words), skip_nothing=True)
            plan.add(f"{name}_half", *words, "-time_steps_max", STEPS // 2)
            alone.add(f"{name}_avx2", *whole(words))
        plan.wait()
        for n, (name, (_, words)) in enumerate(scenes.items()):
            plan.add(f"{name}_restarted", *whole(words, "-restart", self.room / f"{name}_half"), ranks=1 + n % 3)
        outcomes = plan.execute()
        if has_avx512():
            outcomes |= alone.execute("EULASTIC_RUN_MANY_AVX2")
        else:
            print("skipped: without AVX-512, which this processor does not have")
        ran = 0
        for name, (values, words) in scenes.items():
            with self.subTest(f"{name}: {values}\n{' '.join(words)}"):
                ways = [f"{name}_{way}" for way in ("ranks2", "ranks3", "ranks4", "threads", "whole")]
                one = self.assert_same(outcomes, name, ways + [f"{name}_avx2"] * has_avx512())
                restarted = self.results(outcomes, f"{name}_restarted")
                self.assertEqual(restarted["state_hash"], one["state_hash"], "restarted")
                ran += 1
        print(f"{len(scenes)} scenes with {covered} pairs of features, {ran} ran and agree")


class DifficultScenes(WithRoom):
    def compare(self, scenes, ways):
        """Each of `scenes`, {name: words}, alone and in every way, {name: what Plan.add takes, with `words` to be added};
        {name: results}."""
        plan = Plan(self.room)
        for name, words in scenes.items():
            plan.add(name, *words)
            for way, how in ways.items():
                more = {key: value for key, value in how.items() if key != "words"}
                plan.add(f"{name}_{way}", *words, *how.get("words", ()), **more)
        outcomes = plan.execute()
        return {name: self.assert_same(outcomes, name, [f"{name}_{way}" for way in ways]) for name in scenes}

    def test_rows_that_fill_and_empty(self):
        """Two bodies of unlike phases go round a tall box: rows without solid are not read, and fill again."""
        scene = ("-grid_cells 24,80,1 -grid_length 1.2,4,1 -fluid_viscosity 1e-3 -initial_velocity_mean .3,1,0 "
                 "-species a,b -a_shape sphere -a_radius .3 -a_centre .9,1,0 -a_shear_modulus .05 "
                 "-b_shape sphere -b_radius .25 -b_centre .2,2.4,0 -b_shear_modulus .1 -time_end .8 "
                 "-guard_volume_drift 0 -method").split()
        self.compare({method: [*scene, method] for method in ("classic", "fast")},
                     {"whole": {"skip_nothing": True}, "ranks": {"ranks": 2}})

    def test_phases_that_swap_ghosts_behind_walls(self):
        """What the upper disc is swapped with holds the tube's ghosts behind the lower wall, where the disc has nothing."""
        scene = ("-grid_cells 12,48,1 -grid_length 3.6,14.4,.3 -fluid_viscosity 1 -body_force .05,0,0 -boundary_x wall "
                 "-boundary_y wall -species a,b -a_shape cylinder -a_radius .44 -a_axis z -a_centre 2.2,9,0 "
                 "-a_shear_modulus .1 -b_shape tube -b_radius .99 -b_axis y -b_centre 1.7,7,0 -b_shear_modulus .1 "
                 "-time_end 1000 -time_steps_max 8 -guard_volume_drift 0 -method").split()
        methods = ("classic", "fast", "fast -interface_scheme weno5")
        self.compare({f"method{n}": [*scene, *method.split()] for n, method in enumerate(methods)},
                     {"whole": {"skip_nothing": True}, "ranks": {"ranks": 2}})

    def test_many_bodies(self):
        """More than summary.json lists, and on four ranks not as many for each."""
        scene = ("-grid_cells 250,164,1 -grid_length 250,164,1 -fluid_viscosity 1 -initial_velocity_mean 1,.5,0 -species "
                 "a,b -a_shape sphere -a_radius 2.2 -a_count 41,26,1 -a_placement lattice -a_shear_modulus .1 -b_shape "
                 "sphere -b_radius 1.2 -b_centre 6.1,6.3,0 -b_shear_modulus .1 -time_end 1000 -time_steps_max 3").split()
        one = self.compare({"many": scene}, {f"ranks{n}": {"ranks": n} for n in (2, 3, 4)})["many"]
        self.assertEqual(len(one["bodies"]), 500)
        with h5py.File(self.room / "many/bodies.h5") as bodies:
            self.assertEqual(bodies["id"][...].tolist(), list(range(1, 1068)))
            volume = bodies["volume"][-1]
        self.assertEqual([body["volume"] for body in one["bodies"]], volume[:500].tolist())

    def test_turned_bodies_with_prestrain(self):
        """B = R diag(l^2) R^T: a turned disc relaxes as one that is not turned, on any ranks."""
        scene = ("-grid_cells 96,96,1 -grid_length 2,2,1 -fluid_viscosity 1 -species a -a_shape ellipsoid -a_semi_axes "
                 ".24,.15,.2 -a_shear_modulus 1 -a_initial_stretch 1.25,.8,1 -a_centre .53,.26,.5 -time_end .5 "
                 "-a_orientation").split()
        solid = ("-grid_cells 24,20,18 -grid_length 1.2,1,.9 -boundary_z wall -fluid_viscosity 1 -species a -a_shape "
                 "biconcave -a_diameter .5 -a_shear_modulus 1 -a_initial_stretch 1.2,.9,.9259259259259258 -a_placement "
                 "random -a_count 3 -a_orientation random -time_end 1 -time_steps_max 3").split()
        self.compare({f"angle{angle}": [*scene, f"0,0,{angle}"] for angle in (0, 30, 90)} | {"solid": solid},
                     {f"ranks{n}": {"ranks": n} for n in (2, 3)})
        energy = {angle: Run(self.room / f"angle{angle}").summary["elastic_energy"] for angle in (0, 30, 90)}
        start = 0.5 * math.pi * .24 * .15 * (1.25 ** 2 + .8 ** 2 - 2)
        self.assertLess(energy[0], .8 * start)
        self.assertAlmostEqual(energy[30] / energy[0], 1, delta=.02)
        self.assertAlmostEqual(energy[90] / energy[0], 1, delta=1e-3)

    def test_body_that_crosses_ranks_along_x(self):
        """x is cut at a multiple of 256 cells only: whoever receives the body has seen nothing but empty rows before. The
        other one crosses the ends of x, which are wrapped within rows or exchanged."""
        scene = ("-grid_cells 512,16,1 -grid_length 32,1,1 -fluid_viscosity 1e-2 -initial_velocity_mean -1,.2,0 "
                 "-species a,b -a_shape sphere -a_radius .3 -a_centre 16.9,.5,0 -a_shear_modulus .05 "
                 "-b_shape sphere -b_radius .25 -b_centre .5,.4,0 -b_shear_modulus .1 -time_end .9 -guard_volume_drift 0 "
                 "-method").split()
        methods = ("classic", "fast", "fast -solid_exterior identity", "fast -interface_scheme weno5")
        self.compare({f"method{n}": [*scene, *method.split()] for n, method in enumerate(methods)},
                     {"x": {"words": ("-da_processors_x", 2), "ranks": 2},
                      "xy": {"words": ("-da_processors_x", 2, "-da_processors_y", 2), "ranks": 4}})


if __name__ == "__main__":
    unittest.main()
