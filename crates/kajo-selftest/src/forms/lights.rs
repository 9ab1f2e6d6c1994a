//! Lights of simple shapes over a floor.
//!
//! A matt floor of albedo `rho` under the irradiance `E` has the radiance `rho E / pi`. For radiance 1, with `theta` the
//! angle to the floor's normal,
//!
//! ```text
//! disk of radius R at height h, facing       E = pi R^2 / (R^2 + h^2)
//! sphere of radius R at distance d           E = pi (R/d)^2 cos theta      all of it above the horizon
//! sky before which an endless wall rises     E = pi (1 + cos phi) / 2      phi: elevation of the wall's top
//! disc of angular radius r in the sky        E = pi sin^2 r cos theta      all of it above the horizon
//! ```
//!
//! and for emitters of no size, `E = I cos theta / d^2` and `E = E0 cos theta`. A spot light of power `P` has on its axis
//! the intensity `P` over the integral of its profile.
//!
//! *Penumbra.* Half of a disk's plane is hidden by a blocker with a straight edge. What is left of the disk is
//! integrated strip by strip, `E = h^2 integral dx dz / (x^2 + z^2 + h^2)^2`, so that it is exact for large disks
//! too.
//!
//! *Form factors.* The mean irradiance of a rectangle by another one is `pi F`, with the closed forms of `F`
//! for two equal rectangles that face each other, and for two that share an edge at a right angle
//! [Howell, Menguc, Daun and Siegel 2020, C-11 and C-14].

use std::f64::consts::{PI, TAU};

use kajo_math::DVec3;

use super::quadrature::simpson;
use super::{Form, Parameters, floor, floor_and_light, spot_meter, text};
use crate::method::{
    BIDIRECTIONAL, CLASSIC, DIRECT, DISTRIBUTION_COSINE, DISTRIBUTION_UNIFORM, LIGHTS, Method, OCCLUSION,
    PATH, PATH_LIGHTS, PATH_SCATTERING, PATH_SPECTRAL, SMALL_LIGHTS, WHOLE,
};

/// What solves scenes with lights of no size.
const POINTS: &[Method] = &[PATH, PATH_LIGHTS, PATH_SPECTRAL, BIDIRECTIONAL, DIRECT];

/// What solves scenes without emitters of no size in one bounce, at a floor that light reaches from the sky.
pub(super) const SKIES: &[Method] = &[
    PATH,
    PATH_SCATTERING,
    PATH_LIGHTS,
    PATH_SPECTRAL,
    BIDIRECTIONAL,
    DIRECT,
    DISTRIBUTION_COSINE,
    DISTRIBUTION_UNIFORM,
];

pub fn forms(draw: &mut Parameters) -> Vec<Form> {
    let mut forms = vec![disk(draw), sphere(draw), sphere_touched(draw)];
    forms.extend([-0.8, -0.3, 0.2, 0.7].map(|t| penumbra(draw, t, 0.02)));
    forms.push(penumbra(draw, 0.1, 0.8));
    forms.extend([
        point(draw),
        directional(draw),
        disc(draw),
        disc_seen(draw),
        classic_point(draw),
        spot(draw, 0.0),
        spot(draw, 0.85),
    ]);
    forms.extend([wall(draw, SKIES, "sky"), wall(draw, &[OCCLUSION], "sky by occlusion")]);
    forms.extend([facing(draw), adjacent(draw), luminaire(draw, false), luminaire(draw, true)]);
    forms.push(gauze(draw));
    // What is left of a small disk's light behind an edge takes many samples, so that one such scene is enough.
    let is_small = |form: &Form| form.methods == SMALL_LIGHTS;
    let small = forms.iter().rfind(|form| is_small(form)).into_iter();
    let shared = forms.iter().filter(|form| !is_small(form) && form.methods != [OCCLUSION]).chain(small);
    let shared = shared.map(Form::shared);
    // Those that need few start samples.
    let soon = ["S4 disk", "S4 sphere", "point light", "directional light", "disc in the sky"];
    let is_soon = |form: &&Form| soon.iter().any(|name| form.name.starts_with(name));
    let others: Vec<Form> = shared.chain(forms.iter().filter(is_soon).map(Form::chained)).collect();
    forms.extend(others);
    forms
}

/// A camera that sees the floor at the origin under some angle, from so near that nothing stands between.
fn near(n: DVec3) -> String {
    spot_meter(0.02 * (n + 0.5 * n.any_orthonormal_vector()), DVec3::ZERO)
}

