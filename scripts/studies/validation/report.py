"""Judges the runs of the cases: the rows of the tables, and one plot per name. pages.py writes the pages."""
import math
import textwrap

import numpy
from eulastic import figure_style as style
from measured import digits

from .pages import HEADER, WORDS, rows_of, updated, write_page  # noqa: F401


def name_of(key):
    return "/".join(map(str, key)) if isinstance(key, tuple) else str(key)


def failed(case, setting, text):
    return dict(zip(HEADER, [case.name, text.replace("|", "/"), setting.label, "", "", "", "", "", "", "", WORDS[False]]))


def judge(case, setting, runs, measure):
    """Returns the rows of one measure: the value at the finest key and, if requested, the order."""
    def error(value):
        return abs(value - measure.reference) / (abs(measure.reference) if measure.relative else 1)

    key = list(runs)[-1]
    if measure.whole:
        ladder, ours, at = [], measure.ours(runs), " ".join(map(name_of, runs))
    else:
        values, at = {k: measure.ours(run) for k, run in runs.items()}, name_of(key)
        ladder, ours = [(k, error(value)) for k, value in values.items()], values[key]
    def of_setting(table):
        return table.get(setting.label, table.get(setting.method))

    limit = of_setting(measure.tolerance)
    limit = limit(key) if callable(limit) else limit
    order = observed_order(ladder)
    shown = " ".join(f"{e:.2g}" for _, e in ladder) + (f" ({order:.2f})" if order is not None and not math.isnan(order) else "")
    percent = (lambda e: f"{digits(100 * e)} %") if measure.relative else (lambda e: f"{e:.2g}")
    verdict = None if limit is None else bool(error(ours) <= limit)  # a nan fails
    shown_limit, why = "" if limit is None else percent(limit), measure.why
    bound, reason = of_setting(measure.misses) or (None, "")
    bound = bound(key) if callable(bound) else bound
    if bound is not None and verdict is False:
        verdict = "misses" if error(ours) <= bound else False
        shown_limit, why = f"{shown_limit}; kept: {percent(bound)}", f"{why}; kept: {reason}"
    rows = [[case.name, measure.what, setting.label, at, f"{measure.reference:.7g}", f"{ours:.6g}",
             percent(error(ours)), shown_limit, why, shown, WORDS[verdict]]]
    least = measure.order.get(setting.method)
    if least is not None and len(ladder) > 1:
        verdict, asked, why = bool(order >= least), f"at least {least}", "expected order 2, measured on the two finest grids"
        kept, reason = measure.order_misses.get(setting.method, (None, ""))
        if kept is not None and not verdict:
            verdict = "misses" if order >= kept else False
            asked, why = f"{asked}; kept: {kept}", f"{why}; kept: {reason}"
        rows.append([case.name, measure.what + ": order", setting.label, name_of(key), "2", f"{order:.2f}", f"{2 - order:.2f}",
                     asked, why, shown, WORDS[verdict]])
    return [dict(zip(HEADER, row)) for row in rows]


def observed_order(ladder):
    """Returns the order between the two finest grids; None where keys are not cells."""
    if len(ladder) < 2 or not all(isinstance(k, int) for k, _ in ladder):
        return None
    (n, e), (m, f) = ladder[-2:]
    return math.log(e / f) / math.log(m / n) if e > 0 and f > 0 else math.nan


def draw_reference(axis, reference, label):
    """Draws exact solutions and limits as a broad line, and the few points of a published table as marks, with error bars if it has
    them."""
    x, y, *errors = (numpy.asarray(part, dtype=float) for part in reference)
    if errors:
        axis.errorbar(x, y, errors[0] if numpy.any(errors[0]) else None, label=label, capsize=3, elinewidth=1, **style.TABLE)
    elif 2 < len(x) < 20 or len(x) == 1:
        axis.plot(x, y, label=label, **style.TABLE)
    else:
        axis.plot(x, y, label=label, **style.EXACT)


def same_curve(one, other):
    """Returns whether two references have the same values where both are known."""
    (x, y, *_), (a, b, *_) = one, other
    if numpy.any(numpy.diff(x) <= 0) or numpy.any(numpy.diff(a) <= 0):
        return numpy.shape(x) == numpy.shape(a) and numpy.allclose(y, b, equal_nan=True)
    return numpy.allclose(numpy.interp(a, x, y), b, atol=0.01 * numpy.ptp(b) + 1e-12)


def draw_case(axis, case, results):
    """Draws the finest run of every setting over the references: a single one, unless they differ between settings."""
    drawn, labels = [], [setting.label for setting, _ in results]
    for n, (setting, runs) in enumerate(results):
        key = list(runs)[-1]
        mine, reference = case.curve(runs if case.whole_curve else runs[key])
        colour, dashes, mark = style.METHODS[setting.label]
        if labels.count(setting.label) > 1:  # grids of one method: a colour each
            free = [c for c in style.COLOURS if c not in {style.METHODS[label][0] for label in labels if label != setting.label}]
            colour, dashes = free[n % len(free)], style.DASHES[n % len(style.DASHES)]
        at = "" if case.whole_curve else f", {name_of(key)}"
        axis.plot(*mine, color=colour, ls=dashes, marker=mark if len(mine[0]) < 10 else "", ms=4, label=setting.label + at)
        if reference is not None and not any(same_curve(known, reference) for known in drawn):
            drawn.append(reference)
            draw_reference(axis, reference, "reference")
    axis.set(xlabel=case.axes[0], ylabel=textwrap.fill(case.axes[1], 30), **case.scales)
    if axis.get_xscale() == "log":
        axis.set_xticks(axis.lines[0].get_xdata(), [f"{x:g}" for x in axis.lines[0].get_xdata()])
        axis.minorticks_off()
    style.least_range(axis)


def legend_entries(axis):
    """Returns handles and labels, each label once, the reference last."""
    entries = dict(zip(*reversed(axis.get_legend_handles_labels())))
    labels = sorted(entries, key=lambda label: label == "reference")
    return {"handles": [entries[label] for label in labels], "labels": labels}


def one_legend_will_do(axes):
    """Returns whether no two labels of these axes look alike."""
    looks = {}
    for axis in axes:
        for line in axis.lines:
            looks.setdefault((line.get_color(), line.get_linestyle(), line.get_marker()), set()).add(line.get_label())
    return all(len(labels) == 1 for labels in looks.values())


def draw(cases, results, path):
    """Draws all cases of one name side by side."""
    columns = 1 if len(cases) == 1 else 2 if len(cases) < 5 else 3
    figure, axes = style.panels(len(cases), columns, height=3.2 if columns < 3 else 2.9)
    for axis, case in zip(axes, cases):
        draw_case(axis, case, results[case])
    if columns == 1:
        style.legend_beside(axes[0], **legend_entries(axes[0]))
    elif one_legend_will_do(axes):
        style.legend_below(figure, axes, columns=5)
    else:
        for axis in axes:
            style.legend_above(axis, columns=2 if columns == 2 else 1, **legend_entries(axis))
    figure.suptitle(cases[0].name, fontsize=9)
    style.save(figure, path, colours=32)
