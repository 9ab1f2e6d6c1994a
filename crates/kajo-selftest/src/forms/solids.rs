//! Tori, and solids made by set operations, where the closed form of another shape holds.
//!
//! *Torus.* Seen from its axis at a distance `h` below, a torus fills the directions whose angle with the axis differs by less
//! than `beta` from `alpha`, `tan alpha = R/h`, `sin beta = r / sqrt(R^2 + h^2)`. The irradiance there is
//!
//! ```text
//! E = pi (sin^2(alpha + beta) - sin^2(alpha - beta)).
//! ```
//!
//! *Lathes.* A flat end towards the floor is a disk from there.
//!
//! *Sphere sweeps.* Balls that hide in one of them are that one.
//!
//! *Set operations.* What is cut out of a ball by a box around it is the ball; half a ball with its flat side towards the floor
//! is a disk from there; two half balls that meet are one, without anything between them; a clear body in even light is not to
//! be seen.
//!
//! *Isosurfaces.* A ball by an equation of its own, and a clear gyroid.
//!
//! *Blobs.* A single ball of strength `b` and radius `a` makes a sphere of radius `a sqrt(ln(b/T))` for the threshold `T`.

use std::f64::consts::PI;

use kajo_math::DVec3;
use kajo_math::solid_angle::polygon_irradiance;

use super::lights::lit;
use super::{Form, Parameters, spot_meter, text};
use crate::method::{LIGHTS, TOTAL_MIRRORS};

pub fn forms(draw: &mut Parameters) -> Vec<Form> {
    let ring = |draw: &mut Parameters| {
        let (major, minor) = (draw.between(0.5, 0.9), draw.between(0.2, 0.4));
        format!("Torus {{ axis {}  majorRadius {major}  minorRadius {minor} }}", text(draw.direction(-1.0)))
    };
    vec![
        torus(draw),
        cut_ball(draw),
        half_ball(draw),
        shell(draw),
        trough(draw),
        blob(draw),
        hollow_blob(draw),
        isosurface(draw),
        lathe(draw),
        clear(draw, "torus", ring),
        clear(draw, "lathe", vase),
        sphere_sweep(draw),
        clear(draw, "sphere sweep", knot),
        clear(draw, "ball of two halves", two_halves),
        clear(draw, "ball less a ball", hollow),
        clear(draw, "gyroid", gyroid),
        clear(draw, "displaced cube", displaced).file("cube.obj", CUBE.to_owned()),
    ]
}

fn torus(draw: &mut Parameters) -> Form {
    let (h, up) = (draw.between(0.8, 2.0), draw.direction(-1.0));
    let (major, minor) = (draw.between(0.4, 1.2), draw.between(0.05, 0.3));
    let emitter = format!(
        "Torus {{ center {}  axis {}  majorRadius {major}  minorRadius {minor} }}",
        text(h * up),
        text(up)
    );
    let (scene, factor) = lit(draw, &emitter, up);
    let (alpha, beta) = ((major / h).atan(), (minor / major.hypot(h)).asin());
    let expected = factor * PI * ((alpha + beta).sin().powi(2) - (alpha - beta).sin().powi(2));
    Form::new(format!("torus, radii {major} and {minor}, height {h}"), scene, expected, LIGHTS).bounces(0)
}

/// A top that spins over the floor: seen from below it fills what a disk does.
fn lathe(draw: &mut Parameters) -> Form {
    let (r, h, up) = (draw.between(0.4, 0.9), draw.between(1.1, 2.0), draw.direction(-1.0));
    let rise = draw.between(0.3, 0.9) * h;
    let emitter = format!(
        "Lathe {{ origin {}  axis {}  size {r}  profile {{ line 0 0  1 0  cubic 0.9 0.4  0.4 0.2  0 {} }} }}",
        text(h * up),
        text(up),
        rise / r
    );
    let (scene, factor) = lit(draw, &emitter, up);
    let expected = factor * PI * r * r / (r * r + h * h);
    Form::new(format!("lathe, radius {r}, height {h}"), scene, expected, LIGHTS).bounces(0)
}

/// A vase with a thick wall.
fn vase(draw: &mut Parameters) -> String {
    let neck = draw.between(0.2, 0.5);
    format!(
        "Lathe {{ axis {}  size 0.8  profile {{ line 0 -1  0.6 -1  cubic 1.2 -0.2  {neck} 0.2  {} 1  line {neck} 1  \
         cubic {} 0.2  0.9 -0.2  0.4 -0.8  line 0 -0.8 }} }}",
        text(draw.direction(-1.0)),
        neck + 0.15,
        neck - 0.1,
    )
}

