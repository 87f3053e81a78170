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

import h5py
import numpy

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path[:0] = [str(ROOT / "scripts"), str(ROOT / "tests/support")]
from program import BINARY  # noqa: E402
from scene_case import SceneCase  # noqa: E402
from eulastic import Run  # noqa: E402

FILES = "series.csv", "adhesion_bonds.csv", "adhesion_events.csv"
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
        row = rows_of(self.room / "on1" / FILES[0])[-1]
        self.assertEqual((row["bonds_formed"], row["bonds_broken"]), tuple(sum(event["formed"] == value for event in events) for value in (1, 0)))
        self.assertEqual(row["bonds"], row["bonds_formed"] - row["bonds_broken"])
        bodies = Run(self.room / "on1").bodies
        for d, axis in enumerate("xyz"):
            self.assertAlmostEqual(bodies.bond_force[-1, :, d].sum(), row[f"bond_force_{axis}"], delta=1e-15)
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
            bodies = Run(self.room / f"{name}1").bodies
            self.assertEqual(bodies.bonds[-1, 0], bodies.bonds[-1, 1:].sum(), "the vessel bears the other ends")
            numpy.testing.assert_allclose(bodies.bond_force[-1, 0], -bodies.bond_force[-1, 1:].sum(axis=0), atol=1e-14)
            last = rows_of(self.room / f"{name}1" / FILES[1])
            self.assertGreater(len(last), 20)
            self.assertEqual({row["body"] for row in last}, {2, 3})  # the third cell is beside the region
            for row in last:
                self.assertAlmostEqual(math.hypot(row["to_y"] - 6, row["to_z"] - 6), 4.5, delta=.25)  # half a cell
        refused = [word if word != "0.8" else "1.1" for word in map(str, [*words, "-vessel_law", "rigid"])]
        done = subprocess.run([BINARY, *refused], cwd=self.room, capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("-adhesion_cell_vessel_reach: 1.1 is more than 2 cells", done.stderr)

    def test_bodies_that_change_their_rank(self):
        """Receptors go with them, in shear that carries six discs around a periodic box, with bonds to walls and to each other."""
        file = self.room / "discs.csv"
        file.write_text("x,y,z\n" + "".join(f"{1.2 + 2 * n},{1.2 + 1.6 * (n % 2)},0\n" for n in range(6)))
        words = [*("-grid_cells 48,16,1 -grid_length 12,4,1 -boundary_y wall -boundary_ymax_velocity .2,0,0 -initial_velocity couette "
                   "-fluid_viscosity 1.2 -species disc -disc_shape sphere -disc_radius .9 -disc_shear_modulus .2 -disc_placement list "
                   "-adhesion disc-wall,disc-disc -time_step .25 -time_end 100 -series_interval 10 -disc_positions").split(), file,
                 *pair("disc_wall", reach=.4, rate_off=.05, reactive_compliance=30), *pair("disc_disc", reach=.8, rate_off=.02)]
        found = self.run_together({**{f"on{n}": ([*words, "-time_steps_max", 230], {"ranks": n}) for n in (1, 2, 4)},
                                   "half": ([*words, "-time_steps_max", 140], {"ranks": 3})})
        found |= self.run_together({"rest": ([*words, "-time_steps_max", 230, "-restart", self.room / "half"], {"ranks": 2})})
        for name, run in found.items():
            if name != "half":
                self.assertEqual(run.summary["state_hash"], found["on1"].summary["state_hash"], name)
        events = rows_of(self.room / "on1" / FILES[2])
        self.assertEqual({event["pair"] for event in events}, {0, 1})
        self.assertGreater(sum(not event["formed"] for event in events), 10)

    def test_bodies_of_an_inlet_generator(self):
        """A body that comes in has receptors and binds; one that leaves takes its bonds with it. The same on any ranks and after a
        restart."""
        words = [*("-grid_cells 64,16,1 -grid_length 8,2,1 -boundary_y wall -boundary_xmin inflow -boundary_xmax outflow "
                   "-boundary_xmin_velocity 1 -boundary_xmin_profile developed -initial_velocity poiseuille -initial_velocity_amplitude 1.5 "
                   "-boundary_xmin_generator_length 2.5 -fluid_viscosity .5 -species disc -disc_shape sphere -disc_radius .35 -disc_centre 1.2,.5,0 "
                   "-disc_shear_modulus 4 -interface_scheme plic -adhesion disc-wall -adhesion_disc_wall_region 4,0,0,8,2,1 -time_end 12 "
                   "-time_step .01 -series_interval .2").split(),
                 *pair("disc_wall", density=20, reach=.4, rate_on=4, rate_off=4, bond_stiffness=.001)]
        found = self.run_together({**{f"in{n}": ([*words], {"ranks": n}) for n in (1, 3)},
                                   "inhalf": ([*words, "-time_steps_max", 700], {"ranks": 2})})
        found |= self.run_together({"inrest": ([*words, "-restart", self.room / "inhalf"], {"ranks": 3})})
        for name in "in3", "inrest":
            self.assertEqual(found[name].summary["state_hash"], found["in1"].summary["state_hash"], name)
        bodies = Run(self.room / "in1").bodies
        self.assertGreater(len(bodies.id), 1)
        self.assertTrue((numpy.nan_to_num(bodies.bonds).max(axis=0)[:2] > 2).all(), "two of them have had bonds")
        gone = bodies.volume == 0
        self.assertTrue(gone[-1, 0], "the first one has left")
        self.assertEqual(numpy.nan_to_num(bodies.bonds[gone]).max(), 0)

    def test_regions_from_files(self):
        """Bonds where the file has cells: a disc on the lower wall. Wrong files are refused in one line."""
        x, z = numpy.meshgrid((numpy.arange(24) + .5) / 2, (numpy.arange(16) + .5) / 2, indexing="xy")
        mask = numpy.zeros((16, 16, 24), "u1")
        mask[:, 0, :] = numpy.hypot(x - 4, z - 4) < 2
        with h5py.File(self.room / "patch.h5", "w") as file:
            file["patch"] = mask
            file["none"] = 0 * mask
            file["upper"] = mask * 0
            file["upper"][:, 8, :] = 1
        words = self.scene([(3, 1.7, 4), (9, 1.7, 4)], *SHEAR, "-adhesion", "cell-wall", *pair("cell_wall", rate_on=.2), "-time_end", 30,
                           "-snapshot_interval", 30)
        given = ["-adhesion_cell_wall_region_file", self.room / "patch.h5:patch"]
        found = self.run_together({f"patch{n}": ([*words, *given], {"ranks": n}) for n in (1, 3)})
        self.assertEqual(found["patch1"].summary["state_hash"], found["patch3"].summary["state_hash"])
        bonds = rows_of(self.room / "patch1" / FILES[1])
        self.assertGreater(len(bonds), 5)
        for row in bonds:
            self.assertTrue(mask[int(2 * row["to_z"]), 0, int(2 * row["to_x"])], row)
            self.assertEqual(row["to_y"], 0)
        narrow = self.run_together({"narrow": ([*words, *given, "-adhesion_cell_wall_region", "0,0,0,3.2,8,8"], {"ranks": 1})})
        self.assertTrue(narrow)
        self.assertLessEqual(max(row["to_x"] for row in rows_of(self.room / "narrow" / FILES[1])), 3.2)
        for name, says in (("patch.h5:none", ["no cell"]), ("patch.h5:upper", ["no wall"]), ("patch.h5:missing", ["missing"]),
                           ("nothing.h5", ["nothing.h5"])):
            done = subprocess.run([BINARY, *map(str, words), "-adhesion_cell_wall_region_file", self.room / name], cwd=self.room,
                                  capture_output=True, text=True)
            self.assertEqual(done.returncode, 2, (name, done.stdout, done.stderr))
            self.assertRegex(done.stderr, r"\Aeulastic: error: -adhesion_cell_wall_region_file: [^\n]+\n\Z")
            for piece in says:
                self.assertIn(piece, done.stderr)

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
        bodies = Run(self.room / "pair").bodies
        first, second = bodies.bonds[-1]
        self.assertGreater(first, 3)
        self.assertEqual(first, second)
        numpy.testing.assert_allclose(bodies.bond_force[:, 0], -bodies.bond_force[:, 1], atol=1e-15)
        self.assertGreater(bodies.bond_force[2, 0, 0], 0)
        total = rows_of(self.room / "pair" / FILES[0])[-1]
        self.assertEqual(total["bonds"], first)
        for d in "xyz":
            self.assertAlmostEqual(total[f"bond_force_{d}"], 0, delta=1e-15)
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
