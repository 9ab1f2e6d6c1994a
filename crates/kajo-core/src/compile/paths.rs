//! Paths of lines, curves and splines, written as items one after the other.
//!
//! ```text
//! outline { line 0 0  2 0  cubic 3 0  3 1  2 1  spline 1 1.5  0 1 }
//! ```
//!
//! The first item begins with the point where the path begins; every other one goes on from where the path has come to.

use kajo_scene::{Args, Diagnostic, Diagnostics, Item, Params};

use crate::schema::{Absent, FieldKind, FieldSpec, NumberRange};
use crate::shape::{ControlPoint, Path};

/// An item of a path, and what it is made of.
#[derive(Clone, Copy, PartialEq)]
enum PathSegment {
    Line,
    Quadratic,
    Cubic,
    Spline,
}

const SEGMENTS: [(&str, PathSegment); 4] = [
    ("line", PathSegment::Line),
    ("quadratic", PathSegment::Quadratic),
    ("cubic", PathSegment::Cubic),
    ("spline", PathSegment::Spline),
];

/// The descriptions of the items of a path, whose points are numbers with these ranges.
pub(super) const fn fields(point: &'static [NumberRange]) -> [FieldSpec; SEGMENTS.len()] {
    let mut specs = [FieldSpec::new("", FieldKind::Groups(point)); SEGMENTS.len()];
    let mut i = 0;
    while i < specs.len() {
        let (key, segment) = SEGMENTS[i];
        let absent = Absent::Nothing { means: "none", start: "" };
        specs[i] = FieldSpec { key, absent, repeats: true, about: segment.about(), ..specs[i] };
        i += 1;
    }
    specs
}

impl PathSegment {
    /// How many points it takes to go on.
    fn group(self) -> usize {
        match self {
            PathSegment::Line | PathSegment::Spline => 1,
            PathSegment::Quadratic => 2,
            PathSegment::Cubic => 3,
        }
    }

    /// What it goes on by.
    const fn points(self) -> &'static str {
        match self {
            PathSegment::Line | PathSegment::Spline => "points",
            PathSegment::Quadratic => "pairs of points: one it is drawn towards, and its end",
            PathSegment::Cubic => "three points each: two it is drawn towards, and its end",
        }
    }

    const fn about(self) -> &'static str {
        match self {
            PathSegment::Line => "goes straight from point to point",
            PathSegment::Quadratic => {
                "quadratic Béziers by pairs of points: one each is drawn towards, and its end"
            }
            PathSegment::Cubic => "cubic Béziers by three points each: two it is drawn towards, and its end",
            PathSegment::Spline => "goes smoothly through points",
        }
    }
}

/// What becomes of the ends of a path.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Ends {
    /// The last is joined to the first: straight, or smoothly where the path is one spline.
    Joined,
    /// They stay, unless the path comes back to where it began.
    Free,
}

/// The path in a block; `None` where a mistake was reported.
///
/// * `numbers`: how many make a point
pub(super) fn read<'t, V: ControlPoint>(
    block: Item<'t>,
    diagnostics: &mut Diagnostics,
    ends: Ends,
    numbers: usize,
    point: impl Fn(&mut Args<'t>) -> Result<V, Diagnostic>,
) -> Option<Path<V>> {
    let mut params = Params::new(block, diagnostics);
    let path = take(block, &mut params, ends, numbers, point);
    params.finish();
    path
}

/// The same of the items of a path in a block that says more.
pub(super) fn take<'t, V: ControlPoint>(
    block: Item<'t>,
    params: &mut Params<'t, '_>,
    ends: Ends,
    numbers: usize,
    point: impl Fn(&mut Args<'t>) -> Result<V, Diagnostic>,
) -> Option<Path<V>> {
    let items = params.take(&SEGMENTS.map(|(word, _)| word));
    let mut segments = Vec::with_capacity(items.len());
    for (i, &item) in items.iter().enumerate() {
        let segment =
            SEGMENTS.iter().find(|(word, _)| *word == item.keyword()).map(|(_, segment)| *segment)?;
        let points =
            Args::read(item, params.diagnostics(), |args| points(args, segment, i == 0, numbers, &point));
        segments.push(points.map(|points| (segment, points)));
    }
    let segments: Vec<(PathSegment, Vec<V>)> = segments.into_iter().collect::<Option<_>>()?;
    let Some(start) = segments.first().and_then(|(_, points)| points.first()) else {
        if block.has_block() {
            let error = Diagnostic::error(format!("this `{}` goes nowhere", block.keyword()));
            let words = SEGMENTS.map(|(word, _)| format!("`{word}`")).join(", ");
            let help = format!("write one of {words}, and points");
            params.diagnostics().push(error.label(block.keyword_span(), "no points in it").help(help));
        }
        return None;
    };
    if let [(PathSegment::Spline, points)] = &*segments {
        let returns = points.len() > 2 && points.first() == points.last();
        if returns || ends == Ends::Joined {
            return Path::closed_spline(&points[..points.len() - usize::from(returns)]);
        }
    }
    let mut path = Path::new(*start);
    for (i, (segment, points)) in segments.iter().enumerate() {
        let onward = if i == 0 { &points[1..] } else { &points[..] };
        match segment {
            PathSegment::Line => onward.iter().for_each(|&p| path.line_to(p)),
            PathSegment::Quadratic => onward.as_chunks().0.iter().for_each(|&[a, b]| path.quadratic_to(a, b)),
            PathSegment::Cubic => onward.as_chunks().0.iter().for_each(|&[a, b, c]| path.cubic_to([a, b], c)),
            PathSegment::Spline => path.spline_through(onward),
        }
    }
    if ends == Ends::Joined {
        path.close();
    }
    Some(path)
}

/// The points of an item.
fn points<'t, V>(
    args: &mut Args<'t>,
    segment: PathSegment,
    is_first: bool,
    numbers: usize,
    point: impl Fn(&mut Args<'t>) -> Result<V, Diagnostic>,
) -> Result<Vec<V>, Diagnostic> {
    let (word, found) = (args.item().keyword(), args.numbers_left());
    if found == 0 || !found.is_multiple_of(numbers) {
        let message = format!("expected numbers in groups of {numbers} after `{word}`, found {found}");
        return Err(args.error(message));
    }
    let count = found / numbers;
    let onward = count - usize::from(is_first);
    if !onward.is_multiple_of(segment.group()) {
        let begins = if is_first { "the path begins at the first point and " } else { "" };
        let message = format!("{begins}`{word}` goes on by {}; found {onward}", segment.points());
        return Err(args.error(message));
    }
    (0..count).map(|_| point(args)).collect()
}
