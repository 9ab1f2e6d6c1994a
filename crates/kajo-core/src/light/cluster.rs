//! What a light tree knows of a group of lights, and how much of their light it expects at a receiver.
//!
//! A child of a node is chosen in proportion to an estimate of the irradiance that its lights make where nothing is in the way,
//!
//! ```text
//! I = P E[max(0, n . w)] E[|n_r . w|] / (|p - m|^2 + s^2)
//! ```
//!
//! for the power `P`, the mean `m` of the lights' positions and its variance `s^2`, the unit vector `w` from `m` to the receiver `p`, the
//! lights' normals `n` and the receiver's normal `n_r`. A bound in place of the estimate, as in [Conty Estévez and Kulla 2018], makes
//! choices that are far from proportional where a group is near or its normals differ: the closer to the leaves, the nearer is the
//! estimate to what the lights send. The normals are known by their mean `a`, weighted by power, whose length `R` is 1 where they are all alike and
//! 0 for a closed surface or a light that shines alike into all directions. As if they were uniform over a cap their variance is
//!
//! ```text
//! along a     (1 - R)^2 / 3            across     (1 - R^2 - (1 - R)^2 / 3) / 2
//! ```
//!
//! and `n . w` is taken to be uniform about its mean `a . w`. That is exact for one normal, a hemisphere along its axis and a sphere.
//!
//! What cannot send anything is never chosen, and what can is chosen with some probability: a box and a cone around the axes say which
//! it is [Conty Estévez and Kulla 2018; Pharr et al. 2023, 12.6].

use kajo_math::Vec3;

use super::segment::{AngularSpan, LightCone, RaySegment};
use super::{LightBounds, Receiver};

/// The estimate for what may send something is at least this part of the bound on it.
const LEAST: f32 = 0.02;

/// More power counts as this much, so that sums are finite.
const MOST_POWER: f32 = 1e30;

/// Lights that are chosen together.
#[derive(Clone, Copy, Debug)]
pub(super) struct LightCluster {
    /// Around all positions.
    center: Vec3,
    radius2: f32,
    /// Mean of the positions, weighted by power, and their variance.
    mean: Vec3,
    variance: f32,
    /// Mean of the normals, weighted by power.
    facing: Vec3,
    /// Its length, and variances of normals along it and across.
    alignment: f32,
    along: f32,
    across: f32,
    /// The cone of the axes, and the cosine of the largest angle between an axis and the light that leaves.
    axis: Vec3,
    cos_spread: f32,
    sin_spread: f32,
    cos_reach: f32,
    two_sided: bool,
    /// Cosine of the sum of both angles, where light goes to one side and stays before a plane.
    cos_cone: Option<f32>,
    power: f32,
}

/// What a light is chosen for.
pub(super) trait LightQuery {
    /// What is expected of the light of a cluster, up to a factor that is the same for all clusters; 0 where nothing can arrive.
    fn importance(&self, cluster: &LightCluster) -> f32;
}

impl LightQuery for Receiver {
    #[inline]
    fn importance(&self, cluster: &LightCluster) -> f32 {
        cluster.importance(self.p, self.n)
    }
}

/// The light that reaches the ray and from there its start.
impl LightQuery for RaySegment {
    fn importance(&self, cluster: &LightCluster) -> f32 {
        let radius = cluster.variance.sqrt();
        let part = self.seen_from(cluster.mean, radius, cluster.cone().as_ref());
        part.map_or(0.0, |part| (cluster.power * part.scattered(self.extinction)).min(MOST_POWER))
    }
}

/// Sums over lights, weighted by their power.
#[derive(Clone, Copy, Debug)]
pub(super) struct LightMoments {
    power: f32,
    mean: Vec3,
    variance: f32,
    facing: Vec3,
}

impl LightMoments {
    /// Of a single light.
    pub fn of(bounds: &LightBounds) -> LightMoments {
        let is_flat = bounds.cos_spread == 1.0 && bounds.cos_reach == 0.0;
        LightMoments {
            power: bounds.power.min(MOST_POWER),
            mean: bounds.bounds.center(),
            // Uniform over a box.
            variance: bounds.bounds.extent().length_squared() / 12.0,
            facing: if is_flat { bounds.axis } else { Vec3::ZERO },
        }
    }

    /// Of two groups together.
    pub fn union(self, other: LightMoments) -> LightMoments {
        let power = self.power + other.power;
        let share = other.power / power;
        let mix = |a: Vec3, b: Vec3| a + share * (b - a);
        let between = share * (1.0 - share) * self.mean.distance_squared(other.mean);
        LightMoments {
            power,
            mean: mix(self.mean, other.mean),
            variance: self.variance + share * (other.variance - self.variance) + between,
            facing: mix(self.facing, other.facing),
        }
    }
}

impl LightCluster {
    /// Lights with common bounds.
    pub fn new(bounds: &LightBounds, moments: &LightMoments) -> LightCluster {
        let alignment = moments.facing.length().min(1.0);
        let along = (1.0 - alignment) * (1.0 - alignment) / 3.0;
        LightCluster {
            center: bounds.bounds.center(),
            radius2: 0.25 * bounds.bounds.extent().length_squared(),
            mean: moments.mean,
            variance: moments.variance,
            facing: moments.facing,
            alignment,
            along,
            across: 0.5 * (1.0 - alignment * alignment - along).max(0.0),
            axis: bounds.axis,
            cos_spread: bounds.cos_spread,
            sin_spread: sine(bounds.cos_spread),
            cos_reach: bounds.cos_reach,
            two_sided: bounds.two_sided,
            cos_cone: cos_cone(bounds),
            power: bounds.power.min(MOST_POWER),
        }
    }

