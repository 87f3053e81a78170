"""Draws the maps and writes the table of scripts/studies/stability/stability_map."""
from eulastic.figure_style import INK, SMALL, VERMILLION, WIDTH, plt, save
from matplotlib.patches import Patch

SHEETS = {"flows": ["cavity", "random", "shear", "extension"],
          "bodies": ["cells", "thin", "contact", "stretched", "flat_cells", "solid", "viscosity"],
          "times": ["time_step", "reversing", "layers", "nothing", "long", "corner"]}
STABLE, REPORTED, FAILED = "#66C2A5", "#F0E442", VERMILLION
# Reason of a failure: the letter on its square.
LETTERS = {"energy": "E", "nonfinite": "N", "guard": "G", "volume": "V", "phi": "P", "det B": "B", "other": "?"}
FORCED = "////"  # hatching of time steps that were forced and may fail


def draw_scene(axis, corner, scene):
    reason = scene.outcome["reason"]
    colour = FAILED if reason else REPORTED if scene.outcome["notes"] else STABLE
    axis.add_patch(plt.Rectangle(corner, 0.95, 0.95, facecolor=colour, edgecolor=INK, hatch=None if scene.automatic else FORCED, lw=0))
    if reason:
        axis.text(corner[0] + 0.475, corner[1] + 0.475, LETTERS.get(reason, LETTERS["other"]), ha="center", va="center", fontsize=SMALL,
                  color="white", fontweight="bold")


def draw_group(axis, group, method, scenes):
    for scene in scenes:
        draw_scene(axis, (group.x.index(scene.x), group.y.index(scene.y)), scene)
    words = isinstance(group.x[0], str)
    axis.set(xlim=(0, len(group.x)), ylim=(0, len(group.y)), xlabel=group.x_label, ylabel=group.y_label)
    axis.grid(False)
    axis.set_xticks([i + 0.5 for i in range(len(group.x))], group.x, rotation=60 if words else 0, ha="right" if words else "center")
    axis.set_yticks([i + 0.5 for i in range(len(group.y))], group.y)
    axis.set_title(f"{group.title}: {method}")


def draw(scenes, directory):
    groups = {s.group.name: s.group for s in scenes}
    for sheet, listed in SHEETS.items():
        names = [n for n in listed if n in groups]
        if not names:
            continue
        height = 2.6 * len(names)
        figure, axes = plt.subplots(len(names), 2, figsize=(WIDTH, height + 0.7), squeeze=False)
        for row, name in zip(axes, names):
            for axis, method in zip(row, ("fast", "classic")):
                draw_group(axis, groups[name], method, [s for s in scenes if s.group.name == name and s.method == method])
        shown = {LETTERS.get(s.outcome["reason"], LETTERS["other"]) for s in scenes if s.group.name in names and s.outcome["reason"]}
        causes = ", ".join(f"{letter} {cause}" for cause, letter in LETTERS.items() if letter in shown)
        entries = [Patch(facecolor=STABLE, label="stable"), Patch(facecolor=REPORTED, label="reported"),
                   Patch(facecolor=FAILED, label="failed" + (f": {causes}" if causes else ""))]
        if any(not s.automatic for s in scenes if s.group.name in names):
            entries.append(Patch(facecolor="white", edgecolor=INK, hatch=FORCED, lw=0, label="step forced, may fail"))
        figure.get_layout_engine().set(rect=(0, 0, 1, 1 - 0.5 / (height + 0.7)))
        figure.legend(handles=entries, ncols=len(entries), loc="upper center")
        save(figure, directory / f"stability_{sheet}.png", colours=32)


def worst(scenes, name, of=max, digits=2):
    values = [s.outcome[name] for s in scenes if not s.outcome["reason"] and s.outcome.get(name) is not None]
    return f"{of(values):.{digits}g}" if values else ""


def table_row(group, method, scenes):
    own = [s for s in scenes if s.group is group and s.method == method and s.automatic]
    stable = [s for s in own if not s.outcome["reason"]]
    det = [d for s in stable for d in s.outcome["det"] or []]
    forgetful = [s.outcome for s in own if s.outcome.get("forgotten")]
    forgot, least = len(forgetful), f"{min(o['stretch'] for o in forgetful):.2g}" if forgetful else ""
    return (f"| {group.title} | {method} | {len(stable)} | {sum(bool(s.outcome['notes']) for s in stable)} | "
            f"{len(own) - len(stable)} | {worst(own, 'energy', digits=3)} | {worst(own, 'phi')} | {worst(own, 'volume')} | "
            + (f"{min(det):.2g} ... {max(det):.2g}" if det else "") + f" | {worst(own, 'stretch')} | {forgot} | {least} |")


def write_table(scenes, path):
    """Writes the table between the two marks in the file: a row per group and method, of the scenes at the automatic time step. Rows
    of groups that are not among `scenes` are kept."""
    before, rest = path.read_text().split("<!-- table -->\n")
    old, after = rest.split("<!-- end of table -->\n")
    groups = {s.group.name: s.group for s in scenes}
    rows = {tuple(line.split(" | ")[:2]): line for line in old.splitlines()[2:] if line.startswith("| ")}
    for group in groups.values():
        for method in ("fast", "classic"):
            if method in group.methods:
                rows["| " + group.title, method] = table_row(group, method, scenes)
            else:
                rows.pop(("| " + group.title, method), None)
    failed = [line for line in old.splitlines() if line.startswith("- ") and line[2:].split(", ")[0] not in groups]
    failed += [f"- {s.name}: {s.outcome['reason']}" for s in scenes if s.automatic and s.outcome["reason"]]
    count = sum(int(row.split(" | ")[column]) for row in rows.values() for column in (2, 4))
    lines = ["| scenes | method | stable | of these yellow | failed | energy | phi outside 0 ... 1 | volume | det B | largest stretch | B unresolved | from stretch |",
             "|---|---|---|---|---|---|---|---|---|---|---|---|", *rows.values(), "",
             f"{count} scenes at the automatic time step (up to 1.2 of it), {len(failed)} failed" + (":" if failed else "."),
             *[""] * bool(failed), *failed]
    path.write_text(before + "<!-- table -->\n" + "\n".join(lines) + "\n<!-- end of table -->\n" + after)
