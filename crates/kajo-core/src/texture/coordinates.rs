//! Which coordinates of a surface lay a picture on it.

use crate::interaction::SurfaceUv;

/// One of the two sets of coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UvSet {
    /// [`SurfaceUv::first`].
    #[default]
    First,
    /// [`SurfaceUv::second`].
    Second,
}
