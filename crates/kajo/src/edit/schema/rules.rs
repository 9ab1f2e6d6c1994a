//! Defaults that depend on what is around a field: on other fields of its block, on the dialect of the file, on how the
//! scene is rendered.
//!
//! Each function says what the compiler, or a render without other wishes, takes where the field of its name is absent.
//! `None` stands for what no value says.

use kajo_core::schema::Around;
use kajo_core::settings::{IntegratorKind, Settings, ShadowAttenuation};

use super::FieldValue;
use crate::{Defaults, RenderSettings};

/// What a render of the scene does when nobody asks for anything else.
fn render(around: &Around<'_>) -> Option<RenderSettings> {
    RenderSettings::resolve(around.scene?, &Settings::default(), Defaults::Modern, false).ok()
}

fn whole(number: u32) -> Option<FieldValue> {
    Some(FieldValue::numbers([f64::from(number)]))
}

fn word(word: &str) -> Option<FieldValue> {
    Some(FieldValue::word(word))
}

// ---- settings ----------------------------------------------------------------------------------------------------

pub(super) fn size(around: &Around<'_>) -> Option<FieldValue> {
    Some(FieldValue::numbers(render(around)?.size.map(f64::from)))
}

pub(super) fn integrator(around: &Around<'_>) -> Option<FieldValue> {
    word(render(around)?.integrator.name())
}

pub(super) fn samples(around: &Around<'_>) -> Option<FieldValue> {
    let (kind, number) = render(around)?.samples;
    Some(FieldValue { word: Some(kind.name().to_owned()), numbers: vec![number.into()] })
}

pub(super) fn bounces(around: &Around<'_>) -> Option<FieldValue> {
    let render = render(around)?;
    let is_classic = render.integrator == IntegratorKind::Classic;
    whole(if is_classic { render.classic.bounces } else { render.path.bounces })
}

pub(super) fn transparent_shadows(around: &Around<'_>) -> Option<FieldValue> {
    word(match render(around)?.classic.shadow_attenuation {
        ShadowAttenuation::Length => "length",
        ShadowAttenuation::Surface => "surface",
    })
}

pub(super) fn branches(around: &Around<'_>) -> Option<FieldValue> {
    whole(render(around)?.path.branches)
}

pub(super) fn roulette(around: &Around<'_>) -> Option<FieldValue> {
    Some(FieldValue::flag(render(around)?.path.roulette))
}

pub(super) fn tone(around: &Around<'_>) -> Option<FieldValue> {
    word(render(around)?.development.tone.name())
}

pub(super) fn dialect(around: &Around<'_>) -> Option<FieldValue> {
    word(around.rules().dialect.name())
}
