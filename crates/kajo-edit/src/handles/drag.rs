//! From a cursor's way to a handle's new place, and from there to an edit.

use kajo_math::{DMat3, DQuat, DVec2, DVec3};

use super::{Eye, Handle, Meaning, Track};
use crate::{Edit, FieldValue, Movement};

/// Steps that values jump in while a key is held; zero for none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Snap {
    /// Of places and lengths.
    pub length: f64,
    /// Of angles, in degrees.
    pub degrees: f64,
    /// Of factors.
    pub factor: f64,
}

/// What a drag comes to.
#[derive(Clone, Debug)]
pub struct Dragged {
    /// What to do, as of the text at the time when the handle was made.
    pub edit: Edit,
    /// Where the handle is now, world space.
    pub at: DVec3,
}

/// How often a curved line is followed along its tangent.
const TANGENTS: u32 = 8;

/// Values are rounded to a decimal digit that is no more than this share of a pixel.
const ROUNDING: f64 = 0.05;

impl Handle {
    /// The edit for a cursor that went from one place of the picture to another.
    ///
    /// `None` where the handle cannot be seen, or cannot follow: its plane is seen edge on, or a shape would vanish.
    pub fn drag(&self, eye: &Eye<'_>, from: DVec2, to: DVec2, snap: &Snap) -> Option<Dragged> {
        let there = eye.projection_near(self.at, from)? + (to - from);
        if let Track::Circle { center, axis } = self.track {
            return self.turned(eye, from, to, center, axis, snap);
        }
        let at = self.followed(eye, there)?;
        let step = ROUNDING * eye.pixel_at(self.at);
        let (edit, at) = self.meant(at, step, snap)?;
        Some(Dragged { edit, at })
    }

    /// The place on the handle's track that appears at `there`, or nearest to it.
    fn followed(&self, eye: &Eye<'_>, there: DVec2) -> Option<DVec3> {
        match self.track {
            Track::Screen if eye.pose.is_flat() => eye.sight(there)?.intersect(self.at, eye.pose.forward()),
            Track::Screen => {
                let sight = eye.sight(there)?;
                Some(sight.origin + sight.direction * self.at.distance(sight.origin))
            }
            Track::Plane(normal) => eye.sight(there)?.intersect(self.at, normal),
            Track::Line(direction) if eye.pose.is_flat() => along(eye, self.at, direction, there),
            // The line is curved: from each point its tangent leads to a better one.
            Track::Line(direction) => {
                (0..TANGENTS).try_fold(self.at, |at, _| along(eye, at, direction, there))
            }
            Track::Circle { .. } => None,
        }
    }

    fn meant(&self, at: DVec3, step: f64, snap: &Snap) -> Option<(Edit, DVec3)> {
        let local_from_world = self.world_from_local.inverse();
        let local = local_from_world.transform_point3(at);
        let scale = self.world_from_local.matrix3.determinant().abs().cbrt();
        let length = Rounding { step: step / scale, snap: snap.length };
        let world = |p: DVec3| self.world_from_local.transform_point3(p);
        let set = |key: &str, value: FieldValue| Edit::set(self.node, key, value);
        Some(match &self.meaning {
            Meaning::Point { key } => {
                let p = length.vector(local);
                (set(key, vector(p)), world(p))
            }
            Meaning::Part { key, first } => {
                let p = length.vector(local);
                let numbers = p.to_array().map(|x| Some(single(x)));
                let numbers = std::iter::repeat_n(None, *first).chain(numbers).collect();
                return Some((Edit::SetSome { node: self.node, key: (*key).to_owned(), numbers }, world(p)));
            }
            Meaning::Vector { key, from } => {
                let v = length.vector(local - *from);
                (v.length() > 0.0).then(|| (set(key, vector(v)), world(*from + v)))?
            }
            Meaning::Direction { key, from, length, towards } => {
                let way = if *towards { *from - local } else { local - *from };
                (set(key, vector(way.try_normalize()? * *length)), at)
            }
            Meaning::Facing { from, length: normal } => {
                let direction = (local - *from).try_normalize()?;
                let offset = length.number(direction.dot(*from));
                let both = [set("normal", vector(direction * *normal)), set("offset", number(offset))];
                (Edit::Together(both.into()), at)
            }
            Meaning::Distance { key, from, line } => {
                let off = local - *from;
                let across = line.map_or(off, |line| off - off.dot(line) * line);
                let distance = length.number(across.length());
                let rounded = off - across + across.normalize_or_zero() * distance;
                (distance > 0.0).then(|| (set(key, number(distance)), world(*from + rounded)))?
            }
            Meaning::Along { key, from, direction } => {
                let distance = length.number((local - *from).dot(*direction));
                (set(key, number(distance)), world(*from + distance * *direction))
            }
            Meaning::Corner { high } => {
                let p = length.vector(local);
                return Some((self.corner(p, *high), world(p)));
            }
            Meaning::Cone { key, from, axis } => {
                (set(key, number(cone_angle(local - *from, *axis, snap))), at)
            }
            Meaning::Move => {
                let by = Rounding { step, snap: snap.length }.vector(at - self.at);
                (self.movement(Movement::Translate(by)), self.at + by)
            }
            Meaning::Scale { center, axes, axis } => self.scaled(at, snap, *center, *axes, *axis)?,
            Meaning::Turn => return None,
        })
    }

