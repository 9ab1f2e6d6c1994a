"""kajo, a ray tracer: scenes, renders and layers as numpy arrays.

>>> import kajo
>>> scene = kajo.load("scene.txt")
>>> image = scene.render(size=(320, 240), samples=("sobol", 16), layers=["color", "depth"])
>>> image["color"].shape
(240, 320, 3)
>>> image.save("out.exr")
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from typing import Union

import numpy as np
import numpy.typing as npt

from . import _native
from ._native import KajoError, LAYERS, RenderError, SceneError, __version__

__all__ = [
    "Image",
    "KajoError",
    "LAYERS",
    "RenderError",
    "Scene",
    "SceneError",
    "Value",
    "__version__",
    "build_identity",
    "load",
    "loads",
]

Value = Union[bool, int, float, str, tuple[Union[int, float, str], ...]]
"""What a setting may be: on or off, a number, a word, or several of them."""


def build_identity() -> str:
    """What decides the bits of pictures: renders of programs with equal identities are equal."""
    return _native.build_identity()


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

    assets: folders besides the scene's own whose files it may name.
    allow_outside: let it name files anywhere.
    camera: the camera that takes the picture, by its name; the last one by default.
    dialect: the lineage of the format, where it is not to be the scene's own choice.
    aspect: width over height of the picture, for cameras that fit something into it.

    Raises SceneError with every mistake, its place and a caret.
    """
    folders = [os.fspath(folder) for folder in assets]
    return Scene(_native.load(os.fspath(path), folders, allow_outside, camera, dialect, aspect))


def loads(
    text: str,
    *,
    files: Mapping[str, bytes] | None = None,
    name: str = "scene.txt",
    camera: str | None = None,
    dialect: str | None = None,
    aspect: float | None = None,
) -> Scene:
    """Reads a scene from its text.

    files: contents of the files it names, by their names.
    name: what the text is called in messages.
    """
    contents = {key: bytes(value) for key, value in (files or {}).items()}
    return Scene(_native.loads(text, name, contents, camera, dialect, aspect))


class Scene:
    """A scene, ready to be rendered. It never changes."""

    def __init__(self, native: _native.Scene) -> None:
        self._native = native

    @property
    def warnings(self) -> list[str]:
        """What was found odd about it: file:line:column: warning: what."""
        return self._native.warnings

    @property
    def objects(self) -> int:
        """How many objects it has."""
        return self._native.objects

    def render(
        self,
        *,
        layers: Iterable[str] = ("color",),
        threads: int = 0,
        noise: float | None = None,
        time: float | None = None,
        adaptive: bool = False,
        crop: tuple[int, int, int, int] | None = None,
        progress: Callable[[float], object] | None = None,
        **settings: Value,
    ) -> Image:
        """Renders a picture. The interpreter is free for other threads meanwhile, and Ctrl-C stops it.

        layers: what is recorded besides, see LAYERS.
        threads: 0 for one on each core. The picture has the same bits for any number.
        noise: end when the estimated relative error is this small.
        time: end after this many seconds.
        adaptive: take more samples where the picture is noisy.
        crop: left, top, width and height of the part that is wanted.
        progress: called about twenty times a second with the share that is done; what it raises stops the render.
        settings: any key of the block Settings of the scene language, in snake_case: size=(800, 600),
            samples=("sobol", 64), integrator="path", seed=1, shade_back=True.

        Raises SceneError for settings that make no sense, and RenderError.
        """
        names = list(dict.fromkeys(layers))
        samples = settings.get("samples")
        if isinstance(samples, int) and not isinstance(samples, bool):
            # As on the command line.
            settings["samples"] = ("jittered", samples)
        text = " ".join(f"{_key(key)} {_value(value)}" for key, value in settings.items())
        return Image(
            self._native.render(text, names, threads, noise, time, adaptive, crop, progress)
        )


class Image:
    """A rendered picture."""

    def __init__(self, native: _native.Image) -> None:
        self._native = native

    @property
    def size(self) -> tuple[int, int]:
        """Width and height."""
        return self._native.size

    @property
    def layers(self) -> list[str]:
        """Names of its layers."""
        return self._native.layers

    @property
    def samples(self) -> float:
        """Samples of a pixel, on average."""
        return self._native.samples

    @property
    def noise(self) -> float | None:
        """The estimated relative error, where it is known."""
        return self._native.noise

    @property
    def rays(self) -> int:
        """Rays that were cast."""
        return self._native.rays

    @property
    def seconds(self) -> float:
        """How long the render took."""
        return self._native.seconds

    def __getitem__(self, layer: str) -> npt.NDArray[np.float32]:
        """A layer as a new array of height x width x channels, row 0 on top: light is linear."""
        height, width, channels, data = self._native.layer(layer)
        return np.frombuffer(data, dtype=np.float32).reshape(height, width, channels).copy()

    def __array__(
        self, dtype: npt.DTypeLike = None, copy: bool | None = None
    ) -> npt.NDArray[np.float32]:
        if copy is False:
            raise ValueError("the layers of a picture are made anew for each array")
        return self["color"].astype(dtype, copy=False) if dtype is not None else self["color"]

    def encode(self, format: str = "png", *, layers: Iterable[str] | None = None, bits: int = 8) -> bytes:
        """The bytes of a file: png, exr, tga, bmp, ppm, pfm or hdr. Only exr shows more than one layer."""
        if layers is None:
            layers = self.layers if format == "exr" else self.layers[:1]
        return self._native.encode(list(layers), format, bits)

    def save(
        self,
        path: str | os.PathLike[str],
        *,
        layers: Iterable[str] | None = None,
        bits: int = 8,
    ) -> None:
        """Writes a file, whole or not at all; its ending is the format."""
        ending = os.path.splitext(os.fspath(path))[1].lstrip(".").lower()
        data = self.encode(ending, layers=layers, bits=bits)
        self._native.write(os.fspath(path), data)

    def _repr_png_(self) -> bytes:
        return self.encode("png")

    def __repr__(self) -> str:
        width, height = self.size
        return f"<kajo.Image {width} x {height}: {', '.join(self.layers)}>"


def _key(name: str) -> str:
    if not name.isidentifier():
        raise ValueError(f"{name!r} is no setting")
    first, *rest = name.split("_")
    return first + "".join(word.capitalize() for word in rest)


def _value(value: Value) -> str:
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, str):
        if value.replace("-", "").replace("_", "").isalnum() and not value[0].isdigit():
            return value
        if any(c in value for c in '"\\\n\r'):
            raise ValueError(f"{value!r} cannot be a setting")
        return f'"{value}"'
    if isinstance(value, (int, float, np.integer, np.floating)):
        return repr(value.item() if isinstance(value, np.generic) else value)
    if isinstance(value, (tuple, list)):
        return " ".join(_value(part) for part in value)
    raise TypeError(f"a setting is a bool, a number, a word or a tuple of these, not {type(value).__name__}")
