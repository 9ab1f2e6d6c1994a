//! Where mirrors and lenses send rays: a light with a straight edge stands where the rays arrive, and the share of the
//! picture that is lit tells on which side of the edge they pass.
//!
//! *Mirror.* A ray at height `h` over the axis of a spherical mirror of radius `R` crosses the axis at
//! `R / (2 cos theta)` from the middle, `sin theta = h/R`.
//!
//! *Ball.* A ray at height `h` crosses the axis behind a ball of index `n` at `R sin i / sin(2 (i - r))` from the middle,
//! `sin i = h/R = n sin r`.
//!
//! *Prism.* Rays that pass a prism of apex angle `alpha` parallel to its base turn least, by
//! `2 asin(n sin(alpha/2)) - alpha`. A parallel beam stays one, so that the share of it beyond an edge is known
//! at any distance. The angles expected are published ones; the scene has the index that the program knows.
//!
//! The pictures have some width. Over it the crossing is followed ray by ray, by the vector forms of the laws of
//! reflection and refraction, and the lit share is found by bisection in each column.

use kajo_color::named;
use kajo_math::DVec3;

use super::quadrature::{simpson, zero};
use super::{Form, Parameters, text};
use crate::method::{MIRRORS, PATH};

/// Pictures with an edge in them.
const GRID: [u32; 2] = [16, 16];

/// Error of lit shares by single precision: an edge is placed to seven digits of its distance, and seen enlarged.
const EDGE_ROUNDING: f64 = 1e-3;

pub fn forms(draw: &mut Parameters) -> Vec<Form> {
    let mut forms = vec![mirror(draw), ball(draw), ball(draw), filters(draw)];
    let shared: Vec<Form> =
        forms.iter().flat_map(|form| [form.shared(), form.chained(), form.chained_by_length(3)]).collect();
    forms.extend(PRISMS.iter().map(|prism| least_turn(draw, prism)));
    forms.extend(shared);
    forms
}

/// Materials of this file. The light has an ambient colour for the classic integrator, to which nothing emits.
fn materials(body: &str) -> String {
    format!(
        "Background {{ color 0 0 0 }}\nMaterials {{\n  Material body {{ diffuseColor 0 0 0  {body} }}\n  \
         Material emitter {{ diffuseColor 0 0 0  ambientColor 1 1 1  emission 1 1 1 }}\n}}\n"
    )
}

/// A light in the plane x = 0 that begins at `edge` and goes on along z.
fn light_behind(edge: f64) -> String {
    format!("MaterialIndex emitter Quad {{ corner 0 -1 {edge}  edge1 0 2 0  edge2 0 0 20 }}")
}

/// The share of the square `[-1, 1]^2` in which `place` lies beyond `edge`.
fn share(edge: f64, place: impl Fn(f64, f64) -> f64) -> f64 {
    let column = |v: f64| {
        let beyond = |u: f64| place(u, v) - edge;
        match (beyond(-1.0) > 0.0, beyond(1.0) > 0.0) {
            (true, true) => 1.0,
            (false, false) => 0.0,
            (true, false) => 0.5 * (zero(-1.0, 1.0, beyond) + 1.0),
            (false, true) => 0.5 * (1.0 - zero(-1.0, 1.0, beyond)),
        }
    };
    0.5 * simpson(-1.0, 1.0, 40, column)
}

/// Distances at which a ray meets the unit sphere.
fn unit_sphere(o: DVec3, d: DVec3) -> [f64; 2] {
    let (b, c) = (o.dot(d), o.length_squared() - 1.0);
    let root = (b * b - c).sqrt();
    [-b - root, -b + root]
}

/// Snell's law for unit vectors; `n` against `d`, `eta` the index behind over that before the surface.
fn refracted(d: DVec3, n: DVec3, eta: f64) -> DVec3 {
    let cos = -d.dot(n);
    let along = (d + cos * n) / eta;
    along - (1.0 - along.length_squared()).sqrt() * n
}

