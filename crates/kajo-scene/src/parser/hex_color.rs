//! Colours as the web writes them: `#ff8000` after a key is a comment here, and nobody meant it to be one.

use super::Parser;
use crate::diagnostic::Diagnostic;
use crate::edit::format_number;
use crate::source::Span;
use kajo_math::fmath;

impl Parser<'_> {
    /// Reports a colour in hexadecimal digits that follows a key on its line, and takes its numbers for the value.
    ///
    /// * `key`: the key, the last item begun
    ///
    /// Returns where reading goes on.
    pub(super) fn hex_color(&mut self, key: Span, text: &str) -> Option<u32> {
        let rest = &text[key.end as usize..];
        // Blocks begin with a large letter, and a comment after their word is one.
        let is_key = text[key.start as usize..].starts_with(|c: char| c.is_ascii_lowercase());
        let digits = rest.trim_start_matches([' ', '\t']).strip_prefix('#').filter(|_| is_key)?;
        let len = digits.bytes().take_while(u8::is_ascii_hexdigit).count();
        let ends = digits[len..].bytes().next().is_none_or(|b| b.is_ascii_whitespace() || b == b'}');
        let rgb = linear(&digits[..len]).filter(|_| ends)?;
        let end = (text.len() - digits.len() + len) as u32;
        let span = Span { start: end - len as u32 - 1, end, ..key };
        let [hex, key] = [span, key].map(|span| text[span.start as usize..span.end as usize].to_owned());
        let numbers = rgb.map(|v| format_number((v * 1e4).round() / 1e4)).join(" ");
        let error = Diagnostic::error(format!("`{hex}` is a comment, not a colour: `#` begins one"));
        let help = format!("colours are linear red, green and blue: `{key} {numbers}` is that colour");
        self.error(error.label(span, "a comment").help(help));
        if let Some(taker) = self.number_taker() {
            rgb.into_iter().for_each(|value| self.add_number(taker, span, value));
        }
        Some(end)
    }
}

/// Linear light of 3, 6 or 8 hexadecimal digits in sRGB; what stands behind six of them is opacity.
fn linear(digits: &str) -> Option<[f64; 3]> {
    let channel = |i: usize| {
        let value = match digits.len() {
            3 => u32::from_str_radix(&digits[i..=i], 16).ok()? * 17,
            6 | 8 => u32::from_str_radix(&digits[2 * i..2 * i + 2], 16).ok()?,
            _ => return None,
        };
        let v = f64::from(value) / 255.0;
        Some(if v <= 0.040_45 { v / 12.92 } else { f64::from(fmath::pow((v as f32 + 0.055) / 1.055, 2.4)) })
    };
    Some([channel(0)?, channel(1)?, channel(2)?])
}

#[cfg(test)]
mod tests {
    use crate::{SceneDesc, Severity};

    fn said(text: &str) -> Vec<(String, String)> {
        let parsed = SceneDesc::parse_str(text);
        let errors = parsed.diagnostics.iter().filter(|d| d.severity == Severity::Error);
        errors.map(|d| (d.message.clone(), d.help.clone().unwrap_or_default())).collect()
    }

    #[test]
    fn a_colour_of_the_web_is_said_to_be_a_comment() {
        for (text, help) in [
            ("Matte { color #ff0000 }\nMatte { }", "`color 1 0 0` is that colour"),
            ("Matte { color #08F\n}", "`color 0 0.2462 1` is that colour"),
            ("Matte { color\t#808080ff }", "`color 0.2159 0.2159 0.2159` is that colour"),
        ] {
            let said = said(text);
            assert_eq!(said.len(), 1, "{text}: {said:?}");
            assert!(said[0].0.ends_with("is a comment, not a colour: `#` begins one"), "{said:?}");
            assert!(said[0].1.contains(help), "{said:?}");
        }
    }

    #[test]
    fn other_comments_stay_comments() {
        for text in
            ["Matte #facade\n{ color 1 1 1 }", "a 1 #ff0000", "a # ff0000\n1", "a #ff00\n1", "a #ff0000x\n1"]
        {
            assert!(said(text).is_empty(), "{text}");
        }
    }
}
