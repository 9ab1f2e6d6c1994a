//! `PhongMaterial`, also called `Material`: the classic material.

use kajo_color::{Reflectance, Spectrum};
use kajo_math::{Vec3, fmath};
use kajo_scene::{Args, Diagnostic, Item, Params};

use super::marble::VeinKeys;
use crate::bsdf::Phong;
use crate::compile::Compiler;
use crate::compile::extras::{ExtraKeys, Extras};
use crate::compile::fields::{
    COLORS, Given, Keys, Sources, Textured, Typed, at_least, color, float_texture, keys, positive,
    reflectance,
};
use crate::compile::material_draft::Draft;
use crate::compile::member::{MaterialMember, Member};
use crate::compile::picture_values::ColorPicture;
use crate::compile::spectra::Written;
use crate::material::{Blend, PhongMaterial, PhongTextures};
use crate::schema::{Absent, Around, Block, Constant, FieldKind, FieldSpec, FieldValue, Kind};
use crate::settings::Rules;
use crate::texture::{FloatTexture, Marble};

/// Absorption that lets nothing through.
const OPAQUE: f32 = 1e30;

keys! {
    PhongKeys<'t> {
        diffuse: Textured<Written<Reflectance>> =
            reflectance("diffuseColor").or_grey(1.0, "colour of matte reflection").or_texture(),
        texture: Option<ColorPicture> = Typed::<ColorPicture>::new("texture", FieldKind::Picture)
            .textured(&COLORS)
            .option("a picture that tints it, such as wood.png"),
        specular: Textured<Written<Reflectance>> =
            reflectance("specularColor").or_grey(0.0, "colour of the highlight").or_texture(),
        exponent: Option<FloatTexture> = float_texture("exponent", 0.0, f64::MAX)
            .ruled(exponent, "1, or 0 in mit-a2", "sharpness of the highlight"),
        shininess: Option<FloatTexture> = float_texture("shininess", 0.0, f64::MAX)
            .spelling_of("exponent")
            .ruled(exponent, "1, or 0 in mit-a2", "sharpness of the highlight"),
        reflective: Option<Textured<Written<Reflectance>>> = reflectance("reflectiveColor")
            .ruled(reflective_color, "as `specularColor`", "colour of mirror reflection")
            .or_texture(),
        transparent: Option<Textured<Written<Reflectance>>> = reflectance("transparentColor")
            .presumed(Constant::Triple([0.0; 3]), "colour of what shines through")
            .or_texture(),
        index: Given<'t, f32> =
            positive("indexOfRefraction").or(1.0, "how strongly it bends light").given(),
        refraction_index: Option<f32> = at_least("refractionIndex", 0.0)
            .spelling_of("indexOfRefraction")
            .presumed(Constant::Number(0.0), "how strongly it bends light; 0 is opaque"),
        ambient: Option<Textured<Vec3>> = color("ambientColor")
            .ruled(ambient_color, "as `diffuseColor`", "colour under ambient light")
            .or_texture(),
        absorption: Option<Vec3> = color("absorption")
            .unit("1/length")
            .only_beside("transparentColor")
            .ruled(absorption, "by `transparentColor`", "per length inside"),
    }
}

const FIELDS: &[&[FieldSpec]] = &[PhongKeys::FIELDS, ExtraKeys::FIELDS];

pub const MEMBER: MaterialMember = Member {
    block: Block {
        keyword: "PhongMaterial",
        kind: Kind::Material,
        about: "the classic material: matte, with a highlight, a mirror or clear",
        groups: FIELDS,
        parts: &[&VEINS],
    },
    read: draft,
};

/// What the two colours of veins are written by.
const VEIN_COLOR: FieldSpec = FieldSpec {
    absent: Absent::Value(Constant::Triple([0.0; 3])),
    about: "the colours it goes between: black and white unless written",
    ..FieldSpec::new("color", FieldKind::COLOR)
};

/// Veins of two colours in place of the diffuse one.
const VEINS: Block = Block {
    keyword: "Noise",
    kind: Kind::Part,
    about: "veins of two colours in place of the diffuse one",
    groups: &[&[VEIN_COLOR, VEIN_COLOR], VeinKeys::FIELDS],
    parts: &[],
};

/// The same by its other name.
pub const SHORT: MaterialMember = Member {
    block: Block {
        keyword: "Material",
        kind: Kind::Material,
        about: "the same as `PhongMaterial`",
        groups: FIELDS,
        parts: &[&VEINS],
    },
    read: draft,
};

fn default_exponent(rules: &Rules) -> f32 {
    if rules.reflects_specular { 0.0 } else { 1.0 }
}

fn exponent(around: &Around<'_>) -> Option<FieldValue> {
    Some(FieldValue::numbers([f64::from(default_exponent(&around.rules()))]))
}

fn reflective_color(around: &Around<'_>) -> Option<FieldValue> {
    match around.rules().reflects_specular {
        true => around.color("specularColor"),
        false => Some(FieldValue::numbers([0.0; 3])),
    }
}

fn ambient_color(around: &Around<'_>) -> Option<FieldValue> {
    around.color("diffuseColor")
}

