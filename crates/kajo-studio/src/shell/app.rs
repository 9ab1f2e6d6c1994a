//! The whole window, frame by frame.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::{
    CentralPanel, Color32, Frame, Margin, Panel, Rect, RichText, ScrollArea, Ui, UiBuilder, UiKind,
    UiStackInfo,
};
use egui_wgpu::RenderState;
use kajo::session;
use serde::{Deserialize, Serialize};

use super::chooser::{Chooser, ChooserAnswer, Purpose};
use super::keys::{self, Command};
use super::outliner::Outliner;
use super::picture;
use super::questions::Questions;
use super::stage::Stage;
use super::strip::{self, Strip};
use super::text_panel::TextPanel;
use super::viewport::{self, Area};
use super::{
    help, menu, object_panel, picture_panel, problems_panel, rays_panel, render_panel, status, theme,
    time_panel,
};
use crate::state::{Action, Answer, Apart, Compare, Habits, Histogram, Question, Shown, Studio, Wake};

/// The longest step of a flight, in seconds: after a pause the camera does not jump.
const LONGEST_STEP: f32 = 0.1;

/// What the window remembers from one start to the next, beyond the sizes of its panels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Layout {
    /// Whether there are panels around the viewport.
    pub panels: bool,
    /// Whether its colours are light.
    pub light: bool,
    /// The tab on the right.
    pub tab: Tab,
    /// The tab at the bottom, if there is one open.
    pub bottom: Option<Bottom>,
    /// Whether there is a time line; where nobody has said it, there is one for scenes that change with time.
    pub time_line: Option<bool>,
    /// The scenes opened last, newest first.
    pub recent: Vec<PathBuf>,
    /// How the user traces.
    pub habits: Habits,
}

impl Default for Layout {
    fn default() -> Layout {
        Layout {
            panels: true,
            light: false,
            tab: Tab::Object,
            bottom: None,
            time_line: None,
            recent: Vec::new(),
            habits: Habits::default(),
        }
    }
}

/// The tabs of the panel on the right.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Tab {
    /// The fields of what is selected.
    Object,
    /// What is asked of a trace.
    Render,
    /// The picture on show.
    Picture,
}

/// The tabs of the panel at the bottom.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Bottom {
    /// Mistakes in the scene.
    Problems,
    /// The text of the scene.
    Text,
    /// The segments of the debug ray.
    Rays,
}

/// The window.
pub struct App {
    /// What it is about.
    pub studio: Studio,
    /// How it is arranged.
    pub layout: Layout,
    stage: Option<Stage>,
    outliner: Outliner,
    text: TextPanel,
    strip: Strip,
    /// Whether the wipe is being dragged.
    is_wiping: bool,
    histogram: Option<(Arc<session::Frame>, Histogram)>,
    chooser: Option<Chooser>,
    questions: Questions,
    help: bool,
    /// Where the picture was in the last frame.
    area: Option<Area>,
    /// Where the pointer was when the last debug ray was shot.
    shot_at: Option<egui::Pos2>,
    /// What the window is called.
    title: String,
}

/// The way in points that a pointer goes before a key that is held down shoots again.
const STILL: f32 = 3.0;

/// Windows of less width have narrow panels, in points.
const SMALL: f32 = 900.0;

/// Pixels that the histogram looks at, at most about.
const HISTOGRAM_PIXELS: usize = 100_000;

impl App {
    /// An empty window.
    ///
    /// * `card`: what draws the window, for the preview; there is none in some tests
    pub fn new(ctx: &egui::Context, card: Option<&RenderState>, layout: Layout) -> App {
        theme::apply(ctx, theme_of(&layout));
        let waker = ctx.clone();
        let wake: Wake = Arc::new(move || waker.request_repaint());
        let mut studio = Studio::new(wake);
        studio.options.habits = layout.habits.clone();
        App {
            studio,
            layout,
            stage: card.map(Stage::new),
            outliner: Outliner::default(),
            text: TextPanel::default(),
            strip: Strip::default(),
            is_wiping: false,
            histogram: None,
            chooser: None,
            questions: Questions::default(),
            help: false,
            area: None,
            shot_at: None,
            title: String::new(),
        }
    }

