"""The package kajo, as a user of Python meets it. Run by `cargo xtask test` where Python, numpy and pytest are."""

import os
import pathlib
import signal
import subprocess
import threading
import time

import kajo
import numpy as np
import pytest

SCENE = """
PerspectiveCamera { center 0 1 9  direction 0 -0.1 -1  up 0 1 0  angle 30 }
Background { color 0.2 0.3 0.5 }
Lights { DirectionalLight { direction -1 -1 -1  color 0.9 0.9 0.9 } }
Materials { Matte gold { color 0.8 0.6 0.2 }  Matte floor { color 0.5 0.5 0.5 } }
Group {
  MaterialIndex gold   Sphere { center 0 0 0  radius 1 }
  MaterialIndex floor  Plane { normal 0 1 0  offset -1 }
}
"""
PROGRAM = os.environ.get("KAJO_PROGRAM")


@pytest.fixture(scope="module")
def scene():
    return kajo.loads(SCENE)


def test_layers_are_arrays_of_their_own(scene):
    image = scene.render(size=(40, 30), samples=("sobol", 4), layers=["color", "depth", "object"])
    assert image.size == (40, 30) and image.layers == ["color", "depth", "object"] and image.samples == 4
    color, depth = image["color"], image["depth"]
    assert color.shape == (30, 40, 3) and depth.shape == (30, 40, 1)
    assert color.dtype == np.float32 and color.flags.owndata and color.flags.writeable and color.flags.c_contiguous
    assert np.isfinite(color).all() and color.min() >= 0
    # The sphere is seen in the middle, the sky on top: row 0 is there.
    assert abs(float(depth[15, 20, 0]) - 8) < 0.2 and np.isinf(depth[0]).all()
    assert set(np.unique(image["object"])) == {0, 1, 2}
    color[:] = 7
    assert (image["color"] != 7).any()
    del image
    assert (color == 7).all()
    with pytest.raises(KeyError):
        scene.render(size=(4, 4))["depth"]


def test_the_sky_has_the_colour_that_was_asked_for(scene):
    sky = scene.render(size=(40, 30), samples=4)["color"][0, 0]
    assert np.array_equal(sky, np.array([0.2, 0.3, 0.5], dtype=np.float32))


def test_any_number_of_threads_makes_the_same_bytes(scene):
    options = {"size": (50, 38), "samples": ("jittered", 4), "integrator": "path"}
    pictures = [scene.render(threads=n, **options).encode("exr") for n in (1, 2, 7)]
    assert pictures[0] == pictures[1] == pictures[2]
    assert scene.render(seed=2, **options).encode("exr") != pictures[0]


@pytest.mark.skipif(PROGRAM is None, reason="the program kajo is not there")
def test_files_are_those_of_the_command_line(tmp_path):
    (tmp_path / "s.txt").write_text(SCENE)
    for name, options, settings in [
        ("a.exr", ["--layers", "color,depth,normals"], {"layers": ["color", "depth", "normals"]}),
        ("b.png", ["--filter", "gaussian", "0.6"], {"filter": ("gaussian", 0.6)}),
        ("c.png", ["--integrator", "path", "--seed", "3"], {"integrator": "path", "seed": 3}),
        ("d.exr", ["--adaptive", "--integrator", "path"], {"adaptive": True, "integrator": "path"}),
    ]:
        line = [PROGRAM, "render", "s.txt", "-o", name, "--size", "60", "44", "--samples", "sobol", "16"]
        subprocess.run(line + options, cwd=tmp_path, check=True, capture_output=True)
        image = kajo.load(tmp_path / "s.txt").render(size=(60, 44), samples=("sobol", 16), **settings)
        assert image.encode(name[-3:]) == (tmp_path / name).read_bytes(), name
        image.save(tmp_path / ("mine-" + name))
        assert (tmp_path / ("mine-" + name)).read_bytes() == (tmp_path / name).read_bytes()


