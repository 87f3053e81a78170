"""Position of the camera, and the labels around a picture: the base class of Scene."""
import pathlib

import matplotlib
import numpy

from . import derived
from .rounding import round_down

ANGLE = 28  # of view, degrees
INK = 0.15, 0.15, 0.2
FONT = str(pathlib.Path(matplotlib.get_data_path()) / "fonts/ttf/DejaVuSans.ttf")  # VTK's own has no rho
WIDTH = 1600  # of a picture, whose height follows from the box


class Framed:
    def direction(self):
        """Returns the direction from the box to the camera."""
        azimuth, elevation = numpy.radians(self.look.camera)
        return numpy.array([numpy.sin(azimuth) * numpy.cos(elevation), numpy.sin(elevation),
                            numpy.cos(azimuth) * numpy.cos(elevation)])

    def axes(self):
        """Returns the directions to the right and up in the picture."""
        towards = self.direction()
        right = numpy.cross([0, 1, 0] if abs(towards[1]) < 0.999 else [0, 0, -1], towards)
        right /= numpy.linalg.norm(right)
        return right, numpy.cross(towards, right)

    def corners(self):
        """Returns the corners of everything that must be visible: the box, and the line with scale and arrow below it."""
        points = numpy.array(numpy.meshgrid(*([0, x] for x in self.run.length))).reshape(3, -1).T
        return numpy.concatenate((points, points - [0, 2.2 * self.gap(), 0])) if self.look.words else points

    def gap(self):
        return 0.05 * min(self.run.length.max(), 2 * self.run.length[1])

    def seen(self, eye):
        """Returns the corners as tangents of the angle at the camera, (n, 2)."""
        way = self.corners() - eye
        depth = -(way @ self.direction())
        return numpy.stack([way @ axis / depth for axis in self.axes()], axis=1)

    def frame(self):
        """Returns left, right, bottom and top of the part of the picture for the box, in -1 ... 1; the labels are outside."""
        if not self.look.words:
            return -0.98, 0.98, -0.98, 0.98
        left = -0.72 if self.stress > 0 else -0.96
        return left, 0.74 if self.look.behind or self.look.field or self.tension else 0.96, -0.9, 0.86

    def eye(self, aspect):
        """Returns the position of the camera at which the box just fills the frame. `aspect` is width over height, or None if the
        height is to follow from the box."""
        left, right, bottom, top = self.frame()
        half = numpy.tan(numpy.radians(ANGLE / 2))
        eye = self.run.length / 2 + 2 * numpy.linalg.norm(self.run.length) * self.direction()
        for _ in range(30):
            seen = self.seen(eye)
            low, high = seen.min(axis=0), seen.max(axis=0)
            size = (high - low) / (half * numpy.array([(aspect or 1.25) * (right - left), top - bottom]))
            fill = size.max() if aspect else size[0]
            wanted = half * numpy.array([(aspect or 1.25) * (right + left), top + bottom]) / 2
            depth = (eye - self.run.length / 2) @ self.direction()
            off = (low + high) / 2 - wanted * (1 if aspect else (1, 0))
            eye = eye + depth * (off[0] * self.axes()[0] + off[1] * self.axes()[1] + (fill - 1) * self.direction())
        return eye

    def fitting_size(self):
        left, right, bottom, top = self.frame()
        low, high = (end(self.seen(self.eye(None)), axis=0) for end in (numpy.min, numpy.max))
        shape = (high - low)[1] / (high - low)[0] * (right - left) / (top - bottom)
        return WIDTH, round(float(numpy.clip(WIDTH * shape, 0.4 * WIDTH, WIDTH)))

    def place_camera(self, renderer):
        width, height = self.window.GetSize()
        eye = self.eye(width / height)
        camera = renderer.GetActiveCamera()
        camera.SetPosition(*eye)
        camera.SetFocalPoint(*(eye - self.direction()))
        camera.SetViewUp(*self.axes()[1])
        camera.SetViewAngle(ANGLE)
        camera.Zoom(self.look.zoom)
        renderer.ResetCameraClippingRange()

    def letters(self, part):
        """Height of letters in pixels: by the width, as pictures are shown as wide as a column of text, less in very flat ones."""
        width, height = self.window.GetSize()
        return max(11, int(min(width, 2.2 * height) / part))

    def add_words(self, renderer, snapshot):
        from .scene import GREENS
        units, look = self.units, self.look
        width, height = self.window.GetSize()
        self.add_text(renderer, units.at(snapshot.time), (width // 50, height * 95 // 100), self.letters(46))
        if self.stress > 0:
            largest = self.stress * units.factor("pressure")
            self.add_bar(renderer, self.table(0, largest, GREENS), units.label("wall shear\nstress", "pressure").replace(" (", "\n("), 0.03, 0.25)
        scales = [(name.replace("_", " "), derived.quantity(name), ends)
                  for name, ends in ((look.field, self.body_range), (look.behind, self.speed)) if name]
        if self.tension:
            scales.insert(0, ("tension\nof bonds", "force", self.tension))
        low, step, tall = ((0.25, 0, 0.5), (0.06, 0.46, 0.38), (0.04, 0.32, 0.25))[max(0, len(scales) - 1)]
        for n, (name, quantity, ends) in enumerate(scales):
            table = self.table(*(end * units.factor(quantity) for end in ends))
            self.add_bar(renderer, table, units.label(name + " ", quantity).replace(" (", "\n(", 1).strip(), 0.885, low + n * step, tall)
        self.add_scale(renderer, snapshot)

    def add_scale(self, renderer, snapshot):
        """Adds a length on the lower front edge of the box, and an arrow in the direction of the mean flow."""
        place = numpy.array([0, -self.gap(), self.run.length[2]])
        length = round_down(self.run.length[0] / 4)
        line = self.vtk.vtkLineSource()
        line.SetPoint1(*place)
        line.SetPoint2(*(place + [length, 0, 0]))
        self.actor(renderer, line, INK, LineWidth=4, Lighting=False)
        label = f"{length:g}{self.units.after('length')}"
        self.add_below(renderer, label, place, place + [length, 0, 0])
        velocity = snapshot.velocity()
        mean = velocity.mean(axis=(1, 2, 3))
        if abs(mean[0]) < 0.05 * numpy.linalg.norm(velocity, axis=0).max():
            return
        arrow, move = self.vtk.vtkArrowSource(), self.vtk.vtkTransform()
        arrow.SetTipLength(0.3)
        arrow.SetTipRadius(0.09)
        arrow.SetShaftRadius(0.028)
        size = 0.22 * self.run.length[0]
        end = numpy.array([self.run.length[0] - (0 if mean[0] < 0 else size), -self.gap(), self.run.length[2]])
        move.Translate(*end)
        move.Scale(numpy.sign(mean[0]) * size, size, size)
        moved = self.vtk.vtkTransformPolyDataFilter()
        moved.SetTransform(move)
        moved.SetInputConnection(arrow.GetOutputPort())
        self.actor(renderer, moved, INK, Lighting=False)
        self.add_below(renderer, "flow", end, end + [numpy.sign(mean[0]) * size, 0, 0])

    def add_below(self, renderer, words, *ends):
        """Adds text below a line in space, clear of the lower end of the line."""
        (x0, y0), (x1, y1) = (self.on_screen(renderer, end) for end in ends)
        self.add_text(renderer, words, ((x0 + x1) / 2, min(y0, y1) - self.letters(150)), self.letters(52), "Centered")

    def on_screen(self, renderer, place):
        coordinate = self.vtk.vtkCoordinate()
        coordinate.SetCoordinateSystemToWorld()
        coordinate.SetValue(*place)
        return coordinate.GetComputedViewportValue(renderer)

    def add_bar(self, renderer, table, title, place, low, height=0.5):
        bar = self.vtk.vtkScalarBarActor()
        bar.SetLookupTable(table)
        bar.SetTitle(title)
        bar.SetNumberOfLabels(5)
        bar.SetLabelFormat("%-.4g")
        bar.SetPosition(place, low)
        bar.SetWidth(0.08)
        bar.SetHeight(height)
        bar.SetVerticalTitleSeparation(self.letters(90))
        bar.SetUnconstrainedFontSize(True)
        for text in (bar.GetTitleTextProperty(), bar.GetLabelTextProperty()):
            self.style(text, self.letters(58))
        renderer.AddActor2D(bar)

    def style(self, text, size):
        text.SetColor(*INK)
        text.SetFontFamily(self.vtk.VTK_FONT_FILE)
        text.SetFontFile(FONT)
        text.SetFontSize(size)
        text.ItalicOff()
        text.BoldOff()
        text.ShadowOff()

    def add_text(self, renderer, words, place, size, side="Left"):
        text = self.vtk.vtkTextActor()
        text.SetInput(words)
        text.SetPosition(*place)
        self.style(text.GetTextProperty(), size)
        getattr(text.GetTextProperty(), "SetJustificationTo" + side)()
        text.GetTextProperty().SetVerticalJustificationToTop()
        renderer.AddActor2D(text)
