"""S6 to S10, R1: free bodies."""
import math
import threading

import numpy

from . import exact
from .case import Case, Measure, every, reference, rms, square

IMPORTING = threading.Lock()  # a module that another thread imports is not whole yet

ASKED = "goal: 1 % at 16 cells per radius"
RATE = 0.05  # shear rate of disc_in_shear and sphere_in_shear, viscosity 1: inertia rho gd R^2/mu = .05


def last(name):
    return lambda run: run.summary["bodies"][0][name]


def body_line(name):
    return lambda run: ((run.bodies.time, getattr(run.bodies, name)[:, 0]), None)


def fast_at(*ladders):
    return tuple(setting for keys in ladders for setting in every(keys, methods=("fast",), solvers=("acm",)))


# S6
def disc_in_shear(capillary, quick=False):
    """Returns the case. Walls 16 R apart raise the shear rate by 1/(1 - 7.7445 (R/H)^2). The period is 32 R, since images at 16 R
    lower D. The density is .1: with 1 (rho gd R^2/mu = .05) inertia raises D and rotates the disc."""
    deformation, angle = exact.disc_in_shear(capillary / (1 - 7.7445 / 256))
    end = 18 * capillary / RATE

    def line(run):
        return (run.bodies.time, run.bodies.taylor_deformation[:, 0]), ([0, end], [deformation] * 2)
    return Case(
        "S6", f"Disc in shear flow, Ca = {capillary}", "disc_in_shear",
        lambda n, _: {"grid_cells": f"{2 * n},{n},1", "grid_length": "32,16,1", "disc_shear_modulus": RATE / capillary, "time_end": end, "snapshot_interval": 0,
                      "fluid_density": 0.1},
        every((64, 128, 256), methods=("fast",), solvers=("acm",)) + every((64, 128), methods=("fast",), solvers=("smac",))
        + every((64, 128), methods=("classic",), solvers=("acm",), fluid_density=1),
        every((64, 128), methods=("fast",), solvers=("acm",)) if quick else (),
        (Measure(f"Ca {capillary}: Taylor deformation", last("taylor_deformation"), {"fast": lambda n: .01 * (256 / n)},
                 ASKED, deformation, True),
         Measure(f"Ca {capillary}: inclination, degrees", last("inclination"), {"fast": lambda n: .5 * (256 / n)},
                 "goal: the rotation that 1 % of a radius causes at D = .1, with 16 cells per radius", angle)),
        line, ("t", f"D, Ca = {capillary}"))


# S7
LET_GO = dict(zip((.5, 1, 2), exact.relaxing_disc(1.5, 20, (.5, 1, 2))))


def stretch_at(t):
    def stretch(run):
        d = numpy.interp(t, run.bodies.time, run.bodies.taylor_deformation[:, 0])
        return float(numpy.sqrt((1 + d) / (1 - d)))
    return stretch


def stretch_line(run):
    d = run.bodies.taylor_deformation[:, 0]
    return (run.bodies.time / 100, numpy.sqrt((1 + d) / (1 - d))), ([0, *LET_GO], [1.5, *LET_GO.values()])


def relaxation(title, prefix, full, quick):
    return Case(
        "S7", title, "stretched_disc", lambda n, _: {**square(n, 20), "snapshot_interval": 0}, full, quick,
        tuple(Measure(f"{prefix}stretch at G t/mu = {t}", stretch_at(100 * t),
                      {"fast": lambda n, part=(want - 1): .01 * part * (320 / n)},
                      ASKED + ", relative to the stretch minus 1", want)
              for t, want in LET_GO.items()),
        stretch_line, ("G t/mu", prefix + "stretch"))


# S8
def limit(name, slope=False):
    """Extrapolates to an unbounded fluid and h -> 0: least squares of D_0 + a (R/L)^3 + b (h/R)^2, without b at a single resolution.
    `slope`: returns b/D_0."""
    def value(runs):
        terms = [[1, box**-3.] + [n**-2.] * (len({n for n, _ in runs}) > 1) for n, box in runs]
        found = [last(name)(run) for run in runs.values()]
        if numpy.linalg.matrix_rank(terms) < len(terms[0]):
            raise ValueError("too few boxes and resolutions for an extrapolation")
        fit = numpy.linalg.lstsq(numpy.array(terms), numpy.array(found), rcond=None)[0]
        return float(fit[2] / fit[0] if slope else fit[0])
    return value


