//! Denoising of a finished picture.

use std::ffi::OsString;
use std::thread;

use kajo_image::denoise::oidn::{Oidn, OidnError};
use kajo_image::denoise::{Guided, nlm};
use kajo_image::{Format, Image, ImageError};
use kajo_render::{Film, Layer};

use crate::view::{self, View};

/// Which denoiser is asked.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Denoiser {
    /// Intel Open Image Denoise where it is installed, and otherwise the built-in one.
    #[default]
    Best,
    /// Intel Open Image Denoise, in this file or where the system keeps libraries.
    Oidn(Option<OsString>),
    /// Joint non-local means, the same on every machine.
    BuiltIn,
}

/// Why a picture was not denoised.
#[derive(Debug, thiserror::Error)]
pub enum DenoiseError {
    /// The picture was not rendered with what guides a denoiser; see [`DENOISE_OUTPUTS`].
    #[error("the picture has no layer of albedo, normals or variance to denoise it by")]
    NoGuides,
    /// The built-in denoiser goes by how much the samples of a pixel differ.
    #[error(
        "the built-in denoiser goes by how much the samples of a pixel differ, and each has only one; take \
         `--samples 4` or more, or Intel Open Image Denoise"
    )]
    OneSample,
    /// The library did not do it.
    #[error(transparent)]
    Oidn(#[from] OidnError),
    /// No memory, most likely.
    #[error(transparent)]
    Image(#[from] ImageError),
}

/// What a render must be asked for, besides what is to be written, so that its picture can be denoised.
pub const DENOISE_OUTPUTS: [(View, Format); 4] = [
    (View::Color, Format::Exr),
    (View::Albedo, Format::Exr),
    (View::Normals, Format::Exr),
    (View::Variance, Format::Exr),
];

/// The layers of a film that these become.
const GUIDES: [Layer; 4] = [Layer::Color, Layer::Albedo, Layer::Normal, Layer::Variance];

/// Bytes a pixel while it is denoised: the layers, what the built-in denoiser makes of them, and the result.
pub(crate) const BYTES_A_PIXEL: u64 = 4 * 12 + 72 + 12;

/// The light of a film with less noise, and how that was done, in words.
///
/// * `threads`: 0 for one on each core
pub(crate) fn denoise(
    film: &Film,
    denoiser: &Denoiser,
    threads: usize,
) -> Result<(Image, String), DenoiseError> {
    if GUIDES.iter().any(|&layer| !film.spec().layers.has(layer)) {
        return Err(DenoiseError::NoGuides);
    }
    let [color, albedo, normal, variance] = GUIDES.map(|layer| view::develop(film, layer));
    let (color, albedo, normal, variance) = (color?, albedo?, normal?, variance?);
    let guided = Guided { color: &color, variance: &variance, albedo: &albedo, normal: &normal };
    let with_library = |path: Option<&OsString>| {
        let smooth = Oidn::load(path.map(OsString::as_os_str))?.denoise(&guided, threads)?;
        Ok((smooth, "by Intel Open Image Denoise".to_owned()))
    };
    let built_in = |why: &str| {
        if film.samples() < 2 * film.spec().shown().area() {
            return Err(DenoiseError::OneSample);
        }
        let threads = match threads {
            0 => thread::available_parallelism().map_or(1, |n| n.get()),
            n => n,
        };
        Ok((nlm::denoise(&guided, threads)?, format!("by non-local means{why}")))
    };
    match denoiser {
        Denoiser::Oidn(path) => with_library(path.as_ref()),
        Denoiser::BuiltIn => built_in(""),
        Denoiser::Best => match with_library(None) {
            Err(DenoiseError::Oidn(OidnError::NotFound { .. })) => {
                built_in(", since Intel Open Image Denoise is not installed")
            }
            done => done,
        },
    }
}
