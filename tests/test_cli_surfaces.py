"""Surfaces and volumes of fields: what is selected of them, where they are, what they cost.

    test_cli_surfaces.py PROGRAM
"""

import itertools
import json
import math
import re
import struct
import subprocess
import unittest

from cli_case import Case, HAS_VIEW, PROGRAM, Run


class FlatAxes(Case):
    def test_one_step_of_a_volume_is_a_volume(self):
        self.sample("ball", "9,9,9,5", "moving.nrrd")
        step = self.ok("extract", "moving.nrrd", "--iso", "0.5", "--steps", "2:3", "--json").json()
        self.assertEqual(step["dims"], [9, 9, 9])
        self.assertGreater(step["simplices"], 0)


class FlatVolumes(Case):
    """Images through time that are stored as volumes of one layer: all is as it is for the images."""

    IMAGES, LAYERS = (["a.raw", "--type", "f32", "--dims", dims] for dims in ("12,11,9", "12,11,1,9"))

    def setUp(self):
        super().setUp()
        self.sample("gaussians", "12,11,9", "a.nrrd")
        self.ok("convert", "a.nrrd", "-o", "a.raw")

    def results(self, verb, *options):
        """Of images and of layers, without what a clock tells."""
        for field in (self.IMAGES, self.LAYERS):
            found = self.ok(verb, *field, *options, "--json").json()
            for key in ("seconds", "peak_memory_bytes"):
                found.pop(key, None)
            yield found

    def test_the_layer_is_left_out(self):
        for command in (["extract", "--iso", "0.5", "--measure"], ["slice", "--iso", "0.5", "--axis", "y=4.5", "--with", "again=a.raw"],
                        ["animate", "--iso", "0.5", "--frames", "5", "-o", "a_%d.vtp", "--with", "again=a.raw"],
                        ["track", "--iso", "0.5"], ["track", "--iso", "0.5", "--seed", "3.5,4.5,4.5"],
                        ["track", "--iso", "0.5", "--track", "region", "--with", "again=a.raw"], ["morph", "--iso", "0.5"]):
            images, layers = self.results(*command)
            self.assertEqual(images, layers, command)

    # The plane has a number for each axis of the file.
    def test_planes_have_a_number_for_the_layer(self):
        options = ["--iso", "0.5", "--measure", "--json"]
        images = self.ok("slice", *self.IMAGES, "--plane", "1,0.5,0.2,6", *options).json()["measure"]
        layers = self.ok("slice", *self.LAYERS, "--plane", "1,0.5,0,0.2,6", *options).json()["measure"]
        self.assertEqual(images, layers)
        self.assertGreater(images["content"], 0)

    def test_tracked_folders_know_it(self):
        for folder, field in (("images", self.IMAGES), ("layers", self.LAYERS)):
            self.ok("track", *field, "--iso", "0.5", "-o", folder)
            self.ok("animate", folder, "--frames", "3", "-o", folder + "_%d.vtp")
            self.ok("track", "--select", folder + ":0", "--json")
        tables = [(self.folder / folder / "tracks.csv").read_text() for folder in ("images", "layers")]
        self.assertEqual(*tables)
        self.assertGreater(len(tables[0].splitlines()), 1)

    # Then it is the other axes that are left: the surface through time.
    def test_the_layer_can_be_cut(self):
        whole = self.ok("extract", *self.IMAGES, "--iso", "0.5", "--json").json()
        cut = self.ok("slice", *self.LAYERS, "--iso", "0.5", "--axis", "2=0", "--with", "again=a.raw", "-o", "a.vtp",
                      "--json").json()
        self.assertEqual(cut["vertices"], whole["vertices"])
        self.assertGreater(cut["vertices"], 0)

    def test_one_step_is_not_a_layer(self):
        self.assert_refused(2, "track", "a.raw", "--type", "f32", "--dims", "12,11,9,1", "--iso", "0.5",
                            words=["12 x 11 x 9 x 1", "--time-axis", "--steps"])
        self.assert_refused(2, "animate", "a.raw", "--type", "f32", "--dims", "12,11,9,1", "--iso", "0.5", "--frames", "3",
                            "-o", "b_%d.vtp", words=["one sample"])
        self.ok("track", "a.raw", "--type", "f32", "--dims", "12,11,9,1", "--time-axis", "2", "--iso", "0.5")


