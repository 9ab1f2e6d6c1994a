//! Participating media in bidirectional paths: per-vertex data that has no size in scenes without media, and densities of segments.
//!
//! In a medium a segment is drawn with the density of its direction, and with one for how far it goes. Paths are taken with the points of
//! their null collisions [Miller, Georgiev and Jarosz 2019], so that all of these densities are known. Let `N` be the density of the null
//! collisions of a segment that is joined, by residual ratio tracking, and `q` that of a free path with the same ones over it,
//!
//! ```text
//! q = exp(-sigma_t integral of c) (product over null collisions of (m - d)/(m - c))
//! ```
//!
//! with the density `d` and its bounds `c` and `m`. In a homogeneous medium, where nothing is drawn but the end, `N = 1` and `q = T`. Then
//!
//! ```text
//! drawn from either end, to a surface         N q
//! drawn from either end, to a collision at y  N q sigma_t(y)       per volume
//! joined                                      N
//! ```
//!
//! `q` is the same in both directions and `N` is common to all techniques that sample the path. So the weights of `partial_mis.rs` hold with
//! each density per area multiplied by `q sigma_t(y)`, where `sigma_t` is 1 at surfaces, and cosines that are 1 in media.
//!
//! Coefficients depend on the wavelength. Weights take the means of `q` and of `sigma_t` over all lanes that the path
//! began with: any function of the path may stand for a density, as long as it is the same for all techniques. The
//! estimate itself counts over the mean of the true densities of all lanes, each of which might have drawn the
//! distances, as in path tracing; see `transport/collisions.rs`.

use std::fmt;

use kajo_color::Spectrum;
use kajo_core::medium::PhaseAtWavelengths;

use super::partial_mis::Growth;
use crate::integrator::transport::{MediumStack, PathState};

/// Whether paths carry participating media, and what a vertex then keeps of them.
pub trait Volume<'a>: Copy + Sync + fmt::Debug + 'a {
    /// Whether paths carry media.
    const HAS_MEDIA: bool;

    /// Made where paths carry media.
    fn of(make: impl FnOnce() -> WithMedia<'a>) -> Self;

    /// The data of the vertex; `None` in scenes without media.
    fn with_media(&self) -> Option<&WithMedia<'a>>;

    /// The same, to be changed.
    fn with_media_mut(&mut self) -> Option<&mut WithMedia<'a>>;

    /// A density with what media make of it.
    #[inline(always)]
    fn scaled(pdf: f32, factor: impl FnOnce() -> f32) -> f32 {
        if Self::HAS_MEDIA { pdf * factor() } else { pdf }
    }
}

/// A scene without participating media.
#[derive(Clone, Copy, Debug)]
pub struct NoMedia;

impl<'a> Volume<'a> for NoMedia {
    const HAS_MEDIA: bool = false;

    #[inline(always)]
    fn of(_make: impl FnOnce() -> WithMedia<'a>) -> NoMedia {
        NoMedia
    }

    #[inline(always)]
    fn with_media(&self) -> Option<&WithMedia<'a>> {
        None
    }

    #[inline(always)]
    fn with_media_mut(&mut self) -> Option<&mut WithMedia<'a>> {
        None
    }
}

/// A vertex in a scene with participating media.
#[derive(Clone, Copy, Debug)]
pub struct WithMedia<'a> {
    /// Phase function at the vertex, if it is in a medium.
    pub phase: Option<PhaseAtWavelengths<'a>>,
    /// Extinction per unit length at a vertex in a medium, the mean over the lanes; 1 at surfaces.
    pub sigma_t: f32,
    /// Densities of the path to the vertex by lanes, as [`crate::integrator::transport::LaneMis::r_u`].
    pub r_u: Spectrum,
    /// What is around the vertex on the side of `wo` and on the other.
    pub media: [MediumStack; 2],
    /// What merging adds to the sums if the path goes on so that no connection does it. In a medium: `eta^2`, to
    /// `d_vcm`, if vertices may be merged there. On a surface: what merging at the vertex before adds to `d_vc`, if
    /// light is scattered into a single direction there. 0 elsewhere; see `merge.rs`.
    pub merged: f64,
}

impl<'a> Volume<'a> for WithMedia<'a> {
    const HAS_MEDIA: bool = true;

    #[inline]
    fn of(make: impl FnOnce() -> WithMedia<'a>) -> WithMedia<'a> {
        make()
    }

    #[inline]
    fn with_media(&self) -> Option<&WithMedia<'a>> {
        Some(self)
    }

    #[inline]
    fn with_media_mut(&mut self) -> Option<&mut WithMedia<'a>> {
        Some(self)
    }
}

/// The densities of a path's new vertex with what media make of them: `pdf q sigma_t` at a collision, `pdf q` at a
/// surface, and the other way `g q sigma_t` of the vertex before (the first two rows of the table above without `N`,
/// which is common to all techniques).
///
/// * `collision`: mean extinction there, if it is in a medium
pub fn grown_through_media(growth: Growth, path: &PathState<'_>, collision: Option<f32>) -> Growth {
    let lanes = &path.lanes;
    let reach = match collision {
        Some(_) => lanes.reach,
        None => lanes.arrival(&path.wavelengths),
    };
    Growth {
        pdf: growth.pdf * reach * collision.unwrap_or(1.0),
        g: growth.g * reach * lanes.sigma_t_from,
        ..growth
    }
}
