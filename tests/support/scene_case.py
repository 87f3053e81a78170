"""Scenes given by their options, run in a directory of the test's own.

Needs EULASTIC=path of the binary, for run_together EULASTIC_RUN_MANY and, for more ranks than one, EULASTIC_MPIEXEC.
"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
from eulastic import Run  # noqa: E402
from many_runs import Plan  # noqa: E402
from program import BINARY, launcher  # noqa: E402



class SceneCase(unittest.TestCase):
    def setUp(self):
        room = tempfile.TemporaryDirectory()
        self.addCleanup(room.cleanup)
        self.room = pathlib.Path(room.name)

    def run_program(self, name, *options, ranks=1):
        """The Run in self.room / name, which must end well."""
        directory = self.room / name
        done = subprocess.run([*launcher(ranks), BINARY, *options, "-output_dir", directory], capture_output=True, text=True,
                              timeout=300)
        self.assertEqual(done.returncode, 0, done.stderr)
        return Run(directory)

    def run_together(self, runs):
        """`runs`: {name: (options, {how})}, as Plan.add takes them, side by side in one start of MPI; {name: Run}. All must end
        well."""
        plan = Plan(self.room)
        for name, (options, how) in runs.items():
            plan.add(name, *options, **how)
        outcomes = plan.execute()
        for name, outcome in outcomes.items():
            self.assertEqual(outcome.code, 0, f"{name}: {outcome.err}")
        return {name: Run(outcome.directory) for name, outcome in outcomes.items()}
