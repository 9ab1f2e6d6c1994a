//! Control points of a bicubic patch, in space or as a ray sees them.

use kajo_math::{DVec2, DVec3};

/// Four rows of four control points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Net<P>(pub [[P; 4]; 4]);

/// Halves of a cubic, by de Casteljau's algorithm.
fn halves<P>([a, b, c, d]: [P; 4], middle: impl Fn(P, P) -> P) -> [[P; 4]; 2]
where
    P: Copy,
{
    let (ab, bc, cd) = (middle(a, b), middle(b, c), middle(c, d));
    let (left, right) = (middle(ab, bc), middle(bc, cd));
    let both = middle(left, right);
    [[a, ab, left, both], [both, right, cd, d]]
}

impl<P: Copy> Net<P> {
    /// The same points in another space.
    pub fn map<Q>(&self, f: impl Fn(P) -> Q) -> Net<Q> {
        Net(self.0.map(|row| row.map(&f)))
    }

    fn transposed(&self) -> Net<P> {
        Net([0, 1, 2, 3].map(|i| self.0.map(|row| row[i])))
    }

    /// Halves along u.
    fn split(&self, middle: impl Fn(P, P) -> P + Copy) -> [Net<P>; 2] {
        let halves = self.0.map(|row| halves(row, middle));
        [0, 1].map(|side| Net(halves.map(|row| row[side])))
    }

    /// Halves along v.
    fn split_across(&self, middle: impl Fn(P, P) -> P + Copy) -> [Net<P>; 2] {
        self.transposed().split(middle).map(|half| half.transposed())
    }
}

impl Net<DVec3> {
    /// Those of `n` x `n` equal pieces, row by row along v; `n` is a power of two.
    pub fn grid(&self, n: u32) -> Vec<Net<DVec3>> {
        let middle = |a: DVec3, b: DVec3| 0.5 * (a + b);
        let divide = |nets: Vec<Net<DVec3>>, across: bool| -> Vec<Net<DVec3>> {
            let halves = |net: &Net<DVec3>| if across { net.split_across(middle) } else { net.split(middle) };
            nets.iter().flat_map(halves).collect()
        };
        let mut rows = vec![*self];
        while rows.len() < n as usize {
            rows = divide(rows, true);
        }
        let row = |net: &Net<DVec3>| {
            let mut pieces = vec![*net];
            while pieces.len() < n as usize {
                pieces = divide(pieces, false);
            }
            pieces
        };
        rows.iter().flat_map(row).collect()
    }
}

/// A piece of a patch as a ray sees it, which is the origin.
pub(super) struct SubPatch {
    pub net: Net<DVec2>,
    /// Where it is in the patch.
    pub low: DVec2,
    pub size: DVec2,
}

/// A zero found twice, from both sides of the line between two pieces, differs by rounding alone.
const SAME: f64 = 1e-9;

/// A zero that is so little outside of a piece, in parts of the piece, counts.
const MARGIN: f64 = 1e-10;

/// More pieces than this are looked at only where a ray lies in a flat patch, which it meets everywhere or nowhere.
const MOST_SUB_PATCHES: u32 = 4000;

impl SubPatch {
    /// Adds the coordinates in the patch where it is zero.
    ///
    /// * `smallest`: what is seen no larger than this is a point
    /// * `stack`: memory for pieces that are still to be looked at
    pub fn zeros(self, smallest: f64, found: &mut Vec<DVec2>, stack: &mut Vec<SubPatch>) {
        stack.clear();
        stack.push(self);
        let mut looked_at = 0;
        while let Some(sub_patch) = stack.pop() {
            looked_at += 1;
            if sub_patch.is_beside() || looked_at > MOST_SUB_PATCHES {
                continue;
            }
            let (along_u, along_v) = (sub_patch.net.differences(), sub_patch.net.transposed().differences());
            let [longer_u, longer_v] = [&along_u, &along_v]
                .map(|all| all.iter().fold(0.0f64, |longest, d| longest.max(d.abs().max_element())));
            let zero = match () {
                () if longer_u.max(longer_v) <= smallest => Some(DVec2::splat(0.5)),
                () if turn_one_way(&along_u, &along_v) => sub_patch.newton(smallest),
                () => None,
            };
            if let Some(zero) = zero {
                let uv = (sub_patch.low + zero.clamp(DVec2::ZERO, DVec2::ONE) * sub_patch.size)
                    .clamp(DVec2::ZERO, DVec2::ONE);
                if found.iter().all(|known| (*known - uv).abs().max_element() > SAME) {
                    found.push(uv);
                }
                continue;
            }
            stack.extend(sub_patch.halved(longer_u >= longer_v));
        }
    }

