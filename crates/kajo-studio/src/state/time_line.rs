//! The time line: which frame is on show, how it plays, and the keys there are.

use std::sync::Arc;
use std::time::Instant;

use kajo_edit::{Edit, FieldValue, KeyOwner, KeyRow, Timing};

use super::chosen_keys::{ChosenKeys, is_same_frame};
use super::long_texts::Task;
use super::{Action, Studio, Version};

/// The time line of the scene on show.
#[derive(Default)]
pub struct TimeLine {
    playing: Option<Playing>,
    /// Whether it begins anew when it has come to its end.
    pub loops: bool,
    /// The keys of the texts, and the version of these.
    rows: Option<(Version, Arc<[KeyRow]>)>,
    timing: Option<(Version, Timing)>,
    pub(super) chosen: ChosenKeys,
    /// Whether it is on show, and with it the keys of fields.
    pub is_shown: bool,
}

/// Frames that follow each other as time goes by.
struct Playing {
    since: Instant,
    /// The frame that was on show then.
    from: i64,
}

impl TimeLine {
    /// The beginning: nothing plays, and what plays begins anew at its end.
    pub(super) fn new() -> TimeLine {
        TimeLine { loops: true, ..TimeLine::default() }
    }

    /// The same for another scene.
    pub(super) fn cleared(&self) -> TimeLine {
        TimeLine { loops: self.loops, ..TimeLine::default() }
    }

    /// Whether it plays.
    pub fn is_playing(&self) -> bool {
        self.playing.is_some()
    }

    /// The keys of the scene, those of each value as a row.
    pub fn rows(&self) -> &[KeyRow] {
        self.rows.as_ref().map_or(&[], |(_, rows)| rows)
    }

    /// The frames of the scene, and the one on show.
    pub fn timing(&self) -> Option<Timing> {
        self.timing.map(|(_, timing)| timing)
    }

    /// Whether the scene changes with time, as far as its text says.
    pub fn has_time(&self) -> bool {
        let is_timed = self.timing().is_some_and(|timing| timing.changes || timing.block.is_some());
        is_timed || !self.rows().is_empty()
    }
}

/// The keys that are chosen.
impl TimeLine {
    /// Whether a key is chosen.
    pub fn is_chosen(&self, owner: &KeyOwner, frame: f64) -> bool {
        self.chosen.keys.iter().any(|(other, at)| other == owner && is_same_frame(*at, frame))
    }

    /// How many keys are chosen.
    pub fn n_chosen(&self) -> usize {
        self.chosen.keys.len()
    }

    /// Whether keys are being dragged.
    pub fn is_dragging(&self) -> bool {
        self.chosen.drag.is_some()
    }

    /// The first of the rows whose keys are chosen.
    pub fn chosen_row(&self) -> Option<&KeyRow> {
        let (owner, _) = self.chosen.keys.first()?;
        self.rows().iter().find(|row| row.owner == *owner)
    }

    pub(super) fn choose_none(&mut self) {
        self.chosen.keys.clear();
    }

    /// Keys that edits have taken away are chosen no longer; while they are dragged, they may pass over others.
    pub(super) fn forget_gone_keys(&mut self) {
        if self.is_dragging() {
            return;
        }
        let mut keys = std::mem::take(&mut self.chosen.keys);
        keys.retain(|(owner, frame)| self.index_of(owner, *frame).is_some());
        self.chosen.keys = keys;
    }

    fn index_of(&self, owner: &KeyOwner, frame: f64) -> Option<usize> {
        self.rows().iter().find(|row| row.owner == *owner)?.key_at(frame)
    }

    /// The chosen keys, with their places in their rows.
    pub(super) fn chosen_keys(&self) -> Vec<(KeyOwner, usize, f64)> {
        let keys = self.chosen.keys.iter();
        keys.filter_map(|(owner, frame)| Some((owner.clone(), self.index_of(owner, *frame)?, *frame)))
            .collect()
    }

    /// The rows of the chosen keys, or this one.
    pub(super) fn rows_meant(&self, owner: Option<KeyOwner>) -> Vec<KeyOwner> {
        let Some(owner) = owner else {
            let mut owners: Vec<KeyOwner> = Vec::new();
            for (owner, _) in &self.chosen.keys {
                if !owners.contains(owner) {
                    owners.push(owner.clone());
                }
            }
            return owners;
        };
        vec![owner]
    }
}

/// The frame that is due.
///
/// * `elapsed`: seconds since `from` was on show
/// * `loops`: whether the first frame follows the last
///
/// Returns also whether it is the end.
fn due(timing: &Timing, from: i64, elapsed: f64, loops: bool) -> (i64, bool) {
    let passed = (elapsed * timing.fps).min(1e15) as i64;
    let count = timing.last - timing.first + 1;
    let place = from.saturating_sub(timing.first).saturating_add(passed);
    match loops {
        true => (timing.first + place.rem_euclid(count), false),
        false => (timing.first + place.min(count - 1), place >= count - 1),
    }
}

