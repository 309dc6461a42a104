#!/usr/bin/python3
"""Draws moments of a series of surfaces side by side: what ParaView would show of it, as a PNG.

    draw_series.py SERIES.pvd PICTURE.png TIME...

Draws the surfaces of the series that are nearest to the given times, in the box that holds them all, z up. Exits
with 3 where VTK's Python modules are missing, or there is no screen to draw on and no Xvfb to make one.
"""

import os
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

try:
    import vtkmodules.vtkRenderingFreeType  # noqa: F401, draws the text
    from vtkmodules.vtkCommonDataModel import vtkBoundingBox
    from vtkmodules.vtkFiltersCore import vtkPolyDataNormals
    from vtkmodules.vtkFiltersSources import vtkOutlineSource, vtkPlaneSource
    from vtkmodules.vtkFiltersCore import vtkImageAppend
    from vtkmodules.vtkIOImage import vtkPNGWriter
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
    from vtkmodules.vtkRenderingCore import (
        vtkActor, vtkLight, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkTextActor, vtkWindowToImageFilter)
    from vtkmodules.vtkRenderingOpenGL2 import vtkRenderStepsPass, vtkSSAAPass, vtkSSAOPass
except ImportError as error:
    print(f"draw_series: no picture: {error}", file=sys.stderr)
    sys.exit(3)

PANEL = 520  # pixels, both ways
TOWARDS_EYE = (1.15, -1.9, 0.95)
WATER, UNDERSIDE = (0.17, 0.52, 0.84), (0.50, 0.70, 0.82)
LINES, FLOOR, WALL, PAPER, INK = (0.45, 0.46, 0.50), (0.86, 0.85, 0.82), (0.94, 0.94, 0.93), (1, 1, 1), (0.2, 0.2, 0.22)


def read_series(path):
    """The times of a .pvd and their files."""
    entries = ElementTree.parse(path).iter("DataSet")
    return [(float(entry.get("timestep")), path.parent / entry.get("file")) for entry in entries]


def read_surface(file):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(file))
    reader.Update()
    return reader.GetOutput()


def actor_of(source, colour, ambient, diffuse):
    mapper = vtkPolyDataMapper()
    mapper.SetInputConnection(source.GetOutputPort())
    mapper.ScalarVisibilityOff()
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(colour)
    actor.GetProperty().SetAmbient(ambient)
    actor.GetProperty().SetDiffuse(diffuse)
    return actor


def surface_actor(surface):
    normals = vtkPolyDataNormals()
    normals.SetInputData(surface)
    normals.SplittingOff()
    normals.ConsistencyOff()  # the triangles are oriented as they are meant to be
    actor = actor_of(normals, WATER, 0.22, 0.85)
    actor.GetProperty().SetSpecular(0.35)
    actor.GetProperty().SetSpecularPower(30)
    underside = actor.MakeProperty()
    underside.SetColor(UNDERSIDE)
    underside.SetAmbient(0.3)
    actor.SetBackfaceProperty(underside)
    return actor


def plane(origin, point1, point2):
    source = vtkPlaneSource()
    source.SetOrigin(origin)
    source.SetPoint1(point1)
    source.SetPoint2(point2)
    return source


def box_actors(bounds):
    """The floor, the two walls at the back, and all edges."""
    x0, x1, y0, y1, z0, z1 = bounds
    outline = vtkOutlineSource()
    outline.SetBounds(bounds)
    edges = actor_of(outline, LINES, 1, 0)
    edges.GetProperty().SetLineWidth(1.5)
    return [actor_of(plane((x0, y0, z0), (x1, y0, z0), (x0, y1, z0)), FLOOR, 0.8, 0.2),
            actor_of(plane((x0, y0, z0), (x0, y1, z0), (x0, y0, z1)), WALL, 0.8, 0.2),
            actor_of(plane((x0, y1, z0), (x1, y1, z0), (x0, y1, z1)), WALL, 0.8, 0.2), edges]


def title(text):
    actor = vtkTextActor()
    actor.SetInput(text)
    actor.SetPosition(20, PANEL - 42)
    actor.GetTextProperty().SetFontSize(24)
    actor.GetTextProperty().SetColor(INK)
    return actor


def light(direction, intensity):
    source = vtkLight()
    source.SetLightTypeToSceneLight()
    source.SetPosition(direction)
    source.SetIntensity(intensity)
    return source


