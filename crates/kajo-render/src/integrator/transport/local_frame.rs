//! Directions at a surface in the frame in which it scatters.

use kajo_core::bsdf::{Bsdf, BsdfSample};
use kajo_core::shading::Shading;
use kajo_math::{Frame, Vec3};

/// The shading frame at a surface for a direction back along the path.
#[derive(Clone, Copy, Debug)]
pub struct LocalFrame {
    frame: Frame,
    /// Unit direction back along the path, in the frame.
    pub wo: Vec3,
    /// Unit geometric normal, outward.
    ng: Vec3,
    /// The shading normal in the frame, where that was made for another one.
    diffuse_normal: Option<Vec3>,
}

impl LocalFrame {
    /// * `wo`: unit direction back along the path, in world space
    #[inline]
    pub fn new(shading: &Shading, wo: Vec3) -> LocalFrame {
        let frame = shading.frame(wo);
        let is_held = shading.leans && frame.n != shading.n;
        let diffuse_normal = is_held.then(|| frame.to_local(shading.n));
        LocalFrame { wo: frame.to_local(wo), frame, ng: shading.ng, diffuse_normal }
    }

    /// What takes the place of `bsdf` in this frame: where a relief leans so far that the frame was made for a normal turned
    /// towards the viewer, diffuse light is scattered about the normal of the relief all the same. `None` where `bsdf` holds as it
    /// is.
    #[inline]
    pub fn bumped<'s>(&self, bsdf: &Bsdf<'s>) -> Option<Bsdf<'s>> {
        bsdf.with_diffuse_normal(self.diffuse_normal?, self.wo)
    }

    /// The normal that the surface shows to `wo`.
    pub fn n(&self) -> Vec3 {
        self.frame.n
    }

    /// A world-space direction in the frame; `None` for one that is on different sides of the surface by the true normal and
    /// by the shading normal, where no light comes from.
    #[inline]
    pub fn to_local(self, w: Vec3) -> Option<Vec3> {
        let local = self.frame.to_local(w);
        self.agrees(w, local).then_some(local)
    }

    /// A sampled direction in world space; `None` for one that the true surface hides.
    #[inline]
    pub fn to_world(self, sample: &BsdfSample) -> Option<Vec3> {
        let wi = self.frame.to_world(sample.wi);
        self.agrees(wi, sample.wi).then_some(wi)
    }

    fn agrees(&self, world: Vec3, local: Vec3) -> bool {
        world.dot(self.ng) * local.z > 0.0
    }
}
