//! `GradientIndex`: clear matter that bends light, and what all such media have in common.

use std::sync::Arc;

use kajo_color::Dispersion;
use kajo_math::Vec3;
use kajo_math::tape::Tape;

use crate::compile::fields::{
    Keys, at_least, choice, choices, count, function, keys, point, positive, vector,
};
use crate::compile::member::{MediumMember, Member};
use crate::curved_light::Stepping;
use crate::medium::GradientIndex;
use crate::medium::gradient_index::{Dispersing, IndexTurbulence, Profile};
use crate::schema::{Block, Kind};

/// How light is followed, by its word.
#[derive(Clone, Copy, PartialEq)]
pub enum SteppingName {
    Adaptive,
    Euler,
    RungeKutta,
}

choices! {
    SteppingName {
        "adaptive" => SteppingName::Adaptive,
        "euler" => SteppingName::Euler,
        "rungeKutta" => SteppingName::RungeKutta,
    }
}

/// The index of refraction at the d line that a dispersion by Abbe's number is made for; only its shape counts.
const TYPICAL_INDEX: f64 = 1.5;

keys! {
    /// What every medium has that bends light.
    pub CurveKeys {
        noise: f32 = at_least("noise", 0.0).or(0.0, "how much Perlin noise adds to the index"),
        noise_frequency: Vec3 = vector("noiseFrequency")
            .unit("1/length")
            .or([1.0; 3], "how fine the noise is along each axis"),
        noise_origin: Vec3 = point("noiseOrigin")
            .or([0.0; 3], "where the noise has its origin; keys of an animation make it drift"),
        octaves: u32 = count("octaves", 1, 16).or(3, "how many noises are added up"),
        integrator: SteppingName = choice::<SteppingName>("integrator")
            .otherwise(crate::schema::Constant::Word("adaptive"), "how light is followed from step to step"),
        steps: u32 = count("steps", 1, 1_000_000)
            .or(1000, "of the fixed integrators, for the diagonal of the body"),
    }
}

impl CurveKeys {
    /// A medium of a profile, with what these keys say.
    pub fn medium(&self, profile: Profile, dispersing: Dispersing) -> GradientIndex {
        let noise = IndexTurbulence {
            amplitude: self.noise.into(),
            frequency: self.noise_frequency,
            origin: self.noise_origin,
            octaves: self.octaves,
        };
        let mut medium = GradientIndex::new(profile);
        medium.turbulence = (self.noise > 0.0).then_some(noise);
        medium.dispersing = dispersing;
        medium.stepping = match self.integrator {
            SteppingName::Adaptive => Stepping::Adaptive,
            SteppingName::Euler => Stepping::Euler(self.steps),
            SteppingName::RungeKutta => Stepping::RungeKutta(self.steps),
        };
        medium
    }
}

keys! {
    /// How colours part in clear solids.
    pub AbbeKeys {
        abbe_number: Option<f32> =
            positive("abbeNumber").unlike("all colours alike", "60", "how little it splits colours"),
    }
}

impl AbbeKeys {
    /// The dependence on the wavelength.
    pub fn dispersing(&self) -> Dispersing {
        match self.abbe_number {
            Some(abbe) => Dispersing::Glass(Dispersion::from_abbe(TYPICAL_INDEX, abbe.into())),
            None => Dispersing::None,
        }
    }
}

keys! {
    GradientIndexKeys {
        index: Arc<Tape> = function("index").required("index of refraction by `x`, `y` and `z` in world space"),
    }
}

pub const MEMBER: MediumMember = Member {
    block: Block {
        keyword: "GradientIndex",
        kind: Kind::Medium,
        about: "clear matter that bends light, by its index of refraction at every place",
        groups: &[GradientIndexKeys::FIELDS, AbbeKeys::FIELDS, CurveKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item| {
        compiler.medium(item, |params, sources| {
            let GradientIndexKeys { index } = GradientIndexKeys::read(params, sources)?;
            let colors = AbbeKeys::read(params, sources)?;
            let curves = CurveKeys::read(params, sources)?;
            Some(curves.medium(Profile::Function(index), colors.dispersing()))
        })
    },
};
