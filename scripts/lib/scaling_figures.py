"""Runs, tables, models and pictures that paper_figure5 and paper_figure6 of scripts/studies/paper share.

    main(Figure("paper_figure5", ...), __doc__)
"""
import argparse
import csv
import dataclasses
import json
import math
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

from communication_counts import Counts, library, program
from performance_runs import ENVIRONMENT, ROOT, on_ranks
from scaling_model import ASSUMPTIONS, CASE, Machine, Split, Step, model

sys.path.insert(0, str(ROOT / "scripts"))
from eulastic.figure_style import BLUE, VERMILLION, panels  # noqa: E402

METHODS = "fast", "classic"
MEASURED = {"fast": (BLUE, "o-"), "classic": (VERMILLION, "s-")}
MODELLED = [("0.5", (0, (6, 2))), ("0.5", (0, (2, 2))), ("0.7", (0, (6, 2))), ("0.7", (0, (2, 2)))]  # grey, dashed
PITCH = 10.56, 5.28, 10.56  # of the bodies in CASE
SPACING = 21.12 / 64        # of the cells there
COLUMNS = "method", "ranks", "split", "cells", "seconds_per_step", "exchange", "wait", "reductions"


@dataclasses.dataclass
class Figure:
    name: str
    title: str
    box: tuple      # weak: cells of a rank; else None
    cells: tuple    # strong: of all
    modelled: list  # ranks along x, y, z (weak), or ranks
    quantity: object  # {ranks: seconds}, ranks: what is drawn
    label: str

    def cells_on(self, along):
        return tuple(n * p for n, p in zip(self.box, along)) if self.box else self.cells


