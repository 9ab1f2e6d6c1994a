//! `Background` and `Fog` blocks.

use kajo_color::{Emission, Spectrum};
use kajo_image::{DecodeLimits, Format, Image};
use kajo_scene::{Args, Diagnostic, Item, read_limited};

use super::Compiler;
use crate::background::{Background, CubeMap, FACE_NAMES};
use crate::medium::Fog;

impl Compiler<'_> {
    /// Background and ambient light.
    pub(super) fn background(&mut self, item: Option<Item<'_>>) -> (Background, Spectrum) {
        let default = ([0.5; 3], Spectrum::BLACK);
        let constant = |color: [f32; 3]| Background::Constant(Emission::from_rgb(color));
        let Some(item) = item else { return (constant(default.0), default.1) };
        let mut cube_map = None;
        let colors = self.read(item, |params| {
            let color = params.optional("color", Args::vec3).map_or(default.0, |color| color.to_array());
            let ambient = params.optional("ambientLight", Args::vec3).map_or(default.1, Spectrum::from);
            cube_map = params.optional("cubeMap", |args| Ok((args.item(), args.text()?)));
            Some((color, ambient))
        });
        let (color, ambient) = colors.unwrap_or(default);
        let faces = cube_map.and_then(|(item, folder)| self.cube_map(item, &folder));
        (faces.map_or_else(|| constant(color), Background::CubeMap), ambient)
    }

    fn cube_map(&mut self, item: Item<'_>, folder: &str) -> Option<Box<CubeMap>> {
        let faces = FACE_NAMES
            .map(|face| self.picture(item, &format!("{}/{face}.png", folder.trim_end_matches('/'))));
        let [a, b, c, d, e, f] = faces;
        Some(Box::new(CubeMap::new([a?, b?, c?, d?, e?, f?])))
    }

    /// Reads a picture that the scene names.
    pub(super) fn picture(&mut self, item: Item<'_>, name: &str) -> Option<Image> {
        let limit = self.options.limits.mesh_bytes;
        let read = self.assets.open(name, item.path()).and_then(|file| read_limited(file, limit));
        let picture = read.map_err(|e| e.to_string()).and_then(|bytes| {
            let decoded = kajo_image::decode(&bytes, Some(Format::Png), &DecodeLimits::default());
            decoded.map(|d| d.image).map_err(|e| e.to_string())
        });
        match picture {
            Ok(picture) => Some(picture),
            Err(reason) => {
                let error = Diagnostic::error(format!("cannot read `{name}`: {reason}"));
                self.diagnostics.push(error.label(item.head_span(), "named here"));
                None
            }
        }
    }

    /// The fog of the scene.
    pub(super) fn fog(&mut self, item: Item<'_>) -> Option<Fog> {
        self.read(item, |params| {
            let color = params.required("color", Args::vec3);
            let density = params.required("density", |a| a.number_in(0.0..));
            let falloff = params.or("heightFalloff", 0.0, |a| a.number_in(0.0..));
            let height = params.or("height", 0.0, Args::number);
            Some(Fog { color: color?.into(), density: density?, falloff, height })
        })
    }
}
