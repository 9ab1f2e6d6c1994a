//! Participating media.
//!
//! *An absorber.* Over a length `d` the share `exp(-sigma_a d)` of the light is left.
//!
//! *A beam in a cube.* A beam of the irradiance 1 comes into the cube `[-1, 1]^3` from above, and the camera looks across. Light that was
//! scattered once by an isotropic medium has at the height `y` the radiance
//!
//! ```text
//! L = albedo / 4pi exp(-s (1 - y)) (1 - exp(-2 s))
//! ```
//!
//! Seen from within, up to a black disk at the distance `d`, the last factor is `1 - exp(-s d)`. In clear glass that bends next to nothing it is
//! as bright, and nothing but paths from both ends that meet in the medium finds it.
//!
//! *A point light in endless fog*, at the distance `b` from the camera's ray, whose closest point is `a` ahead:
//!
//! ```text
//! L = integral over t of  s I / (4pi r^2) exp(-s (t + r)),    r^2 = b^2 + (t - a)^2
//! ```
//!
//! *A slab that emits* by the radiance `e` per unit length and absorbs is as bright as `e / sigma_a (1 - exp(-sigma_a
//! d))`; a body that gives `sigma_a` times the radiance of an even sky is not to be seen.
//!
//! *A ball of gas over a floor* that gives `e` per unit length and absorbs nothing: the inverse squares of the distances of all of its points add up to
//! that of the middle, as those of gravity do, so a floor of albedo `rho` at the distance `h` is as bright as
//!
//! ```text
//! L = rho / pi  e (4/3) pi R^3 / h^2
//! ```
//!
//! The wall of a hollow ball around it, of the radius `h`, is brighter by the light that it scatters itself: `L / (1 - rho)`. In the middle
//! of a ball of gas that absorbs `sigma` too as much comes from everywhere, `B = e / sigma (1 - exp(-sigma R))`, so
//! there the floor is as bright as `rho B`; and seen from outside, `B + exp(-sigma R) rho B`.
//!
//! *Nothing is lost.* Whatever scatters all light is not to be seen under an even sky: homogeneous, by voxels, by a function, in clear
//! glass.

use std::f64::consts::PI;

use kajo_math::DVec3;

use super::quadrature::simpson;
use super::{Form, Parameters, STARTS, floor, spot_meter};
use crate::method::{
    BIDIRECTIONAL, BIDIRECTIONAL_SPECTRAL, GLOBAL, LIGHT, MLT, MMLT, Method, PATH, PATH_SCATTERING,
    PATH_SPECTRAL, PHOTON_DIRECT, SHARED, SPPM, VCM, VCM_ONE_RADIUS,
};

const MEDIA: &[Method] = &[PATH, PATH_SCATTERING, PATH_SPECTRAL, BIDIRECTIONAL, BIDIRECTIONAL_SPECTRAL];

/// Where lights have no size, so that they are drawn.
const DRAWN: &[Method] = &[PATH, PATH_SPECTRAL, BIDIRECTIONAL, BIDIRECTIONAL_SPECTRAL];

/// Where a body fills much of the picture, so that light finds the camera.
const WIDE: &[Method] = &[PATH, BIDIRECTIONAL, LIGHT];

/// The same by chains, which find one kind of light soonest.
const CHAINS: &[Method] = &[MLT];

/// By chains for each length, which are to be few.
const CHAINS_OF_LENGTHS: &[Method] = &[MMLT];

/// By photons, and by what joins paths where photons would be.
const PHOTONS_AND_JOINTS: &[Method] = &[SPPM, VCM];

/// By a map of photons that is seen itself, since direct light is drawn otherwise.
const SEEN: &[Method] = &[PHOTON_DIRECT];

/// Where no two vertices can be connected.
const MERGED: &[Method] = &[VCM_ONE_RADIUS];

/// Radius of the balls of [`VCM_ONE_RADIUS`].
const BALL_RADIUS: f64 = 0.06;

/// What else such balls may change behind glass, as a share of the light.
const BEHIND_GLASS: f64 = 1e-2;

/// What balls of photons may lose that reach over the border of a body, as a share of its light: those of the first passes are a tenth of it wide.
const BORDER: f64 = 5e-3;

/// What the light within such a ball may differ from that at its middle.
const BLUR: f64 = 1e-2;

/// Scatterings of which next to no path has more in the thickest of these bodies, that of voxels; the default of
/// integrators from both ends, 64, loses light there.
const WITHOUT_END: u32 = 500;

/// The noise of a map, of which few balls lie along the ray; a batch has one, however many samples it takes.
const OF_ONE_MAP: f64 = 1e-2;

/// A body with the box from -1 to 1 around it.
const CUBE: &str = "Box { min -1 -1 -1 max 1 1 1 }";

