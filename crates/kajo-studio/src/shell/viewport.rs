//! The middle of the window: the preview or the traced picture, and the mouse in it.

use egui::{Align2, Color32, FontId, PointerButton, Rect, Response, Sense, Stroke, StrokeKind, Ui, Vec2};
use kajo_edit::handles::HandleKind;
use kajo_math::DVec2;

use super::theme;
use crate::state::{Action, Handles, Studio};

/// Points that the wheel scrolls in a notch.
const NOTCH: f32 = 40.0;

/// Where the picture is in the window, and how large in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// In points.
    pub rect: Rect,
    /// Columns and rows of the picture.
    pub size: [u32; 2],
}

impl Area {
    /// The place in the picture under a point of the window, in its pixels from the top left corner.
    pub fn picture_position(&self, point: egui::Pos2) -> Option<DVec2> {
        let share = (point - self.rect.min) / self.rect.size();
        let inside = (0.0..=1.0).contains(&share.x) && (0.0..=1.0).contains(&share.y);
        let [width, height] = self.size.map(f64::from);
        inside.then(|| DVec2::new(f64::from(share.x) * width, f64::from(share.y) * height))
    }

    /// The same for a point that may be outside of the picture.
    fn picture_position_beyond(&self, point: egui::Pos2) -> DVec2 {
        let share = (point - self.rect.min) / self.rect.size();
        DVec2::new(f64::from(share.x) * f64::from(self.size[0]), f64::from(share.y) * f64::from(self.size[1]))
    }

    /// The point of the window where a place in the picture is.
    pub fn point(&self, position: DVec2) -> egui::Pos2 {
        let [width, height] = self.size.map(f64::from);
        let share = Vec2::new((position.x / width) as f32, (position.y / height) as f32);
        self.rect.min + share * self.rect.size()
    }

    /// The pixel under a point of the window.
    pub fn pixel(&self, point: egui::Pos2) -> Option<[u32; 2]> {
        let position = self.picture_position(point)?;
        let [width, height] = self.size;
        Some([
            (position.x as u32).min(width.saturating_sub(1)),
            (position.y as u32).min(height.saturating_sub(1)),
        ])
    }
}

/// What the mouse in the viewport asks for.
pub fn mouse(ui: &Ui, response: &Response, area: Area, studio: &Studio, handles: &Handles) -> Vec<Action> {
    let mut actions = Vec::new();
    if let Some(actions) = handle_drag(ui, response, area, studio, handles) {
        return actions;
    }
    if response.clicked()
        && let Some(position) = response.interact_pointer_pos().and_then(|point| area.picture_position(point))
    {
        let several = ui.input(|input| input.modifiers.command || input.modifiers.shift);
        actions.push(Action::Pick(position, several));
    }
    let delta = response.drag_delta();
    let by = DVec2::new(delta.x.into(), delta.y.into());
    let shift = ui.input(|input| input.modifiers.shift);
    if delta != Vec2::ZERO {
        if response.dragged_by(PointerButton::Secondary) {
            actions.push(Action::Look(by));
        } else if shift {
            actions.push(Action::Pan(by * f64::from(ui.pixels_per_point())));
        } else {
            actions.push(Action::Orbit(by));
        }
    }
    if response.contains_pointer() {
        let (scroll, zoom) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
        if scroll != 0.0 {
            actions.push(Action::ChangeSpeed(f64::from(scroll / NOTCH)));
        }
        if zoom != 1.0 {
            // The window's own factor for a notch is a little more than ours.
            actions.push(Action::Zoom(f64::from(zoom.ln()) * 5.0));
        }
    }
    actions
}

/// What a drag of a handle asks for; `None` while none is dragged.
fn handle_drag(
    ui: &Ui,
    response: &Response,
    area: Area,
    studio: &Studio,
    handles: &Handles,
) -> Option<Vec<Action>> {
    let in_steps = ui.input(|input| input.modifiers.command);
    let to = response
        .interact_pointer_pos()
        .map(|point| Action::DragTo(area.picture_position_beyond(point), in_steps));
    if studio.has_grip() {
        return response.dragged_by(PointerButton::Primary).then(|| to.into_iter().collect());
    }
    if !response.drag_started_by(PointerButton::Primary) {
        return None;
    }
    let from = area.picture_position(ui.input(|input| input.pointer.press_origin())?)?;
    studio.handle_at(handles, from)?;
    Some(std::iter::once(Action::Grab(from)).chain(to).collect())
}

