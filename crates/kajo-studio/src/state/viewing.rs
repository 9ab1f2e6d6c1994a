//! Actions that move the camera, and what the preview needs of it.

use kajo::CameraPose;

use super::{Action, Navigation, Studio};
use crate::raster::{Eye, Line};

impl Studio {
    /// From where the preview is seen, in a picture of `size` pixels; as if from a pinhole camera, where the camera
    /// makes no flat picture.
    pub fn eye(&self, size: [u32; 2]) -> Option<Eye> {
        let camera = self.camera.flat();
        let [near, far] = self.depths(&camera);
        let clip_from_world = camera.projection(size, near, far)?.as_mat4();
        let is_direction = camera.size().is_some();
        let place = if is_direction { -camera.forward() } else { camera.eye() };
        Some(Eye { clip_from_world, place: place.as_vec3(), is_direction })
    }

    /// The depths that the preview shows: all of the scene, and no nearer than a small share of it.
    fn depths(&self, camera: &CameraPose) -> [f64; 2] {
        let bounds = self.bounds();
        let (center, radius) = (bounds.center().as_dvec3(), f64::from(bounds.extent().length()) / 2.0);
        let ahead = (center - camera.eye()).dot(camera.forward());
        // Planes reach beyond the box.
        let away = (center - camera.eye()).length();
        let reach = 8.0 * radius.max(1e-3).max(away);
        let far = (ahead + reach).max(1e-2 * reach);
        if camera.size().is_some() { [ahead - reach, far] } else { [(1e-4 * far).max(1e-6), far] }
    }

    /// Lines over the preview: lights, the scene's camera, the debug ray.
    pub fn lines(&self) -> Vec<Line> {
        let wires = self.preview.iter().flat_map(|(_, preview)| &preview.lines);
        let wires = wires.map(|wire| Line {
            from: wire.ends[0].into(),
            to: wire.ends[1].into(),
            color: wire.color,
            width: 1.5,
        });
        wires.chain(self.ray_lines()).collect()
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
                let [width, height] = self.picture_size().map(f64::from);
                let bounds = self.selection_bounds().unwrap_or_else(|| self.bounds());
                self.move_camera(|n, camera| n.frame(camera, &bounds, width / height));
            }
            Action::ResetCamera => {
                if let Some(scene) = self.scene() {
                    let camera = CameraPose::of(scene);
                    self.navigation = Navigation::of(Some(&scene.bounds()), &camera);
                    self.camera = camera;
                    self.camera_version += 1;
                    self.is_home = true;
                }
            }
            _ => {}
        }
    }

    fn move_camera(&mut self, step: impl FnOnce(&mut Navigation, &mut CameraPose)) {
        step(&mut self.navigation, &mut self.camera);
        self.camera_version += 1;
        self.is_home = false;
    }
}
