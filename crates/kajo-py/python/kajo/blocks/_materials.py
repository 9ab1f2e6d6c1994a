"""Materials: written by `cargo xtask tables`, not by hand."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar, Literal

from .._items import (
    Item,
    MaterialBlock,
)

if TYPE_CHECKING:
    from .._items import (
        Emission,
        File,
        MaterialName,
        MediumName,
        Number,
        Reflectance,
        Texture,
        Vector,
    )


class PhongMaterial(MaterialBlock):
    """The classic material: matte, with a highlight, a mirror or clear.

    Args:
        diffuse_color: colour of matte reflection (r g b, or a file or spectrum, or a texture).
            Default: 1 1 1.
        texture: a picture that tints it, such as wood.png (picture, or a texture). Default:
            none.
        specular_color: colour of the highlight (r g b, or a file or spectrum, or a texture).
            Default: 0 0 0.
        exponent: sharpness of the highlight (number ≥ 0, or a texture). Default: 1, or 0 in
            mit-a2.
        reflective_color: colour of mirror reflection (r g b, or a file or spectrum, or a
            texture). Default: as `specularColor`.
        transparent_color: colour of what shines through (r g b, or a file or spectrum, or a
            texture). Default: 0 0 0.
        index_of_refraction: how strongly it bends light (number > 0). Default: 1.
        ambient_color: colour under ambient light (r g b, or a texture). Default: as
            `diffuseColor`.
        absorption: per length inside (r g b, 1/length). Default: by `transparentColor`.
        emission: light that it gives itself (r g b, or another light value, W/(m² sr), or a
            texture). Default: 0 0 0.
        emits: the side that gives light (back, both or front). Default: both.
        group: name of the lights it is seen among (word or text). Default: none.
        opacity: the share of it that is there, between holes (number from 0 to 1, or a
            texture). Default: 1.
        normal_map: a picture of normals that dents it, such as hammered.png (picture, or a
            texture). Default: none.
        bump: a picture or a function of heights that dents it, such as bricks.png (picture, or
            a texture). Default: none.
    """

    keyword = "PhongMaterial"

    def __init__(
        self, *children: Item, name: str | None = None,
        diffuse_color: Reflectance | Texture | None = None,
        texture: Texture | None = None,
        specular_color: Reflectance | Texture | None = None,
        exponent: Number | Texture | None = None,
        reflective_color: Reflectance | Texture | None = None,
        transparent_color: Reflectance | Texture | None = None,
        index_of_refraction: Number | None = None,
        ambient_color: Vector | Texture | None = None,
        absorption: Vector | None = None,
        emission: Emission | Texture | None = None,
        emits: Literal["back", "both", "front"] | None = None,
        group: str | None = None,
        opacity: Number | Texture | None = None,
        normal_map: Texture | None = None,
        bump: Texture | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.diffuse_color = diffuse_color
        self.texture = texture
        self.specular_color = specular_color
        self.exponent = exponent
        self.reflective_color = reflective_color
        self.transparent_color = transparent_color
        self.index_of_refraction = index_of_refraction
        self.ambient_color = ambient_color
        self.absorption = absorption
        self.emission = emission
        self.emits = emits
        self.group = group
        self.opacity = opacity
        self.normal_map = normal_map
        self.bump = bump


class Material(MaterialBlock):
    """The same as `PhongMaterial`.

    Args:
        diffuse_color: colour of matte reflection (r g b, or a file or spectrum, or a texture).
            Default: 1 1 1.
        texture: a picture that tints it, such as wood.png (picture, or a texture). Default:
            none.
        specular_color: colour of the highlight (r g b, or a file or spectrum, or a texture).
            Default: 0 0 0.
        exponent: sharpness of the highlight (number ≥ 0, or a texture). Default: 1, or 0 in
            mit-a2.
        reflective_color: colour of mirror reflection (r g b, or a file or spectrum, or a
            texture). Default: as `specularColor`.
        transparent_color: colour of what shines through (r g b, or a file or spectrum, or a
            texture). Default: 0 0 0.
        index_of_refraction: how strongly it bends light (number > 0). Default: 1.
        ambient_color: colour under ambient light (r g b, or a texture). Default: as
            `diffuseColor`.
        absorption: per length inside (r g b, 1/length). Default: by `transparentColor`.
        emission: light that it gives itself (r g b, or another light value, W/(m² sr), or a
            texture). Default: 0 0 0.
        emits: the side that gives light (back, both or front). Default: both.
        group: name of the lights it is seen among (word or text). Default: none.
        opacity: the share of it that is there, between holes (number from 0 to 1, or a
            texture). Default: 1.
        normal_map: a picture of normals that dents it, such as hammered.png (picture, or a
            texture). Default: none.
        bump: a picture or a function of heights that dents it, such as bricks.png (picture, or
            a texture). Default: none.
    """

    keyword = "Material"

    def __init__(
        self, *children: Item, name: str | None = None,
        diffuse_color: Reflectance | Texture | None = None,
        texture: Texture | None = None,
        specular_color: Reflectance | Texture | None = None,
        exponent: Number | Texture | None = None,
        reflective_color: Reflectance | Texture | None = None,
        transparent_color: Reflectance | Texture | None = None,
        index_of_refraction: Number | None = None,
        ambient_color: Vector | Texture | None = None,
        absorption: Vector | None = None,
        emission: Emission | Texture | None = None,
        emits: Literal["back", "both", "front"] | None = None,
        group: str | None = None,
        opacity: Number | Texture | None = None,
        normal_map: Texture | None = None,
        bump: Texture | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.diffuse_color = diffuse_color
        self.texture = texture
        self.specular_color = specular_color
        self.exponent = exponent
        self.reflective_color = reflective_color
        self.transparent_color = transparent_color
        self.index_of_refraction = index_of_refraction
        self.ambient_color = ambient_color
        self.absorption = absorption
        self.emission = emission
        self.emits = emits
        self.group = group
        self.opacity = opacity
        self.normal_map = normal_map
        self.bump = bump


class Matte(MaterialBlock):
    """Paper, plaster, chalk: light is scattered to all sides.

    Args:
        color: its colour (r g b, or a file or spectrum, or a texture). Default: 0.8 0.8 0.8.
        roughness: 0 is as paper, 1 as plaster (number from 0 to 1, or a texture). Default: 0.
        emission: light that it gives itself (r g b, or another light value, W/(m² sr), or a
            texture). Default: 0 0 0.
        emits: the side that gives light (back, both or front). Default: both.
        group: name of the lights it is seen among (word or text). Default: none.
        opacity: the share of it that is there, between holes (number from 0 to 1, or a
            texture). Default: 1.
        normal_map: a picture of normals that dents it, such as hammered.png (picture, or a
            texture). Default: none.
        bump: a picture or a function of heights that dents it, such as bricks.png (picture, or
            a texture). Default: none.
    """

    keyword = "Matte"

    def __init__(
        self, *children: Item, name: str | None = None,
        color: Reflectance | Texture | None = None,
        roughness: Number | Texture | None = None,
        emission: Emission | Texture | None = None,
        emits: Literal["back", "both", "front"] | None = None,
        group: str | None = None,
        opacity: Number | Texture | None = None,
        normal_map: Texture | None = None,
        bump: Texture | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.color = color
        self.roughness = roughness
        self.emission = emission
        self.emits = emits
        self.group = group
        self.opacity = opacity
        self.normal_map = normal_map
        self.bump = bump


class Metal(MaterialBlock):
    """Polished, rough or brushed metal.

    Args:
        metal: a measured metal, such as gold (word or text). Default: by `color`.
        color: its colour, where no metal is named (r g b, or a file or spectrum, or a texture).
            Default: 0.9 0.9 0.9.
        distribution: how the facets of a rough surface lie (beckmann or ggx). Default: ggx.
        roughness: 0 is a mirror (number from 0 to 1, or a texture). Default: 0.
        anisotropy: how far the highlight of a brushed surface is drawn out (number from 0 to 1,
            or a texture). Default: 0.
        rotation: by how many full turns the brushing is turned (number from 0 to 1, turns, or a
            texture). Default: 0.
        emission: light that it gives itself (r g b, or another light value, W/(m² sr), or a
            texture). Default: 0 0 0.
        emits: the side that gives light (back, both or front). Default: both.
        group: name of the lights it is seen among (word or text). Default: none.
        opacity: the share of it that is there, between holes (number from 0 to 1, or a
            texture). Default: 1.
        normal_map: a picture of normals that dents it, such as hammered.png (picture, or a
            texture). Default: none.
        bump: a picture or a function of heights that dents it, such as bricks.png (picture, or
            a texture). Default: none.
    """

    keyword = "Metal"

    def __init__(
        self, *children: Item, name: str | None = None,
        metal: str | None = None,
        color: Reflectance | Texture | None = None,
        distribution: Literal["beckmann", "ggx"] | None = None,
        roughness: Number | Texture | None = None,
        anisotropy: Number | Texture | None = None,
        rotation: Number | Texture | None = None,
        emission: Emission | Texture | None = None,
        emits: Literal["back", "both", "front"] | None = None,
        group: str | None = None,
        opacity: Number | Texture | None = None,
        normal_map: Texture | None = None,
        bump: Texture | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.metal = metal
        self.color = color
        self.distribution = distribution
        self.roughness = roughness
        self.anisotropy = anisotropy
        self.rotation = rotation
        self.emission = emission
        self.emits = emits
        self.group = group
        self.opacity = opacity
        self.normal_map = normal_map
        self.bump = bump


class Glass(MaterialBlock):
    """A clear or frosted body, or a pane.

    Args:
        glass: a measured glass, such as N-BK7 (word or text). Default: by `indexOfRefraction`.
        index_of_refraction: how strongly it bends light (number from 1 to 4). Default: 1.5.
        abbe_number: how little it splits colours (number > 0). Default: all colours alike.
        absorption: per length inside (r g b ≥ 0, 1/length). Default: 0 0 0.
        thickness: of a pane (number ≥ 0, length, or a texture). Default: a solid body.
        thin: a pane, whose surface stands for both its sides (on or off). Default: on with a
            `thickness`.
        distribution: how the facets of a rough surface lie (beckmann or ggx). Default: ggx.
        roughness: 0 is clear, more is frosted (number from 0 to 1, or a texture). Default: 0.
        anisotropy: how far the highlight of a brushed surface is drawn out (number from 0 to 1,
            or a texture). Default: 0.
        rotation: by how many full turns the brushing is turned (number from 0 to 1, turns, or a
            texture). Default: 0.
        medium: name of the medium that scatters light inside (word or text). Default: none.
        priority: of bodies that overlap, the one with the highest counts (whole number from
            -1000 to 1000). Default: 0.
        emission: light that it gives itself (r g b, or another light value, W/(m² sr), or a
            texture). Default: 0 0 0.
        emits: the side that gives light (back, both or front). Default: both.
        group: name of the lights it is seen among (word or text). Default: none.
        opacity: the share of it that is there, between holes (number from 0 to 1, or a
            texture). Default: 1.
        normal_map: a picture of normals that dents it, such as hammered.png (picture, or a
            texture). Default: none.
        bump: a picture or a function of heights that dents it, such as bricks.png (picture, or
            a texture). Default: none.
    """

    keyword = "Glass"

    def __init__(
        self, *children: Item, name: str | None = None,
        glass: str | None = None,
        index_of_refraction: Number | None = None,
        abbe_number: Number | None = None,
        absorption: Vector | None = None,
        thickness: Number | Texture | None = None,
        thin: bool | None = None,
        distribution: Literal["beckmann", "ggx"] | None = None,
        roughness: Number | Texture | None = None,
        anisotropy: Number | Texture | None = None,
        rotation: Number | Texture | None = None,
        medium: MediumName | None = None,
        priority: int | None = None,
        emission: Emission | Texture | None = None,
        emits: Literal["back", "both", "front"] | None = None,
        group: str | None = None,
        opacity: Number | Texture | None = None,
        normal_map: Texture | None = None,
        bump: Texture | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.glass = glass
        self.index_of_refraction = index_of_refraction
        self.abbe_number = abbe_number
        self.absorption = absorption
        self.thickness = thickness
        self.thin = thin
        self.distribution = distribution
        self.roughness = roughness
        self.anisotropy = anisotropy
        self.rotation = rotation
        self.medium = medium
        self.priority = priority
        self.emission = emission
        self.emits = emits
        self.group = group
        self.opacity = opacity
        self.normal_map = normal_map
        self.bump = bump


class Principled(MaterialBlock):
    """One material for most things: fuzz over a coat over a base, metal and glass.

    Args:
        color: its colour (r g b, or a file or spectrum, or a texture). Default: 0.8 0.8 0.8.
        metalness: from plastic to metal (number from 0 to 1, or a texture). Default: 0.
        roughness: of the highlight (number from 0 to 1, or a texture). Default: 0.3.
        anisotropy: how far the highlight of a brushed surface is drawn out (number from 0 to 1,
            or a texture). Default: 0.
        rotation: by how many full turns the brushing is turned (number from 0 to 1, turns, or a
            texture). Default: 0.
        specular_color: tints the highlight (r g b, or a file or spectrum, or a texture).
            Default: 1 1 1.
        index_of_refraction: strength of the highlight (number from 1 to 4, or a texture).
            Default: 1.5.
        transmission: from plastic to glass (number from 0 to 1, or a texture). Default: 0.
        absorption: of the glass, per length inside (r g b ≥ 0, 1/length). Default: 0 0 0.
        thin: its glass is a pane (on or off). Default: off.
        diffuse_roughness: 0 is as paper, 1 as plaster (number from 0 to 1, or a texture).
            Default: 0.
        coat: share of a clear coat (number from 0 to 1, or a texture). Default: 0.
        coat_color: tint of the coat (r g b, or a file or spectrum, or a texture). Default: 1 1
            1.
        coat_roughness: of the coat (number from 0 to 1, or a texture). Default: 0.
        coat_index_of_refraction: of the coat (number from 1 to 4, or a texture). Default: 1.6.
        fuzz: share of fuzz, as of velvet (number from 0 to 1, or a texture). Default: 0.
        fuzz_color: colour of the fuzz (r g b, or a file or spectrum, or a texture). Default: 1
            1 1.
        fuzz_roughness: of the fuzz (number from 0 to 1, or a texture). Default: 0.5.
        subsurface: from plastic to wax, skin and marble (number from 0 to 1, or a texture).
            Default: 0.
        subsurface_radius: how far light goes inside between collisions (r g b > 0, length).
            Default: 1 0.2 0.1.
        subsurface_scale: a factor of `subsurfaceRadius` (number > 0). Default: 0.05.
        subsurface_anisotropy: mean cosine inside: 0 to all sides, 0.8 as in skin (number from
            -0.99 to 0.99). Default: 0.
        medium: name of the medium that scatters light inside (word or text). Default: none.
        priority: of bodies that overlap, the one with the highest counts (whole number from
            -1000 to 1000). Default: 0.
        emission: light that it gives itself (r g b, or another light value, W/(m² sr), or a
            texture). Default: 0 0 0.
        emits: the side that gives light (back, both or front). Default: both.
        group: name of the lights it is seen among (word or text). Default: none.
        opacity: the share of it that is there, between holes (number from 0 to 1, or a
            texture). Default: 1.
        normal_map: a picture of normals that dents it, such as hammered.png (picture, or a
            texture). Default: none.
        bump: a picture or a function of heights that dents it, such as bricks.png (picture, or
            a texture). Default: none.
    """

    keyword = "Principled"

    def __init__(
        self, *children: Item, name: str | None = None,
        color: Reflectance | Texture | None = None,
        metalness: Number | Texture | None = None,
        roughness: Number | Texture | None = None,
        anisotropy: Number | Texture | None = None,
        rotation: Number | Texture | None = None,
        specular_color: Reflectance | Texture | None = None,
        index_of_refraction: Number | Texture | None = None,
        transmission: Number | Texture | None = None,
        absorption: Vector | None = None,
        thin: bool | None = None,
        diffuse_roughness: Number | Texture | None = None,
        coat: Number | Texture | None = None,
        coat_color: Reflectance | Texture | None = None,
        coat_roughness: Number | Texture | None = None,
        coat_index_of_refraction: Number | Texture | None = None,
        fuzz: Number | Texture | None = None,
        fuzz_color: Reflectance | Texture | None = None,
        fuzz_roughness: Number | Texture | None = None,
        subsurface: Number | Texture | None = None,
        subsurface_radius: Vector | None = None,
        subsurface_scale: Number | None = None,
        subsurface_anisotropy: Number | None = None,
        medium: MediumName | None = None,
        priority: int | None = None,
        emission: Emission | Texture | None = None,
        emits: Literal["back", "both", "front"] | None = None,
        group: str | None = None,
        opacity: Number | Texture | None = None,
        normal_map: Texture | None = None,
        bump: Texture | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.color = color
        self.metalness = metalness
        self.roughness = roughness
        self.anisotropy = anisotropy
        self.rotation = rotation
        self.specular_color = specular_color
        self.index_of_refraction = index_of_refraction
        self.transmission = transmission
        self.absorption = absorption
        self.thin = thin
        self.diffuse_roughness = diffuse_roughness
        self.coat = coat
        self.coat_color = coat_color
        self.coat_roughness = coat_roughness
        self.coat_index_of_refraction = coat_index_of_refraction
        self.fuzz = fuzz
        self.fuzz_color = fuzz_color
        self.fuzz_roughness = fuzz_roughness
        self.subsurface = subsurface
        self.subsurface_radius = subsurface_radius
        self.subsurface_scale = subsurface_scale
        self.subsurface_anisotropy = subsurface_anisotropy
        self.medium = medium
        self.priority = priority
        self.emission = emission
        self.emits = emits
        self.group = group
        self.opacity = opacity
        self.normal_map = normal_map
        self.bump = bump


class BTF(MaterialBlock):
    """Cloth, leather: a texture that depends on view and light.

    Args:
        file: a BTF, as `kajo btf` makes them (file).
        scale: a factor of all that it reflects (number ≥ 0, or a texture). Default: 1.
        repeat: how often it fits into the unit square (2 numbers). Default: 1 1.
        offset: by how much of itself it is moved, to the left and down (2 numbers). Default: 0
            0.
        filter: what is between its texels, and whether smaller copies are shown (linear or
            trilinear). Default: linear.
        emission: light that it gives itself (r g b, or another light value, W/(m² sr), or a
            texture). Default: 0 0 0.
        emits: the side that gives light (back, both or front). Default: both.
        group: name of the lights it is seen among (word or text). Default: none.
        opacity: the share of it that is there, between holes (number from 0 to 1, or a
            texture). Default: 1.
        normal_map: a picture of normals that dents it, such as hammered.png (picture, or a
            texture). Default: none.
        bump: a picture or a function of heights that dents it, such as bricks.png (picture, or
            a texture). Default: none.
    """

    keyword = "BTF"

    def __init__(
        self, *children: Item, name: str | None = None,
        file: File,
        scale: Number | Texture | None = None,
        repeat: Number | Vector | None = None,
        offset: Number | Vector | None = None,
        filter: Literal["linear", "trilinear"] | None = None,
        emission: Emission | Texture | None = None,
        emits: Literal["back", "both", "front"] | None = None,
        group: str | None = None,
        opacity: Number | Texture | None = None,
        normal_map: Texture | None = None,
        bump: Texture | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.file = file
        self.scale = scale
        self.repeat = repeat
        self.offset = offset
        self.filter = filter
        self.emission = emission
        self.emits = emits
        self.group = group
        self.opacity = opacity
        self.normal_map = normal_map
        self.bump = bump


class Measured(MaterialBlock):
    """A material whose reflection was measured in a laboratory.

    Args:
        file: a table of MERL (.binary) or of RGL (.bsdf) (file).
        scale: a factor of all that it reflects (number ≥ 0, or a texture). Default: 1.
        rotation: by how many full turns the brushing is turned (number from 0 to 1, turns, or a
            texture). Default: 0.
        emission: light that it gives itself (r g b, or another light value, W/(m² sr), or a
            texture). Default: 0 0 0.
        emits: the side that gives light (back, both or front). Default: both.
        group: name of the lights it is seen among (word or text). Default: none.
        opacity: the share of it that is there, between holes (number from 0 to 1, or a
            texture). Default: 1.
        normal_map: a picture of normals that dents it, such as hammered.png (picture, or a
            texture). Default: none.
        bump: a picture or a function of heights that dents it, such as bricks.png (picture, or
            a texture). Default: none.
    """

    keyword = "Measured"

    def __init__(
        self, *children: Item, name: str | None = None,
        file: File,
        scale: Number | Texture | None = None,
        rotation: Number | Texture | None = None,
        emission: Emission | Texture | None = None,
        emits: Literal["back", "both", "front"] | None = None,
        group: str | None = None,
        opacity: Number | Texture | None = None,
        normal_map: Texture | None = None,
        bump: Texture | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.file = file
        self.scale = scale
        self.rotation = rotation
        self.emission = emission
        self.emits = emits
        self.group = group
        self.opacity = opacity
        self.normal_map = normal_map
        self.bump = bump


class Interface(MaterialBlock):
    """The end of smoke or haze, where light goes straight on.

    Args:
        medium: name of the medium that scatters light inside (word or text). Default: none.
        priority: of bodies that overlap, the one with the highest counts (whole number from
            -1000 to 1000). Default: 0.
        emission: light that it gives itself (r g b, or another light value, W/(m² sr), or a
            texture). Default: 0 0 0.
        emits: the side that gives light (back, both or front). Default: both.
        group: name of the lights it is seen among (word or text). Default: none.
        opacity: the share of it that is there, between holes (number from 0 to 1, or a
            texture). Default: 1.
        normal_map: a picture of normals that dents it, such as hammered.png (picture, or a
            texture). Default: none.
        bump: a picture or a function of heights that dents it, such as bricks.png (picture, or
            a texture). Default: none.
    """

    keyword = "Interface"

    def __init__(
        self, *children: Item, name: str | None = None,
        medium: MediumName | None = None,
        priority: int | None = None,
        emission: Emission | Texture | None = None,
        emits: Literal["back", "both", "front"] | None = None,
        group: str | None = None,
        opacity: Number | Texture | None = None,
        normal_map: Texture | None = None,
        bump: Texture | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.medium = medium
        self.priority = priority
        self.emission = emission
        self.emits = emits
        self.group = group
        self.opacity = opacity
        self.normal_map = normal_map
        self.bump = bump


class AccretionDisk(MaterialBlock):
    """Gas that emits on its way around a black hole.

    Args:
        hole: name of the `BlackHole` that it goes around (word or text).
        temperature: where it is hottest, in the frame of the gas (number > 0, K). Default:
            6500.
        luminance: how bright it is there, in that frame (number ≥ 0). Default: 1.
        pattern: what its light is multiplied by, such as a swirl (number from 0 to 1, or a
            texture). Default: 1.
        against_spin: whether it goes around left-handed about the axis (on or off). Default:
            off.
        emission: light that it gives itself (r g b, or another light value, W/(m² sr), or a
            texture). Default: 0 0 0.
        emits: the side that gives light (back, both or front). Default: both.
        group: name of the lights it is seen among (word or text). Default: none.
        opacity: the share of it that is there, between holes (number from 0 to 1, or a
            texture). Default: 1.
        normal_map: a picture of normals that dents it, such as hammered.png (picture, or a
            texture). Default: none.
        bump: a picture or a function of heights that dents it, such as bricks.png (picture, or
            a texture). Default: none.
    """

    keyword = "AccretionDisk"

    def __init__(
        self, *children: Item, name: str | None = None,
        hole: str,
        temperature: Number | None = None,
        luminance: Number | None = None,
        pattern: Number | Texture | None = None,
        against_spin: bool | None = None,
        emission: Emission | Texture | None = None,
        emits: Literal["back", "both", "front"] | None = None,
        group: str | None = None,
        opacity: Number | Texture | None = None,
        normal_map: Texture | None = None,
        bump: Texture | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.hole = hole
        self.temperature = temperature
        self.luminance = luminance
        self.pattern = pattern
        self.against_spin = against_spin
        self.emission = emission
        self.emits = emits
        self.group = group
        self.opacity = opacity
        self.normal_map = normal_map
        self.bump = bump


class GravitationalLens(MaterialBlock):
    """The plane of a mass that turns the light of what is far behind it.

    Args:
        center: its middle (x y z). Default: 0 0 0.
        mass: of a point: light at the distance b is turned by 4 mass / b (number ≥ 0, length).
            Default: 0.
        dispersion: of the velocities of a galaxy's stars, over that of light: turns light by 4
            pi dispersion^2 (number from 0 to 0.25). Default: 0.
        axis_ratio: how flat the galaxy is seen (number from 0.01 to 1). Default: 1.
        axis: where it is longer (x y z). Default: 1 0 0.
        core: radius within which all mass is spread out (number ≥ 0, length). Default: 0.
        emission: light that it gives itself (r g b, or another light value, W/(m² sr), or a
            texture). Default: 0 0 0.
        emits: the side that gives light (back, both or front). Default: both.
        group: name of the lights it is seen among (word or text). Default: none.
        opacity: the share of it that is there, between holes (number from 0 to 1, or a
            texture). Default: 1.
        normal_map: a picture of normals that dents it, such as hammered.png (picture, or a
            texture). Default: none.
        bump: a picture or a function of heights that dents it, such as bricks.png (picture, or
            a texture). Default: none.
    """

    keyword = "GravitationalLens"

    def __init__(
        self, *children: Item, name: str | None = None,
        center: Vector | None = None,
        mass: Number | None = None,
        dispersion: Number | None = None,
        axis_ratio: Number | None = None,
        axis: Vector | None = None,
        core: Number | None = None,
        emission: Emission | Texture | None = None,
        emits: Literal["back", "both", "front"] | None = None,
        group: str | None = None,
        opacity: Number | Texture | None = None,
        normal_map: Texture | None = None,
        bump: Texture | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.center = center
        self.mass = mass
        self.dispersion = dispersion
        self.axis_ratio = axis_ratio
        self.axis = axis
        self.core = core
        self.emission = emission
        self.emits = emits
        self.group = group
        self.opacity = opacity
        self.normal_map = normal_map
        self.bump = bump


class Checkerboard(MaterialBlock):
    """Two materials in cubes of length one.

    Args:
        material_index: the two materials that it mixes (name or number).
    """

    keyword = "Checkerboard"
    several: ClassVar[tuple[str, ...]] = ("material_index",)

    def __init__(
        self, *children: Item, name: str | None = None,
        material_index: Sequence[MaterialName],
    ) -> None:
        super().__init__(*children, name=name)
        self.material_index = material_index


class Mix(MaterialBlock):
    """Two materials in the same proportion everywhere.

    Args:
        material_index: the two materials that it mixes (name or number).
        amount: share of the second (number from 0 to 1, or a texture). Default: 0.5.
    """

    keyword = "Mix"
    several: ClassVar[tuple[str, ...]] = ("material_index",)

    def __init__(
        self, *children: Item, name: str | None = None,
        material_index: Sequence[MaterialName],
        amount: Number | Texture | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.material_index = material_index
        self.amount = amount


class Noise(MaterialBlock):
    """Two materials in clouds.

    Args:
        material_index: the two materials that it mixes (name or number).
        octaves: levels of detail (whole number from 0 to 32). Default: 1.
    """

    keyword = "Noise"
    several: ClassVar[tuple[str, ...]] = ("material_index",)

    def __init__(
        self, *children: Item, name: str | None = None,
        material_index: Sequence[MaterialName],
        octaves: int | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.material_index = material_index
        self.octaves = octaves


class Marble(MaterialBlock):
    """Two materials in veins.

    Args:
        material_index: the two materials that it mixes (name or number).
        octaves: levels of detail (whole number from 0 to 32). Default: 1.
        frequency: rings or veins per length (number, 1/length). Default: 1.
        amplitude: how strongly the noise bends them (number). Default: 1.
    """

    keyword = "Marble"
    several: ClassVar[tuple[str, ...]] = ("material_index",)

    def __init__(
        self, *children: Item, name: str | None = None,
        material_index: Sequence[MaterialName],
        octaves: int | None = None,
        frequency: Number | None = None,
        amplitude: Number | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.material_index = material_index
        self.octaves = octaves
        self.frequency = frequency
        self.amplitude = amplitude


class Wood(MaterialBlock):
    """Two materials in rings around an axis.

    Args:
        material_index: the two materials that it mixes (name or number).
        octaves: levels of detail (whole number from 0 to 32). Default: 1.
        frequency: rings or veins per length (number, 1/length). Default: 1.
        amplitude: how strongly the noise bends them (number). Default: 1.
    """

    keyword = "Wood"
    several: ClassVar[tuple[str, ...]] = ("material_index",)

    def __init__(
        self, *children: Item, name: str | None = None,
        material_index: Sequence[MaterialName],
        octaves: int | None = None,
        frequency: Number | None = None,
        amplitude: Number | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.material_index = material_index
        self.octaves = octaves
        self.frequency = frequency
        self.amplitude = amplitude
