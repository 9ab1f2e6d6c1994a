"""Rendered pictures."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import TYPE_CHECKING

from . import _native

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt


def _empty(shape: tuple[int, ...]) -> npt.NDArray[np.float32]:
    import numpy as np

    return np.empty(shape, np.float32)


class Image:
    """A rendered picture: layers as arrays, and files."""

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
    def r_hat(self) -> float | None:
        """R-hat of groups of Markov chains: above 1.05 they do not agree, and the picture needs more samples.

        Infinite for a single chain, which has nothing to be compared with. None without chains.
        """
        return self._native.r_hat

    @property
    def clamped(self) -> tuple[float, float, float] | None:
        """The share of the red, green and blue light that `clamp` has taken away, each from 0 to 1.

        None without a limit.
        """
        return self._native.clamped

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
        return self._native.layer(layer, _empty)

    def __array__(
        self, dtype: npt.DTypeLike | None = None, copy: bool | None = None
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
        self, path: str | os.PathLike[str], *, layers: Iterable[str] | None = None, bits: int = 8
    ) -> None:
        """Writes a file, whole or not at all; its ending is the format."""
        ending = os.path.splitext(os.fspath(path))[1].lstrip(".").lower()
        _native.write(os.fspath(path), self.encode(ending, layers=layers, bits=bits))

    def _repr_png_(self) -> bytes:
        return self.encode("png")

    def __repr__(self) -> str:
        width, height = self.size
        return f"<kajo.Image {width} x {height}: {', '.join(self.layers)}>"
