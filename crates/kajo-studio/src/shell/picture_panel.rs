//! The panel about the picture on show: which layer, how light becomes colours, what is under the pointer, and how
//! the light is spread.

use egui::{Color32, Rect, RichText, Slider, Stroke, Ui, pos2, vec2};
use kajo::session::Frame;
use kajo::{RenderSettings, Settings, Tone, View};

use super::theme;
use super::widgets::{capitalised, choice, option, rows, section};
use crate::state::{Action, BINS, Histogram, stops_of};

/// What the panel shows.
pub struct Picture<'a> {
    pub frame: Option<&'a Frame>,
    pub histogram: Option<&'a Histogram>,
    /// The pixel under the pointer.
    pub pixel: Option<[u32; 2]>,
    pub view: View,
    pub settings: &'a RenderSettings,
}

/// All widgets; what they ask for goes into `actions`.
pub fn show(ui: &mut Ui, picture: &Picture<'_>, asked: &mut Settings, actions: &mut Vec<Action>) {
    section(ui, "Layer", true, |ui| layers(ui, picture, actions));
    section(ui, "Development", true, |ui| development(ui, asked, picture.settings));
    section(ui, "Histogram", true, |ui| match picture.histogram {
        Some(histogram) => draw_histogram(ui, histogram),
        None => quiet(ui, "Trace a picture to see how its light is spread."),
    });
    section(ui, "Pixel", true, |ui| match (picture.frame, picture.pixel) {
        (Some(frame), Some(pixel)) => inspect(ui, frame, pixel),
        _ => quiet(ui, "Point at a traced picture to read its numbers."),
    });
}

fn quiet(ui: &mut Ui, text: &str) {
    ui.label(RichText::new(text).color(theme::quiet(ui)));
}

fn layers(ui: &mut Ui, picture: &Picture<'_>, actions: &mut Vec<Action>) {
    ui.horizontal_wrapped(|ui| {
        for view in View::ALL {
            let button = ui.selectable_label(picture.view == view, capitalised(title(view)));
            if button.on_hover_text(about(view)).clicked() {
                actions.push(Action::Show(view));
            }
        }
    });
}

/// The name of a layer for people.
pub fn title(view: View) -> &'static str {
    match view {
        View::Variance => "noise",
        other => other.name(),
    }
}

fn about(view: View) -> &'static str {
    match view {
        View::Color => "The light, developed",
        View::Depth => "Distance along the ray: near is white",
        View::Normals => "Directions of surfaces as colours",
        View::Uv => "Coordinates on surfaces",
        View::Object => "Every object in a colour of its own",
        View::Material => "Every material in a colour of its own",
        View::Samples => "How many samples each pixel has",
        View::Albedo => "How much white light surfaces throw back",
        View::Motion => "Where surfaces move while the shutter is open",
        View::Variance => "How uncertain each pixel still is",
        View::Lost => "How many rays were given up where light is bent",
        View::Records => "Where the irradiance cache has its records",
        View::Lights => "The light of each emitter",
    }
}

fn development(ui: &mut Ui, asked: &mut Settings, settings: &RenderSettings) {
    let development = &settings.development;
    rows(ui, "development", |ui| {
        let hint = "Factors of two by which the picture is made brighter";
        option(ui, "Exposure", hint, &mut asked.exposure, development.exposure, |ui, stops| {
            ui.add(Slider::new(stops, -8.0..=8.0).suffix(" EV").max_decimals(2))
        });
        let hint = "The curve from light to what the display shows";
        option(ui, "Tone curve", hint, &mut asked.tone, development.tone, |ui, tone| {
            choice(ui, "tone", tone, &Tone::ALL.map(|tone| (tone.name(), tone)))
        });
        let white = development.white.unwrap_or([6500.0, 0.0]);
        let hint = "Temperature of the light that is to look white";
        option(ui, "White", hint, &mut asked.white_balance, white, |ui, white| {
            ui.add(Slider::new(&mut white[0], 2000.0..=15000.0).suffix(" K").fixed_decimals(0))
        });
    });
}

