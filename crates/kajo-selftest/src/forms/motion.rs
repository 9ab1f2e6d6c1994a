//! Things that move while the shutter is open.
//!
//! A pixel shows the mean over the time the shutter is open, so a place of the picture that an even object covers for a
//! share `s` of that time has `s` of its light.
//!
//! *A bar* of width `w` that moves by `d` covers a place for `w/d` of the time, less where it comes too late or leaves
//! before the end: seen over all places a trapezoid, `1` at most. *A sector* of the angle `a` that makes a full turn
//! covers every place for `a / 2 pi`, whether or not it and the camera move along together. *An edge* that a camera
//! pans over, by the angle `b` into a pan by `a`, is on the far side for `1 - b/a`; and so it is when the edge is panned
//! past the camera. *A patterned disk* that spins shows the mean of its pattern over each circle.
//!
//! Shares of time are measured with independent moments: strata that a moment's edges happen to match
//! would agree with each other by chance and say nothing of their error.
//!
//! *Emitters* light a floor by the mean over time of the closed forms for emitters at rest, by quadrature.

use std::f64::consts::{PI, TAU};

use kajo_math::{DMat3, DVec3};

use super::lights::lit;
use super::polygon::irradiance;
use super::quadrature::simpson;
use super::{Form, Parameters, spot_meter, text, triangle};
use crate::method::{CLASSIC, DIRECT, LIGHTS, Method, PATH};

/// What draws moments: everything.
const MOMENTS: &[Method] = &[PATH, DIRECT, CLASSIC];

/// An emitter that is seen, not what it lights.
const BRIGHT: &str =
    "Materials { Material emitter { diffuseColor 0 0 0  ambientColor 1 1 1  emission 1 1 1 } }\n";

/// A full turn around the z axis.
const SPIN: &str = "Motion { key 0 { }  key 0.333333333 { ZRotate 120 }  key 0.666666667 { ZRotate 240 }  key 1 { ZRotate 360 } }";

pub fn forms(draw: &mut Parameters) -> Vec<Form> {
    let mut forms = vec![bar_comes(draw), bar_passes(draw), bar_leaves(draw)];
    forms.extend([sector(draw, false), sector(draw, true), pan(draw, false), pan(draw, true)]);
    forms.extend([spinning_pattern(draw), moving_sphere(draw), growing_disk(draw), turning_triangle(draw)]);
    forms
}

/// A bar of width `w`, its left edge at `start` from the place that is seen, that moves by `d` to the right.
fn bar(draw: &mut Parameters, [w, d, start]: [f64; 3]) -> Form {
    // The shutter is open during the middle half of the motion.
    let keys = [start - 0.5 * d, start + 1.5 * d];
    let meter = spot_meter(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO).replacen('{', "{ shutter 1 3 ", 1);
    let scene = format!(
        "{meter}{BRIGHT}Group {{ MaterialIndex emitter Transform {{ ZRotate {}\n  \
         Motion {{ key 0 {{ Translate {} 0 0 }}  key 4 {{ Translate {} 0 0 }} }}\n  \
         Quad {{ corner 0 -1 0  edge1 {w} 0 0  edge2 0 2 0 }} }} }}",
        draw.between(0.0, 360.0),
        keys[0],
        keys[1],
    );
    let (enters, leaves) = ((-w - start) / d, -start / d);
    let expected = leaves.min(1.0) - enters.max(0.0);
    Form::new(format!("moving bar, {w:.4} wide, by {d}"), scene, expected, MOMENTS)
        .pattern("uniform")
        .rounding(2e-4)
}

fn bar_comes(draw: &mut Parameters) -> Form {
    let (d, enters) = (draw.between(0.4, 1.0), draw.between(0.2, 0.8));
    let w = d * draw.between(1.0, 2.0);
    bar(draw, [w, d, -w - d * enters])
}

fn bar_passes(draw: &mut Parameters) -> Form {
    let (d, enters) = (draw.between(0.4, 1.0), draw.between(0.1, 0.5));
    let w = d * draw.between(0.1, 0.4);
    bar(draw, [w, d, -w - d * enters])
}

