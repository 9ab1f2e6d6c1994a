//! Materials and what they are made of.

use std::collections::HashMap;

use super::{SceneBuilder, SceneError, check_finite};
use crate::emission::SurfaceEmission;
use crate::ids::MaterialSlot;
use crate::light::LightGroups;
use crate::material::{AnyMaterial, Appearance, MaterialId, Perforated};
use crate::medium::VelocityGrid;
use crate::texture::{
    AnyColorNode, AnyFloatNode, AnyTexture, Channel, ColorTexture, FloatTexture, NamedTexture,
    PictureChannel, PictureMap, Textures,
};

impl SceneBuilder {
    /// Adds a number that differs from place to place: a channel of a picture, or a pattern.
    ///
    /// # Errors
    /// [`SceneError::NotFinite`], [`SceneError::UnknownTexture`], [`SceneError::TooMany`].
    pub fn float_texture(&mut self, node: impl Into<AnyFloatNode>) -> Result<FloatTexture, SceneError> {
        let node = node.into();
        let name = node.name();
        check_finite(node.is_finite(), name)?;
        self.check_textures(node.parts(), name)?;
        self.appearance.textures.float(node).ok_or(SceneError::TooMany(name))
    }

    /// Adds a colour that differs from place to place: a picture, or what is made of other textures.
    ///
    /// # Errors
    /// [`SceneError::NotFinite`], [`SceneError::UnknownTexture`], [`SceneError::TooMany`].
    pub fn color_texture(&mut self, node: impl Into<AnyColorNode>) -> Result<ColorTexture, SceneError> {
        let node = node.into();
        let name = node.name();
        check_finite(node.is_finite(), name)?;
        self.check_textures(node.parts(), name)?;
        self.appearance.textures.color(node).ok_or(SceneError::TooMany(name))
    }

    /// Adds a material, which has the next number in the id layers.
    ///
    /// One that is made of others gives the light of these, as far as it shows them.
    ///
    /// # Errors
    /// [`SceneError::NotFinite`], [`SceneError::UnknownMaterial`], [`SceneError::UnknownTexture`],
    /// [`SceneError::UnknownMedium`], [`SceneError::CurvedInside`], [`SceneError::TooMany`].
    pub fn material(&mut self, material: impl Into<AnyMaterial>) -> Result<MaterialId, SceneError> {
        let id = self.store_material(material)?;
        self.list_material(id, None);
        Ok(id)
    }

    /// As [`SceneBuilder::material`], of surfaces that give light: each object that has it becomes a light.
    ///
    /// # Errors
    /// As [`SceneBuilder::material`]; [`SceneError::UnknownLightGroup`].
    pub fn emissive_material(
        &mut self,
        material: impl Into<AnyMaterial>,
        emission: SurfaceEmission,
    ) -> Result<MaterialId, SceneError> {
        check_finite(emission.is_finite(), "SurfaceEmission")?;
        self.check_textures(emission.textures(), "SurfaceEmission")?;
        self.check_group(emission.group)?;
        let id = self.material(material)?;
        self.set_emission(id, emission);
        Ok(id)
    }

    /// Gives a name to a material, by which programs show it.
    ///
    /// # Errors
    /// [`SceneError::UnknownMaterial`].
    pub fn name_material(&mut self, material: MaterialId, name: &str) -> Result<(), SceneError> {
        let listed = self.appearance.list.iter_mut().find(|(id, _)| *id == material);
        let (_, own) = listed.ok_or(SceneError::UnknownMaterial(material))?;
        *own = Some(name.to_owned());
        Ok(())
    }

    /// The slot by which triangles of meshes name a material; see [`crate::shape::MeshData::material_slots`].
    ///
    /// # Errors
    /// [`SceneError::UnknownMaterial`], [`SceneError::TooMany`].
    pub fn mesh_material(&mut self, material: MaterialId) -> Result<MaterialSlot, SceneError> {
        self.check_material(material)?;
        let slot = MaterialSlot::new(self.appearance.slots.len());
        self.appearance.slots.push(material);
        slot.ok_or(SceneError::TooMany("Mesh"))
    }

    /// A material that lets be seen what is behind it where the colours of a mesh have opacities less than 1; the material itself
    /// where light passes it anyway.
    ///
    /// # Errors
    /// [`SceneError::UnknownMaterial`], [`SceneError::TooMany`].
    pub fn see_through(&mut self, material: MaterialId) -> Result<MaterialId, SceneError> {
        self.check_material(material)?;
        if self.appearance.may_transmit(material) {
            return Ok(material);
        }
        if let Some(&known) = self.see_through.get(&material) {
            return Ok(known);
        }
        let white = PictureChannel { map: PictureMap::white(), channel: Channel::Alpha };
        let opacity = self.float_texture(white)?;
        let id = self.store_material(Perforated { material, opacity })?;
        self.see_through.insert(material, id);
        Ok(id)
    }

