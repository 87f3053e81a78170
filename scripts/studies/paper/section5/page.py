"""Writes docs/capillary.md: checks, a table and pictures."""
import math
import os
import pathlib
import re
import subprocess

import numpy
from eulastic import read_options

from . import measures

ROOT = pathlib.Path(__file__).resolve().parents[4]
CASE, PAPER = ROOT / "options/capillary_plasma.opts", ROOT / "options/capillary_paper.opts"

WORDS = {True: "pass", False: "**FAIL**", None: "reported"}

PAGE = """# Red cells and platelets in a capillary

Written by `scripts/studies/paper/paper_section5`; do not edit. This page repeats section 5 of Sugiyama et al. (HPCS 2013)
for readers who want to see what the program computes for blood. Red cells and platelets flow through an elastic vessel at hematocrits of 0, 5, 10,
15 and 20 %. The vessel is small enough for two cores, while the paper used the K computer:

    scripts/studies/paper/paper_section5                # all runs: about half an hour; the same command continues after an interruption
    scripts/studies/paper/paper_section5 --finished     # no runs: writes the page from the finished ones
    scripts/studies/paper/paper_section5 --only h20     # one of {cases}

The vessel, {diameter:g} µm wide and {length:g} µm long, is an elastic wall (tube) in a box of {cells} cells of
{spacing:.3g} µm, periodic along x. A body force of {force:g} drives plasma of viscosity {viscosity:g} from rest. Lengths are in µm, times in µs, and the
density is 1; the runs end at {end:g}. Red cells are biconcave solids, 8 µm wide. The {platelets} platelets are ellipsoids of 2 x 2 x 1.6 µm, which start from
the same positions at all hematocrits. The wall shear stress is {capillary:.2g} of the cells' shear modulus. The paper's own case is options/capillary_paper.opts, a vessel
of 104 µm on 3072 x 640 x 640 cells with 8549 red cells and 2000 platelets. For this case `-check_only` estimates {memory} of memory
and a run time of about {time} on one core.

{unfinished}## Figure 7: the cells

![Snapshots at five hematocrits](images/section5_snapshots.png)

*Cells at the beginning and at the end. The pictures show the far half of the vessel. Cells that cross a periodic boundary are cut there and drawn at both ends. With 13 grid cells per diameter some red cells appear as rings ([dimple.md](dimple.md)).*

## Figure 8: positions of the platelets

![Distance of platelets from the axis](images/section5_platelets.png)

*Distance of every platelet from the axis, without red cells and at the highest hematocrit. The grey line is the wall.*

## Figure 9: fluctuation of the platelets

![Radial velocity of platelets](images/section5_radial_velocity.png)

*Root mean square of the radial velocity over the platelets, averaged over each twentieth of the run and over its last two thirds. The bars
are standard errors, computed from the differences between platelets.*

{trend}

## Checks

| check | {names} | expected | verdict |
|---|{columns}---|---|
{checks}

Rows with the verdict "reported" are not judged. Means are over the last two thirds of a run; stresses are those of the last snapshot.

**The wall shear stress** is that at the surface of the lumen, which does not coincide with faces of the grid. It is computed from the staggered velocities
and the B of every species in the snapshot, as the mean of the stress sigma_xr over a cylinder of radius r around the axis, less the flux of momentum;
sigma_xr is mu du/dr plus the sum of G phi B_xr over the species. In a steady flow this mean is force x r/2 at every r, independent of the bodies; at the wall
it is force x diameter/4. The check shows that the flow is steady, that the stresses in the momentum equation agree with the fields in the snapshot, and that no force is lost
at the surface, where cut cells contain viscous and elastic stress. The force on the walls of the box balances the body force on
everything in the box, including the vessel.

**The wall** is an elastic solid that is initially without stress. It is held only by the boundaries of the box that it reaches; no spring pulls it
back. The flow shears the wall by {shear:.2f}, which moves its surface along x by about {elastic:.2f} µm where it is thinnest. Passing cells press on the wall,
so that its surface has an outward displacement at the first snapshot already (averaged over {patch:.1f} µm of the circumference and a grid cell along x).
The mean of this displacement is zero, since volume is conserved. The displacement must not grow by itself ([method.md](method.md), section 7). Therefore
its rms at the last snapshot is compared with that at the first. With cells, the wall also creeps slowly along x: its mean velocity within two grid cells of
the lumen corresponds to {creep:.3f} µm in 1000 µs at most.

![Shares of the shear stress](images/section5_stress.png)

*Viscous and elastic parts of the shear stress at the distance r from the axis, at the end of the run.*
{tube}{flow}"""

