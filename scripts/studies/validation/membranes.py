"""V3: a ring that relaxes by bending, and one that relaxes along its surface. V4: a capsule with small deformation. V5: a capsule in
shear flow against a boundary-integral method, with the effect of walls and images. V6: a red cell in optical tweezers, against the
experiment. V8: a capsule carried by a uniform flow. docs/method.md, section 18."""
import numpy

from . import ellipsoids
from .bodies import fast_at
from .boundary_integral import STARTUPS
from .case import Case, Measure, Setting, reference, square

UNBOUNDED = reference("capsule_startup")
# V5: what walls and images of the box do to D, by capsule_startups.
BOXED = reference(STARTUPS[0].name)
START = UNBOUNDED[:, :2].copy()
START[1:, 1] *= numpy.interp(UNBOUNDED[1:, 0], BOXED[1:, 0], BOXED[1:, 3] / BOXED[1:, 1])


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
                   "goal: 1 % at 12 cells per radius", float(numpy.interp(time, START[:, 0], START[:, 1])), True)


# V3: the second mode of a disc decays as that of a drop with the tension E_b/R^2, times n^2 - 3/2. In a periodic box of four
# radii the drop's rate is .6528 of that in unbounded flow (Fourier transforms; tests/convergence/drop_test.cpp).
RING = dict(zip(reference("ring_2d")[:, 0], reference("ring_2d")[:, 3]))
BEND = 2.5 * RING[1] * .6528


def bending_rate(run):
    t, d = run.bodies.time, run.bodies.taylor_deformation[:, 0]
    late = t > .25 * t[-1]
    return float(-numpy.polyfit(t[late], numpy.log(d[late]), 1)[0])


# An ellipse stretched from a disc: its strain relaxes along the surface, at .4547 E_s/(mu R) in that box (unbounded: 1/2),
# an eigenvalue of the membrane's tension and the Fourier series of the velocity on it. E_s = 4 G_s = 1.
SLIP = .4547


def slipping(n, _):
    return {**square(4 * n, 4), "ring_bending_modulus": 0, "ring_surface_shear_modulus": .25, "ring_initial_stretch": "1.02,0.98039216,1",
            "ring_semi_axes": "1.02,0.98039216,1", "time_end": 1.5, "series_interval": .05, "snapshot_interval": 0}


def slip_rate(run):
    t, energy = run.series.time, run.series.surface_energy
    late = t > .2
    return float(-numpy.polyfit(t[late], numpy.log(energy[late]), 1)[0] / 2)


def bending_line(run):
    t, d = run.bodies.time, run.bodies.taylor_deformation[:, 0]
    fine, begin = numpy.linspace(0, t[-1], 101), .25 * t[-1]
    return (t, d), (fine, float(numpy.interp(begin, t, d)) * numpy.exp(-BEND * (fine - begin)))


def slip_line(run):
    t, energy = run.series.time, run.series.surface_energy
    fine = numpy.linspace(0, t[-1], 101)
    return (t, energy), (fine, float(numpy.interp(.2, t, energy)) * numpy.exp(-2 * SLIP * (fine - .2)))


def bending_energy(run):
    return float(run.bodies.bending_energy[-1, 0] / numpy.pi)


# V4: D/Ca of small deformation, whose membrane turns as a rigid sphere: walls and images raise the shear by the first order
# of such a sphere (drops.py, l -> infinity).
CAPILLARY = .03
SMALL = {row[1]: row[2:4] for row in reference("capsule_linear") if row[0] == 1}[3]  # D/Ca, slow rate of decay


def small(key, _):
    n, box = key
    return {"grid_cells": ",".join([str(n * box)] * 3), "grid_length": ",".join([str(box)] * 3),
            "boundary_ymin_velocity": f"{-box / 2},0,0", "boundary_ymax_velocity": f"{box / 2},0,0",
            "capsule_surface_shear_modulus": 1 / CAPILLARY, "time_end": .6, "series_interval": .02, "snapshot_interval": 0}


def small_limit(run):
    """Returns D/Ca with these walls and images."""
    return SMALL[0] / (1 - 10 / 3 * numpy.pi * ellipsoids.images(run.length)[:2].sum())


def excess(run):
    return float(run.bodies.taylor_deformation[-1, 0] / CAPILLARY / small_limit(run))


