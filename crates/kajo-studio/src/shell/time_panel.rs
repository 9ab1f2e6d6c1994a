//! The time line: buttons that play and step, and below them a ruler of frames and a row for each value with keys.

use egui::{
    Align2, Button, Color32, DragValue, FontId, Rect, Response, RichText, ScrollArea, Sense, Shape, Stroke,
    Ui, Vec2, pos2, vec2,
};
use kajo_edit::{Interpolation, Key, KeyRow, ModelRow, Outside, Timing, number_text};

use super::theme;
use super::widgets::{capitalised, choice};
use crate::state::{Action, Studio};

/// Height of a row, in points.
const ROW: f32 = 18.0;

/// Height of the ruler.
const RULER: f32 = 20.0;

/// Half the width of the mark of a key.
const MARK: f32 = 5.0;

/// Free space left and right of the frames.
const MARGIN: f32 = 10.0;

/// Ticks with numbers are at least so far apart.
const BETWEEN_NUMBERS: f32 = 44.0;

/// Width of the lists that say how keys go on.
const MODES: f32 = 230.0;

/// How near to a key the pointer takes it.
const REACH: f32 = 7.0;

/// The height that it has to begin with, and that of its buttons and ruler alone.
pub const HEIGHTS: [f32; 2] = [130.0, 64.0];

/// A part of the sign of a button, in points from its middle.
enum IconPart {
    /// A triangle with its tip at the second place, and its base at the first.
    Arrow(f32, f32),
    /// An upright bar.
    Bar(f32),
    /// A key.
    Key(f32),
}

const PLAY: [IconPart; 1] = [IconPart::Arrow(-4.0, 6.0)];
const PAUSE: [IconPart; 2] = [IconPart::Bar(-3.0), IconPart::Bar(3.0)];
const BACK: [IconPart; 2] = [IconPart::Arrow(0.0, -7.0), IconPart::Bar(4.0)];
const ON: [IconPart; 2] = [IconPart::Bar(-4.0), IconPart::Arrow(0.0, 7.0)];
const KEY_BEFORE: [IconPart; 2] = [IconPart::Arrow(0.0, -7.0), IconPart::Key(5.0)];
const NEXT_KEY: [IconPart; 2] = [IconPart::Key(-5.0), IconPart::Arrow(0.0, 7.0)];
const FIRST: [IconPart; 2] = [IconPart::Bar(-6.0), IconPart::Arrow(5.0, -4.0)];
const LAST: [IconPart; 2] = [IconPart::Arrow(-5.0, 4.0), IconPart::Bar(6.0)];

/// The whole panel; what it asks for goes into `actions`.
pub fn show(ui: &mut Ui, studio: &Studio, actions: &mut Vec<Action>) {
    let Some(timing) = studio.time_line.timing() else {
        ui.label(RichText::new("Open a scene to see its frames.").color(theme::quiet(ui)));
        return;
    };
    ui.horizontal(|ui| buttons(ui, studio, &timing, actions));
    let names = (0.25 * ui.available_width()).clamp(70.0, 200.0);
    let scale = Scale::new(ui, names, studio, &timing);
    ruler(ui, &scale, actions);
    let rows = studio.time_line.rows();
    let models = studio.document.as_ref().map_or(&[][..], |document| document.model_rows());
    if rows.is_empty() && models.is_empty() {
        ui.label(RichText::new("No value of this scene has keys yet.").color(theme::quiet(ui)));
        return;
    }
    ui.spacing_mut().item_spacing.y = 0.0;
    let area = ScrollArea::vertical().id_salt("keys").auto_shrink(false).max_height(ui.available_height());
    area.show_rows(ui, ROW, rows.len() + models.len(), |ui, shown| {
        let keyed = rows.iter().skip(shown.start).take(shown.len());
        keyed.for_each(|row| row_of_keys(ui, &scale, studio, row, actions));
        let [first, last] = [shown.start, shown.end].map(|at| at.saturating_sub(rows.len()));
        models[first..last].iter().for_each(|row| row_of_model(ui, &scale, studio, row, actions));
    });
}

