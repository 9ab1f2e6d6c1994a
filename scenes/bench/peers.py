"""What the scripts that render one scene by kajo and by other programs have in common."""

import os
import pathlib
import resource
import subprocess
import time

import numpy as np

HEADER = "| program | squared error | of 99 % | seconds | error x s | of 99 % x s | mean as it came |\n|---|---|---|---|---|---|---|"


def numbers(values):
    return " ".join(f"{v:g}" for v in values)


def pov_vector(values):
    """A vector in POV-Ray's language."""
    return f"<{', '.join(f'{v:g}' for v in values)}>"


def row(name, errors, seconds, mean):
    """A row below `HEADER`: squared errors of all values, and of all but the largest one in a hundred."""
    errors = np.sort(errors, axis=None)
    error, most = errors.mean(), errors[: -errors.size // 100].mean()
    return f"| {name} | {error:.3e} | {most:.3e} | {seconds:.2f} | {error * seconds:.3e} | {most * seconds:.3e} | {mean:.5f} |"


class Kajo:
    """A scene of kajo's language, rendered on one thread into a square."""

    def __init__(self, program, folder, name, size, text, arguments):
        self.program, self.name, self.size, self.arguments = program, pathlib.Path(program).name, size, list(map(str, arguments))
        self.file, self.out = folder / f"{name}.txt", folder / f"{name}.pfm"
        self.file.write_text(text)

    def render(self, samples, seed):
        """The picture, from its top row down, and the processor time of the whole program."""
        command = [self.program, "render", str(self.file), "-o", str(self.out), "--size", f"{self.size}x{self.size}", "--samples", "sobol", str(samples)]
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        subprocess.run([*command, "--seed", str(seed), "--threads", "1", "--quiet", *self.arguments], check=True)
        seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        content = self.out.read_bytes().split(b"\n", 3)[3]
        return np.frombuffer(content, "<f4").reshape(self.size, self.size, 3)[::-1].astype(float), seconds

    def run(self, samples, seed):
        """The same with the time that samples take alone."""
        _, start = self.render(1, seed)
        picture, seconds = self.render(samples, seed)
        return picture, (seconds - start) * samples / (samples - 1)


class PovRay:
    """A scene of POV-Ray 3.7, rendered on one thread into a square."""

    def __init__(self, name, folder, file, size, text):
        self.name, self.size, self.folder = f"POV-Ray {name}", size, folder
        self.file, self.text = folder / f"{file}.pov", text

    def run(self, _seed):
        self.file.write_text(self.text)
        config = self.folder / ".povray/3.7"
        config.mkdir(parents=True, exist_ok=True)
        (config / "povray.conf").touch()
        out = self.file.with_suffix(".hdr")
        command = ["povray", f"+I{self.file.name}", f"+O{out.name}", f"+W{self.size}", f"+H{self.size}", "+FH", "-D", "+A0.0", "+AM2", "+R3", "-J", "+WT1"]
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        subprocess.run(command, check=True, cwd=self.folder, capture_output=True, env=os.environ | {"HOME": str(self.folder.resolve())})
        seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        return read_radiance(out), seconds


def read_radiance(path):
    """A picture in Radiance's format, whose rows are run-length coded by channel."""
    content = path.read_bytes()
    end = content.index(b"\n\n") + 2
    size, rest = content[end:].split(b"\n", 1)
    height, width = int(size.split()[1]), int(size.split()[3])
    rows, at = np.empty((height, width, 4), np.uint8), 0
    for row in rows:
        if not (rest[at] == 2 and rest[at + 1] == 2 and rest[at + 2] * 256 + rest[at + 3] == width):
            row[:] = np.frombuffer(rest, np.uint8, 4 * width, at).reshape(width, 4)
            at += 4 * width
            continue
        at += 4
        for channel in range(4):
            x = 0
            while x < width:
                n = rest[at]
                if n > 128:
                    row[x : x + n - 128, channel] = rest[at + 1]
                    x, at = x + n - 128, at + 2
                else:
                    row[x : x + n, channel] = np.frombuffer(rest, np.uint8, n, at + 1)
                    x, at = x + n, at + 1 + n
    # The bytes of red, green and blue stand for the middles of their steps.
    scale = np.ldexp(1.0, rows[..., 3:].astype(int) - 136)
    return np.where(rows[..., 3:] > 0, (rows[..., :3] + 0.5) * scale, 0)


class Mitsuba:
    """A scene of Mitsuba 3, rendered on one thread into a square."""

    def __init__(self, variant, size, samples, eye, target, view_angle):
        import mitsuba as mi

        self.mi, self.variant, self.samples, self.name = mi, variant, samples, f"Mitsuba {variant}"
        mi.set_variant(variant)
        film = {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}, "pixel_format": "rgb"}
        view = mi.ScalarTransform4f().look_at(origin=eye, target=target, up=[0, 1, 0])
        self.sensor = {"type": "perspective", "fov": view_angle, "fov_axis": "y", "to_world": view, "film": film}
        self.sensor["sampler"] = {"type": "multijitter", "sample_count": samples}

    def load(self, scene):
        """Loads a scene, but for its camera, and compiles it."""
        self.scene = self.mi.load_dict({"type": "scene", "sensor": self.sensor} | scene)
        self.run(1000)

    def run(self, seed):
        self.mi.set_variant(self.variant)
        start = time.process_time()
        picture = np.array(self.mi.render(self.scene, spp=self.samples, seed=seed), dtype=float)
        return picture, time.process_time() - start


