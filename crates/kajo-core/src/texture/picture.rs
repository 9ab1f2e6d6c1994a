//! Pictures on surfaces.
//!
//! A picture of `w x h` texels fills the unit square of surface coordinates, its first row on top. With
//!
//! ```text
//! s = repeat u + cross u' + offset        x = w s_x - 1/2        y = h (1 - s_y) - 1/2        u' = (u_y, u_x)
//! ```
//!
//! the value is that of the nearest texel, or the bilinear mean of the four around `(x, y)`:
//!
//! ```text
//! (1-a)(1-b) T(i, j) + a (1-b) T(i+1, j) + (1-a) b T(i, j+1) + a b T(i+1, j+1),     a = x - i,  b = y - j
//! ```
//!
//! Texels are linear: what a file encodes for a screen is decoded before anything is averaged. Outside of the square
//! the picture repeats, is mirrored at its edges, ends in its last texel, or there is nothing. Many samples for a pixel average over its
//! footprint without any bias, which is what pictures are left to unless they ask for a [filter](TexelFilter).

mod filter;
#[cfg(test)]
mod filter_tests;
mod normals;
#[cfg(test)]
mod normals_tests;
mod pyramid;
mod sums;
mod tiled;
mod tiling;
mod wrap;

use std::sync::{Arc, LazyLock, OnceLock};

use kajo_color::{Spectrum, Wavelengths, srgb};
use kajo_image::Image;
use kajo_math::Vec2;

use super::rgb::rgb_reflectance;
use super::{ColorNode, FilteredNormals, SurfaceUv, TextureContext, Textures, UvSet};
use pyramid::Pyramid;
use sums::SummedAreaTable;
use tiled::TiledPicture;

pub use filter::TexelFilter;
pub(crate) use tiled::content_stamp;
pub use tiled::{ReadAt, TILED_EXTENSION, TileCache, TileFiles, TiledCopies, TiledError, TilingRule};
pub use tiling::Tiling;
pub use wrap::Wrap;

/// What the colours of a file mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Encoding {
    /// Values for a screen, after the curve of sRGB.
    Srgb,
    /// Amounts.
    Linear,
}

/// What a texel has for each number of 8 bits in a file, [of its colours, of its alpha].
type StoredBytes = [[u16; 256]; 2];

impl Encoding {
    fn stored_bytes(self) -> &'static StoredBytes {
        static LINEAR: LazyLock<StoredBytes> = LazyLock::new(|| [stored_bytes(std::convert::identity); 2]);
        static SRGB: LazyLock<StoredBytes> = LazyLock::new(|| [stored_bytes(srgb::decode), LINEAR[1]]);
        match self {
            Encoding::Srgb => &SRGB,
            Encoding::Linear => &LINEAR,
        }
    }
}

fn stored_bytes(linear: fn(f32) -> f32) -> [u16; 256] {
    std::array::from_fn(|i| stored(linear(i as f32 / 255.0)))
}

/// What a texel has for a number, which is held to [0, 1]; what is not a number becomes 0.
fn stored(v: f32) -> u16 {
    (v.clamp(0.0, 1.0) * 65535.0).round() as u16
}

/// Linear texels in [0, 1]: red, green, blue and alpha.
#[derive(Debug)]
pub struct Picture {
    width: u32,
    height: u32,
    texels: Texels,
    /// Of all texels.
    mean: [f32; 4],
    /// Smaller copies, where a filter asks for them and they are not in tiles.
    pyramid: OnceLock<Pyramid>,
    /// Sums, where a filter asks for them.
    sums: OnceLock<SummedAreaTable>,
    /// Of its texels as normals, where a material asks for them.
    moments: OnceLock<Arc<Picture>>,
}

/// Where the texels of a picture are.
#[derive(Debug)]
enum Texels {
    /// In memory, row by row.
    Resident(Vec<[u16; 4]>),
    /// In a file.
    Tiled(Box<TiledPicture>),
}

