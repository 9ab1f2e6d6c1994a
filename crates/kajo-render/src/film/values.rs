//! What a sample brings to the filtered layers of a film.

use kajo_core::light::MAX_LIGHT_GROUPS;
use kajo_math::Vec3;

use super::{FilmSpec, Layer};
use crate::{Auxiliary, PixelSample};

/// Most channels that the filtered layers can have together.
pub(crate) const MAX_CHANNELS: usize = 19 + 3 * MAX_LIGHT_GROUPS;

/// The values of a sample for the filtered layers of a film, in their order, written into `values`.
///
/// Returns how many there are.
#[inline]
pub(crate) fn filtered_values(
    spec: &FilmSpec,
    sample: &PixelSample,
    aux: &Auxiliary,
    values: &mut [f32; MAX_CHANNELS],
) -> usize {
    if spec.layers.filters_color_alone() {
        [values[0], values[1], values[2]] = sample.radiance;
        return 3;
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
            Layer::Color => put(&sample.radiance),
            Layer::DepthMap => put(&[hit.map_or(0.0, |hit| spec.depth_map.value(hit.t))]),
            Layer::NormalMap => put(&spec.normal_map.value(normal).to_array()),
            Layer::Normal => put(&normal.to_array()),
            Layer::Uv => put(&hit.map_or([0.0; 2], |hit| hit.uv.to_array())),
            Layer::Albedo => put(&aux.albedo),
            Layer::Motion => put(&aux.motion),
            Layer::LostRays => put(&[aux.lost]),
            Layer::CacheRecords => put(&[aux.record]),
            Layer::Light(group) => put(&aux.lights[usize::from(group)]),
            Layer::Depth | Layer::ObjectId | Layer::MaterialId => {}
            Layer::SampleCount | Layer::Variance => {}
        }
    }
    n
}

#[cfg(test)]
mod tests {
    use kajo_math::Vec2;

    use super::*;
    use crate::{DepthMap, FirstHit, LayerSet};

    #[test]
    fn there_is_room_for_all_filtered_layers() {
        let all = LayerSet::of(&Layer::ALL);
        assert_eq!(all.filtered().map(Layer::channels).sum::<usize>(), MAX_CHANNELS);
    }

    #[test]
    fn values_come_in_the_order_of_the_layers() {
        let hit = FirstHit { t: 2.0, n: Vec3::NEG_Z, uv: Vec2::new(0.1, 0.2), object: 1, material: 2 };
        let sample = PixelSample { radiance: [1.0, 2.0, 3.0], first: Some(hit) };
        let mut aux =
            Auxiliary { albedo: [0.6, 0.7, 0.8], motion: [-4.0, 5.0], record: 1.0, ..Auxiliary::default() };
        aux.lights[2] = [0.5, 1.0, 1.5];
        let depth_map = DepthMap { min: 0.0, max: 4.0, far_is_white: false };
        let mut values = [0.0; MAX_CHANNELS];
        let mut values_of = |layers: &[Layer]| {
            let spec = FilmSpec { layers: LayerSet::of(layers), depth_map, ..FilmSpec::new(1, 1) };
            let n = filtered_values(&spec, &sample, &aux, &mut values);
            values[..n].to_vec()
        };
        let all = values_of(&Layer::ALL);
        assert_eq!(all[..12], [1.0, 2.0, 3.0, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0, -1.0, 0.1, 0.2]);
        assert_eq!(all[12..17], [0.6, 0.7, 0.8, -4.0, 5.0]);
        assert_eq!(all[17..19], [0.0, 1.0]);
        assert_eq!(all[19..24], [0.0; 5]);
        assert_eq!(values_of(&[Layer::Light(2)]), [0.5, 1.0, 1.5]);
        assert_eq!(values_of(&[Layer::ObjectId, Layer::Color]), [1.0, 2.0, 3.0]);
        assert_eq!(values_of(&[Layer::Normal]), [0.0, 0.0, -1.0]);
        assert!(values_of(&[Layer::Depth]).is_empty());
    }
}
