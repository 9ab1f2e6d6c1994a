//! Instances within instances, kept as the scene says them.
//!
//! A forest of a thousand groves of a thousand trees of a thousand leaves is 10^9 objects, but only three thousand
//! lines of text. Where a flat list would be long, the compiler makes an [`Assembly`] of a definition: its members,
//! each a shape or another assembly under a map, and a tree over them in the definition's own space. A ray goes down
//! from tree to tree.
//!
//! What a ray hits is the same, bit for bit, as in the flat list. An object under the maps `M_0, M_1, ... M_k`, outermost
//! first, is tested by the world-space ray and one map
//!
//! ```text
//! world_from_object = M_0 (M_1 ( ... M_k))
//! ```
//!
//! whose products are taken from the right in double precision, as the compiler takes them for the list. Only the trees
//! between are walked by rays in their own spaces. Such a ray differs from the one that decides by the rounding of both
//! on their ways from the world: with the inverse `A` of the maps so far, an origin `o` and the farthest coordinates `r`
//! of anything nested, by a few times
//!
//! ```text
//! 2^-24 size,    size = |A| (2 |o| + r) + |A_t|
//! ```
//!
//! on each axis: five roundings a coordinate, and more for maps that turn and stretch. Boxes are widened by what
//! [`Bvh::closest_of_derived`] takes for four times that size.
//!
//! Objects in assemblies are numbered after all others, in the order of the text.

mod elements;

use kajo_bvh::{BuildSettings, Bvh};
use kajo_math::{Aabb, DAffine3, Ray, Transform, Vec3};

use crate::ids::AssemblyId;
use crate::interaction::{Hit, SurfacePoint};
use crate::material::MaterialId;
use crate::objects::Label;
use crate::shape::{ShapeId, Shapes};
pub use elements::{ElementContent, NestedElement};

/// Most levels of assemblies within assemblies: a ray keeps a stack of a few kilobytes for each.
pub(crate) const MOST_LEVELS: u32 = 32;

/// What an instance refers to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PartContent {
    /// A shape.
    Shape(ShapeId),
    /// All parts of an assembly.
    Assembly(AssemblyId),
}

/// A shape or an assembly in an assembly.
#[derive(Clone, Debug)]
pub(crate) struct Member {
    pub content: PartContent,
    /// To the space of the assembly.
    pub map: DAffine3,
    /// For parts that have none of their own; without it they take that of what the assembly stands in.
    pub material: Option<MaterialId>,
    /// How many objects of the assembly come before.
    pub first: u32,
    pub label: Label,
    /// Whether the shape has materials of its own that may let light through.
    pub brings_materials: bool,
}

/// A definition with a tree of its own.
#[derive(Debug)]
pub(crate) struct Assembly {
    pub members: Vec<Member>,
    tree: Bvh,
    /// Objects in it, at all levels.
    pub count: u32,
    /// Assemblies one in the other, this one included.
    pub levels: u32,
    /// Whether anything in it takes its material from what it stands in.
    pub inherits: bool,
    /// Whether light may pass through anything that does not.
    pub transmits: bool,
}

/// An assembly in the world.
#[derive(Clone, Debug)]
pub(crate) struct Placement {
    pub assembly: AssemblyId,
    pub map: DAffine3,
    /// Of what brings none.
    pub material: Option<MaterialId>,
    /// How many objects come before.
    pub first: u32,
    /// Number of the item that put it there.
    pub placed_by: u32,
}

/// All assemblies of a scene, and where they stand.
#[derive(Debug, Default)]
pub(crate) struct Nested {
    pub assemblies: Vec<Assembly>,
    pub placements: Vec<Placement>,
    tree: Bvh,
    /// Objects in all placements.
    pub count: u32,
}

/// An object reached by descending the hierarchy of assemblies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leaf {
    /// Its number among all nested ones.
    pub number: u32,
    pub shape: ShapeId,
    /// From its space to the world's; `None` where they are the same.
    map: Option<Transform>,
    /// Of parts that bring none.
    pub material: Option<MaterialId>,
    pub label: Label,
    pub placed_by: u32,
    pub brings_materials: bool,
}

impl Leaf {
    /// `f` of the ray in the object's space.
    #[inline]
    pub fn in_object<T>(&self, ray: &Ray, f: impl FnOnce(&Ray) -> T) -> T {
        match &self.map {
            None => f(ray),
            Some(map) => f(&map.ray_in_object(ray)),
        }
    }

    /// The object's map to the world.
    pub fn world_from_object(&self) -> Transform {
        self.map.unwrap_or(Transform::IDENTITY)
    }

