use kajo_core::sampler::{SampleStream, Sampler, SamplerKind};
use kajo_math::{Vec2, Vec3, rng::Stream};
use proptest::prelude::*;

use super::*;
use crate::{Auxiliary, FirstHit, PixelSample, Splats};

const FILTERS: [Filter; 8] = [
    Filter::None,
    Filter::BOX,
    Filter::Box { radius: 1.2 },
    Filter::Tent { radius: 1.0 },
    Filter::Tent { radius: 0.75 },
    Filter::gaussian(0.5),
    Filter::MITCHELL,
    Filter::LANCZOS,
];

fn sampler(kind: SamplerKind, n: u32) -> Sampler {
    Sampler::new(kind, n)
}

fn all_layers(width: u32, height: u32, filter: Filter) -> FilmSpec {
    FilmSpec { filter, layers: LayerSet::of(&Layer::ALL), ..FilmSpec::new(width, height) }
}

fn film(spec: FilmSpec) -> Film {
    Film::new(spec, u64::MAX).expect("a sensible film")
}

/// A sample full of random values, a miss now and then, the same for the same position and index.
fn random_sample(x: u32, y: u32, k: u32) -> PixelSample {
    let stream = Stream::new(99, [x, y], k);
    let u = |d| stream.uniform(d);
    let radiance = [u(10) - 0.3, u(11) * 1e6, u(12) * 1e-6];
    let hit = FirstHit {
        t: u(13) * 20.0 - 1.0,
        n: Vec3::new(u(14) - 0.5, u(15) - 0.5, u(16) - 0.5).normalize_or_zero(),
        uv: Vec2::new(u(17), u(18)),
        object: stream.bits(19) % 5 + 1,
        material: stream.bits(20),
    };
    PixelSample { radiance, first: (u(21) < 0.8).then_some(hit) }
}

/// The same for the rare layers.
fn random_auxiliary(x: u32, y: u32, k: u32) -> Auxiliary {
    let stream = Stream::new(98, [x, y], k);
    let u = |d| stream.uniform(d);
    let mut aux = Auxiliary { albedo: [u(1), u(2), u(3)], motion: [u(4) - 0.5, u(5)], ..Default::default() };
    aux.lights[7] = [u(6), u(7) * 1e-3, u(8)];
    aux
}

/// A few splats of a sample, some of them beside the picture.
fn random_splats(spec: &FilmSpec, x: u32, y: u32, k: u32) -> Splats {
    let mut splats = Splats::default();
    for i in 0..k % 3 {
        let stream = Stream::new(97, [x, y], 8 * k + i);
        let u = |d| stream.uniform(d);
        let across = |u: f32, n: u32| u * (n + 4) as f32 - 2.0;
        splats.add(Vec2::new(across(u(0), spec.width), across(u(1), spec.height)), [u(2), u(3) * 1e3, u(4)]);
    }
    splats
}

/// The part of a tile's random samples with indices in a range.
fn random_part(spec: &FilmSpec, sampler: &Sampler, tile: Rect, samples: std::ops::Range<u32>) -> FilmPart {
    let mut part = FilmPart::new(spec, sampler);
    part.reset(&tile);
    let mut splats = Splats::default();
    for y in tile.y0..tile.y1 {
        for x in tile.x0..tile.x1 {
            for k in samples.clone() {
                let offset = SampleStream::new(sampler, 1, [x, y], k).film_position();
                part.add(x, y, k, offset, &random_sample(x, y, k), &random_auxiliary(x, y, k));
                for splat in random_splats(spec, x, y, k).as_slice() {
                    splats.add(splat.raster, splat.value);
                }
            }
        }
    }
    part.take_splats(&mut splats);
    part
}

/// The bits of every layer.
fn bits(film: &Film) -> Vec<Vec<u32>> {
    let mut bits: Vec<Vec<u32>> = Vec::new();
    for layer in film.spec().layers.iter() {
        let image = film.develop(layer).expect("the film has it");
        bits.push(image.data().iter().map(|v| v.to_bits()).collect());
        bits.extend(film.ids(layer));
    }
    bits
}