/// A light, as an object, over a floor with normal `n`; gives the scene and the radiance for irradiance 1.
pub fn lit(draw: &mut Parameters, emitter: &str, n: DVec3) -> (String, f64) {
    let (rho, le) = (draw.between(0.3, 0.9), draw.between(0.5, 4.0));
    let scene = format!(
        "{}{}Group {{\n  {}\n  MaterialIndex emitter {emitter}\n}}",
        near(n),
        floor_and_light(rho, le),
        floor(n)
    );
    (scene, rho / PI * le)
}

fn disk(draw: &mut Parameters) -> Form {
    let (r, h, up) = (draw.between(0.3, 1.5), draw.between(0.8, 2.0), draw.direction(-1.0));
    let emitter = format!("Disk {{ center {}  normal {}  radius {r} }}", text(h * up), text(-up));
    let (scene, factor) = lit(draw, &emitter, up);
    let expected = factor * PI * r * r / (r * r + h * h);
    Form::new(format!("S4 disk, radius {r}, height {h}"), scene, expected, LIGHTS).bounces(0)
}

fn sphere(draw: &mut Parameters) -> Form {
    let (r, d, up) = (draw.between(0.3, 0.8), draw.between(1.5, 3.0), draw.direction(-1.0));
    // Its lowest point stays above the horizon.
    let towards = (up + 0.8 * up.any_orthonormal_vector()).normalize();
    let emitter = format!("Sphere {{ center {}  radius {r} }}", text(d * towards));
    let (scene, factor) = lit(draw, &emitter, up);
    let expected = factor * PI * (r / d).powi(2) * towards.dot(up);
    Form::new(format!("S4 sphere, radius {r}, distance {d}"), scene, expected, LIGHTS).bounces(0)
}

/// A sphere through which its far side is seen: of both sides together, as much as one does not let pass twice.
fn gauze(draw: &mut Parameters) -> Form {
    let (r, d, up) = (draw.between(0.3, 0.8), draw.between(1.5, 3.0), draw.direction(-1.0));
    let (opacity, towards) = (draw.between(0.2, 0.8), (up + 0.8 * up.any_orthonormal_vector()).normalize());
    let (scene, factor) = lit(draw, &format!("Sphere {{ center {}  radius {r} }}", text(d * towards)), up);
    let thinned = format!("Matte emitter {{ color 0 0 0  opacity {opacity}");
    let scene = scene.replacen("Material emitter { diffuseColor 0 0 0", &thinned, 1);
    let seen = 1.0 - (1.0 - opacity).powi(2);
    let expected = factor * seen * PI * (r / d).powi(2) * towards.dot(up);
    Form::new(format!("sphere of opacity {opacity}, radius {r}, distance {d}"), scene, expected, LIGHTS)
        .bounces(0)
}

fn sphere_touched(draw: &mut Parameters) -> Form {
    let (r, gap) = (draw.between(0.5, 1.0), draw.between(0.1, 0.3));
    let emitter = format!("Sphere {{ center 0 {} 0  radius {r} }}", r + gap);
    let (scene, factor) = lit(draw, &emitter, DVec3::Y);
    let expected = factor * PI * (r / (r + gap)).powi(2);
    Form::new(format!("S4 sphere, radius {r}, {gap} above the floor"), scene, expected, LIGHTS).bounces(0)
}

/// * `t`: how far the edge's shadow is from the disk's middle, in radii; the rest is drawn
fn penumbra(draw: &mut Parameters, t: f64, size: f64) -> Form {
    let h = draw.between(1.0, 2.0);
    let r = size * draw.between(0.5, 1.0) * h;
    let t = t + draw.between(-0.1, 0.1);
    // The blocker at half the height leaves `x < t r` of the disk.
    let emitter = format!(
        "Disk {{ center 0 {h} 0  normal 0 -1 0  radius {r} }}\n  \
         MaterialIndex black Quad {{ corner {} {} -50  edge1 0 0 100  edge2 100 0 0 }}",
        0.5 * t * r,
        0.5 * h
    );
    let (scene, factor) = lit(draw, &emitter, DVec3::Y);
    // With x = -r cos a the strips' ends are smooth.
    let strip = |a: f64| {
        let (x, half) = (-r * a.cos(), r * a.sin());
        let q = x * x + h * h;
        let across = half / (q * (q + half * half)) + (half / q.sqrt()).atan() / q.powf(1.5);
        h * h * across * r * a.sin()
    };
    let expected = factor * simpson(0.0, (-t).acos(), 500, strip);
    let methods = if size < 0.1 { SMALL_LIGHTS } else { LIGHTS };
    let name = format!("S6 penumbra of a disk, radius {r:.4}, height {h}, edge at {t:.3} radii");
    Form::new(name, scene, expected, methods).bounces(0)
}

