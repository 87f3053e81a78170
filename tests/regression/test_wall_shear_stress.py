#!/usr/bin/python3
"""wall_shear_stress of snapshots: on walls of the box against plane Poiseuille flow, where it is exact, and the series of a
square duct; on rigid and elastic surfaces anywhere in the grid against Poiseuille's flow between plates and in a tube.

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
from eulastic import Run  # noqa: E402

def steady(end):
    """A flow that is steady at `end`."""
    return (f"-fluid_viscosity 1 -body_force 1,0,0 -fluid_inertia false -time_end {end} -snapshot_interval {end} -snapshot_precision "
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
        done = subprocess.run([os.environ["EULASTIC"], *words, *steady(4), "-output_dir", self.room / "run",
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
                            "-boundary_ymax_velocity", "3,0,0")
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

    def on_surface(self, *words, end=4):
        """Stress along x in the cells that the surface cuts, others' and other components' being 0."""
        done = subprocess.run([os.environ["EULASTIC"], *words, *steady(end), "-output_dir", self.room / "run",
                               "-output_overwrite"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        snapshot = Run(self.room / "run").snapshots[-1]
        stress = snapshot["wall_shear_stress"].astype(float)
        self.assertLess(abs(stress[..., 1:]).max(), 1e-5)
        return stress[..., 0]

    def test_channel_of_rigid_slabs(self):
        """Exact where both surfaces lie alike in their cells. Else u - exact is a line between t (1 - t) h^2/2 at both, t what
        is left to the next point of the grid in parts of h: the errors are opposite and of second order."""
        for low, high in ((0.25, 0.75), (0.21, 0.79), (0.21, 0.766), (0.1875, 0.8001)):
            for n in (16, 32):
                stress = self.on_surface("-grid_cells", f"4,{n},1", "-grid_length", f"{4 / n},1,1", "-species", "low,high",
                                         *f"-low_shape slab -low_axis y -low_interval 0,{low} -low_law rigid".split(),
                                         *f"-high_shape slab -high_axis y -high_interval {high},1 -high_law rigid".split())
                found, width = stress[0, :, 0], high - low
                self.assertEqual(numpy.count_nonzero(found), 2)
                errors = found[found != 0] - width / 2
                self.assertAlmostEqual(errors.sum(), 0, delta=1e-7)
                self.assertLess(abs(errors).max(), 1e-7 if abs(low + high - 1) < 1e-9 else 1 / (8 * width * n ** 2))

    def tube(self, across, centre, law):
        """Errors over all cells that the surface cuts, in parts of R/2 times the force."""
        radius, cells = 0.385, round(across / 0.77)
        stress = self.on_surface("-grid_cells", f"4,{cells},{cells}", "-grid_length", f"{4 / cells},1,1", "-boundary_y", "wall",
                                 "-boundary_z", "wall", "-species", "vessel", "-vessel_shape", "tube", "-vessel_axis", "x",
                                 "-vessel_radius", str(radius), "-vessel_centre", f"0,{centre}", *law, end=1)  # exp(-5.78/R^2) = 1e-17
        errors = stress[stress != 0] / (radius / 2) - 1
        self.assertGreater(errors.size, 4 * 5 * across / 2)  # every cell of the circumference
        return errors

    def tubes(self, law, centres):
        """RMS, largest and mean error with 10, 20, 40 cells across, and the order of the first."""
        errors = [numpy.concatenate([self.tube(across, centre, law) for centre in centres]) for across in (10, 20, 40)]
        rms = numpy.array([numpy.sqrt((e ** 2).mean()) for e in errors])
        largest = numpy.array([abs(e).max() for e in errors])
        mean = numpy.array([e.mean() for e in errors])
        order = numpy.log2(rms[0] / rms[-1]) / 2
        print(f"tube, {law}: rms {rms}, largest {largest}, mean {mean}, order {order:.2f}")
        return rms, largest, mean, order

    def test_rigid_tube_anywhere_in_the_grid(self):
        rms, largest, _, order = self.tubes(("-vessel_law", "rigid"), ("0.5,0.5", "0.513,0.487", "0.533,0.479"))
        self.assertGreater(order, 1.5)
        self.assertLess(rms[1], 1e-3)
        self.assertLess(largest[1], 2.5e-3)

    def test_elastic_tube(self):
        rms, _, mean, order = self.tubes(("-vessel_shear_modulus", "10"), ("0.513,0.487",))
        self.assertGreater(order, 1)
        self.assertLess(rms[-1], 0.03)
        self.assertLess(abs(mean[-1]), 0.005)


if __name__ == "__main__":
    unittest.main()
