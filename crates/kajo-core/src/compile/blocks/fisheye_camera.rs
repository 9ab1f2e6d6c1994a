//! `FisheyeCamera`: half of all directions or more, as a disk.

use kajo_scene::{Args, Item, Params};

use crate::camera::{Camera, FisheyeCamera, FisheyeProjection};
use crate::compile::aim;
use crate::compile::camera_keys::{CAMERA_PARTS, CameraAim, CameraReader, OwnKeys, ShutterKeys};
use crate::compile::fields::{
    Choice, Defaulted, Field, Given, Keys, Sources, choice, choices, degrees, keys,
};
use crate::compile::member::{CameraMember, Member};
use crate::schema::{Block, FieldSpec, Kind};

choices! {
    FisheyeProjection {
        "equidistant" => FisheyeProjection::Equidistant,
        "equisolid" => FisheyeProjection::Equisolid,
        "orthographic" => FisheyeProjection::Orthographic,
        "stereographic" => FisheyeProjection::Stereographic,
    }
}

/// What the disk fills.
#[derive(Clone, Copy, PartialEq)]
enum DiskFit {
    /// The whole picture, corners included.
    Corners,
    /// The height of the picture.
    Height,
}

choices! {
    DiskFit {
        "corners" => DiskFit::Corners,
        "height" => DiskFit::Height,
    }
}

keys! {
    FisheyeKeys<'t> {
        angle: Given<'t, f32> = degrees("angle", 1e-3, 360.0).or(180.0, "width of the disk").given(),
        projection: FisheyeProjection =
            choice::<FisheyeProjection>("projection").or_word("equidistant", "how angles become distances"),
    }
}

/// The key is also that of what fills the picture.
const FIT: Defaulted<DiskFit> =
    choice("fit").or_word("height", "what the disk fills, or what fills the picture");
const FIT_FIELDS: &[FieldSpec] = &[FIT.spec()];

pub const MEMBER: CameraMember = Member {
    block: Block {
        keyword: "FisheyeCamera",
        kind: Kind::Camera,
        about: "half of all directions or more, as a disk",
        groups: &[aim::AimKeys::FIELDS, ShutterKeys::FIELDS, FisheyeKeys::FIELDS, FIT_FIELDS],
        parts: &CAMERA_PARTS,
    },
    read: CameraReader { other_fits: DiskFit::WORDS, read },
};

fn read<'t>(params: &mut Params<'t, '_>, sources: &mut Sources<'_>, aim: &CameraAim) -> OwnKeys<'t> {
    let keys = FisheyeKeys::read(params, sources);
    let is_disk = |item: Item<'_>| item.word().is_some_and(|word| DiskFit::WORDS.contains(&&*word.text()));
    let fit = FIT.read_where(params, sources, is_disk);
    let (Some(keys), Some(fit)) = (keys, fit) else { return OwnKeys::of(None) };
    let FisheyeKeys { angle, projection } = keys;
    // Which angles there are depends on the projection.
    let widest = projection.widest_angle().to_degrees();
    let too_wide = angle.item.filter(|_| f64::from(angle.value) > widest);
    if let Some(item) = too_wide {
        Args::read(item, params.diagnostics(), |args| args.number_in(1e-3..=widest));
    }
    let camera = aim.frame.map(|frame| {
        let angle = f64::from(angle.value).to_radians();
        Camera::Fisheye(FisheyeCamera { frame, angle, projection, to_corners: fit == DiskFit::Corners })
    });
    OwnKeys::of(camera)
}
