"""S1, S3 to S5: solids whose motion is known exactly at any amplitude."""
import math

import numpy

from . import exact
from .case import Case, Measure, column, every, profile_times, rms, square

LAYERS = exact.Layers()
WHOLE = {"snapshot_precision": "double", "snapshot_fields": "velocity,left_cauchy_green"}


# S1
def quarters(run, value):
    """Returns the amplitude of value(snapshot) over the last period, from four snapshots a quarter period apart."""
    t = numpy.array([s.time for s in run.snapshots])
    last = [run.snapshots[int(numpy.abs(t - (t[-1] - q / 2)).argmin())] for q in range(4)]
    waves = numpy.array([numpy.exp(-1j * LAYERS.omega * s.time) for s in last])
    matrix = numpy.array([[w.real, -w.imag] for w in waves])  # a cos - b sin: least squares, times need not be exact
    return float(numpy.hypot(*numpy.linalg.lstsq(matrix, numpy.array([value(s) for s in last]), rcond=None)[0]))


def interface_speed(run):
    def at_half(snapshot):
        """Returns the mean of the extrapolations from both sides, since du/dy is discontinuous there."""
        u = snapshot["velocity_x"][0, :, 0]
        m = len(u) // 2
        return (3 * u[m - 1] - u[m - 2] + 3 * u[m] - u[m + 1]) / 4
    return quarters(run, at_half)


def shear_at(fraction):
    """Returns the amplitude of B_xy on the edge at this fraction of the height."""
    return lambda run: quarters(run, lambda s: s["left_cauchy_green_xy"][0, :, 0][int(fraction * s["velocity_x"].shape[1])])


def layers_error(run):
    """Returns the rms error of u(y) over a period, relative to the speed of the wall."""
    t, y, u, _ = profile_times(run.profile["y"])
    last = t > t[-1] - 2 + 1e-6
    want = numpy.array([(LAYERS.amplitude(y) * numpy.exp(1j * LAYERS.omega * time)).imag for time in t[last]])
    return rms(u[last] - want)


def layers_line(run):
    t, y, u, _ = profile_times(run.profile["y"])
    return (y, u[-1]), (y, (LAYERS.amplitude(y) * numpy.exp(1j * LAYERS.omega * t[-1])).imag)


# S3
def resting_error(run):
    _, y, u, _ = profile_times(run.profile["y"])
    return float(numpy.abs(u[-1] - exact.resting_layers(y, 0.5, 0.1)).max() / 0.15625)


def resting_shear(fraction):
    return lambda run: float(run.snapshots[-1]["left_cauchy_green_xy"][0, int(fraction * run.cells[1]), 0])


def resting_line(run):
    _, y, u, _ = profile_times(run.profile["y"])
    return (y, u[-1]), (y, exact.resting_layers(y, 0.5, 0.1))


# V1
def viscous_layers(y, y0, ratio=5):
    stress = 1 / (y0 / ratio + 1 - y0)
    return numpy.where(y < y0, stress * y / ratio, 1 - stress * (1 - y))


def surface(run):
    return float(run.options["layer_interval"].split(",")[1])


def viscous_error(run):
    _, y, u, _ = profile_times(run.profile["y"])
    return float(numpy.abs(u[-1] - viscous_layers(y, surface(run))).max())


def viscous_rate(name):
    """Returns the rate relative to the exact one."""
    def rate(run):
        y0 = surface(run)
        length = float(run.options["grid_length"].split(",")[0])
        return float(getattr(run.series, name)[-1]) / length * (y0 / 5 + 1 - y0)
    return rate


def viscous_wall(run):
    stress = run.snapshots[-1]["wall_shear_stress_ymin"][..., 0]
    return float(stress.mean()) * (surface(run) / 5 + 1 - surface(run))


def viscous_line(run):
    _, y, u, _ = profile_times(run.profile["y"])
    fine = numpy.linspace(0, 1, 201)
    return (y, u[-1]), (fine, viscous_layers(fine, surface(run)))