/// A floor under the lights of a `Lights` block.
fn under(rho: f64, n: DVec3, lights: &str) -> String {
    format!("{}Lights {{ {lights} }}\n{}Group {{ {} }}", near(n), floor_and_light(rho, 1.0), floor(n))
}

fn point(draw: &mut Parameters) -> Form {
    let (rho, i, d) = (draw.between(0.3, 0.9), draw.between(1.0, 9.0), draw.between(1.0, 3.0));
    let towards = draw.direction(0.2);
    let light = format!("PointLight {{ position {}  intensity {i} {i} {i} }}", text(d * towards));
    let expected = rho / PI * i * towards.y / (d * d);
    Form::new("point light", under(rho, DVec3::Y, &light), expected, POINTS).bounces(0)
}

fn directional(draw: &mut Parameters) -> Form {
    let (rho, e, towards) = (draw.between(0.3, 0.9), draw.between(1.0, 9.0), draw.direction(0.2));
    let light = format!("DirectionalLight {{ direction {}  irradiance {e} {e} {e} }}", text(-towards));
    const METHODS: &[Method] = &[PATH, PATH_LIGHTS, PATH_SPECTRAL, BIDIRECTIONAL, DIRECT, CLASSIC];
    let expected = rho / PI * e * towards.y;
    Form::new("directional light", under(rho, DVec3::Y, &light), expected, METHODS).bounces(0)
}

/// A directional light with a width, and the sine of its angular radius.
fn sun(draw: &mut Parameters, e: f64, towards: DVec3) -> (String, f64) {
    let degrees = draw.between(10.0, 50.0);
    let light = format!(
        "DirectionalLight {{ direction {}  irradiance {e} {e} {e}  angle {degrees} }}",
        text(-towards)
    );
    (light, (0.5 * degrees).to_radians().sin())
}

fn disc(draw: &mut Parameters) -> Form {
    let (rho, e, towards) = (draw.between(0.3, 0.9), draw.between(1.0, 9.0), draw.direction(0.5));
    let (light, _) = sun(draw, e, towards);
    let expected = rho / PI * e * towards.y;
    Form::new("disc in the sky", under(rho, DVec3::Y, &light), expected, SKIES).bounces(0)
}

fn disc_seen(draw: &mut Parameters) -> Form {
    let (e, towards) = (draw.between(1.0, 9.0), draw.direction(0.5));
    let (light, sin) = sun(draw, e, towards);
    let scene = format!("{}Lights {{ {light} }}", spot_meter(DVec3::ZERO, towards));
    const METHODS: &[Method] = &[PATH, PATH_SCATTERING, PATH_LIGHTS, PATH_SPECTRAL, BIDIRECTIONAL, DIRECT];
    Form::new("disc in the sky, seen", scene, e / (PI * sin * sin), METHODS).bounces(0)
}

fn classic_point(draw: &mut Parameters) -> Form {
    let (rho, c, d) = (draw.between(0.3, 0.9), draw.between(1.0, 9.0), draw.between(1.0, 3.0));
    let towards = draw.direction(0.2);
    let light =
        format!("PointLight {{ position {}  color {c} {c} {c}  attenuation 0.5 0.25 2 }}", text(d * towards));
    const METHODS: &[Method] = &[CLASSIC, PATH, BIDIRECTIONAL, DIRECT];
    let expected = rho * c * towards.y / (0.5 + 0.25 * d + 2.0 * d * d);
    Form::new("point light with the classic falloff", under(rho, DVec3::Y, &light), expected, METHODS)
        .bounces(0)
}

/// * `aside`: how far from the axis the floor is, from 0 on the axis to 1 where the light ends
fn spot(draw: &mut Parameters, aside: f64) -> Form {
    let (rho, watts, d) = (draw.between(0.3, 0.9), draw.between(5.0, 50.0), draw.between(1.0, 3.0));
    let outer = draw.between(20.0, 80.0);
    let inner = outer * draw.between(0.2, 0.7);
    let (cos_inner, cos_outer) = ((inner / 2.0).to_radians().cos(), (outer / 2.0).to_radians().cos());
    let profile = |cos: f64| {
        let x = ((cos - cos_outer) / (cos_inner - cos_outer)).clamp(0.0, 1.0);
        x * x * (3.0 - 2.0 * x)
    };
    // The profile is made of polynomials in the cosine, which Simpson's rule integrates exactly.
    let filled = 1.0 - cos_inner + simpson(cos_outer, cos_inner, 2, profile);
    let angle = (aside * 0.5 * outer).to_radians();
    let axis = DVec3::new(angle.sin(), -angle.cos(), 0.0);
    let light = format!(
        "SpotLight {{ position 0 {d} 0  direction {}  angle {outer}  innerAngle {inner}  power {watts} }}",
        text(axis)
    );
    let expected = rho / PI * watts / (TAU * filled) * profile(angle.cos()) / (d * d);
    let name = format!("spot light of {watts} W, {:.1} degrees off its axis", angle.to_degrees());
    Form::new(name, under(rho, DVec3::Y, &light), expected, POINTS).bounces(0)
}

