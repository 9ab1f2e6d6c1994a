//! One list of everything that draws directions: lobes, materials, lights and cameras.
//!
//! Two laws hold for all of them:
//!
//! * directions follow their density, `P(w in A) = integral of pdf over A`, by a chi-square test [Subr and Arvo 2007];
//! * no light is made, and where nothing absorbs none is lost: the mean of `value / pdf` is the known power, 1 in a white
//!   furnace.
//!
//! A new kind has to come with an entry, or [`nobody_is_left_out`] fails. Variants of an enum are counted by a
//! `match`, members of a family by their pools.

mod cameras;
mod lights;
mod lobes;
mod materials;
mod phases;

use std::collections::BTreeSet;
use std::fmt;

use kajo_math::{Vec2, Vec3};
use kajo_testkit::sphere;

use crate::bsdf::tests::list::deep;

/// Who an entry of the list is about.
#[derive(Clone)]
struct Who {
    family: &'static str,
    kind: &'static str,
    /// What it is like.
    name: String,
}

impl fmt::Display for Who {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}, {}", self.family, self.kind, self.name)
    }
}

/// Directions drawn at random, and their density.
struct Draw {
    who: Who,
    /// A unit direction for `u` and another uniform number; `None` where there is none that has a density.
    draw: Box<dyn Fn(Vec2, f32) -> Option<Vec3>>,
    /// Density per solid angle.
    pdf: Box<dyn Fn(Vec3) -> f32>,
}

/// Power that is sent on, a share of what came in or of what is known.
struct Furnace {
    who: Who,
    /// What one sample sends on, for `u` and another uniform number.
    energy: Box<dyn Fn(Vec2, f32) -> f64>,
    /// What the mean is at least, and at most.
    expected: [f64; 2],
}

/// All kinds of a family, and those of them that have no entry among the draws or among the furnaces.
struct Census {
    family: &'static str,
    kinds: Vec<&'static str>,
    /// Kinds that scatter or shine into single directions only, which have no density.
    pointlike: &'static [&'static str],
    /// Kinds whose power is not known in a closed form.
    unpowered: &'static [&'static str],
}

/// Lists the variants of an enum and says which one a value is. A variant that is not listed does not compile.
macro_rules! kinds {
    ($Enum:ident: $($Kind:ident),+ $(,)?) => {
        const KINDS: &[&str] = &[$(stringify!($Kind)),+];

        fn kind(value: &$Enum) -> &'static str {
            match value {
                $($Enum::$Kind { .. } => stringify!($Kind),)+
            }
        }
    };
}
use kinds;

fn draws() -> Vec<Draw> {
    let all = [lobes::draws(), materials::draws(), phases::draws(), lights::draws(), cameras::draws()];
    all.into_iter().flatten().collect()
}

fn furnaces() -> Vec<Furnace> {
    let surfaces = [lobes::furnaces(), materials::furnaces(), phases::furnaces()];
    surfaces.into_iter().chain([lights::furnaces(), cameras::furnaces()]).flatten().collect()
}

#[test]
fn nobody_is_left_out() {
    let drawn: BTreeSet<_> = draws().iter().map(|draw| (draw.who.family, draw.who.kind)).collect();
    let powered: BTreeSet<_> =
        furnaces().iter().map(|furnace| (furnace.who.family, furnace.who.kind)).collect();
    let all = [lobes::census(), materials::census(), phases::census(), lights::census(), cameras::census()];
    for census in all {
        for kind in census.kinds {
            let who = (census.family, kind);
            assert_eq!(drawn.contains(&who), !census.pointlike.contains(&kind), "{who:?}");
            assert_eq!(powered.contains(&who), !census.unpowered.contains(&kind), "{who:?}");
        }
    }
}

#[test]
fn directions_follow_their_density() {
    let n = if deep() { 100_000 } else { 10_000 };
    let draws = draws();
    let tests = draws.len() as u32;
    let wrong = draws.iter().enumerate().filter_map(|(i, Draw { who, draw, pdf })| {
        let result = sphere::test(n, i as u64, draw, pdf);
        (!result.passes(0.01, tests)).then(|| format!("{who}: {result:?}"))
    });
    assert_eq!(wrong.collect::<Vec<_>>(), Vec::<String>::new());
}

#[test]
fn no_light_is_made_and_none_is_lost() {
    let side = if deep() { 256 } else { 64 };
    // Fewer samples are noisier.
    let noise = if deep() { 0.001 } else { 0.004 };
    let wrong = furnaces().into_iter().filter_map(|Furnace { who, energy, expected: [least, most] }| {
        let mean = sphere::stratified_mean(side, 9, energy);
        let right = (least - noise..=most + noise).contains(&mean);
        (!right).then(|| format!("{who}: {mean} for {least} to {most}"))
    });
    assert_eq!(wrong.collect::<Vec<_>>(), Vec::<String>::new());
}
