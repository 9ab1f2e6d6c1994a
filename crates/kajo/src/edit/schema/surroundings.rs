//! Cameras, background, fog and settings.

use kajo_core::light::LightChoice;
use kajo_core::sampler::SamplerKind;
use kajo_core::settings::{Dialect, Directions, IntegratorKind, Technique};

use super::FieldKind::{
    Angle, Choice, ChoiceAndNumber, ChoiceAndWhole, Color, Emission, File, Flag, Numbers, Point, Text,
    Vector, Wholes,
};
use super::{
    ANY, Block, FieldSpec, Kind, LIGHT_GROUP, POSITIVE, SHARE, at_least, between, block, field, number,
    option, required, ruled, rules, unlike, whole,
};

const CENTER: FieldSpec = option("center", Point, "where it is");
const DIRECTION: FieldSpec = option("direction", Vector, "where it looks");
const TARGET: FieldSpec =
    option("target", Point, "the point it looks at, or the name of an object").not_beside(&["lookAt"]);
const LOOK_AT: FieldSpec = option("lookAt", Numbers(9), "where it is, the point it looks at, and what is up")
    .not_beside(&["target"]);
const UP: FieldSpec = option("up", Vector, "which way is up in the picture");
const FIT: FieldSpec = option("fit", Text, "what fills the picture: scene, or the name of an object");
const APERTURE: FieldSpec = field("aperture", at_least(0.0), "0", "diameter of the lens's opening")
    .only_beside("focus")
    .not_beside(&["fNumber", "focalLength"]);
const FOCUS: FieldSpec = unlike(
    "focus",
    POSITIVE,
    "all is sharp",
    "5",
    "distance of what is sharp; or a point, or the name of an object",
);
const F_NUMBER: FieldSpec = unlike("fNumber", POSITIVE, "none", "2.8", "focal length over diameter")
    .only_beside("focus")
    .together_with("focalLength")
    .not_beside(&["aperture"]);
const FOCAL_LENGTH: FieldSpec = unlike("focalLength", POSITIVE, "none", "0.05", "of the lens")
    .only_beside("focus")
    .together_with("fNumber")
    .not_beside(&["aperture"]);
const BLADES: FieldSpec = unlike("blades", whole(3.0, 64.0), "round", "6", "the opening is a polygon");
const BLADE_ROTATION: FieldSpec =
    field("bladeRotation", Angle { min: -ANY, max: ANY }, "0", "turns the polygon");
const BOKEH: FieldSpec = option("bokeh", File, "a picture of the opening");
const SHUTTER: FieldSpec = field("shutter", Numbers(2), "0 1", "from when to when light is gathered");
const ROLLING_SHUTTER: FieldSpec =
    field("rollingShutter", SHARE, "0", "the share of that time in which rows open one after the other");
const EYES: FieldSpec = field("eyeSeparation", at_least(0.0), "0.065", "distance between the eyes");

const FILTERS: &[&str] = &["none", "box", "tent", "gaussian", "mitchell", "lanczos"];
const SAMPLERS: &[&str] = &words(&SamplerKind::NAMES);
const INTEGRATORS: &[&str] = &words(&IntegratorKind::NAMES);
const DIRECTIONS: &[&str] = &words(&Directions::NAMES);
const TECHNIQUES: &[&str] = &words(&Technique::NAMES);
const LIGHT_CHOICES: &[&str] = &words(&LightChoice::NAMES);
const TONES: &[&str] = &["linear", "srgb", "aces", "agx"];

