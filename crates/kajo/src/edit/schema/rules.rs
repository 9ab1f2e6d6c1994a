//! Defaults that depend on what is around a field: on other fields of its block, on the dialect of the file, on how the
//! scene is rendered.
//!
//! Each function says what the compiler, or a render without other wishes, takes where the field of its name is absent.
//! `None` stands for what no value says.

use kajo_core::scene::Scene;
use kajo_core::settings::{Dialect, IntegratorKind, Rules, Settings, ShadowAttenuation};
use kajo_math::fmath;

use super::FieldValue;
use crate::{Defaults, RenderSettings};

/// What is around a field.
pub struct Around<'a> {
    /// The value that holds for a key of the same block.
    pub(in crate::edit) value: &'a dyn Fn(&str) -> Option<FieldValue>,
    /// Whether a key is written in the same block.
    pub(in crate::edit) is_written: &'a dyn Fn(&str) -> bool,
    /// The scene that the texts make, where there is one.
    pub(in crate::edit) scene: Option<&'a Scene>,
}

impl Around<'_> {
    fn number(&self, key: &str) -> Option<f64> {
        (self.value)(key)?.numbers.first().copied()
    }

    /// A colour, unless it is a spectrum or a picture.
    fn color(&self, key: &str) -> Option<FieldValue> {
        (self.value)(key).filter(|value| value.word.is_none() && value.numbers.len() == 3)
    }

    fn rules(&self) -> Rules {
        self.scene.map_or_else(|| Dialect::default().rules(), |scene| scene.rules)
    }

    /// What a render of the scene does when nobody asks for anything else.
    fn render(&self) -> Option<RenderSettings> {
        RenderSettings::resolve(self.scene?, &Settings::default(), Defaults::Modern, false).ok()
    }
}

fn numbers<const N: usize>(numbers: [f32; N]) -> Option<FieldValue> {
    Some(FieldValue::numbers(numbers.map(f64::from)))
}

fn whole(number: u32) -> Option<FieldValue> {
    Some(FieldValue::numbers([f64::from(number)]))
}

fn word(word: &str) -> Option<FieldValue> {
    Some(FieldValue::word(word))
}

// ---- shapes and lights -------------------------------------------------------------------------------------------

pub(super) fn smooth(around: &Around<'_>) -> Option<FieldValue> {
    (!around.rules().smooth_meshes).then(|| FieldValue::flag(false))
}

/// The tint of a measured luminaire; other lights have no colour unless one is written.
pub(super) fn color_of_light(around: &Around<'_>) -> Option<FieldValue> {
    (around.is_written)("ies").then(|| FieldValue::numbers([1.0; 3]))
}

pub(super) fn inner_angle(around: &Around<'_>) -> Option<FieldValue> {
    numbers([0.75 * around.number("angle")? as f32])
}

// ---- materials ---------------------------------------------------------------------------------------------------

pub(super) fn exponent(around: &Around<'_>) -> Option<FieldValue> {
    numbers([if around.rules().reflects_specular { 0.0 } else { 1.0 }])
}

pub(super) fn reflective_color(around: &Around<'_>) -> Option<FieldValue> {
    if around.rules().reflects_specular { around.color("specularColor") } else { numbers([0.0; 3]) }
}

pub(super) fn ambient_color(around: &Around<'_>) -> Option<FieldValue> {
    around.color("diffuseColor")
}

/// What leaves the transparent colour after one unit of length; nothing passes where that is black.
pub(super) fn absorption(around: &Around<'_>) -> Option<FieldValue> {
    let transparent = around.color("transparentColor")?.vec3()?;
    let of = |share: f64| (-fmath::ln(share as f32)).max(0.0);
    transparent.iter().all(|share| *share > 0.0).then(|| numbers(transparent.map(of)))?
}

pub(super) fn thin(around: &Around<'_>) -> Option<FieldValue> {
    Some(FieldValue::flag((around.is_written)("thickness")))
}

// ---- settings ----------------------------------------------------------------------------------------------------

pub(super) fn size(around: &Around<'_>) -> Option<FieldValue> {
    Some(FieldValue::numbers(around.render()?.size.map(f64::from)))
}

pub(super) fn integrator(around: &Around<'_>) -> Option<FieldValue> {
    word(around.render()?.integrator.name())
}

pub(super) fn samples(around: &Around<'_>) -> Option<FieldValue> {
    let (kind, number) = around.render()?.samples;
    Some(FieldValue { word: Some(kind.name().to_owned()), numbers: vec![number.into()] })
}

pub(super) fn bounces(around: &Around<'_>) -> Option<FieldValue> {
    let render = around.render()?;
    let is_classic = render.integrator == IntegratorKind::Classic;
    whole(if is_classic { render.classic.bounces } else { render.path.bounces })
}

pub(super) fn transparent_shadows(around: &Around<'_>) -> Option<FieldValue> {
    word(match around.render()?.classic.shadow_attenuation {
        ShadowAttenuation::Length => "length",
        ShadowAttenuation::Surface => "surface",
    })
}

pub(super) fn branches(around: &Around<'_>) -> Option<FieldValue> {
    whole(around.render()?.path.branches)
}

pub(super) fn roulette(around: &Around<'_>) -> Option<FieldValue> {
    Some(FieldValue::flag(around.render()?.path.roulette))
}

pub(super) fn tone(around: &Around<'_>) -> Option<FieldValue> {
    word(around.render()?.development.tone.name())
}

pub(super) fn dialect(around: &Around<'_>) -> Option<FieldValue> {
    word(around.rules().dialect.name())
}
