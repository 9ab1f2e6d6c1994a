//! `Group` and `Transform` blocks and the objects in them.

use kajo_math::{DAffine3, Motion, Transform, Vec2};
use kajo_scene::{Args, Diagnostic, Item, Params, not_supported_yet, unknown_word};

use super::definition::{BYTES_PER_OBJECT, Part};
use super::materials::Reference;
use super::places::misplaced;
use super::{Compiler, motion, transform};
use crate::material::MaterialId;
use crate::motion::MovingTransform;
use crate::nested::Content;
use crate::scene::Primitive;
use crate::shape::{Cone, Cuboid, Disk, Plane, Quad, ShapeId, Sphere, Triangle};
use crate::texture::{Channel, PictureMap, Share};

/// Words for objects, groups and transforms included.
pub(super) const OBJECTS: [&str; 13] = [
    "Box",
    "Cone",
    "Cylinder",
    "Disk",
    "Group",
    "Instance",
    "Model",
    "Plane",
    "Quad",
    "Sphere",
    "Transform",
    "Triangle",
    "TriangleMesh",
];
const LATER: [&str; 11] = [
    "BezierCurve",
    "Blob",
    "BsplineCurve",
    "Difference",
    "HeightField",
    "Intersection",
    "Isosurface",
    "Quartic",
    "RevSurface",
    "Torus",
    "Union",
];

/// The running state of a walk through groups.
#[derive(Default)]
pub(super) struct Walk {
    /// Set by `MaterialIndex`; stays in force after the group it stands in, as in the classic format.
    pub material: Option<MaterialId>,
    /// A `MaterialIndex` was wrong, which has been reported: objects without a material are no news.
    pub material_failed: bool,
    /// What has been found of a definition, while one is read: nothing in it is an object of the scene yet.
    pub parts: Option<Vec<Part>>,
}

/// Where objects stand.
pub(super) struct Place {
    pub world: Motion,
    /// The same with its inverse at a moment; `None` when there is none, and what stands here is never hit.
    transform: Option<Transform>,
    /// Its number among the scene's, once an object needs it.
    index: Option<u32>,
}

impl Place {
    /// Where nothing has been moved.
    pub fn origin() -> Place {
        Place::new(Motion::still(DAffine3::IDENTITY))
    }

    fn new(world: Motion) -> Place {
        let transform = match world.constant() {
            Some(map) => Transform::new(map),
            None => Transform::new(&world.at(0.0)),
        };
        let stays = transform.filter(|transform| world.constant().is_some() && transform.is_identity());
        Place { world, transform, index: stays.map(|_| 0) }
    }

    /// The transform of a place that does not move.
    fn fixed(&self) -> Option<&Transform> {
        self.transform.as_ref().filter(|_| self.world.constant().is_some())
    }

    /// The same place for something that has no inverse whatever rounding makes of it.
    fn flattened(self) -> Place {
        Place { transform: None, ..self }
    }

    /// The place of something that stands within what stands here.
    pub fn around(&self, map: &Motion) -> Place {
        let there = Place::new(self.world.then(map));
        if self.is_flat() { there.flattened() } else { there }
    }

    /// The place of something that has been taken here already.
    fn baked(&self) -> Place {
        let origin = Place::origin();
        if self.is_flat() { origin.flattened() } else { origin }
    }

    pub fn is_flat(&self) -> bool {
        self.transform.is_none()
    }
}

