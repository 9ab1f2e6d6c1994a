#!/usr/bin/env python3
"""Fog with lights in it, path traced by kajo, Mitsuba 3 (`volpathmis`) and Blender's Cycles: what an error costs.

    pip install mitsuba bpy numpy
    scenes/bench/fog.py DIR [--lights spot|spots|points] [--kajo FILE]... [--size N] [--samples N] [--runs N] [--bounces N] [--variant NAME]... [--without-cycles] [--without-mitsuba]

A closed room of one matt colour is filled with a homogeneous medium. One thread each, the programs take turns. The error is that of one picture, from
pictures that differ in the seed only, of all pixels and of all but the worst one in a hundred, which for points of light are those that show them; seconds are of processor time, of the render call of Mitsuba, and of all of kajo's and Cycles' work less
that of one sample. "error x s" is what an error costs, however many samples are taken. Means are printed because errors of different pictures say
nothing: the lights of each program are scaled so that its picture has the mean of kajo's first one."""

import argparse
import pathlib

import numpy as np
import peers
from peers import numbers

EYE, TARGET, VIEW_ANGLE = (0, 1.6, 3.8), (0, 1.3, 0), 50
ROOM = ((-3, 0, -3), (3, 3, 4))
ALBEDO, SCATTERING, ABSORPTION, G = 0.5, 0.12, 0.01, 0.4
# Position, direction, full angle of the cone in degrees or none, intensity in W/sr.
LIGHTS = {
    "spot": [((-1.2, 2.8, -0.5), (0.5, -1, 0.1), 24, 10)],
    "spots": [((-1.2, 2.8, -0.5), (0.5, -1, 0.1), 24, 8), ((1.5, 2.7, 0), (-0.4, -1, -0.2), 16, 12), ((2.6, 1, -2), (-1, 0.1, 0.2), 10, 20),
              ((-2.5, 0.6, 0.5), (1, 0.4, -0.6), 14, 14)],
    "points": [((-1.2, 2.2, -0.5), None, None, 1), ((1.5, 1.7, 0), None, None, 0.6), ((2.2, 1, -2), None, None, 1.2), ((-2, 0.6, 0.5), None, None, 0.4),
               ((0.3, 2.5, -2), None, None, 1), ((0, 0.4, 1), None, None, 0.2)],
}  # fmt: skip


class Kajo(peers.Kajo):
    def __init__(self, options, program):
        self.samples = options.samples
        lights = [
            f"SpotLight {{ position {numbers(p)}  direction {numbers(d)}  angle {angle} innerAngle {angle}  intensity {i} }}"
            if angle
            else f"PointLight {{ position {numbers(p)}  intensity {i} }}"
            for p, d, angle, i in LIGHTS[options.lights]
        ]
        low, high = ROOM
        text = (
            f"PerspectiveCamera {{ center {numbers(EYE)}  direction {numbers(np.subtract(TARGET, EYE))}  up 0 1 0  angle {VIEW_ANGLE} }}\n"
            f"Background {{ color 0 0 0 }}\nMedia {{ Medium fog {{ sigma_s {SCATTERING}  sigma_a {ABSORPTION}  g {G} }}  exterior fog }}\n"
            f"Materials {{ Matte wall {{ color {ALBEDO} {ALBEDO} {ALBEDO} }} }}\nLights {{ {' '.join(lights)} }}\n"
            f"Group {{ MaterialIndex wall  Box {{ min {numbers(low)}  max {numbers(high)} }} }}\n"
        )
        arguments = ["--integrator", "path", "--bounces", options.bounces]
        super().__init__(program, options.folder, f"fog_{options.lights}", options.size, text, arguments)

    def run(self, seed):
        return super().run(self.samples, seed)


