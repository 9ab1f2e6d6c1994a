//! Where a camera stands and looks: keys that say it in numbers, and keys that name what is to be seen.
//!
//! ```text
//! center 0 1 5   direction 0 0 -1           a place and a direction
//! center 0 1 5   target 0 1 0               a place and a point
//! center 0 1 5   target vase                a place and the middle of an object
//! lookAt 0 1 5  0 1 0  0 1 0                a place, a point and what is up
//! fit scene                                 from where everything is seen
//! fit vase 0.1   direction -1 -1 -2         an object with a tenth of the picture free at each edge
//! ```
//!
//! What is not written is found: with `fit` the place or, where that is written, how much the camera sees. Objects are known
//! only when the whole scene has been read, so names are looked up then.

use std::borrow::Cow;

use kajo_math::{DVec3, Vec3};
use kajo_scene::{Args, Diagnostic, Item, Params};

use super::fields::{At, Field, Keys, Optional, Plain, Sources, Typed, keys, point, vector};
use crate::camera::CameraFrame;
use crate::schema::{FieldKind, FieldSpec, NumberRange};

/// The share of the picture that `fit` leaves free at each edge by default.
const MARGIN: f32 = 0.05;

/// A point of the scene, or something in it.
#[derive(Clone, Debug)]
pub(super) enum Subject<'a> {
    Point(DVec3),
    /// Everything.
    Scene,
    /// All objects of this name.
    Named(Cow<'a, str>),
}

/// What `fit` says.
#[derive(Clone, Debug)]
pub(super) struct FitKey<'a> {
    pub item: Item<'a>,
    pub subject: Subject<'a>,
    /// Share of the picture.
    pub margin: f64,
}

/// Where a camera stands and looks, as the scene says it.
#[derive(Clone, Debug, Default)]
pub(super) struct Aim<'a> {
    pub center: Option<DVec3>,
    pub direction: Option<DVec3>,
    pub target: Option<(Item<'a>, Subject<'a>)>,
    pub up: Option<DVec3>,
    pub fit: Option<FitKey<'a>>,
}

impl<'a> Aim<'a> {
    /// Reads the keys; `None` when an error was reported.
    ///
    /// * `others`: words after `fit` that mean something else to this camera
    pub fn read(params: &mut Params<'a, '_>, sources: &mut Sources<'_>, others: &[&str]) -> Option<Aim<'a>> {
        let before = params.diagnostics().count(kajo_scene::Severity::Error);
        // The last one whose word is none of the others, which are left to be asked for.
        let is_other = |item: Item<'_>| item.word().is_some_and(|word| others.contains(&&*word.text()));
        let fit = fit_field().read_where(params, sources, |item| !is_other(item))?;
        let mut aim = Aim { fit, ..Aim::default() };
        params.either(&["target", "lookAt"], "a camera");
        let AimKeys { center, direction, target, look_at, up } = AimKeys::read(params, sources)?;
        aim.target = target.map(|target| (target.item, target.value));
        let is_line = matches!(look_at, Some(LookAt::Line { .. }));
        match look_at {
            Some(LookAt::Subject(item, subject)) => aim.target = Some((item, subject)),
            Some(LookAt::Line { item, eye, target, up }) => {
                (aim.center, aim.up) = (Some(eye), up);
                aim.target = Some((item, Subject::Point(target)));
            }
            None => {}
        }
        let misread = params.diagnostics().count(kajo_scene::Severity::Error) > before;
        let (is_fitted, has_target) = (aim.fit.is_some(), aim.target.is_some());
        if !(is_fitted || is_line || misread) {
            params.report_missing("center");
        }
        if !(is_fitted || has_target || misread) {
            params.report_missing("direction");
            params.report_missing("up");
        }
        let [center, direction, up] = [center, direction, up].map(|v| v.map(|v| v.as_dvec3()));
        if is_line {
            params.idle(&["center"], "beside a `lookAt` that says where the camera is");
            if aim.up.is_some() {
                params.idle(&["up"], "beside a `lookAt` that says what is up");
            }
        }
        if has_target && !is_fitted {
            params.idle(&["direction"], "beside what the camera looks at");
        } else if has_target && center.or(aim.center).is_some() {
            params.idle(&["direction"], "beside the place of the camera and what it looks at");
        }
        aim.center = aim.center.or(center);
        aim.direction = direction;
        aim.up = aim.up.or(up);
        (params.diagnostics().count(kajo_scene::Severity::Error) == before).then_some(aim)
    }

    /// Whether objects of the scene have a say in where the camera stands or looks.
    pub fn needs_scene(&self) -> bool {
        let is_point = |(_, subject): &(Item<'_>, Subject<'_>)| matches!(subject, Subject::Point(_));
        self.fit.is_some() || self.target.as_ref().is_some_and(|target| !is_point(target))
    }

    /// The frame that stands at `center` and looks along `direction`, with what was said to be up.
    ///
    /// Returns what is wrong with it too: the key, and why.
    pub fn frame(
        &self,
        center: DVec3,
        direction: DVec3,
    ) -> (CameraFrame, Option<(&'static str, &'static str)>) {
        let up = self.up.unwrap_or_else(|| usual_up(direction));
        let frame = CameraFrame::new(center, direction, up);
        let problem = if frame.right != DVec3::ZERO {
            None
        } else if direction == DVec3::ZERO {
            let key = if self.target.is_some() { "target" } else { "direction" };
            let why = match key {
                "target" => "a camera cannot look at the place where it stands",
                _ => "a camera without a `direction` looks nowhere",
            };
            Some((key, why))
        } else {
            Some(("up", "with `up` along `direction`, or without a length, every pixel sees the same"))
        };
        (frame, problem)
    }

    /// What is up.
    pub fn up(&self) -> DVec3 {
        self.up.unwrap_or(DVec3::Y)
    }
}

/// What is up where nothing is said: y, and -z for who looks along that.
fn usual_up(direction: DVec3) -> DVec3 {
    let forward = direction.normalize_or_zero();
    if forward.cross(DVec3::Y).length() > 1e-6 { DVec3::Y } else { DVec3::NEG_Z }
}

/// The direction from before the right shoulder and above, in which things look like something; for what is `up`.
pub(super) fn usual_direction(up: DVec3) -> DVec3 {
    let up = up.try_normalize().unwrap_or(DVec3::Y);
    // Things that stand upright along y look towards z, those along z towards -y.
    let front = if up.z.abs() > 0.7 { DVec3::NEG_Y } else { DVec3::Z };
    let right = up.cross(front).normalize_or(DVec3::X);
    let front = right.cross(up);
    -(0.55 * right + 0.42 * up + front)
}

/// What is said by a `lookAt`.
enum LookAt<'a> {
    Subject(Item<'a>, Subject<'a>),
    /// As other programs have it.
    Line {
        item: Item<'a>,
        eye: DVec3,
        target: DVec3,
        up: Option<DVec3>,
    },
}

