//! Terrain from pictures and functions.

use std::sync::Arc;

use kajo_image::Image;
use kajo_math::tape::Tape;
use kajo_math::{Vec2, Vec3};
use kajo_scene::{Diagnostic, Item, Span};

use super::Compiler;
use super::picture_files::{format_of, read_picture};
use crate::shape::{HeightField, HeightFieldError, HeightGrid, ShapeId};

/// A height field as a block asks for it.
pub(super) struct HeightFieldRequest {
    /// Where its numbers are from.
    pub source: HeightSource,
    /// Middle of the rectangle, where heights count from.
    pub center: Vec3,
    /// Sides along x and z.
    pub size: Vec2,
    /// What 0 and 1 stand for.
    pub heights: Vec2,
    /// Height of the floor.
    pub base: Option<f32>,
    pub smooth: bool,
}

/// Where heights are from.
pub(super) enum HeightSource {
    /// The pixels of a picture.
    Picture {
        /// Its name.
        name: String,
        /// Where that is named.
        span: Span,
    },
    /// The values of a function of x and z.
    Function {
        /// y is 0 for it.
        function: Arc<Tape>,
        /// Points along the longer side.
        resolution: u32,
    },
}

impl Compiler<'_> {
    /// The terrain of a block; why there is none is reported.
    pub(super) fn height_field(&mut self, item: Item<'_>, request: HeightFieldRequest) -> Option<ShapeId> {
        let HeightFieldRequest { source, center, size, heights, base, smooth } = request;
        let mut grid = match &source {
            HeightSource::Picture { name, span } => self.heights_of_picture(name, item, *span)?,
            HeightSource::Function { function, resolution } => {
                self.heights_of_function(function, *resolution, size, item)?
            }
        };
        let [low, high] = heights.to_array().map(f64::from);
        let height = |value: f32| f64::from(center.y) + low + f64::from(value) * (high - low);
        grid.heights.iter_mut().for_each(|value| *value = height(*value) as f32);
        let size = size.as_dvec2();
        let corner = Vec2::new(center.x, center.z).as_dvec2() - 0.5 * size;
        let base = base.map(|base| f64::from(center.y) + f64::from(base));
        match (HeightField::new(grid, corner, size, base, smooth), source) {
            (Ok(field), _) => self.shape(item, field),
            (
                Err(error @ (HeightFieldError::TooSmall { .. } | HeightFieldError::NotFinite { .. })),
                HeightSource::Picture { name, span },
            ) => {
                self.cannot_read(&name, &error.to_string(), span);
                None
            }
            (Err(error), _) => {
                let error =
                    Diagnostic::error(error.to_string()).label(item.head_span(), "nothing is left of this");
                self.diagnostics.push(error);
                None
            }
        }
    }

    /// The numbers of a picture's first channel; memory is taken for a field of them.
    fn heights_of_picture(&mut self, name: &str, item: Item<'_>, span: Span) -> Option<HeightGrid> {
        let picture = self.picture_of_heights(name, item, span)?;
        let (columns, rows) = (picture.width(), picture.height());
        if let Err(over) = self.options.limits.memory.take(HeightField::bytes(columns, rows)) {
            self.cannot_read(name, &over.to_string(), span);
            return None;
        }
        Some(HeightGrid { columns, rows, heights: picture.pixels().map(|pixel| pixel[0]).collect() })
    }

    /// The values of a function of x and z, counted from the middle of a rectangle.
    fn heights_of_function(
        &mut self,
        function: &Tape,
        resolution: u32,
        size: Vec2,
        item: Item<'_>,
    ) -> Option<HeightGrid> {
        let longer = size.max_element();
        let points = |side: f32| {
            let share = f64::from(side / longer) * f64::from(resolution - 1);
            (share.round() as u32).clamp(1, resolution - 1) + 1
        };
        let (columns, rows) = (points(size.x), points(size.y));
        if let Err(over) = self.options.limits.memory.take(HeightField::bytes(columns, rows)) {
            let error = Diagnostic::error(format!("{columns} x {rows} heights: {over}"));
            self.diagnostics.push(error.label(item.head_span(), "a smaller `resolution` would do"));
            return None;
        }
        let at =
            |i: u32, count: u32, side: f32| (f64::from(i) / f64::from(count - 1) - 0.5) * f64::from(side);
        let mut slots = Vec::new();
        let mut heights = Vec::with_capacity(columns as usize * rows as usize);
        for row in 0..rows {
            let z = at(row, rows, size.y);
            heights.extend(
                (0..columns)
                    .map(|column| function.at(&[at(column, columns, size.x), 0.0, z], &mut slots) as f32),
            );
        }
        Some(HeightGrid { columns, rows, heights })
    }

    /// The numbers of a file as it stores them.
    fn picture_of_heights(&mut self, name: &str, item: Item<'_>, span: Span) -> Option<Image> {
        let limits = &self.options.limits;
        let file = self.assets.open(name, item.path()).map_err(|error| error.to_string());
        let read = file.and_then(|file| {
            let decoded = read_picture(file, format_of(name), limits.picture_bytes, &limits.memory)?;
            let floats = size_of_val(decoded.image.data()) as u64;
            // Held while the heights are taken from it.
            let _floats = limits.memory.share(floats).map_err(|over| over.to_string())?;
            Ok(decoded.image)
        });
        read.map_err(|reason: String| self.cannot_read(name, &reason, span)).ok()
    }
}