/// The buttons, and what is set by numbers.
fn buttons(ui: &mut Ui, studio: &Studio, timing: &Timing, actions: &mut Vec<Action>) {
    let line = &studio.time_line;
    let play: (&[IconPart], &str) = if line.is_playing() { (&PAUSE, "Pause") } else { (&PLAY, "Play") };
    let all: [(&[IconPart], &str, Action); 7] = [
        (&FIRST, "First frame", Action::ShowFrame(timing.first)),
        (&KEY_BEFORE, "Key before", Action::StepKey(false)),
        (&BACK, "Frame before", Action::StepFrame(-1)),
        (play.0, play.1, Action::Play),
        (&ON, "Next frame", Action::StepFrame(1)),
        (&NEXT_KEY, "Next key", Action::StepKey(true)),
        (&LAST, "Last frame", Action::ShowFrame(timing.last)),
    ];
    ui.spacing_mut().item_spacing.x = 3.0;
    for (sign, name, action) in all {
        let button = ui.add(Button::new("").min_size(vec2(26.0, 0.0))).on_hover_text(hint_of(name));
        draw(ui, sign, button.rect.center(), ui.style().interact(&button).fg_stroke.color);
        if button.accessible_name(name).clicked() {
            actions.push(action);
        }
    }
    if ui.selectable_label(line.loops, "Loop").on_hover_text("Begin anew at the end").clicked() {
        actions.push(Action::Loop(!line.loops));
    }
    ui.spacing_mut().item_spacing.x = 6.0;
    ui.separator();
    let label = ui.label("Frame");
    let mut frame = timing.frame;
    if ui.add(DragValue::new(&mut frame).speed(0.2)).labelled_by(label.id).changed() {
        actions.push(Action::ShowFrame(frame));
    }
    ui.label(format!("{:.3} s", timing.seconds(timing.frame as f64)));
    ui.separator();
    frames(ui, timing, actions);
    if let Some(row) = line.chosen_row()
        && ui.available_width() > MODES
    {
        ui.separator();
        modes(ui, row, actions);
    }
}

/// How the values of the chosen keys go from key to key, and what holds outside of them.
fn modes(ui: &mut Ui, row: &KeyRow, actions: &mut Vec<Action>) {
    let mut interpolation = row.interpolation;
    if choice(ui, "between keys", &mut interpolation, &Interpolation::NAMES).changed() {
        actions.push(Action::SetInterpolation(None, interpolation));
    }
    let mut outside = row.outside;
    if choice(ui, "outside of keys", &mut outside, &Outside::NAMES).changed() {
        actions.push(Action::SetOutside(None, outside));
    }
}

/// What can be done to a row.
fn menu(ui: &mut Ui, row: &KeyRow, now: f64, actions: &mut Vec<Action>) {
    let is_free = row.key_at(row.within(now)).is_none();
    if ui.add_enabled(is_free, Button::new("Set a key at this frame")).clicked() {
        actions.push(Action::InsertKey(row.owner.clone()));
        ui.close();
    }
    ui.separator();
    for (name, mode) in Interpolation::NAMES {
        if ui.radio(row.interpolation == mode, capitalised(name)).clicked() {
            actions.push(Action::SetInterpolation(Some(row.owner.clone()), mode));
            ui.close();
        }
    }
    ui.separator();
    for (name, mode) in Outside::NAMES {
        if ui.radio(row.outside == mode, capitalised(name)).clicked() {
            actions.push(Action::SetOutside(Some(row.owner.clone()), mode));
            ui.close();
        }
    }
    ui.separator();
    if ui.button("Choose all its keys").clicked() {
        let keys = row.keys.iter().map(|key| (row.owner.clone(), key.frame)).collect();
        actions.push(Action::ChooseKeys(keys, false));
        ui.close();
    }
}

