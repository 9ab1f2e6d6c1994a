//! Black holes and wormholes.
//!
//! *An even sky* of radiance `L` around a hole of mass `M` without spin has to somebody at rest, wherever the hole is not, the radiance
//! `L (1 - 2M/r)^-2`.
//!
//! *A light behind a hole.* Light of impact parameter `b` goes from the radius `r1` by way of its closest approach to `r2` through an
//! angle that is an elliptic integral [Darwin 1959]. Somebody at rest at `r1` looks along it at the angle of
//! `sin a = b sqrt(1 - 2M/r1) / r1` to the hole, and sees the light at `r2` with its radiance times `((1 - 2M/r2) / (1 - 2M/r1))^2`.
//!
//! *Orbits and falls.* An even sky to somebody on an orbit or in free fall has besides the fourth power of the Doppler shift of the
//! velocity `sqrt(M/(r - 2M))` or `sqrt(2M/r)`. In the direction away from the hole both are closed forms.
//!
//! *A light behind a wormhole.* Through the wormhole of Ellis with the throat `q`, of which the ball of radius `R` is filled, light of impact
//! parameter `b` turns by `2 k (K(k) - F(q/R, k))`, `k = b/q`, elliptic integrals of the first kind.

use kajo_math::gravity::schwarzschild::{elliptic_f, swept_angle};
use kajo_math::{DVec3, fmath};

use super::{Form, Parameters, spot_meter, text};
use crate::method::{BIDIRECTIONAL, Method, PATH, PATH_SCATTERING, PATH_SPECTRAL};

/// What follows light around holes; colours are seen shifted by wavelength only.
const SHIFTED: &[Method] = &[PATH, PATH_SCATTERING, BIDIRECTIONAL];

/// What follows light through wormholes, where nothing is shifted.
const CURVED: &[Method] = &[PATH, PATH_SCATTERING, PATH_SPECTRAL, BIDIRECTIONAL];

pub fn forms(draw: &mut Parameters) -> Vec<Form> {
    let mut forms: Vec<Form> = Observer::ALL.into_iter().map(|observer| sky(draw, observer)).collect();
    forms.extend([behind(draw), behind(draw), wormhole(draw)]);
    forms
}

/// A scene with a medium `m` in bodies, and a light.
fn filled(view: &str, medium: &str, bodies: &str, rest: &str) -> String {
    format!(
        "{view}Media {{ {medium} }}
Materials {{ Interface body {{ medium m }}  Matte light {{ color 0 0 0  emission 1 }} }}
Group {{ MaterialIndex body {bodies} {rest} }}\n"
    )
}

#[derive(Clone, Copy)]
enum Observer {
    Rests,
    Orbits,
    Falls,
}

impl Observer {
    const ALL: [Observer; 3] = [Observer::Rests, Observer::Orbits, Observer::Falls];
}

/// The sky in the direction away from the hole.
fn sky(draw: &mut Parameters, observer: Observer) -> Form {
    let (center, mass, r) = (draw.point(2.0), draw.between(0.5, 2.0), draw.between(4.0, 12.0));
    let away = draw.direction(-1.0);
    let still = 1.0 - 2.0 / r;
    // The direction outwards is one at right angles to the orbit.
    let (word, shift) = match observer {
        Observer::Rests => ("rests", 1.0),
        // Seen at right angles to the motion in the observer's own frame: the frequency is lowered by the factor of time.
        Observer::Orbits => ("orbits", (1.0 - 1.0 / (r - 2.0)).sqrt().recip()),
        Observer::Falls => {
            let v = (2.0 / r).sqrt();
            ("falls", ((1.0 - v) / (1.0 + v)).sqrt())
        }
    };
    let axis = away.any_orthonormal_vector();
    let from = center + r * mass * away;
    // To who orbits, light from outwards comes aslant: that at right angles to the rest frame's motion is looked for ahead.
    let look = match observer {
        Observer::Orbits => {
            let v = (1.0 / (r - 2.0)).sqrt();
            v * axis.cross(away) + (1.0 - v * v).sqrt() * away
        }
        _ => away,
    };
    let scene = filled(
        &spot_meter(from, from + look).replace("color 0 0 0", "color 1 1 1"),
        &format!(
            "BlackHole m {{ center {}  mass {mass}  axis {}  observer {word} }}",
            text(center),
            text(axis)
        ),
        &format!("Sphere {{ center {}  radius {} }}", text(center), 200.0 * mass),
        "",
    );
    let expected = (shift * shift / still).powi(2);
    Form::new(format!("sky over a black hole, whose observer {word} at {r} masses"), scene, expected, SHIFTED)
        .rounding(1e-4)
}

