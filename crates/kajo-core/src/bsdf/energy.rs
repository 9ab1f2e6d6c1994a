//! The energy that a microfacet lobe loses by neglecting multiple scattering, and its compensation.
//!
//! **Metals.** With `f` the lobe of perfect mirrors there is one function `s` of the cosine for which
//!
//! ```text
//! s(o) ∫ f(o, i) s(i) |cos θi| di = 1     for every o
//! ```
//!
//! found by Sinkhorn's iteration [Sinkhorn 1964]. The lobe times `x = s(o) s(i)` loses nothing, is reciprocal as
//! before, and has the same shape, as in [Turquin 2019]. Facets that reflect `F` only lose at each bounce: their
//! lobe is multiplied by `x / (F + (1 - F) x)`, the sum of the geometric series in which a share `1/x`
//! leaves after each bounce [Kulla and Conty 2017].
//!
//! **Clear media.** With `l(o)` the share that single scattering loses, on either side, and `L` its
//! average over the cosine-weighted hemisphere of that side, the light comes out again as
//!
//! ```text
//! f(o, i) = l(o) l(i) n_i² / (π (n₁² L₁ + n₂² L₂))
//! ```
//!
//! on both sides: reciprocal, and it gives back just what was lost. This is the diffuse lobe of [Kulla and Conty 2017]
//! for two sides at once.
//!
//! Where no such light is wanted, the albedo of perfect mirrors that are met once is asked for, `∫ f(o, i) |cos θi| di`.
//!
//! `s`, `l`, `L` and that albedo are tabulated for isotropic roughness in `energy.bin`, made by the generator among the tests of
//! these modules. Interpolated, they keep energy to 0.3 %. Where the roughness differs by direction, what is lost depends on the
//! azimuth too: see `brushed_metal.rs` and `brushed_clear.rs`.

use std::f32::consts::{FRAC_1_PI, TAU};

use kajo_math::{Vec2, Vec3, fmath};

use super::brushed_clear::BrushedClear;
use super::energy_tables::{
    Between, COSINES, EvenTables, LARGEST, LinearSegment, METAL, METAL_ALPHAS, OF_SHAPE, Table, average,
    offset, outlets, short,
};
use super::microfacet::NormalDistribution;
use super::{Microfacets, brushed_metal};

/// The factor `s` of metals at the unit direction `w` above the surface.
#[inline]
pub(super) fn metal(facets: &Microfacets, w: Vec3) -> f32 {
    if facets.alpha_x != facets.alpha_y {
        return brushed_metal::factor(facets, w);
    }
    let (start, cosine) = (offset(facets.shape), Between::cosine(w.z, COSINES));
    let alpha = Between::alpha(facets.alpha_x, METAL_ALPHAS);
    LARGEST * alpha.mix(|a| cosine.mix(|j| short(start + 2 * (a * COSINES + j))))
}

/// The share of light that facets which are perfect mirrors reflect to the cosine `cos` at once, of brushed ones that of
/// the lesser roughness.
#[inline]
pub(super) fn mirrored_once(facets: &Microfacets, cos: f32) -> f32 {
    let start = 2 * OF_SHAPE + offset(facets.shape) / OF_SHAPE * METAL;
    let alpha = Between::alpha(facets.alpha_x.min(facets.alpha_y), METAL_ALPHAS);
    let cosine = Between::cosine(cos, COSINES);
    alpha.mix(|a| cosine.mix(|j| short(start + 2 * (a * COSINES + j))))
}

/// The factor of a metal lobe whose facets reflect `f`, for `x = s(o) s(i)`.
#[inline]
pub(super) fn saturate(f: f32, x: f32) -> f32 {
    x / (f + (1.0 - f) * x)
}

/// What the boundary of two clear media loses, for one distribution of facets and index.
///
/// Directions `w` are unit vectors, above or below the surface alike.
#[derive(Clone, Copy)]
pub(super) struct Loss {
    /// That of facets as rough in all directions as these are in the roughest, by which directions are drawn.
    even: EvenLoss,
    /// What differs for facets whose roughness depends on the direction.
    brushed: Option<BrushedClear>,
}

impl Loss {
    /// * `n`: the higher index over the lower
    #[inline]
    pub fn new(facets: &Microfacets, n: f32) -> Loss {
        let Microfacets { shape, alpha_x, alpha_y } = *facets;
        Loss {
            even: EvenLoss::new(shape, alpha_x.max(alpha_y), n),
            brushed: if alpha_x != alpha_y { Some(BrushedClear::new(facets, n)) } else { None },
        }
    }

    /// What is lost of light from or to `w`, on the side of the higher index or the other.
    #[inline]
    pub fn lost(&self, dense: bool, w: Vec3) -> f32 {
        match &self.brushed {
            None => self.even.tables.lost(dense, w.z.abs()),
            Some(brushed) => brushed.lost(dense, w),
        }
    }

