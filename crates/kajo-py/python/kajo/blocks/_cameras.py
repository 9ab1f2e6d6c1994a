"""Cameras: written by `cargo xtask tables`, not by hand."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from .._items import (
    CameraBlock,
    Item,
)

if TYPE_CHECKING:
    from .._items import (
        File,
        Number,
        Vector,
    )


class PerspectiveCamera(CameraBlock):
    """Rays from one point, or from a lens, spread over an angle.

    Args:
        center: where it is (x y z). Default: none.
        direction: where it looks (x y z). Default: none.
        target: the point it looks at, or the name of an object (x y z). Default: none.
        look_at: where it is, the point it looks at, and what is up (9 numbers). Default: none.
        up: which way is up in the picture (x y z). Default: none.
        fit: what fills the picture: scene, or the name of an object; then perhaps a margin, 0
            to 0.45 of the picture (word or text). Default: none.
        shutter: from when to when light is gathered; in an animation in frames (2 numbers).
            Default: 0 1; 0 0.5 in an animation.
        rolling_shutter: the share of that time in which rows open one after the other (number
            from 0 to 1). Default: 0.
        velocity: how it moves, as a fraction of the speed of light (3 numbers). Default: 0 0 0.
        world_time: moment of the picture for what moves in `Lorentz`, in lengths that light
            goes (number). Default: 0.
        angle: field of view from bottom to top (degrees). Default: none.
        width: columns of the picture, if nothing else says them (whole number from 1 to
            16777216, pixels). Default: none.
        height: rows of the picture, if nothing else says them (whole number from 1 to 16777216,
            pixels). Default: none.
        aperture: diameter of the lens's opening (number ≥ 0, length). Default: 0.
        focus: distance of what is sharp; or a point, or the name of an object (number > 0,
            length). Default: all is sharp.
        f_number: focal length over diameter (number > 0). Default: none.
        focal_length: of the lens (number > 0, length). Default: none.
        blades: the opening is a polygon (whole number from 3 to 64). Default: round.
        blade_rotation: turns the polygon (degrees). Default: 0.
        bokeh: a picture of the opening (file). Default: none.
    """

    keyword = "PerspectiveCamera"

    def __init__(
        self, *children: Item, name: str | None = None,
        center: Vector | None = None,
        direction: Vector | None = None,
        target: Vector | str | None = None,
        look_at: Number | Vector | None = None,
        up: Vector | None = None,
        fit: str | None = None,
        shutter: Number | Vector | None = None,
        rolling_shutter: Number | None = None,
        velocity: Number | Vector | None = None,
        world_time: Number | None = None,
        angle: Number | None = None,
        width: int | None = None,
        height: int | None = None,
        aperture: Number | None = None,
        focus: Number | None = None,
        f_number: Number | None = None,
        focal_length: Number | None = None,
        blades: int | None = None,
        blade_rotation: Number | None = None,
        bokeh: File | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.center = center
        self.direction = direction
        self.target = target
        self.look_at = look_at
        self.up = up
        self.fit = fit
        self.shutter = shutter
        self.rolling_shutter = rolling_shutter
        self.velocity = velocity
        self.world_time = world_time
        self.angle = angle
        self.width = width
        self.height = height
        self.aperture = aperture
        self.focus = focus
        self.f_number = f_number
        self.focal_length = focal_length
        self.blades = blades
        self.blade_rotation = blade_rotation
        self.bokeh = bokeh


class OrthographicCamera(CameraBlock):
    """Parallel rays, as of a plan.

    Args:
        center: where it is (x y z). Default: none.
        direction: where it looks (x y z). Default: none.
        target: the point it looks at, or the name of an object (x y z). Default: none.
        look_at: where it is, the point it looks at, and what is up (9 numbers). Default: none.
        up: which way is up in the picture (x y z). Default: none.
        fit: what fills the picture: scene, or the name of an object; then perhaps a margin, 0
            to 0.45 of the picture (word or text). Default: none.
        shutter: from when to when light is gathered; in an animation in frames (2 numbers).
            Default: 0 1; 0 0.5 in an animation.
        rolling_shutter: the share of that time in which rows open one after the other (number
            from 0 to 1). Default: 0.
        velocity: how it moves, as a fraction of the speed of light (3 numbers). Default: 0 0 0.
        world_time: moment of the picture for what moves in `Lorentz`, in lengths that light
            goes (number). Default: 0.
        size: height of the picture in the world (number, length). Default: none.
        aperture: diameter of the lens's opening (number ≥ 0, length). Default: 0.
        focus: distance of what is sharp; or a point, or the name of an object (number > 0,
            length). Default: all is sharp.
        f_number: focal length over diameter (number > 0). Default: none.
        focal_length: of the lens (number > 0, length). Default: none.
        blades: the opening is a polygon (whole number from 3 to 64). Default: round.
        blade_rotation: turns the polygon (degrees). Default: 0.
        bokeh: a picture of the opening (file). Default: none.
    """

    keyword = "OrthographicCamera"

    def __init__(
        self, *children: Item, name: str | None = None,
        center: Vector | None = None,
        direction: Vector | None = None,
        target: Vector | str | None = None,
        look_at: Number | Vector | None = None,
        up: Vector | None = None,
        fit: str | None = None,
        shutter: Number | Vector | None = None,
        rolling_shutter: Number | None = None,
        velocity: Number | Vector | None = None,
        world_time: Number | None = None,
        size: Number | None = None,
        aperture: Number | None = None,
        focus: Number | None = None,
        f_number: Number | None = None,
        focal_length: Number | None = None,
        blades: int | None = None,
        blade_rotation: Number | None = None,
        bokeh: File | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.center = center
        self.direction = direction
        self.target = target
        self.look_at = look_at
        self.up = up
        self.fit = fit
        self.shutter = shutter
        self.rolling_shutter = rolling_shutter
        self.velocity = velocity
        self.world_time = world_time
        self.size = size
        self.aperture = aperture
        self.focus = focus
        self.f_number = f_number
        self.focal_length = focal_length
        self.blades = blades
        self.blade_rotation = blade_rotation
        self.bokeh = bokeh


class FisheyeCamera(CameraBlock):
    """Half of all directions or more, as a disk.

    Args:
        center: where it is (x y z). Default: none.
        direction: where it looks (x y z). Default: none.
        target: the point it looks at, or the name of an object (x y z). Default: none.
        look_at: where it is, the point it looks at, and what is up (9 numbers). Default: none.
        up: which way is up in the picture (x y z). Default: none.
        shutter: from when to when light is gathered; in an animation in frames (2 numbers).
            Default: 0 1; 0 0.5 in an animation.
        rolling_shutter: the share of that time in which rows open one after the other (number
            from 0 to 1). Default: 0.
        velocity: how it moves, as a fraction of the speed of light (3 numbers). Default: 0 0 0.
        world_time: moment of the picture for what moves in `Lorentz`, in lengths that light
            goes (number). Default: 0.
        angle: width of the disk (degrees from 0.001 to 360). Default: 180.
        projection: how angles become distances (equidistant, equisolid, orthographic or
            stereographic). Default: equidistant.
        fit: what the disk fills, or what fills the picture (corners or height). Default:
            height.
    """

    keyword = "FisheyeCamera"

    def __init__(
        self, *children: Item, name: str | None = None,
        center: Vector | None = None,
        direction: Vector | None = None,
        target: Vector | str | None = None,
        look_at: Number | Vector | None = None,
        up: Vector | None = None,
        shutter: Number | Vector | None = None,
        rolling_shutter: Number | None = None,
        velocity: Number | Vector | None = None,
        world_time: Number | None = None,
        angle: Number | None = None,
        projection: Literal["equidistant", "equisolid", "orthographic", "stereographic"] | None = None,
        fit: Literal["corners", "height"] | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.center = center
        self.direction = direction
        self.target = target
        self.look_at = look_at
        self.up = up
        self.shutter = shutter
        self.rolling_shutter = rolling_shutter
        self.velocity = velocity
        self.world_time = world_time
        self.angle = angle
        self.projection = projection
        self.fit = fit


class PanoramaCamera(CameraBlock):
    """All directions, as longitude and latitude, for one eye or two.

    Args:
        center: where it is (x y z). Default: none.
        direction: where it looks (x y z). Default: none.
        target: the point it looks at, or the name of an object (x y z). Default: none.
        look_at: where it is, the point it looks at, and what is up (9 numbers). Default: none.
        up: which way is up in the picture (x y z). Default: none.
        fit: what fills the picture: scene, or the name of an object; then perhaps a margin, 0
            to 0.45 of the picture (word or text). Default: none.
        shutter: from when to when light is gathered; in an animation in frames (2 numbers).
            Default: 0 1; 0 0.5 in an animation.
        rolling_shutter: the share of that time in which rows open one after the other (number
            from 0 to 1). Default: 0.
        velocity: how it moves, as a fraction of the speed of light (3 numbers). Default: 0 0 0.
        world_time: moment of the picture for what moves in `Lorentz`, in lengths that light
            goes (number). Default: 0.
        eye_separation: distance between the eyes (number ≥ 0, length). Default: 0.065.
        stereo: one eye or two (none or omnidirectional). Default: none.
    """

    keyword = "PanoramaCamera"

    def __init__(
        self, *children: Item, name: str | None = None,
        center: Vector | None = None,
        direction: Vector | None = None,
        target: Vector | str | None = None,
        look_at: Number | Vector | None = None,
        up: Vector | None = None,
        fit: str | None = None,
        shutter: Number | Vector | None = None,
        rolling_shutter: Number | None = None,
        velocity: Number | Vector | None = None,
        world_time: Number | None = None,
        eye_separation: Number | None = None,
        stereo: Literal["none", "omnidirectional"] | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.center = center
        self.direction = direction
        self.target = target
        self.look_at = look_at
        self.up = up
        self.fit = fit
        self.shutter = shutter
        self.rolling_shutter = rolling_shutter
        self.velocity = velocity
        self.world_time = world_time
        self.eye_separation = eye_separation
        self.stereo = stereo


class StereoCubemapCamera(CameraBlock):
    """All directions, as twelve squares for two eyes.

    Args:
        center: where it is (x y z). Default: none.
        direction: where it looks (x y z). Default: none.
        target: the point it looks at, or the name of an object (x y z). Default: none.
        look_at: where it is, the point it looks at, and what is up (9 numbers). Default: none.
        up: which way is up in the picture (x y z). Default: none.
        fit: what fills the picture: scene, or the name of an object; then perhaps a margin, 0
            to 0.45 of the picture (word or text). Default: none.
        shutter: from when to when light is gathered; in an animation in frames (2 numbers).
            Default: 0 1; 0 0.5 in an animation.
        rolling_shutter: the share of that time in which rows open one after the other (number
            from 0 to 1). Default: 0.
        velocity: how it moves, as a fraction of the speed of light (3 numbers). Default: 0 0 0.
        world_time: moment of the picture for what moves in `Lorentz`, in lengths that light
            goes (number). Default: 0.
        eye_separation: distance between the eyes (number ≥ 0, length). Default: 0.065.
        stereo: how eyes turn (twin or omnidirectional). Default: twin.
    """

    keyword = "StereoCubemapCamera"

    def __init__(
        self, *children: Item, name: str | None = None,
        center: Vector | None = None,
        direction: Vector | None = None,
        target: Vector | str | None = None,
        look_at: Number | Vector | None = None,
        up: Vector | None = None,
        fit: str | None = None,
        shutter: Number | Vector | None = None,
        rolling_shutter: Number | None = None,
        velocity: Number | Vector | None = None,
        world_time: Number | None = None,
        eye_separation: Number | None = None,
        stereo: Literal["twin", "omnidirectional"] | None = None,
    ) -> None:
        super().__init__(*children, name=name)
        self.center = center
        self.direction = direction
        self.target = target
        self.look_at = look_at
        self.up = up
        self.fit = fit
        self.shutter = shutter
        self.rolling_shutter = rolling_shutter
        self.velocity = velocity
        self.world_time = world_time
        self.eye_separation = eye_separation
        self.stereo = stereo
