#!/usr/bin/python3
"""Every command of README.md and docs/ as written, in a copy of the project. The runs are shortened from outside,
through PETSC_OPTIONS (which wins over options files): few cells and few steps; what the commands write, and that they
end well, is what is tested. Commands that install, compile or test everything are named in NOT_RUN."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts/lib"))
sys.dont_write_bytecode = True
from read_page import blocks, commands, file_name, is_python  # noqa: E402

BINARY = os.environ["EULASTIC"]
SHORT = "-grid_cells 16,16,16 -time_steps_max 2"
FLAT = {"python.md": SHORT.replace("16,16,16", "16,16,1")}  # pages of 2-D cases
NOT_RUN = {
    "scripts/quickstart": "installs and builds; its run, plot and render are commands of their own here",
    "scripts/test": "this very test is part of it",
    "scripts/dev/tidy": "all sources", "scripts/dev/sanitize": "compiles", "scripts/install": "packages", "scripts/build": "compiles", "scripts/benchmark": "compiles and takes its time",
    "scripts/studies/paper/paper_figure2": "test_scripts.py runs it", "scripts/studies/performance/work_precision": "many long runs",
    "scripts/count_communication": "it has a test of its own", "scripts/studies/scaling/scaling_tables": "it has a test of its own",
    "scripts/studies/paper/paper_figure5": "it has a test of its own", "scripts/studies/paper/paper_figure6": "it has a test of its own",
    "scripts/studies/paper/paper_section5": "an hour; it has a test of its own",
    "scripts/dev/tutorial": "it has a test of its own", "scripts/validate": "hours, and a part of scripts/test",
    "scripts/studies/validation/accuracy_tables": "needs the runs of scripts/validate",
    "scripts/studies/stability/stability_map": "many runs", ".ci/": "scripts/test again", "cmake": "compiles",
    "git": "a clone is there", "sbatch": "needs SLURM",
    "srun": "needs SLURM",
}
# What a page takes for granted.
BEFORE = {"reliability.md": "eulastic options/channel_rbc.opts -checkpoint_interval 1e-9 -output_dir output"}


def pages():
    return [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


def reason_not_to_run(command):
    return next((why for name, why in NOT_RUN.items() if command.startswith(name)), None)


class Docs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        room = tempfile.TemporaryDirectory()
        cls.addClassCleanup(room.cleanup)
        cls.room = pathlib.Path(room.name)
        for name in ("scripts", "options", "python"):
            shutil.copytree(ROOT / name, cls.room / name, symlinks=True, ignore=shutil.ignore_patterns("__pycache__"))
        (cls.room / "build/release").mkdir(parents=True)
        (cls.room / "build/release/eulastic").symlink_to(BINARY)
        for name in "run", "plot":  # as an installation has them; tests/regression/test_install.py tests that it does
            (cls.room / f"build/release/eulastic-{name}").symlink_to(cls.room / "scripts" / name)
        cls.environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                               OMPI_MCA_rmaps_base_oversubscribe="1", PETSC_OPTIONS=SHORT)
        cls.environment.pop("EULASTIC", None)
        cls.environment["PATH"] = f"{cls.room / 'build/release'}:{os.environ['PATH']}"

    def run_line(self, command):
        done = subprocess.run(command, shell=True, cwd=self.room, env=self.environment, capture_output=True, text=True,
                              timeout=300)
        self.assertEqual(done.returncode, 0, f"{command}\n{done.stdout}{done.stderr}")

    def run_python(self, page, block):
        environment = dict(self.environment, PETSC_OPTIONS=FLAT.get(page.name, SHORT))
        done = subprocess.run([sys.executable, "-B", "-c", "\n".join(block)], cwd=self.room, env=environment,
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, "\n".join(block) + done.stderr)

    def test_commands(self):
        ran = 0
        for page in pages():
            if page.name == "tutorial.md":  # scripts/dev/tutorial follows it, and has a test of its own
                continue
            shutil.rmtree(self.room / "output", ignore_errors=True)
            if page.name in BEFORE:
                self.run_line(BEFORE[page.name])
            for before, block in blocks(page):
                if name := file_name(before):
                    (self.room / name).write_text("\n".join(block) + "\n")
                for command in commands(block):
                    with self.subTest(page=page.name, command=command):
                        if reason_not_to_run(command):
                            self.assertTrue(not command.startswith(("scripts/", ".ci/")) or
                                            (ROOT / command.split()[0]).exists())
                            continue
                        self.run_line(command)
                        ran += 1
                if is_python(block):
                    with self.subTest(page=page.name, python=block[0]):
                        self.run_python(page, block)
                        ran += 1
        self.assertGreaterEqual(ran, 5)

    def test_scripts_that_are_mentioned_exist(self):
        for page in pages():
            for name in set(re.findall(r"\bscripts/[a-z0-9_./]+[a-z0-9_]", page.read_text())):
                self.assertTrue((ROOT / name).exists(), f"{page.name}: {name}")

    def test_options_that_are_mentioned_exist(self):
        known = {name.replace("NAME_", "") for name in
                 re.findall(r"^\| `-(\w+)`", (ROOT / "docs/options.md").read_text(), re.MULTILINE)}
        petsc = ("log_", "ksp_", "pc_", "pressure_", "malloc", "info", "mat_", "vec_", "sf_", "da_", "dm_", "options_",
                 "memory_", "mg_", "ff", "fno", "fopenmp", "march")  # of the compiler
        for page in pages():
            for name in set(re.findall(r"`-([a-z]\w+)", page.read_text())):
                plain = re.sub(r"^(rbc|cell|disc|gel|layer|a|b|vessel)_", "", name)
                self.assertTrue(plain in known or name in known or name.startswith(petsc) or
                                any(k.startswith(name) for k in known) or name in ("help", "version", "n"),
                                f"{page.name}: -{name}")


if __name__ == "__main__":
    unittest.main()
