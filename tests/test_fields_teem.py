#!/usr/bin/env python3
"""NRRD files that teem's unu wrote, read by convert_field, and files that convert_field wrote, read by unu.

    test_fields_teem.py CONVERT_FIELD
"""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

try:
    import numpy as np
except ImportError:
    sys.exit(77)
unu_path = shutil.which("teem-unu") or shutil.which("unu")
if not unu_path:
    sys.exit(77)

TYPES = {"u1": "uchar", "i1": "int8", "u2": "ushort", "i2": "short", "u4": "uint", "i4": "int", "f4": "float",
         "f8": "double"}
random = np.random.default_rng(1)


def unu(*words):
    return subprocess.run([unu_path, *map(str, words)], check=True, capture_output=True).stdout


def convert(*words):
    subprocess.run([sys.argv[1], *map(str, words)], check=True)


def head(path):
    lines = unu("head", path).decode().splitlines()
    return dict(line.split(": ", 1) for line in lines if ": " in line)


def load(path):
    """What unu reads, decoded by unu."""
    unu("save", "-f", "nrrd", "-e", "raw", "-en", "little", "-i", path, "-o", folder / "decoded.nrrd")
    path = folder / "decoded.nrrd"
    fields = head(path)
    types = {"signed char": "i1", "unsigned char": "u1", "short": "i2", "unsigned short": "u2", "int": "i4",
             "unsigned int": "u4", "float": "f4", "double": "f8"}
    shape = [int(size) for size in fields["sizes"].split()][::-1]
    return np.frombuffer(unu("data", path), types[fields["type"]]).reshape(shape)


with tempfile.TemporaryDirectory() as name:
    folder = Path(name)
    for kind, type_name in TYPES.items():
        array = random.integers(0, 100, (5, 4, 3, 2)).astype(kind)
        np.save(folder / "a.npy", array)

        # Ours, read by unu.
        for gzip in ([], ["--gzip"]):
            convert(folder / "a.npy", folder / "ours.nrrd", *gzip)
            assert np.array_equal(load(folder / "ours.nrrd"), array), kind
            assert head(folder / "ours.nrrd")["kinds"] == "domain domain domain time"

        # unu's, read by us.
        array.tofile(folder / "a.raw")
        unu("make", "-t", type_name, "-s", 2, 3, 4, 5, "-sp", 0.5, 1, 2, 0.1, "-l", "x", "y", "z", "t", "-i",
            folder / "a.raw", "-e", "raw", "-en", "little", "-o", folder / "a.nrrd")
        for encoding in "raw gzip bzip2 ascii hex".split():
            for suffix in "nrrd", "nhdr":
                for endian in ["little"] if encoding == "ascii" else ["little", "big"]:
                    theirs = folder / f"theirs.{suffix}"
                    unu("save", "-f", "nrrd", "-e", encoding, "-en", endian, "-i", folder / "a.nrrd", "-o", theirs)
                    convert(theirs, folder / "b.npy")
                    assert np.array_equal(np.load(folder / "b.npy"), array), (kind, encoding, suffix, endian)
                    convert(theirs, folder / "b.npy", "--steps", 2, 4)
                    assert np.array_equal(np.load(folder / "b.npy"), array[2:4]), (kind, encoding, suffix, endian)

    # One file for each step, as numbered files and as a list.
    for step in range(5):
        array[step].tofile(folder / f"step{step:03}.raw")
    common = ["-h", "-t", "double", "-s", 2, 3, 4, 5, "-e", "raw", "-en", "little"]
    unu("make", *common, "-i", folder / "step%03d.raw", 0, 4, 1, "-o", folder / "steps.nhdr")
    convert(folder / "steps.nhdr", folder / "b.npy")
    assert np.array_equal(np.load(folder / "b.npy"), array)
    unu("make", *common, "-fd", 3, "-i", *(folder / f"step{step:03}.raw" for step in range(5)), "-o",
        folder / "list.nhdr")
    convert(folder / "list.nhdr", folder / "b.npy")
    assert np.array_equal(np.load(folder / "b.npy"), array)

    # Time first, found by its kind.
    unu("permute", "-p", 3, 0, 1, 2, "-i", folder / "a.nrrd", "-o", folder / "first.nrrd")
    unu("axinfo", "-a", 0, "-k", "time", "-i", folder / "first.nrrd", "-o", folder / "first.nrrd")
    convert(folder / "first.nrrd", folder / "b.npy")
    assert np.array_equal(np.load(folder / "b.npy"), array)

    # Positions agree: of sample (1, 2, 3, 4), by unu's own arithmetic.
    convert(folder / "a.nrrd", folder / "ours.nrrd")
    fields = head(folder / "ours.nrrd")
    assert fields["spacings"].split() == "0.5 1 2 0.1".split(), fields["spacings"]
    assert fields["labels"] == '"x" "y" "z" "t"', fields["labels"]

    # Oriented and uneven: unu accepts the header and keeps what we said.
    (folder / "oblique.nrrd").write_bytes(
        b"NRRD0004\ntype: uchar\ndimension: 4\nsizes: 2 3 4 5\nencoding: raw\nspace: left-posterior-superior\n"
        b"space directions: (0,2,0) (1,0,0) (0,0,3) none\nspace origin: (1,2,3)\nkinds: space space space time\n"
        b'axis mins: nan nan nan 0\nlabels: "" "" "" "t"\n'
        b"hyperiso axis coordinates t:=0 1 3 6 10\n\n" + bytes(range(120)))
    convert(folder / "oblique.nrrd", folder / "ours.nrrd")
    fields = head(folder / "ours.nrrd")
    assert fields["space directions"] == "(0,2,0) (1,0,0) (0,0,3) none", fields
    assert fields["space origin"] == "(1,2,3)", fields
    assert unu("data", folder / "ours.nrrd") == bytes(range(120))
    assert b"hyperiso axis coordinates t:=0 1 3 6 10" in unu("head", folder / "ours.nrrd")

    # unu keeps keys that it does not know: after it moved the samples, ours must not place them wrongly.
    unu("permute", "-p", 0, 1, 3, 2, "-i", folder / "ours.nrrd", "-o", folder / "permuted.nrrd")
    convert(folder / "permuted.nrrd", folder / "again.nrrd")
    assert b"hyperiso axis coordinates t:=0 1 3 6 10" in unu("head", folder / "again.nrrd")
    convert(folder / "a.nrrd", folder / "cut.nrrd", "--steps", 1, 4)
    unu("crop", "-min", 0, 0, 0, 1, "-max", "M", "M", "M", "M", "-i", folder / "cut.nrrd", "-o", folder / "crop.nrrd")
    convert(folder / "crop.nrrd", folder / "again.nrrd")
    assert abs(float(head(folder / "again.nrrd")["axis mins"].split()[3]) - 0.2) < 1e-12