    pub fn surface_at(&self, shapes: &Shapes, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let point = self.in_object(ray, |ray| shapes.surface_at(self.shape, ray, hit));
        self.map.as_ref().map_or(point, |map| point.transformed(map))
    }
}

/// The way from the world down to an assembly.
struct AssemblyPath<'a> {
    above: Option<&'a AssemblyPath<'a>>,
    assembly: &'a Assembly,
    /// To the space above.
    map: &'a DAffine3,
    world_from_assembly: DAffine3,
    material: Option<MaterialId>,
    /// Number of the assembly's first object.
    first: u32,
    placed_by: u32,
}

impl<'a> AssemblyPath<'a> {
    /// The way on into a member that is an assembly.
    fn into(&'a self, member: &'a Member, assembly: &'a Assembly) -> AssemblyPath<'a> {
        AssemblyPath {
            above: Some(self),
            assembly,
            map: &member.map,
            world_from_assembly: self.world_from_assembly * member.map,
            material: member.material.or(self.material),
            first: self.first + member.first,
            placed_by: self.placed_by,
        }
    }

    /// The ray in the assembly's space, and the size of the numbers that it comes from.
    ///
    /// * `extent`: of the coordinates in world space that matter to the ray
    fn ray(&self, ray: &Ray, extent: Vec3) -> (Ray, Vec3) {
        let inverse = self.world_from_assembly.inverse();
        let o = inverse.transform_point3(ray.o.as_dvec3()).as_vec3();
        let d = inverse.transform_vector3(ray.d.as_dvec3()).as_vec3();
        let size = inverse.matrix3.abs() * extent.as_dvec3() + inverse.translation.abs();
        (Ray { o, d, ..*ray }, 4.0 * size.as_vec3())
    }

    /// A member that is a shape; `None` if rounding has left its map without an inverse.
    fn leaf(&self, member: &Member, shape: ShapeId) -> Option<Leaf> {
        let mut map = member.map;
        let mut way = Some(self);
        while let Some(level) = way {
            map = *level.map * map;
            way = level.above;
        }
        let map = Transform::new(&map)?;
        Some(Leaf {
            number: self.first + member.first,
            shape,
            map: (!map.is_identity()).then_some(map),
            material: member.material.or(self.material),
            label: member.label,
            placed_by: self.placed_by,
            brings_materials: member.brings_materials,
        })
    }
}

impl Nested {
    /// Makes an assembly of members, none of which moves or is unbounded.
    ///
    /// Returns its name, or `None` where it would have more objects than can be numbered, or too many levels.
    pub fn assemble(
        &mut self,
        mut members: Vec<Member>,
        shapes: &Shapes,
        may_transmit: impl Fn(MaterialId) -> bool,
        settings: &BuildSettings,
    ) -> Option<AssemblyId> {
        let (mut count, mut levels) = (0u32, 1);
        let (mut inherits, mut transmits) = (false, false);
        for member in &mut members {
            member.first = count;
            let (n, takes_material) = match member.content {
                PartContent::Shape(_) => (1, true),
                PartContent::Assembly(id) => {
                    let inner = self.assembly(id);
                    levels = levels.max(inner.levels + 1);
                    transmits |= inner.transmits;
                    (inner.count, inner.inherits)
                }
            };
            count = count.checked_add(n)?;
            inherits |= takes_material && member.material.is_none();
            transmits |=
                member.brings_materials || (takes_material && member.material.is_some_and(&may_transmit));
        }
        let boxes: Vec<Aabb> = members.iter().map(|m| self.bounds(m.content, &m.map, shapes)).collect();
        let tree = Bvh::build(&boxes, settings);
        let assembly = Assembly { members, tree, count, levels, inherits, transmits };
        let id = AssemblyId::new(self.assemblies.len()).filter(|_| levels <= MOST_LEVELS)?;
        self.assemblies.push(assembly);
        Some(id)
    }

    /// The assembly of a name.
    pub fn assembly(&self, id: AssemblyId) -> &Assembly {
        &self.assemblies[id.index()]
    }

    /// Places an assembly in the world; `false` where its objects could not all be numbered.
    ///
    /// * `room`: how many numbers there are for nested objects
    pub fn place(&mut self, placement: Placement, room: u32) -> bool {
        let count = self.count.checked_add(self.assembly(placement.assembly).count);
        let Some(count) = count.filter(|&count| count <= room) else { return false };
        self.placements.push(Placement { first: self.count, ..placement });
        self.count = count;
        true
    }

    /// Builds the tree over everything that has been placed.
    pub fn finish(&mut self, shapes: &Shapes, settings: &BuildSettings) {
        let boxes: Vec<Aabb> = self.placement_bounds(shapes).collect();
        self.tree = Bvh::build(&boxes, settings);
    }

