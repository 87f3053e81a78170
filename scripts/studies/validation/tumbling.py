"""V7: capsules and red cells that tumble or tank-tread in shear flow (ellipsoids.py). V5: three revolutions of the membrane of a
capsule, after a boundary-integral method (tests/reference/capsule_startup.csv). docs/method.md, section 18."""
import functools

import numpy

from . import ellipsoids
from .bodies import fast_at
from .case import Case, Measure

BOX = (4, 5, 4)  # in radii: what walls add to the strain rate there, images nearly take away


def strain(run):
    return run.bodies.time * 2 * float(run.options["boundary_ymax_velocity"].split(",")[0]) / run.length[1]


def turned(run):
    """Returns the angle by which the long axis has turned, in degrees, clockwise and accumulated over full turns."""
    inclination = numpy.unwrap(run.bodies.inclination[:, 0], period=180)
    return inclination[0] - inclination


def gone_round(run):
    """Returns the angle by which the material has rotated."""
    t, speed = run.bodies.time, run.bodies.turning_rate[:, 0]
    return numpy.degrees(-numpy.append(0, numpy.cumsum(numpy.diff(t) * (speed[1:] + speed[:-1]) / 2)))


def when(angle, of, what=strain):
    """Returns the quantity `what` at the moment when an angle is reached; NaN if it is not reached."""
    def value(run):
        found = numpy.maximum.accumulate(of(run))
        return float(numpy.interp(angle, found, what(run))) if found[-1] >= angle else float("nan")
    return value


def deformation(run):
    return run.bodies.taylor_deformation[:, 0]


def long_axis(run):
    return strain(run), run.bodies.inclination[0, 0] - turned(run)


def cells(n, box=BOX):
    return {"grid_cells": ",".join(str(n * side) for side in box), "snapshot_interval": 0}


# V5: neo-Hookean, Ca = .15. The membrane turns as the vorticity does, to which walls and images add what they do to a sphere.
LONG_BOX = (5, 6, 5)
PERIOD, STEADY = 14.71, .2704
AXES = {"L": 1.2569, "B": .7218, "W": 1.0930}


def period_in(box):
    xy, yx = ellipsoids.images(box)[:2]
    return PERIOD / (1 - 10 / 3 * numpy.pi * (yx - xy))


def long_run(n, _):
    wall = LONG_BOX[1] / 2
    return {**cells(n, LONG_BOX), "grid_length": ",".join(map(str, LONG_BOX)), "boundary_ymin_velocity": f"{-wall},0,0",
            "boundary_ymax_velocity": f"{wall},0,0", "time_end": 47.5, "series_interval": .1, "snapshot_interval": 47.5}


def semi_axes(run):
    """Returns, at the end, the semi-axes of the ellipsoid with the same second moments, corrected for those of the grid cells: the
    long and the short one in the plane of the shear, and the one across it."""
    snapshot = run.snapshots[-1]
    phi = snapshot["solid_fraction"].astype(float)
    places = numpy.meshgrid(*snapshot.coordinates("solid_fraction")[::-1], indexing="ij")[::-1]
    away = [x - (phi * x).sum() / phi.sum() for x in places]
    moments = [[5 * (phi * x * y).sum() / phi.sum() for x in away] for y in away]
    squares = numpy.array(moments) - 5 / 12 * numpy.diag(numpy.square(run.spacing))
    short, long = numpy.sqrt(numpy.linalg.eigvalsh(squares[:2, :2]))
    return {"L": float(long), "B": float(short), "W": float(numpy.sqrt(squares[2, 2]))}


def area(run):
    return run.bodies.surface_area[:, 0]


def after_three(what, ours, asked, wanted):
    return Measure(f"after three revolutions: {what}", ours, {"fast": lambda n: asked * max(1, 12 / n)},
                   f"goal: {100 * asked:g} % at 12 cells per radius", wanted, True)


LONG = Case(
    "V5", "Capsule in shear flow, three revolutions", "capsule_in_shear", long_run, fast_at((8, 12)), (),
    (after_three("D", when(1080, gone_round, deformation), .01, STEADY),
     *(after_three(f"semi-axis {name}", lambda run, name=name: semi_axes(run)[name], .03, wanted) for name, wanted in AXES.items()),
     after_three("area over that after one revolution", lambda run: when(1080, gone_round, area)(run) / when(360, gone_round, area)(run),
                 .005, 1),
     after_three("period of the membrane over that in this box", lambda run: when(1080, gone_round)(run) / (3 * period_in(LONG_BOX)), .03, 1),
     Measure("after three revolutions: change of volume", lambda run: float(abs(run.bodies.volume[-1, 0] / run.bodies.volume[0, 0] - 1)),
             {"fast": 1e-6}, "goal")),
    lambda run: ((strain(run), deformation(run)), ([4, strain(run)[-1]], [STEADY, STEADY])), ("shear x time", "D"))


