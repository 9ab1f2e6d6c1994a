"""Settings, surroundings, lists and parts of blocks: written by `cargo xtask tables`, not by hand."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar, Literal

from .._items import (
    Block,
    Item,
    PartBlock,
)

if TYPE_CHECKING:
    from .._items import (
        Emission,
        File,
        MaterialName,
        MediumName,
        Number,
        Vector,
    )


class SpherePart(PartBlock):
    """A component of a blob around a point.

    Args:
        center: its middle (x y z).
        radius: of its kernel (number > 0, length).
        strength: value of its field in the middle (number). Default: 1.
        material: what it is made of, where it is not like the rest (name or number). Default:
            that of the blob.
    """

    keyword = "sphere"

    def __init__(
        self, *children: Item, name: str | None = None,
        center: Vector,
        radius: Number,
        strength: Number | None = None,
        material: MaterialName | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.center = center
        self.radius = radius
        self.strength = strength
        self.material = material


class CylinderPart(PartBlock):
    """A component of a blob around a line.

    Args:
        base: one end of its axis (x y z).
        top: the other end (x y z).
        radius: of its kernel (number > 0, length).
        strength: value of its field on the axis (number). Default: 1.
        material: what it is made of, where it is not like the rest (name or number). Default:
            that of the blob.
    """

    keyword = "cylinder"

    def __init__(
        self, *children: Item, name: str | None = None,
        base: Vector,
        top: Vector,
        radius: Number,
        strength: Number | None = None,
        material: MaterialName | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.base = base
        self.top = top
        self.radius = radius
        self.strength = strength
        self.material = material


class PlanePart(PartBlock):
    """A component of a blob that fills the half space behind a plane.

    Args:
        point: a point of it (x y z).
        normal: at right angles to it, away from what is filled (x y z).
        radius: of its kernel, outwards (number > 0, length).
        strength: value of its field behind it (number). Default: 1.
        material: what it is made of, where it is not like the rest (name or number). Default:
            that of the blob.
    """

    keyword = "plane"

    def __init__(
        self, *children: Item, name: str | None = None,
        point: Vector,
        normal: Vector,
        radius: Number,
        strength: Number | None = None,
        material: MaterialName | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.point = point
        self.normal = normal
        self.radius = radius
        self.strength = strength
        self.material = material


class Outline(PartBlock):
    """A closed path around a prism."""

    keyword = "outline"


class Profile(PartBlock):
    """A path that a lathe turns."""

    keyword = "profile"


class Path(PartBlock):
    """A path of the balls of a sweep."""

    keyword = "path"


class Strand(PartBlock):
    """One of many curves, by its points.

    Args:
        points: where it goes (numbers in groups of 3).
        radii: half its width: one number, or one for each point (numbers ≥ 0, length). Default:
            `radius` of all.
    """

    keyword = "strand"

    def __init__(
        self, *children: Item, name: str | None = None,
        points: Number | Vector,
        radii: Number | Vector | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.points = points
        self.radii = radii


class Settings(Block):
    """How the scene is to be rendered.

    Args:
        size: columns and rows of the picture (2 whole numbers from 1 to 16777216, pixels).
            Default: 800 600.
        integrator: how light is followed (auto, bidirectional, classic, direct, distribution,
            irradiance, light, mlt, mmlt, occlusion, path, photon, sppm or vcm). Default: classic.
        samples: rays of each pixel (bluenoise, cmj, jittered, pmj, poisson, regular, sobol,
            uniform or zsobol; then a whole number from 1 to 1048576). Default: by the integrator.
        bounces: surfaces that light is followed over (whole number from 0 to 1000). Default: by
            the integrator.
        shadows: what casts them (off, on or transparent). Default: on.
        transparent_shadows: how glass weakens light (length or surface). Default: by the
            dialect.
        shade_back: light reaches back sides (on or off). Default: off.
        fresnel: reflection grows towards grazing angles (on or off). Default: off.
        total_reflection: light that cannot leave is reflected (on or off). Default: off.
        weight: rays that count for less are not followed (number ≥ 0). Default: 0.
        filter: how samples become pixels (box, gaussian, lanczos, mitchell, none or tent; then
            a number from 0.001 to 64). Default: none.
        texture_filter: how pictures are filtered that do not say it themselves (bilinear,
            nearest, bicubic, trilinear, sat, ewa, feline or stochastic). Default: bilinear.
        seed: of the random numbers (whole number from 0 to 9007199254740992). Default: 0.
        spectral: with wavelengths in place of red, green and blue (on or off). Default: off.
        branches: rays from one surface (whole number from 1 to 65536). Default: by the
            integrator.
        directions: how directions are drawn (cosine, scattering or uniform). Default:
            scattering.
        technique: how light is found (combined, lights or scattering). Default: combined.
        light_choice: how a light is drawn (tree, uniform or learned). Default: tree.
        caustics: how light through smooth glass is found (manifold or scattering). Default:
            scattering.
        roulette: faint paths end by chance (on or off). Default: by the integrator.
        guiding: directions by where light has come from (on or off). Default: off.
        training: samples of each pixel by which a guide learns (whole number from 1 to 65536).
            Default: a quarter of `samples`.
        photons: paths from lights for a photon map (whole number from 1 to 100000000). Default:
            by the integrator.
        photon_map: what the photon map is used for (caustics, direct, dots or gather). Default:
            gather.
        merging: merges paths from lights with those from the camera (on or off). Default: on.
        merge_radius: radius of the first disks in which paths are merged (number ≥ 0, length).
            Default: by the picture.
        merge_alpha: how slowly these disks shrink from sample to sample (number from 0 to 1).
            Default: 0.75.
        accuracy: error that a record of irradiance may make, as a share (number > 0). Default:
            0.1.
        rays: rays for a record of irradiance (whole number from 16 to 1048576). Default: 2048.
        gradients: what is known around a record of irradiance (occlusion, off or strata).
            Default: occlusion.
        show_records: the irradiance and its records in place of the picture (on or off).
            Default: off.
        clamp: the most that a sample brings of light that was scattered (number ≥ 0). Default:
            0.
        reach: distance beyond which nothing occludes (number > 0, length). Default: any
            distance.
        ray_offset: how close to a surface rays start (auto or reference). Default: auto.
        depth_range: distances that are white and black (2 numbers, length). Default: by the
            picture.
        exposure: factors of two by which the picture is made brighter (number from -100 to 100,
            stops). Default: 0.
        tone: curve from light to pixels (linear, srgb, aces or agx). Default: by the
            integrator.
        white_balance: kelvin and tint of the light that is to look white (2 numbers: from 1000
            to 25000, from -150 to 150, K). Default: as it is.
        dialect: conventions of the file (handout, mit-2004 or mit-a2). Default: handout.
    """

    keyword = "Settings"

    def __init__(
        self, *children: Item, name: str | None = None,
        size: int | Sequence[int] | None = None,
        integrator: Literal["auto", "bidirectional", "classic", "direct", "distribution", "irradiance", "light", "mlt", "mmlt", "occlusion", "path", "photon", "sppm", "vcm"] | None = None,
        samples: Literal["bluenoise", "cmj", "jittered", "pmj", "poisson", "regular", "sobol", "uniform", "zsobol"] | tuple[Literal["bluenoise", "cmj", "jittered", "pmj", "poisson", "regular", "sobol", "uniform", "zsobol"], int] | None = None,
        bounces: int | None = None,
        shadows: Literal["off", "on", "transparent"] | None = None,
        transparent_shadows: Literal["length", "surface"] | None = None,
        shade_back: bool | None = None,
        fresnel: bool | None = None,
        total_reflection: bool | None = None,
        weight: Number | None = None,
        filter: Literal["box", "gaussian", "lanczos", "mitchell", "none", "tent"] | tuple[Literal["box", "gaussian", "lanczos", "mitchell", "none", "tent"], Number] | None = None,
        texture_filter: Literal["bilinear", "nearest", "bicubic", "trilinear", "sat", "ewa", "feline", "stochastic"] | None = None,
        seed: int | None = None,
        spectral: bool | None = None,
        branches: int | None = None,
        directions: Literal["cosine", "scattering", "uniform"] | None = None,
        technique: Literal["combined", "lights", "scattering"] | None = None,
        light_choice: Literal["tree", "uniform", "learned"] | None = None,
        caustics: Literal["manifold", "scattering"] | None = None,
        roulette: bool | None = None,
        guiding: bool | None = None,
        training: int | None = None,
        photons: int | None = None,
        photon_map: Literal["caustics", "direct", "dots", "gather"] | None = None,
        merging: bool | None = None,
        merge_radius: Number | None = None,
        merge_alpha: Number | None = None,
        accuracy: Number | None = None,
        rays: int | None = None,
        gradients: Literal["occlusion", "off", "strata"] | None = None,
        show_records: bool | None = None,
        clamp: Number | None = None,
        reach: Number | None = None,
        ray_offset: Literal["auto", "reference"] | None = None,
        depth_range: Number | Vector | None = None,
        exposure: Number | None = None,
        tone: Literal["linear", "srgb", "aces", "agx"] | None = None,
        white_balance: Number | Vector | None = None,
        dialect: Literal["handout", "mit-2004", "mit-a2"] | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.size = size
        self.integrator = integrator
        self.samples = samples
        self.bounces = bounces
        self.shadows = shadows
        self.transparent_shadows = transparent_shadows
        self.shade_back = shade_back
        self.fresnel = fresnel
        self.total_reflection = total_reflection
        self.weight = weight
        self.filter = filter
        self.texture_filter = texture_filter
        self.seed = seed
        self.spectral = spectral
        self.branches = branches
        self.directions = directions
        self.technique = technique
        self.light_choice = light_choice
        self.caustics = caustics
        self.roulette = roulette
        self.guiding = guiding
        self.training = training
        self.photons = photons
        self.photon_map = photon_map
        self.merging = merging
        self.merge_radius = merge_radius
        self.merge_alpha = merge_alpha
        self.accuracy = accuracy
        self.rays = rays
        self.gradients = gradients
        self.show_records = show_records
        self.clamp = clamp
        self.reach = reach
        self.ray_offset = ray_offset
        self.depth_range = depth_range
        self.exposure = exposure
        self.tone = tone
        self.white_balance = white_balance
        self.dialect = dialect


class Animation(Block):
    """The frames of a scene that changes with time.

    Args:
        fps: frames of a second (number > 0, 1/s). Default: 24.
        frames: the first frame, which is at time 0, and the last one (2 whole numbers from 0 to
            1000000000). Default: from 1 on.
    """

    keyword = "Animation"

    def __init__(
        self, *children: Item, name: str | None = None,
        fps: Number | None = None,
        frames: int | Sequence[int] | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.fps = fps
        self.frames = frames


class Background(Block):
    """What rays see that hit nothing.

    Args:
        color: what rays see that hit nothing (r g b, or another light value). Default: 0.5 0.5
            0.5.
        ambient_light: light from everywhere, of the classic integrator (r g b). Default: 0 0 0.
        environment: a picture of longitude and latitude (file). Default: none.
        rotate: turns the picture (degrees). Default: 0.
        scale: makes the picture brighter (number ≥ 0). Default: 1.
        cube_map: a folder of six pictures (file). Default: none.
        group: name of the lights it is seen among (word or text). Default: none.
    """

    keyword = "Background"

    def __init__(
        self, *children: Item, name: str | None = None,
        color: Emission | None = None,
        ambient_light: Vector | None = None,
        environment: File | None = None,
        rotate: Number | None = None,
        scale: Number | None = None,
        cube_map: File | None = None,
        group: str | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.color = color
        self.ambient_light = ambient_light
        self.environment = environment
        self.rotate = rotate
        self.scale = scale
        self.cube_map = cube_map
        self.group = group


class Sky(PartBlock):
    """A clear sky with its sun, within a `Background`.

    Args:
        turbidity: haze (number from 2 to 10). Default: 3.
        elevation: of the sun over the horizon (degrees from 0 to 90). Default: 45.
        azimuth: of the sun (degrees). Default: 135.
        ground: reflectance of the ground (number from 0 to 1). Default: 0.2.
        scale: makes it brighter (number ≥ 0). Default: 1.
        sun: with the sun itself (on or off). Default: on.
    """

    keyword = "sky"

    def __init__(
        self, *children: Item, name: str | None = None,
        turbidity: Number | None = None,
        elevation: Number | None = None,
        azimuth: Number | None = None,
        ground: Number | None = None,
        scale: Number | None = None,
        sun: bool | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.turbidity = turbidity
        self.elevation = elevation
        self.azimuth = azimuth
        self.ground = ground
        self.scale = scale
        self.sun = sun


class Stars(PartBlock):
    """Stars before whatever else a `Background` is.

    Args:
        count: how many are strewn over the sky (whole number from 1 to 10000000). Default:
            9000.
        seed: chooses one of many skies (whole number from 0 to 999999999). Default: 0.
        faintest: magnitude of the faintest ones that are strewn (number from -5 to 25).
            Default: 6.5.
        galaxy: the share of those that lies in a band around the sky (number from 0 to 1).
            Default: 0.4.
        pole: perpendicular to that band (x y z). Default: 0.5 1 0.25.
        catalog: a table in their place: right ascension, declination, magnitude, temperature
            (file). Default: none.
        radius: how large each is (degrees from 0.0001 to 5). Default: 0.04.
        pixel_radius: no star is seen smaller than that; 0 for stars of their own size (number
            from 0 to 8, pixels). Default: 1.5.
        scale: makes them brighter; 1 for lux (number ≥ 0). Default: 1.
    """

    keyword = "stars"

    def __init__(
        self, *children: Item, name: str | None = None,
        count: int | None = None,
        seed: int | None = None,
        faintest: Number | None = None,
        galaxy: Number | None = None,
        pole: Vector | None = None,
        catalog: File | None = None,
        radius: Number | None = None,
        pixel_radius: Number | None = None,
        scale: Number | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.count = count
        self.seed = seed
        self.faintest = faintest
        self.galaxy = galaxy
        self.pole = pole
        self.catalog = catalog
        self.radius = radius
        self.pixel_radius = pixel_radius
        self.scale = scale


class Fog(Block):
    """What fills the air, for the classic integrator.

    Args:
        color: its colour (r g b).
        density: how much hides what lies a unit away (number ≥ 0, 1/length).
        height_falloff: how fast it thins with height (number ≥ 0, 1/length). Default: 0.
        height: where the density is the one given (number, length). Default: 0.
    """

    keyword = "Fog"

    def __init__(
        self, *children: Item, name: str | None = None,
        color: Vector,
        density: Number,
        height_falloff: Number | None = None,
        height: Number | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.color = color
        self.density = density
        self.height_falloff = height_falloff
        self.height = height


class Lights(Block):
    """The lights of the scene.

    Args:
        num_lights: how many there are, which is checked (whole number ≥ 0). Default: as many as
            there are.
    """

    keyword = "Lights"

    def __init__(
        self, *children: Item, name: str | None = None,
        num_lights: int | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.num_lights = num_lights


class Materials(Block):
    """The materials of the scene.

    Args:
        num_materials: how many there are, which is checked (whole number ≥ 0). Default: as many
            as there are.
    """

    keyword = "Materials"

    def __init__(
        self, *children: Item, name: str | None = None,
        num_materials: int | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.num_materials = num_materials


class Textures(Block):
    """Textures that have names."""

    keyword = "Textures"


class Media(Block):
    """What bodies and the air are filled with.

    Args:
        exterior: name of the medium around everything (word or text). Default: empty space.
    """

    keyword = "Media"

    def __init__(
        self, *children: Item, name: str | None = None,
        exterior: MediumName | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.exterior = exterior


class Motion(PartBlock):
    """An operation that changes with time."""

    keyword = "Motion"


class Key(PartBlock):
    """The operations that hold at a moment."""

    keyword = "key"


class FollowPath(PartBlock):
    """An operation that brings things to a point of a path and turns them along it.

    Args:
        line: goes straight from point to point (numbers in groups of 3). Default: none.
        quadratic: quadratic Béziers by pairs of points: one each is drawn towards, and its end
            (numbers in groups of 3). Default: none.
        cubic: cubic Béziers by three points each: two it is drawn towards, and its end (numbers
            in groups of 3). Default: none.
        spline: goes smoothly through points (numbers in groups of 3). Default: none.
        progress: how far along the path, in parts of its length (number). Default: 0.
        forward: what of the thing points along the path (x y z). Default: 0 0 -1.
        up: what is up, of the thing and of the world (x y z). Default: 0 1 0.
        bank: how far the thing leans to its right, as into a curve (degrees). Default: 0.
        turn: whether the thing is turned at all (on or off). Default: on.
    """

    keyword = "FollowPath"
    several: ClassVar[tuple[str, ...]] = ("line","quadratic","cubic","spline",)

    def __init__(
        self, *children: Item, name: str | None = None,
        line: Sequence[Number | Vector] | None = None,
        quadratic: Sequence[Number | Vector] | None = None,
        cubic: Sequence[Number | Vector] | None = None,
        spline: Sequence[Number | Vector] | None = None,
        progress: Number | None = None,
        forward: Vector | None = None,
        up: Vector | None = None,
        bank: Number | None = None,
        turn: bool | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.line = line
        self.quadratic = quadratic
        self.cubic = cubic
        self.spline = spline
        self.progress = progress
        self.forward = forward
        self.up = up
        self.bank = bank
        self.turn = turn


class WorldLine(PartBlock):
    """Where a camera is that moves nearly as fast as light, by its own clock.

    Args:
        event: a moment of the world, and where the camera is then (4 numbers). Default: none.
        acceleration: what it feels all the time, from rest in its `center` on: speeds of light
            per time (x y z, 1/length). Default: none.
        proper_time: what its own clock shows, from the first event or from rest on (number).
            Default: 0.
    """

    keyword = "WorldLine"
    several: ClassVar[tuple[str, ...]] = ("event",)

    def __init__(
        self, *children: Item, name: str | None = None,
        event: Sequence[Number | Vector] | None = None,
        acceleration: Vector | None = None,
        proper_time: Number | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.event = event
        self.acceleration = acceleration
        self.proper_time = proper_time