pub fn forms(draw: &mut Parameters) -> Vec<Form> {
    let mut forms = vec![absorber(draw), beam(draw), fog(draw), flame(draw), hot(draw)];
    let grid: Vec<String> = (0..27).map(|_| draw.between(0.0, 1.0).to_string()).collect();
    let g = draw.between(-0.6, 0.8);
    let (r, s) = (draw.between(1.0, 4.0), draw.between(0.2, 3.0));
    let ball = format!("Medium m {{ sigma_s {r} {s} 1 g {g} }}");
    forms.push(white(draw, "a ball", 1.0, &ball, BALL));
    let values = grid.join(" ");
    let voxels = format!("GridMedium m {{ size 3 3 3 values {values} density {} g {g} }}", 3.0 * r);
    forms.push(white(draw, "voxels", 1.0, &voxels, CUBE).bounces(WITHOUT_END));
    let function =
        format!("FunctionMedium m {{ function = cos({r} * x) + z  sigma_s {s} {r} 2  phase rayleigh }}");
    forms.push(white(draw, "a function", 1.0, &function, CUBE));
    forms.push(white(draw, "glass", 1.4, &format!("Medium m {{ density {r} g {g} }}"), BALL));
    forms.extend([wide(draw, "a ball seen from afar", WIDE), wide(draw, "a ball by chains", CHAINS)]);
    // Next to no path is scattered more often.
    forms.push(wide(draw, "a ball by chains of lengths", CHAINS_OF_LENGTHS).bounces(32).least_noise(STARTS));
    // All pixels share the photons of a sample.
    forms.push(wide(draw, "a ball by photons", PHOTONS_AND_JOINTS).rounding(BORDER).size([64, 64]));
    forms.extend([within(draw, DRAWN), within(draw, SEEN).rounding(BLUR).least_noise(OF_ONE_MAP)]);
    forms.push(behind_glass(draw));
    forms.extend([gas_over_floor(draw, GLOBAL), gas_over_floor(draw, SHARED)]);
    forms.extend([gas_around_floor(draw, GLOBAL), gas_around_floor(draw, SHARED)]);
    forms.extend([gas_in_ball(draw, GLOBAL), gas_in_ball(draw, SHARED)]);
    forms
}

const BALL: &str = "Sphere { center 0 0 0 radius 1 }";

/// A scene with a medium `m` in a body of the material `b`.
fn filled(view: &str, media: &str, material: &str, body: &str) -> String {
    format!("{view}Media {{ {media} }}\nMaterials {{ {material} }}\nGroup {{ MaterialIndex b {body} }}\n")
}

fn under_a_sky(from: DVec3, to: DVec3) -> String {
    spot_meter(from, to).replace("color 0 0 0", "color 1 1 1")
}

fn absorber(draw: &mut Parameters) -> Form {
    let (sigma, x) = (draw.between(0.2, 2.0), draw.between(-0.7, 0.7));
    let view = under_a_sky(DVec3::new(x, 0.0, 5.0), DVec3::new(x, 0.0, 0.0));
    let scene = filled(&view, &format!("Medium m {{ sigma_a {sigma} }}"), "Interface b { medium m }", BALL);
    let expected = (-sigma * 2.0 * (1.0 - x * x).sqrt()).exp();
    Form::new(format!("S9 absorber of {sigma} over a chord at {x}"), scene, expected, MEDIA)
}

fn flame(draw: &mut Parameters) -> Form {
    let (sigma, e, x) = (draw.between(0.2, 2.0), draw.between(0.5, 3.0), draw.between(-0.7, 0.7));
    let view = spot_meter(DVec3::new(x, 0.0, 5.0), DVec3::new(x, 0.0, 0.0));
    let medium = format!("Medium m {{ sigma_a {sigma}  emission {e} }}");
    let scene = filled(&view, &medium, "Interface b { medium m }", CUBE);
    let expected = e / sigma * (1.0 - (-2.0 * sigma).exp());
    Form::new(format!("S9 slab that absorbs {sigma} and emits {e}"), scene, expected, MEDIA)
}

/// A floor of albedo `rho` and a ball of gas `m`.
fn gas_and_floor(from: DVec3, rho: f64, gas: &str, ball: &str) -> String {
    format!(
        "{}Media {{ Medium m {{ {gas} }} }}
         Materials {{ Interface gas {{ medium m }}  Matte floor {{ color {rho} {rho} {rho} }} }}
         Group {{ MaterialIndex floor {}  MaterialIndex gas {ball} }}\n",
        spot_meter(from, DVec3::ZERO),
        floor(DVec3::Y)
    )
}