# S4
def wave_setup(a, b, mean):
    """Options of the wave u_a(b), in a 2-D box along x or y, in a thin 3-D one along z; `mean` is a velocity along b."""
    def options(n, _):
        cells = [4, 4, 4 if "z" in (a, b) else 1]
        cells["xyz".index(b)] = n
        return {"grid_cells": ",".join(map(str, cells)),
                "grid_length": ",".join(str(c / n) if c > 1 else "1" for c in cells),
                "initial_velocity": f"shear_wave_{a}{b}", "gel_axis": b, "profile_y": "mean", f"profile_{b}": "mean",
                "initial_velocity_mean": ",".join(str(mean if d == b else 0) for d in "xyz"),
                "snapshot_interval": 1, **WHOLE}
    return options


def wave_component(run, a, b):
    u = run.snapshots[-1][f"velocity_{a}"]
    return u.mean(axis=tuple(i for i in range(3) if i != 2 - "xyz".index(b)))


def wave_error(a, b, mean):
    def error(run):
        u, t = wave_component(run, a, b), run.snapshots[-1].time
        s = (numpy.arange(len(u)) + 0.5) / len(u)
        return rms(u - exact.shear_wave(t, 1.5) * numpy.sin(2 * math.pi * (s - mean * t))) / 1.5
    return error


def wave_amplitude(a, b):
    def amplitude(run):
        u = wave_component(run, a, b)
        return float(2 * abs(numpy.fft.fft(u)[1]) / len(u))
    return amplitude


def wave_line(a, b):
    def line(run):
        t, s, u, v = profile_times(run.profile[b])
        f = u if a == "x" else v
        found = [2 * f_t @ numpy.sin(2 * math.pi * s) / len(s) for f_t in f]
        fine = numpy.linspace(0, t[-1], 101)
        return (t, found), (fine, exact.shear_wave(fine, 1.5))
    return line


def wave(a, b, mean=0.0, quick=False):
    what = f"u_{a} along {b}" + (f", carried at {mean}" if mean else "")
    least = {"fast": lambda n: .005 * (64 / n)**2, "classic": lambda n: .01 * (64 / n)**2}
    second = "second order: twice the error of the frequency, (k h)^2/24, which amounts to .25 % at t = 1 with 64 cells; explicit Euler with dt ~ h^2: as much again"
    def own_line(run):
        u = wave_component(run, a, b)
        s = (numpy.arange(len(u)) + 0.5) / len(u)
        return (s, u), (s, exact.shear_wave(1, 1.5) * numpy.sin(2 * math.pi * (s - mean)))
    return Case("S4", f"Plane shear wave, {what}", "shear_wave", wave_setup(a, b, mean),
                every((32, 64), solvers=("acm",)), every((32, 64), methods=("fast",), solvers=("acm",)) if quick else (),
                (Measure(f"{what}: rms error at t = 1, relative to u(0)", wave_error(a, b, mean), least, second, order={"fast": 1.9}),
                 Measure(f"{what}: amplitude at t = 1", wave_amplitude(a, b), least, second, 1.23141718, True)),
                wave_line(a, b) if (a, b, mean) == ("x", "y", 0) else own_line,
                ("t" if (a, b, mean) == ("x", "y", 0) else b, f"u_{a}"))


# S5
PASSIVE = 1e-15  # nothing feels it; without modulus there is no B