fn bar_leaves(draw: &mut Parameters) -> Form {
    let (w, d) = (draw.between(0.5, 1.0), draw.between(0.5, 1.0));
    let start = -draw.between(0.1, 0.9) * w.min(d);
    bar(draw, [w, d, start])
}

/// * `together`: whether the camera and the sector move along as well
fn sector(draw: &mut Parameters, together: bool) -> Form {
    let (angle, place) = (draw.between(0.3, 1.5), 0.5 * draw.direction(-1.0));
    let (sin, cos) = (0.5 * angle).sin_cos();
    let along = match together {
        true => format!("Motion {{ key 0 {{ }}  key 1 {{ Translate {} }} }}", text(draw.point(2.0))),
        false => String::new(),
    };
    let seen = DVec3::new(place.x, place.y + 0.1, 0.0);
    let meter = spot_meter(DVec3::new(0.0, 0.0, 5.0), seen).replacen('{', &format!("{{ {along} "), 1);
    let blade = [DVec3::ZERO, DVec3::new(2.0 * cos, -2.0 * sin, 0.0), DVec3::new(2.0 * cos, 2.0 * sin, 0.0)];
    let scene = format!(
        "{meter}{BRIGHT}Group {{ MaterialIndex emitter Transform {{ {along} {SPIN} {} }} }}",
        triangle(blade)
    );
    let name = format!("spinning sector of {angle} rad{}", if together { ", camera goes along" } else { "" });
    Form::new(name, scene, angle / TAU, MOMENTS).pattern("uniform").rounding(2e-4)
}

/// * `by_camera`: whether the camera turns, or everything else
fn pan(draw: &mut Parameters, by_camera: bool) -> Form {
    let angle = draw.between(20.0, 40.0);
    let edge = angle * draw.between(0.2, 0.8);
    let turn = |degrees: f64| format!("Motion {{ key 0 {{ }}  key 1 {{ YRotate {degrees} }} }}");
    let (camera, world) =
        if by_camera { (turn(-angle), String::new()) } else { (String::new(), turn(angle)) };
    let meter = spot_meter(DVec3::ZERO, DVec3::NEG_Z).replacen('{', &format!("{{ {camera} "), 1);
    let scene = format!(
        "{meter}{BRIGHT}Group {{ MaterialIndex emitter Transform {{ {world}\n  \
         Quad {{ corner {} -9 -4  edge1 9 0 0  edge2 0 18 0 }} }} }}",
        4.0 * edge.to_radians().tan()
    );
    let name = format!("pan of {} by {angle} degrees", if by_camera { "the camera" } else { "an edge" });
    Form::new(name, scene, 1.0 - edge / angle, MOMENTS).pattern("uniform").rounding(2e-4)
}

fn spinning_pattern(draw: &mut Parameters) -> Form {
    let (radius, size) = (draw.between(0.4, 0.9), draw.between(1.5, 4.0));
    let (x, y) = (draw.between(0.1, 0.9), draw.between(0.1, 0.9));
    let (light, dark) = (draw.between(0.5, 0.9), draw.between(0.1, 0.4));
    let place = DVec3::new(radius, 0.0, 0.0);
    let scene = format!(
        "{}Background {{ color 1 1 1  ambientLight 1 1 1 }}\n\
         Materials {{\n  \
         Material light {{ diffuseColor {light} {light} {light} }}\n  \
         Material dark {{ diffuseColor {dark} {dark} {dark} }}\n  \
         Checkerboard board {{ Transform {{ Translate {x} {y} 0.5  UniformScale {size} }}\n    \
         materialIndex light  materialIndex dark }}\n}}\n\
         Group {{ MaterialIndex board Transform {{ {SPIN} Disk {{ center 0 0 0  normal 0 0 1  radius 1 }} }} }}",
        spot_meter(place + DVec3::Z, place).replace("Background { color 0 0 0 }", "")
    );
    const STEPS: u32 = 200_000;
    let is_light = |i: &u32| {
        let phi = f64::from(*i) / f64::from(STEPS) * TAU;
        let cell = (x + size * radius * phi.cos()).floor() + (y + size * radius * phi.sin()).floor();
        cell.rem_euclid(2.0) == 0.0
    };
    let share = (0..STEPS).filter(is_light).count() as f64 / f64::from(STEPS);
    let expected = share * light + (1.0 - share) * dark;
    let name = format!("spinning checkerboard at {radius} from its axis");
    Form::new(name, scene, expected, MOMENTS).pattern("uniform").bounces(0).rounding(2e-4)
}