/// Balls on a bent path within the last one, which is all that shows.
fn sphere_sweep(draw: &mut Parameters) -> Form {
    let (r, d, up) = (draw.between(0.3, 0.8), draw.between(1.5, 3.0), draw.direction(-1.0));
    let towards = (up + 0.8 * up.any_orthonormal_vector()).normalize();
    let center = d * towards;
    let at = |draw: &mut Parameters| text(center + 0.4 * r * draw.direction(-1.0));
    let emitter = format!(
        "SphereSweep {{ path {{ cubic {} {}  {} {}  {} {}  {} {r} }} }}",
        at(draw),
        0.3 * r,
        at(draw),
        0.5 * r,
        at(draw),
        0.4 * r,
        text(center)
    );
    let (scene, factor) = lit(draw, &emitter, up);
    let expected = factor * PI * (r / d).powi(2) * towards.dot(up);
    Form::new(format!("ball as a sphere sweep, radius {r}, distance {d}"), scene, expected, LIGHTS).bounces(0)
}

/// A path through random points, which crosses itself.
fn knot(draw: &mut Parameters) -> String {
    let ball = |draw: &mut Parameters| format!("{} {}", text(draw.point(0.5)), draw.between(0.1, 0.3));
    let points: Vec<String> = (0..6).map(|_| ball(draw)).collect();
    format!("SphereSweep {{ path {{ spline {} }} }}", points.join("  "))
}

fn cut_ball(draw: &mut Parameters) -> Form {
    let (r, d, up) = (draw.between(0.3, 0.8), draw.between(1.5, 3.0), draw.direction(-1.0));
    let towards = (up + 0.8 * up.any_orthonormal_vector()).normalize();
    let center = d * towards;
    let [low, high] = [-1.0, 1.0].map(|side| text(center + side * 1.5 * r));
    let emitter = format!(
        "Intersection {{ Box {{ min {low}  max {high} }}  Sphere {{ center {}  radius {r} }} }}",
        text(center)
    );
    let (scene, factor) = lit(draw, &emitter, up);
    let expected = factor * PI * (r / d).powi(2) * towards.dot(up);
    Form::new(format!("ball cut out of a box, radius {r}, distance {d}"), scene, expected, LIGHTS).bounces(0)
}

fn half_ball(draw: &mut Parameters) -> Form {
    let (r, h, up) = (draw.between(0.3, 1.0), draw.between(1.1, 2.0), draw.direction(-1.0));
    // The half space above the plane is behind its normal.
    let emitter = format!(
        "Intersection {{ Sphere {{ center {}  radius {r} }}  Plane {{ normal {}  offset {} }} }}",
        text(h * up),
        text(-up),
        -h
    );
    let (scene, factor) = lit(draw, &emitter, up);
    let expected = factor * PI * r * r / (r * r + h * h);
    Form::new(format!("half a ball, radius {r}, height {h}"), scene, expected, LIGHTS).bounces(0)
}

/// The floor sees the inside of a bowl: the rim's disk, by what is taken away.
fn shell(draw: &mut Parameters) -> Form {
    let (r, h) = (draw.between(0.4, 0.9), draw.between(1.1, 2.0));
    let inner = r * draw.between(0.7, 0.95);
    let emitter = format!(
        "Difference {{ Sphere {{ center 0 {h} 0  radius {r} }}\n  Sphere {{ center 0 {h} 0  radius {inner} }}\n  \
         Box {{ min -2 -2 -2  max 2 {h} 2 }} }}"
    );
    let (scene, factor) = lit(draw, &emitter, DVec3::Y);
    let expected = factor * PI * r * r / (r * r + h * h);
    Form::new(format!("bowl, radii {inner} and {r}, height {h}"), scene, expected, LIGHTS).bounces(0)
}

/// The same with a box that is open below, and a rectangle.
fn trough(draw: &mut Parameters) -> Form {
    let [a, b] = [draw.between(0.4, 0.9), draw.between(0.4, 0.9)];
    let (wall, h) = (draw.between(0.05, 0.2), draw.between(0.8, 1.5));
    let (x, z) = (a - wall, b - wall);
    let emitter = format!(
        "Difference {{ Box {{ min -{a} {h} -{b}  max {a} {} {b} }}  Box {{ min -{x} 0 -{z}  max {x} {} {z} }} }}",
        h + 0.7,
        h + 0.6
    );
    let (scene, factor) = lit(draw, &emitter, DVec3::Y);
    let rim = [[-a, -b], [a, -b], [a, b], [-a, b]].map(|[x, z]| DVec3::new(x, h, z));
    let expected = factor * polygon_irradiance(DVec3::ZERO, DVec3::Y, &rim).abs();
    Form::new(format!("trough of {a} and {b}, height {h}"), scene, expected, LIGHTS).bounces(0)
}

/// A sphere of radius `r`, as a blob of one ball.
fn blob_of(draw: &mut Parameters, center: DVec3, r: f64) -> String {
    let (strength, threshold) = (draw.between(1.5, 3.0), draw.between(0.4, 1.2));
    let radius = r / (strength / threshold).ln().sqrt();
    format!(
        "Blob {{ threshold {threshold}  sphere {{ center {}  radius {radius}  strength {strength} }} }}",
        text(center)
    )
}

