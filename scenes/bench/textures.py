#!/usr/bin/env python3
"""Writes a wall of many pictures, to see what a cache of tiles saves.

    textures.py DIR [--pictures N] [--side TEXELS]      DIR/0000.png and so on, DIR/wall.txt and DIR/floor.txt

Each picture is a checkerboard under a gradient in colours of its own, of 8 bits. The wall shows all of them at once, filtered over ellipses; the floor
shows them below mirror balls, by path tracing, with the filter of the render."""
import argparse, math, os, struct, zlib

parser = argparse.ArgumentParser()
parser.add_argument("folder")
parser.add_argument("--pictures", type=int, default=100)
parser.add_argument("--side", type=int, default=4096)
asked = parser.parse_args()
os.makedirs(asked.folder, exist_ok=True)


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def write(path, number, side):
    """Rows of two kinds take turns, so that they need be made once only."""
    color = [(37 * number * k) % 256 for k in (1, 5, 11)]
    rows = []
    for odd in (0, 1):
        texels = bytearray()
        for x in range(side):
            light = 255 if (x // 32 + odd) % 2 else 96
            texels += bytes(light * (c + (255 - c) * x // side) // 255 for c in color)
        rows.append(b"\0" + bytes(texels))
    deflate = zlib.compressobj(1)
    data = b"".join(deflate.compress(rows[y // 32 % 2]) for y in range(side)) + deflate.flush()
    head = struct.pack(">IIBBBBB", side, side, 8, 2, 0, 0, 0)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", data) + chunk(b"IEND", b""))


columns = math.ceil(math.sqrt(asked.pictures))
materials, quads = [], []
for i in range(asked.pictures):
    write(os.path.join(asked.folder, f"{i:04}.png"), i + 1, asked.side)
    materials.append(f"  Matte {{ color {i:04}.png {{ filter ewa }} }}")
    x, y = i % columns, i // columns
    quads.append(f"  MaterialIndex {i} Quad {{ corner {x} {y} 0  edge1 0.95 0 0  edge2 0 0.95 0 }}")
middle = columns / 2
with open(os.path.join(asked.folder, "wall.txt"), "w") as file:
    file.write(
        f"PerspectiveCamera {{ center {middle} {middle} {1.1 * columns}  direction 0 0 -1  up 0 1 0  angle 50 }}\n"
        "Settings { integrator direct }\nBackground { color 1 1 1 }\n"
        "Materials {\n" + "\n".join(materials) + "\n}\nGroup {\n" + "\n".join(quads) + "\n}\n"
    )

materials = [f"  Matte {{ color {i:04}.png }}" for i in range(asked.pictures)]
quads = [f"  MaterialIndex {i} Quad {{ corner {i % columns} 0 {-(i // columns)}  edge1 1 0 0  edge2 0 0 -1 }}" for i in range(asked.pictures)]
balls = [f"  Sphere {{ center {37 * k % columns + 0.5} 0.8 {-(23 * k % columns) - 0.5}  radius 0.8 }}" for k in range(12)]
with open(os.path.join(asked.folder, "floor.txt"), "w") as file:
    file.write(
        f"PerspectiveCamera {{ center {middle} {0.45 * columns} {0.4 * columns}  direction 0 -0.55 -1  up 0 1 0  angle 40 }}\n"
        "Settings { integrator path  size 1280 720  samples sobol 16  bounces 4 }\nBackground { color 0.8 0.9 1 }\n"
        "Lights { DirectionalLight { direction -0.4 -1 -0.3  color 1.5 1.4 1.3 } }\n"
        f"Materials {{\n{chr(10).join(materials)}\n  Metal {{ metal silver  roughness 0.05 }}\n}}\n"
        f"Group {{\n{chr(10).join(quads)}\n  MaterialIndex {asked.pictures}\n{chr(10).join(balls)}\n}}\n"
    )
