//! Bidirectional texture functions: what light does at each texel of a picture, for many directions to the viewer and the light
//! [Dana et al. 1999].
//!
//! A texel is a BRDF `f(wo, wi)`, known at pairs of a set of views and a set of lights. Texels are divided into clusters, and those
//! of a cluster are its mean and a few principal components, each with a weight of the texel's own [Müller et al. 2003]:
//!
//! ```text
//! f(x, wo, wi)  =  Σ_v Σ_l  b_v(wo) b_l(wi) [ m_c(v, l) + Σ_k w_k(x) e_ck(v, l) ]          c = c(x)
//! ```
//!
//! with the barycentric weights `b` of [`DirectionSet`]. Smaller copies of the texture are texels as well, of what is averaged over a
//! footprint. Values may have been measured with the cosine of the light in them, as photographs have it; it is divided out when
//! the tables are made, so that between directions it is that of the true direction, and light fades to nothing at the horizon.
//!
//! Directions are drawn, for one of the three views around `wo`, by a histogram of the mean of all texels over
//! cosine-weighted cells.

mod compress;
mod error;
mod file;
mod reader;
mod ubo2014;

pub use compress::{BtfSamples, Compression, compress};
pub use error::BtfError;
pub use file::{BtfEncoding, BtfFile, read_btf, write_btf};
pub use ubo2014::read_ubo2014;

use std::f32::consts::{FRAC_1_PI, PI, TAU};
use std::fmt;

use kajo_math::piecewise::Piecewise2D;
use kajo_math::{Vec2, Vec3, fmath};

use super::DirectionSet;

/// Cells of the histogram that directions are drawn by: around the normal, and from there to the horizon.
const LOBE_CELLS: [usize; 2] = [32, 16];

/// The share of directions that are drawn by the cosine alone.
const PLAIN_SHARE: f32 = 0.1;

/// A bidirectional texture function, ready to be evaluated.
#[derive(Clone)]
pub struct Btf {
    views: DirectionSet,
    lights: DirectionSet,
    /// Principal components of each cluster.
    components: usize,
    clusters: Vec<Cluster>,
    levels: Vec<Level>,
    /// Of each texel, level by level.
    texel_clusters: Vec<u16>,
    /// `components` weights of each texel.
    texel_weights: Vec<f32>,
    /// For each view, where light comes from on the mean.
    lobes: Vec<Piecewise2D>,
    mean_albedo: [f32; 3],
}

/// The mean of a cluster and its components.
#[derive(Clone, Debug)]
struct Cluster {
    /// `[view][light][0 for the mean, then components][r, g, b]`, without the cosine.
    basis: Vec<f32>,
    /// `[view][...][r, g, b]`: the share of light from everywhere that goes to the view.
    albedo: Vec<f32>,
}

/// A copy of the texture at half the size of the one before.
#[derive(Clone, Copy, Debug)]
struct Level {
    size: [u32; 2],
    /// Its first texel.
    first: u32,
}

/// A texel of any level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Texel(u32);

impl fmt::Debug for Btf {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Btf").field("levels", &self.levels).finish_non_exhaustive()
    }
}

impl Btf {
    /// Makes tables of what a file holds.
    ///
    /// # Errors
    /// [`BtfError`], for directions that cannot be interpolated and numbers that contradict each other.
    pub fn new(file: BtfFile) -> Result<Btf, BtfError> {
        file.check()?;
        let views = DirectionSet::new(&file.views).map_err(BtfError::Views)?;
        let lights = DirectionSet::new(&file.lights).map_err(BtfError::Lights)?;
        let n = 1 + file.components as usize;
        let (n_views, n_lights) = (file.views.len(), file.lights.len());
        let quadrature = quadrature(&lights);
        let divisors: Vec<f32> = lights.directions().iter().map(|w| w.z).collect();
        let cluster = |values: &[f32]| {
            let mut basis = vec![0.0; values.len()];
            for (i, &value) in values.iter().enumerate() {
                // From [component][view][light][rgb].
                let (rgb, pair, k) = (i % 3, i / 3 % (n_views * n_lights), i / (3 * n_views * n_lights));
                let divisor = if file.has_cosine { divisors[pair % n_lights] } else { 1.0 };
                basis[(pair * n + k) * 3 + rgb] = value / divisor;
            }
            let albedo = albedo_of(&basis, &quadrature, 3 * n);
            Cluster { basis, albedo }
        };
        let clusters: Vec<Cluster> =
            file.clusters.chunks_exact(n * n_views * n_lights * 3).map(cluster).collect();
        let mut first = 0;
        let level = |&size: &[u32; 2]| {
            let level = Level { size, first };
            first += size[0] * size[1];
            level
        };
        let levels = file.levels().iter().map(level).collect();
        let mut btf = Btf {
            views,
            lights,
            components: n - 1,
            clusters,
            levels,
            texel_clusters: file.texel_clusters,
            texel_weights: file.texel_weights,
            lobes: Vec::new(),
            mean_albedo: [0.0; 3],
        };
        btf.average();
        Ok(btf)
    }

