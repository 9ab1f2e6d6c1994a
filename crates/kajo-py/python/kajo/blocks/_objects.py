"""Other shapes, groups and operations of transforms: written by `cargo xtask tables`, not by hand."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar, Literal

from .._items import (
    Function,
    Item,
    ObjectBlock,
    Operation,
)

if TYPE_CHECKING:
    from .._items import (
        File,
        MaterialName,
        Number,
        Texture,
        Vector,
    )


class Isosurface(ObjectBlock):
    """The surface where a function is zero, in a box.

    Args:
        function: negative inside, zero at the surface (= function of x, y, z).
        min: the corner of its box with the smallest coordinates (x y z). Default: -1 -1 -1.
        max: the corner of its box with the largest coordinates (x y z). Default: 1 1 1.
        closed: whether faces of the box close it where they cut it (on or off). Default: on.
    """

    keyword = "Isosurface"
    functions: ClassVar[tuple[str, ...]] = ("function",)

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        function: Function | str | Number,
        min: Vector | None = None,
        max: Vector | None = None,
        closed: bool | None = None,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.function = function
        self.min = min
        self.max = max
        self.closed = closed


class DistanceGrid(ObjectBlock):
    """The surface through numbers on a grid, such as signed distances.

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
        level: what the surface is at; lower numbers are inside (number). Default: 0.
        closed: whether faces of the box close it where they cut it (on or off). Default: on.
        smooth: shaded by interpolated normals (on or off). Default: on.
    """

    keyword = "DistanceGrid"

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        file: File | None = None,
        grid: str | None = None,
        values: Number | Vector | None = None,
        size: int | Sequence[int] | None = None,
        encoding: Literal["f32", "u16", "u8"] | None = None,
        min: Vector | None = None,
        max: Vector | None = None,
        level: Number | None = None,
        closed: bool | None = None,
        smooth: bool | None = None,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.file = file
        self.grid = grid
        self.values = values
        self.size = size
        self.encoding = encoding
        self.min = min
        self.max = max
        self.level = level
        self.closed = closed
        self.smooth = smooth


class HeightField(ObjectBlock):
    """Terrain from a picture of heights, or a function.

    Args:
        file: picture of heights (file). Default: none.
        function: height by x and z, counted from `center`, in place of a picture (= function of
            x, y, z). Default: none.
        resolution: points along the longer side at which `function` is asked for (whole number
            from 2 to 32768). Default: 512.
        center: middle of the rectangle, at the height 0 (x y z). Default: 0 0 0.
        size: of the rectangle along x and z (2 numbers, length). Default: 1 1.
        heights: what 0 and 1 of the picture or function stand for (2 numbers, length). Default:
            0 1.
        base: height of the floor of a solid; what is lower is cut off (number, length).
            Default: a sheet.
        smooth: shaded by interpolated normals (on or off). Default: off.
    """

    keyword = "HeightField"
    functions: ClassVar[tuple[str, ...]] = ("function",)

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        file: File | None = None,
        function: Function | str | Number | None = None,
        resolution: int | None = None,
        center: Vector | None = None,
        size: Number | Vector | None = None,
        heights: Number | Vector | None = None,
        base: Number | None = None,
        smooth: bool | None = None,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.file = file
        self.function = function
        self.resolution = resolution
        self.center = center
        self.size = size
        self.heights = heights
        self.base = base
        self.smooth = smooth


class Prism(ObjectBlock):
    """An outline, drawn out across its plane.

    Args:
        origin: where `0 0` of the outline is (x y z). Default: 0 0 0.
        axis: from the near end to the far one (x y z). Default: 0 0 1.
        up: what is up in the outline (x y z). Default: y, or away from it along y.
        size: of one unit of the outline (number > 0, length). Default: 1.
        depth: from the near end to the far one (number > 0, length).
        taper: size of the far end, in parts of the near one (number ≥ 0). Default: 1.
        fill: what is inside where outlines cross (nonzero or evenodd). Default: nonzero.
        bevel: how far edges of both ends are taken off (number > 0, length). Default: sharp
            edges.
        bevel_profile: what edges look like from the side (chamfer or round). Default: chamfer.
    """

    keyword = "Prism"

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        origin: Vector | None = None,
        axis: Vector | None = None,
        up: Vector | None = None,
        size: Number | None = None,
        depth: Number,
        taper: Number | None = None,
        fill: Literal["nonzero", "evenodd"] | None = None,
        bevel: Number | None = None,
        bevel_profile: Literal["chamfer", "round"] | None = None,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.origin = origin
        self.axis = axis
        self.up = up
        self.size = size
        self.depth = depth
        self.taper = taper
        self.fill = fill
        self.bevel = bevel
        self.bevel_profile = bevel_profile


class Text(ObjectBlock):
    """Lettering in a font, drawn out across its plane.

    Args:
        text: the words; `\\n` begins a new line (word or text).
        font: a TrueType or OpenType font (file).
        face: which font of a collection (whole number from 0 to 65535). Default: 0.
        weight: of a variable font: 400 is regular, 700 bold (number from 1 to 1000). Default:
            none.
        align: which point of each line is at `origin` (left, center or right). Default: left.
        line_spacing: distance of lines, in parts of the font's (number ≥ 0). Default: 1.
        letter_spacing: more room between letters, in parts of `size` (number). Default: 0.
        origin: where the first line stands (x y z). Default: 0 0 0.
        axis: towards the reader (x y z). Default: 0 0 1.
        up: what is up in the text (x y z). Default: y, or away from it along y.
        size: height of an em, the font's own unit (number > 0, length). Default: 1.
        depth: how thick the letters are (number > 0, length). Default: 0.2.
        bevel: how far edges of both ends are taken off (number > 0, length). Default: sharp
            edges.
        bevel_profile: what edges look like from the side (chamfer or round). Default: chamfer.
    """

    keyword = "Text"

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        text: str,
        font: File,
        face: int | None = None,
        weight: Number | None = None,
        align: Literal["left", "center", "right"] | None = None,
        line_spacing: Number | None = None,
        letter_spacing: Number | None = None,
        origin: Vector | None = None,
        axis: Vector | None = None,
        up: Vector | None = None,
        size: Number | None = None,
        depth: Number | None = None,
        bevel: Number | None = None,
        bevel_profile: Literal["chamfer", "round"] | None = None,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.text = text
        self.font = font
        self.face = face
        self.weight = weight
        self.align = align
        self.line_spacing = line_spacing
        self.letter_spacing = letter_spacing
        self.origin = origin
        self.axis = axis
        self.up = up
        self.size = size
        self.depth = depth
        self.bevel = bevel
        self.bevel_profile = bevel_profile


class Lathe(ObjectBlock):
    """A profile, turned about an axis.

    Args:
        origin: where `0 0` of the profile is (x y z). Default: 0 0 0.
        axis: what is up in the profile, which turns about it (x y z). Default: 0 1 0.
        size: of one unit of the profile (number > 0, length). Default: 1.
        fill: what is inside where profiles cross (nonzero or evenodd). Default: nonzero.
    """

    keyword = "Lathe"

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        origin: Vector | None = None,
        axis: Vector | None = None,
        size: Number | None = None,
        fill: Literal["nonzero", "evenodd"] | None = None,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.origin = origin
        self.axis = axis
        self.size = size
        self.fill = fill


class SphereSweep(ObjectBlock):
    """All balls along paths, whose radii change on the way."""

    keyword = "SphereSweep"


class Curves(ObjectBlock):
    """Strands with a width: hair, grass, wires.

    Args:
        file: strands: text, or a file of hair (file). Default: none.
        basis: what points make a curve by (bspline, bezier, catmullrom or linear). Default:
            bspline.
        form: round, or flat and facing the ray (tube or ribbon). Default: tube.
        radius: half the width of points that have none (number ≥ 0, length). Default: 0.01.
        tip_radius: the same at the last point of each strand; changes steadily up to there
            (number ≥ 0, length). Default: `radius`.
    """

    keyword = "Curves"

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        file: File | None = None,
        basis: Literal["bspline", "bezier", "catmullrom", "linear"] | None = None,
        form: Literal["tube", "ribbon"] | None = None,
        radius: Number | None = None,
        tip_radius: Number | None = None,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.file = file
        self.basis = basis
        self.form = form
        self.radius = radius
        self.tip_radius = tip_radius


class TriangleMesh(ObjectBlock):
    """The triangles of an OBJ, PLY or STL file.

    Args:
        file: OBJ, PLY or STL (file). Default: none.
        smooth: shaded by interpolated normals (on or off). Default: by neighbouring faces.
        materials: in the materials of its own file (on or off). Default: off.
        colors: tinted by the colours of its vertices (on or off). Default: off.
        displacement: how far the subdivided surface is moved outwards (number, length, or a
            texture). Default: none.
        displacement_function: the same as a function of the place (= function of x, y, z).
            Default: none.
        subdivide: steps of subdivision into a smooth surface (whole number from 0 to 12).
            Default: 0.
        scheme: rules by which it is subdivided (catmullClark or loop). Default: none.
        crease_angle: edges that bend by more stay sharp (degrees from 0 to 180). Default: none.
    """

    keyword = "TriangleMesh"
    functions: ClassVar[tuple[str, ...]] = ("displacement_function",)

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        file: File | None = None,
        smooth: bool | None = None,
        materials: bool | None = None,
        colors: bool | None = None,
        displacement: Number | Texture | None = None,
        displacement_function: Function | str | Number | None = None,
        subdivide: int | None = None,
        scheme: Literal["catmullClark", "loop"] | None = None,
        crease_angle: Number | None = None,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.file = file
        self.smooth = smooth
        self.materials = materials
        self.colors = colors
        self.displacement = displacement
        self.displacement_function = displacement_function
        self.subdivide = subdivide
        self.scheme = scheme
        self.crease_angle = crease_angle


class Model(ObjectBlock):
    """A whole glTF model with its materials and lights.

    Args:
        file: glTF (file).
        smooth: shaded by interpolated normals (on or off). Default: on.
        materials: in the materials of its own file (on or off). Default: on.
        lights: with the lights of its file (on or off). Default: on.
        light_scale: factor of these lights (number ≥ 0). Default: 1.
        group: name of the lights it is seen among (word or text). Default: none.
        points: radius of spheres in place of points (number ≥ 0, length). Default: none.
        animation: name of its animation, or its number from 0 (word or text). Default: the
            first.
        animation_time: moment of the animation (number, s). Default: that of the frame.
        animation_repeat: it begins again when it is over (on or off). Default: on.
        lines: radius of tubes in place of lines (number ≥ 0, length). Default: none.
        subdivide: steps of subdivision into a smooth surface (whole number from 0 to 12).
            Default: 0.
        scheme: rules by which it is subdivided (catmullClark or loop). Default: none.
        crease_angle: edges that bend by more stay sharp (degrees from 0 to 180). Default: none.
    """

    keyword = "Model"

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        file: File,
        smooth: bool | None = None,
        materials: bool | None = None,
        lights: bool | None = None,
        light_scale: Number | None = None,
        group: str | None = None,
        points: Number | None = None,
        animation: str | None = None,
        animation_time: Number | None = None,
        animation_repeat: bool | None = None,
        lines: Number | None = None,
        subdivide: int | None = None,
        scheme: Literal["catmullClark", "loop"] | None = None,
        crease_angle: Number | None = None,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.file = file
        self.smooth = smooth
        self.materials = materials
        self.lights = lights
        self.light_scale = light_scale
        self.group = group
        self.points = points
        self.animation = animation
        self.animation_time = animation_time
        self.animation_repeat = animation_repeat
        self.lines = lines
        self.subdivide = subdivide
        self.scheme = scheme
        self.crease_angle = crease_angle


class Union(ObjectBlock):
    """Objects together; as an operand, what is in any of them.

    Args:
        own_material: material of all its faces (name or number). Default: those of its
            operands.
        num_objects: how many there are, which is checked (whole number ≥ 0). Default: as many
            as there are.
    """

    keyword = "Union"
    spelled: ClassVar[dict[str, str]] = {"own_material": "material"}

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        own_material: MaterialName | None = None,
        num_objects: int | None = None,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.own_material = own_material
        self.num_objects = num_objects


class Intersection(ObjectBlock):
    """What is in all of several solids.

    Args:
        own_material: material of all its faces (name or number). Default: those of its
            operands.
    """

    keyword = "Intersection"
    spelled: ClassVar[dict[str, str]] = {"own_material": "material"}

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        own_material: MaterialName | None = None,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.own_material = own_material


class Difference(ObjectBlock):
    """What is in the first solid and in none of the others.

    Args:
        own_material: material of all its faces (name or number). Default: those of its
            operands.
    """

    keyword = "Difference"
    spelled: ClassVar[dict[str, str]] = {"own_material": "material"}

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        own_material: MaterialName | None = None,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.own_material = own_material


class Merge(ObjectBlock):
    """What is in any of several solids, without the surfaces inside.

    Args:
        own_material: material of all its faces (name or number). Default: those of its
            operands.
    """

    keyword = "Merge"
    spelled: ClassVar[dict[str, str]] = {"own_material": "material"}

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        own_material: MaterialName | None = None,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.own_material = own_material


class Group(ObjectBlock):
    """Objects together.

    Args:
        num_objects: how many there are, which is checked (whole number ≥ 0). Default: as many
            as there are.
    """

    keyword = "Group"

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        num_objects: int | None = None,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.num_objects = num_objects


class Transform(ObjectBlock):
    """Moves, turns and scales an object or a group."""

    keyword = "Transform"


class Instance(ObjectBlock):
    """What was defined, put into its place."""

    keyword = "Instance"


class Lorentz(ObjectBlock):
    """Objects that move nearly as fast as light, and look it.

    Args:
        velocity: of what it holds, as a fraction of the speed of light (3 numbers).
    """

    keyword = "Lorentz"

    def __init__(
        self, *children: Item, name: str | None = None, material: MaterialName | None = None,
        velocity: Number | Vector,
    ) -> None:
        super().__init__(*children, name=name, material=material)
        self.velocity = velocity


class Define(ObjectBlock):
    """Objects that are placed elsewhere."""

    keyword = "Define"


class Translate(Operation):
    """Moves: x y z."""

    keyword = "Translate"

    def __init__(self, x: Number, y: Number, z: Number) -> None:
        super().__init__(x, y, z)


class XRotate(Operation):
    """Turns about the x axis: degrees."""

    keyword = "XRotate"

    def __init__(self, degrees: Number) -> None:
        super().__init__(degrees)


class YRotate(Operation):
    """Turns about the y axis: degrees."""

    keyword = "YRotate"

    def __init__(self, degrees: Number) -> None:
        super().__init__(degrees)


class ZRotate(Operation):
    """Turns about the z axis: degrees."""

    keyword = "ZRotate"

    def __init__(self, degrees: Number) -> None:
        super().__init__(degrees)


class Rotate(Operation):
    """Turns about an axis: x y z degrees: 4 numbers."""

    keyword = "Rotate"

    def __init__(self, *numbers: Number) -> None:
        super().__init__(*numbers)


class Scale(Operation):
    """Scales along the axes: x y z."""

    keyword = "Scale"

    def __init__(self, x: Number, y: Number, z: Number) -> None:
        super().__init__(x, y, z)


class UniformScale(Operation):
    """Scales equally: number."""

    keyword = "UniformScale"

    def __init__(self, factor: Number) -> None:
        super().__init__(factor)


class Matrix(Operation):
    """Any affine map, column by column unless the dialect has rows: 16 numbers."""

    keyword = "Matrix"

    def __init__(self, *numbers: Number) -> None:
        super().__init__(*numbers)


class Matrix4f(Operation):
    """Any affine map, column by column unless the dialect has rows: 16 numbers."""

    keyword = "Matrix4f"

    def __init__(self, *numbers: Number) -> None:
        super().__init__(*numbers)
