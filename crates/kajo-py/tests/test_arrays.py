"""Meshes and pictures that are arrays."""

import gc
import pickle

import kajo
import numpy as np
import pytest

VERTICES = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)
FACES = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
CAMERA = kajo.OrthographicCamera(center=(0, 0, 5), direction=(0, 0, -1), up=(0, 1, 0), size=2)
SMALL = {"size": (32, 32), "samples": ("sobol", 1)}


def scene(file, **more):
    material = kajo.PhongMaterial(diffuse_color=(1, 1, 1))
    mesh = kajo.TriangleMesh(file=file, material=material, **more)
    return kajo.Scene(CAMERA, kajo.Background(color=(0, 0, 0), ambient_light=(1, 1, 1)), mesh)


def test_a_mesh_of_arrays_is_that_of_its_file(tmp_path):
    rng = np.random.default_rng(3)
    kinds = [(None, None, None), ("n", "u", 3), (None, "u", 4), ("n", None, None), (None, None, "b")]
    for normals, uvs, colors in kinds:
        vertices = rng.uniform(-1, 1, (50, 3)).astype(np.float32)
        faces = rng.integers(0, 50, (40, 3), dtype=np.uint32)
        given = {
            "normals": None if normals is None else rng.normal(size=(50, 3)).astype(np.float32),
            "uvs": None if uvs is None else rng.uniform(size=(50, 2)).astype(np.float32),
            "colors": None if colors is None else rng.integers(0, 255, (50, 3), dtype=np.uint8)
            if colors == "b"
            else rng.uniform(size=(50, colors)).astype(np.float32),
        }
        file = kajo.mesh_file(vertices, faces, **given)
        (tmp_path / "mesh.ply").write_bytes(file.tobytes())
        built = scene(file, smooth=normals is not None, colors=colors is not None)
        text = built.text.replace("array0.ply", "mesh.ply")
        (tmp_path / "scene.txt").write_text(text)
        read = kajo.load(tmp_path / "scene.txt")
        options = {**SMALL, "layers": ["color", "normals", "uv"]}
        assert built.render(**options).encode("exr") == read.render(**options).encode("exr")
        again = pickle.loads(pickle.dumps(built))
        assert again.render(**options).encode("exr") == read.render(**options).encode("exr")


def test_what_is_contiguous_is_not_copied():
    file = kajo.mesh_file(VERTICES, FACES)
    (_, _), (_, [vertices]), (_, [faces]) = file._tables
    assert np.shares_memory(vertices, VERTICES) and np.shares_memory(faces, FACES)
    # The file keeps its arrays, whatever becomes of those who made it.
    file = kajo.mesh_file(np.array(VERTICES), np.array(FACES))
    gc.collect()
    assert (scene(file).render(**SMALL)["color"] == 1).all()


def test_other_arrays_are_converted():
    plain = scene(kajo.mesh_file(VERTICES, FACES)).render(**SMALL).encode("exr")
    double = np.repeat(VERTICES.astype(np.float64), 2, axis=0)[::2]
    assert not double.flags.c_contiguous
    for vertices, faces in [
        (double, FACES.astype(np.int64)),
        (VERTICES.tolist(), FACES.astype(np.uint16)),
        (VERTICES.astype(">f4"), FACES.astype(">u4")),
        (np.asfortranarray(VERTICES), np.asfortranarray(FACES)),
        (VERTICES, FACES.astype(np.int32)),
    ]:
        assert scene(kajo.mesh_file(vertices, faces)).render(**SMALL).encode("exr") == plain


def test_a_large_mesh_is_read_in_pieces():
    n = 200
    x, y = np.meshgrid(np.linspace(-1, 1, n, dtype=np.float32), np.linspace(-1, 1, n, dtype=np.float32))
    vertices = np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)
    i = np.arange((n - 1) * n).reshape(n - 1, n)[:, :-1].ravel().astype(np.uint32)
    faces = np.concatenate([np.stack([i, i + 1, i + n], 1), np.stack([i + 1, i + n + 1, i + n], 1)])
    assert vertices.nbytes + faces.nbytes > 1 << 20
    assert (scene(kajo.mesh_file(vertices, faces)).render(**SMALL)["color"] == 1).all()


