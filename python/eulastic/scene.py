"""Pictures of 3-D runs by VTK, for scripts/render and the studies: one window that shows one snapshot after the other."""
import colorsys
import dataclasses
import os
import sys

import numpy

from . import derived
from .contours import Contours
from .framing import INK, Framed
from .reading import VESSELS
from .rounding import round_up

BLUES = (.97, .98, 1), (.80, .88, .95), (.58, .76, .88), (.30, .58, .79), (.10, .36, .62)  # of a size
BOTH = (.13, .40, .67), (.57, .77, .87), (.97, .97, .97), (.96, .65, .51), (.70, .09, .17)  # of what has a sign
GREENS = (.90, .91, .92), (.74, .86, .78), (.50, .75, .60), (.25, .58, .43), (.08, .38, .28)  # of wall shear stress
RED, HUES = 0.99, (0.13, 0.36, 0.78, 0.5)  # of red cells, and of other species, if there are several


@dataclasses.dataclass
class Look:
    camera: tuple = (19.5, 16.5)  # degrees around y from z, and up
    zoom: float = 1
    field: str = ""  # colours bodies
    behind: str = "velocity_x"  # on the plane behind the bodies; "": no plane
    clip: tuple = ()  # (direction, place): what is nearer to the eye is cut away
    transparent: bool = False
    words: bool = True
    whole: bool = False  # bodies across a periodic end are drawn whole, not cut and at both ends


def start_display():
    """Restarts this script under a virtual display if there is no display, which Debian's VTK requires."""
    if not os.environ.get("DISPLAY"):
        first = f"--server-num={100 + os.getpid() % 400}"  # scripts that start together must not race for one number
        os.execvp("xvfb-run", ["xvfb-run", "-a", first, "-s", "-screen 0 640x480x24", sys.executable, "-B", *sys.argv])


def colour(body, hue=None):
    """Returns the colour of a label. Neighbouring labels get distant hues, or distant shades of one hue (golden ratio)."""
    turn = 0.618034 * body % 1
    if hue is None:
        return colorsys.hsv_to_rgb((0.02 + turn) % 1, 0.55, 0.92)
    return colorsys.hsv_to_rgb(hue, 0.55 + 0.35 * turn, 0.98 - 0.25 * turn)


def species(run):
    """Returns {name: hue}; the hue is None for the only species, and "vessel" for vessels."""
    shape = run.species
    hues = iter(HUES * len(shape))
    return {name: "vessel" if kind in VESSELS else None if len(shape) == 1 else RED if kind == "biconcave" else next(hues)
            for name, kind in shape.items()}


