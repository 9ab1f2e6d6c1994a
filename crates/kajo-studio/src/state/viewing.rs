//! Actions that move the camera, and what the preview needs of it.

use std::collections::HashSet;
use std::sync::Arc;

use kajo::{CameraPose, Scene};
use kajo_edit::preview::LineKind;
use kajo_math::{DVec2, DVec3};

use super::{Action, Navigation, Studio};
use crate::raster::{Eye, Line};

/// How opaque the edges of what is taken away are.
const DIMMED: u8 = 90;

impl Studio {
    /// From where the raster preview is seen, in a picture of `size` pixels; `None` for cameras whose picture is not flat.
    /// Whether it is the preview on show, [`Studio::is_drawn`] says.
    pub fn eye(&self, size: [u32; 2]) -> Option<Eye> {
        let camera = &self.camera;
        let [near, far] = camera.depths(&self.bounds());
        let clip_from_world = camera.projection(size, near, far)?.as_mat4();
        let is_direction = camera.size().is_some();
        let place = if is_direction { -camera.forward() } else { camera.eye() };
        Some(Eye { clip_from_world, place: place.as_vec3(), is_direction })
    }

    /// Lines over the preview: lights, the scene's camera, the debug ray.
    pub fn lines(&self) -> Vec<Line> {
        // Who looks all around from the scene's camera would see its own wires, and those of a camera that is fitted to
        // another picture stand elsewhere.
        let is_fitted = self.is_home && self.scene().is_some_and(|scene| scene.output.fitted.is_some());
        let is_there = || self.scene().is_some_and(|scene| CameraPose::of(scene).eye() == self.camera.eye());
        let is_inside = is_fitted || !self.camera.is_flat() && is_there();
        let wires = self.preview.iter().flat_map(|(_, preview)| &preview.lines);
        let wires = wires.filter(|wire| !(is_inside && wire.kind == LineKind::Camera));
        // What is taken away is dim, unless it is chosen.
        let chosen = self.chosen_items();
        let wires = wires.map(|wire| {
            let [r, g, b, a] = wire.color;
            let (opacity, width) = match wire.kind {
                LineKind::Subtracted(item) if chosen.contains(&item) => (230, 1.5),
                LineKind::Subtracted(_) => (DIMMED, 1.0),
                LineKind::Light(_) | LineKind::Camera => (a, 1.5),
            };
            Line { from: wire.ends[0].into(), to: wire.ends[1].into(), color: [r, g, b, opacity], width }
        });
        wires.chain(self.ray_lines()).collect()
    }

    /// The items of what is taken away, in the preview, that is chosen or stands in something chosen.
    fn chosen_items(&self) -> HashSet<u32> {
        let (Some(document), Some((_, preview))) = (&self.document, &self.preview) else {
            return HashSet::new();
        };
        let mut items: Vec<u32> = preview.lines.iter().filter_map(|line| line.kind.subtracted()).collect();
        items.dedup();
        let is_chosen = |&item: &u32| {
            let mut node = document.node_of_item(item);
            while let Some(at) = node {
                if self.selection.has(at) {
                    return true;
                }
                node = document.node(at).and_then(|node| node.parent);
            }
            false
        };
        if self.selection.nodes().is_empty() {
            HashSet::new()
        } else {
            items.into_iter().filter(is_chosen).collect()
        }
    }

    /// What is taken away from a solid and has an edge near a place of the picture; see [`LineKind::Subtracted`].
    ///
    /// * `reach`: how near, in pixels
    pub(super) fn subtracted_at(&self, place: DVec2, size: [u32; 2], reach: f64) -> Option<u32> {
        let (_, preview) = self.preview.as_ref()?;
        let distance = |line: &kajo_edit::preview::Line| {
            let [from, to] = line.ends.map(|end| DVec3::from_array(end.map(f64::from)));
            let strokes = self.camera.strokes(from, to, size);
            strokes.into_iter().map(|stroke| distance_to(place, stroke.ends)).fold(f64::INFINITY, f64::min)
        };
        let lines = preview.lines.iter().filter_map(|line| Some((line.kind.subtracted()?, distance(line))));
        let nearest = lines.min_by(|a, b| a.1.total_cmp(&b.1));
        nearest.filter(|&(_, distance)| distance <= reach).map(|(item, _)| item)
    }

    /// Counts the places where the camera stood.
    pub fn camera_version(&self) -> u64 {
        self.camera_version
    }

    pub(super) fn view_action(&mut self, action: Action) {
        match action {
            Action::Fly(held, seconds) => self.move_camera(|n, camera| n.fly(camera, held, seconds)),
            Action::Look(by) => self.move_camera(|n, camera| n.look(camera, by)),
            Action::Orbit(by) => self.move_camera(|n, camera| n.orbit(camera, by)),
            Action::Pan(by) => {
                let size = self.picture_size();
                self.move_camera(|n, camera| n.pan(camera, by, size));
            }
            Action::Zoom(notches) => self.move_camera(|n, camera| n.zoom(camera, notches)),
            Action::ChangeSpeed(notches) => self.navigation.change_speed(notches),
            Action::SetEye(eye) => self.move_camera(|_, camera| camera.set_eye(eye)),
            Action::SetAngle(angle) => self.move_camera(|_, camera| camera.set_angle(angle)),
            Action::SetHeight(size) => self.move_camera(|_, camera| camera.set_size(size)),
            Action::Frame => {
                self.begin_camera_step(true);
                let [width, height] = self.picture_size().map(f64::from);
                let bounds = self.selection_bounds().unwrap_or_else(|| self.bounds());
                self.navigation.frame(&mut self.camera, &bounds, width / height);
                self.is_home = false;
            }
            Action::ResetCamera => {
                if let Some(scene) = self.scene().cloned() {
                    self.begin_camera_step(true);
                    let camera = CameraPose::of(&scene);
                    self.navigation = Navigation::of(Some(&scene.geometry.bounds()), &camera);
                    self.camera = camera;
                    self.is_home = true;
                    self.fitted_to = None;
                    self.fit_camera();
                }
            }
            _ => {}
        }
    }

    /// Fits the scene's own camera to the picture on show, where it is one that fits something.
    ///
    /// The debug ray stays with the point that it has met.
    pub fn fit_camera(&mut self) {
        let is_fitted = |scene: &&Arc<Scene>| self.is_home && scene.output.fitted.is_some();
        let Some(scene) = self.scene().filter(is_fitted).cloned() else { return };
        let size = self.picture_size();
        let aspect = f64::from(size[0]) / f64::from(size[1]);
        let fitted_to = Some((self.version(), aspect));
        if self.fitted_to == fitted_to {
            return;
        }
        let before = std::mem::replace(&mut self.camera, CameraPose::in_picture(&scene, aspect));
        self.fitted_to = fitted_to;
        self.shoot_along(&before, size);
    }

    fn move_camera(&mut self, step: impl FnOnce(&mut Navigation, &mut CameraPose)) {
        self.begin_camera_step(false);
        step(&mut self.navigation, &mut self.camera);
        self.is_home = false;
    }
}

/// The distance of a point from a piece of a line.
fn distance_to(p: DVec2, [a, b]: [DVec2; 2]) -> f64 {
    let (along, w) = (b - a, p - a);
    let length2 = along.length_squared();
    let share = if length2 > 0.0 { (w.dot(along) / length2).clamp(0.0, 1.0) } else { 0.0 };
    (w - share * along).length()
}
