"""The contract of the program: what scripts and people may rely on.

    test_cli.py PROGRAM
"""

import ast
import gzip
import itertools
import json
import math
import os
import pty
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import zipfile
from pathlib import Path

PROGRAM = Path(sys.argv.pop(1)).resolve() if len(sys.argv) > 1 else Path("build/release/bin/hyperiso").resolve()
ROOT = Path(__file__).resolve().parent.parent
WATER = "examples/data/alpha_water_24x24x24x41.nrrd"
FOLDING = "examples/data/folding_cell_2x2x2x2x2.nrrd"  # a surface that passes through itself
VERBS = ["info", "extract", "interval", "slice", "animate", "morph", "track", "measure", "table", "sample", "convert"]

HAS_VIEW = b"\n  view " in subprocess.run([PROGRAM, "--help"], capture_output=True, check=True).stdout
if HAS_VIEW:
    VERBS.append("view")

# Films need Embree and cairo in the build and ffmpeg on PATH; the film below has no frames' worth of work.
def draws(name):
    with tempfile.TemporaryDirectory() as folder:
        field = os.path.join(folder, "field.nrrd")
        subprocess.run([PROGRAM, "sample", "ball", "--dims", "4,4,4,2", "-o", field], check=True, capture_output=True)
        run = subprocess.run([PROGRAM, "animate", field, "--iso", "0.5", "--frames", "1", "--size", "64x64", "-o",
                              os.path.join(folder, name)], capture_output=True, check=False)
        return run.returncode == 0

HAS_PICTURES, HAS_FILMS = draws("%d.png"), draws("film.mp4")

EXTRACT_KEYS = ["dimension", "dims", "isovalue", "method", "inside", "vertices", "simplices", "active_cells", "seconds",
                "peak_memory_bytes"]
MEASURE_KEYS = ["components", "euler_characteristic", "boundary_facets", "bad_facets", "closed", "content", "vector_area",
                "zero_content_simplices"]


class Run:
    def __init__(self, *arguments, **options):
        done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, check=False, timeout=120, **options)
        self.code, self.out, self.err = done.returncode, done.stdout.decode(), done.stderr.decode()

    def json(self):
        return json.loads(self.out)


class Case(unittest.TestCase):
    """Each test in an empty folder of its own, with the examples where the manual has them."""

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="hyperiso-cli-"))
        self.addCleanup(shutil.rmtree, self.folder)
        (self.folder / "examples").symlink_to(ROOT / "examples")
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder)

    def files(self):
        return sorted(path.name for path in self.folder.iterdir() if path.name != "examples")

    def ok(self, *arguments, **options):
        run = Run(*arguments, **options)
        self.assertEqual((run.code, run.err), (0, ""), arguments)
        return run

    def assert_refused(self, code, *arguments, words=(), **options):
        """One line of error, nothing on standard output, and the folder as it was."""
        before = {name: (self.folder / name).read_bytes() for name in self.files() if (self.folder / name).is_file()}
        run = Run(*arguments, **options)
        self.assertEqual(run.code, code, (arguments, run.err))
        self.assertRegex(run.err, r"\Ahyperiso: error: [^\n]+\n\Z", arguments)
        self.assertEqual(run.out, "", arguments)
        for word in words:
            self.assertIn(word, run.err, arguments)
        after = {name: (self.folder / name).read_bytes() for name in self.files() if (self.folder / name).is_file()}
        self.assertEqual(after, before, arguments)

    def sample(self, name="ball", dims="12,12,12", path="field.nrrd", *options):
        self.ok("sample", name, "--dims", dims, "-o", path, *options)
        return path


class Json(Case):
    def test_extract_has_exactly_these_keys(self):
        path = self.sample("torus-morph", "16,15,14,7")
        found = self.ok("extract", path, "--iso", "0.5", "--json").json()
        self.assertEqual(list(found), EXTRACT_KEYS)
        self.assertEqual(list(found["seconds"]), ["read", "extract", "write"])
        self.assertEqual((found["dimension"], found["dims"], found["isovalue"]), (4, [16, 15, 14, 7], 0.5))
        self.assertEqual((found["method"], found["inside"]), ("hull", "above"))
        for key in ("vertices", "simplices", "active_cells", "peak_memory_bytes"):
            self.assertIsInstance(found[key], int)
            self.assertGreater(found[key], 0)

    def test_repetitions_change_nothing_but_the_time(self):
        path = self.sample()
        once, often = (self.ok("extract", path, "--iso", "0.4,0.5", "--repeat", times, "--json", "-o", times + ".ply")
                       for times in ("1", "4"))
        for a, b in zip(once.json()["surfaces"], often.json()["surfaces"]):
            self.assertEqual(list(a), EXTRACT_KEYS)
            for key in ("vertices", "simplices", "active_cells", "isovalue"):
                self.assertEqual(a[key], b[key])
        for iso in ("0.4", "0.5"):
            self.assertEqual(*((self.folder / f"{times}_iso{iso}.ply").read_bytes() for times in ("1", "4")))
        for wrong in ("0", "-1", "many", "1.5"):
            self.assert_refused(2, "extract", path, "--iso", "0.5", "--repeat", wrong, words=["--repeat"])
        before = self.files()
        self.ok("extract", path, "--iso", "0.5", "--repeat", "3")
        self.assertEqual(self.files(), before)

    def test_measure_has_exactly_these_keys(self):
        path = self.sample()
        found = self.ok("extract", path, "--iso", "0.5", "--json", "--measure").json()
        self.assertEqual(list(found), EXTRACT_KEYS + ["measure"])
        measure = found["measure"]
        self.assertEqual(list(measure), MEASURE_KEYS)
        self.assertEqual((measure["components"], measure["euler_characteristic"], measure["bad_facets"]), (1, 2, 0))
        self.assertIs(measure["closed"], True)
        self.assertEqual(len(measure["vector_area"]), 3)
        self.assertAlmostEqual(measure["content"], 3.14, delta=0.3)

    def test_methods_and_self_intersections(self):
        path = self.sample("noise", "3,3,3,2,2")
        sizes = {}
        for method in ("hull", "component", "simplicial", "barycentric"):
            found = self.ok("extract", path, "--iso", "0.5", "--method", method, "--json").json()
            self.assertEqual(found["method"], method)
            sizes[method] = found["simplices"]
        staircase = self.ok("extract", path, "--iso", "0.5", "--method", "barycentric", "--cut", "staircase", "--json")
        self.assertLess(staircase.json()["simplices"], sizes["barycentric"])
        self.sample("ball", path="ball.nrrd")
        run = ("ball.nrrd", "--iso", "0.5", "-o", "ball.ply", "--self-intersections", "--json")
        self.assertEqual(self.ok("extract", *run).json()["self_intersections"], {"pairs": 0, "examples": []})
        found = self.ok("measure", "ball.ply", "--self-intersections", "--json").json()
        self.assertEqual(found["self_intersections"], {"pairs": 0, "examples": []})
        self.ok("extract", FOLDING, "--iso", "0", "-o", "folding.vtu")
        found = self.ok("measure", "folding.vtu", "--self-intersections", "--json").json()
        self.assertEqual(found["self_intersections"]["pairs"], 51)

    def test_several_isovalues_are_surfaces(self):
        path = self.sample()
        found = self.ok("extract", path, "--iso", "0.4,0.5", "--json", "-o", "s.ply").json()
        self.assertEqual(list(found), ["surfaces"])
        self.assertEqual([surface["isovalue"] for surface in found["surfaces"]], [0.4, 0.5])
        self.assertEqual(list(found["surfaces"][0]), EXTRACT_KEYS)
        self.assertEqual(self.files(), ["field.nrrd", "s_iso0.4.ply", "s_iso0.5.ply"])

    def test_slice(self):
        path = self.sample("ball", "16,16,16,9")
        found = self.ok("slice", path, "--iso", "0.5", "--time", "0.3", "--json", "--measure").json()
        self.assertEqual(found["hyperplane"], {"normal": [0, 0, 0, 1], "offset": 0.3})
        self.assertEqual(list(found["measure"]), MEASURE_KEYS)
        self.assertEqual((found["measure"]["euler_characteristic"], found["measure"]["closed"]), (2, True))
        self.assertGreater(found["simplices"], found["vertices"])

    def test_table(self):
        for dimension, entries, simplices, most in ((2, 16, 16, 2), (3, 256, 836, 6), (4, 65536, 856960, 26)):
            found = self.ok("table", dimension, "--json").json()
            self.assertEqual(list(found), ["dimension", "entries", "simplices", "max", "mean", "seconds"])
            self.assertEqual([found[key] for key in ("dimension", "entries", "simplices", "max")],
                             [dimension, entries, simplices, most])
            self.assertEqual(found["mean"], simplices / entries)

    def test_info(self):
        found = self.ok("info", WATER, "--json").json()
        self.assertEqual((found["dimension"], found["dims"], found["type"]), (4, [24, 24, 24, 41], "f32"))
        self.assertEqual([axis["name"] for axis in found["axes"]], ["x", "y", "z", "t"])
        self.assertEqual((found["axes"][3]["first"], found["axes"][3]["last"]), (0, 1))
        self.assertEqual((found["missing"], found["range"][1]), (0, 1))
        self.assertIn(0.5, found["suggested_isovalues"])
        self.assertEqual(found["bytes"], 24 ** 3 * 41 * 4)

    def test_measure_verb(self):
        self.ok("extract", self.sample(), "--iso", "0.5", "-o", "ball.ply")
        found = self.ok("measure", "ball.ply", "--json").json()
        self.assertEqual(list(found["measure"]), MEASURE_KEYS)
        self.assertEqual((found["dimension"], found["simplex_dimension"]), (3, 2))
        self.assertEqual(found["measure"]["euler_characteristic"], 2)

    def test_sample_and_convert(self):
        found = self.ok("sample", "noise", "--dims", "4,5", "--type", "u8", "-o", "n.nrrd", "--json").json()
        self.assertEqual((found["dims"], found["type"], found["isovalue"]), ([4, 5], "u8", 127.5))
        found = self.ok("convert", "n.nrrd", "--to", "f64", "-o", "n.npy", "--json").json()
        self.assertEqual((found["dims"], found["type"]), ([4, 5], "f64"))
        self.assertEqual(self.ok("info", "n.npy", "--json").json()["type"], "f64")


