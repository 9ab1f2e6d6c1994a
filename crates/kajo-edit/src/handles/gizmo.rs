//! Arrows, rings and boxes at the pivot of anything that can be moved; picking and drawing of handles.

use kajo_math::{DMat3, DQuat, DVec2, DVec3};

use super::{Eye, Handle, HandleKind, Meaning, Track};
use crate::{Document, FieldKind, Kind, NodeId};

/// Length of an arrow, in pixels.
const ARM: f64 = 80.0;

/// Pieces that a ring is drawn of.
const PIECES: usize = 64;

/// What a gizmo does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Moves.
    #[default]
    Move,
    /// Turns.
    Turn,
    /// Scales.
    Scale,
}

/// The directions of a gizmo.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Axes {
    /// Those of the world.
    #[default]
    World,
    /// Those of the node, as the transforms around it and its own have turned them.
    Own,
}

/// A piece of a line to draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandleLine {
    /// World space.
    pub from: DVec3,
    /// World space.
    pub to: DVec3,
    /// Index into the handles.
    pub handle: usize,
}

/// The point that a node turns and scales about; `None` for what cannot be moved.
pub fn pivot_of(document: &Document, node: NodeId) -> Option<DVec3> {
    let found = document.node(node)?;
    let world_from_local = document.placement(node);
    let value = |key: &str| document.value(node, key).and_then(|value| value.vec3()).map(DVec3::from_array);
    let middle = |keys: &[&str]| {
        let points: Vec<DVec3> = keys.iter().filter_map(|key| value(key)).collect();
        (!keys.is_empty() && points.len() == keys.len())
            .then(|| points.iter().sum::<DVec3>() / keys.len() as f64)
    };
    let local = match (found.kind, &*found.keyword) {
        (Kind::Shape, "Quad") => Some(value("corner")? + 0.5 * (value("edge1")? + value("edge2")?)),
        (Kind::Shape, "Plane") => {
            let offset = document.value(node, "offset")?.numbers.first().copied()?;
            Some(value("normal")?.try_normalize()? * offset)
        }
        (Kind::Shape, _) => {
            let fields = found.block.into_iter().flat_map(|block| block.fields());
            let points: Vec<&str> =
                fields.filter(|field| field.kind == FieldKind::Point).map(|field| field.key).collect();
            Some(value("center").or_else(|| middle(&points)).unwrap_or(DVec3::ZERO))
        }
        (Kind::Light | Kind::Camera, _) => value("position").or(value("center")),
        (Kind::Transform | Kind::Instance, _) => Some(document.own_map(node).translation),
        (Kind::Group, _) => {
            let children = document.outline().children(Some(node));
            let pivots: Vec<DVec3> = children.filter_map(|child| pivot_of(document, child.id)).collect();
            let sum: DVec3 = pivots.iter().sum();
            return (!pivots.is_empty() && found.parent.is_some()).then(|| sum / pivots.len() as f64);
        }
        _ => None,
    };
    local.map(|p| world_from_local.transform_point3(p)).filter(|p| p.is_finite())
}

/// The gizmo of a node, of constant size in the picture; empty for what cannot be moved.
pub fn gizmo_of(document: &Document, node: NodeId, eye: &Eye<'_>, mode: Mode, axes: Axes) -> Vec<Handle> {
    let Some(pivot) = pivot_of(document, node) else { return Vec::new() };
    let axes = match axes {
        Axes::World => DMat3::IDENTITY,
        Axes::Own => own_axes(document, node),
    };
    let arm = ARM * eye.pixel_at(pivot);
    let world_from_local = document.placement(node);
    let handle =
        |kind, at, track, meaning, about| Handle { node, kind, at, about, track, meaning, world_from_local };
    let columns = [axes.x_axis, axes.y_axis, axes.z_axis];
    let each = columns.into_iter().enumerate();
    match mode {
        Mode::Move => {
            let middle = handle(HandleKind::Middle, pivot, Track::Screen, Meaning::Move, "move");
            let arrows = each.clone().map(|(i, axis)| {
                let at = pivot + arm * axis;
                handle(HandleKind::Arrow(i), at, Track::Line(axis), Meaning::Move, "move along")
            });
            let squares = each.map(|(i, axis)| {
                let at = pivot + 0.3 * arm * (columns[(i + 1) % 3] + columns[(i + 2) % 3]);
                handle(HandleKind::Square(i), at, Track::Plane(axis), Meaning::Move, "move across")
            });
            arrows.chain(squares).chain([middle]).collect()
        }
        Mode::Turn => each
            .map(|(i, axis)| {
                let at = pivot + arm * columns[(i + 1) % 3];
                let track = Track::Circle { center: pivot, axis };
                handle(HandleKind::Ring(i), at, track, Meaning::Turn, "turn around")
            })
            .collect(),
        Mode::Scale => {
            let meaning = |axis| Meaning::Scale { center: pivot, axes, axis };
            let picture = eye.axes_at(pivot);
            let all = pivot + 0.4 * arm * (picture.right + picture.up).normalize_or(DVec3::X);
            let way = (all - pivot).normalize_or(DVec3::X);
            let middle = handle(HandleKind::Middle, all, Track::Line(way), meaning(None), "scale");
            let boxes = each.map(|(i, axis)| {
                let at = pivot + arm * axis;
                handle(HandleKind::Scale(i), at, Track::Line(axis), meaning(Some(i)), "scale along")
            });
            boxes.chain([middle]).collect()
        }
    }
}

