#!/usr/bin/python3
"""Surfaces of bodies as files (scripts/render --surfaces), of known data."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "python"), str(ROOT / "tests/support")]
sys.dont_write_bytecode = True
import synthetic_run  # noqa: E402
from eulastic import Run, surfaces  # noqa: E402
from eulastic.contours import Contours  # noqa: E402

# Of the volume, that triangles with corners on a sphere of four cells, and their smoothing, may take: (h/R)^2/2.
CHORDS = 0.25**2 / 2


def render(*words):
    without_display = {name: value for name, value in os.environ.items() if name != "DISPLAY"}
    return subprocess.run([str(word) for word in (ROOT / "scripts/render", *words)], capture_output=True, text=True,
                          env=without_display)


def arrays(surface, *names):
    """Corners of triangles (n, 3, 3), and arrays of cells."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    points = vtk_to_numpy(surface.GetPoints().GetData()).astype(float)
    corners = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return points[corners], *(vtk_to_numpy(surface.GetCellData().GetArray(name)) for name in names)


class Levels(unittest.TestCase):
    def test_the_surface_of_a_body_encloses_its_volume(self):
        """A box of many cells: 1/2, its corners aside; of one full cell: the surface of its tent of the same volume."""
        box = numpy.pad(numpy.ones((12, 12, 12)), 2)
        self.assertAlmostEqual(surfaces.enclosing(box), 0.5, delta=0.07)
        level = surfaces.enclosing(numpy.pad(numpy.ones((1, 1, 1)), 2))
        x = (numpy.arange(200) + 0.5) / 100 - 1
        tent = 1 - abs(x)
        volume = ((tent[:, None, None] * tent[:, None] * tent) > level).sum() / 100**3
        self.assertAlmostEqual(volume, 1, delta=0.3)  # 27 samples per cell, eight alike


