"""Writes an output directory as a run with two spheres in a channel would, from closed formulas."""
import json
import pathlib

import h5py
import numpy

LENGTH = numpy.array([8.0, 6.0, 4.0])
RADIUS = 1.0
START = numpy.array([[0.25, 1.5, 2.0], [4.0, 4.5, 2.0]])  # the first one crosses x = 0
SPEED = 0.02


def centroids(time, speed=SPEED):
    """Unwrapped, (nb, 3): both bodies move along x, the second one twice as fast."""
    return START + numpy.outer([1, 2], [speed * time, 0, 0])


def write_snapshot(path, time, cells, pressure_offset=0.0):
    h = LENGTH / cells
    x, y, z = ((numpy.arange(n) + 0.5) * s for n, s in zip(cells, h))
    z, y, x = numpy.meshgrid(z, y, x, indexing="ij")
    fraction, body = numpy.zeros(x.shape), numpy.zeros(x.shape, int)
    for label, centre in enumerate(centroids(time), 1):
        distance = [q - c for q, c in zip((x, y, z), centre)]
        for d in (0, 2):  # periodic
            distance[d] -= LENGTH[d] * numpy.round(distance[d] / LENGTH[d])
        inside = numpy.clip(0.5 + (RADIUS - numpy.sqrt(sum(q * q for q in distance))) / h.max(), 0, 1)
        fraction += inside
        body[inside > 0] = label
    with h5py.File(path, "w") as file:
        file.attrs["time"] = [time]
        velocity = numpy.stack([y * (LENGTH[1] - y) / 9 * SPEED, 0 * y, 0 * y], axis=-1).astype("f4")
        file["velocity"] = velocity
        for d, axis in enumerate("xyz"):
            file["velocity_" + axis] = velocity[..., d]  # the same on the faces: uniform along x
        file["wall_shear_stress_ymin"] = numpy.tile([1e-3, 0, 0], (cells[2], 1, cells[0], 1)).astype("f4")
        file["wall_shear_stress_ymax"] = file["wall_shear_stress_ymin"][...]
        file["pressure"] = (numpy.sin(2 * numpy.pi * x / LENGTH[0]) + pressure_offset).astype("f4")
        file["solid_fraction"] = fraction.astype("f4")
        file["body"] = body.astype("i4")


def write_run(directory, cells=(32, 24, 16), times=(0.0, 50.0, 100.0), speed=SPEED, pressure_offset=0.0):
    directory = pathlib.Path(directory)
    directory.mkdir(parents=True, exist_ok=True)
    cells = numpy.array(cells)
    (directory / "options.txt").write_text(
        "# eulastic\n"
        f"-grid_cells {','.join(map(str, cells))}\n-grid_length {','.join(map(str, LENGTH))}\n"
        "-boundary_x periodic\n-boundary_y wall\n-boundary_z periodic   # comment\n"
        "-body_force 1e-3,0,-1e-5\n-check_only false\n-species rbc\n-rbc_shape sphere\n")
    for n, time in enumerate(times):
        write_snapshot(directory / f"snapshot_{n:06}.h5", time, cells, pressure_offset)
    with open(directory / "series.csv", "w") as file:
        file.write("step,time,dt,kinetic_energy,bulk_velocity\n")
        for n, time in enumerate(times):
            file.write(f"{n},{time!r},0.5,{time * 1e-4!r},{SPEED * 2 / 3!r}\n")
    positions = numpy.array([centroids(t, speed) for t in times])
    with h5py.File(directory / "bodies.h5", "w") as file:
        file["time"], file["id"], file["species"] = list(times), [1, 2], ["rbc", "rbc"]
        file["centroid"], file["velocity"] = positions, numpy.gradient(positions, times, axis=0)
        for name in ("volume", "taylor_deformation", "inclination", "elastic_energy", "largest_stretch", "rest_deformation"):
            file[name] = numpy.ones((len(times), 2))
    bodies = [{"id": i, "species": "rbc", "centroid": list(c), "velocity": [SPEED * i, 0, 0], "volume": 1.0,
               "taylor_deformation": 0.1, "inclination": 30.0 + i, "elastic_energy": 0.1, "largest_stretch": 1.2, "rest_deformation": 0.0} for i, c in enumerate(positions[-1], 1)]
    (directory / "summary.json").write_text(json.dumps(
        {"version": "0", "exit_reason": "time_end", "steps": 10, "time": times[-1], "divergence_rms": 1e-4,
         "divergence_max": 1e-3, "wall_seconds": 2.0, "ns_per_cell_step": 80.0, "bodies": bodies}))
    return directory
