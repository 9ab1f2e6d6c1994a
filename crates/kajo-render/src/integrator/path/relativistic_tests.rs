//! Light between frames: what does not depend on the frame, and the closed forms of what does.

use kajo_color::{Emission, Wavelengths};
use kajo_core::ids::FrameId;
use kajo_core::scene::{Interaction, LightRay, Scene};
use kajo_core::settings::Technique;
use kajo_math::{DVec3, Ray, Vec3};

use super::tests::{TECHNIQUES, camera, scene};
use super::*;
use crate::RenderSettings;
use crate::integrator::Prepare;
use crate::integrator::same_picture::assert_same_picture;
use kajo_core::sampler::{Sampler, SamplerKind};

/// The picture of a scene, `n` samples for each pixel, in linear RGB.
fn picture(scene: &Scene, settings: PathSettings, size: [u32; 2], n: u32) -> Vec<[f32; 3]> {
    let integrator = settings.prepare(scene, &scene.output.camera, size, LayerSet::of(&[]));
    let sampler = Sampler::new(SamplerKind::Uniform, n);
    let mut ctx = SampleContext::new(&sampler, 7);
    let mut pixel = |x, y| {
        let mut sum = [0.0; 3];
        for k in 0..n {
            let place = ctx.begin([x, y], k) + Vec2::new(x as f32, y as f32);
            let sample = integrator.sample(&mut ctx, [x, y], place);
            sum = [0, 1, 2].map(|i| sum[i] + sample.radiance[i] / n as f32);
        }
        sum
    };
    (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y))).map(|(x, y)| pixel(x, y)).collect()
}

/// Demands that two pictures agree but for a few pixels at edges, which rounding decides.
#[track_caller]
fn check_same(a: &[[f32; 3]], b: &[[f32; 3]], tolerance: f32) {
    let off = |(a, b): (&[f32; 3], &[f32; 3])| {
        (0..3).any(|i| (a[i] - b[i]).abs() > tolerance * (a[i].abs() + b[i].abs()) + 1e-6)
    };
    let differ = a.iter().zip(b).filter(|&pair| off(pair)).count();
    assert!(differ * 50 <= a.len(), "{differ} of {} pixels differ", a.len());
    assert!(a.iter().flatten().any(|&x| x > 0.0), "all is black");
    let mean = |p: &[[f32; 3]]| p.iter().flatten().map(|&x| f64::from(x)).sum::<f64>() / p.len() as f64;
    assert!((mean(a) / mean(b) - 1.0).abs() < 0.02, "{} {}", mean(a), mean(b));
}

const MATERIALS: &str = "Background { color 0.3 0.4 0.6 }
    Materials { Matte grey { color 0.6 0.5 0.4 } Matte emitter { color 0 0 0 emission 8 6 4 }
      Material mirror { diffuseColor 0 0 0 reflectiveColor 0.9 0.9 0.9 } Glass glass { indexOfRefraction 1.5 } }";

/// A camera at the origin that looks at what is before it.
fn view(more: &str) -> String {
    format!("PerspectiveCamera {{ center 0 0 0 direction 0 -0.1 -1 up 0 1 0 angle 50 {more} }} {MATERIALS}")
}

const STAGE: &str = "MaterialIndex grey Box { min -3 -2 -8 max 3 -1 -2 }
    MaterialIndex mirror Sphere { center -1 0 -6 radius 0.8 }";
const PLAYERS: &str = "MaterialIndex glass Sphere { center 0.9 -0.2 -4.5 radius 0.6 }
    MaterialIndex emitter Sphere { center 0.2 1.5 -5 radius 0.4 }
    MaterialIndex grey Sphere { center -0.6 -0.5 -4 radius 0.4 }";

/// What moves together with the camera looks as if all were at rest; the background alone would tell, and is black.
#[test]
fn nobody_feels_a_steady_motion() {
    let at_rest =
        scene(&format!("{} Group {{ {STAGE} {PLAYERS} }}", view("")).replace("0.3 0.4 0.6", "0 0 0"));
    let v = "0.35 -0.2 0.6";
    let moving = format!(
        "{} Group {{ Lorentz {{ velocity {v} {STAGE} {PLAYERS} }} }}",
        view(&format!("velocity {v}"))
    );
    let moving = scene(&moving.replace("0.3 0.4 0.6", "0 0 0"));
    for spectral in [false, true] {
        let settings = PathSettings { bounces: 3, spectral, ..PathSettings::default() };
        let pictures = [&at_rest, &moving].map(|scene| picture(scene, settings, [24, 18], 4));
        // At refraction by wavelength and at edges rounding decides.
        check_same(&pictures[0], &pictures[1], 0.02);
    }
}

