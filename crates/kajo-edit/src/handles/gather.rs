//! The handles that nodes have of their own.

use kajo_math::{DAffine3, DVec3};

use super::{Eye, Handle, HandleKind, Meaning, Track};
use crate::reshape::ROWS;
use crate::{Document, FieldKind, FieldSpec, Kind, NodeId};
use kajo_core::schema::{Absent, Block};

/// Length of a direction's handle, in pixels.
const REACH: f64 = 90.0;

/// The handles that a node has of its own, for its numbers one by one. None for a node that is gone.
pub fn handles_of(document: &Document, node: NodeId, eye: &Eye<'_>) -> Vec<Handle> {
    let Some(found) = document.node(node) else { return Vec::new() };
    let world_from_local = document.placement(node);
    if world_from_local.matrix3.determinant() == 0.0 || !world_from_local.is_finite() {
        return Vec::new();
    }
    let mut gather = Gather { document, node, eye, world_from_local, handles: Vec::new() };
    match (found.kind, &*found.keyword) {
        (Kind::Shape, "Box") => gather.corners(),
        (Kind::Shape, "Plane") => gather.plane(),
        (Kind::Shape, "Cylinder" | "Cone") => gather.cone(),
        (Kind::Shape, "Torus") => gather.torus(),
        (Kind::Shape, "BilinearPatch") => {
            gather.points(&["vertex0", "vertex1", "vertex2", "vertex3"], "corner")
        }
        (Kind::Shape, "BicubicPatch") => gather.control_points(),
        (Kind::Shape, "HeightField") => gather.points(&["center"], "middle"),
        (Kind::Shape, "Prism" | "Text") => gather.prism(),
        (Kind::Shape, "Lathe") => gather.lathe(),
        (Kind::Shape, "Curves") => gather.strands(),
        (Kind::Part, "strand") => gather.strand(),
        (Kind::Part, "sphere" | "cylinder" | "plane") => gather.by_fields(found.block),
        (Kind::Shape, "Quad") => gather.quad(),
        (Kind::Shape, "Triangle") => gather.points(&["vertex0", "vertex1", "vertex2"], "corner"),
        (Kind::Shape, _) => gather.by_fields(found.block),
        (Kind::Light, _) => gather.light(),
        (Kind::Camera, _) => gather.camera(),
        _ => None,
    };
    gather.handles.retain(|handle| handle.at.is_finite());
    gather.handles
}

struct Gather<'a> {
    document: &'a Document,
    node: NodeId,
    eye: &'a Eye<'a>,
    world_from_local: DAffine3,
    handles: Vec<Handle>,
}