class Table(Case):
    def test_counts_are_one_number_a_line_and_nothing_else(self):
        for dimension, entries, simplices in ((2, 16, 16), (3, 256, 836), (4, 65536, 856960)):
            printed = self.ok("table", dimension, "--counts").out
            self.assertRegex(printed, r"\A(\d+\n)+\Z")
            counts = list(map(int, printed.split()))
            self.assertEqual((len(counts), sum(counts)), (entries, simplices))
            self.assertEqual((counts[0], counts[-1]), (0, 0))

    def test_entry_in_every_notation(self):
        printed = {self.ok("table", 3, "--entry", labels).out for labels in ("24", "0x18", "0X18", "0b11000")}
        self.assertEqual(len(printed), 1)
        self.assertIn("6 triangles", printed.pop())

    def test_verify(self):
        for dimension in (2, 3):
            run = self.ok("table", dimension, "--verify")
            self.assertNotIn("FAILED", run.out)
            found = self.ok("table", dimension, "--verify", "--json").json()["verification"]
            self.assertEqual(found["facet_checks"], 2 * dimension * 2 ** 2 ** dimension)
            self.assertEqual([value for key, value in found.items() if re.search("failures|mismatches|intersections", key)],
                             [0] * 6)


class WrongUsage(Case):
    def test_one_line_and_exit_code_2(self):
        field = self.sample()
        for arguments in (
                ["cut"], ["extract"], ["--foo"], ["extract", field], ["extract", field, "--iso"],
                ["extract", field, "--iso", "1", "--foo"], ["extract", field, "--iso", "1", "--foo", "2"],
                ["extract", field, "--iso", "0.5", "--iso", "0.6"], ["extract", field, "--iso", "0.5,0.5"],
                ["extract", field, "--iso", "0.5", "--method", "cubes"], ["extract", field, "--iso", "0.5", "--inside", "out"],
                ["extract", field, "--iso", "0.5", "--method", "cubes"],
                ["extract", field, "--iso", "0.5", "--precision", "f16"],
                ["extract", field, "--iso", "0.5", "--threads", "0"], ["extract", field, "--iso", "0.5", "--threads", "two"],
                ["extract", field, "--iso", "0.5", "--memory", "much"], ["extract", field, "--iso", "0.5", "--memory", "-1"],
                ["extract", field, "--iso", "0.5", "--crop", "0:13"], ["extract", field, "--iso", "0.5", "--crop", "5:5"],
                ["extract", field, "--iso", "0.5", "--crop", "a:b"], ["extract", field, "--iso", "0.5", "--crop", ",,,0:2"],
                ["extract", field, "--iso", "0.5", "--crop", ",,0:5", "--steps", "0:5"],
                ["extract", field, "--iso", "0.5", "--steps", "5"],
                ["extract", field, "--iso", "0.5", "--time-axis", "w"], ["extract", field, "--iso", "0.5", "--time-axis", "7"],
                ["slice", field, "--iso", "0.5"], ["slice", field, "--time", "0"],
                ["slice", field, "--iso", "0.5", "--plane", "1,0,0"], ["slice", field, "--iso", "0.5", "--plane", "0,0,0,0"],
                ["slice", field, "--iso", "0.5", "--time", "0:1"], ["slice", field, "--iso", "0.5", "--time", "0:1:-1"],
                ["slice", field, "--iso", "0.5", "--time", "0:1:0"], ["slice", field, "--iso", "0.5", "--times", "0:1e9:1"],
                ["slice", field, "--iso", "0.5", "--time", "0", "--frame", "world"],
                ["slice", field, "--iso", "0.5", "--time", "0,0", "-o", "s.vtp"],
                ["slice", field, "--iso", "0.5", "--time", "0", "-o", "s_%s.vtp"],
                ["slice", field, "--iso", "0.5", "--time", "0", "-o", "s_%d_%d.vtp"],
                ["slice", field, "--iso", "0.5", "--time", "0", "--axis", "x=0", "-o", "s.pvd"],
                ["slice", field, "--iso", "0.5", "--time", "0", "--with", "nothing"],
                ["slice", field, "--iso", "0.5", "--time", "0", "--colour-range", "0:1"],
                ["slice", field, "--iso", "0.5", "--time", "0", "--normals", "--with", "normal=" + field],
                ["extract", field, "--iso", "0.5", "--normals", "-o", "s.stl"],
                ["extract", field, "--iso", "0.5", "--colour-by", "normal", "--normals", "-o", "s.ply"],
                ["extract", field, "--iso", "0.5", "--colour-by", "v", "-o", "s.vtu"],
                ["extract", field, "--iso", "0.5", "--method", "barycentric", "--normals"],
                ["slice", field, "--iso", "0.5", "--axis", "w=0"], ["slice", field, "--iso", "0.5", "--axis", "x"],
                ["slice", field, "--iso", "0.5", "--time", "5"], ["slice", field, "--iso", "0.5", "--time", "nan"],
                ["slice", field, "--iso", "0.4,0.5", "--time", "0", "-o", "s.pvd"],
                ["measure"], ["measure", field], ["measure", "nothing.ply"],
                ["table"], ["table", "5"], ["table", "1"], ["table", "three"], ["table", "3", "--entry", "256"],
                ["table", "3", "--entry", "0x"], ["table", "3", "--entry", "-1"], ["table", "3", "--counts", "--verify"],
                ["sample"], ["sample", "cube", "-o", "a.nrrd"], ["sample", "ball"],
                ["sample", "ball", "--dims", "5", "-o", "a.nrrd"], ["sample", "ball", "--dims", "4,x", "-o", "a.nrrd"],
                ["sample", "ball", "--dims", "4,0", "-o", "a.nrrd"], ["sample", "ball", "--dims", "4,-4", "-o", "a.nrrd"],
                ["sample", "ball", "--dims", "4,4", "--type", "f16", "-o", "a.nrrd"],
                ["sample", "ball", "--dims", "2,2,2,2,2,2,2,2,2", "-o", "a.nrrd"],
                ["sample", "gaussians", "--dims", "4,4", "--blobs", "0", "-o", "a.nrrd"],
                ["convert", field], ["convert", field, "-o", "a.txt"], ["convert", field, "--to", "f16", "-o", "a.npy"],
                ["convert", field, "--rescale", "0", "-o", "a.npy"], ["convert", field, "--rescale", "1:1", "-o", "a.npy"],
                ["info", field, "--dims", "4,4"],
                ["convert", field, "--type", "u8", "-o", "a.npy"]):
            self.assert_refused(2, *arguments)

    def test_isovalue_that_is_no_number_writes_nothing(self):
        field = self.sample()
        for isovalue in ("abc", "nan", "NaN", "-nan", "inf", "-inf", "", "0.5,", ",", "1e999", "0.5x", "0,5;", "0x10", " 1"):
            self.assert_refused(2, "extract", field, "--iso=" + isovalue if isovalue else "--iso=,", "-o", "a.ply")

    def test_no_arguments_give_short_help(self):
        run = Run()
        self.assertEqual((run.code, run.out), (2, ""))
        self.assertIn("hyperiso --help", run.err)

    def test_unknown_verb_is_answered_with_the_verbs(self):
        self.assert_refused(2, "extrakt", words=["extrakt", *VERBS])

    def test_format_that_cannot_hold_the_result_is_told_before_the_work(self):
        field = self.sample("ball", "6,6,6,6")
        self.assert_refused(2, "extract", field, "--iso", "0.5", "-o", "a.ply", words=["a.ply", "vtu"])
        self.assert_refused(2, "extract", field, "--iso", "0.5", "-o", "a.xyz", words=["a.xyz"])
        self.assert_refused(2, "extract", field, "--iso", "0.5", "-o", "a.vtu", "--format", "doc")

    def test_dimension_says_what_is_supported(self):
        self.sample("ball", "4,4,4,4,4", "five.nrrd")
        self.sample("ball", "4,4", "two.nrrd")
        self.sample("ball", "2,2,2,2,2,2,2", "seven.nrrd")
        self.assert_refused(2, "extract", "seven.nrrd", "--iso", "0.5", words=["7", "simplicial in up to 8"])
        self.assert_refused(2, "slice", "five.nrrd", "--iso", "0.5", "--time", "0", words=["5", "3 to 4"])
        self.assert_refused(2, "slice", "two.nrrd", "--iso", "0.5", "--time", "0", words=["2", "3 to 4"])

    def test_axis_of_one_sample_is_named(self):
        self.sample("ball", "5,1,1", "thin.nrrd")
        self.assert_refused(2, "extract", "thin.nrrd", "--iso", "0.5", words=["axis y", "5 x 1"])
        self.assert_refused(2, "slice", self.sample(), "--iso", "0.5", "--time", "0", "--crop", ",3:4",
                            words=["axis y"])


