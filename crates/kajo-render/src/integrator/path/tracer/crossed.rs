//! What a path has come through on its way to a light that it meets.

use kajo_core::ObjectId;
use kajo_core::light::Receiver;
use kajo_math::Vec3;

use crate::integrator::transport::{ChainStart, Via};

/// What a path has come through since it was scattered last into more than single directions.
#[derive(Clone, Copy)]
pub struct Crossed {
    /// Where it was scattered.
    pub start: ChainStart,
    pub receiver: Receiver,
    /// Unit direction in which it left.
    pub d: Vec3,
    /// Density of that per solid angle.
    pub pdf: f32,
    /// `None` where it has come to nothing yet.
    pub via: Option<Via>,
    /// The first object of that.
    pub first: ObjectId,
}
