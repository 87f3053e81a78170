#!/usr/bin/python3
"""Rigid bodies that turn through the grid, of a shape or from a file: mirrored, the same bits, and what is refused."""
import os
import pathlib
import subprocess
import sys
import unittest

import h5py
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
sys.dont_write_bytecode = True
from scene_case import BINARY, SceneCase  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
BOX = "-grid_cells 40,32,32 -grid_length 2.5,2,2 -boundary_y wall -fluid_viscosity .05 -species vane -vane_law rigid".split()
COARSE = ["30,24,24" if word == "40,32,32" else word for word in BOX]  # for what does not depend on the grid
SHAPE = "-vane_shape ellipsoid -vane_semi_axes .6,.3,.4 -vane_centre 1.2,1,1".split()
FILE = "-vane_shape voxels -vane_voxels ellipsoid.stl -vane_centre 1.2,1,1".split()
MOTION = "-vane_velocity .3,0,0 -vane_angular_velocity .4,0,1".split()


class Turning(SceneCase):
    def make_file(self):
        subprocess.run([ROOT / "scripts/make_vessel", self.room / "ellipsoid.stl", "--length", "2.4,1.2,1.6"], check=True,
                       stdout=subprocess.DEVNULL)
        return [word.replace("ellipsoid.stl", str(self.room / "ellipsoid.stl")) for word in FILE]

    def test_an_ellipsoid_of_a_file(self):
        """It goes and turns like the shape that it is of: phi, force and torque."""
        end = "-time_end .4 -series_interval .05 -snapshot_interval .4 -snapshot_precision double".split()
        file = self.make_file() + "-vane_voxels_origin 0,.4,.2".split()
        fields, loads = [], []
        for name, body in (("shape", SHAPE), ("file", file)):
            run = self.run_program(name, *BOX, *body, *MOTION, *end)
            with h5py.File(run.directory / "snapshot_000001.h5") as snapshot:
                fields.append(snapshot["solid_fraction"][...])
            loads.append(numpy.concatenate((run.bodies.force[4:, 0], run.bodies.torque[4:, 0]), axis=1))
        off = abs(fields[1] - fields[0])
        print(f"    phi: {off.max():.3f} at most, {off.sum() / fields[0].sum():.2e} of the volume")
        self.assertLess(off.sum() / fields[0].sum(), .03)
        self.assertGreater(off.max(), 0)
        scale = abs(loads[0]).max(axis=0)
        off = abs(loads[1] - loads[0]).mean(axis=0)
        print("    loads off by", numpy.array2string(off / scale, precision=3))
        for which in 0, 5:  # what the motion makes
            self.assertLess(off[which] / scale[which], .05)

    def test_same_bits_and_mirrored(self):
        file = self.make_file() + "-vane_voxels_origin 0,.4,.2".split()
        for name, body in (("shape", SHAPE), ("file", file)):
            scene = [*COARSE, *body, *MOTION, "-time_end", ".1", "-series_interval", ".05"]
            runs = [*self.run_together({f"{name}{ranks}": (scene, {"ranks": ranks}) for ranks in (1, 2, 3)}).values()]
            self.assertEqual(len({run.summary["state_hash"] for run in runs}), 1, name)
            for run in runs[1:]:
                numpy.testing.assert_array_equal(run.bodies.torque, runs[0].bodies.torque)
        turned = []
        for sign in "", "-":
            run = self.run_program("mirror" + sign, *COARSE, *SHAPE, "-vane_orientation", f"0,0,{sign}20", "-vane_angular_velocity",
                                   f"0,0,{sign}1", "-time_end", ".3", "-series_interval", ".1", "-pressure_solver", "smac")
            turned.append(run.bodies.torque[:, 0])
        numpy.testing.assert_allclose(turned[0] * [-1, 1, -1], turned[1], rtol=0, atol=1e-6 * abs(turned[0]).max())

    def test_refused(self):
        with h5py.File(self.room / "thin.h5", "w") as file:
            file["thin"] = numpy.zeros((32, 32, 40))
            file["thin"][14:18, 16, 10:30] = 1
            file["wide"] = numpy.zeros((32, 32, 40))
            file["wide"][10:20, 10:20] = 1
        at = f"-vane_shape voxels -vane_voxels {self.room / 'thin.h5'}:"
        turn = "-vane_angular_velocity 0,0,1"
        for options, says in ((f"{at}thin {turn}", ("-vane_voxels: ", "three cells thick")),
                              (f"{at}wide {turn}", ("-vane_voxels: ", "reaches the boundaries of the box along x")),
                              (f"{at}wide -vane_velocity 1,0,0", ("-vane_voxels: ", "reaches the boundaries of the box along x")),
                              (" ".join([*self.make_file(), "-vane_voxels_origin 0,-.2,.2", turn]),
                               ("-vane_angular_velocity: rotates a body to y = ", "two cells from the boundaries")),
                              (" ".join([*SHAPE, turn, "-method classic"]), ("-vane_angular_velocity: ", "-method fast")),
                              ("-vane_shape tube -vane_radius .5 -vane_axis z " + turn, ("-vane_angular_velocity: ", "accepted"))):
            done = subprocess.run([BINARY, *BOX, *options.split(), "-time_end", ".1", "-output_dir", self.room / "refused"],
                                  capture_output=True, text=True, timeout=60, env=os.environ)
            self.assertEqual(done.returncode, 2, (options, done.stderr))
            self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
            for piece in says:
                self.assertIn(piece, done.stderr)
            self.assertFalse((self.room / "refused").exists())


if __name__ == "__main__":
    unittest.main()
