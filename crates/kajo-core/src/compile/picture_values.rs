//! Values of materials that pictures may say: holes, normals, heights and light.

use kajo_color::Emission;
use kajo_scene::{Args, Diagnostics, Item, Params, Span};

use super::fields::{
    ChannelKeys, CutoffKeys, HOLES, HeightKeys, Keys, NormalKeys, SLIDE, SlideKeys, Sources, Typed, Value,
    is_picture, name_with,
};
use super::spectra::factor;
use crate::schema::{FieldKind, FieldSpec};
use crate::texture::{ColorTexture, Encoding, Expression, FloatTexture, Grey, PictureChannel, PictureCut};

/// The share of a surface that is there, or a texture of it.
pub(super) const fn opacity(key: &'static str) -> Typed<Opacity> {
    Typed::new(key, FieldKind::SHARE).textured(&HOLES)
}

/// The light of a surface, or a texture that light shines through.
pub(super) const fn surface_light(key: &'static str) -> Typed<SurfaceLight> {
    Typed::new(key, FieldKind::Emission).textured(&SLIDE)
}

/// The share of a surface that is there, and where that is said.
pub(super) struct Opacity {
    pub share: FloatTexture,
    pub span: Span,
}

impl Value<'_> for Opacity {
    fn read(
        spec: &FieldSpec,
        item: Item<'_>,
        diagnostics: &mut Diagnostics,
        sources: &mut Sources<'_>,
    ) -> Option<Opacity> {
        let node = |(map, channel), CutoffKeys { cutoff }| match cutoff {
            None => PictureChannel { map, channel }.into(),
            Some(least) => PictureCut { map, channel, least }.into(),
        };
        let share = sources.float_of(spec, item, diagnostics, CutoffKeys::read, node);
        share.map(|share| Opacity { share, span: item.head_span() })
    }
}

/// A picture or a named texture of normals.
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
        if let Some(named) = sources.named_texture(item, diagnostics, is_file) {
            let NormalKeys { scale } =
                name_with(item, diagnostics, |params| NormalKeys::read(params, sources))?;
            return Some(NormalMap { normals: named?.color(sources.textures.nodes)?, scale });
        }
        let (map, NormalKeys { scale }) =
            sources.picture(item, Some(Encoding::Linear), diagnostics, NormalKeys::read)?;
        let map = sources.normals(item, map, diagnostics)?;
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
        if let Some(named) = sources.named_texture(item, diagnostics, |_| false) {
            let HeightKeys { height } =
                name_with(item, diagnostics, |params| HeightKeys::read(params, sources))?;
            let heights = named?.number(sources.textures.nodes)?;
            return Some(HeightMap { heights, height });
        }
        let read = |params: &mut Params<'_, '_>, sources: &mut Sources<'_>| {
            Some((HeightKeys::read(params, sources)?, ChannelKeys::read(params, sources)?))
        };
        let (map, (HeightKeys { height }, ChannelKeys { channel })) =
            sources.picture(item, Some(Encoding::Linear), diagnostics, read)?;
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
        if item.function().is_some() {
            let function = Args::read(item, diagnostics, Args::function)?;
            let value = sources.textures.nodes.float(Expression { function, bounds: [0.0, f32::MAX] })?;
            let slide = sources.textures.nodes.color(Grey { value, most: f32::MAX })?;
            return Some(SurfaceLight { light: Emission::from_rgb([1.0; 3]), slide: Some(slide) });
        }
        let name = |args: &mut Args<'_>| Ok((args.text()?.into_owned(), factor(args)?));
        let (slide, factor, SlideKeys { light }) = match sources.named_texture(item, diagnostics, |_| true) {
            Some(named) => {
                let mut params = Params::within(item, diagnostics);
                let (own, keys) = (params.own(name), SlideKeys::read(&mut params, sources));
                params.finish();
                (named?.color(sources.textures.nodes)?, own?.1, keys?)
            }
            None if is_picture(item) => {
                let ((map, factor), keys) =
                    sources.picture_and(item, None, diagnostics, name, SlideKeys::read)?;
                (sources.textures.nodes.color(map)?, factor, keys)
            }
            // Other words are lights.
            None => {
                let spectra = sources.textures.spectra;
                let light = Args::read(item, diagnostics, |args| spectra.emission(args))?;
                return Some(SurfaceLight { light, slide: None });
            }
        };
        let light = light.unwrap_or_else(|| Emission::from_rgb([1.0; 3])).scaled(factor);
        Some(SurfaceLight { light, slide: Some(slide) })
    }
}

/// Whether a word is the name of a file rather than that of a texture.
fn is_file(word: &str) -> bool {
    word.contains('.')
}

/// The colours of a picture or a named texture.
pub(super) struct ColorPicture(pub ColorTexture);

impl Value<'_> for ColorPicture {
    fn read(
        _: &FieldSpec,
        item: Item<'_>,
        diagnostics: &mut Diagnostics,
        sources: &mut Sources<'_>,
    ) -> Option<ColorPicture> {
        if let Some(named) = sources.named_texture(item, diagnostics, is_file) {
            Args::read(item, diagnostics, |args| args.text())?;
            return named?.color(sources.textures.nodes).map(ColorPicture);
        }
        let (map, ()) = sources.picture(item, None, diagnostics, |_, _| Some(()))?;
        sources.textures.nodes.color(map).map(ColorPicture)
    }
}
