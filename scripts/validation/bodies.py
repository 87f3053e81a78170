"""S6 ... S10, R1: free bodies."""
import math

import numpy

from . import exact
from .case import Case, Measure, every, reference, square

RATE = 0.05  # shear rate of disc_in_shear and sphere_in_shear, viscosity 1: inertia rho gd R^2/mu = .05


def last(name):
    return lambda run: run.summary["bodies"][0][name]


def body_line(name):
    return lambda run: ((run.bodies.time, getattr(run.bodies, name)[:, 0]), None)


# S6
def disc_in_shear(capillary, quick=False):
    """Walls 16 R apart raise the shear rate by 1/(1 - 7.7445 (R/H)^2). Period 32 R: images at 16 R lower D by 1.6 %
    (8 cells per radius, Ca = .1: .10091, at 32 R .10254). Density .1: with 1 (rho gd R^2/mu = .05)
    inertia raises D by .9 % and turns the disc by .8 degrees."""
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
                 "1 % at 16 cells per radius", deformation, True),
         Measure(f"Ca {capillary}: inclination, degrees", last("inclination"), {"fast": lambda n: .5 * (256 / n)},
                 "what the same distance of 1 % of a radius turns it by, at D = .1", angle)),
        line, ("t", f"D, Ca = {capillary}"))


# S7
def stretch_at(t):
    def stretch(run):
        d = numpy.interp(t, run.bodies.time, run.bodies.taylor_deformation[:, 0])
        return float(numpy.sqrt((1 + d) / (1 - d)))
    return stretch


def stretch_line(run):
    d = run.bodies.taylor_deformation[:, 0]
    return (run.bodies.time / 100, numpy.sqrt((1 + d) / (1 - d))), ([0, .5, 1, 2], [1.5, 1.3809, 1.2904, 1.1701])


def relaxation(title, prefix, full, quick):
    return Case(
        "S7", title, "stretched_disc", lambda n, _: {**square(n, 20), "snapshot_interval": 0}, full, quick,
        tuple(Measure(f"{prefix}stretch at G t/mu = {t}", stretch_at(100 * t),
                      {"fast": lambda n, part=(want - 1): .01 * part * (320 / n)},
                      "1 % of the stretch at 16 cells per radius, as S6; reference to 5e-5", want)
              for t, want in ((.5, 1.3809), (1, 1.2904), (2, 1.1701))),
        stretch_line, ("G t/mu", prefix + "stretch"))


# S8
def limit(name):
    """Unbounded and h -> 0: least squares of D_0 + a (R/L)^3 + b (h/R)^2, or without b at one resolution."""
    def value(runs):
        terms = [[1, box**-3.] + [n**-2.] * (len({n for n, _ in runs}) > 1) for n, box in runs]
        found = [last(name)(run) for run in runs.values()]
        if numpy.linalg.matrix_rank(terms) < len(terms[0]):
            raise ValueError("too few boxes and resolutions for an extrapolation")
        return float(numpy.linalg.lstsq(numpy.array(terms), numpy.array(found), rcond=None)[0][0])
    return value


def sphere(capillary, deformation, angle, time, keys, quick=()):
    """Keys (cells per radius, box in radii); until shear strain `time`, when D is within .3 % of its final value."""
    def options(key, _):
        n, box = key
        return {"grid_cells": ",".join([str(n * box)] * 3), "grid_length": ",".join([str(box)] * 3),
                "wall_ymin_velocity": f"{-RATE * box / 2},0,0", "wall_ymax_velocity": f"{RATE * box / 2},0,0",
                "sphere_shear_modulus": RATE / capillary, "time_end": time / RATE, "snapshot_interval": 0}

    def line(run):
        return (run.bodies.time, run.bodies.taylor_deformation[:, 0]), ([0, time / RATE], [deformation] * 2)
    what = f"Ca {capillary}: %s, extrapolated"
    why = "1 % as S6, extrapolated with (R/L)^3 and h^2"
    return Case("S8", f"Sphere in shear flow, Ca = {capillary}", "sphere_in_shear", options,
                every(keys, methods=("fast",), solvers=("acm",)),
                every(quick, methods=("fast",), solvers=("acm",)) if quick else (),
                (Measure(what % "Taylor deformation", limit("taylor_deformation"), {"fast": .01}, why, deformation, True,
                         whole=True),
                 Measure(f"Ca {capillary}: Taylor deformation in this box", last("taylor_deformation"), {},
                         "walls and images raise it", deformation, True),
                 Measure(what % "inclination", limit("inclination"), {"fast": .5}, "as S6", angle, whole=True)),
                line, ("t", f"D, Ca = {capillary}"),
                (Measure(what % "Taylor deformation", limit("taylor_deformation"), {"fast": .05},
                         "1 % at 16 cells per radius (S6), second order to 6: 7 %; less for the extrapolation",
                         deformation, True, whole=True),))


