//! Filters of pictures: what is between texels, and the mean over what a sample covers.
//!
//! A footprint is two vectors `j0`, `j1` in texels, the distances to the neighbouring samples. With the matrix `J` of both as columns:
//!
//! * **trilinear** [Williams 1983]: bilinear on two levels of a pyramid around `log2 max(|j0|, |j1|)`, mixed. Round, so it blurs
//!   where one vector is much longer than the other
//! * **sat** [Crow 1984]: the mean over the box around the parallelogram of both. Blurs what lies slanted
//! * **ewa** [Heckbert 1989]: the mean over an ellipse with the weights
//!
//!   ```text
//!   w(x) = exp(-5.5 r^2) - exp(-5.5),      r^2 = x' M^-1 x < 1,      M = J J' + 1.9576 I
//!   ```
//!
//!   whose variance is `0.0851 M`: about that of the parallelogram, and that of bilinear weights where there is no footprint. On
//!   level `l` of the pyramid texels are means over squares of `2^l` and so have a variance of their own; there the ellipse is that of
//!   what is left of it, `M_l = (J J' + 1.9576 I) / 4^l - 0.9788 (1 - 1/4^l) I`. So all levels give the same filter, nothing
//!   is seen of their borders, and one of them is enough. The level is the largest on which ellipses are at least 2 texels wide.
//! * **feline** [McCormack et al. 1999]: trilinear probes along the longer axis of the ellipse, with Gaussian weights
//! * **stochastic** [Pharr et al. 2024]: one texel, drawn by the weights of such an ellipse. Right in the mean whatever is done
//!   with it afterwards, and noisy
//!
//! Ellipses more than 16 times longer than wide are made wider.

use std::sync::LazyLock;

use kajo_math::{Vec2, fmath, rng::Stream};

use super::pyramid::Pyramid;
use super::sums::SummedAreaTable;
use super::tiled::TiledLevel;
use super::{Picture, PictureMap, Texels, Wrap};
use crate::texture::TextureContext;

/// How values of a picture are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TexelFilter {
    /// That of the nearest texel.
    Nearest,
    /// The weighted mean of the four around.
    #[default]
    Bilinear,
    /// A smooth surface through the sixteen around [Keys 1981].
    Bicubic,
    /// A mean over a square of the size of the footprint.
    Trilinear,
    /// The mean over a box around the footprint.
    Sat,
    /// The mean over an ellipse.
    Ewa,
    /// Means over squares along an ellipse.
    Feline,
    /// A texel drawn from an ellipse.
    Stochastic,
}

impl TexelFilter {
    /// Names on the command line, in `Settings` and behind pictures.
    pub const NAMES: [(&'static str, TexelFilter); 8] = [
        ("bilinear", TexelFilter::Bilinear),
        ("nearest", TexelFilter::Nearest),
        ("bicubic", TexelFilter::Bicubic),
        ("trilinear", TexelFilter::Trilinear),
        ("sat", TexelFilter::Sat),
        ("ewa", TexelFilter::Ewa),
        ("feline", TexelFilter::Feline),
        ("stochastic", TexelFilter::Stochastic),
    ];

    /// Whether it depends on what a sample covers.
    pub fn wants_footprint(self) -> bool {
        !matches!(self, TexelFilter::Nearest | TexelFilter::Bilinear | TexelFilter::Bicubic)
    }

    /// Bytes of what it needs besides the texels of a picture in memory.
    pub(super) fn bytes(self, width: u32, height: u32) -> u64 {
        match self {
            TexelFilter::Sat => SummedAreaTable::bytes(width, height),
            filter if filter.uses_pyramid() => Pyramid::bytes(u64::from(width) * u64::from(height)),
            _ => 0,
        }
    }

    fn uses_pyramid(self) -> bool {
        matches!(self, TexelFilter::Trilinear | TexelFilter::Ewa | TexelFilter::Feline)
    }
}

/// How much longer than wide an ellipse may be.
const MOST_ANISOTROPY: f32 = 16.0;

/// Variance of the weights of an ellipse along an axis of length 1.
const KERNEL_VARIANCE: f32 = 0.085_136_4;

/// Variance of the mean over one texel in terms of that.
const TEXEL_VARIANCE: f32 = 1.0 / 12.0 / KERNEL_VARIANCE;

/// Variance of bilinear weights in terms of that.
pub(super) const BILINEAR_VARIANCE: f32 = 1.0 / 6.0 / KERNEL_VARIANCE;

/// How far an ellipse may reach on its level, in texels: farther than any that is not held up by a narrow picture.
const MOST_REACH: f32 = 72.0;

/// By how much the exponent of the weights falls to the rim.
const FALL: f32 = 5.5;

impl Picture {
    /// Bytes that [`Picture::prepare`] would take.
    pub(crate) fn preparation(&self, filter: TexelFilter) -> u64 {
        let is_there = match filter {
            TexelFilter::Sat => self.sums.get().is_some(),
            _ => self.pyramid.get().is_some() || self.resident().is_none(),
        };
        if is_there { 0 } else { filter.bytes(self.width, self.height) }
    }