def stagnation(run):
    return float(run.snapshots[-1]["left_cauchy_green_xx"][0, run.cells[1] // 2, run.cells[0] // 2])


def stagnation_exact(t, nu=0.01, k=2 * math.pi):
    """Returns B_xx = exp(2 k int_0^t e^{-2 nu k^2 s} ds) at the point where u = sin kx cos ky e^{-2 nu k^2 t} stretches most."""
    return math.exp(2 * k * (1 - math.exp(-2 * nu * k * k * t)) / (2 * nu * k * k))


def stagnation_line(run):
    b = run.snapshots[-1]["left_cauchy_green_xx"][0, run.cells[1] // 2]
    return (run.centres(0), b), ([0.5], [stagnation_exact(run.snapshots[-1].time)])


def centre_rotation(run):
    """Returns |B - I| in the centre (1/4, 1/4) of the vortex, where the flow only rotates: the largest component of the mean of four
    cells."""
    s, n = run.snapshots[-1], run.cells[0]
    i = n // 4
    worst = 0
    for name, unit in (("xx", 1), ("yy", 1), ("xy", 0)):
        b = s[f"left_cauchy_green_{name}"][0]
        near = b[i, i] if name == "xy" else b[i - 1:i + 1, i - 1:i + 1].mean()
        worst = max(worst, abs(float(near) - unit))
    return worst


def marked_disc(run):
    return run.summary["bodies"][0]["taylor_deformation"]


def marked_strain(run):
    """Returns the largest difference of B_xy and B_xx in the middle of the marked disc from [[1 + g^2, g], [g, 1]]."""
    s = run.snapshots[-1]
    g, j, i = 0.05 * s.time, run.cells[1] // 2, run.cells[0] // 2
    found = (s["left_cauchy_green_xx"][0, j, i] - 1 - g * g, s["left_cauchy_green_xy"][0, j, i] - g,
             s["left_cauchy_green_yy"][0, j, i] - 1)
    return float(numpy.abs(found).max())


def marked_line(run):
    t = run.bodies.time
    return (t, run.bodies.taylor_deformation[:, 0]), (t, [exact.sheared_circle(0.05 * x) for x in t])


SECOND_LAYER = {"fast": lambda n: 2 * (2 / n)**2, "classic": lambda n: 2 / n}
WHY_LAYER = ("fast: second order, 2 (h/L_s)^2, L_s the thickness of the solid layer; classic: first order in the width of the "
             "interface, h/L_s")
# classic, steady: B_xy on the edge of the surface rests only where du/dy = 0, so the first cell of fluid rests, at h/2
# above the surface. What the parabola should have there, 4 (h/2) (L_f - h/2)/L_f^2 of its maximum, is the error.
FIRST_CELL = {"fast": SECOND_LAYER["fast"], "classic": lambda n: 1.01 * (4 / n) * (1 - 1 / n)}
WHY_FIRST_CELL = ("fast: second order, 2 (h/L_s)^2, L_s the thickness of the solid layer; classic: 1.01 times the error that a first cell of "
                  "fluid at rest causes, 2 h/L_f (1 - h/(2 L_f)), L_f the thickness of the fluid layer")
CASES = (
    Case("S1", "Fluid over a solid layer, oscillating wall", "sheared_layers",
         lambda n, _: {**column(n), "time_step": 0, "snapshot_interval": 0.5, **WHOLE},
         every((32, 64)), every((32,), solvers=("acm",), methods=("fast",)),
         (Measure("|u| at the interface", interface_speed, SECOND_LAYER, WHY_LAYER, .43700328, True),
          Measure("|B_xy| on the wall", shear_at(0), SECOND_LAYER, WHY_LAYER, .29522648, True),
          Measure("|B_xy| at the interface", shear_at(0.5), SECOND_LAYER, WHY_LAYER, .24588593, True,
                  misses={"classic": (.5, "the edge has the mean shear rate of solid and fluid, so that the error is 47 % on any grid")}),
          Measure("rms error of u(y, t) over a period, relative to the wall speed", layers_error, SECOND_LAYER, WHY_LAYER,
                  order={"fast": 1.9})),
         layers_line, ("y", "u at t = 26")),
    Case("S3", "Channel flow over a solid layer at rest", "sheared_layers",
         lambda n, _: {**column(n), "time_step": 0, "time_end": 30, "boundary_ymax_velocity": "0,0,0",
                       "boundary_ymax_angular_frequency": 0, "boundary_ymax_phase": 0, "body_force": "0.5,0,0", "fluid_viscosity": 0.1,
                       "layer_shear_modulus": 1, "snapshot_interval": 30, "profile_interval": 0, **WHOLE},
         every((32, 64)), every((16, 32), methods=("fast",), solvers=("acm",)),
         (Measure("largest error of u, relative to its maximum", resting_error, FIRST_CELL, WHY_FIRST_CELL, order={"fast": 1.9}),
          Measure("B_xy on the wall", resting_shear(0), SECOND_LAYER, WHY_LAYER, 0.375, True),
          Measure("B_xy at the interface", resting_shear(0.5), SECOND_LAYER, WHY_LAYER, 0.125, True,
                  misses={"classic": (1.0625, "the value is twice the exact one, apart from an error of first order, 4/n")})),
         resting_line, ("y", "u at t = 30")),
    Case("V1", "Layers of viscosity 1 and 5, the surface .3 h away from a face", "viscous_layers",
         lambda n, _: {**column(n), "layer_interval": f"0,{0.5 + 0.3 / n}"},
         every((32, 64), classic=(16, 32)), every((16,), solvers=("smac",)),
         (Measure("largest error of u, relative to the wall speed", viscous_error, {m: lambda n: 0.21 / n for m in ("fast", "classic")},
                  "error of u in the cell with the kink, .15 h (T - T/5) = .2 h, and .01 h because the stress T changes with the position of the surface"),
          Measure("power of the wall over T U", viscous_rate("wall_power"), {"fast": 1e-5, "classic": 1e-5},
                  "exact for any position of the surface, apart from the rest of the transient", 1, True),
          Measure("shear stress on the viscous wall over T", viscous_wall, {"fast": 1e-5, "classic": 1e-5}, "exact", 1, True),
          Measure("dissipation over T U", viscous_rate("viscous_dissipation"), {"fast": 1e-5, "classic": 1e-5},
                  "exact, by summation by parts", 1, True)),
         viscous_line, ("y", "u at t = 2")),
    wave("x", "y", quick=True), wave("y", "x"), wave("z", "x"), wave("x", "z", quick=True), wave("y", "z"),
    wave("x", "y", mean=0.5, quick=True),
    Case("S5", "Strain at a stagnation point between vortices", "shear_wave",
         lambda n, _: {**square(n), "fluid_viscosity": 0.01, "initial_velocity": "taylor_green",
                       "initial_velocity_amplitude": 1, "gel_shear_modulus": PASSIVE, "time_end": 0.1, "snapshot_interval": 0.1,
                       "profile_interval": 0, **WHOLE},
         every((33, 65), solvers=("acm",)), every((33, 65), methods=("fast",), solvers=("acm",)),
         (Measure("B_xx in the stagnation point at t = .1", stagnation,
                  {"fast": lambda n: 9.4e-4 * (65 / n)**2, "classic": lambda n: 8.4e-3 + 9.4e-4 * (65 / n)**2},
                  "twice the error of the strain rate, (k h)^2/24, times ln B_xx = 1.2: .047 % at 65^2; Euler adds (2 k)^2 t dt/2 with dt = .00106",
                  stagnation_exact(0.1), True, order={"fast": 1.9}),),
         stagnation_line, ("x", "B_xx on y = 1/2")),
    Case("S5", "Rotation in the centre of a vortex", "shear_wave",
         lambda n, _: {**square(n), "fluid_viscosity": 0.01, "initial_velocity": "taylor_green",
                       "initial_velocity_amplitude": 1, "gel_shear_modulus": PASSIVE, "time_end": 0.1, "snapshot_interval": 0.1,
                       "profile_interval": 0, **WHOLE},
         every((32, 64), solvers=("acm",)), every((32, 64), methods=("fast",), solvers=("acm",)),
         (Measure("largest |B - I| in the centre of the vortex at t = .1", centre_rotation,
                  {m: lambda n: 2 * ((2 * math.pi)**3 * 0.1 / (4 * n * n))**2 for m in ("fast", "classic")},
                  "twice g^2: in the mean of four cells the shear g = k^3 h^2 t/4 cancels, and g^2 remains", order={"fast": 3.5}),),
         lambda run: ((run.centres(0), run.snapshots[-1]["left_cauchy_green_xx"][0, run.cells[1] // 4]),
                      ([0.25], [1])), ("x", "B_xx on y = 1/4")),
    Case("S5", "A marked disc of fluid in simple shear", "disc_in_shear",
         lambda n, _: {**square(n, 8), "boundary_ymin_velocity": "-0.2,0,0", "boundary_ymax_velocity": "0.2,0,0",
                       "disc_shear_modulus": PASSIVE, "time_end": 20, "snapshot_interval": 20, **WHOLE},
         every((64, 128), solvers=("acm",)), every((64,), methods=("fast",), solvers=("acm",)),
         (Measure("Taylor deformation after a shear of 1", marked_disc, {"fast": lambda n: .01 * (128 / n)},
                  "goal: 1 % at 16 cells per radius", exact.sheared_circle(1), True),
          Measure("largest error of B in the middle", marked_strain,
                  {"fast": 1e-12, "classic": lambda n: 0.02 * (8 / n)**2},
                  "Couette flow is linear in space and B quadratic in time, so that Heun's method is exact to round-off; Euler: twice the shear rate times dt, dt = h^2/5")),
         marked_line, ("t", "Taylor deformation")),
)