#[cfg(test)]
mod tests {
    use kajo_image::{BitDepth, EncodeOptions, Format, encode};
    use kajo_math::Ray;
    use kajo_scene::{Diagnostics, MemoryAssets, SceneDesc};

    use super::*;
    use crate::compile::{CompileOptions, compile};
    use crate::scene::Scene;

    /// Pictures of three columns and two rows, whose first row is 0, 0.25, 1, and some that are none.
    fn assets() -> MemoryAssets {
        let file = |[columns, rows]: [u32; 2], format, depth, h: fn(u32, u32) -> f32| {
            let options = EncodeOptions { depth, ..EncodeOptions::default() };
            encode(&Image::from_fn(columns, rows, |x, y| [h(x, y), 0.5, 0.5]).unwrap(), format, &options)
                .unwrap()
        };
        MemoryAssets::new()
            .with("8.png", file([3, 2], Format::Png, BitDepth::Eight, hill_of))
            .with("16.png", file([3, 2], Format::Png, BitDepth::Sixteen, hill_of))
            .with("float.pfm", file([3, 2], Format::Pfm, BitDepth::Eight, |x, y| 100.0 * hill_of(x, y)))
            .with("float.exr", file([3, 2], Format::Exr, BitDepth::Eight, |x, y| -2.0 * hill_of(x, y)))
            .with("dot.png", file([1, 1], Format::Png, BitDepth::Eight, |_, _| 0.5))
            .with("row.png", file([3, 1], Format::Png, BitDepth::Eight, |_, _| 0.5))
            .with(
                "hole.pfm",
                file(
                    [3, 2],
                    Format::Pfm,
                    BitDepth::Eight,
                    |x, y| {
                        if (x, y) == (2, 1) { f32::NAN } else { 0.5 }
                    },
                ),
            )
            .with("text.png", "no picture")
    }

    fn hill_of(x: u32, y: u32) -> f32 {
        if y == 0 { [0.0, 0.25, 1.0][x as usize] } else { 0.5 }
    }

    fn compiled(object: &str) -> Result<Scene, String> {
        let text = format!(
            "PerspectiveCamera {{ center 0 0 9 direction 0 0 -1 up 0 1 0 angle 30 }}
             Materials {{ Matte {{ }} Matte {{ emission 1 }} }} Group {{ MaterialIndex 0 {object} }}"
        );
        let mut parsed = SceneDesc::parse_str(&text);
        let mut diagnostics = Diagnostics::default();
        let scene = compile(&mut parsed.desc, &assets(), &CompileOptions::default(), &mut diagnostics);
        let said: Vec<String> = diagnostics.iter().map(|d| d.message.clone()).collect();
        scene.filter(|_| said.is_empty()).ok_or_else(|| said.join(" / "))
    }