FLOW = """
## Flow rate

![Relative apparent viscosity](images/section5_viscosity.png)

*Relative apparent viscosity: the flow rate of plasma over that of blood at the same force. The dashed line is the fit of Pries,
Neuhaus and Gaehtgens (Am. J. Physiol. 263, H1770, 1992) to data for blood in glass tubes, evaluated at this diameter. The
discharge hematocrit is the volume fraction of red cells in the blood that leaves the tube.*

| hematocrit | red cells | requested | placed | discharge | flow rate, µm³/ms | apparent viscosity | Pries et al. | gap |
|---|---|---|---|---|---|---|---|---|
{flow}

In the last row the red cells are membranes around a fluid five times as viscous as plasma, with the same initial positions
(options/capillary_red_cells_h20.opts); in all other rows they are solids as viscous as plasma.

The gap in the last column is the relative difference of the apparent viscosity from that of Pries et al. The next table shows measures that help to explain it:

| hematocrit | tube / discharge hematocrit | the same, Pries et al. 1990 | apparent viscosity in sixths of the run | from the profile | blood in the same positions | layer, µm | layer for Pries et al., µm |
|---|---|---|---|---|---|---|---|
{layers}

- *Apparent viscosity in sixths of the run*: its mean over each sixth, from the second one on.
- *From the profile*: the apparent viscosity of a tube with the final distribution of cells and the local viscosity {local}, where H is
  the local volume fraction of cells. The local viscosity is a fit to the ratio of force x r/2 to the slope of u, at all radii and later snapshots of all runs with such cells.
- *Blood in the same positions*: the same, but with the local viscosity that Pries et al. give for wide tubes.
- *Layer*: the width of an equivalent cell-free layer at the wall. If the cells were distributed evenly in the rest of the lumen, such a layer would give the apparent viscosity
  of the run. The last column is the same for the value of Pries et al. at the resulting discharge hematocrit. The profile itself need not have such a layer.

Two causes of the gap can be separated:

1. **Positions of the cells.** The cells were placed in the whole lumen and have not gathered around the axis as in a long tube: the tube hematocrit is too close to the
   discharge hematocrit, and the layer is too thin. A layer as wide as in the last column would close the gap. The run has only {strain:.0f} units of shear strain at the wall, which
   is too short for such a migration; the sixths of the run show its progress.
2. **Properties of the cells.** In the same positions real blood would flow more easily. A solid cell is a neo-Hookean body as viscous as plasma, which cannot tank-tread. Only a few grid
   cells span the thickness of a red cell ([dimple.md](dimple.md)), and less than one spans the plasma between two of them.

The vessel is not a cause: the flow rate of plasma alone is correct to {plasma}.{coarse}
The period, 2.4 diameters, has not been varied.
"""

TUBE = """
## Plasma alone: Poiseuille's flow in the tube

These runs have the same vessel and force without red cells and platelets. The vessel is four grid cells long, and its surface cuts the grid at all angles. The
runs end when the flow is steady. tests/convergence/tube_test.cpp asserts the order.

| cells across the lumen | rms error of u | order | error of flow rate | rms velocity of the wall / largest of plasma |
|---|---|---|---|---|
{rows}

The error of u is the root mean square over the lumen, relative to the largest u. The error of the flow rate is relative, too. The order is computed from the error with half as many
cells; it varies because the surface cuts each grid differently. From 40 cells on, the wall is at least four grid cells thick; where it is only two or three cells thick, the errors are
larger than the order suggests. The last line has `-vessel_anchored false`, which treats the wall like a free body ([method.md](method.md), section 7): the wall does not move either,
but its surface is of first order, so that the lumen acts as if it were narrower.
"""


def percent(value, digits=2):
    return f"{100 * value:.{digits}f} %"


def estimate(case, line, value):
    """Returns the number that -check_only prints in a line about an options file."""
    program = os.environ.get("EULASTIC", ROOT / "build/release/eulastic")
    report = subprocess.run([program, case, "-check_only"], check=True, capture_output=True, text=True).stdout
    return re.search(rf"^{line}.*?: ({value})", report, re.MULTILINE)[1]


