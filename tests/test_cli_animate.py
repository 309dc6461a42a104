"""animate and morph: the surface as it moves.

    test_cli_animate.py PROGRAM
"""

import ast
import json
import math
import re
import shutil
import struct
import subprocess
import unittest
import zipfile

from cli_case import Case, HAS_FILMS, HAS_PICTURES, Run


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

    def test_frames_are_the_stored_steps_if_nothing_else_is_said(self):
        self.torus()
        self.ok("extract", "torus.nrrd", "--iso", "0.5", "-o", "torus.vtu")
        for source in (["torus.nrrd", "--iso", "0.5"], ["torus.vtu"]):
            self.ok("animate", *source, "-o", "m.pvd")
            self.assertEqual([float(time) for time in re.findall(r'timestep="([^"]*)"', (self.folder / "m.pvd").read_text())],
                             [step / 4 for step in range(9)])

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
        moving = [self.ok("animate", *source, "--frames", "4", "--morph", "-o", "f.glb", "--json").json()
                  for source in [["turned.nhdr", "--iso", "0.5"], ["turned.vtu"]]]
        self.assertEqual(moving[0]["simplices"], moving[1]["simplices"])
        self.assertEqual(moving[0]["vertices"], moving[1]["vertices"])
        header = (self.folder / "turned.nhdr").read_text()
        (self.folder / "sheared.nhdr").write_text(header.replace("(0,0,0,0.5)", "(0.3,0,0,0.5)"))
        self.assert_refused(2, "animate", "sheared.nhdr", "--iso", "0.5", "--frames", "3", "--morph", "-o", "s.glb",
                            words=["--morph", "moves space"])
        self.ok("animate", "sheared.nhdr", "--iso", "0.5", "--frames", "3", "--morph", "--tracks", "-o", "s.glb")

    def test_frames_that_move_have_a_target_each(self):
        self.torus()
        still = self.ok("animate", "torus.nrrd", "--iso", "0.5", "--times", "0.1,0.3,0.4", "-o", "s.glb", "--json").json()
        moving = self.ok("animate", "torus.nrrd", "--iso", "0.5", "--times", "0.1,0.3,0.4", "--morph", "-o", "m.glb",
                         "--json").json()
        self.assertEqual(still["simplices"], moving["simplices"])
        data = (self.folder / "m.glb").read_bytes()
        meshes = json.loads(data[20:20 + struct.unpack_from("<I", data, 12)[0]])["meshes"]
        self.assertEqual(["targets" in mesh["primitives"][0] for mesh in meshes], [True, True, False])

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
    def test_gif_of_any_size(self):
        self.torus()
        self.ok("animate", "torus.nrrd", "--iso", "0.5", "--frames", "2", "--size", "101x75", "-o", "film.gif")
        self.assertEqual(struct.unpack("<HH", (self.folder / "film.gif").read_bytes()[6:10]), (101, 75))

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
        self.sample("ball", "6,6,6", "curve.nrrd")
        self.ok("extract", "curve.nrrd", "--iso", "0.5", "-o", "curve.ply")
        for arguments, words in [
                (["curve.ply", "-o", "f_%d.obj"], ["--frames", "--times"]),  # a mesh that knows of no steps
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
                (["torus.nrrd", "--iso", "0.5", "--frames", "3", "--morph", *ply], ["--morph", ".ply"]),
                (["torus.nrrd", "--iso", "0.5", "--frames", "3", "--fps", "0", "-o", "a.glb"], ["--fps", "0"]),
                (["torus.nrrd", "--iso", "0.5", "--frames", "3", "--colour-by", "density", "-o", "a.glb"], ["density", "normal, x, y, z"]),
                (["torus.nrrd", "--iso", "0.5", "--frames", "3", "--colour-by", "t", "-o", "a.glb"], ["t is the same all over a frame"]),
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
                                "f.mp4", words=["--size", "101x100", "102x100"])

    def test_an_empty_surface_is_told_and_written(self):
        self.torus()
        run = Run("animate", "torus.nrrd", "--iso", "9", "--frames", "2", "-o", "f_%d.ply")
        self.assertEqual(run.code, 0)
        self.assertRegex(run.err, r"\Ahyperiso: warning: no surface[^\n]*\n\Z")
        self.assertEqual(self.files(), ["f_0.ply", "f_1.ply", "torus.nrrd"])


if __name__ == "__main__":
    unittest.main()