impl Studio {
    pub(super) fn time_action(&mut self, action: Action) {
        let Some(timing) = self.time_line.timing() else { return };
        match action {
            Action::ShowFrame(frame) => self.go_to_frame(frame),
            Action::StepFrame(by) => self.go_to_frame(timing.frame.saturating_add(by)),
            Action::StepKey(forward) => self.step_key(&timing, forward),
            Action::Play => self.play(&timing),
            Action::Loop(on) => {
                self.time_line.loops = on;
                self.play_from(timing.frame);
            }
            Action::SetRate(fps) => self.set_timing(&timing, fps, [timing.first, timing.last], "fps"),
            Action::SetFrames(frames) => self.set_timing(&timing, timing.fps, frames, "frames"),
            other => self.key_action(other),
        }
    }

    /// Once a frame of the window: looks at the text, and shows the frame that is due.
    pub(super) fn pass_time(&mut self) {
        let Some(document) = &self.document else {
            return;
        };
        let version = (self.opened, document.generation());
        if self.time_line.timing.is_none_or(|(of, _)| of != version) {
            self.time_line.rows = Some((version, document.key_rows().into()));
            self.time_line.timing = Some((version, document.timing()));
            self.time_line.forget_gone_keys();
        }
        let (Some(playing), Some(timing)) = (&self.time_line.playing, self.time_line.timing()) else {
            return;
        };
        (self.wake)();
        // What takes longer than a frame lasts is shown whole, and others are left out. A drag is one of what is seen.
        let is_held = self.dragged.is_some() || self.grip.is_some() || self.time_line.is_dragging();
        if is_held || self.typing.is_some() || self.is_compiling() {
            return;
        }
        let elapsed = playing.since.elapsed().as_secs_f64();
        let (frame, is_end) = due(&timing, playing.from, elapsed, self.time_line.loops);
        if is_end {
            self.time_line.playing = None;
        }
        self.show_frame(frame);
    }

    fn play(&mut self, timing: &Timing) {
        if self.time_line.playing.take().is_some() {
            return;
        }
        let is_within = (timing.first..=timing.last).contains(&timing.frame);
        // From the end there is nothing left to play.
        let is_at_end = timing.frame == timing.last && !self.time_line.loops;
        let from = if is_within && !is_at_end { timing.frame } else { timing.first };
        self.time_line.playing = Some(Playing { since: Instant::now(), from });
        (self.wake)();
    }

    /// Goes on playing from this frame, if anything plays.
    fn play_from(&mut self, frame: i64) {
        if let Some(playing) = &mut self.time_line.playing {
            *playing = Playing { since: Instant::now(), from: frame };
        }
    }

    fn go_to_frame(&mut self, frame: i64) {
        self.play_from(frame);
        self.show_frame(frame);
    }

    /// Goes to the next key of any value, or to the one before.
    fn step_key(&mut self, timing: &Timing, forward: bool) {
        let frames =
            self.time_line.rows().iter().flat_map(|row| &row.keys).map(|key| key.frame.round() as i64);
        let next = match forward {
            true => frames.filter(|&frame| frame > timing.frame).min(),
            false => frames.filter(|&frame| frame < timing.frame).max(),
        };
        match next {
            Some(frame) => self.go_to_frame(frame),
            None => {
                self.say(if forward { "There is no later key." } else { "There is no earlier key." }, false)
            }
        }
    }

    /// Shows the scene as it is at another frame; a trace that is on show starts anew.
    fn show_frame(&mut self, frame: i64) {
        if self.time_line.timing().is_some_and(|timing| timing.frame == frame) {
            return;
        }
        if self.has_long_text() {
            self.do_beside(Task::ShowFrame(frame));
            return;
        }
        self.end_drag();
        if self.document.as_mut().is_some_and(|document| document.show_frame(frame)) {
            self.pictures.shown = None;
            self.compile();
        }
    }

    /// Writes the rate and the range of frames into the scene: the one that was changed, or both where there is no block
    /// for them yet.
    fn set_timing(&mut self, timing: &Timing, fps: f64, frames: [i64; 2], key: &str) {
        let numbers = match key {
            "fps" => vec![fps],
            _ => frames.map(|frame| frame as f64).to_vec(),
        };
        match timing.block {
            Some(node) => {
                self.begin_drag(node, key, 0);
                self.edit(&Edit::set(node, key, FieldValue::numbers(numbers)));
            }
            None => {
                self.end_drag();
                let [first, last] = frames;
                let block =
                    format!("Animation {{ fps {}  frames {first} {last} }}", kajo_edit::number_text(fps));
                self.edit(&Edit::Add { into: None, block });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_due_as_time_goes_by() {
        let timing = Timing { fps: 10.0, first: 5, last: 8, frame: 5, block: None, changes: true };
        let frames = |from, loops| [0.0, 0.19, 0.25, 0.31, 0.45].map(|t| due(&timing, from, t, loops).0);
        assert_eq!(frames(5, true), [5, 6, 7, 8, 5]);
        assert_eq!(frames(7, true), [7, 8, 5, 6, 7]);
        assert_eq!(frames(6, false), [6, 7, 8, 8, 8]);
        assert!(due(&timing, 6, 0.2, false).1 && !due(&timing, 6, 0.19, false).1);
        assert!(!due(&timing, 6, 1e300, true).1);
        // From frames outside of the range it goes into it.
        assert_eq!((due(&timing, 4, 0.0, true).0, due(&timing, 20, 0.0, false)), (8, (8, true)));
    }
}
