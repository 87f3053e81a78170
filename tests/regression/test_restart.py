#!/usr/bin/python3
"""Restarts give the bits of the uninterrupted run, or are refused.

Needs EULASTIC=path of the binary and EULASTIC_MPIEXEC.
"""
import pathlib
import random
import shutil
import sys
import unittest

import h5py
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from restart_case import FLAT, SOLID, ATTACHED, OFTEN, Restart  # noqa: E402


class SameBits(Restart):
    def check(self, case, options, before, after, steps=12):
        end = lambda n: ["-time_steps_max", n]
        self.run_case("whole", *case, *options, *end(2 * steps))
        self.run_case("run", *case, *options, *end(steps), *OFTEN, ranks=before)
        self.assertEqual(self.summary("run")["exit_reason"], "steps")
        shutil.copytree(self.room / "run", self.room / "first")
        self.run_case("run", *case, *options, *end(2 * steps), "-restart", "run", ranks=after)
        self.assert_same("whole", "run")
        # Elsewhere, with other intervals: the state does not care.
        self.run_case("other", *case[:-2], *options, *end(2 * steps), "-restart", "first", "-series_interval", ".05",
                      "-snapshot_interval", ".3")
        self.assert_same("whole", "other", outputs=False)

    def test_flat_fast_acm(self):
        self.check(FLAT, [], before=1, after=4)

    def test_flat_classic_smac(self):
        self.check(ATTACHED, "-method classic -pressure_solver smac".split(), before=3, after=2)

    def test_solid_fast_smac(self):
        self.check(SOLID, ["-pressure_solver", "smac"], before=2, after=3)

    def test_solid_classic_acm(self):
        self.check(SOLID, "-method classic -time_step .013".split(), before=2, after=1, steps=13)

    def test_solid_fast_acm(self):
        self.check(SOLID, [], before=3, after=2)

    def test_attached_fast_acm(self):
        self.check(ATTACHED, "-acm_coarse false -acm_iterations_max 4".split(), before=0, after=0)

    def test_travelling_body(self):
        case = " ".join(FLAT[:FLAT.index("-bead_law")]) + (" -bead_law rigid -bead_velocity .6,.2,0 -bead_velocity_angular_frequency "
                                                          ".7 -bead_velocity_phase .4 -bead_angular_velocity 0,0,1")
        self.check(case.split() + FLAT[-4:], [], before=2, after=3)

    def test_turning_bodies(self):
        """An ellipse that turns as it goes, and a cross from a file that rocks."""
        cross = numpy.zeros((1, 16, 20))
        cross[0, 5:12, 12:15], cross[0, 7:10, 10:17] = 1, 1
        with h5py.File(self.room / "cross.h5", "w") as file:
            file["solid"] = cross
        at = FLAT.index("-bead_shape")
        case = [word.replace("cell,bead", "cell,bead,cross") for word in FLAT[:at]] + (
            "-bead_shape ellipsoid -bead_semi_axes .4,.3,1 -bead_centre 1.6,1.5,0 -bead_law rigid -bead_velocity .05,0,0 "
            "-bead_angular_velocity 0,0,1 -cross_shape voxels -cross_voxels cross.h5:solid -cross_law rigid "
            "-cross_centre 3.4,2.1,0 -cross_angular_velocity 0,0,.8 -cross_angular_velocity_angular_frequency 3").split()
        self.check(case + FLAT[-4:], [], before=2, after=3)

    def test_pulled_membrane(self):
        case = " ".join(FLAT[:FLAT.index("-bead_law")]) + (" -bead_law membrane -bead_surface_shear_modulus .5 "
                                                          "-bead_stretch_force .2 -bead_stretch_volume_fraction .1")
        self.check(case.split() + FLAT[-4:], [], before=2, after=3)

    def test_membrane(self):
        """A row of every step: those that the restart computes anew have the bits of those that come with the forces."""
        case = " ".join(FLAT[:FLAT.index("-bead_law")]) + (" -bead_law membrane -bead_surface_shear_modulus .5 "
                                                          "-bead_bending_modulus .01")
        self.check(case.split() + FLAT[-4:-1] + ["1e-9"], [], before=2, after=3)

    def test_flat_viscosities(self):
        self.check(FLAT, "-cell_viscosity 1.5 -bead_viscosity .03".split(), before=2, after=3)

    def test_fluid_alone(self):
        case = FLAT[:FLAT.index("-species")] + FLAT[-4:]
        self.run_case("whole", *case, "-time_steps_max", 20)
        self.run_case("run", *case, "-time_steps_max", 10, *OFTEN)
        self.run_case("run", *case, "-time_steps_max", 20, "-restart", "run")
        self.assertEqual(self.summary("run")["state_hash"], self.summary("whole")["state_hash"])
        self.assertEqual(self.series("run"), self.series("whole"))

    def test_a_later_end(self):
        # The last step to the first end is shortened: the checkpoint is the state before it.
        case = [*FLAT[:-4], "-series_interval", ".11", "-snapshot_interval", ".23"]
        self.run_case("whole", *case, "-time_end", "1.5")
        self.run_case("run", *case, "-time_end", ".83", "-checkpoint_interval", ".5")
        first = self.summary("run")
        self.assertEqual((first["exit_reason"], first["time"]), ("time_end", 0.83))
        with h5py.File(self.checkpoints()[-1]) as file:
            self.assertEqual(file["step"][0], first["steps"] - 1)
            self.assertLess(file["time"][0], 0.83)
        self.run_case("run", *case, "-time_end", "1.5", "-restart", "run")
        self.assert_same("whole", "run")
        names = lambda directory: sorted(p.name for p in (self.room / directory).glob("snapshot*"))
        self.assertEqual(names("run"), names("whole"))
        self.assertEqual((self.room / "run/snapshots.xdmf").read_text(),
                         (self.room / "whole/snapshots.xdmf").read_text())
        self.assertNotIn("-restart", (self.room / "run/options.txt").read_text())

    def test_rows_that_wait_and_probes_that_do_not(self):
        """A row is written after the next step: one that waits when a checkpoint is made is that of the whole run too, and
        probes of its time are there once."""
        for interval in (1e-9, .11):
            options = [*FLAT[:-2], "-series_interval", interval, "-probe_points", "1.1,2,0:3,1.5,0"]
            self.run_case("whole", *options, "-time_steps_max", 9)
            self.run_case("run", *options, "-time_steps_max", 4)
            self.run_case("run", *options, "-time_steps_max", 6, "-restart", "run", "-snapshot_interval", ".05")
            self.run_case("run", *options, "-time_steps_max", 9, "-restart", "run", "-snapshot_interval", "0")
            self.assertEqual(self.series("run"), self.series("whole"))
            rows = lambda name: (self.room / name / "probes.csv").read_text().splitlines()
            self.assertEqual([row for row in rows("run") if row in rows("whole")], rows("whole"))
            self.assertEqual(len(set(rows("run"))), len(rows("run")))
            if interval < 1e-3:
                self.assertEqual(rows("run"), rows("whole"))
            for name in "whole", "run":
                shutil.rmtree(self.room / name)

    def test_looking_and_keeping_do_not_touch_the_run(self):
        for n, case in enumerate((FLAT, SOLID)):
            self.run_case(f"plain{n}", *case, "-time_steps_max", 15)
            self.run_case(f"busy{n}", *case[:-2], "-series_interval", "1e-9", "-snapshot_interval", ".1",
                          "-checkpoint_keep", 3, *OFTEN, "-time_steps_max", 15)
            self.assert_same(f"plain{n}", f"busy{n}", outputs=False)
            self.assertEqual([p.name for p in self.checkpoints(f"busy{n}")],
                             [f"checkpoint_{n:08}.h5" for n in (13, 14, 15)])

    def test_older_one_by_name(self):
        self.run_case("whole", *FLAT, "-time_steps_max", 16)
        self.run_case("run", *FLAT, "-time_steps_max", 12, "-checkpoint_keep", 9, *OFTEN)
        self.run_case("run", *FLAT, "-time_steps_max", 16, "-checkpoint_keep", 9, "-restart", "run/checkpoint_00000007.h5")
        self.assert_same("whole", "run")
        # Those after step 7 belonged to a run that is no more.
        self.assertEqual([p.name for p in self.checkpoints()], [f"checkpoint_{n:08}.h5" for n in (4, 5, 6, 7, 16)])
        # At its end already: nothing to do, and the summary says so.
        self.run_case("run", *FLAT, "-time_steps_max", 16, "-restart", "run")
        self.assertEqual((self.summary("run")["exit_reason"], self.summary("run")["steps"]), ("steps", 16))

    def test_what_guards_and_summary_compare_with_is_that_of_all_runs(self):
        case = [*FLAT, "-method", "classic", "-time_step", ".01"]
        self.run_case("whole", *case, "-time_steps_max", 12)
        for n, options in ((4, []), (8, ["-restart", "run"]), (12, ["-restart", "run"])):
            self.run_case("run", *case, "-time_steps_max", n, *options)
        self.assertEqual(self.summary("run")["mach_max"], self.summary("whole")["mach_max"])
        with h5py.File(self.checkpoints("run")[-1]) as run, h5py.File(self.checkpoints("whole")[-1]) as whole:
            for name in "energy_made", "mach_max":
                self.assertEqual(list(run[name]), list(whole[name]), name)

    def test_a_changed_time_step_holds_from_the_first_step(self):
        case = [*FLAT[:-2], "-method", "classic", "-series_interval", "1e-9"]
        self.run_case("run", *case, "-time_steps_max", 3, "-time_step", ".01")
        steps = lambda: [float(row.split(",")[2]) for row in self.series("run").splitlines()[-2:]]
        self.run_case("run", *case, "-time_steps_max", 5, "-time_step", ".005", "-restart", "run")
        self.assertEqual(steps(), [.005, .005])
        self.run_case("run", *case, "-time_steps_max", 7, "-restart", "run")
        self.assertNotEqual(steps()[0], .005)  # the automatic one


