//! The `Settings` block.

use kajo_color::Tone;
use kajo_scene::{Args, Diagnostic, Diagnostics, Item, Params};

use crate::interaction::RayOffset;
use crate::light::LightChoice;
use crate::sampler::SamplerKind;
use crate::settings::{
    Dialect, Directions, FilterChoice, IntegratorKind, Settings, ShadowAttenuation, Shadows, Technique,
};

const SHADOWS: [(&str, Shadows); 3] =
    [("off", Shadows::Off), ("on", Shadows::Opaque), ("transparent", Shadows::Transparent)];
const ATTENUATIONS: [(&str, ShadowAttenuation); 2] =
    [("length", ShadowAttenuation::Length), ("surface", ShadowAttenuation::Surface)];
const OFFSETS: [(&str, RayOffset); 2] = [("auto", RayOffset::Auto), ("reference", RayOffset::Reference)];

/// The most samples of a pixel.
pub const MAX_SAMPLES: i64 = 1 << 20;

/// The most rays from one surface.
pub const MAX_BRANCHES: i64 = 1 << 16;

pub(super) fn read(item: Item<'_>, diagnostics: &mut Diagnostics) -> Settings {
    let mut params = Params::new(item, diagnostics);
    let tones = Tone::ALL.map(|tone| (tone.name(), tone));
    let dialects: Vec<_> = Dialect::NAMES.into_iter().zip(Dialect::ALL).collect();
    let settings = Settings {
        size: params.optional("size", size),
        bounces: params.optional("bounces", |a| a.int_in(0..=1000).map(|n| n as u32)),
        weight: params.optional("weight", |a| a.number_in(0.0..)),
        shadows: params.optional("shadows", |a| a.choice(&SHADOWS)),
        shadow_attenuation: params.optional("transparentShadows", |a| a.choice(&ATTENUATIONS)),
        shade_back: params.optional("shadeBack", Args::flag),
        samples: params
            .optional("samples", |a| Ok((a.choice(&SamplerKind::NAMES)?, a.int_in(1..=MAX_SAMPLES)? as u32))),
        filter: params.optional("filter", filter),
        seed: params.optional("seed", |a| a.int_in(0..=1 << 53).map(|n| n as u64)),
        fresnel: params.optional("fresnel", Args::flag),
        total_reflection: params.optional("totalReflection", Args::flag),
        ray_offset: params.optional("rayOffset", |a| a.choice(&OFFSETS)),
        dialect: params.optional("dialect", |a| a.choice(&dialects)),
        depth_range: params.optional("depthRange", Args::numbers::<2>),
        integrator: params.optional("integrator", |a| a.choice(&IntegratorKind::NAMES)),
        spectral: params.optional("spectral", Args::flag),
        branches: params.optional("branches", |a| a.int_in(1..=MAX_BRANCHES).map(|n| n as u32)),
        directions: params.optional("directions", |a| a.choice(&Directions::NAMES)),
        technique: params.optional("technique", |a| a.choice(&Technique::NAMES)),
        light_choice: params.optional("lightChoice", |a| a.choice(&LightChoice::NAMES)),
        roulette: params.optional("roulette", Args::flag),
        reach: params.optional("reach", Args::positive),
        exposure: params.optional("exposure", |a| a.number_in(-100.0..=100.0)),
        tone: params.optional("tone", |a| a.choice(&tones)),
        white_balance: params.optional("whiteBalance", white_balance),
    };
    params.finish();
    settings
}

/// A temperature in kelvin, and a tint if there is one.
fn white_balance(args: &mut Args<'_>) -> Result<[f64; 2], Diagnostic> {
    let kelvin = args.number_in(1000.0..=25_000.0)?;
    let tint = if args.numbers_left() == 0 { 0.0 } else { args.number_in(-150.0..=150.0)? };
    Ok([kelvin.into(), tint.into()])
}

fn size(args: &mut Args<'_>) -> Result<[u32; 2], Diagnostic> {
    let side = |n: f32| ((1.0..=16_777_216.0).contains(&n) && n == n.trunc()).then_some(n as u32);
    match args.numbers::<2>()?.map(side) {
        [Some(w), Some(h)] => Ok([w, h]),
        _ => Err(args.error("`size` must be two whole numbers above zero")),
    }
}

/// A filter with its radius, or its standard deviation where it is Gaussian.
fn filter(args: &mut Args<'_>) -> Result<FilterChoice, Diagnostic> {
    type Make = fn(f32) -> FilterChoice;
    let kinds: [(&str, (Make, f32)); 6] = [
        ("box", (FilterChoice::Box, 0.5)),
        ("gaussian", (FilterChoice::Gaussian, 0.5)),
        ("lanczos", (FilterChoice::Lanczos, 3.0)),
        ("mitchell", (FilterChoice::Mitchell, 2.0)),
        ("none", (|_| FilterChoice::None, 0.0)),
        ("tent", (FilterChoice::Tent, 1.0)),
    ];
    let (make, default) = args.choice(&kinds)?;
    let size = if args.numbers_left() == 0 { default } else { args.number_in(1e-3..=64.0)? };
    Ok(make(size))
}
