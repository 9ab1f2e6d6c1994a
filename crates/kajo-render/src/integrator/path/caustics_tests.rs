//! Lights behind glass that are drawn, against closed forms and against paths that meet them by chance.

use std::f64::consts::PI;

use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_core::settings::{Caustics, Technique};
use kajo_testkit::Estimate;

use super::tests::{camera, mean_of, scene};
use super::*;
use crate::RenderSettings;
use crate::integrator::same_picture::assert_same_picture;

const WALKS: PathSettings =
    PathSettings { caustics: Caustics::Manifold, bounces: 2, ..PathSettings::DEFAULT };

/// The mean of a single pixel.
fn mean(scene: &Scene, settings: PathSettings, paths: u32) -> Estimate {
    let integrator = integrator_of(&scene.output.camera, scene, settings, [1, 1], LayerSet::of(&[]));
    mean_of(&*integrator, paths, 0)
}

/// Share of light that a boundary lets through.
fn fresnel(cos_i: f64, eta: f64) -> f64 {
    let cos_t = (1.0 - (1.0 - cos_i * cos_i) / (eta * eta)).sqrt();
    let s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    1.0 - 0.5 * (s * s + p * p)
}

/// Irradiance at the distance `x` from the foot of a point of the intensity 1 over a floor, through a slab.
///
/// With the angle `a` of the light that arrives there, `x = air tan a + slab tan b`, `sin a = eta sin b`, and
/// `E = T^2 exp(-sigma slab / cos b) sin a / (x dx/da)`.
fn under_slab(x: f64, air: f64, slab: f64, eta: f64, sigma: f64) -> f64 {
    let inside = |a: f64| (a.sin() / eta).asin();
    let reach = |a: f64| air * a.tan() + slab * inside(a).tan();
    let (mut low, mut high) = (0.0, 1.57);
    for _ in 0..100 {
        let a = 0.5 * (low + high);
        if reach(a) < x { low = a } else { high = a }
    }
    let a = low;
    let h = 1e-5;
    let slope = (reach(a + h) - reach(a - h)) / (2.0 * h);
    let t = fresnel(a.cos(), eta);
    t * t * (-sigma * slab / inside(a).cos()).exp() * a.sin() / (x * slope)
}

/// A slab of glass between a light and a floor, which is seen from below the slab at the distance `x` from the foot of the light.
fn slab(x: f32, light: &str, materials: &str, emitter: &str) -> Scene {
    let view = camera([x, 0.4, 0.5], [x, 0.0, 0.0]);
    scene(&format!(
        "{view} {light} Materials {{ Matte floor {{ color 0.5 0.5 0.5 }} {materials} }}
         Group {{ MaterialIndex floor Quad {{ corner -3 0 -3 edge1 0 0 6 edge2 6 0 0 }}
                  MaterialIndex glass Box {{ min -5 0.5 -5 max 5 1.3 5 }}
                  {} {emitter} }}",
        if emitter.is_empty() { "" } else { "MaterialIndex emitter" }
    ))
}

#[test]
fn a_slab_shifts_the_light_of_a_point() {
    let light = "Lights { PointLight { position 0 2.3 0 color 3 3 3 attenuation 0 0 1 } }";
    let glass = "Glass glass { indexOfRefraction 1.5  absorption 0.3 0.3 0.3 }";
    for x in [0.05f32, 0.8, 2.5] {
        let scene = slab(x, light, glass, "");
        let found = mean(&scene, WALKS, 20);
        let bare = slab(x, light, "Glass glass { indexOfRefraction 1.0001 }", "");
        let unbent = mean(&bare, WALKS, 20);
        let away = f64::from(x).hypot(2.3);
        let ratio = under_slab(x.into(), 1.5, 0.8, 1.5, 0.3) / (2.3 / away.powi(3));
        let relative = found.mean / unbent.mean / ratio - 1.0;
        assert!(relative.abs() < 2e-3, "{x}: {} {} {ratio} {relative}", found.mean, unbent.mean);
        assert_eq!(mean(&scene, PathSettings { caustics: Caustics::Scattering, ..WALKS }, 20).mean, 0.0);
    }
}

