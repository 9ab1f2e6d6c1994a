//! The compiled scene: everything rays meet, immutable and shared by all threads.

mod accel;
mod extent;
mod fitted;
mod immersion;
mod rays;

use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

use kajo_color::Spectrum;
use kajo_math::{Aabb, Ray, Transform, Vec2, Vec3, Vec4};

use crate::background::Background;
use crate::bsdf::Phong;
use crate::camera::{Camera, NamedCamera};
use crate::family::Pooled;
use crate::glow::VariedEmission;
use crate::ids::{ObjectId, PoseId};
use crate::interaction::{Hit, SurfacePoint, Tangents};
use crate::item_buffer::{Body, ItemBuffer};
use crate::light::{LightId, LightSampler, Lights};
use crate::material::{Appearances, MaterialId, MaterialPoint, Materials};
use crate::medium::Fog;
use crate::motion::MovingTransform;
use crate::nested::{Leaf, NestedPiece};
use crate::objects::{Object, Objects};
use crate::settings::{Rules, Settings};
use crate::shape::{ShapeId, Shapes, Sphere, Surface};
use crate::texture::{SurfaceUv, Textures};

pub(crate) use accel::Aggregate;
pub use extent::Extent;
pub use fitted::{Fitted, FittedCamera};
pub use immersion::Immersion;

/// A shape at its place in the world, with its material.
#[derive(Clone, Copy, Debug)]
pub struct Primitive {
    /// The geometry.
    pub shape: ShapeId,
    /// Where it stands.
    pub pose: PoseId,
    /// The material of parts that bring none of their own.
    pub material: MaterialId,
    /// Whether light may pass through any part.
    pub transmits: bool,
    /// Whether any part gives light.
    pub glows: bool,
}

/// What becomes of a ray.
#[derive(Clone, Copy, Debug)]
pub enum Event {
    /// It meets a surface.
    Surface(Interaction),
    /// It leaves the scene.
    Escaped,
}

impl Event {
    /// Where it meets a surface.
    pub fn surface(&self) -> Option<&Interaction> {
        match self {
            Event::Surface(at) => Some(at),
            Event::Escaped => None,
        }
    }
}

/// A ray's meeting with a surface, in world space.
#[derive(Clone, Copy, Debug, Default)]
pub struct Interaction {
    /// Position and normals.
    pub point: SurfacePoint,
    /// The record of the hit in the shape's own terms.
    pub hit: Hit,
    /// Index into [`Scene::primitives`], or past its end the number of an object in a nested instance.
    pub object: ObjectId,
    /// The material there.
    pub material: MaterialId,
    /// Moment within the shutter interval.
    pub time: f32,
}

/// Primitives beyond which [`Scene::item_buffer`] would take longer than it saves.
const MOST_ITEMS: usize = 1 << 16;

/// A scene ready to be rendered.
#[derive(Debug)]
pub struct Scene {
    /// Geometry, in object space.
    pub shapes: Shapes,
    /// Maps from object to world space; the first is the identity.
    pub transforms: Vec<Transform>,
    /// Maps that may change while the shutter is open.
    pub motions: Vec<MovingTransform>,
    /// Shapes at their places, in the order of the file. Object `i + 1` of the id layers is primitive `i`; numbers past
    /// the end are those of objects in nested instances.
    pub primitives: Vec<Primitive>,
    /// Whether light may pass through any of them.
    pub transmits: bool,
    /// Whether any material shows a picture, so that it has to know surface coordinates.
    pub has_pictures: bool,
    /// Whether any mesh has colours at its corners.
    pub has_vertex_colors: bool,
    /// Whether any material turns the frame in which it scatters, so that it has to be asked; see [`Scene::shading`].
    pub has_orientations: bool,
    /// Whether light goes straight on through any material, so that what is behind is seen and lit through its holes or
    /// panes.
    pub has_passages: bool,
    /// The user's words for each primitive; see [`Scene::object`].
    pub objects: Objects,
    /// Materials.
    pub materials: Materials,
    /// Every material of the file, in its order, with its name. Number `i + 1` of the id layers is entry `i`.
    pub material_list: Vec<(MaterialId, Option<String>)>,
    /// Materials of mesh parts, by [`crate::shape::Surface::material_slot`].
    pub slot_materials: Vec<MaterialId>,
    /// Patterns that materials use.
    pub textures: Textures,
    /// Light of surfaces that differs from place to place; see [`crate::light::AreaLight::varied`].
    pub varied_emissions: Vec<VariedEmission>,
    /// Lights.
    pub lights: Lights,
    /// The lights in the order of the file, and then the pieces of glowing objects.
    pub light_list: Vec<LightId>,
    /// Names of the groups of lights; the first is that of lights without one.
    pub light_groups: Arc<[String]>,
    /// Everything that gives light, ready to be chosen from.
    pub light_sampler: LightSampler,
    /// Light that comes from everywhere.
    pub ambient: Spectrum,
    /// What escaping rays see.
    pub background: Arc<Background>,
    /// Fog everywhere, if any.
    pub fog: Option<Fog>,
    /// The camera.
    pub camera: Camera,
    /// What the camera fits into its picture; see [`Scene::camera_for`].
    pub fitted: Option<FittedCamera>,
    /// All cameras there are to choose from: those of the file in their order, then those of its models.
    pub cameras: Vec<NamedCamera>,
    /// In which share of the shutter's time its rows open one after the other, from the top; 0 where all open at once.
    pub readout: f32,
    /// What the file itself says about how to render it.
    pub settings: Settings,
    /// The conventions of the file's dialect.
    pub rules: Rules,
    /// Whether the file has a group of objects at all; without one the reference shows the uv picture.
    pub has_group: bool,
    pub(crate) material_numbers: HashMap<MaterialId, u32>,
    pub(crate) aggregate: Aggregate,
}

