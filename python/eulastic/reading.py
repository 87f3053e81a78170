"""The output directory of a run, and files of options (docs/outputs.md, docs/options.md)."""
import json
import pathlib
import types

import h5py
import numpy


def parse_options(words):
    """Options as {name without dash: value}; `words` alternate between names and values, "" for a bare name."""
    options, name = {}, None
    for word in words:
        if word.startswith("-") and word[1:2].isalpha():
            name = word[1:]
            options[name] = ""
        elif name is not None:
            options[name] = word
            name = None
    return options


def read_options(path):
    """An options file: lines `-name value`, # starts a comment; -options_file brings in another, which it wins over."""
    path = pathlib.Path(path)
    lines = (line.split("#")[0].split(maxsplit=1) for line in path.read_text().splitlines())
    options = parse_options(word.strip() for line in lines for word in line)
    if "options_file" in options:
        options = {**read_options(path.parent / options.pop("options_file")), **options}
    return options


class Snapshot:
    """One snapshot file. Fields are read when asked for: arrays (nz, ny, nx), or (nz, ny, nx, 3) of a vector."""

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
        """(x, y, z) of a field, each an array along its direction: value [k, j, i] lies at (x[i], y[j], z[k])."""
        with h5py.File(self.path) as file:
            where = file[name].attrs.get("location", "centre")
            nx, ny, nz = file[name].shape[2::-1]
        where = where.decode() if isinstance(where, bytes) else where
        staggered = where.split("_")[1] if "_" in where else ""
        return tuple((numpy.arange(n) + (0 if d in staggered else 0.5)) * h
                     for d, n, h in zip("xyz", (nx, ny, nz), self.run.spacing))

    def velocity(self):
        """Velocity at cell centres, (3, nz, ny, nx); velocity_x, _y, _z are the staggered ones."""
        return numpy.moveaxis(self["velocity"].astype(float), -1, 0)

    def wall_shear_stress(self, d, side):
        """Size of the shear stress on the low (0) or high (1) wall normal to d: (nz, ny, nx), one layer along d."""
        return numpy.linalg.norm(self[f"wall_shear_stress_{'xyz'[d]}{('min', 'max')[side]}"].astype(float), axis=-1)

    def surface_shear_stress(self):
        """Size of the shear stress on vessels and obstacles in the cells that their surface cuts, 0 in others."""
        return numpy.linalg.norm(self["wall_shear_stress"].astype(float), axis=-1)

    def plane(self, d=2, place=None):
        """Index of the plane of cells normal to d (0, 1, 2) at `place`; by default the one that cuts the most solid, the first
        of those that differ by round-off only, and without any solid the middle one."""
        if place is not None:
            return int(numpy.clip(place / self.run.spacing[d], 0, self.run.cells[d] - 1))
        others = tuple({0, 1, 2} - {2 - d})
        solid = self["solid_fraction"].sum(axis=others, dtype=float) if "solid_fraction" in self else numpy.zeros(1)
        return int((solid >= (1 - 1e-6) * solid.max()).argmax()) if solid.any() else self.run.cells[d] // 2


def is_finished(directory):
    """Whether a run came to its end: until then summary.json is of its last checkpoint, and says so."""
    path = pathlib.Path(directory) / "summary.json"
    return path.exists() and json.loads(path.read_text())["exit_reason"] in ("time_end", "steps")


class Run:
    """A finished or unfinished run; what has not been written yet is empty or None. FileNotFoundError if there is none;
    print(run) says what is there.

    options    {name: value} as resolved
    summary    summary.json
    series     numpy record array, one entry per line of series.csv, fields named by its header
    bodies     arrays of bodies.h5: time (nt), id, species (nb), centroid (nt, nb, 3), ...
    probes     probes.csv likewise; profile["x"], ["y"], ["z"] profile_x.csv, ...: those that are there
    snapshots  list of Snapshot in the order of time
    """

    def __init__(self, directory):
        self.directory = pathlib.Path(directory)
        if not (self.directory / "options.txt").exists():
            raise FileNotFoundError(f"{directory}: no run here (options.txt is missing)")
        self.options = read_options(self.directory / "options.txt")
        self.summary = self._if_there("summary.json", lambda path: json.loads(path.read_text()), {})
        self.series = self._if_there("series.csv", read_series, None)
        self.probes = self._if_there("probes.csv", read_series, None)
        self.profile = {d: read_series(self.directory / f"profile_{d}.csv") for d in "xyz"
                        if (self.directory / f"profile_{d}.csv").exists()}
        self.bodies = self._if_there("bodies.h5", read_bodies, None)
        self.snapshots = sorted((Snapshot(p, self) for p in self.directory.glob("snapshot_*.h5")), key=lambda s: s.time)

    def _if_there(self, name, read, otherwise):
        path = self.directory / name
        return read(path) if path.exists() else otherwise

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
        """periodic, wall or symmetry."""
        name = "boundary_" + "xyz"[d]
        both, own, other = (self.options.get(name + end, "same") for end in ("", *("min", "max")[::1 - 2 * high]))
        both = "periodic" if both == "same" else both
        if self.cells[d] == 1 or (both == "periodic" and "same" in (own, other)):
            return "periodic"
        return both if own == "same" else own

    def is_bounded(self, d):
        return self.side(d, 0) != "periodic"

    def centres(self, d):
        """Coordinates of the cell centres along direction d."""
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


def read_series(path):
    return numpy.atleast_1d(numpy.genfromtxt(path, delimiter=",", names=True, deletechars="")).view(numpy.recarray)


def read_bodies(path):
    with h5py.File(path) as file:
        arrays = {name: item[...] for name, item in file.items()}
    arrays["species"] = numpy.array([s.decode() if isinstance(s, bytes) else s for s in arrays["species"]])
    return types.SimpleNamespace(**arrays)
