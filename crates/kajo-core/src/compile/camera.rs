//! Camera blocks.

use kajo_math::{DVec3, Motion};
use kajo_scene::{Args, Diagnostic, Item, Params};

use super::lens::LensKeys;
use super::{Compiler, motion};
use crate::camera::{
    Camera, EyePair, FisheyeCamera, FisheyeProjection, Frame, MovingCamera, OrthographicCamera,
    PanoramaCamera, PerspectiveCamera, Stereo, StereoCubemapCamera,
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

/// Distance between a grown person's eyes in metres.
const EYE_SEPARATION: f32 = 0.065;

impl Compiler<'_> {
    /// The camera of the scene: the last of several. One must be there when there is something to see.
    pub(super) fn camera(&mut self, items: &[Item<'_>], needed: bool) -> Option<Camera> {
        for pair in items.windows(2) {
            let warning = Diagnostic::warning("the scene has several cameras; the last one counts");
            let earlier = "this one has no effect";
            self.diagnostics
                .push(warning.label(pair[1].keyword_span(), "").label(pair[0].keyword_span(), earlier));
        }
        let Some(&item) = items.last() else {
            if needed {
                let help = "add, for instance, `PerspectiveCamera { center 0 0 10 direction 0 0 -1 up 0 1 0 angle 30 }`";
                self.diagnostics.push(Diagnostic::error("the scene has no camera").help(help));
            }
            let frame = Frame::new(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y);
            return Some(Camera::Orthographic(OrthographicCamera { frame, size: 2.0, lens: None }));
        };
        let raw_up = self.rules.raw_up;
        let (mut lens_keys, mut moves) = (None, None);
        let mut size = None;
        let (mut shutter, mut readout) = (Shutter::default(), 0.0);
        let camera = self.read(item, |params| {
            shutter = motion::shutter(params);
            readout = params.or("rollingShutter", 0.0, |args| args.number_in(0.0..=1.0));
            moves = params.block("Motion");
            let frame = frame(params, raw_up);
            let eyes = |params: &mut Params<'_, '_>| {
                let separation = params.or("eyeSeparation", EYE_SEPARATION, |a| a.number_in(0.0..));
                EyePair { separation: separation.into() }
            };
            Some(match item.keyword() {
                "OrthographicCamera" => {
                    let size = params.required("size", Args::number);
                    warn_of_size(params, size);
                    lens_keys = LensKeys::read(params);
                    Camera::Orthographic(OrthographicCamera { frame: frame?, size: size?.into(), lens: None })
                }
                "PerspectiveCamera" => {
                    let angle = params.required("angle", Args::number);
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
        let lens = lens_keys.and_then(|keys| self.lens(keys));
        (self.shutter, self.readout, self.camera_size) = (shutter, readout, size);
        let moves = moves.and_then(|item| self.camera_motion(item));
        let camera = camera?.with_lens(lens);
        Some(match moves {
            Some(map) => Camera::Moving(Box::new(MovingCamera { camera, map })),
            None => camera,
        })
    }

    /// The motion of a camera, which keeps its size.
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
    let fits = [("corners", true), ("height", false)];
    let to_corners = params.or("fit", false, |a| a.choice(&fits));
    FisheyeCamera { frame, angle: f64::from(angle).to_radians(), projection, to_corners }
}

fn frame(params: &mut Params<'_, '_>, raw_up: bool) -> Option<Frame> {
    let [center, direction, up] = ["center", "direction", "up"].map(|key| params.required(key, Args::vec3));
    let (center, direction, up) = (center?.as_dvec3(), direction?.as_dvec3(), up?.as_dvec3());
    let frame = Frame::new(center, direction, up);
    if frame.right == DVec3::ZERO {
        let (key, why) = if direction == DVec3::ZERO {
            ("direction", "a camera without a `direction` looks nowhere")
        } else {
            ("up", "with `up` along `direction`, or without a length, every pixel sees the same")
        };
        params.warn(key, why, "says too little");
    }
    Some(if raw_up { frame.with_raw_up(up) } else { frame })
}
