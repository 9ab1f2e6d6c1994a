#!/usr/bin/env python3
"""Writes scenes/gallery/grids/cloud.df3: a small cumulus as a grid of densities.

Balls of several sizes over a flat base, eaten away by fractal noise of cells [Worley 1996], as clouds of
[Schneider 2015] are. The file is POV-Ray's df3: three big-endian numbers of 16 bits, then a byte for each voxel.
"""

import math
import pathlib
import random
import struct

SIZE = (64, 36, 44)
rng = random.Random(7)


def cells(n):
    """One random point in each cell of an n x n x n lattice that repeats."""
    points = [(rng.random(), rng.random(), rng.random()) for _ in range(n**3)]

    def distance(x, y, z):
        x, y, z = x * n, y * n, z * n
        i, j, k = math.floor(x), math.floor(y), math.floor(z)
        best = 9.0
        for a in (i - 1, i, i + 1):
            for b in (j - 1, j, j + 1):
                for c in (k - 1, k, k + 1):
                    p = points[((c % n) * n + b % n) * n + a % n]
                    best = min(best, (a + p[0] - x) ** 2 + (b + p[1] - y) ** 2 + (c + p[2] - z) ** 2)
        return math.sqrt(best)

    return distance


octaves = [(0.55, cells(5)), (0.3, cells(10)), (0.15, cells(20))]
# Middle (x, y, z) and radius of each ball, in a box 64 : 36 : 44.
balls = [(0.3, 0.3, 0.5, 0.2), (0.48, 0.42, 0.46, 0.26), (0.66, 0.34, 0.55, 0.2), (0.8, 0.26, 0.48, 0.13)]
balls += [(0.2, 0.24, 0.42, 0.12), (0.42, 0.62, 0.5, 0.17), (0.56, 0.6, 0.4, 0.15), (0.4, 0.3, 0.66, 0.15)]


def density(x, y, z):
    inside = 0.0
    for bx, by, bz, r in balls:
        d = math.dist((x, y * SIZE[1] / SIZE[0], z * SIZE[2] / SIZE[0]),
                      (bx, by * SIZE[1] / SIZE[0], bz * SIZE[2] / SIZE[0]))
        inside = max(inside, 1.0 - d / (0.9 * r))
    base = min(1.0, max(0.0, (y - 0.12) / 0.08))
    if inside <= 0.0 or base == 0.0:
        return 0.0
    worn = sum(weight * noise(x, y * SIZE[1] / SIZE[0], z * SIZE[2] / SIZE[0]) for weight, noise in octaves)
    return base * min(1.0, max(0.0, 3.0 * (inside - 0.75 * worn + 0.18)))


nx, ny, nz = SIZE
values = bytearray()
for k in range(nz):
    for j in range(ny):
        for i in range(nx):
            values.append(round(255 * density((i + 0.5) / nx, (j + 0.5) / ny, (k + 0.5) / nz)))
path = pathlib.Path(__file__).parent.parent / "gallery/grids/cloud.df3"
path.parent.mkdir(exist_ok=True)
path.write_bytes(struct.pack(">3H", *SIZE) + bytes(values))
print(path, len(values), sum(v > 0 for v in values) / len(values))
