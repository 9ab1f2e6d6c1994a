//! Textures made of several others: mixtures, products, sums, and functions of them.

use std::cell::RefCell;
use std::sync::Arc;

use kajo_color::{Spectrum, Wavelengths};
use kajo_math::tape::{Dual, Tape};

use super::{
    AnyTexture, ColorNode, ColorTexture, FilteredNumber, FloatNode, FloatTexture, TextureContext,
    TextureDetail, TextureEvaluator, TextureSlope, Textures,
};

/// What is made of numbers.
#[derive(Clone, Debug)]
pub enum FloatOperation {
    /// The first and the second, in the proportion that the third says: `(1 - t) a + t b`.
    Mix,
    /// All of them multiplied.
    Multiply,
    /// All of them added, held to [0, 1].
    Add,
    /// A function of up to three of them, held to [0, 1].
    Formula(Arc<Tape>),
}

/// A number that is made of others.
#[derive(Clone, Debug)]
pub struct FloatCombination {
    /// How.
    pub operation: FloatOperation,
    /// The others.
    pub parts: Arc<[FloatTexture]>,
}

thread_local! {
    /// Memory for the operations of functions and of their derivatives.
    static SCRATCH: RefCell<(Vec<f64>, Vec<Dual<f64, 3>>)> = RefCell::default();
}

/// The value of a formula, with its derivatives by the numbers that it is of.
fn formula_of(tape: &Tape, values: [f32; 3]) -> Dual<f64, 3> {
    let variables = [0, 1, 2].map(|k| Dual {
        value: values[k].into(),
        slopes: std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 }),
    });
    SCRATCH.with_borrow_mut(|(_, slots)| tape.at(&variables, slots))
}

/// A number held to [0, 1]; 0 for what is none.
fn held(v: f64) -> f32 {
    if v > 0.0 { v.min(1.0) as f32 } else { 0.0 }
}

impl FloatCombination {
    /// The value of a formula, with its derivatives by the parts.
    fn formula(&self, tape: &Tape, evaluator: TextureEvaluator<'_>) -> Dual<f64, 3> {
        let value = |k: usize| self.parts.get(k).map_or(0.0, |part| part.at(evaluator));
        formula_of(tape, [0, 1, 2].map(value))
    }

    fn filtered_formula(&self, tape: &Tape, evaluator: TextureEvaluator<'_>) -> FilteredNumber {
        let part =
            |k: usize| self.parts.get(k).map_or(FilteredNumber::default(), |part| part.filtered(evaluator));
        let parts = [0, 1, 2].map(part);
        let means = parts.map(|part| f64::from(part.mean));
        let mean = held(SCRATCH.with_borrow_mut(|(slots, _)| tape.at(&means, slots)));
        if !parts.iter().any(FilteredNumber::varies) || mean <= 0.0 || mean >= 1.0 {
            return FilteredNumber::point(mean);
        }
        let Dual { slopes, .. } = formula_of(tape, parts.map(|part| part.mean));
        if slopes.iter().any(|slope| !slope.is_finite()) {
            return FilteredNumber::point(mean);
        }
        let changes = parts.iter().zip(slopes).map(|(part, slope)| part.mapped(0.0, slope as f32));
        FilteredNumber { mean, ..changes.fold(FilteredNumber::default(), |sum, part| sum.plus(part)) }
    }
}

impl FloatNode for FloatCombination {
    fn is_finite(&self) -> bool {
        true
    }

