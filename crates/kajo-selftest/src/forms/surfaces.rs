//! Directional albedos: surfaces under an even sky.
//!
//! A surface of value `f` under a sky of radiance 1 has the radiance `E(theta) = integral f cos dw`. For Phong's lobe,
//!
//! ```text
//! E = rho_d + rho_s (n + 2) / 2 pi  integral  max(0, r . w)^n cos  dw
//! ```
//!
//! with `r` the mirror direction; the integral over the hemisphere is done by Simpson's rule in both angles.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use kajo_math::DVec3;

use super::lights::SKIES;
use super::quadrature::simpson;
use super::{Form, Parameters, spot_meter, text};

pub fn forms(draw: &mut Parameters) -> Vec<Form> {
    vec![glossy(draw, [1.0, 10.0]), glossy(draw, [10.0, 60.0])]
}

fn glossy(draw: &mut Parameters, [least, most]: [f64; 2]) -> Form {
    let (diffuse, specular) = (draw.between(0.1, 0.4), draw.between(0.2, 0.5));
    let (exponent, sky) = (draw.between(least, most).round(), draw.between(0.5, 2.0));
    let angle = draw.between(10.0, 75.0).to_radians();
    let (sin, cos) = angle.sin_cos();
    let scene = format!(
        "{}Materials {{ Material gloss {{ diffuseColor {diffuse} {diffuse} {diffuse}\n\
         specularColor {specular} {specular} {specular}  exponent {exponent} }} }}\n\
         Group {{ MaterialIndex gloss Disk {{ center 0 0 0  normal 0 1 0  radius 1 }} }}",
        spot_meter(2.0 * DVec3::new(sin, cos, 0.0), DVec3::ZERO)
            .replace("color 0 0 0", &format!("color {}", text(DVec3::splat(sky))))
    );
    let over = |theta: f64| {
        let (st, ct) = theta.sin_cos();
        let lobe = |phi: f64| (ct * cos - st * sin * phi.cos()).max(0.0).powf(exponent);
        2.0 * simpson(0.0, PI, 200, lobe) * ct * st
    };
    let lobe = (exponent + 2.0) / TAU * simpson(0.0, FRAC_PI_2, 400, over);
    let expected = sky * (diffuse + specular * lobe);
    let name = format!("gloss of exponent {exponent} at {:.1} degrees", angle.to_degrees());
    Form::new(name, scene, expected, SKIES).bounces(0)
}
