#!/usr/bin/env python3
"""Tracks against the Reeb graphs that VTK computes, whose vtkReebGraph shares nothing with hyperiso.

    test_tracking_reeb.py HYPERISO

A Reeb graph is compared as a multiset of its arcs, each by the times of its two nodes and by how many arcs end and
begin there; the times of random fields are different enough for that to be the graph.
"""

import itertools
import json
import os
import subprocess
import sys
import tempfile
import unittest
from collections import Counter
from pathlib import Path

try:
    import numpy
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkReebGraph
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLUnstructuredGridReader
except ImportError:
    sys.exit(77)

PROGRAM = Path(sys.argv.pop(1)).resolve()


def run(*words):
    done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, check=False)
    assert done.returncode == 0, done.stderr.decode()
    return done.stdout


class Graph:
    """Nodes with times and arcs between them."""

    def __init__(self, times, arcs):
        self.times, self.arcs = list(times), list(arcs)

    def signature(self):
        """What is left when arcs of no duration are drawn together and nodes with one arc on each side left out."""
        parent = list(range(len(self.times)))

        def find(node):
            while parent[node] != node:
                node = parent[node]
            return node

        for a, b in self.arcs:
            if self.times[a] == self.times[b]:
                parent[find(a)] = find(b)
        arcs = [sorted((find(a), find(b)), key=lambda node: self.times[node]) for a, b in self.arcs]
        arcs = {number: arc for number, arc in enumerate(arcs) if self.times[arc[0]] != self.times[arc[1]]}
        before, after = {}, {}
        for number, (a, b) in arcs.items():
            after.setdefault(a, set()).add(number)
            before.setdefault(b, set()).add(number)
        for node in list(after):
            if len(after[node]) == 1 and len(before.get(node, ())) == 1:
                first, second = before.pop(node).pop(), after.pop(node).pop()
                end = arcs.pop(second)[1]
                arcs[first] = (arcs[first][0], end)
                before[end] = before[end] - {second} | {first}

        def name(node):
            return round(self.times[node], 6), len(before.get(node, ())), len(after.get(node, ()))

        return Counter((name(a), name(b)) for a, b in arcs.values())


def tracked(options):
    events = json.loads(run("track", *options, "--json"))["events"]
    begun, arcs = {}, []
    for number, event in enumerate(events):
        arcs += [(begun.pop(track), number) for track in event["in"]]
        for track in event["out"]:
            assert track not in begun
            begun[track] = number
    assert not begun, "a track without an end"
    return Graph([event["time"] for event in events], arcs)


def reeb_graph(simplices, times):
    """Of `times` on a complex of any dimension, of which its triangles are enough."""
    graph = vtkReebGraph()
    triangles = {triangle for simplex in simplices for triangle in itertools.combinations(sorted(simplex), 3)}
    for a, b, c in sorted(triangles, key=lambda triangle: max(times[corner] for corner in triangle)):
        graph.StreamTriangle(a, times[a], b, times[b], c, times[c])
    graph.CloseStream()
    vertex = graph.GetVertexData().GetAbstractArray("Vertex Ids")
    nodes = [times[int(vertex.GetTuple1(node))] for node in range(graph.GetNumberOfVertices())]
    arcs = [(graph.GetSourceVertex(arc), graph.GetTargetVertex(arc)) for arc in range(graph.GetNumberOfEdges())]
    return Graph(nodes, arcs)


def mesh_of(name, options, dimension, corners):
    """The simplices of a mesh that hyperiso writes and the times of its vertices."""
    reader = vtkXMLPolyDataReader() if name.endswith(".vtp") else vtkXMLUnstructuredGridReader()
    run(*options, "--precision", "f64", "-o", name)
    reader.SetFileName(name)
    reader.Update()
    mesh = reader.GetOutput()
    if mesh.GetNumberOfPoints() == 0:
        return [], []
    cells = mesh.GetPolys() if name.endswith(".vtp") else mesh.GetCells()
    simplices = vtk_to_numpy(cells.GetConnectivityArray()).reshape(-1, corners).tolist()
    if dimension == 4:
        times = vtk_to_numpy(mesh.GetPointData().GetArray("t"))
    else:
        times = vtk_to_numpy(mesh.GetPoints().GetData())[:, 2]
    return simplices, times.tolist()


