"""Times skimage.measure.marching_cubes: FILE (raw float32, axis 0 fastest) NX NY NZ ISOVALUE -> seconds."""

import sys
import time

import numpy
from skimage.measure import marching_cubes

path, (nx, ny, nz), isovalue = sys.argv[1], map(int, sys.argv[2:5]), float(sys.argv[5])
samples = numpy.fromfile(path, dtype=numpy.float32).reshape(nz, ny, nx)
best = float("inf")
begin = time.perf_counter()
for run in range(5):
    if run > 1 and time.perf_counter() - begin > 5:
        break
    start = time.perf_counter()
    marching_cubes(samples, isovalue, allow_degenerate=True)
    best = min(best, time.perf_counter() - start)
print(best)
