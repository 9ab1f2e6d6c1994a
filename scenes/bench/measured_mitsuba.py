#!/usr/bin/env python3
"""A table of RGL's form beside Mitsuba 3 and its `measured` material.

    pip install mitsuba numpy
    scenes/bench/measured_mitsuba.py DIR [--kajo FILE] [--samples N] [--runs N]

Writes two tables to DIR, an isotropic and an anisotropic one, of smooth functions that are like nothing that was ever measured, and renders a
tilted square of each, under a sky and by a rectangle. The means of both programs are printed with how much they differ, and the largest difference between
tiles of the picture in standard errors."""

import argparse
import pathlib
import struct
import subprocess

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")
SIZE, TILES = 64, 4
NORMAL = np.array([0.3, 0.6, 1.0]) / np.linalg.norm([0.3, 0.6, 1.0])


def axes(normal):
    x = np.cross([0, 1, 0], normal)
    x /= np.linalg.norm(x)
    return x, np.cross(normal, x)


X, Y = axes(NORMAL)
LIGHT = np.array([2.0, 3.0, 3.0])


def write_tensors(path, fields):
    """Magic, version 1.0, and for each field its name, type, offset and shape."""
    head = b"tensor_file\0" + bytes([1, 0]) + struct.pack("<I", len(fields))
    offset = len(head) + sum(2 + len(name) + 2 + 1 + 8 + 8 * values.ndim for name, values in fields.items())
    body = b""
    for name, values in fields.items():
        kind = {"uint8": 1, "float32": 10}[str(values.dtype)]
        head += struct.pack("<H", len(name)) + name.encode() + struct.pack("<HBQ", values.ndim, kind, offset + len(body))
        head += struct.pack(f"<{values.ndim}Q", *values.shape)
        body += values.tobytes()
    path.write_bytes(head + body)


def table(path, azimuths):
    u, v = np.meshgrid(np.linspace(0, 1, 32), np.linspace(0, 1, 32))
    theta, turn = u * u * np.pi / 2, 2 * np.pi * v
    tilts = np.linspace(0, 1.5, 9)

    def of_views(f):
        return np.array([[f(t, a) for t in tilts] for a in azimuths], "f4")

    tone = (0.9, 0.6, 0.3)
    facets = np.exp(-np.tan(np.minimum(theta, 1.5)) ** 2 / 0.2) / (np.cos(theta) ** 4 + 1e-3) + 0.05
    write_tensors(path, {
        "description": np.frombuffer(b"made", "u1"),
        "phi_i": np.array(azimuths, "f4"),
        "theta_i": tilts.astype("f4"),
        "ndf": facets.astype("f4"),
        "sigma": (0.9 * np.cos(theta) + 0.15).astype("f4"),
        "vndf": of_views(lambda t, a: 1 + 0.8 * np.exp(-8 * (u - 0.3 * t) ** 2) + 0.3 * np.cos(turn + a) * t),
        "luminance": of_views(lambda t, a: 0.2 + np.exp(-6 * ((u - 0.5) ** 2 + (v - 0.5) ** 2)) * (1 + 0.5 * t)),
        "jacobian": np.array([1], "u1"),
        "rgb": of_views(lambda t, a: [
            c * (0.3 + 0.4 * np.sin(3 * u + t) ** 2 * (1 + 0.5 * np.sin(a)) + 0.2 * np.cos(turn + a) ** 2) for c in tone
        ]),
    })  # fmt: skip


