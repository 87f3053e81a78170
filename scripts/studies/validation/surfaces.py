"""L4, S11: surfaces of solids that are oblique to the grid."""
import math

import numpy

from . import exact
from .case import Case, Measure, every, rms

FAST = {"methods": ("fast",), "solvers": ("acm",)}

# L4: layers normal to (1, 1) in a periodic box of side 1 with n and 3 n/4 cells, eta = (x + y - 1)/sqrt 2, one of each.
MU = 0.05
LAYERS = exact.TurnedLayers(half=math.sqrt(0.125), mu=MU, modulus=1, strain=0.3, guess=-2.6 + 6.1j)
PERIOD = 2 * math.pi / LAYERS.s.imag
MEAN = (1.0, 0.5)


def layer_cells(n):
    return n, 3 * n // 4


def eta(n, at_x, at_y, moved=0.0):
    """Returns the coordinate eta at (i + at_x) h_x, (j + at_y) h_y."""
    nx, ny = layer_cells(n)
    return ((numpy.arange(nx) + at_x) / nx + ((numpy.arange(ny) + at_y) / ny)[:, None] - 1 - moved) / math.sqrt(2)


def fraction(n):
    """Returns the solid fraction of every cell for |x + y - 1| < 1/4 and its periodic images. The area below x + y = c is a difference
    of squares."""
    nx, ny = layer_cells(n)
    hx, hy = 1 / nx, 1 / ny
    low = numpy.arange(nx) * hx + (numpy.arange(ny) * hy)[:, None]

    def below(c):
        d = [numpy.maximum(c - low - part, 0)**2 for part in (0, hx, hy, hx + hy)]
        return (d[0] - d[1] - d[2] + d[3]) / (2 * hx * hy)
    return numpy.clip(below(1.25) - below(0.75) + below(0.25) + 1 - below(1.75), 0, 1)


def layer_start(mean):
    def start(n):
        gamma, edge = (LAYERS.shear(eta(n, at, at), 0) for at in (0.5, 0))
        u, v = (s * LAYERS.velocity(eta(n, *at), 0) / math.sqrt(2) for s, at in ((1, (0, 0.5)), (-1, (0.5, 0))))
        fields = {"velocity_x": u + mean[0], "velocity_y": v + mean[1], "solid_fraction": fraction(n),
                  "left_cauchy_green_xx": 1 + gamma + gamma**2 / 2, "left_cauchy_green_yy": 1 - gamma + gamma**2 / 2,
                  "left_cauchy_green_xy": -edge**2 / 2}
        return {name: field[None] for name, field in fields.items()}
    return start


def exact_velocity(run, mean):
    """Returns the exact u on the faces normal to x, at the time of the last snapshot."""
    snapshot = run.snapshots[-1]
    return mean[0] + LAYERS.velocity(eta(run.cells[0], 0, 0.5, sum(mean) * snapshot.time), snapshot.time) / math.sqrt(2)


LARGEST = float(numpy.abs(LAYERS.velocity(numpy.linspace(0, LAYERS.half, 1001), 0)).max() / math.sqrt(2))


def layers_error(mean):
    return lambda run: rms(run.snapshots[-1]["velocity_x"][0] - exact_velocity(run, mean)) / LARGEST


def layers_line(mean):
    def line(run):
        j, x = run.cells[1] // 2, numpy.arange(run.cells[0]) / run.cells[0]
        return (x, run.snapshots[-1]["velocity_x"][0, j]), (x, exact_velocity(run, mean)[j])
    return line


def layers(title, grid, line, error, start, least, full, quick, kept={}):
    end = PERIOD / 2
    return Case("L4", f"Layers {title}", "taylor_green_advected",
                lambda n, _: {**grid(n), "fluid_viscosity": MU, "species": "layer", "layer_shear_modulus": 1, "time_end": end,
                              "series_interval": end, "snapshot_interval": end, "snapshot_fields": "velocity",
                              "snapshot_precision": "double"},
                every(full, **FAST), every(quick, **FAST),
                (Measure(f"{title}: rms error of u after half a period, relative to the largest initial u", error, {},
                         "reported: the order is judged", order={"fast": least}, order_misses=kept),),
                line, ("x or y", f"u, {title}"), start=start)


