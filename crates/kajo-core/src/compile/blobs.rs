//! `Blob`: its components with their materials, and the mixture of these.

use kajo_scene::{Diagnostic, Item};

use super::Compiler;
use super::graphics_state::{CurrentTransform, GraphicsState};
use super::material_draft::Reference;
use crate::material::{Blend, MaterialId};
use crate::shape::{Blob, BlobComponent, BlobKernel, MOST_MATERIALS};
use crate::texture::{SurfaceShare, UvSet};

/// A blob as it is written.
pub(super) struct BlobText<'t> {
    pub kernel: BlobKernel,
    /// Above zero.
    pub threshold: f64,
    pub components: Vec<ComponentText<'t>>,
}

/// A component as it is written.
pub(super) struct ComponentText<'t> {
    pub item: Item<'t>,
    /// With no material yet.
    pub shape: BlobComponent,
    pub material: Option<Reference<'t>>,
}

impl Compiler<'_> {
    /// Makes an object of a blob; `None` for one that could not be read, which was reported.
    pub(super) fn blob(
        &mut self,
        text: Option<BlobText<'_>>,
        item: Item<'_>,
        ctm: &mut CurrentTransform,
        state: &mut GraphicsState,
    ) {
        let Some(BlobText { kernel, threshold, components }) = text else {
            return self.put_shape(None, item, ctm, state);
        };
        let mixes = state.of_all.is_none() && components.iter().any(|component| component.material.is_some());
        let materials = if mixes { self.blob_materials(&components, item, state) } else { Some(Vec::new()) };
        let Some(materials) = materials else { return };
        let mixed = distinct(&materials);
        let number = |i: usize| {
            let own = materials.get(i).and_then(|own| mixed.iter().position(|other| other == own));
            own.unwrap_or(0)
        };
        let shapes = components.iter().enumerate();
        let shapes: Vec<BlobComponent> =
            shapes.map(|(i, component)| BlobComponent { material: number(i), ..component.shape }).collect();
        let shape = Blob::new(kernel, threshold, &shapes).and_then(|blob| self.shape(item, blob));
        if !mixes {
            return self.put_shape(shape, item, ctm, state);
        }
        let material = self.mixture(&mixed, item);
        self.put_made_of(material, shape, item, ctm, state);
    }

    /// The material of each component; `None` when a mistake was reported.
    fn blob_materials(
        &mut self,
        components: &[ComponentText<'_>],
        item: Item<'_>,
        state: &GraphicsState,
    ) -> Option<Vec<MaterialId>> {
        let mut materials: Vec<Option<MaterialId>> = Vec::with_capacity(components.len());
        for component in components {
            let takes_away = component.shape.strength < 0.0;
            materials.push(match &component.material {
                Some(_) if takes_away => {
                    let error = Diagnostic::error("what takes away from a blob has no material");
                    let error = error.label(component.item.head_span(), "has a `strength` below zero");
                    self.diagnostics.push(error.help("leave out `material`"));
                    None
                }
                Some(reference) => self.material(reference),
                // It has no share.
                None if takes_away => materials.first().copied().flatten().or(state.material),
                None if state.material.is_some() => state.material,
                None => {
                    if !state.material_failed {
                        let error = Diagnostic::error("this component has no material, and others have one");
                        let error = error.label(component.item.head_span(), "of what is it made?");
                        let help =
                            "write `material NAME` in its block, or `MaterialIndex NAME` before the `Blob`";
                        self.diagnostics.push(error.help(help));
                    }
                    None
                }
            });
        }
        let count = distinct(&materials.iter().copied().flatten().collect::<Vec<_>>()).len();
        if count > MOST_MATERIALS {
            let message = format!("the components of a blob have {MOST_MATERIALS} materials at most");
            let error = Diagnostic::error(message).label(item.head_span(), format!("has {count}"));
            self.diagnostics.push(error);
            return None;
        }
        materials.into_iter().collect()
    }

    /// A mixture of materials by the surface coordinates of a blob that has them in this order.
    fn mixture(&mut self, materials: &[MaterialId], item: Item<'_>) -> Option<MaterialId> {
        let span = item.head_span();
        let (&first, others) = materials.split_first()?;
        let mut mixed = first;
        for (i, &material) in others.iter().enumerate() {
            let set = if i < 2 { UvSet::First } else { UvSet::Second };
            let share = SurfaceShare { set, axis: i % 2, mean: 1.0 / (i as f32 + 2.0) };
            let amount = self.scene.float_texture(share);
            let amount = self.accepted(amount, span)?;
            mixed = self.store_material(Blend { amount, materials: [mixed, material] }, span)?;
        }
        self.has_memory_for_materials(span).then_some(mixed)
    }
}

/// Each once, in the order of the first of each.
fn distinct(materials: &[MaterialId]) -> Vec<MaterialId> {
    let mut found = Vec::new();
    for material in materials {
        if !found.contains(material) {
            found.push(*material);
        }
    }
    found
}
