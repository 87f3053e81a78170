"""The scenes of scripts/studies/stability/stability_map, which are short and difficult. Density, size of the box and speed are 1 unless a scene
sets them.

A group is a map: its `build(x, y)` gives the options of the scene at (x, y); each is run with the methods of its group.
"""
from dataclasses import dataclass, field
from typing import Callable

UP, DOWN = "1,0,0", "-1,0,0"
METHODS = "fast", "classic"


@dataclass
class Group:
    name: str
    title: str
    build: Callable
    x: list
    y: list
    x_label: str
    y_label: str
    quick: list = field(default_factory=list)  # the (x, y) of the reduced map; [] = none, None = all
    factor: bool = False  # x is the time step over the automatic one (the least of that run)
    methods: tuple = METHODS


def box(cells=32, walls="", viscosity=0.01, end=2.0, steps=3000, depth=1, **more):
    """A unit box (flat unless depth > 1), walls in the directions named."""
    nx, ny = cells if isinstance(cells, tuple) else (cells, cells)
    options = {"grid_cells": f"{nx},{ny},{depth}", "grid_length": f"1,1,{depth / nx:g}", "fluid_viscosity": viscosity,
               "time_end": end, "time_steps_max": steps, **{f"boundary_{d}": "wall" for d in walls}}
    return options | more


def body(G, name="a", shape="sphere", radius=0.2, centre=".5,.5,0", **more):
    size = {"radius": radius} if shape in ("sphere", "cylinder", "biconcave") else {}
    place = {} if shape == "slab" or "placement" in more else {"centre": centre}
    known = {"species": name} | {f"{name}_{k}": v for k, v in ({"shape": shape, "shear_modulus": G} | size | place | more).items()}
    return known


def two(first, second):
    return first | second | {"species": first["species"] + "," + second["species"]}


def cavity(G, Re, cells=32, **more):
    """A disc in a lid-driven cavity, the lid started at once."""
    return box(cells, "xy", 1 / Re, boundary_ymax_velocity=UP, **more) | body(G, centre=".6,.5,0")


def random_flow(G, Re, cells=32, **more):
    """A disc in a random solenoidal flow that nothing drives."""
    return box(cells, "", 1 / Re, initial_velocity="random", **more) | body(G)


def shear(G, Re, cells=32, **more):
    """A disc in Couette flow between walls that start at once."""
    return box(cells, "y", 1 / Re, boundary_ymax_velocity=UP, boundary_ymin_velocity=DOWN, **more) | body(G)


def per_body(cells, kind):
    """`cells` across the disc's diameter of 0.4."""
    n = round(cells / 0.4)
    build = {"cavity": cavity, "random": random_flow, "shear": shear}[kind]
    return build(0.1, 100, n, steps=2000 if cells < 40 else 800)


def thin(kind, G):
    """Plates three cells thick, 24 cells long."""
    h = 1 / 32
    plate = dict(shape="ellipsoid", semi_axes=f"{12 * h},{1.5 * h},1")
    flow = {"sheared": box(32, "y", boundary_ymax_velocity=UP, boundary_ymin_velocity=DOWN),
            "across": box(32, "", body_force="0,1,0"),
            "random": box(32, "", initial_velocity="random"),
            "cavity": box(32, "xy", boundary_ymax_velocity=UP),
            "slab": box(32, "y", boundary_ymax_velocity=UP)}[kind]
    if kind == "slab":
        return flow | body(G, shape="slab", interval=f"0,{3 * h}")
    return flow | body(G, **plate, orientation="0,0,30" if kind != "across" else "0,0,0")


