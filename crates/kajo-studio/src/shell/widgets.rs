//! Rows of a panel: a name, a widget, and a way back to what the scene says.

use egui::{DragValue, Id, Response, RichText, Ui};
use kajo_edit::FieldValue;

use super::theme;

/// Two columns of names and widgets.
pub fn rows(ui: &mut Ui, name: &str, add: impl FnOnce(&mut Ui)) {
    egui::Grid::new(name).num_columns(2).spacing([10.0, 6.0]).min_col_width(92.0).show(ui, add);
}

/// A row whose widget changes a value in place.
///
/// * `hint`: shown when the pointer rests on the name
pub fn row(ui: &mut Ui, name: &str, hint: &str, add: impl FnOnce(&mut Ui) -> Response) -> Response {
    let label = ui.label(RichText::new(name).color(ui.visuals().text_color())).on_hover_text(hint);
    let response = ui.horizontal(|ui| add(ui).labelled_by(label.id)).inner;
    ui.end_row();
    response
}

/// A row for something that the scene says unless the user does.
///
/// * `asked`: what the user says
/// * `value`: what holds now
pub fn option<T: Clone>(
    ui: &mut Ui,
    name: &str,
    hint: &str,
    asked: &mut Option<T>,
    value: T,
    add: impl FnOnce(&mut Ui, &mut T) -> Response,
) {
    let color = if asked.is_some() { theme::accent(ui) } else { ui.visuals().text_color() };
    let label = ui.label(RichText::new(name).color(color)).on_hover_text(hint);
    ui.horizontal(|ui| {
        let mut value = value;
        if add(ui, &mut value).labelled_by(label.id).changed() {
            *asked = Some(value);
        }
        if asked.is_some() {
            let back = ui.small_button("×").on_hover_text("Back to what the scene says");
            if back.accessible_name(format!("Reset {name}")).clicked() {
                *asked = None;
            }
        }
    });
    ui.end_row();
}

/// A list to choose from.
pub fn choice<T: PartialEq + Copy>(ui: &mut Ui, id: &str, value: &mut T, all: &[(&str, T)]) -> Response {
    let name = all.iter().find(|(_, one)| one == value).map_or("other", |(name, _)| name);
    let mut changed = false;
    let combo = egui::ComboBox::from_id_salt(id).selected_text(capitalised(name)).show_ui(ui, |ui| {
        for (name, one) in all {
            changed |= ui.selectable_value(value, *one, capitalised(name)).changed();
        }
    });
    let mut response = combo.response;
    if changed {
        response.mark_changed();
    }
    response
}

/// A swatch that opens a picker, and the three numbers, which may be above one.
pub fn color(ui: &mut Ui, value: &FieldValue, label: Id) -> Option<FieldValue> {
    let mut rgb = match value.numbers[..] {
        [r, g, b, ..] => [r, g, b],
        [grey] => [grey; 3],
        _ => [0.0; 3],
    };
    let brightest = rgb.iter().fold(1.0, |most: f64, v| most.max(*v));
    // Brighter than white: the picker shows the hue, and the brightness stays.
    let mut shown = rgb.map(|v| (v / brightest) as f32);
    let picker = ui.color_edit_button_rgb(&mut shown).on_hover_text("Linear red, green and blue");
    let mut any = picker.labelled_by(label).changed();
    if any {
        rgb = shown.map(|v| tidy((f64::from(v) * brightest * 1e4).round() / 1e4));
    }
    ui.spacing_mut().item_spacing.x = 3.0;
    ui.spacing_mut().interact_size.x = 40.0;
    for (v, name) in rgb.iter_mut().zip(["red", "green", "blue"]) {
        let drag = DragValue::new(v).speed(0.005).range(0.0..=f64::MAX).max_decimals(3);
        if ui.add(drag).labelled_by(label).on_hover_text(name).changed() {
            *v = tidy(*v);
            any = true;
        }
    }
    any.then(|| FieldValue::numbers(rgb))
}

/// Without the digits that come from computing in binary.
pub fn tidy(v: f64) -> f64 {
    (v * 1e6).round() / 1e6
}

/// A headline over a group of rows that can be folded away.
pub fn section(ui: &mut Ui, title: &str, open: bool, add: impl FnOnce(&mut Ui)) {
    egui::CollapsingHeader::new(RichText::new(title).strong()).default_open(open).show_unindented(ui, |ui| {
        ui.add_space(2.0);
        add(ui);
        ui.add_space(6.0);
    });
}

/// With a capital letter, for names that are small in scenes.
pub fn capitalised(name: &str) -> String {
    let mut letters = name.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_no_binary_dust() {
        assert_eq!(tidy(0.1 + 0.2), 0.3);
    }

    #[test]
    fn names_get_a_capital() {
        assert_eq!(capitalised("path"), "Path");
        assert_eq!(capitalised("élan"), "Élan");
        assert_eq!(capitalised(""), "");
    }
}
