"""view: pages.

    test_cli_view.py PROGRAM
"""

import json
import re
import time
import unittest

from cli_case import Case, HAS_VIEW, Run, WATER


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
        self.assert_refused(2, "view", WATER, "--iso", "0.5", "--payload", "field", "--max-size", "700k", "-o", "b.html",
                            words=["would be larger than", "higher limit"])
        self.assert_refused(2, "view", WATER, "--iso", "0.5", "--payload", "field", "--max-size", "100k", "-o", "b.html",
                            words=["viewer alone", "100 KiB"])
        self.assertFalse((self.folder / "b.html").exists())

    def test_space_alone_and_two_axes_of_space_with_time(self):
        for dims in ("12,12,12", "12,12,12,5"):
            self.sample("ball", dims, "ball.nrrd")
            self.ok("view", "ball.nrrd", "--iso", "0.5", "-o", "ball.html")
            self.assertEqual(self.metadata("ball.html")["dimension"], dims.count(",") + 1)

    def test_one_step_is_the_surface_that_it_has_in_space(self):
        step = ("--steps", "3:4", "--iso", "0.5")
        found = {}
        for payload in ("mesh", "band", "field") if self.has_field_pages() else ("mesh",):
            run = self.ok("view", WATER, *step, "--payload", payload, "-o", "a.html", "--json").json()
            page = self.metadata("a.html")
            self.assertEqual((page["dimension"], page["time"], page["part"], run["dimension"]), (3, False, "t = 0.075", 3))
            found[payload] = (run["vertices"], run["simplices"])
        extracted = self.ok("extract", WATER, *step, "--json").json()
        self.assertEqual(set(found.values()), {(extracted["vertices"], extracted["simplices"])})
        # A plane of the volume through time, read step by step where memory is short, too.
        plane = ("--crop", "0:24,3:4", "--iso", "0.5", "--payload", "mesh")
        self.ok("view", WATER, *plane, "-o", "plane.html")
        page = self.metadata("plane.html")
        self.assertEqual((page["dimension"], page["time"], [axis["name"] for axis in page["axes"]]), (3, True, ["x", "z", "t"]))
        self.assertTrue(page["part"].startswith("y = 0.14"), page["part"])
        self.ok("view", WATER, "--iso", "0.5", "-o", "whole.html")
        self.assertEqual(self.metadata("whole.html")["part"], "")
        self.assert_refused(2, "view", WATER, *step, "--track", "-o", "b.html", words=["one step", "two or more"])
        self.assert_refused(2, "view", WATER, *step, "--crop", "0:24,3:4", "-o", "b.html", words=["2 dimensions", "one sample"])

    def test_without_a_program_that_opens_pages_it_is_written_and_that_is_said(self):
        field = self.sample()
        (self.folder / "bin").mkdir()
        command = ("view", field, "--iso", "0.5", "--open", "-o", "a.html")
        run = Run(*command, env={"PATH": str(self.folder / "bin")})
        self.assertEqual(run.code, 0)
        self.assertRegex(run.err, r"\Ahyperiso: warning: --open: .*xdg-open.*a\.html in a browser\n\Z")
        self.assertTrue((self.folder / "a.html").exists())
        self.assertEqual(Run(*command, "--quiet", env={"PATH": str(self.folder / "bin")}).err, "")
        opener = self.folder / "bin" / "xdg-open"
        opener.write_text('#!/bin/sh\necho "$1" >opening && mv opening opened\n')
        opener.chmod(0o755)
        self.ok(*command, env={"PATH": f"{self.folder}/bin:/usr/bin:/bin"})
        end = time.monotonic() + 20  # it is not waited for
        while not (self.folder / "opened").exists() and time.monotonic() < end:
            time.sleep(0.01)
        self.assertEqual((self.folder / "opened").read_text().strip(), str(self.folder.resolve() / "a.html"))

    def test_wrong_usage(self):
        field = self.sample()
        self.assert_refused(2, "view", field, "-o", "a.html", words=["--iso"])
        self.assert_refused(2, "view", field, "--iso", "0.5", words=["output"])
        self.assert_refused(2, "view", field, "--iso", "0.5", "-o", "a.glb", words=["a.glb", ".html"])
        self.assert_refused(2, "view", field, "--iso", "0.5,0.6", "-o", "a.html", words=["one isovalue"])
        self.assert_refused(2, "view", field, "--iso", "0.5", "--max-size", "many", "-o", "a.html", words=["--max-size"])
        self.assert_refused(2, "view", field, "--iso", "0.5", "--payload", "net", "-o", "a.html", words=["mesh, band and field"])
        self.assert_refused(2, "view", field, "--iso", "0.5", "--payload", "band", "--method", "barycentric", "-o", "a.html",
                            words=["barycentric"])
        self.assert_refused(2, "view", field, "--iso", "0.5", "--colour-by", "bogus", "-o", "a.html",
                            words=["'bogus'", "solid, component"])
        self.sample("ball", "4,4", "two.nrrd")
        self.assert_refused(2, "view", "two.nrrd", "--iso", "0.5", "-o", "a.html", words=["3 to 4"])
        self.ok("extract", field, "--iso", "0.5", "-o", "mesh.vtu")
        self.assert_refused(2, "view", "mesh.vtu", "--iso", "0.5", "-o", "a.html", words=["--iso"])
        self.assert_refused(2, "view", "mesh.vtu", "--track", "-o", "a.html", words=["--track"])
        self.assert_refused(2, "view", "mesh.vtu", "--payload", "field", "-o", "a.html", words=["no samples"])
        self.assert_refused(1, "view", field, "--iso", "0.5", "-o", "no/such/folder/a.html", words=["folder"])


if __name__ == "__main__":
    unittest.main()
