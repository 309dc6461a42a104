"""track: components through time.

    test_cli_track.py PROGRAM
"""

import os
import resource
import signal
import subprocess
import time
import unittest

from cli_case import Case, PROGRAM


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
            again = self.ok("track", "--select", f"all:{track['id']}", "--json").json()
            self.assertEqual(again["events"], found["events"])
        self.assert_refused(2, "track", "--iso", "0.5", words=["INPUT", "--select"])
        self.assert_refused(2, "track", "--select", "all:0", "--iso", "0.4", words=["--iso", "0.5"])
        self.assert_refused(2, "track", "--select", "all:99", words=["99"])
        self.assert_refused(2, "track", "--select", "examples:0", words=["examples", "source.json"])
        self.sample("gaussians", "16,16,16,8")
        self.assert_refused(2, "track", "--select", "all:0", words=["16 x 16 x 16 x 9", "again"])
        self.sample("gaussians", "16,16,16,9")
        self.assert_refused(2, *run, "--select", "all", words=["FOLDER:ID"])
        self.assert_refused(2, *run, "--select", "all:99", words=["99"])
        self.assert_refused(2, *run, "--select", "none:0", words=["none/tracks.csv"])
        self.assert_refused(2, *run, "--select", "all:0", "--track", "region", words=["surfaces"])

    def test_what_a_slab_of_noise_holds_counts(self):
        """Found while the slab is passed, as it is not known before: at once, not minutes later."""
        path = self.sample("noise", "40,40,40,2")
        memory = self.beside_the_program(path, 8 << 10)
        self.assert_refused(1, "track", path, "--iso", "0.5", *memory, "-o", "tracks", words=["8 MiB", "--memory"])
        self.assertEqual(self.files(), ["field.nrrd"])

    # Of noise the pictures would take hundreds of megabytes.
    def test_pictures_show_the_largest_of_many(self):
        path = self.sample("noise", "64,64,24")
        count = len(self.ok("track", path, "--iso", "0.8", "-o", "tracks", "--json").json()["tracks"])
        self.assertGreater(count, 2000)
        graph = (self.folder / "tracks/graph.svg").read_text()
        self.assertEqual(graph.count("<title>track "), 2000)
        self.assertIn(f"2000 tracks, isovalue 0.8 ({count - 2000} more simplified or smaller)", graph)
        self.assertLessEqual((self.folder / "tracks/volume.svg").read_text().count("<title>track "), 2000)

    def test_fields_of_too_many_or_too_few_axes(self):
        path = self.sample("ball", "6,6,6,5,4")
        self.assert_refused(2, "track", path, "--iso", "0.5", words=["6 x 6 x 6 x 5 x 4", "--crop ,,,0:1"])
        self.ok("track", path, "--iso", "0.5", "--crop", ",,,2:3", "-o", "tracks")
        self.assert_refused(2, "track", self.sample("ball", "9,9"), "--iso", "0.5", words=["9 x 9"])

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


