//! Textures that are made of others: ramps, curves, mixtures, products, sums, formulas, other places.

use std::sync::Arc;

use kajo_math::tape::Tape;
use kajo_scene::{Args, Diagnostic, Item, Params};

use super::patterns::{PlacementKeys, mapped, placement};
use crate::compile::fields::{
    Choice, Keys, Sources, between, choice, choices, function, keys, number, share,
};
use crate::compile::member::{Member, TextureMember};
use crate::compile::named_texture::{NamedTexture, numbers_of};
use crate::compile::operands::OPERAND;
use crate::compile::transform;
use crate::schema::{Block, FieldKind, FieldSpec, Kind, NumberRange};
use crate::texture::{
    ColorCombination, ColorOperation, Colors, Curve, CurveNumbers, Cycle, FloatCombination, FloatOperation,
    FloatTexture, Interpolation, Knots, Ramp,
};

/// The one texture that something is made of.
const ONE: &[FieldSpec] = &[OPERAND];

/// The textures that something is made of.
const SEVERAL: &[FieldSpec] = &[OPERAND; 16];

/// How many textures a product or a sum may have.
const FEW: [usize; 2] = [2, 16];

/// A colour of a ramp.
const COLOR_STOP: FieldSpec = FieldSpec {
    repeats: true,
    about: "a position from 0 to 1, and the colour there; any number of these, in order",
    ..FieldSpec::new("stop", FieldKind::ColorStop)
};

/// A number of a curve.
const NUMBER_STOP: FieldSpec = FieldSpec {
    repeats: true,
    about: "a position from 0 to 1, and the number there; any number of these, in order",
    ..FieldSpec::new("stop", FieldKind::Numbers(&[NumberRange::ANY, NumberRange::SHARE]))
};

/// The words for what is between colours.
#[derive(Clone, Copy)]
pub struct Between {
    interpolation: Interpolation,
    is_oklab: bool,
}

impl Between {
    const fn of(interpolation: Interpolation, is_oklab: bool) -> Between {
        Between { interpolation, is_oklab }
    }
}

choices! {
    Between {
        "linear" => Between::of(Interpolation::Linear, false),
        "oklab" => Between::of(Interpolation::Linear, true),
        "smooth" => Between::of(Interpolation::Smooth, false),
        "step" => Between::of(Interpolation::Step, false),
    }
}

choices! {
    Interpolation {
        "linear" => Interpolation::Linear,
        "smooth" => Interpolation::Smooth,
        "step" => Interpolation::Step,
    }
}

keys! {
    RampKeys {
        interpolation: Between = choice::<Between>("interpolation").or_word("linear", "what is between colours"),
        frequency: f32 = number("frequency").or(1.0, "how often it is run through from 0 to 1"),
        phase: f32 = number("phase").or(0.0, "by which part of itself it is moved"),
    }
}

keys! {
    CurveKeys {
        interpolation: Interpolation = choice::<Interpolation>("interpolation")
            .or_word("linear", "what is between numbers"),
    }
}

keys! {
    ThresholdKeys {
        edge: f32 = between("edge", 0.0, 1.0).or(0.5, "what is less is 0, what is more is 1"),
        softness: f32 = between("softness", 0.0, 1.0).or(0.0, "how wide the change is"),
    }
}

keys! {
    BlendKeys {
        amount: FloatTexture = share("amount").or(0.5, "share of the second"),
    }
}

keys! {
    FormulaKeys {
        function: Arc<Tape> = function("function")
            .required("where x, y and z are the first, the second and the third texture"),
    }
}

const fn block(keyword: &'static str, about: &'static str, groups: &'static [&'static [FieldSpec]]) -> Block {
    Block { keyword, kind: Kind::Texture, about, groups, parts: &[] }
}

