//! Lights.

use super::FieldKind::{Angle, Emission, File, Numbers, Point, Vector};
use super::{
    ANY, Block, FieldKind, FieldSpec, Kind, LIGHT_GROUP, at_least, block, field, number, option, required,
    ruled, rules, unlike,
};

const ANGLE: FieldKind = Angle { min: 0.0, max: 360.0 };
const NONE: &str = "none";
const COLOR: FieldSpec = unlike("color", Emission, NONE, "1 1 1", "brightness by the classic formula")
    .not_beside(&["intensity", "power"]);
const POSITION: FieldSpec = required("position", Point, "where it is");
const INTENSITY: FieldSpec = unlike("intensity", Emission, NONE, "1 1 1", "power per solid angle")
    .not_beside(&["color", "power", "ies", "attenuation", "falloff"]);
const POWER: FieldSpec = unlike("power", Emission, NONE, "10 10 10", "all the light it gives").not_beside(&[
    "color",
    "intensity",
    "attenuation",
    "falloff",
]);
const ATTENUATION: FieldSpec =
    field("attenuation", Numbers(3), "1 0 0", "divides the colour by c0 + c1 d + c2 d² at the distance d")
        .not_beside(&["falloff", "intensity", "power", "ies"]);
const FALLOFF: FieldSpec =
    unlike("falloff", number(), "by `attenuation`", "1", "divides the colour by f d² at the distance d")
        .not_beside(&["attenuation", "intensity", "power", "ies"]);

pub(super) const BLOCKS: &[Block] = &[
    block(
        "DirectionalLight",
        Kind::Light,
        &[
            required("direction", Vector, "the way its light goes"),
            unlike("color", Emission, NONE, "1 1 1", "brightness by the classic formula")
                .not_beside(&["irradiance"]),
            unlike("irradiance", Emission, NONE, "3 3 3", "light on a surface that faces it")
                .not_beside(&["color"]),
            field("angle", Angle { min: 0.0, max: 180.0 }, "0", "how wide it is in the sky; the sun: 0.53"),
            LIGHT_GROUP,
        ],
    ),
    block(
        "PointLight",
        Kind::Light,
        &[
            POSITION,
            ruled("color", Emission, rules::color_of_light, NONE, "brightness by the classic formula")
                .not_beside(&["intensity", "power"]),
            INTENSITY,
            POWER,
            ATTENUATION,
            FALLOFF,
            LIGHT_GROUP,
            option("ies", File, "measured intensities, in place of all these").not_beside(&[
                "intensity",
                "attenuation",
                "falloff",
            ]),
            field("direction", Vector, "0 -1 0", "where a measured luminaire points").only_beside("ies"),
            field("rotate", Angle { min: -ANY, max: ANY }, "0", "turns a measured luminaire about its axis")
                .only_beside("ies"),
            field("scale", at_least(0.0), "1", "makes a measured luminaire brighter").only_beside("ies"),
        ],
    ),
    block(
        "SpotLight",
        Kind::Light,
        &[
            POSITION,
            required("direction", Vector, "where it points"),
            required("angle", ANGLE, "full width of the cone"),
            ruled("innerAngle", ANGLE, rules::inner_angle, NONE, "width of the cone that is evenly bright"),
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
