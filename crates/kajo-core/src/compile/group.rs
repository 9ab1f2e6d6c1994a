//! `Group` and `Transform` blocks and the objects in them.

use kajo_math::{DAffine3, Transform, Vec2};
use kajo_scene::{Args, Diagnostic, Item, Params, not_supported_yet, unknown_word};

use super::materials::Reference;
use super::{Compiler, transform};
use crate::material::MaterialId;
use crate::scene::{Object, Primitive};
use crate::shape::{Cone, Cuboid, Disk, Plane, Quad, ShapeId, Sphere, Triangle};

/// Words for objects, groups and transforms included.
const OBJECTS: [&str; 11] = [
    "Box",
    "Cone",
    "Cylinder",
    "Disk",
    "Group",
    "Plane",
    "Quad",
    "Sphere",
    "Transform",
    "Triangle",
    "TriangleMesh",
];
const LATER: [&str; 8] =
    ["Blob", "Difference", "HeightField", "Intersection", "Isosurface", "Quartic", "Torus", "Union"];

/// The running state of a walk through groups.
#[derive(Default)]
struct Walk {
    /// Set by `MaterialIndex`; stays in force after the group it stands in, as in the classic format.
    material: Option<MaterialId>,
    /// A `MaterialIndex` was wrong, which has been reported: objects without a material are no news.
    material_failed: bool,
    /// The objects stand in a `Transform` without an inverse: they are read, but never hit.
    flattened: bool,
}

impl Compiler<'_> {
    /// Everything in the scene's group.
    pub(super) fn objects(&mut self, group: Item<'_>) {
        let mut walk = Walk::default();
        self.group(group, &DAffine3::IDENTITY, 0, &mut walk);
    }

    /// * `world`: the matrix around the group; `place`: the same as an index of the pool
    fn group(&mut self, group: Item<'_>, world: &DAffine3, place: u32, walk: &mut Walk) {
        let mut objects = 0;
        let mut count = None;
        for item in self.children(group) {
            match item.keyword() {
                "numObjects" => count = Some(item),
                word => {
                    // A misspelt object was meant to be one.
                    objects += usize::from(OBJECTS.contains(&word) || item.has_block());
                    self.object(item, group.keyword(), world, place, walk);
                }
            }
        }
        self.check_count("numObjects", count, objects, "object");
    }

    fn object(&mut self, item: Item<'_>, parent: &str, world: &DAffine3, place: u32, walk: &mut Walk) {
        match item.keyword() {
            "Group" => self.group(item, world, place, walk),
            "MaterialIndex" => {
                let reference = Args::read(item, self.diagnostics, Reference::read);
                let material = reference.and_then(|reference| self.material(&reference));
                walk.material_failed |= material.is_none();
                walk.material = material.or(walk.material);
            }
            "Transform" => self.transform(item, world, walk),
            word if OBJECTS.contains(&word) => self.primitive(item, place, walk),
            word if LATER.contains(&word) => self.diagnostics.push(not_supported_yet(item)),
            _ => {
                let allowed = OBJECTS.into_iter().chain(["MaterialIndex", "numObjects"]);
                self.diagnostics.push(unknown_word(item, Some(parent), allowed));
            }
        }
    }

    fn transform(&mut self, item: Item<'_>, world: &DAffine3, walk: &mut Walk) {
        let mut local = DAffine3::IDENTITY;
        let mut flattens = false;
        let mut objects = Vec::new();
        for child in self.children(item) {
            if !transform::OPERATIONS.contains(&child.keyword()) {
                objects.push(child);
            } else if objects.is_empty() {
                local = transform::apply(local, child, self.rules.matrix_by_rows, self.diagnostics);
                // Rounding in a later product could hide that there is no inverse.
                flattens |= local.matrix3.determinant() == 0.0;
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
        let world = *world * local;
        let transform = Transform::new(&world).filter(|_| !flattens && !walk.flattened);
        if transform.is_none() && !walk.flattened {
            let warning =
                Diagnostic::warning("this `Transform` has no inverse, so what it holds cannot be seen");
            self.diagnostics.push(warning.label(item.keyword_span(), "flattens its object"));
        }
        let flattened_around = std::mem::replace(&mut walk.flattened, transform.is_none());
        let mut place = 0;
        if let Some(transform) = transform.filter(|transform| !transform.is_identity()) {
            place = self.transforms.len() as u32;
            self.transforms.push(transform);
        }
        for object in objects {
            self.object(object, item.keyword(), &world, place, walk);
        }
        walk.flattened = flattened_around;
    }

    fn primitive(&mut self, item: Item<'_>, place: u32, walk: &Walk) {
        let mut place = place;
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
            "Triangle" => ("Triangle", self.triangle(item, &mut place)),
            _ => ("TriangleMesh", self.mesh(item)),
        };
        let Some(material) = walk.material else {
            let materials_failed = self.diagnostics.has_errors() && self.material_list.is_empty();
            if walk.material_failed || materials_failed {
                return;
            }
            let error = Diagnostic::error(format!("`{keyword}` has no material"));
            let help = "write `MaterialIndex 0`, or the name of a material, before it";
            self.diagnostics
                .push(error.label(item.keyword_span(), "no `MaterialIndex` before this").help(help));
            return;
        };
        let Some(shape) = shape.filter(|_| !walk.flattened) else { return };
        let brings_own = keyword == "TriangleMesh" && self.slots_transmit();
        let transmits = brings_own || self.materials.may_transmit(material, &self.materials);
        self.primitives.push(Primitive { shape, transform: place, material, transmits });
        self.objects.push(Object { name: item.word().map(|word| word.text().into_owned()), keyword });
    }

    /// A single triangle, taken to world space at once: no ray is ever transformed for it.
    fn triangle(&mut self, item: Item<'_>, place: &mut u32) -> Option<ShapeId> {
        let mut triangle = self.read(item, read_triangle)?;
        if triangle.is_degenerate() {
            let warning = Diagnostic::warning("this triangle has no area and is left out");
            self.diagnostics.push(warning.label(item.keyword_span(), "its corners lie on a line"));
            return None;
        }
        let transform = self.transforms[std::mem::take(place) as usize];
        if !transform.is_identity() {
            triangle.vertices = triangle.vertices.map(|v| transform.point(v));
            if transform.mirrors() {
                // The normal keeps its side of the surface: the order of the corners turns round.
                triangle.vertices.swap(1, 2);
                triangle.uvs.swap(1, 2);
            }
        }
        self.shape(item, triangle)
    }

    /// Whether light may pass through any material that came with a mesh.
    fn slots_transmit(&self) -> bool {
        self.slot_materials.iter().any(|&id| self.materials.may_transmit(id, &self.materials))
    }

    /// The items in a block; an item without a block is reported.
    fn children<'t>(&mut self, item: Item<'t>) -> Vec<Item<'t>> {
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