def checks(runs):
    """Yields (name, {case: text}, expected value, verdict or None) of every check for which the runs exist."""
    wall = {case: measures.wall_shear_stress(run) for case, run in runs.items()}
    yield ("wall shear stress / (force x diameter/4)", {c: f"{w:.4f}" for c, w in wall.items()}, "1, within 1 %",
           all(abs(w - 1) < 0.01 for w in wall.values()))
    held = {case: measures.held_by_walls(run) for case, run in runs.items()}
    yield ("force on the box / body force on all in it", {c: f"{w:.4f}" for c, w in held.items()}, "1, within 1 %",
           all(abs(w - 1) < 0.01 for w in held.values()))
    cells = {case: run for case, run in runs.items() if case != "plasma"}
    off = {case: cells_off(run) for case, run in cells.items()}
    yield ("number of red cells minus the requested number", {c: f"{n:+.2f}" for c, n in off.items()}, "within one",
           all(abs(n) < 1 for n in off.values()))
    rate = {case: measures.flow_rate(run)[0] / measures.poiseuille(run) for case, run in runs.items()}
    yield ("flow rate / Poiseuille's", {c: f"{q:.4f}" for c, q in rate.items()}, "falls; plasma 1, within 1 %",
           verdict(runs, lambda: abs(rate["plasma"] - 1) < 0.01 and list(rate.values()) == sorted(rate.values(), reverse=True)))
    rms = {case: measures.radial_rms(run)[0] for case, run in runs.items()}
    yield ("radial rms velocity of platelets, µm/ms", {c: f"{1e3 * v:.3f}" for c, v in rms.items()},
           "more with red cells than without", verdict(runs, lambda: min(rms[c] for c in cells) > 2 * rms["plasma"]))
    drift = {case: abs(run.series.solid_volume / run.series.solid_volume[0] - 1).max() for case, run in runs.items()}
    yield ("change of the volume of all bodies together", {c: f"{d:.1e}" for c, d in drift.items()}, "", None)
    own = {case: run.series.volume_drift.max() for case, run in runs.items()}
    yield ("largest change of the volume of one body", {c: f"{d:.1e}" for c, d in own.items()}, "", None)
    yield ("overlap of bodies, relative to the volume of the red cells", {c: f"{measures.overlap(run):.1g}" for c, run in cells.items()}, "", None)
    yield ("centres whose strain the grid did not resolve, over all steps", {c: str(run.summary["strain_forgotten"]) for c, run in runs.items()},
           "", None)
    moved = {case: measures.wall_displacements(run) for case, run in runs.items()}
    yield ("wall: outward displacement, rms at the snapshots, µm",
           {c: ", ".join(f"{x.std():.3f}" for x in d) for c, d in moved.items()}, "", None)
    growth = {case: d[-1].std() / d[0].std() for case, d in moved.items()}
    yield ("wall: rms at the last snapshot / at the first", {c: f"{g:.2f}" for c, g in growth.items()}, "below 2",
           verdict(runs, lambda: max(growth.values()) < 2))
    yield ("wall: largest displacement at any snapshot, µm", {c: f"{abs(d).max():.2f}" for c, d in moved.items()}, "", None)
    speed = {case: measures.wall_speed(run) for case, run in runs.items()}
    yield ("wall: mean velocity at the end / largest of plasma", {c: f"{v[0]:+.0e}" for c, v in speed.items()}, "", None)
    yield ("wall: rms velocity at the end / largest of plasma", {c: f"{v[1]:.0e}" for c, v in speed.items()}, "", None)


def verdict(runs, holds):
    """Returns None as long as there is nothing to compare."""
    return bool(holds()) if "plasma" in runs and len(runs) > 1 else None


def cells_off(run):
    """Returns the number of red cells less the number that the hematocrit asks for."""
    wanted = float(run.options["rbc_hematocrit"]) * measures.area(run) * run.length[0]
    count = len(measures.of_species(run, "rbc"))
    volume = run.bodies.volume[0, measures.of_species(run, "rbc")].sum() / count
    return count - wanted / volume


def name_of(case, run):
    return percent(float(run.options["rbc_hematocrit"]), 0) + (", membranes" if case.startswith("red_cells") else "")