impl Scene {
    /// Whether what a ray finds depends on its time.
    pub fn moves(&self) -> bool {
        self.camera.moves() || self.motions.iter().any(MovingTransform::moves)
    }

    /// The map of a primitive from its own space to the world's.
    ///
    /// * `time`: moment within the shutter interval
    pub fn place(&self, primitive: &Primitive, time: f32) -> Transform {
        self.transform_at(primitive.pose, time, |map| *map)
    }

    /// Whether a primitive moves while the shutter is open.
    pub(crate) fn is_moving(&self, primitive: &Primitive) -> bool {
        self.motion(primitive.pose).is_some_and(MovingTransform::moves)
    }

    /// The shape of an object.
    pub fn shape(&self, object: ObjectId) -> Option<ShapeId> {
        match self.primitives.get(object.index()) {
            Some(primitive) => Some(primitive.shape),
            None => self.leaf(object).map(|leaf| leaf.shape),
        }
    }

    /// The user's words for an object.
    pub fn object(&self, object: ObjectId) -> Option<Object<'_>> {
        match self.primitives.get(object.index()) {
            Some(_) => self.objects.get(object.index()),
            None => self.leaf(object).and_then(|leaf| self.objects.words(leaf.label, leaf.placed_by)),
        }
    }

    /// How many objects there are, those in nested instances included, each as often as it stands somewhere.
    pub fn object_count(&self) -> u64 {
        let nested = self.aggregate.nested().map_or(0, |nested| nested.count);
        self.primitives.len() as u64 + u64::from(nested)
    }

    /// Boxes around all nested instances, none of which [`Scene::primitives`] holds.
    pub fn nested_bounds(&self) -> impl Iterator<Item = Aabb> {
        self.aggregate.nested().into_iter().flat_map(|nested| nested.placement_bounds(&self.shapes))
    }

    /// Whether light may pass through any part of an object.
    pub(crate) fn may_transmit(&self, object: ObjectId) -> bool {
        match self.primitives.get(object.index()) {
            Some(primitive) => primitive.transmits,
            None => rarely(|| self.leaf(object).is_some_and(|leaf| self.leaf_transmits(&leaf))),
        }
    }

    /// What stands in nested instances, which [`Scene::primitives`] does not hold, in pieces.
    ///
    /// * `cost`: of showing a shape; a box costs 12
    /// * `budget`: what the pieces may cost together. The largest instances are taken apart first, and what is left is
    ///   boxes; of more than a twelfth of the budget some are left out
    pub fn nested_pieces(&self, cost: impl Fn(ShapeId) -> usize, budget: usize) -> Vec<NestedPiece> {
        let first = self.first_nested();
        let nested = self.aggregate.nested();
        nested.map_or_else(Vec::new, |nested| nested.pieces(&self.shapes, first, cost, budget))
    }

    /// The objects in nested instances that items of the text put into the scene, in order.
    ///
    /// * `is_wanted`: whether it is about what the item of this number places; see [`Object::placed_by`]
    pub fn nested_objects(&self, is_wanted: impl Fn(u32) -> bool) -> Vec<Range<ObjectId>> {
        let first = self.first_nested();
        self.aggregate.nested().map_or_else(Vec::new, |nested| nested.objects(first, is_wanted))
    }

    /// The first object in a nested instance.
    fn first_nested(&self) -> ObjectId {
        ObjectId::from_index(self.primitives.len() as u32)
    }

    /// An object in a nested instance.
    fn leaf(&self, object: ObjectId) -> Option<Leaf> {
        self.aggregate.nested()?.find(object.since(self.first_nested())?)
    }

    /// The name of an object in a nested instance among all.
    fn object_of(&self, leaf: &Leaf) -> ObjectId {
        self.first_nested().after(leaf.number)
    }

    fn leaf_transmits(&self, leaf: &Leaf) -> bool {
        let transmits = |material| self.materials.may_transmit(material, &self.materials);
        leaf.brings_materials || leaf.material.is_some_and(transmits)
    }

    /// The motion that a pose names, if it names one.
    #[inline]
    fn motion(&self, pose: PoseId) -> Option<&MovingTransform> {
        pose.moving_in(&self.motions)
    }

    /// The motion of an object; what is in nested instances has none.
    #[inline]
    fn motion_of(&self, object: ObjectId) -> Option<&MovingTransform> {
        self.motion(self.primitives.get(object.index())?.pose)
    }

    /// What lies in which direction from a point, of what neither moves nor is nested; `None` where the trees do better,
    /// as for very large scenes.
    ///
    /// * `cells`: how many directions to tell apart, about; the more, the faster it answers, and the longer it
    ///   takes to be made
    pub fn item_buffer(&self, apex: Vec3, cells: usize) -> Option<ItemBuffer> {
        if self.primitives.len() > MOST_ITEMS {
            return None;
        }
        let body = |(index, p): (u32, &Primitive)| {
            let bounds = self.world_bounds(p);
            let untransformed = p.pose.is_identity();
            let sphere = Sphere::find(&self.shapes, p.shape).filter(|_| untransformed).copied();
            let bounded = bounds.is_finite() && !bounds.is_empty() && !self.is_moving(p);
            let object = ObjectId::from_index(index);
            bounded.then_some(Body { object, bounds, sphere, opaque: !p.transmits })
        };
        let bodies: Vec<Body> = (0..).zip(&self.primitives).filter_map(body).collect();
        ItemBuffer::new(apex, &bodies, cells)
    }

    /// What materials are looked up in.
    #[inline]
    pub fn appearances(&self) -> Appearances<'_> {
        Appearances { materials: &self.materials, textures: &self.textures }
    }

    /// Where patterns in world space are evaluated for an interaction: at the point itself, or where that was at
    /// time 0 if it belongs to something that moves.
    #[inline]
    pub(crate) fn pattern_point(&self, at: &Interaction) -> Vec3 {
        if self.motions.is_empty() {
            return at.point.p;
        }
        match self.motion_of(at.object) {
            None => at.point.p,
            Some(motion) => motion.painted(at.point.p, at.time),
        }
    }

    /// Where materials are evaluated for an interaction.
    #[inline]
    pub fn material_point(&self, at: &Interaction) -> MaterialPoint {
        let needs_uv = || self.materials.needs_uv(at.material, &self.materials);
        let uv = if self.has_pictures && needs_uv() {
            rarely(|| self.surface_uv(at))
        } else {
            SurfaceUv::default()
        };
        MaterialPoint { p: self.pattern_point(at), uv, tint: self.tint(at) }
    }

    /// The colour of the corners around an interaction with a mesh that has some.
    #[inline]
    pub(crate) fn tint(&self, at: &Interaction) -> Option<Vec4> {
        let of = |shape| self.shapes.color_at(shape, &at.hit);
        if self.has_vertex_colors { rarely(|| self.shape(at.object).and_then(of)) } else { None }
    }

    /// The classic reflection model of a material, where it is the same at every point whatever has the material.
    #[inline]
    pub fn constant(&self, material: MaterialId) -> Option<&Phong> {
        if self.has_vertex_colors { None } else { self.materials.constant(material) }
    }

    /// Where the point of an interaction is at another moment within the shutter interval.
    pub fn point_at(&self, at: &Interaction, time: f32) -> Vec3 {
        match self.motion_of(at.object) {
            None => at.point.p,
            Some(motion) => {
                let own = motion.at(at.time).object_from_world.transform_point3(at.point.p);
                motion.at(time).point(own)
            }
        }
    }

    /// The colour that light is multiplied by when it passes a crossing straight through.
    #[inline]
    pub fn transparency(&self, ray: &Ray, object: ObjectId, hit: Hit) -> Spectrum {
        let material = match self.primitives.get(object.index()) {
            Some(placed) => self.material_at(placed.shape, placed.material, &hit),
            None => self.interaction(ray, object, hit).material,
        };
        if let Some(phong) = self.constant(material) {
            return phong.transparent;
        }
        let place = self.material_point(&self.interaction(ray, object, hit));
        self.appearances().phong(material, &place).transparent
    }

    #[inline]
    fn material_at(&self, shape: ShapeId, own: MaterialId, hit: &Hit) -> MaterialId {
        let slot = self.shapes.material_slot(shape, hit.part);
        slot.map_or(own, |slot| self.slot_materials[slot as usize])
    }

    /// What the surface says of the place of an interaction.
    pub(crate) fn surface_uv(&self, at: &Interaction) -> SurfaceUv {
        let uv = self.uv(at);
        let second = self.shape(at.object).and_then(|shape| self.shapes.second_uv_at(shape, &at.hit));
        SurfaceUv { first: uv, second: second.unwrap_or(uv) }
    }

    /// Surface coordinates at an interaction.
    pub fn uv(&self, at: &Interaction) -> Vec2 {
        let own = |map: &Transform| map.object_from_world.transform_point3(at.point.p);
        match self.primitives.get(at.object.index()) {
            Some(&Primitive { shape, pose, .. }) => {
                self.shapes.uv_at(shape, &at.hit, self.transform_at(pose, at.time, own))
            }
            None => self
                .leaf(at.object)
                .map_or(Vec2::ZERO, |leaf| self.shapes.uv_at(leaf.shape, &at.hit, own(&leaf.place()))),
        }
    }

    /// How the position at an interaction changes with surface coordinates, in world space.
    pub fn tangents(&self, at: &Interaction) -> Tangents {
        let of = |shape: ShapeId, map: &Transform| {
            let own = map.object_from_world.transform_point3(at.point.p);
            self.shapes.tangents_at(shape, &at.hit, own).transformed(map)
        };
        match self.primitives.get(at.object.index()) {
            Some(&Primitive { shape, pose, .. }) => self.transform_at(pose, at.time, |map| of(shape, map)),
            None => {
                let leaf = self.leaf(at.object);
                leaf.map_or_else(Tangents::default, |leaf| of(leaf.shape, &leaf.place()))
            }
        }
    }

    /// The number of a material in the id layers: its place in the file from 1 on; 0 for a material
    /// that came with a mesh.
    pub fn material_number(&self, material: MaterialId) -> u32 {
        self.material_numbers.get(&material).copied().unwrap_or(0)
    }

    /// A box around everything that has bounds, at any time while the shutter is open.
    pub fn bounds(&self) -> Aabb {
        self.primitives
            .iter()
            .map(|p| self.world_bounds(p))
            .chain(self.nested_bounds())
            .filter(Aabb::is_finite)
            .fold(Aabb::EMPTY, Aabb::union)
    }

    /// Bytes of geometry and its trees.
    pub fn bytes(&self) -> usize {
        let meshes: usize = self.shapes.meshes.iter().map(Surface::heap_bytes).sum();
        let placed = size_of_val(&*self.primitives) + size_of_val(&*self.transforms);
        meshes + self.aggregate.bytes() + placed + self.objects.bytes()
    }

    pub(crate) fn world_bounds(&self, primitive: &Primitive) -> Aabb {
        let bounds = self.shapes.bounds(primitive.shape);
        if primitive.pose.is_identity() {
            return bounds;
        }
        match primitive.pose.still_in(&self.transforms) {
            Some(transform) => transform.bounds(&bounds),
            None => {
                let motion = self.motion(primitive.pose);
                motion.map_or(Aabb::EMPTY, |motion| motion.bounds_of_all_times(&bounds))
            }
        }
    }

    /// Boxes of a moving primitive at the ends of a part of the shutter's interval; empty for any other, and for
    /// unbounded ones.
    pub(crate) fn moving_bounds(&self, primitive: &Primitive, part: [f64; 2]) -> [Aabb; 2] {
        let bounds = self.shapes.bounds(primitive.shape);
        match self.motion(primitive.pose) {
            Some(motion) if motion.moves() && bounds.is_finite() => motion.bounds(&bounds, part),
            _ => [Aabb::EMPTY; 2],
        }
    }

    /// `f` of the map of a primitive at a time.
    #[inline]
    fn transform_at<T>(&self, pose: PoseId, time: f32, f: impl FnOnce(&Transform) -> T) -> T {
        let moved;
        let map = match pose.still_in(&self.transforms) {
            Some(map) => map,
            None => {
                moved = rarely(|| self.motion(pose).map_or(Transform::IDENTITY, |motion| motion.at(time)));
                &moved
            }
        };
        f(map)
    }
}

/// `f` of nothing, out of the way of those who do not need it.
#[cold]
#[inline(never)]
pub(crate) fn rarely<T>(f: impl FnOnce() -> T) -> T {
    f()
}
