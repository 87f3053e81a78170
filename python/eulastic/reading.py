"""The output directory of a run (docs/outputs.md)."""
import functools
import json
import pathlib
import types
import warnings

import h5py
import numpy

from .option_files import read_options

VESSELS = "tube", "constricted_tube", "voxels"

class Snapshot:
    """One snapshot file. Fields are read on access, as arrays (nz, ny, nx), or (nz, ny, nx, 3) for a vector."""

    def __init__(self, path, run):
        self.path, self.run = path, run
        with h5py.File(path) as file:
            self.time = float(numpy.squeeze(file.attrs["time"]))
            self.fields = sorted(file)

    def __contains__(self, name):
        return name in self.fields

    def __getitem__(self, name):
        with h5py.File(self.path) as file:
            return file[name][...]

    def coordinates(self, name):
        """Returns (x, y, z) of a field, each an array along its direction: the value [k, j, i] lies at (x[i], y[j], z[k])."""
        with h5py.File(self.path) as file:
            where = file[name].attrs.get("location", "centre")
            nx, ny, nz = file[name].shape[2::-1]
        where = where.decode() if isinstance(where, bytes) else where
        staggered = where.split("_")[1] if "_" in where else ""
        return tuple((numpy.arange(n) + (0 if d in staggered else 0.5)) * h
                     for d, n, h in zip("xyz", (nx, ny, nz), self.run.spacing))

    def velocity(self):
        """Returns the velocity at cell centres, (3, nz, ny, nx); velocity_x, _y, _z are the staggered components."""
        return numpy.moveaxis(self["velocity"].astype(float), -1, 0)

    def wall_shear_stress(self, d, side):
        """Returns the magnitude of the shear stress on the low (0) or high (1) wall normal to d: (nz, ny, nx), one layer along d."""
        return numpy.linalg.norm(self[f"wall_shear_stress_{'xyz'[d]}{('min', 'max')[side]}"].astype(float), axis=-1)

    def surface_shear_stress(self):
        """Returns the magnitude of the shear stress on vessels and obstacles in the cells that their surface cuts, 0 in all
        others."""
        return numpy.linalg.norm(self["wall_shear_stress"].astype(float), axis=-1)

    def plane(self, d=2, place=None):
        """Returns the index of the plane of cells normal to d (0, 1, 2) at `place`; ValueError outside of the box. By default it
        is the plane with the largest amount of moving bodies; without any, that with the largest lumen of the vessels; without
        any solid, the middle one. Among planes that differ by round-off only, it is the one next to the middle, of two such
        planes the first."""
        if place is not None:
            if not 0 <= place <= self.run.length[d]:
                raise ValueError(f"{'xyz'[d]} = {place:g} is outside of the box; accepted: 0 to {self.run.length[d]:g}")
            return min(int(place / self.run.spacing[d]), self.run.cells[d] - 1)
        others = tuple({0, 1, 2} - {2 - d})
        bodies = self.fraction_of_bodies().sum(axis=others, dtype=float)
        if not bodies.any() and "solid_fraction" in self:
            solid = self["solid_fraction"]
            bodies = (1 - solid).sum(axis=others, dtype=float) if solid.any() else bodies
        if not bodies.any():
            return self.run.cells[d] // 2
        most = numpy.flatnonzero(bodies >= (1 - 1e-6) * bodies.max())
        return int(most[(len(most) - 1) // 2])

    def fraction_of(self, species):
        """Returns the solid fraction of one species, (nz, ny, nx). KeyError if the run does not have it."""
        if species not in self.run.species:
            raise KeyError(f"{self.run.directory}: there is no species {species}; accepted: {', '.join(self.run.species) or 'none'}")
        return self["solid_fraction" + ("_" + species if len(self.run.species) > 1 else "")]

    def fraction_of_bodies(self):
        """Returns the solid fraction of all species that move with the flow, (nz, ny, nx), without vessels, slabs and other
        walls."""
        moving = [name for name in self.run.species if not self.run.is_fixed(name)]
        if "solid_fraction" not in self or not moving and self.run.species:
            return numpy.zeros(self.run.cells[::-1], "f4")
        if len(moving) == len(self.run.species):
            return self["solid_fraction"]
        return sum(self.fraction_of(name) for name in moving)

    def bonds(self):
        """Returns the rows of adhesion_bonds.csv at the time of this snapshot, as `Run.adhesion_bonds` has them; no rows without
        adhesion."""
        rows = self.run.adhesion_bonds
        if rows is None or not len(rows):
            return rows
        return rows[abs(rows.time - self.time) <= 1e-12 * max(1, abs(self.time))]


def is_finished(directory):
    """Returns whether a run reached its end. Until then summary.json is that of its last checkpoint and says `unfinished`."""
    path = pathlib.Path(directory) / "summary.json"
    return path.exists() and json.loads(path.read_text())["exit_reason"] in ("time_end", "steps")


class Run:
    """A finished or unfinished run. Parts that have not been written yet are empty or None. Raises FileNotFoundError if the
    directory holds no run; print(run) summarises it.

    options    {name: value} as resolved
    summary    summary.json
    series     numpy record array, one entry per line of series.csv, fields named by its header
    bodies     arrays of bodies.h5: time (nt), id, species (nb), centroid (nt, nb, 3), ...
    probes     probes.csv likewise; profile["x"], ["y"], ["z"] profile_x.csv, ..., if they exist
    snapshots  list of Snapshot in the order of time
    adhesion_bonds, adhesion_events  adhesion_bonds.csv, ... as series, read at first use; None without adhesion
    """

    def __init__(self, directory):
        self.directory = pathlib.Path(directory)
        if not (self.directory / "options.txt").exists():
            raise FileNotFoundError(f"{directory}: no run here (options.txt is missing)")
        self.options = read_options(self.directory / "options.txt")
        self.summary = self._if_there("summary.json", lambda path: json.loads(path.read_text()), {})
        self.series = self._if_there("series.csv", read_series, None)
        self.probes = self._if_there("probes.csv", read_series, None)
        profiles = {d: self._if_there(f"profile_{d}.csv", read_series, None) for d in "xyz"}
        self.profile = {d: rows for d, rows in profiles.items() if rows is not None}
        self.bodies = self._if_there("bodies.h5", read_bodies, None)
        snapshots = (_unless_damaged(lambda p: Snapshot(p, self), p) for p in self.directory.glob("snapshot_*.h5"))
        self.snapshots = sorted((s for s in snapshots if s is not None), key=lambda s: s.time)

    def _if_there(self, name, read, otherwise):
        path = self.directory / name
        return read(path) if path.exists() else otherwise

    @functools.cached_property
    def adhesion_bonds(self):
        return self._if_there("adhesion_bonds.csv", read_series, None)

    @functools.cached_property
    def adhesion_events(self):
        return self._if_there("adhesion_events.csv", read_series, None)

    @property
    def species(self):
        """Returns {name: shape} in the order of -species."""
        names = self.options.get("species", "")
        return {name: self.options.get(name + "_shape") for name in names.split(",")} if names else {}

    def is_fixed(self, species):
        """Returns whether the species is a vessel or an obstacle (rigid, anchored or from a file, but no membrane), which the
        flow does not carry along."""
        shape, of = self.species[species], lambda name, default: self.options.get(f"{species}_{name}", default)
        anchored = of("anchored", "true" if shape in ("slab", "tube", "constricted_tube") else "false")
        law = of("law", "neo_hookean")
        return law == "rigid" or law not in ("membrane", "red_cell") and (anchored == "true" or shape == "voxels")

    @property
    def cells(self):
        """(nx, ny, nz)"""
        return tuple(int(n) for n in self.options["grid_cells"].split(","))

    @property
    def length(self):
        return numpy.array([float(x) for x in self.options["grid_length"].split(",")])

    @property
    def spacing(self):
        return self.length / self.cells

    def side(self, d, high):
        """Returns the kind of the low (0) or high (1) boundary in direction d: periodic, wall, symmetry, inflow, pressure or
        outflow."""
        name = "boundary_" + "xyz"[d]
        both, own, other = (self.options.get(name + end, "same") for end in ("", *("min", "max")[::1 - 2 * high]))
        both = "periodic" if both == "same" else both
        if self.cells[d] == 1 or (both == "periodic" and "same" in (own, other)):
            return "periodic"
        return both if own == "same" else own

    def is_bounded(self, d):
        return self.side(d, 0) != "periodic"

    def centres(self, d):
        """Returns the coordinates of the cell centres along direction d."""
        return (numpy.arange(self.cells[d]) + 0.5) * self.spacing[d]


    def __str__(self):
        lines = [f"{self.directory}: {' x '.join(map(str, self.cells))} cells, box "
                 f"{' x '.join(f'{x:g}' for x in self.length)}"]
        lines += [f"  {name:28} {value}" for name, value in self.summary.items() if name not in ("bodies", "sides")]
        if self.series is not None:
            lines.append(f"  series: {len(self.series)} lines of {', '.join(self.series.dtype.names)}")
        if self.bodies is not None:
            names = ", ".join(vars(self.bodies))
            lines.append(f"  bodies: {len(self.bodies.id)} at {len(self.bodies.time)} times: {names}")
        lines += [f"  {s.path.name}: t = {s.time:g}: {', '.join(s.fields)}" for s in self.snapshots]
        return "\n".join(lines)


def _unless_damaged(read, path):
    """Returns None, with a warning, for a truncated or damaged HDF5 file."""
    try:
        return read(path)
    except (OSError, KeyError) as error:
        warnings.warn(f"{path} is damaged or truncated and left out: {error}", stacklevel=3)
        return None


def read_series(path):
    """Returns the complete lines of a table; a truncated last line is left out. None without a header."""
    lines = path.read_text().split("\n")[:-1]
    if not lines:
        return None
    names = lines[0].split(",")
    rows = numpy.loadtxt(lines[1:], delimiter=",", ndmin=2) if len(lines) > 1 else numpy.empty((0, len(names)))
    return numpy.rec.fromarrays(rows.T, names=names)


def read_bodies(path):
    """Returns the arrays of bodies.h5, cut to the rows that all of them have. None, with a warning, for a damaged file."""
    def read(path):
        with h5py.File(path) as file:
            return {name: item[...] for name, item in file.items()}

    arrays = _unless_damaged(read, path)
    if arrays is None:
        return None
    rows = min((len(values) for name, values in arrays.items() if name not in ("id", "species")), default=0)
    arrays = {name: values if name in ("id", "species") else values[:rows] for name, values in arrays.items()}
    arrays["species"] = numpy.array([s.decode() if isinstance(s, bytes) else s for s in arrays["species"]])
    return types.SimpleNamespace(**arrays)


def over_time(rows):
    """Returns the rows of profiles or probes as arrays over time: time (nt); positions (n), which are constant; every other
    column (nt, n). A last time with missing rows is left out. ValueError if the positions change in time, as they do after a
    restart with other -probe_points."""
    names = [name for name in rows.dtype.names if name != "time"]
    count = int((rows.time == rows.time[0]).sum()) if len(rows) else 0
    number = numpy.arange(len(rows)) % max(count, 1)
    for name in ("time", "x", "y", "z", "probe"):
        constant = numpy.arange(len(rows)) - number if name == "time" else number
        if name in rows.dtype.names and (rows[name] != rows[name][constant]).any():
            raise ValueError("over_time: the positions change in time, as after a restart with other -probe_points; accepted: rows of "
                             "the same positions, such as rows[rows.time > TIME]")
    whole = rows[:len(rows) // count * count] if count else rows
    arrays = {name: whole[name].reshape(-1, max(count, 1)) for name in names}
    arrays = {name: values[0] if name in ("x", "y", "z", "probe") and len(values) else values for name, values in arrays.items()}
    return types.SimpleNamespace(time=whole.time[::count] if count else whole.time, **arrays)
