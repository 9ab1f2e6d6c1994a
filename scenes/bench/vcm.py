#!/usr/bin/env python3
"""Vertex connection and merging by kajo and by LuxCore's BIDIRVM: what an error costs in a room with a ball of glass and a mirror ball.

    pip install pyluxcore numpy
    scenes/bench/vcm.py DIR [--light rectangle|point] [--kajo FILE]... [--size N] [--samples N] [--runs N] [--bounces N] [--without-luxcore]

The room and its balls are those of SmallVCM [Georgiev 2012] but for their sizes; its balls show caustics in mirrors and through glass, which nothing else finds under the point. One thread each, the
programs take turns. The error is that of one picture against a picture of the same program with many more samples, relative to its squared mean, of all pixels and of all but the
worst one in a hundred; seconds are of processor time, of kajo's whole run less that of one sample, and of LuxCore's session. Each program has the merging radius that it chooses itself. Means are printed
because LuxCore's bidirectional engines show the room brighter than its own path tracer does, with which kajo agrees."""

import argparse
import pathlib
import time

import numpy as np
import peers
from peers import numbers

EYE, VIEW_ANGLE = (0, 0, 3.9), 39.3077
WHITE, RED, GREEN = (0.8, 0.8, 0.8), (0.8, 0.15, 0.1), (0.15, 0.6, 0.2)
MIRROR, INDEX = 0.9, 1.5
GLASS_BALL, MIRROR_BALL = ((0.45, -0.6, 0.35), 0.38), ((-0.42, -0.58, -0.3), 0.4)
LIGHT_CENTER, LIGHT_HALF, RADIANCE, INTENSITY = (0, 0.98, 0), 0.15, 20, 2
# Corner and both edges, whose cross product points into the room.
WALLS = [
    ((-1, -1, -1), (0, 0, 2), (2, 0, 0), WHITE),
    ((-1, 1, -1), (2, 0, 0), (0, 0, 2), WHITE),
    ((-1, -1, -1), (2, 0, 0), (0, 2, 0), WHITE),
    ((-1, -1, -1), (0, 2, 0), (0, 0, 2), RED),
    ((1, -1, -1), (0, 0, 2), (0, 2, 0), GREEN),
]


def light_edges():
    corner = np.subtract(LIGHT_CENTER, (LIGHT_HALF, 0, LIGHT_HALF))
    return corner, (2 * LIGHT_HALF, 0, 0), (0, 0, 2 * LIGHT_HALF)


class Kajo(peers.Kajo):
    def __init__(self, options, program):
        self.samples = options.samples
        names = {WHITE: "white", RED: "red", GREEN: "green"}
        materials = " ".join(f"Matte {name} {{ color {numbers(color)} }}" for color, name in names.items())
        quads = " ".join(f"MaterialIndex {names[color]} Quad {{ corner {numbers(c)}  edge1 {numbers(a)}  edge2 {numbers(b)} }}" for c, a, b, color in WALLS)
        (glass, glass_radius), (mirror, mirror_radius) = GLASS_BALL, MIRROR_BALL
        corner, a, b = light_edges()
        is_point = options.light == "point"
        lights = f"Lights {{ PointLight {{ position {numbers(LIGHT_CENTER)}  intensity {INTENSITY} }} }}" if is_point else ""
        emitter = "" if is_point else f"MaterialIndex emitter Quad {{ corner {numbers(corner)}  edge1 {numbers(a)}  edge2 {numbers(b)} }}"
        text = (
            f"PerspectiveCamera {{ center {numbers(EYE)}  direction 0 0 -1  up 0 1 0  angle {VIEW_ANGLE} }}\nBackground {{ color 0 0 0 }}\n"
            f"Materials {{ {materials} Glass glass {{ indexOfRefraction {INDEX} }} Material mirror {{ diffuseColor 0 0 0  reflectiveColor {numbers([MIRROR] * 3)} }} "
            f"Matte emitter {{ color 0 0 0  emission {numbers([RADIANCE] * 3)}  emits front }} }}\n{lights}\n"
            f"Group {{ {quads} {emitter}\nMaterialIndex glass Sphere {{ center {numbers(glass)}  radius {glass_radius} }} "
            f"MaterialIndex mirror Sphere {{ center {numbers(mirror)}  radius {mirror_radius} }} }}\n"
        )
        arguments = ["--integrator", "vcm", "--bounces", options.bounces, "--filter", "box", "1"]
        super().__init__(program, options.folder, f"vcm_{options.light}", options.size, text, arguments)

    def run(self, seed):
        return super().run(self.samples, seed)


