"""The exact solutions of scripts/studies/validation, exact.py and ellipsoids.py, against closed forms, sampling and their own equations."""
import math
import pathlib
import sys
import unittest

import numpy

sys.path[:0] = [str(pathlib.Path(__file__).resolve().parents[2] / folder) for folder in ("scripts", "scripts/studies")]
sys.dont_write_bytecode = True
from validation import ellipsoids, exact  # noqa: E402


class References(unittest.TestCase):
    def test_a_sheared_disc_comes_to_rest_where_the_closed_form_says(self):
        for capillary in (0.05, 0.1, 0.2, 0.5):
            d, xx, xy, yy = exact.sheared_disc(capillary, [30])[0]
            want, angle = exact.disc_in_shear(capillary)
            self.assertAlmostEqual(d, want, delta=1e-8)
            self.assertAlmostEqual(math.degrees(math.atan2(2 * xy, xx - yy)) / 2, angle, delta=1e-4)
            self.assertAlmostEqual(xx * yy - xy * xy, 1, delta=1e-7)

    def test_walls_raise_the_strain_rate_of_a_small_deformation(self):
        xy, yx, xx = exact.images_of_disc(1, 50)
        self.assertAlmostEqual(2 * math.pi * (xy + yx), 7.7445, delta=5e-5)  # of gd (R/H)^2: docs of S6
        self.assertAlmostEqual(exact.sheared_disc(0.01, [5], 16, 64)[0, 0], exact.disc_in_shear(0.01 / (1 - 7.7445 / 256))[0],
                               delta=1e-5)
        for one, other in zip(exact.images_of_disc(1, 50), exact.images_of_disc(1, 80)):
            self.assertAlmostEqual(one, other, delta=1e-12)  # far images are not felt
        for one, other in zip(exact.images_of_disc(2, 3), exact.images_of_disc(4, 6)):
            self.assertAlmostEqual(one, 4 * other, delta=1e-12)

    def test_turned_layers_obey_their_equations(self):
        mu, modulus, half, t, d = 0.05, 1, math.sqrt(0.125), 0.1, 1e-4
        layers = exact.TurnedLayers(half, mu, modulus, 0.3, -2.6 + 6.1j)
        w, gamma = layers.velocity, layers.shear

        def slope(f, eta, time=t):
            return (f(eta + d, time) - f(eta - d, time)) / (2 * d)

        def change(f, eta):
            return (f(eta, t + d) - f(eta, t - d)) / (2 * d)
        solid, fluid = numpy.array([-0.1, 0.0, 0.05, 0.15]), numpy.array([0.2, 0.3, 0.45])
        for eta, elastic in ((solid, modulus * slope(gamma, solid)), (fluid, 0)):
            viscous = mu * (w(eta + d, t) - 2 * w(eta, t) + w(eta - d, t)) / d**2
            numpy.testing.assert_allclose(change(w, eta), viscous + elastic, atol=2e-6)
        numpy.testing.assert_allclose(change(gamma, solid), slope(w, solid), atol=2e-6)
        s, tiny = half / 2, 1e-9
        self.assertAlmostEqual(float(w(s - tiny, t)), float(w(s + tiny, t)), delta=1e-7)

        def one_sided(direction):
            at = [float(w(s + direction * x, t)) for x in (tiny, d, 2 * d)]
            return (-3 * at[0] + 4 * at[1] - at[2]) / (2 * direction * d)
        self.assertAlmostEqual(mu * one_sided(-1) + modulus * float(gamma(s, t)), mu * one_sided(1), delta=1e-5)

    def test_the_duct_ends_as_poiseuille_and_begins_as_the_force(self):
        self.assertAlmostEqual(exact.duct_startup(9, 1, 1, 1)[0], 0.0736713, delta=1e-6)
        self.assertAlmostEqual(exact.duct_startup(1e-3, 1, 1, 1)[0], 1e-3, delta=1e-6)
        self.assertAlmostEqual(exact.duct_startup(0.4, 2, 2, 4)[0], 2 * exact.duct_startup(0.4, 1, 1, 1)[0], delta=1e-12)

    def test_a_rigid_spheroid_turns_as_jeffery_says(self):
        half = math.pi * (2 + 1 / 2)
        quarter, whole = ellipsoids.drop((1, 0.5, 1), 90, 1e9, [half / 2, half])
        numpy.testing.assert_allclose(quarter, (1 / 3, 0), atol=1e-3)
        numpy.testing.assert_allclose(whole, (1 / 3, -90), atol=1e-3)

    def test_a_drop_as_viscous_as_the_fluid_deforms_with_it(self):
        """Along axis 3, too, which does not change."""
        flow, start = numpy.array([[1, 1.5], [0, 1]]), numpy.diag([1, 0.25])
        squares, directions = numpy.linalg.eigh(flow @ start @ flow.T)
        short, long = numpy.sqrt(squares)
        angle = math.degrees(math.atan(directions[1, 1] / directions[0, 1]))
        numpy.testing.assert_allclose(ellipsoids.drop((1, 0.5, 0.7), 0, 1, [1.5])[0], ((long - short) / (long + short), angle),
                                      atol=1e-4)

    def test_a_drop_nearly_a_sphere_is_strained_as_taylor_says(self):
        self.assertAlmostEqual(ellipsoids.resistance((1, 1, 1)), 2.5, delta=1e-9)
        d = ellipsoids.drop((1, 1, 1), 0, 5, [1e-3])[0, 0]
        self.assertAlmostEqual(d, 5 / (2 * 5 + 3) * 1e-3 / 2, delta=1e-7)

    def test_walls_and_images_of_a_stresslet(self):
        sphere = 10 / 3 * math.pi  # its stresslet, in shear of rate 1
        self.assertAlmostEqual(sphere * ellipsoids.images((60, 1, 60))[:2].sum(), 14.249, delta=5e-4)
        for one, other in zip(ellipsoids.images((4, 5, 4)), ellipsoids.images((8, 10, 8))):
            self.assertAlmostEqual(one, 8 * other, delta=1e-6 * abs(one))

    def test_tank_treading_ends_at_the_largest_ratio(self):
        axes = 1, 0.5, 0.8
        most = ellipsoids.largest_ratio(axes)
        self.assertLess(ellipsoids.tank_treading(axes, most - 1e-6)[0], 0.1)
        self.assertTrue(math.isnan(ellipsoids.tank_treading(axes, most + 1e-6)[0]))
        # A neo-Hookean capsule at Ca = .15 by the boundary-integral method: its steady axes, angle and period.
        angle, rate = ellipsoids.tank_treading((1.2569, 0.7218, 1.0930), 1)
        self.assertAlmostEqual(angle, 0.1713 * 180, delta=1)
        self.assertAlmostEqual(-2 * math.pi / rate / 14.71, 1, delta=0.012)


if __name__ == "__main__":
    unittest.main()
