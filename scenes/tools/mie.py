#!/usr/bin/env python3
"""Writes scenes/gallery/phases/fog.txt: how the droplets of a fog scatter light, by Mie's solution for balls of water.

The series of [Bohren and Huffman 1983, appendix A], for light without polarisation, summed over droplets of many sizes
and over three wavelengths. One line an angle in degrees: the angle, and the value in any unit.
"""

import math
import pathlib

INDEX = {0.45: 1.337, 0.55: 1.333, 0.65: 1.331}
MEAN_RADIUS = 10.0
SPREAD = 0.1
ANGLES = [0, 0.25, 0.5, 0.75, 1, 1.5, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 25, 30]
ANGLES += list(range(35, 120, 5)) + [a / 2 for a in range(240, 361)]


def intensity(x, m, cosines):
    """|S1|^2 + |S2|^2 of a ball of size parameter x and index m."""
    stop = int(x + 4 * x ** (1 / 3) + 2)
    y = m * x
    start = int(max(stop, abs(y)) + 16)
    d = [0.0] * (start + 1)
    for n in range(start, 0, -1):
        d[n - 1] = n / y - 1 / (d[n] + n / y)
    psi0, psi1 = math.cos(x), math.sin(x)
    chi0, chi1 = -math.sin(x), math.cos(x)
    xi1 = complex(psi1, -chi1)
    pi0, pi1 = [0.0] * len(cosines), [1.0] * len(cosines)
    s1, s2 = [0j] * len(cosines), [0j] * len(cosines)
    for n in range(1, stop + 1):
        psi = (2 * n - 1) * psi1 / x - psi0
        chi = (2 * n - 1) * chi1 / x - chi0
        xi = complex(psi, -chi)
        a = ((d[n] / m + n / x) * psi - psi1) / ((d[n] / m + n / x) * xi - xi1)
        b = ((d[n] * m + n / x) * psi - psi1) / ((d[n] * m + n / x) * xi - xi1)
        factor = (2 * n + 1) / (n * (n + 1))
        for j, mu in enumerate(cosines):
            tau = n * mu * pi1[j] - (n + 1) * pi0[j]
            s1[j] += factor * (a * pi1[j] + b * tau)
            s2[j] += factor * (a * tau + b * pi1[j])
            pi0[j], pi1[j] = pi1[j], ((2 * n + 1) * mu * pi1[j] - (n + 1) * pi0[j]) / n
        psi0, psi1 = psi1, psi
        chi0, chi1 = chi1, chi
        xi1 = complex(psi1, -chi1)
    return [abs(u) ** 2 + abs(v) ** 2 for u, v in zip(s1, s2)]


cosines = [math.cos(math.radians(a)) for a in ANGLES]
total = [0.0] * len(ANGLES)
for step in range(-30, 31):
    radius = MEAN_RADIUS * (1 + SPREAD * step / 12)
    weight = math.exp(-0.5 * (step / 12) ** 2)
    for wavelength, m in INDEX.items():
        k = 2 * math.pi / wavelength
        for j, value in enumerate(intensity(k * radius, m, cosines)):
            total[j] += weight * value / k**2

out = pathlib.Path(__file__).parent.parent / "gallery/phases/fog.txt"
out.parent.mkdir(exist_ok=True)
side = total[ANGLES.index(90)]
lines = [f"{angle:g} {value / side:.5g}" for angle, value in zip(ANGLES, total)]
head = f"# Light scattered by droplets of water of {MEAN_RADIUS:g} micrometres: degrees, value. Written by scenes/tools/mie.py.\n"
out.write_text(head + "\n".join(lines) + "\n")