def set_camera(renderer, bounds):
    centre = [(bounds[2 * k] + bounds[2 * k + 1]) / 2 for k in range(3)]
    size = max(bounds[2 * k + 1] - bounds[2 * k] for k in range(3))
    camera = renderer.GetActiveCamera()
    camera.SetFocalPoint(centre)
    camera.SetPosition([c + size * d for c, d in zip(centre, TOWARDS_EYE)])
    camera.SetViewUp(0, 0, 1)
    renderer.ResetCamera(bounds)
    camera.Zoom(1.08)


def set_shading(renderer, bounds):
    """Light from above, and darkness where surfaces are close to each other, which shows their depth."""
    renderer.AutomaticLightCreationOff()
    renderer.AddLight(light((0.5, -1.5, 3), 0.75))
    renderer.AddLight(light((2.5, -1, 0.6), 0.35))
    size = max(bounds[2 * k + 1] - bounds[2 * k] for k in range(3))
    occlusion = vtkSSAOPass()
    occlusion.SetRadius(0.25 * size)
    occlusion.SetBias(0.01 * size)
    occlusion.SetKernelSize(256)
    occlusion.BlurOn()
    occlusion.SetDelegatePass(vtkRenderStepsPass())
    smooth = vtkSSAAPass()
    smooth.SetDelegatePass(occlusion)
    renderer.SetPass(smooth)


def panel(surface, bounds, text):
    """One moment as an image. Occlusion needs a window of its own."""
    renderer = vtkRenderer()
    renderer.SetBackground(PAPER)
    for actor in [surface_actor(surface), *box_actors(bounds)]:
        renderer.AddActor(actor)
    renderer.AddActor2D(title(text))
    set_camera(renderer, bounds)
    set_shading(renderer, bounds)
    window = vtkRenderWindow()
    window.SetOffScreenRendering(True)
    window.SetSize(PANEL, PANEL)
    window.AddRenderer(renderer)
    image = vtkWindowToImageFilter()
    image.SetInput(window)
    image.ReadFrontBufferOff()
    image.Update()
    return image.GetOutput()


def joined(images, axis):
    append = vtkImageAppend()
    append.SetAppendAxis(axis)
    for image in images:
        append.AddInputData(image)
    append.Update()
    return append.GetOutput()


def draw(entries, picture):
    surfaces = [(time, read_surface(file)) for time, file in entries]
    box = vtkBoundingBox()
    for _, surface in surfaces:
        box.AddBounds(surface.GetBounds())
    bounds = [0.0] * 6
    box.GetBounds(bounds)
    panels = [panel(surface, bounds, f"t = {time:g}") for time, surface in surfaces]
    columns = min(3, len(panels))
    rows = [joined(panels[start:start + columns], 0) for start in range(0, len(panels), columns)]
    writer = vtkPNGWriter()
    writer.SetFileName(str(picture))
    writer.SetInputData(joined(rows[::-1], 1))  # images are counted from below
    writer.Write()


def draw_on_a_screen_made_for_it():
    """Runs this program again with a screen of its own; VTK as Debian builds it ends the process where there is none.

    Xvfb itself takes the first free number and says which, once it is there: nobody else can take it in between. It
    must not start anew (-noreset) when one window is closed and the next not yet open: it refuses windows meanwhile.
    """
    if not shutil.which("Xvfb"):
        print("draw_series: no picture: there is no screen, and no Xvfb to make one", file=sys.stderr)
        return 3
    told, number = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(number), "-noreset", "-nolisten", "tcp",
                               "-screen", "0", "640x480x24"], pass_fds=[number], stderr=subprocess.DEVNULL)
    os.close(number)
    try:
        with os.fdopen(told) as line:
            display = line.readline().strip()
        if not display:
            print("draw_series: no picture: Xvfb did not start", file=sys.stderr)
            return 3
        run = subprocess.run([sys.executable, *sys.argv], env={**os.environ, "DISPLAY": f":{display}"}, check=False)
        return abs(run.returncode)
    finally:
        server.terminate()
        server.wait()


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    if not os.environ.get("DISPLAY"):
        return draw_on_a_screen_made_for_it()
    series = read_series(Path(sys.argv[1]))
    times = [float(time) for time in sys.argv[3:]]
    draw([min(series, key=lambda entry: abs(entry[0] - time)) for time in times], Path(sys.argv[2]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
