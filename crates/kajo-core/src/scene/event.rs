//! What becomes of a ray.

use crate::differential::SurfaceFootprint;
use crate::ids::ObjectId;
use crate::interaction::{Hit, SurfacePoint};
use crate::material::MaterialId;

/// What becomes of a ray.
#[derive(Clone, Copy, Debug)]
pub enum RayEvent {
    /// It meets a surface.
    Surface(Interaction),
    /// It leaves the scene.
    Escaped,
}

impl RayEvent {
    /// Where it meets a surface.
    pub fn surface(&self) -> Option<&Interaction> {
        match self {
            RayEvent::Surface(at) => Some(at),
            RayEvent::Escaped => None,
        }
    }
}

/// Intersection of a ray with a surface, in world space.
#[derive(Clone, Copy, Debug, Default)]
pub struct Interaction {
    /// Position and normals.
    pub point: SurfacePoint,
    /// The record of the hit in the shape's own terms.
    pub hit: Hit,
    /// Index into [`crate::scene::Geometry::primitives`], or past its end the number of an object in a nested instance.
    pub object: ObjectId,
    /// The material there.
    pub material: MaterialId,
    /// Moment within the shutter interval.
    pub time: f32,
    /// What a sample covers of the surface, where the path carries differentials.
    pub footprint: SurfaceFootprint,
}