# Inside 50 times as viscous, the elastic stress of the membrane a part of that: a drop without tension, which is exact.
OBLATE, VISCOUS, RIGID = (1, .5, 1), 50, 1e9


@functools.lru_cache
def drop(ratio):
    times = numpy.arange(0, 12.01, .1)
    return times, ellipsoids.drop(OBLATE, 90, ratio, times, BOX)


def of_drop(ratio, angle, column=None):
    """Returns the strain, or a column of ellipsoids.drop, at the moment when the ellipsoid has turned by this angle."""
    times, found = drop(ratio)
    return float(numpy.interp(angle, 90 - found[:, 1], times if column is None else found[:, column]))


def beside(ratio):
    return lambda run: (long_axis(run), (drop(ratio)[0], drop(ratio)[1][:, 1]))


def viscous(n, _):
    return {**cells(n), "time_end": 12}


# Inside as outside, the membrane so stiff that it should turn as a rigid body does.
CAPILLARY = .05


def stiff(n, _):
    return {**cells(n), "capsule_viscosity": 1, "capsule_surface_shear_modulus": 1 / CAPILLARY}


# A red cell: does its shape go round with its material (1), or its material alone (0)?
def with_material(run):
    return (when(360, gone_round, turned)(run) - when(180, gone_round, turned)(run)) / 180


def red_cell(ratio, end):
    """Options of a red cell with viscosity 20, shear rate 6.6e-5, in a box of 4, 3 and 3 radii, as in the file."""
    return lambda n, _: {**cells(n, (4, 3, 3)), "cell_viscosity": 20 * ratio, "time_end": end / 6.6e-5,
                         "series_interval": .1 / 6.6e-5}


def drop_measure(what, ours, wanted, kept=None):
    return Measure(what, ours, {"fast": .03}, "goal: 3 %; the reference contains walls and images to leading order", wanted, True,
                   misses={"fast": (kept, "beyond a viscosity ratio of 20 the velocity lags by several steps")} if kept else {})


def motion(what, expected):
    return Measure(f"{what}: rotation of the long axis over that of the material", with_material, {"fast": .25},
                   "0 for tank-treading, 1 for tumbling", expected)


CASES = (
    LONG,
    Case("V7", "Oblate capsule, 50 times as viscous inside", "tumbling_capsule", viscous, fast_at((8,)), (),
         (drop_measure("shear strain until half a turn", when(180, turned), of_drop(VISCOUS, 180), .15),
          drop_measure("D after a quarter turn", when(90, turned, deformation), of_drop(VISCOUS, 90, 0)),
          drop_measure("D after half a turn", when(180, turned, deformation), of_drop(VISCOUS, 180, 0), .04)),
         beside(VISCOUS), ("strain", "inclination, degrees; inside 50 times as viscous")),
    Case("V7", "Oblate capsule, Ca = .05", "tumbling_capsule", stiff, fast_at((8,)), (),
         (Measure("stiff membrane: shear strain until half a turn", when(180, turned), {"fast": .05},
                  "the reference is a rigid body; the effect of Ca on the angle has vanished after half a turn", of_drop(RIGID, 180), True),
          Measure("stiff membrane: D when the material has turned by pi", when(180, gone_round, deformation), {"fast": 25 / 12 * CAPILLARY},
                  "the reference is D at rest; the flow adds at most 25/12 Ca, as to a sphere", 1 / 3)),
         beside(RIGID), ("strain", "inclination, degrees; stiff membrane")),
    Case("V7", "Red cell, viscosity ratio .3", "red_cell_in_shear", red_cell(.3, 24), fast_at((10,)), (),
         (motion("ratio .3", 0),), lambda run: (long_axis(run), None), ("strain", "inclination, degrees; red cell, viscosity ratio .3")),
    Case("V7", "Red cell, viscosity ratio 20", "red_cell_in_shear", red_cell(20, 36), fast_at((10,)), (),
         (motion("ratio 20", 1),), lambda run: (long_axis(run), None), ("strain", "inclination, degrees; red cell, viscosity ratio 20")),
)