    /// Makes what a filter needs besides the texels, unless it has been made.
    pub(crate) fn prepare(&self, filter: TexelFilter) {
        if filter == TexelFilter::Sat {
            self.sums.get_or_init(|| SummedAreaTable::of(self));
        } else if filter.uses_pyramid() && self.resident().is_some() {
            self.pyramid.get_or_init(|| Pyramid::of(self));
        }
    }

    fn level(&self, level: usize) -> LevelView<'_> {
        let texels = match &self.texels {
            Texels::Resident(texels) => texels,
            Texels::Tiled(tiled) => {
                let tiled = tiled.level(level);
                let [width, height] = tiled.size();
                return LevelView { width, height, texels: LevelTexels::Tiled(tiled) };
            }
        };
        let above = self.pyramid.get().and_then(|pyramid| pyramid.levels.get(level.checked_sub(1)?));
        let (width, height, texels) = match above {
            Some(level) => (level.width, level.height, &level.texels),
            None => (self.width, self.height, texels),
        };
        LevelView { width, height, texels: LevelTexels::Resident(texels) }
    }

    /// The number of the smallest level.
    fn top(&self) -> usize {
        match &self.texels {
            Texels::Resident(_) => self.pyramid.get().map_or(0, |pyramid| pyramid.levels.len()),
            Texels::Tiled(tiled) => tiled.top(),
        }
    }
}

/// A level of the pyramid.
struct LevelView<'a> {
    width: u32,
    height: u32,
    texels: LevelTexels<'a>,
}

enum LevelTexels<'a> {
    Resident(&'a [[u16; 4]]),
    Tiled(TiledLevel<'a>),
}

/// In how many parts of `r^2` the weights of an ellipse are known: within 0.003 of their formula, which is 1 in the middle.
const KERNEL_PARTS: f32 = 1024.0;

/// Weights of an ellipse by `r^2`.
fn kernel() -> &'static [f32; KERNEL_PARTS as usize] {
    static KERNEL: LazyLock<[f32; KERNEL_PARTS as usize]> = LazyLock::new(|| {
        let weight = |r2: f32| fmath::exp(-FALL * r2) - fmath::exp(-FALL);
        std::array::from_fn(|i| weight((i as f32 + 0.5) / KERNEL_PARTS))
    });
    &KERNEL
}

/// The largest whole number that is not more, as `f32::floor` has it.
#[inline]
pub(super) fn floor(x: f32) -> i64 {
    let whole = x as i64;
    whole.saturating_sub(i64::from(whole as f32 > x))
}

/// The least whole number that is not less.
#[inline]
pub(super) fn ceil(x: f32) -> i64 {
    floor(-x).saturating_neg()
}

