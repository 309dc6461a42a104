#!/usr/bin/env python3
"""Arrays that NumPy saved, through convert_field, to arrays that NumPy loads.

    test_fields_numpy.py CONVERT_FIELD
"""

import subprocess
import sys
import tempfile
from pathlib import Path

try:
    import numpy as np
except ImportError:
    sys.exit(77)

convert = sys.argv[1]
random = np.random.default_rng(1)

with tempfile.TemporaryDirectory() as name:
    folder = Path(name)
    for kind in "u1 i1 u2 i2 u4 i4 f4 f8".split():
        for order in "<>":
            # Every bit pattern of the type may occur: NaN payloads must come through as well.
            array = random.integers(0, 256, (5, 4, 3, 2 * int(kind[1])), dtype=np.uint8).view(order + kind)
            for saved in (array, np.asfortranarray(array), array[:, :, :, :1], array[0, 0, 0]):
                np.save(folder / "in.npy", saved)
                subprocess.run([convert, folder / "in.npy", folder / "out.npy"], check=True)
                loaded = np.load(folder / "out.npy")
                # In Fortran order the first index is the fastest, and becomes the last of an array in C order.
                in_fortran_order = saved.flags.f_contiguous and not saved.flags.c_contiguous
                expected = saved.T if in_fortran_order else saved
                assert loaded.shape == expected.shape, (loaded.shape, expected.shape)
                assert loaded.dtype == np.dtype(kind), loaded.dtype
                assert loaded.tobytes() == expected.astype(kind, copy=False).tobytes() or np.array_equal(
                    loaded, expected, equal_nan=kind[0] == "f"), (kind, order)
            subprocess.run([convert, folder / "in.npy", folder / "part.npy", "--steps", "1", "2"], check=True)
            assert np.load(folder / "part.npy").tobytes() == np.load(folder / "out.npy")[1:2].tobytes()
    np.save(folder / "in.npy", np.array([[True, False], [False, True]]))
    subprocess.run([convert, folder / "in.npy", folder / "out.npy"], check=True)
    assert np.load(folder / "out.npy").tolist() == [[1, 0], [0, 1]]
    for unreadable in (np.zeros((2, 2), "i8"), np.zeros((2, 2), "c8"), np.zeros((2, 2), "f2")):
        np.save(folder / "in.npy", unreadable)
        result = subprocess.run([convert, folder / "in.npy", folder / "none.npy"], capture_output=True, text=True)
        assert result.returncode == 1 and "in.npy" in result.stderr, result
        assert not (folder / "none.npy").exists()
