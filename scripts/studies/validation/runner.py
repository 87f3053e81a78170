"""Runs the program for the cases. A finished run is kept, under a key of its options, its file and the results of the program; an
interrupted run continues from its last checkpoint."""
import collections
import hashlib
import json
import os
import re
import shutil
import subprocess
import tempfile
import threading

import h5py
import program_environment  # noqa: F401
from eulastic import Run
from results import identity

from .case import ROOT


class Failed(Exception):
    """A run that did not end as it should; the text is the program's own line."""


class Runner:
    def __init__(self, program, work):
        self.program, self.work = program, work
        self.identity = identity(program)
        self.busy = collections.defaultdict(threading.Lock)  # of a directory: cases may share a run
        self.environment = {name: value for name, value in os.environ.items() if name != "PETSC_OPTIONS"}

    def command(self, case, setting, key, folder, more):
        options = {"method": setting.method, "pressure_solver": setting.solver, **case.options(key, folder),
                   **setting.options, **more}
        if case.start:
            options["initial_state"] = self.written(case.start(key))
        words = [word for name, value in options.items() for word in (f"-{name}", str(value))]
        file = ROOT / "options" / f"{case.file}.opts"
        text = json.dumps([self.identity, file.read_text(), words])
        tail = re.sub(r"\W+", "_", f"{case.name}_{setting.method}_{setting.solver}_{key}".lower())
        directory = self.work / f"{tail}_{hashlib.sha256(text.encode()).hexdigest()[:12]}"
        return [str(self.program), str(file), *words], directory

    def written(self, datasets):
        """Writes a file with these datasets, which is named after its content. Returns its path."""
        digest = hashlib.sha256()
        for name, values in sorted(datasets.items()):
            digest.update(name.encode() + values.tobytes())
        path = self.work / f"start_{digest.hexdigest()[:12]}.h5"
        if not path.exists():
            self.work.mkdir(parents=True, exist_ok=True)
            with tempfile.NamedTemporaryFile(dir=self.work, suffix=".tmp", delete=False) as room:
                with h5py.File(room, "w") as file:
                    for name, values in datasets.items():
                        file[name] = values
            os.replace(room.name, path)
        return path

    def is_done(self, directory):
        summary = directory / "summary.json"
        return summary.exists() and json.loads(summary.read_text())["exit_reason"] in ("time_end", "steps")

    def run(self, words, directory):
        if self.is_done(directory):
            return Run(directory)
        words = words + ["-output_dir", str(directory), "-checkpoint_wall_minutes", "2", "-checkpoint_keep", "1"]
        if directory.exists() and any(directory.glob("checkpoint_*.h5")):
            words += ["-restart", str(directory)]
        else:
            shutil.rmtree(directory, ignore_errors=True)
        done = subprocess.run(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, stdin=subprocess.DEVNULL,
                              env=self.environment)
        if done.returncode:
            raise Failed((done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[0])
        for checkpoint in directory.glob("checkpoint_*.h5"):
            checkpoint.unlink()
        return Run(directory)

    def chain(self, case, setting, more):
        """Runs all keys of a setting in their order, so that results of earlier keys are available. Returns {key: run}."""
        runs, directories = {}, {}
        for key in setting.keys:
            words, directories[key] = self.command(case, setting, key, directories.__getitem__, more)
            with self.busy[directories[key]]:
                runs[key] = self.run(words, directories[key])
        return runs
