//! Drawing directions towards media that emit: flames, hot gas.
//!
//! A body of such a medium is cut into the cells of a grid, and a point of it is drawn with a density `p(x)` per volume that is the same
//! all over a cell, in proportion to the light that is given there. What is drawn is not the point but the
//! direction to it, and the light of all of the medium along that direction counts [Simon et al. 2017, "Line integration for
//! rendering heterogeneous emissive volumes"]. The density per solid angle of the direction `w` at the receiver `o` is
//!
//! ```text
//! q(w) = integral of p(o + t w) t^2 dt = sum over cells of p_c (t1^3 - t0^3) / 3
//! ```
//!
//! It has no pole, as the density `p t^2` of a point has in its place: receivers may be as near as they like, or within the
//! medium. A body `b` of the power `Φ_b`, at the distance `D_b` from the receiver to its middle, is chosen with the probability
//!
//! ```text
//! P(b) ~ Φ_b / max(D_b^2, R_b^2)
//! ```
//!
//! with the radius `R_b` of its box. The density of all is the sum of `P(b) q_b(w)`.
//!
//! No estimate depends on how well the cells are known: where they say less than there is, directions drawn by scattering find the light.

use kajo_math::piecewise::Piecewise1D;
use kajo_math::{Aabb, Ray, Vec2, Vec3};

use super::MajorantGrid;

/// Cells along the longest side of a body.
const CELLS: f32 = 24.0;

/// Part of the mean emission that each cell counts with at least, lest what the points miss be left undrawn.
const LEAST_SHARE: f32 = 0.01;

/// All bodies of media that emit and that light comes out of straight; see [`Scene::emissive_volumes`](crate::scene::Scene::emissive_volumes).
#[derive(Debug, Default)]
pub struct EmissiveVolumes {
    volumes: Vec<EmissiveVolume>,
}

/// One of them.
#[derive(Debug)]
pub(crate) struct EmissiveVolume {
    /// Density per volume of points, by cells; both of its bounds are the same.
    density: MajorantGrid,
    size: [u32; 3],
    /// The probabilities of cells, x first.
    cells: Piecewise1D,
    middle: Vec3,
    /// Half the diagonal of its box, squared.
    radius2: f32,
    /// Up to a factor.
    power: f32,
}

impl EmissiveVolumes {
    /// * `volumes`: not many, since each question is asked of all
    pub(crate) fn new(volumes: Vec<EmissiveVolume>) -> EmissiveVolumes {
        EmissiveVolumes { volumes }
    }

    /// Whether there are none.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.volumes.is_empty()
    }

    /// A unit direction from a point, with its density per solid angle.
    ///
    /// * `u`, `v`: uniform in [0, 1)²
    pub fn sample(&self, from: Vec3, u: Vec2, v: Vec2) -> Option<(Vec3, f32)> {
        let all: f32 = self.volumes.iter().map(|volume| volume.weight(from)).sum();
        let mut left = u.x * all;
        let chosen = self.volumes.iter().find_map(|volume| {
            let weight = volume.weight(from);
            if left < weight {
                return Some((volume, left / weight));
            }
            left -= weight;
            None
        });
        let (volume, choice) = chosen?;
        let w = (volume.point(choice, Vec3::new(u.y, v.x, v.y)) - from).normalize_or_zero();
        let pdf = self.pdf(from, w);
        (w != Vec3::ZERO && pdf > 0.0 && pdf.is_finite()).then_some((w, pdf))
    }

    /// The density per solid angle with which [`EmissiveVolumes::sample`] draws a direction.
    ///
    /// * `w`: unit direction
    pub fn pdf(&self, from: Vec3, w: Vec3) -> f32 {
        let (mut sum, mut all) = (0.0, 0.0);
        for volume in &self.volumes {
            let weight = volume.weight(from);
            sum += weight * volume.pdf(from, w);
            all += weight;
        }
        if sum > 0.0 { sum / all } else { 0.0 }
    }
}

impl EmissiveVolume {
    /// Cells along each side of a box that is not flat.
    pub(crate) fn cells(bounds: &Aabb) -> [u32; 3] {
        let side = bounds.extent().max_element() / CELLS;
        (bounds.extent() / side).to_array().map(|n| (n.round() as u32).max(1))
    }

    /// `None` where nothing is emitted, or without end.
    ///
    /// * `bounds`: not flat
    /// * `size`: cells along each axis
    /// * `emission`: of cells, radiance per unit length, x first
    pub(crate) fn new(bounds: Aabb, size: [u32; 3], emission: &[f32]) -> Option<EmissiveVolume> {
        let mean = emission.iter().sum::<f32>() / emission.len() as f32;
        let weights: Vec<f32> = emission.iter().map(|e| e.max(LEAST_SHARE * mean)).collect();
        let cells = Piecewise1D::new(&weights)?;
        let cell_volume = (bounds.extent() / Vec3::from(size.map(|n| n as f32))).element_product();
        let [nx, ny, _] = size;
        let density = MajorantGrid::new(bounds, size, |[x, y, z]| {
            [cells.probability(((z * ny + y) * nx + x) as usize) / cell_volume; 2]
        });
        let radius2 = 0.25 * bounds.extent().length_squared();
        let power = weights.iter().sum::<f32>() * cell_volume;
        let usable = density.largest().is_finite() && power > 0.0 && power.is_finite();
        usable.then_some(EmissiveVolume { density, size, cells, middle: bounds.center(), radius2, power })
    }

