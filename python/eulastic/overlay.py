"""Curves of several runs in one picture."""
from .reading import Run

SIDE_ISSUES = "output_dir", "output_overwrite", "restart", "threads", "check_only", "print_options"


def differing_options(runs):
    """Returns for each run {option: value} of those options whose values are not equal in all runs."""
    names = dict.fromkeys(name for run in runs for name in run.options if name not in SIDE_ISSUES)
    differ = [name for name in names if len({run.options.get(name) for run in runs}) > 1]
    return [{name: run.options[name] for name in differ if name in run.options} for run in runs]


def labels_of(runs):
    """Returns for each run the options in which it differs from others, at most three, or the name of its directory."""
    return [", ".join(f"{name} {value}" for name, value in options.items()) if 0 < len(options) <= 3 else run.directory.name
            for run, options in zip(runs, differing_options(runs))]


def overlay(runs, quantity, axis=None, labels=None, **style):
    """Draws a curve for every run, Run or directory, and returns matplotlib's axis.

    quantity  a column of series.csv, or a function that returns (x, y) of a run
    labels    by default the options in which the runs differ
    style     of the curves, as matplotlib's plot takes it
    """
    runs = [run if isinstance(run, Run) else Run(run) for run in runs]
    if not runs:
        raise ValueError("overlay: no runs")
    if axis is None:
        import matplotlib.pyplot
        axis = matplotlib.pyplot.subplots()[1]
    if labels is None:
        labels = labels_of(runs)
    for run, label in zip(runs, labels):
        if not callable(quantity) and quantity not in run.series.dtype.names:
            raise KeyError(f"{quantity}; accepted: {', '.join(run.series.dtype.names)}")
        x, y = quantity(run) if callable(quantity) else (run.series.time, run.series[quantity])
        axis.plot(x, y, label=label, **style)
    if not callable(quantity):
        axis.set(xlabel="time", ylabel=quantity.replace("_", " "))
    axis.legend()
    return axis