/// A film of samples `value(x, y, k)` of every pixel.
fn splat(spec: FilmSpec, sampler: &Sampler, value: impl Fn(u32, u32, u32) -> f32) -> Film {
    let film = film(spec);
    let mut part = FilmPart::new(&spec, sampler);
    part.reset(&spec.rect());
    for y in 0..spec.height {
        for x in 0..spec.width {
            for k in 0..sampler.samples() {
                let offset = SampleStream::new(sampler, 5, [x, y], k).film_position();
                let radiance = [value(x, y, k); 3];
                part.add(x, y, k, offset, &PixelSample { radiance, first: None }, &Auxiliary::default());
            }
        }
    }
    film.merge(&part).expect("a part of this film");
    film
}

#[test]
fn the_response_to_an_impulse_is_the_filter() {
    for filter in FILTERS {
        // One impulse in the middle and one in a corner, where the border cuts the filter off.
        check_impulse(filter, 9, (6, 7, 2));
        check_impulse(filter, 9, (0, 0, 0));
        // Three is no square: sample 2 lies two pixels below the one it is taken for.
        check_impulse(filter, 3, (6, 7, 2));
    }
}

/// Compares a picture of one sample of value 1 among `n` in each pixel with the filter's weights.
fn check_impulse(filter: Filter, n: u32, impulse: (u32, u32, u32)) {
    let sampler = sampler(SamplerKind::Regular, n);
    let value = |x, y, k| if (x, y, k) == impulse { 1.0 } else { 0.0 };
    let image = splat(FilmSpec { filter, ..FilmSpec::new(13, 13) }, &sampler, value);
    let image = image.develop(Layer::Color).expect("colour");
    // Weight of a sample at the pixel (px, py).
    let weight = |(x, y, k): (u32, u32, u32), px: u32, py: u32| {
        if filter == Filter::None {
            return f64::from(u8::from((x, y) == (px, py)));
        }
        let offset = SampleStream::new(&sampler, 0, [0, 0], k).film_position();
        let centre = |sample: u32, offset: f32, pixel: u32| {
            (f64::from(sample) - f64::from(pixel)) as f32 + offset - 0.5
        };
        f64::from(filter.weight(centre(x, offset.x, px), centre(y, offset.y, py)))
    };
    for py in 0..13 {
        for px in 0..13 {
            let samples = (0..13).flat_map(|y| (0..13).flat_map(move |x| (0..n).map(move |k| (x, y, k))));
            let sum: f64 = samples.map(|sample| weight(sample, px, py)).sum();
            let expected = if sum == 0.0 { 0.0 } else { weight(impulse, px, py) / sum };
            let found = f64::from(image.pixel(px, py)[0]);
            assert!(
                (found - expected).abs() < 3e-7,
                "{filter:?}, {n} at ({px}, {py}): {found}, not {expected}"
            );
        }
    }
}

