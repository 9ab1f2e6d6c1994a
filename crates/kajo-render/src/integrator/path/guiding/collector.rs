//! The records of the paths of a pass, of the light that comes to points in cells, summed exactly.
//!
//! A record is a direction in which a path left a vertex, with the density `p` of the mixture, and the light `c` that
//! came back along it, scattered towards the path: what lights gave at the next vertex, and what surfaces send back
//! there of light that was scattered before. That is taken from the last pass, as the mean over all records of the
//! cell, so that a path need not have found a light itself [Dahm and Keller 2017]. Of each cell is kept, for the leaves
//! of a tree of squares and for some shares `a`,
//!
//! ```text
//! S = sum of c/p                                    an estimate of N times the integral of c over the leaf
//! K = sum of c/p ln(p / (a p_s + (1 - a) p_g))      N times the divergence from c, but for what is the same for all a
//! ```
//!
//! with the densities `p_s` of scattering and `p_g` of the guide. If all directions were drawn in proportion to `c` there would be no noise, so that
//! leaves get the share `S`; and the share with the least `K` is the best mixture there is [Müller 2019, 10.1].
//!
//! Sums are of whole numbers, so that they are the same in whatever order the threads come.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use kajo_math::fmath::ln64;
use kajo_math::{Vec2, Vec3};

use super::field::{Cell, Field, Known, axis_of};
use super::quadtree::{self, LEAF, Node};

/// Shares of directions drawn by scattering among which a cell chooses; the first one is what it has without a guide.
pub const SHARES: [f32; 6] = [1.0, 0.85, 0.7, 0.5, 0.3, 0.15];

/// By how much another share must be better than the first, in natural units of information.
const WORTHWHILE: f64 = 0.02;

/// Makes logarithms of ratios of densities positive.
const OFFSET: f64 = 20.0;

/// The initial share of scattering in a cell whose guide no path has used yet.
const FIRST_SHARE: f32 = 0.5;

/// Effective records by which paths that were not guided can judge a guide.
pub const LEAST_RECORDS: f32 = 8.0;

/// A square is divided that holds more than this share of its tree, and more than so many effective records.
const DIVIDED: f32 = 0.01;
const FEWEST_DIVIDED: f32 = 4.0;

/// How often a square is divided at most.
const DEPTH: u32 = 12;

/// The same of a tree that has held nothing yet.
const FIRST_DIVIDED: f32 = 0.02;

/// The share of a tree that is taken for granted, at least; and for how many effective records that stands.
const EVEN: f32 = 0.1;
const PRIOR: f32 = 8.0;

/// Number of photons that weigh as much as the cosine prior.
const TRUSTED_PHOTONS: f64 = 16.0;

/// What records count for of which there are newer ones.
const OLD: f64 = 0.5;

/// The cosine that light from behind is taken to have: normals of a side differ.
const LEAST_COSINE: f32 = 0.02;

/// Bits of the lower word of a sum.
const WORD: u32 = 32;

/// Bits below the unit that sums are counted in.
const FRACTION: i32 = 40;

/// An exact sum of positive numbers of the size of some unit, up to `2^24` times that.
#[derive(Debug, Default)]
struct Sum([AtomicU64; 2]);

impl Sum {
    /// * `v`: in the unit
    fn add(&self, v: f64) {
        let scale = (1u64 << FRACTION) as f64;
        // A cast is at most the largest number there is, and 0 for what is none.
        let n = (v * scale) as u64;
        let (low, high) = (n & ((1 << WORD) - 1), n >> WORD);
        for (word, n) in self.0.iter().zip([low, high]) {
            if n != 0 {
                word.fetch_add(n, Relaxed);
            }
        }
    }

    fn value(&self) -> f64 {
        let [low, high] = [0, 1].map(|i| self.0[i].load(Relaxed) as f64);
        (high * (1u64 << WORD) as f64 + low) / (1u64 << FRACTION) as f64
    }
}

/// A square whose quarters are counted.
#[derive(Debug)]
struct Square {
    children: [u32; 4],
    sums: [Sum; 4],
}

/// A cell that is counted in.
#[derive(Debug, Default)]
struct Counted {
    root: u32,
    records: AtomicU64,
    /// Sums of `x` and of its square.
    x: [Sum; 2],
    /// The sum of light that was connected with.
    direct: Sum,
    /// Of each share the sum `K`, with an offset.
    divergences: [Sum; SHARES.len()],
}

