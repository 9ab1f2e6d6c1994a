//! Keys and what they do, in one table: the window obeys it and its help shows it.

use egui::{Context, Event, Key, Modifiers};

use kajo_edit::handles::Mode;

use super::text_editor;
use crate::state::{Action, Held};

/// What a key does.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Something to the scene.
    Do(Action),
    /// Shoots a debug ray at the pointer.
    DebugRay,
    /// Asks which scene to open.
    ChooseScene,
    /// Saves, and asks where if there is no file yet.
    Save,
    /// Asks where to save.
    SaveAs,
    /// Asks where to write the picture.
    Export,
    /// Asks where to write pictures from all around.
    Turntable,
    /// Copies the text of what is selected to the clipboard.
    Copy,
    /// Copies it and takes it out.
    Cut,
    /// Asks the system for the text on the clipboard, to be pasted.
    AskForPaste,
    /// Shows or hides the list of keys.
    Help,
    /// Shows or hides the panels around the viewport.
    Panels,
    /// Shows or hides the time line.
    TimeLine,
    /// Goes from dark colours to light ones, or back.
    Theme,
    /// Closes what is open, or gives up what is going on.
    Escape,
}

/// A key, alone or with others held.
pub struct Shortcut {
    /// Held with it.
    pub modifiers: Modifiers,
    /// The key.
    pub key: Key,
    /// What it does.
    pub command: Command,
    /// The same in words.
    pub about: &'static str,
}

/// The keys and mouse buttons that move the camera, in words.
pub const MOVES: [(&str, &str); 10] = [
    ("W A S D", "Fly forward, left, back, right"),
    ("Page up, Page down", "Fly up, down"),
    ("Shift", "Fly four times as fast"),
    ("Right drag", "Look around"),
    ("Wheel", "Change the speed of flight"),
    ("Left or middle drag", "Turn around what you look at"),
    ("Shift and drag", "Shift the camera"),
    ("Ctrl and wheel", "Come nearer, or go away"),
    ("Click", "Select what is under the pointer"),
    ("Drag a handle", "Edit the shape; Ctrl goes in steps"),
];

/// The keys of the clipboard, in words; systems tell of them in their own way.
pub const CLIPBOARD: (&str, &str) = ("Ctrl+C, X, V", "Copy, cut, paste blocks of the scene");

/// The key of the text that lists what may be typed, in words; see [`super::completion`].
pub const COMPLETION: (&str, &str) = ("Ctrl+Space", "In the text, list what may be typed");

/// All keys but those that are held to fly.
pub fn shortcuts() -> Vec<Shortcut> {
    use Command::Do;
    const NONE: Modifiers = Modifiers::NONE;
    const COMMAND: Modifiers = Modifiers::COMMAND;
    let table = [
        (NONE, Key::Enter, Do(Action::Trace), "Trace from the current view"),
        (NONE, Key::Space, Do(Action::ToggleShown), "Switch between preview and traced picture"),
        (NONE, Key::E, Command::DebugRay, "Shoot a debug ray at the pointer; held, wherever it goes"),
        (NONE, Key::L, Command::ChooseScene, "Open a scene"),
        (COMMAND, Key::O, Command::ChooseScene, "Open a scene"),
        (COMMAND, Key::N, Do(Action::New), "Begin a new scene"),
        (COMMAND, Key::R, Do(Action::Reload), "Read the file again"),
        (COMMAND, Key::S, Command::Save, "Save the scene"),
        (COMMAND.plus(Modifiers::SHIFT), Key::S, Command::SaveAs, "Save the scene to another file"),
        (COMMAND, Key::Q, Do(Action::Close), "Quit"),
        (COMMAND, Key::E, Command::Export, "Write the picture to a file"),
        (COMMAND, Key::Z, Do(Action::Undo), "Take the last step back"),
        (COMMAND.plus(Modifiers::SHIFT), Key::Z, Do(Action::Redo), "Do it again"),
        (COMMAND, Key::Y, Do(Action::Redo), "Do it again"),
        (COMMAND, Key::D, Do(Action::Duplicate), "Copy what is selected"),
        (NONE, Key::Delete, Do(Action::Delete), "Take out what is selected, or the chosen keys"),
        (COMMAND.plus(Modifiers::SHIFT), Key::C, Do(Action::StoreCamera), "Write this view into the scene"),
        (NONE, Key::F, Do(Action::Frame), "Show what is selected, or all, as large as fits"),
        (Modifiers::ALT, Key::ArrowLeft, Do(Action::StepCamera(true)), "Back to where the camera was before"),
        (Modifiers::ALT, Key::ArrowRight, Do(Action::StepCamera(false)), "Forth again"),
        (NONE, Key::Home, Do(Action::ResetCamera), "Back to the scene's own camera"),
        (NONE, Key::ArrowDown, Do(Action::SelectNext(true)), "Select the next block of the scene"),
        (NONE, Key::ArrowUp, Do(Action::SelectNext(false)), "Select the block before"),
        (NONE, Key::Plus, Do(Action::ChangeSpeed(1.0)), "Fly faster"),
        (NONE, Key::Minus, Do(Action::ChangeSpeed(-1.0)), "Fly slower"),
        (NONE, Key::Num1, Do(Action::Gizmo(Some(Mode::Move))), "Show or hide the arrows that move"),
        (NONE, Key::Num2, Do(Action::Gizmo(Some(Mode::Turn))), "Show or hide the rings that turn"),
        (NONE, Key::Num3, Do(Action::Gizmo(Some(Mode::Scale))), "Show or hide the boxes that scale"),
        (NONE, Key::T, Command::TimeLine, "Show or hide the time line"),
        (NONE, Key::K, Do(Action::Play), "Play the frames, or stop that"),
        (NONE, Key::I, Do(Action::KeySelected), "Set keys for what is selected and has keys"),
        (NONE, Key::Comma, Do(Action::StepFrame(-1)), "Back a frame"),
        (NONE, Key::Period, Do(Action::StepFrame(1)), "On a frame"),
        (Modifiers::SHIFT, Key::Comma, Do(Action::StepKey(false)), "Back to the key before"),
        (Modifiers::SHIFT, Key::Period, Do(Action::StepKey(true)), "On to the next key"),
        (NONE, Key::P, Command::Panels, "Show or hide the panels"),
        (NONE, Key::F1, Command::Help, "Show or hide this list"),
        (NONE, Key::Escape, Command::Escape, "Stop tracing; close what is open"),
    ];
    table
        .into_iter()
        .map(|(modifiers, key, command, about)| Shortcut { modifiers, key, command, about })
        .collect()
}

