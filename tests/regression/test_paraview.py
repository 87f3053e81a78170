#!/usr/bin/python3
"""snapshots.xdmf, walls.xdmf and the .vti files as ParaView sees them. Every item is followed to its dataset: shape,
type, place and values. Debian's VTK must read the .vti files; where pvpython is installed, ParaView's own two XDMF
readers must see the same."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

import h5py
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))

from program import BINARY, launcher  # noqa: E402

CELLS, LENGTH = numpy.array([12, 10, 8]), numpy.array([1.2, 1.0, 0.8])
SCENE = ("-grid_cells 12,10,8 -grid_length 1.2,1,.8 -boundary_y wall -boundary_ymax_velocity 1,0,0 -fluid_viscosity .5 "
         "-initial_velocity couette -species cell,seed -cell_shape sphere -cell_radius .2 -cell_centre .6,.3,.4 "
         "-cell_shear_modulus 1 -seed_shape sphere -seed_radius .15 -seed_centre .6,.8,.4 -seed_shear_modulus 1 "
         "-time_step .002 -time_end .01 -snapshot_interval .005").split()

# Runs inside pvpython: what each reader sees at the last time.
PROBE = """
import json, sys
from paraview.simple import OpenDataFile, XDMFReader, Xdmf3ReaderS
from paraview.servermanager import Fetch
seen = []
for path in sys.argv[1:]:
    for reader in (XDMFReader(FileNames=[path]), Xdmf3ReaderS(FileName=[path])):
        reader.UpdatePipeline()
        times = list(reader.TimestepValues)
        reader.UpdatePipeline(times[-1])
        arrays = {reader.CellData.GetArray(n).Name: reader.CellData.GetArray(n).GetRange(0)
                  for n in range(reader.CellData.GetNumberOfArrays())}
        info = reader.GetDataInformation()
        seen.append({"times": times, "arrays": arrays, "cells": info.GetNumberOfCells(), "bounds": info.GetBounds()})
print("SEEN" + json.dumps(seen))
"""

# All cells of a .vti file as VTK reads them.
READ_VTI = """
import sys
import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLImageDataReader
reader = vtkXMLImageDataReader()
reader.SetFileName(sys.argv[1])
reader.Update()
image = reader.GetOutput()
fields = {image.GetCellData().GetArrayName(n): vtk_to_numpy(image.GetCellData().GetArray(n))
          for n in range(image.GetCellData().GetNumberOfArrays())}
