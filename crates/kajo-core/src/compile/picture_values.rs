//! Values of materials that pictures may say: holes, normals, heights and light.

use kajo_color::Emission;
use kajo_scene::{Args, Diagnostics, Item, Params, Span};

use super::fields::{Sources, Typed, Value};
use super::pictures::{is_picture, name_with, read_channel};
use super::spectra::factor;
use crate::schema::{FieldKind, FieldSpec};
use crate::texture::{ColorTexture, Encoding, Expression, FloatTexture, PictureChannel, PictureCut};

/// The share of a surface that is there, or a texture of it.
pub(super) const fn opacity(key: &'static str) -> Typed<Opacity> {
    Typed::new(key, FieldKind::SHARE).textured()
}

/// The light of a surface, or a texture that light shines through.
pub(super) const fn surface_light(key: &'static str) -> Typed<SurfaceLight> {
    Typed::new(key, FieldKind::Emission).textured()
}

/// The share of a surface that is there, and where that is said.
pub(super) struct Opacity {
    pub share: FloatTexture,
    pub place: Span,
}

impl Value<'_> for Opacity {
    fn read(
        spec: &FieldSpec,
        item: Item<'_>,
        diagnostics: &mut Diagnostics,
        sources: &mut Sources<'_>,
    ) -> Option<Opacity> {
        let read = |params: &mut Params<'_, '_>| {
            (read_channel(params), params.optional("cutoff", |args| args.number_in(0.0..=1.0)))
        };
        let node = |map, (channel, cutoff)| match cutoff {
            None => PictureChannel { map, channel }.into(),
            Some(least) => PictureCut { map, channel, least }.into(),
        };
        let share = sources.textures.float_of(spec, item, diagnostics, read, node);
        share.map(|share| Opacity { share, place: item.head_span() })
    }
}

/// A picture of normals.
pub(super) struct NormalMap {
    pub normals: ColorTexture,
    /// How steep they are made.
    pub scale: f32,
}

impl Value<'_> for NormalMap {
    fn read(
        _: &FieldSpec,
        item: Item<'_>,
        diagnostics: &mut Diagnostics,
        sources: &mut Sources<'_>,
    ) -> Option<NormalMap> {
        let scale = |params: &mut Params<'_, '_>| Scale(params.or("scale", 1.0, Args::number));
        let (map, Scale(scale)) =
            sources.textures.pictures.map(item, Some(Encoding::Linear), diagnostics, scale)?;
        Some(NormalMap { normals: sources.textures.nodes.color(map)?, scale })
    }
}

/// A picture or a named texture of heights, or a function of the place.
pub(super) struct HeightMap {
    pub heights: FloatTexture,
    /// How far white rises above black.
    pub height: f32,
}

impl Value<'_> for HeightMap {
    fn read(
        _: &FieldSpec,
        item: Item<'_>,
        diagnostics: &mut Diagnostics,
        sources: &mut Sources<'_>,
    ) -> Option<HeightMap> {
        if item.function().is_some() {
            let function = Args::read(item, diagnostics, Args::function)?;
            let bounds = [f32::MIN, f32::MAX];
            let heights = sources.textures.nodes.float(Expression { function, bounds })?;
            return Some(HeightMap { heights, height: 1.0 });
        }
        if let Some(named) = sources.textures.named(item, diagnostics, |_| false) {
            let height = name_with(item, diagnostics, |params| params.optional("height", Args::number))?;
            let heights = named?.number(sources.textures.nodes)?;
            return Some(HeightMap { heights, height: height.unwrap_or(Height::default().0) });
        }
        let read = |params: &mut Params<'_, '_>| {
            (Height(params.or("height", Height::default().0, Args::number)), read_channel(params))
        };
        let (map, (Height(height), channel)) =
            sources.textures.pictures.map(item, Some(Encoding::Linear), diagnostics, read)?;
        let heights = sources.textures.nodes.float(PictureChannel { map, channel })?;
        Some(HeightMap { heights, height })
    }
}

/// The light of a surface, and the picture that it shines through like a slide, if there is one.
pub(super) struct SurfaceLight {
    pub light: Emission,
    pub slide: Option<ColorTexture>,
}

impl Value<'_> for SurfaceLight {
    fn read(
        _: &FieldSpec,
        item: Item<'_>,
        diagnostics: &mut Diagnostics,
        sources: &mut Sources<'_>,
    ) -> Option<SurfaceLight> {
        let spectra = sources.textures.spectra;
        let light = |params: &mut Params<'_, '_>| params.optional("light", |args| spectra.emission(args));
        let name = |args: &mut Args<'_>| Ok((args.text()?.into_owned(), factor(args)?));
        // Other words are lights.
        if let Some(named) = sources.textures.named(item, diagnostics, |_| true) {
            let (factor, light) = if item.has_block() {
                let mut params = Params::new(item, diagnostics);
                let (own, light) = (params.own(name), light(&mut params));
                params.finish();
                (own?.1, light)
            } else {
                (Args::read(item, diagnostics, name)?.1, None)
            };
            let slide = named?.color(sources.textures.nodes)?;
            let light = light.unwrap_or_else(|| Emission::from_rgb([1.0; 3])).scaled(factor);
            return Some(SurfaceLight { light, slide: Some(slide) });
        }
        if !is_picture(item) {
            let light = Args::read(item, diagnostics, |args| spectra.emission(args))?;
            return Some(SurfaceLight { light, slide: None });
        }
        let ((map, factor), light) =
            sources.textures.pictures.map_and(item, None, diagnostics, name, light)?;
        let light = light.unwrap_or_else(|| Emission::from_rgb([1.0; 3])).scaled(factor);
        Some(SurfaceLight { light, slide: Some(sources.textures.nodes.color(map)?) })
    }
}

/// The colours of a picture.
pub(super) struct ColorPicture(pub ColorTexture);

impl Value<'_> for ColorPicture {
    fn read(
        _: &FieldSpec,
        item: Item<'_>,
        diagnostics: &mut Diagnostics,
        sources: &mut Sources<'_>,
    ) -> Option<ColorPicture> {
        let (map, ()) = sources.textures.pictures.map(item, None, diagnostics, |_| ())?;
        sources.textures.nodes.color(map).map(ColorPicture)
    }
}

/// How steep a picture of normals is made.
struct Scale(f32);

impl Default for Scale {
    fn default() -> Scale {
        Scale(1.0)
    }
}

/// How far white rises above black.
struct Height(f32);

impl Default for Height {
    fn default() -> Height {
        Height(0.01)
    }
}
