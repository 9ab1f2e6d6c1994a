//! What any material of its own may have besides: light, holes, dents.

use kajo_scene::{Diagnostic, Params, Span};

use super::fields::{At, HEIGHTS, Keys, NORMALS, Sources, Typed, choice, choices, keys, light_group};
use super::picture_values::{HeightMap, NormalMap, Opacity, SurfaceLight, opacity, surface_light};
use crate::emission::SurfaceEmission;
use crate::ids::LightGroup;
use crate::light::Sides;
use crate::material::Relief;
use crate::schema::{Constant, FieldKind};
use crate::texture::FloatTexture;

choices! {
    Sides {
        "back" => Sides::Back,
        "both" => Sides::Both,
        "front" => Sides::Front,
    }
}

keys! {
    ExtraKeys<'t> {
        emission: Option<SurfaceLight> = surface_light("emission")
            .unit("W/(m² sr)")
            .presumed(Constant::Triple([0.0; 3]), "light that it gives itself"),
        emits: Option<At<'t, Sides>> = choice::<Sides>("emits")
            .only_beside("emission")
            .placed()
            .presumed(Constant::Word("both"), "the side that gives light"),
        group: Option<At<'t, LightGroup>> = light_group("group")
            .only_beside("emission")
            .placed()
            .option("name of the lights it is seen among"),
        opacity: Option<Opacity> = opacity("opacity")
            .presumed(Constant::Number(1.0), "the share of it that is there, between holes"),
        normals: Option<NormalMap> = Typed::<NormalMap>::new("normalMap", FieldKind::Picture)
            .textured(&NORMALS)
            .option("a picture of normals that dents it, such as hammered.png"),
        heights: Option<HeightMap> = Typed::<HeightMap>::new("bump", FieldKind::Picture)
            .textured(&HEIGHTS)
            .option("a picture or a function of heights that dents it, such as bricks.png"),
    }
}

/// What any material of its own may have besides.
pub(super) struct Extras {
    pub emission: SurfaceEmission,
    /// Less than 1 for a material with holes, and where that is said.
    pub opacity: Option<(FloatTexture, Span)>,
    pub relief: Option<Relief>,
}

impl Extras {
    pub fn read(params: &mut Params<'_, '_>, sources: &mut Sources<'_>) -> Option<Extras> {
        let ExtraKeys { emission, emits, group, opacity, normals, heights } =
            ExtraKeys::read(params, sources)?;
        let [of_sides, of_group] = [emits.as_ref().map(|at| at.item), group.as_ref().map(|at| at.item)];
        for item in [of_sides, of_group].into_iter().flatten().filter(|_| emission.is_none()) {
            let message = format!("`{}` says nothing without an `emission`", item.keyword());
            params.diagnostics().push(Diagnostic::warning(message).label(item.head_span(), "has no effect"));
        }
        let emission = emission.map(|SurfaceLight { light, slide }| {
            let sides = emits.map_or(Sides::Both, |at| at.value);
            let group = group.map(|at| at.value).unwrap_or_default();
            let even = SurfaceEmission::from(light);
            slide.iter().fold(even, SurfaceEmission::through).on(sides).in_group(group)
        });
        let relief = match (normals, heights) {
            (Some(NormalMap { normals, scale }), _) => Some(Relief::Normals { normals, scale: scale.into() }),
            (None, Some(HeightMap { heights, height })) => Some(Relief::Heights { heights, height }),
            (None, None) => None,
        };
        let emission = emission.unwrap_or_default();
        let opacity = opacity.map(|opacity| (opacity.share, opacity.span));
        Some(Extras { emission, opacity, relief })
    }
}