class SliceOfAMesh(Case):
    def test_times_are_not_negative_and_a_cut_beside_the_data_is_refused(self):
        self.sample("ball", "9,9,9,5", "moving.nrrd")
        self.ok("extract", "moving.nrrd", "--iso", "0.5", "-o", "moving.vtu")
        cut = self.ok("slice", "moving.vtu", "--time", "0.5", "--json").json()
        for part in cut["seconds"].values():
            self.assertGreaterEqual(part, 0)
        for source in (["moving.vtu"], ["moving.nrrd", "--iso", "0.5"]):
            self.assert_refused(2, "slice", *source, "--time", "99", "-o", "x.vtp", words=["99", "axis t"])


class Morph(Case):
    """Moving pieces; .npz is read back by zipfile and struct, without NumPy."""

    def arrays(self, path):
        arrays, types = {}, {"<f4": "<f", "<f8": "<d", "<u8": "<Q"}
        with zipfile.ZipFile(path) as archive:
            self.assertIsNone(archive.testzip())
            for name in archive.namelist():
                content = archive.read(name)
                self.assertEqual(content[:8], b"\x93NUMPY\x01\x00")
                start = 10 + struct.unpack("<H", content[8:10])[0]
                self.assertEqual(start % 64, 0)
                header = ast.literal_eval(content[10:start].decode())
                numbers = [number for number, in struct.iter_unpack(types[header["descr"]], content[start:])]
                self.assertEqual(len(numbers), math.prod(header["shape"]))
                arrays[name.removesuffix(".npy")] = (header["shape"], numbers)
        return arrays

    def test_pieces_at_a_time_have_the_area_of_the_slice(self):
        self.sample("torus-morph", "12,12,12,5", "torus.nrrd")
        pieces = self.ok("morph", "torus.nrrd", "--iso", "0.5", "--precision", "f64", "-o", "pieces.npz", "--json").json()
        arrays = self.arrays("pieces.npz")
        count = pieces["pieces"]
        self.assertEqual({name: shape for name, (shape, _) in arrays.items()},
                         {"start": (count, 3, 3), "end": (count, 3, 3), "start_time": (count,), "end_time": (count,),
                          "simplex": (count,)})
        start, end, first, last = (arrays[name][1] for name in ["start", "end", "start_time", "end_time"])
        cut = self.ok("slice", "torus.nrrd", "--iso", "0.5", "--precision", "f64", "--time", "0.4", "--measure",
                      "--json").json()
        area = 0
        for piece in range(count):
            if first[piece] < 0.4 <= last[piece]:
                share = (0.4 - first[piece]) / (last[piece] - first[piece])
                a, b, c = ([start[9 * piece + 3 * corner + k] * (1 - share) + end[9 * piece + 3 * corner + k] * share
                            for k in range(3)] for corner in range(3))
                u, v = [q - p for p, q in zip(a, b)], [q - p for p, q in zip(a, c)]
                area += math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2
        self.assertAlmostEqual(area, cut["measure"]["content"], places=9)

    def test_a_mesh_gives_the_pieces_of_its_field(self):
        self.sample("ball", "9,9,9,5", "ball.nrrd")
        self.ok("extract", "ball.nrrd", "--iso", "0.5", "-o", "ball.vtu")
        self.ok("morph", "ball.nrrd", "--iso", "0.5", "-o", "field.npz")
        self.ok("morph", "ball.vtu", "-o", "mesh.npz")
        self.assertEqual((self.folder / "field.npz").read_bytes(), (self.folder / "mesh.npz").read_bytes())
        count = self.ok("morph", "ball.vtu", "-o", "mesh.vtu", "--json").json()["pieces"]
        self.assertEqual(self.ok("measure", "mesh.vtu", "--json").json()["simplices"], count)

    def test_two_dimensions_through_time_give_segments(self):
        self.sample("ball", "9,9,5", "disc.nrrd")
        self.ok("morph", "disc.nrrd", "--iso", "0.5", "-o", "disc.npz")
        self.assertEqual(self.arrays("disc.npz")["start"][0][1:], (2, 2))

    def test_wrong_usage(self):
        self.sample("ball", "9,9,9,5", "ball.nrrd")
        self.sample("ball", "9,9", "flat.nrrd")
        self.sample("ball", "5,5,5,5,5", "five.nrrd")
        self.ok("interval", "ball.nrrd", "--steps", "0:1", "--range", "0:0.5", "-o", "volume.vtu")
        for arguments, words in [(["ball.nrrd"], ["--iso"]), (["ball.nrrd", "--iso", "0.1,0.2"], ["--iso", "one"]),
                                 (["ball.nrrd", "--iso", "0.5", "-o", "x.stpl"], ["x.stpl", "npz"]),
                                 (["flat.nrrd", "--iso", "0.5"], ["2 dimensions"]),
                                 (["five.nrrd", "--iso", "0.5"], ["5 dimensions"]),
                                 (["volume.vtu"], ["volume.vtu", "tetrahedra in 3"])]:
            self.assert_refused(2, "morph", *arguments, words=words)
        self.assert_refused(1, "morph", "ball.nrrd", "--iso", "0.5", "-o", "missing/x.npz", words=["missing/x.npz"])


