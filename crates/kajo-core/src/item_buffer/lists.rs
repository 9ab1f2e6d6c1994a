//! Who is seen in which cell.
//!
//! A box `[x] x [y] x [w]` has coordinates within the quotients of intervals `[x] / [w]` and `[y] / [w]`. A sphere at
//! distance `l` fills a cone with `sin(beta) = r / l`; a cell lies in a cone of half angle `alpha` around its middle
//! `m`, so they meet only where `m` is within `alpha + beta` of the sphere's centre, and the sphere hides everything
//! behind it where `m` is within `beta - alpha`.

use std::ops::{Range, RangeInclusive};

use kajo_math::{DVec2, DVec3};

use super::{BufferedObject, Cell, Face, Item, LONGEST, UNIT};
use crate::ids::ObjectId;
use crate::shape::Sphere;

/// Least number of cells for each primitive that a face shows.
const CELLS_PER_ITEM: usize = 4;

/// Cells across a face.
const SIDE: RangeInclusive<usize> = 8..=512;

/// What `u` and `v` are widened by against their rounding, which is a few times 2^-24.
const PAD: f64 = 1e-6;

/// Above the relative rounding of a distance in single precision.
const ROUNDING: f64 = 1e-6;

/// More than the parameter up to which rays may ignore hits; see [`crate::RayOffset::Reference`].
const IGNORED: f64 = 2e-3;

/// The faces around a point, their cells and the lists of these.
///
/// * `slack`: what bodies are taken for larger by
/// * `cells`: how many there shall be, about
pub(super) fn around(
    center: DVec3,
    bodies: &[BufferedObject],
    slack: f64,
    cells: usize,
) -> ([Face; 6], Vec<Cell>, Vec<Item>) {
    let mut outlines: Vec<Outline> = bodies.iter().map(|b| Outline::new(b, center, slack)).collect();
    outlines.sort_by(|a, b| a.near.total_cmp(&b.near));
    let seen = [0, 1, 2, 3, 4, 5].map(|face| VisibleOutline::through(face, &outlines));
    let shown: usize = seen.iter().map(Vec::len).sum();
    let mut lists = Lists::default();
    let faces = [0, 1, 2, 3, 4, 5].map(|face| {
        let bodies = &seen[face];
        lists.draw(face, bodies, cells * bodies.len() / shown.max(1))
    });
    let (cells, items) = lists.finish();
    (faces, cells, items)
}

/// A body as it looks from the apex, larger by the slack.
struct Outline {
    object: ObjectId,
    near: f64,
    /// Corners of the bounds, relative to the apex.
    lo: DVec3,
    hi: DVec3,
    cone: Option<Cone>,
}

/// The directions of a sphere.
struct Cone {
    /// Unit vector to its centre.
    axis: DVec3,
    /// Sine and cosine of the half angle of all that it might fill.
    outer: [f64; 2],
    /// Sine and cosine of the half angle of what it surely hides, and the distance behind which it does.
    hidden: Option<([f64; 2], f64)>,
}

impl Outline {
    fn new(body: &BufferedObject, center: DVec3, slack: f64) -> Outline {
        let lo = body.bounds.min.as_dvec3() - center - slack;
        let hi = body.bounds.max.as_dvec3() - center + slack;
        let cone = body.sphere.and_then(|sphere| Cone::new(&sphere, body.opaque, center, slack));
        let near = match &body.sphere {
            Some(sphere) => sphere.center.as_dvec3().distance(center) - f64::from(sphere.radius) - slack,
            None => lo.max(-hi).max(DVec3::ZERO).length(),
        };
        Outline { object: body.object, near, lo, hi, cone }
    }

    /// The window of a face through which the body may be seen, if any: smallest and largest `u` and `v`.
    fn window(&self, face: usize) -> Option<[[f64; 2]; 2]> {
        let axis = face / 2;
        let (near, far) = if face.is_multiple_of(2) {
            (self.lo[axis].max(0.0), self.hi[axis])
        } else {
            ((-self.hi[axis]).max(0.0), -self.lo[axis])
        };
        if far <= 0.0 {
            return None;
        }
        let interval = |axis: usize| {
            let (lo, hi) = (self.lo[axis], self.hi[axis]);
            let least = lo / if lo < 0.0 { near } else { far };
            let most = hi / if hi > 0.0 { near } else { far };
            [(least - PAD).max(-1.0 - PAD), (most + PAD).min(1.0 + PAD)]
        };
        let window = [interval((axis + 1) % 3), interval((axis + 2) % 3)];
        window.iter().all(|[least, most]| least <= most).then_some(window)
    }
}

