//! The tree of the scene: every block of its text, groups to fold.

use std::collections::HashSet;

use egui::{Align2, FontId, Key, RichText, ScrollArea, Sense, TextEdit, Ui, pos2, vec2};
use kajo_edit::{Document, Kind, Node, NodeId, keywords_of};

use super::theme;
use crate::state::{Action, Selection};

/// Height of a row, in points.
const ROW: f32 = 20.0;
/// Width of a step inwards.
const STEP: f32 = 14.0;

/// What is folded, searched for and renamed.
#[derive(Default)]
pub struct Outliner {
    folded: HashSet<NodeId>,
    search: String,
    /// The node that gets a name, and the name so far.
    renamed: Option<(NodeId, String)>,
    /// What was selected when the list was last scrolled to it.
    scrolled_to: Option<NodeId>,
    /// How far down the list is scrolled, in points.
    offset: f32,
}

impl Outliner {
    /// The whole panel; what it asks for goes into `actions`.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        document: &Document,
        selection: &Selection,
        actions: &mut Vec<Action>,
    ) {
        ui.add_space(4.0);
        ui.horizontal(|ui| {
            add_menu(ui, actions);
            let search =
                TextEdit::singleline(&mut self.search).hint_text("Search").desired_width(f32::INFINITY);
            ui.add(search).accessible_name("Search the scene");
        });
        ui.separator();
        let rows = self.rows(document);
        if rows.is_empty() {
            ui.label(RichText::new("Nothing found.").color(theme::quiet(ui)));
        }
        let target = selection.main().filter(|main| self.scrolled_to != Some(*main));
        self.scrolled_to = selection.main();
        let spacing = std::mem::take(&mut ui.spacing_mut().item_spacing.y);
        let mut area = ScrollArea::vertical().auto_shrink(false);
        if let Some(at) = target.and_then(|target| rows.iter().position(|node| node.id == target)) {
            let height = ui.available_height();
            let top = at as f32 * ROW;
            if top < self.offset || top + ROW > self.offset + height {
                area = area.vertical_scroll_offset((top - 0.5 * height).max(0.0));
            }
        }
        let shown = area.show_rows(ui, ROW, rows.len(), |ui, range| {
            for node in &rows[range] {
                self.row(ui, document, node, selection, actions);
            }
        });
        self.offset = shown.state.clamped_offset().y;
        ui.spacing_mut().item_spacing.y = spacing;
    }

    /// The nodes that are to be seen, in the order of the text.
    fn rows<'a>(&self, document: &'a Document) -> Vec<&'a Node> {
        let nodes = document.outline().nodes();
        let wanted = self.search.trim().to_lowercase();
        if !wanted.is_empty() {
            let fits = |node: &&Node| {
                let name = node.name.as_deref().unwrap_or_default();
                node.keyword.to_lowercase().contains(&wanted) || name.to_lowercase().contains(&wanted)
            };
            return nodes.iter().filter(fits).collect();
        }
        let mut rows = Vec::new();
        let mut folded_depth = u32::MAX;
        for node in nodes {
            if node.depth > folded_depth {
                continue;
            }
            folded_depth = if self.folded.contains(&node.id) { node.depth } else { u32::MAX };
            rows.push(node);
        }
        rows
    }

    fn row(
        &mut self,
        ui: &mut Ui,
        document: &Document,
        node: &Node,
        selection: &Selection,
        actions: &mut Vec<Action>,
    ) {
        let (rect, response) =
            ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click_and_drag());
        let label = format!("{} {}", node.keyword, node.name.as_deref().unwrap_or_default());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TreeItem, true, label.trim()));
        let chosen = selection.has(node.id);
        if chosen {
            ui.painter().rect_filled(rect, 3.0, ui.visuals().selection.bg_fill);
        } else if response.hovered() {
            ui.painter().rect_filled(rect, 3.0, ui.visuals().faint_bg_color);
        }
        let x =
            rect.left() + 4.0 + STEP * if self.search.trim().is_empty() { node.depth as f32 } else { 0.0 };
        let is_parent = document.outline().children(Some(node.id)).next().is_some();
        if is_parent {
            self.fold_mark(ui, node.id, pos2(x + 5.0, rect.center().y));
        }
        if self.renamed.as_ref().is_some_and(|(id, _)| *id == node.id) {
            let field = egui::Rect::from_min_max(pos2(x + 14.0, rect.top()), rect.max);
            self.rename_field(ui, field, actions);
            return;
        }
        let color = match chosen {
            true => ui.visuals().selection.stroke.color,
            false => theme::legible(ui, color_of(node.kind)),
        };
        let text = |x: f32, text: &str, color| {
            ui.painter().text(
                pos2(x, rect.center().y),
                Align2::LEFT_CENTER,
                text,
                FontId::proportional(13.0),
                color,
            )
        };
        let end = text(x + 14.0, &node.keyword, color);
        if let Some(name) = &node.name {
            text(
                end.right() + 7.0,
                name,
                if chosen { ui.visuals().selection.stroke.color } else { ui.visuals().text_color() },
            );
        }
        self.row_input(ui, node, &response, actions);
        drag(ui, node, &response, actions);
    }

    fn fold_mark(&mut self, ui: &Ui, id: NodeId, at: egui::Pos2) {
        let area = egui::Rect::from_center_size(at, vec2(STEP, ROW));
        let mark = ui.interact(area, ui.scope_id().with(("fold", id)), Sense::click());
        let is_folded = self.folded.contains(&id);
        let r = 3.5;
        let corners = match is_folded {
            true => [vec2(-r * 0.6, -r), vec2(r, 0.0), vec2(-r * 0.6, r)],
            false => [vec2(-r, -r * 0.6), vec2(r, -r * 0.6), vec2(0.0, r)],
        };
        let triangle = corners.map(|corner| at + corner).to_vec();
        ui.painter().add(egui::Shape::convex_polygon(triangle, theme::quiet(ui), egui::Stroke::NONE));
        if mark.clicked() && !self.folded.remove(&id) {
            self.folded.insert(id);
        }
    }

    fn row_input(&mut self, ui: &Ui, node: &Node, response: &egui::Response, actions: &mut Vec<Action>) {
        let several = ui.input(|input| input.modifiers.command || input.modifiers.shift);
        if response.clicked() {
            actions.push(if several { Action::SelectToo(node.id) } else { Action::Select(vec![node.id]) });
        }
        if response.double_clicked() {
            self.renamed = Some((node.id, node.name.as_deref().unwrap_or_default().to_owned()));
        }
        if response.secondary_clicked() {
            actions.push(Action::Select(vec![node.id]));
        }
        response.context_menu(|ui| {
            let mut item = |ui: &mut Ui, text: &str, action: Action| {
                if ui.button(text).clicked() {
                    actions.push(action);
                }
            };
            item(ui, "Frame", Action::Frame);
            item(ui, "Duplicate", Action::Duplicate);
            item(ui, "Delete", Action::Delete);
            if ui.button("Rename").clicked() {
                self.renamed = Some((node.id, node.name.as_deref().unwrap_or_default().to_owned()));
            }
        });
    }

    fn rename_field(&mut self, ui: &mut Ui, rect: egui::Rect, actions: &mut Vec<Action>) {
        let Some((id, mut name)) = self.renamed.take() else { return };
        let response = ui.put(rect, TextEdit::singleline(&mut name)).accessible_name("Name");
        if ui.input(|input| input.key_pressed(Key::Escape)) {
            return;
        }
        if response.lost_focus() {
            let name = name.trim().to_owned();
            actions.push(Action::Rename(id, (!name.is_empty()).then_some(name)));
            return;
        }
        response.request_focus();
        self.renamed = Some((id, name));
    }
}

