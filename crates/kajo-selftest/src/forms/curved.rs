//! Bodies that bend light.
//!
//! *Luneburg's ball*, `n^2 = 2 - (r/R)^2`: a ray that comes parallel to `d` leaves it at `c + R d`, whatever its height, so an emitter of
//! a thousandth of the radius there fills the ball with its light. Under an even sky of radiance 1 nothing is to be seen of the ball from
//! outside, and within radiance is `n^2` of the place.
//!
//! *A parabola.* Where `n^2 = n0^2 + 2 g y`, a ray that begins at the angle `a` has at the distance `x` the height
//! `y = x tan a + g x^2 / (2 n0^2 cos^2 a)`. An emitter there is seen with its radiance times `n0^2 / n^2`.
//!
//! *A fish-eye*, `n = n0 / (1 + r^2)`: all rays from `p` come to `-p / |p|^2`.
//!
//! *A hot road.* From the index `n0` to `n1` at the ground rays come back up that go down at less than the angle of
//! `cos a = n1 / n0`; they show the sky in the place of the ground.

use kajo_math::DVec3;

use super::{Form, Parameters, spot_meter, text};
use crate::method::{BIDIRECTIONAL, Method, PATH, PATH_SCATTERING, PATH_SPECTRAL};

const CURVED: &[Method] = &[PATH, PATH_SCATTERING, PATH_SPECTRAL, BIDIRECTIONAL];

pub fn forms(draw: &mut Parameters) -> Vec<Form> {
    vec![
        even_sky(draw, true),
        even_sky(draw, false),
        antipode(draw),
        parabola(draw),
        fish_eye(draw),
        road(draw, true),
        road(draw, false),
    ]
}

/// A scene with a medium `m` in a body, and what gives light.
fn filled(view: &str, medium: &str, body: &str, rest: &str) -> String {
    format!(
        "{view}Media {{ {medium} }}
Materials {{ Interface body {{ medium m }}  Matte emitter {{ color 0 0 0  emission 1 }}  Matte ground {{ color 0 0 0  emission 0.25 }} }}
Group {{ MaterialIndex body {body} {rest} }}\n"
    )
}

fn under_a_sky(from: DVec3, to: DVec3) -> String {
    spot_meter(from, to).replace("color 0 0 0", "color 1 1 1")
}

fn even_sky(draw: &mut Parameters, is_inside: bool) -> Form {
    let (center, radius) = (draw.point(2.0), draw.between(0.5, 3.0));
    let distance = if is_inside { draw.between(0.1, 0.9) } else { 4.0 };
    let from = center + radius * distance * draw.direction(-1.0);
    let view = under_a_sky(from, center + radius * draw.point(0.3));
    let scene = filled(
        &view,
        &format!("LuneburgLens m {{ center {}  radius {radius} }}", text(center)),
        &format!("Sphere {{ center {}  radius {radius} }}", text(center)),
        "",
    );
    let expected = if is_inside { 2.0 - distance * distance } else { 1.0 };
    Form::new(format!("Luneburg ball under an even sky, seen from {distance} radii"), scene, expected, CURVED)
}

fn antipode(draw: &mut Parameters) -> Form {
    let (center, radius, d) = (draw.point(1.0), draw.between(0.5, 2.0), draw.direction(-1.0));
    let height = draw.between(0.05, 0.9);
    let from = center + radius * (height * d.any_orthonormal_vector() - 4.0 * d);
    let pole = center + radius * (1.0 + 1e-5) * d;
    let scene = filled(
        &spot_meter(from, from + d),
        &format!("LuneburgLens m {{ center {}  radius {radius} }}", text(center)),
        &format!("Sphere {{ center {}  radius {radius} }}", text(center)),
        &format!(
            "MaterialIndex emitter Disk {{ center {}  normal {}  radius {} }}",
            text(pole),
            text(-d),
            1e-3 * radius
        ),
    );
    Form::new(format!("emitter behind a Luneburg ball, at height {height}"), scene, 1.0, CURVED)
}

fn parabola(draw: &mut Parameters) -> Form {
    let (n0, g, a, x) =
        (draw.between(1.3, 1.6), draw.between(-0.2, 0.2), draw.between(-0.5, 0.5), draw.between(0.5, 1.5));
    let y = x * a.tan() + g * x * x / (2.0 * (n0 * a.cos()).powi(2));
    let slope = a.tan() + g * x / (n0 * a.cos()).powi(2);
    let scene = filled(
        &spot_meter(DVec3::ZERO, DVec3::new(a.cos(), a.sin(), 0.0)),
        &format!("LinearIndex m {{ origin 0 0 0  index {n0}  gradient 0 {g} 0 }}"),
        "Box { min -2 -2 -2 max 2 2 2 }",
        &format!("MaterialIndex emitter Disk {{ center {x} {y} 0  normal -1 {} 0  radius 0.0001 }}", -slope),
    );
    let expected = n0 * n0 / (n0 * n0 + 2.0 * g * y);
    Form::new(format!("emitter on a parabola in the index {n0}, gradient {g}"), scene, expected, CURVED)
        .rounding(1e-4)
}

fn fish_eye(draw: &mut Parameters) -> Form {
    let (r, a, index) = (draw.between(0.5, 0.8), draw.between(0.7, 2.4), draw.between(1.5, 3.0));
    let p = DVec3::new(r, 0.0, 0.0);
    let image = -p / (r * r);
    let scene = filled(
        &spot_meter(p, p + DVec3::new(a.cos(), a.sin(), 0.0)),
        &format!("MaxwellFishEye m {{ radius 1  index {index} }}"),
        "Sphere { center 0 0 0  radius 9 }",
        &format!("MaterialIndex emitter Sphere {{ center {}  radius 0.0003 }}", text(image)),
    );
    let n = |r: f64| index / (1.0 + r * r);
    let expected = (n(r) / n(1.0 / r)).powi(2);
    Form::new(format!("image in a fish-eye of the index {index}"), scene, expected, CURVED).rounding(2e-3)
}

fn road(draw: &mut Parameters, mirrors: bool) -> Form {
    let (depth, drop) = (draw.between(0.05, 0.2), draw.between(2e-5, 5e-5));
    let critical = (1.0 - drop).acos();
    let share = if mirrors { draw.between(0.8, 0.999) } else { draw.between(1.001, 1.2) };
    let (from, a) = (DVec3::new(-900.0, 2.0, 0.0), critical * share);
    let scene = filled(
        &under_a_sky(from, from + 100.0 * DVec3::new(a.cos(), -a.sin(), 0.0)),
        &format!("GradientIndex m {{ index = 1 - {drop} * exp(-y / {depth}) }}"),
        "Box { min -1000 -0.1 -100 max 1000 40 100 }",
        "MaterialIndex ground Quad { corner -999 0 -99 edge1 0 0 198 edge2 1998 0 0 }",
    );
    // Radiance over the square of the index stays the same, and that is lowest at the ground.
    let expected = if mirrors { 1.0 } else { 0.25 / ((1.0 - drop) * (1.0 - drop)) };
    Form::new(format!("hot road at {share} of the angle below which it mirrors"), scene, expected, CURVED)
}
