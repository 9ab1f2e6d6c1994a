"""Scenes that are built of objects: they are the scenes of their texts, and what makes no sense is refused."""

import inspect
import pickle
import random
import re

import kajo
import numpy as np
import pytest
from kajo import _items

SMALL = {"size": (16, 12), "samples": ("sobol", 2), "integrator": "path"}


def numbers(rng, low, high, count):
    return [round(rng.uniform(low, high), 3) for _ in range(count)]


def text_of(values):
    return " ".join(repr(value) for value in values)


def random_material(rng, i):
    """A material as an object, and its name and text."""
    color, roughness = numbers(rng, 0.1, 0.9, 3), numbers(rng, 0.1, 0.9, 1)[0]
    name = f"m{i}"
    said = f"color {text_of(color)} roughness {roughness!r}"
    kind = rng.randrange(5)
    if kind == 0:
        return kajo.Matte(name=name, color=color, roughness=roughness), f"Matte {name} {{ {said} }}"
    if kind == 1:
        block = kajo.Principled(name=name, color=tuple(color), roughness=roughness, metalness=0.5)
        return block, f"Principled {name} {{ {said} metalness 0.5 }}"
    if kind == 2:
        block = kajo.Metal(name=name, metal="gold", roughness=np.float32(0.25))
        return block, f"Metal {name} {{ metal gold roughness 0.25 }}"
    if kind == 3:
        block = kajo.Matte(name=name, color=color, emission=kajo.Blackbody(4000, 2))
        return block, f"Matte {name} {{ color {text_of(color)} emission blackbody 4000 2 }}"
    block = kajo.Matte(name=name, color=kajo.Spectrum([400, 600, 700], [0.2, roughness, 0.3]))
    return block, f"Matte {name} {{ color spectrum 400 0.2 600 {roughness!r} 700 0.3 }}"


def random_object(rng, material, depth=0):
    """An object, and its text."""
    center, size = numbers(rng, -2, 2, 3), numbers(rng, 0.2, 0.8, 1)[0]
    kind = rng.randrange(7 if depth < 2 else 4)
    if kind == 0:
        return kajo.Sphere(center=center, radius=size), f"Sphere {{ center {text_of(center)} radius {size!r} }}"
    if kind == 1:
        top = np.array(center) + size
        block = kajo.Box(name="a box", min=center, max=top)
        return block, f'Box "a box" {{ min {text_of(center)} max {text_of(top.tolist())} }}'
    if kind == 2:
        block = kajo.Torus(center=center, axis=(0, 1, 0.5), major_radius=1, minor_radius=size / 3)
        said = f"center {text_of(center)} axis 0 1 0.5 majorRadius 1 minorRadius {size / 3!r}"
        return block, f"Torus {{ {said} }}"
    if kind == 3:
        block = kajo.Isosurface(function="x^2 + y^2 + z^2 - 0.3", material=material)
        return block, f"MaterialIndex {material.name} Isosurface {{ function = x^2 + y^2 + z^2 - 0.3 }}"
    inner, text = random_object(rng, material, depth + 1)
    if kind == 4:
        block = kajo.Transform(kajo.Translate(*center), kajo.YRotate(30), inner)
        return block, f"Transform {{ Translate {text_of(center)} YRotate 30 {text} }}"
    if kind == 5:
        other, other_text = random_object(rng, material, depth + 1)
        return kajo.Group(inner, other, name="g"), f"Group g {{ {text} {other_text} }}"
    outline = kajo.Outline(kajo.Item("line", 0, 0, 1, 0, 1, size))
    block = kajo.Group(inner, kajo.Prism(outline, depth=size, origin=center))
    prism = f"Prism {{ depth {size!r} origin {text_of(center)} outline {{ line 0 0 1 0 1 {size!r} }} }}"
    return block, f"Group {{ {text} {prism} }}"


def random_scene(seed):
    rng = random.Random(seed)
    camera = numbers(rng, 4, 6, 1)[0]
    materials = [random_material(rng, i) for i in range(rng.randrange(1, 4))]
    light, sky = numbers(rng, 0.2, 1, 3), numbers(rng, 0, 0.5, 3)
    items = [
        kajo.PerspectiveCamera(center=(0, 1, camera), direction=(0, -0.2, -1), up=(0, 1, 0), angle=50),
        kajo.Background(color=sky),
        kajo.PointLight(position=(3, 4, 5), color=light),
        kajo.Settings(seed=seed % 7, bounces=3),
    ]
    objects, texts = [], []
    for _ in range(rng.randrange(1, 6)):
        material = rng.choice(materials)
        block, text = random_object(rng, material[0])
        block.material = material[0]
        if text.startswith("MaterialIndex"):
            text = text.split(" ", 2)[2]
        objects.append(block)
        texts.append(f"MaterialIndex {material[0].name} {text}")
    text = f"""
        PerspectiveCamera {{ center 0 1 {camera!r} direction 0 -0.2 -1 up 0 1 0 angle 50 }}
        Background {{ color {text_of(sky)} }} Settings {{ seed {seed % 7} bounces 3 }}
        Lights {{ PointLight {{ position 3 4 5 color {text_of(light)} }} }}
        Materials {{ {" ".join(text for _, text in materials)} }}
        Group {{ {" ".join(texts)} }}"""
    blocks = [*items, *(block for block, _ in materials), *objects]
    return blocks, text


