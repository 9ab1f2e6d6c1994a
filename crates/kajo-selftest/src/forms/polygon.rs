//! Polygons of even light over a floor, and their shadows.
//!
//! A polygon with corners in the unit directions `v_i` and of radiance 1 gives a surface of normal `n` the irradiance
//! [Lambert 1760]
//!
//! ```text
//! E = 1/2 |sum over edges of  Theta_i  n . (v_i x v_(i+1)) / |v_i x v_(i+1)| |
//! ```
//!
//! with `Theta_i` the angle between the two corners, once the part below the horizon has been cut off. What an
//! opaque half-plane hides is cut off in the same way, by the plane through its edge and the point. A floor of albedo
//! `rho` has the radiance `rho E / pi`. A light that is not the same all over, behind a picture, with holes, in stripes,
//! is the sum of its parts. Ambient occlusion is `1 - E / pi` for the polygon as what hides the sky.

use std::f64::consts::{PI, TAU};

use kajo_math::DVec3;

use super::{Form, Parameters, floor, floor_and_light, spot_meter, text, triangle};
use crate::method::{LIGHTS, OCCLUSION, PATH};

pub fn forms(draw: &mut Parameters) -> Vec<Form> {
    let mut forms = vec![above(draw), setting(draw), half_hidden(draw), hides_the_sky(draw)];
    forms.extend(
        ["sobol", "zsobol", "pmj", "uniform", "jittered", "poisson", "cmj"].map(|s| sampled(draw, s)),
    );
    forms.extend(["tree", "uniform"].map(|choice| many(draw, choice)));
    forms.extend([painted(draw, "a picture"), painted(draw, "holes"), striped(draw)]);
    let shared = forms.iter().filter(|form| form.methods == LIGHTS).map(Form::shared);
    let others: Vec<Form> = shared.chain([forms[0].chained()]).collect();
    forms.extend(others);
    forms
}

/// An emitter each of whose quarters gives another light, by a picture that it shines through or one of its holes.
fn painted(draw: &mut Parameters, by: &str) -> Form {
    let centre = draw.between(1.0, 2.0) * (DVec3::Y + 0.4 * draw.direction(-1.0));
    let (a, b) = (draw.between(0.5, 1.0) * DVec3::new(1.0, 0.3, 0.1), draw.between(0.5, 1.0) * DVec3::Z);
    let corner = centre - 0.5 * (a + b);
    let (rho, le) = (draw.between(0.3, 0.9), draw.between(0.5, 4.0));
    // Upper left, upper right, lower left, lower right.
    let shares: [usize; 4] = std::array::from_fn(|_| draw.index(256));
    let light = (0..4).map(|i| {
        let from = corner + 0.5 * f64::from(i % 2) * a + if i < 2 { 0.5 * b } else { DVec3::ZERO };
        let quarter = [from, from + 0.5 * a, from + 0.5 * (a + b), from + 0.5 * b];
        shares[i as usize] as f64 / 255.0 * irradiance(&quarter, DVec3::Y)
    });
    let expected = rho / PI * le * light.sum::<f64>();
    let emitter = match by {
        "a picture" => format!("emission quarters.pgm {le} {{ filter nearest  encoding linear }}"),
        _ => format!("emission {le}  opacity quarters.pgm {{ filter nearest }}"),
    };
    let object = format!("Quad {{ corner {}  edge1 {}  edge2 {} }}", text(corner), text(a), text(b));
    let scene = over_floor(rho, &format!("Matte emitter {{ color 0 0 0  {emitter} }}"), &object);
    let [c, d, e, f] = shares;
    let form =
        Form::new(format!("S3 light in quarters by {by}, {c} {d} {e} {f} of 255"), scene, expected, LIGHTS);
    form.bounces(0).file("quarters.pgm", format!("P2 2 2 255 {c} {d} {e} {f}\n"))
}

/// A light of stripes, a mixture of a material that emits and one that does not.
fn striped(draw: &mut Parameters) -> Form {
    let (x, width, height) = (draw.between(-1.0, 0.0), draw.between(1.0, 2.0), draw.between(0.6, 1.5));
    let (rho, le, per_unit) = (draw.between(0.3, 0.9), draw.between(0.5, 4.0), draw.between(2.0, 4.0));
    let stripe = |i: i32| {
        let [from, to] = [i, i + 1].map(|edge| (f64::from(edge) / per_unit).clamp(x, x + width));
        let corner = |x: f64, z: f64| DVec3::new(x, height, z);
        match i.rem_euclid(2) {
            0 if from < to => irradiance(
                &[corner(from, -0.5), corner(to, -0.5), corner(to, 0.5), corner(from, 0.5)],
                DVec3::Y,
            ),
            _ => 0.0,
        }
    };
    let expected = rho / PI * le * (-20..20).map(stripe).sum::<f64>();
    // Along x only: elsewhere the light keeps to one cell.
    let emitter = format!(
        "Matte on {{ color 0 0 0  emission {le} }}  Matte off {{ color 0 0 0 }}\n  \
         Checkerboard emitter {{ Transform {{ Translate 0 0.5 0.5  Scale {per_unit} 0.1 0.1 }}  materialIndex on  materialIndex off }}"
    );
    let object = format!("Quad {{ corner {x} {height} -0.5  edge1 {width} 0 0  edge2 0 0 1 }}");
    let scene = over_floor(rho, &emitter, &object);
    Form::new(format!("S3 light of stripes, {width} wide, {per_unit} to the unit"), scene, expected, LIGHTS)
        .bounces(0)
}

