"""Scenes: from files, from texts, from blocks that are objects; and their renders."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib import import_module
from typing import TYPE_CHECKING, Any, TypeAlias

from . import _native
from ._image import Image
from ._items import (
    Block,
    Item,
    LightBlock,
    MaterialBlock,
    MediumBlock,
    ObjectBlock,
    TextureBlock,
    Writer,
    quoted,
)

if TYPE_CHECKING:
    from ._arrays import ArrayFile, Table

Value: TypeAlias = "bool | int | float | str | Sequence[bool | int | float | str]"
"""What a setting may be: on or off, a number, a word, or several of them."""

FileContent: TypeAlias = "bytes | bytearray | memoryview | ArrayFile"

Progress: TypeAlias = "Callable[[float], object] | bool"

_LISTS = {"Lights": LightBlock, "Materials": MaterialBlock, "Media": MediumBlock, "Textures": TextureBlock}


class Scene:
    """A scene, ready to be rendered. It never changes.

    >>> scene = Scene(
    ...     PerspectiveCamera(center=(0, 1, 9), direction=(0, -0.1, -1), up=(0, 1, 0), angle=30),
    ...     DirectionalLight(direction=(-1, -1, -1), color=(1, 1, 1)),
    ...     Sphere(center=(0, 0, 0), radius=1, material=Matte(color=(0.8, 0.6, 0.2))),
    ... )

    Lights, media, materials and objects are put into the lists that the language has them in, in their order; a
    material or a medium that another block refers to need not be given beside it.

    Args:
        items: the blocks of the scene.
        files: contents of further files that it names, by their names.
        name: what its text is called in messages.
        camera: the camera that takes the picture, by its name; the last one by default.
        dialect: the lineage of the format, where it is not to be the scene's own choice.
        aspect: width over height of the picture, for cameras that fit something into it.

    Raises:
        SceneError: with every mistake, its place in the text and a caret.
    """

    def __init__(
        self,
        *items: Item,
        files: Mapping[str, FileContent] | None = None,
        name: str = "scene.txt",
        camera: str | None = None,
        dialect: str | None = None,
        aspect: float | None = None,
    ) -> None:
        text, arrays = scene_text(items)
        self._read(text, {**arrays, **(files or {})}, name, (camera, dialect, aspect))

    def _read(
        self,
        text: str,
        files: Mapping[str, FileContent],
        name: str,
        options: tuple[str | None, str | None, float | None],
    ) -> None:
        self._text: str | None = text
        self._files: dict[str, FileContent] = dict(files)
        self._name = name
        self._options = options
        self._source: tuple[str, list[str], bool] | None = None
        self._bundle: bytes | None = None
        self._native = _native.loads(text, name, _tables(self._files), *options)

    @classmethod
    def _of(
        cls,
        native: _native.Scene,
        options: tuple[str | None, str | None, float | None],
        source: tuple[str, list[str], bool] | None,
    ) -> Scene:
        scene = object.__new__(cls)
        scene._native, scene._options, scene._source = native, options, source
        scene._text, scene._files, scene._name, scene._bundle = None, {}, "", None
        return scene

    @property
    def text(self) -> str | None:
        """The text of the scene language that it was made of; None for one that was read from a file."""
        return self._text

    @property
    def warnings(self) -> list[str]:
        """What was found odd about it: file:line:column: warning: what."""
        return self._native.warnings

    @property
    def objects(self) -> int:
        """How many objects it has."""
        return self._native.objects

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the text as a scene file, and beside it the files that are arrays or were given as contents."""
        if self._text is None:
            raise ValueError("the scene was read from a file; `kajo.edit` opens it to be changed and saved")
        folder = os.path.dirname(os.fspath(path))
        for name, content in self._files.items():
            data = bytes(content) if isinstance(content, (bytes, bytearray, memoryview)) else content.tobytes()
            _native.write(os.path.join(folder, name), data)
        _native.write(os.fspath(path), self._text.encode())

    def bundle(self) -> bytes:
        """The scene with all its files as the bytes of a bundle, which `kajo render` and `kajo.loads` take.

        Files are read as they are now, also those of a scene that was loaded before.
        """
        if self._bundle is not None:
            return self._bundle
        if self._text is not None:
            return _native.pack_text(self._text, self._name, _tables(self._files))
        if self._source is None:
            raise ValueError("this scene's files are not known: it is that of a document; save that and load it")
        return _native.pack(*self._source)

    def __reduce__(self) -> tuple[Callable[..., Scene], tuple[Any, ...]]:
        return _unpickled, (self.bundle(), self._options)

    def render(
        self,
        *,
        layers: Iterable[str] = ("color",),
        threads: int = 0,
        noise: float | None = None,
        time: float | None = None,
        adaptive: bool = False,
        crop: tuple[int, int, int, int] | None = None,
        progress: Progress = False,
        preview: Callable[[bytes, int], object] | None = None,
        preview_interval: float = 1.0,
        live: bool = False,
        **settings: Value,
    ) -> Image:
        """Renders a picture. The interpreter is free for other threads meanwhile, and Ctrl-C stops it.

        Args:
            layers: what is recorded besides, see LAYERS.
            threads: 0 for one on each core. The picture has the same bits for any number.
            noise: end when the estimated relative error is this small.
            time: end after this many seconds.
            adaptive: take more samples where the picture is noisy.
            crop: left, top, width and height of the part that is wanted.
            progress: called about twenty times a second with the share that is done; what it raises stops the render.
                True shows a bar, where tqdm is installed.
            preview: called with the bytes of a PNG of the picture so far and the samples of a pixel in it.
            preview_interval: seconds between two of these.
            live: show the picture so far in a notebook.
            settings: any key of the block Settings of the scene language, in snake_case: size=(800, 600),
                samples=("sobol", 64), integrator="path", seed=1, shade_back=True.

        Raises:
            SceneError: for settings that make no sense.
            RenderError: when there can be no picture.
        """
        names = list(dict.fromkeys(layers))
        samples = settings.get("samples")
        if isinstance(samples, int) and not isinstance(samples, bool):
            # As on the command line.
            settings["samples"] = ("jittered", samples)
        text = " ".join(f"{_key(key)} {_value(value)}" for key, value in settings.items())
        if live and preview is None:
            preview = _notebook_preview()
        shown = None if preview is None else (preview_interval, preview)
        with _bar(progress) as told:
            native = self._native.render(text, names, threads, noise, time, adaptive, crop, told, shown)
        return Image(native)


