//! Functions of two numbers, and of parameters, that are known at the nodes of a grid; and drawing in proportion to them.
//!
//! Between nodes of the unit square a function is bilinear, between its parameters linear. As a density it has marginals that are
//! linear in pieces, so that the integrals of these are inverted by square roots [Dupuy and Jakob 2018, supplement].

use kajo_math::Vec2;

/// What a function is between slices of its parameters: four of them with their shares, which add up to 1.
pub type Slices = [(usize, f32); 4];

/// A function, or several of the same parameters.
#[derive(Clone)]
pub struct WarpGrid {
    /// Nodes along x and y.
    size: [usize; 2],
    /// Functions of each slice.
    channels: usize,
    /// `[slice][channel][y][x]`.
    data: Vec<f32>,
}

/// Where the parameters of slices lie; `[first][second]` is their order.
#[derive(Clone, Debug)]
pub struct Parameters(pub [Vec<f32>; 2]);

impl Parameters {
    /// The slices around values of the parameters, which are held to the range of what is known.
    #[inline]
    pub fn slices(&self, at: [f32; 2]) -> Slices {
        let [(i, s), (j, t)] = [0, 1].map(|k| bracket(&self.0[k], at[k]));
        let n = self.0[1].len();
        let [i1, j1] = [(i + 1).min(self.0[0].len() - 1), (j + 1).min(n - 1)];
        [
            (i * n + j, (1.0 - s) * (1.0 - t)),
            (i * n + j1, (1.0 - s) * t),
            (i1 * n + j, s * (1.0 - t)),
            (i1 * n + j1, s * t),
        ]
    }
}

/// The node below `x` and how far it is on the way to the next, within the range of ascending nodes.
#[inline]
pub fn bracket(nodes: &[f32], x: f32) -> (usize, f32) {
    let above = nodes.partition_point(|&node| node <= x);
    if above == 0 || nodes.len() == 1 {
        return (0, 0.0);
    }
    if above == nodes.len() {
        return (nodes.len() - 2, 1.0);
    }
    let (low, high) = (nodes[above - 1], nodes[above]);
    (above - 1, (x - low) / (high - low))
}

impl WarpGrid {
    /// * `data`: `[slice][channel][y][x]`; each side has at least two nodes
    pub fn new(size: [usize; 2], channels: usize, data: Vec<f32>) -> WarpGrid {
        WarpGrid { size, channels, data }
    }

    /// The cell of a point of the unit square along an axis, and where in it.
    #[inline]
    fn cell(&self, x: f32, axis: usize) -> (usize, f32) {
        let place = x.clamp(0.0, 1.0) * (self.size[axis] - 1) as f32;
        let cell = (place as usize).min(self.size[axis] - 2);
        (cell, place - cell as f32)
    }

    /// The value of a channel at a point of the unit square.
    #[inline]
    pub fn eval(&self, p: Vec2, slices: &Slices, channel: usize) -> f32 {
        let [width, height] = self.size;
        let ((x, s), (y, t)) = (self.cell(p.x, 0), self.cell(p.y, 1));
        let mut sum = 0.0;
        for &(slice, share) in slices.iter().filter(|slice| slice.1 > 0.0) {
            let at = ((slice * self.channels + channel) * height + y) * width + x;
            let (low, high) = (&self.data[at..at + 2], &self.data[at + width..at + width + 2]);
            let [low, high] = [low, high].map(|row| row[0] + s * (row[1] - row[0]));
            sum += share * (low + t * (high - low));
        }
        sum
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.data)
    }
}

/// Densities over the unit square, each slice with the integral 1.
#[derive(Clone)]
pub struct Warp {
    grid: WarpGrid,
    /// Integral over each row: `[slice][y]`.
    rows: Vec<f32>,
    /// Integral of `rows` up to each: `[slice][y]`.
    marginal: Vec<f32>,
    /// Integral along each row up to each node: `[slice][y][x]`.
    conditional: Vec<f32>,
}

