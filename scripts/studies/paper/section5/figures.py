"""The pictures of scripts/studies/paper/paper_section5, from {case: run}."""
import numpy
from eulastic.figure_style import BLUE, COLOURS, INK, MARKS, ORANGE, SKY, VERMILLION, WIDTH, legend_below, legend_beside, panels, plt, save
from eulastic.labels import Units
from eulastic.scene import Look, Scene, plane_range

from . import measures


def percent(run):
    """Returns the hematocrit that was asked for, in %."""
    return 100 * float(run.options.get("rbc_hematocrit", 0))


def snapshots(runs, work, path):
    """Draws Fig. 7: the beginning and the end of every run."""
    pairs = {case: (run.snapshots[0], run.snapshots[-1]) for case, run in runs.items()}
    speed = plane_range([snapshot for pair in pairs.values() for snapshot in pair])
    figure, axes = plt.subplots(len(runs), 2, figsize=(WIDTH, 2.12 * len(runs) + 0.3), squeeze=False, layout="none",
                                gridspec_kw=dict(left=0.06, right=0.99, top=1 - 0.3 / (2.12 * len(runs) + 0.3), bottom=0.005,
                                                 wspace=0.02, hspace=0.03))
    for row, (case, pair) in zip(axes, pairs.items()):
        scene = Scene(runs[case], (960, 500), Units(""), speed, 0, Look(camera=(6, 12), words=False))
        for axis, snapshot in zip(row, pair):
            picture = work / f"{case}_{int(snapshot is pair[1])}.png"
            scene.draw(snapshot, picture)
            axis.imshow(plt.imread(picture), interpolation="antialiased")
            axis.set(xticks=[], yticks=[])
            axis.spines[:].set_visible(False)
            if axis in axes[0]:
                axis.set_title(f"t = {snapshot.time / 1000:.2g} ms")
        row[0].set_ylabel(f"{percent(runs[case]):.0f} %")
    save(figure, path)


def platelets(runs, path):
    """Draws Fig. 8: distances of all platelets from the axis, without red cells and with the highest hematocrit."""
    chosen = [runs[case] for case in (list(runs)[0], list(runs)[-1])]
    figure, axes = panels(2, height=3.6, sharey=True)
    for axis, run in zip(axes, chosen):
        axis.plot(run.bodies.time / 1000, measures.radial(run)[0], lw=0.9)
        axis.axhline(measures.tube(run)[0], color="0.4", lw=2)
        axis.set(title=f"hematocrit {percent(run):.0f} %", xlabel="t (ms)", xlim=(0, run.bodies.time[-1] / 1000),
                 ylim=(0, measures.tube(run)[0] + 0.4))
    axes[0].set_ylabel("distance from the axis (µm)")
    save(figure, path)


def windows(time, width):
    """Returns slices of rows, each about `width` of time long."""
    edges = numpy.searchsorted(time, numpy.arange(time[0], time[-1] + width / 2, width))
    return [slice(a, b) for a, b in zip(edges[:-1], edges[1:]) if b > a]


def radial_velocity(runs, path):
    """Draws Fig. 9: rms of the radial velocity of the platelets, over time and as a mean of the later part."""
    figure, (left, right) = panels(2, height=3.8, sharey=True, width_ratios=(1.5, 1))
    for n, run in enumerate(runs.values()):
        velocity, time = measures.radial(run)[1], run.bodies.time
        parts = windows(time, time[-1] / 20)
        colour, mark = COLOURS[n % len(COLOURS)], MARKS[n % len(MARKS)]
        left.plot([time[part].mean() / 1000 for part in parts],
                  [1e3 * numpy.sqrt((velocity[part] ** 2).mean()) for part in parts], color=colour, marker=mark, ms=3,
                  label=f"{percent(run):.0f} %")
        value, error = measures.radial_rms(run)
        right.errorbar(percent(run), 1e3 * value, 1e3 * error, color=colour, marker=mark, ms=4, capsize=3)
    left.set(xlabel="t (ms)", ylabel="rms of radial velocity (µm/ms)", ylim=(0, None))
    legend_below(figure, [left], columns=len(runs), title="hematocrit")
    right.set(xlabel="hematocrit (%)", title="mean over the last two thirds", xlim=(-1, None))
    save(figure, path)


def stress(runs, path):
    """Draws the shares of the shear stress that plasma and cells carry at the end."""
    chosen = [runs[case] for case in (list(runs)[0], list(runs)[-1])]
    figure, axes = panels(2, height=3.8, sharey=True)
    for axis, run in zip(axes, chosen):
        radius = measures.tube(run)[0]
        radii = numpy.linspace(0.05 * radius, min(1.04 * radius, run.length[1] / 2 - 1.01 * run.spacing[1]), 100)
        viscous, elastic = 1e3 * measures.shear_stress(run, run.snapshots[-1], radii)
        axis.stackplot(radii, viscous, elastic, colors=(SKY, ORANGE), labels=("viscous", "elastic"))
        axis.plot(radii, 1e3 * measures.force(run) * radii / 2, color=INK, ls="--", label="exact: force × r/2")
        axis.axvline(radius, color="0.4", lw=2)
        axis.set(title=f"hematocrit {percent(run):.0f} %", xlabel="r (µm)", xlim=(radii[0], radii[-1]))
    legend_below(figure, axes)
    axes[0].set_ylabel("shear stress (Pa)")
    save(figure, path)


def viscosity(runs, membranes, path):
    """Draws the relative apparent viscosity beside that of blood in glass tubes."""
    plasma = measures.flow_rate(runs["plasma"])[0]
    diameter = 2 * measures.tube(runs["plasma"])[0]
    figure, (axis,) = panels(1, height=3.8)
    cells = {case: run for case, run in runs.items() if case != "plasma"}
    discharge = [measures.hematocrit(run)[1] for run in cells.values()]
    axis.plot([0] + [100 * h for h in discharge], [1] + [plasma / measures.flow_rate(run)[0] for run in cells.values()], "o-",
              color=BLUE, label="solids")
    for run in membranes.values():
        ratio = measures.plasma_rate(runs["plasma"], run) / measures.flow_rate(run)[0]
        axis.plot(100 * measures.hematocrit(run)[1], ratio, "s", color=VERMILLION, label="membranes")
    line = numpy.linspace(0, max([0.25, *discharge]), 50)
    axis.plot(100 * line, measures.pries(diameter, line), "--", color=INK, label=f"Pries et al. 1992,\n{diameter:g} µm")
    axis.set(xlabel="discharge hematocrit (%)", ylabel="relative apparent viscosity", ylim=(0.95, None))
    legend_beside(axis)
    save(figure, path)
