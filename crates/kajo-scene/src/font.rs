//! Text in a TrueType or OpenType font, as outlines.
//!
//! Glyphs follow each other from left to right by their advances and by the kerning of pairs, that of `GPOS` or else of `kern`, in font
//! units, which are whole numbers: so every machine puts them at the same places. Outlines are not hinted.

use std::collections::BTreeSet;

use ttf_parser::gpos::{PairAdjustment, PositioningSubtable};
use ttf_parser::head::IndexToLocationFormat;
use ttf_parser::{Face, FaceParsingError, GlyphId, OutlineBuilder, Tag, fonts_in_collection};

/// Characters of a text at most.
const LONGEST_TEXT: usize = 10_000;

/// Points of all outlines at most.
const MOST_POINTS: usize = 2_000_000;

/// How text is set.
#[derive(Clone, Debug, PartialEq)]
pub struct TextStyle {
    /// Which font of a collection, from 0.
    pub face: u32,
    /// Where lines begin, end or have their middle.
    pub align: TextAlign,
    /// Distance of baselines, in parts of what the font asks for.
    pub line_spacing: f64,
    /// What is added between glyphs, in em.
    pub letter_spacing: f64,
    /// Weight of a variable font: 400 is regular, 700 bold.
    pub weight: Option<f32>,
}

/// Which point of each line is at x = 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TextAlign {
    /// Where it begins at the left.
    #[default]
    Left,
    /// Its middle.
    Center,
    /// Where it ends at the right.
    Right,
}

/// The outlines of a text, in em: the first baseline is at y = 0, and y points up.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TextOutlines {
    /// Closed contours. What they enclose is told by the nonzero rule.
    pub contours: Vec<GlyphContour>,
    /// Characters that the font draws nothing for, or has no glyph for, once each.
    pub missing: Vec<char>,
}

/// A closed contour; the last point is joined to the first.
#[derive(Clone, Debug, PartialEq)]
pub struct GlyphContour {
    /// Where it begins.
    pub start: [f64; 2],
    /// How it goes on.
    pub segments: Vec<GlyphSegment>,
}

/// A piece of a contour, from the end of the one before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GlyphSegment {
    /// Straight.
    Line([f64; 2]),
    /// A Bézier curve by one control point, and its end.
    Quadratic([f64; 2], [f64; 2]),
    /// A Bézier curve by two control points, and its end.
    Cubic([f64; 2], [f64; 2], [f64; 2]),
}

/// Why a text has no outlines. The text completes "cannot read `x`: ...".
#[derive(Debug, thiserror::Error)]
pub enum FontError {
    /// The bytes are no font.
    #[error("it is no TrueType or OpenType font ({0})")]
    NotAFont(FaceParsingError),
    /// A collection has fewer fonts.
    #[error("it has {count} fonts, so `face` must be less than {count}")]
    NoSuchFace {
        /// How many there are.
        count: u32,
    },
    /// A glyph is damaged, or of too many parts.
    #[error("the outline of glyph {glyph} is damaged")]
    BadGlyph {
        /// Its number.
        glyph: u16,
    },
    /// More than is worth setting.
    #[error("the text has more than {LONGEST_TEXT} characters or {MOST_POINTS} points")]
    TooLong,
}

/// The outlines of lines of text.
///
/// * `bytes`: a font file: TrueType, OpenType or a collection of such
///
/// # Errors
/// When the font is none, is damaged, or the text is too long.
pub fn text_outlines(
    bytes: &[u8],
    lines: &[impl AsRef<str>],
    style: &TextStyle,
) -> Result<TextOutlines, FontError> {
    let count = fonts_in_collection(bytes).unwrap_or(1);
    if style.face >= count {
        return Err(FontError::NoSuchFace { count });
    }
    let mut face = Face::parse(bytes, style.face).map_err(FontError::NotAFont)?;
    if let Some(weight) = style.weight {
        // A font of one weight has that one.
        let _ = face.set_variation(Tag::from_bytes(b"wght"), weight);
    }
    let characters: usize = lines.iter().map(|line| line.as_ref().chars().count()).sum();
    if characters > LONGEST_TEXT {
        return Err(FontError::TooLong);
    }
    let mut setter = Setter::new(&face, style);
    for (i, line) in lines.iter().enumerate() {
        setter.line(line.as_ref(), -(i as f64) * setter.leading)?;
    }
    Ok(TextOutlines { contours: setter.pen.contours, missing: setter.missing.into_iter().collect() })
}