impl Warp {
    /// The densities in proportion to one function a slice; `None` where one is negative, not finite, or zero everywhere.
    pub fn new(size: [usize; 2], data: Vec<f32>) -> Option<Warp> {
        let [width, height] = size;
        let (mut rows, mut marginal, mut conditional) = (Vec::new(), Vec::new(), Vec::new());
        let mut data = data;
        for slice in data.chunks_exact_mut(width * height) {
            if !slice.iter().all(|&v| v >= 0.0 && v.is_finite()) {
                return None;
            }
            let row = |row: &[f32]| sums(row).last().copied().unwrap_or(0.0);
            let whole = sums_of(slice.chunks_exact(width).map(row)).last().copied().unwrap_or(0.0);
            if whole <= 0.0 {
                return None;
            }
            slice.iter_mut().for_each(|v| *v = (f64::from(*v) / whole) as f32);
            let mut own = Vec::new();
            for row in slice.chunks_exact(width) {
                let sums = sums(row);
                own.push(sums[width - 1]);
                conditional.extend(sums.iter().map(|&v| v as f32));
            }
            rows.extend(own.iter().map(|&v| v as f32));
            marginal.extend(sums_of(own.into_iter()).iter().map(|&v| v as f32));
        }
        Some(Warp { grid: WarpGrid::new(size, 1, data), rows, marginal, conditional })
    }

    /// The density at a point.
    #[inline]
    pub fn pdf(&self, p: Vec2, slices: &Slices) -> f32 {
        self.grid.eval(p, slices, 0)
    }

    #[inline]
    fn mixed(table: &[f32], stride: usize, at: usize, slices: &Slices) -> f32 {
        slices.iter().map(|&(slice, share)| share * table[slice * stride + at]).sum()
    }

    /// A point drawn with the density, from `u` in [0, 1)².
    pub fn sample(&self, u: Vec2, slices: &Slices) -> Vec2 {
        let [width, height] = self.grid.size;
        let rows = |y: usize| Warp::mixed(&self.rows, height, y, slices);
        let marginal = |y: usize| Warp::mixed(&self.marginal, height, y, slices);
        let (y, t) = inverted(u.y, height, rows, marginal);
        let between = |table: &[f32], x: usize| {
            let [low, high] = [y, y + 1].map(|y| Warp::mixed(table, width * height, y * width + x, slices));
            low + t * (high - low)
        };
        let density = |x: usize| between(&self.grid.data, x);
        let (x, s) = inverted(u.x, width, density, |x| between(&self.conditional, x));
        Vec2::new((x as f32 + s) / (width - 1) as f32, (y as f32 + t) / (height - 1) as f32)
    }

    /// The numbers that [`Warp::sample`] makes a point of.
    pub fn invert(&self, p: Vec2, slices: &Slices) -> Vec2 {
        let [width, height] = self.grid.size;
        let ((x, s), (y, t)) = (self.grid.cell(p.x, 0), self.grid.cell(p.y, 1));
        let rows = |y: usize| Warp::mixed(&self.rows, height, y, slices);
        let marginal = |y: usize| Warp::mixed(&self.marginal, height, y, slices);
        let between = |table: &[f32], x: usize| {
            let [low, high] = [y, y + 1].map(|y| Warp::mixed(table, width * height, y * width + x, slices));
            low + t * (high - low)
        };
        let down = reached(marginal(y), [rows(y), rows(y + 1)], t, height) / marginal(height - 1);
        let ends = [between(&self.grid.data, x), between(&self.grid.data, x + 1)];
        let whole = between(&self.conditional, width - 1);
        let across = reached(between(&self.conditional, x), ends, s, width);
        let across = if whole > 0.0 { across / whole } else { p.x };
        Vec2::new(across.clamp(0.0, 1.0), down.clamp(0.0, 1.0))
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        let others = [&self.rows, &self.marginal, &self.conditional];
        self.grid.bytes() + others.iter().map(|table| size_of_val(&***table)).sum::<usize>()
    }
}

/// Integrals of what is linear between values over [0, 1], up to each of them.
fn sums(values: &[f32]) -> Vec<f64> {
    sums_of(values.iter().map(|&v| f64::from(v)))
}

