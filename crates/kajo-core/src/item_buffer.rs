//! Which primitives lie in which direction from a point.
//!
//! Camera rays of a pinhole camera start at one point, shadow rays of a point light end at one. The
//! directions from such an apex are divided into cells once, and each cell lists what can be met there,
//! nearest first. A ray then asks a short list instead of a tree [Weghorst, Hooper and Greenberg 1984],
//! [Haines and Greenberg 1986].
//!
//! The cells are those of six grids on a cube around the apex. A direction `d` whose largest coordinate is
//! `d_a` belongs to the face of that axis and sign, at
//!
//! ```text
//! u = d_b / |d_a|,    v = d_c / |d_a|,    a, b, c in cyclic order.
//! ```
//!
//! Each grid covers only the window of its face behind which there is anything. A box `[x] x [y] x [w]` has
//! coordinates within the quotients of intervals `[x] / [w]` and `[y] / [w]`. A sphere at distance `l` fills a
//! cone with `sin(beta) = r / l`; a cell lies in a cone of half angle `alpha` around its middle `m`, so
//! they meet only where `m` is within `alpha + beta` of the sphere's centre, and the sphere hides everything
//! behind it where `m` is within `beta - alpha`. A cell remembers from which distance on that is so: what is
//! farther away is in its shadow, whatever else is there. The finer the grid, the more is known without asking
//! a single primitive.
//!
//! Lists are conservative: everything is taken for larger by `slack`, and only rays that keep to the lines through
//! the apex within half of that are answered. What a ray hits is therefore the same, bit for bit, with and without.

use kajo_math::{Aabb, DVec2, DVec3, Ray, Vec3};

use crate::shape::Sphere;

/// Least number of cells for each primitive that a face shows.
const CELLS_PER_ITEM: usize = 4;

/// Cells across a face.
const SIDE: std::ops::RangeInclusive<usize> = 8..=512;

/// Longest list of a cell; where there is more, a tree is faster.
const LONGEST: usize = 24;

/// What everything is larger by, relative to the distance of the farthest primitive: above all rounding, far below
/// the size of a cell.
const SLACK: f64 = 1.0 / 8192.0;

/// Rays that start farther away than this many times the farthest primitive are not answered: their own rounding
/// comes near the slack.
const REACH: f64 = 16.0;

/// What `u` and `v` are widened by against their rounding, which is a few times 2^-24.
const PAD: f64 = 1e-6;

/// Above the relative rounding of a distance in single precision.
const ROUNDING: f64 = 1e-6;

/// How far the squared length of a unit vector may be from 1.
const UNIT: f32 = 1e-5;

/// More than the parameter up to which rays may ignore hits; see [`crate::RayOffset::Reference`].
const IGNORED: f64 = 2e-3;

/// What is put into a buffer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Body {
    /// The caller's number.
    pub primitive: u32,
    /// Finite bounds.
    pub bounds: Aabb,
    /// The shape, if it is a sphere.
    pub sphere: Option<Sphere>,
    /// Whether nothing behind it matters.
    pub opaque: bool,
}

/// An entry of a cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Item {
    pub primitive: u32,
    /// No point of the primitive is nearer to the apex.
    pub near: f32,
}

/// For every direction from a point, what lies there.
#[derive(Clone, Debug)]
pub struct ItemBuffer {
    apex: Vec3,
    slack: f32,
    reach: f32,
    /// By axis, and for each the positive direction first.
    faces: [Face; 6],
    cells: Vec<Cell>,
    items: Vec<Item>,
}

/// A grid over a window of a face.
#[derive(Clone, Copy, Debug, Default)]
struct Face {
    /// Smallest `u` and `v`.
    start: [f32; 2],
    /// Cells per unit of `u` and `v`.
    scale: [f32; 2],
    /// Cells across; 0 where there is nothing to see.
    side: u32,
    /// Number of the first cell.
    first: u32,
}

/// A list of items, or too many for one.
#[derive(Clone, Copy, Debug)]
struct Cell {
    first: u32,
    len: u32,
    /// The distance beyond which something opaque hides everything.
    hidden_beyond: f32,
}

/// What is between the apex and a point.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Between<'a> {
    /// Something opaque, for sure.
    Blocked,
    /// None but the first of these, up to this distance from the apex.
    Items(&'a [Item], f32),
}