    /// One frame.
    pub fn ui(&mut self, ui: &mut Ui) {
        let ctx = ui.ctx().clone();
        self.studio.update();
        self.studio.time_line.is_shown = self.has_time_line();
        let chosen = self.studio.selection.main();
        self.take_dropped_files(&ctx);
        self.close(&ctx);
        let mut commands = if self.has_dialog() { Vec::new() } else { keys::pressed(&ctx) };
        let mut actions = Vec::new();
        self.fly(&ctx, &mut actions);
        self.on_ground(ui, |app, ui| {
            app.panels(ui, &mut commands, &mut actions);
            let apart = app.studio.apart();
            app.strip(ui, &mut actions);
            app.viewport(ui, apart.as_ref(), &mut actions);
        });
        self.ask(&ctx, &mut actions);
        self.put_question(&ctx, &mut actions);
        help::show(&ctx, &mut self.help);
        self.shoot_while_held(&ctx, &mut actions);
        for command in commands {
            self.obey(&ctx, command, &mut actions);
        }
        for action in actions {
            self.studio.apply(action);
            ctx.request_repaint();
        }
        if self.studio.selection.main().is_some_and(|node| Some(node) != chosen) {
            self.layout.tab = Tab::Object;
        }
        if !ctx.input(|input| input.pointer.any_down()) {
            self.studio.apply(Action::EndDrag);
        }
        self.remember();
        self.name_window(&ctx);
        self.layout.habits = self.studio.options.habits.clone();
    }

    /// Whether there is a time line.
    pub fn has_time_line(&self) -> bool {
        let is_wanted = self.layout.time_line.unwrap_or_else(|| self.studio.time_line.has_time());
        is_wanted && self.studio.document.is_some()
    }

    /// Where the picture was in the last frame.
    pub fn area(&self) -> Option<Area> {
        self.area
    }

    /// Names the window after its scene, with a star while there are edits that are not saved.
    fn name_window(&mut self, ctx: &egui::Context) {
        let title = match &self.studio.document {
            None => "kajo studio".to_owned(),
            Some(_) => {
                let star = if self.studio.has_unsaved_edits() { "*" } else { "" };
                format!("{star}{} - kajo studio", self.studio.title())
            }
        };
        if self.title != title {
            ctx.send_viewport_cmd(egui::ViewportCommand::Title(title.clone()));
            self.title = title;
        }
    }

    /// What the window is called.
    pub fn title(&self) -> &str {
        &self.title
    }

    fn take_dropped_files(&mut self, ctx: &egui::Context) {
        let dropped = ctx.input(|input| input.raw.dropped_files.clone());
        if let Some(path) = dropped.first().map(|file| file.path().to_owned()) {
            self.studio.apply(Action::Open(path));
        }
    }

    /// Whether something is asked, so that keys mean nothing else.
    fn has_dialog(&self) -> bool {
        self.chooser.is_some() || self.studio.question().is_some()
    }

    /// Ends the program when that is wanted and nothing is lost by it.
    fn close(&mut self, ctx: &egui::Context) {
        let is_asked_to = ctx.input(|input| input.viewport().close_requested());
        if is_asked_to && !self.studio.is_closing() {
            self.studio.apply(Action::Close);
            if !self.studio.is_closing() {
                ctx.send_viewport_cmd(egui::ViewportCommand::CancelClose);
            }
        } else if self.studio.is_closing() && !is_asked_to {
            ctx.send_viewport_cmd(egui::ViewportCommand::Close);
        }
    }

    /// Shows the question that stands, below that for a file.
    fn put_question(&mut self, ctx: &egui::Context, actions: &mut Vec<Action>) {
        if self.chooser.is_some() {
            return;
        }
        let (title, question) = (self.studio.title(), self.studio.question());
        let notice = self.studio.notice.as_ref().filter(|notice| notice.is_error);
        let problem = notice.map(|notice| notice.text.as_str());
        let is_unsaved = matches!(question, Some(Question::Unsaved { .. }));
        match self.questions.show(ctx, question, &title, problem) {
            // A scene that never had a file needs a name.
            Some(Answer::Save) if is_unsaved && self.path().is_none() => {
                self.choose(Purpose::SaveScene, "scene.txt");
            }
            Some(answer) => actions.push(Action::Answer(answer)),
            None => {}
        }
    }

