//! Which coordinates of a surface lay a picture on it.

/// One of the two sets of coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UvSet {
    /// [`SurfaceUv::first`](super::SurfaceUv::first).
    #[default]
    First,
    /// [`SurfaceUv::second`](super::SurfaceUv::second).
    Second,
}