/// A luminaire whose intensity is linear in the vertical angle and between the horizontal ones of its file.
fn luminaire(draw: &mut Parameters, by_power: bool) -> Form {
    let (rho, d) = (draw.between(0.3, 0.9), draw.between(1.0, 3.0));
    let (low, high) = (draw.between(20.0, 60.0), draw.between(100.0, 300.0));
    let (vertical, horizontal) = (draw.between(5.0, 60.0), draw.between(5.0, 355.0));
    // Candela at 0 and 90 degrees from straight down, for the horizontal angles 0 and 180.
    let ends = [[high, low], [0.5 * high, 0.25 * low]];
    let file = format!(
        "IESNA:LM-63-1995\nTILT=NONE\n1 -1 1  2 2 1 2  0 0 0\n1 1 50\n0 90\n0 180\n{} {}\n{} {}\n",
        ends[0][0], ends[0][1], ends[1][0], ends[1][1]
    );
    let [s, t] = [vertical / 90.0, (180.0 - (horizontal - 180.0_f64).abs()) / 180.0];
    let row = |[a, b]: [f64; 2]| a + s * (b - a);
    let candela = (1.0 - t) * row(ends[0]) + t * row(ends[1]);
    // The mean of both horizontal angles, and the integral of (a + (b - a) 2v/pi) sin v: 2 pi (a + (b - a) 2/pi).
    let [a, b] = [0, 1].map(|v| 0.5 * (ends[0][v] + ends[1][v]));
    let flux = TAU * (a + (b - a) * 2.0 / PI);
    let watts = draw.between(5.0, 50.0);
    let (word, factor) =
        if by_power { (format!("power {watts}"), watts / flux) } else { ("scale 0.01".to_owned(), 0.01) };
    // The floor is at the origin, and the horizontal angle 0 at the side of +x, counted towards -z.
    let [(sv, cv), (sh, ch)] = [vertical, horizontal].map(|degrees| degrees.to_radians().sin_cos());
    let down = DVec3::new(sv * ch, -cv, -sv * sh);
    let light = format!("PointLight {{ position {}  ies luminaire.ies  {word} }}", text(-d * down));
    let expected = rho / PI * factor * candela * cv / (d * d);
    let name = format!("luminaire of {word} at {vertical} and {horizontal} degrees");
    Form::new(name, under(rho, DVec3::Y, &light), expected, POINTS)
        .bounces(0)
        .file("luminaire.ies", file)
        .rounding(1e-4)
}

fn wall(draw: &mut Parameters, methods: &'static [Method], name: &str) -> Form {
    let (rho, sky) = (draw.between(0.3, 0.9), draw.between(0.5, 3.0));
    let (distance, phi) = (draw.between(0.5, 1.0), draw.between(20.0, 80.0).to_radians());
    let scene = format!(
        "{}Group {{ {}\n  MaterialIndex black Quad {{ corner {distance} 0 -2000  edge1 0 0 4000  edge2 0 {} 0 }} }}",
        near(DVec3::Y).replace("color 0 0 0", &format!("color {sky} {sky} {sky}"))
            + &floor_and_light(rho, 1.0),
        floor(DVec3::Y),
        distance * phi.tan()
    );
    let open = 0.5 * (1.0 + phi.cos());
    let expected = if methods == [OCCLUSION] { open } else { rho * sky * open };
    let name = format!("{name} beside a wall of {:.1} degrees", phi.to_degrees());
    Form::new(name, scene, expected, methods).bounces(0)
}

/// A whole rectangle, seen from the side along parallel rays, lit by a light that sends nothing to the camera.
///
/// * `view`: direction of the rays
/// * `center`: of the rectangle
/// * `frame`: side of the picture
fn seen_whole(view: DVec3, center: DVec3, frame: f64, objects: &str, rho: f64, le: f64) -> String {
    format!(
        "OrthographicCamera {{ center {}  direction {}  up {}  size {frame} }}\nBackground {{ color 0 0 0 }}\n{}\
         Group {{ {objects} }}",
        text(center - view),
        text(view),
        text(view.any_orthogonal_vector()),
        floor_and_light(rho, le).replace("Material emitter {", "Material emitter { emits front ")
    )
}

