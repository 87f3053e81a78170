"""S12: exact properties. In each pair of runs, one is changed in a way that must have no effect."""
import numpy

from .case import Case, Measure, every


def difference(value, change):
    """Returns the largest distance between value(first) and change(value(second)), relative to the largest value."""
    def distance(runs):
        first, second = [value(run) for run in runs.values()]
        return float(numpy.abs(first - change(second)).max() / numpy.abs(first).max())
    return distance


def velocity(run):
    return run.snapshots[-1].velocity()[:2, 0]


def mirrored_in_y(v):
    return numpy.stack([v[0], -v[1]])[:, ::-1]


def rotated(v):
    """Rotates back by 90 degrees: the value at (x, y) is the rotated value at (1 - y, x)."""
    turned = numpy.rot90(v, 1, axes=(1, 2))
    return numpy.stack([turned[1], -turned[0]])


def mirror_options(n):
    def options(key, _):
        return {"disc_centre": f"10.56,{7.392 if key == 'scene' else 21.12 - 7.392},0", "grid_cells": f"{n},{n},1",
                "time_end": 60, "body_force": "2e-3,0,0", "snapshot_interval": 60, "snapshot_precision": "double"}
    return options


def cavity_options(key, _):
    """Options of a cavity with the lid at the top, or of the same scene turned by 90 degrees, with the lid at the left, moving
    upwards."""
    turned = key == "turned"
    return {"grid_cells": "48,48,1", "time_end": 2, "snapshot_interval": 2, "snapshot_precision": "double",
            "boundary_ymax_velocity": "0,0,0" if turned else "1,0,0", "boundary_xmin_velocity": "0,1,0" if turned else "0,0,0",
            "disc_centre": "0.5,0.6,0" if turned else "0.6,0.5,0"}


def stressless_options(key, _):
    body = {"species": "disc", "disc_shape": "sphere", "disc_radius": 0.2, "disc_centre": "0.6,0.5,0", "disc_shear_modulus": 0}
    return {"grid_cells": "48,48,1", "time_end": 2, "snapshot_interval": 2, "snapshot_precision": "double",
            **(body if key == "body" else {})}


def recovery_options(key, folder):
    """Options of a disc in shear, then of the same state between walls at rest."""
    n, part = key
    common = {"grid_cells": f"{n},{n},1", "grid_length": "8,8,1", "disc_shear_modulus": 0.5, "snapshot_precision": "double",
              "snapshot_fields": "velocity,pressure,solid_fraction,body,left_cauchy_green"}
    if part == "sheared":
        return {**common, "boundary_ymin_velocity": "-0.2,0,0", "boundary_ymax_velocity": "0.2,0,0", "time_end": 30,
                "snapshot_interval": 30}
    state = sorted(folder((n, "sheared")).glob("snapshot_*.h5"))[-1]
    return {**common, "boundary_ymin_velocity": "0,0,0", "boundary_ymax_velocity": "0,0,0", "initial_velocity": "zero",
            "initial_state": state, "time_end": 60, "snapshot_interval": 60}


def speed_left(runs):
    released = runs[max(n for n, _ in runs), "released"]
    return float(numpy.abs(released.snapshots[-1].velocity()).max() / 0.2)


def strain(run):
    """Returns the rms of B - I in the body."""
    s = run.snapshots[-1]
    phi = s["solid_fraction"]
    squares = sum((s[f"left_cauchy_green_{c}"] - i)**2 for c, i in (("xx", 1), ("yy", 1), ("xy", 0)))
    return float(numpy.sqrt((phi * squares).sum() / phi.sum()))


def strain_left(runs):
    n = max(n for n, _ in runs)
    return strain(runs[n, "released"]) / strain(runs[n, "sheared"])


def deformation_left(runs):
    n = max(n for n, _ in runs)
    left, before = [runs[n, part].summary["bodies"][0]["taylor_deformation"] for part in ("released", "sheared")]
    return left / before


def strain_order(runs):
    coarse, fine = sorted({n for n, _ in runs})[-2:]
    at = [strain(runs[n, "released"]) for n in (coarse, fine)]
    return float(numpy.log(at[0] / at[1]) / numpy.log(fine / coarse))