    /// What comes out towards `w` on that side, per solid angle, of all that is lost; with the cosine of `w`.
    #[inline]
    pub fn returned(&self, dense: bool, w: Vec3) -> f32 {
        match &self.brushed {
            None => self.even.pdf(dense, w.z.abs()),
            Some(brushed) => {
                let cos = w.z.abs();
                brushed.lost(dense, w) * brushed.density[usize::from(dense)] * cos * FRAC_1_PI
            }
        }
    }

    /// The share of what is lost that comes out on the side of the lower index.
    #[inline]
    pub fn thin_share(&self) -> f32 {
        self.brushed.as_ref().map_or(self.even.thin_share, |brushed| brushed.thin_share)
    }

    /// Density, per solid angle, of [`sample`](Loss::sample): that of [`returned`](Loss::returned) for facets of one roughness.
    #[inline]
    pub fn pdf(&self, dense: bool, w: Vec3) -> f32 {
        self.even.pdf(dense, w.z.abs())
    }

    /// Density, per solid angle, of [`sample_side`](Loss::sample_side) on the side of the lower index.
    #[inline]
    pub fn thin_pdf(&self, w: Vec3) -> f32 {
        if self.even.thin_share > 0.0 { self.even.pdf(false, w.z.abs()) / self.even.thin_share } else { 0.0 }
    }

    /// A direction for light that is lost, above or below the surface.
    ///
    /// * `dense_is_above`: whether the higher index is on the side of positive z
    /// * `u`: uniform in [0, 1)², for the direction
    /// * `uc`: uniform in [0, 1), for the side
    pub fn sample(&self, dense_is_above: bool, u: Vec2, uc: f32) -> Vec3 {
        let dense = uc >= self.even.thin_share;
        let w = self.even.sample_side(dense, u);
        if dense == dense_is_above { w } else { -w }
    }

    /// A direction on one side only, as if that side were above.
    pub fn sample_side(&self, dense: bool, u: Vec2) -> Vec3 {
        self.even.sample_side(dense, u)
    }

    /// Share of light from or to `w` that is reflected on the side of the lower index, what comes out after more than one facet
    /// included.
    #[inline]
    pub fn reflected(&self, w: Vec3) -> f32 {
        let once = match &self.brushed {
            None => self.even.tables.reflected_once(w.z),
            Some(brushed) => brushed.reflected_once(w),
        };
        (once + self.lost(false, w) * self.thin_share()).min(1.0)
    }
}

/// What the boundary of two such media loses, and how it comes out.
#[derive(Clone, Copy)]
struct EvenLoss {
    tables: EvenTables,
    /// `n²/(n₁² L₁ + n₂² L₂)` on the side of the lower and of the higher index.
    density: [f32; 2],
    /// The share of what is lost that comes out on the side of the lower index.
    thin_share: f32,
}

impl EvenLoss {
    #[inline]
    fn new(shape: NormalDistribution, alpha: f32, n: f32) -> EvenLoss {
        let tables = EvenTables::new(shape, alpha, n);
        let (density, thin_share) = outlets(tables.averages(), n);
        EvenLoss { tables, density, thin_share }
    }

    /// Density, per solid angle, with which what is lost comes out at the cosine `cos` on that side.
    #[inline]
    fn pdf(&self, dense: bool, cos: f32) -> f32 {
        self.tables.lost(dense, cos) * self.density[usize::from(dense)] * cos * FRAC_1_PI
    }

    /// A direction with that density on one side, as if that side were above.
    fn sample_side(&self, dense: bool, u: Vec2) -> Vec3 {
        let cos = self.sample_cosine(if dense { Table::Dense } else { Table::Thin }, f64::from(u.x));
        let r = (1.0 - cos * cos).max(0.0).sqrt();
        let (sin_phi, cos_phi) = fmath::sin_cos(TAU * u.y);
        Vec3::new(r * cos_phi, r * sin_phi, cos)
    }

    /// A cosine `μ` with a density in proportion to `l μ`: `l` is linear in the root `x` of the cosine between nodes,
    /// so that the integral of `l 4x³` is a polynomial there, which is inverted by bisection.
    fn sample_cosine(&self, table: Table, u: f64) -> f32 {
        let nodes: [f64; COSINES] = std::array::from_fn(|j| f64::from(self.tables.node(table, j)));
        let mut left = u * average(&nodes);
        for j in 0..COSINES - 1 {
            let segment = LinearSegment::new(&nodes, j);
            let mass = segment.integral(segment.end);
            if left < mass {
                let (mut low, mut high) = (segment.start, segment.end);
                for _ in 0..32 {
                    let middle = 0.5 * (low + high);
                    if segment.integral(middle) < left { low = middle } else { high = middle }
                }
                return (low * low) as f32;
            }
            left -= mass;
        }
        1.0
    }
}