class Mitsuba(peers.Mitsuba):
    def __init__(self, options, variant):
        super().__init__(variant, options.size, options.samples, EYE, TARGET, VIEW_ANGLE)
        self.sensor["medium"] = {"type": "ref", "id": "fog"}
        T = self.mi.ScalarTransform4f
        fog = {"type": "homogeneous", "albedo": SCATTERING / (SCATTERING + ABSORPTION), "sigma_t": SCATTERING + ABSORPTION,
               "phase": {"type": "hg", "g": G}, "sample_emitters": True}  # fmt: skip
        low, high = (np.array(v, float) for v in ROOM)
        wall = {"type": "twosided", "side": {"type": "diffuse", "reflectance": {"type": "rgb", "value": ALBEDO}}}
        box = {"type": "cube", "to_world": T().translate((low + high) / 2).scale((high - low) / 2), "bsdf": wall, "interior": {"type": "ref", "id": "fog"}}
        scene = {"fog": fog, "integrator": {"type": "volpathmis", "max_depth": options.bounces + 2}, "room": box}
        for i, (p, d, angle, intensity) in enumerate(LIGHTS[options.lights]):
            light = {"type": "point", "position": list(p), "intensity": {"type": "rgb", "value": intensity}}
            if angle:
                light = {"type": "spot", "to_world": T().look_at(origin=p, target=np.add(p, d), up=[0, 0, 1]), "cutoff_angle": angle / 2,
                         "beam_width": angle / 2 * 0.999, "intensity": {"type": "rgb", "value": intensity}}  # fmt: skip
            scene[f"light{i}"] = light | {"medium": {"type": "ref", "id": "fog"}}
        self.load(scene)


class Cycles(peers.Cycles):
    def __init__(self, options):
        super().__init__(options.folder, options.size, options.samples, options.bounces)
        low, high = (np.array(v, float) for v in ROOM)
        self.bpy.ops.mesh.primitive_cube_add(size=1, location=(low + high) / 2, scale=high - low)
        self.bpy.context.object.data.materials.append(self.wall())
        for p, d, angle, intensity in LIGHTS[options.lights]:
            light = self.light("SPOT" if angle else "POINT", 4 * np.pi * intensity, p, d)
            light.shadow_soft_size = 0
            if angle:
                light.spot_size, light.spot_blend = np.radians(angle), 0
        self.sky(0)
        self.camera(EYE, TARGET, VIEW_ANGLE)

    def wall(self):
        """Matt walls of a box that is filled with the medium."""
        material, node = self.material()
        kinds = ("OutputMaterial", "BsdfDiffuse", "VolumeScatter", "VolumeAbsorption", "AddShader")
        out, diffuse, scatter, absorb, add = map(node, kinds)
        diffuse.inputs["Color"].default_value = (ALBEDO, ALBEDO, ALBEDO, 1)
        scatter.inputs["Color"].default_value, absorb.inputs["Color"].default_value = (1, 1, 1, 1), (0, 0, 0, 1)
        scatter.inputs["Density"].default_value, absorb.inputs["Density"].default_value = SCATTERING, ABSORPTION
        scatter.inputs["Anisotropy"].default_value = G
        links = material.node_tree.links
        links.new(scatter.outputs[0], add.inputs[0])
        links.new(absorb.outputs[0], add.inputs[1])
        links.new(diffuse.outputs[0], out.inputs["Surface"])
        links.new(add.outputs[0], out.inputs["Volume"])
        return material


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=lambda name: pathlib.Path(name).resolve())
    parser.add_argument("--kajo", action="append", help="any number of programs; kajo where none is named")
    parser.add_argument("--lights", choices=LIGHTS, default="spot")
    for name, default in (("size", 128), ("samples", 64), ("runs", 4), ("bounces", 8)):
        parser.add_argument(f"--{name}", type=int, default=default)
    parser.add_argument("--variant", action="append", help="Mitsuba's; scalar_rgb where none is named")
    parser.add_argument("--without-cycles", action="store_true")
    parser.add_argument("--without-mitsuba", action="store_true")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    programs = [Kajo(options, program) for program in options.kajo or ["kajo"]]
    programs += [] if options.without_mitsuba else [Mitsuba(options, variant) for variant in options.variant or ["scalar_rgb"]]
    programs += [] if options.without_cycles else [Cycles(options)]
    peers.rows_by_variance(programs, options.runs)


if __name__ == "__main__":
    main()
