#!/usr/bin/python3
"""Scenes by dice: box, walls, bodies, laws, methods. The same state hash, series and measures of bodies on random splits,
with threads, with nothing skipped, without AVX-512, and restarted.

Needs EULASTIC_RUN_MANY, EULASTIC_RUN_MANY_AVX2 and EULASTIC_MPIEXEC. EULASTIC_SCENES: how many (8), EULASTIC_SEED: of the
first one (372: the sixth failed once). EULASTIC_WIDE=1: 512 cells along x, which is split in two as well.
"""
import math
import os
import pathlib
import random
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from many_runs import Plan  # noqa: E402
from processor import has_avx512  # noqa: E402

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
        options["initial_stretch"] = "1.2,0.833333333,1"
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
            words += [f"-boundary_{axis}{dice.choice(('min', 'max'))}_velocity", numbers(speed)]
    if not walls and dice.random() < 0.5:
        words += ["-initial_velocity", dice.choice(("taylor_green", "uniform", "shear_wave_xy")),
                  "-initial_velocity_mean", numbers([dice.uniform(-0.3, 0.3) if e in axes else 0 for e in "xyz"])]
    names = "abc"[:dice.choice((0, 1, 1, 2, 3))]
    for name in names:
        words += body(dice, name, lengths, axes)
    if names:
        words += ["-species", ",".join(names)]
    sometimes = (0.3, ("-fluid_inertia", "false")), (0.25, ("-pressure_solver", "smac"))
    if method == "fast":
        sometimes += ((0.2, ("-interface_scheme", dice.choice(("plic", "weno5")))),
                      (0.2, ("-solid_exterior", dice.choice(("extrapolate", "identity")))),
                      (0.15, ("-viscous_scheme", dice.choice(("auto", "rkl", "explicit")))))
    for chance, option in sometimes:
        if dice.random() < chance:
            words += option
    if walls and dice.random() < 0.3 and f"-boundary_{walls[0]}max_velocity" not in words:
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

    def test_same_bits(self):
        ran = compared = restarted = 0
        for seed in range(SEED, SEED + SCENES):
            dice = random.Random(seed)
            words, cells = scene(dice)
            steps = dice.choice((4, 7, 11, 25))
            whole, half = [*words, "-time_steps_max", steps], [*words, "-time_steps_max", max(1, steps // 2)]
            on = lambda ranks: [word for d, n in zip("xyz", ranks) if d != "z" or n > 1 for word in (f"-da_processors_{d}", n)]
            number = lambda ranks: {"ranks": math.prod(ranks)}
            plan, alone = Plan(self.room), Plan(self.room, ranks=1)
            plan.add(f"{seed}_one", *whole)
            ways = []
            for ranks in sorted({split(dice, cells), split(dice, cells)}):
                ways.append("{}_ranks_{}x{}x{}".format(seed, *ranks))
                plan.add(ways[-1], *whole, *on(ranks), **number(ranks))
            balanced, first, second = (split(dice, cells) for _ in range(3))
            plan.add(f"{seed}_threads", *whole, "-threads", dice.choice((2, 3)))
            plan.add(f"{seed}_balanced", *whole, "-load_balance", *on(balanced), **number(balanced))
            plan.add(f"{seed}_whole", *whole, skip_nothing=True)
            plan.add(f"{seed}_half", *half, *on(first), **number(first))
            plan.wait()
            plan.add(f"{seed}_restarted", *whole, "-restart", self.room / f"{seed}_half", *dice.choice(([], ["-load_balance"])),
                     *on(second), **number(second))
            outcomes = plan.execute()
            ways += [f"{seed}_{way}" for way in ("threads", "balanced", "whole")]
            if has_avx512():
                alone.add(f"{seed}_avx2", *whole)
                outcomes |= alone.execute("EULASTIC_RUN_MANY_AVX2")
                ways.append(f"{seed}_avx2")
            one = outcomes[f"{seed}_one"]
            self.assertIn(one.code, (0, 2, 3), one.err)
            if one.code:
                continue
            ran += 1
            for way in [*ways, f"{seed}_restarted"]:
                with self.subTest(f"{way}: {' '.join(map(str, whole))}"):
                    other = outcomes[way]
                    if way.endswith("restarted") and outcomes[f"{seed}_half"].code:
                        continue
                    self.assertEqual(other.code, 0, other.err)
                    compared += 1
                    restarted += way.endswith("restarted")
                    results = one.results()
                    for what in results if not way.endswith("restarted") else ("state_hash",):
                        self.assertEqual(results[what], other.results()[what], what)
        print(f"{SCENES} scenes, {ran} ran: {compared} compared, {restarted} of them restarted")
        self.assertGreater(ran, 0.6 * SCENES)
        self.assertGreaterEqual(compared, 4 * ran)
        self.assertGreater(restarted, 0.6 * ran)


if __name__ == "__main__":
    unittest.main()
