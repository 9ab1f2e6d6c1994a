//! Colours by a number: ramps.
//!
//! Where a number varies within a [footprint](super::FilteredNumber), a ramp answers with the mean of its linear light over these numbers, by
//! integrals between its stops: a stop that is sharp is as smooth in the picture as the samples of a pixel would make it.

use std::sync::Arc;

use kajo_color::{Spectrum, Wavelengths, oklab};
use kajo_math::Vec3;

use super::filtered::{HeldBox, NARROW};
use super::integral::Integral;
use super::rgb::rgb_reflectance;
use super::{
    AnyTexture, ColorNode, FilteredNumber, FloatNode, FloatTexture, Interpolation, Knots, TextureContext,
    TextureDetail, TextureSlope, Textures,
};

/// A place in the period of a ramp: `frequency t + phase`, of which the fraction counts unless both have their defaults.
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

    /// The mean of a function of the place in the period, where the number is anything between two bounds.
    ///
    /// * `bounds`: the first less than the second
    /// * `integral`: of the function, which is as well handed in itself
    fn mean<const N: usize>(
        self,
        [lo, hi]: [f64; 2],
        integral: &Integral<N>,
        f: impl Fn(f32) -> [f32; N],
    ) -> [f64; N] {
        let over = |lo: f64, hi: f64| integral.over(lo, hi, &f);
        if self == Cycle::default() {
            return over(lo, hi).map(|sum| sum / (hi - lo));
        }
        let place = |t: f64| f64::from(self.frequency) * t + f64::from(self.phase);
        let (a, b) = (place(lo), place(hi));
        let (lo, hi) = (a.min(b), a.max(b));
        let (first, last) = (lo.floor(), hi.floor());
        if hi - lo < NARROW {
            return f((lo - first) as f32).map(f64::from);
        }
        let sum = if first == last {
            over(lo - first, hi - first)
        } else {
            let (head, whole, tail) = (over(lo - first, 1.0), over(0.0, 1.0), over(0.0, hi - last));
            std::array::from_fn(|i| head[i] + (last - first - 1.0) * whole[i] + tail[i])
        };
        sum.map(|sum| sum / (hi - lo))
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
    /// Of linear sRGB.
    integral: Integral<3>,
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
        let knots = Knots::new(stops, interpolation)?;
        let places = if is_oklab { knots.breakpoints(PARTS) } else { knots.breakpoints(1) };
        let integral = Integral::new(places, |t| rgb_of(knots.at(t), is_oklab));
        Some(Colors { knots, is_oklab, integral })
    }

    /// Linear sRGB at a place, in [0, 1].
    pub fn at(&self, t: f32) -> [f32; 3] {
        self.rgb(self.knots.at(t))
    }

    fn rgb(&self, own: [f32; 3]) -> [f32; 3] {
        rgb_of(own, self.is_oklab)
    }

    /// The mean of linear sRGB over the numbers of a footprint.
    fn mean(&self, numbers: &HeldBox, cycle: Cycle) -> [f32; 3] {
        numbers
            .mean_of(|t| self.at(cycle.at(t)), |lo, hi| cycle.mean([lo, hi], &self.integral, |t| self.at(t)))
    }
}

/// In how many parts an interval between two colours of Oklab is integrated: what is between may leave the gamut, and be held to it, within one.
const PARTS: usize = 16;

