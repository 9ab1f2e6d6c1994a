//! What polygons enclose, as triangles.
//!
//! The plane is cut into bands at the height of every corner and every crossing of two sides. In a band sides do not cross, so
//! in their order from left to right the winding numbers between them say what is inside: trapezoids. Those of successive bands
//! between the same two sides are one.

use std::collections::HashMap;

use kajo_math::DVec2;

use super::FillRule;

/// Among more sides crossings are not looked for.
const MOST_CROSSED: usize = 2000;

/// A side of a polygon that is not level, upwards.
#[derive(Clone, Copy)]
struct Side {
    low: DVec2,
    high: DVec2,
    /// What the winding number changes by, from left to right.
    change: i32,
}

impl Side {
    fn x_at(&self, y: f64) -> f64 {
        let share = (y - self.low.y) / (self.high.y - self.low.y);
        if share >= 1.0 { self.high.x } else { self.low.x + share * (self.high.x - self.low.x) }
    }

    /// The height at which two sides cross.
    fn crossing(&self, other: &Side) -> Option<f64> {
        let (a, b) = (self.high - self.low, other.high - other.low);
        let s = (other.low - self.low).perp_dot(b) / a.perp_dot(b);
        let y = self.low.y + s * a.y;
        let within = |side: &Side| side.low.y < y && y < side.high.y;
        (within(self) && within(other)).then_some(y)
    }
}

/// Triangles, counter-clockwise, that cover what closed polygons enclose, once.
pub(super) fn fill(polygons: &[Vec<DVec2>], rule: FillRule) -> Vec<[DVec2; 3]> {
    let mut sides = sides(polygons);
    sides.sort_unstable_by(|a, b| a.low.y.total_cmp(&b.low.y));
    let heights = heights(&sides);
    let (mut triangles, mut active, mut next) = (Vec::new(), Vec::<usize>::new(), 0);
    // The lower edges of trapezoids that go on, by their two sides.
    let mut open: HashMap<[usize; 2], f64> = HashMap::new();
    for band in heights.windows(2) {
        let (low, middle) = (band[0], 0.5 * (band[0] + band[1]));
        active.retain(|&i| sides[i].high.y > middle);
        while next < sides.len() && sides[next].low.y <= low {
            active.extend((sides[next].high.y > middle).then_some(next));
            next += 1;
        }
        active.sort_unstable_by(|&a, &b| sides[a].x_at(middle).total_cmp(&sides[b].x_at(middle)));
        let mut going_on = HashMap::new();
        let (mut winding, mut left) = (0, None);
        for &i in &active {
            let was_inside = rule.fills(winding);
            winding += sides[i].change;
            match (was_inside, rule.fills(winding), left) {
                (false, true, _) => left = Some(i),
                (true, false, Some(from)) => {
                    let key = [from, i];
                    going_on.insert(key, open.remove(&key).unwrap_or(low));
                }
                _ => {}
            }
        }
        close(&sides, &mut open, low, &mut triangles);
        open = going_on;
    }
    close(&sides, &mut open, heights.last().copied().unwrap_or(0.0), &mut triangles);
    triangles
}

fn sides(polygons: &[Vec<DVec2>]) -> Vec<Side> {
    let mut sides = Vec::new();
    for polygon in polygons {
        for (i, &a) in polygon.iter().enumerate() {
            let b = polygon[(i + 1) % polygon.len()];
            if a.y < b.y {
                sides.push(Side { low: a, high: b, change: -1 });
            } else if a.y > b.y {
                sides.push(Side { low: b, high: a, change: 1 });
            }
        }
    }
    sides
}

/// Where bands begin and end, ascending.
fn heights(sides: &[Side]) -> Vec<f64> {
    let mut heights: Vec<f64> = sides.iter().flat_map(|side| [side.low.y, side.high.y]).collect();
    if sides.len() <= MOST_CROSSED {
        for (i, side) in sides.iter().enumerate() {
            let near = sides[i + 1..].iter().take_while(|other| other.low.y < side.high.y);
            heights.extend(near.filter_map(|other| side.crossing(other)));
        }
    }
    heights.sort_unstable_by(f64::total_cmp);
    heights.dedup();
    heights
}

/// Adds the trapezoids that end at a height, in the order of their sides.
fn close(sides: &[Side], open: &mut HashMap<[usize; 2], f64>, high: f64, out: &mut Vec<[DVec2; 3]>) {
    let mut ended: Vec<([usize; 2], f64)> = open.drain().collect();
    ended.sort_unstable_by_key(|(key, _)| *key);
    for ([left, right], low) in ended {
        let at = |i: usize, y: f64| DVec2::new(sides[i].x_at(y), y);
        let [a, b, c, d] = [at(left, low), at(right, low), at(right, high), at(left, high)];
        out.extend([[a, b, c], [a, c, d]].into_iter().filter(|[a, b, c]| (b - a).perp_dot(c - a) > 0.0));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(polygons: &[&[[f64; 2]]], rule: FillRule) -> f64 {
        let polygons: Vec<Vec<DVec2>> =
            polygons.iter().map(|polygon| polygon.iter().copied().map(DVec2::from_array).collect()).collect();
        fill(&polygons, rule).iter().map(|[a, b, c]| 0.5 * (b - a).perp_dot(c - a)).sum()
    }

    #[test]
    fn areas_are_those_of_the_rule() {
        let square: &[[f64; 2]] = &[[0., 0.], [3., 0.], [3., 3.], [0., 3.]];
        let hole: &[[f64; 2]] = &[[1., 1.], [2., 1.], [2., 2.], [1., 2.]];
        let turned: &[[f64; 2]] = &[[1., 2.], [2., 2.], [2., 1.], [1., 1.]];
        let both = [FillRule::NonZero, FillRule::EvenOdd];
        assert_eq!(both.map(|rule| area(&[square], rule)), [9.0, 9.0]);
        assert_eq!(both.map(|rule| area(&[square, hole], rule)), [9.0, 8.0]);
        assert_eq!(both.map(|rule| area(&[square, turned], rule)), [8.0, 8.0]);
        // A bow tie, whose sides cross in the middle.
        let tie: &[[f64; 2]] = &[[0., 0.], [2., 2.], [2., 0.], [0., 2.]];
        assert!(both.iter().all(|&rule| (area(&[tie], rule) - 2.0).abs() < 1e-15));
        assert_eq!(area(&[&[[0., 0.], [1., 1.]], &[]], FillRule::NonZero), 0.0);
    }

    /// A star of five points: with the pentagon in its middle, which is gone around twice, or without.
    #[test]
    fn stars_that_cross_themselves() {
        let point = |i: u32| {
            let angle = f64::from(i) * 0.8 * std::f64::consts::PI;
            [angle.cos(), angle.sin()]
        };
        let star: Vec<[f64; 2]> = (0..5).map(point).collect();
        // The inner radius is that of the outer over the square of the golden ratio.
        let golden = 0.5 * (1.0 + 5f64.sqrt());
        let inner = golden.powi(-2);
        let tenth = std::f64::consts::PI / 5.0;
        let (whole, pentagon) = (5.0 * inner * tenth.sin(), 2.5 * inner * inner * (2.0 * tenth).sin());
        assert!((area(&[&star], FillRule::NonZero) - whole).abs() < 1e-12);
        assert!((area(&[&star], FillRule::EvenOdd) - (whole - pentagon)).abs() < 1e-12);
    }
}
