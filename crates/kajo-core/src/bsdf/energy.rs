//! What a microfacet surface loses when light that hits it a second time is forgotten, and how it is given back.
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
//! these modules. Interpolated, they keep energy to 0.3 %. Brushed metals have tables of their own, see `brushed.rs`. Of two
//! roughnesses clear media take the lesser one, so that hardly any light is made (3 % at most).

use std::f32::consts::{FRAC_1_PI, TAU};

use kajo_math::{Vec2, Vec3, fmath};

use super::microfacet::Shape;
use super::{Microfacets, brushed};

/// Nodes of the cosine, of the roughness of metals and clear media, and of the index of refraction.
pub(super) const COSINES: usize = 32;
pub(super) const METAL_ALPHAS: usize = 64;
pub(super) const ALPHAS: usize = 32;
pub(super) const INDICES: usize = 16;

/// Bytes of the tables of one shape: `s`, then `l` of both sides and the share reflected above, as 16-bit numbers, then
/// `L` of both sides in single precision; little endian, cosines fastest, then roughness, then index. After both shapes the
/// albedos of mirrors that are met once, of each shape as many as there are of `s`.
const METAL: usize = 2 * METAL_ALPHAS * COSINES;
const CLEAR: usize = 2 * INDICES * ALPHAS * COSINES;
const AVERAGES: usize = 4 * INDICES * ALPHAS;
const OF_SHAPE: usize = METAL + 3 * CLEAR + 2 * AVERAGES;

/// The largest value of `s`; all others are at most 1.
pub(super) const LARGEST: f32 = 3.0;

const TABLES: &[u8; 2 * OF_SHAPE + 2 * METAL] = include_bytes!("energy.bin");

/// The largest `(n - 1)/(n + 1)` of the tables, of the index 4. Nodes go by its root, since near 1 the critical angle
/// moves so fast.
pub(super) const STRONGEST: f32 = 0.6;

/// A place between two nodes: the lower one, and how far it is to the next.
#[derive(Clone, Copy)]
pub(super) struct Between(usize, f32);

impl Between {
    /// The place at `x` of [0, 1] among `nodes` nodes.
    #[inline]
    pub fn new(x: f32, nodes: usize) -> Between {
        let x = x.clamp(0.0, 1.0) * (nodes - 1) as f32;
        let i = (x as usize).min(nodes - 2);
        Between(i, x - i as f32)
    }

    #[inline]
    pub fn mix(self, value: impl Fn(usize) -> f32) -> f32 {
        (1.0 - self.1) * value(self.0) + self.1 * value(self.0 + 1)
    }

    fn cosine(cos: f32) -> Between {
        Between::new(cos.sqrt(), COSINES)
    }

    /// The place of a roughness; nodes go by its root.
    fn alpha(alpha: f32, nodes: usize) -> Between {
        Between::new(alpha.sqrt(), nodes)
    }

    fn index(n: f32) -> Between {
        Between::new(((n - 1.0).max(0.0) / (STRONGEST * (n + 1.0))).sqrt(), INDICES)
    }
}

/// Where the tables of a shape begin.
fn offset(shape: Shape) -> usize {
    match shape {
        Shape::Ggx => 0,
        Shape::Beckmann => OF_SHAPE,
    }
}

/// The 16-bit number at a byte, as a share of the largest.
#[inline]
fn short(at: usize) -> f32 {
    f32::from(u16::from_le_bytes([TABLES[at], TABLES[at + 1]])) * (1.0 / 65535.0)
}

#[inline]
fn single(at: usize) -> f32 {
    f32::from_le_bytes([TABLES[at], TABLES[at + 1], TABLES[at + 2], TABLES[at + 3]])
}

/// The factor `s` of metals at the unit direction `w` above the surface.
#[inline]
pub(super) fn metal(facets: &Microfacets, w: Vec3) -> f32 {
    if facets.alpha_x != facets.alpha_y {
        return brushed::factor(facets, w);
    }
    let (start, cosine) = (offset(facets.shape), Between::cosine(w.z));
    let alpha = Between::alpha(facets.alpha_x, METAL_ALPHAS);
    LARGEST * alpha.mix(|a| cosine.mix(|j| short(start + 2 * (a * COSINES + j))))
}

/// The share of light that facets which are perfect mirrors reflect to the cosine `cos` at once, of brushed ones that of
/// the lesser roughness.
#[inline]
pub(super) fn mirrored_once(facets: &Microfacets, cos: f32) -> f32 {
    let start = 2 * OF_SHAPE + offset(facets.shape) / OF_SHAPE * METAL;
    let alpha = Between::alpha(facets.alpha_x.min(facets.alpha_y), METAL_ALPHAS);
    let cosine = Between::cosine(cos);
    alpha.mix(|a| cosine.mix(|j| short(start + 2 * (a * COSINES + j))))
}

/// The factor of a metal lobe whose facets reflect `f`, for `x = s(o) s(i)`.
#[inline]
pub(super) fn saturate(f: f32, x: f32) -> f32 {
    x / (f + (1.0 - f) * x)
}

/// What the boundary of two clear media loses, for one roughness and index.
#[derive(Clone, Copy)]
pub(super) struct Loss {
    start: usize,
    alpha: Between,
    index: Between,
    /// `n²/(n₁² L₁ + n₂² L₂)` on the side of the lower and of the higher index.
    density: [f32; 2],
    /// The share of what is lost that comes out on the side of the lower index.
    pub thin_share: f32,
}

