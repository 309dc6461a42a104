"""A folder that track wrote, as the input of view and animate.

    test_cli_tracked_folder.py PROGRAM
"""

import csv
import json
import math
import os
import re
import struct
import subprocess
import unittest

from cli_case import Case, HAS_VIEW, PROGRAM, Run


def metadata(page):
    return json.loads(re.search(r'id="hyperiso-metadata">(.*?)</script>', page.read_text())[1])


class Folder(Case):
    def setUp(self):
        super().setUp()
        self.sample("gaussians", "12,11,10,6", "blobs.nrrd")  # two that merge

    def track(self, *options, field="blobs.nrrd", folder="tracks"):
        """Gives the rows of its tracks."""
        self.ok("track", field, *(options or ["--iso", "0.5"]), "-o", folder)
        with open(self.folder / folder / "tracks.csv", encoding="ascii") as table:
            return list(csv.DictReader(table))

    def edit(self, change, path="tracks/source.json"):
        source = json.loads((self.folder / path).read_text())
        change(source)
        (self.folder / path).write_text(json.dumps(source))


@unittest.skipUnless(HAS_VIEW, "built without the viewer")
class Pages(Folder):
    def same_page(self, *options, field="blobs.nrrd"):
        self.track(*options, field=field)
        self.ok("view", "tracks", "--title", "same", "-o", "a.html")
        self.ok("view", field, *options, "--track", "--title", "same", "-o", "b.html")
        self.assertEqual((self.folder / "a.html").read_bytes(), (self.folder / "b.html").read_bytes())
        return metadata(self.folder / "a.html")

    # Every option that decides the tracks has to come along: another surface would have other tracks.
    def test_the_page_is_that_of_the_field_with_the_options_it_was_tracked_with(self):
        self.assertEqual(len(self.same_page("--iso", "0.5")["tracking"]["tracks"]), 2)
        self.same_page("--iso", "0.45", "--method", "simplicial", "--inside", "below", "--crop", "1:11,,1:", "--steps", "1:5")
        self.ok("convert", "blobs.nrrd", "-o", "blobs.raw")
        self.same_page("--iso", "0.5", "--dims", "12,11,10,6", "--type", "f32", field="blobs.raw")
        self.same_page("--iso", "0.5", "--time-axis", "0")

    def test_tracks_cut_or_marked_by_options_are_those_of_the_table(self):
        for options in (["--overlap", "99%", "--overlap-volumes", "exact"], ["--min-volume", "1e9"], ["--min-duration", "9"]):
            rows = self.track("--iso", "0.5", *options)
            self.ok("view", "tracks", "-o", "a.html")
            tracks = metadata(self.folder / "a.html")["tracking"]["tracks"]
            self.assertEqual([(str(track["id"]), track["start_type"], track["end_type"], str(int(track["simplified"])))
                              for track in tracks],
                             [(row["track_id"], row["start_type"], row["end_type"], row["simplified"]) for row in rows])
            if options[0] == "--overlap":
                self.assertIn("weak", {row["end_type"] for row in rows})

    def test_the_last_axis_of_a_field_that_names_no_time_is_time(self):
        samples = struct.pack("<60f", *(5 - abs(x - 2) - t for t in range(3) for y in range(4) for x in range(5)))
        header = "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 4, 5), }".ljust(117) + "\n"
        (self.folder / "a.npy").write_bytes(b"\x93NUMPY\x01\x00" + struct.pack("<H", 118) + header.encode() + samples)
        self.track("--iso", "3.5", field="a.npy")
        self.ok("view", "tracks", "-o", "a.html")
        self.assertTrue(metadata(self.folder / "a.html")["time"])

    # Two surfaces around one region, and a ball in it: as surfaces three tracks, as regions two.
    def test_the_surface_goes_by_the_regions_that_were_tracked(self):
        axis = [x / 8 - 1 for x in range(17)]
        radius = [math.hypot(x, y, z) for z in axis for y in axis for x in axis]
        shell = [max(0.2 - abs(r - 0.65), 0.2 - r) for r in radius]
        (self.folder / "shell.raw").write_bytes(struct.pack(f"<{2 * len(shell)}f", *shell, *shell))
        raw = ["--dims", "17,17,17,2", "--type", "f32", "--iso", "0.05"]
        for options, count in (([], 3), (["--track", "region"], 2)):
            self.track(*raw, *options, field="shell.raw")
            for payload in (["mesh", "band"] if self.has_field_pages() else ["mesh"]):
                self.ok("view", "tracks", "--payload", payload, "-o", "a.html")
                page = metadata(self.folder / "a.html")
                self.assertEqual((len(page["tracking"]["tracks"]), page["tracking"]["regions"]), (count, bool(options)))
                self.assertEqual(page["attributes"], [{"kind": "label", "labels": list(range(count)), "name": "track"}])

    def has_field_pages(self):
        return Run("view", "shell.raw", "--dims", "17,17,17,2", "--type", "f32", "--iso", "0.05", "--payload", "band",
                   "-o", "probe.html").code == 0

    def test_its_title_is_the_folders_name(self):
        self.track(folder="blobs at half")
        for name in ("blobs at half", "blobs at half/", "./blobs at half"):
            self.ok("view", name, "-o", "a.html")
            self.assertEqual(metadata(self.folder / "a.html")["title"], "blobs at half")

    def test_samples_are_never_left_out(self):  # what is left would have other tracks
        self.track()
        for payload in ([], ["--payload", "mesh"]):
            self.assert_refused(2, "view", "tracks", "--max-size", "100k", *payload, "-o", "a.html",
                                words=["100 KiB", "tracks", "--max-size"])
        self.assert_refused(2, "view", "tracks", "--max-size", "100k", "--memory", "21M", "-o", "a.html")

    def test_a_page_of_fewer_samples_has_their_tracks(self):
        pages = []
        for payload in ("mesh", "band"):
            self.ok("view", "examples/data/alpha_water_24x24x24x41.nrrd", "--iso", "0.5", "--track", "--quiet", "--payload",
                    payload, "--max-size", "890k", "-o", "a.html")
            pages.append(metadata(self.folder / "a.html"))
        self.assertEqual(pages[0]["axes"], pages[1]["axes"])
        self.assertEqual(pages[0]["tracking"], pages[1]["tracking"])


