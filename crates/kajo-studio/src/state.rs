//! What the window is about, with no window in it: the scene, the camera, the trace and everything one can do to
//! them. Widgets read it and hand in [`Action`]s, so tests can do both.

mod action;
mod asking;
mod chosen_keys;
mod editing;
mod handling;
mod histogram;
mod keying;
pub mod line_ends;
mod long_texts;
mod navigation;
mod pictures;
mod priority;
mod problems;
mod rays;
mod recovery;
mod render_options;
mod selection;
mod sight;
mod steps;
mod swatches;
mod textures;
mod time_line;
mod tracer;
mod turntable;
mod typing;
mod viewing;
mod watch;
mod worker;

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use kajo::session::{Job, Status};
use kajo::{CameraPose, LoadOptions, RenderSettings, Scene, Severity, TextureFolder, View, suitable_size};
use kajo_edit::handles::Mode;
use kajo_edit::preview::Preview;
use kajo_edit::{Compilation, Compiled, Document, DocumentError, FileId};
use kajo_math::{Aabb, DVec3, Vec3};

pub use action::{Action, Answer, Compare};
pub use asking::{Cause, Question};
pub use handling::{GIZMOS, Grip, Handles};
pub use histogram::{BINS, Histogram, stops_of};
pub use navigation::{Held, Navigation};
pub use pictures::{Apart, Kept, Pictures, effort};
pub use problems::{Problem, SourcePosition, problems};
pub use rays::{Rays, color as ray_color, kind_name as ray_kind, legend as ray_legend};
pub use recovery::LeftOver;
pub use render_options::{Habits, PictureSize, RenderOptions};
pub use selection::Selection;
pub use sight::BACKGROUND;
pub use steps::CameraState;
pub use time_line::TimeLine;
pub use tracer::{Request, Tracer, Wake};
pub use watch::Watch;

use asking::Asking;
use editing::DraggedField;
use long_texts::{LongTexts, Task};
use rays::Probing;
use selection::Chosen;
use sight::Sight;
use steps::CameraSteps;
use swatches::Swatches;
use textures::FineTextures;
use turntable::TurntableOrder;
use worker::Worker;

/// What fills the viewport.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shown {
    /// What the graphics card draws.
    #[default]
    Preview,
    /// What was traced.
    Traced,
}

/// A sentence for the status bar.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// The message.
    pub text: String,
    /// Whether something went wrong.
    pub is_error: bool,
}

/// Layers that every trace records beside the light: to show one of them nothing is traced anew.
const ALWAYS: [View; 7] =
    [View::Samples, View::Variance, View::Depth, View::Normals, View::Uv, View::Object, View::Material];

/// Tells one version of a scene from another: a count of documents, and one of versions of a document.
pub type Version = (u64, u64);

/// A scene that was read, with mistakes or without.
struct Opened {
    path: PathBuf,
    document: Result<Document, DocumentError>,
}

