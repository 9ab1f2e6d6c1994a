"""Patterns, A to M: written by `cargo xtask tables`, not by hand."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from .._items import (
    Item,
    TextureBlock,
)

if TYPE_CHECKING:
    from .._items import (
        Number,
        Vector,
    )


class Brick(TextureBlock):
    """Bricks in courses across y, the same along z.

    Args:
        course_height: height of a course, of bricks of length 1 (number > 0, size). Default:
            0.375.
        mortar: width of the joints (number from 0 to 1, size). Default: 0.0625.
        shift: by which part of a brick each course is moved (number). Default: 0.5.
        variation: by how much some bricks are darker (number from 0 to 1). Default: 0.
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

    keyword = "Brick"

    def __init__(
        self, *children: Item, name: str | None = None,
        course_height: Number | None = None,
        mortar: Number | None = None,
        shift: Number | None = None,
        variation: Number | None = None,
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
        self.course_height = course_height
        self.mortar = mortar
        self.shift = shift
        self.variation = variation
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


class Hexagons(TextureBlock):
    """Six-sided tiles in x and y, the same along z.

    Args:
        mortar: width of the joints (number from 0 to 1, size). Default: 0.0625.
        variation: by how much some tiles are darker (number from 0 to 1). Default: 0.
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

    keyword = "Hexagons"

    def __init__(
        self, *children: Item, name: str | None = None,
        mortar: Number | None = None,
        variation: Number | None = None,
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
        self.mortar = mortar
        self.variation = variation
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


class Checks(TextureBlock):
    """Cubes that are 0 and 1 by turns.

    Args:
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

    keyword = "Checks"

    def __init__(
        self, *children: Item, name: str | None = None,
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


class Cells(TextureBlock):
    """Cubes, each with a number that is drawn for it.

    Args:
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

    keyword = "Cells"

    def __init__(
        self, *children: Item, name: str | None = None,
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


class Gradient(TextureBlock):
    """Bands across x.

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

    keyword = "Gradient"

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


class Clouds(TextureBlock):
    """Clouds: a sum of noise.

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

    keyword = "Clouds"

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


class Granite(TextureBlock):
    """Grains of stone.

    Args:
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

    keyword = "Granite"

    def __init__(
        self, *children: Item, name: str | None = None,
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


class Gabor(TextureBlock):
    """Waves of about one length, as of fabric and brushed metal.

    Args:
        frequency: waves per unit (number, 1/size). Default: 2.
        bandwidth: how much their frequencies differ (number > 0, 1/size). Default: 0.75.
        direction: what is across the waves; 0 0 0 for all directions (x y z). Default: 0 0 0.
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

    keyword = "Gabor"

    def __init__(
        self, *children: Item, name: str | None = None,
        frequency: Number | None = None,
        bandwidth: Number | None = None,
        direction: Vector | None = None,
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
        self.bandwidth = bandwidth
        self.direction = direction
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


class Agate(TextureBlock):
    """Folded layers of agate.

    Args:
        bend: how strongly turbulence folds the layers (number). Default: 2.
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

    keyword = "Agate"

    def __init__(
        self, *children: Item, name: str | None = None,
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


class Crackle(TextureBlock):
    """Cells with dark walls, as of dry mud and giraffes.

    Args:
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

    keyword = "Crackle"

    def __init__(
        self, *children: Item, name: str | None = None,
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


class Leopard(TextureBlock):
    """Round spots in rows.

    Args:
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

    keyword = "Leopard"

    def __init__(
        self, *children: Item, name: str | None = None,
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
