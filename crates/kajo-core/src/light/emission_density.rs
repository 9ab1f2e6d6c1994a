//! Drawing points of a surface that does not emit the same everywhere.
//!
//! The luminance of its points is tabulated over the coordinates of the patch, and points are drawn with a density `p_e` that is
//! bilinear between the entries. Where the patch is near, what it covers of the receiver's sky matters too, and the
//! more so the less its light varies. So a share `s` of points is drawn by emission and the rest by the rules of [`Patch`], and the
//! density is that of the mixture
//!
//! ```text
//! p = s p_e d² / |n . w| + (1 - s) p_patch             s = v² / (1 + v²)
//! ```
//!
//! with `v` the variance of the emission over the square of its mean. For a patch that is drawn by area anyway, `s = 1`.
//!
use kajo_math::bilinear::Bilinear2D;
use kajo_math::{Vec2, Vec3};

use crate::shape::{Patch, PatchDirection, PatchSample, PlacedPatch, per_solid_angle};

/// How well the luminance between the nodes of a table is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableDetail {
    /// It is linear there, or nearly so.
    Blended,
    /// There may be more, or less.
    Sampled,
}

impl TableDetail {
    /// Part of the mean luminance that every point counts with at least, lest what the table misses be left undrawn. What is drawn
    /// where nothing is emitted is drawn in vain.
    fn least_share(self) -> f32 {
        match self {
            TableDetail::Blended => 1e-4,
            TableDetail::Sampled => 0.01,
        }
    }
}

/// The relative variance of the emission from which on a table is worth it, where points are drawn by area without one.
const WORTH_BY_AREA: f64 = 1e-3;

/// The same of a patch that is drawn by solid angle: two ways to draw points are less evenly spread than one. Measured.
const WORTH_BY_SOLID_ANGLE: f64 = 0.4;

/// The same of a sphere, and of what else is drawn through its silhouette. The half of it that faces away is drawn in vain,
/// and a direction counts by its cosine: together
/// that is a relative variance of 5/3, where directions into its cap are even.
const WORTH_ON_SPHERE: f64 = 5.0 / 3.0;

/// A density of points by what they emit.
#[derive(Clone, Debug)]
pub struct EmissionDensity {
    density: Bilinear2D,
    /// Of the points that are drawn by it where the patch is near.
    share: f32,
}

impl EmissionDensity {
    /// The density in proportion to luminances at the nodes of a grid of coordinates; `None` where these differ
    /// too little, or are no density.
    ///
    /// * `cells`: columns and rows
    /// * `luminance`: of nodes, one more of both than of cells, row by row
    pub fn new(
        patch: &Patch,
        cells: [usize; 2],
        luminance: &[f32],
        detail: TableDetail,
    ) -> Option<EmissionDensity> {
        let sum = |of: fn(f64) -> f64| luminance.iter().map(|&v| of(v.into())).sum::<f64>();
        let (n, sum, squares) = (luminance.len() as f64, sum(|v| v), sum(|v| v * v));
        let variance = squares * n / (sum * sum) - 1.0;
        let worth = match patch {
            Patch::Curved(curved) if curved.has_silhouette() => WORTH_ON_SPHERE,
            Patch::Disk(_) | Patch::Curved(_) => WORTH_BY_AREA,
            Patch::Triangle(_) | Patch::Rectangle(_) | Patch::Quad(_) => WORTH_BY_SOLID_ANGLE,
            Patch::Sphere { .. } => WORTH_ON_SPHERE,
            Patch::Traced(_) => return None,
        };
        if !variance.is_finite() || variance < worth {
            return None;
        }
        let least = detail.least_share() * (sum / n) as f32;
        let density = Bilinear2D::new(cells, 1.0, |i, j| luminance[j * (cells[0] + 1) + i].max(least))?;
        Some(EmissionDensity { density, share: (variance * variance / (1.0 + variance * variance)) as f32 })
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        self.density.bytes()
    }

    /// A point drawn by area, without a receiver.
    pub fn sample_area(&self, patch: &PlacedPatch<'_>, u: Vec2) -> Option<PatchSample> {
        let (at, density) = self.density.sample(u);
        let sample = patch.point_at(at)?;
        let pdf_area = density * sample.pdf_area;
        (pdf_area.is_finite() && pdf_area > 0.0).then_some(PatchSample { pdf_area, ..sample })
    }

    /// Density per area with which [`EmissionDensity::sample_area`] draws the point `p`.
    pub fn pdf_area(&self, patch: &PlacedPatch<'_>, p: Vec3) -> f32 {
        self.density.pdf(patch.coordinates(p)) * patch.pdf_area(p)
    }

    /// A point drawn for the receiver `from`, its density per solid angle there.
    pub fn sample(&self, patch: &PlacedPatch<'_>, from: Vec3, u: Vec2) -> Option<PatchDirection> {
        let share = self.share_for(patch, from);
        let drawn = if u.x < share {
            self.sample_area(patch, Vec2::new(u.x / share, u.y))?.seen_from(from)?
        } else {
            patch.sample(from, Vec2::new((u.x - share) / (1.0 - share), u.y))?
        };
        let pdf = self.pdf(patch, from, drawn.at.p, drawn.at.n);
        (pdf.is_finite() && pdf > 0.0).then_some(PatchDirection { pdf, ..drawn })
    }

    /// Density per solid angle at `from` with which [`EmissionDensity::sample`] draws the point `p`.
    ///
    /// * `n`: unit geometric normal at `p`
    pub fn pdf(&self, patch: &PlacedPatch<'_>, from: Vec3, p: Vec3, n: Vec3) -> f32 {
        let share = self.share_for(patch, from);
        let by_emission = per_solid_angle(self.pdf_area(patch, p), from, p, n).unwrap_or(0.0);
        if share < 1.0 { share * by_emission + (1.0 - share) * patch.pdf(from, p, n) } else { by_emission }
    }

    fn share_for(&self, patch: &PlacedPatch<'_>, from: Vec3) -> f32 {
        if patch.is_drawn_by_area(from) { 1.0 } else { self.share }
    }
}
