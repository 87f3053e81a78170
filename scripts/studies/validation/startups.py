"""V9: capsules of both laws, with viscosities other than that of the fluid, in shear flow from rest, against a boundary-integral method
(boundary_integral.py, capsule_startups) with the contributions of walls and images. docs/method.md, section 18.
"""
import numpy

from .bodies import fast_at
from .boundary_integral import STARTUPS
from .case import Case, Measure, reference

LAWS = {"neo_hookean": "neo-Hookean", "skalak": "Skalak"}


def at(time, quantity):
    return lambda run: float(numpy.interp(time, run.bodies.time, getattr(run.bodies, quantity)[:, 0]))


def drift(run):
    return float(abs(run.bodies.volume[-1, 0] / run.bodies.volume[0, 0] - 1))


def case(start):
    known = reference(start.name)
    label = f"{LAWS[start.law]}, Ca = {start.capillary:g}, ratio {start.ratio:g}"
    asked = .02 if start.ratio == 1 else .03

    def options(n, _):
        return {"grid_cells": ",".join(str(n * side) for side in start.box), "grid_length": ",".join(map(str, start.box)),
                "capsule_membrane_law": start.law, "capsule_surface_shear_modulus": 1 / start.capillary, "capsule_viscosity": start.ratio,
                "time_end": start.end, "series_interval": start.interval, "snapshot_interval": 0}

    def deformation(time):
        return Measure(f"{label}: D at shear x time {time:g}", at(time, "taylor_deformation"), {"fast": lambda n: asked * max(1, 12 / n)},
                       f"goal: {100 * asked:g} % at 12 cells per radius; first order",
                       float(numpy.interp(time, known[:, 0], known[:, 3])), True)
    quick = start.law == "skalak" and start.capillary == .3 and start.ratio == 1
    return Case("V9", f"Capsule in shear flow, {label}", "capsule_in_shear", options, fast_at((8, 12)), fast_at((6,)) if quick else (),
                (*(deformation(start.end * part / 3) for part in (1, 2, 3)),
                 Measure(f"{label}: inclination at the end, degrees", at(start.end, "inclination"), {"fast": lambda n: 1 * max(1, 12 / n)},
                         "goal: 1 degree at 12 cells per radius", float(known[-1, 4])),
                 Measure(f"{label}: change of volume", drift, {"fast": 1e-5}, "the volume changes by div v only, as the area in S10")),
                lambda run: ((run.bodies.time, run.bodies.taylor_deformation[:, 0]), (known[:, 0], known[:, 3])),
                ("shear x time", f"D, {label}"), (deformation(start.end / 3),), {"time_end": start.end / 3})


CASES = tuple(case(start) for start in STARTUPS[1:])  # the first is V5