    /// A scaling about `center` by how far the handle was pulled, along one axis or all.
    fn scaled(
        &self,
        at: DVec3,
        snap: &Snap,
        center: DVec3,
        axes: DMat3,
        axis: Option<usize>,
    ) -> Option<(Edit, DVec3)> {
        let arm = (self.at - center).normalize_or_zero();
        let factor = (at - center).dot(arm) / (self.at - center).length();
        let factor = Rounding { step: 1e-4, snap: snap.factor }.number(factor);
        let mut factors = DVec3::splat(factor);
        if let Some(axis) = axis {
            factors = DVec3::ONE;
            factors[axis] = factor;
        }
        let movement = Movement::Scale { center, axes, factors };
        let there = center + factor * (self.at - center);
        (factor != 0.0).then(|| (self.movement(movement), there))
    }

    /// A corner of a box goes to `p`: each coordinate belongs to one of the two corners in the text.
    fn corner(&self, p: DVec3, high: [bool; 3]) -> Edit {
        let side = |key: &str, is_high: bool| Edit::SetSome {
            node: self.node,
            key: key.to_owned(),
            numbers: (0..3).map(|i| (high[i] == is_high).then(|| single(p[i]))).collect(),
        };
        Edit::Together(vec![side("min", false), side("max", true)])
    }

    /// A ring turns by the angle that the cursor went around its centre.
    fn turned(
        &self,
        eye: &Eye<'_>,
        from: DVec2,
        to: DVec2,
        center: DVec3,
        axis: DVec3,
        snap: &Snap,
    ) -> Option<Dragged> {
        let spoke = |place: DVec2| {
            let hit = eye.sight(place)?.intersect(center, axis)?;
            (hit - center).try_normalize()
        };
        let angle = match spoke(from).zip(spoke(to)) {
            Some((a, b)) => axis.dot(a.cross(b)).atan2(a.dot(b)).to_degrees(),
            // Seen edge on, the ring is a line: what goes along it turns it.
            None => {
                let across = eye.axes_at(center).ahead.cross(axis).try_normalize()?;
                let pixel = eye.pixel_at(center);
                let radius = self.at.distance(center);
                let a = eye.project(center)?;
                let way = (eye.project(center + across * pixel)? - a).normalize_or_zero();
                -((to - from).dot(way) * pixel / radius).to_degrees()
            }
        };
        let degrees = Rounding { step: 0.01, snap: snap.degrees }.number(angle);
        let movement = Movement::Rotate { center, axis, degrees };
        let turn = DQuat::from_axis_angle(axis, degrees.to_radians());
        Some(Dragged { edit: self.movement(movement), at: center + turn * (self.at - center) })
    }

    fn movement(&self, movement: Movement) -> Edit {
        Edit::Move { node: self.node, movement }
    }
}

/// The point of a line whose projection is nearest to `there`.
///
/// The projection of a line is a line, or follows one nearby, on which places follow `(a t + b) / (c t + 1)`; the nearest point of that line is
/// found in the picture, and what is seen there is the point of the line in space that lies nearest to the sight.
fn along(eye: &Eye<'_>, at: DVec3, direction: DVec3, there: DVec2) -> Option<DVec3> {
    let here = eye.projection_near(at, there)?;
    let step = direction * eye.pixel_at(at);
    let ahead = eye.projection_near(at + step, here);
    let way = ahead.or_else(|| eye.projection_near(at - step, here).map(|back| 2.0 * here - back))? - here;
    // Seen end on, no pixel moves it.
    if way.length() < 1e-3 {
        return None;
    }
    let way = way.normalize();
    let foot = here + way * (there - here).dot(way);
    let sight = eye.sight(foot)?;
    let across = direction.cross(sight.direction);
    // The plane through the line that is as square to the sight as can be.
    sight.intersect(at, across.cross(direction)).map(|hit| at + direction * (hit - at).dot(direction))
}

/// The full angle of a cone about `axis` whose side goes through `off`, in degrees.
fn cone_angle(off: DVec3, axis: DVec3, snap: &Snap) -> f64 {
    let angle = 2.0 * off.cross(axis).length().atan2(off.dot(axis)).to_degrees();
    Rounding { step: 0.01, snap: snap.degrees }.number(angle).clamp(0.0, 360.0)
}

/// How values are rounded.
#[derive(Clone, Copy)]
struct Rounding {
    /// What makes no difference.
    step: f64,
    /// Steps asked for; zero for none.
    snap: f64,
}

impl Rounding {
    fn number(self, x: f64) -> f64 {
        if self.snap > 0.0 {
            return (x / self.snap).round() * self.snap;
        }
        // To the decimal digit below the step.
        let digits = -self.step.log10().floor();
        if !(-12.0..=12.0).contains(&digits) {
            return x;
        }
        let unit = 10f64.powi(digits as i32);
        (x * unit).round() / unit
    }

    fn vector(self, v: DVec3) -> DVec3 {
        v.to_array().map(|x| self.number(x)).into()
    }
}

/// A number in the precision of scenes.
fn single(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { f64::from(x as f32) }
}

fn number(x: f64) -> FieldValue {
    FieldValue::numbers([single(x)])
}

fn vector(v: DVec3) -> FieldValue {
    FieldValue::numbers(v.to_array().map(single))
}
