//! The segments of the debug ray as a table.

use egui::{Align2, Color32, DragValue, FontId, RichText, ScrollArea, Sense, Stroke, Ui, pos2, vec2};
use kajo::probe::{ConservedQuantity, Segment};

use super::theme;
use crate::state::{Action, Rays, Studio, ray_color, ray_kind, ray_legend};

const ROW: f32 = 18.0;

/// Names and widths of the columns, in points.
const COLUMNS: [(&str, f32); 10] = [
    ("Ray", 130.0),
    ("Hit", 210.0),
    ("Material", 110.0),
    ("t", 70.0),
    ("Point", 170.0),
    ("Normal", 150.0),
    ("Index", 50.0),
    ("Weight", 150.0),
    ("Contribution", 150.0),
    ("Conserved", 520.0),
];

/// The whole panel; what it asks for goes into `actions`.
pub fn show(ui: &mut Ui, studio: &Studio, actions: &mut Vec<Action>) {
    let Some(rays) = &studio.rays else {
        ui.label(
            RichText::new("Point at the picture and press E to shoot a debug ray.").color(theme::quiet(ui)),
        );
        return;
    };
    if rays.is_awaited {
        preparation(ui, studio, actions);
    }
    summary(ui, rays, actions);
    legend(ui, rays);
    let mut hovered = None;
    let width: f32 = COLUMNS.iter().map(|(_, width)| width).sum();
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        let (head, _) = ui.allocate_exact_size(vec2(width, ROW), Sense::hover());
        for (x, (name, width)) in columns(head.left()) {
            cell(ui, pos2(x, head.center().y), name, width, theme::quiet(ui));
        }
        let clip = ui.clip_rect();
        for (index, segment) in rays.ray.segments.iter().enumerate() {
            let (row, response) = ui.allocate_exact_size(vec2(width, ROW), Sense::click());
            if !row.intersects(clip) {
                continue;
            }
            let label = format!("Segment {index} {}", ray_kind(segment.kind));
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Row, true, &label));
            let is_chosen = rays.chosen == Some(index);
            if response.hovered() {
                hovered = Some(index);
            }
            if is_chosen {
                ui.painter().rect_filled(row, 2.0, ui.visuals().selection.bg_fill);
            } else if response.hovered() {
                ui.painter().rect_filled(row, 2.0, ui.visuals().faint_bg_color);
            }
            let [r, g, b] = ray_color(segment);
            let texts = cells(studio, segment);
            for (i, ((x, (_, width)), text)) in columns(row.left()).zip(&texts).enumerate() {
                let color = if i == 0 {
                    theme::legible(ui, Color32::from_rgb(r, g, b))
                } else {
                    ui.visuals().text_color()
                };
                let indent = if i == 0 { 9.0 * segment.depth.min(8) as f32 } else { 0.0 };
                cell(ui, pos2(x + indent, row.center().y), text, width - indent, color);
            }
            if response.clicked() {
                actions.push(Action::ChooseSegment((!is_chosen).then_some(index)));
            }
        }
    });
    if rays.hovered != hovered {
        actions.push(Action::HoverSegment(hovered));
    }
}

/// How far the integrator is with what it prepares, which may take as long as at the beginning of a trace.
fn preparation(ui: &mut Ui, studio: &Studio, actions: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        ui.spinner();
        let text = match studio.rays_progress() {
            None | Some([_, 0]) => "The integrator prepares".to_owned(),
            Some([done, tasks]) => format!("The integrator prepares: {done} of {tasks} tasks"),
        };
        // Before the text, whose length changes: it stays under the pointer.
        if ui.small_button("Stop").clicked() {
            actions.push(Action::ClearDebugRay);
        }
        ui.label(text);
    });
}

/// What the colours of the rays stand for.
fn legend(ui: &mut Ui, rays: &Rays) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 5.0;
        for ([r, g, b], text) in ray_legend(&rays.ray.segments) {
            let (line, _) = ui.allocate_exact_size(vec2(16.0, ROW), Sense::hover());
            let color = theme::legible(ui, Color32::from_rgb(r, g, b));
            ui.painter().hline(line.x_range(), line.center().y, Stroke::new(3.0, color));
            ui.label(RichText::new(text).small());
            ui.add_space(8.0);
        }
    });
}

fn summary(ui: &mut Ui, rays: &Rays, actions: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        let [r, g, b] = rays.ray.radiance;
        let n = rays.ray.segments.len();
        ui.label(format!("{n} segments, radiance {r:.4} {g:.4} {b:.4}"));
        if rays.ray.left_out > 0 {
            ui.label(format!("and {} more", rays.ray.left_out));
        }
        if rays.samples > 1 {
            let mut number = rays.sample + 1;
            ui.separator();
            ui.label("Sample");
            let drag = DragValue::new(&mut number).range(1..=rays.samples).speed(0.1);
            let hint = "Which of the pixel's samples is followed";
            if ui.add(drag).on_hover_text(hint).changed() {
                actions.push(Action::DebugSample(number - 1));
            }
            ui.label(format!("of {}", rays.samples));
        }
        if ui.small_button("Clear").clicked() {
            actions.push(Action::ClearDebugRay);
        }
    });
}

fn columns(left: f32) -> impl Iterator<Item = (f32, (&'static str, f32))> {
    COLUMNS.into_iter().scan(left, |x, column| {
        let at = *x;
        *x += column.1;
        Some((at, column))
    })
}

fn cell(ui: &Ui, at: egui::Pos2, text: &str, width: f32, color: Color32) {
    let rect = egui::Rect::from_min_size(pos2(at.x, at.y - ROW), vec2(width - 6.0, 2.0 * ROW));
    let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
    painter.text(at + vec2(4.0, 0.0), Align2::LEFT_CENTER, text, FontId::monospace(11.5), color);
}

/// What was to stay the same along a curve, and by how much of itself it did not.
fn conserved(segment: &Segment) -> String {
    let quantities = segment.conserved.iter().flatten();
    let one = |quantity: &ConservedQuantity| {
        let ConservedQuantity { name, start, end } = *quantity;
        let off = (end - start).abs() / start.abs().max(f64::MIN_POSITIVE);
        format!("{name} {end:.6} (off by {off:.0e})")
    };
    quantities.map(one).collect::<Vec<_>>().join(", ")
}

fn cells(studio: &Studio, segment: &Segment) -> [String; 10] {
    let triple = |[x, y, z]: [f32; 3]| format!("{x:.3} {y:.3} {z:.3}");
    let (object, material) = studio.names_of(segment);
    let hit = segment.hit;
    [
        ray_kind(segment.kind).to_owned(),
        object,
        material,
        if segment.distance.is_finite() { format!("{:.4}", segment.distance) } else { "-".to_owned() },
        hit.map_or_else(|| "-".to_owned(), |hit| triple(hit.p.to_array())),
        hit.map_or_else(|| "-".to_owned(), |hit| triple(hit.n.to_array())),
        format!("{:.3}", segment.eta),
        triple(segment.weight),
        triple(segment.contribution),
        conserved(segment),
    ]
}
