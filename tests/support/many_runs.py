"""Many short runs of the program in one start of MPI (tests/support/run_many.cpp), side by side on parts of its ranks.

Needs EULASTIC_RUN_MANY, or EULASTIC_RUN_MANY_AVX2 for `program`, and EULASTIC_MPIEXEC.
"""
import dataclasses
import json
import os
import pathlib
import subprocess

import h5py
from program import launcher



@dataclasses.dataclass
class Outcome:
    """What a run left: exit code, standard output and error, and its output directory."""
    code: int
    out: str
    err: str
    directory: pathlib.Path

    def results(self):
        """What must not depend on ranks: state hash, series.csv, and the bytes of all that bodies.h5 holds."""
        summary = json.loads((self.directory / "summary.json").read_text())
        found = {"state_hash": summary["state_hash"], "series": (self.directory / "series.csv").read_text(),
                 "bodies": summary["bodies"], "sides": summary.get("sides")}
        if summary["bodies"]:
            with h5py.File(self.directory / "bodies.h5") as bodies:
                found["measures"] = {name: bodies[name][...].tobytes() for name in bodies}
        return found


class Plan:
    """Runs that are added one by one and executed together; each takes the ranks that are least busy so far."""

    def __init__(self, room, ranks=4):
        self.room, self.ranks = pathlib.Path(room), ranks
        self.lines, self.names, self.load = [], [], [0] * ranks

    def add(self, name, *words, ranks=1, skip_nothing=False, output=True):
        """A run of these command-line words, in room/NAME unless `output` is false."""
        assert name not in self.names, name
        first = min(range(self.ranks - ranks + 1), key=lambda at: max(self.load[at:at + ranks]))
        self.load[first:first + ranks] = [max(self.load[first:first + ranks]) + 1] * ranks
        words = [str(word) for word in words] + (["-output_dir", str(self.room / name)] if output else [])
        assert not any("\t" in word or "\n" in word for word in words)
        self.lines.append("\t".join(["run", str(first), str(ranks), str(int(skip_nothing)), str(self.room / name), *words]))
        self.names.append(name)

    def wait(self):
        """What is added from here on starts when all runs before have ended."""
        self.lines.append("wait")
        self.load = [0] * self.ranks

    def execute(self, program="EULASTIC_RUN_MANY", timeout=600, cwd=None):
        """{name: Outcome}. `cwd`: the directory in which all of them run."""
        plan = self.room / "plan.txt"
        plan.write_text("\n".join(self.lines) + "\n")
        done = subprocess.run([*launcher(self.ranks), os.environ[program], str(plan)], capture_output=True, text=True, timeout=timeout,
                              stdin=subprocess.DEVNULL, cwd=cwd)
        outcomes = {}
        for name in self.names:
            text = lambda end: (self.room / (name + end)).read_text() if (self.room / (name + end)).exists() else ""
            code = text(".code")
            if not code:
                raise AssertionError(f"{name} did not end: {text('.err')}{done.stderr}")
            outcomes[name] = Outcome(int(code), text(".out"), text(".err"), self.room / name)
        if done.returncode:
            raise AssertionError(done.stderr)
        return outcomes
