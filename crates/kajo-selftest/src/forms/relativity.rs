//! Things that move at speeds not much below that of light.
//!
//! With `mu = n·v` for the direction `n` in which a thing of velocity `v` is seen, radiance of all light is multiplied by
//!
//! ```text
//! D^4,    D = 1 / (gamma (1 + mu))         of a source that moves
//!         D = 1 / (gamma (1 - mu))         for an observer who moves, mu of the direction that he sees
//! ```
//!
//! [Rybicki and Lightman 1979, 4.9]. So an observer who moves sees an even sky as bright as `D^4`; an emissive room that flies past is the room
//! at rest times `D^4`; and the irradiance of a small emitter that flies past is
//!
//! ```text
//! E = I0 D^4 cos theta / r^2,       r: to where the emitter was when the light left it
//! ```
//!
//! *A floor* that moves by `beta` along its normal under an even sky is lit, in its own frame, by
//!
//! ```text
//! E = 2 pi / gamma^4  integral from 0 to 1 of  mu / (1 - beta mu)^4 dmu
//! ```
//!
//! *A mirror* that moves by `b` along its normal, against light that comes at the angle `i`, changes its frequency and angle to
//! [Einstein 1905, 8]
//!
//! ```text
//! nu'/nu = (1 + 2 b cos i + b^2) / (1 - b^2),    cos r = ((1 + b^2) cos i + 2 b) / (1 + 2 b cos i + b^2)
//! ```

use std::f64::consts::PI;

use kajo_math::DVec3;
use kajo_math::lorentz::{FrameMap, SpacetimeEvent};

use super::quadrature::simpson;
use super::{Form, Number, Parameters, floor, floor_and_light, spot_meter, text};
use crate::method::{DIRECT, Method, PATH, PATH_LIGHTS, PATH_SCATTERING};

/// What follows light between frames, where it is drawn or met.
const ALL: &[Method] = &[PATH, PATH_SCATTERING, PATH_LIGHTS];

/// The same for emitters so small that they are hardly ever met.
const SMALL: &[Method] = &[PATH, PATH_LIGHTS, DIRECT];

/// What single precision makes of places and directions in two frames, as a share of their fourth powers.
const ROUNDING: f64 = 2e-4;

pub fn forms(draw: &mut Parameters) -> Vec<Form> {
    let mut forms =
        vec![emitter(draw), emitter(draw), emitter(draw), room(draw), room(draw), sky(draw), sky(draw)];
    forms.extend([moving_floor(draw, 1.0), moving_floor(draw, -1.0), mirror(draw), mirror(draw)]);
    forms
}

fn gamma(v: DVec3) -> f64 {
    1.0 / (1.0 - v.length_squared()).sqrt()
}

/// The Doppler factor of a source that is seen along `n`.
fn doppler(n: DVec3, v: DVec3) -> f64 {
    1.0 / (gamma(v) * (1.0 + n.dot(v)))
}

/// A velocity as the language writes it.
fn velocity(v: DVec3) -> String {
    format!("velocity {} {} {}", v.x, v.y, v.z)
}

fn emitter(draw: &mut Parameters) -> Form {
    let (rho, le) = (draw.between(0.3, 0.9), draw.between(100.0, 400.0));
    let n = draw.direction(-1.0);
    let v = draw.between(0.1, 0.9) * draw.direction(-1.0);
    let across = n.any_orthonormal_vector();
    // Where it was when the light left it.
    let (cos, r) = (draw.between(0.4, 0.95), draw.between(2.0, 4.0));
    let seen = cos * n + (1.0 - cos * cos).sqrt() * n.cross(across);
    let eye = 0.02 * (n + 0.5 * across);
    let moment = draw.between(-2.0, 2.0);
    let left = moment - eye.length() - r;
    let start = r * seen - v * left;
    let radius = 0.004 * r;
    let meter = spot_meter(eye, DVec3::ZERO).replacen('{', &format!("{{ worldTime {moment} "), 1);
    let [x, y, z] = start.to_array();
    let scene = format!(
        "{meter}{}Group {{ {} MaterialIndex emitter Lorentz {{ {} Translate {x} {y} {z} \
         Sphere {{ center 0 0 0 radius {radius} }} }} }}",
        floor_and_light(rho, le),
        floor(n),
        velocity(v),
    );
    let irradiance = le * PI * radius * radius * doppler(seen, v).powi(4) * cos / (r * r);
    let name = format!("emitter that flies past at {:.4}", v.length());
    Form::new(name, scene, rho / PI * irradiance, SMALL).rounding(5e-4).bounces(0)
}

fn room(draw: &mut Parameters) -> Form {
    let (rho, le) = (draw.between(0.2, 0.7), draw.between(0.5, 4.0));
    let v = draw.between(0.1, 0.9) * draw.direction(-1.0);
    let (from, n) = (draw.point(0.1), draw.direction(-1.0));
    let scene = format!(
        "{}Materials {{ Material m {{ diffuseColor {rho} {rho} {rho}  emission {le} {le} {le} }} }}\n\
         Group {{ MaterialIndex m  Lorentz {{ {} Sphere {{ center 0 0 0 radius 1 }} }} }}",
        spot_meter(from, from + n),
        velocity(v),
    );
    let expected = doppler(n, v).powi(4) * le / (1.0 - rho);
    Form::new(format!("emissive room that moves at {:.4}", v.length()), scene, expected, ALL)
        .bounces(200)
        .rounding(ROUNDING)
}

