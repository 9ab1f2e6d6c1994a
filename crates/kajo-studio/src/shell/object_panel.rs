//! The fields of what is selected, each with a widget of its type: those that are set, and under *More* the others with
//! what holds for them, dimmed.

use egui::{
    CollapsingHeader, Color32, DragValue, Id, RichText, ScrollArea, Sense, Shape, Slider, SliderClamping,
    Stroke, TextEdit, Ui, UiBuilder, vec2,
};
use kajo_edit::{Document, Field, FieldKind, FieldValue, Keying, Kind, Node, NodeId, Ramp, RampStop};

use super::widgets::{choice, color, rows, tidy};
use super::{ramp, swatch, theme};
use crate::state::{Action, Selection, Studio};

/// How strongly what is not set is painted.
const DIM: f32 = 0.6;

/// The whole panel; what it asks for goes into `actions`.
pub fn show(ui: &mut Ui, studio: &Studio, actions: &mut Vec<Action>) {
    let Some(document) = &studio.document else { return };
    let selection = &studio.selection;
    let Some(node) = selection.main().and_then(|id| document.node(id)) else {
        ui.label(RichText::new("Click on something to see what it is made of.").color(theme::quiet(ui)));
        return;
    };
    head(ui, node, selection, actions);
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        picture(ui, studio, node);
        fields(ui, studio, document, node, actions);
        if let Some(material) = document.material_of(node.id).and_then(|id| document.node(id))
            && material.id != node.id
        {
            ui.add_space(8.0);
            ui.separator();
            material_head(ui, document, material, actions);
            picture(ui, studio, material);
            ui.push_id("material", |ui| fields(ui, studio, document, material, actions));
        }
    });
}

fn head(ui: &mut Ui, node: &Node, selection: &Selection, actions: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        ui.label(RichText::new(&*node.keyword).strong().size(15.0));
        if let Some(name) = &node.name {
            ui.label(RichText::new(&**name).color(theme::accent(ui)));
        }
        let others = selection.nodes().len().saturating_sub(1);
        if others > 0 {
            ui.label(RichText::new(format!("and {others} more")).color(theme::quiet(ui)));
        }
    });
    ui.horizontal(|ui| {
        for (text, action) in
            [("Frame", Action::Frame), ("Duplicate", Action::Duplicate), ("Delete", Action::Delete)]
        {
            if ui.small_button(text).clicked() {
                actions.push(action);
            }
        }
    });
    ui.add_space(6.0);
}

/// A picture of a texture, or of a material with textures.
fn picture(ui: &mut Ui, studio: &Studio, node: &Node) {
    if let Some(of_node) = studio.swatch_of(node.id) {
        swatch::large(ui, of_node, node.name.as_deref().unwrap_or(&node.keyword));
    }
}

/// The name of the material, and a list of all to paint with another.
fn material_head(ui: &mut Ui, document: &Document, material: &Node, actions: &mut Vec<Action>) {
    let name = |node: &Node| node.name.as_deref().map_or_else(|| node.keyword.to_string(), str::to_owned);
    ui.horizontal(|ui| {
        let label = ui.label(RichText::new("Material").strong());
        let combo = egui::ComboBox::from_id_salt("paint").selected_text(name(material)).show_ui(ui, |ui| {
            let all = document.outline().nodes().iter().filter(|node| node.kind == Kind::Material);
            for other in all {
                if ui.selectable_label(other.id == material.id, name(other)).clicked() {
                    actions.push(Action::Paint(other.id));
                }
            }
        });
        combo.response.labelled_by(label.id);
        if ui.small_button("Select").on_hover_text("Show where it is in the tree").clicked() {
            actions.push(Action::Select(vec![material.id]));
        }
    });
    ui.add_space(4.0);
}