/// A texel as numbers in [0, 1].
#[inline]
fn unit(texel: [u16; 4]) -> [f32; 4] {
    texel.map(|v| f32::from(v) * (1.0 / 65535.0))
}

impl LevelView<'_> {
    /// The texels of a row from one column to another, where all of them are there, side by side in memory.
    #[inline]
    fn run(&self, row: Option<usize>, first: i64, last: i64) -> Option<&[[u16; 4]]> {
        let LevelTexels::Resident(texels) = self.texels else { return None };
        let (first, last) = (usize::try_from(first).ok()?, usize::try_from(last).ok()?);
        if last >= self.width as usize {
            return None;
        }
        texels[row? * self.width as usize..].get(first..=last)
    }

    #[inline]
    fn texel(&self, x: Option<usize>, y: Option<usize>, wrap: [Wrap; 2]) -> [f32; 4] {
        match (x, y) {
            (Some(x), Some(y)) => {
                let texel = match &self.texels {
                    LevelTexels::Resident(texels) => texels[y * self.width as usize + x],
                    LevelTexels::Tiled(level) => level.texel(x, y),
                };
                unit(texel)
            }
            (None, _) => wrap[0].beside(),
            (_, None) => wrap[1].beside(),
        }
    }

    /// The bilinear mean at a place of the picture's own.
    fn bilinear(&self, s: Vec2, wrap: [Wrap; 2]) -> [f32; 4] {
        let (w, h) = (self.width, self.height);
        let x = wrap[0].coordinate(s.x) * w as f32 - 0.5;
        let y = (1.0 - wrap[1].coordinate(s.y)) * h as f32 - 0.5;
        let (i, j) = (x.floor(), y.floor());
        let (a, b) = (x - i, y - j);
        let (i, j) = (i as i64, j as i64);
        let texel = |i: i64, j: i64| self.texel(wrap[0].index(i, w), wrap[1].index(j, h), wrap);
        let corners = [texel(i, j), texel(i + 1, j), texel(i, j + 1), texel(i + 1, j + 1)];
        let weights = [(1.0 - a) * (1.0 - b), a * (1.0 - b), (1.0 - a) * b, a * b];
        std::array::from_fn(|c| corners.iter().zip(weights).map(|(corner, weight)| weight * corner[c]).sum())
    }
}

/// A footprint in texels, by the axes of its ellipse.
#[derive(Clone, Copy, Debug)]
struct Ellipse {
    /// `J J'`: xx, xy, yy.
    m: [f32; 3],
    /// The longer half axis and its unit direction.
    major: f32,
    along: Vec2,
    minor: f32,
}

impl Ellipse {
    /// That of `x = J c` for `|c| <= 1`, no longer than [`MOST_ANISOTROPY`] allows.
    fn new([j0, j1]: [Vec2; 2]) -> Ellipse {
        let (xx, xy, yy) = (j0.x * j0.x + j1.x * j1.x, j0.x * j0.y + j1.x * j1.y, j0.y * j0.y + j1.y * j1.y);
        // Eigenvalues of a symmetric matrix; the smaller one by the determinant, without cancellation.
        let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let root = (half * half + xy * xy).sqrt();
        let largest = mean + root;
        let determinant = j0.perp_dot(j1);
        let smallest = if largest > 0.0 { determinant * determinant / largest } else { 0.0 };
        let along = if half >= 0.0 { Vec2::new(half + root, xy) } else { Vec2::new(xy, root - half) };
        let along = along.normalize_or(Vec2::X);
        let major = largest.sqrt();
        let minor = smallest.sqrt().max(major / MOST_ANISOTROPY);
        let widened = minor * minor - smallest;
        let across = Vec2::new(-along.y, along.x);
        let m = [
            xx + widened * across.x * across.x,
            xy + widened * across.x * across.y,
            yy + widened * across.y * across.y,
        ];
        Ellipse { m, major, along, minor }
    }