def row_of_u(change):
    """Returns u on a line along y of both runs."""
    def line(runs):
        first, second = runs.values()
        u, other = velocity(first)[0], change(velocity(second))[0]
        return (first.centres(1), u[:, u.shape[1] // 4]), (first.centres(1), other[:, u.shape[1] // 4])
    return line


def recovery_line(runs):
    """Returns D relative to its start in the finest pair, while the walls rest; it should vanish."""
    run = runs[max(n for n, _ in runs), "released"]
    t, d = run.bodies.time, run.bodies.taylor_deformation[:, 0]
    return (t, d / d[0]), ([t[-1] / 2, t[-1]], [0, 0])


ROUND_OFF = "round-off, which the flow may amplify to 1e-9"
TRUNCATION = "twice the error of phi by the directional split, T dt^2 |grad v|^3/12 ~ 5e-5"
ODD = "1e-7, the option -acm_tolerance, since coarse levels with an odd number of cells are not symmetric"
CASES = (
    Case("S12", "The mirrored scene", "disc_in_channel", mirror_options(64), every(("scene", "mirrored")),
         every(("scene", "mirrored"), methods=("fast",), solvers=("acm",)),
         (Measure("mirrored scene, 64 cells: velocity", difference(velocity, mirrored_in_y), {"fast": 1e-9, "classic": 1e-9},
                  ROUND_OFF, whole=True),),
         row_of_u(mirrored_in_y), ("y", "u; reference: mirrored"), whole_curve=True),
    Case("S12", "The mirrored scene, 48 cells", "disc_in_channel", mirror_options(48),
         every(("scene", "mirrored"), methods=("fast",), solvers=("acm",)), (),
         (Measure("mirrored scene, 48 cells: velocity", difference(velocity, mirrored_in_y), {"fast": 1e-7}, ODD, whole=True),),
         row_of_u(mirrored_in_y), ("y", "u, 48 cells; reference: mirrored"), whole_curve=True),
    Case("S12", "The turned scene", "lid_cavity_disc", cavity_options, every(("scene", "turned")),
         every(("scene", "turned"), solvers=("acm",)),
         (Measure("turned scene: velocity", difference(velocity, rotated), {"fast": 1e-4, "classic": 1e-9},
                  "classic: " + ROUND_OFF + "; fast: " + TRUNCATION, whole=True),),
         row_of_u(rotated), ("y", "u; reference: turned"), whole_curve=True),
    Case("S12", "A body without stress", "lid_cavity", stressless_options, every(("body", "fluid")),
         every(("body", "fluid"), solvers=("acm",)),
         (Measure("body without stress and pure fluid: velocity", difference(velocity, lambda v: v),
                  {"fast": 1e-9, "classic": 1e-9}, ROUND_OFF, whole=True),),
         row_of_u(lambda v: v), ("y", "u; reference: no body"), whole_curve=True),
    Case("S12", "Recovery when the walls stop", "disc_in_shear", recovery_options,
         every(tuple((n, part) for n in (64, 128) for part in ("sheared", "released")), solvers=("acm",)),
         every(tuple((n, part) for n in (32, 64) for part in ("sheared", "released")), methods=("fast",),
               solvers=("acm",)),
         (Measure("recovery: largest remaining speed, relative to that of the walls before", speed_left, {"fast": 1e-3, "classic": 1e-3},
                  "goal: .001; the exact value is e^{-G t/(2 mu)} = 3e-7", whole=True,
                  misses={"classic": (4e-3, "B in the smeared surface does not return to I; the error, .006 at 64^2, decreases at less than first order")}),
          Measure("recovery: remaining deformation, relative to the largest", deformation_left, {"fast": .02}, "goal: 2 %, twice that of S6",
                  whole=True),
          Measure("recovery: remaining rms of B - I, relative to the largest", strain_left, {}, "reported: the value decreases with the spacing", whole=True),
          Measure("recovery: amount by which the order of B - I is below 1/2", lambda runs: max(0, .5 - strain_order(runs)), {"fast": 0},
                  "order at least 1/2, that of an error of fixed size in a layer of cells", whole=True)),
         recovery_line, ("t", "D over its start, walls at rest"), whole_curve=True),
)
