//! Principal components: the few directions along which many vectors differ most.
//!
//! Of all subspaces of `k` dimensions that of the first `k` right singular vectors leaves the least squared error, the sum of the
//! squares of the other singular values [Eckart and Young 1936]. It is found by multiplying a block of vectors by `XᵀX`
//! again and again, made orthonormal in between, and turned to the eigenvectors of what `XᵀX` is within the block (Rayleigh
//! and Ritz) [Halko, Martinsson and Tropp 2011]. Blocks are wider than asked for, which is what makes that fast.

use crate::rng::Stream;

/// Vectors of a block beyond those that are asked for.
const OVERSAMPLING: usize = 8;
/// Most multiplications.
const MAX_STEPS: usize = 300;
/// The captured energy has settled when a step adds less than this share of it.
const SETTLED: f64 = 1e-13;

/// The first `k` principal directions of the rows of `data` about the origin, orthonormal, the most important one first: fewer where
/// the rows span no more.
///
/// * `data`: rows of `width` numbers each
pub fn principal_directions(data: &[f32], width: usize, k: usize) -> Vec<Vec<f64>> {
    let rows = data.len().checked_div(width).unwrap_or(0);
    let n = (k + OVERSAMPLING).min(rows).min(width);
    if k == 0 || n == 0 {
        return Vec::new();
    }
    // Rows of the block are vectors. They begin at random, as the same numbers for everybody.
    let random = |i: usize, j: usize| f64::from(Stream::new(7, [i as u32, j as u32], 0).uniform(0)) - 0.5;
    let mut block: Vec<Vec<f64>> = (0..n).map(|i| (0..width).map(|j| random(i, j)).collect()).collect();
    orthonormalise(&mut block);
    let mut captured = 0.0;
    for _ in 0..MAX_STEPS {
        let image = multiplied(data, width, &block);
        let (energies, turned) = ritz(&block, &image);
        let energy: f64 = energies.iter().take(k).sum();
        block = turned;
        if energy - captured <= SETTLED * energy {
            block.truncate(energies.iter().take(k).filter(|&&e| e > 1e-14 * energies[0] && e > 0.0).count());
            return block;
        }
        captured = energy;
        block = multiplied(data, width, &block);
        orthonormalise(&mut block);
    }
    block.truncate(k);
    block
}

/// `XᵀX v` for each vector of a block.
fn multiplied(data: &[f32], width: usize, block: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut image = vec![vec![0.0; width]; block.len()];
    for row in data.chunks_exact(width) {
        for (v, out) in block.iter().zip(&mut image) {
            let share: f64 = row.iter().zip(v).map(|(&x, &v)| f64::from(x) * v).sum();
            row.iter().zip(out).for_each(|(&x, out)| *out += share * f64::from(x));
        }
    }
    image
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Modified Gram-Schmidt, twice. A vector that depends on those before it becomes zero.
fn orthonormalise(block: &mut [Vec<f64>]) {
    for i in 0..block.len() {
        let (before, rest) = block.split_at_mut(i);
        let v = &mut rest[0];
        let was = dot(v, v).sqrt();
        for _ in 0..2 {
            for u in before.iter() {
                let share = dot(u, v);
                v.iter_mut().zip(u).for_each(|(v, u)| *v -= share * u);
            }
        }
        let length = dot(v, v).sqrt();
        let scale = if length > 1e-12 * was && length > 0.0 { 1.0 / length } else { 0.0 };
        v.iter_mut().for_each(|v| *v *= scale);
    }
}

/// Eigenvalues of `VᵀAV`, the largest first, and the vectors of the block `V` turned to the eigenvectors.
fn ritz(block: &[Vec<f64>], image: &[Vec<f64>]) -> (Vec<f64>, Vec<Vec<f64>>) {
    let n = block.len();
    let small: Vec<f64> = (0..n * n).map(|i| dot(&block[i / n], &image[i % n])).collect();
    let (values, vectors) = symmetric_eigen(&small, n);
    let turned = |e: &Vec<f64>| {
        let mut v = vec![0.0; block[0].len()];
        for (share, u) in e.iter().zip(block) {
            v.iter_mut().zip(u).for_each(|(v, u)| *v += share * u);
        }
        v
    };
    (values, vectors.iter().map(turned).collect())
}

/// Eigenvalues of a symmetric matrix, the largest first, and orthonormal eigenvectors, by rotations that make one pair of other
/// elements vanish after the other [Jacobi 1846].
///
/// * `matrix`: `n x n`, of which the mean of both triangles counts
pub fn symmetric_eigen(matrix: &[f64], n: usize) -> (Vec<f64>, Vec<Vec<f64>>) {
    let mut a: Vec<f64> = (0..n * n).map(|i| 0.5 * (matrix[i] + matrix[i % n * n + i / n])).collect();
    let mut v: Vec<f64> = (0..n * n).map(|i| f64::from(u8::from(i / n == i % n))).collect();
    let scale: f64 = a.iter().map(|x| x * x).sum();
    for _ in 0..60 {
        let off: f64 = (0..n * n).filter(|i| i / n != i % n).map(|i| a[i] * a[i]).sum();
        if off <= 1e-30 * scale {
            break;
        }
        for (p, q) in (0..n).flat_map(|p| (p + 1..n).map(move |q| (p, q))) {
            if a[p * n + q] == 0.0 {
                continue;
            }
            let theta = (a[q * n + q] - a[p * n + p]) / (2.0 * a[p * n + q]);
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let c = 1.0 / (t * t + 1.0).sqrt();
            rotate(&mut a, &mut v, n, [p, q], [c, t * c]);
        }
    }
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&i, &j| a[j * n + j].total_cmp(&a[i * n + i]));
    let vector = |&i: &usize| (0..n).map(|k| v[k * n + i]).collect();
    (order.iter().map(|&i| a[i * n + i]).collect(), order.iter().map(vector).collect())
}

