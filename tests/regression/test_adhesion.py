#!/usr/bin/python3
"""Adhesion: the same bonds on any ranks, threads and after a restart; numbers and lives of bonds as their rates say; equal and
opposite forces; what is refused.

Needs EULASTIC, EULASTIC_MPIEXEC and EULASTIC_RUN_MANY.
"""
import csv
import math
import pathlib
import subprocess
import sys
import unittest

import numpy

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path[:0] = [str(ROOT / "scripts"), str(ROOT / "tests/support")]
from program import BINARY  # noqa: E402
from scene_case import SceneCase  # noqa: E402

FILES = "adhesion.csv", "adhesion_bonds.csv", "adhesion_events.csv"
BOX = ("-grid_cells 24,16,16 -grid_length 12,8,8 -boundary_y wall -fluid_viscosity 1.2 -species cell -cell_shape sphere -cell_radius 1.4 "
       "-cell_shear_modulus .05 -cell_placement list").split()
SHEAR = "-initial_velocity couette -boundary_ymax_velocity .02,0,0".split()


def pair(name, **options):
    """Options of a pair."""
    given = {"density": 6, "reach": .8, "rate_on": .05, "rate_off": .01, "bond_stiffness": .01} | options
    return [word for option, value in given.items() for word in (f"-adhesion_{name}_{option}", str(value))]


def rows_of(path):
    with open(path) as file:
        return [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]


