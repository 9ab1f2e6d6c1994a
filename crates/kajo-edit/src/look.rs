//! The camera's block after a camera that was moved by hand.

use kajo_math::DVec3;
use kajo_scene::Item;

use super::reshape::{tidy, vector};
use super::tree::Tree;
use super::{EditRefused, FieldValue, Node, TextEdit};
use kajo::CameraPose;
use kajo_core::schema::Kind;

/// Directions that differ by less are the same: far below a pixel.
const SAME_DIRECTION: f64 = 1e-7;

impl Tree {
    /// Makes the scene's camera stand and look as `pose` does. What is the same already stays as it is written.
    pub(super) fn look(&self, pose: &CameraPose) -> Result<Vec<TextEdit>, EditRefused> {
        let opening = match (pose.angle(), pose.size()) {
            (Some(angle), _) => Some(("angle", angle.to_degrees())),
            (None, Some(size)) => Some(("size", size)),
            (None, None) => None,
        };
        let Some(camera) = self.root(Kind::Camera) else {
            let [eye, forward, up] = [pose.eye(), pose.forward(), pose.up()].map(|v| vector(v).text());
            let opening = opening.map_or_else(String::new, |(key, x)| {
                format!("  {key} {}", FieldValue::numbers([tidy(x, 0.0)]).text())
            });
            let block =
                format!("{} {{ center {eye}  direction {forward}  up {up}{opening} }}", pose.keyword());
            return self.add(None, &block);
        };
        let moves = |child: &&Node| ["FollowPath", "WorldLine"].contains(&&*child.keyword);
        if let Some(path) = self.outline.children(Some(camera.id)).find(moves) {
            let message =
                format!("this camera goes along its path: change `{}`, or take it out", path.keyword);
            return Err(EditRefused::new(message));
        }
        let mut aim = AimEdits::of(self, camera);
        aim.place(pose)?;
        if let Some((key, value)) = opening.filter(|_| *camera.keyword == *pose.keyword()) {
            let known = self.number_of(camera, key);
            if known.is_none_or(|known| (known - value).abs() > SAME_DIRECTION * value.abs()) {
                aim.set(key, FieldValue::numbers([tidy(value, 0.0)]))?;
            }
        }
        // A point or an object in focus stays so.
        let known = self
            .value(camera, "focus", None)
            .filter(|focus| focus.word.is_none() && focus.numbers.len() == 1);
        let focus = pose.lens().map(|lens| lens.focus).zip(known.map(|focus| focus.numbers[0]));
        if let Some((focus, known)) = focus
            && (known - focus).abs() > SAME_DIRECTION * focus.abs()
        {
            aim.set("focus", FieldValue::numbers([tidy(focus, 0.0)]))?;
        }
        aim.finish()
    }
}

/// Edits of where a camera stands and looks, however that is written.
struct AimEdits<'a> {
    tree: &'a Tree,
    camera: &'a Node,
    edits: Vec<TextEdit>,
    /// Values that have to be written from now on.
    missing: Vec<(String, FieldValue)>,
    /// What names things to be seen, which a camera that was moved by hand does no longer.
    stale: Vec<Item<'a>>,
}

