//! Pictures of how a picture is put together: where the samples of its pixels lie, and the shape of its filter.
//!
//! Each pixel is shown as a block of `zoom x zoom`, as in assignment 7 of MIT 6.837, fall 2004.

use kajo_core::sampler::SampleStream;
use kajo_image::{Image, ImageError};
use kajo_render::Filter;

use crate::RenderSettings;

/// The most pixels of a diagram.
const MOST_PIXELS: u64 = 1 << 24;

/// Smallest zoom at which the borders of pixels are drawn; below they would hide the samples.
const BORDERED: u32 = 4;

/// Grey of the borders of pixels.
const BORDER: f32 = 0.25;

/// White dots on black where the samples of the pixels lie, and grey lines where pixels begin.
///
/// * `zoom`: columns and rows for a pixel
///
/// # Errors
/// [`ImageError::Parameter`] when the picture would have no pixels, or too many.
pub fn sample_positions(settings: &RenderSettings, zoom: u32) -> Result<Image, ImageError> {
    let [width, height] = zoomed(settings.size, zoom)?;
    let mut image = Image::new(width, height, 1)?;
    if zoom >= BORDERED {
        for y in 0..height {
            for x in (0..width).filter(|x| x % zoom == 0 || y % zoom == 0) {
                image.pixel_mut(x, y)[0] = BORDER;
            }
        }
    }
    let sampler = settings.sampler();
    for (y, x) in (0..settings.size[1]).flat_map(|y| (0..settings.size[0]).map(move |x| (y, x))) {
        for k in 0..sampler.samples() {
            let place = SampleStream::new(&sampler, settings.seed, [x, y], k).film_position();
            let at = |pixel: u32, offset: f32| pixel * zoom + (offset * zoom as f32) as u32;
            let (x, y) = (at(x, place.x), at(y, place.y));
            // Samples of a number that is no square may lie below the last row.
            if x < width && y < height {
                image.pixel_mut(x, y)[0] = 1.0;
            }
        }
    }
    Ok(image)
}

/// The weights of samples around the middle of the middle pixel: white is the largest, black nothing, and red is negative.
///
/// * `zoom`: columns and rows for a pixel
///
/// # Errors
/// As those of [`sample_positions`].
pub fn filter_shape(settings: &RenderSettings, zoom: u32) -> Result<Image, ImageError> {
    let [width, height] = zoomed(settings.size, zoom)?;
    // Without a filter a sample counts for its own pixel.
    let filter = if settings.filter == Filter::None { Filter::BOX } else { settings.filter };
    let middle = settings.size.map(|n| (n / 2) as f32 + 0.5);
    let offset = |at: u32, middle: f32| (at as f32 + 0.5) / zoom as f32 - middle;
    let most = filter.weight(0.0, 0.0);
    Image::from_fn(width, height, |x, y| {
        let weight = filter.weight(offset(x, middle[0]), offset(y, middle[1])) / most;
        [weight.abs(), weight.max(0.0), weight.max(0.0)]
    })
}

fn zoomed(size: [u32; 2], zoom: u32) -> Result<[u32; 2], ImageError> {
    let [width, height] = size.map(|n| u64::from(n) * u64::from(zoom));
    match (u32::try_from(width), u32::try_from(height)) {
        (Ok(w), Ok(h)) if (1..=MOST_PIXELS).contains(&width.saturating_mul(height)) => Ok([w, h]),
        _ => Err(ImageError::Parameter(format!(
            "a picture of {} x {} pixels, {zoom} times as large, has no pixels or more than {MOST_PIXELS}",
            size[0], size[1]
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Defaults, LoadOptions, MemoryAssets, SamplerKind, Settings, load_from};

    fn settings(size: [u32; 2], samples: (SamplerKind, u32), filter: Filter) -> RenderSettings {
        let text = "OrthographicCamera { center 0 0 5 direction 0 0 -1 up 0 1 0 size 5 }";
        let loaded = load_from("s.txt", &MemoryAssets::new().with("s.txt", text), &LoadOptions::default());
        let asked = Settings { size: Some(size), samples: Some(samples), ..Settings::default() };
        let resolved =
            RenderSettings::resolve(&loaded.scene.unwrap(), &asked, Defaults::Classic, false).unwrap();
        RenderSettings { filter, ..resolved }
    }

    #[test]
    fn samples_are_dots_where_they_lie() {
        // Of a grid of four, the middles of the quarters of each pixel.
        let image = sample_positions(&settings([2, 1], (SamplerKind::Regular, 4), Filter::None), 8).unwrap();
        assert_eq!((image.width(), image.height()), (16, 8));
        for y in 0..8 {
            for x in 0..16 {
                let dot = [2, 6].contains(&(x % 8)) && [2, 6].contains(&y);
                let border = x % 8 == 0 || y == 0;
                let expected = if dot { 1.0 } else { f32::from(u8::from(border)) * BORDER };
                assert_eq!(image.pixel(x, y), [expected], "{x} {y}");
            }
        }
        // One random sample in each pixel; of three on a grid of one, two lie below.
        let random = sample_positions(&settings([3, 3], (SamplerKind::Uniform, 1), Filter::None), 3).unwrap();
        assert_eq!(random.data().iter().filter(|&&v| v == 1.0).count(), 9);
        let tall = sample_positions(&settings([1, 1], (SamplerKind::Regular, 3), Filter::None), 3).unwrap();
        assert_eq!(tall.data().iter().filter(|&&v| v == 1.0).count(), 1);
    }

    #[test]
    fn filters_have_their_shape() {
        let shape = |filter| filter_shape(&settings([3, 3], (SamplerKind::Regular, 1), filter), 10).unwrap();
        let bright = |image: &Image, x, y| image.pixel(x, y)[1];
        let own = shape(Filter::None);
        assert_eq!([bright(&own, 9, 15), bright(&own, 10, 15), bright(&own, 19, 10)], [0.0, 1.0, 1.0]);
        let cone = shape(Filter::Cone { radius: 1.0 });
        // 0.3 right and 0.4 below of the middle of the picture, less half a small pixel each.
        let expected = 1.0 - 0.35f32.hypot(0.45);
        assert!((bright(&cone, 18, 19) - expected).abs() < 1e-6);
        let gaussian = shape(Filter::gaussian(0.5));
        assert!((bright(&gaussian, 19, 15) - (-2.0 * (0.45f32 * 0.45 + 0.05 * 0.05)).exp()).abs() < 1e-6);
        let lobes = shape(Filter::MITCHELL);
        let [r, g, b] = lobes.rgb(29, 15);
        assert!(r > 0.0 && g == 0.0 && b == 0.0, "{r} {g} {b}");
    }

    #[test]
    fn sizes_without_sense_are_refused() {
        let settings = settings([1000, 1000], (SamplerKind::Regular, 1), Filter::None);
        for zoom in [0, 5, u32::MAX] {
            assert!(matches!(sample_positions(&settings, zoom), Err(ImageError::Parameter(_))));
            assert!(matches!(filter_shape(&settings, zoom), Err(ImageError::Parameter(_))));
        }
    }
}