fn inspect(ui: &mut Ui, frame: &Frame, [x, y]: [u32; 2]) {
    rows(ui, "pixel", |ui| {
        ui.label("Place");
        ui.monospace(format!("{x}, {y}"));
        ui.end_row();
        for view in View::ALL {
            let Some(value) = frame.value(view, x, y) else { continue };
            ui.label(capitalised(title(view)));
            ui.monospace(in_words(view, value));
            ui.end_row();
        }
    });
}

/// The numbers of a layer at a pixel, as many as it has.
pub fn in_words(view: View, value: [f32; 3]) -> String {
    let [a, b, c] = value;
    match view {
        View::Depth if a.is_infinite() => "nothing hit".to_owned(),
        View::Depth => format!("{a:.4}"),
        View::Object | View::Material if a == 0.0 => "none".to_owned(),
        View::Object | View::Material | View::Samples => format!("{a:.0}"),
        View::Lost | View::Records => format!("{a:.3}"),
        View::Uv | View::Motion => format!("{a:.3} {b:.3}"),
        View::Variance => format!("{a:.2e} {b:.2e} {c:.2e}"),
        View::Color | View::Normals | View::Albedo | View::Lights => format!("{a:.3} {b:.3} {c:.3}"),
    }
}

fn draw_histogram(ui: &mut Ui, histogram: &Histogram) {
    let size = vec2(ui.available_width(), 88.0);
    let (rect, response) = ui.allocate_exact_size(size, egui::Sense::hover());
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 3.0, ui.visuals().extreme_bg_color);
    let bin_width = rect.width() / BINS as f32;
    let peak = (histogram.peak() as f32).sqrt();
    let colors = [
        Color32::from_rgba_unmultiplied(235, 90, 80, 110),
        Color32::from_rgba_unmultiplied(90, 200, 100, 110),
        Color32::from_rgba_unmultiplied(90, 140, 250, 110),
    ];
    for (counts, color) in histogram.counts.iter().zip(colors) {
        for (bin, &count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
            let height = (count as f32).sqrt() / peak * (rect.height() - 4.0);
            let x = rect.left() + bin as f32 * bin_width;
            let bar = Rect::from_min_max(pos2(x, rect.bottom() - height), pos2(x + bin_width, rect.bottom()));
            painter.rect_filled(bar, 0.0, color);
        }
    }
    // Light of one: what is to its right is brighter than a display can show without a curve.
    let one = (0..BINS).find(|&bin| stops_of(bin) >= 0.0).unwrap_or(BINS) as f32;
    let x = rect.left() + one * bin_width;
    painter.vline(x, rect.y_range(), Stroke::new(1.0, Color32::from_gray(110)));
    let [r, g, b] = histogram.above_one;
    response.on_hover_text(format!(
        "Stops from -12 to +4, square root of counts; the line is 1.0.\nAbove it: {r} red, {g} green, {b} blue."
    ));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_as_their_layer_has_them() {
        assert_eq!(in_words(View::Depth, [f32::INFINITY, 0.0, 0.0]), "nothing hit");
        assert_eq!(in_words(View::Depth, [1.5, 0.0, 0.0]), "1.5000");
        assert_eq!(in_words(View::Object, [0.0; 3]), "none");
        assert_eq!(in_words(View::Material, [3.0, 0.0, 0.0]), "3");
        assert_eq!(in_words(View::Uv, [0.25, 0.5, 0.0]), "0.250 0.500");
        assert_eq!(in_words(View::Color, [1.0, 0.5, 0.25]), "1.000 0.500 0.250");
    }

    #[test]
    fn every_layer_says_what_it_is() {
        for view in View::ALL {
            assert!(!title(view).is_empty() && !about(view).is_empty());
        }
    }
}
