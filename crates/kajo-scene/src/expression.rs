//! Numbers as expressions: `2 * r + 1`, `sin(30 deg)`, `random(7, 0, 1)`; and functions of the place: `x^2 + y^2 - r`.
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

mod functions;

use std::f64::consts::PI;
use std::ops::Range;

use kajo_math::tape::{Binary, Node, Tape, TapeBuilder, Unary};

use self::functions::{FUNCTIONS, Function, constant};

/// Parentheses and signs within each other.
const DEEPEST: usize = 64;

/// The names of the variables of a [`Formula`], in the order of [`Tape`]'s: coordinates of a point.
pub(crate) const VARIABLES: [&str; 3] = ["x", "y", "z"];

/// Operations of a function at most.
const MOST_OPERATIONS: usize = 10_000;

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

/// What an expression with variables is.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Formula {
    /// The same everywhere.
    Number(f64),
    /// A function of the variables.
    Function(Tape),
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
/// * `value_of`: the values of names, which stand at these bytes
///
/// # Errors
/// What cannot be read or has no finite value, with its place.
pub(crate) fn evaluate(
    text: &str,
    start: usize,
    around: Around,
    value_of: &dyn Fn(&str, Range<usize>) -> Option<f64>,
) -> Result<Evaluated, ExpressionError> {
    let mut reader = Reader::new(text, start, around, value_of, &[]);
    let is_name =
        name_at(&text[start..]).is_some_and(|name| value_of(name, start..start + name.len()).is_some());
    let name_end = start + name_at(&text[start..]).map_or(0, str::len);
    let value = reader.sum()?;
    let end = reader.at;
    match value {
        Node::Constant(value) => Ok(Evaluated { value, end, is_name: is_name && end == name_end }),
        Node::Slot(_) => {
            Err(ExpressionError { message: "this is no number".to_owned(), at: start..end, help: None })
        }
    }
}

/// The function of the place that starts at byte `start` of `text`, as far as it reaches, and where it ends.
///
/// * `start`, `value_of`: as for [`evaluate`]; a variable hides a value of its name
///
/// # Errors
/// What cannot be read, and parts without variables that have no finite value, with the place.
pub(crate) fn formula(
    text: &str,
    start: usize,
    value_of: &dyn Fn(&str, Range<usize>) -> Option<f64>,
) -> Result<(Formula, usize), ExpressionError> {
    let mut reader = Reader::new(text, start, Around::Nothing, value_of, &VARIABLES);
    let value = reader.sum()?;
    let formula = match value {
        Node::Constant(number) => Formula::Number(number),
        Node::Slot(_) => Formula::Function(reader.tape.finish(value)),
    };
    Ok((formula, reader.at))
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

struct Reader<'a> {
    text: &'a str,
    at: usize,
    value_of: &'a dyn Fn(&str, Range<usize>) -> Option<f64>,
    /// The names of variables.
    variables: &'static [&'static str],
    tape: TapeBuilder,
    /// Parentheses open, and one more where nothing is around: between them blanks mean nothing.
    open: usize,
    depth: usize,
}