# S9
EXACT_RING = complex(-1.441313, 7.313910)


def ring_rate(run):
    """Complex rate s: least squares of Re(a e^{s t}) by Gauss-Newton, after half a period."""
    t, d = run.bodies.time, run.bodies.taylor_deformation[:, 0] * numpy.where(
        numpy.abs(run.bodies.inclination[:, 0]) < 45, 1, -1)  # the long axis turns by 90 degrees
    here = t > math.pi / EXACT_RING.imag
    t, d = t[here], d[here] / numpy.abs(d[here]).max()
    best = numpy.array([EXACT_RING.real, EXACT_RING.imag])

    def model(s):
        basis = numpy.exp(s[0] * t)[:, None] * numpy.stack([numpy.cos(s[1] * t), numpy.sin(s[1] * t)], 1)
        return basis @ numpy.linalg.lstsq(basis, d, rcond=None)[0] - d
    for _ in range(20):
        residual = model(best)
        jacobian = numpy.stack([(model(best + e) - residual) / 1e-5 for e in 1e-5 * numpy.eye(2)], 1)
        best = best - numpy.linalg.lstsq(jacobian, residual, rcond=None)[0]
    return complex(*best)


def ring_line(run):
    t, d = run.bodies.time, run.bodies.taylor_deformation[:, 0]
    sign = numpy.where(numpy.abs(run.bodies.inclination[:, 0]) < 45, 1, -1)
    return (t, sign * d), None


# S10
PATH = reference("soft_disc_cavity")


def path_distance(begin, end):
    """Largest distance of the centroid from the reference path."""
    def distance(run):
        t = PATH[(PATH[:, 0] >= begin) & (PATH[:, 0] <= end), 0]
        xy = [numpy.interp(t, run.bodies.time, run.bodies.centroid[:, 0, d]) for d in (0, 1)]
        want = [numpy.interp(t, PATH[:, 0], PATH[:, 1 + d]) for d in (0, 1)]
        return float(numpy.hypot(xy[0] - want[0], xy[1] - want[1]).max())
    return distance


def drift(run):
    return float(numpy.abs(run.bodies.volume[:, 0] / run.bodies.volume[0, 0] - 1).max())


def path_line(run):
    here = PATH[:, 0] <= run.summary["time"] + 1e-9
    return (run.bodies.centroid[:, 0, 0], run.bodies.centroid[:, 0, 1]), (PATH[here, 1], PATH[here, 2])


# R1
def thickness(run):
    """Thickness of the cell along its axis, y, on the lines of cells along z through the middle: (r, h)."""
    s = run.snapshots[0]
    h = s["solid_fraction"].astype(float).sum(axis=1) * run.spacing[1]
    k = run.cells[2] // 2
    r = numpy.hypot(run.centres(0) - run.length[0] / 2, run.centres(2)[k] - run.length[2] / 2)
    return numpy.sign(run.centres(0) - run.length[0] / 2) * r, h[k]


def middle_thickness(run):
    r, h = thickness(run)
    return float(h[numpy.abs(r) < 1].min())


def area(run):
    """Surface of the level 1/2 by marching cubes."""
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


