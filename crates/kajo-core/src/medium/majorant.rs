//! How dense a medium is at most along a ray.

use super::majorant_grid::{GridWalk, Majorant};

/// The stretches of a ray, from its start on; between and behind them there is nothing of the medium.
#[derive(Clone, Debug)]
pub struct Majorants<'a>(Kind<'a>);

#[derive(Clone, Debug)]
enum Kind<'a> {
    /// One stretch, until it was handed out.
    One(Option<Majorant>),
    /// One for each cell of a grid.
    Cells(GridWalk<'a>),
}

impl<'a> Majorants<'a> {
    /// A single stretch.
    #[inline]
    pub fn one(majorant: Majorant) -> Majorants<'a> {
        Majorants(Kind::One(Some(majorant)))
    }

    /// One for each cell of a grid.
    #[inline]
    pub fn cells(walk: GridWalk<'a>) -> Majorants<'a> {
        Majorants(Kind::Cells(walk))
    }
}

impl Iterator for Majorants<'_> {
    type Item = Majorant;

    #[inline]
    fn next(&mut self) -> Option<Majorant> {
        match &mut self.0 {
            Kind::One(majorant) => majorant.take(),
            Kind::Cells(walk) => walk.next(),
        }
    }
}
