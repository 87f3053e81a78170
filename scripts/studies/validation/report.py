"""Judges the runs of the cases: the rows of the tables, and one plot per name. pages.py writes the pages."""
import io
import math

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from PIL import Image  # noqa: E402  (matplotlib's own)

from .pages import HEADER, WORDS, rows_of, updated, write_page  # noqa: E402,F401


def name_of(key):
    return "/".join(map(str, key)) if isinstance(key, tuple) else str(key)


def failed(case, setting, text):
    return dict(zip(HEADER, [case.name, text.replace("|", "/"), setting.label, "", "", "", "", "", "", "", WORDS[False]]))


def judge(case, setting, runs, measure):
    """Rows of one measure: the value at the finest key and, if asked for, the order."""
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
    shown = " ".join(f"{e:.2g}" for _, e in ladder) + (f" ({order:.2f})" if order is not None else "")
    percent = (lambda e: f"{100 * e:.2g} %") if measure.relative else (lambda e: f"{e:.2g}")
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
    """Of the two finest grids; None where keys are not cells."""
    if len(ladder) < 2 or not all(isinstance(k, int) for k, _ in ladder):
        return None
    (n, e), (m, f) = ladder[-2:]
    return math.log(e / f) / math.log(m / n) if e > 0 and f > 0 else math.nan


def draw(cases, results, path):
    """All cases of one name side by side: the finest run of every setting over the reference."""
    cases = cases[:6]
    columns = min(3, len(cases))
    lines = -(-len(cases) // columns)
    figure, axes = plt.subplots(lines, columns, figsize=(3.6 * columns, 2.8 * lines), squeeze=False)
    for axis in axes.flat[len(cases):]:
        axis.set_visible(False)
    styles = {"fast, ACM": "C3-", "fast, SMAC": "C1--", "classic, ACM": "C0-.", "classic, SMAC": "C9:"}
    for axis, case in zip(axes.flat, cases):
        reference = None
        for setting, runs in results[case]:
            key = list(runs)[-1]
            mine, reference = case.curve(runs if case.whole_curve else runs[key])
            at = "" if case.whole_curve else f", {name_of(key)}"
            axis.plot(*mine, styles[setting.label], lw=1, label=setting.label + at)
        if reference is not None:
            axis.plot(*reference, "ko" if len(reference[0]) < 20 else "k-", ms=3, lw=3, alpha=.25, label="reference", zorder=0)
        axis.set(xlabel=case.axes[0], ylabel=case.axes[1])
        axis.legend(fontsize=6)
    figure.suptitle(cases[0].name, fontsize=9)
    figure.tight_layout()
    picture = io.BytesIO()
    figure.savefig(picture, dpi=80)
    plt.close(figure)
    path.parent.mkdir(parents=True, exist_ok=True)
    Image.open(picture).convert("RGB").quantize(24).save(path, optimize=True)  # a few kB