class FlatAxes(Case):
    def test_one_step_of_a_volume_is_a_volume(self):
        self.sample("ball", "9,9,9,5", "moving.nrrd")
        step = self.ok("extract", "moving.nrrd", "--iso", "0.5", "--steps", "2:3", "--json").json()
        self.assertEqual(step["dims"], [9, 9, 9])
        self.assertGreater(step["simplices"], 0)


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


class Tracking(Case):
    def test_regions_are_told_from_surfaces(self):
        path = self.sample("gaussians", "12,12,12,9")
        found = self.ok("track", path, "--iso", "0.5", "--track", "region", "-o", "tracks", "--json").json()
        self.assertEqual([event["type"] for event in found["events"]], ["open_start", "open_start", "merge", "open_end"])
        series = (self.folder / "tracks" / "tracks.pvd").read_text()
        self.assertIn("region_0000.vtu", series)
        shell = self.ok("track", path, "--range", "0.3:0.6", "--json", "--overlap-volumes", "exact").json()
        self.assertEqual(shell["steps"], 9)

    def test_a_track_of_an_earlier_run_is_followed(self):
        path = self.sample("gaussians", "16,16,16,9")
        run = ("track", path, "--iso", "0.5")
        whole = self.ok(*run, "-o", "all", "--json").json()
        for track in whole["tracks"]:
            found = self.ok(*run, "--select", f"all:{track['id']}", "--json").json()
            times = {(event["type"], event["time"]) for event in found["events"]}
            self.assertIn((track["start_type"], track["start_time"]), times)
        self.assert_refused(2, *run, "--select", "all", words=["FOLDER:ID"])
        self.assert_refused(2, *run, "--select", "all:99", words=["99"])
        self.assert_refused(2, *run, "--select", "none:0", words=["none/tracks.csv"])
        self.assert_refused(2, *run, "--select", "all:0", "--track", "region", words=["surfaces"])

    def test_other_fields_are_columns(self):
        path = self.sample("gaussians", "12,12,12,5")
        self.ok("track", path, "--iso", "0.5", "--with", f"again={path}", "-o", "all")
        table = (self.folder / "all" / "features.csv").read_text().splitlines()
        self.assertTrue(table[0].endswith(",again_mass,again_min,again_max"), table[0])
        row = dict(zip(table[0].split(","), table[1].split(",")))
        self.assertAlmostEqual(float(row["again_mass"]), float(row["mass"]), places=9)
        self.assertEqual(row["again_max"], row["max"])

    def test_what_is_tracked_is_said_once(self):
        path = self.sample("gaussians", "8,8,8,3")
        for options, word in [
            (["--iso", "0.5", "--range", "0.3:0.6"], "--range"),
            ([], "--iso"),
            (["--range", "0.3:0.6", "--track", "surface"], "--track"),
            (["--range", "0.3"], "A:B"),
            (["--iso", "0.5", "--track", "volume"], "region"),
            (["--iso", "0.5", "--overlap-volumes", "all"], "exact"),
        ]:
            self.assert_refused(2, "track", path, *options, words=[word])
        self.assert_refused(2, "track", path, "--range", "0.6:0.3", words=["0.6"])


class UnusableInput(Case):
    def write(self, name, content):
        (self.folder / name).write_bytes(content)
        return name

    def nrrd(self, name, sizes, data, encoding="raw"):
        header = (f"NRRD0004\ntype: float\ndimension: {len(sizes)}\nsizes: {' '.join(map(str, sizes))}\n"
                  f"endian: little\nencoding: {encoding}\n\n")
        return self.write(name, header.encode() + data)

    def test_every_reader_refuses_it(self):
        samples = struct.pack("<27f", *range(27))
        good_gzip = gzip.compress(samples)
        for name, arguments in (
                ("missing", ["missing.nrrd"]), ("missing raw", ["missing.raw", "--dims", "3,3,3", "--type", "f32"]),
                ("folder", ["."]), ("empty", [self.write("empty.nrrd", b"")]), ("empty vti", [self.write("empty.vti", b"")]),
                ("empty npy", [self.write("empty.npy", b"")]), ("text", [self.write("text.nrrd", b"hello\n")]),
                ("truncated", [self.nrrd("short.nrrd", [3, 3, 3], samples[:-1])]),
                ("wrong sizes", [self.nrrd("sizes.nrrd", [3, 3, 4], samples)]),
                ("no sizes", [self.nrrd("none.nrrd", [], samples)]),
                ("zero size", [self.nrrd("zero.nrrd", [3, 0, 3], samples)]),
                ("negative size", [self.nrrd("negative.nrrd", [3, -3, 3], samples)]),
                ("overflow", [self.nrrd("overflow.nrrd", [2 ** 31, 2 ** 31, 2 ** 31], samples)]),
                ("overflow to 0", [self.nrrd("wrap.nrrd", [2 ** 32, 2 ** 32], samples)]),
                ("huge size", [self.nrrd("huge.nrrd", [3, 10 ** 30], samples)]),
                ("no gzip", [self.nrrd("no.nrrd", [3, 3, 3], samples, "gzip")]),
                ("bad gzip", [self.nrrd("bad.nrrd", [3, 3, 3], good_gzip[:20] + b"\xff" * 9 + good_gzip[29:], "gzip")]),
                ("short gzip", [self.nrrd("cut.nrrd", [3, 3, 3], good_gzip[:-12], "gzip")]),
                ("raw without dims", [self.write("some.raw", samples)]),
                ("raw without type", ["some.raw", "--dims", "3,3,3"]),
                ("raw too short", ["some.raw", "--dims", "3,3,4", "--type", "f32"]),
                ("raw skip", ["some.raw", "--dims", "3,3,3", "--type", "f32", "--skip", "4"]),
                ("raw overflow", ["some.raw", "--dims", "4294967296,4294967296,4294967296", "--type", "f64"]),
                ("suffix", [self.write("some.xyz", samples)]),
                ("steps that differ", [self.nrrd("a.nrrd", [3, 3, 3], samples), self.nrrd("b.nrrd", [3, 9], samples)])):
            with self.subTest(name):
                for verb in (["info"], ["extract", "--iso", "1", "-o", "out.vtu"], ["convert", "-o", "out.npy"],
                             ["slice", "--iso", "1", "--time", "1", "-o", "out.ply"]):
                    self.assert_refused(2, *verb, *arguments)

    def test_meshes(self):
        for path in (self.write("empty.ply", b""), self.write("empty.vtu", b""), self.write("text.stl", b"solid"),
                     self.write("none.off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n"), "missing.vtp"):
            self.assert_refused(2, "measure", path)
            self.assert_refused(2, "slice", path, "--time", "0", "-o", "out.vtp")

    def test_names_with_line_breaks_stay_one_line(self):
        self.assert_refused(2, "info", "no\nsuch\x1b[31mfile.nrrd")


