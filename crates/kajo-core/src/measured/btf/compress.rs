//! Compression by principal components of clusters.
//!
//! Texels are first gathered around means that are near to them (k-means [Lloyd 1982]), then each goes to the cluster whose mean and
//! components leave the least of it [Kambhatla and Leen 1997; Müller et al. 2003], and both are found anew, some times
//! over. With one cluster the error is the least that any such number of components leaves. With as many clusters as
//! texels nothing is lost.

use kajo_math::principal::principal_directions;

use super::BtfFile;
use super::file::levels;

/// Rounds of k-means at most.
const MEAN_ROUNDS: usize = 20;
/// Rounds in which clusters are fitted with their components.
const FIT_ROUNDS: usize = 3;

/// A texture as it is measured: a value for each texel, view and light.
#[derive(Clone, Debug, PartialEq)]
pub struct BtfSamples {
    /// Width and height in texels.
    pub size: [u32; 2],
    /// Angles of the directions to the viewer: to the normal, and from u towards v; radians.
    pub views: Vec<[f32; 2]>,
    /// Angles of the directions to the light.
    pub lights: Vec<[f32; 2]>,
    /// Whether values have the cosine of the light in them.
    pub has_cosine: bool,
    /// `[row, column][view][light][r, g, b]`, rows from above; per steradian.
    pub values: Vec<f32>,
}

/// How much is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Compression {
    /// Clusters of texels, at least 1 and at most 65,536; never more than there are texels.
    pub clusters: u32,
    /// Principal components of each, at most 1024.
    pub components: u32,
}

impl Default for Compression {
    fn default() -> Compression {
        Compression { clusters: 8, components: 8 }
    }
}

/// A cluster while it is fitted.
#[derive(Clone, Default)]
struct Fit {
    mean: Vec<f32>,
    components: Vec<Vec<f64>>,
}

impl BtfSamples {
    /// Numbers of a texel.
    fn width(&self) -> usize {
        3 * self.views.len() * self.lights.len()
    }
}

/// Compresses a texture with all its smaller copies.
///
/// * `samples`: at least one texel, one view and one light, and as many values as these are
///
/// The copies are averages of the samples, not of what is left of them.
pub fn compress(samples: &BtfSamples, kept: &Compression) -> BtfFile {
    let width = samples.width();
    let count = (samples.values.len() / width).max(1);
    let n_clusters = (kept.clusters.max(1) as usize).min(count).min(1 << 16);
    let mut owners = nearest_means(&samples.values, width, n_clusters);
    let mut fits = fitted(&samples.values, width, &owners, n_clusters, kept.components as usize);
    if kept.components > 0 && n_clusters > 1 {
        for _ in 0..FIT_ROUNDS {
            owners = samples.values.chunks_exact(width).map(|texel| best(texel, &fits)).collect();
            fits = fitted(&samples.values, width, &owners, n_clusters, kept.components as usize);
        }
    }
    let components = fits.iter().map(|fit| fit.components.len()).max().unwrap_or(0);
    let mut file = BtfFile {
        size: samples.size,
        views: samples.views.clone(),
        lights: samples.lights.clone(),
        has_cosine: samples.has_cosine,
        components: components as u32,
        clusters: Vec::new(),
        texel_clusters: Vec::new(),
        texel_weights: Vec::new(),
    };
    for fit in &fits {
        file.clusters.extend(&fit.mean);
        file.clusters.extend(fit.components.iter().flatten().map(|&v| v as f32));
        file.clusters.resize(file.clusters.len() + (components - fit.components.len()) * width, 0.0);
    }
    // The largest level has its clusters already, those of smaller ones are found.
    store(&mut file, &samples.values, width, &fits, |texel, _| owners[texel]);
    let mut smaller = Vec::new();
    for (i, pair) in levels(samples.size).windows(2).enumerate() {
        smaller = halved(if i == 0 { &samples.values } else { &smaller }, width, pair[0], pair[1]);
        store(&mut file, &smaller, width, &fits, |_, values| best(values, &fits));
    }
    file
}

/// Adds texels with the weights of their components.
fn store(
    file: &mut BtfFile,
    values: &[f32],
    width: usize,
    fits: &[Fit],
    owner: impl Fn(usize, &[f32]) -> usize,
) {
    for (texel, values) in values.chunks_exact(width).enumerate() {
        let owner = owner(texel, values);
        let Fit { mean, components } = &fits[owner];
        let weight = |component: &Vec<f64>| {
            let parts = values.iter().zip(mean).zip(component);
            parts.map(|((&v, &m), &e)| (f64::from(v) - f64::from(m)) * e).sum::<f64>() as f32
        };
        file.texel_clusters.push(owner as u16);
        file.texel_weights.extend(components.iter().map(weight));
        let missing = file.components as usize - components.len();
        file.texel_weights.resize(file.texel_weights.len() + missing, 0.0);
    }
}

fn squared_distance(a: &[f32], b: &[f32]) -> f64 {
    a.iter().zip(b).map(|(&a, &b)| (f64::from(a) - f64::from(b)) * (f64::from(a) - f64::from(b))).sum()
}

