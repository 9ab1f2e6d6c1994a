//! Small pictures of textures in the panel of the selection.

use std::sync::Arc;

use egui::{
    ColorImage, Image, Response, RichText, Sense, Stroke, StrokeKind, TextureHandle, TextureOptions, Ui, vec2,
};
use kajo_edit::{SWATCH_SIZE, Swatch};

use super::theme;

/// The side of one in a row of a field, in points of the window.
const SMALL: f32 = 18.0;

/// The side of one that stands alone.
const LARGE: f32 = SWATCH_SIZE as f32;

/// A picture of what is selected, with how large it is beside it.
///
/// * `name`: what it is a picture of
pub fn large(ui: &mut Ui, swatch: &Arc<Swatch>, name: &str) {
    ui.horizontal(|ui| {
        paint(ui, swatch, LARGE, name);
        ui.label(RichText::new(caption(swatch)).small().color(theme::quiet(ui)));
    });
    ui.add_space(6.0);
}

/// A picture within a row, which grows under the pointer.
///
/// * `name`: what it is a picture of
pub fn small(ui: &mut Ui, swatch: &Arc<Swatch>, name: &str) {
    paint(ui, swatch, SMALL, name).on_hover_ui(|ui| {
        paint(ui, swatch, LARGE, name);
        ui.label(RichText::new(caption(swatch)).small());
    });
}

fn paint(ui: &mut Ui, swatch: &Arc<Swatch>, side: f32, name: &str) -> Response {
    let (rect, response) = ui.allocate_exact_size(vec2(side, side), Sense::hover());
    let texture = texture(ui, swatch, name);
    Image::new((texture.id(), rect.size())).corner_radius(2.0).paint_at(ui, rect);
    let edge = Stroke::new(1.0, ui.visuals().widgets.noninteractive.bg_stroke.color);
    ui.painter().rect_stroke(rect, 2.0, edge, StrokeKind::Outside);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, format!("Swatch of {name}")));
    response
}

/// The picture on the card; made once for each swatch.
fn texture(ui: &Ui, swatch: &Arc<Swatch>, name: &str) -> TextureHandle {
    type Known = (Arc<Swatch>, TextureHandle);
    let id = egui::Id::unique(("swatch", name));
    let known = ui.data(|data| data.get_temp::<Known>(id)).filter(|(of, _)| Arc::ptr_eq(of, swatch));
    if let Some((_, texture)) = known {
        return texture;
    }
    let image = ColorImage::from_rgba_unmultiplied([SWATCH_SIZE as usize; 2], &swatch.rgba);
    let texture = ui.load_texture(format!("swatch of {name}"), image, TextureOptions::LINEAR);
    ui.data_mut(|data| data.insert_temp(id, (Arc::clone(swatch), texture.clone())));
    texture
}

fn caption(swatch: &Swatch) -> String {
    match swatch.width {
        Some(width) => format!("width {width}"),
        None => "u and v from 0 to 1".to_owned(),
    }
}