/// A matt floor at the origin under an object of the material `emitter`, which `material` describes.
fn over_floor(rho: f64, material: &str, object: &str) -> String {
    format!(
        "{}Materials {{\n  Matte floor {{ color {rho} {rho} {rho} }}\n  {material}\n}}\n\
         Group {{\n  {}\n  MaterialIndex emitter {object}\n}}",
        spot_meter(DVec3::new(0.01, 0.02, 0.0), DVec3::ZERO),
        floor(DVec3::Y)
    )
}

/// Irradiance at the origin from a flat polygon of radiance 1.
pub fn irradiance(corners: &[DVec3], n: DVec3) -> f64 {
    let visible: Vec<DVec3> = cut(corners, n).into_iter().map(DVec3::normalize).collect();
    let edges = visible.iter().zip(visible.iter().cycle().skip(1));
    let sum: f64 = edges
        .map(|(a, b)| {
            let cross = a.cross(*b);
            // Nothing is to be seen of an edge that points at the origin.
            if cross.length() < 1e-14 {
                0.0
            } else {
                cross.length().atan2(a.dot(*b)) * n.dot(cross.normalize())
            }
        })
        .sum();
    0.5 * sum.abs()
}

/// The part of a convex polygon on the side of the plane through the origin to which `n` points
/// [Sutherland and Hodgman 1974].
fn cut(corners: &[DVec3], n: DVec3) -> Vec<DVec3> {
    let mut kept = Vec::new();
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        let (da, db) = (a.dot(n), b.dot(n));
        if da >= 0.0 {
            kept.push(a);
        }
        if (da < 0.0) != (db < 0.0) {
            kept.push(a + (b - a) * (da / (da - db)));
        }
    }
    kept
}

/// A convex polygon around a place: corners on an ellipse, in a plane of any tilt.
struct Polygon {
    centre: DVec3,
    corners: Vec<DVec3>,
}

impl Polygon {
    fn draw(draw: &mut Parameters, centre: DVec3, size: f64) -> Polygon {
        let normal = (centre.normalize() + 0.6 * draw.direction(-1.0)).normalize();
        let u = normal.any_orthonormal_vector();
        let v = normal.cross(u);
        let n = 3 + draw.index(6);
        let (a, b) = (size * draw.between(0.6, 1.0), size * draw.between(0.6, 1.0));
        let angle = |i: usize, draw: &mut Parameters| (i as f64 + draw.between(0.0, 0.8)) / n as f64 * TAU;
        let corners = (0..n).map(|i| angle(i, draw)).map(|t| centre + a * t.cos() * u + b * t.sin() * v);
        Polygon { centre, corners: corners.collect() }
    }

    /// As a fan of triangles.
    fn scene(&self) -> String {
        let fan = self.corners[1..].windows(2).map(|pair| triangle([self.corners[0], pair[0], pair[1]]));
        fan.collect::<Vec<_>>().join("\n  ")
    }
}

/// A polygon as the light over a floor with normal `n`, and perhaps more objects.
fn lit(draw: &mut Parameters, polygons: &[Polygon], n: DVec3, more: &str) -> (String, f64) {
    let (rho, le) = (draw.between(0.3, 0.9), draw.between(0.5, 4.0));
    // From so near that nothing stands between.
    let from = 0.05 * (n + 0.5 * n.any_orthonormal_vector());
    let lights: Vec<String> = polygons.iter().map(Polygon::scene).collect();
    let scene = format!(
        "{}{}Group {{\n  {}\n  {more}\n  MaterialIndex emitter\n  {}\n}}",
        spot_meter(from, DVec3::ZERO),
        floor_and_light(rho, le),
        floor(n),
        lights.join("\n  ")
    );
    (scene, rho / PI * le)
}

fn above(draw: &mut Parameters) -> Form {
    let centre = draw_centre(draw, 0.6);
    let polygon = Polygon::draw(draw, centre, 0.4);
    let (scene, factor) = lit(draw, std::slice::from_ref(&polygon), DVec3::Y, "");
    let name = format!("S3 polygon of {} corners over a floor", polygon.corners.len());
    Form::new(name, scene, factor * irradiance(&polygon.corners, DVec3::Y), LIGHTS).bounces(0)
}

/// A place at a distance of one or two.
fn draw_centre(draw: &mut Parameters, least_cos: f64) -> DVec3 {
    draw.between(1.0, 2.0) * draw.direction(least_cos)
}

