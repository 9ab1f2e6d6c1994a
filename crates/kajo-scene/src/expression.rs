//! Numbers as expressions: `2 * r + 1`, `sin(30 deg)`, `random(7, 0, 1)`.
//!
//! ```text
//! sum      = product { ("+" | "-") product }
//! product  = signed { ("*" | "/" | "%") signed }
//! signed   = ("+" | "-") signed | power
//! power    = unit [ "^" signed ]
//! unit     = primary [ "deg" ]
//! primary  = number | name | function "(" sum { "," sum } ")" | "(" sum ")"
//! ```
//!
//! Angles are in radians, and `deg` makes them of degrees. All is done in double precision, by functions with the same
//! bits on every machine.
//!
//! A list of numbers has blanks between them and no commas, so that outside of parentheses `1 -2` are two numbers and
//! `1 - 2` is one: there a `+` or `-` joins two terms only where blanks stand on both its sides.

use kajo_math::fmath;
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// Parentheses and signs within each other.
const DEEPEST: usize = 64;

/// What an expression is worth, and where it ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Evaluated {
    /// A finite number.
    pub value: f64,
    /// One past its last byte.
    pub end: usize,
    /// Whether it is the name of a value and nothing else.
    pub is_name: bool,
}

/// Why there is no value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ExpressionError {
    /// What is wrong.
    pub message: String,
    /// The bytes it is about.
    pub at: Range<usize>,
    /// What could be done.
    pub help: Option<String>,
}

/// Where an expression stands.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Around {
    /// In a list of numbers, of which it may be one.
    List,
    /// Alone: all that can belong to it does.
    Nothing,
}

/// The value of the expression that starts at byte `start` of `text`, as far as it reaches.
///
/// * `start`: where a number, a name, a function, a sign or a parenthesis stands
/// * `value_of`: the values of names
///
/// # Errors
/// What cannot be read or has no finite value, with its place.
pub(crate) fn evaluate(
    text: &str,
    start: usize,
    around: Around,
    value_of: &dyn Fn(&str) -> Option<f64>,
) -> Result<Evaluated, ExpressionError> {
    let open = usize::from(around == Around::Nothing);
    let mut reader = Reader { text, at: start, value_of, open, depth: 0 };
    let is_name = name_at(&text[start..]).is_some_and(|name| value_of(name).is_some());
    let name_end = start + name_at(&text[start..]).map_or(0, str::len);
    let value = reader.sum()?;
    Ok(Evaluated { value, end: reader.at, is_name: is_name && reader.at == name_end })
}

/// The name at the start of `text`: letters, digits and `_`, the first no digit.
pub(crate) fn name_at(text: &str) -> Option<&str> {
    let end = text.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(text.len());
    let is_name = text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    is_name.then(|| &text[..end])
}

/// Whether a function has this name.
pub(crate) fn is_function(name: &str) -> bool {
    FUNCTIONS.iter().any(|function| function.name == name)
}

/// Whether a name stands for something in every expression, so that no value may be given to it.
pub(crate) fn is_reserved(name: &str) -> bool {
    is_function(name) || name == "deg" || constant(name).is_some()
}

fn constant(name: &str) -> Option<f64> {
    match name {
        "pi" => Some(PI),
        "tau" => Some(TAU),
        _ => None,
    }
}

/// A function of expressions.
struct Function {
    name: &'static str,
    /// How it is written, for messages.
    usage: &'static str,
    /// Least and most arguments.
    arguments: (usize, usize),
    value: fn(&[f64]) -> f64,
}

impl Function {
    const fn one(name: &'static str, usage: &'static str, value: fn(&[f64]) -> f64) -> Function {
        Function { name, usage, arguments: (1, 1), value }
    }

    const fn of(n: usize, name: &'static str, usage: &'static str, value: fn(&[f64]) -> f64) -> Function {
        Function { name, usage, arguments: (n, n), value }
    }
}

