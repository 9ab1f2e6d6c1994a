//! Materials.

use super::FieldKind::{Choice, Color, Emission, Flag, Material, Reflectance, Text};
use super::{
    Block, FieldKind, FieldSpec, Kind, POSITIVE, SHARE, at_least, between, block, field, number, option,
    required, ruled, rules, unlike, whole,
};

const EMISSION: FieldSpec = field("emission", Emission, "0 0 0", "light that it gives itself");
const EMITS: FieldSpec =
    field("emits", Choice(&["front", "back", "both"]), "both", "the side that gives light")
        .only_beside("emission");
const LIGHT_GROUP: FieldSpec = super::LIGHT_GROUP.only_beside("emission");
const DISTRIBUTION: FieldSpec =
    field("distribution", Choice(&["ggx", "beckmann"]), "ggx", "how the facets of a rough surface lie");
const PRIORITY: FieldSpec =
    field("priority", whole(-1000.0, 1000.0), "0", "of bodies that overlap, the one with the highest counts");
const OPACITY: FieldSpec = field("opacity", SHARE, "1", "the share of it that is there, between holes");
const NORMAL_MAP: FieldSpec =
    option("normalMap", Text, "a picture of normals that dents it, such as hammered.png");
const BUMP: FieldSpec = option("bump", Text, "a picture of heights that dents it, such as bricks.png");
const ANISOTROPY: FieldSpec =
    field("anisotropy", SHARE, "0", "how far the highlight of a brushed surface is drawn out");
const ROTATION: FieldSpec = field("rotation", SHARE, "0", "by how many full turns the brushing is turned");
const FIRST: FieldSpec = required("materialIndex", Material, "the two materials that it mixes");
const OCTAVES: FieldSpec = field("octaves", whole(0.0, 32.0), "1", "levels of detail");
const FREQUENCY: FieldSpec = field("frequency", number(), "1", "rings or veins per length");
const AMPLITUDE: FieldSpec = field("amplitude", number(), "1", "how strongly the noise bends them");
const INDEX: FieldKind = between(1.0, 4.0);

const PHONG: &[FieldSpec] = &[
    field("diffuseColor", Reflectance, "1 1 1", "colour of matte reflection"),
    option("texture", Text, "a picture that tints it, such as wood.png"),
    field("specularColor", Reflectance, "0 0 0", "colour of the highlight"),
    ruled("exponent", at_least(0.0), rules::exponent, "", "sharpness of the highlight"),
    ruled("shininess", at_least(0.0), rules::exponent, "", "sharpness of the highlight")
        .spelling_of("exponent"),
    ruled(
        "reflectiveColor",
        Reflectance,
        rules::reflective_color,
        "as `specularColor`",
        "colour of mirror reflection",
    ),
    field("transparentColor", Reflectance, "0 0 0", "colour of what shines through"),
    field("indexOfRefraction", POSITIVE, "1", "how strongly it bends light"),
    field("refractionIndex", at_least(0.0), "0", "how strongly it bends light; 0 is opaque")
        .spelling_of("indexOfRefraction"),
    ruled("ambientColor", Color, rules::ambient_color, "as `diffuseColor`", "colour under ambient light"),
    ruled("absorption", Color, rules::absorption, "by `transparentColor`", "per length inside")
        .only_beside("transparentColor"),
    EMISSION,
    EMITS,
    LIGHT_GROUP,
    OPACITY,
    NORMAL_MAP,
    BUMP,
];

const WOODY: &[FieldSpec] = &[FIRST, FIRST, OCTAVES, FREQUENCY, AMPLITUDE];

pub(super) const BLOCKS: &[Block] = &[
    block!("PhongMaterial", Kind::Material, PHONG),
    block!("Material", Kind::Material, PHONG),
    block!(
        "Matte",
        Kind::Material,
        &[
            field("color", Reflectance, "0.8 0.8 0.8", "its colour"),
            field("roughness", SHARE, "0", "0 is as paper, 1 as plaster"),
            EMISSION,
            EMITS,
            LIGHT_GROUP,
            OPACITY,
            NORMAL_MAP,
            BUMP,
        ],
    ),
    block!(
        "Metal",
        Kind::Material,
        &[
            unlike("metal", Text, "by `color`", "", "a measured metal, such as gold"),
            field("color", Reflectance, "0.9 0.9 0.9", "its colour, where no metal is named"),
            DISTRIBUTION,
            field("roughness", SHARE, "0", "0 is a mirror"),
            ANISOTROPY,
            ROTATION,
            EMISSION,
            EMITS,
            LIGHT_GROUP,
            OPACITY,
            NORMAL_MAP,
            BUMP,
        ],
    ),
    block!(
        "Glass",
        Kind::Material,
        &[
            unlike("glass", Text, "by `indexOfRefraction`", "", "a measured glass, such as N-BK7"),
            field("indexOfRefraction", INDEX, "1.5", "how strongly it bends light"),
            unlike("abbeNumber", POSITIVE, "all colours alike", "60", "how little it splits colours"),
            field("absorption", Color, "0 0 0", "per length inside"),
            unlike("thickness", at_least(0.0), "a solid body", "0.01", "of a pane"),
            ruled("thin", Flag, rules::thin, "", "a pane, whose surface stands for both its sides"),
            DISTRIBUTION,
            field("roughness", SHARE, "0", "0 is clear, more is frosted"),
            ANISOTROPY,
            ROTATION,
            PRIORITY,
            EMISSION,
            EMITS,
            LIGHT_GROUP,
            OPACITY,
            NORMAL_MAP,
            BUMP,
        ],
    ),
    block!(
        "Principled",
        Kind::Material,
        &[
            field("color", Reflectance, "0.8 0.8 0.8", "its colour"),
            field("metalness", SHARE, "0", "from plastic to metal"),
            field("roughness", SHARE, "0.3", "of the highlight"),
            ANISOTROPY,
            ROTATION,
            field("specularColor", Reflectance, "1 1 1", "tints the highlight"),
            field("indexOfRefraction", INDEX, "1.5", "strength of the highlight"),
            field("transmission", SHARE, "0", "from plastic to glass"),
            field("absorption", Color, "0 0 0", "of the glass, per length inside"),
            field("thin", Flag, "off", "its glass is a pane"),
            field("diffuseRoughness", SHARE, "0", "0 is as paper, 1 as plaster"),
            field("coat", SHARE, "0", "of clear coat"),
            field("coatColor", Reflectance, "1 1 1", "tint of the coat"),
            field("coatRoughness", SHARE, "0", "of the coat"),
            field("coatIndexOfRefraction", INDEX, "1.6", "of the coat"),
            field("fuzz", SHARE, "0", "as of velvet"),
            field("fuzzColor", Reflectance, "1 1 1", "colour of the fuzz"),
            field("fuzzRoughness", SHARE, "0.5", "of the fuzz"),
            PRIORITY,
            EMISSION,
            EMITS,
            LIGHT_GROUP,
            OPACITY,
            NORMAL_MAP,
            BUMP,
        ],
    ),
    block!("Checkerboard", Kind::Material, &[FIRST, FIRST]),
    block!("Mix", Kind::Material, &[FIRST, FIRST, field("amount", SHARE, "0.5", "share of the second")]),
    block!("Noise", Kind::Material, &[FIRST, FIRST, OCTAVES]),
    block!("Marble", Kind::Material, WOODY),
    block!("Wood", Kind::Material, WOODY),
    block!("Materials", Kind::Materials, &[]),
];
