//! Flat surfaces in coordinate planes, through the origin, turned and moved, at all scales: where rays that leave a
//! surface meet it again, nothing of this comes out.
//!
//! Under a sky of radiance 1 and without anything else in the scene,
//!
//! ```text
//! a mirror, a pane, a cut-out, and white matt with holes   L = 1
//! matt of albedo a                                         L = a
//! nothing hides a light                                    E by Lambert's formula
//! ```
//!
//! The first two hold for every single path that is continued by scattering alone.

use std::f64::consts::PI;
use std::fmt::Write;

use kajo_core::RayOffset;
use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_core::scene::Scene;
use kajo_core::settings::{Shadows, Technique};
use kajo_math::solid_angle::polygon_irradiance;
use kajo_math::{DVec3, Vec2};
use kajo_scene::MemoryAssets;

use super::tests::{plain, scene_with};
use super::{
    AmbientOcclusion, AmbientOcclusionSettings, Bidirectional, BidirectionalSettings, Classic,
    ClassicSettings, Path, PathSettings,
};
use crate::{LayerSet, PixelIntegrator, SampleContext};

const SCALES: [f64; 5] = [1e-6, 1e-3, 1.0, 1e3, 1e6];

/// A plane with its axes: the first and the last lie in it, the second is its normal, counter-clockwise.
#[derive(Clone, Copy, Debug)]
struct PlaneFrame {
    origin: DVec3,
    axes: [DVec3; 3],
    scale: f64,
}

impl PlaneFrame {
    /// World space from coordinates in the plane, of the order of 1, and above it.
    fn at(&self, [x, y, z]: [f64; 3]) -> DVec3 {
        let [u, n, v] = self.axes;
        self.scale * (self.origin + x * u + y * n + z * v)
    }

    fn text(&self, p: [f64; 3]) -> String {
        numbers(self.at(p))
    }

    fn direction(&self, [x, y, z]: [f64; 3]) -> DVec3 {
        let [u, n, v] = self.axes;
        x * u + y * n + z * v
    }
}

fn numbers(v: DVec3) -> String {
    format!("{} {} {}", v.x as f32, v.y as f32, v.z as f32)
}

/// Coordinate planes from either side and planes across all axes; through the origin, and not.
fn frames() -> impl Iterator<Item = PlaneFrame> {
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let n = DVec3::new(2.0, 1.0, -2.0) / 3.0;
    let u = n.any_orthonormal_vector();
    let frames = [[x, y, -z], [x, -y, z], [y, z, -x], [z, x, -y], [-z, -x, -y], [u, n, u.cross(n)]];
    let origins = [DVec3::ZERO, DVec3::new(3.0, -2.0, 1.5)];
    SCALES.into_iter().flat_map(move |scale| {
        frames
            .into_iter()
            .flat_map(move |axes| origins.into_iter().map(move |origin| PlaneFrame { origin, axes, scale }))
    })
}

/// Corners of a square in the plane, counter-clockwise as seen from above it.
const SQUARE: [[f64; 2]; 4] = [[-2.0, -2.0], [-2.0, 2.0], [2.0, 2.0], [2.0, -2.0]];
const TRIANGLE: [[f64; 2]; 3] = [[-2.0, -2.0], [-1.5, 3.0], [3.0, -1.0]];

/// What stands in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Flat {
    Plane,
    Disk,
    Quad,
    Triangle,
    /// One face of a box, the others below.
    Lid,
    /// A mesh with its corners in the world, as many squares wide as this.
    Mesh(u32),
    /// A mesh that a transform moves there.
    Placed(u32),
}

const FLATS: [Flat; 8] = [
    Flat::Plane,
    Flat::Disk,
    Flat::Quad,
    Flat::Triangle,
    Flat::Lid,
    Flat::Mesh(1),
    Flat::Mesh(5),
    Flat::Placed(3),
];

/// A square mesh of squares of two triangles each.
fn grid(squares: u32, point: impl Fn([f64; 3]) -> DVec3) -> String {
    let side = squares + 1;
    let mut obj = String::new();
    for i in 0..side * side {
        let [x, z] = [i % side, i / side].map(|k| 4.0 * f64::from(k) / f64::from(squares) - 2.0);
        writeln!(obj, "v {}", numbers(point([x, 0.0, z]))).expect("memory");
    }
    for i in 0..squares * squares {
        let a = i / squares * side + i % squares + 1;
        let (b, c, d) = (a + side, a + side + 1, a + 1);
        writeln!(obj, "f {a} {b} {c}\nf {a} {c} {d}").expect("memory");
    }
    obj
}