class Cycles:
    """A scene of Blender's Cycles, rendered on one thread into a square."""

    def __init__(self, folder, size, samples, bounces):
        import bpy

        self.bpy, self.size, self.samples, self.name = bpy, size, samples, f"Cycles {bpy.app.version_string}"
        bpy.ops.wm.read_factory_settings(use_empty=True)
        scene = bpy.context.scene
        scene.render.engine = "CYCLES"
        cycles = scene.cycles
        cycles.device, cycles.use_denoising, cycles.use_adaptive_sampling = "CPU", False, False
        cycles.max_bounces = cycles.diffuse_bounces = cycles.volume_bounces = bounces
        cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
        cycles.pixel_filter_type = "BOX"
        scene.render.resolution_x = scene.render.resolution_y = size
        scene.render.resolution_percentage, scene.render.threads_mode, scene.render.threads = 100, "FIXED", 1
        scene.view_settings.view_transform = "Raw"
        scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
        scene.render.filepath = str(folder / "cycles.exr")

    def sky(self, radiance):
        world = self.bpy.data.worlds.new("world")
        world.use_nodes = True
        world.node_tree.nodes["Background"].inputs[0].default_value = (radiance, radiance, radiance, 1)
        self.bpy.context.scene.world = world

    def camera(self, eye, target, view_angle):
        import mathutils

        camera = self.bpy.data.objects.new("camera", self.bpy.data.cameras.new("camera"))
        camera.data.sensor_fit, camera.data.angle = "VERTICAL", np.radians(view_angle)
        z = (mathutils.Vector(eye) - mathutils.Vector(target)).normalized()
        x = mathutils.Vector((0, 1, 0)).cross(z).normalized()
        camera.matrix_world = mathutils.Matrix((x, z.cross(x), z)).transposed().to_4x4()
        camera.matrix_world.translation = eye
        self.bpy.context.collection.objects.link(camera)
        self.bpy.context.scene.camera = camera

    def light(self, kind, energy, position=(0, 0, 0), direction=None):
        """* `energy`: watts, of a sun per square metre"""
        import mathutils

        light = self.bpy.data.lights.new("light", kind)
        light.energy = energy
        placed = self.bpy.data.objects.new("light", light)
        if direction is not None:
            placed.rotation_mode, placed.rotation_quaternion = "QUATERNION", mathutils.Vector(direction).to_track_quat("-Z", "Y")
        placed.location = position
        self.bpy.context.collection.objects.link(placed)
        return light

    def material(self):
        """A material with no nodes but its output, and what adds one."""
        material = self.bpy.data.materials.new("material")
        material.use_nodes = True
        material.node_tree.nodes.clear()
        return material, lambda kind: material.node_tree.nodes.new(f"ShaderNode{kind}")

    def render(self, samples, seed):
        scene = self.bpy.context.scene
        scene.cycles.seed, scene.cycles.samples = seed, samples
        start = time.process_time()
        self.bpy.ops.render.render(write_still=True)
        seconds = time.process_time() - start
        image = self.bpy.data.images.load(scene.render.filepath)
        pixels = np.empty(self.size**2 * 4, np.float32)
        image.pixels.foreach_get(pixels)
        self.bpy.data.images.remove(image)
        return pixels.reshape(self.size, self.size, 4)[::-1, :, :3].astype(float), seconds

    def run(self, seed):
        """The picture, and the time that samples take alone."""
        _, start = self.render(1, seed)
        picture, seconds = self.render(self.samples, seed)
        return picture, (seconds - start) * self.samples / (self.samples - 1)


