//! Channels of pictures as numbers.

use super::{
    ColorNode, FilteredNumber, FloatNode, PictureMap, TextureContext, TextureDetail, TextureSlope, Textures,
};

/// What of a picture is a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Channel {
    /// Red, which in a grey picture is everything.
    #[default]
    Red,
    /// Green.
    Green,
    /// Blue.
    Blue,
    /// How much the picture covers.
    Alpha,
}

/// A channel of a picture.
#[derive(Clone, Debug)]
pub struct PictureChannel {
    /// The picture.
    pub map: PictureMap,
    /// Its channel.
    pub channel: Channel,
}

/// 1 where a channel of a picture is this much or more, and 0 elsewhere.
#[derive(Clone, Debug)]
pub struct PictureCut {
    /// The picture.
    pub map: PictureMap,
    /// Its channel.
    pub channel: Channel,
    /// The least that is not cut away.
    pub least: f32,
}

impl FloatNode for PictureChannel {
    fn is_finite(&self) -> bool {
        self.map.is_finite()
    }

    fn wants_footprint(&self) -> bool {
        self.map.wants_footprint()
    }

    fn is_on_second_set(&self) -> bool {
        self.map.is_on_second_set()
    }

    fn prepare(&self) {
        self.map.prepare();
    }

    #[inline]
    fn value(&self, _textures: &Textures, at: &TextureContext) -> f32 {
        self.map.filtered(at)[self.channel as usize]
    }

    fn is_filtered(&self, _textures: &Textures) -> bool {
        self.map.wants_footprint()
    }

    /// By differences; what the filter took away is not known.
    fn filtered(&self, textures: &Textures, at: &TextureContext) -> FilteredNumber {
        let value = |at: &TextureContext| self.value(textures, at);
        if self.map.wants_footprint() {
            FilteredNumber::by_differences(at, 0.0, value)
        } else {
            FilteredNumber::point(value(at))
        }
    }

    fn slope(&self, _textures: &Textures, at: &TextureContext, factor: f32) -> TextureSlope {
        let uv = self.map.slope(at.uv, factor, |texel| texel[self.channel as usize]);
        TextureSlope { uv, ..TextureSlope::default() }
    }

    fn needs_uv(&self, _textures: &Textures) -> bool {
        true
    }

    fn detail(&self, _textures: &Textures, found: &mut TextureDetail) {
        self.map.shown(found);
    }

    fn mean(&self, _textures: &Textures) -> f32 {
        self.map.means()[self.channel as usize]
    }
}

impl PictureCut {
    /// What is left of a picture that has another factor.
    fn left(&self, at: &TextureContext, cover: f32) -> f32 {
        self.left_of(self.map.at(at.uv), cover)
    }

    fn left_of(&self, texel: [f32; 4], cover: f32) -> f32 {
        f32::from(u8::from(texel[self.channel as usize] * cover >= self.least))
    }
}

impl FloatNode for PictureCut {
    fn is_finite(&self) -> bool {
        self.map.is_finite() && self.least.is_finite()
    }

    fn value(&self, _textures: &Textures, at: &TextureContext) -> f32 {
        self.left(at, 1.0)
    }

    /// The factor counts before anything is cut.
    fn covered(&self, _textures: &Textures, at: &TextureContext) -> f32 {
        self.left(at, at.cover())
    }

    fn slope(&self, _textures: &Textures, at: &TextureContext, factor: f32) -> TextureSlope {
        let uv = self.map.slope(at.uv, factor, |texel| self.left_of(texel, 1.0));
        TextureSlope { uv, ..TextureSlope::default() }
    }

    fn needs_uv(&self, _textures: &Textures) -> bool {
        true
    }

    fn detail(&self, _textures: &Textures, found: &mut TextureDetail) {
        self.map.shown(found);
        found.jumps = true;
    }

    fn mean(&self, _textures: &Textures) -> f32 {
        self.map.means()[self.channel as usize]
    }
}
