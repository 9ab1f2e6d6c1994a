//! What a picture shows, and how it gets into a file.
//!
//! A float file (OpenEXR, PFM) holds the numbers themselves. Other files hold a picture of them: distances as
//! grey, normals as colours, every object in a colour of its own.

use kajo_core::settings::MapRules;
use kajo_image::exr::{ChannelData, ExrLayer, ExrPicture};
use kajo_image::{BitDepth, EncodeOptions, Format, Image, ImageError, Quantiser, Rounding, exr};
use kajo_render::{Film, Layer, MAX_LIGHT_GROUPS};

use crate::RenderSettings;
use crate::development::Development;

/// One thing a render can show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// Light.
    Color,
    /// Distance along the camera ray to the first surface.
    Depth,
    /// Direction of the first surface.
    Normals,
    /// Coordinates on the first surface.
    Uv,
    /// Which object it belongs to, numbered from 1 in the order of the file.
    Object,
    /// Which material it has, numbered from 1 in the order of the file.
    Material,
    /// How many samples were taken.
    Samples,
    /// How much white light the first surface throws back.
    Albedo,
    /// Where the first surface moves in the picture while the shutter is open, in pixels.
    Motion,
    /// Estimated variance of the light.
    Variance,
    /// How many rays were given up in bodies that bend light.
    Lost,
    /// Where the records of an irradiance cache are.
    Records,
    /// The light of each group of emitters.
    Lights,
}

impl View {
    /// All views.
    pub const ALL: [View; 13] = [
        View::Color,
        View::Depth,
        View::Normals,
        View::Uv,
        View::Object,
        View::Material,
        View::Samples,
        View::Albedo,
        View::Motion,
        View::Variance,
        View::Lost,
        View::Records,
        View::Lights,
    ];

    /// Their names, in the same order.
    pub const NAMES: [&'static str; 13] = [
        "color", "depth", "normals", "uv", "object", "material", "samples", "albedo", "motion", "variance",
        "lost", "records", "lights",
    ];

    /// The view of that name.
    pub fn from_name(name: &str) -> Option<View> {
        View::NAMES.iter().position(|&known| known == name).map(|i| View::ALL[i])
    }

    /// The name of the view.
    pub fn name(self) -> &'static str {
        View::NAMES[self as usize]
    }

    /// What the film must record for it.
    ///
    /// * `n_groups`: groups of lights in the scene
    pub(crate) fn layers(
        self,
        format: Format,
        settings: &RenderSettings,
        n_groups: usize,
    ) -> impl Iterator<Item = Layer> {
        let groups = (0..n_groups).map(|group| Layer::Light(group as u8));
        let (one, all) = match self {
            View::Lights => (None, Some(groups)),
            _ => (Some(self.layer(format, settings)), None),
        };
        one.into_iter().chain(all.into_iter().flatten())
    }

    /// The layer that it shows, the first where there are several.
    pub(crate) fn layer(self, format: Format, settings: &RenderSettings) -> Layer {
        let numbers = holds_numbers(format);
        match self {
            View::Color => Layer::Color,
            View::Depth if !numbers && settings.depth_range.is_some() => Layer::DepthMap,
            View::Depth => Layer::Depth,
            View::Normals if numbers => Layer::Normal,
            View::Normals => Layer::NormalMap,
            View::Uv => Layer::Uv,
            View::Object => Layer::ObjectId,
            View::Material => Layer::MaterialId,
            View::Samples => Layer::SampleCount,
            View::Albedo => Layer::Albedo,
            View::Motion => Layer::Motion,
            View::Variance => Layer::Variance,
            View::Lost => Layer::LostRays,
            View::Records => Layer::CacheRecords,
            View::Lights => Layer::Light(0),
        }
    }
}

/// Whether files of the format hold any number, rather than something to look at.
fn holds_numbers(format: Format) -> bool {
    matches!(format, Format::Exr | Format::Pfm)
}

