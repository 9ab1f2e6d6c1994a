#!/usr/bin/env python3
"""Paints the dusk sky of scenes/gallery/cube_map.txt: six PNG files, 512 x 512.

    python3 scenes/tools/sky.py [size]

A sky over sea: a vertical gradient, a low sun with its glow, streaks of cloud
from value noise, and a far ridge along the horizon. Only the Python standard
library is used, and the same call always writes the same files.

Faces are named by the axis they lie on: +x right, +y up, +z front. Seen from
the middle of the cube the four side faces stand upright.
"""

import struct
import sys
import zlib
from math import atan2, cos, exp, floor, sin, sqrt
from pathlib import Path

FOLDER = Path(__file__).resolve().parent.parent / "gallery" / "dusk"
SUN = (0.42, 0.105, 0.90)

# Direction through the point (u, v) of a face, u to the right and v up, both in [-1, 1].
FACES = {
    "right": lambda u, v: (1, v, u),
    "left": lambda u, v: (-1, v, -u),
    "up": lambda u, v: (u, 1, v),
    "down": lambda u, v: (u, -1, -v),
    "front": lambda u, v: (-u, v, 1),
    "back": lambda u, v: (u, v, -1),
}


def unit(a):
    length = sqrt(sum(x * x for x in a))
    return tuple(x / length for x in a)


def mix(a, b, t):
    t = min(1.0, max(0.0, t))
    return tuple(x + (y - x) * t for x, y in zip(a, b))


def lattice(i, j):
    """A fixed pseudo-random number in [0, 1) for a lattice point."""
    h = (i * 374761393 + j * 668265263) & 0xFFFFFFFF
    h = ((h ^ (h >> 13)) * 1274126177) & 0xFFFFFFFF
    return ((h ^ (h >> 16)) & 0xFFFFFF) / 0x1000000


def value_noise(x, y):
    i, j = floor(x), floor(y)
    s, t = x - i, y - j
    s, t = s * s * (3 - 2 * s), t * t * (3 - 2 * t)
    low = lattice(i, j) * (1 - s) + lattice(i + 1, j) * s
    high = lattice(i, j + 1) * (1 - s) + lattice(i + 1, j + 1) * s
    return low * (1 - t) + high * t


def octaves(x, y, count):
    return sum(value_noise(x * 2**k, y * 2**k) / 2 ** (k + 1) for k in range(count))


def ridge_height(azimuth):
    """Elevation of the far ridge; the azimuth enters by a circle, so it has no seam."""
    n = octaves(40 + 3.2 * cos(azimuth), 40 + 3.2 * sin(azimuth), 5)
    return 0.015 + 0.19 * max(0.0, n - 0.36)


def sky(d):
    """Linear RGB seen in the unit direction d."""
    x, y, z = d
    sun = unit(SUN)
    facing = sum(a * b for a, b in zip(d, sun))
    if y < 0:
        # The sea mirrors a darker sky and a broad, soft path of the sun.
        water = mix((0.20, 0.17, 0.22), (0.015, 0.03, 0.06), 2.2 * -y)
        path = exp(-40 * (1 - sum(a * b for a, b in zip((x, -y, z), sun))))
        return tuple(w + 0.45 * path * c for w, c in zip(water, (1.0, 0.55, 0.25)))
    colour = mix((0.96, 0.55, 0.28), (0.50, 0.33, 0.42), 5.0 * y)
    colour = mix(colour, (0.07, 0.11, 0.27), 1.6 * (y - 0.08))
    # Away from the sun the horizon is cooler.
    colour = mix(colour, (0.24, 0.22, 0.38), 0.5 * (0.5 - 0.5 * facing) * (1 - y))
    streak = octaves(1.6 * x / (y + 0.16), 4.2 * z / (y + 0.16), 5)
    cover = min(1.0, max(0.0, (streak - 0.50) * 4.0)) * min(1.0, 5.0 * y)
    lit = mix((0.30, 0.20, 0.30), (1.0, 0.62, 0.42), 0.5 + 0.5 * facing)
    colour = mix(colour, lit, 0.75 * cover)
    glow = 0.55 * exp(-26 * (1 - facing)) + 0.9 * exp(-900 * (1 - facing))
    colour = tuple(c + glow * g for c, g in zip(colour, (1.0, 0.72, 0.42)))
    if facing > 0.9990:
        colour = (1.0, 0.97, 0.85)
    # The ridge's edge is about a pixel wide, so that it has no stairs.
    haze = mix((0.055, 0.05, 0.09), (0.42, 0.24, 0.20), exp(-3 * (1 - facing)))
    return mix(colour, haze, 0.5 + 300 * (ridge_height(atan2(z, x)) - y))


def write_png(path, size, rows):
    """Writes 8-bit RGB, each row with the PNG filter `up` (2)."""

    def chunk(kind, data):
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    raw, above = bytearray(), bytes(3 * size)
    for row in rows:
        raw.append(2)
        raw += bytes((a - b) & 255 for a, b in zip(row, above))
        above = row
    header = struct.pack(">IIBBBBB", size, size, 8, 2, 0, 0, 0)
    path.write_bytes(
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(bytes(raw), 9))
        + chunk(b"IEND", b"")
    )


def main():
    size = int(sys.argv[1]) if len(sys.argv) > 1 else 512
    FOLDER.mkdir(parents=True, exist_ok=True)
    for name, direction in FACES.items():
        rows = []
        for j in range(size):
            v = 1 - 2 * (j + 0.5) / size
            row = bytearray()
            for i in range(size):
                u = 2 * (i + 0.5) / size - 1
                colour = sky(unit(direction(u, v)))
                row += bytes(floor(min(1.0, max(0.0, c)) * 255 + 0.5) for c in colour)
            rows.append(bytes(row))
        write_png(FOLDER / f"{name}.png", size, rows)
        print(f"gallery/dusk/{name}.png")


if __name__ == "__main__":
    main()