fn setting(draw: &mut Parameters) -> Form {
    let centre = draw_centre(draw, 0.9);
    let polygon = Polygon::draw(draw, centre, 0.6);
    // The horizon passes through the polygon or just below.
    let along = centre.normalize().any_orthonormal_vector();
    let n = (along + draw.between(0.1, 0.3) * centre.normalize()).normalize();
    let (scene, factor) = lit(draw, std::slice::from_ref(&polygon), n, "");
    let expected = factor * irradiance(&polygon.corners, n);
    Form::new("S3 polygon near the horizon", scene, expected, LIGHTS).bounces(0)
}

fn half_hidden(draw: &mut Parameters) -> Form {
    let centre = draw_centre(draw, 0.6);
    let polygon = Polygon::draw(draw, centre, 0.4);
    let towards = polygon.centre.normalize();
    let edge = towards.any_orthonormal_vector();
    let across = towards.cross(edge);
    let middle = 0.4 * polygon.centre + draw.between(-0.08, 0.08) * across;
    let blocker = format!(
        "MaterialIndex black Quad {{ corner {}  edge1 {}  edge2 {} }}",
        text(middle - 50.0 * edge),
        text(100.0 * edge),
        text(50.0 * across)
    );
    let (scene, factor) = lit(draw, std::slice::from_ref(&polygon), DVec3::Y, &blocker);
    // Seen from the floor, `across` is the hidden side.
    let side = edge.cross(middle);
    let side = if side.dot(across) > 0.0 { -side } else { side };
    let expected = factor * irradiance(&cut(&polygon.corners, side), DVec3::Y);
    Form::new("S3 polygon behind a half-plane", scene, expected, LIGHTS).bounces(0)
}

fn sampled(draw: &mut Parameters, pattern: &'static str) -> Form {
    let centre = draw_centre(draw, 0.6);
    let polygon = Polygon::draw(draw, centre, 0.4);
    let (scene, factor) = lit(draw, std::slice::from_ref(&polygon), DVec3::Y, "");
    let expected = factor * irradiance(&polygon.corners, DVec3::Y);
    Form::new(format!("S3 polygon, {pattern} samples"), scene, expected, &[PATH]).bounces(0).pattern(pattern)
}

fn many(draw: &mut Parameters, choice: &str) -> Form {
    const LIGHTS: usize = 24;
    let polygons: Vec<Polygon> = (0..LIGHTS)
        .map(|i| {
            // One to a place of a grid, so that none hides another.
            let (x, z) = ((i % 6) as f64 - 2.5, (i / 6) as f64 - 1.5);
            let centre = DVec3::new(x, draw.between(2.0, 2.2), z);
            let size = draw.between(0.02, 0.15);
            Polygon::draw(draw, centre, size)
        })
        .collect();
    let (scene, factor) = lit(draw, &polygons, DVec3::Y, "");
    let expected: f64 = polygons.iter().map(|p| irradiance(&p.corners, DVec3::Y)).sum();
    let name = format!("S3 {LIGHTS} polygons, lights chosen by {choice}");
    Form::new(name, scene, factor * expected, &[PATH]).bounces(0).settings(&format!("lightChoice {choice}"))
}

fn hides_the_sky(draw: &mut Parameters) -> Form {
    let centre = draw_centre(draw, 0.6);
    let polygon = Polygon::draw(draw, centre, 0.8);
    let (scene, _) = lit(draw, std::slice::from_ref(&polygon), DVec3::Y, "");
    let expected = 1.0 - irradiance(&polygon.corners, DVec3::Y) / PI;
    Form::new("sky with a polygon before it, by occlusion", scene, expected, &[OCCLUSION])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of side 1 at height `h`, moved by `x`.
    fn square(h: f64, x: f64) -> [DVec3; 4] {
        [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(a, b)| DVec3::new(a + x, h, b))
    }

    #[test]
    fn lamberts_formula_gives_the_published_values() {
        for (h, x, expected) in
            [(0.5, 0.0, 1.740_840), (1.0, 0.0, 0.752_275), (2.0, 0.0, 0.230_837), (1.0, 1.0, 0.265_005)]
        {
            assert!((irradiance(&square(h, x), DVec3::Y) - expected).abs() < 1e-6, "{h} {x}");
        }
        let triangle = [DVec3::new(0.0, 1.0, 0.0), DVec3::new(1.0, 1.0, 0.0), DVec3::new(0.0, 1.0, 1.0)];
        assert!((irradiance(&triangle, DVec3::Y) - 0.302_300).abs() < 1e-6);
        let tilted = DVec3::new(0.5, 0.75f64.sqrt(), 0.0);
        assert!((irradiance(&square(1.0, 0.0), tilted) - 0.651_489).abs() < 1e-6);
        let half = cut(&square(1.0, 0.0), DVec3::X);
        assert!((irradiance(&half, DVec3::Y) - 0.376_137).abs() < 1e-6);
    }
}