/// Everything.
pub struct Studio {
    /// The scene and its text.
    pub document: Option<Document>,
    /// Counts documents.
    opened: u64,
    /// What is wrong with the text as it is now.
    pub problems: Vec<Problem>,
    /// What is chosen.
    pub selection: Selection,
    /// The scene as triangles and lines, and the version it was made of.
    pub preview: Option<(Version, Arc<Preview>)>,
    /// The debug ray, if one was shot.
    pub rays: Option<Rays>,
    probing: Probing,
    /// From where one looks.
    pub camera: CameraPose,
    camera_version: u64,
    steps: CameraSteps,
    /// Whether the camera stands where the scene says.
    is_home: bool,
    /// The scene and the shape of the picture, width over height, to which it is fitted there.
    fitted_to: Option<(Version, f64)>,
    /// How one moves.
    pub navigation: Navigation,
    /// What is asked of a trace.
    pub options: RenderOptions,
    /// What the viewport shows.
    pub shown: Shown,
    /// Which layer of a traced picture it shows.
    pub view: View,
    /// The pictures traced last, and how two of them are compared.
    pub pictures: Pictures,
    /// The trace.
    pub tracer: Tracer,
    /// The frame on show, and the keys of the scene.
    pub time_line: TimeLine,
    /// The newest message.
    pub notice: Option<Notice>,
    /// Pixels of the viewport.
    pub window: [u32; 2],
    /// The gizmo on show, if any.
    pub gizmo: Option<Mode>,
    grip: Option<Grip>,
    /// The field that is being dragged.
    dragged: Option<DraggedField>,
    /// The file that is being typed in.
    typing: Option<FileId>,
    turntable: Worker<TurntableOrder, Result<String, String>>,
    stop_turntable: Arc<AtomicBool>,
    opener: Worker<PathBuf, Opened>,
    long_texts: LongTexts,
    /// Makes scenes of texts that were edited; the number is that of the document.
    compiler: Worker<(u64, Compilation), (u64, Compiled)>,
    /// The version of the text that it was given last.
    ordered: Option<Version>,
    /// Whether a trace is to begin once the scene is what the text says.
    wants_trace: bool,
    sight: Sight,
    textures: FineTextures,
    swatches: Swatches,
    previewer: Worker<(Version, Arc<Scene>), (Version, Arc<Preview>)>,
    watch: Watch,
    asking: Asking,
    wake: Wake,
    /// Whether a file was written while it was read.
    was_changed_meanwhile: bool,
}

impl Studio {
    /// An empty stage.
    ///
    /// * `wake`: called by other threads when there is something new to show
    pub fn new(wake: Wake) -> Studio {
        let waker = Arc::clone(&wake);
        let camera =
            CameraPose::perspective(DVec3::new(0.0, 0.0, 10.0), DVec3::ZERO, DVec3::Y, 45f64.to_radians());
        Studio {
            document: None,
            opened: 0,
            problems: Vec::new(),
            selection: Selection::default(),
            preview: None,
            rays: None,
            probing: Probing::new(0, &wake),
            navigation: Navigation::of(None, &camera),
            camera,
            camera_version: 0,
            steps: CameraSteps::default(),
            is_home: true,
            fitted_to: None,
            options: RenderOptions::default(),
            shown: Shown::Preview,
            view: View::Color,
            pictures: Pictures::default(),
            tracer: Tracer::new(Arc::clone(&wake)),
            time_line: TimeLine::new(),
            notice: None,
            window: [800, 600],
            gizmo: None,
            grip: None,
            dragged: None,
            typing: None,
            turntable: Worker::new(Arc::clone(&wake), TurntableOrder::carry_out),
            stop_turntable: Arc::default(),
            opener: Worker::new(Arc::clone(&wake), open),
            long_texts: LongTexts::new(Arc::clone(&wake)),
            compiler: Worker::new(Arc::clone(&wake), |(opened, text): (u64, Compilation)| {
                (opened, text.run())
            }),
            ordered: None,
            wants_trace: false,
            sight: Sight::new(Arc::clone(&wake)),
            textures: FineTextures::new(Arc::clone(&wake)),
            swatches: Swatches::new(Arc::clone(&wake)),
            previewer: Worker::new(Arc::clone(&wake), |(version, scene): (Version, Arc<Scene>)| {
                (version, Arc::new(Preview::of(&scene)))
            }),
            watch: Watch::new(move || waker()),
            asking: Asking::default(),
            wake,
            was_changed_meanwhile: false,
        }
    }

