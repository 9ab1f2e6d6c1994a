//! Colours and numbers of materials that may be pictures.
//!
//! ```text
//! color planks.png
//! color planks.png { repeat 4 2  offset 0.5 0  wrap mirror  filter nearest  encoding linear }
//! roughness scratches.png { channel green  range 0.1 0.4 }
//! roughness = 0.3 + 0.1 * sin(20 * x)
//! color bark
//! roughness bark { range 0.4 0.8 }
//! emission slide.png 5
//! emission slide.png { light blackbody 3200 5 }
//! color "waves.####.png"
//! ```
//!
//! A name that ends as those of pictures do is one; other names are those of `Textures`. Whole numbers of a colour are
//! values for a screen unless `encoding` says otherwise; floats, and pictures of numbers, are amounts. A file is read
//! once, however many parameters show it.

use std::ops::{Bound, RangeBounds};
use std::sync::Arc;

use kajo_color::Reflectance;
use kajo_image::Format;
use kajo_scene::{Args, Assets, Diagnostic, Diagnostics, Item, Params};

use super::picture_keys::{ChannelKeys, PictureKeys, RANGE};
use super::picture_sequence::PictureSequence;
use super::{Keys, Sources};
use crate::compile::CompileOptions;
use crate::compile::named_texture::{self, NamedTexture, TextureNames, is_spectrum};
use crate::compile::picture_files::{PictureCache, PictureReader, Problem};
use crate::compile::spectra::{SpectrumReader, Written};
use crate::schema::FieldSpec;
use crate::texture::{
    AnyFloatNode, Channel, ColorTexture, Encoding, Expression, FloatTexture, Picture, PictureChannel,
    PictureMap, Remapped, Textures, Tiling, Wrap,
};

/// Endings of pictures that people have and this program does not read.
const FOREIGN: [&str; 7] = ["avif", "dds", "gif", "ktx", "ktx2", "tif", "tiff"];

/// Endings of pictures that are read and not written.
const READ_ONLY: [&str; 3] = ["jpeg", "jpg", "webp"];

/// Reads textures.
pub(in crate::compile) struct TextureReader<'a> {
    pub spectra: SpectrumReader<'a>,
    pub pictures: PictureReader<'a>,
    /// Of the scene.
    pub nodes: &'a mut Textures,
    /// Those that have names.
    pub named: &'a TextureNames,
}

impl<'a> TextureReader<'a> {
    pub fn new(
        assets: &'a dyn Assets,
        options: &'a CompileOptions,
        cache: &'a mut PictureCache,
        nodes: &'a mut Textures,
        named: &'a TextureNames,
    ) -> TextureReader<'a> {
        TextureReader {
            spectra: SpectrumReader { assets },
            pictures: PictureReader::new(assets, options, cache),
            nodes,
            named,
        }
    }
}

