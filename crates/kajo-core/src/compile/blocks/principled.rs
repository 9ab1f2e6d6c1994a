//! `Principled`: fuzz over a coat over a mixture of a base, metal and glass, in the terms of OpenPBR.

use kajo_color::Reflectance;
use kajo_scene::{Diagnostic, Params};

use super::glass::{MEDIUM, PRIORITY};
use super::medium::FreePath;
use super::metal::{ANISOTROPY, ROTATION};
use crate::compile::extras::ExtraKeys;
use crate::compile::fields::{
    Absorption, Inside, Keys, Sources, Typed, absorption, between, color_texture, flag, float_texture, keys,
    positive, share,
};
use crate::compile::member::{MaterialMember, Member};
use crate::material::{Grain, LayeredMaterial, Layers, SpecularLayer, SubsurfaceBody};
use crate::medium::phase::HenyeyGreenstein;
use crate::medium::{Coefficients, HomogeneousMedium, Phase};
use crate::schema::{Block, Constant, FieldKind, Kind, NumberRange};
use crate::texture::{ColorTexture, FloatTexture};

const SUBSURFACE: &str = "subsurface";

keys! {
    PrincipledKeys {
        color: ColorTexture = color_texture("color").or([0.8; 3], "its colour"),
        metalness: FloatTexture = share("metalness").or(0.0, "from plastic to metal"),
        roughness: FloatTexture = share("roughness").or(0.3, "of the highlight"),
        anisotropy: FloatTexture = ANISOTROPY,
        rotation: FloatTexture = ROTATION,
        specular_color: ColorTexture = color_texture("specularColor").or([1.0; 3], "tints the highlight"),
        index: FloatTexture = float_texture("indexOfRefraction", 1.0, 4.0).or(1.5, "strength of the highlight"),
        transmission: FloatTexture = share("transmission").or(0.0, "from plastic to glass"),
        absorption: Absorption =
            absorption("absorption").unit("1/length").or([0.0; 3], "of the glass, per length inside"),
        thin: bool = flag("thin").or(false, "its glass is a pane"),
        diffuse_roughness: FloatTexture = share("diffuseRoughness").or(0.0, "0 is as paper, 1 as plaster"),
        coat: FloatTexture = share("coat").or(0.0, "share of a clear coat"),
        coat_color: ColorTexture = color_texture("coatColor").or([1.0; 3], "tint of the coat"),
        coat_roughness: FloatTexture = share("coatRoughness").or(0.0, "of the coat"),
        coat_index: FloatTexture = float_texture("coatIndexOfRefraction", 1.0, 4.0).or(1.6, "of the coat"),
        fuzz: FloatTexture = share("fuzz").or(0.0, "share of fuzz, as of velvet"),
        fuzz_color: ColorTexture = color_texture("fuzzColor").or([1.0; 3], "colour of the fuzz"),
        fuzz_roughness: FloatTexture = share("fuzzRoughness").or(0.5, "of the fuzz"),
        subsurface: FloatTexture = share("subsurface").or(0.0, "from plastic to wax, skin and marble"),
        subsurface_radius: Option<FreePath> = Typed::<FreePath>::new("subsurfaceRadius", FieldKind::Color(NumberRange::POSITIVE))
            .unit("length")
            .only_beside(SUBSURFACE)
            .presumed(Constant::Triple([1.0, 0.2, 0.1]), "how far light goes inside between collisions"),
        subsurface_scale: f32 = positive("subsurfaceScale")
            .only_beside(SUBSURFACE)
            .or(0.05, "a factor of `subsurfaceRadius`"),
        subsurface_anisotropy: f32 = between("subsurfaceAnisotropy", -0.99, 0.99)
            .only_beside(SUBSURFACE)
            .or(0.0, "mean cosine inside: 0 to all sides, 0.8 as in skin"),
        medium: Option<Inside> = MEDIUM,
        priority: i32 = PRIORITY,
    }
}

