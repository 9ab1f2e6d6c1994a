#!/usr/bin/env python3
"""Writes scenes/gallery/grids/knot.raw: signed distances to a trefoil knot of a tube, on 48 x 48 x 28 points.

    python3 scenes/tools/knot.py scenes/gallery/grids/knot.raw

The box is from -1 -1 -0.6 to 1 1 0.6. A byte is 127.5 at the surface, less inside, and changes by 127.5 in 0.25 units.
"""

import math
import sys

SIZE = (48, 48, 28)
LOW, HIGH = (-1, -1, -0.6), (1, 1, 0.6)
TUBE, REACH, STEPS = 0.17, 0.25, 400


def curve(i):
    t = 2 * math.pi * i / STEPS
    r = 0.27
    return (
        r * (math.sin(t) + 2 * math.sin(2 * t)),
        r * (math.cos(t) - 2 * math.cos(2 * t)),
        -1.1 * r * math.sin(3 * t),
    )


CURVE = [curve(i) for i in range(STEPS)]


def distance(p):
    nearest = min((p[0] - c[0]) ** 2 + (p[1] - c[1]) ** 2 + (p[2] - c[2]) ** 2 for c in CURVE)
    return math.sqrt(nearest) - TUBE


def main(path):
    values = bytearray()
    for k in range(SIZE[2]):
        for j in range(SIZE[1]):
            for i in range(SIZE[0]):
                at = [l + (h - l) * n / (m - 1) for l, h, n, m in zip(LOW, HIGH, (i, j, k), SIZE)]
                values.append(min(255, max(0, round(127.5 * (1 + distance(at) / REACH)))))
    with open(path, "wb") as file:
        file.write(values)


main(*sys.argv[1:])
