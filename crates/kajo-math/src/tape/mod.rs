//! Functions of a few variables as lists of operations.
//!
//! A function typed in a scene is read once, into a tape: each operation takes the results of earlier ones. The same tape
//! is evaluated over numbers, over intervals, over either together with derivatives ([`Scalar`], [`Dual`]: forward-mode
//! differentiation [Griewank and Walther 2008, chapter 3]), and over bounds of first and second derivatives ([`Curvature`]).
//!
//! ```
//! use kajo_math::tape::{Dual, Tape, TapeBuilder, Unary};
//! // sin(x) * y
//! let mut builder = TapeBuilder::new();
//! let (x, y) = (builder.variable(0), builder.variable(1));
//! let sine = builder.unary(Unary::Sin, x);
//! let product = builder.mul(sine, y);
//! let tape = builder.finish(product);
//! let mut slots = Vec::new();
//! assert_eq!(tape.at(&[0.0, 3.0], &mut slots), 0.0);
//! let [x, y] = [Dual { value: 0.0, slopes: [1.0, 0.0] }, Dual { value: 3.0, slopes: [0.0, 1.0] }];
//! assert_eq!(tape.at(&[x, y], &mut Vec::new()).slopes, [3.0, 0.0]);
//! ```

mod curvature;
mod dual;
mod scalar;

use std::collections::HashMap;

pub use curvature::Curvature;
pub use dual::Dual;
pub use scalar::Scalar;

/// A function of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Unary {
    /// The same with the other sign.
    Neg,
    /// Distance from zero.
    Abs,
    /// -1 below zero, 0 at zero, 1 above.
    Sign,
    /// The next whole number below.
    Floor,
    /// The next whole number above.
    Ceil,
    /// The nearest whole number, halves away from zero.
    Round,
    /// Square root.
    Sqrt,
    /// Exponential function.
    Exp,
    /// Natural logarithm.
    Ln,
    /// Sine, of radians.
    Sin,
    /// Cosine, of radians.
    Cos,
    /// Tangent, of radians.
    Tan,
    /// Arc sine, in radians.
    Asin,
    /// Arc cosine, in radians.
    Acos,
    /// Arc tangent, in radians.
    Atan,
    /// A whole power.
    Powi(i32),
}

/// A function of two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Binary {
    /// Sum.
    Add,
    /// Difference.
    Sub,
    /// Product.
    Mul,
    /// Quotient.
    Div,
    /// What the division leaves, with the sign of the divisor.
    Modulo,
    /// The first to the power of the second.
    Pow,
    /// The smaller one.
    Min,
    /// The larger one.
    Max,
    /// Angle of the point (second, first) from the first axis, in radians.
    Atan2,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Operation {
    /// The bits of a number.
    Constant(u64),
    Variable(u32),
    Unary(Unary, u32),
    Binary(Binary, u32, u32),
    /// Sine and cosine of the first, which are worked out together: their own results.
    SinCos(u32, [u32; 2]),
    /// The result is there already.
    Done,
}

/// A function as a list of operations; see the head of this module.
#[derive(Clone, Debug, PartialEq)]
pub struct Tape {
    /// Each takes the results of earlier ones; the last is the value.
    operations: Vec<Operation>,
}

impl Tape {
    /// The value of the function.
    ///
    /// * `variables`: their values; one that is not there is zero
    /// * `slots`: memory that may be used again
    pub fn at<S: Scalar>(&self, variables: &[S], slots: &mut Vec<S>) -> S {
        let zero = S::constant(0.0);
        if slots.len() < self.operations.len() {
            slots.resize(self.operations.len(), zero);
        }
        let slots = &mut slots[..self.operations.len()];
        let mut value = zero;
        for (i, operation) in self.operations.iter().enumerate() {
            value = match *operation {
                Operation::Constant(bits) => S::constant(f64::from_bits(bits)),
                Operation::Variable(i) => variables.get(i as usize).copied().unwrap_or(zero),
                Operation::Unary(function, a) => slots[a as usize].unary(function),
                Operation::Binary(function, a, b) => slots[a as usize].binary(function, slots[b as usize]),
                Operation::SinCos(a, [sine, cosine]) => {
                    let (sin, cos) = slots[a as usize].sin_cos();
                    slots[sine as usize] = sin;
                    slots[cosine as usize] = cos;
                    continue;
                }
                Operation::Done => {
                    value = slots[i];
                    continue;
                }
            };
            slots[i] = value;
        }
        value
    }

    /// How many operations it takes.
    pub fn len(&self) -> usize {
        self.operations.len()
    }