/// A direction that a path has taken, and what came of it.
#[derive(Clone, Copy, Debug)]
pub struct GuideRecord {
    pub cell: u32,
    /// The direction in the square; none for single directions.
    pub position: Option<Vec2>,
    /// Density of the mixture; of a single direction the probability with which scattering was asked.
    pub p: f32,
    /// Density of scattering; of a single direction 1.
    pub p_scattering: f32,
    /// Density of the guide.
    pub p_guide: f32,
    /// `c/p`.
    pub x: f32,
    /// Light that the place was connected with, scattered towards the path.
    pub direct: f32,
}

/// The sums of a pass.
#[derive(Debug)]
pub struct Collector {
    squares: Vec<Square>,
    cells: Vec<Counted>,
    /// What `x` is counted in.
    unit: f64,
}

/// Bytes of a square, with that of the tree that is made of it.
const BYTES: u64 = (size_of::<Square>() + size_of::<Node>()) as u64;

impl Collector {
    /// One for the cells of a field, with trees that follow its guides.
    ///
    /// * `unit`: the size of `x` of a record, positive
    pub fn new(field: &Field, unit: f64) -> Collector {
        let mut collector = Collector { squares: Vec::new(), cells: Vec::new(), unit };
        for cell in &field.cells {
            let root = collector.grow(&field.nodes, cell.guide, Division::of_all(threshold(cell)));
            collector.cells.push(Counted { root, ..Counted::default() });
        }
        collector
    }

    /// Makes squares as small as what they hold asks for; returns the one that holds all.
    fn grow(&mut self, nodes: &[Node], of: Option<u32>, square: Division) -> u32 {
        let at = self.squares.len();
        self.squares.push(Square { children: [LEAF; 4], sums: Default::default() });
        for i in 0..4 {
            let (within, child) = quarter_of(nodes, of, i);
            let quarter = square.quarter(within);
            if quarter.share > quarter.least && quarter.depth < DEPTH {
                self.squares[at].children[i] = self.grow(nodes, child, quarter);
            }
        }
        at as u32
    }

    /// Adds a record.
    pub fn add(&self, record: &GuideRecord) {
        let cell = &self.cells[record.cell as usize];
        cell.records.fetch_add(1, Relaxed);
        let &GuideRecord { p, p_scattering, p_guide, .. } = record;
        let [x, direct] = [record.x, record.direct].map(|x| f64::from(x) / self.unit);
        cell.direct.add(direct);
        let [p, p_scattering, p_guide] = [p, p_scattering, p_guide].map(f64::from);
        if !x.is_finite() || x <= 0.0 {
            return;
        }
        for (share, divergence) in SHARES.into_iter().map(f64::from).zip(&cell.divergences) {
            let ratio = p / (share * p_scattering + (1.0 - share) * p_guide);
            divergence.add(x * (ln64(ratio) + OFFSET).clamp(0.0, 2.0 * OFFSET));
        }
        match record.position {
            Some(position) => self.add_light(cell, position, x),
            None => {
                cell.x[0].add(x);
                cell.x[1].add(x * x);
            }
        }
    }

    /// Adds the power of a photon to a cell.
    ///
    /// * `position`: of the direction that it came from, in the square
    pub fn add_photon(&self, cell: u32, position: Vec2, power: f32) {
        let counted = &self.cells[cell as usize];
        counted.records.fetch_add(1, Relaxed);
        let x = f64::from(power) / self.unit;
        if x.is_finite() && x > 0.0 {
            self.add_light(counted, position, x);
        }
    }

    fn add_light(&self, cell: &Counted, mut position: Vec2, x: f64) {
        cell.x[0].add(x);
        cell.x[1].add(x * x);
        let mut at = cell.root;
        loop {
            let square = &self.squares[at as usize];
            let (i, within) = quadtree::quarter(position);
            (at, position) = (square.children[i], within);
            if at == LEAF {
                return square.sums[i].add(x);
            }
        }
    }

