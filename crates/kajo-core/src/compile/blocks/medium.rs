//! `Medium`: what is the same everywhere, and what all media have in common.

use kajo_color::Emission;
use kajo_scene::{Args, Diagnostic, Params};

use super::phase::{PhaseKeys, phase};
use crate::compile::fields::{Keys, Plain, Sources, Typed, at_least, emission, keys, report_beside};
use crate::compile::member::{MediumMember, Member};
use crate::medium::{Coefficients, HomogeneousMedium};
use crate::schema::Kind;
use crate::schema::{Block, Constant, FieldKind, FieldSpec, NumberRange};

/// Red, green and blue, or one number for all three; not negative.
#[derive(Clone, Copy)]
pub struct PerLength([f32; 3]);

impl Plain<'_> for PerLength {
    fn parse(spec: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<PerLength, Diagnostic> {
        let values = one_or_three(args)?;
        match values.iter().all(|v| v.is_finite() && spec.kind.range(0).contains((*v).into())) {
            true => Ok(PerLength(values)),
            false => Err(args.error(format!("`{}` is not negative", spec.key))),
        }
    }
}

/// Red, green and blue, or one number for all three; from 0 to 1.
#[derive(Clone, Copy)]
pub struct Albedo([f32; 3]);

impl Plain<'_> for Albedo {
    fn parse(spec: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<Albedo, Diagnostic> {
        let values = one_or_three(args)?;
        match values.iter().all(|v| spec.kind.range(0).contains((*v).into())) {
            true => Ok(Albedo(values)),
            false => Err(args.error(format!("`{}` is from 0 to 1", spec.key))),
        }
    }
}

/// A length that light goes without a collision, one or three; above 0.
#[derive(Clone, Copy)]
pub struct FreePath(pub [f32; 3]);

impl Plain<'_> for FreePath {
    fn parse(spec: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<FreePath, Diagnostic> {
        let values = one_or_three(args)?;
        let is_length = |v: f32| v.is_finite() && spec.kind.range(0).contains(v.into());
        match values.iter().all(|v| is_length(*v) && v.recip().is_finite()) {
            true => Ok(FreePath(values)),
            false => Err(args.error(format!("`{}` is more than 0", spec.key))),
        }
    }
}

fn one_or_three(args: &mut Args<'_>) -> Result<[f32; 3], Diagnostic> {
    if args.numbers_left() == 1 { args.number().map(|v| [v; 3]) } else { args.numbers() }
}

const PER_LENGTH: FieldKind = FieldKind::Color(NumberRange::NOT_NEGATIVE);

const SIGMA_A: &str = "sigma_a";
const SIGMA_S: &str = "sigma_s";

keys! {
    /// What every medium has.
    CoefficientKeys {
        sigma_a: Option<PerLength> = Typed::<PerLength>::new(SIGMA_A, PER_LENGTH)
            .unit("1/length")
            .not_beside(&["albedo", "density", "meanFreePath"])
            .unlike("none", "0.1 0.2 0.4", "absorption per length"),
        sigma_s: Option<PerLength> = Typed::<PerLength>::new(SIGMA_S, PER_LENGTH)
            .unit("1/length")
            .not_beside(&["albedo", "density", "meanFreePath"])
            .unlike("none", "1 1 1", "scattering per length"),
        albedo: Option<Albedo> = Typed::<Albedo>::new("albedo", FieldKind::Color(NumberRange::SHARE))
            .not_beside(&[SIGMA_A, SIGMA_S])
            .presumed(Constant::Triple([1.0; 3]), "share of light that a collision scatters"),
        density: Option<PerLength> = Typed::<PerLength>::new("density", PER_LENGTH)
            .unit("1/length")
            .not_beside(&[SIGMA_A, SIGMA_S, "meanFreePath"])
            .unlike("by the other keys", "1 1 1", "collisions per length"),
        mean_free_path: Option<FreePath> = Typed::<FreePath>::new("meanFreePath", FieldKind::Color(NumberRange::POSITIVE))
            .unit("length")
            .not_beside(&[SIGMA_A, SIGMA_S, "density"])
            .unlike("by the other keys", "1 1 1", "mean length between collisions"),
        scale: f32 = at_least("scale", 0.0).or(1.0, "makes all of it denser"),
        emission: Option<Emission> = emission("emission")
            .unit("W/(m³ sr)")
            .presumed(Constant::Triple([0.0; 3]), "radiance per length that it gives itself"),
    }
}

pub const MEMBER: MediumMember = Member {
    block: Block {
        keyword: "Medium",
        kind: Kind::Medium,
        about: "milk, haze, coloured water: what is the same everywhere",
        groups: &[CoefficientKeys::FIELDS, PhaseKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item| {
        compiler.medium(item, |params, sources| {
            Some(HomogeneousMedium { coefficients: coefficients(params, sources)? })
        })
    },
};

/// What a medium of density 1 does to light, by the keys of its block.
pub fn coefficients(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<Coefficients> {
    for key in [SIGMA_A, SIGMA_S, "meanFreePath"] {
        if params.contains(key) {
            report_beside(params, CoefficientKeys::FIELDS, key);
        }
    }
    // Grids may only emit, by a `temperature`.
    let any = [SIGMA_A, SIGMA_S, "density", "meanFreePath", "temperature"];
    let has_none = !any.into_iter().any(|key| params.contains(key));
    let (keys, phase) = (CoefficientKeys::read(params, sources), phase(params, sources));
    let keys = keys?;
    if has_none && keys.emission.is_none() {
        let error = Diagnostic::error("this medium has no density");
        let help =
            "write `sigma_a` and `sigma_s`, or `albedo` with `density` or `meanFreePath`; or an `emission`";
        params.report(error.help(help), "does nothing to light");
        return None;
    }
    let phase = phase?;
    let of = |value: Option<PerLength>| value.map_or([0.0; 3], |PerLength(value)| value);
    let scaled = |value: [f32; 3]| value.map(|v| v * keys.scale);
    let extinction = match keys.mean_free_path {
        Some(FreePath(lengths)) => lengths.map(f32::recip),
        None => of(keys.density),
    };
    let made = if keys.density.is_some() || keys.mean_free_path.is_some() {
        let Albedo(albedo) = keys.albedo.unwrap_or(Albedo([1.0; 3]));
        Coefficients::from_albedo(albedo, scaled(extinction), phase)
    } else {
        Coefficients::new(scaled(of(keys.sigma_a)), scaled(of(keys.sigma_s)), phase)
    };
    let report = |error| params.report(Diagnostic::error(format!("{error}")), "is none");
    let made = made.map_err(report).ok()?;
    Some(match keys.emission {
        Some(emission) => made.with_emission(emission.scaled(keys.scale)),
        None => made,
    })
}
