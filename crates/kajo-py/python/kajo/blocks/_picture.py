"""Pictures on surfaces: written by `cargo xtask tables`, not by hand."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar, Literal

from .._items import (
    PictureValue,
)

if TYPE_CHECKING:
    from .._items import (
        Emission,
        Number,
        PictureFile,
        Vector,
    )


class Picture(PictureValue):
    """A picture on a surface.

    Args:
        source: the name of its file, or an array of height x width x channels, see `kajo.picture_file`.
        repeat: how often it fits into the unit square, across and up; one number for both (2
            numbers). Default: 1 1.
        offset: moves it by so much of itself to the left and down (2 numbers). Default: 0 0.
        wrap: what is beside it: itself, its mirror image, its last row or column, black, or
            nothing: black with an alpha of 0 (repeat, mirror, clamp, black or once). Default:
            repeat.
        tiling: how it repeats; `random` lays pieces of it at random, without seams and without
            a pattern that is seen from afar (regular or random). Default: regular.
        filter: what is between its texels, and what stands for many of them (bilinear, nearest,
            bicubic, trilinear, sat, ewa, feline or stochastic). Default: by `textureFilter`.
        encoding: what its numbers mean; those of a key that is no colour are linear (srgb or
            linear). Default: by the file.
        channel: of pictures of numbers: which channel (red, green, blue or alpha). Default:
            red.
        range: of numbers: what 0 and 1, or black and white, stand for, within the values of the
            key; must be there where 0 or 1 is none of them (2 numbers). Default: 0 1.
        cutoff: of `opacity`: the surface is there where the picture is this much or more, and
            nowhere else (number from 0 to 1). Default: none.
        scale: of `normalMap`: how steep the dents are made (number). Default: 1.
        height: of `bump`: how far white rises above black (number, length). Default: 0.01.
        light: of `emission`: the light that shines through the picture (r g b, or another light
            value, W/(m² sr)). Default: 1 1 1.
        frames: of a sequence: the first and the last file that there are (2 whole numbers from
            -1000000000 to 1000000000). Default: a file for each frame.
        frame_offset: of a sequence: by how many frames what is shown is ahead (whole number
            from -1000000000 to 1000000000). Default: 0.
        cycle: whether it begins again, or stands still before its first and after its last
            picture (on or off). Default: off.
        factor: Of `emission`: a factor.
    """

    keys: ClassVar[dict[str, str]] = {
        "repeat": "repeat",
        "offset": "offset",
        "wrap": "wrap",
        "tiling": "tiling",
        "filter": "filter",
        "encoding": "encoding",
        "channel": "channel",
        "range": "range",
        "cutoff": "cutoff",
        "scale": "scale",
        "height": "height",
        "light": "light",
        "frames": "frames",
        "frame_offset": "frameOffset",
        "cycle": "cycle",
    }

    def __init__(
        self,
        source: PictureFile,
        *,
        repeat: Number | Vector | None = None,
        offset: Number | Vector | None = None,
        wrap: Literal["repeat", "mirror", "clamp", "black", "once"] | None = None,
        tiling: Literal["regular", "random"] | None = None,
        filter: Literal["bilinear", "nearest", "bicubic", "trilinear", "sat", "ewa", "feline", "stochastic"] | None = None,
        encoding: Literal["srgb", "linear"] | None = None,
        channel: Literal["red", "green", "blue", "alpha"] | None = None,
        range: Number | Vector | None = None,
        cutoff: Number | None = None,
        scale: Number | None = None,
        height: Number | None = None,
        light: Emission | None = None,
        frames: int | Sequence[int] | None = None,
        frame_offset: int | None = None,
        cycle: bool | None = None,
        factor: Number | None = None,
    ) -> None:
        super().__init__(source, factor)
        self.repeat = repeat
        self.offset = offset
        self.wrap = wrap
        self.tiling = tiling
        self.filter = filter
        self.encoding = encoding
        self.channel = channel
        self.range = range
        self.cutoff = cutoff
        self.scale = scale
        self.height = height
        self.light = light
        self.frames = frames
        self.frame_offset = frame_offset
        self.cycle = cycle
