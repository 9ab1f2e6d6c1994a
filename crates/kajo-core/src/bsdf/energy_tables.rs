//! The tables of what microfacets lose, and places between their nodes: see `energy.rs`.

use super::microfacet::NormalDistribution;

/// Nodes of the cosine, of the roughness of metals and clear media, and of the index of refraction.
pub(super) const COSINES: usize = 32;
pub(super) const METAL_ALPHAS: usize = 64;
pub(super) const ALPHAS: usize = 32;
pub(super) const INDICES: usize = 16;

/// Bytes of the tables of one shape: `s`, then `l` of both sides and the share reflected above, as 16-bit numbers, then
/// `L` of both sides in single precision; little endian, cosines fastest, then roughness, then index. After both shapes the
/// albedos of mirrors that are met once, of each shape as many as there are of `s`.
pub(super) const METAL: usize = 2 * METAL_ALPHAS * COSINES;
const CLEAR: usize = 2 * INDICES * ALPHAS * COSINES;
const AVERAGES: usize = 4 * INDICES * ALPHAS;
pub(super) const OF_SHAPE: usize = METAL + 3 * CLEAR + 2 * AVERAGES;

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

    /// The place of a cosine; nodes go by its root.
    #[inline]
    pub fn cosine(cos: f32, nodes: usize) -> Between {
        Between::new(cos.sqrt(), nodes)
    }

    /// The place of a roughness; nodes go by its root.
    pub fn alpha(alpha: f32, nodes: usize) -> Between {
        Between::new(alpha.sqrt(), nodes)
    }

    /// The place of an index of refraction.
    pub fn index(n: f32, nodes: usize) -> Between {
        Between::new(((n - 1.0).max(0.0) / (STRONGEST * (n + 1.0))).sqrt(), nodes)
    }
}

/// Where the tables of a shape begin.
pub(super) fn offset(shape: NormalDistribution) -> usize {
    match shape {
        NormalDistribution::Ggx => 0,
        NormalDistribution::Beckmann => OF_SHAPE,
    }
}

/// The 16-bit number at a byte, as a share of the largest.
#[inline]
pub(super) fn short(at: usize) -> f32 {
    f32::from(u16::from_le_bytes([TABLES[at], TABLES[at + 1]])) * (1.0 / 65535.0)
}

#[inline]
fn single(at: usize) -> f32 {
    f32::from_le_bytes([TABLES[at], TABLES[at + 1], TABLES[at + 2], TABLES[at + 3]])
}

/// A place in the tables of clear media whose facets are as rough in all directions.
#[derive(Clone, Copy)]
pub(super) struct EvenTables {
    start: usize,
    alpha: Between,
    index: Between,
}

/// One of the three tables of clear media.
#[derive(Clone, Copy)]
pub(super) enum Table {
    /// `l` on the side of the lower index.
    Thin,
    /// `l` on the side of the higher index.
    Dense,
    /// Light that single scattering reflects on the side of the lower index.
    Reflected,
}

impl EvenTables {
    /// * `n`: the higher index over the lower
    #[inline]
    pub fn new(shape: NormalDistribution, alpha: f32, n: f32) -> EvenTables {
        let (alpha, index) = (Between::alpha(alpha, ALPHAS), Between::index(n, INDICES));
        EvenTables { start: offset(shape) + METAL, alpha, index }
    }

    /// `L` on the side of the lower and of the higher index.
    #[inline]
    pub fn averages(&self) -> [f32; 2] {
        [0, 1].map(|side| {
            let start = self.start + 3 * CLEAR + side * AVERAGES;
            self.index.mix(|n| self.alpha.mix(|a| single(start + 4 * (n * ALPHAS + a))))
        })
    }

    /// A value of a table at the node `j` of the cosine.
    #[inline]
    pub fn node(&self, table: Table, j: usize) -> f32 {
        let start = self.start + table as usize * CLEAR;
        self.index.mix(|n| self.alpha.mix(|a| short(start + 2 * ((n * ALPHAS + a) * COSINES + j))))
    }

    #[inline]
    fn at(&self, table: Table, cos: f32) -> f32 {
        Between::cosine(cos, COSINES).mix(|j| self.node(table, j))
    }

    /// `l` at the cosine `cos` in [0, 1] on the side of the higher index or the other.
    #[inline]
    pub fn lost(&self, dense: bool, cos: f32) -> f32 {
        self.at(if dense { Table::Dense } else { Table::Thin }, cos)
    }

    /// Share that single facets reflect at the cosine `cos` on the side of the lower index.
    #[inline]
    pub fn reflected_once(&self, cos: f32) -> f32 {
        self.at(Table::Reflected, cos)
    }
}

/// `n²/(n₁² L₁ + n₂² L₂)` on the side of the lower and of the higher index, and the share of what is lost that comes
/// out on the former, for the averages `L`.
#[inline]
pub(super) fn outlets([thin, dense]: [f32; 2], n: f32) -> ([f32; 2], f32) {
    let total = thin + n * n * dense;
    // A smooth surface loses nothing that could come out.
    let over = if total > 0.0 { 1.0 / total } else { 0.0 };
    ([over, n * n * over], thin * over)
}

/// A tabulated function between two nodes, `base + slope x`.
pub(super) struct LinearSegment {
    pub start: f64,
    pub end: f64,
    base: f64,
    slope: f64,
}

impl LinearSegment {
    pub fn new(nodes: &[f64; COSINES], j: usize) -> LinearSegment {
        let step = 1.0 / (COSINES - 1) as f64;
        let slope = (nodes[j + 1] - nodes[j]) / step;
        let start = j as f64 * step;
        LinearSegment { start, end: start + step, base: nodes[j] - slope * start, slope }
    }

    /// The integral of `(base + slope x) 4x³` from the start to `x`.
    pub fn integral(&self, x: f64) -> f64 {
        let [a4, b4] = [self.start, x].map(|x| x * x * x * x);
        self.base * (b4 - a4) + 0.8 * self.slope * (b4 * x - a4 * self.start)
    }
}

/// The average of a tabulated function over the hemisphere, weighted by the cosine: `∫ f 2μ dμ = ∫ f 4x³ dx`.
pub(super) fn average(nodes: &[f64; COSINES]) -> f64 {
    (0..COSINES - 1).map(|j| LinearSegment::new(nodes, j)).map(|segment| segment.integral(segment.end)).sum()
}