/// It is all the same which of two groups moves, if the camera goes along with the other.
#[test]
fn only_relative_motion_counts() {
    let first = scene(
        &format!("{} Group {{ {STAGE} Lorentz {{ velocity 0.5 0.1 -0.3 {PLAYERS} }} }}", view(""))
            .replace("0.3 0.4 0.6", "0 0 0"),
    );
    let back = "velocity -0.5 -0.1 0.3";
    let second = scene(
        &format!("{} Group {{ Lorentz {{ {back} {STAGE} }} {PLAYERS} }}", view(back))
            .replace("0.3 0.4 0.6", "0 0 0"),
    );
    for technique in TECHNIQUES {
        for spectral in [false, true] {
            let settings = PathSettings { bounces: 2, technique, spectral, ..PathSettings::default() };
            let pictures = [&first, &second].map(|scene| picture(scene, settings, [24, 18], 4));
            check_same(&pictures[0], &pictures[1], 0.02);
        }
    }
}

/// However light is found, drawn in the frame of its emitter or met, it is as much: under an emitter, a sky and a sun that move past the floor.
#[test]
fn all_techniques_find_the_same_light() {
    let text = format!(
        "{} Lights {{ DirectionalLight {{ direction 0.3 -1 0.2 irradiance 1 1 1 angle 30 }} }}
         {MATERIALS} Group {{ MaterialIndex emitter Quad {{ corner -1 2 -1 edge1 2 0 0 edge2 0 0 2 }}
           Lorentz {{ velocity 0.6 0.1 0.2 MaterialIndex grey Box {{ min -9 -1 -9 max 9 0 9 }}
             MaterialIndex emitter Sphere {{ center 1 1.2 0 radius 0.5 }} }} }}",
        camera([0.5, 0.4, 1.0], [0.0, 0.0, 0.0]).replace("Background { color 0 0 0 }", "")
    );
    let scene = scene(&text);
    let mean = |technique| {
        let settings = PathSettings { bounces: 0, technique, ..PathSettings::default() };
        let n = 20_000;
        f64::from(picture(&scene, settings, [1, 1], n)[0][0])
    };
    let [combined, lights, scattering] = TECHNIQUES.map(mean);
    assert!((lights / combined - 1.0).abs() < 0.02, "{lights} {combined}");
    assert!((scattering / combined - 1.0).abs() < 0.04, "{scattering} {combined}");
}

/// A black body that comes nearer looks like a hotter one: `T' = D T` [Weiskopf 2001].
#[test]
fn a_black_body_that_moves_is_one_of_another_temperature() {
    for (b, kelvin) in [(0.5, 10045.9f32), (-0.5, 3348.6)] {
        let text = format!(
            "{} Materials {{ Matte m {{ color 0 0 0 emission blackbody 5800 1 }} }}
             Group {{ Lorentz {{ velocity 0 0 {b} MaterialIndex m Sphere {{ center 0 0 0 radius 1 }} }} }}",
            camera([0.0, 0.0, 5.0], [0.0, 0.0, 0.0])
        );
        let settings = PathSettings { spectral: true, ..PathSettings::default() };
        let moving = picture(&scene(&text), settings, [1, 1], 256)[0];
        let still =
            text.replace(&format!("velocity 0 0 {b}"), "velocity 0 0 0").replace("5800", &kelvin.to_string());
        let still = picture(&scene(&still), settings, [1, 1], 256)[0];
        let ratios = [0, 1, 2].map(|i| moving[i] / still[i]);
        // Planck's law at one wavelength says by how much it is brighter than a body of luminance 1.
        let nm = Wavelengths::sample(0.3);
        let [hot, own] = [kelvin, 5800.0].map(Emission::blackbody);
        let doppler = kelvin / 5800.0;
        let expected = own.at(&nm.shifted(doppler))[0] * doppler.powi(5) / hot.at(&nm)[0];
        for ratio in ratios {
            assert!((ratio / expected - 1.0).abs() < 1e-3, "{b}: {ratios:?} {expected}");
        }
    }
}

/// The mean over all directions and the flux of an even sky for an observer who moves, by the rays that it casts.
#[test]
fn a_moving_camera_meets_more_light() {
    for (b, mean) in [(0.5f64, 1.444_444), (0.9, 6.684_211)] {
        let scene = scene(&format!("{} Group {{ }}", view(&format!("velocity 0 0 {}", -b))));
        let all = scene.relativity.as_deref().expect("a camera that moves");
        let n = 20_000;
        let (mut sum, mut flux) = (0.0, 0.0);
        for i in 0..n {
            let cos = 1.0 - 2.0 * (f64::from(i) + 0.5) / f64::from(n);
            let d = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, -cos).as_vec3();
            let seen = all.observed(&Ray::new(Vec3::ZERO, d), Vec3::ZERO);
            let l = f64::from(seen.ray.d.length()).powi(-4);
            sum += l / f64::from(n);
            flux += l * cos * 4.0 * std::f64::consts::PI / f64::from(n);
        }
        assert!((sum / mean - 1.0).abs() < 1e-5, "{b}: {sum}");
        let gamma2 = 1.0 / (1.0 - b * b);
        let expected = 4.0 * std::f64::consts::PI * 4.0 / 3.0 * gamma2 * b;
        assert!((flux / expected - 1.0).abs() < 1e-5, "{b}: {flux} {expected}");
    }
}

