//! How far the filter carries samples beyond their pixel.

use kajo_core::sampler::Sampler;

use super::Filter;

/// How far samples reach beyond their own pixel, in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Reach {
    /// To the left, to the right and upwards.
    pub side: i32,
    /// Downwards, where samples may overhang.
    pub below: i32,
}

impl Reach {
    /// How far samples of a film reach.
    pub fn of(filter: &Filter, sampler: &Sampler) -> Reach {
        filter.radius().map_or(Reach { side: 0, below: 0 }, |radius| Reach::new(radius, sampler))
    }

    /// To whichever side they reach farthest.
    pub fn widest(self) -> u32 {
        self.side.max(self.below).max(0) as u32
    }

    pub fn new(radius: f32, sampler: &Sampler) -> Reach {
        Reach { below: Reach::beyond(sampler.height(), radius), ..Reach::within_pixel(radius) }
    }

    /// The reach of what lies within its own pixel.
    pub fn within_pixel(radius: f32) -> Reach {
        let side = Reach::beyond(1.0, radius);
        Reach { side, below: side }
    }

    /// How many pixels further on positions with offsets in [0, extent) reach; supports are half-open.
    fn beyond(extent: f32, radius: f32) -> i32 {
        (extent - 0.5 + radius).ceil() as i32 - 1
    }
}
