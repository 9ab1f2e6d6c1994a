//! The stops of a ramp: a bar with its colours, markers to drag, and a row for each of them.

use egui::{Color32, CursorIcon, DragValue, Rect, Rgba, Sense, Shape, Stroke, Ui, pos2, vec2};
use kajo_edit::{FieldValue, Ramp, RampStop};

use super::widgets::color;

/// Height of the bar, and of the markers below it.
const BAR: f32 = 20.0;
const MARKER: f32 = 10.0;

/// The whole widget; the new stops where they were changed.
pub fn show(ui: &mut Ui, ramp: &Ramp) -> Option<Vec<RampStop>> {
    let by_bar = bar(ui, ramp);
    let mut by_rows = None;
    egui::Grid::new("stops")
        .num_columns(2)
        .spacing([6.0, 4.0])
        .min_col_width(0.0)
        .show(ui, |ui| by_rows = stop_rows(ui, ramp));
    by_bar.or(by_rows)
}

/// The colours; a click between the markers puts one more there, and markers are dragged as far as their neighbours.
fn bar(ui: &mut Ui, ramp: &Ramp) -> Option<Vec<RampStop>> {
    let places = ramp.stops.iter().map(|stop| stop.at);
    let [lo, hi] = places.fold([0.0, 1.0], |[lo, hi]: [f64; 2], at| [lo.min(at), hi.max(at)]);
    let width = ui.available_width().clamp(80.0, 280.0);
    let (rect, response) = ui.allocate_exact_size(vec2(width, BAR + MARKER), Sense::click());
    let response = response.on_hover_text("A click adds a stop; drag the marks below");
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Ramp"));
    // The outermost markers are wider than their places.
    let bar = Rect::from_min_size(rect.min + vec2(0.5 * MARKER, 0.0), vec2(width - MARKER, BAR));
    let x_of = |at: f64| bar.left() + (((at - lo) / (hi - lo)) as f32) * bar.width();
    let place_of = |x: f32| lo + f64::from((x - bar.left()) / bar.width()) * (hi - lo);
    let columns = bar.width() as usize;
    for column in 0..columns {
        let x = bar.left() + column as f32;
        let [r, g, b] = ramp.at(place_of(x + 0.5));
        let slice = Rect::from_min_max(pos2(x, bar.top()), pos2(x + 1.0, bar.bottom()));
        ui.painter().rect_filled(slice, 0.0, Color32::from(Rgba::from_rgb(r, g, b)));
    }
    let mut new = None;
    for (i, stop) in ramp.stops.iter().enumerate() {
        let tip = pos2(x_of(stop.at), bar.bottom());
        let place = Rect::from_center_size(tip + vec2(0.0, 0.5 * MARKER), vec2(MARKER, MARKER));
        let mark = ui
            .interact(place, ui.scope_id().with(("mark", i)), Sense::drag())
            .on_hover_cursor(CursorIcon::ResizeHorizontal);
        mark.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, format!("Mark {}", i + 1)));
        let edge = if mark.hovered() || mark.dragged() {
            ui.visuals().strong_text_color()
        } else {
            ui.visuals().text_color()
        };
        let [r, g, b] = stop.rgb.map(|v| v as f32);
        let corners = [vec2(0.0, 0.0), vec2(0.5 * MARKER, MARKER), vec2(-0.5 * MARKER, MARKER)];
        let corners = corners.map(|corner| tip + corner).to_vec();
        let fill = Color32::from(Rgba::from_rgb(r, g, b));
        ui.painter().add(Shape::convex_polygon(corners, fill, Stroke::new(1.2, edge)));
        if let Some(pointer) = mark.interact_pointer_pos().filter(|_| mark.dragged()) {
            new = Some(moved(ramp, i, place_of(pointer.x.clamp(bar.left(), bar.right()))));
        }
    }
    let clicked =
        response.interact_pointer_pos().filter(|pointer| response.clicked() && bar.contains(*pointer));
    new.or(clicked.map(|pointer| ramp.with_stop(rounded(place_of(pointer.x)))))
}

fn stop_rows(ui: &mut Ui, ramp: &Ramp) -> Option<Vec<RampStop>> {
    let mut new = None;
    for (i, stop) in ramp.stops.iter().enumerate() {
        let label = ui.label(format!("Stop {}", i + 1));
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 3.0;
            ui.spacing_mut().button_padding.x = 2.0;
            let mut at = stop.at;
            let [least, most] = ramp.room(i);
            let drag = DragValue::new(&mut at).range(least..=most).speed(0.005).max_decimals(4);
            if ui.add(drag).labelled_by(label.id).on_hover_text("where it is").changed() {
                new = Some(moved(ramp, i, at));
            }
            if let Some(value) = color(ui, &FieldValue::numbers(stop.rgb), label.id)
                && let [r, g, b] = value.numbers[..]
            {
                let mut stops = ramp.stops.clone();
                stops[i].rgb = [r, g, b].map(|v| v.clamp(0.0, 1.0));
                new = Some(stops);
            }
            let button = ui.small_button("×").on_hover_text("Take this stop out");
            if ramp.stops.len() > 1 && button.accessible_name(format!("Remove stop {}", i + 1)).clicked() {
                let mut stops = ramp.stops.clone();
                stops.remove(i);
                new = Some(stops);
            }
        });
        ui.end_row();
    }
    new
}

/// The stops with one of them somewhere else, between its neighbours.
fn moved(ramp: &Ramp, i: usize, at: f64) -> Vec<RampStop> {
    let [least, most] = ramp.room(i);
    let mut stops = ramp.stops.clone();
    stops[i].at = rounded(at).clamp(least, most);
    stops
}

/// As fine as a bar can show.
fn rounded(at: f64) -> f64 {
    (at * 1e4).round() / 1e4
}
