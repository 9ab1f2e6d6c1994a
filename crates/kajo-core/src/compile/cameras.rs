//! Which of several cameras takes the picture, and what they see of what they name.

use std::ops::Range;

use kajo_math::DVec3;
use kajo_scene::{Diagnostic, Diagnostics, Item, SceneDesc, Span, nearest};

use super::CompileOptions;
use super::aim::{Aim, FitKey, Subject, usual_direction};
use super::camera::CameraRequest;
use super::lens::Focus;
use crate::camera::fit::{Fit, FitError, Freedom, centred};
use crate::camera::{Camera, CameraFrame, MovingCamera, NamedCamera};
use crate::motion::Shutter;
use crate::scene::{Extent, Fitted, FittedCamera, Scene};

/// Width over height of a picture of which nothing is known.
const USUAL_ASPECT: f64 = 4.0 / 3.0;

/// The index of the camera that takes the picture: the one of that name, or the last. `None` without any.
pub(super) fn chosen(cameras: &[CameraRequest<'_>], name: Option<&str>) -> Option<usize> {
    let named = name.and_then(|name| cameras.iter().rposition(|c| c.name.as_deref() == Some(name)));
    named.or_else(|| cameras.len().checked_sub(1))
}

/// When the chosen camera gathers light, and what holds without one.
pub(super) fn shutter_of(
    cameras: &[CameraRequest<'_>],
    chosen: Option<usize>,
    usual: Shutter,
) -> (Shutter, f32) {
    chosen.map_or((usual, 0.0), |i| (cameras[i].shutter, cameras[i].readout))
}

/// Puts the cameras into a scene, whose objects they may name.
///
/// The last camera of the scene takes the picture, unless `options` say otherwise.
pub(super) fn span(
    scene: &mut Scene,
    requests: Vec<CameraRequest<'_>>,
    desc: &SceneDesc,
    options: &CompileOptions,
    diagnostics: &mut Diagnostics,
) {
    let own = scene.output.settings.size.map(|[width, height]| f64::from(width) / f64::from(height.max(1)));
    let has_own = !requests.is_empty();
    let mut cameras = Vec::with_capacity(requests.len() + scene.output.cameras.len());
    let mut fits = Vec::with_capacity(requests.len());
    for request in requests {
        let natural = request.camera.natural_aspect().map(f64::from);
        let aspect = options.aspect.or(own).or(natural).unwrap_or(USUAL_ASPECT);
        let name = request.name.clone();
        let resolver = Resolver { scene, desc, aspect, item: request.item, diagnostics };
        if let Some((camera, fitted)) = resolver.camera(request) {
            cameras.push(NamedCamera { name, camera });
            fits.push(fitted);
        }
    }
    let of_model = scene.output.cameras.first().filter(|_| options.model_cameras_first || !has_own);
    let is_of_model = of_model.is_some();
    if let Some(NamedCamera { camera, .. }) = of_model.or(cameras.last()).cloned() {
        scene.output.camera = camera;
        scene.output.fitted = if is_of_model { None } else { fits.last().cloned().flatten() };
    }
    cameras.append(&mut scene.output.cameras);
    scene.output.cameras = cameras;
    let Some(name) = options.camera.as_deref() else { return };
    match scene.output.cameras.iter().rposition(|camera| camera.name.as_deref() == Some(name)) {
        Some(found) => {
            scene.output.camera = scene.output.cameras[found].camera.clone();
            scene.output.fitted = fits.get(found).cloned().flatten();
        }
        None if diagnostics.has_errors() => {}
        None => diagnostics.push(no_such_camera(scene, name)),
    }
}

fn no_such_camera(scene: &Scene, name: &str) -> Diagnostic {
    let names = || scene.output.cameras.iter().filter_map(|camera| camera.name.as_deref());
    let list: Vec<String> = names().map(|name| format!("`{name}`")).collect();
    let help = match (nearest(name, names()), list.is_empty()) {
        (_, true) => {
            "its cameras have no names; one is given as in `PerspectiveCamera front { ... }`".to_owned()
        }
        (Some(near), _) if list.len() > 1 => format!("did you mean `{near}`? There are {}", list.join(", ")),
        _ => format!("there are {}", list.join(", ")),
    };
    Diagnostic::error(format!("the scene has no camera named `{name}`")).help(help)
}

struct Resolver<'s, 't, 'd> {
    scene: &'s Scene,
    desc: &'t SceneDesc,
    aspect: f64,
    item: Item<'t>,
    diagnostics: &'d mut Diagnostics,
}

impl<'s, 't> Resolver<'s, 't, '_> {
    /// The camera as it stands in the scene, and what it fits into its picture; `None` when an error was reported.
    fn camera(mut self, request: CameraRequest<'t>) -> Option<(Camera, Option<FittedCamera>)> {
        let CameraRequest { camera, aim, motion, focus, has_opening, raw_up, .. } = request;
        let (mut camera, mut fitted) = match aim.needs_scene() {
            true => self.aimed(camera, &aim, has_opening, raw_up)?,
            false => (camera, None),
        };
        if let Some((item, focus)) = focus
            && let Some(p) = self.sharp_point(&focus, item.head_span())?
        {
            camera = self.focused(camera, p, item.head_span())?;
            fitted.iter_mut().for_each(|fitted| fitted.focus = Some(p));
        }
        fitted.iter_mut().for_each(|fitted| fitted.motion.clone_from(&motion));
        let camera = match motion {
            Some(map) => Camera::Moving(Box::new(MovingCamera { camera, map })),
            None => camera,
        };
        Some((camera, fitted))
    }

    fn aimed(
        &mut self,
        camera: Camera,
        aim: &Aim<'t>,
        has_opening: bool,
        raw_up: bool,
    ) -> Option<(Camera, Option<FittedCamera>)> {
        let target = match &aim.target {
            None => None,
            Some((_, Subject::Point(p))) => Some(*p),
            Some((item, subject)) => Some(self.extent(subject, item.head_span())?.middle()),
        };
        let Some(fit) = &aim.fit else {
            let center = aim.center?;
            return Some((self.framed(camera, aim, center, target? - center, raw_up), None));
        };
        let extent = self.extent(&fit.subject, fit.item.head_span())?;
        let freedom = match (aim.center, target) {
            (Some(_), _) if has_opening => {
                let error = Diagnostic::error("nothing is left to be found for `fit`");
                let error = error.label(fit.item.head_span(), "what shall change?");
                let help = "leave out `center`, and the camera goes where it fits; or the `angle` or `size`, and it sees as much";
                self.diagnostics.push(error.help(help));
                return None;
            }
            (Some(_), _) => Freedom::Opening,
            (None, Some(_)) => Freedom::Distance,
            (None, None) => Freedom::Position,
        };
        let direction = match (aim.center, target) {
            (Some(center), Some(target)) => target - center,
            (Some(center), None) if aim.direction.is_none() => {
                let up = aim.up();
                centred(center, up, &|n| extent.support(n)).unwrap_or_else(|| extent.middle() - center)
            }
            _ => aim.direction.unwrap_or_else(|| usual_direction(aim.up())),
        };
        let center = aim.center.or(target).unwrap_or(DVec3::ZERO);
        let fitted = FittedCamera {
            written: self.framed(camera, aim, center, direction, raw_up),
            fit: Fit { freedom, aspect: self.aspect, margin: fit.margin },
            objects: match &fit.subject {
                Subject::Named(name) => {
                    Fitted::Named { name: name.clone().into_owned(), items: self.items_named(name) }
                }
                Subject::Point(_) | Subject::Scene => Fitted::All,
            },
            keeps_size: has_opening,
            focus: None,
            motion: None,
        };
        match fitted.framed(&extent) {
            Ok(camera) => Some((camera, Some(fitted))),
            Err(error) => {
                self.diagnostics.push(explained(error, fit));
                None
            }
        }
    }

    fn framed(
        &mut self,
        camera: Camera,
        aim: &Aim<'t>,
        center: DVec3,
        direction: DVec3,
        raw_up: bool,
    ) -> Camera {
        let (frame, problem) = aim.frame(center, direction);
        if let Some((_, why)) = problem {
            let warning = Diagnostic::warning(why).label(self.item.keyword_span(), "says too little");
            self.diagnostics.push(warning);
        }
        camera.with_frame(if raw_up { frame.with_raw_up(aim.up()) } else { frame })
    }

    /// The point that is to be sharp, where that is not a distance; the outer `None` when an error was reported.
    fn sharp_point(&mut self, focus: &Focus<'t>, span: Span) -> Option<Option<DVec3>> {
        match focus {
            Focus::Distance(_) => Some(None),
            Focus::On(Subject::Point(p)) => Some(Some(*p)),
            Focus::On(subject) => Some(Some(self.extent(subject, span)?.middle())),
        }
    }

    /// The camera with its lens focused on a point.
    fn focused(&mut self, camera: Camera, p: DVec3, span: Span) -> Option<Camera> {
        let CameraFrame { center, forward, .. } = *camera.frame();
        let focused = camera.focused_on(p);
        if focused.is_none() {
            let error = Diagnostic::error("the camera cannot focus on what is behind it");
            let behind = (center - p).dot(forward) as f32;
            self.diagnostics.push(error.label(span, format!("{behind} behind it")));
        }
        focused
    }

    /// What is to be seen; empty, with a warning, where the scene has nothing.
    fn extent(&mut self, subject: &Subject<'_>, span: Span) -> Option<Extent<'s>> {
        let name = match subject {
            Subject::Point(_) | Subject::Scene => {
                let extent = self.scene.geometry.extent(|_| true);
                if extent.is_empty() {
                    let warning = Diagnostic::warning("there is nothing in this scene that has an end");
                    self.diagnostics.push(warning.label(span, "a ball around the origin is taken for it"));
                }
                return Some(extent);
            }
            Subject::Named(name) => name,
        };
        let places = self.items_named(name);
        let is_named = |own: Option<&str>, placed_by: u32| {
            own == Some(&**name) || places.iter().any(|range| range.contains(&placed_by))
        };
        let extent = self.scene.geometry.extent(|object| is_named(object.name, object.placed_by));
        if !extent.is_empty() {
            return Some(extent);
        }
        let is_there =
            !places.is_empty() || self.scene.geometry.objects.iter().any(|o| o.name == Some(&**name));
        let error = match is_there {
            true => Diagnostic::error(format!("`{name}` has no end, or nothing in it")),
            false => Diagnostic::error(format!("there is no object named `{name}`")),
        };
        let words = self.words();
        let known = self
            .scene
            .geometry
            .objects
            .iter()
            .filter_map(|object| object.name)
            .chain(words.iter().map(|w| &**w));
        let near = nearest(name, known).filter(|_| !is_there);
        let help = match near {
            Some(near) => format!("did you mean `{near}`?"),
            None => {
                "objects are named as in `Sphere moon { ... }`; `scene` stands for all of them".to_owned()
            }
        };
        self.diagnostics.push(error.label(span, "asked for here").help(help));
        None
    }

    /// Blocks in the scene's group that have a word after them.
    fn blocks_with_words(&self) -> impl Iterator<Item = Item<'t>> + use<'t> {
        let groups = self.desc.roots().filter(|item| item.keyword() == "Group");
        let within = |group: Item<'t>| group.index()..group.next_index();
        let ranges: Vec<Range<u32>> = groups.map(within).collect();
        let is_within = move |item: &Item<'_>| ranges.iter().any(|range| range.contains(&item.index()));
        let has_word = |item: &Item<'_>| item.word().is_some() && item.keyword() != "MaterialIndex";
        self.desc.items().filter(move |item| has_word(item) && is_within(item))
    }

    /// Numbers of the items in the blocks of that name.
    fn items_named(&self, name: &str) -> Vec<Range<u32>> {
        let is_named = |item: &Item<'_>| item.word().is_some_and(|word| word.text() == name);
        let named = self.blocks_with_words().filter(is_named);
        named.map(|item| item.index()..item.next_index()).collect()
    }

    fn words(&self) -> Vec<String> {
        let is_block = |item: &Item<'_>| item.has_block() || item.keyword() == "Instance";
        let words = self.blocks_with_words().filter(is_block);
        words.filter_map(|item| item.word().map(|word| word.text().into_owned())).collect()
    }
}

fn explained(error: FitError, fit: &FitKey<'_>) -> Diagnostic {
    let (message, help) = match error {
        FitError::Around => (
            "no picture from there holds all of it",
            "a part of it is beside or behind the camera: leave out `center`, and the camera goes where it fits",
        ),
        FitError::SeesAll => (
            "this camera sees all around; nothing can fit it better",
            "write where it is: `center`, `direction` and `up`",
        ),
        FitError::NoAngle => (
            "with this angle of view nothing fits the picture",
            "write one between 0 and 180, such as `angle 40`",
        ),
        FitError::NoAxes => {
            ("`up` is the direction in which the camera looks", "write another `up` or another `direction`")
        }
    };
    Diagnostic::error(message).label(fit.item.head_span(), "to be fitted").help(help)
}