#[test]
fn a_slab_shifts_the_light_of_a_ball() {
    let (radius, radiance) = (0.02f64, 900.0f64);
    for x in [0.05f32, 2.5] {
        let glass = format!(
            "Glass glass {{ indexOfRefraction 1.5  absorption 0.3 0.3 0.3 }}
             Matte emitter {{ color 0 0 0 emission {radiance} }}"
        );
        let emitter = format!("Sphere {{ center 0 2.3 0 radius {radius} }}");
        let scene = slab(x, "", &glass, &emitter);
        let irradiance = under_slab(x.into(), 1.5, 0.8, 1.5, 0.3) * radiance * PI * radius * radius;
        let expected = 0.5 / PI * irradiance;
        for technique in [Technique::Combined, Technique::Lights] {
            let found = mean(&scene, PathSettings { technique, ..WALKS }, 1000);
            if let Err(complaint) = found.check(expected, 0.02) {
                panic!("{x} {technique:?}: {complaint}");
            }
        }
    }
}

/// A floor beside a mirror in the plane x = 1, seen at the distance `x` from the origin.
fn beside_mirror(x: f32, light: &str, emitter: &str) -> Scene {
    scene(&format!(
        "{} {light} Materials {{ Matte floor {{ color 0.5 0.5 0.5 }}  Metal mirror {{ color 1 1 1 }}
                          Matte emitter {{ color 0 0 0  emission 3000 3000 3000  emits front }} }}
         Group {{ MaterialIndex floor Quad {{ corner -9 0 -9 edge1 0 0 18 edge2 18 0 0 }}
                  MaterialIndex mirror Quad {{ corner 1 0.01 -3 edge1 0 3 0 edge2 0 0 6 }}
                  MaterialIndex emitter {emitter} }}",
        camera([x, 0.4, 0.5], [x, 0.0, 0.0])
    ))
}

/// The cosine on the floor over the squared distance of a light at height 1.5, so far away in x.
fn share(x: f64) -> f64 {
    1.5 / (x * x + 1.5 * 1.5 + 0.4 * 0.4).powf(1.5)
}

/// A mirror is a second light behind it: `E = F I cos / d^2` for both, the reflected one from farther away.
#[test]
fn a_plane_mirror_shows_a_second_light() {
    let light = "Lights { PointLight { position -1 1.5 0.4 color 3 3 3 attenuation 0 0 1 } }";
    let scene = beside_mirror(0.0, light, "");
    let found = mean(&scene, WALKS, 4000);
    let plain = mean(&scene, PathSettings { caustics: Caustics::Scattering, ..WALKS }, 10);
    // From x = -1, and from x = 3 behind the mirror.
    let expected = plain.mean * (1.0 + share(3.0) / share(1.0));
    if let Err(complaint) = found.check(expected, 0.02) {
        panic!("{complaint}");
    }
}

/// A spot that sends nothing straight to where the mirror sends its light.
#[test]
fn a_spot_is_seen_in_a_mirror_from_outside_of_its_cone() {
    let of = |light: &str| beside_mirror(0.0, &format!("Lights {{ {light} }}"), "");
    let point = of("PointLight { position -1 1.5 0.4 color 3 3 3 attenuation 0 0 1 }");
    let straight = mean(&point, PathSettings { caustics: Caustics::Scattering, ..WALKS }, 10);
    let spot = of("SpotLight { position -1 1.5 0.4 direction 2 -1 -0.267 color 3 3 3 attenuation 0 0 1
                               angle 20 innerAngle 20 }");
    let found = mean(&spot, WALKS, 4000);
    assert_eq!(mean(&spot, PathSettings { caustics: Caustics::Scattering, ..WALKS }, 10).mean, 0.0);
    if let Err(complaint) = found.check(straight.mean * share(3.0) / share(1.0), 0.02) {
        panic!("{complaint}");
    }
}

