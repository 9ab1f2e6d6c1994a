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


class LuxCore(peers.LuxCore):
    def __init__(self, options):
        self.samples = options.samples
        depth = {"path.maxdepth": options.bounces + 1, "light.maxdepth": options.bounces + 1}
        super().__init__(options.size, "BIDIRVMCPU", EYE, (0, 0, 0), VIEW_ANGLE, depth)
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

    def ball(self, center, radius, material):
        """A sphere of triangles with smooth normals: LuxCore has none of its own."""
        around, down = 256, 128
        theta, phi = np.meshgrid(np.linspace(0, np.pi, down + 1), np.linspace(0, 2 * np.pi, around + 1), indexing="ij")
        normals = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi)], -1).reshape(-1, 3)
        at = np.arange((down + 1) * (around + 1)).reshape(down + 1, around + 1)
        p, q, r, s = (part.ravel() for part in (at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]))
        triangles = np.concatenate([np.stack([p, r, q], -1)[:-around], np.stack([p, s, r], -1)[around:]])
        self.mesh(np.asarray(center) + radius * normals, triangles, normals, material)

    def run(self, seed):
        return self.render(self.samples, seed)


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
