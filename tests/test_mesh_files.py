"""Reads the mesh files of hyperiso with VTK and meshio, and lets hyperiso read VTK's, and compares.

    test_mesh_files.py MESH_FILES        the program made of mesh_files.cpp

Exits with 77 where Python has no VTK.
"""

import itertools
import json
import subprocess
import sys
import tempfile
import xml.etree.ElementTree
from pathlib import Path

try:
    import numpy
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)
try:
    import meshio
except ImportError:
    meshio = None

VTK_CELL_TYPES = {2: vtk.VTK_LINE, 3: vtk.VTK_TRIANGLE, 4: vtk.VTK_TETRA, 5: vtk.VTK_POLY_VERTEX}
FLOAT = {False: numpy.float32, True: numpy.float64}


class Checks:
    """Counts what was compared and collects what differed."""

    def __init__(self):
        self.count, self.failures = 0, []

    def equal(self, read, written, what):
        self.count += 1
        read, written = numpy.asarray(read), numpy.asarray(written)
        if read.size == written.size == 0:
            return
        if read.shape != written.shape or not numpy.array_equal(read, written):
            self.failures.append(f"{what}: read {read.shape} {read.ravel()[:6]}, written {written.shape} {written.ravel()[:6]}")

    def close(self, read, written, tolerance, what):
        self.count += 1
        if not abs(read - written) <= tolerance:
            self.failures.append(f"{what}: {read}, not {written} within {tolerance}")


def collect_vtk_messages():
    """VTK reports errors to a window and carries on. Returns a window that keeps them."""
    window = vtk.vtkStringOutputWindow()
    vtk.vtkOutputWindow.SetInstance(window)
    return window


def points_of(mesh, dtype=None):
    """The points as a file holds them, three coordinates each."""
    positions = numpy.array(mesh["positions"], FLOAT[mesh["f64"]]).reshape(-1, mesh["dimension"])
    xyz = numpy.zeros((len(positions), 3), dtype or positions.dtype)
    columns = min(3, mesh["dimension"])
    xyz[:, :columns] = positions[:, :columns]
    return xyz


def simplices_of(mesh):
    return numpy.array(mesh["simplices"], numpy.int64).reshape(-1, mesh["corners"])


def read_with(reader, path):
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def array_of(data, name):
    array = data.GetArray(name)
    return None if array is None else vtk_to_numpy(array)


def vtk_points(data):
    return numpy.zeros((0, 3)) if data.GetNumberOfPoints() == 0 else vtk_to_numpy(data.GetPoints().GetData())


def vtk_cells(cells, corners):
    connectivity = vtk_to_numpy(cells.GetConnectivityArray())
    offsets = vtk_to_numpy(cells.GetOffsetsArray())
    assert numpy.array_equal(offsets, corners * numpy.arange(len(offsets))), "cells of another size"
    return connectivity.reshape(-1, corners)


def check_xml(mesh, data, cells, what, checks):
    """What .vtu and .vtp have in common: all of the mesh, to the bit."""
    checks.equal(vtk_points(data), points_of(mesh), f"{what}: points")
    checks.equal(vtk_cells(cells, mesh["corners"]), simplices_of(mesh), f"{what}: cells")
    if mesh["positions"]:
        checks.equal(vtk_points(data).dtype == FLOAT[mesh["f64"]], True, f"{what}: precision")
    for attribute in mesh["attributes"]:
        where = data.GetPointData() if attribute["at"] == "points" else data.GetCellData()
        read = array_of(where, attribute["name"])
        checks.equal(read is not None, True, f"{what}: attribute {attribute['name']} is there")
        if read is not None:
            values = numpy.array(attribute["values"], read.dtype)
            shape = (-1, attribute["components"]) if attribute["components"] > 1 else (-1,)
            checks.equal(read, values.reshape(shape), f"{what}: attribute {attribute['name']}")
    if mesh["edges"]:
        checks.equal(array_of(data.GetPointData(), "grid_edge"), numpy.array(mesh["edges"], numpy.uint64), f"{what}: edges")
    if mesh["dimension"] == 4 and mesh["positions"]:
        xyzt = numpy.array(mesh["positions"], FLOAT[mesh["f64"]]).reshape(-1, 4)
        checks.equal(array_of(data.GetPointData(), "xyzt"), xyzt, f"{what}: xyzt")
        checks.equal(array_of(data.GetPointData(), "t"), xyzt[:, 3], f"{what}: t")