    /// Puts the sums into the field.
    ///
    /// * `photons`: the sums over photons of the same cells
    pub fn update_field(&self, field: &mut Field, photons: Option<&Collector>) {
        let (mut nodes, mut found) =
            (Vec::with_capacity(self.squares.len()), Vec::with_capacity(self.squares.len()));
        let sides = field.sides();
        for (i, (counted, &side)) in self.cells.iter().zip(&sides).enumerate() {
            let cell = &mut field.cells[i];
            let is_tried = cell.guide.is_some() && counted.effective() >= LEAST_RECORDS;
            let old = Old { nodes: &field.found, energy: OLD * cell.known.energy };
            let new = self.energy(counted.root);
            let [x, squares] = [0, 1].map(|i| counted.x[i].value());
            let known = Known {
                records: counted.records.load(Relaxed) as f64 + OLD * cell.known.records,
                direct: counted.direct.value() + OLD * cell.known.direct,
                x: x + OLD * cell.known.x,
                squares: squares + OLD * OLD * cell.known.squares,
                energy: new + old.energy,
                photons: photons.map_or(0.0, |photons| photons.cells[i].records.load(Relaxed) as f32),
            };
            let root = nodes.len() as u32;
            let photons =
                photons.map(|photons| (photons, photons.energy(counted.root))).filter(|(_, sum)| *sum > 0.0);
            if known.energy > 0.0 || photons.is_some() {
                let (axis, whole) = (axis_of(side), SquareBounds::WHOLE);
                let prior = self.prior(counted.root, whole, axis);
                let even = match known.energy > 0.0 {
                    true => f64::from(EVEN.max(PRIOR / (PRIOR + known.effective()))),
                    false => 1.0,
                };
                let by_photons = match photons {
                    Some(_) => f64::from(known.photons) / (f64::from(known.photons) + TRUSTED_PHOTONS),
                    None => 0.0,
                };
                let freezing = Freezing {
                    paths: if known.energy > 0.0 { (1.0 - even) / known.energy } else { 0.0 },
                    photons: photons.map(|(photons, sum)| (photons, even * by_photons / sum)),
                    unknown: even * (1.0 - by_photons) / prior,
                    axis,
                    old,
                };
                let trees = FrozenTrees { nodes: &mut nodes, found: &mut found };
                let old = OldSquare { node: cell.guide, share: 1.0 };
                self.freeze(trees, counted.root, whole, &freezing, old);
            }
            cell.known = known;
            [cell.light, cell.direct] =
                [known.x, known.direct].map(|sum| (sum / known.records.max(1.0) * self.unit) as f32);
            cell.guide = (nodes.len() as u32 > root).then_some(root);
            cell.share = match cell.guide {
                None => 1.0,
                Some(_) if is_tried => counted.best_share(),
                Some(_) => FIRST_SHARE,
            };
        }
        (field.nodes, field.found) = (nodes, found);
    }

    /// What a square of some area holds.
    fn energy(&self, square: u32) -> f64 {
        let square = &self.squares[square as usize];
        let quarter = |i: usize| match square.children[i] {
            LEAF => square.sums[i].value(),
            child => self.energy(child),
        };
        (0..4).map(quarter).sum()
    }

    /// What it would hold if nothing were known.
    fn prior(&self, square: u32, bounds: SquareBounds, axis: Vec3) -> f64 {
        let square = &self.squares[square as usize];
        let quarter = |i: usize| match square.children[i] {
            LEAF => unknown(bounds.quarter(i), axis),
            child => self.prior(child, bounds.quarter(i), axis),
        };
        (0..4).map(quarter).sum()
    }