def contact(kind, G):
    """Bodies that touch walls, each other, or everything."""
    fixed = box(32, "xy", boundary_ymax_velocity=UP)
    random = box(32, "", initial_velocity="random")
    return {
        "touching the wall": lambda: fixed | body(G, centre=".5,.2,0"),
        "in the corner": lambda: fixed | body(G, centre=".8,.8,0"),
        "at the lid": lambda: fixed | body(G, centre=".5,.8,0"),
        "two touching": lambda: random | two(body(G, radius=.18, centre=".32,.5,0"),
                                             body(G, "b", radius=.18, centre=".68,.5,0")),
        "two overlapping": lambda: random | two(body(G, centre=".4,.5,0"), body(G, "b", centre=".6,.5,0")),
        "soft and stiff": lambda: fixed | two(body(G, radius=.15, centre=".3,.5,0"),
                                              body(100 * G, "b", radius=.15, centre=".65,.5,0")),
        "nine, one species": lambda: fixed | body(G, radius=.15, placement="lattice", count="3,3,1"),
        "box of solid": lambda: random | body(G, shape="slab", interval="0,1"),
        "box of solid, lid": lambda: fixed | body(G, shape="slab", interval="0,1"),
        "disc as wide as the box": lambda: random | body(G, radius=.5),
        "slab under a lid": lambda: fixed | body(G, shape="slab", interval="0,.5"),
        "slab off the faces": lambda: fixed | body(G, shape="slab", interval="0,.51"),
        "slab and disc": lambda: fixed | two(body(G, shape="slab", interval="0,.3"),
                                             body(G, "b", radius=.15, centre=".5,.45,0")),
    }[kind]()


CONTACTS = ["touching the wall", "in the corner", "at the lid", "two touching", "two overlapping",
            "soft and stiff", "nine, one species", "box of solid", "box of solid, lid", "disc as wide as the box",
            "slab under a lid", "slab off the faces", "slab and disc"]


def reversing(frequency, G):
    """Walls that reverse, started at full speed."""
    return shear(G, 100, boundary_ymax_angular_frequency=frequency, boundary_ymin_angular_frequency=frequency)


def stretched(stretch, G):
    """An ellipse with B = diag(l^2, 1/l^2), let go."""
    r = 0.09
    return box(48, "", 0.01) | body(G, shape="ellipsoid", semi_axes=f"{r * stretch},{r / stretch},1",
                                    initial_stretch=f"{stretch},{1 / stretch:.17g},1")


def extension(G, Re):
    """A disc at the stagnation point of decaying vortices: stretch 3 and far beyond where G is small."""
    return box(32, "", 1 / Re, initial_velocity="taylor_green", end=1.5) | body(G, radius=.15)


def layers(viscosity, cells):
    """A double shear layer too thin for the grid, with and without a disc."""
    disc = body(0.01) if isinstance(cells, str) else {}
    return box(int(str(cells).split()[0]), "", viscosity, initial_velocity="shear_layer", end=3) | disc


def nothing(kind, G):
    rest = box(32, "", end=1, steps=300)
    return {
        "at rest": lambda: rest | body(G),
        "at rest between walls": lambda: box(32, "xy", end=1, steps=300) | body(G),
        "no viscosity": lambda: rest | body(G) | {"fluid_viscosity": 0},
        "no viscosity, random": lambda: rest | body(G) | {"fluid_viscosity": 0, "initial_velocity": "random", "time_steps_max": 1000},
        "no inertia": lambda: rest | body(G) | {"fluid_inertia": "false", "initial_velocity": "random"},
        "no fluid": lambda: rest | body(G, shape="slab", interval="0,1"),
        "uniform velocity": lambda: rest | body(G) | {"initial_velocity": "uniform", "initial_velocity_mean": "1,.7,0"},
        "tiny velocity": lambda: rest | body(G) | {"initial_velocity": "random", "initial_velocity_amplitude": 1e-12},
        "tiny force": lambda: rest | body(G) | {"body_force": "1e-12,0,0"},
        "strong force": lambda: box(32, "y", end=1) | body(G) | {"body_force": "100,0,0"},
        "fast force": lambda: rest | body(G) | {"body_force": "10,5,0", "body_force_angular_frequency": 100},
    }[kind]()


NOTHINGS = ["at rest", "at rest between walls", "no viscosity", "no viscosity, random", "no inertia", "no fluid",
            "uniform velocity", "tiny velocity", "tiny force", "strong force", "fast force"]


def flat_cells(ratio, G):
    """Cells `ratio` times longer than high."""
    return cavity(G, 100, (32, round(32 * ratio)) if ratio >= 1 else (round(32 / ratio), 32))


