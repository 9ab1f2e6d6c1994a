//! `Polynomial`: where a sum of powers of x, y and z is zero.

use std::sync::Arc;

use kajo_math::Vec3;
use kajo_math::tape::{Binary, Node, Tape, TapeBuilder};
use kajo_scene::{Args, Diagnostic, Params};

use super::isosurface::surface;
use crate::compile::fields::{Keys, Plain, Sources, Typed, flag, keys, point};
use crate::compile::member::{Member, ObjectMember};
use crate::schema::{Block, FieldKind, FieldSpec, Kind, NumberRange};
use crate::shape::Isosurface;

/// A power.
const POWER: NumberRange = NumberRange { min: 0.0, max: 100.0 };

/// A coefficient, and the powers of x, y and z that it is for.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Term {
    coefficient: f64,
    powers: [u32; 3],
}

/// All terms of a polynomial.
struct Terms(Vec<Term>);

impl Plain<'_> for Terms {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<Terms, Diagnostic> {
        let found = args.numbers_left();
        if found == 0 || !found.is_multiple_of(4) {
            let message = format!(
                "expected groups of 4 numbers after `terms`, a coefficient and the powers of x, y and z; found {found} numbers"
            );
            return Err(args.error(message));
        }
        let mut term = || {
            let coefficient = args.double()?;
            let mut powers = [0; 3];
            for power in &mut powers {
                *power = args.int_in(POWER.wholes())? as u32;
            }
            Ok(Term { coefficient, powers })
        };
        (0..found / 4).map(|_| term()).collect::<Result<_, _>>().map(Terms)
    }
}

keys! {
    PolynomialKeys {
        terms: Terms = Typed::<Terms>::new("terms", FieldKind::Groups(&[NumberRange::ANY, POWER, POWER, POWER]))
            .required("for each term a coefficient and the powers of x, y and z"),
        min: Vec3 = point("min").or([-1.0; 3], "the corner of its box with the smallest coordinates"),
        max: Vec3 = point("max").or([1.0; 3], "the corner of its box with the largest coordinates"),
        closed: bool = flag("closed").or(true, "whether faces of the box close it where they cut it"),
    }
}

pub const MEMBER: ObjectMember = Member {
    block: Block {
        keyword: "Polynomial",
        kind: Kind::Shape,
        about: "where a polynomial of any degree is zero, in a box",
        groups: &[PolynomialKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item, ctm, state| {
        compiler.solid(item, ctm, state, |params, sources| read(params, sources))
    },
};

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<Isosurface> {
    let PolynomialKeys { terms: Terms(terms), min, max, closed } = PolynomialKeys::read(params, sources)?;
    surface(params, Arc::new(function(&terms)), [min, max], closed)
}

/// The sum of all terms. Powers are taken as powers, so that interval arithmetic knows that even ones are not negative.
fn function(terms: &[Term]) -> Tape {
    let mut tape = TapeBuilder::new();
    let variables = [0, 1, 2].map(|i| tape.variable(i));
    let mut sum = Node::Constant(0.0);
    for term in terms {
        let mut product = Node::Constant(term.coefficient);
        for (&variable, &power) in variables.iter().zip(&term.powers) {
            let raised = match power {
                0 => continue,
                1 => variable,
                _ => tape.binary(Binary::Pow, variable, Node::Constant(power.into())),
            };
            product = tape.mul(product, raised);
        }
        sum = tape.add(sum, product);
    }
    tape.finish(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_add_up() {
        let term = |coefficient: f64, powers: [u32; 3]| Term { coefficient, powers };
        let all = [term(2.0, [3, 1, 0]), term(-1.0, [0, 0, 60]), term(0.5, [0, 0, 0]), term(1.0, [0, 2, 1])];
        let function = function(&all);
        let [x, y, z] = [0.7, -1.3, 0.9_f64];
        let expected = 2.0 * x.powi(3) * y - z.powi(60) + 0.5 + y * y * z;
        assert!((function.at(&[x, y, z], &mut Vec::new()) - expected).abs() < 1e-14);
    }
}