    /// Works out what the texels of the largest level are on the mean.
    fn average(&mut self) {
        let n = 1 + self.components;
        let [width, height] = self.size();
        let count = (width * height) as usize;
        // The mean texel has a weight for each component of each cluster.
        let mut shares = vec![0.0f64; n * self.clusters.len()];
        for (texel, &cluster) in self.texel_clusters[..count].iter().enumerate() {
            let at = usize::from(cluster) * n;
            shares[at] += 1.0;
            let weights = &self.texel_weights[texel * (n - 1)..][..n - 1];
            weights.iter().zip(&mut shares[at + 1..]).for_each(|(&w, share)| *share += f64::from(w));
        }
        shares.iter_mut().for_each(|share| *share /= count as f64);
        let mean = |table: fn(&Cluster) -> &[f32], at: usize| {
            let sum = |rgb: usize| {
                let of = |(i, share): (usize, &f64)| {
                    share * f64::from(table(&self.clusters[i / n])[(at * n + i % n) * 3 + rgb])
                };
                shares.iter().enumerate().map(of).sum::<f64>() as f32
            };
            [sum(0), sum(1), sum(2)]
        };
        let n_lights = self.lights.directions().len();
        let directions = lobe_directions();
        let lobes = (0..self.views.directions().len()).map(|view| {
            let row: Vec<f32> = (0..n_lights)
                .map(|light| mean(|c| &c.basis, view * n_lights + light).iter().sum::<f32>().max(0.0))
                .collect();
            lobe(&row, &directions, &self.lights)
        });
        let lobes = lobes.collect();
        let straight = self.views.weights(Vec3::Z);
        let mut albedo = [0.0; 3];
        for (view, weight) in straight {
            let here = mean(|c| &c.albedo, view as usize);
            albedo = [0, 1, 2].map(|i| albedo[i] + weight * here[i]);
        }
        self.lobes = lobes;
        self.mean_albedo = albedo.map(|v| v.clamp(0.0, 1.0));
    }

    /// Width and height in texels.
    pub fn size(&self) -> [u32; 2] {
        self.levels[0].size
    }

    /// The number of copies of the texture, the largest one included.
    pub fn level_count(&self) -> usize {
        self.levels.len()
    }

    /// The albedo, straight on, of the mean of all texels; linear RGB in [0, 1].
    pub fn mean_albedo(&self) -> [f32; 3] {
        self.mean_albedo
    }

    /// The texel of a level at a column and a row from above, which repeat.
    #[inline]
    pub fn texel(&self, level: usize, x: i64, y: i64) -> Texel {
        let Level { size: [width, height], first } = self.levels[level.min(self.levels.len() - 1)];
        let (x, y) = (x.rem_euclid(i64::from(width)) as u32, y.rem_euclid(i64::from(height)) as u32);
        Texel(first + y * width + x)
    }

    /// Width and height of a level in texels.
    #[inline]
    pub fn level_size(&self, level: usize) -> [u32; 2] {
        self.levels[level.min(self.levels.len() - 1)].size
    }

    /// The BRDF of a texel in linear RGB, per steradian.
    ///
    /// * `wo`, `wi`: unit vectors above the surface
    #[inline]
    pub fn value(&self, Texel(texel): Texel, wo: Vec3, wi: Vec3) -> [f32; 3] {
        let (views, lights) = (self.views.weights(wo), self.lights.weights(wi));
        let n = 1 + self.components;
        let cluster = &self.clusters[usize::from(self.texel_clusters[texel as usize])];
        let n_lights = self.lights.directions().len();
        let mut sum = [0.0; 3];
        for (view, a) in views.into_iter().filter(|view| view.1 > 0.0) {
            for (light, b) in lights.into_iter().filter(|light| light.1 > 0.0) {
                let at = (view as usize * n_lights + light as usize) * n;
                let here = self.mixed(texel, &cluster.basis[3 * at..][..3 * n]);
                sum = [0, 1, 2].map(|i| sum[i] + a * b * here[i]);
            }
        }
        sum.map(|v| v.max(0.0))
    }

    /// The mean in a row of a cluster, and its components by the weights of a texel.
    #[inline]
    fn mixed(&self, texel: u32, row: &[f32]) -> [f32; 3] {
        let weights = &self.texel_weights[texel as usize * self.components..][..self.components];
        let mut sum = [row[0], row[1], row[2]];
        for (component, &w) in row[3..].chunks_exact(3).zip(weights) {
            sum = [0, 1, 2].map(|i| sum[i] + w * component[i]);
        }
        sum
    }

    /// The share of light from everywhere that goes to `wo` from a texel; linear RGB.
    pub fn albedo(&self, Texel(texel): Texel, wo: Vec3) -> [f32; 3] {
        let n = 1 + self.components;
        let cluster = &self.clusters[usize::from(self.texel_clusters[texel as usize])];
        let mut sum = [0.0; 3];
        for (view, weight) in self.views.weights(wo) {
            let here = self.mixed(texel, &cluster.albedo[view as usize * n * 3..][..3 * n]);
            sum = [0, 1, 2].map(|i| sum[i] + weight * here[i]);
        }
        sum.map(|v| v.max(0.0))
    }

