//! Solids made of other solids by set operations (constructive solid geometry).
//!
//! The solids that the operations are made of, the leaves, are kept in one list, however deep the operations nest. A ray
//! finds all crossings of its whole line with every leaf that it comes near, sorts them, and goes along: at each crossing one
//! leaf begins or ends to hold the point, and where that changes what the operations say, there is the surface of the result
//! [Roth 1982]. Crossings that lie nearer to each other than they are known are taken together, as one change: so `A - A` is
//! empty, a face that two operands share is none or one and never speckles, and neither needs to be treated by itself.
//!
//! Operands may move: a ray meets each leaf where that is at the ray's time, so the solid has another shape at each.
//!
//! A face has the material of the leaf that it is of. Normals point out of the result, so those of what is taken away are
//! turned round.
//!
//! Scene: `Difference { Box { min 0 0 0  max 1 1 1 }  Sphere { center 1 1 1  radius 0.5 } }`

mod crossings;
mod sets;

use std::sync::Arc;

use kajo_bvh::{BuildSettings, Bvh};
use kajo_math::solid_angle::basis64;
use kajo_math::{Aabb, DAffine3, DVec3, Motion, Ray, Transform, Vec2, Vec3, Vec4};

use self::crossings::with_scratch;
use self::sets::{SetExpression, SetTree};
use super::{AnyShape, Patch, Plane, ShapeId, Shapes, Surface, Tessellation};
use crate::family::Pooled;
use crate::ids::MaterialSlot;
use crate::interaction::{Hit, SurfacePoint, Tangents};
use crate::motion::{MovingTransform, Shutter};
pub use sets::SetOperation;

/// From this many leaves on a tree finds those that a ray comes near.
const LEAVES_FOR_A_TREE: usize = 8;

/// A solid made of others. A clone is the same solid.
#[derive(Clone, Debug)]
pub struct Csg(Arc<Solid>);

/// One of the shapes that an operand is the union of.
#[derive(Clone, Debug)]
pub struct SolidPart {
    /// A closed shape, a plane for the half space behind it, or the result of other operations.
    pub shape: AnyShape,
    /// To the space of the result; invertible at all times.
    pub map: Motion,
    /// Its material among those that shapes bring, if it has one of its own; see
    /// [`crate::builder::SceneBuilder::mesh_material`].
    pub material: Option<MaterialSlot>,
    /// The number of the item of the text that it is of, or any; see [`Csg::subtracted`].
    pub source: u32,
}

/// Why there is no such solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CsgError {
    /// No operands.
    #[error("a set operation without operands makes nothing")]
    Empty,
    /// A part of an operand encloses nothing.
    #[error("part {part} of operand {operand} encloses nothing")]
    NotClosed {
        /// Which operand.
        operand: usize,
        /// Which of its parts.
        part: usize,
    },
    /// The map of a part has no inverse.
    #[error("the map of an operand has no inverse")]
    NoInverse,
    /// More leaves or more faces than 32 bits count.
    #[error("there are too many operands")]
    TooMany,
}

#[derive(Debug)]
struct Solid {
    shapes: Shapes,
    leaves: Vec<Leaf>,
    expression: SetExpression,
    sets: SetTree,
    bounds: Aabb,
    /// Of the leaves that have bounds, where there are many.
    tree: Option<Bvh>,
    /// The leaves that the tree holds, in its order.
    bounded: Vec<u32>,
    /// The others.
    unbounded: Vec<u32>,
    /// The largest coordinate of any bounded leaf.
    reach: f32,
}

#[derive(Clone, Debug)]
struct Leaf {
    shape: ShapeId,
    map: Motion,
    /// The map when the shutter opens.
    start: DAffine3,
    /// The map with its inverse, where it moves anything.
    transform: Option<LeafTransform>,
    /// In the space of the result, at any time while the shutter is open.
    bounds: Aabb,
    /// Number of its first part among those of all leaves.
    first_part: u32,
    material: Option<MaterialSlot>,
    /// Whether the materials count that its shape brings.
    brings_materials: bool,
    /// See [`SolidPart::source`].
    source: u32,
    /// Whether it is taken away.
    inverted: bool,
}