class Adhesion(SceneCase):
    def scene(self, rows, *words):
        file = self.room / f"places{len(rows)}.csv"
        file.write_text("\n".join(["x,y,z", *(",".join(map(str, row)) for row in rows), ""]))
        return [*BOX, "-cell_positions", file, *map(str, words)]

    def test_the_same_bonds_everywhere(self):
        """On ranks, threads and from the middle on; on walls, across a periodic side, and between two cells that touch."""
        words = self.scene([(.1, 1.7, 4), (4, 1.6, 7.9), (4.2, 4.6, 7.7), (9, 6.4, 2)], *SHEAR, "-adhesion", "cell-wall,cell-cell",
                           *pair("cell_wall", rate_off=.05, reactive_compliance=30), *pair("cell_cell", catch_rate_off=.02),
                           "-time_end", 60, "-series_interval", 5, "-snapshot_interval", 20)
        end = ["-time_steps_max", 40]
        found = self.run_together({**{f"on{n}": ([*words, *end], {"ranks": n}) for n in (1, 2, 3, 4)},
                                   "threads": ([*words, *end, "-threads", 2], {"ranks": 1}),
                                   "half": ([*words, "-time_steps_max", 20], {"ranks": 2})})
        found |= self.run_together({"rest": ([*words, *end, "-restart", self.room / "half"], {"ranks": 3})})
        one = found["on1"]
        for name, run in found.items():
            if name != "half":
                self.assertEqual(run.summary["state_hash"], one.summary["state_hash"], name)
            if name not in ("half", "rest"):  # a restart goes on in files of its own
                for file in FILES:
                    self.assertEqual((self.room / name / file).read_bytes(), (self.room / "on1" / file).read_bytes(), (name, file))
        events = rows_of(self.room / "on1" / FILES[2])
        self.assertGreater(sum(not event["formed"] for event in events), 3)
        self.assertEqual({event["pair"] for event in events}, {0, 1})
        whole = {float(row["time"]): row for row in events}
        later = rows_of(self.room / "rest" / FILES[2])
        self.assertTrue(later and all(whole[row["time"]] is not None for row in later))
        bonds = rows_of(self.room / "on1" / FILES[1])
        last = [row for row in bonds if row["time"] == bonds[-1]["time"]]
        self.assertEqual(len(last), len(events) - 2 * sum(not event["formed"] for event in events))

    def test_vessels(self):
        """Bonds to rigid and elastic vessels: the same on any ranks and after a restart, on the vessel's surface, and where that is in
        the region alone."""
        file = self.room / "in_vessel.csv"
        file.write_text("x,y,z\n3,2.9,6\n9,6,9\n12,9.1,6\n")
        words = [*("-grid_cells 32,24,24 -grid_length 16,12,12 -boundary_y wall -boundary_z wall -fluid_viscosity 1.2 -body_force 1e-4,0,0 "
                   "-species vessel,cell -vessel_shape tube -vessel_axis x -vessel_diameter 9 -cell_shape sphere -cell_radius 1.2 "
                   "-cell_shear_modulus .05 -cell_placement list -adhesion cell-vessel -adhesion_cell_vessel_region 0,0,0,10,12,12 "
                   "-time_end 30 -snapshot_interval 30 -cell_positions").split(), file, *pair("cell_vessel", density=10, rate_on=.1)]
        for law in ["-vessel_law", "rigid"], ["-vessel_shear_modulus", ".5"]:
            name = law[1].strip(".")
            found = self.run_together({**{f"{name}{n}": ([*words, *law], {"ranks": n}) for n in (1, 3)},
                                       f"{name}half": ([*words, *law, "-time_steps_max", 8], {"ranks": 2})})
            found |= self.run_together({f"{name}rest": ([*words, *law, "-restart", self.room / f"{name}half"], {"ranks": 3})})
            for run, of in found.items():
                if not run.endswith("half"):
                    self.assertEqual(of.summary["state_hash"], found[f"{name}1"].summary["state_hash"], run)
            last = rows_of(self.room / f"{name}1" / FILES[1])
            self.assertGreater(len(last), 20)
            self.assertEqual({row["body"] for row in last}, {2, 3})  # the third cell is beside the region
            for row in last:
                self.assertAlmostEqual(math.hypot(row["to_y"] - 6, row["to_z"] - 6), 4.5, delta=.25)  # half a cell
        refused = [word if word != "0.8" else "1.1" for word in map(str, [*words, "-vessel_law", "rigid"])]
        done = subprocess.run([BINARY, *refused], cwd=self.room, capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("-adhesion_cell_vessel_reach: 1.1 is more than 2 cells", done.stderr)

    def test_files_of_a_run_that_goes_on(self):
        words = self.scene([(3, 1.7, 4)], *SHEAR, "-adhesion", "cell-wall", *pair("cell_wall"), "-time_end", 60, "-series_interval", 3,
                           "-snapshot_interval", 15, "-checkpoint_interval", 10)
        self.run_together({"whole": (words, {"ranks": 1}), "parts": ([*words, "-time_steps_max", 25], {"ranks": 1})})
        done = subprocess.run([BINARY, self.room / "parts/options.txt", "-restart", self.room / "parts", "-output_dir", self.room / "parts",
                               "-time_steps_max", "0"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        for file in FILES:
            self.assertEqual((self.room / "parts" / file).read_bytes(), (self.room / "whole" / file).read_bytes(), file)

    def test_numbers_and_lives_as_the_rates_say(self):
        """A cell at rest whose bonds hardly pull. With bonds that never break all receptors within reach are bound in the end; with a
        rate of rupture the share that the rates say. Lives of broken bonds have their mean."""
        at = [(6, 2, 4)]
        common = ["-adhesion", "cell-wall", "-time_end", 400, "-time_step", 1, "-series_interval", 4]
        rates = {"density": 200, "reach": 1.5, "bond_stiffness": 1e-9, "rate_on": .1}
        found = self.run_together({"all": (self.scene(at, *common, *pair("cell_wall", **rates | {"rate_off": 0})), {"ranks": 1}),
                                   "some": (self.scene(at, *common, *pair("cell_wall", **rates | {"rate_off": .2})), {"ranks": 1})})
        self.assertEqual(len(found), 2)
        most = rows_of(self.room / "all" / FILES[0])[-1]["bonds"]
        # The cap of a sphere that is no more than 1.5 away from the wall, 2 pi a (1.5 - (2 - a)). Solid fractions are means over cells,
        # linear between centres: of variance h^2/12 + h^2/6, so that phi = 1/2 lies h^2/(4 a) inside of a sphere of radius a. Cells
        # round the number of their receptors at random.
        radius = 1.4 - .5**2 / (4 * 1.4)
        cap = 200 * 2 * math.pi * radius * (radius - .5)
        self.assertAlmostEqual(most, cap, delta=3 * math.sqrt(cap))
        numbers = [row["bonds"] for row in rows_of(self.room / "some" / FILES[0]) if row["time"] > 60]
        on, off = -math.expm1(-.1), -math.expm1(-.2)
        share = on / (on + off)
        # A bond is forgotten within 1/.3 = 3.3 steps, so that rows 4 apart are nearly independent.
        error = math.sqrt(share * (1 - share) / most / len(numbers) * 2)
        self.assertAlmostEqual(numpy.mean(numbers) / most, share, delta=4 * error)
        lives = [event["age"] for event in rows_of(self.room / "some" / FILES[2]) if not event["formed"] and event["time"] < 350]
        self.assertGreater(len(lives), 1000)
        self.assertAlmostEqual(numpy.mean(lives), 1 / off, delta=4 / off / math.sqrt(len(lives)))

    def test_forces_are_equal_and_opposite(self):
        """Two cells that pull each other: their bonds' forces cancel, the pair stays where it was, and comes closer."""
        words = self.scene([(4.3, 4, 4), (7.7, 4, 4)], "-adhesion", "cell-cell", *pair("cell_cell", rate_off=0, reach=1.2, rate_on=.5,
                                                                                       bond_stiffness=.004),
                           "-time_end", 150, "-series_interval", 10)
        run = self.run_together({"pair": (words, {"ranks": 2})})["pair"]
        forces = rows_of(self.room / "pair" / FILES[0])
        last = [row for row in forces if row["time"] == forces[-1]["time"]]
        self.assertGreater(last[0]["bonds"], 3)
        self.assertEqual(last[0]["bonds"], last[1]["bonds"])
        for d in "xyz":
            self.assertAlmostEqual(last[0][f"force_{d}"], -last[1][f"force_{d}"], delta=1e-15)
        self.assertGreater(forces[2]["force_x"], 0)
        left, right = (body["centroid"][0] for body in run.summary["bodies"])
        self.assertAlmostEqual(left + right, 12, delta=2e-3)
        self.assertLess(right - left, 3.4 - .05)

    def test_no_adhesion_no_files(self):
        words = self.scene([(3, 1.7, 4), (8, 2, 4)], *SHEAR, "-time_end", 1, "-time_steps_max", 2)
        self.run_together({"plain": (words, {"ranks": 1})})
        self.assertEqual([path.name for path in (self.room / "plain").glob("adhesion*")], [])

    def test_refusals(self):
        at = [(3, 1.7, 4), (8, 2, 4)]
        good = ["-adhesion", "cell-wall", *pair("cell_wall"), "-time_end", 1]
        for words, says in (
                (["-adhesion", "cell-nothing"], ["-adhesion", "cell-nothing", "NAME-wall"]),
                (["-adhesion", "wall-cell"], ["-adhesion", "wall-cell"]),
                (["-adhesion", "cell-wall,cell-wall"], ["-adhesion", "twice"]),
                (["-adhesion", "cell-wall"], ["-adhesion_cell_wall_density", "must be given"]),
                (good + ["-adhesion_cell_wall_rate_catch", "1"], ["-adhesion_cell_wall_rate_catch"]),
                (["-adhesion", "cell-wall", *pair("cell_wall", rate_on=-1)], ["-adhesion_cell_wall_rate_on", ">= 0"]),
                (["-adhesion", "cell-wall", *pair("cell_wall", reach=.4)], ["-adhesion_cell_wall_reach", "less than a cell", "0.5"]),
                (good + ["-adhesion_cell_wall_region", "0,2,0,12,3,8"], ["-adhesion_cell_wall_region", "no wall"]),
                (good + ["-adhesion_cell_wall_region", "0,2,0,12,1,8"], ["-adhesion_cell_wall_region", "below"]),
                (good + ["periodic"], ["-adhesion", "cell-wall", "without a wall"]),
                (good + ["-cell_contact", "merge"], ["-adhesion", "cell", "merge"]),
                (good + ["-method", "classic"], ["-adhesion", "cell", "-method fast"])):
            scene = [*self.scene(at), *words, "-time_end", "1"] if "-time_end" not in words else [*self.scene(at), *words]
            if "periodic" in scene:  # in place of the walls
                scene = ["periodic" if word == "wall" else word for word in scene if word != "periodic"]
            done = subprocess.run([BINARY, *map(str, scene)], cwd=self.room, capture_output=True, text=True)
            self.assertEqual(done.returncode, 2, (words, done.stdout, done.stderr))
            self.assertRegex(done.stderr, r"\Aeulastic: error: [^\n]+\n\Z")
            for piece in says:
                self.assertIn(piece, done.stderr)


if __name__ == "__main__":
    unittest.main()
