//! The preview that the camera's rays make, with the lines over it.

use std::ops::Range;
use std::sync::Arc;

use egui::{Color32, Stroke, Ui};
use kajo_edit::preview::TracedPreview;
use kajo_math::{DVec3, Ray};

use super::picture;
use super::viewport::Area;
use crate::raster::{Canvas, Line, Sheet, is_within};
use crate::state::Studio;

/// How much of a line is seen through what is before it.
const HIDDEN: f32 = 0.3;

/// A share of the distance by which a line may lie behind what is seen there and still be on it.
const ON_SURFACE: f64 = 0.01;

/// What was seen, on the card.
#[derive(Default)]
pub struct SightPainter {
    /// The picture that the sheet shows, and the objects that have an outline in it.
    shown: Option<(Arc<TracedPreview>, Vec<Range<u32>>)>,
    sheet: Option<Sheet>,
}

impl SightPainter {
    /// Paints what the camera sees, the outline of what is selected, and the lines.
    pub fn paint(&mut self, ui: &Ui, studio: &Studio, area: Area, canvas: &Canvas) {
        let Some(seen) = studio.sight() else { return };
        let sheet = self.sheet(seen, studio.selection.objects(), canvas);
        picture::paint(ui.painter(), canvas.show(&sheet, area.rect), area.rect, 0.0, 1.0);
        for line in studio.lines() {
            paint_line(ui, studio, seen, area, &line);
        }
    }

    fn sheet(&mut self, seen: &Arc<TracedPreview>, selected: &[Range<u32>], canvas: &Canvas) -> Sheet {
        let is_shown =
            self.shown.as_ref().is_some_and(|(shown, with)| Arc::ptr_eq(shown, seen) && with == selected);
        let fitting = self.sheet.take().filter(|sheet| sheet.size() == seen.size());
        let sheet = match fitting {
            Some(sheet) if is_shown => sheet,
            fitting => {
                let sheet = fitting.unwrap_or_else(|| canvas.sheet(seen.size()));
                canvas.write(&sheet, &seen.rgba(|number| is_within(number, selected)));
                self.shown = Some((Arc::clone(seen), selected.to_vec()));
                sheet
            }
        };
        self.sheet = Some(sheet.clone());
        sheet
    }
}

/// Paints a line, faint where something is before it.
fn paint_line(ui: &Ui, studio: &Studio, seen: &TracedPreview, area: Area, line: &Line) {
    let painter = ui.painter().with_clip_rect(area.rect);
    let [r, g, b, opacity] = line.color;
    let [from, to]: [DVec3; 2] = [line.from, line.to].map(|p| p.as_dvec3());
    for stroke in studio.camera.strokes(from, to, area.size) {
        let middle = 0.5 * (stroke.ends[0] + stroke.ends[1]);
        // Parallel rays see what is behind the camera too, at distances below zero.
        let along = |ray: Ray| (stroke.middle - ray.o.as_dvec3()).dot(ray.d.as_dvec3());
        let distance = studio.camera.ray(middle, area.size).map_or(0.0, along);
        let surface = f64::from(seen.distance(middle));
        let is_hidden = distance > surface + ON_SURFACE * surface.abs();
        let opacity = f32::from(opacity) * if is_hidden { HIDDEN } else { 1.0 };
        let color = Color32::from_rgba_unmultiplied(r, g, b, opacity as u8);
        painter.line_segment(stroke.ends.map(|end| area.point(end)), Stroke::new(line.width, color));
    }
}
