//! A scene as triangles and lines, for a picture that a graphics card draws while one moves about.
//!
//! Shapes become triangles in world space, in one mesh. Meshes stay what they are and are drawn where each
//! of their instances stands; spheres are instances of one unit sphere, so that a thousand of them are a thousand
//! matrices. Infinite planes become squares that reach to the horizon. Lights, the scene's own camera and what
//! set operations take away are drawn in lines. What moves is shown where it is when the shutter opens.
//!
//! Nested instances, of which there may be more than can be drawn, are shown from the largest to the smallest as
//! long as that takes not too many triangles, and as boxes from there on: [`Preview::has_boxes`] says so.
//!
//! Every vertex and every instance has an object number, and their sum is the number of the id layers, counted from 1.

mod atlas;
mod chart;
mod color;
mod lines;
mod traced;

use std::collections::HashMap;
use std::sync::Arc;

use kajo_core::material::MaterialId;
use kajo_core::scene::Scene;
use kajo_core::shape::{Mesh, Plane, ShapeId, Sphere, Surface, Tessellation};
use kajo_core::{ElementContent, NestedElement, ObjectId, Pooled};
use kajo_math::{Aabb, Affine3A, Transform, Vec3};

use chart::{Chart, Plan};

pub(crate) use color::in_context as color_at;

pub use atlas::Atlas;
pub use lines::{Line, LineKind};
pub use traced::TracedPreview;

/// Triangles of all curved surfaces together, about.
const CURVED_TRIANGLES: u32 = 200_000;

/// The same where they would not look round otherwise.
const MOST_CURVED_TRIANGLES: u32 = 1_000_000;

/// Segments of a full circle that look round from afar.
const ROUND: f64 = 8.0;

/// Triangles of all nested instances together, about.
const NESTED_TRIANGLES: usize = 400_000;

/// Fewest and most segments of a full circle.
const AROUND: [u32; 2] = [4, 64];

/// Triangles that show textures, at most: the others have one colour.
const TEXTURED_TRIANGLES: usize = 400_000;

/// Texels of all textures together, and of those of an object, about.
const TEXELS: u32 = 1 << 21;
const TEXELS_OF_AN_OBJECT: u32 = 1 << 18;

/// How far the frames around the square of a plane reach, in sizes of that square. Each is so many times as large as the
/// one before that numbers of single precision tell its corners from those of the triangles near the camera.
const FRAMES: [f64; 5] = [1.0, 8.0, 64.0, 512.0, 4096.0];

/// The same where textures are shown, whose texels are the larger the farther away they are.
const TEXTURED_FRAMES: [f64; 9] = [0.125, 0.25, 0.5, 1.0, 2.0, 8.0, 64.0, 512.0, 4096.0];

/// Within this part of the square of a plane the texels of its textures are the smallest.
const NEAR: f32 = 0.25;

/// A corner of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Vertex {
    /// Position in the space of the mesh.
    pub position: [f32; 3],
    /// Unit normal there; zero where each triangle has its own, `normalize(cross(dpdx, dpdy))` in a shader.
    pub normal: [f32; 3],
    /// Colour, encoded in sRGB, and 255.
    pub color: [u8; 4],
    /// What is added to the object number of the instance.
    pub object: u32,
}

/// Triangles that are drawn once for each instance.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PreviewMesh {
    /// Vertices.
    pub vertices: Vec<Vertex>,
    /// Three indices of vertices for each triangle.
    pub indices: Vec<u32>,
    /// Where each vertex is in [`Preview::atlas`], in texels from its left upper corner, and by whose colour that of the vertex is
    /// multiplied there; empty where there are no textures.
    pub texels: Vec<[f32; 2]>,
}

/// A mesh at its place in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PreviewInstance {
    /// Index into [`Preview::meshes`].
    pub mesh: u32,
    /// World space from the space of the mesh.
    pub world_from_mesh: Affine3A,
    /// Colour by which that of the vertices is multiplied, encoded in sRGB, and 255.
    pub color: [u8; 4],
    /// What is added to the object number of the vertices.
    pub object: u32,
}