fn mirror(draw: &mut Parameters) -> Form {
    const HALF_ANGLE: f64 = 1.0;
    let h = draw.between(0.3, 0.7);
    let tan = HALF_ANGLE.to_radians().tan();
    // Rays along z from inside the mirror, fanned out a little.
    let place = |u: f64, v: f64| {
        let (o, d) = (DVec3::new(h, 0.0, 0.0), DVec3::new(u * tan, v * tan, 1.0).normalize());
        let p = o + unit_sphere(o, d)[1] * d;
        let back = d - 2.0 * d.dot(p) * p;
        p.z - p.x * back.z / back.x
    };
    let edge = place(draw.between(-0.5, 0.5), 0.0);
    // The light is within the mirror.
    let scene = format!(
        "PerspectiveCamera {{ center {h} 0 0  direction 0 0 1  up 0 1 0  angle {} }}\n{}\
         Group {{ MaterialIndex body Sphere {{ center 0 0 0  radius 1 }}\n\
         MaterialIndex emitter Quad {{ corner 0 -0.1 {edge}  edge1 0 0.2 0  edge2 0 0 0.2 }} }}",
        2.0 * HALF_ANGLE,
        materials("reflectiveColor 1 1 1")
    );
    let expected = share(edge, place);
    Form::new(format!("focus of a mirror, rays at height {h}"), scene, expected, MIRRORS)
        .bounces(1)
        .size(GRID)
        .rounding(EDGE_ROUNDING)
}

fn ball(draw: &mut Parameters) -> Form {
    const HALF: f64 = 0.05;
    let (n, h) = (draw.between(1.3, 1.6), draw.between(0.3, 0.65));
    let place = |u: f64, v: f64| {
        let (o, d) = (DVec3::new(h + HALF * u, HALF * v, -5.0), DVec3::Z);
        let p = o + unit_sphere(o, d)[0] * d;
        let inside = refracted(d, p, n);
        let q = p + unit_sphere(p, inside)[1] * inside;
        let out = refracted(inside, -q, 1.0 / n);
        q.z - q.x * out.z / out.x
    };
    let edge = place(draw.between(-0.5, 0.5), 0.0);
    let scene = format!(
        "OrthographicCamera {{ center {h} 0 -5  direction 0 0 1  up 0 1 0  size {} }}\n{}\
         Group {{ MaterialIndex body Sphere {{ center 0 0 0  radius 1 }} {} }}",
        2.0 * HALF,
        materials(&format!("transparentColor 1 1 1  indexOfRefraction {n}")),
        light_behind(edge)
    );
    let name = format!("focus of a ball of index {n}, rays at height {h}");
    Form::new(name, scene, share(edge, place), MIRRORS).bounces(2).size(GRID).rounding(EDGE_ROUNDING)
}

/// Panes that take away light and bend none.
fn filters(draw: &mut Parameters) -> Form {
    let shares = [0; 3].map(|_| draw.between(0.4, 0.9));
    let pane = |(i, share): (usize, &f64)| {
        let materials =
            format!("Material pane{i} {{ diffuseColor 0 0 0  transparentColor {share} {share} {share} }}");
        let quad =
            format!("MaterialIndex pane{i} Quad {{ corner -9 -9 {i}  edge1 18 0 0.5  edge2 0 18 0.3 }}");
        (materials, quad)
    };
    let (panes, quads): (Vec<String>, Vec<String>) = shares.iter().enumerate().map(pane).unzip();
    let scene = format!(
        "{}Materials {{ {} }}\nGroup {{ {} }}",
        super::spot_meter(DVec3::new(0.0, 0.0, 9.0), DVec3::ZERO).replace("color 0 0 0", "color 1 1 1"),
        panes.join("\n"),
        quads.join("\n")
    );
    Form::new("three filters", scene, shares.iter().product(), MIRRORS).bounces(3)
}

/// A glass at one of Fraunhofer's lines, and how far a prism of 60 degrees turns that line at least.
struct Prism {
    glass: &'static str,
    line: &'static str,
    nm: f64,
    degrees: f64,
}

const fn prism(glass: &'static str, line: &'static str, nm: f64, degrees: f64) -> Prism {
    Prism { glass, line, nm, degrees }
}

