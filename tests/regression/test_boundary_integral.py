"""scripts/studies/validation/boundary_integral.py against the laws of docs/method.md, exact ellipsoids, theory of small deformation
and another boundary-integral code."""
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "scripts"), str(ROOT / "scripts/studies")]
sys.dont_write_bytecode = True
from validation import ellipsoids  # noqa: E402
from validation.boundary_integral import STARTUPS, Capsule, Membrane, extrapolated, moments, sphere, startup  # noqa: E402
from validation.case import reference  # noqa: E402


def drop(halvings, ratio, times, box=None):
    return startup(Capsule(*sphere(halvings), math.inf, ratio=ratio, box=box), times, .1)


def small(halvings, box=None, capillary=.003):
    """D/Ca when it is steady: the slow mode has decayed by exp(-.248 times 24)."""
    return startup(Capsule(*sphere(halvings), capillary, box=box), [24 * capillary], .2 * capillary)[0, 0] / capillary


class BoundaryIntegral(unittest.TestCase):
    def test_the_sphere_is_closed_and_turned_outwards(self):
        for halvings, nodes in enumerate((12, 42, 162)):
            x, triangles = sphere(halvings)
            self.assertEqual((x.shape, triangles.shape), ((nodes, 3), (2 * nodes - 4, 3)))
            volume, second = moments(x, triangles)
            self.assertAlmostEqual(volume, 4 / 3 * math.pi, delta=1e-12)
            numpy.testing.assert_allclose(second, second[0, 0] * numpy.eye(3), atol=1e-12)

    def test_tension_of_a_stretched_triangle(self):
        """(26): what the corners pull with, times their place, is -tau times the area."""
        x = numpy.array([(0, 0, 0), (1, .2, 0), (.3, 1.1, 0)])
        f = numpy.array([(1.3, .2, 0), (0, .9, 0), (0, 0, 1)])
        b, plane = (f @ f.T)[:2, :2], numpy.eye(2)
        j = math.sqrt(numpy.linalg.det(b))
        area = j * numpy.linalg.norm(numpy.cross(x[1], x[2])) / 2
        i1, i2 = numpy.trace(b) - 2, j * j - 1
        turn = numpy.linalg.qr(numpy.array([(1, 2, 3), (0, 1, -1), (1, 1, 0.)]))[0]
        for law, tau in (("neo_hookean", 7 / j * (b - plane / j**2)), ("skalak", 7 / j * ((i1 + 1) * b + j * j * (3 * i2 - 1) * plane))):
            place = x @ f.T @ turn.T
            forces = Membrane(x, numpy.array([(0, 1, 2)]), law, 7, 3).forces(place)
            numpy.testing.assert_allclose((turn.T @ place.T @ forces @ turn)[:2, :2], -area * tau, atol=1e-12)
            numpy.testing.assert_allclose(forces.sum(axis=0), 0, atol=1e-12)

    def test_a_drop_without_tension_is_the_exact_ellipsoid(self):
        """Errors of second order, and little after them: the double layer."""
        for ratio, times in ((5, (.5, 1, 1.5)), (.2, (.4,))):
            coarse, fine = (drop(halvings, ratio, times) for halvings in (1, 2))
            exact = ellipsoids.drop((1, 1, 1), 45, ratio, times)
            numpy.testing.assert_allclose((coarse - exact)[:, 0] / (fine - exact)[:, 0], 4, atol=.6)
            numpy.testing.assert_allclose(extrapolated(coarse, fine)[:, 0] / exact[:, 0], 1, atol=.003)
            numpy.testing.assert_allclose(extrapolated(coarse, fine)[:, 1], exact[:, 1], atol=.02)

    def test_walls_and_images(self):
        """Of a drop, as in ellipsoids.py; of a capsule that turns as a rigid sphere, whose stresslet is 10/3 pi."""
        box, free = (drop(1, 5, [1.], where)[0] for where in ((4, 5, 4), None))
        exact, alone = (ellipsoids.drop((1, 1, 1), 45, 5, [1.], where)[0] for where in ((4, 5, 4), None))
        self.assertAlmostEqual((box / free)[0], (exact / alone)[0], delta=.003)
        walls = 1 / (1 - 10 / 3 * math.pi * ellipsoids.images((6, 6, 6))[:2].sum())
        self.assertAlmostEqual(small(1, (6, 6, 6)) / small(1), walls, delta=.006)

    def test_small_deformation(self):
        """25/12 Ca, and the error falls faster than with the square of the spacing."""
        coarse, fine = (small(halvings) / (25 / 12) - 1 for halvings in (1, 2))
        self.assertLess(abs(fine), .02)
        self.assertLess(4 * abs(fine), abs(coarse))

    def test_another_boundary_integral_code(self):
        known = reference("capsule_startup")[[4, 8]]
        coarse, fine = (startup(Capsule(*sphere(halvings), .15), known[:, 0], .04) for halvings in (1, 2))
        numpy.testing.assert_allclose(extrapolated(coarse, fine)[:, 0] / known[:, 1], 1, atol=.005)

    def test_the_references_are_remade(self):
        """On a coarser mesh: as far as that changes them."""
        name = STARTUPS[1].name
        with tempfile.TemporaryDirectory() as room:
            subprocess.run([ROOT / "scripts/studies/validation/capsule_startups", name, "--nodes", "162", "--output", room], check=True,
                           stdout=subprocess.DEVNULL)
            lines = (pathlib.Path(room) / f"{name}.csv").read_text().splitlines()
        found = numpy.array([[float(x) for x in line.split(",")] for line in lines if line[0].isdigit()])
        self.assertEqual(lines[3], "t,D,inclination,D_in_box,inclination_in_box")
        numpy.testing.assert_allclose(found[1:, [1, 3]], reference(name)[1:, [1, 3]], rtol=.01)
        for start in STARTUPS:
            self.assertEqual(list(reference(start.name)[1:, 0]), list(start.times))


if __name__ == "__main__":
    unittest.main()