class Frames(Folder):
    def test_frames_are_those_of_the_field(self):
        self.track("--iso", "0.45", "--method", "simplicial", "--steps", "1:")
        self.ok("animate", "tracks", "--frames", "4", "--events", "-o", "a.glb")
        self.ok("animate", "blobs.nrrd", "--iso", "0.45", "--method", "simplicial", "--steps", "1:", "--tracks", "--frames",
                "4", "--events", "-o", "b.glb")
        self.assertEqual((self.folder / "a.glb").read_bytes(), (self.folder / "b.glb").read_bytes())
        self.assertIn(b'"track 1"', (self.folder / "a.glb").read_bytes())

    def test_frames_are_the_stored_steps_if_nothing_else_is_said(self):
        self.track()
        expected = self.ok("info", "blobs.nrrd", "--json").json()["axes"][-1]
        found = self.ok("animate", "tracks", "-o", "a.pvd", "--json").json()
        self.assertEqual(found["frames"], expected["count"])
        times = [float(time) for time in re.findall(r'timestep="([^"]*)"', (self.folder / "a.pvd").read_text())]
        self.ok("track", "blobs.nrrd", "--iso", "0.5", "-o", "again")
        steps = [float(time) for time in re.findall(r'timestep="([^"]*)"', (self.folder / "again/tracks.pvd").read_text())]
        self.assertEqual(times, steps)
        self.assertIn(b"track_id", (self.folder / "a_0000.vtp").read_bytes())

    def test_tracks_choose_the_colours(self):
        self.track()
        self.assert_refused(2, "animate", "tracks", "--colour-by", "x", "-o", "a.glb", words=["--colour-by", "folder"])