/// Objects can be dragged into groups.
fn drag(ui: &Ui, node: &Node, response: &egui::Response, actions: &mut Vec<Action>) {
    if node.kind.is_object() {
        response.dnd_set_drag_payload(node.id);
    }
    if !node.kind.holds_objects() {
        return;
    }
    if response.dnd_hover_payload::<NodeId>().is_some_and(|id| *id != node.id) {
        ui.painter().rect_stroke(
            response.rect,
            3.0,
            egui::Stroke::new(1.0, theme::accent(ui)),
            egui::StrokeKind::Inside,
        );
    }
    if let Some(id) = response.dnd_release_payload::<NodeId>().filter(|id| **id != node.id) {
        actions.push(Action::MoveInto(*id, node.id));
    }
}

fn add_menu(ui: &mut Ui, actions: &mut Vec<Action>) {
    ui.menu_button("+ Add", |ui| {
        for (name, kind) in [("Shape", Kind::Shape), ("Light", Kind::Light), ("Material", Kind::Material)] {
            ui.menu_button(name, |ui| {
                for keyword in keywords_of(kind).filter(|keyword| has_pattern(keyword)) {
                    if ui.button(keyword).clicked() {
                        actions.push(Action::Add(keyword));
                    }
                }
            });
        }
        ui.separator();
        for keyword in keywords_of(Kind::Group).chain(["Transform"]) {
            if ui.button(keyword).clicked() {
                actions.push(Action::Add(keyword));
            }
        }
    });
}

fn has_pattern(keyword: &str) -> bool {
    kajo_edit::template(keyword, [0.0; 3], 1.0).is_some()
}

fn color_of(kind: Kind) -> egui::Color32 {
    match kind {
        Kind::Light | Kind::Lights => egui::Color32::from_rgb(240, 210, 120),
        Kind::Material | Kind::Materials => egui::Color32::from_rgb(150, 205, 150),
        Kind::Camera => egui::Color32::from_rgb(150, 190, 240),
        Kind::Group | Kind::Transform | Kind::Define | Kind::Instance => {
            egui::Color32::from_rgb(200, 175, 235)
        }
        _ => egui::Color32::from_gray(185),
    }
}
