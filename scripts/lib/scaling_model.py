"""Models the time of a step on many ranks from counted messages and the program's own split; nothing here is measured.

    machine, step = Machine.read("k"), Step.read("classic")
    parts = model(machine, step, Split.planned((256, 192, 160), (96, 27, 32)))
    parts["compute"], parts["latency"], parts["exchange"], parts["pack"], parts["reductions"], parts["gather"]  # s

The terms are those of LogGP (Alexandrov et al. 1995), latency and overhead of a message and bandwidth of a rank, and the time that
memory takes to pack and unpack. tools/step_counts.csv, written by scripts/studies/scaling/scaling_tables --count, holds the counts of the
inner one of 27 ranks with boxes of 32^3 cells. The bytes to neighbours across faces, edges and corners give the sums of w, w^2 and w^3 over
the fields of a step, with w the width of their layers, and these sums give the bytes of a box of any size. Data of the boxes of bodies
(`boxes` there) go to all ranks that own a part of them and have sums of their own.
"""
import collections
import csv
import dataclasses
import json
import math
import pathlib
import re
import subprocess
import sys

from communication_counts import program
from performance_runs import ENVIRONMENT, ROOT

COUNTS = ROOT / "tools/step_counts.csv"
CASE = ROOT / "options/channel_rbc.opts"
COUNTED_BOX, COUNTED_SPLIT = 32, 3
LEVEL_GATHERED = 4096  # cells: what the V-cycle gathers on every rank
LEVEL_MESSAGES = 3     # to a neighbour in a sweep, of each coarse level that is not gathered
SPACING = 21.12 / 96   # of CASE as counted
BOXES = "boxes"        # the verb of what a step sends because bodies lie in boxes of their own
# What stands on the command line of scripts/count_communication beside CASE, for the counts and for -check_only.
SETTINGS = {"fast": ["-method", "fast", "-time_step", "0.8", "-acm_tolerance", "1e-30", "-acm_iterations_max", "2"],
            "classic": ["-method", "classic", "-time_step", "0.004"]}
ASSUMPTIONS = [
    "the messages of a rank leave one after the other; nothing overlaps, and the network has no other traffic and no contention",
    "an exchange of a block of fields is one message to each neighbour and waits for one latency; the same is assumed for exchanges "
    "with the boxes of bodies, although fewer ranks share a body",
    "a body is owned by the rank that has its centre, which may be anywhere, and the data in cells of other ranks are sent; the "
    "redistribution of bodies for load balance is neglected",
    "packing and unpacking read and write every value once at both ends, at the bandwidth of the memory",
    "a reduction takes log2(ranks) rounds with the whole vector; a gather takes log2(ranks) latencies and the time of all its bytes",
    "levels of the V-cycle beyond the counted ones send three messages to a neighbour per pressure iteration, as the counted ones do; "
    "their bytes are neglected",
    "all ranks compute as long as the rank with the largest box; bodies are distributed evenly, and output is neglected",
    "fast has two pressure iterations and about twenty viscous stages in a step, as counted; the ratio of its arithmetic to that of "
    "classic is the estimate of -check_only",
]


@dataclasses.dataclass
class Machine:
    name: str
    rank: str                        # what a rank is
    classic_seconds_per_cell: float  # and step, of a rank
    latency: float                   # s
    overhead: float                  # s, for each message at each end
    bandwidth: float                 # B/s into and out of a rank
    memory_bandwidth: float          # B/s of a rank
    sources: list

    @classmethod
    def read(cls, name):
        """Reads tools/machines/NAME.json, or a file like it. Exits with one line if there is none."""
        path = next((p for p in (ROOT / f"tools/machines/{name}.json", pathlib.Path(name)) if p.is_file()), None)
        known = ", ".join(sorted(p.stem for p in (ROOT / "tools/machines").glob("*.json")))
        if not path:
            sys.stderr.write(f"--model {name}: no such machine; accepted: {known}, or a file like theirs\n")
            sys.exit(2)
        fields = [field.name for field in dataclasses.fields(cls)]
        try:
            values = json.loads(path.read_text())
            assert isinstance(values, dict) and set(values) == set(fields)
            machine = cls(**values)
            assert all(getattr(machine, key) > 0 for key in fields[2:-1])
        except (ValueError, AssertionError, TypeError):
            sys.stderr.write(f"--model {name}: {path} is no machine; accepted: JSON with {', '.join(fields)}, as in "
                             "tools/machines/k.json\n")
            sys.exit(2)
        return machine


