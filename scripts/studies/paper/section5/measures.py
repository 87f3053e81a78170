"""Numbers of a run of options/capillary_*.opts: a tube along x with its red cells and platelets."""
import numpy
from eulastic.rounding import floor


def tube(run):
    """Returns the radius of the lumen and the position (y, z) of its axis."""
    return float(run.options["vessel_radius"]), [float(x) for x in run.options["vessel_centre"].split(",")[1:]]


def force(run):
    """Returns the body force per volume along x."""
    return float(run.options["fluid_density"]) * float(run.options["body_force"].split(",")[0])


def area(run):
    return numpy.pi * tube(run)[0] ** 2


def shear_modulus(run, species):
    return float(run.options[f"{species}_shear_modulus"])


# Shear stress

def edge_stress(run, snapshot, d):
    """Returns the shear stress sigma_xy (d = 1) or sigma_xz (d = 2) less the momentum flux rho u v, averaged over x, on the edges
    between two cells along d: the part of the plasma and the part of the elastic bodies, each (nz, ny) with one entry fewer along d.
    sigma_xy = mu du/dy + sum of G avg4(phi) B_xy, as in the solver; the mean of dv/dx is 0 in a periodic box."""
    axis = 2 - d  # of arrays (nz, ny, nx)
    low, high = (numpy.s_[:-1], numpy.s_[1:])

    def pair(values):  # on the two sides of the edges along d
        cut = [numpy.s_[:]] * 3
        return values[tuple(cut[:axis] + [low] + cut[axis + 1:])], values[tuple(cut[:axis] + [high] + cut[axis + 1:])]

    u_low, u_high = pair(snapshot["velocity_x"].astype(float))
    across = snapshot["velocity_" + "xyz"[d]].astype(float)
    viscous = float(run.options["fluid_viscosity"]) * (u_high - u_low) / run.spacing[d]
    viscous -= float(run.options["fluid_density"]) * (u_low + u_high) / 2 * pair((across + numpy.roll(across, 1, 2)) / 2)[1]
    elastic = numpy.zeros_like(viscous)
    for species in run.options["species"].split(","):
        fraction = snapshot["solid_fraction_" + species].astype(float)
        around = sum(pair(fraction + numpy.roll(fraction, 1, 2))) / 4
        elastic += shear_modulus(run, species) * around * pair(
            snapshot[f"left_cauchy_green_x{'xyz'[d]}_{species}"].astype(float))[1]
    return viscous.mean(axis=2), elastic.mean(axis=2)


def bilinear(values, y0, z0, h, y, z):
    """Interpolates values (nz, ny), located at y0 + j h_y, z0 + k h_z, to the points y, z."""
    s, t = (y - y0) / h[1], (z - z0) / h[2]
    j, k = (numpy.floor(q).astype(int) for q in (s, t))
    s, t = s - j, t - k
    return (1 - t) * ((1 - s) * values[k, j] + s * values[k, j + 1]) + t * ((1 - s) * values[k + 1, j] + s * values[k + 1, j + 1])


def shear_stress(run, snapshot, radii):
    """Returns the force per area that the fluid inside a cylinder around the axis exerts on it, (parts, radii): the part of viscosity
    and momentum flux, and the part of elastic bodies. In a steady flow their sum is force x radius/2."""
    h, (y0, z0) = run.spacing, tube(run)[1]
    angle = (numpy.arange(720) + 0.5) * numpy.pi / 360
    parts = numpy.zeros((2, len(radii)))
    for d in (1, 2):
        fields = edge_stress(run, snapshot, d)
        first = [h[1] / 2, h[2] / 2]
        first[d - 1] *= 2
        for n, radius in enumerate(radii):
            y, z = y0 + radius * numpy.cos(angle), z0 + radius * numpy.sin(angle)
            normal = numpy.cos(angle) if d == 1 else numpy.sin(angle)
            parts[:, n] -= [(normal * bilinear(field, *first, h, y, z)).mean() for field in fields]
    return parts


def wall_shear_stress(run):
    """Returns the stress on the surface of the lumen in the last snapshot, relative to force x diameter/4."""
    radius = tube(run)[0]
    return float(shear_stress(run, run.snapshots[-1], [radius]).sum() / (force(run) * radius / 2))


