"""S13 to S22: rigid bodies, alone and between an inlet and an outlet; docs/method.md, sections 19 and 20."""
import functools
import math

import numpy

from .bodies import fast_at
from .case import ROOT, Case, Measure

# Drag K of a simple cubic array of spheres over Stokes' 6 pi mu a U at solid volume fraction c, U the mean velocity of the box
# (Zick & Homsy, J. Fluid Mech. 115, 1982, table 2).
ARRAY = {.027: 2.008, .064: 2.810, .125: 4.292, .216: 7.442}
ACROSS = .77  # diameter of the tube in a box of 1
TORQUE = 4 * math.pi / (.15**-2 - .4**-2)


def bulk(run):
    return float(run.series.bulk_velocity_x[-1])


def array(fraction, settings, quick):
    radius = (3 * fraction / (4 * math.pi))**(1 / 3)

    def options(n, _):  # n: cells per radius; anywhere in the grid
        cells = round(n / radius)
        return {"grid_cells": f"{cells},{cells},{cells}", "grain_radius": radius, "time_end": .6 if fraction > .1 else 1.5, "snapshot_interval": 0}
    return Case("S13", f"Cubic array of rigid spheres, volume fraction {fraction}", "sphere_array", options, settings, quick,
                (Measure(f"fraction {fraction}: drag K", lambda run: 1 / (6 * math.pi * radius * bulk(run)),
                         {"fast": lambda n: .01 * max(1, (16 / n)**2)}, "goal: 1 % at 16 cells per radius; second order",
                         ARRAY[fraction], True),
                 Measure(f"fraction {fraction}: force on the sphere relative to the driving force", lambda run: float(
                     run.bodies.force[-1, 0, 0]) / (1 - fraction), {"fast": lambda n: .01 * max(1, (16 / n)**2)},
                         "the balance of momentum of the box", 1, True)),
                lambda run: ((run.series.time, run.series.bulk_velocity_x), steady(run.series, 1 / (6 * math.pi * radius * ARRAY[fraction]))),
                ("t", f"mean velocity, volume fraction {fraction}"))


def steady(table, value):
    """Returns a reference that is known for the end only."""
    return table.time[[0, -1]], [value, value]


def tube_options(across, _):
    cells = round(across / ACROSS)
    return {"grid_cells": f"8,{cells},{cells}", "grid_length": f"{8 / cells},1,1", "grain_shape": "tube", "grain_axis": "x", "grain_radius": ACROSS / 2,
            "grain_centre": "0,0.513,0.487", "fluid_inertia": "true", "time_end": .5, "time_step": .005, "snapshot_interval": 0}


@functools.lru_cache(maxsize=None)
def zeros():
    """Returns the first zeros of J_0, by Newton from (m - 1/4) pi."""
    found = []
    for m in range(1, 7):
        z = (m - .25) * math.pi
        for _ in range(8):
            z += bessel(0, z) / bessel(1, z)
        found.append(z)
    return tuple(found)


def tube_startup(t):
    """Returns the mean velocity of the box when a force of 1 starts the fluid of viscosity and density 1 in the tube (Szymanski, J.
    Math. Pures Appl. 11, 1932)."""
    return math.pi * (ACROSS / 2)**4 / 8 * (1 - sum(32 / z**4 * numpy.exp(-z**2 * t / (ACROSS / 2)**2) for z in zeros()))


def startup_line(end):
    t = numpy.linspace(0, end, 201)
    return t, tube_startup(t)


def gradient(run):
    p = run.probes.pressure.reshape(-1, 2)[-1]
    return float((p[1] - p[0]) / .3)


EXACT_GRADIENT = -12.8 / (math.pi * ACROSS**4)


def gradient_line(runs):
    """Returns the error of the gradient over the cells across, and the line of second order through the finest one."""
    across = numpy.array(list(runs))
    errors = numpy.array([100 * abs(gradient(run) / EXACT_GRADIENT - 1) for run in runs.values()])
    return (across, errors), (across[[0, -1]], errors[-1] * (across[-1] / across[[0, -1]])**2)


WOMERSLEY, VISCOSITY = 5, .1  # number R sqrt(frequency/nu)
FREQUENCY = VISCOSITY * (WOMERSLEY / (ACROSS / 2))**2
PERIODS = 6


def bessel(order, z):
    """Returns J_0 or J_1 by its power series."""
    return sum((-1)**m * (z / 2)**(2 * m + order) / (math.factorial(m) * math.factorial(m + order)) for m in range(60))


def womersley_flow():
    """Returns the complex mean velocity of the box under a force cos(frequency t): Womersley (1955)."""
    z = WOMERSLEY * 1j**1.5
    return (1 - 2 * bessel(1, z) / (z * bessel(0, z))) / (1j * FREQUENCY) * math.pi * (ACROSS / 2)**2


