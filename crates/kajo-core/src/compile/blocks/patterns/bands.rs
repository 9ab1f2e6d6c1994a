//! Patterns that are bands: of a coordinate, an angle, a distance, straight or bent by noise.

use kajo_math::pattern::{
    Agate, Gradient, Leopard, Onion, Radial, Rings, Ripples, Spiral, Timber, Veins, Wave, Waves,
};

use super::{OctaveKeys, SEED, amount, pattern_member};
use crate::compile::fields::{Keys, choice, count, keys, number};

keys! {
    BandKeys {
        wave: Wave = choice::<Wave>("wave").or_word("triangle", "shape of a band"),
        frequency: f32 = number("frequency").unit("1/size").or(1.0, "bands per unit"),
        phase: f32 = number("phase").or(0.0, "by which part of a band it is moved"),
    }
}

keys! {
    ArmKeys {
        wave: Wave = choice::<Wave>("wave").or_word("triangle", "shape of a band"),
        arms: u32 = count("arms", 1, 100_000).or(8, "bands of a full turn"),
        phase: f32 = number("phase").or(0.0, "by which part of a band it is moved"),
    }
}

keys! {
    SpiralKeys {
        wave: Wave = choice::<Wave>("wave").or_word("triangle", "shape of a band"),
        arms: u32 = count("arms", 0, 100_000).or(2, "spirals beside each other"),
        frequency: f32 = number("frequency").unit("1/size").or(1.0, "bands per unit of radius"),
        phase: f32 = number("phase").or(0.0, "by which part of a band it is moved"),
    }
}

keys! {
    VeinKeys {
        wave: Wave = choice::<Wave>("wave").or_word("triangle", "shape of a vein"),
        frequency: f32 = number("frequency").unit("1/size").or(1.0, "veins per unit"),
        phase: f32 = number("phase").or(0.0, "by which part of a vein it is moved"),
        bend: f32 = number("bend").or(1.5, "by how many veins noise bends them"),
    }
}

keys! {
    RingKeys {
        wave: Wave = choice::<Wave>("wave").or_word("saw", "shape of a ring"),
        frequency: f32 = number("frequency").unit("1/size").or(4.0, "rings per unit"),
        phase: f32 = number("phase").or(0.0, "by which part of a ring it is moved"),
        bend: f32 = number("bend").or(1.0, "by how many rings noise bends them"),
    }
}

keys! {
    LayerKeys {
        bend: f32 = number("bend").or(2.0, "how strongly turbulence folds the layers"),
    }
}

keys! {
    TimberKeys {
        frequency: f32 = amount("frequency", 8.0, "rings per unit"),
        bend: f32 = amount("bend", 1.0, "by how many rings noise bends them"),
        knots: f32 = amount("knots", 0.5, "branches per unit of the trunk"),
        rays: f32 = amount("rays", 0.25, "how dark the sheets outwards from the middle are"),
        pores: f32 = amount("pores", 0.25, "how dark the tubes along the trunk are"),
        seed: u32 = SEED,
    }
}

keys! {
    RippleKeys {
        frequency: f32 = number("frequency").unit("1/size").or(1.0, "waves per unit"),
        phase: f32 = number("phase").or(0.0, "by which part of a wave they have run"),
        seed: u32 = SEED,
    }
}

pattern_member!(GRADIENT, "Gradient", "bands across x", [BandKeys], |params, sources| {
    let BandKeys { wave, frequency, phase } = BandKeys::read(params, sources)?;
    Gradient { wave, frequency, phase }
});

pattern_member!(RADIAL, "Radial", "sectors around y", [ArmKeys], |params, sources| {
    let ArmKeys { wave, arms, phase } = ArmKeys::read(params, sources)?;
    Radial { wave, arms, phase }
});

pattern_member!(SPIRAL, "Spiral", "spirals around y", [SpiralKeys], |params, sources| {
    let SpiralKeys { wave, arms, frequency, phase } = SpiralKeys::read(params, sources)?;
    Spiral { wave, arms, frequency, phase }
});

pattern_member!(ONION, "Onion", "shells around the origin", [BandKeys], |params, sources| {
    let BandKeys { wave, frequency, phase } = BandKeys::read(params, sources)?;
    Onion { wave, frequency, phase }
});

pattern_member!(
    VEINS,
    "Veins",
    "marble: veins across x that noise bends",
    [VeinKeys, OctaveKeys],
    |params, sources| {
        let VeinKeys { wave, frequency, phase, bend } = VeinKeys::read(params, sources)?;
        Veins { wave, frequency, phase, bend, octaves: OctaveKeys::read(params, sources)?.octaves() }
    }
);

pattern_member!(
    RINGS,
    "Rings",
    "wood: rings around y that noise bends",
    [RingKeys, OctaveKeys],
    |params, sources| {
        let RingKeys { wave, frequency, phase, bend } = RingKeys::read(params, sources)?;
        Rings { wave, frequency, phase, bend, octaves: OctaveKeys::read(params, sources)?.octaves() }
    }
);

pattern_member!(
    TIMBER,
    "Timber",
    "wood with late and early growth, knots, rays and pores",
    [TimberKeys],
    |params, sources| {
        let TimberKeys { frequency, bend, knots, rays, pores, seed } = TimberKeys::read(params, sources)?;
        Timber { frequency, bend, knots, rays, pores, seed }
    }
);

pattern_member!(AGATE, "Agate", "folded layers of agate", [LayerKeys, OctaveKeys], |params, sources| {
    let LayerKeys { bend } = LayerKeys::read(params, sources)?;
    Agate { bend, octaves: OctaveKeys::read(params, sources)?.octaves() }
});

pattern_member!(
    RIPPLES,
    "Ripples",
    "waves of one length around ten places",
    [RippleKeys],
    |params, sources| {
        let RippleKeys { frequency, phase, seed } = RippleKeys::read(params, sources)?;
        Ripples { frequency, phase, seed }
    }
);

pattern_member!(
    WAVES,
    "Waves",
    "waves of many lengths around ten places",
    [RippleKeys],
    |params, sources| {
        let RippleKeys { frequency, phase, seed } = RippleKeys::read(params, sources)?;
        Waves { frequency, phase, seed }
    }
);

pattern_member!(LEOPARD, "Leopard", "round spots in rows", [], |_params, _sources| Leopard);
