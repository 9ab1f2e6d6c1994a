//! Light that joined paths do not find, though merged ones do: caustics that are seen in mirrors, through glass and under water.
//!
//! Two small pictures are made of the same random numbers, by `vcm` with merging and without. Without merging it is `bidirectional`, to the bit, so the two differ by
//! what merging finds alone. With the brightness `v` and `b` of a pixel and the mean `m` of all `v`
//!
//! ```text
//! D = sum of t(v) - t(b)  over  sum of t(v),      t(x) = x / (x + m)
//! ```
//!
//! where `t` keeps single bright samples from deciding. In the gallery `D` is 0.01 to 0.11 where caustics are seen in mirrors or through glass, and below 0.01 elsewhere.

use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_core::scene::Scene;
use kajo_math::Vec2;

use super::vcm;
use super::vcm::VertexMergingSettings;
use crate::{Layer, LayerSet, PixelIntegrator, SampleContext, Setup, Silent};

/// Columns and rows of the pictures, and samples of each of their pixels.
const PICTURE: ([u32; 2], u32) = ([24, 16], 16);

/// Paths from lights for each sample of the pixels.
const LIGHT_PATHS: u32 = 4096;

/// The share `D` of light that merging finds alone.
pub fn share(scene: &Scene) -> f32 {
    let camera = &scene.output.camera;
    let picture = |merging: bool| {
        let settings = VertexMergingSettings { merging, photons: LIGHT_PATHS, ..Default::default() };
        let layers = LayerSet::of(&[Layer::Color]);
        brightness(&*vcm::integrator_of(camera, scene, settings, PICTURE.0, layers))
    };
    let [merged, joined] = [true, false].map(picture);
    let mean = merged.iter().sum::<f32>() / merged.len() as f32;
    let seen = |pixels: &[f32]| pixels.iter().map(|&b| b.max(0.0) / (b.max(0.0) + mean)).sum::<f32>();
    let [merged, joined] = [merged, joined].map(|pixels| seen(&pixels));
    // Not a number, and not above any share, where all is dark.
    (merged - joined) / merged
}

/// The brightness of each pixel, row by row.
fn brightness(integrator: &dyn PixelIntegrator) -> Vec<f32> {
    let ([width, height], samples) = PICTURE;
    let sampler = Sampler::new(SamplerKind::Sobol, samples);
    let setup = Setup { seed: 0, threads: 1, memory: u64::MAX, progress: &Silent };
    let mut ctx = SampleContext::new(&sampler, 0);
    let mut sums = vec![0.0; (width * height) as usize];
    for index in 0..samples {
        let part = integrator.samples_per_state().map(|n| n.part_of(index));
        let state = part.and_then(|k| integrator.with_state(k, &setup).ok());
        let integrator = state.as_ref().map_or(integrator, |state| &*state.integrator);
        for i in 0..width * height {
            let pixel = [i % width, i / width];
            let raster = Vec2::from(pixel.map(|x| x as f32)) + ctx.begin(pixel, index);
            let radiance = integrator.sample(&mut ctx, pixel, raster).radiance;
            sums[i as usize] += radiance.iter().sum::<f32>();
        }
        for splat in ctx.splats.as_slice() {
            let [x, y] = splat.raster.to_array();
            if x >= 0.0 && y >= 0.0 && x < width as f32 && y < height as f32 {
                sums[(x as u32 + y as u32 * width) as usize] += splat.value.iter().sum::<f32>();
            }
        }
        ctx.splats.clear();
    }
    sums
}