class Folder(Case):
    """What -o names: a folder that is new, empty, or of an earlier run; written whole or not at all."""

    def setUp(self):
        super().setUp()
        self.run_of = ("track", self.sample("gaussians", "12,12,12,9"), "--iso", "0.5")

    def names(self, folder="tracks"):
        return sorted(os.listdir(folder))

    def test_it_is_not_the_name_of_a_file(self):
        for name in ("tracks.csv", "deep/er/tracks.vtu"):
            self.assert_refused(2, *self.run_of, "-o", name, words=["folder", "such as " + name[:-4]])
        self.assert_refused(2, *self.run_of, "-o", "field.nrrd")
        (self.folder / "notes").write_text("")
        self.assert_refused(2, *self.run_of, "-o", "notes", words=["notes is a file"])
        self.assert_refused(1, *self.run_of, "-o", "notes/tracks", words=["notes"])
        self.assertEqual(self.files(), ["field.nrrd", "notes"])
        for name in ("run.of.2026", "at 0.5", "deep/er/"):
            self.ok(*self.run_of, "-o", name)
            self.assertIn("tracks.csv", self.names(name))
        (self.folder / "folder.csv").mkdir()
        self.ok(*self.run_of, "-o", "folder.csv")

    def test_files_of_others_are_left_alone(self):
        other = self.folder / "tracks"
        other.mkdir()
        (other / ".hidden").write_text("")
        (other / "tracks.csv").write_text("my own")
        (other / "zebra").write_text("")
        self.assert_refused(2, *self.run_of, "-o", "tracks", words=["tracks.csv", "tracks/tracks"])
        self.assertEqual((other / "tracks.csv").read_text(), "my own")
        (other / "source.json").write_text("{}")
        self.assert_refused(2, *self.run_of, "-o", "tracks")
        for name in ("tracks.csv", "zebra", "source.json"):
            (other / name).unlink()
        self.ok(*self.run_of, "-o", "tracks")
        (other / "notes.txt").write_text("to keep")
        self.ok(*self.run_of, "-o", "tracks")
        self.assertIn("notes.txt", self.names())
        self.ok(*self.run_of, "--steps", "0:4", "-o", "tracks")
        (other / "surface_0008.vtp").write_text("my own") # a name that a longer run has
        self.assert_refused(2, *self.run_of, "-o", "tracks", words=["surface_0008.vtp"])
        self.assertEqual((other / "surface_0008.vtp").read_text(), "my own")
        self.assertNotIn("surface_0007.vtp", self.names())

    # Else a series would go on into surfaces of a longer run.
    def test_what_an_earlier_run_left_is_replaced_whole(self):
        self.ok(*self.run_of, "-o", "first")
        self.ok(*self.run_of, "-o", "tracks")
        self.assertIn("surface_0008.vtp", self.names())
        for options in (["--steps", "0:4"], ["--track", "region"], ["--select", "first:0"]):
            self.ok(*self.run_of, *options, "-o", "tracks")
            self.ok(*self.run_of, *options, "-o", "new")
            self.assertEqual(self.names(), self.names("new"), options)
            (self.folder / "new/source.json").unlink()
            for name in self.names("new"):
                (self.folder / "new" / name).unlink()

    def test_the_folder_that_is_read_stays(self):
        self.ok(*self.run_of, "-o", "tracks")
        before = (self.folder / "tracks/source.json").read_bytes()
        for name in ("tracks", "./tracks/"):
            self.assert_refused(2, "track", "--select", "tracks:0", "-o", name, words=["--select"])
        self.assertEqual((self.folder / "tracks/source.json").read_bytes(), before)

    # Told before the field is read.
    def test_a_folder_that_cannot_be_made(self):
        self.assert_refused(1, "track", "no such field.nrrd", "--iso", "0.5", "-o", "/proc/tracks", words=["/proc/tracks"])
        if os.getuid() != 0:
            (self.folder / "closed").mkdir(mode=0o500)
            self.assert_refused(1, *self.run_of, "-o", "closed/tracks", words=["closed/tracks"])
            self.assert_refused(1, *self.run_of, "-o", "closed", words=["closed"])
            self.assert_refused(1, "extract", "no such field.nrrd", "--iso", "0.5", "-o", "closed/a.ply", words=["closed/a.ply"])

    # A full disk, as far as a test can have one.
    def test_a_file_that_does_not_fit(self):
        self.ok(*self.run_of, "-o", "old")
        before = {name: (self.folder / "old" / name).read_bytes() for name in self.names("old")}
        for folder in ("old", "new/tracks"):
            self.assert_refused(1, "track", "field.nrrd", "--iso", "0.4", "-o", folder, words=["cannot write"],
                                preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (4000, 4000)))
        self.assertEqual({name: (self.folder / "old" / name).read_bytes() for name in self.names("old")}, before)
        self.assertEqual(self.files(), ["field.nrrd", "old"])

    def test_ctrl_c_while_writing_leaves_nothing(self):
        self.sample("gaussians", "10,10,10,2000", "long.nrrd")  # seconds of files
        for folder, files in (("new/tracks", ["field.nrrd", "long.nrrd"]), ("old", ["field.nrrd", "long.nrrd", "old"])):
            if folder == "old":
                self.ok(*self.run_of, "-o", "old")
            before = self.names("old") if folder == "old" else []
            with subprocess.Popen([PROGRAM, "track", "long.nrrd", "--iso", "0.5", "-o", folder], stdout=subprocess.PIPE) as run:
                while run.poll() is None and not (os.path.isdir(folder) and len(self.names(folder)) > len(before) + 20):
                    time.sleep(0.001)
                run.send_signal(signal.SIGINT)
                self.assertEqual((run.wait(), run.stdout.read()), (130, b""))
            self.assertEqual(self.files(), files)
            if before:
                self.assertEqual(self.names("old"), before)


if __name__ == "__main__":
    unittest.main()
