"""The criteria by which scripts/studies/stability/stability_map judges a finished run."""
import math

import numpy

from eulastic import Run

GROWTH = {"fast": 0.01, "classic": 0.1}  # share by which the energy of a flow that nothing drives may have grown
MADE = 0.1  # share of the energy that may be made, where more moves than the walls' speed explains
DRIFT = {"fast": 1e-3, "classic": 0.1}  # of the volume of all bodies
PHI = {"fast": 1e-9, "classic": 0.01}  # beyond 0 and 1
DETERMINANT = (0.5, 4.0)  # of B at the centres in free bodies, as long as no stretch was beyond
STRETCH = 3.0
MEMBRANES = ("membrane", "red_cell")  # B_s has the determinant 0
# WENO5 bounds neither phi nor the volume: of classic this is reported, not judged.
# Bodies of one species lie in boxes of their own; a snapshot holds the sum of their phi. Each is between 0 and 1
# (planes), the sum need not be: where it is not, they overlap.
REPORTED = {"fast": ("overlap", "energy made"), "classic": ("volume", "phi", "det B", "overlap", "energy made")}


def fields_of_b(snapshot, name):
    """Returns phi, tr B and det B at the centres; off-diagonals are averaged from their edges, those on high walls from inside."""
    ending = "_" + name if f"solid_fraction_{name}" in snapshot else ""
    b = {c: snapshot[f"left_cauchy_green_{c}{ending}"].astype(float) for c in ("xx", "yy", "zz", "yz", "xz", "xy")
         if f"left_cauchy_green_{c}{ending}" in snapshot}
    one = numpy.ones_like(b["xx"])

    def centred(c):
        if c not in b:
            return 0 * one
        q = b[c]
        for d in c:
            axis = "zyx".index(d)
            q = (q + numpy.roll(q, -1, axis)) / 2
        return q
    xx, yy, zz = b["xx"], b["yy"], b.get("zz", one)
    yz, xz, xy = centred("yz"), centred("xz"), centred("xy")
    determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
    return snapshot["solid_fraction" + ending], xx + yy + zz, determinant


def stretch_of(trace, flat):
    """Returns the largest stretch as the solver estimates it: uniaxial in 3-D, plane in 2-D."""
    if flat:
        t = max(trace - 1, 2)
        return math.sqrt((t + math.sqrt(t * t - 4)) / 2)
    return float(max(numpy.roots([1, 0, -max(trace, 3), 2]).real))  # y^3 - trace y + 2 = 0


def vectors(options, ending):
    return [[float(x) for x in value.split(",")] for name, value in options.items() if name.endswith(ending)]


def energy_made(series):
    """Returns, for every row, the gain of kinetic and elastic energy since any earlier row beyond the work of force and walls. It is 0
    in an exact flow: dissipation only removes energy, and a solid returns only what it received."""
    power = series.force_power + series.wall_power
    work = numpy.concatenate([[0], numpy.cumsum((power[1:] + power[:-1]) / 2 * numpy.diff(series.time))])
    unpaid = series.kinetic_energy + series.elastic_energy - work
    return unpaid - numpy.minimum.accumulate(unpaid)


def surface_energy_made(run):
    """Returns the energy that membranes have generated, relative to the energy supplied."""
    return float(-run.series.energy_lost_elastic.min() / run.summary["energy_supplied"])