/// Everything that a raster picture of a scene needs.
#[derive(Clone, Debug, PartialEq)]
pub struct Preview {
    /// Triangles.
    pub meshes: Vec<PreviewMesh>,
    /// Where they stand; sorted by mesh.
    pub instances: Vec<PreviewInstance>,
    /// Lights, the scene's own camera, and what set operations take away.
    pub lines: Vec<Line>,
    /// A box around everything that has bounds; of unit size around the origin when nothing has.
    pub bounds: Aabb,
    /// Whether boxes stand for nested instances of which there are too many. What is picked is not what is drawn then, and
    /// a [`TracedPreview`] shows what is.
    pub has_boxes: bool,
    /// The textures of surfaces that show any, coarse; [`Atlas::refined`] makes a finer one. `None` where none does.
    pub atlas: Option<Arc<Atlas>>,
}

impl Preview {
    /// The preview of a scene.
    pub fn of(scene: &Scene) -> Preview {
        let bounds = extent(scene);
        let mut builder = Builder::new(scene, bounds);
        for (index, primitive) in (0..).zip(&scene.geometry.primitives) {
            let object = ObjectId::from_index(index);
            let Some(transform) = scene.snapshot_transform(object, 0.0) else { continue };
            builder.add(object.number(), primitive.shape, &transform, primitive.material);
        }
        for element in scene.geometry.nested_elements(|shape| builder.cost(shape), NESTED_TRIANGLES) {
            builder.add_element(&element);
        }
        let lines = lines::of(scene, &bounds);
        builder.finish(lines)
    }

    /// Triangles drawn, instances counted as often as they stand.
    pub fn triangle_count(&self) -> u64 {
        self.instances.iter().map(|i| self.meshes[i.mesh as usize].indices.len() as u64 / 3).sum()
    }
}

/// A box around what has bounds, never empty.
fn extent(scene: &Scene) -> Aabb {
    let bounds = scene.geometry.bounds();
    if bounds.is_empty() { Aabb { min: Vec3::splat(-1.0), max: Vec3::ONE } } else { bounds }
}

/// A preview in the making.
struct Builder<'a> {
    scene: &'a Scene,
    bounds: Aabb,
    around: u32,
    /// All that is drawn once, in world space.
    single: PreviewMesh,
    unit_sphere: Option<u32>,
    unit_cube: Option<u32>,
    has_boxes: bool,
    /// The pieces of a mesh that have a material in common, and that material where the mesh brings it.
    parts: HashMap<ShapeId, Vec<(u32, Option<MaterialId>)>>,
    meshes: Vec<PreviewMesh>,
    instances: Vec<PreviewInstance>,
    /// What shows textures, and how many triangles that is.
    charts: Vec<Chart>,
    textured_triangles: usize,
    /// Shapes with textures of their own, and without.
    brings_textures: HashMap<ShapeId, bool>,
}