fn fields(ui: &mut Ui, studio: &Studio, document: &Document, node: &Node, actions: &mut Vec<Action>) {
    let fields = document.fields(node.id);
    if fields.is_empty() {
        ui.label(RichText::new("It has no fields of its own.").color(theme::quiet(ui)));
        return;
    }
    let ramp = Ramp::of(&fields);
    if let Some(ramp) = &ramp
        && let Some(stops) = ui.push_id("ramp", |ui| ramp::show(ui, ramp)).inner
    {
        let values = stops.iter().map(RampStop::value).collect();
        actions.push(Action::SetFields { node: node.id, key: Ramp::KEY.to_owned(), values });
    }
    let is_shown = |field: &Field| ramp.is_none() || field.kind != FieldKind::ColorStop;
    let (set, others): (Vec<Field>, Vec<Field>) =
        fields.into_iter().filter(is_shown).partition(|field| studio.is_set(node.id, field));
    let mut list = |ui: &mut Ui, name: &str, fields: &[Field]| {
        rows(ui, name, |ui| fields.iter().for_each(|field| row(ui, studio, node.id, field, actions)));
    };
    list(ui, "fields", &set);
    if others.is_empty() {
        return;
    }
    let title = RichText::new(format!("More ({})", others.len())).color(theme::quiet(ui));
    let more = CollapsingHeader::new(title).id_salt(("more", &node.keyword)).default_open(set.is_empty());
    more.show_unindented(ui, |ui| list(ui, "others", &others));
}

fn row(ui: &mut Ui, studio: &Studio, node: NodeId, field: &Field, actions: &mut Vec<Action>) {
    let is_written = field.span.is_some();
    let color = if is_written { ui.visuals().strong_text_color() } else { theme::quiet(ui) };
    let label = ui.label(RichText::new(spaced(&field.key)).color(color)).on_hover_text(field.about);
    // The same widget wherever the row is: a field that is set goes to another list, and what was opened from here stays.
    let id = Id::unique(("field", node, &field.key, field.nth));
    ui.scope_builder(UiBuilder::new().scope_id(id), |ui| {
        ui.horizontal(|ui| {
            if !is_written {
                ui.multiply_opacity(DIM);
            }
            if let Some(named) = studio.swatch_in(field) {
                swatch::small(
                    ui,
                    named,
                    field.value.as_ref().and_then(|v| v.word.as_deref()).unwrap_or(&field.key),
                );
            }
            if let Some(value) = value_of_row(ui, field, label.id) {
                actions.push(Action::SetField { node, key: field.key.clone(), nth: field.nth, value });
            }
            let mut words = "";
            if is_written && studio.time_line.is_shown {
                // It has to find room in rows that are full already.
                ui.spacing_mut().item_spacing.x = 3.0;
                ui.spacing_mut().button_padding.x = 4.0;
                words = key_mark(ui, studio, node, field, actions);
            }
            if is_written && !field.required {
                let hint = match words {
                    "" => "Take it out: the default holds again",
                    _ => "Take it out with all its keys: the default holds again",
                };
                let button = ui.small_button("×").on_hover_text(hint);
                if button.accessible_name(format!("Reset {}", field.key)).clicked() {
                    actions.push(Action::UnsetField { node, key: field.key.clone(), nth: field.nth });
                }
            }
            if !words.is_empty() {
                ui.label(RichText::new(words).small().color(theme::accent(ui)));
            }
        });
    });
    ui.end_row();
}

/// Shows whether a value has keys; a click sets a key at the frame on show, or takes it out. Returns what a change does, in a
/// word or two; nothing where that is as ever.
fn key_mark(
    ui: &mut Ui,
    studio: &Studio,
    node: NodeId,
    field: &Field,
    actions: &mut Vec<Action>,
) -> &'static str {
    let (Some(document), Some(timing)) = (&studio.document, studio.time_line.timing()) else { return "" };
    let frame = timing.frame;
    let keying = document.keying(node, &field.key, field.nth);
    let (rect, response) = ui.allocate_exact_size(vec2(12.0, 16.0), Sense::click());
    let name = format!("Key of {}", field.key);
    let is_set = matches!(keying, Keying::Keyed { at_frame: true });
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_set, &name));
    let (accent, quiet) = (theme::accent(ui), theme::quiet(ui));
    let (fill, edge, words, hint) = match &keying {
        Keying::Keyed { at_frame: true } => (
            accent,
            accent,
            "key",
            format!("A change is one of the key at frame {frame}; a click takes it out"),
        ),
        Keying::Keyed { at_frame: false } => {
            let hint = format!("It has keys, but none at frame {frame}: a change or a click sets one");
            (Color32::TRANSPARENT, accent, "adds a key", hint)
        }
        Keying::Still => {
            let hint = format!("The same at all times; a click sets its first key, at frame {frame}");
            (Color32::TRANSPARENT, quiet, "", hint)
        }
        Keying::Fixed(why) => {
            ui.painter().circle_filled(rect.center(), 1.5, quiet);
            response.on_hover_text(format!("No key: {}", in_words(why)));
            return "";
        }
    };
    let size = if response.hovered() { 6.0 } else { 5.0 };
    let corners = [vec2(0.0, -size), vec2(size, 0.0), vec2(0.0, size), vec2(-size, 0.0)];
    let corners = corners.map(|way| rect.center() + way).to_vec();
    ui.painter().add(Shape::convex_polygon(corners, fill, Stroke::new(1.3, edge)));
    if response.on_hover_text(hint).clicked() {
        actions.push(Action::ToggleKey { node, key: field.key.clone(), nth: field.nth });
    }
    words
}

