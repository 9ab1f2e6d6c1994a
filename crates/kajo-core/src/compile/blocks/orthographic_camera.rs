//! `OrthographicCamera`: parallel rays.

use kajo_scene::Params;

use crate::camera::{Camera, OrthographicCamera};
use crate::compile::aim;
use crate::compile::camera_keys::{CAMERA_PARTS, CameraAim, CameraReader, OwnKeys, ShutterKeys, opening};
use crate::compile::fields::{Keys, Sources, keys, number};
use crate::compile::lens::{LensFields, LensKeys};
use crate::compile::member::{CameraMember, Member};
use crate::schema::{Block, Kind};

/// Height of the view of a camera that may stand where it likes.
const USUAL_SIZE: f32 = 1.0;

keys! {
    OrthographicKeys {
        size: Option<f32> = number("size").unit("length").option("height of the picture in the world"),
    }
}

pub const MEMBER: CameraMember = Member {
    block: Block {
        keyword: "OrthographicCamera",
        kind: Kind::Camera,
        about: "parallel rays, as of a plan",
        groups: &[
            aim::AimKeys::FIELDS,
            aim::FIT,
            ShutterKeys::FIELDS,
            OrthographicKeys::FIELDS,
            LensFields::FIELDS,
        ],
        parts: &CAMERA_PARTS,
    },
    read: CameraReader { other_fits: &[], read },
};

fn read<'t>(params: &mut Params<'t, '_>, sources: &mut Sources<'_>, aim: &CameraAim) -> OwnKeys<'t> {
    let keys = OrthographicKeys::read(params, sources);
    let lens = LensKeys::read(params, sources);
    let written = keys.and_then(|keys| keys.size);
    let (size, has_opening) = opening(params, "size", written, USUAL_SIZE, aim);
    warn_of_size(params, size);
    let camera = aim.frame.zip(size).map(|(frame, size)| {
        Camera::Orthographic(OrthographicCamera { frame, size: size.into(), lens: None })
    });
    OwnKeys { has_opening, lens, ..OwnKeys::of(camera) }
}

/// Heights of the view that the formula has an answer for, but nobody means.
fn warn_of_size(params: &mut Params<'_, '_>, size: Option<f32>) {
    match size {
        Some(0.0) => params.warn(
            "size",
            "a view of no size sees nothing but a point; write how much of the scene it sees, such as `size 5`",
            "no size",
        ),
        Some(size) if size < 0.0 => params.warn(
            "size",
            "with a size below 0 the picture stands on its head; write one above 0",
            "below 0",
        ),
        _ => {}
    }
}