/// The map of a leaf.
#[derive(Clone, Debug)]
enum LeafTransform {
    Still(Transform),
    Moving(Box<MovingTransform>),
}

impl Csg {
    /// Operands that move are seen through the usual shutter.
    ///
    /// * `operands`: each the union of its parts
    ///
    /// # Errors
    /// See [`CsgError`].
    pub fn new(operation: SetOperation, operands: &[Vec<SolidPart>]) -> Result<Csg, CsgError> {
        let mut making = Making::new(Shutter::default());
        let mut expressions = Vec::with_capacity(operands.len());
        for (i, parts) in operands.iter().enumerate() {
            let mut union = Vec::with_capacity(parts.len());
            for (j, part) in parts.iter().enumerate() {
                if !part.shape.is_solid() {
                    return Err(CsgError::NotClosed { operand: i, part: j });
                }
                union.push(making.part(part)?);
            }
            expressions.push(match <[SetExpression; 1]>::try_from(union) {
                Ok([single]) => single,
                Err(union) => SetExpression::Node(SetOperation::Union, union),
            });
        }
        if making.leaves.is_empty() {
            return Err(CsgError::Empty);
        }
        Ok(making.finish(SetExpression::Node(operation, expressions)))
    }

    /// The same solid without the materials of its leaves.
    #[must_use]
    pub fn of_one_material(&self) -> Csg {
        let mut making = Making::new(Shutter::default());
        match making.solid(self, &Motion::still(DAffine3::IDENTITY), None) {
            Ok(expression) => making.finish(expression),
            Err(_) => self.clone(),
        }
    }

    /// The numbers of the materials of its leaves.
    pub fn material_slots(&self) -> impl Iterator<Item = MaterialSlot> {
        let solid = &self.0;
        solid.leaves.iter().flat_map(|leaf| {
            let of_mesh = <super::Mesh as Pooled<Shapes>>::find(&solid.shapes, leaf.shape)
                .filter(|_| leaf.brings_materials)
                .map_or(&[][..], super::Mesh::material_slots);
            leaf.material.into_iter().chain(of_mesh.iter().filter_map(|slot| slot.given()))
        })
    }

    /// Triangles of each leaf that is taken away, whole, in the space of the result when the shutter opens, with its
    /// [`SolidPart::source`].
    ///
    /// * `around`: segments of a full circle
    pub fn subtracted(&self, around: u32) -> impl Iterator<Item = (u32, Tessellation)> {
        let solid = &*self.0;
        let leaves = solid.leaves.iter().filter(|leaf| leaf.inverted);
        leaves.map(move |leaf| (leaf.source, solid.tessellated(leaf, around)))
    }

    /// The leaf that a part is of, and the number of the part there.
    fn leaf_of(&self, part: u32) -> (u32, &Leaf, u32) {
        let leaves = &self.0.leaves;
        let i = leaves.partition_point(|leaf| leaf.first_part <= part).saturating_sub(1);
        (i as u32, &leaves[i], part - leaves[i].first_part)
    }

    /// `f` of the leaf of a hit, with the hit and a point, as it is when the shutter opens, in the leaf's own space.
    fn at_leaf<T>(&self, hit: &Hit, p: Vec3, f: impl FnOnce(&Shapes, ShapeId, &Hit, Vec3) -> T) -> T {
        let (_, leaf, part) = self.leaf_of(hit.part);
        let p = leaf.in_place(0.0, p, |p, transform| transform.object_from_world.transform_point3(p));
        f(&self.0.shapes, leaf.shape, &Hit { part, ..*hit }, p)
    }
}

/// What is known of a leaf besides its shape and its transform.
struct LeafText {
    material: Option<MaterialSlot>,
    brings_materials: bool,
    source: u32,
}

/// Leaves gathered so far.
struct Making {
    shutter: Shutter,
    shapes: Shapes,
    leaves: Vec<Leaf>,
    parts: u32,
}

