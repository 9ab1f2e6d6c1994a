//! What a camera sees, ray by ray: the preview for cameras whose picture no matrix makes, such as panoramas.
//!
//! Each place gets the camera's own ray, the one that [`pick`](kajo::probe::pick) casts there, so what is drawn and what is
//! picked cannot differ. Surfaces are lit as in the raster preview, by a light at the eye: `0.28 + 0.72 |n·d|`.

use std::thread;

use kajo_core::scene::Scene;
use kajo_math::{DVec2, Ray};

use super::color;
use kajo::CameraPose;

/// The colour of outlines.
const OUTLINE: [u8; 3] = [255, 168, 51];

/// What one ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PixelHit {
    /// Encoded in sRGB.
    color: [u8; 3],
    /// Number in the id layers, counted from 1; 0 for nothing.
    object: u32,
    distance: f32,
}

/// A picture of what a camera sees.
#[derive(Clone, Debug, PartialEq)]
pub struct TracedPreview {
    /// Columns and rows of the picture that the camera makes.
    picture: [u32; 2],
    /// Columns and rows of rays.
    size: [u32; 2],
    /// Row by row, from the top.
    met: Vec<PixelHit>,
}

impl TracedPreview {
    /// Casts the rays, on all cores. `None` when it was told to stop.
    ///
    /// * `picture`: columns and rows of the camera's picture
    /// * `size`: columns and rows of rays, spread evenly over it
    /// * `background`: what is seen where there is nothing, encoded in sRGB
    /// * `goes_on`: asked before each row
    pub fn of(
        scene: &Scene,
        camera: &CameraPose,
        picture: [u32; 2],
        size: [u32; 2],
        background: [u8; 3],
        goes_on: impl Fn() -> bool + Sync,
    ) -> Option<TracedPreview> {
        let [columns, rows] = size.map(|n| n.max(1) as usize);
        let nothing = PixelHit { color: background, object: 0, distance: f32::INFINITY };
        let mut met = vec![nothing; columns * rows];
        let share =
            DVec2::new(picture[0].into(), picture[1].into()) / DVec2::new(columns as f64, rows as f64);
        let look = |x: usize, y: usize| {
            let position = (DVec2::new(x as f64, y as f64) + 0.5) * share;
            camera.ray(position, picture).and_then(|ray| hit(scene, &ray)).unwrap_or(nothing)
        };
        let threads = thread::available_parallelism().map_or(1, usize::from).min(rows);
        let band = rows.div_ceil(threads);
        let is_whole = thread::scope(|scope| {
            let bands = met.chunks_mut(band * columns).enumerate().map(|(i, part)| {
                let (look, goes_on) = (&look, &goes_on);
                scope.spawn(move || {
                    part.chunks_mut(columns).enumerate().all(|(row, part)| {
                        part.iter_mut().enumerate().for_each(|(x, met)| *met = look(x, i * band + row));
                        goes_on()
                    })
                })
            });
            let bands: Vec<_> = bands.collect();
            bands.into_iter().all(|band| band.join().unwrap_or(false))
        });
        is_whole.then_some(TracedPreview { picture, size: [columns as u32, rows as u32], met })
    }

    /// Columns and rows of rays.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Number of the object at a place of the camera's picture, as in the id layers; 0 for nothing.
    pub fn object(&self, position: DVec2) -> u32 {
        self.at(position).map_or(0, |met| met.object)
    }

    /// Distance along the camera's ray to what is seen at a place of its picture; infinite for nothing.
    pub fn distance(&self, position: DVec2) -> f32 {
        self.at(position).map_or(f32::INFINITY, |met| met.distance)
    }

    fn at(&self, position: DVec2) -> Option<&PixelHit> {
        let share = position / DVec2::new(self.picture[0].into(), self.picture[1].into());
        let inside = (0.0..1.0).contains(&share.x) && (0.0..1.0).contains(&share.y);
        let [columns, rows] = self.size.map(f64::from);
        let (x, y) = ((share.x * columns) as usize, (share.y * rows) as usize);
        self.met.get(y * self.size[0] as usize + x).filter(|_| inside)
    }

