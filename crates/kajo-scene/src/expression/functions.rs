//! The functions and constants of expressions.

use std::f64::consts::{PI, TAU};

use kajo_math::tape::{Binary, Node, TapeBuilder, Unary};

/// The constant with a name.
pub(super) fn constant(name: &str) -> Option<f64> {
    match name {
        "pi" => Some(PI),
        "tau" => Some(TAU),
        _ => None,
    }
}

/// A function of expressions.
pub(super) struct Function {
    pub name: &'static str,
    /// How it is written, for messages.
    pub usage: &'static str,
    /// Least and most arguments.
    pub arguments: (usize, usize),
    /// Its value for as many arguments; `None` where it has one for numbers only.
    pub apply: fn(&mut TapeBuilder, &[Node]) -> Option<Node>,
}

impl Function {
    const fn of(
        n: usize,
        name: &'static str,
        usage: &'static str,
        apply: fn(&mut TapeBuilder, &[Node]) -> Option<Node>,
    ) -> Function {
        Function { name, usage, arguments: (n, n), apply }
    }
}

/// One of the functions of one number that tapes have.
macro_rules! unary {
    ($name:literal, $function:expr) => {
        Function::of(1, $name, concat!($name, "(x)"), |tape, v| Some(tape.unary($function, v[0])))
    };
}

pub(super) const FUNCTIONS: [Function; 24] = [
    unary!("sin", Unary::Sin),
    unary!("cos", Unary::Cos),
    unary!("tan", Unary::Tan),
    unary!("asin", Unary::Asin),
    unary!("acos", Unary::Acos),
    unary!("atan", Unary::Atan),
    Function::of(2, "atan2", "atan2(y, x)", |tape, v| Some(tape.binary(Binary::Atan2, v[0], v[1]))),
    unary!("sqrt", Unary::Sqrt),
    unary!("exp", Unary::Exp),
    unary!("ln", Unary::Ln),
    unary!("abs", Unary::Abs),
    unary!("sign", Unary::Sign),
    unary!("floor", Unary::Floor),
    unary!("ceil", Unary::Ceil),
    unary!("round", Unary::Round),
    Function::of(1, "fract", "fract(x)", |tape, v| {
        let floor = tape.unary(Unary::Floor, v[0]);
        Some(tape.sub(v[0], floor))
    }),
    Function {
        name: "min",
        usage: "min(a, b, ...)",
        arguments: (1, 16),
        apply: |tape, v| v.iter().copied().reduce(|a, b| tape.binary(Binary::Min, a, b)),
    },
    Function {
        name: "max",
        usage: "max(a, b, ...)",
        arguments: (1, 16),
        apply: |tape, v| v.iter().copied().reduce(|a, b| tape.binary(Binary::Max, a, b)),
    },
    Function::of(3, "clamp", "clamp(x, low, high)", |tape, v| Some(clamp(tape, v[0], v[1], v[2]))),
    Function::of(3, "mix", "mix(a, b, t)", |tape, v| {
        let rest = tape.sub(Node::Constant(1.0), v[2]);
        let (a, b) = (tape.mul(v[0], rest), tape.mul(v[1], v[2]));
        Some(tape.add(a, b))
    }),
    Function::of(2, "step", "step(edge, x)", |tape, v| Some(step(tape, v[0], v[1]))),
    Function::of(3, "smoothstep", "smoothstep(low, high, x)", |tape, v| {
        let (from, width) = (tape.sub(v[2], v[0]), tape.sub(v[1], v[0]));
        let t = tape.binary(Binary::Div, from, width);
        let t = clamp(tape, t, Node::Constant(0.0), Node::Constant(1.0));
        let (square, twice) = (tape.mul(t, t), tape.mul(Node::Constant(2.0), t));
        let rest = tape.sub(Node::Constant(3.0), twice);
        Some(tape.mul(square, rest))
    }),
    Function::of(2, "hypot", "hypot(x, y)", |tape, v| {
        let (x, y) = (tape.mul(v[0], v[0]), tape.mul(v[1], v[1]));
        let sum = tape.add(x, y);
        Some(tape.unary(Unary::Sqrt, sum))
    }),
    Function::of(3, "random", "random(seed, low, high)", |_, v| match *v {
        [Node::Constant(seed), Node::Constant(low), Node::Constant(high)] => {
            Some(Node::Constant(low + (high - low) * random(seed)))
        }
        _ => None,
    }),
];

fn clamp(tape: &mut TapeBuilder, x: Node, low: Node, high: Node) -> Node {
    let x = tape.binary(Binary::Max, x, low);
    tape.binary(Binary::Min, x, high)
}

/// 0 where `x` is less than `edge`, 1 elsewhere: `ceil((1 + sign(x - edge)) / 2)`.
fn step(tape: &mut TapeBuilder, edge: Node, x: Node) -> Node {
    let above = tape.sub(x, edge);
    let sign = tape.unary(Unary::Sign, above);
    let shifted = tape.add(Node::Constant(1.0), sign);
    let half = tape.mul(Node::Constant(0.5), shifted);
    tape.unary(Unary::Ceil, half)
}

/// A number in [0, 1) that looks like no other seed's: the output function of SplitMix64 [Steele et al. 2014].
pub(super) fn random(seed: f64) -> f64 {
    // Zero has two signs.
    let mut z = (seed + 0.0).to_bits().wrapping_add(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 * f64::from_bits(0x3CA0_0000_0000_0000)
}
