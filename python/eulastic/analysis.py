"""Computes averages over time with standard errors, pressure drop, apparent viscosity, averages of the wall shear stress, and the
cell-free layer of a run. `since` and `until` bound the time of the average."""
import collections
import types

import numpy

from .surfaces import sample

Average = collections.namedtuple("Average", "mean standard_error correlation_time independent")


def weights(time):
    """Returns the weights of the trapezoidal rule, with the sum 1; equal weights if there is only one time."""
    if len(time) < 2 or time[-1] == time[0]:
        return numpy.full(len(time), 1 / max(1, len(time)))
    steps = numpy.diff(time)
    return (numpy.append(steps, 0) + numpy.insert(steps, 0, 0)) / 2 / (time[-1] - time[0])


def correlated_rows(deviations):
    """Returns the integrated autocorrelation time in rows, at least 1: 1 + 2 sum of r_k, the initial positive sequence of Geyer,
    "Practical Markov Chain Monte Carlo", Statistical Science 7 (1992). Not a number if it is longer than a tenth of the rows."""
    n = len(deviations)
    variance = deviations @ deviations / n
    if variance == 0:
        return 1.0 if n >= 10 else numpy.nan
    total = -1.0
    for lag in range(0, n - 1, 2):
        pair = sum(deviations[:n - k] @ deviations[k:] for k in (lag, lag + 1)) / (n * variance)
        if pair <= 0:
            break
        total += 2 * pair
    return max(1.0, total) if max(1.0, total) <= n / 10 else numpy.nan


def time_average(time, values, since=-numpy.inf, until=numpy.inf):
    """Returns Average(mean, standard_error, correlation_time, independent) of values (nt) at evenly spaced times (nt), such as the
    rows of series.csv. The mean is an integral by the trapezoidal rule. The standard error accounts for the correlation of
    neighbouring rows; `independent` is the number of independent samples. With fewer than ten of them, as in a developing flow or a
    short series, all but the mean are not a number."""
    time, values = numpy.asarray(time, float), numpy.asarray(values, float)
    used = (time >= since) & (time <= until)
    time, values = time[used], values[used]
    if len(time) == 0:
        raise ValueError(f"time_average: no row between {since:g} and {until:g}")
    mean, n = float(weights(time) @ values), len(time)
    rows = correlated_rows(values - values.mean())
    error = numpy.sqrt(values.var() * rows / (n - rows)) if rows < n else numpy.nan
    return Average(mean, float(error), float(rows * (time[-1] - time[0]) / max(1, n - 1)), float(n / rows))


def vector(run, name):
    return numpy.array([float(x) for x in run.options.get(name, "0,0,0").split(",")])


def dimension(run):
    return 2 if run.cells[2] == 1 else 3


def drops(run):
    """Returns the pressure drops along x, y and z at the rows of series.csv, (3, nt)."""
    series, number = run.series, lambda name, default: float(run.options.get(name, default))
    swing = numpy.cos(number("body_force_angular_frequency", 0) * series.time + number("body_force_phase", 0))
    found = number("fluid_density", 1) * numpy.outer(vector(run, "body_force") * run.length, swing)
    for d, axis in enumerate("xyz"):
        for end, sign in (("min", 1), ("max", -1)):
            if f"pressure_{axis}{end}" in series.dtype.names:
                found[d] += sign * series[f"pressure_{axis}{end}"]
    return found


def direction_of_flow(run):
    """Returns the direction with the largest pressure drop. ValueError if nothing drives the flow."""
    largest = abs(drops(run)).max(axis=1)
    if not largest.max() > 0:
        raise ValueError(f"{run.directory}: neither a body force nor the pressure of boundaries drives this flow")
    return int(largest.argmax())


def pressure_drop(run, d=None):
    """Returns the pressure drop (nt) at the rows of series.csv along direction d (0, 1, 2; by default the one with the largest
    drop): that of the body force (density x force x length of the box) and that between inflow, pressure and outflow boundaries."""
    return drops(run)[direction_of_flow(run) if d is None else d]