@pytest.mark.parametrize("seed", range(100))
def test_a_scene_of_objects_is_that_of_its_text(seed):
    blocks, text = random_scene(seed)
    built, written = kajo.Scene(*blocks), kajo.loads(text)
    assert built.objects == written.objects
    assert built.render(**SMALL).encode("exr") == written.render(**SMALL).encode("exr"), built.text
    # And once more, from the text that it is made of.
    assert kajo.loads(built.text).render(**SMALL).encode("exr") == written.render(**SMALL).encode("exr")


def classes():
    found = [getattr(kajo, name) for name in kajo.blocks.__all__]
    return [found for found in found if issubclass(found, kajo.Block)]


def sample(annotation):
    """A value of a type, as the annotation says it."""
    first = annotation.removesuffix(" | None").removeprefix("Sequence[")
    if first.startswith("Literal["):
        word = re.split("['\"]", first)[1]
        return (word, 1) if "tuple" in first else word
    values = {"Number": 1.5, "int": 2, "Vector": (0.25, 0.5, 0.75), "bool": True, "str": "word", "File": "a b.png"}
    values |= {"Reflectance": (0.1, 0.2, 0.3), "Emission": 2.5, "Function": "x + y", "MaterialName": "gold"}
    values |= {"MediumName": "mist", "Texture": "tile.png"}
    value = values[first.split(" ")[0].rstrip("]")]
    return [value, value] if annotation.startswith("Sequence[") else value


def test_every_field_is_written_by_a_key_that_its_block_has():
    written = 0
    for block in classes():
        fields = {k: v for k, v in block.__init__.__annotations__.items() if k in block.fields()}
        parameters = inspect.signature(block).parameters
        required = {k: sample(fields[k]) for k in fields if parameters[k].default is inspect.Parameter.empty}
        for field in fields:
            text = str(block(**{**required, field: sample(fields[field])}))
            # The language itself says which words it does not know.
            around = {
                "LightBlock": "Lights {{ {} }}",
                "MaterialBlock": "Materials {{ {} }}",
                "MediumBlock": "Media {{ {} }}",
                "TextureBlock": "Textures {{ {} }}",
                "ObjectBlock": "Materials {{ Matte gold {{ }} }} Group {{ MaterialIndex gold {} }}",
                "PartBlock": "Background {{ {} }}" if block.keyword == "sky" else None,
            }.get(block.__mro__[1].__name__, "{}")
            if around is None:
                continue
            try:
                kajo.loads(around.format(text))
            except kajo.SceneError as error:
                assert not any("unknown word" in line for line in error.lines), (text, error.lines)
            written += 1
    assert written > 300


def test_materials_and_media_are_found_by_who_refers_to_them():
    gold = kajo.Metal(metal="gold")
    mist = kajo.Medium(sigma_s=(0.1, 0.1, 0.1))
    glass = kajo.Interface(medium=mist)
    mixed = kajo.Mix(material_index=[gold, kajo.Matte(color=(1, 0, 0))])
    scene = kajo.Scene(
        kajo.PerspectiveCamera(center=(0, 0, 9), direction=(0, 0, -1), up=(0, 1, 0), angle=30),
        kajo.Sphere(center=(0, 0, 0), radius=1, material=mixed),
        kajo.Sphere(center=(2, 0, 0), radius=1, material=glass),
        kajo.Sphere(center=(4, 0, 0), radius=1, material=gold),
        kajo.Metal(name="metal1", metal="copper"),
    )
    assert scene.objects == 3 and "Medium medium1 {" in scene.text and "medium medium1" in scene.text
    # A name that somebody gave is not given again.
    assert scene.text.count("Metal metal1 ") == 1 and "Metal metal2 { metal gold }" in scene.text
    assert scene.text.index("metal2 {") < scene.text.index("Mix mix1")


def test_textures_are_found_by_who_refers_to_them():
    veins = kajo.Veins(size=0.4, bend=2)
    stops = [(0, 0.35, 0.36, 0.4), (0.3, 0.8, 0.8, 0.8), (1, 0.9, 0.9, 0.9)]
    marble = kajo.Ramp(texture=veins, stop=stops)
    scene = kajo.Scene(
        kajo.PerspectiveCamera(center=(0, 0, 9), direction=(0, 0, -1), up=(0, 1, 0), angle=20),
        kajo.Background(color=(1, 1, 1)),
        kajo.Sphere(center=(0, 0, 0), radius=1, material=kajo.Matte(color=marble)),
    )
    assert not scene.warnings and scene.text.index("Veins veins1") < scene.text.index("Ramp ramp1"), scene.text
    assert scene.text.count("stop ") == 3 and "color ramp1" in scene.text
    assert len(np.unique(scene.render(size=(16, 16))["color"][..., 0])) > 10