class LuxCore:
    def __init__(self, options):
        import pyluxcore

        self.core, self.options = pyluxcore, options
        pyluxcore.Init()
        pyluxcore.SetLogHandler(lambda message: None)
        self.name = f"LuxCore {pyluxcore.Version()} BIDIRVM"
        self.scene, self.meshes = pyluxcore.Scene(), 0
        self.parse({
            "scene.camera.type": "perspective",
            "scene.camera.lookat.orig": list(EYE),
            "scene.camera.lookat.target": [0, 0, 0],
            "scene.camera.up": [0, 1, 0],
            "scene.camera.fieldofview": VIEW_ANGLE,
            "scene.camera.autofocus.enable": 0,
        })  # fmt: skip
        for i, (corner, a, b, color) in enumerate(WALLS):
            self.parse({f"scene.materials.wall{i}.type": "matte", f"scene.materials.wall{i}.kd": list(color)})
            self.quad(corner, a, b, f"wall{i}")
        self.parse({"scene.materials.glass.type": "glass", "scene.materials.glass.kr": [1, 1, 1], "scene.materials.glass.kt": [1, 1, 1], "scene.materials.glass.interiorior": INDEX})
        self.parse({"scene.materials.mirror.type": "mirror", "scene.materials.mirror.kr": [MIRROR] * 3})
        self.ball(*GLASS_BALL, "glass")
        self.ball(*MIRROR_BALL, "mirror")
        if options.light == "point":
            self.parse({"scene.lights.point.type": "point", "scene.lights.point.position": list(LIGHT_CENTER), "scene.lights.point.gain": [INTENSITY] * 3})
        else:
            self.parse({"scene.materials.emitter.type": "matte", "scene.materials.emitter.kd": [0, 0, 0], "scene.materials.emitter.emission": [RADIANCE] * 3})
            self.quad(*light_edges(), "emitter")

    def properties(self, values):
        properties = self.core.Properties()
        for key, value in values.items():
            properties.Set(self.core.Property(key, value if isinstance(value, list) else [value]))
        return properties

    def parse(self, values):
        self.scene.Parse(self.properties(values))

    def mesh(self, points, triangles, normals, material):
        self.meshes += 1
        name = f"mesh{self.meshes}"
        tuples = [None if values is None else [tuple(float(v) for v in row) for row in values] for values in (points, normals)]
        self.scene.DefineMesh(name, tuples[0], [tuple(int(v) for v in row) for row in triangles], tuples[1], None, None, None)
        self.parse({f"scene.objects.{name}.shape": name, f"scene.objects.{name}.material": material})

    def quad(self, corner, a, b, material):
        corner, a, b = map(np.asarray, (corner, a, b))
        self.mesh([corner, corner + a, corner + a + b, corner + b], [(0, 1, 2), (0, 2, 3)], None, material)

    def ball(self, center, radius, material):
        """A sphere of triangles with smooth normals: LuxCore has none of its own."""
        around, down = 256, 128
        theta, phi = np.meshgrid(np.linspace(0, np.pi, down + 1), np.linspace(0, 2 * np.pi, around + 1), indexing="ij")
        normals = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi)], -1).reshape(-1, 3)
        at = np.arange((down + 1) * (around + 1)).reshape(down + 1, around + 1)
        p, q, r, s = (part.ravel() for part in (at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]))
        triangles = np.concatenate([np.stack([p, r, q], -1)[:-around], np.stack([p, s, r], -1)[around:]])
        self.mesh(np.asarray(center) + radius * normals, triangles, normals, material)

    def render(self, samples, seed):
        size = self.options.size
        config = self.core.RenderConfig(
            self.properties({
                "renderengine.type": "BIDIRVMCPU",
                "renderengine.seed": seed + 1,
                "native.threads.count": 1,
                "sampler.type": "RANDOM",
                "film.width": size,
                "film.height": size,
                "film.filter.type": "BOX",
                "film.filter.width": 0.5,
                "film.imagepipelines.0.0.type": "TONEMAP_LINEAR",
                "film.imagepipelines.0.0.scale": 1.0,
                "path.maxdepth": self.options.bounces + 1,
                "light.maxdepth": self.options.bounces + 1,
                "film.noiseestimation.warmup": 1 << 30,
                "batch.haltspp": [samples, 0],
            }),
            self.scene,
        )  # fmt: skip
        session = self.core.RenderSession(config)
        before = time.process_time()
        session.Start()
        while not session.HasDone():
            time.sleep(0.005)
            session.UpdateStats()
        seconds = time.process_time() - before
        session.Stop()
        buffer = np.empty(size * size * 3, np.float32)
        session.GetFilm().GetOutputFloat(self.core.FilmOutputType.RGB, buffer, 0)
        return buffer.reshape(size, size, 3)[::-1].astype(float), seconds

    def run(self, seed):
        return self.render(self.options.samples, seed)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--light", choices=["rectangle", "point"], default="rectangle")
    parser.add_argument("--kajo", action="append")
    parser.add_argument("--size", type=int, default=96)
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--reference", type=int, default=6, help="how many times as many samples a reference has")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--bounces", type=int, default=10)
    parser.add_argument("--without-luxcore", action="store_true")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    programs = [Kajo(options, program) for program in options.kajo or ["target/release/kajo"]]
    if not options.without_luxcore:
        programs.append(LuxCore(options))
    runs = [[program.run(seed) for program in programs] for seed in range(1, options.runs + 1)]
    print(peers.HEADER)
    for program, results in zip(programs, zip(*runs)):
        reference, _ = program.render(options.reference * options.samples, 100)
        errors = np.mean([((picture - reference) ** 2).mean(-1) for picture, _ in results], axis=0) / reference.mean() ** 2
        seconds = float(np.median([seconds for _, seconds in results]))
        print(peers.row(program.name, errors, seconds, reference.mean()), flush=True)


if __name__ == "__main__":
    main()
