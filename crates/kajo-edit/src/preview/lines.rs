//! Lights, the camera, and what set operations take away, as wires.

use std::collections::HashMap;
use std::f32::consts::TAU;

use kajo_color::Emission;
use kajo_core::light::{LightId, LightOutline};
use kajo_core::scene::Scene;
use kajo_core::shape::{Csg, Tessellation};
use kajo_core::{ObjectId, Pooled};
use kajo_math::{Aabb, DVec2, Frame, Vec3, fmath};

use kajo::CameraPose;

/// Sizes of markers as shares of the scene's diagonal.
const STAR: f32 = 0.015;
const CONE: f32 = 0.15;
const FRUSTUM: f32 = 0.08;

/// Segments of a circle.
const AROUND: u32 = 24;

/// Segments around what is taken away.
const AROUND_SUBTRACTED: u32 = 24;

/// Lines of what is taken away beyond which no more are drawn.
const MOST_SUBTRACTED: usize = 30_000;

/// Faces that are less inclined to each other than by this cosine show no edge.
const EVEN: f32 = 0.995;

/// Lights beyond which no more are drawn.
const MOST_LIGHTS: usize = 1000;

/// What a line belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineKind {
    /// A light: its place in the order of the file, from 0.
    Light(u32),
    /// The scene's own camera.
    Camera,
    /// What a set operation takes away: the number of its item among those of the text.
    Subtracted(u32),
}

impl LineKind {
    /// The item of what is taken away, if it is that.
    pub fn subtracted(self) -> Option<u32> {
        match self {
            LineKind::Subtracted(item) => Some(item),
            LineKind::Light(_) | LineKind::Camera => None,
        }
    }
}

/// Part of a wire.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// What it belongs to.
    pub kind: LineKind,
    /// Ends, in world space.
    pub ends: [[f32; 3]; 2],
    /// Colour, encoded in sRGB, and 255.
    pub color: [u8; 4],
}

/// The wires of a scene.
pub(super) fn of(scene: &Scene, bounds: &Aabb) -> Vec<Line> {
    let mut wires = Wires { lines: Vec::new(), bounds: *bounds, size: bounds.extent().length().max(1e-6) };
    for (number, &id) in (0..).zip(scene.lighting.list.iter().take(MOST_LIGHTS)) {
        wires.light(scene, number, id);
    }
    wires.camera(&CameraPose::of(scene));
    wires.subtracted(scene);
    wires.lines
}

struct Wires {
    lines: Vec<Line>,
    bounds: Aabb,
    /// The scene's diagonal.
    size: f32,
}

impl Wires {
    fn add(&mut self, kind: LineKind, color: [u8; 4], from: Vec3, to: Vec3) {
        self.lines.push(Line { kind, ends: [from.to_array(), to.to_array()], color });
    }

    fn light(&mut self, scene: &Scene, number: u32, id: LightId) {
        let kind = LineKind::Light(number);
        let lights = &scene.lighting.lights;
        let color = hue(lights.emission(id).map_or([1.0; 3], Emission::rgb));
        match lights.outline(id) {
            LightOutline::None => {}
            LightOutline::Star(p) => self.star(kind, color, p),
            LightOutline::Cone { apex, axis, cosines } => {
                self.star(kind, color, apex);
                for cosine in cosines {
                    self.cone(kind, color, apex, axis, cosine);
                }
            }
            LightOutline::Direction(to_light) => self.sun(kind, color, to_light),
        }
    }

    fn star(&mut self, kind: LineKind, color: [u8; 4], p: Vec3) {
        let diagonal = STAR * 0.577;
        let rays = [
            STAR * Vec3::X,
            STAR * Vec3::Y,
            STAR * Vec3::Z,
            diagonal * Vec3::ONE,
            diagonal * Vec3::new(1.0, 1.0, -1.0),
            diagonal * Vec3::new(1.0, -1.0, 1.0),
            diagonal * Vec3::new(-1.0, 1.0, 1.0),
        ];
        for ray in rays.map(|ray| self.size * ray) {
            self.add(kind, color, p - ray, p + ray);
        }
    }

    /// The rim of a cone of light and four lines to it.
    fn cone(&mut self, kind: LineKind, color: [u8; 4], apex: Vec3, axis: Vec3, cosine: f32) {
        let frame = Frame::from_normal(axis);
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let rim = |i: u32| {
            let (s, c) = fmath::sin_cos(TAU * i as f32 / AROUND as f32);
            apex + CONE * self.size * frame.to_world(Vec3::new(sine * c, sine * s, cosine))
        };
        let rim: Vec<Vec3> = (0..=AROUND).map(rim).collect();
        for pair in rim.windows(2) {
            self.add(kind, color, pair[0], pair[1]);
        }
        for i in 0..4 {
            self.add(kind, color, apex, rim[i * AROUND as usize / 4]);
        }
    }