    /// The picture as it is shown, red, green, blue and 255 for each ray, row 0 on top. Some objects have an outline.
    ///
    /// * `has_outline`: whether the object of that number has one
    pub fn rgba(&self, has_outline: impl Fn(u32) -> bool) -> Vec<u8> {
        let marked: Vec<bool> =
            self.met.iter().map(|met| met.object > 0 && has_outline(met.object)).collect();
        let [columns, rows] = self.size.map(|n| n as usize);
        let is_marked = |x: usize, y: usize| x < columns && y < rows && marked[y * columns + x];
        let mut rgba = Vec::with_capacity(4 * self.met.len());
        for (i, met) in self.met.iter().enumerate() {
            let (x, y) = (i % columns, i / columns);
            let around = [(0, 1), (1, 0), (1, 2), (2, 1)];
            let is_edge = !marked[i]
                && around
                    .iter()
                    .any(|(right, down)| is_marked((x + right).wrapping_sub(1), (y + down).wrapping_sub(1)));
            let [r, g, b] = if is_edge { OUTLINE } else { met.color };
            rgba.extend([r, g, b, 255]);
        }
        rgba
    }
}

fn hit(scene: &Scene, ray: &Ray) -> Option<PixelHit> {
    let (at, point) = scene.trace_snapshot(ray)?;
    let [r, g, b, _] = color::encoded(color::at(scene, &at));
    let light = 0.28 + 0.72 * point.n.dot(ray.d).abs().min(1.0);
    let color = [r, g, b].map(|v| (f32::from(v) * light).round() as u8);
    Some(PixelHit { color, object: at.object.number(), distance: at.hit.t })
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo::{LoadOptions, MemoryAssets, load_from};

    fn scene() -> Scene {
        let text = "FisheyeCamera { center 0 0 5 direction 0 0 -1 up 0 1 0 angle 120 }
            Materials { Material { diffuseColor 1 0 0 } }
            Group { MaterialIndex 0 Sphere { center 0 0 0 radius 2 } }";
        let assets = MemoryAssets::new().with("a.txt", text);
        load_from("a.txt", &assets, &LoadOptions::default()).scene.expect("a scene")
    }

    #[test]
    fn a_ball_is_seen_and_outlined() {
        let scene = scene();
        let camera = CameraPose::of(&scene);
        let seen = TracedPreview::of(&scene, &camera, [80, 80], [40, 40], [9, 8, 7], || true).unwrap();
        assert_eq!((seen.size(), seen.object(DVec2::splat(40.0))), ([40, 40], 1));
        assert!((seen.distance(DVec2::splat(40.0)) - 3.0).abs() < 0.01);
        assert_eq!(seen.object(DVec2::splat(2.0)), 0);
        assert_eq!(seen.object(DVec2::new(-1.0, 40.0)), 0);
        let plain = seen.rgba(|_| false);
        let outlined = seen.rgba(|number| number == 1);
        let pixel = |rgba: &[u8], i: usize| [rgba[4 * i], rgba[4 * i + 1], rgba[4 * i + 2]];
        assert_eq!(pixel(&plain, 0), [9, 8, 7]);
        assert!(pixel(&plain, 20 * 40 + 20)[0] > 240, "lit from the eye");
        let changed: Vec<usize> = (0..1600).filter(|&i| pixel(&plain, i) != pixel(&outlined, i)).collect();
        assert!(changed.len() > 20 && changed.iter().all(|&i| pixel(&outlined, i) == OUTLINE));
        assert!(changed.iter().all(|&i| seen.met[i].object == 0));
    }

    #[test]
    fn it_stops_when_told() {
        let scene = scene();
        let camera = CameraPose::of(&scene);
        assert!(TracedPreview::of(&scene, &camera, [80, 80], [40, 40], [0; 3], || false).is_none());
    }
}