/// The number of the least value, the first of equal ones.
fn least(values: impl Iterator<Item = f64>) -> usize {
    let mut best = (0, f64::INFINITY);
    for (i, value) in values.enumerate() {
        if value < best.1 {
            best = (i, value);
        }
    }
    best.0
}

/// The cluster whose mean and components leave the least of a texel.
fn best(texel: &[f32], fits: &[Fit]) -> usize {
    least(fits.iter().map(|fit| {
        let all = squared_distance(texel, &fit.mean);
        let captured = fit.components.iter().map(|component| {
            let parts = texel.iter().zip(&fit.mean).zip(component);
            let share: f64 = parts.map(|((&v, &m), &e)| (f64::from(v) - f64::from(m)) * e).sum();
            share * share
        });
        all - captured.sum::<f64>()
    }))
}

/// Means and components of clusters; an empty one has neither.
fn fitted(values: &[f32], width: usize, owners: &[usize], n: usize, components: usize) -> Vec<Fit> {
    let mut fits = vec![Fit::default(); n];
    for (cluster, fit) in fits.iter_mut().enumerate() {
        let members = values.chunks_exact(width).zip(owners).filter(|&(_, &owner)| owner == cluster);
        let mut own: Vec<f32> = members.flat_map(|(texel, _)| texel.iter().copied()).collect();
        fit.mean = mean(&own, width);
        own.chunks_exact_mut(width).for_each(|texel| {
            texel.iter_mut().zip(&fit.mean).for_each(|(v, m)| *v -= m);
        });
        fit.components = principal_directions(&own, width, components);
    }
    fits
}

fn mean(values: &[f32], width: usize) -> Vec<f32> {
    let mut sums = vec![0.0; width];
    for texel in values.chunks_exact(width) {
        texel.iter().zip(&mut sums).for_each(|(&v, sum)| *sum += f64::from(v));
    }
    let count = (values.len() / width).max(1) as f64;
    sums.iter().map(|sum| (sum / count) as f32).collect()
}

/// The cluster of each texel by k-means. Means begin at texels that are farthest from those before.
fn nearest_means(values: &[f32], width: usize, n: usize) -> Vec<usize> {
    let texels: Vec<&[f32]> = values.chunks_exact(width).collect();
    if n >= texels.len() {
        return (0..texels.len()).collect();
    }
    let mut means = vec![mean(values, width)];
    let mut distances: Vec<f64> = texels.iter().map(|t| squared_distance(t, &means[0])).collect();
    while means.len() < n {
        let farthest = least(distances.iter().map(|d| -d));
        let next = texels[farthest].to_vec();
        for (distance, texel) in distances.iter_mut().zip(&texels) {
            *distance = distance.min(squared_distance(texel, &next));
        }
        means.push(next);
    }
    let mut owners = Vec::new();
    for _ in 0..MEAN_ROUNDS {
        let now: Vec<usize> =
            texels.iter().map(|t| least(means.iter().map(|m| squared_distance(t, m)))).collect();
        if now == owners {
            break;
        }
        owners = now;
        let fits = fitted(values, width, &owners, n, 0);
        let kept = |(mean, fit): (&Vec<f32>, Fit), cluster: usize| {
            if owners.contains(&cluster) { fit.mean } else { mean.clone() }
        };
        means = means.iter().zip(fits).enumerate().map(|(i, pair)| kept(pair, i)).collect();
    }
    owners
}

/// A copy of another size, at most as large, each texel of it the mean of the area that it covers.
fn halved(values: &[f32], width: usize, [w, h]: [u32; 2], [to_w, to_h]: [u32; 2]) -> Vec<f32> {
    let across = shares(w, to_w);
    let down = shares(h, to_h);
    let mut all = Vec::new();
    for (rows, columns) in down.iter().flat_map(|rows| across.iter().map(move |columns| (rows, columns))) {
        let mut sum = vec![0.0f64; width];
        for (&(y, a), &(x, b)) in rows.iter().flat_map(|row| columns.iter().map(move |column| (row, column)))
        {
            let texel = &values[(y * w as usize + x) * width..][..width];
            texel.iter().zip(&mut sum).for_each(|(&v, sum)| *sum += a * b * f64::from(v));
        }
        all.extend(sum.iter().map(|&v| v as f32));
    }
    all
}

/// For each of `to` cells those of `from` that it covers, with their shares.
fn shares(from: u32, to: u32) -> Vec<Vec<(usize, f64)>> {
    let ratio = f64::from(from) / f64::from(to);
    let covered = |i: u32| {
        let (low, high) = (f64::from(i) * ratio, f64::from(i + 1) * ratio);
        let share = |j: u32| (high.min(f64::from(j + 1)) - low.max(f64::from(j))) / ratio;
        (0..from).map(|j| (j as usize, share(j))).filter(|&(_, share)| share > 1e-9).collect()
    };
    (0..to).map(covered).collect()
}