    fn fly(&self, ctx: &egui::Context, actions: &mut Vec<Action>) {
        let held = keys::held(ctx);
        if held.moves() && !self.has_dialog() {
            let seconds = ctx.input(|input| input.stable_dt).min(LONGEST_STEP);
            actions.push(Action::Fly(held, seconds.into()));
        }
    }

    /// Shows what stands on the ground of the window. Panels have no colour of their own: the stage paints it, and
    /// widgets that want to know it ask the stack of their parents.
    fn on_ground(&mut self, ui: &mut Ui, show: impl FnOnce(&mut App, &mut Ui)) {
        let (all, color) = (ui.max_rect(), ui.visuals().panel_fill);
        if let Some(stage) = &mut self.stage {
            stage.fill(ui.painter(), all, color);
        }
        let ground = UiStackInfo::new(UiKind::Frame).with_frame(Frame::new().fill(color));
        ui.scope_builder(UiBuilder::new().max_rect(all).ui_stack_info(ground), |ui| show(self, ui));
    }

    fn panels(&mut self, ui: &mut Ui, commands: &mut Vec<Command>, actions: &mut Vec<Action>) {
        let margin = frame_of_panel(ui).inner_margin(Margin::symmetric(10, 5));
        Panel::top("menu")
            .frame(margin)
            .show(ui, |ui| menu::show(ui, &self.studio, &self.layout.recent, commands));
        Panel::bottom("status").frame(margin).show(ui, |ui| status::show(ui, &self.studio));
        if !self.layout.panels {
            return;
        }
        // Of a small window the picture keeps a part.
        let room = ui.ctx().content_rect().size();
        let share = |small, large| if room.x < SMALL { small } else { large };
        self.bottom_panel(ui, room, actions);
        if self.has_time_line() {
            let [height, least] = time_panel::HEIGHTS;
            let panel = Panel::bottom("time")
                .resizable(true)
                .default_size(height.min(0.3 * room.y))
                .size_range(least..=(0.5 * room.y).clamp(least, 500.0));
            panel.frame(frame_of_panel(ui)).show(ui, |ui| time_panel::show(ui, &self.studio, actions));
        }
        if let Some(document) = &self.studio.document {
            let panel = Panel::left("outliner")
                .resizable(true)
                .default_size((0.22 * room.x).min(220.0))
                .size_range(100.0..=(share(0.24, 0.4) * room.x).min(480.0));
            panel.frame(frame_of_panel(ui)).show(ui, |ui| {
                self.outliner.show(ui, document, &self.studio.selection, actions);
            });
        }
        let panel = Panel::right("right")
            .resizable(true)
            .default_size((0.38 * room.x).min(350.0))
            .size_range(150.0..=(share(0.4, 0.5) * room.x).min(560.0));
        panel.frame(frame_of_panel(ui)).show(ui, |ui| self.right_panel(ui, actions));
    }

    fn bottom_panel(&mut self, ui: &mut Ui, room: egui::Vec2, actions: &mut Vec<Action>) {
        let n = self.studio.problems.len();
        let problems = if n == 0 { "Problems".to_owned() } else { format!("Problems ({n})") };
        Panel::bottom("tabs").resizable(false).frame(frame_of_panel(ui)).show(ui, |ui| {
            ui.horizontal(|ui| {
                for (tab, name) in [
                    (Bottom::Problems, problems.as_str()),
                    (Bottom::Text, "Text"),
                    (Bottom::Rays, "Debug ray"),
                ] {
                    let open = self.layout.bottom == Some(tab);
                    let color = if tab == Bottom::Problems && self.studio.n_errors() > 0 {
                        theme::error(ui)
                    } else {
                        ui.visuals().text_color()
                    };
                    if ui.selectable_label(open, RichText::new(name).color(color)).clicked() {
                        self.layout.bottom = (!open).then_some(tab);
                    }
                }
            });
        });
        let Some(tab) = self.layout.bottom else { return };
        let panel = Panel::bottom("bottom")
            .resizable(true)
            .default_size(170.0_f32.min(0.35 * room.y))
            .size_range(50.0..=(0.6 * room.y).min(600.0));
        panel.frame(frame_of_panel(ui)).show(ui, |ui| match tab {
            Bottom::Problems => problems_panel::show(ui, &self.studio.problems),
            Bottom::Rays => rays_panel::show(ui, &self.studio, actions),
            Bottom::Text => {
                let Studio { document, selection, problems, .. } = &self.studio;
                if let Some(document) = document {
                    self.text.show(ui, document, selection, problems, actions);
                }
            }
        });
    }