def on_plane(snapshot, name):
    """Returns a field on the plane z = 0. If this plane is a wall, or lies inside one, the middle plane is taken."""
    speed = derived.field(snapshot, "speed")
    still = snapshot.run.is_bounded(2) or speed[0].max() < 1e-3 * speed.max()
    return derived.field(snapshot, name)[snapshot.run.cells[2] // 2 if still else 0]


def plane_range(snapshots, name="velocity_x"):
    """Returns the range of a field on the plane, the same for all frames of a film: with 0 in the middle if it has both signs,
    otherwise with 0 at one end, and with ends whose quarters are short numbers."""
    low, high = 0.0, 0.0
    for snapshot in snapshots:
        values = on_plane(snapshot, name)
        low, high = min(low, values.min()), max(high, values.max())
    floor = derived.least(snapshots[-1], name)
    if max(-low, high) <= floor:
        low, high = 0.0, floor
    if low < -0.02 * high and derived.is_signed(name):
        high = max(high, -low)
        low = -high if high > 0 else low
    quarter = round_up((high - low) / 4 or 1.0)
    return (-2 * quarter, 2 * quarter) if low < -0.02 * high else (0.0, 4 * quarter)


def stress_range(snapshots):
    """Returns the largest shear stress on walls and surfaces in all frames, rounded up to two digits; 0 if there is none."""
    walls = [name for name in snapshots[-1].fields if name.startswith("wall_shear_stress")]
    largest = max((numpy.linalg.norm(snapshot[name], axis=-1).max() for snapshot in snapshots for name in walls), default=0)
    return round_up(largest)


def field_range(snapshots, name):
    """Returns the range of a field in bodies over all frames."""
    inside = [derived.field(s, name)[s["solid_fraction"] > 0.5] for s in snapshots]
    values = numpy.concatenate([v for v in inside if v.size] or [numpy.zeros(1)])
    return derived.limits(name, values, derived.least(snapshots[-1], name))


def tension_range(snapshots):
    """Returns the range of the tension of bonds over all frames, with 0 in the middle and quarters that are short numbers; None
    without bonds."""
    tensions = [rows.tension for rows in (snapshot.bonds() for snapshot in snapshots) if rows is not None and len(rows)]
    if not tensions:
        return None
    half = 2 * round_up(abs(numpy.concatenate(tensions)).max() / 2 or 1.0)
    return -half, half


class Scene(Framed):
    def __init__(self, run, size, units, speed, stress, look=Look(), body_range=(0, 1), tension=None):
        self.contours = Contours(run)
        self.vtk, self.run, self.units, self.speed, self.stress = self.contours.vtk, run, units, speed, stress
        self.look, self.body_range, self.tension = look, body_range, tension
        vtk = self.vtk
        self.window = vtk.vtkRenderWindow()  # opens the display
        self.window.SetOffScreenRendering(1)
        self.window.SetMultiSamples(8)
        self.window.SetAlphaBitPlanes(int(look.transparent))
        self.window.SetSize(*(size or self.fitting_size()))

    def draw(self, snapshot, path):
        """Draws a snapshot into a PNG file. OSError if it cannot be written."""
        vtk = self.vtk
        renderer = vtk.vtkRenderer()
        renderer.SetBackground(1, 1, 1)
        renderer.SetBackgroundAlpha(0 if self.look.transparent else 1)
        vtk.vtkLightKit().AddLightsToRenderer(renderer)
        self.window.GetRenderers().RemoveAllItems()
        self.window.AddRenderer(renderer)
        self.add_bodies(renderer, snapshot)
        if self.tension:
            self.add_bonds(renderer, snapshot)
        self.add_box(renderer, snapshot)
        if self.look.behind:
            self.add_slice(renderer, snapshot)
        self.place_camera(renderer)
        if self.look.words:
            self.add_words(renderer, snapshot)
        self.window.Render()
        image = vtk.vtkWindowToImageFilter()
        image.SetInput(self.window)
        image.SetInputBufferType(vtk.VTK_RGBA if self.look.transparent else vtk.VTK_RGB)
        image.ReadFrontBufferOff()
        writer = vtk.vtkPNGWriter()
        writer.SetFileName(str(path))
        writer.SetInputConnection(image.GetOutputPort())
        open(path, "wb").close()  # VTK would not say why it cannot
        writer.Write()
        if writer.GetErrorCode():
            raise OSError(f"{path} cannot be written")

    def actor(self, renderer, source, rgb, **properties):
        mapper = self.vtk.vtkPolyDataMapper()
        mapper.SetInputConnection(source.GetOutputPort())
        mapper.ScalarVisibilityOff()
        actor = self.vtk.vtkActor()
        actor.SetMapper(mapper)
        actor.GetProperty().SetColor(*rgb)
        for name, value in properties.items():
            getattr(actor.GetProperty(), "Set" + name)(value)
        renderer.AddActor(actor)
        return actor

    def add_bodies(self, renderer, snapshot):
        clip, field = self.look.clip, derived.field(snapshot, self.look.field) if self.look.field else None
        planes = [self.contours.plane(*clip, -numpy.sign(self.direction()[clip[0]]))] if clip else []
        for name, hue in species(self.run).items():
            if hue == "vessel":
                self.add_vessel(renderer, snapshot, name)
                continue
            for body, part in self.contours.bodies(snapshot, name, self.look.whole, planes):
                actor = self.actor(renderer, self.with_normals(part), colour(body, hue), Specular=0.35, SpecularPower=25,
                                   Ambient=0.12)
                if field is not None:
                    self.colour_by(actor, field)

    def colour_by(self, actor, field):
        actor.GetMapper().Update()
        surface = actor.GetMapper().GetInput()
        if surface.GetNumberOfPoints() == 0:
            return
        surface.GetPointData().SetScalars(self.contours.at_points(surface, field))
        actor.GetMapper().ScalarVisibilityOn()
        actor.GetMapper().SetLookupTable(self.table(*self.body_range))

    def add_vessel(self, renderer, snapshot, name):
        """Adds the far side of the lumen, coloured by its shear stress; ends that leave the box are open."""
        surface = self.with_normals(self.contours.vessel(snapshot, name))
        look = dict(BackfaceCulling=True)
        if "wall_shear_stress" not in snapshot:
            self.actor(renderer, surface, (0.80, 0.72, 0.70), Opacity=0.45, **look)
            return
        surface.Update()
        lumen = surface.GetOutput()
        lumen.GetPointData().SetScalars(self.contours.stress_at_points(lumen, snapshot))
        mapper = self.actor(renderer, surface, (1, 1, 1), Ambient=0.25, **look).GetMapper()
        mapper.ScalarVisibilityOn()
        mapper.SetLookupTable(self.table(0, self.stress, GREENS))

    def add_bonds(self, renderer, snapshot):
        """Adds bonds as lines from end to end, coloured by their tension. A bond that begins outside of the box is moved by its
        periods."""
        from vtkmodules.util.numpy_support import numpy_to_vtk
        vtk, bonds = self.vtk, snapshot.bonds()
        periodic = [not self.run.is_bounded(d) for d in range(3)]
        points, lines = vtk.vtkPoints(), vtk.vtkCellArray()
        for bond in bonds:
            ends = numpy.array([[bond[f"{end}_{d}"] for d in "xyz"] for end in ("from", "to")])
            ends -= numpy.where(periodic, numpy.floor(ends[0] / self.run.length) * self.run.length, 0)
            lines.InsertNextCell(2)
            for end in ends:
                lines.InsertCellPoint(points.InsertNextPoint(*end))
        data = vtk.vtkPolyData()
        data.SetPoints(points)
        data.SetLines(lines)
        data.GetCellData().SetScalars(numpy_to_vtk(numpy.array(bonds.tension, float), deep=1))
        tubes = vtk.vtkTubeFilter()
        tubes.SetInputData(data)
        tubes.SetRadius(0.2 * self.run.spacing.min())
        tubes.SetNumberOfSides(8)
        mapper = self.actor(renderer, tubes, INK, Ambient=0.3).GetMapper()
        mapper.ScalarVisibilityOn()
        mapper.SetLookupTable(self.table(*self.tension))

    def with_normals(self, surface):
        normals = self.vtk.vtkPolyDataNormals()
        normals.SetInputConnection(surface.GetOutputPort())
        normals.SetFeatureAngle(60)  # sharp where a body is cut
        return normals

    def add_box(self, renderer, snapshot):
        length = self.run.length
        cube = self.vtk.vtkCubeSource()
        cube.SetBounds(0, length[0], 0, length[1], 0, length[2])
        edges = self.vtk.vtkExtractEdges()
        edges.SetInputConnection(cube.GetOutputPort())
        self.actor(renderer, edges, (0.35, 0.35, 0.4), LineWidth=2, Lighting=False)
        for d, side in ((0, 0), (0, 1), (1, 0)):  # in front and on top it stays open, behind is the plane
            if self.run.side(d, side) == "wall":
                self.add_wall(renderer, snapshot, d, side)

    def table(self, low, high, colours=None):
        table = self.vtk.vtkColorTransferFunction()
        for x, rgb in zip(numpy.linspace(low, high, 5), colours or (BOTH if low < 0 < high else BLUES)):
            table.AddRGBPoint(x, *rgb)
        return table

    def add_wall(self, renderer, snapshot, d, side):
        """Adds a wall, coloured by the magnitude of its shear stress if the snapshot has it."""
        from vtkmodules.util.numpy_support import numpy_to_vtk
        points = [n + 1 for n in self.run.cells]
        points[d] = 1
        origin = numpy.zeros(3)
        origin[d] = side * self.run.length[d]
        wall = self.vtk.vtkImageData()
        wall.SetDimensions(*points)
        wall.SetSpacing(*self.run.spacing)
        wall.SetOrigin(*origin)
        mapper = self.vtk.vtkDataSetMapper()
        mapper.SetInputData(wall)
        actor = self.vtk.vtkActor()
        actor.SetMapper(mapper)
        actor.GetProperty().SetColor(0.82, 0.83, 0.86)
        actor.GetProperty().LightingOff()
        if self.stress > 0:
            wall.GetCellData().SetScalars(numpy_to_vtk(snapshot.wall_shear_stress(d, side).ravel(), deep=1))
            mapper.SetLookupTable(self.table(0, self.stress, GREENS))
        renderer.AddActor(actor)

    def add_slice(self, renderer, snapshot):
        """Adds a field on the plane z = 0, behind the bodies."""
        from vtkmodules.util.numpy_support import numpy_to_vtk
        run, vtk = self.run, self.vtk
        values = numpy.pad(on_plane(snapshot, self.look.behind), 1, mode="edge")
        for end in (0, -1):
            wall = run.side(1, -end) == "wall" and self.look.behind.startswith("velocity_")
            if wall:
                moves = run.options.get(f"boundary_y{('min', 'max')[-end]}_velocity", "0,0,0").split(",")
                values[end] = float(moves["xyz".index(self.look.behind[-1])])
        grid = vtk.vtkRectilinearGrid()
        grid.SetDimensions(*values.shape[::-1], 1)
        for d, place in enumerate((grid.SetXCoordinates, grid.SetYCoordinates)):
            place(numpy_to_vtk(numpy.concatenate(([0], run.centres(d), [run.length[d]])), deep=1))
        grid.SetZCoordinates(numpy_to_vtk(numpy.zeros(1), deep=1))
        grid.GetPointData().SetScalars(numpy_to_vtk(values.ravel(), deep=1))
        mapper = vtk.vtkDataSetMapper()
        mapper.SetInputData(grid)
        mapper.SetLookupTable(self.table(*self.speed))
        mapper.InterpolateScalarsBeforeMappingOn()
        actor = vtk.vtkActor()
        actor.SetMapper(mapper)
        actor.GetProperty().LightingOff()
        renderer.AddActor(actor)