impl ItemBuffer {
    /// A buffer around `apex`, or `None` when there is nothing to put in or the apex is not finite.
    ///
    /// * `cells`: how many directions to tell apart, about; more where the bodies are many
    pub(crate) fn new(apex: Vec3, bodies: &[Body], cells: usize) -> Option<ItemBuffer> {
        let center = apex.as_dvec3();
        let farthest = |b: &Body| {
            let (lo, hi) = (b.bounds.min.as_dvec3() - center, b.bounds.max.as_dvec3() - center);
            lo.abs().max(hi.abs()).length()
        };
        let extent = bodies.iter().map(farthest).fold(0.0, f64::max);
        let slack = (SLACK * extent).max(32.0 * f64::from(f32::EPSILON) * center.abs().max_element());
        if !(extent > 0.0 && slack.is_finite()) {
            return None;
        }
        let mut outlines: Vec<Outline> = bodies.iter().map(|b| Outline::new(b, center, slack)).collect();
        outlines.sort_by(|a, b| a.near.total_cmp(&b.near));
        let seen = [0, 1, 2, 3, 4, 5].map(|face| Seen::through(face, &outlines));
        let shown: usize = seen.iter().map(Vec::len).sum();
        let mut lists = Lists::default();
        let faces = [0, 1, 2, 3, 4, 5].map(|face| {
            let bodies = &seen[face];
            lists.draw(face, bodies, cells * bodies.len() / shown.max(1))
        });
        let (cells, items) = lists.finish();
        Some(ItemBuffer {
            apex,
            slack: 0.5 * slack as f32,
            reach: (REACH * extent) as f32,
            faces,
            cells,
            items,
        })
    }

    /// What a ray may meet, nearest first; `None` where that is too much for a list, or the ray does not start at
    /// the apex with a direction of unit length.
    #[inline]
    pub(crate) fn seen_along(&self, ray: &Ray) -> Option<&[Item]> {
        let unit = (ray.d.length_squared() - 1.0).abs() < UNIT;
        if !(unit && ray.o == self.apex && ray.t_min >= 0.0) {
            return None;
        }
        self.cell(ray.d).map_or(Some(&[]), |cell| self.list(cell))
    }

    /// What a ray that ends at the apex may meet, those nearest to the apex first; `None` where that is too much for a
    /// list, or the ray does not end close enough to the apex.
    #[inline(always)]
    pub(crate) fn between(&self, ray: &Ray) -> Option<Between<'_>> {
        let from_apex = ray.o - self.apex;
        let miss = from_apex + ray.t_max * ray.d;
        let close = miss.abs().max_element() <= self.slack && from_apex.abs().max_element() <= self.reach;
        if !close {
            return None;
        }
        let Some(cell) = self.cell(from_apex) else { return Some(Between::Items(&[], 0.0)) };
        let distance = from_apex.length();
        if distance > cell.hidden_beyond {
            return Some(Between::Blocked);
        }
        Some(Between::Items(self.list(cell)?, distance * (1.0 + 8.0 * f32::EPSILON)))
    }

    /// The cell of a direction; none where there is nothing.
    #[inline]
    fn cell(&self, d: Vec3) -> Option<&Cell> {
        let a = d.abs();
        let (axis, [w, u, v]) = if a.x >= a.y && a.x >= a.z {
            (0, [d.x, d.y, d.z])
        } else if a.y >= a.z {
            (1, [d.y, d.z, d.x])
        } else {
            (2, [d.z, d.x, d.y])
        };
        let face = &self.faces[2 * axis + usize::from(w < 0.0)];
        let inverse = 1.0 / w.abs();
        let x = (u * inverse - face.start[0]) * face.scale[0];
        let y = (v * inverse - face.start[1]) * face.scale[1];
        let side = face.side as f32;
        // Outside the window there is nothing, and no direction at all leads nowhere.
        let within = x >= 0.0 && y >= 0.0 && x < side && y < side;
        let place = || (face.first + y as u32 * face.side + x as u32) as usize;
        if within { self.cells.get(place()) } else { None }
    }

    /// The items of a cell, unless there are too many.
    #[inline]
    fn list(&self, cell: &Cell) -> Option<&[Item]> {
        let Cell { first, len, .. } = *cell;
        if len as usize > LONGEST {
            return None;
        }
        Some(&self.items[first as usize..(first + len) as usize])
    }

    /// Bytes kept.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.cells) + size_of_val(&*self.items)
    }
}