impl Making {
    fn new(shutter: Shutter) -> Making {
        Making { shutter, shapes: Shapes::default(), leaves: Vec::new(), parts: 0 }
    }

    fn part(&mut self, part: &SolidPart) -> Result<SetExpression, CsgError> {
        match &part.shape {
            AnyShape::Csg(inner) => self.solid(inner, &part.map, Some(part.material)),
            shape => {
                let brings_materials = true;
                let &SolidPart { material, source, .. } = part;
                self.leaf(shape.clone(), part.map.clone(), LeafText { material, brings_materials, source })
            }
        }
    }

    /// The leaves of a solid under a map.
    ///
    /// * `material`: of those that have none; without it none has any
    fn solid(
        &mut self,
        inner: &Csg,
        map: &Motion,
        material: Option<Option<MaterialSlot>>,
    ) -> Result<SetExpression, CsgError> {
        let first = self.leaves.len() as u32;
        for leaf in &inner.0.leaves {
            let shape = inner.0.shapes.any(leaf.shape);
            let of_leaf = material.and_then(|material| leaf.material.or(material));
            let brings_materials = leaf.brings_materials && material.is_some();
            let text = LeafText { material: of_leaf, brings_materials, source: leaf.source };
            self.leaf(shape, map.then(&leaf.map), text)?;
        }
        Ok(shifted(&inner.0.expression, first))
    }

    fn leaf(&mut self, shape: AnyShape, map: Motion, text: LeafText) -> Result<SetExpression, CsgError> {
        let LeafText { material, brings_materials, source } = text;
        let start = map.at(self.shutter.open);
        let still = Transform::new(&start).ok_or(CsgError::NoInverse)?;
        let number = u32::try_from(self.leaves.len()).map_err(|_| CsgError::TooMany)?;
        let shape = shape.store(&mut self.shapes).ok_or(CsgError::TooMany)?;
        let own = self.shapes.bounds(shape);
        let moving = map.constant().is_none().then(|| MovingTransform::new(map.clone(), self.shutter));
        let transform = match moving.filter(MovingTransform::moves) {
            Some(moving) => Some(LeafTransform::Moving(Box::new(moving))),
            None => (!still.is_identity()).then_some(LeafTransform::Still(still)),
        };
        let bounds = match &transform {
            _ if own.is_empty() => Aabb::EMPTY,
            _ if !own.is_finite() => Aabb::EVERYWHERE,
            Some(LeafTransform::Moving(moving)) => moving.bounds_of_all_times(&own),
            // Widened by what rounding may take, where it stands as it is too.
            Some(LeafTransform::Still(_)) | None => still.bounds(&own),
        };
        let first_part = self.parts;
        let parts = self.parts.checked_add(self.shapes.part_count(shape));
        self.parts = parts.ok_or(CsgError::TooMany)?;
        let inverted = false;
        self.leaves.push(Leaf {
            shape,
            map,
            start,
            transform,
            bounds,
            first_part,
            material,
            brings_materials,
            source,
            inverted,
        });
        Ok(SetExpression::Leaf(number))
    }

    fn finish(self, expression: SetExpression) -> Csg {
        let Making { shapes, mut leaves, .. } = self;
        let sets = SetTree::new(&expression, leaves.len());
        for (i, leaf) in leaves.iter_mut().enumerate() {
            leaf.inverted = sets.is_inverted(i as u32);
        }
        let (bounded, unbounded): (Vec<u32>, Vec<u32>) =
            (0..leaves.len() as u32).partition(|&i| leaves[i as usize].bounds.is_finite());
        let boxes: Vec<Aabb> = bounded.iter().map(|&i| leaves[i as usize].bounds).collect();
        let tree = (boxes.len() >= LEAVES_FOR_A_TREE).then(|| Bvh::build(&boxes, &BuildSettings::default()));
        let far = |bounds: &Aabb| bounds.min.abs().max(bounds.max.abs()).max_element();
        let reach = boxes.iter().map(far).fold(0.0, f32::max);
        let bounds = bounds_of(&expression, &|leaf| leaves[leaf as usize].bounds);
        Csg(Arc::new(Solid { shapes, leaves, expression, sets, bounds, tree, bounded, unbounded, reach }))
    }
}