def mitsuba_scene(file, light, samples):
    square = np.eye(4)
    square[:3, 0], square[:3, 1], square[:3, 2] = X, Y, NORMAL
    look_at = mi.ScalarTransform4f().look_at
    film = {"type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "box"}, "pixel_format": "rgb"}
    sky = {"type": "constant", "radiance": {"type": "rgb", "value": 0.5}}
    emitter = {"type": "area", "radiance": {"type": "rgb", "value": 20.0}}
    rectangle = {"type": "rectangle", "to_world": look_at(origin=LIGHT, target=[0, 0, 0], up=[0, 1, 0]).scale(0.5), "emitter": emitter}
    sampler = {"type": "independent", "sample_count": samples}
    view = look_at(origin=[0, 0, 5], target=[0, 0, 0], up=[0, 1, 0])
    return mi.load_dict({
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 2},
        "sensor": {"type": "perspective", "fov": 30, "to_world": view, "film": film, "sampler": sampler},
        "square": {"type": "rectangle", "to_world": mi.ScalarTransform4f(square), "bsdf": {"type": "measured", "filename": str(file)}},
        "light": sky if light == "sky" else rectangle,
    })  # fmt: skip


def kajo_scene(file, light, samples):
    def quad(corner, edge1, edge2):
        corner, edge1, edge2 = (" ".join(f"{v:.7f}" for v in vector) for vector in (corner, edge1, edge2))
        return f"Quad {{ corner {corner}  edge1 {edge1}  edge2 {edge2} }}"

    sky = 0.5 if light == "sky" else 0
    x, y = axes(-LIGHT / np.linalg.norm(LIGHT))
    emitter = "" if light == "sky" else f"MaterialIndex emitter {quad(LIGHT - (x + y) / 2, x, y)}"
    return f"""
PerspectiveCamera {{ center 0 0 5  direction 0 0 -1  up 0 1 0  angle 30 }}
Background {{ color {sky} {sky} {sky} }}
Settings {{ size {SIZE} {SIZE}  integrator path  samples sobol {samples}  bounces 0 }}
Materials {{ Measured table {{ file {file.name} }}  Matte emitter {{ color 0 0 0  emission 20 20 20  emits front }} }}
Group {{ MaterialIndex table {quad(-X - Y, 2 * X, 2 * Y)} {emitter} }}
"""


def tiles(pictures):
    side = SIZE // TILES
    return pictures.reshape(len(pictures), TILES, side, TILES, side, 3).mean((2, 4))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=lambda name: pathlib.Path(name).resolve())
    parser.add_argument("--kajo", default="kajo")
    parser.add_argument("--samples", type=int, default=256)
    parser.add_argument("--runs", type=int, default=4)
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    print("| table | light | kajo | Mitsuba | kajo / Mitsuba - 1 | tiles, errors |\n|---|---|---|---|---|---|")
    for name, azimuths in (("isotropic", [0]), ("anisotropic", np.linspace(-np.pi, np.pi, 9))):
        file = options.folder / f"{name}.bsdf"
        table(file, azimuths)
        for light in ("sky", "rectangle"):
            text, out = options.folder / f"{name}_{light}.txt", options.folder / "picture.pfm"
            text.write_text(kajo_scene(file, light, options.samples))
            scene, pictures = mitsuba_scene(file, light, options.samples), ([], [])
            for seed in range(1, options.runs + 1):
                subprocess.run([options.kajo, "render", text, "-o", out, "--seed", str(seed), "--quiet"], check=True)
                pictures[0].append(np.array(mi.Bitmap(str(out)), dtype=float))
                pictures[1].append(np.array(mi.render(scene, seed=seed), dtype=float))
            kajo, mitsuba = (np.stack(p) for p in pictures)
            a, b = tiles(kajo), tiles(mitsuba)
            error = np.sqrt((a.var(0, ddof=1) + b.var(0, ddof=1)) / options.runs + (1e-4 * b.mean(0) + 1e-7) ** 2)
            worst = np.abs((a.mean(0) - b.mean(0)) / error).max()
            ours, theirs = kajo.mean(), mitsuba.mean()
            print(f"| {name} | {light} | {ours:.5f} | {theirs:.5f} | {ours / theirs - 1:+.1e} | {worst:.1f} |", flush=True)


if __name__ == "__main__":
    main()