def channels(run, d):
    """Returns [(low, high, low wall, high wall)] for the fluid along d between walls of the box and slabs. A wall is "ymin", ... or a
    slab and its face, "NAME_ymax", ...; it is None for other boundaries. Across a periodic boundary `high` is beyond the box."""
    axis, length, spaces = "xyz"[d], run.length[d], []
    slabs = [name for name, shape in run.species.items()
             if shape == "slab" and run.is_fixed(name) and run.options.get(f"{name}_axis", "y") == axis]
    low, wall = 0.0, f"{axis}min" if run.side(d, 0) == "wall" else None
    for first, last, name in sorted((*vector(run, f"{name}_interval"), name) for name in slabs):
        if first > low:
            spaces.append((low, first, wall, f"{name}_{axis}min"))
        if last > low:
            low, wall = last, f"{name}_{axis}max"
    if low < length:
        spaces.append((low, length, wall, f"{axis}max" if run.side(d, 1) == "wall" else None))
    if not run.is_bounded(d) and len(spaces) > 1 and spaces[0][2] is None and spaces[-1][3] is None:
        (_, high, _, last), (low, _, first, _) = spaces.pop(0), spaces.pop()
        spaces.append((low, length + high, first, last))
    elif not run.is_bounded(d) and len(spaces) == 1 and spaces[0][2:] != (None, None):
        low, high, first, last = spaces.pop()  # a slab at one side of the box is the wall at the other one
        spaces.append((low, high, first or f"{slabs[-1]}_{axis}max", last or f"{slabs[0]}_{axis}min"))
    return spaces


def channel(run, d):
    """Returns (height of the fluid along d, gap) of the only channel between walls normal to d; the gap includes the mirror image
    behind a plane of symmetry. (0, 0) if there is no channel or there are several."""
    spaces = channels(run, d)
    if len(spaces) != 1:
        return 0.0, 0.0
    (low, high, *walls), sides = spaces[0], [run.side(d, side) for side in (0, 1)]
    ends = sorted("wall" if wall else side for wall, side in zip(walls, sides))
    return high - low, {("wall", "wall"): 1, ("symmetry", "wall"): 2}.get(tuple(ends), 0) * (high - low)


def tubes(run):
    return [name for name, shape in run.species.items() if shape in ("tube", "constricted_tube")]


def refuse_inner_walls(run, what):
    """Raises ValueError for vessels from a file, whose walls have no known distance."""
    inner = [name for name, shape in run.species.items() if shape == "voxels" and run.is_fixed(name)]
    if inner:
        raise ValueError(f"{run.directory}: {what}: {inner[0]} is neither a tube, a slab nor a wall of the box")


def apparent_viscosity(run, species=None):
    """Returns the viscosity (nt), at the rows of series.csv, with which a Newtonian fluid would have the flow rate of this run at its
    pressure drop. In a tube, `species` or the only one, it is the column NAME_apparent_viscosity (Poiseuille's law); in a plane
    channel between two walls of the box or slabs, pressure drop / length x gap^2 / (12 x mean velocity of the fluid). It is
    meaningful in steady flow or averaged over periods. 0 where nothing flows. ValueError in any other flow."""
    vessels = [species] if species else tubes(run)
    if len(vessels) == 1 and f"{vessels[0]}_apparent_viscosity" in run.series.dtype.names:
        return run.series[f"{vessels[0]}_apparent_viscosity"]
    refuse_inner_walls(run, "apparent viscosity")
    walls = [d for d in range(dimension(run)) if channel(run, d)[1] > 0]
    if vessels or len(walls) != 1 or direction_of_flow(run) in walls:
        raise ValueError(f"{run.directory}: apparent viscosity: neither a tube (of several, name one) nor a plane channel")
    along = direction_of_flow(run)
    height, gap = channel(run, walls[0])
    mean = run.series["bulk_velocity_" + "xyz"[along]] * run.length[walls[0]] / height
    gradient = pressure_drop(run, along) / run.length[along]
    return numpy.divide(gradient * gap ** 2, 12 * mean, out=numpy.zeros(len(mean)), where=mean != 0)