def test_mistakes_have_places():
    with pytest.raises(kajo.SceneError) as caught:
        kajo.loads("Group { Sphre { center 0 0 0  radius 1 } }")
    assert "Sphere" in str(caught.value) and "^" in str(caught.value)
    assert any(line.startswith("scene.txt:1:9: error: ") for line in caught.value.lines)
    assert isinstance(caught.value, kajo.KajoError)
    with pytest.raises(kajo.SceneError, match="no such file"):
        kajo.load("nowhere.txt")


@pytest.mark.parametrize(
    "settings, error",
    [
        ({"sise": (4, 4)}, kajo.SceneError),
        ({"size": (4,)}, kajo.SceneError),
        ({"size": (0, 4)}, kajo.SceneError),
        ({"samples": ("sobol", -1)}, kajo.SceneError),
        ({"integrator": "pth"}, kajo.SceneError),
        ({"seed": float("nan")}, kajo.SceneError),
        ({"integrator": "path } Group {"}, kajo.SceneError),
        ({"integrator": 'a"b'}, ValueError),
        ({"samples": [object()]}, TypeError),
        ({"layers": ["colour"]}, ValueError),
        ({"noise": -1.0}, ValueError),
        ({"time": float("nan")}, ValueError),
        ({"crop": (100_000, 0, 5, 5)}, kajo.KajoError),
        ({"size": (2_000_000_000, 2_000_000_000)}, kajo.KajoError),
    ],
)
def test_what_makes_no_sense_is_refused(scene, settings, error):
    with pytest.raises(error):
        scene.render(**settings)


def test_chains_say_whether_they_agree(scene):
    def r_hat(integrator, samples):
        return scene.render(size=(24, 20), samples=("sobol", samples), integrator=integrator).r_hat

    assert r_hat("path", 4) is None
    assert r_hat("mlt", 1) == float("inf")
    assert 0.99 < r_hat("mmlt", 256) < 1.05 < r_hat("mmlt", 2)


def test_files_come_from_memory():
    text = SCENE.replace("Lights {", 'include "more.txt"  Lights {')
    with pytest.raises(kajo.SceneError):
        kajo.loads(text)
    assert kajo.loads(text, files={"more.txt": b"# nothing"}).objects == 2


def test_progress_is_told_and_may_stop(scene):
    told = []
    scene.render(size=(200, 150), samples=("sobol", 64), progress=told.append)
    assert told[-1] == 1.0 and told == sorted(told) and 0 <= told[0] <= 1

    def stop(_):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        scene.render(size=(1000, 1000), samples=("sobol", 65536), progress=stop)


def test_ctrl_c_stops_a_render(scene):
    # Shells ignore it on behalf of what they start in the background.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    # Once to wake all threads.
    scene.render(size=(64, 64))
    sent = []

    def press():
        sent.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    took = []
    for _ in range(3):
        threading.Timer(0.2, press).start()
        with pytest.raises(KeyboardInterrupt):
            scene.render(size=(1000, 1000), samples=("sobol", 65536))
        took.append(time.monotonic() - sent[-1])
    signal.signal(signal.SIGINT, before)
    # 50 ms where nothing else takes the cores.
    assert min(took) < 1, took


def test_a_preview_fills_in_and_may_stop(scene):
    seen = []
    image = scene.render(
        size=(64, 48),
        samples=("sobol", 256),
        integrator="path",
        preview=lambda png, samples: seen.append((png[:4], samples)),
        preview_interval=0.0,
    )
    assert seen and all(head == b"\x89PNG" for head, _ in seen) and image.samples == 256
    assert [samples for _, samples in seen] == sorted(samples for _, samples in seen)
    # Whoever looks changes nothing.
    plain = scene.render(size=(64, 48), samples=("sobol", 256), integrator="path")
    assert image.encode("exr") == plain.encode("exr")

    def stop(png, samples):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        scene.render(size=(64, 48), samples=("sobol", 4096), preview=stop, preview_interval=0.0)
    with pytest.raises(ValueError, match="preview_interval"):
        scene.render(size=(4, 4), preview=stop, preview_interval=-1.0)