    /// Whether all control points are on one side of a line through the origin: of an axis, or of one between them.
    fn is_beside(&self) -> bool {
        const DIRECTIONS: [DVec2; 4] = [DVec2::X, DVec2::Y, DVec2::ONE, DVec2::new(1.0, -1.0)];
        DIRECTIONS.iter().any(|direction| {
            let side = |p: &DVec2| p.dot(*direction);
            let points = || self.net.0.iter().flatten();
            points().all(|p| side(p) > 0.0) || points().all(|p| side(p) < 0.0)
        })
    }

    /// Both halves, along u or along v.
    fn halved(&self, along_u: bool) -> [SubPatch; 2] {
        let middle = |a: DVec2, b: DVec2| 0.5 * (a + b);
        let nets = if along_u { self.net.split(middle) } else { self.net.split_across(middle) };
        let size = self.size * if along_u { DVec2::new(0.5, 1.0) } else { DVec2::new(1.0, 0.5) };
        let step = self.size - size;
        let [first, second] = nets;
        [SubPatch { net: first, low: self.low, size }, SubPatch { net: second, low: self.low + step, size }]
    }

    /// The zero of a piece over which the map does not fold, in coordinates of the piece; `None` where none within it is found.
    fn newton(&self, smallest: f64) -> Option<DVec2> {
        const MOST_STEPS: u32 = 12;
        let mut at = DVec2::splat(0.5);
        for _ in 0..MOST_STEPS {
            let (p, by_u, by_v) = self.net.at(at);
            let turn = by_u.perp_dot(by_v);
            let step = DVec2::new(p.perp_dot(by_v), by_u.perp_dot(p)) / turn;
            let next = at - step;
            // Beyond the neighbouring pieces there is nothing to find.
            if !next.is_finite() || (next - 0.5).abs().max_element() > 2.0 {
                return None;
            }
            at = next;
            if step.abs().max_element() < 1e-15 || p.abs().max_element() < 0.25 * smallest {
                break;
            }
        }
        let is_within = (at - 0.5).abs().max_element() <= 0.5 + MARGIN;
        let (p, by_u, by_v) = self.net.at(at);
        let rounding = smallest.max(1e-12 * (by_u.abs().max_element() + by_v.abs().max_element()));
        (is_within && p.abs().max_element() <= rounding).then_some(at)
    }
}

impl Net<DVec2> {
    /// Differences of neighbours along rows.
    fn differences(&self) -> [DVec2; 12] {
        let mut all = [DVec2::ZERO; 12];
        for (row, out) in self.0.iter().zip(all.chunks_exact_mut(3)) {
            for (pair, out) in row.windows(2).zip(out) {
                *out = pair[1] - pair[0];
            }
        }
        all
    }

    /// Value, and derivatives by both coordinates.
    fn at(&self, uv: DVec2) -> (DVec2, DVec2, DVec2) {
        let curve = |[a, b, c, d]: [DVec2; 4], t: f64| {
            let [ab, bc, cd] = [a.lerp(b, t), b.lerp(c, t), c.lerp(d, t)];
            let (left, right) = (ab.lerp(bc, t), bc.lerp(cd, t));
            (left.lerp(right, t), 3.0 * (right - left))
        };
        let rows = self.0.map(|row| curve(row, uv.x));
        let (p, by_v) = curve(rows.map(|row| row.0), uv.y);
        (p, curve(rows.map(|row| row.1), uv.y).0, by_v)
    }
}

/// Whether every one of some vectors is turned the same way, by less than half a turn, from every one of others.
fn turn_one_way(from: &[DVec2; 12], to: &[DVec2; 12]) -> bool {
    let (Some([a, b]), Some([c, d])) = (fan(from), fan(to)) else { return false };
    let turns = [a.perp_dot(c), a.perp_dot(d), b.perp_dot(c), b.perp_dot(d)];
    turns.iter().all(|&turn| turn > 0.0) || turns.iter().all(|&turn| turn < 0.0)
}

/// The outermost of vectors that are less than a quarter of a turn from their sum.
fn fan(all: &[DVec2; 12]) -> Option<[DVec2; 2]> {
    let middle: DVec2 = all.iter().sum();
    let mut ends = [(f64::INFINITY, DVec2::ZERO), (f64::NEG_INFINITY, DVec2::ZERO)];
    for &d in all {
        let ahead = middle.dot(d);
        // A vector that has vanished points everywhere.
        if ahead <= 0.0 {
            return None;
        }
        let slope = middle.perp_dot(d) / ahead;
        if slope < ends[0].0 {
            ends[0] = (slope, d);
        }
        if slope > ends[1].0 {
            ends[1] = (slope, d);
        }
    }
    Some(ends.map(|end| end.1))
}
