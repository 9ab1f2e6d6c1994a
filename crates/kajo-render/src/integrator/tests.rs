//! The classic integrator against closed forms.

use kajo_core::RayOffset;
use kajo_core::bsdf::fresnel;
use kajo_core::compile::{CompileOptions, compile};
use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_core::scene::Scene;
use kajo_core::settings::{ShadowAttenuation, Shadows};
use kajo_math::{Vec2, rng::Stream};
use kajo_scene::{MemoryAssets, SceneDesc};
use kajo_testkit::vdb::{VdbCompression, VdbFile, VdbGrid, VdbKind, VdbMap};

use super::classic::{Classic, ClassicSettings};
use crate::{LayerSet, PixelIntegrator, PixelSample, RayCounters, SampleContext};

/// An orthographic camera two units high that looks down the z axis, and a world without light.
const VIEW: &str = "OrthographicCamera { center 0 0 10 direction 0 0 -1 up 0 1 0 size 2 }
    Background { color 0 0 0 ambientLight 0 0 0 }
    Lights { DirectionalLight { direction 0 0 -1 color 0 0 0 } }";

fn scene(text: &str) -> Scene {
    scene_with(text, &MemoryAssets::new())
}

/// The scene that a text describes, with these files beside it.
pub(super) fn scene_with(text: &str, assets: &MemoryAssets) -> Scene {
    let mut parsed = SceneDesc::parse_str(text);
    let scene = compile(&mut parsed.desc, assets, &CompileOptions::default(), &mut parsed.diagnostics);
    scene.unwrap_or_else(|| panic!("{text}\n{:?}", parsed.diagnostics))
}

/// A cube of 4 x 4 x 4 voxels that are all the same.
pub(super) fn cube_of_voxels(name: &str, kind: VdbKind, value: [f32; 3]) -> VdbGrid {
    let mut grid = VdbGrid::new(name, kind, VdbMap::Uniform(1.0));
    for k in 0..64 {
        grid.set([k % 4, k / 4 % 4, k / 16], value);
    }
    grid
}

/// A file `smoke.vdb` of these grids.
pub(super) fn vdb_of(grids: Vec<VdbGrid>) -> MemoryAssets {
    let file = VdbFile { version: 224, compression: VdbCompression::Zip, masks: true, grids };
    MemoryAssets::new().with("smoke.vdb", file.to_bytes())
}

/// Two scenes in which smoke behind clear glass, lit from above, is on the camera's ray for three quarters of the time that the shutter is open,
/// and the light that it scatters once: a box of it moves, or it moves in its box.
pub(super) fn passing_smoke() -> ([Scene; 2], f64) {
    let scene_of = |x: f32, medium: &str, things: &str| {
        let text = format!(
            "PerspectiveCamera {{ center {x} 0.4 5  direction 0 0 -1  up 0 1 0  angle 0.01  shutter 0 1 }} Background {{ color 0 0 0 }}
             Lights {{ DirectionalLight {{ direction 0 -1 0  irradiance 1 }} }} Media {{ {medium} }}
             Materials {{ Glass glass {{ indexOfRefraction 1.0001 medium m }} }} Group {{ MaterialIndex glass {things} }}"
        );
        let grids = vec![
            cube_of_voxels("density", VdbKind::Float, [1.0; 3]),
            cube_of_voxels("vel", VdbKind::Vec3, [8.0, 0.0, 0.0]),
        ];
        scene_with(&text, &vdb_of(grids))
    };
    let motion = "Motion { key 0 { } key 1 { Translate 2 0 0 } }";
    let moving_box = format!("Transform {{ {motion} Box {{ min -1 -1 -1 max 1 1 1 }} }}");
    let grid =
        "GridMedium m { file smoke.vdb min -1 -1 -1 max 1 1 1  density 1  velocityScale 0.5 velocity vel }";
    let scenes = [
        scene_of(0.5, "Medium m { sigma_s 1 }", &moving_box),
        scene_of(1.5, grid, "Box { min -3 -2 -2 max 4 2 2 }"),
    ];
    (scenes, 0.75 * (-0.6f64).exp() * (1.0 - (-2.0f64).exp()) / (4.0 * std::f64::consts::PI))
}

