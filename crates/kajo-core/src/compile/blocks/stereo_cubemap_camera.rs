//! `StereoCubemapCamera`: all directions, as twelve squares for two eyes.

use kajo_scene::Params;

use crate::camera::{Camera, EyePair, Stereo, StereoCubemapCamera};
use crate::compile::aim;
use crate::compile::camera_keys::{
    CAMERA_PARTS, CameraAim, CameraReader, EYE_SEPARATION, OwnKeys, ShutterKeys,
};
use crate::compile::fields::{Keys, Sources, choice, choices, keys};
use crate::compile::member::{CameraMember, Member};
use crate::schema::{Block, Kind};

choices! {
    Stereo {
        "twin" => Stereo::Twin,
        "omnidirectional" => Stereo::Omnidirectional,
    }
}

keys! {
    StereoCubemapKeys {
        eye_separation: f32 = EYE_SEPARATION,
        stereo: Stereo = choice::<Stereo>("stereo").or_word("twin", "how eyes turn"),
    }
}

pub const MEMBER: CameraMember = Member {
    block: Block {
        keyword: "StereoCubemapCamera",
        kind: Kind::Camera,
        about: "all directions, as twelve squares for two eyes",
        groups: &[aim::AimKeys::FIELDS, aim::FIT, ShutterKeys::FIELDS, StereoCubemapKeys::FIELDS],
        parts: &CAMERA_PARTS,
    },
    read: CameraReader { other_fits: &[], read },
};

fn read<'t>(params: &mut Params<'t, '_>, sources: &mut Sources<'_>, aim: &CameraAim) -> OwnKeys<'t> {
    let keys = StereoCubemapKeys::read(params, sources);
    OwnKeys::of(aim.frame.zip(keys).map(|(frame, keys)| {
        let eyes = EyePair { separation: keys.eye_separation.into() };
        Camera::StereoCubemap(StereoCubemapCamera { frame, eyes, stereo: keys.stereo })
    }))
}