impl<'a> Builder<'a> {
    fn new(scene: &'a Scene, bounds: Aabb) -> Builder<'a> {
        let curved =
            scene.geometry.primitives.iter().filter(|p| scene.geometry.shapes.is_curved(p.shape)).count()
                as u64;
        let curved = curved + scene.geometry.object_count() - scene.geometry.primitives.len() as u64;
        // A sphere has as many triangles as the square of the segments around it.
        let around = |triangles: u32| (f64::from(triangles) / curved.max(1) as f64).sqrt();
        let around = around(CURVED_TRIANGLES).max(around(MOST_CURVED_TRIANGLES).min(ROUND));
        let around = (around as u32).clamp(AROUND[0], AROUND[1]) & !1;
        Builder {
            scene,
            bounds,
            around,
            single: PreviewMesh::default(),
            unit_sphere: None,
            unit_cube: None,
            has_boxes: false,
            parts: HashMap::new(),
            meshes: Vec::new(),
            instances: Vec::new(),
            charts: Vec::new(),
            textured_triangles: 0,
            brings_textures: HashMap::new(),
        }
    }

    /// Triangles that a shape takes.
    fn cost(&self, id: ShapeId) -> usize {
        let shapes = &self.scene.geometry.shapes;
        let else_about = if shapes.is_curved(id) { (self.around * self.around) as usize } else { 12 };
        Mesh::find(shapes, id).map_or(else_about, Mesh::triangle_count)
    }

    fn add(&mut self, object: u32, id: ShapeId, transform: &Transform, material: MaterialId) {
        let scene = self.scene;
        if self.add_textured(object, id, transform, material) {
            return;
        }
        let world_from_object = transform.world_from_object;
        if let Some(sphere) = Sphere::find(&scene.geometry.shapes, id) {
            let mesh = self.unit_sphere();
            let sized = Affine3A::from_scale(Vec3::splat(sphere.radius));
            let sphere = Affine3A::from_translation(sphere.center) * sized;
            self.instance(mesh, object, world_from_object * sphere, material);
        } else if let Some(mesh) = Mesh::find(&scene.geometry.shapes, id) {
            for (part, own) in self.material_parts(id, mesh) {
                self.instance(part, object, world_from_object, own.unwrap_or(material));
            }
        } else {
            let (triangles, _) = self.tessellated(id, transform, &FRAMES);
            let own = |part: u32| scene.geometry.shapes.material_slot(id, part);
            let of_part = |part: u32| own(part).map_or(material, |slot| scene.appearance.slots[slot.index()]);
            self.add_single(object, of_part, transform, &triangles);
        }
    }

    /// The triangles of a shape, and of a plane what [`Builder::square`] returns.
    ///
    /// * `frames`: of planes; see [`FRAMES`]
    fn tessellated(
        &self,
        id: ShapeId,
        transform: &Transform,
        frames: &[f64],
    ) -> (Tessellation, Option<(Vec3, f32)>) {
        let shapes = &self.scene.geometry.shapes;
        let mut triangles = Tessellation::default();
        let near = match Plane::find(shapes, id) {
            Some(plane) => self.square(plane, transform, frames, &mut triangles),
            None => {
                shapes.tessellate(id, self.around, &mut triangles);
                None
            }
        };
        (triangles, near)
    }

    /// Adds an object whose surfaces show textures, if they do and there are not too many of them; whether it was added.
    fn add_textured(
        &mut self,
        object: u32,
        id: ShapeId,
        transform: &Transform,
        material: MaterialId,
    ) -> bool {
        let shows_textures = self.scene.appearance.varies(material) || self.brings_textures(id);
        let Some(object) = ObjectId::from_number(object).filter(|_| shows_textures) else { return false };
        if self.textured_triangles + self.cost(id) > TEXTURED_TRIANGLES {
            return false;
        }
        let (triangles, near) = self.tessellated(id, transform, &TEXTURED_FRAMES);
        self.textured_triangles += triangles.faces.len();
        self.charts.push(Chart { object, world_from_object: *transform, triangles, near });
        true
    }

    /// Whether a shape has colours at its corners, or parts with textures of their own.
    fn brings_textures(&mut self, id: ShapeId) -> bool {
        let (shapes, appearance) = (&self.scene.geometry.shapes, &self.scene.appearance);
        *self.brings_textures.entry(id).or_insert_with(|| {
            let own = |part: u32| shapes.material_slot(id, part).map(|slot| appearance.slots[slot.index()]);
            let varies = |part: u32| own(part).is_some_and(|material| appearance.varies(material));
            shapes.has_colors(id) || (0..shapes.part_count(id)).any(varies)
        })
    }

    fn add_element(&mut self, element: &NestedElement) {
        let object = element.object.number();
        match element.content {
            ElementContent::Shape(shape) => {
                self.add(object, shape, &element.world_from_object, element.material)
            }
            ElementContent::Whole(bounds) => {
                self.has_boxes = true;
                let sized = Affine3A::from_scale(0.5 * bounds.extent());
                let from_cube = Affine3A::from_translation(bounds.center()) * sized;
                let mesh = self.unit_cube();
                self.instance(
                    mesh,
                    object,
                    element.world_from_object.world_from_object * from_cube,
                    element.material,
                );
            }
        }
    }

    /// The mesh of the cube from -1 to 1.
    fn unit_cube(&mut self) -> u32 {
        if let Some(known) = self.unit_cube {
            return known;
        }
        let corner = |i: u32| Vertex {
            position: [0, 1, 2].map(|axis| if i >> axis & 1 == 1 { 1.0 } else { -1.0 }),
            normal: [0.0; 3],
            color: [255; 4],
            object: 0,
        };
        // The corners of a side go around it: those of axis 0 have bit 0 in common, and so on.
        let side = |axis: u32, high: u32| {
            let [a, b] = [1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3)];
            let low = high << axis;
            [low, low | a, low | a | b, low, low | a | b, low | b]
        };
        let indices = (0..3).flat_map(|axis| [side(axis, 0), side(axis, 1)]).flatten().collect();
        let mesh =
            self.push(PreviewMesh { vertices: (0..8).map(corner).collect(), indices, texels: Vec::new() });
        *self.unit_cube.insert(mesh)
    }

