//! `WorldLine`: where a camera is whose clock shows a time, in a world that has a speed of light.
//!
//! Scene: `PerspectiveCamera { ... WorldLine { event 0  0 0 10  event 20  0 0 0  properTime (time) } }`

use kajo_math::DVec3;
use kajo_math::lorentz::SpacetimeEvent;
use kajo_math::world_line::{WorldLine, WorldLineError, WorldPoint, accelerated};
use kajo_scene::{Args, Diagnostic, Diagnostics, Item, Params};

use crate::scene::MAX_GAMMA;
use crate::schema::{Absent, Block, Constant, FieldKind, FieldSpec, Kind, NumberRange};

const EVENT: FieldSpec = FieldSpec {
    absent: Absent::Nothing { means: "none", start: "" },
    repeats: true,
    about: "a moment of the world, and where the camera is then",
    ..FieldSpec::new("event", FieldKind::Numbers(&[NumberRange::ANY; 4]))
};

const ACCELERATION: FieldSpec = FieldSpec {
    absent: Absent::Nothing { means: "none", start: "0 0 -0.1" },
    about: "what it feels all the time, from rest in its `center` on: speeds of light per time",
    unit: "1/length",
    ..FieldSpec::new("acceleration", FieldKind::Vector)
};

const PROPER_TIME: FieldSpec = FieldSpec {
    absent: Absent::Value(Constant::Number(0.0)),
    about: "what its own clock shows, from the first event or from rest on",
    ..FieldSpec::new("properTime", FieldKind::NUMBER)
};

pub(super) const BLOCK: Block = Block {
    keyword: "WorldLine",
    kind: Kind::Part,
    about: "where a camera is that moves nearly as fast as light, by its own clock",
    groups: &[&[EVENT, ACCELERATION, PROPER_TIME]],
    parts: &[],
};

/// Where a block says that the camera is; `None` where a mistake was reported.
pub(super) fn read(item: Item<'_>, diagnostics: &mut Diagnostics) -> Option<WorldPoint> {
    let mut params = Params::new(item, diagnostics);
    let written = params.take(&[EVENT.key]);
    let events: Vec<Option<SpacetimeEvent>> =
        written.iter().map(|&item| Args::read(item, params.diagnostics(), event)).collect();
    let acceleration = params.optional(ACCELERATION.key, |args| Ok(args.vec3()?.as_dvec3()));
    let proper_time = params.or(PROPER_TIME.key, 0.0, Args::double);
    params.finish();
    let events: Vec<SpacetimeEvent> = events.into_iter().collect::<Option<_>>()?;
    let fastest = (1.0 - 1.0 / (MAX_GAMMA * MAX_GAMMA)).sqrt();
    let (point, culprit) = match (acceleration, events.is_empty()) {
        (Some(acceleration), true) => (Ok(accelerated(acceleration, proper_time)), item),
        (Some(_), false) => {
            let error = Diagnostic::error("a world line has either events or an `acceleration`");
            diagnostics.push(error.label(written[0].keyword_span(), "goes elsewhere"));
            return None;
        }
        (None, _) => match WorldLine::through(&events, fastest) {
            Ok(line) => (Ok(line.at(proper_time)), item),
            Err(error) => (Err(error), culprit(&error, &written).unwrap_or(item)),
        },
    };
    let too_fast = |point: &WorldPoint| !point.velocity.is_finite() || point.velocity.length() >= fastest;
    let message = match point {
        Ok(point) if too_fast(&point) || !point.event.x.is_finite() || !point.event.t.is_finite() => {
            format!("at {proper_time} by its clock the camera is as fast as light, nearly")
        }
        Ok(point) => return Some(point),
        Err(error) => error.to_string(),
    };
    let error = Diagnostic::error(message).label(culprit.keyword_span(), "no camera goes so");
    diagnostics
        .push(error.help("an event is `event t x y z`; light goes one unit of length in one unit of time"));
    None
}

fn event(args: &mut Args<'_>) -> Result<SpacetimeEvent, Diagnostic> {
    Ok(SpacetimeEvent { t: args.double()?, x: DVec3::new(args.double()?, args.double()?, args.double()?) })
}

/// The event that is to blame.
fn culprit<'t>(error: &WorldLineError, written: &[Item<'t>]) -> Option<Item<'t>> {
    match *error {
        WorldLineError::Empty => None,
        WorldLineError::Order(i) | WorldLineError::Fast { after: i, .. } => written.get(i).copied(),
    }
}
