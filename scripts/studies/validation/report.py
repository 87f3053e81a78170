"""Judges the runs of the cases: the rows, docs/validation.md, the pages of docs/validation/ and one plot per name."""
import csv
import math
import re
import textwrap

import numpy
from eulastic import figure_style as style

from .notes import NOTES

HEADER = ["case", "measure", "method, solver", "at", "reference", "ours", "error", "tolerance", "tolerance from",
          "errors, coarse to fine (order)", "verdict"]
WORDS = {True: "pass", False: "**FAIL**", None: "reported", "misses": "misses, as documented"}


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
        verdict, asked, why = bool(order >= least), f"at least {least}", "second order, measured on two grids"
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


def table(rows):
    lines = ["| " + " | ".join(HEADER) + " |", "|" + "---|" * len(HEADER)]
    return "\n".join(lines + ["| " + " | ".join(row[c].replace("|", "\\|") for c in HEADER) + " |" for row in rows])


def draw_reference(axis, reference, label):
    """Exact solutions and limits as a broad line; the few points of a published table, with their errors if it has them, as marks."""
    x, y, *errors = (numpy.asarray(part, dtype=float) for part in reference)
    if errors:
        axis.errorbar(x, y, errors[0] if numpy.any(errors[0]) else None, label=label, capsize=3, elinewidth=1, **style.TABLE)
    elif 2 < len(x) < 20 or len(x) == 1:
        axis.plot(x, y, label=label, **style.TABLE)
    else:
        axis.plot(x, y, label=label, **style.EXACT)


def same_curve(one, other):
    """Whether two references are one: the same values where both are known."""
    (x, y, *_), (a, b, *_) = one, other
    if numpy.any(numpy.diff(x) <= 0) or numpy.any(numpy.diff(a) <= 0):
        return numpy.shape(x) == numpy.shape(a) and numpy.allclose(y, b, equal_nan=True)
    return numpy.allclose(numpy.interp(a, x, y), b, atol=0.01 * numpy.ptp(b) + 1e-12)


def draw_case(axis, case, results):
    """The finest run of every setting over the references: one, unless they differ from setting to setting."""
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
    """Handles and labels, each label once, the reference last."""
    entries = dict(zip(*reversed(axis.get_legend_handles_labels())))
    labels = sorted(entries, key=lambda label: label == "reference")
    return {"handles": [entries[label] for label in labels], "labels": labels}


def one_legend_will_do(axes):
    """Whether no two labels of these axes look alike."""
    looks = {}
    for axis in axes:
        for line in axis.lines:
            looks.setdefault((line.get_color(), line.get_linestyle(), line.get_marker()), set()).add(line.get_label())
    return all(len(labels) == 1 for labels in looks.values())


def draw(cases, results, path):
    """All cases of one name side by side."""
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


PAGE = """# Validation

Written by `scripts/validate`; do not edit. This page is for readers who want to know how accurate the program is: it
compares results with exact solutions and published references. The script runs every case below from the files of
options/ and exits with 1 if a row fails. Finished runs are kept in build/validation, and an interrupted run is continued.
A row that misses its tolerance for a known reason has another bound, "kept", and fails beyond that.

    scripts/validate              # all cases: hours
    scripts/validate --quick      # a short form of every reference, part of scripts/test --full
    scripts/validate --only S6
    scripts/validate --only S6 --update       # also writes its rows into these pages

The table below has one row for each case. The pages of the families have all measures with their references, errors and
tolerances, the known misses and limits, and the pictures:

{families}

[validation/rows.csv](validation/rows.csv) has all rows as one table. The cases, with their options, formulas and
sources, are in scripts/studies/validation.

{counts}

{made}{summary}
"""

FAMILY = """# Validation: {title}

Written by `scripts/validate`; do not edit. This page has all measures of the family; [validation.md](../validation.md)
describes the script and has the summary of all cases.

"at" is the finest grid: cells in a direction; in S8 cells per radius and the size of the box in radii. The errors on
coarser grids precede that of the finest one, with the observed order. Errors in % are relative. A tolerance follows from
theory (the formula is given; "twice" is a factor for neglected terms), from the error of the reference, or it is "asked
for", that is, set without a theory. A tolerance that depends on the grid is that of the grid in the row. Rows without a
tolerance are reported, not judged: results of the classic method for comparison with the fast one.

In the pictures a broad grey line is an exact solution or a known limit, and circles are published values, with their errors
where these are published. The other lines are the finest run of each method and pressure solver; the number behind them is "at".

{table}

## Known misses and limits

{notes}
{plots}"""