const PRISMS: [Prism; 8] = [
    prism("N-BK7", "C", 656.2725, 38.4291),
    prism("N-BK7", "d", 587.5618, 38.6467),
    prism("N-BK7", "F", 486.1327, 39.1381),
    prism("N-BK7", "h", 404.6561, 39.8353),
    prism("N-SF10", "C", 656.2725, 58.7350),
    prism("N-SF10", "d", 587.5618, 59.5690),
    prism("N-SF10", "F", 486.1327, 61.6689),
    prism("N-SF10", "h", 404.6561, 65.2181),
];

/// A prism with its edge along y and its base parallel to z.
const PRISM: &str = "v 1 -5 0\nv -0.5 -5 -0.8660254\nv -0.5 -5 0.8660254\n\
    v 1 5 0\nv -0.5 5 -0.8660254\nv -0.5 5 0.8660254\n\
    f 1 3 2\nf 4 5 6\nf 1 5 4\nf 1 2 5\nf 1 6 3\nf 1 4 6\nf 2 6 5\nf 2 3 6\n";

fn least_turn(draw: &mut Parameters, prism: &Prism) -> Form {
    /// The light is so far away that 0.002 degrees are a thirtieth of the beam.
    const FAR: f64 = 100.0;
    const BEAM: f64 = 0.1;
    let Prism { glass, line, nm, degrees } = *prism;
    let index = named::glass(glass).map_or(f64::NAN, |glass| glass.index(nm));
    let (sin, cos) = (0.5 * degrees).to_radians().sin_cos();
    // Through the middles of the two sides, up before the prism and down behind it.
    let (towards, away) = (DVec3::new(sin, 0.0, cos), DVec3::new(-sin, 0.0, cos));
    let half = 0.75f64.sqrt() / 2.0;
    let (enters, leaves) = (DVec3::new(0.25, 0.0, -half), DVec3::new(0.25, 0.0, half));
    let across = DVec3::new(cos, 0.0, sin);
    let beyond = draw.between(-0.5, 0.5);
    let edge = leaves + FAR * away + 0.5 * beyond * BEAM * across;
    let scene = format!(
        "OrthographicCamera {{ center {}  direction {}  up 0 1 0  size {BEAM} }}\n{}\
         Group {{ MaterialIndex body TriangleMesh {{ file prism.obj }}\n\
         MaterialIndex emitter Quad {{ corner {}  edge1 0 10 0  edge2 {} }} }}",
        text(enters - 2.0 * towards),
        text(towards),
        materials(&format!("transparentColor 1 1 1  indexOfRefraction {index}")),
        text(edge - 5.0 * DVec3::Y),
        text(5.0 * across)
    );
    let name = format!("prism of {glass}, line {line}, turned by {degrees} degrees");
    Form::new(name, scene, 0.5 * (1.0 - beyond), &[PATH])
        .bounces(2)
        .size(GRID)
        .rounding(5e-3)
        .file("prism.obj", PRISM.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_through_a_ball_cross_the_axis_where_the_formula_says() {
        for (h, expected) in [(0.01, 1.499_958), (0.2, 1.483_232), (0.5, 1.391_573), (0.8, 1.200_281)] {
            let (o, d) = (DVec3::new(h, 0.0, -5.0), DVec3::Z);
            let p = o + unit_sphere(o, d)[0] * d;
            let inside = refracted(d, p, 1.5);
            let q = p + unit_sphere(p, inside)[1] * inside;
            let out = refracted(inside, -q, 1.0 / 1.5);
            assert!((q.z - q.x * out.z / out.x - expected).abs() < 1e-6, "{h}");
        }
    }

    #[test]
    fn shares_are_areas() {
        assert_eq!(share(0.0, |_, _| 1.0), 1.0);
        assert_eq!(share(0.0, |_, _| -1.0), 0.0);
        assert!((share(0.5, |u, v| u + 0.2 * v) - 0.25).abs() < 1e-12);
        assert!((share(0.5, |u, v| -u + 0.2 * v) - 0.25).abs() < 1e-12);
    }
}
