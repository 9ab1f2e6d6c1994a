//! Spectra of point sets, and of the error on the screen.

use kajo_math::poisson;
use kajo_testkit::spectrum::Spectrum;

use super::*;

/// The picture of a smooth function with `n` samples in each pixel, less its true value.
fn error_image(kind: SamplerKind, n: u32, size: u32, seed: u64) -> Spectrum {
    let sampler = Sampler::new(kind, n);
    let pixel = |i: u32| {
        let value = |k| {
            let mut draws = SampleStream::new(&sampler, seed, [i % size, i / size], k);
            let _film = draws.film_position();
            f64::from(draws.next_2d().element_product())
        };
        (0..n).map(value).sum::<f64>() / f64::from(n) - 0.25
    };
    Spectrum::of_image(&(0..size * size).map(pixel).collect::<Vec<_>>(), size as usize)
}

/// Mean power at the lowest quarter of frequencies; 1 for white noise.
fn low(spectrum: &Spectrum) -> f64 {
    let quarter = spectrum.size / 8;
    spectrum.radial()[1..quarter].iter().sum::<f64>() / (quarter - 1) as f64
}

#[test]
fn errors_along_the_curve_are_blue() {
    for n in [1, 2, 4, 16] {
        let mean = |kind| Spectrum::mean(&[0, 1, 2, 3].map(|seed| error_image(kind, n, 64, seed)));
        let (blue, white) = (low(&mean(ZSobol)), low(&mean(Sobol)));
        assert!(blue < 0.15, "{n} samples: {blue}");
        assert!((0.75..1.25).contains(&white), "{n} samples: {white}");
    }
}

/// Blue noise: no low frequencies, and a peak at the distance of neighbours.
#[test]
fn poisson_disks_are_blue() {
    let sets = (0..10).map(|seed| {
        let points: Vec<[f64; 2]> = poisson::maximal(0.027, seed).iter().map(|p| p.to_array()).collect();
        Spectrum::of_points(&points, 128)
    });
    let radial = Spectrum::mean(&sets.collect::<Vec<_>>()).radial();
    let (peak, power) = radial.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).expect("frequencies");
    assert!((1.2..2.0).contains(power), "peak of {power} at {peak}");
    // The rings of neighbours are about r apart.
    assert!((30..42).contains(&peak), "{peak}");
    let below: Vec<f64> = radial[1..peak / 2].to_vec();
    let mean = below.iter().sum::<f64>() / below.len() as f64;
    assert!(mean < 0.2 && below.iter().all(|&p| p < 0.35), "{mean} {below:?}");
}
