//! Light that joined paths do not find, though merged ones do: caustics that are seen in mirrors, through glass and under water.
//!
//! Two small pictures are made of the same random numbers, by `vcm` with merging and without. Without merging it is
//! `bidirectional`, to the bit, so the two differ by what merging finds alone. With the brightness `v` and `b` of a
//! pixel and the mean `m` of all `v`
//!
//! ```text
//! D = sum of t(v) - t(b)  over  sum of t(v),      t(x) = x / (x + m)
//! ```
//!
//! where `t` keeps single bright samples from deciding. In the gallery `D` is 0.01 to 0.11 where caustics are seen in
//! mirrors or through glass, and below 0.01 elsewhere.

use kajo_core::scene::Scene;

use super::vcm::VertexMergingSettings;
use super::{small_picture, vcm};
use crate::{Layer, LayerSet};

/// Columns and rows of the pictures, and samples of each of their pixels.
const SIZE: [u32; 2] = [24, 16];
const SAMPLES: u32 = 16;

/// Paths from lights for each sample of the pixels.
const LIGHT_PATHS: u32 = 4096;

/// The share `D` of light that merging finds alone.
pub fn share(scene: &Scene) -> f32 {
    let camera = &scene.output.camera;
    let picture = |merging: bool| {
        let settings = VertexMergingSettings { merging, photons: LIGHT_PATHS, ..Default::default() };
        let layers = LayerSet::of(&[Layer::Color]);
        small_picture::brightness(&*vcm::integrator_of(camera, scene, settings, SIZE, layers), SIZE, SAMPLES)
    };
    let [merged, joined] = [true, false].map(picture);
    let mean = merged.iter().sum::<f32>() / merged.len() as f32;
    let seen = |pixels: &[f32]| pixels.iter().map(|&b| b.max(0.0) / (b.max(0.0) + mean)).sum::<f32>();
    let [merged, joined] = [merged, joined].map(|pixels| seen(&pixels));
    // Not a number, and not above any share, where all is dark.
    (merged - joined) / merged
}