#[test]
fn a_constant_picture_stays_constant() {
    for filter in FILTERS {
        for (kind, n) in [(SamplerKind::Regular, 4), (SamplerKind::Jittered, 16), (SamplerKind::Uniform, 5)] {
            for value in [1.0, 0.1, 1e-6, 12_345.678, 3e9] {
                for cell in [None, Some([3, 4])] {
                    let spec = FilmSpec { filter, cell, ..FilmSpec::new(9, 8) };
                    let image = splat(spec, &sampler(kind, n), |_, _, _| value)
                        .develop(Layer::Color)
                        .expect("colour");
                    for &found in image.data() {
                        assert!(
                            (found - value).abs() <= 1e-7 * value,
                            "{filter:?} {kind:?}: {found}, not {value}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn cells_do_not_bleed_into_each_other() {
    for filter in FILTERS {
        let spec = FilmSpec { filter, cell: Some([4, 3]), ..FilmSpec::new(8, 6) };
        // Jittered with a number that is no square, so that samples even overhang.
        let film = splat(spec, &sampler(SamplerKind::Jittered, 6), |x, y, _| (x / 4 + 2 * (y / 3)) as f32);
        let image = film.develop(Layer::Color).expect("colour");
        for y in 0..6 {
            for x in 0..8 {
                let found = image.pixel(x, y)[0];
                let expected = (x / 4 + 2 * (y / 3)) as f32;
                assert!((found - expected).abs() < 1e-6, "{filter:?} at ({x}, {y}): {found}");
            }
        }
    }
}

#[test]
fn own_layers_look_at_the_pixels_own_samples() {
    let spec = all_layers(2, 1, Filter::MITCHELL);
    let film = film(spec);
    let sampler = sampler(SamplerKind::Regular, 4);
    let mut part = FilmPart::new(&spec, &sampler);
    part.reset(&spec.rect());
    let hit = |t, object| PixelSample {
        radiance: [0.0; 3],
        first: Some(FirstHit { t, n: Vec3::Z, uv: Vec2::ZERO, object, material: object + 10 }),
    };
    let at = |k| SampleStream::new(&sampler, 0, [0, 0], k).film_position();
    let none = Auxiliary::default();
    // Indices out of order: the smallest decides the numbers.
    part.add(0, 0, 2, at(2), &hit(5.0, 2), &none);
    part.add(0, 0, 1, at(1), &hit(2.0, u32::MAX - 10), &none);
    part.add(0, 0, 3, at(3), &PixelSample::default(), &none);
    part.add(1, 0, 0, at(0), &PixelSample::default(), &none);
    part.add(1, 0, 1, at(1), &PixelSample::default(), &none);
    film.merge(&part).expect("a part of this film");
    let data = |layer| film.develop(layer).expect("the film has it").into_data();
    assert_eq!(data(Layer::Depth), [3.5, f32::INFINITY]);
    assert_eq!(data(Layer::SampleCount), [3.0, 2.0]);
    assert_eq!(film.ids(Layer::ObjectId), Some(vec![u32::MAX - 10, 0]));
    assert_eq!(film.ids(Layer::MaterialId), Some(vec![u32::MAX, 0]));
    assert_eq!(film.ids(Layer::Color), None);
}

#[test]
fn maps_are_averages_of_maps() {
    let spec = FilmSpec {
        depth_map: DepthMap { min: 0.0, max: 10.0, far_is_white: false },
        ..all_layers(1, 1, Filter::None)
    };
    let film = film(spec);
    let sampler = sampler(SamplerKind::Regular, 4);
    let mut part = FilmPart::new(&spec, &sampler);
    part.reset(&spec.rect());
    // Clamped before the average: 1, 0.5, 0 and a miss.
    let depths = [Some((-4.0, Vec3::X)), Some((5.0, Vec3::NEG_X)), Some((20.0, Vec3::Y)), None];
    for (k, depth) in (0..).zip(depths) {
        let first = depth.map(|(t, n)| FirstHit { t, n, uv: Vec2::ONE, object: 1, material: 1 });
        let sample = PixelSample { radiance: [0.0; 3], first };
        part.add(0, 0, k, Vec2::splat(0.5), &sample, &Auxiliary::default());
    }
    film.merge(&part).expect("a part of this film");
    let data = |layer| film.develop(layer).expect("the film has it").into_data();
    assert_eq!(data(Layer::DepthMap), [0.375]);
    assert_eq!(data(Layer::NormalMap), [0.5, 0.25, 0.0]);
    assert_eq!(data(Layer::Normal), [0.0, 0.25, 0.0]);
    assert_eq!(data(Layer::Uv), [0.75, 0.75]);
}

#[test]
fn values_that_are_no_numbers_are_black_and_counted() {
    for filter in FILTERS {
        let value = |x: u32, _, k| match (x, k) {
            (0, 0) => f32::NAN,
            (1, 1) => f32::INFINITY,
            (2, 2) => f32::NEG_INFINITY,
            _ => 0.0,
        };
        let film =
            splat(FilmSpec { filter, ..FilmSpec::new(4, 3) }, &sampler(SamplerKind::Regular, 4), value);
        assert_eq!(film.non_finite(), 9);
        assert!(film.develop(Layer::Color).expect("colour").data().iter().all(|&v| v == 0.0), "{filter:?}");
    }
}

#[test]
fn a_film_without_samples_is_black() {
    let film = film(all_layers(3, 2, Filter::LANCZOS));
    for layer in Layer::ALL {
        let nothing = if layer == Layer::Depth { f32::INFINITY } else { 0.0 };
        let image = film.develop(layer).expect("the film has it");
        assert_eq!(image.data().len(), 6 * layer.channels());
        assert!(image.data().iter().all(|&v| v == nothing), "{layer:?}");
    }
    assert!(self::film(FilmSpec::new(3, 2)).develop(Layer::Uv).is_none());
}

#[test]
fn parts_of_other_films_and_of_finished_ones_are_refused() {
    let sampler = sampler(SamplerKind::Regular, 1);
    let spec = FilmSpec { one_pass: true, ..FilmSpec::new(300, 300) };
    let part = FilmPart::new(&spec, &sampler);
    assert_eq!(film(spec).merge(&part), Err(FilmError::OnePass));
    assert_eq!(film(FilmSpec { one_pass: false, ..spec }).merge(&part), Err(FilmError::OtherFilm));
}

/// Takes so many bytes and no more.
struct Full(usize);

impl std::io::Write for Full {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0 = self.0.checked_sub(bytes.len()).ok_or(std::io::ErrorKind::StorageFull)?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_film_of_many_blocks_is_saved_whole_or_not_at_all() {
    let sampler = sampler(SamplerKind::Uniform, 2);
    let spec = FilmSpec { layers: LayerSet::of(&Layer::ALL), ..FilmSpec::new(700, 70) };
    let open = film(spec);
    for column in 0..6 {
        let tile = Rect { x0: column * 100, y0: 0, x1: column * 100 + 90, y1: 60 };
        open.add(&random_part(&spec, &sampler, tile, 0..2));
    }
    let mut saved = Vec::new();
    open.save(0, &mut saved).expect("memory does not fail");
    let mut rest = &saved[..];
    let restored = Film::restore(spec, u64::MAX, &mut rest).expect("as it was saved");
    assert!(rest.is_empty());
    assert_eq!(bits(&restored), bits(&open));
    for threads in [1, 2, 3, 40] {
        let mut again = Vec::new();
        restored.save(threads, &mut again).expect("memory does not fail");
        assert!(again == saved, "by {threads} threads");
    }
    for room in [0, 20, saved.len() / 2, saved.len() - 1] {
        assert!(open.save(0, &mut Full(room)).is_err());
    }
    open.save(0, &mut Full(saved.len())).expect("there is room");
}

#[test]
fn finished_pixels_are_what_the_sums_would_give() {
    let sampler = sampler(SamplerKind::Jittered, 3);
    let spec = FilmSpec { layers: LayerSet::of(&Layer::ALL), ..FilmSpec::new(300, 230) };
    let (open, one_pass) = (film(spec), film(FilmSpec { one_pass: true, ..spec }));
    for column in 0..3 {
        let tile = Rect { x0: column * 90, y0: 0, x1: column * 90 + 90, y1: 200 };
        open.add(&random_part(&spec, &sampler, tile, 0..3));
        one_pass.add(&random_part(one_pass.spec(), &sampler, tile, 0..3));
    }
    assert!(!one_pass.spec().keeps_sums());
    // Below row 200 and right of column 270 no sample was taken.
    assert_eq!(bits(&open), bits(&one_pass));
}

#[test]
fn a_single_sample_needs_no_sums() {
    let sampler = sampler(SamplerKind::Uniform, 1);
    for layers in [&Layer::ALL[..], &[Layer::Color], &[Layer::Depth, Layer::ObjectId]] {
        let spec = FilmSpec { layers: LayerSet::of(layers), ..FilmSpec::new(300, 230) };
        let (open, one_pass) = (film(spec), film(FilmSpec { one_pass: true, ..spec }));
        for tile in [Rect { x0: 0, y0: 0, x1: 130, y1: 200 }, Rect { x0: 130, y0: 0, x1: 300, y1: 230 }] {
            open.add(&random_part(&spec, &sampler, tile, 0..1));
            one_pass.add(&random_part(one_pass.spec(), &sampler, tile, 0..1));
        }
        assert_eq!(bits(&open), bits(&one_pass));
        assert_eq!((open.samples(), one_pass.samples()), (130 * 200 + 170 * 230, 130 * 200 + 170 * 230));
    }
}

#[test]
fn a_single_bad_value_is_black_and_counted() {
    let spec = FilmSpec { one_pass: true, ..all_layers(300, 300, Filter::None) };
    let film = film(spec);
    let mut part = FilmPart::new(&spec, &sampler(SamplerKind::Regular, 1));
    part.reset(&Rect::of_size(2, 1));
    let first = FirstHit { t: f32::NAN, n: Vec3::Z, uv: Vec2::ZERO, object: 1, material: 1 };
    let sample = PixelSample { radiance: [1.0, f32::NAN, 2.0], first: None };
    part.add(0, 0, 0, Vec2::splat(0.5), &sample, &Auxiliary::default());
    let sample = PixelSample { radiance: [0.5; 3], first: Some(first) };
    part.add(1, 0, 0, Vec2::splat(0.5), &sample, &Auxiliary::default());
    film.add(&part);
    assert_eq!(film.non_finite(), 2);
    assert_eq!(film.develop(Layer::Color).expect("colour").data()[..6], [1.0, 0.0, 2.0, 0.5, 0.5, 0.5]);
    assert_eq!(film.develop(Layer::Depth).expect("depth").data()[1], f32::INFINITY);
}

/// Samples and splats above a limit are cut alike in whatever parts they come, and what that took goes on from a saved film.
#[test]
fn what_a_limit_takes_does_not_depend_on_parts() {
    let sampler = sampler(SamplerKind::Sobol, 4);
    for filter in [Filter::None, Filter::MITCHELL] {
        let spec = FilmSpec { clamp: Some(500.0), ..all_layers(20, 12, filter) };
        let (whole, parts) = (film(spec), film(spec));
        whole.merge(&random_part(&spec, &sampler, spec.rect(), 0..4)).expect("a part of this film");
        for samples in [2..4, 0..2] {
            for x0 in [10, 0] {
                let tile = Rect { x0, y0: 0, x1: x0 + 10, y1: 12 };
                parts
                    .merge(&random_part(&spec, &sampler, tile, samples.clone()))
                    .expect("a part of this film");
            }
        }
        let clamped = whole.clamped().expect("a limit");
        assert!(clamped.count > 500 && clamped.taken[1] > 0.9 && clamped.taken[2] > 0.0, "{clamped:?}");
        assert_eq!((bits(&parts), parts.clamped()), (bits(&whole), Some(clamped)));
        let mut saved = Vec::new();
        parts.save(1, &mut saved).expect("saved");
        let restored = Film::restore(spec, u64::MAX, &mut saved.as_slice()).expect("restored");
        assert_eq!((bits(&restored), restored.clamped()), (bits(&whole), Some(clamped)));
        let other = film(spec);
        other.merge(&random_part(&spec, &sampler, spec.rect(), 0..4)).expect("a part of this film");
        restored.absorb(other).expect("a film of this kind");
        assert_eq!(restored.clamped().map(|light| light.count), Some(2 * clamped.count));
    }
}

#[test]
fn variance_is_that_of_the_mean() {
    let spec = FilmSpec { layers: LayerSet::of(&[Layer::Variance]), ..FilmSpec::new(3, 1) };
    for filter in [Filter::None, Filter::MITCHELL] {
        let spec = FilmSpec { filter, ..spec };
        let film = film(spec);
        let mut part = FilmPart::new(&spec, &sampler(SamplerKind::Uniform, 4));
        part.reset(&spec.rect());
        let mut add = |x, k, radiance| {
            let sample = PixelSample { radiance, first: None };
            part.add(x, 0, k, Vec2::splat(0.3), &sample, &Auxiliary::default());
        };
        // 1, 2, 3, 6 has the variance 14/3, its mean a quarter of that.
        for (k, v) in (0..).zip([1.0, 2.0, 3.0, 6.0]) {
            add(0, k, [v, 0.1, 1e4 * v]);
        }
        add(1, 0, [5.0; 3]);
        film.merge(&part).expect("a part of this film");
        let variance = film.develop(Layer::Variance).expect("variance").into_data();
        assert_eq!(variance[..2], [14.0 / 12.0, 0.0]);
        assert!((variance[2] / (1e8 * 14.0 / 12.0) - 1.0).abs() < 1e-6, "{variance:?}");
        assert_eq!(variance[3..], [0.0; 6], "one sample and none say nothing");
    }
}

#[test]
fn an_even_rain_of_splats_is_an_even_picture() {
    for filter in FILTERS {
        for cell in [None, Some([3, 4])] {
            let spec = FilmSpec { filter, cell, ..FilmSpec::new(9, 8) };
            // As if each of four samples of each pixel had brought 100 splats, all over the picture; the
            // edges of all boxes lie between them.
            let mut splats = Splats::default();
            for i in 0..9 * 20 {
                for j in 0..8 * 20 {
                    let raster = Vec2::new(i as f32 + 0.5, j as f32 + 0.5) / 20.0;
                    splats.add(raster, [4.0 / 400.0, 8.0 / 400.0, 0.0]);
                }
            }
            let film = splat(spec, &sampler(SamplerKind::Regular, 4), |_, _, _| 1.0);
            let mut part = FilmPart::new(&spec, &sampler(SamplerKind::Regular, 4));
            part.reset(&spec.rect());
            part.take_splats(&mut splats);
            film.merge(&part).expect("a part of this film");
            let image = film.develop(Layer::Color).expect("colour");
            for rgb in image.pixels() {
                let found = [rgb[0], rgb[1], rgb[2]];
                for (v, expected) in found.into_iter().zip([2.0, 3.0, 1.0]) {
                    assert!((v - expected).abs() < 3e-3, "{filter:?}, cells {cell:?}: {found:?}");
                }
            }
        }
    }
}

#[test]
fn splats_beside_the_picture_are_lost_and_bad_ones_counted() {
    let spec = FilmSpec { filter: Filter::LANCZOS, ..FilmSpec::new(4, 4) };
    let film = splat(spec, &sampler(SamplerKind::Regular, 1), |_, _, _| 0.0);
    let mut part = FilmPart::new(&spec, &sampler(SamplerKind::Regular, 1));
    part.reset(&spec.rect());
    let mut splats = Splats::default();
    for raster in [(-0.01, 2.0), (2.0, -1e9), (4.0, 2.0), (2.0, f32::MAX)] {
        splats.add(raster.into(), [1.0; 3]);
    }
    splats.add(Vec2::NAN, [1.0; 3]);
    splats.add(Vec2::ONE, [f32::NAN; 3]);
    part.take_splats(&mut splats);
    assert!(splats.as_slice().is_empty());
    film.merge(&part).expect("a part of this film");
    assert_eq!(film.non_finite(), 2);
    assert!(film.develop(Layer::Color).expect("colour").data().iter().all(|&v| v == 0.0));
}

/// Splats of random value at random positions: a film, and the picture that many of them have on average.
#[test]
fn the_spread_of_splats_is_known() {
    const FILMS: u64 = 400;
    let sampler = sampler(SamplerKind::Uniform, 8);
    for filter in [Filter::None, Filter::Box { radius: 0.5 }] {
        let layers = LayerSet::of(&[Layer::Color, Layer::Variance]);
        let spec = FilmSpec { filter, layers, ..FilmSpec::new(6, 5) };
        let (mut values, mut squares, mut variance, mut noise) = (0.0, 0.0, 0.0, 0.0);
        for seed in 0..FILMS {
            let film = splat(spec, &sampler, |_, _, _| 0.0);
            let mut splats = Splats::default();
            // One of the film's 240 samples in three brings light, and each pixel is as likely as the next.
            for k in 0..240 / 3 {
                let stream = Stream::new(seed, [0, 0], k);
                let raster = Vec2::new(6.0 * stream.uniform(0), 5.0 * stream.uniform(1));
                splats.add(raster, [3.0 * stream.uniform(2); 3]);
            }
            let mut part = FilmPart::new(&spec, &sampler);
            part.reset(&spec.rect());
            part.take_splats(&mut splats);
            film.merge(&part).expect("a part of this film");
            let mean = |layer| {
                let image = film.develop(layer).expect("the film has it");
                let data = image.data();
                let n = data.len() as f64;
                let sum = |power| data.iter().map(|&v| f64::from(v).powi(power)).sum::<f64>() / n;
                (sum(1), sum(2))
            };
            let (value, square) = mean(Layer::Color);
            values += value / FILMS as f64;
            squares += square / FILMS as f64;
            variance += mean(Layer::Variance).0 / FILMS as f64;
            noise += film.noise().expect("the variance is kept") / FILMS as f64;
        }
        // 1/8 Σ s over a pixel: 80/30 splats on average, whose values have the mean 1.5 and the mean square 3.
        assert!((values / (80.0 / 30.0 * 1.5 / 8.0) - 1.0).abs() < 0.02, "{values}");
        assert!((variance / (80.0 / 30.0 * 3.0 / 64.0) - 1.0).abs() < 0.02, "{variance}");
        let found = squares - values * values;
        assert!((found / variance - 1.0).abs() < 0.06, "spread {found}, estimated {variance}");
        let expected = (variance / (1.01 * values * values)).sqrt();
        assert!((noise / expected - 1.0).abs() < 0.02, "noise {noise}, and not {expected}");
    }
}

/// The tiles of a cut of a picture in two directions, each with its samples cut in two.
fn units(spec: &FilmSpec, x: u32, y: u32, k: u32, n: u32) -> Vec<(Rect, std::ops::Range<u32>)> {
    let (w, h) = (spec.width, spec.height);
    let mut units = Vec::new();
    for (x0, x1) in [(0, x), (x, w)] {
        for (y0, y1) in [(0, y), (y, h)] {
            for samples in [0..k, k..n] {
                units.push((Rect { x0, y0, x1, y1 }, samples));
            }
        }
    }
    units
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Splitting by position and by sample range, and merging in any order, changes no bit.
    #[test]
    fn any_split_in_any_order_gives_the_same_bits(
        size in (1u32..40, 1u32..40),
        which in 0..FILTERS.len(),
        kind in prop_oneof![Just(SamplerKind::Uniform), Just(SamplerKind::Regular), Just(SamplerKind::Jittered)],
        n in 1u32..7,
        cut in (0f64..1.0, 0f64..1.0, 0f64..1.0),
        cells in any::<bool>(),
        order in Just((0..8).collect::<Vec<usize>>()).prop_shuffle(),
    ) {
        let (w, h) = size;
        let cell = cells.then_some([w.div_ceil(3), h.div_ceil(2)]);
        let spec = FilmSpec { cell, ..all_layers(w, h, FILTERS[which]) };
        let sampler = Sampler::new(kind, n);
        let whole = film(spec);
        whole.merge(&random_part(&spec, &sampler, spec.rect(), 0..n)).expect("a part of this film");
        let split = film(spec);
        let at = |share: f64, of: u32| (share * f64::from(of)) as u32;
        let units = units(&spec, at(cut.0, w), at(cut.1, h), at(cut.2, n), n);
        for i in order {
            let (tile, samples) = units[i].clone();
            split.merge(&random_part(&spec, &sampler, tile, samples)).expect("a part of this film");
        }
        prop_assert_eq!(bits(&whole), bits(&split));
        prop_assert_eq!(whole.non_finite(), split.non_finite());
    }
}