    /// A direction above the surface for the viewer `wo`.
    ///
    /// * `uc`: uniform in [0, 1), chooses among views
    pub fn sample(&self, wo: Vec3, u: Vec2, uc: f32) -> Vec3 {
        let views = self.views.weights(wo);
        let mut uc = uc;
        let mut chosen = views[0].0;
        for (view, weight) in views.into_iter().filter(|view| view.1 > 0.0) {
            chosen = view;
            if uc < weight {
                break;
            }
            uc -= weight;
        }
        from_square(self.lobes[chosen as usize].sample(u).0)
    }

    /// Density per solid angle of [`Btf::sample`].
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let p = to_square(wi);
        let views = self.views.weights(wo).into_iter().filter(|view| view.1 > 0.0);
        let density: f32 = views.map(|(view, weight)| weight * self.lobes[view as usize].pdf(p)).sum();
        density * wi.z * FRAC_1_PI
    }

    /// Bytes of memory of all tables.
    pub fn bytes(&self) -> usize {
        let numbers = |list: &[f32]| size_of_val(list);
        let clusters: usize = self.clusters.iter().map(|c| numbers(&c.basis) + numbers(&c.albedo)).sum();
        let lobe = (LOBE_CELLS[0] + 1) * (LOBE_CELLS[1] + 1) * size_of::<f32>();
        clusters + size_of_val(&*self.texel_clusters) + numbers(&self.texel_weights) + self.lobes.len() * lobe
    }
}

/// A direction of the hemisphere from a point of the unit square; areas become cosine-weighted solid angles over π.
fn from_square(u: Vec2) -> Vec3 {
    let (sin, cos) = fmath::sin_cos(TAU * u.x);
    let r = u.y.sqrt();
    Vec3::new(r * cos, r * sin, (1.0 - u.y).max(0.0).sqrt())
}

/// The inverse of [`from_square`].
fn to_square(w: Vec3) -> Vec2 {
    let turn = fmath::atan2(w.y, w.x) * (1.0 / TAU);
    let turn = if turn < 0.0 { turn + 1.0 } else { turn };
    let below = 1.0f32.next_down();
    Vec2::new(turn.min(below), w.truncate().length_squared().min(below))
}

/// Directions within the cells of the histogram, four in each.
fn lobe_directions() -> Vec<Vec3> {
    let [width, height] = LOBE_CELLS.map(|n| 2 * n);
    let at = |i: usize| {
        Vec2::new(((i % width) as f32 + 0.5) / width as f32, ((i / width) as f32 + 0.5) / height as f32)
    };
    (0..width * height).map(|i| from_square(at(i))).collect()
}

/// The histogram of directions in proportion to values of the lights, and for a part to the cosine.
fn lobe(values: &[f32], directions: &[Vec3], lights: &DirectionSet) -> Piecewise2D {
    let [width, height] = LOBE_CELLS;
    let mut cells = vec![0.0; width * height];
    for (i, &w) in directions.iter().enumerate() {
        let value: f32 = lights.weights(w).into_iter().map(|(light, b)| b * values[light as usize]).sum();
        let (x, y) = (i % (2 * width) / 2, i / (2 * width) / 2);
        cells[x + width * y] += value;
    }
    let mean = cells.iter().sum::<f32>() / cells.len() as f32;
    let plain = if mean > 0.0 && mean.is_finite() { PLAIN_SHARE / (1.0 - PLAIN_SHARE) * mean } else { 1.0 };
    cells.iter_mut().for_each(|cell| *cell = if cell.is_finite() { *cell + plain } else { plain });
    Piecewise2D::new(&cells, width).expect("numbers above zero")
}

/// For each light its share in the integral of a function times the cosine.
fn quadrature(lights: &DirectionSet) -> Vec<f32> {
    let directions = lobe_directions();
    let mut sums = vec![0.0f64; lights.directions().len()];
    for &w in &directions {
        for (light, weight) in lights.weights(w) {
            sums[light as usize] += f64::from(weight);
        }
    }
    sums.iter().map(|sum| (sum * f64::from(PI) / directions.len() as f64) as f32).collect()
}

/// Sums over lights of rows of a cluster.
///
/// * `stride`: numbers of each pair
fn albedo_of(basis: &[f32], quadrature: &[f32], stride: usize) -> Vec<f32> {
    let mut albedo = Vec::new();
    for view in basis.chunks_exact(quadrature.len() * stride) {
        let mut sum = vec![0.0f64; stride];
        for (row, &q) in view.chunks_exact(stride).zip(quadrature) {
            row.iter().zip(&mut sum).for_each(|(&v, sum)| *sum += f64::from(v) * f64::from(q));
        }
        albedo.extend(sum.iter().map(|&v| v as f32));
    }
    albedo
}

#[cfg(test)]
pub(crate) mod tests;
