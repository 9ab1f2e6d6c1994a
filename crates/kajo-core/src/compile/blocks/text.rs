//! `Text`: lettering in a font, drawn out across its plane.

use kajo_math::{DVec2, Vec3};
use kajo_scene::{
    Args, Diagnostic, GlyphContour, GlyphSegment, Item, Params, TextAlign, TextStyle, read_limited,
    text_outlines,
};

use super::prism::{BevelKeys, axes};
use crate::compile::fields::{
    At, Direction, FileName, Keys, Plain, Sources, Typed, at_least, between, choice, choices, count,
    direction, file, keys, number, point, positive,
};
use crate::compile::member::{Member, ObjectMember, reported};
use crate::schema::{Block, FieldKind, FieldSpec, Kind};
use crate::shape::{FillRule, Path, Prism, Sweep};

choices! {
    TextAlign {
        "left" => TextAlign::Left,
        "center" => TextAlign::Center,
        "right" => TextAlign::Right,
    }
}

/// What begins a new line, as it is written.
const BREAK: &str = "\\n";

/// Lines of text.
struct Lines(Vec<String>);

impl Plain<'_> for Lines {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<Lines, Diagnostic> {
        Ok(Lines(args.text()?.split(BREAK).map(str::to_owned).collect()))
    }
}

keys! {
    TextKeys<'t> {
        text: Lines = Typed::<Lines>::new("text", FieldKind::Text).required("the words; `\\n` begins a new line"),
        font: At<'t, FileName> = file("font").placed().required("a TrueType or OpenType font"),
        face: u32 = count("face", 0, 65_535).or(0, "which font of a collection"),
        weight: Option<f32> = between("weight", 1.0, 1000.0).option("of a variable font: 400 is regular, 700 bold"),
        align: TextAlign = choice::<TextAlign>("align").or_word("left", "which point of each line is at `origin`"),
        line_spacing: f32 = at_least("lineSpacing", 0.0).or(1.0, "distance of lines, in parts of the font's"),
        letter_spacing: f32 = number("letterSpacing").or(0.0, "more room between letters, in parts of `size`"),
        origin: Vec3 = point("origin").or([0.0; 3], "where the first line stands"),
        axis: Direction = direction("axis").or([0.0, 0.0, 1.0], "towards the reader"),
        up: Option<At<'t, Direction>> =
            direction("up").placed().unlike("y, or away from it along y", "0 1 0", "what is up in the text"),
        size: f32 = positive("size").unit("length").or(1.0, "height of an em, the font's own unit"),
        depth: f32 = positive("depth").unit("length").or(0.2, "how thick the letters are"),
    }
}

pub const MEMBER: ObjectMember = Member {
    block: Block {
        keyword: "Text",
        kind: Kind::Shape,
        about: "lettering in a font, drawn out across its plane",
        groups: &[TextKeys::FIELDS, BevelKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item, ctm, state| {
        compiler.solid(item, ctm, state, |params, sources| read(item, params, sources))
    },
};

/// Bytes of the largest font file.
const LARGEST_FONT: u64 = 128 << 20;

fn read<'t>(item: Item<'t>, params: &mut Params<'t, '_>, sources: &mut Sources<'_>) -> Option<Prism> {
    let keys = TextKeys::read(params, sources);
    let bevel = BevelKeys::read(params, sources);
    let TextKeys {
        text,
        font,
        face,
        weight,
        align,
        line_spacing,
        letter_spacing,
        origin,
        axis,
        up,
        size,
        depth,
    } = keys?;
    let style = TextStyle {
        face,
        align,
        line_spacing: line_spacing.into(),
        letter_spacing: letter_spacing.into(),
        weight,
    };
    let name = &font.value.0;
    let assets = sources.textures.spectra.assets;
    let bytes = assets.open(name, font.item.path());
    let bytes = bytes.and_then(|file| read_limited(file, LARGEST_FONT)).map_err(|e| e.to_string());
    let outlines = bytes.and_then(|bytes| text_outlines(&bytes, &text.0, &style).map_err(|e| e.to_string()));
    let outlines = match outlines {
        Ok(outlines) => outlines,
        Err(reason) => {
            let error = Diagnostic::error(format!("cannot read `{name}`: {reason}"));
            params.diagnostics().push(error.label(font.item.head_span(), "named here"));
            return None;
        }
    };
    if !outlines.missing.is_empty() {
        let characters: String = outlines.missing.iter().collect();
        let warning = Diagnostic::warning(format!("`{name}` has no glyph for `{characters}`"));
        params.report(warning, "the font's mark for that stands in their place");
    }
    let scale = f64::from(size);
    let contours: Vec<Path<DVec2>> =
        outlines.contours.iter().map(|contour| path(contour).map(|p| p * scale)).collect();
    let axes = axes(params, axis, up)?;
    let depth = f64::from(depth);
    let bevel = bevel?.bevel(params, depth)?;
    let sweep = Sweep { origin: origin.as_dvec3(), axes, depth, taper: 1.0, rule: FillRule::NonZero, bevel };
    reported(params, Prism::new(sweep, &contours), item, "there is nothing to be seen of this text")
}

/// A contour of a glyph as a closed path, in em.
fn path(contour: &GlyphContour) -> Path<DVec2> {
    let mut path = Path::new(DVec2::from(contour.start));
    for segment in &contour.segments {
        match *segment {
            GlyphSegment::Line(p) => path.line_to(p.into()),
            GlyphSegment::Quadratic(control, p) => path.quadratic_to(control.into(), p.into()),
            GlyphSegment::Cubic(a, b, p) => path.cubic_to([a.into(), b.into()], p.into()),
        }
    }
    path.close();
    path
}
