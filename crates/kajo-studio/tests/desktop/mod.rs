//! The real program in a real window, on a display without a screen, driven by keys and mouse from outside.
//!
//! What it does is seen as a user sees it: in the title of its window, in files, and in the pixels of the display. Every
//! wait is for something to be seen there, for as long as it takes: a slow machine makes a test slow, not red.

mod screen;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread;
use std::time::Duration;

pub use screen::Screen;

/// A red ball in the middle of the picture.
pub const SCENE: &str = "\
// A comment that stays.
PerspectiveCamera { center 0 0 9  direction 0 0 -1  up 0 1 0  angle 30 }
Background { color 0.2 0.3 0.5 }
Lights { DirectionalLight { direction -1 -1 -1  color 0.9 0.9 0.9 } }
Materials { Matte { color 0.8 0.1 0.1 } }
Group { MaterialIndex 0  Sphere ball { center 0 0 0  radius 1 } }
Settings { samples regular 1 }
";

/// The button of a dialog that Enter presses.
pub const ACCENT: [u8; 3] = [255, 176, 64];

/// Programs that these tests need.
const NEEDS: [&str; 2] = ["Xvfb", "xdotool"];

/// A program that is ended with the test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A display, and the program on it.
pub struct Desktop {
    display: String,
    folder: tempfile::TempDir,
    _server: Running,
    program: Option<Running>,
    window: String,
}

impl Desktop {
    /// A display of that size. `None`, with a word about it, where a program is missing that it needs.
    pub fn new(size: [u32; 2]) -> Option<Desktop> {
        let path = std::env::var_os("PATH").unwrap_or_default();
        let is_there = |name: &str| std::env::split_paths(&path).any(|folder| folder.join(name).is_file());
        if let Some(missing) = NEEDS.into_iter().find(|name| !is_there(name)) {
            eprintln!("skipped: {missing} is not installed");
            return None;
        }
        let folder = tempfile::tempdir().unwrap();
        for name in ["screen", "home", "scenes"] {
            fs::create_dir(folder.path().join(name)).unwrap();
        }
        let (display, server) = server(&folder.path().join("screen"), size);
        Some(Desktop { display, folder, _server: server, program: None, window: String::new() })
    }

    /// A display with the program on it, and `SCENE` as `scene.txt` in the program.
    pub fn with_scene() -> Option<Desktop> {
        let mut desktop = Desktop::new([1280, 800])?;
        desktop.write("scene.txt", SCENE);
        desktop.start(Some("scene.txt"));
        desktop.see("the ball", |screen| screen.ball());
        Some(desktop)
    }

    /// Starts the program, and waits until it has read the scene.
    pub fn start(&mut self, scene: Option<&str>) {
        let home = self.folder.path().join("home");
        let program = quiet(env!("CARGO_BIN_EXE_kajo-studio"))
            .args(scene.map(|name| self.path(name)))
            .env("DISPLAY", &self.display)
            .env("HOME", &home)
            .env("XDG_RUNTIME_DIR", &home)
            .env("XDG_DATA_HOME", &home)
            .env("XDG_CONFIG_HOME", &home)
            .env_remove("WAYLAND_DISPLAY")
            .spawn()
            .unwrap();
        self.program = Some(Running(program));
        self.window = self.until("a window", |desktop| {
            let found = desktop.xdotool(&["search", "--onlyvisible", "--name", "kajo studio"]);
            String::from_utf8(found.stdout).unwrap().lines().next_back().map(str::to_owned)
        });
        // Without a window manager nobody else says who gets the keys.
        let window = self.window.clone();
        self.until("the keys", |desktop| {
            let focus = desktop.xdotool(&["getwindowfocus"]);
            let has_focus = String::from_utf8_lossy(&focus.stdout).trim() == window;
            if !has_focus {
                desktop.xdotool(&["windowfocus", &window]);
            }
            has_focus.then_some(())
        });
        if let Some(scene) = scene {
            self.wait_for_title(&format!("{scene} - kajo studio"));
        }
    }

    /// Ends the program without a chance to do anything about it.
    pub fn kill(&mut self) {
        self.program = None;
    }

    /// Waits until the program has come to its end, and returns whether that was a good one.
    pub fn ended(&mut self) -> bool {
        let status = self.program.take().expect("a program").0.wait().unwrap();
        status.success()
    }

