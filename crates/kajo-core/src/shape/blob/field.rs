//! The field of a blob: kernels that fall off with the squared distance from balls, cylinders and half spaces, and their bounds along
//! rays.

use kajo_math::{Aabb, DVec3, fmath, roots};

use super::cell::Cell;

/// How the strength of a component falls off, by `u`, the squared distance over the squared radius.
///
/// All of them fall, and less and less so, and end at some `u` with the value zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BlobKernel {
    /// `exp(-u)`, cut where it is negligible [Blinn 1982].
    #[default]
    Gaussian,
    /// `1 - 22/9 u + 17/9 u^2 - 4/9 u^3` up to the radius [Wyvill, McPheeters and Wyvill 1986].
    Wyvill,
    /// `(1 - u)^2` up to the radius, as in POV-Ray.
    Povray,
}

/// What a component is made around.
#[derive(Clone, Copy, Debug)]
pub enum BlobCore {
    /// A point.
    Ball(DVec3),
    /// A line between two points.
    Cylinder([DVec3; 2]),
    /// All points `p` with `normal . p <= offset`.
    HalfSpace {
        /// Unit normal, which points out of it.
        normal: DVec3,
        /// Distance of its plane from the origin along the normal.
        offset: f64,
    },
}

/// One of the things that a blob is made of.
#[derive(Clone, Copy, Debug)]
pub struct BlobComponent {
    /// What distances are measured from.
    pub core: BlobCore,
    /// Of its kernel; above zero.
    pub radius: f64,
    /// Value of the field at the core; negative ones take away.
    pub strength: f64,
    /// The number of its material among those of the blob, less than [`MOST_MATERIALS`].
    pub material: usize,
}

/// How many materials the components of a blob may have.
pub const MOST_MATERIALS: usize = 5;

impl BlobKernel {
    /// The value at `u`, without what is cut off.
    #[inline]
    fn value(self, u: f64) -> f64 {
        match self {
            BlobKernel::Gaussian => fmath::exp64(-u),
            BlobKernel::Wyvill => 1.0 + u * (-22.0 / 9.0 + u * (17.0 / 9.0 - u * (4.0 / 9.0))),
            BlobKernel::Povray => (1.0 - u) * (1.0 - u),
        }
    }

    /// The derivative by `u`: never positive, and rising.
    #[inline]
    fn slope(self, u: f64) -> f64 {
        match self {
            BlobKernel::Gaussian => -fmath::exp64(-u),
            BlobKernel::Wyvill => -22.0 / 9.0 + u * (34.0 / 9.0 - u * (12.0 / 9.0)),
            BlobKernel::Povray => 2.0 * (u - 1.0),
        }
    }

    /// Both, with one exponential where they have the same.
    #[inline]
    fn value_and_slope(self, u: f64) -> (f64, f64) {
        let value = self.value(u);
        (value, if self == BlobKernel::Gaussian { -value } else { self.slope(u) })
    }
}

/// A component ready to be evaluated.
#[derive(Clone, Copy, Debug)]
pub(super) struct Term {
    core: BlobCore,
    strength: f64,
    /// One over the squared radius.
    inverse2: f64,
    /// Where the kernel ends.
    farthest: f64,
    /// What is taken from it, so that it ends at zero.
    cut: f64,
    /// See [`BlobComponent::material`].
    pub material: usize,
}

/// A range of values.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Range {
    pub lo: f64,
    pub hi: f64,
}

impl Range {
    fn add(&mut self, other: Range) {
        self.lo += other.lo;
        self.hi += other.hi;
    }

    fn scaled(self, by: f64) -> Range {
        let (a, b) = (self.lo * by, self.hi * by);
        Range { lo: a.min(b), hi: a.max(b) }
    }

    pub fn contains(self, x: f64) -> bool {
        self.lo <= x && x <= self.hi
    }
}

