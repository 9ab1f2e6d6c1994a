//! Camera blocks.

use std::borrow::Cow;

use kajo_math::world_line::WorldPoint;
use kajo_math::{DAffine3, DVec3, Motion};
use kajo_scene::{Diagnostic, Diagnostics, Item, Params};

use super::aim::{Aim, Subject};
use super::blocks::CAMERAS as MEMBERS;
use super::camera_keys::{CAMERA_PARTS, CameraAim, OwnKeys, ShutterKeys};
use super::fields::{Keys, Sources};
use super::lens::{Focus, LensKeys};
use super::lorentz::Velocity;
use super::member::keywords;
use super::{Compiler, follow_path, motion, world_line};
use crate::camera::{Camera, CameraFrame, OrthographicCamera};
use crate::motion::{MovingTransform, Shutter};
use crate::scene::CameraMotion;

/// Words that make a camera.
pub(super) const KEYWORDS: [&str; MEMBERS.len()] = keywords(&MEMBERS);

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
    /// How it moves, and when, in a world that has a speed of light.
    pub observer: CameraMotion,
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
        let member = MEMBERS.iter().find(|member| member.block.keyword == item.keyword())?;
        let raw_up = self.rules.raw_up;
        let (name, keys, moves, aim, frames, own) = self.read_keys(item, |params, sources| {
            let name = params.name().map(Cow::into_owned);
            let moves = Moves::take(params);
            let keys = ShutterKeys::read(params, sources);
            let aim = Aim::read(params, sources, member.read.other_fits);
            let is_fitted = aim.as_ref().is_some_and(|aim| aim.fit.is_some());
            let frame = aim.as_ref().map(|aim| known_frame(aim, params, raw_up));
            let own = (member.read.read)(params, sources, &CameraAim { frame, is_fitted });
            let frames = frames_at(item, sources, member.read.other_fits, raw_up);
            Some((name, keys, moves, aim, frames, own))
        })?;
        let ShutterKeys { shutter, rolling: readout, velocity: Velocity(velocity), world_time } = keys?;
        let shutter = self.exposure(shutter);
        let OwnKeys { camera, has_opening, lens: lens_keys, size } = own;
        let focus = lens_keys.as_ref().and_then(LensKeys::subject);
        let lens = lens_keys.and_then(|keys| self.lens(keys));
        if let Some(path) = moves.follows.or(moves.world_line)
            && (aim.as_ref().is_some_and(Aim::needs_scene) || focus.is_some())
        {
            self.diagnostics.push(explain_path(path));
        }
        let own_way = self.changing_frame(item.desc().clock(), |moment| *frames.get(moment)?);
        let evenly = CameraMotion { velocity, time: world_time.into() };
        let (observer, [flown, keyed, followed]) = self.camera_moved(&moves, evenly);
        let motion =
            [flown, keyed, followed, own_way].into_iter().flatten().reduce(|outer, inner| outer.then(&inner));
        // A camera moves while its own shutter is open.
        let motion = motion.map(|motion| MovingTransform::new(motion, shutter));
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
            observer,
            raw_up,
            size,
        })
    }

    /// How a camera moves in a world that has a speed of light, and what else moves it: its world line, its keys, its path.
    ///
    /// * `evenly`: without a world line
    fn camera_moved(
        &mut self,
        moves: &Moves<'_>,
        evenly: CameraMotion,
    ) -> (CameraMotion, [Option<Motion>; 3]) {
        let point = moves.world_line.and_then(|item| world_line::read(item, self.diagnostics));
        let observer =
            point.map_or(evenly, |WorldPoint { event, velocity }| CameraMotion { velocity, time: event.t });
        // An observer stands where it would have been at the moment 0, had it always moved as it does now.
        let flown = point.map(|WorldPoint { event, velocity }| {
            Motion::still(DAffine3::from_translation(event.x - event.t * velocity))
        });
        let keyed = moves.keys.and_then(|item| self.camera_motion(item));
        let followed = moves.follows.map(|item| self.camera_on_path(item));
        (observer, [flown, keyed, followed])
    }

    /// The motion of a camera, which keeps its size.
    fn camera_motion(&mut self, item: Item<'_>) -> Option<Motion> {
        let keys = motion::read(item, self.rules.matrix_by_rows, self.now(), self.diagnostics)?;
        if !keys.is_rigid() {
            let error = Diagnostic::error("a camera can be moved and turned, but not stretched");
            self.diagnostics.push(error.label(item.keyword_span(), "stretches the camera"));
            return None;
        }
        Some(Motion::keyed(keys))
    }

    /// The motion of a camera along a path.
    fn camera_on_path(&mut self, item: Item<'_>) -> Motion {
        let moving = self.changing_operation(item);
        let mut still = || follow_path::read(item, self.diagnostics).unwrap_or(DAffine3::IDENTITY);
        moving.unwrap_or_else(|| Motion::still(still()))
    }
}