/// Camera rays and their shading, and nothing more.
pub(super) fn plain(scene: &Scene) -> ClassicSettings {
    ClassicSettings {
        bounces: 0,
        weight: 0.0,
        shadows: Shadows::Off,
        shadow_attenuation: ShadowAttenuation::Length,
        shade_back: false,
        uv: false,
        fresnel: false,
        total_reflection: false,
        ray_offset: RayOffset::Reference,
        highlight: scene.output.rules.highlight,
    }
}

/// Light along the camera ray through picture coordinates `(x, y)` in [-1, 1]^2, and the rays it took.
fn look(scene: &Scene, settings: ClassicSettings, x: f32, y: f32) -> ([f32; 3], RayCounters) {
    let classic = Classic::new(scene, settings, [200, 200], LayerSet::of(&[]));
    let raster = Vec2::new(100.0 * (x + 1.0), 100.0 * (1.0 - y));
    let (sample, rays) = take(&classic, [0, 0], raster);
    (sample.radiance, rays)
}

/// The sample of a pixel at a position, and the rays it took.
fn take(classic: &Classic<'_>, pixel: [u32; 2], raster: Vec2) -> (PixelSample, RayCounters) {
    let sampler = Sampler::new(SamplerKind::Regular, 1);
    let mut ctx = SampleContext::new(&sampler, 0);
    (classic.sample(&mut ctx, pixel, raster), ctx.rays)
}

fn near(got: f32, expected: f64, tolerance: f64) {
    assert!((f64::from(got) - expected).abs() <= tolerance, "{got} instead of {expected}");
}

fn random(i: u32) -> impl Fn(u32) -> f32 {
    let stream = Stream::new(71, [i, 0], 0);
    move |k| stream.uniform(k)
}

#[test]
fn point_lights_fall_off_as_told() {
    let at = |attenuation: &str, z: f32| {
        let s = scene(&format!(
            "{VIEW} Materials {{ Material {{ diffuseColor 0.5 0.6 0.7 }} }}
             Lights {{ PointLight {{ position 0 0 {z} color 2 2 2 attenuation {attenuation} }} }}
             Group {{ MaterialIndex 0 Plane {{ normal 0 0 1 offset 0 }} }}"
        ));
        look(&s, plain(&s), 0.0, 0.0).0
    };
    near(at("1 0 0", 3.0)[0], 1.0, 1e-6);
    near(at("0 0 1", 2.0)[1] / at("0 0 1", 4.0)[1], 4.0, 1e-5);
    near(at("0.5 0.25 0.125", 2.0)[2], 2.0 * 0.7 / (0.5 + 0.5 + 0.5), 1e-6);
}

#[test]
fn shadow_rays_begin_a_thousandth_off_in_the_reference_mode_only() {
    let lit = |gap: f32, ray_offset: RayOffset| {
        let s = scene(&format!(
            "{VIEW} Materials {{ Material {{ }} }} Lights {{ DirectionalLight {{ direction 1 0 -1 color 1 1 1 }} }}
             Group {{ MaterialIndex 0 Plane {{ normal 0 0 1 offset 0 }}
                      Quad {{ corner {} -1 0 edge1 0 2 0 edge2 0 0 1 }} }}",
            -gap
        ));
        // At the origin the light comes from -x, where a wall stands `gap` away.
        let settings = ClassicSettings { shadows: Shadows::Opaque, ray_offset, ..plain(&s) };
        look(&s, settings, 0.0, 0.0).0[0] > 0.1
    };
    // Along the diagonal the wall is gap * sqrt 2 away.
    assert!(lit(0.0009 / 1.5, RayOffset::Reference), "an occluder at 0.0009 casts no shadow");
    assert!(!lit(0.0011, RayOffset::Reference), "one at 0.0011 and more does");
    assert!(!lit(0.0009 / 1.5, RayOffset::Auto), "without the thousandth it does too");
}

#[test]
fn objects_beyond_a_point_light_cast_no_shadow() {
    let lit = |z: f32| {
        let s = scene(&format!(
            "{VIEW} Materials {{ Material {{ }} }} Lights {{ PointLight {{ position 0.5 0 3 color 1 1 1 }} }}
             Group {{ MaterialIndex 0 Plane {{ normal 0 0 1 offset 0 }} Quad {{ corner 0.1 -5 {z} edge1 5 0 0 edge2 0 10 0 }} }}"
        ));
        look(&s, ClassicSettings { shadows: Shadows::Opaque, ..plain(&s) }, 0.0, 0.0).0[0] > 0.1
    };
    assert!(lit(4.0) && !lit(2.0));
}