    /// The mesh of the unit sphere.
    fn unit_sphere(&mut self) -> u32 {
        if let Some(known) = self.unit_sphere {
            return known;
        }
        let mut triangles = Tessellation::default();
        Sphere::new(Vec3::ZERO, 1.0).tessellate(self.around, &mut triangles);
        let indices = triangles.faces.as_flattened().to_vec();
        let mesh =
            self.push(PreviewMesh { vertices: white_vertices(&triangles), indices, texels: Vec::new() });
        *self.unit_sphere.insert(mesh)
    }

    /// The meshes of a mesh: one, or one for each material that it brings.
    fn material_parts(&mut self, id: ShapeId, mesh: &Mesh) -> Vec<(u32, Option<MaterialId>)> {
        if let Some(known) = self.parts.get(&id) {
            return known.clone();
        }
        let mut triangles = Tessellation::default();
        mesh.tessellate(self.around, &mut triangles);
        let vertices = white_vertices(&triangles);
        let own = |part: u32| mesh.material_slot(part).map(|slot| self.scene.appearance.slots[slot.index()]);
        let mut by_material: HashMap<Option<MaterialId>, Vec<u32>> = HashMap::new();
        let mut materials = Vec::new();
        for (face, &part) in triangles.faces.iter().zip(&triangles.parts) {
            let material = own(part);
            let indices = by_material.entry(material).or_insert_with(|| {
                materials.push(material);
                Vec::new()
            });
            indices.extend(face);
        }
        let mut parts = Vec::with_capacity(materials.len());
        for material in materials {
            let indices = by_material.remove(&material).unwrap_or_default();
            let part = PreviewMesh { vertices: vertices.clone(), indices, texels: Vec::new() };
            parts.push((self.push(if material.is_none() { part } else { compact(part) }), material));
        }
        self.parts.insert(id, parts.clone());
        parts
    }

    fn push(&mut self, mesh: PreviewMesh) -> u32 {
        self.meshes.push(mesh);
        self.meshes.len() as u32 - 1
    }

    fn instance(&mut self, mesh: u32, object: u32, world_from_mesh: Affine3A, material: MaterialId) {
        let middle = Vec3::from(world_from_mesh.translation);
        let color = color::of(self.scene, material, middle);
        self.instances.push(PreviewInstance { mesh, world_from_mesh, color, object });
    }

    /// Adds triangles at their place in the world.
    ///
    /// * `material`: of each part
    fn add_single(
        &mut self,
        object: u32,
        material: impl Fn(u32) -> MaterialId,
        to: &Transform,
        triangles: &Tessellation,
    ) {
        let points: Vec<Vec3> = triangles.positions.iter().map(|&p| to.point(p)).collect();
        let middle = Aabb::around(points.iter().copied()).center();
        let mut colors: HashMap<MaterialId, [u8; 4]> = HashMap::new();
        let mut color_of = |part: u32| {
            let material = material(part);
            *colors.entry(material).or_insert_with(|| color::of(self.scene, material, middle))
        };
        // Corners are shared within a part at most.
        let mut of_vertices = vec![[255; 4]; points.len()];
        for (face, &part) in triangles.faces.iter().zip(&triangles.parts) {
            let color = color_of(part);
            face.iter().for_each(|&i| of_vertices[i as usize] = color);
        }
        let base = self.single.vertices.len() as u32;
        let vertices = points.iter().zip(&triangles.normals).zip(of_vertices);
        self.single.vertices.extend(vertices.map(|((p, &n), color)| Vertex {
            position: p.to_array(),
            normal: to.normal(n).to_array(),
            color,
            object,
        }));
        for &[a, b, c] in &triangles.faces {
            let face = if to.mirrors() { [a, c, b] } else { [a, b, c] };
            self.single.indices.extend(face.map(|i| base + i));
        }
    }

