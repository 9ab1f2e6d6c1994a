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

/// An operation of a function that is being built: it takes the results of earlier ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Operation {
    /// The bits of a number.
    Constant(u64),
    Variable(u32),
    Unary(Unary, u32),
    Binary(Binary, u32, u32),
}

/// What is done with numbers in slots; each writes a slot that no other writes.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Instruction {
    Unary {
        function: Unary,
        a: u32,
        to: u32,
    },
    Binary {
        function: Binary,
        a: u32,
        b: u32,
        to: u32,
    },
    /// Sine and cosine of the same, which are worked out together.
    SinCos {
        a: u32,
        sine: u32,
        cosine: u32,
    },
}

/// A function as a list of operations; see the head of this module.
///
/// Its numbers have slots: first its variables, then its constants, then what the operations give.
#[derive(Clone, Debug, PartialEq)]
pub struct Tape {
    /// Their numbers.
    variables: Vec<u32>,
    /// Their bits.
    constants: Vec<u64>,
    instructions: Vec<Instruction>,
    slots: u32,
    /// The slot of the value.
    result: u32,
}

impl Tape {
    /// The value of the function.
    ///
    /// * `variables`: their values; one that is not there is zero
    /// * `slots`: memory that may be used again
    pub fn at<S: Scalar>(&self, variables: &[S], slots: &mut Vec<S>) -> S {
        let zero = S::constant(0.0);
        if slots.len() < self.slots as usize {
            slots.resize(self.slots as usize, zero);
        }
        let slots = &mut slots[..self.slots as usize];
        let (of_variables, others) = slots.split_at_mut(self.variables.len());
        for (slot, &i) in of_variables.iter_mut().zip(&self.variables) {
            *slot = variables.get(i as usize).copied().unwrap_or(zero);
        }
        for (slot, &bits) in others.iter_mut().zip(&self.constants) {
            *slot = S::constant(f64::from_bits(bits));
        }
        for instruction in &self.instructions {
            match *instruction {
                Instruction::Unary { function, a, to } => {
                    slots[to as usize] = slots[a as usize].unary(function)
                }
                Instruction::Binary { function, a, b, to } => {
                    slots[to as usize] = slots[a as usize].binary(function, slots[b as usize]);
                }
                Instruction::SinCos { a, sine, cosine } => {
                    (slots[sine as usize], slots[cosine as usize]) = slots[a as usize].sin_cos();
                }
            }
        }
        slots[self.result as usize]
    }

    /// How many numbers it works with: variables, constants, and results of operations.
    pub fn len(&self) -> usize {
        self.slots as usize
    }

    /// Whether it works with none.
    pub fn is_empty(&self) -> bool {
        self.slots == 0
    }

    /// Whether its value depends on a variable.
    pub fn has_variable(&self, i: u32) -> bool {
        self.variables.contains(&i)
    }

    /// Bytes kept beyond the record itself.
    pub fn heap_bytes(&self) -> usize {
        size_of_val(&*self.variables) + size_of_val(&*self.constants) + size_of_val(&*self.instructions)
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

    /// The function whose value `result` is.
    pub fn finish(mut self, result: Node) -> Tape {
        let result = self.slot(result) as usize;
        // Whatever came later belongs to nothing.
        self.operations.truncate(result + 1);
        let slots = self.slots();
        let (mut variables, mut constants, mut instructions) = (Vec::new(), Vec::new(), Vec::new());
        // Of equal operations there is one, so the second of an angle is the other function.
        let mut angles = HashMap::new();
        for (i, operation) in self.operations.iter().enumerate() {
            let slot = |operation: u32| slots[operation as usize];
            match *operation {
                Operation::Variable(variable) => variables.push(variable),
                Operation::Constant(bits) => constants.push(bits),
                Operation::Unary(function @ (Unary::Sin | Unary::Cos), a) => {
                    if let Some((first, other)) = angles.insert(a, (instructions.len(), slots[i])) {
                        let [sine, cosine] =
                            if function == Unary::Cos { [other, slots[i]] } else { [slots[i], other] };
                        instructions[first] = Instruction::SinCos { a: slot(a), sine, cosine };
                    } else {
                        instructions.push(Instruction::Unary { function, a: slot(a), to: slots[i] });
                    }
                }
                Operation::Unary(function, a) => {
                    instructions.push(Instruction::Unary { function, a: slot(a), to: slots[i] });
                }
                Operation::Binary(function, a, b) => {
                    instructions.push(Instruction::Binary { function, a: slot(a), b: slot(b), to: slots[i] });
                }
            }
        }
        Tape { variables, constants, instructions, slots: slots.len() as u32, result: slots[result] }
    }

    /// The slots of what the operations give: variables first, then constants, then the rest.
    fn slots(&self) -> Vec<u32> {
        let kind = |operation: &Operation| match operation {
            Operation::Variable(_) => 0,
            Operation::Constant(_) => 1,
            Operation::Unary(..) | Operation::Binary(..) => 2,
        };
        let mut order: Vec<usize> = (0..self.operations.len()).collect();
        order.sort_by_key(|&i| kind(&self.operations[i]));
        let mut slots = vec![0; order.len()];
        for (slot, &i) in order.iter().enumerate() {
            slots[i] = slot as u32;
        }
        slots
    }
}

#[cfg(test)]
mod tests;