    /// Adds a material that has no number in the id layers.
    pub(crate) fn store_material(
        &mut self,
        material: impl Into<AnyMaterial>,
    ) -> Result<MaterialId, SceneError> {
        let material = material.into();
        let name = material.name();
        check_finite(material.is_finite(), name)?;
        material.parts().iter().try_for_each(|&part| self.check_material(part))?;
        self.check_textures(material.textures(), name)?;
        if let Some(medium) = material.medium() {
            self.check_medium(medium)?;
            if !material.may_bend_light() && self.appearance.media.bends_light(medium) {
                return Err(SceneError::CurvedInside(name));
            }
        }
        let id = material.store(&mut self.appearance.materials).ok_or(SceneError::TooMany(name))?;
        let of_part = |part| self.emissions.get(&part).cloned().unwrap_or_default();
        let Appearance { materials, textures, .. } = &mut self.appearance;
        let emission = materials.emission(id, &of_part, textures).ok_or(SceneError::TooMany(name))?;
        self.set_emission(id, emission);
        Ok(id)
    }

    /// Gives a material its number in the id layers, the next one.
    pub(crate) fn list_material(&mut self, material: MaterialId, name: Option<String>) {
        self.appearance.list.push((material, name));
    }

    /// Keeps the textures that have names, to be looked up by these.
    pub(crate) fn name_textures(&mut self, named: HashMap<String, NamedTexture>) {
        self.appearance.named_textures = named;
    }

    /// Makes surfaces of a material give light; before others are made of it.
    pub(crate) fn set_emission(&mut self, material: MaterialId, emission: SurfaceEmission) {
        if !emission.is_black() {
            self.emissions.insert(material, emission);
        }
    }

    /// Whether surfaces of a material give light.
    pub(crate) fn is_emissive(&self, material: MaterialId) -> bool {
        self.emissions.contains_key(&material)
    }

    /// The light of surfaces of a material.
    pub(crate) fn emission(&self, material: MaterialId) -> Option<&SurfaceEmission> {
        self.emissions.get(&material)
    }

    /// Materials and patterns so far.
    pub fn appearance(&self) -> &Appearance {
        &self.appearance
    }

    /// Refuses textures of another scene, and constants of `what` that are not finite.
    pub(super) fn check_textures<'a>(
        &self,
        textures: impl IntoIterator<Item = AnyTexture<'a>>,
        what: &'static str,
    ) -> Result<(), SceneError> {
        textures.into_iter().try_for_each(|texture| {
            check_finite(texture.is_finite(), what)?;
            let is_known = texture.is_known(&self.appearance.textures);
            is_known.then_some(()).ok_or(SceneError::UnknownTexture)
        })
    }

    /// The textures so far.
    pub(crate) fn textures(&self) -> &Textures {
        &self.appearance.textures
    }

    /// Textures, for readers of pictures and patterns, and names of groups.
    pub(crate) fn textures_and_groups(&mut self) -> (&mut Textures, &mut LightGroups) {
        (&mut self.appearance.textures, &mut self.light_groups)
    }

    pub(super) fn check_material(&self, material: MaterialId) -> Result<(), SceneError> {
        let known = self.appearance.materials.contains(material);
        known.then_some(()).ok_or(SceneError::UnknownMaterial(material))
    }

    /// What is to be known of all materials together.
    pub(super) fn finish_appearance(&mut self) {
        let appearance = &mut self.appearance;
        let numbers = appearance.list.iter().enumerate().map(|(i, &(id, _))| (id, i as u32 + 1));
        appearance.numbers = numbers.rev().collect();
        for (plain, seen) in &self.see_through {
            let number = appearance.numbers.get(plain).copied();
            appearance.numbers.extend(number.map(|number| (*seen, number)));
        }
        appearance.has_pictures = appearance.materials.ids().any(|id| appearance.needs_uv(id));
        let mut materials = appearance.materials.ids();
        appearance.has_filters = appearance.textures.wants_footprint()
            || materials.any(|id| appearance.materials.wants_footprint(id));
        appearance.has_passages = appearance.materials.ids().any(|id| appearance.has_passages(id));
        appearance.has_media = appearance.materials.ids().any(|id| appearance.has_medium(id));
        appearance.has_subsurface =
            appearance.media.ids().any(|id| appearance.media.coefficients(id).is_subsurface());
        let mut velocities = appearance.media.ids().filter_map(|id| appearance.media.velocities(id));
        appearance.has_moving_media = velocities.any(VelocityGrid::moves);
        appearance.bends_light = appearance.materials.ids().any(|id| appearance.bends_light(id));
        appearance.has_orientations = appearance.materials.ids().any(|id| appearance.is_oriented(id));
    }
}
