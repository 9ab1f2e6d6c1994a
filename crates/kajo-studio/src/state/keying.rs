//! What is done to keys.

use kajo_edit::{Edit, Interpolation, KeyOwner, Keying, NodeId, Outside};

use super::chosen_keys::{KeyDrag, is_same_frame};
use super::{Action, Studio};

impl Studio {
    pub(super) fn key_action(&mut self, action: Action) {
        match action {
            Action::ChooseKeys(keys, beside) => self.choose_keys(keys, beside),
            Action::DragKeys(by) => self.drag_keys(by),
            Action::DeleteKeys => {
                let keys = self.time_line.chosen_keys();
                if keys.is_empty() {
                    self.say("Choose keys first: click on their marks.", false);
                } else {
                    let keys = keys.into_iter().map(|(owner, index, _)| (owner, index)).collect();
                    self.edit_and_say(&Edit::DeleteKeys(keys));
                }
            }
            Action::ToggleKey { node, key, nth } => self.toggle_key(node, key, nth),
            Action::InsertKey(owner) => self.edit_and_say(&Edit::InsertKey(owner)),
            Action::KeySelected => self.key_selected(),
            Action::SetInterpolation(owner, interpolation) => {
                self.set_modes(owner, Some(interpolation), None)
            }
            Action::SetOutside(owner, outside) => self.set_modes(owner, None, Some(outside)),
            _ => {}
        }
    }

    /// Chooses keys, and with them the block that the last of them is about.
    fn choose_keys(&mut self, keys: Vec<(KeyOwner, f64)>, beside: bool) {
        self.end_drag();
        if !beside {
            self.time_line.choose_none();
        }
        if let Some(node) = keys.last().and_then(|(owner, _)| owner.node())
            && let Some(document) = self.document.as_ref().filter(|_| !self.selection.has(node))
        {
            self.selection.set(vec![node], document);
        }
        for (owner, frame) in keys {
            let all = &mut self.time_line.chosen.keys;
            match all.iter().position(|(other, at)| *other == owner && is_same_frame(*at, frame)) {
                Some(at) => drop(all.remove(at)),
                None => all.push((owner, frame)),
            }
        }
    }

    fn drag_keys(&mut self, by: i64) {
        if !self.time_line.is_dragging() {
            let keys = self.time_line.chosen_keys();
            if by == 0 || keys.is_empty() {
                return;
            }
            self.end_drag();
            let Some(document) = &mut self.document else { return };
            document.begin_gesture(if keys.len() == 1 { "move a key" } else { "move keys" });
            self.time_line.chosen.drag = Some(KeyDrag { keys, by: 0 });
        }
        let Some(drag) = self.time_line.chosen.drag.as_mut().filter(|drag| drag.by != by) else { return };
        drag.by = by;
        let (keys, frames) = (drag.keys.clone(), by as f64);
        let edit = Edit::MoveKeys {
            keys: keys.iter().map(|(owner, index, _)| (owner.clone(), *index)).collect(),
            frames,
        };
        self.edit(&edit);
        // Keys that are back where they were may stand between frames.
        let there = |frame: f64| if by == 0 { frame } else { (frame + frames).round() };
        self.time_line.chosen.keys =
            keys.into_iter().map(|(owner, _, frame)| (owner, there(frame))).collect();
    }

    fn toggle_key(&mut self, node: NodeId, key: String, nth: usize) {
        let Some(document) = &self.document else { return };
        match document.keying(node, &key, nth) {
            Keying::Fixed(why) => self.say(&format!("{key} gets no key: {why}."), true),
            Keying::Keyed { at_frame: true } => {
                let keys = document.keys_here(node, &key, nth);
                self.edit_and_say(&Edit::DeleteKeys(keys));
            }
            Keying::Still | Keying::Keyed { at_frame: false } => {
                self.edit_and_say(&Edit::SetKey { node, key, nth: Some(nth), value: None });
            }
        }
    }

    /// Sets keys for what has some.
    fn key_selected(&mut self) {
        let Some(document) = &self.document else { return };
        let mut edits = Vec::new();
        for &node in self.selection.nodes() {
            for field in document.fields(node) {
                if matches!(document.keying(node, &field.key, field.nth), Keying::Keyed { .. }) {
                    edits.push(Edit::SetKey { node, key: field.key, nth: Some(field.nth), value: None });
                }
            }
        }
        if edits.is_empty() {
            let words = "Nothing that is selected has keys: the mark behind a value, in the Object tab, sets its first.";
            self.say(words, false);
            return;
        }
        self.edit_and_say(&Edit::Together(edits));
    }

    fn set_modes(
        &mut self,
        owner: Option<KeyOwner>,
        interpolation: Option<Interpolation>,
        outside: Option<Outside>,
    ) {
        let owners = self.time_line.rows_meant(owner).into_iter();
        let edits: Vec<Edit> =
            owners.map(|owner| Edit::SetKeyModes { owner, interpolation, outside }).collect();
        if !edits.is_empty() {
            self.edit_and_say(&Edit::Together(edits));
        }
    }
}
