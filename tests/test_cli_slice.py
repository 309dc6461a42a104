"""slice: cuts of fields and of mesh files.

    test_cli_slice.py PROGRAM
"""

import math
import re
import struct
import unittest

from cli_case import Case, Run, WATER


class SliceOfAMesh(Case):
    def test_time_of_three_axes_of_space_is_told(self):
        field = self.sample()
        self.ok("extract", field, "--iso", "0.5", "-o", "ball.vtu")
        for source in ([field, "--iso", "0.5"], ["ball.vtu"]):
            told = Run("slice", *source, "--time", "0.25", "--json")
            self.assertRegex(told.err, r"\Ahyperiso: warning: --time cuts the last axis, z,.* --axis z=0.25 [^\n]*\n\Z")
            plain = self.ok("slice", *source, "--axis", "z=0.25", "--json").json()
            self.assertEqual(told.json()["hyperplane"], plain["hyperplane"])
        self.sample("ball", "12,12,5", "disc.nrrd", "--time")
        self.ok("slice", "disc.nrrd", "--iso", "0.5", "--time", "0.25")
        self.ok("slice", field, "--iso", "0.5", "--time-axis", "z", "--time", "0.25")

    def test_times_are_not_negative_and_a_cut_beside_the_data_is_refused(self):
        self.sample("ball", "9,9,9,5", "moving.nrrd")
        self.ok("extract", "moving.nrrd", "--iso", "0.5", "-o", "moving.vtu")
        cut = self.ok("slice", "moving.vtu", "--time", "0.5", "--json").json()
        for part in cut["seconds"].values():
            self.assertGreaterEqual(part, 0)
        for source in (["moving.vtu"], ["moving.nrrd", "--iso", "0.5"]):
            self.assert_refused(2, "slice", *source, "--time", "99", "-o", "x.vtp", words=["99", "axis t"])


