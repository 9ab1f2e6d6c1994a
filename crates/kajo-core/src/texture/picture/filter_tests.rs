//! Filters against closed forms.

use std::f32::consts::PI;
use std::sync::Arc;

use kajo_math::{Vec2, Vec3, rng::Stream};

use super::filter::{ceil, floor};
use super::{Picture, PictureMap, TexelFilter, Wrap};
use crate::texture::{TextureContext, TextureFootprint};

const FILTERS: [TexelFilter; 8] = [
    TexelFilter::Nearest,
    TexelFilter::Bilinear,
    TexelFilter::Bicubic,
    TexelFilter::Trilinear,
    TexelFilter::Sat,
    TexelFilter::Ewa,
    TexelFilter::Feline,
    TexelFilter::Stochastic,
];

fn map(picture: Picture, filter: TexelFilter) -> PictureMap {
    picture.prepare(filter);
    PictureMap { filter, ..PictureMap::new(Arc::new(picture)) }
}

/// At surface coordinates with a footprint.
fn covering(uv: Vec2, axes: [Vec2; 2]) -> TextureContext {
    let footprint = TextureFootprint { uv: axes, ..TextureFootprint::POINT };
    TextureContext { uv: uv.into(), p: Vec3::new(uv.x, uv.y, 0.0), footprint, ..TextureContext::default() }
}

/// Gratings of whole periods in all directions, filtered by slanted ellipses: the amplitude is that of a Gaussian with the variance
/// of the weights, `exp(-2 pi^2 s^2 f^2)`, with `s^2 = 0.0851 k' (J J' + 1.9576 I) k / |k|^2` along the wave vector `k`.
#[test]
fn ellipses_filter_gratings_as_gaussians_do() {
    const N: u32 = 256;
    let mut worst = 0.0f32;
    for (k, waves) in [(5, 9), (20, 4), (-12, 17), (0, 14), (30, 0), (23, 24)].into_iter().enumerate() {
        let wave = |x: f32, y: f32| (2.0 * PI * (waves.0 as f32 * x + waves.1 as f32 * y)).cos();
        let picture = Picture::from_fn(N, N, |x, y| {
            let v = 0.5 + 0.5 * wave((x as f32 + 0.5) / N as f32, 1.0 - (y as f32 + 0.5) / N as f32);
            [v, 0.5, 1.0 - v, 1.0]
        });
        let map = map(picture, TexelFilter::Ewa);
        for angle in 0..12 {
            for (major, minor) in [(3.0, 3.0), (8.0, 2.0), (12.0, 3.5), (20.0, 5.0), (16.0, 1.5)] {
                let (sin, cos) = (angle as f32 * PI / 12.0).sin_cos();
                let axes = [major * Vec2::new(cos, sin), minor * Vec2::new(-sin, cos)].map(|v| v / N as f32);
                let wave_vector = Vec2::new(waves.0 as f32, waves.1 as f32);
                let along: f32 = axes.iter().map(|axis| axis.dot(wave_vector).powi(2)).sum();
                let variance =
                    0.085_136_4 * (along + 1.957_64 * wave_vector.length_squared() / (N * N) as f32);
                let expected = (-2.0 * PI * PI * variance).exp();
                // The coefficient of the wave over places all over it, and what else is there.
                let (mut sum, mut norm, mut rest, places) = (0.0, 0.0, 0.0, 64);
                for i in 0..places {
                    let s = Stream::new(9, [i, k as u32], angle);
                    let uv = Vec2::new(s.uniform(0), s.uniform(1));
                    let found = 2.0 * map.filtered(&covering(uv, axes))[0] - 1.0;
                    let phase = wave(uv.x, uv.y);
                    (sum, norm) = (sum + found * phase, norm + phase * phase);
                    rest += (found - expected * phase).abs() / places as f32;
                }
                let amplitude = sum / norm;
                worst = worst.max((amplitude - expected).abs());
                let what = format!("{waves:?} {angle} {major} {minor}: {amplitude} {expected} {rest}");
                assert!((amplitude - expected).abs() < 0.02 && rest < 0.02, "{what}");
            }
        }
    }
    assert!(worst > 1e-4);
}

