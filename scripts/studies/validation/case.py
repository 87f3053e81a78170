"""The data of a case of the validation; runner.py runs cases, and report.py judges them."""
import dataclasses
import pathlib
from typing import Callable, Optional

import numpy
from eulastic import over_time

ROOT = pathlib.Path(__file__).resolve().parents[3]


@dataclasses.dataclass(frozen=True)
class Setting:
    """One method and pressure solver, run for every key, coarse to fine: cells, or a name or tuple of the case's own."""
    method: str
    solver: str
    keys: tuple
    options: dict = dataclasses.field(default_factory=dict)  # of this setting only

    @property
    def label(self):
        return f"{self.method}, {self.solver.upper()}"


@dataclasses.dataclass(frozen=True)
class Measure:
    """ours: number from a run, or from all runs of a setting, {key: run}, if `whole`. reference 0: ours is an error.
    tolerance: {method, or label: number, or function of the key}; a method that is not in it is reported, not judged.
    order: {method: least observed order}, between the two finest runs.
    misses: as tolerance, {...: (bound, why)}: a tolerance that is known to be missed, and the bound that is kept instead.
    order_misses: {method: (least, why)}, the same of an order."""
    what: str
    ours: Callable
    tolerance: dict
    why: str
    reference: float = 0
    relative: bool = False
    order: dict = dataclasses.field(default_factory=dict)
    whole: bool = False
    misses: dict = dataclasses.field(default_factory=dict)
    order_misses: dict = dataclasses.field(default_factory=dict)


@dataclasses.dataclass(frozen=True, eq=False)
class Case:
    """options: function of a key, and of a function that gives the directory of an earlier key, to {option: value}.
    start: function of a key to the {dataset: array} of its -initial_state (docs/outputs.md), for starts that options cannot say.
    curve: function of a run, or of all runs of a setting, {key: run}, if `whole_curve`, to ((x, y), reference) for the plot, with
    the labels of its axes, and `scales`, what matplotlib sets of these. The reference: (x, y), (x, y, errors of y) or None."""
    name: str
    title: str
    file: str
    options: Callable
    full: tuple
    quick: tuple
    measures: tuple
    curve: Callable
    axes: tuple
    quick_measures: Optional[tuple] = None
    quick_options: dict = dataclasses.field(default_factory=dict)
    start: Optional[Callable] = None
    whole_curve: bool = False
    scales: dict = dataclasses.field(default_factory=dict)


def every(keys, classic=None, methods=("fast", "classic"), solvers=("acm", "smac"), **options):
    """Settings of all methods and solvers; classic may have keys of its own."""
    return tuple(Setting(m, s, classic if m == "classic" and classic else keys, options) for m in methods for s in solvers)


def square(n, length=1):
    return {"grid_cells": f"{n},{n},1", "grid_length": f"{length},{length},1"}


def column(n):
    """Options of four columns of n cells in height 1, for flows that depend on y only."""
    return {"grid_cells": f"4,{n},1", "grid_length": f"{4 / n},1,1"}


def reference(name):
    """Reads tests/reference/NAME.csv as an array; lines with # name the source."""
    path = ROOT / "tests/reference" / f"{name}.csv"
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    return numpy.array([[float(x) for x in line.split(",")] for line in lines[1:]])


def at_times(table, column_name, times):
    """Interpolates a column of series.csv, or of a body, linearly to these times."""
    return numpy.interp(times, table.time, getattr(table, column_name))


def profile_times(profile):
    """Reads a profile file. Returns times (nt), coordinates (n), u and v (nt, n)."""
    if len(profile) == 0:
        raise ValueError("no profile")
    arrays = over_time(profile)
    place = next(getattr(arrays, d) for d in "xyz" if hasattr(arrays, d))
    return arrays.time, place, arrays.velocity_x, arrays.velocity_y


def rms(x):
    return float(numpy.sqrt(numpy.mean(numpy.square(x))))