    /// Does what the user wants.
    pub fn apply(&mut self, action: Action) {
        match action {
            action if action.is_of_time() => self.time_action(action),
            Action::Open(_) | Action::New | Action::Close | Action::Recover => self.leave(action),
            Action::Answer(answer) => self.answer(answer),
            Action::Reload => self.reload(),
            Action::Trace => self.trace(),
            Action::Stop => {
                self.tracer.cancel();
                if self.rays_progress().is_some() {
                    self.clear_rays();
                }
                self.stop_turntable.store(true, Ordering::Relaxed);
            }
            Action::Turntable(ref path) => {
                let files = self.turntable_files(path);
                self.write(action, &files);
            }
            Action::Gizmo(_) | Action::Grab(_) | Action::DragTo(..) | Action::CancelDrag => {
                self.handle_action(action);
            }
            Action::ToggleShown => self.toggle_shown(),
            Action::Show(view) => self.view = view,
            Action::KeepPicture
            | Action::ForgetPicture(_)
            | Action::ShowPicture(_)
            | Action::CompareWith(_)
            | Action::Compare(_)
            | Action::Wipe(_)
            | Action::LookAsIn(_) => self.picture_action(action),
            Action::StepCamera(is_back) => {
                if !self.step_camera(is_back) {
                    self.say("The camera has made no such step.", false);
                }
            }
            Action::EndDrag => {
                self.rest_camera();
                self.edit_action(action);
            }
            Action::Pick(..)
            | Action::DebugRay(_)
            | Action::DebugSample(_)
            | Action::ClearDebugRay
            | Action::ChooseSegment(_)
            | Action::HoverSegment(_) => self.probe_action(action),
            Action::Fly(..)
            | Action::Look(_)
            | Action::Orbit(_)
            | Action::Pan(_)
            | Action::Zoom(_)
            | Action::ChangeSpeed(_)
            | Action::Frame
            | Action::SetEye(_)
            | Action::SetAngle(_)
            | Action::SetHeight(_)
            | Action::ResetCamera => self.view_action(action),
            other => self.edit_action(other),
        }
    }

    /// Takes in what other threads have done, and starts the trace anew where that is due. Called once a frame.
    pub fn update(&mut self) {
        if let Some(opened) = self.opener.take() {
            self.take(opened);
        }
        self.take_copy();
        self.adopt_scene();
        self.pass_time();
        if let Some(preview) = self.previewer.take_latest().filter(|(version, _)| version.0 == self.opened) {
            self.preview = Some(preview);
        }
        self.refine_textures();
        self.draw_swatches();
        self.look();
        self.take_rays();
        match self.turntable.take() {
            Some(Ok(text)) => self.say(&text, false),
            Some(Err(text)) => self.say(&text, true),
            None => {}
        }
        let is_changed =
            self.watch.changed() && self.document.as_ref().is_some_and(Document::changed_on_disk);
        if std::mem::take(&mut self.was_changed_meanwhile) || is_changed {
            self.take_changes();
        }
        self.fit_camera();
        self.save_aside();
        self.keep_finished();
        self.trace_if_stale();
    }

    /// Starts the trace anew where something has changed, but where there is such a picture already.
    fn trace_if_stale(&mut self) {
        if self.shown != Shown::Traced || !self.options.habits.live {
            return;
        }
        let Some(request) = self.request().filter(|request| !self.tracer.was_asked_for(request)) else {
            return;
        };
        let is_finished = self.tracer.finished().is_some_and(|(_, of)| of.is_like(&request));
        if is_finished || self.pictures.shown.is_some() {
            // It is only shown larger or smaller than it was asked for.
            return;
        }
        if self.pictures.answer(&request).is_some() {
            if self.progress().is_some() {
                self.tracer.forget();
            }
            return;
        }
        let before = self.finished_picture();
        self.trace();
        if let Some(letter) = before {
            let way = if self.steps.can_undo() { "Ctrl+Z goes back to it" } else { "it stands below" };
            self.say(&format!("The finished picture is kept as {letter}: {way}."), false);
        }
    }
}

/// What the window asks about.
impl Studio {
    /// The last scene without mistakes.
    pub fn scene(&self) -> Option<&Arc<Scene>> {
        self.document.as_ref().and_then(Document::scene)
    }

    /// The version of [`Studio::scene`].
    pub fn version(&self) -> Version {
        (self.opened, self.document.as_ref().map_or(0, Document::scene_generation))
    }

    /// What a trace would do now; `None` without a scene.
    pub fn settings(&self) -> Option<Result<RenderSettings, kajo::SettingsError>> {
        self.scene().map(|scene| self.options.resolve(scene, self.window))
    }

