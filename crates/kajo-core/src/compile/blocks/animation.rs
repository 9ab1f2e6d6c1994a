//! The `Animation` block: which frames a scene has.

use kajo_scene::{Args, Diagnostic, Params};

use crate::compile::fields::{Keys, Plain, Sources, Typed, keys, positive};
use crate::schema::{Block, FieldKind, FieldSpec, Kind, NumberRange};

/// The largest number of a frame.
pub const LAST_FRAME: i64 = 1_000_000_000;

pub const KEYWORD: &str = "Animation";
pub const FPS: &str = "fps";
pub const FRAMES: &str = "frames";

/// The first frame and the last one.
pub struct FrameRange(pub [i64; 2]);

keys! {
    AnimationKeys {
        fps: f32 = positive(FPS).unit("1/s").or(24.0, "frames of a second"),
        frames: Option<FrameRange> = Typed::<FrameRange>::new(FRAMES, FieldKind::Wholes(&[NumberRange { min: 0.0, max: LAST_FRAME as f64 }; 2]))
            .unlike("from 1 on", "1 240", "the first frame, which is at time 0, and the last one"),
    }
}

pub const BLOCK: Block = Block {
    keyword: KEYWORD,
    kind: Kind::Animation,
    about: "the frames of a scene that changes with time",
    groups: &[AnimationKeys::FIELDS],
    parts: &[],
};

/// Frames of a second, and the first and the last frame where they are said.
pub fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<(f64, Option<[i64; 2]>)> {
    let AnimationKeys { fps, frames } = AnimationKeys::read(params, sources)?;
    Some((fps.into(), frames.map(|range| range.0)))
}

impl Plain<'_> for FrameRange {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<FrameRange, Diagnostic> {
        frame_range(args)
    }
}

/// The first frame and the last one, in this order.
pub fn frame_range(args: &mut Args<'_>) -> Result<FrameRange, Diagnostic> {
    let (first, last) = (args.int_in(0..=LAST_FRAME)?, args.int_in(0..=LAST_FRAME)?);
    match last >= first {
        true => Ok(FrameRange([first, last])),
        false => Err(args.error("the last frame does not come before the first one")),
    }
}