STEPPED = {
    "cavity, soft": lambda: cavity(0.1, 100),
    "cavity, stiff": lambda: cavity(100, 100),
    "random, inertial": lambda: random_flow(1, 1000),
    "random, viscous": lambda: random_flow(10, 1),
    "shear": lambda: shear(1, 10),
    "no bodies": lambda: box(32, "", 1e-3, initial_velocity="random"),
}


def stepped(factor, kind):
    return STEPPED[kind]()


def solid(kind, G):
    """A solid in 3-D."""
    flow = box(20, "xyz", depth=20, end=1, steps=300, boundary_ymax_velocity=UP)
    free = box(20, "", depth=20, end=1, steps=300, initial_velocity="random")
    return {
        "cavity": lambda: flow | body(G, centre=".6,.5,.5", radius=.25),
        "random": lambda: free | body(G, centre=".5,.5,.5", radius=.25),
        "lattice, touching": lambda: free | body(G, radius=.25, placement="lattice", count="2,2,2"),
        "stretched 3": lambda: free | body(G, centre=".5,.5,.5", shape="ellipsoid", semi_axes=".45,.09,.09",
                                           initial_stretch="3,.57735,.57735") | {"initial_velocity": "zero"},
        "plate": lambda: free | body(G, centre=".5,.5,.5", shape="ellipsoid", semi_axes=".4,.075,.4", orientation="30,20,10"),
        "box of solid": lambda: free | body(G, shape="slab", interval="0,1"),
        "vortices": lambda: free | body(G, centre=".5,.5,.5") | {"initial_velocity": "taylor_green_3d"},
    }[kind]()


SOLIDS = ["cavity", "random", "lattice, touching", "stretched 3", "plate", "box of solid", "vortices"]


def long(kind, G):
    """A run of a hundred thousand steps."""
    short = {"end": 1e9, "steps": 100000}
    scene = {"rest": lambda: box(16, "", **short) | body(G, radius=.25),
             "shear": lambda: shear(G, 100, 16, **short),
             "cavity": lambda: cavity(G, 100, 16, **short),
             "reversing": lambda: shear(G, 100, 16, **short, boundary_ymax_angular_frequency=3, boundary_ymin_angular_frequency=3)}[kind]()
    return scene | {"series_interval": 0.5}


def viscous(contrast, kind):
    """Bodies with a viscosity of their own, stiff, soft or without stress, fast and creeping."""
    short = dict(end=1, steps=800)
    flow = {"cavity": lambda: cavity(1, 100, **short),
            "random": lambda: random_flow(0.1, 1000, **short),
            "shear": lambda: shear(1, 1, **short),
            "drop in shear": lambda: shear(0, 1, **short),
            "touching the wall": lambda: box(32, "xy", boundary_ymax_velocity=UP, **short) | body(1, centre=".5,.2,0"),
            "slab under a lid": lambda: box(32, "xy", boundary_ymax_velocity=UP, **short) | body(1, shape="slab", interval="0,.51"),
            "3-D": lambda: box(16, "xyz", depth=16, end=1, steps=100, boundary_ymax_velocity=UP) | body(1, centre=".6,.5,.5")}[kind]()
    return flow | {"a_viscosity": contrast * flow["fluid_viscosity"]}


VISCOUS = ["cavity", "random", "shear", "drop in shear", "touching the wall", "slab under a lid", "3-D"]


def corner(cells, G):
    """A disc that the lid drags into the corner at its end and holds there."""
    return cavity(G, 100, cells, end=60, steps=100000) | {"series_interval": 0.1}


def crowd(hematocrit, seed):
    """Red cells at random between plates, 16 cells long and 2.5 thick, in um, us and mPa s: they touch walls and each other."""
    return box((48, 40), "y", 1.2, 1500, 20000, grid_length="24,20,.5", body_force="4e-4,0,0", species="rbc", rbc_law="red_cell",
               rbc_diameter=8, rbc_placement="random", rbc_orientation="random", rbc_hematocrit=hematocrit, rbc_seed=seed,
               series_interval=10)


MODULI = [1e-4, 1e-3, 1e-2, 1e-1, 1, 10, 100, 1000]
REYNOLDS = [0.1, 1, 10, 100, 1000, 10000]
THREE = [0.01, 1, 100]