    /// A square of a plane, large enough to hold the scene's shadow on it and the camera's, and around it frames that go
    /// as far as one can see. Returns the middle and half the side of what is to be seen close.
    ///
    /// * `frames`: see [`FRAMES`]
    fn square(
        &self,
        plane: &Plane,
        to: &Transform,
        frames: &[f64],
        out: &mut Tessellation,
    ) -> Option<(Vec3, f32)> {
        let n = plane.normal();
        if n == Vec3::ZERO {
            return None;
        }
        let inverse = to.object_from_world;
        let onto = |p: Vec3| p - (n.dot(p) - plane.offset() as f32) * n;
        let near = Aabb::around([
            self.bounds.min,
            self.bounds.max,
            self.scene.output.camera.frame().center.as_vec3(),
        ])
        .transformed(&inverse);
        let center = onto(near.center());
        let (s, t) = kajo_math::warp::basis(n);
        let reach = 2.0 * near.extent().length().max((near.center() - center).length()).max(1.0);
        let [middle, s, t] = [center, reach * s, reach * t].map(Vec3::as_dvec3);
        let cells = 2 * frames.len() as u32 - 1;
        let along = |share: f64| {
            let line = (share * f64::from(cells)).round() as usize;
            match line.checked_sub(frames.len()) {
                Some(outward) => frames[outward],
                None => -frames[frames.len() - 1 - line],
            }
        };
        out.grid(0, [cells; 2], |x, y| (middle + along(x) * s + along(y) * t, n.as_dvec3()));
        Some((center, NEAR * reach))
    }

    /// Adds the triangles that show textures, and returns these.
    fn add_charts(&mut self) -> Option<Arc<Atlas>> {
        let charts = std::mem::take(&mut self.charts);
        let plan = Plan::new(charts, TEXELS, TEXELS_OF_AN_OBJECT);
        let mesh = plan.mesh();
        if mesh.indices.is_empty() {
            return None;
        }
        self.push_single(mesh);
        Some(Arc::new(Atlas::coarse(plan, self.scene)))
    }

    /// Adds a mesh in world space, whose vertices know their objects.
    fn push_single(&mut self, mesh: PreviewMesh) {
        let mesh = self.push(mesh);
        let world_from_mesh = Affine3A::IDENTITY;
        self.instances.push(PreviewInstance { mesh, world_from_mesh, color: [255; 4], object: 0 });
    }

    fn finish(mut self, lines: Vec<Line>) -> Preview {
        if !self.single.indices.is_empty() {
            let single = std::mem::take(&mut self.single);
            self.push_single(single);
        }
        let atlas = self.add_charts();
        self.instances.sort_by_key(|instance| instance.mesh);
        let Builder { meshes, instances, bounds, has_boxes, .. } = self;
        Preview { meshes, instances, lines, bounds, has_boxes, atlas }
    }
}

fn white_vertices(triangles: &Tessellation) -> Vec<Vertex> {
    let vertex = |(p, n): (&Vec3, &Vec3)| Vertex {
        position: p.to_array(),
        normal: n.to_array(),
        color: [255; 4],
        object: 0,
    };
    triangles.positions.iter().zip(&triangles.normals).map(vertex).collect()
}

/// The same mesh without the vertices that it does not use.
fn compact(mesh: PreviewMesh) -> PreviewMesh {
    let mut places = vec![u32::MAX; mesh.vertices.len()];
    let mut vertices = Vec::new();
    let mut slot_of = |i: u32| {
        let slot = &mut places[i as usize];
        if *slot == u32::MAX {
            *slot = vertices.len() as u32;
            vertices.push(mesh.vertices[i as usize]);
        }
        *slot
    };
    let indices = mesh.indices.iter().map(|&i| slot_of(i)).collect();
    PreviewMesh { vertices, indices, texels: Vec::new() }
}

#[cfg(test)]
mod camera_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod texture_tests;
