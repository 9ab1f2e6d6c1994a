#!/usr/bin/env python3
"""The squared error of path tracing at equal numbers of samples, beside Mitsuba 3 and its multijitter sampler.

    pip install mitsuba numpy
    scenes/bench/errors_mitsuba.py [--kajo FILE] [--samples N] [--pattern NAME] [--size N] [--runs N] [SCENE]...

The scenes are those of errors/ and cornell_box.txt that both programs can say alike. The error is that of one picture, from pictures that differ in
the seed only; the means of both are printed too, since errors of different pictures say nothing. An error says nothing of time: see paths.sh.
"""

import argparse
import pathlib
import subprocess
import tempfile

import mitsuba as mi
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
BOUNCES = 6

mi.set_variant("scalar_rgb")


def rgb(*values):
    return {"type": "rgb", "value": list(values * 3 if len(values) == 1 else values)}


def diffuse(*color):
    return {"type": "twosided", "side": {"type": "diffuse", "reflectance": rgb(*color)}}


def quad(corner, edge1, edge2, bsdf, radiance=None):
    corner, edge1, edge2 = (np.array(v, float) for v in (corner, edge1, edge2))
    n = np.cross(edge1, edge2)
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 1] = edge1 / 2, edge2 / 2
    matrix[:3, 2], matrix[:3, 3] = n / np.linalg.norm(n), corner + (edge1 + edge2) / 2
    shape = {"type": "rectangle", "to_world": mi.ScalarTransform4f(matrix), "bsdf": bsdf}
    return shape | ({"emitter": {"type": "area", "radiance": radiance}} if radiance else {})


def sphere(center, radius, bsdf):
    return {"type": "sphere", "center": center, "radius": radius, "bsdf": bsdf}


BLACK = {"type": "diffuse", "reflectance": rgb(0.0)}
EMITTED = rgb(12.0, 11.0, 9.0)
FLOOR = quad((-5, 0, 5), (10, 0, 0), (0, 0, -10), diffuse(0.5, 0.6, 0.4))
BLUE = diffuse(0.2, 0.5, 0.9)
BALLS = [
    sphere([-0.5, 0.8, 0], 0.8, diffuse(0.8, 0.3, 0.2)),
    sphere([1, 0.4, 0.9], 0.4, BLUE),
    sphere([1.3, 0.6, -1], 0.6, BLUE),
]
EMITTER = quad((-0.5, 3, 0.5), (0, 0, -1), (1, 0, 0), BLACK, EMITTED)
TWO_EMITTERS = [
    quad((-1.5, 3, 0.5), (0, 0, -1), (1, 0, 0), BLACK, EMITTED),
    quad((1, 2.5, 0.5), (0, 0, -1), (0.5, 0, 0), BLACK, EMITTED),
]


def rough_metal(name, alpha):
    return {"type": "roughconductor", "material": name, "distribution": "ggx", "alpha": alpha}


def glossy_metals():
    wall = diffuse(0.6, 0.6, 0.6)
    gold, copper = rough_metal("Au", 0.0625), rough_metal("Cu", 0.16)
    return [
        quad((-5, 0, 5), (10, 0, 0), (0, 0, -10), rough_metal("Ag", 0.16)),
        sphere([-0.5, 0.8, 0], 0.8, gold),
        sphere([1, 0.4, 0.9], 0.4, copper),
        sphere([1.3, 0.6, -1], 0.6, copper),
        quad((-3, 0, 6), (0, 4, 0), (0, 0, -9), wall),
        quad((3, 0, -3), (0, 4, 0), (0, 0, 9), wall),
        quad((-3, 0, 6), (6, 0, 0), (0, 4, 0), wall),
        quad((-3, 4, -3), (6, 0, 0), (0, 0, 9), wall),
        quad((-3, 0, -3), (6, 0, 0), (0, 4, 0), wall),
        EMITTER,
    ]


def sky(radiance):
    return {"type": "constant", "radiance": rgb(radiance)}


def bitmap(name):
    """A picture of one channel, as one of three."""
    grey = np.array(mi.Bitmap(str(HERE / "errors" / name)), dtype=np.float32)
    return mi.Bitmap(np.repeat(grey.reshape(*grey.shape[:2], 1), 3, axis=2))


