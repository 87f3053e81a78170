#!/usr/bin/python3
"""A run that is there is not replaced unaware, goes on with other options where docs/howto/long_run.md allows it, in directories
of any name; and files that somebody else changes meanwhile are noticed.

Needs EULASTIC and EULASTIC_MPIEXEC.
"""
import contextlib
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time
import unittest

import h5py
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from checksum import checksum, content, text_of  # noqa: E402
from restart_case import FLAT, OFTEN, ROOT, Restart  # noqa: E402

CASE = "\n".join(["-grid_cells 16,16,1", "-grid_length 1,1,1", "-fluid_viscosity .1", "-body_force 1,0,0", "-species disc",
                  "-disc_shape sphere", "-disc_radius .25", "-disc_shear_modulus 1", "-time_end .1", ""])
RIGID = "\n".join(["-grid_cells 16,16,1", "-grid_length 1,1,1", "-boundary_xmin inflow", "-boundary_xmax pressure",
                   "-boundary_y wall", "-fluid_viscosity .1", "-boundary_xmin_velocity 1", "-boundary_xmin_profile uniform",
                   "-time_end .1", ""])
NAMES = "out[1]", "out (2)", "it's", 'a "quoted" one', "colon:name", "star*?", "hash #1", "back\\slash", "tilde~ $HOME"


def listing(folder):
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.rglob("*")
            if path.is_file() and path.name != ".lock"}


class Kept(Restart):
    def setUp(self):
        super().setUp()
        self.case = self.room / "case.opts"
        self.case.write_text(CASE)

    def script(self, *words, at=None):
        return subprocess.run([ROOT / "scripts/run", "--ranks", "1", *map(str, words)], cwd=at or self.room, env=self.environment,
                              capture_output=True, text=True, timeout=120)

    def refused_by_script(self, *words, says, at=None):
        done = self.script(*words, at=at)
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertRegex(done.stderr, r"\Arun: [^\n]+\n\Z")
        self.assertIn(says, done.stderr)


