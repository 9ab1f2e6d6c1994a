//! What a picture can show beside colour.
//!
//! Two kinds of layer exist. *Filtered* ones are averages of a value of each sample, weighted by the
//! filter as colours are: colour, the depth map, normals, uv. (So a map is the average of the samples'
//! maps, not the map of the averages.) *Own* ones look only at the samples taken for the pixel, since a
//! weighted mean of distances with negative lobes, or of numbers of objects, would mean nothing.

use kajo_math::Vec3;

use super::spec::FilmSpec;
use crate::PixelSample;

/// One output of a render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// Radiance, linear RGB. Filtered.
    Color,
    /// Distance squeezed into [0, 1] by a [`DepthMap`]; 0 for misses. Filtered.
    DepthMap,
    /// Mean ray parameter of the samples that hit something; infinity where none did. Own.
    Depth,
    /// Normal as a colour, by a [`NormalMap`]. Filtered.
    NormalMap,
    /// World space unit normal, zero for misses. Filtered, so shorter than 1 where normals differ.
    Normal,
    /// Parameters of the surface, zero for misses. Filtered.
    Uv,
    /// Number of the object that the pixel's first sample hit; 0 for a miss. Own.
    ObjectId,
    /// Number of the material that the pixel's first sample hit; 0 for a miss. Own.
    MaterialId,
    /// Samples taken for the pixel. Own.
    SampleCount,
}

impl Layer {
    /// Every layer, in the order in which films store them.
    pub const ALL: [Layer; 9] = [
        Layer::Color,
        Layer::DepthMap,
        Layer::NormalMap,
        Layer::Normal,
        Layer::Uv,
        Layer::Depth,
        Layer::ObjectId,
        Layer::MaterialId,
        Layer::SampleCount,
    ];

    /// Numbers per pixel.
    pub fn channels(self) -> usize {
        match self {
            Layer::Color | Layer::NormalMap | Layer::Normal => 3,
            Layer::Uv => 2,
            Layer::DepthMap | Layer::Depth => 1,
            Layer::ObjectId | Layer::MaterialId | Layer::SampleCount => 1,
        }
    }

    /// Whether the layer is an average over the filter's support.
    pub fn is_filtered(self) -> bool {
        FILTERED.has(self)
    }
}

/// A set of layers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LayerSet(u16);

impl LayerSet {
    /// The set with these layers.
    pub const fn of(layers: &[Layer]) -> LayerSet {
        let mut bits = 0;
        let mut i = 0;
        while i < layers.len() {
            bits |= 1 << layers[i] as u16;
            i += 1;
        }
        LayerSet(bits)
    }

    /// This set and one layer more.
    pub const fn with(self, layer: Layer) -> LayerSet {
        LayerSet(self.0 | 1 << layer as u16)
    }

    /// Whether a layer is in the set.
    #[inline]
    pub const fn has(self, layer: Layer) -> bool {
        self.0 & 1 << layer as u16 != 0
    }

    /// The layers of the set, in the order of [`Layer::ALL`].
    pub fn iter(self) -> impl Iterator<Item = Layer> {
        Layer::ALL.into_iter().filter(move |&layer| self.has(layer))
    }

    /// The filtered layers of the set.
    pub(crate) fn filtered(self) -> impl Iterator<Item = Layer> {
        self.iter().filter(|layer| layer.is_filtered())
    }
}

/// How a distance becomes a grey value.
///
/// With `x = clamp((t - min) / (max - min), 0, 1)` the value is `1 - x`, or `x` when far is white;
/// `max < min` works as the formula says and `max = min` gives black.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthMap {
    /// Distance at one end of the scale.
    pub min: f32,
    /// Distance at the other end.
    pub max: f32,
    /// White at `max` and beyond (dialect mit-a2) rather than at `min` and nearer.
    pub far_is_white: bool,
}

impl Default for DepthMap {
    fn default() -> DepthMap {
        DepthMap { min: 0.0, max: 1.0, far_is_white: false }
    }
}

impl DepthMap {
    /// Grey value of a hit at `t`.
    #[inline]
    pub fn value(&self, t: f32) -> f32 {
        if self.max == self.min {
            return 0.0;
        }
        let x = ((t - self.min) / (self.max - self.min)).clamp(0.0, 1.0);
        if self.far_is_white { x } else { 1.0 - x }
    }
}

/// How a normal becomes a colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NormalMap {
    /// Absolute values of the components; black for a miss.
    #[default]
    Absolute,
    /// `(n + 1)/2`, grey ½ for a miss (dialect mit-a2).
    Biased,
}

impl NormalMap {
    /// Colour of a normal; a miss has the normal zero.
    #[inline]
    pub fn value(self, n: Vec3) -> Vec3 {
        match self {
            NormalMap::Absolute => n.abs(),
            NormalMap::Biased => (n + 1.0) * 0.5,
        }
    }
}

/// The filtered layers.
const FILTERED: LayerSet =
    LayerSet::of(&[Layer::Color, Layer::DepthMap, Layer::NormalMap, Layer::Normal, Layer::Uv]);