def held_by_walls(run):
    """Returns the force on the walls of the box in the last snapshot, relative to the body force on the whole content of the box."""
    total = sum(snapshot_wall[..., 0].sum() * run.spacing[0] * run.spacing[3 - d]
                for d in (1, 2) for side in ("min", "max")
                for snapshot_wall in [run.snapshots[-1][f"wall_shear_stress_{'xyz'[d]}{side}"].astype(float)])
    return float(total / (force(run) * run.length.prod()))


def wall_displacements(run):
    """Returns the outward displacement of the surface of the lumen since the first snapshot, for every later snapshot, averaged over
    sixteenths of the circumference, for each cell along the vessel: (snapshots, nx, 16)."""
    radius, (y0, z0) = tube(run)
    angle = numpy.arctan2(run.centres(2)[:, None] - z0, run.centres(1)[None, :] - y0)
    part = floor((angle + numpy.pi) * 8 / numpy.pi) % 16  # cells on a diagonal lie on a boundary
    area = [snapshot["solid_fraction_vessel"].astype(float) for snapshot in run.snapshots]
    width = run.spacing[1] * run.spacing[2] / (radius * numpy.pi / 8)
    return numpy.array([[(first - later)[part == n].sum(axis=0) * width for n in range(16)]
                        for first in area[:1] for later in area[1:]]).swapaxes(1, 2)


def wall_speed(run):
    """Returns the mean of u and its root mean square over the solid cells of the wall within two cells of the lumen, in the last
    snapshot, relative to the largest speed of plasma alone."""
    radius, (y0, z0) = tube(run)
    distance = numpy.hypot(run.centres(1)[None, :] - y0, run.centres(2)[:, None] - z0)
    snapshot = run.snapshots[-1]
    near = (snapshot["solid_fraction_vessel"] > 0.999) & (distance < radius + 2 * run.spacing[1])[:, :, None]
    u = snapshot["velocity_x"].astype(float)[near] / (2 * poiseuille(run) / area(run))
    return u.mean(), numpy.sqrt((u ** 2).mean())


# Flow

def after(run, part):
    """Returns a mask of the times after the fraction `part` of the run."""
    return run.bodies.time >= part * run.bodies.time[-1]


def flow_rate(run, part=1 / 3):
    """Returns the mean flow rate after the fraction `part` of the run, and its standard deviation in time."""
    late = run.series.time >= part * run.series.time[-1]
    rate = run.series.vessel_flow_rate[late]
    return rate.mean(), rate.std()


def poiseuille(run):
    """Returns the flow rate of plasma alone by the law of Poiseuille."""
    return numpy.pi * tube(run)[0] ** 4 * force(run) / (8 * float(run.options["fluid_viscosity"]))


def plasma_rate(plasma, run):
    """Returns the flow rate of plasma with the viscosity of `run`, scaled from the run `plasma` of plasma alone."""
    return flow_rate(plasma)[0] * poiseuille(run) / poiseuille(plasma)


def of_species(run, name):
    return numpy.flatnonzero(run.bodies.species == name)


def hematocrit(run, part=1 / 3):
    """Returns the tube hematocrit at the start, and the discharge hematocrit: the volume flux of red cells over the flow rate, after
    the fraction `part` of the run."""
    cells = of_species(run, "rbc")
    volume = run.bodies.volume[:, cells]
    flux = (volume * run.bodies.velocity[:, cells, 0])[after(run, part)].sum(axis=1).mean() / run.length[0]
    return volume[0].sum() / (area(run) * run.length[0]), flux / flow_rate(run, part)[0]


def pries(diameter, discharge):
    """Returns the relative apparent viscosity of blood in glass tubes of `diameter` um (Pries, Neuhaus, Gaehtgens, Am. J. Physiol.
    263, H1770, 1992)."""
    at_45 = 220 * numpy.exp(-1.3 * diameter) + 3.2 - 2.44 * numpy.exp(-0.06 * diameter ** 0.645)
    narrow = 1 / (1 + 1e-11 * diameter ** 12)
    power = (0.8 + numpy.exp(-0.075 * diameter)) * (narrow - 1) + narrow
    return 1 + (at_45 - 1) * ((1 - discharge) ** power - 1) / ((1 - 0.45) ** power - 1)


def pries_bulk(discharge):
    """Returns the same viscosity for a tube so wide that the cell-free layer does not matter."""
    return pries(1000, discharge)