    fn parts(&self) -> Vec<AnyTexture<'_>> {
        self.parts.iter().copied().map(AnyTexture::from).collect()
    }

    fn needs_uv(&self, textures: &Textures) -> bool {
        self.parts.iter().any(|part| part.needs_uv(textures))
    }

    fn detail(&self, textures: &Textures, found: &mut TextureDetail) {
        self.parts.iter().for_each(|part| part.detail(textures, found));
        found.jumps |= matches!(self.operation, FloatOperation::Formula(_));
    }

    fn value(&self, textures: &Textures, at: &TextureContext) -> f32 {
        let evaluator = textures.evaluator(at);
        let values = self.parts.iter().map(|part| part.at(evaluator));
        match &self.operation {
            FloatOperation::Mix => {
                let [a, b, t] = *self.parts else { return 0.0 };
                mixed(t.at(evaluator), || a.at(evaluator), || b.at(evaluator))
            }
            FloatOperation::Multiply => values.product(),
            FloatOperation::Add => values.sum::<f32>().clamp(0.0, 1.0),
            FloatOperation::Formula(tape) => {
                let value = |k: usize| self.parts.get(k).map_or(0.0, |part| f64::from(part.at(evaluator)));
                let values = [0, 1, 2].map(value);
                held(SCRATCH.with_borrow_mut(|(slots, _)| tape.at(&values, slots)))
            }
        }
    }

    fn is_filtered(&self, textures: &Textures) -> bool {
        self.parts.iter().any(|part| part.is_filtered(textures))
    }

    /// By the rules of sums, products and chains, as [`FloatNode::slope`]; what was lost of its parts is taken for independent.
    fn filtered(&self, textures: &Textures, at: &TextureContext) -> FilteredNumber {
        let evaluator = textures.evaluator(at);
        let mut parts = self.parts.iter().map(|part| part.filtered(evaluator));
        match &self.operation {
            FloatOperation::Mix => {
                let [a, b, t] = *self.parts else { return FilteredNumber::default() };
                let [a, b, t] = [a, b, t].map(|part| part.filtered(evaluator));
                let mean = mixed(t.mean, || a.mean, || b.mean);
                let sum = a.mapped(0.0, 1.0 - t.mean).plus(b.mapped(0.0, t.mean));
                FilteredNumber { mean, ..sum.plus(t.mapped(0.0, b.mean - a.mean)) }
            }
            FloatOperation::Multiply => {
                let first = parts.next().unwrap_or(FilteredNumber::point(1.0));
                parts.fold(first, |product, part| product.times(part))
            }
            FloatOperation::Add => {
                let sum = parts.fold(FilteredNumber::default(), |sum, part| sum.plus(part));
                let is_free = sum.mean > 0.0 && sum.mean < 1.0;
                sum.mapped(sum.mean.clamp(0.0, 1.0), if is_free { 1.0 } else { 0.0 })
            }
            FloatOperation::Formula(tape) => self.filtered_formula(tape, evaluator),
        }
    }

    /// By the rules of sums, products and chains; level where a sum is held to its bounds.
    fn slope(&self, textures: &Textures, at: &TextureContext, factor: f32) -> TextureSlope {
        let evaluator = textures.evaluator(at);
        let weighed = |weights: &mut dyn Iterator<Item = f32>| {
            let slopes = self.parts.iter().zip(weights).map(|(part, w)| part.slope(evaluator, factor * w));
            slopes.fold(TextureSlope::default(), TextureSlope::plus)
        };
        match &self.operation {
            FloatOperation::Mix => {
                let [a, b, t] = *self.parts else { return TextureSlope::default() };
                let share = t.at(evaluator);
                weighed(&mut [1.0 - share, share, b.at(evaluator) - a.at(evaluator)].into_iter())
            }
            FloatOperation::Multiply => {
                let others = |i: usize| {
                    let rest = self.parts.iter().enumerate().filter(|(j, _)| *j != i);
                    rest.map(|(_, part)| part.at(evaluator)).product::<f32>()
                };
                weighed(&mut (0..self.parts.len()).map(others))
            }
            FloatOperation::Add => {
                let sum: f32 = self.parts.iter().map(|part| part.at(evaluator)).sum();
                let is_free = sum > 0.0 && sum < 1.0;
                weighed(&mut std::iter::repeat(if is_free { 1.0 } else { 0.0 }))
            }
            FloatOperation::Formula(tape) => {
                let Dual { value, slopes } = self.formula(tape, evaluator);
                let is_free = value > 0.0 && value < 1.0 && slopes.iter().all(|slope| slope.is_finite());
                weighed(&mut slopes.into_iter().map(|slope| if is_free { slope as f32 } else { 0.0 }))
            }
        }
    }

    /// Of the operation on the means of its parts.
    fn mean(&self, textures: &Textures) -> f32 {
        let means: Vec<f32> = self.parts.iter().map(|part| part.mean(textures)).collect();
        match &self.operation {
            FloatOperation::Mix => match *means {
                [a, b, t] => mixed(t, || a, || b),
                _ => 0.0,
            },
            FloatOperation::Multiply => means.iter().product(),
            FloatOperation::Add => means.iter().sum::<f32>().clamp(0.0, 1.0),
            FloatOperation::Formula(tape) => {
                let means: Vec<f64> = means.into_iter().map(f64::from).collect();
                held(tape.at(&means, &mut Vec::new()))
            }
        }
    }
}

