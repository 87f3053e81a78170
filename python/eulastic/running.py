"""Starts one or many runs by scripts/run. Finished runs are not repeated; interrupted runs are continued."""
import collections.abc
import concurrent.futures
import decimal
import itertools
import numbers
import os
import pathlib
import signal
import subprocess
import threading

import numpy

from .reading import Run

SCRIPT = pathlib.Path(__file__).parent / "shell/run"
SCALARS = int, float, str, bool, type(None)


class RunError(RuntimeError):
    """A run did not reach its end. The text is the program's message; exit_code is that of the program (docs/reliability.md),
    directory that of the run; table contains the successful rows of a sweep."""

    def __init__(self, text, exit_code=None, directory=None, table=None):
        super().__init__(text)
        self.exit_code, self.directory, self.table = exit_code, directory, table


def option_value(value):
    """Returns the text of a value for the program: True is true, numbers keep all digits, sequences and arrays are joined by commas,
    sequences of sequences (points) by colons; strings and paths are unchanged. TypeError for anything else."""
    if isinstance(value, (numpy.generic, numpy.ndarray)):
        value = value.tolist()
    if isinstance(value, (str, os.PathLike, bytes)):
        return os.fsdecode(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, decimal.Decimal)):
        return str(value)
    if isinstance(value, numbers.Real):
        return repr(float(value)).removesuffix(".0")
    if not isinstance(value, collections.abc.Iterable) or isinstance(value, (collections.abc.Set, collections.abc.Mapping)):
        raise TypeError(f"{value!r} of type {type(value).__name__} is no value of an option; accepted: numbers, texts, paths, True, "
                        "False, None, and sequences of them")
    items = list(value)
    nested = any(isinstance(one, collections.abc.Iterable) and not isinstance(one, (str, bytes)) for one in items)
    return (":" if nested else ",").join(option_value(one) for one in items)


def option_words(options):
    """Returns {name: text} without options that are None. TypeError names the option."""
    words = {}
    for name, value in options.items():
        try:
            if value is not None:
                words[name] = option_value(value)
        except TypeError as error:
            raise TypeError(f"{name}: {error}") from None
    return words


def stop(process):
    """Asks a run and its processes to end; the program then writes a checkpoint."""
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGTERM)


def launch(case, directory, ranks, options, say, replace=False, started=lambda process: None):
    """Runs the program to its end and returns the Run. Options are strings, and `say` is called with each line of output."""
    words = [word for name, text in options.items() for word in (f"-{name}", text)]
    command = ["bash", SCRIPT, "--ranks", str(ranks), *(["--replace"] if replace else []), case, directory, *words]
    # A session of its own: an interrupt is for Python, which then stops the program with all that belongs to it.
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                               start_new_session=True)
    started(process)
    lines = []
    try:
        for line in process.stdout:
            lines.append(line.rstrip())
            say(line.rstrip())
        process.wait()
    finally:
        stop(process)
        process.stdout.read()  # to its end: the program may write a checkpoint after the shell that started it is gone
        process.wait()
        process.stdout.close()
    if process.returncode:
        told = [line for line in lines if line.startswith("eulastic: error: ")] or lines[-1:] or ["the program ended without a message"]
        raise RunError(told[0].removeprefix("eulastic: error: "), process.returncode, directory)
    return Run(directory)


def run(case, output_dir=None, ranks=2, progress=True, replace=False, **options):
    """Runs a case, which is a file or the name of a case of options/, and returns its Run.

    output_dir  directory of the results, by default output/CASE
    progress    whether to print the program's lines (percentage, time left), or a function that is called with each
    replace     whether to replace an existing run; otherwise a run with other options or a later end raises RunError
    options     options of the program without the dash: rbc_shear_modulus=0.05, body_force=(1e-3, 0, 0),
                probe_points=[(0, 1, 2), (3, 4, 5)]; None: not given

    RunError contains the program's message. A finished run with the same options is only read; an interrupted run is
    continued.
    """
    directory = output_dir or pathlib.Path("output") / pathlib.Path(case).stem
    say = progress if callable(progress) else print if progress else lambda _: None
    return launch(case, directory, ranks, option_words(options), say, replace)


def sweep(case, grid, jobs=1, output_dir=None, ranks=1, progress=True, replace=False, **options):
    """Runs a case with every combination of the options in `grid`, {option: values}, `jobs` at a time.

    Returns a numpy record array with one row per run, in the order of the grid: the swept options, the numbers and strings of
    summary.json, and `run`, the Run. The directories are output_dir/OPTION=VALUE+..., by default in output/CASE_sweep; finished
    runs are not repeated. If runs fail, the others continue to their end, and RunError lists the messages; its `table` has the
    rows of the others. `progress` prints a line when a run has ended; `ranks` is the number for each run; `options` and
    `replace` apply to all runs, as in run().
    """
    folder = pathlib.Path(output_dir or pathlib.Path("output") / f"{pathlib.Path(case).stem}_sweep")
    points = [dict(zip(grid, values)) for values in itertools.product(*grid.values())]
    words, common = [option_words(point) for point in points], option_words(options)
    names = ["+".join(f"{name}={texts.get(name)}" for name in grid).replace("/", "_") for texts in words]
    if len(set(names)) < len(names) or not points:
        raise ValueError("sweep: grid: every option needs one value or more, none of them twice")
    lock, ended, processes = threading.Lock(), [], []

    def one(texts, name):
        try:
            result = launch(case, folder / name, ranks, {**common, **texts}, lambda _: None, replace,
                            processes.append)
        except RunError as error:
            result = error
        with lock:
            ended.append(name)
            if progress:
                print(f"sweep: {len(ended)} of {len(points)}: {name}: {outcome(result)}", flush=True)
        return result

    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        futures = [pool.submit(one, *job) for job in zip(words, names)]
        try:
            results = [future.result() for future in futures]
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            for process in processes:
                stop(process)
            raise
    points = [{name: plain(value, texts.get(name)) for name, value in point.items()} for point, texts in zip(points, words)]
    rows = [(point, result) for point, result in zip(points, results) if isinstance(result, Run)]
    table = table_of(list(grid), rows) if rows else None
    failed = [f"{name}: {result}" for name, result in zip(names, results) if isinstance(result, RunError)]
    if failed:
        raise RunError("\n".join(failed), directory=folder, table=table)
    return table


def plain(value, text):
    """Returns the value if a column of a table can hold it, otherwise its text."""
    value = value.item() if isinstance(value, numpy.generic) else value
    return value if isinstance(value, SCALARS) else text


def outcome(result):
    if isinstance(result, RunError):
        return str(result)
    return f"{result.summary['steps']} steps, {result.summary['wall_seconds_total']:.3g} s"


def table_of(swept, rows):
    """Returns a record array whose columns have one type each: numbers (null becomes nan), strings, or objects for the runs."""
    columns = {name: [point[name] for point, _ in rows] for name in swept}
    for name in rows[0][1].summary:
        values = [result.summary.get(name) for _, result in rows]
        if name not in columns and all(isinstance(value, SCALARS) for value in values):
            columns[name] = [numpy.nan if value is None else value for value in values]
    arrays = {name: numpy.array(values) for name, values in columns.items()}
    table = numpy.recarray(len(rows), [*((name, array.dtype) for name, array in arrays.items()), ("run", object)])
    for name, array in arrays.items():
        table[name] = array
    for row, (_, result) in enumerate(rows):
        table["run"][row] = result
    return table
