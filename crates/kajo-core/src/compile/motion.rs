//! `Motion` blocks: a map at two moments or more.
//!
//! Scene: `Transform { Motion { key 0 { } key 1 { Translate 1 0 0  YRotate 90 } }  Sphere { center 0 0 0  radius 1 } }`

use kajo_math::{DAffine3, KeyError, Keyframes};
use kajo_scene::{Args, Diagnostic, Diagnostics, Item, Params};

use super::fields::{Plain, Sources};
use super::{follow_path, operations};
use crate::motion::Shutter;
use crate::schema::{Around, Block, FieldSpec, FieldValue, Kind};

/// Where a shutter is open in a film unless a camera says otherwise, in frames.
pub(super) const USUAL_SHUTTER: [f64; 2] = [0.0, 0.5];

pub(super) const BLOCK: Block = Block {
    keyword: operations::MOTION,
    kind: Kind::Part,
    about: "an operation that changes with time",
    groups: &[],
    parts: &[&KEY],
};

/// The blocks that move what they stand in.
pub(super) const BLOCKS: &[&Block] = &[&BLOCK, &follow_path::BLOCK];

pub(super) const KEY: Block = Block {
    keyword: "key",
    kind: Kind::Part,
    about: "the operations that hold at a moment",
    groups: &[operations::FIELDS],
    parts: &[],
};

/// Reads a `Motion` block; `None` when an error was reported.
///
/// * `by_rows`: how the numbers of `Matrix` are ordered
/// * `now`: the time of its keys that is time 0 of what is made of them
pub(super) fn read(
    item: Item<'_>,
    by_rows: bool,
    now: f64,
    diagnostics: &mut Diagnostics,
) -> Option<Keyframes> {
    let mut params = Params::new(item, diagnostics);
    let keys = params.take(&[KEY.keyword]);
    params.finish();
    let maps: Vec<_> = keys.iter().map(|&key| read_key(key, by_rows, diagnostics)).collect();
    let maps = maps.into_iter().map(|key| key.map(|(time, map)| (time - now, map)));
    let maps: Vec<(f64, DAffine3)> = maps.collect::<Option<_>>()?;
    match Keyframes::new(&maps) {
        Ok(keyframes) => {
            warn(&keyframes, item, &keys, diagnostics);
            Some(keyframes)
        }
        Err(error) => {
            diagnostics.push(explain(error, item, &keys));
            None
        }
    }
}

/// The moment and the map of a key.
fn read_key(item: Item<'_>, by_rows: bool, diagnostics: &mut Diagnostics) -> Option<(f64, DAffine3)> {
    let mut params = Params::new(item, diagnostics);
    let time = params.own(Args::double);
    let operations = params.take(&operations::OPERATIONS);
    params.finish();
    let apply = |m, item| operations::apply(m, item, by_rows, diagnostics);
    Some((time?, operations.into_iter().fold(DAffine3::IDENTITY, apply)))
}

fn explain(error: KeyError, item: Item<'_>, keys: &[Item<'_>]) -> Diagnostic {
    let (message, place, label) = match error {
        KeyError::Few => ("a `Motion` needs two keys or more", item, "moves from where to where?"),
        KeyError::Order(i) => ("the keys of a `Motion` stand in the order of time", keys[i], "not later"),
        KeyError::NoInverse(i) => ("nothing can move through a flat state", keys[i], "has no inverse"),
        KeyError::Mirrors(i) => {
            let label = "a mirror image of the key before, or the other way round";
            ("nothing can move to its mirror image", keys[i], label)
        }
    };
    let error = Diagnostic::error(message).label(place.head_span(), label);
    match place.keyword() {
        "key" => error,
        _ => error.help("write `Motion { key 0 { ... } key 1 { ... } }` with operations in the blocks"),
    }
}

/// What is likely not meant.
fn warn(keyframes: &Keyframes, item: Item<'_>, keys: &[Item<'_>], diagnostics: &mut Diagnostics) {
    let help = "between two keys things turn by the shorter way; put another key in between";
    if keyframes.segments().iter().all(|segment| segment.is_still()) {
        let warning = Diagnostic::warning("this `Motion` moves nothing: all its keys are the same");
        diagnostics.push(warning.label(item.keyword_span(), "stands still").help(help));
    }
    if let Some(i) = keyframes.segments().iter().position(|segment| segment.is_half_turn()) {
        let warning = Diagnostic::warning("half a turn from one key to the next could go either way");
        diagnostics.push(warning.label(keys[i + 1].head_span(), "half a turn from the last key").help(help));
    }
}

/// What holds for a key `shutter` that is not written.
pub(super) fn usual_shutter(around: &Around<'_>) -> Option<FieldValue> {
    let is_film = around.scene.is_some_and(|scene| scene.output.animation.is_some());
    Some(FieldValue::numbers(if is_film { USUAL_SHUTTER } else { Shutter::default().interval() }))
}

impl Plain<'_> for Shutter {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<Shutter, Diagnostic> {
        let (open, close) = (args.double()?, args.double()?);
        if close >= open {
            Ok(Shutter::new(open, close))
        } else {
            Err(args.error("a shutter closes after it opens"))
        }
    }
}
