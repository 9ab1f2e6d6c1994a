//! What the kinds of cameras say of their own.

use kajo_scene::Params;

use super::fields::{Defaulted, Sources, Typed, at_least, between, keys, number};
use super::lens::LensKeys;
use super::lorentz::{self, Velocity};
use super::motion::{self, usual_shutter};
use super::{follow_path, world_line};
use crate::camera::{Camera, CameraFrame};
use crate::motion::Shutter;
use crate::schema::{Block, Constant, FieldKind, NumberRange};

/// The blocks that move a camera: by keys, along a path, by its own clock.
pub(super) const CAMERA_PARTS: [&Block; 3] = [&motion::BLOCK, &follow_path::BLOCK, &world_line::BLOCK];

/// What reads the keys that a kind of camera has of its own.
pub(super) struct CameraReader {
    /// Words after `fit` that mean something else to this camera.
    pub other_fits: &'static [&'static str],
    pub read: for<'t> fn(&mut Params<'t, '_>, &mut Sources<'_>, &CameraAim) -> OwnKeys<'t>,
}

/// Where a camera stands and looks, as far as that is known before the scene is.
pub(super) struct CameraAim {
    pub frame: Option<CameraFrame>,
    /// Whether what it sees is found by what it is to see.
    pub is_fitted: bool,
}

/// What a kind of camera says of its own.
pub(super) struct OwnKeys<'t> {
    pub camera: Option<Camera>,
    /// Whether its angle or size was written.
    pub has_opening: bool,
    pub lens: Option<LensKeys<'t>>,
    /// Columns and rows of the picture.
    pub size: Option<[u32; 2]>,
}

impl OwnKeys<'_> {
    /// A camera that says nothing else.
    pub fn of(camera: Option<Camera>) -> OwnKeys<'static> {
        OwnKeys { camera, has_opening: true, lens: None, size: None }
    }
}

keys! {
    pub ShutterKeys {
        shutter: Option<Shutter> = Typed::<Shutter>::new("shutter", FieldKind::Numbers(&[NumberRange::ANY; 2])).ruled(
            usual_shutter,
            "0 1; 0 0.5 in an animation",
            "from when to when light is gathered; in an animation in frames",
        ),
        rolling: f32 = between("rollingShutter", 0.0, 1.0)
            .or(0.0, "the share of that time in which rows open one after the other"),
        velocity: Velocity = lorentz::VELOCITY
            .otherwise(Constant::Triple([0.0; 3]), "how it moves, as a fraction of the speed of light"),
        world_time: f32 = number("worldTime")
            .or(0.0, "moment of the picture for what moves in `Lorentz`, in lengths that light goes"),
    }
}

/// Distance between the eyes, which is that of a grown person's in metres.
pub(super) const EYE_SEPARATION: Defaulted<f32> =
    at_least("eyeSeparation", 0.0).unit("length").or(0.065, "distance between the eyes");

/// How much a camera sees, and whether that was written: what is usual where it is found by what the camera is to see.
pub(super) fn opening(
    params: &mut Params<'_, '_>,
    key: &'static str,
    written: Option<f32>,
    usual: f32,
    aim: &CameraAim,
) -> (Option<f32>, bool) {
    let has_opening = params.contains(key);
    if aim.is_fitted && !has_opening {
        return (Some(usual), false);
    }
    if written.is_none() {
        params.report_missing(key);
    }
    (written, has_opening)
}
