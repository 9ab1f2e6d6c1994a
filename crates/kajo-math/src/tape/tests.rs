use proptest::prelude::*;

use super::*;
use crate::interval::{Domain, Interval};

const UNARY: [Unary; 22] = [
    Unary::Neg,
    Unary::Abs,
    Unary::Sign,
    Unary::Floor,
    Unary::Ceil,
    Unary::Round,
    Unary::Sqrt,
    Unary::Exp,
    Unary::Ln,
    Unary::Sin,
    Unary::Cos,
    Unary::Tan,
    Unary::Asin,
    Unary::Acos,
    Unary::Atan,
    Unary::Powi(0),
    Unary::Powi(1),
    Unary::Powi(2),
    Unary::Powi(3),
    Unary::Powi(7),
    Unary::Powi(-1),
    Unary::Powi(-2),
];

const BINARY: [Binary; 9] = [
    Binary::Add,
    Binary::Sub,
    Binary::Mul,
    Binary::Div,
    Binary::Modulo,
    Binary::Pow,
    Binary::Min,
    Binary::Max,
    Binary::Atan2,
];

/// A function of two variables: each number says an operation and what it takes.
fn tape_of(choices: &[(usize, usize, usize)]) -> Tape {
    let mut builder = TapeBuilder::new();
    let mut nodes =
        vec![builder.variable(0), builder.variable(1), Node::Constant(0.75), Node::Constant(-2.0)];
    for &(operation, a, b) in choices {
        let (a, b) = (nodes[a % nodes.len()], nodes[b % nodes.len()]);
        let operation = operation % (UNARY.len() + BINARY.len());
        nodes.push(match UNARY.get(operation) {
            Some(&function) => builder.unary(function, a),
            None => builder.binary(BINARY[operation - UNARY.len()], a, b),
        });
    }
    let last = *nodes.last().unwrap();
    builder.finish(last)
}

/// All places of a grid on an interval, its ends among them.
fn positions(range: Interval) -> impl Iterator<Item = f64> {
    (0..=8).map(move |i| (range.lo + (range.hi - range.lo) * f64::from(i) / 8.0).min(range.hi))
}

#[test]
fn functions_of_one_number_stay_in_their_bounds() {
    let ends = [-1e3, -7.0, -2.5, -1.0, -0.3, 0.0, 1e-9, 0.5, 1.0, 1.6, 3.2, 6.3, 40.0, 1e12];
    for function in UNARY {
        for (i, &lo) in ends.iter().enumerate() {
            for &hi in &ends[i..] {
                let range = Interval::new(lo, hi);
                let bounds = range.unary(function);
                for x in positions(range) {
                    let value = x.unary(function);
                    match bounds.domain {
                        Domain::Nowhere => {
                            assert!(value.is_nan() || value.is_infinite(), "{function:?} of {x}")
                        }
                        Domain::Somewhere => {}
                        Domain::Everywhere => assert!(!value.is_nan(), "{function:?} of {x}"),
                    }
                    if !value.is_nan() {
                        assert!(
                            bounds.contains(value),
                            "{function:?} of {x} in {range:?}: {value} not in {bounds:?}"
                        );
                    }
                }
            }
        }
    }
}

/// Bounds are no wider than they must be: the ends of smooth functions are reached.
#[test]
fn bounds_are_tight() {
    let close = |a: Interval, lo: f64, hi: f64| {
        let margin = 1e-13 * (1.0 + lo.abs().max(hi.abs()));
        assert!((a.lo - lo).abs() < margin && (a.hi - hi).abs() < margin, "{a:?} for {lo} to {hi}");
    };
    let x = Interval::new(-0.5, 2.0);
    close(x.powi(2), 0.0, 4.0);
    close(x.powi(3), -0.125, 8.0);
    close(x.abs(), 0.0, 2.0);
    close(x.sin(), (-0.5_f64).sin(), 1.0);
    close(x.cos(), 2.0_f64.cos(), 1.0);
    close(Interval::new(3.0, 4.0).sin(), 4.0_f64.sin(), 3.0_f64.sin());
    close(Interval::new(2.0, 7.0).cos(), -1.0, 1.0);
    close(Interval::new(1.0, 4.0).pow(Interval::new(0.5, 2.0)), 1.0, 16.0);
    close(Interval::new(0.2, 0.4).tan(), 0.2_f64.tan(), 0.4_f64.tan());
    close(Interval::new(5.25, 5.5).modulo(Interval::point(2.0)), 1.25, 1.5);
    close(
        Interval::new(1.0, 2.0).atan2(Interval::new(-1.0, 1.0)),
        0.25 * std::f64::consts::PI,
        2.0_f64.atan2(-1.0).max(1.0_f64.atan2(-1.0)),
    );
    assert_eq!(Interval::new(-2.0, -1.0).sqrt().domain, Domain::Nowhere);
    assert_eq!(Interval::new(-2.0, 1.0).sqrt().domain, Domain::Somewhere);
    assert_eq!(Interval::new(0.0, 1.0).sqrt().domain, Domain::Everywhere);
}