    fn right_panel(&mut self, ui: &mut Ui, actions: &mut Vec<Action>) {
        ui.add_space(4.0);
        ui.horizontal(|ui| {
            for (tab, name) in [(Tab::Object, "Object"), (Tab::Render, "Render"), (Tab::Picture, "Picture")] {
                ui.selectable_value(&mut self.layout.tab, tab, RichText::new(name).strong());
            }
        });
        ui.separator();
        if self.layout.tab == Tab::Object {
            if self.studio.document.is_some() {
                // In a small window the fields may be wider than the panel.
                ScrollArea::horizontal().id_salt("fields").auto_shrink(false).show(ui, |ui| {
                    object_panel::show(ui, &self.studio, actions);
                });
            }
            return;
        }
        let Some(own) = self.studio.scene().map(|scene| scene.output.settings.clone()) else {
            ui.label(RichText::new("Open a scene to set how it is traced.").color(theme::quiet(ui)));
            return;
        };
        let settings = match self.studio.settings() {
            Some(Ok(settings)) => settings,
            Some(Err(error)) => {
                ui.label(RichText::new(error.to_string()).color(theme::error(ui)));
                return;
            }
            None => return,
        };
        ScrollArea::both().auto_shrink(false).show(ui, |ui| match self.layout.tab {
            Tab::Object => {}
            Tab::Render => {
                render_panel::camera(ui, &self.studio.camera, actions);
                render_panel::show(ui, &mut self.studio.options, &own, &settings);
            }
            Tab::Picture => {
                let frame = self.studio.picture();
                self.count(frame.as_ref());
                let shown = picture_panel::Picture {
                    frame: frame.as_deref(),
                    histogram: self.histogram.as_ref().map(|(_, histogram)| histogram),
                    pixel: self.pixel_under_pointer(ui, frame.as_deref()),
                    view: self.studio.view,
                    settings: &settings,
                };
                picture_panel::show(ui, &shown, &mut self.studio.options.asked, actions);
            }
        });
    }

    /// Keeps the histogram up to date.
    fn count(&mut self, frame: Option<&Arc<session::Frame>>) {
        let Some(frame) = frame else {
            self.histogram = None;
            return;
        };
        if self.histogram.as_ref().is_some_and(|(counted, _)| Arc::ptr_eq(counted, frame)) {
            return;
        }
        let light = frame.light();
        let step = (light.data().len() / 3 / HISTOGRAM_PIXELS).max(1);
        let histogram = Histogram::of(light.pixels().step_by(step));
        self.histogram = Some((Arc::clone(frame), histogram));
    }

    /// The pixel of a traced picture, which may be coarser than the one on show.
    fn pixel_under_pointer(&self, ui: &Ui, frame: Option<&session::Frame>) -> Option<[u32; 2]> {
        let area = Area { size: frame?.size(), ..self.area? };
        area.pixel(ui.input(|input| input.pointer.hover_pos())?)
    }

    /// The pictures traced last, below the one on show.
    fn strip(&mut self, ui: &mut Ui, actions: &mut Vec<Action>) {
        // It is there from the beginning, so that all pictures have one size and can be compared.
        if self.layout.panels && self.studio.document.is_some() {
            let panel = Panel::bottom("strip").resizable(false).frame(frame_of_panel(ui));
            panel.show(ui, |ui| self.strip.show(ui, &self.studio, actions));
        }
    }

