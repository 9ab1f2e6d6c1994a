//! What the boundary of two clear media loses whose facets are rougher one way than the other.
//!
//! See `energy.rs`: with `l(w)` the share of light from or to `w` that is lost where it meets a second facet, it comes out
//! again as `l(o) l(i) n_i² / (π (n₁² L₁ + n₂² L₂))`. Here `l` depends on the azimuth too. Most of that is caught by the
//! roughness along the azimuth `φ` of the direction,
//!
//! ```text
//! α(φ)² = (αx cos φ)² + (αy sin φ)²        l(θ, φ) = l_even(θ; α(φ)) + d(θ, φ)
//! ```
//!
//! with `l_even` for facets of one roughness. What is left, `d`, is tabulated over the cosine, the azimuth in one quarter,
//! the greater roughness, the lesser one over that, and the index, in `brushed_clear.bin`, made by the generator among the tests
//! of these modules for both shapes. So is what both sides' averages `L` are above those of facets of one roughness, the root
//! mean square of both. Straight above, where all azimuths meet, `d` still belongs to one of them.

use std::f32::consts::FRAC_2_PI;

use kajo_math::{Vec3, fmath};

use super::Microfacets;
use super::energy_tables::{Between, EvenTables, outlets};
use super::microfacet::NormalDistribution;

/// Nodes of the cosine, of the azimuth in a quarter, of the ratio of both roughnesses, of the greater one, and of the index.
pub(super) const COSINES: usize = 16;
pub(super) const TURNS: usize = 12;
pub(super) const ASPECTS: usize = 7;
pub(super) const ALPHAS: usize = 10;
pub(super) const INDICES: usize = 12;

/// Nodes of everything but directions.
pub(super) const SURFACES: usize = ASPECTS * ALPHAS * INDICES;
/// Nodes of each table.
pub(super) const OF_TABLE: usize = COSINES * TURNS * SURFACES;

/// Bytes of the tables of one shape: `d` of what is lost on the side of the lower index and of the higher one, and of what
/// is reflected on the former, in signed 16-bit numbers; then the differences of `L` of both sides in single precision.
/// Little endian; cosines fastest, then azimuths, ratios, roughnesses and indices.
pub(super) const OF_SHAPE: usize = 6 * OF_TABLE + 8 * SURFACES;

/// Those of GGX, then those of Beckmann.
const TABLES: &[u8; 2 * OF_SHAPE] = include_bytes!("brushed_clear.bin");

/// Where the tables of a shape begin.
fn offset(shape: NormalDistribution) -> usize {
    match shape {
        NormalDistribution::Ggx => 0,
        NormalDistribution::Beckmann => OF_SHAPE,
    }
}

/// The tables of facets of one roughness, the root mean square of both, from which the averages `L` differ.
pub(super) fn mean_surface(facets: &Microfacets, n: f32) -> EvenTables {
    let Microfacets { shape, alpha_x, alpha_y } = *facets;
    EvenTables::new(shape, (0.5 * (alpha_x * alpha_x + alpha_y * alpha_y)).sqrt(), n)
}

/// What one boundary loses.
#[derive(Clone, Copy)]
pub(super) struct BrushedClear {
    shape: NormalDistribution,
    /// The greater and the lesser roughness.
    alphas: [f32; 2],
    /// Whether the greater one is along y.
    is_across: bool,
    n: f32,
    index: Between,
    alpha: Between,
    aspect: Between,
    /// `n²/(n₁² L₁ + n₂² L₂)` on the side of the lower and of the higher index.
    pub density: [f32; 2],
    /// The share of what is lost that comes out on the side of the lower index.
    pub thin_share: f32,
}

/// One of the tables of differences.
#[derive(Clone, Copy)]
enum Table {
    Thin,
    Dense,
    Reflected,
}

/// A direction as the tables see it: in one quarter, grain along x.
struct TableDirection {
    cos: f32,
    /// The square of the cosine of the azimuth.
    cos2_phi: f32,
    /// The azimuth as a share of the quarter.
    turn: f32,
}