class Slices(Case):
    # Any plane, several of each kind, in the order of the manual; from the field and from its mesh.
    def test_planes_and_series_from_field_and_mesh(self):
        field = self.sample("torus-morph", "14,14,14,7")
        self.ok("extract", field, "--iso", "0.5", "-o", "all.vtu")
        planes = ["--times", "0:2:0.5", "--time", "1.9", "--axis", "y=0.1", "--plane", "-1,0.5,0,0.25,0.125:0.5:0.125"]
        both = []
        for source in ([field, "--iso", "0.5"], ["all.vtu"]):
            found = self.ok("slice", *source, *planes, "--json", "--measure", "--precision", "f64").json()["slices"]
            self.assertEqual([cut["hyperplane"]["offset"] for cut in found],
                             [0, 0.5, 1, 1.5, 2, 1.9, 0.1, 0.125, 0.25, 0.375, 0.5])
            self.assertEqual(found[-1]["hyperplane"]["normal"], [-1, 0.5, 0, 0.25])
            for cut in found:
                self.assertEqual(cut["measure"]["bad_facets"], 0)
                self.assertGreater(cut["simplices"], 0)
            both.append([(cut["vertices"], cut["simplices"], cut["measure"]["euler_characteristic"]) for cut in found])
        self.assertEqual(*both)

    def test_volumes_from_field_and_mesh(self):
        field = self.sample("ball", "10,10,10,5")
        self.ok("interval", field, "--range", "0.4:0.6", "-o", "volume.vtu")
        planes = ["--time", "0.5,0.6", "--plane", "1,0,0,1,0.5"]
        both = [[(cut["vertices"], cut["simplices"]) for cut in self.ok("slice", *source, *planes, "--json").json()["slices"]]
                for source in ([field, "--range", "0.4:0.6"], ["volume.vtu"])]
        self.assertEqual(*both)
        self.assert_refused(2, "slice", field, "--range", "0.4:0.6", "--iso", "1", "--time", "0", words=["--iso", "--range"])
        self.assert_refused(2, "slice", "volume.vtu", "--range", "0:1", "--time", "0", words=["mesh"])

    # In the frame of the axes places are true; the other frame is told, and leads to the same places.
    def test_frame_of_an_oblique_plane(self):
        field = self.sample("ball", "10,10,10,5")
        points = []
        for frame in ("axes", "orthonormal"):
            cut = self.ok("slice", field, "--iso", "0.5", "--plane", "1,0,0,2,1.75", "--frame", frame, "--precision", "f64",
                          "-o", "cut.off", "--json").json()["frame"]
            lines = (self.folder / "cut.off").read_text().split("\n")
            points.append([[origin + sum(u * row[k] for u, row in zip(map(float, line.split()), cut["directions"]))
                            for k, origin in enumerate(cut["origin"])] for line in lines[2:2 + int(lines[1].split()[0])]])
        self.assertGreater(len(points[0]), 100)
        for a, b in zip(*points):
            self.assertAlmostEqual(a[0] + 2 * a[3], 1.75)
            for x, y in zip(a, b):
                self.assertAlmostEqual(x, y)

    def test_numbered_files_and_series(self):
        field = self.sample("ball", "10,10,10,5")
        run = self.ok("slice", field, "--iso", "0.5", "--times", "0:1:0.5", "-o", "f_%03d.vtp", "--json").json()
        self.assertEqual([cut["file"] for cut in run["slices"]], ["f_000.vtp", "f_001.vtp", "f_002.vtp"])
        self.ok("slice", field, "--iso", "0.5", "--time", "1", "-o", "100%%_%d.ply")
        self.assertEqual(self.files(), ["100%_0.ply", "f_000.vtp", "f_001.vtp", "f_002.vtp", "field.nrrd"])

    # Another field at the places of the surface: the field itself is the isovalue everywhere.
    def test_data_of_the_vertices(self):
        field = self.sample("ball", "10,10,10,5")
        data = ["--with", f"{field},again={field}", "--normals"]
        self.ok("extract", field, "--iso", "0.5", *data, "-o", "all.vtu")
        for source in ([field, "--iso", "0.5", *data], ["all.vtu"]):
            self.ok("slice", *source, "--plane", "1,0,0,1,1.2", "-o", "cut.ply", "--colour-by", "t")
            header, body = (self.folder / "cut.ply").read_bytes().split(b"end_header\n")
            names = re.findall(rb"property (\w+) (\w+)\n", header)
            self.assertEqual([name.decode() for _, name in names],
                             ["x", "y", "z", "nx", "ny", "nz", "field", "again", "t", "red", "green", "blue"])
            count = int(re.search(rb"element vertex (\d+)", header)[1])
            vertices = list(struct.iter_unpack("<9f3B", body[:count * 39]))
            self.assertGreater(count, 100)
            self.assertGreater(len({vertex[9:] for vertex in vertices}), 10)
            for vertex in vertices:
                self.assertAlmostEqual(math.hypot(*vertex[3:6]), 1, places=5)
                self.assertAlmostEqual(vertex[6], 0.5, places=5)
                self.assertEqual(vertex[6], vertex[7])
        self.assert_refused(2, "slice", "all.vtu", "--time", "0", "--normals", words=["extract"])

    def test_data_from_a_variable_of_the_same_file(self):
        points = [(x, y, z) for z in range(4) for y in range(4) for x in range(4)]
        arrays = {"distance": [math.dist(p, (1.4, 1.5, 1.6)) for p in points], "height": [p[2] * 2.0 for p in points]}
        data = "".join(f'<DataArray type="Float64" Name="{name}" format="ascii">{" ".join(map(repr, values))}</DataArray>'
                       for name, values in arrays.items())
        (self.folder / "two.vti").write_text(
            '<VTKFile type="ImageData"><ImageData WholeExtent="0 3 0 3 0 3" Origin="0 0 0" Spacing="1 1 1">'
            f'<Piece Extent="0 3 0 3 0 3"><PointData>{data}</PointData></Piece></ImageData></VTKFile>')
        self.ok("extract", "two.vti", "--iso", "1.2", "--inside", "below", "--with", "height", "-o", "s.ply", "--precision", "f64")
        header, body = (self.folder / "s.ply").read_bytes().split(b"end_header\n")
        self.assertIn(b"property double height\n", header)
        for x, y, z, height in struct.iter_unpack("<4d", body[:int(re.search(rb"vertex (\d+)", header)[1]) * 32]):
            self.assertAlmostEqual(height, 2 * z)
        self.assert_refused(2, "extract", "two.vti", "--iso", "1.2", "--with", "depth", words=["depth", "height"])


    def test_a_plane_that_meets_nothing_is_told(self):
        run = Run("slice", WATER, "--iso", "0.5", "--plane", "1,1,1,1,50")
        self.assertEqual(run.code, 0)
        self.assertIn("meets no part of the surface", run.err)
        self.ok("slice", WATER, "--iso", "0.5", "--plane", "1,1,1,1,50", "--quiet") # says nothing more


if __name__ == "__main__":
    unittest.main()
