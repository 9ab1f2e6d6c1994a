//! A camera that moves while the shutter is open: its rays are those of one at rest, moved along rigidly.
//!
//! Scene: `PerspectiveCamera { ..  Motion { key 0 { } key 1 { Translate 0.2 0 0 } } }`

use kajo_math::{DVec2, DVec3, Ray, Vec2, Vec3};

use super::{Camera, Connection, Importance};
use crate::motion::MovingTransform;

/// A camera and its motion.
#[derive(Clone, Debug)]
pub struct MovingCamera {
    /// The camera in its own space, one that does not move.
    pub camera: Camera,
    /// From there to the world, without any stretch.
    pub map: MovingTransform,
}

impl MovingCamera {
    /// See [`Camera::ray`].
    pub(super) fn ray(&self, at: Vec2, aspect: f32, lens: Vec2, time: f32) -> Option<Ray> {
        let ray = self.camera.ray(at, aspect, lens, time)?;
        let map = self.map.at(time);
        Some(Ray { o: map.point(ray.o), d: map.vector(ray.d), ..ray })
    }

    /// See [`Camera::importance`].
    pub(super) fn importance(&self, o: Vec3, d: Vec3, aspect: f32, time: f32) -> Option<Importance> {
        let own = self.map.at(time).object_from_world;
        self.camera.importance(own.transform_point3(o), own.transform_vector3(d), aspect, time)
    }

    /// See [`Camera::sample_origin`].
    pub(super) fn sample_origin(&self, u: Vec2, aspect: f32, time: f32) -> Option<Vec3> {
        Some(self.map.at(time).point(self.camera.sample_origin(u, aspect, time)?))
    }

    /// See [`Camera::connect`].
    pub(super) fn connect(&self, p: Vec3, lens: Vec2, aspect: f32, time: f32) -> Option<Connection> {
        let map = self.map.at(time);
        let way = self.camera.connect(map.object_from_world.transform_point3(p), lens, aspect, time)?;
        Some(Connection { wi: map.vector(way.wi), ..way })
    }

    /// See [`Camera::pdf_across`].
    pub(super) fn pdf_across(&self, ray: &Ray, distance: f32, aspect: f32) -> Option<f32> {
        let own = self.map.at(ray.time).object_from_world;
        let ray = Ray { o: own.transform_point3(ray.o), d: own.transform_vector3(ray.d), ..*ray };
        self.camera.pdf_across(&ray, distance, aspect)
    }

    /// See [`Camera::projections`].
    pub(super) fn projections(&self, p: DVec3, aspect: f64, time: f32) -> [Option<DVec2>; 2] {
        self.camera.projections(self.map.map_at(time).inverse().transform_point3(p), aspect, time)
    }

    /// See [`Camera::project`].
    pub(super) fn project(&self, p: DVec3, aspect: f64, time: f32) -> Option<DVec2> {
        self.camera.project(self.map.map_at(time).inverse().transform_point3(p), aspect, time)
    }
}
