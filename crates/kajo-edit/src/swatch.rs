//! Small pictures of textures and of the materials that show them.
//!
//! A swatch lies flat before one who looks along -z: surface coordinates go from 0 to 1 across it, and patterns, which fill
//! space, show the square `z = 0` around the origin. That is as small as it can be with most of what the pattern has in it.

use kajo_color::srgb;
use kajo_core::scene::Scene;
use kajo_core::texture::{SurfaceUv, TextureContext};
use kajo_math::{Vec2, Vec3};

use crate::{Document, Kind, NodeId};

/// Rows and columns of a swatch.
pub const SWATCH_SIZE: u32 = 96;

/// Points to a side of a pixel, whose mean it is.
const POINTS: u32 = 2;

/// Quarters of the width of the square that are tried, from the smallest; each is half the next.
const NARROWEST: f32 = 0.125;
const WIDTHS: i32 = 14;

/// Points along a side of the square where a width is tried.
const TRIED: u32 = 12;

/// The part of the largest contrast of any width that is enough.
const ENOUGH: f32 = 0.75;

/// What a swatch shows.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum SwatchOf {
    /// A texture, by its name.
    Texture(String),
    /// A material, by its number in the id layers, from 1.
    Material(u32),
}

/// A small picture of a texture.
#[derive(Clone, Debug, PartialEq)]
pub struct Swatch {
    /// Red, green, blue, encoded in sRGB, and 255 for each pixel; [`SWATCH_SIZE`] rows of as many pixels, row 0 on top.
    pub rgba: Vec<u8>,
    /// How wide it is in space; `None` where the texture depends on surface coordinates, of which all are shown.
    pub width: Option<f32>,
}

impl Document {
    /// What a swatch can show of a node: a texture with a name, or a material whose colours differ from place to place. `None` for
    /// anything else, and before there is a scene.
    pub fn swatch_of(&self, id: NodeId) -> Option<SwatchOf> {
        let (node, scene) = (self.node(id)?, self.scene()?);
        match node.kind {
            Kind::Texture => node.name.as_deref().and_then(|name| self.swatch_named(name)),
            Kind::Material => {
                let (number, (material, _)) =
                    (1..).zip(&scene.appearance.list).find(|(n, _)| self.node_of_material(*n) == Some(id))?;
                scene.appearance.varies(*material).then_some(SwatchOf::Material(number))
            }
            _ => None,
        }
    }

    /// What a swatch can show of a name that stands for a texture; `None` where none has it.
    pub fn swatch_named(&self, name: &str) -> Option<SwatchOf> {
        let is_known = self.scene()?.appearance.named_textures.contains_key(name);
        is_known.then(|| SwatchOf::Texture(name.to_owned()))
    }
}

impl Swatch {
    /// The picture of something in a scene; `None` where the scene has no such thing.
    pub fn new(scene: &Scene, of: &SwatchOf) -> Option<Swatch> {
        let appearance = &scene.appearance;
        match of {
            SwatchOf::Texture(name) => {
                let texture = appearance.named_textures.get(name)?;
                let color = |at: &TextureContext| texture.rgb(appearance.textures.evaluator(at));
                Some(Swatch::drawn(|at| Vec3::from(color(at).to_rgb())))
            }
            SwatchOf::Material(number) => {
                let (material, _) = *appearance.list.get(number.checked_sub(1)? as usize)?;
                let color = |at: &TextureContext| crate::preview::color_at(scene, material, at);
                Some(Swatch::drawn(color))
            }
        }
    }

    fn drawn(color: impl Fn(&TextureContext) -> Vec3) -> Swatch {
        let needs_uv = needs_uv(&color);
        let width = if needs_uv { 1.0 } else { telling_width(&color) };
        let fine = SWATCH_SIZE * POINTS;
        let mut rgba = Vec::with_capacity(4 * (SWATCH_SIZE * SWATCH_SIZE) as usize);
        for (y, x) in (0..SWATCH_SIZE).flat_map(|y| (0..SWATCH_SIZE).map(move |x| (y, x))) {
            let points = (0..POINTS).flat_map(|j| (0..POINTS).map(move |i| [POINTS * x + i, POINTS * y + j]));
            let mean = points.map(|cell| color(&place(cell, fine, -0.5 * width, width))).sum::<Vec3>()
                / (POINTS * POINTS) as f32;
            let shown = mean.to_array().map(|v| (255.0 * srgb::encode(v.clamp(0.0, 1.0))).round() as u8);
            rgba.extend(shown.into_iter().chain([255]));
        }
        Swatch { rgba, width: (!needs_uv).then_some(width) }
    }
}

/// The middle of a cell of a grid over a square, counted from the left and from the top.
///
/// * `low`: the left and lower corner of the square, twice the same number
fn place([x, y]: [u32; 2], cells: u32, low: f32, width: f32) -> TextureContext {
    let uv = Vec2::new(x as f32 + 0.5, (cells - 1 - y) as f32 + 0.5) / cells as f32;
    let p = (low + width * uv).extend(0.0);
    TextureContext { p, uv: SurfaceUv::from(uv), n: Vec3::Z, ..TextureContext::default() }
}