fn moving_sphere(draw: &mut Parameters) -> Form {
    let (r, n) = (draw.between(0.2, 0.4), draw.direction(-1.0));
    let across = n.any_orthonormal_vector();
    let ends = [-1.5, 1.5].map(|x| (0.5 + draw.between(0.0, 1.0)) * n + draw.between(0.5, 1.0) * x * across);
    let emitter = format!(
        "Transform {{ Motion {{ key 0 {{ Translate {} }}  key 1 {{ Translate {} }} }}\n  \
         Sphere {{ center 0 0 0  radius {r} }} }}",
        text(ends[0]),
        text(ends[1])
    );
    let (scene, factor) = lit(draw, &emitter, n);
    let irradiance = |t: f64| {
        let c = ends[0].lerp(ends[1], t);
        PI * r * r * c.dot(n) / c.length().powi(3)
    };
    let expected = factor * simpson(0.0, 1.0, 500, irradiance);
    Form::new(format!("moving sphere, radius {r}"), scene, expected, LIGHTS).bounces(0)
}

fn growing_disk(draw: &mut Parameters) -> Form {
    let n = draw.direction(-1.0);
    let (h, r) = ([0, 1].map(|_| draw.between(0.8, 2.0)), [0, 1].map(|_| draw.between(0.3, 1.2)));
    let key = |t: usize| format!("key {t} {{ Translate {}  UniformScale {} }}", text(h[t] * n), r[t]);
    let emitter = format!(
        "Transform {{ Motion {{ {}  {} }}\n  Disk {{ center 0 0 0  normal {}  radius 1 }} }}",
        key(0),
        key(1),
        text(-n)
    );
    let (scene, factor) = lit(draw, &emitter, n);
    let at = |ends: [f64; 2], t: f64| ends[0] + t * (ends[1] - ends[0]);
    let irradiance = |t: f64| {
        let (r2, h2) = (at(r, t).powi(2), at(h, t).powi(2));
        PI * r2 / (r2 + h2)
    };
    let expected = factor * simpson(0.0, 1.0, 200, irradiance);
    Form::new(format!("growing disk, radius {} to {}", r[0], r[1]), scene, expected, LIGHTS).bounces(0)
}

fn turning_triangle(draw: &mut Parameters) -> Form {
    let n = draw.direction(-1.0);
    let (centre, angle) = (draw.between(0.9, 1.5) * n, draw.between(60.0, 160.0));
    let [axis, across] = [draw.direction(-1.0), draw.direction(-1.0)];
    let (u, v) = (across.any_orthonormal_vector(), across.cross(across.any_orthonormal_vector()));
    let corners = [u, -0.5 * u + 0.8 * v, -0.4 * u - 0.9 * v].map(|corner| 0.7 * corner);
    let emitter = format!(
        "Transform {{ Translate {}  Motion {{ key 0 {{ }}  key 1 {{ Rotate {} {angle} }} }}\n  {} }}",
        text(centre),
        text(axis),
        triangle(corners)
    );
    let (scene, factor) = lit(draw, &emitter, n);
    let seen = |t: f64| {
        let turned = DMat3::from_axis_angle(axis, t * angle.to_radians());
        irradiance(&corners.map(|corner| centre + turned * corner), n)
    };
    let expected = factor * simpson(0.0, 1.0, 2000, seen);
    Form::new(format!("triangle turning by {angle} degrees"), scene, expected, LIGHTS).bounces(0)
}
