#!/usr/bin/env python3
"""Writes the IES files of scenes/gallery/luminaires.txt.

    python3 scenes/tools/luminaires.py scenes/gallery/luminaires

Five invented luminaires, each a formula for candela by the vertical angle v and the horizontal angle h in degrees.
"""

import math
import os
import sys


def bell(x, width):
    return math.exp(-((x / width) ** 2))


def spot(v, h):
    """A reflector: a narrow beam, the rings of its facets, and some stray light."""
    rings = 1 + 0.35 * math.cos(math.radians(v * 30)) * bell(v, 30)
    return 1500 * bell(v, 13) * rings + 60 * bell(v, 45)


def batwing(v, h):
    """Most light to the sides, as over a desk."""
    return 420 * bell(v - 38, 13) + 90 * bell(v, 45)


def up_and_down(v, h):
    """A wall light: a wide lobe down and a narrower one up."""
    return 700 * bell(v, 17) + 1100 * bell(180 - v, 10) + 12


def wall_washer(v, h):
    """Throws its light towards the horizontal angle 0."""
    towards = math.cos(math.radians(h))
    return 900 * bell(v - 30 * max(towards, 0) - 8, 16) * (0.55 + 0.45 * towards)


def petals(v, h):
    """Six petals around the axis."""
    return 800 * bell(v - 30, 16) * math.cos(math.radians(3 * h)) ** 2 + 260 * bell(v, 10)


def every(step, last):
    return [step * i for i in range(round(last / step) + 1)]


LUMINAIRES = {
    "spot": (spot, every(2, 90), [0]),
    "batwing": (batwing, every(5, 90), [0]),
    "up_and_down": (up_and_down, every(5, 180), [0]),
    "wall_washer": (wall_washer, every(5, 90), every(15, 180)),
    "petals": (petals, every(5, 90), every(10, 90)),
}


def main(folder):
    for name, (intensity, vertical, horizontal) in LUMINAIRES.items():
        with open(os.path.join(folder, name + ".ies"), "w", encoding="ascii") as out:
            out.write(f"IESNA:LM-63-2002\n[MANUFAC] invented\n[LUMCAT] {name}\nTILT=NONE\n")
            out.write(f"1 -1 1 {len(vertical)} {len(horizontal)} 1 2 0 0 0\n1 1 20\n")
            for angles in (vertical, horizontal):
                out.write(" ".join(str(angle) for angle in angles) + "\n")
            for h in horizontal:
                out.write(" ".join(f"{intensity(v, h):.1f}" for v in vertical) + "\n")


if __name__ == "__main__":
    main(sys.argv[1])
