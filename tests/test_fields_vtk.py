#!/usr/bin/env python3
"""VTI files that VTK wrote, read by convert_field, and files that convert_field wrote, read by VTK.

    test_fields_vtk.py CONVERT_FIELD
"""

import itertools
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree
from pathlib import Path

try:
    import numpy as np
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLImageDataWriter
except ImportError:
    sys.exit(77)

random = np.random.default_rng(1)


def convert(*words):
    subprocess.run([sys.argv[1], *map(str, words)], check=True)


def image_of(array, cells=False):
    """array[z, y, x] as an image whose extent does not begin at 0."""
    image = vtkImageData()
    counts = array.shape[::-1]
    more = 1 if cells else 0
    image.SetExtent(3, 2 + counts[0] + more, -1, counts[1] - 2 + more, 0, counts[2] - 1 + more)
    image.SetOrigin(1, 2, 3)
    image.SetSpacing(0.5, 1, 2)
    values = numpy_to_vtk(array.ravel(), deep=True)
    values.SetName("values")
    vectors = numpy_to_vtk(np.repeat(array.ravel(), 3).reshape(-1, 3), deep=True)
    vectors.SetName("vectors")
    data = image.GetCellData() if cells else image.GetPointData()
    data.AddArray(vectors)
    data.SetScalars(values)
    return image


def read(path):
    reader = vtkXMLImageDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def samples_of(image):
    counts = image.GetDimensions()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(counts[::-1])


with tempfile.TemporaryDirectory() as name:
    folder = Path(name)
    for kind in "u1 i1 u2 i2 u4 i4 f4 f8".split():
        array = random.integers(0, 100, (5, 4, 3)).astype(kind)

        # VTK's, read by us.
        for mode, compressed, encoded, wide, big_endian, cells in itertools.product(
                ("ascii", "binary", "appended"), (0, 1), (0, 1), (32, 64), (0, 1), (0, 1)):
            if kind not in ("f4", "u2") and (cells or wide == 32):
                continue  # the type matters for few of these
            writer = vtkXMLImageDataWriter()
            writer.SetInputData(image_of(array, bool(cells)))
            writer.SetDataMode({"ascii": 0, "binary": 1, "appended": 2}[mode])
            if compressed:
                writer.SetCompressorTypeToZLib()
                writer.SetBlockSize(32)  # several blocks
            else:
                writer.SetCompressorTypeToNone()
            writer.SetEncodeAppendedData(encoded)
            writer.SetHeaderType(wide)
            writer.SetByteOrder(0 if big_endian else 1)
            writer.SetFileName(str(folder / "theirs.vti"))
            writer.Write()
            convert(folder / "theirs.vti", folder / "a.npy")
            assert np.array_equal(np.load(folder / "a.npy"), array), (kind, mode, compressed, encoded, wide, cells)

        # Ours, read by VTK.
        convert(folder / "theirs.vti", folder / "ours.vti")
        image = read(folder / "ours.vti")
        assert np.array_equal(samples_of(image), array), kind
        assert image.GetPointData().GetScalars().GetName() == "values"

    writer.SetInputData(image_of(array))
    writer.Write()
    convert(folder / "theirs.vti", folder / "ours.vti")
    theirs, ours = image_of(array), read(folder / "ours.vti")
    assert ours.GetExtent() == theirs.GetExtent(), ours.GetExtent()
    assert ours.GetOrigin() == theirs.GetOrigin() and ours.GetSpacing() == theirs.GetSpacing()

    # Falling axes: each sample stays at its place.
    (folder / "falling.nrrd").write_bytes(
        b"NRRD0004\ntype: uchar\ndimension: 2\nsizes: 2 3\nencoding: raw\nspacings: 1 -2\naxis mins: 0 5\n\n" +
        bytes(range(6)))
    convert(folder / "falling.nrrd", folder / "ours.vti")
    image = read(folder / "ours.vti")
    positions = {image.GetPoint(i)[:2]: image.GetPointData().GetScalars().GetTuple1(i) for i in range(6)}
    assert positions == {(0, 5): 0, (1, 5): 1, (0, 3): 2, (1, 3): 3, (0, 1): 4, (1, 1): 5}, positions

    # Oriented: in the world as well.
    (folder / "oblique.nrrd").write_bytes(
        b"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 3 4\nencoding: raw\nspace: LPS\n"
        b"space directions: (0,2,0) (-1,0,0) (0,0,3)\nspace origin: (1,2,3)\n\n" + bytes(range(24)))
    convert(folder / "oblique.nrrd", folder / "ours.vti")
    image = read(folder / "ours.vti")
    for z, y, x in itertools.product(range(4), range(3), range(2)):
        i = x + 2 * (y + 3 * z)
        assert image.GetPointData().GetScalars().GetTuple1(i) == i
        assert np.allclose(image.GetPoint(i), (1 - y, 2 + 2 * x, 3 + 3 * z)), (image.GetPoint(i), x, y, z)

    # A series, in the order and with the times of its .pvd.
    array = random.random((3, 5, 4, 2)).astype("f4")
    np.save(folder / "a.npy", array)
    convert(folder / "a.npy", folder / "series.pvd")
    steps = ElementTree.parse(folder / "series.pvd").getroot().find("Collection")
    assert [float(step.get("timestep")) for step in steps] == [0, 1, 2]
    for step, expected in zip(steps, array):
        assert np.array_equal(samples_of(read(folder / step.get("file"))), expected)