    /// World-space boxes of all placements.
    pub fn placement_bounds(&self, shapes: &Shapes) -> impl Iterator<Item = Aabb> {
        self.placements.iter().map(|p| self.bounds(PartContent::Assembly(p.assembly), &p.map, shapes))
    }

    fn bounds(&self, content: PartContent, map: &DAffine3, shapes: &Shapes) -> Aabb {
        let own = match content {
            PartContent::Shape(shape) => shapes.bounds(shape),
            PartContent::Assembly(id) => self.assembly(id).tree.bounds(),
        };
        Transform::of_invertible(map).bounds(&own)
    }

    fn path_to(&self, placement: u32) -> AssemblyPath<'_> {
        let placement = &self.placements[placement as usize];
        AssemblyPath {
            above: None,
            assembly: self.assembly(placement.assembly),
            map: &placement.map,
            world_from_assembly: placement.map,
            material: placement.material,
            first: placement.first,
            placed_by: placement.placed_by,
        }
    }

    /// Coordinates that matter to a ray on its way through the assemblies, on each axis.
    fn extent(&self, ray: &Ray) -> Vec3 {
        let bounds = self.tree.bounds();
        2.0 * ray.o.abs() + bounds.min.abs().max(bounds.max.abs())
    }

    /// As [`Bvh::closest`], with objects in place of numbers.
    pub fn closest(&self, ray: &Ray, mut hit: impl FnMut(&Leaf, f32) -> f32) {
        let extent = self.extent(ray);
        self.tree.closest(ray, |i, t_max| {
            self.closest_in(&self.path_to(i), &ray.over(ray.t_min, t_max), extent, &mut hit)
        });
    }

    fn closest_in<F: FnMut(&Leaf, f32) -> f32>(
        &self,
        way: &AssemblyPath<'_>,
        ray: &Ray,
        extent: Vec3,
        hit: &mut F,
    ) -> f32 {
        let (inner, size) = way.ray(ray, extent);
        let mut nearest = ray.t_max;
        way.assembly.tree.closest_of_derived(&inner, size, |i, t_max| {
            let member = &way.assembly.members[i as usize];
            nearest = match member.content {
                PartContent::Shape(shape) => way.leaf(member, shape).map_or(t_max, |leaf| hit(&leaf, t_max)),
                PartContent::Assembly(id) => {
                    let below = way.into(member, self.assembly(id));
                    self.closest_in(&below, &ray.over(ray.t_min, t_max), extent, hit)
                }
            };
            nearest
        });
        nearest
    }

    /// As [`Bvh::any`], with objects in place of numbers.
    pub fn any(&self, ray: &Ray, mut hit: impl FnMut(&Leaf) -> bool) -> bool {
        let extent = self.extent(ray);
        self.tree.any(ray, |i| self.any_in(&self.path_to(i), ray, extent, &mut hit))
    }

    fn any_in<F: FnMut(&Leaf) -> bool>(
        &self,
        way: &AssemblyPath<'_>,
        ray: &Ray,
        extent: Vec3,
        hit: &mut F,
    ) -> bool {
        let (inner, size) = way.ray(ray, extent);
        way.assembly.tree.any_of_derived(&inner, size, |i| {
            let member = &way.assembly.members[i as usize];
            match member.content {
                PartContent::Shape(shape) => way.leaf(member, shape).is_some_and(|leaf| hit(&leaf)),
                PartContent::Assembly(id) => {
                    self.any_in(&way.into(member, self.assembly(id)), ray, extent, hit)
                }
            }
        })
    }

    /// The object with a number among all nested ones.
    pub fn find(&self, number: u32) -> Option<Leaf> {
        if number >= self.count {
            return None;
        }
        let placement = self.placements.partition_point(|p| p.first <= number).checked_sub(1)?;
        self.find_in(&self.path_to(placement as u32), number)
    }

    fn find_in(&self, way: &AssemblyPath<'_>, number: u32) -> Option<Leaf> {
        let members = &way.assembly.members;
        let place = members.partition_point(|m| way.first + m.first <= number).checked_sub(1)?;
        let member = &members[place];
        match member.content {
            PartContent::Shape(shape) => way.leaf(member, shape),
            PartContent::Assembly(below) => self.find_in(&way.into(member, self.assembly(below)), number),
        }
    }

    /// Bytes of members, placements and trees.
    pub fn bytes(&self) -> usize {
        let assembly = |a: &Assembly| size_of_val(&*a.members) + a.tree.stats().bytes;
        let assemblies: usize = self.assemblies.iter().map(assembly).sum();
        assemblies + size_of_val(&*self.placements) + self.tree.stats().bytes
    }
}
