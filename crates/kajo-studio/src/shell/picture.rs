//! A traced picture as a texture of the window.

use std::sync::Arc;

use egui::{Color32, ColorImage, Painter, Pos2, Rect, TextureFilter, TextureHandle, TextureOptions, pos2};
use kajo::session::Frame;
use kajo::{Development, View};

/// Pixels stay squares when they are enlarged, as one wants to see them, and are averaged when there are too many.
const SAMPLING: TextureOptions = TextureOptions {
    magnification: TextureFilter::Nearest,
    minification: TextureFilter::Linear,
    wrap_mode: egui::TextureWrapMode::ClampToEdge,
    mipmap_mode: None,
};

/// The texture of a picture, made anew when another picture, layer or development is asked for.
#[derive(Default)]
pub struct PictureTexture {
    shown: Option<(Arc<Frame>, View, Development)>,
    handle: Option<TextureHandle>,
}

impl PictureTexture {
    /// The texture that shows a layer of a picture.
    ///
    /// # Errors
    /// What is wrong when the picture has no such layer.
    pub fn show(
        &mut self,
        ctx: &egui::Context,
        frame: &Arc<Frame>,
        view: View,
        development: &Development,
    ) -> Result<egui::TextureId, String> {
        let same = |(shown, of, as_developed): &(Arc<Frame>, View, Development)| {
            Arc::ptr_eq(shown, frame) && *of == view && as_developed == development
        };
        if let (Some(shown), Some(handle)) = (&self.shown, &self.handle)
            && same(shown)
        {
            return Ok(handle.id());
        }
        let bytes = frame.rgba(view, development).map_err(|error| error.to_string())?;
        let image = color_image(frame.size(), &bytes, ctx.input(|input| input.max_texture_side));
        match &mut self.handle {
            Some(handle) => handle.set(image, SAMPLING),
            None => self.handle = Some(ctx.load_texture("traced picture", image, SAMPLING)),
        }
        self.shown = Some((Arc::clone(frame), view, *development));
        self.handle.as_ref().map(TextureHandle::id).ok_or_else(String::new)
    }
}

/// The picture, or every nth column and row of one that is larger than textures may be.
fn color_image([width, height]: [u32; 2], rgba: &[u8], largest: usize) -> ColorImage {
    let (width, height) = (width as usize, height as usize);
    let step = width.max(height).div_ceil(largest.max(1)).max(1);
    if step == 1 {
        return ColorImage::from_rgba_unmultiplied([width, height], rgba);
    }
    let pixel = |x: usize, y: usize| {
        let at = 4 * (y * width + x);
        Color32::from_rgb(rgba[at], rgba[at + 1], rgba[at + 2])
    };
    let rows = (0..height).step_by(step);
    let pixels = rows.flat_map(|y| (0..width).step_by(step).map(move |x| pixel(x, y))).collect();
    ColorImage::new([width.div_ceil(step), height.div_ceil(step)], pixels)
}

/// Paints a texture into the part of `rect` between two shares of its width.
pub fn paint(painter: &Painter, id: egui::TextureId, rect: Rect, from: f32, to: f32) {
    let x = |share: f32| egui::lerp(rect.x_range(), share);
    let part = Rect::from_min_max(pos2(x(from), rect.top()), pos2(x(to), rect.bottom()));
    let uv = Rect::from_min_max(pos2(from, 0.0), pos2(to, 1.0));
    painter.image(id, part, uv, Color32::WHITE);
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
        let rgba: Vec<u8> = (0..5 * 3).flat_map(|i| [i as u8, 0, 0, 255]).collect();
        let image = color_image([5, 3], &rgba, 3);
        assert_eq!(image.size, [3, 2]);
        let reds: Vec<u8> = image.pixels.iter().map(|pixel| pixel.r()).collect();
        assert_eq!(reds, [0, 2, 4, 10, 12, 14]);
        assert_eq!(color_image([5, 3], &rgba, 5).size, [5, 3]);
    }

    #[test]
    fn the_picture_keeps_its_aspect() {
        let outer = Rect::from_min_max(pos2(10.0, 20.0), pos2(410.0, 220.0));
        let rect = fitted(outer, [100, 100], 1.0);
        assert_eq!((rect.size(), rect.center()), (egui::vec2(200.0, 200.0), outer.center()));
        assert_eq!(fitted(outer, [400, 200], 2.0), outer);
    }
}
