//! Everything that can be done, as values.

use std::path::PathBuf;

use kajo::View;
use kajo_edit::handles::Mode;
use kajo_edit::{FieldValue, FileId, Interpolation, KeyOwner, NodeId, Outside};
use kajo_math::{DVec2, DVec3};

use super::Held;

/// Something the user wants.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    // Files.
    /// Opens the scene in this file.
    Open(PathBuf),
    /// Begins a scene of its own.
    New,
    /// Reads the file again.
    Reload,
    /// Ends the program.
    Close,
    /// Offers edits that were left over once more.
    Recover,
    /// Answers the question that stands.
    Answer(Answer),
    /// Writes the text to its file.
    Save,
    /// Writes the text to another file.
    SaveAs(PathBuf),
    /// Writes the picture on show to a file of the kind its name tells; OpenEXR gets every layer.
    Export(PathBuf),
    /// Writes pictures from all around; the number of each goes before the ending.
    Turntable(PathBuf),

    // Tracing.
    /// Traces from the current view with the current settings, and shows it.
    Trace,
    /// Stops tracing; what there is stays.
    Stop,
    /// Shows the preview in place of the trace, or the other way round.
    ToggleShown,
    /// Shows a layer of the trace.
    Show(View),
    /// Keeps the newest picture as it is now.
    KeepPicture,
    /// Forgets the picture with this letter.
    ForgetPicture(char),
    /// Shows the picture with this letter, or the newest trace.
    ShowPicture(Option<char>),
    /// Compares with the picture with this letter, or with the newest of those that are not on show.
    CompareWith(Option<char>),
    /// Shows two pictures together, or one alone.
    Compare(Compare),
    /// Puts the wipe there, as a share of the width.
    Wipe(f32),
    /// Looks from where a picture was traced.
    LookAsIn(char),

    // Questions about a place of the picture, in its pixels from the top left corner.
    /// Chooses what is seen there; beside what is chosen already, if so.
    Pick(DVec2, bool),
    /// Shoots a debug ray there.
    DebugRay(DVec2),
    /// Shoots another sample of the debug ray's pixel, by its number from 0.
    DebugSample(u32),
    /// Takes the debug ray away.
    ClearDebugRay,
    /// Lights up a segment of the debug ray, or none.
    ChooseSegment(Option<usize>),
    /// Lights up the segment of the debug ray that is pointed at, or none.
    HoverSegment(Option<usize>),

    // Camera.
    /// Flies for some seconds.
    Fly(Held, f64),
    /// Turns the camera where it stands; points of the window.
    Look(DVec2),
    /// Turns the camera around what it looks at; points of the window.
    Orbit(DVec2),
    /// Shifts the camera; pixels of the picture.
    Pan(DVec2),
    /// Comes nearer, by notches of the wheel.
    Zoom(f64),
    /// Flies faster, by notches of the wheel.
    ChangeSpeed(f64),
    /// Shows what is selected, or the whole scene, as large as fits.
    Frame,
    /// Goes back to the scene's own camera.
    ResetCamera,
    /// Takes the last step of the camera back, or does it again if not so.
    StepCamera(bool),
    /// Writes the current view into the scene.
    StoreCamera,
    /// Puts the camera there.
    SetEye(DVec3),
    /// Another vertical field of view, in radians.
    SetAngle(f64),
    /// Another height of the picture of parallel rays, in world units.
    SetHeight(f64),

    // Time.
    /// Shows the scene as it is at a frame.
    ShowFrame(i64),
    /// Goes this many frames on, or back.
    StepFrame(i64),
    /// Goes to the next key, or to the one before if not so.
    StepKey(bool),
    /// Plays the frames one after the other, or stops that.
    Play,
    /// Begins anew at the end of the frames, or does not.
    Loop(bool),
    /// Writes another rate of frames into the scene, per second.
    SetRate(f64),
    /// Writes the first and the last frame into the scene.
    SetFrames([i64; 2]),
    /// Chooses these keys, each by its frame; beside those that are chosen already, if so.
    ChooseKeys(Vec<(KeyOwner, f64)>, bool),
    /// Moves what keys are chosen to this many frames from where the drag began.
    DragKeys(i64),
    /// Takes the chosen keys out.
    DeleteKeys,
    /// Sets a key of a value at the frame on show, or takes it out if there is one.
    ToggleKey {
        /// The block.
        node: NodeId,
        /// The field.
        key: String,
        /// Which of several with that key.
        nth: usize,
    },
    /// Sets a key at the frame on show that changes nothing there.
    InsertKey(KeyOwner),
    /// Sets keys at the frame on show for all values of what is selected that have keys.
    KeySelected,
    /// Says how the values of the rows of the chosen keys, or of this row, go from key to key.
    SetInterpolation(Option<KeyOwner>, Interpolation),
    /// Says what holds outside of these keys.
    SetOutside(Option<KeyOwner>, Outside),

    // Selection.
    /// Chooses these nodes.
    Select(Vec<NodeId>),
    /// Chooses a node beside the others, or no longer.
    SelectToo(NodeId),
    /// Chooses the next node of the text, or the one before.
    SelectNext(bool),

    // Edits.
    /// Makes this the text of a file, as the next of the letters that are typed.
    Type {
        /// The file.
        file: FileId,
        /// Its whole text.
        text: String,
    },
    /// What was typed is one step.
    EndTyping,
    /// Adds blocks from a text, such as was copied.
    Paste(String),
    /// Gives a field a value; while it is dragged, its values are one step.
    SetField {
        /// The block.
        node: NodeId,
        /// The field.
        key: String,
        /// Which of several with that key.
        nth: usize,
        /// Its value.
        value: FieldValue,
    },
    /// Makes these all the values of a key that any number may have; while one is dragged, they are one step.
    SetFields {
        /// The block.
        node: NodeId,
        /// Their key.
        key: String,
        /// The values in order.
        values: Vec<FieldValue>,
    },
    /// Takes a field out, so that its default holds.
    UnsetField {
        /// The block.
        node: NodeId,
        /// The field.
        key: String,
        /// Which of several with that key.
        nth: usize,
    },
    /// Shows the gizmo that moves, turns or scales; hides it if it is there.
    Gizmo(Option<Mode>),
    /// Grabs the handle at a place of the picture, if there is one.
    Grab(DVec2),
    /// Drags it there; in round steps, if so.
    DragTo(DVec2, bool),
    /// Takes back what the drag has done.
    CancelDrag,
    /// Ends the drag of a field or handle.
    EndDrag,
    /// Adds a block of this kind where the camera looks, or to the list it belongs to.
    Add(&'static str),
    /// Copies what is selected.
    Duplicate,
    /// Takes out what is selected.
    Delete,
    /// Gives a node a name, or none.
    Rename(NodeId, Option<String>),
    /// Paints what is selected with a material.
    Paint(NodeId),
    /// Moves a node into a group.
    MoveInto(NodeId, NodeId),
    /// Takes the last step back.
    Undo,
    /// Does it again.
    Redo,
}

impl Action {
    /// Whether it is about the time line.
    pub(super) fn is_of_time(&self) -> bool {
        matches!(
            self,
            Action::ShowFrame(_)
                | Action::StepFrame(_)
                | Action::StepKey(_)
                | Action::Play
                | Action::Loop(_)
                | Action::SetRate(_)
                | Action::SetFrames(_)
                | Action::ChooseKeys(..)
                | Action::DragKeys(_)
                | Action::DeleteKeys
                | Action::ToggleKey { .. }
                | Action::InsertKey(_)
                | Action::KeySelected
                | Action::SetInterpolation(..)
                | Action::SetOutside(..)
        )
    }
}

/// What the user decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Nothing is to be done.
    Cancel,
    /// Save the edits first.
    Save,
    /// Give the edits up.
    Drop,
    /// Replace the file.
    Replace,
    /// Take what the other program wrote.
    Theirs,
    /// Keep the edits made here.
    Mine,
    /// Go on with these edits that were left over.
    Recover(usize),
    /// Forget these.
    Forget(usize),
}

/// How two pictures are shown together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compare {
    /// One of them alone.
    #[default]
    Off,
    /// One left of a line, the other right.
    Wipe,
    /// How far they are apart.
    Difference,
}
