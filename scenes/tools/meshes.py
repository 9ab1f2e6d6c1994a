#!/usr/bin/env python3
"""Writes the small meshes that the scenes of this folder use.

    python3 scenes/tools/meshes.py

Every mesh is a formula, so the files can be made again at any time and come
out the same. Nothing beyond the Python standard library is needed.

  classic/cube.obj        12 triangles, edge 2, centred on the origin
  classic/hare_200.obj    a sitting hare of eight ellipsoids, 200 triangles
  classic/hare_1000.obj   the same hare, 1000 triangles
  gallery/meshes/knot.obj      a (2, 3) torus knot without normals
  gallery/meshes/knot_low.obj  the same knot of few facets
  gallery/meshes/vase.obj      a turned vase whose bands name MTL materials
  gallery/meshes/gem.obj       a brilliant-cut stone, closed, flat facets
  gallery/meshes/shell.ply     a snail's shell of quads, binary
  gallery/meshes/lantern.glb   a lantern on a post, of five nodes and three materials
"""

import json
from math import cos, exp, pi, sin, sqrt
from pathlib import Path
from struct import pack

SCENES = Path(__file__).resolve().parent.parent


def sub(a, b):
    return tuple(x - y for x, y in zip(a, b))


def cross(a, b):
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


def unit(a):
    length = sqrt(sum(x * x for x in a))
    return tuple(x / length for x in a)


class Mesh:
    """Vertices and faces; a face is (material or None, vertex numbers from 0)."""

    def __init__(self):
        self.vertices = []
        self.faces = []

    def vertex(self, p):
        self.vertices.append(p)
        return len(self.vertices) - 1

    def face(self, *corners, material=None):
        self.faces.append((material, corners))

    def write(self, path, title, library=None, with_normals=False):
        """Writes the mesh; `with_normals` gives the `f a//n` form, one normal a face."""
        lines = [f"# {title}", "# made by scenes/tools/meshes.py"]
        if library:
            lines.append(f"mtllib {library}")
        lines += ["v %.4f %.4f %.4f" % v for v in self.vertices]
        if with_normals:
            for _, f in self.faces:
                a, b, c = (self.vertices[i] for i in f[:3])
                lines.append("vn %.4f %.4f %.4f" % unit(cross(sub(b, a), sub(c, a))))
        material = None
        for number, (name, corners) in enumerate(self.faces, start=1):
            if name != material:
                lines.append(f"usemtl {name}")
                material = name
            form = f"%d//{number}" if with_normals else "%d"
            lines.append("f " + " ".join(form % (i + 1) for i in corners))
        path.write_text("\n".join(lines) + "\n")
        print(f"{path.relative_to(SCENES)}: {len(self.faces)} faces")

    def write_ply(self, path, title):
        """Writes the mesh as binary PLY."""
        header = [
            "ply",
            "format binary_little_endian 1.0",
            f"comment {title}",
            f"element vertex {len(self.vertices)}",
            *(f"property float {axis}" for axis in "xyz"),
            f"element face {len(self.faces)}",
            "property list uchar ushort vertex_indices",
            "end_header\n",
        ]
        vertices = b"".join(pack("<3f", *v) for v in self.vertices)
        faces = b"".join(pack(f"<B{len(f)}H", len(f), *f) for _, f in self.faces)
        path.write_bytes("\n".join(header).encode() + vertices + faces)
        print(f"{path.relative_to(SCENES)}: {len(self.faces)} faces")


def ellipsoid(mesh, centre, radii, segments, bands, lean=0.0):
    """Adds a closed ellipsoid of 2 * segments * (bands - 1) triangles.

    Its axis is y; `lean` turns it about z, in degrees, before it is moved.
    """
    c, s = cos(lean * pi / 180), sin(lean * pi / 180)

    def place(x, y, z):
        x, y, z = x * radii[0], y * radii[1], z * radii[2]
        return (centre[0] + c * x - s * y, centre[1] + s * x + c * y, centre[2] + z)

    bottom, top = mesh.vertex(place(0, -1, 0)), mesh.vertex(place(0, 1, 0))
    rings = []
    for band in range(1, bands):
        polar = pi * band / bands
        rings.append(
            [
                mesh.vertex(place(sin(polar) * cos(a), -cos(polar), sin(polar) * sin(a)))
                for a in (2 * pi * (k + 0.5 * (band % 2)) / segments for k in range(segments))
            ]
        )
    for k in range(segments):
        n = (k + 1) % segments
        mesh.face(bottom, rings[0][k], rings[0][n])
        mesh.face(top, rings[-1][n], rings[-1][k])
        for band, (low, high) in enumerate(zip(rings, rings[1:]), start=1):
            # Odd rings are turned by half a segment: pick the short diagonal.
            if band % 2:
                mesh.face(low[k], high[n], low[n])
                mesh.face(low[k], high[k], high[n])
            else:
                mesh.face(low[k], high[k], low[n])
                mesh.face(low[n], high[k], high[n])