/// The words of a table.
const fn words<T, const N: usize>(table: &[(&'static str, T); N]) -> [&'static str; N] {
    let mut words = [""; N];
    let mut i = 0;
    while i < N {
        words[i] = table[i].0;
        i += 1;
    }
    words
}

pub(super) const BLOCKS: &[Block] = &[
    block(
        "PerspectiveCamera",
        Kind::Camera,
        &[
            CENTER,
            DIRECTION,
            TARGET,
            LOOK_AT,
            UP,
            FIT,
            SHUTTER,
            ROLLING_SHUTTER,
            option("angle", Angle { min: -ANY, max: ANY }, "field of view from bottom to top"),
            option("width", whole(1.0, 16_777_216.0), "columns of the picture, if nothing else says them"),
            option("height", whole(1.0, 16_777_216.0), "rows of the picture, if nothing else says them"),
            APERTURE,
            FOCUS,
            F_NUMBER,
            FOCAL_LENGTH,
            BLADES,
            BLADE_ROTATION,
            BOKEH,
        ],
    ),
    block(
        "OrthographicCamera",
        Kind::Camera,
        &[
            CENTER,
            DIRECTION,
            TARGET,
            LOOK_AT,
            UP,
            FIT,
            SHUTTER,
            ROLLING_SHUTTER,
            option("size", number(), "height of the picture in the world"),
            APERTURE,
            FOCUS,
            F_NUMBER,
            FOCAL_LENGTH,
            BLADES,
            BLADE_ROTATION,
            BOKEH,
        ],
    ),
    block(
        "FisheyeCamera",
        Kind::Camera,
        &[
            CENTER,
            DIRECTION,
            TARGET,
            LOOK_AT,
            UP,
            SHUTTER,
            ROLLING_SHUTTER,
            field("angle", Angle { min: 1e-3, max: 360.0 }, "180", "width of the disk"),
            field(
                "projection",
                Choice(&["equidistant", "equisolid", "orthographic", "stereographic"]),
                "equidistant",
                "how angles become distances",
            ),
            field(
                "fit",
                Choice(&["height", "corners"]),
                "height",
                "what the disk fills, or what fills the picture",
            ),
        ],
    ),
    block(
        "PanoramaCamera",
        Kind::Camera,
        &[
            CENTER,
            DIRECTION,
            TARGET,
            LOOK_AT,
            UP,
            FIT,
            SHUTTER,
            ROLLING_SHUTTER,
            EYES,
            field("stereo", Choice(&["none", "omnidirectional"]), "none", "one eye or two"),
        ],
    ),
    block(
        "StereoCubemapCamera",
        Kind::Camera,
        &[
            CENTER,
            DIRECTION,
            TARGET,
            LOOK_AT,
            UP,
            FIT,
            SHUTTER,
            ROLLING_SHUTTER,
            EYES,
            field("stereo", Choice(&["twin", "omnidirectional"]), "twin", "how eyes turn"),
        ],
    ),
    block(
        "Background",
        Kind::Background,
        &[
            field("color", Emission, "0.5 0.5 0.5", "what rays see that hit nothing"),
            field("ambientLight", Color, "0 0 0", "light from everywhere, of the classic integrator"),
            option("environment", File, "a picture of longitude and latitude").not_beside(&["cubeMap"]),
            field("rotate", Angle { min: -ANY, max: ANY }, "0", "turns the picture")
                .only_beside("environment"),
            field("scale", at_least(0.0), "1", "makes the picture brighter").only_beside("environment"),
            option("cubeMap", File, "a folder of six pictures").not_beside(&["environment"]),
            LIGHT_GROUP,
        ],
    ),
    block(
        "sky",
        Kind::Part,
        &[
            field("turbidity", between(2.0, 10.0), "3", "haze"),
            field("elevation", Angle { min: 0.0, max: 90.0 }, "45", "of the sun over the horizon"),
            field("azimuth", Angle { min: -ANY, max: ANY }, "135", "of the sun"),
            field("ground", between(0.0, 1.0), "0.2", "reflectance of the ground"),
            field("scale", at_least(0.0), "1", "makes it brighter"),
            field("sun", Flag, "on", "with the sun itself"),
        ],
    ),
    block(
        "Fog",
        Kind::Fog,
        &[
            required("color", Color, "its colour"),
            required("density", at_least(0.0), "how much hides what lies a unit away"),
            field("heightFalloff", at_least(0.0), "0", "how fast it thins with height"),
            field("height", number(), "0", "where the density is the one given"),
        ],
    ),
    block(
        "Settings",
        Kind::Settings,
        &[
            ruled("size", Wholes(2), rules::size, "", "columns and rows of the picture"),
            ruled("integrator", Choice(INTEGRATORS), rules::integrator, "", "how light is followed"),
            ruled("samples", ChoiceAndWhole(SAMPLERS), rules::samples, "", "rays of each pixel"),
            ruled("bounces", whole(0.0, 1000.0), rules::bounces, "", "surfaces that light is followed over"),
            field("shadows", Choice(&["off", "on", "transparent"]), "on", "what casts them"),
            ruled(
                "transparentShadows",
                Choice(&["length", "surface"]),
                rules::transparent_shadows,
                "",
                "how glass weakens light",
            ),
            field("shadeBack", Flag, "off", "light reaches back sides"),
            field("fresnel", Flag, "off", "reflection grows towards grazing angles"),
            field("totalReflection", Flag, "off", "light that cannot leave is reflected"),
            field("weight", at_least(0.0), "0", "rays that count for less are not followed"),
            field("filter", ChoiceAndNumber(FILTERS), "none", "how samples become pixels"),
            field("seed", whole(0.0, 9_007_199_254_740_992.0), "0", "of the random numbers"),
            field("spectral", Flag, "off", "with wavelengths in place of red, green and blue"),
            ruled("branches", whole(1.0, 65_536.0), rules::branches, "", "rays from one surface"),
            field("directions", Choice(DIRECTIONS), "scattering", "how directions are drawn"),
            field("technique", Choice(TECHNIQUES), "combined", "how light is found"),
            field("lightChoice", Choice(LIGHT_CHOICES), "tree", "how a light is drawn"),
            ruled("roulette", Flag, rules::roulette, "", "faint paths end by chance"),
            unlike("reach", POSITIVE, "any distance", "1", "distance beyond which nothing occludes"),
            field("rayOffset", Choice(&["auto", "reference"]), "auto", "how close to a surface rays start"),
            unlike("depthRange", Numbers(2), "by the picture", "0 10", "distances that are white and black"),
            field("exposure", between(-100.0, 100.0), "0", "in stops"),
            ruled("tone", Choice(TONES), rules::tone, "", "curve from light to pixels"),
            unlike("whiteBalance", Numbers(2), "as it is", "6500 0", "kelvin and tint"),
            ruled("dialect", Choice(&Dialect::NAMES), rules::dialect, "", "conventions of the file"),
        ],
    ),
];