def check_vtu(mesh, path, checks):
    grid = read_with(vtk.vtkXMLUnstructuredGridReader(), path)
    check_xml(mesh, grid, grid.GetCells(), path.name, checks)
    types = {grid.GetCellType(i) for i in range(grid.GetNumberOfCells())}
    checks.equal(types <= {VTK_CELL_TYPES[mesh["corners"]]}, True, f"{path.name}: cell types")
    if "time" in mesh:
        check_contour_in_time(mesh, grid, checks)


def points_of_lines(mesh):
    """The points of each line, the first one again at the end of closed ones."""
    positions = numpy.array(mesh["positions"], FLOAT[mesh["f64"]]).reshape(-1, 2)
    return [positions[line["vertices"] + (line["vertices"][:1] if line["closed"] else [])] for line in mesh["lines"]]


def check_vtp_lines(mesh, data, what, checks):
    points, lines = vtk_points(data)[:, :2], points_of_lines(mesh)
    checks.equal(data.GetNumberOfLines(), len(lines), f"{what}: lines")
    for i, line in enumerate(lines):
        ids = data.GetCell(i).GetPointIds()
        checks.equal([points[ids.GetId(k)] for k in range(ids.GetNumberOfIds())], line, f"{what}: line {i}")


def check_svg(mesh, path, checks):
    """A path for each line, in order: as far as hundredths of pixels tell, an affine image of it."""
    svg = "{http://www.w3.org/2000/svg}"
    root = xml.etree.ElementTree.parse(path).getroot()
    paths = root.find(f"{svg}g[@id='isolines']").findall(f"{svg}path")
    checks.equal(len(paths), len(mesh["lines"]), f"{path.name}: lines")
    drawn, expected = [], []
    for shape, line, points in zip(paths, mesh["lines"], points_of_lines(mesh)):
        words = shape.get("d")
        checks.equal(words.endswith("Z"), line["closed"], f"{path.name}: closed")
        drawn += [[float(x) for x in word.split()] for word in words.strip("MZ").split("L")]
        expected += list(points[:len(line["vertices"])])
    drawn, expected = numpy.array(drawn), numpy.array(expected)
    checks.equal(drawn.shape, expected.shape, f"{path.name}: points")
    for axis, rising in [(0, True), (1, False)]:
        (slope, offset), *_ = numpy.polyfit(expected[:, axis], drawn[:, axis], 1, full=True)
        checks.equal(slope > 0, rising, f"{path.name}: y points upwards")
        checks.close(abs(slope * expected[:, axis] + offset - drawn[:, axis]).max(), 0, 0.011, f"{path.name}: places")
        checks.equal((drawn[:, axis] >= 0).all(), True, f"{path.name}: inside the picture")


def check_geojson(mesh, path, checks):
    def refuse(word):
        raise ValueError(f"{word} in {path.name}")
    features = json.loads(path.read_text(), parse_constant=refuse)["features"]
    checks.equal(len(features), len(mesh["lines"]), f"{path.name}: lines")
    for feature, line, points in zip(features, mesh["lines"], points_of_lines(mesh)):
        checks.equal(feature["geometry"]["type"], "LineString", f"{path.name}: type")
        checks.equal(feature["properties"]["closed"], line["closed"], f"{path.name}: closed")
        checks.equal(numpy.array(feature["geometry"]["coordinates"], points.dtype), points, f"{path.name}: points")


def check_vtp(mesh, path, checks):
    data = read_with(vtk.vtkXMLPolyDataReader(), path)
    if "lines" in mesh:
        return check_vtp_lines(mesh, data, path.name, checks)
    check_xml(mesh, data, data.GetLines() if mesh["corners"] == 2 else data.GetPolys(), path.name, checks)


