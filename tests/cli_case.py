"""What the tests of the program share: a run of it, and cases in an empty folder. Takes PROGRAM from the command line."""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
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

    def beside_the_program(self, field, kibibytes):
        """--memory for that much beside what the program itself holds, which differs from system to system."""
        held = re.search(r"holds ([0-9.]+) ([KM])iB", Run("extract", field, "--iso", "0.5", "--memory", "1K").err)
        return "--memory", f"{int(float(held[1]) * {'K': 1, 'M': 1024}[held[2]]) + kibibytes}K"

    def sample(self, name="ball", dims="12,12,12", path="field.nrrd", *options):
        self.ok("sample", name, "--dims", dims, "-o", path, *options)
        return path