class NotReplaced(Kept):
    def test_its_own_options_do_not_replace_a_run(self):
        self.run_case("trap", self.case, "-output_overwrite")
        options = self.room / "trap/options.txt"
        self.assertNotIn("output_overwrite", options.read_text())
        before = listing(self.room / "trap")
        self.refused(options, "-output_dir", "trap", "-time_end", ".05", says=["-output_dir", "-output_overwrite"])
        # As earlier versions wrote it, or in the environment: it counts only on the command line.
        old = self.room / "old.opts"
        old.write_text(options.read_text() + "-output_overwrite true\n")
        said = self.call(old, "-output_dir", "trap", "-time_end", ".05")
        self.assertEqual(said.returncode, 2)
        self.assertIn("-output_overwrite", said.stderr)
        self.environment["PETSC_OPTIONS"] = "-output_overwrite"
        self.refused(self.case, "-output_dir", "trap", says=["is not empty"])
        del self.environment["PETSC_OPTIONS"]
        self.assertEqual(listing(self.room / "trap"), before)
        self.run_case("trap", options, "-output_overwrite", "-time_end", ".05")
        self.assertEqual(self.summary("trap")["time"], .05)

    def test_a_restart_does_not_shorten_a_run(self):
        self.run_case("run", self.case, "-checkpoint_keep", 50, *OFTEN)
        before = listing(self.room / "run")
        first = self.checkpoints()[0]
        self.refused(self.case, "-restart", first, "-output_dir", "run", "-time_end", ".09", says=["-time_end", "t = 0.1", "-output_overwrite"])
        self.refused(self.case, "-restart", "run", "-output_dir", "run", "-time_end", ".0999999", says=["-time_end", "-output_overwrite"])
        self.assertEqual(listing(self.room / "run"), before)
        self.run_case("run", self.case, "-restart", first, "-time_end", ".09", "-output_overwrite")
        self.assertEqual(self.summary("run")["time"], .09)

    def test_script_replaces_when_asked(self):
        run = self.room / "run"
        self.assertEqual(self.script(self.case, run).returncode, 0)
        before = listing(run)
        self.refused_by_script(self.case, run, "-disc_radius", ".3", says="--replace")
        self.refused_by_script(self.case, run, "-time_end", ".05", says="--replace")
        self.refused_by_script(self.case, run, "-time_steps_max", "2", says="--replace")
        (self.room / "sub").mkdir()
        self.refused_by_script("../case.opts", "../run", "-fluid_density", "2", says="--replace", at=self.room / "sub")
        self.assertIn("already", self.script("../case.opts", "../run", at=self.room / "sub").stdout)
        self.assertIn("already", self.script(self.case, run, "-checkpoint_wall_minutes", "7").stdout)
        self.assertEqual(listing(run), before)
        self.assertEqual(self.script("--replace", self.case, run, "-time_end", ".05").returncode, 0)
        self.assertEqual(self.summary("run")["time"], .05)
        self.assertEqual(self.script(self.case, run, "-time_end", ".03", "--replace").returncode, 0)
        self.assertEqual(self.summary("run")["time"], .03)
        self.assertEqual(self.script(self.case, run, "-time_end", ".02", "-output_overwrite").returncode, 0)
        self.assertEqual(self.summary("run")["time"], .02)

    def test_script_goes_on_with_other_intervals(self):
        run = self.room / "run"
        self.case.write_text(CASE + "-series_interval .0005\n")  # what it would be by default
        self.environment["PETSC_OPTIONS"] = "-fluid_density 2"
        self.assertEqual(self.script(self.case, run).returncode, 0)
        del self.environment["PETSC_OPTIONS"]
        dense = "-fluid_density", "2"
        self.assertIn("already", self.script(self.case, run, *dense).stdout)
        self.refused_by_script(self.case, run, *dense, "-series_interval", ".01", says="is finished and has other options (")
        self.refused_by_script(self.case, run, *dense, "-pressure_solver", "smac", says="is finished and has other options (")
        self.refused_by_script(self.case, run, "-time_end", ".12", says="-fluid_density")
        self.assertIn("goes on", self.script(self.case, run, *dense, "-time_end", ".12").stdout)
        other = "-series_interval", ".01", "-guard_cfl", "2", "-pressure_solver", "smac", "-load_balance", "-snapshot_fields", "pressure"
        self.assertIn("goes on", self.script(self.case, run, *dense, *other, "-time_end", ".14").stdout)
        self.assertEqual((self.summary("run")["time"], self.summary("run")["pressure_solver"]), (.14, "smac"))

    def test_finished_and_without_checkpoint(self):
        run = self.room / "run"
        self.assertEqual(self.script(self.case, run, "-checkpoint_keep", "0").returncode, 0)
        before = listing(run)
        self.refused_by_script(self.case, run, "-checkpoint_keep", "0", "-time_end", ".2", says="no checkpoint")
        self.assertEqual(listing(run), before)

    def test_default_checkpoints(self):
        said = self.call(self.case, "-print_options").stdout
        self.assertIn("\n-checkpoint_wall_minutes 30\n", said)
        self.refused(self.case, "-checkpoint_keep", "0", "-checkpoint_wall_minutes", "5", says=["-checkpoint_wall_minutes", "-checkpoint_keep > 0"])
        self.run_case("none", self.case, "-checkpoint_keep", "0")
        self.assertEqual(self.checkpoints("none"), [])


