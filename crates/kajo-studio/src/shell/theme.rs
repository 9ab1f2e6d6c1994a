//! Colours and sizes of the window: neutral, dark or light, so that they do not tint how a picture is seen, with one
//! warm colour for what is chosen.

use egui::{Color32, CornerRadius, FontFamily, FontId, Stroke, TextStyle, Theme, Ui, Visuals, vec2};

/// What is chosen, where it is painted over a picture.
pub const ACCENT: Color32 = Color32::from_rgb(255, 176, 64);

/// The colours of a theme.
struct Palette {
    accent: Color32,
    on_accent: Color32,
    backdrop: Color32,
    error: Color32,
    warning: Color32,
    good: Color32,
    keyword: Color32,
    text: Color32,
    strong: Color32,
    quiet: Color32,
    chosen: Color32,
    on_chosen: Color32,
    // Surfaces.
    well: Color32,
    panel: Color32,
    stripe: Color32,
    button: Color32,
    hovered: Color32,
    edge: Color32,
    outline: Color32,
}

const DARK: Palette = Palette {
    accent: ACCENT,
    on_accent: Color32::from_rgb(30, 22, 10),
    backdrop: Color32::from_rgb(24, 25, 28),
    error: Color32::from_rgb(255, 110, 100),
    warning: Color32::from_rgb(255, 200, 90),
    good: Color32::from_rgb(120, 210, 140),
    keyword: Color32::from_rgb(140, 190, 250),
    text: Color32::from_gray(205),
    strong: Color32::from_gray(230),
    quiet: Color32::from_gray(140),
    chosen: Color32::from_rgb(104, 74, 28),
    on_chosen: Color32::from_rgb(255, 220, 170),
    well: Color32::from_rgb(20, 21, 23),
    panel: Color32::from_rgb(36, 37, 41),
    stripe: Color32::from_rgb(41, 42, 47),
    button: Color32::from_rgb(55, 57, 63),
    hovered: Color32::from_rgb(70, 73, 80),
    edge: Color32::from_rgb(20, 20, 22),
    outline: Color32::from_gray(110),
};

const LIGHT: Palette = Palette {
    accent: Color32::from_rgb(150, 78, 0),
    on_accent: Color32::WHITE,
    backdrop: Color32::from_rgb(196, 197, 200),
    error: Color32::from_rgb(190, 30, 20),
    warning: Color32::from_rgb(150, 95, 0),
    good: Color32::from_rgb(20, 115, 45),
    keyword: Color32::from_rgb(25, 80, 165),
    text: Color32::from_gray(45),
    strong: Color32::from_gray(15),
    quiet: Color32::from_gray(105),
    chosen: Color32::from_rgb(255, 214, 150),
    on_chosen: Color32::from_rgb(60, 32, 0),
    well: Color32::WHITE,
    panel: Color32::from_rgb(241, 241, 243),
    stripe: Color32::from_rgb(232, 232, 235),
    button: Color32::from_rgb(220, 221, 225),
    hovered: Color32::from_rgb(205, 207, 213),
    edge: Color32::from_rgb(196, 197, 202),
    outline: Color32::from_gray(140),
};

fn palette(ui: &Ui) -> &'static Palette {
    if ui.visuals().dark_mode { &DARK } else { &LIGHT }
}

/// What is chosen, and the button one is looking for.
pub fn accent(ui: &Ui) -> Color32 {
    palette(ui).accent
}

/// Text on the accent colour.
pub fn on_accent(ui: &Ui) -> Color32 {
    palette(ui).on_accent
}

/// Around the picture.
pub fn backdrop(ui: &Ui) -> Color32 {
    palette(ui).backdrop
}

/// Mistakes.
pub fn error(ui: &Ui) -> Color32 {
    palette(ui).error
}

/// Warnings.
pub fn warning(ui: &Ui) -> Color32 {
    palette(ui).warning
}

/// What went well, and comments.
pub fn good(ui: &Ui) -> Color32 {
    palette(ui).good
}

/// Words that begin a block.
pub fn keyword(ui: &Ui) -> Color32 {
    palette(ui).keyword
}

/// Text that may be overlooked.
pub fn quiet(ui: &Ui) -> Color32 {
    palette(ui).quiet
}