    /// About the irradiance at a receiver, times pi; 0 where nothing can arrive.
    ///
    /// * `n`: the receiver's unit normal, or zero where there is none
    #[inline]
    pub fn importance(&self, p: Vec3, n: Vec3) -> f32 {
        let Some(bound) = self.largest_cosine(p) else { return 0.0 };
        let to_receiver = p - self.mean;
        let distance2 = to_receiver.length_squared();
        let w = to_receiver * (1.0 / distance2.sqrt().max(f32::MIN_POSITIVE));
        let spread2 = distance2 + self.variance;
        // Of directions, per axis.
        let blur = self.variance / (3.0 * spread2.max(f32::MIN_POSITIVE));
        let cos = self.facing.dot(w);
        // Squared cosine between the mean normal and the way, times the squared length of that mean.
        let ahead = if self.alignment > 0.0 { cos * cos / (self.alignment * self.alignment) } else { 0.0 };
        let variance =
            self.across + (self.along - self.across) * ahead + self.alignment * self.alignment * blur;
        let leaving =
            if self.two_sided { 0.5 * mean_of_abs(cos, variance) } else { mean_of_positive(cos, variance) };
        let mut importance = self.power * leaving.max(LEAST * bound) / spread2.max(f32::MIN_POSITIVE);
        if n != Vec3::ZERO {
            importance *= mean_of_abs(w.dot(n), blur).max(1e-4);
        }
        // Without bound at a point of light itself.
        importance.min(MOST_POWER)
    }

    /// The angle under which a light sees a ray; `None` where it does not.
    pub fn seen_from(&self, segment: &RaySegment) -> Option<AngularSpan> {
        // A light is taken for half as large as it is, so that a ray through it is drawn finely where it passes the middle.
        segment.seen_from(self.center, 0.5 * self.radius2.sqrt(), self.cone().as_ref())?.span()
    }

    /// Where light goes, if all of it stays on one side of a plane.
    fn cone(&self) -> Option<LightCone> {
        let cone = |cos| LightCone { center: self.center, radius: self.radius2.sqrt(), axis: self.axis, cos };
        self.cos_cone.map(cone)
    }

    /// A bound on the cosine between the axes and ways to a receiver; `None` where no light can go there.
    #[inline]
    fn largest_cosine(&self, p: Vec3) -> Option<f32> {
        let to_receiver = p - self.center;
        let distance2 = to_receiver.length_squared();
        if distance2 <= self.radius2 || self.cos_spread <= -1.0 {
            return Some(1.0);
        }
        let w = to_receiver * (1.0 / distance2.sqrt());
        // The angle that the box fills.
        let sin2 = self.radius2 / distance2;
        let (sin_b, cos_b) = (sin2.sqrt(), (1.0 - sin2).max(0.0).sqrt());
        let cos_w = if self.two_sided { self.axis.dot(w).abs() } else { self.axis.dot(w) };
        let sin_w = sine(cos_w);
        let cos_x = cos_of_rest(sin_w, cos_w, self.sin_spread, self.cos_spread);
        let sin_x = sin_of_rest(sin_w, cos_w, self.sin_spread, self.cos_spread);
        let cos_leaving = cos_of_rest(sin_x, cos_x, sin_b, cos_b);
        // A hair of tolerance: a light must not be ruled out by rounding.
        (cos_leaving >= self.cos_reach - 1e-4).then_some(cos_leaving.max(1e-4))
    }
}

/// The cosine of the largest angle between the middle of the axes and light that leaves; `None` where that is more than a right angle.
fn cos_cone(bounds: &LightBounds) -> Option<f32> {
    let LightBounds { cos_spread, cos_reach, two_sided, .. } = *bounds;
    let cos = cos_spread * cos_reach - sine(cos_spread) * sine(cos_reach);
    // Of two angles below 180 degrees.
    (!two_sided && cos_spread >= 0.0 && cos_reach >= 0.0 && cos >= 0.0).then_some(cos)
}

/// The mean of the positive part of what is uniform about a mean with a variance.
#[inline]
fn mean_of_positive(mean: f32, variance: f32) -> f32 {
    let half = (3.0 * variance).sqrt();
    if mean >= half {
        mean
    } else if mean <= -half {
        0.0
    } else {
        (mean + half) * (mean + half) / (4.0 * half)
    }
}

/// The mean of the absolute value of what is uniform about a mean with a variance.
#[inline]
fn mean_of_abs(mean: f32, variance: f32) -> f32 {
    let half = (3.0 * variance).sqrt();
    if mean.abs() >= half { mean.abs() } else { (mean * mean + half * half) / (2.0 * half) }
}

#[inline]
fn sine(cos: f32) -> f32 {
    (1.0 - cos * cos).max(0.0).sqrt()
}

/// `cos(max(0, a - b))`.
#[inline]
fn cos_of_rest(sin_a: f32, cos_a: f32, sin_b: f32, cos_b: f32) -> f32 {
    if cos_a > cos_b { 1.0 } else { cos_a * cos_b + sin_a * sin_b }
}

/// `sin(max(0, a - b))`.
#[inline]
fn sin_of_rest(sin_a: f32, cos_a: f32, sin_b: f32, cos_b: f32) -> f32 {
    if cos_a > cos_b { 0.0 } else { sin_a * cos_b - cos_a * sin_b }
}