class AnyName(Kept):
    def test_directories(self):
        for name in NAMES:
            with self.subTest(name):
                self.assertEqual(self.script(self.case, name, "-time_end", ".05").returncode, 0)
                self.assertIn("already", self.script(self.case, name, "-time_end", ".05").stdout)
                longer = self.script(self.case, name)
                self.assertIn("goes on from its checkpoint", longer.stdout, longer.stderr)
                self.assertEqual(self.summary(name)["time"], .1)
                line = longer.stdout.strip().splitlines()[-1]
                again = subprocess.run(["bash", "-c", re.search("to continue: (.*) -time_end", line)[1] + " -time_end .12"], cwd=self.room,
                                       env=self.environment, capture_output=True, text=True, timeout=120)
                self.assertEqual((again.returncode, again.stderr), (0, ""))
                self.assertEqual(self.summary(name)["time"], .12)

    def test_species(self):
        for name in "references", "first_volumes", "increment_0", "x", "before", "time", "hash", "species":
            with self.subTest(name):
                case = self.room / f"{name}.opts"
                case.write_text(CASE.replace("disc", name))
                result = self.call(case, "-output_dir", name, *OFTEN)
                if result.returncode == 2:  # a name that options have: refused, and nothing written
                    self.assertIn("collides", result.stderr)
                    self.assertFalse((self.room / name).exists())
                    continue
                self.assertEqual((result.returncode, result.stderr), (0, ""))
                self.run_case(name, case, "-restart", name, "-time_end", ".2")
                self.run_case(name + "_whole", case, "-time_end", ".2")
                self.assert_same(name, name + "_whole", outputs=False)

    def test_numbers_and_words_are_no_paths(self):
        (self.room / "sub").mkdir()
        case = self.room / "sub/inflow.opts"
        case.write_text(RIGID)
        for make in pathlib.Path.mkdir, pathlib.Path.touch:
            for name in "1", "uniform":
                make(self.room / "sub" / name)
            self.assertEqual(self.call(case, "-check_only").returncode, 0)
            self.assertIn("\n-boundary_xmin_velocity 1\n", self.call(case, "-print_options").stdout)
            for name in "1", "uniform":
                path = self.room / "sub" / name
                path.rmdir() if path.is_dir() else path.unlink()

    def test_quotes_in_options(self):
        (self.room / "q.opts").write_text(CASE + '-output_dir "a \\"b\\" \\\\ c\\d"\n')
        text = self.call(self.room / "q.opts", "-print_options").stdout
        self.assertIn('\n-output_dir "a \\"b\\" \\\\ c\\\\d"\n', text)
        (self.room / "again.opts").write_text(text)
        self.assertEqual(self.call(self.room / "again.opts", "-print_options").stdout, text)


