//! `Curves`: strands with a width, for hair, grass and wires.

use kajo_math::Vec3;
use kajo_scene::{Args, Diagnostic, Item, Params};

use crate::compile::Compiler;
use crate::compile::curves::CurvesRequest;
use crate::compile::fields::{
    At, FileName, Keys, Plain, Sources, Typed, at_least, choice, choices, file, keys,
};
use crate::compile::graphics_state::{CurrentTransform, GraphicsState};
use crate::compile::member::{Member, ObjectMember};
use crate::schema::{Block, FieldKind, FieldSpec, Kind, NumberRange};
use crate::shape::{CurveBasis, CurveForm, Strands};

choices! {
    CurveBasis {
        "bspline" => CurveBasis::BSpline,
        "bezier" => CurveBasis::Bezier,
        "catmullrom" => CurveBasis::CatmullRom,
        "linear" => CurveBasis::Linear,
    }
}

choices! {
    CurveForm {
        "tube" => CurveForm::Tube,
        "ribbon" => CurveForm::Ribbon,
    }
}

keys! {
    CurvesKeys<'t> {
        file: Option<At<'t, FileName>> = file("file").placed().option("strands: text, or a file of hair"),
        basis: CurveBasis = choice::<CurveBasis>("basis").or_word("bspline", "what points make a curve by"),
        form: CurveForm = choice::<CurveForm>("form").or_word("tube", "round, or flat and facing the ray"),
        radius: f32 = at_least("radius", 0.0).unit("length").or(0.01, "half the width of points that have none"),
        tip_radius: Option<f32> = at_least("tipRadius", 0.0).unit("length").unlike(
            "`radius`",
            "0",
            "the same at the last point of each strand; changes steadily up to there",
        ),
    }
}

pub const MEMBER: ObjectMember = Member {
    block: Block {
        keyword: "Curves",
        kind: Kind::Shape,
        about: "strands with a width: hair, grass, wires",
        groups: &[CurvesKeys::FIELDS],
        parts: &[&STRAND],
    },
    read: place_curves,
};

/// The numbers of a strand that are half its width.
struct Radii(Vec<f32>);

impl Plain<'_> for Radii {
    fn parse(spec: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<Radii, Diagnostic> {
        let count = args.numbers_left();
        (0..count).map(|_| args.number_in(spec.kind.bounds())).collect::<Result<_, _>>().map(Radii)
    }
}

/// The points of a strand.
struct Points(Vec<Vec3>);

impl Plain<'_> for Points {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<Points, Diagnostic> {
        args.points().map(Points)
    }
}

keys! {
    StrandKeys {
        points: Points = Typed::<Points>::new("points", FieldKind::Groups(&[NumberRange::ANY; 3])).required("where it goes"),
        radii: Option<Radii> = Typed::<Radii>::new("radii", FieldKind::Groups(&[NumberRange::NOT_NEGATIVE]))
            .unit("length")
            .unlike("`radius` of all", "0.01", "half its width: one number, or one for each point"),
    }
}

pub const STRAND: Block = Block {
    keyword: "strand",
    kind: Kind::Part,
    about: "one of many curves, by its points",
    groups: &[StrandKeys::FIELDS],
    parts: &[],
};

fn place_curves(
    compiler: &mut Compiler<'_>,
    item: Item<'_>,
    ctm: &mut CurrentTransform,
    state: &mut GraphicsState,
) {
    let shape = compiler.read_keys(item, read).and_then(|request| compiler.curves(item, request));
    compiler.put_shape(shape, item, ctm, state);
}

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<CurvesRequest> {
    params.name();
    let keys = CurvesKeys::read(params, sources);
    let items = params.take(&[STRAND.keyword]);
    if items.is_empty() && !params.contains("file") {
        params.report_missing(STRAND.keyword);
        return None;
    }
    let mut strands = Strands::default();
    let read: Vec<Option<()>> =
        items.into_iter().map(|item| strand(item, params, sources, &mut strands)).collect();
    let CurvesKeys { file, basis, form, radius, tip_radius } = keys?;
    read.into_iter().collect::<Option<()>>()?;
    let file = file.map(|file| (file.value.0, file.item.head_span()));
    Some(CurvesRequest { file, strands, basis, form, radii: [radius, tip_radius.unwrap_or(radius)] })
}

/// Adds what a block of a strand says.
fn strand(
    item: Item<'_>,
    params: &mut Params<'_, '_>,
    sources: &mut Sources<'_>,
    out: &mut Strands,
) -> Option<()> {
    let mut own = Params::new(item, params.diagnostics());
    let keys = StrandKeys::read(&mut own, sources);
    own.finish();
    let StrandKeys { points: Points(points), radii } = keys?;
    let radii = radii.map(|Radii(radii)| radii).unwrap_or_default();
    if radii.len() > 1 && radii.len() != points.len() {
        let message = format!("{} radii for {} points", radii.len(), points.len());
        let error = Diagnostic::error(message).label(item.head_span(), "in this strand");
        params.diagnostics().push(error.help("write one radius, or one for each point"));
        return None;
    }
    match *radii {
        [one] => out.radii.extend(points.iter().map(|_| one)),
        [] => out.radii.extend(points.iter().map(|_| f32::NAN)),
        _ => out.radii.extend(&radii),
    }
    out.points.extend(points);
    out.finish_strand();
    Some(())
}