/// How a film's light is shown.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Look<'a> {
    pub development: &'a Development,
    /// The light, where it is not what the film says.
    pub light: Option<&'a Image>,
    /// Names of the groups of lights.
    pub groups: &'a [String],
    /// Whether the file is made in little time rather than small.
    pub quick: bool,
}

impl Look<'_> {
    fn color(&self, film: &Film, format: Format) -> Result<Image, ImageError> {
        let mut light = match self.light {
            Some(light) => light.clone(),
            None => develop(film, Layer::Color)?,
        };
        self.development.apply(&mut light, format);
        Ok(light)
    }
}

/// The bytes of a file that shows `views`; only OpenEXR can show more than one.
///
/// # Errors
/// When the film lacks a layer, the format cannot hold the picture, or memory runs out.
pub(crate) fn encode(
    film: &Film,
    views: &[View],
    format: Format,
    depth: BitDepth,
    settings: &RenderSettings,
    look: &Look<'_>,
) -> Result<Vec<u8>, ImageError> {
    let text = vec![("Software".to_owned(), concat!("kajo ", env!("CARGO_PKG_VERSION")).to_owned())];
    if format == Format::Exr && settings.reduction.is_some() {
        let message = "pictures whose pixels are made of several are no OpenEXR files; choose another format";
        return Err(ImageError::Parameter(message.to_owned()));
    }
    if format == Format::Exr {
        let layers = exr_layers(film, views, look)?;
        let chromaticities = look.development.chromaticities();
        let shown = film.spec().shown();
        let (width, height) = (shown.width(), shown.height());
        let encode = if look.quick { exr::encode_quickly } else { exr::encode };
        return encode(ExrPicture { width, height, layers, chromaticities, attributes: text });
    }
    let [view] = views else {
        return Err(ImageError::Parameter(format!("a {format} file shows one thing, not {}", views.len())));
    };
    let options =
        EncodeOptions { depth, quantiser: quantiser(settings), opaque_alpha: settings.opaque_alpha, text };
    let image = match view {
        View::Color => look.color(film, format)?,
        View::Lights => {
            let mut groups = picture(film, View::Lights, format, settings)?;
            look.development.apply(&mut groups, format);
            groups
        }
        _ => picture(film, *view, format, settings)?,
    };
    let image = match settings.reduction {
        Some(reduction) => reduction.reduce(&image)?,
        None => image,
    };
    kajo_image::encode(&image, format, &options)
}

/// How values become whole numbers.
pub(crate) fn quantiser(settings: &RenderSettings) -> Quantiser {
    let rounding = match settings.maps {
        MapRules::Inverted => Rounding::Nearest,
        MapRules::Direct => Rounding::Truncate,
    };
    Quantiser { rounding, ..Quantiser::default() }
}

/// The view as a picture of one or three channels.
pub(crate) fn picture(
    film: &Film,
    view: View,
    format: Format,
    settings: &RenderSettings,
) -> Result<Image, ImageError> {
    let layer = view.layer(format, settings);
    let image = develop(film, layer)?;
    match view {
        View::Uv => mapped(&image, |uv| [uv[0], uv[1], 0.0]),
        View::Motion if holds_numbers(format) => mapped(&image, |motion| [motion[0], motion[1], 0.0]),
        // A pixel to either side takes it from grey to an end of the scale.
        View::Motion => mapped(&image, |motion| [0.5 + 0.5 * motion[0], 0.5 + 0.5 * motion[1], 0.5]),
        View::Depth if layer == Layer::Depth && !holds_numbers(format) => nearness(&image),
        View::Samples if !holds_numbers(format) => {
            let most = image.data().iter().copied().fold(1.0, f32::max);
            mapped(&image, |count| [count[0] / most])
        }
        View::Lights => groups_in_colour(film, &image),
        View::Object | View::Material if !holds_numbers(format) => mapped(&image, |id| false_colour(id[0])),
        _ => Ok(image),
    }
}

pub(crate) fn develop(film: &Film, layer: Layer) -> Result<Image, ImageError> {
    film.develop(layer).ok_or_else(|| missing(film, layer))
}