CUT = {m: lambda n: .005 * (64 / n)**2 for m in ("fast", "classic")}
CASES = (
    disc_in_shear(.05), disc_in_shear(.1, quick=True), disc_in_shear(.2),
    relaxation("Stretched disc lets go", "", every((80, 160, 320), methods=("fast",), solvers=("acm",), time_step=0.25)
               + every((160,), methods=("fast",), solvers=("smac",), time_step=0.25)
               + every((40, 80), methods=("classic",), solvers=("acm",), fluid_density=1),
               every((80, 160), methods=("fast",), solvers=("acm",), time_step=1)),
    relaxation("Stretched disc, automatic time step", "automatic step: ",
               every((80, 160, 320), methods=("fast",), solvers=("acm",)), ()),
    sphere(.05, .062058, 41.449, 1.6, ((6, 6), (6, 8), (8, 6), (8, 8), (12, 6))),
    sphere(.1, .121639, 38.065, 2.4, ((6, 6), (6, 8), (8, 6), (6, 10), (8, 8), (10, 6), (12, 6), (16, 6)), ((4, 6), (4, 8), (6, 6))),
    sphere(.2, .227328, 32.193, 4, ((6, 6), (6, 8), (8, 6), (8, 8), (12, 6))),
    Case("S9", "Disc that rings", "stretched_disc",
         lambda n, _: {**square(n, 2), "fluid_density": 1, "fluid_viscosity": 0.01, "disc_semi_axes": f"{.2 * 1.02},{.2 / 1.02},1",
                       "disc_initial_stretch": f"1.02,{1 / 1.02},1", "disc_shear_modulus": 1, "time_end": 2,
                       "series_interval": 0.02, "snapshot_interval": 0},
         every((80, 160, 320), (80, 160), solvers=("acm",)) + every((160,), methods=("fast",), solvers=("smac",)),
         every((80, 160), methods=("fast",), solvers=("acm",)),
         (Measure("distance of the complex rate, relative", lambda run: abs(ring_rate(run) / EXACT_RING - 1),
                  {"fast": lambda n: 1 / (0.2 * n)}, "rate ~ 1/R, surface known to half a cell: h/(2 R), .1 % for the box"),
          Measure("rate of decay", lambda run: -ring_rate(run).real, {}, "part of the rate", 1.441313, True),
          Measure("angular frequency", lambda run: ring_rate(run).imag, {}, "part of the rate", 7.313910, True)),
         ring_line, ("t", "Taylor deformation")),
    Case("S10", "Soft disc in the lid-driven cavity", "lid_cavity_disc", lambda n, _: {**square(n), "snapshot_interval": 0},
         every((64, 128, 256), solvers=("acm",)) + every((64, 128), methods=("fast",), solvers=("smac",)),
         every((64, 128), methods=("fast",), solvers=("acm",)),
         (Measure("distance from the path to t = 5", path_distance(0, 5), {"fast": lambda n: .005 * (256 / n)},
                  "agreement of two published methods, .002, and 1 cell at 256^2"),
          Measure("distance from the path to t = 8", path_distance(0, 8), {"fast": lambda n: .01 * (256 / n)},
                  "the same, carried past the lid"),
          Measure("drift of the area", drift, {"fast": .005}, "a percent of what an interface of one cell holds")),
         path_line, ("x", "y"),
         (Measure("distance from the path to t = 2", path_distance(0, 2), {"fast": lambda n: .005 * (128 / n)},
                  "the gate of 256^2 to t = 5, of which this is the smooth part; first order"),
          Measure("drift of the area", drift, {"fast": .001}, "a fifth of the gate of 256^2 to t = 8")), {"time_end": 2}),
    Case("R1", "The shape of a red cell", "channel_rbc",
         lambda n, _: {"grid_cells": f"{n},{n // 2},{n}", "grid_length": "10.56,5.28,10.56", "rbc_count": "1,1,1",
                       "time_steps_max": 1, "snapshot_interval": 1, "snapshot_precision": "double"},
         every((32, 64, 128), solvers=("acm",)), every((32, 64), methods=("fast",), solvers=("acm",)),
         (Measure("volume", lambda run: float(run.bodies.volume[0, 0]), CUT,
                  "exact fractions of cells by sub-cell sampling, .5 % at h = .165", 100.74, True),
          Measure("surface", area, {m: lambda n: .02 * (64 / n) for m in ("fast", "classic")},
                  "marching cubes of cell fractions: first order at the rim", 140.33, True),
          Measure("thickness in the middle", middle_thickness, {m: lambda n: .02 * (64 / n)**2 for m in ("fast", "classic")},
                  "curvature over half a cell, second order", .829, True),
          Measure("largest thickness", lambda run: float(thickness(run)[1].max()),
                  {m: lambda n: .02 * (64 / n)**2 for m in ("fast", "classic")}, "the same", 2.625, True)),
         thickness_line, ("r", "thickness")),
)
