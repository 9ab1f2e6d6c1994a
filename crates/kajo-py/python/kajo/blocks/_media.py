"""Media: written by `cargo xtask tables`, not by hand."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar, Literal

from .._items import (
    Function,
    Item,
    MediumBlock,
)

if TYPE_CHECKING:
    from .._items import (
        Emission,
        File,
        Number,
        Texture,
        Vector,
    )


class Medium(MediumBlock):
    """Milk, haze, coloured water: what is the same everywhere.

    Args:
        sigma_a: absorption per length (r g b ≥ 0, 1/length). Default: none.
        sigma_s: scattering per length (r g b ≥ 0, 1/length). Default: none.
        albedo: share of light that a collision scatters (r g b from 0 to 1). Default: 1 1 1.
        density: collisions per length (r g b ≥ 0, 1/length). Default: by the other keys.
        mean_free_path: mean length between collisions (r g b > 0, length). Default: by the
            other keys.
        scale: makes all of it denser (number ≥ 0). Default: 1.
        emission: radiance per length that it gives itself (r g b, or another light value, W/(m³
            sr)). Default: 0 0 0.
        phase: where to light is scattered (henyeyGreenstein, isotropic, mie, rayleigh or
            table). Default: by the other keys.
        g: mean cosine: -1 back, 0 to all sides, 1 straight on (number). Default: 0.
        droplets: mean diameter of the droplets of fog or a cloud (number from 5 to 50, µm).
            Default: 20 for `mie`.
        phase_table: rows of the angle by which light is turned and how much is (numbers).
            Default: none.
        phase_file: a file of such rows, one on a line (file). Default: none.
        phase_angle: what the first number of each row is (cosine or degrees). Default:
            `degrees`.
        phase_colors: whether the values of a row are three, of red, green and blue (on or off).
            Default: off.
        phase_wavelengths: wavelengths in nm, increasing, of which each row has a value (numbers
            > 0). Default: none.
    """

    keyword = "Medium"
    spelled: ClassVar[dict[str, str]] = {"sigma_a": "sigma_a", "sigma_s": "sigma_s"}

    def __init__(
        self, *children: Item, name: str | None = None,
        sigma_a: Vector | None = None,
        sigma_s: Vector | None = None,
        albedo: Vector | None = None,
        density: Vector | None = None,
        mean_free_path: Vector | None = None,
        scale: Number | None = None,
        emission: Emission | None = None,
        phase: Literal["henyeyGreenstein", "isotropic", "mie", "rayleigh", "table"] | None = None,
        g: Number | None = None,
        droplets: Number | None = None,
        phase_table: Number | Vector | None = None,
        phase_file: File | None = None,
        phase_angle: Literal["cosine", "degrees"] | None = None,
        phase_colors: bool | None = None,
        phase_wavelengths: Number | Vector | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.sigma_a = sigma_a
        self.sigma_s = sigma_s
        self.albedo = albedo
        self.density = density
        self.mean_free_path = mean_free_path
        self.scale = scale
        self.emission = emission
        self.phase = phase
        self.g = g
        self.droplets = droplets
        self.phase_table = phase_table
        self.phase_file = phase_file
        self.phase_angle = phase_angle
        self.phase_colors = phase_colors
        self.phase_wavelengths = phase_wavelengths


class GridMedium(MediumBlock):
    """A cloud, smoke or fire, given voxel by voxel.

    Args:
        file: its numbers: .vdb of OpenVDB, .nvdb of NanoVDB, .vol of Mitsuba, .df3 of POV-Ray,
            or raw values (file). Default: none.
        grid: name of the grid in a .vdb or .nvdb (word or text). Default: `density`, or the
            first.
        values: its numbers, as many as `size` says, x first (numbers). Default: those of
            `file`.
        size: numbers along x, y and z, of `values` and of raw files (3 whole numbers from 1 to
            4294967295). Default: by the file.
        encoding: how a raw file stores numbers (f32, u16 or u8). Default: by the file.
        min: the corner of its box with the smallest coordinates (x y z). Default: by the file,
            or -1 -1 -1.
        max: the corner of its box with the largest coordinates (x y z). Default: by the file,
            or 1 1 1.
        temperature: name of a grid in the same .vdb or .nvdb: it emits as a black body this hot
            (word or text). Default: none.
        temperature_scale: kelvin of the number 1 more in that grid (number, K). Default: 1.
        temperature_offset: kelvin of the number 0 (number, K). Default: 0.
        brightness: luminance per length that it gives at 2000 K (number ≥ 0, W/(m³ sr)).
            Default: 1.
        velocity: name of a grid of velocities in the same .vdb, or of three: vel.x, vel.y and
            vel.z (word or text). Default: none.
        velocity_scale: units of the file that the number 1 goes in a unit of the shutter's time
            (number, 1/time). Default: 1.
        albedo_grid: name of a grid of colours in the same .vdb: shares of what is scattered,
            times `albedo` (word or text). Default: none.
        sigma_a: absorption per length (r g b ≥ 0, 1/length). Default: none.
        sigma_s: scattering per length (r g b ≥ 0, 1/length). Default: none.
        albedo: share of light that a collision scatters (r g b from 0 to 1). Default: 1 1 1.
        density: collisions per length (r g b ≥ 0, 1/length). Default: by the other keys.
        mean_free_path: mean length between collisions (r g b > 0, length). Default: by the
            other keys.
        scale: makes all of it denser (number ≥ 0). Default: 1.
        emission: radiance per length that it gives itself (r g b, or another light value, W/(m³
            sr)). Default: 0 0 0.
        phase: where to light is scattered (henyeyGreenstein, isotropic, mie, rayleigh or
            table). Default: by the other keys.
        g: mean cosine: -1 back, 0 to all sides, 1 straight on (number). Default: 0.
        droplets: mean diameter of the droplets of fog or a cloud (number from 5 to 50, µm).
            Default: 20 for `mie`.
        phase_table: rows of the angle by which light is turned and how much is (numbers).
            Default: none.
        phase_file: a file of such rows, one on a line (file). Default: none.
        phase_angle: what the first number of each row is (cosine or degrees). Default:
            `degrees`.
        phase_colors: whether the values of a row are three, of red, green and blue (on or off).
            Default: off.
        phase_wavelengths: wavelengths in nm, increasing, of which each row has a value (numbers
            > 0). Default: none.
    """

    keyword = "GridMedium"
    spelled: ClassVar[dict[str, str]] = {"sigma_a": "sigma_a", "sigma_s": "sigma_s"}

    def __init__(
        self, *children: Item, name: str | None = None,
        file: File | None = None,
        grid: str | None = None,
        values: Number | Vector | None = None,
        size: int | Sequence[int] | None = None,
        encoding: Literal["f32", "u16", "u8"] | None = None,
        min: Vector | None = None,
        max: Vector | None = None,
        temperature: str | None = None,
        temperature_scale: Number | None = None,
        temperature_offset: Number | None = None,
        brightness: Number | None = None,
        velocity: str | None = None,
        velocity_scale: Number | None = None,
        albedo_grid: str | None = None,
        sigma_a: Vector | None = None,
        sigma_s: Vector | None = None,
        albedo: Vector | None = None,
        density: Vector | None = None,
        mean_free_path: Vector | None = None,
        scale: Number | None = None,
        emission: Emission | None = None,
        phase: Literal["henyeyGreenstein", "isotropic", "mie", "rayleigh", "table"] | None = None,
        g: Number | None = None,
        droplets: Number | None = None,
        phase_table: Number | Vector | None = None,
        phase_file: File | None = None,
        phase_angle: Literal["cosine", "degrees"] | None = None,
        phase_colors: bool | None = None,
        phase_wavelengths: Number | Vector | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.file = file
        self.grid = grid
        self.values = values
        self.size = size
        self.encoding = encoding
        self.min = min
        self.max = max
        self.temperature = temperature
        self.temperature_scale = temperature_scale
        self.temperature_offset = temperature_offset
        self.brightness = brightness
        self.velocity = velocity
        self.velocity_scale = velocity_scale
        self.albedo_grid = albedo_grid
        self.sigma_a = sigma_a
        self.sigma_s = sigma_s
        self.albedo = albedo
        self.density = density
        self.mean_free_path = mean_free_path
        self.scale = scale
        self.emission = emission
        self.phase = phase
        self.g = g
        self.droplets = droplets
        self.phase_table = phase_table
        self.phase_file = phase_file
        self.phase_angle = phase_angle
        self.phase_colors = phase_colors
        self.phase_wavelengths = phase_wavelengths


class FunctionMedium(MediumBlock):
    """Haze or a cloud by a function of the place.

    Args:
        function: its density; where it is negative there is nothing (= function of x, y, z).
        min: the corner of its box with the smallest coordinates (x y z). Default: -1 -1 -1.
        max: the corner of its box with the largest coordinates (x y z). Default: 1 1 1.
        sigma_a: absorption per length (r g b ≥ 0, 1/length). Default: none.
        sigma_s: scattering per length (r g b ≥ 0, 1/length). Default: none.
        albedo: share of light that a collision scatters (r g b from 0 to 1). Default: 1 1 1.
        density: collisions per length (r g b ≥ 0, 1/length). Default: by the other keys.
        mean_free_path: mean length between collisions (r g b > 0, length). Default: by the
            other keys.
        scale: makes all of it denser (number ≥ 0). Default: 1.
        emission: radiance per length that it gives itself (r g b, or another light value, W/(m³
            sr)). Default: 0 0 0.
        phase: where to light is scattered (henyeyGreenstein, isotropic, mie, rayleigh or
            table). Default: by the other keys.
        g: mean cosine: -1 back, 0 to all sides, 1 straight on (number). Default: 0.
        droplets: mean diameter of the droplets of fog or a cloud (number from 5 to 50, µm).
            Default: 20 for `mie`.
        phase_table: rows of the angle by which light is turned and how much is (numbers).
            Default: none.
        phase_file: a file of such rows, one on a line (file). Default: none.
        phase_angle: what the first number of each row is (cosine or degrees). Default:
            `degrees`.
        phase_colors: whether the values of a row are three, of red, green and blue (on or off).
            Default: off.
        phase_wavelengths: wavelengths in nm, increasing, of which each row has a value (numbers
            > 0). Default: none.
    """

    keyword = "FunctionMedium"
    functions: ClassVar[tuple[str, ...]] = ("function",)
    spelled: ClassVar[dict[str, str]] = {"sigma_a": "sigma_a", "sigma_s": "sigma_s"}

    def __init__(
        self, *children: Item, name: str | None = None,
        function: Function | str | Number,
        min: Vector | None = None,
        max: Vector | None = None,
        sigma_a: Vector | None = None,
        sigma_s: Vector | None = None,
        albedo: Vector | None = None,
        density: Vector | None = None,
        mean_free_path: Vector | None = None,
        scale: Number | None = None,
        emission: Emission | None = None,
        phase: Literal["henyeyGreenstein", "isotropic", "mie", "rayleigh", "table"] | None = None,
        g: Number | None = None,
        droplets: Number | None = None,
        phase_table: Number | Vector | None = None,
        phase_file: File | None = None,
        phase_angle: Literal["cosine", "degrees"] | None = None,
        phase_colors: bool | None = None,
        phase_wavelengths: Number | Vector | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.function = function
        self.min = min
        self.max = max
        self.sigma_a = sigma_a
        self.sigma_s = sigma_s
        self.albedo = albedo
        self.density = density
        self.mean_free_path = mean_free_path
        self.scale = scale
        self.emission = emission
        self.phase = phase
        self.g = g
        self.droplets = droplets
        self.phase_table = phase_table
        self.phase_file = phase_file
        self.phase_angle = phase_angle
        self.phase_colors = phase_colors
        self.phase_wavelengths = phase_wavelengths


class TextureMedium(MediumBlock):
    """Smoke or a cloud by a texture.

    Args:
        texture: what it is made of: the name of a texture, a picture, a number, or a colour
            (word or text, or a texture).
        min: the corner of its box with the smallest coordinates (x y z). Default: -1 -1 -1.
        max: the corner of its box with the largest coordinates (x y z). Default: 1 1 1.
        sigma_a: absorption per length (r g b ≥ 0, 1/length). Default: none.
        sigma_s: scattering per length (r g b ≥ 0, 1/length). Default: none.
        albedo: share of light that a collision scatters (r g b from 0 to 1). Default: 1 1 1.
        density: collisions per length (r g b ≥ 0, 1/length). Default: by the other keys.
        mean_free_path: mean length between collisions (r g b > 0, length). Default: by the
            other keys.
        scale: makes all of it denser (number ≥ 0). Default: 1.
        emission: radiance per length that it gives itself (r g b, or another light value, W/(m³
            sr)). Default: 0 0 0.
        phase: where to light is scattered (henyeyGreenstein, isotropic, mie, rayleigh or
            table). Default: by the other keys.
        g: mean cosine: -1 back, 0 to all sides, 1 straight on (number). Default: 0.
        droplets: mean diameter of the droplets of fog or a cloud (number from 5 to 50, µm).
            Default: 20 for `mie`.
        phase_table: rows of the angle by which light is turned and how much is (numbers).
            Default: none.
        phase_file: a file of such rows, one on a line (file). Default: none.
        phase_angle: what the first number of each row is (cosine or degrees). Default:
            `degrees`.
        phase_colors: whether the values of a row are three, of red, green and blue (on or off).
            Default: off.
        phase_wavelengths: wavelengths in nm, increasing, of which each row has a value (numbers
            > 0). Default: none.
    """

    keyword = "TextureMedium"
    spelled: ClassVar[dict[str, str]] = {"sigma_a": "sigma_a", "sigma_s": "sigma_s"}

    def __init__(
        self, *children: Item, name: str | None = None,
        texture: Number | Vector | Texture,
        min: Vector | None = None,
        max: Vector | None = None,
        sigma_a: Vector | None = None,
        sigma_s: Vector | None = None,
        albedo: Vector | None = None,
        density: Vector | None = None,
        mean_free_path: Vector | None = None,
        scale: Number | None = None,
        emission: Emission | None = None,
        phase: Literal["henyeyGreenstein", "isotropic", "mie", "rayleigh", "table"] | None = None,
        g: Number | None = None,
        droplets: Number | None = None,
        phase_table: Number | Vector | None = None,
        phase_file: File | None = None,
        phase_angle: Literal["cosine", "degrees"] | None = None,
        phase_colors: bool | None = None,
        phase_wavelengths: Number | Vector | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.texture = texture
        self.min = min
        self.max = max
        self.sigma_a = sigma_a
        self.sigma_s = sigma_s
        self.albedo = albedo
        self.density = density
        self.mean_free_path = mean_free_path
        self.scale = scale
        self.emission = emission
        self.phase = phase
        self.g = g
        self.droplets = droplets
        self.phase_table = phase_table
        self.phase_file = phase_file
        self.phase_angle = phase_angle
        self.phase_colors = phase_colors
        self.phase_wavelengths = phase_wavelengths


class GradientIndex(MediumBlock):
    """Clear matter that bends light, by its index of refraction at every place.

    Args:
        index: index of refraction by `x`, `y` and `z` in world space (= function of x, y, z).
        abbe_number: how little it splits colours (number > 0). Default: all colours alike.
        noise: how much Perlin noise adds to the index (number ≥ 0). Default: 0.
        noise_frequency: how fine the noise is along each axis (x y z, 1/length). Default: 1 1
            1.
        noise_origin: where the noise has its origin; keys of an animation make it drift (x y
            z). Default: 0 0 0.
        octaves: how many noises are added up (whole number from 1 to 16). Default: 3.
        integrator: how light is followed from step to step (adaptive, euler or rungeKutta).
            Default: adaptive.
        steps: of the fixed integrators, for the diagonal of the body (whole number from 1 to
            1000000). Default: 1000.
    """

    keyword = "GradientIndex"
    functions: ClassVar[tuple[str, ...]] = ("index",)

    def __init__(
        self, *children: Item, name: str | None = None,
        index: Function | str | Number,
        abbe_number: Number | None = None,
        noise: Number | None = None,
        noise_frequency: Vector | None = None,
        noise_origin: Vector | None = None,
        octaves: int | None = None,
        integrator: Literal["adaptive", "euler", "rungeKutta"] | None = None,
        steps: int | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.index = index
        self.abbe_number = abbe_number
        self.noise = noise
        self.noise_frequency = noise_frequency
        self.noise_origin = noise_origin
        self.octaves = octaves
        self.integrator = integrator
        self.steps = steps


class IndexGrid(MediumBlock):
    """Clear matter that bends light, by indices of refraction on a grid.

    Args:
        file: its numbers: .vdb of OpenVDB, .nvdb of NanoVDB, .vol of Mitsuba, .df3 of POV-Ray,
            or raw values (file). Default: none.
        grid: name of the grid in a .vdb or .nvdb (word or text). Default: `density`, or the
            first.
        values: its numbers, as many as `size` says, x first (numbers). Default: those of
            `file`.
        size: numbers along x, y and z, of `values` and of raw files (3 whole numbers from 1 to
            4294967295). Default: by the file.
        encoding: how a raw file stores numbers (f32, u16 or u8). Default: by the file.
        min: the corner of its box with the smallest coordinates (x y z). Default: by the file,
            or -1 -1 -1.
        max: the corner of its box with the largest coordinates (x y z). Default: by the file,
            or 1 1 1.
        scale: what its numbers are multiplied by (number). Default: 1.
        offset: index of refraction where the number is 0 (number). Default: 0.
        abbe_number: how little it splits colours (number > 0). Default: all colours alike.
        noise: how much Perlin noise adds to the index (number ≥ 0). Default: 0.
        noise_frequency: how fine the noise is along each axis (x y z, 1/length). Default: 1 1
            1.
        noise_origin: where the noise has its origin; keys of an animation make it drift (x y
            z). Default: 0 0 0.
        octaves: how many noises are added up (whole number from 1 to 16). Default: 3.
        integrator: how light is followed from step to step (adaptive, euler or rungeKutta).
            Default: adaptive.
        steps: of the fixed integrators, for the diagonal of the body (whole number from 1 to
            1000000). Default: 1000.
    """

    keyword = "IndexGrid"

    def __init__(
        self, *children: Item, name: str | None = None,
        file: File | None = None,
        grid: str | None = None,
        values: Number | Vector | None = None,
        size: int | Sequence[int] | None = None,
        encoding: Literal["f32", "u16", "u8"] | None = None,
        min: Vector | None = None,
        max: Vector | None = None,
        scale: Number | None = None,
        offset: Number | None = None,
        abbe_number: Number | None = None,
        noise: Number | None = None,
        noise_frequency: Vector | None = None,
        noise_origin: Vector | None = None,
        octaves: int | None = None,
        integrator: Literal["adaptive", "euler", "rungeKutta"] | None = None,
        steps: int | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.file = file
        self.grid = grid
        self.values = values
        self.size = size
        self.encoding = encoding
        self.min = min
        self.max = max
        self.scale = scale
        self.offset = offset
        self.abbe_number = abbe_number
        self.noise = noise
        self.noise_frequency = noise_frequency
        self.noise_origin = noise_origin
        self.octaves = octaves
        self.integrator = integrator
        self.steps = steps


class LuneburgLens(MediumBlock):
    """A ball of the index sqrt(2 - (r/R)^2): parallel light meets on its far side.

    Args:
        center: middle of the ball (x y z). Default: 0 0 0.
        radius: where its index is 1 (number > 0, length). Default: 1.
        abbe_number: how little it splits colours (number > 0). Default: all colours alike.
        noise: how much Perlin noise adds to the index (number ≥ 0). Default: 0.
        noise_frequency: how fine the noise is along each axis (x y z, 1/length). Default: 1 1
            1.
        noise_origin: where the noise has its origin; keys of an animation make it drift (x y
            z). Default: 0 0 0.
        octaves: how many noises are added up (whole number from 1 to 16). Default: 3.
        integrator: how light is followed from step to step (adaptive, euler or rungeKutta).
            Default: adaptive.
        steps: of the fixed integrators, for the diagonal of the body (whole number from 1 to
            1000000). Default: 1000.
    """

    keyword = "LuneburgLens"

    def __init__(
        self, *children: Item, name: str | None = None,
        center: Vector | None = None,
        radius: Number | None = None,
        abbe_number: Number | None = None,
        noise: Number | None = None,
        noise_frequency: Vector | None = None,
        noise_origin: Vector | None = None,
        octaves: int | None = None,
        integrator: Literal["adaptive", "euler", "rungeKutta"] | None = None,
        steps: int | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.center = center
        self.radius = radius
        self.abbe_number = abbe_number
        self.noise = noise
        self.noise_frequency = noise_frequency
        self.noise_origin = noise_origin
        self.octaves = octaves
        self.integrator = integrator
        self.steps = steps


class MaxwellFishEye(MediumBlock):
    """Matter of the index n0 / (1 + (r/a)^2), in which rays are circles.

    Args:
        center: its middle (x y z). Default: 0 0 0.
        radius: where its index is half of that in the middle (number > 0, length). Default: 1.
        index: index of refraction in the middle (number > 0). Default: 2.
        abbe_number: how little it splits colours (number > 0). Default: all colours alike.
        noise: how much Perlin noise adds to the index (number ≥ 0). Default: 0.
        noise_frequency: how fine the noise is along each axis (x y z, 1/length). Default: 1 1
            1.
        noise_origin: where the noise has its origin; keys of an animation make it drift (x y
            z). Default: 0 0 0.
        octaves: how many noises are added up (whole number from 1 to 16). Default: 3.
        integrator: how light is followed from step to step (adaptive, euler or rungeKutta).
            Default: adaptive.
        steps: of the fixed integrators, for the diagonal of the body (whole number from 1 to
            1000000). Default: 1000.
    """

    keyword = "MaxwellFishEye"

    def __init__(
        self, *children: Item, name: str | None = None,
        center: Vector | None = None,
        radius: Number | None = None,
        index: Number | None = None,
        abbe_number: Number | None = None,
        noise: Number | None = None,
        noise_frequency: Vector | None = None,
        noise_origin: Vector | None = None,
        octaves: int | None = None,
        integrator: Literal["adaptive", "euler", "rungeKutta"] | None = None,
        steps: int | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.center = center
        self.radius = radius
        self.index = index
        self.abbe_number = abbe_number
        self.noise = noise
        self.noise_frequency = noise_frequency
        self.noise_origin = noise_origin
        self.octaves = octaves
        self.integrator = integrator
        self.steps = steps


class RodLens(MediumBlock):
    """A rod of the index n0 sqrt(1 - (g r)^2), that light winds through like a wave.

    Args:
        origin: a point of its axis (x y z). Default: 0 0 0.
        axis: along it (x y z). Default: 0 0 1.
        index: index of refraction on the axis (number > 0). Default: 1.5.
        gradient: g; light winds once in about 2 pi / g (number ≥ 0, 1/length). Default: 0.5.
        abbe_number: how little it splits colours (number > 0). Default: all colours alike.
        noise: how much Perlin noise adds to the index (number ≥ 0). Default: 0.
        noise_frequency: how fine the noise is along each axis (x y z, 1/length). Default: 1 1
            1.
        noise_origin: where the noise has its origin; keys of an animation make it drift (x y
            z). Default: 0 0 0.
        octaves: how many noises are added up (whole number from 1 to 16). Default: 3.
        integrator: how light is followed from step to step (adaptive, euler or rungeKutta).
            Default: adaptive.
        steps: of the fixed integrators, for the diagonal of the body (whole number from 1 to
            1000000). Default: 1000.
    """

    keyword = "RodLens"

    def __init__(
        self, *children: Item, name: str | None = None,
        origin: Vector | None = None,
        axis: Vector | None = None,
        index: Number | None = None,
        gradient: Number | None = None,
        abbe_number: Number | None = None,
        noise: Number | None = None,
        noise_frequency: Vector | None = None,
        noise_origin: Vector | None = None,
        octaves: int | None = None,
        integrator: Literal["adaptive", "euler", "rungeKutta"] | None = None,
        steps: int | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.origin = origin
        self.axis = axis
        self.index = index
        self.gradient = gradient
        self.abbe_number = abbe_number
        self.noise = noise
        self.noise_frequency = noise_frequency
        self.noise_origin = noise_origin
        self.octaves = octaves
        self.integrator = integrator
        self.steps = steps


class LinearIndex(MediumBlock):
    """Matter whose index has a square that grows evenly, in which rays are parabolas.

    Args:
        origin: where the index is `index` (x y z). Default: 0 0 0.
        index: index of refraction there (number > 0). Default: 1.5.
        gradient: half the gradient of the square of the index (x y z, 1/length). Default: 0 0.1
            0.
        abbe_number: how little it splits colours (number > 0). Default: all colours alike.
        noise: how much Perlin noise adds to the index (number ≥ 0). Default: 0.
        noise_frequency: how fine the noise is along each axis (x y z, 1/length). Default: 1 1
            1.
        noise_origin: where the noise has its origin; keys of an animation make it drift (x y
            z). Default: 0 0 0.
        octaves: how many noises are added up (whole number from 1 to 16). Default: 3.
        integrator: how light is followed from step to step (adaptive, euler or rungeKutta).
            Default: adaptive.
        steps: of the fixed integrators, for the diagonal of the body (whole number from 1 to
            1000000). Default: 1000.
    """

    keyword = "LinearIndex"

    def __init__(
        self, *children: Item, name: str | None = None,
        origin: Vector | None = None,
        index: Number | None = None,
        gradient: Vector | None = None,
        abbe_number: Number | None = None,
        noise: Number | None = None,
        noise_frequency: Vector | None = None,
        noise_origin: Vector | None = None,
        octaves: int | None = None,
        integrator: Literal["adaptive", "euler", "rungeKutta"] | None = None,
        steps: int | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.origin = origin
        self.index = index
        self.gradient = gradient
        self.abbe_number = abbe_number
        self.noise = noise
        self.noise_frequency = noise_frequency
        self.noise_origin = noise_origin
        self.octaves = octaves
        self.integrator = integrator
        self.steps = steps


class AirLayers(MediumBlock):
    """Air over hot or cold ground, in which mirages are seen.

    Args:
        up: away from the ground (x y z). Default: 0 1 0.
        ground: where the ground is along `up` (number, length). Default: 0.
        meter: a metre in the scene's unit (number > 0, length). Default: 1.
        temperature: of air away from the ground (number > 0, K). Default: 293.
        rise: how much hotter it is at the ground; negative for colder (number, K). Default: 0.
        depth: height in which that falls to 1/e (number > 0, m). Default: 0.1.
        inversion: how much warmer it is above a certain height (number, K). Default: 0.
        inversion_height: that height (number ≥ 0, m). Default: 10.
        inversion_width: half the thickness of the layer between (number > 0, m). Default: 1.
        strength: makes all bending stronger than it is (number ≥ 0). Default: 1.
        dispersion: whether colours part as they do in air (on or off). Default: on.
        noise: how much Perlin noise adds to the index (number ≥ 0). Default: 0.
        noise_frequency: how fine the noise is along each axis (x y z, 1/length). Default: 1 1
            1.
        noise_origin: where the noise has its origin; keys of an animation make it drift (x y
            z). Default: 0 0 0.
        octaves: how many noises are added up (whole number from 1 to 16). Default: 3.
        integrator: how light is followed from step to step (adaptive, euler or rungeKutta).
            Default: adaptive.
        steps: of the fixed integrators, for the diagonal of the body (whole number from 1 to
            1000000). Default: 1000.
    """

    keyword = "AirLayers"

    def __init__(
        self, *children: Item, name: str | None = None,
        up: Vector | None = None,
        ground: Number | None = None,
        meter: Number | None = None,
        temperature: Number | None = None,
        rise: Number | None = None,
        depth: Number | None = None,
        inversion: Number | None = None,
        inversion_height: Number | None = None,
        inversion_width: Number | None = None,
        strength: Number | None = None,
        dispersion: bool | None = None,
        noise: Number | None = None,
        noise_frequency: Vector | None = None,
        noise_origin: Vector | None = None,
        octaves: int | None = None,
        integrator: Literal["adaptive", "euler", "rungeKutta"] | None = None,
        steps: int | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.up = up
        self.ground = ground
        self.meter = meter
        self.temperature = temperature
        self.rise = rise
        self.depth = depth
        self.inversion = inversion
        self.inversion_height = inversion_height
        self.inversion_width = inversion_width
        self.strength = strength
        self.dispersion = dispersion
        self.noise = noise
        self.noise_frequency = noise_frequency
        self.noise_origin = noise_origin
        self.octaves = octaves
        self.integrator = integrator
        self.steps = steps


class BlackHole(MediumBlock):
    """The curved space around a black hole.

    Args:
        center: its middle (x y z). Default: 0 0 0.
        mass: half the radius of its horizon, were it not to spin (number > 0, length). Default:
            1.
        spin: angular momentum over the square of the mass (number from -1 to 1). Default: 0.
        axis: what it spins about, right-handed (x y z). Default: 0 1 0.
        observer: how a camera moves that is in its space (againstSpin, falls, orbits or rests).
            Default: rests.
    """

    keyword = "BlackHole"

    def __init__(
        self, *children: Item, name: str | None = None,
        center: Vector | None = None,
        mass: Number | None = None,
        spin: Number | None = None,
        axis: Vector | None = None,
        observer: Literal["againstSpin", "falls", "orbits", "rests"] | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.center = center
        self.mass = mass
        self.spin = spin
        self.axis = axis
        self.observer = observer


class Wormhole(MediumBlock):
    """The curved space of two mouths that are one throat.

    Args:
        mouth: the middle of one mouth (x y z).
        other: the middle of the other one (x y z).
        radius: of the ball around each mouth in which space is curved (number > 0, length).
        throat: radius of its narrowest place (number > 0, length).
        length: how long it is as narrow as that (number ≥ 0, length). Default: 0.
        width: how gently it widens, as the mass of a black hole would; 0 for that of Ellis
            (number ≥ 0, length). Default: 0.
        into: light that goes into the one mouth like this... (x y z). Default: 0 0 -1.
        out: ...comes out of the other like that (x y z). Default: 0 0 -1.
        up: what is up on both sides (x y z). Default: 0 1 0.
    """

    keyword = "Wormhole"

    def __init__(
        self, *children: Item, name: str | None = None,
        mouth: Vector,
        other: Vector,
        radius: Number,
        throat: Number,
        length: Number | None = None,
        width: Number | None = None,
        into: Vector | None = None,
        out: Vector | None = None,
        up: Vector | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.mouth = mouth
        self.other = other
        self.radius = radius
        self.throat = throat
        self.length = length
        self.width = width
        self.into = into
        self.out = out
        self.up = up
