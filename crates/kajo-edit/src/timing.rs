//! The frame that a document shows, and those that its scene has.

use std::sync::Arc;

use kajo_core::schema::Kind;

use super::texts::Change;
use super::tree::{Before, Tree};
use super::{Document, NodeId};

/// The frames of a scene, and the one on show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Frames of a second.
    pub fps: f64,
    /// The frame at time 0.
    pub first: i64,
    /// The last frame: the one that the scene says, or that of the last key, but two seconds at least.
    pub last: i64,
    /// The frame on show.
    pub frame: i64,
    /// The block of the text that says so; `None` where there is none, and the numbers are the usual ones.
    pub block: Option<NodeId>,
    /// Whether anything in the text depends on the time.
    pub changes: bool,
}

impl Timing {
    /// Seconds from time 0 to a frame.
    pub fn seconds(&self, frame: f64) -> f64 {
        (frame - self.first as f64) / self.fps
    }
}

impl Document {
    /// The frames of the scene, and the one on show.
    pub fn timing(&self) -> Timing {
        let tree = &self.tree;
        let clock = tree.desc.clock();
        let first = clock.first_frame();
        let block = tree.root(Kind::Animation);
        let frames = block.and_then(|node| tree.value_item(node, "frames", None));
        let written = frames.and_then(|item| item.numbers().nth(1)).map(|(last, _)| last as i64);
        let last = written.unwrap_or_else(|| {
            let keys = self.key_rows();
            let latest = keys.iter().filter_map(|row| row.keys.last()).map(|key| key.frame.ceil() as i64);
            latest.max().unwrap_or(first).max(first.saturating_add((2.0 * clock.fps()).ceil() as i64 - 1))
        });
        Timing {
            fps: clock.fps(),
            first,
            last: last.max(first),
            frame: clock.frame(),
            block: block.map(|node| node.id),
            changes: tree.desc.changes(),
        }
    }

    /// Shows another frame: what changes with time is as it is then, and the scene has to be compiled anew. Returns
    /// whether there is anything to do.
    ///
    /// A gesture under way ends. Texts and steps stay what they are.
    pub fn show_frame(&mut self, frame: i64) -> bool {
        if frame == self.tree.desc.clock().frame() {
            return false;
        }
        self.end_gesture();
        self.options.frame = Some(frame);
        let old = std::mem::take(&mut self.tree);
        let change = Change::default();
        let before = Before { outline: &old.outline, change: &change, remembered: &[] };
        let clock = old.clock_of(&self.options);
        let parsed =
            Tree::parse(&self.disk, &self.options, clock, &mut self.files, before, &mut self.identities);
        self.tree = Arc::new(parsed);
        self.generation += 1;
        self.frames_shown += 1;
        true
    }

    /// Grows with each change of the texts, and not with the frame on show.
    pub fn text_generation(&self) -> u64 {
        self.generation - self.frames_shown
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use kajo::LoadOptions;

    use super::*;
    use crate::{Edit, FieldValue};

    fn document(animation: &str, radius: &str) -> Document {
        let text = format!(
            "{animation} PerspectiveCamera {{ center 0 0 9  direction 0 0 -1  up 0 1 0  angle 30 }}
            Materials {{ Matte {{ }} }} Group {{ MaterialIndex 0  Sphere {{ center 0 0 0  radius {radius} }} }}"
        );
        Document::untitled(Path::new("."), &text, LoadOptions::default()).unwrap()
    }

    /// The highest point of the scene, to four digits: bounds are a little larger than what is within.
    fn top(document: &mut Document) -> f32 {
        document.compile();
        assert!(document.is_current(), "{}", document.report(false));
        (document.scene().unwrap().geometry.bounds().max.y * 1e4).round() / 1e4
    }

    #[test]
    fn frames_are_those_of_the_text_or_usual_ones() {
        let timing = document("Animation { fps 10  frames 5 9 }", "1").timing();
        assert_eq!((timing.fps, timing.first, timing.last, timing.frame), (10.0, 5, 9, 5));
        assert!(timing.block.is_some() && !timing.changes);
        assert_eq!(timing.seconds(7.0), 0.2);
        let timing = document("", "1").timing();
        assert_eq!((timing.fps, timing.first, timing.last, timing.frame), (24.0, 1, 48, 1));
        assert!(timing.block.is_none() && !timing.changes);
        let timing = document("", "keys { 0: 1  2.49: 2 }").timing();
        assert_eq!((timing.last, timing.changes), (61, true));
        assert_eq!(document("Animation { fps 0 }", "1").timing().fps, 24.0);
    }

    #[test]
    fn a_scene_is_as_it_is_at_the_frame_on_show() {
        for animation in ["", "Animation { }"] {
            let mut document = document(animation, "keys { 0: 1  1: 3 }");
            let text = document.text().to_owned();
            let generation = document.text_generation();
            assert_eq!(top(&mut document), 1.0);
            assert!(document.show_frame(13) && !document.show_frame(13));
            assert!(!document.is_current());
            assert_eq!(top(&mut document), 2.0);
            assert_eq!(document.timing().frame, 13);
            assert!(document.show_frame(-100));
            assert_eq!(top(&mut document), 1.0);
            assert_eq!((document.text(), document.text_generation()), (&*text, generation));
            assert!(!document.undo(), "that is no step");
        }
    }

    /// As the manual says it.
    #[test]
    fn what_is_repeated_once_or_not_at_all_comes_and_goes() {
        let text = "let seen = keys step { 0: 1  1.5: 0 }
            PerspectiveCamera { center 0 0 9  direction 0 0 -1  up 0 1 0  angle 30 }
            Materials { Matte { } }
            Group { MaterialIndex 0  Sphere { center 0 0 0  radius 1 }  repeat once seen { Sphere { center 0 2 0  radius 1 } } }";
        let mut document = Document::untitled(Path::new("."), text, LoadOptions::default()).unwrap();
        for (frame, expected) in [(1, 3.0), (36, 3.0), (37, 1.0), (12, 3.0)] {
            document.show_frame(frame);
            assert_eq!(top(&mut document), expected, "frame {frame}");
        }
        let rows = document.key_rows();
        assert_eq!((&*rows[0].name, rows[0].keys.len()), ("let seen", 2));
    }

    #[test]
    fn frames_go_by_while_a_scene_is_edited_and_nodes_remain_what_they_are() {
        let mut document = document("", "keys { 0: 1  1: 3 }");
        let ball = document.outline().nodes().iter().find(|node| &*node.keyword == "Sphere").unwrap().id;
        document.begin_gesture("drag");
        document.apply(&Edit::set(ball, "center", FieldValue::numbers([0.0, 5.0, 0.0]))).unwrap();
        document.show_frame(25);
        assert!(!document.in_gesture());
        assert_eq!(top(&mut document), 8.0);
        assert_eq!(document.value(ball, "radius"), Some(FieldValue::numbers([3.0])));
        assert!(document.undo() && !document.undo());
        assert_eq!(top(&mut document), 3.0);
    }
}
