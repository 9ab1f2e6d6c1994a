#!/usr/bin/env python3
"""Vertex connection and merging by kajo and by LuxCore's BIDIRVM: what an error costs in rooms with balls of glass and mirrors.

    pip install pyluxcore numpy
    scenes/bench/vcm.py DIR [--scene room|cube] [--light rectangle|point|sun|sky] [--kajo FILE]... [--size N] [--samples N] [--runs N] [--bounces N] [--without-luxcore]

`room` and its balls are those of SmallVCM [Georgiev 2012] but for their sizes; its balls show caustics in mirrors and through glass, which nothing else finds under the point. `cube` is like one of LuxCore's own tests. One thread each, the
programs take turns. The error is that of one picture against a picture of the same program with many more samples, relative to its squared mean, of all pixels and of all but the
worst one in a hundred; seconds are of processor time, of kajo's whole run less that of one sample, and of LuxCore's session. Each program has the merging radius that it chooses itself. Means are printed
because LuxCore's bidirectional engines show the room brighter than its own path tracer does, with which kajo agrees."""

import argparse
import pathlib

import numpy as np
import peers
from peers import numbers

WHITE, RED, GREEN, BLUE = (0.8, 0.8, 0.8), (0.8, 0.15, 0.1), (0.15, 0.6, 0.2), (0, 0, 0.75)
MIRROR = 0.9
INTENSITY, SUN_DIRECTION, IRRADIANCE, SKY = 2, (-1, -1.5, -1), 10, 1


class Room:
    """SmallVCM's: a ball of glass and a mirror ball in a box that is open towards the camera."""

    EYE, TARGET, UP, VIEW_ANGLE = (0, 0, 3.9), (0, 0, 0), (0, 1, 0), 39.3077
    # Corner and both edges, whose cross product points into the room.
    WALLS = [
        ((-1, -1, -1), (0, 0, 2), (2, 0, 0), WHITE),
        ((-1, 1, -1), (2, 0, 0), (0, 0, 2), WHITE),
        ((-1, -1, -1), (2, 0, 0), (0, 2, 0), WHITE),
        ((-1, -1, -1), (0, 2, 0), (0, 0, 2), RED),
        ((1, -1, -1), (0, 0, 2), (0, 2, 0), GREEN),
    ]
    # Center, radius and index of refraction of balls of glass; mirrors have none.
    BALLS = [((0.45, -0.6, 0.35), 0.38, 1.5), ((-0.42, -0.58, -0.3), 0.4, None)]
    CUBE = None
    POINT, EMITTERS, RADIANCE = (0, 0.98, 0), [((-0.15, 0.98, -0.15), (0.3, 0, 0), (0, 0, 0.3))], 20


class CubeAndBall:
    """Like `mat-glass-area` of LuxCore's tests, but for the colours of its glass: a cube and a ball of glass on a floor before two walls, below two rectangles that shine."""

    EYE, TARGET, UP, VIEW_ANGLE = (4.34339, -8.09766, 4.74567), (-2.1735, 7.36445, -0.197534), (0, 0, 1), 45
    WALLS = [
        ((-4.9, -4.9, 0.49), (9.8, 0, 0), (0, 9.8, 0), WHITE),
        ((-4.9, -4.9, 0.49), (0, 9.8, 0), (0, 0, 5.37), WHITE),
        ((-4.9, 4.9, 0.49), (9.8, 0, 0), (0, 0, 5.37), BLUE),
    ]
    BALLS = [((2.56, 1.07, 2.165), 1.258, 1.7)]
    # A corner of the lower face, its edges, and the index of refraction.
    CUBE = ((-2.234, -1.382, 0.5), ((1.915, 0.576, 0), (-0.576, 1.915, 0), (0, 0, 2)), 1.4)
    POINT, EMITTERS, RADIANCE = (0, -5.5, 5.6), [
        ((-3.579, -5.996, 5.279), (0.23, 0.21, 0.584), (0.446, -0.489, 0)),
        ((1.478, -5.455, 5.823), (0.876, 0.289, 0), (0.242, -0.734, -0.504)),
    ], 120  # fmt: skip


SCENES = {"room": Room, "cube": CubeAndBall}


def cube_faces(corner, edges):
    """Corner and both edges of each face."""
    corner, edges = np.array(corner), np.array(edges)
    for i in range(3):
        a, b, c = edges[i], edges[(i + 1) % 3], edges[(i + 2) % 3]
        yield from ((corner, b, a), (corner + c, a, b))