fn rotate(a: &mut [f64], v: &mut [f64], n: usize, [p, q]: [usize; 2], [c, s]: [f64; 2]) {
    for k in 0..n {
        let (x, y) = (a[k * n + p], a[k * n + q]);
        (a[k * n + p], a[k * n + q]) = (c * x - s * y, s * x + c * y);
    }
    for k in 0..n {
        let (x, y) = (a[p * n + k], a[q * n + k]);
        (a[p * n + k], a[q * n + k]) = (c * x - s * y, s * x + c * y);
        let (x, y) = (v[k * n + p], v[k * n + q]);
        (v[k * n + p], v[k * n + q]) = (c * x - s * y, s * x + c * y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(rows: usize, width: usize) -> Vec<f32> {
        // Singular values that fall off slowly, which is where subspaces are slow to find.
        let value = |i: usize| {
            let fade = 1.0 / (1.0 + (i % width) as f32 * 0.3);
            (Stream::new(11, [i as u32, 0], 0).uniform(0) - 0.5) * fade
        };
        (0..rows * width).map(value).collect()
    }

    /// The energy that all but the first `k` eigenvectors of `XᵀX` have.
    fn left_by_svd(data: &[f32], width: usize, k: usize) -> f64 {
        let mut gram = vec![0.0; width * width];
        for row in data.chunks_exact(width) {
            for (i, g) in gram.iter_mut().enumerate() {
                *g += f64::from(row[i / width]) * f64::from(row[i % width]);
            }
        }
        symmetric_eigen(&gram, width).0[k..].iter().sum()
    }

    fn left(data: &[f32], width: usize, k: usize) -> f64 {
        let basis = principal_directions(data, width, k);
        assert!(basis.len() <= k);
        let residual = |row: &[f32]| {
            let mut row: Vec<f64> = row.iter().map(|&x| f64::from(x)).collect();
            for b in &basis {
                let share = dot(b, &row);
                row.iter_mut().zip(b).for_each(|(x, b)| *x -= share * b);
            }
            dot(&row, &row)
        };
        data.chunks_exact(width).map(residual).sum()
    }

    #[test]
    fn the_error_is_that_of_the_singular_values() {
        for (rows, width) in [(200, 40), (30, 60), (50, 5)] {
            let data = noise(rows, width);
            for k in [1, 3, 8] {
                let k = k.min(width);
                let (found, least) = (left(&data, width, k), left_by_svd(&data, width, k));
                let all = left(&data, width, 0);
                assert!((found - least).abs() < 1e-6 * all, "{rows} x {width}, {k}: {found} {least}");
            }
        }
    }

    #[test]
    fn no_more_directions_than_the_rows_span() {
        let data: Vec<f32> = (0..40).map(|i| ((i / 4) * (i % 4)) as f32).collect();
        assert_eq!(principal_directions(&data, 4, 3).len(), 1);
        assert_eq!(principal_directions(&[0.0; 12], 4, 3).len(), 0);
        assert!(principal_directions(&[], 4, 3).is_empty() && principal_directions(&data, 4, 0).is_empty());
    }

    #[test]
    fn eigenvectors_are_orthonormal_and_give_the_matrix_back() {
        let n = 6;
        let matrix: Vec<f64> = (0..36)
            .map(|i| f64::from(((i / n) * (i % n)) as u32 % 5) + f64::from(u8::from(i / n == i % n)))
            .collect();
        let (values, vectors) = symmetric_eigen(&matrix, n);
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let expected = f64::from(u8::from(i == j));
            assert!((dot(&vectors[i], &vectors[j]) - expected).abs() < 1e-12);
            let sum: f64 = (0..n).map(|k| values[k] * vectors[k][i] * vectors[k][j]).sum();
            assert!((sum - matrix[i * n + j]).abs() < 1e-12);
        }
        assert!(values.windows(2).all(|pair| pair[0] >= pair[1]));
    }
}
