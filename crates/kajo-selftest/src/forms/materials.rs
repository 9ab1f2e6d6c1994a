//! Materials: panes, absorbing bodies, and surfaces that lose no light.
//!
//! *Pane.* With `r` the reflectance of one face and `a = exp(-sigma d / cos)` what one crossing lets through, light that
//! goes to and fro without interference adds up to
//!
//! ```text
//! T = (1 - r)^2 a / (1 - r^2 a^2)        R = r + r a T
//! ```
//!
//! both for a pane without thickness and for a block whose two faces are followed one by one. `r` is the mean of
//! Fresnel's terms for both polarisations.
//!
//! *Absorber.* Bodies of index 1 bend nothing, and weaken light by `exp(-sigma d)`; where two overlap, the one of the
//! higher priority is there.
//!
//! *Relief.* A matt surface of albedo `rho` whose normals lean by `a` against parallel light of the irradiance `E` across it
//! has the radiance `rho/pi E cos(t)` from everywhere, however low, with `t` between the leaning normal and the light.
//!
//! *White furnace.* In even light a surface that absorbs nothing is as bright as the light around it, whatever its
//! roughness. The tables of energy that rough surfaces are completed by are good to a few parts in a thousand.

use std::f64::consts::PI;

use kajo_math::DVec3;

use super::{Form, Parameters, spot_meter, text};
use crate::method::{BIDIRECTIONAL, DIRECT, Method, PATH, PATH_LIGHTS, PATH_SCATTERING, PATH_SPECTRAL};

/// What follows glass, and lights behind it that are met.
const CLEAR: &[Method] = &[PATH, PATH_SPECTRAL, DIRECT];

/// What solves a surface under one light of no size.
const LIT: &[Method] = &[PATH, PATH_LIGHTS, PATH_SPECTRAL, BIDIRECTIONAL, DIRECT];

/// What follows light through a world of surfaces.
const FURNACE: &[Method] = &[PATH, PATH_SCATTERING, PATH_LIGHTS, PATH_SPECTRAL];

/// Error of tabulated energies.
const OF_TABLES: f64 = 3e-3;

/// The same for a ball of glass that is rougher one way than the other, which light meets several times.
const OF_BRUSHED_TABLES: f64 = 1e-2;

pub fn forms(draw: &mut Parameters) -> Vec<Form> {
    let mut forms = Vec::new();
    for is_block in [false, true] {
        for reflected in [false, true] {
            forms.push(pane(draw, is_block, reflected));
        }
    }
    let shared: Vec<Form> = forms.iter().flat_map(|form| [form.shared(), form.chained()]).collect();
    forms.extend([absorber(draw), overlapping_absorbers(draw)]);
    forms.extend([5.0, 20.0, 60.0].map(|elevation| relief(draw, elevation)));
    let roughness = draw.between(0.2, 0.9);
    for (name, material) in [
        ("gold-like metal", format!("Metal m {{ color 1 1 1  roughness {roughness} }}")),
        (
            "Beckmann metal",
            format!("Metal m {{ color 1 1 1  roughness {roughness}  distribution beckmann }}"),
        ),
        ("clay", format!("Matte m {{ color 1 1 1  roughness {roughness} }}")),
        ("frosted glass", format!("Glass m {{ roughness {roughness} }}")),
        ("a clear pane", "Glass m { thin on }".to_owned()),
        ("a frosted pane", format!("Glass m {{ thin on  roughness {roughness} }}")),
        ("plastic", format!("Principled m {{ color 1 1 1  roughness {roughness} }}")),
        ("coat", format!("Principled m {{ color 1 1 1  roughness {roughness}  coat 1  coatRoughness 0.3 }}")),
        ("velvet", format!("Principled m {{ color 1 1 1  roughness {roughness}  fuzz 1 }}")),
        ("gauze", "Matte m { color 1 1 1  opacity 0.4 }".to_owned()),
    ] {
        forms.push(furnace(draw, name, &material).rounding(OF_TABLES));
    }
    forms.extend(shared);
    let (roughness, anisotropy) = (draw.between(0.2, 0.7), draw.between(0.2, 0.6));
    let brushed = format!(
        "Principled m {{ transmission 1  color 1 1 1  roughness {roughness}  anisotropy {anisotropy} }}"
    );
    forms.push(furnace(draw, "brushed glass", &brushed).rounding(OF_BRUSHED_TABLES));
    forms
}

