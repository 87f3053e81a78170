#!/usr/bin/python3
"""-snapshot_times exact: snapshots at the multiples of the interval, of the second order, that leave the run alone.

Needs EULASTIC=path of the binary and EULASTIC_MPIEXEC.
"""
import pathlib
import shutil
import sys
import unittest

import h5py
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from restart_case import FLAT, SOLID, OFTEN, Restart  # noqa: E402

DISCS, BALL = FLAT[:-4], SOLID[:-4]  # without their ends
EVERY = .17
INTERVAL = ["-snapshot_interval", EVERY]
EXACT = ["-snapshot_times", "exact", "-snapshot_precision", "double", "-snapshot_fields",
         "velocity,solid_fraction,left_cauchy_green,body"]
MEMBRANE = [*BALL[:-2], *("-cell_law membrane -cell_surface_shear_modulus .5 "
                          "-cell_viscosity .6").split()]


class SnapshotTimes(Restart):
    def snapshots(self, directory):
        return sorted((self.room / directory).glob("snapshot_*.h5"))

    def times(self, directory):
        times = []
        for path in self.snapshots(directory):
            with h5py.File(path) as file:
                times.append(float(file.attrs["time"]))
        return times

    def assert_same_snapshots(self, one, other):
        a, b = self.snapshots(one), self.snapshots(other)
        self.assertEqual([p.name for p in a], [p.name for p in b])
        for x, y in zip(a, b):
            with h5py.File(x) as first, h5py.File(y) as second:
                self.assertEqual(first.attrs["time"], second.attrs["time"])
                self.assertEqual(set(first), set(second))
                for name in first:
                    numpy.testing.assert_array_equal(first[name][()], second[name][()], f"{x.name} {name}")

    def test_times_are_the_multiples_and_the_run_is_left_alone(self):
        for case, step in ((DISCS, .05), (BALL, .07), (MEMBRANE, .03)):
            with self.subTest(case[1], step=step):
                options = [*case, "-time_step", step, "-time_end", 1]
                self.run_case("plain", *options)
                self.run_case("films", *options, *INTERVAL, *EXACT)
                self.assert_same("plain", "films")
                expected = [n * EVERY for n in range(6)] + [1.]
                numpy.testing.assert_allclose(self.times("films"), expected, rtol=1e-12)
                for run in ("plain", "films"):
                    shutil.rmtree(self.room / run)

    def test_several_within_a_step(self):
        self.run_case("films", *DISCS, "-time_step", .06, "-time_end", .3, *EXACT, "-snapshot_interval", .02)
        numpy.testing.assert_allclose(self.times("films"), [n * .02 for n in range(16)], rtol=1e-12)

    def test_rows_of_the_series_are_of_second_order(self):
        """A row between two half levels against the one that a run which ends there makes of its last one, by half a step:
        what both miss, and so their difference, falls with the square of the step."""
        case = [*DISCS, "-initial_velocity_mean", ".6,0,0", "-series_interval", "1e-9", "-time_end", 100]
        columns = ("elastic_energy", "elastic_power", "centroid", "elastic_energy of bodies")

        def differences(step, steps):
            self.run_case("ends", *case, "-time_step", step, "-time_steps_max", steps)
            self.run_case("goes_on", *case, "-time_step", step, "-time_steps_max", steps + 3)
            rows = []
            for run in ("ends", "goes_on"):
                lines = self.series(run).splitlines()
                row = dict(zip(lines[0].split(","), map(float, lines[steps + 1].split(","))))
                self.assertEqual(row["step"], steps)
                with h5py.File(self.room / run / "bodies.h5") as file:
                    self.assertEqual(file["time"][steps], row["time"])
                    rows.append([numpy.array(q) for q in (
                        row["elastic_energy"], row["elastic_power"], file["centroid"][steps, :, 0],
                        file["elastic_energy"][steps])])
                shutil.rmtree(self.room / run)
            return [abs(a - b).max() / abs(a).max() for a, b in zip(*rows)]
        coarse, fine = differences(.08, 5), differences(.02, 20)
        for name, a, b in zip(columns, coarse, fine):
            print(f"{name}: {a:.2e}, with a quarter of the step {b:.2e}")
            self.assertGreater(a, 0, name)
            self.assertLess(b, a / 8, name)
            self.assertLess(b, 2e-3, name)

    def test_second_order(self):
        """Against small steps that meet the multiples. Where solids are depends on the grid and the step together; there
        a snapshot must be much better than that of the next step, late by up to a step."""
        case = [*DISCS, "-time_end", 4 * EVERY, "-initial_velocity_mean", ".6,0,0"]
        self.run_case("fine", *case, "-time_step", EVERY / 64, *INTERVAL, *EXACT)

        def errors(step, times=EXACT):
            self.run_case("run", *case, "-time_step", step, *INTERVAL, *times)
            sums = {}
            for run in ("fine", "run"):
                with h5py.File(self.snapshots(run)[3]) as file:
                    phi, x = file["solid_fraction"][0], numpy.arange(20) + .5
                    bead = phi * (file["body"][0] == 2)
                    sums[run] = [file["velocity_x"][0], (bead * x).sum() / bead.sum(),
                                 (bead * file["left_cauchy_green_xx"][0]).sum() / bead.sum()]
            shutil.rmtree(self.room / "run")
            return [float(numpy.sqrt(numpy.mean((a - b)**2))) for a, b in zip(sums["run"], sums["fine"])]

        # Multiples are .4 and .8 of a step after one, before and after its middle.
        coarse, half = errors(EVERY / 3.8), errors(EVERY / 7.6)
        late = errors(EVERY / 7.6, EXACT[2:])
        self.assertGreater(coarse[0] / half[0], 3)
        for name, error, of_late in zip(("velocity", "centroid", "strain"), half, late):
            self.assertLess(error, .2 * of_late, name)

    def test_same_bits_on_ranks_and_after_a_restart(self):
        for case in (DISCS, MEMBRANE):
            with self.subTest(case[1]):
                options = [*case, "-time_step", .06, "-time_end", 100, *INTERVAL, *EXACT]
                end = lambda n: ["-time_steps_max", n]
                self.run_case("whole", *options, *end(12))
                self.run_case("others", *options, *end(12), ranks=3)
                self.assert_same_snapshots("whole", "others")
                self.run_case("run", *options, *end(7), *OFTEN, ranks=2)
                self.run_case("run", *options, *end(12), "-restart", "run")
                self.assert_same_snapshots("whole", "run")
                for run in ("whole", "others", "run"):
                    shutil.rmtree(self.room / run)

    def test_refused_where_it_means_nothing(self):
        self.refused(*DISCS, "-time_end", 1, *EXACT, "-method", "classic", says=["-snapshot_times", "steps"])


if __name__ == "__main__":
    unittest.main()