def flow_rows(runs, membranes):
    diameter = 2 * measures.tube(runs["plasma"])[0]
    for case, run in (runs | membranes).items():
        rate, spread = measures.flow_rate(run)
        text = f"{1e3 * rate:.0f} ± {1e3 * spread:.0f}"
        if case == "plasma":
            yield f"| 0 | 0 | 0 | 0 | 0 | {text} | 1 | 1 | |"
            continue
        seeded, discharge = measures.hematocrit(run)
        here, there = measures.plasma_rate(runs["plasma"], run) / rate, measures.pries(diameter, discharge)
        count = len(measures.of_species(run, "rbc"))
        asked = float(run.options["rbc_hematocrit"])
        yield (f"| {name_of(case, run)} | {count} | {percent(asked)} | {percent(seeded)} | {percent(discharge)} | {text} | "
               f"{here:.3f} | {there:.3f} | {percent(here / there - 1, 0)} |")


def local_fit(runs):
    a, b = measures.local_viscosity([run for case, run in runs.items() if case != "plasma"])
    return f"1 {'-+'[a > 0]} {abs(a):.2f} H {'-+'[b > 0]} {abs(b):.1f} H²", lambda h: 1 + a * h + b * h ** 2


def layer_rows(runs, membranes):
    for group in (runs, membranes) if membranes else (runs,):
        viscosity = local_fit(group)[1]
        for case, run in group.items():
            if case == "plasma":
                continue
            radius = measures.tube(run)[0]
            seeded, discharge = measures.hematocrit(run)
            r, share, _ = measures.profiles(run, run.snapshots[-1])
            at = lambda x: numpy.interp(x, r, share, right=0)  # noqa: E731
            here = measures.plasma_rate(runs["plasma"], run) / measures.flow_rate(run)[0]
            ends = [n / 6 * run.series.time[-1] for n in range(1, 7)]
            rate = [run.series.bulk_velocity_x[(run.series.time >= t0) & (run.series.time <= t1)].mean()
                    for t0, t1 in zip(ends[:-1], ends[1:])]
            steady = runs["plasma"].series.bulk_velocity_x[-1] * measures.poiseuille(run) / measures.poiseuille(runs["plasma"])
            there = measures.cell_free_layer(radius, seeded, viscosity, lambda h: measures.pries(2 * radius, h))
            yield (f"| {name_of(case, run)} | {seeded / discharge:.2f} | "
                   f"{measures.pries_ratio(2 * radius, discharge):.2f} | " + ", ".join(f"{steady / q:.3f}" for q in rate)
                   + f" | {measures.tube_flow(radius, at, viscosity)[0]:.3f} | "
                   f"{measures.tube_flow(radius, at, measures.pries_bulk)[0]:.3f} | "
                   f"{measures.cell_free_layer(radius, seeded, viscosity, lambda h: here):.1f} | {there:.1f} |")


def grid_effect(runs, coarse):
    """Compares the apparent viscosity at 10 % on two grids, over the time that all runs cover."""
    if len(coarse) < 2 or "h10" not in runs:
        return ""
    fine = {"plasma": runs["plasma"], "h10": runs["h10"]}
    end = min(run.series.time[-1] for run in [*fine.values(), *coarse.values()])

    def viscosity(pair):
        plasma, blood = (run.series.bulk_velocity_x[(run.series.time >= end / 3) & (run.series.time <= end)].mean() for run in pair)
        return f"{plasma / blood:.3f}"
    return (f"\nThe grid is not the main cause either: at 10 % the apparent viscosity from {end / 3:.0f} to {end:.0f} is "
            f"{viscosity(coarse.values())} on {' x '.join(map(str, list(coarse.values())[0].cells))} cells and "
            f"{viscosity(fine.values())} here.")


def flow(runs, membranes, coarse, strain):
    error = abs(measures.flow_rate(runs["plasma"])[0] / measures.poiseuille(runs["plasma"]) - 1)
    local = local_fit(runs)[0] + (f" (membranes {local_fit(membranes)[0]})" if membranes else "")
    return FLOW.format(flow="\n".join(flow_rows(runs, membranes)), layers="\n".join(layer_rows(runs, membranes)), local=local,
                       strain=strain, plasma=percent(error, 1), coarse=grid_effect(runs, coarse))