impl Cone {
    /// `None` where the apex is inside the sphere or next to it.
    fn new(sphere: &Sphere, opaque: bool, center: DVec3, slack: f64) -> Option<Cone> {
        let to = sphere.center.as_dvec3() - center;
        let (l, r) = (to.length(), f64::from(sphere.radius));
        let half_angle = |r: f64| {
            let sin = r / l;
            [sin, (1.0 - sin * sin).sqrt()]
        };
        if r + slack >= l {
            return None;
        }
        let hides = opaque && r > slack;
        let hidden = hides.then(|| (half_angle(r - slack), l + r + slack + IGNORED));
        Some(Cone { axis: to / l, outer: half_angle(r + slack), hidden })
    }
}

/// A body and the window of a face through which it is seen.
struct VisibleOutline<'a> {
    outline: &'a Outline,
    window: [[f64; 2]; 2],
}

impl<'a> VisibleOutline<'a> {
    /// What is seen through a face, in the same order.
    fn through(face: usize, outlines: &'a [Outline]) -> Vec<VisibleOutline<'a>> {
        let seen = |outline: &'a Outline| Some(VisibleOutline { outline, window: outline.window(face)? });
        outlines.iter().filter_map(seen).collect()
    }
}

/// Lists of all cells while they are made.
#[derive(Default)]
struct Lists {
    cells: Vec<Growing>,
    entries: Vec<(u32, Item)>,
}

/// A cell while its list is made.
#[derive(Clone, Copy)]
struct Growing {
    len: u32,
    /// The distance behind which everything is hidden.
    hidden_beyond: f64,
}

impl Lists {
    /// Adds the grid of a face and what is seen through it, sorted from near to far.
    fn draw(&mut self, face: usize, seen: &[VisibleOutline<'_>], cells: usize) -> Face {
        let first = self.cells.len();
        let Some(whole) = seen.iter().map(|body| body.window).reduce(|[a, b], [c, d]| {
            let union = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
            [union(a, c), union(b, d)]
        }) else {
            return Face::default();
        };
        let wanted = (cells.max(CELLS_PER_ITEM * seen.len()) as f64).sqrt() as usize;
        let side = wanted.clamp(*SIDE.start(), *SIDE.end());
        let grid = Grid::new(face, whole, side);
        self.cells.resize(first + side * side, Growing { len: 0, hidden_beyond: f64::INFINITY });
        for body in seen {
            self.add(first, body, &grid);
        }
        Face {
            start: grid.start.map(|x| x as f32),
            scale: grid.step.map(|x| 1.0 / x as f32),
            side: side as u32,
            first: first as u32,
        }
    }

    /// Adds a body to all cells of a grid where it can be seen.
    fn add(&mut self, first: usize, body: &VisibleOutline<'_>, grid: &Grid) {
        let outline = body.outline;
        // A ray's parameter differs from its distance by half of `UNIT`.
        let near = (outline.near * (1.0 - f64::from(UNIT))) as f32;
        let item = Item { object: outline.object, near };
        let extent = outline.cone.as_ref().map(|cone| Extent::new(cone, grid));
        let [columns, rows] = grid.cells(body.window);
        for row in rows {
            let start = first + row * grid.side;
            for column in columns.clone() {
                let growing = &mut self.cells[start + column];
                if outline.near > growing.hidden_beyond || growing.len as usize > LONGEST {
                    continue;
                }
                if let Some(extent) = &extent {
                    let [u, v] = grid.middle([column, row]);
                    let (along, length) = extent.cosine(u, v);
                    if along < extent.outer * length {
                        continue;
                    }
                    if along > extent.hidden * length {
                        growing.hidden_beyond = growing.hidden_beyond.min(extent.hides_beyond);
                    }
                }
                growing.len += 1;
                self.entries.push(((start + column) as u32, item));
            }
        }
    }

    /// The lists one after another. Entries of a cell stay in their order.
    fn finish(self) -> (Vec<Cell>, Vec<Item>) {
        let mut end = 0;
        let place = |growing: &Growing| {
            let hidden_beyond = (growing.hidden_beyond * (1.0 + ROUNDING)) as f32;
            let cell = Cell { first: end, len: growing.len, hidden_beyond };
            end += growing.len;
            cell
        };
        let cells: Vec<Cell> = self.cells.iter().map(place).collect();
        let mut next: Vec<u32> = cells.iter().map(|cell| cell.first).collect();
        let mut items = vec![Item { object: ObjectId::NONE, near: 0.0 }; self.entries.len()];
        for (cell, item) in self.entries {
            let next = &mut next[cell as usize];
            items[*next as usize] = item;
            *next += 1;
        }
        (cells, items)
    }
}

/// The cells of a face while they are filled.
struct Grid {
    face: usize,
    side: usize,
    start: [f64; 2],
    step: [f64; 2],
    /// Sine and cosine of a bound on the half angle of any cell.
    half_angle: [f64; 2],
}

impl Grid {
    fn new(face: usize, window: [[f64; 2]; 2], side: usize) -> Grid {
        let step = window.map(|[least, most]| (most - least) / side as f64);
        // Points of a plane at distance 1 that are `h` apart are seen under at most `2 atan(h / 2)`.
        let h = 0.5 * DVec2::from_array(step).length() + PAD;
        let tan = h / (1.0 - 0.25 * h * h);
        let cos = 1.0 / (1.0 + tan * tan).sqrt();
        Grid { face, side, start: window.map(|[least, _]| least), step, half_angle: [tan * cos, cos] }
    }