class Seeds(Case):
    def extract(self, *arguments):
        return self.ok("extract", "blobs.nrrd", "--iso", "0.5", "--json", *arguments).json()

    def test_a_seed_or_a_pair_gives_one_component(self):
        self.sample("gaussians", "21,21,21,9", "blobs.nrrd")
        whole = self.extract("--steps", "0:1", "--measure", "-o", "whole.obj")
        self.assertEqual(whole["measure"]["components"], 2)
        self.assertNotIn("samples_visited", whole)
        lines = (self.folder / "whole.obj").read_text().splitlines()
        point = ",".join(next(line for line in lines if line.startswith("v ")).split()[1:])
        one = self.extract("--steps", "0:1", "--measure", "--seed", point)
        self.assertEqual([one["measure"]["components"], one["measure"]["closed"]], [1, True])
        self.assertLess(one["simplices"], whole["simplices"])
        self.assertLess(one["samples_visited"], 21 ** 3 / 2)
        self.assertGreaterEqual(one["cells_visited"], one["active_cells"])
        through_time = self.extract("--seed", point + ",0", "--measure", "-o", "traced.vtu")
        self.assertEqual(through_time["measure"]["bad_facets"], 0)

    def test_a_pair_finds_the_crossing_between(self):
        values = [0.0] * 63
        values[2 * 9 + 2] = values[2 * 9 + 7] = 1.0  # two samples inside
        (self.folder / "two.raw").write_bytes(struct.pack("<63f", *values))
        raw = ["two.raw", "--dims", "9,7", "--type", "f32", "--iso", "0.5", "--json"]
        self.assertEqual(self.ok("extract", *raw).json()["simplices"], 8)
        for seeds in [["0,0:2,2"], ["7.2,2:5,5"], ["0,0:2,2", "1,2"]]:
            options = [word for seed in seeds for word in ["--seed", seed]]
            self.assertEqual(self.ok("extract", *options, *raw).json()["simplices"], 4)
        self.assertEqual(self.ok("extract", *raw, "--seed", "2,1", "--seed", "7,1").json()["simplices"], 8)
        self.assert_refused(2, "extract", *raw, "--seed", "0,0:5,5")
        self.assert_refused(2, "extract", *raw, "--seed", "0,0:2,2:5,5")

    def test_seeds_that_mean_nothing(self):
        self.sample("ball", "9,9,9,5", "blobs.nrrd")
        for bad in ["0,0,0", "0,0,0,0,0", "0,0,0,99", "a,0,0,0", "0,0,0,0:0,0,0,0:0,0,0,0", "", "-1,-1,-1,0",
                    "0,0,0,0.5:0,0,0,0.5"]:
            self.assert_refused(2, "extract", "blobs.nrrd", "--iso", "0.5", "--seed", bad)
        # A cell that one of the surfaces passes: the message says which does not.
        self.sample("ball", "9,9,9", "ball.nrrd")
        self.ok("extract", "ball.nrrd", "--iso", "0.4", "--seed", "0,0,0.7")
        self.assert_refused(2, "extract", "ball.nrrd", "--iso", "0.4,0.9", "--seed", "0,0,0.7", words=["--seed at isovalue 0.9"])


