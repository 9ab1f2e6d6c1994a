//! How a stage is cut into units.

use std::ops::Range;

use kajo::{Rect, WorkUnit};

/// The units of a stage: all tiles with the first samples, then all with the next, so that a whole picture is there
/// early.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    sampled: Rect,
    tile: u32,
    samples: Range<u32>,
    step: u32,
}

/// Most units of a stage.
pub(crate) const MOST_UNITS: u64 = 10_000_000;

impl Layout {
    /// * `sampled`: the pixels
    /// * `tile`: side of a tile, at least 1
    /// * `samples`: of the stage
    /// * `step`: samples of a unit, at least 1
    pub fn new(sampled: Rect, tile: u32, samples: Range<u32>, step: u32) -> Layout {
        Layout { sampled, tile: tile.max(1), samples, step: step.max(1) }
    }

    /// Tiles.
    pub fn tiles(&self) -> u64 {
        let [columns, rows] = self.grid();
        u64::from(columns) * u64::from(rows)
    }

    /// Units.
    pub fn units(&self) -> u64 {
        self.tiles().saturating_mul((self.samples.end - self.samples.start).div_ceil(self.step).into())
    }

    /// The tile of a unit.
    pub fn tile_of(&self, unit: u64) -> u64 {
        unit % self.tiles().max(1)
    }

    /// What a unit is; `None` beyond the last.
    pub fn work_unit(&self, unit: u64) -> Option<WorkUnit> {
        if unit >= self.units() {
            return None;
        }
        let [columns, _] = self.grid();
        let (tile, range) = (unit % self.tiles(), (unit / self.tiles()) as u32);
        let (column, row) = ((tile % u64::from(columns)) as u32, (tile / u64::from(columns)) as u32);
        let Rect { x0, y0, x1, y1 } = self.sampled;
        let (left, top) = (x0 + column * self.tile, y0 + row * self.tile);
        let tile = Rect {
            x0: left,
            y0: top,
            x1: left.saturating_add(self.tile).min(x1),
            y1: top.saturating_add(self.tile).min(y1),
        };
        let start = self.samples.start + range * self.step;
        Some(WorkUnit { tile, samples: start..start.saturating_add(self.step).min(self.samples.end) })
    }

    fn grid(&self) -> [u32; 2] {
        [self.sampled.width(), self.sampled.height()].map(|side| side.div_ceil(self.tile))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_cover_every_sample_once() {
        let sampled = Rect { x0: 3, y0: 5, x1: 40, y1: 26 };
        for (tile, samples, step) in [(1, 0..3, 2), (16, 4..9, 2), (100, 0..1, 7), (7, 2..2, 1)] {
            let layout = Layout::new(sampled, tile, samples.clone(), step);
            let mut seen = std::collections::BTreeMap::new();
            for unit in 0..layout.units() {
                let unit = layout.work_unit(unit).unwrap();
                assert!(unit.tile.area() > 0 && !unit.samples.is_empty());
                for (x, y) in (unit.tile.y0..unit.tile.y1)
                    .flat_map(|y| (unit.tile.x0..unit.tile.x1).map(move |x| (x, y)))
                {
                    unit.samples.clone().for_each(|k| *seen.entry((x, y, k)).or_insert(0) += 1);
                }
            }
            assert_eq!(seen.len() as u64, sampled.area() * u64::from(samples.end - samples.start));
            assert!(seen.values().all(|&n| n == 1));
            assert_eq!(layout.work_unit(layout.units()), None);
        }
    }
}