#[test]
fn facing_mirrors_add_a_geometric_series() {
    let s = scene(
        "OrthographicCamera { center 0 0 0 direction 0 0 -1 up 0 1 0 size 2 }
         Background { color 9 9 9 ambientLight 1 1 1 } Lights { DirectionalLight { direction 0 0 -1 color 0 0 0 } }
         Materials { Material { diffuseColor 0.1 0.2 0.3 reflectiveColor 0.5 0.5 0.5 } }
         Group { MaterialIndex 0 Quad { corner -9 -9 -1 edge1 18 0 0 edge2 0 18 0 } Quad { corner -9 -9 -3 edge1 18 0 0 edge2 0 18 0 } }",
    );
    // Seen from outside there is one mirror: its other side shows nothing but sky.
    for bounces in [0u32, 1, 2, 5] {
        let (rgb, rays) = look(&s, ClassicSettings { bounces, ..plain(&s) }, 0.0, 0.0);
        let expected = 0.1 + if bounces == 0 { 0.0 } else { 0.5 * 9.0 };
        near(rgb[0], expected, 1e-5);
        assert_eq!(rays.reflected, u64::from(bounces.min(1)));
    }
    let s = scene(
        "PerspectiveCamera { center 0 0 -2 direction 0 0 -1 up 0 1 0 angle 30 }
         Background { color 9 9 9 ambientLight 1 1 1 } Lights { DirectionalLight { direction 0 0 -1 color 0 0 0 } }
         Materials { Material { diffuseColor 0.1 0.2 0.3 reflectiveColor 0.5 0.5 0.5 } }
         Group { MaterialIndex 0 Quad { corner -9 -9 -1 edge1 18 0 0 edge2 0 18 0 } Quad { corner -9 -9 -3 edge1 18 0 0 edge2 0 18 0 } }",
    );
    for bounces in [0u32, 1, 2, 5, 20] {
        let (rgb, rays) = look(&s, ClassicSettings { bounces, ..plain(&s) }, 0.0, 0.0);
        near(rgb[1], 0.2 * (1.0 - 0.5f64.powi(bounces as i32 + 1)) / 0.5, 1e-5);
        assert_eq!(rays.reflected, u64::from(bounces));
    }
    // Each mirror's magnitude is sqrt(3)/2: a product below 0.5 ends the branch after four of them.
    let (_, rays) = look(&s, ClassicSettings { bounces: 20, weight: 0.5, ..plain(&s) }, 0.0, 0.0);
    assert_eq!(rays.reflected, 4);
}

/// Glass that neither absorbs nor adds: with Fresnel's division every way through it shows the
/// uniform sky, whatever the path.
#[test]
fn a_glass_ball_in_uniform_light_is_invisible() {
    for eta in [1.33, 1.5, 2.417] {
        let s = scene(&format!(
            "OrthographicCamera {{ center 0 0 10 direction 0 0 -1 up 0 1 0 size 2 }} Background {{ color 1 1 1 }}
             Lights {{ DirectionalLight {{ direction 0 0 -1 color 0 0 0 }} }}
             Materials {{ Material {{ diffuseColor 0 0 0 transparentColor 1 1 1 indexOfRefraction {eta} }} }}
             Group {{ MaterialIndex 0 Sphere {{ center 0 0 0 radius 1 }} }}"
        ));
        let settings = ClassicSettings { bounces: 24, weight: 1e-7, fresnel: true, ..plain(&s) };
        for i in 0..40 {
            near(look(&s, settings, i as f32 / 40.0, 0.05).0[0], 1.0, 2e-5);
        }
    }
}

