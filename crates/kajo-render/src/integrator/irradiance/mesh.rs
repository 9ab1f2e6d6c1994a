//! Gradient and Hessian of irradiance that know what hides what [Schwarzhaupt, Jensen and Jarosz 2012].
//!
//! The hemisphere is a mesh of cells, one around the direction of each sample and of its radiance, which stands for all that is seen from the
//! point `x`. The irradiance from a polygon of radiance `L` is a sum over its edges [Lambert 1760],
//!
//! ```text
//! E = L/2 sum over edges of g(a, b),      g(a, b) = n·(a x b) Θ / sin Θ,      cos Θ = a·b
//! ```
//!
//! with `a`, `b` the unit directions to the ends of an edge, counted around so that `g` is positive where one looks up to it. Where `x`
//! moves, they do: with `r` the distance of the end and `e_i` an axis of the tangent plane,
//!
//! ```text
//! da/dx_i       = -(e_i - a a_i) / r
//! d²a/dx_i dx_j = (3 a a_i a_j - e_i a_j - e_j a_i - a δ_ij) / r²
//! ```
//!
//! so first and second derivatives of `E` are sums over edges too, each weighed by the difference of the radiances on both sides of it. The paper
//! joins the points that were hit to triangles with the radiance of their farthest corner. Here a corner of the mesh lies between four
//! samples, as far away as the nearer of them, so that the border of what is near moves as it does: that is how occlusion is known. Then
//! borders lie on average where they are, and not half a stratum further in.
//!
//! The sky is infinitely far, and does not move.

use kajo_math::fmath::acos64;
use kajo_math::{DVec2, DVec3};

use super::hemisphere::{Derivatives, Hemisphere, Strata};

/// A corner of the mesh with the derivatives of its direction.
#[derive(Clone, Copy)]
struct Corner {
    a: DVec3,
    /// By x and y.
    first: [DVec3; 2],
    /// By xx, xy and yy.
    second: [DVec3; 3],
}

/// Pairs of axes of second derivatives.
const PAIRS: [[usize; 2]; 3] = [[0, 0], [0, 1], [1, 1]];

impl Corner {
    fn new(a: DVec3, inverse_distance: f64) -> Corner {
        let axes = [DVec3::X, DVec3::Y];
        let first = [0, 1].map(|i| -inverse_distance * (axes[i] - a * a[i]));
        let second = PAIRS.map(|[i, j]| {
            let same = if i == j { 1.0 } else { 0.0 };
            let v = 3.0 * a * a[i] * a[j] - axes[i] * a[j] - axes[j] * a[i] - a * same;
            inverse_distance * inverse_distance * v
        });
        Corner { a, first, second }
    }
}

/// First and second derivatives of `g`.
struct Edge {
    first: DVec2,
    second: [f64; 3],
}

impl Edge {
    fn new(from: &Corner, to: &Corner) -> Edge {
        let (a, b) = (from.a, to.a);
        let c = a.dot(b);
        let [f, f1, f2] = arc_over_sine(c);
        let cross = |a: DVec3, b: DVec3| a.x * b.y - a.y * b.x;
        let d = cross(a, b);
        let d1 = [0, 1].map(|i| cross(from.first[i], b) + cross(a, to.first[i]));
        let c1 = [0, 1].map(|i| from.first[i].dot(b) + a.dot(to.first[i]));
        let first = [0, 1].map(|i| d1[i] * f + d * f1 * c1[i]);
        let mut second = [0.0; 3];
        for (n, [i, j]) in PAIRS.into_iter().enumerate() {
            let d2 = cross(from.second[n], b)
                + cross(from.first[i], to.first[j])
                + cross(from.first[j], to.first[i])
                + cross(a, to.second[n]);
            let c2 = from.second[n].dot(b)
                + from.first[i].dot(to.first[j])
                + from.first[j].dot(to.first[i])
                + a.dot(to.second[n]);
            second[n] = d2 * f + f1 * (d1[i] * c1[j] + d1[j] * c1[i] + d * c2) + d * f2 * c1[i] * c1[j];
        }
        Edge { first: first.into(), second }
    }
}

/// `Θ / sin Θ` and its first and second derivative, by the cosine `c`.
///
/// They solve `(1 - c^2) f' = c f - 1`; near `c = 1` that is nothing over nothing, and the power series takes its place.
fn arc_over_sine(c: f64) -> [f64; 3] {
    let t = 1.0 - c;
    if t < 1e-3 {
        let f = 1.0 + t * (1.0 / 3.0 + t * (2.0 / 15.0 + t * (2.0 / 35.0 + t * 8.0 / 315.0)));
        let f1 = -(1.0 / 3.0 + t * (4.0 / 15.0 + t * (6.0 / 35.0 + t * 32.0 / 315.0)));
        let f2 = 4.0 / 15.0 + t * (12.0 / 35.0 + t * 96.0 / 315.0);
        return [f, f1, f2];
    }
    // Edges are never half a turn long.
    let c = c.max(-0.999_999);
    let s2 = (1.0 - c) * (1.0 + c);
    let f = acos64(c) / s2.sqrt();
    let f1 = (c * f - 1.0) / s2;
    [f, f1, (f + 3.0 * c * f1) / s2]
}

