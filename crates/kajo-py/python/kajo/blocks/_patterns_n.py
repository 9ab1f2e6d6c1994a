"""Patterns, N to Z: written by `cargo xtask tables`, not by hand."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from .._items import (
    Item,
    TextureBlock,
)

if TYPE_CHECKING:
    from .._items import (
        Number,
    )


class Radial(TextureBlock):
    """Sectors around y.

    Args:
        wave: shape of a band (once, saw, sine or triangle). Default: triangle.
        arms: bands of a full turn (whole number from 1 to 100000). Default: 8.
        phase: by which part of a band it is moved (number). Default: 0.
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

    keyword = "Radial"

    def __init__(
        self, *children: Item, name: str | None = None,
        wave: Literal["once", "saw", "sine", "triangle"] | None = None,
        arms: int | None = None,
        phase: Number | None = None,
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
        self.wave = wave
        self.arms = arms
        self.phase = phase
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


class Spiral(TextureBlock):
    """Spirals around y.

    Args:
        wave: shape of a band (once, saw, sine or triangle). Default: triangle.
        arms: spirals beside each other (whole number from 0 to 100000). Default: 2.
        frequency: bands per unit of radius (number, 1/size). Default: 1.
        phase: by which part of a band it is moved (number). Default: 0.
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

    keyword = "Spiral"

    def __init__(
        self, *children: Item, name: str | None = None,
        wave: Literal["once", "saw", "sine", "triangle"] | None = None,
        arms: int | None = None,
        frequency: Number | None = None,
        phase: Number | None = None,
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
        self.wave = wave
        self.arms = arms
        self.frequency = frequency
        self.phase = phase
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


class Onion(TextureBlock):
    """Shells around the origin.

    Args:
        wave: shape of a band (once, saw, sine or triangle). Default: triangle.
        frequency: bands per unit (number, 1/size). Default: 1.
        phase: by which part of a band it is moved (number). Default: 0.
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

    keyword = "Onion"

    def __init__(
        self, *children: Item, name: str | None = None,
        wave: Literal["once", "saw", "sine", "triangle"] | None = None,
        frequency: Number | None = None,
        phase: Number | None = None,
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
        self.wave = wave
        self.frequency = frequency
        self.phase = phase
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


class Turbulence(TextureBlock):
    """Smoke and fire: a sum of creased noise.

    Args:
        octaves: levels of detail (whole number from 1 to 16). Default: 6.
        gain: size of a level by that of the one before (number from 0.01 to 1). Default: 0.5.
        lacunarity: frequency of a level by that of the one before (number from 1 to 16).
            Default: 2.
        seed: chooses one of many (whole number from 0 to 999999999). Default: 0.
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

    keyword = "Turbulence"

    def __init__(
        self, *children: Item, name: str | None = None,
        octaves: int | None = None,
        gain: Number | None = None,
        lacunarity: Number | None = None,
        seed: int | None = None,
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
        self.octaves = octaves
        self.gain = gain
        self.lacunarity = lacunarity
        self.seed = seed
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


class Ridged(TextureBlock):
    """Mountain ridges, lightning: noise that is sharp on top.

    Args:
        octaves: levels of detail (whole number from 1 to 16). Default: 6.
        gain: size of a level by that of the one before (number from 0.01 to 1). Default: 0.5.
        lacunarity: frequency of a level by that of the one before (number from 1 to 16).
            Default: 2.
        seed: chooses one of many (whole number from 0 to 999999999). Default: 0.
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

    keyword = "Ridged"

    def __init__(
        self, *children: Item, name: str | None = None,
        octaves: int | None = None,
        gain: Number | None = None,
        lacunarity: Number | None = None,
        seed: int | None = None,
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
        self.octaves = octaves
        self.gain = gain
        self.lacunarity = lacunarity
        self.seed = seed
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


class Wrinkles(TextureBlock):
    """Folds of cloth, leather and paper.

    Args:
        octaves: levels of detail (whole number from 1 to 16). Default: 6.
        gain: size of a level by that of the one before (number from 0.01 to 1). Default: 0.5.
        lacunarity: frequency of a level by that of the one before (number from 1 to 16).
            Default: 2.
        seed: chooses one of many (whole number from 0 to 999999999). Default: 0.
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

    keyword = "Wrinkles"

    def __init__(
        self, *children: Item, name: str | None = None,
        octaves: int | None = None,
        gain: Number | None = None,
        lacunarity: Number | None = None,
        seed: int | None = None,
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
        self.octaves = octaves
        self.gain = gain
        self.lacunarity = lacunarity
        self.seed = seed
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


class Veins(TextureBlock):
    """Marble: veins across x that noise bends.

    Args:
        wave: shape of a vein (once, saw, sine or triangle). Default: triangle.
        frequency: veins per unit (number, 1/size). Default: 1.
        phase: by which part of a vein it is moved (number). Default: 0.
        bend: by how many veins noise bends them (number). Default: 1.5.
        octaves: levels of detail (whole number from 1 to 16). Default: 6.
        gain: size of a level by that of the one before (number from 0.01 to 1). Default: 0.5.
        lacunarity: frequency of a level by that of the one before (number from 1 to 16).
            Default: 2.
        seed: chooses one of many (whole number from 0 to 999999999). Default: 0.
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

    keyword = "Veins"

    def __init__(
        self, *children: Item, name: str | None = None,
        wave: Literal["once", "saw", "sine", "triangle"] | None = None,
        frequency: Number | None = None,
        phase: Number | None = None,
        bend: Number | None = None,
        octaves: int | None = None,
        gain: Number | None = None,
        lacunarity: Number | None = None,
        seed: int | None = None,
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
        self.wave = wave
        self.frequency = frequency
        self.phase = phase
        self.bend = bend
        self.octaves = octaves
        self.gain = gain
        self.lacunarity = lacunarity
        self.seed = seed
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


class Rings(TextureBlock):
    """Wood: rings around y that noise bends.

    Args:
        wave: shape of a ring (once, saw, sine or triangle). Default: saw.
        frequency: rings per unit (number, 1/size). Default: 4.
        phase: by which part of a ring it is moved (number). Default: 0.
        bend: by how many rings noise bends them (number). Default: 1.
        octaves: levels of detail (whole number from 1 to 16). Default: 6.
        gain: size of a level by that of the one before (number from 0.01 to 1). Default: 0.5.
        lacunarity: frequency of a level by that of the one before (number from 1 to 16).
            Default: 2.
        seed: chooses one of many (whole number from 0 to 999999999). Default: 0.
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

    keyword = "Rings"

    def __init__(
        self, *children: Item, name: str | None = None,
        wave: Literal["once", "saw", "sine", "triangle"] | None = None,
        frequency: Number | None = None,
        phase: Number | None = None,
        bend: Number | None = None,
        octaves: int | None = None,
        gain: Number | None = None,
        lacunarity: Number | None = None,
        seed: int | None = None,
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
        self.wave = wave
        self.frequency = frequency
        self.phase = phase
        self.bend = bend
        self.octaves = octaves
        self.gain = gain
        self.lacunarity = lacunarity
        self.seed = seed
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


class Timber(TextureBlock):
    """Wood with late and early growth, knots, rays and pores.

    Args:
        frequency: rings per unit (number ≥ 0). Default: 8.
        bend: by how many rings noise bends them (number ≥ 0). Default: 1.
        knots: branches per unit of the trunk (number ≥ 0). Default: 0.5.
        rays: how dark the sheets outwards from the middle are (number ≥ 0). Default: 0.25.
        pores: how dark the tubes along the trunk are (number ≥ 0). Default: 0.25.
        seed: chooses one of many (whole number from 0 to 999999999). Default: 0.
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

    keyword = "Timber"

    def __init__(
        self, *children: Item, name: str | None = None,
        frequency: Number | None = None,
        bend: Number | None = None,
        knots: Number | None = None,
        rays: Number | None = None,
        pores: Number | None = None,
        seed: int | None = None,
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
        self.frequency = frequency
        self.bend = bend
        self.knots = knots
        self.rays = rays
        self.pores = pores
        self.seed = seed
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


class Worley(TextureBlock):
    """Distances to the nearest of many points.

    Args:
        value: what the distances make (cell, crackle, nearest or second). Default: nearest.
        metric: how distances are measured (chebyshev, euclidean or manhattan). Default:
            euclidean.
        seed: chooses one of many (whole number from 0 to 999999999). Default: 0.
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

    keyword = "Worley"

    def __init__(
        self, *children: Item, name: str | None = None,
        value: Literal["cell", "crackle", "nearest", "second"] | None = None,
        metric: Literal["chebyshev", "euclidean", "manhattan"] | None = None,
        seed: int | None = None,
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
        self.value = value
        self.metric = metric
        self.seed = seed
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


class Ripples(TextureBlock):
    """Waves of one length around ten places.

    Args:
        frequency: waves per unit (number, 1/size). Default: 1.
        phase: by which part of a wave they have run (number). Default: 0.
        seed: chooses one of many (whole number from 0 to 999999999). Default: 0.
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

    keyword = "Ripples"

    def __init__(
        self, *children: Item, name: str | None = None,
        frequency: Number | None = None,
        phase: Number | None = None,
        seed: int | None = None,
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
        self.frequency = frequency
        self.phase = phase
        self.seed = seed
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


class Waves(TextureBlock):
    """Waves of many lengths around ten places.

    Args:
        frequency: waves per unit (number, 1/size). Default: 1.
        phase: by which part of a wave they have run (number). Default: 0.
        seed: chooses one of many (whole number from 0 to 999999999). Default: 0.
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

    keyword = "Waves"

    def __init__(
        self, *children: Item, name: str | None = None,
        frequency: Number | None = None,
        phase: Number | None = None,
        seed: int | None = None,
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
        self.frequency = frequency
        self.phase = phase
        self.seed = seed
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
