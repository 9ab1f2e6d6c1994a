//! The energy that the lobe of a brushed metal loses by neglecting multiple scattering.
//!
//! As for other metals there is one function `s` of the direction with
//!
//! ```text
//! s(o) ∫ f(o, i) s(i) |cos θi| di = 1     for every o,
//! ```
//!
//! `f` the lobe of perfect mirrors, found by Sinkhorn's iteration; see `energy.rs`. Where facets are rougher one way it depends
//! on the azimuth too. It is the same in the four quarters, and is tabulated over the cosine, the azimuth in one of
//! them, the greater roughness, and the lesser one over that, in `brushed_metal.bin`, made by the generator among the tests of
//! these modules. Interpolated, it keeps energy to 1 %, that of Beckmann's shape at
//! the end of the range to 2 %; the tables of plain metals, asked for the geometric mean of both
//! roughnesses, would lose a tenth where one is 0.9 and the other 0.3, and a quarter where one is 1 and the other 0.05.

use std::f32::consts::FRAC_2_PI;

use kajo_math::{Vec3, fmath};

use super::Microfacets;
use super::energy_tables::{Between, LARGEST};
use super::microfacet::NormalDistribution;

/// Nodes of the cosine, of the azimuth in a quarter, of the greater roughness and of the ratio of both.
pub(super) const COSINES: usize = 20;
pub(super) const TURNS: usize = 10;
pub(super) const ALPHAS: usize = 14;
pub(super) const ASPECTS: usize = 9;

/// Values of one shape: cosines fastest, then azimuths, then ratios, then roughnesses.
pub(super) const OF_SHAPE: usize = COSINES * TURNS * ASPECTS * ALPHAS;

/// Both shapes as 16-bit numbers, little endian.
const TABLES: &[u8; 4 * OF_SHAPE] = include_bytes!("brushed_metal.bin");

/// The factor `s` at the unit direction `w` above the surface.
pub(super) fn factor(facets: &Microfacets, w: Vec3) -> f32 {
    let (along, across) = (w.x.abs(), w.y.abs());
    let (rough, fine, along, across) = if facets.alpha_x >= facets.alpha_y {
        (facets.alpha_x, facets.alpha_y, along, across)
    } else {
        (facets.alpha_y, facets.alpha_x, across, along)
    };
    let start = if facets.shape == NormalDistribution::Ggx { 0 } else { OF_SHAPE };
    let alpha = Between::new(rough.sqrt(), ALPHAS);
    let aspect = Between::new((fine / rough).sqrt(), ASPECTS);
    let turn = Between::new(FRAC_2_PI * fmath::atan2(across, along), TURNS);
    let cosine = Between::new(w.z.sqrt(), COSINES);
    let node = |a: usize, q: usize, p: usize, j: usize| {
        let at = 2 * (start + ((a * ASPECTS + q) * TURNS + p) * COSINES + j);
        f32::from(u16::from_le_bytes([TABLES[at], TABLES[at + 1]])) * (LARGEST / 65535.0)
    };
    alpha.mix(|a| aspect.mix(|q| turn.mix(|p| cosine.mix(|j| node(a, q, p, j)))))
}
