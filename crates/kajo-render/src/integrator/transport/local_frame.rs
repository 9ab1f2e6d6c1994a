//! Directions at a surface in the frame in which it scatters.

use kajo_core::bsdf::BsdfSample;
use kajo_core::shading::Shading;
use kajo_math::{Frame, Vec3};

/// The shading frame at a surface for a direction back along the path.
#[derive(Debug)]
pub struct LocalFrame {
    frame: Frame,
    /// Unit direction back along the path, in the frame.
    pub wo: Vec3,
    /// Unit geometric normal, outward.
    ng: Vec3,
}

impl LocalFrame {
    /// * `wo`: unit direction back along the path, in world space
    #[inline]
    pub fn new(shading: &Shading, wo: Vec3) -> LocalFrame {
        let frame = shading.frame(wo);
        LocalFrame { wo: frame.to_local(wo), frame, ng: shading.ng }
    }

    /// The normal that the surface shows to `wo`.
    pub fn n(&self) -> Vec3 {
        self.frame.n
    }

    /// A world-space direction in the frame; `None` for one that is on different sides of the surface by the true normal and
    /// by the shading normal, where no light comes from.
    #[inline]
    pub fn to_local(&self, w: Vec3) -> Option<Vec3> {
        let local = self.frame.to_local(w);
        self.agrees(w, local).then_some(local)
    }

    /// A sampled direction in world space; `None` for one that the true surface hides.
    #[inline]
    pub fn to_world(&self, sample: &BsdfSample) -> Option<Vec3> {
        let wi = self.frame.to_world(sample.wi);
        self.agrees(wi, sample.wi).then_some(wi)
    }

    fn agrees(&self, world: Vec3, local: Vec3) -> bool {
        world.dot(self.ng) * local.z > 0.0
    }
}