fn behind(draw: &mut Parameters) -> Form {
    let (b, r1, r2) = (draw.between(7.0, 12.0), draw.between(20.0, 60.0), draw.between(15.0, 60.0));
    let towards = draw.direction(-1.0);
    let side = towards.any_orthonormal_vector();
    let from = -r1 * towards;
    let alpha = fmath::asin64(b * (1.0 - 2.0 / r1).sqrt() / r1);
    let swept = swept_angle(b, [r1, r2]).unwrap_or(0.0);
    let look = fmath::cos64(alpha) * towards + fmath::sin64(alpha) * side;
    let light = r2 * (fmath::sin64(swept) * side - fmath::cos64(swept) * towards);
    let scene = filled(
        &spot_meter(from, from + look),
        "BlackHole m { mass 1 }",
        "Sphere { center 0 0 0  radius 500 }",
        &format!("MaterialIndex light Sphere {{ center {}  radius 0.02 }}", text(light)),
    );
    let expected = ((1.0 - 2.0 / r2) / (1.0 - 2.0 / r1)).powi(2);
    Form::new(
        format!("light behind a black hole, by light of the impact parameter {b}"),
        scene,
        expected,
        SHIFTED,
    )
    .rounding(3e-3)
}

fn wormhole(draw: &mut Parameters) -> Form {
    let (throat, radius) = (draw.between(0.5, 1.5), draw.between(2.0, 5.0));
    let b = throat * draw.between(0.1, 0.9);
    let into = draw.direction(-1.0);
    let up = into.any_orthonormal_vector();
    let (mouth, other) = (draw.point(2.0), draw.point(2.0) + DVec3::new(20.0, 0.0, 0.0));
    let from = mouth - 2.0 * radius * into + b * up;
    let k = b / throat;
    let complete = elliptic_f(1.0, k * k) - elliptic_f(throat / radius, k * k);
    let turn = 2.0 * k * complete;
    // The place at the edge where light comes in, then that where it comes out: as seen from the middle, with up as it is and backwards
    // become forwards.
    let start = fmath::asin64(b / radius);
    let place = |angle: f64| fmath::cos64(angle) * into + fmath::sin64(angle) * up;
    let out = place(start + turn);
    // On the other side it leaves at the same angle to the radius that it came in at.
    let along = place(2.0 * start + turn);
    let light = other + radius * out + radius * along;
    let scene = filled(
        &spot_meter(from, from + into),
        &format!(
            "Wormhole m {{ mouth {}  other {}  radius {radius}  throat {throat}  into {}  out {}  up {} }}",
            text(mouth),
            text(other),
            text(into),
            text(into),
            text(up)
        ),
        &format!(
            "Merge {{ Sphere {{ center {}  radius {radius} }} Sphere {{ center {}  radius {radius} }} }}",
            text(mouth),
            text(other)
        ),
        &format!("MaterialIndex light Sphere {{ center {}  radius {} }}", text(light), 0.004 * radius),
    );
    Form::new(format!("light behind a wormhole, by light of the impact parameter {b}"), scene, 1.0, CURVED)
}