    /// A saddle of x and z around its middle, at points of a grid and between them.
    #[test]
    fn functions_are_heights() {
        let saddle = "HeightField { function = x^2 - z^2  size 2 1  center 5 3 0  resolution 9 }";
        let scene = compiled(saddle).unwrap();
        for (x, z, expected) in
            [(0.0, 0.0, 0.0), (0.5, 0.25, 0.1875), (-0.75, 0.0, 0.5625), (0.125, 0.0, 0.03125)]
        {
            let found = height(&scene, 5.0 + x, z);
            assert!((found - 3.0 - expected).abs() < 1e-6, "{found} at {x} {z}");
        }
        let steep = compiled("HeightField { function = x  size 2 2  heights 1 3 }").unwrap();
        assert!((height(&steep, 0.5, 0.3) - 2.0).abs() < 1e-5);
        let said = |object: &str| compiled(object).err().unwrap_or_default();
        assert!(said("HeightField { }").contains("`HeightField` needs `file`"));
        assert!(
            said("HeightField { function = 1 / x  resolution 3 }")
                .contains("column 2 of row 1 is not a finite number")
        );
        assert!(said("HeightField { function = x  file 8.png }").contains("function"));
        assert!(said("HeightField { file 8.png  resolution 8 }").contains("resolution"));
        assert!(said("HeightField { function = x  resolution 1 }").contains("resolution"));
    }

    /// The height of a scene at a place, seen from far above.
    fn height(scene: &Scene, x: f32, z: f32) -> f32 {
        let ray = Ray::new(Vec3::new(x, 512.0, z), Vec3::NEG_Y);
        let at = scene.trace(&ray);
        at.surface().expect("there is terrain below").point.p.y
    }

    /// The first row is at the least z, columns go along x, and numbers are not put through the curve of a screen.
    #[test]
    fn pictures_lie_as_maps_and_their_numbers_are_heights() {
        for (name, scale) in [("8.png", 1.0), ("16.png", 1.0), ("float.pfm", 100.0), ("float.exr", -2.0)] {
            let scene =
                compiled(&format!("HeightField {{ file {name}  center 1 2 3  size 4 6  heights -1 1 }}"));
            let scene = scene.unwrap_or_else(|said| panic!("{name}: {said}"));
            let tolerance = if name == "8.png" { 0.5 / 255.0 * 2.0 } else { 2e-5 * f32::abs(scale) };
            for (x, z, value) in
                [(-1.0, 0.0, 0.0), (1.0, 0.0, 0.25), (3.0, 0.0, 1.0), (-1.0, 6.0, 0.5), (0.0, 0.0, 0.125)]
            {
                let found = height(&scene, x, z);
                let expected = 2.0 - 1.0 + 2.0 * scale * value;
                assert!((found - expected).abs() <= tolerance, "{name}: {found} for {expected} at {x} {z}");
            }
        }
    }

    #[test]
    fn what_is_no_terrain_is_told() {
        let said = |block: &str| compiled(&format!("HeightField {{ {block} }}")).err().unwrap_or_default();
        assert!(said("size 1 1").contains("needs `file`"), "{}", said("size 1 1"));
        for (block, expected) in [
            ("file none.png", "cannot read `none.png`"),
            ("file text.png", "cannot read `text.png`"),
            ("file dot.png", "1 x 1 heights make no surface"),
            ("file row.png", "3 x 1 heights make no surface"),
            ("file hole.pfm", "the height in column 3 of row 2 is not a finite number"),
            ("file 8.png size 0 1", "both sides of the rectangle must be above zero"),
            ("file 8.png size 1 -1", "both sides of the rectangle must be above zero"),
            ("file 8.png base 1", "no height is above the base"),
        ] {
            assert!(said(block).contains(expected), "{block}: {}", said(block));
        }
    }

    #[test]
    fn solids_have_a_base_and_sheets_are_no_operands() {
        let field = |more: &str| format!("HeightField {{ file 8.png  size 2 2  {more} }}");
        let cut = |more: &str| {
            compiled(&format!("Intersection {{ {}  Sphere {{ center 0 0 0 radius 0.5 }} }}", field(more)))
        };
        assert!(cut("base -1").is_ok());
        assert!(cut("").is_err_and(|said| said.contains("must have an inside")), "{:?}", cut("").err());
        for (more, count) in [("", 1), ("base -1", 6)] {
            let emissive = compiled(&format!("MaterialIndex 1 {}", field(more))).unwrap();
            assert_eq!(emissive.lighting.lights.areas.len(), count, "one for each part");
        }
    }
}
