//! `Glass`: a clear or frosted body, or a pane.

use kajo_color::{Dispersion, named};
use kajo_scene::{Args, Diagnostic, Params};

use super::metal::{ANISOTROPY, DISTRIBUTION, ROTATION, by_name};
use crate::bsdf::microfacet::NormalDistribution;
use crate::compile::extras::ExtraKeys;
use crate::compile::fields::{
    Absorption, Defaulted, Inside, Keys, Optional, Plain, Sources, Typed, absorption, between, flag,
    float_texture, inside, keys, positive, share, whole,
};
use crate::compile::member::{MaterialMember, Member};
use crate::material::{Glass, GlassSettings, Grain};
use crate::schema::{Around, Block, FieldKind, FieldSpec, FieldValue, Kind};
use crate::texture::FloatTexture;

/// Which of several bodies counts.
pub const PRIORITY: Defaulted<i32> =
    whole("priority", -1000, 1000).or(0, "of bodies that overlap, the one with the highest counts");

/// What a body is filled with.
pub const MEDIUM: Optional<Inside> = inside("medium").option("name of the medium that scatters light inside");

/// A glass of the list of measured ones.
struct Measured(Dispersion);

keys! {
    GlassKeys {
        glass: Option<Measured> = Typed::<Measured>::new("glass", FieldKind::Text)
            .unlike("by `indexOfRefraction`", "", "a measured glass, such as N-BK7"),
        index: f32 = between("indexOfRefraction", 1.0, 4.0).or(1.5, "how strongly it bends light"),
        abbe_number: Option<f32> =
            positive("abbeNumber").unlike("all colours alike", "60", "how little it splits colours"),
        absorption: Absorption =
            absorption("absorption").unit("1/length").or([0.0; 3], "per length inside"),
        thickness: Option<FloatTexture> =
            float_texture("thickness", 0.0, f64::MAX).unit("length").unlike("a solid body", "0.01", "of a pane"),
        thin: Option<bool> =
            flag("thin").ruled(thin, "on with a `thickness`", "a pane, whose surface stands for both its sides"),
        distribution: NormalDistribution = DISTRIBUTION,
        roughness: FloatTexture = share("roughness").or(0.0, "0 is clear, more is frosted"),
        anisotropy: FloatTexture = ANISOTROPY,
        rotation: FloatTexture = ROTATION,
        medium: Option<Inside> = MEDIUM,
        priority: i32 = PRIORITY,
    }
}

pub const MEMBER: MaterialMember = Member {
    block: Block {
        keyword: "Glass",
        kind: Kind::Material,
        about: "a clear or frosted body, or a pane",
        groups: &[GlassKeys::FIELDS, ExtraKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item| compiler.pooled(item, read),
};

/// Only panes have a thickness.
fn thin(around: &Around<'_>) -> Option<FieldValue> {
    Some(FieldValue::flag((around.is_written)("thickness")))
}

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<Glass> {
    let keys = GlassKeys::read(params, sources)?;
    let index = f64::from(keys.index);
    let plain = match keys.abbe_number {
        Some(abbe) => Dispersion::from_abbe(index, f64::from(abbe)),
        None => Dispersion::Constant(index),
    };
    let thin = keys.thin.unwrap_or(keys.thickness.is_some());
    if keys.glass.is_some() {
        params.idle(&["indexOfRefraction", "abbeNumber"], "beside `glass`");
    }
    if !thin {
        params.idle(&["thickness"], "with `thin off`");
    } else {
        params.idle(&["medium"], "of a pane, which has no inside");
    }
    let settings = GlassSettings {
        index: keys.glass.map_or(plain, |Measured(dispersion)| dispersion),
        shape: keys.distribution,
        roughness: keys.roughness,
        grain: Grain { anisotropy: keys.anisotropy, rotation: keys.rotation },
        absorption: keys.absorption.0,
        pane: thin.then(|| keys.thickness.unwrap_or(0.0.into())),
        priority: keys.priority,
        medium: keys.medium.map(|Inside(medium)| medium),
    };
    Some(settings.into())
}

impl Plain<'_> for Measured {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<Measured, Diagnostic> {
        by_name(args, named::glass, named::glasses().collect::<Vec<_>>().into_iter()).map(Measured)
    }
}
