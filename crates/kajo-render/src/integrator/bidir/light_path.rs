//! Memory for the vertices of paths from lights, which is kept from sample to sample.

use super::vertex::Vertex;
use super::volume::{NoMedia, Volume, WithMedia};

/// Volumes whose vertices can be kept: as memory alone, which borrows from no scene.
pub trait ReusedVolume<'a>: Volume<'a> {
    /// The same for vertices that borrow from no scene, of which there are none.
    type Kept: Send + 'static;

    /// Memory that was kept, for the vertices of a path.
    fn reused(kept: Vec<Vertex<'static, Self::Kept>>) -> Vec<Vertex<'a, Self>>;
}

impl<'a> ReusedVolume<'a> for NoMedia {
    type Kept = NoMedia;

    #[inline(always)]
    fn reused(kept: Vec<Vertex<'static, NoMedia>>) -> Vec<Vertex<'a, NoMedia>> {
        kept
    }
}

impl<'a> ReusedVolume<'a> for WithMedia<'a> {
    type Kept = WithMedia<'static>;

    #[inline(always)]
    fn reused(kept: Vec<Vertex<'static, WithMedia<'static>>>) -> Vec<Vertex<'a, WithMedia<'a>>> {
        kept
    }
}