impl Gather<'_> {
    fn vec3(&self, key: &str) -> Option<DVec3> {
        self.document.value(self.node, key)?.vec3().map(DVec3::from_array)
    }

    fn number(&self, key: &str) -> Option<f64> {
        self.document.value(self.node, key)?.numbers.first().copied()
    }

    fn world(&self, p: DVec3) -> DVec3 {
        self.world_from_local.transform_point3(p)
    }

    fn add(&mut self, kind: HandleKind, at: DVec3, track: Track, meaning: Meaning, about: &'static str) {
        let (node, world_from_local) = (self.node, self.world_from_local);
        self.handles.push(Handle { node, kind, at, about, track, meaning, world_from_local });
    }

    /// A point of the text.
    fn point(&mut self, key: &'static str, about: &'static str) -> Option<DVec3> {
        let p = self.vec3(key)?;
        self.add(HandleKind::Point, self.world(p), Track::Screen, Meaning::Point { key }, about);
        Some(p)
    }

    fn points(&mut self, keys: &[&'static str], about: &'static str) -> Option<()> {
        keys.iter().for_each(|&key| {
            self.point(key, about);
        });
        Some(())
    }

    /// A radius around a point, or around a line through it, towards the side of the picture.
    fn radius(&mut self, key: &'static str, from: DVec3, line: Option<DVec3>) -> Option<()> {
        let radius = self.number(key)?.abs();
        let side = self.sideways(from, line)?;
        let at = self.world(from + radius * side);
        // A radius of zero can be drawn out again, if only its handle has a way to go.
        let track = Track::Line(self.world_from_local.transform_vector3(side).try_normalize()?);
        let track = if line.is_none() { Track::Screen } else { track };
        self.add(HandleKind::Size, at, track, Meaning::Distance { key, from, line }, "radius");
        Some(())
    }

    /// A unit direction in local space that points to the right in the picture, and across `line`.
    fn sideways(&self, from: DVec3, line: Option<DVec3>) -> Option<DVec3> {
        let into_local = self.world_from_local.inverse();
        let right = into_local.transform_vector3(self.eye.axes_at(self.world(from)).right);
        let Some(line) = line else { return right.try_normalize() };
        let sight = into_local.transform_vector3(self.eye.towards(self.world(from)));
        let silhouette = line.cross(sight);
        if silhouette.length() > 1e-3 * sight.length() {
            return silhouette.try_normalize();
        }
        (right - right.dot(line) * line).try_normalize()
    }

    /// Those of a shape that is told by points, directions and lengths: lengths are those from the first point, across the
    /// first direction if there is one.
    fn by_fields(&mut self, block: Option<&Block>) -> Option<()> {
        let fields: Vec<&'static FieldSpec> = block?.fields().collect();
        let of = |kind: FieldKind| fields.iter().filter(move |field| field.kind == kind);
        let mut first = None;
        for field in of(FieldKind::Point) {
            let p = self.point(field.key, field.about);
            first = first.or(p);
        }
        let from = first?;
        let mut line = None;
        for field in of(FieldKind::Vector) {
            let vector = self.vec3(field.key)?;
            line = line.or(vector.try_normalize());
            self.direction(field.key, from, vector.length(), false, field.about)?;
        }
        for field in &fields {
            let is_length = matches!(field.kind, FieldKind::Number { .. }) && field.unit == "length";
            // One of zero that could be absent is not there.
            let is_there = matches!(field.absent, Absent::Required) || self.number(field.key) != Some(0.0);
            if is_length && is_there {
                self.radius(field.key, from, line)?;
            }
        }
        Some(())
    }

    fn corners(&mut self) -> Option<()> {
        let (min, max) = (self.vec3("min")?, self.vec3("max")?);
        for i in 0..8 {
            let high = [i & 1 != 0, i & 2 != 0, i & 4 != 0];
            let pick = |axis: usize| if high[axis] { max[axis] } else { min[axis] };
            let corner = DVec3::new(pick(0), pick(1), pick(2));
            self.add(
                HandleKind::Point,
                self.world(corner),
                Track::Screen,
                Meaning::Corner { high },
                "corner",
            );
        }
        Some(())
    }

    /// Those of a bicubic patch.
    fn control_points(&mut self) -> Option<()> {
        for key in ROWS {
            let numbers = self.document.value(self.node, key)?.numbers;
            for (k, &p) in numbers.as_chunks::<3>().0.iter().enumerate() {
                let meaning = Meaning::Part { key, first: 3 * k };
                let at = self.world(DVec3::from_array(p));
                self.add(HandleKind::Point, at, Track::Screen, meaning, "control point");
            }
        }
        Some(())
    }

    /// The points of the strands that are written out, as many as a hand finds its way among.
    fn strands(&mut self) -> Option<()> {
        const MOST_POINTS: usize = 100;
        let curves = self.node;
        let strands =
            self.document.outline().children(Some(curves)).filter(|node| &*node.keyword == "strand");
        for strand in strands {
            self.node = strand.id;
            self.strand();
            if self.handles.len() >= MOST_POINTS {
                break;
            }
        }
        self.node = curves;
        Some(())
    }

    fn strand(&mut self) -> Option<()> {
        let numbers = self.document.value(self.node, "points")?.numbers;
        for (k, &p) in numbers.as_chunks::<3>().0.iter().enumerate() {
            let (at, meaning) =
                (self.world(DVec3::from_array(p)), Meaning::Part { key: "points", first: 3 * k });
            self.add(HandleKind::Point, at, Track::Screen, meaning, "control point");
        }
        Some(())
    }

    fn plane(&mut self) -> Option<()> {
        let normal = self.vec3("normal")?.try_normalize()?;
        let offset = self.number("offset")?;
        // A place of the plane in view: what lies below the middle of the scene.
        let middle = self.world_from_local.inverse().transform_point3(self.middle());
        let foot = middle + (offset - middle.dot(normal)) * normal;
        let (at, from) = (self.world(foot), foot - offset * normal);
        let way = self.world_from_local.transform_vector3(normal).try_normalize()?;
        let meaning = Meaning::Along { key: "offset", from, direction: normal };
        self.add(HandleKind::Size, at, Track::Line(way), meaning, "offset");
        let tip = at + way * REACH * self.eye.pixel_at(at);
        let meaning = Meaning::Facing { from: foot, length: self.vec3("normal")?.length() };
        self.add(HandleKind::Direction, tip, Track::Screen, meaning, "normal");
        Some(())
    }

    /// The middle of what has bounds, or the origin.
    fn middle(&self) -> DVec3 {
        let bounds = self.document.scene().map(|scene| scene.geometry.bounds());
        let bounds = bounds.filter(|bounds| bounds.is_finite() && !bounds.is_empty());
        bounds.map_or(DVec3::ZERO, |bounds| 0.5 * (bounds.min.as_dvec3() + bounds.max.as_dvec3()))
    }

    /// The handle of a direction from a local point, at a constant distance in the picture.
    fn direction(
        &mut self,
        key: &'static str,
        from: DVec3,
        length: f64,
        towards: bool,
        about: &'static str,
    ) -> Option<()> {
        let direction = self.vec3(key)?.try_normalize()?;
        let way = self.world_from_local.transform_vector3(if towards { -direction } else { direction });
        let origin = self.world(from);
        let at = origin + way.try_normalize()? * REACH * self.eye.pixel_at(origin);
        self.add(
            HandleKind::Direction,
            at,
            Track::Screen,
            Meaning::Direction { key, from, length, towards },
            about,
        );
        Some(())
    }

    fn cone(&mut self) -> Option<()> {
        let (base, top) = (self.point("base", "middle of an end")?, self.point("top", "middle of an end")?);
        let axis = (top - base).try_normalize()?;
        self.radius("radius", base, Some(axis))?;
        if self.number("topRadius").is_some() { self.radius("topRadius", top, Some(axis)) } else { Some(()) }
    }

    fn torus(&mut self) -> Option<()> {
        let center = self.point("center", "centre")?;
        let direction = self.vec3("axis")?;
        let axis = direction.try_normalize()?;
        self.radius("majorRadius", center, Some(axis))?;
        let middle = center + self.number("majorRadius")?.abs() * self.sideways(center, Some(axis))?;
        self.radius("minorRadius", middle, None)?;
        self.direction("axis", center, direction.length(), false, "axis")
    }

    fn prism(&mut self) -> Option<()> {
        let origin = self.point("origin", "origin of the outline")?;
        let vector = self.vec3("axis")?;
        let axis = vector.try_normalize()?;
        let way = self.world_from_local.transform_vector3(axis).try_normalize()?;
        let at = self.world(origin + self.number("depth")? * axis);
        let meaning = Meaning::Along { key: "depth", from: origin, direction: axis };
        self.add(HandleKind::Size, at, Track::Line(way), meaning, "depth");
        self.radius("size", origin, Some(axis))?;
        self.direction("axis", origin, vector.length(), false, "axis")
    }

    fn lathe(&mut self) -> Option<()> {
        let origin = self.point("origin", "origin of the profile")?;
        let vector = self.vec3("axis")?;
        self.radius("size", origin, Some(vector.try_normalize()?))?;
        self.direction("axis", origin, vector.length(), false, "axis")
    }

    fn quad(&mut self) -> Option<()> {
        let corner = self.point("corner", "corner")?;
        for key in ["edge1", "edge2"] {
            let at = self.world(corner + self.vec3(key)?);
            self.add(HandleKind::Point, at, Track::Screen, Meaning::Vector { key, from: corner }, "corner");
        }
        Some(())
    }

    fn light(&mut self) -> Option<()> {
        let position = self.point("position", "position");
        let Some(direction) = self.vec3("direction") else { return Some(()) };
        match position {
            Some(position) => {
                self.direction("direction", position, direction.length(), false, "where it points")
            }
            // What comes from afar is shown where it comes from.
            None => {
                self.direction("direction", self.middle(), direction.length(), true, "where it comes from")
            }
        }?;
        let position = position?;
        self.cone_of_light("angle", position, direction)?;
        self.cone_of_light("innerAngle", position, direction)
    }

    fn cone_of_light(&mut self, key: &'static str, from: DVec3, direction: DVec3) -> Option<()> {
        let Some(angle) = self.number(key) else { return Some(()) };
        let axis = direction.try_normalize()?;
        let side = self.sideways(from, Some(axis))?;
        let half = 0.5 * angle.to_radians();
        let arm = half.cos() * axis + half.sin() * side;
        let at = self.world(from + arm * REACH * self.eye.pixel_at(self.world(from)));
        let track = Track::Plane(axis.cross(side));
        self.add(HandleKind::Size, at, track, Meaning::Cone { key, from, axis }, "width of the cone");
        Some(())
    }

    /// The point that a lens focuses on, where it is one.
    fn focus_point(&mut self) -> Option<()> {
        self.point("focus", "what is sharp").map(|_| ())
    }

    fn camera(&mut self) -> Option<()> {
        let line = self.document.value(self.node, "lookAt").filter(|line| line.numbers.len() >= 6);
        if let Some(line) = line {
            for (first, about) in [(0, "eye"), (3, "target")] {
                let p = DVec3::from_slice(&line.numbers[first..first + 3]);
                let meaning = Meaning::Part { key: "lookAt", first };
                self.add(HandleKind::Point, self.world(p), Track::Screen, meaning, about);
            }
            return self.focus_point();
        }
        // One that fits something stands nowhere in particular, and may look at a point all the same.
        let center = self.point("center", "eye");
        let target = ["target", "lookAt"].into_iter().find_map(|key| self.point(key, "target"));
        self.focus_point();
        let center = center?;
        if target.is_some() {
            return Some(());
        }
        let direction = self.vec3("direction")?;
        let forward = direction.try_normalize()?;
        let focus = self.document.value(self.node, "focus").filter(|focus| focus.numbers.len() == 1);
        let focus = focus.and_then(|focus| focus.numbers.first().copied());
        let distance = focus.unwrap_or_else(|| (self.middle() - center).dot(forward).max(direction.length()));
        let target = center + distance * forward;
        let meaning =
            Meaning::Direction { key: "direction", from: center, length: direction.length(), towards: false };
        self.add(HandleKind::Direction, target, Track::Screen, meaning, "target");
        if focus.is_some() {
            let meaning = Meaning::Along { key: "focus", from: center, direction: forward };
            self.add(HandleKind::Size, target, Track::Line(forward), meaning, "what is sharp");
        }
        Some(())
    }
}