/// Draws the sign of a button.
fn draw(ui: &Ui, sign: &[IconPart], middle: egui::Pos2, color: Color32) {
    let painter = ui.painter();
    let at = |x: f32, y: f32| middle + vec2(x, y);
    let fill = |points: Vec<egui::Pos2>| Shape::convex_polygon(points, color, Stroke::NONE);
    for part in sign {
        match *part {
            IconPart::Arrow(base, tip) => {
                painter.add(fill(vec![at(base, -5.0), at(tip, 0.0), at(base, 5.0)]));
            }
            IconPart::Bar(x) => {
                painter.vline(middle.x + x, middle.y - 5.0..=middle.y + 5.0, Stroke::new(2.0, color));
            }
            IconPart::Key(x) => {
                painter.add(fill(vec![at(x, -3.5), at(x + 3.5, 0.0), at(x, 3.5), at(x - 3.5, 0.0)]));
            }
        }
    }
}

/// The range and the rate of frames, which are numbers of the text.
fn frames(ui: &mut Ui, timing: &Timing, actions: &mut Vec<Action>) {
    let hint = match timing.block {
        Some(_) => "In the scene's Animation block",
        None => "The scene does not say it yet: a change writes an Animation block",
    };
    let [mut first, mut last] = [timing.first, timing.last];
    let label = ui.label("Frames").on_hover_text(hint);
    let start = ui.add(DragValue::new(&mut first).speed(0.2).range(i64::MIN / 4..=last));
    let start = start.labelled_by(label.id).on_hover_text(hint);
    ui.label("to");
    let end = ui.add(DragValue::new(&mut last).speed(0.2).range(first..=i64::MAX / 4));
    let end = end.labelled_by(label.id).on_hover_text(hint);
    if start.changed() || end.changed() {
        actions.push(Action::SetFrames([first, last]));
    }
    let mut fps = timing.fps;
    let drag = DragValue::new(&mut fps).speed(0.1).range(0.001..=1e6).max_decimals(3).suffix(" per second");
    if ui.add(drag).on_hover_text(hint).accessible_name("Rate").changed() {
        actions.push(Action::SetRate((fps * 1e3).round() / 1e3));
    }
}

/// What a button does, and its key.
fn hint_of(name: &str) -> String {
    let key = match name {
        "Key before" => " (Shift+,)",
        "Frame before" => " (,)",
        "Play" | "Pause" => " (K)",
        "Next frame" => " (.)",
        "Next key" => " (Shift+.)",
        _ => "",
    };
    format!("{name}{key}")
}

/// Where frames are.
struct Scale {
    /// The width of the names before the frames.
    names: f32,
    /// Where frames are drawn, of any height.
    track: Rect,
    /// The frames at its ends.
    ends: [f64; 2],
    /// The frames that the scene has.
    frames: [f64; 2],
    /// The frame on show.
    now: f64,
}

impl Scale {
    /// Of all frames that the scene has, and all its keys.
    fn new(ui: &Ui, names: f32, studio: &Studio, timing: &Timing) -> Scale {
        let all = ui.available_rect_before_wrap();
        // The bar that scrolls stands beside it.
        let bar = ui.spacing().scroll.allocated_width();
        let track = Rect::from_min_max(
            pos2(all.left() + names + MARGIN, all.top()),
            pos2((all.right() - MARGIN - bar).max(all.left() + names + MARGIN + 1.0), all.bottom()),
        );
        let frames = [timing.first as f64, timing.last as f64];
        let now = timing.frame as f64;
        let keys = studio.time_line.rows().iter().flat_map(|row| &row.keys).map(|key| key.frame);
        let ends = keys.chain([now]).fold(frames, |[least, most], frame| [least.min(frame), most.max(frame)]);
        let ends = [ends[0], ends[1].max(ends[0] + 1.0)];
        Scale { names, track, ends, frames, now }
    }

    /// Points from one frame to the next.
    fn points(&self) -> f32 {
        self.track.width() / (self.ends[1] - self.ends[0]) as f32
    }