    /// A file among the scenes.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join("scenes").join(name)
    }

    pub fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_default()
    }

    pub fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
    }

    /// Files in a folder of the program's own, such as that of edits saved aside.
    pub fn files_of_program(&self, folder: &str) -> Vec<PathBuf> {
        let found = fs::read_dir(self.folder.path().join("home").join(folder));
        found.map_or_else(|_| Vec::new(), |files| files.map(|file| file.unwrap().path()).collect())
    }

    /// Tries until it works, for as long as it takes.
    ///
    /// # Panics
    /// When the program ends meanwhile.
    pub fn until<T>(&mut self, what: &str, mut attempt: impl FnMut(&Desktop) -> Option<T>) -> T {
        loop {
            if let Some(result) = attempt(self) {
                return result;
            }
            if let Some(program) = &mut self.program
                && let Some(status) = program.0.try_wait().unwrap()
            {
                panic!("the program has ended with {status} before there was {what}");
            }
            thread::sleep(Duration::from_millis(30));
        }
    }

    /// Waits until the window has this title.
    pub fn wait_for_title(&mut self, title: &str) {
        self.until(title, |desktop| (desktop.title() == title).then_some(()));
    }

    pub fn title(&self) -> String {
        let name = self.xdotool(&["getwindowname", &self.window]).stdout;
        String::from_utf8_lossy(&name).trim().to_owned()
    }

    /// What is on the display, as soon as there is what one looks for.
    pub fn see<T>(&mut self, what: &str, find: impl Fn(&Screen) -> Option<T>) -> T {
        let found = self.until(what, |desktop| find(&desktop.screen()?));
        self.keep_screenshot(what);
        found
    }

    /// What is on the display once it has been the same for a while.
    pub fn rest(&mut self) -> Screen {
        let mut last = None;
        let mut same = 0;
        self.until("rest", |desktop| {
            let screen = desktop.screen();
            same = if screen == last { same + 1 } else { 0 };
            last = screen;
            // A caret that blinks is no change that is waited for.
            if same < 3 { None } else { last.clone() }
        })
    }

    /// Waits until a dialog asks something.
    pub fn wait_for_question(&mut self, what: &str) {
        self.see(what, |screen| screen.button());
    }

    /// Waits until no dialog asks anything.
    pub fn wait_for_no_question(&mut self) {
        self.see("no question", |screen| screen.button().is_none().then_some(()));
    }

    /// What is on the display; `None` while the server is writing it for the first time.
    pub fn screen(&self) -> Option<Screen> {
        Screen::read(&self.folder.path().join("screen/Xvfb_screen0"))
    }

    /// Keeps a picture of the display in the folder that `KAJO_SCREENSHOTS` names, to be looked at.
    fn keep_screenshot(&self, what: &str) {
        let Some(folder) = std::env::var_os("KAJO_SCREENSHOTS").map(PathBuf::from) else { return };
        let test = thread::current().name().unwrap_or("test").to_owned();
        let count = fs::read_dir(&folder).map_or(0, Iterator::count);
        let name = format!("{count:03}_{test}_{}.png", what.replace(' ', "_"));
        if let Some(screen) = self.screen() {
            screen.save(&folder.join(name));
        }
    }

    /// Presses a key such as `ctrl+shift+s`.
    pub fn key(&self, keys: &str) {
        self.keys(&[keys]);
    }

    /// Presses keys one after the other, as fast as the display takes them.
    pub fn keys(&self, keys: &[&str]) {
        assert!(self.xdotool(&[&["key", "--delay", "0"], keys].concat()).status.success());
    }

    /// Types letters into what has the focus.
    pub fn type_text(&self, text: &str) {
        assert!(self.xdotool(&["type", "--delay", "1", text]).status.success());
    }

    pub fn point_at(&self, [x, y]: [u32; 2]) {
        assert!(self.xdotool(&["mousemove", &x.to_string(), &y.to_string()]).status.success());
    }

    pub fn click(&self, at: [u32; 2]) {
        self.point_at(at);
        assert!(self.xdotool(&["click", "1"]).status.success());
    }

    /// Drags with the left button, in steps as a hand makes them: over several frames, since what begins and ends within
    /// one is a click.
    pub fn drag(&self, from: [u32; 2], to: [u32; 2]) {
        self.point_at(from);
        assert!(self.xdotool(&["mousedown", "1"]).status.success());
        for step in 1..=8 {
            thread::sleep(Duration::from_millis(50));
            let between = |a: u32, b: u32| (a * (8 - step) + b * step) / 8;
            self.point_at([between(from[0], to[0]), between(from[1], to[1])]);
        }
        assert!(self.xdotool(&["mouseup", "1"]).status.success());
    }

    /// Columns and rows of the window.
    pub fn window_size(&self) -> [u32; 2] {
        let geometry = self.xdotool(&["getwindowgeometry", "--shell", &self.window]).stdout;
        let geometry = String::from_utf8_lossy(&geometry).into_owned();
        let number = |key: &str| geometry.lines().find_map(|line| line.strip_prefix(key)?.parse().ok());
        ["WIDTH=", "HEIGHT="].map(|key| number(key).expect("a size"))
    }

    fn xdotool(&self, arguments: &[&str]) -> Output {
        Command::new("xdotool").args(arguments).env("DISPLAY", &self.display).output().unwrap()
    }
}

fn quiet(name: &str) -> Command {
    let mut command = Command::new(name);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command
}

/// A display of its own number, whose pixels are in a file in `folder`.
fn server(folder: &Path, [width, height]: [u32; 2]) -> (String, Running) {
    for number in 140.. {
        let display = format!(":{number}");
        let size = format!("{width}x{height}x24");
        let server = quiet("Xvfb")
            .args([display.as_str(), "-screen", "0", &size, "-nolisten", "tcp", "-noreset", "-fbdir"])
            .arg(folder)
            .spawn()
            .unwrap();
        let mut server = Running(server);
        loop {
            if server.0.try_wait().unwrap().is_some() {
                // The number is taken.
                break;
            }
            let answer = quiet("xdotool").arg("getdisplaygeometry").env("DISPLAY", &display).status();
            // Another server may have answered while this one has not yet found that out.
            if answer.unwrap().success() && folder.join("Xvfb_screen0").exists() {
                thread::sleep(Duration::from_millis(100));
                if server.0.try_wait().unwrap().is_none() {
                    return (display, server);
                }
            }
            thread::sleep(Duration::from_millis(30));
        }
    }
    unreachable!("numbers do not end")
}
