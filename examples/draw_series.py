#!/usr/bin/python3
"""Draws moments of a series of surfaces side by side: what ParaView would show of it, as a PNG.

    draw_series.py SERIES.pvd PICTURE.png TIME...

Draws the surfaces of the series that are nearest to the given times. Exits with 3 where VTK's Python modules are
missing, or there is no screen to draw on and no xvfb-run to make one.
"""

import os
import shutil
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

try:
    import vtkmodules.vtkRenderingFreeType  # noqa: F401, draws the text
    import vtkmodules.vtkRenderingOpenGL2  # noqa: F401, draws
    from vtkmodules.vtkCommonDataModel import vtkBoundingBox
    from vtkmodules.vtkFiltersCore import vtkPolyDataNormals
    from vtkmodules.vtkFiltersSources import vtkOutlineSource, vtkPlaneSource
    from vtkmodules.vtkIOImage import vtkPNGWriter
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
    from vtkmodules.vtkRenderingCore import (
        vtkActor, vtkLightKit, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkTextActor, vtkWindowToImageFilter)
except ImportError as error:
    print(f"draw_series: no picture: {error}", file=sys.stderr)
    sys.exit(3)

PANEL = 480  # pixels, both ways
WATER, UNDERSIDE = (0.20, 0.55, 0.85), (0.62, 0.78, 0.88)
LINES, FLOOR, PAPER, INK = (0.55, 0.55, 0.58), (0.93, 0.93, 0.91), (1, 1, 1), (0.2, 0.2, 0.22)


def read_series(path):
    """The times of a .pvd and their files."""
    entries = ElementTree.parse(path).iter("DataSet")
    return [(float(entry.get("timestep")), path.parent / entry.get("file")) for entry in entries]


def read_surface(file):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(file))
    reader.Update()
    return reader.GetOutput()


def surface_actor(surface):
    normals = vtkPolyDataNormals()
    normals.SetInputData(surface)
    normals.SplittingOff()
    normals.ConsistencyOff()  # the triangles are oriented as they are meant to be
    mapper = vtkPolyDataMapper()
    mapper.SetInputConnection(normals.GetOutputPort())
    mapper.ScalarVisibilityOff()
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(WATER)
    actor.GetProperty().SetSpecular(0.35)
    actor.GetProperty().SetSpecularPower(40)
    underside = actor.MakeProperty()
    underside.SetColor(UNDERSIDE)
    actor.SetBackfaceProperty(underside)
    return actor


def flat_actor(source, colour):
    mapper = vtkPolyDataMapper()
    mapper.SetInputConnection(source.GetOutputPort())
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(colour)
    actor.GetProperty().LightingOff()
    return actor


def box_actor(bounds):
    outline = vtkOutlineSource()
    outline.SetBounds(bounds)
    return flat_actor(outline, LINES)


def floor_actor(bounds):
    floor = vtkPlaneSource()
    floor.SetOrigin(bounds[0], bounds[2], bounds[4])
    floor.SetPoint1(bounds[1], bounds[2], bounds[4])
    floor.SetPoint2(bounds[0], bounds[3], bounds[4])
    return flat_actor(floor, FLOOR)


def title(text):
    actor = vtkTextActor()
    actor.SetInput(text)
    actor.SetPosition(20, PANEL - 42)
    actor.GetTextProperty().SetFontSize(24)
    actor.GetTextProperty().SetColor(INK)
    return actor


def panel(surface, bounds, text):
    renderer = vtkRenderer()
    renderer.SetBackground(PAPER)
    renderer.AddActor(surface_actor(surface))
    renderer.AddActor(box_actor(bounds))
    renderer.AddActor(floor_actor(bounds))
    renderer.AddActor2D(title(text))
    centre = [(bounds[2 * k] + bounds[2 * k + 1]) / 2 for k in range(3)]
    size = max(bounds[2 * k + 1] - bounds[2 * k] for k in range(3))
    camera = renderer.GetActiveCamera()
    camera.SetFocalPoint(centre)
    camera.SetPosition(centre[0] + 1.15 * size, centre[1] - 1.9 * size, centre[2] + 0.95 * size)
    camera.SetViewUp(0, 0, 1)
    renderer.ResetCamera(bounds)
    camera.Zoom(1.08)
    lights = vtkLightKit()
    lights.SetKeyLightAngle(40, -35)  # above, to the left
    lights.AddLightsToRenderer(renderer)
    return renderer


def draw(entries, picture):
    surfaces = [(time, read_surface(file)) for time, file in entries]
    box = vtkBoundingBox()
    for _, surface in surfaces:
        box.AddBounds(surface.GetBounds())
    bounds = [0.0] * 6
    box.GetBounds(bounds)

    columns = min(3, len(surfaces))
    rows = -(-len(surfaces) // columns)
    window = vtkRenderWindow()
    window.SetOffScreenRendering(True)
    window.SetMultiSamples(8)
    window.SetSize(columns * PANEL, rows * PANEL)
    for number, (time, surface) in enumerate(surfaces):
        column, row = number % columns, rows - 1 - number // columns
        renderer = panel(surface, bounds, f"t = {time:g}")
        renderer.SetViewport(column / columns, row / rows, (column + 1) / columns, (row + 1) / rows)
        window.AddRenderer(renderer)

    image = vtkWindowToImageFilter()
    image.SetInput(window)
    image.ReadFrontBufferOff()
    writer = vtkPNGWriter()
    writer.SetFileName(str(picture))
    writer.SetInputConnection(image.GetOutputPort())
    writer.Write()


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    if not os.environ.get("DISPLAY"):
        # VTK as Debian builds it ends the process where there is no screen.
        if not shutil.which("xvfb-run"):
            print("draw_series: no picture: there is no screen, and no xvfb-run to make one", file=sys.stderr)
            return 3
        os.execvp("xvfb-run", ["xvfb-run", "-a", sys.executable, *sys.argv])
    series = read_series(Path(sys.argv[1]))
    times = [float(time) for time in sys.argv[3:]]
    draw([min(series, key=lambda entry: abs(entry[0] - time)) for time in times], Path(sys.argv[2]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