/// The sky is seen where the ray through a ball leaves it: two refractions by Snell's law.
#[test]
fn a_ball_lens_bends_rays_as_its_formula_says() {
    let s = scene(
        "OrthographicCamera { center 0 0 10 direction 0 0 -1 up 0 1 0 size 2 } Background { color 0 0 0 }
         Lights { DirectionalLight { direction 0 0 -1 color 0 0 0 } }
         Materials { Material { diffuseColor 0 0 0 transparentColor 1 1 1 indexOfRefraction 1.5 } Material { diffuseColor 1 1 1 } }
         Background { color 0 0 0 ambientLight 1 1 1 }
         Group { MaterialIndex 0 Sphere { center 0 0 0 radius 1 } MaterialIndex 1 Disk { center 0 0 -1.391573 normal 0 0 1 radius 0.0005 } }",
    );
    // At height 0.5 the ray crosses the axis 1.391573 behind the centre and hits the small disk there.
    let settings = ClassicSettings { bounces: 2, ..plain(&s) };
    near(look(&s, settings, 0.5, 0.0).0[0], 1.0, 1e-6);
    near(look(&s, settings, 0.0, 0.5).0[0], 1.0, 1e-6);
    near(look(&s, settings, 0.45, 0.0).0[0], 0.0, 1e-6);
    near(look(&s, settings, 0.55, 0.0).0[0], 0.0, 1e-6);
}

#[test]
fn a_camera_inside_glass_sees_straight_out() {
    let s = scene(
        "PerspectiveCamera { center 0 0 0.3 direction 0 0 -1 up 0 1 0 angle 90 } Background { color 0 0 0 ambientLight 1 1 1 }
         Lights { DirectionalLight { direction 0 0 -1 color 0 0 0 } }
         Materials { Material { diffuseColor 0 0 0 transparentColor 1 1 1 indexOfRefraction 1.8 } Material { } }
         Group { MaterialIndex 0 Sphere { center 0 0 0 radius 1 } MaterialIndex 1 Disk { center 3 0 -4.7 normal 0 0 1 radius 0.01 } }",
    );
    // The carried index is 1 at the camera, so the way out of the ball is 1 to 1.
    near(look(&s, ClassicSettings { bounces: 1, ..plain(&s) }, 0.6, 0.0).0[0], 1.0, 1e-6);
}

#[test]
fn total_internal_reflection_is_dark_unless_asked_for() {
    // A ray enters the lower face of a prism straight and hits the slanted face at 45 degrees.
    let s = scene(
        "OrthographicCamera { center 0 0 10 direction 0 0 -1 up 0 1 0 size 2 } Background { color 0.25 0.5 0.75 }
         Lights { DirectionalLight { direction 0 0 -1 color 0 0 0 } }
         Materials { Material { diffuseColor 0 0 0 transparentColor 1 1 1 indexOfRefraction 1.5 } }
         Group { MaterialIndex 0
            Quad { corner -1 -1 1 edge1 2 0 0 edge2 0 2 0 }
            Quad { corner 1 -1 1 edge1 -2 0 -2 edge2 0 2 0 }
            Quad { corner -1 -1 -1 edge1 0 0 2 edge2 0 2 0 } }",
    );
    let base = ClassicSettings { bounces: 6, ..plain(&s) };
    let (dark, _) = look(&s, base, 0.0, 0.0);
    assert_eq!(dark, [0.0; 3]);
    let (physical, _) = look(&s, ClassicSettings { total_reflection: true, ..base }, 0.0, 0.0);
    assert_eq!(physical, [0.25, 0.5, 0.75], "all of it goes round the corner and out through the side");
    // Entering and leaving squarely each mirror 4 percent; what is lost comes back as sky light.
    let (fresnel, _) = look(&s, ClassicSettings { fresnel: true, bounces: 30, ..base }, 0.0, 0.0);
    near(fresnel[0], 0.25, 1e-5);
}

#[test]
fn fresnel_divides_by_the_angle() {
    let s = scene(
        "OrthographicCamera { center 0 0 10 direction 0 0 -1 up 0 1 0 size 2 } Background { color 1 1 1 }
         Lights { DirectionalLight { direction 0 0 -1 color 0 0 0 } }
         Materials { Material { diffuseColor 0 0 0 transparentColor 1 0 0 indexOfRefraction 1.5 } Material { diffuseColor 0 0 0 } }
         Group { MaterialIndex 0 Plane { normal 1 0 1 offset 0 } MaterialIndex 1 Disk { center 0 0 -5 normal 0 0 1 radius 9 } }",
    );
    // Behind the glass all is black; in the mirror direction (towards +x) all is white.
    let (rgb, _) = look(&s, ClassicSettings { bounces: 1, fresnel: true, ..plain(&s) }, 0.0, 0.0);
    near(rgb[0], fresnel::dielectric(0.5f32.sqrt(), 1.5).into(), 1e-6);
    near(rgb[0], 0.050_240, 1e-5);
    assert_eq!(rgb[1], 0.0);
}

