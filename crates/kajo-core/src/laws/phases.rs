//! Phase functions of media.

use std::f32::consts::PI;

use kajo_math::{Vec3, warp};

use super::{Census, Draw, Furnace, Who, kinds};
use crate::medium::Phase;
use crate::medium::phase::HenyeyGreenstein;

kinds!(Phase: Isotropic, HenyeyGreenstein, Rayleigh);

pub(super) fn census() -> Census {
    Census { family: "phase", kinds: KINDS.to_vec(), pointlike: &[], unpowered: &[] }
}

fn all() -> impl Iterator<Item = (Who, Phase, Vec3)> {
    let lobe = |g| Phase::HenyeyGreenstein(HenyeyGreenstein::new(g).expect("a mean cosine"));
    let phases = [Phase::Isotropic, Phase::Rayleigh, lobe(0.0), lobe(0.6), lobe(-0.8)];
    phases.into_iter().flat_map(|phase| {
        [Vec3::Z, Vec3::new(0.48, -0.6, 0.64)].map(|wo| {
            let name = format!("{phase:?} from {wo}");
            (Who { family: "phase", kind: kind(&phase), name }, phase, wo)
        })
    })
}

pub(super) fn draws() -> Vec<Draw> {
    let draw = |(who, phase, wo): (Who, Phase, Vec3)| Draw {
        who,
        draw: Box::new(move |u, _| Some(phase.sample(wo, u).wi)),
        pdf: Box::new(move |wi| phase.eval(wo, wi)),
    };
    all().map(draw).collect()
}

/// All light goes somewhere: the mean over all directions, and the value over the density of a sample.
pub(super) fn furnaces() -> Vec<Furnace> {
    let furnace = |(who, phase, wo): (Who, Phase, Vec3)| Furnace {
        who,
        energy: Box::new(move |u, uc| {
            let sample = phase.sample(wo, u);
            let of_sample = phase.eval(wo, sample.wi) / sample.pdf;
            let anywhere = 4.0 * PI * phase.eval(wo, warp::uniform_sphere(u));
            f64::from(if uc < 0.5 { of_sample } else { anywhere })
        }),
        expected: [1.0; 2],
    };
    // Uniform directions are too few for narrow lobes, whose integrals the tests of `medium/phase` hold.
    all().filter(|(_, phase, _)| phase.mean_cosine().abs() < 0.7).map(furnace).collect()
}