class OtherOptions(Kept):
    def test_another_pressure_solver(self):
        self.run_case("one", self.case, *OFTEN)
        options = self.room / "one/options.txt"
        for solver in "smac", "ksp":
            result = self.call(options, "-restart", "one", "-output_dir", solver, "-time_end", ".2", "-pressure_solver", solver)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertRegex(result.stderr, r"\Aeulastic: warning: -acm_iterations_max [^\n]*-acm_coarse [^\n]*dropped[^\n]*-pressure_solver acm\n\Z")
            self.assertEqual(self.summary(solver)["pressure_solver"], solver)
            self.assertNotIn("-acm_", (self.room / solver / "options.txt").read_text())
        result = self.call("ksp/options.txt", "-restart", "ksp", "-output_dir", "back", "-time_end", ".3", "-pressure_solver", "acm")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        # As an earlier version wrote it.
        old = self.room / "old.opts"
        old.write_text(options.read_text().replace("-disc_law neo_hookean\n", "-disc_law neo_hookean\n-disc_membrane_law neo_hookean\n"))
        self.assertIn("-disc_membrane_law", old.read_text())
        self.run_case("old", old, "-restart", "one", "-time_end", ".2")
        newest = self.checkpoints("one")[-1]
        with h5py.File(newest, "r+") as file:
            text = numpy.frombuffer(old.read_bytes(), dtype=numpy.uint8)
            del file["options"]
            file["options"] = text
            file["options"].attrs["checksum"] = numpy.array(f"{checksum(text):016x}", dtype="S16")[()]
            file.attrs.modify("content", text_of(content(file)))
        self.run_case("older", old, "-restart", "one", "-time_end", ".2")
        old.write_text(old.read_text().replace("-disc_membrane_law neo_hookean", "-disc_membrane_law skalak"))
        self.refused(old, says=["-disc_membrane_law", "-disc_law membrane"])
        # Of the same source, and on the command line: refused as ever.
        self.refused(self.case, "-pressure_solver", "smac", "-acm_search_directions", "1", says=["-acm_search_directions", "-pressure_solver acm"])
        wrong = self.room / "wrong.opts"
        wrong.write_text(CASE + "-pressure_solver smac\n-acm_search_directions 1\n")
        self.refused(wrong, says=["-acm_search_directions", "wrong.opts:11"])

    def test_dropped_values_do_not_count(self):
        moving = self.room / "moving.opts"
        moving.write_text(CASE.replace("-body_force 1,0,0", "-boundary_y wall\n-boundary_ymax_velocity 3,0,0"))
        result = self.call(moving, "-boundary_y", "periodic", "-print_options")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertNotIn("-boundary_ymax_velocity", result.stdout)
        result = self.call(moving, "-boundary_y", "periodic", "-output_dir", "run")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("-boundary_ymax_velocity (", result.stderr)
        self.assertLess(self.summary("run")["kinetic_energy"], 1e-20)

    def test_outputs_and_intervals(self):
        self.run_case("one", self.case, *OFTEN, "-snapshot_interval", ".05", "-probe_points", ".5,.5,.5", "-profile_x", "mean")
        options = self.room / "one/options.txt"
        result = self.call(options, "-restart", "one", "-output_dir", "one", "-time_end", ".2", "-probe_points", "none", "-profile_x", "none",
                           "-snapshot_interval", "0", "-checkpoint_keep", "0")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stderr, r"\Aeulastic: warning: -checkpoint_interval [^\n]*-checkpoint_wall_minutes [^\n]*dropped[^\n]*\n\Z")

    def test_none_unsets(self):
        case = self.room / "viscous.opts"
        case.write_text(CASE + "-disc_viscosity .3\n-disc_contact merge\n")
        text = self.call(case, "-disc_viscosity", "none", "-disc_contact", "none", "-print_options").stdout
        self.assertEqual(text, self.call(self.case, "-print_options").stdout)
        diameter = self.room / "diameter.opts"
        diameter.write_text(CASE.replace("-disc_radius .25", "-disc_diameter 9"))
        self.refused(diameter, "-disc_radius", "none", says=["-disc_radius", "must be given"])
        self.refused(self.case, "-disc_viscosities", "none", says=["unknown option -disc_viscosities"])
        fluid = self.room / "fluid.opts"
        fluid.write_text("".join(line + "\n" for line in CASE.splitlines() if "disc_" not in line))
        self.run_case("fluid", fluid, "-species", "none")
        self.assertFalse((self.room / "fluid/bodies.h5").exists())

    def test_options_that_mean_nothing_for_a_law(self):
        rigid = [word for word in CASE.split() if word not in ("-disc_shear_modulus",)][:-3] + ["-time_end", ".1"]
        for options, says in (("-disc_membrane_law skalak", "-disc_law membrane or red_cell"), ("-disc_c1 1", "mooney_rivlin"),
                              ("-disc_velocity 1,0,0", "-disc_law rigid")):
            self.refused(self.case, *options.split(), says=[options.split()[0], says])
        for option, value in (("viscosity", "1"), ("surface_tension", "0"), ("body_force", "0,0,0"), ("body_force_phase", "0"),
                              ("initial_stretch", "1,1,1"), ("contact", "merge")):
            self.refused(*rigid, "-disc_law", "rigid", f"-disc_{option}", value, says=[f"-disc_{option}", "neo_hookean"])
        self.refused(*rigid, "-disc_law", "membrane", "-disc_surface_shear_modulus", "1", "-disc_skalak_c", "3",
                     says=["-disc_skalak_c", "-disc_membrane_law skalak"])


class Contents(Kept):
    def setUp(self):
        super().setUp()
        self.case.write_text(RIGID.replace("-boundary_xmin_velocity 1", "-boundary_xmin_velocity pulse.csv"))
        self.pulse = self.room / "pulse.csv"
        self.pulse.write_text("0,1\n1,1\n")

    def test_of_a_run_by_the_script(self):
        run = self.room / "run"
        self.assertEqual(self.script(self.case, run).returncode, 0)
        text = (run / "options.txt").read_text()
        content = re.search(r"\n-boundary_xmin_velocity pulse.csv\n# content ([0-9a-f]{16})\n", text)[1]
        self.assertEqual(self.summary("run")["files"], [{"option": "boundary_xmin_velocity", "path": "pulse.csv", "content": content}])
        (self.room / "sub").mkdir()
        self.assertIn("already", self.script("../case.opts", "../run", at=self.room / "sub").stdout)
        self.pulse.rename(self.room / "other.csv")
        self.assertIn("already", self.script(self.case, run, "-boundary_xmin_velocity", "other.csv").stdout)
        self.pulse.write_text("0,3\n1,3\n")
        self.refused_by_script(self.case, run, says="-boundary_xmin_velocity")
        self.assertEqual((run / "options.txt").read_text(), text)
        (self.room / "other.csv").rename(self.pulse)
        self.assertIn("already", self.script(self.case, run).stdout)

    def test_at_a_restart(self):
        self.run_case("run", self.case, *OFTEN)
        again = [self.case, "-restart", "run", "-output_dir", "on", "-time_end", ".2"]
        self.pulse.rename(self.room / "same.csv")
        self.pulse.write_text("0,1\n1,1.0\n")
        self.refused(*again, says=["-boundary_xmin_velocity: cannot change", "pulse.csv with the content"])
        self.assertFalse((self.room / "on").exists())
        self.run_case("on", *again[:3], "-time_end", ".2", "-boundary_xmin_velocity", "same.csv")

    def test_every_byte_counts(self):
        hashes = set()
        for text in ("0,1\n1,1\n", "0,1\n1,1\n\n", "0,1\n1,1\n ", " 0,1\n1,1\n", "0,1\n1,2\n", "0,2\n1,1\n", "0,1\n1,1\n" + " " * 600000,
                     "0,1\n1,1\n" + " " * 600001):
            self.pulse.write_text(text)
            hashes.add(re.search(r"# content (\w+)", self.call(self.case, "-print_options").stdout)[1])
        self.assertEqual(len(hashes), 8)