/// What the keys pressed since the last frame ask for, in their order. While text is typed they are letters and ask for nothing, but
/// that those with Ctrl keep their meaning in the text of the scene; while a widget has the focus, Enter and Space
/// belong to it.
pub fn pressed(ctx: &Context) -> Vec<Command> {
    let focus = ctx.memory(|memory| memory.focused());
    let types_scene = focus == Some(text_editor::id());
    if ctx.text_edit_focused() && !types_scene {
        return Vec::new();
    }
    let is_free = |shortcut: &Shortcut| match focus {
        Some(_) if types_scene => shortcut.modifiers.command || shortcut.key == Key::F1,
        Some(_) => !matches!(shortcut.key, Key::Enter | Key::Space | Key::ArrowUp | Key::ArrowDown),
        None => true,
    };
    let list: Vec<Shortcut> = shortcuts().into_iter().filter(is_free).collect();
    let mut commands = Vec::new();
    ctx.input_mut(|input| {
        input.events.retain(|event| {
            let command = match event {
                // A key that is held down shoots where the pointer goes; see `shoots`.
                Event::Key { key, pressed: true, repeat, modifiers, .. } => meaning(&list, *key, *modifiers)
                    .filter(|command| !(*repeat && *command == Command::DebugRay)),
                _ if types_scene => None,
                // Systems tell of the keys of the clipboard in their own way. Widgets may want to know of them too.
                _ => {
                    commands.extend(of_clipboard(event));
                    None
                }
            };
            let is_taken = command.is_some();
            commands.extend(command);
            !is_taken
        });
    });
    commands
}

/// What a key asks for. Each event says what was held with it: at the end of the frame that may be up again.
fn meaning(list: &[Shortcut], key: Key, modifiers: Modifiers) -> Option<Command> {
    let is_meant = |shortcut: &&Shortcut| {
        let is_plus = modifiers.shift && key == Key::Plus && !modifiers.command;
        shortcut.key == key && (modifiers.matches_exact(shortcut.modifiers) || is_plus)
    };
    list.iter().find(is_meant).map(|shortcut| shortcut.command.clone())
}

/// What an event of the clipboard asks for.
fn of_clipboard(event: &Event) -> Option<Command> {
    match event {
        Event::Copy => Some(Command::Copy),
        Event::Cut => Some(Command::Cut),
        Event::Paste(text) => Some(Command::Do(Action::Paste(text.clone()))),
        _ => None,
    }
}

/// Whether the key that shoots debug rays is down.
pub fn shoots(ctx: &Context) -> bool {
    !ctx.text_edit_focused() && ctx.input(|input| input.key_down(Key::E) && input.modifiers.is_none())
}

/// Which of the keys that fly are down.
pub fn held(ctx: &Context) -> Held {
    if ctx.text_edit_focused() {
        return Held::default();
    }
    ctx.input(|input| {
        let down = |key| input.key_down(key) && !input.modifiers.command && !input.modifiers.alt;
        Held {
            forward: down(Key::W),
            back: down(Key::S),
            left: down(Key::A),
            right: down(Key::D),
            up: down(Key::PageUp),
            down: down(Key::PageDown),
            fast: input.modifiers.shift,
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_key_means_two_things() {
        let all = shortcuts();
        for (i, a) in all.iter().enumerate() {
            for b in &all[..i] {
                assert!(a.key != b.key || a.modifiers != b.modifiers, "{} and {}", a.about, b.about);
            }
            let flies = [Key::W, Key::A, Key::S, Key::D, Key::PageUp, Key::PageDown].contains(&a.key);
            assert!(!flies || a.modifiers != Modifiers::NONE, "{} is on a key that flies", a.about);
        }
    }

    #[test]
    fn the_keys_of_the_course_are_there() {
        let of = |key| shortcuts().into_iter().find(|s| s.key == key).map(|s| s.command);
        assert_eq!(of(Key::Enter), Some(Command::Do(Action::Trace)));
        assert_eq!(of(Key::Space), Some(Command::Do(Action::ToggleShown)));
        assert_eq!(of(Key::E), Some(Command::DebugRay));
        assert_eq!(of(Key::L), Some(Command::ChooseScene));
    }
}