def pictured_sky(name):
    turned = mi.ScalarTransform4f().rotate([0, 1, 0], 180)
    return {"type": "envmap", "bitmap": bitmap(name), "to_world": turned}


def slide(name, scale, corner, edge1, edge2):
    pixels = np.array(bitmap(name)) * scale
    radiance = {"type": "bitmap", "bitmap": mi.Bitmap(pixels), "raw": True, "wrap_mode": "clamp"}
    return quad(corner, edge1, edge2, BLACK, radiance)


def scenes():
    things = [FLOOR, *BALLS]
    return {
        "constant_sky": [*things, sky(0.5)],
        "glossy_metals": glossy_metals(),
        "dim_sky": [*things, EMITTER, sky(0.001)],
        "sky_and_rectangle": [*things, EMITTER, sky(0.3)],
        "soft_slide": [*things, slide("soft.pfm", 4, (-1, 1.9, 1), (0, 0, -2), (2, 0, 0))],
        "sunny_sky": [*things, pictured_sky("sunny.pfm")],
        "textured_square": [*things, slide("bright_texel.pfm", 200, (-1, 3, 1), (0, 0, -2), (2, 0, 0))],
        "two_pixel_sun": [*things, pictured_sky("two_pixel_sun.pfm")],
        "two_rectangles": [*things, *TWO_EMITTERS],
    }


def mitsuba_scene(name, size, samples):
    film = {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}, "pixel_format": "rgb"}
    sampler = {"type": "multijitter", "sample_count": samples}
    integrator = {"type": "path", "max_depth": BOUNCES + 2}
    if name == "cornell_box":
        scene = mi.cornell_box()
        scene["sensor"] |= {"film": film, "sampler": sampler}
        return mi.load_dict(scene | {"integrator": integrator})
    view = mi.ScalarTransform4f().look_at(origin=[0, 2.2, 5], target=[0, 0.7, 0], up=[0, 1, 0])
    sensor = {"type": "perspective", "fov": 40, "fov_axis": "y", "to_world": view, "film": film, "sampler": sampler}
    shapes = {f"shape{i}": shape for i, shape in enumerate(scenes()[name])}
    return mi.load_dict({"type": "scene", "sensor": sensor, "integrator": integrator, **shapes})


def kajo_pictures(kajo, name, options):
    file = HERE / ("cornell_box.txt" if name == "cornell_box" else f"errors/{name}.txt")
    with tempfile.TemporaryDirectory() as work:
        out = str(pathlib.Path(work) / "picture.pfm")
        for seed in range(1, options.runs + 1):
            command = [kajo, "render", str(file), "-o", out, "--integrator", "path", "--bounces", str(BOUNCES)]
            command += ["--size", f"{options.size}x{options.size}", "--samples", options.pattern, str(options.samples)]
            subprocess.run([*command, "--seed", str(seed), "--threads", "1", "--quiet"], check=True)
            yield np.array(mi.Bitmap(out), dtype=float)


def mitsuba_pictures(name, options):
    scene = mitsuba_scene(name, options.size, options.samples)
    for seed in range(options.runs):
        yield np.array(mi.render(scene, spp=options.samples, seed=seed), dtype=float)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kajo", default="kajo")
    parser.add_argument("--pattern", default="sobol", help="kajo's sample pattern")
    for name, default in (("samples", 64), ("size", 64), ("runs", 8)):
        parser.add_argument(f"--{name}", type=int, default=default)
    known = [*scenes(), "cornell_box"]
    parser.add_argument("scene", nargs="*", help=f"any of {', '.join(known)}")
    options = parser.parse_args()
    print("| scene | kajo | Mitsuba | ratio | means |\n|---|---|---|---|---|")
    for name in options.scene or known:
        pictures = [np.stack(list(p)) for p in (kajo_pictures(options.kajo, name, options), mitsuba_pictures(name, options))]
        kajo, mitsuba = (p.var(axis=0, ddof=1).mean() for p in pictures)
        means = ", ".join(f"{p.mean():.5f}" for p in pictures)
        print(f"| {name} | {kajo:.3g} | {mitsuba:.3g} | {kajo / mitsuba:.2f} | {means} |", flush=True)


if __name__ == "__main__":
    main()