impl Flat {
    fn text(self, frame: &PlaneFrame) -> String {
        let n = frame.axes[1];
        match self {
            Flat::Plane => {
                format!("Plane {{ normal {} offset {} }}", numbers(n), frame.at([0.0; 3]).dot(n) as f32)
            }
            Flat::Disk => format!(
                "Disk {{ center {} normal {} radius {} }}",
                frame.text([0.0; 3]),
                numbers(n),
                2.0 * frame.scale as f32
            ),
            Flat::Quad => format!(
                "Quad {{ corner {} edge1 {} edge2 {} }}",
                frame.text([-2.0, 0.0, -2.0]),
                numbers(frame.scale * frame.direction([0.0, 0.0, 4.0])),
                numbers(frame.scale * frame.direction([4.0, 0.0, 0.0])),
            ),
            Flat::Triangle => {
                let [a, b, c] = TRIANGLE.map(|[x, z]| frame.text([x, 0.0, z]));
                format!("Triangle {{ vertex0 {a} vertex1 {b} vertex2 {c} }}")
            }
            Flat::Lid => Flat::placed(frame, "Box { min -2 -1 -2 max 2 0 2 }"),
            Flat::Mesh(_) => "TriangleMesh { file mesh.obj }".to_string(),
            Flat::Placed(_) => Flat::placed(frame, "TriangleMesh { file mesh.obj }"),
        }
    }

    /// A thing of unit size in the plane y = 0, moved to its place.
    fn placed(frame: &PlaneFrame, thing: &str) -> String {
        let [u, n, v] = frame.axes.map(|axis| numbers(frame.scale * axis));
        let origin = frame.text([0.0; 3]);
        format!("Transform {{ Matrix {{ {u} 0 {n} 0 {v} 0 {origin} 1 }} {thing} }}")
    }

    fn assets(self, frame: &PlaneFrame) -> MemoryAssets {
        let mesh = match self {
            Flat::Mesh(squares) => grid(squares, |p| frame.at(p)),
            Flat::Placed(squares) => grid(squares, DVec3::from),
            _ => return MemoryAssets::new(),
        };
        MemoryAssets::new().with("mesh.obj", mesh)
    }

    /// Its outline, if that is a polygon.
    fn outline(self, frame: &PlaneFrame) -> Option<Vec<DVec3>> {
        let corner = |&[x, z]: &[f64; 2]| frame.at([x, 0.0, z]);
        match self {
            Flat::Quad | Flat::Mesh(_) | Flat::Placed(_) => Some(SQUARE.iter().map(corner).collect()),
            Flat::Triangle => Some(TRIANGLE.iter().map(corner).collect()),
            Flat::Plane | Flat::Disk | Flat::Lid => None,
        }
    }
}

/// A camera that sees nothing but the middle of the plane, from above; how steeply is up to `from`.
fn camera(frame: &PlaneFrame, from: [f64; 3]) -> String {
    let d = -frame.direction(from);
    format!(
        "PerspectiveCamera {{ center {} direction {} up 0.31 0.82 0.2 angle 4 }}",
        frame.text(from),
        numbers(d.normalize())
    )
}

fn scene(flat: Flat, frame: &PlaneFrame, text: &str) -> Scene {
    scene_with(text, &flat.assets(frame))
}

/// Steep and grazing.
const VIEWS: [[f64; 3]; 2] = [[0.4, 3.0, 1.0], [2.4, 0.4, 1.5]];

/// The scene of one flat thing under a white sky.
fn under_a_sky(flat: Flat, frame: &PlaneFrame, view: [f64; 3], material: &str) -> Scene {
    let text = format!(
        "{} Background {{ color 1 1 1 ambientLight 0 0 0 }} Lights {{ }} Materials {{ {material} }}
         Group {{ MaterialIndex m {} }}",
        camera(frame, view),
        flat.text(frame)
    );
    scene(flat, frame, &text)
}

/// Sixteen samples over the picture.
fn samples(integrator: &dyn PixelIntegrator) -> Vec<f32> {
    let sampler = Sampler::new(SamplerKind::Uniform, 1);
    let mut ctx = SampleContext::new(&sampler, 0);
    let pixels = (0..16).map(|i| [i % 4, i / 4]);
    let sample = |[x, y]: [u32; 2]| {
        let offset = ctx.begin([x, y], 0);
        integrator.sample(&mut ctx, [x, y], Vec2::new(x as f32, y as f32) + offset).radiance[0]
    };
    pixels.map(sample).collect()
}

#[track_caller]
fn check(what: &str, frame: &PlaneFrame, values: &[f32], expected: f32) {
    let is_right = |v: &f32| (v - expected).abs() < 1e-4;
    let wrong = values.iter().filter(|v| !is_right(v)).count();
    assert!(wrong == 0, "{what} at {frame:?}: {wrong} of {} are wrong: {values:?}", values.len());
}

fn by_scattering() -> PathSettings {
    PathSettings { technique: Technique::Scattering, roulette: false, ..PathSettings::default() }
}