impl Picture {
    /// The picture of a file, and how many of its values were no numbers in [0, 1]; those are held to it.
    ///
    /// * `image`: at least one pixel; one or three channels, and perhaps alpha
    pub fn new(image: &Image, encoding: Encoding) -> (Picture, usize) {
        let mut outside = 0;
        let bytes: [f32; 256] = std::array::from_fn(|i| i as f32 / 255.0);
        let [colors, alphas] = encoding.stored_bytes();
        // Most pictures have 8 bits, of which there are few numbers.
        let mut counted = |v: f32, of_bytes: &[u16; 256], linear: fn(f32) -> f32| {
            let byte = usize::from((v * 255.0 + 0.5) as u8);
            if bytes[byte] == v {
                return of_bytes[byte];
            }
            let v = linear(v);
            outside += usize::from(!(0.0..=1.0).contains(&v));
            stored(v)
        };
        let linear = match encoding {
            Encoding::Srgb => srgb::decode,
            Encoding::Linear => std::convert::identity,
        };
        let texel = |pixel: &[f32]| {
            let (color, alpha) = match *pixel {
                [grey] => ([grey; 3], 1.0),
                [grey, alpha] => ([grey; 3], alpha),
                [r, g, b] => ([r, g, b], 1.0),
                [r, g, b, alpha, ..] => ([r, g, b], alpha),
                [] => ([0.0; 3], 1.0),
            };
            let [r, g, b] = color.map(|v| counted(v, colors, linear));
            [r, g, b, counted(alpha, alphas, std::convert::identity)]
        };
        let texels: Vec<_> = image.pixels().map(texel).collect();
        (Picture::of_texels([image.width(), image.height()], texels), outside)
    }

    /// The picture of linear numbers in [0, 1].
    ///
    /// * `texel`: by column and row from above; sizes are at least 1
    pub(crate) fn from_fn(width: u32, height: u32, mut texel: impl FnMut(u32, u32) -> [f32; 4]) -> Picture {
        let mut texels = Vec::new();
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            texels.push(texel(x, y).map(stored));
        }
        Picture::of_texels([width, height], texels)
    }

    fn of_texels([width, height]: [u32; 2], texels: Vec<[u16; 4]>) -> Picture {
        let mut sums = [0u64; 4];
        for texel in &texels {
            (0..4).for_each(|c| sums[c] += u64::from(texel[c]));
        }
        let mean = sums.map(|sum| (sum as f64 / (65535.0 * texels.len() as f64)) as f32);
        Picture::new_with(Texels::Resident(texels), [width, height], mean)
    }

    /// The picture of a tiled copy.
    fn in_tiles(tiled: TiledPicture, mean: [f32; 4]) -> Picture {
        let size = tiled.size();
        Picture::new_with(Texels::Tiled(Box::new(tiled)), size, mean)
    }

    fn new_with(texels: Texels, [width, height]: [u32; 2], mean: [f32; 4]) -> Picture {
        Picture {
            width,
            height,
            texels,
            mean,
            pyramid: OnceLock::new(),
            sums: OnceLock::new(),
            moments: OnceLock::new(),
        }
    }

    /// The texels, where they are in memory.
    fn resident(&self) -> Option<&[[u16; 4]]> {
        match &self.texels {
            Texels::Resident(texels) => Some(texels),
            Texels::Tiled(_) => None,
        }
    }

    /// Bytes that so many texels take in memory.
    pub(crate) fn bytes(width: u32, height: u32) -> u64 {
        u64::from(width) * u64::from(height) * size_of::<[u16; 4]>() as u64
    }

    /// Width and height in texels.
    pub(crate) fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    #[inline]
    fn stored(&self, x: usize, y: usize) -> [u16; 4] {
        match &self.texels {
            Texels::Resident(texels) => texels[y * self.width as usize + x],
            Texels::Tiled(tiled) => tiled.level(0).texel(x, y),
        }
    }

    #[inline]
    fn texel(&self, x: usize, y: usize) -> [f32; 4] {
        self.stored(x, y).map(|v| f32::from(v) * (1.0 / 65535.0))
    }
}

