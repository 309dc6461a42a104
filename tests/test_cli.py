"""The contract that all verbs keep: what scripts and people may rely on.

    test_cli.py PROGRAM
"""

import gzip
import os
import pty
import re
import signal
import struct
import subprocess
import time
import unittest

from cli_case import Case, EXTRACT_KEYS, FOLDING, HAS_FILMS, MEASURE_KEYS, PROGRAM, Run, VERBS, WATER


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
                ["extract", field, "--iso", "0.5", "--cut", "staircase"], ["extract", field, "--iso", "0.5", "--cut", "midpoints"],
                ["extract", field, "--iso=", "--json"], ["extract", field, "--iso", "0.5", "--seed=", "--json"],
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

    # By its name, another way to it, a link, or one of several numbered files.
    def test_input_is_not_replaced(self):
        field = self.sample("ball", "6,6,6,3")
        (self.folder / "link.nrrd").symlink_to("field.nrrd")
        os.link("field.nrrd", "hard.nrrd")
        for path in ("field.nrrd", "./field.nrrd", str(self.folder / "field.nrrd"), "link.nrrd", "hard.nrrd"):
            self.assert_refused(2, "convert", field, "-o", path, words=["-o", path, "would replace", "field.nrrd"])
        self.assert_refused(2, "convert", "link.nrrd", "-o", field, words=["would replace"])
        self.assert_refused(2, "extract", WATER, "--iso", "0.5", "--with", "b=link.nrrd", "--format", "vtu", "-o", field,
                            words=["would replace link.nrrd"])
        self.ok("convert", field, "-o", "s.vti")
        for path in ("s.pvd", "s.vti"):
            self.assert_refused(2, "convert", "s.pvd", "-o", path, words=["would replace s.pvd"])
            self.assert_refused(2, "convert", "s_0000.vti", "s_0001.vti", "-o", path, words=["would replace s_0000.vti"])
        self.ok("convert", "s_0000.vti", "s_0001.vti", "-o", "t.pvd")
        for step in ("s_0001.vti", "s_%04d.vti"):
            self.assert_refused(2, "extract", "s.pvd", "--iso", "0.5", "--format", "vtu", "-o", step, words=["would replace s_000"])
        self.ok("convert", field, "-o", "samples.raw")
        header = "NRRD0004\ntype: float\ndimension: 4\nsizes: 6 6 6 3\nendian: little\nencoding: raw\ndata file: samples.raw\n"
        (self.folder / "a.nhdr").write_text(header)
        (self.folder / "a.series").write_text('{"files": [{"name": "s_0000.vti", "time": 0}, {"name": "s_0001.vti", "time": 1}]}')
        self.assert_refused(2, "convert", "a.nhdr", "-o", "samples.raw", words=["would replace samples.raw"])
        self.assert_refused(2, "extract", WATER, "--iso", "0.5", "--with", "b=a.nhdr", "--format", "vtu", "-o", "samples.raw",
                            words=["would replace samples.raw"])
        self.assert_refused(2, "convert", "a.series", "-o", "s_0001.vti", words=["would replace s_0001.vti"])
        self.ok("convert", "a.nhdr", "-o", "other.raw")
        self.ok("extract", field, "--iso", "0.5", "-o", "m_007.vtu")
        self.assert_refused(2, "slice", "m_007.vtu", "--time", "0.5", "-o", "m_%03d.vtu", words=["would replace m_007.vtu"])
        self.ok("slice", "m_007.vtu", "--time", "0.5", "-o", "m_%02d.vtu")

    # Told before the work is done.
    def test_folder_that_is_not_there_is_named(self):
        field = self.sample("ball", "6,6,6,3")
        for verb, options in (("extract", ["-o", "no/a.ply"]), ("slice", ["--time", "0", "-o", "no/a_%d.ply"]),
                              ("animate", ["-o", "no/a_%d.ply"]), ("animate", ["-o", "no/a.glb"])):
            self.assert_refused(1, verb, field, "--iso", "0.5", *options, words=[options[-1], "there is no folder no;"])
        (self.folder / "away.ply").symlink_to("no/a.ply")
        self.assert_refused(1, "extract", field, "--iso", "0.5", "--steps", "0:1", "-o", "away.ply", words=["there is no folder no"])

    def test_link_that_leads_nowhere_stays_and_its_file_is_made(self):
        field = self.sample()
        (self.folder / "link.ply").symlink_to("made.ply")
        self.ok("extract", field, "--iso", "0.5", "-o", "link.ply")
        self.assertEqual(os.readlink("link.ply"), "made.ply")
        self.assertTrue((self.folder / "made.ply").is_file())

    # Standard output has the report; the shell's habit of "-" would make a file of that name.
    def test_no_file_is_called_minus(self):
        arguments = {"sample": ["ball", "--dims", "4,4"], "extract": [WATER, "--iso", "0.5"], "interval": [WATER, "--range", "0.4:0.6"]}
        for verb in VERBS:
            if re.search(r"--output\b", self.ok(verb, "--help").out):
                self.assert_refused(2, verb, *arguments.get(verb, [WATER]), "-o", "-", words=["-o", "standard output"])

    def test_the_report_names_the_files_there_are(self):
        self.assertIn("wrote  a.pvd, and a .vti for each of its 2 steps\n",
                      self.ok("convert", WATER, "--steps", "3:5", "-o", "a.vti").out)
        self.assertIn("wrote  b.pvd, and the .vti of its step\n", self.ok("convert", WATER, "--steps", "3:4", "-o", "b.vti").out)
        self.assertEqual(self.files(), ["a.pvd", "a_0000.vti", "a_0001.vti", "b.pvd", "b_0000.vti"])
        self.assertIn("wrote  c.vti\n", self.ok("convert", self.sample(), "-o", "c.vti").out)

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

    def test_memory_limit_counts_what_methods_and_measures_hold(self):
        field = self.sample("noise", "12,12,12,3")
        barycentric = "extract", field, "--iso", "0.5", "--method", "barycentric"
        enough = self.beside_the_program(field, 90 << 10)
        self.assert_refused(1, *barycentric, *self.beside_the_program(field, 18 << 10), words=["simplices so far", "--memory"])
        self.ok(*barycentric, *enough)
        self.assert_refused(1, *barycentric, *enough, "--measure", words=["--measure of", "more than", "--memory"])
        six = self.sample("noise", "4,4,3,3,3,3")
        self.assert_refused(1, "extract", six, "--iso", "0.5", "--method", "simplicial", *self.beside_the_program(six, 2 << 10),
                            words=["so far"])

    def test_huge_field_is_refused_not_attempted(self):
        self.assert_refused(1, "sample", "ball", "--dims", "100000,100000,10000", "-o", "a.raw", words=["memory"])
        self.assert_refused(2, "sample", "ball", "--dims", "4294967296,4294967296,4294967296", "-o", "a.raw")


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
            commands = commands.replace(".mp4", ".mp4 --size 320x180")  # seconds of drawing
            if not HAS_FILMS:
                commands = commands.replace("\\\n", "")  # a line for each
                commands = "\n".join(line for line in commands.splitlines() if ".mp4" not in line)
            run = subprocess.run(["sh", "-e", "-c", commands], env=environment, capture_output=True, check=False)
            self.assertEqual((run.returncode, run.stderr.decode()), (0, ""), arguments)


if __name__ == "__main__":
    unittest.main()
