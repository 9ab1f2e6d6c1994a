//! What becomes of one camera ray: every ray that follows from it, what that met, and the light it found.
//!
//! Integrators tell a `PathObserver` what they do. Where pictures are made that is `Counting`, which counts rays
//! and lets everything else be compiled away; a [`Trail`] keeps it all. The same code runs in both cases, and
//!
//! ```text
//! radiance of the sample = sum over all segments of their contributions
//! ```

use kajo_core::LightIndex;
use kajo_core::curved_light::ConservedQuantity;
use kajo_core::light::{LightId, Receiver};
use kajo_core::scene::{Interaction, RayEvent, Scene};
use kajo_math::{Ray, Vec3};

use crate::RayCounters;
use crate::context::{Interrupt, RAYS_PER_CHECK, SampleContext};
use crate::integrator::PathState;

/// Segments beyond which no more are kept.
const MOST_SEGMENTS: usize = 100_000;

/// What a ray is cast for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayKind {
    /// From the camera.
    Camera,
    /// Mirrored at a surface.
    Reflected,
    /// Through a surface.
    Transmitted,
    /// Into a random direction from a surface that is no mirror.
    Scattered,
    /// Towards a light, or to find out whether anything is near.
    Shadow,
    /// From a light.
    Light,
    /// Between a point of a path from the camera and one of a path from a light.
    Connection,
    /// From a path from an emitter to the lens. Its light goes to the pixel where that is seen, and is no part of the
    /// sample.
    Splat,
}

/// Where a ray ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrailHit {
    /// Number of the object in the id layers, counted from 1.
    pub object: u32,
    /// Number of the material in the id layers, counted from 1; 0 for one that came with a mesh.
    pub material: u32,
    /// World-space point.
    pub p: Vec3,
    /// Unit shading normal, outward.
    pub n: Vec3,
    /// Unit geometric normal, outward.
    pub ng: Vec3,
}

/// What a light belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightSource {
    /// A light of the file: its place in their order, from 0.
    Listed(u32),
    /// An emissive object: its number in the id layers, counted from 1.
    Object(u32),
    /// The background.
    Background,
}

impl LightSource {
    fn of(scene: &Scene, id: LightId) -> Option<LightSource> {
        let lights = &scene.lighting.lights;
        if let Some(object) = lights.object(id) {
            return Some(LightSource::Object(object.number()));
        }
        if lights.is_background(id) {
            return Some(LightSource::Background);
        }
        scene.lighting.list.iter().position(|&listed| listed == id).map(|at| LightSource::Listed(at as u32))
    }
}

/// One ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// What it was cast for.
    pub kind: RayKind,
    /// Index of the segment at whose end it starts; `None` for those from the camera and from a light.
    pub parent: Option<u32>,
    /// How many segments lie before it.
    pub depth: u32,
    /// World-space origin.
    pub from: Vec3,
    /// World-space unit direction.
    pub d: Vec3,
    /// Distance to where it ends: at a surface, or at a light; infinite for one that leaves the scene.
    pub distance: f32,
    /// The surface that it met; for a ray that joins two points what is in the way.
    pub hit: Option<TrailHit>,
    /// The light that a shadow ray is cast to; `None` for all other rays.
    pub light: Option<LightSource>,
    /// Index of refraction of what it travels through.
    pub eta: f32,
    /// Throughput from its far end to the sensor, linear RGB.
    pub weight: [f32; 3],
    /// What it adds to the sample itself, beside what the segments after it do: light of the surface or the
    /// background at its end, of the light that a shadow ray reaches, of fog along it. Linear RGB.
    pub contribution: [f32; 3],
    /// What should be the same where the curve began whose last chord this is, and at its end; nothing for straight rays.
    pub conserved: [Option<ConservedQuantity>; 3],
}

/// An observer of the rays of a sample.
pub(crate) trait PathObserver: Default {
    /// A position in the tree of rays.
    type Mark: Copy + 'static;

    /// The counters of rays.
    fn counters(&mut self) -> &mut RayCounters;

    /// Whether the sample is to be given up: asked wherever a path forks, since the rays of a sample may then be
    /// very many.
    fn interrupted(&mut self) -> bool {
        false
    }

    /// A ray of this kind comes next.
    fn next(&mut self, _kind: RayKind) {}

