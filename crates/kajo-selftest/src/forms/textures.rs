//! Textured floors under an even sky, seen from above over whole periods: pictures by every filter, and ramps of patterns, filtered and not.
//!
//! Under a sky of radiance `L` the mean radiance is `L` times the mean albedo, that of all texels, or of the ramp `f` over all numbers:
//!
//! ```text
//! checks      (f(0) + f(1)) / 2
//! gradient    integral of f from 0 to 1
//! ```
//!
//! because a wave of triangles is anything from 0 to 1 alike. No filter may change that.

use kajo_math::DVec3;

use super::{Form, Parameters, text};
use crate::method::{DIRECT, DISTRIBUTION_COSINE, Method, PATH, PATH_SCATTERING, PATH_SPECTRAL};

/// What follows footprints from the camera.
const FOLLOWING: &[Method] = &[PATH, PATH_SCATTERING, PATH_SPECTRAL, DIRECT, DISTRIBUTION_COSINE];

/// Pixels of a picture, so that what a sample covers is a part of a period.
const GRID: [u32; 2] = [16, 16];

/// By how much the mean of what is filtered may be off: weights are made to add up for each sample and not for each texel, and numbers are taken
/// for even within a footprint.
const FILTERED: f64 = 4e-3;

const FILTERS: [&str; 8] =
    ["nearest", "bilinear", "bicubic", "trilinear", "sat", "ewa", "feline", "stochastic"];

pub fn forms(draw: &mut Parameters) -> Vec<Form> {
    let mut forms: Vec<Form> = FILTERS.into_iter().map(|filter| picture(draw, filter)).collect();
    for filter in ["off", "on"] {
        forms.extend([checks(draw, filter), gradient(draw, filter)]);
    }
    forms
}

/// A floor of the material `m`, of which a square of side 4 is seen from above; surface coordinates go from 0 to 1 over twice that.
fn floor(sky: f64, textures: &str, color: &str) -> String {
    format!(
        "OrthographicCamera {{ center 0 1.2 0  direction 0 -1 0  up 0 0 1  size 4 }}
         Background {{ color {} }}
         {textures}
         Materials {{ Matte m {{ color {color} }} }}
         Group {{ MaterialIndex m Quad {{ corner -4 0.2 4  edge1 8 0 0  edge2 0 0 -8 }} }}",
        text(DVec3::splat(sky))
    )
}

fn rounding(form: Form, is_filtered: bool) -> Form {
    if is_filtered { form.rounding(FILTERED) } else { form }
}

fn picture(draw: &mut Parameters, filter: &str) -> Form {
    let sky = draw.between(0.5, 2.0);
    // Shares of 255 that cubics between them keep in range.
    let texels: Vec<u64> = (0..16).map(|_| 60 + draw.index(130) as u64).collect();
    let mean = texels.iter().sum::<u64>() as f64 / (16.0 * 255.0);
    let lines: Vec<String> = texels.iter().map(u64::to_string).collect();
    let file = format!("P2\n4 4\n255\n{}\n", lines.join(" "));
    let color = format!("tile.pgm {{ filter {filter}  repeat 8  encoding linear }}");
    let is_filtered = !matches!(filter, "nearest" | "bilinear" | "bicubic");
    let form =
        Form::new(format!("floor with a picture, {filter}"), floor(sky, "", &color), mean * sky, FOLLOWING);
    rounding(form.file("tile.pgm", file).size(GRID).bounces(0), is_filtered)
}

/// A pattern in two greys.
fn checks(draw: &mut Parameters, filter: &str) -> Form {
    let sky = draw.between(0.5, 2.0);
    let [dark, light, edge] = [[0.1, 0.4], [0.5, 0.9], [0.1, 0.9]].map(|[lo, hi]| draw.between(lo, hi));
    let textures = format!(
        "Textures {{ Ramp t {{ texture c  interpolation step  stop 0 {dark} {dark} {dark}  stop {edge} {light} {light} {light} }}
           Checks c {{ size 0.5  filter {filter} }} }}"
    );
    let name = format!("floor of two greys, filter {filter}");
    let form = Form::new(name, floor(sky, &textures, "t"), 0.5 * (dark + light) * sky, FOLLOWING);
    rounding(form.size(GRID).bounces(0), filter == "on")
}

/// A wave in greys with an edge.
fn gradient(draw: &mut Parameters, filter: &str) -> Form {
    let sky = draw.between(0.5, 2.0);
    let [a, b, c, d] = [0; 4].map(|_| draw.between(0.1, 0.9));
    let edge = draw.between(0.2, 0.8);
    let stops = [(0.0, a), (edge, b), (edge, c), (1.0, d)].map(|(at, v)| format!("stop {at} {v} {v} {v}  "));
    let textures = format!(
        "Textures {{ Ramp t {{ texture g  {} }} Gradient g {{ size 4  filter {filter} }} }}",
        stops.concat()
    );
    let mean = 0.5 * (edge * (a + b) + (1.0 - edge) * (c + d));
    let name = format!("floor with a ramp, filter {filter}");
    let form = Form::new(name, floor(sky, &textures, "t"), mean * sky, FOLLOWING);
    rounding(form.size(GRID).bounces(0), filter == "on")
}
