//! `Principled`: fuzz over a coat over a mixture of a base, metal and glass, in the terms of OpenPBR.

use kajo_scene::Params;

use super::glass::{MEDIUM, PRIORITY};
use super::metal::{ANISOTROPY, ROTATION};
use crate::compile::extras::ExtraKeys;
use crate::compile::fields::{
    Absorption, Inside, Keys, Sources, absorption, color_texture, flag, float_texture, keys, share,
};
use crate::compile::member::{MaterialMember, Member};
use crate::material::{Grain, LayeredMaterial, Layers, Specular};
use crate::schema::{Block, Kind};
use crate::texture::{ColorTexture, FloatTexture};

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
    },
    read: |compiler, item| compiler.pooled(item, read),
};

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<LayeredMaterial> {
    let keys = PrincipledKeys::read(params, sources)?;
    if !params.contains("transmission") {
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
        specular: Specular::Factor(keys.specular_color),
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
    };
    Some(layers.into())
}