class Kajo(peers.Kajo):
    def __init__(self, options, program):
        self.samples, scene = options.samples, SCENES[options.scene]
        quad = lambda c, a, b, material: f"MaterialIndex {material} Quad {{ corner {numbers(c)}  edge1 {numbers(a)}  edge2 {numbers(b)} }}"
        names = {WHITE: "white", RED: "red", GREEN: "green", BLUE: "blue"}
        matte = [f"Matte {name} {{ color {numbers(color)} }}" for color, name in names.items()]
        matte += [f"Material mirror {{ diffuseColor 0 0 0  reflectiveColor {numbers([MIRROR] * 3)} }} Matte emitter {{ color 0 0 0  emission {numbers([scene.RADIANCE] * 3)}  emits front }}"]
        matte += [f"Glass glass{i} {{ indexOfRefraction {index} }}" for i, (_, _, index) in enumerate(scene.BALLS) if index]
        things = [quad(c, a, b, names[color]) for c, a, b, color in scene.WALLS]
        things += [f"MaterialIndex {f'glass{i}' if index else 'mirror'} Sphere {{ center {numbers(at)}  radius {r} }}" for i, (at, r, index) in enumerate(scene.BALLS)]
        if scene.CUBE:
            corner, edges, index = scene.CUBE
            matrix = [*edges[0], 0, *edges[1], 0, *edges[2], 0, *corner, 1]
            matte += [f"Glass cube {{ indexOfRefraction {index} }}"]
            things += [f"MaterialIndex cube Transform {{ Matrix {numbers(matrix)} Box {{ min 0 0 0  max 1 1 1 }} }}"]
        if options.light == "rectangle":
            things += [quad(*edges, "emitter") for edges in scene.EMITTERS]
        point = f"Lights {{ PointLight {{ position {numbers(scene.POINT)}  intensity {INTENSITY} }} }}"
        sun = f"Lights {{ DirectionalLight {{ direction {numbers(SUN_DIRECTION)}  irradiance {IRRADIANCE} }} }}"
        lights = {"point": point, "sun": sun}.get(options.light, "")
        sky = numbers([SKY if options.light == "sky" else 0] * 3)
        view = np.subtract(scene.TARGET, scene.EYE)
        text = f"PerspectiveCamera {{ center {numbers(scene.EYE)}  direction {numbers(view)}  up {numbers(scene.UP)}  angle {scene.VIEW_ANGLE} }}\nBackground {{ color {sky} }}\n"
        text += "\n".join(["Materials {", *matte, "}", lights, "Group {", *things, "}\n"])
        arguments = ["--integrator", "vcm", "--bounces", options.bounces, "--filter", "box", "1"]
        super().__init__(program, options.folder, f"vcm_{options.scene}_{options.light}", options.size, text, arguments)

    def run(self, seed):
        return super().run(self.samples, seed)


class LuxCore(peers.LuxCore):
    def __init__(self, options):
        self.samples, scene = options.samples, SCENES[options.scene]
        depth = {"path.maxdepth": options.bounces + 1, "light.maxdepth": options.bounces + 1}
        super().__init__(options.size, "BIDIRVMCPU", scene.EYE, scene.TARGET, scene.VIEW_ANGLE, depth, scene.UP)
        for i, (corner, a, b, color) in enumerate(scene.WALLS):
            self.parse({f"scene.materials.wall{i}.type": "matte", f"scene.materials.wall{i}.kd": list(color)})
            self.quad(corner, a, b, f"wall{i}")
        self.parse({"scene.materials.mirror.type": "mirror", "scene.materials.mirror.kr": [MIRROR] * 3})
        for i, (at, radius, index) in enumerate(scene.BALLS):
            self.ball(at, radius, self.glass(f"glass{i}", index) if index else "mirror")
        if scene.CUBE:
            corner, edges, index = scene.CUBE
            self.glass("cube", index)
            for face in cube_faces(corner, edges):
                self.quad(*face, "cube")
        if options.light == "point":
            self.parse({"scene.lights.light.type": "point", "scene.lights.light.position": list(scene.POINT), "scene.lights.light.gain": [INTENSITY] * 3})
        elif options.light == "sun":
            self.parse({"scene.lights.light.type": "sharpdistant", "scene.lights.light.direction": list(SUN_DIRECTION), "scene.lights.light.gain": [IRRADIANCE] * 3})
        elif options.light == "sky":
            self.parse({"scene.lights.light.type": "constantinfinite", "scene.lights.light.gain": [SKY] * 3})
        else:
            self.parse({"scene.materials.emitter.type": "matte", "scene.materials.emitter.kd": [0, 0, 0], "scene.materials.emitter.emission": [scene.RADIANCE] * 3})
            for edges in scene.EMITTERS:
                self.quad(*edges, "emitter")

    def glass(self, name, index):
        key = f"scene.materials.{name}"
        self.parse({f"{key}.type": "glass", f"{key}.kr": [1, 1, 1], f"{key}.kt": [1, 1, 1], f"{key}.interiorior": index})
        return name

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
    parser.add_argument("--scene", choices=list(SCENES), default="room")
    parser.add_argument("--light", choices=["rectangle", "point", "sun", "sky"], default="rectangle")
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
