"""Shapes that a few numbers tell: written by `cargo xtask tables`, not by hand."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from .._items import (
    Item,
    ObjectBlock,
)

if TYPE_CHECKING:
    from .._items import (
        MaterialName,
        Number,
        Vector,
    )


class Sphere(ObjectBlock):
    """A ball.

    Args:
        center: its middle (x y z).
        radius: its radius (number, length).
    """

    keyword = "Sphere"

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        center: Vector,
        radius: Number,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.center = center
        self.radius = radius


class Box(ObjectBlock):
    """A box with faces parallel to the axes.

    Args:
        min: the corner with the smallest coordinates (x y z).
        max: the corner with the largest coordinates (x y z).
    """

    keyword = "Box"

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        min: Vector,
        max: Vector,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.min = min
        self.max = max


class Plane(ObjectBlock):
    """A plane without bounds.

    Args:
        normal: at right angles to it (x y z).
        offset: distance from the origin along the normal (number, length).
    """

    keyword = "Plane"

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        normal: Vector,
        offset: Number,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.normal = normal
        self.offset = offset


class Cylinder(ObjectBlock):
    """A cylinder, with or without caps.

    Args:
        base: middle of one end (x y z).
        top: middle of the other end (x y z).
        radius: its radius (number, length).
        capped: closed by disks at its ends (on or off). Default: on.
    """

    keyword = "Cylinder"

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        base: Vector,
        top: Vector,
        radius: Number,
        capped: bool | None = None,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.base = base
        self.top = top
        self.radius = radius
        self.capped = capped


class Cone(ObjectBlock):
    """A cone, pointed or cut off, with or without caps.

    Args:
        base: middle of the base (x y z).
        top: the tip, or the middle of the other end (x y z).
        radius: radius of the base (number, length).
        top_radius: radius at the top (number, length). Default: 0.
        capped: closed by disks at its ends (on or off). Default: on.
    """

    keyword = "Cone"

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        base: Vector,
        top: Vector,
        radius: Number,
        top_radius: Number | None = None,
        capped: bool | None = None,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.base = base
        self.top = top
        self.radius = radius
        self.top_radius = top_radius
        self.capped = capped


class Torus(ObjectBlock):
    """A ring with a round tube.

    Args:
        center: its middle (x y z). Default: 0 0 0.
        axis: through its hole (x y z). Default: 0 1 0.
        major_radius: from its middle to that of the tube (number > 0, length).
        minor_radius: radius of the tube (number > 0, length).
    """

    keyword = "Torus"

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        center: Vector | None = None,
        axis: Vector | None = None,
        major_radius: Number,
        minor_radius: Number,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.center = center
        self.axis = axis
        self.major_radius = major_radius
        self.minor_radius = minor_radius


class Superellipsoid(ObjectBlock):
    """Between a box, a ball and an octahedron.

    Args:
        center: its middle (x y z). Default: 0 0 0.
        radius: from the middle to each face of the box around it (number > 0, length).
        east: exponent around the y axis: square near 0, round at 1, a diamond at 2 (number from
            0.01 to 2). Default: 1.
        north: exponent from pole to pole, likewise (number from 0.01 to 2). Default: 1.
    """

    keyword = "Superellipsoid"

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        center: Vector | None = None,
        radius: Number,
        east: Number | None = None,
        north: Number | None = None,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.center = center
        self.radius = radius
        self.east = east
        self.north = north


class Blob(ObjectBlock):
    """Balls, cylinders and half spaces that flow into each other.

    Args:
        threshold: value of the field at the surface (number > 0). Default: 0.5.
        kernel: how strength falls off with the distance (gaussian, wyvill or povray). Default:
            gaussian.
    """

    keyword = "Blob"

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        threshold: Number | None = None,
        kernel: Literal["gaussian", "wyvill", "povray"] | None = None,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.threshold = threshold
        self.kernel = kernel


class Quadric(ObjectBlock):
    """Where a polynomial of degree 2 is zero, in a box.

    Args:
        coefficients: of the powers of x, y and z, in their order (10 numbers).
        min: the corner of its box with the smallest coordinates (x y z). Default: -1 -1 -1.
        max: the corner of its box with the largest coordinates (x y z). Default: 1 1 1.
        closed: whether faces of the box close it where they cut it (on or off). Default: on.
    """

    keyword = "Quadric"

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        coefficients: Number | Vector,
        min: Vector | None = None,
        max: Vector | None = None,
        closed: bool | None = None,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.coefficients = coefficients
        self.min = min
        self.max = max
        self.closed = closed


class Cubic(ObjectBlock):
    """Where a polynomial of degree 3 is zero, in a box.

    Args:
        coefficients: of the powers of x, y and z, in their order (20 numbers).
        min: the corner of its box with the smallest coordinates (x y z). Default: -1 -1 -1.
        max: the corner of its box with the largest coordinates (x y z). Default: 1 1 1.
        closed: whether faces of the box close it where they cut it (on or off). Default: on.
    """

    keyword = "Cubic"

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        coefficients: Number | Vector,
        min: Vector | None = None,
        max: Vector | None = None,
        closed: bool | None = None,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.coefficients = coefficients
        self.min = min
        self.max = max
        self.closed = closed


class Quartic(ObjectBlock):
    """Where a polynomial of degree 4 is zero, in a box.

    Args:
        coefficients: of the powers of x, y and z, in their order (35 numbers).
        min: the corner of its box with the smallest coordinates (x y z). Default: -1 -1 -1.
        max: the corner of its box with the largest coordinates (x y z). Default: 1 1 1.
        closed: whether faces of the box close it where they cut it (on or off). Default: on.
    """

    keyword = "Quartic"

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        coefficients: Number | Vector,
        min: Vector | None = None,
        max: Vector | None = None,
        closed: bool | None = None,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.coefficients = coefficients
        self.min = min
        self.max = max
        self.closed = closed


class Polynomial(ObjectBlock):
    """Where a polynomial of any degree is zero, in a box.

    Args:
        terms: for each term a coefficient and the powers of x, y and z (numbers in groups of 4:
            any, from 0 to 100, from 0 to 100, from 0 to 100).
        min: the corner of its box with the smallest coordinates (x y z). Default: -1 -1 -1.
        max: the corner of its box with the largest coordinates (x y z). Default: 1 1 1.
        closed: whether faces of the box close it where they cut it (on or off). Default: on.
    """

    keyword = "Polynomial"

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        terms: Number | Vector,
        min: Vector | None = None,
        max: Vector | None = None,
        closed: bool | None = None,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.terms = terms
        self.min = min
        self.max = max
        self.closed = closed


class Disk(ObjectBlock):
    """A flat disk or ring.

    Args:
        center: its middle (x y z).
        normal: at right angles to it (x y z).
        radius: its radius (number, length).
        inner_radius: radius of the hole (number, length). Default: 0.
    """

    keyword = "Disk"

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        center: Vector,
        normal: Vector,
        radius: Number,
        inner_radius: Number | None = None,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.center = center
        self.normal = normal
        self.radius = radius
        self.inner_radius = inner_radius


class Quad(ObjectBlock):
    """A parallelogram.

    Args:
        corner: one corner (x y z).
        edge1: from there to the next corner (x y z).
        edge2: from there to the last corner (x y z).
    """

    keyword = "Quad"

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        corner: Vector,
        edge1: Vector,
        edge2: Vector,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.corner = corner
        self.edge1 = edge1
        self.edge2 = edge2


class Triangle(ObjectBlock):
    """One triangle.

    Args:
        vertex0: first corner (x y z).
        vertex1: second corner (x y z).
        vertex2: third corner (x y z).
        text_coord0: texture coordinates of the first corner (2 numbers). Default: 0 0.
        text_coord1: texture coordinates of the second corner (2 numbers). Default: 1 0.
        text_coord2: texture coordinates of the third corner (2 numbers). Default: 0 1.
    """

    keyword = "Triangle"

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        vertex0: Vector,
        vertex1: Vector,
        vertex2: Vector,
        text_coord0: Number | Vector | None = None,
        text_coord1: Number | Vector | None = None,
        text_coord2: Number | Vector | None = None,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.vertex0 = vertex0
        self.vertex1 = vertex1
        self.vertex2 = vertex2
        self.text_coord0 = text_coord0
        self.text_coord1 = text_coord1
        self.text_coord2 = text_coord2


class BilinearPatch(ObjectBlock):
    """The surface of straight lines between four corners.

    Args:
        vertex0: first corner, (u, v) = (0, 0) (x y z).
        vertex1: next corner around it, (1, 0) (x y z).
        vertex2: the one opposite the first, (1, 1) (x y z).
        vertex3: last corner, (0, 1) (x y z).
    """

    keyword = "BilinearPatch"

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        vertex0: Vector,
        vertex1: Vector,
        vertex2: Vector,
        vertex3: Vector,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.vertex0 = vertex0
        self.vertex1 = vertex1
        self.vertex2 = vertex2
        self.vertex3 = vertex3


class BicubicPatch(ObjectBlock):
    """A Bézier patch of sixteen control points.

    Args:
        row0: four control points, from (u, v) = (0, 0) to (1, 0) (12 numbers).
        row1: the next four (12 numbers).
        row2: the next four (12 numbers).
        row3: the last four, from (0, 1) to (1, 1) (12 numbers).
    """

    keyword = "BicubicPatch"

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        row0: Number | Vector,
        row1: Number | Vector,
        row2: Number | Vector,
        row3: Number | Vector,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.row0 = row0
        self.row1 = row1
        self.row2 = row2
        self.row3 = row3
