//! What a mean of normals loses.

use std::sync::Arc;

use kajo_math::Vec2;
use kajo_math::rng::Stream;

use super::{Picture, PictureMap, TexelFilter, Tiling};
use crate::texture::{ColorNode, NormalSpread, TextureContext, TextureFootprint, Textures};

const N: u32 = 128;
const FILTERS: [TexelFilter; 4] =
    [TexelFilter::Trilinear, TexelFilter::Sat, TexelFilter::Ewa, TexelFilter::Feline];

/// Normals with the components `x` and `y` by column and row.
fn normals(filter: TexelFilter, component: impl Fn(u32, u32) -> [f32; 2]) -> PictureMap {
    let stored = |column, row| {
        let [x, y] = component(column, row);
        let z = (1.0 - x * x - y * y).sqrt();
        [x, y, z].map(|m| 0.5 + 0.5 * m)
    };
    let picture = Picture::from_fn(N, N, |column, row| {
        let [r, g, b] = stored(column, row);
        [r, g, b, 1.0]
    });
    let map = PictureMap { filter, ..PictureMap::new(Arc::new(picture)) };
    map.prepare();
    map
}

fn spread(map: &PictureMap, uv: Vec2, texels: f32) -> NormalSpread {
    let width = texels / N as f32;
    let footprint =
        TextureFootprint { uv: [Vec2::new(width, 0.0), Vec2::new(0.0, width)], ..TextureFootprint::POINT };
    let at = TextureContext { uv: uv.into(), footprint, ..TextureContext::default() };
    map.filtered_normals(&Textures::default(), &at).map_or(NormalSpread::default(), |found| found.spread)
}

/// Facets of random slopes: far away their variances are those of the numbers drawn, from near nothing is left of them.
#[test]
fn far_away_variances_are_those_of_the_facets() {
    let facet = |column, row| {
        let s = Stream::new(5, [column, row], 0);
        let (a, b) = (s.uniform(0) - 0.5, s.uniform(1) - 0.5);
        [0.6 * a, 0.3 * b + 0.3 * a]
    };
    let expected = NormalSpread { xx: 0.36 / 12.0, yy: 0.18 / 12.0, xy: 0.18 / 12.0 };
    for filter in FILTERS {
        let map = normals(filter, facet);
        assert!(spread(&map, Vec2::splat(0.5), 32.0).is_none(), "not asked for as normals");
        let map = map.of_normals();
        let mut mean = NormalSpread::default();
        for i in 0..64 {
            let s = Stream::new(6, [i, 0], 0);
            let found = spread(&map, Vec2::new(s.uniform(0), s.uniform(1)), 24.0);
            mean.xx += found.xx / 64.0;
            mean.yy += found.yy / 64.0;
            mean.xy += found.xy / 64.0;
        }
        for (found, expected) in [(mean.xx, expected.xx), (mean.yy, expected.yy), (mean.xy, expected.xy)] {
            assert!((found / expected - 1.0).abs() < 0.08, "{filter:?}: {mean:?}");
        }
        assert!(spread(&map, Vec2::splat(0.4), 0.0).is_none());
        assert!(spread(&map, Vec2::splat(0.4), 0.05).xx < 1e-4);
    }
}

/// A surface that leans everywhere alike has no facets, rounding of eight bits included.
#[test]
fn even_normals_stay_smooth() {
    for filter in FILTERS {
        let map = normals(filter, |_, _| [77.0 / 255.0, -31.0 / 255.0]).of_normals();
        for texels in [0.5, 3.0, 50.0] {
            assert!(spread(&map, Vec2::new(0.37, 0.61), texels).is_none(), "{filter:?}");
        }
    }
}

/// Where normals turn evenly, their variance is that of the footprint: `g^2 v` for a gradient of `g` a texel and a kernel of variance `v`.
#[test]
fn even_bends_spread_with_the_footprint() {
    let gradient = 1.0 / 256.0;
    let map = normals(TexelFilter::Ewa, |column, _| [gradient * (column as f32 - 64.0), 0.0]).of_normals();
    for texels in [4.0, 8.0, 16.0] {
        let found = spread(&map, Vec2::splat(0.5), texels).xx;
        let expected = gradient * gradient * 0.085_136 * texels * texels;
        assert!((found - expected).abs() < 0.1 * expected + 1e-4, "{texels}: {found} for {expected}");
    }
}

#[test]
fn texels_that_are_drawn_or_mixed_have_no_spread() {
    let facet = |column: u32, _| [if column.is_multiple_of(2) { 0.4 } else { -0.4 }, 0.0];
    for filter in [TexelFilter::Nearest, TexelFilter::Bilinear, TexelFilter::Bicubic, TexelFilter::Stochastic]
    {
        let map = normals(filter, facet);
        assert_eq!(map.moment_bytes(), 0);
        let map = map.of_normals();
        assert!(spread(&map, Vec2::splat(0.5), 9.0).is_none(), "{filter:?}");
        assert!(map.picture.moments.get().is_none(), "nothing is made in vain");
    }
    let random = PictureMap { tiling: Tiling::Random, ..normals(TexelFilter::Ewa, facet) };
    assert!(spread(&random.of_normals(), Vec2::splat(0.5), 9.0).is_none());
    let map = normals(TexelFilter::Ewa, facet);
    assert!(map.moment_bytes() > 0);
    let [once, again] = [map.clone().of_normals(), map.of_normals()];
    assert_eq!(once.moment_bytes(), 0, "made once for all");
    let moments = [once, again].map(|map| map.moments.map(|of| Arc::as_ptr(&of.picture)));
    assert_eq!(moments[0], moments[1]);
}