    /// The level of the pyramid whose texels suit its width.
    fn level(&self) -> usize {
        (fmath::ln((0.5 * self.minor).max(1.0)) / std::f32::consts::LN_2) as usize
    }
}

impl PictureMap {
    /// Red, green, blue and alpha of what a sample covers, linear and in [0, 1].
    #[inline]
    pub fn filtered(&self, at: &TextureContext) -> [f32; 4] {
        if !self.filter.wants_footprint() {
            return self.at(at.uv);
        }
        let texel = self.tiling.show(self.picture_uv(at.uv), self.picture.mean, |s| self.over(s, at));
        std::array::from_fn(|c| self.factor[c] * texel[c])
    }

    /// The footprint in texels.
    pub(super) fn axes(&self, at: &TextureContext) -> [Vec2; 2] {
        at.footprint.on(self.set).map(|duv| {
            let ds = duv * self.repeat + self.cross * Vec2::new(duv.y, duv.x);
            Vec2::new(ds.x, -ds.y) * self.extent()
        })
    }

    /// Columns and rows of texels.
    fn extent(&self) -> Vec2 {
        Vec2::from(self.picture.size().map(|n| n as f32))
    }

    #[inline(never)]
    fn over(&self, s: Vec2, at: &TextureContext) -> [f32; 4] {
        let axes = self.axes(at);
        let is_usable = axes.iter().all(|axis| axis.is_finite() && axis.length_squared().is_finite());
        if !is_usable || axes == [Vec2::ZERO; 2] || !s.is_finite() {
            return self.picture.level(0).bilinear(s, self.wrap);
        }
        match self.filter {
            TexelFilter::Trilinear => {
                let width = axes[0].length_squared().max(axes[1].length_squared()).sqrt();
                self.trilinear(s, width)
            }
            TexelFilter::Sat => self.boxed(s * self.extent(), axes, self.extent()),
            TexelFilter::Feline => self.probed(s, &Ellipse::new(axes), self.extent()),
            TexelFilter::Stochastic => self.drawn(s, &axes, at),
            _ => self.elliptic(s, &Ellipse::new(axes)),
        }
    }

    /// * `width`: of the square, in texels
    fn trilinear(&self, s: Vec2, width: f32) -> [f32; 4] {
        let top = self.picture.top();
        let level = (fmath::ln(width.max(1.0)) / std::f32::consts::LN_2).min(top as f32);
        let (below, t) = (level as usize, level.fract());
        let fine = self.picture.level(below).bilinear(s, self.wrap);
        if t == 0.0 {
            return fine;
        }
        let coarse = self.picture.level(below + 1).bilinear(s, self.wrap);
        std::array::from_fn(|c| fine[c] + t * (coarse[c] - fine[c]))
    }

    /// * `x`: in texels, upwards
    fn boxed(&self, x: Vec2, [j0, j1]: [Vec2; 2], size: Vec2) -> [f32; 4] {
        let Some(table) = self.picture.sums.get() else {
            return self.picture.level(0).bilinear(x / size, self.wrap);
        };
        let middle = Vec2::new(x.x, size.y - x.y);
        // Sums of more than this lose the fractions of texels.
        let half = (0.5 * (j0.abs() + j1.abs())).clamp(Vec2::splat(0.5), 4096.0 * size);
        let (low, high) = (middle - half, middle + half);
        if !low.cmplt(high).all() {
            return self.picture.level(0).bilinear(x / size, self.wrap);
        }
        let mut mean = table.mean(low, high, self.wrap);
        if self.wrap.contains(&Wrap::Black) {
            let is_edged = |wrap: Wrap| matches!(wrap, Wrap::Black | Wrap::Once);
            let inside = |i: usize| match is_edged(self.wrap[i]) {
                true => (high[i].min(size[i]) - low[i].max(0.0)).max(0.0) / (high[i] - low[i]),
                false => 1.0,
            };
            mean[3] = (mean[3] + 1.0 - inside(0) * inside(1)).min(1.0);
        }
        mean
    }