    /// Whether it is zero without any operation.
    pub fn is_empty(&self) -> bool {
        self.operations.is_empty()
    }

    /// Whether its value depends on a variable.
    pub fn has_variable(&self, i: u32) -> bool {
        self.operations.contains(&Operation::Variable(i))
    }

    /// Bytes kept beyond the record itself.
    pub fn heap_bytes(&self) -> usize {
        size_of_val(&*self.operations)
    }
}

/// A part of a function that is being built: a number, or what an operation gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Node {
    /// The same for all variables.
    Constant(f64),
    /// The result of the operation with this number.
    Slot(u32),
}

/// Builds a [`Tape`]. Operations on constants are done at once; equal operations are one.
#[derive(Debug, Default)]
pub struct TapeBuilder {
    operations: Vec<Operation>,
    known: HashMap<Operation, u32>,
}

impl TapeBuilder {
    /// Nothing yet.
    pub fn new() -> TapeBuilder {
        TapeBuilder::default()
    }

    fn push(&mut self, operation: Operation) -> u32 {
        *self.known.entry(operation).or_insert_with(|| {
            self.operations.push(operation);
            self.operations.len() as u32 - 1
        })
    }

    fn slot(&mut self, node: Node) -> u32 {
        match node {
            Node::Constant(x) => self.push(Operation::Constant(x.to_bits())),
            Node::Slot(slot) => slot,
        }
    }

    /// How many operations there are so far.
    pub fn len(&self) -> usize {
        self.operations.len()
    }

    /// Whether there is no operation yet.
    pub fn is_empty(&self) -> bool {
        self.operations.is_empty()
    }

    /// The variable with this number.
    pub fn variable(&mut self, i: u32) -> Node {
        Node::Slot(self.push(Operation::Variable(i)))
    }

    /// A function of one number.
    pub fn unary(&mut self, function: Unary, a: Node) -> Node {
        match a {
            Node::Constant(x) => Node::Constant(x.unary(function)),
            Node::Slot(a) => Node::Slot(self.push(Operation::Unary(function, a))),
        }
    }

    /// A function of two numbers. A power with a whole constant exponent becomes [`Unary::Powi`].
    pub fn binary(&mut self, function: Binary, a: Node, b: Node) -> Node {
        /// Larger whole powers are powers like others.
        const LARGEST_POWER: f64 = 64.0;
        match (function, a, b) {
            (_, Node::Constant(x), Node::Constant(y)) => Node::Constant(x.binary(function, y)),
            (Binary::Add, Node::Constant(0.0), kept) | (Binary::Mul, Node::Constant(1.0), kept) => kept,
            (Binary::Add | Binary::Sub, _, Node::Constant(0.0)) | (Binary::Mul, _, Node::Constant(1.0)) => a,
            (Binary::Pow, _, Node::Constant(n)) if n.fract() == 0.0 && n.abs() <= LARGEST_POWER => {
                self.unary(Unary::Powi(n as i32), a)
            }
            _ => {
                let (a, b) = (self.slot(a), self.slot(b));
                Node::Slot(self.push(Operation::Binary(function, a, b)))
            }
        }
    }

    /// The sum of two numbers.
    pub fn add(&mut self, a: Node, b: Node) -> Node {
        self.binary(Binary::Add, a, b)
    }

    /// The difference of two numbers.
    pub fn sub(&mut self, a: Node, b: Node) -> Node {
        self.binary(Binary::Sub, a, b)
    }

    /// The product of two numbers.
    pub fn mul(&mut self, a: Node, b: Node) -> Node {
        self.binary(Binary::Mul, a, b)
    }

    /// Sines and cosines of the same become one operation.
    fn join_angles(&mut self) {
        // Of equal operations there is one, so the second of an angle is the other function.
        let mut firsts = HashMap::new();
        for i in 0..self.operations.len() {
            let Operation::Unary(function @ (Unary::Sin | Unary::Cos), a) = self.operations[i] else {
                continue;
            };
            let Some(first) = firsts.insert(a, i) else { continue };
            let [sine, cosine] = if function == Unary::Cos { [first, i] } else { [i, first] };
            self.operations[first] = Operation::SinCos(a, [sine as u32, cosine as u32]);
            self.operations[i] = Operation::Done;
        }
    }

    /// The function whose value `result` is.
    pub fn finish(mut self, result: Node) -> Tape {
        let slot = self.slot(result) as usize;
        // Whatever came later belongs to nothing.
        self.operations.truncate(slot + 1);
        self.join_angles();
        Tape { operations: self.operations }
    }
}

#[cfg(test)]
mod tests;