    /// `Φ / max(D^2, R^2)`.
    fn weight(&self, from: Vec3) -> f32 {
        self.power / from.distance_squared(self.middle).max(self.radius2)
    }

    /// A point of it.
    ///
    /// * `choice`: uniform in [0, 1), chooses the cell
    /// * `u`: uniform in [0, 1)³
    fn point(&self, choice: f32, u: Vec3) -> Vec3 {
        let cell = self.cells.cell_of(choice).0 as u32;
        let [nx, ny, _] = self.size;
        let place = Vec3::from([cell % nx, cell / nx % ny, cell / (nx * ny)].map(|k| k as f32));
        let bounds = self.density.bounds();
        bounds.min + (place + u) / Vec3::from(self.size.map(|n| n as f32)) * bounds.extent()
    }

    /// Density per solid angle of a direction.
    fn pdf(&self, from: Vec3, w: Vec3) -> f32 {
        let ray = Ray::new(from, w);
        let Some((enter, _)) = self.density.bounds().clip(&ray) else { return 0.0 };
        // Counted from where the ray enters, so that the lengths in cells of a body far away are not lost to rounding.
        let ray = Ray::new(ray.at(enter), w);
        let in_cell = |density: f32, from: f32, to: f32| {
            let (a, b) = (enter + from, enter + to);
            density * (to - from) * (a * a + a * b + b * b)
        };
        self.density.walk(&ray).map(|cell| in_cell(cell.density, cell.t_min, cell.t_max)).sum::<f32>() / 3.0
    }
}

#[cfg(test)]
mod tests {
    use kajo_math::rng::Stream;
    use kajo_math::warp;

    use super::*;

    fn volumes() -> EmissiveVolumes {
        let bounds = [
            Aabb { min: Vec3::new(-1.0, -2.0, 0.5), max: Vec3::new(1.5, 0.0, 2.0) },
            Aabb { min: Vec3::new(0.5, 1.0, -1.0), max: Vec3::new(1.0, 1.5, 1.0) },
        ];
        let size = [3, 2, 4];
        let emission = |k: u32| (0..24).map(move |i| if i % 5 == k { 0.0 } else { (i + k) as f32 });
        let volume = |(bounds, k)| EmissiveVolume::new(bounds, size, &emission(k).collect::<Vec<_>>());
        EmissiveVolumes { volumes: bounds.into_iter().zip([0, 3]).filter_map(volume).collect() }
    }

    /// From outside, from within a body, and from where both are in one direction.
    #[test]
    fn directions_follow_their_density() {
        let volumes = volumes();
        for (i, from) in
            [[4.0, 3.0, -2.0], [0.2, -1.0, 1.1], [0.7, 5.0, 0.8], [-1.0, -2.0, 0.5]].into_iter().enumerate()
        {
            let from = Vec3::from(from);
            let result = kajo_testkit::sphere::test(
                20_000,
                i as u64,
                |u, w| {
                    // Two more numbers from the digits of the first ones that choose no cell.
                    let more = (u * 4096.0).fract();
                    volumes
                        .sample(from, Vec2::new(w, more.x), Vec2::new((u.x * 16.0).fract(), u.y))
                        .map(|(w, _)| w)
                },
                |w| volumes.pdf(from, w),
            );
            assert!(result.passes(0.01, 4), "{from}: {result:?}");
        }
    }

    /// Far away all of the density is in a small cone, and rounding leaves it what it is.
    #[test]
    fn bodies_far_away_keep_their_density() {
        let volumes = volumes();
        let from = Vec3::new(2000.0, -1000.0, 1500.0);
        let (mut sum, n) = (0.0, 4000);
        for i in 0..n {
            let number = Stream::new(5, [i, 0], 0);
            let (u, v) = (number.uniform(0), number.uniform(1));
            let (w, pdf) = volumes
                .sample(from, Vec2::new(u, v), Vec2::new(number.uniform(2), number.uniform(3)))
                .expect("all bodies are seen");
            assert_eq!(pdf, volumes.pdf(from, w));
            sum += f64::from(pdf).recip() / f64::from(n);
        }
        // The mean of 1/q is the solid angle of all bodies, the same by even directions into a cone around them.
        let towards = (Vec3::new(0.25, -0.25, 0.5) - from).normalize();
        let one_minus_cos = 4e-6;
        let frame = kajo_math::Frame::from_normal(towards);
        let many = 400_000;
        let hits = (0..many).filter(|&i| {
            let number = Stream::new(6, [i, 0], 0);
            let w = warp::uniform_cone(Vec2::new(number.uniform(0), number.uniform(1)), one_minus_cos);
            volumes.pdf(from, frame.to_world(w)) > 0.0
        });
        let solid_angle =
            std::f64::consts::TAU * f64::from(one_minus_cos) * hits.count() as f64 / f64::from(many);
        assert!((sum / solid_angle - 1.0).abs() < 0.05, "{sum} {solid_angle}");
    }

    #[test]
    fn what_gives_no_light_is_no_volume() {
        let bounds = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        assert!(EmissiveVolume::new(bounds, [1, 1, 2], &[0.0, 0.0]).is_none());
        assert!(EmissiveVolume::new(bounds, [1, 1, 2], &[f32::INFINITY, 1.0]).is_none());
        assert!(EmissiveVolumes::default().sample(Vec3::ZERO, Vec2::ZERO, Vec2::ZERO).is_none());
        assert_eq!(EmissiveVolumes::default().pdf(Vec3::ZERO, Vec3::X), 0.0);
    }
}