/// Points of the far side of a small ball are no points of its near side.
#[test]
fn a_ball_of_a_millimetre_is_as_bright_in_a_mirror_as_a_larger_one() {
    let of = |radius: f64| {
        let emitter = format!("Sphere {{ center -1 1.5 0.4 radius {radius} }}");
        let found = mean(&beside_mirror(0.0, "", &emitter), WALKS, 8000);
        let area = radius * radius;
        (found.mean / area, found.standard_error / area)
    };
    let (small, large) = (of(0.0005), of(0.02));
    assert!((small.0 - large.0).abs() < 4.0 * small.1.hypot(large.1) + 2e-3 * large.0, "{small:?} {large:?}");
    assert!(small.1 < 0.02 * small.0, "{small:?}");
}

/// A panel that turns its back to where the mirror sends its light: `E = L A cos cos / d^2` of the one behind the mirror.
#[test]
fn a_panel_is_seen_in_a_mirror_from_behind() {
    let panel = "Quad { corner -1 1.45 0.35 edge1 0 0.1 0 edge2 0 0 0.1 }";
    let scene = beside_mirror(-1.5, "", panel);
    let distance2: f64 = 4.5 * 4.5 + 1.5 * 1.5 + 0.4 * 0.4;
    let expected = 0.5 / PI * 3000.0 * 0.01 * 1.5 * 4.5 / (distance2 * distance2);
    for technique in [Technique::Combined, Technique::Lights] {
        let found = mean(&scene, PathSettings { technique, ..WALKS }, 2000);
        if let Err(complaint) = found.check(expected, 0.02) {
            panic!("{technique:?}: {complaint}");
        }
    }
}

const BALL: &str = "MaterialIndex glass Sphere { center 0 1.2 0 radius 0.7 }";

/// A floor under a small light at the angle `lean` from the vertical about the middle of what casts, seen at the distance `x` from its foot.
fn under(casters: &str, x: f32, lean: f32, radius: f32) -> Scene {
    let (s, c) = lean.sin_cos();
    let radiance = 10.0 / (radius * radius);
    let (lx, ly) = (3.0 * s, 1.2 + 3.0 * c);
    scene(&format!(
        "{} Materials {{ Matte floor {{ color 0.5 0.5 0.5 }}  Glass glass {{ indexOfRefraction 1.5 }}
                         Glass tinted {{ indexOfRefraction 1.33  absorption 1 0.2 0.1 }}
                         Glass flint {{ glass SF10 }}
                         Metal mirror {{ metal gold }}
                         Matte emitter {{ color 0 0 0  emission {radiance} }} }}
         Group {{ MaterialIndex floor Quad {{ corner -9 0 -9 edge1 0 0 18 edge2 18 0 0 }}
                  {casters}
                  MaterialIndex emitter Sphere {{ center {lx} {ly} 0 radius {radius} }} }}",
        camera([x, 0.1, 0.05], [x, 0.0, 0.0])
    ))
}

/// Walks take nothing away and add nothing: the mean is that of paths that meet lights by chance, whatever casts the light, and there is less
/// noise.
#[test]
fn walks_change_no_mean() {
    let ellipsoid = "MaterialIndex tinted
         Transform { Translate 0 1.2 0 ZRotate 30 Scale 0.7 0.35 0.6 Sphere { center 0 0 0 radius 1 } }";
    let lens = "MaterialIndex glass
         Intersection { Sphere { center 0 0.5 0 radius 1 } Sphere { center 0 1.9 0 radius 1 } }";
    let bulb = "MaterialIndex glass
         Difference { Sphere { center 1.438 3.833 0 radius 0.6 } Sphere { center 1.438 3.833 0 radius 0.55 } }";
    let pond = "MaterialIndex tinted Box { min -3 -0.5 -3 max 3 0.5 3 }";
    let ring = "MaterialIndex mirror Cylinder { base 0 0.01 0 top 0 0.6 0 radius 0.9 capped off }";
    let mirror = "MaterialIndex mirror Sphere { center -1.2 0.9 0 radius 0.4 }";
    for (casters, x, bounces, gain) in [
        (BALL, -0.1, 2, 20.0),
        (BALL, -0.6, 2, 2.0),
        (ellipsoid, -0.75, 2, 2.0),
        (lens, -0.75, 2, 2.0),
        (bulb, -0.3, 2, 20.0),
        (pond, -0.75, 1, 20.0),
        (ring, -0.75, 1, 2.0),
        (mirror, -0.1, 1, 20.0),
    ] {
        let scene = under(casters, x, 0.5, 0.08);
        let settings = PathSettings { bounces, ..WALKS };
        let walks = mean(&scene, settings, 500);
        let plain = mean(&scene, PathSettings { caustics: Caustics::Scattering, ..settings }, 20000);
        let sigma = walks.standard_error.hypot(plain.standard_error);
        assert!((walks.mean - plain.mean).abs() < 4.0 * sigma, "{casters} {x}: {walks:?} {plain:?}");
        // The same number of paths would have 40 times the variance of that many.
        let gained = 40.0 * (plain.standard_error / walks.standard_error).powi(2);
        assert!(gained > gain, "{casters} {x}: {gained}");
    }
}

