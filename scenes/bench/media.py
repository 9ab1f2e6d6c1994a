#!/usr/bin/env python3
"""A cloud, coloured smoke and skin, path traced by kajo and by Mitsuba 3 (`volpathmis`), Blender's Cycles and LuxCore: what an error costs.

    pip install mitsuba bpy pyluxcore numpy
    scenes/bench/media.py DIR [--scene cloud|smoke|skin] [--kajo FILE]... [--variant NAME]... [--without cycles|mitsuba|luxcore]... [--size N] [--samples N] [--runs N] [--bounces N]

The cloud and the smoke are one grid of 64 x 64 x 64 densities, made here; the smoke scatters and absorbs by colour. Skin is a ball in which light walks at random, which Cycles has and the others
have not. One thread each, the programs take turns. The error is that of one picture, from pictures that differ in the seed only; seconds are of processor time, of the render call of Mitsuba and
LuxCore, and of all of kajo's and Cycles' work less that of one sample. "error x s" is what an error costs, however many samples are taken. The lights of each program are scaled so that its picture has the mean of kajo's first
one; means are printed as they came. LuxCore marches through media by steps, here of half a voxel, which is faster and not exact."""

import argparse
import pathlib
import struct

import numpy as np
import peers
from peers import numbers

EYE, TARGET, VIEW_ANGLE = (2.6, 1.0, 3.4), (0, 0, 0), 34
SUN, IRRADIANCE, SKY = (-0.6, -0.8, -0.1), 3.0, 0.4
VOXELS = 64
# Scattered and absorbed per unit of length where the density is 1, by colour, and the mean cosine.
MEDIA = {"cloud": ((18.0, 18.0, 18.0), (0.02, 0.02, 0.02), 0.6), "smoke": ((6.0, 4.5, 2.5), (0.6, 2.0, 4.0), 0.3)}
SKIN, SKIN_RADIUS, SKIN_SCALE = (0.8, 0.5, 0.4), (1, 0.35, 0.2), 0.3


def densities():
    """Puffs of soft balls with a noise on their rims; nothing at the faces of the box. Axes x, y, z."""
    random = np.random.default_rng(5)
    at = np.stack(np.meshgrid(*[(np.arange(VOXELS) + 0.5) / VOXELS * 2 - 1] * 3, indexing="ij"), -1)
    noise = np.zeros((VOXELS,) * 3)
    for octave in range(4):
        waves = random.normal(size=(12, 3)) * 3 * 2**octave
        phases = random.uniform(0, 2 * np.pi, 12)
        noise += np.cos(at @ waves.T + phases).sum(-1) / 12 / 1.6**octave
    puffs = [(random.uniform(-0.45, 0.45, 3) * (1.2, 0.6, 1), random.uniform(0.25, 0.5)) for _ in range(9)]
    body = np.max([1 - np.linalg.norm(at - center, axis=-1) / radius for center, radius in puffs], axis=0)
    density = np.clip(3 * body + 1.2 * noise, 0, 1)
    rim = np.abs(at).max(-1) > 1 - 3 / VOXELS
    return np.where(rim, 0, density).astype(np.float32)


