//! The light that a glass ball throws on a screen.
//!
//! Parallel rays of irradiance `E` meet a ball of radius 1 and index `n` at heights `h` off its axis. With
//! `sin i = h = n sin r` a ray is bent by `i - r` when it enters and again when it leaves, and meets the screen behind the
//! ball at the distance `x(h)` from the axis. Unpolarised light passes both surfaces with the share `(1 - F)^2`. A
//! part of the screen so receives the flux
//!
//! ```text
//! E integral over h in [0, 1] of  (1 - F)^2 phi(x(h)) h dh
//! ```
//!
//! with `phi(x)` the angle that the part covers of the circle of radius `x` around the axis. No path from the camera finds
//! this light by chance, since parallel light is met with probability zero; `caustics manifold` looks for its
//! directions by Newton's method. The screen is so small that no light passes beside the ball to it, and light is
//! scattered so seldom that none comes to the screen by way of the screen.

use std::f64::consts::PI;

use kajo_math::DVec3;

use super::quadrature::simpson;
use super::{Form, Parameters, text};
use crate::method::{
    BIDIRECTIONAL, BIDIRECTIONAL_SPECTRAL, LIGHT, MLT, Method, PATH_MANIFOLD, PHOTON_DIRECT, PHOTONS,
    PHOTONS_SPECTRAL, SIZE_BY_WAVELENGTH,
};

/// What finds light that no ray meets by chance.
const METHODS: &[Method] = &[BIDIRECTIONAL, BIDIRECTIONAL_SPECTRAL, LIGHT];

/// What looks for the directions in which light comes through the ball.
const WALKS: &[Method] = &[PATH_MANIFOLD];

/// Markov chains over paths from both ends.
const CHAINS: &[Method] = &[MLT];

/// One map of photons that is seen itself.
const ONE_MAP: &[Method] = &[PHOTON_DIRECT];

/// The noise of a map, of which a batch has one, however many samples it takes.
const NOISE_OF_ONE_MAP: f64 = 2.5e-3;

/// The noise of walks, which take thirty times as long for a sample.
const NOISE_OF_WALKS: f64 = 2.5e-3;

/// How much the disks of photons may blur over the border of the picture, as a share of its light.
const BLUR: f64 = 0.01;

pub fn forms(draw: &mut Parameters) -> Vec<Form> {
    let far = Screen { distance: draw.between(1.8, 2.2), half: 0.4, aside: 0.0, aslant: 60.0 };
    let near = Screen { distance: draw.between(1.2, 1.3), half: 0.15, aside: 0.0, aslant: 75.0 };
    // On the axis the light has no bound, and its square no mean.
    let beside = Screen { aside: draw.between(0.22, 0.28), ..near };
    let [far, near, beside] = [far, near, beside].map(|screen| form(draw, screen));
    let by = |what: &str, methods: &'static [Method], screen: &Form| Form {
        name: format!("{}, by {what}", screen.name),
        methods,
        ..screen.clone()
    };
    vec![
        by("walks", WALKS, &far).least_noise(NOISE_OF_WALKS),
        by("walks", WALKS, &beside).least_noise(NOISE_OF_WALKS),
        by("chains", CHAINS, &far).size([32, 32]),
        by("chains", CHAINS, &near).size([32, 32]),
        // All pixels share the photons of a sample.
        by("photons", PHOTONS, &far).rounding(BLUR).size([64, 64]),
        by("photons", PHOTONS_SPECTRAL, &far).rounding(BLUR).size(SIZE_BY_WAVELENGTH),
        by("one map", ONE_MAP, &far).rounding(BLUR).least_noise(NOISE_OF_ONE_MAP).size([64, 64]),
        far,
        near,
    ]
}

/// A screen behind the ball, and what is seen of it.
#[derive(Clone, Copy)]
struct Screen {
    /// From the middle of the ball.
    distance: f64,
    /// Half the side of the square that is seen, across the camera's direction.
    half: f64,
    /// Of its middle from the axis.
    aside: f64,
    /// Degrees between the camera's direction and the axis, so that it looks past the ball.
    aslant: f64,
}

