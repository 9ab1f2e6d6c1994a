//! Shapes, lights and cameras moved by their own numbers, where these can say it.

use kajo_math::{DAffine3, DVec3};

use super::movement::{Linear, Movement};
use super::tree::Tree;
use super::{FieldValue, Node};
use kajo_core::schema::{FieldKind, Kind};

/// The rows of a bicubic patch.
pub(super) const ROWS: [&str; 4] = ["row0", "row1", "row2", "row3"];

/// New values of a block.
pub(super) type Values = Vec<(&'static str, FieldValue)>;

impl Tree {
    /// The values that a block has after a movement in its own space; `None` where its numbers cannot say that.
    pub(super) fn reshaped(&self, node: &Node, movement: &Movement) -> Option<Values> {
        let block = Block { tree: self, node, map: movement.map(), linear: movement.linear() };
        match node.kind {
            Kind::Light | Kind::Camera => Some(block.pointing()),
            _ => block.shape(),
        }
    }

    /// The numbers of a value, or of its default.
    pub(super) fn numbers_of(&self, node: &Node, key: &str) -> Option<Vec<f64>> {
        self.value(node, key, None).map(|value| value.numbers)
    }

    /// Three numbers of a value, or of its default.
    pub(super) fn vec3_of(&self, node: &Node, key: &str) -> Option<DVec3> {
        self.numbers_of(node, key)?.first_chunk().copied().map(DVec3::from_array)
    }

    /// One number of a value, or of its default.
    pub(super) fn number_of(&self, node: &Node, key: &str) -> Option<f64> {
        self.numbers_of(node, key)?.first().copied()
    }
}

/// A block that is moved.
struct Block<'a> {
    tree: &'a Tree,
    node: &'a Node,
    map: DAffine3,
    linear: Linear,
}

