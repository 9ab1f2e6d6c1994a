//! Colours and numbers by another number: ramps and curves.

use std::sync::Arc;

use kajo_color::{Spectrum, Wavelengths, oklab};
use kajo_math::Vec3;

use super::rgb::rgb_reflectance;
use super::{
    AnyTexture, ColorNode, FloatNode, FloatTexture, Interpolation, Knots, TextureContext, TextureDetail,
    TextureSlope, Textures,
};

/// A place in the period of a ramp: `frequency t + phase`, of which the fraction counts unless both say nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cycle {
    /// How often the ramp is run through while the number goes from 0 to 1.
    pub frequency: f32,
    /// Where it begins.
    pub phase: f32,
}

impl Default for Cycle {
    fn default() -> Cycle {
        Cycle { frequency: 1.0, phase: 0.0 }
    }
}

impl Cycle {
    fn at(self, t: f32) -> f32 {
        if self == Cycle::default() {
            return t;
        }
        let t = self.frequency * t + self.phase;
        t - t.floor()
    }

    fn is_finite(self) -> bool {
        self.frequency.is_finite() && self.phase.is_finite()
    }
}

/// The colours of a ramp.
#[derive(Clone, Debug)]
pub struct Colors {
    /// Linear sRGB, or Oklab.
    knots: Knots<3>,
    is_oklab: bool,
}

impl Colors {
    /// Colours between which is what is between their components.
    ///
    /// * `stops`: places with linear sRGB in [0, 1], none before another
    /// * `is_oklab`: whether the components are those of Oklab
    ///
    /// `None` as [`Knots::new`].
    pub fn new(stops: Vec<(f32, [f32; 3])>, interpolation: Interpolation, is_oklab: bool) -> Option<Colors> {
        let own = |rgb| if is_oklab { oklab::from_rgb(rgb) } else { rgb };
        let stops = stops.into_iter().map(|(at, rgb)| (at, own(rgb))).collect();
        Some(Colors { knots: Knots::new(stops, interpolation)?, is_oklab })
    }

    /// Linear sRGB at a place, in [0, 1].
    pub fn at(&self, t: f32) -> [f32; 3] {
        self.rgb(self.knots.at(t))
    }

    fn rgb(&self, own: [f32; 3]) -> [f32; 3] {
        let rgb = if self.is_oklab { oklab::to_rgb(own) } else { own };
        rgb.map(|v| v.clamp(0.0, 1.0))
    }
}

/// Colours by a number.
#[derive(Clone, Debug)]
pub struct Ramp {
    /// The number.
    pub texture: FloatTexture,
    /// How often the ramp is run through.
    pub cycle: Cycle,
    /// The colours.
    pub colors: Arc<Colors>,
}

impl ColorNode for Ramp {
    fn is_finite(&self) -> bool {
        self.cycle.is_finite()
    }

    fn parts(&self) -> Vec<AnyTexture<'_>> {
        vec![self.texture.into()]
    }

    fn color_needs_uv(&self, textures: &Textures) -> bool {
        self.texture.needs_uv(textures)
    }

    fn color_detail(&self, textures: &Textures, found: &mut TextureDetail) {
        self.texture.detail(textures, found);
        found.jumps = true;
    }

    fn reflectance(&self, textures: &Textures, at: &TextureContext, wavelengths: &Wavelengths) -> Spectrum {
        let t = self.cycle.at(self.texture.at(textures.evaluator(at)));
        rgb_reflectance(self.colors.at(t), wavelengths)
    }

    fn color_mean(&self, _textures: &Textures) -> [f32; 3] {
        self.colors.rgb(self.colors.knots.mean())
    }
}

/// Numbers by a number.
#[derive(Clone, Debug)]
pub struct Curve {
    /// The number.
    pub texture: FloatTexture,
    /// The curve, with numbers in [0, 1].
    pub knots: Arc<Knots<1>>,
}

impl FloatNode for Curve {
    fn is_finite(&self) -> bool {
        true
    }

    fn part(&self) -> Option<FloatTexture> {
        Some(self.texture)
    }

    fn value(&self, textures: &Textures, at: &TextureContext) -> f32 {
        self.knots.at(self.texture.at(textures.evaluator(at)))[0]
    }

    fn slope(&self, textures: &Textures, at: &TextureContext, factor: f32) -> TextureSlope {
        let evaluator = textures.evaluator(at);
        let [slope] = self.knots.slope(self.texture.at(evaluator));
        self.texture.slope(evaluator, factor * slope)
    }

    fn detail(&self, textures: &Textures, found: &mut TextureDetail) {
        self.texture.detail(textures, found);
        found.jumps = true;
    }

    fn mean(&self, _textures: &Textures) -> f32 {
        self.knots.mean()[0]
    }
}

/// A number as a grey.
#[derive(Clone, Copy, Debug)]
pub struct Grey {
    /// The number.
    pub value: FloatTexture,
    /// The largest that it may be; 1 for a reflectance, more for a factor of light.
    pub most: f32,
}

impl Grey {
    /// The grey of a reflectance.
    pub fn reflectance(value: FloatTexture) -> Grey {
        Grey { value, most: 1.0 }
    }
}

impl ColorNode for Grey {
    fn is_finite(&self) -> bool {
        self.most >= 0.0 && self.most.is_finite()
    }

    fn parts(&self) -> Vec<AnyTexture<'_>> {
        vec![self.value.into()]
    }

    fn color_needs_uv(&self, textures: &Textures) -> bool {
        self.value.needs_uv(textures)
    }

    fn color_detail(&self, textures: &Textures, found: &mut TextureDetail) {
        self.value.detail(textures, found);
    }

    fn reflectance(&self, textures: &Textures, at: &TextureContext, wavelengths: &Wavelengths) -> Spectrum {
        let value = self.value.at(textures.evaluator(at)).clamp(0.0, self.most);
        rgb_reflectance([value; 3], wavelengths)
    }

    fn color_mean(&self, textures: &Textures) -> [f32; 3] {
        [self.value.mean(textures); 3]
    }
}

/// How light a colour is: its luminance by that of white.
#[derive(Clone, Debug)]
pub struct Lightness(pub super::ColorTexture);

/// Luminances of the primaries of sRGB.
const LUMINANCES: Vec3 = Vec3::new(0.212_639, 0.715_168_7, 0.072_192_3);

impl FloatNode for Lightness {
    fn is_finite(&self) -> bool {
        true
    }

    fn parts(&self) -> Vec<AnyTexture<'_>> {
        vec![(&self.0).into()]
    }

    fn needs_uv(&self, textures: &Textures) -> bool {
        self.0.needs_uv(textures)
    }

    fn detail(&self, textures: &Textures, found: &mut TextureDetail) {
        self.0.detail(textures, found);
    }

    fn value(&self, textures: &Textures, at: &TextureContext) -> f32 {
        LUMINANCES.dot(self.0.rgb(textures.evaluator(at)).to_rgb().into())
    }

    /// By differences over a small part of both coordinates of the surface and of a unit of space.
    fn slope(&self, textures: &Textures, at: &TextureContext, factor: f32) -> TextureSlope {
        let value = |at: &TextureContext| self.value(textures, at);
        let space = TextureSlope::over(at, 1.0 / 256.0, factor, value);
        space.plus(TextureSlope::on_surface(at, 1.0 / 512.0, factor, value))
    }

    fn mean(&self, textures: &Textures) -> f32 {
        LUMINANCES.dot(self.0.mean(textures).into())
    }
}