/// The blocks that move a camera.
struct Moves<'a> {
    keys: Option<Item<'a>>,
    follows: Option<Item<'a>>,
    world_line: Option<Item<'a>>,
}

impl<'a> Moves<'a> {
    fn take(params: &mut Params<'a, '_>) -> Moves<'a> {
        let [keys, follows, world_line] = CAMERA_PARTS.map(|block| params.block(block.keyword));
        if world_line.is_some() {
            ["velocity", "worldTime"].into_iter().for_each(|key| params.refuse(key, "beside a `WorldLine`"));
        }
        Moves { keys, follows, world_line }
    }
}

/// What is known of the world is not known in the space of a camera on a path.
fn explain_path(path: Item<'_>) -> Diagnostic {
    let error =
        Diagnostic::error("a camera on a path says by numbers where it looks, as if it stood at the origin");
    error
        .label(path.keyword_span(), "moves it from there")
        .help("leave out `fit`, names of objects, and points to focus on; or let `center` and `target` change by keys")
}

/// Where a camera stands and looks at each moment of the clock; nothing for one that does not depend on the time, or whose
/// place is found by what it is to see.
fn frames_at(
    item: Item<'_>,
    sources: &mut Sources<'_>,
    other_fits: &[&str],
    raw_up: bool,
) -> Vec<Option<CameraFrame>> {
    let moments = item.desc().clock().len();
    if moments < 2 || !item.changes() {
        return Vec::new();
    }
    let mut frames = Vec::with_capacity(moments);
    for moment in 0..moments {
        let mut unheard = Diagnostics::new();
        let mut params = Params::new(item.at_moment(moment), &mut unheard);
        params.name();
        let aim = Aim::read(&mut params, sources, other_fits).filter(|aim| !aim.needs_scene());
        frames.push(aim.map(|aim| known_frame(&aim, &mut params, raw_up)));
    }
    let is_still = frames.windows(2).all(|pair| pair[0] == pair[1]);
    if is_still { Vec::new() } else { frames }
}

/// The error of a scene without a camera.
pub(super) fn missing() -> Diagnostic {
    let help = "add, for instance, `PerspectiveCamera { fit scene }`, which sees everything, or one that says where it is: \
                `PerspectiveCamera { center 0 0 10 direction 0 0 -1 up 0 1 0 angle 30 }`";
    Diagnostic::error("the scene has no camera").help(help)
}

/// The camera of scenes that have nothing to see.
pub(super) fn none() -> Camera {
    let frame = CameraFrame::new(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y);
    Camera::Orthographic(OrthographicCamera { frame, size: 2.0, lens: None })
}

/// The frame of a camera that asks for nothing of the scene; any other for one that does.
fn known_frame(aim: &Aim<'_>, params: &mut Params<'_, '_>, raw_up: bool) -> CameraFrame {
    let (Some(center), false) = (aim.center, aim.needs_scene()) else {
        return CameraFrame::new(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y);
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