def kuhn_simplices(shape):
    """Of each cell those along the paths from its lowest to its highest corner."""
    number = numpy.arange(numpy.prod(shape)).reshape(shape)
    simplices = []
    for corner in itertools.product(*(range(count - 1) for count in shape)):
        for order in itertools.permutations(range(len(shape))):
            path = [list(corner)]
            for axis in order:
                path.append([at + (k == axis) for k, at in enumerate(path[-1])])
            simplices.append([int(number[tuple(point)]) for point in path])
    return simplices


class ReebGraphs(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)

    def compare(self, field, method, region):
        numpy.save("field.npy", field)
        dimension = field.ndim
        common = ["field.npy", "--method", method]
        if region:
            high = float(field.max()) + 0.7
            options = ["interval", *common, "--range", f"0.1:{high}"]
            name, corners = "region.vtu", dimension + 1
        else:
            options = ["extract", *common, "--iso", "0.1"]
            name, corners = ("surface.vtu", 4) if dimension == 4 else ("surface.vtp", 3)
        expected = reeb_graph(*mesh_of(name, options, dimension, corners))
        found = tracked([*common, "--iso", "0.1", "--track", "region" if region else "surface"])
        self.assertEqual(found.signature(), expected.signature())
        return sum(expected.signature().values())

    def compare_random(self, shape, seeds, region, ties=False):
        arcs = 0
        for method in ("hull", "simplicial"):
            for seed in range(seeds):
                random = numpy.random.default_rng(seed)
                field = random.integers(-2, 3, shape) + 0.1 if ties else random.standard_normal(shape)
                with self.subTest(method=method, seed=seed):
                    arcs += self.compare(field, method, region)
        self.assertGreater(arcs, 3 * seeds)

    def test_surfaces_on_the_plane(self):
        self.compare_random((6, 5, 5), 12, region=False)

    def test_surfaces_in_space(self):
        self.compare_random((4, 4, 3, 3), 4, region=False)

    def test_surfaces_with_ties(self):
        self.compare_random((5, 4, 4), 12, region=False, ties=True)
        self.compare_random((3, 3, 3, 3), 4, region=False, ties=True)

    def test_regions_on_the_plane(self):
        self.compare_random((5, 4, 4), 6, region=True)

    def test_regions_in_space(self):
        self.compare_random((3, 3, 3, 2), 3, region=True)

    def test_regions_with_ties(self):
        self.compare_random((4, 4, 4), 6, region=True, ties=True)
        self.compare_random((3, 3, 2, 2), 4, region=True, ties=True)

    def rise(self, shape, speed, seed):
        """f = g + speed t with a random permutation g: its surface passes each sample once, and its history is the
        contour tree of -g on the grid's Kuhn simplices, with the times (isovalue - g) / speed."""
        g = numpy.random.default_rng(seed).permutation(numpy.prod(shape)).reshape(shape)
        isovalue = g.size - 0.5
        steps = numpy.arange(int(isovalue / speed) + 2).reshape(-1, *[1] * len(shape))
        numpy.save("rising.npy", (g + speed * steps).astype(float))
        found = tracked(["rising.npy", "--iso", isovalue, "--method", "simplicial"])
        expected = reeb_graph(kuhn_simplices(shape), ((isovalue - g) / speed).ravel().tolist())
        self.assertEqual(found.signature(), expected.signature(), f"seed {seed}")

    def test_rising_permutations_on_the_plane(self):
        for seed in range(100):
            self.rise((5, 6), (1, 0.7, 2.9, 13)[seed % 4], seed)

    def test_rising_permutations_in_space(self):
        for seed in range(24):
            self.rise((3, 4, 3), (1, 0.7, 2.9, 13)[seed % 4], seed)


if __name__ == "__main__":
    unittest.main()
