"""V5: a capsule in shear flow, by a boundary-integral method in unbounded Stokes flow; docs/method.md, section 18."""
import numpy

from .bodies import fast_at
from .case import Case, Measure, reference

START = reference("capsule_startup")


def deformation(time):
    def value(run):
        return float(numpy.interp(time, run.bodies.time, run.bodies.taylor_deformation[:, 0]))
    return value


def drift(run):
    return float(abs(run.bodies.volume[-1, 0] / run.bodies.volume[0, 0] - 1))


def line(run):
    return (run.bodies.time, run.bodies.taylor_deformation[:, 0]), (START[:, 0], START[:, 1])


def options(n, _):
    return {"grid_cells": f"{8 * n},{8 * n},{6 * n}", "snapshot_interval": 0}


def measure(time):
    return Measure(f"D at shear x time {time}", deformation(time), {"fast": lambda n: .01 * max(1, 12 / n)},
                   "asked for: 1 % at 12 cells per radius", float(numpy.interp(time, START[:, 0], START[:, 1])), True,
                   misses={"fast": (lambda n: .025 * max(1, 12 / n), "the force is spread, which smooths the velocity's kink: of first order; "
                                    "walls and images are not in the reference")})


CASES = (
    Case("V5", "Capsule in shear flow, neo-Hookean, Ca = .15", "capsule_in_shear", options, fast_at((8, 12)), fast_at((6,)),
         (measure(.64), measure(1.28), measure(1.92),
          Measure("change of volume", drift, {"fast": 1e-5}, "of the divergence, as AREA of S10")),
         line, ("shear x time", "D")),
)