    fn elliptic(&self, s: Vec2, ellipse: &Ellipse) -> [f32; 4] {
        let number = ellipse.level();
        if number >= self.picture.top() && number > 0 {
            // All of the picture is about a texel.
            return self.picture.level(self.picture.top()).bilinear(s, self.wrap);
        }
        let level = self.picture.level(number);
        let scale = Vec2::new(
            level.width as f32 / self.picture.width as f32,
            level.height as f32 / self.picture.height as f32,
        );
        let squared = scale * scale;
        // M of the level: what the texels themselves blur is left out.
        let own = BILINEAR_VARIANCE * squared - TEXEL_VARIANCE * (1.0 - squared);
        let [xx, xy, yy] = ellipse.m;
        let (xx, xy, yy) = (squared.x * xx + own.x, scale.x * scale.y * xy, squared.y * yy + own.y);
        // Levels of narrow pictures are narrow too, and no smaller than a texel.
        let [kx, ky] = [xx, yy].map(|v| (MOST_REACH / v.sqrt()).min(1.0));
        let (xx, xy, yy) = (kx * kx * xx, kx * ky * xy, ky * ky * yy);
        let determinant = xx * yy - xy * xy;
        if determinant.is_nan() || determinant <= 0.0 {
            return level.bilinear(s, self.wrap);
        }
        let conic = [yy / determinant, -2.0 * xy / determinant, xx / determinant];
        let center = Vec2::new(s.x, 1.0 - s.y) * Vec2::new(level.width as f32, level.height as f32) - 0.5;
        let mean = self.mean_within(&level, center, conic, yy);
        mean.unwrap_or_else(|| level.bilinear(s, self.wrap))
    }

    /// The mean over the texels of a level within an ellipse; `None` where there is none.
    ///
    /// * `center`: in texels, downwards
    /// * `[a, b, c]`: of `a x^2 + b x y + c y^2 < 1` around it
    /// * `yy`: the square of how far it reaches up and down
    fn mean_within(
        &self,
        level: &LevelView<'_>,
        center: Vec2,
        [a, b, c]: [f32; 3],
        yy: f32,
    ) -> Option<[f32; 4]> {
        let reach = yy.sqrt();
        let kernel = kernel();
        let (mut sum, mut weights) = ([0.0; 4], 0.0);
        for j in ceil(center.y - reach)..=floor(center.y + reach) {
            let y = j as f32 - center.y;
            // Where the row enters the ellipse and leaves it.
            let (middle, half) = (-0.5 * b * y / a, ((1.0 - y * y / yy) / a).max(0.0).sqrt());
            let row = self.wrap[1].index_far(j, level.height);
            let low = center.x + middle;
            let weight = |i: i64| {
                let x = i as f32 - center.x;
                let r2 = (a * x + b * y) * x + c * y * y;
                kernel.get((KERNEL_PARTS * r2) as usize).copied()
            };
            let mut add = |weight: f32, texel: [f32; 4]| {
                (0..4).for_each(|c| sum[c] += weight * texel[c]);
                weights += weight;
            };
            let (first, last) = (ceil(low - half), floor(low + half));
            if let Some(texels) = level.run(row, first, last) {
                for (i, texel) in (first..).zip(texels) {
                    if let Some(weight) = weight(i) {
                        add(weight, unit(*texel));
                    }
                }
                continue;
            }
            for i in first..=last {
                if let Some(weight) = weight(i) {
                    add(weight, level.texel(self.wrap[0].index_far(i, level.width), row, self.wrap));
                }
            }
        }
        (weights > 0.0).then(|| sum.map(|sum| (sum / weights).min(1.0)))
    }

