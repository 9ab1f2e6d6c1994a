//! Lights.

use super::FieldKind::{Angle, Emission, File, Numbers, Point, Vector};
use super::{
    ANY, Block, FieldKind, FieldSpec, Kind, LIGHT_GROUP, at_least, block, field, number, option, required,
};

const ANGLE: FieldKind = Angle { min: 0.0, max: 360.0 };
const COLOR: FieldSpec = option("color", Emission, "brightness by the classic formula");
const POSITION: FieldSpec = required("position", Point, "where it is");
const INTENSITY: FieldSpec = option("intensity", Emission, "power per solid angle");
const POWER: FieldSpec = option("power", Emission, "all the light it gives");
const ATTENUATION: FieldSpec =
    option("attenuation", Numbers(3), "divides the colour by c0 + c1 d + c2 d² at the distance d");
const FALLOFF: FieldSpec = option("falloff", number(), "divides the colour by f d² at the distance d");

pub(super) const BLOCKS: &[Block] = &[
    block(
        "DirectionalLight",
        Kind::Light,
        &[
            required("direction", Vector, "the way its light goes"),
            COLOR,
            option("irradiance", Emission, "light on a surface that faces it"),
            field("angle", Angle { min: 0.0, max: 180.0 }, "0", "how wide it is in the sky; the sun: 0.53"),
            LIGHT_GROUP,
        ],
    ),
    block(
        "PointLight",
        Kind::Light,
        &[
            POSITION,
            COLOR,
            INTENSITY,
            POWER,
            ATTENUATION,
            FALLOFF,
            LIGHT_GROUP,
            option("ies", File, "measured intensities, in place of all these"),
            option("direction", Vector, "where a measured luminaire points"),
            option("rotate", Angle { min: -ANY, max: ANY }, "turns a measured luminaire about its axis"),
            option("scale", at_least(0.0), "makes a measured luminaire brighter"),
        ],
    ),
    block(
        "SpotLight",
        Kind::Light,
        &[
            POSITION,
            required("direction", Vector, "where it points"),
            required("angle", ANGLE, "full width of the cone"),
            option("innerAngle", ANGLE, "width of the cone that is evenly bright"),
            COLOR,
            INTENSITY,
            POWER,
            ATTENUATION,
            FALLOFF,
            LIGHT_GROUP,
        ],
    ),
    block("Lights", Kind::Lights, &[]),
];