impl Sources<'_> {
    /// A colour whose components are shares of light, a measured spectrum of such, a picture, or a texture by its name.
    pub fn color(&mut self, item: Item<'_>, diagnostics: &mut Diagnostics) -> Option<ColorTexture> {
        if is_picture(item) {
            let (map, ()) = self.picture(item, None, diagnostics, |_, _| Some(()))?;
            return self.textures.nodes.color(map);
        }
        if let Some(named) = self.named_texture(item, diagnostics, is_spectrum) {
            Args::read(item, diagnostics, |args| args.text())?;
            return named?.color(self.textures.nodes);
        }
        let spectra = self.textures.spectra;
        Args::read(item, diagnostics, |args| share_of_light(spectra, args)).map(ColorTexture::Constant)
    }

    /// The texture that an item names, as [`named_texture::find`]; none where it names a picture.
    pub fn named_texture(
        &self,
        item: Item<'_>,
        diagnostics: &mut Diagnostics,
        is_value: impl Fn(&str) -> bool,
    ) -> Option<Option<NamedTexture>> {
        if is_picture(item) {
            return None;
        }
        named_texture::find(self.textures.named, item, diagnostics, is_value)
    }

    /// A number within the bounds of its field, a picture or a named texture of such, or a function of the place.
    pub fn float(
        &mut self,
        spec: &FieldSpec,
        item: Item<'_>,
        diagnostics: &mut Diagnostics,
    ) -> Option<FloatTexture> {
        let node = |(map, channel), ()| PictureChannel { map, channel }.into();
        self.float_of(spec, item, diagnostics, |_, _| Some(()), node)
    }

    /// As [`Sources::float`] of what `of` makes of a channel of a picture.
    ///
    /// * `more`: reads what of the picture's block is for `of`
    pub fn float_of<'t, T>(
        &mut self,
        spec: &FieldSpec,
        item: Item<'t>,
        diagnostics: &mut Diagnostics,
        more: impl FnOnce(&mut Params<'t, '_>, &mut Sources<'_>) -> Option<T>,
        of: impl FnOnce((PictureMap, Channel), T) -> AnyFloatNode,
    ) -> Option<FloatTexture> {
        let bounds = spec.kind.bounds();
        if item.function().is_some() {
            let function = Args::read(item, diagnostics, Args::function)?;
            return self.textures.nodes.float(Expression { function, bounds: held_by(bounds) });
        }
        let range = |params: &mut Params<'_, '_>| {
            params.optional(RANGE.key, |args| Ok([args.number_in(bounds)?, args.number_in(bounds)?]))
        };
        if let Some(named) = self.named_texture(item, diagnostics, |_| false) {
            let range = name_with(item, diagnostics, |params| Some(range(params)))?;
            let texture = named?.number(self.textures.nodes)?;
            return self.ranged(spec, item, diagnostics, (texture, range, "texture"));
        }
        if !is_picture(item) {
            return Args::read(item, diagnostics, |args| args.number_in(bounds)).map(FloatTexture::Constant);
        }
        let (map, (channel, said, range)) =
            self.picture(item, Some(Encoding::Linear), diagnostics, |params, sources| {
                let channel = ChannelKeys::read(params, sources);
                let range = range(params);
                Some((channel?.channel, more(params, sources)?, range))
            })?;
        let texture = self.textures.nodes.float(of((map, channel), said))?;
        self.ranged(spec, item, diagnostics, (texture, range, "picture"))
    }

    /// A texture from 0 to 1, brought to the range that its item says; one that needs a range and has none is reported.
    fn ranged(
        &mut self,
        spec: &FieldSpec,
        item: Item<'_>,
        diagnostics: &mut Diagnostics,
        (texture, range, what): (FloatTexture, Option<[f32; 2]>, &str),
    ) -> Option<FloatTexture> {
        let bounds = spec.kind.bounds();
        match range {
            Some(range) => self.textures.nodes.float(Remapped { texture, range }),
            None if bounds.contains(&0.0) && bounds.contains(&1.0) => Some(texture),
            None => {
                let message =
                    format!("a {what} of `{}` needs a `range`: its value is a {}", spec.key, spec.kind);
                let error = Diagnostic::error(message).label(item.head_span(), "from 0 to 1");
                diagnostics.push(error.help("`range` has the two values that black and white stand for"));
                None
            }
        }
    }

    /// The picture that an item names, laid as its block says.
    ///
    /// * `encoding`: what the colours mean if the block does not say; `None` leaves it to the file
    /// * `more`: reads what else may stand in the block
    pub fn picture<'t, T>(
        &mut self,
        item: Item<'t>,
        encoding: Option<Encoding>,
        diagnostics: &mut Diagnostics,
        more: impl FnOnce(&mut Params<'t, '_>, &mut Sources<'_>) -> Option<T>,
    ) -> Option<(PictureMap, T)> {
        let read_name = |args: &mut Args<'t>| Ok((args.text()?.into_owned(), ()));
        let ((map, ()), more) = self.picture_and(item, encoding, diagnostics, read_name, more)?;
        Some((map, more))
    }

    /// A picture as one of normals, with what its filter needs for that.
    pub fn normals(
        &mut self,
        item: Item<'_>,
        map: PictureMap,
        diagnostics: &mut Diagnostics,
    ) -> Option<PictureMap> {
        if let Err(over) = self.textures.pictures.memory.take(map.moment_bytes()) {
            let error = Diagnostic::error(format!("cannot filter these normals: {over}"));
            diagnostics.push(error.label(item.head_span(), "named here"));
            return None;
        }
        Some(map.of_normals())
    }

    /// As [`Sources::picture`], and what stands after the name.
    pub fn picture_and<'t, U, T>(
        &mut self,
        item: Item<'t>,
        encoding: Option<Encoding>,
        diagnostics: &mut Diagnostics,
        read_name: impl FnOnce(&mut Args<'t>) -> Result<(String, U), Diagnostic>,
        more: impl FnOnce(&mut Params<'t, '_>, &mut Sources<'_>) -> Option<T>,
    ) -> Option<((PictureMap, U), T)> {
        let mut params = Params::within(item, diagnostics);
        let name = params.own(read_name);
        let keys = PictureKeys::read(&mut params, self);
        if keys.as_ref().is_some_and(|keys| keys.tiling == Tiling::Random && keys.wrap != Wrap::Repeat) {
            params.refuse("tiling", "beside a `wrap` other than `repeat`");
        }
        let more = more(&mut params, self);
        let sequence = PictureSequence::read(name.as_ref().map(|(name, _)| &**name), &mut params, self);
        params.finish();
        let ((name, after), keys, sequence) = (name?, keys?, sequence?);
        let PictureKeys { repeat, offset, wrap, tiling, filter, encoding: said } = keys;
        let pictures = &mut self.textures.pictures;
        let picture = pictures.at_frame(item, &name, sequence, said.or(encoding), diagnostics)?;
        let filter = filter.unwrap_or(pictures.filter());
        if let Err(over) = pictures.prepare(&picture, filter) {
            let error = Diagnostic::error(format!("cannot filter `{name}`: {over}"));
            diagnostics.push(error.label(item.head_span(), "named here"));
            return None;
        }
        let map = PictureMap {
            wrap: [wrap; 2],
            tiling,
            filter,
            repeat: repeat.0,
            offset,
            ..PictureMap::new(picture)
        };
        Some(((map, after), more?))
    }
}