def sphere(capillary, deformation, angle, time, keys, quick=()):
    """Returns the case. Keys are (cells per radius, box in radii); runs end at the shear strain `time`, when D is within .3 % of its
    final value."""
    def options(key, _):
        n, box = key
        return {"grid_cells": ",".join([str(n * box)] * 3), "grid_length": ",".join([str(box)] * 3),
                "boundary_ymin_velocity": f"{-RATE * box / 2},0,0", "boundary_ymax_velocity": f"{RATE * box / 2},0,0",
                "sphere_shear_modulus": RATE / capillary, "time_end": time / RATE, "snapshot_interval": 0}

    def line(run):
        return (run.bodies.time, run.bodies.taylor_deformation[:, 0]), ([0, time / RATE], [deformation] * 2)
    what = f"Ca {capillary}: %s, extrapolated"
    why = "goal: 1 % after extrapolation in (R/L)^3 and h^2 from 8 cells per radius on"
    return Case("S8", f"Sphere in shear flow, Ca = {capillary}", "sphere_in_shear", options,
                every(keys, methods=("fast",), solvers=("acm",)),
                every(quick, methods=("fast",), solvers=("acm",)) if quick else (),
                (Measure(what % "Taylor deformation", limit("taylor_deformation"), {"fast": .01}, why, deformation, True,
                         whole=True),
                 Measure(f"Ca {capillary}: relative error of D over (h/R)^2", limit("taylor_deformation", True), {}, "coefficient of the same fit",
                         whole=True),
                 Measure(f"Ca {capillary}: Taylor deformation in this box", last("taylor_deformation"), {},
                         "walls and periodic images increase D", deformation, True),
                 Measure(what % "inclination", limit("inclination"), {"fast": .5}, "goal, as in S6", angle, whole=True)),
                line, ("t", f"D, Ca = {capillary}; reference: unbounded"),
                (Measure(what % "Taylor deformation", limit("taylor_deformation"), {"fast": .05},
                         "goal: 1 % at 16 cells per radius (S6), of second order, so 7 % at 6; less after the extrapolation",
                         deformation, True, whole=True),))


# S9
def ringing(run):
    """Returns the times and the Taylor deformation relative to its start, with a sign for the direction of the long axis."""
    d = run.bodies.taylor_deformation[:, 0] * numpy.where(numpy.abs(run.bodies.inclination[:, 0]) < 45, 1, -1)
    return run.bodies.time, d / d[0]


RING = {0.01: reference("ringing_disc"), 0.001: reference("ringing_disc_thin")}


def ring(viscosity, limits, kept, settings, quick):
    """Returns the case. limits: tolerances at 80, 160, 320 cells; kept: second bounds, for rows that miss them."""
    want = RING[viscosity]

    def error(run):
        """Returns the rms error over the times of the reference, relative to the start."""
        return rms(numpy.interp(want[:, 0], *ringing(run)) - want[:, 1])
    asked, instead = [dict(zip((80, 160, 320), each)) for each in (limits, kept)]
    options = {"fluid_density": 1, "fluid_viscosity": viscosity, "disc_semi_axes": f"{.2 * 1.02},{.2 / 1.02},1",
               "disc_initial_stretch": f"1.02,{1 / 1.02},1", "disc_shear_modulus": 1, "time_end": 2, "series_interval": 0.02,
               "snapshot_interval": 0}
    return Case("S9", f"Ringing disc, viscosity {viscosity}", "stretched_disc", lambda n, _: {**square(n, 2), **options},
                settings, quick,
                (Measure(f"viscosity {viscosity}: rms error of the deformation to t = 2, relative to its start", error,
                         {"fast": lambda n: asked[n]}, "goal",
                         misses={"fast": (lambda n: instead[n], "the surface is of first order where viscosity damps waves of a "
                                          "cell, and waves shorter than a cell are lost")}),),
                lambda run: (ringing(run), (want[:, 0], want[:, 1])), ("t", f"D over its start, viscosity {viscosity}"))


# S10
PATH = reference("soft_disc_cavity")


def path_distance(begin, end):
    """Returns the largest distance of the centroid from the reference path."""
    def distance(run):
        t = PATH[(PATH[:, 0] >= begin) & (PATH[:, 0] <= end), 0]
        xy = [numpy.interp(t, run.bodies.time, run.bodies.centroid[:, 0, d]) for d in (0, 1)]
        want = [numpy.interp(t, PATH[:, 0], PATH[:, 1 + d]) for d in (0, 1)]
        return float(numpy.hypot(xy[0] - want[0], xy[1] - want[1]).max())
    return distance


AREA_DRIFT = {"fast, ACM": lambda n: 8e-7 * n / math.sqrt(math.pi * .2**2), "fast, SMAC": 1e-12}
AREA_WHY = "the area changes by div v only: T rms(div v)/sqrt(area) with rms(div v) h equal to the option -acm_tolerance; with SMAC round-off"


def drift(run):
    return float(numpy.abs(run.bodies.volume[:, 0] / run.bodies.volume[0, 0] - 1).max())


def path_line(run):
    here = PATH[:, 0] <= run.summary["time"] + 1e-9
    return (run.bodies.centroid[:, 0, 0], run.bodies.centroid[:, 0, 1]), (PATH[here, 1], PATH[here, 2])


# R1
def thickness(run):
    """Returns the thickness of the cell along its axis, y, on the lines of grid cells along z through the middle: (r, h)."""
    s = run.snapshots[0]
    h = s["solid_fraction"].astype(float).sum(axis=1) * run.spacing[1]
    k = run.cells[2] // 2
    r = numpy.hypot(run.centres(0) - run.length[0] / 2, run.centres(2)[k] - run.length[2] / 2)
    return numpy.sign(run.centres(0) - run.length[0] / 2) * r, h[k]


