//! A picture in the making, as it was when a pass ended.

use std::sync::Arc;

use kajo_image::{BitDepth, Format, Image, ImageError};
use kajo_render::{ClampedLight, Film, Layer, RenderStats};

use crate::view::{self, Look};
use crate::{Development, RenderSettings, View};

/// A picture with all its views.
///
/// The light is that at the end of a pass. Other views, and files, are developed when they are asked for: while the
/// same picture is still being rendered they may hold some samples more.
#[derive(Debug)]
pub struct Frame {
    job: u64,
    film: Arc<Film>,
    groups: Arc<[String]>,
    light: Image,
    r_hat: Option<f64>,
    clamped: Option<ClampedLight>,
    settings: RenderSettings,
    full_size: [u32; 2],
    samples: u32,
    stats: RenderStats,
}

impl Frame {
    /// `None` when there is no memory for it.
    pub(super) fn new(
        job: u64,
        film: Arc<Film>,
        groups: Arc<[String]>,
        settings: RenderSettings,
        full_size: [u32; 2],
        samples: u32,
        stats: RenderStats,
    ) -> Option<Frame> {
        let light = film.develop(Layer::Color)?;
        let (r_hat, clamped) = (film.r_hat(), film.clamped());
        Some(Frame { job, film, groups, light, r_hat, clamped, settings, full_size, samples, stats })
    }

    /// The number of the job it belongs to; see [`super::Session::start`].
    pub fn job(&self) -> u64 {
        self.job
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        self.settings.size
    }

    /// Columns and rows of the picture that the job asks for.
    pub fn full_size(&self) -> [u32; 2] {
        self.full_size
    }

    /// Samples of each pixel; 0 in a coarse picture.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Rays, samples, threads; seconds since the job was begun.
    pub fn stats(&self) -> RenderStats {
        self.stats
    }

    /// Rays per second.
    pub fn rays_per_second(&self) -> f64 {
        self.stats.rays.total() as f64 / self.stats.seconds.max(1e-9)
    }

    /// Memory that it takes, about; as much as a film of its size and views.
    pub fn bytes(&self) -> u64 {
        let light = 4 * self.light.data().len() as u128;
        u64::try_from(self.film.spec().bytes() + light).unwrap_or(u64::MAX)
    }

    /// Estimated relative error of the light over the whole picture, where [`View::Variance`] was asked for.
    pub fn noise(&self) -> Option<f64> {
        self.film.noise()
    }

    /// How far groups of Markov chains are from agreeing, where there are any; see [`Picture::r_hat`](crate::Picture::r_hat).
    pub fn r_hat(&self) -> Option<f64> {
        self.r_hat
    }

    /// What `clamp` has taken away of the light, where that is asked for; see [`Picture::clamped`](crate::Picture::clamped).
    pub fn clamped(&self) -> Option<ClampedLight> {
        self.clamped
    }

    /// How it was rendered.
    pub fn settings(&self) -> &RenderSettings {
        &self.settings
    }

    /// The light, linear RGB, row 0 on top.
    pub fn light(&self) -> &Image {
        &self.light
    }

    /// The views that it has: those that the job asked for, and the light.
    pub fn views(&self) -> Vec<View> {
        View::ALL.into_iter().filter(|&view| self.has(view)).collect()
    }

    /// Whether it has a view. Every frame has the light; coarse ones lack what their job did not ask of them.
    pub fn has(&self, view: View) -> bool {
        let layers = self.film.spec().layers;
        [Format::Png, Format::Exr].iter().all(|&format| layers.has(view.layer(format, &self.settings)))
    }

    /// The numbers of a view, as OpenEXR files hold them; one to three channels.
    ///
    /// # Errors
    /// When the job did not ask for the view, or there is no memory for it.
    pub fn numbers(&self, view: View) -> Result<Image, ImageError> {
        match view {
            View::Color => Ok(self.light.clone()),
            _ => view::develop(&self.film, view.layer(Format::Exr, &self.settings)),
        }
    }

    /// The numbers of a view at one pixel, those that it does not have as zeros; `None` outside of the picture, and
    /// where the job did not ask for the view.
    pub fn value(&self, view: View, x: u32, y: u32) -> Option<[f32; 3]> {
        self.film.value(view.layer(Format::Exr, &self.settings), x, y)
    }

    /// A view to look at: `height x width x 4` bytes, the last of four 255, as in a PNG file of it.
    ///
    /// * `development`: how light becomes values; the exposure of a window, not of the scene
    ///
    /// # Errors
    /// As [`Frame::numbers`].
    pub fn rgba(&self, view: View, development: &Development) -> Result<Vec<u8>, ImageError> {
        let image = match view {
            View::Color => {
                let mut light = self.light.clone();
                development.apply(&mut light, Format::Png);
                light
            }
            _ => view::picture(&self.film, view, Format::Png, &self.settings)?,
        };
        let quantiser = view::quantiser(&self.settings);
        let byte = |value: f32| quantiser.colour(value, BitDepth::Eight) as u8;
        let mut bytes = Vec::with_capacity(4 * image.data().len() / image.channels());
        for pixel in image.pixels() {
            let [r, g, b] = match *pixel {
                [r, g, b, ..] => [r, g, b],
                [grey, ..] => [grey; 3],
                [] => [0.0; 3],
            };
            bytes.extend([byte(r), byte(g), byte(b), 255]);
        }
        Ok(bytes)
    }

    /// The bytes of a file that shows `views`, as [`Picture::encode`](crate::Picture::encode) has them.
    ///
    /// # Errors
    /// When a view was not asked for, or the format cannot hold the picture.
    pub fn encode(
        &self,
        views: &[View],
        format: Format,
        depth: BitDepth,
        development: &Development,
    ) -> Result<Vec<u8>, ImageError> {
        let look = Look { development, light: None, groups: &self.groups, quick: false };
        view::encode(&self.film, views, format, depth, &self.settings, &look)
    }
}
