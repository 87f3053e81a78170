"""F1 to F7: flows without bodies."""
import math

import numpy

from . import exact
from .case import Case, Measure, at_times, column, every, profile_times, reference, rms, square


# F1
def vortices_error(run):
    snapshot = run.snapshots[-1]
    u = snapshot["velocity_x"][0]
    x, y = numpy.arange(u.shape[1]) / u.shape[1], (numpy.arange(u.shape[0])[:, None] + 0.5) / u.shape[0]
    return rms(u - exact.taylor_green(x, y, snapshot.time, 0.01, 1))


def vortices_line(run):
    """Returns u on y = 0, where it is largest, interpolated by the cubic through the four nearest rows, since no row lies there."""
    snapshot = run.snapshots[-1]
    u = snapshot["velocity_x"][0]
    x, fine = numpy.arange(u.shape[1]) / u.shape[1], numpy.linspace(0, 1, 201)
    return (x, (9 * (u[-1] + u[0]) - u[-2] - u[1]) / 16), (fine, exact.taylor_green(fine, 0, snapshot.time, 0.01, 1))


# F3
def startup_error(run):
    """Returns the error of the mid-channel velocity for nu t/H^2 >= .05, in units of g H^2/nu."""
    here = run.probes.time >= 0.05 - 1e-9
    want = [exact.channel_startup(numpy.array([0.5]), t, 1, 1, 1)[0] for t in run.probes.time[here]]
    return float(numpy.abs(run.probes.velocity_x[here] - want).max())


def startup_line(run):
    want = [exact.channel_startup(numpy.array([0.5]), t, 1, 1, 1)[0] for t in run.probes.time]
    return (run.probes.time, run.probes.velocity_x), (run.probes.time, want)


def duct_error(run):
    """Returns the largest error of any row, relative to the final velocity; on an even number of cells the middle is the common corner
    of four cells and is interpolated."""
    want = exact.duct_startup(run.probes.time, 1, 1, 1)
    return float(numpy.abs(run.probes.velocity_x - want).max() / exact.duct_startup(9, 1, 1, 1)[0])


def duct_line(run):
    t = run.probes.time
    return (t, run.probes.velocity_x), (t, exact.duct_startup(t, 1, 1, 1))


# F4
def oscillation_error(solution):
    """Returns the rms error over y and the last period, relative to the largest velocity."""
    def error(run):
        t, y, u, _ = profile_times(run.profile["y"])
        last = t > t[-1] - 1 + 1e-6
        want = numpy.array([solution(y, time) for time in t[last]])
        return rms(u[last] - want) / numpy.abs(want).max()
    return error


def oscillation_line(solution):
    def line(run):
        t, y, u, _ = profile_times(run.profile["y"])
        return (y, u[-3]), (y, solution(y, t[-3]))
    return line


def womersley(y, t):
    return exact.womersley(y, t, 1, 2 * math.pi, 1, 0.05)


def stokes(y, t):
    return exact.oscillating_wall(y, t, 1, 2 * math.pi, 1, 0.05)


# F6
def parabola(s, f, i):
    """Returns the extremum of the parabola through three neighbouring values."""
    a, b = (f[i + 1] - 2 * f[i] + f[i - 1]) / 2, (f[i + 1] - f[i - 1]) / 2
    return f[i] - b * b / (4 * a)


def cubic(s, nodes, values):
    """Interpolates by the cubic through four equidistant nodes around s."""
    i = numpy.clip(numpy.searchsorted(nodes, s) - 2, 0, len(nodes) - 4)
    t = (s - nodes[i]) / (nodes[1] - nodes[0])
    weights = (-(t - 1) * (t - 2) * (t - 3) / 6, t * (t - 2) * (t - 3) / 2, -t * (t - 1) * (t - 3) / 2,
               t * (t - 1) * (t - 2) / 6)
    return sum(w * values[i + m] for m, w in enumerate(weights))


def cavity_extremum(direction, find):
    def value(run):
        _, s, u, v = profile_times(run.profile[direction])
        f = u[-1] if direction == "y" else v[-1]
        return parabola(s, f, int(find(f)))
    return value


def cavity_error(name):
    """Returns the largest distance of u(1/2, y) and v(x, 1/2) from the reference profiles."""
    def error(run):
        table, worst = reference(name), 0
        for direction, c in (("y", 1), ("x", 2)):
            _, s, u, v = profile_times(run.profile[direction])
            f = u[-1] if direction == "y" else v[-1]
            worst = max(worst, numpy.abs(f - cubic(s, table[:, 0], table[:, c])).max())
        return float(worst)
    return error


def cavity_line(name):
    def line(run):
        _, y, u, _ = profile_times(run.profile["y"])
        return (y, u[-1]), tuple(reference(name)[:, :2].T)
    return line


