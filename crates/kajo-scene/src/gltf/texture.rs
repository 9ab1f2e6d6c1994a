//! Textures of glTF: which image, and how it is sampled.

use serde::Deserialize;

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Texture {
    source: Option<usize>,
    pub sampler: Option<usize>,
    extensions: TextureExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct TextureExtensions {
    #[serde(rename = "KHR_texture_basisu")]
    basisu: Option<OtherSource>,
    #[serde(rename = "EXT_texture_webp")]
    webp: Option<OtherSource>,
    #[serde(rename = "EXT_texture_avif")]
    avif: Option<OtherSource>,
}

#[derive(Debug, Deserialize)]
struct OtherSource {
    source: usize,
}

impl Texture {
    /// Its image: one in PNG or JPEG where there is a choice.
    pub fn source(&self) -> Option<usize> {
        let TextureExtensions { basisu, webp, avif } = &self.extensions;
        let others = [webp, basisu, avif].into_iter().flatten().map(|other| other.source);
        self.source.into_iter().chain(others).next()
    }
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub(super) struct Sampler {
    pub wrap_s: Option<u32>,
    pub wrap_t: Option<u32>,
    pub mag_filter: Option<u32>,
    pub min_filter: Option<u32>,
}