/// Most channels that the filtered layers can have together.
pub(crate) const MAX_CHANNELS: usize = 12;

/// The values of a sample for the filtered layers of a film, in their order, written into `values`.
#[inline]
pub(crate) fn filtered_values<'a>(
    spec: &FilmSpec,
    sample: &PixelSample,
    values: &'a mut [f32; MAX_CHANNELS],
) -> &'a [f32] {
    let [r, g, b] = sample.radiance.to_rgb();
    if spec.layers.0 & FILTERED.0 == LayerSet::of(&[Layer::Color]).0 {
        [values[0], values[1], values[2]] = [r, g, b];
        return &values[..3];
    }
    let mut n = 0;
    let mut put = |channels: &[f32]| {
        values[n..n + channels.len()].copy_from_slice(channels);
        n += channels.len();
    };
    let hit = sample.first.as_ref();
    let normal = hit.map_or(Vec3::ZERO, |hit| hit.n);
    for layer in spec.layers.filtered() {
        match layer {
            Layer::Color => put(&[r, g, b]),
            Layer::DepthMap => put(&[hit.map_or(0.0, |hit| spec.depth_map.value(hit.t))]),
            Layer::NormalMap => put(&spec.normal_map.value(normal).to_array()),
            Layer::Normal => put(&normal.to_array()),
            Layer::Uv => put(&hit.map_or([0.0; 2], |hit| hit.uv.to_array())),
            Layer::Depth | Layer::ObjectId | Layer::MaterialId | Layer::SampleCount => {}
        }
    }
    &values[..n]
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_color::Spectrum;
    use kajo_math::Vec2;

    use crate::FirstHit;

    #[test]
    fn sets_hold_what_was_put_in() {
        let set = LayerSet::of(&[Layer::Uv, Layer::Color]);
        assert_eq!(set.iter().collect::<Vec<_>>(), [Layer::Color, Layer::Uv]);
        assert!(!set.has(Layer::Depth) && set.with(Layer::Depth).has(Layer::Depth));
        let all = LayerSet::of(&Layer::ALL);
        assert_eq!(all.iter().count(), 9);
        assert_eq!(all.filtered().map(Layer::channels).sum::<usize>(), MAX_CHANNELS);
    }

    #[test]
    fn depth_maps_follow_the_formula() {
        let map = |min, max, far_is_white, t| DepthMap { min, max, far_is_white }.value(t);
        assert_eq!(map(9.0, 10.0, false, 9.25), 0.75);
        assert_eq!(map(9.0, 10.0, true, 9.25), 0.25);
        // Nearer than the near end, and behind an orthographic camera.
        assert_eq!((map(9.0, 10.0, false, 1.0), map(9.0, 10.0, false, -5.0)), (1.0, 1.0));
        assert_eq!((map(9.0, 10.0, false, 11.0), map(9.0, 10.0, true, 11.0)), (0.0, 1.0));
        // The range turned round, and an empty one.
        assert_eq!(map(10.0, 9.0, false, 9.25), 0.25);
        assert_eq!((map(3.0, 3.0, false, 3.0), map(3.0, 3.0, true, 9.0)), (0.0, 0.0));
    }

    #[test]
    fn normal_maps_of_hits_and_misses() {
        let n = Vec3::new(-0.5, 0.0, 0.75);
        assert_eq!(NormalMap::Absolute.value(n), Vec3::new(0.5, 0.0, 0.75));
        assert_eq!(NormalMap::Biased.value(n), Vec3::new(0.25, 0.5, 0.875));
        assert_eq!(NormalMap::Absolute.value(Vec3::ZERO), Vec3::ZERO);
        assert_eq!(NormalMap::Biased.value(Vec3::ZERO), Vec3::splat(0.5));
    }

    #[test]
    fn values_come_in_the_order_of_the_layers() {
        let hit = FirstHit { t: 2.0, n: Vec3::NEG_Z, uv: Vec2::new(0.1, 0.2), object: 1, material: 2 };
        let sample = PixelSample { radiance: Spectrum::rgb(1.0, 2.0, 3.0), first: Some(hit) };
        let depth_map = DepthMap { min: 0.0, max: 4.0, far_is_white: false };
        let mut values = [0.0; MAX_CHANNELS];
        let mut values_of = |layers: &[Layer]| {
            let spec = FilmSpec { layers: LayerSet::of(layers), depth_map, ..FilmSpec::new(1, 1) };
            filtered_values(&spec, &sample, &mut values).to_vec()
        };
        assert_eq!(values_of(&Layer::ALL), [1.0, 2.0, 3.0, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0, -1.0, 0.1, 0.2]);
        assert_eq!(values_of(&[Layer::ObjectId, Layer::Color]), [1.0, 2.0, 3.0]);
        assert_eq!(values_of(&[Layer::Normal]), [0.0, 0.0, -1.0]);
        assert_eq!(values_of(&[Layer::Depth]), []);
    }
}