def small_line(run):
    return (run.bodies.time, run.bodies.taylor_deformation[:, 0] / CAPILLARY), (run.bodies.time[[0, -1]], [small_limit(run)] * 2)


def slow_rate(run):
    """Returns the rate at which D approaches its end, from the decay of its derivative."""
    t, d = run.bodies.time, run.bodies.taylor_deformation[:, 0]
    middle, slope = (t[1:] + t[:-1]) / 2, numpy.diff(d) / numpy.diff(t)
    late = (middle > .12) & (middle < .4)
    return float(-numpy.polyfit(middle[late], numpy.log(slope[late]), 1)[0] * CAPILLARY)


def unbounded_rate(runs):
    """Returns the rate on the finest grid, corrected for walls and images by (a/L)^3, from two boxes on the coarsest grid."""
    rates = {key: slow_rate(run) for key, run in runs.items()}
    if len(rates) < 3:
        return list(rates.values())[-1]
    (n, box), (_, larger), finest = rates
    images = (rates[n, larger] - rates[n, box]) / (larger**-3. - box**-3.)
    return rates[finest] - images * finest[1]**-3.


# V6: force in pN: what is measured there, um: long and short diameter of the silhouette, each with its error.
TWEEZERS = {round(row[0]): row for row in reference("mills_2004_tweezers")[[0, 2, 5, 7, 9, 12]]}


def tweezers(force, _):
    return {"cell_stretch_force": TWEEZERS[force][0] / 1000, "snapshot_interval": 1000, "guard_energy_growth": "off"}


def diameters(run):
    """Returns the diameters along x and y of the silhouette along z of the surface phi = 1/2."""
    silhouette = run.snapshots[-1]["solid_fraction"].max(axis=0)
    found = []
    for across, spacing in ((0, run.spacing[0]), (1, run.spacing[1])):
        line = silhouette.max(axis=across)
        first, *_, last = numpy.flatnonzero(line >= .5)
        ends = [(line[at] - .5) / (line[at] - line[beyond]) for at, beyond in ((first, first - 1), (last, last + 1))]
        found.append(float((last - first + sum(ends)) * spacing))
    return found


def tweezer_measures():
    for force, (_, *measured) in TWEEZERS.items():
        for d, name in enumerate(("axial", "transverse")):
            yield Measure(f"{name} diameter at {force} pN, um", lambda runs, force=force, d=d: diameters(runs[force])[d],
                          {"fast": measured[2 * d + 1]}, "the experiment's error bar", measured[2 * d], whole=True,
                          misses={"fast": (measured[2 * d + 1] + .3, "the computed cell is wider, and the grid is not the cause (see the notes)")} if d else {})


def tweezer_line(runs):
    """Returns the axial and then the transverse diameters over the force, with the error bars of the experiment."""
    found = numpy.array([(TWEEZERS[force][0], *diameters(run)) for force, run in runs.items()])
    force, axial, axial_error, transverse, transverse_error = reference("mills_2004_tweezers").T

    def joined(one, other):
        return numpy.concatenate([one, [numpy.nan], other])
    return ((joined(found[:, 0], found[:, 0]), joined(found[:, 1], found[:, 2])),
            (joined(force, force), joined(axial, transverse), joined(axial_error, transverse_error)))


def largest_change(name):
    def value(runs):
        changes = [abs(getattr(run.bodies, name)[-1, 0] / getattr(run.bodies, name)[0, 0] - 1) for run in runs.values()]
        return float(max(changes))
    return value


# V8: exact, as L3: nothing deforms in a uniform flow. An oblate capsule, turned by 30 degrees, at rest but for the flow.
def carried(n, _):
    return {"grid_cells": f"{3 * n},{3 * n},{3 * n}", "grid_length": "3,3,3", "initial_velocity": "uniform", "initial_velocity_mean": "1,.5,0",
            "fluid_density": .1, "ring_semi_axes": "1,.5,1", "ring_orientation": "0,0,30", "ring_bending_modulus": 0,
            "ring_surface_shear_modulus": 20, "time_end": 3, "series_interval": .25, "snapshot_interval": 0}


def change_carried(quantity):
    return lambda run: float(abs(getattr(run.bodies, quantity)[-1, 0] / getattr(run.bodies, quantity)[0, 0] - 1))