/// A picture laid on a surface.
#[derive(Clone, Debug)]
pub struct PictureMap {
    /// The texels, shared by all that use them.
    pub picture: Arc<Picture>,
    /// What is beside it: to its sides, and above and below.
    pub wrap: [Wrap; 2],
    /// How it fills the plane.
    pub tiling: Tiling,
    /// What is between its texels.
    pub filter: TexelFilter,
    /// Which coordinates of the surface place it.
    pub set: UvSet,
    /// How often it fits into the unit square.
    pub repeat: Vec2,
    /// How much its own coordinates grow with the other one of the surface, where it is turned.
    pub cross: Vec2,
    /// By how much of itself it is moved, to the left and down.
    pub offset: Vec2,
    /// What its channels are multiplied by, in [0, 1].
    pub factor: [f32; 4],
    /// The moments of its texels as normals, laid out alike; made by [`PictureMap::of_normals`].
    pub moments: Option<Arc<PictureMap>>,
}

/// What is to be known of textures before they are tabulated.
#[derive(Clone, Debug, Default)]
pub struct TextureDetail {
    /// The pictures that they show.
    pub pictures: Vec<PictureMap>,
    /// Whether any of them is a pattern that fills space.
    pub has_pattern: bool,
    /// Whether any of them may change at once and not linearly between the middles of texels.
    pub jumps: bool,
}

impl ColorNode for PictureMap {
    fn is_finite(&self) -> bool {
        let place = [self.repeat, self.cross, self.offset];
        place.iter().all(|v| v.is_finite()) && self.factor.iter().all(|v| v.is_finite())
    }

    fn wants_footprint(&self) -> bool {
        self.filter.wants_footprint()
    }

    fn is_on_second_set(&self) -> bool {
        self.set == UvSet::Second
    }

    fn prepare(&self) {
        self.picture.prepare(self.filter);
    }

    fn reflectance(&self, _textures: &Textures, at: &TextureContext, wavelengths: &Wavelengths) -> Spectrum {
        let [r, g, b, _] = self.filtered(at);
        rgb_reflectance([r, g, b], wavelengths)
    }

    fn color_is_filtered(&self, _textures: &Textures) -> bool {
        ColorNode::wants_footprint(self)
    }

    fn color_needs_uv(&self, _textures: &Textures) -> bool {
        true
    }

    fn color_detail(&self, _textures: &Textures, found: &mut TextureDetail) {
        self.shown(found);
    }

    fn color_mean(&self, _textures: &Textures) -> [f32; 3] {
        let [r, g, b, _] = self.means();
        [r, g, b]
    }

    fn filtered_normals(&self, _textures: &Textures, at: &TextureContext) -> Option<FilteredNormals> {
        self.normals_over(at)
    }

    /// A direction of the picture as one of the coordinates that place it.
    fn along(&self, m: Vec2) -> Vec2 {
        if self.cross == Vec2::ZERO {
            return m * self.repeat.map(f32::signum);
        }
        let right = Vec2::new(self.repeat.x, self.cross.x).normalize_or_zero();
        let up = Vec2::new(self.cross.y, self.repeat.y).normalize_or_zero();
        m.x * right + m.y * up
    }
}

impl PictureMap {
    /// A picture that fills the unit square.
    pub fn new(picture: Arc<Picture>) -> PictureMap {
        PictureMap {
            picture,
            wrap: [Wrap::default(); 2],
            tiling: Tiling::default(),
            filter: TexelFilter::default(),
            set: UvSet::default(),
            repeat: Vec2::ONE,
            cross: Vec2::ZERO,
            offset: Vec2::ZERO,
            factor: [1.0; 4],
            moments: None,
        }
    }

    /// A picture of one white texel, as a carrier of other factors.
    pub(crate) fn white() -> PictureMap {
        PictureMap::new(Arc::new(Picture::from_fn(1, 1, |_, _| [1.0; 4])))
    }

    /// Adds itself to what is `found` of other textures.
    pub(super) fn shown(&self, found: &mut TextureDetail) {
        found.jumps |= self.filter == TexelFilter::Nearest;
        found.pictures.push(self.clone());
    }

    /// Whether both pictures lie in the same place.
    pub(crate) fn lies_like(&self, other: &PictureMap) -> bool {
        let place = |map: &PictureMap| (map.wrap, map.tiling, map.set, map.repeat, map.cross, map.offset);
        place(self) == place(other)
    }