def pulse(run):
    """Returns the same quantity of a run, by least squares over the last period."""
    t, u = run.series.time, run.series.bulk_velocity_x
    last = t > t[-1] * (1 - 1 / PERIODS)
    waves = numpy.stack([numpy.cos(FREQUENCY * t[last]), -numpy.sin(FREQUENCY * t[last])], axis=1)
    real, imaginary = numpy.linalg.lstsq(waves, u[last], rcond=None)[0]
    return complex(real, imaginary)


def pulse_options(across, _):
    period = 2 * math.pi / FREQUENCY
    return {**tube_options(across, _), "fluid_viscosity": VISCOSITY, "body_force_angular_frequency": FREQUENCY, "time_end": PERIODS * period,
            "time_step": period / (2 * across), "series_interval": period / (2 * across)}


def late(run):
    """Returns times, drag and lift coefficients of a periodic wake, which are 20 times the force per depth, in the last 2.5 units of
    time."""
    last = run.bodies.time > run.bodies.time[-1] - 2.5
    return run.bodies.time[last], *20 * run.bodies.force[last, 0, :2].T


def strouhal(run):
    """Returns the Strouhal number, with diameter .1 and mean velocity 1: the frequency of the lift between its first and last rise
    through its mean."""
    t, _, lift = late(run)
    lift = lift - lift.mean()
    at = numpy.flatnonzero((lift[:-1] < 0) & (lift[1:] >= 0))
    rises = t[at] - lift[at] * (t[at + 1] - t[at]) / (lift[at + 1] - lift[at])
    return float(.1 * (len(rises) - 1) / (rises[-1] - rises[0]))


def swinging(run):
    """Returns the coefficients of drag and of added mass, with diameter, density and largest speed 1: those of the force of Morison et
    al. (1950) that fits the last period best."""
    frequency, last = 2 * math.pi / 5, run.bodies.time > run.bodies.time[-1] - 5
    t, force = run.bodies.time[last], run.bodies.force[last, 0, 0]
    speed, rate = -numpy.cos(frequency * t), frequency * numpy.sin(frequency * t)
    terms = numpy.stack([-abs(speed) * speed / 2, -math.pi / 4 * rate], axis=1)
    return numpy.linalg.lstsq(terms, force, rcond=None)[0]


def swinging_line(run):
    """Returns the force in the last period, and that of the published coefficients."""
    frequency, last = 2 * math.pi / 5, run.bodies.time > run.bodies.time[-1] - 5
    t = run.bodies.time[last]
    speed, rate = -numpy.cos(frequency * t), frequency * numpy.sin(frequency * t)
    return (t, run.bodies.force[last, 0, 0]), (t, -DRAG * abs(speed) * speed / 2 - ADDED_MASS * math.pi / 4 * rate)


DRAG, ADDED_MASS = 2.09, 1.45


def torque_line(run):
    late = run.bodies.time >= .1 - 1e-9  # the start is a jump
    return (run.bodies.time[late], -run.bodies.torque[late, 0, 2]), ([.1, run.bodies.time[-1]], [TORQUE, TORQUE])


def upper_share():
    """Returns the share of the flow that leaves the bifurcation upwards, by a network of Poiseuille's resistances along its axes
    (scripts/make_vessel)."""
    per_length = 8 * 1.2 / (math.pi * 5.5**4)
    ahead, up = 40, math.dist((32, 16), (43, 25)) + math.dist((43, 25), (47, 33)) + math.dist((47, 33), (48, 42)) + 6
    return per_length * ahead / (per_length * (ahead + up) + .05)


# Backward-facing step at Re = 800: where the flow comes back to the lower wall, leaves the upper one and comes back to that, in
# step heights (Gartling 1990, table II: 6.10, 4.85, 10.48 channel heights).
STEP = {"reattachment below": 12.20, "separation above": 9.70, "reattachment above": 20.96}


def step_options(n, _):
    """Options with the parabola 24 (y - 1/2)(1 - y) of the upper half as inlet profile, averaged over every cell."""
    path = ROOT / "build" / f"backward_step_inlet_{n}.txt"
    path.parent.mkdir(exist_ok=True)
    y = numpy.clip(numpy.arange(n + 1) / n, .5, 1)
    path.write_text("\n".join(f"{u:.15g}" for u in n * numpy.diff(24 * (.75 * y**2 - y**3 / 3 - y / 2))) + "\n")
    return {"grid_cells": f"{30 * n},{n},1", "grid_length": f"30,1,{1 / n}", "boundary_xmin_profile": path, "snapshot_interval": 400}