def check_contour_in_time(mesh, grid, checks):
    """ParaView's way of slicing: a contour of the point data `t` is our slice at that time."""
    contour = vtk.vtkContourFilter()
    contour.SetInputData(grid)
    contour.SetInputArrayToProcess(0, 0, 0, vtk.vtkDataObject.FIELD_ASSOCIATION_POINTS, "t")
    contour.SetValue(0, mesh["time"])
    area = vtk.vtkMassProperties()
    area.SetInputConnection(contour.GetOutputPort())
    area.Update()
    checks.close(area.GetSurfaceArea(), mesh["area"], 1e-5 * mesh["area"], "contour of t: area of the slice")
    checks.close(area.GetSurfaceArea(), numpy.pi, 0.03 * numpy.pi, "contour of t: area of the ball")
    edges = vtk.vtkFeatureEdges()
    edges.SetInputConnection(contour.GetOutputPort())
    edges.FeatureEdgesOff()
    edges.Update()
    checks.equal(edges.GetOutput().GetNumberOfCells(), 0, "contour of t: open or branching edges")


def check_ply(mesh, path, checks):
    data = read_with(vtk.vtkPLYReader(), path)
    checks.equal(vtk_points(data), points_of(mesh, numpy.float32), f"{path.name}: points")
    checks.equal(vtk_cells(data.GetPolys(), 3), simplices_of(mesh), f"{path.name}: cells")
    if meshio is None or any(attribute["at"] == "cells" for attribute in mesh["attributes"]):
        return  # meshio does not read scalars of faces
    read = meshio.read(path)
    checks.equal(read.points, points_of(mesh), f"{path.name}: points, by meshio")
    checks.equal(read.cells_dict["triangle"], simplices_of(mesh), f"{path.name}: cells, by meshio")
    for attribute in mesh["attributes"]:
        if attribute["components"] == 1:
            checks.equal(read.point_data[attribute["name"]],
                         numpy.array(attribute["values"], read.point_data[attribute["name"]].dtype),
                         f"{path.name}: {attribute['name']}, by meshio")


def check_stl(mesh, path, checks):
    reader = vtk.vtkSTLReader()
    reader.MergingOff()
    data = read_with(reader, path)
    triangles = points_of(mesh, numpy.float32)[simplices_of(mesh)]
    checks.equal(vtk_points(data).reshape(-1, 3, 3), triangles, f"{path.name}: corners")
    cross = numpy.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    records = numpy.frombuffer(path.read_bytes()[84:], numpy.dtype([("normal", "<f4", 3), ("rest", "V38")]))
    along = numpy.einsum("ij,ij->i", cross, records["normal"]) - numpy.linalg.norm(cross, axis=1)
    checks.close(abs(along).max(), 0, 1e-3, f"{path.name}: normals")


def check_obj(mesh, path, checks):
    data = read_with(vtk.vtkOBJReader(), path)
    checks.equal(vtk_points(data), points_of(mesh, numpy.float32), f"{path.name}: points")
    cells = data.GetLines() if mesh["corners"] == 2 else data.GetPolys()
    checks.equal(vtk_cells(cells, mesh["corners"]), simplices_of(mesh), f"{path.name}: cells")


def check_off(mesh, path, checks):
    if meshio is None:
        return
    read = meshio.read(path)
    checks.equal(read.points.astype(FLOAT[mesh["f64"]]), points_of(mesh), f"{path.name}: points")
    checks.equal(read.cells_dict["triangle"], simplices_of(mesh), f"{path.name}: cells")


CHECKS = {".vtu": check_vtu, ".vtp": check_vtp, ".ply": check_ply, ".stl": check_stl, ".obj": check_obj, ".off": check_off,
          ".svg": check_svg, ".geojson": check_geojson}


def check_series(folder, checks):
    entries = xml.etree.ElementTree.parse(folder / "series & <more>.pvd").getroot().find("Collection")
    checks.equal([float(entry.get("timestep")) for entry in entries], [0.1, 1 / 3], "series: times")
    checks.equal([(folder / entry.get("file")).is_file() for entry in entries], [True, True], "series: files")


