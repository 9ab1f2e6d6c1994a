//! A traced picture on the card, and where it goes in the window.

use std::sync::Arc;

use egui::{Painter, Pos2, Rect, Shape, pos2};
use kajo::session::Frame;
use kajo::{Development, Image, View};

use crate::raster::{Canvas, Sheet};

/// The sheet of a picture, written anew when another picture, layer or development is asked for.
#[derive(Default)]
pub struct TracedPicture {
    shown: Option<(Arc<Frame>, View, Development)>,
    sheet: Option<Sheet>,
}

impl TracedPicture {
    /// The sheet that shows a layer of a picture.
    ///
    /// # Errors
    /// What is wrong when the picture has no such layer.
    pub fn sheet(
        &mut self,
        canvas: &Canvas,
        frame: &Arc<Frame>,
        view: View,
        development: &Development,
    ) -> Result<Sheet, String> {
        let same = |(shown, of, as_developed): &(Arc<Frame>, View, Development)| {
            Arc::ptr_eq(shown, frame) && *of == view && as_developed == development
        };
        if let (Some(shown), Some(sheet)) = (&self.shown, &self.sheet)
            && same(shown)
        {
            return Ok(sheet.clone());
        }
        let bytes = frame.rgba(view, development).map_err(|error| error.to_string())?;
        self.shown = Some((Arc::clone(frame), view, *development));
        Ok(self.written(canvas, frame.size(), bytes))
    }

    /// The sheet of a map, values as shown.
    pub fn map(&mut self, canvas: &Canvas, map: &Image) -> Sheet {
        let byte = |value: f32| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
        let bytes = map.rgb_pixels().flat_map(|[r, g, b]| [byte(r), byte(g), byte(b), 255]).collect();
        self.written(canvas, [map.width(), map.height()], bytes)
    }

    fn written(&mut self, canvas: &Canvas, size: [u32; 2], bytes: Vec<u8>) -> Sheet {
        let (size, bytes) = reduced(size, bytes, canvas.largest_side());
        let fitting = self.sheet.take().filter(|sheet| sheet.size() == size);
        let sheet = fitting.unwrap_or_else(|| canvas.sheet(size));
        canvas.write(&sheet, &bytes);
        self.sheet = Some(sheet.clone());
        sheet
    }
}

/// The picture, or every nth column and row of one that is larger than sheets may be; its size and its bytes.
fn reduced([width, height]: [u32; 2], rgba: Vec<u8>, largest: u32) -> ([u32; 2], Vec<u8>) {
    let step = width.max(height).div_ceil(largest.max(1)).max(1);
    if step == 1 {
        return ([width, height], rgba);
    }
    let row = |y: usize| &rgba[4 * width as usize * y..][..4 * width as usize];
    let rows = (0..height as usize).step_by(step as usize);
    let bytes = rows.flat_map(|y| row(y).chunks_exact(4).step_by(step as usize)).flatten().copied().collect();
    ([width.div_ceil(step), height.div_ceil(step)], bytes)
}

/// Paints what shows in `rect`, between two shares of its width.
pub fn paint(painter: &Painter, shape: Shape, rect: Rect, from: f32, to: f32) {
    let x = |share: f32| egui::lerp(rect.x_range(), share);
    let part = Rect::from_min_max(pos2(x(from), rect.top()), pos2(x(to), rect.bottom()));
    painter.with_clip_rect(part.intersect(painter.clip_rect())).add(shape);
}

/// The largest rectangle of that aspect inside of another, in its middle, on whole pixels.
pub fn fitted(outer: Rect, size: [u32; 2], pixels_per_point: f32) -> Rect {
    let [width, height] = size.map(|pixels| pixels.max(1) as f32);
    let scale = (outer.width() / width).min(outer.height() / height);
    let rect = Rect::from_center_size(outer.center(), egui::vec2(width, height) * scale);
    let snap = |p: Pos2| (p.to_vec2() * pixels_per_point).round().to_pos2() / pixels_per_point;
    Rect::from_min_max(snap(rect.min), snap(rect.max))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_larger_than_textures_lose_columns_and_rows() {
        let rgba: Vec<u8> = (0..5 * 3).flat_map(|i| [i, 0, 0, 255]).collect();
        let (size, bytes) = reduced([5, 3], rgba.clone(), 3);
        assert_eq!(size, [3, 2]);
        let reds: Vec<u8> = bytes.chunks_exact(4).map(|pixel| pixel[0]).collect();
        assert_eq!(reds, [0, 2, 4, 10, 12, 14]);
        assert_eq!(reduced([5, 3], rgba.clone(), 5), ([5, 3], rgba));
    }

    #[test]
    fn the_picture_keeps_its_aspect() {
        let outer = Rect::from_min_max(pos2(10.0, 20.0), pos2(410.0, 220.0));
        let rect = fitted(outer, [100, 100], 1.0);
        assert_eq!((rect.size(), rect.center()), (egui::vec2(200.0, 200.0), outer.center()));
        assert_eq!(fitted(outer, [400, 200], 2.0), outer);
    }
}
