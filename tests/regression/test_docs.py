#!/usr/bin/python3
"""Every command of README.md and, with scripts/test --full, of docs/ as written, in a copy of the project. The runs are shortened from outside,
through PETSC_OPTIONS (which wins over options files): few cells and few steps; what the commands write, and that they
end well, is what is tested. Commands that install, compile or test everything are named in NOT_RUN."""
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

from PIL import Image

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "scripts/lib"), str(ROOT / "tests/support")]
sys.dont_write_bytecode = True
from full import FULL  # noqa: E402
from load_script import load  # noqa: E402
from program import BINARY  # noqa: E402
from read_page import blocks, commands, file_name, is_python  # noqa: E402

evidence = load("evidence")
SHORT = "-grid_cells 16,16,16 -time_steps_max 2"
FLAT = SHORT.replace("16,16,16", "16,16,1")
OTHERS = {"python.md": FLAT, "vessel.md": "-grid_cells 30,16,16 -time_steps_max 2", "gallery.md": "-time_steps_max 2",
          "adhesion.md": "-time_steps_max 2",  # the reach of bonds is at least a cell
          "long_run.md": "-grid_cells 16,16,1 -checkpoint_interval 30"}
NO_COMMANDS = "tutorial.md", "gallery.md"  # scripts/dev/tutorial follows the one, a test below looks at the other
NOT_RUN = {
    "scripts/quickstart": "installs and builds; its run, plot and render are commands of their own here",
    "scripts/test": "this very test is part of it",
    "scripts/install": "packages", "scripts/build": "compiles", "scripts/benchmark": "compiles and takes its time",
    "scripts/studies/paper/paper_figure2": "test_scripts.py runs it", "scripts/studies/performance/work_precision": "many long runs",
    "scripts/studies/performance/membranes": "test_performance.py runs it",
    "scripts/studies/performance/race": "test_performance.py runs it",
    "scripts/count_communication": "it has a test of its own", "scripts/studies/scaling/scaling_tables": "it has a test of its own",
    "scripts/studies/scaling/node": "it has a test of its own",
    "scripts/studies/paper/paper_figure5": "it has a test of its own", "scripts/studies/paper/paper_figure6": "it has a test of its own",
    "scripts/studies/paper/paper_section5": "an hour; it has a test of its own",
    "scripts/validate": "hours, and a part of scripts/test",
    "scripts/studies/validation/accuracy_tables": "needs the runs of scripts/validate",
    "scripts/studies/stability/": "many runs", "scripts/dev/": "minutes to hours", "scripts/docs": "it has a test of its own", ".ci/": "scripts/test again",
    "cmake": "compiles, or installs: test_install.py", "git": "a clone is there", "sbatch": "needs SLURM",
}
EVIDENCE = ("validation", "accuracy", "dimple", "performance", "scaling", "stability", "robustness", "contact", "capillary",
            "paper_figure2")
# The only numbers in the prose of such pages: set-ups, bounds and what others say; results stand where scripts write them.
GIVEN = {
    "performance": "0.1 0.35 0.4 0.5 1 3.5 4 5 8 10 16 20 32 56 60 64 100 145 150 200 640 .005 2e-4 4e-3 64^3 128^3 256^2",
    "scaling": "0 1 3 4 5 6 8 12 16 18 20 25 26 27 32 33 48 56 64 96 1.1 160 192 256 504 0.33 0.73 1024 16^3 32^3 4096 8.39 91.6 "
               "82,944 131,072",
    "stability": "0 1 3 4 7 .1 .5 10 .01 1.2 1e-3 1e-9",
    "robustness": "1 4 16 32 100 2-D 3-D 500",
    "contact": "1 5 6 8 15 16 2-D 3-D 0.22",
}
# What a page takes for granted.
BEFORE = {"reliability.md": "eulastic options/channel_rbc.opts -checkpoint_interval 1e-9 -output_dir output",
          "cluster.md": "cp options/channel_rbc.opts case.opts"}


def pages():
    return [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]


def tables_by_hand(text):
    """Rows of tables outside of the marks of scripts."""
    rest = re.sub(r"<!-- table\b.*?<!-- end( of table)? -->", "", text, flags=re.DOTALL)
    return [line for line in rest.splitlines() if line.startswith("|")]