/// What stands in the block behind the name of a texture; `None` for what is wrong, which is reported.
pub(in crate::compile) fn name_with<'t, T>(
    item: Item<'t>,
    diagnostics: &mut Diagnostics,
    read: impl FnOnce(&mut Params<'t, '_>) -> Option<T>,
) -> Option<T> {
    let mut params = Params::within(item, diagnostics);
    let name = params.own(|args| args.text().map(|_| ()));
    let found = read(&mut params);
    params.finish();
    name.and(found)
}

/// The numbers that a function of the place is held to.
fn held_by((low, high): (Bound<f64>, Bound<f64>)) -> [f32; 2] {
    let low = match low {
        Bound::Included(low) => low as f32,
        Bound::Excluded(low) => (low as f32).next_up().max(1e-6),
        Bound::Unbounded => f32::MIN,
    };
    let high = match high {
        Bound::Included(high) | Bound::Excluded(high) => high as f32,
        Bound::Unbounded => f32::MAX,
    };
    [low, high]
}

fn share_of_light(spectra: SpectrumReader<'_>, args: &mut Args<'_>) -> Result<Reflectance, Diagnostic> {
    let Written { rgb, value } = spectra.reflectance(args)?;
    // A measured one has been checked, and its colour may be none of the screen's.
    if value.rgb() == rgb.to_rgb() || rgb.to_rgb().iter().all(|v| (0.0..=1.0).contains(v)) {
        return Ok(value);
    }
    Err(args.error("a share of light is between 0 and 1"))
}

/// Whether the item names a picture.
pub(in crate::compile) fn is_picture(item: Item<'_>) -> bool {
    let Some(word) = item.word() else { return false };
    let name = word.text();
    let Some((_, ending)) = name.rsplit_once('.') else { return false };
    let is_other = FOREIGN.iter().chain(&READ_ONLY).any(|other| ending.eq_ignore_ascii_case(other));
    is_other || Format::from_extension(ending).is_some()
}