    fn viewport(&mut self, ui: &mut Ui, apart: Option<&Apart>, actions: &mut Vec<Action>) {
        CentralPanel::default().frame(Frame::new()).show(ui, |ui| {
            let response = viewport::allocate(ui);
            if let Some(stage) = &mut self.stage {
                stage.fill(ui.painter(), response.rect, theme::backdrop(ui));
            }
            let pixels = response.rect.size() * ui.pixels_per_point();
            self.studio.window = [pixels.x, pixels.y].map(|side| (side.round() as u32).max(1));
            self.studio.fit_camera();
            if self.studio.scene().is_none() {
                self.area = None;
                empty(ui, response.rect, self.studio.is_loading(), !self.studio.problems.is_empty());
                return;
            }
            let size = self.studio.picture_size();
            let area = Area { rect: picture::fitted(response.rect, size, ui.pixels_per_point()), size };
            self.area = Some(area);
            let handles = self.studio.handles();
            let studio = &self.studio;
            match strip::drag_wipe(ui, &response, area.rect, studio, &mut self.is_wiping) {
                Some(action) => actions.push(action),
                None => actions.extend(viewport::mouse(ui, &response, area, studio, &handles)),
            }
            match (&mut self.stage, self.studio.shown) {
                (Some(stage), Shown::Preview) => stage.paint_preview(ui, &self.studio, area),
                (Some(stage), Shown::Traced) => stage.paint_trace(ui, &self.studio, area, apart),
                (None, _) => {}
            }
            viewport::paint_debug_pixel(ui, area, &self.studio);
            if self.studio.shown == Shown::Traced {
                strip::paint_comparison(ui, area.rect, &self.studio, apart);
            }
            viewport::paint_handles(ui, area, &self.studio, &handles);
        });
    }

    fn ask(&mut self, ctx: &egui::Context, actions: &mut Vec<Action>) {
        let Some(chooser) = &mut self.chooser else { return };
        match chooser.show(ctx) {
            ChooserAnswer::None => return,
            ChooserAnswer::Cancelled => {}
            ChooserAnswer::Chosen(path) => match chooser.purpose {
                Purpose::OpenScene => actions.push(Action::Open(path)),
                Purpose::SaveScene => actions.push(Action::SaveAs(path)),
                Purpose::Export => actions.push(Action::Export(path)),
                Purpose::Turntable => actions.push(Action::Turntable(path)),
            },
        }
        self.chooser = None;
    }

    fn copy(&mut self, ctx: &egui::Context) {
        if let Some(text) = self.studio.selected_text() {
            ctx.copy_text(text);
        }
    }

    /// Shoots a debug ray at the pointer, or through the middle of the picture where there is no pointer over it.
    fn shoot(&mut self, ctx: &egui::Context, actions: &mut Vec<Action>) {
        let Some(area) = self.area else { return };
        let pointer = ctx.input(|input| input.pointer.hover_pos());
        let place = pointer
            .and_then(|point| area.picture_position(point))
            .or_else(|| area.picture_position(area.rect.center()));
        actions.extend(place.map(Action::DebugRay));
        self.shot_at = pointer;
        self.layout.bottom = Some(Bottom::Rays);
        self.studio.shown = Shown::Preview;
    }

    /// Shoots again wherever the pointer goes while the key is held. Panels that open under a pointer that rests are no
    /// reason to.
    fn shoot_while_held(&mut self, ctx: &egui::Context, actions: &mut Vec<Action>) {
        if !keys::shoots(ctx) {
            self.shot_at = None;
            return;
        }
        let (Some(shot_at), Some(area)) = (self.shot_at, self.area) else { return };
        let pointer = ctx.input(|input| input.pointer.hover_pos());
        let Some(pointer) = pointer.filter(|pointer| pointer.distance(shot_at) > STILL) else { return };
        if let Some(place) = area.picture_position(pointer) {
            actions.push(Action::DebugRay(place));
            self.shot_at = Some(pointer);
        }
    }

    fn path(&self) -> Option<&Path> {
        self.studio.document.as_ref().and_then(|document| document.path())
    }

    fn choose(&mut self, purpose: Purpose, name: &str) {
        if purpose != Purpose::OpenScene && self.studio.document.is_none() {
            return;
        }
        let near = self.path().map(Path::to_owned).or_else(|| self.layout.recent.first().cloned());
        self.chooser = Some(Chooser::new(purpose, near.as_deref(), name));
    }

