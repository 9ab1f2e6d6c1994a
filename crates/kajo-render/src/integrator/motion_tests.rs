//! What moves while the shutter is open, through every integrator.

use kajo_core::RayOffset;
use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_core::scene::Scene;
use kajo_math::Vec2;
use kajo_scene::MemoryAssets;

use super::tests::{plain, scene_with};
use super::{AmbientOcclusion, AmbientOcclusionSettings, Classic, ClassicSettings, Path, PathSettings};
use crate::{Layer, LayerSet, PixelIntegrator, SampleContext};

/// The picture is 40 pixels wide and 20 high; ten of them are one unit.
const SIZE: [u32; 2] = [40, 20];

/// A scene in front of an orthographic camera two units high.
fn scene(camera_motion: &str, group: &str) -> Scene {
    let text = format!(
        "OrthographicCamera {{ center 0 0 10 direction 0 0 -1 up 0 1 0 size 2 {camera_motion} }}
         Background {{ color 0 0 0 ambientLight 1 1 1 }}
         Materials {{ Material emitter {{ diffuseColor 0 0 0  ambientColor 1 1 1  emission 1 1 1 }} }}
         Group {{ MaterialIndex emitter {group} }}"
    );
    scene_with(&text, &MemoryAssets::new())
}

fn classic(scene: &Scene, layers: LayerSet) -> Classic<'_> {
    let settings = ClassicSettings { shade_back: true, ray_offset: RayOffset::Auto, ..plain(scene) };
    Classic::new(scene, settings, SIZE, layers)
}

/// The part of `[a, b]` within `[0, 1]`.
fn share(a: f64, b: f64) -> f64 {
    (b.min(1.0) - a.max(0.0)).max(0.0)
}

#[test]
fn a_moving_bar_is_a_trapezoid_everywhere() {
    for (w, d) in [(0.5, 1.5), (1.2, 0.7), (1.0, 1.0)] {
        // From -1.4 to the right; a position x is covered while -1.4 + d t <= x <= -1.4 + w + d t.
        let bar =
            "Quad { corner -1.4 -2 0  edge1 1 0 0  edge2 0 4 0 }".replace("edge1 1", &format!("edge1 {w}"));
        let motion = |x: f64| format!("Motion {{ key 0 {{ }} key 1 {{ Translate {x} 0 0 }} }}");
        let covered = |x: f64| share((x + 1.4 - w) / d, (x + 1.4) / d);
        let object = scene("", &format!("Transform {{ {} {bar} }}", motion(d)));
        let camera = scene(&motion(-d), &bar);
        for scene in [&object, &camera] {
            let classic = classic(scene, LayerSet::of(&[]));
            let samples = 1 << 12;
            let sampler = Sampler::new(SamplerKind::Sobol, samples);
            let mut ctx = SampleContext::new(&sampler, 5);
            for column in 0..SIZE[0] {
                let middle = Vec2::new(column as f32 + 0.5, 7.5);
                let radiance = |k: u32| {
                    ctx.begin([column, 7], k);
                    f64::from(classic.sample(&mut ctx, [column, 7], middle).radiance[0])
                };
                // Ambient light and emission, 1 each.
                let found = (0..samples).map(radiance).sum::<f64>() / f64::from(2 * samples);
                let expected = covered(f64::from(middle.x) / 10.0 - 2.0);
                assert!((found - expected).abs() < 1e-3, "{w} {d}, column {column}: {found} for {expected}");
            }
        }
    }
}

/// A hole in a slab that rests moves as a bar does, and shows what is behind it.
#[test]
fn a_moving_hole_is_a_trapezoid() {
    let (w, d) = (0.6, 1.4);
    let slab = "Difference { Box { min -3 -3 -1  max 3 3 0 }
        Transform { Motion { key 0 { } key 1 { Translate 1.4 0 0 } } Box { min -1.4 -2 -2  max -0.8 2 1 } } }";
    let scene = scene("", slab);
    let layers = LayerSet::of(&[]);
    let integrators: [(Box<dyn PixelIntegrator + '_>, f64); 2] = [
        (Box::new(classic(&scene, layers)), 2.0),
        (Box::new(Path::new(&scene, PathSettings::default(), SIZE, layers)), 1.0),
    ];
    let samples = 1 << 12;
    let sampler = Sampler::new(SamplerKind::Sobol, samples);
    for (integrator, light) in &integrators {
        let mut ctx = SampleContext::new(&sampler, 5);
        for column in 0..SIZE[0] {
            let middle = Vec2::new(column as f32 + 0.5, 7.5);
            let radiance = |k: u32| {
                ctx.begin([column, 7], k);
                f64::from(integrator.sample(&mut ctx, [column, 7], middle).radiance[0])
            };
            let found = (0..samples).map(radiance).sum::<f64>() / (light * f64::from(samples));
            let x = f64::from(middle.x) / 10.0 - 2.0 + 1.4;
            let expected = 1.0 - share((x - w) / d, x / d);
            assert!((found - expected).abs() < 1e-3, "column {column}: {found} for {expected}");
        }
    }
}

