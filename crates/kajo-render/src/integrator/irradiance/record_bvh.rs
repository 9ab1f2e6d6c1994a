//! The records of a finished cache, in a bounding volume hierarchy.
//!
//! The octree that they come to one by one visits many more than hold at a point; here a box is around each spheroid in which a record
//! holds. What is found is summed by the numbers of records, in whatever order the hierarchy finds them.

use kajo_bvh::{BuildSettings, Bvh};
use kajo_math::{Aabb, Ray, Vec3};

use super::record::{IrradianceQuery, Record};

/// Records that are found at one point without memory from the heap.
const FEW: usize = 32;

/// Records whose number and radii are final.
#[derive(Debug)]
pub struct RecordBvh {
    records: Vec<Record>,
    boxes: Bvh,
}

impl RecordBvh {
    /// The hierarchy over these records.
    pub fn new(records: Vec<Record>) -> RecordBvh {
        let boxes: Vec<Aabb> = records.iter().map(Record::bounds).collect();
        RecordBvh { boxes: Bvh::build(&boxes, &BuildSettings::default()), records }
    }

    /// All records, in the order in which they came.
    #[cfg(test)]
    pub fn records(&self) -> &[Record] {
        &self.records
    }

    /// Visits all records that may reach the point `p`, in the order in which they came.
    fn near(&self, p: Vec3, mut each: impl FnMut(&Record)) {
        let (mut few, mut len, mut more) = ([0; FEW], 0, Vec::new());
        // All but a point: a ray of no length meets nothing.
        let point = Ray { o: p, d: Vec3::X, t_min: 0.0, t_max: f32::MIN_POSITIVE, time: 0.0 };
        self.boxes.each(&point, |i| match few.get_mut(len) {
            Some(next) => (*next, len) = (i, len + 1),
            None => more.push(i),
        });
        let found = match more.is_empty() {
            true => &mut few[..len],
            false => {
                more.extend(few);
                &mut more[..]
            }
        };
        found.sort_unstable();
        found.iter().for_each(|&i| each(&self.records[i as usize]));
    }

    /// The irradiance of a position, linear RGB; `None` where no record holds.
    ///
    /// * `turn`: as for [`Record::weight`]
    pub fn irradiance(&self, at: &IrradianceQuery, turn: f32) -> Option<[f32; 3]> {
        let (mut sum, mut weights) = ([0.0; 3], 0.0);
        self.near(at.p, |record| {
            let weight = record.weight(at, turn);
            if weight > 0.0 {
                let e = record.extrapolated(at);
                sum = [0, 1, 2].map(|i| sum[i] + weight * e[i]);
                weights += weight;
            }
        });
        (weights > 0.0).then(|| sum.map(|sum: f32| sum / weights))
    }

    /// Whether a record lies no further from a position than this share of its smaller radius.
    pub fn is_record(&self, at: &IrradianceQuery, turn: f32, share: f32) -> bool {
        let mut is_record = false;
        self.near(at.p, |record| {
            let is_near = record.p.distance(at.p) < share * record.radii[1];
            is_record |= is_near && record.weight(at, turn) > 0.0;
        });
        is_record
    }
}

#[cfg(test)]
mod tests {
    use super::super::octree::tests::{point, records};
    use super::*;

    /// What the hierarchy finds is what a look at all records finds, to the bit; also where more lie in one place than are common.
    #[test]
    fn nothing_is_missed() {
        for copies in [1, 40] {
            let records: Vec<Record> = records().into_iter().flat_map(|r| [r].repeat(copies)).collect();
            let tree = RecordBvh::new(records.clone());
            let mut found = 0;
            for i in 0..400 {
                let p = point(i + 20_000);
                let at = IrradianceQuery { p, n: Vec3::Y, relief: Vec3::Y };
                let (mut sum, mut weights) = (0.0, 0.0);
                for record in &records {
                    let weight = record.weight(&at, 0.1).max(0.0);
                    sum += weight * record.extrapolated(&at)[0];
                    weights += weight;
                }
                let e = tree.irradiance(&at, 0.1);
                assert_eq!(e.map(|e| e[0]), (weights > 0.0).then(|| sum / weights), "{p}");
                let is_near = |r: &Record| r.p.distance(p) < 0.5 * r.radii[1] && r.weight(&at, 0.1) > 0.0;
                assert_eq!(tree.is_record(&at, 0.1, 0.5), records.iter().any(is_near));
                found += usize::from(weights > 0.0);
            }
            assert!(found > 100 && found < 400, "{found}");
        }
    }
}