def tube_rows(tubes):
    errors = {}
    for name, run in tubes.items():
        cells = run.cells[1]
        radius, (y0, z0) = measures.tube(run)
        y, z = run.centres(1)[None, :] - y0, run.centres(2)[:, None] - z0
        share = 1 - (y ** 2 + z ** 2) / radius ** 2
        largest = 2 * measures.poiseuille(run) / measures.area(run)
        u = run.snapshots[-1]["velocity_x"].astype(float).mean(axis=2) / largest
        error = math.sqrt(((u - share)[share > 0] ** 2).mean())
        if name != "free":
            errors[cells] = error
        rate = run.series.bulk_velocity_x[-1] * run.length[1] * run.length[2] / measures.poiseuille(run) - 1
        order = f"{math.log2(errors[cells // 2] / error):.2f}" if cells // 2 in errors and name != "free" else ""
        label = f"{2 * radius / run.spacing[1]:.1f}" + (", not anchored" if name == "free" else "")
        yield f"| {label} | {error:.2e} | {order} | {rate:+.2e} | {measures.wall_speed(run)[1]:.0e} |"


def trend(runs):
    """Describes in words what Fig. 9 shows."""
    if "plasma" not in runs or len(runs) < 2:
        return "Some runs have not been made yet."
    rms = {case: [1e3 * v for v in measures.radial_rms(run)] for case, run in runs.items()}
    cells = list(rms)[1:]
    value = [rms[c][0] for c in cells]
    spread, error = value[-1] - value[0], math.hypot(rms[cells[0]][1], rms[cells[-1]][1])
    words = "increases with the hematocrit" if spread > 2 * error and value == sorted(value) else \
        "shows no trend with the hematocrit beyond its standard error"
    return (f"In plasma alone platelets keep their distance from the axis: the rms is {rms['plasma'][0]:.3f} µm/ms. With red cells they move about "
            f"{value[0] / rms['plasma'][0]:.0f} times\nas fast, already at the lowest hematocrit. Among the runs with red cells the rms {words}: "
            + ", ".join(f"{rms[c][0]:.2f} ± {rms[c][1]:.2f}" for c in cells)
            + " µm/ms\nfor " + ", ".join(f"{100 * float(runs[c].options['rbc_hematocrit']):.0f}" for c in cells) + " %. So the motion "
            "of the red cells makes the platelets fluctuate, which is the result of the paper.")


def other_options(run):
    """Describes in words how the runs differ from the files of options/."""
    file, changed = read_options(CASE), []
    for name in ("grid_cells", "grid_length", "time_end"):
        if [float(x) for x in file[name].split(",")] != [float(x) for x in run.options[name].split(",")]:
            changed.append(f"-{name} {run.options[name]}")
    return f"**The runs of this page were made with `{' '.join(changed)}`, in contrast to options/.**\n\n" if changed else ""


def write(runs, membranes, tubes, coarse, missing, path):
    """Writes the page. Returns whether no check failed."""
    run = list(runs.values())[0]
    rows = list(checks(runs))
    radius = measures.tube(run)[0]
    wall_stress = measures.force(run) * radius / 2
    strain = wall_stress / float(run.options["fluid_viscosity"]) * run.bodies.time[-1]
    text = PAGE.format(
        cases="plasma, h05, h10, h15, h20, red_cells_h20, tube, coarse", diameter=2 * radius, length=run.length[0],
        end=run.bodies.time[-1], cells=" x ".join(map(str, run.cells)), spacing=run.spacing[0], force=measures.force(run),
        viscosity=float(run.options["fluid_viscosity"]), platelets=len(measures.of_species(run, "platelet")),
        capillary=wall_stress / measures.shear_modulus(run, "platelet"),
        memory=estimate(PAPER, "memory", r"[\d.]+ GB"), time=estimate(PAPER, "wall time", r"[\d.]+ \w+"),
        shear=wall_stress / measures.shear_modulus(run, "vessel"), patch=radius * math.pi / 8,
        creep=max(1e3 * measures.wall_speed(run)[0] * 2 * measures.poiseuille(run) / measures.area(run) for run in runs.values()),
        elastic=wall_stress / measures.shear_modulus(run, "vessel") * (run.length[1] / 2 - radius),
        unfinished=other_options(run) + (f"**Not run yet: {', '.join(missing)}.**\n\n" if missing else ""), trend=trend(runs),
        names=" | ".join(runs), columns="---|" * len(runs),
        checks="\n".join(f"| {name} | {' | '.join(values.get(case, '') for case in runs)} | {wanted} | {WORDS[passed]} |"
                         for name, values, wanted, passed in rows),
        tube=TUBE.format(rows="\n".join(tube_rows(tubes))) if tubes else "",
        flow=flow(runs, membranes, coarse, strain) if "plasma" in runs and len(runs) > 1 else "")
    path.write_text(text)
    return not any(passed is False for *_, passed in rows)