impl Term {
    /// * `negligible`: a value that may be cut off
    pub fn new(component: &BlobComponent, kernel: BlobKernel, negligible: f64) -> Term {
        let farthest = match kernel {
            BlobKernel::Gaussian => fmath::ln64((component.strength.abs() / negligible).max(1.0)),
            BlobKernel::Wyvill | BlobKernel::Povray => 1.0,
        };
        let inverse2 = 1.0 / (component.radius * component.radius);
        let cut = if kernel == BlobKernel::Gaussian { kernel.value(farthest) } else { 0.0 };
        let &BlobComponent { core, strength, material, .. } = component;
        Term { core, strength, inverse2, farthest, cut, material }
    }

    /// What it is made around.
    pub fn core(&self) -> BlobCore {
        self.core
    }

    /// Whether its support is bounded; that of half spaces is not.
    pub fn is_bounded(&self) -> bool {
        !matches!(self.core, BlobCore::HalfSpace { .. })
    }

    /// How far from the origin what it is made around begins, and how far around that its support reaches.
    pub fn scale(&self) -> [f64; 2] {
        let far = match self.core {
            BlobCore::Ball(center) => center.abs().max_element(),
            BlobCore::Cylinder([a, b]) => a.abs().max(b.abs()).max_element(),
            BlobCore::HalfSpace { offset, .. } => offset.abs(),
        };
        [far, (self.farthest / self.inverse2).sqrt()]
    }

    /// A box around a part of its border that shows what it does; of a half space some of the plane next to the origin.
    pub fn shown(&self) -> Aabb {
        match self.core {
            BlobCore::HalfSpace { normal, offset } => {
                let ([_, reach], foot) = (self.scale(), offset * normal);
                Aabb { min: (foot - 2.0 * reach).as_vec3(), max: (foot + 2.0 * reach).as_vec3() }
            }
            _ => self.bounds(),
        }
    }

    /// One over the square of its radius.
    pub fn inverse2(&self) -> f64 {
        self.inverse2
    }

    /// The value in its middle.
    pub fn strength(&self) -> f64 {
        self.strength
    }

    /// Whether it adds to the field.
    pub fn adds(&self) -> bool {
        self.strength > 0.0
    }

    /// A box around its support.
    pub fn bounds(&self) -> Aabb {
        let reach = (self.farthest / self.inverse2).sqrt();
        let around = |p: DVec3| Aabb { min: (p - reach).as_vec3(), max: (p + reach).as_vec3() };
        match self.core {
            BlobCore::Ball(center) => around(center),
            BlobCore::Cylinder([a, b]) => around(a).union(around(b)),
            BlobCore::HalfSpace { .. } => return Aabb::EVERYWHERE,
        }
        .padded(1e-6)
    }

    /// The least and the most that it may say in a box; `None` where that is nothing.
    pub fn range_in(&self, kernel: BlobKernel, cell: &Cell) -> Option<Range> {
        let [near2, far2] = match self.core {
            BlobCore::Ball(center) => cell.distances2(center),
            BlobCore::Cylinder(_) => {
                let (middle, half) = (0.5 * (cell.min + cell.max), 0.5 * (cell.max - cell.min).length());
                let distance = self.offset(middle).length();
                [(distance - half).max(0.0), distance + half].map(|d| d * d)
            }
            BlobCore::HalfSpace { normal, offset } => {
                let (middle, half) = (0.5 * (cell.min + cell.max), 0.5 * (cell.max - cell.min));
                let (height, spread) = (normal.dot(middle) - offset, normal.abs().dot(half));
                [height - spread, height + spread].map(|h| h.max(0.0)).map(|d| d * d)
            }
        };
        let [nearest, farthest] = [near2, far2].map(|d2| d2 * self.inverse2);
        if nearest >= self.farthest {
            return None;
        }
        let [hi, lo] = [nearest, farthest.min(self.farthest)].map(|u| kernel.value(u) - self.cut);
        Some(Range { lo, hi }.scaled(self.strength))
    }

