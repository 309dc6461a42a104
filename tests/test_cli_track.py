"""track: components through time.

    test_cli_track.py PROGRAM
"""

import unittest

from cli_case import Case


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


if __name__ == "__main__":
    unittest.main()