def grid_of_vtk():
    """A small tetrahedral mesh made by VTK, with arrays of several types."""
    random = numpy.random.default_rng(1)
    grid = vtk.vtkUnstructuredGrid()
    points = vtk.vtkPoints()
    points.SetDataTypeToDouble()
    points.SetData(numpy_to_vtk(random.normal(size=(30, 3)), deep=True))
    grid.SetPoints(points)
    for corners in random.permuted(numpy.tile(numpy.arange(30), (20, 1)), axis=1)[:, :4]:
        grid.InsertNextCell(vtk.VTK_TETRA, 4, [int(corner) for corner in corners])
    for name, values in [("heat", random.normal(size=30).astype(numpy.float32)), ("pairs", random.normal(size=(30, 2))),
                         ("small", numpy.arange(-15, 15, dtype=numpy.int8)), ("big", numpy.arange(30, dtype=numpy.uint64) << 40)]:
        array = numpy_to_vtk(values, deep=True)
        array.SetName(name)
        grid.GetPointData().AddArray(array)
    return grid


def files_of_vtk(folder):
    """The same mesh in every encoding that VTK writes."""
    grid = grid_of_vtk()
    for mode, zlib, wide, big_endian in itertools.product(("ascii", "binary", "raw", "base64"), (0, 1), (0, 1), (0, 1)):
        writer = vtk.vtkXMLUnstructuredGridWriter()
        writer.SetInputData(grid)
        {"ascii": writer.SetDataModeToAscii, "binary": writer.SetDataModeToBinary}.get(mode, writer.SetDataModeToAppended)()
        writer.SetEncodeAppendedData(mode == "base64")
        (writer.SetCompressorTypeToZLib if zlib else writer.SetCompressorTypeToNone)()
        (writer.SetHeaderTypeToUInt64 if wide else writer.SetHeaderTypeToUInt32)()
        (writer.SetByteOrderToBigEndian if big_endian else writer.SetByteOrderToLittleEndian)()
        path = folder / f"vtk_{mode}_{zlib}_{wide}_{big_endian}.vtu"
        writer.SetFileName(str(path))
        writer.Write()
        yield path, grid


def check_reading(program, folder, checks):
    """hyperiso reads what VTK wrote."""
    files = list(files_of_vtk(folder))
    dumps = subprocess.run([program, "dump", *(str(path) for path, _ in files)], check=True, capture_output=True, text=True)
    for (path, grid), line in zip(files, dumps.stdout.splitlines(), strict=True):
        mesh = json.loads(line)
        checks.equal([mesh["dimension"], mesh["corners"]], [3, 4], f"{path.name}: dimensions")
        checks.equal(points_of(mesh), vtk_points(grid), f"{path.name}: points")
        checks.equal(simplices_of(mesh), vtk_cells(grid.GetCells(), 4), f"{path.name}: cells")
        for attribute in mesh["attributes"]:
            expected = array_of(grid.GetPointData(), attribute["name"])
            read = numpy.array(attribute["values"]).astype(expected.dtype).reshape(expected.shape)
            checks.equal(read, expected, f"{path.name}: {attribute['name']}")
        checks.equal(len(mesh["attributes"]), 4, f"{path.name}: attributes")


def main():
    program = sys.argv[1]
    messages = collect_vtk_messages()
    checks = Checks()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        subprocess.run([program, "write", name], check=True)
        for mesh in json.loads((folder / "meshes.json").read_text()):
            path = folder / mesh["file"]
            CHECKS[path.suffix](mesh, path, checks)
        check_series(folder, checks)
        check_reading(program, folder, checks)
    if messages.GetOutput():
        checks.failures.append(f"VTK says: {messages.GetOutput()}")
    for failure in checks.failures:
        print(failure)
    print(f"{checks.count} comparisons, {len(checks.failures)} failures" + ("" if meshio else "; meshio is missing: no OFF"))
    return 1 if checks.failures else 0


if __name__ == "__main__":
    sys.exit(main())
