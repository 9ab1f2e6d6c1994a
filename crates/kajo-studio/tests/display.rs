//! The real program in a real window, on a display without a screen, driven by keys and mouse from outside.
//!
//! It needs Xvfb and xdotool, which `cargo xtask test` installs where it may; without them it says so and passes.

#![cfg(target_os = "linux")]

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::Duration;

const SCENE: &str = "\
// A comment that stays.
PerspectiveCamera { center 0 0 9  direction 0 0 -1  up 0 1 0  angle 30 }
Background { color 0.2 0.3 0.5  ambientLight 0.2 0.2 0.2 }
Lights { DirectionalLight { direction -1 -1 -1  color 0.9 0.9 0.9 } }
Materials { Material { diffuseColor 0.8 0.3 0.2 } }
Group { MaterialIndex 0  Sphere { center 0 0 0  radius 1 } }
Settings { samples regular 1 }
";

/// A program that is ended with the test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A display, the program on it, and its home.
struct Desktop {
    display: String,
    _home: tempfile::TempDir,
    window: String,
    program: Running,
    _server: Running,
}

fn quiet(name: &str) -> Command {
    let mut command = Command::new(name);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command
}

fn has_program(name: &str) -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).any(|folder| folder.join(name).is_file())
}

/// Tries until it works, for as long as it takes.
fn until<T>(mut attempt: impl FnMut() -> Option<T>) -> T {
    loop {
        if let Some(result) = attempt() {
            return result;
        }
        thread::sleep(Duration::from_millis(50));
    }
}

impl Desktop {
    fn open(scene: &Path) -> Desktop {
        let (display, server) = server();
        let home = tempfile::tempdir().unwrap();
        let program = quiet(env!("CARGO_BIN_EXE_kajo-studio"))
            .arg(scene)
            .env("DISPLAY", &display)
            .env("HOME", home.path())
            .env("XDG_RUNTIME_DIR", home.path())
            .env("XDG_DATA_HOME", home.path())
            .env_remove("WAYLAND_DISPLAY")
            .spawn()
            .unwrap();
        let mut program = Running(program);
        let window = until(|| {
            assert_eq!(program.0.try_wait().unwrap(), None, "the program has ended by itself");
            let found = Command::new("xdotool")
                .args(["search", "--onlyvisible", "--name", "kajo studio"])
                .env("DISPLAY", &display)
                .output()
                .unwrap();
            String::from_utf8(found.stdout).unwrap().lines().next_back().map(str::to_owned)
        });
        let desktop = Desktop { display, _home: home, window, program, _server: server };
        // Without a window manager nobody else says who gets the keys.
        until(|| desktop.xdotool(&["windowfocus", "--sync", &desktop.window]).then_some(()));
        desktop
    }

    fn xdotool(&self, arguments: &[&str]) -> bool {
        quiet("xdotool").args(arguments).env("DISPLAY", &self.display).status().unwrap().success()
    }

    /// Presses a key like `ctrl+shift+s`, as slowly as a hand does: modifiers that come together with their key may be
    /// heard of after it.
    fn key(&self, keys: &str) {
        let press = |how: &str, key: &str| {
            assert!(self.xdotool(&[how, key]));
            thread::sleep(Duration::from_millis(200));
        };
        let (modifiers, key) = keys.rsplit_once('+').unwrap_or(("", keys));
        let modifiers: Vec<&str> = modifiers.split('+').filter(|name| !name.is_empty()).collect();
        modifiers.iter().for_each(|modifier| press("keydown", modifier));
        press("key", key);
        modifiers.iter().for_each(|modifier| press("keyup", modifier));
    }

    fn write(&self, text: &str) {
        assert!(self.xdotool(&["type", "--delay", "20", text]));
        thread::sleep(Duration::from_millis(300));
    }
}

/// A display of its own number.
fn server() -> (String, Running) {
    let mut numbers = 140..;
    until(|| {
        let display = format!(":{}", numbers.next()?);
        let arguments = [display.as_str(), "-screen", "0", "1280x800x24", "-nolisten", "tcp"];
        let mut server = Running(quiet("Xvfb").args(arguments).spawn().ok()?);
        until(|| match server.0.try_wait() {
            // The number is taken.
            Ok(Some(_)) => Some(None),
            _ => Path::new(&format!("/tmp/.X11-unix/X{}", &display[1..])).exists().then_some(Some(())),
        })?;
        thread::sleep(Duration::from_millis(300));
        server.0.try_wait().ok()?.is_none().then_some((display, server))
    })
}

#[test]
fn the_program_traces_writes_pictures_moves_and_saves() {
    if let Some(missing) = ["Xvfb", "xdotool"].into_iter().find(|name| !has_program(name)) {
        eprintln!("skipped: {missing} is not installed");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.txt");
    std::fs::write(&scene, SCENE).unwrap();
    let mut desktop = Desktop::open(&scene);

    // Enter traces, and the picture goes into a file.
    let picture = folder.path().join("picture.png");
    desktop.key("Return");
    let size = until(|| {
        // Not before the picture is as fine as the viewport.
        let _ = std::fs::remove_file(&picture);
        thread::sleep(Duration::from_secs(1));
        desktop.key("ctrl+e");
        desktop.key("ctrl+a");
        desktop.write(&picture.display().to_string());
        desktop.key("Return");
        size_of_png(&picture).filter(|size| size[0] > 400)
    });
    assert!(size[1] > 250, "as high as the viewport: {size:?}");

    // W flies ahead, the view goes into the scene, and the scene into its file.
    let saved = until(|| {
        assert!(desktop.xdotool(&["keydown", "w"]));
        thread::sleep(Duration::from_millis(500));
        assert!(desktop.xdotool(&["keyup", "w"]));
        desktop.key("ctrl+shift+c");
        desktop.key("ctrl+s");
        let text = std::fs::read_to_string(&scene).unwrap();
        (text != SCENE).then_some(text)
    });
    assert!(saved.starts_with("// A comment that stays.\nPerspectiveCamera { center 0 0 "), "{saved}");
    let z: f64 = saved.split("center 0 0 ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!(z < 8.9, "nearer: {z}");
    assert_eq!(saved.replace(&format!("center 0 0 {z} "), "center 0 0 9 "), SCENE);
    assert_eq!(desktop.program.0.try_wait().unwrap(), None, "it still runs");
}

/// Columns and rows of a PNG file, once it is whole.
fn size_of_png(path: &Path) -> Option<[u32; 2]> {
    let bytes = std::fs::read(path).ok()?;
    let number = |at: usize| Some(u32::from_be_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    Some([number(16)?, number(20)?])
}
