//! The strip of pictures that were traced last, and how two of them are compared.

use std::collections::HashMap;
use std::sync::Arc;

use egui::{
    Align, Align2, Color32, ColorImage, ComboBox, CursorIcon, FontId, Layout, PointerButton, Pos2, Rect,
    Response, RichText, ScrollArea, Sense, Stroke, StrokeKind, TextureHandle, Ui, pos2, vec2,
};
use kajo::View;
use kajo::session::Frame;

use super::theme;
use crate::state::{Action, Apart, Compare, Kept, Shown, Studio};

/// Height of a small picture, in points, and what it may be wide.
const HEIGHT: f32 = 44.0;
const WIDTHS: [f32; 2] = [30.0, 100.0];

/// Windows of less height have buttons in place of small pictures, and these have that height.
const LOW: f32 = 520.0;
const LOW_HEIGHT: f32 = 22.0;

/// Strips of less width have fewer buttons.
const NARROW: f32 = 360.0;

/// Small pictures of those that are kept.
#[derive(Default)]
pub struct Strip {
    small: HashMap<char, (Arc<Frame>, TextureHandle)>,
}

impl Strip {
    /// The whole strip; what it asks for goes into `actions`.
    pub fn show(&mut self, ui: &mut Ui, studio: &Studio, actions: &mut Vec<Action>) {
        let kept = studio.pictures.kept();
        self.small.retain(|letter, _| kept.iter().any(|kept| kept.letter == *letter));
        let is_low = ui.ctx().content_rect().height() < LOW;
        let size = vec2(ui.available_width(), if is_low { LOW_HEIGHT } else { HEIGHT });
        ui.allocate_ui_with_layout(size, Layout::right_to_left(Align::Center), |ui| {
            ui.set_min_size(size);
            if kept.is_empty() {
                let words = RichText::new("Finished pictures will stand here, to be compared.");
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                    ui.add(egui::Label::new(words.color(theme::quiet(ui))).truncate());
                });
                return;
            }
            modes(ui, studio, actions);
            ui.separator();
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ScrollArea::horizontal().id_salt("strip").auto_shrink([false, true]).show(ui, |ui| {
                    ui.set_min_height(size.y);
                    for kept in kept {
                        self.entry(ui, studio, kept, is_low, actions);
                    }
                    let is_shown = studio.pictures.shown.is_none();
                    let now = ui.selectable_label(is_shown, "Now").on_hover_text("The newest trace");
                    if now.clicked() {
                        actions.push(Action::ShowPicture(None));
                    }
                });
            });
        });
    }

    fn entry(&mut self, ui: &mut Ui, studio: &Studio, kept: &Kept, is_low: bool, actions: &mut Vec<Action>) {
        let letter = kept.letter;
        let is_shown = studio.pictures.shown == Some(letter);
        let name = format!("Picture {letter}");
        let response = if is_low {
            ui.selectable_label(is_shown, letter.to_string())
        } else {
            let picture = self.small(ui, kept);
            let size = picture.size_vec2();
            let (rect, response) = ui.allocate_exact_size(size, Sense::click());
            let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            ui.painter().image(picture.id(), rect, whole, Color32::WHITE);
            let color = if is_shown { theme::accent(ui) } else { ui.visuals().window_stroke.color };
            let width = if is_shown || response.hovered() { 2.0 } else { 1.0 };
            ui.painter().rect_stroke(rect, 2.0, Stroke::new(width, color), StrokeKind::Inside);
            label(ui, rect.left_top() + vec2(3.0, 3.0), Align2::LEFT_TOP, &letter.to_string());
            response
        };
        response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_shown, &name));
        let hint =
            format!("{}\nClick shows it, double click looks from there, right click has more", kept.about());
        let response = response.on_hover_text(hint);
        if response.double_clicked() {
            actions.push(Action::LookAsIn(letter));
        } else if response.clicked() {
            actions.push(Action::ShowPicture((!is_shown).then_some(letter)));
        }
        response.context_menu(|ui| {
            if ui.button("Look from there").clicked() {
                actions.push(Action::LookAsIn(letter));
            }
            if ui.button("Compare with it").clicked() {
                actions.push(Action::CompareWith(Some(letter)));
                if studio.pictures.compare == Compare::Off {
                    actions.push(Action::Compare(Compare::Wipe));
                }
            }
            if ui.button("Forget").clicked() {
                actions.push(Action::ForgetPicture(letter));
            }
        });
    }

    fn small(&mut self, ui: &Ui, kept: &Kept) -> TextureHandle {
        if let Some((frame, picture)) = self.small.get(&kept.letter)
            && Arc::ptr_eq(frame, &kept.frame)
        {
            return picture.clone();
        }
        let image = reduced(&kept.frame, ui.pixels_per_point());
        let picture =
            ui.ctx().load_texture(format!("picture {}", kept.letter), image, egui::TextureOptions::LINEAR);
        self.small.insert(kept.letter, (Arc::clone(&kept.frame), picture.clone()));
        picture
    }
}

