//! Camera blocks.

use std::borrow::Cow;

use kajo_math::{DVec3, Motion};
use kajo_scene::{Args, Diagnostic, Item, Params};

use super::aim::{Aim, Subject};
use super::lens::{Focus, LensKeys};
use super::{Compiler, motion};
use crate::camera::{
    Camera, EyePair, FisheyeCamera, FisheyeProjection, Frame, OrthographicCamera, PanoramaCamera,
    PerspectiveCamera, Stereo, StereoCubemapCamera,
};
use crate::motion::{MovingTransform, Shutter};

/// Words that make a camera.
pub(super) const KEYWORDS: [&str; 5] =
    ["FisheyeCamera", "OrthographicCamera", "PanoramaCamera", "PerspectiveCamera", "StereoCubemapCamera"];

/// Names of fisheye projections.
const PROJECTIONS: [(&str, FisheyeProjection); 4] = [
    ("equidistant", FisheyeProjection::Equidistant),
    ("equisolid", FisheyeProjection::Equisolid),
    ("orthographic", FisheyeProjection::Orthographic),
    ("stereographic", FisheyeProjection::Stereographic),
];

/// What the disk of a fisheye may fill.
const DISK_FITS: [&str; 2] = ["corners", "height"];

/// Angle of view of a camera that may stand where it likes, in degrees.
const USUAL_ANGLE: f32 = 35.0;

/// Distance between a grown person's eyes in metres.
const EYE_SEPARATION: f32 = 0.065;

/// A camera as the scene describes it, before what it names is looked up.
pub(super) struct CameraRequest<'a> {
    pub item: Item<'a>,
    pub name: Option<String>,
    /// The camera as far as it is known: where [`Aim::needs_scene`], without its place.
    pub camera: Camera,
    pub aim: Aim<'a>,
    /// Whether its angle or size was written.
    pub has_opening: bool,
    /// What its lens is to focus on, unless that is a distance.
    pub focus: Option<(Item<'a>, Focus<'a>)>,
    pub motion: Option<MovingTransform>,
    pub shutter: Shutter,
    pub readout: f32,
    /// Whether `up` is taken as it stands.
    pub raw_up: bool,
    /// Columns and rows of the picture, where the camera says them.
    pub size: Option<[u32; 2]>,
}

