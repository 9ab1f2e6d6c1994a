#!/usr/bin/env python3
"""The disk of a spinning black hole by kajo and by Gyoto (Debian: gyoto-bin), one thread each: intensities and time.

    scenes/bench/gyoto.py [--kajo FILE] [--size N] [--spin A] [--inclination DEGREES]

Gyoto says what all wavelengths carry together, g^4 F(r). kajo shows luminance, and of black bodies as hot as this luminance says
their temperature, whose fourth power that is. Both cameras are a thousand masses away, and look through the middles of the same pixels.
"""

import argparse
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

DISTANCE = 1000.0
FIELD = 0.04  # radians
HOTTEST = 3e5  # K, in the frame of the gas
OUTER = 14.0

GYOTO = """<?xml version="1.0" encoding="UTF-8" standalone="no"?>
<Scenery>
  <Metric kind="KerrBL"><Spin>{spin}</Spin></Metric>
  <Screen>
    <Distance unit="geometrical">{distance}</Distance>
    <Time unit="geometrical_time">{distance}</Time>
    <FieldOfView unit="radian">{field}</FieldOfView>
    <Inclination unit="degree">{inclination}</Inclination>
    <PALN>0</PALN><Argument>0</Argument>
    <Resolution>{size}</Resolution>
  </Screen>
  <Astrobj kind="PageThorneDisk">
    <InnerRadius>0</InnerRadius><OuterRadius>{outer}</OuterRadius><RMax>50</RMax>
  </Astrobj>
  <MinimumTime>-5000.</MinimumTime>
  <Quantities>User4</Quantities>
</Scenery>
"""

KAJO = """Settings {{ integrator path  size {size} {size}  samples regular 1  filter none  bounces 1 }}
PerspectiveCamera {{ center 0 {y} {z}  direction 0 {down} {back}  up 0 1 0  angle {angle} }}
Background {{ color 0 0 0 }}
Media {{ BlackHole hole {{ mass 1  spin {spin}  axis 0 1 0 }} }}
Materials {{
  Interface space {{ medium hole }}
  AccretionDisk gas {{ hole hole  temperature {hottest}  luminance 1 }}
}}
Group {{
  MaterialIndex space  Sphere {{ center 0 0 0  radius 1100 }}
  MaterialIndex gas    Disk {{ center 0 0 0  normal 0 1 0  innerRadius {inner}  radius {outer} }}
}}
"""


def innermost_orbit(a):
    """Radial coordinate of the innermost stable orbit [Bardeen, Press and Teukolsky 1972, eq. 2.21]."""
    z1 = 1 + (1 - a * a) ** (1 / 3) * ((1 + a) ** (1 / 3) + (1 - a) ** (1 / 3))
    z2 = np.sqrt(3 * a * a + z1 * z1)
    return 3 + z2 - np.sqrt((3 - z1) * (3 + z1 + 2 * z2))


def run(command):
    """Seconds of processor time that a command takes."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def read_fits(path, size):
    """The numbers of a picture: doubles, most significant byte first, behind a head of blocks of 2880 bytes."""
    data = path.read_bytes()
    head = 0
    while b"END     " not in data[head : head + 2880]:
        head += 2880
    return np.frombuffer(data, ">f8", size * size, head + 2880).reshape(size, size)


def read_pfm(path):
    """Luminances, from the bottom row to the top."""
    with path.open("rb") as file:
        kind, (width, height) = file.readline().strip(), map(int, file.readline().split())
        order = "<f4" if float(file.readline()) < 0 else ">f4"
        channels = 3 if kind == b"PF" else 1
        pixels = np.frombuffer(file.read(), order).reshape(height, width, channels).astype(float)
    return pixels @ ([0.2126, 0.7152, 0.0722] if channels == 3 else [1.0])


def luminance(kelvin):
    """Of black bodies, up to a factor; the eye by the lobes of Wyman, Sloan and Shirley [2013]."""
    nm = np.arange(380.0, 781.0)
    lobe = lambda middle, left, right: np.exp(-0.5 * ((nm - middle) / np.where(nm < middle, left, right)) ** 2)
    eye = 0.821 * lobe(568.8, 46.9, 40.5) + 0.286 * lobe(530.9, 16.3, 31.1)
    meters = nm * 1e-9
    return (eye / meters**5 / np.expm1(1.438777e-2 / (meters * np.asarray(kelvin)[..., None]))).sum(-1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kajo", default="kajo")
    parser.add_argument("--size", type=int, default=128)
    parser.add_argument("--spin", type=float, default=0.9)
    parser.add_argument("--inclination", type=float, default=80.0)
    args = parser.parse_args()
    tilt = np.radians(args.inclination)
    flat = lambda r: np.hypot(r, args.spin)  # a distance in the scene
    y, z = DISTANCE * np.cos(tilt), DISTANCE * np.sin(tilt)
    values = dict(vars(args), distance=DISTANCE, field=FIELD, y=y, z=z, down=-y, back=-z, angle=np.degrees(FIELD))
    values |= dict(hottest=HOTTEST, inner=flat(innermost_orbit(args.spin)))
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        (folder / "disk.xml").write_text(GYOTO.format(outer=OUTER, **values))
        (folder / "disk.txt").write_text(KAJO.format(outer=flat(OUTER), **values))
        theirs = run(["gyoto", "-T1", folder / "disk.xml", f"!{folder}/gyoto.fits"])
        ours = run([args.kajo, "render", folder / "disk.txt", "-o", folder / "kajo.pfm", "--threads", "1"])
        gyoto = read_fits(folder / "gyoto.fits", args.size)[::-1, ::-1]
        kajo = read_pfm(folder / "kajo.pfm")[::-1]
    print(f"seen: {(gyoto > 0).sum()} pixels by Gyoto, {(kajo > 0).sum()} by kajo, {((gyoto > 0) & (kajo > 0)).sum()} by both")
    seen = (gyoto > 0.01 * gyoto.max()) & (kajo > 0)
    kelvin = np.geomspace(0.01 * HOTTEST, 3 * HOTTEST, 4000)
    intensity = np.interp(kajo[seen], luminance(kelvin) / luminance(HOTTEST), kelvin) ** 4
    ratio = intensity / gyoto[seen]
    print(f"together: {intensity.sum() / gyoto[seen].sum() / np.median(ratio) - 1:+.3%} beside the median")
    ratio /= np.median(ratio)
    print(f"each: {(abs(ratio - 1) < 0.005).mean():.1%} of {seen.sum()} pixels within 0.5 %, 90 % from {np.quantile(ratio, 0.05):.4f} to {np.quantile(ratio, 0.95):.4f}")
    print(f"processor time: Gyoto {theirs:.1f} s, kajo {ours:.1f} s, {theirs / ours:.1f} times as fast")


if __name__ == "__main__":
    sys.exit(main())
