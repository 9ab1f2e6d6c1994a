//! What a line in a plane has inside of an outline of curves.
//!
//! Curves are given by control points, and the side of the line on which a point lies by one function of the point. Curves
//! that share an end have the same value there, bit by bit, and zero counts as one side: so the changes of side along a closed
//! contour cancel exactly, crossings come in pairs, and no line slips between two curves or meets their common end twice.
//! Along the line each crossing changes the winding number by one; a fill rule says which numbers are inside.

use kajo_math::{DVec2, roots};

use super::Bezier;

/// Which winding numbers are inside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FillRule {
    /// All but zero: what any contour goes around, unless another goes around it the other way.
    #[default]
    NonZero,
    /// Odd ones: what is crossed in and out in turns.
    EvenOdd,
}

impl FillRule {
    /// Whether a place with this winding number is inside.
    #[inline]
    pub fn fills(self, winding: i32) -> bool {
        match self {
            FillRule::NonZero => winding != 0,
            FillRule::EvenOdd => winding % 2 != 0,
        }
    }
}

/// A line in the plane: where `n . p + c = 0`. Its left side is where that is positive.
#[derive(Clone, Copy)]
pub(super) struct PlaneLine {
    pub n: DVec2,
    pub c: f64,
    /// More than the rounding of the sum.
    pub rounding: f64,
}

impl PlaneLine {
    /// * `reach`: the largest coordinate of points that will be asked for
    pub fn new(n: DVec2, c: f64, reach: f64) -> PlaneLine {
        let rounding = 8.0 * f64::EPSILON * ((n.x.abs() + n.y.abs()) * reach + c.abs());
        PlaneLine { n, c, rounding }
    }

    /// Twice, or some times, the distance of a point, with the sign of its side.
    #[inline]
    pub fn side(&self, p: DVec2) -> f64 {
        self.n.x * p.x + self.n.y * p.y + self.c
    }

    /// Whether any point of a box may be on the line, or be found on another side than a neighbour.
    #[inline]
    pub fn overlaps(&self, [min, max]: [DVec2; 2]) -> bool {
        let (middle, half) = (0.5 * (min + max), 0.5 * (max - min));
        let reach = self.n.x.abs() * half.x + self.n.y.abs() * half.y + self.rounding;
        // Not for boxes of nothing.
        self.side(middle).abs() <= reach
    }

    /// Visits the parameters at which a curve crosses the line, and whether it comes from the right.
    pub fn crossings(&self, curve: &Bezier<DVec2>, mut visit: impl FnMut(f64, bool)) {
        let sides = curve.map(|p| self.side(p));
        let mut from_right = sides.start() < 0.0;
        let mut add = |s: f64| {
            visit(s, from_right);
            from_right = !from_right;
        };
        match *sides.points() {
            [a, b] if (a < 0.0) != (b < 0.0) => add(a / (a - b)),
            [a, b, c] => roots::sign_changes(&[a, b, c], add),
            [a, b, c, d] => roots::sign_changes(&[a, b, c, d], add),
            _ => {}
        }
    }
}

/// A crossing of a line with a curve.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    /// Where on the line.
    pub t: f64,
    /// Which curve, and where on it.
    pub curve: u32,
    pub s: f64,
    /// Whether the curve comes from the right, that is, whether what is behind the crossing has the curve on its right.
    pub from_right: bool,
}

impl Crossing {
    fn change(&self) -> i32 {
        if self.from_right { 1 } else { -1 }
    }
}

/// An end of a piece of a line that is inside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Border {
    pub t: f64,
    /// The curve that ends it; none where the piece has no end.
    pub curve: Option<BorderCurve>,
}

/// The place of a curve that has the inside on one side of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct BorderCurve {
    pub curve: u32,
    pub s: f64,
    /// Whether the outside is on its left.
    pub outside_left: bool,
}

impl Border {
    fn new(crossing: &Crossing, enters: bool) -> Border {
        let outside_left = crossing.from_right == enters;
        let curve = Some(BorderCurve { curve: crossing.curve, s: crossing.s, outside_left });
        Border { t: crossing.t, curve }
    }
}