/// Puts glyphs one after the other.
struct Setter<'a> {
    face: &'a Face<'a>,
    kerning: Kerning<'a>,
    style: &'a TextStyle,
    /// Font units of an em.
    em: f64,
    /// From one baseline to the next, in em.
    leading: f64,
    pen: Pen,
    missing: BTreeSet<char>,
}

impl<'a> Setter<'a> {
    fn new(face: &'a Face<'a>, style: &'a TextStyle) -> Setter<'a> {
        let em = f64::from(face.units_per_em());
        let height = f64::from(face.ascender()) - f64::from(face.descender()) + f64::from(face.line_gap());
        let asked = if height > 0.0 { height / em } else { 1.0 };
        Setter {
            face,
            kerning: Kerning::of(face),
            style,
            em,
            leading: style.line_spacing * asked,
            pen: Pen { scale: 1.0 / em, ..Pen::default() },
            missing: BTreeSet::new(),
        }
    }

    /// Sets a line on the baseline at a height.
    fn line(&mut self, text: &str, y: f64) -> Result<(), FontError> {
        let glyphs: Vec<(char, Option<GlyphId>)> =
            text.chars().filter(|c| !c.is_control()).map(|c| (c, self.face.glyph_index(c))).collect();
        let extra = self.style.letter_spacing * self.em;
        let mut places = Vec::with_capacity(glyphs.len());
        let (mut x, mut before) = (0.0, None);
        for (_, glyph) in &glyphs {
            let glyph = glyph.unwrap_or(GlyphId(0));
            if let Some(before) = before {
                x += f64::from(self.kerning.between(before, glyph)) + extra;
            }
            places.push((glyph, x));
            x += f64::from(self.face.glyph_hor_advance(glyph).unwrap_or(0));
            before = Some(glyph);
        }
        let start = match self.style.align {
            TextAlign::Left => 0.0,
            TextAlign::Center => -0.5 * x,
            TextAlign::Right => -x,
        };
        for (&(c, known), (glyph, x)) in glyphs.iter().zip(places) {
            self.pen.origin = [start + x, y * self.em];
            let drawn = self.draw(glyph)?;
            if known.is_none() || !drawn && !c.is_whitespace() {
                self.missing.insert(c);
            }
        }
        Ok(())
    }

    /// Adds the outline of a glyph; whether it has one.
    fn draw(&mut self, glyph: GlyphId) -> Result<bool, FontError> {
        let bad = Err(FontError::BadGlyph { glyph: glyph.0 });
        if !parts_end(self.face, glyph) {
            return bad;
        }
        let before = self.pen.points;
        let is_whole = self.face.outline_glyph(glyph, &mut self.pen).is_some();
        match self.pen.points {
            points if points > MOST_POINTS => Err(FontError::TooLong),
            points if points > before && !is_whole => bad,
            points => Ok(points > before),
        }
    }
}

/// What a font says of pairs of glyphs.
struct Kerning<'a> {
    pairs: Vec<PairAdjustment<'a>>,
    face: &'a Face<'a>,
}

impl<'a> Kerning<'a> {
    fn of(face: &'a Face<'a>) -> Kerning<'a> {
        let mut lookups = BTreeSet::new();
        let gpos = face.tables().gpos;
        for feature in gpos.iter().flat_map(|gpos| gpos.features) {
            if feature.tag == Tag::from_bytes(b"kern") {
                lookups.extend(feature.lookup_indices);
            }
        }
        let lookups = lookups.into_iter().filter_map(|index| gpos.as_ref()?.lookups.get(index));
        let subtables = lookups.flat_map(|lookup| lookup.subtables.into_iter::<PositioningSubtable<'a>>());
        let pairs = subtables.filter_map(|subtable| match subtable {
            PositioningSubtable::Pair(pair) => Some(pair),
            _ => None,
        });
        Kerning { pairs: pairs.collect(), face }
    }

    /// What is added between two glyphs, in font units: by the first subtable that knows the pair.
    fn between(&self, left: GlyphId, right: GlyphId) -> i16 {
        if !self.pairs.is_empty() {
            return self.pairs.iter().find_map(|pair| adjustment(pair, left, right)).unwrap_or(0);
        }
        let tables = self.face.tables().kern.iter().flat_map(|kern| kern.subtables);
        let known = |table: ttf_parser::kern::Subtable<'_>| {
            let is_plain = table.horizontal && !table.variable && !table.has_cross_stream;
            table.glyphs_kerning(left, right).filter(|_| is_plain)
        };
        tables.filter_map(known).next().unwrap_or(0)
    }
}