/// Glass that refracts by wavelength has chains of one wavelength, and all three channels have the light of paths.
#[test]
fn dispersion_is_that_of_paths() {
    let scene = under("MaterialIndex flint Sphere { center 0 1.2 0 radius 0.7 }", -0.5, 0.5, 0.08);
    let settings = PathSettings { spectral: true, ..WALKS };
    for lane in 0..3 {
        let found = |settings, paths| {
            let integrator = integrator_of(&scene.output.camera, &scene, settings, [1, 1], LayerSet::of(&[]));
            mean_of(&*integrator, paths, lane)
        };
        let (walks, plain) =
            (found(settings, 500), found(PathSettings { caustics: Caustics::Scattering, ..settings }, 20000));
        let sigma = walks.standard_error.hypot(plain.standard_error);
        assert!((walks.mean - plain.mean).abs() < 4.0 * sigma, "{lane}: {walks:?} {plain:?}");
    }
}

/// Light from infinitely far away goes through a slab in its own direction, weakened at both sides: `E = T^2 cos`.
#[test]
fn a_slab_weakens_the_light_of_a_direction() {
    let light = "Lights { DirectionalLight { direction 0.6 -0.8 0 color 3 3 3 } }";
    let found = mean(&slab(0.0, light, "Glass glass { indexOfRefraction 1.5 }", ""), WALKS, 4000);
    let open = slab(0.0, light, "Glass glass { thickness 0  indexOfRefraction 1 }", "");
    let plain = mean(&open, PathSettings { caustics: Caustics::Scattering, ..WALKS }, 10);
    let expected = plain.mean * fresnel(0.8, 1.5).powi(2);
    if let Err(complaint) = found.check(expected, 0.02) {
        panic!("{complaint} {}", plain.mean);
    }
}

/// Irradiance under a ball of radius 1 and index `eta` in parallel light of irradiance 1, at the distance `x` from its axis, on a screen
/// `screen` below its middle.
///
/// A ray at the distance `h` from the axis comes to `x(h)`, and light of all of those that come to `x` adds up: `E = sum of T^2 h / (x |dx/dh|)`.
fn under_ball(x: f64, screen: f64, eta: f64) -> f64 {
    const STEPS: u32 = 100_000;
    let lands = |h: f64| {
        let (i, r) = (h.asin(), (h / eta).asin());
        let leaves = 2.0 * r - i;
        leaves.sin() - (2.0 * (i - r)).tan() * (screen - leaves.cos())
    };
    let light = |step: u32| {
        let [from, to] = [step, step + 1].map(|k| f64::from(k) / f64::from(STEPS));
        let [a, b] = [from, to].map(lands);
        let is_between = |x: f64| (a - x) * (b - x) < 0.0;
        let (h, slope) = (0.5 * (from + to), (b - a) * f64::from(STEPS));
        let comes = is_between(x) || is_between(-x);
        if comes { fresnel((1.0 - h * h).sqrt(), eta).powi(2) * h / (x * slope.abs()) } else { 0.0 }
    };
    (0..STEPS - 1).map(light).sum()
}

