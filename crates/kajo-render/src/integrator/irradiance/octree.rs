//! Where records are found while more of them come.
//!
//! A loose octree [Ward, Rubinstein and Clear 1988]: a record lies in the node that its point is in, at the level whose cubes are as
//! wide as its larger radius or up to twice that. So a record reaches no further than half a cube beyond its own, and a
//! look-up at a point visits each level at the cubes that hold it when they are made twice as wide.
//!
//! Records of a node are found in the opposite order of that in which they came, nodes from the largest on; so the sum over them is the
//! same for everybody.

use kajo_math::Vec3;

use super::record::{IrradianceQuery, Record};

/// Stands for none.
const NONE: u32 = u32::MAX;

/// Levels below the root at most. Smaller records lie in the smallest cubes.
const MOST_LEVELS: u32 = 40;

/// A cube, known by where it hangs.
#[derive(Clone, Copy, Debug)]
struct Node {
    children: [u32; 8],
    /// The last record that came.
    first: u32,
}

const EMPTY: Node = Node { children: [NONE; 8], first: NONE };

/// Records in space.
#[derive(Clone, Debug)]
pub struct Octree {
    records: Vec<Record>,
    /// The record that came to the same node before.
    before: Vec<u32>,
    nodes: Vec<Node>,
    center: Vec3,
    /// Half the width of the root.
    half: f32,
}

/// The eighth of a cube that a point is in, with its center.
fn octant(center: Vec3, half: f32, p: Vec3) -> (usize, Vec3) {
    let is_high = p.cmpge(center);
    let index = is_high.bitmask() as usize;
    let quarter = 0.5 * half;
    (index, center + Vec3::select(is_high, Vec3::splat(quarter), Vec3::splat(-quarter)))
}

impl Octree {
    /// A tree without records.
    ///
    /// * `half`: half the width of a cube around `center` that holds most points of records; positive
    pub fn new(center: Vec3, half: f32) -> Octree {
        Octree { records: Vec::new(), before: Vec::new(), nodes: vec![EMPTY], center, half }
    }

    /// All records, in the order in which they came.
    pub fn records(&self) -> &[Record] {
        &self.records
    }

    /// All records alone, in the order in which they came.
    pub fn into_records(self) -> Vec<Record> {
        self.records
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        let records = self.records.len() * (size_of::<Record>() + size_of::<u32>());
        (records + self.nodes.len() * size_of::<Node>()) as u64
    }

    /// Makes the root wider until it holds a finite point, such as one of a plane without end, and is as large as `radius`.
    fn grow(&mut self, p: Vec3, radius: f32) {
        while (p - self.center).abs().max_element().max(radius) > self.half {
            let wider = self.center + self.half * Vec3::ONE.copysign(p - self.center);
            let half = 2.0 * self.half;
            if !(half.is_finite() && wider.is_finite()) {
                return;
            }
            let (index, _) = octant(wider, half, self.center);
            let inner = self.nodes.len() as u32;
            self.nodes.push(self.nodes[0]);
            self.nodes[0] = EMPTY;
            self.nodes[0].children[index] = inner;
            (self.center, self.half) = (wider, half);
        }
    }

    /// Adds a record at a finite point.
    pub fn insert(&mut self, record: Record) {
        self.grow(record.p, record.radii[0]);
        let (mut at, mut center, mut half) = (0, self.center, self.half);
        for _ in 0..MOST_LEVELS {
            if half < 2.0 * record.radii[0] {
                break;
            }
            let (index, middle) = octant(center, half, record.p);
            (center, half) = (middle, 0.5 * half);
            if self.nodes[at].children[index] == NONE {
                self.nodes[at].children[index] = self.nodes.len() as u32;
                self.nodes.push(EMPTY);
            }
            at = self.nodes[at].children[index] as usize;
        }
        self.before.push(self.nodes[at].first);
        self.nodes[at].first = self.records.len() as u32;
        self.records.push(record);
    }

    /// Visits the numbers of all records that may reach the point `p`, and of others near.
    ///
    /// * `reach`: added to all that records reach
    fn near(&self, p: Vec3, reach: f32, each: &mut impl FnMut(u32)) {
        self.visit(0, self.center, self.half, p, reach, each);
    }

    fn visit(&self, node: u32, center: Vec3, half: f32, p: Vec3, reach: f32, each: &mut impl FnMut(u32)) {
        if (p - center).abs().max_element() > 2.0 * half + reach {
            return;
        }
        let node = &self.nodes[node as usize];
        let mut record = node.first;
        while record != NONE {
            each(record);
            record = self.before[record as usize];
        }
        let quarter = 0.5 * half;
        for (i, &child) in node.children.iter().enumerate() {
            if child != NONE {
                let side = |bit: usize| if i & bit != 0 { quarter } else { -quarter };
                let center = center + Vec3::new(side(1), side(2), side(4));
                self.visit(child, center, quarter, p, reach, each);
            }
        }
    }