    /// The vector to `p` from what is nearest to it.
    fn offset(&self, p: DVec3) -> DVec3 {
        match self.core {
            BlobCore::Ball(center) => p - center,
            BlobCore::Cylinder([a, b]) => {
                let (along, w) = (b - a, p - a);
                let length2 = along.length_squared();
                let share = if length2 > 0.0 { (w.dot(along) / length2).clamp(0.0, 1.0) } else { 0.0 };
                w - share * along
            }
            BlobCore::HalfSpace { normal, offset } => (normal.dot(p) - offset).max(0.0) * normal,
        }
    }

    /// Its value and gradient at a point.
    #[inline(always)]
    pub fn at(&self, kernel: BlobKernel, p: DVec3) -> (f64, DVec3) {
        let w = self.offset(p);
        let u = w.length_squared() * self.inverse2;
        if u >= self.farthest {
            return (0.0, DVec3::ZERO);
        }
        let (value, slope) = kernel.value_and_slope(u);
        (self.strength * (value - self.cut), 2.0 * self.strength * self.inverse2 * slope * w)
    }

    /// Its value and derivative along a line through `p` with direction `d`.
    #[inline]
    pub fn along(&self, kernel: BlobKernel, p: DVec3, d: DVec3) -> (f64, f64) {
        let (value, gradient) = self.at(kernel, p);
        (value, gradient.dot(d))
    }

    /// Where a line is within its support.
    pub fn extent_along(&self, o: DVec3, d: DVec3) -> Option<[f64; 2]> {
        let reach2 = self.farthest / self.inverse2;
        let ball = |center: DVec3| {
            let w = o - center;
            let shift = -w.dot(d) / d.dot(d);
            let across = w + shift * d;
            let (near, far) = roots::quadratic(d.dot(d), 0.0, across.dot(across) - reach2)?;
            Some([near + shift, far + shift])
        };
        match self.core {
            BlobCore::Ball(center) => ball(center),
            BlobCore::Cylinder([a, b]) => {
                let hull = |x: Option<[f64; 2]>, y: Option<[f64; 2]>| match (x, y) {
                    (Some(x), Some(y)) => Some([x[0].min(y[0]), x[1].max(y[1])]),
                    (x, y) => x.or(y),
                };
                hull(hull(ball(a), ball(b)), tube(o, d, a, b, reach2))
            }
            BlobCore::HalfSpace { normal, offset } => {
                let (height, reach) = (normal.dot(o) - offset, reach2.sqrt());
                match rise(normal, d) {
                    0.0 => (height < reach).then_some([f64::NEG_INFINITY, f64::INFINITY]),
                    rise if rise > 0.0 => Some([f64::NEG_INFINITY, (reach - height) / rise]),
                    rise => Some([(reach - height) / rise, f64::INFINITY]),
                }
            }
        }
    }

    /// Where a line comes into a half space or leaves it, on one side of which the term is constant.
    pub fn flat_from(&self, o: DVec3, d: DVec3) -> Option<f64> {
        let BlobCore::HalfSpace { normal, offset } = self.core else { return None };
        let t = (offset - normal.dot(o)) / rise(normal, d);
        t.is_finite().then_some(t)
    }

    /// Its value where a line comes from, at infinity.
    pub fn at_start(&self, kernel: BlobKernel, o: DVec3, d: DVec3) -> f64 {
        let BlobCore::HalfSpace { normal, .. } = self.core else { return 0.0 };
        match rise(normal, d) {
            0.0 => self.at(kernel, o).0,
            rise if rise > 0.0 => self.strength * (kernel.value(0.0) - self.cut),
            _ => 0.0,
        }
    }