    /// The straight ray of a path, which is at its start, goes through what is around there for this length, if it comes to the next
    /// surface.
    fn traced(&mut self, _scene: &Scene, _path: &PathState<'_>, _extent: f32) {}

    /// Records the ray announced last with its end; it becomes the current ray, the parent of those that follow.
    fn ended(
        &mut self,
        _scene: &Scene,
        _ray: &Ray,
        _end: Option<&Interaction>,
        _about: impl FnOnce() -> About,
    ) {
    }

    /// Records one chord of a curved ray, which goes on behind it.
    fn bent(&mut self, _scene: &Scene, _chord: &Ray, _about: impl FnOnce() -> About) {}

    /// The chord that is recorded next is the last one of a curve along which these are kept.
    fn keeps(&mut self, _conserved: impl FnOnce() -> [Option<ConservedQuantity>; 3]) {}

    /// The current ray finds light.
    fn found(&mut self, _light: impl FnOnce() -> [f32; 3]) {}

    /// The current ray meets light of an emitter: of a surface, of a medium, or from infinitely far away.
    fn emitter_met(&mut self, light: impl FnOnce() -> [f32; 3]) {
        self.found(light);
    }

    /// Records a ray from the end of the current one to a known point, with the light that it adds.
    fn joined(
        &mut self,
        _kind: RayKind,
        _scene: &Scene,
        _ray: &Ray,
        _about: impl FnOnce() -> About,
        _light: impl FnOnce() -> [f32; 3],
    ) {
    }

    /// A light was drawn for a receiver that might scatter what it sends.
    fn light_drawn(&mut self, _to: &Receiver, _light: LightIndex, _arrives: impl FnOnce() -> bool) {}

    /// The sample is this in place of the light found.
    fn shown_instead(&mut self, _light: impl FnOnce() -> [f32; 3]) {}

    /// All weights and light reported from here on are to be multiplied by this.
    fn weaken(&mut self, _factor: impl FnOnce() -> [f32; 3]) {}

    /// The current ray.
    fn mark(&self) -> Self::Mark;

    /// Makes an earlier ray the current one again, with its factor: a branch is taken up.
    fn back_to(&mut self, mark: Self::Mark);

    /// Notes the current ray.
    fn note(&mut self) {}

    /// Makes the noted ray of this number, from 0, the current one.
    fn back_to_noted(&mut self, _number: u32) {}
}

/// What an integrator reports of a ray beside its geometry.
pub(crate) struct About {
    pub eta: f32,
    pub weight: [f32; 3],
    /// The light that the ray is cast to.
    pub light: Option<LightId>,
}

/// Counts the rays of a sample, notes what is seen of emitters, and may give it up.
#[derive(Clone, Copy, Default)]
pub(crate) struct Counting<'a> {
    /// Rays of the thread so far.
    pub rays: RayCounters,
    interrupt: Option<&'a Interrupt<'a>>,
    /// How many rays there were when the interrupt was last asked.
    asked: u64,
    /// Whether the ray at hand was scattered, or comes from a light.
    is_scattered: bool,
    /// Light of emitters that was met by rays which were not, linear RGB.
    pub seen: [f32; 3],
}

impl<'a> Counting<'a> {
    /// Goes on with the counters of a context.
    pub fn new(ctx: &SampleContext<'a>) -> Counting<'a> {
        let asked = ctx.rays.total();
        Counting { rays: ctx.rays, interrupt: ctx.interrupt, asked, ..Counting::default() }
    }
}

impl PathObserver for Counting<'_> {
    /// Whether the ray was scattered.
    type Mark = bool;

    #[inline]
    fn counters(&mut self) -> &mut RayCounters {
        &mut self.rays
    }

    fn interrupted(&mut self) -> bool {
        let Some(interrupt) = self.interrupt else { return false };
        if self.rays.total() - self.asked >= RAYS_PER_CHECK {
            self.asked = self.rays.total();
            interrupt.ask();
        }
        interrupt.is_raised()
    }

    #[inline]
    fn next(&mut self, kind: RayKind) {
        self.is_scattered = match kind {
            RayKind::Camera => false,
            RayKind::Reflected | RayKind::Transmitted => self.is_scattered,
            RayKind::Scattered | RayKind::Shadow | RayKind::Light | RayKind::Connection | RayKind::Splat => {
                true
            }
        };
    }