/// The level of an ellipse goes by its width alone, until that is made wider.
#[test]
fn levels_go_by_the_minor_axis() {
    for minor in [1.7f32, 3.0, 6.5, 40.0] {
        let level = |eccentricity: f32, angle: f32| {
            let (sin, cos) = angle.sin_cos();
            let axes = [eccentricity * minor * Vec2::new(cos, sin), minor * Vec2::new(-sin, cos)];
            super::filter::level_of(axes)
        };
        let round = level(1.0, 0.0);
        for eccentricity in 1..=15 {
            for angle in 0..8 {
                assert_eq!(level(eccentricity as f32, angle as f32), round, "{minor} {eccentricity} {angle}");
            }
        }
        // Twice as long as it may be is twice as wide.
        assert_eq!(
            level(31.99, 0.3),
            super::filter::level_of([2.0 * minor * 0.9997 * Vec2::X, 2.0 * minor * Vec2::Y])
        );
    }
}

/// A picture of one colour keeps it, and one of two halves has its mean in large footprints.
#[test]
fn constants_and_means_are_kept() {
    for filter in FILTERS {
        let even = map(Picture::from_fn(13, 7, |_, _| [0.25, 0.5, 0.75, 1.0]), filter);
        let checks = map(Picture::from_fn(64, 64, |x, y| [((x ^ y) & 1) as f32; 4]), filter);
        let mut mean = 0.0;
        for i in 0..2000 {
            let s = Stream::new(11, [i, 0], 0);
            let uv = 8.0 * Vec2::new(s.uniform(0), s.uniform(1)) - 4.0;
            let axes = [2, 4].map(|k| 0.5 * (Vec2::new(s.uniform(k), s.uniform(k + 1)) - 0.5));
            let found = even.filtered(&covering(uv, axes));
            for (found, expected) in found.into_iter().zip([0.25, 0.5, 0.75, 1.0]) {
                assert!((found - expected).abs() < 2e-5, "{filter:?} {uv}: {found} {expected}");
            }
            let found = checks.filtered(&covering(uv, [0.3 * Vec2::X, 0.3 * Vec2::Y]))[0];
            mean += found / 2000.0;
            if matches!(
                filter,
                TexelFilter::Trilinear | TexelFilter::Sat | TexelFilter::Ewa | TexelFilter::Feline
            ) {
                assert!((found - 0.5).abs() < 0.01, "{filter:?}: {found}");
            }
        }
        assert!((mean - 0.5).abs() < 0.04, "{filter:?}: {mean}");
    }
}

/// Texels drawn one by one have the mean of the weights that they are drawn by.
#[test]
fn drawn_texels_have_the_mean_of_their_ellipse() {
    let picture = |_: TexelFilter| {
        Picture::from_fn(64, 64, |x, y| {
            let v = 0.5 + 0.5 * (2.0 * PI * (3.0 * (x as f32 + 0.5) + 2.0 * (y as f32 + 0.5)) / 64.0).cos();
            [v, v * v, 0.0, 1.0]
        })
    };
    let [drawn, whole] =
        [TexelFilter::Stochastic, TexelFilter::Ewa].map(|filter| map(picture(filter), filter));
    let axes = [Vec2::new(0.08, 0.03), Vec2::new(-0.02, 0.05)];
    let uv = Vec2::new(0.31, 0.62);
    let expected = whole.filtered(&covering(uv, axes))[0];
    let n = 40_000;
    let sum: f32 = (0..n)
        .map(|i| {
            let at = TextureContext { p: Vec3::new(0.0, 0.0, i as f32), ..covering(uv, axes) };
            drawn.filtered(&at)[0]
        })
        .sum();
    assert!((sum / n as f32 - expected).abs() < 0.01, "{} {expected}", sum / n as f32);
}

#[test]
fn bicubic_pictures_pass_through_texels_and_affine_ones_are_exact() {
    let ramp = map(
        Picture::from_fn(16, 16, |x, y| [x as f32 / 20.0, y as f32 / 20.0, 0.5, 1.0]),
        TexelFilter::Bicubic,
    );
    let noise =
        map(Picture::from_fn(16, 16, |x, y| [Stream::new(3, [x, y], 0).uniform(0); 4]), TexelFilter::Bicubic);
    for i in 0..200 {
        let s = Stream::new(4, [i, 0], 0);
        let uv = Vec2::new(0.15 + 0.7 * s.uniform(0), 0.15 + 0.7 * s.uniform(1));
        let found = ramp.at(uv);
        assert!((found[0] - (16.0 * uv.x - 0.5) / 20.0).abs() < 3e-5);
        assert!((found[1] - (16.0 * (1.0 - uv.y) - 0.5) / 20.0).abs() < 3e-5);
        let (x, y) = (i % 16, i / 16);
        let middle = Vec2::new((x as f32 + 0.5) / 16.0, 1.0 - (y as f32 + 0.5) / 16.0);
        assert!((noise.at(middle)[0] - noise.picture.texel(x as usize, y as usize)[0]).abs() < 1e-4);
    }
}

