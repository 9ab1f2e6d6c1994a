#!/usr/bin/env python3
"""Writes scenes/gallery/fonts/kajo.ttf: a small geometric typeface with the letters a g i j k l o w.

    python3 scenes/tools/font.py scenes/gallery/fonts/kajo.ttf

Letters are strokes of one width laid over each other, so contours overlap, as they do in variable fonts. One pair of letters
is kerned. The file is TrueType with the tables that a font cannot do without, and `kern`.
"""

import math
import struct
import sys

EM, X_HEIGHT, ASCENDER, DESCENDER, STROKE = 1000, 500, 750, -230, 110


def oriented(points, clockwise):
    """Points of a contour, as (x, y, is on the curve), in an order."""
    area = sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(points, points[1:] + points[:1]))
    return points if (area < 0) == clockwise else points[::-1]


def polygon(*corners):
    return [oriented([(x, y, True) for x, y in corners], True)]


def box(x0, y0, x1, y1):
    return polygon((x0, y0), (x1, y0), (x1, y1), (x0, y1))


def circle(x, y, r, clockwise=True):
    """Eight parabolas, whose control points are between the points on the circle."""
    points = []
    for i in range(8):
        for angle, radius, on in ((i, r, True), (i + 0.5, r / math.cos(math.pi / 8), False)):
            a = math.pi / 4 * angle
            points.append((round(x + radius * math.cos(a)), round(y + radius * math.sin(a)), on))
    return oriented(points, clockwise)


def ring(x, y, r):
    return [circle(x, y, r), circle(x, y, r - STROKE, clockwise=False)]


def slanted(x0, y0, x1, y1, width=130):
    return polygon((x0, y0), (x0 + width, y0), (x1 + width, y1), (x1, y1))


BOWL = ring(275, 250, 250)
# Contours and advance width of each letter.
GLYPHS = {
    " ": ([], 280),
    "a": (BOWL + box(415, 0, 525, X_HEIGHT), 585),
    "g": (BOWL + box(415, DESCENDER, 525, X_HEIGHT) + box(110, DESCENDER, 525, DESCENDER + STROKE), 585),
    "i": (box(60, 0, 170, X_HEIGHT) + [circle(115, 650, 80)], 230),
    "j": (box(60, DESCENDER, 170, X_HEIGHT) + box(-70, DESCENDER, 170, DESCENDER + STROKE) + [circle(115, 650, 80)], 230),
    "k": (box(60, 0, 170, ASCENDER) + slanted(120, 180, 370, X_HEIGHT) + slanted(390, 0, 180, 310), 540),
    "l": (box(60, 0, 170, ASCENDER), 230),
    "o": (ring(275, 250, 250), 550),
    "w": (
        slanted(150, 0, 10, 500, 115) + slanted(165, 0, 315, 500, 115)
        + slanted(450, 0, 310, 500, 115) + slanted(465, 0, 615, 500, 115),
        740,
    ),
}
MISSING = (box(60, 0, 440, 700) + [oriented([(110, 50, True), (390, 50, True), (390, 650, True), (110, 650, True)], False)], 500)
KERNED = {("k", "a"): -40}


def glyph(contours):
    points = [p for contour in contours for p in contour]
    if not points:
        return b"", (0, 0, 0, 0)
    xs, ys = [p[0] for p in points], [p[1] for p in points]
    bounds = (min(xs), min(ys), max(xs), max(ys))
    out = struct.pack(">h4h", len(contours), *bounds)
    end = -1
    for contour in contours:
        end += len(contour)
        out += struct.pack(">H", end)
    out += struct.pack(">H", 0)
    overlap = 0x40
    flags = [int(on) for _, _, on in points]
    flags[0] |= overlap
    out += bytes(flags)
    for axis in (xs, ys):
        last = 0
        for value in axis:
            out += struct.pack(">h", value - last)
            last = value
    return out + b"\0" * (-len(out) % 4), bounds


def main(path):
    letters = sorted(GLYPHS)
    shapes = [MISSING] + [GLYPHS[letter] for letter in letters]
    data, offsets, metrics, boxes = b"", [0], b"", []
    for contours, advance in shapes:
        piece, bounds = glyph(contours)
        data += piece
        offsets.append(len(data))
        metrics += struct.pack(">Hh", advance, bounds[0])
        boxes.append(bounds)
    whole = tuple(pick(b[i] for b in boxes) for i, pick in enumerate((min, min, max, max)))
    count = len(shapes)
    most_points = max(sum(map(len, contours)) for contours, _ in shapes)
    most_contours = max(len(contours) for contours, _ in shapes)
    index = {letter: i + 1 for i, letter in enumerate(letters)}
    # Format 4 with a segment for each letter.
    codes = [ord(letter) for letter in letters] + [0xFFFF]
    deltas = [(index[letter] - ord(letter)) & 0xFFFF for letter in letters] + [1]
    n = len(codes)
    power = 1 << (n.bit_length() - 1)
    words = [2 * n, 2 * power, power.bit_length() - 1, 2 * (n - power)] + codes + [0] + codes + deltas + [0] * n
    sub = struct.pack(f">{len(words)}H", *words)
    cmap = struct.pack(">HHHHI", 0, 1, 3, 1, 12) + struct.pack(">HHH", 4, 6 + len(sub), 0) + sub
    pairs = sorted((index[a], index[b], value) for (a, b), value in KERNED.items())
    kern = struct.pack(">HHHHHHHHH", 0, 1, 0, 14 + 6 * len(pairs), 1, len(pairs), 6, 0, 0)
    kern += b"".join(struct.pack(">HHh", *pair) for pair in pairs)
    tables = {
        b"cmap": cmap,
        b"glyf": data,
        b"head": struct.pack(
            ">IIIIHHQQ4hHHhhh", 0x10000, 0x10000, 0, 0x5F0F3CF5, 3, EM, 0, 0, *whole, 0, 8, 2, 1, 0),
        b"hhea": struct.pack(
            ">IhhhHhhhhhhhhhhhH", 0x10000, ASCENDER, DESCENDER, 120,
            max(width for _, width in shapes), 0, 0, whole[2], 1, 0, 0, 0, 0, 0, 0, 0, count),
        b"hmtx": metrics,
        b"kern": kern,
        b"loca": struct.pack(f">{len(offsets)}I", *offsets),
        b"maxp": struct.pack(">I14H", 0x10000, count, most_points, most_contours, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0),
        b"post": struct.pack(">IIhhIIIII", 0x30000, 0, -100, 50, 0, 0, 0, 0, 0),
    }
    n = len(tables)
    power = 1 << (n.bit_length() - 1)
    out = struct.pack(">IHHHH", 0x10000, n, 16 * power, power.bit_length() - 1, 16 * (n - power))
    offset, body = 12 + 16 * n, b""
    for tag, table in sorted(tables.items()):
        padded = table + b"\0" * (-len(table) % 4)
        checksum = sum(struct.unpack(f">{len(padded) // 4}I", padded)) & 0xFFFFFFFF
        out += struct.pack(">4sIII", tag, checksum, offset + len(body), len(table))
        body += padded
    with open(path, "wb") as file:
        file.write(out + body)


main(*sys.argv[1:])
