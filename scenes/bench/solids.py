#!/usr/bin/env python3
"""Writes scenes of solids for kajo and for POV-Ray 3.7, the same in both.

    solids.py DIR      csg, csg-group, tori, spheres, isosurface, blobs, lathe, height: DIR/NAME.txt, and NAME.pov of those to compare

csg: a box with 999 balls taken away. csg-group: the same 1,000 leaves in a group. tori, spheres: a field of 1,024 each.
isosurface: a gyroid in a box, by its formula. blobs: 1,000 components. lathe: a vase whose wall is of cubic curves. height: 512 x 512 heights of 16 bits.
One point light with shadows, ambient light 0.1, one ray a pixel; the picture is 640 x 480."""
import math, os, struct, sys, zlib

SIZE = 640, 480
LIGHT = (6, 12, 9)


def pcg(x):
    s = (x * 747796405 + 2891336453) & 0xFFFFFFFF
    w = (((s >> ((s >> 28) + 4)) ^ s) * 277803737) & 0xFFFFFFFF
    return (w >> 22) ^ w


def u(i, k):
    return (pcg((pcg(i) + k) & 0xFFFFFFFF) >> 8) * 2.0**-24


def near(i, k, most):
    return (2 * u(i, k) - 1) * most


# Balls on a lattice of ten, a little off, without the first.
BALLS = [((i % 10 - 4.5) * 0.8 + near(i, 0, 0.2), (i // 10 % 10 - 4.5) * 0.8 + near(i, 1, 0.2),
          (i // 100 - 4.5) * 0.8 + near(i, 2, 0.2), 0.35 + 0.12 * u(i, 3)) for i in range(1, 1000)]
FIELD = [((i % 32 - 15.5) * 0.9, 0.35 + 0.1 * u(i, 0), (i // 32 - 15.5) * 0.9, near(i, 1, 1), 1, near(i, 2, 1))
         for i in range(1024)]
DROPS = [(3.6 * math.cos(0.11 * i) * (0.3 + 0.7 * u(i, 0)), near(i, 1, 1.6), 3.6 * math.sin(0.11 * i) * (0.3 + 0.7 * u(i, 2)),
          0.35 + 0.3 * u(i, 3)) for i in range(1000)]

# A vase's wall, outside and inside: points, of which each three end a cubic curve that begins at the last of the ones before.
VASE = [(0, 0), (0.2, 0), (0.4, 0), (0.6, 0), (1.3, 0.7), (0.1, 1.2), (0.4, 2.0), (0.38, 2.02), (0.35, 2.02), (0.33, 2.0),
        (0.03, 1.2), (1.2, 0.7), (0.5, 0.1), (0.35, 0.1), (0.2, 0.1), (0, 0.1)]


def height(x, z):
    """From 0 to 1."""
    h, a, f = 0.0, 0.5, 3.0
    for k in range(6):
        h += a * (0.5 + 0.5 * math.sin(f * x + 1.7 * k) * math.cos(f * z + 2.3 * k + 0.5 * math.sin(f * 0.7 * x)))
        a, f = 0.5 * a, 2.03 * f
    return min(max(h, 0.0), 1.0)


def png(path, n):
    rows = b"".join(b"\0" + b"".join(struct.pack(">H", round(65535 * height(i / (n - 1), j / (n - 1)))) for i in range(n)) for j in range(n))
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    head = struct.pack(">IIBBBBB", n, n, 16, 0, 0, 0, 0)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def text(*numbers):
    return " ".join("%.7g" % x for x in numbers)


def angle(*numbers):
    return "<" + ",".join("%.7g" % x for x in numbers) + ">"


COLOR = (0.8, 0.55, 0.3)


def kajo(eye, target, objects):
    d = [t - e for e, t in zip(eye, target)]
    return f"""Settings {{ size {SIZE[0]} {SIZE[1]}  integrator classic  samples regular 1  shadows on  filter none }}
PerspectiveCamera {{ center {text(*eye)}  direction {text(*d)}  up 0 1 0  angle 35 }}
Background {{ color 0.3 0.5 0.8  ambientLight 0.1 0.1 0.1 }}
Lights {{ PointLight {{ position {text(*LIGHT)}  color 0.9 0.9 0.9 }} }}
Materials {{
  PhongMaterial {{ diffuseColor {text(*COLOR)} }}
  PhongMaterial {{ diffuseColor 0.6 0.6 0.6 }}
}}
Group {{
  MaterialIndex 0
{objects}
}}
"""


def povray(eye, target, objects):
    fov = 0.5 / math.tan(math.radians(35 / 2))
    color = "texture {{ pigment {{ rgb {} }} finish {{ ambient 0.1 diffuse 0.9 }} }}".format
    objects = objects.replace("COLOR", color(angle(*COLOR))).replace("GREY", color(0.6))
    return f"""#version 3.7;
global_settings {{ assumed_gamma 1.0 ambient_light rgb 1 }}
camera {{ perspective location {angle(*eye)} right -x*{SIZE[0]}/{SIZE[1]} up y direction z*{fov:.9f} sky y look_at {angle(*target)} }}
background {{ rgb <0.3,0.5,0.8> }}
light_source {{ {angle(*LIGHT)} rgb 1 }}
{objects}
"""


FLOOR = "  MaterialIndex 1\n  Plane {{ normal 0 1 0  offset {} }}".format
POV_FLOOR = "plane {{ y, {} GREY }}".format


def scenes():
    balls = "\n".join("    Sphere { center %s  radius %s }" % (text(*b[:3]), text(b[3])) for b in BALLS)
    box = "    Box { min -4 -4 -4  max 4 4 4 }"
    eye, target = (7, 9, 13), (0, -0.4, 0)
    pov = "\n".join("sphere { %s, %s }" % (angle(*b[:3]), text(b[3])) for b in BALLS)
    yield "csg", eye, target, f"  Difference {{\n{box}\n{balls}\n  }}", f"difference {{ box {{ <-4,-4,-4>, <4,4,4> }}\n{pov}\nCOLOR }}"
    yield "csg-group", eye, target, f"{box}\n{balls}", None
    eye, target = (0, 9, 19), (0, 0, 1)
    rings = "\n".join("  Torus { center %s  axis %s  majorRadius 0.28  minorRadius 0.1 }" % (text(*t[:3]), text(*t[3:])) for t in FIELD)
    pov = []
    for x, y, z, a, b, c in FIELD:
        # The torus of POV-Ray lies around y: this turns y to the axis.
        n = math.sqrt(a * a + b * b + c * c)
        ax, ay, az = a / n, b / n, c / n
        s = (0, az, -ay) if abs(ax) < 0.9 else (-az, 0, ax)
        m = math.sqrt(sum(q * q for q in s))
        s = [q / m for q in s]
        t = (s[1] * az - s[2] * ay, s[2] * ax - s[0] * az, s[0] * ay - s[1] * ax)
        pov.append("torus { 0.28, 0.1 matrix %s COLOR }" % angle(*s, ax, ay, az, *t, x, y, z))
    yield "tori", eye, target, rings + "\n" + FLOOR(0), "\n".join(pov) + POV_FLOOR(0)
    spheres = "\n".join("  Sphere { center %s  radius 0.3 }" % text(*t[:3]) for t in FIELD)
    yield "spheres", eye, target, spheres + "\n" + FLOOR(0), None
    f = "sin(x) * cos(y) + sin(y) * cos(z) + sin(z) * cos(x)"
    yield ("isosurface", (9, 8, 15), (0, -0.5, 0), f"  Isosurface {{ function = {f}  min -4 -4 -4  max 4 4 4 }}",
           f"isosurface {{ function {{ {f.replace(' ', '')} }} contained_by {{ box {{ -4, 4 }} }} max_gradient 1.75 accuracy 0.0001 COLOR }}")
    own = "\n".join("    sphere { center %s  radius %s }" % (text(*d[:3]), text(d[3])) for d in DROPS)
    pov = "\n".join("sphere { %s, %s, 1 }" % (angle(*d[:3]), text(d[3])) for d in DROPS)
    yield ("blobs", (5, 7, 10), (0, -0.3, 0), f"  Blob {{\n    threshold 0.5  kernel povray\n{own}\n  }}\n{FLOOR(-2)}",
           f"blob {{ threshold 0.5\n{pov}\nCOLOR }}\n{POV_FLOOR(-2)}")
    own = "cubic " + "  ".join(text(*p) for p in VASE)
    pov = ", ".join(angle(*p) for k in range(0, 15, 3) for p in VASE[k : k + 4])
    yield ("lathe", (2.2, 3.2, 4), (0, 0.85, 0), f"  Lathe {{ profile {{ {own} }} }}\n{FLOOR(0)}",
           f"lathe {{ bezier_spline 20, {pov} COLOR }}\n{POV_FLOOR(0)}")
    yield ("height", (5, 6, 9), (0, -0.3, 0), "  HeightField { file height.png  size 10 10  heights -1.5 1.5 }",
           'height_field { png "height.png" translate <-0.5,0,-0.5> scale <10,3,-10> translate <0,-1.5,0> COLOR }')


if __name__ == "__main__":
    folder = sys.argv[1]
    os.makedirs(folder, exist_ok=True)
    png(f"{folder}/height.png", 512)
    for name, eye, target, own, other in scenes():
        open(f"{folder}/{name}.txt", "w").write(kajo(eye, target, own))
        if other:
            open(f"{folder}/{name}.pov", "w").write(povray(eye, target, other))