fn gas_over_floor(draw: &mut Parameters, methods: &'static [Method]) -> Form {
    let (rho, e, h) = (draw.between(0.2, 0.9), draw.between(0.5, 3.0), draw.between(0.5, 2.0));
    let radius = h * draw.between(0.3, 0.6);
    let ball = format!("Sphere {{ center 0 {h} 0  radius {radius} }}");
    let scene = gas_and_floor(DVec3::new(5.0, 2.0, 1.0), rho, &format!("emission {e}"), &ball);
    let expected = rho / PI * e * 4.0 / 3.0 * PI * radius.powi(3) / (h * h);
    let name = format!("ball of gas of radius {radius} at the height {h} over a floor of albedo {rho}");
    Form::new(name, scene, expected, methods).bounces(0)
}

fn gas_around_floor(draw: &mut Parameters, methods: &'static [Method]) -> Form {
    let (rho, e, sigma) = (draw.between(0.2, 0.9), draw.between(0.5, 3.0), draw.between(0.3, 2.0));
    let radius = draw.between(0.3, 1.5);
    let ball = format!("Sphere {{ center 0 0 0  radius {radius} }}");
    let gas = format!("emission {e}  sigma_a {sigma}");
    let scene = gas_and_floor(DVec3::new(2.0, 4.0, 1.0), rho, &gas, &ball);
    let left = (-sigma * radius).exp();
    let emitted = e / sigma * (1.0 - left);
    let name = format!("floor of albedo {rho} in a ball of gas that absorbs {sigma}");
    Form::new(name, scene, emitted + left * rho * emitted, methods).bounces(0)
}

fn gas_in_ball(draw: &mut Parameters, methods: &'static [Method]) -> Form {
    let (rho, e) = (draw.between(0.3, 0.7), draw.between(0.5, 3.0));
    let (radius, wall) = (draw.between(0.2, 0.4), draw.between(0.8, 1.5));
    let scene = format!(
        "{}Media {{ Medium m {{ emission {e} }} }}
         Materials {{ Interface gas {{ medium m }}  Matte wall {{ color {rho} {rho} {rho} }} }}
         Group {{ MaterialIndex wall Sphere {{ center 0 0 0  radius {wall} }}
                  MaterialIndex gas Sphere {{ center 0 0 0  radius {radius} }} }}\n",
        spot_meter(DVec3::new(0.5, 0.0, 0.0), DVec3::new(wall, 0.2, 0.1))
    );
    let expected = rho / PI * e * 4.0 / 3.0 * PI * radius.powi(3) / (wall * wall) / (1.0 - rho);
    Form::new(format!("ball of gas of radius {radius} in a ball of albedo {rho}"), scene, expected, methods)
        .bounces(WITHOUT_END)
}

fn hot(draw: &mut Parameters) -> Form {
    let view = under_a_sky(draw.direction(-1.0) * draw.between(0.1, 4.0), draw.point(0.4));
    let (a, s, k) = (draw.between(0.2, 1.5), draw.between(0.5, 3.0), draw.between(-0.8, 0.8));
    let medium =
        format!("FunctionMedium m {{ function = 1 + {k} * x  sigma_a {a}  sigma_s {s}  emission {a} }}");
    let scene = filled(&view, &medium, "Interface b { medium m }", CUBE);
    Form::new("a body as hot as the sky around it".to_owned(), scene, 1.0, MEDIA)
}

/// Light of the beam in a cube at the height `y`, with the extinction `s`.
fn beam_in_cube(s: f64, y: f64, albedo: f64) -> f64 {
    albedo / (4.0 * PI) * (-s * (1.0 - y)).exp() * (1.0 - (-2.0 * s).exp())
}

fn beam(draw: &mut Parameters) -> Form {
    let (s, y, albedo) = (draw.between(0.3, 2.0), draw.between(-0.8, 0.8), draw.between(0.3, 1.0));
    let view = spot_meter(DVec3::new(0.0, y, 5.0), DVec3::new(0.0, y, 0.0));
    let medium = format!("Medium m {{ albedo {albedo} density {s} }}");
    let scene = filled(&view, &medium, "Interface b { medium m }", CUBE)
        + "Lights { DirectionalLight { direction 0 -1 0  irradiance 1 } }";
    let expected = beam_in_cube(s, y, albedo);
    Form::new(format!("S10 beam in a cube of {s}, albedo {albedo}, at height {y}"), scene, expected, DRAWN)
        .bounces(0)
}