/// The same expression with other numbers.
fn shifted(expression: &SetExpression, by: u32) -> SetExpression {
    match expression {
        SetExpression::Leaf(leaf) => SetExpression::Leaf(leaf + by),
        SetExpression::Node(operation, operands) => {
            SetExpression::Node(*operation, operands.iter().map(|operand| shifted(operand, by)).collect())
        }
    }
}

/// A box around what an expression holds.
///
/// * `of_leaf`: boxes around its leaves
fn bounds_of(expression: &SetExpression, of_leaf: &impl Fn(u32) -> Aabb) -> Aabb {
    match expression {
        SetExpression::Leaf(leaf) => of_leaf(*leaf),
        SetExpression::Node(operation, operands) => {
            let each = operands.iter().map(|operand| bounds_of(operand, of_leaf));
            match operation {
                SetOperation::Union => each.fold(Aabb::EMPTY, Aabb::union),
                SetOperation::Intersection => each.fold(Aabb::EVERYWHERE, Aabb::intersection),
                SetOperation::Difference => each.take(1).fold(Aabb::EVERYWHERE, Aabb::intersection),
            }
        }
    }
}

impl Leaf {
    /// See [`Surface::bounds_during`].
    fn bounds_during(&self, shapes: &Shapes, part: [f64; 2]) -> Aabb {
        match &self.transform {
            Some(LeafTransform::Moving(motion)) if self.bounds.is_finite() => {
                let [start, end] = motion.bounds(&shapes.bounds(self.shape), part);
                start.union(end)
            }
            _ => self.bounds,
        }
    }
}

/// Of a plane that moves, when the shutter opens, as much as is ever within a box.
fn moving_plane_patch(plane: &Plane, motion: &MovingTransform, bounds: &Aabb) -> Option<Patch> {
    /// Between the moments that are looked at it may be a little more.
    const WIDER: f64 = 1.25;
    let n = plane.normal().as_dvec3();
    let (x, y) = basis64(n);
    let radius = 0.5 * f64::from(bounds.extent().length());
    let feet: Vec<(DVec3, f64)> = motion
        .sampled_maps()
        .map(|map| {
            let back = map.inverse();
            let center = back.transform_point3(bounds.center().as_dvec3());
            // A matrix lengthens nothing more than by this.
            let columns = [back.matrix3.x_axis, back.matrix3.y_axis, back.matrix3.z_axis];
            let longest = columns.iter().map(|column| column.length_squared()).sum::<f64>().sqrt();
            (center - (center.dot(n) - plane.offset()) * n, radius * longest)
        })
        .collect();
    let middle = feet.iter().map(|(foot, _)| *foot).sum::<DVec3>() / feet.len() as f64;
    let reach = feet.iter().map(|(foot, radius)| foot.distance(middle) + radius).fold(0.0, f64::max);
    let size = 2.0 * WIDER * reach;
    let patch = Patch::parallelogram(middle - 0.5 * size * (x + y), [size * x, size * y]);
    patch.transformed(&motion.map_at(0.0))
}

impl Solid {
    /// Of a plane, as much as there can be of it in a result that has an end; in the space of that.
    fn plane_patch(&self, leaf: &Leaf) -> Option<Patch> {
        let plane = <Plane as Pooled<Shapes>>::find(&self.shapes, leaf.shape)?;
        let bounds = self.bounds.is_finite().then_some(self.bounds)?;
        if let Some(LeafTransform::Moving(motion)) = &leaf.transform {
            return moving_plane_patch(plane, motion, &bounds);
        }
        let map = leaf.start;
        let normal = map.matrix3.inverse().transpose() * plane.normal().as_dvec3();
        let n = normal.try_normalize()?;
        let on_plane = map.transform_point3(plane.offset() * plane.normal().as_dvec3());
        let center = bounds.center().as_dvec3();
        let foot = center - (center - on_plane).dot(n) * n;
        let (x, y) = basis64(n);
        let size = f64::from(bounds.extent().length());
        Some(Patch::parallelogram(foot - 0.5 * size * (x + y), [size * x, size * y]))
    }

