//! Colours and sizes of the window: dark and neutral, so that they do not tint how a picture is seen, with one warm
//! colour for what is chosen.

use egui::{Color32, CornerRadius, FontFamily, FontId, Stroke, TextStyle, Visuals, vec2};

/// What is chosen, and the button one is looking for.
pub const ACCENT: Color32 = Color32::from_rgb(255, 176, 64);
/// Text on the accent colour.
pub const ON_ACCENT: Color32 = Color32::from_rgb(30, 22, 10);
/// Behind the scene, and around it.
pub const BACKDROP: Color32 = Color32::from_rgb(24, 25, 28);
/// Mistakes.
pub const ERROR: Color32 = Color32::from_rgb(255, 110, 100);
/// Warnings.
pub const WARNING: Color32 = Color32::from_rgb(255, 200, 90);
/// What went well.
pub const GOOD: Color32 = Color32::from_rgb(120, 210, 140);
/// Text that may be overlooked.
pub const QUIET: Color32 = Color32::from_gray(140);

/// The shades of grey, darkest first: wells, panels, buttons, buttons under the pointer.
const WELL: Color32 = Color32::from_rgb(20, 21, 23);
const PANEL: Color32 = Color32::from_rgb(36, 37, 41);
const BUTTON: Color32 = Color32::from_rgb(55, 57, 63);
const HOVERED: Color32 = Color32::from_rgb(70, 73, 80);
const EDGE: Color32 = Color32::from_rgb(20, 20, 22);

/// Makes the whole window look so.
pub fn apply(ctx: &egui::Context) {
    ctx.set_theme(egui::Theme::Dark);
    ctx.style_mut_of(egui::Theme::Dark, |style| {
        style.visuals = visuals();
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

fn visuals() -> Visuals {
    let mut visuals = Visuals::dark();
    visuals.panel_fill = PANEL;
    visuals.window_fill = PANEL;
    visuals.window_stroke = Stroke::new(1.0, Color32::from_gray(70));
    visuals.extreme_bg_color = WELL;
    visuals.faint_bg_color = Color32::from_rgb(41, 42, 47);
    visuals.selection.bg_fill = Color32::from_rgb(104, 74, 28);
    visuals.selection.stroke = Stroke::new(1.0, Color32::from_rgb(255, 220, 170));
    visuals.hyperlink_color = ACCENT;
    visuals.warn_fg_color = WARNING;
    visuals.error_fg_color = ERROR;
    visuals.slider_trailing_fill = true;
    let widgets = &mut visuals.widgets;
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, EDGE);
    widgets.noninteractive.fg_stroke = Stroke::new(1.0, Color32::from_gray(200));
    for (state, fill) in [
        (&mut widgets.inactive, BUTTON),
        (&mut widgets.hovered, HOVERED),
        (&mut widgets.active, BUTTON),
        (&mut widgets.open, HOVERED),
    ] {
        state.bg_fill = fill;
        state.weak_bg_fill = fill;
        state.corner_radius = CornerRadius::same(4);
    }
    widgets.inactive.fg_stroke = Stroke::new(1.0, Color32::from_gray(225));
    widgets.hovered.bg_stroke = Stroke::new(1.0, Color32::from_gray(110));
    widgets.active.bg_stroke = Stroke::new(1.0, ACCENT);
    visuals
}