/// Whether colours differ between surface coordinates at one place.
fn needs_uv(color: &impl Fn(&TextureContext) -> Vec3) -> bool {
    let cells = (0..TRIED).flat_map(|y| (0..TRIED).map(move |x| [x, y]));
    let mut colors =
        cells.map(|cell| color(&TextureContext { p: Vec3::ZERO, ..place(cell, TRIED, 0.0, 1.0) }));
    let first = colors.next();
    colors.any(|color| Some(color) != first)
}

/// A width of the square at which a texture has most of its contrast in a sixteenth of it.
fn telling_width(color: &impl Fn(&TextureContext) -> Vec3) -> f32 {
    let quarters: Vec<f32> = (0..WIDTHS).map(|i| NARROWEST * (i as f32).exp2()).collect();
    let contrasts: Vec<f32> = quarters.iter().map(|&quarter| contrast(quarter, color)).collect();
    let largest = contrasts.iter().copied().fold(0.0, f32::max);
    let telling = quarters.iter().zip(&contrasts).find(|(_, contrast)| **contrast >= ENOUGH * largest);
    // One that is the same all over is shown as wide as patterns usually repeat.
    if largest == 0.0 { 2.0 } else { telling.map_or(2.0, |(&quarter, _)| 4.0 * quarter) }
}

/// The standard deviation of the colours in a square with a corner at the origin, where several parts of a pattern may meet.
fn contrast(width: f32, color: &impl Fn(&TextureContext) -> Vec3) -> f32 {
    let cells = (0..TRIED).flat_map(|y| (0..TRIED).map(move |x| [x, y]));
    let colors: Vec<Vec3> = cells.map(|cell| color(&place(cell, TRIED, 0.0, width))).collect();
    let mean = colors.iter().sum::<Vec3>() / colors.len() as f32;
    let variance = colors.iter().map(|c| c.distance_squared(mean)).sum::<f32>() / colors.len() as f32;
    if variance.is_finite() { variance.sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo::LoadOptions;
    use std::path::Path;

    const TEXT: &str = "PerspectiveCamera { center 0 0 9  direction 0 0 -1  up 0 1 0  angle 30 }
        Textures {
            Checks small { size 0.25 }  Checks large { size 40 }
            Gradient laid { wave once  projection uv }
            Ramp red { texture laid  stop 0 0 0 0  stop 1 1 0 0 }
        }
        Materials { Matte plain { color 0.2 0.3 0.4 }  Matte covered { color red } }
        Group { MaterialIndex covered  Sphere { center 0 0 0  radius 1 } }";

    fn document() -> Document {
        let mut document = Document::untitled(Path::new("."), TEXT, LoadOptions::default()).unwrap();
        document.compile();
        assert!(document.scene().is_some(), "{}", document.report(false));
        document
    }

    fn of(document: &Document, name: &str) -> Option<SwatchOf> {
        let node = document.outline().nodes().iter().find(|node| node.name.as_deref() == Some(name)).unwrap();
        document.swatch_of(node.id)
    }

    fn swatch(name: &str) -> Swatch {
        let document = document();
        Swatch::new(document.scene().unwrap(), &of(&document, name).unwrap()).unwrap()
    }

    fn pixel(swatch: &Swatch, x: u32, y: u32) -> [u8; 3] {
        let begin = 4 * (y * SWATCH_SIZE + x) as usize;
        [0, 1, 2].map(|i| swatch.rgba[begin + i])
    }

    #[test]
    fn textures_and_what_shows_them_have_swatches() {
        let document = document();
        assert_eq!(of(&document, "red"), Some(SwatchOf::Texture("red".to_owned())));
        assert_eq!(of(&document, "covered"), Some(SwatchOf::Material(2)));
        assert_eq!(of(&document, "plain"), None);
        assert_eq!(document.swatch_named("green"), None);
        assert_eq!(Swatch::new(document.scene().unwrap(), &SwatchOf::Material(9)), None);
    }

    #[test]
    fn surface_coordinates_go_from_left_to_right() {
        for name in ["red", "covered"] {
            let swatch = swatch(name);
            assert_eq!(swatch.width, None);
            let row: Vec<u8> = (0..SWATCH_SIZE).map(|x| pixel(&swatch, x, 40)[0]).collect();
            assert!(row.is_sorted() && row[0] < 60 && row[95] > 200, "{name}: {row:?}");
        }
    }

    /// Of any size, some squares of a pattern are seen, and each of them is large enough to be.
    #[test]
    fn the_square_is_as_large_as_what_repeats_in_it() {
        for (name, size) in [("small", 0.25), ("large", 40.0)] {
            let swatch = swatch(name);
            let width = swatch.width.unwrap();
            assert!((2.0 * size..=16.0 * size).contains(&width), "{name}: {width}");
            let is_white = |x: u32| pixel(&swatch, x, 3)[0] > 128;
            let turns = (1..SWATCH_SIZE).filter(|&x| is_white(x) != is_white(x - 1)).count();
            assert!((1..16).contains(&turns), "{name}: {turns}");
        }
    }
}
