//! Pictures of models: as they are, and mixed of two where a material says in two pictures what is one number here.
//!
//! A surface in the older terms of a diffuse colour `d`, a specular one `s` and a glossiness becomes one in the newer terms
//! texel by texel. Its metalness `m` solves, with `|.|` for brightness,
//!
//! ```text
//! 0.04 m² + (|d| (1 - max s) / 0.96 + |s| - 0.08) m + 0.04 - |s| = 0
//! ```
//!
//! which says that a mixture of a metal and of a diffuse base under a gloss of 4 % reflects as much [Khronos 2017, "Converting
//! between workflows"].

use std::sync::Arc;

use kajo_scene::{ModelGlossiness, PictureSource, PictureUse, PictureWrap};

use super::Compiler;
use super::model_material::ModelPictures;
use crate::texture::{Encoding, Picture, PictureMap, TexelFilter, UvSet, Wrap};

/// What surfaces that are no metals reflect straight on.
const GLOSS: f32 = 0.04;

impl Compiler<'_> {
    /// A picture that a material shows; one that cannot be read is left out.
    pub(super) fn model_picture(
        &mut self,
        shown: Option<PictureUse>,
        encoding: Option<Encoding>,
        pictures: &ModelPictures<'_>,
    ) -> Option<PictureMap> {
        let PictureUse { picture: number, wrap, nearest, set, repeat, cross, offset } = shown?;
        let &ModelPictures { list, path, files, at } = pictures;
        let source = list.get(number)?.as_ref()?;
        if is_ktx2(source) {
            let why = "KTX2 pictures (`KHR_texture_basisu`) are not read; a program such as `gltf-transform` writes \
                       PNG in their place";
            self.picture_left_out(&format!("images[{number}]"), path, why, at);
            return None;
        }
        let map = match source {
            PictureSource::File(name) => self.found_picture(name, path, encoding, at),
            PictureSource::Bytes(bytes) => {
                let source = files.map(|files| files.picture(number));
                self.held_picture((bytes, source), &format!("{path}#images[{number}]"), encoding, at)
            }
        }?;
        let wrap = wrap.map(|wrap| match wrap {
            PictureWrap::Repeat => Wrap::Repeat,
            PictureWrap::Mirror => Wrap::Mirror,
            PictureWrap::Clamp => Wrap::Clamp,
        });
        let filter = if nearest { TexelFilter::Nearest } else { map.filter };
        let set = match set {
            kajo_scene::CoordinateSet::First => UvSet::First,
            kajo_scene::CoordinateSet::Second => UvSet::Second,
        };
        let (repeat, cross, offset) = (repeat.into(), cross.into(), offset.into());
        Some(PictureMap { wrap, filter, set, repeat, cross, offset, ..map })
    }

    /// Base colour with opacity, and roughness in green with metalness in blue, of a surface in older terms.
    pub(super) fn glossiness_pictures(
        &mut self,
        older: &ModelGlossiness,
        pictures: &ModelPictures<'_>,
    ) -> Option<[PictureMap; 2]> {
        let specular = self.model_picture(Some(older.picture), None, pictures)?;
        let diffuse = self.model_picture(older.diffuse_picture, None, pictures);
        let diffuse = diffuse
            .unwrap_or_else(|| PictureMap { picture: PictureMap::white().picture, ..specular.clone() });
        let surface = |d: [f32; 4], s: [f32; 4]| {
            let [r, g, b, alpha] = d;
            let d = [r * older.diffuse[0], g * older.diffuse[1], b * older.diffuse[2]];
            let f = std::array::from_fn(|c| s[c] * older.specular[c]);
            (newer(d, f), alpha, 1.0 - s[3] * older.glossiness)
        };
        let color = mixed(&diffuse, &specular, |d, s| {
            let (([r, g, b], _), alpha, _) = surface(d, s);
            [r, g, b, alpha]
        })?;
        let metal = mixed(&diffuse, &specular, |d, s| {
            let ((_, metalness), _, roughness) = surface(d, s);
            [0.0, roughness, metalness, 1.0]
        })?;
        Some([color, metal])
    }
}

/// Whether a picture is in the container of the extension `KHR_texture_basisu`.
fn is_ktx2(source: &PictureSource) -> bool {
    match source {
        PictureSource::File(name) => name.to_ascii_lowercase().ends_with(".ktx2"),
        PictureSource::Bytes(bytes) => bytes.starts_with(b"\xabKTX 20\xbb"),
    }
}

/// A picture of two that lie in the same place; `None` where they do not.
fn mixed(
    a: &PictureMap,
    b: &PictureMap,
    texel: impl Fn([f32; 4], [f32; 4]) -> [f32; 4],
) -> Option<PictureMap> {
    if !a.lies_like(b) {
        return None;
    }
    let size = std::array::from_fn(|i| a.picture.size()[i].max(b.picture.size()[i]));
    let [width, height]: [u32; 2] = size;
    let picture = Picture::from_fn(width, height, |x, y| {
        let s = kajo_math::Vec2::new((x as f32 + 0.5) / width as f32, 1.0 - (y as f32 + 0.5) / height as f32);
        texel(a.unscaled(s), b.unscaled(s))
    });
    picture.prepare(a.filter);
    Some(PictureMap { picture: Arc::new(picture), ..a.clone() })
}

/// Base colour and metalness of a surface of the diffuse colour `d` and the specular one `s`.
fn newer(d: [f32; 3], s: [f32; 3]) -> ([f32; 3], f32) {
    let left = 1.0 - s.into_iter().fold(0.0, f32::max);
    let metalness = metalness(brightness(d), brightness(s), left);
    let diffuse = d.map(|c| c * left / (1.0 - GLOSS) / (1.0 - metalness).max(1e-4));
    let metal = s.map(|c| (c - GLOSS * (1.0 - metalness)) / metalness.max(1e-4));
    let share = metalness * metalness;
    let color = std::array::from_fn(|c| diffuse[c] + (metal[c] - diffuse[c]) * share);
    (color.map(|c: f32| c.clamp(0.0, 1.0)), metalness)
}

fn metalness(diffuse: f32, specular: f32, left: f32) -> f32 {
    if specular < GLOSS {
        return 0.0;
    }
    let b = diffuse * left / (1.0 - GLOSS) + specular - 2.0 * GLOSS;
    let c = GLOSS - specular;
    let root = (b * b - 4.0 * GLOSS * c).max(0.0).sqrt();
    ((root - b) / (2.0 * GLOSS)).clamp(0.0, 1.0)
}

/// As it is perceived, about.
fn brightness([r, g, b]: [f32; 3]) -> f32 {
    (0.299 * r * r + 0.587 * g * g + 0.114 * b * b).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn surfaces_in_older_terms_keep_their_looks() {
        let near = |(color, metal): ([f32; 3], f32), expected: [f32; 3], metalness: f32| {
            let close = |a: f32, b: f32| (a - b).abs() < 0.02;
            assert!(close(metal, metalness), "{metal} for {metalness}");
            assert!(std::iter::zip(color, expected).all(|(a, b)| close(a, b)), "{color:?} for {expected:?}");
        };
        near(newer([0.5, 0.25, 0.1], [0.04; 3]), [0.5, 0.25, 0.1], 0.0);
        near(newer([0.5, 0.25, 0.1], [0.0; 3]), [0.52, 0.26, 0.104], 0.0);
        near(newer([0.0; 3], [1.0, 0.8, 0.3]), [1.0, 0.8, 0.3], 1.0);
        near(newer([0.0; 3], [0.0; 3]), [0.0; 3], 0.0);
    }
}
