#!/usr/bin/python3
"""wall_shear_stress of snapshots against plane Poiseuille flow, where it is exact, and the series of a square duct.

Needs EULASTIC.
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
sys.dont_write_bytecode = True
from read_run import Run  # noqa: E402

STEADY = ("-fluid_viscosity 1 -body_force 1,0,0 -fluid_inertia false -time_end 4 -snapshot_interval 4 -snapshot_precision "
          "double -snapshot_fields wall_shear_stress -pressure_solver smac").split()


def duct(z):
    """Stress on the side y = 0 of a square duct of side 1 that a unit force per volume drives."""
    m = numpy.arange(1, 4001, 2)[:, None]
    return 4 / numpy.pi ** 2 * (numpy.tanh(m * numpy.pi / 2) * numpy.sin(m * numpy.pi * z) / m ** 2).sum(axis=0)


class WallShearStress(unittest.TestCase):
    def setUp(self):
        room = tempfile.TemporaryDirectory()
        self.addCleanup(room.cleanup)
        self.room = pathlib.Path(room.name)

    def stress(self, wall, *words):
        done = subprocess.run([os.environ["EULASTIC"], *words, *STEADY, "-output_dir", self.room / "run",
                               "-output_overwrite"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return Run(self.room / "run").snapshots[-1]["wall_shear_stress_" + wall][..., 0].astype(float)

    def test_plane_poiseuille_is_exact(self):
        for n in (8, 17):
            for wall in ("ymin", "ymax"):
                found = self.stress(wall, "-grid_cells", f"4,{n},1", "-grid_length", f"{4 / n},1,1", "-boundary_y", "wall")
                numpy.testing.assert_allclose(found, 0.5, rtol=1e-9)

    def test_moving_wall(self):
        found = self.stress("ymax", "-grid_cells", "4,16,1", "-grid_length", ".25,1,1", "-boundary_y", "wall",
                            "-wall_ymax_velocity", "3,0,0")
        numpy.testing.assert_allclose(found, 0.5 - 3, rtol=1e-9)

    def test_square_duct_is_second_order(self):
        errors = []
        for n in (8, 16, 32):
            found = self.stress("ymin", "-grid_cells", f"4,{n},{n}", "-grid_length", f"{4 / n},1,1", "-boundary_y", "wall",
                                "-boundary_z", "wall")
            z = (numpy.arange(n) + 0.5) / n
            middle = abs(z - 0.5) < 0.25  # in the corners the exact stress has a logarithm in its curvature
            errors.append(abs(found[:, 0, 0] - duct(z))[middle].max() / duct(numpy.array([0.5]))[0])
            self.assertAlmostEqual(found.mean(), 0.25, delta=1e-8)  # the force on the fluid over four sides
        orders = numpy.log2(numpy.array(errors[:-1]) / errors[1:])
        print(f"duct: largest error {errors}, order {orders}")
        self.assertGreater(orders.min(), 1.8)
        self.assertLess(errors[-1], 1e-3)


if __name__ == "__main__":
    unittest.main()
