//! The camera's block after a camera that was moved by hand.

use kajo_math::DVec3;

use super::reshape::{tidy, vector};
use super::schema::Kind;
use super::tree::Tree;
use super::{EditRefused, FieldValue, TextEdit};
use crate::CameraPose;

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
        let old = |key| self.vec3_of(camera, key).unwrap_or_default();
        let mut edits = Vec::new();
        let mut set = |key: &str, value: FieldValue| -> Result<(), EditRefused> {
            edits.extend(self.set_field(camera, key, None, Some(&value))?);
            Ok(())
        };
        if old("center").as_vec3() != pose.eye().as_vec3() {
            set("center", vector(pose.eye()))?;
        }
        let direction = old("direction");
        let forward = if direction.normalize_or_zero().distance(pose.forward()) < SAME_DIRECTION {
            direction.normalize()
        } else {
            set("direction", vector(pose.forward()))?;
            pose.forward()
        };
        // The camera makes its own up of any that leads to the same picture.
        let upright = |up: DVec3| forward.cross(up).cross(forward).normalize_or_zero();
        if upright(old("up")).distance(upright(pose.up())) > SAME_DIRECTION {
            set("up", vector(pose.up()))?;
        }
        if let Some((key, value)) = opening.filter(|_| *camera.keyword == *pose.keyword()) {
            let known = self.number_of(camera, key);
            if known.is_none_or(|known| (known - value).abs() > SAME_DIRECTION * value.abs()) {
                set(key, FieldValue::numbers([tidy(value, 0.0)]))?;
            }
        }
        let focus = pose.lens().map(|lens| lens.focus).zip(self.number_of(camera, "focus"));
        if let Some((focus, known)) = focus
            && (known - focus).abs() > SAME_DIRECTION * focus.abs()
        {
            set("focus", FieldValue::numbers([tidy(focus, 0.0)]))?;
        }
        Ok(edits)
    }
}