#[test]
fn straight_line_shadows_of_glass_follow_the_chord() {
    for i in 0..100 {
        let u = random(i);
        let (b, sigma) = (0.999 * u(0), 3.0 * u(1));
        let s = scene(&format!(
            "{VIEW} Lights {{ DirectionalLight {{ direction 0 0 -1 color 1 1 1 }} }}
             Materials {{ Material {{ }} Material {{ diffuseColor 0 0 0 transparentColor 1 1 1 absorption {sigma} 0 {} }} }}
             Group {{ MaterialIndex 0 Plane {{ normal 0 0 1 offset 0 }}
                      MaterialIndex 1 Transform {{ Translate {b} 0 15 Sphere {{ center 0 0 0 radius 1 }} }} }}",
            2.0 * sigma
        ));
        // The camera looks through the ball too: white glass of index 1 adds nothing on the way.
        let settings = ClassicSettings { shadows: Shadows::Transparent, bounces: 2, ..plain(&s) };
        let (rgb, _) = look(&s, settings, 0.0, 0.0);
        let chord = 2.0 * (1.0 - f64::from(b * b)).sqrt();
        let shadow = |sigma: f64| (-sigma * chord).exp();
        near(rgb[0], shadow(sigma.into()), 2e-5);
        near(rgb[1], 1.0, 1e-5);
        near(rgb[2], shadow(2.0 * f64::from(sigma)), 2e-5);
    }
}

#[test]
fn transparent_shadows_know_insides_and_thin_things() {
    let lit = |objects: &str, attenuation: ShadowAttenuation| {
        let s = scene(&format!(
            "{VIEW} Lights {{ PointLight {{ position 0 3 3 color 1 1 1 }} }}
             Materials {{ Material {{ }} Material {{ transparentColor 0.5 0.25 1 }} Material {{ transparentColor 0 0 0 }} }}
             Group {{ MaterialIndex 0 Plane {{ normal 0 0 1 offset 0 }} {objects} }}"
        ));
        let settings =
            ClassicSettings { shadows: Shadows::Transparent, shadow_attenuation: attenuation, ..plain(&s) };
        let (with, _) = look(&s, settings, 0.0, 0.0);
        let (without, _) = look(&s, plain(&s), 0.0, 0.0);
        [0, 1, 2].map(|i| with[i] / without[i])
    };
    let close = |got: [f32; 3], expected: [f64; 3]| (0..3).for_each(|i| near(got[i], expected[i], 1e-5));
    let (length, surface) = (ShadowAttenuation::Length, ShadowAttenuation::Surface);
    // A pane between z = 1 and z = 1.5 is crossed at 45 degrees: 0.5 sqrt 2 inside.
    let pane = "MaterialIndex 1 Box { min -5 0.5 1 max 5 5 1.5 }";
    let d = 0.5 * 2f64.sqrt();
    close(lit(pane, length), [0.5f64.powf(d), 0.25f64.powf(d), 1.0]);
    close(lit(pane, surface), [0.25, 0.0625, 1.0]);
    // A light inside the glass: only the way from its surface at z = 2 counts, sqrt 2.
    let around = "MaterialIndex 1 Box { min -5 1.5 2 max 5 5 5 }";
    let d = 2f64.sqrt();
    close(lit(around, length), [0.5f64.powf(d), 0.25f64.powf(d), 1.0]);
    // A sheet without thickness filters once, an opaque one blocks.
    close(
        lit("MaterialIndex 1 Quad { corner -5 0.5 1 edge1 10 0 0 edge2 0 10 0 }", length),
        [0.5, 0.25, 1.0],
    );
    close(
        lit(&format!("{pane} MaterialIndex 2 Quad {{ corner -5 0.5 2 edge1 10 0 0 edge2 0 10 0 }}"), length),
        [0.0; 3],
    );
    // Where the objects do not reach, nothing changes.
    close(lit("MaterialIndex 2 Quad { corner 4 -5 1 edge1 10 0 0 edge2 0 10 0 }", length), [1.0; 3]);
}

