"""Surfaces of the bodies of a 3-D run by VTK, for pictures and as files: contours of phi, cut where a body crosses an end of the
box."""
import itertools
import json

import numpy

from . import derived
from .reading import VESSELS
from .surfaces import at_points, body_pieces, enclosing, sample, spread

KINDS = "vtp", "stl"


class Contours:
    def __init__(self, run):
        import vtkmodules.all as vtk  # takes its time
        self.vtk, self.run = vtk, run
        self.periodic = [not run.is_bounded(d) for d in (2, 1, 0)]  # in z, y, x

    def in_species(self, snapshot, field, name):
        """Returns solid_fraction or body, (nz, ny, nx), of one species."""
        return snapshot[field + ("_" + name if len(self.run.species) > 1 else "")]

    def bodies(self, snapshot, name, whole=False, planes=()):
        """Yields (label, VTK filter) for the bodies of a species that is not a vessel. The surface of the filter encloses the
        volume of the body. A body that crosses a periodic end is cut there into parts or, if `whole`, continues beyond the box;
        planes cut it, too."""
        labels = self.in_species(snapshot, "body", name).astype(int)
        for body, piece, begin in body_pieces(self.in_species(snapshot, "solid_fraction", name), labels, self.periodic):
            for part in self.parts(self.contour(piece, begin, enclosing(piece)), piece.shape, begin, whole, planes):
                yield body, part

    def vessel(self, snapshot, name):
        """Returns the surface phi = 1/2 of a vessel. It is open where it leaves the box, half a cell beyond the end."""
        return self.contour(self.widened(self.in_species(snapshot, "solid_fraction", name)), numpy.full(3, -1))

    def widened(self, values):
        """Returns the array with one more cell on each side."""
        for axis in range(3):
            beyond = [(1, 1) if d == axis else (0, 0) for d in range(3)]
            values = numpy.pad(values, beyond, mode="wrap" if self.periodic[axis] else "edge")
        return values

    def contour(self, fraction, begin, level=0.5):
        """Returns the smoothed surface phi = level; `begin` is the index (k, j, i) of the first cell."""
        from vtkmodules.util.numpy_support import numpy_to_vtk
        h = self.run.spacing
        image = self.vtk.vtkImageData()
        image.SetDimensions(*fraction.shape[::-1])
        image.SetSpacing(*h)
        image.SetOrigin(*((begin[::-1] + 0.5) * h))
        image.GetPointData().SetScalars(numpy_to_vtk(numpy.ascontiguousarray(fraction, dtype=float).ravel(), deep=1))
        surface = self.vtk.vtkFlyingEdges3D()
        surface.SetInputData(image)
        surface.SetValue(0, level)
        smooth = self.vtk.vtkWindowedSincPolyDataFilter()  # takes the steps of a sharp phi out of the picture
        smooth.SetInputConnection(surface.GetOutputPort())
        smooth.SetNumberOfIterations(20 if fraction.sum() > 50 else 4)  # it would shrink a body of few cells
        smooth.SetPassBand(0.1)
        smooth.NormalizeCoordinatesOn()
        return smooth

    def parts(self, surface, shape, begin, whole, planes):
        """Yields the surface, or its parts if it crosses ends of the box; planes cut it, too."""
        planes, shifts = list(planes), []
        for d, (first, count, n, periodic) in enumerate(zip(begin[::-1], shape[::-1], self.run.cells, self.periodic[::-1])):
            low, high = first + 2 < 0, first + count - 2 > n  # two cells around a body are empty
            beyond = periodic and not whole and (low or high)
            shifts.append((0, 1 if low else -1) if beyond else (0,))
            if beyond:
                planes += [self.plane(d, 0, 1), self.plane(d, self.run.length[d], -1)]
        for shift in itertools.product(*shifts):
            part = surface
            if any(shift):
                move = self.vtk.vtkTransform()
                move.Translate(*(shift * self.run.length))
                part = self.vtk.vtkTransformPolyDataFilter()
                part.SetTransform(move)
                part.SetInputConnection(surface.GetOutputPort())
            if planes:
                cut, collection = self.vtk.vtkClipClosedSurface(), self.vtk.vtkPlaneCollection()
                for plane in planes:
                    collection.AddItem(plane)
                cut.SetClippingPlanes(collection)
                cut.SetInputConnection(part.GetOutputPort())
                part = cut
            yield part

    def plane(self, d, place, towards):
        """Returns a VTK plane that cuts at `place` along d and keeps the side towards +1 or -1."""
        plane = self.vtk.vtkPlane()
        plane.SetOrigin(*(place if axis == d else 0 for axis in range(3)))
        plane.SetNormal(*(towards if axis == d else 0 for axis in range(3)))
        return plane

    def at_points(self, surface, field):
        """Returns a field of cells (nz, ny, nx) at the points of a vtkPolyData as a VTK array."""
        from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
        places = vtk_to_numpy(surface.GetPoints().GetData()) / self.run.spacing - 0.5
        return numpy_to_vtk(sample(field, places, self.periodic), deep=1)

    def stress_at_points(self, surface, snapshot):
        """Returns the magnitude of the shear stress on vessels and obstacles at the points of a vtkPolyData as a VTK array."""
        from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
        places = vtk_to_numpy(surface.GetPoints().GetData()) / self.run.spacing + 0.5
        return numpy_to_vtk(at_points(spread(self.widened(snapshot.surface_shear_stress())), places), deep=1)

    def all_surfaces(self, snapshot, field="", whole=False):
        """Returns a vtkPolyData of triangles with all bodies and vessels. Data of cells are `body`, the label (0 for vessels),
        and `species`, 1, 2, ... in the order of the strings `species_names`. Data of points are `field`, and `wall_shear_stress`,
        the magnitude of that stress, if the snapshot has it; it is 0 on moving bodies."""
        from vtkmodules.util.numpy_support import numpy_to_vtk
        vtk, names = self.vtk, self.run.species
        together, values = vtk.vtkAppendPolyData(), derived.field(snapshot, field) if field else None
        together.AddInputData(vtk.vtkPolyData())  # without any body there is this one
        for number, (name, shape) in enumerate(names.items(), 1):
            vessel = shape in VESSELS
            for body, part in [(0, self.vessel(snapshot, name))] if vessel else self.bodies(snapshot, name, whole):
                triangles = vtk.vtkTriangleFilter()
                triangles.SetInputConnection(part.GetOutputPort())
                triangles.Update()
                surface = vtk.vtkPolyData()
                surface.CopyStructure(triangles.GetOutput())
                for array, value in (("body", body), ("species", number)):
                    cells = numpy_to_vtk(numpy.full(surface.GetNumberOfCells(), value, numpy.int32), deep=1)
                    cells.SetName(array)
                    surface.GetCellData().AddArray(cells)
                if field and surface.GetNumberOfPoints() > 0:
                    points = self.at_points(surface, values)
                    points.SetName(field)
                    surface.GetPointData().AddArray(points)
                if "wall_shear_stress" in snapshot and surface.GetNumberOfPoints() > 0:
                    none = numpy.zeros(surface.GetNumberOfPoints())
                    stress = self.stress_at_points(surface, snapshot) if self.run.is_fixed(name) else numpy_to_vtk(none, deep=1)
                    stress.SetName("wall_shear_stress")
                    surface.GetPointData().AddArray(stress)
                together.AddInputData(surface)
        together.Update()
        strings = vtk.vtkStringArray()
        strings.SetName("species_names")
        for name in names:
            strings.InsertNextValue(name)
        together.GetOutput().GetFieldData().AddArray(strings)
        return together.GetOutput()

    def write(self, snapshots, kind, folder, field="", whole=False):
        """Writes surfaces_NNNNNN.vtp or .stl for each snapshot, with its number, into `folder`, and surfaces.vtp.series, their
        list with times for ParaView. Yields each (snapshot, path). Raises OSError if a file cannot be written."""
        folder.mkdir(parents=True, exist_ok=True)
        listed = []
        for snapshot in snapshots:
            path = folder / f"surfaces_{snapshot.path.stem.split('_')[1]}.{kind}"
            path.open("wb").close()  # VTK would not say why it cannot
            writer = self.vtk.vtkXMLPolyDataWriter() if kind == "vtp" else self.vtk.vtkSTLWriter()
            if kind == "stl":
                writer.SetFileTypeToBinary()
            writer.SetFileName(str(path))
            writer.SetInputData(self.all_surfaces(snapshot, field, whole))
            if not writer.Write():
                raise OSError(f"cannot write {path}")
            listed.append({"name": path.name, "time": snapshot.time})
            yield snapshot, path
        series = {"file-series-version": "1.0", "files": listed}
        (folder / f"surfaces.{kind}.series").write_text(json.dumps(series, indent=2) + "\n")
