//! The program `kajo-studio`.

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

use egui_wgpu::{WgpuConfiguration, WgpuSetup};
use kajo_studio::shell::{App, Layout};
use kajo_studio::state::Action;

const HELP: &str = "\
The window of kajo: fly through a scene, trace it, look at what rays do, edit it.

Usage: kajo-studio [SCENE]

Options:
  -h, --help     Print help
  -V, --version  Print version

F1 in the window lists all keys.";

/// What the command line asks for.
enum Request {
    Window(Option<PathBuf>),
    Answer(&'static str),
    Mistake(String),
}

fn main() -> ExitCode {
    match request(std::env::args_os().skip(1).collect()) {
        Request::Window(scene) => window(scene),
        Request::Answer(text) => {
            println!("{text}");
            ExitCode::SUCCESS
        }
        Request::Mistake(text) => failed(&text),
    }
}

fn request(words: Vec<std::ffi::OsString>) -> Request {
    match words.as_slice() {
        [] => Request::Window(None),
        [one] => match one.to_str() {
            Some("-h" | "--help") => Request::Answer(HELP),
            Some("-V" | "--version") => Request::Answer(concat!("kajo-studio ", env!("CARGO_PKG_VERSION"))),
            Some(word) if word.starts_with('-') => Request::Mistake(format!("there is no option `{word}`")),
            _ => Request::Window(Some(one.into())),
        },
        _ => Request::Mistake("one scene at a time".to_owned()),
    }
}

fn window(scene: Option<PathBuf>) -> ExitCode {
    if let Some(missing) = scene.as_ref().filter(|path| !path.is_file()) {
        return failed(&format!("there is no file `{}`", missing.display()));
    }
    let viewport = egui::ViewportBuilder::default()
        .with_title("kajo studio")
        .with_app_id("kajo-studio")
        .with_inner_size([1280.0, 800.0])
        .with_min_inner_size([320.0, 240.0])
        .with_clamp_size_to_monitor_size(true)
        .with_drag_and_drop(true);
    // Without dithering the pixels on show are those of the picture, and drawing on the processor is faster.
    let options =
        eframe::NativeOptions { viewport, wgpu_options: card(), dithering: false, ..Default::default() };
    let run = eframe::run_native(
        "kajo-studio",
        options,
        Box::new(|context| {
            let layout = context.storage.and_then(|storage| eframe::get_value(storage, LAYOUT));
            let layout: Layout = layout.unwrap_or_default();
            let mut app = App::new(&context.egui_ctx, context.wgpu_render_state.as_ref(), layout);
            if let Some(folder) = eframe::storage_dir("kajo-studio") {
                app.studio.keep_edits_in(&folder.join("recovery"));
            }
            if let Some(scene) = scene {
                app.studio.apply(Action::Open(scene));
            }
            Ok(Box::new(Window(app)))
        }),
    );
    match run {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => failed(&explained(&error)),
    }
}

/// Any graphics card will do, and so will its stand-in on the processor; large scenes want all the memory it gives.
fn card() -> WgpuConfiguration {
    let mut configuration = WgpuConfiguration::default();
    if let WgpuSetup::CreateNew(setup) = &mut configuration.wgpu_setup {
        let usual = Arc::clone(&setup.device_descriptor);
        setup.device_descriptor = Arc::new(move |adapter| {
            let mut descriptor = usual(adapter);
            let limits = adapter.limits();
            descriptor.required_limits.max_buffer_size = limits.max_buffer_size;
            descriptor.required_limits.max_texture_dimension_2d = limits.max_texture_dimension_2d;
            descriptor
        });
    }
    configuration
}

/// The key of the layout in the storage of the system.
const LAYOUT: &str = "layout";

/// The window as the system sees it.
struct Window(App);

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        self.0.ui(ui);
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        eframe::set_value(storage, LAYOUT, &self.0.layout);
    }
}

/// What to do when there can be no window.
fn explained(error: &eframe::Error) -> String {
    let what = error.to_string();
    let advice = match error {
        eframe::Error::Wgpu(_) => {
            "no graphics card can be used, nor a stand-in for one; on Linux the packages mesa-vulkan-drivers or \
             libgl1-mesa-dri bring one that runs on the processor"
        }
        _ => {
            "there is no display to open a window on; on Linux set DISPLAY or WAYLAND_DISPLAY, or log in to a \
             desktop. `kajo render scene.txt` needs no window"
        }
    };
    format!("{what}\n{advice}")
}

fn failed(text: &str) -> ExitCode {
    eprintln!("error: {text}");
    ExitCode::from(2)
}