fn form(draw: &mut Parameters, Screen { distance, half, aside, aslant }: Screen) -> Form {
    let (n, rho, e) = (draw.between(1.4, 1.6), draw.between(0.3, 0.9), draw.between(0.5, 4.0));
    let (sin, cos) = aslant.to_radians().sin_cos();
    // Parallel rays aslant see a rectangle that is as wide as the picture and higher.
    let half_height = half / cos;
    let middle = DVec3::new(aside, 0.0, distance);
    let view = DVec3::new(0.0, sin, cos);
    let scene = format!(
        "OrthographicCamera {{ center {}  direction {}  up 0 {cos} {}  size {} }}\nBackground {{ color 0 0 0 }}\n\
         Lights {{ DirectionalLight {{ direction 0 0 1  irradiance {e} {e} {e} }} }}\n\
         Materials {{ Glass glass {{ indexOfRefraction {n} }}  Matte screen {{ color {rho} {rho} {rho} }} }}\n\
         Group {{ MaterialIndex glass Sphere {{ center 0 0 0  radius 1 }}\n\
         MaterialIndex screen Disk {{ center {}  normal 0 0 -1  radius 0.95 }} }}",
        text(middle - 3.0 * view),
        text(view),
        -sin,
        2.0 * half,
        text(DVec3::new(0.0, 0.0, distance))
    );
    let covered = |x: f64| covered(x, [aside - half, aside + half], half_height);
    let flux = simpson(0.0, 1.0, 200_000, |h| share(h, n) * covered(landing(h, n, distance)) * h);
    let expected = rho / PI * e * flux / (4.0 * half * half_height);
    let from_axis = if aside == 0.0 { String::new() } else { format!(", {aside} from the axis") };
    let name = format!("S13 caustic of a ball of index {n} on a screen at {distance}{from_axis}");
    Form::new(name, scene, expected, METHODS).bounces(2).size([4, 4])
}

/// The angle that the rectangle `from..to` by `-half_height..half_height` covers of the circle of radius `x` about the origin.
fn covered(x: f64, [from, to]: [f64; 2], half_height: f64) -> f64 {
    // Of the upper half of the circle.
    let angle = |at: f64| (at / x).clamp(-1.0, 1.0).acos();
    let (begin, end) = (angle(to), angle(from));
    let height = (half_height / x).min(1.0).asin();
    let common = |low: f64, high: f64| (end.min(high) - begin.max(low)).max(0.0);
    2.0 * (common(0.0, height) + common(PI - height, PI))
}

/// Share of unpolarised light that passes both surfaces.
fn share(h: f64, n: f64) -> f64 {
    let (ci, cr) = ((1.0 - h * h).sqrt(), (1.0 - h * h / (n * n)).sqrt());
    let (s, p) = ((ci - n * cr) / (ci + n * cr), (n * ci - cr) / (n * ci + cr));
    (1.0 - 0.5 * (s * s + p * p)).powi(2)
}

/// Distance from the axis at which a ray meets the screen; infinite when it does not.
fn landing(h: f64, n: f64, distance: f64) -> f64 {
    let (i, r) = (h.asin(), (h / n).asin());
    // It enters at the angle i from the axis and leaves after the angle pi - 2 r around the middle.
    let leaves = 2.0 * r - i;
    let bent = 2.0 * (i - r);
    if bent >= PI / 2.0 {
        return f64::INFINITY;
    }
    // Towards positive x where it has not yet crossed the axis.
    (leaves.sin() - bent.tan() * (distance - leaves.cos())).abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Irradiance at a distance from the axis, as the mean over a narrow ring.
    fn irradiance(x: f64, distance: f64) -> f64 {
        let width = 2e-3 * x;
        let within = |h: f64| (landing(h, 1.5, distance) - x).abs() < width;
        let steps = 4_000_000;
        let value = |k: i32| {
            let h = (f64::from(k) + 0.5) / f64::from(steps);
            if within(h) { share(h, 1.5) * h } else { 0.0 }
        };
        (0..steps).map(value).sum::<f64>() / f64::from(steps) / (2.0 * width * x)
    }

    #[test]
    fn the_caustic_has_the_known_irradiance() {
        // Sums over the branches of the map of heights to distances, checked by millions of rays.
        for (distance, x, expected) in [
            (2.0, 0.1, 5.679),
            (2.0, 0.3, 1.697),
            (2.0, 0.7, 0.3129),
            (1.2, 0.05, 81.9),
            (1.2, 0.1, 3.854),
            (1.2, 0.3, 0.363),
        ] {
            let found = irradiance(x, distance);
            assert!((found / expected - 1.0).abs() < 3e-3, "{distance} {x}: {found} for {expected}");
        }
    }
}
