"""What ranks send: the list of the rank in the middle, which does not depend on how many there are; which collectives
grow with ranks or bodies.

Needs EULASTIC, EULASTIC_MPIEXEC and EULASTIC_COUNT_LIBRARY. EULASTIC_RANKS: 27 (the default) or 64.
"""
import functools
import os
import pathlib
import re
import sys
import unittest

sys.path[:0] = [str(pathlib.Path(__file__).resolve().parents[2] / "scripts/lib")]
sys.dont_write_bytecode = True
from communication_counts import ROOT, Counting, Counts  # noqa: E402
from test_scripts import SCRIPTS, start  # noqa: E402

RANKS = int(os.environ.get("EULASTIC_RANKS", 27))
STEPS = 4
METHODS = {"fast": ["-method", "fast", "-time_step", "0.5", "-acm_tolerance", "1e-30", "-acm_iterations_max", "2"],
           "classic": ["-method", "classic", "-time_step", "0.02"]}

# 8^3 for each rank of 27 or 64, and what the V-cycle gathers: one level coarser, 8 B for a cell.
CELLS = 8 * round(RANKS ** (1 / 3))
GATHERED = CELLS ** 3
# Stage Step of four steps, a body across all sides of the rank in the middle: {(verb, kind): (calls, bytes, largest)}.
KNOWN = {
    "fast": {
        ("", "Allreduce"): (8, 176, 40),
        ("", "send"): (936, 3030344, 12288),
        ("EulACM", "Allgatherv"): (6, 6 * GATHERED, GATHERED),
        ("EulACM", "Allreduce"): (10, 38080, 3808),
        ("EulACM", "send"): (1144, 167072, 1024),
        ("EulViscous", "send"): (364, 364904, 3072),
    },
    "classic": {
        ("", "Allreduce"): (5, 56, 40),
        ("", "send"): (572, 782664, 9216),
        ("EulACM", "Allreduce"): (4, 13056, 3264),
    },
}
# A message to each of 26 neighbours; in EulViscous two messages to each are under way together in every step.
EXCHANGES = {"fast": {"": 936 // 26, "EulACM": 1144 // 26, "EulViscous": 364 // 26 - STEPS}, "classic": {"": 572 // 26}}
# PETSc finds out who sends to whom with a barrier, at the first use of a width and a number of fields on a grid.
ONCE = {"fast": {("", "Barrier"): (1, 0, 0), ("EulACM", "Barrier"): (4, 0, 0), ("EulViscous", "Barrier"): (1, 0, 0)},
        "classic": {("", "Barrier"): (1, 0, 0)}}

# Bytes for each rank in the largest collective: what the DMDA gathers when it is made.
GROW_WITH_RANKS = {("Main Stage", "", "Allgather"): 4}
# The largest of eight ranks with one body, on the grid, and with eight, in boxes. Barriers: who sends to whom
# where there are several bodies, which may overlap or be near.
GROW_WITH_BODIES = {
    ("Main Stage", "", "Barrier"): (None, 0),
    ("Setup", "", "Allgather"): (None, 16 * 8),  # what each rank has to do: bodies are shared out
    ("Setup", "", "Allreduce"): (4, 16),  # whether all boxes still fit, and where strain was lost
}
LARGEST = 65536


@functools.lru_cache(maxsize=None)
def inner(method, along, bodies="1,1,1"):
    """Counts of the rank in the middle of along^3 ranks."""
    split = [word for d in "xyz" for word in (f"-da_processors_{d}", along)]
    run = Counting([ROOT / "options/channel_rbc.opts", "-grid_cells", f"{CELLS},{CELLS},{CELLS}", "-rbc_count", bodies,
                    *split, *METHODS[method]], along ** 3)
    return run.run(STEPS)[run.inner]


def largest(counts):
    """{(stage, verb, kind of a collective): bytes}."""
    found = {}
    for (stage, verb, kind, _), (_, _, size) in counts.collectives().items():
        found[stage, verb, kind] = max(size, found.get((stage, verb, kind), 0))
    return found


class Communication(unittest.TestCase):
    maxDiff = None
    along = round(RANKS ** (1 / 3))

    def test_the_rank_in_the_middle(self):
        for method, known in KNOWN.items():
            with self.subTest(method=method):
                counts = inner(method, self.along).of("Step")
                self.assertEqual(counts.neighbours, 26)
                self.assertEqual({verb: calls for (_, verb), calls in counts.begun.items()}, EXCHANGES[method])
                found = {(verb, kind): value for (_, verb, kind, _), value in counts.by_verb().items()}
                self.assertEqual(found, {**known, **ONCE[method]})

    def test_collectives_that_grow_with_ranks(self):
        few, many = largest(inner("fast", 2)), largest(inner("fast", self.along))
        self.assertEqual(set(few), set(many))
        grows = {key: (few[key] / 8, many[key] / RANKS) for key in many if many[key] > few[key]}
        self.assertEqual(grows, {key: (size, size) for key, size in GROW_WITH_RANKS.items()})

    @unittest.skipUnless(RANKS == 27, "how many phases there are depends on the grid")
    def test_collectives_that_grow_with_bodies(self):
        one, eight = largest(inner("fast", 2)), largest(inner("fast", 2, "2,2,2"))
        self.assertEqual({key: (one.get(key), size) for key, size in eight.items() if size != one.get(key)},
                         GROW_WITH_BODIES)

    def test_collectives_are_small(self):
        for counts in (inner("fast", self.along), inner("classic", self.along), inner("fast", 2, "2,2,2")):
            self.assertLessEqual(max(largest(counts).values()), LARGEST)


class Script(unittest.TestCase):
    def test_two_ranks(self):
        done = start(SCRIPTS / "count_communication", ROOT / "options/channel_rbc.opts", "-grid_cells", "16,16,16",
                     "-method", "classic", "-pressure_solver", "acm", "-rbc_count", "1,1,1", "--ranks", 2, "--steps",
                     "2,4")
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = [line.split() for line in done.stdout.splitlines() if re.match(r" +(least|inner|most) \(", line)]
        self.assertEqual([row[0] for row in rows], ["least", "inner", "most"])
        neighbours, exchanges, collectives = zip(*(map(float, row[-3:]) for row in rows))
        self.assertEqual(set(neighbours), {1})
        # Three layers of velocity, phi and B, one of v* and D*: each an exchange with one message.
        messages = {float(row[2]) for row in rows}
        self.assertEqual((messages, set(exchanges)), ({5.0}, {5.0}), done.stdout)
        self.assertRegex(done.stdout, rf"\n  exchanges and collectives of the rank that has most: {5 + collectives[0]:g} \(")

    def test_what_it_refuses(self):
        case = ROOT / "options/channel_rbc.opts"
        for words, reason in (((case,), "--ranks"), ((case, "--ranks", 0), "--ranks 0"),
                              (("no.opts", "--ranks", 2), "no.opts"),
                              ((case, "--ranks", 2, "--steps", "4,2"), "--steps 4,2"),
                              ((case, "--ranks", 2, "-grid_cels", "8"), "-grid_cels")):
            done = start(SCRIPTS / "count_communication", *words)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(reason, done.stderr)

    def test_difference_of_two_runs(self):
        key, late = ("Step", "", "send", "1"), ("Step", "EulACM", "Allreduce", "8")
        begun, verb = ("Step", ""), ("Step", "EulACM")
        before = Counts({key: (10, 100, 10)}, begun={begun: 4})
        after = Counts({key: (30, 180, 20), late: (2, 16, 8)}, begun={begun: 10, verb: 2})
        self.assertEqual(after.per_step(before, 2).rows, {key: (10, 40, 20), late: (1, 8, 8)})
        self.assertEqual(after.per_step(before, 2).begun, {begun: 3, verb: 1})
        self.assertEqual((after.exchanges, after.of("Output").exchanges), (12, 0))
        self.assertEqual(after.per_step(after, 2).rows, {})


if __name__ == "__main__":
    unittest.main()
