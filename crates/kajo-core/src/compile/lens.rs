//! The keys of cameras that make a lens of the pinhole.

use std::borrow::Cow;
use std::sync::Arc;

use kajo_math::piecewise::Piecewise2D;
use kajo_scene::{Args, Diagnostic, Item, Params};

use super::Compiler;
use super::aim::{Subject, subject};
use crate::camera::{Aperture, ThinLens};

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
    Picture(Item<'a>, Cow<'a, str>),
}

impl<'a> LensKeys<'a> {
    /// Reads the keys; `None` for a pinhole, or when an error was reported.
    pub(super) fn read(params: &mut Params<'a, '_>) -> Option<LensKeys<'a>> {
        let diameter = diameter(params);
        let focus = match diameter {
            Some(_) => params.required("focus", focus),
            None => params.optional("focus", focus),
        };
        let blades = params.optional("blades", |a| a.int_in(3..=64));
        let rotation = params.or("bladeRotation", 0.0, Args::number);
        let picture = params.optional("bokeh", |args| Ok((args.item(), args.text()?)));
        let opening = match (picture, blades) {
            (Some((item, name)), _) => Opening::Picture(item, name),
            (None, Some(blades)) => {
                Opening::Polygon { blades: blades as u32, rotation: f64::from(rotation).to_radians() }
            }
            (None, None) => Opening::Round,
        };
        if diameter.is_none() {
            params.idle(&["focus", "blades", "bladeRotation", "bokeh"], "without an `aperture`");
        } else if matches!(opening, Opening::Picture(..)) {
            params.idle(&["blades", "bladeRotation"], "beside `bokeh`");
        }
        let diameter = diameter.filter(|&d| d > 0.0)?;
        Some(LensKeys { diameter, focus: focus?, opening })
    }

    /// What the lens is to focus on, unless that is a distance.
    pub(super) fn subject(&self) -> Option<(Item<'a>, Focus<'a>)> {
        Some(self.focus.clone()).filter(|(_, focus)| matches!(focus, Focus::On(_)))
    }
}

/// A distance, a point, or the name of something.
fn focus<'a>(args: &mut Args<'a>) -> Result<(Item<'a>, Focus<'a>), Diagnostic> {
    let is_subject = args.is_word() || args.numbers_left() > 1;
    let focus = match is_subject {
        true => Focus::On(subject(args)?),
        false => Focus::Distance(args.positive()?.into()),
    };
    Ok((args.item(), focus))
}

/// The diameter of the opening, said directly or as in photography.
fn diameter(params: &mut Params<'_, '_>) -> Option<f64> {
    let aperture = params.optional("aperture", |a| Ok((a.item(), a.number_in(0.0..)?)));
    let by_number = params.has("fNumber") || params.has("focalLength");
    if !by_number {
        return aperture.map(|(_, diameter)| diameter.into());
    }
    let f_number = params.required("fNumber", Args::positive);
    let focal_length = params.required("focalLength", Args::positive);
    if let Some((item, _)) = aperture {
        let error = Diagnostic::error("a camera has either `aperture` or `fNumber` and `focalLength`");
        params.diagnostics().push(error.label(item.head_span(), "one too many"));
    }
    Some(f64::from(focal_length?) / f64::from(f_number?))
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
