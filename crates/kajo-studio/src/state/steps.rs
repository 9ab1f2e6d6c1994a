//! Steps of the camera, to be taken back: each drag, each flight, each jump is one.

use kajo::CameraPose;

use super::{Navigation, Shown, Studio};

/// Steps that can be taken back, at most.
const MOST: usize = 200;

/// Where the camera stood.
#[derive(Clone, Debug)]
pub struct CameraState {
    camera: CameraPose,
    navigation: Navigation,
    version: u64,
    is_home: bool,
}

/// Where the camera was before, and where it was before that was taken back.
#[derive(Clone, Debug, Default)]
pub struct CameraSteps {
    back: Vec<CameraState>,
    forth: Vec<CameraState>,
    /// Numbers of places given out so far.
    used: u64,
    is_moving: bool,
    has_moved: bool,
    /// Steps in a traced picture since the last edit: undo takes these back first.
    newest: usize,
    /// Such steps that were taken back.
    undone: usize,
}

impl CameraSteps {
    /// Whether a drag or a flight goes on.
    pub fn is_moving(&self) -> bool {
        self.is_moving
    }

    /// Once a frame while nothing is held: what does not move has come to its end.
    pub(super) fn rest(&mut self) {
        self.is_moving &= std::mem::take(&mut self.has_moved);
    }

    /// Whether undo is about the camera.
    pub(super) fn can_undo(&self) -> bool {
        self.newest > 0
    }

    /// An edit was made: undo is about that again.
    pub(super) fn edited(&mut self) {
        (self.newest, self.undone) = (0, 0);
    }

    /// Forgets all steps, as for another scene.
    pub(super) fn clear(&mut self) {
        *self = CameraSteps { used: self.used, ..CameraSteps::default() };
    }
}

impl Studio {
    /// Where the camera stands.
    pub(super) fn camera_state(&self) -> CameraState {
        CameraState {
            camera: self.camera.clone(),
            navigation: self.navigation,
            version: self.camera_version,
            is_home: self.is_home,
        }
    }

    /// Notes where the camera stands before it moves, and gives its next place a number.
    ///
    /// * `at_once`: whether it jumps, rather than being dragged or flown
    pub(super) fn begin_camera_step(&mut self, at_once: bool) {
        if at_once || !self.steps.is_moving {
            let place = self.camera_state();
            self.steps.back.push(place);
            if self.steps.back.len() > MOST {
                self.steps.back.remove(0);
            }
            self.steps.forth.clear();
            self.steps.undone = 0;
            self.steps.newest = if self.shown == Shown::Traced { self.steps.newest + 1 } else { 0 };
        }
        self.steps.is_moving = !at_once;
        self.steps.has_moved = !at_once;
        self.pictures.shown = None;
        self.steps.used = self.steps.used.max(self.camera_version) + 1;
        self.camera_version = self.steps.used;
    }

    /// Once a frame while nothing is held.
    pub(super) fn rest_camera(&mut self) {
        if self.steps.is_moving {
            self.steps.rest();
            // There may be something to do once it has come to rest.
            (self.wake)();
        }
    }

    /// Puts the camera where it stood, as a step.
    pub(super) fn go_to(&mut self, place: CameraState) {
        self.begin_camera_step(true);
        self.stand_at(place);
    }

    fn stand_at(&mut self, place: CameraState) {
        let speed = self.navigation.speed;
        self.navigation = place.navigation;
        self.navigation.speed = speed;
        self.camera = place.camera;
        self.camera_version = place.version;
        self.is_home = place.is_home;
        self.fitted_to = None;
        self.steps.is_moving = false;
    }

    /// Takes the last step of the camera back, or does it again. `false` when there is none.
    pub(super) fn step_camera(&mut self, is_back: bool) -> bool {
        let here = self.camera_state();
        let steps = &mut self.steps;
        let (from, to) =
            if is_back { (&mut steps.back, &mut steps.forth) } else { (&mut steps.forth, &mut steps.back) };
        let Some(place) = from.pop() else { return false };
        to.push(here);
        self.stand_at(place);
        true
    }

    /// Takes a step of the camera back, or does it again, if it was made in a traced picture and nothing was edited
    /// since.
    pub(super) fn undo_camera(&mut self, is_back: bool) -> bool {
        let steps = &mut self.steps;
        let (from, to) = if is_back {
            (&mut steps.newest, &mut steps.undone)
        } else {
            (&mut steps.undone, &mut steps.newest)
        };
        if self.shown != Shown::Traced || *from == 0 {
            return false;
        }
        (*from, *to) = (*from - 1, *to + 1);
        self.step_camera(is_back)
    }
}