/// The widget of a field; where no value says what holds, what that is and a way to set one.
fn value_of_row(ui: &mut Ui, field: &Field, label: Id) -> Option<FieldValue> {
    if let Some(why) = &field.idle {
        ui.label(RichText::new(in_words(why)).italics());
        return None;
    }
    let is_typed = matches!(
        field.kind,
        FieldKind::File
            | FieldKind::Text
            | FieldKind::Picture
            | FieldKind::Function
            | FieldKind::Material
            | FieldKind::Integrator
    );
    match &field.value {
        Some(value) => match field.slider.filter(|_| value.word.is_none()) {
            None => editor(ui, field.kind, value, "", label),
            // Beside one number, below several.
            Some(range) if value.numbers.len() <= 1 => {
                let typed = editor(ui, field.kind, value, "", label);
                sliding(ui, value, range, label).or(typed)
            }
            Some(range) => {
                let both = ui.vertical(|ui| {
                    let typed = ui.horizontal(|ui| editor(ui, field.kind, value, "", label)).inner;
                    sliding(ui, value, range, label).or(typed)
                });
                both.inner
            }
        },
        None if is_typed || field.required => {
            editor(ui, field.kind, &field.start, &in_words(field.means), label)
        }
        None => {
            ui.label(in_words(field.means));
            let button = ui.small_button("Set").on_hover_text(format!("To {}", field.start.text()));
            button.accessible_name(format!("Set {}", field.key)).clicked().then(|| field.start.clone())
        }
    }
}

/// A widget for a value; the new value when it was changed.
///
/// * `hint`: what an empty text stands for
fn editor(ui: &mut Ui, kind: FieldKind, value: &FieldValue, hint: &str, label: Id) -> Option<FieldValue> {
    match kind {
        // A point or a name may stand where a distance can.
        FieldKind::Number { min, max } if value.word.is_none() && value.numbers.len() <= 1 => {
            number(ui, value, label, min, max)
        }
        FieldKind::Number { .. } if value.word.is_none() => {
            numbers(ui, value, label, value.numbers.len(), false)
        }
        FieldKind::Whole { min, max } => whole(ui, value, label, min, max),
        FieldKind::Count => whole(ui, value, label, 0.0, f64::from(u32::MAX)),
        FieldKind::Angle { min, max } => angle(ui, value, label, min, max),
        FieldKind::Point | FieldKind::Vector if value.word.is_none() => numbers(ui, value, label, 3, false),
        FieldKind::Color(_) => color(ui, value, label),
        FieldKind::Reflectance | FieldKind::Emission if value.word.is_none() => color(ui, value, label),
        FieldKind::Flag => {
            let mut on = value.word.as_deref() == Some("on");
            let word = if on { "On" } else { "Off" };
            let response = ui.checkbox(&mut on, word);
            response.labelled_by(label).changed().then(|| FieldValue::flag(on))
        }
        FieldKind::Choice(words) => words_choice(ui, value, label, words),
        FieldKind::ChoiceAndNumber(words, _) | FieldKind::ChoiceAndWhole(words, _) => {
            let is_whole = matches!(kind, FieldKind::ChoiceAndWhole(..));
            let word = words_choice(ui, value, label, words)
                .map(|new| FieldValue { numbers: value.numbers.clone(), ..new });
            let number =
                (!value.numbers.is_empty()).then(|| numbers(ui, value, label, 1, is_whole)).flatten();
            word.or(number.map(|new| FieldValue { word: value.word.clone(), ..new }))
        }
        FieldKind::ColorStop => numbers(ui, value, label, 4, false),
        FieldKind::Numbers(ranges) => numbers(ui, value, label, ranges.len().max(value.numbers.len()), false),
        // As long as they can be seen beside each other.
        FieldKind::Groups(_) if value.word.is_none() && (1..=16).contains(&value.numbers.len()) => {
            numbers(ui, value, label, value.numbers.len(), false)
        }
        FieldKind::Wholes(ranges) => numbers(ui, value, label, ranges.len(), true),
        FieldKind::File
        | FieldKind::Text
        | FieldKind::Picture
        | FieldKind::Groups(_)
        | FieldKind::Function
        | FieldKind::Number { .. }
        | FieldKind::Point
        | FieldKind::Vector
        | FieldKind::Material
        | FieldKind::Integrator
        | FieldKind::Reflectance
        | FieldKind::Emission => text(ui, value, hint, label),
    }
}