class Interval(Case):
    def interval(self, *arguments):
        return self.ok("interval", *arguments, "--json", "--measure").json()

    def test_volumes_of_adjoining_ranges_add_up(self):
        self.sample("ball", "24,24,24", "ball.nrrd")
        whole = self.interval("ball.nrrd", "--range", "0.3:0.7", "--method", "simplicial", "-o", "shell.vtu")
        self.assertEqual(whole["range"], [0.3, 0.7])
        self.assertEqual(whole["measure"]["bad_facets"], 0)
        self.assertEqual(whole["measure"]["inverted_simplices"], 0)
        parts = self.interval("ball.nrrd", "--range", "0.3,0.5,0.7", "--method", "simplicial")
        self.assertAlmostEqual(parts["measure"]["content"], whole["measure"]["content"], 6)
        self.assertEqual(len(self.interval("ball.nrrd", "--range", "0.3:0.7:5")["levels"]), 5)
        self.assertIn("shell.vtu", self.files())

    def test_a_volume_through_time_cut_at_a_step_is_that_of_the_step(self):
        self.sample("ball", "9,9,9,5", "moving.nrrd")
        through_time = self.interval("moving.nrrd", "--range", "0.3:0.7", "-o", "moving.vtu")
        self.assertEqual(through_time["dimension"], 4)
        self.assertEqual(through_time["content"], through_time["measure"]["content"])
        self.assertEqual(through_time["inverted_simplices"], through_time["measure"]["inverted_simplices"])
        step = self.interval("moving.nrrd", "--range", "0.3:0.7", "--steps", "2:3")
        cut = self.ok("slice", "moving.vtu", "--time", "0.5", "--measure", "--json", "-o", "cut.vtu").json()
        for key in ["vertices", "simplices"]:
            self.assertEqual(cut[key], step[key])
        self.assertEqual(cut["measure"]["euler_characteristic"], step["measure"]["euler_characteristic"])
        self.assertAlmostEqual(cut["measure"]["content"], step["content"], 12)
        for time in ["0", "0.1", "0.5", "1"]:
            where = ["--time", time, "--measure", "--json"]
            from_mesh = self.ok("slice", "moving.vtu", *where).json()
            from_field = self.ok("slice", "moving.nrrd", "--range", "0.3:0.7", *where).json()
            self.assertEqual(from_field["range"], [0.3, 0.7])
            for key in ["vertices", "simplices"]:
                self.assertEqual(from_field[key], from_mesh[key])
            self.assertAlmostEqual(from_field["measure"]["content"], from_mesh["measure"]["content"], 6)
        self.assert_refused(2, "slice", "moving.nrrd", "--range", "0.3:0.7", "--iso", "0.5", "--time", "0.5")
        self.assert_refused(2, "slice", "moving.vtu", "--range", "0.3:0.7", "--time", "0.5")
        between = self.ok("slice", "moving.vtu", "--time", "0.1", "--measure", "--json").json()
        self.assertEqual(between["measure"]["bad_facets"], 0)
        self.assert_refused(2, "interval", "moving.nrrd", "--range", "0.3:0.7", "-o", "moving.ply")

    def test_ranges_that_mean_nothing(self):
        field = self.sample()
        for bad in ["0.7:0.3", "0.5", "0.5:0.5", "0:1:1", "0:1:x", "a:b", "nan:1", "1:2:3:4"]:
            self.assert_refused(2, "interval", field, "--range", bad)