CASES = (
    Case("V3", "Ring relaxing by bending", "bending_ring", lambda n, _: {**square(4 * n, 4), "snapshot_interval": 0},
         fast_at((8, 16)), fast_at((8,)),
         (Measure("rate of relaxation by bending in this box", bending_rate, {"fast": lambda n: .08 * max(1, (12 / n)**2)},
                  "2 % of second order, and the error of the curvature, .03 to .06 depending on the position of the ring in the grid", BEND, True),
          Measure("bending energy relative to that of a disc", bending_energy, {"fast": lambda n: .06 * max(1, (12 / n)**2)},
                  "the ring still deviates from a disc by .03, which contributes .01; second order", 1, True)),
         bending_line, ("t", "D; in this box, linear")),
    Case("V3", "Ring relaxing along its surface", "bending_ring", slipping,
         fast_at((8, 16, 32)), fast_at((8,)),
         (Measure("rate of relaxation along the surface in this box", slip_rate, {"fast": lambda n: 2.72 / n},
                  "goal: 17 % at 16 cells per radius; first order", SLIP, True),),
         slip_line, ("t", "energy; in this box, linear")),
    Case("V4", "Capsule in shear flow, small deformation", "capsule_in_shear", small,
         fast_at(((8, 6), (8, 8), (12, 6))), fast_at(((6, 5),)),
         (Measure("D/Ca relative to 25/12 with these walls", excess, {"fast": lambda key: .04 * max(1, 16 / key[0])},
                  "goal: 4 % at 16 cells per radius; first order", 1, True),
          Measure("slow rate of decay, in G_s/(mu a), unbounded", unbounded_rate, {"fast": lambda key: .04 * max(1, 16 / key[0])},
                  "as D/Ca", SMALL[1], True, whole=True)),
         small_line, ("shear x time", "D/Ca; limit of small deformation")),
    Case("V5", "Capsule in shear flow, neo-Hookean, Ca = .15", "capsule_in_shear", options, fast_at((8, 12)), fast_at((6,)),
         (measure(.64), measure(1.28), measure(1.92),
          Measure("change of volume", drift, {"fast": 1e-5}, "the volume changes by div v only, as the area in S10")),
         line, ("shear x time", "D")),
    Case("V6", "Red cell in optical tweezers", "red_cell_in_tweezers", tweezers, (Setting("fast", "acm", tuple(TWEEZERS)),), (),
         (*tweezer_measures(),
          Measure("largest change of the membrane's area", largest_change("surface_area"), {}, "the modulus of area is a thousandth of a real one",
                  whole=True),
          Measure("largest change of volume", largest_change("volume"), {"fast": 1e-5}, "the volume changes by div v only, as the area in S10", whole=True),
          Measure("energy made by the numerics over that held and supplied, largest", lambda runs: max(run.summary["energy_made_share"] for run in runs.values()),
                  {"fast": .01}, "goal", whole=True,
                  misses={"fast": (.6, "with the largest force, the uneven tension along the cell keeps driving a slow flow along its surface, and a run with "
                                   "-guard_energy_growth would be stopped")})),
         tweezer_line, ("force, pN", "axial and transverse diameter, um"), whole_curve=True),
    Case("V8", "Capsule carried by a uniform flow, 3.4 radii along (2, 1)", "bending_ring", carried, fast_at((8, 12)), fast_at((6,)),
         (Measure("change of D", change_carried("taylor_deformation"), {"fast": lambda n: .04 * (8 / n)**2},
                  "exact: a uniform flow deforms nothing; 4 % at 8 cells per radius, second order"),
          Measure("change of the area", change_carried("surface_area"), {"fast": lambda n: .005 * (8 / n)**2}, "as the area in V5; second order",
                  misses={"fast": (lambda n: .0065 * (8 / n)**2, "the area changes at the start, since planes of exact fractions have less area "
                                   "than those of a surface that has moved, and is constant afterwards")}),
          Measure("change of volume", drift, {"fast": 1e-5}, "the volume changes by div v only, as the area in S10")),
         lambda run: ((run.bodies.time, run.bodies.taylor_deformation[:, 0]), (run.bodies.time[[0, -1]], [1 / 3, 1 / 3])), ("t", "D")),
)
