"""Fields of a snapshot for pictures, all at the centres of cells, (nz, ny, nx): those of the file, and fields that are computed
from them. The names are those of docs/outputs.md, and speed, vorticity_x, vorticity_y and vorticity_z."""
import numpy

QUANTITIES = {"speed": "velocity", "velocity": "velocity", "vorticity": "rate", "pressure": "pressure", "wall": "pressure"}
SIGNED = "velocity", "vorticity", "pressure"


def names(snapshot):
    """Returns the names of all fields that `field` can compute from this snapshot."""
    own = [name for name in snapshot.fields if not name.startswith(("velocity", "wall_shear_stress_"))]
    if "velocity" in snapshot:
        own += ["speed", *(f"{what}_{d}" for what in ("velocity", "vorticity") for d in "xyz")]
    return sorted(own)


def quantity(name):
    """Returns the kind of unit of a field: velocity, rate, pressure, or None for a pure number."""
    return QUANTITIES.get(name.split("_")[0])


def is_signed(name):
    return name.split("_")[0] in SIGNED or name in ("left_cauchy_green_xy", "left_cauchy_green_xz", "left_cauchy_green_yz")


def field(snapshot, name):
    """Returns a field (nz, ny, nx). KeyError lists the accepted names. Staggered components of B are not averaged: they lie half
    a cell below the centres."""
    if name not in names(snapshot):
        raise KeyError(f"{name}; accepted: {', '.join(names(snapshot))}")
    if name == "speed":
        return numpy.linalg.norm(snapshot.velocity(), axis=0)
    if name.startswith("velocity_"):
        return snapshot.velocity()["xyz".index(name[-1])]
    if name.startswith("vorticity_"):
        return vorticity(snapshot, "xyz".index(name[-1]))
    values = snapshot[name].astype(float)
    return numpy.linalg.norm(values, axis=-1) if values.ndim == 4 else values


def vorticity(snapshot, d):
    """Returns component d of curl v from the velocity at the centres, by central differences of second order, one-sided beside
    boundaries that are not periodic."""
    first, second = (d + 1) % 3, (d + 2) % 3
    velocity = snapshot.velocity()
    return slope(snapshot.run, velocity[second], first) - slope(snapshot.run, velocity[first], second)


def slope(run, values, d):
    axis, n = 2 - d, run.cells[d]
    if n == 1:
        return numpy.zeros_like(values)
    if run.is_bounded(d):
        return numpy.gradient(values, run.spacing[d], axis=axis)
    return (numpy.roll(values, -1, axis) - numpy.roll(values, 1, axis)) / (2 * run.spacing[d])


def least(snapshot, name):
    """Returns the magnitude below which values are round-off."""
    speed = numpy.linalg.norm(snapshot.velocity(), axis=0).max() if "velocity" in snapshot else 0
    scale = {"velocity": speed, "rate": speed / snapshot.run.length.max(),
             "pressure": float(snapshot.run.options.get("fluid_density", 1)) * speed**2}.get(quantity(name), 1)
    return 1e-6 * scale


def limits(name, values, floor):
    """Returns the ends of a colour scale. A field with both signs has 0 in the middle; a field that is never negative begins at
    0."""
    low, high = float(values.min()), float(values.max())
    if not numpy.isfinite([low, high]).all() or max(-low, high) <= floor:
        return -max(floor, 1e-300), max(floor, 1e-300)
    if is_signed(name) and low < -0.02 * high and high > -0.02 * low:
        return -max(-low, high), max(-low, high)
    return min(low, 0.0) if low < 0.5 * high else low, max(high, 0.0) if high > 0.5 * low else high