def hare(counts):
    """A sitting hare looking along -x; `counts` are (segments, bands) of each part."""
    body, head, ear, tail, foot = counts
    mesh = Mesh()
    ellipsoid(mesh, (0.28, 0.70, 0), (0.88, 0.74, 0.62), *body, lean=-38)
    ellipsoid(mesh, (-0.50, 1.50, 0), (0.50, 0.42, 0.38), *head, lean=12)
    ellipsoid(mesh, (-0.14, 2.16, 0.19), (0.15, 0.60, 0.10), *ear, lean=-20)
    ellipsoid(mesh, (-0.04, 2.12, -0.19), (0.15, 0.60, 0.10), *ear, lean=-28)
    ellipsoid(mesh, (1.14, 0.44, 0), (0.26, 0.22, 0.22), *tail)
    ellipsoid(mesh, (-0.32, 0.12, 0.36), (0.46, 0.14, 0.18), *foot)
    ellipsoid(mesh, (-0.32, 0.12, -0.36), (0.46, 0.14, 0.18), *foot)
    return mesh


def cube():
    mesh = Mesh()
    for k in range(8):
        mesh.vertex((1 if k & 1 else -1, 1 if k & 2 else -1, 1 if k & 4 else -1))
    for a, b, c, d in (
        (4, 5, 7, 6),
        (1, 0, 2, 3),
        (5, 1, 3, 7),
        (0, 4, 6, 2),
        (6, 7, 3, 2),
        (0, 1, 5, 4),
    ):
        mesh.face(a, b, c)
        mesh.face(a, c, d)
    return mesh


def knot(p=2, q=3, around=160, across=18, tube=0.36):
    """A (p, q) torus knot, as quads over a frame that turns with the curve."""

    def curve(t):
        r = 1.6 + 0.62 * cos(q * t)
        return (r * cos(p * t), 0.62 * sin(q * t) * 1.25, r * sin(p * t))

    mesh = Mesh()
    h = 1e-4
    for i in range(around):
        t = 2 * pi * i / around
        c = curve(t)
        along = unit(sub(curve(t + h), curve(t - h)))
        # The vector from the torus' core circle to the curve is a smooth normal guide.
        core = (1.6 * cos(p * t), 0.0, 1.6 * sin(p * t))
        side = unit(cross(along, sub(c, core)))
        out = cross(side, along)
        for k in range(across):
            a = 2 * pi * k / across
            u, v = tube * cos(a), tube * sin(a)
            mesh.vertex(tuple(c[j] + u * out[j] + v * side[j] for j in range(3)))
    for i in range(around):
        n = (i + 1) % around
        for k in range(across):
            m = (k + 1) % across
            mesh.face(i * across + k, i * across + m, n * across + m, n * across + k)
    return mesh


def vase(segments=48):
    """A surface of revolution: (radius, height) pairs and the material of each band."""
    clay, glaze, gold = "clay", "glaze", "gold"
    profile = [
        (0.00, 0.00, clay),
        (0.55, 0.00, clay),
        (0.60, 0.06, clay),
        (0.54, 0.14, gold),
        (0.58, 0.20, glaze),
        (0.78, 0.45, glaze),
        (0.95, 0.75, glaze),
        (1.00, 1.05, gold),
        (0.98, 1.17, glaze),
        (0.86, 1.45, glaze),
        (0.62, 1.75, glaze),
        (0.42, 2.00, glaze),
        (0.34, 2.22, gold),
        (0.34, 2.34, clay),
        (0.40, 2.52, clay),
        (0.52, 2.66, gold),
        (0.54, 2.70, gold),
        (0.48, 2.68, clay),
        (0.30, 2.40, clay),
        (0.26, 2.20, clay),
        (0.00, 2.10, clay),
    ]
    mesh = Mesh()
    rings = []
    for radius, height, _ in profile:
        if radius == 0:
            rings.append([mesh.vertex((0, height, 0))] * segments)
        else:
            turn = (2 * pi * k / segments for k in range(segments))
            rings.append([mesh.vertex((radius * cos(a), height, radius * sin(a))) for a in turn])
    for (_, _, material), low, high in zip(profile, rings, rings[1:]):
        for k in range(segments):
            n = (k + 1) % segments
            corners = [low[k], high[k], high[n], low[n]]
            corners = [c for i, c in enumerate(corners) if c != corners[i - 1]]
            mesh.face(*corners, material=material)
    return mesh


def gem(sides=8):
    """A brilliant cut: table, star and kite facets of the crown, girdle, pavilion."""
    mesh = Mesh()

    def ring(radius, height, phase):
        turn = (2 * pi * (k + phase) / sides for k in range(sides))
        return [mesh.vertex((radius * cos(a), height, radius * sin(a))) for a in turn]

    table = ring(0.56, 0.34, 0.0)
    middle = ring(0.80, 0.22, 0.5)
    girdle = ring(1.00, 0.03, 0.0)
    belt = ring(1.00, -0.03, 0.0)
    waist = ring(0.62, -0.36, 0.5)
    culet = mesh.vertex((0, -0.86, 0))
    mesh.face(*reversed(table))
    for k in range(sides):
        n = (k + 1) % sides
        mesh.face(table[k], table[n], middle[k])
        mesh.face(table[n], girdle[n], middle[k])
        mesh.face(table[k], middle[k], girdle[k])
        mesh.face(middle[k], girdle[n], girdle[k])
        mesh.face(girdle[k], girdle[n], belt[n], belt[k])
        mesh.face(belt[k], belt[n], waist[k])
        mesh.face(waist[k], belt[n], waist[n])
        mesh.face(waist[k], waist[n], culet)
    return mesh


