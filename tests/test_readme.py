"""What README.md shows must work: its commands run, and its C++ example is the one that tests/install builds.

    test_readme.py PROGRAM
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).parent.parent
PROGRAM = Path(sys.argv.pop(1))


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```$", (ROOT / "README.md").read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)


class Readme(unittest.TestCase):
    def test_commands_run_in_their_order(self):
        commands = [line for block in blocks("sh") for line in block.splitlines()]
        if b"\n  view " not in subprocess.run([PROGRAM, "--help"], capture_output=True, check=True).stdout:
            commands = [command for command in commands if not command.startswith("hyperiso view ")]  # built without
        if b"was built without pictures" in subprocess.run(
                [PROGRAM, "animate", "none", "--frames", "1", "-o", "none.mp4"], capture_output=True, check=False).stderr \
                or not shutil.which("ffmpeg"):
            commands = [command for command in commands if ".mp4" not in command]
        self.assertGreater(len(commands), 0)
        path = f"{PROGRAM.parent}{os.pathsep}{os.environ['PATH']}"
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "examples").symlink_to(ROOT / "examples")
            for command in commands:
                command = command.replace(".mp4", ".mp4 --size 320x180")  # seconds of drawing
                run = subprocess.run(command, shell=True, cwd=folder, env={**os.environ, "PATH": path},
                                     capture_output=True, text=True, check=False)
                self.assertEqual(run.returncode, 0, f"{command}\n{run.stderr}")
                self.assertEqual(run.stderr, "", command)

    def test_example_is_the_one_that_is_built_and_run(self):
        self.assertEqual(blocks("cpp"), [(ROOT / "tests/install/main.cpp").read_text(encoding="utf-8")])


if __name__ == "__main__":
    unittest.main()
