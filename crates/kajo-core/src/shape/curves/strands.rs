//! Control points of many curves, and the cubics that they stand for.
//!
//! Every kind of curve is kept as the places that its cubics join at, each with its tangent and its radius, so that neighbours
//! share them bit for bit. With control points `p`
//!
//! ```text
//! B-spline       c_i = (p_(i-1) + 4 p_i + p_(i+1)) / 6      m_i = (p_(i+1) - p_(i-1)) / 2
//! Catmull-Rom    c_i = p_i                                  m_i = (p_(i+1) - p_(i-1)) / 2
//! Bezier         c_i = p_(3 i)                              m_i = 3 (p_(3 i + 1) - p_(3 i)) and 3 (p_(3 i) - p_(3 i - 1))
//! ```

use kajo_math::{DVec3, Vec3};

use super::CurveBasis;

/// Curves by their control points, one after the other.
#[derive(Clone, Debug, Default)]
pub struct Strands {
    /// Control points.
    pub points: Vec<Vec3>,
    /// The radius at each.
    pub radii: Vec<f32>,
    /// Where in these each strand ends.
    pub ends: Vec<u32>,
}

impl Strands {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// Ends the strand that points were added to.
    pub fn finish_strand(&mut self) {
        self.ends.push(self.points.len() as u32);
    }

    /// The points of a strand.
    pub(crate) fn range(&self, strand: usize) -> std::ops::Range<usize> {
        let start = if strand == 0 { 0 } else { self.ends[strand - 1] as usize };
        start..self.ends[strand] as usize
    }
}

/// A place where cubics join.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub p: [f32; 3],
    pub r: f32,
    /// How both change along the cubic.
    pub m: [f32; 3],
    pub mr: f32,
}

impl Node {
    /// * `p`: place and radius
    /// * `m`: how they change
    /// * `sides`: whether a cubic ends here, and whether one begins; in none the radius falls below zero
    fn new(p: (DVec3, f64), m: (DVec3, f64), [ends, begins]: [bool; 2]) -> Node {
        let r = p.1.max(0.0);
        let low = if begins { -3.0 * r } else { f64::NEG_INFINITY };
        let high = if ends { 3.0 * r } else { f64::INFINITY };
        let mr = m.1.clamp(low, high);
        Node { p: p.0.as_vec3().to_array(), r: r as f32, m: m.0.as_vec3().to_array(), mr: mr as f32 }
    }

    pub fn position(&self) -> (DVec3, f64) {
        (Vec3::from(self.p).as_dvec3(), self.r.into())
    }

    pub fn slope(&self) -> (DVec3, f64) {
        (Vec3::from(self.m).as_dvec3(), self.mr.into())
    }
}

impl CurveBasis {
    /// How many nodes further the next cubic begins.
    pub(super) fn stride(self) -> usize {
        if self == CurveBasis::Bezier { 2 } else { 1 }
    }

    /// Whether so many control points make a curve.
    pub fn takes(self, points: usize) -> bool {
        match self {
            CurveBasis::Bezier => points >= 4 && points % 3 == 1,
            CurveBasis::Linear | CurveBasis::BSpline | CurveBasis::CatmullRom => points >= 2,
        }
    }

    /// Adds the nodes of a strand.
    pub(super) fn nodes(self, points: &[Vec3], radii: &[f32], out: &mut Vec<Node>) {
        let last = points.len() - 1;
        let at = |i: usize| (points[i].as_dvec3(), f64::from(radii[i]));
        let minus = |a: (DVec3, f64), b: (DVec3, f64), k: f64| (k * (a.0 - b.0), k * (a.1 - b.1));
        let sides = |i: usize| [i > 0, i < last];
        match self {
            CurveBasis::Linear => {
                out.extend((0..=last).map(|i| Node::new(at(i), (DVec3::ZERO, 0.0), sides(i))));
            }
            CurveBasis::Bezier => {
                for k in (0..last).step_by(3) {
                    out.push(Node::new(at(k), minus(at(k + 1), at(k), 3.0), [false, true]));
                    out.push(Node::new(at(k + 3), minus(at(k + 3), at(k + 2), 3.0), [true, false]));
                }
            }
            CurveBasis::CatmullRom => out.extend((0..=last).map(|i| {
                let half = if i == 0 || i == last { 1.0 } else { 0.5 };
                Node::new(at(i), minus(at((i + 1).min(last)), at(i.saturating_sub(1)), half), sides(i))
            })),
            CurveBasis::BSpline => out.extend((0..=last).map(|i| {
                if i == 0 || i == last {
                    // As with a point beyond, as far away as the neighbour.
                    let m = minus(at((i + 1).min(last)), at(i.saturating_sub(1)), 1.0);
                    return Node::new(at(i), m, sides(i));
                }
                let (a, b, c) = (at(i - 1), at(i), at(i + 1));
                let p = ((a.0 + 4.0 * b.0 + c.0) / 6.0, (a.1 + 4.0 * b.1 + c.1) / 6.0);
                Node::new(p, minus(c, a, 0.5), sides(i))
            })),
        }
    }
}