class Detached(Kept):
    def test_values_beside_a_header_are_a_part_of_the_case(self):
        """The values that a detached NRRD header names count as those of the header do; its place does not."""
        mask = numpy.zeros((16, 16), "u1")
        mask[5:11, 5:11] = 1
        (self.room / "one").mkdir()
        (self.room / "one/body.nhdr").write_text("NRRD0004\ntype: uchar\ndimension: 2\nsizes: 16 16\nencoding: raw\nspacings: .0625 .0625\n"
                                                 "space dimension: 2\nspace origin: (.03125,.03125)\ndata file: values.raw\n")
        values = self.room / "one/values.raw"
        values.write_bytes(mask.tobytes())
        case = [*CASE.replace("-disc_shape sphere\n-disc_radius .25", "-disc_shape voxels").replace("-time_end .1", "").split(), "-disc_voxels"]
        content = lambda path: re.search(r"# content (\w+)", self.call(*case, path, "-time_end", ".1", "-print_options").stdout)[1]  # noqa: E731
        first = content("one/body.nhdr")
        shutil.copytree(self.room / "one", self.room / "two")
        self.assertEqual(content("two/body.nhdr"), first)
        self.run_case("run", *case, "one/body.nhdr", "-time_end", ".1", *OFTEN)
        mask[8, 8] = 0
        values.write_bytes(mask.tobytes())
        self.assertNotEqual(content("one/body.nhdr"), first)
        again = ["-restart", "run", "-time_end", ".11", "-output_dir", "on"]
        self.refused(*case, "one/body.nhdr", *again, says=["-disc_voxels: cannot change", "one/body.nhdr with the content"])
        self.run_case("on", *case, "two/body.nhdr", *again[:4])


class Watched(Restart):
    def check(self, damage, name, options=()):
        shutil.rmtree(self.room / "run", ignore_errors=True)
        process = self.start(*FLAT[:-2], "-time_step", "1e-4", "-series_interval", "1e-9", *options, *OFTEN)
        self.wait_until(lambda: self.checkpoints() and (self.room / "run" / name).exists())
        limit = time.monotonic() + 60
        while process.poll() is None and time.monotonic() < limit:
            # Again and again: what is damaged while the program replaces the file by a whole one is whole again.
            with contextlib.suppress(FileNotFoundError):
                damage(self.room / "run" / name)
            time.sleep(.2)
        self.assertEqual(process.poll(), 1)
        errors = process.stderr.read()
        # One line that names the file; damage in the middle of writing is an error of that writing.
        self.assertRegex(errors, rf"\Aeulastic: error: [^\n]*{re.escape(name)}\b[^\n]*\n\Z")
        self.assertEqual(self.summary("run")["exit_reason"], "output_failed")

    def test_rows_that_vanish_or_are_cut(self):
        self.check(pathlib.Path.unlink, "series.csv")
        self.check(lambda path: os.truncate(path, 10), "series.csv")
        self.check(pathlib.Path.unlink, "bodies.h5")
        self.check(lambda path: os.truncate(path, 100), "bodies.h5")
        self.check(pathlib.Path.unlink, "probes.csv", ("-probe_points", "1,1,0"))


if __name__ == "__main__":
    unittest.main()