class Surfaces(unittest.TestCase):
    def setUp(self):
        room = tempfile.TemporaryDirectory()
        self.addCleanup(room.cleanup)
        self.room = pathlib.Path(room.name)
        self.run_ = Run(synthetic_run.write_run(self.room / "run"))

    def read(self, path):
        import vtkmodules.all as vtk
        reader = vtk.vtkXMLPolyDataReader()
        reader.SetFileName(str(path))
        reader.Update()
        return reader.GetOutput()

    def test_bodies(self):
        """Two spheres, the first across x = 0: its parts, cut, or the whole of it have the volume; points have the field."""
        from vtkmodules.util.numpy_support import vtk_to_numpy
        wanted = self.run_.snapshots[0]["solid_fraction"].sum() * 0.25**3 / 2
        folder, volumes = self.room / "vtp", []
        for words, ends in (((), (0, 8)), (("--whole",), (-0.75, 5))):
            done = render(self.run_.directory, "--surfaces", "vtp", "--field", "pressure", "--output", folder, *words)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(len(list(folder.glob("*.vtp"))), 3)
            surface = self.read(folder / "surfaces_000000.vtp")
            numpy.testing.assert_allclose(surface.GetBounds()[:2], ends, atol=0.02)
            triangles, body, species = arrays(surface, "body", "species")
            self.assertEqual((set(body), set(species)), ({1, 2}, {1}))
            volumes.append([(numpy.linalg.det(triangles[body == label]) / 6).sum() for label in (1, 2)])
            x = vtk_to_numpy(surface.GetPoints().GetData())[:, 0]
            pressure = vtk_to_numpy(surface.GetPointData().GetArray("pressure"))
            numpy.testing.assert_allclose(pressure, numpy.sin(2 * numpy.pi * x / 8), atol=0.01)
        numpy.testing.assert_allclose(volumes, wanted, rtol=CHORDS)
        numpy.testing.assert_allclose(volumes[0], volumes[1], rtol=1e-6)
        series = json.loads((folder / "surfaces.vtp.series").read_text())
        self.assertEqual([(item["name"], item["time"]) for item in series["files"]],
                         [(f"surfaces_{n:06}.vtp", 50.0 * n) for n in range(3)])

    def test_stl_of_one_time(self):
        folder = self.room / "stl"
        done = render(self.run_.directory, "--surfaces", "stl", "--time", 90, "--output", folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual({path.name for path in folder.iterdir()}, {"surfaces_000002.stl", "surfaces.stl.series"})
        data = (folder / "surfaces_000002.stl").read_bytes()
        count = int.from_bytes(data[80:84], "little")
        self.assertEqual(len(data), 84 + 50 * count)
        corners = numpy.frombuffer(data[84:], numpy.dtype([("v", "<f4", (4, 3)), ("attribute", "<u2")]))["v"][:, 1:]
        wanted = self.run_.snapshots[2]["solid_fraction"].sum() * 0.25**3
        self.assertAlmostEqual((numpy.linalg.det(corners.astype(float)) / 6).sum() / wanted, 1, delta=CHORDS)

    def test_wrong_input_is_one_line(self):
        for words, reason in (("stl --field pressure", "does not go with --field"), ("vtp --clip z=2", "does not go with --clip"),
                              ("vtp --movie x.gif", "does not go with --movie"), ("vtp --output /dev/null", "/dev/null")):
            done = render(self.run_.directory, "--surfaces", *words.split())
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stderr, rf"\Arender: [^\n]*{reason}[^\n]*\n\Z")

    def test_species_and_vessels(self):
        """A tube along x before a species of two bodies: names in order; the tube's surface is that of its lumen, with the stress
        that the cells at it hold."""
        from vtkmodules.util.numpy_support import vtk_to_numpy
        with open(self.run_.directory / "options.txt", "a") as file:
            file.write("-species wall,cell\n-wall_shape tube\n-cell_shape sphere\n")
        run = Run(self.run_.directory)
        y, z = numpy.meshgrid(run.centres(1), run.centres(2))
        distance = numpy.hypot(y - 3, z - 2)[..., None] + numpy.zeros(32)
        with h5py.File(run.snapshots[0].path, "a") as file:
            for name in ("solid_fraction", "body"):
                file[name + "_cell"] = file[name][...]
            file["solid_fraction_wall"] = numpy.clip(0.5 + (distance - 1.5) / 0.25, 0, 1)
            file["body_wall"] = (distance > 1.4).astype("i4")
            file["wall_shear_stress"] = (abs(distance - 1.5) < 0.25)[..., None] * numpy.array([0.3, 0.4, 0])
        run = Run(self.run_.directory)
        surface = Contours(run).all_surfaces(run.snapshots[0])
        names = surface.GetFieldData().GetAbstractArray("species_names")
        self.assertEqual([names.GetValue(n) for n in range(names.GetNumberOfValues())], ["wall", "cell"])
        triangles, body, species = arrays(surface, "body", "species")
        self.assertEqual(set(zip(body, species)), {(0, 1), (1, 2), (2, 2)})
        x, y, z = triangles[species == 1].reshape(-1, 3).T
        numpy.testing.assert_allclose(numpy.hypot(y - 3, z - 2), 1.5, atol=0.05)
        numpy.testing.assert_allclose([x.min(), x.max()], [-0.125, 8.125], atol=0.025)
        points, stress = (vtk_to_numpy(array) for array in (surface.GetPoints().GetData(), surface.GetPointData().GetArray("wall_shear_stress")))
        on_lumen = numpy.zeros(len(points), bool)
        cells = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        on_lumen[cells[species == 1]] = True
        self.assertTrue(0.3 * len(points) < on_lumen.sum() < 0.9 * len(points))
        numpy.testing.assert_allclose(stress[on_lumen], 0.5, rtol=1e-6)
        numpy.testing.assert_array_equal(stress[~on_lumen], 0)

    def test_nothing_to_enclose(self):
        with h5py.File(self.run_.snapshots[0].path, "a") as file:
            file["body"][...] = 0
        surface = Contours(self.run_).all_surfaces(self.run_.snapshots[0])
        self.assertEqual(surface.GetNumberOfCells(), 0)


if __name__ == "__main__":
    unittest.main()