impl<'a> Reader<'a> {
    fn new(
        text: &'a str,
        start: usize,
        around: Around,
        value_of: &'a dyn Fn(&str, Range<usize>) -> Option<f64>,
        variables: &'static [&'static str],
    ) -> Reader<'a> {
        let open = usize::from(around == Around::Nothing);
        Reader { text, at: start, value_of, variables, tape: TapeBuilder::new(), open, depth: 0 }
    }

    fn sum(&mut self) -> Result<Node, ExpressionError> {
        let start = self.at;
        let mut sum = self.product()?;
        while let Some(operator) = self.operator(b"+-") {
            let right = self.product()?;
            let operator = if operator == b'+' { Binary::Add } else { Binary::Sub };
            let value = self.tape.binary(operator, sum, right);
            sum = self.checked(value, start)?;
        }
        Ok(sum)
    }

    fn product(&mut self) -> Result<Node, ExpressionError> {
        let start = self.at;
        let mut product = self.signed()?;
        while let Some(operator) = self.operator(b"*/%") {
            let divisor = self.at;
            let right = self.signed()?;
            if operator != b'*' && right == Node::Constant(0.0) {
                let shown = self.text[divisor..self.at].trim_start();
                let at = self.at - shown.len()..self.at;
                return Err(ExpressionError { message: "division by zero".to_owned(), at, help: None });
            }
            let operator = match operator {
                b'*' => Binary::Mul,
                b'/' => Binary::Div,
                // With the sign of the divisor, so that angles and numbers of rows wrap as one expects.
                _ => Binary::Modulo,
            };
            let value = self.tape.binary(operator, product, right);
            product = self.checked(value, start)?;
        }
        Ok(product)
    }

    fn signed(&mut self) -> Result<Node, ExpressionError> {
        self.blanks();
        self.depth += 1;
        if self.depth > DEEPEST {
            let message = format!("parentheses and signs stand more than {DEEPEST} deep in each other");
            return Err(ExpressionError { message, at: self.at..self.at + 1, help: None });
        }
        let value = match self.peek() {
            Some(b'-') => {
                self.at += 1;
                let value = self.signed()?;
                self.tape.unary(Unary::Neg, value)
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

    fn power(&mut self) -> Result<Node, ExpressionError> {
        let start = self.at;
        let base = self.unit()?;
        if self.operator(b"^").is_none() {
            return Ok(base);
        }
        let exponent = self.signed()?;
        let value = self.tape.binary(Binary::Pow, base, exponent);
        self.checked(value, start)
    }

    fn unit(&mut self) -> Result<Node, ExpressionError> {
        let value = self.primary()?;
        let rest = self.text[self.at..].trim_start();
        if self.open > 0 && name_at(rest) == Some("deg") {
            self.at = self.text.len() - rest.len() + "deg".len();
            return Ok(self.tape.mul(value, Node::Constant(PI / 180.0)));
        }
        Ok(value)
    }

    fn primary(&mut self) -> Result<Node, ExpressionError> {
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
                Ok(Node::Constant(value))
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

    fn named(&mut self, name: &str) -> Result<Node, ExpressionError> {
        let at = self.at..self.at + name.len();
        self.at = at.end;
        if let Some(function) = FUNCTIONS.iter().find(|function| function.name == name) {
            return self.call(function, at);
        }
        if let Some(i) = self.variables.iter().position(|variable| *variable == name) {
            return Ok(self.tape.variable(i as u32));
        }
        if let Some(value) = (self.value_of)(name, at.clone()).or_else(|| constant(name)) {
            return Ok(Node::Constant(value));
        }
        let what = if self.text[self.at..].starts_with('(') { "function" } else { "value" };
        let functions = || FUNCTIONS.iter().map(|function| function.name).chain(["pi", "tau"]);
        let near = crate::nearest::nearest(name, functions()).map(|near| format!("did you mean `{near}`?"));
        let help = near.or_else(|| (what == "value").then(|| format!("write `let {name} = 1` before it")));
        Err(ExpressionError { message: format!("there is no {what} named `{name}`"), at, help })
    }

    fn call(&mut self, function: &Function, name: Range<usize>) -> Result<Node, ExpressionError> {
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
        let Some(value) = (function.apply)(&mut self.tape, &arguments) else {
            let message = format!("what `{}` is called with must be the same everywhere", function.name);
            return wrong(name.start..self.at, message);
        };
        let finite = self.checked(value, name.start);
        finite.map_err(|error| match value {
            Node::Constant(_) => {
                let shown: Vec<String> = arguments.iter().map(shown).collect();
                let message = format!("`{}` has no finite value at {}", function.name, shown.join(", "));
                ExpressionError { message, at: name.start..self.at, help: None }
            }
            Node::Slot(_) => error,
        })
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

    /// The value of what begins at `start`, if it is a finite number or a function that is not too long.
    fn checked(&self, value: Node, start: usize) -> Result<Node, ExpressionError> {
        let message = match value {
            Node::Constant(number) if !number.is_finite() => "this has no finite value".to_owned(),
            _ if self.tape.len() > MOST_OPERATIONS => {
                format!("a function has at most {MOST_OPERATIONS} operations")
            }
            _ => return Ok(value),
        };
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

fn shown(argument: &Node) -> String {
    match argument {
        Node::Constant(number) => number.to_string(),
        Node::Slot(_) => "a function".to_owned(),
    }
}

#[cfg(test)]
mod tests;