impl Block<'_> {
    fn shape(&self) -> Option<Values> {
        let direct = self.linear != Linear::Mirrored;
        match &*self.node.keyword {
            "Box" => {
                let keeps = matches!(self.linear, Linear::Identity | Linear::Aligned) || self.only_scales();
                if keeps { Some(vec![self.point("min")?, self.point("max")?]) } else { None }
            }
            "Quad" if direct => Some(vec![self.point("corner")?, self.edge("edge1")?, self.edge("edge2")?]),
            "Triangle" if direct => {
                Some(vec![self.point("vertex0")?, self.point("vertex1")?, self.point("vertex2")?])
            }
            "BilinearPatch" if direct => {
                ["vertex0", "vertex1", "vertex2", "vertex3"].map(|key| self.point(key)).into_iter().collect()
            }
            "BicubicPatch" if direct => ROWS.into_iter().map(|key| self.row(key)).collect(),
            "Plane" if direct => self.plane(),
            "HeightField" => self.height_field(),
            // It stays upright and along the axes.
            "Superellipsoid" if self.linear != Linear::Identity && !self.only_scales() => None,
            "Quad" | "Triangle" | "BilinearPatch" | "BicubicPatch" | "Plane" => None,
            _ => self.by_fields(),
        }
    }

    /// Points are moved, directions turned and lengths scaled, where a block is told by these and says where it is.
    fn by_fields(&self) -> Option<Values> {
        let factor = self.similarity()?;
        let (mut values, mut has_place) = (Vec::new(), false);
        for field in self.node.block?.fields() {
            match field.kind {
                FieldKind::Point => {
                    has_place = true;
                    values.push(self.point(field.key)?);
                }
                FieldKind::Vector => values.push(self.turned(field.key)?),
                FieldKind::Number { .. } if field.unit == "length" => {
                    values.push(self.length(field.key, factor)?);
                }
                FieldKind::Number { .. }
                | FieldKind::Whole { .. }
                | FieldKind::Angle { .. }
                | FieldKind::Flag
                | FieldKind::Choice(_) => {}
                _ => return None,
            }
        }
        has_place.then_some(values)
    }

    /// A height field stays upright and along the axes.
    fn height_field(&self) -> Option<Values> {
        let mut values = vec![self.point("center")?];
        match self.linear {
            Linear::Identity => Some(values),
            // A function of the place stays as it is.
            _ if self.tree.value(self.node, "function", None).is_some() => None,
            Linear::Similar(factor) if self.only_scales() => {
                for key in ["size", "heights", "base"] {
                    let Some(numbers) = self.tree.numbers_of(self.node, key) else { continue };
                    let scaled = numbers.into_iter().map(|x| tidy(x * factor, 0.0));
                    values.push((key, FieldValue::numbers(scaled)));
                }
                Some(values)
            }
            _ => None,
        }
    }

    /// A light or a camera: a place and directions, of whatever length.
    fn pointing(&self) -> Values {
        let keys = ["position", "center", "target", "focus", "lookAt"];
        let places = keys.into_iter().filter_map(|key| self.points(key));
        places.chain(["direction", "up"].into_iter().filter_map(|key| self.turned(key))).collect()
    }

    /// A plane `n p = d`, with `n` of any length and `d` counted in its direction.
    fn plane(&self) -> Option<Values> {
        let (raw, offset) =
            (self.tree.vec3_of(self.node, "normal")?, self.tree.number_of(self.node, "offset")?);
        let n = raw.try_normalize()?;
        let turned = (self.map.matrix3.inverse().transpose() * n).try_normalize()?;
        let offset = turned.dot(self.map.transform_point3(offset * n));
        let normal = if self.linear == Linear::Identity { raw } else { turned * raw.length() };
        Some(vec![("normal", vector(normal)), ("offset", FieldValue::numbers([tidy(offset, 0.0)]))])
    }

    fn similarity(&self) -> Option<f64> {
        match self.linear {
            Linear::Identity => Some(1.0),
            Linear::Similar(factor) => Some(factor),
            _ => None,
        }
    }

    /// Whether all that happens besides moving is scaling equally.
    fn only_scales(&self) -> bool {
        let Linear::Similar(factor) = self.linear else { return false };
        self.map.matrix3.abs_diff_eq(kajo_math::DMat3::from_diagonal(DVec3::splat(factor)), 1e-9 * factor)
    }

    fn point(&self, key: &'static str) -> Option<(&'static str, FieldValue)> {
        let p = self.tree.vec3_of(self.node, key)?;
        Some((key, vector(self.map.transform_point3(p))))
    }

    /// The points of a row of a patch.
    fn row(&self, key: &'static str) -> Option<(&'static str, FieldValue)> {
        let numbers = self.tree.numbers_of(self.node, key)?;
        let (points, rest) = numbers.as_chunks::<3>();
        let moved = points.iter().map(|&p| self.map.transform_point3(DVec3::from_array(p)));
        rest.is_empty().then(|| (key, FieldValue::numbers(moved.flat_map(|p| vector(p).numbers))))
    }

    /// As many points as a value has, and then what is up, as a `lookAt` may say it.
    fn points(&self, key: &'static str) -> Option<(&'static str, FieldValue)> {
        let numbers = self.tree.numbers_of(self.node, key)?;
        let (points, rest) = numbers.as_chunks::<3>();
        if points.is_empty() || !rest.is_empty() {
            return None;
        }
        let moved = points.iter().enumerate().map(|(i, &p)| match i {
            0 | 1 => self.map.transform_point3(DVec3::from_array(p)),
            _ => (self.map.matrix3 * DVec3::from_array(p)).normalize_or_zero(),
        });
        Some((key, FieldValue::numbers(moved.flat_map(|p| vector(p).numbers))))
    }

    fn edge(&self, key: &'static str) -> Option<(&'static str, FieldValue)> {
        let edge = self.tree.vec3_of(self.node, key)?;
        Some((key, vector(self.map.matrix3 * edge)))
    }

    /// A direction, which keeps its length.
    fn turned(&self, key: &'static str) -> Option<(&'static str, FieldValue)> {
        let direction = self.tree.vec3_of(self.node, key)?;
        let turned = (self.map.matrix3 * direction).normalize_or_zero() * direction.length();
        let kept = turned.distance(direction) <= 1e-9 * direction.length();
        Some((key, if kept { FieldValue::numbers(direction.to_array()) } else { vector(turned) }))
    }

    fn length(&self, key: &'static str, factor: f64) -> Option<(&'static str, FieldValue)> {
        let length = self.tree.number_of(self.node, key)?;
        Some((key, FieldValue::numbers([tidy(length * factor, 0.0)])))
    }
}

/// Three numbers as they are written.
pub(super) fn vector(v: DVec3) -> FieldValue {
    let scale = v.abs().max_element();
    FieldValue::numbers(v.to_array().map(|x| tidy(x, scale)))
}

/// A number in the precision that scenes have; what is only rounding, against numbers of size `scale`, becomes zero.
pub(super) fn tidy(x: f64, scale: f64) -> f64 {
    if x.abs() <= 1e-12 * scale || x == 0.0 { 0.0 } else { f64::from(x as f32) }
}