def middle_thickness(run):
    r, h = thickness(run)
    return float(h[numpy.abs(r) < 1].min())


def area(run):
    """Returns the area of the isosurface phi = 1/2, by marching cubes."""
    with IMPORTING:
        import vtk
        from vtk.util.numpy_support import numpy_to_vtk
    phi = run.snapshots[0]["solid_fraction"].astype(float)
    image = vtk.vtkImageData()
    image.SetDimensions(phi.shape[::-1])
    image.SetSpacing(*run.spacing)
    image.GetPointData().SetScalars(numpy_to_vtk(phi.ravel(), deep=True))
    surface, mass = vtk.vtkMarchingCubes(), vtk.vtkMassProperties()
    surface.SetInputData(image)
    surface.SetValue(0, 0.5)
    mass.SetInputConnection(surface.GetOutputPort())
    return mass.GetSurfaceArea()


def thickness_line(run):
    r, h = thickness(run)
    return (r, h), (r, exact.red_cell_thickness(numpy.abs(r)))


CASES = (
    disc_in_shear(.05), disc_in_shear(.1, quick=True), disc_in_shear(.2),
    relaxation("Released stretched disc", "", every((80, 160, 320), methods=("fast",), solvers=("acm",), time_step=0.25)
               + every((160,), methods=("fast",), solvers=("smac",), time_step=0.25)
               + every((40, 80), methods=("classic",), solvers=("acm",), fluid_density=1),
               every((80, 160), methods=("fast",), solvers=("acm",), time_step=1)),
    relaxation("Released stretched disc, automatic time step", "automatic step: ",
               every((80, 160, 320), methods=("fast",), solvers=("acm",)), ()),
    sphere(.05, .062058, 41.449, 1.6, ((8, 6), (8, 8), (12, 6), (16, 6))),
    sphere(.1, .121639, 38.065, 2.4, ((8, 6), (8, 8), (8, 10), (10, 6), (12, 6)), ((4, 6), (4, 8), (6, 6))),
    sphere(.2, .227328, 32.193, 4, ((8, 6), (8, 8), (12, 6))),
    *(ring(viscosity, limits, kept, fast_at((80,), (160,), (320,)) + more, fast_at((80,), (160,)))
      for viscosity, limits, kept, more in (
          (0.01, (.01, .003, .0015), (.01, .003, .003), every((160,), methods=("fast",), solvers=("smac",))
           + every((160,), methods=("classic",), solvers=("acm",))),
          (0.001, (.04, .013, .005), (.1, .02, .005), ()))),
    Case("S10", "Soft disc in the lid-driven cavity", "lid_cavity_disc", lambda n, _: {**square(n), "snapshot_interval": 0},
         every((64, 128, 256), solvers=("acm",)) + every((64, 128), methods=("fast",), solvers=("smac",)),
         every((64, 128), methods=("fast",), solvers=("acm",)),
         (Measure("distance from the path to t = 5", path_distance(0, 5), {"fast": lambda n: .005 * (256 / n)},
                  "difference of two published methods, .002, and about one cell at 256^2"),
          Measure("distance from the path to t = 8", path_distance(0, 8), {"fast": lambda n: .01 * (256 / n)},
                  "twice as much, after the disc has passed the lid"),
          Measure("drift of the area", drift, AREA_DRIFT, AREA_WHY)),
         path_line, ("x", "y"),
         (Measure("distance from the path to t = 2", path_distance(0, 2), {"fast": lambda n: .005 * (128 / n)},
                  "that of 256^2 to t = 5, scaled with h"),
          Measure("drift of the area", drift, AREA_DRIFT, AREA_WHY)), {"time_end": 2}, scales={"aspect": "equal"}),
    Case("R1", "The shape of a red cell", "channel_rbc",
         lambda n, _: {"grid_cells": f"{n},{n // 2},{n}", "grid_length": "10.56,5.28,10.56", "rbc_count": "1,1,1",
                       "time_steps_max": 1, "snapshot_interval": 1, "snapshot_precision": "double"},
         every((32, 64, 128), solvers=("acm",)), every((32, 64), methods=("fast",), solvers=("acm",)),
         (Measure("volume", lambda run: float(run.bodies.volume[0, 0]), {m: 5e-5 for m in ("fast", "classic")},
                  "the reference has five digits", 100.74, True),
          Measure("surface", area, {}, "marching cubes of exact cell fractions overestimate a surface, that of a sphere by .3 % at 24 cells "
                  "per radius, and by no less on finer grids", 140.33, True),
          Measure("thickness in the middle", middle_thickness, {m: lambda n: .02 * (64 / n)**2 for m in ("fast", "classic")},
                  "twice the difference between the axis and the cells beside it, .32 h^2, which is 1.04 % at 64 cells", .829, True),
          Measure("largest thickness", lambda run: float(thickness(run)[1].max()),
                  {m: lambda n: .02 * (64 / n)**2 for m in ("fast", "classic")}, "as in the middle, which is more curved", 2.625, True)),
         thickness_line, ("r", "thickness")),
)