/// A bright colour as it can be read on a panel.
pub fn legible(ui: &Ui, color: Color32) -> Color32 {
    let [r, g, b, _] = color.to_array();
    let darker = |c: u8| (f32::from(c) * 0.55) as u8;
    if ui.visuals().dark_mode { color } else { Color32::from_rgb(darker(r), darker(g), darker(b)) }
}

/// Makes the whole window look so.
pub fn apply(ctx: &egui::Context, theme: Theme) {
    ctx.set_theme(theme);
    for (theme, palette) in [(Theme::Dark, &DARK), (Theme::Light, &LIGHT)] {
        ctx.style_mut_of(theme, |style| {
            style.visuals = visuals(theme, palette);
            style.text_styles = [
                (TextStyle::Small, FontId::new(11.0, FontFamily::Proportional)),
                (TextStyle::Body, FontId::new(13.5, FontFamily::Proportional)),
                (TextStyle::Button, FontId::new(13.5, FontFamily::Proportional)),
                (TextStyle::Heading, FontId::new(17.0, FontFamily::Proportional)),
                (TextStyle::Monospace, FontId::new(12.5, FontFamily::Monospace)),
            ]
            .into();
            style.spacing.item_spacing = vec2(7.0, 5.0);
            style.spacing.button_padding = vec2(8.0, 3.0);
            style.spacing.interact_size = vec2(38.0, 21.0);
            style.spacing.slider_width = 110.0;
            style.spacing.combo_width = 90.0;
            style.spacing.indent = 14.0;
            style.interaction.tooltip_delay = 0.4;
            style.animation_time = 0.08;
        });
    }
}

fn visuals(theme: Theme, palette: &Palette) -> Visuals {
    let mut visuals = theme.default_visuals();
    visuals.panel_fill = palette.panel;
    visuals.window_fill = palette.panel;
    visuals.window_stroke = Stroke::new(1.0, palette.outline);
    visuals.extreme_bg_color = palette.well;
    visuals.faint_bg_color = palette.stripe;
    visuals.selection.bg_fill = palette.chosen;
    visuals.selection.stroke = Stroke::new(1.0, palette.on_chosen);
    visuals.hyperlink_color = palette.accent;
    visuals.warn_fg_color = palette.warning;
    visuals.error_fg_color = palette.error;
    visuals.slider_trailing_fill = true;
    let widgets = &mut visuals.widgets;
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, palette.edge);
    widgets.noninteractive.fg_stroke = Stroke::new(1.0, palette.text);
    for (state, fill) in [
        (&mut widgets.inactive, palette.button),
        (&mut widgets.hovered, palette.hovered),
        (&mut widgets.active, palette.button),
        (&mut widgets.open, palette.hovered),
    ] {
        state.bg_fill = fill;
        state.weak_bg_fill = fill;
        state.corner_radius = CornerRadius::same(4);
        state.fg_stroke = Stroke::new(1.0, palette.strong);
    }
    widgets.hovered.bg_stroke = Stroke::new(1.0, palette.outline);
    widgets.active.bg_stroke = Stroke::new(1.0, palette.accent);
    visuals
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The ratio of luminances that WCAG 2.2 calls contrast.
    fn contrast(a: Color32, b: Color32) -> f32 {
        let luminance = |color: Color32| {
            let [r, g, b, _] = egui::Rgba::from(color).to_array();
            0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05
        };
        let [a, b] = [luminance(a), luminance(b)];
        (a / b).max(b / a)
    }

    #[test]
    fn text_can_be_read_in_both_themes() {
        for palette in [&DARK, &LIGHT] {
            let colors =
                [palette.error, palette.warning, palette.good, palette.keyword, palette.text, palette.accent];
            for color in colors {
                assert!(contrast(color, palette.panel) > 4.5, "{color:?} {}", contrast(color, palette.panel));
                assert!(contrast(color, palette.well) > 4.5, "{color:?}");
            }
            assert!(
                contrast(palette.quiet, palette.panel) > 4.0,
                "{}",
                contrast(palette.quiet, palette.panel)
            );
            assert!(contrast(palette.on_accent, palette.accent) > 4.5);
            assert!(contrast(palette.on_chosen, palette.chosen) > 4.5);
            assert!(contrast(palette.strong, palette.hovered) > 4.5);
        }
    }
}