    /// Bounds of its value and of its derivative on a piece of a line, by the squared distance, which is convex there.
    pub fn bounds_along(&self, kernel: BlobKernel, o: DVec3, d: DVec3, [a, b]: [f64; 2]) -> (Range, Range) {
        let at = |t: f64| {
            let w = self.offset(o + t * d);
            (w.length_squared() * self.inverse2, 2.0 * w.dot(d) * self.inverse2)
        };
        let ((u_a, slope_a), (u_b, slope_b)) = (at(a), at(b));
        let most = u_a.max(u_b).min(self.farthest);
        let least = if slope_a >= 0.0 {
            u_a
        } else if slope_b <= 0.0 {
            u_b
        } else {
            self.least_between(o, d, [a, b], [u_a, u_b], [slope_a, slope_b])
        };
        let least = least.clamp(0.0, self.farthest);
        let (at_least, at_most) = (kernel.value_and_slope(least), kernel.value_and_slope(most));
        let value = Range { lo: at_most.0 - self.cut, hi: at_least.0 - self.cut };
        // Products of one that is never positive and one that rises from end to end; beyond where it ends it is zero.
        let ends = u_a.max(u_b) >= self.farthest;
        let kernel_slope = [at_least.1, if ends { 0.0 } else { at_most.1 }];
        let products = [slope_a, slope_b].map(|slope| kernel_slope.map(|k| k * slope));
        let all = products.into_iter().flatten();
        let derivative = Range {
            lo: all.clone().fold(f64::INFINITY, f64::min),
            hi: all.fold(f64::NEG_INFINITY, f64::max),
        };
        (value.scaled(self.strength), derivative.scaled(self.strength))
    }

    /// A bound from below of the least `u` within a piece of a line where it falls at first and rises at last: where its tangents
    /// meet, or for balls itself.
    fn least_between(&self, o: DVec3, d: DVec3, [a, b]: [f64; 2], u: [f64; 2], slope: [f64; 2]) -> f64 {
        if let BlobCore::Ball(center) = self.core {
            let w = o - center;
            let across = w - (w.dot(d) / d.dot(d)) * d;
            return across.length_squared() * self.inverse2;
        }
        let t = (u[1] - u[0] + slope[0] * a - slope[1] * b) / (slope[0] - slope[1]);
        u[0] + slope[0] * (t.clamp(a, b) - a)
    }
}

/// How fast a line leaves a half space; zero where it never does.
fn rise(normal: DVec3, d: DVec3) -> f64 {
    const PARALLEL: f64 = 1e-12;
    let rise = normal.dot(d);
    if rise.abs() <= PARALLEL * d.length() { 0.0 } else { rise }
}

/// Where a line is within a cylinder without its ends, between the planes at them.
fn tube(o: DVec3, d: DVec3, a: DVec3, b: DVec3, reach2: f64) -> Option<[f64; 2]> {
    let along = b - a;
    let length2 = along.length_squared();
    if length2 == 0.0 {
        return None;
    }
    let w = o - a;
    let across = |v: DVec3| v - (v.dot(along) / length2) * along;
    let (d_across, w_across) = (across(d), across(w));
    let (mut lo, mut hi) = (f64::NEG_INFINITY, f64::INFINITY);
    if d_across.length_squared() > 1e-24 * d.length_squared() {
        let shift = -w_across.dot(d_across) / d_across.dot(d_across);
        let nearest = w_across + shift * d_across;
        let (near, far) = roots::quadratic(d_across.dot(d_across), 0.0, nearest.dot(nearest) - reach2)?;
        (lo, hi) = (near + shift, far + shift);
    } else if w_across.length_squared() > reach2 {
        return None;
    }
    let (height, rise) = (w.dot(along), d.dot(along));
    if rise == 0.0 {
        return (0.0..=length2).contains(&height).then_some([lo, hi]);
    }
    let [p, q] = [-height / rise, (length2 - height) / rise];
    (lo, hi) = (lo.max(p.min(q)), hi.min(p.max(q)));
    (lo < hi).then_some([lo, hi])
}

/// The sum of bounds of some of these terms.
pub(super) fn sum_of_bounds(
    terms: &[Term],
    members: &[u32],
    kernel: BlobKernel,
    (o, d): (DVec3, DVec3),
    piece: [f64; 2],
) -> (Range, Range) {
    let mut sums = (Range::default(), Range::default());
    for &i in members {
        let (value, derivative) = terms[i as usize].bounds_along(kernel, o, d, piece);
        sums.0.add(value);
        sums.1.add(derivative);
    }
    sums
}
