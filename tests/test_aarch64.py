"""The engine compiles for AArch64 without a warning, and its words of bits are vectors (NEON) there.

Guards the path that x86 builds never take. Skipped without a cross compiler (Debian: g++-aarch64-linux-gnu).
"""

import re
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
COMPILER = shutil.which("aarch64-linux-gnu-g++")
FLAGS = ["-std=c++20", "-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Werror", "-I", ROOT / "include", "-I", ROOT / "src"]


def compiled(*arguments, text=None):
    done = subprocess.run([COMPILER, *map(str, FLAGS), *map(str, arguments)], input=text, capture_output=True, text=True,
                          check=False)
    return done.returncode, done.stdout, done.stderr


class Aarch64(unittest.TestCase):
    def test_engine_compiles(self):
        for file in ("kernels/kernels_baseline.cpp", "kernels.cpp", "engine.cpp", "extract.cpp"):
            code, _, errors = compiled("-fsyntax-only", ROOT / "src/extract" / file)
            self.assertEqual((code, errors), (0, ""), file)

    def test_words_are_vectors(self):
        code, assembly, errors = compiled(
            "-O2", "-S", "-o", "-", "-x", "c++", "-",
            text='#include "extract/kernels/words.hpp"\n'
                 "void crossed(const std::uint64_t* a, const std::uint64_t* b, std::uint64_t* c) {\n"
                 "  using namespace hyperiso;\n"
                 "  store_words(c, load_words(a) ^ load_words(b));\n"
                 "  (void)list_nonzero, (void)following, (void)write_bit_numbers;\n"
                 "}\n")
        self.assertEqual((code, errors), (0, ""))
        self.assertRegex(assembly, re.compile(r"^\s+eor\s+v\d+\.16b", re.MULTILINE))


if __name__ == "__main__":
    if not COMPILER:
        print("skipped: there is no aarch64-linux-gnu-g++", file=sys.stderr)
        sys.exit(77)
    unittest.main()
