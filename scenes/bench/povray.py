#!/usr/bin/env python3
"""Radiosity and photons by POV-Ray and by kajo: what an error costs in a sunlit room, and below a ball of glass.

    apt-get install povray; pip install numpy
    scenes/bench/povray.py DIR [--scene room|ball] [--kajo FILE] [--size N] [--runs N]

Both scenes have parallel light, which both programs know alike: an irradiance of pi beside POV-Ray's colour 1. One thread each, the programs take turns. POV-Ray renders with its documented settings
of rising quality, kajo with rising numbers of samples. The error is that of one picture against one by kajo's paths (room) or merged paths (ball) with many more samples, relative to its squared mean, of all
pixels, of all but the worst one in a hundred, and of all but the worst one in ten, which is without the edges, where POV-Ray takes some nine samples a pixel; seconds are of processor time of the whole process. In the room light is scattered three times at most between the floor and the eye, as by `recursion_limit 3`."""

import argparse
import pathlib

import numpy as np
import peers
from peers import numbers, pov_vector as vector

BOUNCES = 3
GREY, RED, GREEN = (0.75, 0.75, 0.75), (0.7, 0.15, 0.1), (0.15, 0.6, 0.2)

# Eye, the point that it looks at, angle, direction of the light, and boxes and balls of a colour; none is glass.
SCENES = {
    "room": {
        "eye": (0, 0, 5.5),
        "target": (0, 0, 0),
        "angle": 40,
        "light": (0.45, -0.75, -0.5),
        "boxes": [
            ((-2, -2.1, -2), (2, -2, 2), GREY),
            ((-2, 2, -2), (2, 2.1, -0.5), GREY),
            ((-2.1, -2.1, -2.1), (-2, 2.1, 2), RED),
            ((2, -2.1, -2.1), (2.1, 2.1, 2), GREEN),
            ((-2.1, -2.1, -2.1), (2.1, 2.1, -2), GREY),
            ((-1.4, -2, -1.4), (-0.3, 0.2, -0.4), GREY),
        ],
        "balls": [((0.9, -1.2, 0), 0.8, GREY)],
    },
    "ball": {
        "eye": (0, 4, 5),
        "target": (0.5, 0, 0),
        "angle": 40,
        "light": (0.5, -1, -0.1),
        "boxes": [((-4, -0.1, -4), (4, 0, 4), GREY)],
        "balls": [((0, 1.3, 0), 1, None)],
    },
}


class Kajo(peers.Kajo):
    def __init__(self, options, name, arguments):
        scene = SCENES[options.scene]
        colors = {GREY: "grey", RED: "red", GREEN: "green", None: "glass"}
        matt = " ".join(f"Matte {name} {{ color {numbers(color)} }}" for color, name in colors.items() if color)
        boxes = "\n".join(f"MaterialIndex {colors[c]} Box {{ min {numbers(low)}  max {numbers(high)} }}" for low, high, c in scene["boxes"])
        balls = "\n".join(f"MaterialIndex {colors[c]} Sphere {{ center {numbers(at)}  radius {r} }}" for at, r, c in scene["balls"])
        text = (
            f"PerspectiveCamera {{ center {numbers(scene['eye'])}  direction {numbers(np.subtract(scene['target'], scene['eye']))}  up 0 1 0  angle {scene['angle']} }}\n"
            f"Background {{ color 0 0 0 }}\nLights {{ DirectionalLight {{ direction {numbers(scene['light'])}  irradiance {np.pi} }} }}\n"
            f"Materials {{ {matt} Glass glass {{ indexOfRefraction 1.5 }} }}\nGroup {{ {boxes}\n{balls} }}\n"
        )
        super().__init__(options.kajo, options.folder, options.scene, options.size, text, [*arguments, "--filter", "box", "1"])
        self.name = f"kajo {name}"


class PovRay(peers.PovRay):
    def __init__(self, options, name, settings):
        scene = SCENES[options.scene]
        finish = "finish { ambient 0 diffuse 1 }"
        boxes = "\n".join(f"box {{ {vector(low)}, {vector(high)} pigment {{ rgb {vector(c)} }} {finish} }}" for low, high, c in scene["boxes"])
        glass = (
            "pigment { rgbt 1 } finish { ambient 0 diffuse 0 reflection { 0, 1 fresnel on } conserve_energy } interior { ior 1.5 } "
            "photons { target reflection on refraction on }"
        )
        look = lambda c: f"pigment {{ rgb {vector(c)} }} {finish}" if c else glass
        balls = "\n".join(f"sphere {{ {vector(at)}, {r} {look(c)} }}" for at, r, c in scene["balls"])
        text = (
            f"#version 3.7;\nglobal_settings {{ assumed_gamma 1 max_trace_level 20 adc_bailout 0.001 {settings} }}\n"
            f"camera {{ perspective location {vector(scene['eye'])} right -x up y angle {scene['angle']} look_at {vector(scene['target'])} }}\n"
            f"light_source {{ {vector(-50 * np.array(scene['light'], float))} rgb 1 parallel point_at 0 photons {{ reflection on refraction on }} }}\n{boxes}\n{balls}\n"
        )
        super().__init__(name, options.folder, options.scene, options.size, text)


def programs(options):
    """Each a name and what renders a picture with a seed."""
    found = []
    if options.scene == "room":
        for quality, (count, bound) in {"35, 1.8": (35, 1.8), "200, 0.5": (200, 0.5), "800, 0.25": (800, 0.25)}.items():
            radiosity = f"radiosity {{ pretrace_start 0.08 pretrace_end 0.005 count {count} nearest_count 10 error_bound {bound} recursion_limit {BOUNCES} low_error_factor 0.5 brightness 1 }}"
            program = PovRay(options, f"radiosity {quality}", radiosity)
            found.append((program.name, program.run))
        path = ["--integrator", "path", "--bounces", BOUNCES]
        cache = ["--integrator", "irradiance", "--bounces", BOUNCES]
        cases = [("path", path, 4), ("path", path, 16), ("path", path, 64), ("irradiance", cache, 4), ("irradiance", cache, 16)]
    else:
        for count in (20_000, 200_000, 1_000_000):
            program = PovRay(options, f"{count} photons", f"photons {{ count {count} }}")
            found.append((program.name, program.run))
        cases = [(name, ["--integrator", name, "--bounces", 10], samples) for name in ("sppm", "vcm") for samples in (4, 16, 64)]
        walk = ["--integrator", "path", "--caustics", "manifold", "--bounces", 10]
        cases += [("path, manifold", walk, 4), ("path, manifold", walk, 16)]
    for name, arguments, samples in cases:
        program = Kajo(options, f"{name}, {samples} samples", arguments)
        found.append((program.name, lambda seed, program=program, samples=samples: program.render(samples, seed)))
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--scene", choices=list(SCENES), default="room")
    parser.add_argument("--kajo", default="target/release/kajo")
    parser.add_argument("--size", type=int, default=192)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--reference", type=int, default=4096, help="samples of the reference")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    by = ["--integrator", "path", "--bounces", BOUNCES] if options.scene == "room" else ["--integrator", "sppm", "--bounces", 10]
    reference, _ = Kajo(options, "reference", by).render(options.reference, 100)
    found = programs(options)
    runs = [[run(seed) for _, run in found] for seed in range(1, options.runs + 1)]
    peers.rows_by_reference([(name, reference) for name, _ in found], runs)


if __name__ == "__main__":
    main()
