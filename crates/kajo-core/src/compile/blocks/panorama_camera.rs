//! `PanoramaCamera`: all directions, as longitude and latitude.

use kajo_scene::Params;

use crate::camera::{Camera, EyePair, PanoramaCamera};
use crate::compile::aim;
use crate::compile::camera_keys::{
    CAMERA_PARTS, CameraAim, CameraReader, EYE_SEPARATION, OwnKeys, ShutterKeys,
};
use crate::compile::fields::{Keys, Sources, choice, choices, keys};
use crate::compile::member::{CameraMember, Member};
use crate::schema::{Block, Kind};

/// For how many eyes the picture is.
#[derive(Clone, Copy, PartialEq)]
enum Eyes {
    One,
    Two,
}

choices! {
    Eyes {
        "none" => Eyes::One,
        "omnidirectional" => Eyes::Two,
    }
}

keys! {
    PanoramaKeys {
        eye_separation: f32 = EYE_SEPARATION,
        stereo: Eyes = choice::<Eyes>("stereo").or_word("none", "one eye or two"),
    }
}

pub const MEMBER: CameraMember = Member {
    block: Block {
        keyword: "PanoramaCamera",
        kind: Kind::Camera,
        about: "all directions, as longitude and latitude, for one eye or two",
        groups: &[aim::AimKeys::FIELDS, aim::FIT, ShutterKeys::FIELDS, PanoramaKeys::FIELDS],
        parts: &CAMERA_PARTS,
    },
    read: CameraReader { other_fits: &[], read },
};

fn read<'t>(params: &mut Params<'t, '_>, sources: &mut Sources<'_>, aim: &CameraAim) -> OwnKeys<'t> {
    let keys = PanoramaKeys::read(params, sources);
    OwnKeys::of(aim.frame.zip(keys).map(|(frame, keys)| {
        let eyes = EyePair { separation: keys.eye_separation.into() };
        Camera::Panorama(PanoramaCamera { frame, eyes: (keys.stereo == Eyes::Two).then_some(eyes) })
    }))
}
