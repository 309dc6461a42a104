"""tools/check_layers on small trees made here: it must pass what is allowed and name what is not."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

TOOL = Path(__file__).parent.parent / "tools" / "check_layers"


def check(files):
    """Runs the tool on a tree of {path: content}; returns its exit code and what it printed."""
    with tempfile.TemporaryDirectory() as root:
        (Path(root) / "src").mkdir()
        for path, content in files.items():
            file = Path(root) / path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(content)
        run = subprocess.run([sys.executable, TOOL, root], capture_output=True, text=True, check=False)
        return run.returncode, run.stdout


class CheckLayers(unittest.TestCase):
    def assert_refused(self, files, *words):
        code, printed = check(files)
        self.assertEqual(code, 1, printed)
        self.assertEqual(printed.count("\n"), 1, printed)
        for word in words:
            self.assertIn(word, printed)

    def assert_passes(self, files):
        self.assertEqual(check(files), (0, ""))

    def test_own_folder_and_arrows(self):
        self.assert_passes({"src/core/a.hpp": "", "src/mesh/b.hpp": '#include "core/a.hpp"\n',
                            "src/mesh/c.cpp": '#include "mesh/b.hpp"\n#include <vector>\n'})

    def test_arrows_are_transitive(self):
        self.assert_passes({"src/core/a.hpp": "", "src/slice/b.cpp": '#include "core/a.hpp"\n'})

    def test_backward_include_is_named_with_file_and_line(self):
        self.assert_refused({"src/io/a.hpp": "", "src/core/b.cpp": '// why\n#include "io/a.hpp"\n'},
                            "src/core/b.cpp:2: core may not include io")

    def test_include_by_relative_path_is_no_way_around(self):
        self.assert_refused({"src/io/a.hpp": "", "src/core/b.cpp": '#include "../io/a.hpp"\n'}, "core may not include io")

    def test_include_of_a_public_header_counts_as_its_folder(self):
        for quoted in ('"hyperiso/io.hpp"', "<hyperiso/io.hpp>"):
            self.assert_refused({"include/hyperiso/io.hpp": "", "src/mesh/b.cpp": f"#include {quoted}\n"},
                                "src/mesh/b.cpp:1: mesh may not include io")

    def test_public_headers_are_checked_too(self):
        self.assert_refused({"include/hyperiso/mesh.hpp": '#include "hyperiso/extract.hpp"\n',
                             "include/hyperiso/extract.hpp": ""},
                            "include/hyperiso/mesh.hpp:1: mesh may not include extract")

    def test_tables_and_meshes_never_see_a_field(self):
        for folder in ("table", "mesh"):
            self.assert_refused({"include/hyperiso/field.hpp": "",
                                 f"src/{folder}/b.cpp": '#include "hyperiso/field.hpp"\n'}, "never sees a field")

    def test_spaces_do_not_hide_an_include(self):
        self.assert_refused({"src/io/a.hpp": "", "src/core/b.cpp": '  #  include  "io/a.hpp"\n'}, "core may not include io")

    def test_unknown_folder_says_where_to_add_it(self):
        self.assert_refused({"src/new/a.cpp": ""}, "src/new is unknown", "ARROWS of tools/check_layers")

    def test_unknown_public_header_says_where_to_add_it(self):
        self.assert_refused({"include/hyperiso/new.hpp": ""}, "HEADERS of tools/check_layers")

    def test_file_outside_the_folders(self):
        self.assert_refused({"src/a.cpp": ""}, "belongs in a folder")

    def test_quoted_include_that_is_nowhere(self):
        self.assert_refused({"src/core/b.cpp": '#include "zlib.h"\n'}, "src/core/b.cpp:1", "use <>")


if __name__ == "__main__":
    unittest.main()