class Refusals(Restart):
    def test_options(self):
        self.run_case("run", *SOLID, "-time_steps_max", 4, *OFTEN)
        def changed(name, value):
            case = list(SOLID)
            if name in case:
                case[case.index(name) + 1] = value
            else:
                case += [name, value]
            return [*case, "-restart", "run", "-output_dir", "new"]
        for name, value in [("-grid_cells", "12,10,10"), ("-grid_length", "3,2.5,2.3"), ("-boundary_y", "periodic"),
                            ("-cell_radius", ".6"), ("-cell_shear_modulus", "2"), ("-fluid_viscosity", ".4"),
                            ("-boundary_zmax_velocity", "0,0,0"), ("-method", "classic"), ("-interface_scheme", "weno5"),
                            ("-cell_placement", "lattice")]:
            with self.subTest(name):
                case = changed(name, value)
                if name == "-cell_placement":
                    at = case.index("-cell_centre")
                    case[at:at + 2] = ["-cell_count", "2,1,1"]
                self.refused(*case, says=[name, "cannot change at a restart"])
        at = SOLID.index("-species")
        self.refused(*SOLID[:at], *SOLID[-4:], "-restart", "run", "-output_dir", "new", says=["-species", "not given"])
        self.refused(*changed("-time_steps_max", "3"), says=["-time_steps_max", "step 4"])
        self.refused(*changed("-time_end", "1e-3"), says=["-time_end", "already"])
        self.refused(*SOLID, "-restart", "nowhere", says=["-restart", "nowhere"])
        self.refused(*SOLID, "-restart", ".", "-output_dir", "new", says=["-restart", "no checkpoint"])
        self.assertFalse((self.room / "new").exists(), "something was written")
        for options in ("-pressure_solver smac", "-acm_search_directions 0", "-acm_search_directions 3", "-time_step .01", "-acm_iterations_max 2"):
            with self.subTest(options):
                shutil.rmtree(self.room / "new", ignore_errors=True)
                self.run_case("new", *SOLID, *options.split(), "-time_steps_max", 6, "-restart", "run")

    def test_damage(self):
        case = [*FLAT, "-time_steps_max", "8", "-checkpoint_keep", "2"]
        self.run_case("whole", *FLAT, "-time_steps_max", 12)
        self.run_case("good", *case, *OFTEN)
        shutil.copytree(self.room / "good", self.room / "run")
        older, newest = self.checkpoints()
        good = newest.read_bytes()
        again = [*FLAT, "-time_steps_max", "12", "-output_dir"]

        def refuse(content, says):
            newest.write_bytes(content)
            self.refused(*again, "new", "-restart", newest, says=["-restart", newest.name, older.name, *says])

        refuse(good[:len(good) // 2], ["damaged or truncated"])
        refuse(b"", ["damaged or truncated"])
        refuse(b"once upon a time\n" * 400, ["not an HDF5 file"])
        with h5py.File(newest, "w") as file:
            file["velocity_x"] = numpy.zeros(3)
        refuse(newest.read_bytes(), ["not a checkpoint of this program"])
        newest.write_bytes(good)
        with h5py.File(newest, "r+") as file:
            file.attrs["format"] = 0
        refuse(newest.read_bytes(), ["format 0", "this program reads format 5"])
        newest.write_bytes(good)
        with h5py.File(newest, "r+") as file:
            file["velocity_x"][0, 3, 4] += 1e-15
        refuse(newest.read_bytes(), ["velocity_x", "checksum"])
        newest.write_bytes(good)
        with h5py.File(newest, "r+") as file:
            del file["pressure"].attrs["checksum"]
        refuse(newest.read_bytes(), ["pressure", "checksum"])

        # A directory: the older one, and it says so.
        result = self.call(*again, "run", "-restart", "run", ranks=2)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stderr, r"\Aeulastic: warning: -restart: [^\n]*" + newest.name + r"[^\n]*\n\Z")
        self.assertIn(older.name, result.stderr)
        self.assert_same("whole", "run")
        for path in self.checkpoints():
            path.unlink()
        newest.write_bytes(good[:5000])
        self.refused(*again, "run", "-restart", "run", says=[newest.name, "no older one"])

    def test_flipped_bits(self):
        self.run_case("whole", *FLAT, "-time_steps_max", 5)
        self.run_case("run", *FLAT, "-time_steps_max", 4, *OFTEN, "-checkpoint_keep", 1)
        path = self.checkpoints()[0]
        good = path.read_bytes()
        random.seed(3)
        refused = 0
        # The first two kilobytes and the names are metadata; anywhere else are mostly values.
        for at in [random.randrange(2048) for _ in range(9)] + [random.randrange(len(good)) for _ in range(9)]:
            bad = bytearray(good)
            bad[at] ^= 1 << random.randrange(8)
            path.write_bytes(bad)
            shutil.rmtree(self.room / "new", ignore_errors=True)
            result = self.call(*FLAT, "-time_steps_max", 5, "-restart", path, "-output_dir", "new")
            with self.subTest(byte=at):
                if result.returncode == 0:  # a bit that nobody reads
                    self.assert_same("whole", "new", outputs=False)
                else:
                    refused += 1
                    self.assertEqual(result.returncode, 2, result.stderr)
                    self.assertRegex(result.stderr, r"\Aeulastic: error: -restart: [^\n]+\n\Z")
        self.assertGreater(refused, 6)


if __name__ == "__main__":
    unittest.main()