#[test]
fn fog_weakens_every_stretch() {
    let s = scene(&format!(
        "{VIEW} Fog {{ color 0.2 0.4 0.6 density 0.3 }} Background {{ color 1 1 1 ambientLight 1 1 1 }}
         Materials {{ Material {{ diffuseColor 0.5 0.5 0.5 reflectiveColor 0.5 0.5 0.5 }} }}
         Group {{ MaterialIndex 0 Quad {{ corner -1 -1 4 edge1 1 0 0 edge2 0 2 0 }} }}"
    ));
    let t = (-0.3f64 * 6.0).exp();
    let settings = ClassicSettings { bounces: 1, ..plain(&s) };
    // The mirror shows endless fog, seen through fog.
    near(look(&s, settings, -0.5, 0.0).0[0], t * (0.5 + 0.5 * 0.2) + (1.0 - t) * 0.2, 1e-5);
    near(look(&s, settings, 0.5, 0.0).0[2], 0.6, 1e-6);
}

#[test]
fn back_sides_are_dark_or_lit_as_told() {
    let s = scene(&format!(
        "{VIEW} Lights {{ DirectionalLight {{ direction 0 0 -1 color 1 1 1 }} }} Materials {{ Material {{ ambientColor 0 0 0 }} }}
         Group {{ MaterialIndex 0 Triangle {{ vertex0 -9 -9 0 vertex1 0 9 0 vertex2 9 -9 0 }} }}"
    ));
    assert_eq!(look(&s, plain(&s), 0.0, 0.0).0, [0.0; 3], "clockwise: its back faces the camera");
    let lit = ClassicSettings { shade_back: true, ..plain(&s) };
    near(look(&s, lit, 0.0, 0.0).0[0], 1.0, 1e-6);
}

#[test]
fn the_test_picture_shows_pixel_centres() {
    let s = scene(VIEW);
    let classic = Classic::new(&s, ClassicSettings { uv: true, ..plain(&s) }, [8, 4], LayerSet::of(&[]));
    for (i, j) in [(0u32, 0u32), (7, 0), (3, 2), (7, 3)] {
        // A regular grid of two or three samples hangs over into the rows below.
        for offset in [0.01, 0.5, 0.99, 2.5] {
            let raster = Vec2::new(i as f32 + offset, j as f32 + offset);
            let sample = take(&classic, [i, j], raster).0;
            let expected = [(i as f32 + 0.5) / 8.0, (j as f32 + 0.5) / 4.0, 1.0];
            assert_eq!(sample.radiance, expected);
        }
    }
}

#[test]
fn depth_of_a_tilted_plane_is_exact() {
    for i in 0..200 {
        let u = random(i);
        let (nx, ny, offset) = (u(0) - 0.5, u(1) - 0.5, 4.0 * u(2) - 2.0);
        let s = scene(&format!(
            "PerspectiveCamera {{ center 0 0 10 direction 0 0 -1 up 0 1 0 angle 40 }} Materials {{ Material {{ }} }}
             Group {{ MaterialIndex 0 Plane {{ normal {nx} {ny} 1 offset {offset} }} }}"
        ));
        let classic = Classic::new(&s, plain(&s), [64, 64], LayerSet::of(&[]));
        let raster = Vec2::new(64.0 * u(3), 64.0 * u(4));
        let sample = take(&classic, [0, 0], raster).0;
        let d = f64::to_radians(20.0).tan();
        let (x, y) = (f64::from(raster.x) / 32.0 - 1.0, 1.0 - f64::from(raster.y) / 32.0);
        let length = (x * x * d * d + y * y * d * d + 1.0).sqrt();
        let (nx, ny, n) = (f64::from(nx), f64::from(ny), (f64::from(nx * nx + ny * ny) + 1.0).sqrt());
        let along = (nx * x * d + ny * y * d - 1.0) / length;
        let expected = (f64::from(offset) * n - 10.0) / along;
        let got = f64::from(sample.first.expect("a plane without end").t);
        assert!((got / expected - 1.0).abs() < 2e-6, "{got} {expected}");
    }
}