    fn x(&self, frame: f64) -> f32 {
        let share = (frame - self.ends[0]) / (self.ends[1] - self.ends[0]);
        self.track.left() + share as f32 * self.track.width()
    }

    /// The frame nearest to a place.
    fn frame(&self, x: f32) -> i64 {
        let share = f64::from(((x - self.track.left()) / self.track.width()).clamp(0.0, 1.0));
        (self.ends[0] + share * (self.ends[1] - self.ends[0])).round() as i64
    }
}

/// Asks for the frame at the pointer, where it presses.
fn scrub(response: &Response, scale: &Scale, actions: &mut Vec<Action>) {
    if let Some(at) = response.interact_pointer_pos().filter(|_| response.is_pointer_button_down_on()) {
        let frame = scale.frame(at.x);
        if frame as f64 != scale.now {
            actions.push(Action::ShowFrame(frame));
        }
    }
}

/// The numbers of the frames, and the frame on show, which is dragged.
fn ruler(ui: &mut Ui, scale: &Scale, actions: &mut Vec<Action>) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), RULER), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, "Time"));
    scrub(&response, scale, actions);
    let painter = ui.painter();
    let quiet = theme::quiet(ui);
    let [first, last] = scale.frames.map(|frame| scale.x(frame));
    let within = Rect::from_x_y_ranges(first..=last, rect.y_range());
    painter.rect_filled(within, 2.0, ui.visuals().extreme_bg_color);
    let step = tick_step(scale.points());
    let mut frame = (scale.ends[0] / step as f64).ceil() as i64 * step;
    while frame as f64 <= scale.ends[1] {
        let x = scale.x(frame as f64);
        painter.vline(x, rect.bottom() - 5.0..=rect.bottom(), Stroke::new(1.0, quiet));
        let at = pos2(x, rect.top() + 7.0);
        painter.text(at, Align2::CENTER_CENTER, frame.to_string(), FontId::proportional(10.5), quiet);
        frame += step;
    }
    let (x, accent) = (scale.x(scale.now), theme::accent(ui));
    let text =
        painter.layout_no_wrap(format!("{}", scale.now), FontId::proportional(11.0), theme::on_accent(ui));
    let flag = Rect::from_center_size(pos2(x, rect.top() + 8.0), text.size() + vec2(8.0, 2.0));
    painter.rect_filled(flag, 3.0, accent);
    painter.galley(flag.center() - 0.5 * text.size(), text, accent);
    painter.vline(x, flag.bottom()..=rect.bottom(), Stroke::new(1.5, accent));
}

/// Frames from one number of the ruler to the next: 1, 2 or 5 times a power of ten.
fn tick_step(points: f32) -> i64 {
    let least = f64::from(BETWEEN_NUMBERS / points.max(1e-9));
    let mut power = 1_i64;
    while power < 1_000_000_000_000 {
        if let Some(step) = [1, 2, 5].into_iter().map(|n| n * power).find(|&step| step as f64 >= least) {
            return step;
        }
        power *= 10;
    }
    power
}

/// The name of a value, and a mark for each of its keys.
fn row_of_keys(ui: &mut Ui, scale: &Scale, studio: &Studio, row: &KeyRow, actions: &mut Vec<Action>) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    let id = ui.scope_id().with(&row.owner);
    let node = row.owner.node();
    let is_chosen = node.is_some_and(|node| studio.selection.has(node));
    let response = row_name(ui, scale, (rect, id), &row.name, is_chosen);
    let response = response.on_hover_text(about(row));
    response.context_menu(|ui| menu(ui, row, scale.now, actions));
    if response.clicked()
        && let Some(node) = node
    {
        actions.push(Action::Select(vec![node]));
    }
    track(ui, scale, studio, row, rect, id, actions);
}