    fn probed(&self, s: Vec2, ellipse: &Ellipse, size: Vec2) -> [f32; 4] {
        let major = ellipse.major.max(1.0);
        let minor = ellipse.minor.max(1.0);
        let count = (2.0 * major / minor - 1.0).round().max(1.0);
        let n = count as u32;
        // So many probes as wide as this cover the ellipse.
        let width = minor.max(2.0 * major / (count + 1.0));
        let step = if n > 1 { 2.0 * (major - width) / (count - 1.0) } else { 0.0 };
        let (mut sum, mut weights) = ([0.0; 4], 0.0);
        for k in 0..n {
            let distance = (k as f32 - 0.5 * (count - 1.0)) * step;
            let offset = distance * ellipse.along / size;
            let weight = fmath::exp(-2.0 * (distance / major) * (distance / major));
            let probe = self.trilinear(s + Vec2::new(offset.x, -offset.y), width);
            (0..4).for_each(|c| sum[c] += weight * probe[c]);
            weights += weight;
        }
        sum.map(|sum| (sum / weights).min(1.0))
    }

    /// One texel: a Gaussian step within the footprint, and one of the four around with its bilinear weight.
    fn drawn(&self, s: Vec2, axes: &[Vec2; 2], at: &TextureContext) -> [f32; 4] {
        // The numbers are a function of the point, which is another one for each sample.
        let name = u64::from(s.x.to_bits()) << 32 | u64::from(s.y.to_bits());
        let point = [at.p.x.to_bits(), at.p.y.to_bits()];
        let stream = Stream::new(name, point, at.p.z.to_bits() ^ at.time.to_bits().rotate_left(16));
        let radius = (-2.0 * KERNEL_VARIANCE * fmath::ln(1.0 - stream.uniform(0))).sqrt();
        let (sin, cos) = fmath::sin_cos(std::f32::consts::TAU * stream.uniform(1));
        let (w, h) = (self.picture.width, self.picture.height);
        let center = Vec2::new(s.x, 1.0 - s.y) * Vec2::new(w as f32, h as f32);
        let center = center + radius * (cos * axes[0] + sin * axes[1]);
        let texel = center - 0.5 + Vec2::new(stream.uniform(2), stream.uniform(3));
        let (i, j) = (texel.x.floor() as i64, texel.y.floor() as i64);
        let [across, up] = self.wrap;
        self.picture.level(0).texel(across.index_far(i, w), up.index_far(j, h), self.wrap)
    }

    /// The surface through the sixteen texels around a place, by Catmull and Rom's cubics.
    pub(super) fn bicubic(&self, s: Vec2) -> [f32; 4] {
        let level = self.picture.level(0);
        let [across, up] = self.wrap;
        let x = across.coordinate(s.x) * level.width as f32 - 0.5;
        let y = (1.0 - up.coordinate(s.y)) * level.height as f32 - 0.5;
        let (i, j) = (x.floor(), y.floor());
        let (wx, wy) = (cubic_weights(x - i), cubic_weights(y - j));
        let mut sum = [0.0; 4];
        for (row, wy) in (j as i64 - 1..).zip(wy) {
            let row = up.index_far(row, level.height);
            for (column, wx) in (i as i64 - 1..).zip(wx) {
                let texel = level.texel(across.index_far(column, level.width), row, self.wrap);
                (0..4).for_each(|c| sum[c] += wx * wy * texel[c]);
            }
        }
        sum.map(|v| v.clamp(0.0, 1.0))
    }
}

/// Weights of the four texels around the part `t` of the way from the second one to the third [Keys 1981, eq. 4, a = -1/2].
fn cubic_weights(t: f32) -> [f32; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [
        0.5 * (-t + 2.0 * t2 - t3),
        0.5 * (2.0 - 5.0 * t2 + 3.0 * t3),
        0.5 * (t + 4.0 * t2 - 3.0 * t3),
        0.5 * (t3 - t2),
    ]
}

/// The level that is looked up for a footprint in texels.
#[cfg(test)]
pub(super) fn level_of(axes: [Vec2; 2]) -> usize {
    Ellipse::new(axes).level()
}