@pytest.mark.parametrize(
    "make, error, words",
    [
        (lambda: kajo.Sphere(center=(0, 0, 0), radios=1), TypeError, "radios"),
        (lambda: kajo.Sphere(radius=1), TypeError, "center"),
        (lambda: kajo.Group("Sphere"), TypeError, "Group holds blocks"),
        (lambda: kajo.Scene("Sphere"), TypeError, "made of blocks"),
        (lambda: str(kajo.Sphere(center=(0, 0, float("nan")), radius=1)), ValueError, "Sphere.center: nan"),
        (lambda: str(kajo.Sphere(center=object(), radius=1)), TypeError, "Sphere.center"),
        (lambda: kajo.Translate(0, float("inf"), 0), ValueError, "finite"),
        (lambda: kajo.Spectrum([400, 500], [1]), ValueError, "2 wavelengths and 1 values"),
        (lambda: kajo.Spectrum([500, 400], [1, 1]), ValueError, "grow"),
        (lambda: kajo.Item("two words"), ValueError, "no keyword"),
        (lambda: kajo.Sphere(center=(0, 0, 0), radius=1).replace(size=3), TypeError, "size"),
        (lambda: setattr(kajo.Sphere(center=(0, 0, 0), radius=1), "radios", 3), AttributeError, "radius"),
        (lambda: str(kajo.Matte(name="a\nb")), ValueError, "control character"),
    ],
)
def test_what_makes_no_sense_is_refused_in_words(make, error, words):
    with pytest.raises(error, match=words):
        make()


def test_mistakes_in_built_scenes_have_places():
    with pytest.raises(kajo.SceneError) as caught:
        kajo.Scene(kajo.Sphere(center=(0, 0, 0), radius=1, material="gild"), kajo.Matte(name="gold"))
    assert "gold" in str(caught.value) and "^" in str(caught.value)


def test_blocks_compare_and_are_copied():
    ball = kajo.Sphere(center=(0, 0, 0), radius=1, material=kajo.Matte(color=(1, 0, 0)))
    assert ball == pickle.loads(pickle.dumps(ball)) and ball != ball.replace(radius=2)
    assert ball.replace(radius=2).radius == 2 and ball.radius == 1
    array = kajo.Sphere(center=np.zeros(3), radius=1)
    assert array == kajo.Sphere(center=np.zeros(3), radius=1) and array != kajo.Sphere(center=np.ones(3), radius=1)
    assert repr(kajo.Sphere(center=(0, 0, 0), radius=1)) == "Sphere(center=(0, 0, 0), radius=1)"
    assert str(kajo.Key(0.5, kajo.Translate(1, 0, 0))) == "key 0.5 {\n  Translate 1 0 0\n}"


def test_words_are_quoted_where_need_be():
    for word, text in [("gold", "gold"), ("two words", '"two words"'), ("let", '"let"'), ('a"\\b', '"a\\"\\\\b"')]:
        assert _items.quoted(word) == text
    assert _items.number_text(np.float32(0.1)) == "0.10000000149011612" and _items.number_text(3) == "3"


@pytest.mark.parametrize("origin", ["objects", "file", "text"])
def test_scenes_are_pickled_with_all_their_files(origin, tmp_path):
    blocks, text = random_scene(5)
    if origin == "objects":
        scene = kajo.Scene(*blocks)
    elif origin == "text":
        scene = kajo.loads('include "more.txt"', files={"more.txt": text.encode()})
    else:
        (tmp_path / "more.txt").write_text(text)
        (tmp_path / "scene.txt").write_text('include "more.txt"')
        scene = kajo.load(tmp_path / "scene.txt")
    packed = pickle.dumps(scene)
    plain = scene.render(**SMALL).encode("exr")
    (tmp_path / "more.txt").unlink(missing_ok=True)
    again = pickle.loads(packed)
    assert again.render(**SMALL).encode("exr") == plain
    assert pickle.loads(pickle.dumps(again)).render(**SMALL).encode("exr") == plain


def test_a_built_scene_is_saved_with_its_arrays(tmp_path):
    tile = np.zeros((2, 2, 3), np.uint8)
    tile[0] = 255
    scene = kajo.Scene(
        kajo.PerspectiveCamera(center=(0, 0, 3), direction=(0, 0, -1), up=(0, 1, 0), angle=30),
        kajo.Background(color=(1, 1, 1)),
        kajo.Sphere(center=(0, 0, 0), radius=1, material=kajo.Matte(color=kajo.Picture(tile, filter="nearest"))),
    )
    scene.save(tmp_path / "s.txt")
    again = kajo.load(tmp_path / "s.txt")
    assert again.render(**SMALL).encode("exr") == scene.render(**SMALL).encode("exr")
    with pytest.raises(ValueError, match="kajo.edit"):
        again.save(tmp_path / "t.txt")
