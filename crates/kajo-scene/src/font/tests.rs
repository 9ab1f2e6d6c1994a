use super::*;

/// The typeface of the gallery: an em of 1000 units, ascent 750, descent 230, gap 120; `ka` is kerned by -40.
const FONT: &[u8] = include_bytes!("../../../../scenes/gallery/fonts/kajo.ttf");

fn style() -> TextStyle {
    TextStyle { face: 0, align: TextAlign::Left, line_spacing: 1.0, letter_spacing: 0.0, weight: None }
}

fn set(lines: &[&str], style: &TextStyle) -> TextOutlines {
    text_outlines(FONT, lines, style).unwrap()
}

/// Least and greatest x, then y, of the points on curves.
fn extent(outlines: &TextOutlines) -> [[f64; 2]; 2] {
    let end = |segment: &GlyphSegment| match *segment {
        GlyphSegment::Line(p) | GlyphSegment::Quadratic(_, p) | GlyphSegment::Cubic(_, _, p) => p,
    };
    let points = outlines
        .contours
        .iter()
        .flat_map(|contour| std::iter::once(contour.start).chain(contour.segments.iter().map(end)));
    points.fold([[f64::INFINITY, f64::NEG_INFINITY]; 2], |all, p| {
        std::array::from_fn(|axis| [all[axis][0].min(p[axis]), all[axis][1].max(p[axis])])
    })
}

fn is_near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-12
}

#[test]
fn glyphs_follow_each_other_by_their_advances_and_kerning() {
    let l = set(&["l"], &style());
    assert_eq!(l.contours.len(), 1);
    let corners = extent(&l);
    assert!(is_near(corners[0][0], 0.06) && is_near(corners[0][1], 0.17), "{corners:?}");
    assert!(is_near(corners[1][0], 0.0) && is_near(corners[1][1], 0.75), "{corners:?}");
    // k 540, kerned by -40, then the stem of an a up to 525.
    assert!(is_near(extent(&set(&["ka"], &style()))[0][1], 0.54 - 0.04 + 0.525));
    assert!(is_near(extent(&set(&["la"], &style()))[0][1], 0.23 + 0.525));
    assert!(is_near(extent(&set(&["l l"], &style()))[0][1], 0.23 + 0.28 + 0.17));
    let wide = TextStyle { letter_spacing: 0.1, ..style() };
    assert!(is_near(extent(&set(&["la"], &wide))[0][1], 0.33 + 0.525));
}

#[test]
fn lines_are_aligned_one_below_the_other() {
    let lines = ["lll", "l"];
    let expected =
        [(TextAlign::Left, 0.17), (TextAlign::Center, 0.5 * 0.69 - 0.06), (TextAlign::Right, -0.06)];
    for (align, right) in expected {
        let set = set(&lines, &TextStyle { align, line_spacing: 2.0, ..style() });
        assert_eq!(set.contours.len(), 4);
        let last = TextOutlines { contours: set.contours[3..].to_vec(), missing: Vec::new() };
        let [[left, right_of_last], [bottom, top]] = extent(&last);
        // Twice ascent, descent and gap.
        assert!(is_near(bottom, -2.2) && is_near(top, -2.2 + 0.75), "{align:?}");
        match align {
            TextAlign::Left => assert!(is_near(right_of_last, right)),
            TextAlign::Center => assert!(is_near(left, -0.115 + 0.06)),
            TextAlign::Right => assert!(is_near(right_of_last, right)),
        }
    }
}

#[test]
fn what_the_font_has_no_glyph_for_is_told_once() {
    let outlines = set(&["lxé x", "l"], &style());
    assert_eq!(outlines.missing, ['x', 'é']);
    // In their place is the glyph for what is missing, of two contours.
    assert_eq!(outlines.contours.len(), 2 + 3 * 2);
    assert!(set(&[" "], &style()).contours.is_empty());
    assert!(set(&[], &style()).contours.is_empty());
}

/// Round letters are parabolas that stay near their circles.
#[test]
fn curves_are_kept() {
    let o = set(&["o"], &style());
    assert_eq!(o.contours.len(), 2);
    let mut curves = 0;
    for segment in &o.contours[0].segments {
        if let GlyphSegment::Quadratic(c, p) = *segment {
            curves += 1;
            let radius = |[x, y]: [f64; 2]| (x - 0.275).hypot(y - 0.25);
            assert!((radius(p) - 0.25).abs() < 1e-3 && (radius(c) - 0.2706).abs() < 2e-3);
        }
    }
    assert_eq!(curves, 8);
}

#[test]
fn what_is_no_font_is_refused() {
    let refused =
        |bytes: &[u8], style: &TextStyle| text_outlines(bytes, &["kajo"], style).unwrap_err().to_string();
    assert!(refused(b"", &style()).contains("no TrueType or OpenType font"));
    assert!(refused(b"solid cube\nendsolid", &style()).contains("no TrueType or OpenType font"));
    assert!(refused(FONT, &TextStyle { face: 1, ..style() }).contains("`face` must be less than 1"));
    let long = "l".repeat(10_001);
    assert!(matches!(text_outlines(FONT, &[long], &style()), Err(FontError::TooLong)));
}

/// A font cut short or with a byte changed is set as far as it makes sense, or refused; nothing else.
#[test]
fn damaged_fonts_do_no_harm() {
    for cut in 0..FONT.len() {
        let _ = text_outlines(&FONT[..cut], &["kajo text"], &style());
    }
    let mut bytes = FONT.to_vec();
    let mut refused = 0;
    for i in 0..FONT.len() {
        for change in [1, 0x80, 0xff] {
            bytes[i] ^= change;
            refused += u32::from(text_outlines(&bytes, &["kajo text"], &style()).is_err());
            bytes[i] ^= change;
        }
    }
    assert!(refused > 100, "{refused}");
}