/// The first surface along a camera ray of direction `d` from `o`: what is hit, and the ray of light in the world.
fn seen(scene: &Scene, o: Vec3, d: Vec3) -> Option<(Interaction, LightRay)> {
    let all = scene.relativity.as_deref()?;
    let light = all.observed(&Ray::new(o, d), o);
    let mut at = Interaction::default();
    scene.trace_light(all, &light, None, &mut at)?;
    Some((at, light))
}

/// The last angle from `axis` towards `side` under which something is seen.
fn edge(scene: &Scene, axis: DVec3, side: DVec3) -> DVec3 {
    let towards = |angle: f64| angle.cos() * axis + angle.sin() * side;
    let (mut within, mut beyond) = (0.0, 1.5);
    for _ in 0..40 {
        let middle = 0.5 * (within + beyond);
        match seen(scene, Vec3::ZERO, towards(middle).as_vec3()) {
            Some(_) => within = middle,
            None => beyond = middle,
        }
    }
    towards(within)
}

/// The outline of a sphere is a circle, whatever moves [Penrose 1959].
#[test]
fn spheres_look_round() {
    let (sin, cos) = 60f64.to_radians().sin_cos();
    let ball = format!(
        "MaterialIndex grey Sphere {{ center {} 0 {} radius {} }}",
        10.0 * sin,
        -10.0 * cos,
        10.0 * 10f64.to_radians().sin()
    );
    let camera_moves = scene(&format!("{} Group {{ {ball} }}", view("velocity 0 0 -0.9")));
    let ball_moves = scene(&format!("{} Group {{ Lorentz {{ velocity 0 0 0.9 {ball} }} }}", view("")));
    for scene in [camera_moves, ball_moves] {
        let middle = (0.5f64 * (12.2124 + 18.2519)).to_radians();
        let axis = DVec3::new(middle.sin(), 0.0, -middle.cos());
        let across = [DVec3::Y, axis.cross(DVec3::Y)];
        let edges: Vec<DVec3> = (0..64)
            .map(|i| {
                let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 64.0).sin_cos();
                edge(&scene, axis, cos * across[0] + sin * across[1])
            })
            .collect();
        let angles = edges.iter().map(|d| d.angle_between(axis).to_degrees());
        for angle in angles {
            // A twentieth of a pixel of a picture of 1000 pixels over 50 degrees.
            assert!((angle - 0.5 * (18.2519 - 12.2124)).abs() < 0.0025, "{angle}");
        }
        let from_motion = |d: &DVec3| d.angle_between(DVec3::NEG_Z).to_degrees();
        let least = edges.iter().map(from_motion).fold(f64::INFINITY, f64::min);
        let most = edges.iter().map(from_motion).fold(0.0, f64::max);
        assert!((least - 12.2124).abs() < 1e-3 && (most - 18.2519).abs() < 1e-3, "{least} {most}");
    }
}

/// A cube that passes far away looks turned by `asin b` [Terrell 1959].
#[test]
fn cubes_that_pass_look_turned() {
    for (b, degrees) in [(0.5f64, 30.0f64), (0.8, 53.1301), (0.9, 64.1581)] {
        let cube = "MaterialIndex grey Box { min -0.5 -0.5 -0.5 max 0.5 0.5 0.5 }";
        let scene = scene(&format!("{} Group {{ Lorentz {{ velocity {b} 0 0 {cube} }} }}", view("")));
        // Parallel rays, as from far away, that all arrive at one moment.
        let n = 40_000;
        let (mut side, mut back) = (0, 0);
        for i in 0..n {
            // Light from the middle needs the time 10 to get here.
            let o = Vec3::new(-10.0 * b as f32 - 3.0 + 6.0 * i as f32 / n as f32, 0.1, 10.0);
            let Some((at, _)) = seen_parallel(&scene, o) else { continue };
            side += i32::from(at.point.n == Vec3::Z);
            back += i32::from(at.point.n == Vec3::NEG_X);
        }
        let turned = f64::from(back).atan2(f64::from(side)).to_degrees();
        assert!((turned - degrees).abs() < 0.02, "{b}: {turned}, {side} {back}");
        let width = 6.0 * f64::from(side) / f64::from(n);
        assert!((width - (1.0 - b * b).sqrt()).abs() < 1e-3, "{b}: {width}");
    }
}