/// Up to three chains lead to a direction before the focus of a ball, of which walks from fixed directions miss some.
#[test]
fn no_light_of_a_direction_is_missed() {
    for x in [0.01f32, 0.015, 0.02, 0.15, 0.235, 0.242, 0.3] {
        let view = camera([x, 0.1, 0.05], [x, 0.0, 0.0]);
        let scene = scene(&format!(
            "{view} Lights {{ DirectionalLight {{ direction 0 -1 0  irradiance 1 }} }}
             Materials {{ Matte floor {{ color 0.5 0.5 0.5 }}  Glass glass {{ indexOfRefraction 1.5 }} }}
             Group {{ MaterialIndex floor Disk {{ center 0 0 0 normal 0 1 0 radius 0.9 }}
                      MaterialIndex glass Sphere {{ center 0 1.25 0 radius 1 }} }}"
        ));
        let found = mean(&scene, WALKS, 400);
        let expected = 0.5 / PI * under_ball(x.into(), 1.25, 1.5);
        assert!(found.standard_error < 0.02 * expected, "{x}: {found:?} {expected}");
        let off = (found.mean - expected).abs();
        assert!(off < 4.0 * found.standard_error + 3e-3 * expected, "{x}: {found:?} {expected}");
    }
}

/// Chains are no longer than paths may be, and scenes in which nothing casts light have the very samples of paths.
#[test]
fn walks_keep_to_the_limits_of_paths() {
    let scene = under(BALL, -0.6, 0.5, 0.02);
    let one = mean(&scene, PathSettings { bounces: 1, ..WALKS }, 200);
    assert_eq!(
        one.mean,
        mean(&scene, PathSettings { bounces: 1, caustics: Caustics::Scattering, ..WALKS }, 200).mean
    );
    let bare = under("", -0.6, 0.5, 0.02);
    let plain = PathSettings { caustics: Caustics::Scattering, ..WALKS };
    assert_eq!(mean(&bare, WALKS, 50).mean, mean(&bare, plain, 50).mean);
}

#[test]
fn threads_tiles_and_stops_make_the_same_picture() {
    let size = [20, 16];
    let scene = slab(
        0.5,
        "Lights { PointLight { position 0 2 0  intensity 3 } }",
        "Glass glass { }  Matte emitter { color 0 0 0  emission 3 }",
        "Sphere { center 0.5 2 -0.5  radius 0.3 }",
    );
    for spectral in [false, true] {
        let settings = PathSettings { spectral, ..WALKS };
        let layers = LayerSet::of(&[crate::Layer::Color]);
        let integrator = integrator_of(&scene.output.camera, &scene, settings, size, layers);
        let schedule = RenderSettings::new(Sampler::new(SamplerKind::Sobol, 4));
        assert_same_picture(&*integrator, size, &schedule, [2, 1]);
    }
}

/// A clear ball in an even light is not seen, nor is its shadow.
#[test]
fn a_furnace_stays_white() {
    let text = format!(
        "{} Background {{ color 1 1 1 }} Materials {{ Matte floor {{ color 1 1 1 }} Glass glass {{ }} }}
         Group {{ MaterialIndex floor Sphere {{ center 0 -1 0 radius 1 }} {BALL} }}",
        camera([0.3, 0.1, 0.05], [0.0, 0.0, 0.0])
    );
    let found = mean(&scene(&text), PathSettings { bounces: 100, ..WALKS }, 400);
    if let Err(complaint) = found.check(1.0, 0.02) {
        panic!("{complaint}");
    }
}

/// Where light is scattered on its way nothing is drawn through glass, and that is said.
#[test]
fn media_are_told_of() {
    let text = format!(
        "{} Media {{ Medium haze {{ meanFreePath 40 }} exterior haze }} Group {{ {BALL} }}",
        camera([0.0; 3], [1.0; 3])
    );
    let text = text.replace("Group", "Materials { Glass glass { } } Group");
    let foggy = scene(&text);
    assert!(foggy.has_media() && !WALKS.walks_in(&foggy));
    assert_eq!(crate::integrator::Prepare::left_out(&WALKS, &foggy, [1, 1]).len(), 1);
    let clear = under(BALL, 0.0, 0.0, 0.1);
    assert!(WALKS.walks_in(&clear));
    assert!(crate::integrator::Prepare::left_out(&WALKS, &clear, [1, 1]).is_empty());
}
