#!/usr/bin/python3
"""A run that is refused, or stops before its first step is done, leaves its directory as it was, whatever the reason.

Needs EULASTIC, EULASTIC_RUN_MANY and EULASTIC_MPIEXEC.
"""
import fcntl
import hashlib
import json
import pathlib
import resource
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
sys.dont_write_bytecode = True
from many_runs import Plan  # noqa: E402
from program import BINARY, launcher  # noqa: E402

SCENE = ("-grid_cells 16,16,1 -grid_length 1,1,1 -fluid_viscosity .1 -body_force 1,0,0 -species disc -disc_shape sphere "
         "-disc_radius .25 -disc_shear_modulus 1 -disc_initial_stretch 1.2,.8333333333333334,1 -snapshot_interval .05 "
         "-probe_points .5,.5,.5").split()
# What is given beside the scene, and the exit status.
RESTARTS = {
    "an unknown option": ("-restart RUN -disc_radios 1", 2),
    "a changed body": ("-restart RUN -disc_radius .3 -time_end .2", 2),
    "an end that is over": ("-restart RUN -time_end .05", 2),
    "steps that are over": ("-restart RUN -time_steps_max 3", 2),
    "no checkpoint there": ("-restart EMPTY -time_end .2 -output_overwrite", 2),
    "no such file": ("-restart nowhere -time_end .2", 2),
    "a damaged checkpoint": ("-restart DAMAGED -time_end .2 -output_overwrite", 2),
    "a guard at its first step": ("-restart RUN -time_end .2 -guard_cfl 1e-9", 3),
    "a first step that is not finite": ("-restart RUN -time_end 2e15 -time_step 1e13 -guard_cfl 0", 3),
    "memory": ("-restart RUN -time_end .2 -guard_memory 1e-12", 2),
    "a KSP that does not converge": ("-restart RUN -time_end .2 -pressure_solver ksp -pressure_ksp_max_it 1 "
                                     "-pressure_ksp_rtol 1e-14 -pressure_pc_type none", 1),
}
NEW = {
    "is not empty": ("-time_end .1", 2),
    "an unknown option": ("-output_overwrite -disc_radios 1", 2),
    "memory": ("-output_overwrite -time_end .1 -guard_memory 1e-12", 2),
    "a missing file": ("-output_overwrite -time_end .1 -initial_state nowhere.h5", 2),
    "a guard at its start": ("-output_overwrite -time_end .1 -initial_velocity_mean 1,0,0 -guard_cfl 1e-9", 3),
    "a first step that is not finite": ("-output_overwrite -time_end 2e17 -time_step 1e17 -guard_cfl 0", 3),
    "a PETSc option nobody reads": ("-output_overwrite -time_end .1 -pressure_solver ksp -pressure_ksp_nonsense 1", 2),
    "a KSP that does not converge": ("-output_overwrite -time_end .1 -pressure_solver ksp -pressure_ksp_max_it 1 "
                                     "-pressure_ksp_rtol 1e-14 -pressure_pc_type none", 1),
    "an implicit viscous step that does not converge": ("-output_overwrite -time_end .1 -disc_viscosity 2 "
                                                        "-viscous_tolerance 1e-200", 1),
}


def listing(folder):
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.rglob("*")
            if path.is_file()}


