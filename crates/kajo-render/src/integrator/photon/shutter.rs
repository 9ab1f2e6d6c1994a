//! Which photons light what a ray meets at a moment.
//!
//! A photon that came to a thing where that was at another moment says nothing of its light: with photons of all moments a thing that moves out of
//! its own width would be lit by a part of them only, and be too dark by that. So all rays and photons of a pass of progressive photon mapping
//! are of one moment; those of all passes are spread evenly over the time that the shutter is open. Where samples share a map,
//! or rows are exposed one after the other, that time is divided into equal parts whose photons are kept apart,
//! at the positions which surfaces have in the middle of the part.

use kajo_core::scene::{Interaction, Scene};
use kajo_math::Vec3;

/// Parts of the time that the shutter is open, each of which has photons of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShutterParts {
    /// At least 1.
    count: u32,
    /// The moment of all rays and photons, where they have one in common.
    common: Option<f32>,
}

impl ShutterParts {
    /// All the time, as one.
    pub const WHOLE: ShutterParts = ShutterParts { count: 1, common: None };

    /// * `count`: at least 1
    pub fn equal(count: u32) -> ShutterParts {
        ShutterParts { count: count.max(1), common: None }
    }

    /// One moment.
    ///
    /// * `moment`: in [0, 1] while the shutter is open
    pub fn at(moment: f32) -> ShutterParts {
        ShutterParts { count: 1, common: Some(moment) }
    }

    /// How many there are.
    pub fn count(self) -> u32 {
        self.count
    }

    /// The moment that all rays and photons have in common, if they have one.
    pub fn common(self) -> Option<f32> {
        self.common
    }

    /// A moment of a part.
    ///
    /// * `u`: uniform in [0, 1)
    pub fn moment(self, part: u32, u: f32) -> f32 {
        match self.count {
            1 => self.common.unwrap_or(u),
            count => {
                let end = (part + 1) as f32 / count as f32;
                ((part as f32 + u) / count as f32).min(end.next_down())
            }
        }
    }

    /// The part that a moment is in.
    pub fn part_at(self, moment: f32) -> u32 {
        ((moment * self.count as f32) as u32).min(self.count - 1)
    }

    /// How many of `n` paths each part has, at least 1.
    pub fn share_of(self, n: u32) -> u32 {
        n.div_ceil(self.count).max(1)
    }

    /// The moment in the middle of the part that a moment is in, where there are several.
    fn middle(self, moment: f32) -> Option<f32> {
        (self.count > 1).then(|| (self.part_at(moment) as f32 + 0.5) / self.count as f32)
    }

    /// Where the point of an interaction is kept and looked for: where it is in the middle of its part.
    pub fn point_at(self, scene: &Scene, at: &Interaction) -> Vec3 {
        self.middle(at.time).map_or(at.point.p, |middle| scene.geometry.point_at(at, middle))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_moment_is_in_one_part() {
        let parts = ShutterParts::equal(8);
        for part in 0..8 {
            for u in [0.0, 0.3, 1.0f32.next_down()] {
                let moment = parts.moment(part, u);
                assert_eq!(parts.part_at(moment), part, "{u}");
            }
            assert_eq!(parts.middle(parts.moment(part, 0.9)), Some((part as f32 + 0.5) / 8.0));
        }
        assert_eq!([parts.part_at(0.0), parts.part_at(1.0)], [0, 7]);
        let [whole, one] = [ShutterParts::WHOLE, ShutterParts::at(0.3)];
        assert_eq!([whole.moment(0, 0.7), one.moment(0, 0.7)], [0.7, 0.3]);
        assert!([whole, one].iter().all(|parts| parts.part_at(0.9) == 0 && parts.middle(0.9).is_none()));
    }
}