/// The beam in a cube, seen from a place within up to a black disk within, so that nothing of the border is seen.
fn within(draw: &mut Parameters, methods: &'static [Method]) -> Form {
    let (s, y, albedo) = (draw.between(0.3, 1.5), draw.between(-0.5, 0.5), draw.between(0.3, 1.0));
    let (from, to) = (draw.between(0.3, 0.6), draw.between(-0.6, -0.3));
    let view = spot_meter(DVec3::new(0.0, y, from), DVec3::new(0.0, y, to));
    let scene = format!(
        "{view}Media {{ Medium m {{ albedo {albedo} density {s} }} }}
         Materials {{ Interface b {{ medium m }}  Matte black {{ color 0 0 0 }} }}
         Group {{ MaterialIndex b {CUBE}  MaterialIndex black Disk {{ center 0 {y} {to}  normal 0 0 1  radius 0.01 }} }}
         Lights {{ DirectionalLight {{ direction 0 -1 0  irradiance 1 }} }}\n"
    );
    let expected = albedo / (4.0 * PI) * (-s * (1.0 - y)).exp() * (1.0 - (-s * (from - to)).exp());
    let name = format!("S10 beam in a cube of {s}, albedo {albedo}, seen from within at height {y}");
    Form::new(name, scene, expected, methods).bounces(0)
}

/// The beam in a cube of clear glass, all across it: light enters the cube, is scattered once, and leaves it.
fn behind_glass(draw: &mut Parameters) -> Form {
    let (s, y, albedo) = (draw.between(0.3, 1.2), draw.between(-0.8, 0.8), draw.between(0.3, 1.0));
    let view = format!(
        "OrthographicCamera {{ center 0 {y} 5  direction 0 0 -1  up 0 1 0  size 0.00625 }}
         Background {{ color 0 0 0 }}\n"
    );
    let medium = format!("Medium m {{ albedo {albedo} density {s} }}");
    let scene = filled(&view, &medium, "Glass b { indexOfRefraction 1.0001  medium m }", CUBE)
        + "Lights { DirectionalLight { direction 0 -1 0  irradiance 1 } }";
    // Light within `r` of the walls that the camera looks through: a ball there lies outside by `(2 - 3 t + t^3)/4` of it at the depth `t r`,
    // the integral over `t` of which is 3/16.
    let lost = s * 3.0 / 16.0 * BALL_RADIUS * (1.0 + (-2.0 * s).exp()) / (1.0 - (-2.0 * s).exp());
    let expected = beam_in_cube(s, y, albedo) * (1.0 - lost);
    let name = format!("S10 beam in a cube of glass of {s}, albedo {albedo}, at height {y}");
    Form::new(name, scene, expected, MERGED)
        .bounces(2)
        .rounding(BEHIND_GLASS)
        .least_noise(0.25 * BEHIND_GLASS)
        .size([256, 1])
}

fn fog(draw: &mut Parameters) -> Form {
    let (s, a, b) = (draw.between(0.05, 0.3), draw.between(2.0, 6.0), draw.between(0.6, 1.5));
    let scene = format!(
        "{}Media {{ Medium m {{ sigma_s {s} }} exterior m }}
         Lights {{ PointLight {{ position {b} 0 0  intensity 1 }} }}\n",
        spot_meter(DVec3::new(0.0, 0.0, a), DVec3::ZERO)
    );
    let f = |t: f64| {
        let r = b.hypot(t - a);
        s / (4.0 * PI * r * r) * (-s * (t + r)).exp()
    };
    let expected = simpson(0.0, 2.0 * a, 4000, f) + simpson(2.0 * a, 40.0 / s, 40_000, f);
    Form::new(format!("S11 point light beside a ray in fog of {s}"), scene, expected, DRAWN).bounces(0)
}

/// * `eta`: index of refraction of the body's material, which is glass unless that is 1
/// * `body`: the object, a ball of radius 1 about the origin where `eta` is not 1
fn white(draw: &mut Parameters, name: &str, eta: f64, medium: &str, body: &str) -> Form {
    let eye = draw.direction(-1.0) * draw.between(0.1, 4.0);
    let material = match eta {
        1.0 => "Interface b { medium m }".to_owned(),
        _ => format!("Glass b {{ indexOfRefraction {eta} medium m }}"),
    };
    let scene = filled(&under_a_sky(eye, draw.point(0.4)), medium, &material, body);
    // Within a body radiance is n^2 times that outside.
    let expected = if eye.length() < 1.0 { eta * eta } else { 1.0 };
    Form::new(format!("{name} that scatters all light"), scene, expected, MEDIA)
}

/// All of a ball and the sky beside it in one picture.
fn wide(draw: &mut Parameters, name: &str, methods: &'static [Method]) -> Form {
    let from = draw.direction(-1.0) * draw.between(2.5, 3.5);
    let view = under_a_sky(from, DVec3::ZERO).replace("angle 0.001", "angle 50");
    let (s, g) = (draw.between(0.5, 1.5), draw.between(-0.5, 0.5));
    let medium = format!("Medium m {{ density {s} g {g} }}");
    let scene = filled(&view, &medium, "Interface b { medium m }", BALL);
    Form::new(format!("{name} that scatters all light"), scene, 1.0, methods)
}
