//! Values of fields that are light, colours and textures.

use kajo_color::{Emission, Reflectance, Spectrum};
use kajo_math::Vec3;
use kajo_scene::{Args, Diagnostic, Diagnostics, Item};

use super::picture_keys::{COLORS, NUMBERS};
use super::pictures::is_picture;
use super::{Optional, Plain, Sources, Stated, Typed, Value, triple_of};
use crate::compile::light_groups;
use crate::compile::named_texture::is_spectrum;
use crate::compile::spectra::Written;
use crate::ids::LightGroup;
use crate::schema::{Constant, FieldKind, FieldSpec, NumberRange};
use crate::texture::{ColorTexture, FloatTexture};

impl Plain<'_> for Emission {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, sources: &mut Sources<'_>) -> Result<Emission, Diagnostic> {
        sources.textures.spectra.emission(args)
    }
}

/// Light that is not negative.
pub(in crate::compile) const fn emission(key: &'static str) -> Typed<Emission> {
    Typed::new(key, FieldKind::Emission)
}

impl Plain<'_> for Written<Emission> {
    fn parse(
        _: &FieldSpec,
        args: &mut Args<'_>,
        sources: &mut Sources<'_>,
    ) -> Result<Written<Emission>, Diagnostic> {
        sources.textures.spectra.classic_light(args)
    }
}

impl Stated for Written<Emission> {
    fn of(constant: Constant) -> Option<Written<Emission>> {
        let rgb = Vec3::of(constant)?;
        Some(Written { rgb: rgb.into(), value: Emission::from_rgb(rgb.to_array()) })
    }
}

/// Light of the classic format, which may be negative.
pub(in crate::compile) const fn classic_light(key: &'static str) -> Typed<Written<Emission>> {
    Typed::new(key, FieldKind::Emission)
}

impl Plain<'_> for Written<Reflectance> {
    fn parse(
        _: &FieldSpec,
        args: &mut Args<'_>,
        sources: &mut Sources<'_>,
    ) -> Result<Written<Reflectance>, Diagnostic> {
        sources.textures.spectra.reflectance(args)
    }
}

impl Stated for Written<Reflectance> {
    fn of(constant: Constant) -> Option<Written<Reflectance>> {
        let [grey, ..] = <[f32; 3]>::of(constant)?;
        Some(Written { rgb: Spectrum::WHITE * grey, value: Reflectance::from_rgb([grey; 3]) })
    }
}

/// The colour of a surface of the classic format, which may be anything.
pub(in crate::compile) const fn reflectance(key: &'static str) -> Typed<Written<Reflectance>> {
    Typed::new(key, FieldKind::Reflectance)
}

/// A colour that is three numbers.
pub(in crate::compile) const fn color(key: &'static str) -> Typed<Vec3> {
    Typed::new(key, FieldKind::COLOR)
}

/// Absorption per unit length, which is not negative.
pub(in crate::compile) struct Absorption(pub [f32; 3]);

impl Plain<'_> for Absorption {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<Absorption, Diagnostic> {
        let absorption = args.vec3()?;
        if absorption.min_element() < 0.0 {
            return Err(args.error("absorption is not negative"));
        }
        Ok(Absorption(absorption.to_array()))
    }
}

impl Stated for Absorption {
    fn of(constant: Constant) -> Option<Absorption> {
        Vec3::of(constant).map(|absorption| Absorption(absorption.to_array()))
    }
}

/// Absorption per unit length.
pub(in crate::compile) const fn absorption(key: &'static str) -> Typed<Absorption> {
    Typed::new(key, FieldKind::Color(NumberRange::NOT_NEGATIVE))
}

impl Value<'_> for ColorTexture {
    fn read(
        _: &FieldSpec,
        item: Item<'_>,
        diagnostics: &mut Diagnostics,
        sources: &mut Sources<'_>,
    ) -> Option<ColorTexture> {
        sources.color(item, diagnostics)
    }
}

impl Stated for ColorTexture {
    fn of(constant: Constant) -> Option<ColorTexture> {
        Vec3::of(constant).map(|color| ColorTexture::Constant(Reflectance::from_rgb(color.to_array())))
    }
}

/// A colour whose components are shares of light, a measured spectrum of such, or a texture.
pub(in crate::compile) const fn color_texture(key: &'static str) -> Typed<ColorTexture> {
    Typed::new(key, FieldKind::Reflectance).textured(&COLORS)
}

/// A colour of the classic format, or a texture as a factor of white.
#[derive(Clone)]
pub(in crate::compile) struct Textured<V> {
    pub value: V,
    pub texture: Option<ColorTexture>,
}

impl<V> From<V> for Textured<V> {
    fn from(value: V) -> Textured<V> {
        Textured { value, texture: None }
    }
}

impl<'t, V: Plain<'t> + Stated> Value<'t> for Textured<V> {
    fn read(
        spec: &FieldSpec,
        item: Item<'t>,
        diagnostics: &mut Diagnostics,
        sources: &mut Sources<'_>,
    ) -> Option<Textured<V>> {
        let texture = match sources.named_texture(item, diagnostics, is_spectrum) {
            Some(named) => {
                Args::read(item, diagnostics, |args| args.text())?;
                named?.color(sources.textures.nodes)
            }
            None if is_picture(item) => sources.color(item, diagnostics),
            None => return V::read(spec, item, diagnostics, sources).map(Textured::from),
        };
        let texture = Some(texture?);
        V::of(triple_of([1.0; 3])).map(|value| Textured { value, texture })
    }
}

impl<V: Stated> Stated for Textured<V> {
    fn of(constant: Constant) -> Option<Textured<V>> {
        V::of(constant).map(Textured::from)
    }
}

impl Value<'_> for FloatTexture {
    fn read(
        spec: &FieldSpec,
        item: Item<'_>,
        diagnostics: &mut Diagnostics,
        sources: &mut Sources<'_>,
    ) -> Option<FloatTexture> {
        sources.float(spec, item, diagnostics)
    }
}

impl Stated for FloatTexture {
    fn of(constant: Constant) -> Option<FloatTexture> {
        f32::of(constant).map(FloatTexture::Constant)
    }
}

/// A number from `min` to `max`, or a texture of such.
pub(in crate::compile) const fn float_texture(key: &'static str, min: f64, max: f64) -> Typed<FloatTexture> {
    Typed::new(key, FieldKind::Number { min, max }).textured(&NUMBERS)
}

/// A number in [0, 1], or a texture of such.
pub(in crate::compile) const fn share(key: &'static str) -> Typed<FloatTexture> {
    float_texture(key, 0.0, 1.0)
}

impl Plain<'_> for LightGroup {
    fn parse(
        _: &FieldSpec,
        args: &mut Args<'_>,
        sources: &mut Sources<'_>,
    ) -> Result<LightGroup, Diagnostic> {
        light_groups::read(args, sources.groups)
    }
}

/// The group of lights that something is seen in.
pub(in crate::compile) const fn light_group(key: &'static str) -> Typed<LightGroup> {
    Typed::new(key, FieldKind::Text)
}

/// The group of lights that something is seen in.
pub(in crate::compile) const GROUP: Optional<LightGroup> =
    light_group("group").option("name of the lights it is seen among");
