//! The materials `Glass`, `Matte`, `Metal` and `Principled`.

use kajo_color::{dispersion::Dispersion, named};
use kajo_math::Vec3;
use kajo_scene::{Args, Diagnostic, Params, nearest};

use super::pictures::PaintReader;
use crate::bsdf::microfacet::Shape;
use crate::family::Pooled;
use crate::material::{
    Glass, GlassSettings, Grain, LayeredMaterial, Layers, MaterialId, Materials, Matte, Metal, Specular,
    Substance,
};

/// The words of these materials.
pub(super) const PHYSICAL: [&str; 4] = ["Glass", "Matte", "Metal", "Principled"];

/// A material that scatters as physics has it.
pub(super) enum Physical {
    Glass(Glass),
    Matte(Matte),
    Metal(Metal),
    Layered(Box<LayeredMaterial>),
}

impl Physical {
    /// Reads the block that the keyword began, all but what every material has.
    pub(super) fn read(
        keyword: &str,
        params: &mut Params<'_, '_>,
        paints: &mut PaintReader<'_>,
    ) -> Option<Physical> {
        params.name();
        match keyword {
            "Glass" => glass(params, paints).map(|settings| Physical::Glass(settings.into())),
            "Matte" => {
                let color = paints.paint(params, "color", 0.8);
                Some(Physical::Matte(Matte::new(color, paints.share(params, "roughness", 0.0))))
            }
            "Metal" => metal(params, paints).map(Physical::Metal),
            _ => Some(Physical::Layered(Box::new(layers(params, paints).into()))),
        }
    }

    pub(super) fn store(&self, materials: &mut Materials) -> Option<MaterialId> {
        match self {
            Physical::Glass(glass) => glass.clone().store(materials),
            Physical::Matte(matte) => matte.clone().store(materials),
            Physical::Metal(metal) => metal.clone().store(materials),
            Physical::Layered(layered) => LayeredMaterial::clone(layered).store(materials),
        }
    }
}

fn shape(params: &mut Params<'_, '_>) -> Shape {
    params.or("distribution", Shape::Ggx, |args| {
        args.choice(&[("beckmann", Shape::Beckmann), ("ggx", Shape::Ggx)])
    })
}

fn grain(params: &mut Params<'_, '_>, paints: &mut PaintReader<'_>) -> Grain {
    let anisotropy = paints.share(params, "anisotropy", 0.0);
    Grain { anisotropy, rotation: paints.share(params, "rotation", 0.0) }
}

/// What a list of names has under the word of `args`, or an error with the nearest name.
fn by_name<T>(
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

fn metal(params: &mut Params<'_, '_>, paints: &mut PaintReader<'_>) -> Option<Metal> {
    let measured = params.optional("metal", |args| by_name(args, named::metal, named::METALS.into_iter()));
    let color = paints.paint(params, "color", 0.9);
    if measured.is_some() {
        params.idle(&["color"], "beside `metal`");
    }
    let substance = measured.map_or(Substance::Color(color), Substance::Measured);
    let (shape, roughness) = (shape(params), paints.share(params, "roughness", 0.0));
    Some(Metal::new(substance, shape, roughness).brushed(grain(params, paints)))
}

fn glass(params: &mut Params<'_, '_>, paints: &mut PaintReader<'_>) -> Option<GlassSettings> {
    let named = params.optional("glass", |args| {
        by_name(args, named::glass, named::glasses().collect::<Vec<_>>().into_iter())
    });
    let index = params.or("indexOfRefraction", 1.5, |args| args.number_in(1.0..=4.0));
    let abbe = params.optional("abbeNumber", Args::positive);
    let plain = match abbe {
        Some(abbe) => Dispersion::from_abbe(f64::from(index), f64::from(abbe)),
        None => Dispersion::Constant(f64::from(index)),
    };
    let absorption = absorption(params);
    let thickness = params.optional("thickness", |args| args.number_in(0.0..));
    let thin = params.or("thin", thickness.is_some(), Args::flag);
    if named.is_some() {
        params.idle(&["indexOfRefraction", "abbeNumber"], "beside `glass`");
    }
    if !thin {
        params.idle(&["thickness"], "with `thin off`");
    }
    Some(GlassSettings {
        index: named.unwrap_or(plain),
        shape: shape(params),
        roughness: paints.share(params, "roughness", 0.0),
        grain: grain(params, paints),
        absorption,
        pane: thin.then(|| thickness.unwrap_or(0.0)),
        priority: params.or("priority", 0, |args| args.int_in(-1000..=1000)) as i32,
    })
}

/// Absorption per unit length.
fn absorption(params: &mut Params<'_, '_>) -> [f32; 3] {
    let read = params.or("absorption", Vec3::ZERO, |args| {
        let absorption = args.vec3()?;
        if absorption.min_element() < 0.0 {
            Err(args.error("absorption is not negative"))
        } else {
            Ok(absorption)
        }
    });
    read.to_array()
}

fn layers(params: &mut Params<'_, '_>, paints: &mut PaintReader<'_>) -> Layers {
    let index =
        |params: &mut Params<'_, '_>, key, default| params.or(key, default, |args| args.number_in(1.0..=4.0));
    let thin = params.or("thin", false, Args::flag);
    if !params.has("transmission") {
        params.idle(&["absorption", "priority", "thin"], "without `transmission`");
    } else if thin {
        params.idle(&["absorption", "priority"], "with `thin on`: a pane has no inside");
    }
    Layers {
        color: paints.paint(params, "color", 0.8),
        specular: Specular::Factor(paints.paint(params, "specularColor", 1.0)),
        metalness: paints.share(params, "metalness", 0.0),
        transmission: paints.share(params, "transmission", 0.0),
        absorption: absorption(params),
        thin,
        roughness: paints.share(params, "roughness", 0.3),
        grain: grain(params, paints),
        diffuse_roughness: paints.share(params, "diffuseRoughness", 0.0),
        eta: index(params, "indexOfRefraction", 1.5),
        dispersion: None,
        coat: paints.share(params, "coat", 0.0),
        coat_color: paints.paint(params, "coatColor", 1.0),
        coat_roughness: paints.share(params, "coatRoughness", 0.0),
        coat_eta: index(params, "coatIndexOfRefraction", 1.6),
        fuzz: paints.share(params, "fuzz", 0.0),
        fuzz_color: paints.paint(params, "fuzzColor", 1.0),
        fuzz_roughness: paints.share(params, "fuzzRoughness", 0.5),
        priority: params.or("priority", 0, |args| args.int_in(-1000..=1000)) as i32,
    }
}