/// Marks the pixel that the debug ray was shot through.
pub fn paint_debug_pixel(ui: &Ui, area: Area, studio: &Studio) {
    let pixel = studio.rays.as_ref().and_then(|rays| rays.pixel(&studio.camera, area.size));
    let Some([corner, sides]) = pixel else { return };
    // A pixel may be too small to be seen.
    let pixel = Rect::from_two_pos(area.point(corner), area.point(corner + sides));
    let square = Rect::from_center_size(pixel.center(), pixel.size().max(Vec2::splat(5.0)));
    let painter = ui.painter().with_clip_rect(area.rect);
    for (width, color) in [(3.5, Color32::from_black_alpha(160)), (1.5, Color32::WHITE)] {
        let stroke = Stroke::new(width, color);
        painter.rect_stroke(square, 0.0, stroke, StrokeKind::Outside);
        for way in [Vec2::X, Vec2::Y, -Vec2::X, -Vec2::Y] {
            let edge = square.center() + way * (0.5 * square.size() + Vec2::splat(3.0));
            painter.line_segment([edge, edge + 7.0 * way], stroke);
        }
    }
}

/// Paints the handles of what is selected, the one under the pointer brighter.
pub fn paint_handles(ui: &Ui, area: Area, studio: &Studio, handles: &Handles) {
    let painter = ui.painter().with_clip_rect(area.rect);
    let pointer = ui.input(|input| input.pointer.hover_pos()).and_then(|point| area.picture_position(point));
    let hovered =
        pointer.and_then(|position| studio.handle_at(handles, position)).filter(|_| !studio.has_grip());
    for line in &handles.lines {
        let width = if hovered == Some(line.handle) { 3.0 } else { 1.5 };
        let stroke = Stroke::new(width, color(handles.all[line.handle].kind));
        for piece in studio.camera.strokes(line.from, line.to, area.size) {
            painter.line_segment(piece.ends.map(|end| area.point(end)), stroke);
        }
    }
    let points = handles.all.iter().enumerate().flat_map(|(index, handle)| {
        let places = studio.camera.projections(handle.at, area.size).into_iter().flatten();
        places.map(move |position| (index, handle, area.point(position)))
    });
    for (index, handle, at) in points.filter(|(_, handle, _)| !matches!(handle.kind, HandleKind::Ring(_))) {
        let r = if hovered == Some(index) { 6.5 } else { 4.5 };
        let fill = color(handle.kind);
        let edge = Stroke::new(1.0, Color32::from_black_alpha(200));
        match handle.kind {
            HandleKind::Square(_) | HandleKind::Scale(_) | HandleKind::Size => {
                let square = Rect::from_center_size(at, Vec2::splat(1.8 * r));
                painter.rect(square, 1.0, fill, edge, StrokeKind::Outside);
            }
            _ => {
                painter.circle(at, r, fill, edge);
            }
        }
        if hovered == Some(index) {
            let font = FontId::proportional(12.0);
            painter.text(
                at + Vec2::new(12.0, -10.0),
                Align2::LEFT_BOTTOM,
                handle.about,
                font,
                Color32::WHITE,
            );
        }
    }
}

/// Red, green and blue for the axes x, y and z.
fn color(kind: HandleKind) -> Color32 {
    const AXES: [Color32; 3] =
        [Color32::from_rgb(240, 90, 90), Color32::from_rgb(110, 210, 90), Color32::from_rgb(90, 150, 255)];
    match kind {
        HandleKind::Arrow(axis)
        | HandleKind::Square(axis)
        | HandleKind::Ring(axis)
        | HandleKind::Scale(axis) => AXES.get(axis).copied().unwrap_or(theme::ACCENT),
        HandleKind::Middle => Color32::WHITE,
        HandleKind::Point | HandleKind::Size | HandleKind::Direction => theme::ACCENT,
    }
}

/// Takes the whole middle of the window.
pub fn allocate(ui: &mut Ui) -> Response {
    let rect = ui.available_rect_before_wrap();
    let response = ui.allocate_rect(rect, Sense::click_and_drag());
    if response.is_pointer_button_down_on() {
        // Keys are for flying again.
        ui.memory_mut(|memory| {
            if let Some(id) = memory.focused() {
                memory.surrender_focus(id);
            }
        });
    }
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Canvas, true, "Viewport"));
    response
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    #[test]
    fn places_are_counted_in_pixels_of_the_picture() {
        let rect = Rect::from_min_max(pos2(100.0, 50.0), pos2(300.0, 150.0));
        let area = Area { rect, size: [400, 200] };
        assert_eq!(area.picture_position(pos2(100.0, 50.0)), Some(DVec2::ZERO));
        assert_eq!(area.picture_position(pos2(200.0, 100.0)), Some(DVec2::new(200.0, 100.0)));
        assert_eq!(area.pixel(pos2(300.0, 150.0)), Some([399, 199]));
        assert_eq!(area.picture_position(pos2(99.0, 60.0)), None);
        assert_eq!(area.pixel(pos2(200.0, 151.0)), None);
    }
}
