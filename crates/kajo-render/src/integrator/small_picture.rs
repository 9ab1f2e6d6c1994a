//! Small pictures, by which an integrator is chosen.

use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_math::Vec2;

use crate::{PixelIntegrator, SampleContext, Setup, Silent};

/// The sums over `samples` samples of the three channels of each pixel, row by row; random numbers are always the same.
pub fn brightness(integrator: &dyn PixelIntegrator, [width, height]: [u32; 2], samples: u32) -> Vec<f32> {
    let sampler = Sampler::new(SamplerKind::Sobol, samples);
    let setup = Setup { seed: 0, threads: 1, memory: u64::MAX, progress: &Silent };
    let mut ctx = SampleContext::new(&sampler, 0);
    let mut sums = vec![0.0; (width * height) as usize];
    let mut made = None;
    for index in 0..samples {
        let part = integrator.samples_per_state().map(|n| n.part_of(index));
        if made.as_ref().is_none_or(|&(of, _)| of != part) {
            made = Some((part, part.and_then(|k| integrator.with_state(k, &setup).ok())));
        }
        let state = made.as_ref().and_then(|(_, state)| state.as_ref());
        let integrator = state.map_or(integrator, |state| &*state.integrator);
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