def along(ranks, box=None):
    """Returns the split of the ranks for weak scaling: as cubic as their number and whole blocks of 256 cells along x allow."""
    whole = box is None or box[0] % 256 == 0
    splits = [(x, y, ranks // x // y) for x in range(1, ranks + 1) if ranks % x == 0 and (whole or x == 1)
              for y in range(1, ranks // x + 1) if ranks // x % y == 0]
    return min(splits, key=lambda split: (max(split) / min(split[0 if whole else 1:]), split))


def case_options(cells, split, method, steps, more):
    """Returns the options of a run with the resolution and the density of bodies of CASE."""
    lengths = [n * SPACING for n in cells]
    counts = [max(1, round(length / pitch)) for length, pitch in zip(lengths, PITCH)]
    words = {"grid_cells": cells, "grid_length": [f"{length:.9g}" for length in lengths], "rbc_count": counts,
             "method": [method], "time_steps_max": [steps], "snapshot_interval": [0]}
    line = [str(CASE)]
    for name, values in words.items():
        line += [f"-{name}", ",".join(map(str, values))]
    if split:
        line += [word for d, p in zip("xyz", split) for word in (f"-da_processors_{d}", str(p))]
    return [*line, *more]


def launch(ranks, command):
    if "SLURM_JOB_ID" in os.environ and "EULASTIC_MPIEXEC" not in os.environ:
        return ["srun", "-n", str(ranks), *map(str, command)]
    return on_ranks(ranks, command)


def events(log):
    """Returns {event: seconds of the slowest rank} of the stage Step in the output of -log_view."""
    stage = re.search(r"--- Event Stage \d+: Step\n(.*?)(\n---|\Z)", log, re.S)
    return {row[0]: float(row[3]) for row in map(str.split, stage[1].splitlines()) if len(row) > 4} if stage else {}


def measure(figure, method, ranks, steps, more):
    """Runs the program. Returns one row of COLUMNS: means over `steps` steps; shares of the step of the slowest rank."""
    split = along(ranks, figure.box) if figure.box else None
    cells = figure.cells_on(split)
    with tempfile.TemporaryDirectory(dir=os.environ.get("SLURM_SUBMIT_DIR")) as folder:
        room = pathlib.Path(folder)
        (room / "counts").mkdir()
        line = launch(ranks, [program(), *case_options(cells, split, method, steps, more), "-output_dir", room / "run",
                              "-log_view"])
        environment = dict(ENVIRONMENT, EULASTIC_COUNT=str(room / "counts"), LD_PRELOAD=str(library()))
        done = subprocess.run(line, capture_output=True, text=True, env=environment)
        if done.returncode:
            sys.exit(f"{shlex.join(line)}\n{done.stdout}{done.stderr}")
        summary = json.loads((room / "run/summary.json").read_text())
        reduced = max(Counts.read(path).seconds for path in (room / "counts").glob("*.csv")) if ranks > 1 else 0
    found, wall = events(done.stdout), summary["wall_seconds"]
    if ranks == 1:
        found = {}
    return {"method": method, "ranks": ranks, "split": "x".join(map(str, split)) if split else "",
            "cells": math.prod(cells), "seconds_per_step": wall / summary["steps"],
            "exchange": found.get("EulExchange", 0) / wall, "wait": found.get("EulWait", 0) / wall,
            "reductions": reduced / wall}


def modelled(figure, machine, method):
    """Returns [(Split, {part: seconds})]."""
    step = Step.read(method)
    rows = []
    for ranks in figure.modelled:
        split = Split.planned(figure.box, ranks) if figure.box else Split.of(figure.cells, ranks)
        rows.append((split, model(machine, step, split)))
    return rows


def describe(machine, method, rows):
    """Yields lines of text."""
    yield f"MODEL, not measured: {machine.name}, {method}; a rank is {machine.rank}; milliseconds of a step"
    names = ["compute", "latency", "exchange", "pack", "reductions", "gather"]
    yield f"{'ranks':>8} {'split':>12} {'largest box':>14} " + " ".join(f"{name:>10}" for name in [*names, "step"])
    for split, parts in rows:
        yield (f"{split.count:>8} {'x'.join(map(str, split.ranks)):>12} {'x'.join(map(str, split.box)):>14} " +
               " ".join(f"{1e3 * parts.get(name, 0):10.3f}" for name in names) + f" {1e3 * sum(parts.values()):10.3f}")


def draw(figure, measured, models, path):
    """Draws measured times as full coloured lines with marks, and modelled ones as dashed grey lines without marks, labelled as
    such."""
    picture, (axes,) = panels(1, height=4.6)
    for method, (colour, mark) in MEASURED.items():
        times = {row["ranks"]: row["seconds_per_step"] for row in measured if row["method"] == method}
        if times:
            axes.plot(list(times), [figure.quantity(times, p) for p in times], mark, color=colour, label=f"measured: {method}")
    for n, (machine, method, rows) in enumerate(models):
        colour, dashes = MODELLED[n % len(MODELLED)]
        times = {split.count: sum(parts.values()) for split, parts in rows}
        axes.plot(list(times), [figure.quantity(times, p) for p in times], color=colour,
                  linestyle=dashes, label=f"model, not measured: {method}, {machine.name}")
    axes.set(xscale="log", xlabel="ranks", ylabel=figure.label, title=f"{figure.title} (model)" if not measured else
             figure.title + (" (dashed: model)" if models else ""))
    if not figure.box:
        axes.set(yscale="log")
    else:
        axes.set(ylim=(0, 1.1))
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncol=2)  # below the axes
    picture.savefig(path, metadata={"Description": "dashed grey lines are modelled, not measured"})


def job_script(figure, arguments):
    most = max(arguments.ranks)
    words = [f"scripts/studies/paper/{figure.name}", "--measure", "--ranks", ",".join(map(str, arguments.ranks)), "--steps",
             arguments.steps, "--output", arguments.output, *arguments.options]
    return (f"#!/bin/bash\n#SBATCH --job-name={figure.name}\n#SBATCH --ntasks={most}\n#SBATCH --cpus-per-task=1\n"
            f"#SBATCH --time=02:00:00\n# module load ...: the compiler, MPI, HDF5 and FFTW of the build\n"
            f"cd {shlex.quote(str(ROOT))}\n{shlex.join(map(str, words))}\n")


def numbers(text):
    values = [int(word) for word in text.split(",")]
    if not values or min(values) < 1:
        raise ValueError
    return values


def main(figure, usage, check=None):
    """Runs a script for `figure`. `check(machine)` returns lines on the deviation of the model from the paper."""
    parser = argparse.ArgumentParser(description=usage, formatter_class=argparse.RawDescriptionHelpFormatter,
                                     allow_abbrev=False)
    cores = int(os.environ.get("SLURM_NTASKS", len(os.sched_getaffinity(0))))
    parser.add_argument("--measure", action="store_true")
    parser.add_argument("--model", action="append", default=[])
    parser.add_argument("--job", type=pathlib.Path)
    parser.add_argument("--ranks", type=numbers, default=[2 ** n for n in range(cores.bit_length())])
    parser.add_argument("--steps", type=int, default=10)
    parser.add_argument("--box" if figure.box else "--cells", dest="size", type=numbers)
    parser.add_argument("--output", type=pathlib.Path, default=pathlib.Path("output") / figure.name)
    arguments, arguments.options = parser.parse_known_args()
    if not (arguments.measure or arguments.model or arguments.job):
        parser.exit(2, f"{figure.name}: nothing to do; accepted: --measure, --model MACHINE, --job FILE\n")
    if arguments.size and len(arguments.size) != 3:
        parser.exit(2, f"{figure.name}: --{'box' if figure.box else 'cells'}: accepted: X,Y,Z, numbers of cells\n")
    machines = [Machine.read(name) for name in arguments.model]
    if arguments.job:
        if arguments.size:
            arguments.options[:0] = [f"--{'box' if figure.box else 'cells'}", ",".join(map(str, arguments.size))]
        arguments.job.write_text(job_script(figure, arguments))
        print(f"{figure.name}: {arguments.job}; start it with sbatch")
    if not (arguments.measure or machines):
        return
    arguments.output.mkdir(parents=True, exist_ok=True)
    models = [(machine, method, modelled(figure, machine, method)) for machine in machines for method in METHODS]
    if machines:
        print("\n".join(["Assumed:", *(f"- {line}" for line in ASSUMPTIONS)]))
    for machine, method, rows in models:
        if method == METHODS[0]:
            print("\n".join(["", *(f"- {line}" for line in machine.sources)]))
        print("\n".join(describe(machine, method, rows)))
    for machine in machines if check else []:
        print("\n".join(check(machine)))
    measured = []
    if arguments.measure:
        size = tuple(arguments.size or ((64, 64, 64) if figure.box else (128, 128, 128)))
        real = dataclasses.replace(figure, **{"box" if figure.box else "cells": size})
        for method in METHODS:
            for ranks in arguments.ranks:
                measured.append(measure(real, method, ranks, arguments.steps, arguments.options))
                print("measured: " + ", ".join(f"{key} {value:.4g}" if isinstance(value, float) else f"{key} {value}"
                                               for key, value in measured[-1].items()), flush=True)
        with open(arguments.output / f"{figure.name}.csv", "w", newline="") as file:
            writer = csv.DictWriter(file, COLUMNS)
            writer.writeheader()
            writer.writerows(measured)
    draw(figure, measured, models, arguments.output / f"{figure.name}.png")
    print(f"{figure.name}: {arguments.output / figure.name}.png")
