//! Light between things that move at speeds not much below its own.
//!
//! What moves with one velocity rests in a frame of its own, and all of it stands in trees of its own there. Along a ray of light
//! back in time from the event `(t, x)`,
//!
//! ```text
//! t(s) = t - s |d|,    x(s) = x + s d
//! ```
//!
//! events are linear in `s`, and so they are in every frame, with the same `s`: the ray is mapped to each frame and tested there as
//! any other, and the least `s` of all frames is what light left first on its way back. So rays see what moves where it was when light
//! left it, and as it looked then. Frames have no bounds in the world, through all of which they move.
//!
//! Light is scattered in the frame of the surface, where nothing is new. What changes between frames is its frequency `ν`, and with it
//!
//! ```text
//! L(λ) λ^5 = const,    L dν-integrated / ν^4 = const,    dω ν^2 = const       at λ ν = c
//! ```
//!
//! for radiance per wavelength, radiance in all, and solid angles [Rybicki and Lightman 1979, 4.9].

use std::collections::HashMap;

use kajo_bvh::BuildSettings;
use kajo_color::{Spectrum, Wavelengths};
use kajo_math::lorentz::{FrameMap, SpacetimeEvent};
use kajo_math::{DAffine3, DVec3, Ray, Transform, Vec3};

use super::accel::Aggregate;
use super::{Geometry, Interaction, Scene};
use crate::ids::{FrameId, ObjectId};
use crate::interaction::SurfacePoint;
use crate::light::LightSampler;

/// By how much clocks of what moves may run slow: up to a speed of 0.9999995. Frequencies of light between two things that fly apart
/// then differ by less than 10^7, and their fifth powers remain numbers.
pub const MAX_GAMMA: f64 = 1000.0;

/// How a camera moves, and when its picture is taken.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CameraMotion {
    /// Its velocity in the world, as a fraction of the speed of light.
    pub velocity: DVec3,
    /// The moment of the world, in the time in which light goes one unit of length. Things have the places of the scene's text at the
    /// moment 0, the camera as well.
    pub time: f64,
}

/// An inertial frame, and what rests in it.
#[derive(Debug)]
pub struct RestFrame {
    from_world: FrameMap,
    to_world: FrameMap,
    /// Trees over its objects; the world's are those of the scene's geometry.
    trees: Option<Aggregate>,
    /// Its lights; those of the world are chosen by [`super::Lighting::sampler`].
    sampler: Option<LightSampler>,
}

impl RestFrame {
    /// The world's.
    pub(crate) fn world() -> RestFrame {
        let map = FrameMap::IDENTITY;
        RestFrame { from_world: map, to_world: map, trees: None, sampler: None }
    }

    /// The map from the world to it.
    pub fn from_world(&self) -> &FrameMap {
        &self.from_world
    }
}

impl Geometry {
    /// A frame with all that rests in it.
    ///
    /// * `stands`: whether an object does
    pub(crate) fn rest_frame(
        &self,
        from_world: FrameMap,
        stands: impl Fn(ObjectId) -> bool,
        sampler: LightSampler,
        settings: &BuildSettings,
    ) -> RestFrame {
        let trees = Some(self.frame_trees(stands, settings));
        RestFrame { from_world, to_world: from_world.inverse(), trees, sampler: Some(sampler) }
    }
}

/// All inertial frames of a scene.
#[derive(Debug)]
pub struct Relativity {
    /// The first one is the world's.
    frames: Vec<RestFrame>,
    /// Of the objects that do not rest in the world.
    objects: HashMap<ObjectId, FrameId>,
    /// The camera's observer.
    pub observer: CameraMotion,
}

/// Light that arrives at an event of a frame, followed back in time; see the head of this module.
#[derive(Clone, Copy, Debug)]
pub struct LightRay {
    /// Whose coordinates these are.
    pub frame: FrameId,
    /// Its places. The direction may have any length, which is the frequency that the light has in this frame over the one that it has
    /// where the parameter is a length.
    pub ray: Ray,
    /// The moment at its origin, in the time in which light goes one unit of length.
    pub t: f64,
}