GROUPS = [
    Group("cavity", "a disc in a lid-driven cavity", cavity, MODULI, REYNOLDS, "G/(ρU²)", "Re",
          [(1e-4, 1e4), (1e-2, 100), (1, 0.1), (1, 1e4), (1000, 100), (1000, 1e4)]),
    Group("random", "a disc in a random flow, not driven", random_flow, MODULI, REYNOLDS, "G/(ρU²)", "Re",
          [(1e-4, 1e4), (1e-2, 100), (1, 0.1), (1, 1e4), (1000, 100), (1000, 1e4)]),
    Group("shear", "a disc in Couette flow from rest", shear, MODULI, REYNOLDS, "G/(ρU²)", "Re",
          [(1e-4, 1e4), (1e-2, 1), (1, 100), (1000, 1e4)]),
    Group("extension", "a disc at a stagnation point", extension, MODULI, REYNOLDS, "G/(ρU²)", "Re",
          [(1e-4, 1e4), (1e-2, 100), (1, 100)]),
    Group("time_step", "time step over the automatic one", stepped,
          [.5, .8, 1, 1.1, 1.2, 1.5, 2, 3, 5, 10, 20, 50], list(STEPPED), "Δt / automatic Δt", "",
          [(1.2, k) for k in STEPPED], factor=True),
    Group("cells", "cells across a body", per_body, [6, 8, 12, 16, 24, 32, 48, 64], ["cavity", "random", "shear"],
          "cells", "", [(6, "cavity"), (6, "random"), (24, "shear")]),
    Group("thin", "plates three cells thick", thin, ["sheared", "across", "random", "cavity", "slab"], MODULI[1:-1:2] + [1000],
          "", "G/(ρU²)", [("sheared", 1e-3), ("random", 10), ("across", .1), ("slab", 1000)]),
    Group("contact", "touching walls and each other", contact, CONTACTS, THREE, "", "G/(ρU²)",
          [(k, 1) for k in CONTACTS[::2]] + [(k, 0.01) for k in CONTACTS[1::2]] + [(k, 100) for k in CONTACTS[-3:-1]]),
    Group("reversing", "walls that reverse", reversing, [0.1, 1, 10, 100, 1000], [0.01, 1, 100], "ω L/U", "G/(ρU²)",
          [(10, 1), (1000, 100)]),
    Group("stretched", "a released stretched ellipse", stretched, [1.5, 2, 3, 4, 5], MODULI[1:], "stretch", "G (ρ = L = 1, μ = 0.01)",
          [(1.5, 100), (3, 1), (5, 100)]),
    Group("layers", "shear layers too thin for the grid", layers, [0, 1e-6, 1e-5, 1e-4, 1e-3],
          [16, 32, 64, "32 disc", "64 disc"], "viscosity/(ρUL)", "cells", [(0, "32 disc"), (1e-5, 32)]),
    Group("nothing", "zero motion, modulus, force, viscosity", nothing, NOTHINGS, [0, 1, 1000], "", "G",
          [(k, 0) for k in NOTHINGS] + [(k, 1000) for k in NOTHINGS]),
    Group("flat_cells", "cells longer than high", flat_cells, [0.25, 0.5, 2, 4], [0.01, 1, 100], "length/height of a cell",
          "G/(ρU²)", [(4, 1)]),
    Group("solid", "3-D", solid, SOLIDS, [0.01, 1, 100], "", "G/(ρU²)", [("cavity", 1), ("lattice, touching", 0.01)]),
    Group("long", "a hundred thousand steps", long, ["rest", "shear", "cavity", "reversing"], [0.01, 1, 100], "", "G/(ρU²)"),
    Group("viscosity", "viscosity of a body over the fluid's", viscous, [.01, .05, .2, 5, 20, 100], VISCOUS, "contrast", "",
          [(.01, "cavity"), (100, "shear"), (100, "3-D")]),
    Group("crowd", "membranes between plates", crowd, [.2, .3], [1, 2], "hematocrit", "seed", [(.3, 1)], methods=("fast",)),  # membranes need it
    Group("corner", "a disc held in a corner to t = 60", corner, [16, 24], MODULI[1:-1], "cells of the box", "G/(ρU²)",
          [(16, 0.01)]),
]