def between(run, since, until):
    found = [snapshot for snapshot in run.snapshots if since <= snapshot.time <= until]
    if not found:
        raise ValueError(f"{run.directory}: no snapshot between {since:g} and {until:g}")
    return found


def wall_shear(run, where="", since=-numpy.inf, until=numpy.inf):
    """Returns averages over the snapshots of the shear stress on vessels and obstacles, (nz, ny, nx), or with where="ymin", ... on
    that wall of the box, one layer. The namespace has `mean`, the mean vector (..., 3); `tawss`, the mean magnitude (time-averaged
    wall shear stress); and `osi`, the oscillatory shear index (1 - |mean| / tawss) / 2: 0 where the stress keeps its direction,
    1/2 where its mean vanishes, not a number where there is no stress."""
    snapshots = between(run, since, until)
    shares = weights(numpy.array([snapshot.time for snapshot in snapshots]))
    mean, size = 0.0, 0.0
    for share, snapshot in zip(shares, snapshots):
        stress = snapshot["wall_shear_stress" + ("_" + where if where else "")].astype(float)
        mean = mean + share * stress
        size = size + share * numpy.linalg.norm(stress, axis=-1)
    ratio = numpy.divide(numpy.linalg.norm(mean, axis=-1), size, out=numpy.full(size.shape, numpy.nan), where=size > 0)
    return types.SimpleNamespace(mean=mean, tawss=size, osi=(1 - numpy.minimum(ratio, 1)) / 2)


def first_crossing(fraction, distance):
    """Returns the distance at which each row of (n, m), values at increasing distances (m), first reaches 1/2, by linear
    interpolation; not a number if it never does."""
    inside = fraction >= 0.5
    at, rows = inside.argmax(axis=1), numpy.arange(len(fraction))
    before = numpy.maximum(at - 1, 0)
    low, high = fraction[rows, before], fraction[rows, at]
    part = numpy.divide(0.5 - low, high - low, out=numpy.ones(len(rows)), where=high > low)
    crossing = distance[before] + numpy.clip(part, 0, 1) * (distance[at] - distance[before])
    return numpy.where(inside.any(axis=1), crossing, numpy.nan)


def lumen_radius(run, name):
    """Returns the radius of the lumen of a tube at the cell centres along its axis; the throat of a constricted tube follows a
    cosine (docs/method/bodies.md)."""
    axis, number = "xyz".index(run.options.get(f"{name}_axis", "y")), lambda what: float(run.options[f"{name}_{what}"])
    radius = numpy.full(run.cells[axis], number("radius"))
    if run.species[name] == "constricted_tube":
        s, throat = run.centres(axis) - vector(run, f"{name}_centre")[axis], number("throat_length")
        depth = (number("radius") - number("throat_radius")) / 2 * (1 + numpy.cos(2 * numpy.pi * s / throat))
        radius -= numpy.where(2 * abs(s) < throat, depth, 0)
    return radius


def rays_of_tube(run, name):
    """Returns points (n, m, 3) from the surface of the lumen to its axis, at most about a cell apart around and along the axis and a
    quarter of a cell inward; their distances (m) from the surface, in radii; and the radius of the lumen at each ray (n)."""
    axis, radii = "xyz".index(run.options.get(f"{name}_axis", "y")), lumen_radius(run, name)
    centre, h, widest = vector(run, f"{name}_centre"), min(run.spacing[:dimension(run)]), radii.max()
    flat = dimension(run) == 2 and axis < 2  # a channel in the plane
    turns = 2 if flat else int(numpy.ceil(2 * numpy.pi * widest / h))
    angle = (numpy.arange(turns) + (0.5 if turns > 2 else 0)) * 2 * numpy.pi / turns
    distance = numpy.linspace(0, 1, int(numpy.ceil(4 * widest / h)) + 1)
    from_axis = radii[:, None, None] * (1 - distance)
    first, second = ((1, 2), (2, 0), (0, 1))[axis]
    if flat:
        first, second = (1 - axis, 2)
    points = numpy.empty((run.cells[axis], turns, len(distance), 3))
    points[..., axis] = run.centres(axis)[:, None, None]
    points[..., first] = centre[first] + numpy.cos(angle)[:, None] * from_axis
    points[..., second] = centre[second] + numpy.sin(angle)[:, None] * from_axis
    if flat:
        points[..., 2] = run.centres(2)[0]
    return points.reshape(-1, len(distance), 3), distance, numpy.repeat(radii, turns)