def cavity(re, u_min, v_max, v_min, end, full, quick):
    ghia = "goal: .0025, half the error of the table of Ghia et al. (1982)"
    least = {"fast": 0.0025, "classic": 0.0025}
    return Case(
        "F6", f"Lid-driven cavity, Re = {re}", "lid_cavity",
        lambda n, _: {**square(n), "fluid_viscosity": 1 / re, "time_end": end, "snapshot_interval": 0},
        full, quick,
        tuple(Measure(f"Re {re}: {what}", cavity_extremum(d, find), least, ghia, value)
              for what, d, find, value in (("u_min", "y", numpy.argmin, u_min), ("v_max", "x", numpy.argmax, v_max),
                                           ("v_min", "x", numpy.argmin, v_min)))
        + (Measure(f"Re {re}: largest error of both profiles", cavity_error(f"cavity_re{re}"),
                   {"fast": 0.005, "classic": 0.005}, "goal: .005, the error of the table of Ghia et al. (1982); interpolating the computed profile adds .0002",
                   order={"fast": 1.7} if re == 100 else {}),),
        cavity_line(f"cavity_re{re}"), ("y", f"u on x = 1/2, Re = {re}"))


# F7
def energy(run):
    return run.series.kinetic_energy


def layer_energy(t):
    return lambda run: float(at_times(run.series, "kinetic_energy", t))


def layer_growth(run):
    """Returns the largest relative increase of the kinetic energy from one row to the next."""
    return float(max(0, numpy.diff(energy(run)).max()) / energy(run)[0])


def vortices_in_layers(run):
    """Counts the maxima of |vorticity| among 9 x 9 cells above 3/10 of the largest: there should be exactly one per layer."""
    u, v = run.snapshots[-1]["velocity_x"][0].astype(float), run.snapshots[-1]["velocity_y"][0].astype(float)
    n = len(u)
    w = numpy.abs((v - numpy.roll(v, 1, 1)) * n - (u - numpy.roll(u, 1, 0)) * n)
    w = sum(numpy.roll(w, (a, b), (0, 1)) for a in (-1, 0, 1) for b in (-1, 0, 1)) / 9
    near = [numpy.roll(w, (a, b), (0, 1)) for a in range(-4, 5) for b in range(-4, 5) if a or b]
    return int(((w > numpy.max(near, axis=0)) & (w > 0.3 * w.max())).sum())


def energy_line(run):
    table = reference("double_shear_layer")
    return (run.series.time, energy(run)), (table[:, 0], table[:, 1])


def vortex_energy(t):
    return lambda run: float(at_times(run.series, "kinetic_energy", t) / (2 * math.pi)**3)


def vortex_line(run):
    t, e = [0, 1, 2, 3, 4, 6, 8, 9, 10], [.125, .124515, .123917, .123024, .121508, .113581, .098290, .086404, .074479]
    here = numpy.array(t) <= run.summary["time"] + 1e-9
    return (run.series.time, energy(run) / (2 * math.pi)**3), (numpy.array(t)[here], numpy.array(e)[here])