def turns(run, row, beside):
    """Returns the positions where the shear on a wall changes sign, in step heights; on the lower wall the first one belongs to the
    corner eddy."""
    u = run.snapshots[-1].velocity()[0][0]
    shear = 9 * u[row] - u[beside]
    x = (numpy.arange(len(shear)) + .5) * run.spacing[0]
    at = numpy.flatnonzero(shear[1:] * shear[:-1] < 0)
    return 2 * (x[at] - shear[at] * (x[at + 1] - x[at]) / (shear[at + 1] - shear[at]))


def fork_options(n, _):
    """Options of a steady inflow, as a table, since the case has a period."""
    path = ROOT / "build/bifurcation_steady.csv"
    path.parent.mkdir(exist_ok=True)
    path.write_text("time,value\n0,5\n360,5\n")
    return {"grid_cells": f"{72 * n // 14},{48 * n // 14},{20 * n // 14}", "cell_count": 0, "boundary_xmin_generator_length": 0,
            "boundary_xmin_flow_rate": path, "time_end": 60, "snapshot_interval": 0}


def step_line(row, beside, published):
    """Returns the shear rate on a wall, with mean velocity and channel height 1, and the published positions where it is 0."""
    def line(run):
        u = run.snapshots[-1].velocity()[0][0]
        shear = (9 * u[row] - u[beside]) / (3 * run.spacing[1])
        x = 2 * (numpy.arange(len(shear)) + .5) * run.spacing[0]
        return (x, shear), ([STEP[what] for what in published], [0.] * len(published), [0.] * len(published))
    return line


def step_measure(what, row, beside, number):
    return Measure(what, lambda run: float(turns(run, row, beside)[number]), {"fast": lambda n: .02 * max(1, (80 / n)**2)},
                   "goal: 2 % at 80 cells; second order", STEP[what], True)