/// What a subtable adds to the advance of the first glyph of a pair.
fn adjustment(pair: &PairAdjustment<'_>, left: GlyphId, right: GlyphId) -> Option<i16> {
    match pair {
        PairAdjustment::Format1 { coverage, sets } => {
            Some(sets.get(coverage.get(left)?)?.get(right)?.0.x_advance)
        }
        PairAdjustment::Format2 { coverage, classes, matrix } => {
            coverage.get(left)?;
            Some(matrix.get((classes.0.get(left), classes.1.get(right)))?.0.x_advance)
        }
    }
}

/// Whether a glyph of `glyf` is made of parts that come to an end soon: without a bound, parts of parts could be without number.
fn parts_end(face: &Face<'_>, glyph: GlyphId) -> bool {
    const MOST_PARTS: u32 = 1000;
    let table = |name: &[u8; 4]| face.raw_face().table(Tag::from_bytes(name));
    let (Some(loca), Some(glyf)) = (table(b"loca"), table(b"glyf")) else { return true };
    let is_long = face.tables().head.index_to_location_format == IndexToLocationFormat::Long;
    let (mut left, mut count) = (vec![glyph.0], 0);
    while let Some(part) = left.pop() {
        count += 1;
        if count > MOST_PARTS {
            return false;
        }
        left.extend(parts_of(loca, glyf, is_long, part).unwrap_or_default());
    }
    true
}

/// The glyphs that a glyph is composed of; none for a simple one.
fn parts_of(loca: &[u8], glyf: &[u8], is_long: bool, glyph: u16) -> Option<Vec<u16>> {
    /// Bits of a part: wide arguments, more parts, and one, two or four numbers of a map.
    const WIDE: u16 = 0x1;
    const MORE: u16 = 0x20;
    const MAPS: [(u16, usize); 3] = [(0x8, 2), (0x40, 4), (0x80, 8)];
    let word = |bytes: &[u8], at: usize| Some(u16::from_be_bytes(*bytes.get(at..)?.first_chunk()?));
    let index = usize::from(glyph);
    let start = match is_long {
        true => u32::from_be_bytes(*loca.get(4 * index..)?.first_chunk()?) as usize,
        false => 2 * usize::from(word(loca, 2 * index)?),
    };
    let own = glyf.get(start..)?;
    let mut parts = Vec::new();
    // Composed glyphs say that they have less than no contours.
    if word(own, 0)? as i16 >= 0 {
        return Some(parts);
    }
    let mut at = 10;
    loop {
        let flags = word(own, at)?;
        parts.push(word(own, at + 2)?);
        let map: usize = MAPS.iter().filter(|(bit, _)| flags & bit != 0).map(|(_, bytes)| bytes).sum();
        at += 4 + if flags & WIDE != 0 { 4 } else { 2 } + map;
        if flags & MORE == 0 {
            return Some(parts);
        }
    }
}

/// Collects contours.
#[derive(Default)]
struct Pen {
    contours: Vec<GlyphContour>,
    /// Where the glyph is, in font units.
    origin: [f64; 2],
    /// Em of a font unit.
    scale: f64,
    points: usize,
}

impl Pen {
    fn at(&mut self, x: f32, y: f32) -> [f64; 2] {
        self.points += 1;
        [(self.origin[0] + f64::from(x)) * self.scale, (self.origin[1] + f64::from(y)) * self.scale]
    }

    fn add(&mut self, segment: GlyphSegment) {
        if let Some(contour) = self.contours.last_mut() {
            contour.segments.push(segment);
        }
    }
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        let start = self.at(x, y);
        self.contours.push(GlyphContour { start, segments: Vec::new() });
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let end = self.at(x, y);
        self.add(GlyphSegment::Line(end));
    }

    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        let segment = GlyphSegment::Quadratic(self.at(cx, cy), self.at(x, y));
        self.add(segment);
    }

    fn curve_to(&mut self, ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32) {
        let segment = GlyphSegment::Cubic(self.at(ax, ay), self.at(bx, by), self.at(x, y));
        self.add(segment);
    }

    /// Every contour is closed, said or not; one of a single point is none.
    fn close(&mut self) {
        if self.contours.last().is_some_and(|contour| contour.segments.is_empty()) {
            self.contours.pop();
        }
    }
}

#[cfg(test)]
mod tests;
