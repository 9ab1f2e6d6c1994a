//! Objects and what holds them.

use super::FieldKind::{self, Angle, File, Flag, Numbers, Point, Vector};
use super::{
    ANY, Block, FieldSpec, Kind, LIGHT_GROUP, at_least, block, field, number, option, required, ruled, rules,
};

const DEGREES: FieldKind = Angle { min: -ANY, max: ANY };

const CAPPED: FieldSpec = field("capped", Flag, "on", "closed by disks at its ends");
const SMOOTH: FieldSpec =
    ruled("smooth", Flag, rules::smooth, "by neighbouring faces", "shaded by interpolated normals");

/// The map that leaves everything where it is.
const IDENTITY: &str = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";

/// Operations of a transform; there may be several of each, and their order counts.
const OPERATIONS: &[FieldSpec] = &[
    field("Translate", Vector, "0 0 0", "moves"),
    field("XRotate", DEGREES, "0", "turns about the x axis"),
    field("YRotate", DEGREES, "0", "turns about the y axis"),
    field("ZRotate", DEGREES, "0", "turns about the z axis"),
    field("Rotate", Numbers(4), "0 1 0 0", "turns about an axis: x y z degrees"),
    field("Scale", Vector, "1 1 1", "scales along the axes"),
    field("UniformScale", number(), "1", "scales equally"),
    field("Matrix", Numbers(16), IDENTITY, "any affine map"),
    field("Matrix4f", Numbers(16), IDENTITY, "any affine map"),
];

pub(super) const BLOCKS: &[Block] = &[
    block(
        "Sphere",
        Kind::Shape,
        &[required("center", Point, "its middle"), required("radius", number(), "its radius")],
    ),
    block(
        "Box",
        Kind::Shape,
        &[
            required("min", Point, "the corner with the smallest coordinates"),
            required("max", Point, "the corner with the largest coordinates"),
        ],
    ),
    block(
        "Plane",
        Kind::Shape,
        &[
            required("normal", Vector, "at right angles to it"),
            required("offset", number(), "distance from the origin along the normal"),
        ],
    ),
    block(
        "Cylinder",
        Kind::Shape,
        &[
            required("base", Point, "middle of one end"),
            required("top", Point, "middle of the other end"),
            required("radius", number(), "its radius"),
            CAPPED,
        ],
    ),
    block(
        "Cone",
        Kind::Shape,
        &[
            required("base", Point, "middle of the base"),
            required("top", Point, "the tip, or the middle of the other end"),
            required("radius", number(), "radius of the base"),
            field("topRadius", number(), "0", "radius at the top"),
            CAPPED,
        ],
    ),
    block(
        "Disk",
        Kind::Shape,
        &[
            required("center", Point, "its middle"),
            required("normal", Vector, "at right angles to it"),
            required("radius", number(), "its radius"),
            field("innerRadius", number(), "0", "radius of the hole"),
        ],
    ),
    block(
        "Quad",
        Kind::Shape,
        &[
            required("corner", Point, "one corner"),
            required("edge1", Vector, "from there to the next corner"),
            required("edge2", Vector, "from there to the last corner"),
        ],
    ),
    block(
        "Triangle",
        Kind::Shape,
        &[
            required("vertex0", Point, "first corner"),
            required("vertex1", Point, "second corner"),
            required("vertex2", Point, "third corner"),
            field("textCoord0", Numbers(2), "0 0", "texture coordinates of the first corner"),
            field("textCoord1", Numbers(2), "1 0", "texture coordinates of the second corner"),
            field("textCoord2", Numbers(2), "0 1", "texture coordinates of the third corner"),
        ],
    ),
    block(
        "TriangleMesh",
        Kind::Shape,
        &[
            option("file", File, "OBJ, PLY or STL"),
            option("obj_file", File, "OBJ, PLY or STL").spelling_of("file"),
            SMOOTH,
            field("materials", Flag, "off", "in the materials of its own file"),
            field("colors", Flag, "off", "tinted by the colours of its vertices"),
        ],
    ),
    block(
        "Model",
        Kind::Shape,
        &[
            required("file", File, "glTF"),
            field("smooth", Flag, "on", "shaded by interpolated normals"),
            field("materials", Flag, "on", "in the materials of its own file"),
            field("lights", Flag, "on", "with the lights of its file"),
            field("lightScale", at_least(0.0), "1", "factor of these lights"),
            LIGHT_GROUP,
            option("points", at_least(0.0), "radius of spheres in place of points"),
            option("lines", at_least(0.0), "radius of tubes in place of lines"),
        ],
    ),
    block("Group", Kind::Group, &[]),
    block("Define", Kind::Define, &[]),
    block("Transform", Kind::Transform, OPERATIONS),
    block("Instance", Kind::Instance, OPERATIONS),
    block("Motion", Kind::Part, &[]),
    block("key", Kind::Part, OPERATIONS),
];
