//! The inertial frames of a scene that is being put together.

use std::collections::HashMap;

use kajo_bvh::BuildSettings;
use kajo_math::DVec3;
use kajo_math::lorentz::{FrameMap, SpacetimeEvent};

use super::{SceneBuilder, SceneError, check_finite};
use crate::ids::{FrameId, LightIndex, ObjectId};
use crate::light::LightSampler;
use crate::scene::{CameraMotion, Geometry, MAX_GAMMA, Relativity, RestFrame};

/// Where things rest that are put into the scene next.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rest {
    /// Their frame.
    pub frame: FrameId,
    /// The moment of that frame which counts as 0 for what moves in it.
    pub epoch: f64,
}

/// Frames, and what rests in which.
#[derive(Debug, Default)]
pub(super) struct Frames {
    /// The maps from the world to all frames but the world's own.
    others: Vec<FrameMap>,
    /// Where things rest from now on.
    rest: Rest,
    /// Of the objects that do not rest in the world.
    objects: HashMap<ObjectId, FrameId>,
    /// Of the lights that do not.
    lights: HashMap<LightIndex, FrameId>,
    observer: CameraMotion,
}

impl Frames {
    pub fn add_object(&mut self, object: ObjectId) {
        if self.rest.frame != FrameId::WORLD {
            self.objects.insert(object, self.rest.frame);
        }
    }

    pub fn add_light(&mut self, light: LightIndex) {
        if self.rest.frame != FrameId::WORLD {
            self.lights.insert(light, self.rest.frame);
        }
    }

    /// Whether everything rests in the world.
    pub fn has_one(&self) -> bool {
        self.others.is_empty()
    }

    pub fn ids(&self) -> impl Iterator<Item = FrameId> {
        (0..=self.others.len()).filter_map(FrameId::new)
    }

    /// The frame of an object.
    pub fn of_object(&self, object: ObjectId) -> FrameId {
        self.objects.get(&object).copied().unwrap_or_default()
    }

    /// The frame of a light of the file.
    pub fn of_light(&self, light: LightIndex) -> FrameId {
        self.lights.get(&light).copied().unwrap_or_default()
    }

    fn map(&self, frame: FrameId) -> FrameMap {
        let other = frame.index().checked_sub(1).and_then(|i| self.others.get(i));
        other.copied().unwrap_or(FrameMap::IDENTITY)
    }

    /// The frame of a map, and what the map's places and times are less those of the frame.
    fn frame_of(&mut self, map: FrameMap) -> Result<(FrameId, SpacetimeEvent), SceneError> {
        let known = self.ids().find_map(|id| Some((id, map.offset(&self.map(id))?)));
        if let Some(found) = known {
            return Ok(found);
        }
        let id = FrameId::new(self.others.len() + 1).ok_or(SceneError::TooManyFrames)?;
        self.others.push(map);
        Ok((id, SpacetimeEvent { t: 0.0, x: DVec3::ZERO }))
    }

    /// What rays have to know; `None` where everything and the observer rest in the world.
    ///
    /// * `samplers`: of the lights in all frames but the world's
    pub fn finish(
        self,
        geometry: &Geometry,
        samplers: Vec<LightSampler>,
        settings: &BuildSettings,
    ) -> Option<Box<Relativity>> {
        if self.has_one() && self.observer.velocity == DVec3::ZERO {
            return None;
        }
        let mut frames = vec![RestFrame::world()];
        for (id, sampler) in self.ids().skip(1).zip(samplers) {
            frames.push(geometry.rest_frame(self.map(id), |i| self.of_object(i) == id, sampler, settings));
        }
        let objects = self.objects.iter().map(|(&object, &frame)| (object, frame));
        Some(Box::new(Relativity::new(frames, objects, self.observer)))
    }
}

impl SceneBuilder {
    /// Where things rest that are pushed from now on: in the world unless this is set.
    pub fn rest_in(&mut self, rest: Rest) {
        self.frames.rest = rest;
    }

    /// Where things rest that are pushed now.
    pub fn rest(&self) -> Rest {
        self.frames.rest
    }

    /// A frame that moves in that of [`SceneBuilder::rest`], for [`SceneBuilder::rest_in`].
    ///
    /// What has the place `pivot` in it is there at time 0 of what it moves in, too; other places are contracted towards it.
    ///
    /// * `velocity`: as a fraction of the speed of light
    ///
    /// Returns with it by how much places have to be moved that are meant to be in it: things that move alike share one frame.
    ///
    /// # Errors
    /// [`SceneError::NotFinite`], [`SceneError::Velocity`], [`SceneError::TooManyFrames`].
    pub fn moving_frame(&mut self, velocity: DVec3, pivot: DVec3) -> Result<(Rest, DVec3), SceneError> {
        check_finite(velocity.is_finite() && pivot.is_finite(), "FrameMap")?;
        let Rest { frame, epoch } = self.frames.rest;
        if velocity == DVec3::ZERO {
            return Ok((self.frames.rest, DVec3::ZERO));
        }
        let boost =
            FrameMap::boost(velocity, SpacetimeEvent { t: epoch, x: pivot }).ok_or(SceneError::Velocity)?;
        let map = boost.after(&self.frames.map(frame));
        if !(boost.gamma() <= MAX_GAMMA && map.gamma() <= MAX_GAMMA) {
            return Err(SceneError::Velocity);
        }
        let (frame, offset) = self.frames.frame_of(map)?;
        Ok((Rest { frame, epoch: offset.t }, offset.x))
    }

    /// How the camera moves, and when its picture is taken.
    ///
    /// # Errors
    /// [`SceneError::NotFinite`], [`SceneError::Velocity`].
    pub fn observe(&mut self, observer: CameraMotion) -> Result<(), SceneError> {
        check_finite(observer.velocity.is_finite() && observer.time.is_finite(), "CameraMotion")?;
        let origin = SpacetimeEvent { t: 0.0, x: DVec3::ZERO };
        let gamma = FrameMap::boost(observer.velocity, origin).map(|map| map.gamma());
        if gamma.is_none_or(|gamma| gamma > MAX_GAMMA) {
            return Err(SceneError::Velocity);
        }
        self.frames.observer = observer;
        Ok(())
    }
}
