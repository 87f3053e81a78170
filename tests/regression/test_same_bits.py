#!/usr/bin/python3
"""Every case of options/ for a few steps: the same state hash, series and measures of bodies on 1 to 4 ranks, with
threads, with AVX-512 and without, and with nothing skipped and the work space spoilt (programs that differ from the usual one in
that only: tests/CMakeLists.txt).

Needs EULASTIC, EULASTIC_MPIEXEC, EULASTIC_AVX2 and EULASTIC_WHOLE.
"""
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import h5py

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "tests/support"))
from processor import has_avx512  # noqa: E402
from test_cases import CASES, coarse  # noqa: E402

MPIEXEC = os.environ.get("EULASTIC_MPIEXEC", "mpiexec")
STEPS = 4


class SameBits(unittest.TestCase):
    compared = different = 0  # cases with a method, in one more way

    @classmethod
    def tearDownClass(cls):
        print(f"{len(CASES)} cases, fast and classic: {cls.compared} state hashes compared, {cls.different} different")
        if not has_avx512():
            print("skipped: without AVX-512, which this processor does not have")

    def setUp(self):
        room = tempfile.TemporaryDirectory()
        self.addCleanup(room.cleanup)
        self.room = pathlib.Path(room.name)

    def run_program(self, *words, ranks=1, program="EULASTIC"):
        command = [MPIEXEC, "--oversubscribe", "-n", str(ranks)] if ranks > 1 else []
        done = subprocess.run([*command, os.environ[program], *words, "-output_dir", self.room / "run",
                               "-output_overwrite"], capture_output=True, text=True, timeout=300,
                              env=dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1"))
        self.assertEqual(done.returncode, 0, done.stderr)
        summary = json.loads((self.room / "run/summary.json").read_text())
        self.assertEqual(summary["ranks"], ranks)
        summary["series"] = (self.room / "run/series.csv").read_text()
        if summary["bodies"]:
            with h5py.File(self.room / "run/bodies.h5") as bodies:
                summary["measures"] = {name: bodies[name][...].tobytes() for name in bodies}
        return summary

    def summary(self, case, *options, **how):
        summary = self.run_program(ROOT / f"options/{case}.opts", "-grid_cells", coarse(case), "-time_steps_max",
                                   str(STEPS), "-snapshot_interval", "0", *options, **how)
        self.assertEqual(summary["steps"], STEPS)
        return summary

    def same(self, one, other, way):
        SameBits.compared += 1
        SameBits.different += other["state_hash"] != one["state_hash"]
        for what in "state_hash", "series", "measures":
            self.assertEqual(other.get(what), one.get(what), way)

    def compare(self, method):
        skipped = 0
        for case in CASES:
            with self.subTest(case):
                options = ["-method", method, "-time_step", "0"]
                one = self.summary(case, *options)
                for n in (2, 3, 4):
                    self.same(one, self.summary(case, *options, ranks=n), f"{n} ranks")
                for ranks, threads in ((1, 3), (2, 2)) if case == "channel_rbc" else ((1, 3),):
                    summary = self.summary(case, *options, "-threads", str(threads), ranks=ranks)
                    self.assertEqual(summary["threads"], threads)
                    self.same(one, summary, f"{ranks} ranks, {threads} threads each")
                if has_avx512():
                    self.same(one, self.summary(case, *options, program="EULASTIC_AVX2"), "without AVX-512")
                whole = self.summary(case, *options, program="EULASTIC_WHOLE")
                self.same(one, whole, "nothing skipped, work space spoilt")
                if not one["bodies"]:
                    continue
                self.assertGreaterEqual(whole["active_fraction"], 1)
                skipped += one["active_fraction"] < 0.9

        self.assertGreater(skipped, 3)

    def test_fast(self):
        self.compare("fast")

    def test_classic(self):
        self.compare("classic")

    def test_rows_that_fill_and_empty(self):
        # Two bodies of unlike phases go round a tall box: rows without solid are not read, and fill again.
        scene = ("-grid_cells 24,80,1 -grid_length 1.2,4,1 -fluid_viscosity 1e-3 -initial_velocity_mean .3,1,0 "
                 "-species a,b -a_shape sphere -a_radius .3 -a_centre .9,1,0 -a_shear_modulus .05 "
                 "-b_shape sphere -b_radius .25 -b_centre .2,2.4,0 -b_shear_modulus .1 -time_end .8 "
                 "-guard_volume_drift 0").split()
        for method in ("classic", "fast"):
            with self.subTest(method):
                run = lambda **how: self.run_program(*scene, "-method", method, **how)
                one = run()
                self.assertEqual(run(program="EULASTIC_WHOLE")["state_hash"], one["state_hash"])
                self.assertEqual(run(ranks=2)["state_hash"], one["state_hash"])

    def test_phases_that_swap_ghosts_behind_walls(self):
        # What the upper disc is swapped with holds the tube's ghosts behind the lower wall, where the disc has nothing.
        scene = ("-grid_cells 12,48,1 -grid_length 3.6,14.4,.3 -fluid_viscosity 1 -body_force .05,0,0 -boundary_x wall "
                 "-boundary_y wall -species a,b -a_shape cylinder -a_radius .44 -a_axis z -a_centre 2.2,9,0 "
                 "-a_shear_modulus .1 -b_shape tube -b_radius .99 -b_axis y -b_centre 1.7,7,0 -b_shear_modulus .1 "
                 "-time_end 1000 -time_steps_max 8 -guard_volume_drift 0 -method").split()
        for method in ("classic", "fast", "fast -interface_scheme weno5", "classic -solid_exterior extrapolate"):
            with self.subTest(method):
                run = lambda **how: self.run_program(*scene, *method.split(), **how)
                one = run()
                self.assertEqual(run(program="EULASTIC_WHOLE")["state_hash"], one["state_hash"])
                self.assertEqual(run(ranks=2)["state_hash"], one["state_hash"])

    def test_many_bodies(self):
        # More than summary.json lists, and on four ranks not as many for each.
        scene = ("-grid_cells 250,164,1 -grid_length 250,164,1 -fluid_viscosity 1 -initial_velocity_mean 1,.5,0 -species "
                 "a,b -a_shape sphere -a_radius 2.2 -a_count 41,26,1 -a_placement lattice -a_shear_modulus .1 -b_shape "
                 "sphere -b_radius 1.2 -b_centre 6.1,6.3,0 -b_shear_modulus .1 -time_end 1000 -time_steps_max 3").split()
        one = self.run_program(*scene)
        self.assertEqual(len(one["bodies"]), 500)
        with h5py.File(self.room / "run/bodies.h5") as bodies:
            self.assertEqual(bodies["id"][...].tolist(), list(range(1, 1068)))
            volume = bodies["volume"][-1]
        self.assertEqual([body["volume"] for body in one["bodies"]], volume[:500].tolist())
        for n in (2, 3, 4):
            other = self.run_program(*scene, ranks=n)
            self.same(one, other, f"{n} ranks")
            self.assertEqual(other["bodies"], one["bodies"])

    def test_turned_bodies_with_prestrain(self):
        # B = R diag(l^2) R^T: a turned disc relaxes as one that is not turned, on any ranks.
        scene = ("-grid_cells 96,96,1 -grid_length 2,2,1 -fluid_viscosity 1 -species a -a_shape ellipsoid -a_semi_axes "
                 ".24,.15,.2 -a_shear_modulus 1 -a_initial_stretch 1.25,.8,1 -a_centre .53,.26,.5 -time_end .5").split()
        energy = {}
        for angle in (0, 30, 90):
            one = self.run_program(*scene, "-a_orientation", f"0,0,{angle}")
            energy[angle] = one["elastic_energy"]
            for n in (2, 3, 4):
                self.same(one, self.run_program(*scene, "-a_orientation", f"0,0,{angle}", ranks=n), f"{n} ranks")
        start = 0.5 * math.pi * .24 * .15 * (1.25 ** 2 + .8 ** 2 - 2)
        self.assertLess(energy[0], .8 * start)
        self.assertAlmostEqual(energy[30] / energy[0], 1, delta=.02)
        self.assertAlmostEqual(energy[90] / energy[0], 1, delta=1e-3)
        solid = ("-grid_cells 24,20,18 -grid_length 1.2,1,.9 -boundary_z wall -fluid_viscosity 1 -species a -a_shape "
                 "biconcave -a_diameter .5 -a_shear_modulus 1 -a_initial_stretch 1.2,.9,.9259259259259258 -a_placement "
                 "random -a_count 3 -a_orientation random -time_end 1 -time_steps_max 3").split()
        one = self.run_program(*solid)
        for n in (2, 4):
            self.same(one, self.run_program(*solid, ranks=n), f"{n} ranks")

    def test_body_that_crosses_ranks_along_x(self):
        # x is cut at a multiple of 256 cells only: whoever receives the body has seen nothing but empty rows before. The
        # other one crosses the ends of x, which are wrapped within rows or exchanged.
        scene = ("-grid_cells 512,16,1 -grid_length 32,1,1 -fluid_viscosity 1e-2 -initial_velocity_mean -1,.2,0 "
                 "-species a,b -a_shape sphere -a_radius .3 -a_centre 16.9,.5,0 -a_shear_modulus .05 "
                 "-b_shape sphere -b_radius .25 -b_centre .5,.4,0 -b_shear_modulus .1 -time_end .9").split()
        for method in ("classic", "fast", "fast -solid_exterior identity", "fast -interface_scheme weno5",
                       "classic -solid_exterior extrapolate"):
            with self.subTest(method):
                options = [*scene, "-method", *method.split(), "-guard_volume_drift", "0"]
                one = self.run_program(*options)
                for split in (("-da_processors_x", "2"), ("-da_processors_x", "2", "-da_processors_y", "2")):
                    cut = self.run_program(*options, *split, ranks=2 * (len(split) // 2))
                    self.assertEqual(cut["state_hash"], one["state_hash"])


if __name__ == "__main__":
    unittest.main()
