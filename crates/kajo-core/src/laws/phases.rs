//! Phase functions of media.

use std::f32::consts::PI;
use std::sync::Arc;

use kajo_math::{Vec3, warp};

use super::{Census, Draw, Furnace, Who, kinds};
use crate::medium::Phase;
use crate::medium::phase::{HenyeyGreenstein, MiePhase, PhaseAngle, PhaseTable};

kinds!(Phase: Isotropic, HenyeyGreenstein, Rayleigh, Mie, Table);

pub(super) fn census() -> Census {
    // All lobes of droplets are narrow; see `furnaces`.
    Census { family: "phase", kinds: KINDS.to_vec(), pointlike: &[], unpowered: &["Mie"] }
}

/// Forwards, with a peak backwards.
const RAINBOW: &[(f32, f32)] =
    &[(0.0, 9.0), (15.0, 4.0), (60.0, 0.5), (130.0, 0.2), (142.0, 2.0), (180.0, 0.3)];
/// Nothing straight on.
const SIDEWAYS: &[(f32, f32)] = &[(0.0, 0.0), (40.0, 2.0), (80.0, 0.0), (100.0, 0.0), (180.0, 1.0)];

fn all() -> impl Iterator<Item = (Who, Phase, Vec3)> {
    let lobe = |g| Phase::HenyeyGreenstein(HenyeyGreenstein::new(g).expect("a mean cosine"));
    let droplets = |diameter| Phase::Mie(MiePhase::new(diameter).expect("a diameter"));
    let mut phases = vec![Phase::Isotropic, Phase::Rayleigh, lobe(0.0), lobe(0.6), lobe(-0.8)];
    phases.extend([droplets(5.0), droplets(20.0)]);
    for pairs in [RAINBOW, SIDEWAYS] {
        let table = PhaseTable::new(pairs, PhaseAngle::Degrees).expect("a table");
        phases.push(Phase::Table(Arc::new(table)));
    }
    phases.into_iter().flat_map(|phase| {
        [Vec3::Z, Vec3::new(0.48, -0.6, 0.64)].map(|wo| {
            let name = format!("{phase:?} from {wo}");
            (Who { family: "phase", kind: kind(&phase), name }, phase.clone(), wo)
        })
    })
}

pub(super) fn draws() -> Vec<Draw> {
    let draw = |(who, phase, wo): (Who, Phase, Vec3)| {
        let drawn = phase.clone();
        Draw {
            who,
            draw: Box::new(move |u, _| Some(drawn.sample(wo, u).wi)),
            pdf: Box::new(move |wi| phase.eval(wo, wi)),
        }
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
