#!/usr/bin/env python3
"""Three of POV-Ray's sample scenes by POV-Ray and by kajo: what an error costs with its radiosity and its photons.

    apt-get install povray povray-examples; pip install numpy
    scenes/bench/povray_samples.py DIR [--scene radiosity3|cornell|phot_met_glass] [--examples DIR] [--kajo FILE] [--size N] [--runs N]

POV-Ray renders its own files with their settings and with better ones, kajo a scene of the same shapes, colours and lights; one thread each, the programs take turns. What is changed in all of them is the camera, which makes
a square. In `phot_met_glass` the light is forty times as far away, since it does not fade with distance, and what POV-Ray calls ambient is off, since no light brings it. Materials and lights of the last two are like POV-Ray's and not the
same, so the error of a picture is that against one of the same program with its best settings; for `radiosity3`, whose light is the same to both, it is that against kajo's paths. Errors are relative to the squared mean of the picture, of all pixels,
of all but the worst one in a hundred, and of all but the worst one in ten, which is without the edges, where POV-Ray takes some nine samples a pixel; seconds are of processor time of the whole process."""

import argparse
import pathlib
import re

import numpy as np
import peers
from peers import numbers, pov_vector as vector

EXAMPLES = pathlib.Path("/usr/share/doc/povray/examples")


def box(material, low, high):
    return f"MaterialIndex {material} Box {{ min {numbers(low)}  max {numbers(high)} }}"


def triangles(material, *corners):
    """Two triangles for every four corners around a face."""
    lines = [f"MaterialIndex {material}"]
    for a, b, c, d in corners:
        lines += [f"Triangle {{ vertex0 {numbers(p)}  vertex1 {numbers(q)}  vertex2 {numbers(r)} }}" for p, q, r in ((a, b, c), (a, c, d))]
    return "\n".join(lines)


def block(material, height, *corners):
    """A prism that stands on the floor, with four corners around it."""
    at = lambda corner, y: (corner[0], y, corner[1])
    sides = [(at(p, 0), at(p, height), at(q, height), at(q, 0)) for p, q in zip(corners, corners[1:] + corners[:1])]
    return triangles(material, [at(p, height) for p in corners], *sides)


class RadiosityTutorial:
    """Solids under an even sky: what one gathering of its light by each pixel costs."""

    FILE, EYE, TARGET, ANGLE = "radiosity/radiosity3.pov", (3.8, 7.2, -10), (0, 1.2, 0), 56.3
    SKY = 1.4 * np.array([0.7, 0.705, 1])
    ONE_REFERENCE = True

    @classmethod
    def text(cls):
        colors = {"white": (1, 1, 1), "rose": (1, 0.7, 0.6), "blue": (0.6, 0.7, 1)}
        materials = " ".join(f"Matte {name} {{ color {numbers(0.65 * np.array(color))} }}" for name, color in colors.items())
        lines = [f"Background {{ color {numbers(cls.SKY)} }}\nMaterials {{ {materials} }}\nGroup {{\nMaterialIndex white Plane {{ normal 0 1 0  offset 0 }}"]
        lines += ["MaterialIndex rose Transform { Translate -1.6 0.5 -4.1  XRotate 90  Superellipsoid { radius 1  east 0.7  north 0.3 } }"]
        lines += ["MaterialIndex blue Cylinder { base 1.8 0 -0.75  top 1.8 1.8 -0.75  radius 1 } Sphere { center 1.8 1.8 -0.75  radius 1 }"]
        lines += ["MaterialIndex white Torus { center -1.6 0 -4.1  axis 0 0 1  majorRadius 2.1  minorRadius 0.3 }"]
        for i in range(6):
            x, height, z = 5.2 - 0.3 * i, 1 + 0.6 * i, i - 3
            lines += [f"Cylinder {{ base {x:g} 0 {z}  top {x:g} {height:g} {z}  radius 0.25 }}"]
            lines += [f"Transform {{ Translate {x:g} {height:g} {z}  Scale 1 0.3 1  Sphere {{ center 0 0 0  radius 0.5 }} }}"]
        lines += ["Transform { Translate 0 4.5 0  Scale 2.6 0.3 2.6  Sphere { center 0 0 0  radius 1 } } Sphere { center 0 4.8 0  radius 0.8 }"]
        lines += [box("white", (-3, 4, -3), (3, 4.2, 3)), box("white", (2.8, 0, -3), (3, 4.2, 3))]
        lines += ["Difference {", box("white", (-3, 0, -3), (-2.8, 4.2, 3)), box("white", (-5, -0.1, 0), (-2, 3.2, 2)), "}\n}\n"]
        return "\n".join(lines)

    @staticmethod
    def qualities():
        better = lambda count, bound: [(r"count 35", f"count {count}"), (r"error_bound 0\.2", f"error_bound {bound}"), (r"pretrace_end\s+0\.04", "pretrace_end 0.01")]
        return {"as it is": [], "radiosity 200, 0.2": better(200, 0.2), "radiosity 800, 0.1": better(800, 0.1)}

    # What is gathered is light of the sky alone, by `recursion_limit 1`.
    BY = ["--bounces", 0]
    CASES = [("path", 4), ("path", 16), ("path", 64), ("irradiance --rays 128", 4), ("irradiance --rays 256 --accuracy 0.02", 8), ("irradiance", 16)]
    REFERENCE = ("path", 4096)