/// A body as it looks from the apex, larger by the slack.
struct Outline {
    primitive: u32,
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
    fn new(body: &Body, center: DVec3, slack: f64) -> Outline {
        let lo = body.bounds.min.as_dvec3() - center - slack;
        let hi = body.bounds.max.as_dvec3() - center + slack;
        let cone = body.sphere.and_then(|sphere| Cone::new(&sphere, body.opaque, center, slack));
        let near = match &body.sphere {
            Some(sphere) => sphere.center.as_dvec3().distance(center) - f64::from(sphere.radius) - slack,
            None => lo.max(-hi).max(DVec3::ZERO).length(),
        };
        Outline { primitive: body.primitive, near, lo, hi, cone }
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
struct Seen<'a> {
    outline: &'a Outline,
    window: [[f64; 2]; 2],
}

impl<'a> Seen<'a> {
    /// What is seen through a face, in the same order.
    fn through(face: usize, outlines: &'a [Outline]) -> Vec<Seen<'a>> {
        let seen = |outline: &'a Outline| Some(Seen { outline, window: outline.window(face)? });
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
    fn draw(&mut self, face: usize, seen: &[Seen<'_>], cells: usize) -> Face {
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
    fn add(&mut self, first: usize, body: &Seen<'_>, grid: &Grid) {
        let outline = body.outline;
        // A ray's parameter differs from its distance by half of `UNIT`.
        let near = (outline.near * (1.0 - f64::from(UNIT))) as f32;
        let item = Item { primitive: outline.primitive, near };
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
        let mut items = vec![Item { primitive: 0, near: 0.0 }; self.entries.len()];
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
    fn cells(&self, window: [[f64; 2]; 2]) -> [std::ops::Range<usize>; 2] {
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

#[cfg(test)]
mod tests {
    use kajo_math::rng::Stream;

    use super::*;
    use crate::shape::Surface;

    /// Spheres and boxes of many sizes within [-1, 1]^3, every third one not opaque.
    fn bodies(n: u32, seed: u64) -> Vec<Body> {
        let body = |primitive: u32| {
            let s = Stream::new(seed, [primitive, 0], 0);
            let center = 2.0 * Vec3::new(s.uniform(0), s.uniform(1), s.uniform(2)) - 1.0;
            let sphere = Sphere::new(center, 0.3 * s.uniform(3).powi(3));
            let is_sphere = !primitive.is_multiple_of(4);
            let bounds = sphere.bounds();
            let sphere = is_sphere.then_some(sphere);
            Body { primitive, bounds, sphere, opaque: !primitive.is_multiple_of(3) }
        };
        (0..n).map(body).collect()
    }

    /// Where a ray meets a body, if it does: a sphere, or a box in place of another shape.
    fn meets(body: &Body, ray: &Ray) -> Option<f32> {
        match body.sphere {
            Some(sphere) => sphere.hit(ray).map(|hit| hit.t),
            None => body.bounds.clip(ray).map(|(near, _)| near),
        }
    }

    fn points(n: u32, seed: u64, scale: f32) -> impl Iterator<Item = Vec3> {
        (0..n).map(move |i| {
            let s = Stream::new(seed, [i, 1], 0);
            scale * (2.0 * Vec3::new(s.uniform(0), s.uniform(1), s.uniform(2)) - 1.0)
        })
    }

    /// Points outside, inside and within a body, on an axis and far away.
    fn apexes(bodies: &[Body]) -> [Vec3; 5] {
        [
            Vec3::new(3.0, 4.0, -2.0),
            Vec3::new(0.2, -0.1, 0.3),
            bodies[1].bounds.center(),
            Vec3::new(0.0, 5.0, 0.0),
            Vec3::new(-300.0, 200.0, 0.5),
        ]
    }

    #[test]
    fn lists_hold_all_that_a_ray_from_the_apex_can_meet_first() {
        for n in [1, 5, 400] {
            let bodies = bodies(n.max(2), u64::from(n));
            for (apex, cells) in apexes(&bodies).into_iter().zip([0, 0, 9000, 100_000, 9000]) {
                let buffer = ItemBuffer::new(apex, &bodies, cells).unwrap();
                let mut listed = 0;
                for target in points(3000, 7, 1.2) {
                    let ray = Ray::new(apex, (target - apex).normalize());
                    let Some(items) = buffer.seen_along(&ray) else { continue };
                    listed += items.len();
                    let nearest = bodies.iter().filter_map(|b| Some((meets(b, &ray)?, b.primitive)));
                    if let Some((t, primitive)) = nearest.min_by(|a, b| a.0.total_cmp(&b.0)) {
                        let item = items.iter().find(|item| item.primitive == primitive);
                        assert!(item.is_some_and(|item| item.near <= t), "{apex} {ray:?} {primitive}");
                    }
                    assert!(items.is_sorted_by(|a, b| a.near <= b.near));
                }
                assert!(listed < 3000 * 12, "{n} {apex}: {listed}");
            }
        }
    }

    #[test]
    fn rays_to_the_apex_find_what_blocks_them() {
        let bodies = bodies(400, 3);
        for (apex, cells) in apexes(&bodies).into_iter().flat_map(|apex| [(apex, 0), (apex, 100_000)]) {
            let buffer = ItemBuffer::new(apex, &bodies, cells).unwrap();
            let (mut answered, mut blocked, mut known) = (0, 0, 0);
            for p in points(3000, 8, 1.5).chain(points(500, 9, 40.0)) {
                let (wi, distance) = ((apex - p).normalize(), (apex - p).length());
                let ray = Ray::new(p, wi).over(1e-3, distance);
                let Some(between) = buffer.between(&ray) else { continue };
                answered += 1;
                let met: Vec<&Body> = bodies.iter().filter(|b| meets(b, &ray).is_some()).collect();
                let hidden = met.iter().any(|b| b.opaque && b.sphere.is_some());
                blocked += u32::from(hidden);
                let items = match between {
                    Between::Items(items, farthest) => {
                        items.iter().take_while(|item| item.near <= farthest).collect::<Vec<_>>()
                    }
                    Between::Blocked => {
                        known += 1;
                        assert!(hidden, "{ray:?}");
                        continue;
                    }
                };
                let listed = |b: &&Body| items.iter().any(|item| item.primitive == b.primitive);
                if hidden {
                    assert!(met.iter().any(|b| b.opaque && listed(b)), "{ray:?}");
                } else {
                    assert!(met.iter().all(listed), "{ray:?}");
                }
            }
            assert!(answered > 2000 && blocked > 100, "{apex}: {answered} {blocked}");
            let many = if cells == 0 { 0 } else { blocked / 4 };
            assert!(known >= many, "{apex}: {known} of {blocked}");
        }
    }

    #[test]
    fn other_rays_are_not_answered() {
        let bodies = bodies(50, 4);
        let apex = Vec3::new(3.0, 4.0, -2.0);
        let buffer = ItemBuffer::new(apex, &bodies, 0).unwrap();
        let to_apex = |p: Vec3| Ray::new(p, (apex - p).normalize()).over(0.0, (apex - p).length());
        let ray = to_apex(Vec3::ZERO);
        assert!(buffer.between(&ray).is_some());
        assert!(buffer.between(&ray.over(0.0, 0.99 * ray.t_max)).is_none());
        assert!(buffer.between(&ray.over(0.0, f32::INFINITY)).is_none());
        assert!(buffer.between(&Ray { d: Vec3::NAN, ..ray }).is_none());
        assert!(buffer.between(&to_apex(Vec3::new(1e4, 0.0, 0.0))).is_none());
        let seen = Ray::new(apex, -ray.d);
        assert!(buffer.seen_along(&seen).is_some());
        assert!(buffer.seen_along(&Ray { d: 2.0 * seen.d, ..seen }).is_none());
        assert!(buffer.seen_along(&Ray { o: apex + 0.1, ..seen }).is_none());
        assert!(buffer.seen_along(&Ray::new(apex, ray.d)).is_some_and(<[Item]>::is_empty));
        assert!(ItemBuffer::new(apex, &[], 0).is_none());
        assert!(ItemBuffer::new(Vec3::new(f32::INFINITY, 0.0, 0.0), &bodies, 0).is_none());
    }

    /// A thousand bodies in one direction are no list; what is behind a wall is in none.
    #[test]
    fn crowds_go_to_the_tree_and_hidden_things_nowhere() {
        let apex = Vec3::new(0.0, 0.0, 10.0);
        let sphere = |primitive: u32, z: f32, radius: f32| {
            let sphere = Sphere::new(Vec3::new(0.0, 0.0, z), radius);
            Body { primitive, bounds: sphere.bounds(), sphere: Some(sphere), opaque: true }
        };
        let mut bodies: Vec<Body> = (0..1000).map(|i| sphere(i, -(i as f32), 0.01)).collect();
        let ahead = Ray::new(apex, Vec3::NEG_Z);
        assert!(ItemBuffer::new(apex, &bodies, 0).unwrap().seen_along(&ahead).is_none());
        bodies.push(sphere(1000, 2.0, 1.0));
        let buffer = ItemBuffer::new(apex, &bodies, 0).unwrap();
        assert_eq!(buffer.seen_along(&ahead).map(|items| items[0].primitive), Some(1000));
        let listed = buffer.seen_along(&ahead).map_or(0, <[Item]>::len);
        assert!(listed < 4, "{listed}");
        assert!(buffer.bytes() < 100_000);
    }
}
