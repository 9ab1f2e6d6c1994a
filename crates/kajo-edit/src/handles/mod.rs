//! Handles: points of a scene that can be dragged with the mouse, and what a drag means for the text.
//!
//! Every node has handles of its own: the centre and radius of a sphere, the corners of a triangle or a box, the ends
//! of a cylinder, the cone of a spot light, the target and focus of a camera. Anything that can be moved has a gizmo
//! besides: arrows, rings and boxes at its pivot.
//!
//! A handle is grabbed at a point of the picture and follows the cursor: its projection moves by as much as the
//! cursor does, as far as its track allows. With `x` its place and `pi` the projection,
//!
//! ```text
//! screen   x' on the plane through x parallel to the picture, pi(x') = pi(x) + to - from;
//!          for a picture that is not flat on the sphere through x around the eye
//! line     x' on a line, pi(x') as near to that point as the line comes
//! plane    x' on a given plane, pi(x') = pi(x) + to - from
//! circle   x' on a circle; what counts is the angle
//! ```
//!
//! Nothing here draws or knows a window: handles are made of a [`Document`](crate::Document) and a
//! [`CameraPose`](kajo::CameraPose), and a drag becomes an [`Edit`](crate::Edit) for a gesture of the document. All
//! drags of a gesture start from the handle as it was grabbed.
//!
//! ```no_run
//! # fn run(document: &mut kajo_edit::Document, node: kajo_edit::NodeId) -> Option<()> {
//! use kajo_edit::handles::{Eye, Snap, handles_of, pick};
//! use kajo::kajo_math::DVec2;
//!
//! let pose = kajo::CameraPose::of(document.scene()?);
//! let eye = Eye { pose: &pose, size: [960, 540] };
//! let handles = handles_of(document, node, &eye);
//! let (from, to) = (DVec2::new(300.0, 200.0), DVec2::new(320.0, 190.0));
//! let grabbed = pick(&handles, &eye, from, 8.0)?;
//! document.begin_gesture("drag");
//! let dragged = grabbed.drag(&eye, from, to, &Snap::default())?;
//! document.apply(&dragged.edit).ok()?;
//! document.end_gesture();
//! # Some(())
//! # }
//! ```

mod drag;
mod eye;
mod gather;
mod gizmo;

use kajo_math::{DAffine3, DVec3};

use crate::NodeId;

pub use drag::{Dragged, Snap};
pub use eye::Eye;
pub use gather::handles_of;
pub use gizmo::{Axes, HandleLine, Mode, gizmo_of, lines_of, pick, pivot_of};

/// A point that can be dragged.
#[derive(Clone, Debug)]
pub struct Handle {
    /// What it changes.
    pub node: NodeId,
    /// What it is, for its looks.
    pub kind: HandleKind,
    /// World space.
    pub at: DVec3,
    /// What it is for, in a few words.
    pub about: &'static str,
    track: Track,
    meaning: Meaning,
    /// From the space of the node's numbers.
    world_from_local: DAffine3,
}

/// What a handle is, for its looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HandleKind {
    /// A corner, centre or end.
    Point,
    /// A radius, distance or angle.
    Size,
    /// A direction.
    Direction,
    /// An arrow of the gizmo, along the axis with this number; a ring around it; a box on it.
    Arrow(usize),
    /// A square of the gizmo, across the axis with this number.
    Square(usize),
    /// A ring of the gizmo, around the axis with this number.
    Ring(usize),
    /// A box of the gizmo, on the axis with this number.
    Scale(usize),
    /// The middle of the gizmo.
    Middle,
}

/// Where a handle can go, in world space.
#[derive(Clone, Copy, Debug)]
enum Track {
    /// Parallel to the picture.
    Screen,
    /// Along a direction.
    Line(DVec3),
    /// Across a normal.
    Plane(DVec3),
    /// Around an axis.
    Circle { center: DVec3, axis: DVec3 },
}

/// What the place of a handle says; points and vectors in the space of the node's numbers unless told otherwise.
#[derive(Clone, Debug)]
enum Meaning {
    /// A point.
    Point { key: &'static str },
    /// A point among the numbers of a value, from this one on.
    Part { key: &'static str, first: usize },
    /// A vector from a point.
    Vector { key: &'static str, from: DVec3 },
    /// A direction from a point, or towards it, that keeps its length.
    Direction { key: &'static str, from: DVec3, length: f64, towards: bool },
    /// The normal of a plane through a point.
    Facing { from: DVec3, length: f64 },
    /// A distance from a point, or from a line through it.
    Distance { key: &'static str, from: DVec3, line: Option<DVec3> },
    /// A coordinate along a unit direction, from a point.
    Along { key: &'static str, from: DVec3, direction: DVec3 },
    /// A corner of a box: which coordinates are the larger ones.
    Corner { high: [bool; 3] },
    /// The full angle in degrees of a cone around a unit axis.
    Cone { key: &'static str, from: DVec3, axis: DVec3 },
    /// The place of all.
    Move,
    /// The direction of all.
    Turn,
    /// The size of all, along axes that are the columns; all of them when there is no number.
    Scale { center: DVec3, axes: kajo_math::DMat3, axis: Option<usize> },
}

#[cfg(test)]
mod tests;
