//! What things look like: all materials of a scene, and the patterns that they use.

use std::collections::HashMap;

use kajo_color::{Spectrum, Wavelengths};
use kajo_math::Vec3;

use super::{MaterialId, Materials};
use crate::medium::{Media, MediumId};
use crate::texture::{NamedTexture, Textures};

/// Materials, and what they are made of: what any of them is asked in.
#[derive(Debug, Default)]
pub struct Appearance {
    /// Materials.
    pub materials: Materials,
    /// Patterns that materials use.
    pub textures: Textures,
    /// What bodies and the air are filled with.
    pub media: Media,
    /// Every material of the file, in its order, with its name. Number `i + 1` of the id layers is entry `i`.
    pub list: Vec<(MaterialId, Option<String>)>,
    /// The textures of the file that have names.
    pub named_textures: HashMap<String, NamedTexture>,
    /// Materials of mesh parts, by [`crate::shape::Surface::material_slot`].
    pub slots: Vec<MaterialId>,
    /// Whether any material shows a picture, so that it has to know surface coordinates.
    pub has_pictures: bool,
    /// Whether any material turns the frame in which it scatters, so that it has to be asked; see [`crate::Scene::shading`].
    pub has_orientations: bool,
    /// Whether light goes straight on through any material, so that what is behind is seen and lit through its holes or
    /// panes.
    pub has_passages: bool,
    /// Whether any texture asks for footprints, so that paths have to carry them; see [`Textures::wants_footprint`].
    pub has_filters: bool,
    /// Whether a body of any material is filled with a medium.
    pub has_media: bool,
    /// Whether a body of any material is filled with what light is scattered in many times; see
    /// [`crate::medium::Coefficients::is_subsurface`].
    pub has_subsurface: bool,
    /// Whether the matter of any medium moves while the shutter is open.
    pub has_moving_media: bool,
    /// Whether a body of any material bends light, so that paths within have to be followed along curves.
    pub bends_light: bool,
    pub(crate) numbers: HashMap<MaterialId, u32>,
}

impl Appearance {
    /// The number of a material in the id layers: its place in the file from 1 on; 0 for a material
    /// that came with a mesh.
    pub fn number(&self, material: MaterialId) -> u32 {
        self.numbers.get(&material).copied().unwrap_or(0)
    }

    /// Whether the classic reflection model of a material may differ from place to place, colours of meshes left out.
    ///
    /// Holes and reliefs change nothing of it, mixtures may.
    pub fn varies(&self, material: MaterialId) -> bool {
        if self.materials.constant(material).is_some() {
            return false;
        }
        let parts = self.materials.parts(material);
        parts.len() != 1 || self.varies(parts[0])
    }

    /// Whether any medium gives light.
    pub fn has_emissive_media(&self) -> bool {
        self.media.ids().any(|medium| self.media.coefficients(medium).emits())
    }

    /// The density of a medium at a world-space point, not negative; see [`crate::medium::Medium::density`].
    #[inline]
    pub fn density(&self, medium: MediumId, p: Vec3) -> f32 {
        self.media.density(medium, &self.textures, p)
    }

    /// The same for each wavelength; see [`crate::medium::Medium::spectral_density`].
    #[inline]
    pub fn spectral_density(&self, medium: MediumId, p: Vec3, wavelengths: &Wavelengths) -> Spectrum {
        self.media.spectral_density(medium, &self.textures, p, wavelengths)
    }
}