class LuxCore:
    """A scene of LuxCore, rendered on one thread into a square."""

    def __init__(self, size, engine, eye, target, view_angle, settings, up=(0, 1, 0)):
        """* `settings`: of a render, beside those that all have"""
        import pyluxcore

        self.core, self.size, self.settings = pyluxcore, size, {"renderengine.type": engine} | settings
        pyluxcore.Init()
        pyluxcore.SetLogHandler(lambda message: None)
        self.name = f"LuxCore {pyluxcore.Version()} {engine.removesuffix('CPU')}"
        self.scene, self.meshes = pyluxcore.Scene(), 0
        self.parse({
            "scene.camera.type": "perspective",
            "scene.camera.lookat.orig": list(eye),
            "scene.camera.lookat.target": list(target),
            "scene.camera.up": list(up),
            "scene.camera.fieldofview": view_angle,
            "scene.camera.autofocus.enable": 0,
        })  # fmt: skip

    def properties(self, values):
        properties = self.core.Properties()
        for key, value in values.items():
            properties.Set(self.core.Property(key, value if isinstance(value, list) else [value]))
        return properties

    def parse(self, values):
        self.scene.Parse(self.properties(values))

    def mesh(self, points, triangles, normals, material):
        self.meshes += 1
        name = f"mesh{self.meshes}"
        tuples = [None if values is None else [tuple(float(v) for v in row) for row in values] for values in (points, normals)]
        self.scene.DefineMesh(name, tuples[0], [tuple(int(v) for v in row) for row in triangles], tuples[1], None, None, None)
        self.parse({f"scene.objects.{name}.shape": name, f"scene.objects.{name}.material": material})

    def quad(self, corner, a, b, material):
        corner, a, b = map(np.asarray, (corner, a, b))
        self.mesh([corner, corner + a, corner + a + b, corner + b], [(0, 1, 2), (0, 2, 3)], None, material)

    def render(self, samples, seed):
        config = self.core.RenderConfig(
            self.properties({
                "renderengine.seed": seed + 1,
                "native.threads.count": 1,
                "sampler.type": "RANDOM",
                "film.width": self.size,
                "film.height": self.size,
                "film.filter.type": "BOX",
                "film.filter.width": 0.5,
                "film.imagepipelines.0.0.type": "TONEMAP_LINEAR",
                "film.imagepipelines.0.0.scale": 1.0,
                "film.noiseestimation.warmup": 1 << 30,
                "batch.haltspp": [samples, 0],
            } | self.settings),
            self.scene,
        )  # fmt: skip
        session = self.core.RenderSession(config)
        before = time.process_time()
        session.Start()
        while not session.HasDone():
            time.sleep(0.005)
            session.UpdateStats()
        seconds = time.process_time() - before
        session.Stop()
        buffer = np.empty(self.size * self.size * 3, np.float32)
        session.GetFilm().GetOutputFloat(self.core.FilmOutputType.RGB, buffer, 0)
        return buffer.reshape(self.size, self.size, 3)[::-1].astype(float), seconds


def rows_by_variance(programs, runs):
    """Prints a table of errors, from pictures that differ in the seed only; the lights of each program are scaled so that its picture has the mean of the first one's."""
    results = [[program.run(seed) for program in programs] for seed in range(1, runs + 1)]
    print(HEADER)
    wanted = None
    for program, of_program in zip(programs, zip(*results)):
        stack = np.stack([picture for picture, _ in of_program])
        mean = stack.mean()
        wanted = wanted or mean
        stack *= wanted / mean
        seconds = float(np.median([seconds for _, seconds in of_program]))
        print(row(program.name, stack.var(axis=0, ddof=1), seconds, mean), flush=True)


def rows_by_reference(references, runs):
    """Prints a table of errors against references, relative to their squared mean.

    `references` has the name of each program and the picture that its errors are against, `runs` what each program gave in each
    run: a picture and seconds."""
    print("| program | squared error | of 99 % | of 90 % | seconds | mean |\n|---|---|---|---|---|---|")
    for (name, reference), results in zip(references, zip(*runs)):
        errors = np.mean([((picture - reference) ** 2).mean(-1) for picture, _ in results], axis=0) / reference.mean() ** 2
        seconds = float(np.median([seconds for _, seconds in results]))
        errors, mean = np.sort(errors, axis=None), np.mean([picture.mean() for picture, _ in results])
        parts = " | ".join(f"{errors[: errors.size * share // 100].mean():.2e}" for share in (100, 99, 90))
        print(f"| {name} | {parts} | {seconds:.2f} | {mean:.4f} |", flush=True)
