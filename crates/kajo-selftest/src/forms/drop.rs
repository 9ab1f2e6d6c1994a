//! Where the light goes that falls on a drop.
//!
//! Parallel rays meet a drop of index `n` and radius 1 at distances `b` from its axis, with `sin i = b = n sin r`. With the mean
//! `F` of Fresnel's terms for both polarisations, the share of them that is mirrored outside, and of those that are mirrored `k` times
//! inside before they leave, is
//!
//! ```text
//! integral of  F 2 b db,      integral of  (1 - F)^2 F^k 2 b db
//! ```
//!
//! Seen along parallel rays before an even sky, with light that meets surfaces `n` times at most, the drop is as bright as the
//! first `n` of these together. For water, n = 1.333, they are 0.06641, 0.88144, 0.04392 and 0.00555.

use std::f64::consts::{FRAC_PI_2, PI};

use super::quadrature::simpson;
use super::{Form, Parameters};
use crate::method::{BIDIRECTIONAL, DIRECT, Method, PATH, PATH_SPECTRAL, SHARED_PHOTONS};

/// What counts mirrors among its bounces.
const METHODS: &[Method] = &[PATH, PATH_SPECTRAL, BIDIRECTIONAL, DIRECT];

/// Side of the picture, in radii of the drop.
const FRAME: f64 = 2.1;

pub fn forms(draw: &mut Parameters) -> Vec<Form> {
    let mut forms: Vec<Form> = [1, 2, 3, 4].map(|meetings| form(draw, meetings)).into();
    let by_photons = |form: &Form| form.by("photons", SHARED_PHOTONS);
    let shared: Vec<Form> = forms.iter().flat_map(|form| [by_photons(form), form.chained()]).collect();
    forms.extend(shared);
    forms
}

fn form(draw: &mut Parameters, meetings: u32) -> Form {
    let (n, sky) = (draw.between(1.3, 1.6), draw.between(0.5, 4.0));
    let scene = format!(
        "OrthographicCamera {{ center 0 0 -5  direction 0 0 1  up 0 1 0  size {FRAME} }}\n\
         Background {{ color {sky} {sky} {sky} }}\nMaterials {{ Glass water {{ indexOfRefraction {n} }} }}\n\
         Group {{ MaterialIndex water Sphere {{ center 0 0 0  radius 1 }} }}"
    );
    let seen: f64 = (0..meetings).map(|order| share(n, order)).sum();
    let covered = PI / (FRAME * FRAME);
    let name = format!("S14 drop of index {n}, light that meets its surface {meetings} times at most");
    Form::new(name, scene, sky * (1.0 - covered + covered * seen), METHODS)
        .bounces(meetings - 1)
        .size([16, 16])
}

/// The share of light that is mirrored outside, for `order` 0, or leaves after `order - 1` reflections inside.
fn share(n: f64, order: u32) -> f64 {
    simpson(0.0, FRAC_PI_2, 2000, |i| {
        let (b, ci) = i.sin_cos();
        let cr = (1.0 - (b / n).powi(2)).sqrt();
        let (s, p) = ((ci - n * cr) / (ci + n * cr), (n * ci - cr) / (n * ci + cr));
        let f = 0.5 * (s * s + p * p);
        let share = if order == 0 { f } else { (1.0 - f).powi(2) * f.powi(order as i32 - 1) };
        2.0 * b * ci * share
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shares_are_the_known_ones() {
        for (n, shares) in [
            (1.333, [0.066_41, 0.881_44, 0.043_92, 0.005_55, 0.001_47]),
            (1.5, [0.091_78, 0.835_54, 0.061_18, 0.007_99, 0.001_97]),
        ] {
            for (order, expected) in (0..).zip(shares) {
                let found = share(n, order);
                assert!((found - expected).abs() < 6e-6, "{n} {order}: {found} for {expected}");
            }
            // At grazing angles light goes around for long.
            assert!(((0..1000).map(|order| share(n, order)).sum::<f64>() - 1.0).abs() < 1e-6);
        }
    }
}
