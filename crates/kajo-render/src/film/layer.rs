//! What a picture can show beside colour.
//!
//! Two kinds of layer exist. *Filtered* ones are averages of a value of each sample, weighted by the
//! filter as colours are: colour, the depth map, normals, uv. (So a map is the average of the samples'
//! maps, not the map of the averages.) *Own* ones look only at the samples taken for the pixel, since a
//! weighted mean of distances with negative lobes, or of numbers of objects, would mean nothing.

use kajo_core::light::MAX_LIGHT_GROUPS;
use kajo_math::Vec3;

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
    /// Share of white light that the first surface throws back; see [`Auxiliary::albedo`](crate::Auxiliary::albedo). Filtered.
    Albedo,
    /// Motion in the picture in pixels; see [`Auxiliary::motion`](crate::Auxiliary::motion). Filtered.
    Motion,
    /// Estimated variance of the mean of the pixel's own samples, `(Σv²/n - (Σv/n)²)/(n - 1)`, for each of
    /// red, green and blue; 0 where fewer than two samples were taken. Own.
    Variance,
    /// Rays of a sample that were given up in bodies that bend light; see [`RayCounters::lost`](crate::RayCounters::lost). Filtered.
    LostRays,
    /// Whether the sample looks at the dot of a record of an irradiance cache, 1 or 0; see
    /// [`Auxiliary::record`](crate::Auxiliary::record). Filtered.
    CacheRecords,
    /// Radiance from one group of lights, counted from 0 and below [`MAX_LIGHT_GROUPS`]. Filtered.
    Light(u8),
}

impl Layer {
    /// Every layer, in the order in which films store them.
    pub const ALL: [Layer; 14 + MAX_LIGHT_GROUPS] = {
        let mut all = [Layer::Light(0); 14 + MAX_LIGHT_GROUPS];
        let named = [
            Layer::Color,
            Layer::DepthMap,
            Layer::NormalMap,
            Layer::Normal,
            Layer::Uv,
            Layer::Albedo,
            Layer::Motion,
            Layer::LostRays,
            Layer::CacheRecords,
            Layer::Depth,
            Layer::ObjectId,
            Layer::MaterialId,
            Layer::SampleCount,
            Layer::Variance,
        ];
        let mut i = 0;
        while i < all.len() {
            all[i] = if i < named.len() { named[i] } else { Layer::Light((i - named.len()) as u8) };
            i += 1;
        }
        all
    };

    /// Position in [`Layer::ALL`].
    const fn index(self) -> u32 {
        match self {
            Layer::Color => 0,
            Layer::DepthMap => 1,
            Layer::NormalMap => 2,
            Layer::Normal => 3,
            Layer::Uv => 4,
            Layer::Albedo => 5,
            Layer::Motion => 6,
            Layer::LostRays => 7,
            Layer::CacheRecords => 8,
            Layer::Depth => 9,
            Layer::ObjectId => 10,
            Layer::MaterialId => 11,
            Layer::SampleCount => 12,
            Layer::Variance => 13,
            Layer::Light(group) => 14 + group as u32,
        }
    }

    /// Numbers per pixel.
    pub fn channels(self) -> usize {
        match self {
            Layer::Color | Layer::NormalMap | Layer::Normal => 3,
            Layer::Albedo | Layer::Light(_) | Layer::Variance => 3,
            Layer::Uv | Layer::Motion => 2,
            Layer::DepthMap | Layer::Depth | Layer::LostRays | Layer::CacheRecords => 1,
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
pub struct LayerSet(u32);

impl LayerSet {
    /// The set with these layers.
    pub const fn of(layers: &[Layer]) -> LayerSet {
        let mut bits = 0;
        let mut i = 0;
        while i < layers.len() {
            bits |= 1 << layers[i].index();
            i += 1;
        }
        LayerSet(bits)
    }

    /// This set and one layer more.
    pub const fn with(self, layer: Layer) -> LayerSet {
        LayerSet(self.0 | 1 << layer.index())
    }

    /// Whether a layer is in the set.
    #[inline]
    pub const fn has(self, layer: Layer) -> bool {
        self.0 & 1 << layer.index() != 0
    }

    /// The layers of the set, in the order of [`Layer::ALL`].
    pub fn iter(self) -> impl Iterator<Item = Layer> {
        Layer::ALL.into_iter().filter(move |&layer| self.has(layer))
    }

    /// Whether a layer of the set takes its values from [`Auxiliary`](crate::Auxiliary).
    #[inline]
    pub const fn wants_auxiliary(self) -> bool {
        self.0 & AUXILIARY.0 != 0
    }

    /// Whether colour is the only filtered layer of the set.
    #[inline]
    pub(crate) const fn filters_color_alone(self) -> bool {
        self.0 & FILTERED.0 == LayerSet::of(&[Layer::Color]).0
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
const FILTERED: LayerSet = AUXILIARY
    .with(Layer::Color)
    .with(Layer::DepthMap)
    .with(Layer::NormalMap)
    .with(Layer::Normal)
    .with(Layer::Uv);

/// The layers whose values are in [`Auxiliary`](crate::Auxiliary).
const AUXILIARY: LayerSet = {
    let mut set = LayerSet::of(&[Layer::Albedo, Layer::Motion, Layer::LostRays, Layer::CacheRecords]);
    let mut group = 0;
    while group < MAX_LIGHT_GROUPS {
        set = set.with(Layer::Light(group as u8));
        group += 1;
    }
    set
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_hold_what_was_put_in() {
        let set = LayerSet::of(&[Layer::Uv, Layer::Color]);
        assert_eq!(set.iter().collect::<Vec<_>>(), [Layer::Color, Layer::Uv]);
        assert!(!set.has(Layer::Depth) && set.with(Layer::Depth).has(Layer::Depth));
        let all = LayerSet::of(&Layer::ALL);
        assert_eq!(all.iter().count(), Layer::ALL.len());
        assert!(all.wants_auxiliary() && !set.with(Layer::Variance).wants_auxiliary());
        for (i, layer) in (0..).zip(Layer::ALL) {
            assert_eq!(layer.index(), i);
        }
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
}
