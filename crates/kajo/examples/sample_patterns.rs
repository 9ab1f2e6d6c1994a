//! The pictures of the manual's page on sample patterns: point sets, the noise they make, and the spectra of
//! both. `cargo run --release --example sample_patterns -- docs/src/images`

use std::error::Error;
use std::path::{Path, PathBuf};

use kajo::{
    Defaults, EncodeOptions, Format, Image, LoadOptions, MemoryAssets, SamplerKind, Scene, Settings, Silent,
};
use kajo_core::sampler::{SampleStream, Sampler};
use kajo_math::poisson;
use kajo_render::integrator::Prepare;
use kajo_render::{Film, FilmSpec, Layer, LayerSet, RenderSettings};
use kajo_testkit::spectrum::Spectrum;

/// From left to right.
const KINDS: [SamplerKind; 7] = [
    SamplerKind::Uniform,
    SamplerKind::Regular,
    SamplerKind::Jittered,
    SamplerKind::Poisson,
    SamplerKind::Pmj,
    SamplerKind::Sobol,
    SamplerKind::ZSobol,
];

/// Side of each picture, in pixels.
const SIDE: u32 = 128;
const GAP: u32 = 8;

/// A ball before a wall that is far out of focus.
const STAGE: &str = "
PerspectiveCamera { center 0 0 6  direction 0 0 -1  up 0 1 0  angle 40  aperture 0.7  focus 4.5 }
Background { color 0 0 0  ambientLight 0.3 0.3 0.3 }
Lights { DirectionalLight { direction -0.5 -0.6 -1  color 0.7 0.7 0.7 } }
Materials {
  PhongMaterial dark  { diffuseColor 0.2 0.22 0.25 }
  PhongMaterial light { diffuseColor 0.8 0.78 0.74 }
  PhongMaterial ball  { diffuseColor 0.8 0.3 0.2  specularColor 0.4 0.4 0.4  exponent 30 }
  Checkerboard wall { materialIndex dark  materialIndex light }
}
Group {
  MaterialIndex wall  Transform { Translate 0.5 0.5 0.5  Plane { normal 0 0 1  offset -2 } }
  MaterialIndex ball  Sphere { center 0.3 -0.2 1.4  radius 0.9 }
}";

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| ".".to_owned()));
    let points = KINDS.map(|kind| Ok([points(kind)?, power(&point_spectrum(kind))?]));
    write(&folder.join("sample_points.png"), points)?;

    let assets = MemoryAssets::new().with("stage.txt", STAGE);
    let loaded = kajo::load_from("stage.txt", &assets, &LoadOptions::default());
    let scene = loaded.scene.as_ref().ok_or_else(|| loaded.report(false))?;
    let truth = picture(scene, Sampler::new(SamplerKind::Sobol, 1024), 99)?;
    let noise = KINDS.map(|kind| {
        let pictures: Result<Vec<Image>, _> =
            (0..8).map(|seed| picture(scene, Sampler::new(kind, 4), seed)).collect();
        let pictures = pictures?;
        let errors: Vec<Vec<f64>> = pictures.iter().map(|picture| error(picture, &truth)).collect();
        let spectra: Vec<Spectrum> = errors.iter().map(|e| Spectrum::of_image(e, SIDE as usize)).collect();
        let spectrum = Spectrum::mean(&spectra);
        let squares: f64 = errors.iter().flatten().map(|e| e * e).sum();
        let rms = (squares / (8 * SIDE * SIDE) as f64).sqrt();
        let low = spectrum.radial()[1..16].iter().sum::<f64>() / 15.0;
        println!("{kind:?}: error {rms:.4}, of white noise's power at low frequencies {low:.2}");
        Ok([pictures[0].clone(), power(&spectrum)?])
    });
    write(&folder.join("sample_noise.png"), noise)
}

/// 256 positions in one pixel, as dots.
fn points(kind: SamplerKind) -> Result<Image, Box<dyn Error>> {
    let mut image = Image::filled(SIDE, SIDE, &[1.0; 3])?;
    for [x, y] in positions(kind, 0) {
        let [x, y] = [x, y].map(|c| (c * f64::from(SIDE)) as u32);
        for (x, y) in [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)] {
            image.pixel_mut(x % SIDE, y % SIDE).fill(0.0);
        }
    }
    Ok(image)
}

fn positions(kind: SamplerKind, seed: u64) -> Vec<[f64; 2]> {
    if kind == SamplerKind::Poisson {
        // A sampler moves the same set around, which does not change its spectrum.
        return poisson::exactly(256, seed).iter().map(|p| p.to_array()).collect();
    }
    let sampler = Sampler::new(kind, 256);
    let position = |k| SampleStream::new(&sampler, seed, [0, 0], k).film_position().as_dvec2().to_array();
    (0..256).map(position).collect()
}

fn point_spectrum(kind: SamplerKind) -> Spectrum {
    let one = |seed| Spectrum::of_points(&positions(kind, seed), SIDE as usize);
    Spectrum::mean(&(0..30).map(one).collect::<Vec<_>>())
}

/// A spectrum as a picture, in which white noise is grey.
fn power(spectrum: &Spectrum) -> Result<Image, Box<dyn Error>> {
    let mut image = Image::new(SIDE, SIDE, 3)?;
    for (pixel, &power) in image.data_mut().chunks_mut(3).zip(&spectrum.power) {
        pixel.fill((0.5 * power).min(1.0) as f32);
    }
    Ok(image)
}

fn picture(scene: &Scene, sampler: Sampler, seed: u64) -> Result<Image, Box<dyn Error>> {
    let asked = Settings { size: Some([SIDE; 2]), ..Settings::default() };
    let settings = kajo::RenderSettings::resolve(scene, &asked, Defaults::Modern, false)?;
    let layers = LayerSet::of(&[Layer::Color]);
    let film = Film::new(FilmSpec { layers, ..FilmSpec::new(SIDE, SIDE) }, u64::MAX)?;
    let integrator = settings.integrator_settings.prepare(scene, &scene.output.camera, settings.size, layers);
    kajo_render::render(
        &*integrator,
        &film,
        &RenderSettings { seed, ..RenderSettings::new(sampler) },
        &Silent,
    )?;
    film.develop(Layer::Color).ok_or_else(|| "the film holds no colour".into())
}

/// The error of green in each pixel.
fn error(picture: &Image, truth: &Image) -> Vec<f64> {
    let pixels = picture.data().chunks(3).zip(truth.data().chunks(3));
    pixels.map(|(a, b)| f64::from(a[1]) - f64::from(b[1])).collect()
}

/// Writes pairs of pictures side by side, the second of each below the first.
fn write(path: &Path, pairs: [Result<[Image; 2], Box<dyn Error>>; 7]) -> Result<(), Box<dyn Error>> {
    let mut sheet = Image::filled(7 * (SIDE + GAP) - GAP, 2 * SIDE + GAP, &[1.0; 3])?;
    for (column, pair) in (0..).zip(pairs) {
        let [above, below] = pair?;
        sheet.blit(&above, column * (SIDE + GAP), 0)?;
        sheet.blit(&below, column * (SIDE + GAP), SIDE + GAP)?;
    }
    std::fs::write(path, kajo::encode(&sheet, Format::Png, &EncodeOptions::default())?)?;
    Ok(())
}
