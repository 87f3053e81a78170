#!/usr/bin/python3
"""Membranes as options set them up."""
import pathlib
import sys
import unittest

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
sys.dont_write_bytecode = True
from scene_case import SceneCase  # noqa: E402

CAPSULE = ("-grid_cells 32,32,32 -grid_length 4,4,4 -fluid_viscosity 1 -species a -a_shape sphere -a_radius 1 "
           "-a_centre 2,2,2 -a_law membrane -a_surface_shear_modulus 1 -interface_scheme plic -time_step 1e-3 "
           "-time_end 2e-3 -series_interval 1e-3 -snapshot_interval 2e-3").split()


class Membranes(SceneCase):
    def test_orientation_turns_the_stretch(self):
        """Stretches along x and y, turned about z, are those along y and x: energy, and the flow that it drives."""
        straight = self.run_program("straight", *CAPSULE, "-a_initial_stretch", ".9,1.2,1.1")
        turned = self.run_program("turned", *CAPSULE, "-a_initial_stretch", "1.2,.9,1.1", "-a_orientation", "0,0,90")
        other = self.run_program("other", *CAPSULE, "-a_initial_stretch", "1.2,.9,1.1")
        round_off = 1e-9
        energy = straight.series.surface_energy
        self.assertGreater(energy[0], 0.1)
        self.assertLess(energy[-1], energy[0])
        numpy.testing.assert_allclose(turned.series.surface_energy, energy, rtol=round_off)
        speed = [run.snapshots[-1].velocity() for run in (straight, turned, other)]
        largest = abs(speed[0]).max()
        numpy.testing.assert_allclose(speed[1], speed[0], atol=round_off * largest)
        self.assertGreater(abs(speed[2] - speed[0]).max(), 0.1 * largest)

    def test_ends_are_pulled_apart(self):
        """The flow is its own mirror image, nothing moves as a whole, and the budget is closed."""
        capsule = CAPSULE[:CAPSULE.index("-time_end")]
        run = self.run_program("pulled", *capsule, *("-a_stretch_force .5 -a_stretch_volume .1 -time_end 2e-2 "
                                                     "-series_interval 1e-3 -snapshot_interval 2e-2 -snapshot_precision double").split())
        x, y, z = run.snapshots[-1].velocity()
        largest, round_off = abs(x).max(), 1e-9
        self.assertGreater(largest, 1e-4)
        numpy.testing.assert_allclose(x, -x[:, :, ::-1], atol=round_off * largest)
        numpy.testing.assert_allclose(y, y[:, :, ::-1], atol=round_off * largest)
        numpy.testing.assert_allclose(z, z[:, :, ::-1], atol=round_off * largest)
        self.assertGreater(x[16, 16, 24], 0.5 * largest)  # away from the middle
        self.assertLess(abs(x.mean()), round_off * largest)
        self.assertGreater(run.series.force_power[-1], 0)
        supplied = run.summary["energy_supplied"]
        self.assertLess(abs(run.summary["energy_lost"]), 0.005 * supplied)
        self.assertGreater(run.bodies.taylor_deformation[-1, 0], run.bodies.taylor_deformation[0, 0])


if __name__ == "__main__":
    unittest.main()