    /// The tree of a square as it is drawn by, and that of what was found; returns what both hold.
    fn freeze(
        &self,
        FrozenTrees { nodes, found }: FrozenTrees<'_>,
        square: u32,
        bounds: SquareBounds,
        by: &Freezing<'_>,
        old: OldSquare,
    ) -> [f64; 2] {
        let at = nodes.len();
        let empty = Node { shares: [0.25; 4], children: [LEAF; 4] };
        nodes.push(empty);
        found.push(empty);
        let (mut held, mut held_found) = ([0.0; 4], [0.0; 4]);
        for i in 0..4 {
            let quarter = bounds.quarter(i);
            let (within, child_of_old) = quarter_of(by.old.nodes, old.node, i);
            let old = OldSquare { node: child_of_old, share: old.share * f64::from(within) };
            [held[i], held_found[i]] = match self.squares[square as usize].children[i] {
                LEAF => {
                    let energy = self.squares[square as usize].sums[i].value() + by.old.energy * old.share;
                    let sum_of = |of: &Collector| of.squares[square as usize].sums[i].value();
                    let photons = by.photons.map_or(0.0, |(photons, weight)| weight * sum_of(photons));
                    [by.paths * energy + photons + by.unknown * unknown(quarter, by.axis), energy]
                }
                child => {
                    let next = nodes.len() as u32;
                    (nodes[at].children[i], found[at].children[i]) = (next, next);
                    self.freeze(FrozenTrees { nodes, found }, child, quarter, by, old)
                }
            };
        }
        [(nodes, held), (found, held_found)].map(|(nodes, held)| {
            let all: f64 = held.iter().sum();
            if all > 0.0 {
                nodes[at].shares = held.map(|held| (held / all) as f32);
            }
            all
        })
    }
}

/// What of a tree a square has, while it is divided.
#[derive(Clone, Copy)]
struct Division {
    /// Its share of the energy of the tree.
    share: f32,
    /// Squares with a larger share than this are divided.
    least: f32,
    /// How often it has been divided.
    depth: u32,
}

impl Division {
    fn of_all(least: f32) -> Division {
        Division { share: 1.0, least, depth: 0 }
    }

    /// A quarter with a share of the square.
    fn quarter(self, within: f32) -> Division {
        Division { share: self.share * within, depth: self.depth + 1, ..self }
    }
}

/// A square of the unit square.
#[derive(Clone, Copy)]
struct SquareBounds {
    corner: Vec2,
    side: f32,
}

impl SquareBounds {
    const WHOLE: SquareBounds = SquareBounds { corner: Vec2::ZERO, side: 1.0 };

    fn quarter(self, i: usize) -> SquareBounds {
        let side = 0.5 * self.side;
        let corner = self.corner + side * Vec2::new((i % 2) as f32, (i / 2) as f32);
        SquareBounds { corner, side }
    }
}

/// The trees of all cells: as directions are drawn by them, and of what was found.
struct FrozenTrees<'t> {
    nodes: &'t mut Vec<Node>,
    found: &'t mut Vec<Node>,
}

/// A square in the tree of the pass before.
#[derive(Clone, Copy)]
struct OldSquare {
    node: Option<u32>,
    /// The share of that tree that it has.
    share: f64,
}

/// What a tree is made of.
struct Freezing<'c> {
    /// Weights of what paths have found, of what photons say, and of what is taken for granted.
    paths: f64,
    photons: Option<(&'c Collector, f64)>,
    unknown: f64,
    axis: Vec3,
    old: Old<'c>,
}

/// What was found before.
struct Old<'c> {
    nodes: &'c [Node],
    energy: f64,
}

/// What a square has where nothing is known: light from all over, seen by a surface that faces an axis.
fn unknown(SquareBounds { corner, side }: SquareBounds, axis: Vec3) -> f64 {
    let w = quadtree::from_square(corner + 0.5 * side);
    f64::from(side * side * (w.dot(axis).max(0.0) + LEAST_COSINE))
}

impl Counted {
    /// How many records of equal light would be as good.
    fn effective(&self) -> f32 {
        let [x, squares] = [0, 1].map(|i| self.x[i].value());
        if squares > 0.0 { (x * x / squares) as f32 } else { 0.0 }
    }

    /// The share by which the divergence is least, if that is worth the trouble.
    fn best_share(&self) -> f32 {
        let divergences: Vec<f64> = self.divergences.iter().map(Sum::value).collect();
        let mut best = (divergences[0] - WORTHWHILE * self.x[0].value(), SHARES[0]);
        for (&divergence, share) in divergences.iter().zip(SHARES).skip(1) {
            if divergence < best.0 {
                best = (divergence, share);
            }
        }
        best.1
    }
}

fn quarter_of(nodes: &[Node], of: Option<u32>, i: usize) -> (f32, Option<u32>) {
    let Some(at) = of else { return (0.25, None) };
    let node = &nodes[at as usize];
    (node.shares[i], Some(node.children[i]).filter(|&child| child != LEAF))
}

