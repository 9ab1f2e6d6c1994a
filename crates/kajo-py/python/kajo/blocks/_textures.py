"""Textures that are made of others: written by `cargo xtask tables`, not by hand."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar, Literal

from .._items import (
    Function,
    Item,
    TextureBlock,
)

if TYPE_CHECKING:
    from .._items import (
        Number,
        Texture,
        Vector,
    )


class Placed(TextureBlock):
    """Another texture or a picture at another place.

    Args:
        texture: what it is made of: the name of a texture, a picture, a number, or a colour
            (word or text, or a texture).
        space: what it is placed in: the world, or the space in which the fields of the shape
            are written (object or world). Default: world.
        size: length of the unit that it is described in (number > 0, length). Default: 1.
        projection: how it is laid on surfaces (camera, cubic, cylindrical, planar, solid,
            spherical, triplanar or uv). Default: solid.
        uv_set: which surface coordinates `projection uv` takes (whole number from 1 to 2).
            Default: 1.
        angle: opening of `projection camera` (degrees from 0.01 to 179). Default: 90.
        warp: by how many units turbulence moves it (number). Default: 0.
        warp_octaves: levels of detail of the turbulence (whole number from 1 to 16). Default:
            6.
        lambda_: frequency of a level by that of the one before (number from 1 to 16). Default:
            2.
        omega: size of a level by that of the one before (number from 0 to 1). Default: 0.5.
        filter: faded where it is finer than samples are apart (on or off). Default: off.
    """

    keyword = "Placed"

    def __init__(
        self, *children: Item, name: str | None = None,
        texture: Number | Vector | Texture,
        space: Literal["object", "world"] | None = None,
        size: Number | None = None,
        projection: Literal["camera", "cubic", "cylindrical", "planar", "solid", "spherical", "triplanar", "uv"] | None = None,
        uv_set: int | None = None,
        angle: Number | None = None,
        warp: Number | None = None,
        warp_octaves: int | None = None,
        lambda_: Number | None = None,
        omega: Number | None = None,
        filter: bool | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.texture = texture
        self.space = space
        self.size = size
        self.projection = projection
        self.uv_set = uv_set
        self.angle = angle
        self.warp = warp
        self.warp_octaves = warp_octaves
        self.lambda_ = lambda_
        self.omega = omega
        self.filter = filter


class Ramp(TextureBlock):
    """Colours by a number.

    Args:
        texture: what it is made of: the name of a texture, a picture, a number, or a colour
            (word or text, or a texture).
        stop: a position from 0 to 1, and the colour there; any number of these, in order (a
            number, then r g b from 0 to 1).
        interpolation: what is between colours (linear, oklab, smooth or step). Default: linear.
        frequency: how often it is run through from 0 to 1 (number). Default: 1.
        phase: by which part of itself it is moved (number). Default: 0.
    """

    keyword = "Ramp"
    several: ClassVar[tuple[str, ...]] = ("stop",)

    def __init__(
        self, *children: Item, name: str | None = None,
        texture: Number | Vector | Texture,
        stop: Sequence[Number | Vector],
        interpolation: Literal["linear", "oklab", "smooth", "step"] | None = None,
        frequency: Number | None = None,
        phase: Number | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.texture = texture
        self.stop = stop
        self.interpolation = interpolation
        self.frequency = frequency
        self.phase = phase


class Curve(TextureBlock):
    """Numbers by a number.

    Args:
        texture: what it is made of: the name of a texture, a picture, a number, or a colour
            (word or text, or a texture).
        stop: a position from 0 to 1, and the number there; any number of these, in order (2
            numbers: any, from 0 to 1).
        interpolation: what is between numbers (linear, smooth or step). Default: linear.
    """

    keyword = "Curve"
    several: ClassVar[tuple[str, ...]] = ("stop",)

    def __init__(
        self, *children: Item, name: str | None = None,
        texture: Number | Vector | Texture,
        stop: Sequence[Number | Vector],
        interpolation: Literal["linear", "smooth", "step"] | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.texture = texture
        self.stop = stop
        self.interpolation = interpolation


class Threshold(TextureBlock):
    """0 and 1, by whether a number is large.

    Args:
        texture: what it is made of: the name of a texture, a picture, a number, or a colour
            (word or text, or a texture).
        edge: what is less is 0, what is more is 1 (number from 0 to 1). Default: 0.5.
        softness: how wide the change is (number from 0 to 1). Default: 0.
    """

    keyword = "Threshold"

    def __init__(
        self, *children: Item, name: str | None = None,
        texture: Number | Vector | Texture,
        edge: Number | None = None,
        softness: Number | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.texture = texture
        self.edge = edge
        self.softness = softness


class Blend(TextureBlock):
    """Two textures in a proportion.

    Args:
        texture: what it is made of: the name of a texture, a picture, a number, or a colour
            (word or text, or a texture).
        amount: share of the second (number from 0 to 1, or a texture). Default: 0.5.
    """

    keyword = "Blend"
    several: ClassVar[tuple[str, ...]] = ("texture",)

    def __init__(
        self, *children: Item, name: str | None = None,
        texture: Sequence[Number | Vector | Texture],
        amount: Number | Texture | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.texture = texture
        self.amount = amount


class Multiply(TextureBlock):
    """The product of textures.

    Args:
        texture: what it is made of: the name of a texture, a picture, a number, or a colour
            (word or text, or a texture).
    """

    keyword = "Multiply"
    several: ClassVar[tuple[str, ...]] = ("texture",)

    def __init__(
        self, *children: Item, name: str | None = None,
        texture: Sequence[Number | Vector | Texture],
    ) -> None:
        super().__init__(*children, name=name)
        self.texture = texture


class Add(TextureBlock):
    """The sum of textures, held to 1.

    Args:
        texture: what it is made of: the name of a texture, a picture, a number, or a colour
            (word or text, or a texture).
    """

    keyword = "Add"
    several: ClassVar[tuple[str, ...]] = ("texture",)

    def __init__(
        self, *children: Item, name: str | None = None,
        texture: Sequence[Number | Vector | Texture],
    ) -> None:
        super().__init__(*children, name=name)
        self.texture = texture


class Formula(TextureBlock):
    """A function of up to three textures, held to [0, 1].

    Args:
        texture: what it is made of: the name of a texture, a picture, a number, or a colour
            (word or text, or a texture).
        function: where x, y and z are the first, the second and the third texture (= function
            of x, y, z).
    """

    keyword = "Formula"
    several: ClassVar[tuple[str, ...]] = ("texture",)
    functions: ClassVar[tuple[str, ...]] = ("function",)

    def __init__(
        self, *children: Item, name: str | None = None,
        texture: Sequence[Number | Vector | Texture],
        function: Function | str | Number,
    ) -> None:
        super().__init__(*children, name=name)
        self.texture = texture
        self.function = function