fn whole(ui: &mut Ui, value: &FieldValue, label: Id, min: f64, max: f64) -> Option<FieldValue> {
    let mut v = value.numbers.first().copied().unwrap_or(0.0);
    let drag = DragValue::new(&mut v).range(min..=max).clamp_existing_to_range(false);
    let drag = drag.speed(0.1).fixed_decimals(0);
    ui.add(drag).labelled_by(label).changed().then(|| FieldValue::numbers([v.round()]))
}

/// Numbers of a narrow range, such as shares and the spin of a black hole, have a slider.
fn number(ui: &mut Ui, value: &FieldValue, label: Id, min: f64, max: f64) -> Option<FieldValue> {
    /// The widest range of a slider.
    const NARROW: f64 = 30.0;
    let mut v = value.numbers.first().copied().unwrap_or(0.0);
    let response = if max - min <= NARROW {
        ui.add(Slider::new(&mut v, min..=max).clamping(SliderClamping::Edits).max_decimals(3))
    } else {
        let drag = DragValue::new(&mut v).range(min..=max).clamp_existing_to_range(false);
        ui.add(drag.speed(step(value.numbers.first().copied().unwrap_or(0.0))).max_decimals(6))
    };
    response.labelled_by(label).changed().then(|| FieldValue::numbers([tidy(v)]))
}

/// A slider over the range in which a number, or the length of a vector, is mostly tried.
fn sliding(ui: &mut Ui, value: &FieldValue, [lo, hi]: [f64; 2], label: Id) -> Option<FieldValue> {
    let is_vector = value.numbers.len() > 1;
    let length = value.numbers.iter().map(|v| v * v).sum::<f64>().sqrt();
    let mut new = length;
    let slider = Slider::new(&mut new, lo..=hi).clamping(SliderClamping::Never).show_value(is_vector);
    let response = ui.add(slider.logarithmic(lo > 0.0).max_decimals(4));
    let response = if is_vector { response.on_hover_text("how long it is") } else { response };
    response.labelled_by(label).changed().then(|| match (is_vector, length > 0.0) {
        (false, _) => FieldValue::numbers([tidy(new)]),
        (true, true) => FieldValue::numbers(value.numbers.iter().map(|v| tidy(v * new / length))),
        // A vector of no direction goes forward.
        (true, false) => FieldValue::numbers([0.0, 0.0, -tidy(new)]),
    })
}

fn angle(ui: &mut Ui, value: &FieldValue, label: Id, min: f64, max: f64) -> Option<FieldValue> {
    let mut v = value.numbers.first().copied().unwrap_or(0.0);
    let drag = DragValue::new(&mut v)
        .range(min..=max)
        .clamp_existing_to_range(false)
        .speed(0.25)
        .suffix("°")
        .max_decimals(3);
    ui.add(drag).labelled_by(label).changed().then(|| FieldValue::numbers([tidy(v)]))
}

