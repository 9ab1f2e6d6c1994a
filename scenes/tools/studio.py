#!/usr/bin/env python3
"""Paints the environment of scenes/gallery/environment.txt: a photographer's studio.

    python3 scenes/tools/studio.py scenes/gallery/studio.hdr

Writes a Radiance HDR picture of all directions: a warm and a cold softbox, a thin strip and a dim room.
"""

import math
import struct
import sys

WIDTH, HEIGHT = 512, 256

# Longitude and latitude of the middle in degrees, half width, half height, colour.
LIGHTS = [
    (-50, 42, 24, 16, (42.0, 30.0, 19.0)),
    (70, 25, 14, 26, (9.0, 14.0, 24.0)),
    (165, 12, 34, 2.5, (26.0, 25.0, 24.0)),
]


def color(longitude, latitude):
    for middle, height, half_width, half_height, light in LIGHTS:
        aside = (longitude - middle + 180) % 360 - 180
        if abs(aside) < half_width and abs(latitude - height) < half_height:
            return light
    wall = 0.12 + 0.08 * math.sin(math.radians(latitude))
    return (wall, wall * 1.02, wall * 1.08)


def rgbe(rgb):
    largest = max(rgb)
    if largest < 1e-32:
        return bytes(4)
    mantissa, exponent = math.frexp(largest)
    scale = mantissa * 256 / largest
    return bytes([int(v * scale) for v in rgb] + [exponent + 128])


def packed(values):
    """Runs of a byte, as (128 + length, byte), and other bytes, as (length, bytes)."""
    out, i = bytearray(), 0
    while i < len(values):
        run = i
        while run < len(values) and values[run] == values[i] and run - i < 127:
            run += 1
        if run - i > 2:
            out += bytes([128 + run - i, values[i]])
            i = run
        else:
            out += bytes([1, values[i]])
            i += 1
    return bytes(out)


def main(path):
    with open(path, "wb") as out:
        out.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (HEIGHT, WIDTH))
        for y in range(HEIGHT):
            latitude = 90 - (y + 0.5) * 180 / HEIGHT
            row = [rgbe(color((x + 0.5) * 360 / WIDTH - 180, latitude)) for x in range(WIDTH)]
            out.write(struct.pack(">BBH", 2, 2, WIDTH))
            for channel in range(4):
                out.write(packed([pixel[channel] for pixel in row]))


if __name__ == "__main__":
    main(sys.argv[1])