def numbers_by_hand(text):
    """Outside of tables, code, links and the line that says with which program a page was made."""
    for span in r"<!-- table\b.*?<!-- end( of table)? -->", r"```.*?```", r"^( {4}|>).*?$", r"`[^`]*`", r"\]\([^)]*\)":
        text = re.sub(span, "", text, flags=re.DOTALL | re.MULTILINE)
    return {number.rstrip(".,-") for number in re.findall(r"(?<![\w^/.-])\.?\d[\w.,^-]*", text)}


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
        srun = cls.room / "build/release/srun"  # as SLURM has it for a job of two tasks
        srun.write_text('#!/bin/sh\nexec mpiexec "$@"\n')
        srun.chmod(0o755)
        cls.environment = dict(os.environ, SLURM_NTASKS="2", SCRATCH=str(cls.room / "scratch"), PETSC_OPTIONS=SHORT)
        cls.environment.pop("EULASTIC", None)
        cls.environment["PATH"] = f"{cls.room / 'build/release'}:{os.environ['PATH']}"

    def environment_of(self, page):
        """README.md works as it is printed, for root, too."""
        environment = dict(self.environment, PETSC_OPTIONS=OTHERS.get(page.name, SHORT))
        if page.name == "README.md":
            environment = {name: value for name, value in environment.items() if not name.startswith("OMPI_ALLOW_RUN_AS_ROOT")}
        return environment

    def run_line(self, command, page):
        done = subprocess.run(command, shell=True, cwd=self.room, env=self.environment_of(page), capture_output=True, text=True,
                              timeout=300)
        self.assertEqual(done.returncode, 0, f"{command}\n{done.stdout}{done.stderr}")

    def run_python(self, page, block):
        done = subprocess.run([sys.executable, "-B", "-c", "\n".join(block)], cwd=self.room, env=self.environment_of(page),
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, "\n".join(block) + done.stderr)

    def test_commands(self):
        ran = 0
        for page in pages() if FULL else [ROOT / "README.md"]:
            if page.name in NO_COMMANDS:
                continue
            shutil.rmtree(self.room / "output", ignore_errors=True)
            if page.name in BEFORE:
                self.run_line(BEFORE[page.name], page)
            for before, block in blocks(page):
                if name := file_name(before):
                    (self.room / name).write_text("\n".join(block) + "\n")
                for command in commands(block):
                    with self.subTest(page=page.name, command=command):
                        if reason_not_to_run(command):
                            self.assertTrue(not command.startswith(("scripts/", ".ci/")) or
                                            (ROOT / command.split()[0]).exists())
                            continue
                        self.run_line(command, page)
                        ran += 1
                if is_python(block):
                    with self.subTest(page=page.name, python=block[0]):
                        self.run_python(page, block)
                        ran += 1
        self.assertGreaterEqual(ran, 20 if FULL else 5)

    def test_gallery(self):
        """Every case once, with options that the program takes, its picture, and what it is as the file says; each way to draw
        one of them in a run of two steps."""
        page = ROOT / "docs/gallery.md"
        text = page.read_text()
        cases = sorted(path.stem for path in (ROOT / "options").glob("*.opts"))
        self.assertEqual(sorted(re.findall(r"^### (\w+)$", text, re.MULTILINE)), cases)
        pictures = re.findall(r"\]\((images/gallery_[\w.]+)\)", text)
        self.assertEqual(len(pictures), len(cases))
        self.assertLess(sum((ROOT / "docs" / name).stat().st_size for name in pictures), 4e6)
        runs = [shlex.split(c) for _, block in blocks(page) for c in commands(block) if c.startswith("scripts/run ")]
        self.assertEqual(sorted(pathlib.Path(words[1]).stem for words in runs), cases)
        for _, case, directory, *options in runs:
            done = subprocess.run([BINARY, ROOT / case, *options, "-print_options"], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
        ways = {}
        for _, block in blocks(page):
            run, draw = commands(block)
            script, directory, *options = shlex.split(draw)
            self.assertEqual(directory, shlex.split(run)[2])
            ways.setdefault((script, *options), (run, draw))
        self.assertGreaterEqual(len(ways), 5)
        for run, draw in list(ways.values())[:None if FULL else 2]:
            self.run_line(run, page)
            self.run_line(draw, page)

    def test_every_page_is_in_the_index(self):
        index = ROOT / "docs/README.md"
        named = {(index.parent / target).resolve() for target in re.findall(r"\]\(([\w/.]+\.md)\)", index.read_text())}
        self.assertEqual(set(pages()) - named - {index, ROOT / "README.md"}, set())

    def test_length_of_the_front_pages(self):
        for page in (ROOT / "README.md", *sorted((ROOT / "docs/howto").glob("*.md"))):
            self.assertLessEqual(page.read_text().count("\n"), 105 if page.name == "README.md" else 60, page.name)

    def test_numbers_of_evidence_are_written_by_scripts(self):
        """A table of an evidence page stands between marks that a script writes, or the whole page is a script's; it says once with
        which program, when, on what and by which script it was made."""
        self.assertEqual(tables_by_hand("a\n| 1 |\n<!-- table x -->\n| 2 |\n<!-- end -->\n"), ["| 1 |"])
        for name in EVIDENCE:
            text = (ROOT / f"docs/{name}.md").read_text()
            stamps = re.findall(r"^> Made with eulastic [\d.]+ \((?:sources )?\w[\w-]*\), \d{4}-\d\d-\d\d, on .+, by `(scripts/[\w/]+)`", text, re.M)
            self.assertEqual(len(stamps), 1, name)
            self.assertTrue((ROOT / stamps[0]).exists(), stamps)
            script = re.search(r"^Written by `(scripts/[\w/]+)`.*?; do not edit\.", text, re.M)
            if script:
                self.assertEqual(script[1], stamps[0])
            else:
                self.assertEqual(tables_by_hand(text), [], name)
                self.assertEqual(numbers_by_hand(text) - set(GIVEN[name].split()), set(), f"{name}.md: is it measured?")

    def test_every_table_and_picture_has_a_step_of_scripts_evidence(self):
        steps, elsewhere = evidence.STEPS, evidence.ELSEWHERE
        for step in steps:
            self.assertTrue((ROOT / "docs" / step.page).exists() or (ROOT / step.page).exists(), step)
            for command in step.commands:
                self.assertTrue(command.startswith(("cp ", "scripts/")) and (command.startswith("cp ") or (ROOT / command.split()[0]).exists()))
        marks = [(str(page.relative_to(ROOT / "docs")), name) for page in pages() if page.name != "README.md"
                 for name in re.findall(r"<!-- table ?(\w*) ?-->", page.read_text()) if name not in elsewhere]
        self.assertEqual(sorted(marks), sorted((step.page, table) for step in steps for table in step.tables))
        for picture in sorted((ROOT / "docs/images").iterdir()):
            makers = [step.name for step in steps for pattern in step.pictures if picture.match(pattern)]
            self.assertEqual(len(makers), picture.name not in elsewhere, f"{picture.name}: {makers}")
        shown = set(re.findall(r"images/([\w.]+)\)", "".join(page.read_text() for page in pages())))
        self.assertEqual({picture.name for picture in (ROOT / "docs/images").iterdir()}, shown)

    def test_evidence_is_of_the_release(self):
        """Once CHANGELOG.md begins with a release, all steps and stamps have its version, all measured times the same sources, and all
        steps the same results."""
        newest = re.findall(r"^## (.+)$", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)[0]
        known = json.loads((ROOT / "docs/evidence.json").read_text()) if (ROOT / "docs/evidence.json").exists() else {}
        self.assertEqual(set(known) - {step.name for step in evidence.STEPS}, set())
        if newest == "Unreleased":
            return
        self.assertEqual(set(known), {step.name for step in evidence.STEPS})
        made = {(step["version"], step["sources"]) for step in known.values()}
        self.assertEqual({version for version, _ in made}, {newest.split()[0]})
        self.assertEqual(len({known[step.name]["sources"] for step in evidence.STEPS if step.timed}), 1, "of all measured times")
        self.assertEqual(len({step["results"] for step in known.values()}), 1, "of all steps")
        elsewhere = re.compile(rf"<!-- table ({'|'.join(evidence.ELSEWHERE)}) -->.*?<!-- end -->", re.DOTALL)
        for page in pages():
            stamp = re.compile(r"Made with eulastic ([\d.]+) \((?:sources )?(\w[\w-]*)\)")
            self.assertEqual({version for version, _ in stamp.findall(page.read_text())} - {newest.split()[0]}, set(), page)
            self.assertEqual(set(stamp.findall(elsewhere.sub("", page.read_text()))) - made, set(), page)

    def test_pictures_are_at_print_size(self):
        """1,600 pixels wide, or 1,200 for square ones: those of the gallery, and once CHANGELOG.md begins with a release all."""
        newest = re.findall(r"^## (.+)$", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)[0]
        pattern = "gallery_*" if newest == "Unreleased" else "*"
        pictures = [path for path in (ROOT / "docs/images").glob(pattern) if path.suffix != ".svg"]
        self.assertGreater(len(pictures), 30)
        for path in pictures:
            with Image.open(path) as picture:
                self.assertGreaterEqual(picture.width, 1200, path.name)

    def test_steps_of_evidence(self):
        """A step is done once, and again when the sources have changed, unless it measures no times and the results are the same;
        what it makes lies in docs/."""
        for options in (self.room / "options").glob("*.opts"):
            if options.stem != "disc_in_shear":
                options.unlink()
        for folder in "docs/images", "src":
            (self.room / folder).mkdir(parents=True, exist_ok=True)
        (self.room / "src/solver.cpp").write_text("int one;\n")
        script = [self.room / "scripts/evidence", "--only", "grid.md"]
        environment = dict(os.environ, EULASTIC=str(BINARY))

        def says(*more):
            done = subprocess.run([*script, *more], capture_output=True, text=True, env=environment)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            return done.stdout
        self.assertIn("not made by this script yet\n0 of 1 steps", says("--list"))
        self.assertIn("evidence: grid, about", says())
        self.assertTrue((self.room / "docs/images/domain.png").exists())
        self.assertIn("evidence: grid is up to date\nevidence: 1 of 1 steps are of these sources or of their results", says())
        self.assertIn("evidence: grid, about", says("--again"))
        (self.room / "docs/grid.md").write_text("A page is no source.\n")
        (self.room / "src/solver.cpp").write_text("int one;  // nor is a comment\n")
        self.assertIn("up to date: ", says("--list"))
        (self.room / "src/solver.cpp").write_text("int two;\n")
        self.assertIn("older: ", says("--list"))  # as long as the results are not known
        self.assertRegex(says(), "short runs of all cases\nevidence: grid is up to date\n")
        self.assertIn("up to date: ", says("--list"))
        (self.room / "src/solver.cpp").write_text("int three;\n")
        with open(self.room / "options/disc_in_shear.opts", "a") as options:
            options.write("-fluid_viscosity 1.5\n")
        self.assertRegex(says(), "short runs of all cases\nevidence: grid, about .* min\n")
        record = json.loads((self.room / "docs/evidence.json").read_text())["grid"]
        (self.room / "scripts/dev/draw_grid").write_text("#!/bin/sh\nexit 3\n")
        done = subprocess.run([*script, "--again"], capture_output=True, text=True, env=environment)
        self.assertEqual(done.returncode, 1)
        self.assertIn("evidence: 0 of 1 steps are of these sources or of their results; failed: grid\n", done.stdout)
        self.assertEqual(json.loads((self.room / "docs/evidence.json").read_text())["grid"], record)
        shutil.copy(ROOT / "scripts/dev/draw_grid", self.room / "scripts/dev/draw_grid")
        done = subprocess.run([script[0], "--only", "nowhere"], capture_output=True, text=True, env=environment)
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertRegex(done.stderr, r"\Aevidence: --only nowhere: accepted: grid, .*\n\Z")

    def test_exceptions_to_fast_are_those_of_the_tables(self):
        """performance.md names in its prose the cases and grids where `classic` is faster or more accurate than `fast`, no others."""
        text = (ROOT / "docs/performance.md").read_text()

        def rows(name):
            table = re.search(rf"<!-- table {name} -->(.*?)<!-- end -->", text, re.DOTALL)[1]
            return [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines() if re.match(r"\| [a-z].*\d", line)]
        found = set()
        for case, cells, fast, _, classic, _ in rows("work_precision"):
            if "-" not in (fast, classic):
                (error, time), (error_classic, time_classic) = (map(float, re.findall(r"[\d.e+-]+", cell)) for cell in (fast, classic))
                if error_classic < error or time_classic < time:
                    found.add(f"{case}, {cells}")
        race = {(row[0], row[1], row[2]): (float(row[3]), float(row[6])) for row in rows("race") if row[6]}
        compared = 0
        for (case, method, cells), (error, time) in race.items():
            if method == "classic":
                other_error, other_time = race[case, "fast", cells]
                compared += 1
                if error < other_error or time < other_time:
                    found.add(f"{case}, {cells}")
        self.assertGreaterEqual(compared, 5)
        self.assertEqual(found, set(re.findall(r"`([a-z_0-9 ]+, \d+)`", text)))

    def test_soft_spheres_need_what_their_errors_say(self):
        """The cells per radius for 1 % of resolution.md and of the note on S8 follow from the coefficients of S8."""
        page = (ROOT / "docs/validation/solids.md").read_text()
        coefficients = dict(re.findall(r"^\| S8 \| Ca 0?(\.\d+): relative error of D over \(h/R\)\^2 \|(?:[^|]*\|){3} *([\d.]+)", page, re.MULTILINE))
        cells = {capillary: round((100 * float(c)) ** 0.5) for capillary, c in coefficients.items()}
        self.assertEqual(sorted(cells), [".05", ".1", ".2"])
        words = f"{cells['.2']}, {cells['.1']} and {cells['.05']} cells per radius at Ca = .2, .1 and .05"
        self.assertIn(words, page)
        self.assertIn(f"{words} (validation, S8)", (ROOT / "docs/howto/resolution.md").read_text())

    def test_numbers_of_the_front_page_are_those_of_the_tables(self):
        """Accuracy, speed and scale of README.md."""
        readme = (ROOT / "README.md").read_text()
        text = {name: (ROOT / f"docs/{name}.md").read_text() for name in ("validation/membranes", "performance")}
        errors = re.findall(r"^\| V9 \| [^|]*: D at [^|]*\|(?:[^|]*\|){4} *([\d.]+) % \|", text["validation/membranes"], re.MULTILINE)
        self.assertGreaterEqual(len(errors), 18)
        self.assertIn(f"within {max(map(float, errors)):g} % of boundary-integral", readme)
        sooner = re.search(r"^\| fast \|(?:[^|]*\|){5} *([\d.]+) \|$", text["performance"], re.MULTILINE)[1]
        self.assertIn(f"{int(float(sooner))} times sooner", readme)
        scaling = (ROOT / "docs/scaling.md").read_text()
        ranks, copies = (f"{float(re.search(rf'^.*{row}.*$', scaling, re.MULTILINE)[0].split('|')[column]):.1f}" for row, column in (
            (r"\| channel_rbc \| 128 x 128 x 128 \| fast \|", 8), (r"\| copies \|[^|]*\| fast \|", 8)))
        self.assertIn(f"16 ranks are {ranks} times as fast as one, at 128^3", readme)
        self.assertIn(f"reach {copies}", " ".join(readme.split()))

    def test_membranes_cost_and_converge_as_their_tables_say(self):
        """The wall time of membranes relative to solid cells, on two pages, and the orders of capsules that method/membranes.md gives."""
        def words(name):
            return " ".join((ROOT / f"docs/{name}.md").read_text().split())
        text = (ROOT / "docs/performance.md").read_text()
        factor = round(float(re.search(r"^\| membranes \|.*\| ([\d.]+) \|$", text, re.MULTILINE)[1]))
        times = f"about {['no', 'one', 'two', 'three', 'four', 'five'][factor]} times the wall time"
        self.assertEqual(words("performance").count(times), 2)
        self.assertIn(f"took {times}", words("comparison"))
        self.assertIn("elastic **solids**", words("comparison"))
        orders = re.findall(r"^\| [^|]*viscosity ratio [15] \| \d+ \| [\d.]+ % \| ([\d.]+) \|", text, re.MULTILINE)
        self.assertEqual(len(orders), 4)
        self.assertIn(f"is {min(orders)} to {max(orders)} for viscosity ratios of 1 and 5", words("method/membranes"))

    def test_pages_agree_on_what_leaves_whole(self):
        """README.md, the questions and the method; tests/regression/test_open_sides.py tests the program."""
        readme, questions, method = (" ".join((ROOT / name).read_text().split()) for name in
                                     ("README.md", "docs/howto/questions.md", "docs/method/boundaries.md"))
        for text in readme, questions:
            self.assertIn("Membranes, drops and bodies with a viscosity of their own are removed whole when", text)
        self.assertIn("Drops with surface tension, membranes, and bodies with a viscosity of their own leave *whole*", method)
        self.assertIn("anchored bodies cannot leave", readme)
        self.assertIn("The run stops when an anchored body", method)

    def test_messages_of_questions_are_those_of_the_program(self):
        """The longest run of words of every quoted message of questions.md stands in the sources."""
        joined = "".join(re.sub(r'"\s*\n\s*"', "", path.read_text()) for path in sorted((ROOT / "src").rglob("*.cpp")))
        rows = re.findall(r"^\| `([^`]+)` ", (ROOT / "docs/howto/questions.md").read_text(), re.MULTILINE)
        self.assertGreaterEqual(len(rows), 12)
        for row in rows:
            words = max(re.findall(r"(?<![\w-])[a-z]+(?: [a-z]+)*(?![\w-])", row), key=len)
            with self.subTest(message=row, words=words):
                self.assertTrue(words in joined)

    def test_durations_agree(self):
        """README.md, the scripts and the main case give the same durations."""
        def text(name):
            return re.sub(r"\s+(# )?", " ", (ROOT / name).read_text())
        for name in "README.md", "scripts/quickstart", "options/channel_rbc.opts":
            self.assertRegex(text(name), r"(?i)a quarter of a minute", name)
        readme, words = text("README.md"), text("scripts/test")
        self.assertIn("must pass: about ten minutes on two cores, after the build", words)
        self.assertIn("The tests take about ten minutes after a build", readme)
        self.assertIn("under five minutes, after the build", words)
        self.assertIn("`scripts/test --quick` takes less than five minutes", readme)
        self.assertIn("--full all tests, some hours", words)
        self.assertIn("`scripts/test --full` runs all tests and takes hours", readme)

    def test_the_note_on_tweezers_is_that_of_its_rows(self):
        """Validation, V6: the largest error of the axial diameter, and the growth of the area."""
        page = (ROOT / "docs/validation/membranes.md").read_text()
        axial = re.findall(r"^\| V6 \| axial diameter at \d+ pN, um \|[^|]*\|[^|]*\|([^|]*)\|([^|]*)\|", page, re.MULTILINE)
        self.assertEqual(len(axial), 6)
        largest = max(abs(float(reference) - float(ours)) for reference, ours in axial)
        area = float(re.search(r"^\| V6 \| largest change of the membrane's area \|(?:[^|]*\|){3}([^|]*)\|", page, re.MULTILINE)[1])
        notes = re.search(r"^## V6\n.*?(?=^## )", page, re.MULTILINE | re.DOTALL)[0]
        self.assertIn(f"within {largest:.2f} um".replace("0.", "."), notes)
        self.assertIn(f"grow by up to {100 * area:.1f} %", notes)

    def test_kinds_of_boundaries_in_python(self):
        """The docstring of Run.side names every kind of boundary that the options have."""
        sys.path.insert(0, str(ROOT / "python"))
        from eulastic.reading import Run
        accepted = re.search(r"^\| `-boundary_SIDE` \|.*\| one of ([\w, ]+) \|$", (ROOT / "docs/options.md").read_text(), re.MULTILINE)[1]
        kinds = {kind for kind in accepted.split(", ") if kind != "same"} | {"periodic"}
        self.assertGreaterEqual(len(kinds), 6)
        self.assertEqual({kind for kind in kinds if kind in Run.side.__doc__}, kinds)

    def test_anchors_exist(self):
        """Links into pages, as GitHub and the site name their headings."""
        def anchors(page):
            headings = re.findall(r"^#+ (.+)$", page.read_text(), re.MULTILINE)
            return {re.sub(r"[^\w -]", "", heading.lower()).strip().replace(" ", "-") for heading in headings}
        for page in pages():
            for target, anchor in re.findall(r"\]\(([\w/.]*)#([\w-]+)\)", page.read_text()):
                self.assertIn(anchor, anchors(page.parent / target if target else page), f"{page.name}: {target}#{anchor}")

    @unittest.skipUnless(shutil.which("mkdocs") and shutil.which("doxygen") and pathlib.Path("/usr/share/javascript/mathjax").exists(),
                         "scripts/install --docs")
    def test_site(self):
        """Every page is on it, no link leads nowhere, equations and search need no network."""
        site = self.room / "site"
        done = subprocess.run([ROOT / "scripts/docs", "--output", site, "--without-api"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn(", 0 links lead nowhere", done.stdout)
        for page in pages():
            place = site / page.relative_to(ROOT).with_suffix(".html")
            self.assertTrue((place.with_name("index.html") if page.name == "README.md" else place).exists(), place)
        method = (site / "docs/method.html").read_text()
        self.assertIn('<span class="arithmatex">\\(', method)
        self.assertIn('src="../mathjax/MathJax.js', method)
        self.assertTrue((site / "mathjax/MathJax.js").exists() and (site / "search/search_index.json").exists())
        for place in site.rglob("*.html"):
            loaded = re.findall(r'<(?:script|link|img)[^>]*(?:src|href)="(https?:[^"]+)"', place.read_text())
            self.assertEqual([url for url in loaded if "canonical" not in url], [], place)

    def test_citations_of_the_method_lead_somewhere(self):
        """Sections and equations that sources, tests and pages cite stand on one page each, which the index of method.md links."""
        index = (ROOT / "docs/method.md").read_text()
        pages_of_method = {path: path.read_text() for path in [ROOT / "docs/method.md", *(ROOT / "docs/method").glob("*.md")]}
        sections = [int(n) for text in pages_of_method.values() for n in re.findall(r"^## (\d+)\. ", text, re.MULTILINE)]
        self.assertEqual(sorted(sections), list(range(1, max(sections) + 1)))
        self.assertEqual([int(n) for n in re.findall(r"^\| \[(\d+)\. ", index, re.MULTILINE)], sorted(sections))
        tags = [tag for text in pages_of_method.values() for tag in re.findall(r"\\tag\{([^}]*)\}", text)]
        self.assertEqual(len(tags), len(set(tags)))
        rows = {tag for row in re.findall(r"^\| \[\d+\..*", index, re.MULTILINE) for tag in re.findall(r"\((\d+[\d,a-z]*)\)", row)}
        self.assertEqual(rows, set(tags))
        known = {part for tag in tags for part in tag.split(",")}
        cited = 0
        for path in (path for folder in ("src", "tests", "scripts", "docs", "options") for path in sorted((ROOT / folder).rglob("*"))):
            if not path.is_file() or path.suffix in (".png", ".jpg", ".svg", ".h5", ".stl", ".nrrd") or "__pycache__" in path.parts:
                continue
            text = path.read_text(errors="replace")
            for numbers in re.findall(r"method\.md\)?,? sections? (\d+(?:(?:,| and| to) \d+)*)", text):
                self.assertLessEqual({int(n) for n in re.findall(r"\d+", numbers)}, set(sections), path)
                cited += 1
            for equation in re.findall(r"method\.md\)?, \((\d+[a-z]?)\)", text):
                self.assertIn(equation, known, path)
                cited += 1
        self.assertGreater(cited, 50)

    def test_scripts_that_are_mentioned_exist(self):
        for page in pages():
            for name in set(re.findall(r"\bscripts/[a-z0-9_./]+[a-z0-9_]", page.read_text())):
                self.assertTrue((ROOT / name).exists(), f"{page.name}: {name}")

    def test_options_that_are_mentioned_exist(self):
        present = (ROOT / "docs/options.md").read_text().split("## Former names")[0]
        known = {name.replace("NAME_", "") for name in re.findall(r"^\| `-(\w+)`", present, re.MULTILINE)}
        petsc = ("log_", "ksp_", "pc_", "pressure_", "malloc", "info", "mat_", "vec_", "sf_", "da_", "dm_", "options_",
                 "memory_", "mg_", "ff", "fno", "fopenmp", "march")  # of the compiler
        for page in pages():
            text = page.read_text().split("## Former names")[0] if page.name == "options.md" else page.read_text()
            for name in set(re.findall(r"`-([a-z]\w+)", text)):
                name = re.sub(r"_[xyz](min|max)(?![a-z])", "_SIDE", name)
                plain = re.sub(r"^(rbc|cell|disc|gel|layer|a|b|vessel)_", "", name)
                self.assertTrue(plain in known or name in known or name.startswith(petsc) or
                                any(k.startswith(name) for k in known) or name in ("help", "version", "n"),
                                f"{page.name}: -{name}")


if __name__ == "__main__":
    unittest.main()
