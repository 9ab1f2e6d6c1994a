"""Lights: written by `cargo xtask tables`, not by hand."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .._items import (
    Item,
    LightBlock,
)

if TYPE_CHECKING:
    from .._items import (
        Emission,
        File,
        Number,
        Vector,
    )


class DirectionalLight(LightBlock):
    """Parallel light from far away, as of the sun.

    Args:
        direction: the way its light goes (x y z).
        color: brightness by the classic formula (r g b, or another light value). Default: none.
        irradiance: light on a surface that faces it (r g b, or another light value, W/m²).
            Default: none.
        angle: how wide it is in the sky; the sun: 0.53 (degrees from 0 to 180). Default: 0.
        group: name of the lights it is seen among (word or text). Default: none.
    """

    keyword = "DirectionalLight"

    def __init__(
        self, *children: Item, name: str | None = None,
        direction: Vector,
        color: Emission | None = None,
        irradiance: Emission | None = None,
        angle: Number | None = None,
        group: str | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.direction = direction
        self.color = color
        self.irradiance = irradiance
        self.angle = angle
        self.group = group


class PointLight(LightBlock):
    """Light from a point to all sides.

    Args:
        position: where it is (x y z).
        color: brightness by the classic formula (r g b, or another light value). Default: none.
        intensity: power per solid angle (r g b, or another light value, W/sr). Default: none.
        power: all the light it gives (r g b, or another light value, W). Default: none.
        attenuation: divides the colour by c0 + c1 d + c2 d² at the distance d (3 numbers).
            Default: 1 0 0.
        falloff: divides the colour by f d² at the distance d (number). Default: by
            `attenuation`.
        group: name of the lights it is seen among (word or text). Default: none.
        ies: measured intensities, in place of all these (file). Default: none.
        direction: where a measured luminaire points (x y z). Default: 0 -1 0.
        rotate: turns a measured luminaire about its axis (degrees). Default: 0.
        scale: makes a measured luminaire brighter (number ≥ 0). Default: 1.
    """

    keyword = "PointLight"

    def __init__(
        self, *children: Item, name: str | None = None,
        position: Vector,
        color: Emission | None = None,
        intensity: Emission | None = None,
        power: Emission | None = None,
        attenuation: Number | Vector | None = None,
        falloff: Number | None = None,
        group: str | None = None,
        ies: File | None = None,
        direction: Vector | None = None,
        rotate: Number | None = None,
        scale: Number | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.position = position
        self.color = color
        self.intensity = intensity
        self.power = power
        self.attenuation = attenuation
        self.falloff = falloff
        self.group = group
        self.ies = ies
        self.direction = direction
        self.rotate = rotate
        self.scale = scale


class SpotLight(LightBlock):
    """Light from a point into a cone.

    Args:
        position: where it is (x y z).
        direction: where it points (x y z).
        angle: full width of the cone (degrees from 0 to 360).
        inner_angle: width of the cone that is evenly bright (degrees from 0 to 360). Default: ¾
            of `angle`.
        color: brightness by the classic formula (r g b, or another light value). Default: none.
        intensity: power per solid angle (r g b, or another light value, W/sr). Default: none.
        power: all the light it gives (r g b, or another light value, W). Default: none.
        attenuation: divides the colour by c0 + c1 d + c2 d² at the distance d (3 numbers).
            Default: 1 0 0.
        falloff: divides the colour by f d² at the distance d (number). Default: by
            `attenuation`.
        group: name of the lights it is seen among (word or text). Default: none.
    """

    keyword = "SpotLight"

    def __init__(
        self, *children: Item, name: str | None = None,
        position: Vector,
        direction: Vector,
        angle: Number,
        inner_angle: Number | None = None,
        color: Emission | None = None,
        intensity: Emission | None = None,
        power: Emission | None = None,
        attenuation: Number | Vector | None = None,
        falloff: Number | None = None,
        group: str | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.position = position
        self.direction = direction
        self.angle = angle
        self.inner_angle = inner_angle
        self.color = color
        self.intensity = intensity
        self.power = power
        self.attenuation = attenuation
        self.falloff = falloff
        self.group = group
