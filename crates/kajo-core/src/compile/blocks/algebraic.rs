//! `Quadric`, `Cubic` and `Quartic`: where a polynomial is zero.

use std::sync::Arc;

use kajo_math::Vec3;
use kajo_math::tape::{Node, Tape, TapeBuilder};
use kajo_scene::{Args, Diagnostic, Params};

use super::isosurface::surface;
use crate::compile::fields::{Keys, Plain, Sources, Typed, flag, keys, point};
use crate::compile::member::{Member, ObjectMember};
use crate::schema::{Block, FieldKind, FieldSpec, Kind, NumberRange};

/// The coefficients of a polynomial of degree `D`, in the order of POV-Ray's `poly`: `x^D`, `x^(D-1) y`, `x^(D-1) z`,
/// `x^(D-1)`, `x^(D-2) y^2`, ..., 1.
struct Coefficients<const D: usize>(Vec<f64>);

/// How many coefficients a polynomial of a degree has.
const fn count(degree: usize) -> usize {
    (degree + 1) * (degree + 2) * (degree + 3) / 6
}

impl<const D: usize> Plain<'_> for Coefficients<D> {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<Coefficients<D>, Diagnostic> {
        let (wanted, found) = (count(D), args.numbers_left());
        if wanted != found {
            return Err(args.error(format!("expected {wanted} numbers after `coefficients`, found {found}")));
        }
        (0..wanted).map(|_| args.double()).collect::<Result<_, _>>().map(Coefficients)
    }
}

impl<const D: usize> Coefficients<D> {
    /// The polynomial by Horner's rule: in x, of polynomials in y, of polynomials in z.
    fn function(&self) -> Tape {
        let mut tape = TapeBuilder::new();
        let [x, y, z] = [0, 1, 2].map(|i| tape.variable(i));
        let mut left = self.0.iter().copied();
        let mut in_x = Node::Constant(0.0);
        for i in (0..=D).rev() {
            let mut in_y = Node::Constant(0.0);
            for j in (0..=D - i).rev() {
                let mut in_z = Node::Constant(0.0);
                for _ in 0..=D - i - j {
                    in_z = step(&mut tape, in_z, z, Node::Constant(left.next().unwrap_or(0.0)));
                }
                in_y = step(&mut tape, in_y, y, in_z);
            }
            in_x = step(&mut tape, in_x, x, in_y);
        }
        tape.finish(in_x)
    }
}

/// `sum x + next`.
fn step(tape: &mut TapeBuilder, sum: Node, x: Node, next: Node) -> Node {
    let raised = if sum == Node::Constant(0.0) { sum } else { tape.mul(sum, x) };
    tape.add(raised, next)
}

/// A block for polynomials of one degree.
macro_rules! algebraic {
    ($member:ident, $keys:ident, $degree:literal, $keyword:literal, $about:literal) => {
        keys! {
            $keys {
                coefficients: Coefficients<$degree> =
                    Typed::<Coefficients<$degree>>::new("coefficients", FieldKind::Numbers(&[NumberRange::ANY; count($degree)]))
                        .required("of the powers of x, y and z, in their order"),
                min: Vec3 = point("min").or([-1.0; 3], "the corner of its box with the smallest coordinates"),
                max: Vec3 = point("max").or([1.0; 3], "the corner of its box with the largest coordinates"),
                closed: bool = flag("closed").or(true, "whether faces of the box close it where they cut it"),
            }
        }

        pub const $member: ObjectMember = Member {
            block: Block {
                keyword: $keyword,
                kind: Kind::Shape,
                about: $about,
                groups: &[$keys::FIELDS],
                parts: &[],
            },
            read: |compiler, item, ctm, state| {
                compiler.solid(item, ctm, state, |params: &mut Params<'_, '_>, sources: &mut Sources<'_>| {
                    let $keys { coefficients, min, max, closed } = $keys::read(params, sources)?;
                    surface(params, Arc::new(coefficients.function()), [min, max], closed)
                })
            },
        };
    };
}

algebraic!(QUADRIC, QuadricKeys, 2, "Quadric", "where a polynomial of degree 2 is zero, in a box");
algebraic!(CUBIC, CubicKeys, 3, "Cubic", "where a polynomial of degree 3 is zero, in a box");
algebraic!(QUARTIC, QuarticKeys, 4, "Quartic", "where a polynomial of degree 4 is zero, in a box");

#[cfg(test)]
mod tests {
    use super::*;

    /// Coefficients that are one after the other 1, the others being 0, give the monomials in the order of POV-Ray.
    #[test]
    fn coefficients_are_in_their_order() {
        let [x, y, z] = [3.0, 5.0, 7.0_f64];
        let expected = [x * x, x * y, x * z, x, y * y, y * z, y, z * z, z, 1.0];
        for (i, value) in expected.into_iter().enumerate() {
            let mut coefficients = vec![0.0; count(2)];
            coefficients[i] = 1.0;
            let function = Coefficients::<2>(coefficients).function();
            assert_eq!(function.at(&[x, y, z], &mut Vec::new()), value);
        }
        let all = Coefficients::<4>((0..35).map(f64::from).collect()).function();
        let mut sum = 0.0;
        let mut number = 0.0;
        for i in (0..=4).rev() {
            for j in (0..=4 - i).rev() {
                for k in (0..=4 - i - j).rev() {
                    sum += number * x.powi(i) * y.powi(j) * z.powi(k);
                    number += 1.0;
                }
            }
        }
        assert_eq!(all.at(&[x, y, z], &mut Vec::new()), sum);
    }
}
