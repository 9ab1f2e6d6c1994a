//! `PerspectiveCamera`: rays from one point, or from a lens.

use kajo_scene::{Diagnostic, Params};

use crate::camera::{Camera, PerspectiveCamera};
use crate::compile::aim;
use crate::compile::camera_keys::{CAMERA_PARTS, CameraAim, CameraReader, OwnKeys, ShutterKeys, opening};
use crate::compile::fields::{At, Keys, Sources, any_angle, count, keys};
use crate::compile::lens::{LensFields, LensKeys};
use crate::compile::member::{CameraMember, Member};
use crate::schema::{Block, Kind};

/// Angle of view of a camera that may stand where it likes, in degrees.
const USUAL_ANGLE: f32 = 35.0;

/// The most columns or rows of a picture.
const MOST_PIXELS: u32 = 1 << 24;

keys! {
    PerspectiveKeys<'t> {
        angle: Option<f32> = any_angle("angle").option("field of view from bottom to top"),
        width: Option<At<'t, u32>> = count("width", 1, MOST_PIXELS)
            .unit("pixels")
            .placed()
            .option("columns of the picture, if nothing else says them"),
        height: Option<At<'t, u32>> = count("height", 1, MOST_PIXELS)
            .unit("pixels")
            .placed()
            .option("rows of the picture, if nothing else says them"),
    }
}

pub const MEMBER: CameraMember = Member {
    block: Block {
        keyword: "PerspectiveCamera",
        kind: Kind::Camera,
        about: "rays from one point, or from a lens, spread over an angle",
        groups: &[
            aim::AimKeys::FIELDS,
            aim::FIT,
            ShutterKeys::FIELDS,
            PerspectiveKeys::FIELDS,
            LensFields::FIELDS,
        ],
        parts: &CAMERA_PARTS,
    },
    read: CameraReader { other_fits: &[], read },
};

fn read<'t>(params: &mut Params<'t, '_>, sources: &mut Sources<'_>, aim: &CameraAim) -> OwnKeys<'t> {
    let keys = PerspectiveKeys::read(params, sources);
    let lens = LensKeys::read(params, sources);
    let Some(PerspectiveKeys { angle, width, height }) = keys else { return OwnKeys::of(None) };
    let (angle, has_opening) = opening(params, "angle", angle, USUAL_ANGLE, aim);
    warn_of_angle(params, angle);
    let size = picture_size(params, width, height);
    let camera = aim.frame.zip(angle).map(|(frame, angle)| {
        Camera::Perspective(PerspectiveCamera::new(frame, f64::from(angle).to_radians()))
    });
    OwnKeys { has_opening, lens, size, ..OwnKeys::of(camera) }
}

/// Columns and rows of the picture, which scenes of one course have in their camera.
fn picture_size(
    params: &mut Params<'_, '_>,
    width: Option<At<'_, u32>>,
    height: Option<At<'_, u32>>,
) -> Option<[u32; 2]> {
    let (half, other) = match (width, height) {
        (Some(width), Some(height)) => return Some([width.value, height.value]),
        (Some(width), None) => (width, "height"),
        (None, Some(height)) => (height, "width"),
        (None, None) => return None,
    };
    let error = Diagnostic::error(format!("`{}` needs a `{other}` beside it", half.item.keyword()));
    params.diagnostics().push(error.label(half.item.head_span(), "says half of a size"));
    None
}

/// Angles of view that the formula has an answer for, as the course's program, but nobody means.
fn warn_of_angle(params: &mut Params<'_, '_>, degrees: Option<f32>) {
    let Some(degrees) = degrees else { return };
    // The width of the picture at the distance 1 is twice the tangent of half of it.
    let message = match degrees.rem_euclid(360.0) {
        0.0 => {
            "a camera with an angle of 0 sees nothing but a point; write how much it sees, such as `angle 40`"
        }
        180.0 => {
            "a plane picture cannot hold half of all directions; write less than 180, or a `FisheyeCamera`"
        }
        angle if angle > 180.0 => {
            "with an angle below 0 or above 180 the picture stands on its head; write one between them"
        }
        _ if !(0.0..180.0).contains(&degrees) => {
            "angles of view lie between 0 and 180; whole turns have no effect"
        }
        _ => return,
    };
    params.warn("angle", message, "no angle of view");
}