    /// Columns and rows of the picture that the camera makes.
    pub fn picture_size(&self) -> [u32; 2] {
        if let Some(size) = self.finished_size() {
            return size;
        }
        match self.options.habits.size {
            PictureSize::Window => suitable_size(self.camera.camera(), self.window),
            _ => self.settings().and_then(Result::ok).map_or(self.window, |settings| settings.size),
        }
    }

    /// A box around the scene; one around the origin where there is none.
    pub fn bounds(&self) -> Aabb {
        let unit = Aabb { min: Vec3::splat(-1.0), max: Vec3::ONE };
        let bounds = self.scene().map(|scene| scene.geometry.bounds());
        bounds.filter(|bounds| !bounds.is_empty() && bounds.is_finite()).unwrap_or(unit)
    }

    /// The name of the scene for people.
    pub fn title(&self) -> String {
        let Some(document) = &self.document else { return "no scene".to_owned() };
        let name = document.path().and_then(std::path::Path::file_name);
        name.map_or_else(|| "untitled".to_owned(), |name| name.to_string_lossy().into_owned())
    }

    /// Whether a scene is being read.
    pub fn is_loading(&self) -> bool {
        self.opener.is_busy()
    }

    /// How far the trace is, while it runs.
    pub fn progress(&self) -> Option<f32> {
        match self.tracer.status() {
            Status::Running { progress } => Some(progress),
            _ => None,
        }
    }

    /// Whether the text has been edited, or is being edited, and the scene that it makes is not there yet.
    pub fn is_compiling(&self) -> bool {
        self.compiler.is_busy() || self.long_texts.is_busy()
    }

    /// Whether the preview is of the scene as it is now.
    pub fn preview_is_current(&self) -> bool {
        self.preview.as_ref().is_some_and(|(version, _)| *version == self.version())
    }

    /// Number of mistakes.
    pub fn n_errors(&self) -> usize {
        self.problems.iter().filter(|problem| problem.severity == Severity::Error).count()
    }

    fn request(&self) -> Option<Request> {
        self.scene()?;
        Some(Request {
            scene: self.version(),
            camera: self.camera_version,
            options: self.options.of_light(),
            window: if self.options.habits.size == PictureSize::Window { self.window } else { [0, 0] },
        })
    }

    /// What a trace records.
    fn views(&self) -> Vec<View> {
        if self.options.habits.all_layers {
            return View::ALL.into_iter().filter(|&view| view != View::Color).collect();
        }
        let is_more = self.view != View::Color && !ALWAYS.contains(&self.view);
        ALWAYS.into_iter().chain(is_more.then_some(self.view)).collect()
    }
}

/// Tracing and files.
impl Studio {
    fn trace(&mut self) {
        let (Some(scene), Some(request)) = (self.scene().cloned(), self.request()) else {
            self.say("Open a scene first.", false);
            return;
        };
        self.shown = Shown::Traced;
        self.wants_trace = self.is_compiling();
        if self.wants_trace {
            return;
        }
        self.keep_dropped();
        self.pictures.shown = None;
        match self.options.resolve(&scene, self.window) {
            Ok(settings) => {
                let habits = &self.options.habits;
                let mut job = Job::new(scene, settings).through(self.camera.clone());
                job.downscale = if habits.progressive { habits.downscale.max(1) } else { 1 };
                job.keeps_state = habits.keep_records;
                job.views = self.views();
                job.coarse_views = vec![self.view];
                let job = if habits.endless { job.without_end() } else { job };
                let place = self.camera_state();
                self.tracer.start(request, job, place);
            }
            Err(error) => {
                self.say(&error.to_string(), true);
                self.tracer.give_up(request);
            }
        }
    }

    fn toggle_shown(&mut self) {
        self.shown = match self.shown {
            Shown::Preview => Shown::Traced,
            Shown::Traced => Shown::Preview,
        };
    }