    /// Parallel arrows from outside of the scene towards its middle.
    fn sun(&mut self, kind: LineKind, color: [u8; 4], to_light: Vec3) {
        let frame = Frame::from_normal(to_light);
        let tip = self.bounds.center() + 0.6 * self.size * to_light;
        let tail = 0.15 * self.size * to_light;
        for i in 0..4 {
            let (s, c) = fmath::sin_cos(TAU * i as f32 / 4.0);
            let beside = 0.03 * self.size * frame.to_world(Vec3::new(c, s, 0.0));
            self.add(kind, color, tip + tail + beside, tip + beside);
            self.add(kind, color, tip + beside, tip + 0.5 * beside + 0.2 * tail);
        }
    }

    /// The edges of what set operations take away.
    fn subtracted(&mut self, scene: &Scene) {
        const GREY: [u8; 4] = [170, 170, 185, 255];
        let most = self.lines.len() + MOST_SUBTRACTED;
        for (index, primitive) in (0..).zip(&scene.geometry.primitives) {
            let Some(csg) = Csg::find(&scene.geometry.shapes, primitive.shape) else { continue };
            let Some(place) = scene.snapshot_transform(ObjectId::from_index(index), 0.0) else { continue };
            for (item, triangles) in csg.subtracted(AROUND_SUBTRACTED) {
                for [a, b] in edges(&triangles) {
                    self.add(LineKind::Subtracted(item), GREY, place.point(a), place.point(b));
                }
                if self.lines.len() > most {
                    return;
                }
            }
        }
    }

    /// The corners of what the camera sees, a little way from it.
    fn camera(&mut self, pose: &CameraPose) {
        const GREY: [u8; 4] = [190, 190, 190, 255];
        const SIZE: [u32; 2] = [4, 3];
        let flat = pose.flat();
        let depth = FRUSTUM * self.size;
        let eye = flat.eye().as_vec3();
        let corner = |x: f64, y: f64| {
            let ray = flat.ray(DVec2::new(x, y), SIZE)?;
            let forward = ray.d.dot(flat.forward().as_vec3());
            Some([ray.o, ray.o + depth / forward.max(1e-3) * ray.d])
        };
        let corners = [corner(0.0, 0.0), corner(4.0, 0.0), corner(4.0, 3.0), corner(0.0, 3.0)];
        let [Some(a), Some(b), Some(c), Some(d)] = corners else { return };
        for (from, to) in [(a, b), (b, c), (c, d), (d, a)] {
            self.add(LineKind::Camera, GREY, from[0], from[1]);
            self.add(LineKind::Camera, GREY, from[1], to[1]);
        }
        // A mark on top, so that one sees which way is up.
        let roof = 0.5 * (a[1] + b[1]) + 0.3 * (a[1] - d[1]);
        self.add(LineKind::Camera, GREY, a[1], roof);
        self.add(LineKind::Camera, GREY, b[1], roof);
        self.add(LineKind::Camera, GREY, eye, eye + 0.5 * depth * flat.forward().as_vec3());
    }
}

/// The edges of triangles: those along which the surface turns or ends.
fn edges(triangles: &Tessellation) -> Vec<[Vec3; 2]> {
    /// A corner is the same whatever triangle it is of, but for rounding.
    const GRID: f32 = 4096.0;
    let bounds = Aabb::around(triangles.positions.iter().copied());
    let scale = GRID / bounds.extent().max_element().max(f32::MIN_POSITIVE);
    let corner = |i: u32| triangles.positions[i as usize];
    let key = |p: Vec3| ((p - bounds.min) * scale).round().as_ivec3();
    let mut found: HashMap<[[i32; 3]; 2], (Vec3, bool)> = HashMap::new();
    let mut order = Vec::new();
    for &[a, b, c] in &triangles.faces {
        let [a, b, c] = [a, b, c].map(corner);
        let n = (b - a).cross(c - a).normalize_or_zero();
        for [from, to] in [[a, b], [b, c], [c, a]] {
            let mut ends = [from, to].map(|p| key(p).to_array());
            if n == Vec3::ZERO || ends[0] == ends[1] {
                continue;
            }
            ends.sort_unstable();
            match found.get_mut(&ends) {
                Some((other, is_edge)) => *is_edge = other.dot(n) < EVEN,
                None => {
                    found.insert(ends, (n, true));
                    order.push((ends, [from, to]));
                }
            }
        }
    }
    order.into_iter().filter(|(ends, _)| found[ends].1).map(|(_, line)| line).collect()
}

/// The colour of a light, as bright as it can be.
fn hue(rgb: [f32; 3]) -> [u8; 4] {
    let rgb = rgb.map(|v| v.max(0.0));
    let most = rgb.iter().copied().fold(0.0, f32::max);
    let share = |v: f32| if most > 0.0 { (80.0 + 175.0 * v / most) as u8 } else { 255 };
    [share(rgb[0]), share(rgb[1]), share(rgb[2]), 255]
}
