//! `Lathe`: a profile, turned about an axis.

use kajo_math::{DVec2, Vec3};
use kajo_scene::{Diagnostic, Item, Params};

use crate::compile::fields::{Direction, Keys, Sources, choice, direction, keys, point, positive};
use crate::compile::member::{Member, ObjectMember};
use crate::compile::paths::{self, Ends};
use crate::schema::{Block, Kind, NumberRange};
use crate::shape::{FillRule, Lathe, LatheError, Path, Turning};

keys! {
    LatheKeys {
        origin: Vec3 = point("origin").or([0.0; 3], "where `0 0` of the profile is"),
        axis: Direction = direction("axis").or([0.0, 1.0, 0.0], "what is up in the profile, which turns about it"),
        size: f32 = positive("size").unit("length").or(1.0, "of one unit of the profile"),
        fill: FillRule = choice::<FillRule>("fill").or_word("nonzero", "what is inside where profiles cross"),
    }
}

pub const MEMBER: ObjectMember = Member {
    block: Block {
        keyword: "Lathe",
        kind: Kind::Shape,
        about: "a profile, turned about an axis",
        groups: &[LatheKeys::FIELDS],
        parts: &[&PROFILE],
    },
    read: |compiler, item, ctm, state| {
        compiler.solid(item, ctm, state, |params, sources| read(item, params, sources))
    },
};

pub const PROFILE: Block = Block {
    keyword: "profile",
    kind: Kind::Part,
    about: "a path that a lathe turns",
    groups: &[&paths::fields(&[NumberRange::ANY; 2])],
    parts: &[],
};

fn read<'t>(item: Item<'t>, params: &mut Params<'t, '_>, sources: &mut Sources<'_>) -> Option<Lathe> {
    let keys = LatheKeys::read(params, sources);
    let items = params.take(&[PROFILE.keyword]);
    if items.is_empty() {
        params.report_missing(PROFILE.keyword);
    }
    let profiles: Vec<Option<Path<DVec2>>> = items
        .iter()
        .map(|&item| {
            paths::read(item, params.diagnostics(), Ends::Free, 2, |args| Ok(args.vec2()?.as_dvec2()))
        })
        .collect();
    let LatheKeys { origin, axis: Direction(axis), size, fill } = keys?;
    let profiles =
        profiles.into_iter().collect::<Option<Vec<_>>>().filter(|profiles| !profiles.is_empty())?;
    let profiles: Vec<_> = profiles.iter().map(|profile| profile.map(|p| p * f64::from(size))).collect();
    let turning = Turning { origin: origin.as_dvec3(), axis: axis.as_dvec3().normalize(), rule: fill };
    match Lathe::new(turning, &profiles) {
        Ok(lathe) => Some(lathe),
        Err(error) => {
            let diagnostic = Diagnostic::error(error.to_string());
            params.diagnostics().push(match error {
                LatheError::Nothing => diagnostic.label(item.head_span(), "leaves no such shape"),
                LatheError::CrossesAxis(i) => diagnostic
                    .label(items[i].head_span(), "goes below 0")
                    .help("a curve or spline may swing beyond the points that it goes through"),
            });
            None
        }
    }
}