impl LightRay {
    /// The moment at a parameter.
    ///
    /// * `eta`: index of refraction of what it goes through
    pub fn time_at(&self, s: f32, eta: f32) -> f64 {
        self.t - f64::from(s) * f64::from(eta) * self.ray.d.as_dvec3().length()
    }
}

impl Relativity {
    pub(crate) fn new(
        frames: Vec<RestFrame>,
        objects: impl Iterator<Item = (ObjectId, FrameId)>,
        observer: CameraMotion,
    ) -> Relativity {
        Relativity { frames, objects: objects.collect(), observer }
    }

    /// All frames, the world's first.
    pub fn ids(&self) -> impl Iterator<Item = FrameId> + use<> {
        (0..self.frames.len()).filter_map(FrameId::new)
    }

    /// A frame by its name.
    pub fn frame(&self, id: FrameId) -> &RestFrame {
        &self.frames[id.index()]
    }

    /// The frame that an object rests in.
    pub fn frame_of(&self, object: ObjectId) -> FrameId {
        self.objects.get(&object).copied().unwrap_or_default()
    }

    /// What takes the coordinates of an object's frame to the world's at its moment 0, where what moves is contracted; `None` for what
    /// rests in the world.
    pub fn snapshot(&self, object: ObjectId) -> Option<DAffine3> {
        let frame = self.frame_of(object);
        (frame != FrameId::WORLD).then(|| self.frame(frame).from_world.snapshot(0.0))
    }

    /// The coordinates in one frame of an event of another.
    pub fn event(&self, event: SpacetimeEvent, from: FrameId, to: FrameId) -> SpacetimeEvent {
        if from == to {
            return event;
        }
        self.frame(to).from_world.event(self.frame(from).to_world.event(event))
    }

    /// The direction in one frame of light that in another arrives from `d`, times the ratio of its frequencies; see
    /// [`FrameMap::light`].
    pub fn light(&self, d: DVec3, from: FrameId, to: FrameId) -> DVec3 {
        if from == to {
            return d;
        }
        self.frame(to).from_world.light(self.frame(from).to_world.light(d))
    }

    /// The same ray of light in another frame, with the same parameter.
    pub fn ray(&self, light: &LightRay, to: FrameId) -> LightRay {
        if light.frame == to {
            return *light;
        }
        let start = self.event(SpacetimeEvent { t: light.t, x: light.ray.o.as_dvec3() }, light.frame, to);
        let d = self.light(light.ray.d.as_dvec3(), light.frame, to);
        LightRay { frame: to, ray: Ray { o: start.x.as_vec3(), d: d.as_vec3(), ..light.ray }, t: start.t }
    }

    /// A ray that a camera at rest in the world would cast, as that of the observer, in the world: what the observer's motion makes of
    /// its direction, and of the places beside `pivot` where rays of a lens or of two eyes begin. The frequency there over that which
    /// the observer sees is the length of its direction.
    ///
    /// * `pivot`: the camera's own place at the moment 0 of the world
    pub fn observed(&self, ray: &Ray, pivot: Vec3) -> LightRay {
        let CameraMotion { velocity, time } = self.observer;
        let pivot = pivot.as_dvec3();
        let start = SpacetimeEvent { t: 0.0, x: pivot };
        let map = FrameMap::boost(velocity, start).unwrap_or(FrameMap::IDENTITY);
        let back = map.inverse();
        // All rays begin at one moment of the camera's own time, when it is `time` in the world at its own place.
        let event = back.event(SpacetimeEvent { t: time / map.gamma(), x: ray.o.as_dvec3() });
        let d = back.light(ray.d.as_dvec3());
        let ray = Ray { o: event.x.as_vec3(), d: d.as_vec3(), ..*ray };
        LightRay { frame: FrameId::WORLD, ray, t: event.t }
    }
}

impl Scene {
    /// The lights of a frame.
    pub fn lights_of(&self, frame: FrameId) -> &LightSampler {
        let own = self.relativity.as_ref().and_then(|all| all.frame(frame).sampler.as_ref());
        own.unwrap_or(&self.lighting.sampler)
    }

    /// Whether anything gives light, at rest or not.
    pub fn has_lights(&self) -> bool {
        let moving = self
            .relativity
            .iter()
            .flat_map(|all| all.frames.iter().filter_map(|frame| frame.sampler.as_ref()));
        !self.lighting.sampler.is_empty()
            || moving.into_iter().any(|sampler| !sampler.is_empty())
            || self.appearance.has_emissive_media()
    }

