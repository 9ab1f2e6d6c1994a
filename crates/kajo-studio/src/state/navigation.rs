//! Moving the camera: flying as in a game, and turning around what one looks at.

use kajo::CameraPose;
use kajo_math::{Aabb, DVec2, DVec3, fmath};

/// Radians of turn for a point of the window that the mouse moves.
const TURN: f64 = 0.005;
/// Logarithm of the factor of speed, or of distance, for a notch of the wheel: ln 1.2.
const NOTCH: f64 = 0.182_321_556_793_954_6;
/// How much faster one flies with Shift held.
const HASTE: f64 = 4.0;
/// The slowest and fastest flight, as a share of the scene's size each second.
const SPEEDS: [f64; 2] = [1e-4, 1e2];

/// Which of the keys that move the camera are down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Held {
    /// W
    pub forward: bool,
    /// S
    pub back: bool,
    /// A
    pub left: bool,
    /// D
    pub right: bool,
    /// Page up
    pub up: bool,
    /// Page down
    pub down: bool,
    /// Shift
    pub fast: bool,
}

impl Held {
    /// Whether the camera moves.
    pub fn moves(&self) -> bool {
        self.direction() != DVec3::ZERO
    }

    /// To the right, up and forward; a unit vector, or zero.
    fn direction(&self) -> DVec3 {
        let axis = |plus: bool, minus: bool| f64::from(i8::from(plus) - i8::from(minus));
        let along =
            DVec3::new(axis(self.right, self.left), axis(self.up, self.down), axis(self.forward, self.back));
        along.normalize_or_zero()
    }
}

/// How fast one flies and what one turns around.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Navigation {
    /// World units a second.
    pub speed: f64,
    /// What the camera turns around.
    pub center: DVec3,
    /// Size of the scene, in world units.
    extent: f64,
}

impl Navigation {
    /// A speed that crosses the scene in a few seconds, and the middle of what the camera looks at.
    pub fn of(bounds: Option<&Aabb>, camera: &CameraPose) -> Navigation {
        let bounds = bounds.filter(|bounds| !bounds.is_empty() && bounds.is_finite());
        let extent = bounds.map_or(10.0, |bounds| f64::from(bounds.extent().length()).max(1e-6));
        let distance = bounds.map_or(extent, |bounds| {
            (bounds.center().as_dvec3() - camera.eye()).dot(camera.forward()).max(0.05 * extent)
        });
        Navigation { speed: 0.2 * extent, center: camera.eye() + distance * camera.forward(), extent }
    }

    /// Flies for some time.
    pub fn fly(&mut self, camera: &mut CameraPose, held: Held, seconds: f64) {
        let haste = if held.fast { HASTE } else { 1.0 };
        let before = camera.eye();
        camera.fly(self.speed * haste * seconds * held.direction());
        self.center += camera.eye() - before;
    }

    /// Turns the camera where it stands.
    ///
    /// * `by`: points of the window that the mouse went right and down
    pub fn look(&mut self, camera: &mut CameraPose, by: DVec2) {
        let distance = (self.center - camera.eye()).length();
        camera.turn(TURN * by.x, -TURN * by.y);
        self.center = camera.eye() + distance * camera.forward();
    }

    /// Turns the camera around the centre, so that the scene turns the way the mouse goes.
    pub fn orbit(&mut self, camera: &mut CameraPose, by: DVec2) {
        camera.orbit(self.center, -TURN * by.x, TURN * by.y);
    }

    /// Shifts the camera, so that what is at the centre's distance follows the mouse.
    ///
    /// * `size`: columns and rows of the viewport, in points
    pub fn pan(&mut self, camera: &mut CameraPose, by: DVec2, size: [u32; 2]) {
        let [Some(from), Some(to)] = [DVec2::ZERO, by].map(|place| {
            let middle = DVec2::new(f64::from(size[0]), f64::from(size[1])) / 2.0;
            self.at_center_distance(camera, middle + place, size)
        }) else {
            return;
        };
        camera.set_eye(camera.eye() + from - to);
        self.center += from - to;
    }

    /// Comes nearer to the centre, or goes away from it.
    pub fn zoom(&mut self, camera: &mut CameraPose, notches: f64) {
        let factor = fmath::exp64(-NOTCH * notches);
        match camera.size() {
            Some(size) => camera.set_size(size * factor),
            None => camera.set_eye(self.center + factor * (camera.eye() - self.center)),
        }
    }

    /// Flies faster, or slower for a negative number of notches.
    pub fn change_speed(&mut self, notches: f64) {
        let factor = fmath::exp64(NOTCH * notches);
        self.speed = (self.speed * factor).clamp(SPEEDS[0] * self.extent, SPEEDS[1] * self.extent);
    }

    /// Shows a box as large as fits, and turns around its middle from then on.
    pub fn frame(&mut self, camera: &mut CameraPose, bounds: &Aabb, aspect: f64) {
        if !bounds.is_empty() && bounds.is_finite() {
            camera.frame(bounds, aspect);
            self.center = bounds.center().as_dvec3();
        }
    }