impl<'a> AimEdits<'a> {
    fn of(tree: &'a Tree, camera: &'a Node) -> AimEdits<'a> {
        let names = |item: &Item<'_>| match item.keyword() {
            "fit" => item.word().is_none_or(|word| !["height", "corners"].contains(&&*word.text())),
            "target" | "lookAt" => item.word().is_some(),
            _ => false,
        };
        let stale = tree.values_of(camera).filter(names).collect();
        AimEdits { tree, camera, edits: Vec::new(), missing: Vec::new(), stale }
    }

    fn set(&mut self, key: &str, value: FieldValue) -> Result<(), EditRefused> {
        if self.tree.value_item(self.camera, key, None).is_none() {
            self.missing.push((key.to_owned(), value));
            return Ok(());
        }
        self.edits.extend(self.tree.set_field(self.camera, key, None, Some(&value))?);
        Ok(())
    }

    fn place(&mut self, pose: &CameraPose) -> Result<(), EditRefused> {
        let old = |key| self.tree.vec3_of(self.camera, key);
        let line = self.tree.numbers_of(self.camera, "lookAt").filter(|line| line.len() >= 6);
        if let Some(line) = line {
            return self.place_line(pose, &line);
        }
        let (center, direction, up) = (old("center"), old("direction"), old("up"));
        let target = ["target", "lookAt"].into_iter().find_map(|key| Some((key, old(key)?)));
        if center.is_none_or(|center| center.as_vec3() != pose.eye().as_vec3()) {
            self.set("center", vector(pose.eye()))?;
        }
        let written = match (target, center) {
            (Some((_, target)), _) => Some(target - pose.eye()),
            (None, _) => direction,
        };
        let same = |v: &DVec3| v.normalize_or_zero().distance(pose.forward()) < SAME_DIRECTION;
        let forward = match (written.filter(same), target) {
            (Some(direction), _) => direction.normalize(),
            (None, Some((key, target))) => {
                // The point looked at stays as far away.
                let distance = center.map_or(1.0, |center| center.distance(target));
                self.set(key, vector(pose.eye() + distance * pose.forward()))?;
                pose.forward()
            }
            (None, None) => {
                self.set("direction", vector(pose.forward()))?;
                pose.forward()
            }
        };
        // The camera makes its own up of any that leads to the same picture.
        let upright = |up: DVec3| forward.cross(up).cross(forward).normalize_or_zero();
        // Beside numbers alone it has to be written.
        let is_needed = up.is_none() && !self.stale.is_empty();
        if is_needed || upright(up.unwrap_or(DVec3::Y)).distance(upright(pose.up())) > SAME_DIRECTION {
            self.set("up", vector(pose.up()))?;
        }
        Ok(())
    }

    /// A `lookAt` of a place, a point and perhaps of what is up.
    fn place_line(&mut self, pose: &CameraPose, line: &[f64]) -> Result<(), EditRefused> {
        let part = |i: usize| line.get(i..i + 3).map(DVec3::from_slice);
        let (Some(eye), Some(target)) = (part(0), part(3)) else { return Ok(()) };
        let up = part(6);
        let moved = eye.as_vec3() != pose.eye().as_vec3();
        let turned = (target - pose.eye()).normalize_or_zero().distance(pose.forward()) >= SAME_DIRECTION;
        let upright = |up: DVec3| pose.forward().cross(up).cross(pose.forward()).normalize_or_zero();
        let rolled = upright(up.unwrap_or(DVec3::Y)).distance(upright(pose.up())) > SAME_DIRECTION;
        if !(moved || turned || rolled) {
            return Ok(());
        }
        let target = if turned { pose.eye() + eye.distance(target) * pose.forward() } else { target };
        let up = if rolled { Some(pose.up()) } else { up };
        let points = [Some(pose.eye()), Some(target), up];
        self.set("lookAt", FieldValue::numbers(points.into_iter().flatten().flat_map(|p| vector(p).numbers)))
    }

    /// What names things gives its place to the numbers that are missing.
    fn finish(mut self) -> Result<Vec<TextEdit>, EditRefused> {
        if self.missing.is_empty() && self.edits.is_empty() {
            return Ok(self.edits);
        }
        let mut stale = self.stale.into_iter();
        if let Some(first) = stale.next().filter(|_| !self.missing.is_empty()) {
            let (file, range) = self.tree.range(first);
            let texts: Vec<String> =
                self.missing.iter().map(|(key, v)| format!("{key} {}", v.text())).collect();
            self.edits.push(TextEdit { file, range, new: texts.join("  ") });
        } else {
            for (key, value) in &self.missing {
                self.edits.extend(self.tree.set_field(self.camera, key, None, Some(value))?);
            }
        }
        for item in stale {
            let (file, range) = self.tree.range(item);
            self.edits.push(TextEdit { file, range, new: String::new() });
        }
        Ok(self.edits)
    }
}