    /// Columns and rows of the cells that a window touches.
    fn cells(&self, window: [[f64; 2]; 2]) -> [Range<usize>; 2] {
        [0, 1].map(|i| {
            let place = |x: f64| (((x - self.start[i]) / self.step[i]).max(0.0) as usize).min(self.side - 1);
            place(window[i][0])..place(window[i][1]) + 1
        })
    }

    /// The coordinates of the middle of a cell.
    #[inline]
    fn middle(&self, place: [usize; 2]) -> [f64; 2] {
        [0, 1].map(|i| self.start[i] + (place[i] as f64 + 0.5) * self.step[i])
    }
}

/// A sphere's cone as the cells of a grid see it.
struct Extent {
    /// Components of its axis along `u`, along `v` and towards the face.
    axis: [f64; 3],
    /// Cells with a smaller cosine between middle and axis see nothing of it.
    outer: f64,
    /// Cells with a larger one see nothing beside it.
    hidden: f64,
    /// The distance behind which it hides everything in the latter.
    hides_beyond: f64,
}

impl Extent {
    fn new(cone: &Cone, grid: &Grid) -> Extent {
        let axis = grid.face / 2;
        let ahead = if grid.face.is_multiple_of(2) { cone.axis[axis] } else { -cone.axis[axis] };
        // Within the sum of two angles, and within their difference.
        let ([sin_a, cos_a], [sin_b, cos_b]) = (grid.half_angle, cone.outer);
        let (hidden, hides_beyond) = match cone.hidden {
            Some(([sin_b, cos_b], far)) if sin_b > sin_a => (cos_a * cos_b + sin_a * sin_b, far),
            _ => (f64::INFINITY, f64::INFINITY),
        };
        Extent {
            axis: [cone.axis[(axis + 1) % 3], cone.axis[(axis + 2) % 3], ahead],
            outer: cos_a * cos_b - sin_a * sin_b,
            hidden,
            hides_beyond,
        }
    }

    /// The cosine between the axis and the direction to `(u, v)` times the length of the latter, and that length.
    #[inline]
    fn cosine(&self, u: f64, v: f64) -> (f64, f64) {
        let [x, y, z] = self.axis;
        (x * u + y * v + z, (1.0 + u * u + v * v).sqrt())
    }
}