@dataclasses.dataclass
class Moments:
    """A group of exchanges: number of messages to each neighbour in a step, and the sums of w, w^2, w^3 over their fields."""
    messages: float = 0
    w: tuple = (0, 0, 0)

    @classmethod
    def of(cls, rows):
        """`rows`: {rank: (calls, bytes)} of the inner one of 3 x 3 x 3 ranks."""
        found = collections.defaultdict(list)
        for rank, (calls, size) in rows.items():
            across = sum(d != 1 for d in (rank % 3, rank // 3 % 3, rank // 9))
            found[across].append((calls, size))
        mean = {across: [sum(column) / len(pairs) for column in zip(*pairs)] for across, pairs in found.items()}
        return cls(mean[1][0], tuple(mean[k][1] / 8 / COUNTED_BOX ** (3 - k) for k in (1, 2, 3)))


@dataclasses.dataclass
class Bodies:
    """Bodies in boxes of their own, to and from which velocities and forces are exchanged."""
    exchanges: float = 0     # in a step, of three components each
    per_cell: float = 0      # bodies for each cell of the grid
    width: tuple = (0, 0, 0)  # of the box of a body, in cells

    def elsewhere(self, split):
        """Returns the mean share of a box that lies in cells of other ranks than the one that has its centre."""
        here = 1.0
        for width, n, parts in zip(self.width, split.box, split.ranks):
            if parts > 1:
                here *= 1 - width / (4 * n) if width < 2 * n else n / width
        return 1 - here

    def bytes(self, split):
        """Returns the bytes that a rank sends for them in a step."""
        return 8 * 3 * self.exchanges * self.per_cell * math.prod(split.box) * math.prod(self.width) * self.elsewhere(split)


@dataclasses.dataclass
class Step:
    method: str
    plain: Moments       # all but those of the V-cycle and of the boxes of bodies
    cycle: Moments
    sweeps: float        # with a V-cycle
    reductions: list     # [(calls, bytes of one)]
    relative: float      # arithmetic of a cell over that of classic
    bodies: Bodies = dataclasses.field(default_factory=Bodies)

    @classmethod
    def read(cls, method, path=COUNTS):
        groups = {False: collections.defaultdict(lambda: (0, 0)), True: collections.defaultdict(lambda: (0, 0))}
        reductions, gathers = [], 0.0
        with open(path) as file:
            everything = list(csv.DictReader(file))
        rows = [row for row in everything if row["setting"] == method and row["stage"] == "Step"]
        boxes = {(row["kind"], row["partner"]): float(row["calls"]) for row in everything if row["setting"] == f"{method}_{BOXES}"}
        if not rows:
            sys.exit(f"{path}: nothing of {method}; scripts/studies/scaling/scaling_tables --count writes it")
        for row in rows:
            calls, size = float(row["calls"]), float(row["bytes"])
            if row["kind"] == "send" and row["verb"] == BOXES:
                continue
            if row["kind"] == "send":
                group, rank = groups[row["verb"] == "EulACM"], int(row["partner"])
                group[rank] = group[rank][0] + calls, group[rank][1] + size
            elif row["kind"] == "Allgatherv":
                gathers += calls
            else:
                reductions.append((calls, size / calls))
        plain, cycle = (Moments.of(group) if group else Moments() for group in (groups[False], groups[True]))
        bodies = Bodies(boxes["exchanges", "0"], boxes["bodies", "0"] / (COUNTED_BOX * COUNTED_SPLIT) ** 3,
                        tuple(boxes["width", str(d)] for d in range(3))) if boxes else Bodies()
        return cls(method, plain, cycle, gathers, reductions, estimate(method) / estimate("classic"), bodies)


@dataclasses.dataclass
class Split:
    cells: tuple
    ranks: tuple   # along x, y, z
    box: tuple     # the largest one

    @classmethod
    def planned(cls, box, along, by_hand=True):
        """Returns the program's split of along * box cells: into `along` ranks, or, unless `by_hand`, its own choice for the same
        number of ranks."""
        return cls.of([n * p for n, p in zip(box, along)], math.prod(along), along if by_hand else None)

    @classmethod
    def of(cls, cells, ranks, along=None):
        hand = [word for d, p in zip("xyz", along) for word in (f"-da_processors_{d}", str(p))] if along else []
        text = check(cells, ["-ranks", str(ranks), *hand])
        numbers = lambda pattern: tuple(map(int, re.search(pattern, text, re.M).groups()))
        parts = numbers(r"^ranks: (\d+) x (\d+) x (\d+) = ")
        most = numbers(r"^largest box of a rank: (\d+) x (\d+) x (\d+) ") if ranks > 1 else tuple(cells)
        return cls(tuple(cells), parts, most)

    @property
    def count(self):
        return math.prod(self.ranks)

    @property
    def neighbours(self):
        return math.prod(min(p, 3) for p in self.ranks) - 1

    @property
    def unevenness(self):
        return math.prod(self.box) * self.count / math.prod(self.cells)

    def bytes(self, w):
        """Returns the bytes that a rank sends for fields whose layers have these sums of w, w^2, w^3."""
        cut = [p > 1 for p in self.ranks]
        sides = [[n, 0] if not c else [n, 2] for n, c in zip(self.box, cut)]  # along the box, or one of two ends
        total = 0.0
        for ends in ((x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)):
            if sum(ends):
                total += math.prod(side[end] for side, end in zip(sides, ends)) * w[sum(ends) - 1]
        return 8 * total


def check(cells, words):
    """Returns the output of -check_only for CASE with this number of cells, at the spacing of CASE as counted."""
    line = [str(program()), str(CASE), "-grid_cells", ",".join(map(str, cells)), "-grid_length",
            ",".join(f"{n * SPACING:.9g}" for n in cells), "-rbc_count", "1,1,1", "-check_only", *words]
    done = subprocess.run(line, capture_output=True, text=True, env=ENVIRONMENT)
    if done.returncode:
        sys.exit(done.stderr.strip())
    return done.stdout


def estimate(method):
    """Returns the estimated microseconds per cell and step on a core."""
    return float(re.search(r"([\d.e+-]+) us per cell, step and core", check((96, 96, 96), SETTINGS[method]))[1])


def shared_levels(cells):
    """Returns the number of levels of the V-cycle above the one that every rank holds."""
    return max(0, math.ceil(math.log(math.prod(cells) / LEVEL_GATHERED, 8) - 1e-9))


def more_messages(step, split):
    """Returns the messages to a neighbour of the levels of the V-cycle beyond those counted."""
    return LEVEL_MESSAGES * step.sweeps * (shared_levels(split.cells) - shared_levels([COUNTED_BOX * COUNTED_SPLIT] * 3))


def exchanges(machine, split, messages, size):
    """Returns {part: seconds} of this number of messages to each neighbour, with `size` bytes in all."""
    return {"latency": messages * (machine.latency + 2 * machine.overhead * split.neighbours),
            "exchange": size / machine.bandwidth, "pack": 4 * size / machine.memory_bandwidth}


def model(machine, step, split):
    """Returns {part of a step: seconds}; their sum is the time of the step."""
    parts = {"compute": math.prod(split.box) * machine.classic_seconds_per_cell * step.relative}
    if split.count == 1:
        return parts
    messages = step.plain.messages + step.bodies.exchanges + step.cycle.messages + more_messages(step, split)
    rounds = (split.count - 1).bit_length()  # the logarithm to base 2, rounded up
    hop = machine.latency + 2 * machine.overhead
    gathered = 8 * math.prod(split.cells) / 8 ** shared_levels(split.cells)
    size = split.bytes(step.plain.w) + split.bytes(step.cycle.w) + step.bodies.bytes(split)
    parts.update(exchanges(machine, split, messages, size))
    parts["reductions"] = sum(calls * rounds * (hop + bytes / machine.bandwidth) for calls, bytes in step.reductions)
    parts["gather"] = step.sweeps * (rounds * hop + gathered / machine.bandwidth)
    return parts
