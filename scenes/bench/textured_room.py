#!/usr/bin/env python3
"""A room with pictures on all its walls, path traced by kajo, Mitsuba 3 and Blender's Cycles: what an error costs.

    pip install mitsuba bpy numpy
    scenes/bench/textured_room.py DIR [--kajo FILE] [--filter NAME]... [--without-cycles] [--size N] [--samples N] [--runs N]

Floor, walls, ceiling and two boxes show pictures that the script writes to DIR, bilinear and repeated. One thread each, the programs take turns.
The error is that of one picture, from pictures that differ in the seed only; seconds are of processor time, of the render call
of Mitsuba, and of all of kajo's and Cycles' work less that of one sample. "error x s" is what an error costs, however many samples are taken.
Means are printed because errors of different pictures say nothing."""

import argparse
import pathlib
import struct
import zlib

import numpy as np
import peers
from peers import numbers

BOUNCES = 6
EYE, TARGET, VIEW_ANGLE = (0, 1.3, 2.3), (0, 1.0, 0), 65
EMITTED = (17, 15, 12)
# Corner, two edges, picture, and how often it is repeated; the normal is edge1 x edge2, the row at the top of the picture at edge2's end.
BOX = [((0, 0, 1), (1, 0, 0), (0, 1, 0)), ((1, 0, 1), (0, 0, -1), (0, 1, 0)), ((1, 0, 0), (-1, 0, 0), (0, 1, 0)),
       ((0, 0, 0), (0, 0, 1), (0, 1, 0)), ((0, 1, 1), (1, 0, 0), (0, 0, -1))]  # fmt: skip


def box(corner, size, picture):
    corner, size = np.array(corner, float), np.array(size, float)
    return [(tuple(corner + size * c), tuple(size * a), tuple(size * b), picture, 1) for c, a, b in BOX]


QUADS = [
    ((-2.5, 0, 2.5), (5, 0, 0), (0, 0, -5), "planks", 3),
    ((-2.5, 2.6, -2.5), (5, 0, 0), (0, 0, 5), "plaster", 2),
    ((-2.5, 0, -2.5), (5, 0, 0), (0, 2.6, 0), "bricks", 4),
    ((2.5, 0, 2.5), (-5, 0, 0), (0, 2.6, 0), "bricks", 4),
    ((-2.5, 0, 2.5), (0, 0, -5), (0, 2.6, 0), "paper", 4),
    ((2.5, 0, -2.5), (0, 0, 5), (0, 2.6, 0), "paper", 4),
    *box((-1.5, 0, -1.6), (0.9, 1.5, 0.9), "paper"),
    *box((0.5, 0, -0.7), (0.9, 0.8, 0.9), "planks"),
]
EMITTER = ((-0.6, 2.59, -0.9), (1.2, 0, 0), (0, 0, 1.2))


