#!/usr/bin/python3
"""Scenes by dice: box, walls, bodies, laws, methods. The same state hash, series and measures of bodies on random splits,
with threads, with nothing skipped, without AVX-512, and restarted.

Needs EULASTIC, EULASTIC_MPIEXEC, EULASTIC_AVX2 and EULASTIC_WHOLE. EULASTIC_SCENES: how many (8), EULASTIC_SEED: of the
first one (372: the sixth failed once). EULASTIC_WIDE=1: 512 cells along x, which is split in two as well.
"""
import json
import math
import os
import pathlib
import random
import subprocess
import sys
import tempfile
import unittest

import h5py

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from processor import has_avx512  # noqa: E402

MPIEXEC = os.environ.get("EULASTIC_MPIEXEC", "mpiexec")
SCENES, SEED = int(os.environ.get("EULASTIC_SCENES", 8)), int(os.environ.get("EULASTIC_SEED", 372))
WIDE = os.environ.get("EULASTIC_WIDE") == "1"
GUARDS = "divergence", "volume_drift", "energy_growth", "mach"  # what a coarse grid does is not the question


def numbers(values):
    return ",".join(repr(value) for value in values)


def body(dice, name, lengths, axes):
    """Options of a species of one to four bodies in a box of these lengths; `axes`: its directions, xy or xyz."""
    dimension, size = len(axes), min(lengths[:len(axes)])
    shape = dice.choice("sphere sphere ellipsoid biconcave cylinder slab tube".split())
    radius = size * dice.uniform(0.12, 0.42)
    options = {"shape": shape}
    if shape == "ellipsoid":
        options["semi_axes"] = numbers(size * dice.uniform(0.12, 0.4) for _ in range(3))
    elif shape == "slab":
        d = dice.randrange(dimension)
        options |= {"axis": axes[d], "interval": numbers((0, lengths[d] * dice.uniform(0.15, 0.5)))}
    else:
        options["radius"] = repr(radius)
        if shape == "cylinder":
            options["axis"] = "z" if dimension == 2 else dice.choice(axes)
        elif shape != "sphere":
            options["axis"] = dice.choice(axes)
    if shape in ("sphere", "ellipsoid", "biconcave") and dice.random() < 0.4:
        options |= {"placement": "random", "count": str(dice.randint(1, 4)), "orientation": "random",
                    "seed": str(dice.randrange(1000))}
        for key in options.keys() & {"radius", "semi_axes"}:
            options[key] = numbers(0.5 * float(value) for value in options[key].split(","))
    elif shape != "slab":
        options["centre"] = numbers(dice.uniform(0.1, 0.9) * length for length in lengths)
    if dice.random() < 0.75:
        options["shear_modulus"] = dice.choice(("0", "0.01", "0.1", "0.5"))
    else:
        options |= {"law": "mooney_rivlin", "c1": "0.05", "c2": "0.02", "c3": dice.choice(("0", "0.1"))}
    if dice.random() < 0.2:
        options["initial_stretch"] = "1.2,0.9,1"
    return [word for key, value in options.items() for word in (f"-{name}_{key}", value)]


def scene(dice):
    """Options of a scene, but for how many steps, and its cells."""
    flat = dice.random() < 0.35
    axes = "xy" if flat else "xyz"
    cells = [dice.choice((6, 7, 8, 9, 10, 12, 13, 15, 16, 17, 20, 24)) for _ in range(3)]
    if flat:
        cells = [dice.choice((12, 16, 24, 33, 48, 64, 100)), dice.choice((9, 12, 16, 24, 33, 48, 64)), 1]
    if WIDE:
        cells = [512, *(min(n, 64 if flat else 12) for n in cells[1:])]
    lengths = [n * dice.choice((0.3, 0.5)) for n in cells]
    method = dice.choice(("fast", "classic"))
    words = ["-grid_cells", numbers(cells), "-grid_length", numbers(lengths), "-method", method,
             "-fluid_viscosity", dice.choice(("0.1", "1", "3")),
             "-body_force", numbers([dice.choice((0, 1e-3, 5e-2)) if d < len(axes) else 0 for d in range(3)])]
    walls = [axis for axis in axes if dice.random() < 0.4]
    for axis in walls:
        words += [f"-boundary_{axis}", "wall"]
        if dice.random() < 0.4:
            speed = [dice.uniform(-0.2, 0.2) if e in axes and e != axis else 0 for e in "xyz"]
            words += [f"-wall_{axis}{dice.choice(('min', 'max'))}_velocity", numbers(speed)]
    if not walls and dice.random() < 0.5:
        words += ["-initial_velocity", dice.choice(("taylor_green", "uniform", "shear_wave_xy")),
                  "-initial_velocity_mean", numbers([dice.uniform(-0.3, 0.3) if e in axes else 0 for e in "xyz"])]
    names = "abc"[:dice.choice((0, 1, 1, 2, 3))]
    for name in names:
        words += body(dice, name, lengths, axes)
    if names:
        words += ["-species", ",".join(names)]
    sometimes = (0.3, ("-fluid_inertia", "false")), (0.25, ("-pressure_solver", "smac"))
    if names:
        sometimes += ((0.2, ("-interface_scheme", dice.choice(("plic", "weno5")))),
                      (0.2, ("-solid_exterior", dice.choice(("extrapolate", "identity")))))
    sometimes += ((0.15, ("-time_integrator", dice.choice(("staggered", "euler")))),
                  (0.15, ("-viscous_scheme", dice.choice(("rkl", "explicit")))))
    for chance, option in sometimes:
        if dice.random() < chance:
            words += option
    if walls and dice.random() < 0.3 and f"-wall_{walls[0]}max_velocity" not in words:
        words += [f"-boundary_{walls[0]}max", "symmetry"]
    for name in names:
        own = random.Random(f"{name} {words}")  # not of the dice, whose other scenes would become different ones
        if own.random() < 0.4:
            words += [f"-{name}_viscosity", own.choice(("0.01", "0.5", "2", "20"))]
    words += ["-time_end", "1000", "-series_interval", dice.choice(("0.05", "0.5", "1000"))]
    return words + [word for name in GUARDS for word in (f"-guard_{name}", "0")], cells


