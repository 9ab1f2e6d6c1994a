//! Text in a TrueType or OpenType font, as outlines.
//!
//! Lines are shaped as HarfBuzz does it (kerning, ligatures, scripts that join or reorder letters), in font units, which are
//! whole numbers: so every machine puts the glyphs at the same places. Outlines are not hinted.

use std::collections::BTreeSet;

use harfrust::{ShapeOptions, ShaperData, ShaperInstance, UnicodeBuffer, Variation};
use skrifa::instance::{Location, Size};
use skrifa::outline::{DrawError, DrawSettings, OutlinePen};
use skrifa::raw::tables::glyf::Glyph;
use skrifa::raw::{FileRef, ReadError, TableProvider};
use skrifa::{FontRef, GlyphId, MetadataProvider, Tag};

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
    /// Settings of a variable font, such as `wght` 700; axes that it does not have are left out.
    pub axes: Vec<(String, f32)>,
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
    /// Characters that the font has no glyph for, once each.
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
    NotAFont(ReadError),
    /// A collection has fewer fonts.
    #[error("it has {count} fonts, so `face` must be less than {count}")]
    NoSuchFace {
        /// How many there are.
        count: u32,
    },
    /// Glyphs are pictures, or there are none.
    #[error("it has no outlines")]
    NoOutlines,
    /// The font says that an em has no units.
    #[error("its header is damaged")]
    BadHeader,
    /// A glyph is damaged.
    #[error("the outline of glyph {glyph} is damaged ({reason})")]
    BadGlyph {
        /// Its number.
        glyph: u32,
        /// What is wrong.
        reason: DrawError,
    },
    /// A glyph is made of one without points, or of too many.
    #[error(
        "the outline of glyph {glyph} is damaged (a part of it has no points, or there are too many parts)"
    )]
    BadParts {
        /// Its number.
        glyph: u32,
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
    let font = face(bytes, style.face)?;
    let characters: usize = lines.iter().map(|line| line.as_ref().chars().count()).sum();
    if characters > LONGEST_TEXT {
        return Err(FontError::TooLong);
    }
    if font.outline_glyphs().format().is_none() {
        return Err(FontError::NoOutlines);
    }
    let mut setter = Setter::new(font, style)?;
    for (i, line) in lines.iter().enumerate() {
        setter.line(line.as_ref(), -(i as f64) * setter.leading)?;
    }
    let mut missing = BTreeSet::new();
    let charmap = setter.font.charmap();
    for line in lines {
        let absent = |c: &char| !c.is_whitespace() && !c.is_control() && charmap.map(*c).is_none();
        missing.extend(line.as_ref().chars().filter(absent));
    }
    Ok(TextOutlines { contours: setter.pen.contours, missing: missing.into_iter().collect() })
}

/// One font of a file.
fn face(bytes: &[u8], index: u32) -> Result<FontRef<'_>, FontError> {
    match FileRef::new(bytes).map_err(FontError::NotAFont)? {
        FileRef::Font(font) if index == 0 => Ok(font),
        FileRef::Font(_) => Err(FontError::NoSuchFace { count: 1 }),
        FileRef::Collection(all) if index < all.len() => all.get(index).map_err(FontError::NotAFont),
        FileRef::Collection(all) => Err(FontError::NoSuchFace { count: all.len() }),
    }
}

/// Puts glyphs one after the other.
struct Setter<'a> {
    font: FontRef<'a>,
    location: Location,
    shaping: ShaperData,
    instance: ShaperInstance,
    style: &'a TextStyle,
    /// Font units of an em.
    em: f64,
    /// From one baseline to the next, in em.
    leading: f64,
    pen: Pen,
}

impl<'a> Setter<'a> {
    fn new(font: FontRef<'a>, style: &'a TextStyle) -> Result<Setter<'a>, FontError> {
        let tag = |name: &str| Tag::new_checked(name.as_bytes()).ok();
        let settings = || style.axes.iter().filter_map(|(name, value)| Some((tag(name)?, *value)));
        let location = font.axes().location(settings());
        let metrics = font.metrics(Size::unscaled(), &location);
        if metrics.units_per_em == 0 {
            return Err(FontError::BadHeader);
        }
        let em = f64::from(metrics.units_per_em);
        let height = f64::from(metrics.ascent) - f64::from(metrics.descent) + f64::from(metrics.leading);
        let asked = if height > 0.0 { height / em } else { 1.0 };
        let variations = settings().map(|(tag, value)| Variation { tag, value });
        Ok(Setter {
            shaping: ShaperData::new(&font),
            instance: ShaperInstance::from_variations(&font, variations),
            leading: style.line_spacing * asked,
            pen: Pen { scale: 1.0 / em, ..Pen::default() },
            font,
            location,
            style,
            em,
        })
    }

    /// Sets a line on the baseline at a height.
    fn line(&mut self, text: &str, y: f64) -> Result<(), FontError> {
        let mut buffer = UnicodeBuffer::new();
        buffer.push_str(text);
        buffer.guess_segment_properties();
        let shaper = self.shaping.shaper(&self.font).instance(Some(&self.instance)).build();
        let set = shaper.shape(buffer, ShapeOptions::new());
        let (glyphs, places) = (set.glyph_infos(), set.glyph_positions());
        let extra = self.style.letter_spacing * self.em;
        let advances: f64 = places.iter().map(|place| f64::from(place.x_advance)).sum();
        let width = advances + extra * glyphs.len().saturating_sub(1) as f64;
        let mut x = match self.style.align {
            TextAlign::Left => 0.0,
            TextAlign::Center => -0.5 * width,
            TextAlign::Right => -width,
        };
        let outlines = self.font.outline_glyphs();
        for (glyph, place) in glyphs.iter().zip(places) {
            self.pen.origin = [x + f64::from(place.x_offset), y * self.em + f64::from(place.y_offset)];
            let id = GlyphId::new(glyph.glyph_id);
            self.check(id)?;
            if let Some(outline) = outlines.get(id) {
                let settings = DrawSettings::unhinted(Size::unscaled(), &self.location);
                let damaged = |reason| FontError::BadGlyph { glyph: glyph.glyph_id, reason };
                outline.draw(settings, &mut self.pen).map_err(damaged)?;
            }
            if self.pen.points > MOST_POINTS {
                return Err(FontError::TooLong);
            }
            x += f64::from(place.x_advance) + extra;
        }
        Ok(())
    }
}

impl Setter<'_> {
    /// Refuses glyphs that those who draw outlines do not expect: with parts that have no points, or parts without end.
    fn check(&self, id: GlyphId) -> Result<(), FontError> {
        const MOST_PARTS: u32 = 1000;
        let (Ok(loca), Ok(glyf)) = (self.font.loca(None), self.font.glyf()) else { return Ok(()) };
        let bad = Err(FontError::BadParts { glyph: id.to_u32() });
        let (mut left, mut parts) = (vec![id], 0);
        while let Some(part) = left.pop() {
            parts += 1;
            match loca.get_glyf(part, &glyf) {
                _ if parts > MOST_PARTS => return bad,
                Ok(Some(Glyph::Simple(simple))) if simple.num_points() == 0 => return bad,
                Ok(Some(Glyph::Composite(parts))) => {
                    left.extend(parts.components().map(|part| GlyphId::from(part.glyph)));
                }
                _ => {}
            }
        }
        Ok(())
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

impl OutlinePen for Pen {
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