    /// Notes the scene that is open among those opened last.
    fn remember(&mut self) {
        /// As many are offered.
        const MOST: usize = 10;
        let Some(path) = self.path().map(|path| std::path::absolute(path).unwrap_or(path.to_owned())) else {
            return;
        };
        if self.layout.recent.first() != Some(&path) {
            self.layout.recent.retain(|other| *other != path);
            self.layout.recent.insert(0, path);
            self.layout.recent.truncate(MOST);
        }
    }

    /// Ends what goes on, or else closes what is open.
    fn escape(&mut self, actions: &mut Vec<Action>) {
        let prepares = self.studio.rays_progress().is_some();
        if self.studio.progress().is_some() || self.studio.is_writing() || prepares {
            actions.push(Action::Stop);
        } else if self.studio.pictures.compare != Compare::Off {
            actions.push(Action::Compare(Compare::Off));
        } else if self.layout.panels && self.layout.bottom.is_some() {
            self.layout.bottom = None;
        }
    }

    fn obey(&mut self, ctx: &egui::Context, command: Command, actions: &mut Vec<Action>) {
        match command {
            Command::Do(Action::Delete) if self.studio.time_line.n_chosen() > 0 => {
                actions.push(Action::DeleteKeys);
            }
            Command::Do(action) => actions.push(action),
            Command::DebugRay => self.shoot(ctx, actions),
            Command::ChooseScene => self.choose(Purpose::OpenScene, ""),
            Command::Save if self.path().is_some() => actions.push(Action::Save),
            Command::Save | Command::SaveAs => {
                let name = self.studio.title();
                self.choose(Purpose::SaveScene, if self.path().is_some() { &name } else { "scene.txt" });
            }
            Command::Export => {
                let name =
                    self.path().and_then(Path::file_stem).map(|stem| stem.to_string_lossy().into_owned());
                self.choose(Purpose::Export, &format!("{}.png", name.as_deref().unwrap_or("picture")));
            }
            Command::Turntable => self.choose(Purpose::Turntable, "turn.png"),
            Command::Copy => self.copy(ctx),
            Command::Cut => {
                self.copy(ctx);
                actions.push(Action::Delete);
            }
            Command::AskForPaste => ctx.send_viewport_cmd(egui::ViewportCommand::RequestPaste),
            Command::Theme => {
                self.layout.light = !self.layout.light;
                ctx.set_theme(theme_of(&self.layout));
            }
            Command::Help => self.help = !self.help,
            Command::TimeLine => {
                self.layout.time_line = Some(!self.has_time_line());
                self.layout.panels |= self.has_time_line();
            }
            Command::Panels => self.layout.panels = !self.layout.panels,
            Command::Escape if self.help => self.help = false,
            Command::Escape if self.studio.has_grip() || self.studio.time_line.is_dragging() => {
                actions.push(Action::CancelDrag)
            }
            Command::Escape => self.escape(actions),
        }
    }
}

/// The frame of a panel, which lets the ground of the window be seen.
fn frame_of_panel(ui: &Ui) -> Frame {
    Frame::side_top_panel(ui.style()).fill(Color32::TRANSPARENT)
}

fn theme_of(layout: &Layout) -> egui::Theme {
    if layout.light { egui::Theme::Light } else { egui::Theme::Dark }
}

/// What the viewport says without a scene.
fn empty(ui: &Ui, rect: Rect, is_loading: bool, has_problems: bool) {
    let (big, small) = match (is_loading, has_problems) {
        (true, _) => ("Reading...", ""),
        (false, true) => {
            ("This scene has mistakes", "They are listed below; the scene opens once they are gone.")
        }
        (false, false) => ("Drop a scene here", "or press L to open one.   F1 lists all keys."),
    };
    let at = rect.center();
    let painter = ui.painter();
    let center = egui::Align2::CENTER_CENTER;
    let font = egui::FontId::proportional;
    painter.text(at - egui::vec2(0.0, 16.0), center, big, font(24.0), ui.visuals().text_color());
    let words =
        painter.layout(small.to_owned(), font(14.0), theme::quiet(ui), (rect.width() - 16.0).max(0.0));
    let corner = at + egui::vec2(-words.size().x / 2.0, 8.0);
    painter.galley(corner, words, theme::quiet(ui));
}