impl Compiler<'_> {
    /// Everything in the scene's group.
    pub(super) fn objects(&mut self, group: Item<'_>) {
        self.group(group, &mut Place::origin(), &mut Walk::default());
        if let Some((count, first)) = self.flat_triangles {
            let message = match count {
                1 => "this triangle has no area and is left out".to_owned(),
                n => format!("{n} triangles have no area and are left out"),
            };
            let label = if count == 1 { "its corners lie on a line" } else { "the first one" };
            self.diagnostics.push(Diagnostic::warning(message).label(first, label));
        }
    }

    pub(super) fn group(&mut self, group: Item<'_>, place: &mut Place, walk: &mut Walk) {
        let mut objects = 0;
        let mut count = None;
        for item in self.children(group) {
            match item.keyword() {
                "numObjects" => count = Some(item),
                word => {
                    // A misspelt object was meant to be one.
                    let is_object = OBJECTS.contains(&word) || (item.has_block() && word != "Define");
                    objects += usize::from(is_object);
                    self.object(item, group.keyword(), place, walk);
                }
            }
        }
        self.check_count("numObjects", count, objects, "object");
    }

    fn object(&mut self, item: Item<'_>, parent: &str, place: &mut Place, walk: &mut Walk) {
        match item.keyword() {
            "Define" => self.define(item, walk),
            "Group" => self.group(item, place, walk),
            "MaterialIndex" => {
                let reference = Args::read(item, self.diagnostics, Reference::read);
                let material = reference.and_then(|reference| self.material(&reference));
                walk.material_failed |= material.is_none();
                walk.material = material.or(walk.material);
            }
            "Instance" => self.instance(item, place, walk),
            "Model" => self.model(item, place, walk),
            "Transform" => self.transform(item, place, walk),
            word if OBJECTS.contains(&word) => self.primitive(item, place, walk),
            word if LATER.contains(&word) => self.diagnostics.push(not_supported_yet(item)),
            _ => {
                let allowed = OBJECTS.into_iter().chain(["Define", "MaterialIndex", "numObjects"]);
                let error = misplaced(item, Some("Group"));
                let error = error.unwrap_or_else(|| unknown_word(item, Some(parent), allowed));
                self.diagnostics.push(error);
            }
        }
    }

    fn transform(&mut self, item: Item<'_>, place: &Place, walk: &mut Walk) {
        let mut operations = Vec::new();
        let mut objects = Vec::new();
        for child in self.children(item) {
            if !transform::MOVING_OPERATIONS.contains(&child.keyword()) {
                objects.push(child);
            } else if objects.is_empty() {
                operations.push(child);
            } else {
                let message = format!("`{}` comes after the object it should move", child.keyword());
                let error = Diagnostic::error(message).label(child.head_span(), "too late");
                self.diagnostics.push(error.help("write the operations first, then the object"));
            }
        }
        if objects.is_empty() {
            let warning = Diagnostic::warning("this `Transform` holds no object");
            self.diagnostics.push(warning.label(item.keyword_span(), "moves nothing"));
        }
        let mut there = self.moved(item, &operations, place);
        for object in objects {
            self.object(object, item.keyword(), &mut there, walk);
        }
    }

    /// The place that `operations` of `item` lead to from `place`; one that cannot be is reported.
    pub(super) fn moved(&mut self, item: Item<'_>, operations: &[Item<'_>], place: &Place) -> Place {
        let mut local = Motion::still(DAffine3::IDENTITY);
        let mut flattens = false;
        for &operation in operations {
            local = self.operate(local, operation);
            // Rounding in a later product could hide that there is no inverse.
            flattens |= local.at(0.0).matrix3.determinant() == 0.0;
        }
        let there = Place::new(place.world.then(&local));
        if place.is_flat() {
            return there.flattened();
        }
        if flattens || there.is_flat() {
            let message =
                format!("this `{}` has no inverse, so what it holds cannot be seen", item.keyword());
            let warning = Diagnostic::warning(message);
            self.diagnostics.push(warning.label(item.keyword_span(), "flattens its object"));
            return there.flattened();
        }
        there
    }

    /// A map after one more operation.
    fn operate(&mut self, map: Motion, operation: Item<'_>) -> Motion {
        let by_rows = self.rules.matrix_by_rows;
        if operation.keyword() == "Motion" {
            let keys = motion::read(operation, by_rows, self.diagnostics);
            return keys.map_or(map.clone(), |keys| map.then(&Motion::keyed(keys)));
        }
        let mut apply = |m| Motion::still(transform::apply(m, operation, by_rows, self.diagnostics));
        match map.constant() {
            Some(map) => apply(*map),
            // `Matrix` multiplies from the left.
            None if operation.keyword().starts_with("Matrix") => apply(DAffine3::IDENTITY).then(&map),
            None => map.then(&apply(DAffine3::IDENTITY)),
        }
    }

    fn primitive(&mut self, item: Item<'_>, place: &mut Place, walk: &mut Walk) {
        let mut baked = None;
        let (keyword, shape) = match item.keyword() {
            "Box" => ("Box", self.read(item, read_box).and_then(|s| self.shape(item, s))),
            "Cone" => ("Cone", self.read(item, |p| read_cone(p, true)).and_then(|s| self.shape(item, s))),
            "Cylinder" => {
                ("Cylinder", self.read(item, |p| read_cone(p, false)).and_then(|s| self.shape(item, s)))
            }
            "Disk" => ("Disk", self.read(item, read_disk).and_then(|s| self.shape(item, s))),
            "Plane" => ("Plane", self.read(item, read_plane).and_then(|s| self.shape(item, s))),
            "Quad" => ("Quad", self.read(item, read_quad).and_then(|s| self.shape(item, s))),
            "Sphere" => ("Sphere", self.read(item, read_sphere).and_then(|s| self.shape(item, s))),
            "Triangle" => {
                let shape = self.triangle(item, place);
                baked = place.world.constant().map(|_| place.baked());
                ("Triangle", shape)
            }
            _ => ("TriangleMesh", self.mesh(item)),
        };
        let name = item.word().map(|word| word.text().into());
        let brings_materials = keyword == "TriangleMesh" && self.slots_transmit;
        let Some(shape) = shape else {
            self.material_for(item, walk);
            return;
        };
        if !self.has_memory(BYTES_PER_OBJECT, item.head_span()) {
            return;
        }
        let part = Part {
            content: Content::Shape(shape),
            map: Motion::still(DAffine3::IDENTITY),
            material: None,
            label: self.objects.label(name, keyword, item.index()),
            brings_materials,
        };
        self.put(&part, item, baked.as_mut().unwrap_or(place), walk);
    }

    /// Makes `part` an object at `place`: of the definition that is being read, else of the scene.
    ///
    /// * `by`: what puts it there
    pub(super) fn put(&mut self, part: &Part, by: Item<'_>, place: &mut Place, walk: &mut Walk) {
        if let Some(parts) = &mut walk.parts {
            if !place.is_flat() && self.may_stand(part, by, place) {
                let own = part.material.or(walk.material);
                let material = own.map(|material| self.see_through(part.content, material));
                parts.push(Part { map: place.world.clone(), material, ..part.clone() });
            }
            return;
        }
        let shape = match part.content {
            Content::Shape(shape) => shape,
            Content::Assembly(number) => return self.place_assembly(number, part.material, by, place, walk),
        };
        let material = part.material.or_else(|| self.material_for(by, walk));
        let (Some(material), Some(transform)) = (material, self.transform_number(place, by)) else { return };
        let material = self.see_through(part.content, material);
        let transmits = part.brings_materials || self.materials.may_transmit(material, &self.materials);
        self.primitives.push(Primitive { shape, transform, material, transmits, glows: false });
        self.objects.push(part.label, by.index());
    }

    /// The material of a part: one that is not everywhere, if the colours of a mesh say so.
    fn see_through(&mut self, content: Content, material: MaterialId) -> MaterialId {
        let is_clear = matches!(content, Content::Shape(shape) if self.clear_meshes.contains(&shape));
        // Light passes such a material anyway, or it has the opacities of vertices as a factor already.
        if !is_clear || self.materials.may_transmit(material, &self.materials) {
            return material;
        }
        if let Some(&known) = self.see_through.get(&material) {
            return known;
        }
        let opacity = Share::Picture(PictureMap::white(), Channel::Alpha);
        let glow = self.glows.get(&material).cloned();
        let id = self.lit_and_cut(material, glow, Some(opacity)).unwrap_or(material);
        self.see_through.insert(material, id);
        id
    }

    /// The material in force; its absence is reported.
    pub(super) fn material_for(&mut self, item: Item<'_>, walk: &Walk) -> Option<MaterialId> {
        let materials_failed = self.diagnostics.has_errors() && self.material_list.is_empty();
        if walk.material.is_none() && walk.parts.is_none() && !walk.material_failed && !materials_failed {
            let error = Diagnostic::error(format!("`{}` has no material", item.keyword()));
            let help = "write `MaterialIndex 0`, or the name of a material, before it";
            let error = error.label(item.keyword_span(), "no `MaterialIndex` before this");
            self.diagnostics.push(error.help(help));
        }
        walk.material
    }

    /// The number of a place's transform; `None` when it has none and nothing there can be hit.
    fn transform_number(&mut self, place: &mut Place, by: Item<'_>) -> Option<u32> {
        let transform = place.transform?;
        if place.index.is_none() {
            let moves = place.world.constant().is_none();
            let bytes = if moves { size_of::<MovingTransform>() } else { size_of::<Transform>() };
            if !self.has_memory(bytes, by.head_span()) {
                return None;
            }
        }
        let number = match (place.index, place.world.constant()) {
            (Some(number), _) => number,
            (None, Some(_)) => {
                self.transforms.push(transform);
                self.transforms.len() as u32 - 1
            }
            (None, None) => {
                let number = u32::MAX - self.motions.len() as u32;
                self.motions.push(MovingTransform::new(place.world.clone(), self.shutter));
                number
            }
        };
        place.index = Some(number);
        Some(number)
    }

    /// A single triangle, taken to its place at once unless it moves: no ray is ever transformed for it.
    fn triangle(&mut self, item: Item<'_>, place: &Place) -> Option<ShapeId> {
        let mut triangle = self.read(item, read_triangle)?;
        if triangle.is_degenerate() {
            let (count, _) = self.flat_triangles.get_or_insert((0, item.keyword_span()));
            *count += 1;
            return None;
        }
        if let Some(transform) = place.fixed().filter(|transform| !transform.is_identity()) {
            triangle.vertices = triangle.vertices.map(|v| transform.point(v));
            if transform.mirrors() {
                // The normal keeps its side of the surface: the order of the corners turns round.
                triangle.vertices.swap(1, 2);
                triangle.uvs.swap(1, 2);
            }
        }
        self.shape(item, triangle)
    }

    /// The items in a block; an item without a block is reported.
    pub(super) fn children<'t>(&mut self, item: Item<'t>) -> Vec<Item<'t>> {
        let mut params = Params::new(item, self.diagnostics);
        params.name();
        let children = params.rest();
        params.finish();
        children
    }
}