# Page below validation/: (title, whether a case belongs to it).
FAMILIES = {
    "flow": ("flow without bodies", lambda name: name.startswith("F")),
    "solids": ("elastic solids", lambda name: name[0] in "RL" or name[0] == "S" and int(name[1:]) <= 12),
    "membranes": ("viscosity contrast, drops and membranes", lambda name: name.startswith("V")),
    "vessels": ("rigid bodies, vessels, inlets and outlets", lambda name: name[0] == "S" and int(name[1:]) > 12),
}


OF_CASES = re.compile(r"^- ([A-Z]+\d+(?:, [A-Z]+\d+)*): (Made with .*)$", re.M)


def rows_file(page):
    return page.parent / "validation/rows.csv"


def rows_of(page):
    """The rows that write_page() has written beside the path `page`."""
    with rows_file(page).open(newline="") as file:
        return list(csv.DictReader(file))


def updated(page, rows, made, order):
    """Returns the rows of the path `page` with those of the cases in `rows` in place of theirs, and {case: with what it was made}
    for all that were updated; `order`: names of all cases."""
    new = {row["case"] for row in rows}
    whole = [row for row in rows_of(page) if row["case"] not in new] + rows
    known = {name: text for names, text in OF_CASES.findall(page.read_text()) for name in names.split(", ")}
    since = {**known, **{name: made for name in new}}
    return sorted(whole, key=lambda row: order.index(row["case"])), {name: since[name] for name in order if name in since}


def summary(rows, titles):
    """One row per case: how many of its measures passed, missed as documented, failed, or are reported."""
    lines = ["| case | what | passed | missed as documented | failed | reported | page |", "|---|---|---|---|---|---|---|"]
    for name in dict.fromkeys(row["case"] for row in rows):
        verdicts = [row["verdict"] for row in rows if row["case"] == name]
        numbers = " | ".join(str(verdicts.count(WORDS[word]) or "") for word in (True, "misses", False, None))
        page = next(page for page, (_, belongs) in FAMILIES.items() if belongs(name))
        kinds = titles.get(name, "").split("; ")
        what = "; ".join(kinds) if len(kinds) < 3 else f"{kinds[0]}; {len(kinds) - 1} more"
        lines.append(f"| {name} | {what} | {numbers} | [{page}](validation/{page}.md) |")
    return "\n".join(lines)


def write_family(rows, titles, pictures, page, path):
    title, belongs = FAMILIES[page]
    plots = "".join(f"\n![{titles[name]}](../images/{picture.name})\n\n*{name}: {titles[name]}*\n"
                    for name, picture in pictures.items() if belongs(name))
    notes = "\n".join(f"- {name}: {text}" for name, text in NOTES.items() if name in titles and belongs(name)) or "None."
    path.write_text(FAMILY.format(title=title, table=table([row for row in rows if belongs(row["case"])]), notes=notes, plots=plots))


def write_page(rows, titles, pictures, path, made=None):
    """The summary in `path`, a page for each family that has rows, and rows.csv, in the folder validation/ beside it.
    `made`: {case: with what}, of those not made with the page."""
    rows_file(path).parent.mkdir(parents=True, exist_ok=True)
    with rows_file(path).open("w", newline="") as file:
        writer = csv.DictWriter(file, HEADER, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    counts = ", ".join(f"{sum(row['verdict'] == word for row in rows)} {name}" for word, name in
                       ((WORDS[True], "passed"), (WORDS["misses"], "missed as documented"), (WORDS[False], "failed"),
                        (WORDS[None], "reported")))
    cases = {}
    for name, text in (made or {}).items():
        cases.setdefault(text, []).append(name)
    since = "".join(f"- {', '.join(names)}: {text}\n" for text, names in cases.items())
    since = f"The rows of these cases are newer than the others:\n\n{since}\n" if since else ""
    shown = [page for page, (_, belongs) in FAMILIES.items() if any(belongs(row["case"]) for row in rows)]
    for page in shown:
        write_family(rows, titles, pictures, page, rows_file(path).with_name(f"{page}.md"))
    families = "\n".join(f"- [{FAMILIES[page][0]}](validation/{page}.md)" for page in shown)
    path.write_text(PAGE.format(families=families, counts=counts + ".", made=since, summary=summary(rows, titles)))