#[test]
fn nothing_flat_hides_the_sky_from_itself() {
    let empty = || LayerSet::of(&[]);
    for frame in frames() {
        for flat in FLATS {
            for view in VIEWS {
                let is_solid = flat == Flat::Lid;
                let materials = [
                    ("matt", "Matte m { color 0.5 0.5 0.5 }", 0.5),
                    ("mirror", "Metal m { color 1 1 1 }", 1.0),
                    ("pane", "Glass m { thin on }", 1.0),
                    ("holes", "Matte m { color 1 1 1 opacity 0.5 }", 1.0),
                    ("cut-out", "Matte m { color 1 0 0 opacity 0 }", 1.0),
                ];
                for (name, material, expected) in materials {
                    let scene = under_a_sky(flat, &frame, view, material);
                    let what = format!("{name} {flat:?} from {view:?}");
                    if is_solid && name == "holes" {
                        continue; // Light goes to and fro within the box, and not for ever.
                    }
                    let path = Path::new(&scene, by_scattering(), [4, 4], empty());
                    check(&format!("path, {what}"), &frame, &samples(&path), expected);
                    if name == "matt" {
                        let reach = AmbientOcclusionSettings { reach: f32::INFINITY };
                        let occlusion = AmbientOcclusion::new(&scene, reach, [4, 4], empty());
                        check(&format!("occlusion, {what}"), &frame, &samples(&occlusion), 1.0);
                    }
                    if name == "cut-out" {
                        let both = BidirectionalSettings::default();
                        let both = Bidirectional::new(&scene, both, [4, 4], empty());
                        check(&format!("bidirectional, {what}"), &frame, &samples(&both), 1.0);
                    }
                }
            }
        }
    }
}

#[test]
fn the_classic_integrator_sees_the_sky_in_flat_mirrors_and_no_shadow_on_flat_things() {
    for frame in frames() {
        for flat in FLATS {
            for view in VIEWS {
                let to_light = frame.direction([0.5, 0.2, -0.3]).normalize();
                let text = format!(
                    "{} Background {{ color 1 1 1 ambientLight 0 0 0 }}
                     Lights {{ DirectionalLight {{ direction {} color 1 1 1 }} }}
                     Materials {{ PhongMaterial m {{ diffuseColor 1 1 1 reflectiveColor 0.25 0.25 0.25 }} }}
                     Group {{ MaterialIndex m {} }}",
                    camera(&frame, view),
                    numbers(-to_light),
                    flat.text(&frame)
                );
                let scene = scene(flat, &frame, &text);
                let settings = ClassicSettings {
                    bounces: 2,
                    shadows: Shadows::Opaque,
                    shade_back: true,
                    ray_offset: RayOffset::Auto,
                    ..plain(&scene)
                };
                let classic = Classic::new(&scene, settings, [4, 4], LayerSet::of(&[]));
                let expected = to_light.dot(frame.axes[1]) as f32 + 0.25;
                check(&format!("classic, {flat:?} from {view:?}"), &frame, &samples(&classic), expected);
            }
        }
    }
}

/// A light in the plane and a small receiver above it, seen from between.
///
/// * `height`: of the receiver, where the light is some 4 wide
fn flat_lights_reach(height: f64) {
    for frame in frames() {
        for flat in FLATS {
            let Some(outline) = flat.outline(&frame) else { continue };
            let text = format!(
                "PerspectiveCamera {{ center {} direction {} up 0.31 0.82 0.2 angle 0.5 }}
                 Background {{ color 0 0 0 }} Lights {{ }}
                 Materials {{ Matte r {{ color 0.5 0.5 0.5 }} Matte m {{ color 0 0 0 emission 2 2 2 }} }}
                 Group {{ MaterialIndex m {} MaterialIndex r Quad {{ corner {} edge1 {} edge2 {} }} }}",
                frame.text([0.3, height - 1.0, 0.2]),
                numbers(frame.direction([-0.3, 1.0, -0.2]).normalize()),
                flat.text(&frame),
                frame.text([-0.5, height, -0.5]),
                numbers(frame.scale * frame.direction([1.0, 0.0, 0.0])),
                numbers(frame.scale * frame.direction([0.0, 0.0, 1.0])),
            );
            let scene = scene(flat, &frame, &text);
            let (from, n) = (frame.at([0.0, height, 0.0]), -frame.axes[1]);
            let expected = (2.0 * 0.5 / PI * polygon_irradiance(from, n, &outline).abs()) as f32;
            for technique in [Technique::Combined, Technique::Lights] {
                let settings = PathSettings { technique, bounces: 1, ..PathSettings::default() };
                let path = Path::new(&scene, settings, [1, 1], LayerSet::of(&[]));
                let found = mean(&path, 256);
                let what = format!("{technique:?}: {flat:?} lights {found} at {frame:?}");
                assert!((found / expected - 1.0).abs() < 0.04, "{what}, {expected} expected");
            }
        }
    }
}

#[test]
fn flat_lights_reach_what_they_face() {
    flat_lights_reach(1.5);
}

/// The rounding of a ray's end grows with its length.
#[test]
fn flat_lights_reach_far() {
    flat_lights_reach(300.0);
}

fn mean(integrator: &dyn PixelIntegrator, count: u32) -> f32 {
    let sampler = Sampler::new(SamplerKind::Sobol, count);
    let mut ctx = SampleContext::new(&sampler, 0);
    let sum: f32 = (0..count)
        .map(|k| {
            let offset = ctx.begin([0, 0], k);
            integrator.sample(&mut ctx, [0, 0], offset).radiance[0]
        })
        .sum();
    sum / count as f32
}
