#!/usr/bin/python3
"""One rank fails, in every verb and in every way: all ranks end within seconds, with one line and an exit code.

Needs EULASTIC, EULASTIC_MPIEXEC and EULASTIC_FAULT_LIBRARY (tests/support/fault.cpp, preloaded).
"""
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from program import BINARY, launcher  # noqa: E402
from restart_case import ENDLESS, FLAT, OFTEN, ROOT, Restart  # noqa: E402

LIBRARY = os.environ["EULASTIC_FAULT_LIBRARY"]
VERBS = re.findall(r'"(Eul[A-Z]\w+)"', (ROOT / "src/base/events.cpp").read_text().split("stage_names")[0])
IN_BOXES = "-threads 2 -cell_placement lattice -cell_count 2,2,1".split()
# What a verb needs besides a fluid with bodies and the fast method.
NEEDS = {"EulSMAC": ["-pressure_solver", "smac"], "EulTension": ["-cell_surface_tension", "0.5"],
         "EulMembrane": ["-cell_law", "membrane", "-cell_surface_shear_modulus", "1"],
         "EulAdhesion": ("-adhesion cell-wall -adhesion_cell_wall_density 9 -adhesion_cell_wall_reach 1.5 -adhesion_cell_wall_rate_on 9 "
                         "-adhesion_cell_wall_rate_off 1 -adhesion_cell_wall_bond_stiffness .01").split(),
         "EulRigid": ["-cell_law", "rigid"], "EulBoxes": IN_BOXES, "EulThreads": IN_BOXES}
WITHOUT = {"EulMembrane": "-cell_shear_modulus", "EulRigid": "-cell_shear_modulus", "EulBoxes": "-cell_centre", "EulThreads": "-cell_centre"}
SECONDS = 300  # far more than it takes on a busy machine, far less than for ever


class Faults(Restart):
    def fails(self, kind, verb, rank, ranks=2, count=3):
        self.environment.update({"LD_PRELOAD": LIBRARY, "EULASTIC_FAULT": f"{kind} {verb} {rank} {count}",
                                 "OMPI_MCA_orte_base_help_aggregate": "0",
                                 "OMPI_MCA_odls_base_sigkill_timeout": "0"})  # mpiexec kills what is left at once
        scene = list(FLAT)
        if verb in WITHOUT:
            at = scene.index(WITHOUT[verb])
            del scene[at:at + 2]
        command = [*launcher(ranks), BINARY, *scene, *OFTEN, *NEEDS.get(verb, []),
                   "-time_steps_max", "60", "-output_dir", f"{kind}_{verb}_{rank}"]
        result = subprocess.run(list(map(str, command)), cwd=self.room, env=self.environment, timeout=SECONDS,
                                capture_output=True, text=True)
        self.assertIn(f"fault: {kind} in {verb}", result.stderr, "the fault was not met")
        self.assertNotEqual(result.returncode, 0)
        return [line for line in result.stderr.splitlines() if line.startswith("eulastic: error:")]

    def test_memory_in_every_verb(self):
        for verb in VERBS:
            with self.subTest(verb):
                lines = self.fails("memory", verb, 1)
                self.assertEqual(lines, ["eulastic: error: rank 1: out of memory"])

    def test_error_in_every_verb(self):
        for n, verb in enumerate(VERBS):
            with self.subTest(verb):
                lines = self.fails("error", verb, n % 2)
                self.assertEqual(len(lines), 1, lines)
                self.assertRegex(lines[0], "MPI|cannot|disk full|damaged")

    def test_crash_and_exit(self):
        lines = self.fails("crash", "EulMomentum", 1)
        self.assertEqual(len(lines), 1, lines)
        self.assertIn("rank 1 received signal 11", lines[0])
        self.fails("exit", "EulACM", 1)  # Open MPI has the word
        self.fails("memory", "EulACM", 2, ranks=3)

    def test_crash_that_holds_a_lock(self):
        for kind, signal in ("locked", 11), ("heap", 6):
            lines = self.fails(kind, "EulMomentum", 1)
            self.assertEqual(len(lines), 1, lines)
            self.assertIn(f"rank 1 received signal {signal}", lines[0])

    def test_a_failed_fsync_is_not_tried_again(self):
        self.environment["LD_PRELOAD"] = LIBRARY
        for name in "checkpoint_", "bodies.h5", "series.csv", "snapshot_", "summary.json":
            for count in 1, 3:
                with self.subTest(name, count=count):
                    shutil.rmtree(self.room / "run", ignore_errors=True)
                    self.environment["EULASTIC_FSYNC"] = f"{name} {count}"
                    result = self.call(*FLAT, *OFTEN, "-snapshot_interval", ".05", "-time_steps_max", 30, "-output_dir", "run")
                    self.assertEqual(result.returncode, 1, result.stderr)
                    self.assertRegex(result.stderr, r"\Aeulastic: error: [^\n]+\n\Z")
                    self.assertIn(name.rstrip("_"), result.stderr)
                    if name == "checkpoint_":
                        self.assertEqual(len(self.checkpoints()), count // 2)  # each is synced twice

    def test_flush_of_one_rank(self):
        for rank in (0, 1):  # the other waits inside HDF5
            with self.subTest(rank):
                self.assertEqual(len(self.fails("flush", "EulWrite", rank)), 1)

    def test_opening_on_one_rank(self):
        for kind, rank in (("size", 0), ("bcast", 1)):  # both ranks wait inside HDF5
            with self.subTest(kind):
                lines = self.fails(kind, "EulWrite", rank)
                self.assertEqual(len(lines), 1, lines)
                self.assertIn("not open after", lines[0])

    def test_directory_that_one_rank_does_not_see(self):
        for rank in (0, 1):
            with self.subTest(rank):
                lines = self.fails("absent", "EulWrite", rank)
                self.assertEqual(len(lines), 1, lines)
                self.assertRegex(lines[0], "cannot open .*: No such file")

    def test_disk_of_one_rank(self):
        for which in (0, 1):
            with self.subTest(which):
                shutil.rmtree(self.room / "run", ignore_errors=True)
                process = self.start(*FLAT, *ENDLESS[:2], *OFTEN, ranks=2)
                self.wait_until(self.checkpoints)
                children = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
                ranks = [int(p) for p in children if os.readlink(f"/proc/{p}/exe") == os.path.realpath(BINARY)]
                resource.prlimit(ranks[which], resource.RLIMIT_FSIZE, (10000, 10000))
                code = process.wait(SECONDS)
                errors = process.stderr.read()
                self.assertEqual(code, 1, errors)
                self.assertEqual(errors.count("eulastic: error:"), 1, errors)


if __name__ == "__main__":
    unittest.main()