fn ids(film: &Film, layer: Layer) -> Result<ChannelData, ImageError> {
    film.ids(layer).map(ChannelData::U32).ok_or_else(|| missing(film, layer))
}

/// Why there is no picture of a layer: it was not recorded, or else there is no memory.
fn missing(film: &Film, layer: Layer) -> ImageError {
    let spec = film.spec();
    let bytes = u64::from(spec.width) * u64::from(spec.height) * layer.channels() as u64 * 4;
    match spec.layers.has(layer) {
        true => ImageError::Memory { needed: bytes },
        false => ImageError::Parameter(format!("the film has no layer {layer:?}")),
    }
}

fn mapped<const N: usize>(image: &Image, map: impl Fn(&[f32]) -> [f32; N]) -> Result<Image, ImageError> {
    let mut result = Image::new(image.width(), image.height(), N)?;
    for (to, from) in result.data_mut().chunks_exact_mut(N).zip(image.pixels()) {
        to.copy_from_slice(&map(from));
    }
    Ok(result)
}

/// The light of the first group as it is, and that of each other in a colour of its own.
fn groups_in_colour(film: &Film, first: &Image) -> Result<Image, ImageError> {
    let mut sum = first.clone();
    for group in 1..MAX_LIGHT_GROUPS as u8 {
        if !film.spec().layers.has(Layer::Light(group)) {
            continue;
        }
        let light = develop(film, Layer::Light(group))?;
        let colour = false_colour(f32::from(group));
        for (sum, light) in sum.data_mut().chunks_exact_mut(3).zip(light.pixels()) {
            let grey = light.iter().sum::<f32>() / 3.0;
            sum.iter_mut().zip(colour).for_each(|(sum, share)| *sum += share * grey);
        }
    }
    Ok(sum)
}

/// Distances as grey: what is nearest in the picture is white, what is far a dark grey, misses are black.
fn nearness(depth: &Image) -> Result<Image, ImageError> {
    /// Tells the farthest surface from a miss.
    const FARTHEST: f32 = 0.1;
    let mut hits: Vec<f32> = depth.data().iter().copied().filter(|t| t.is_finite()).collect();
    if hits.is_empty() {
        return mapped(depth, |_| [0.0]);
    }
    // A floor that runs to the horizon would leave no grey for anything else: its farthest tenth is one.
    let tenth = hits.len() / 10;
    let last = hits.len() - 1 - tenth;
    let (nearer, &mut far, _) = hits.select_nth_unstable_by(last, f32::total_cmp);
    let near = nearer.iter().copied().fold(far, f32::min);
    mapped(depth, |t| {
        let share = if far > near { ((t[0] - near) / (far - near)).min(1.0) } else { 0.0 };
        [if t[0].is_finite() { 1.0 - (1.0 - FARTHEST) * share } else { 0.0 }]
    })
}

/// Black for 0 and a strong colour for every other number, neighbours far apart.
fn false_colour(id: f32) -> [f32; 3] {
    /// Turns of the colour circle by this share never meet again [Knuth 1998, 6.4].
    const GOLDEN_RATIO: f32 = 0.618_034;
    if id == 0.0 {
        return [0.0; 3];
    }
    let hue = (id * GOLDEN_RATIO).fract() * 6.0;
    // Three tents of the colour circle, a third of it apart.
    [3.0, 5.0, 1.0].map(|offset| {
        let distance = ((hue + offset) % 6.0 - 3.0).abs();
        0.25 + 0.7 * (distance - 1.0).clamp(0.0, 1.0)
    })
}