/// One of the three tables of clear media.
#[derive(Clone, Copy)]
enum Table {
    /// `l` on the side of the lower index.
    Thin,
    /// `l` on the side of the higher index.
    Dense,
    /// Light that single scattering reflects on the side of the lower index.
    Reflected,
}

impl Loss {
    /// * `n`: the higher index over the lower
    #[inline]
    pub fn new(facets: &Microfacets, n: f32) -> Loss {
        let alpha = Between::alpha(facets.alpha_x.min(facets.alpha_y), ALPHAS);
        let index = Between::index(n);
        let start = offset(facets.shape) + METAL;
        let average = |side: usize| {
            let start = start + 3 * CLEAR + side * AVERAGES;
            index.mix(|n| alpha.mix(|a| single(start + 4 * (n * ALPHAS + a))))
        };
        let thin = average(0);
        let total = thin + n * n * average(1);
        // A smooth surface loses nothing that could come out.
        let over = if total > 0.0 { 1.0 / total } else { 0.0 };
        Loss { start, alpha, index, density: [over, n * n * over], thin_share: thin * over }
    }

    /// A value of a table at the node `j` of the cosine.
    #[inline]
    fn node(&self, table: Table, j: usize) -> f32 {
        let start = self.start + table as usize * CLEAR;
        self.index.mix(|n| self.alpha.mix(|a| short(start + 2 * ((n * ALPHAS + a) * COSINES + j))))
    }

    #[inline]
    fn at(&self, table: Table, cos: f32) -> f32 {
        Between::cosine(cos).mix(|j| self.node(table, j))
    }

    /// `l` at the cosine `cos` in [0, 1] on the side of the higher index or the other.
    #[inline]
    pub fn lost(&self, dense: bool, cos: f32) -> f32 {
        self.at(if dense { Table::Dense } else { Table::Thin }, cos)
    }

    /// Density, per solid angle, with which what is lost comes out at the cosine `cos` on that side.
    #[inline]
    pub fn pdf(&self, dense: bool, cos: f32) -> f32 {
        self.lost(dense, cos) * self.density[usize::from(dense)] * cos * FRAC_1_PI
    }

    /// A direction with that density, above or below the surface.
    ///
    /// * `dense_is_above`: whether the higher index is on the side of positive z
    /// * `u`: uniform in [0, 1)², for the direction
    /// * `uc`: uniform in [0, 1), for the side
    pub fn sample(&self, dense_is_above: bool, u: Vec2, uc: f32) -> Vec3 {
        let dense = uc >= self.thin_share;
        let w = self.sample_side(dense, u);
        if dense == dense_is_above { w } else { -w }
    }

    /// A direction on one side only, as if that side were above.
    pub fn sample_side(&self, dense: bool, u: Vec2) -> Vec3 {
        let cos = self.sample_cosine(if dense { Table::Dense } else { Table::Thin }, f64::from(u.x));
        let r = (1.0 - cos * cos).max(0.0).sqrt();
        let (sin_phi, cos_phi) = fmath::sin_cos(TAU * u.y);
        Vec3::new(r * cos_phi, r * sin_phi, cos)
    }

    /// A cosine `μ` with a density in proportion to `l μ`: `l` is linear in the root `x` of the cosine between nodes,
    /// so that the integral of `l 4x³` is a polynomial there, which is inverted by bisection.
    fn sample_cosine(&self, table: Table, u: f64) -> f32 {
        let nodes: [f64; COSINES] = std::array::from_fn(|j| f64::from(self.node(table, j)));
        let mut left = u * average(&nodes);
        for j in 0..COSINES - 1 {
            let piece = Piece::new(&nodes, j);
            let mass = piece.integral(piece.end);
            if left < mass {
                let (mut low, mut high) = (piece.start, piece.end);
                for _ in 0..32 {
                    let middle = 0.5 * (low + high);
                    if piece.integral(middle) < left { low = middle } else { high = middle }
                }
                return (low * low) as f32;
            }
            left -= mass;
        }
        1.0
    }

    /// Share reflected on the side of the lower index, what comes out after more than one facet included.
    pub fn reflected(&self, cos: f32) -> f32 {
        (self.at(Table::Reflected, cos) + self.lost(false, cos) * self.thin_share).min(1.0)
    }
}

/// A tabulated function between two nodes, `base + slope x`.
struct Piece {
    start: f64,
    end: f64,
    base: f64,
    slope: f64,
}

impl Piece {
    fn new(nodes: &[f64; COSINES], j: usize) -> Piece {
        let step = 1.0 / (COSINES - 1) as f64;
        let slope = (nodes[j + 1] - nodes[j]) / step;
        let start = j as f64 * step;
        Piece { start, end: start + step, base: nodes[j] - slope * start, slope }
    }

    /// The integral of `(base + slope x) 4x³` from the start to `x`.
    fn integral(&self, x: f64) -> f64 {
        let [a4, b4] = [self.start, x].map(|x| x * x * x * x);
        self.base * (b4 - a4) + 0.8 * self.slope * (b4 * x - a4 * self.start)
    }
}

/// The average of a tabulated function over the hemisphere, weighted by the cosine: `∫ f 2μ dμ = ∫ f 4x³ dx`.
pub(super) fn average(nodes: &[f64; COSINES]) -> f64 {
    (0..COSINES - 1).map(|j| Piece::new(nodes, j)).map(|piece| piece.integral(piece.end)).sum()
}