const FUNCTIONS: [Function; 24] = [
    Function::one("sin", "sin(x)", |v| fmath::sin64(v[0])),
    Function::one("cos", "cos(x)", |v| fmath::cos64(v[0])),
    Function::one("tan", "tan(x)", |v| fmath::tan64(v[0])),
    Function::one("asin", "asin(x)", |v| fmath::asin64(v[0])),
    Function::one("acos", "acos(x)", |v| fmath::acos64(v[0])),
    Function::one("atan", "atan(x)", |v| fmath::atan64(v[0])),
    Function::of(2, "atan2", "atan2(y, x)", |v| fmath::atan2_64(v[0], v[1])),
    Function::one("sqrt", "sqrt(x)", |v| v[0].sqrt()),
    Function::one("exp", "exp(x)", |v| fmath::exp64(v[0])),
    Function::one("ln", "ln(x)", |v| fmath::ln64(v[0])),
    Function::one("abs", "abs(x)", |v| v[0].abs()),
    Function::one("sign", "sign(x)", |v| if v[0] == 0.0 { 0.0 } else { v[0].signum() }),
    Function::one("floor", "floor(x)", |v| v[0].floor()),
    Function::one("ceil", "ceil(x)", |v| v[0].ceil()),
    Function::one("round", "round(x)", |v| v[0].round()),
    Function::one("fract", "fract(x)", |v| v[0] - v[0].floor()),
    Function {
        name: "min",
        usage: "min(a, b, ...)",
        arguments: (1, 16),
        value: |v| v.iter().copied().fold(f64::INFINITY, f64::min),
    },
    Function {
        name: "max",
        usage: "max(a, b, ...)",
        arguments: (1, 16),
        value: |v| v.iter().copied().fold(f64::NEG_INFINITY, f64::max),
    },
    Function::of(3, "clamp", "clamp(x, low, high)", |v| v[0].max(v[1]).min(v[2])),
    Function::of(3, "mix", "mix(a, b, t)", |v| v[0] * (1.0 - v[2]) + v[1] * v[2]),
    Function::of(2, "step", "step(edge, x)", |v| if v[1] < v[0] { 0.0 } else { 1.0 }),
    Function::of(3, "smoothstep", "smoothstep(low, high, x)", |v| {
        let t = ((v[2] - v[0]) / (v[1] - v[0])).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    }),
    Function::of(2, "hypot", "hypot(x, y)", |v| (v[0] * v[0] + v[1] * v[1]).sqrt()),
    Function::of(3, "random", "random(seed, low, high)", |v| v[1] + (v[2] - v[1]) * random(v[0])),
];

/// A number in [0, 1) that looks like no other seed's: the output function of SplitMix64 [Steele et al. 2014].
fn random(seed: f64) -> f64 {
    // Zero has two signs.
    let mut z = (seed + 0.0).to_bits().wrapping_add(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 * f64::from_bits(0x3CA0_0000_0000_0000)
}

struct Reader<'a> {
    text: &'a str,
    at: usize,
    value_of: &'a dyn Fn(&str) -> Option<f64>,
    /// Parentheses open, and one more where nothing is around: between them blanks mean nothing.
    open: usize,
    depth: usize,
}

