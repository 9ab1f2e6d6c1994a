//! A function of the place that is typed in the scene: `f(x, y, z)` at a world-space point, held to what the parameter may be.

use std::cell::RefCell;
use std::sync::Arc;

use kajo_math::rng::Stream;
use kajo_math::tape::{Dual, Tape};
use kajo_math::{Vec2, Vec3};

use super::{FloatNode, TextureContext, TextureSlope, Textures};

/// A function of x, y and z.
#[derive(Clone, Debug)]
pub struct Expression {
    /// The function.
    pub function: Arc<Tape>,
    /// The least and the largest that it may be; what is no number is the least.
    pub bounds: [f32; 2],
}

thread_local! {
    /// Memory for the operations of functions and of their derivatives.
    static SCRATCH: RefCell<(Vec<f64>, Vec<Dual<f64, 3>>)> = RefCell::default();
}

impl Expression {
    /// The number at a world-space point.
    pub fn at(&self, p: Vec3) -> f32 {
        let variables = p.to_array().map(f64::from);
        let value = SCRATCH.with_borrow_mut(|(slots, _)| self.function.at(&variables, slots));
        self.held(value)
    }

    fn held(&self, value: f64) -> f32 {
        let [least, largest] = self.bounds;
        if value.is_nan() { least } else { (value as f32).clamp(least, largest) }
    }
}

impl FloatNode for Expression {
    fn is_finite(&self) -> bool {
        self.bounds.iter().all(|v| v.is_finite())
    }

    fn value(&self, _textures: &Textures, at: &TextureContext) -> f32 {
        self.at(at.p)
    }

    /// Its own derivatives; none where it is held to its bounds.
    fn slope(&self, _textures: &Textures, at: &TextureContext, factor: f32) -> TextureSlope {
        let variables = [0, 1, 2].map(|i| {
            let slopes = std::array::from_fn(|k| if k == i { 1.0 } else { 0.0 });
            Dual { value: f64::from(at.p[i]), slopes }
        });
        let Dual { value, slopes } =
            SCRATCH.with_borrow_mut(|(_, slots)| self.function.at(&variables, slots));
        let [least, largest] = self.bounds.map(f64::from);
        let is_free = value > least && value < largest && slopes.iter().all(|slope| slope.is_finite());
        let p = if is_free { factor * Vec3::from(slopes.map(|slope| slope as f32)) } else { Vec3::ZERO };
        TextureSlope { uv: Vec2::ZERO, p }
    }

    /// Over a cube around the origin, about.
    fn mean(&self, _textures: &Textures) -> f32 {
        const POINTS: u32 = 256;
        let point = |i: u32| {
            let s = Stream::new(0, [i, 0], 0);
            8.0 * Vec3::new(s.uniform(0), s.uniform(1), s.uniform(2)) - 4.0
        };
        (0..POINTS).map(|i| self.at(point(i))).sum::<f32>() / POINTS as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_math::tape::{Node, TapeBuilder, Unary};

    /// `x y + sin(z)`.
    fn wave(bounds: [f32; 2]) -> Expression {
        let mut tape = TapeBuilder::new();
        let [x, y, z] = [0, 1, 2].map(|i| tape.variable(i));
        let product = tape.mul(x, y);
        let sine = tape.unary(Unary::Sin, z);
        let sum = tape.add(product, sine);
        Expression { function: Arc::new(tape.finish(sum)), bounds }
    }

    #[test]
    fn functions_have_their_values_and_slopes() {
        let (free, textures) = (wave([-100.0, 100.0]), Textures::default());
        for i in 0..100 {
            let s = Stream::new(2, [i, 0], 0);
            let p = 6.0 * Vec3::new(s.uniform(0), s.uniform(1), s.uniform(2)) - 3.0;
            let at = TextureContext { p, ..TextureContext::default() };
            assert!((free.value(&textures, &at) - (p.x * p.y + p.z.sin())).abs() < 1e-5);
            let slope = free.slope(&textures, &at, 2.0);
            let expected = 2.0 * Vec3::new(p.y, p.x, p.z.cos());
            assert!(slope.uv == Vec2::ZERO && (slope.p - expected).length() < 1e-5, "{p}");
            let differences = TextureSlope::in_space(&at, 2.0, |at| free.value(&textures, at));
            assert!((slope.p - differences.p).length() < 1e-2, "{p}: {} {}", slope.p, differences.p);
            let held = wave([0.0, 1.0]).at(p);
            assert_eq!(held, free.at(p).clamp(0.0, 1.0));
        }
    }

    #[test]
    fn what_is_no_number_is_the_least() {
        let mut tape = TapeBuilder::new();
        let x = tape.variable(0);
        let root = tape.unary(Unary::Sqrt, x);
        let root = Expression { function: Arc::new(tape.finish(root)), bounds: [0.25, 2.0] };
        assert_eq!((root.at(-Vec3::X), root.at(Vec3::X), root.at(100.0 * Vec3::X)), (0.25, 1.0, 2.0));
        let at = TextureContext { p: -Vec3::X, ..TextureContext::default() };
        assert_eq!(root.slope(&Textures::default(), &at, 1.0), TextureSlope::default());
        let even = TapeBuilder::new().finish(Node::Constant(0.5));
        let even = Expression { function: Arc::new(even), bounds: [0.0, 1.0] };
        assert_eq!(even.mean(&Textures::default()), 0.5);
    }
}
