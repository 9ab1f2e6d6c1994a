//! Pictures of normals: how much those within a footprint differ.
//!
//! A filter gives the mean of the normals `m = 2 rgb - 1` that a sample covers, which is that of a smoother surface: what is lost are their
//! differences, by which many small facets scatter light. A second picture holds the moments `mx^2`, `my^2` and `mx my` of the texels;
//! filtered in the same way they give the covariances [Olano and Baker 2010]
//!
//! ```text
//! C = F[m m'] - F[m] F[m]'
//! ```
//!
//! A filter is never narrower than the interpolation between texels, whose differences the mean follows. With the footprint `J` in
//! texels and the interpolation's `B I` as in [`super::filter`] the footprint's own share of the variance is about
//! `tr J J' / (tr J J' + 2 B)`, which is 0 for what is seen from near.

use std::sync::Arc;

use kajo_math::Vec3;

use super::filter::{BILINEAR_VARIANCE, TexelFilter};
use super::{Picture, PictureMap, Tiling, stored};
use crate::texture::{FilteredNormals, NormalSpread, TextureContext};

/// Variance that the rounding of stored texels may make of one normal.
const ROUNDING: f32 = 1e-4;

impl Picture {
    /// The moments of its texels as normals, where those are in memory: red `mx^2`, green `my^2`, blue `(1 + mx my) / 2`.
    fn moments(&self) -> Option<&Arc<Picture>> {
        let texels = self.resident()?;
        let made = || {
            let of = |texel: &[u16; 4]| {
                let [x, y] = [texel[0], texel[1]].map(|v| f32::from(v) * (2.0 / 65535.0) - 1.0);
                [stored(x * x), stored(y * y), stored(0.5 + 0.5 * x * y), u16::MAX]
            };
            Arc::new(Picture::of_texels([self.width, self.height], texels.iter().map(of).collect()))
        };
        Some(self.moments.get_or_init(made))
    }
}

impl PictureMap {
    /// Bytes that [`PictureMap::of_normals`] would take.
    pub(crate) fn moment_bytes(&self) -> u64 {
        let [width, height] = self.picture.size();
        match self.picture.moments.get() {
            _ if !self.has_spread() => 0,
            Some(moments) => moments.preparation(self.filter),
            None => Picture::bytes(width, height) + self.filter.bytes(width, height),
        }
    }

    /// The same as normals, of which is found how much those within a footprint differ if a filter takes their mean.
    ///
    /// Not of pictures in tiles, nor of those that a random tiling mixes.
    pub fn of_normals(self) -> PictureMap {
        if !self.has_spread() {
            return self;
        }
        let Some(moments) = self.picture.moments() else { return self };
        moments.prepare(self.filter);
        let moments = Arc::new(PictureMap { picture: moments.clone(), ..self.clone() });
        PictureMap { moments: Some(moments), ..self }
    }

    fn has_spread(&self) -> bool {
        let takes_means = self.filter.wants_footprint() && self.filter != TexelFilter::Stochastic;
        let is_plain = self.tiling != Tiling::Random && self.factor == [1.0; 4];
        takes_means && is_plain && self.picture.resident().is_some()
    }

    /// See [`crate::texture::ColorNode::filtered_normals`].
    pub(super) fn normals_over(&self, at: &TextureContext) -> Option<FilteredNormals> {
        let moments = self.moments.as_ref()?;
        let covered: f32 = self.axes(at).iter().map(|axis| axis.length_squared()).sum();
        let share = covered / (covered + 2.0 * BILINEAR_VARIANCE);
        if share.is_nan() || share <= 0.0 {
            return None;
        }
        let [r, g, b, _] = self.filtered(at);
        let mean = 2.0 * Vec3::new(r, g, b) - 1.0;
        let [xx, yy, xy, _] = moments.filtered(at);
        let variance = |moment: f32, mean: f32| share * (moment - mean * mean - ROUNDING).max(0.0);
        let (xx, yy) = (variance(xx, mean.x), variance(yy, mean.y));
        let most = (xx * yy).sqrt();
        let xy = (share * (2.0 * xy - 1.0 - mean.x * mean.y)).clamp(-most, most);
        let spread = NormalSpread { xx, yy, xy };
        (!spread.is_none()).then_some(FilteredNormals { mean, spread })
    }
}
