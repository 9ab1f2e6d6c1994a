//! The middle of the window: the preview or the traced picture, and the mouse in it.

use egui::{PointerButton, Rect, Response, Sense, Ui, Vec2};
use kajo_math::DVec2;

use crate::state::Action;

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
    pub fn place(&self, point: egui::Pos2) -> Option<DVec2> {
        let share = (point - self.rect.min) / self.rect.size();
        let inside = (0.0..=1.0).contains(&share.x) && (0.0..=1.0).contains(&share.y);
        let [width, height] = self.size.map(f64::from);
        inside.then(|| DVec2::new(f64::from(share.x) * width, f64::from(share.y) * height))
    }

    /// The pixel under a point of the window.
    pub fn pixel(&self, point: egui::Pos2) -> Option<[u32; 2]> {
        let place = self.place(point)?;
        let [width, height] = self.size;
        Some([(place.x as u32).min(width.saturating_sub(1)), (place.y as u32).min(height.saturating_sub(1))])
    }
}

/// What the mouse in the viewport asks for.
pub fn mouse(ui: &Ui, response: &Response, area: Area) -> Vec<Action> {
    let mut actions = Vec::new();
    if response.clicked()
        && let Some(place) = response.interact_pointer_pos().and_then(|point| area.place(point))
    {
        let several = ui.input(|input| input.modifiers.command || input.modifiers.shift);
        actions.push(Action::Pick(place, several));
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
        assert_eq!(area.place(pos2(100.0, 50.0)), Some(DVec2::ZERO));
        assert_eq!(area.place(pos2(200.0, 100.0)), Some(DVec2::new(200.0, 100.0)));
        assert_eq!(area.pixel(pos2(300.0, 150.0)), Some([399, 199]));
        assert_eq!(area.place(pos2(99.0, 60.0)), None);
        assert_eq!(area.pixel(pos2(200.0, 151.0)), None);
    }
}
