#!/usr/bin/python3
"""What scripts draw and bin is the same on every processor: rounding (python/eulastic/rounding.py), and the means to run a test
without some features of this one (tests/support/fewer_features.py)."""
import pathlib
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

import numpy

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "python"))
sys.dont_write_bytecode = True
from eulastic import derived, rounding, scene  # noqa: E402

PROBE = """
import sys
import numpy.core._multiarray_umath as core
print(*sys.argv[1:], *(name for name in core.__cpu_dispatch__ if core.__cpu_features__[name]))
"""


class Rounding(unittest.TestCase):
    """One unit in the last place, by which logarithms and powers differ between processors, changes no scale."""

    def beside(self, value):
        """The value in single and double precision, and its neighbours below and above."""
        for kind in numpy.float32, numpy.float64:
            yield from (numpy.nextafter(kind(value), kind(0)), kind(value), numpy.nextafter(kind(value), kind(numpy.inf)))

    def test_up(self):
        for short in .001, .0099, .01, .02, .1, .37, 1, 25, 1000, 3e7:
            for value in self.beside(short):
                self.assertEqual(rounding.round_up(value), short)
        for value, wanted in ((0, 0), (.00101, .0011), (.0998, .1), (9.91, 10), (123.4, 130)):
            self.assertEqual(rounding.round_up(value), wanted)
        for value in numpy.nan, numpy.inf:
            self.assertTrue(numpy.isnan(rounding.round_up(value)))

    def test_down(self):
        for short in .001, .002, .05, 1, 5, 1000:
            for value in self.beside(short):
                self.assertEqual(rounding.round_down(value), short)
        for value, wanted in ((.00199, .001), (4.99, 2), (9.99, 5), (12, 10)):
            self.assertEqual(rounding.round_down(value), wanted)

    def test_floor(self):
        whole = numpy.arange(-3.0, 4)
        for values in whole, numpy.nextafter(whole, -numpy.inf), numpy.nextafter(whole, numpy.inf), whole + .999:
            numpy.testing.assert_array_equal(rounding.floor(values), whole)

    def test_range_of_stress(self):
        for value in self.beside(.001):
            snapshot = unittest.mock.MagicMock(fields=["wall_shear_stress_ymin", "pressure"])
            snapshot.__getitem__.return_value = numpy.array([[value, 0, 0], [0, 0, 0]])
            self.assertEqual(scene.stress_range([snapshot]), .001)
        self.assertEqual(scene.stress_range([unittest.mock.MagicMock(fields=["pressure"])]), 0)

    def test_range_on_a_plane(self):
        for low, wanted in ((0, (0, .004)), (-1, (-.002, .002))):
            for value in self.beside(.004 if low == 0 else .002):
                with unittest.mock.patch.multiple(scene, on_plane=lambda *_: numpy.array([low * value, value])), \
                        unittest.mock.patch.object(derived, "least", return_value=1e-9):
                    self.assertEqual(scene.plane_range([None]), wanted)


class FewerFeatures(unittest.TestCase):
    def test_features_are_taken_from_numpy(self):
        """No warning is printed, and the arguments of the script arrive."""
        for words, taken in (((), ("AVX512",)), (("--oldest",), ("AVX512", "AVX2", "FMA3"))):
            with tempfile.NamedTemporaryFile("w", suffix=".py") as probe:
                probe.write(PROBE)
                probe.flush()
                done = subprocess.run([sys.executable, ROOT / "tests/support/fewer_features.py", *words, probe.name, "-v"],
                                      capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            first, *left = done.stdout.split()
            self.assertEqual((first, [name for name in left if name.startswith(taken)]), ("-v", []))


if __name__ == "__main__":
    unittest.main()