    fn take(&mut self, Opened { path, document }: Opened) {
        match document {
            // Something may have been edited while it was read.
            Ok(_) if !self.may_go() => self.leave(Action::Open(path)),
            Ok(document) => {
                self.begin(document);
                match self.n_errors() {
                    0 => self.say(&format!("Opened {}.", self.title()), false),
                    1 => self.say(&format!("1 mistake in {}.", self.title()), true),
                    n => self.say(&format!("{n} mistakes in {}.", self.title()), true),
                }
            }
            Err(error) => self.say(&format!("{}: {error}", path.display()), true),
        }
    }

    /// Reads the files again, once that may be.
    fn reload(&mut self) {
        self.end_drag();
        if !self.ask_about(Cause::Reloading) {
            self.take_from_disk(Cause::Reloading);
        }
    }

    /// Takes over what another program has written, or asks about it.
    fn take_changes(&mut self) {
        if self.long_texts.is_busy() {
            // Once that is done.
            self.was_changed_meanwhile = true;
            return;
        }
        if !self.ask_about(Cause::Changed) {
            self.take_from_disk(Cause::Changed);
        }
    }

    /// Takes over what is on disk: everything to read it again, and what others have written otherwise.
    fn take_from_disk(&mut self, cause: Cause) {
        let task = if cause == Cause::Reloading { Task::Reload } else { Task::TakeTheirs };
        if self.has_long_text() {
            self.do_beside(task);
            return;
        }
        self.end_drag();
        let chosen = self.chosen();
        let Some(document) = &mut self.document else { return };
        match task.carry_out(document) {
            Ok(()) => {
                self.compile();
                self.was_reloaded(&chosen);
            }
            Err(problem) => self.say(&problem, true),
        }
    }

    fn was_reloaded(&mut self, chosen: &[Chosen]) {
        if let Some(document) = &self.document {
            self.selection.find_again(chosen, document);
        }
        self.watch_files();
        self.say("Read again: the file has changed.", false);
    }

    /// Looks at all files that the scene consists of.
    fn watch_files(&mut self) {
        let Some(document) = &self.document else { return };
        let Some(path) = document.path() else { return };
        let folder = path.parent().unwrap_or(path);
        let included = document.files().skip(1).map(|(_, file)| folder.join(&file.name));
        self.watch.set(std::iter::once(path.to_owned()).chain(included).collect());
        // Since the document was read, and before the watch began.
        self.was_changed_meanwhile = document.changed_on_disk();
    }

    /// Has a scene made of the text; the last one stays on show until it is there.
    fn compile(&mut self) {
        let Some(document) = &self.document else { return };
        self.selection.refresh(document);
        let text = (self.opened, document.generation());
        if let Some(compilation) = document.compilation().filter(|_| self.ordered != Some(text)) {
            self.ordered = Some(text);
            self.compiler.order((self.opened, compilation));
        }
    }

    /// Takes over a scene that was made of the text, and all that follows from it.
    fn adopt_scene(&mut self) {
        if let Some((opened, compiled)) = self.compiler.take_latest()
            && let Some(document) = self.document.as_mut().filter(|_| opened == self.opened)
        {
            document.adopt(compiled);
            self.after_compile();
        }
        if self.wants_trace && !self.is_compiling() {
            self.trace();
        }
    }

    fn after_compile(&mut self) {
        let Some(document) = &self.document else { return };
        self.problems = problems(document.diagnostics(), document.sources());
        self.selection.refresh(document);
        if let Some(scene) = document.scene().filter(|_| self.is_home) {
            self.camera = CameraPose::of(scene);
            self.fitted_to = None;
            self.fit_camera();
        }
        let version = self.version();
        if let Some(scene) = self.scene().cloned().filter(|_| !self.preview_is_current()) {
            self.previewer.order((version, scene));
            self.shoot_again();
        }
    }

    fn say(&mut self, text: &str, is_error: bool) {
        self.notice = Some(Notice { text: text.to_owned(), is_error });
    }
}

/// How scenes are read in the window.
fn load_options() -> LoadOptions {
    LoadOptions { textures: TextureFolder::usual(), ..LoadOptions::default() }
}

fn open(path: PathBuf) -> Opened {
    let document = Document::open(&path, load_options()).map(|mut document| {
        document.compile();
        document
    });
    Opened { path, document }
}