class NothingIsLost(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        room = tempfile.TemporaryDirectory()
        cls.addClassCleanup(room.cleanup)
        cls.room = pathlib.Path(room.name)
        done = cls.start(*SCENE, "-time_end", ".1", "-output_dir", cls.room / "run")
        assert done.returncode == 0, done.stderr
        (cls.room / "empty").mkdir()
        shutil.copytree(cls.room / "run", cls.room / "damaged")
        for path in (cls.room / "damaged").glob("checkpoint_*.h5"):
            path.write_bytes(path.read_bytes()[:-1000])

    @classmethod
    def start(cls, *words, ranks=1, **more):
        return subprocess.run([*launcher(ranks), BINARY, *map(str, words)], cwd=cls.room, capture_output=True,
                              text=True, timeout=120, **more)

    def refuse(self, cases):
        """On one rank each by itself, on two one after the other in one start of MPI."""
        before = listing(self.room)
        with tempfile.TemporaryDirectory() as beside:
            plan, statuses = Plan(beside, ranks=2), {}
            for why, (words, status) in cases.items():
                for name in "RUN", "EMPTY", "DAMAGED":
                    words = words.replace(name, str(self.room / name.lower()))
                case = [*SCENE, "-output_dir", self.room / "run", *words.split()]
                with self.subTest(why):
                    done = self.start(*case)
                    self.assertEqual(done.returncode, status, done.stdout + done.stderr)
                    self.assertEqual(done.stderr.count("eulastic: error:"), 1, done.stderr)
                    self.assertEqual(listing(self.room), before)
                plan.add(why, *case, ranks=2, output=False)
                statuses[why] = status
            for why, outcome in plan.execute(cwd=self.room).items():
                with self.subTest(why, ranks=2):
                    self.assertEqual(outcome.code, statuses[why], outcome.out + outcome.err)
                    self.assertEqual(outcome.err.count("eulastic: error:"), 1, outcome.err)
            self.assertEqual(listing(self.room), before)

    def test_restarts(self):
        self.refuse(RESTARTS)

    def test_new_runs(self):
        self.refuse(NEW)

    def test_while_another_run_is_there(self):
        copy = self.room / "busy"
        shutil.copytree(self.room / "run", copy)
        self.addCleanup(shutil.rmtree, copy)
        with open(copy / ".lock", "w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            before = listing(copy)
            for words in ("-output_overwrite -time_end .2", f"-restart {copy} -time_end .2"):
                done = self.start(*SCENE, "-output_dir", copy, *words.split())
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn("in use", done.stderr)
                self.assertEqual(listing(copy), before)

    def test_a_disk_that_is_full_or_a_kill_before_the_first_step(self):
        before = listing(self.room / "run")
        large = ["-grid_cells", "1024,1024,1"]  # the snapshot of the start, in .new, has 32 MB
        words = [*SCENE[2:], *large, "-time_end", ".1", "-output_dir", self.room / "run", "-output_overwrite"]
        limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (2**24, 2**24))  # noqa: E731
        done = self.start(*words, preexec_fn=limit)  # one rank: Open MPI has files of its own
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertEqual(done.stderr.count("eulastic: error:"), 1, done.stderr)
        self.assertEqual(listing(self.room / "run"), before)
        # One whose first step never ends: killed when its files are there, and then one that is refused.
        process = subprocess.Popen([*launcher(), BINARY, *map(str, words)], stdout=subprocess.DEVNULL)
        while not list((self.room / "run").glob(".new/*.csv")):
            self.assertIsNone(process.poll())
        process.kill()
        process.wait()
        self.assertEqual({name: value for name, value in listing(self.room / "run").items() if not name.startswith(".new/")},
                         before)
        self.assertEqual(self.start(*SCENE, "-output_dir", self.room / "run", "-output_overwrite", "-time_end", "2e17",
                                    "-time_step", "1e17", "-guard_cfl", "0").returncode, 3)
        self.assertEqual(listing(self.room / "run"), before)

    def test_what_is_replaced_is_replaced_whole(self):
        copy = self.room / "copy"
        shutil.copytree(self.room / "run", copy)
        self.addCleanup(shutil.rmtree, copy)
        (copy / "notes.txt").write_text("mine")
        (copy / "snapshot_000099.h5").write_text("of the earlier run")
        for ranks in (1, 2):
            done = self.start(*SCENE, "-output_dir", copy, "-output_overwrite", "-time_end", ".1", ranks=ranks)
            self.assertEqual(done.returncode, 0, done.stderr)
            now, before = listing(copy), listing(self.room / "run")
            self.assertEqual(now.pop("notes.txt"), hashlib.sha256(b"mine").hexdigest())
            self.assertEqual(set(now), set(before))
            self.assertEqual(now["series.csv"], before["series.csv"])

    def test_a_finished_run_can_be_extended(self):
        copy, whole = self.room / "longer", self.room / "whole"
        shutil.copytree(self.room / "run", copy)
        done = self.start(*SCENE, "-output_dir", copy, "-restart", copy, "-time_end", ".2", "-series_interval", "5e-4",
                          ranks=2)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("is discarded", done.stdout)  # the last step was that of a shorter run
        done = self.start(*SCENE, "-output_dir", whole, "-time_end", ".2", "-series_interval", "5e-4")
        self.assertEqual(done.returncode, 0, done.stderr)
        one, other = (json.loads((at / "summary.json").read_text()) for at in (copy, whole))
        self.assertEqual(one["state_hash"], other["state_hash"])
        self.assertEqual((copy / "series.csv").read_text(), (whole / "series.csv").read_text())
        none = self.room / "none"
        self.start(*SCENE, "-output_dir", none, "-time_end", ".1", "-checkpoint_keep", "0")
        self.assertTrue((none / "summary.json").exists())
        self.assertEqual(list(none.glob("checkpoint_*")), [])
        for at in copy, whole, none:
            shutil.rmtree(at)


if __name__ == "__main__":
    unittest.main()
