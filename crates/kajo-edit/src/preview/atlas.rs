//! The textures of all surfaces, evaluated into one picture.
//!
//! Every texel is a point of a triangle of the preview, and what the scene's own textures say there, through the material that
//! shows them; so any texture of any material is seen, on surface coordinates as in space.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;

use kajo_core::scene::Scene;
use kajo_math::Vec3;

use super::chart::{Plan, Tile};
use super::color;

/// How finely textures are evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Detail {
    /// Texels to a side of a square that has one colour.
    block: u32,
    /// Points to a side of that square, whose mean it is; see [`Tile::points`].
    points: u32,
}

/// For the first sight of a scene that is being edited.
const COARSE: Detail = Detail { block: 4, points: 1 };

/// For one that has been there for a while.
const FINE: Detail = Detail { block: 1, points: 2 };

/// Texels of a tile that are evaluated in one go, about.
const TEXELS_IN_A_BAND: u32 = 2048;

/// A picture with tiles for the triangles of a preview; see [`PreviewMesh::texels`](super::PreviewMesh::texels).
#[derive(Clone, Debug, PartialEq)]
pub struct Atlas {
    plan: Arc<Plan>,
    rgba: Vec<u8>,
}

/// Some rows of a tile.
#[derive(Clone, Copy)]
struct Band {
    tile: Tile,
    /// The first row, and the one behind the last.
    rows: [u32; 2],
}

impl Atlas {
    pub(super) fn coarse(plan: Plan, scene: &Scene) -> Atlas {
        let rgba = bake(&plan, scene, COARSE, &|| true).unwrap_or_default();
        Atlas { plan: Arc::new(plan), rgba }
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        self.plan.size
    }

    /// Red, green, blue, encoded in sRGB, and 255 for each texel; height x width x 4, row 0 on top.
    pub fn rgba(&self) -> &[u8] {
        &self.rgba
    }

    /// The same picture, as fine as it gets, made on all cores. `None` when it was told to stop.
    ///
    /// * `scene`: the one that the preview was made of
    /// * `goes_on`: asked now and then
    pub fn refined(&self, scene: &Scene, goes_on: impl Fn() -> bool + Sync) -> Option<Atlas> {
        let rgba = bake(&self.plan, scene, FINE, &goes_on)?;
        Some(Atlas { plan: Arc::clone(&self.plan), rgba })
    }
}

fn bake(plan: &Plan, scene: &Scene, detail: Detail, goes_on: &(dyn Fn() -> bool + Sync)) -> Option<Vec<u8>> {
    let bands: Vec<Band> = plan.tiles.iter().flat_map(|tile| bands_of(*tile, detail.block)).collect();
    let (next, is_stopped) = (AtomicUsize::new(0), AtomicBool::new(false));
    let work = || {
        let mut done = Vec::new();
        while let Some(band) = bands.get(next.fetch_add(1, Ordering::Relaxed)) {
            if !goes_on() {
                is_stopped.store(true, Ordering::Relaxed);
            }
            if is_stopped.load(Ordering::Relaxed) {
                break;
            }
            done.push((*band, baked(plan, scene, band, detail)));
        }
        done
    };
    let width = plan.size[0] as usize;
    let mut rgba = vec![255; 4 * width * plan.size[1] as usize];
    let threads = thread::available_parallelism().map_or(1, usize::from);
    thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        for (band, texels) in workers.into_iter().flat_map(|worker| worker.join().unwrap_or_default()) {
            let [left, top] = band.tile.origin.map(usize::from);
            let columns = band.tile.size()[0] as usize;
            for (row, texels) in (band.rows[0] as usize..).zip(texels.as_flattened().chunks(4 * columns)) {
                let begin = 4 * ((top + row) * width + left);
                rgba[begin..begin + texels.len()].copy_from_slice(texels);
            }
        }
    });
    (!is_stopped.into_inner()).then_some(rgba)
}

/// A tile in bands of whole blocks.
fn bands_of(tile: Tile, block: u32) -> impl Iterator<Item = Band> {
    let [columns, rows] = tile.size();
    let height = (TEXELS_IN_A_BAND / columns).max(1).next_multiple_of(block);
    let first_rows = (0..rows).step_by(height as usize);
    first_rows.map(move |row| Band { tile, rows: [row, (row + height).min(rows)] })
}

/// The texels of a band, row by row.
fn baked(plan: &Plan, scene: &Scene, band: &Band, Detail { block, points }: Detail) -> Vec<[u8; 4]> {
    let Band { tile, rows } = band;
    let columns = tile.size()[0];
    let chart = &plan.charts[tile.chart as usize];
    let points = points * u32::from(tile.points);
    let mut texels = vec![[255; 4]; (columns * (rows[1] - rows[0])) as usize];
    let color = |x: f32, y: f32| {
        let (part, p, n) = tile.at(chart, x, y)?;
        let at = scene.surface_point(chart.object, part, p, n)?;
        Some(color::at(scene, &at)).filter(|rgb| rgb.is_finite())
    };
    for top in (rows[0]..rows[1]).step_by(block as usize) {
        for left in (0..columns).step_by(block as usize) {
            let [right, bottom] = [(left + block).min(columns), (top + block).min(rows[1])];
            let step = |from: u32, to: u32, i: u32| {
                from as f32 + (to - from) as f32 * (i as f32 + 0.5) / points as f32
            };
            let (mut sum, mut found) = (Vec3::ZERO, 0.0);
            for (i, j) in (0..points).flat_map(|j| (0..points).map(move |i| (i, j))) {
                if let Some(rgb) = color(step(left, right, i), step(top, bottom, j)) {
                    (sum, found) = (sum + rgb, found + 1.0);
                }
            }
            if found == 0.0 {
                continue;
            }
            let mean = color::encoded(sum / found);
            for (x, y) in (top..bottom).flat_map(|y| (left..right).map(move |x| (x, y))) {
                texels[((y - rows[0]) * columns + x) as usize] = mean;
            }
        }
    }
    texels
}