pub const PLACED: TextureMember = Member {
    block: Block {
        parts: &[&transform::PLACEMENT],
        ..block("Placed", "another texture or a picture at another place", &[ONE, PlacementKeys::FIELDS])
    },
    read: |params, sources| {
        let operands = sources.operands(params, [1, 1]);
        let placed = placement(params, sources);
        let (texture, (mapping, _)) = (operands?.pop()?, placed?);
        mapped(texture, mapping, sources)
    },
};

pub const RAMP: TextureMember = Member {
    block: block("Ramp", "colours by a number", &[ONE, &[COLOR_STOP], RampKeys::FIELDS]),
    read: |params, sources| {
        let texture = number_operand(params, sources);
        let items = params.take(&[COLOR_STOP.key]);
        let keys = RampKeys::read(params, sources);
        let stops = stops(params, &items, |args| {
            let at = args.number()?;
            let mut share = |i| args.number_in(COLOR_STOP.kind.range(i).bounds());
            Ok((at, [share(1)?, share(2)?, share(3)?]))
        });
        let RampKeys { interpolation: Between { interpolation, is_oklab }, frequency, phase } = keys?;
        let colors = Arc::new(Colors::new(stops?, interpolation, is_oklab)?);
        let ramp = Ramp { texture: texture?, cycle: Cycle { frequency, phase }, colors };
        sources.textures.nodes.color(ramp).map(NamedTexture::Color)
    },
};

pub const CURVE: TextureMember = Member {
    block: block("Curve", "numbers by a number", &[ONE, &[NUMBER_STOP], CurveKeys::FIELDS]),
    read: |params, sources| {
        let texture = number_operand(params, sources);
        let items = params.take(&[NUMBER_STOP.key]);
        let keys = CurveKeys::read(params, sources);
        let stops = stops(params, &items, |args| {
            Ok((args.number()?, [args.number_in(NUMBER_STOP.kind.range(1).bounds())?]))
        });
        let knots = Knots::new(stops?, keys?.interpolation)?;
        let curve = Arc::new(CurveNumbers::new(knots));
        sources.textures.nodes.float(Curve { texture: texture?, curve }).map(NamedTexture::Float)
    },
};

pub const THRESHOLD: TextureMember = Member {
    block: block("Threshold", "0 and 1, by whether a number is large", &[ONE, ThresholdKeys::FIELDS]),
    read: |params, sources| {
        let texture = number_operand(params, sources);
        let ThresholdKeys { edge, softness } = ThresholdKeys::read(params, sources)?;
        let (below, above) = (edge - 0.5 * softness, edge + 0.5 * softness);
        let knots = Knots::new(vec![(below, [0.0]), (above, [1.0])], Interpolation::Smooth)?;
        let curve = Arc::new(CurveNumbers::new(knots));
        sources.textures.nodes.float(Curve { texture: texture?, curve }).map(NamedTexture::Float)
    },
};

pub const BLEND: TextureMember = Member {
    block: block("Blend", "two textures in a proportion", &[&[OPERAND; 2], BlendKeys::FIELDS]),
    read: |params, sources| {
        let parts = sources.operands(params, [2, 2]);
        let BlendKeys { amount } = BlendKeys::read(params, sources)?;
        let parts = parts?;
        match numbers_of(&parts) {
            Some(mut numbers) => {
                numbers.push(amount);
                floats(FloatOperation::Mix, numbers, sources)
            }
            None => colors(ColorOperation::Mix(amount), &parts, sources),
        }
    },
};

pub const MULTIPLY: TextureMember = Member {
    block: block("Multiply", "the product of textures", &[SEVERAL]),
    read: |params, sources| {
        let parts = sources.operands(params, FEW)?;
        match numbers_of(&parts) {
            Some(numbers) => floats(FloatOperation::Multiply, numbers, sources),
            None => colors(ColorOperation::Multiply, &parts, sources),
        }
    },
};

