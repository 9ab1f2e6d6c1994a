//! What every camera can do.

use kajo_math::{Aabb, DVec2, DVec3, Ray, Vec2, Vec3};

use super::fit::{Fit, FitError, FitSpace};
use super::origins::around_eyes;
use super::{Camera, CameraFrame, Connection, Importance, ThinLens};

/// A kind of camera, at rest. What it does not say is what a camera without a lens is like, with whose picture nothing can be connected.
pub(super) trait CameraModel {
    /// The word that makes one in a scene.
    fn keyword(&self) -> &'static str;

    /// Whether its own numbers are finite, those of its frame and its lens left out.
    fn is_finite(&self) -> bool;

    /// Position and axes.
    fn frame(&self) -> &CameraFrame;

    /// Moves it to another position and other axes.
    fn set_frame(&mut self, frame: CameraFrame);

    /// See [`Camera::ray`].
    fn ray(&self, at: Vec2, aspect: f32, lens: Vec2) -> Option<Ray>;

    /// The lens, if there is one.
    fn lens(&self) -> Option<&ThinLens> {
        None
    }

    /// Puts a lens in place of the pinhole, where it can have one.
    fn set_lens(&mut self, _lens: Option<ThinLens>) {}

    /// See [`Camera::apex`].
    fn apex(&self) -> Option<Vec3> {
        None
    }

    /// See [`Camera::cells`].
    fn cells(&self) -> [u32; 2] {
        [1, 1]
    }

    /// See [`Camera::has_extent`].
    fn has_extent(&self) -> bool {
        false
    }

    /// See [`Camera::natural_aspect`].
    fn natural_aspect(&self) -> Option<f32> {
        None
    }

    /// See [`Camera::origins`].
    fn origins(&self, _positions: [Vec2; 2], _aspect: f32) -> Option<Aabb> {
        Some(around_eyes(self.frame(), None))
    }

    /// See [`Camera::project`]; of a point by right, up and forward.
    fn project(&self, _local: DVec3, _aspect: f64) -> Option<DVec2> {
        None
    }

    /// Whether it shows everything twice, to the left and to the right eye.
    fn has_two_eyes(&self) -> bool {
        false
    }

    /// Where an eye sees a point of the world.
    ///
    /// * `side`: -1 for the left eye, 1 for the right
    fn project_eye(&self, _p: DVec3, _side: f64) -> Option<DVec2> {
        None
    }

    /// See [`Fit::apply`].
    ///
    /// * `inside`: the share of the picture that is to be filled
    fn fitted(&self, _fit: &Fit, _space: &FitSpace<'_>, _inside: f64) -> Result<Camera, FitError> {
        Err(FitError::SeesAll)
    }

    /// See [`Camera::is_connectable`].
    fn is_connectable(&self) -> bool {
        false
    }

    /// See [`Camera::importance`].
    fn importance(&self, _o: DVec3, _d: DVec3, _aspect: f32) -> Option<Importance> {
        None
    }

    /// See [`Camera::sample_origin`].
    fn sample_origin(&self, _u: Vec2, _aspect: f32) -> Option<DVec3> {
        None
    }

    /// See [`Camera::connect`].
    fn connect(&self, _p: DVec3, _lens: Vec2, _aspect: f32) -> Option<Connection> {
        None
    }

    /// See [`Camera::pdf_across`].
    fn pdf_across(&self, _o: DVec3, _d: DVec3, _distance: f32, _aspect: f32) -> Option<f32> {
        None
    }
}
