//! The keys of cameras that make a lens of the pinhole.

use std::sync::Arc;

use kajo_math::piecewise::Piecewise2D;
use kajo_scene::{Args, Diagnostic, Item, Params};

use super::Compiler;
use super::aim::{Subject, subject};
use super::fields::{
    At, FileName, Given, Keys, Plain, Sources, Typed, any_angle, at_least, count, file, keys, positive,
};
use crate::camera::{Aperture, ThinLens};
use crate::schema::{FieldKind, FieldSpec};

/// A lens as the scene asks for it, its picture not read yet.
pub(super) struct LensKeys<'a> {
    diameter: f64,
    focus: (Item<'a>, Focus<'a>),
    opening: Opening<'a>,
}

/// What a lens makes sharp.
#[derive(Clone, Debug)]
pub(super) enum Focus<'a> {
    Distance(f64),
    /// A point, or the middle of something.
    On(Subject<'a>),
}

enum Opening<'a> {
    Round,
    Polygon { blades: u32, rotation: f64 },
    Picture(Item<'a>, String),
}

keys! {
    /// The keys as they are written.
    LensFields<'t> {
        aperture: Given<'t, f32> = at_least("aperture", 0.0)
            .unit("length")
            .only_beside("focus")
            .not_beside(&["fNumber", "focalLength"])
            .or(0.0, "diameter of the lens's opening")
            .given(),
        focus: Option<At<'t, Focus<'t>>> = Typed::<Focus<'_>>::new("focus", FieldKind::POSITIVE)
            .unit("length")
            .placed()
            .unlike("all is sharp", "5", "distance of what is sharp; or a point, or the name of an object"),
        f_number: Option<f32> = positive("fNumber")
            .only_beside("focus")
            .together_with("focalLength")
            .not_beside(&["aperture"])
            .unlike("none", "2.8", "focal length over diameter"),
        focal_length: Option<f32> = positive("focalLength")
            .unit("length")
            .only_beside("focus")
            .together_with("fNumber")
            .not_beside(&["aperture"])
            .unlike("none", "0.05", "of the lens"),
        blades: Option<u32> = count("blades", 3, 64).unlike("round", "6", "the opening is a polygon"),
        blade_rotation: f32 = any_angle("bladeRotation").or(0.0, "turns the polygon"),
        bokeh: Option<At<'t, FileName>> = file("bokeh").placed().option("a picture of the opening"),
    }
}

impl<'a> LensKeys<'a> {
    /// Reads the keys; `None` for a pinhole, or when an error was reported.
    pub(super) fn read(params: &mut Params<'a, '_>, sources: &mut Sources<'_>) -> Option<LensKeys<'a>> {
        let keys = LensFields::read(params, sources)?;
        let diameter = diameter(&keys, params);
        if diameter.is_some() {
            params.report_missing("focus");
        }
        let opening = match (keys.bokeh, keys.blades) {
            (Some(picture), _) => Opening::Picture(picture.item, picture.value.0),
            (None, Some(blades)) => {
                Opening::Polygon { blades, rotation: f64::from(keys.blade_rotation).to_radians() }
            }
            (None, None) => Opening::Round,
        };
        if diameter.is_none() {
            params.idle(&["focus", "blades", "bladeRotation", "bokeh"], "without an `aperture`");
        } else if matches!(opening, Opening::Picture(..)) {
            params.idle(&["blades", "bladeRotation"], "beside `bokeh`");
        }
        let diameter = diameter.filter(|&d| d > 0.0)?;
        let focus = keys.focus?;
        Some(LensKeys { diameter, focus: (focus.item, focus.value), opening })
    }

    /// What the lens is to focus on, unless that is a distance.
    pub(super) fn subject(&self) -> Option<(Item<'a>, Focus<'a>)> {
        Some(self.focus.clone()).filter(|(_, focus)| matches!(focus, Focus::On(_)))
    }
}

/// A distance, a point, or the name of something.
impl<'t> Plain<'t> for Focus<'t> {
    fn parse(spec: &FieldSpec, args: &mut Args<'t>, _: &mut Sources<'_>) -> Result<Focus<'t>, Diagnostic> {
        let is_subject = args.is_word() || args.numbers_left() > 1;
        Ok(match is_subject {
            true => Focus::On(subject(args)?),
            false => Focus::Distance(args.number_in(spec.kind.bounds())?.into()),
        })
    }
}

/// The diameter of the opening, said directly or as in photography.
fn diameter(keys: &LensFields<'_>, params: &mut Params<'_, '_>) -> Option<f64> {
    let by_number = params.contains("fNumber") || params.contains("focalLength");
    if !by_number {
        return keys.aperture.item.map(|_| keys.aperture.value.into());
    }
    params.report_missing("fNumber");
    params.report_missing("focalLength");
    if let Some(item) = keys.aperture.item {
        let error = Diagnostic::error("a camera has either `aperture` or `fNumber` and `focalLength`");
        params.diagnostics().push(error.label(item.head_span(), "one too many"));
    }
    Some(f64::from(keys.focal_length?) / f64::from(keys.f_number?))
}

impl Compiler<'_> {
    /// The lens that was asked for, with its picture.
    pub(super) fn lens(&mut self, keys: LensKeys<'_>) -> Option<ThinLens> {
        let aperture = match keys.opening {
            Opening::Round => Aperture::Round,
            Opening::Polygon { blades, rotation } => Aperture::Polygon { blades, rotation },
            Opening::Picture(item, name) => {
                let picture = self.picture(item, &name)?;
                let brightness: Vec<f32> =
                    picture.rgb_pixels().map(|[r, g, b]| 0.2126 * r + 0.7152 * g + 0.0722 * b).collect();
                let Some(density) = Piecewise2D::new(&brightness, picture.width() as usize) else {
                    let error = Diagnostic::error("a lens whose opening is all black lets no light through");
                    self.diagnostics.push(error.label(item.head_span(), "opening"));
                    return None;
                };
                Aperture::Picture(Arc::new(density))
            }
        };
        let focus = match keys.focus.1 {
            Focus::Distance(distance) => distance,
            // Until it is known where that is.
            Focus::On(_) => 1.0,
        };
        Some(ThinLens { aperture, radius: 0.5 * keys.diameter, focus })
    }
}
