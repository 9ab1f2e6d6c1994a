#!/usr/bin/env python3
"""Writes the pictures of scenes/gallery/relief.txt.

    python3 scenes/tools/relief.py scenes/gallery/pictures

Hammer marks as normals in eight bits, a brick wall as heights in sixteen, and ripples as heights in sixteen. Each repeats
without a seam. Nothing beyond the Python standard library is needed.
"""

import math
import os
import random
import struct
import sys
import zlib


def png(path, width, height, channels, bits, rows):
    """Writes a PNG of grey or RGB numbers between 0 and 1."""
    top = (1 << bits) - 1
    form = {8: "B", 16: ">H"}[bits]
    raw = bytearray()
    for row in rows:
        raw.append(0)
        for value in row:
            raw += struct.pack(form, round(min(max(value, 0), 1) * top))
    def chunk(name, data):
        body = name + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))
    kind = {1: 0, 3: 2}[channels]
    header = struct.pack(">IIBBBBB", width, height, bits, kind, 0, 0, 0)
    with open(path, "wb") as out:
        out.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header))
        out.write(chunk(b"IDAT", zlib.compress(bytes(raw), 9)) + chunk(b"IEND", b""))


def smooth(x):
    x = min(max(x, 0), 1)
    return x * x * (3 - 2 * x)


def hammered(n, marks=70):
    """Heights of round dents on a torus; the deepest one counts."""
    rand = random.Random(5)
    dents = [(rand.random(), rand.random(), rand.uniform(0.08, 0.13)) for _ in range(marks)]
    def height(x, y):
        depth = 0.0
        for cx, cy, r in dents:
            dx, dy = abs(x - cx), abs(y - cy)
            d2 = min(dx, 1 - dx) ** 2 + min(dy, 1 - dy) ** 2
            depth = max(depth, (r * r - d2) / r)
        return -0.32 * depth
    return [[height(i / n, j / n) for i in range(n)] for j in range(n)]


def normals(heights):
    """Normals of heights whose unit is the width of the picture; v goes up, rows go down."""
    n = len(heights)
    for j in range(n):
        row = []
        for i in range(n):
            du = (heights[j][(i + 1) % n] - heights[j][i - 1]) * n / 2
            dv = (heights[j - 1][i] - heights[(j + 1) % n][i]) * n / 2
            length = math.sqrt(du * du + dv * dv + 1)
            row += [0.5 - 0.5 * du / length, 0.5 - 0.5 * dv / length, 0.5 + 0.5 / length]
        yield row


def bricks(w, h):
    """Four courses of two bricks, every other one moved by half a brick, each brick a little uneven."""
    rand = random.Random(3)
    tilts = [[(rand.uniform(-1, 1), rand.uniform(-1, 1), rand.random()) for _ in range(2)] for _ in range(4)]
    for j in range(h):
        y, course = math.modf(4 * j / h)
        row = []
        for i in range(w):
            x, brick = math.modf((2 * i / w + 0.5 * (course % 2)) % 2)
            edge = min(x, 1 - x, (y - 0.0) / 2, (1 - y) / 2)
            tilt = tilts[int(course)][int(brick)]
            face = 0.8 + 0.12 * (tilt[0] * (x - 0.5) + tilt[1] * (y - 0.5)) + 0.08 * tilt[2]
            row.append(face * smooth((edge - 0.02) / 0.04))
        yield row


def ripples(w, h):
    """Waves in sand, bent by slower ones."""
    tau = 2 * math.pi
    for j in range(h):
        row = []
        for i in range(w):
            x, y = i / w, j / h
            bend = 0.35 * math.sin(tau * x) + 0.2 * math.sin(tau * (2 * x + y))
            wave = 0.5 + 0.5 * math.sin(tau * (6 * y + bend))
            row.append(wave**1.4)
        yield row


def main(folder):
    n = 256
    png(os.path.join(folder, "hammered.png"), n, n, 3, 8, normals(hammered(n)))
    png(os.path.join(folder, "bricks.png"), 512, 256, 1, 16, bricks(512, 256))
    png(os.path.join(folder, "ripples.png"), 256, 256, 1, 16, ripples(256, 256))


if __name__ == "__main__":
    main(sys.argv[1])