class Source(Folder):
    """source.json: where the field is, and that it is still what it was. By animate; view reads the same."""

    SHOW = ("animate", "tracks", "-o", "a.pvd")

    def test_both_may_move_together_and_be_named_from_anywhere(self):
        (self.folder / "data").mkdir()
        (self.folder / "blobs.nrrd").rename(self.folder / "data/blobs.nrrd")
        self.track(field="data/blobs.nrrd", folder="runs/tracks")
        (self.folder / "study").mkdir()
        for name in ("data", "runs"):
            (self.folder / name).rename(self.folder / "study" / name)
        self.ok("animate", "study/runs/tracks", "-o", "a.pvd")
        os.chdir(self.folder / "study/runs/tracks")
        self.ok("animate", ".", "-o", "../a.pvd")
        os.chdir(self.folder)
        (self.folder / "elsewhere").symlink_to("study/runs/tracks")
        self.ok("animate", "elsewhere", "-o", "a.pvd")

    def test_a_field_that_moved_is_named_after_the_folder(self):
        self.track()
        (self.folder / "blobs.nrrd").rename(self.folder / "moved.nrrd")
        self.assert_refused(2, *self.SHOW, words=["blobs.nrrd", "hyperiso animate tracks FIELD"])
        self.ok("animate", "tracks", "moved.nrrd", "-o", "a.pvd")
        self.assert_refused(2, "animate", "moved.nrrd", "tracks", "--iso", "0.5", "-o", "a.pvd")

    def test_a_name_that_is_not_utf_8(self):
        name = os.fsdecode(b"bl\xf6bs.nrrd")
        (self.folder / "blobs.nrrd").rename(self.folder / name)
        run = subprocess.run([PROGRAM, "track", name, "--iso", "0.5", "-o", "tracks"], capture_output=True, check=False)
        self.assertEqual((run.returncode, run.stderr), (0, b""))
        self.assert_refused(2, *self.SHOW, words=["FIELD"])
        run = subprocess.run([PROGRAM, "animate", "tracks", name, "-o", "a.pvd"], capture_output=True, check=False)
        self.assertEqual((run.returncode, run.stderr), (0, b""))

    def test_a_field_in_several_files(self):
        for step in range(3):
            self.ok("convert", "blobs.nrrd", "--steps", f"{step}:{step + 1}", "-o", f"step{step}.npy")
            data = (self.folder / f"step{step}.npy").read_bytes()
            (self.folder / f"step{step}.npy").write_bytes(data.replace(b"(1, 10, 11, 12)", b"(10, 11, 12)   "))
        self.ok("track", *(f"step{step}.npy" for step in range(3)), "--iso", "0.5", "-o", "tracks")
        self.assertEqual(self.ok(*self.SHOW, "--json").json()["frames"], 3)

    def test_a_field_that_changed_is_noticed(self):
        self.track()
        self.sample("gaussians", "12,11,9,6", "blobs.nrrd")
        self.assert_refused(2, *self.SHOW, words=["blobs.nrrd", "12 x 11 x 9 x 6", "12 x 11 x 10 x 6", "again"])
        self.sample("gaussians", "12,11,10,6", "blobs.nrrd", "--type", "f64")
        self.assert_refused(2, *self.SHOW, words=["f64", "f32"])
        self.sample("torus-morph", "12,11,10,6", "blobs.nrrd")
        self.assert_refused(2, *self.SHOW, words=["again"])
        self.sample("gaussians", "12,11,10,6", "blobs.nrrd")
        self.ok(*self.SHOW)
        data = bytearray((self.folder / "blobs.nrrd").read_bytes())
        data[-4 * 12 * 11 * 5:] = bytes(4 * 12 * 11 * 5)  # half of the last step
        (self.folder / "blobs.nrrd").write_bytes(data)
        self.assert_refused(2, *self.SHOW, words=["tracks.csv", "again"])

    def test_a_table_that_changed_is_noticed(self):
        self.track()
        table = self.folder / "tracks/tracks.csv"
        table.write_text(table.read_text().replace("merge", "death"))
        self.assert_refused(2, *self.SHOW, words=["tracks.csv", "again"])
        table.unlink()
        self.assert_refused(2, *self.SHOW, words=["tracks.csv"])

    def test_options_that_say_otherwise_are_refused_and_those_that_say_the_same_are_not(self):
        self.track("--iso", "0.5", "--steps", "1:")
        for options, words in [(["--iso", "0.6"], ["--iso", "0.5"]), (["--steps", "2:"], ["--steps", "1:"]),
                               (["--method", "simplicial"], ["hull"]), (["--inside", "below"], ["above"]),
                               (["--crop", "1:"], ["without --crop"]), (["--big-endian"], ["--big-endian"]),
                               (["--time-axis", "1"], ["--time-axis"])]:
            self.assert_refused(2, *self.SHOW, *options, words=["tracks", *words])
        self.ok(*self.SHOW, "--iso", "0.5", "--steps", "1:", "--method", "hull", "--tracks", "--precision", "f64")

    def test_what_one_surface_does_not_show_is_refused_with_what_would_work(self):
        for options, words in [(["--range", "0.3:0.6"], ["0.3:0.6", "two surfaces", "--iso", "tracks.pvd"]),
                               (["--iso", "0.5", "--select", "all:0"], ["--select"])]:
            self.track(folder="all")
            self.track(*options)
            self.assert_refused(2, *self.SHOW, words=["tracks", *words])

    def test_other_folders_are_none_of_tracks(self):
        (self.folder / "tracks").mkdir()
        self.assert_refused(2, *self.SHOW, words=["tracks", "source.json", "hyperiso track"])

    def test_other_verbs_say_what_it_is(self):
        self.track()
        for verb in (["info"], ["extract", "--iso", "0.5"]):
            self.assert_refused(2, verb[0], "tracks", *verb[1:], words=["tracks: is a folder"])

    # Whatever stands there, the answer is one line.
    def test_a_source_that_was_cut_or_edited(self):
        self.track()
        whole = (self.folder / "tracks/source.json").read_text()
        for length in {*range(0, len(whole) - 2, 37), len(whole) - 3}:
            (self.folder / "tracks/source.json").write_text(whole[:length])
            self.assert_refused(2, *self.SHOW, words=["source.json"])
        for text in ("[]", "1", "\0", '{"version": 1}', '{"version": "1"}', "[" * 5000):
            (self.folder / "tracks/source.json").write_text(text)
            self.assert_refused(2, *self.SHOW, words=["source.json"])
        for member in set(json.loads(whole)) - {"files"}:  # which only the next run of track reads
            for value in (None, [], {}, "0", 7, [7], {"--iso": 0.5}, {"--colour": "red"}, {"size": 1}):
                if value == json.loads(whole)[member]:
                    continue
                (self.folder / "tracks/source.json").write_text(whole)
                self.edit(lambda source, member=member, value=value: source.update({member: value}))
                self.assert_refused(2, *self.SHOW)
        (self.folder / "tracks/source.json").write_text(whole)
        self.edit(lambda source: source["options"].update({"--iso": "half"}))
        self.assert_refused(2, *self.SHOW, words=["--iso", "half"])

    def test_a_later_version_is_named(self):
        self.track()
        self.edit(lambda source: source.update(version=2))
        self.assert_refused(2, *self.SHOW, words=["source.json", "version 2", "version 1"])

    def test_tracking_again_replaces_it(self):
        self.track()
        self.track("--iso", "0.4")
        self.assertEqual(json.loads((self.folder / "tracks/source.json").read_text())["options"]["--iso"], "0.4")
        self.ok(*self.SHOW, "--iso", "0.4")

    def test_no_list_of_files_leads_out_of_the_folder(self):
        self.track()
        for files in (["../blobs.nrrd", "..", ".", "", 7, None, "/", "deep/a"], None, 7, {"a": "../blobs.nrrd"}):
            self.edit(lambda source, files=files: source.update(files=files))
            (self.folder / "tracks/deep").mkdir(exist_ok=True)
            (self.folder / "tracks/deep/a").write_text("")
            self.track()
            self.assertTrue((self.folder / "blobs.nrrd").exists() and (self.folder / "tracks/deep/a").exists())


if __name__ == "__main__":
    unittest.main()