/// Pictures of whole rectangles have edges.
const GRID: [u32; 2] = [16, 16];

fn facing(draw: &mut Parameters) -> Form {
    let (rho, le) = (draw.between(0.3, 0.9), draw.between(0.5, 4.0));
    let [a, b, c] = [0; 3].map(|_| draw.between(0.5, 1.5));
    let objects = format!(
        "MaterialIndex floor Quad {{ corner 0 0 0  edge1 0 0 {b}  edge2 {a} 0 0 }}\n  \
         MaterialIndex emitter Quad {{ corner 0 {c} 0  edge1 {a} 0 0  edge2 0 0 {b} }}"
    );
    // So flat that the light does not stand in the way.
    let view = DVec3::new(0.0, -c, 1.3 * b).normalize();
    let frame = 1.2 * a.hypot(b);
    let scene = seen_whole(view, DVec3::new(0.5 * a, 0.0, 0.5 * b), frame, &objects, rho, le);
    let f = factor_facing(a / c, b / c);
    let expected = rho * le * f * a * b * -view.y / (frame * frame);
    let name = format!("S5 rectangles {a} x {b} that face each other at {c}");
    Form::new(name, scene, expected, WHOLE).bounces(0).size(GRID)
}

fn adjacent(draw: &mut Parameters) -> Form {
    let (rho, le) = (draw.between(0.3, 0.9), draw.between(0.5, 4.0));
    // The floor is l by w, the light l by h, and they share the edge of length l.
    let [l, w, h] = [0; 3].map(|_| draw.between(0.5, 1.5));
    let objects = format!(
        "MaterialIndex floor Quad {{ corner 0 0 0  edge1 0 0 {w}  edge2 {l} 0 0 }}\n  \
         MaterialIndex emitter Quad {{ corner 0 0 0  edge1 {l} 0 0  edge2 0 {h} 0 }}"
    );
    // Along the light, which is then a line.
    let view = DVec3::new(1.0, -1.0, 0.0).normalize();
    let frame = 1.2 * l.hypot(w);
    let scene = seen_whole(view, DVec3::new(0.5 * l, 0.0, 0.5 * w), frame, &objects, rho, le);
    let f = factor_adjacent(w / l, h / l);
    let expected = rho * le * f * l * w * -view.y / (frame * frame);
    let name = format!("S5 rectangles {l} x {w} and {l} x {h} at a right angle");
    Form::new(name, scene, expected, WHOLE).bounces(0).size(GRID)
}

/// Form factor between equal rectangles that face each other; sides over their distance.
fn factor_facing(x: f64, y: f64) -> f64 {
    let (p, q) = (1.0 + x * x, 1.0 + y * y);
    2.0 / (PI * x * y)
        * ((p * q / (p + q - 1.0)).sqrt().ln()
            + x * q.sqrt() * (x / q.sqrt()).atan()
            + y * p.sqrt() * (y / p.sqrt()).atan()
            - x * x.atan()
            - y * y.atan())
}

/// Form factor from a rectangle of width `w` to one of height `h` on a common edge of length 1, at a right angle.
fn factor_adjacent(w: f64, h: f64) -> f64 {
    let (ww, hh) = (w * w, h * h);
    let (all, both) = (1.0 + ww + hh, ww + hh);
    let logarithms = ((1.0 + ww) * (1.0 + hh) / all).ln()
        + ww * (ww * all / ((1.0 + ww) * both)).ln()
        + hh * (hh * all / ((1.0 + hh) * both)).ln();
    let angles = w * (1.0 / w).atan() + h * (1.0 / h).atan() - both.sqrt() * (1.0 / both.sqrt()).atan();
    (angles + 0.25 * logarithms) / (PI * w)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_faces_of_a_cube_see_all_of_each_other() {
        let (opposite, adjacent) = (factor_facing(1.0, 1.0), factor_adjacent(1.0, 1.0));
        assert!((opposite - 0.199_824_896).abs() < 1e-9);
        assert!((adjacent - 0.200_043_776).abs() < 1e-9);
        // Of a box of 1 x 2 x 3, seen from the face of 1 x 2.
        let all = factor_facing(1.0 / 3.0, 2.0 / 3.0)
            + 2.0 * factor_adjacent(2.0, 3.0)
            + 2.0 * factor_adjacent(0.5, 1.5);
        assert!((all - 1.0).abs() < 1e-12);
    }
}
