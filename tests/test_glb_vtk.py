"""The .glb that `hyperiso animate` writes, read by VTK: one frame is there at every moment.

    test_glb_vtk.py PROGRAM
"""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

try:
    import vtkmodules.vtkCommonDataModel  # the blocks that the reader gives
    from vtkmodules.vtkIOGeometry import vtkGLTFReader
except ImportError:
    print("VTK's Python modules are missing (Debian: python3-vtk9)")
    sys.exit(77)

PROGRAM = Path(sys.argv.pop(1)).resolve()


def parts(block):
    """The meshes in a tree of blocks."""
    if block is None:
        return []
    if hasattr(block, "GetNumberOfBlocks"):
        return [part for k in range(block.GetNumberOfBlocks()) for part in parts(block.GetBlock(k))]
    return [block] if block.GetNumberOfCells() > 0 else []


class Glb(unittest.TestCase):
    def frames_at(self, path, seconds):
        """Bounds and numbers of triangles of what is not shrunk to a point."""
        reader = vtkGLTFReader()
        reader.SetFileName(str(path))
        reader.ApplyDeformationsToGeometryOn()
        reader.SetFrameRate(100)
        reader.UpdateInformation()
        self.assertEqual(reader.GetNumberOfAnimations(), 1)
        reader.EnableAnimation(0)
        found = []
        for second in seconds:
            reader.UpdateTimeStep(second)
            shown = []
            for part in parts(reader.GetOutputDataObject(0)):
                low_high = part.GetBounds()
                if max(low_high[2 * k + 1] - low_high[2 * k] for k in range(3)) > 0:
                    shown.append((low_high, part.GetNumberOfPolys()))
            found.append(shown)
        return found

    def test_one_frame_at_a_time_as_the_slices_are(self):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)

            def run(*words):
                return subprocess.run([PROGRAM, *map(str, words)], cwd=folder, check=True, capture_output=True).stdout

            run("sample", "torus-morph", "--dims", "16,16,16,9", "-o", "torus.nrrd")
            run("animate", "torus.nrrd", "--iso", "0.5", "--frames", 9, "-o", "torus.glb")
            shown = self.frames_at(folder / "torus.glb", [(i + 0.5) / 10 for i in range(9)])
            self.assertEqual([len(frame) for frame in shown], [1] * 9)
            run("animate", "torus.nrrd", "--iso", "0.5", "--frames", 9, "-o", "f_%d.ply")
            for i, ((bounds, triangles),) in enumerate(shown):
                header = (folder / f"f_{i}.ply").read_bytes().split(b"end_header")[0].decode()
                self.assertIn(f"element face {triangles}\n", header)
                self.assertGreater(bounds[1], 0.3)
                self.assertLess(bounds[1], 1)

    def test_frames_that_move(self):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)

            def run(*words):
                return subprocess.run([PROGRAM, *map(str, words)], cwd=folder, check=True, capture_output=True).stdout

            run("sample", "ball", "--dims", "16,16,16,5", "--time", "-o", "ball.nrrd")
            run("animate", "ball.nrrd", "--iso", "0.5", "--times", "0.5,0.55,0.9", "--morph", "-o", "ball.glb")
            run("animate", "ball.nrrd", "--iso", "0.5", "--times", "0.5,0.55,0.9", "-o", "still.glb")
            seconds = [0.001, 0.012, 0.024]  # the first of the two gaps, of 0.025 s
            for path, moves in [("ball.glb", True), ("still.glb", False)]:
                shown = self.frames_at(folder / path, seconds)
                self.assertEqual([len(frame) for frame in shown], [1] * 3)
                widths = [bounds[1] - bounds[0] for ((bounds, _),) in shown]
                self.assertEqual(len(set(widths)), 3 if moves else 1, widths)


if __name__ == "__main__":
    unittest.main()