/// The share of a tree that a square may hold.
fn threshold(cell: &Cell) -> f32 {
    match cell.guide {
        Some(_) => DIVIDED.max(FEWEST_DIVIDED / (cell.known.effective() + cell.known.photons).max(1.0)),
        None => FIRST_DIVIDED,
    }
}

/// Divides cells of which much is known, as far as there is room for what is collected in them.
///
/// * `counts`: how much each cell has had, `most`: how much it may have
/// * `memory`: bytes that all of it may take
pub fn divide(field: &mut Field, counts: &[f32], most: f32, memory: u64) {
    // Old trees are thrown away when new ones have been made of what was collected, and arrays grow by doubling.
    let room = usize::try_from(memory / (3 * BYTES)).unwrap_or(usize::MAX);
    let mut sizes: Vec<usize> = field.cells.iter().map(|cell| size_of_tree(&field.nodes, cell)).collect();
    let mut squares: usize = sizes.iter().sum();
    field.divide(counts, most, |cell| {
        let more = sizes[cell as usize];
        let has_room = squares.saturating_add(more) <= room;
        if has_room {
            sizes.push(more);
            squares += more;
        }
        has_room
    });
}

/// Squares of the tree that follows a guide.
fn size_of_tree(nodes: &[Node], cell: &Cell) -> usize {
    let least = threshold(cell);
    let mut rest = vec![(cell.guide, 1.0, 0)];
    let mut size = 0;
    while let Some((of, share, depth)) = rest.pop() {
        size += 1;
        for i in 0..4 {
            let (within, child) = quarter_of(nodes, of, i);
            if share * within > least && depth + 1 < DEPTH {
                rest.push((child, share * within, depth + 1));
            }
        }
    }
    size
}

#[cfg(test)]
mod tests {
    use kajo_math::Aabb;

    use super::*;
    use crate::integrator::path::guiding::quadtree::{density, from_square, sample};

    fn field() -> Field {
        Field::new(Aabb { min: Vec3::ZERO, max: Vec3::ONE })
    }

    fn numbers(i: u64) -> [f32; 2] {
        let h = kajo_math::rng::mix(i);
        [(h >> 40) as f32 / 16_777_216.0, (h >> 16 & 0xFF_FFFF) as f32 / 16_777_216.0]
    }

    /// A record of light from a small patch of the square, by directions that are even over the sphere.
    fn record(i: u64) -> GuideRecord {
        let place = Vec2::from(numbers(i));
        let is_lit = place.distance(Vec2::new(0.3, 0.6)) < 0.05;
        let p = quadtree::UNIFORM;
        GuideRecord {
            cell: 0,
            position: Some(place),
            p,
            p_scattering: p,
            p_guide: p,
            x: if is_lit { 3.0 } else { 0.0 },
            direct: 0.0,
        }
    }

    #[test]
    fn sums_are_exact_in_any_order() {
        let values: Vec<f64> =
            (0..1000).map(|i| f64::from(numbers(i)[0]) * 10f64.powi(i as i32 % 12 - 6)).collect();
        let [forwards, backwards] = [Sum::default(), Sum::default()];
        values.iter().for_each(|&v| forwards.add(v));
        values.iter().rev().for_each(|&v| backwards.add(v));
        let bits = |sum: &Sum| [0, 1].map(|i| sum.0[i].load(Relaxed));
        assert_eq!(bits(&forwards), bits(&backwards));
        assert!((forwards.value() / values.iter().sum::<f64>() - 1.0).abs() < 1e-6);
        for none in [0.0, -1.0, f64::NAN] {
            let sum = Sum::default();
            sum.add(none);
            assert_eq!(sum.value(), 0.0);
        }
    }