def pictures(folder):
    """Four pictures of 1024 x 1024 texels and 8 bits, with detail down to single texels."""
    rng = np.random.default_rng(1)
    y, x = np.mgrid[0:1024, 0:1024]
    brick = ((x + 64 * (y // 64 % 2)) % 128 < 8) | (y % 64 < 8)
    shades = {
        "planks": 0.35 + 0.25 * np.sin(y / 3 + 4 * np.sin(x / 90)) * (y % 128 > 4) + 0.1 * rng.random((1024, 1024)),
        "bricks": np.where(brick, 0.85, 0.35) + 0.15 * rng.random((1024, 1024)),
        "paper": np.where((x // 32 + y // 32) % 2, 0.8, 0.45) + 0.1 * rng.random((1024, 1024)),
        "plaster": 0.8 + 0.15 * rng.random((1024, 1024)),
    }
    tints = {"planks": (1, 0.75, 0.5), "bricks": (1, 0.6, 0.5), "paper": (0.7, 0.9, 1), "plaster": (1, 1, 0.97)}

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    for name, shade in shades.items():
        rgb = np.clip(255 * shade[..., None] * tints[name], 0, 255).astype(np.uint8)
        rows = b"".join(b"\0" + row.tobytes() for row in rgb)
        head = chunk(b"IHDR", struct.pack(">IIBBBBB", 1024, 1024, 8, 2, 0, 0, 0))
        content = head + chunk(b"IDAT", zlib.compress(rows, 1)) + chunk(b"IEND", b"")
        (folder / f"{name}.png").write_bytes(b"\x89PNG\r\n\x1a\n" + content)


class Kajo(peers.Kajo):
    def __init__(self, options, filter_name):
        self.samples = options.samples
        direction = np.subtract(TARGET, EYE)
        lines = [
            f"PerspectiveCamera {{ center {numbers(EYE)}  direction {numbers(direction)}  up 0 1 0  angle {VIEW_ANGLE} }}",
            "Background { color 0 0 0 }",
            "Materials {",
        ]
        for i, (_, _, _, picture, repeat) in enumerate(QUADS):
            lines.append(f"  Matte m{i} {{ color {picture}.png {{ repeat {repeat}  filter {filter_name} }} }}")
        lines.append(f"  Matte emitter {{ color 0 0 0  emission {numbers(EMITTED)}  emits front }}\n}}\nGroup {{")
        for i, (corner, edge1, edge2, _, _) in enumerate(QUADS):
            lines.append(f"  MaterialIndex m{i}  {self.quad(corner, edge1, edge2)}")
        lines.append(f"  MaterialIndex emitter  {self.quad(*EMITTER)}\n}}\n")
        arguments = ["--integrator", "path", "--bounces", BOUNCES]
        super().__init__(options.kajo, options.folder, f"room_{filter_name}", options.size, "\n".join(lines), arguments)
        self.name = f"kajo {filter_name}"

    @staticmethod
    def quad(corner, edge1, edge2):
        return f"Quad {{ corner {numbers(corner)}  edge1 {numbers(edge1)}  edge2 {numbers(edge2)} }}"

    def run(self, seed):
        return super().run(self.samples, seed)


class Mitsuba(peers.Mitsuba):
    def __init__(self, options, variant):
        super().__init__(variant, options.size, options.samples, EYE, TARGET, VIEW_ANGLE)
        mi, scene = self.mi, {"integrator": {"type": "path", "max_depth": BOUNCES + 2}}
        for i, (*corners, picture, repeat) in enumerate(QUADS):
            scale = mi.ScalarTransform4f().scale([repeat, repeat, 1])
            color = {"type": "bitmap", "filename": str(options.folder / f"{picture}.png"), "to_uv": scale}
            scene[f"quad{i}"] = self.quad(corners, {"type": "twosided", "side": {"type": "diffuse", "reflectance": color}})
        black = {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}}
        emitted = {"type": "area", "radiance": {"type": "rgb", "value": list(EMITTED)}}
        scene["emitter"] = self.quad(EMITTER, black) | {"light": emitted}
        self.load(scene)

    def quad(self, corners, bsdf):
        corner, edge1, edge2 = (np.array(v, float) for v in corners)
        n = np.cross(edge1, edge2)
        matrix = np.eye(4)
        matrix[:3, 0], matrix[:3, 1] = edge1 / 2, edge2 / 2
        matrix[:3, 2], matrix[:3, 3] = n / np.linalg.norm(n), corner + (edge1 + edge2) / 2
        return {"type": "rectangle", "to_world": self.mi.ScalarTransform4f(matrix), "bsdf": bsdf}


class Cycles(peers.Cycles):
    def __init__(self, options):
        super().__init__(options.folder, options.size, options.samples, BOUNCES)
        for i, (*corners, picture, repeat) in enumerate(QUADS):
            self.quad(corners, repeat, self.textured(str(options.folder / f"{picture}.png")))
        self.quad(EMITTER, 1, self.emitting())
        self.sky(0)
        self.camera(EYE, TARGET, VIEW_ANGLE)

    def textured(self, file):
        material, node = self.material()
        diffuse, picture, out = map(node, ("BsdfDiffuse", "TexImage", "OutputMaterial"))
        picture.image = self.bpy.data.images.load(file, check_existing=True)
        picture.image.colorspace_settings.name = "sRGB"
        links = material.node_tree.links
        links.new(picture.outputs[0], diffuse.inputs["Color"])
        links.new(diffuse.outputs[0], out.inputs["Surface"])
        return material

    def emitting(self):
        material, node = self.material()
        emission, geometry, mix, black, out = map(node, ("Emission", "NewGeometry", "MixShader", "BsdfDiffuse", "OutputMaterial"))
        emission.inputs["Color"].default_value = (*(v / EMITTED[0] for v in EMITTED), 1)
        emission.inputs["Strength"].default_value = EMITTED[0]
        black.inputs["Color"].default_value = (0, 0, 0, 1)
        links = material.node_tree.links
        links.new(geometry.outputs["Backfacing"], mix.inputs[0])
        links.new(emission.outputs[0], mix.inputs[1])
        links.new(black.outputs[0], mix.inputs[2])
        links.new(mix.outputs[0], out.inputs["Surface"])
        return material

    def quad(self, corners, repeat, material):
        corner, edge1, edge2 = (np.array(v, float) for v in corners)
        mesh = self.bpy.data.meshes.new("quad")
        points = (corner, corner + edge1, corner + edge1 + edge2, corner + edge2)
        mesh.from_pydata([tuple(map(float, p)) for p in points], [], [(0, 1, 2, 3)])
        mesh.uv_layers.new().data.foreach_set("uv", [repeat * v for v in (0, 0, 1, 0, 1, 1, 0, 1)])
        mesh.materials.append(material)
        self.bpy.context.collection.objects.link(self.bpy.data.objects.new("quad", mesh))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=lambda name: pathlib.Path(name).resolve())
    parser.add_argument("--kajo", default="kajo")
    parser.add_argument("--filter", action="append", help="kajo's, any number of them; bilinear where none is named")
    parser.add_argument("--variant", action="append", help="Mitsuba's; scalar_rgb where none is named")
    for name, default in (("size", 256), ("samples", 64), ("runs", 4)):
        parser.add_argument(f"--{name}", type=int, default=default)
    parser.add_argument("--without-cycles", action="store_true", help="for Mitsuba's variants with LLVM, which cannot be loaded beside it")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    pictures(options.folder)
    programs = [Kajo(options, name) for name in options.filter or ["bilinear"]]
    programs += [Mitsuba(options, variant) for variant in options.variant or ["scalar_rgb"]]
    programs += [] if options.without_cycles else [Cycles(options)]
    runs = [[program.run(seed) for program in programs] for seed in range(1, options.runs + 1)]
    print("| program | squared error | seconds | error x s | mean |\n|---|---|---|---|---|")
    for program, results in zip(programs, zip(*runs)):
        stack = np.stack([picture for picture, _ in results])
        error, seconds = stack.var(axis=0, ddof=1).mean(), float(np.median([seconds for _, seconds in results]))
        mean = ", ".join(f"{v:.4f}" for v in stack.mean(axis=(0, 1, 2)))
        print(f"| {program.name} | {error:.3e} | {seconds:.2f} | {error * seconds:.3e} | {mean} |", flush=True)


if __name__ == "__main__":
    main()
