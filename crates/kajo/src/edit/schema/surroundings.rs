//! Cameras, background, fog and settings.

use kajo_core::light::LightChoice;
use kajo_core::sampler::SamplerKind;
use kajo_core::settings::{Dialect, Directions, IntegratorKind, Technique};

use super::FieldKind::{Angle, Choice, ChoiceAndNumber, Color, Emission, File, Flag, Numbers, Point, Vector};
use super::{
    ANY, Block, FieldSpec, Kind, LIGHT_GROUP, POSITIVE, SHARE, at_least, between, block, field, number,
    option, required, whole,
};

const CENTER: FieldSpec = required("center", Point, "where it is");
const DIRECTION: FieldSpec = required("direction", Vector, "where it looks");
const UP: FieldSpec = required("up", Vector, "which way is up in the picture");
const APERTURE: FieldSpec = option("aperture", at_least(0.0), "diameter of the lens's opening");
const FOCUS: FieldSpec = option("focus", POSITIVE, "distance of what is sharp");
const F_NUMBER: FieldSpec = option("fNumber", POSITIVE, "focal length over diameter");
const FOCAL_LENGTH: FieldSpec = option("focalLength", POSITIVE, "of the lens");
const BLADES: FieldSpec = option("blades", whole(3.0, 64.0), "the opening is a polygon");
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
            UP,
            SHUTTER,
            ROLLING_SHUTTER,
            required("angle", Angle { min: -ANY, max: ANY }, "field of view from bottom to top"),
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
            UP,
            SHUTTER,
            ROLLING_SHUTTER,
            required("size", number(), "height of the picture in the world"),
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
            field("fit", Choice(&["height", "corners"]), "height", "what the disk fills"),
        ],
    ),
    block(
        "PanoramaCamera",
        Kind::Camera,
        &[
            CENTER,
            DIRECTION,
            UP,
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
            UP,
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
            option("environment", File, "a picture of longitude and latitude"),
            option("rotate", Angle { min: -ANY, max: ANY }, "turns the picture"),
            option("scale", at_least(0.0), "makes the picture brighter"),
            option("cubeMap", File, "a folder of six pictures"),
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
            option("size", Numbers(2), "columns and rows of the picture"),
            option("integrator", Choice(INTEGRATORS), "how light is followed"),
            option("samples", ChoiceAndNumber(SAMPLERS), "rays of each pixel"),
            option("bounces", whole(0.0, 1000.0), "surfaces that light is followed over"),
            option("shadows", Choice(&["off", "on", "transparent"]), "what casts them"),
            option("transparentShadows", Choice(&["length", "surface"]), "how glass weakens light"),
            option("shadeBack", Flag, "light reaches back sides"),
            option("fresnel", Flag, "reflection grows towards grazing angles"),
            option("totalReflection", Flag, "light that cannot leave is reflected"),
            option("weight", at_least(0.0), "rays that count for less are not followed"),
            option("filter", ChoiceAndNumber(FILTERS), "how samples become pixels"),
            option("seed", whole(0.0, 9_007_199_254_740_992.0), "of the random numbers"),
            option("spectral", Flag, "with wavelengths in place of red, green and blue"),
            option("branches", whole(1.0, 65_536.0), "rays from one surface"),
            option("directions", Choice(DIRECTIONS), "how directions are drawn"),
            option("technique", Choice(TECHNIQUES), "how light is found"),
            option("lightChoice", Choice(LIGHT_CHOICES), "how a light is drawn"),
            option("roulette", Flag, "faint paths end by chance"),
            option("reach", POSITIVE, "distance beyond which nothing occludes"),
            option("rayOffset", Choice(&["auto", "reference"]), "how close to a surface rays start"),
            option("depthRange", Numbers(2), "distances that are white and black"),
            option("exposure", between(-100.0, 100.0), "in stops"),
            option("tone", Choice(TONES), "curve from light to pixels"),
            option("whiteBalance", Numbers(2), "kelvin and tint"),
            option("dialect", Choice(&Dialect::NAMES), "conventions of the file"),
        ],
    ),
];
