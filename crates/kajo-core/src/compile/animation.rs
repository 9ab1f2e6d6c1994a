//! The `Animation` block, and the moments of a frame for which a text is evaluated.
//!
//! Scene: `Animation { fps 24  frames 1 240 }`
//!
//! The first of the frames is at time 0, so frame `k` is at `(k - first) / fps` seconds. Its shutter is open from `open` to
//! `close`, counted in frames from that time. Within a compiled scene times are seconds from the frame, so that two frames
//! which show the same are the same to the bit.
//!
//! Whatever moves for being a function of the time is evaluated at [`STEPS`] + 1 moments of the shutter, between which
//! [`Keyframes`] lead: a rotation at constant speed and a translation along a line are exact, and of a circle with the
//! share `a` of a turn in a frame the error is `1 - cos(pi a / STEPS)` of its radius, 1 % for 4/10 of a turn.

use kajo_math::{DAffine3, DMat3, DVec3, Keyframes, Motion};
use kajo_scene::{Args, Clock, Diagnostic, Diagnostics, Item, SceneDesc};

use super::blocks::CAMERAS;
use super::blocks::animation::{self, FPS, FRAMES, KEYWORD, frame_range};
use super::motion::USUAL_SHUTTER;
use super::{CompileOptions, Compiler, operations};
use crate::animation::Animation;
use crate::camera::CameraFrame;
use crate::motion::Shutter;

const SHUTTER: &str = "shutter";

/// Parts of the shutter's time, at the ends of which what moves is evaluated.
const STEPS: u32 = 8;

/// The animation of a scene whose frames are asked for, or which says that it has some; `None` for any other.
///
/// What is wrong with the block is said when the scene is compiled.
///
/// * `desc`: the scene, evaluated at any time
/// * `options`: the frame and the rate that are asked for
pub fn animation_of(desc: &SceneDesc, options: &CompileOptions) -> Option<Animation> {
    let block = desc.roots().filter(|item| item.keyword() == KEYWORD).last();
    let child = |key: &str| block?.children().filter(|item| item.keyword() == key).last();
    let unheard = &mut Diagnostics::new();
    let fps = child(FPS).and_then(|item| Args::read(item, unheard, Args::positive));
    let frames = child(FRAMES).and_then(|item| Args::read(item, unheard, frame_range)).map(|range| range.0);
    asked(options, block.map(|_| (fps.map(f64::from), frames)))
}

/// The animation that a scene says it has, if it does, as far as its rate and frames could be read; or that is asked for.
fn asked(options: &CompileOptions, block: Option<(Option<f64>, Option<[i64; 2]>)>) -> Option<Animation> {
    if block.is_none() && options.frame.is_none() && options.fps.is_none() {
        return None;
    }
    let (fps, frames) = block.unwrap_or_default();
    let fps = options.fps.or(fps).unwrap_or(kajo_scene::USUAL_FPS);
    let animation = Animation { fps, frames, frame: 0 };
    Some(Animation { frame: options.frame.unwrap_or(animation.first_frame()), ..animation })
}

/// The moments for which the text of a scene with an animation has to be evaluated; `None` for any other scene.
///
/// They are the frame's, those of the shutter of the camera that takes the picture, and time 0, at which patterns are
/// painted on what moves.
///
/// * `desc`, `options`: as for [`animation_of`]
pub fn clock_of(desc: &SceneDesc, options: &CompileOptions) -> Option<Clock> {
    let animation = animation_of(desc, options)?;
    let is_camera = |item: &Item<'_>| CAMERAS.iter().any(|member| member.block.keyword == item.keyword());
    let cameras: Vec<Item<'_>> = desc.roots().filter(is_camera).collect();
    let is_named =
        |item: &&Item<'_>| item.word().map(|word| word.text()).as_deref() == options.camera.as_deref();
    let named = options.camera.as_ref().and_then(|_| cameras.iter().rfind(is_named));
    let written = named.or(cameras.last()).and_then(|camera| {
        let item = camera.children().filter(|item| item.keyword() == SHUTTER).last()?;
        Args::read(item, &mut Diagnostics::new(), |args| Ok([args.double()?, args.double()?]))
    });
    let [open, close] = written.filter(|[open, close]| close >= open).unwrap_or(USUAL_SHUTTER);
    let steps = if close > open { STEPS } else { 0 };
    let share = |i: u32| f64::from(i) / f64::from(STEPS);
    let clock = Clock::new(animation.fps, animation.first_frame(), animation.frame);
    let start = (animation.first_frame() - animation.frame) as f64;
    let moments = (0..=steps).map(|i| open + (close - open) * share(i)).chain([start]);
    Some(clock.with_moments(moments))
}