def layers(run, fraction):
    """Returns {wall: distances of the nearest bodies (n)} in one snapshot."""
    found, periodic = {}, [not run.is_bounded(d) for d in (2, 1, 0)]
    for name in tubes(run):
        points, distance, radii = rays_of_tube(run, name)
        values = sample(fraction, points.reshape(-1, 3) / run.spacing - 0.5, periodic).reshape(points.shape[:2])
        found[name] = first_crossing(values, distance) * radii
    if found:
        return found
    for d in range(dimension(run)):
        lines = numpy.moveaxis(fraction, 2 - d, -1).reshape(-1, run.cells[d])
        lines, centres = numpy.concatenate((lines, lines), axis=1), numpy.append(run.centres(d), run.centres(d) + run.length[d])
        for low, high, first, last in channels(run, d):
            between_walls = (centres > low) & (centres < high)
            line, centre = lines[:, between_walls], centres[between_walls]
            if first:
                found[first] = first_crossing(line, centre - low)
            if last:
                found[last] = first_crossing(line[:, ::-1], high - centre[::-1])
    return found


def cell_free_layer(run, species=None, since=-numpy.inf, until=numpy.inf):
    """Returns the thickness of the layer beside the walls without bodies of all moving species, or of one. On a line from every cell
    of the wall inward, in a tube along its radius, it ends where the solid fraction reaches 1/2; lines without a body do not count.

    The namespace has `time` (nt) of the snapshots; `thickness` (nt), the mean over all walls, and `walls`, {wall: (nt)} for
    each (ymin, ..., NAME_ymax, ... of a slab, or the name of the tube); `mean`, over time; `deviation`, the standard deviation over walls and time
    (roughness); `covered`, the share of the lines that meet a body. ValueError where there is no wall or no snapshot."""
    refuse_inner_walls(run, "cell-free layer")
    snapshots, walls, every = between(run, since, until), {}, []
    for snapshot in snapshots:
        fraction = (snapshot.fraction_of(species) if species else snapshot.fraction_of_bodies()).astype(float)
        found = layers(run, fraction)
        if not found:
            raise ValueError(f"{run.directory}: cell-free layer: there is neither a tube nor a wall of the box nor a slab")
        every.append(numpy.concatenate(list(found.values())))
        for wall, distances in found.items():
            walls.setdefault(wall, []).append(mean_of(distances))
    time, lines = numpy.array([snapshot.time for snapshot in snapshots]), numpy.array(every)
    thickness, share = numpy.array([mean_of(row) for row in every]), weights(time)
    met = numpy.isfinite(thickness)
    mean = share[met] @ thickness[met] / share[met].sum() if share[met].sum() > 0 else numpy.nan
    seen = lines[numpy.isfinite(lines)]
    return types.SimpleNamespace(time=time, thickness=thickness, walls={name: numpy.array(rows) for name, rows in walls.items()},
                                 mean=float(mean), deviation=float(seen.std()) if seen.size else numpy.nan,
                                 covered=float(numpy.isfinite(lines).mean()))


def mean_of(distances):
    """Returns the mean of the finite distances; not a number if there are none."""
    met = distances[numpy.isfinite(distances)]
    return float(met.mean()) if met.size else numpy.nan