@pytest.mark.parametrize(
    "arguments, error, words",
    [
        ((VERTICES[:, :2], FACES), ValueError, r"vertices: the shape is to be \(n, 3\), and it is \(4, 2\)"),
        ((VERTICES.ravel(), FACES), ValueError, "vertices"),
        ((VERTICES.astype(complex), FACES), TypeError, "vertices: an array of floats.*complex"),
        ((VERTICES, FACES.astype(np.float32)), TypeError, "faces: an array of whole numbers"),
        ((VERTICES, FACES[:, :2]), ValueError, r"faces: the shape is to be \(m, 3\)"),
        ((VERTICES, FACES + 2), ValueError, "faces: row 0 is .2, 3, 4., and there are 4 vertices"),
        ((VERTICES, -FACES.astype(np.int32)), ValueError, "faces: row 0"),
        ((VERTICES, [["a", "b", "c"]]), TypeError, "faces"),
    ],
)
def test_wrong_arrays_are_refused(arguments, error, words):
    with pytest.raises(error, match=words):
        kajo.mesh_file(*arguments)
    with pytest.raises(ValueError, match="normals: there are 3 rows for 4 vertices"):
        kajo.mesh_file(VERTICES, FACES, normals=VERTICES[:3])


def test_points_that_are_no_numbers_are_left_out():
    vertices = VERTICES.copy()
    vertices[3] = np.nan
    built = scene(kajo.mesh_file(vertices, FACES))
    assert any("left out" in line for line in built.warnings), built.warnings
    assert np.isfinite(built.render(**SMALL)["color"]).all()


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32, np.float64])
@pytest.mark.parametrize("channels", [0, 1, 3, 4])
def test_pictures_show_their_numbers(dtype, channels):
    if channels == 4 and dtype in (np.float32, np.float64):
        with pytest.raises(ValueError, match="1 or 3 channels"):
            kajo.picture_file(np.zeros((2, 2, 4), dtype))
        return
    rng = np.random.default_rng(1)
    shape = (4, 4, channels) if channels else (4, 4)
    most = 1 if dtype in (np.float32, np.float64) else np.iinfo(dtype).max
    pixels = (rng.uniform(0.1, 0.9, shape) * most).astype(dtype)
    if channels == 4:
        pixels[..., 3] = most
    picture = kajo.Picture(pixels, filter="nearest", encoding="linear")
    material = kajo.PhongMaterial(diffuse_color=picture)
    file = kajo.mesh_file(VERTICES, FACES, uvs=np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32))
    mesh = kajo.TriangleMesh(file=file, material=material)
    built = kajo.Scene(CAMERA, kajo.Background(color=(0, 0, 0), ambient_light=(1, 1, 1)), mesh)
    shown = built.render(size=(4, 4), samples=("sobol", 1), filter=("box", 0.5))["color"]
    wanted = (pixels.astype(np.float64) / most).reshape(4, 4, -1)[..., :3]
    # Pictures are kept with 16 bits a channel.
    assert np.abs(shown - wanted).max() < 2e-5


@pytest.mark.parametrize(
    "pixels, error",
    [
        (np.zeros(3), ValueError),
        (np.zeros((2, 2, 5), np.uint8), ValueError),
        (np.zeros((0, 2, 3), np.uint8), ValueError),
        (np.zeros((2, 2), bool), TypeError),
        (np.zeros((2, 2), np.int32), TypeError),
        (np.zeros((2, 2), complex), TypeError),
        ("no picture", TypeError),
    ],
)
def test_wrong_pictures_are_refused(pixels, error):
    with pytest.raises(error):
        kajo.picture_file(np.asarray(pixels)[np.newaxis, np.newaxis] if isinstance(pixels, str) else pixels)


def test_a_field_of_heights():
    heights = np.zeros((16, 16), np.float32)
    heights[4:12, 4:12] = 1
    camera = kajo.OrthographicCamera(center=(0, 5, 0), direction=(0, -1, 0), up=(0, 0, -1), size=2)
    field = kajo.HeightField(
        file=kajo.picture_file(heights), size=(2, 2), heights=(0, 1), material=kajo.Matte(color=(1, 1, 1))
    )
    depth = kajo.Scene(camera, field).render(size=(32, 32), layers=["color", "depth"])["depth"][..., 0]
    assert abs(depth[16, 16] - 4) < 0.01 and abs(depth[1, 1] - 5) < 0.01


def test_contents_of_files_are_bytes():
    with pytest.raises(TypeError, match="bytes are wanted"):
        kajo.loads("", files={"a.txt": 3})