def pries_ratio(diameter, discharge):
    """Returns the tube hematocrit over the discharge hematocrit (Pries, Secomb, Gaehtgens, Gross, Circ. Res. 67, 826, 1990)."""
    return discharge + (1 - discharge) * (1 + 1.7 * numpy.exp(-0.415 * diameter) - 0.6 * numpy.exp(-0.011 * diameter))


# Where the cells are, and what follows from it

def profiles(run, snapshot):
    """Returns means over rings around the axis with the width of a grid cell: (radii, volume fraction of red cells, velocity)."""
    (y0, z0), width = tube(run)[1], run.spacing[1]
    distance = numpy.hypot(run.centres(1)[None, :] - y0, run.centres(2)[:, None] - z0)
    rings = [floor(distance / width) == n for n in range(floor(tube(run)[0] / width))]
    fields = [distance, *(snapshot[name].astype(float).mean(axis=2) for name in ("solid_fraction_rbc", "velocity_x"))]
    return [numpy.array([field[ring].mean() for ring in rings]) for field in fields]


def local_viscosity(runs):
    """Returns a, b of the relative viscosity 1 + a H + b H^2 at the local hematocrit H: a least-squares fit to the stress r/2 x force
    over the slope of u, at all rings of all snapshots but the first, weighted as the rings contribute to the flow rate."""
    rows = []
    for run in runs:
        for snapshot in run.snapshots[1:]:
            r, share, u = profiles(run, snapshot)
            edge = (r[1:] + r[:-1]) / 2
            slope = (u[:-1] - u[1:]) / numpy.diff(r)
            stress = force(run) * edge / 2 / float(run.options["fluid_viscosity"])
            rows.append((edge ** 1.5, (share[1:] + share[:-1]) / 2, stress / slope - 1))
    weight, share, more = (numpy.concatenate(column) for column in zip(*rows))
    return numpy.linalg.lstsq(weight[:, None] * numpy.stack([share, share ** 2], 1), weight * more, rcond=None)[0]


def tube_flow(radius, share, viscosity):
    """Returns the apparent relative viscosity and the discharge hematocrit of a tube with the hematocrit `share`(r) and the local
    relative viscosity `viscosity`(share)."""
    r = (numpy.arange(4000) + 0.5) / 4000 * radius
    h = share(r)
    u = numpy.cumsum((r / viscosity(h))[::-1])[::-1]
    return (r * numpy.cumsum(r[::-1])[::-1]).sum() / (r * u).sum(), (r * u * h).sum() / (r * u).sum()


def cell_free_layer(radius, hematocrit, viscosity, wanted):
    """Returns the width of the cell-free layer at the wall with which a tube, whose cells are distributed evenly in the rest of it,
    has the apparent viscosity `wanted`(discharge hematocrit)."""
    def too_viscous(width):
        core = radius - width
        here, discharge = tube_flow(radius, lambda r: numpy.where(r < core, hematocrit * (radius / core) ** 2, 0), viscosity)
        return here > wanted(discharge)
    low, high = 0.0, (1 - hematocrit ** 0.5) * radius
    for _ in range(30):
        middle = (low + high) / 2
        low, high = (middle, high) if too_viscous(middle) else (low, middle)
    return low


# Platelets

def radial(run):
    """Returns the distance from the axis and the radial velocity of every platelet at all times, (nt, n) each."""
    who = of_species(run, "platelet")
    place = run.bodies.centroid[:, who, 1:] - tube(run)[1]
    velocity = run.bodies.velocity[:, who, 1:]
    distance = numpy.linalg.norm(place, axis=2)
    return distance, (place * velocity).sum(axis=2) / distance


def radial_rms(run, part=1 / 3):
    """Returns the root mean square of the radial velocity over all platelets and later times, and its standard error, estimated from
    the differences between platelets."""
    square = (radial(run)[1][after(run, part)] ** 2).mean(axis=0)  # of each
    value = numpy.sqrt(square.mean())
    return value, square.std(ddof=1) / numpy.sqrt(len(square)) / (2 * value)


def overlap(run):
    """Returns the volume by which all bodies together exceed the volume of the cells that they fill, relative to the volume of all red
    cells: the largest value of all snapshots."""
    largest = 0
    for snapshot in run.snapshots:
        fraction = {name: snapshot["solid_fraction_" + name] for name in run.options["species"].split(",")}
        largest = max(largest, numpy.maximum(sum(fraction.values()) - 1.0, 0).sum() / fraction["rbc"].sum())
    return largest
