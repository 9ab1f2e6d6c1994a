//! Denoising: a noisy picture, its albedo and normals in, a smooth one out.
//!
//! Two denoisers take the same [`Guided`] picture. [`oidn`] asks the library Intel Open Image Denoise, if it is
//! installed; [`nlm`] is built in and depends on nothing.

pub mod nlm;
pub mod oidn;
mod spikes;

use crate::{Image, ImageError};

/// A picture to be denoised and what guides it. All images have three channels and one size.
#[derive(Clone, Copy, Debug)]
pub struct Guided<'a> {
    /// Light, linear RGB.
    pub color: &'a Image,
    /// Estimated variance of each value of `color`.
    pub variance: &'a Image,
    /// Share of white light that surfaces throw back, in [0, 1].
    pub albedo: &'a Image,
    /// Normals of surfaces, zero where there are none.
    pub normal: &'a Image,
}

impl Guided<'_> {
    /// Makes sure that the images fit together.
    ///
    /// # Errors
    /// [`ImageError::Parameter`] when one has another size or number of channels.
    fn check(&self) -> Result<(), ImageError> {
        let size = (self.color.width(), self.color.height(), 3);
        for (name, image) in [
            ("light", self.color),
            ("variance", self.variance),
            ("albedo", self.albedo),
            ("normals", self.normal),
        ] {
            if (image.width(), image.height(), image.channels()) != size {
                return Err(ImageError::parameter(format!("the {name} to denoise with are not of one size")));
            }
        }
        Ok(())
    }
}