def turned(what, mean):
    return layers(f"at 45 degrees, {what}", lambda n: {"grid_cells": "{},{},1".format(*layer_cells(n)), "grid_length": "1,1,1"},
                  layers_line(mean), layers_error(mean), layer_start(mean), 1.6, (32, 64, 128), (32, 64),
                  {"fast": (-.1, "the remaining error at the surface is of first order (docs/method.md, section 7)")})


# The same layers along the cells, surfaces on faces: what the program has of second order without cut cells.
def straight_y(n, at_y):
    return ((numpy.arange(n) + at_y) / n - 0.5) * 2 * LAYERS.half


def straight_start(n):
    y, gamma = straight_y(n, 0.5), LAYERS.shear(straight_y(n, 0.5), 0)
    fields = {"velocity_x": LAYERS.velocity(y, 0), "velocity_y": 0 * y, "solid_fraction": 1.0 * (numpy.abs(y) < LAYERS.half / 2),
              "left_cauchy_green_xx": 1 + gamma**2, "left_cauchy_green_yy": 0 * y + 1,
              "left_cauchy_green_xy": LAYERS.shear(straight_y(n, 0), 0)}
    return {name: numpy.tile(field[:, None], (1, 1, 4)) for name, field in fields.items()}


def straight_line(run):
    s, y = run.snapshots[-1], straight_y(run.cells[1], 0.5)
    return (y, s["velocity_x"][0, :, 0] / math.sqrt(2)), (y, LAYERS.velocity(y, s.time) / math.sqrt(2))


def straight_error(run):
    (_, found), (_, want) = straight_line(run)
    return rms(found - want) / LARGEST


# S11: 8 cells per radius at n = 20
RADIUS, DRIVE, VISCOSITY = 0.4, 0.5, 0.1


def flow_rate(run):
    """Returns the flow rate relative to Poiseuille's, in a box of cross-section 1. The wall rests, so that all of u counts."""
    return run.summary["bulk_velocity"] / (math.pi * RADIUS**4 * DRIVE / (8 * VISCOSITY))


def tube_line(run):
    y = run.profile["y"].y - 0.5
    return (y, run.profile["y"].velocity_x), (y, numpy.maximum(DRIVE * (RADIUS**2 - y**2) / (4 * VISCOSITY), 0))


def tube(modulus):
    return Case("S11", f"Steady flow in a tube with an elastic wall, G = {modulus}", "poiseuille_startup",
                lambda n, _: {"grid_cells": f"4,{n},{n}", "grid_length": f"{4 / n},1,1", "boundary_z": "wall",
                              "fluid_viscosity": VISCOSITY, "body_force": f"{DRIVE},0,0", "time_step": 0, "time_end": 2.5,
                              "series_interval": 0.5, "probe_points": f"{2 / n},0.5,0.5", "profile_y": f"{2 / n},0.5",
                              "profile_interval": 0, "species": "vessel", "vessel_shape": "tube", "vessel_axis": "x",
                              "vessel_radius": RADIUS, "vessel_shear_modulus": modulus},
                every((20, 40), **FAST), every((20,), **FAST) if modulus > 1 else (),
                (Measure(f"G = {modulus}: flow rate relative to Poiseuille's", flow_rate, {"fast": lambda n: .03 * (20 / n)**2},
                         "goal: 3 % at 8 cells per radius, second order", 1, True),),
                tube_line, ("y", f"u, G = {modulus}"))


CASES = (
    turned("at rest", (0, 0)), turned("carried", MEAN),
    layers("along the cells", lambda n: {"grid_cells": f"4,{n},1", "grid_length": f"{8 * LAYERS.half / n},{2 * LAYERS.half},1"},
           straight_line, straight_error, straight_start, 1.9, (32, 64, 128), (32, 64)),
    tube(100), tube(1),
)