time = image.GetFieldData().GetArray("TimeValue").GetTuple1(0)
numpy.savez(sys.argv[2], origin=image.GetOrigin(), spacing=image.GetSpacing(), extent=image.GetExtent(), time=time, **fields)
"""


def start(*command):
    return subprocess.run(command, capture_output=True, text=True)


def numbers(item):
    return numpy.array([float(x) for x in item.text.split()])


class Paraview(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        room = tempfile.TemporaryDirectory()
        cls.addClassCleanup(room.cleanup)
        cls.room = pathlib.Path(room.name)
        cls.directory = cls.room / "out"
        done = start(BINARY, *SCENE, "-output_dir", cls.directory)
        assert done.returncode == 0, done.stderr
        cls.last = h5py.File(cls.directory / "snapshot_000002.h5")
        cls.addClassCleanup(cls.last.close)

    def grids(self, index):
        """(time, uniform grid) of an index, in its order."""
        root = xml.etree.ElementTree.parse(self.directory / index).getroot()
        top = root.find("Domain/Grid")
        self.assertEqual((top.get("GridType"), top.get("CollectionType")), ("Collection", "Temporal"))
        for grid in top.findall("Grid"):
            time = float(grid.find("Time").get("Value"))
            for part in grid.findall("Grid") or [grid]:
                yield time, part

    def check_attributes(self, grid, cells):
        """Every attribute's dataset has the declared shape and type; returns the arrays by name."""
        arrays = {}
        for attribute in grid.findall("Attribute"):
            item = attribute.find("DataItem")
            self.assertEqual((attribute.get("Center"), item.get("Format")), ("Cell", "HDF"))
            name, dataset = item.text.split(":/")
            with h5py.File(self.directory / name) as file:
                values = file[dataset][...]
            shape = [int(n) for n in item.get("Dimensions").split()]
            components = [3] if attribute.get("AttributeType") == "Vector" else []
            self.assertEqual((shape, list(values.shape)), (list(cells) + components,) * 2)
            self.assertEqual(values.dtype.itemsize, int(item.get("Precision")))
            self.assertEqual(values.dtype.kind, {"Float": "f", "Int": "i"}[item.get("NumberType")])
            arrays[attribute.get("Name")] = values
        return arrays

    def test_snapshots(self):
        grids = list(self.grids("snapshots.xdmf"))
        self.assertEqual(len(grids), 3)
        for time, grid in grids:
            topology, geometry = grid.find("Topology"), grid.findall("Geometry/DataItem")
            self.assertEqual([int(n) for n in topology.get("Dimensions").split()], list(CELLS[::-1] + 1))
            numpy.testing.assert_allclose(numbers(geometry[0]), 0)
            numpy.testing.assert_allclose(numbers(geometry[1]), (LENGTH / CELLS)[::-1])
            arrays = self.check_attributes(grid, CELLS[::-1])
            self.assertLessEqual({"velocity", "pressure", "solid_fraction", "body"}, set(arrays))
            with h5py.File(self.directory / f"{grid.get('Name')}.h5") as file:
                self.assertEqual(numpy.squeeze(file.attrs["time"]), time)
        k, j, i = 4, 3, 6  # the cell of the lower body's centre
        self.assertEqual((arrays["body"][k, j, i], arrays["body"][4, 8, 6]), (1, 2))
        self.assertAlmostEqual(arrays["velocity"][k, j, i, 0], 0.35, delta=0.02)

    def test_walls(self):
        grids = list(self.grids("walls.xdmf"))
        self.assertEqual(len(grids), 6)
        for time, grid in grids:
            plate = [int(n) for n in grid.find("Topology").get("Dimensions").split()]
            self.assertEqual(plate, [CELLS[2] + 1, 2, CELLS[0] + 1])
            origin, spacing = map(numbers, grid.findall("Geometry/DataItem"))
            self.assertAlmostEqual(origin[1], 1.0 if grid.get("Name").endswith("ymax") else -spacing[1])
            stress = self.check_attributes(grid, [CELLS[2], 1, CELLS[0]])["wall_shear_stress"]
            if time == 0:  # Couette flow; the traction on the upper wall is against its motion
                exact = -0.5 if grid.get("Name").endswith("ymax") else 0.5
                numpy.testing.assert_allclose(stress[..., 0], exact, rtol=1e-6)
                numpy.testing.assert_allclose(stress[..., 1:], 0, atol=1e-12)

    def read_vti(self, path):
        done = start(sys.executable, "-c", READ_VTI, str(path), str(self.room / "seen.npz"))
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return dict(numpy.load(self.room / "seen.npz"))

    @unittest.skipUnless(pathlib.Path("/usr/lib/python3/dist-packages/vtkmodules").exists(), "VTK is not installed")
    def test_vti(self):
        """VTK sees the grid, all that the HDF5 file has at centres, and beside the walls the stress on them; on two ranks the same
        bytes. The list has all times, in a run that goes on, too."""
        out, two = self.room / "vti", self.room / "vti_two"
        words = *SCENE, "-snapshot_format", "vti"
        done = start(BINARY, *words, "-output_dir", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        seen = self.read_vti(out / "snapshot_000002.vti")
        for name, exact in {"extent": [0, 12, 0, 10, 0, 8], "origin": [0, 0, 0], "spacing": self.last.attrs["spacing"], "time": 0.01}.items():
            numpy.testing.assert_array_equal(seen.pop(name), exact)
        walls = [self.last[f"wall_shear_stress_{wall}"][:, 0] for wall in ("ymin", "ymax")]
        stress = seen.pop("wall_shear_stress").reshape(8, 10, 12, 3)
        numpy.testing.assert_array_equal(stress[:, 0], walls[0])
        numpy.testing.assert_array_equal(stress[:, -1], walls[1])
        self.assertGreater(abs(walls[0]).min(axis=(0, 1)).max(), 0.4)
        self.assertFalse(stress[:, 1:-1].any())
        self.assertEqual(set(seen), {"velocity", "pressure", *(name + tail for name in ("body", "solid_fraction")
                                                               for tail in ("", "_cell", "_seed"))})
        for name, values in seen.items():
            numpy.testing.assert_array_equal(values.ravel(), self.last[name][...].ravel(), name)
            self.assertEqual(values.dtype, self.last[name].dtype)
        done = start(*launcher(2), BINARY, *words, "-output_dir", two)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual((two / "snapshot_000002.vti").read_bytes(), (out / "snapshot_000002.vti").read_bytes())
        longer = [".02" if word == ".01" else word for word in words]
        done = start(BINARY, *longer, "-restart", out, "-output_dir", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        times = [(item.get("file"), float(item.get("timestep"))) for item in
                 xml.etree.ElementTree.parse(out / "snapshots.pvd").getroot().iter("DataSet")]
        self.assertEqual([name for name, _ in times], [f"snapshot_{n:06}.vti" for n in range(5)])
        numpy.testing.assert_allclose([time for _, time in times], [0, 0.006, 0.01, 0.016, 0.02])
        done = start(BINARY, *SCENE, "-output_overwrite", "-output_dir", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual([path.name for path in out.iterdir() if path.suffix in (".vti", ".pvd")], [])

    @unittest.skipUnless(pathlib.Path("/usr/lib/python3/dist-packages/vtkmodules").exists(), "VTK is not installed")
    def test_stress_on_a_vessel_is_always_in_vti(self):
        """In 2-D, double precision, without -snapshot_fields that asks for it: what a run that asks for it has."""
        flat = ("-grid_cells 16,12,1 -grid_length 1.6,1.2,.1 -species plates -plates_shape tube -plates_axis x -plates_radius .43 "
                "-plates_law rigid -body_force 1,0,0 -time_step .01 -time_end .1 -snapshot_interval .1 -snapshot_precision double").split()
        for name, words in {"asked": ("-snapshot_fields", "wall_shear_stress"),
                            "vessel": ("-snapshot_fields", "pressure", "-snapshot_format", "vti")}.items():
            done = start(BINARY, *flat, *words, "-output_dir", self.room / name)
            self.assertEqual(done.returncode, 0, done.stderr)
        seen = self.read_vti(self.room / "vessel/snapshot_000001.vti")
        with h5py.File(self.room / "asked/snapshot_000001.h5") as file:
            exact = file["wall_shear_stress"][...]
        self.assertEqual(set(seen) - {"origin", "spacing", "extent", "time"}, {"pressure", "wall_shear_stress"})
        self.assertEqual(exact.dtype, numpy.float64)
        self.assertGreater(abs(exact).max(), 0.05)
        numpy.testing.assert_array_equal(seen["wall_shear_stress"].ravel(), exact.ravel())

    def test_other_formats_are_refused(self):
        done = start(BINARY, *SCENE, "-snapshot_format", "vtk", "-output_dir", self.room / "none")
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, r"\A[^\n]*-snapshot_format[^\n]*xdmf, vti[^\n]*\n\Z")
        self.assertFalse((self.room / "none").exists())

    @unittest.skipUnless(shutil.which("pvpython"), "pvpython is not installed")
    def test_readers_of_paraview(self):
        paths = [str(self.directory / name) for name in ("snapshots.xdmf", "walls.xdmf")]
        command = ["pvpython", "-c", f"import sys\nsys.argv[1:] = {paths!r}\n{PROBE}"]
        if not os.environ.get("DISPLAY") and shutil.which("xvfb-run"):
            command = ["xvfb-run", "-a", *command]
        done = subprocess.run(command, capture_output=True, text=True, timeout=300)
        line = [line for line in done.stdout.splitlines() if line.startswith("SEEN")]
        self.assertTrue(line, done.stdout + done.stderr)
        fields = json.loads(line[0][4:])
        self.assertEqual([seen["cells"] for seen in fields], [960, 960, 192, 192])
        for seen in fields:
            self.assertEqual(len(seen["times"]), 3)
        for seen in fields[:2]:
            for name in ("pressure", "solid_fraction", "body"):
                values = self.last[name][...]
                numpy.testing.assert_allclose(seen["arrays"][name], [values.min(), values.max()], rtol=1e-6)
            numpy.testing.assert_allclose(seen["bounds"], [0, 1.2, 0, 1, 0, 0.8], atol=1e-12)
        for seen in fields[2:]:
            both = numpy.array([self.last[f"wall_shear_stress_{wall}"][..., 0] for wall in ("ymin", "ymax")])
            numpy.testing.assert_allclose(seen["arrays"]["wall_shear_stress"], [both.min(), both.max()], rtol=1e-6)


if __name__ == "__main__":
    unittest.main()