/// A mean of inverse distances that is about the largest of them where they differ.
fn nearest(inverse_distances: impl IntoIterator<Item = f64>) -> f64 {
    let (mut cubes, mut fourths) = (0.0, 0.0);
    for v in inverse_distances {
        let v = v.max(0.0);
        cubes += v * v * v;
        fourths += v * v * v * v;
    }
    if cubes > 0.0 { fourths / cubes } else { 0.0 }
}

impl Hemisphere {
    /// How the irradiance changes with the position, from the mesh of what is seen.
    pub fn derivatives(&self) -> Derivatives {
        let Strata { rings, azimuths } = self.strata;
        let mut sums = Derivatives::default();
        // Corner `k` of a row lies between azimuths `k` and `k + 1`. All cells of the first ring meet at the normal.
        let zenith = nearest((0..azimuths).map(|k| self.at(0, k).inverse_distance));
        let mut inner = vec![Corner::new(DVec3::Z, zenith); azimuths];
        for j in 0..rings {
            let outer: Vec<Corner> = (0..azimuths).map(|k| self.corner(j, k)).collect();
            for k in 0..azimuths {
                let [here, beside] = [self.at(j, k), self.at(j, k + 1)].map(|ray| ray.radiance);
                // Nothing is seen below the horizon.
                let below = if j + 1 < rings { self.at(j + 1, k).radiance } else { [0.0; 3] };
                sums.add(&inner[k], &outer[k], beside, here);
                sums.add(&outer[(k + azimuths - 1) % azimuths], &outer[k], here, below);
            }
            inner = outer;
        }
        sums
    }

    /// The corner between rings `j` and `j + 1`, or between the last ring and the horizon, and azimuths `k` and `k + 1`.
    fn corner(&self, j: usize, k: usize) -> Corner {
        let upper = [self.at(j, k), self.at(j, k + 1)];
        let towards = [1.0, -1.0];
        let near = [0, 1].map(|i| self.continued(j, k + i, [1.0, towards[i]]));
        let direction = upper[0].d + upper[1].d;
        if j + 1 == self.strata.rings {
            let direction = DVec3::new(direction.x, direction.y, 0.0);
            return Corner::new(direction.normalize_or(DVec3::X), nearest(near));
        }
        let lower = [0, 1].map(|i| self.continued(j + 1, k + i, [-1.0, towards[i]]));
        let direction = direction + self.at(j + 1, k).d + self.at(j + 1, k + 1).d;
        Corner::new(direction.normalize_or(DVec3::Z), nearest(near.into_iter().chain(lower)))
    }
}

impl Derivatives {
    /// Adds an edge between two polygons.
    ///
    /// * `left`: the radiance of the one that has the edge in this direction; `right`: of the one that has it in the other
    fn add(&mut self, from: &Corner, to: &Corner, left: [f64; 3], right: [f64; 3]) {
        let difference = [0, 1, 2].map(|i| 0.5 * (left[i] - right[i]));
        if difference == [0.0; 3] {
            return;
        }
        let edge = Edge::new(from, to);
        for (sum, l) in self.gradient.iter_mut().zip(difference) {
            *sum += l * edge.first;
        }
        let mean = (difference[0] + difference[1] + difference[2]) / 3.0;
        for (sum, second) in self.hessian.iter_mut().zip(edge.second) {
            *sum += mean * second;
        }
    }
}

/// The larger and the smaller in absolute value of the eigenvalues of a symmetric matrix `xx`, `xy`, `yy`, and the cosine of the angle from
/// the x axis to the eigenvector of the **smaller** one, which lies in the upper half plane.
pub fn eigenvalues([xx, xy, yy]: [f64; 3]) -> ([f64; 2], f64) {
    let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
    let radius = (half * half + xy * xy).sqrt();
    let [high, low] = [mean + radius, mean - radius];
    let (larger, smaller) = if high.abs() >= low.abs() { (high, low) } else { (low, high) };
    // A - larger is a multiple of v v^T with the other eigenvector v, along which both rows lie.
    let rows = [DVec2::new(xx - larger, xy), DVec2::new(xy, yy - larger)];
    let along = if rows[0].length_squared() >= rows[1].length_squared() { rows[0] } else { rows[1] };
    let along = along.try_normalize().unwrap_or(DVec2::X);
    let cos = if along.y < 0.0 { -along.x } else { along.x };
    ([larger, smaller], cos)
}

#[cfg(test)]
mod tests;
