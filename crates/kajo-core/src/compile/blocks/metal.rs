//! `Metal`: polished, rough or brushed.

use kajo_color::{metal, named};
use kajo_scene::{Args, Diagnostic, Params, nearest};

use crate::bsdf::microfacet::NormalDistribution;
use crate::compile::extras::ExtraKeys;
use crate::compile::fields::{
    Defaulted, Keys, Plain, Sources, Typed, choice, choices, color_texture, keys, share,
};
use crate::compile::member::{MaterialMember, Member};
use crate::material::{Grain, Metal, Substance};
use crate::schema::{Block, FieldKind, FieldSpec, Kind};
use crate::texture::{ColorTexture, FloatTexture};

choices! {
    NormalDistribution {
        "beckmann" => NormalDistribution::Beckmann,
        "ggx" => NormalDistribution::Ggx,
    }
}

/// The distribution of the facets of a rough surface.
pub const DISTRIBUTION: Defaulted<NormalDistribution> =
    choice::<NormalDistribution>("distribution").or_word("ggx", "how the facets of a rough surface lie");
/// The strength of a grain.
pub const ANISOTROPY: Defaulted<FloatTexture> =
    share("anisotropy").or(0.0, "how far the highlight of a brushed surface is drawn out");
/// The direction of a grain.
pub const ROTATION: Defaulted<FloatTexture> =
    share("rotation").unit("turns").or(0.0, "by how many full turns the brushing is turned");

/// A metal of the list of measured ones.
struct Measured(metal::MeasuredMetal);

keys! {
    MetalKeys {
        metal: Option<Measured> = Typed::<Measured>::new("metal", FieldKind::Text)
            .unlike("by `color`", "", "a measured metal, such as gold"),
        color: ColorTexture = color_texture("color").or([0.9; 3], "its colour, where no metal is named"),
        distribution: NormalDistribution = DISTRIBUTION,
        roughness: FloatTexture = share("roughness").or(0.0, "0 is a mirror"),
        anisotropy: FloatTexture = ANISOTROPY,
        rotation: FloatTexture = ROTATION,
    }
}

pub const MEMBER: MaterialMember = Member {
    block: Block {
        keyword: "Metal",
        kind: Kind::Material,
        about: "polished, rough or brushed metal",
        groups: &[MetalKeys::FIELDS, ExtraKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item| compiler.pooled(item, read),
};

fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<Metal> {
    let MetalKeys { metal, color, distribution, roughness, anisotropy, rotation } =
        MetalKeys::read(params, sources)?;
    if metal.is_some() {
        params.idle(&["color"], "beside `metal`");
    }
    let substance = metal.map_or(Substance::Color(color), |Measured(metal)| Substance::Measured(metal));
    Some(Metal::new(substance, distribution, roughness).brushed(Grain { anisotropy, rotation }))
}

impl Plain<'_> for Measured {
    fn parse(_: &FieldSpec, args: &mut Args<'_>, _: &mut Sources<'_>) -> Result<Measured, Diagnostic> {
        by_name(args, named::metal, named::METALS.into_iter()).map(Measured)
    }
}

/// What a list of names has under the word of `args`, or an error with the nearest name.
pub fn by_name<T>(
    args: &mut Args<'_>,
    find: fn(&str) -> Option<T>,
    names: impl Iterator<Item = &'static str> + Clone,
) -> Result<T, Diagnostic> {
    let name = args.text()?;
    find(&name).ok_or_else(|| {
        let known = names.clone().collect::<Vec<_>>().join(", ");
        let near = nearest(&name, names).map(|near| format!("did you mean `{near}`?"));
        args.error(format!("there is no `{name}` here; known are {known}")).maybe_help(near)
    })
}
