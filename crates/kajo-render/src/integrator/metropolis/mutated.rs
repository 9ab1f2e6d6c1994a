//! What a chain mutates: whole samples of an integrator, or samples by one technique alone.
//!
//! A whole sample is a function `F(u)` of its numbers. Multiplexed Metropolis light transport [Hachisuka, Kaplanyan and
//! Dachsbacher 2014] splits the light of bidirectional path tracing by the number of vertices `k` of its paths, light
//! and lens counted, each of which has chains of its own: a *class*. Of the `k` techniques, with `s = 0 .. k - 1`
//! vertices from the light, a sample has one, which a number of its own chooses. What the technique finds, `f_s` over
//! its density `p_s`, has its weight `w_s` among all of them, and
//!
//! ```text
//! F_k(u) = k w_s(x) f(x) / p_s(x),    s = floor(k u_0)           [Hachisuka, Kaplanyan and Dachsbacher 2014]
//! ```
//!
//! has the mean of the light of all paths of `k` vertices over the cube of `u`, since each technique has the part `1/k`
//! of the cube and the weights sum to one.

use std::ops::Range;

use kajo_math::Vec2;

use crate::integrator::bidir::{SingleTechnique, VertexCounts};
use crate::{PixelIntegrator, PixelSample, SampleContext};

/// Samples as functions of their numbers.
#[derive(Clone, Copy)]
pub enum Mutated<'a> {
    /// Whole samples, of one class.
    Whole(&'a dyn PixelIntegrator),
    /// Samples by one technique: the class is the number of vertices of the path.
    ByTechnique {
        integrator: &'a dyn SingleTechnique,
        /// Vertices of the longest paths.
        longest: u32,
    },
}

impl Mutated<'_> {
    /// The classes of samples that have chains of their own.
    pub fn classes(&self) -> Range<u32> {
        match *self {
            Mutated::Whole(_) => 0..1,
            Mutated::ByTechnique { longest, .. } => 2..longest + 1,
        }
    }

    /// A sample of a class, and what its light is to be multiplied by.
    ///
    /// * `technique`: chooses the technique
    pub fn sample(
        &self,
        ctx: &mut SampleContext<'_>,
        raster: Vec2,
        class: u32,
        technique: f32,
    ) -> (PixelSample, f32) {
        match self {
            Mutated::Whole(integrator) => (integrator.sample(ctx, [0, 0], raster), 1.0),
            Mutated::ByTechnique { integrator, .. } => {
                let technique = VertexCounts::chosen(class, technique);
                (integrator.sample_by(ctx, raster, technique), class as f32)
            }
        }
    }
}
