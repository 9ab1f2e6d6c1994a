//! Repetition without a pattern to be seen: by-example noise [Heitz and Neyret 2018].
//!
//! The plane is divided into triangles; each corner of theirs shows the picture moved by a random part of itself. At a point the three corners of
//! its triangle are mixed by their barycentric weights `w`, such that the variance of the picture is kept where that of a plain mean would be less:
//!
//! ```text
//! value = m + sum of w_i (T_i - m) / sqrt(sum of w_i^2),        m the mean of the picture
//! ```
//!
//! That is exact for pictures whose values are distributed as a Gaussian, and good for those that are much the same
//! everywhere, such as bark, gravel, rust and grass. What has a structure, such as bricks, is not for this.

use kajo_math::{Vec2, rng::Stream};

/// How a picture fills the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tiling {
    /// One beside the other.
    #[default]
    Regular,
    /// By pieces of it that lie at random.
    Random,
}

/// Edges of the triangles for each width of the picture: a corner shows less than a third of it.
const DENSITY: f32 = 3.464_101_6;

/// Tells the random numbers of tilings from others.
const NAME: u64 = 0x7469_6c65;

/// The corners around a place: by how much of the picture each moves it, and its weight; the weights add up to 1.
fn corners(s: Vec2) -> [(Vec2, f32); 3] {
    // To the lattice whose unit vectors are two edges of a triangle.
    let grid = DENSITY * Vec2::new(s.x - s.y * 0.577_350_26, s.y * 1.154_700_5);
    let cell = grid.floor();
    let Vec2 { x, y } = grid - cell;
    let (base, others) = if x + y < 1.0 {
        ((Vec2::ZERO, 1.0 - x - y), [(Vec2::X, x), (Vec2::Y, y)])
    } else {
        ((Vec2::ONE, x + y - 1.0), [(Vec2::Y, 1.0 - x), (Vec2::X, 1.0 - y)])
    };
    [base, others[0], others[1]].map(|(corner, weight)| {
        let at = cell + corner;
        let stream = Stream::new(NAME, [at.x as i32 as u32, at.y as i32 as u32], 0);
        (Vec2::new(stream.uniform(0), stream.uniform(1)), weight)
    })
}

impl Tiling {
    /// What a picture shows at a place of its own.
    ///
    /// * `mean`: of the picture
    /// * `look`: the picture itself at a place
    #[inline]
    pub(super) fn show(self, s: Vec2, mean: [f32; 4], look: impl Fn(Vec2) -> [f32; 4]) -> [f32; 4] {
        // Farther away there are no digits left for a place within a triangle.
        if self == Tiling::Regular || !s.is_finite() || s.abs().max_element() > 65536.0 {
            return look(s);
        }
        let (mut sum, mut squares) = ([0.0; 4], 0.0);
        for (moved, weight) in corners(s) {
            if weight > 0.0 {
                let texel = look(s + moved);
                (0..4).for_each(|c| sum[c] += weight * (texel[c] - mean[c]));
                squares += weight * weight;
            }
        }
        let gain = 1.0 / squares.sqrt();
        std::array::from_fn(|c| (mean[c] + gain * sum[c]).clamp(0.0, 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::{Picture, PictureMap};
    use std::sync::Arc;

    fn positions() -> impl Iterator<Item = Vec2> {
        (0..20_000u32).map(|i| {
            let s = Stream::new(3, [i, 0], 0);
            40.0 * Vec2::new(s.uniform(0), s.uniform(1)) - 20.0
        })
    }

    #[test]
    fn weights_are_shares_and_continuous() {
        for s in positions().take(2000) {
            let sum: f32 = corners(s).iter().map(|&(_, weight)| weight).sum();
            assert!((sum - 1.0).abs() < 1e-5 && corners(s).iter().all(|&(_, weight)| weight >= -1e-6), "{s}");
        }
        let smooth = |s: Vec2| [0.5 + 0.25 * (std::f32::consts::TAU * s.x).sin(), 0.5, 0.5, 1.0];
        let at = |s: Vec2| Tiling::Random.show(s, [0.5, 0.5, 0.5, 1.0], smooth)[0];
        for s in positions().take(2000) {
            let step = 1e-4 * Vec2::new(0.6, 0.8);
            assert!((at(s + step) - at(s)).abs() < 2e-3, "{s}");
        }
    }

    /// Mean and variance of white noise are kept, and a period later there is something else.
    #[test]
    fn noise_keeps_its_mean_and_its_variance() {
        // Eight numbers added up are nearly distributed as a Gaussian.
        let noise = |i: u32| (0..8).map(|d| Stream::new(1, [i, 0], 0).uniform(d)).sum::<f32>() / 8.0;
        let picture = Arc::new(Picture::from_fn(64, 64, |x, y| [noise(64 * y + x), 0.0, 0.0, 1.0]));
        let plain = PictureMap { filter: crate::texture::TexelFilter::Nearest, ..PictureMap::new(picture) };
        let random = PictureMap { tiling: Tiling::Random, ..plain.clone() };
        let statistics = |map: &PictureMap| {
            let n = positions().count() as f32;
            let mean = positions().map(|s| map.at(s)[0]).sum::<f32>() / n;
            (mean, positions().map(|s| (map.at(s)[0] - mean).powi(2)).sum::<f32>() / n)
        };
        let ((mean, variance), (random_mean, random_variance)) = (statistics(&plain), statistics(&random));
        assert!((mean - random_mean).abs() < 0.005, "{mean} {random_mean}");
        assert!((random_variance / variance - 1.0).abs() < 0.06, "{variance} {random_variance}");
        let repeats = |map: &PictureMap| positions().filter(|&s| map.at(s) == map.at(s + Vec2::X)).count();
        assert!(repeats(&plain) > 19_000 && repeats(&random) < 400, "{}", repeats(&random));
        // A picture of one colour stays that.
        let grey = Arc::new(Picture::from_fn(4, 4, |_, _| [0.25, 0.5, 0.75, 1.0]));
        let flat = PictureMap { tiling: Tiling::Random, ..PictureMap::new(grey) };
        assert!(positions().all(|s| (flat.at(s)[1] - 0.5).abs() < 1e-4));
    }

    #[test]
    fn hostile_positions_give_shares() {
        let picture = Arc::new(Picture::from_fn(4, 4, |x, _| [x as f32 / 3.0; 4]));
        let map = PictureMap { tiling: Tiling::Random, ..PictureMap::new(picture) };
        for v in [f32::NAN, f32::INFINITY, -f32::MAX, 1e30, -1e9, 65535.9, -0.0, 1e-40] {
            for s in [Vec2::new(v, 0.3), Vec2::new(0.3, v), Vec2::splat(v)] {
                assert!(map.at(s).iter().all(|v| (0.0..=1.0).contains(v)), "{s}");
            }
        }
    }
}