/// Linear sRGB of a colour of a ramp, held to [0, 1].
fn rgb_of(own: [f32; 3], is_oklab: bool) -> [f32; 3] {
    let rgb = if is_oklab { oklab::to_rgb(own) } else { own };
    rgb.map(|v| v.clamp(0.0, 1.0))
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
        let number = self.texture.filtered(textures.evaluator(at));
        let rgb = match number.varies() {
            true => self.colors.mean(&number.numbers(), self.cycle),
            false => self.colors.at(self.cycle.at(number.mean)),
        };
        rgb_reflectance(rgb, wavelengths)
    }

    fn color_is_filtered(&self, textures: &Textures) -> bool {
        self.texture.is_filtered(textures)
    }

    fn color_mean(&self, _textures: &Textures) -> [f32; 3] {
        self.colors.rgb(self.colors.knots.mean())
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

    fn color_is_filtered(&self, textures: &Textures) -> bool {
        self.value.is_filtered(textures)
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

    fn is_filtered(&self, textures: &Textures) -> bool {
        self.0.is_filtered(textures)
    }

    /// By differences; what a filter took away from a colour is not known.
    fn filtered(&self, textures: &Textures, at: &TextureContext) -> FilteredNumber {
        let value = |at: &TextureContext| self.value(textures, at);
        if self.is_filtered(textures) {
            FilteredNumber::by_differences(at, 0.0, value)
        } else {
            FilteredNumber::point(value(at))
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    const STOPS: [(f32, [f32; 3]); 5] = [
        (0.1, [0.9, 0.1, 0.0]),
        (0.3, [0.0, 0.2, 1.0]),
        (0.3, [1.0, 1.0, 0.0]),
        (0.35, [0.0, 0.4, 0.1]),
        (0.9, [0.3, 0.0, 0.9]),
    ];

    fn ramps() -> [Colors; 4] {
        let of = |interpolation, is_oklab| Colors::new(STOPS.to_vec(), interpolation, is_oklab).unwrap();
        [
            of(Interpolation::Linear, false),
            of(Interpolation::Smooth, false),
            of(Interpolation::Step, false),
            of(Interpolation::Linear, true),
        ]
    }

    fn cycles() -> [Cycle; 4] {
        [(1.0, 0.0), (1.0, 0.3), (-3.7, 0.2), (0.0, 0.6)].map(|(frequency, phase)| Cycle { frequency, phase })
    }

    /// By many points.
    fn averaged(colors: &Colors, cycle: Cycle, numbers: &HeldBox) -> [f64; 3] {
        const PLACES: u32 = 100_000;
        let ([zero, one], [lo, hi]) = (numbers.ends, numbers.bounds);
        let at = |t: f64| colors.at(cycle.at(t as f32)).map(f64::from);
        let mut sum = [0.0; 3];
        let mut add = |rgb: [f64; 3], share: f64| (0..3).for_each(|i| sum[i] += share * rgb[i]);
        add(at(0.0), zero);
        add(at(1.0), one);
        for i in 0..PLACES {
            let t = lo + (hi - lo) * (f64::from(i) + 0.5) / f64::from(PLACES);
            add(at(t), (1.0 - zero - one) / f64::from(PLACES));
        }
        sum
    }

    #[test]
    fn ramps_average_over_the_numbers_of_a_footprint() {
        for (colors, cycle) in ramps().iter().flat_map(|colors| cycles().map(|cycle| (colors, cycle))) {
            for (mean, variance) in [
                (0.5, 1.0 / 12.0),
                (0.3, 1e-4),
                (0.32, 1e-3),
                (0.2, 0.05),
                (0.9, 0.02),
                (0.6, 0.2),
                (0.4, 1e-7),
            ] {
                let numbers = HeldBox::new(mean, variance);
                let (found, expected) = (colors.mean(&numbers, cycle), averaged(colors, cycle, &numbers));
                for (found, expected) in found.into_iter().zip(expected) {
                    assert!(
                        (f64::from(found) - expected).abs() < 1e-4,
                        "{colors:?} {cycle:?} {mean} {variance}: {found} {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_narrow_footprint_has_the_colour_of_its_point() {
        for (colors, cycle) in ramps().iter().flat_map(|colors| cycles().map(|cycle| (colors, cycle))) {
            for t in [0.0, 0.07, 0.2, 0.33, 0.65, 1.0] {
                let found = colors.mean(&HeldBox::new(t, 1e-13), cycle);
                let expected = colors.at(cycle.at(t));
                let off = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
                assert!(off < 1e-4, "{cycle:?} {t}: {found:?} {expected:?}");
            }
        }
    }

    /// Seen from afar a ramp that is run through often is as bright as all of it.
    #[test]
    fn a_wide_footprint_has_the_mean_of_the_ramp() {
        for colors in ramps() {
            let cycle = Cycle { frequency: 64.0, phase: 0.1 };
            let found = colors.mean(&HeldBox::new(0.5, 0.02), cycle);
            let whole = colors.integral.over(0.0, 1.0, |t| colors.at(t));
            assert!((0..3).all(|i| (f64::from(found[i]) - whole[i]).abs() < 0.02), "{found:?} {whole:?}");
        }
    }
}