#[test]
fn constants_are_folded_and_equal_operations_are_one() {
    let mut builder = TapeBuilder::new();
    let x = builder.variable(0);
    let two = builder.add(Node::Constant(1.0), Node::Constant(1.0));
    assert_eq!(two, Node::Constant(2.0));
    let squares = [0, 1].map(|_| builder.binary(Binary::Pow, x, two));
    let sum = builder.add(squares[0], squares[1]);
    let later = builder.unary(Unary::Sin, sum);
    assert!(matches!(later, Node::Slot(3)));
    let tape = builder.finish(sum);
    assert_eq!(tape.len(), 3);
    assert_eq!(tape.at(&[3.0], &mut Vec::new()), 18.0);
    assert!(tape.has_variable(0) && !tape.has_variable(1));
    assert_eq!(TapeBuilder::new().finish(Node::Constant(4.0)).at::<f64>(&[], &mut Vec::new()), 4.0);
}

/// Sines and cosines of the same are worked out together, and have the bits they have alone.
#[test]
fn angles_are_joined() {
    for cosine_first in [false, true] {
        let mut builder = TapeBuilder::new();
        let x = builder.variable(0);
        let mut functions = [Unary::Sin, Unary::Cos];
        if cosine_first {
            functions.reverse();
        }
        let [a, b] = functions.map(|function| builder.unary(function, x));
        let tripled = builder.mul(a, Node::Constant(3.0));
        let result = builder.binary(Binary::Sub, tripled, b);
        let tape = builder.finish(result);
        let joined = |instruction: &&Instruction| matches!(instruction, Instruction::SinCos { .. });
        assert_eq!(tape.instructions.iter().filter(joined).count(), 1);
        assert_eq!(tape.instructions.len(), 3);
        let mut slots = Vec::new();
        for x in positions(Interval::new(-20.0, 20.0)).chain([0.0, 1e-9, -1e-8, 2e-8, 1e300, f64::INFINITY]) {
            let [first, second] = functions.map(|function| x.unary(function));
            let expected = 3.0 * first - second;
            assert_eq!(tape.at(&[x], &mut slots).to_bits(), expected.to_bits(), "{x}");
        }
        let x = Dual { value: 0.7, slopes: [2.0] };
        let [first, second] = functions.map(|function| x.unary(function));
        let dual = tape.at(&[x], &mut Vec::new());
        let slope = first.slopes[0] * 3.0 + first.value * 0.0 - second.slopes[0];
        assert_eq!((dual.value, dual.slopes), (3.0 * first.value - second.value, [slope]));
        // The last result may be of the pair.
        let mut builder = TapeBuilder::new();
        let x = builder.variable(0);
        let [_, last] = functions.map(|function| builder.unary(function, x));
        assert_eq!(builder.finish(last).at(&[0.3], &mut slots), 0.3_f64.unary(functions[1]));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    /// Over any box the bounds hold the value and the slopes at all its places, and know whether there is a value.
    #[test]
    fn bounds_hold_for_any_function(
        choices in prop::collection::vec((0..31_usize, 0..16_usize, 0..16_usize), 1..9),
        low in prop::array::uniform2(-3.0..3.0_f64),
        size in prop::array::uniform2(0.0..1.5_f64),
    ) {
        let tape = tape_of(&choices);
        let ranges = [0, 1].map(|i| Interval::new(low[i], low[i] + size[i]));
        let dual = |i: usize| {
            let slopes = std::array::from_fn(|k| Interval::point(f64::from(u8::from(i == k))));
            Dual { value: ranges[i], slopes }
        };
        let bounds: Dual<Interval, 2> = tape.at(&[dual(0), dual(1)], &mut Vec::new());
        let rough = tape.at(&ranges.map(Curvature::variable), &mut Vec::new());
        for x in positions(ranges[0]) {
            for y in positions(ranges[1]) {
                let of = |value: f64, slopes: [f64; 2]| Dual { value, slopes };
                let found = tape.at(&[of(x, [1.0, 0.0]), of(y, [0.0, 1.0])], &mut Vec::new());
                let value = found.value;
                match bounds.value.domain {
                    Domain::Everywhere => prop_assert!(!value.is_nan(), "no value at {x} {y}"),
                    Domain::Nowhere => prop_assert!(!value.is_finite(), "a value at {x} {y}"),
                    Domain::Somewhere => {}
                }
                if bounds.value.domain == Domain::Nowhere || !value.is_finite() {
                    continue;
                }
                let length = found.slopes[0].hypot(found.slopes[1]);
                if rough.curvature.is_finite() && length.is_finite() {
                    prop_assert!(rough.value.contains(value) && length <= rough.slope * (1.0 + 1e-9) + 1e-9,
                        "slope {length} at {x} {y} above {rough:?}");
                }
                prop_assert!(bounds.value.contains(value), "{value} at {x} {y} not in {:?}", bounds.value);
                for (slope, bound) in found.slopes.iter().zip(bounds.slopes) {
                    // Slopes of numbers are themselves rounded, by more than the bounds of exact ones know.
                    let margin = 1e-9 * (1.0 + slope.abs());
                    let within = !(*slope < bound.lo - margin || *slope > bound.hi + margin);
                    prop_assert!(!slope.is_finite() || within, "slope {slope} at {x} {y} not in {bound:?}");
                }
            }
        }
    }

    /// Between any two places a function departs from its tangent by no more than half of its largest curvature times the
    /// square of the distance.
    #[test]
    fn curvature_is_a_bound(
        choices in prop::collection::vec((0..31_usize, 0..16_usize, 0..16_usize), 1..6),
        a in prop::array::uniform2(-3.0..3.0_f64),
        by in prop::array::uniform2(-0.5..0.5_f64),
    ) {
        let tape = tape_of(&choices);
        let b = [a[0] + by[0], a[1] + by[1]];
        let ranges = [0, 1].map(|i| Curvature::variable(Interval::new(a[i].min(b[i]), a[i].max(b[i]))));
        let bound = tape.at(&ranges, &mut Vec::new());
        if bound.curvature.is_finite() && bound.value.domain == Domain::Everywhere {
            let duals = [0, 1].map(|i| Dual { value: a[i], slopes: [by[i]] });
            let from = tape.at(&duals, &mut Vec::new());
            let value = tape.at(&b, &mut Vec::new());
            let departs = (value - from.value - from.slopes[0]).abs();
            let most = 0.5 * bound.curvature * (by[0] * by[0] + by[1] * by[1]);
            let rounding = 1e-9 * (1.0 + from.value.abs() + value.abs() + from.slopes[0].abs());
            prop_assert!(departs <= most + rounding, "{departs} above {most}");
        }
    }

    /// Slopes are those of differences, where the function is smooth.
    #[test]
    fn slopes_are_differences(i in 0..31_usize, x in 0.1..0.9_f64, y in 1.1..1.9_f64) {
        let tape = tape_of(&[(i, 0, 1)]);
        let at = |x: f64, y: f64| tape.at(&[x, y], &mut Vec::new());
        let h = 1e-6;
        let expected = [(at(x + h, y) - at(x - h, y)) / (2.0 * h), (at(x, y + h) - at(x, y - h)) / (2.0 * h)];
        let duals = [Dual { value: x, slopes: [1.0, 0.0] }, Dual { value: y, slopes: [0.0, 1.0] }];
        let found = tape.at(&duals, &mut Vec::new());
        let is_step = |f: Unary| matches!(f, Unary::Sign | Unary::Floor | Unary::Ceil | Unary::Round);
        for (a, b) in found.slopes.iter().zip(expected) {
            let jumps = UNARY.get(i).is_some_and(|&f| is_step(f)) && b.abs() > 1.0;
            prop_assert!(jumps || (a - b).abs() < 1e-5 * (1.0 + a.abs()), "{a} for {b} at {x} {y}");
        }
    }
}