fn sky(draw: &mut Parameters) -> Form {
    let (l, v) = (draw.between(0.5, 4.0), draw.between(0.1, 0.99) * draw.direction(-1.0));
    let (from, n) = (draw.point(2.0), draw.direction(-1.0));
    let meter = spot_meter(from, from + n)
        .replacen('{', &format!("{{ {} ", velocity(v)), 1)
        .replace("color 0 0 0", &format!("color {l} {l} {l}"));
    let expected = l * doppler(n, -v).powi(4);
    let name = format!("even sky for a camera that moves at {:.4}", v.length());
    Form::new(name, meter, expected, &[PATH]).rounding(ROUNDING)
}

fn moving_floor(draw: &mut Parameters, side: f64) -> Form {
    let (rho, l) = (draw.between(0.3, 0.9), draw.between(0.5, 4.0));
    let (n, beta) = (draw.direction(-1.0), side * draw.between(0.1, 0.5));
    let eye = n + draw.between(0.2, 1.5) * n.any_orthonormal_vector();
    let v = beta * n;
    let scene = format!(
        "{}{}Group {{ MaterialIndex floor Lorentz {{ {} Plane {{ normal {} offset 0 }} }} }}",
        spot_meter(eye, DVec3::ZERO).replace("color 0 0 0", &format!("color {l} {l} {l}")),
        floor_and_light(rho, 1.0),
        velocity(v),
        text(n),
    );
    let lit = simpson(0.0, 1.0, 2000, |mu| mu / (1.0 - beta * mu).powi(4));
    let irradiance = l * 2.0 * PI / gamma(v).powi(4) * lit;
    let expected = rho / PI * irradiance * doppler(-eye.normalize(), v).powi(4);
    Form::new(format!("floor that moves under the sky at {beta}"), scene, expected, ALL)
        .bounces(1)
        .rounding(ROUNDING)
}

fn mirror(draw: &mut Parameters) -> Form {
    let (b, l) = (draw.between(0.05, 0.8), draw.between(0.5, 4.0));
    let cos = draw.between(0.1, 0.99);
    let n = draw.direction(-1.0);
    let [ratio, cos_out] = mirrored(b, cos);
    let eye = 3.0 * (cos_out * n + (1.0 - cos_out * cos_out).sqrt() * n.any_orthonormal_vector());
    let scene = format!(
        "{}Materials {{ Material mirror {{ diffuseColor 0 0 0  reflectiveColor 1 1 1 }} }}\n\
         Group {{ MaterialIndex mirror Lorentz {{ {} Plane {{ normal {} offset 0 }} }} }}",
        spot_meter(eye, DVec3::ZERO).replace("color 0 0 0", &format!("color {l} {l} {l}")),
        velocity(b * n),
        text(n),
    );
    Form::new(format!("mirror that moves at {b}"), scene, l * ratio.powi(4), &[PATH, DIRECT])
        .bounces(1)
        .rounding(ROUNDING)
}

/// The ratio of frequencies and the cosine of reflection of light that comes to a mirror under an angle.
fn mirrored(b: f64, cos: f64) -> [f64; 2] {
    let sum = 1.0 + 2.0 * b * cos + b * b;
    [sum / (1.0 - b * b), ((1.0 + b * b) * cos + 2.0 * b) / sum]
}

/// Aberration, Doppler factors, the sum of velocities and moving mirrors, by the transformation that rays are mapped with.
pub fn numbers() -> Vec<Number> {
    let mut numbers = Vec::new();
    let origin = SpacetimeEvent { t: 0.0, x: DVec3::ZERO };
    let boost = |b: f64| FrameMap::boost(b * DVec3::X, origin).unwrap_or(FrameMap::IDENTITY);
    let towards = |degrees: f64| {
        let angle = degrees.to_radians();
        DVec3::new(angle.cos(), angle.sin(), 0.0)
    };
    let angle_of = |d: DVec3| d.y.atan2(d.x).to_degrees();
    let mut number = |name: String, expected: f64, measured: f64| {
        let tolerance = 1e-9 * expected.abs().max(1.0);
        numbers.push(Number { name, expected, measured, tolerance });
    };
    for b in [0.5f64, 0.9, 0.99] {
        for degrees in [30.0, 60.0, 90.0, 120.0, 150.0f64] {
            let half = ((1.0 - b) / (1.0 + b)).sqrt() * (0.5 * degrees.to_radians()).tan();
            let seen = angle_of(boost(b).light(towards(degrees)));
            number(format!("aberration of {degrees} degrees at {b}"), 2.0 * half.atan().to_degrees(), seen);
        }
        for degrees in [0.0, 90.0, 180.0f64] {
            let expected = (1.0 - b * b).sqrt() / (1.0 - b * degrees.to_radians().cos());
            let found = 1.0 / boost(b).inverse().light(towards(degrees)).length();
            number(format!("Doppler factor at {b}, {degrees} degrees"), expected, found);
        }
    }
    for [a, b] in [[0.5, 0.5], [0.9, 0.9], [0.99, -0.5]] {
        let found = boost(b).after(&boost(a)).velocity().x;
        number(format!("sum of the velocities {a} and {b}"), (a + b) / (1.0 + a * b), found);
    }
    for (b, degrees) in [(0.5, 45.0), (0.5, 0.0), (0.9, 60.0f64)] {
        let [ratio, cos] = mirrored(b, degrees.to_radians().cos());
        let met = boost(b).light(towards(degrees));
        let out = -boost(b).inverse().light(-DVec3::new(met.x, -met.y, 0.0));
        number(format!("frequency from a mirror that moves at {b}, {degrees} degrees"), ratio, out.length());
        number(format!("angle of it, {degrees} degrees"), cos.acos().to_degrees(), -angle_of(out));
    }
    numbers
}