def energy_growth(run):
    """Returns the largest energy relative to the bound that the start and the force allow. With moving walls the bound is the motion
    of the whole box at twice their speed, unless the energy was supplied: a solid that a wall stretches may hold many times that, and
    release it at once."""
    series, options = run.series, run.options
    volume = float(numpy.prod(run.length if run.cells[2] > 1 else run.length[:2]))
    modulus = max([float(v) for k, v in options.items() if k.endswith("_shear_modulus")] or [0.0])
    energy = series.kinetic_energy + series.elastic_energy
    wall = max([math.hypot(*v) for k, v in [(k, [float(x) for x in v.split(",")]) for k, v in options.items()
                                            if k.startswith("boundary_") and k.endswith("_velocity") and "," in v]] or [0.0])
    force = max([math.hypot(*v) for v in vectors(options, "body_force")] or [0.0])
    if wall > 0:
        share = series.kinetic_energy / (max(series.kinetic_energy[0], 0) + 2 * volume * wall**2)
        return float(numpy.where(energy_made(series) > MADE * energy, share, numpy.minimum(share, 1)).max())
    # d sqrt(E)/dt <= |f| sqrt(rho V/2)
    bound = (math.sqrt(max(energy[0], 0)) + force * math.sqrt(volume / 2) * series.time) ** 2
    return float(numpy.max(energy / (bound + 1e-12 * modulus * volume + 1e-300)))


def judge(directory, method):
    """Returns (reason of failure or "", what is only reported, measures)."""
    run = Run(directory)
    summary, series = run.summary, run.series
    m = {"steps": summary["steps"], "dt": summary["dt_mean"],
         "dt_min": float(numpy.min(series.dt[1:-1])) if len(series) > 2 else summary["dt_mean"]}
    if summary["exit_reason"] not in ("time_end", "steps"):
        return summary["exit_reason"], [], m
    if not all(numpy.isfinite(series[name]).all() for name in series.dtype.names):
        return "not finite", [], m
    m["energy"] = energy_growth(run)
    membranes = {name[:-len("_law")] for name, law in run.options.items() if name.endswith("_law") and law in MEMBRANES}
    if membranes:
        m["energy"] = max(m["energy"], 1 + surface_energy_made(run) - MADE)
    verdict = next(v for v in summary["verdicts"] if v["of"] == "energy")
    m["made"] = verdict["verdict"] == "do not trust" and "generated energy" in verdict["why"]
    m["forgotten"] = summary["strain_forgotten"]
    m["divergence"] = float(series.divergence_rms.max())
    m["volume"] = float(abs(series.solid_volume / series.solid_volume[0] - 1).max()) if series.solid_volume[0] > 0 else 0.0
    m["phi"], m["overlap"], m["stretch"], det = 0.0, 0.0, 1.0, []
    flat = run.cells[2] == 1
    for name in [n for n in run.options.get("species", "none").split(",") if n != "none"]:
        largest, free = 1.0, run.options[f"{name}_shape"] != "slab" and name not in membranes
        for snapshot in run.snapshots:
            phi, trace, determinant = fields_of_b(snapshot, name)
            beyond = "overlap" if sum(body["species"] == name for body in summary["bodies"]) > 1 else "phi"
            m["phi"] = max(m["phi"], float(-phi.min()))
            m[beyond] = max(m[beyond], float(phi.max() - 1))
            solid, inside = phi > 0.5, phi > 0.999
            free = free and not any(run.is_bounded(d) and solid.take([0, -1], 2 - d).any() for d in range(3))
            if solid.any():
                largest = max(largest, stretch_of(float(trace[solid].max()), flat))
            if free and largest <= STRETCH and inside.any():
                det += [float(determinant[inside].min()), float(determinant[inside].max())]
        m["stretch"] = max(m["stretch"], largest)
    m["det"] = [min(det), max(det)] if det else None
    broken = [name for name, bad in (
        ("energy", not m["energy"] <= 1 + GROWTH[method]), ("energy made", m["made"]), ("phi", m["phi"] > PHI[method]),
        ("overlap", m["overlap"] > PHI[method]), ("volume", not m["volume"] <= DRIFT[method]),
        ("det B", bool(det) and not DETERMINANT[0] <= min(det) <= max(det) <= DETERMINANT[1])) if bad]
    died = [name for name in broken if name not in REPORTED[method]]
    return ", ".join(died), [name for name in broken if name not in died], m