fn sums_of(values: impl ExactSizeIterator<Item = f64>) -> Vec<f64> {
    let step = 1.0 / (values.len() - 1) as f64;
    let (mut sum, mut before) = (0.0, None);
    let add = |v: f64| {
        sum += before.map_or(0.0, |before| 0.5 * (before + v) * step);
        before = Some(v);
        sum
    };
    values.map(add).collect()
}

/// The integral up to a place in a cell.
fn reached(before: f32, [a, b]: [f32; 2], t: f32, nodes: usize) -> f32 {
    before + (a + 0.5 * t * (b - a)) * t / (nodes - 1) as f32
}

/// The cell and the place in it up to which the share `u` of an integral lies.
///
/// * `density`: at nodes; `integral`: up to nodes
fn inverted(
    u: f32,
    nodes: usize,
    density: impl Fn(usize) -> f32,
    integral: impl Fn(usize) -> f32,
) -> (usize, f32) {
    let target = u * integral(nodes - 1);
    let (mut low, mut high) = (0, nodes - 1);
    while high - low > 1 {
        let middle = low.midpoint(high);
        if integral(middle) <= target { low = middle } else { high = middle }
    }
    let (a, b) = (density(low), density(low + 1));
    // a t + (b - a) t² / 2 = rest
    let rest = (target - integral(low)) * (nodes - 1) as f32;
    let root = (a * a + 2.0 * rest * (b - a)).max(0.0).sqrt();
    let t = if a + root > 0.0 { 2.0 * rest / (a + root) } else { 0.5 };
    (low, t.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use kajo_math::rng::Stream;

    use super::*;

    fn warp() -> (Warp, Parameters) {
        let value = |i: u32| 0.05 + Stream::new(8, [i, 0], 0).uniform(0);
        let parameters = Parameters([vec![0.0], vec![0.0, 0.5, 2.0]]);
        (Warp::new([5, 4], (0..60).map(value).collect()).unwrap(), parameters)
    }

    #[test]
    fn points_are_drawn_by_the_density_and_found_again() {
        let (warp, parameters) = warp();
        for at in [0.0, 0.3, 1.9, 5.0] {
            let slices = parameters.slices([0.0, at]);
            let n = 300;
            let mut counts = [0u32; 16];
            for i in 0..n * n {
                let u = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
                let p = warp.sample(u, &slices);
                assert!((warp.invert(p, &slices) - u).abs().max_element() < 2e-5, "{at} {u} {p}");
                counts[(p.x * 4.0) as usize + 4 * (p.y * 4.0) as usize] += 1;
            }
            for (bin, count) in counts.iter().enumerate() {
                let m = 40;
                let middle = |i: usize| ((i % m) as f32 + 0.5) / m as f32;
                let p = |i: usize| {
                    Vec2::new((bin % 4) as f32 + middle(i), (bin / 4) as f32 + middle(i / m)) / 4.0
                };
                let expected: f32 =
                    (0..m * m).map(|i| warp.pdf(p(i), &slices)).sum::<f32>() / (16 * m * m) as f32;
                let found = *count as f32 / (n * n) as f32;
                // Rows of numbers end on one side of a border or the other.
                assert!((found - expected).abs() < 2.5e-3, "{at} {bin}: {found} {expected}");
            }
        }
    }

    #[test]
    fn what_is_no_density_is_refused() {
        assert!(Warp::new([2, 2], vec![0.0; 4]).is_none());
        assert!(Warp::new([2, 2], vec![1.0, -1.0, 1.0, 1.0]).is_none());
        assert!(Warp::new([2, 2], vec![1.0, f32::NAN, 1.0, 1.0]).is_none());
    }

    #[test]
    fn parameters_are_held_to_what_is_known() {
        let parameters = Parameters([vec![0.0, 1.0], vec![0.0, 2.0]]);
        assert_eq!(parameters.slices([-3.0, 9.0]), [(0, 0.0), (1, 1.0), (2, 0.0), (3, 0.0)]);
        assert_eq!(parameters.slices([0.25, 1.0]), [(0, 0.375), (1, 0.375), (2, 0.125), (3, 0.125)]);
        assert_eq!(bracket(&[4.0], 9.0), (0, 0.0));
    }
}
