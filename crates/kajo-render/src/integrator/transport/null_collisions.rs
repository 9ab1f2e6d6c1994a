//! Where along a ray collisions with the majorant of a medium are.
//!
//! Between them the share `T = exp(-depth)` of the light is left, by lanes, with a depth that adds up over stretches of constant majorants.

use std::ops::Add;

use kajo_color::Spectrum;
use kajo_core::sampler::SampleStream;
use kajo_math::{Ray, fmath};

/// Null collisions along one ray after which it is given up: a majorant that is far above all densities is a mistake of the
/// scene, and must not hold up a picture for ever.
const MOST_COLLISIONS: u32 = 1 << 20;

/// A medium, or several, as null-collision sampling sees it: coefficients and majorants along a ray.
pub(super) trait NullCollisionMedium {
    /// How much there is of it at most.
    type Most;

    /// What stretches of a ray with constant majorants add up to, and `T` depends on.
    type Depth: Copy + Default + Add<Output = Self::Depth>;

    /// The spans of a ray with one majorant each, from its start on; between and behind them there is nothing.
    fn spans(&self, ray: &Ray) -> impl Iterator<Item = Span<Self::Most>>;

    /// Whether there is nothing.
    fn is_void(&self, most: &Self::Most) -> bool;

    /// `sigma[h]`.
    fn hero_extinction(&self, most: &Self::Most) -> f32;

    /// What a stretch adds to the depth.
    fn depth(&self, most: &Self::Most, length: f32) -> Self::Depth;

    /// `T[i]`.
    fn transmittance(&self, depth: Self::Depth) -> Spectrum;
}

/// A part of a ray with one majorant.
pub(super) struct Span<M> {
    pub(super) t_min: f32,
    pub(super) t_max: f32,
    pub(super) most: M,
}

/// What happens along a ray, from collision to collision.
pub(super) trait CollisionVisitor<M, D> {
    /// Passes a stretch without collisions.
    ///
    /// * `from`, `to`: distances of its ends
    /// * `depth`: from the last collision to `from`
    #[inline]
    fn pass(&mut self, _draws: &mut SampleStream<'_>, _from: f32, _to: f32, _depth: D, _majorant: &M) {}

    /// Comes to a collision with the majorant; `true` ends the walk.
    ///
    /// * `at`: its distance
    /// * `t`: `T[i]` of all lanes since the last one
    fn collide(&mut self, draws: &mut SampleStream<'_>, at: f32, t: Spectrum, majorant: &M) -> bool;
}

/// Where along a ray collisions with a majorant are, one after the other, drawn by the hero's lane.
///
/// Returns `T[i]` since the last collision where it ends at the far end of the ray.
#[inline]
pub(super) fn walk<M: NullCollisionMedium>(
    matter: &M,
    ray: &Ray,
    draws: &mut SampleStream<'_>,
    walker: &mut impl CollisionVisitor<M::Most, M::Depth>,
) -> Option<Spectrum> {
    let mut optical_depth = exponential(draws);
    // How many collisions there are differs from sample to sample.
    let mut own = draws.substream();
    let draws = own.as_mut().unwrap_or(draws);
    let mut depth = M::Depth::default();
    let mut collisions = 0;
    for Span { t_min, t_max, most } in matter.spans(ray) {
        // Where there is nothing, nothing happens.
        if matter.is_void(&most) {
            continue;
        }
        let mut at = t_min;
        let sigma = matter.hero_extinction(&most);
        loop {
            let step = if sigma > 0.0 { optical_depth / sigma } else { f32::INFINITY };
            if at + step >= t_max {
                let rest = t_max - at;
                walker.pass(draws, at, t_max, depth, &most);
                optical_depth = (optical_depth - sigma * rest).max(0.0);
                depth = depth + matter.depth(&most, rest);
                break;
            }
            walker.pass(draws, at, at + step, depth, &most);
            at += step;
            let t = matter.transmittance(depth + matter.depth(&most, step));
            collisions += 1;
            if walker.collide(draws, at, t, &most) || collisions == MOST_COLLISIONS {
                return None;
            }
            depth = M::Depth::default();
            optical_depth = exponential(draws);
        }
    }
    Some(matter.transmittance(depth))
}

/// An optical depth of the density `exp(-depth)`.
fn exponential(draws: &mut SampleStream<'_>) -> f32 {
    -fmath::ln(1.0 - draws.next_1d())
}