fn blob(draw: &mut Parameters) -> Form {
    let (r, d, up) = (draw.between(0.3, 0.8), draw.between(1.5, 3.0), draw.direction(-1.0));
    let towards = (up + 0.8 * up.any_orthonormal_vector()).normalize();
    let emitter = blob_of(draw, d * towards, r);
    let (scene, factor) = lit(draw, &emitter, up);
    let expected = factor * PI * (r / d).powi(2) * towards.dot(up);
    Form::new(format!("ball as a blob, radius {r}, distance {d}"), scene, expected, LIGHTS).bounces(0)
}

/// A ball as a function, told so that nobody sees that it is one.
fn isosurface(draw: &mut Parameters) -> Form {
    let (r, d, up) = (draw.between(0.3, 0.8), draw.between(1.5, 3.0), draw.direction(-1.0));
    let towards = (up + 0.8 * up.any_orthonormal_vector()).normalize();
    let center = d * towards;
    let [x, y, z] = center.to_array();
    let [low, high] = [-1.0, 1.0].map(|side| text(center + side * 1.2 * r));
    let emitter = format!(
        "Isosurface {{ function = exp((x - ({x}))^2 + (y - ({y}))^2) - exp({r}^2 - (z - ({z}))^2)  \
         min {low}  max {high} }}"
    );
    let (scene, factor) = lit(draw, &emitter, up);
    let expected = factor * PI * (r / d).powi(2) * towards.dot(up);
    Form::new(format!("ball as an isosurface, radius {r}, distance {d}"), scene, expected, LIGHTS).bounces(0)
}

/// The floor sees the inside of a bowl whose hollow is a blob.
fn hollow_blob(draw: &mut Parameters) -> Form {
    let (r, h) = (draw.between(0.4, 0.9), draw.between(1.1, 2.0));
    let inner = r * draw.between(0.7, 0.95);
    let ball = blob_of(draw, h * DVec3::Y, inner);
    let emitter = format!(
        "Difference {{ Sphere {{ center 0 {h} 0  radius {r} }}\n  {ball}\n  Box {{ min -2 -2 -2  max 2 {h} 2 }} }}"
    );
    let (scene, factor) = lit(draw, &emitter, DVec3::Y);
    let expected = factor * PI * r * r / (r * r + h * h);
    Form::new(format!("bowl by a blob, radii {inner} and {r}, height {h}"), scene, expected, LIGHTS)
        .bounces(0)
}

fn clear(draw: &mut Parameters, name: &str, body: impl Fn(&mut Parameters) -> String) -> Form {
    let (sky, n) = (draw.between(0.5, 4.0), draw.between(1.2, 2.0));
    let body = body(draw);
    let scene = format!(
        "{}Materials {{ Material glass {{ diffuseColor 0 0 0  transparentColor 1 1 1  indexOfRefraction {n} }} }}\n\
         Group {{ MaterialIndex glass {body} }}",
        spot_meter(4.0 * draw.direction(-1.0), draw.point(0.5))
            .replace("color 0 0 0", &format!("color {sky} {sky} {sky}"))
    );
    Form::new(format!("clear {name} of index {n} in even light"), scene, sky, TOTAL_MIRRORS).bounces(100)
}

fn two_halves(draw: &mut Parameters) -> String {
    let (n, offset) = (draw.direction(-1.0), draw.between(-0.5, 0.5));
    let half = |n: DVec3, offset: f64| {
        let n = text(n);
        format!(
            "Intersection {{ Sphere {{ center 0 0 0  radius 1 }}  Plane {{ normal {n}  offset {offset} }} }}"
        )
    };
    format!("Merge {{ {} {} }}", half(n, offset), half(-n, -offset))
}

fn displaced(draw: &mut Parameters) -> String {
    let (moved, crease) = (draw.between(-0.1, 0.3), draw.between(60.0, 120.0));
    format!(
        "TriangleMesh {{ file cube.obj  smooth off  subdivide 2  creaseAngle {crease}  displacement {moved} }}"
    )
}

const CUBE: &str = "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n\
    f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";

fn hollow(draw: &mut Parameters) -> String {
    let (center, radius) = (draw.point(0.2), draw.between(0.2, 0.5));
    let inner = format!("Sphere {{ center {}  radius {radius} }}", text(center));
    format!("Difference {{ Sphere {{ center 0 0 0  radius 1 }}  {inner} }}")
}

fn gyroid(draw: &mut Parameters) -> String {
    let k = draw.between(3.0, 5.0);
    let wave = |a: &str, b: &str| format!("sin({k} * {a}) * cos({k} * {b})");
    let function = [wave("x", "y"), wave("y", "z"), wave("z", "x")].join(" + ");
    format!("Intersection {{ Sphere {{ center 0 0 0  radius 1 }}  Isosurface {{ function = {function} }} }}")
}