impl Reader<'_> {
    fn sum(&mut self) -> Result<f64, ExpressionError> {
        let start = self.at;
        let mut sum = self.product()?;
        while let Some(operator) = self.operator(b"+-") {
            let right = self.product()?;
            sum = self.finite(if operator == b'+' { sum + right } else { sum - right }, start)?;
        }
        Ok(sum)
    }

    fn product(&mut self) -> Result<f64, ExpressionError> {
        let start = self.at;
        let mut product = self.signed()?;
        while let Some(operator) = self.operator(b"*/%") {
            let divisor = self.at;
            let right = self.signed()?;
            if operator != b'*' && right == 0.0 {
                let shown = self.text[divisor..self.at].trim_start();
                let at = self.at - shown.len()..self.at;
                return Err(ExpressionError { message: "division by zero".to_owned(), at, help: None });
            }
            let value = match operator {
                b'*' => product * right,
                b'/' => product / right,
                // With the sign of the divisor, so that angles and numbers of rows wrap as one expects.
                _ => product - right * (product / right).floor(),
            };
            product = self.finite(value, start)?;
        }
        Ok(product)
    }

    fn signed(&mut self) -> Result<f64, ExpressionError> {
        self.blanks();
        self.depth += 1;
        if self.depth > DEEPEST {
            let message = format!("parentheses and signs stand more than {DEEPEST} deep in each other");
            return Err(ExpressionError { message, at: self.at..self.at + 1, help: None });
        }
        let value = match self.peek() {
            Some(b'-') => {
                self.at += 1;
                -self.signed()?
            }
            Some(b'+') => {
                self.at += 1;
                self.signed()?
            }
            _ => self.power()?,
        };
        self.depth -= 1;
        Ok(value)
    }

    fn power(&mut self) -> Result<f64, ExpressionError> {
        let start = self.at;
        let base = self.unit()?;
        if self.operator(b"^").is_none() {
            return Ok(base);
        }
        let exponent = self.signed()?;
        self.finite(fmath::pow64(base, exponent), start)
    }

    fn unit(&mut self) -> Result<f64, ExpressionError> {
        let value = self.primary()?;
        let rest = self.text[self.at..].trim_start();
        if self.open > 0 && name_at(rest) == Some("deg") {
            self.at = self.text.len() - rest.len() + "deg".len();
            return Ok(value * (PI / 180.0));
        }
        Ok(value)
    }

    fn primary(&mut self) -> Result<f64, ExpressionError> {
        self.blanks();
        let rest = &self.text[self.at..];
        if rest.starts_with('(') {
            let open = self.at;
            self.at += 1;
            self.open += 1;
            let value = self.sum()?;
            self.close(open)?;
            return Ok(value);
        }
        if let Some(name) = name_at(rest) {
            return self.named(name);
        }
        let length = number_length(rest);
        match rest[..length].parse::<f64>() {
            Ok(value) if value.is_finite() => {
                self.at += length;
                Ok(value)
            }
            _ => {
                let found = rest.chars().next();
                let end = self.at + found.map_or(0, char::len_utf8);
                let message = match found {
                    Some(c) if !c.is_whitespace() => format!("expected a number, a name or `(`, found `{c}`"),
                    _ => "expected a number, a name or `(` at the end of this".to_owned(),
                };
                Err(ExpressionError { message, at: self.at..end, help: None })
            }
        }
    }

    fn named(&mut self, name: &str) -> Result<f64, ExpressionError> {
        let at = self.at..self.at + name.len();
        self.at = at.end;
        if let Some(function) = FUNCTIONS.iter().find(|function| function.name == name) {
            return self.call(function, at);
        }
        if let Some(value) = (self.value_of)(name).or_else(|| constant(name)) {
            return Ok(value);
        }
        let what = if self.text[self.at..].starts_with('(') { "function" } else { "value" };
        let functions = || FUNCTIONS.iter().map(|function| function.name).chain(["pi", "tau"]);
        let near = crate::nearest::nearest(name, functions()).map(|near| format!("did you mean `{near}`?"));
        let help = near.or_else(|| (what == "value").then(|| format!("write `let {name} = 1` before it")));
        Err(ExpressionError { message: format!("there is no {what} named `{name}`"), at, help })
    }

    fn call(&mut self, function: &Function, name: Range<usize>) -> Result<f64, ExpressionError> {
        let wrong = |at: Range<usize>, message: String| {
            Err(ExpressionError { message, at, help: Some(format!("it is written `{}`", function.usage)) })
        };
        if self.peek() != Some(b'(') {
            return wrong(name, format!("the function `{}` has no arguments", function.name));
        }
        let open = self.at;
        self.at += 1;
        self.open += 1;
        let mut arguments = Vec::new();
        loop {
            arguments.push(self.sum()?);
            self.blanks();
            if self.peek() != Some(b',') {
                break;
            }
            self.at += 1;
        }
        self.close(open)?;
        let (least, most) = function.arguments;
        if !(least..=most).contains(&arguments.len()) {
            let message = format!("`{}` takes no {} arguments", function.name, arguments.len());
            return wrong(name.start..self.at, message);
        }
        let value = (function.value)(&arguments);
        if value.is_finite() {
            return Ok(value);
        }
        let shown: Vec<String> = arguments.iter().map(f64::to_string).collect();
        let message = format!("`{}` has no finite value at {}", function.name, shown.join(", "));
        Err(ExpressionError { message, at: name.start..self.at, help: None })
    }

    fn close(&mut self, open: usize) -> Result<(), ExpressionError> {
        self.blanks();
        if self.peek() != Some(b')') {
            let message = "this `(` is not closed".to_owned();
            let found = self.text[self.at..].chars().next().filter(|c| !c.is_whitespace());
            let help = found.map(|c| format!("expected an operator, `,` or `)` before `{c}`"));
            return Err(ExpressionError { message, at: open..open + 1, help });
        }
        self.at += 1;
        self.open -= 1;
        Ok(())
    }

    /// Steps over the next sign if it is one of `wanted` and joins what is before it with what follows.
    fn operator(&mut self, wanted: &[u8]) -> Option<u8> {
        let rest = &self.text[self.at..];
        let behind = rest.trim_start();
        let operator = behind.bytes().next().filter(|byte| wanted.contains(byte))?;
        let blank_before = behind.len() < rest.len();
        let is_comment = behind.starts_with("//") || behind.starts_with("/*");
        let joins = match operator {
            b'+' | b'-' if self.open == 0 => {
                blank_before && behind[1..].starts_with(|c: char| c.is_whitespace())
            }
            _ => !is_comment,
        };
        joins.then(|| self.at = self.text.len() - behind.len() + 1)?;
        Some(operator)
    }

    fn finite(&self, value: f64, start: usize) -> Result<f64, ExpressionError> {
        if value.is_finite() {
            return Ok(value);
        }
        let message = "this has no finite value".to_owned();
        let start = self.at - self.text[start..self.at].trim_start().len();
        Err(ExpressionError { message, at: start..self.at, help: None })
    }

    fn blanks(&mut self) {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start().len();
    }

    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }
}