/// Visits the pieces of a line that are inside, in ascending order.
///
/// * `crossings`: all of them; they are sorted
/// * `before`: the winding number before the first
/// * `nearer`: crossings that are nearer to each other are one
pub(super) fn inside_intervals(
    crossings: &mut [Crossing],
    rule: FillRule,
    before: i32,
    nearer: f64,
    mut visit: impl FnMut([Border; 2]),
) {
    crossings.sort_unstable_by(|a, b| a.t.total_cmp(&b.t));
    let mut emit = |piece: [Border; 2]| {
        if piece[1].t - piece[0].t > nearer {
            visit(piece);
        }
    };
    let mut winding = before;
    let mut open = rule.fills(before).then_some(Border { t: f64::NEG_INFINITY, curve: None });
    let mut last: Option<[Border; 2]> = None;
    let mut close = |open: Border, end: Border| {
        last = Some(match last {
            Some([first, middle]) if open.t - middle.t <= nearer => [first, end],
            Some(piece) => {
                emit(piece);
                [open, end]
            }
            None => [open, end],
        });
    };
    for crossing in &*crossings {
        let was_inside = rule.fills(winding);
        winding += crossing.change();
        match (was_inside, rule.fills(winding), open) {
            (false, true, _) => open = Some(Border::new(crossing, true)),
            (true, false, Some(start)) => close(start, Border::new(crossing, false)),
            _ => {}
        }
    }
    if let Some(start) = open.filter(|_| rule.fills(winding)) {
        close(start, Border { t: f64::INFINITY, curve: None });
    }
    last.into_iter().for_each(emit);
}

/// A binary tree over boxes in the plane, in double precision: neighbours in their order are neighbours in the tree.
#[derive(Clone, Debug)]
pub(super) struct BoxTree {
    /// Node `i` has the children `2 i` and `2 i + 1`, the root is 1.
    boxes: Vec<[DVec2; 2]>,
}

impl BoxTree {
    pub fn new(leaves: &[[DVec2; 2]]) -> BoxTree {
        let width = leaves.len().next_power_of_two();
        let nothing = [DVec2::INFINITY, DVec2::NEG_INFINITY];
        let mut boxes = vec![nothing; 2 * width];
        boxes[width..width + leaves.len()].copy_from_slice(leaves);
        for i in (1..width).rev() {
            let [a, b] = [boxes[2 * i], boxes[2 * i + 1]];
            boxes[i] = [a[0].min(b[0]), a[1].max(b[1])];
        }
        BoxTree { boxes }
    }

    /// Visits the leaves that a test leaves over, in their order.
    pub fn each(&self, meets: impl Fn([DVec2; 2]) -> bool, mut visit: impl FnMut(u32)) {
        let width = self.boxes.len() / 2;
        let mut stack = [0; usize::BITS as usize];
        let (mut node, mut depth) = (1, 0);
        loop {
            if meets(self.boxes[node]) {
                if node < width {
                    stack[depth] = 2 * node + 1;
                    depth += 1;
                    node *= 2;
                    continue;
                }
                visit((node - width) as u32);
            }
            if depth == 0 {
                return;
            }
            depth -= 1;
            node = stack[depth];
        }
    }

    /// Visits leaves whose boxes are nearer to a point than what has been found, nearer ones first where that is cheap.
    ///
    /// * `nearest`: square of the distance beyond which nothing is asked for
    /// * `visit`: gives the square of the distance to a leaf
    pub fn each_near(&self, p: DVec2, mut nearest: f64, mut visit: impl FnMut(u32) -> f64) {
        let width = self.boxes.len() / 2;
        let apart = |node: usize| {
            let [min, max] = self.boxes[node];
            (min - p).max(p - max).max(DVec2::ZERO).length_squared()
        };
        let mut stack = [(0, 0.0); usize::BITS as usize];
        let (mut node, mut distance, mut depth) = (1, apart(1), 0);
        loop {
            if distance < nearest {
                if node < width {
                    let [a, b] = [2 * node, 2 * node + 1].map(|child| (child, apart(child)));
                    let (near, far) = if a.1 <= b.1 { (a, b) } else { (b, a) };
                    stack[depth] = far;
                    depth += 1;
                    (node, distance) = near;
                    continue;
                }
                nearest = nearest.min(visit((node - width) as u32));
            }
            if depth == 0 {
                return;
            }
            depth -= 1;
            (node, distance) = stack[depth];
        }
    }