    fn trees_of<'a>(&'a self, all: &'a Relativity, frame: FrameId) -> &'a Aggregate {
        all.frame(frame).trees.as_ref().unwrap_or(&self.geometry.aggregate)
    }

    /// Follows light back in time to the surface that it left last, and writes that to `at`, in the frame of that surface.
    ///
    /// Returns the ray in that frame, or `None` where it came from outside of the scene. `at.hit.t` is the parameter.
    ///
    /// * `only`: the frame in which alone it is followed, as inside of a body where light is slower
    pub fn trace_light(
        &self,
        all: &Relativity,
        light: &LightRay,
        only: Option<FrameId>,
        at: &mut Interaction,
    ) -> Option<LightRay> {
        let (mut found, mut t_max) = (None, light.ray.t_max);
        let mut nearest = Interaction::default();
        for frame in all.ids().filter(|&frame| only.is_none_or(|only| only == frame)) {
            let mut own = all.ray(light, frame);
            own.ray.t_max = t_max;
            if self.closest_within_tree(self.trees_of(all, frame), &own.ray, &mut nearest) {
                t_max = nearest.hit.t;
                (*at, found) = (nearest, Some(own));
            }
        }
        let found = found?;
        self.complete(&found.ray, at);
        Some(found)
    }

    /// What is met along a ray through the world as it is at its moment 0, where what moves is contracted: not what an observer sees, but where
    /// things are, for editors.
    ///
    /// Returns it in the frame in which it rests, with its position and normals in the world.
    pub fn trace_snapshot(&self, ray: &Ray) -> Option<(Interaction, SurfacePoint)> {
        let Some(all) = self.relativity.as_deref() else {
            return self.trace(ray).surface().map(|at| (*at, at.point));
        };
        let (mut found, mut t_max) = (None, ray.t_max);
        for frame in all.ids() {
            let map = Transform::of_invertible(&all.frame(frame).from_world.snapshot(0.0));
            let own = map.ray_in_object(&ray.over(ray.t_min, t_max));
            let mut at = Interaction::default();
            if self.closest_within_tree(self.trees_of(all, frame), &own, &mut at) {
                self.complete(&own, &mut at);
                t_max = at.hit.t;
                let point = if map.is_identity() { at.point } else { at.point.transformed(&map) };
                found = Some((at, point));
            }
        }
        found
    }

    /// The map of an object that is no nested one to the world, at a moment of the shutter, or of what moves with a velocity at the moment
    /// 0 of the world.
    pub fn snapshot_transform(&self, object: ObjectId, time: f32) -> Option<Transform> {
        let place = self.geometry.transform_of(self.geometry.primitives.get(object.index())?, time);
        let now = self.relativity.as_ref().and_then(|all| all.snapshot(object));
        let Some(now) = now.map(|now| Transform::of_invertible(&now)) else { return Some(place) };
        Some(Transform {
            world_from_object: now.world_from_object * place.world_from_object,
            object_from_world: place.object_from_world * now.object_from_world,
        })
    }

    /// The share of light that comes along a segment, as [`Scene::transmittance`], past what rests in any frame.
    ///
    /// * `segment`: the segment in each frame, with the same parameter
    /// * `wavelengths`: of the light there
    pub fn light_transmittance(
        &self,
        all: &Relativity,
        segment: impl Fn(FrameId) -> Ray,
        wavelengths: impl Fn(FrameId) -> Wavelengths,
    ) -> Spectrum {
        let mut passed = Spectrum::WHITE;
        for frame in all.ids() {
            let (trees, segment) = (self.trees_of(all, frame), segment(frame));
            let blocked = if self.appearance.has_passages {
                let wavelengths = wavelengths(frame);
                self.occluded_within_or(trees, &segment, |object, hit| {
                    let at = self.interaction(&segment, object, hit);
                    passed *= self.passage(&at, 1.0, &wavelengths, at.crossing_cosine(segment.d));
                    passed.is_black()
                })
            } else {
                self.occluded_within(trees, &segment)
            };
            if blocked {
                return Spectrum::BLACK;
            }
        }
        passed
    }
}