/// A small picture of the light, with the nearest pixels.
fn reduced(frame: &Frame, scale: f32) -> ColorImage {
    let [width, height] = frame.size().map(|side| side.max(1) as f32);
    let size = [(HEIGHT * width / height).clamp(WIDTHS[0], WIDTHS[1]), HEIGHT];
    let [columns, rows] = size.map(|points| (points * scale).round().max(1.0) as usize);
    let Ok(rgba) = frame.rgba(View::Color, &frame.settings().development) else {
        return ColorImage::filled([columns, rows], Color32::BLACK);
    };
    let pixel = |x: usize, y: usize| {
        let x = ((x as f32 + 0.5) / columns as f32 * width) as usize;
        let y = ((y as f32 + 0.5) / rows as f32 * height) as usize;
        let at = 4 * (y * width as usize + x);
        rgba.get(at..at + 3).map_or(Color32::BLACK, |rgb| Color32::from_rgb(rgb[0], rgb[1], rgb[2]))
    };
    let pixels =
        (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))).map(|(x, y)| pixel(x, y)).collect();
    ColorImage::new([columns, rows], pixels).with_source_size(size.into())
}

/// How two pictures are shown together, from right to left.
fn modes(ui: &mut Ui, studio: &Studio, actions: &mut Vec<Action>) {
    let pictures = &studio.pictures;
    let is_narrow = ui.available_width() < NARROW;
    for (how, name, hint) in [
        (
            Compare::Difference,
            if is_narrow { "Diff" } else { "Difference" },
            "How far the picture is from another",
        ),
        (Compare::Wipe, "Wipe", "Another picture left of a line that can be dragged"),
    ] {
        let is_on = pictures.compare == how;
        if ui.selectable_label(is_on, name).on_hover_text(hint).clicked() {
            actions.push(Action::Compare(if is_on { Compare::Off } else { how }));
        }
    }
    if is_narrow {
        // What is left out here is in the menus.
        return;
    }
    if let Some(reference) = studio.reference() {
        let shown = reference.letter.to_string();
        ComboBox::from_id_salt("reference").width(40.0).selected_text(shown).show_ui(ui, |ui| {
            for kept in pictures.kept() {
                if ui.selectable_label(kept.letter == reference.letter, kept.about()).clicked() {
                    actions.push(Action::CompareWith(Some(kept.letter)));
                }
            }
        });
        ui.label(RichText::new("with").color(theme::quiet(ui)));
    }
    let keep = ui
        .small_button("Keep")
        .on_hover_text("Keeps the newest picture as it is now; finished ones are kept anyway");
    if keep.clicked() {
        actions.push(Action::KeepPicture);
    }
}

/// The figures of a difference, in words.
fn figures(studio: &Studio, apart: &Apart) -> String {
    match apart.difference.as_ref() {
        Ok(difference) => {
            let f = &difference.figures;
            let psnr = if f.psnr.is_finite() { format!("{:.1} dB", f.psnr) } else { "infinite".to_owned() };
            format!(
                "RMSE {:.3e}    relMSE {:.3e}    PSNR {psnr}    largest {:.3e}",
                f.rmse, f.rel_mse, f.max_abs
            )
        }
        Err(_) if studio.progress().is_some() => "The trace is still coarse.".to_owned(),
        Err(problem) => problem.clone(),
    }
}