class SlabBySlab(Case):
    """A field larger than --memory is extracted step by step, to the same file."""

    SMALL = ("--memory", "4M")  # the field takes 5 MB, a step 256 KB

    def setUp(self):
        super().setUp()
        self.field = self.sample("torus-morph", "40,40,40,20")

    def assert_same(self, *arguments, suffix=".vtu", memory=SMALL):
        whole = self.ok("extract", *arguments, "--json", "-o", "whole" + suffix).json()
        slabs = self.ok("extract", *arguments, "--json", "-o", "slabs" + suffix, *memory).json()
        for key in ("vertices", "simplices", "active_cells"):
            self.assertEqual(whole[key], slabs[key], key)
        self.assertGreater(slabs["simplices"], 0)
        whole, slabs = ((self.folder / (name + suffix)).read_bytes() for name in ("whole", "slabs"))
        self.assertEqual(whole, slabs)
        (self.folder / ("whole" + suffix)).unlink()
        (self.folder / ("slabs" + suffix)).unlink()

    def test_every_kind_of_input(self):
        self.assert_same(self.field, "--iso", "0.5")
        self.ok("convert", self.field, "-o", "packed.nrrd", "--compress")
        self.assert_same("packed.nrrd", "--iso", "0.5")
        self.ok("convert", self.field, "-o", "plain.npy")
        self.assert_same("plain.npy", "--iso", "0.5", "--method", "simplicial", memory=("--memory", "5M"))
        self.ok("convert", self.field, "-o", "series.pvd")
        self.assert_same("series.pvd", "--iso", "0.5")
        steps = sorted(name for name in self.files() if name.startswith("series_"))
        self.assertEqual(len(steps), 20)
        self.assert_same(*steps, "--iso", "0.5")

    def test_part_of_a_field(self):
        self.assert_same(self.field, "--iso", "0.5", "--crop", "3:,,:38", "--steps", "1:19")
        self.assert_same(self.field, "--iso", "0.5", "--crop", ",20:21", memory=self.beside_the_program(self.field, 100))  # of 125 KiB

    def test_a_volume_goes_along_its_last_axis(self):
        self.ok("sample", "gyroid", "--dims", "64,64,300", "-o", "volume.nrrd")
        for suffix in (".ply", ".stl", ".obj", ".off", ".vtp"):
            self.assert_same("volume.nrrd", "--iso", "0.2", suffix=suffix)

    def test_surface_that_does_not_fit_beside_the_field(self):
        field = self.sample("noise", "20,20,20,20", "noise.nrrd")
        self.assert_same(field, "--iso", "0.5", memory=("--memory", "20M"))

    def test_several_isovalues_and_nothing_written(self):
        surfaces = self.ok("extract", self.field, "--iso", "0.3,0.5", "--json", *self.SMALL).json()["surfaces"]
        whole = self.ok("extract", self.field, "--iso", "0.3,0.5", "--json").json()["surfaces"]
        self.assertEqual([s["simplices"] for s in surfaces], [s["simplices"] for s in whole])
        self.ok("extract", self.field, "--iso", "0.3,0.5", "-o", "a.vtu", *self.SMALL)
        self.assertEqual(self.files(), ["a_iso0.3.vtu", "a_iso0.5.vtu", self.field])

    def test_to_a_pipe(self):
        self.ok("extract", self.field, "--iso", "0.5", "-o", "whole.vtu")
        done = subprocess.run([PROGRAM, "extract", self.field, "--iso", "0.5", "-o", "/dev/stderr", "--format", "vtu",
                               "--quiet", *self.SMALL], capture_output=True, check=True)
        self.assertEqual(done.stderr, (self.folder / "whole.vtu").read_bytes())

    def test_measured_as_a_whole_if_that_fits(self):
        self.ok("convert", self.field, "-o", "packed.nrrd", "--compress")
        measure = self.ok("extract", "packed.nrrd", "--iso", "0.7", "--json", "--measure", "--memory", "8M").json()
        self.assertEqual(measure["measure"],
                         self.ok("extract", self.field, "--iso", "0.7", "--json", "--measure").json()["measure"])
        self.assert_refused(1, "extract", "packed.nrrd", "--iso", "0.1", "--method", "simplicial", "--measure",
                            *self.SMALL, words=["measured as a whole", "--memory"])

    @unittest.skipUnless(HAS_VIEW, "built without the viewer")
    def test_a_page_of_the_same_surface(self):
        for options in ([], ["--max-size", "900K"]):
            whole, slabs = (json.loads(Run("view", self.field, "--iso", "0.7", "-o", "page.html", "--json", "--payload", "mesh",
                                           *options, *memory).out) for memory in ([], ["--memory", "5M"]))
            self.assertEqual((whole["simplices"], whole["notes"]), (slabs["simplices"], slabs["notes"]))

    def test_file_that_ends_too_soon_leaves_nothing(self):
        self.ok("convert", self.field, "-o", "packed.nrrd", "--compress")
        content = (self.folder / "packed.nrrd").read_bytes()
        (self.folder / "packed.nrrd").write_bytes(content[:len(content) * 2 // 3])
        self.assert_refused(2, "extract", "packed.nrrd", "--iso", "0.5", "-o", "out.vtu", *self.SMALL, words=["packed.nrrd"])

    def test_no_room_for_two_steps(self):
        self.assert_refused(1, "extract", self.field, "--iso", "0.5", *self.beside_the_program(self.field, 250),
                            words=["two steps", "--memory"])

    def test_empty_surface_is_warned_about(self):
        run = Run("extract", self.field, "--iso", "7", *self.SMALL)
        self.assertEqual(run.code, 0)
        self.assertRegex(run.err, r"warning: no surface at isovalue 7: the values go from [^\n]+\n\Z")

    def test_advice_names_options_that_the_verb_has(self):
        run = Run("sample", "noise", "--dims", "200,200,200", "-o", "n.nrrd", "--memory", "10M")
        self.assertEqual(run.code, 1)
        self.assertIn("smaller --dims", run.err)
        self.assertNotIn("--crop", run.err)


class Selection(Case):
    def test_crop_and_steps(self):
        field = self.sample("ball", "10,9,8,7")
        found = self.ok("info", field, "--json", "--crop", "2:8,,:4", "--steps", "3:").json()
        self.assertEqual(found["dims"], [6, 9, 4, 4])
        whole = self.ok("info", field, "--json").json()
        self.assertEqual(found["axes"][3]["last"], whole["axes"][3]["last"])
        self.assertAlmostEqual(found["axes"][0]["first"], whole["axes"][0]["first"] + 2 * whole["axes"][0]["spacing"])

    def test_negative_numbers_are_values_not_options(self):
        field = self.sample("gyroid", "12,12,12")
        self.ok("extract", field, "--iso", "-0.5")
        self.ok("extract", field, "--iso=-0.5,-.25,1e-1")
        self.ok("slice", field, "--iso", "-0.5", "--time", "-0.25", "--quiet")
        self.ok("slice", field, "--iso", "0.1", "--axis", "x=-0.25")

    def test_time_axis_becomes_the_last(self):
        field = self.sample("ball", "10,9,8,7")
        self.assertEqual(self.ok("info", field, "--time-axis", "y", "--json").json()["dims"], [10, 8, 7, 9])
        self.assertEqual(self.ok("info", field, "--time-axis", "0", "--json").json()["dims"], [9, 8, 7, 10])

    def test_raw_files_are_described_by_options(self):
        (self.folder / "a.raw").write_bytes(b"head" + struct.pack(">12h", *range(12)))
        found = self.ok("info", "a.raw", "--dims", "4,3", "--type", "i16", "--skip", "4", "--big-endian", "--json").json()
        self.assertEqual((found["dims"], found["range"]), ([4, 3], [0, 11]))

    def test_files_as_steps(self):
        for step in range(3):
            (self.folder / f"{step}.raw").write_bytes(struct.pack("<8f", *range(step, step + 8)))
        found = self.ok("info", "0.raw", "1.raw", "2.raw", "--dims", "2,2,2", "--type", "f32", "--json").json()
        self.assertEqual((found["dims"], found["range"], found["has_time"]), ([2, 2, 2, 3], [0, 9], True))

    def surface(self, path):
        """The points of an .off file and its triangles, each from its lowest corner, in order."""
        lines = (self.folder / path).read_text().split("\n")
        points, triangles = (int(count) for count in lines[1].split()[:2])
        corners = [tuple(map(int, line.split()[1:])) for line in lines[2 + points:2 + points + triangles]]
        return lines[2:2 + points], sorted(c[c.index(min(c)):] + c[:c.index(min(c))] for c in corners)

    # The cut of the mesh and the cut of the field are the same surface; at a step, to the bit.
    def test_slice_of_mesh_and_of_field_agree(self):
        field = self.sample("torus-morph", "16,16,16,9")
        self.ok("extract", field, "--iso", "0.5", "-o", "all.vtu")
        for time_ in ("0", "0.25", "0.3", "2"):
            self.ok("slice", "all.vtu", "--time", time_, "-o", "mesh.off")
            self.ok("slice", field, "--iso", "0.5", "--time", time_, "-o", "field.off")
            counts = [self.ok("measure", path, "--json").json() for path in ("mesh.off", "field.off")]
            self.assertEqual(counts[0]["vertices"], counts[1]["vertices"], time_)
            self.assertEqual(counts[0]["measure"]["euler_characteristic"], counts[1]["measure"]["euler_characteristic"])
            if time_ != "0.3":
                self.assertEqual(self.surface("mesh.off"), self.surface("field.off"), time_)

    def test_series_names_a_file_for_each_time(self):
        field = self.sample("ball", "10,10,10,5")
        self.ok("slice", field, "--iso", "0.5", "--time", "0,0.3,1", "-o", "m.pvd")
        self.assertEqual(self.files(), ["field.nrrd", "m.pvd", "m_0000.vtp", "m_0001.vtp", "m_0002.vtp"])
        series = (self.folder / "m.pvd").read_text()
        self.assertEqual(re.findall(r'timestep="([^"]*)"', series), ["0", "0.3", "1"])
        self.assertEqual(re.findall(r'file="([^"]*)"', series), ["m_0000.vtp", "m_0001.vtp", "m_0002.vtp"])


class World(Case):
    """A field whose file turns and scales its axes: surfaces come in the coordinates of the world."""

    def test_surface_and_slice_are_where_the_file_says(self):
        directions = "(0,2,0) (-2,0,0) (0,0,2) none"  # a quarter turn, twice the size
        size = 13
        samples = []
        for t, z, y, x in itertools.product(range(3), range(size), range(size), range(size)):
            samples.append(4 - math.dist((x, y, z), (5 + t, 6, 6)))
        header = (f"NRRD0004\ntype: float\ndimension: 4\nsizes: {size} {size} {size} 3\nspace dimension: 3\n"
                  f"space directions: {directions}\nspace origin: (100,200,300)\nkinds: domain domain domain time\n"
                  "spacings: nan nan nan 0.5\naxis mins: nan nan nan 7\n"
                  "endian: little\nencoding: raw\n\n")
        (self.folder / "turned.nrrd").write_bytes(header.encode() + struct.pack(f"<{len(samples)}f", *samples))
        self.ok("extract", "turned.nrrd", "--iso", "0", "-o", "all.vtu")
        for source in (["turned.nrrd", "--iso", "0"], ["all.vtu"]):
            for step in range(3):
                run = self.ok("slice", *source, "--time", 7 + step * 0.5, "--measure", "--json", "-o", "cut.off").json()
                self.assertEqual(run["measure"]["euler_characteristic"], 2)
                self.assertAlmostEqual(run["measure"]["content"], 4 * math.pi * 64, delta=20)
                points = [list(map(float, line.split())) for line in self.surface_points("cut.off")]
                centre = [(min(column) + max(column)) / 2 for column in zip(*points)]
                for found, expected in zip(centre, (100 - 2 * 6, 200 + 2 * (5 + step), 300 + 2 * 6)):
                    self.assertAlmostEqual(found, expected, places=3)

    # Time in a space of four dimensions, with an offset of its own; and planes across axes of the world.
    def test_time_and_planes_mean_the_same_for_field_and_mesh(self):
        size, samples = 9, []
        for t, z, y, x in itertools.product(range(3), range(size), range(size), range(size)):
            samples.append(3 - math.dist((x, y, z), (3 + t, 4, 4)))
        (self.folder / "turned.nrrd").write_bytes(
            (f"NRRD0005\ntype: float\ndimension: 4\nsizes: {size} {size} {size} 3\nspace: scanner-xyz-time\n"
             "space directions: (1,1,0,0) (-1,1,0,0) (0,0,2,0) (0,0,0,0.5)\nspace origin: (100,200,300,7)\n"
             "endian: little\nencoding: raw\n\n").encode() + struct.pack(f"<{len(samples)}f", *samples))
        self.ok("extract", "turned.nrrd", "--iso", "0", "-o", "all.vtu", "--precision", "f64")
        for plane in (["--time", "7.25"], ["--time", "7.5"], ["--plane", "1,0,0,0.5,103.9"], ["--plane", "0,0,1,0,308"],
                      ["--plane", "1,1,0,0,308.7"], ["--axis", "0=100"]):
            cuts = [self.ok("slice", *source, *plane, "--json", "--measure", "--precision", "f64", "-o", "cut.off").json()
                    for source in (["turned.nrrd", "--iso", "0"], ["all.vtu"])]
            self.assertGreater(cuts[0]["simplices"], 50)
            for key in ("vertices", "simplices", "hyperplane", "frame"):
                self.assertEqual(cuts[0][key], cuts[1][key], plane)
            for key in ("content", "boundary_facets", "euler_characteristic"):
                self.assertAlmostEqual(cuts[0]["measure"][key], cuts[1]["measure"][key], places=6, msg=plane)
        self.assert_refused(2, "slice", "turned.nrrd", "--iso", "0", "--time", "0.5", words=["7", "8"])

    @unittest.skipUnless(HAS_VIEW, "built without the viewer")
    def test_events_of_a_page_are_there_too(self):
        samples = []
        for t, z, y, x in itertools.product(range(6), range(9), range(9), range(17)):  # two balls meet at x = 8
            samples.append(max(3 - math.dist((x, y, z), (3 + t, 4, 4)), 3 - math.dist((x, y, z), (13 - t, 4, 4))))
        header = ("NRRD0004\ntype: float\ndimension: 4\nsizes: 17 9 9 6\nspace dimension: 3\n"
                  "space directions: (0,2,0) (-2,0,0) (0,0,2) none\nspace origin: (100,200,300)\n"
                  "kinds: domain domain domain time\nspacings: nan nan nan 0.5\nendian: little\nencoding: raw\n\n")
        (self.folder / "meet.nrrd").write_bytes(header.encode() + struct.pack(f"<{len(samples)}f", *samples))
        self.ok("view", "meet.nrrd", "--iso", "0.5", "--track", "-o", "meet.html")
        text = (self.folder / "meet.html").read_text()
        page = json.loads(re.search(r'id="hyperiso-metadata">(.*?)</script>', text)[1])
        merge, = [event for event in page["tracking"]["events"] if event["type"] == "merge"]
        self.assertEqual([axis["samples"] for axis in page["axes"]], [0, 0, 9, 6])  # x and y are mixed
        for found, expected in zip(merge["position"], (100 - 2 * 4, 200 + 2 * 8, 300 + 2 * 4)):
            self.assertAlmostEqual(found, expected, delta=1.5)

    def surface_points(self, path):
        lines = (self.folder / path).read_text().split("\n")
        return lines[2:2 + int(lines[1].split()[0])]


if __name__ == "__main__":
    unittest.main()
