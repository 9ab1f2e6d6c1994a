//! Points and lines of models, as spheres and tubes.

use std::collections::{BTreeSet, HashMap};

use kajo_math::Vec3;
use kajo_scene::{Item, ModelMaterial, ModelPart, VertexColors};

use super::Compiler;
use super::model_material::ModelPictures;
use crate::material::MaterialId;
use crate::shape::{Cone, ShapeId, Sphere};

/// Levels that a channel of a colour may have: each colour is a material of its own.
const LEVELS: f32 = 31.0;

/// How thick points and lines are; those without a radius are left out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct BeadRadii {
    pub points: Option<f32>,
    pub lines: Option<f32>,
}

/// A part of a mesh: the shape and its material.
pub(super) type Stored = (ShapeId, Option<MaterialId>);

/// Materials of points by those of their parts and by their colours, in levels.
pub(super) type BeadMaterials = HashMap<(Option<usize>, [u8; 3]), Option<MaterialId>>;

impl Compiler<'_> {
    /// The spheres and tubes of a part.
    ///
    /// * `material`: of the part, and what the file says of it
    pub(super) fn beads(
        &mut self,
        part: &ModelPart,
        radii: BeadRadii,
        material: Option<(MaterialId, &ModelMaterial)>,
        known: &mut BeadMaterials,
        (pictures, item): (&ModelPictures<'_>, Item<'_>),
    ) -> Option<Vec<Stored>> {
        let points = radii.points.map_or(&[][..], |_| &part.points);
        let segments = radii.lines.map_or(&[][..], |_| &part.segments);
        let ends: BTreeSet<u32> = segments.iter().flatten().copied().collect();
        if !self.has_room(points.len() + segments.len() + ends.len(), item.head_span(), 0) {
            return None;
        }
        let place = |v: u32| Vec3::from(part.mesh.positions[v as usize]);
        let spheres = points.iter().map(|&v| (v, radii.points));
        let joints = ends.iter().map(|&v| (v, radii.lines));
        let mut stored = Vec::with_capacity(points.len() + segments.len() + ends.len());
        for (v, radius) in spheres.chain(joints) {
            let shape = self.shape(item, Sphere::new(place(v), radius.unwrap_or_default()))?;
            stored.push((shape, self.bead_material(part, v, material, known, pictures)));
        }
        for &[a, b] in segments {
            let radius = radii.lines.unwrap_or_default();
            // Two ends at one place are one sphere.
            let Some(tube) = Cone::new(place(a), place(b), radius, radius, false) else { continue };
            let shape = self.shape(item, tube)?;
            stored.push((shape, self.bead_material(part, a, material, known, pictures)));
        }
        Some(stored)
    }

    /// The material at a vertex.
    fn bead_material(
        &mut self,
        part: &ModelPart,
        vertex: u32,
        material: Option<(MaterialId, &ModelMaterial)>,
        known: &mut BeadMaterials,
        pictures: &ModelPictures<'_>,
    ) -> Option<MaterialId> {
        let (plain, said) = material?;
        let Some(&[r, g, b, _]) = part.mesh.colors.get(vertex as usize) else { return Some(plain) };
        // Levels are even to the eye, about.
        let levels = [r, g, b].map(|c| (c.sqrt() * LEVELS).round() as u8);
        *known.entry((part.material, levels)).or_insert_with(|| {
            let shown = levels.map(|level| (f32::from(level) / LEVELS) * (f32::from(level) / LEVELS));
            let base_color = std::array::from_fn(|c| said.base_color[c] * shown[c]);
            let colored = ModelMaterial { base_color, vertex_colors: VertexColors::None, ..said.clone() };
            self.model_material(&colored, pictures)
        })
    }
}