def test_a_bar_shows_progress(scene, capsys):
    pytest.importorskip("tqdm")
    scene.render(size=(64, 48), progress=True)
    assert "100%" in capsys.readouterr().err


def test_pictures_are_compared(scene):
    a = scene.render(size=(40, 30), samples=4)
    b = scene.render(size=(40, 30), samples=4, seed=2)
    same, other = kajo.compare(a, a), kajo.compare(a, b)
    assert (same.mse, same.flip, same.max_abs, same.psnr) == (0, 0, 0, float("inf"))
    assert other.mse > 0 and 0 < other.flip < 1 and other.map.shape == (30, 40) and other.map.max() <= 1
    by_hand = float(((a["color"].astype(float) - b["color"]) ** 2).mean())
    assert abs(other.mse - by_hand) < 1e-6 * by_hand and abs(other.rmse**2 - other.mse) < 1e-12
    assert kajo.compare(np.zeros((8, 8)), np.full((8, 8), 0.25), display=True).max_abs == 0.25
    with pytest.raises(ValueError):
        kajo.compare(a, scene.render(size=(8, 8)))
    with pytest.raises(ValueError, match="shape"):
        kajo.compare(np.zeros(3), np.zeros(3))


def test_the_self_test_runs():
    told = []
    rows = kajo.selftest("table", seed=1, progress=told.append)
    assert len(rows) > 3 and told == rows and all(row.verdict == "pass" for row in rows), rows
    assert all(abs(row.measured / row.expected - 1) < 0.1 for row in rows if row.expected)
    assert kajo.selftest("there is no such row") == []


GALLERY = pathlib.Path(__file__).parents[3] / "scenes" / "gallery"


@pytest.mark.skipif(PROGRAM is None or not GALLERY.is_dir(), reason="the program kajo, or the gallery, is not there")
def test_scenes_of_the_gallery_are_those_of_the_command_line(tmp_path):
    scenes = sorted(GALLERY.glob("*.txt"), key=lambda path: path.stat().st_size)
    scenes = [scene for scene in scenes if scene.name != "manifest.txt"]
    # Those that take long to load come last, and are for `cargo xtask deep`.
    scenes = scenes if os.environ.get("KAJO_DEEP") else scenes[::9]
    assert len(scenes) > 5
    for path in scenes:
        line = [PROGRAM, "render", str(path), "--assets", str(GALLERY.parent), "-o", str(tmp_path / "a.exr")]
        size = ["--size", "16", "12", "--samples", "jittered", "1"]
        ran = subprocess.run(line + size, capture_output=True, text=True)
        assert ran.returncode == 0, (path.name, ran.stderr)
        # Cameras that fit something into the picture have to know what that is like.
        image = kajo.load(path, assets=[GALLERY.parent], aspect=16 / 12).render(size=(16, 12), samples=1)
        assert image.encode("exr") == (tmp_path / "a.exr").read_bytes(), path.name


def test_other_threads_run_meanwhile(scene):
    steps, over = [], threading.Event()

    def count():
        while not over.is_set():
            steps.append(1)
            time.sleep(0.005)

    thread = threading.Thread(target=count)
    thread.start()
    scene.render(size=(300, 200), samples=("sobol", 64), integrator="path")
    over.set()
    thread.join()
    assert len(steps) > 3


def test_memory_stays_flat(scene):
    resource = pytest.importorskip("resource")
    for i in range(400):
        if i == 100:
            before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        scene.render(size=(64, 48), samples=1, layers=["color", "depth"])["depth"]
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 20_000, "kilobytes"


def test_a_picture_shows_itself(scene):
    image = scene.render(size=(16, 16), samples=1)
    assert image._repr_png_().startswith(b"\x89PNG") and "16 x 16" in repr(image)
    assert np.asarray(image).shape == (16, 16, 3)
    with pytest.raises(ValueError, match="no format"):
        image.encode("gif")
    with pytest.raises(OSError):
        image.save("/nowhere/at/all.png")
    assert kajo.build_identity().startswith("kajo " + kajo.__version__)
