#!/usr/bin/env python3
"""A room with pictures on all its walls, path traced by kajo, Mitsuba 3 and Blender's Cycles: what an error costs.

    pip install mitsuba bpy numpy
    scenes/bench/textured_room.py DIR [--kajo FILE] [--filter NAME]... [--without-cycles] [--size N] [--samples N] [--runs N]

Floor, walls, ceiling and two boxes show pictures that the script writes to DIR, bilinear and repeated. One thread each, the programs take turns.
The error is that of one picture, from pictures that differ in the seed only; seconds are of processor time, of the render call
of Mitsuba and Cycles, and of kajo's whole run less that of one sample. "error x s" is what an error costs, however many samples are taken.
Means are printed because errors of different pictures say nothing."""

import argparse
import pathlib
import resource
import struct
import subprocess
import time
import zlib

import numpy as np

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


def numbers(values):
    return " ".join(f"{v:g}" for v in values)


class Kajo:
    def __init__(self, options, filter_name):
        self.options, self.name = options, f"kajo {filter_name}"
        self.file, self.out = options.folder / f"room_{filter_name}.txt", options.folder / "room.pfm"
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
        self.file.write_text("\n".join(lines))

    @staticmethod
    def quad(corner, edge1, edge2):
        return f"Quad {{ corner {numbers(corner)}  edge1 {numbers(edge1)}  edge2 {numbers(edge2)} }}"

    def render(self, samples, seed):
        options = self.options
        command = [options.kajo, "render", str(self.file), "-o", str(self.out), "--integrator", "path", "--bounces", str(BOUNCES)]
        command += ["--size", f"{options.size}x{options.size}", "--samples", "sobol", str(samples)]
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        subprocess.run([*command, "--seed", str(seed), "--threads", "1", "--quiet"], check=True)
        seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        content = self.out.read_bytes().split(b"\n", 3)[3]
        return np.frombuffer(content, "<f4").reshape(options.size, options.size, 3)[::-1].astype(float), seconds

    def run(self, seed):
        samples = self.options.samples
        _, start = self.render(1, seed)
        picture, seconds = self.render(samples, seed)
        return picture, (seconds - start) * samples / (samples - 1)


class Mitsuba:
    def __init__(self, options, variant):
        import mitsuba as mi

        self.mi, self.options, self.variant, self.name = mi, options, variant, f"Mitsuba {variant}"
        mi.set_variant(variant)
        film = {"type": "hdrfilm", "width": options.size, "height": options.size, "rfilter": {"type": "box"}, "pixel_format": "rgb"}
        view = mi.ScalarTransform4f().look_at(origin=EYE, target=TARGET, up=[0, 1, 0])
        sensor = {"type": "perspective", "fov": VIEW_ANGLE, "fov_axis": "y", "to_world": view, "film": film}
        sensor["sampler"] = {"type": "multijitter", "sample_count": options.samples}
        scene = {"type": "scene", "sensor": sensor, "integrator": {"type": "path", "max_depth": BOUNCES + 2}}
        for i, (*corners, picture, repeat) in enumerate(QUADS):
            scale = mi.ScalarTransform4f().scale([repeat, repeat, 1])
            color = {"type": "bitmap", "filename": str(options.folder / f"{picture}.png"), "to_uv": scale}
            scene[f"quad{i}"] = self.quad(corners, {"type": "twosided", "side": {"type": "diffuse", "reflectance": color}})
        black = {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}}
        emitted = {"type": "area", "radiance": {"type": "rgb", "value": list(EMITTED)}}
        scene["emitter"] = self.quad(EMITTER, black) | {"light": emitted}
        self.scene = mi.load_dict(scene)
        self.run(1000)

    def quad(self, corners, bsdf):
        corner, edge1, edge2 = (np.array(v, float) for v in corners)
        n = np.cross(edge1, edge2)
        matrix = np.eye(4)
        matrix[:3, 0], matrix[:3, 1] = edge1 / 2, edge2 / 2
        matrix[:3, 2], matrix[:3, 3] = n / np.linalg.norm(n), corner + (edge1 + edge2) / 2
        return {"type": "rectangle", "to_world": self.mi.ScalarTransform4f(matrix), "bsdf": bsdf}

    def run(self, seed):
        self.mi.set_variant(self.variant)
        start = time.process_time()
        picture = np.array(self.mi.render(self.scene, spp=self.options.samples, seed=seed), dtype=float)
        return picture, time.process_time() - start


