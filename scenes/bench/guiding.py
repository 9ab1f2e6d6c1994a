#!/usr/bin/env python3
"""Path tracing with and without `guiding on`: squared errors with as many samples, and in the same time.

    pip install numpy
    scenes/bench/guiding.py DIR [--kajo FILE] [--size W H] [--samples N] [--runs N] [--reference N] [SCENE]...

Each scene is rendered by guided paths with its default training, then by plain paths with as many samples, and with as many as take the same processor time of the whole program. The error is the mean of
`(a - r)^2 / (r^2 + m^2/100)` beside a picture `r` of mean `m` by guided paths with many more samples, which have the same mean as plain ones; of all values, and of all but the largest one in a hundred. Both are means over
runs with other seeds. Without scenes: the room with a door ajar, and eight others."""

import argparse
import pathlib
import resource
import subprocess

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
GALLERY = HERE.parent / "gallery"
SCENES = [GALLERY / f"{name}.txt" for name in ["ajar", "gap", "keyhole", "marble_hall", "cornell", "lights", "materials", "drinks", "clear_sky"]]


def render(options, scene, guiding, samples, seed, training=None):
    """The picture and the processor time."""
    out = options.folder / "guiding.pfm"
    command = [options.kajo, "render", scene, "-o", out, "--size", *options.size, "--integrator", "path", "--guiding", guiding, "--samples", "sobol", samples]
    command += ["--seed", seed, "--quiet"] + (["--training", training] if training else [])
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run(list(map(str, command)), check=True, stderr=subprocess.DEVNULL)
    seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    picture = np.frombuffer(out.read_bytes().split(b"\n", 3)[3], "<f4").astype(float)
    return picture, seconds


def errors(options, scene, reference, guiding, samples):
    """Mean errors of all values and of all but the largest one in a hundred, and mean seconds."""
    scale = reference**2 + reference.mean() ** 2 / 100
    sums = np.zeros(3)
    for seed in range(options.runs):
        picture, seconds = render(options, scene, guiding, samples, seed)
        squared = np.sort((picture - reference) ** 2 / scale)
        sums += squared.mean(), squared[: -squared.size // 100].mean(), seconds
    return sums / options.runs


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("scenes", type=pathlib.Path, nargs="*", default=SCENES)
    parser.add_argument("--kajo", default="kajo")
    parser.add_argument("--size", nargs=2, type=int, default=[128, 80])
    parser.add_argument("--samples", type=int, default=256)
    parser.add_argument("--runs", type=int, default=4)
    parser.add_argument("--reference", type=int, default=8192)
    options = parser.parse_intermixed_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    print("| scene | guided | s | plain, samples | s | plain, time | s | ratio, samples | of 99 % | ratio, time | of 99 % |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    for scene in options.scenes:
        reference, _ = render(options, scene, "on", options.reference, 1000, training=64)
        guided = errors(options, scene, reference, "on", options.samples)
        alike = errors(options, scene, reference, "off", options.samples)
        timed = errors(options, scene, reference, "off", max(1, round(options.samples * guided[2] / alike[2])))
        figures = " | ".join(f"{error:.3e} | {seconds:.1f}" for error, _, seconds in (guided, alike, timed))
        ratios = " | ".join(f"{guided[i] / plain[i]:.2f}" for plain in (alike, timed) for i in (0, 1))
        print(f"| {scene.stem} | {figures} | {ratios} |", flush=True)


if __name__ == "__main__":
    main()