/// Bytes of the number without sign at the start of `text`.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let mut end = digits(0);
    if bytes.get(end) == Some(&b'.') {
        end += 1 + digits(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) && end > 0 {
        let signed = end + 1 + usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let exponent = bytes.get(signed..).map_or(0, |_| digits(signed));
        if exponent > 0 {
            end = signed + exponent;
        }
    }
    end
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn value_of(name: &str) -> Option<f64> {
        match name {
            "r" => Some(0.5),
            "i" => Some(3.0),
            _ => None,
        }
    }

    /// The value of all of `text`, or the message and the piece it is about.
    fn value(text: &str) -> Result<f64, (String, &str)> {
        match evaluate(text, 0, Around::List, &value_of) {
            Ok(found) => {
                assert_eq!(found.end, text.len(), "{text}");
                Ok(found.value)
            }
            Err(error) => Err((error.message, &text[error.at])),
        }
    }

    #[test]
    fn operators_bind_as_in_mathematics() {
        for (text, expected) in [
            ("2 * r + 1", 2.0),
            ("1 + 2 * 3", 7.0),
            ("(1 + 2) * 3", 9.0),
            ("2 ^ 3 ^ 2", 512.0),
            ("-2 ^ 2", -4.0),
            ("2 ^ -1", 0.5),
            ("8 / 4 / 2", 1.0),
            ("7 - 3 - 2", 2.0),
            ("-7 % 3", 2.0),
            ("--2", 2.0),
            ("(1-2)", -1.0),
            ("(1 -2)", -1.0),
            ("2*r", 1.0),
            (".5e1", 5.0),
            ("(2e)", f64::NAN),
            ("max(1, i, 2)", 3.0),
            ("( 4\n)", 4.0),
        ] {
            match value(text) {
                Ok(found) => assert_eq!(found, expected, "{text}"),
                Err(_) => assert!(expected.is_nan(), "{text}"),
            }
        }
    }

    #[test]
    fn functions_have_their_values() {
        for (text, expected) in [
            ("sin(30 deg)", 0.5),
            ("cos(pi)", -1.0),
            ("atan2(1, -1)", 0.75 * PI),
            ("acos(0)", 0.5 * PI),
            ("sqrt(2) ^ 2", 2.0),
            ("ln(exp(3))", 3.0),
            ("mix(2, 4, 0.25)", 2.5),
            ("clamp(7, 0, 1)", 1.0),
            ("smoothstep(0, 2, 1)", 0.5),
            ("sign(-3) + step(1, 2) + fract(-0.25) + hypot(3, 4)", 5.75),
        ] {
            let found = value(text).unwrap();
            assert!((found - expected).abs() < 1e-15 * expected.abs().max(1.0), "{text}: {found}");
        }
        for function in &FUNCTIONS {
            assert!(function.usage.starts_with(&format!("{}(", function.name)));
            assert!(is_reserved(function.name));
        }
    }

    #[test]
    fn random_numbers_fill_their_range_evenly() {
        let n = 4096;
        let drawn: Vec<f64> = (0..n).map(|i| random(f64::from(i))).collect();
        let mean = drawn.iter().sum::<f64>() / f64::from(n);
        // The standard deviation of the mean is 0.0045.
        assert!((mean - 0.5).abs() < 0.018, "{mean}");
        let mut bins = [0_u32; 16];
        drawn.iter().for_each(|x| bins[(x * 16.0) as usize] += 1);
        let chi_square: f64 = bins.iter().map(|&n| (f64::from(n) - 256.0).powi(2) / 256.0).sum();
        // One in ten thousand lies above 44.3 with 15 degrees of freedom.
        assert!(chi_square < 44.3, "{chi_square}");
        let neighbours: f64 = drawn.windows(2).map(|pair| (pair[0] - 0.5) * (pair[1] - 0.5)).sum();
        assert!((neighbours * 12.0 / f64::from(n)).abs() < 4.0 / f64::from(n).sqrt());
        assert_eq!(value("random(0, 2, 3)"), value("random(-0, 2, 3)"));
        assert!((2.0..3.0).contains(&value("random(7, 2, 3)").unwrap()));
    }

    #[test]
    fn an_expression_ends_where_a_list_goes_on() {
        for (text, end) in [("1 -2", 1), ("r -r", 1), ("1 - 2 3", 5), ("r 4", 1), ("2 // c", 1), ("3 deg", 1)]
        {
            assert_eq!(evaluate(text, 0, Around::List, &value_of).unwrap().end, end, "{text}");
        }
        for (text, end) in [("1 -2 3", 4), ("2 * 3 deg c", 9), ("1-2", 3)] {
            assert_eq!(evaluate(text, 0, Around::Nothing, &value_of).unwrap().end, end, "{text}");
        }
        let names = ["r", "r + 1", "(r)", "2"]
            .map(|text| evaluate(text, 0, Around::List, &value_of).unwrap().is_name);
        assert_eq!(names, [true, false, false, false]);
    }

    #[test]
    fn mistakes_have_a_place() {
        for (text, message, place) in [
            ("1 / (i - 3)", "division by zero", "(i - 3)"),
            ("4 % 0", "division by zero", "0"),
            ("2 * q", "there is no value named `q`", "q"),
            ("sqrt(0 - 1)", "`sqrt` has no finite value at -1", "sqrt(0 - 1)"),
            ("1 + ln(0)", "`ln` has no finite value at 0", "ln(0)"),
            ("(1 + 2", "this `(` is not closed", "("),
            ("(1 2)", "this `(` is not closed", "("),
            ("sin(1, 2)", "`sin` takes no 2 arguments", "sin(1, 2)"),
            ("sin * 2", "the function `sin` has no arguments", "sin"),
            ("(2 * )", "expected a number, a name or `(`, found `)`", ")"),
            ("2 *", "expected a number, a name or `(` at the end of this", ""),
            ("1e300 * 1e300", "this has no finite value", "1e300 * 1e300"),
            ("sine(1)", "there is no function named `sine`", "sine"),
            ("0 ^ -1", "this has no finite value", "0 ^ -1"),
        ] {
            assert_eq!(value(text), Err((message.to_owned(), place)), "{text}");
        }
        let deep = "(".repeat(100) + "1" + &")".repeat(100);
        assert!(value(&deep).unwrap_err().0.contains("more than 64 deep"));
        assert!(value(&("-".repeat(1_000_000) + "1")).is_err(), "no stack overflow");
    }

    proptest! {
        #[test]
        fn sums_and_products_are_those_of_rust(a in -1e3..1e3f64, b in -1e3..1e3f64, c in 1e-3..1e3f64) {
            let text = format!("{a:?} * {b:?} - {b:?} / {c:?}");
            prop_assert_eq!(value(&text), Ok(a * b - b / c));
        }

        #[test]
        fn any_text_ends_in_a_value_or_a_message(text in "[-+*/%^() ,.0-9a-zé]{0,30}") {
            match evaluate(&text, 0, Around::List, &value_of) {
                Ok(found) => prop_assert!(found.value.is_finite() && text.is_char_boundary(found.end)),
                Err(error) => prop_assert!(text.get(error.at).is_some()),
            }
        }
    }
}