class Cycles:
    def __init__(self, options):
        import bpy
        import mathutils

        self.bpy, self.options, self.name = bpy, options, f"Cycles {bpy.app.version_string}"
        bpy.ops.wm.read_factory_settings(use_empty=True)
        for i, (*corners, picture, repeat) in enumerate(QUADS):
            self.quad(corners, repeat, self.textured(str(options.folder / f"{picture}.png")))
        self.quad(EMITTER, 1, self.emitting())
        world = bpy.data.worlds.new("world")
        world.use_nodes = True
        world.node_tree.nodes["Background"].inputs[0].default_value = (0, 0, 0, 1)
        bpy.context.scene.world = world
        camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
        camera.data.sensor_fit, camera.data.angle = "VERTICAL", np.radians(VIEW_ANGLE)
        z = (mathutils.Vector(EYE) - mathutils.Vector(TARGET)).normalized()
        x = mathutils.Vector((0, 1, 0)).cross(z).normalized()
        camera.matrix_world = mathutils.Matrix((x, z.cross(x), z)).transposed().to_4x4()
        camera.matrix_world.translation = EYE
        bpy.context.collection.objects.link(camera)
        bpy.context.scene.camera = camera
        self.settings()
        self.run(1000)

    def settings(self):
        scene = self.bpy.context.scene
        scene.render.engine = "CYCLES"
        cycles = scene.cycles
        cycles.device, cycles.use_denoising, cycles.use_adaptive_sampling = "CPU", False, False
        cycles.max_bounces = cycles.diffuse_bounces = BOUNCES
        cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
        cycles.pixel_filter_type, cycles.samples = "BOX", self.options.samples
        scene.render.resolution_x = scene.render.resolution_y = self.options.size
        scene.render.resolution_percentage, scene.render.threads_mode, scene.render.threads = 100, "FIXED", 1
        scene.view_settings.view_transform = "Raw"
        scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
        scene.render.filepath = str(self.options.folder / "cycles.exr")

    def material(self):
        material = self.bpy.data.materials.new("m")
        material.use_nodes = True
        tree = material.node_tree
        tree.nodes.clear()
        return material, tree, tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"]

    def textured(self, file):
        material, tree, surface = self.material()
        diffuse, picture = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeTexImage")
        picture.image = self.bpy.data.images.load(file, check_existing=True)
        picture.image.colorspace_settings.name = "sRGB"
        tree.links.new(picture.outputs[0], diffuse.inputs["Color"])
        tree.links.new(diffuse.outputs[0], surface)
        return material

    def emitting(self):
        material, tree, surface = self.material()
        emission, geometry, mix = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("Emission", "NewGeometry", "MixShader"))
        emission.inputs["Color"].default_value = (*(v / EMITTED[0] for v in EMITTED), 1)
        emission.inputs["Strength"].default_value = EMITTED[0]
        black = tree.nodes.new("ShaderNodeBsdfDiffuse")
        black.inputs["Color"].default_value = (0, 0, 0, 1)
        tree.links.new(geometry.outputs["Backfacing"], mix.inputs[0])
        tree.links.new(emission.outputs[0], mix.inputs[1])
        tree.links.new(black.outputs[0], mix.inputs[2])
        tree.links.new(mix.outputs[0], surface)
        return material

    def quad(self, corners, repeat, material):
        corner, edge1, edge2 = (np.array(v, float) for v in corners)
        mesh = self.bpy.data.meshes.new("quad")
        points = (corner, corner + edge1, corner + edge1 + edge2, corner + edge2)
        mesh.from_pydata([tuple(map(float, p)) for p in points], [], [(0, 1, 2, 3)])
        mesh.uv_layers.new().data.foreach_set("uv", [repeat * v for v in (0, 0, 1, 0, 1, 1, 0, 1)])
        mesh.materials.append(material)
        self.bpy.context.collection.objects.link(self.bpy.data.objects.new("quad", mesh))

    def run(self, seed):
        scene = self.bpy.context.scene
        scene.cycles.seed = seed
        start = time.process_time()
        self.bpy.ops.render.render(write_still=True)
        seconds = time.process_time() - start
        image = self.bpy.data.images.load(scene.render.filepath)
        pixels = np.empty(self.options.size**2 * 4, np.float32)
        image.pixels.foreach_get(pixels)
        self.bpy.data.images.remove(image)
        return pixels.reshape(self.options.size, self.options.size, 4)[::-1, :, :3].astype(float), seconds


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