/// Mean reflectance of both polarisations at glass of index `n`, and the cosine inside.
fn fresnel(cos: f64, n: f64) -> (f64, f64) {
    let inside = (1.0 - (1.0 - cos * cos) / (n * n)).sqrt();
    let [s, p] = [(cos - n * inside) / (cos + n * inside), (n * cos - inside) / (n * cos + inside)];
    (0.5 * (s * s + p * p), inside)
}

/// A pane at the origin across the y axis, with a light behind it or where it mirrors to.
fn pane(draw: &mut Parameters, is_block: bool, reflected: bool) -> Form {
    let (n, sigma, le) = (draw.between(1.2, 2.0), draw.between(0.0, 20.0), draw.between(0.5, 4.0));
    let (thickness, degrees) = (0.02, draw.between(30.0, 65.0));
    let (sin, cos) = degrees.to_radians().sin_cos();
    let (r, inside) = fresnel(cos, n);
    let a = (-sigma * thickness / inside).exp();
    let through = (1.0 - r).powi(2) * a / (1.0 - r * r * a * a);
    let share = if reflected { r + r * a * through } else { through };
    let glass = format!("Glass glass {{ indexOfRefraction {n}  absorption {sigma} {sigma} {sigma} ");
    let (glass, object) = if is_block {
        (format!("{glass} }}"), format!("Box {{ min -40 -{thickness} -40  max 40 0 40 }}"))
    } else {
        let quad = "Quad { corner -40 0 -40  edge1 0 0 80  edge2 80 0 0 }".to_owned();
        (format!("{glass} thickness {thickness} }}"), quad)
    };
    let light = if reflected {
        // Across the mirrored ray, beside the one from the camera.
        let (middle, across) = (3.0 * DVec3::new(-sin, cos, 0.0), DVec3::new(cos, sin, 0.0));
        let corner = middle - across - DVec3::Z;
        format!("Quad {{ corner {}  edge1 {}  edge2 0 0 2 }}", text(corner), text(2.0 * across))
    } else {
        "Quad { corner -90 -1 -90  edge1 0 0 180  edge2 180 0 0 }".to_owned()
    };
    let scene = format!(
        "{}Materials {{ {glass}\nMaterial light {{ diffuseColor 0 0 0  emission {le} {le} {le} }} }}\n\
         Group {{ MaterialIndex glass {object}\nMaterialIndex light {light} }}",
        spot_meter(3.0 * DVec3::new(sin, cos, 0.0), DVec3::ZERO)
    );
    let (kind, way) =
        (if is_block { "block" } else { "pane" }, if reflected { "mirrored" } else { "let through" });
    let name = format!("S8 {kind} of index {n} at {degrees} degrees, absorption {sigma}, light {way}");
    Form::new(name, scene, le * share, CLEAR).bounces(60).rounding(1e-4)
}

/// An emissive wall seen through objects in front of it.
fn before_a_wall(
    draw: &mut Parameters,
    view: &str,
    materials: &str,
    objects: &str,
    share: f64,
) -> (String, f64) {
    let le = draw.between(0.5, 4.0);
    let scene = format!(
        "{view}Materials {{ {materials}\nMaterial light {{ diffuseColor 0 0 0  emission {le} {le} {le} }} }}\n\
         Group {{ {objects}\nMaterialIndex light Quad {{ corner -90 -90 -30  edge1 180 0 0  edge2 0 180 0 }} }}"
    );
    (scene, le * share)
}

fn clear(name: &str, sigma: f64, priority: i32) -> String {
    format!(
        "Glass {name} {{ indexOfRefraction 1  absorption {sigma} {sigma} {sigma}  priority {priority} }}\n"
    )
}

fn absorber(draw: &mut Parameters) -> Form {
    let (sigma, radius, b) = (draw.between(0.1, 2.0), draw.between(0.5, 1.5), draw.between(0.0, 0.95));
    let chord = 2.0 * radius * (1.0 - b * b).sqrt();
    let x = b * radius;
    let view = spot_meter(DVec3::new(x, 0.0, 4.0), DVec3::new(x, 0.0, 0.0));
    let ball = format!("MaterialIndex haze Sphere {{ center 0 0 0  radius {radius} }}");
    let share = (-sigma * chord).exp();
    let (scene, expected) = before_a_wall(draw, &view, &clear("haze", sigma, 0), &ball, share);
    let name = format!("S9 ball that absorbs {sigma}, along a chord of {chord:.4}");
    Form::new(name, scene, expected, CLEAR).bounces(8)
}