#[test]
fn beside_a_picture_may_be_nothing() {
    let white = || Picture::from_fn(8, 8, |_, _| [1.0; 4]);
    let axes = [0.05 * Vec2::X, 0.05 * Vec2::Y];
    for filter in FILTERS {
        for (wrap, beside) in [(Wrap::Black, [0.0, 0.0, 0.0, 1.0]), (Wrap::Once, [0.0; 4])] {
            let map = PictureMap { wrap: [wrap; 2], ..map(white(), filter) };
            for uv in [Vec2::new(-0.4, 0.5), Vec2::new(0.5, 1.4), Vec2::splat(30.0), Vec2::splat(-1e30)] {
                let found = map.filtered(&covering(uv, axes));
                let near = found.iter().zip(beside).all(|(a, b)| (a - b).abs() < 1e-5);
                assert!(near, "{filter:?} {wrap:?} {uv}: {found:?}");
            }
            let inside = map.filtered(&covering(Vec2::splat(0.5), axes));
            assert!(inside.iter().all(|v| (v - 1.0).abs() < 1e-5), "{filter:?} {inside:?}");
        }
    }
}

/// However narrow a picture is, it is no work to filter it, and its mean is kept.
#[test]
fn narrow_pictures_are_filtered_too() {
    for filter in [TexelFilter::Trilinear, TexelFilter::Sat, TexelFilter::Ewa, TexelFilter::Feline] {
        for (w, h) in [(4096, 1), (1, 4096), (3, 1024)] {
            let picture = Picture::from_fn(w, h, |x, y| [((x + y) & 1) as f32; 4]);
            let map = map(picture, filter);
            for i in 0..500 {
                let s = Stream::new(13, [i, 0], 0);
                let size = 40.0 * s.uniform(2) * s.uniform(2);
                let axes = [Vec2::new(size, 0.2 * size), Vec2::new(-0.1 * size, size)];
                let uv = Vec2::new(s.uniform(0), s.uniform(1));
                let found = map.filtered(&covering(uv, axes))[0];
                let is_wide = size > 1.0 && filter != TexelFilter::Feline;
                assert!(
                    !is_wide || (found - map.means()[0]).abs() < 0.02,
                    "{filter:?} {w} x {h} {size}: {found}"
                );
            }
        }
    }
}

#[test]
fn hostile_footprints_give_shares() {
    for filter in FILTERS {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp, Wrap::Black, Wrap::Once] {
            let noise = Picture::from_fn(9, 5, |x, y| [Stream::new(3, [x, y], 0).uniform(0); 4]);
            let map = PictureMap { wrap: [wrap; 2], ..map(noise, filter) };
            for v in [f32::NAN, f32::INFINITY, 1e30, 1e-30, 1e10, 3.0, 0.0] {
                for axes in [[Vec2::X * v, Vec2::Y], [Vec2::splat(v); 2], [Vec2::X * v, Vec2::Y * v]] {
                    for uv in [Vec2::splat(0.4), Vec2::new(v, 0.3)] {
                        let found = map.filtered(&covering(uv, axes));
                        assert!(
                            found.iter().all(|v| (0.0..=1.0).contains(v)),
                            "{filter:?} {wrap:?} {v}: {found:?}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn whole_numbers_around_are_those_of_the_library() {
    let large = [f32::MAX, 9.3e18, 1e18, 3e9];
    for x in (-40..=40).map(|i| 0.25 * i as f32).chain(large).chain(large.map(|x| -x)) {
        assert_eq!(floor(x), x.floor() as i64, "{x}");
        assert_eq!(ceil(x), (x.ceil() as i64).max(-i64::MAX), "{x}");
    }
}
