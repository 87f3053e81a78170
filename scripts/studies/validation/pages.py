"""Writes docs/validation.md, the pages of docs/validation/ and rows.csv from the rows that report.py judges."""
import csv
import re

from .notes import NOTES
from .subjects import SUBJECTS, TITLES

HEADER = ["case", "measure", "method, solver", "at", "reference", "ours", "error", "tolerance", "tolerance from",
          "errors, coarse to fine (order)", "verdict"]
WORDS = {True: "pass", False: "**FAIL**", None: "reported", "misses": "misses, as documented"}

PAGE = """# Validation

Written by `scripts/validate`; do not edit. This page is for readers who want to know how accurate the program is: it
compares results with exact solutions and published references. The script runs every case below from the files of
options/ and exits with 1 if a row fails. Finished runs are kept in build/validation, and an interrupted run is continued.
A row that misses its tolerance for a known reason has a second, wider bound, and fails beyond that.

    scripts/validate              # all cases: hours
    scripts/validate --quick      # a short form of every reference, part of scripts/test --full
    scripts/validate --only S6
    scripts/validate --only S6 --update       # also writes its rows into these pages

The table below has one row for each case. Each case has a section on the page of its family, with what is solved, the
reference, a picture, notes, and all measures:

{families}

[validation/rows.csv](validation/rows.csv) has all rows as one table. The cases, with their options, formulas and
sources, are in scripts/studies/validation.

{counts}

{summary}
{made}"""

FAMILY = """# Validation: {title}

This page is for readers who want to judge the accuracy of the program for {title}: each case is compared with an exact solution or
a published reference. Written by `scripts/validate`; do not edit. [validation.md](../validation.md) describes the script and
summarises all cases.

{contents}

**Columns of the tables.** "at" is the finest grid: cells in one direction{at}.
Errors on coarser grids precede that of the finest one, with the observed order in brackets. Errors in % are relative. A tolerance follows from theory, from the error of the reference, or is a
goal that was set without a theory; the letter refers to the list below the table. A tolerance that depends on the grid is that of the
grid in the row. Where a row misses its tolerance for a known reason, "kept" is the bound beyond which it fails. Rows without a
tolerance are reported, not judged; most of them are results of the classic method, for comparison with the fast one.

In the pictures a broad grey line is an exact solution, a known limit, or what the axis names; circles are published values, with
their errors where these are published. The other lines are the finest run of each method and pressure solver; the number behind them is "at".
{sections}"""

# Page below validation/: (title, whether a case belongs to it, what "at" is in some of its cases).
FAMILIES = {
    "flow": ("flow without bodies", lambda name: name.startswith("F"), ""),
    "solids": ("elastic solids", lambda name: name[0] in "RL" or name[0] == "S" and int(name[1:]) <= 12,
               "; in S8 cells per radius / size of the box in radii; in L1, L2, L3 and the long run of S6 cells per radius"),
    "membranes": ("viscosity contrast, drops and membranes", lambda name: name.startswith("V"),
                  "; from V2 on cells per radius, in pairs with the size of the box in radii; in V6 the forces in pN"),
    "vessels": ("rigid bodies, vessels, inlets and outlets", lambda name: name[0] == "S" and int(name[1:]) > 12,
                "; in S13 cells per radius; in S14, S17 and S18 cells across the lumen; in S19 cells per 14 um; in S16, S20 and S22 cells per diameter"),
}
OF_CASES = re.compile(r"^- ([A-Z]+\d+(?:, [A-Z]+\d+)*): (Made with .*)$", re.M)


def belongs(page, name):
    return FAMILIES[page][1](name)


def rows_file(page):
    return page.parent / "validation/rows.csv"


def rows_of(page):
    """Returns the rows that write_page() has written beside the page `path`."""
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


def by_family(rows):
    """Returns the names of the cases in the order of families and numbers."""
    names = {row["case"] for row in rows}
    return [name for page in FAMILIES
            for name in sorted((name for name in names if belongs(page, name)), key=lambda name: ("FSRLV".index(name[0]), int(name[1:])))]


def summary(rows, titles):
    """Returns one row per case: how many of its measures passed, missed as documented, failed, or are reported."""
    lines = ["| case | what | passed | missed as documented | failed | reported | page |", "|---|---|---|---|---|---|---|"]
    for name in by_family(rows):
        verdicts = [row["verdict"] for row in rows if row["case"] == name]
        numbers = " | ".join(str(verdicts.count(WORDS[word]) or "") for word in (True, "misses", False, None))
        page = next(page for page in FAMILIES if belongs(page, name))
        lines.append(f"| {name} | {TITLES.get(name, titles.get(name, ''))} | {numbers} | [{page}](validation/{page}.md#{name.lower()}) |")
    return "\n".join(lines)


def table(rows):
    """Returns the rows of one case, with letters for the reasons of tolerances, which a list below the table explains."""
    reasons = list(dict.fromkeys(row["tolerance from"] for row in rows if row["tolerance from"]))
    letters = {reason: chr(ord("a") + n) for n, reason in enumerate(reasons)}
    shown = [column for column in HEADER if column != "tolerance from"]
    lines = ["| " + " | ".join(shown) + " |", "|" + "---|" * len(shown)]
    for row in rows:
        letter = f" ({letters[row['tolerance from']]})" if row["tolerance from"] else ""
        cells = {**row, "tolerance": (row["tolerance"] + letter).strip()}
        lines.append("| " + " | ".join(cells[c].replace("|", "\\|") for c in shown) + " |")
    text = "\n".join(lines)
    if reasons:
        shown = {reason: re.sub("^goal(?=$|;)", "goal, set without a theory", reason) for reason in reasons}
        text += "\n\n*Tolerances:*\n\n" + "\n".join(
            f"- ({letter}) {shown[reason].replace('; kept: ', '. Some rows miss this because ')}." for reason, letter in letters.items())
    return text


def section(name, rows, title, picture):
    """Returns the section of one case: the problem, the reference, the picture, notes and the table. The heading is the name of the
    case, so that links to it stay short."""
    solved, reference = SUBJECTS.get(name, ("", ""))
    title = TITLES.get(name, title)
    parts = [f"## {name}", f"**{title}.** {solved}", f"**Reference.** {reference}"]
    if picture:
        parts.append(f"![{name}: {title}](../images/{picture.name})")
    if name in NOTES:
        parts.append("\n".join(f"- {note}" for note in NOTES[name]))
    return "\n\n".join([*parts, table(rows)]) + "\n"


def write_family(rows, titles, pictures, page, path):
    title, _, at = FAMILIES[page]
    names = [name for name in by_family(rows) if belongs(page, name)]
    contents = "\n".join(f"- [{name}](#{name.lower()}): {TITLES.get(name, titles.get(name, ''))}" for name in names)
    sections = "\n".join(section(name, [row for row in rows if row["case"] == name], titles.get(name, name), pictures.get(name))
                         for name in names)
    path.write_text(FAMILY.format(title=title, contents=contents, at=at, sections="\n" + sections))


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
    since = f"\nThe rows of these cases are newer than the others:\n\n{since}" if since else ""
    shown = [page for page in FAMILIES if any(belongs(page, row["case"]) for row in rows)]
    for page in shown:
        write_family(rows, titles, pictures, page, rows_file(path).with_name(f"{page}.md"))
    families = "\n".join(f"- [{FAMILIES[page][0]}](validation/{page}.md)" for page in shown)
    path.write_text(PAGE.format(families=families, counts=counts + ".", made=since, summary=summary(rows, titles)))