pub const MEMBER: MaterialMember = Member {
    block: Block {
        keyword: "Principled",
        kind: Kind::Material,
        about: "one material for most things: fuzz over a coat over a base, metal and glass",
        groups: &[PrincipledKeys::FIELDS, ExtraKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item| {
        compiler.pooled_from(item, read, |compiler, (layers, body)| {
            let Some(body) = body else { return Some(layers.into()) };
            let stored = compiler.scene.medium(HomogeneousMedium { coefficients: body.coefficients });
            let medium = compiler.accepted(stored, item.head_span())?;
            let SubsurfaceText { share, is_tinted, .. } = body;
            let subsurface = Some(SubsurfaceBody { share, medium, is_tinted });
            Some(LayeredMaterial::from(Layers { subsurface, ..layers }))
        })
    },
};

/// A body below the surface, before its medium is stored.
struct SubsurfaceText {
    share: FloatTexture,
    is_tinted: bool,
    coefficients: Coefficients,
}

/// What is below the surface, where light enters it; `Err` of what was reported.
fn body(keys: &PrincipledKeys, params: &mut Params<'_, '_>) -> Result<Option<SubsurfaceText>, ()> {
    let share = keys.subsurface;
    if share.share_range()[1] <= 0.0 {
        let keys = ["subsurfaceRadius", "subsurfaceScale", "subsurfaceAnisotropy"];
        params.idle(&keys, "without `subsurface`");
        return Ok(None);
    }
    if keys.metalness.share_range()[0] >= 1.0 {
        let keys = [SUBSURFACE, "subsurfaceRadius", "subsurfaceScale", "subsurfaceAnisotropy"];
        params.idle(&keys, "with `metalness 1`: light does not enter metal");
        return Ok(None);
    }
    if keys.transmission.share_range()[1] > 0.0 {
        params.refuse("transmission", "beside `subsurface`: a body has one inside");
        return Err(());
    }
    params.idle(&["diffuseRoughness"], "beside `subsurface`");
    let FreePath(radius) = keys.subsurface_radius.unwrap_or(FreePath([1.0, 0.2, 0.1]));
    let radius = radius.map(|r| r * keys.subsurface_scale);
    let white = Reflectance::constant(1.0);
    let (color, is_tinted) = match &keys.color {
        ColorTexture::Constant(color) => (color, false),
        ColorTexture::Node(_) => (&white, true),
    };
    let phase = match keys.subsurface_anisotropy {
        0.0 => Phase::Isotropic,
        g => HenyeyGreenstein::new(g).map_or(Phase::Isotropic, Phase::HenyeyGreenstein),
    };
    match Coefficients::subsurface(color, radius, phase) {
        Ok(coefficients) => Ok(Some(SubsurfaceText { share, is_tinted, coefficients })),
        Err(_) => {
            let error = Diagnostic::error("`subsurfaceRadius` times `subsurfaceScale` is out of range");
            params.report(error, "light would collide at every point, or never");
            Err(())
        }
    }
}

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<(Layers, Option<SubsurfaceText>)> {
    let keys = PrincipledKeys::read(params, sources)?;
    let body = body(&keys, params).ok()?;
    if body.is_some() {
        params.idle(&["absorption", "medium", "thin"], "beside `subsurface`");
    } else if !params.contains("transmission") {
        params.idle(&["absorption", "medium", "priority", "thin"], "without `transmission`");
    } else if keys.thin {
        params.idle(&["absorption", "medium", "priority"], "with `thin on`: a pane has no inside");
    } else if keys.index.varies() {
        params.refuse(
            "indexOfRefraction",
            "as a texture beside `transmission`: the inside of a body has one index",
        );
    }
    let layers = Layers {
        color: keys.color,
        specular: SpecularLayer::Factor(keys.specular_color),
        metalness: keys.metalness,
        transmission: keys.transmission,
        absorption: keys.absorption.0,
        thin: keys.thin,
        roughness: keys.roughness,
        grain: Grain { anisotropy: keys.anisotropy, rotation: keys.rotation },
        diffuse_roughness: keys.diffuse_roughness,
        eta: keys.index,
        dispersion: None,
        coat: keys.coat,
        coat_color: keys.coat_color,
        coat_roughness: keys.coat_roughness,
        coat_eta: keys.coat_index,
        fuzz: keys.fuzz,
        fuzz_color: keys.fuzz_color,
        fuzz_roughness: keys.fuzz_roughness,
        priority: keys.priority,
        medium: keys.medium.map(|Inside(medium)| medium),
        subsurface: None,
    };
    Some((layers, body))
}