    /// Triangles of a whole leaf when the shutter opens, in the space of the result.
    fn tessellated(&self, leaf: &Leaf, around: u32) -> Tessellation {
        let mut own = Tessellation::default();
        if let Some(patch) = self.plane_patch(leaf) {
            own.patch(0, &patch, around);
            return own;
        }
        self.shapes.tessellate(leaf.shape, around, &mut own);
        leaf.in_place(0.0, own, |mut own, transform| {
            own.place(transform);
            own
        })
    }

    /// The patches of all leaves.
    fn each_patch(&self, visit: &mut dyn FnMut(u32, Patch)) {
        for leaf in &self.leaves {
            self.plane_patch(leaf).into_iter().for_each(|patch| visit(leaf.first_part, patch));
            self.shapes.patches(leaf.shape, &mut |part, patch| {
                let patch = if leaf.inverted { patch.by_area() } else { Some(patch) };
                let placed = match patch {
                    Some(patch) if leaf.transform.is_some() => patch.transformed(&leaf.start),
                    patch => patch,
                };
                placed.into_iter().for_each(|patch| visit(leaf.first_part + part, patch));
            });
        }
    }
}

impl Surface for Csg {
    fn bounds(&self) -> Aabb {
        let bounds = self.0.bounds;
        if bounds.is_empty() { Aabb::EMPTY } else { bounds }
    }

    fn is_finite(&self) -> bool {
        // What it is made of was asked before.
        self.0.leaves.iter().all(|leaf| leaf.start.is_finite())
    }

    fn hit(&self, ray: &Ray) -> Option<Hit> {
        let mut first = None;
        with_scratch(|scratch| {
            self.0.walk(ray, scratch, |hit| {
                first = Some(hit);
                true
            });
        });
        first
    }

    fn crossings<F: FnMut(Hit)>(&self, ray: &Ray, mut visit: F) {
        // Whoever visits may ask another solid.
        let mut all = with_scratch(|scratch| {
            let mut all = std::mem::take(&mut scratch.found);
            all.clear();
            self.0.walk(ray, scratch, |hit| {
                all.push(hit);
                false
            });
            all
        });
        all.drain(..).for_each(&mut visit);
        with_scratch(|scratch| scratch.found = all);
    }

    fn surface_at(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let (_, leaf, part) = self.leaf_of(hit.part);
        let point = self.0.leaf_surface(leaf, ray, &Hit { part, ..*hit });
        if leaf.inverted { SurfacePoint { n: -point.n, ng: -point.ng, ..point } } else { point }
    }

    fn hit_at(&self, part: u32, p: Vec3) -> Hit {
        let hit = Hit { part, ..Hit::default() };
        let inner = self.at_leaf(&hit, p, |shapes, shape, hit, p| shapes.hit_at(shape, hit.part, p));
        Hit { part, ..inner }
    }

    fn uv_at(&self, hit: &Hit, p: Vec3) -> Vec2 {
        self.at_leaf(hit, p, |shapes, shape, hit, p| shapes.uv_at(shape, hit, p))
    }

    fn second_uv_at(&self, hit: &Hit, p: Vec3) -> Option<Vec2> {
        self.at_leaf(hit, p, |shapes, shape, hit, p| shapes.second_uv_at(shape, hit, p))
    }

    fn color_at(&self, hit: &Hit) -> Option<Vec4> {
        self.at_leaf(hit, Vec3::ZERO, |shapes, shape, hit, _| shapes.color_at(shape, hit))
    }