/// Several numbers in a row, with names for three of them; of very many the first, while the others stay what they are.
fn numbers(ui: &mut Ui, value: &FieldValue, label: Id, count: usize, is_whole: bool) -> Option<FieldValue> {
    const SHOWN: usize = 16;
    let mut all = value.numbers.clone();
    all.resize(count.max(1), 0.0);
    let mut any = false;
    let size = all.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    ui.spacing_mut().item_spacing.x = 3.0;
    ui.spacing_mut().interact_size.x = 52.0;
    for (i, v) in all.iter_mut().enumerate().take(SHOWN) {
        let drag = DragValue::new(v).speed(step(size));
        let drag = if is_whole { drag.fixed_decimals(0) } else { drag.max_decimals(4) };
        let hint = ["x", "y", "z"].get(i).copied().filter(|_| count == 3).unwrap_or("number");
        let response = ui.add(drag).on_hover_text(hint);
        if response.labelled_by(label).changed() {
            *v = if is_whole { v.round() } else { tidy(*v) };
            any = true;
        }
    }
    any.then(|| FieldValue { word: value.word.clone(), numbers: all })
}

fn words_choice(
    ui: &mut Ui,
    value: &FieldValue,
    label: Id,
    words: &'static [&'static str],
) -> Option<FieldValue> {
    let current = value.word.as_deref().unwrap_or_default();
    let mut chosen = words.iter().position(|word| *word == current).unwrap_or(usize::MAX);
    let mut all: Vec<(&str, usize)> = words.iter().copied().zip(0..).collect();
    if chosen == usize::MAX && !current.is_empty() {
        // A word that is understood without being one of those that are offered.
        all.push((current, chosen));
    }
    let response = choice(ui, "words", &mut chosen, &all).labelled_by(label);
    let word = response.changed().then(|| words.get(chosen)).flatten()?;
    Some(FieldValue::word(*word))
}

/// A word, taken over when one has finished typing.
fn text(ui: &mut Ui, value: &FieldValue, hint: &str, label: Id) -> Option<FieldValue> {
    let id = ui.scope_id().with("typed");
    let written = value.text();
    let mut typed = ui.data(|data| data.get_temp::<String>(id)).unwrap_or_else(|| written.clone());
    let response =
        ui.add(TextEdit::singleline(&mut typed).hint_text(hint).desired_width(150.0)).labelled_by(label);
    if response.has_focus() {
        ui.data_mut(|data| data.insert_temp(id, typed));
        return None;
    }
    ui.data_mut(|data| data.remove::<String>(id));
    let is_new = response.lost_focus() && typed != written && !typed.trim().is_empty();
    is_new.then(|| value_of(typed.trim()))
}

/// Words and numbers as a scene has them.
fn value_of(typed: &str) -> FieldValue {
    let mut numbers = Vec::new();
    let mut words = Vec::new();
    for word in typed.split_whitespace() {
        match word.parse() {
            Ok(number) => numbers.push(number),
            Err(_) => words.push(word),
        }
    }
    let word = words.join(" ");
    let word = word.trim_matches('"').to_owned();
    FieldValue { word: (!word.is_empty()).then_some(word), numbers }
}

/// How much a value changes for a point of dragging.
fn step(v: f64) -> f64 {
    (v.abs() * 0.01).max(0.005)
}

/// A text with its keys, which stand between backticks, as the names that they have in the panel.
fn in_words(text: &str) -> String {
    text.split('`')
        .enumerate()
        .map(|(i, part)| if i % 2 == 1 { spaced(part) } else { part.to_owned() })
        .collect()
}

/// `diffuseColor` as `Diffuse color`.
fn spaced(key: &str) -> String {
    let mut text = String::with_capacity(key.len() + 4);
    for (i, letter) in key.chars().enumerate() {
        match letter {
            '_' => text.push(' '),
            _ if i == 0 => text.extend(letter.to_uppercase()),
            _ if letter.is_uppercase() => {
                text.push(' ');
                text.extend(letter.to_lowercase());
            }
            _ => text.push(letter),
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_become_names() {
        assert_eq!(spaced("diffuseColor"), "Diffuse color");
        assert_eq!(spaced("shade_back"), "Shade back");
        assert_eq!(spaced("radius"), "Radius");
        assert_eq!(in_words("only with `transparentColor`"), "only with Transparent color");
    }

    #[test]
    fn typed_values_are_words_and_numbers() {
        assert_eq!(value_of("gold 2.5"), FieldValue { word: Some("gold".into()), numbers: vec![2.5] });
        assert_eq!(value_of("\"a file.png\""), FieldValue::word("a file.png"));
        assert_eq!(value_of("1 2 3"), FieldValue::numbers([1.0, 2.0, 3.0]));
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(step(0.0), 0.005);
        assert_eq!(step(-200.0), 2.0);
    }
}
