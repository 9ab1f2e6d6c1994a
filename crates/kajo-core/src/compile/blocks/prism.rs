//! `Prism`: an outline, drawn out across its plane.

use kajo_math::{DVec2, DVec3, Vec3};
use kajo_scene::{Diagnostic, Item, Params};

use crate::compile::fields::{
    At, Direction, Keys, Sources, at_least, choice, choices, direction, keys, point, positive,
};
use crate::compile::member::{Member, ObjectMember, reported};
use crate::compile::paths::{self, Ends};
use crate::schema::{Block, Kind, NumberRange};
use crate::shape::{Bevel, BevelProfile, FillRule, Path, Prism, Sweep};

choices! {
    FillRule {
        "nonzero" => FillRule::NonZero,
        "evenodd" => FillRule::EvenOdd,
    }
}

keys! {
    PrismKeys<'t> {
        origin: Vec3 = point("origin").or([0.0; 3], "where `0 0` of the outline is"),
        axis: Direction = direction("axis").or([0.0, 0.0, 1.0], "from the near end to the far one"),
        up: Option<At<'t, Direction>> =
            direction("up").placed().unlike("y, or away from it along y", "0 1 0", "what is up in the outline"),
        size: f32 = positive("size").unit("length").or(1.0, "of one unit of the outline"),
        depth: f32 = positive("depth").unit("length").required("from the near end to the far one"),
        taper: f32 = at_least("taper", 0.0).or(1.0, "size of the far end, in parts of the near one"),
        fill: FillRule = choice::<FillRule>("fill").or_word("nonzero", "what is inside where outlines cross"),
    }
}

choices! {
    BevelProfile {
        "chamfer" => BevelProfile::Chamfer,
        "round" => BevelProfile::Round,
    }
}

keys! {
    /// What edges look like.
    BevelKeys<'t> {
        bevel: Option<At<'t, f32>> =
            positive("bevel").unit("length").placed().unlike("sharp edges", "0.02", "how far edges of both ends are taken off"),
        bevel_profile: BevelProfile =
            choice::<BevelProfile>("bevelProfile").or_word("chamfer", "what edges look like from the side"),
    }
}

impl BevelKeys<'_> {
    /// The bevel of a prism that is so deep, if it has one; `None` where it has no room.
    pub fn bevel(self, params: &mut Params<'_, '_>, depth: f64) -> Option<Option<Bevel>> {
        let Some(At { value, item }) = self.bevel else { return Some(None) };
        let width = f64::from(value);
        if width > 0.5 * depth {
            let error =
                Diagnostic::error(format!("`bevel` must not be more than half of `depth`, {}", 0.5 * depth));
            params.diagnostics().push(error.label(item.head_span(), "the bevels of both ends would overlap"));
            return None;
        }
        Some(Some(Bevel { width, profile: self.bevel_profile }))
    }
}

pub const MEMBER: ObjectMember = Member {
    block: Block {
        keyword: "Prism",
        kind: Kind::Shape,
        about: "an outline, drawn out across its plane",
        groups: &[PrismKeys::FIELDS, BevelKeys::FIELDS],
        parts: &[&OUTLINE],
    },
    read: |compiler, item, ctm, state| {
        compiler.solid(item, ctm, state, |params, sources| read(item, params, sources))
    },
};

pub const OUTLINE: Block = Block {
    keyword: "outline",
    kind: Kind::Part,
    about: "a closed path around a prism",
    groups: &[&paths::fields(&[NumberRange::ANY; 2])],
    parts: &[],
};

fn read<'t>(item: Item<'t>, params: &mut Params<'t, '_>, sources: &mut Sources<'_>) -> Option<Prism> {
    let keys = PrismKeys::read(params, sources);
    let bevel = BevelKeys::read(params, sources);
    let outlines = params.take(&[OUTLINE.keyword]);
    if outlines.is_empty() {
        params.report_missing(OUTLINE.keyword);
    }
    let contours: Vec<Option<Path<DVec2>>> = outlines
        .iter()
        .map(|&outline| {
            paths::read(outline, params.diagnostics(), Ends::Joined, 2, |args| Ok(args.vec2()?.as_dvec2()))
        })
        .collect();
    let PrismKeys { origin, axis, up, size, depth, taper, fill } = keys?;
    let contours =
        contours.into_iter().collect::<Option<Vec<_>>>().filter(|contours| !contours.is_empty())?;
    let axes = axes(params, axis, up)?;
    let contours: Vec<_> = contours.iter().map(|contour| contour.map(|p| p * f64::from(size))).collect();
    let bevel = bevel?;
    if let (Some(at), true) = (&bevel.bevel, taper != 1.0) {
        let error = Diagnostic::error("a prism has either `bevel` or `taper`, not both");
        params
            .diagnostics()
            .push(error.label(at.item.head_span(), "edges are taken off evenly, so both ends are alike"));
        return None;
    }
    let depth = f64::from(depth);
    let bevel = bevel.bevel(params, depth)?;
    let sweep = Sweep { origin: origin.as_dvec3(), axes, depth, taper: taper.into(), rule: fill, bevel };
    reported(params, Prism::new(sweep, &contours), item, "all points of this outline are on one line")
}

/// To the right, up and along the axis; a direction that is up and along the axis too is reported.
pub fn axes(
    params: &mut Params<'_, '_>,
    Direction(axis): Direction,
    up: Option<At<'_, Direction>>,
) -> Option<[DVec3; 3]> {
    let axis = axis.as_dvec3().normalize();
    // How far two directions must be apart to span a plane.
    const APART: f64 = 1e-6;
    let right = |up: DVec3| up.cross(axis).try_normalize().filter(|_| up.cross(axis).length() > APART);
    let right = match &up {
        Some(up) => right(up.value.0.as_dvec3().normalize()),
        None => right(DVec3::Y).or_else(|| right(-axis.y.signum() * DVec3::Z)),
    };
    let Some(right) = right else {
        let span = up.map(|up| up.item.head_span());
        let error = Diagnostic::error("`up` points along the axis");
        params.diagnostics().push(match span {
            Some(span) => error.label(span, "leaves open what is to the right"),
            None => error,
        });
        return None;
    };
    Some([right, axis.cross(right), axis])
}