    /// The point under a place of the picture that is as far ahead as the centre.
    fn at_center_distance(&self, camera: &CameraPose, place: DVec2, size: [u32; 2]) -> Option<DVec3> {
        let ray = camera.ray(place, size)?;
        let [o, d] = [ray.o, ray.d].map(|v| v.as_dvec3());
        let ahead = (self.center - o).dot(camera.forward()) / d.dot(camera.forward());
        ahead.is_finite().then(|| o + ahead * d)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_math::Vec3;

    fn camera() -> CameraPose {
        CameraPose::perspective(DVec3::new(0.0, 1.0, 9.0), DVec3::new(0.0, 1.0, 0.0), DVec3::Y, 0.8)
    }

    fn parallel() -> CameraPose {
        CameraPose::orthographic(DVec3::new(0.0, 1.0, 9.0), DVec3::new(0.0, 1.0, 0.0), DVec3::Y, 4.0)
    }

    fn scene() -> Aabb {
        Aabb { min: Vec3::splat(-2.0), max: Vec3::splat(2.0) }
    }

    #[test]
    fn keys_fly_along_the_axes_of_the_camera() {
        let mut camera = camera();
        let mut navigation = Navigation::of(Some(&scene()), &camera);
        navigation.speed = 2.0;
        let cases = [
            (Held { forward: true, ..Held::default() }, DVec3::NEG_Z),
            (Held { back: true, ..Held::default() }, DVec3::Z),
            (Held { left: true, ..Held::default() }, DVec3::NEG_X),
            (Held { right: true, ..Held::default() }, DVec3::X),
            (Held { up: true, ..Held::default() }, DVec3::Y),
            (Held { down: true, ..Held::default() }, DVec3::NEG_Y),
            (Held { up: true, down: true, ..Held::default() }, DVec3::ZERO),
            (Held { right: true, fast: true, ..Held::default() }, HASTE * DVec3::X),
        ];
        for (held, direction) in cases {
            let (before, ahead) = (camera.eye(), navigation.center - camera.eye());
            navigation.fly(&mut camera, held, 0.5);
            assert!((camera.eye() - before - direction).length() < 1e-9, "{held:?}");
            assert!((navigation.center - camera.eye() - ahead).length() < 1e-9);
        }
        assert!(!Held { fast: true, ..Held::default() }.moves());
    }

    #[test]
    fn looking_right_turns_right_and_looking_down_turns_down() {
        let mut camera = camera();
        let mut navigation = Navigation::of(None, &camera);
        navigation.look(&mut camera, DVec2::new(100.0, 50.0));
        assert!(camera.forward().x > 0.3 && camera.forward().y < -0.1, "{}", camera.forward());
        assert_eq!(camera.eye(), DVec3::new(0.0, 1.0, 9.0));
        let ahead = (navigation.center - camera.eye()).normalize();
        assert!((ahead - camera.forward()).length() < 1e-9);
    }

    #[test]
    fn what_is_orbited_stays_in_its_place_of_the_picture() {
        for mut camera in [camera(), parallel()] {
            let mut navigation = Navigation::of(Some(&scene()), &camera);
            let size = [800, 600];
            let before = camera.project(navigation.center, size).unwrap();
            navigation.orbit(&mut camera, DVec2::new(80.0, -30.0));
            let after = camera.project(navigation.center, size).unwrap();
            assert!((before - after).length() < 1e-3, "{before} {after}");
            // The scene turns the way the mouse goes, so the camera goes the other way.
            assert!(camera.eye().x < -1.0, "{}", camera.eye());
        }
    }

    #[test]
    fn panning_carries_the_centre_along_with_the_mouse() {
        for mut camera in [camera(), parallel()] {
            let mut navigation = Navigation::of(Some(&scene()), &camera);
            let (center, size) = (navigation.center, [800, 600]);
            let before = camera.project(center, size).unwrap();
            navigation.pan(&mut camera, DVec2::new(40.0, -25.0), size);
            let moved = camera.project(center, size).unwrap() - before;
            assert!((moved - DVec2::new(40.0, -25.0)).length() < 0.01, "{moved}");
        }
    }

    #[test]
    fn the_wheel_changes_distance_and_speed_within_limits() {
        let mut camera = camera();
        let mut navigation = Navigation::of(Some(&scene()), &camera);
        let distance =
            |camera: &CameraPose, navigation: &Navigation| (camera.eye() - navigation.center).length();
        let before = distance(&camera, &navigation);
        navigation.zoom(&mut camera, 1.0);
        assert!((distance(&camera, &navigation) * 1.2 - before).abs() < 1e-9);
        let mut flat = parallel();
        navigation.zoom(&mut flat, -1.0);
        assert!((flat.size().unwrap() - 4.8).abs() < 1e-9);
        let speed = navigation.speed;
        navigation.change_speed(2.0);
        assert!((navigation.speed / speed - 1.44).abs() < 1e-9);
        for notches in [1e3, -1e3] {
            navigation.change_speed(notches);
            assert!(navigation.speed.is_finite() && navigation.speed > 0.0);
        }
    }

    #[test]
    fn a_framed_box_is_seen_whole() {
        for mut camera in [camera(), parallel()] {
            let mut navigation = Navigation::of(None, &camera);
            let far = Aabb { min: Vec3::new(50.0, 0.0, 50.0), max: Vec3::new(52.0, 4.0, 51.0) };
            navigation.frame(&mut camera, &far, 1.5);
            for corner in [far.min, far.max] {
                let place = camera.project(corner.as_dvec3(), [600, 400]).unwrap();
                assert!(place.x > 0.0 && place.x < 600.0 && place.y > 0.0 && place.y < 400.0, "{place}");
            }
            assert_eq!(navigation.center, far.center().as_dvec3());
            let eye = camera.eye();
            navigation.frame(&mut camera, &Aabb::EMPTY, 1.5);
            assert_eq!(camera.eye(), eye);
        }
    }
}