/// The keys of a model's own animation, which are in its file.
fn row_of_model(ui: &mut Ui, scale: &Scale, studio: &Studio, row: &ModelRow, actions: &mut Vec<Action>) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    let id = ui.scope_id().with(("model", row.node));
    let response = row_name(ui, scale, (rect, id), &row.name, studio.selection.has(row.node));
    let about = format!("{}: {} keys in the model's file", row.name, row.frames.len());
    if response.on_hover_text(about).clicked() {
        actions.push(Action::Select(vec![row.node]));
    }
    let all =
        Rect::from_x_y_ranges(scale.track.left() - MARGIN..=scale.track.right() + MARGIN, rect.y_range());
    scrub(&ui.interact(all, id.with("track"), Sense::click_and_drag()), scale, actions);
    let (y, quiet) = (rect.center().y, theme::quiet(ui));
    let painter = ui.painter().with_clip_rect(all.intersect(ui.clip_rect()));
    painter.hline(scale.track.x_range(), y, Stroke::new(1.0, ui.visuals().faint_bg_color));
    painter.vline(scale.x(scale.now), rect.y_range(), Stroke::new(1.0, theme::accent(ui)));
    // Of many keys at one place one is drawn.
    let mut drawn = f32::NEG_INFINITY;
    for x in row.frames.iter().map(|&frame| scale.x(frame)) {
        if x >= drawn + 1.0 && all.x_range().contains(x) {
            painter.circle_stroke(pos2(x, y), 0.6 * MARK, Stroke::new(1.0, quiet));
            drawn = x;
        }
    }
}

/// The name of a row, which is clicked on.
fn row_name(ui: &Ui, scale: &Scale, (rect, id): (Rect, egui::Id), name: &str, is_chosen: bool) -> Response {
    let place = Rect::from_min_size(rect.min, Vec2::new(scale.names, ROW));
    let response = ui.interact(place, id.with("name"), Sense::click());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Row, true, format!("Keys of {name}")));
    if is_chosen {
        ui.painter().rect_filled(place, 2.0, ui.visuals().selection.bg_fill);
    } else if response.hovered() {
        ui.painter().rect_filled(place, 2.0, ui.visuals().faint_bg_color);
    }
    let color = if is_chosen { ui.visuals().selection.stroke.color } else { ui.visuals().text_color() };
    let painter = ui.painter().with_clip_rect(place.shrink2(vec2(4.0, 0.0)).intersect(ui.clip_rect()));
    let at = pos2(place.left() + 6.0, place.center().y);
    painter.text(at, Align2::LEFT_CENTER, name, FontId::proportional(12.0), color);
    response
}

/// What is to be known of a row.
fn about(row: &KeyRow) -> String {
    let count = if row.keys.len() == 1 { "1 key".to_owned() } else { format!("{} keys", row.keys.len()) };
    let mut text = format!("{}: {count}\nRight click: how values go from key to key", row.name);
    if row.is_repeated {
        text.push_str("\nIt stands in `repeat`: a change is one of all its turns.");
    }
    text
}

/// The keys of a row, which are chosen and dragged; between them one scrubs.
fn track(
    ui: &mut Ui,
    scale: &Scale,
    studio: &Studio,
    row: &KeyRow,
    rect: Rect,
    id: egui::Id,
    actions: &mut Vec<Action>,
) {
    let all =
        Rect::from_x_y_ranges(scale.track.left() - MARGIN..=scale.track.right() + MARGIN, rect.y_range());
    let ground = ui.interact(all, id.with("track"), Sense::click_and_drag());
    grab(ui, &ground, scale, studio, row, actions);
    ground.context_menu(|ui| menu(ui, row, scale.now, actions));
    let y = rect.center().y;
    let painter = ui.painter();
    painter.hline(scale.track.x_range(), y, Stroke::new(1.0, ui.visuals().faint_bg_color));
    if let [first, .., last] = &*row.keys {
        painter.hline(scale.x(first.frame)..=scale.x(last.frame), y, Stroke::new(1.5, theme::quiet(ui)));
    }
    painter.vline(scale.x(scale.now), rect.y_range(), Stroke::new(1.0, theme::accent(ui)));
    for (index, key) in row.keys.iter().enumerate() {
        let place = pos2(scale.x(key.frame), y);
        let around = Rect::from_center_size(place, Vec2::splat(2.0 * MARK + 2.0));
        let response = ui.interact(around, id.with(index), Sense::hover());
        let name = format!("Key {} of {}", frame_text(key.frame), row.name);
        let is_chosen = studio.time_line.is_chosen(&row.owner, key.frame);
        response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_chosen, &name));
        mark(ui, place, key.is_at(scale.now), is_chosen);
        response.on_hover_text(about_key(key));
    }
}