def split(dice, cells):
    """Ranks along x, y and z, three cells each or more; x whole or in 256 cells (docs/method.md, "The same bits")."""
    x, most = 1 + WIDE, [max(1, n // 3) for n in cells[1:]]
    return dice.choice([(x, y, z) for y in range(1, 5) for z in range(1, 5)
                        if y <= most[0] and z <= most[1] and 1 < x * y * z <= 4])


class RandomScenes(unittest.TestCase):
    def setUp(self):
        room = tempfile.TemporaryDirectory()
        self.addCleanup(room.cleanup)
        self.room = pathlib.Path(room.name)

    def run_program(self, words, directory, ranks=(1, 1, 1), program="EULASTIC"):
        """State hash, series and measures; None if the program refuses or stops."""
        count = math.prod(ranks)
        if count > 1:
            words = [*words, "-da_processors_x", str(ranks[0]), "-da_processors_y", str(ranks[1])]
            words += ["-da_processors_z", str(ranks[2])] if ranks[2] > 1 else []
        command = [MPIEXEC, "--oversubscribe", "-n", str(count)] if count > 1 else []
        done = subprocess.run([*command, os.environ[program], *words, "-output_dir", self.room / directory,
                               "-output_overwrite"], capture_output=True, text=True, timeout=300)
        self.assertIn(done.returncode, (0, 2, 3), done.stderr)
        if done.returncode:
            return None
        summary = json.loads((self.room / directory / "summary.json").read_text())
        found = {"state_hash": summary["state_hash"], "series": (self.room / directory / "series.csv").read_text()}
        if summary["bodies"]:
            with h5py.File(self.room / directory / "bodies.h5") as bodies:
                found["measures"] = {name: bodies[name][...].tobytes() for name in bodies}
        return found

    def test_same_bits(self):
        ran = compared = restarted = 0
        programs = {"nothing skipped": {"program": "EULASTIC_WHOLE"}, "without AVX-512": {"program": "EULASTIC_AVX2"}}
        if not has_avx512():
            del programs["without AVX-512"]
            print("skipped: without AVX-512, which this processor does not have")
        for seed in range(SEED, SEED + SCENES):
            dice = random.Random(seed)
            words, cells = scene(dice)
            steps = dice.choice((4, 7, 11, 25))
            whole = [*words, "-time_steps_max", str(steps)]
            one = self.run_program(whole, "one")
            if one is None:
                continue
            ran += 1
            ways = {"{} x {} x {} ranks".format(*ranks): {"ranks": ranks} for ranks in {split(dice, cells), split(dice, cells)}}
            ways |= {"threads": {"words": [*whole, "-threads", str(dice.choice((2, 3)))]},
                     "balanced": {"words": [*whole, "-balance"], "ranks": split(dice, cells)}, **programs}
            half = [*words, "-time_steps_max", str(max(1, steps // 2)), "-checkpoint_interval", "1e9"]
            if self.run_program(half, "half", split(dice, cells)) is not None:
                ways["restarted"] = {"words": [*whole, "-restart", str(self.room / "half"),
                                               *dice.choice(([], ["-balance"]))], "ranks": split(dice, cells)}
            for way, how in ways.items():
                with self.subTest(f"seed {seed}, {way}: {' '.join(whole)}"):
                    other = self.run_program(**{"words": whole, "directory": "other", **how})
                    self.assertIsNotNone(other)
                    compared += 1
                    restarted += way == "restarted"
                    for what in one if way != "restarted" else ("state_hash",):
                        self.assertEqual(one[what], other[what], what)
        print(f"{SCENES} scenes, {ran} ran: {compared} compared, {restarted} of them restarted")
        self.assertGreater(ran, 0.6 * SCENES)
        self.assertGreaterEqual(compared, (2 + len(programs)) * ran)
        self.assertGreater(restarted, 0.6 * ran)


if __name__ == "__main__":
    unittest.main()