def load(
    path: str | os.PathLike[str],
    *,
    assets: Iterable[str | os.PathLike[str]] = (),
    allow_outside: bool = False,
    camera: str | None = None,
    dialect: str | None = None,
    aspect: float | None = None,
) -> Scene:
    """Reads a scene file, or a model.

    Args:
        path: the file.
        assets: folders besides the scene's own whose files it may name.
        allow_outside: let it name files anywhere.
        camera: the camera that takes the picture, by its name; the last one by default.
        dialect: the lineage of the format, where it is not to be the scene's own choice.
        aspect: width over height of the picture, for cameras that fit something into it.

    Raises:
        SceneError: with every mistake, its place and a caret.
    """
    source = (os.fspath(path), [os.fspath(folder) for folder in assets], allow_outside)
    options = (camera, dialect, aspect)
    return Scene._of(_native.load(*source, *options), options, source)


def loads(
    text: str | bytes,
    *,
    files: Mapping[str, FileContent] | None = None,
    name: str = "scene.txt",
    camera: str | None = None,
    dialect: str | None = None,
    aspect: float | None = None,
) -> Scene:
    """Reads a scene from its text, or from the bytes of a bundle.

    Args:
        text: the text.
        files: contents of the files it names, by their names.
        name: what the text is called in messages.
        camera, dialect, aspect: as for `load`.
    """
    options = (camera, dialect, aspect)
    if isinstance(text, bytes):
        return _unpickled(text, options)
    scene = object.__new__(Scene)
    scene._read(text, files or {}, name, options)
    return scene


def _unpickled(bundle: bytes, options: tuple[str | None, str | None, float | None]) -> Scene:
    scene = Scene._of(_native.unpack(bundle, *options), options, None)
    # It can be handed on.
    scene._bundle = bundle
    return scene


def scene_text(items: Iterable[Item]) -> tuple[str, dict[str, ArrayFile]]:
    """The text of a scene made of these blocks, and the files that it names which are arrays."""
    gathered: dict[str, list[Item]] = {name: [] for name in _LISTS}
    heads: dict[str, Block] = {}
    tops: list[Item] = []
    objects: list[Item] = []
    for item in items:
        if not isinstance(item, Item):
            raise TypeError(f"a scene is made of blocks and items, not of {item!r}")
        if item.keyword in _LISTS and item.children is not None:
            gathered[item.keyword] += item.children
            if isinstance(item, Block):
                heads[item.keyword] = item
            continue
        kind = next((name for name, base in _LISTS.items() if isinstance(item, base)), None)
        if kind is not None:
            gathered[kind].append(item)
        elif isinstance(item, ObjectBlock) or item.keyword == "MaterialIndex":
            objects.append(item)
        else:
            tops.append(item)
    return _written(tops, gathered, heads, objects)