    #[test]
    fn a_guide_learns_where_light_comes_from() {
        let mut field = field();
        for _ in 0..3 {
            let collector = Collector::new(&field, 3.0);
            (0..200_000).for_each(|i| collector.add(&record(i)));
            collector.update_field(&mut field, None);
        }
        let cell = field.cells[0];
        let guide = cell.guide.unwrap();
        assert!(cell.known.effective() > 1000.0 && cell.light > 0.0);
        assert!(field.cells[1].guide.is_none(), "nothing was found there");
        let near = (0..20_000).filter(|&i| {
            sample(&field.nodes, guide, Vec2::from(numbers(i))).0.distance(Vec2::new(0.3, 0.6)) < 0.07
        });
        let near = near.count();
        assert!(near > 15_000, "{near} of 20,000");
        let (n, mut sum) = (512, 0.0);
        for i in 0..n * n {
            let p = (Vec2::new((i % n) as f32, (i / n) as f32) + 0.5) / n as f32;
            let by_tree = density(&field.nodes, guide, p);
            // Light may come from anywhere that the surface sees.
            assert!(by_tree > 0.0 || from_square(p).x < 0.0, "{p}");
            sum += f64::from(by_tree / quadtree::UNIFORM);
        }
        assert!((sum / f64::from(n * n) - 1.0).abs() < 1e-4, "{}", sum / f64::from(n * n));
    }

    #[test]
    fn shares_are_those_of_the_closest_mixture() {
        let uniform = quadtree::UNIFORM;
        for (p_guide, expected) in [(100.0 * uniform, 0.15), (0.001 * uniform, 1.0), (uniform, 1.0)] {
            let mut field = field();
            let first = Collector::new(&field, 1.0);
            first.add(&GuideRecord { x: 1.0, ..record(0) });
            first.update_field(&mut field, None);
            assert_eq!(field.cells[0].share, FIRST_SHARE);
            let collector = Collector::new(&field, 1.0);
            (0..100).for_each(|i| collector.add(&GuideRecord { x: 1.0, p_guide, ..record(i) }));
            collector.update_field(&mut field, None);
            assert_eq!(field.cells[0].share, expected, "{p_guide}");
        }
    }

    /// Records at one place, then as many at another: the guide has both, the newer ones with twice the weight.
    #[test]
    fn records_of_all_passes_count_and_newer_ones_more() {
        let mut field = field();
        let places = [Vec2::new(0.3, 0.6), Vec2::new(0.9, 0.1)];
        for place in places {
            let collector = Collector::new(&field, 1.0);
            (0..1000)
                .for_each(|i| collector.add(&GuideRecord { x: 1.0, position: Some(place), ..record(i) }));
            collector.update_field(&mut field, None);
        }
        let guide = field.cells[0].guide.unwrap();
        let share = |nodes: &[Node], place: Vec2| {
            let (i, _) = quadtree::quarter(place);
            nodes[guide as usize].shares[i]
        };
        let [old, new] = places.map(|place| share(&field.found, place));
        assert!((new / old - 2.0).abs() < 1e-3 && (old + new - 1.0).abs() < 1e-6, "{old} {new}");
        // What is drawn by has a share of what is taken for granted, and no quarter of the square has nothing.
        assert!(field.nodes[guide as usize].shares.iter().all(|&share| share > 0.0));
        let known = field.cells[0].known;
        assert_eq!((known.records, known.x), (1500.0, 1500.0));
    }

    /// Cells without records of paths use photons alone.
    #[test]
    fn photons_fill_cells_where_paths_have_found_nothing() {
        let mut field = field();
        let place = Vec2::new(0.3, 0.6);
        for _ in 0..3 {
            let photons = Collector::new(&field, 1.0);
            (0..1000).for_each(|_| photons.add_photon(0, place, 1.0));
            Collector::new(&field, 1.0).update_field(&mut field, Some(&photons));
        }
        let guide = field.cells[0].guide.unwrap();
        assert!(density(&field.nodes, guide, place) > 20.0 * quadtree::UNIFORM);
        assert_eq!(field.cells[0].light, 0.0);
        assert!(field.cells[1].guide.is_none());
    }

    #[test]
    fn cells_are_divided_as_far_as_there_is_room() {
        let counts = [1e6; super::super::field::SIDES];
        for (memory, most) in [(0, 6), (1 << 20, 400), (1 << 24, 6000)] {
            let mut field = field();
            divide(&mut field, &counts, 10.0, memory);
            let collector = Collector::new(&field, 1.0);
            assert!(field.cells.len() <= most, "{memory}: {} cells", field.cells.len());
            let bytes = collector.squares.len() as u64 * BYTES;
            assert!(memory == 0 || bytes <= memory && 10 * bytes > memory, "{memory}: {bytes}");
        }
    }
}