class CornellBox:
    """The room with two blocks, its emitter as nine lights of sixteen points."""

    FILE, EYE, TARGET, ANGLE = "radiosity/cornell.pov", (27.8, 27.3, -80), (27.8, 27.3, 0), 39.5
    ONE_REFERENCE = False

    @staticmethod
    def text():
        floor, top, back = 0, 54.88, 55.92
        right = [(0, floor, 0), (0, top, 0), (0, top, back), (0, floor, back)]
        left = [(55.28, floor, 0), (55.6, top, 0), (55.6, top, back), (54.96, floor, back)]
        white = triangles("white", (right[0], left[0], left[3], right[3]), (right[1], left[1], left[2], right[2]), (right[3], right[2], left[2], left[3]))
        radiance = np.array([1, 0.67, 0.21]) * 30
        return "\n".join(
            [
                "Background { color 0 0 0 }\nMaterials { Matte white { color 0.75 0.75 0.75 } Matte red { color 0.43 0.019 0.019 } Matte green { color 0.019 0.177 0.019 }",
                f"Matte emitter {{ color 0 0 0  emission {numbers(radiance)} }} }}\nGroup {{",
                white,
                triangles("green", right),
                triangles("red", left),
                block("white", 16.5, (13, 6.5), (8.2, 22.5), (24, 27.2), (29, 11.4)),
                block("white", 33, (42.3, 24.7), (26.5, 29.6), (31.4, 45.6), (47.2, 40.6)),
                "MaterialIndex emitter Quad { corner 21.3 54.87 22.7  edge1 13 0 0  edge2 0 0 10.5 }\n}\n",
            ]
        )

    @staticmethod
    def qualities():
        better = lambda count, bound: [(r"count 200", f"count {count}"), (r"error_bound 0\.5", f"error_bound {bound}"), (r"pretrace_end 0\.01", "pretrace_end 0.005")]
        return {"as it is": [], "radiosity 800, 0.25": better(800, 0.25), "reference": better(1600, 0.1)}

    BY = ["--bounces", 4]
    CASES = [("path", 4), ("path", 16), ("path", 64), ("irradiance --rays 512", 16), ("irradiance", 4), ("irradiance", 16), ("irradiance", 64)]
    REFERENCE = ("path", 4096)


