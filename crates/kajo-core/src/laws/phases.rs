//! Phase functions of media.

use std::f32::consts::PI;
use std::sync::Arc;

use kajo_color::Wavelengths;
use kajo_math::{Vec3, warp};

use super::{Census, Draw, Furnace, Who, kinds};
use crate::medium::Phase;
use crate::medium::phase::{HenyeyGreenstein, MiePhase, PhaseAngle, PhaseColumns, PhaseRows, PhaseTable};

kinds!(Phase: Isotropic, HenyeyGreenstein, Rayleigh, Mie, Table, ColorTable);

pub(super) fn census() -> Census {
    // All lobes of droplets are narrow; see `furnaces`.
    Census { family: "phase", kinds: KINDS.to_vec(), pointlike: &[], unpowered: &["Mie"] }
}

/// Forwards, with a peak backwards.
const RAINBOW: &[(f32, f32)] =
    &[(0.0, 9.0), (15.0, 4.0), (60.0, 0.5), (130.0, 0.2), (142.0, 2.0), (180.0, 0.3)];
/// Nothing straight on.
const SIDEWAYS: &[(f32, f32)] = &[(0.0, 0.0), (40.0, 2.0), (80.0, 0.0), (100.0, 0.0), (180.0, 1.0)];

/// Rows of an angle and three values; blue goes nowhere forwards.
const RAINBOWS: &[f32] = &[
    0.0, 9.0, 3.0, 0.0, //
    30.0, 2.0, 2.0, 1.0, //
    90.0, 0.2, 0.5, 1.0, //
    138.0, 0.3, 0.9, 2.0, //
    142.0, 2.0, 0.4, 0.3, //
    180.0, 0.3, 0.2, 0.1,
];

/// A phase function at some wavelengths, of which one lane draws.
#[derive(Clone)]
struct Case {
    phase: Phase,
    wo: Vec3,
    wavelengths: Wavelengths,
    lane: u32,
}

impl Case {
    /// The value of the lane that draws.
    fn value(&self, wi: Vec3) -> f32 {
        self.phase.at(&self.wavelengths).eval(self.wo, wi).value()[self.lane as usize]
    }
}

fn all() -> impl Iterator<Item = (Who, Case)> {
    let lobe = |g| Phase::HenyeyGreenstein(HenyeyGreenstein::new(g).expect("a mean cosine"));
    let droplets = |diameter| Phase::Mie(MiePhase::new(diameter).expect("a diameter"));
    let mut phases = vec![Phase::Isotropic, Phase::Rayleigh, lobe(0.0), lobe(0.6), lobe(-0.8)];
    phases.extend([droplets(5.0), droplets(20.0)]);
    for pairs in [RAINBOW, SIDEWAYS] {
        let table = PhaseTable::new(pairs, PhaseAngle::Degrees).expect("a table");
        phases.push(Phase::Table(Arc::new(table)));
    }
    let grey = phases.into_iter().map(|phase| (phase, Wavelengths::RGB, 0));
    let rows = PhaseRows::new(3, RAINBOWS).expect("rows");
    let spectral = PhaseColumns::Wavelengths(vec![440.0, 540.0, 640.0]);
    let colored = [PhaseColumns::Rgb, spectral].into_iter().flat_map(move |columns| {
        let phase = Phase::by_numbers(&columns, &rows, PhaseAngle::Degrees).expect("a table");
        let some = Wavelengths::sample(0.2);
        [(Wavelengths::RGB, 0), (Wavelengths::RGB, 2), (some, 0), (some, 1), (some, 3)]
            .map(|(wavelengths, lane)| (phase.clone(), wavelengths, lane))
    });
    grey.chain(colored).flat_map(|(phase, wavelengths, lane)| {
        [Vec3::Z, Vec3::new(0.48, -0.6, 0.64)].map(|wo| {
            let name = format!("{phase:?} from {wo}, lane {lane} of {:?}", wavelengths.nm());
            let case = Case { phase: phase.clone(), wo, wavelengths, lane };
            (Who { family: "phase", kind: kind(&phase), name }, case)
        })
    })
}

pub(super) fn draws() -> Vec<Draw> {
    let draw = |(who, case): (Who, Case)| {
        let drawn = case.clone();
        Draw {
            who,
            draw: Box::new(move |u, _| {
                Some(drawn.phase.at(&drawn.wavelengths).sample(drawn.wo, u, drawn.lane).wi)
            }),
            pdf: Box::new(move |wi| case.value(wi)),
        }
    };
    all().map(draw).collect()
}

/// All light goes somewhere: the mean over all directions, and the value over the density of a sample.
pub(super) fn furnaces() -> Vec<Furnace> {
    let furnace = |(who, case): (Who, Case)| Furnace {
        who,
        energy: Box::new(move |u, uc| {
            let sample = case.phase.at(&case.wavelengths).sample(case.wo, u, case.lane);
            let drawn = sample.value.value()[case.lane as usize];
            let of_sample = case.value(sample.wi) / drawn;
            let anywhere = 4.0 * PI * case.value(warp::uniform_sphere(u));
            f64::from(if uc < 0.5 { of_sample } else { anywhere })
        }),
        expected: [1.0; 2],
    };
    // Uniform directions are too few for narrow lobes, whose integrals the tests of `medium/phase` hold.
    all().filter(|(_, case)| case.phase.mean_cosine().abs() < 0.7).map(furnace).collect()
}