/// `(1 - t) a + t b`, of which what has no share is not worked out.
fn mixed(t: f32, a: impl FnOnce() -> f32, b: impl FnOnce() -> f32) -> f32 {
    if t <= 0.0 {
        a()
    } else if t >= 1.0 {
        b()
    } else {
        (1.0 - t) * a() + t * b()
    }
}

/// What is made of colours.
#[derive(Clone, Copy, Debug)]
pub enum ColorOperation {
    /// The first and the second, in a proportion: `(1 - t) a + t b`.
    Mix(FloatTexture),
    /// All of them multiplied.
    Multiply,
    /// All of them added, held to [0, 1].
    Add,
}

/// A colour that is made of others.
#[derive(Clone, Debug)]
pub struct ColorCombination {
    /// How.
    pub operation: ColorOperation,
    /// The others.
    pub parts: Arc<[ColorTexture]>,
}

impl ColorNode for ColorCombination {
    fn is_finite(&self) -> bool {
        !matches!(self.operation, ColorOperation::Mix(FloatTexture::Constant(t)) if !t.is_finite())
    }

    fn parts(&self) -> Vec<AnyTexture<'_>> {
        let amount = match self.operation {
            ColorOperation::Mix(t) => Some(AnyTexture::from(t)),
            ColorOperation::Multiply | ColorOperation::Add => None,
        };
        self.parts.iter().map(AnyTexture::from).chain(amount).collect()
    }

    fn color_needs_uv(&self, textures: &Textures) -> bool {
        let amount = matches!(self.operation, ColorOperation::Mix(t) if t.needs_uv(textures));
        amount || self.parts.iter().any(|part| part.needs_uv(textures))
    }

    fn color_is_filtered(&self, textures: &Textures) -> bool {
        let amount = matches!(self.operation, ColorOperation::Mix(t) if t.is_filtered(textures));
        amount || self.parts.iter().any(|part| part.is_filtered(textures))
    }

    fn color_detail(&self, textures: &Textures, found: &mut TextureDetail) {
        self.parts().into_iter().for_each(|part| part.detail(textures, found));
    }

    fn reflectance(&self, textures: &Textures, at: &TextureContext, wavelengths: &Wavelengths) -> Spectrum {
        let evaluator = textures.evaluator(at);
        let mut colors = self.parts.iter().map(|part| part.at(evaluator, wavelengths));
        match self.operation {
            ColorOperation::Mix(t) => {
                let t = t.at(evaluator).clamp(0.0, 1.0);
                match &*self.parts {
                    [a, _] if t == 0.0 => a.at(evaluator, wavelengths),
                    [_, b] if t == 1.0 => b.at(evaluator, wavelengths),
                    [a, b] => a.at(evaluator, wavelengths) * (1.0 - t) + b.at(evaluator, wavelengths) * t,
                    _ => Spectrum::BLACK,
                }
            }
            ColorOperation::Multiply => {
                let first = colors.next().unwrap_or(Spectrum::BLACK);
                colors.fold(first, |product, color| product * color)
            }
            ColorOperation::Add => colors.fold(Spectrum::BLACK, |sum, color| sum + color).clamp(0.0, 1.0),
        }
    }

    /// Of the operation on the means of its parts.
    fn color_mean(&self, textures: &Textures) -> [f32; 3] {
        let means: Vec<[f32; 3]> = self.parts.iter().map(|part| part.mean(textures)).collect();
        let each = |of: &dyn Fn(usize) -> f32| [0, 1, 2].map(of);
        match self.operation {
            ColorOperation::Mix(t) => match *means {
                [a, b] => {
                    let t = t.mean(textures);
                    each(&|i| (1.0 - t) * a[i] + t * b[i])
                }
                _ => [0.0; 3],
            },
            ColorOperation::Multiply => each(&|i| means.iter().map(|mean| mean[i]).product()),
            ColorOperation::Add => each(&|i| means.iter().map(|mean| mean[i]).sum::<f32>().clamp(0.0, 1.0)),
        }
    }
}