def shell(turns=3.2, around=150, across=16):
    """A logarithmic spiral that a growing tube follows, axis y."""
    mesh = Mesh()
    for i in range(around + 1):
        t = 2 * pi * turns * (i / around - 1)
        grow = exp(0.16 * t)
        for k in range(across):
            a = 2 * pi * k / across
            out = grow * (0.62 + 0.55 * cos(a))
            mesh.vertex((out * cos(t), grow * (0.60 * sin(a) - 1.25) + 1.9, out * sin(t)))
    for i in range(around):
        for k in range(across):
            m = (k + 1) % across
            low, high = i * across, (i + 1) * across
            mesh.face(low + k, low + m, high + m, high + k)
    return mesh


def write_lantern(path):
    """A lantern as a model: boxes and a roof, each a mesh that nodes place."""
    box = [(x, y, z) for x in (-1, 1) for y in (0, 1) for z in (-1, 1)]
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    cube = [box[i] for a, b, c, d in sides for i in (a, b, c, a, c, d)]
    base = [(-1, 0, -1), (-1, 0, 1), (1, 0, 1), (1, 0, -1)]
    roof = [p for k in range(4) for p in (base[k], base[(k + 1) % 4], (0, 1, 0))]
    roof += [base[i] for i in (0, 3, 2, 0, 2, 1)]
    data = b"".join(pack("<3f", *p) for p in cube + roof)
    view = [{"buffer": 0, "byteOffset": at * 12, "byteLength": n * 12} for at, n in ((0, 36), (36, 18))]
    limits = {"min": [-1, 0, -1], "max": [1, 1, 1]}
    accessor = [{"bufferView": i, "componentType": 5126, "count": n, "type": "VEC3", **limits} for i, n in ((0, 36), (1, 18))]
    colour = lambda *rgba: {"pbrMetallicRoughness": {"baseColorFactor": rgba, "metallicFactor": 0}}
    mesh = lambda accessor, material: {"primitives": [{"attributes": {"POSITION": accessor}, "material": material}]}
    document = {
        "asset": {"version": "2.0", "generator": "scenes/tools/meshes.py"},
        "buffers": [{"byteLength": len(data)}],
        "bufferViews": view,
        "accessors": accessor,
        "materials": [
            {"name": "iron", **colour(0.10, 0.11, 0.13, 1)},
            {"name": "glass", "alphaMode": "BLEND", **colour(1.0, 0.8, 0.4, 0.55)},
        ],
        "meshes": [mesh(0, 0), mesh(0, 1), mesh(1, 0)],
        "nodes": [
            {"name": "lantern", "children": [1, 2, 3, 4]},
            {"name": "foot", "mesh": 0, "scale": [0.30, 0.12, 0.30]},
            {"name": "post", "mesh": 0, "scale": [0.06, 1.80, 0.06]},
            {"name": "pane", "mesh": 1, "translation": [0, 1.80, 0], "scale": [0.22, 0.50, 0.22]},
            {"name": "roof", "mesh": 2, "translation": [0, 2.30, 0], "scale": [0.34, 0.30, 0.34]},
        ],
        "scenes": [{"nodes": [0]}],
        "scene": 0,
    }
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    chunks = pack("<I4s", len(text), b"JSON") + text + pack("<I4s", len(data), b"BIN\0") + data
    path.write_bytes(pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
    print(f"{path.relative_to(SCENES)}: {len(document['nodes'])} nodes")


def main():
    classic, gallery = SCENES / "classic", SCENES / "gallery" / "meshes"
    gallery.mkdir(parents=True, exist_ok=True)
    cube().write(classic / "cube.obj", "a cube of 12 triangles", with_normals=True)
    few = hare([(10, 4), (8, 4), (6, 3), (6, 2), (4, 3)])
    many = hare([(20, 10), (16, 8), (12, 6), (8, 5), (7, 5)])
    for mesh, count in ((few, 200), (many, 1000)):
        assert len(mesh.faces) == count
        mesh.write(classic / f"hare_{count}.obj", f"a hare of {count} triangles", with_normals=True)
    knot().write(gallery / "knot.obj", "a (2, 3) torus knot")
    knot(around=54, across=8).write(gallery / "knot_low.obj", "a (2, 3) torus knot of few facets")
    vase().write(gallery / "vase.obj", "a vase with three materials", library="vase.mtl")
    gem().write(gallery / "gem.obj", "a brilliant-cut stone")
    shell().write_ply(gallery / "shell.ply", "a snail's shell")
    write_lantern(gallery / "lantern.glb")


if __name__ == "__main__":
    main()