def write_vdb(file, density):
    """A file of OpenVDB with one grid of floats, `density`, whose box is from -1 to 1; nothing is compressed or left out."""
    text = lambda value: struct.pack("<I", len(value)) + value  # noqa: E731
    scale, origin = 2 / VOXELS, 1 / VOXELS - 1
    sizes = [[s] * 3 for s in (scale, scale, 1 / scale, 1 / scale**2, 0.5 / scale)]
    head = struct.pack("<II", 0, 2) + b"".join(map(text, (b"class", b"string", b"fog volume", b"name", b"string", b"density")))
    head += text(b"ScaleTranslateMap") + struct.pack("<18d", *[origin] * 3, *sum(sizes, [])) + struct.pack("<I", 1)
    # The root has no tiles and one child, which has one child.
    head += struct.pack("<fII3i", 0, 0, 1, 0, 0, 0)
    leaves = [(x, y, z) for x in range(VOXELS // 8) for y in range(VOXELS // 8) for z in range(VOXELS // 8)]

    def node(log2, children):
        mask = bytearray(8**log2 // 8)
        for child in children:
            mask[child >> 3] |= 1 << (child & 7)
        return bytes(mask) + bytes(len(mask)) + b"\x06" + bytes(4 * 8**log2)

    tree = node(5, [0]) + node(4, [x << 8 | y << 4 | z for x, y, z in leaves])
    full = b"\xff" * 64
    blocks = (density[8 * x : 8 * x + 8, 8 * y : 8 * y + 8, 8 * z : 8 * z + 8] for x, y, z in leaves)
    values = b"".join(full + b"\x06" + block.astype("<f4").tobytes() for block in blocks)
    start = b" BDV\0\0\0\0" + struct.pack("<III", 224, 10, 0) + b"\1" + b"0" * 36 + struct.pack("<II", 0, 1)
    start += text(b"density") + text(b"Tree_float_5_4_3") + text(b"")
    grid = len(start) + 24
    buffers = grid + len(head) + len(tree) + 64 * len(leaves)
    file.write_bytes(start + struct.pack("<3q", grid, buffers, buffers + len(values)) + head + tree + full * len(leaves) + values)


class Kajo(peers.Kajo):
    def __init__(self, options, program):
        self.samples = options.samples
        if options.scene == "skin":
            skin = f"Principled skin {{ color {numbers(SKIN)}  roughness 0.4  subsurface 1  subsurfaceRadius {numbers(SKIN_RADIUS)}  subsurfaceScale {SKIN_SCALE} }}"
            body = f"Materials {{ {skin} }}\nGroup {{ MaterialIndex skin Sphere {{ center 0 0 0  radius 0.9 }} }}\n"
        else:
            scattering, absorption, g = MEDIA[options.scene]
            medium = f"file {options.grid.name}  grid density  sigma_s {numbers(scattering)}  sigma_a {numbers(absorption)}  g {g}"
            body = f"Media {{ GridMedium m {{ {medium} }} }}\nMaterials {{ Interface b {{ medium m }} }}\nGroup {{ MaterialIndex b Box {{ min -1 -1 -1  max 1 1 1 }} }}\n"
        text = (
            f"PerspectiveCamera {{ center {numbers(EYE)}  direction {numbers(np.subtract(TARGET, EYE))}  up 0 1 0  angle {VIEW_ANGLE} }}\n"
            f"Background {{ color {SKY} {SKY} {SKY} }}\nLights {{ DirectionalLight {{ direction {numbers(SUN)}  irradiance {IRRADIANCE} }} }}\n{body}"
        )
        super().__init__(program, options.folder, options.scene, options.size, text, ["--integrator", "path", "--bounces", options.bounces])

    def run(self, seed):
        return super().run(self.samples, seed)


class Mitsuba(peers.Mitsuba):
    def __init__(self, options, variant):
        super().__init__(variant, options.size, options.samples, EYE, TARGET, VIEW_ANGLE)
        mi, T = self.mi, self.mi.ScalarTransform4f
        scattering, absorption, g = (np.array(v) for v in MEDIA[options.scene])
        extinction = scattering + absorption
        values = options.density.transpose(2, 1, 0)[..., None] * (extinction / extinction.max()).astype(np.float32)
        box = T().translate([-1, -1, -1]).scale([2, 2, 2])
        grid = {"type": "gridvolume", "grid": mi.VolumeGrid(np.ascontiguousarray(values)), "to_world": box, "raw": True}
        albedo = {"type": "constvolume", "value": {"type": "rgb", "value": list(scattering / extinction)}}
        medium = {"type": "heterogeneous", "sigma_t": grid, "albedo": albedo, "scale": float(extinction.max()), "phase": {"type": "hg", "g": float(g)}}
        self.load({
            "integrator": {"type": "volpathmis", "max_depth": options.bounces + 2},
            "sky": {"type": "constant", "radiance": {"type": "rgb", "value": SKY}},
            "sun": {"type": "directional", "direction": list(SUN), "irradiance": {"type": "rgb", "value": IRRADIANCE}},
            "body": {"type": "cube", "bsdf": {"type": "null"}, "interior": medium},
        })  # fmt: skip


class Cycles(peers.Cycles):
    def __init__(self, options):
        super().__init__(options.folder, options.size, options.samples, options.bounces)
        self.light("SUN", IRRADIANCE, direction=SUN).angle = 0
        self.sky(SKY)
        self.camera(EYE, TARGET, VIEW_ANGLE)
        if options.scene == "skin":
            self.skin()
        else:
            self.volume(str(options.grid), *MEDIA[options.scene])

    def skin(self):
        self.bpy.ops.mesh.primitive_uv_sphere_add(radius=0.9, segments=256, ring_count=128)
        self.bpy.ops.object.shade_smooth()
        material, node = self.material()
        out, skin = node("OutputMaterial"), node("BsdfPrincipled")
        for name, value in (("Base Color", (*SKIN, 1)), ("Roughness", 0.4), ("Subsurface Weight", 1), ("Subsurface Radius", SKIN_RADIUS), ("Subsurface Scale", SKIN_SCALE)):
            skin.inputs[name].default_value = value
        skin.subsurface_method = "RANDOM_WALK"
        material.node_tree.links.new(skin.outputs[0], out.inputs["Surface"])
        self.bpy.context.object.data.materials.append(material)

    def volume(self, file, scattering, absorption, g):
        grid = self.bpy.data.volumes.new("grid")
        grid.filepath = file
        self.bpy.context.collection.objects.link(self.bpy.data.objects.new("grid", grid))
        material, node = self.material()
        links = material.node_tree.links
        out, density, both = node("OutputMaterial"), node("Attribute"), node("AddShader")
        density.attribute_name = "density"
        # What is absorbed is told by what is left.
        for i, (kind, values, color) in enumerate([("VolumeScatter", scattering, lambda s: s), ("VolumeAbsorption", absorption, lambda s: 1 - s)]):
            shader, scale = node(kind), node("Math")
            scale.operation, scale.inputs[1].default_value = "MULTIPLY", max(values)
            shader.inputs["Color"].default_value = (*(color(value / max(values)) for value in values), 1)
            if kind == "VolumeScatter":
                shader.inputs["Anisotropy"].default_value = g
            links.new(density.outputs["Fac"], scale.inputs[0])
            links.new(scale.outputs[0], shader.inputs["Density"])
            links.new(shader.outputs[0], both.inputs[i])
        links.new(both.outputs[0], out.inputs["Volume"])
        grid.materials.append(material)


class LuxCore(peers.LuxCore):
    def __init__(self, options):
        self.samples = options.samples
        depth = {"path.pathdepth.total": options.bounces + 1, "path.pathdepth.diffuse": options.bounces + 1, "path.pathdepth.glossy": options.bounces + 1,
                 "path.pathdepth.specular": options.bounces + 1, "sampler.type": "SOBOL"}  # fmt: skip
        super().__init__(options.size, "PATHCPU", EYE, TARGET, VIEW_ANGLE, depth)
        scattering, absorption, g = MEDIA[options.scene]
        # From the box to the unit cube.
        place = np.diag([0.5, 0.5, 0.5, 1.0])
        place[:3, 3] = 0.5
        self.parse({
            "scene.textures.density.type": "densitygrid",
            "scene.textures.density.nx": VOXELS, "scene.textures.density.ny": VOXELS, "scene.textures.density.nz": VOXELS,
            "scene.textures.density.data": [float(v) for v in options.density.transpose(2, 1, 0).ravel()],
            "scene.textures.density.wrap": "black", "scene.textures.density.storage": "float",
            "scene.textures.density.mapping.type": "globalmapping3d",
            "scene.textures.density.mapping.transformation": [float(v) for v in place.T.ravel()],
        })  # fmt: skip
        for name, values in (("scattering", scattering), ("absorption", absorption)):
            self.parse({f"scene.textures.{name}.type": "scale", f"scene.textures.{name}.texture1": "density", f"scene.textures.{name}.texture2": list(values)})
        self.parse({
            "scene.volumes.m.type": "heterogeneous", "scene.volumes.m.scattering": "scattering", "scene.volumes.m.absorption": "absorption",
            "scene.volumes.m.asymmetry": [g] * 3, "scene.volumes.m.multiscattering": 1, "scene.volumes.m.steps.size": 1 / VOXELS, "scene.volumes.m.steps.maxcount": 1024,
            "scene.materials.b.type": "null", "scene.materials.b.volume.interior": "m",
            "scene.lights.sky.type": "constantinfinite", "scene.lights.sky.color": [SKY] * 3,
            "scene.lights.sun.type": "sharpdistant", "scene.lights.sun.direction": list(SUN), "scene.lights.sun.color": [IRRADIANCE] * 3,
        })  # fmt: skip
        corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
        faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        self.mesh(corners, [t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))], None, "b")

    def run(self, seed):
        return self.render(self.samples, seed)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=lambda name: pathlib.Path(name).resolve())
    parser.add_argument("--scene", choices=["cloud", "smoke", "skin"], default="cloud")
    parser.add_argument("--kajo", action="append", help="any number of programs; kajo where none is named")
    parser.add_argument("--variant", action="append", help="Mitsuba's, with LLVM where it is one of llvm; scalar_rgb where none is named")
    parser.add_argument("--without", action="append", default=[], choices=["cycles", "mitsuba", "luxcore"])
    for name, default in (("size", 96), ("samples", 32), ("runs", 4), ("bounces", 64)):
        parser.add_argument(f"--{name}", type=int, default=default)
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    options.density, options.grid = densities(), options.folder / "grid.vdb"
    write_vdb(options.grid, options.density)
    programs = [Kajo(options, program) for program in options.kajo or ["kajo"]]
    others = {"cycles": Cycles, "luxcore": LuxCore}
    # Skin is a walk of Cycles.
    asked = ["cycles"] if options.scene == "skin" else others
    if options.scene != "skin" and "mitsuba" not in options.without:
        programs += [Mitsuba(options, variant) for variant in options.variant or ["scalar_rgb"]]
    programs += [others[name](options) for name in asked if name not in options.without]
    peers.rows_by_variance(programs, options.runs)


if __name__ == "__main__":
    main()