    #[inline]
    fn emitter_met(&mut self, light: impl FnOnce() -> [f32; 3]) {
        if !self.is_scattered {
            let light = light();
            self.seen = [0, 1, 2].map(|c| self.seen[c] + light[c]);
        }
    }

    #[inline]
    fn mark(&self) -> bool {
        self.is_scattered
    }

    #[inline]
    fn back_to(&mut self, is_scattered: bool) {
        self.is_scattered = is_scattered;
    }
}

/// All rays of one sample, each after the one that it starts from.
#[derive(Clone, Debug, Default)]
pub struct Trail {
    segments: Vec<Segment>,
    left_out: usize,
    counters: RayCounters,
    position: TreePosition,
    noted: Vec<TreePosition>,
    next: Option<RayKind>,
    /// Of the next segment.
    conserved: [Option<ConservedQuantity>; 3],
}

/// A position in the tree of rays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TreePosition {
    /// The current ray.
    segment: Option<u32>,
    /// Of all light that is found there.
    factor: [f32; 3],
}

impl Default for TreePosition {
    fn default() -> TreePosition {
        TreePosition { segment: None, factor: [1.0; 3] }
    }
}

impl Trail {
    /// The rays.
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// How many more there were than are kept.
    pub fn left_out(&self) -> usize {
        self.left_out
    }

    /// Rays by kind.
    pub fn counters(&self) -> RayCounters {
        self.counters
    }

    fn push(
        &mut self,
        kind: RayKind,
        scene: &Scene,
        ray: &Ray,
        hit: Option<(TrailHit, f32)>,
        about: About,
    ) -> Option<u32> {
        let TreePosition { segment: parent, factor } = self.position;
        let length = ray.d.length();
        let segment = Segment {
            kind,
            parent,
            depth: parent.map_or(0, |parent| self.segments[parent as usize].depth + 1),
            from: ray.o,
            d: ray.d / length,
            distance: hit.map_or(ray.t_max, |(_, t)| t) * length,
            hit: hit.map(|(hit, _)| hit),
            light: about.light.and_then(|id| LightSource::of(scene, id)),
            eta: about.eta,
            weight: product(factor, about.weight),
            contribution: [0.0; 3],
            conserved: std::mem::take(&mut self.conserved),
        };
        if self.segments.len() == MOST_SEGMENTS {
            self.left_out += 1;
            return None;
        }
        self.segments.push(segment);
        Some(self.segments.len() as u32 - 1)
    }

    fn add(&mut self, segment: Option<u32>, light: [f32; 3]) {
        if let Some(segment) = segment {
            let light = product(self.position.factor, light);
            let sum = &mut self.segments[segment as usize].contribution;
            sum.iter_mut().zip(light).for_each(|(sum, light)| *sum += light);
        }
    }
}

impl PathObserver for Trail {
    type Mark = TreePosition;

    fn counters(&mut self) -> &mut RayCounters {
        &mut self.counters
    }

    fn next(&mut self, kind: RayKind) {
        self.next = Some(kind);
    }

    fn ended(&mut self, scene: &Scene, ray: &Ray, end: Option<&Interaction>, about: impl FnOnce() -> About) {
        let kind = self.next.take().unwrap_or(RayKind::Camera);
        let hit = end.map(|at| (TrailHit::of(scene, at), at.hit.t));
        self.position.segment = self.push(kind, scene, ray, hit, about()).or(self.position.segment);
    }

    fn bent(&mut self, scene: &Scene, piece: &Ray, about: impl FnOnce() -> About) {
        if piece.d == Vec3::ZERO {
            return;
        }
        let kind = *self.next.get_or_insert(RayKind::Camera);
        self.position.segment = self.push(kind, scene, piece, None, about()).or(self.position.segment);
    }

    fn keeps(&mut self, conserved: impl FnOnce() -> [Option<ConservedQuantity>; 3]) {
        self.conserved = conserved();
    }

    fn found(&mut self, light: impl FnOnce() -> [f32; 3]) {
        self.add(self.position.segment, light());
    }

    fn joined(
        &mut self,
        kind: RayKind,
        scene: &Scene,
        ray: &Ray,
        about: impl FnOnce() -> About,
        light: impl FnOnce() -> [f32; 3],
    ) {
        let light = light();
        let in_the_way = match scene.trace(ray) {
            RayEvent::Surface(at) if light == [0.0; 3] => Some((TrailHit::of(scene, &at), at.hit.t)),
            _ => None,
        };
        let segment = self.push(kind, scene, ray, in_the_way, about()).or(self.position.segment);
        self.add(segment, light);
    }