fn read_sphere(params: &mut Params<'_, '_>) -> Option<Sphere> {
    params.name();
    let center = params.required("center", Args::vec3);
    let radius = params.required("radius", Args::number);
    Some(Sphere::new(center?, radius?))
}

fn read_plane(params: &mut Params<'_, '_>) -> Option<Plane> {
    params.name();
    let normal = params.required("normal", Args::vec3);
    let offset = params.required("offset", Args::number);
    Some(Plane::new(normal?.as_dvec3(), offset?.into()))
}

fn read_triangle(params: &mut Params<'_, '_>) -> Option<Triangle> {
    params.name();
    let vertices = ["vertex0", "vertex1", "vertex2"].map(|key| params.required(key, Args::vec3));
    let uvs = ["textCoord0", "textCoord1", "textCoord2"].map(|key| params.optional(key, Args::vec2));
    let uvs: [Vec2; 3] = std::array::from_fn(|i| uvs[i].unwrap_or([Vec2::ZERO, Vec2::X, Vec2::Y][i]));
    let [a, b, c] = vertices;
    Some(Triangle { vertices: [a?, b?, c?], uvs })
}

fn read_box(params: &mut Params<'_, '_>) -> Option<Cuboid> {
    params.name();
    let min = params.required("min", Args::vec3);
    let max = params.required("max", Args::vec3);
    Some(Cuboid::new(min?, max?))
}

