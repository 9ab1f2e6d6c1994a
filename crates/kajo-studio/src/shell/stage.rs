//! What the card paints under the widgets: the ground of the window, the preview, traced pictures.

use std::collections::HashMap;

use egui::{Align2, Color32, FontId, Painter, Rect, Ui};
use egui_wgpu::RenderState;
use kajo::View;

use super::picture::{self, TracedPicture};
use super::picture_panel::title;
use super::sight::SightPainter;
use super::theme;
use super::viewport::Area;
use crate::raster::{Raster, Sheet, Shot};
use crate::state::{Apart, BACKGROUND, Compare, Studio, Version};

/// Everything that is on the card.
pub struct Stage {
    raster: Raster,
    /// The version of the scene that the card has.
    on_card: Option<Version>,
    /// Whether its textures are as fine as they get.
    has_fine_textures: bool,
    /// The preview that rays make.
    seen: SightPainter,
    picture: TracedPicture,
    kept_picture: TracedPicture,
    map: TracedPicture,
    /// Colours that areas are filled with.
    plain: HashMap<Color32, Sheet>,
}

impl Stage {
    /// An empty stage on the card that draws the window.
    pub fn new(card: &RenderState) -> Stage {
        Stage {
            raster: Raster::new(card),
            on_card: None,
            has_fine_textures: false,
            seen: SightPainter::default(),
            picture: TracedPicture::default(),
            kept_picture: TracedPicture::default(),
            map: TracedPicture::default(),
            plain: HashMap::new(),
        }
    }

    /// Fills an area of the window.
    pub fn fill(&mut self, painter: &Painter, rect: Rect, color: Color32) {
        let canvas = self.raster.canvas();
        let sheet = self.plain.entry(color).or_insert_with(|| canvas.plain(color));
        painter.add(canvas.show(sheet, rect));
    }

    /// Shows the scene as triangles and lines, or as the camera's own rays see it.
    pub fn paint_preview(&mut self, ui: &Ui, studio: &Studio, area: Area) {
        if !studio.is_drawn() {
            self.seen.paint(ui, studio, area, self.raster.canvas());
            return;
        }
        if let Some((version, preview)) = &studio.preview
            && self.on_card != Some(*version)
        {
            self.raster.set_scene(preview);
            self.on_card = Some(*version);
            self.has_fine_textures = false;
        }
        if let Some(textures) = studio.fine_textures().filter(|_| !self.has_fine_textures) {
            self.raster.set_textures(textures);
            self.has_fine_textures = true;
        }
        let scale = ui.pixels_per_point();
        let pixels = area.rect.size() * scale;
        let size = [pixels.x, pixels.y].map(|side| (side.round() as u32).max(1));
        let Some(eye) = studio.eye(size) else { return };
        let lines = studio.lines();
        let selected = studio.selection.objects();
        let background = BACKGROUND.map(|v| f32::from(v) / 255.0);
        let shot = Shot { size, scale, eye, lines: &lines, selected, background };
        let sheet = self.raster.draw(&shot);
        picture::paint(ui.painter(), self.raster.canvas().show(&sheet, area.rect), area.rect, 0.0, 1.0);
    }

    /// Shows what was traced; left of the wipe what it is compared with, or how far the two are apart.
    pub fn paint_trace(&mut self, ui: &Ui, studio: &Studio, area: Area, apart: Option<&Apart>) {
        let Some(Ok(settings)) = studio.settings() else { return };
        let development = settings.development;
        let Some(frame) = studio.picture() else { return };
        let canvas = self.raster.canvas();
        if let Some(Ok(difference)) = apart.map(|apart| apart.difference.as_ref()) {
            let sheet = self.map.map(canvas, &difference.map);
            picture::paint(ui.painter(), canvas.show(&sheet, area.rect), area.rect, 0.0, 1.0);
            return;
        }
        // While the picture is still coarse the light will do; if it has not the layer, that should be known.
        let is_coarse = frame.samples() == 0;
        let view = if frame.has(studio.view) || !is_coarse { studio.view } else { View::Color };
        let shown = if frame.has(view) {
            self.picture.sheet(canvas, &frame, view, &development)
        } else {
            Err(format!("This trace has not recorded the layer {}: Enter traces anew, with it.", title(view)))
        };
        let kept = studio.reference().filter(|_| studio.pictures.compare == Compare::Wipe).map(|kept| {
            let view = if kept.frame.has(studio.view) { studio.view } else { View::Color };
            self.kept_picture.sheet(canvas, &kept.frame, view, &development)
        });
        let wipe = if kept.is_some() { studio.pictures.wipe } else { 0.0 };
        for (sheet, from, to) in [(Some(shown), wipe, 1.0), (kept, 0.0, wipe)] {
            match sheet {
                Some(Ok(sheet)) => {
                    picture::paint(ui.painter(), canvas.show(&sheet, area.rect), area.rect, from, to);
                }
                Some(Err(problem)) => {
                    let (at, font) = (area.rect.center(), FontId::proportional(14.0));
                    ui.painter().text(at, Align2::CENTER_CENTER, problem, font, theme::error(ui));
                }
                None => {}
            }
        }
    }
}