CASES = (
    Case("S21", "Backward-facing step, Re = 800", "backward_step", step_options, fast_at((40, 80)), fast_at((16,)),
         (step_measure("reattachment below", 0, 1, -1), step_measure("separation above", -1, -2, 0),
          step_measure("reattachment above", -1, -2, -1)),
         step_line(0, 1, ("reattachment below",)), ("x, step heights", "shear rate on the lower wall"), scales={"ylim": (-10, 10)}),
    Case("S21", "Backward-facing step, Re = 800, upper wall", "backward_step", step_options, fast_at((40, 80)), fast_at((16,)), (),
         step_line(-1, -2, ("separation above", "reattachment above")), ("x, step heights", "shear rate on the upper wall"),
         scales={"ylim": (-10, 10)}),
    array(.027, fast_at((8,)), ()), array(.216, fast_at((8, 16)), fast_at((8,))),
    Case("S14", "Poiseuille flow in a rigid tube", "sphere_array", tube_options, fast_at((10, 20, 40)), fast_at((10, 20)),
         (Measure("flow rate", bulk, {"fast": lambda across: .01 * (20 / across)**1.8},
                  "goal: 1 % at 20 cells across, order 1.8", math.pi * (ACROSS / 2)**4 / 8, True, order={"fast": 1.8}),),
         lambda run: ((run.series.time, run.series.bulk_velocity_x), startup_line(run.series.time[-1])), ("t", "mean velocity")),
    Case("S15", "Rotating cylinder inside a fixed one", "rotating_cylinder",
         lambda n, _: {"grid_cells": f"{n},{n},1", "snapshot_interval": 0}, fast_at((32, 64, 128)), fast_at((32, 64)),
         (Measure("torque on the inner cylinder", lambda run: float(run.bodies.torque[-1, 0, 2]), {"fast": .01},
                  "goal: 1 %", -TORQUE, True),
          Measure("torque on the outer cylinder", lambda run: float(run.bodies.torque[-1, 1, 2]), {"fast": .01},
                  "goal: 1 %", TORQUE, True)),
         torque_line, ("t", "torque that turns the inner cylinder, from t = .1 on")),
    Case("S16", "Cylinder in a channel, Re = 20", "cylinder_in_channel",
         lambda n, _: {"grid_cells": f"{22 * n},{41 * n // 10},1", "time_end": 8, "snapshot_interval": 0}, fast_at((10, 20, 40)),
         fast_at((10,)),
         (Measure("drag coefficient", lambda run: float(run.bodies.force[-1, 0, 0]) * 500,
                  {"fast": lambda n: .01 * max(1, 40 / n)}, "goal: 1 % at 40 cells in the diameter", 5.5795, True),
          Measure("lift coefficient", lambda run: float(run.bodies.force[-1, 0, 1]) * 500, {}, "reported only: the lift is a fifth of a per cent of the drag",
                  .01062, True)),
         lambda run: ((run.bodies.time[1:], 500 * run.bodies.force[1:, 0, 0]), steady(run.bodies, 5.5795)), ("t", "drag coefficient")),
    Case("S17", "Rigid tube from an inlet to an outlet", "sphere_array",
         lambda across, _: {**tube_options(across, _), "grid_cells": f"{24 * across // 20},{round(across / ACROSS)},{round(across / ACROSS)}",
                            "grid_length": f"{24 * across // 20 / round(across / ACROSS)},1,1", "body_force": "0,0,0",
                            "boundary_xmin": "inflow", "boundary_xmax": "pressure", "boundary_xmin_profile": "developed",
                            "boundary_xmin_flow_rate": .1, "probe_points": "0.3,0.513,0.487:0.6,0.513,0.487"},
         fast_at((10, 20, 40)), fast_at((10, 20)),
         (Measure("pressure gradient", gradient, {"fast": lambda across: .01 * (20 / across)**1.8},
                  "goal: 1 % at 20 cells across, order 1.8", EXACT_GRADIENT, True, order={"fast": 1.8}),),
         gradient_line, ("cells across", "error of the pressure gradient, %; reference: second order"), whole_curve=True,
         scales={"xscale": "log", "yscale": "log"}),
    Case("S18", "Pulse in a rigid tube, Womersley number 5", "sphere_array", pulse_options, fast_at((10, 20, 40)), fast_at((10, 20)),
         (Measure("relative error of the complex amplitude of the flow rate", lambda run: abs(pulse(run) / womersley_flow() - 1),
                  {"fast": lambda across: .01 * (20 / across)**1.7}, "goal: 1 % with 20 cells across and 40 steps per period; second order in both",
                  order={"fast": 1.7}),),
         lambda run: ((run.series.time, run.series.bulk_velocity_x),
                      (run.series.time, (womersley_flow() * numpy.exp(1j * FREQUENCY * run.series.time)).real)), ("t", "mean velocity")),
    Case("S19", "Bifurcation from a surface, one inlet and two outlets", "bifurcation",
         fork_options,
         fast_at((14, 21, 28)), fast_at((14,)),
         (Measure("share of the upper outlet", lambda run: -float(run.series.flow_rate_ymax[-1]) / 5, {"fast": .05},
                  "goal: 5 %; the network of resistances neglects the rounding of the fork", upper_share(), True),),
         lambda run: ((run.series.time[1:], -run.series.flow_rate_ymax[1:]), steady(run.series, 5 * upper_share())),
         ("t (µs)", "flow rate at the upper outlet (µm³/µs)"), scales={"ylim": (0, 2.5)}),
    Case("S20", "Cylinder in a channel, Re = 100", "cylinder_in_channel",
         lambda n, _: {"grid_cells": f"{22 * n},{41 * n // 10},1", "boundary_xmin_velocity": 1, "time_end": 8, "snapshot_interval": 0,
                       "series_interval": .005}, fast_at((20, 40)), (),
         (Measure("largest drag coefficient", lambda run: float(late(run)[1].max()), {"fast": lambda n: .01 * (40 / n)**2},
                  "goal: 1 % at 40 cells in the diameter", 3.23, True),
          Measure("largest lift coefficient", lambda run: float(late(run)[2].max()), {}, "reported only: the reference is known to 1 %", 1, True),
          Measure("Strouhal number", strouhal, {"fast": lambda n: .01 * (40 / n)**2}, "goal: 1 % at 40 cells in the diameter", .3, True)),
         lambda run: ((run.bodies.time[1:], 20 * run.bodies.force[1:, 0, 1]), steady(run.bodies, 1)),
         ("t", "lift coefficient; published: its largest")),
    # Duetsch, Durst, Becker & Lienhart, J. Fluid Mech. 360, 1998, table 2
    Case("S22", "Oscillating cylinder in fluid at rest, Re = 100, Keulegan-Carpenter number 5", "oscillating_cylinder",
         lambda n, _: {"grid_cells": f"{24 * n},{16 * n},1", "grid_length": "24,16,1", "time_end": 15, "snapshot_interval": 0},
         fast_at((10, 20, 40)), (),
         (Measure("drag coefficient", lambda run: float(swinging(run)[0]), {"fast": lambda n: .04 * max(1, 20 / n)},
                  "goal: 4 % from 20 cells in the diameter on", DRAG, True),
          Measure("coefficient of added mass", lambda run: float(swinging(run)[1]), {"fast": lambda n: .04 * max(1, 20 / n)},
                  "goal: 4 % from 20 cells in the diameter on", ADDED_MASS, True)),
         swinging_line, ("t", "force in the last period; published fit")),
)