    /// The box around all.
    pub fn bounds(&self) -> [DVec2; 2] {
        self.boxes[1]
    }

    pub fn bytes(&self) -> usize {
        size_of_val(&*self.boxes)
    }
}

/// A box around a curve: that of the control points of pieces of it.
pub(super) fn box_of(curve: &Bezier<DVec2>) -> [DVec2; 2] {
    const LEVELS: u32 = 3;
    let pieces = curve.subdivided(if curve.points().len() > 2 { LEVELS } else { 0 });
    let points = pieces.iter().flat_map(Bezier::points);
    points.fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[min, max], p| [min.min(*p), max.max(*p)])
}

/// How often curves go around a point, by what is on the right of it.
pub(super) fn winding(curves: &[Bezier<DVec2>], p: DVec2) -> i32 {
    let right = PlaneLine { n: DVec2::Y, c: -p.y, rounding: 0.0 };
    let mut winding = 0;
    for curve in curves {
        right.crossings(curve, |s, from_right| {
            if curve.at(s).x > p.x {
                winding += if from_right { 1 } else { -1 };
            }
        });
    }
    winding
}

/// What each of several curves has of the way along all of them: from where, and how much.
pub(super) fn shares(curves: &[Bezier<DVec2>]) -> Vec<[f64; 2]> {
    let lengths: Vec<f64> = curves.iter().map(length).collect();
    let whole: f64 = lengths.iter().sum();
    let mut from = 0.0;
    let share = |length: &f64| {
        let share = [from, length / whole];
        from += share[1];
        share
    };
    lengths.iter().map(share).collect()
}

/// About the length of a curve.
fn length(curve: &Bezier<DVec2>) -> f64 {
    const STEPS: u32 = 16;
    let steps = if curve.points().len() > 2 { STEPS } else { 1 };
    let at = |i: u32| curve.at(f64::from(i) / f64::from(steps));
    (0..steps).map(|i| at(i).distance(at(i + 1))).sum()
}

/// The parameter of the place of a curve that is nearest to a point, by Newton's method from `s`.
pub(super) fn nearest_parameter(curve: &Bezier<DVec2>, p: DVec2, mut s: f64) -> f64 {
    const STEPS: u32 = 3;
    for _ in 0..STEPS {
        let tangent = curve.derivative(s);
        let step = (p - curve.at(s)).dot(tangent) / tangent.length_squared();
        s = if step.is_finite() { (s + step).clamp(0.0, 1.0) } else { s };
    }
    s
}

/// Straight pieces that stand for a curve.
pub(super) fn segments(curve: &Bezier<DVec2>, around: u32) -> u32 {
    let legs: Vec<DVec2> = curve.points().windows(2).map(|pair| pair[1] - pair[0]).collect();
    let turn: f64 = legs
        .windows(2)
        .map(|pair| kajo_math::fmath::atan2_64(pair[0].perp_dot(pair[1]), pair[0].dot(pair[1])).abs())
        .sum();
    let even = turn / std::f64::consts::TAU * f64::from(around);
    // Where a curve turns most is as long as the rest of it in parameters.
    (2.0 * even).ceil().clamp(1.0, 1024.0) as u32
}

/// The direction of a curve, also where its derivative vanishes.
pub(super) fn direction(curve: &Bezier<DVec2>, s: f64) -> DVec2 {
    let tangent = curve.derivative(s);
    if tangent != DVec2::ZERO { tangent } else { curve.derivative(s + 1e-6 * (0.5 - s)) }
}