fn overlapping_absorbers(draw: &mut Parameters) -> Form {
    let [first, second] = [0; 2].map(|_| draw.between(0.1, 1.0));
    let [a, b, c] = [draw.between(0.5, 1.0), draw.between(1.2, 2.0), draw.between(2.5, 3.0)];
    let view = spot_meter(DVec3::new(0.1, 0.2, 9.0), DVec3::new(0.1, 0.2, 0.0));
    let materials = clear("strong", first, 2) + &clear("weak", second, 1);
    let objects = format!(
        "MaterialIndex strong Box {{ min -1 -1 0  max 1 1 {b} }}\nMaterialIndex weak Box {{ min -0.9 -0.9 {a}  max 0.9 0.9 {c} }}"
    );
    let share = (-first * b - second * (c - b)).exp();
    let (scene, expected) = before_a_wall(draw, &view, &materials, &objects, share);
    let name = format!("S9 overlapping bodies that absorb {first} and {second}, by priority");
    Form::new(name, scene, expected, CLEAR).bounces(8)
}

/// A floor with a normal map of one texel, under parallel light, seen from this many degrees above.
fn relief(draw: &mut Parameters, elevation: f64) -> Form {
    let (rho, irradiance) = (draw.between(0.2, 0.9), draw.between(0.5, 3.0));
    let light = draw.direction(0.7);
    let [lean, along, from] = [draw.between(10.0, 40.0), draw.between(0.0, 360.0), draw.between(0.0, 360.0)];
    let [lean, along, from, elevation_angle] = [lean, along, from, elevation].map(f64::to_radians);
    // In the numbers of the file, of 16 bits; u is along x and v along -z.
    let leaning = DVec3::new(lean.sin() * along.cos(), lean.sin() * along.sin(), lean.cos());
    let texel = leaning.to_array().map(|v| ((0.5 + 0.5 * v) * 65535.0).round());
    let [nx, ny, nz] = texel.map(|v| v / 65535.0 * 2.0 - 1.0);
    let n = DVec3::new(nx, nz, -ny).normalize();
    let viewer = DVec3::new(
        elevation_angle.cos() * from.cos(),
        elevation_angle.sin(),
        elevation_angle.cos() * from.sin(),
    );
    let scene = format!(
        "{}Lights {{ DirectionalLight {{ direction {}  irradiance {irradiance} {irradiance} {irradiance} }} }}\n\
         Materials {{ Matte m {{ color {rho} {rho} {rho}  normalMap leaning.ppm }} }}\n\
         Group {{ MaterialIndex m Quad {{ corner -40 0 40  edge1 80 0 0  edge2 0 0 -80 }} }}",
        spot_meter(3.0 * viewer, DVec3::ZERO),
        text(-light)
    );
    let expected = rho / PI * irradiance * n.dot(light).max(0.0);
    let name = format!("matt relief seen from {elevation} degrees above");
    let [r, g, b] = texel;
    Form::new(name, scene, expected, LIT)
        .bounces(0)
        .file("leaning.ppm", format!("P3 1 1 65535 {r} {g} {b}\n"))
        .rounding(1e-4)
}

fn furnace(draw: &mut Parameters, name: &str, material: &str) -> Form {
    let sky = draw.between(0.5, 3.0);
    let degrees = draw.between(0.0, 75.0);
    let (sin, cos) = degrees.to_radians().sin_cos();
    let scene = format!(
        "{}Materials {{ {material} }}\nGroup {{ MaterialIndex m Sphere {{ center 0 -1 0  radius 1 }} }}",
        spot_meter(3.0 * DVec3::new(sin, cos, 0.0), DVec3::ZERO)
            .replace("color 0 0 0", &format!("color {sky} {sky} {sky}"))
    );
    let name = format!("white furnace: {name} at {degrees} degrees");
    Form::new(name, scene, sky, FURNACE).bounces(200)
}