fn look_at<'a>(args: &mut Args<'a>) -> Result<LookAt<'a>, Diagnostic> {
    let item = args.item();
    let count = args.numbers_left();
    if args.is_word() || count < 4 {
        return Ok(LookAt::Subject(item, subject(args)?));
    }
    let (eye, target) = (args.vec3()?.as_dvec3(), args.vec3()?.as_dvec3());
    let up = if count > 6 { Some(args.vec3()?.as_dvec3()) } else { None };
    Ok(LookAt::Line { item, eye, target, up })
}

/// A point, or the name of something.
pub(super) fn subject<'a>(args: &mut Args<'a>) -> Result<Subject<'a>, Diagnostic> {
    if !args.is_word() {
        return Ok(Subject::Point(args.vec3()?.as_dvec3()));
    }
    let name = args.text()?;
    Ok(if name == "scene" { Subject::Scene } else { Subject::Named(name) })
}

keys! {
    AimKeys<'t> {
        center: Option<Vec3> = point("center").option("where it is"),
        direction: Option<Vec3> = vector("direction").option("where it looks"),
        target: Option<At<'t, Subject<'t>>> = Typed::<Subject<'_>>::new("target", FieldKind::Point)
            .not_beside(&["lookAt"])
            .placed()
            .option("the point it looks at, or the name of an object"),
        look_at: Option<LookAt<'t>> = Typed::<LookAt<'_>>::new("lookAt", FieldKind::Numbers(&[NumberRange::ANY; 9]))
            .not_beside(&["target"])
            .option("where it is, the point it looks at, and what is up"),
        up: Option<Vec3> = vector("up").option("which way is up in the picture"),
    }
}

/// The field that says what fills the picture.
const fn fit_field<'t>() -> Optional<FitKey<'t>> {
    Typed::new("fit", FieldKind::Text).option("what fills the picture: scene, or the name of an object; then perhaps a margin, 0 to 0.45 of the picture")
}

/// Its description; it stands apart since one camera means something else by the same key.
pub(super) const FIT: &[FieldSpec] = &[fit_field().spec()];

impl<'t> Plain<'t> for Subject<'t> {
    fn parse(_: &FieldSpec, args: &mut Args<'t>, _: &mut Sources<'_>) -> Result<Subject<'t>, Diagnostic> {
        subject(args)
    }
}

impl<'t> Plain<'t> for LookAt<'t> {
    fn parse(_: &FieldSpec, args: &mut Args<'t>, _: &mut Sources<'_>) -> Result<LookAt<'t>, Diagnostic> {
        look_at(args)
    }
}

impl<'t> Plain<'t> for FitKey<'t> {
    fn parse(_: &FieldSpec, args: &mut Args<'t>, _: &mut Sources<'_>) -> Result<FitKey<'t>, Diagnostic> {
        let item = args.item();
        if !args.is_word() {
            let error = args.error("`fit` says what the picture is to hold");
            return Err(error.help("write `fit scene`, or `fit` and the name of an object"));
        }
        let subject = subject(args)?;
        let margin = if args.numbers_left() > 0 { args.number_in(0.0..=0.45)? } else { MARGIN };
        Ok(FitKey { item, subject, margin: margin.into() })
    }
}
