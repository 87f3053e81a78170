"""scripts/studies/paper/paper_figure5 and paper_figure6: models by hand, what pictures say of them, and real runs."""
import contextlib
import csv
import dataclasses
import io
import os
import shutil
import sys
import unittest

import matplotlib.pyplot

sys.dont_write_bytecode = True
from test_scripts import SCRIPTS, WithFolder, load, start  # noqa: E402
import scaling_figures  # noqa: E402
from scaling_model import COUNTED_BOX, COUNTS, Bodies, Machine, Moments, Split, Step, model  # noqa: E402


class Model(unittest.TestCase):
    split = Split((1024, 64, 64), (4, 4, 4), (256, 16, 16))

    def test_bytes_are_those_of_the_layers(self):
        for width in (1, 3):
            around = (256 + 2 * width) * (16 + 2 * width) ** 2 - 256 * 16 ** 2
            self.assertEqual(self.split.bytes((width, width ** 2, width ** 3)), 8 * around)
        whole_x = Split((256, 64, 64), (1, 4, 4), (256, 16, 16))
        self.assertEqual(whole_x.bytes((2, 4, 8)), 8 * 256 * (20 ** 2 - 16 ** 2))
        self.assertEqual((self.split.neighbours, whole_x.neighbours), (26, 8))

    def test_layers_are_found_in_counts(self):
        rows = {}
        for rank in set(range(27)) - {13}:
            across = sum(d != 1 for d in (rank % 3, rank // 3 % 3, rank // 9))
            rows[rank] = 3, 8 * sum(w ** across * COUNTED_BOX ** (3 - across) for w in (1, 3, 3))
        self.assertEqual(Moments.of(rows), Moments(3, (7, 19, 55)))

    def test_counts_that_are_stored(self):
        classic, fast = Step.read("classic"), Step.read("fast")
        # Three layers of velocity, phi and B, and one of v* and D*: five exchanges of blocks.
        self.assertEqual(classic.plain, Moments(5, (10 * 3 + 4, 10 * 9 + 4, 10 * 27 + 4)))
        self.assertEqual((classic.cycle.messages, classic.sweeps, fast.sweeps), (0, 0, 2))
        # Bodies lie in boxes: three layers of velocity, one of v* and of a pressure are left outside of verbs.
        viscous = Moments(11, (66, 132, 264))
        self.assertEqual(fast.plain, Moments(3 + viscous.messages, (3 * 3 + 4 + 66, 3 * 9 + 4 + 132, 3 * 27 + 4 + 264)))
        self.assertEqual(classic.bodies, Bodies())

    def test_boxes_of_bodies_that_are_stored(self):
        bodies = Step.read("fast").bodies
        self.assertEqual((bodies.exchanges, bodies.per_cell), (3, 16 / 96 ** 3))
        with open(COUNTS) as file:
            counted = next(float(row["bytes"]) for row in csv.DictReader(file)
                           if row["setting"] == "fast_boxes" and row["kind"] == "send")
        # With fewer bodies than ranks some have gone to ranks far from their centre.
        split = Split((96,) * 3, (3,) * 3, (COUNTED_BOX,) * 3)
        self.assertLess(bodies.bytes(split), counted)
        self.assertLess(counted, bodies.bytes(split) / bodies.elsewhere(split))

    def test_boxes_of_bodies_by_hand(self):
        bodies = Bodies(2, 1 / 1000, (8, 4, 40))
        # A centre anywhere in a rank leaves 1 - 8/64 of 8 cells in its 16, and 16 of 40 at most in 16.
        self.assertAlmostEqual(bodies.elsewhere(self.split), 1 - (1 - 8 / 1024) * (1 - 4 / 64) * 16 / 40, delta=1e-12)
        whole_x = Split((256, 64, 64), (1, 1, 4), (256, 64, 16))
        self.assertAlmostEqual(bodies.bytes(whole_x), 48 * 262.144 * 1280 * (1 - 16 / 40), delta=1e-6)
        machine = Machine("m", "r", 1e-6, 1e-5, 1e-6, 1e9, 4e9, [])
        step = Step("fast", Moments(), Moments(), 0, [], 1)
        without = model(machine, step, self.split)
        parts = model(machine, dataclasses.replace(step, bodies=bodies), self.split)
        self.assertAlmostEqual(parts["latency"] - without["latency"], 2 * (1e-5 + 2e-6 * 26), delta=1e-12)
        self.assertAlmostEqual(parts["exchange"] - without["exchange"], bodies.bytes(self.split) / 1e9, delta=1e-12)

    def test_parts_by_hand(self):
        machine = Machine("m", "r", 1e-6, 1e-5, 1e-6, 1e9, 4e9, [])
        step = Step("fast", Moments(2, (2, 2, 2)), Moments(1, (1, 1, 1)), 2, [(3, 1000)], 2)
        parts = model(machine, step, self.split)
        # The V-cycle has a level more than counted: three messages in each of two sweeps.
        size, hop = self.split.bytes((3, 3, 3)), 1.2e-5
        expected = {"compute": 2e-6 * 65536, "latency": (3 + 6) * (1e-5 + 2e-6 * 26), "exchange": size / 1e9,
                    "pack": size / 1e9, "reductions": 3 * 6 * (hop + 1e-6), "gather": 2 * (6 * hop + 8 * 1024 / 1e9)}
        self.assertEqual(set(parts), set(expected))
        for part, seconds in expected.items():
            self.assertAlmostEqual(parts[part], seconds, delta=1e-12, msg=part)
        alone = Split((64, 64, 64), (1, 1, 1), (64, 64, 64))
        self.assertEqual(model(machine, step, alone), {"compute": 2e-6 * 64 ** 3})

    def test_cubic_splits(self):
        self.assertEqual(scaling_figures.along(8, (256, 64, 64)), (2, 2, 2))
        self.assertEqual(scaling_figures.along(8, (64, 64, 64)), (1, 2, 4))


class Skeleton(WithFolder):
    def test_it_sends_what_was_counted(self):
        script = load("studies/scaling/simulate_scaling")
        self.assertTrue(script.counted("classic", self.folder))
        right = script.lines_of("classic")
        script.lines_of = lambda _: right[1:]
        with contextlib.redirect_stdout(io.StringIO()) as said:
            self.assertFalse(script.counted("classic", self.folder))
        self.assertEqual(said.getvalue().count("counted"), 1)

    @unittest.skipUnless(shutil.which("smpicc"), "needs SimGrid: scripts/install --simgrid")
    def test_simulated_network(self):
        machine = Machine.read("k")  # arithmetic is most of it
        rows = list(load("studies/scaling/simulate_scaling").table(machine, "classic", (27, 64)))
        self.assertEqual([row[0] for row in rows], [27, 64])
        for _, simulated, modelled in rows:
            self.assertGreater(simulated, COUNTED_BOX ** 3 * machine.classic_seconds_per_cell)
            self.assertLess(simulated, modelled)  # rounds overlap in the network, not in the model


class Pictures(WithFolder):
    def test_nothing_modelled_looks_measured(self):
        figure = load("studies/paper/paper_figure5").FIGURE
        rows = [{"method": "fast", "ranks": ranks, "seconds_per_step": 1.0} for ranks in (1, 2)]
        machine = Machine("M", "r", 1, 1, 1, 1, 1, [])
        models = [(machine, method, [(Split((64,) * 3, (1, 1, p), (64,) * 3), {"compute": 1}) for p in (1, 2)])
                  for method in ("fast", "classic")]
        scaling_figures.draw(figure, rows, models, self.folder / "x.png")
        axes = matplotlib.pyplot.gcf().axes[0]
        self.assertIn("model", axes.get_title())
        labels = [text.get_text() for text in axes.get_legend().get_texts()]
        self.assertEqual(len(labels), 3)
        for line, label in zip(axes.get_lines(), labels):
            is_model = label.startswith("model, not measured")
            self.assertEqual(is_model, not label.startswith("measured"))
            self.assertEqual(line.get_linestyle() != "-", is_model)
            self.assertEqual(line.get_marker() == "None", is_model)
            self.assertEqual(line.get_color() in ("0.5", "0.7"), is_model)

    def test_model_prints_what_it_assumes(self):
        done = start(SCRIPTS / "studies/paper/paper_figure5", "--model", "k", "--output", self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        for word in ("Assumed:", "MODEL, not measured", "(assumed)", "ms a step are not explained", "82944"):
            self.assertIn(word, done.stdout)
        self.assertTrue((self.folder / "paper_figure5.png").exists())

    def test_real_runs(self):
        done = start(SCRIPTS / "studies/paper/paper_figure5", "--measure", "--ranks", "1,2", "--box", "32,32,32", "--steps", 2,
                     "--output", self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.folder / "paper_figure5.csv") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([(row["method"], row["ranks"], row["cells"]) for row in rows],
                         [(method, ranks, cells) for method in ("fast", "classic")
                          for ranks, cells in (("1", "32768"), ("2", "65536"))])
        for row in rows:
            exchange, wait, reductions = (float(row[key]) for key in ("exchange", "wait", "reductions"))
            self.assertEqual(exchange > 0 and reductions > 0, row["ranks"] == "2")
            self.assertTrue(0 <= wait <= exchange <= 1 and reductions <= 1, row)

    def test_job(self):
        job = self.folder / "job.sh"
        done = start(SCRIPTS / "studies/paper/paper_figure6", "--job", job, "--ranks", "4,8", "--cells", "256,64,64", "-threads", 2)
        self.assertEqual(done.returncode, 0, done.stderr)
        text = job.read_text()
        self.assertIn("#SBATCH --ntasks=8", text)
        self.assertIn("scripts/studies/paper/paper_figure6 --measure --ranks 4,8 --steps 10", text)
        self.assertIn("--cells 256,64,64 -threads 2", text)
        self.assertEqual(start("bash", "-n", job).returncode, 0)

    def test_slurm_starts_ranks(self):
        os.environ["SLURM_JOB_ID"] = "1"
        self.addCleanup(os.environ.pop, "SLURM_JOB_ID")
        keep = os.environ.pop("EULASTIC_MPIEXEC", None)
        if keep:
            self.addCleanup(os.environ.__setitem__, "EULASTIC_MPIEXEC", keep)
        self.assertEqual(scaling_figures.launch(8, ["program", "-x"]), ["srun", "-n", "8", "program", "-x"])

    def test_refusals(self):
        (self.folder / "bad.json").write_text('{"name": "x"}')
        for words, reason in (((), "nothing to do"), (("--model", "nowhere"), "accepted: hdr, k, or"),
                              (("--model", self.folder / "bad.json"), "is no machine"),
                              (("--measure", "--ranks", "0"), "--ranks"), (("--measure", "--box", "8,8"), "--box")):
            done = start(SCRIPTS / "studies/paper/paper_figure5", *words, "--output", self.folder / "none")
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(reason, done.stderr)
            self.assertFalse((self.folder / "none").exists())


class Node(WithFolder):
    node = load("studies/scaling/node")

    def row(self, part, method, ranks, seconds, speed_up, wait=.25):
        return {"part": part, "case": part, "cells": "4x2x2", "method": method, "ranks": ranks, "threads": 1, "seconds_per_step": seconds,
                "ns_per_cell_step": 1, "speed_up": speed_up, "exchange": .5, "wait": wait}

    def test_table_by_hand(self):
        rows = self.node.add_ceilings([self.row("copies", "fast", 1, .5, 1), self.row("copies", "fast", 4, .625, 3.2),
                                       self.row("weak", "fast", 1, .5, 1), self.row("weak", "fast", 4, .8, 2.5),
                                       self.row("capillary_h20", "classic", 1, 2, 1), self.row("capillary_h20", "classic", 4, 1, 2)])
        self.assertEqual([row["of_ceiling"] for row in rows], [1, 1, 1, 2.5 / 3.2, "", ""])
        self.assertEqual(self.node.table(rows).splitlines(), [
            "| case | cells | method | ms a step on 1 rank | speed-up on 4 | of the copies' speed-up on 4 | waiting on 4 |",
            "|---|---|---|---|---|---|---|",
            "| copies | 4 x 2 x 2 a rank | fast | 500 | 3.20 | - | - |",
            "| weak | 4 x 2 x 2 a rank | fast | 500 | 2.50 | 78% | 25% |",
            "| capillary_h20 | 4 x 2 x 2 | classic | 2000 | 2.00 | - | 25% |"])
        page = self.folder / "scaling.md"
        shutil.copy(self.node.PAGE, page)
        self.node.write_tables({"node": self.node.table(rows)}, page, "Made with this.")
        self.assertIn("| 78% | 25% |\n| capillary_h20 | 4 x 2 x 2 | classic | 2000 | 2.00 | - | 25% |\n\nMade with this.\n<!-- end -->",
                      page.read_text())

    def test_speed_ups_are_of_work_done(self):
        # Medians on one, two and four ranks: 8, 5 and 2 s a step; copies and weak scaling have twice and four times the cells.
        found = {(4, 1): [(2, .5, .25)] * 3, (1, 1): [(8, 0, 0)] * 3, (2, 1): [(9, .5, .25), (5, .6, .4), (4, .7, .1)]}
        for part, expected in ("channel_rbc", [1, 1.6, 4]), ("weak", [1, 3.2, 16]), ("copies", [1, 3.2, 16]):
            rows = self.node.rows_of(self.node.Series(part, "fast", (8, 4, 4), 3), found)
            self.assertEqual([row["speed_up"] for row in rows], expected)
            self.assertEqual([(row["exchange"], row["wait"]) for row in rows], [(0, 0), (.6, .25), (.5, .25)])
        later = self.node.rows_of(self.node.Series("weak", "fast", (8, 4, 4), 3), {(n, 1): found[n, 1] for n in (2, 4)})
        self.assertEqual([row["speed_up"] for row in later], [2, 10])
        self.assertEqual([row["ns_per_cell_step"] for row in later], [1e9 * 5 / 256, 1e9 * 2 / 512])

    def test_ranks_times_threads(self):
        series = self.node.Series("hybrid", "fast", (8, 4, 4), 3, "capillary_h20")
        self.assertEqual(series.shapes([1, 2, 4]), [(4, 1), (2, 2), (1, 4)])
        self.assertEqual(series.shapes([1, 6]), [(6, 1), (3, 2)])
        rows = self.node.rows_of(series, {(4, 1): [(1, .5, .2)], (2, 2): [(2, 0, 0)], (1, 4): [(.5, 0, 0)]})
        self.assertEqual([row["speed_up"] for row in rows], [4, 2, 8])
        self.assertEqual(self.node.table(rows), "")
        self.assertEqual(self.node.hybrid_table(rows).splitlines(), [
            "| ms a step | cells | 4 x 1 | 2 x 2 | 1 x 4 |", "|---|---|---|---|---|", "| capillary_h20 | 8 x 4 x 4 | 1000 | 2000 | 500 |"])

    def test_what_it_refuses(self):
        cores = len(self.node.cores())
        for words, reason in ((["--ranks", f"1,{cores + 1}"], f"this machine has {cores} cores that can be used; accepted: at most {cores}"),
                              (["--ranks", "0,1"], "numbers from 1 on"), (["--ranks", "1;2"], "numbers from 1 on"),
                              (["--steps", "0"], "--steps: 0: accepted"), (["--only", "nothing"], "--only"),
                              (["--write", "--quick"], "--write: accepted without --quick"),
                              (["--write", "--ranks", cores + 1, "--oversubscribe"], "--write: accepted without --quick")):
            done = start(SCRIPTS / "studies/scaling/node", *words, "--csv", self.folder / "x.csv")
            self.assertEqual((done.returncode, done.stdout), (2, ""), words)
            self.assertIn(reason, done.stderr)
        self.assertFalse((self.folder / "x.csv").exists())

    def test_real_runs(self):
        done = start(SCRIPTS / "studies/scaling/node", "--quick", "--ranks", "2,1", "--steps", 1, "--method", "classic", "--only", "copies",
                     "weak", "channel_rbc", "hybrid", "--csv", self.folder / "new/x.csv", *["--oversubscribe"] * (len(self.node.cores()) < 2))
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.folder / "new/x.csv") as file:
            self.assertRegex(next(file), r"^# Made with eulastic .* cores? could be used, of \d+ GB of memory; load ")
            rows = list(csv.DictReader(file))
        self.assertEqual([(row["part"], row["cells"], row["ranks"]) for row in rows],
                         [(part, "32x32x32", ranks) for part in ("copies", "weak", "channel_rbc") for ranks in "12"])
        for row in rows:
            seconds, speed_up, ceiling, exchange, wait = (float(row[key]) for key in (
                "seconds_per_step", "speed_up", "of_ceiling", "exchange", "wait"))
            self.assertGreater(seconds, 0)
            self.assertEqual(speed_up == ceiling == 1, row["ranks"] == "1" or (row["part"] == "copies" and speed_up == 1))
            self.assertEqual(exchange > 0, row["ranks"] == "2" and row["part"] != "copies")
            self.assertTrue(0 <= wait <= exchange, row)
        self.assertEqual(len([line for line in done.stdout.splitlines() if line.startswith("| ")]), 4)
        self.assertIn("of the copies' speed-up on 2", done.stdout)

    def test_real_hybrid_runs(self):
        done = start(SCRIPTS / "studies/scaling/node", "--quick", "--ranks", "2", "--steps", 1, "--only", "hybrid", "--csv", self.folder / "x.csv",
                     *["--oversubscribe"] * (len(self.node.cores()) < 2))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"\A\| ms a step \| cells \| 2 x 1 \| 1 x 2 \|\n\|(---\|)+\n(\| [^|]+\| [^|]+\| [\d.]+ \| [\d.]+ \|\n){3}")


if __name__ == "__main__":
    unittest.main()
