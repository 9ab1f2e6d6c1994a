//! Media that bodies and the air are filled with.

use super::{SceneBuilder, SceneError, check_finite};
use crate::medium::{AnyMedium, Media, MediumId};

impl SceneBuilder {
    /// Adds a medium, which materials can name as what their bodies are filled with.
    ///
    /// # Errors
    /// [`SceneError::NotFinite`], [`SceneError::UnknownTexture`], [`SceneError::TooMany`].
    pub fn medium(&mut self, medium: impl Into<AnyMedium>) -> Result<MediumId, SceneError> {
        let medium = medium.into();
        let name = medium.name();
        check_finite(medium.is_finite(), name)?;
        self.check_textures(medium.textures(), name)?;
        medium.store(&mut self.appearance.media).ok_or(SceneError::TooMany(name))
    }

    /// Fills the air with a medium: all that is outside of bodies.
    ///
    /// # Errors
    /// [`SceneError::UnknownMedium`], [`SceneError::CurvedAir`], [`SceneError::EndlessEmission`].
    pub fn air(&mut self, medium: MediumId) -> Result<(), SceneError> {
        self.check_medium(medium)?;
        if self.appearance.media.bends_light(medium) {
            return Err(SceneError::CurvedAir);
        }
        let media = &self.appearance.media;
        if media.bounds(medium).is_none() && media.coefficients(medium).emits_without_extinction() {
            return Err(SceneError::EndlessEmission);
        }
        self.air = Some(medium);
        Ok(())
    }

    /// All media so far.
    pub(crate) fn media(&self) -> &Media {
        &self.appearance.media
    }

    pub(super) fn check_medium(&self, medium: MediumId) -> Result<(), SceneError> {
        self.appearance.media.contains(medium).then_some(()).ok_or(SceneError::UnknownMedium(medium))
    }
}
