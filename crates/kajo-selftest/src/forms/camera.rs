//! How a lens blurs.
//!
//! A thin lens of diameter `A` in focus at distance `s` spreads a point of the picture over a disk of diameter
//! `A |z - s| / s` at distance `z`. Of an even light behind a straight edge, the pixel whose middle lies `t` radii of
//! that disk inside of the edge sees the share
//!
//! ```text
//! 1/2 + (asin t + t sqrt(1 - t^2)) / pi
//! ```

use std::f64::consts::PI;

use super::{Form, Parameters};
use crate::method::{CLASSIC, DIRECT, Method, PATH};

/// What draws places on lenses: everything.
const LENSES: &[Method] = &[PATH, DIRECT, CLASSIC];

pub fn forms(draw: &mut Parameters) -> Vec<Form> {
    vec![blurred(draw, true, false), blurred(draw, false, false), blurred(draw, false, true)]
}

fn blurred(draw: &mut Parameters, nearer: bool, parallel: bool) -> Form {
    let (aperture, focus) = (draw.between(0.1, 0.5), draw.between(3.0, 6.0));
    let z = focus * if nearer { draw.between(0.3, 0.8) } else { draw.between(1.3, 2.5) };
    let t = draw.between(-0.8, 0.8);
    let radius = 0.5 * aperture * (z - focus).abs() / focus;
    let kind = if parallel { "OrthographicCamera" } else { "PerspectiveCamera" };
    let extent = if parallel { "size 0.00001" } else { "angle 0.0001" };
    let scene = format!(
        "{kind} {{ center 0 0 0  direction 0 0 -1  up 0 1 0  {extent}  aperture {aperture}  focus {focus} }}\n\
         Background {{ color 0 0 0 }}\n\
         Materials {{ Material emitter {{ diffuseColor 0 0 0  ambientColor 1 1 1  emission 1 1 1 }} }}\n\
         Group {{ MaterialIndex emitter Quad {{ corner {} -9 -{z}  edge1 9 0 0  edge2 0 18 0 }} }}",
        -t * radius
    );
    let expected = 0.5 + (t.asin() + t * (1.0 - t * t).sqrt()) / PI;
    let name = format!("blur of an aperture of {aperture} at {z:.3}, focus at {focus}");
    Form::new(name, scene, expected, LENSES).rounding(2e-4)
}
