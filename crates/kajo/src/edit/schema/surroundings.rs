//! Background, fog and settings.

use kajo_core::light::LightChoice;
use kajo_core::sampler::SamplerKind;
use kajo_core::settings::{Dialect, Directions, IntegratorKind, Technique};

use super::FieldKind::{
    Angle, Choice, ChoiceAndNumber, ChoiceAndWhole, Color, Emission, File, Flag, Numbers, Wholes,
};
use super::{
    ANY, Block, Kind, LIGHT_GROUP, POSITIVE, at_least, between, block, field, number, option, required,
    ruled, rules, unlike, whole,
};

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
    block!(
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
    block!(
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
    block!(
        "Fog",
        Kind::Fog,
        &[
            required("color", Color, "its colour"),
            required("density", at_least(0.0), "how much hides what lies a unit away"),
            field("heightFalloff", at_least(0.0), "0", "how fast it thins with height"),
            field("height", number(), "0", "where the density is the one given"),
        ],
    ),
    block!(
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