/// The directions of a node's own axes in the world, made perpendicular.
fn own_axes(document: &Document, node: NodeId) -> DMat3 {
    let m = document.placement(node).matrix3 * document.own_map(node).matrix3;
    let x = m.x_axis.normalize_or(DVec3::X);
    let y = (m.y_axis - m.y_axis.dot(x) * x).try_normalize().unwrap_or_else(|| x.any_orthonormal_vector());
    DMat3::from_cols(x, y, x.cross(y))
}

/// The handle under the cursor: the nearest one within `reach` pixels, and of those the one in front.
pub fn pick<'a>(handles: &'a [Handle], eye: &Eye<'_>, cursor: DVec2, reach: f64) -> Option<&'a Handle> {
    let distance = |handle: &Handle| -> Option<(f64, f64)> {
        let depth = (handle.at - eye.pose.eye()).dot(eye.axes_at(handle.at).ahead);
        let pixels = match handle.track {
            Track::Circle { center, axis } => {
                let points: Vec<DVec3> = ring(handle.at, center, axis).collect();
                let strokes = points.windows(2).flat_map(|pair| eye.pose.strokes(pair[0], pair[1], eye.size));
                strokes
                    .map(|stroke| to_segment(cursor, stroke.ends[0], stroke.ends[1]))
                    .fold(f64::INFINITY, f64::min)
            }
            _ => eye.projection_near(handle.at, cursor)?.distance(cursor),
        };
        (pixels <= reach).then_some((pixels, depth))
    };
    let hits = handles.iter().filter_map(|handle| Some((handle, distance(handle)?)));
    // A pixel more or less is no reason to take the one behind.
    let best = hits.min_by(|(_, a), (_, b)| {
        (a.0.round(), a.1).partial_cmp(&(b.0.round(), b.1)).unwrap_or(std::cmp::Ordering::Equal)
    });
    best.map(|(handle, _)| handle)
}

/// Lines that show what handles do: rings, arms from the pivot, and the way to the tip of a direction.
///
/// * `pivot`: of the gizmo; handles of shapes are points and have no lines
pub fn lines_of(handles: &[Handle], pivot: DVec3) -> Vec<HandleLine> {
    let mut lines = Vec::new();
    for (index, handle) in handles.iter().enumerate() {
        let origin = handle.world_from_local;
        match (&handle.track, &handle.meaning) {
            (Track::Circle { center, axis }, _) => {
                let points: Vec<DVec3> = ring(handle.at, *center, *axis).collect();
                lines.extend(points.windows(2).map(|p| HandleLine { from: p[0], to: p[1], handle: index }));
            }
            (
                _,
                Meaning::Direction { from, .. } | Meaning::Facing { from, .. } | Meaning::Cone { from, .. },
            ) => {
                lines.push(HandleLine { from: origin.transform_point3(*from), to: handle.at, handle: index });
            }
            (Track::Line(_), Meaning::Move | Meaning::Scale { .. }) => {
                lines.push(HandleLine { from: pivot, to: handle.at, handle: index });
            }
            _ => {}
        }
    }
    lines
}

/// Points around a circle, from `start` and back to it.
fn ring(start: DVec3, center: DVec3, axis: DVec3) -> impl Iterator<Item = DVec3> {
    let turned =
        move |i: usize| DQuat::from_axis_angle(axis, i as f64 / PIECES as f64 * std::f64::consts::TAU);
    (0..=PIECES).map(move |i| center + turned(i) * (start - center))
}

fn to_segment(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let along = b - a;
    let t = if along == DVec2::ZERO {
        0.0
    } else {
        ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0)
    };
    p.distance(a + t * along)
}