ADVECTED = {"fast": lambda n: 3.4e-3 * (64 / n)**2, "classic": 3.4e-3}
HALF_PERCENT = {m: lambda n: 0.005 * (64 / n)**2 for m in ("fast", "classic")}
PHASE = "second order: twice |k h|^2/12, which is .26 % at 64 cells, with k^2 = i omega/nu"
CASES = (
    Case("F1", "Advected Taylor-Green vortices", "taylor_green_advected",
         lambda n, _: {**square(n), "snapshot_interval": 0.5, "snapshot_precision": "double"},
         every((32, 64, 128), classic=(32, 64)), every((32, 64)),
         (Measure("L2 error of u at t = .5", vortices_error, ADVECTED,
                  "the error of second-order Adams-Bashforth steps with an exact projection at 64^2, scaled with h^2", order={"fast": 1.9}),),
         vortices_line, ("x", "u on y = 0, t = .5")),
    Case("F2", "Taylor-Green vortex in 3-D, Re = 1600", "taylor_green_3d",
         lambda n, _: {"grid_cells": f"{n},{n},{n}", "time_end": 4, "snapshot_interval": 0},
         every((32, 64), classic=(32,), solvers=("acm",)) + every((32,), methods=("fast",), solvers=("smac",)),
         every((32,), methods=("fast",), solvers=("acm",)),
         (Measure("mean energy at t = 4", vortex_energy(4), {"fast": lambda n: .015 * (64 / n)**2,
                                                              "classic": lambda n: .015 * (64 / n)**2},
                  "WENO5 dissipates: another implementation loses 1.3 % of the energy at 64^3; scaled with h^2", 0.121508, True),
          Measure("mean energy at t = 2", vortex_energy(2), {"fast": lambda n: .015 * (64 / n)**2,
                                                              "classic": lambda n: .015 * (64 / n)**2},
                  "as at t = 4", 0.123917, True)),
         vortex_line, ("t", "mean kinetic energy"),
         (Measure("mean energy at t = 2", vortex_energy(2), {"fast": .015},
                  "as the full run at t = 4", 0.123917, True),), {"time_end": 2}),
    Case("F3", "Start-up of channel flow", "poiseuille_startup",
         lambda n, _: {**column(n), "probe_points": f"{2 / n},0.5,0"},
         every((32, 64), methods=("fast",)) + every((32, 64), methods=("classic",), time_step=0),
         every((32, 64), methods=("fast",), solvers=("acm",)),
         (Measure("largest error in the middle for t >= .05, relative to g H^2/nu", startup_error,
                  {"fast": lambda n: 0.165 / n**2 + 5e-6, "classic": lambda n: 0.212 / n**2},
                  "sum of the errors at walls, h^2/8, of decay rates, .04 h^2, and in time: (pi^2 dt)^2/125 with dt = .0025 for RKL2, .23 dt with dt = h^2/5 for Euler"),),
         startup_line, ("t", "u in the middle")),
    Case("F3", "Start-up with the automatic time step", "poiseuille_startup",
         lambda n, _: {**column(n), "probe_points": f"{2 / n},0.5,0", "time_step": 0},
         every((32, 64), methods=("fast",), solvers=("acm",)), every((32, 64), methods=("fast",), solvers=("acm",)),
         (Measure("automatic time step: the same error", startup_error, {"fast": .00125}, "goal: 1 % of the final velocity"),),
         startup_line, ("t", "u in the middle, automatic step")),
    Case("F3", "Start-up of a square duct, automatic time step", "poiseuille_startup",
         lambda n, _: {"grid_cells": f"4,{n},{n}", "grid_length": f"{4 / n},1,1", "boundary_z": "wall", "time_step": 0,
                       "probe_points": f"{2 / n},0.5,0.5"},
         every((16, 32), methods=("fast",), solvers=("acm",)), every((16,), methods=("fast",), solvers=("acm",)),
         (Measure("square duct, automatic time step: largest error in the middle, relative to the final velocity", duct_error,
                  {"fast": lambda n: 0.005 + 1 / n**2}, "goal: .5 %, plus the error of the grid, h^2"),),
         duct_line, ("t", "u in the middle of a duct")),
    Case("F4", "Oscillating channel flow (Womersley)", "womersley", lambda n, _: {**column(n), "time_step": 0.8 / n},
         every((32, 64), methods=("fast",)) + every((32, 64), methods=("classic",), time_step=0),
         every((32, 64), methods=("fast",), solvers=("acm",)),
         (Measure("rms error of u(y, t) over a period, relative to the largest u", oscillation_error(womersley), HALF_PERCENT,
                  PHASE, order={"fast": 1.9, "classic": 1.9}),),
         oscillation_line(womersley), ("y", "u at 5/8 of a period")),
    Case("F4", "Oscillating wall (Stokes' second problem)", "womersley",
         lambda n, _: {**column(n), "time_step": 0, "body_force": "0,0,0", "body_force_angular_frequency": 0,
                       "boundary_ymax_velocity": "1,0,0", "boundary_ymax_angular_frequency": 2 * math.pi, "boundary_ymax_phase": -math.pi / 2},
         every((32, 64)), every((32, 64), methods=("fast",), solvers=("acm",)),
         (Measure("oscillating wall: the same error", oscillation_error(stokes), HALF_PERCENT, PHASE,
                  order={"fast": 1.9, "classic": 1.9}),),
         oscillation_line(stokes), ("y", "oscillating wall: u at 5/8 of a period")),
    cavity(100, -.214043, .179574, -.253805, 20, every((32, 64, 128), (32, 64)),
           every((32, 64), methods=("fast",), solvers=("acm",))),
    cavity(400, -.328757, .303852, -.454089, 60, every((64, 128), methods=("fast",), solvers=("acm",)), ()),
    cavity(1000, -.388637, .376973, -.527120, 120, every((64, 128, 256), methods=("fast",), solvers=("acm",)), ()),
    Case("F7", "Double shear layer", "double_shear_layer", lambda n, _: square(n),
         every((64, 128)), every((128,), methods=("fast",), solvers=("acm",)),
         tuple(Measure(f"kinetic energy at t = {t}", layer_energy(t),
                       {m: lambda n, lost=(.4339584 / value - 1): 1.6 * (30 / n)**2 / 12 * lost for m in ("fast", "classic")},
                       "twice the relative error of the dissipation of a layer, .8 (30 h)^2/12, times the dissipated share of the energy", value, True)
               for t, value in ((.4, .4077905), (.8, .3878271), (1.2, .3710957)))
         + (Measure("largest rise of the energy", layer_growth, {"fast": 0, "classic": 0}, "exact: the energy never rises"),
            Measure("vortices at t = 1.2", vortices_in_layers, {m: lambda n: 0 if n >= 128 else None for m in ("fast", "classic")},
                    "exact: one vortex per layer, from 128^2 on", 2)),
         energy_line, ("t", "mean kinetic energy")),
)