/// A press on a key chooses it, a drag moves it and all others that are chosen; elsewhere they are the time's.
fn grab(ui: &Ui, ground: &Response, scale: &Scale, studio: &Studio, row: &KeyRow, actions: &mut Vec<Action>) {
    let line = &studio.time_line;
    let near = |x: f32| {
        let distance = |key: &&Key| (scale.x(key.frame) - x).abs();
        let nearest = row.keys.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.filter(|key| distance(key) <= REACH)
    };
    let (origin, was_pressed, is_primary, more) = ui.input(|input| {
        let pointer = &input.pointer;
        let more = input.modifiers.shift || input.modifiers.command;
        (pointer.press_origin(), pointer.any_pressed(), pointer.primary_down(), more)
    });
    let Some(origin) = origin.filter(|_| ground.is_pointer_button_down_on() && is_primary) else {
        if let Some(key) = ground.interact_pointer_pos().and_then(|at| near(at.x))
            && ground.double_clicked()
        {
            actions.push(Action::ShowFrame(key.frame.round() as i64));
        }
        return;
    };
    let memory = ground.id.with("key");
    if was_pressed {
        let key = near(origin.x);
        ui.data_mut(|data| data.insert_temp(memory, key.is_some()));
        if let Some(key) = key.filter(|key| more || !line.is_chosen(&row.owner, key.frame)) {
            actions.push(Action::ChooseKeys(vec![(row.owner.clone(), key.frame)], more));
        }
    }
    if !ui.data(|data| data.get_temp(memory)).unwrap_or(false) {
        scrub(ground, scale, actions);
    } else if ground.dragged()
        && let Some(at) = ground.interact_pointer_pos()
    {
        let by = ((at.x - origin.x) / scale.points()).round() as i64;
        actions.push(Action::DragKeys(by));
    }
}

/// When a key is, and what it says.
fn about_key(key: &Key) -> String {
    let values: Vec<String> = key.values.iter().map(|&value| number_text(value)).collect();
    let when = format!("Frame {}, {} s", frame_text(key.frame), number_text(key.seconds));
    let text = if values.is_empty() { when } else { format!("{when}: {}", values.join(" ")) };
    format!("{text}\nDrag moves it, Delete takes it out, a double click goes there")
}

/// A frame, with a fraction if it has one.
fn frame_text(frame: f64) -> String {
    number_text((frame * 1e3).round() / 1e3)
}

/// The mark of a key.
fn mark(ui: &Ui, at: egui::Pos2, is_now: bool, is_chosen: bool) {
    let corners = [vec2(0.0, -MARK), vec2(MARK, 0.0), vec2(0.0, MARK), vec2(-MARK, 0.0)].map(|way| at + way);
    let fill = match (is_chosen, is_now) {
        (true, _) => theme::accent(ui),
        (false, true) => ui.visuals().strong_text_color(),
        (false, false) => theme::quiet(ui),
    };
    let edge = if is_chosen { ui.visuals().strong_text_color() } else { Color32::from_black_alpha(160) };
    ui.painter().add(Shape::convex_polygon(corners.to_vec(), fill, Stroke::new(1.0, edge)));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_the_ruler_are_round_and_do_not_touch() {
        for (points, step) in [(100.0, 1), (30.0, 2), (10.0, 5), (5.0, 10), (0.5, 100), (1e-4, 500_000)] {
            assert_eq!(tick_step(points), step, "{points}");
        }
        assert!(tick_step(0.0) > 1_000_000);
    }
}