    fn shown_instead(&mut self, light: impl FnOnce() -> [f32; 3]) {
        self.segments.iter_mut().for_each(|segment| segment.contribution = [0.0; 3]);
        if let Some(first) = self.segments.first_mut() {
            first.contribution = light();
        }
    }

    fn weaken(&mut self, factor: impl FnOnce() -> [f32; 3]) {
        self.position.factor = product(self.position.factor, factor());
    }

    fn mark(&self) -> TreePosition {
        self.position
    }

    fn back_to(&mut self, mark: TreePosition) {
        self.position = mark;
    }

    fn note(&mut self) {
        self.noted.push(self.position);
    }

    fn back_to_noted(&mut self, number: u32) {
        self.position = self.noted.get(number as usize).copied().unwrap_or_default();
    }
}

fn product(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

impl TrailHit {
    fn of(scene: &Scene, at: &Interaction) -> TrailHit {
        let material = scene.appearance.number(at.material);
        TrailHit { object: at.object.number(), material, p: at.point.p, n: at.point.n, ng: at.point.ng }
    }
}

#[cfg(test)]
mod tests {
    use kajo_core::builder::SceneBuilder;
    use kajo_core::camera::{CameraFrame, PerspectiveCamera};
    use kajo_core::settings::Settings;
    use kajo_math::DVec3;

    use super::*;

    fn nothing() -> Scene {
        let mut scene = SceneBuilder::default();
        let frame = CameraFrame::new(9.0 * DVec3::Z, DVec3::NEG_Z, DVec3::Y);
        scene.camera(PerspectiveCamera::new(frame, 0.5)).expect("a camera");
        scene.finish(Settings::default()).expect("a scene")
    }

    fn about() -> About {
        About { eta: 1.5, weight: [0.5, 1.0, 2.0], light: None }
    }

    #[test]
    fn a_tree_of_rays_is_kept_with_the_factors_of_its_forks() {
        let scene = nothing();
        let ray = Ray::new(Vec3::ZERO, 2.0 * Vec3::Z).over(0.0, 3.0);
        let mut trail = Trail::default();
        trail.ended(&scene, &ray, None, about);
        let fork = trail.mark();
        trail.weaken(|| [0.5; 3]);
        trail.next(RayKind::Reflected);
        trail.ended(&scene, &ray, None, about);
        trail.found(|| [1.0, 2.0, 3.0]);
        trail.back_to(fork);
        trail.next(RayKind::Transmitted);
        trail.ended(&scene, &ray, None, about);
        trail.joined(RayKind::Shadow, &scene, &ray, about, || [1.0; 3]);
        let [camera, mirrored, through, shadow] = trail.segments() else { panic!("{trail:?}") };
        assert_eq!((camera.kind, camera.parent, camera.depth), (RayKind::Camera, None, 0));
        assert_eq!((camera.d, camera.distance, camera.eta), (Vec3::Z, 6.0, 1.5));
        assert_eq!((mirrored.kind, mirrored.parent, mirrored.depth), (RayKind::Reflected, Some(0), 1));
        assert_eq!((mirrored.weight, mirrored.contribution), ([0.25, 0.5, 1.0], [0.5, 1.0, 1.5]));
        assert_eq!(
            (through.kind, through.parent, through.weight),
            (RayKind::Transmitted, Some(0), about().weight)
        );
        assert_eq!((shadow.parent, shadow.depth, shadow.contribution), (Some(2), 2, [1.0; 3]));
    }

    /// A thousand bounces that fork each time are no reason to run out of memory; their light is not lost.
    #[test]
    fn what_is_too_much_is_counted() {
        let scene = nothing();
        let ray = Ray::new(Vec3::ZERO, Vec3::Z);
        let mut trail = Trail::default();
        for _ in 0..MOST_SEGMENTS + 7 {
            trail.ended(&scene, &ray, None, about);
            trail.found(|| [1.0; 3]);
        }
        assert_eq!((trail.segments().len(), trail.left_out()), (MOST_SEGMENTS, 7));
        let sum: f32 = trail.segments().iter().map(|segment| segment.contribution[0]).sum();
        assert_eq!(sum, (MOST_SEGMENTS + 7) as f32);
    }
}