/// A cone, or a cylinder when it does not taper.
fn read_cone(params: &mut Params<'_, '_>, tapers: bool) -> Option<Cone> {
    params.name();
    let base = params.required("base", Args::vec3);
    let top = params.required("top", |args| Ok((args.vec3()?, args.item())));
    let radius = params.required("radius", Args::number);
    let top_radius = if tapers { Some(params.or("topRadius", 0.0, Args::number)) } else { radius };
    let capped = params.or("capped", true, Args::flag);
    let (base, (top, place)) = (base?, top?);
    let cone = Cone::new(base, top, radius?, top_radius?, capped);
    report(params, cone, place, "`base` and `top` are the same point")
}

fn read_disk(params: &mut Params<'_, '_>) -> Option<Disk> {
    params.name();
    let center = params.required("center", Args::vec3);
    let normal = params.required("normal", |args| Ok((args.vec3()?, args.item())));
    let radius = params.required("radius", Args::number);
    let inner = params.or("innerRadius", 0.0, Args::number);
    let (normal, place) = normal?;
    let disk = Disk::new(center?, normal, radius?, inner);
    report(params, disk, place, "`normal` must not be zero")
}

fn read_quad(params: &mut Params<'_, '_>) -> Option<Quad> {
    params.name();
    let [corner, edge1] = ["corner", "edge1"].map(|key| params.required(key, Args::vec3));
    let edge2 = params.required("edge2", |args| Ok((args.vec3()?, args.item())));
    let (edge2, place) = edge2?;
    let quad = Quad::new(corner?, edge1?, edge2);
    report(params, quad, place, "`edge1` and `edge2` must not be parallel or zero")
}

/// Reports a shape that cannot be.
fn report<T>(params: &mut Params<'_, '_>, shape: Option<T>, place: Item<'_>, message: &str) -> Option<T> {
    if shape.is_none() {
        params
            .diagnostics()
            .push(Diagnostic::error(message).label(place.head_span(), "leaves no such shape"));
    }
    shape
}
