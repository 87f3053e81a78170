"""Maps and table of scripts/studies/stability/stability_map."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.patches import Patch  # noqa: E402

SHEETS = {"flows": ["cavity", "random", "shear", "extension"],
          "bodies": ["cells", "thin", "contact", "stretched", "flat_cells", "solid", "viscosity"],
          "times": ["time_step", "reversing", "layers", "nothing", "long", "corner"]}
COLOURS = {"stable": "#7fbf7b", "reported": "#fee08b", "energy": "#d73027", "nonfinite": "#67001f", "guard": "#f46d43",
           "volume": "#b2182b", "phi": "#d6604d", "det B": "#c51b7d", "other": "#542788"}


def verdict(scene):
    reason = scene.outcome["reason"]
    if reason:
        return reason if reason in COLOURS else "other"
    return "reported" if scene.outcome["notes"] else "stable"


def draw_group(axis, group, method, scenes):
    for scene in scenes:
        axis.add_patch(plt.Rectangle((group.x.index(scene.x), group.y.index(scene.y)), 0.95, 0.95,
                                     color=COLOURS[verdict(scene)], hatch=None if scene.automatic else "..", linewidth=0))
    axis.set(xlim=(0, len(group.x)), ylim=(0, len(group.y)), xlabel=group.x_label, ylabel=group.y_label)
    axis.set_xticks([i + 0.5 for i in range(len(group.x))], group.x, fontsize=6,
                    rotation=60 if isinstance(group.x[0], str) else 0, ha="right" if isinstance(group.x[0], str) else "center")
    axis.set_yticks([i + 0.5 for i in range(len(group.y))], group.y, fontsize=6)
    axis.set_title(f"{group.title}: {method}", fontsize=8)


def draw(scenes, directory):
    groups = {s.group.name: s.group for s in scenes}
    for sheet, listed in SHEETS.items():
        names = [n for n in listed if n in groups]
        if not names:
            continue
        figure, axes = plt.subplots(len(names), 2, figsize=(9, 2.6 * len(names)), squeeze=False)
        for row, name in zip(axes, names):
            for axis, method in zip(row, ("fast", "classic")):
                draw_group(axis, groups[name], method, [s for s in scenes if s.group.name == name and s.method == method])
        figure.legend(handles=[Patch(color=c, label=n) for n, c in COLOURS.items()], ncols=len(COLOURS), fontsize=7,
                      loc="upper center")
        figure.tight_layout(rect=(0, 0, 1, 0.98))
        figure.savefig(directory / f"stability_{sheet}.png", dpi=80)
        plt.close(figure)


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
    """Between the two marks in the file: a row per group and method, of the scenes at the automatic time step. Rows of
    groups that are not among `scenes` are kept."""
    before, rest = path.read_text().split("<!-- table -->\n")
    old, after = rest.split("<!-- end of table -->\n")
    groups = {s.group.name: s.group for s in scenes}
    rows = {tuple(line.split(" | ")[:2]): line for line in old.splitlines()[2:] if line.startswith("| ")}
    for group in groups.values():
        for method in ("fast", "classic"):
            rows["| " + group.title, method] = table_row(group, method, scenes)
    failed = [line for line in old.splitlines() if line.startswith("- ") and line[2:].split(", ")[0] not in groups]
    failed += [f"- {s.name}: {s.outcome['reason']}" for s in scenes if s.automatic and s.outcome["reason"]]
    count = sum(int(row.split(" | ")[column]) for row in rows.values() for column in (2, 4))
    lines = ["| scenes | method | stable | of these yellow | failed | energy | phi outside 0 ... 1 | volume | det B | largest stretch | B unresolved | from stretch |",
             "|---|---|---|---|---|---|---|---|---|---|---|---|", *rows.values(), "",
             f"{count} scenes at the automatic time step (up to 1.2 of it), {len(failed)} failed" + (":" if failed else "."),
             *[""] * bool(failed), *failed]
    path.write_text(before + "<!-- table -->\n" + "\n".join(lines) + "\n<!-- end of table -->\n" + after)