/// Each row sees a trapezoid of its own: the bar has come so far when the row opens, and moves on for the rest of the time.
#[test]
fn rows_of_a_rolling_shutter_open_one_after_the_other() {
    let (w, d) = (0.5, 1.5);
    let bar = "Transform { Motion { key 0 { } key 1 { Translate 1.5 0 0 } }
        Quad { corner -1.4 -2 0  edge1 0.5 0 0  edge2 0 4 0 } }";
    for readout in [0.25, 0.8, 1.0] {
        let scene = scene(&format!("rollingShutter {readout}"), bar);
        let layers = LayerSet::of(&[]);
        let integrators: [Box<dyn PixelIntegrator + '_>; 2] = [
            Box::new(classic(&scene, layers)),
            Box::new(Path::new(&scene, PathSettings::default(), SIZE, layers)),
        ];
        let samples = 1 << 12;
        let sampler = Sampler::new(SamplerKind::Sobol, samples);
        for (integrator, light) in integrators.iter().zip([2.0, 1.0]) {
            let mut ctx = SampleContext::new(&sampler, 5);
            for (column, row) in (0..SIZE[0]).zip([2, 11, 17].into_iter().cycle()) {
                let middle = Vec2::new(column as f32 + 0.52, row as f32 + 0.5);
                let radiance = |k: u32| {
                    ctx.begin([column, row], k);
                    f64::from(integrator.sample(&mut ctx, [column, row], middle).radiance[0])
                };
                let found = (0..samples).map(radiance).sum::<f64>() / (light * f64::from(samples));
                let opens = readout * f64::from(middle.y) / 20.0;
                let (x, moved) = (f64::from(middle.x) / 10.0 - 2.0 + 1.4 - d * opens, d * (1.0 - readout));
                let expected = match moved > 0.0 {
                    true => share((x - w) / moved, x / moved),
                    false => f64::from(u8::from(x > 0.0 && x < w)),
                };
                assert!((found - expected).abs() < 2e-3, "{readout}, {column} {row}: {found} for {expected}");
            }
        }
    }
}

#[test]
fn layers_record_the_motion_in_pixels() {
    let wall = "Quad { corner -9 -9 0  edge1 18 0 0  edge2 0 18 0 }";
    let motion = "Motion { key 0 { } key 2 { Translate 0.8 0.6 0 } }";
    for (camera, moves, expected) in [
        ("", motion, Vec2::new(4.0, -3.0)),
        (motion, "", Vec2::new(-4.0, 3.0)),
        (motion, motion, Vec2::ZERO),
        ("", "", Vec2::ZERO),
        ("shutter 0.5 1", motion, Vec2::new(2.0, -1.5)),
        ("", "Motion { key 0 { } key 1 { UniformScale 2 } }", Vec2::new(5.0, 0.0)),
    ] {
        let scene = scene(camera, &format!("Transform {{ {moves} {wall} }}"));
        let layers = LayerSet::of(&[Layer::Motion]);
        let integrators: [Box<dyn PixelIntegrator + '_>; 3] = [
            Box::new(classic(&scene, layers)),
            Box::new(Path::new(&scene, PathSettings::default(), SIZE, layers)),
            Box::new(AmbientOcclusion::new(&scene, AmbientOcclusionSettings { reach: 1.0 }, SIZE, layers)),
        ];
        for integrator in integrators {
            let sampler = Sampler::new(SamplerKind::Uniform, 16);
            let mut ctx = SampleContext::new(&sampler, 1);
            for k in 0..16 {
                ctx.begin([25, 10], k);
                ctx.aux = Default::default();
                integrator.sample(&mut ctx, [25, 10], Vec2::new(25.0, 10.0));
                let found = Vec2::from(ctx.aux.motion);
                // What grows moves by its place when the shutter opens, and that depends on when it was met.
                let grows = expected.x == 5.0;
                let right = if grows {
                    found.x > 2.4 && found.x < 5.1 && found.y.abs() < 1e-3
                } else {
                    found.distance(expected) < 1e-3
                };
                assert!(right, "{camera} / {moves}: {found}");
            }
        }
    }
}

#[test]
fn what_rests_takes_no_time_and_no_other_numbers() {
    let ball = "Sphere { center 0 0 0  radius 0.9 }";
    let still = scene("", ball);
    let later =
        scene("", &format!("Transform {{ Motion {{ key 3 {{ }} key 4 {{ Translate 9 9 9 }} }} {ball} }}"));
    let layers = LayerSet::of(&[]);
    let sampler = Sampler::new(SamplerKind::Pmj, 64);
    let [a, b] = [&still, &later].map(|scene| Path::new(scene, PathSettings::default(), SIZE, layers));
    let mut ctx = SampleContext::new(&sampler, 9);
    for k in 0..64 {
        let place = ctx.begin([12, 3], k) + Vec2::new(12.0, 3.0);
        let draws = ctx.draws;
        let first = a.sample(&mut ctx, [12, 3], place);
        ctx.draws = draws;
        let second = b.sample(&mut ctx, [12, 3], place);
        assert_eq!(first.radiance, second.radiance);
        assert_eq!(first.first.map(|hit| hit.t.to_bits()), second.first.map(|hit| hit.t.to_bits()));
    }
}