pub const ADD: TextureMember = Member {
    block: block("Add", "the sum of textures, held to 1", &[SEVERAL]),
    read: |params, sources| {
        let parts = sources.operands(params, FEW)?;
        match numbers_of(&parts) {
            Some(numbers) => floats(FloatOperation::Add, numbers, sources),
            None => colors(ColorOperation::Add, &parts, sources),
        }
    },
};

pub const FORMULA: TextureMember = Member {
    block: block(
        "Formula",
        "a function of up to three textures, held to [0, 1]",
        &[&[OPERAND; 3], FormulaKeys::FIELDS],
    ),
    read: |params, sources| {
        let parts = sources.operands(params, [1, 3]);
        let FormulaKeys { function } = FormulaKeys::read(params, sources)?;
        let parts = parts?;
        let unset =
            ["x", "y", "z"].iter().zip(0u32..).skip(parts.len()).find(|(_, i)| function.has_variable(*i));
        if let Some((name, _)) = unset {
            let message = format!("`function` takes `{name}`, but there are only {} textures", parts.len());
            params.report(Diagnostic::error(message), "x is the first, y the second, z the third");
            return None;
        }
        let numbers: Option<Vec<_>> = parts.iter().map(|part| part.number(sources.textures.nodes)).collect();
        floats(FloatOperation::Formula(function), numbers?, sources)
    },
};

/// The one texture of a block, as a number.
fn number_operand(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<FloatTexture> {
    let texture = sources.operands(params, [1, 1])?.pop()?;
    texture.number(sources.textures.nodes)
}

/// The colours of a ramp, for display.
///
/// * `stops`: as for [`Colors::new`]
/// * `interpolation`: the word for what is between them
///
/// `None` for an unknown word, and as [`Colors::new`].
pub fn ramp_colors(stops: Vec<(f32, [f32; 3])>, interpolation: &str) -> Option<Colors> {
    let (_, Between { interpolation, is_oklab }) =
        Between::NAMES.iter().find(|(name, _)| *name == interpolation)?;
    Colors::new(stops, *interpolation, *is_oklab)
}

/// The stops of a ramp or a curve; none at all, and one before another, are reported.
fn stops<'t, const N: usize>(
    params: &mut Params<'_, '_>,
    items: &[Item<'t>],
    read: impl Fn(&mut Args<'t>) -> Result<(f32, [f32; N]), Diagnostic>,
) -> Option<Vec<(f32, [f32; N])>> {
    if items.is_empty() {
        let error = Diagnostic::error("there is no `stop`");
        params.report(
            error.help("a `stop` has a position from 0 to 1, and what is there"),
            "has nothing to say",
        );
        return None;
    }
    let found: Vec<_> = items.iter().map(|&item| Args::read(item, params.diagnostics(), &read)).collect();
    let stops = found.into_iter().collect::<Option<Vec<_>>>()?;
    if let Some(i) = (1..stops.len()).find(|&i| stops[i].0 < stops[i - 1].0) {
        let message = format!("this `stop` is at {}, before the last one at {}", stops[i].0, stops[i - 1].0);
        let error = Diagnostic::error(message).label(items[i].head_span(), "goes back");
        params.diagnostics().push(error.help("stops are in the order of their places"));
        return None;
    }
    Some(stops)
}

fn floats(
    operation: FloatOperation,
    parts: Vec<FloatTexture>,
    sources: &mut Sources<'_>,
) -> Option<NamedTexture> {
    let combination = FloatCombination { operation, parts: parts.into() };
    sources.textures.nodes.float(combination).map(NamedTexture::Float)
}

fn colors(
    operation: ColorOperation,
    parts: &[NamedTexture],
    sources: &mut Sources<'_>,
) -> Option<NamedTexture> {
    let nodes = &mut *sources.textures.nodes;
    let parts: Option<Vec<_>> = parts.iter().map(|part| part.color(nodes)).collect();
    nodes.color(ColorCombination { operation, parts: parts?.into() }).map(NamedTexture::Color)
}