impl<'a> Compiler<'_> {
    /// The cameras of the scene. One must be there when there is something to see, here or in a model.
    pub(super) fn cameras(&mut self, items: &[Item<'a>], chosen: Option<&str>) -> Vec<CameraRequest<'a>> {
        let is_named = |item: &Item<'_>| item.word().is_some();
        for pair in items.windows(2).filter(|pair| !is_named(&pair[0]) && chosen.is_none()) {
            let warning = Diagnostic::warning("the scene has several cameras; the last one counts");
            let earlier = "this one has no effect, and no name to choose it by";
            self.diagnostics
                .push(warning.label(pair[1].keyword_span(), "").label(pair[0].keyword_span(), earlier));
        }
        items.iter().filter_map(|&item| self.camera(item)).collect()
    }

    fn camera(&mut self, item: Item<'a>) -> Option<CameraRequest<'a>> {
        let raw_up = self.rules.raw_up;
        let (mut lens_keys, mut moves, mut name) = (None, None, None);
        let (mut shutter, mut readout, mut has_opening) = (Shutter::default(), 0.0, true);
        let (mut aim, mut size) = (None, None);
        let camera = self.read(item, |params| {
            name = params.name().map(Cow::into_owned);
            shutter = motion::shutter(params);
            readout = params.or("rollingShutter", 0.0, |args| args.number_in(0.0..=1.0));
            moves = params.block("Motion");
            let others: &[&str] = if item.keyword() == "FisheyeCamera" { &DISK_FITS } else { &[] };
            aim = Aim::read(params, others);
            let is_fitted = aim.as_ref().is_some_and(|aim| aim.fit.is_some());
            let frame = aim.as_ref().map(|aim| known_frame(aim, params, raw_up));
            let eyes = |params: &mut Params<'_, '_>| {
                let separation = params.or("eyeSeparation", EYE_SEPARATION, |a| a.number_in(0.0..));
                EyePair { separation: separation.into() }
            };
            // Without its opening a camera that stands somewhere is given it by what it fits.
            let mut opening = |params: &mut Params<'_, '_>, key, usual: f32| {
                has_opening = params.has(key);
                if is_fitted && !has_opening { Some(usual) } else { params.required(key, Args::number) }
            };
            Some(match item.keyword() {
                "OrthographicCamera" => {
                    let size = opening(params, "size", 1.0);
                    warn_of_size(params, size);
                    lens_keys = LensKeys::read(params);
                    Camera::Orthographic(OrthographicCamera { frame: frame?, size: size?.into(), lens: None })
                }
                "PerspectiveCamera" => {
                    let angle = opening(params, "angle", USUAL_ANGLE);
                    warn_of_angle(params, angle);
                    size = picture_size(params);
                    lens_keys = LensKeys::read(params);
                    Camera::Perspective(PerspectiveCamera::new(frame?, f64::from(angle?).to_radians()))
                }
                "FisheyeCamera" => Camera::Fisheye(fisheye(params, frame?)),
                "PanoramaCamera" => {
                    let eyes = eyes(params);
                    let stereo = params
                        .or("stereo", false, |a| a.choice(&[("none", false), ("omnidirectional", true)]));
                    Camera::Panorama(PanoramaCamera { frame: frame?, eyes: stereo.then_some(eyes) })
                }
                _ => {
                    let kinds = [("twin", Stereo::Twin), ("omnidirectional", Stereo::Omnidirectional)];
                    let eyes = eyes(params);
                    let stereo = params.or("stereo", Stereo::Twin, |a| a.choice(&kinds));
                    Camera::StereoCubemap(StereoCubemapCamera { frame: frame?, eyes, stereo })
                }
            })
        });
        let focus = lens_keys.as_ref().and_then(LensKeys::subject);
        let lens = lens_keys.and_then(|keys| self.lens(keys));
        // What moves with the camera does so while its own shutter is open.
        let scenes = std::mem::replace(&mut self.shutter, shutter);
        let motion = moves.and_then(|item| self.camera_motion(item));
        self.shutter = scenes;
        let camera = camera?.with_lens(lens);
        Some(CameraRequest {
            item,
            name,
            camera,
            aim: aim?,
            has_opening,
            focus,
            motion,
            shutter,
            readout,
            raw_up,
            size,
        })
    }

    /// The motion of a camera, which keeps its size, while the compiler's shutter is open.
    fn camera_motion(&mut self, item: Item<'_>) -> Option<MovingTransform> {
        let keys = motion::read(item, self.rules.matrix_by_rows, self.diagnostics)?;
        if !keys.is_rigid() {
            let error = Diagnostic::error("a camera can be moved and turned, but not stretched");
            self.diagnostics.push(error.label(item.keyword_span(), "stretches the camera"));
            return None;
        }
        Some(MovingTransform::new(Motion::keyed(keys), self.shutter))
    }
}

/// Columns and rows of the picture, which scenes of one course have in their camera.
fn picture_size(params: &mut Params<'_, '_>) -> Option<[u32; 2]> {
    let mut side = |key, other: &str| {
        let read = params.optional(key, |args| Ok((args.int_in(1..=1 << 24)? as u32, args.item())));
        (read, other.to_owned())
    };
    match (side("width", "height"), side("height", "width")) {
        ((Some((width, _)), _), (Some((height, _)), _)) => Some([width, height]),
        ((Some((_, item)), other), (None, _)) | ((None, _), (Some((_, item)), other)) => {
            let error = Diagnostic::error(format!("`{}` needs a `{other}` beside it", item.keyword()));
            params.diagnostics().push(error.label(item.head_span(), "says half of a size"));
            None
        }
        ((None, _), (None, _)) => None,
    }
}

/// The error of a scene that nobody looks at.
pub(super) fn missing() -> Diagnostic {
    let help = "add, for instance, `PerspectiveCamera { fit scene }`, which sees everything, or one that says where it is: \
                `PerspectiveCamera { center 0 0 10 direction 0 0 -1 up 0 1 0 angle 30 }`";
    Diagnostic::error("the scene has no camera").help(help)
}

/// The camera of scenes that have nothing to see.
pub(super) fn none() -> Camera {
    let frame = Frame::new(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y);
    Camera::Orthographic(OrthographicCamera { frame, size: 2.0, lens: None })
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

/// The same of the heights of views without perspective.
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

fn fisheye(params: &mut Params<'_, '_>, frame: Frame) -> FisheyeCamera {
    let projection = params.or("projection", FisheyeProjection::Equidistant, |a| a.choice(&PROJECTIONS));
    let widest = projection.widest_angle().to_degrees();
    let angle = params.or("angle", 180.0, |a| a.number_in(1e-3..=widest));
    let [corners, height] = DISK_FITS;
    let fits = [(corners, true), (height, false)];
    let is_disk = |item: Item<'_>| item.word().is_some_and(|word| DISK_FITS.contains(&&*word.text()));
    let to_corners = params.optional_where("fit", is_disk, |a| a.choice(&fits)).unwrap_or(false);
    FisheyeCamera { frame, angle: f64::from(angle).to_radians(), projection, to_corners }
}

/// The frame of a camera that asks for nothing of the scene; any other for one that does.
fn known_frame(aim: &Aim<'_>, params: &mut Params<'_, '_>, raw_up: bool) -> Frame {
    let (Some(center), false) = (aim.center, aim.needs_scene()) else {
        return Frame::new(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y);
    };
    let direction = match aim.target {
        Some((_, Subject::Point(target))) => target - center,
        _ => aim.direction.unwrap_or(DVec3::NEG_Z),
    };
    let (frame, problem) = aim.frame(center, direction);
    if let Some((key, why)) = problem {
        params.warn(key, why, "says too little");
    }
    if raw_up { frame.with_raw_up(aim.up()) } else { frame }
}
