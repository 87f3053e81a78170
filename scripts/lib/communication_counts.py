"""Counts what ranks send in a time step, with tools/count_communication.cpp.

    run = Counting(["options/channel_rbc.opts", "-method", "classic"], ranks=8)
    counts = run.per_step(2, 4)
    counts[run.inner].messages, counts[run.inner].neighbours, counts[run.inner].exchanges
    counts[run.inner].collectives()
"""
import collections
import csv
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

from performance_runs import ENVIRONMENT, ROOT, on_ranks

STEP = ("Step", "")  # the empty one: a PETSc whose stages the library does not know
EXCHANGE = "exchange"  # a kind
KEYS = "stage", "verb", "kind", "partner"


def program():
    return os.environ.get("EULASTIC", ROOT / "build/release/eulastic")


def library():
    """Returns the path of the counting library; builds it if it is missing."""
    path = pathlib.Path(os.environ.get("EULASTIC_COUNT_LIBRARY", ROOT / "build/release/libcount_communication.so"))
    if not path.exists():
        subprocess.run([ROOT / "scripts/build", "release", "count_communication"], check=True, stdout=sys.stderr)
    return path


class Counts:
    """Counts of one rank: rows is {(stage, verb, kind, partner): (calls, bytes, largest)} for any number of steps, begun is {(stage,
    verb): number of exchanges that the rank began}, seconds is the time in collectives of stage Step."""

    def __init__(self, rows, seconds=0.0, begun=None):
        self.rows, self.seconds, self.begun = rows, seconds, begun or {}

    @classmethod
    def read(cls, path):
        with open(path) as file:
            rows = list(csv.DictReader(file))
        return cls({tuple(row[key] for key in KEYS): tuple(int(row[key]) for key in ("calls", "bytes", "largest"))
                    for row in rows if row["kind"] != EXCHANGE},
                   sum(float(row["seconds"]) for row in rows if row["stage"] == STEP[0]),
                   {(row["stage"], row["verb"]): int(row["calls"]) for row in rows if row["kind"] == EXCHANGE})

    def per_step(self, before, steps):
        """Returns the means over the `steps` steps by which this run is longer than the run `before`."""
        rows = {}
        for key, (calls, size, largest) in self.rows.items():
            earlier = before.rows.get(key, (0, 0, 0))
            if calls > earlier[0]:
                rows[key] = ((calls - earlier[0]) / steps, (size - earlier[1]) / steps, largest)
        begun = {key: (calls - before.begun.get(key, 0)) / steps for key, calls in self.begun.items()}
        return Counts(rows, begun={key: calls for key, calls in begun.items() if calls > 0})

    def of(self, *stages):
        return Counts({key: value for key, value in self.rows.items() if key[0] in stages},
                      begun={key: calls for key, calls in self.begun.items() if key[0] in stages})

    def _sends(self):
        return {key: value for key, value in self.rows.items() if key[2] == "send"}

    @property
    def messages(self):
        return sum(calls for calls, _, _ in self._sends().values())

    @property
    def bytes(self):
        return sum(size for _, size, _ in self._sends().values())

    @property
    def largest(self):
        return max((largest for _, _, largest in self._sends().values()), default=0)

    @property
    def exchanges(self):
        """Number of exchanges with neighbours: everything that is begun before a rank waits for a message counts as one. Collectives
        are not included."""
        return sum(self.begun.values())

    @property
    def neighbours(self):
        return len({key[3] for key in self._sends()})

    def by_verb(self):
        """Returns {(stage, verb, kind, ranks, or 0 for sends): (calls, bytes, largest)}."""
        table = collections.defaultdict(lambda: (0, 0, 0))
        for (stage, verb, kind, partner), (calls, size, largest) in self.rows.items():
            key = stage, verb, kind, 0 if kind == "send" else int(partner)
            earlier = table[key]
            table[key] = (earlier[0] + calls, earlier[1] + size, max(earlier[2], largest))
        return dict(sorted(table.items()))

    def collectives(self):
        """Returns {(stage, verb, kind, ranks of the communicator): (calls, bytes, largest)}."""
        return {key: value for key, value in self.by_verb().items() if key[2] != "send"}


class Counting:
    def __init__(self, case, ranks):
        """`case`: the command line, that is, files and options. Exits with the program's message if the program refuses it."""
        self.case, self.ranks = [str(word) for word in case], ranks
        check = subprocess.run([program(), *self.case, "-check_only", "-ranks", str(ranks)], capture_output=True,
                               text=True, env=ENVIRONMENT)
        if check.returncode:
            sys.stderr.write(check.stderr)
            sys.exit(check.returncode)
        self.report = check.stdout
        found = re.search(r"^ranks: (\d+) x (\d+) x (\d+) = ", self.report, re.M)
        self.split = tuple(map(int, found.groups())) if found else (1, 1, 1)

    @property
    def inner(self):
        """The rank in the middle of the decomposition."""
        x, y, z = self.split
        return x // 2 + x * (y // 2 + y * (z // 2))

    def run(self, steps):
        """Returns [Counts of every rank] of a whole run with this number of steps."""
        with tempfile.TemporaryDirectory() as folder:
            room = pathlib.Path(folder)
            (room / "counts").mkdir()
            command = on_ranks(self.ranks, [program(), *self.case, "-time_steps_max", steps, "-output_dir",
                                            room / "run"])
            environment = dict(ENVIRONMENT, EULASTIC_COUNT=str(room / "counts"), LD_PRELOAD=str(library()))
            done = subprocess.run(command, capture_output=True, text=True, env=environment)
            if done.returncode:
                sys.exit(f"{shlex.join(command)}\n{done.stdout}{done.stderr}")
            taken = re.search(r"step (\d+);", done.stdout.splitlines()[-1])
            if not taken or int(taken[1]) != steps:
                sys.exit(f"the run did not take {steps} steps: {done.stdout.splitlines()[-1]}")
            return [Counts.read(room / f"counts/{rank}.csv") for rank in range(self.ranks)]

    def per_step(self, first, last):
        """Returns [Counts of every rank] per step: those of `last` steps less those of `first` steps."""
        before, after = self.run(first), self.run(last)
        return [a.per_step(b, last - first) for a, b in zip(after, before)]