    fn tangents_at(&self, hit: &Hit, p: Vec3) -> Tangents {
        let own = self.at_leaf(hit, p, |shapes, shape, hit, p| shapes.tangents_at(shape, hit, p));
        let (_, leaf, _) = self.leaf_of(hit.part);
        leaf.in_place(0.0, own, |own, transform| own.transformed(transform))
    }

    fn second_tangents_at(&self, hit: &Hit, p: Vec3) -> Option<Tangents> {
        let own = self.at_leaf(hit, p, |shapes, shape, hit, p| shapes.second_tangents_at(shape, hit, p))?;
        let (_, leaf, _) = self.leaf_of(hit.part);
        Some(leaf.in_place(0.0, own, |own, transform| own.transformed(transform)))
    }

    fn part_motion(&self, part: u32) -> Option<&MovingTransform> {
        match &self.leaf_of(part).1.transform {
            Some(LeafTransform::Moving(motion)) => Some(motion),
            _ => None,
        }
    }

    fn has_moving_parts(&self) -> bool {
        self.0.leaves.iter().any(|leaf| leaf.map.constant().is_none())
    }

    fn expose(&mut self, shutter: Shutter) {
        if !self.has_moving_parts() {
            return;
        }
        let mut making = Making::new(shutter);
        // It was possible before.
        if let Ok(expression) = making.solid(self, &Motion::still(DAffine3::IDENTITY), Some(None)) {
            *self = making.finish(expression);
        }
    }

    fn moves(&self) -> bool {
        self.0.leaves.iter().any(|leaf| matches!(leaf.transform, Some(LeafTransform::Moving(_))))
    }

    fn bounds_during(&self, part: [f64; 2]) -> Aabb {
        let solid = &*self.0;
        bounds_of(&solid.expression, &|leaf| solid.leaves[leaf as usize].bounds_during(&solid.shapes, part))
    }

    fn is_closed(&self) -> bool {
        self.0.bounds.is_finite() || self.0.bounds.is_empty()
    }

    fn is_solid(&self) -> bool {
        true
    }

    fn part_count(&self) -> u32 {
        let last = self.0.leaves.last();
        last.map_or(0, |leaf| leaf.first_part + self.0.shapes.part_count(leaf.shape))
    }

    /// Those of all leaves, whole: [`Surface::shows`] says what of them there is.
    fn patches<F: FnMut(u32, Patch)>(&self, mut visit: F) {
        self.0.each_patch(&mut visit);
    }

    fn is_partial(&self) -> bool {
        true
    }

    fn shows(&self, part: u32, p: Vec3, time: f32) -> bool {
        let (leaf, ..) = self.leaf_of(part);
        with_scratch(|scratch| self.0.depends_on(leaf, p, time, scratch))
    }

    fn is_inverted(&self, part: u32) -> bool {
        self.leaf_of(part).1.inverted
    }

    fn tessellate(&self, around: u32, out: &mut Tessellation) {
        for (i, leaf) in self.0.leaves.iter().enumerate() {
            let mut own = self.0.tessellated(leaf, around);
            if leaf.inverted {
                own.turn_inside_out();
            }
            let keeps = |p: Vec3| with_scratch(|scratch| self.0.depends_on(i as u32, p, 0.0, scratch));
            own.cut(leaf.first_part, keeps, out);
        }
    }

    fn material_slot(&self, part: u32) -> Option<MaterialSlot> {
        let (_, leaf, part) = self.leaf_of(part);
        let brought =
            if leaf.brings_materials { self.0.shapes.material_slot(leaf.shape, part) } else { None };
        brought.or(leaf.material)
    }

    fn heap_bytes(&self) -> usize {
        let solid = &*self.0;
        let of_shapes: usize = solid.leaves.iter().map(|leaf| solid.shapes.heap_bytes(leaf.shape)).sum();
        size_of::<Solid>()
            + solid.shapes.bytes()
            + of_shapes
            + size_of_val(&*solid.leaves)
            + solid.tree.as_ref().map_or(0, |tree| tree.stats().bytes)
    }
}

#[cfg(test)]
mod tests;