    /// How far it is from a texel to the next in surface coordinates, for a picture that is not turned.
    pub fn texel(&self) -> Vec2 {
        1.0 / (self.repeat.abs() * Vec2::new(self.picture.width as f32, self.picture.height as f32))
    }

    /// How `factor` times a number that is read from the texels changes with surface coordinates, over one texel.
    pub(super) fn slope(&self, uv: SurfaceUv, factor: f32, value: impl Fn([f32; 4]) -> f32) -> Vec2 {
        let half = 0.5 * self.texel();
        let rise = |step: Vec2| {
            let [there, back] = [step, -step].map(|step| value(self.at(uv.moved(step))));
            there - back
        };
        let rises = Vec2::new(rise(Vec2::new(half.x, 0.0)), rise(Vec2::new(0.0, half.y)));
        factor * rises / self.texel()
    }

    /// The means of all texels in each channel, however much of the picture is shown.
    pub fn means(&self) -> [f32; 4] {
        std::array::from_fn(|c| self.factor[c] * self.picture.mean[c])
    }

    /// Red, green, blue and alpha at surface coordinates, linear and in [0, 1].
    #[inline]
    pub fn at(&self, uv: impl Into<SurfaceUv>) -> [f32; 4] {
        let texel = self.tiling.show(self.picture_uv(uv.into()), self.picture.mean, |s| self.unscaled(s));
        std::array::from_fn(|c| self.factor[c] * texel[c])
    }

    /// Where surface coordinates are on the picture and its repetitions, in texels.
    pub(crate) fn in_texels(&self, uv: SurfaceUv) -> Vec2 {
        self.picture_uv(uv) * Vec2::new(self.picture.width as f32, self.picture.height as f32)
    }

    #[inline]
    fn picture_uv(&self, uv: SurfaceUv) -> Vec2 {
        let place = match self.set {
            UvSet::First => uv.first,
            UvSet::Second => uv.second,
        };
        place * self.repeat + self.cross * Vec2::new(place.y, place.x) + self.offset
    }

