//! Patterns that are sums of noise.

use kajo_math::Vec3;
use kajo_math::pattern::{Clouds, Gabor, Granite, Ridged, Turbulence, Wrinkles};

use super::{OctaveKeys, SEED, SeedKeys, pattern_member};
use crate::compile::fields::{Keys, keys, number, positive, vector};

pattern_member!(CLOUDS, "Clouds", "clouds: a sum of noise", [OctaveKeys], |params, sources| {
    Clouds(OctaveKeys::read(params, sources)?.octaves())
});

pattern_member!(
    TURBULENCE,
    "Turbulence",
    "smoke and fire: a sum of creased noise",
    [OctaveKeys],
    |params, sources| { Turbulence(OctaveKeys::read(params, sources)?.octaves()) }
);

pattern_member!(
    RIDGED,
    "Ridged",
    "mountain ridges, lightning: noise that is sharp on top",
    [OctaveKeys],
    |params, sources| { Ridged(OctaveKeys::read(params, sources)?.octaves()) }
);

pattern_member!(
    WRINKLES,
    "Wrinkles",
    "folds of cloth, leather and paper",
    [OctaveKeys],
    |params, sources| { Wrinkles(OctaveKeys::read(params, sources)?.octaves()) }
);

pattern_member!(GRANITE, "Granite", "grains of stone", [SeedKeys], |params, sources| {
    Granite { seed: SeedKeys::read(params, sources)?.seed }
});

keys! {
    GaborKeys {
        frequency: f32 = number("frequency").unit("1/size").or(2.0, "waves per unit"),
        bandwidth: f32 = positive("bandwidth").unit("1/size").or(0.75, "how much their frequencies differ"),
        direction: Vec3 = vector("direction").or([0.0; 3], "what is across the waves; 0 0 0 for all directions"),
        seed: u32 = SEED,
    }
}

pattern_member!(
    GABOR,
    "Gabor",
    "waves of about one length, as of fabric and brushed metal",
    [GaborKeys],
    |params, sources| {
        let GaborKeys { frequency, bandwidth, direction, seed } = GaborKeys::read(params, sources)?;
        Gabor { frequency, bandwidth, direction: direction.normalize_or_zero(), seed }
    }
);
