"""Scripts that measure: their tables, from numbers of known results and from short runs."""
import pathlib
import re
import sys
import types
import unittest

import numpy

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from full import full  # noqa: E402
from test_scripts import SCRIPTS, WithFolder, load, start  # noqa: E402


class Performance(WithFolder):
    def test_tables_stand_between_their_marks(self):
        import performance_runs
        page = self.folder / "performance.md"
        page.write_text("a\n<!-- table x -->\nold\n<!-- end -->\nb\n<!-- table y -->\n<!-- end -->\n")
        keep, performance_runs.PAGE = performance_runs.PAGE, page
        self.addCleanup(setattr, performance_runs, "PAGE", keep)
        performance_runs.write_tables({"x": performance_runs.markdown_table([{"n": 3}], {"n": "cells"})})
        self.assertEqual(page.read_text(), "a\n<!-- table x -->\n| cells |\n|---|\n| 3 |\n<!-- end -->\nb\n"
                                           "<!-- table y -->\n<!-- end -->\n")
        with self.assertRaises(SystemExit):
            performance_runs.write_tables({"z": ""})
        marks = set(re.findall("<!-- table (\\w+) -->", keep.read_text()))
        self.assertEqual(marks, {"work_precision", "ablation", "rate", "paper_table1", "verbs", "two_cores",
                                 "cost_of_bodies", "small_body", "memory", "crowd", "time_steps", "capsules",
                                 "kinds_of_cells", "viscous_schemes", "race", "rigid_tubes", "cost_of_output"})

    def test_error_in_time(self):
        steps = load("studies/performance/time_steps")
        curve = lambda run: run
        fine = (numpy.arange(5.), numpy.array([0, 1, 2, 3, 4.]))
        self.assertEqual(steps.error(curve, fine, fine), 0)
        self.assertAlmostEqual(steps.error(curve, (numpy.array([0, 1.5, 4]), numpy.array([7, 1.7, 3.9])), fine), .05)
        for case in steps.CASES:
            self.assertEqual(steps.options(case)["-time_step"], "0")

    @full
    def test_membranes(self):
        made = start(SCRIPTS / "studies/performance/membranes", "--quick", "--output", self.folder).stdout
        self.assertEqual(re.findall(r"\| (solid|membranes|[\w-]+, Ca = [.\d]+, viscosity ratio [.\d]+) \|", made),
                         ["solid", "membranes", "neo-Hookean, Ca = 0.15, viscosity ratio 1", "Skalak, Ca = 0.3, viscosity ratio 5",
                          "neo-Hookean, Ca = 0.3, viscosity ratio 0.2"])
        off = [float(percent) for percent in re.findall(r"\| 4 \| ([.\d]+) % \| - \|", made)]
        self.assertEqual(len(off), 3)
        self.assertLess(max(off), 8)  # 2.4, 6.2, 5.5 at 4 cells per radius

    @full
    def test_rigid_tubes(self):
        made = start(SCRIPTS / "studies/performance/rigid_tubes", "--quick", "--output", self.folder).stdout
        rows = re.findall(r"\| (rigid|elastic)[^|]* \| [.\d]+ \| ([-+.\d]+) % \| (\d+) \|", made)
        self.assertEqual([row[0] for row in rows], ["rigid"] + ["elastic"] * 3, made)
        self.assertLess(abs(float(rows[0][1])), 3)
        self.assertTrue(all(int(row[2]) > int(rows[0][2]) for row in rows[1:]), "what is stiff takes more steps")

    @full
    def test_cost_of_output(self):
        made = start(SCRIPTS / "studies/performance/cost_of_output", "--quick", "--output", self.folder).stdout
        step = float(re.search(r"\| channel_rbc \| [^|]* \| (\d+) \| ([-.\d]+) \| ([-.\d]+) \|", made)[1])
        self.assertGreater(step, 0)

    @full
    def test_race(self):
        done = start(SCRIPTS / "studies/performance/race", "--quick", "--output", self.folder)
        rows = [line.split("  ") for line in done.stdout.splitlines()]
        self.assertEqual([row[1] for row in rows], ["fast"] * 3 + ["fast, loose"] * 3 + ["classic"] * 2 + ["classic, extrapolated"], done.stderr)
        self.assertTrue(all(0 < float(row[3]) < .01 for row in rows), done.stdout)  # um, after 2 us
        self.assertTrue((self.folder / "race.png").exists())
        race = load("studies/performance/race")
        place = lambda x: {"bodies": [{"id": 1, "species": "rbc", "centroid": [x, 3, 0]}, {"id": 2, "species": "platelet", "centroid": [0, 0, 0]}]}
        self.assertAlmostEqual(race.distance(place(1), place(20.5), 21), 1.5)  # the shorter way

    def test_table_of_verbs(self):
        table1 = load("studies/paper/paper_table1")
        run = {"bytes_per_cell": 100, "flops_per_cell": 100, "ns_per_cell": 6, "peak": 50, "triad": 25}
        text = table1.verbs_table(128, {f"{verb}/128": run for verb in table1.VERBS})
        self.assertIn("| D* by itself (fast) | 100 | 100 | 4.00 | 2.00 | 6.00 | 1.50 |", text)

    def test_table_of_two_cores(self):
        table1 = load("studies/paper/paper_table1")
        run = lambda ns, triad, peak: {f"{name}/64": {"ns_per_cell": ns, "triad": triad, "peak": peak}
                                       for name in table1.TWO_CORES}
        rounds = [[run(10, 20, 50), run(5, 30, 90), run(4, 40, 100)], [run(12, 20, 50), run(8, 40, 90), run(8, 20, 50)],
                  [run(10, 10, 50), run(10, 10, 50), run(5, 20, 100)]]
        text = table1.two_cores_table([64], rounds)
        self.assertIn("| triad | 1.50 | 2.00 |\n| peak | 1.80 | 2.00 |", text)
        self.assertIn("| RKL stage | 1.50 (100.0 %) | 2.00 (125.0 %) |", text)

    def test_the_paper_has_its_own_rate(self):
        table1 = load("studies/paper/paper_table1")
        run = {"ns_per_cell": 0.73e9 / 8.39e6, "flops_per_cell": 1, "GFlops": 1, "peak": 128, "of_peak": .5}
        text = table1.parts_table({"64/64/64": "64^3"}, *[{f"{part}/64/64/64": run for part, *_ in table1.PARTS}] * 2)
        self.assertIn(f"31.2 % | {table1.PAPER_RATE:.3f} |", text)

    def test_errors_and_times_beside_the_whole_method(self):
        tables = load("studies/performance/performance_tables")
        row = lambda setting, pressure, cells, error, seconds, dt="auto": {
            "case": "a_b", "setting": setting, "pressure": pressure, "cells": cells, "dt": dt, "error": error,
            "wall_seconds": seconds}
        rows = [row("fast", "acm", "16", ".1", "2"), row("fast", "acm", "16", ".05", "9", ".1"),
                row("classic", "smac", "32", ".2", "8"), row("fast", "acm", "32", ".02", "6")]
        text = tables.work_precision(rows)
        self.assertIn("| a b | 16 | 0.1 (1) | - | - | - |\n| a b | 32 | 0.02 (3) | - | - | 0.2 (4) |", text)
        rows = [row("complete method", "acm", "64", ".1", "2"), row("one iteration", "acm", "64", "12.04", "1")]
        self.assertIn("| complete method | 1 (1) |\n| one iteration | 120 (0.5) |", tables.ablation(rows))

    def test_thickness_of_a_dimple(self):
        """A plate 6 x 1.3 x 6 across the seam of x, askew to nothing: what the integral over phi finds."""
        spacing, cells = numpy.array([0.5, 0.25, 0.5]), (32, 48, 24)
        run = types.SimpleNamespace(
            cells=cells, spacing=spacing, length=spacing * cells, centres=lambda d: (numpy.arange(cells[d]) + 0.5) * spacing[d],
            bodies=types.SimpleNamespace(time=numpy.array([0.0]), centroid=numpy.array([[[1.0, 5.1, 6.0]]])))
        part = [numpy.clip((half - abs((run.centres(d) - c + length / 2) % length - length / 2)) / h + 0.5, 0, 1)
                for d, (half, c, h, length) in enumerate(zip((3, 0.65, 3), (1, 5.1, 6), spacing, run.length))]
        snapshot = type("Snapshot", (dict,), {"time": 0.0})
        phi = part[2][:, None, None] * part[1][:, None] * part[0]
        thickness, largest = load("studies/validation/dimple_study").middle(run, snapshot(solid_fraction=phi))
        self.assertAlmostEqual(thickness, 1.3, delta=1e-3)
        self.assertAlmostEqual(largest, 1, delta=1e-12)

    @full
    def test_cost_of_bodies(self):
        done = start(SCRIPTS / "studies/performance/cost_of_bodies", "--quick", "--only", "share", "memory", "crowd")
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = [line.strip("| ").split(" | ") for line in done.stdout.splitlines() if line.startswith("|")]
        self.assertEqual([row[1] for row in rows[2:5]], ["0.000", "0.562", "1.000"])  # half, and the cells cut
        fields = {row[0]: int(row[1].split()[0]) for row in rows if "classic" in row[0]}
        self.assertLess(fields["pure flow, classic"], fields["red cells, classic"])


if __name__ == "__main__":
    unittest.main()