impl BrushedClear {
    /// * `n`: the higher index over the lower
    pub fn new(facets: &Microfacets, n: f32) -> BrushedClear {
        let Microfacets { shape, alpha_x, alpha_y } = *facets;
        let alphas @ [rough, fine] = [alpha_x.max(alpha_y), alpha_x.min(alpha_y)];
        let (index, alpha) = (Between::index(n, INDICES), Between::alpha(rough, ALPHAS));
        let aspect = Between::alpha(fine / rough, ASPECTS);
        let difference = |side: usize| {
            let node = |n: usize, a: usize, q: usize| {
                let at =
                    offset(shape) + 6 * OF_TABLE + 4 * (side * SURFACES + (n * ALPHAS + a) * ASPECTS + q);
                f32::from_le_bytes([TABLES[at], TABLES[at + 1], TABLES[at + 2], TABLES[at + 3]])
            };
            index.mix(|n| alpha.mix(|a| aspect.mix(|q| node(n, a, q))))
        };
        let even = mean_surface(facets, n).averages();
        let averages = [0, 1].map(|side| (even[side] + difference(side)).max(0.0));
        let (density, thin_share) = outlets(averages, n);
        let is_across = alpha_y > alpha_x;
        BrushedClear { shape, alphas, is_across, n, index, alpha, aspect, density, thin_share }
    }

    /// `l` for the unit direction `w`, on the side of the higher index or the other.
    pub fn lost(&self, dense: bool, w: Vec3) -> f32 {
        let seen = self.seen(w);
        let even = self.even(&seen).lost(dense, seen.cos);
        (even + self.difference(if dense { Table::Dense } else { Table::Thin }, &seen)).clamp(0.0, 1.0)
    }

    /// Share of light to `w` that single facets reflect on the side of the lower index.
    pub fn reflected_once(&self, w: Vec3) -> f32 {
        let seen = self.seen(w);
        let even = self.even(&seen).reflected_once(seen.cos);
        (even + self.difference(Table::Reflected, &seen)).clamp(0.0, 1.0)
    }

    fn seen(&self, w: Vec3) -> TableDirection {
        let (along, across) = (w.x.abs(), w.y.abs());
        let (along, across) = if self.is_across { (across, along) } else { (along, across) };
        let across_the_normal = along * along + across * across;
        let cos2_phi = if across_the_normal > 0.0 { along * along / across_the_normal } else { 1.0 };
        TableDirection { cos: w.z.abs(), cos2_phi, turn: FRAC_2_PI * fmath::atan2(across, along) }
    }

    /// The tables for the roughness along the azimuth.
    fn even(&self, seen: &TableDirection) -> EvenTables {
        let [rough, fine] = self.alphas.map(|alpha| alpha * alpha);
        let alpha = (seen.cos2_phi * rough + (1.0 - seen.cos2_phi) * fine).sqrt();
        EvenTables::new(self.shape, alpha, self.n)
    }

    fn difference(&self, table: Table, seen: &TableDirection) -> f32 {
        let (turn, cosine) = (Between::new(seen.turn, TURNS), Between::cosine(seen.cos, COSINES));
        let start = offset(self.shape) + 2 * table as usize * OF_TABLE;
        let node = |n: usize, a: usize, q: usize, p: usize, j: usize| {
            let node = (((n * ALPHAS + a) * ASPECTS + q) * TURNS + p) * COSINES + j;
            let at = start + 2 * node;
            f32::from(i16::from_le_bytes([TABLES[at], TABLES[at + 1]])) * (1.0 / 32767.0)
        };
        let on = |n: usize, a: usize, q: usize| turn.mix(|p| cosine.mix(|j| node(n, a, q, p, j)));
        self.index.mix(|n| self.alpha.mix(|a| self.aspect.mix(|q| on(n, a, q))))
    }
}