/// Paints the line of the wipe over the picture and what is on its sides, or the figures of a difference.
pub fn paint_comparison(ui: &Ui, rect: Rect, studio: &Studio, apart: Option<&Apart>) {
    let Some(reference) = studio.reference() else { return };
    let margin = 8.0;
    let [left, right] = [rect.left_top() + vec2(margin, margin), rect.right_top() + vec2(-margin, margin)];
    let shown = studio.about_picture();
    if studio.pictures.compare == Compare::Difference {
        label(ui, left, Align2::LEFT_TOP, &format!("{}   against   {shown}", reference.about()));
        if let Some(apart) = apart {
            label(ui, left + vec2(0.0, 22.0), Align2::LEFT_TOP, &figures(studio, apart));
            let key = "Black is equal, pale yellow far apart";
            label(ui, rect.left_bottom() + vec2(margin, -margin), Align2::LEFT_BOTTOM, key);
        }
        return;
    }
    let x = wipe_at(rect, studio);
    let painter = ui.painter().with_clip_rect(rect);
    painter.vline(x, rect.y_range(), Stroke::new(3.0, Color32::from_black_alpha(120)));
    painter.vline(x, rect.y_range(), Stroke::new(1.0, Color32::WHITE));
    let grip = pos2(x, rect.center().y);
    painter.circle(grip, 9.0, Color32::from_black_alpha(150), Stroke::new(1.5, Color32::WHITE));
    painter.text(grip, Align2::CENTER_CENTER, "<>", FontId::monospace(10.0), Color32::WHITE);
    label(ui, left, Align2::LEFT_TOP, &reference.about());
    label(ui, right, Align2::RIGHT_TOP, &shown);
}

/// What a drag of the wipe asks for; `None` where it is not dragged.
///
/// * `is_dragged`: whether it is, to be kept from frame to frame
pub fn drag_wipe(
    ui: &Ui,
    response: &Response,
    rect: Rect,
    studio: &Studio,
    is_dragged: &mut bool,
) -> Option<Action> {
    /// Points from the line that are near enough.
    const REACH: f32 = 8.0;
    let is_there = studio.shown == Shown::Traced && studio.pictures.compare == Compare::Wipe;
    if !is_there || studio.reference().is_none() {
        *is_dragged = false;
        return None;
    }
    let is_near = |at: Pos2| (at.x - wipe_at(rect, studio)).abs() <= REACH && rect.contains(at);
    if response.hover_pos().is_some_and(is_near) || *is_dragged {
        ui.ctx().set_cursor_icon(CursorIcon::ResizeHorizontal);
    }
    let origin = ui.input(|input| input.pointer.press_origin());
    *is_dragged |= response.drag_started_by(PointerButton::Primary) && origin.is_some_and(is_near);
    *is_dragged &= response.dragged_by(PointerButton::Primary);
    let to = response.interact_pointer_pos().filter(|_| *is_dragged)?;
    Some(Action::Wipe((to.x - rect.left()) / rect.width()))
}

/// Where the wipe is in the window.
pub fn wipe_at(rect: Rect, studio: &Studio) -> f32 {
    egui::lerp(rect.x_range(), studio.pictures.wipe)
}

/// White letters on a dark ground, to be read over any picture.
fn label(ui: &Ui, at: Pos2, align: Align2, text: &str) {
    let galley = ui.painter().layout_no_wrap(text.to_owned(), FontId::proportional(12.0), Color32::WHITE);
    let rect = align.anchor_size(at, galley.size());
    ui.painter().rect_filled(rect.expand(2.5), 2.0, Color32::from_black_alpha(170));
    ui.painter().galley(rect.min, galley, Color32::WHITE);
}