    /// The sum of the weights at a position.
    ///
    /// * `turn`: as for [`Record::weight`]
    pub fn weight(&self, at: &IrradianceQuery, turn: f32) -> f32 {
        let mut sum = 0.0;
        self.near(at.p, 0.0, &mut |i| sum += self.records[i as usize].weight(at, turn).max(0.0));
        sum
    }

    /// Adds a record and makes it and its neighbours agree on how far they hold.
    pub fn insert_clamped(&mut self, mut record: Record) {
        let mut neighbours = Vec::new();
        self.near(record.p, record.radii[0], &mut |i| neighbours.push(i));
        neighbours.retain(|&i| self.records[i as usize].is_beside(&record));
        for &i in &neighbours {
            record.clamp_to(&self.records[i as usize]);
        }
        for &i in &neighbours {
            self.records[i as usize].clamp_to(&record);
        }
        self.insert(record);
    }
}

#[cfg(test)]
pub mod tests {
    use kajo_math::rng::{mix, unit};

    use super::*;

    fn number(i: u64) -> f32 {
        unit(mix(i) as u32)
    }

    /// One of many points of the cube from -1 to 1.
    pub fn point(i: u64) -> Vec3 {
        Vec3::new(number(3 * i), number(3 * i + 1), number(3 * i + 2)) * 2.0 - 1.0
    }

    /// Records of many radii there.
    pub fn records() -> Vec<Record> {
        let record = |i: u64| {
            let r = 0.5 * number(i + 9000) * number(i + 10_000);
            Record {
                p: point(i),
                n: Vec3::Y,
                irradiance: [number(i + 11_000), 1.0, 2.0],
                radii: [r, 0.7 * r],
                axis: 2.0 * number(i + 12_000) - 1.0,
                ..Record::default()
            }
        };
        (0..500).map(record).collect()
    }

    /// What the tree finds is what a look at all records finds.
    #[test]
    fn nothing_is_missed() {
        let mut tree = Octree::new(Vec3::ZERO, 1.0);
        records().into_iter().for_each(|record| tree.insert(record));
        let mut found = 0;
        for i in 0..400 {
            let p = point(i + 20_000);
            let at = IrradianceQuery { p, n: Vec3::Y, relief: Vec3::Y };
            let weights = || tree.records().iter().map(|record| record.weight(&at, 0.1).max(0.0));
            let all: f32 = weights().sum();
            assert!((tree.weight(&at, 0.1) - all).abs() <= 1e-5 * all, "{p}");
            found += usize::from(all > 0.0);
        }
        assert!(found > 100 && found < 400, "{found}");
    }

    /// Records far outside of the first cube are found again, at the level of their own size, and those inside still are; so are records
    /// that reach far beyond it.
    #[test]
    fn the_root_grows() {
        let mut tree = Octree::new(Vec3::ZERO, 1.0);
        let record = |p: Vec3| Record { p, n: Vec3::Y, radii: [0.01; 2], ..Record::default() };
        let points = (0..400).map(|i| point(i) * if i % 2 == 0 { 1.0 } else { 300.0 }).collect::<Vec<_>>();
        points.iter().for_each(|&p| tree.insert(record(p)));
        for &p in &points {
            let at = IrradianceQuery { p, n: Vec3::Y, relief: Vec3::Y };
            assert_eq!(tree.weight(&at, 0.1), 1.0, "{p}");
            let mut visited = 0;
            tree.near(p, 0.0, &mut |_| visited += 1);
            assert!(visited < 8, "{p}: {visited}");
        }
        tree.insert(record(Vec3::splat(f32::MAX)));
        assert_eq!(tree.records().len(), 401);
        let mut tree = Octree::new(Vec3::ZERO, 1.0);
        tree.insert(Record { radii: [50.0; 2], ..record(Vec3::ZERO) });
        let at = IrradianceQuery { p: Vec3::X * 40.0, n: Vec3::Y, relief: Vec3::Y };
        assert!((tree.weight(&at, 0.1) - 0.2).abs() < 1e-6);
    }

    #[test]
    fn neighbours_bound_each_other() {
        let mut tree = Octree::new(Vec3::ZERO, 1.0);
        let large = Record { n: Vec3::Y, radii: [0.8, 0.8], ..Record::default() };
        tree.insert_clamped(large);
        tree.insert_clamped(Record { p: Vec3::X * 0.25, radii: [0.125, 0.125], ..large });
        tree.insert_clamped(Record { p: Vec3::X * -0.25, n: Vec3::NEG_Y, radii: [0.1, 0.1], ..large });
        let radii: Vec<_> = tree.records().iter().map(|record| record.radii[0]).collect();
        assert_eq!(radii, [0.375, 0.125, 0.1], "what is lit from elsewhere bounds nothing");
    }
}