class MetalAndGlass:
    """A ball of red glass in a frame of metal, and a ring around them: caustics of all three."""

    FILE, EYE, TARGET, ANGLE = "lights/phot_met_glass.pov", (20, 5, 10), (0, -1, 0), 34
    ONE_REFERENCE = False

    @staticmethod
    def text():
        irradiance = np.pi * np.array([1.3, 1.2, 1.1])
        absorption = -np.log([0.75, 0.2, 0.25]) / 2
        bars = [((-0.8, -0.8, -1.5), (0.8, 0.8, 1.5)), ((-0.8, -1.5, -0.8), (0.8, 1.5, 0.8)), ((-1.5, -0.8, -0.8), (1.5, 0.8, 0.8))]
        return "\n".join(
            [
                f"Background {{ color 0 0 0 }}\nLights {{ DirectionalLight {{ direction 3 -10 -18  irradiance {numbers(irradiance)} }} }}",
                "Materials { Matte ground { color 0.6 0.6 0.6 } Material metal { diffuseColor 0.075 0.075 0.09  reflectiveColor 0.4 0.4 0.48 }",
                f"Glass glass {{ indexOfRefraction 1.5  absorption {numbers(absorption)} }} }}\nGroup {{",
                "MaterialIndex ground Plane { normal 0 1 0  offset -1 }\nMaterialIndex metal",
                "Transform { YRotate 12  Difference {",
                *(box("metal", low, high) for low, high in [((-1, -1, -1), (1, 1, 1)), *bars]),
                "} }\nDifference { Cylinder { base 0 -1 0  top 0 0 0  radius 6 } Cylinder { base 0 -2 0  top 0 1 0  radius 5.8 } }",
                "MaterialIndex glass Sphere { center 0 0 0  radius 1 }\n}\n",
            ]
        )

    @staticmethod
    def qualities():
        always = [(r"assumed_gamma 1\.0", "assumed_gamma 1.0 ambient_light 0"), (r"<-3, 10, 18>", "<-3, 10, 18>*40")]
        dense = lambda spacing: always + [(r"spacing 0\.03", f"spacing {spacing}")]
        return {"as it is": always, "spacing 0.01": dense(0.01), "reference": dense(0.003)}

    BY = ["--bounces", 24]
    CASES = [("sppm", 4), ("sppm", 16), ("sppm", 64), ("vcm", 4), ("vcm", 16)]
    REFERENCE = ("sppm", 2048)


SCENES = {"radiosity3": RadiosityTutorial, "cornell": CornellBox, "phot_met_glass": MetalAndGlass}


def povray(options, name, edits):
    """The sample with our camera and other edits, each of which changes one place."""
    scene = SCENES[options.scene]
    text = (options.examples / scene.FILE).read_text()
    camera = f"camera {{ perspective location {vector(scene.EYE)} right -x up y angle {scene.ANGLE} look_at {vector(scene.TARGET)} }}"
    for pattern, replacement in [(r"camera\s*\{[^}]*\}", camera), *edits]:
        text, count = re.subn(pattern, lambda _: replacement, text)
        if count != 1:
            raise SystemExit(f"{scene.FILE} has {count} places like {pattern}")
    return peers.PovRay(name, options.folder, options.scene, options.size, text)


def kajo(options, integrator):
    scene = SCENES[options.scene]
    camera = f"PerspectiveCamera {{ center {numbers(scene.EYE)}  direction {numbers(np.subtract(scene.TARGET, scene.EYE))}  up 0 1 0  angle {scene.ANGLE} }}\n"
    return peers.Kajo(options.kajo, options.folder, options.scene, options.size, camera + scene.text(), ["--integrator", *integrator.split(), *scene.BY, "--filter", "box", "1"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--scene", choices=list(SCENES), default="radiosity3")
    parser.add_argument("--examples", type=pathlib.Path, default=EXAMPLES)
    parser.add_argument("--kajo", default="target/release/kajo")
    parser.add_argument("--size", type=int, default=192)
    parser.add_argument("--runs", type=int, default=3)
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    scene = SCENES[options.scene]
    integrator, samples = scene.REFERENCE
    reference, _ = kajo(options, integrator).render(samples, 100)
    qualities = scene.qualities()
    best = qualities.pop("reference", None)
    other = reference if scene.ONE_REFERENCE else povray(options, "reference", best).run(0)[0]
    found = [(f"POV-Ray, {name}", povray(options, name, edits).run, other) for name, edits in qualities.items()]
    for integrator, samples in scene.CASES:
        program = kajo(options, integrator)
        found.append((f"`{integrator}`, {samples} samples", lambda seed, program=program, samples=samples: program.render(samples, seed), reference))
    runs = [[run(seed) for _, run, _ in found] for seed in range(1, options.runs + 1)]
    print(f"means of the references: kajo {reference.mean():.4f}, POV-Ray {other.mean():.4f}")
    peers.rows_by_reference([(name, against) for name, _, against in found], runs)


if __name__ == "__main__":
    main()
