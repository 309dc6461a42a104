#!/usr/bin/env python3
"""The files of a tracking graph, read by the programs they are for: they must agree with each other.

    test_tracking_files.py WRITE_TRACKING HYPERISO
"""

import csv
import json
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree
from collections import Counter
from pathlib import Path

try:
    import networkx
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLUnstructuredGridReader
except ImportError:
    sys.exit(77)


def table(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def numbers(words):
    return [int(word) for word in words.split()]


def check_tables(folder, events, arcs):
    tracks, features, rows = (table(folder / f"{name}.csv") for name in ("tracks", "features", "events"))
    assert [row["type"] for row in rows] == [event["type"] for event in events]
    assert sum(len(numbers(row["tracks_out"])) - len(numbers(row["tracks_in"])) for row in rows) == 0
    assert sum(len(numbers(row["tracks_out"])) for row in rows) == arcs
    for row, event in zip(rows, events):
        assert float(row["time"]) == event["time"] and numbers(row["tracks_in"]) == event["in"]
    steps = Counter(row["track_id"] for row in features)
    for row in tracks:
        assert int(row["steps"]) == steps[row["track_id"]]
        for parent in numbers(row["parents"]):
            assert int(row["track_id"]) in numbers(tracks[parent]["children"])
        assert row["clipped"] in "01"
    for row in features:
        # what walls cut open may lie mostly beside its surface
        assert row["on_wall"] == "1" or float(row["low_x"]) <= float(row["centroid_x"]) <= float(row["high_x"])
        assert float(row["volume"]) > 0 and row["euler_characteristic"] in ("0", "1", "-1", "2", "3")
    assert "weak" in {row["end_type"] for row in tracks} | {row["start_type"] for row in tracks}
    return tracks, features


def check_graphs(folder, events, arcs):
    def signature(graph, kind):
        return Counter((data[kind], round(float(data["time"]), 9)) for _, data in graph.nodes(data=True))

    expected = Counter((event["type"], round(event["time"], 9)) for event in events)
    graphml = networkx.read_graphml(folder / "graph.graphml", force_multigraph=True)
    assert graphml.is_directed() and graphml.number_of_edges() == arcs and signature(graphml, "type") == expected
    assert networkx.is_directed_acyclic_graph(networkx.DiGraph(graphml))
    for _, _, data in graphml.edges(data=True):
        assert data["start_time"] <= data["end_time"] and isinstance(data["track_id"], int)

    gexf = networkx.read_gexf(folder / "graph.gexf")
    assert gexf.number_of_nodes() == len(events) and gexf.number_of_edges() == arcs
    assert all("start" in data and "end" in data for _, data in gexf.nodes(data=True))

    with open(folder / "graph.json", encoding="utf-8") as file:
        node_link = networkx.node_link_graph(json.load(file))
    assert node_link.number_of_edges() == arcs and signature(node_link, "type") == expected

    if shutil.which("dot"):
        plain = subprocess.run(["dot", "-Tplain", folder / "graph.dot"], check=True, capture_output=True, text=True)
        words = Counter(line.split()[0] for line in plain.stdout.splitlines())
        assert words["node"] == len(events) and words["edge"] == arcs, words


def check_vtu(folder, events, features):
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(folder / "graph.vtu"))
    reader.Update()
    grid = reader.GetOutput()
    assert grid.GetNumberOfPoints() == len(features) + len(events)
    data = {grid.GetPointData().GetArrayName(i): vtk_to_numpy(grid.GetPointData().GetArray(i))
            for i in range(grid.GetPointData().GetNumberOfArrays())}
    assert {"SequenceIndex", "Size", "BranchId", "Type", "Time"} <= set(data)
    assert sorted(data["BranchId"][: len(features)]) == sorted(int(row["track_id"]) for row in features)
    cells = {grid.GetCellData().GetArrayName(i) for i in range(grid.GetCellData().GetNumberOfArrays())}
    assert {"BranchId", "Overlap"} <= cells and grid.GetCellType(0) == 3  # lines


def check_pictures(folder, tracks):
    def of(name, tag):
        return ElementTree.parse(folder / name).getroot().iter("{http://www.w3.org/2000/svg}" + tag)

    shown = [row for row in tracks if row["simplified"] == "0"]
    for name in ("graph.svg", "volume.svg"):  # as wide as the window of a browser, if that is less
        picture = next(of(name, "svg"))
        assert "max-width:100%" in picture.get("style") and picture.get("viewBox").split()[2] == picture.get("width")
    titles = [title.text for title in of("graph.svg", "title")]
    assert sum(title.startswith("track ") for title in titles) == len(shown)
    assert not any(word in path.get("d") for path in of("graph.svg", "path") for word in ("nan", "inf"))
    assert len(list(of("volume.svg", "path"))) == sum(row["steps"] != "0" for row in shown)


def check_napari(folder, features):
    rows = table(folder / "napari_tracks.csv")
    assert list(rows[0]) == ["track_id", "t", "y", "x"] and len(rows) == len(features)
    keys = [(int(row["track_id"]), float(row["t"])) for row in rows]
    assert keys == sorted(set(keys))  # napari wants tracks one after the other, times ascending
    with open(folder / "napari_graph.json", encoding="utf-8") as file:
        assert all(isinstance(parent, int) for parents in json.load(file).values() for parent in parents)


def check_surfaces(program, folder):
    """The series of surfaces names the tracks that features.csv has at each step."""
    field = folder / "field.nrrd"
    quiet = {"check": True, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    subprocess.run([program, "sample", "gaussians", "--dims", "20,18,16,9", "-o", field], **quiet)
    subprocess.run([program, "track", field, "--iso", "0.5", "-o", folder / "tracks"], **quiet)
    features, tracks = (table(folder / "tracks" / f"{name}.csv") for name in ("features", "tracks"))
    series = list(ElementTree.parse(folder / "tracks" / "tracks.pvd").getroot().iter("DataSet"))
    assert len(series) == 9 and len(tracks) > 1
    for step, entry in enumerate(series):
        reader = vtkXMLPolyDataReader()
        reader.SetFileName(str(folder / "tracks" / entry.get("file")))
        reader.Update()
        surface = reader.GetOutput()
        ids, families = (vtk_to_numpy(surface.GetCellData().GetArray(name)) for name in ("track_id", "family_id"))
        rows = [row for row in features if int(row["step"]) == step]
        assert set(ids) == {int(row["track_id"]) for row in rows}
        assert all(int(tracks[track]["family_id"]) == family for track, family in zip(ids, families))
        assert all(float(row["time"]) == float(entry.get("timestep")) for row in rows)
        assert surface.GetNumberOfPolys() == len(ids) > 0


def main():
    with tempfile.TemporaryDirectory() as name:
        check_surfaces(sys.argv[2], Path(name))
    for blobs in (4, 60):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name) / "made" / "tracks"
            subprocess.run([sys.argv[1], folder, str(blobs)], check=True)
            with open(folder / "events.json", encoding="utf-8") as file:
                events = json.load(file)["events"]
            arcs = sum(len(event["out"]) for event in events)
            tracks, features = check_tables(folder, events, arcs)
            check_graphs(folder, events, arcs)
            check_vtu(folder, events, features)
            check_pictures(folder, tracks)
            check_napari(folder, features)


if __name__ == "__main__":
    main()