    /// The picture's own numbers at a place of its own.
    pub(crate) fn unscaled(&self, s: Vec2) -> [f32; 4] {
        let [across, up] = self.wrap;
        let (w, h) = (self.picture.width, self.picture.height);
        let x = across.coordinate(s.x) * w as f32;
        let y = (1.0 - up.coordinate(s.y)) * h as f32;
        let texel = |i: i64, j: i64| match (across.index(i, w), up.index(j, h)) {
            (Some(x), Some(y)) => self.picture.texel(x, y),
            (None, _) => across.beside(),
            (_, None) => up.beside(),
        };
        match self.filter {
            TexelFilter::Nearest => return texel(x.floor() as i64, y.floor() as i64),
            TexelFilter::Bicubic => return self.bicubic(s),
            _ => {}
        }
        let (x, y) = (x - 0.5, y - 0.5);
        let (i, j) = (x.floor(), y.floor());
        let (a, b) = (x - i, y - j);
        let (i, j) = (i as i64, j as i64);
        let corners = [texel(i, j), texel(i + 1, j), texel(i, j + 1), texel(i + 1, j + 1)];
        let weights = [(1.0 - a) * (1.0 - b), a * (1.0 - b), (1.0 - a) * b, a * b];
        std::array::from_fn(|c| corners.iter().zip(weights).map(|(corner, weight)| weight * corner[c]).sum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_math::rng::Stream;

    fn map(image: &Image, encoding: Encoding) -> PictureMap {
        PictureMap::new(Arc::new(Picture::new(image, encoding).0))
    }

    /// 8 x 4 texels of an affine function of their middles, which are `(i + 1/2)/8` and, from below, `(j + 1/2)/4`.
    fn ramp() -> Image {
        Image::from_fn(8, 4, |x, y| {
            let (u, v) = ((x as f32 + 0.5) / 8.0, 1.0 - (y as f32 + 0.5) / 4.0);
            [u, v, 0.25 * u + 0.5 * v, 1.0 - u]
        })
        .unwrap()
    }

    /// Numbers of 8 bits come from a table; those of 16 bits, of which some are the same, and numbers out of range do not.
    #[test]
    fn texels_are_those_of_the_curve() {
        let mut numbers: Vec<f32> = (0..=255).map(|i| i as f32 / 255.0).collect();
        numbers.extend((0..=65535).step_by(7).map(|i| i as f32 / 65535.0));
        numbers.extend([-0.25, -0.0, 1.0, 1.5, 1e30, f32::NAN, f32::INFINITY]);
        for encoding in [Encoding::Srgb, Encoding::Linear] {
            let width = numbers.len() as u32;
            let image = Image::from_fn(width, 1, |x, _| {
                let v = numbers[x as usize];
                [v, v, v, v]
            });
            let (picture, outside) = Picture::new(&image.unwrap(), encoding);
            // Three colours and alpha of -0.25, 1.5, 1e30, and what is no number or infinite.
            assert_eq!(outside, 5 * 4, "{encoding:?}");
            for (texel, &v) in picture.resident().unwrap().iter().zip(&numbers) {
                let linear = if encoding == Encoding::Srgb { srgb::decode(v) } else { v };
                let stored = |v: f32| (f64::from(v.clamp(0.0, 1.0)) * 65535.0).round() as u16;
                assert!(texel[0].abs_diff(stored(linear)) <= 1 && texel[3].abs_diff(stored(v)) <= 1, "{v}");
                assert!(texel[1] == texel[0] && texel[2] == texel[0]);
                let byte = numbers[..256].iter().position(|&byte| byte == v);
                assert!(byte.is_none_or(|byte| texel[0] == encoding.stored_bytes()[0][byte]));
            }
        }
    }

    #[test]
    fn between_texels_an_affine_picture_is_exact() {
        let map = map(&ramp(), Encoding::Linear);
        for i in 0..500 {
            let s = Stream::new(4, [i, 0], 0);
            // Up to the middles of the outermost texels.
            let uv = Vec2::new(0.0625 + 0.875 * s.uniform(0), 0.125 + 0.75 * s.uniform(1));
            let found = map.at(uv);
            let expected = [uv.x, uv.y, 0.25 * uv.x + 0.5 * uv.y, 1.0 - uv.x];
            for (found, expected) in found.into_iter().zip(expected) {
                assert!((found - expected).abs() < 2e-5, "{uv}: {found} {expected}");
            }
        }
    }

    #[test]
    fn pictures_repeat_and_are_mirrored() {
        let near = |a: [f32; 4], b: [f32; 4]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-4);
        for filter in [TexelFilter::Bilinear, TexelFilter::Nearest] {
            let tiled = PictureMap { filter, ..map(&ramp(), Encoding::Linear) };
            let mirrored = PictureMap { wrap: [Wrap::Mirror; 2], ..tiled.clone() };
            let clamped = PictureMap { wrap: [Wrap::Clamp; 2], ..tiled.clone() };
            for i in 0..500 {
                let s = Stream::new(5, [i, 0], 0);
                let uv = 20.0 * Vec2::new(s.uniform(0), s.uniform(1)) - 10.0;
                // Off the borders of texels, where rounding decides for the nearest.
                let uv = (uv * 64.0).floor() / 64.0 + 1.0 / 128.0;
                assert!(near(tiled.at(uv), tiled.at(uv + Vec2::new(3.0, -2.0))), "{uv}");
                assert!(near(mirrored.at(uv), mirrored.at(-uv)), "{uv}");
                assert!(near(mirrored.at(uv), mirrored.at(2.0 - uv)), "{uv}");
                assert!(near(clamped.at(uv), clamped.at(uv.clamp(Vec2::ZERO, Vec2::ONE))), "{uv}");
            }
            let inside = Vec2::new(0.3, 0.4);
            assert_eq!(tiled.at(inside), mirrored.at(inside));
            assert_eq!(tiled.at(inside), clamped.at(inside));
        }
        // Across its edge a tiled picture is the mean of its first and last column.
        let tiled = map(&ramp(), Encoding::Linear);
        assert!((tiled.at(Vec2::new(0.0, 0.5))[0] - 0.5).abs() < 1e-4);
        let mirrored = PictureMap { wrap: [Wrap::Mirror; 2], ..tiled };
        assert!((mirrored.at(Vec2::new(0.0, 0.5))[0] - 0.0625).abs() < 1e-4);
    }

    #[test]
    fn the_picture_is_upright_scaled_and_moved() {
        let nearest = PictureMap { filter: TexelFilter::Nearest, ..map(&ramp(), Encoding::Linear) };
        let found = nearest.at(Vec2::new(0.99, 0.99));
        assert!((found[0] - 0.9375).abs() < 1e-4 && (found[1] - 0.875).abs() < 1e-4, "{found:?}");
        let (repeat, offset) = (Vec2::new(2.0, 4.0), Vec2::new(0.25, 0.5));
        let laid = PictureMap { repeat, offset, ..nearest.clone() };
        let uv = Vec2::new(0.31, 0.17);
        assert_eq!(laid.at(uv), nearest.at(uv * repeat + offset));
        let turned = PictureMap { cross: Vec2::new(-0.5, 0.25), ..laid };
        let place = uv * repeat + Vec2::new(-0.5 * uv.y, 0.25 * uv.x) + offset;
        assert_eq!(turned.at(uv), nearest.at(place));
    }

    #[test]
    fn coordinates_and_wraps_are_chosen() {
        let nearest = PictureMap { filter: TexelFilter::Nearest, ..map(&ramp(), Encoding::Linear) };
        let (first, second) = (Vec2::new(0.3, 0.4), Vec2::new(0.8, 0.1));
        let uv = SurfaceUv { first, second };
        assert_eq!(nearest.at(uv), nearest.at(first));
        assert_eq!(PictureMap { set: UvSet::Second, ..nearest.clone() }.at(uv), nearest.at(second));
        let strip = PictureMap { wrap: [Wrap::Repeat, Wrap::Clamp], ..nearest.clone() };
        assert_eq!(strip.at(Vec2::new(2.3, 5.0)), nearest.at(Vec2::new(0.3, 0.999)));
    }

    #[test]
    fn values_for_a_screen_are_decoded_before_they_are_mixed() {
        let image = Image::from_fn(2, 1, |x, _| [x as f32, x as f32, x as f32, x as f32]).unwrap();
        let map = map(&image, Encoding::Srgb);
        let [r, .., alpha] = map.at(Vec2::new(0.5, 0.5));
        assert!((r - 0.5).abs() < 1e-4 && (alpha - 0.5).abs() < 1e-4, "half of the light, not of the number");
        let grey = Image::filled(1, 1, &[0.5]).unwrap();
        let found = Picture::new(&grey, Encoding::Srgb).0.texel(0, 0);
        assert!((found[1] - 0.2140).abs() < 1e-4 && found[3] == 1.0, "{found:?}");
    }

    #[test]
    fn what_is_no_share_is_counted_and_held() {
        let image = Image::from_fn(2, 1, |x, _| [if x == 0 { f32::NAN } else { 7.0 }, -1.0, 0.5]).unwrap();
        let (picture, outside) = Picture::new(&image, Encoding::Linear);
        assert_eq!(outside, 4);
        assert_eq!((picture.texel(0, 0)[0], picture.texel(1, 0)[0], picture.texel(0, 0)[1]), (0.0, 1.0, 0.0));
    }

    #[test]
    fn hostile_coordinates_give_shares() {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            for filter in [TexelFilter::Nearest, TexelFilter::Bilinear] {
                let map = PictureMap { wrap: [wrap; 2], filter, ..map(&ramp(), Encoding::Linear) };
                for v in
                    [f32::NAN, f32::INFINITY, -f32::MAX, 1e30, -1e-30, -0.0, 1.0, 0.999_999_94, 2.0, -7.0]
                {
                    for uv in [Vec2::new(v, 0.3), Vec2::new(0.3, v), Vec2::splat(v)] {
                        assert!(
                            map.at(uv).iter().all(|v| (0.0..=1.0).contains(v)),
                            "{wrap:?} {filter:?} {uv}"
                        );
                    }
                }
            }
        }
    }
}