class Output(Case):
    def test_failure_leaves_what_was_there(self):
        for name in ("out.vtu", "out.npy", "out_iso0.5.vtu"):
            (self.folder / name).write_text("keep me")
        (self.folder / "bad.nrrd").write_bytes(b"NRRD0004\ntype: float\ndimension: 3\nsizes: 3 3 3\nendian: little\nencoding: raw\n\nshort")
        self.assert_refused(2, "extract", "bad.nrrd", "--iso", "1", "-o", "out.vtu")
        self.assert_refused(2, "extract", self.sample(), "--iso", "nan", "-o", "out.vtu")
        self.assert_refused(2, "convert", "bad.nrrd", "-o", "out.npy")

    def test_unwritable_output_is_exit_code_1(self):
        field = self.sample()
        (self.folder / "folder.ply").mkdir()
        for path in ("no/such/folder/a.ply", "folder.ply", "/proc/a.ply", f"{field}/a.ply"):
            self.assert_refused(1, "extract", field, "--iso", "0.5", "-o", path)
        for path in ("no/such/folder/a.npy", f"{field}/a.npy"):
            self.assert_refused(1, "convert", field, "-o", path)
            self.assert_refused(1, "sample", "ball", "--dims", "4,4", "-o", path)

    # The second file cannot be written: the first must not appear either.
    def test_several_files_appear_together_or_not_at_all(self):
        field = self.sample()
        (self.folder / "s_iso0.5.ply").mkdir()
        self.assert_refused(1, "extract", field, "--iso", "0.4,0.5", "-o", "s.ply")
        (self.folder / "m_0001.vtp").mkdir()
        self.assert_refused(1, "slice", field, "--iso", "0.5", "--time", "0,0.1,0.2", "-o", "m.pvd")

    def test_full_standard_output_is_exit_code_1(self):
        for arguments in (["table", "2"], ["--help"], ["--version"], ["extract", WATER, "--iso", "0.5", "--json"]):
            with open("/dev/full", "w", encoding="utf-8") as full:
                run = subprocess.run([PROGRAM, *arguments], stdout=full, stderr=subprocess.PIPE, check=False)
            self.assertEqual(run.returncode, 1, arguments)
            self.assertRegex(run.stderr.decode(), r"\Ahyperiso: error: [^\n]+\n\Z")

    def test_reader_that_leaves_is_no_error(self):
        with subprocess.Popen([PROGRAM, "table", "4", "--counts"], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as run:
            self.assertEqual(run.stdout.readline(), b"0\n")
            run.stdout.close()
            self.assertEqual(run.stderr.read(), b"")
        self.assertEqual(run.returncode, 0)

    def test_warnings_are_for_standard_error_and_can_be_turned_off(self):
        field = self.sample()
        run = Run("extract", field, "--iso", "7", "--json", "-o", "none.ply")
        self.assertEqual((run.code, run.json()["simplices"]), (0, 0))
        self.assertRegex(run.err, r"\Ahyperiso: warning: [^\n]+\n\Z")
        self.assertTrue((self.folder / "none.ply").exists())
        self.ok("extract", field, "--iso", "7", "--quiet")

    def test_same_bytes_every_time_and_for_any_number_of_threads(self):
        field = self.sample("torus-morph", "20,20,20,9")
        contents = set()
        for threads in ("1", "1", "2", "5"):
            self.ok("extract", field, "--iso", "0.5", "-o", "a.vtu", "--threads", threads)
            contents.add((self.folder / "a.vtu").read_bytes())
        self.assertEqual(len(contents), 1)

    def test_memory_limit_is_kept_and_named(self):
        field = self.sample("noise", "20,20,20,9")
        self.assert_refused(1, "extract", field, "--iso", "0.5", "--memory", "100K", words=["memory"])
        self.assert_refused(1, "sample", "noise", "--dims", "20,20,20,9", "-o", "n.nrrd", "--memory", "100K", words=["memory"])
        self.ok("extract", field, "--iso", "0.5", "--memory", "2G")

    def test_huge_field_is_refused_not_attempted(self):
        self.assert_refused(1, "sample", "ball", "--dims", "100000,100000,10000", "-o", "a.raw", words=["memory"])
        self.assert_refused(2, "sample", "ball", "--dims", "4294967296,4294967296,4294967296", "-o", "a.raw")


class Animate(Case):
    def torus(self, dims="12,12,12,9"):
        return self.sample("torus-morph", dims, "torus.nrrd")

    def test_a_series_holds_the_slices(self):
        self.torus()
        made = self.ok("animate", "torus.nrrd", "--iso", "0.5", "--frames", "5", "-o", "m.pvd", "--json").json()
        self.assertEqual(list(made), ["frames", "isovalue", "times", "vertices", "simplices", "seconds",
                                      "peak_memory_bytes"])
        self.assertEqual((made["frames"], made["times"]), (5, [0, 2]))
        self.assertEqual(self.files(), ["m.pvd", *(f"m_{i:04}.vtp" for i in range(5)), "torus.nrrd"])
        self.assertEqual(re.findall(r'timestep="([^"]*)" part="0" file="([^"]*)"', (self.folder / "m.pvd").read_text()),
                         [(time, f"m_{i:04}.vtp") for i, time in enumerate(["0", "0.5", "1", "1.5", "2"])])
        for i, time in enumerate(["0", "0.5", "1", "1.5", "2"]):
            self.ok("slice", "torus.nrrd", "--iso", "0.5", "--time", time, "-o", "cut.vtp")
            self.assertEqual(self.ok("measure", "cut.vtp", "--json").json(), self.ok("measure", f"m_{i:04}.vtp", "--json").json())

    def test_numbered_files_from_a_field_and_from_its_mesh(self):
        self.torus()
        self.ok("extract", "torus.nrrd", "--iso", "0.5", "-o", "torus.vtu")
        self.ok("animate", "torus.nrrd", "--iso", "0.5", "--times", "0:0.7:0.35,1.25", "-o", "f_%02d.ply")
        self.ok("animate", "torus.vtu", "--times", "0,0.35,0.7,1.25", "-o", "m_%d.ply")
        self.assertEqual([name for name in self.files() if name.endswith("ply")],
                         [f"f_{i:02}.ply" for i in range(4)] + [f"m_{i}.ply" for i in range(4)])
        for i in range(4):
            field, mesh = (self.ok("measure", path, "--json").json() for path in [f"f_{i:02}.ply", f"m_{i}.ply"])
            for key in ["simplices", "vertices", "euler_characteristic", "closed", "bad_facets"]:
                self.assertEqual(field.get(key), mesh.get(key), key)

    def test_frames_at_events_are_at_their_times(self):
        self.sample("gaussians", "12,12,12,5", "blobs.nrrd")
        plain = self.ok("animate", "blobs.nrrd", "--iso", "0.5", "--frames", "3", "-o", "a.pvd", "--json").json()
        self.ok("track", "blobs.nrrd", "--iso", "0.5", "-o", "tracks")
        merge = [event["time"] for event in json.loads((self.folder / "tracks/events.json").read_text())["events"]
                 if event["type"] == "merge"]
        found = self.ok("animate", "blobs.nrrd", "--iso", "0.5", "--frames", "3", "--events", "-o", "b.pvd", "--json").json()
        self.assertEqual(found["frames"], plain["frames"] + found["events"])
        times = [float(time) for time in re.findall(r'timestep="([^"]*)"', (self.folder / "b.pvd").read_text())]
        self.assertEqual(len(merge), 1)
        self.assertIn(merge[0], times)
        self.assertEqual(times, sorted(set(times)))

    def test_components_have_nodes_named_by_their_tracks(self):
        self.sample("gaussians", "16,16,16,6", "blobs.nrrd")  # two that merge
        self.ok("animate", "blobs.nrrd", "--iso", "0.5", "--frames", "3", "--tracks", "-o", "t.glb")
        data = (self.folder / "t.glb").read_bytes()
        nodes = json.loads(data[20:20 + struct.unpack_from("<I", data, 12)[0]])["nodes"]
        parts = [[nodes[child]["name"] for child in node.get("children", [])] for node in nodes
                 if node["name"].startswith("frame")]
        self.assertEqual(parts[0], ["track 0", "track 1"])
        self.assertEqual(len(parts[2]), 1)
        self.assertIn(parts[2][0], parts[0])
        self.ok("animate", "blobs.nrrd", "--iso", "0.5", "--times", "0.33", "--tracks", "--events", "-o", "t.pvd")
        self.assertIn(b"track_id", (self.folder / "t_0000.vtp").read_bytes())
        self.assert_refused(2, "animate", "blobs.nrrd", "--iso", "0.5", "--frames", "3", "--tracks", "--colour-by", "x", "-o",
                            "t.glb", words=["--tracks", "--colour-by"])

    def test_times_are_the_worlds_as_those_of_the_mesh_are(self):
        self.sample("ball", "8,8,8,3", "ball.raw")
        (self.folder / "turned.nhdr").write_text(
            "NRRD0004\ntype: float\ndimension: 4\nsizes: 8 8 8 3\nencoding: raw\nendian: little\nspace dimension: 4\n"
            "space directions: (1,1,0,0) (-1,1,0,0) (0,0,1,0) (0,0,0,0.5)\nspace origin: (5,0,0,3)\ndata file: ball.raw\n")
        self.ok("extract", "turned.nhdr", "--iso", "0.5", "-o", "turned.vtu")
        for source, name in [(["turned.nhdr", "--iso", "0.5"], "f"), (["turned.vtu"], "m")]:
            made = self.ok("animate", *source, "--frames", "3", "-o", name + "_%d.ply", "--json").json()
            self.assertEqual(made["times"], [3, 4])
            self.ok("animate", *source, "--times", "3.75", "-o", name + "_between_%d.ply")
        for name in ["0", "1", "between_0"]:
            field, mesh = (self.ok("measure", f"{kind}_{name}.ply", "--json").json() for kind in "fm")
            self.assertAlmostEqual(field["measure"]["content"] if "measure" in field else field["content"],
                                   mesh["measure"]["content"] if "measure" in mesh else mesh["content"], places=3)

    def test_colours_have_one_range_for_all_frames(self):
        self.sample("ball", "12,12,12,5", "ball.nrrd")
        self.ok("animate", "ball.nrrd", "--iso", "0.5", "--frames", "3", "--colour-by", "x", "-o", "f_%d.ply")
        self.ok("animate", "ball.nrrd", "--iso", "0.5", "--frames", "3", "--colour-by", "x", "--colour-range", "-1:1", "-o",
                "g_%d.ply")
        for name in ["f_0.ply", "g_0.ply"]:
            self.assertIn(b"property uchar red", (self.folder / name).read_bytes())
        self.assertNotEqual((self.folder / "f_0.ply").read_bytes(), (self.folder / "g_0.ply").read_bytes())

    def test_glb_is_one_file_of_its_length(self):
        self.torus()
        self.ok("animate", "torus.nrrd", "--iso", "0.5", "--frames", "3", "-o", "t.glb")
        data = (self.folder / "t.glb").read_bytes()
        magic, version, length, json_length = struct.unpack_from("<4sIII", data)
        self.assertEqual((magic, version, length), (b"glTF", 2, len(data)))
        self.assertEqual(len(json.loads(data[20:20 + json_length])["meshes"]), 3)

    @unittest.skipUnless(HAS_PICTURES, "built without pictures")
    def test_pictures(self):
        self.torus()
        arguments = ["animate", "torus.nrrd", "--iso", "0.5", "--frames", "3", "--size", "160x121"]
        self.ok(*arguments, "--threads", "1", "-o", "a_%d.png")
        self.ok(*arguments, "--threads", "3", "-o", "b_%d.png")
        pictures = [(self.folder / f"a_{i}.png").read_bytes() for i in range(3)]
        for i, picture in enumerate(pictures):
            self.assertEqual(picture[:8], b"\x89PNG\r\n\x1a\n")
            self.assertEqual(struct.unpack_from(">II", picture, 16), (160, 121))
            self.assertEqual(picture, (self.folder / f"b_{i}.png").read_bytes())
        self.assertEqual(len(set(pictures)), 3)
        self.ok(*arguments, "--view", "90,0", "-o", "c_%d.png")
        self.assertNotEqual((self.folder / "c_0.png").read_bytes(), pictures[0])
        self.sample("ball", "12,12,5", "disc.nrrd", "--time")
        self.ok("animate", "disc.nrrd", "--iso", "0.5", "--frames", "2", "-o", "d_%d.png")

    @unittest.skipUnless(HAS_FILMS and shutil.which("ffprobe"), "no ffmpeg, or built without pictures")
    def test_films_hold_their_frames(self):
        self.torus()
        for name, coding in [("film.mp4", "h264"), ("film.gif", "gif")]:
            self.ok("animate", "torus.nrrd", "--iso", "0.5", "--frames", "7", "--size", "128x96", "--fps", "5", "-o", name)
            stream = json.loads(subprocess.run(
                ["ffprobe", "-v", "error", "-count_frames", "-show_streams", "-of", "json", name],
                capture_output=True, check=True).stdout)["streams"][0]
            self.assertEqual((stream["codec_name"], stream["width"], stream["height"], stream["nb_read_frames"],
                              stream["r_frame_rate"]), (coding, 128, 96, "7", "5/1"))
        self.ok("animate", "torus.nrrd", "--iso", "0.5", "--frames", "7", "--size", "128x96", "-o", "f_%d.png")

        def frames(source, *options):
            return subprocess.run(["ffmpeg", "-v", "error", *options, "-i", source, "-f", "rawvideo", "-pix_fmt", "rgb24", "-"],
                                  capture_output=True, check=True).stdout
        film, pictures = frames("film.mp4"), frames("f_%d.png", "-start_number", "0")
        self.assertEqual(len(film), len(pictures))
        self.assertLess(sum(abs(a - b) for a, b in zip(film, pictures)) / len(film), 3)

    @unittest.skipUnless(HAS_FILMS, "no ffmpeg, or built without pictures")
    def test_without_ffmpeg_it_says_so_before_the_work(self):
        self.torus()
        (self.folder / "film.mp4").write_text("keep me")
        self.assert_refused(1, "animate", "torus.nrrd", "--iso", "0.5", "--frames", "3", "-o", "film.mp4", words=["ffmpeg"],
                            env={"PATH": "/nowhere"})

    def test_wrong_usage(self):
        self.torus()
        self.ok("extract", "torus.nrrd", "--iso", "0.5", "-o", "torus.vtu")
        self.sample("ball", "6,6", "flat.nrrd")
        self.sample("ball", "4,4,4,4,4", "five.nrrd")
        ply = ["-o", "f_%d.ply"]
        for arguments, words in [
                (["torus.nrrd", "--iso", "0.5", *ply], ["--frames", "--times"]),
                (["torus.nrrd", "--iso", "0.5", "--frames", "3", "--times", "0.5", *ply], ["--frames", "--times"]),
                (["torus.nrrd", "--iso", "0.5", "--frames", "0", *ply], ["--frames", "0"]),
                (["torus.nrrd", "--iso", "0.5", "--frames", "many", *ply], ["--frames", "many"]),
                (["torus.nrrd", "--iso", "0.5", "--times", "0.5,2.5", *ply], ["2.5", "axis t"]),
                (["torus.nrrd", "--iso", "0.5", "--times", "0.5,0.25", *ply], ["--times", "0.25"]),
                (["torus.nrrd", "--iso", "0.5", "--times", "1:0:0.5", *ply], ["--times", "1:0:0.5"]),
                (["torus.nrrd", "--iso", "0.5", "--frames", "3"], ["-o"]),
                (["torus.nrrd", "--iso", "0.5", "--frames", "3", "-o", "film.avi"], ["film.avi", ".mp4", ".glb"]),
                (["torus.nrrd", "--iso", "0.5", "--frames", "3", "-o", "f.ply"], ["f.ply", "f_%04d.ply"]),
                (["torus.nrrd", "--iso", "0.5", "--frames", "3", "-o", "f_%d_%d.ply"], ["f_%d_%d.ply"]),
                (["torus.nrrd", "--iso", "0.5", "--frames", "3", "-o", "f_%d.txt"], ["txt"]),
                (["torus.nrrd", "--frames", "3", *ply], ["--iso"]),
                (["torus.nrrd", "--iso", "0.5,0.6", "--frames", "3", *ply], ["--iso", "one"]),
                (["flat.nrrd", "--iso", "0.5", "--frames", "3", *ply], ["2 dimensions"]),
                (["five.nrrd", "--iso", "0.5", "--frames", "3", *ply], ["5 dimensions"]),
                (["torus.vtu", "--iso", "0.5", "--frames", "3", *ply], ["--iso"]),
                (["torus.vtu", "--frames", "3", "--events", *ply], ["--events", "field"]),
                (["torus.vtu", "--frames", "3", "--normals", *ply], ["--normals"]),
                (["torus.vtu", "--times", "9", *ply], ["9"]),
                (["torus.nrrd", "--iso", "0.5", "--frames", "3", "--fps", "5", *ply], ["--fps", ".ply"]),
                (["torus.nrrd", "--iso", "0.5", "--frames", "3", "--quantise", *ply], ["--quantise", ".ply"]),
                (["torus.nrrd", "--iso", "0.5", "--frames", "3", "--fps", "0", "-o", "a.glb"], ["--fps", "0"]),
                (["torus.nrrd", "--iso", "0.5", "--frames", "3", "--colour-by", "density", "-o", "a.glb"], ["density"]),
                (["torus.nrrd", "--iso", "0.5", "--frames", "3", "--colour-by", "x", "-o", "a.pvd"], ["--colour-by"]),
                (["torus.nrrd", "--iso", "0.5", "--frames", "3", "--colour-range", "0:1", "-o", "a.glb"], ["--colour-by"])]:
            self.assert_refused(2, "animate", *arguments, words=words)
        for name in ["missing/f_%d.ply", "missing/a.glb", "missing/a.pvd"]:
            self.assert_refused(1, "animate", "torus.nrrd", "--iso", "0.5", "--frames", "3", "-o", name, words=["missing"])
        if HAS_PICTURES:
            for options, words in [(["--size", "100"], ["--size", "100"]), (["--size", "9x9"], ["--size", "9"]),
                                   (["--view", "3"], ["--view"]), (["--view", "0,91"], ["91"]),
                                   (["--quantise"], ["--quantise", ".png"])]:
                self.assert_refused(2, "animate", "torus.nrrd", "--iso", "0.5", "--frames", "3", *options, "-o", "f_%d.png",
                                    words=words)
            self.assert_refused(2, "animate", "torus.nrrd", "--iso", "0.5", "--frames", "3", "--size", "101x100", "-o",
                                "f.mp4", words=["--size", "101"])

    def test_an_empty_surface_is_told_and_written(self):
        self.torus()
        run = Run("animate", "torus.nrrd", "--iso", "9", "--frames", "2", "-o", "f_%d.ply")
        self.assertEqual(run.code, 0)
        self.assertRegex(run.err, r"\Ahyperiso: warning: no surface[^\n]*\n\Z")
        self.assertEqual(self.files(), ["f_0.ply", "f_1.ply", "torus.nrrd"])
class SlabBySlab(Case):
    """A field larger than --memory is extracted step by step, to the same file."""

    SMALL = ("--memory", "4M")  # the field takes 5 MB, a step 256 KB

    def setUp(self):
        super().setUp()
        self.field = self.sample("torus-morph", "40,40,40,20")

    def beside_the_program(self, kibibytes):
        """--memory for that much beside what the program itself holds, which differs from system to system."""
        held = re.search(r"holds ([0-9.]+) MiB", Run("extract", self.field, "--iso", "0.5", "--memory", "1K").err)
        return "--memory", f"{int(float(held[1]) * 1024) + kibibytes}K"

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
        self.assert_same(self.field, "--iso", "0.5", "--crop", ",20:21", memory=self.beside_the_program(100))  # of 125 KiB

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
        measure = self.ok("extract", "packed.nrrd", "--iso", "0.7", "--json", "--measure", "--memory", "5M").json()
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
        self.assert_refused(1, "extract", self.field, "--iso", "0.5", *self.beside_the_program(250),
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


class Interruption(Case):
    def interrupt(self, when, *arguments):
        with subprocess.Popen([PROGRAM, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as run:
            while run.poll() is None and not when():
                time.sleep(0.001)
            run.send_signal(signal.SIGINT)
            out, err = run.communicate()
        return run.returncode, out, err

    def unfinished(self):
        return any(name.endswith(".part") for name in self.files())

    # Long enough to be caught in the act; had it ended, the exit code would be 0.
    def test_ctrl_c_while_writing_leaves_no_file(self):
        field = self.sample("noise", "40,40,40,12")
        (self.folder / "out.vtu").write_text("keep me")
        code, out, _ = self.interrupt(self.unfinished, "extract", field, "--iso", "0.5", "-o", "out.vtu")
        self.assertEqual((code, out), (130, b""))
        self.assertEqual(self.files(), [field, "out.vtu"])
        self.assertEqual((self.folder / "out.vtu").read_text(), "keep me")

    def test_ctrl_c_while_writing_slabs_leaves_no_file(self):
        field = self.sample("noise", "40,40,40,12")
        code, out, _ = self.interrupt(self.unfinished, "extract", field, "--iso", "0.5", "-o", "out.vtu", "--memory", "30M")
        self.assertEqual((code, out), (130, b""))
        self.assertEqual(self.files(), [field])

    def test_ctrl_c_between_the_files_of_a_series_leaves_none(self):
        field = self.sample("noise", "40,40,40,4")
        times = ",".join(str(i / 1000) for i in range(900))
        code, _, _ = self.interrupt(lambda: len(self.files()) > 3, "slice", field, "--iso", "0.5", "--time", times, "-o", "m.pvd")
        self.assertEqual(code, 130)
        self.assertEqual(self.files(), [field])

    @unittest.skipUnless(HAS_FILMS, "no ffmpeg, or built without pictures")
    def test_ctrl_c_while_a_film_is_drawn_leaves_none(self):
        field = self.sample("ball", "16,16,16,4")
        start = time.monotonic()
        code, _, _ = self.interrupt(lambda: self.unfinished() and time.monotonic() > start + 0.3, "animate", field, "--iso",
                                    "0.5", "--frames", "900", "-o", "film.mp4")
        self.assertEqual(code, 130)
        time.sleep(0.3)  # ffmpeg ends by itself
        self.assertEqual(self.files(), [field])

    def test_ctrl_c_while_computing_leaves_no_file(self):
        start = time.monotonic()
        code, _, _ = self.interrupt(lambda: time.monotonic() > start + 0.2, "sample", "gyroid", "--dims", "300,300,300,20",
                                    "-o", "a.raw")
        self.assertEqual((code, self.files()), (130, []))


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
        self.ok("slice", field, "--iso", "-0.5", "--time", "-0.25")
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


@unittest.skipUnless(HAS_VIEW, "built without the viewer")
class View(Case):
    def metadata(self, page):
        text = (self.folder / page).read_text()
        return json.loads(re.search(r'<script type="application/json" id="hyperiso-metadata">(.*?)</script>', text)[1])

    def test_a_page_tells_what_the_field_is(self):
        run = self.ok("view", WATER, "--iso", "0.5", "--title", "Dam break", "--colour-by", "speed", "-o", "a.html", "--json")
        extracted = self.ok("extract", WATER, "--iso", "0.5", "--json").json()
        page = self.metadata("a.html")
        for key in ("vertices", "simplices"):
            self.assertEqual(run.json()[key], extracted[key])
            self.assertEqual(page[key], extracted[key])
        self.assertEqual(run.json()["bytes"], (self.folder / "a.html").stat().st_size)
        self.assertEqual((page["title"], page["isovalue"], page["time"], page["colourBy"]), ("Dam break", 0.5, True, "speed"))
        self.assertEqual([axis["samples"] for axis in page["axes"]], [24, 24, 24, 41])
        self.assertLess((run.json()["bytes"] - 700e3) / page["simplices"], 6)  # bytes per tetrahedron

    def test_a_mesh_gives_the_same_surface(self):
        self.ok("extract", WATER, "--iso", "0.5", "-o", "water.vtu")
        self.ok("view", "water.vtu", "-o", "mesh.html")
        self.ok("view", WATER, "--iso", "0.5", "-o", "field.html")
        blocks = [re.findall(r'class="hyperiso-block">([^<]*)<', (self.folder / name).read_text())
                  for name in ("mesh.html", "field.html")]
        self.assertGreater(len(blocks[0]), 0)
        self.assertEqual(*blocks)

    def test_tracks_and_events_come_with_it(self):
        self.ok("view", self.sample("gaussians", "16,16,16,21"), "--iso", "0.5", "--track", "-o", "a.html")
        page = self.metadata("a.html")
        self.assertEqual(len(page["tracking"]["tracks"]), 2)
        self.assertIn("merge", [event["type"] for event in page["tracking"]["events"]])
        self.assertEqual(page["attributes"], [{"name": "track", "kind": "label", "labels": [0, 1]}])

    def test_a_page_that_would_be_too_large_has_fewer_samples_and_says_so(self):
        run = Run("view", WATER, "--iso", "0.5", "--max-size", "1M", "--payload", "mesh", "-o", "a.html")
        self.assertEqual(run.code, 0)
        self.assertRegex(run.err, r"\Ahyperiso: warning: the page would have been larger than 1 MiB: .*second sample.*\n\Z")
        page = self.metadata("a.html")
        self.assertEqual([axis["samples"] for axis in page["axes"]], [12, 12, 12, 41])
        self.assertEqual(len(page["notes"]), 1)
        self.assertLess((self.folder / "a.html").stat().st_size, 2 ** 20)
        self.ok("extract", WATER, "--iso", "0.5", "-o", "water.vtu")
        self.assert_refused(2, "view", "water.vtu", "--max-size", "1M", "-o", "b.html", words=["220424", "1 MiB"])

    def has_field_pages(self):
        return "no extraction" not in Run("view", WATER, "--iso", "0.5", "--payload", "band", "-o", "probe.html").err

    def test_a_page_of_samples_shows_the_same_surface(self):
        if not self.has_field_pages():
            self.skipTest("built without the extraction for pages")
        sizes = {}
        for payload in ("mesh", "band", "field"):
            run = self.ok("view", WATER, "--iso", "0.5", "--payload", payload, "-o", "a.html", "--json").json()
            page = self.metadata("a.html")
            self.assertEqual((run["payload"], run["simplices"], page["simplices"], page["vertices"]),
                             (payload, 220424, 220424, 41685))
            self.assertEqual("samples" in page, payload != "mesh")
            sizes[payload] = run["bytes"]
        self.assertLess(sizes["band"], sizes["field"])
        self.assertLess(sizes["field"], sizes["mesh"])

    def test_the_band_is_taken_before_samples_are_left_out(self):
        if not self.has_field_pages():
            self.skipTest("built without the extraction for pages")
        run = self.ok("view", WATER, "--iso", "0.5", "--max-size", "1.2M", "-o", "a.html", "--json")
        self.assertEqual((run.json()["payload"], run.json()["notes"], run.json()["simplices"]), ("band", [], 220424))
        run = Run("view", WATER, "--iso", "0.5", "--max-size", "890k", "-o", "a.html", "--json")
        self.assertEqual(run.code, 0)
        self.assertRegex(run.err, r"\Ahyperiso: warning: the page would have been larger than 8.*second sample.*\n\Z")
        self.assertEqual(len(self.metadata("a.html")["notes"]), 1)
        self.assertEqual(self.metadata("a.html")["samples"]["axes"][0]["count"], 12)
        self.assert_refused(2, "view", WATER, "--iso", "0.5", "--payload", "field", "--max-size", "100k", "-o", "b.html",
                            words=["would be larger than", "higher limit"])
        self.assertFalse((self.folder / "b.html").exists())

    def test_space_alone_and_two_axes_of_space_with_time(self):
        for dims in ("12,12,12", "12,12,12,5"):
            self.sample("ball", dims, "ball.nrrd")
            self.ok("view", "ball.nrrd", "--iso", "0.5", "-o", "ball.html")
            self.assertEqual(self.metadata("ball.html")["dimension"], dims.count(",") + 1)

    def test_wrong_usage(self):
        field = self.sample()
        self.assert_refused(2, "view", field, "-o", "a.html", words=["--iso"])
        self.assert_refused(2, "view", field, "--iso", "0.5", words=["output"])
        self.assert_refused(2, "view", field, "--iso", "0.5,0.6", "-o", "a.html", words=["one isovalue"])
        self.assert_refused(2, "view", field, "--iso", "0.5", "--max-size", "many", "-o", "a.html", words=["--max-size"])
        self.assert_refused(2, "view", field, "--iso", "0.5", "--payload", "net", "-o", "a.html", words=["mesh, band and field"])
        self.assert_refused(2, "view", field, "--iso", "0.5", "--payload", "band", "--method", "barycentric", "-o", "a.html",
                            words=["barycentric"])
        self.sample("ball", "4,4", "two.nrrd")
        self.assert_refused(2, "view", "two.nrrd", "--iso", "0.5", "-o", "a.html", words=["3 to 4"])
        self.ok("extract", field, "--iso", "0.5", "-o", "mesh.vtu")
        self.assert_refused(2, "view", "mesh.vtu", "--iso", "0.5", "-o", "a.html", words=["--iso"])
        self.assert_refused(2, "view", "mesh.vtu", "--track", "-o", "a.html", words=["--track"])
        self.assert_refused(2, "view", "mesh.vtu", "--payload", "field", "-o", "a.html", words=["no samples"])
        self.assert_refused(1, "view", field, "--iso", "0.5", "-o", "no/such/folder/a.html", words=["folder"])

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


class Terminal(Case):
    # Drawn only there, on one line, and wiped away: what is left on the screen is the report.
    def test_progress_bar(self):
        reader, writer = pty.openpty()
        with subprocess.Popen([PROGRAM, "sample", "noise", "--dims", "100,100,100,6", "-o", "a.nrrd", "--compress"],
                              stdout=subprocess.PIPE, stderr=writer) as run:
            os.close(writer)
            drawn = b""
            try:
                while piece := os.read(reader, 4096):
                    drawn += piece
            except OSError:  # how Linux says that the other end is closed
                pass
            out = run.stdout.read().decode()
        os.close(reader)
        self.assertEqual(run.returncode, 0)
        self.assertIn("wrote", out)
        self.assertIn(b"write", drawn)
        self.assertNotIn(b"\n", drawn)
        self.assertTrue(drawn.endswith(b"\r\x1b[K"), drawn[-80:])


class Manual(Case):
    def test_lists_every_verb_and_option_within_80_columns(self):
        manual = self.ok("--help").out
        for verb in VERBS:
            self.assertRegex(manual, rf"\n  {verb} +\w")
        for arguments in ([], *([verb] for verb in VERBS)):
            page = self.ok(*arguments, "--help").out
            self.assertEqual(page, self.ok(*arguments, "-h").out)
            self.assertLessEqual(max(map(len, page.splitlines())), 80)
            self.assertIn("Examples:", page)
        for option in ("--iso", "--method", "--inside", "--crop", "--steps", "--time-axis", "--variable", "--threads",
                       "--memory", "--precision", "--output", "--format", "--measure", "--json", "--quiet", "--dims",
                       "--type", "--skip", "--big-endian"):
            self.assertRegex(self.ok("extract", "--help").out, rf"(?m)^  .*{option}\b", option)

    def test_version(self):
        self.assertRegex(self.ok("--version").out, r"\Ahyperiso \d+\.\d+\.\d+\n\Z")

    def test_examples_run_as_written(self):
        environment = dict(os.environ, PATH=f"{PROGRAM.parent}:{os.environ['PATH']}")
        for arguments in ([], *([verb] for verb in VERBS)):
            page = self.ok(*arguments, "--help").out
            commands = page[page.index("Examples:"):].split("\n", 1)[1]
            if arguments == ["table"]:
                commands = commands.replace("table 4 --verify", "table 3 --verify")  # seconds of exact arithmetic
            if not HAS_FILMS:
                commands = "\n".join(line for line in commands.splitlines() if ".mp4" not in line)
            run = subprocess.run(["sh", "-e", "-c", commands], env=environment, capture_output=True, check=False)
            self.assertEqual((run.returncode, run.stderr.decode()), (0, ""), arguments)


if __name__ == "__main__":
    unittest.main()