/// What leaves the transparent colour after one unit of length; no number says that nothing passes where that is black.
fn absorption(around: &Around<'_>) -> Option<FieldValue> {
    let transparent = around.color("transparentColor")?.vec3()?.map(|share| share as f32);
    let passes = transparent.iter().all(|share| *share > 0.0);
    passes.then(|| FieldValue::numbers(transparent.map(|share| f64::from(absorption_of(share)))))
}

/// The absorption per unit length that leaves the share `t` after one unit.
pub fn absorption_of(t: f32) -> f32 {
    if t <= 0.0 { OPAQUE } else { (-fmath::ln(t)).max(0.0) }
}

fn draft<'t>(compiler: &mut Compiler<'_>, item: Item<'t>) -> Option<Draft<'t>> {
    let (phong, veins, extras) = compiler.read_keys(item, |params, sources| {
        params.name();
        let phong = read(params, sources);
        let veins = params.block(VEINS.keyword);
        let extras = Extras::read(params, sources);
        Some((phong?, veins, extras?))
    })?;
    let span = item.head_span();
    let id = match veins {
        None => compiler.store_material(phong, span),
        Some(item) => compiler.veined(item, &phong),
    };
    Some(Draft::Stored(id, extras, span))
}

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<PhongMaterial> {
    let reflects_specular = sources.rules.reflects_specular;
    let keys = PhongKeys::read(params, sources)?;
    let PhongKeys { mut diffuse, specular, .. } = keys;
    let plain = |rgb: Spectrum| Textured::from(Written { rgb, value: Reflectance::from_rgb(rgb.to_rgb()) });
    let picture = keys.texture.map(|ColorPicture(picture)| picture);
    if picture.is_some() {
        if diffuse.texture.is_some() {
            params.refuse("texture", "beside a `diffuseColor` that is a texture");
        }
        let color =
            if sources.rules.texture_is_diffuse { plain(Spectrum::rgb(1.0, 1.0, 1.0)) } else { diffuse };
        diffuse = Textured { texture: picture.clone(), ..color };
    }
    let otherwise = |is_specular| if is_specular { specular.clone() } else { plain(Spectrum::BLACK) };
    let reflective = keys.reflective.unwrap_or_else(|| otherwise(reflects_specular));
    // In the programs that have this word a material with an index lets light through.
    let index = keys.refraction_index.filter(|&eta| eta > 0.0);
    let clear = index.is_some() && reflects_specular;
    let transparent = keys.transparent.unwrap_or_else(|| otherwise(clear));
    let ambient = match keys.ambient {
        Some(Textured { value, texture }) => Textured { value: value.into(), texture: texture.or(picture) },
        None => Textured { value: diffuse.value.rgb, texture: diffuse.texture.clone() },
    };
    let absorption = keys.absorption.map_or_else(|| transparent.value.rgb.map(absorption_of), Spectrum::from);
    let exponent = keys.shininess.or(keys.exponent);
    let eta = match keys.index {
        Given { value, item: None } => index.unwrap_or(value),
        Given { value, .. } => value,
    };
    let phong = Phong {
        ambient: ambient.value,
        diffuse: diffuse.value.rgb,
        specular: specular.value.rgb,
        exponent: match exponent {
            Some(FloatTexture::Constant(exponent)) => exponent,
            _ => default_exponent(&sources.rules),
        },
        reflective: reflective.value.rgb,
        transparent: transparent.value.rgb,
        absorption,
        eta,
    };
    let colors = [&diffuse, &specular, &reflective, &transparent].map(|color| color.value.value.clone());
    let textures = PhongTextures {
        ambient: ambient.texture,
        diffuse: diffuse.texture,
        specular: specular.texture,
        reflective: reflective.texture,
        transparent: transparent.texture,
        exponent: exponent.filter(|exponent| exponent.varies()),
    };
    Some(PhongMaterial::new(phong, colors).with_textures(textures))
}

impl Compiler<'_> {
    /// A material whose diffuse colour goes from one to another in veins: a `Noise` block within it.
    fn veined(&mut self, item: Item<'_>, phong: &PhongMaterial) -> Option<crate::material::MaterialId> {
        let (colors, veins) = self.read_keys(item, |params, sources| {
            let colors = params.take(&[VEIN_COLOR.key]);
            Some((colors, VeinKeys::read(params, sources)?))
        })?;
        if let Some(third) = colors.get(2) {
            let error = Diagnostic::error("veins go from one `color` to another, and there is a third");
            self.diagnostics.push(error.label(third.head_span(), "one too many"));
        }
        let mut color = |i: usize, default| {
            let read = colors.get(i).and_then(|&item| Args::read(item, self.diagnostics, Args::vec3));
            phong.with_diffuse(read.unwrap_or(default).into())
        };
        let parts = [color(0, Vec3::ZERO), color(1, Vec3::ONE)];
        let VeinKeys { octaves, frequency, amplitude } = veins;
        let amount = self.scene.float_texture(Marble { octaves, frequency, amplitude });
        let span = item.head_span();
        let amount = self.accepted(amount, span)?;
        let [first, second] = parts.map(|part| self.store_material(part, span));
        let blend = Blend { amount, materials: [first?, second?] };
        self.store_material(blend, span)
    }
}
