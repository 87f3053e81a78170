#!/usr/bin/python3
"""The program from outside: exit codes, one line on stderr, nothing written after wrong input, -help, -version.

Needs EULASTIC=path of the binary; EULASTIC_MPIEXEC for the runs on several ranks.
"""
import json
import math
import os
import pathlib
import pty
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/support"))

from program import BINARY, MPIEXEC, launcher  # noqa: E402

SCENE = ("-grid_cells 8,8,8 -boundary_y wall -time_end 1e-3 -time_step 1e-3 -species cell -cell_shape sphere "
         "-cell_radius .25 -cell_shear_modulus 1").split()


class CommandLine(unittest.TestCase):
    def setUp(self):
        room = tempfile.TemporaryDirectory()
        self.addCleanup(room.cleanup)
        self.room = pathlib.Path(room.name)

    def run_program(self, *arguments, ranks=0, environment=None, stdout=subprocess.PIPE):
        variables = {k: v for k, v in os.environ.items() if k != "PETSC_OPTIONS"}
        variables.update(environment or {})
        return subprocess.run([*launcher(ranks), BINARY, *arguments], cwd=self.room, env=variables, stdout=stdout,
                              stderr=subprocess.PIPE, text=True, timeout=120)

    def refused(self, *arguments, says=(), environment=None):
        before = sorted(self.room.rglob("*"))
        result = self.run_program(*arguments, environment=environment)
        self.assertEqual(result.returncode, 2, arguments)
        self.assertEqual(result.stdout, "", arguments)
        self.assertRegex(result.stderr, r"\Aeulastic: error: [^\n]+\n\Z", arguments)
        for piece in says:
            self.assertIn(piece, result.stderr)
        self.assertEqual(sorted(self.room.rglob("*")), before, "something was written")

    def test_refusals(self):
        for added, says in [
                ("-grid_cels 8,8,8", ["-grid_cels", "-grid_cells"]),
                ("-series_interval", ["-series_interval", "missing"]),
                ("-threads 0", ["-threads", "out of range", "an integer"]),
                ("-threads two", ["-threads", "two"]),
                ("-body_force 1,,0", ["-body_force", "empty item"]),
                ("-body_force 1,0", ["-body_force", "3 numbers"]),
                ("-fluid_density 1x", ["-fluid_density", "1x", "a number > 0"]),
                ("-fluid_density nan", ["-fluid_density", "not finite"]),
                ("-fluid_density inf", ["-fluid_density", "not finite"]),
                ("-body_force -inf,0,0", ["-body_force", "not finite"]),
                ("-fluid_density -1", ["-fluid_density", "out of range"]),
                ("-time_end 1", ["-time_end", "given twice"]),
                ("-method slow", ["-method", "classic"]),
                ("-fluid_inertia maybe", ["-fluid_inertia", "true or false"]),
                ("missing.opts", ["missing.opts"]),
                ("word another", ["another"]),
                ("-cell_radius", ["-cell_radius"]),
                ("-cell_colour red", ["-cell_colour"]),
                ("-boundary_ymin_velocity 0,1,0", ["-boundary_ymin_velocity", "normal"]),
                ("-boundary_xmin_velocity 0,1,0", ["-boundary_xmin_velocity", "-boundary_x wall"]),
                ("-cell_placement list -cell_positions no.csv", ["-cell_positions", "no.csv"]),
                ("-da_processors_y 3", ["rank"])]:
            with self.subTest(added):
                self.refused(*SCENE, *added.split(), says=says)
        self.refused("-series_interval", "1", says=["-time_end", "must be given"])
        self.refused("-time_end", "1", "-species", "wall", says=["-species", "wall"])
        self.refused("-time_end", "1", "-species", "a,a", says=["-species", "twice"])
        self.refused(*SCENE, environment={"PETSC_OPTIONS": "-nonsense 1"}, says=["-nonsense", "PETSC_OPTIONS"])

    def test_too_large(self):
        self.refused("-time_end", "1", "-grid_cells", "1290,1290,1290", says=["-grid_cells", "; accepted: "])
        self.refused("-time_end", "1", "-guard_memory", "1e-9", says=["GB on a node", "-guard_memory"])

    def test_check_only_refuses_too(self):
        self.refused(*SCENE, "-check_only", "-time_steps_max", "1.5", says=["-time_steps_max", "an integer"])

    def test_petsc_output_stays_away_from_errors(self):
        self.refused(*SCENE, "-log_view", "-nonsense", says=["-nonsense"])

    def test_petsc_options_that_nobody_reads(self):
        for added, says in [("-mat_foo 1", ["-mat_foo", "unknown to PETSc"]), ("-log_vew", ["-log_vew", "-log_view"]),
                            ("-log_view no.txt", ["-log_view", "no.txt", ":FILE"]),
                            ("-ksp_type cg", ["-ksp_type", "-pressure_ksp_type"])]:
            with self.subTest(added):
                self.refused(*SCENE, *added.split(), says=says)

    def test_no_log_of_what_is_no_run(self):
        for question in "-check_only", "-print_options":
            result = self.run_program(*SCENE, question, "-log_view", ":log.xml:ascii_xml")
            self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertEqual(list(self.room.iterdir()), [])

    def test_log_counts_flops_of_what_computes(self):
        scene = ("-grid_cells 60,50,1 -grid_length 6,5,1 -time_end 100 -time_steps_max 2 -body_force 1,0,0 -fluid_viscosity .1 "
                 "-species cell,drop,capsule,post -cell_shape sphere -cell_radius .7 -cell_centre 1,1,0 -cell_shear_modulus 1 "
                 "-drop_shape sphere -drop_shear_modulus 0 -drop_viscosity .2 -drop_surface_tension 1 -drop_radius .7 "
                 "-drop_centre 3,1,0 -capsule_shape sphere -capsule_radius .7 -capsule_centre 5,1,0 -capsule_law membrane "
                 "-capsule_surface_shear_modulus 1 -post_shape sphere -post_radius .7 -post_centre 3,3.5,0 -post_law rigid "
                 "-post_velocity .1,0,0").split()
        result = self.run_program(*scene, "-log_view", ":log.txt")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        flops = dict.fromkeys("EulMomentum EulViscous EulTension EulMembrane EulRigid EulDivergence EulACM EulCorrect "
                              "EulFraction EulLeftCauchy EulExterior EulSums".split(), 0.)
        for line in (self.room / "log.txt").read_text().splitlines():
            words = line.split()
            if words and words[0] in flops:
                flops[words[0]] += float(words[5])
        self.assertEqual([verb for verb, count in flops.items() if not count > 0], [])

    def test_dm_view_shows_the_dmda_of_the_fields(self):
        """8 points along periodic directions, 9 between walls, and the split that -da_processors asks for."""
        for ranks, split, sizes in (1, (), "m 1 n 1 p 1"), (2, ("-da_processors_z", "2"), "m 1 n 1 p 2"):
            result = self.run_program(*SCENE, *split, "-dm_view", "-output_dir", f"run{ranks}", ranks=ranks)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn("type: da", result.stdout)
            self.assertRegex(result.stdout, rf"Processor \[0\] M 8 N 9 P 8 {sizes} w 1 s \d")

    def test_log_that_cannot_be_written(self):
        for ranks in (0, 2):
            result = self.run_program(*SCENE, "-log_view", ":/nowhere/log", "-output_dir", f"run{ranks}", ranks=ranks)
            self.assertRegex(result.stderr, r"\Aeulastic: error: at the end: [^\n]*/nowhere/log")
            self.assertNotIn("PETSC ERROR", result.stderr)
            self.assertEqual(result.returncode, 1)
            self.assertTrue((self.room / f"run{ranks}/summary.json").exists())

    def test_bodies_at_the_same_place_are_refused(self):
        """One of them would have no cells left; 0 and 8 are the same place in a periodic box. A smaller body within one is not."""
        scene = ("-grid_cells 16,16,16 -grid_length 8,8,8 -time_end 1e-3 -time_step 1e-3 -species a,b -a_shape sphere -a_radius 1 "
                 "-a_shear_modulus 1 -a_placement list -a_positions pair.csv -b_shape sphere -b_shear_modulus 1").split()
        for bodies, radius, pair in (("2,2,2\n0,6,6\n3,3,2\n8,6,6\n", ".9", "-species a: body 4 is at the same place as body 2 (a)"),
                                     ("6,6,6\n4,4,4\n", "1", "-species b: body 3 is at the same place as body 2 (a)"),
                                     ("6,6,6\n4,4,4\n", ".5", "")):
            (self.room / "pair.csv").write_text(bodies)
            for ranks in 0, 3:
                for more in (["-check_only"], []):
                    done = self.run_program(*scene, "-b_radius", radius, *more, "-output_overwrite", ranks=ranks)
                    self.assertEqual(done.returncode, 2 if pair else 0, done.stderr)
                    self.assertIn(pair, done.stderr)
                    self.assertEqual(done.stderr.count("eulastic: error:"), int(pair != ""))

    def test_bodies_placed_over_each_other_are_a_warning(self):
        (self.room / "pair.csv").write_text("2,2,2\n6,6,6\n5,6,6\n")
        scene = ("-grid_cells 16,16,16 -grid_length 8,8,8 -time_end 1e-3 -time_step 1e-3 -species a,b -a_shape sphere "
                 "-a_radius 1.5 -a_shear_modulus 1 -a_placement list -a_positions pair.csv -b_shape sphere "
                 "-b_shear_modulus 1 -b_radius 1 ").split()
        volume = math.pi * 1**2 * (4.5 - 1) / 3 * 2  # of a lens of two caps, 1 high
        text = r"warning: 2 bodies overlap as placed; first body 2 \(a\) and body 3 \(a\), which share a volume of " \
               r"at least (\S+), (\S+) % of body 3; correct -a_positions, or use -a_placement random\n"
        said = set()
        for ranks in 0, 1, 2, 3:
            answer = self.run_program(*scene, "-b_centre", "2,2,4.5", "-check_only", ranks=ranks)
            self.assertEqual((answer.returncode, answer.stderr), (0, ""))
            self.assertRegex(answer.stdout, text + r"\Z")
            done = self.run_program(*scene, "-b_centre", "2,2,4.5", "-output_overwrite", ranks=ranks)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertRegex(done.stderr, r"\Aeulastic: " + text)
            said |= {done.stderr.splitlines()[0], "eulastic: " + answer.stdout.splitlines()[-1]}
        self.assertEqual(len(said), 1, said)
        shared, percent = map(float, re.search(text, said.pop() + "\n").groups())
        self.assertTrue(0.9 * volume < shared < volume, shared)
        self.assertAlmostEqual(percent, 100 * shared / (4 / 3 * math.pi * 1.5**3), delta=0.1)
        three = self.run_program(*scene, "-b_centre", "2,2,4", "-check_only").stdout
        self.assertIn("warning: 4 bodies overlap as placed; first body 1 (a) and body 4 (b), ", three)
        self.assertIn("; correct -b_centre\n", three)

    def test_bodies_of_few_cells_are_a_warning(self):
        for radius, warning in ((".25", ""), (".1", "eulastic: warning: bodies of less than 8 cells: 1 of 1; ")):
            words = [radius if word == ".25" else word for word in SCENE]
            done = self.run_program(*words, "-output_dir", radius)
            self.assertEqual(done.returncode, 0)
            self.assertEqual(done.stderr[:len(warning)] if warning else done.stderr, warning)

    def test_surfaces_that_the_grid_does_not_resolve_are_a_warning(self):
        scene = ("-grid_cells 24,24,24 -grid_length 1,1,1 -boundary_y periodic -fluid_density 1 -fluid_viscosity 1 -time_end 1 "
                 "-time_steps_max 1 -output_overwrite -species a -a_shape ellipsoid").split()
        drop, membrane = ("-a_surface_tension 1 -a_shear_modulus 0".split(),
                          "-a_law membrane -a_surface_shear_modulus 1".split())
        for radius, kind, warning in ((".26", drop, ""), (".2", drop, "drops of a are 0.2 in radius where they are thinnest, 4.8"),
                                      (".26", membrane, ""), (".05", membrane, "membranes of a are 0.1 apart where they are")):
            done = self.run_program(*scene, "-a_semi_axes", f"{radius},.3,.3", *kind)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(done.stderr.startswith(f"eulastic: warning: {warning}"), bool(warning), done.stderr)

    def test_membranes_nearer_to_a_wall_than_a_cell_are_a_warning(self):
        """Solid sides of the box and rigid bodies that rest; a cell is .25."""
        scene = ("-grid_cells 24,16,16 -grid_length 6,4,4 -fluid_viscosity 1 -time_end 1 -time_steps_max 1 -output_overwrite "
                 "-species a -a_shape sphere -a_radius .8 -a_law membrane -a_surface_shear_modulus 1 ").split()
        symmetry = "-boundary_ymin symmetry -boundary_ymax wall -a_centre"
        for walls, near, far in ((symmetry, "3,3,2", "3,.9,2"), ("-boundary_y wall -a_centre", "3,1,2", "3,1.06,2"),
                                 ("-species a,v -v_law rigid -v_shape tube -v_radius 1.9 -v_axis x -a_centre", "3,2.9,2", "3,2.8,2"),
                                 ("-species a,v -v_law rigid -v_shape slab -v_axis y -v_interval 0,1 -a_centre", "3,2,2", "3,2.1,2"),
                                 ("-species a,v -v_law rigid -v_shape sphere -v_radius .5 -v_centre 1,2,2 -a_centre", "2.5,2,2", "2.6,2,2"),
                                 ("-species a,v -v_shape slab -v_axis y -v_interval 0,1 -v_shear_modulus 1 -a_centre", "", "3,2,2")):
            words = [word for word in scene if walls[:8] != "-species" or word not in ("-species", "a")]
            for centre, ranks in ((near, 1), (near, 2), (far, 1)):
                for only in (["-check_only"], []) if centre else ():
                    done = self.run_program(*words, *walls.split(), centre, *only, ranks=ranks if ranks > 1 else 0)
                    self.assertEqual(done.returncode, 0, done.stderr)
                    self.assertEqual("the membrane of body 1 (a) starts less than a cell, 0.25, from a wall" in done.stdout + done.stderr,
                                     centre == near, (walls, centre, only))

    def test_viscosities_far_from_the_fluids_are_a_warning(self):
        scene = ("-grid_cells 16,16,1 -grid_length 1,1,1 -boundary_y periodic -fluid_viscosity .5 -time_end 1 "
                 "-time_steps_max 1 -output_overwrite -species a -a_shape ellipsoid -a_semi_axes .3,.3,1 -a_shear_modulus 1 -a_viscosity").split()
        for viscosity, times, steps in (("9", None, None), (".02", "0.04", "100"), ("20", "40", "160")):
            for words in ([], ["-check_only"]):
                done = self.run_program(*scene, viscosity, *words)
                self.assertEqual(done.returncode, 0, done.stderr)
                said = re.findall(r"a is (\S+) times as viscous .* lags by about (\d+) steps", done.stdout + done.stderr)
                self.assertEqual(said, [(times, steps)] if times else [])

    def test_attached_bodies_too_stiff_for_the_grid_are_a_warning(self):
        scene = ("-grid_cells 16,16,1 -grid_length 2,1,1 -fluid_density 4 -fluid_viscosity 2 -boundary_y wall -time_end 1 "
                 "-time_steps_max 1 -output_overwrite -species a -a_shape slab -a_interval 0,.3 -a_shear_modulus").split()
        text = "a is anchored and too stiff for the grid: "  # sqrt(G/rho) h <= nu: G <= 4 (.5 16)^2 = 256
        for modulus, spacing in ((250, None), (260, "0.062"), (25600, "0.00625")):
            for words in ([], ["-check_only"]):
                done = self.run_program(*scene, str(modulus), *words)
                self.assertEqual(done.returncode, 0, done.stderr)
                said = [line for line in (done.stdout + done.stderr).splitlines() if text in line]
                self.assertEqual(len(said), spacing is not None, done.stdout + done.stderr)
                self.assertTrue(spacing is None or f"a spacing of at most {spacing}" in said[0], said)
        free = self.run_program(*scene, "260", "-a_anchored", "false", "-check_only")
        self.assertNotIn(text, free.stdout)

    def test_how_threads_wait(self):
        """Threads spin on processors of their own and sleep where they share them, unless EULASTIC_WAIT says otherwise."""
        allowed = os.sched_getaffinity(0)
        self.addCleanup(os.sched_setaffinity, 0, allowed)
        free = {"EULASTIC_WAIT": "", "OMPI_MCA_hwloc_base_binding_policy": "none"}

        def says(threads, ranks, processors, wanted=""):
            os.sched_setaffinity(0, set(sorted(allowed)[:processors]))
            done = self.run_program(*SCENE, "-threads", str(threads), "-output_dir", "run", "-output_overwrite", ranks=ranks,
                                    environment=free | {"EULASTIC_WAIT": wanted})
            self.assertEqual(done.returncode, 0, done.stderr)
            warning = (f"eulastic: warning: -threads {threads}: this rank may use {processors} processor(s); with Open MPI, "
                       f"mpiexec --map-by slot:PE={threads} gives a rank as many as it has threads\n")
            self.assertEqual(done.stderr, warning if threads > processors else "")
            line = re.findall(rf"^{max(ranks, 1) * threads} threads on {processors} processor\(s\) of this node (\w+) while they "
                              r"wait(?:, as EULASTIC_WAIT says)?$", done.stdout, re.MULTILINE)
            self.assertEqual(len(line), threads > 1, done.stdout)
            self.assertEqual("EULASTIC_WAIT" in done.stdout, bool(wanted))
            return line and line[0]

        self.assertFalse(says(1, 0, 1))
        self.assertEqual(says(2, 0, 1), "sleep")
        self.assertEqual(says(2, 0, 1, "spin"), "spin")
        if len(allowed) > 1:
            self.assertEqual(says(2, 0, 2), "spin")
            self.assertEqual(says(2, 0, 2, "sleep"), "sleep")
            self.assertEqual(says(2, 2, 2), "sleep")
        self.refused(*SCENE, "-threads", "2", "-output_dir", "wrong", environment={"EULASTIC_WAIT": "yield"},
                     says=["EULASTIC_WAIT", "yield", "spin, sleep"])

    def test_ranks_that_wait_give_up_the_core(self):
        """With the settings of scripts/environment, as MPI itself says; what the environment says before stays."""
        for given, yields in ({}, "true"), ({"OMPI_MCA_mpi_yield_when_idle": "0"}, "false"):
            environment = {k: v for k, v in os.environ.items() if k != "OMPI_MCA_mpi_yield_when_idle"}
            environment.update(given, OMPI_MCA_mpi_show_mca_params="enviro")
            done = subprocess.run([str(ROOT / "scripts/lib/in_environment"), *launcher(2), BINARY, "-version"],
                                  capture_output=True, text=True, timeout=120, env=environment)
            self.assertIn(f"mpi_yield_when_idle={yields}", done.stdout + done.stderr)

    def test_errors_on_several_ranks_are_printed_once(self):
        result = self.run_program(*SCENE, "-nonsense", ranks=3)
        self.assertEqual(result.returncode, 2)
        self.assertEqual(result.stderr.count("eulastic: error:"), 1)
        self.assertEqual(list(self.room.iterdir()), [])

    def test_help_and_version(self):
        for arguments in (["-help"], ["-version"], ["-nonsense", "-help"], ["-help", "markdown"], ["-h"], ["--help"]):
            with self.subTest(arguments):
                result = self.run_program(*arguments)
                self.assertEqual((result.returncode, result.stderr), (0, ""))
                self.assertIn("eulastic", result.stdout)
        self.assertIn("-grid_cells", self.run_program("-help").stdout)
        self.assertIn("-series_interval", self.run_program("-help").stdout)
        self.assertEqual(self.run_program("-version").stdout.count("\n"), 1)
        self.assertEqual(self.run_program("-help", ranks=2).stdout, self.run_program("-help").stdout)
        self.assertEqual(list(self.room.iterdir()), [])

    def test_usage_and_help_of_a_word(self):
        alone = self.run_program()
        self.assertEqual((alone.returncode, alone.stderr), (2, ""))
        self.assertLess(alone.stdout.count("\n"), 15)
        self.assertIn("-check_only", alone.stdout)
        self.assertEqual(self.run_program("--help").stdout, alone.stdout)
        self.assertEqual(self.run_program("-h").stdout, alone.stdout)
        found = re.findall(r"^  -(\w+)", self.run_program("-help", "stiffens").stdout, re.MULTILINE)
        self.assertEqual(found, ["NAME_c3"])
        self.refused("-help", "nonsense", says=["-help", "nonsense"])

    def test_what_there_is_not(self):
        self.refused(*SCENE, "-cell_density", "2", says=["-cell_density", "not supported", "README.md"])
        self.assertIn("\n## What it does not do\n", (ROOT / "README.md").read_text())

    def test_the_launchers_banner_is_not_there(self):
        """With the settings of scripts/environment, as scripts/run has them."""
        for words, status in ((["-nonsense"], 2), (["-guard_cfl", "1e-9", "-initial_velocity_mean", "1,0,0"], 3)):
            done = self.run_program(*SCENE, *words, ranks=2)
            self.assertEqual(done.returncode, status)
            self.assertRegex(done.stderr, r"\Aeulastic: error: [^\n]+\n\Z")

    def test_a_word_at_every_end(self):
        """The command that the last line names goes on with the run, from the directory where it was started."""
        case = [*SCENE[:SCENE.index("-time_end")], *SCENE[SCENE.index("-species"):], "-time_step", "1e-3"]
        for ranks, name in (0, "run"), (2, "a run of two"):
            done = self.run_program(*case, "-time_end", "3e-3", "-output_dir", name, ranks=ranks)
            first, last = done.stdout.splitlines()[0], done.stdout.splitlines()[-1]
            self.assertRegex(first, rf"^eulastic \S+: 8 x 8 x 8 cells on {ranks or 1} ranks?; results go to {name}$")
            self.assertRegex(last, rf"^eulastic: reached -time_end at t = 0.003, step 3; results: {name}; to continue: ")
            self.assertEqual("mpiexec -n 2" in last, ranks == 2)
            command = last.split("; to continue: ")[1].replace("LATER", "5e-3").replace("mpiexec", MPIEXEC)
            longer = subprocess.run(command, shell=True, cwd=self.room, capture_output=True, text=True, timeout=120)
            self.assertEqual((longer.returncode, longer.stderr), (0, ""))
            self.assertIn("reached -time_end at t = 0.005, step 5;", longer.stdout.splitlines()[-1])
            stopped = self.run_program(*case, "-time_end", "1e-2", "-output_overwrite", "-output_dir", name, "-guard_divergence",
                                       "1e-30", "-body_force", "1,0,0", "-checkpoint_interval", "1e-9", ranks=ranks)
            self.assertEqual(stopped.returncode, 3)
            self.assertRegex(stopped.stdout.splitlines()[-1], rf"^eulastic: stopped by a guard at t = .*; results: {name}; to "
                             r"continue from checkpoint_\d+\.h5, with the remedy of the error: .*eulastic.* -restart ")
            self.assertIn(json.loads((self.room / name / "summary.json").read_text())["checkpoint"], stopped.stdout)
        steps = self.run_program(*case, "-time_end", "1", "-time_steps_max", "4", "-checkpoint_keep", "0", "-output_dir", "s")
        self.assertRegex(steps.stdout.splitlines()[-1], "reached -time_steps_max at .*; there is no checkpoint to continue from$")

    def test_one_progress_line_in_a_terminal_lines_in_a_log(self):
        case = [*SCENE, "-output_overwrite", "-time_steps_max", "2"]
        for ranks in (0, 2):
            with self.subTest(ranks=ranks):
                log = self.run_program(*case, ranks=ranks)
                self.assertEqual(log.returncode, 0, log.stderr)
                self.assertNotIn("\x1b", log.stdout)
                self.assertIn("100.0 %", log.stdout)
                ours, theirs = pty.openpty()
                self.addCleanup(os.close, ours)
                done = self.run_program(*case, ranks=ranks, stdout=theirs)
                os.close(theirs)
                self.assertEqual(done.returncode, 0, done.stderr)
                shown = os.read(ours, 10000)
                if ranks:  # Open MPI gives rank 0 a terminal wherever its output goes to
                    self.assertIn(b"100.0 %", shown)
                    self.assertNotIn(b"\x1b", shown)
                else:
                    self.assertRegex(shown, rb"\r100.0 %[^\r\n]*\x1b\[K")

    def test_options_manual_is_up_to_date(self):
        self.assertEqual(self.run_program("-help", "markdown").stdout, (ROOT / "docs/options.md").read_text(),
                         "run: eulastic -help markdown > docs/options.md")

    def test_check_only(self):
        result = self.run_program(*SCENE, "-check_only", "-grid_cells", "2048,2048,2048")
        self.assertEqual(result.returncode, 2)  # -grid_cells twice
        case = self.room / "case.opts"
        case.write_text("".join(f"{n} {v}\n" for n, v in zip(SCENE[::2], SCENE[1::2])))
        result = self.run_program(case.name, "-check_only", "-grid_cells", "2048,2048,2048", "-body_force", "1,0,0")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        for line in ("cells: 2048 x 2048 x 2048 = 8589934592", "dt limit, viscous", "Reynolds number",
                     "capillary number of cell", "memory:", "hematocrit: 0.0654498"):
            self.assertIn(line, result.stdout)
        self.assertEqual([p.name for p in self.room.iterdir()], ["case.opts"])

    def test_check_only_tells_the_work_of_ranks(self):
        # Boxes of two discs, 18^2 cells of 4 each, both at home on the first of four ranks of 512 cells.
        (self.room / "two.csv").write_text("8,8,0\n24,8,0\n")
        discs = ("-grid_cells 32,64,1 -grid_length 32,64,1 -time_end 1 -cell_shape sphere -cell_radius 4.9 -cell_shear_modulus 1 "
                 "-cell_placement list -cell_positions two.csv -check_only").split()
        flow, disc, name = 512, 4 * 18**2, "work of the fullest rank / mean (estimate): "

        def line(*arguments, **ranks):
            done = self.run_program(*discs, *arguments, **ranks)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            return "".join(row for row in done.stdout.splitlines() if row.startswith("work of"))

        def expected(fullest, wall):
            total = 4 * flow + wall + 2 * disc
            parts = (f"{100 * part / total:.3g} % in {where}" for part, where in
                     ((4 * flow, "the flow"), (wall, "phases of the grid"), (2 * disc, "boxes")))
            return f"{name}{fullest / total * 4:.3f}; of all work {', '.join(parts)}"

        alone = ["-species", "cell", "-ranks", "4"]
        self.assertEqual(line(*alone), expected(flow + disc, 0))
        self.assertEqual(line(*alone, ranks=3), line(*alone))
        self.assertEqual(line("-species", "cell", ranks=4), line(*alone))
        # A slab that fills the third rank, 3 a cell, and seven rows of both beside it: the second disc goes to the second rank.
        slab = "-species cell,slab -slab_shape slab -slab_axis y -ranks 4 -slab_interval".split()
        wall = 3 * (16 + 14) * 32
        self.assertEqual(line(*slab, "32,48", "-slab_shear_modulus", "1"), expected(flow + 3 * 7 * 32 + disc, wall))
        self.assertEqual(line(*slab, "32,48", "-slab_law", "rigid"), expected(flow + disc, 0))
        # One that fills the last rank reaches the first across the periodic side: both discs go to the second rank.
        self.assertEqual(line(*slab, "48,64", "-slab_shear_modulus", "1"), expected(flow + 2 * disc, wall))
        for without in (["-ranks", "1"], ["-ranks", "4", "-method", "classic"], ["-ranks", "4", "-cell_contact", "merge"]):
            self.assertEqual(line("-species", "cell", *without), "")

    def test_every_case_is_valid(self):
        cases = sorted((ROOT / "options").glob("*.opts"))
        self.assertTrue(cases)
        for case in cases:
            with self.subTest(case.name):
                result = self.run_program(str(case), "-check_only")
                self.assertEqual((result.returncode, result.stderr), (0, ""))

    def test_options_txt_gives_the_same_run(self):
        (self.room / ".petscrc").write_text("-fluid_density 7\n-nonsense\n")
        result = self.run_program(*SCENE, "-output_dir", "first", environment={"PETSC_OPTIONS": "-fluid_density 3"})
        self.assertEqual(result.returncode, 0, result.stderr)
        text = (self.room / "first/options.txt").read_text()
        self.assertIn("\n-fluid_density 3\n", text)
        self.assertIn("# PETSC_OPTIONS: -fluid_density 3\n", text)
        self.refused("first/options.txt", says=["first"])  # the directory is there
        result = self.run_program("first/options.txt", "-output_dir", "second")
        self.assertEqual(result.returncode, 0, result.stderr)
        def values(name):
            lines = (self.room / name / "options.txt").read_text().splitlines()
            return [l for l in lines if l.startswith("-") and not l.startswith("-output_dir")]
        self.assertEqual(values("second"), values("first"))


if __name__ == "__main__":
    unittest.main()