fn exr_layers(film: &Film, views: &[View], look: &Look<'_>) -> Result<Vec<ExrLayer>, ImageError> {
    // Colour and distance share the main layer, where compositors look for `Z`.
    let mut main = ExrLayer::default();
    let mut others = Vec::new();
    for view in views {
        match view {
            View::Color => main.channels.extend(planes(&look.color(film, Format::Exr)?, &["R", "G", "B"])),
            View::Depth => main.channels.extend(planes(&develop(film, Layer::Depth)?, &["Z"])),
            View::Normals => {
                others.push(named("N", planes(&develop(film, Layer::Normal)?, &["X", "Y", "Z"])))
            }
            View::Uv => others.push(named("uv", planes(&develop(film, Layer::Uv)?, &["U", "V"]))),
            View::Object => {
                others.push(named("object", vec![("id".to_owned(), ids(film, Layer::ObjectId)?)]))
            }
            View::Material => {
                others.push(named("material", vec![("id".to_owned(), ids(film, Layer::MaterialId)?)]))
            }
            View::Samples => {
                others.push(named("samples", planes(&develop(film, Layer::SampleCount)?, &["count"])));
            }
            View::Albedo => {
                others.push(named("albedo", planes(&develop(film, Layer::Albedo)?, &["R", "G", "B"])));
            }
            View::Motion => others.push(named("motion", planes(&develop(film, Layer::Motion)?, &["X", "Y"]))),
            View::Variance => {
                others.push(named("variance", planes(&develop(film, Layer::Variance)?, &["R", "G", "B"])));
            }
            View::Lost => others.push(named("lost", planes(&develop(film, Layer::LostRays)?, &["count"]))),
            View::Records => {
                others.push(named("records", planes(&develop(film, Layer::CacheRecords)?, &["share"])));
            }
            View::Lights => {
                for (group, name) in (0..).zip(look.groups) {
                    let mut light = develop(film, Layer::Light(group))?;
                    look.development.apply(&mut light, Format::Exr);
                    others.push(named(&format!("lights.{name}"), planes(&light, &["R", "G", "B"])));
                }
            }
        }
    }
    if !main.channels.is_empty() {
        others.insert(0, main);
    }
    Ok(others)
}

fn named(name: &str, channels: Vec<(String, ChannelData)>) -> ExrLayer {
    ExrLayer { name: Some(name.to_owned()), channels }
}

fn planes(image: &Image, names: &[&str]) -> Vec<(String, ChannelData)> {
    let plane = |c: usize| ChannelData::F32(image.pixels().map(|pixel| pixel[c]).collect());
    names.iter().enumerate().map(|(c, &name)| (name.to_owned(), plane(c))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_go_both_ways() {
        for view in View::ALL {
            assert_eq!(View::from_name(view.name()), Some(view));
        }
        assert_eq!(View::from_name("colour"), None);
    }

    #[test]
    fn near_is_white_and_misses_are_black() {
        let depth = Image::from_data(2, 2, 1, vec![5.0, 7.0, f32::INFINITY, 6.0]).unwrap();
        let grey = nearness(&depth).unwrap();
        for (found, expected) in grey.data().iter().zip([1.0, 0.1, 0.0, 0.55]) {
            assert!((found - expected).abs() < 1e-6, "{found} for {expected}");
        }
        let horizon = Image::from_fn(20, 1, |x, _| [if x < 18 { 1.0 + x as f32 } else { 1e6 }]).unwrap();
        let grey = nearness(&horizon).unwrap();
        assert_eq!((grey.pixel(0, 0)[0], grey.pixel(19, 0)[0]), (1.0, grey.pixel(17, 0)[0]));
        assert!(grey.pixel(8, 0)[0] < 0.7, "the near part has most of the greys");
        let nothing = Image::filled(1, 1, &[f32::INFINITY]).unwrap();
        assert_eq!(nearness(&nothing).unwrap().data(), [0.0]);
        let flat = Image::filled(1, 1, &[3.0]).unwrap();
        assert_eq!(nearness(&flat).unwrap().data(), [1.0]);
    }

    #[test]
    fn false_colours_differ_and_none_is_black() {
        let colours: Vec<_> = (0..50).map(|id| false_colour(id as f32).map(|v| (v * 255.0) as u8)).collect();
        assert_eq!(colours[0], [0; 3]);
        for (i, a) in colours.iter().enumerate() {
            assert!(colours[..i].iter().all(|b| a != b), "number {i} looks like an earlier one");
            assert!(i == 0 || a.iter().any(|&v| v > 200), "number {i} is dark: {a:?}");
        }
    }
}