def _written(
    tops: list[Item], gathered: dict[str, list[Item]], heads: dict[str, Block], objects: list[Item]
) -> tuple[str, dict[str, ArrayFile]]:
    writer = Writer()
    for item in [*gathered["Materials"], *gathered["Media"], *gathered["Textures"]]:
        if isinstance(item, Block) and item.name is not None:
            writer.take(item.name)
    # Objects first: they say which materials and media there are besides those that were given.
    body = _section(writer, [*tops, *_group(objects)])
    _complete(writer, gathered["Materials"], MaterialBlock)
    _complete(writer, gathered["Media"], MediumBlock)
    lights = _section(writer, _list("Lights", gathered["Lights"], heads))
    _complete(writer, gathered["Textures"], TextureBlock)
    media = _section(writer, _list("Media", gathered["Media"], heads))
    # What others are made of stands before them.
    textures = _section(writer, _list("Textures", _ordered(gathered["Textures"], TextureBlock), heads))
    materials = _section(writer, _list("Materials", _ordered(gathered["Materials"], MaterialBlock), heads))
    return "\n".join([*media, *lights, *textures, *materials, *body, ""]), writer.files


def _complete(writer: Writer, known: list[Item], base: type[Block]) -> None:
    """Adds the blocks of a kind that others refer to; what these refer to is found by writing them."""
    done = 0
    while True:
        new = [block for block in writer.referred if isinstance(block, base)]
        known += [block for block in new if not any(block is item for item in known)]
        if done == len(known):
            return
        waiting, done = known[done:], len(known)
        _section(writer, waiting)


def _ordered(blocks: Sequence[Item], kind: type[Block]) -> list[Item]:
    """Blocks with those of their kind that they refer to before them, otherwise in their order."""
    ordered: list[Item] = []
    waiting: list[int] = []

    def put(item: Item) -> None:
        if any(item is done for done in ordered) or id(item) in waiting:
            return
        waiting.append(id(item))
        if isinstance(item, Block):
            for _, value in item.values_of_fields():
                for part in value if isinstance(value, (list, tuple)) else [value]:
                    if isinstance(part, kind):
                        put(part)
        ordered.append(item)

    for item in blocks:
        put(item)
    return ordered


def _section(writer: Writer, items: Sequence[Item]) -> list[str]:
    writer.lines = []
    for item in items:
        writer.item(item)
    return writer.lines


def _list(keyword: str, items: Sequence[Item], heads: Mapping[str, Block]) -> list[Item]:
    if keyword in heads:
        return [heads[keyword].replace(children=list(items))]
    return [Item(keyword, children=items)] if items else []


def _group(objects: Sequence[Item]) -> list[Item]:
    return [Item("Group", children=objects)] if objects else []


def _tables(files: Mapping[str, FileContent]) -> dict[str, list[Table]]:
    tables: dict[str, list[Table]] = {}
    for name, content in files.items():
        if isinstance(content, (bytes, bytearray, memoryview)):
            view = memoryview(content).cast("B")
            tables[name] = [(b"", [(view, len(view))])] if len(view) else []
        elif hasattr(content, "_parts"):
            tables[name] = content._parts()
        else:
            raise TypeError(f"files[{name!r}]: bytes are wanted, not {type(content).__name__}")
    return tables


def _key(name: str) -> str:
    if not name.isidentifier():
        raise ValueError(f"{name!r} is no setting")
    first, *rest = name.split("_")
    return first + "".join(word.capitalize() for word in rest)


def _value(value: object) -> str:
    if isinstance(value, str):
        if any(c in value for c in '"\\\n\r'):
            raise ValueError(f"{value!r} cannot be a setting")
        return value if value.replace("-", "a").isalnum() and value[0].isalpha() else quoted(value)
    if isinstance(value, float) and value != value:
        return "nan"
    if isinstance(value, (tuple, list)):
        return " ".join(_value(part) for part in value)
    return Writer().value(value)


@contextmanager
def _bar(progress: Progress) -> Iterator[Callable[[float], object] | None]:
    """Progress callback: a function, or a bar."""
    if progress is False or progress is True:
        if not progress:
            yield None
            return
        try:
            tqdm = import_module("tqdm.auto").tqdm
        except ImportError:
            raise ImportError("progress=True shows a bar of tqdm, which is not installed: pip install tqdm") from None
        with tqdm(total=100, unit="%", bar_format="{l_bar}{bar}| {elapsed}<{remaining}") as bar:
            yield lambda share: bar.update(round(100 * share, 2) - bar.n)
        return
    yield progress


def _notebook_preview() -> Callable[[bytes, int], object]:
    try:
        ipython = import_module("IPython.display")
    except ImportError:
        raise ImportError("live=True is for notebooks, and IPython is not installed") from None
    handles: list[Any] = []

    def show(png: bytes, samples: int) -> None:
        picture = ipython.Image(data=png, format="png")
        if handles:
            handles[0].update(picture)
        else:
            handles.append(ipython.display(picture, display_id=True))

    return show