impl PictureReader<'_> {
    /// The picture of a name at the frame of the scene.
    fn at_frame(
        &mut self,
        item: Item<'_>,
        name: &str,
        sequence: PictureSequence,
        encoding: Option<Encoding>,
        diagnostics: &mut Diagnostics,
    ) -> Option<Arc<Picture>> {
        match sequence.name_at(name, item.desc().clock()) {
            Ok(name) => self.named(item, &name, encoding, diagnostics),
            Err(error) => {
                diagnostics.push(error.label(item.head_span(), "named here"));
                None
            }
        }
    }

    /// The picture of a name in the scene; one that cannot be read is an error.
    fn named(
        &mut self,
        item: Item<'_>,
        name: &str,
        encoding: Option<Encoding>,
        diagnostics: &mut Diagnostics,
    ) -> Option<Arc<Picture>> {
        let picture = self.picture(name, item.path(), encoding);
        let said = |problem: Problem| match problem {
            Problem::Unreadable(reason) => Diagnostic::error(format!("cannot read `{name}`: {reason}"))
                .label(item.head_span(), "named here"),
            Problem::Outside(n) => {
                Diagnostic::warning(format!("{n} values of `{name}` are not between 0 and 1"))
                    .label(item.head_span(), "they are held to it")
            }
        };
        match picture {
            Ok((picture, problem)) => {
                problem.into_iter().for_each(|problem| diagnostics.push(said(problem)));
                Some(picture)
            }
            Err(problem) => {
                diagnostics.push(said(problem));
                None
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use kajo_color::{Emission, Wavelengths};
    use kajo_image::{EncodeOptions, Image, encode};
    use kajo_math::{Ray, Vec2, Vec3};
    use kajo_scene::{MemoryAssets, SceneDesc};

    use super::*;
    use crate::bsdf::tests::without_tables;
    use crate::bsdf::{Base, Bsdf, Phong};
    use crate::compile::compile;
    use crate::scene::{Interaction, Scene};
    use crate::texture::TexelFilter;

    /// Files of 2 x 2 texels: red and green above blue and white, greys, and shares as floats.
    fn assets() -> MemoryAssets {
        let file = |format, texel: fn(u32, u32) -> [f32; 4]| {
            encode(&Image::from_fn(2, 2, texel).unwrap(), format, &EncodeOptions::default()).unwrap()
        };
        let colors = |x, y| match (x, y) {
            (0, 0) => [1.0, 0.0, 0.0, 1.0],
            (1, 0) => [0.0, 1.0, 0.0, 0.0],
            (0, _) => [0.0, 0.0, 1.0, 1.0],
            _ => [1.0, 1.0, 1.0, 0.5],
        };
        let colors = file(Format::Png, colors);
        let grey = file(Format::Png, |x, _| if x == 0 { [0.5; 4] } else { [1.0, 0.25, 0.5, 1.0] });
        let bright = file(Format::Exr, |_, _| [3.0, 0.5, 0.25, 1.0]);
        MemoryAssets::new()
            .with("colors.png", &colors)
            .with("skins/colors.png", colors)
            .with("grey.png", grey)
            .with("bright.exr", bright)
            .with("text.png", "no picture")
            .with("photo.jxl", "no picture")
            .with(
                "skins/box.mtl",
                "newmtl skin\nmap_Kd -s 1 1 1 colors.png\nnewmtl lost\nKd 1 0 0\nmap_Kd none.png\n",
            )
            .with(
                "skins/box.obj",
                "mtllib box.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
                 usemtl skin\nf 1/1 2/2 3/3\nusemtl lost\nf 1/1 3/3 4/4\n",
            )
    }

    fn compiled(materials: &str, object: &str) -> (Option<Scene>, Vec<String>) {
        let text = format!(
            "PerspectiveCamera {{ center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }}
             Materials {{ {materials} }} Group {{ MaterialIndex 0 {object} }}"
        );
        let mut parsed = SceneDesc::parse_str(&text);
        let mut diagnostics = Diagnostics::default();
        let scene = compile(&mut parsed.desc, &assets(), &CompileOptions::default(), &mut diagnostics);
        (scene, diagnostics.iter().map(|d| d.message.clone()).collect())
    }

    const SQUARE: &str = "Quad { corner -1 -1 0 edge1 2 0 0 edge2 0 2 0 }";

    /// A square from (-1, -1) to (1, 1) of the material, met at a place.
    fn met(materials: &str, object: &str, x: f32, y: f32) -> (Scene, Interaction) {
        let (scene, said) = compiled(materials, object);
        let scene = scene.unwrap_or_else(|| panic!("{materials}: {said:?}"));
        let at = scene.trace(&Ray::new(Vec3::new(x, y, 5.0), Vec3::NEG_Z));
        let at = *at.surface().expect("the ray meets the square");
        (scene, at)
    }

    fn classic(materials: &str, x: f32, y: f32) -> Phong {
        let (scene, at) = met(materials, SQUARE, x, y);
        scene.appearance.phong(at.material, &scene.texture_context(&at))
    }

    fn assert_near(found: [f32; 3], expected: [f32; 3]) {
        assert!(Vec3::from(found).distance(expected.into()) < 1e-3, "{found:?} for {expected:?}");
    }

    const RED: [f32; 3] = [1.0, 0.0, 0.0];
    const BLUE: [f32; 3] = [0.0, 0.0, 1.0];
    const GREEN: [f32; 3] = [0.0, 1.0, 0.0];

    #[test]
    fn colours_of_every_material_may_be_pictures() {
        for material in [
            "Matte { color colors.png }",
            "Matte { color colors.png { wrap clamp } }",
            "Material { texture colors.png }",
            "Material { texture colors.png { filter nearest } specularColor 1 1 1 }",
            "Principled { color colors.png }",
        ] {
            assert_near(classic(material, -0.5, 0.5).diffuse.to_rgb(), RED);
            assert_near(classic(material, -0.5, -0.5).diffuse.to_rgb(), BLUE);
            assert_near(classic(material, 0.5, 0.5).diffuse.to_rgb(), GREEN);
            assert_near(classic(material, 0.5, 0.5).ambient.to_rgb(), GREEN);
        }
        assert_near(classic("Metal { color colors.png }", -0.5, 0.5).reflective.to_rgb(), RED);
        let shifted = "Matte { color colors.png { repeat 1 2 offset 0.5 0 filter nearest } }";
        assert_near(classic(shifted, -0.5, -0.75).diffuse.to_rgb(), [1.0; 3]);
        assert_near(classic(shifted, -0.5, -0.25).diffuse.to_rgb(), GREEN);
        // A factor of the colour that is written.
        assert_near(
            classic("Material { diffuseColor 0.5 1 1 texture colors.png }", -0.5, 0.5).diffuse.to_rgb(),
            [0.5, 0.0, 0.0],
        );
    }

    #[test]
    fn whole_numbers_are_for_screens_where_they_are_colours() {
        let at = |material: &str| classic(material, -0.5, 0.5);
        assert_near(at("Matte { color grey.png }").diffuse.to_rgb(), [0.2159; 3]);
        assert_near(at("Matte { color grey.png { encoding linear } }").diffuse.to_rgb(), [0.502; 3]);
        // A metal of the roughness 1/2 has the exponent 2/α² - 2, α = 1/4.
        let rough = |material: &str| classic(material, -0.5, 0.5).exponent;
        assert!((rough("Metal { roughness grey.png }") - 30.0).abs() < 1.0);
        assert!(
            (rough("Metal { roughness grey.png { encoding srgb } }") - 2.0 / 0.2159f32.powi(4) + 2.0).abs()
                < 20.0
        );
    }

    #[test]
    fn numbers_take_a_channel() {
        let exponent = |channel: &str| {
            let material = format!("Metal {{ roughness grey.png {{ channel {channel} filter nearest }} }}");
            classic(&material, 0.5, 0.5).exponent
        };
        let of = |roughness: f32| (2.0 / roughness.powi(4) - 2.0).max(1.0);
        for (channel, roughness) in
            [("red", 1.0), ("green", 64.0 / 255.0), ("blue", 128.0 / 255.0), ("alpha", 1.0)]
        {
            assert!(
                (exponent(channel) / of(roughness) - 1.0).abs() < 0.01,
                "{channel}: {}",
                exponent(channel)
            );
        }
    }

    #[test]
    fn scattering_follows_the_picture_in_every_mode() {
        for material in ["Matte { color colors.png }", "Material { texture colors.png }"] {
            let (scene, at) = met(material, SQUARE, -0.5, 0.5);
            let albedo = |lambda: &Wavelengths| scene.bsdf(&at, lambda, 1.0, 0.5).albedo(Vec3::Z);
            assert_near(albedo(&Wavelengths::RGB).to_rgb(), RED);
            let (n, mut sum) = (4000, Vec3::ZERO);
            for i in 0..n {
                let lambda = Wavelengths::sample((i as f32 + 0.5) / n as f32);
                let light = Emission::from_rgb([1.0; 3]).at(&lambda);
                sum += Vec3::from(kajo_color::sensor::to_rgb(albedo(&lambda) * light, &lambda)) / n as f32;
            }
            assert!(sum.distance(RED.into()) < 0.02, "{material}: {sum}");
        }
    }

    #[test]
    fn holes_may_be_pictures() {
        let veil = "Matte { opacity colors.png { channel alpha filter nearest } }";
        for (x, y, visible) in [(-0.5, 0.5, 0.0), (0.5, 0.5, 1.0), (0.5, -0.5, 1.0 - 128.0 / 255.0)] {
            let (scene, _) = met(veil, SQUARE, x, y);
            let through = scene.transmittance_in_air(&Ray::new(Vec3::new(x, y, 5.0), Vec3::NEG_Z))[0];
            assert!((through - visible).abs() < 1e-3, "{x} {y}: {through}");
        }
    }

    /// By the render's filter unless the picture has its own, for those that meshes bring as well.
    #[test]
    fn pictures_are_filtered_as_the_render_says() {
        const WHITE: [f32; 3] = [1.0; 3];
        let mean = [0.5; 3];
        let mesh = "TriangleMesh { file \"skins/box.obj\" materials on }";
        for (settings, asked, material, object, expected) in [
            ("", None, "Matte { color colors.png }", SQUARE, WHITE),
            ("textureFilter trilinear", None, "Matte { color colors.png }", SQUARE, mean),
            ("textureFilter trilinear", None, "Matte { color colors.png { filter nearest } }", SQUARE, WHITE),
            (
                "textureFilter trilinear",
                Some(TexelFilter::Nearest),
                "Matte { color colors.png }",
                SQUARE,
                WHITE,
            ),
            ("", Some(TexelFilter::Trilinear), "Matte { color colors.png }", SQUARE, mean),
            ("", None, "Matte { }", mesh, WHITE),
            ("textureFilter trilinear", None, "Matte { }", mesh, mean),
        ] {
            let text = format!(
                "PerspectiveCamera {{ center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }} Settings {{ {settings} }}
                 Materials {{ {material} }} Group {{ MaterialIndex 0 {object} }}"
            );
            let mut parsed = SceneDesc::parse_str(&text);
            let options = CompileOptions { texture_filter: asked, ..CompileOptions::default() };
            let scene =
                compile(&mut parsed.desc, &assets(), &options, &mut Diagnostics::default()).expect(&text);
            let event = scene.trace(&Ray::new(Vec3::new(0.5, -0.5, 5.0), Vec3::NEG_Z));
            let at = *event.surface().expect("the ray meets the square");
            let mut context = scene.texture_context(&at);
            context.footprint.uv = [Vec2::X, Vec2::Y];
            let found = scene.appearance.phong(at.material, &context).diffuse.to_rgb();
            assert!(Vec3::from(found).distance(expected.into()) < 1e-3, "{found:?} for {text}");
        }
    }

    #[test]
    fn meshes_bring_their_pictures() {
        let mesh = "TriangleMesh { file \"skins/box.obj\" materials on }";
        let (scene, said) = compiled("Matte { }", mesh);
        assert_eq!(said, ["`skins/box.mtl`: `none.png` is left out: there is no such file"]);
        let scene = scene.expect("the picture that is missing is left out");
        let color = |x, y| {
            let event = scene.trace(&Ray::new(Vec3::new(x, y, 5.0), Vec3::NEG_Z));
            let at = event.surface().expect("the ray meets the square");
            let place = scene.texture_context(at);
            scene.appearance.phong(at.material, &place).diffuse.to_rgb()
        };
        assert_near(color(0.5, -0.5), [1.0; 3]);
        assert_near(color(-0.5, 0.5), RED);
    }

    #[test]
    fn models_bring_their_pictures() {
        let floats = [-1.0f32, -1.0, 0.0, 3.0, -1.0, 0.0, -1.0, 3.0, 0.0, 0.0, 1.0, 2.0, 1.0, 0.0, -1.0];
        let bytes: Vec<u8> = floats.iter().flat_map(|x| x.to_le_bytes()).collect();
        let json = |image: &str| {
            format!(
                r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"uri":"a.bin","byteLength":60}}],
                "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":24}}],
                "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}},
                {{"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"}}],
                "textures":[{{"source":0}}],"images":[{{{image}}}],
                "materials":[{{"pbrMetallicRoughness":{{"baseColorFactor":[0.5,1,1,1],"baseColorTexture":{{"index":0}},
                "roughnessFactor":0.5,"metallicRoughnessTexture":{{"index":0}}}},"normalTexture":{{"index":0,"scale":0.5}}}}],
                "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_0":1}},"material":0}}]}}],
                "nodes":[{{"mesh":0}}]}}"#
            )
        };
        let color = |image: &str| {
            let text = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }
                        Materials { Matte { } } Group { MaterialIndex 0 Model { file skins/a.gltf } }";
            let assets = assets().with("skins/a.gltf", json(image)).with("skins/a.bin", &bytes);
            let mut diagnostics = Diagnostics::default();
            let mut parsed = SceneDesc::parse_str(text);
            let scene = compile(&mut parsed.desc, &assets, &CompileOptions::default(), &mut diagnostics);
            let said: Vec<_> = diagnostics.iter().map(|d| d.message.clone()).collect();
            let scene = scene.unwrap_or_else(|| panic!("{said:?}"));
            let event = scene.trace(&Ray::new(Vec3::new(-0.5, 0.5, 5.0), Vec3::NEG_Z));
            let at = event.surface().expect("the ray meets the model");
            let place = scene.texture_context(at);
            let phong = scene.appearance.phong(at.material, &place);
            let bsdf = without_tables(scene.bsdf(at, &Wavelengths::RGB, 1.0, 0.5));
            (phong.diffuse.to_rgb(), said, scene.shading(at, 0.5), bsdf)
        };
        let (found, said, shading, bsdf) = color(r#""uri":"colors.png""#);
        assert_near(found, [0.5, 0.0, 0.0]);
        assert!(said.is_empty(), "{said:?}");
        // Red is no green of roughness and no blue of metalness, and as a normal it points to the lower right, and inwards.
        assert!(
            shading.leans && shading.n.distance(Vec3::new(0.5, -0.5, -1.0).normalize()) < 1e-4,
            "{shading:?}"
        );
        let Bsdf::Principled(layers) = bsdf else { panic!("{bsdf:?}") };
        assert!(layers.base == Base::Diffuse && layers.alpha.x == 0.0, "{layers:?}");
        assert_near(layers.color.to_rgb(), [0.5, 0.0, 0.0]);
        let (found, said, shading, bsdf) = color(r#""uri":"data:image/png;base64,Zm9v""#);
        assert_near(found, [0.5, 1.0, 1.0]);
        assert!(
            !shading.leans && matches!(bsdf, Bsdf::Principled(layers) if layers.base == Base::Metal),
            "{bsdf:?}"
        );
        assert!(said[0].contains("skins/a.gltf#images[0]` is left out: "), "{said:?}");
    }

    /// The alpha of the four texels is 1 and 0 above 1 and 1/2, the red of the grey picture 1/2 and 1 from left to right.
    #[test]
    fn holes_come_from_alpha_from_red_and_from_cuts() {
        let through = |(scene, said): (Option<Scene>, Vec<String>)| {
            let scene = scene.unwrap_or_else(|| panic!("{said:?}"));
            let visible = |x, y| scene.transmittance_in_air(&Ray::new(Vec3::new(x, y, 5.0), Vec3::NEG_Z))[0];
            [visible(-0.5, 0.5), visible(0.5, 0.5), visible(-0.5, -0.5), visible(0.5, -0.5)]
        };
        let of_scene = |opacity: &str| through(compiled(&format!("Matte {{ opacity {opacity} }}"), SQUARE));
        let near = |found: [f32; 4], expected: [f32; 4]| {
            assert!(
                std::iter::zip(found, expected).all(|(a, b)| (a - b).abs() < 3e-3),
                "{found:?} {expected:?}"
            );
        };
        near(of_scene("colors.png { channel alpha }"), [0.0, 1.0, 0.0, 0.5]);
        near(of_scene("colors.png { channel alpha  cutoff 0.4 }"), [0.0, 1.0, 0.0, 0.0]);
        near(of_scene("colors.png { channel alpha  cutoff 0.6 }"), [0.0, 1.0, 0.0, 1.0]);
        near(of_scene("grey.png { cutoff 0.6 }"), [1.0, 0.0, 1.0, 0.0]);

        let of_mesh = |mtl: &str| {
            let obj = "mtllib a.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
                       usemtl a\nf 1/1 2/2 3/3 4/4\n";
            let assets = assets().with("a.obj", obj).with("a.mtl", format!("newmtl a\n{mtl}"));
            let text = "PerspectiveCamera { center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }
                        Materials { Matte { } } Group { MaterialIndex 0 TriangleMesh { file a.obj  materials on } }";
            let mut diagnostics = Diagnostics::default();
            let mut parsed = SceneDesc::parse_str(text);
            let scene = compile(&mut parsed.desc, &assets, &CompileOptions::default(), &mut diagnostics);
            (scene, diagnostics.iter().map(|d| d.message.clone()).collect::<Vec<_>>())
        };
        near(through(of_mesh("map_d colors.png\n")), [0.0, 1.0, 0.0, 0.5]);
        near(through(of_mesh("map_d grey.png\n")), [0.5, 0.0, 0.5, 0.0]);
        let (clear, said) = of_mesh("d 0.5\nmap_d colors.png\n");
        assert!(clear.is_some() && said[0].contains("light passes it anyway"), "{said:?}");
        let (bumpy, said) = of_mesh("norm colors.png\n");
        let (bumpy, ray) = (bumpy.unwrap(), Ray::new(Vec3::new(-0.5, 0.5, 5.0), Vec3::NEG_Z));
        let event = bumpy.trace(&ray);
        assert!(bumpy.shading(event.surface().unwrap(), 0.5).leans && said.is_empty(), "{said:?}");
    }

    #[test]
    fn sequences_show_the_picture_of_the_frame() {
        let color = |frame: i64, picture: &str| {
            let image = |v: f32| {
                encode(&Image::filled(1, 1, &[v]).unwrap(), Format::Png, &EncodeOptions::default()).unwrap()
            };
            let assets = (1..4).fold(MemoryAssets::new(), |assets, n| {
                assets.with(format!("a.00{n}.png"), image(n as f32 / 3.0))
            });
            let text = format!(
                "PerspectiveCamera {{ center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }}
                 Materials {{ Matte {{ color {picture} }} }} Group {{ MaterialIndex 0 {SQUARE} }}"
            );
            let mut parsed = SceneDesc::parse_str(&text);
            parsed.desc.set_clock(kajo_scene::Clock::new(24.0, 1, frame));
            let mut said = Diagnostics::default();
            let scene = compile(&mut parsed.desc, &assets, &CompileOptions::default(), &mut said);
            let said: Vec<_> = said.iter().map(|d| d.message.clone()).collect();
            scene
                .map(|scene| {
                    let event = scene.trace(&Ray::new(Vec3::new(0.0, 0.0, 5.0), Vec3::NEG_Z));
                    let at = event.surface().expect("the ray meets the square");
                    scene.appearance.phong(at.material, &scene.texture_context(at)).diffuse.to_rgb()[0]
                })
                .ok_or_else(|| said.join("; "))
        };
        let name = "\"a.###.png\"";
        let linear = format!("{name} {{ encoding linear }}");
        for n in 1..4 {
            let found = color(n, &linear).unwrap();
            assert!((found - n as f32 / 3.0).abs() < 2e-3, "{n}: {found}");
        }
        assert!(color(4, name).unwrap_err().contains("`a.004.png`"));
        let cycled = format!("{name} {{ encoding linear  frames 1 3  cycle on }}");
        assert_eq!(color(5, &cycled), color(2, &linear));
        let held = format!("{name} {{ encoding linear  frames 1 3 }}");
        assert_eq!(color(99, &held), color(3, &linear));
        for (picture, message) in [
            (format!("{name} {{ frames 3 1 }}"), "first frame"),
            (format!("{name} {{ cycle on }}"), "without `frames`"),
            ("\"a.###.00#.png\"".to_owned(), "two places"),
        ] {
            let error = color(1, &picture).unwrap_err();
            assert!(error.contains(message), "{picture}: {error}");
        }
    }

    #[test]
    fn a_file_is_read_once() {
        let (assets, mut cache) = (assets(), PictureCache::default());
        let options = CompileOptions::default();
        let mut reader = PictureReader::new(&assets, &options, &mut cache);
        let mut read = |name, from, encoding| reader.picture(name, from, encoding).map(|read| read.0).ok();
        let first = read("skins/colors.png", "s.txt", None).expect("a picture");
        let again = read("colors.png", "skins/a.mtl", None).expect("a picture");
        assert!(Arc::ptr_eq(&first, &again), "the same file by another name");
        let linear = read("skins/colors.png", "s.txt", Some(Encoding::Linear)).expect("a picture");
        assert!(!Arc::ptr_eq(&first, &linear), "other numbers");
        assert!(read("text.png", "s.txt", None).is_none() && read("text.png", "s.txt", None).is_none());
    }

    #[test]
    fn mistakes_are_named() {
        let error = |material: &str| {
            let (scene, said) = compiled(material, SQUARE);
            assert!(scene.is_none(), "accepted: {material}");
            said.join("; ")
        };
        assert_eq!(error("Matte { color none.png }"), "cannot read `none.png`: there is no such file");
        assert!(error("Matte { color text.png }").starts_with("cannot read `text.png`: "));
        assert!(error("Matte { roughness photo.gif }").starts_with("cannot read `photo.gif`"));
        assert!(error("Matte { color colors.png { wrap never } }").contains("wrap"));
        assert!(
            error("Matte { color colors.png { channel red } }").contains("channel"),
            "colours have all channels"
        );
        assert!(error("Matte { color colors.png 0.5 }").contains("found"));
        assert!(error("Material { texture 1 0 0 }").contains("texture"));
        assert!(error("Matte { color photo.jxl }").contains("photo.jxl"));
        assert!(error("Glass { opacity colors.png }").contains("no holes"));
        let (scene, said) = compiled("Matte { color bright.exr }", SQUARE);
        assert!(scene.is_some() && said == ["4 values of `bright.exr` are not between 0 and 1"], "{said:?}");
    }
}
