//! Nested instances in a bounded number of elements, for pictures that are made of lists.
//!
//! The largest things are taken apart first: what stands in the world, then what stands in that, as long as the list does
//! not grow too long. What is left whole is a box.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::ops::Range;

use kajo_math::{Aabb, DAffine3, Transform};

use super::{Assembly, Nested, PartContent};
use crate::ids::{AssemblyId, ObjectId};
use crate::material::MaterialId;
use crate::shape::{ShapeId, Shapes};

/// An object in a nested instance, or a whole instance.
#[derive(Clone, Debug, PartialEq)]
pub struct NestedElement {
    /// The object, or the first one in the instance.
    pub object: ObjectId,
    /// What it is.
    pub content: ElementContent,
    /// From its space to the world's.
    pub world_from_object: Transform,
    /// Of the object, unless its shape brings its own; of a whole instance, of the first object in it.
    pub material: MaterialId,
}

/// What a [`NestedElement`] is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ElementContent {
    /// One object.
    Shape(ShapeId),
    /// A box around all that is in an instance.
    Whole(Aabb),
}

impl Nested {
    /// What stands in the world, in elements.
    ///
    /// * `first_object`: of nested objects
    /// * `cost`: of showing a shape; a box costs 12
    /// * `budget`: what the elements may cost together; of placements more than a twelfth of it are left out
    pub fn elements(
        &self,
        shapes: &Shapes,
        first_object: ObjectId,
        cost: impl Fn(ShapeId) -> usize,
        budget: usize,
    ) -> Vec<NestedElement> {
        let (elements, wholes) = (Vec::new(), BinaryHeap::new());
        let mut gathering = Gathering { nested: self, shapes, first_object, elements, wholes };
        // The cost of what stands in each assembly, one level down.
        let of_member = |content| match content {
            PartContent::Shape(shape) => cost(shape),
            PartContent::Assembly(_) => WHOLE,
        };
        let of_assembly =
            |a: &Assembly| a.members.iter().map(|m| of_member(m.content)).fold(0, usize::saturating_add);
        let costs: Vec<usize> = self.assemblies.iter().map(of_assembly).collect();
        for placement in self.placements.iter().take(budget / WHOLE) {
            gathering.hold(placement.assembly, placement.map, placement.material, placement.first);
        }
        let mut spent = WHOLE * gathering.wholes.len();
        while let Some(whole) = gathering.wholes.pop() {
            let apart = spent.saturating_add(costs[whole.assembly.index()]) - WHOLE;
            if apart <= budget {
                spent = apart;
                gathering.take_apart(&whole);
            } else {
                gathering.keep(&whole);
            }
        }
        gathering.elements
    }

    /// The objects that items of the text put into the scene, in order.
    ///
    /// * `first_object`: of nested ones
    /// * `is_wanted`: whether it is about what the item of this number places
    pub fn objects(&self, first_object: ObjectId, is_wanted: impl Fn(u32) -> bool) -> Vec<Range<ObjectId>> {
        let objects =
            self.placements.iter().filter(|placement| is_wanted(placement.placed_by)).map(|placement| {
                let first = first_object.after(placement.first);
                first..first.after(self.assembly(placement.assembly).count)
            });
        objects.collect()
    }
}

/// Triangles of a box.
const WHOLE: usize = 12;

/// Pieces so far, and what may still be taken apart.
struct Gathering<'a> {
    nested: &'a Nested,
    shapes: &'a Shapes,
    first_object: ObjectId,
    elements: Vec<NestedElement>,
    wholes: BinaryHeap<Whole>,
}

/// An assembly somewhere in the world.
struct Whole {
    /// Diagonal of its box in world space.
    size: f32,
    assembly: AssemblyId,
    map: DAffine3,
    material: Option<MaterialId>,
    /// Its first object among the nested ones.
    first: u32,
}

impl Gathering<'_> {
    fn hold(&mut self, assembly: AssemblyId, map: DAffine3, material: Option<MaterialId>, first: u32) {
        let bounds = self.nested.bounds(PartContent::Assembly(assembly), &map, self.shapes);
        if bounds.is_empty() {
            return;
        }
        self.wholes.push(Whole { size: bounds.extent().length(), assembly, map, material, first });
    }

    fn take_apart(&mut self, whole: &Whole) {
        for member in &self.nested.assembly(whole.assembly).members {
            let (map, first) = (whole.map * member.map, whole.first + member.first);
            let material = member.material.or(whole.material);
            match member.content {
                PartContent::Assembly(number) => self.hold(number, map, material, first),
                PartContent::Shape(shape) => self.push(ElementContent::Shape(shape), &map, material, first),
            }
        }
    }

    fn keep(&mut self, whole: &Whole) {
        let assembly = self.nested.assembly(whole.assembly);
        let material = self.first_material(assembly, whole.material);
        self.push(ElementContent::Whole(assembly.tree.bounds()), &whole.map, material, whole.first);
    }

    fn push(&mut self, content: ElementContent, map: &DAffine3, material: Option<MaterialId>, first: u32) {
        // Rounding may have left a map without an inverse; rays meet nothing there either.
        let Some(place) = Transform::new(map) else { return };
        let (object, material) = (self.first_object.after(first), material.unwrap_or_default());
        self.elements.push(NestedElement { object, content, world_from_object: place, material });
    }

    /// The material of the first object in an assembly.
    fn first_material(&self, assembly: &Assembly, inherited: Option<MaterialId>) -> Option<MaterialId> {
        let member = assembly.members.first()?;
        let material = member.material.or(inherited);
        match member.content {
            PartContent::Shape(_) => material,
            PartContent::Assembly(number) => self.first_material(self.nested.assembly(number), material),
        }
    }
}

impl Ord for Whole {
    /// By size; of equals the one that stands first in the text is greater.
    fn cmp(&self, other: &Whole) -> Ordering {
        self.size.total_cmp(&other.size).then(other.first.cmp(&self.first))
    }
}

impl PartialOrd for Whole {
    fn partial_cmp(&self, other: &Whole) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Whole {
    fn eq(&self, other: &Whole) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Whole {}