fn seen_parallel(scene: &Scene, o: Vec3) -> Option<(Interaction, LightRay)> {
    seen(scene, o, Vec3::NEG_Z)
}

/// A rod that comes nearer along the line of sight looks longer by `sqrt((1 + b) / (1 - b))`, and one that leaves shorter.
#[test]
fn rods_look_long_when_they_come_and_short_when_they_leave() {
    for (b, length) in [(0.8, 3.0f64), (-0.8, 1.0 / 3.0)] {
        // Its ends, one beside the other.
        let ends = "MaterialIndex grey Disk { center 0 0 -1 normal 0 0 1 radius 0.4 }
            Disk { center 1 0 0 normal 0 0 1 radius 0.4 }";
        let scene = scene(&format!("{} Group {{ Lorentz {{ velocity 0 0 {b} {ends} }} }}", view("")));
        let depth = |x: f32| {
            let (at, light) = seen_parallel(&scene, Vec3::new(x, 0.0, 50.0)).expect("an end");
            f64::from(light.ray.at(at.hit.t).z)
        };
        let found = depth(1.0) - depth(0.0);
        assert!((found / length - 1.0).abs() < 1e-4, "{b}: {found}");
    }
}

/// Nobody sees what is not yet there: light of an emitter that leaves takes its time.
#[test]
fn the_moment_of_the_picture_moves_what_moves() {
    let ball = "MaterialIndex grey Sphere { center 0 0 0 radius 0.5 }";
    for moment in [0.0f64, 4.0] {
        let camera = view(&format!("worldTime {moment}"));
        let scene =
            scene(&format!("{camera} Group {{ Lorentz {{ velocity 0.5 0 0 Translate 0 0 -3 {ball} }} }}"));
        // The middle was at x when its light left: x = b (t - sqrt(x^2 + 9)).
        let b = 0.5;
        let x = {
            let (p, q) = (1.0 - b * b, b * moment);
            (q - (q * q - p * (q * q - 9.0 * b * b)).sqrt()) / p
        };
        let (at, light) =
            seen(&scene, Vec3::ZERO, Vec3::new(x as f32, 0.0, -3.0).normalize()).expect("the ball");
        assert_eq!(scene.relativity.as_ref().unwrap().frame_of(at.object), FrameId::new(1).unwrap());
        let place = light.ray.at(at.hit.t);
        assert!((f64::from(place.x) - x).abs() < 0.5, "{moment}: {place} {x}");
    }
}

/// What no eye could stand is no harm to numbers.
#[test]
fn the_fastest_things_leave_numbers() {
    let fast = "velocity 0 0 0.9999994";
    let text =
        format!("{} Group {{ {STAGE} Lorentz {{ {fast} {PLAYERS} }} }}", view("velocity 0 0 -0.9999994"));
    for spectral in [false, true] {
        let settings = PathSettings { spectral, ..PathSettings::default() };
        let all = picture(&scene(&text), settings, [8, 6], 16);
        assert!(all.iter().flatten().all(|x| x.is_finite()));
    }
}

#[test]
fn debug_rays_tell_all_light_of_a_sample() {
    let scene =
        scene(&format!("{} Group {{ {STAGE} Lorentz {{ velocity 0.3 0 0.4 {PLAYERS} }} }}", view("")));
    let settings = PathSettings { bounces: 3, technique: Technique::Combined, ..PathSettings::default() };
    let integrator = settings.prepare(&scene, &scene.output.camera, [24, 18], LayerSet::of(&[]));
    let sampler = Sampler::new(SamplerKind::Uniform, 1);
    for y in 0..18 {
        let mut ctx = SampleContext::new(&sampler, 3);
        let place = ctx.begin([12, y], 0) + Vec2::new(12.0, y as f32);
        let (sample, trail) = integrator.trail(&mut ctx, [12, y], place);
        let sum: f32 = trail.segments().iter().map(|segment| segment.contribution[1]).sum();
        assert!((sum - sample.radiance[1]).abs() < 1e-4 * (1.0 + sum), "{y}: {sum} {:?}", sample.radiance);
    }
}

#[test]
fn threads_tiles_and_stops_make_the_same_picture() {
    let moving = format!("Lorentz {{ velocity 0.6 0.1 0.3 {PLAYERS} }}");
    let scene = scene(&format!("{} Group {{ {STAGE} {moving} }}", view("velocity 0 0 -0.5")));
    for spectral in [false, true] {
        let settings = PathSettings { bounces: 3, spectral, ..PathSettings::default() };
        let size = [20, 16];
        let layers = LayerSet::of(&[crate::Layer::Color]);
        let integrator = settings.prepare(&scene, &scene.output.camera, size, layers);
        let schedule = RenderSettings::new(Sampler::new(SamplerKind::Sobol, 4));
        assert_same_picture(&*integrator, size, &schedule, [2, 1]);
    }
}