impl Compiler<'_> {
    /// Takes the animation of the scene, whose block may be there.
    pub(super) fn animation(&mut self, item: Option<Item<'_>>) {
        let block = item.map(|item| {
            if item.changes() {
                let error = Diagnostic::error("the frames of a scene are the same at all times");
                self.diagnostics.push(error.label(item.keyword_span(), "depends on the time"));
            }
            let read = self.read_keys(item, animation::read);
            read.map_or((None, None), |(fps, frames)| (Some(fps), frames))
        });
        self.animation = asked(self.options, block);
    }

    /// When a camera gathers light: in seconds from the frame, for which its numbers are frames.
    pub(super) fn exposure(&self, written: Option<Shutter>) -> Shutter {
        let Some(animation) = &self.animation else { return written.unwrap_or_default() };
        let [open, close] = written.map_or(USUAL_SHUTTER, |shutter| shutter.interval());
        Shutter { open: open / animation.fps, close: close / animation.fps, painted: -animation.seconds() }
    }

    /// Seconds from time 0 to what is time 0 in the compiled scene.
    pub(super) fn now(&self) -> f64 {
        self.animation.map_or(0.0, |animation| animation.seconds())
    }

    /// The motion of an operation whose numbers are functions of the time; `None` where they are not, and where the
    /// operation has no inverse at some moment or becomes its mirror image, so that it is what it is at the frame.
    pub(super) fn changing_operation(&mut self, item: Item<'_>) -> Option<Motion> {
        let clock = item.desc().clock();
        if !item.changes() || clock.len() < 2 || self.diagnostics.has_errors() {
            return None;
        }
        let by_rows = self.rules.matrix_by_rows;
        let unheard = &mut Diagnostics::new();
        let mut keys = self.moments(clock, |moment| {
            operations::apply(DAffine3::IDENTITY, item.at_moment(moment), by_rows, unheard)
        });
        // Numbers may be out of range at other moments than the frame.
        let said = unheard.iter().next().cloned();
        if let Some(said) = said {
            self.diagnostics.push(said);
            return None;
        }
        // The last one is time 0, which is anywhere.
        let painted = keys.pop()?;
        let [first, last] = [keys.first()?.0, keys.last()?.0];
        let open = keys.clone();
        if painted.0 < first {
            keys.insert(0, painted);
        } else if painted.0 > last {
            keys.push(painted);
        }
        if let [(_, map)] = keys.as_slice() {
            return Some(Motion::still(*map));
        }
        Keyframes::new(&keys).or_else(|_| Keyframes::new(&open)).ok().map(Motion::keyed)
    }

    /// The way of a camera whose place is a function of the time, from where it is at the frame; `None` where it is not.
    ///
    /// * `frame_at`: its frame at a moment of the clock
    pub(super) fn changing_frame(
        &self,
        clock: &Clock,
        mut frame_at: impl FnMut(usize) -> Option<CameraFrame>,
    ) -> Option<Motion> {
        let axes = |frame: &CameraFrame| {
            let up = frame.right.cross(frame.forward);
            (frame.right != DVec3::ZERO && up != DVec3::ZERO)
                .then(|| DMat3::from_cols(frame.right, up.normalize_or_zero(), -frame.forward))
        };
        let start = frame_at(0)?;
        let back = axes(&start)?.transpose();
        let mut frames = self.moments(clock, &mut frame_at);
        frames.pop();
        let mut places = Vec::with_capacity(frames.len());
        let mut turns = Vec::with_capacity(frames.len());
        for (time, frame) in frames {
            let frame = frame?;
            places.push((time, DAffine3::from_translation(frame.center)));
            turns.push((time, DAffine3::from_mat3(axes(&frame)? * back)));
        }
        let keyed = |maps: &[(f64, DAffine3)]| match maps {
            [(_, map)] => Some(Motion::still(*map)),
            _ => Keyframes::new(maps).ok().map(Motion::keyed),
        };
        let to_center = Motion::still(DAffine3::from_translation(-start.center));
        Some(keyed(&places)?.then(&keyed(&turns)?).then(&to_center))
    }

    /// What is at each moment but that of the frame, with its time in seconds from there.
    fn moments<T>(&self, clock: &Clock, mut at: impl FnMut(usize) -> T) -> Vec<(f64, T)> {
        (1..clock.len()).map(|moment| (clock.offset(moment) / clock.fps(), at(moment))).collect()
    }
}
