//! The rainbow of one drop [Descartes 1637].
//!
//! Parallel rays fall on a drop of index `n` and radius 1. The ray at distance `b` from the axis enters under the angle
//! `i`, `sin i = b`, is reflected `k` times within and leaves, turned in all by
//!
//! ```text
//! 2 (i - r) + k (pi - 2 r),    sin r = b / n
//! ```
//!
//! For `k` = 1 no ray comes back further from the direction of the light than the bow's radius, and near it the light
//! piles up; for `k` = 2 none comes back nearer. A ring-shaped light far away in that direction covers the bow's edge. The
//! share of light that the picture of the drop gets from the emitter is the integral over `b` of all `k` whose rays meet
//! it. The drop lets half of the light through and mirrors half at each meeting, so that rays of order `k`
//! carry `1/2^(k+2)`, and those mirrored outside `1/2`.
//!
//! The ring stands by published radii of bows in water of 20 °C; the scene has the index that the program knows.

use std::f64::consts::{PI, TAU};

use kajo_color::named;

use super::{Form, Parameters};
use crate::method::{DIRECT, Method, PATH};

/// What follows mirrors and glass, and can look at the emitter's light.
const METHODS: &[Method] = &[PATH, DIRECT];

/// Meetings of a ray with the surface that are followed.
const BOUNCES: u32 = 12;

/// How far away the light is, in radii of the drop.
const FAR: f64 = 1000.0;

/// Side of the picture, in radii of the drop.
const FRAME: f64 = 2.2;

pub fn forms(draw: &mut Parameters) -> Vec<Form> {
    BOWS.iter().map(|bow| form(draw, bow)).collect()
}

/// A bow in one of Fraunhofer's lines.
struct Bow {
    line: &'static str,
    nm: f64,
    /// Published index of water.
    index: f64,
    /// Its radius.
    degrees: f64,
    /// Reflections within the drop: the light is inside of the primary bow and outside of the secondary.
    reflections: u32,
}

const BOWS: [Bow; 4] = [
    Bow { line: "C", nm: 656.2725, index: 1.331_513, degrees: 42.295, reflections: 1 },
    Bow { line: "F", nm: 486.1327, index: 1.337_492, degrees: 41.429, reflections: 1 },
    Bow { line: "C", nm: 656.2725, index: 1.331_513, degrees: 50.500, reflections: 2 },
    Bow { line: "F", nm: 486.1327, index: 1.337_492, degrees: 52.061, reflections: 2 },
];

fn form(draw: &mut Parameters, bow: &Bow) -> Form {
    let Bow { line, nm, index, degrees, reflections } = *bow;
    let dark = draw.between(0.5, 2.0);
    // Less light is in the secondary bow, so more of it is looked at.
    let [from, to] = match reflections {
        1 => [degrees - draw.between(0.4, 1.5), degrees + dark],
        _ => [degrees - dark, degrees + draw.between(2.0, 5.0)],
    };
    let ring = [from, to].map(|degrees| FAR * degrees.to_radians().tan());
    let water = named::glass("water").map_or(f64::NAN, |water| water.index(nm));
    let scene = format!(
        "OrthographicCamera {{ center 0 0 -5  direction 0 0 1  up 0 1 0  size {FRAME} }}\n\
         Background {{ color 0 0 0 }}\n\
         Materials {{\n  Material water {{ diffuseColor 0 0 0  reflectiveColor 0.5 0.5 0.5\n    \
         transparentColor 0.5 0.5 0.5  indexOfRefraction {water} }}\n  \
         Material emitter {{ diffuseColor 0 0 0  emission 1 1 1 }}\n}}\n\
         Group {{ MaterialIndex water Sphere {{ center 0 0 0  radius 1 }}\n\
         MaterialIndex emitter Disk {{ center 0 0 -{FAR}  normal 0 0 1  radius {}  innerRadius {} }} }}",
        ring[1], ring[0]
    );
    let name = format!(
        "{} rainbow of water, line {line}, radius {degrees} degrees",
        if reflections == 1 { "primary" } else { "secondary" }
    );
    Form::new(name, scene, share(index, ring), METHODS).bounces(BOUNCES).size([16, 16]).rounding(1e-3)
}

/// Light of the ring over that of the picture.
fn share(n: f64, [inner, outer]: [f64; 2]) -> f64 {
    const STEPS: u32 = 200_000;
    let rays = |step: u32| {
        let b = (f64::from(step) + 0.5) / f64::from(STEPS);
        let orders = (0..=BOUNCES - 2).map(|k| (place(n, b, Some(k)), 0.5f64.powi(k as i32 + 2)));
        let outside = std::iter::once((place(n, b, None), 0.5));
        let met = orders.chain(outside).filter(|(r, _)| r.is_some_and(|r| (inner..outer).contains(&r)));
        b * met.map(|(_, weight)| weight).sum::<f64>()
    };
    TAU / (FRAME * FRAME) * (0..STEPS).map(rays).sum::<f64>() / f64::from(STEPS)
}

/// Distance from the axis at which the ray of distance `b` meets the light's plane, after so many reflections
/// within the drop, or one outside; `None` where it goes the other way.
fn place(n: f64, b: f64, reflections: Option<u32>) -> Option<f64> {
    let (i, r) = (b.asin(), (b / n).asin());
    // All angles are taken from the middle of the drop, in the ray's plane; the ray arrives along angle 0.
    let (turned, left_at) = match reflections {
        None => (2.0 * i - PI, PI - i),
        Some(k) => {
            let chords = f64::from(k + 1) * (PI - 2.0 * r);
            (chords + 2.0 * i - PI, PI - i - chords)
        }
    };
    // The ray arrives at the angle pi - i and each chord takes the point of its end on by pi - 2 r.
    let (sin, cos) = turned.sin_cos();
    let (along, aside) = (left_at.cos(), left_at.sin());
    let steps = (-FAR - along) / cos;
    (steps > 0.0).then(|| (aside - steps * sin).abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bows_have_their_published_radii() {
        for bow in &BOWS {
            // Directions only: the drop is as good as a point.
            let radii = (1..10_000).filter_map(|i| {
                let r = place(bow.index, f64::from(i) / 10_000.0, Some(bow.reflections))?;
                Some((r / FAR).atan().to_degrees())
            });
            let edge = match bow.reflections {
                1 => radii.fold(0.0, f64::max),
                _ => radii.fold(90.0, f64::min),
            };
            assert!((edge - bow.degrees).abs() < 0.06, "{edge} for {}", bow.degrees);
        }
    }
}
