//! What gives light of its own.

use kajo_color::Spectrum;

use super::{SceneBuilder, SceneError, check_finite};
use crate::background::Background;
use crate::ids::{LightGroup, LightIndex};
use crate::light::{AnyLight, LightGroupError};
use crate::medium::Fog;

impl SceneBuilder {
    /// Adds a light to those without a group.
    ///
    /// # Errors
    /// [`SceneError::NotFinite`], [`SceneError::OwnLight`], [`SceneError::TooMany`].
    pub fn light(&mut self, light: impl Into<AnyLight>) -> Result<LightIndex, SceneError> {
        self.light_in(LightGroup::default(), light)
    }

    /// Adds a light to a group.
    ///
    /// # Errors
    /// [`SceneError::NotFinite`], [`SceneError::OwnLight`], [`SceneError::UnknownLightGroup`], [`SceneError::TooMany`].
    pub fn light_in(
        &mut self,
        group: LightGroup,
        light: impl Into<AnyLight>,
    ) -> Result<LightIndex, SceneError> {
        let light = light.into();
        let name = light.name();
        if matches!(light, AnyLight::AreaLight(_) | AnyLight::SkyLight(_)) {
            return Err(SceneError::OwnLight(name));
        }
        check_finite(light.is_finite(), name)?;
        self.check_group(group)?;
        let index = LightIndex::new(self.light_list.len()).ok_or(SceneError::TooMany(name))?;
        let id = light.store(&mut self.lights).ok_or(SceneError::TooMany(name))?;
        self.light_list.push((id, group));
        self.frames.add_light(index);
        Ok(index)
    }

    /// A group of lights, whose light can be seen apart; the same one for the same name.
    ///
    /// # Errors
    /// [`SceneError::TooManyLightGroups`], [`SceneError::LightGroupName`].
    pub fn light_group(&mut self, name: &str) -> Result<LightGroup, SceneError> {
        self.light_groups.group(name).map_err(|error| match error {
            LightGroupError::Name => SceneError::LightGroupName(name.to_owned()),
            LightGroupError::TooMany => SceneError::TooManyLightGroups,
        })
    }

    /// What rays see that leave the scene, and what shines on it from there; black unless it is set.
    ///
    /// # Errors
    /// [`SceneError::NotFinite`].
    pub fn background(&mut self, background: Background) -> Result<(), SceneError> {
        self.background_in(LightGroup::default(), background)
    }

    /// As [`SceneBuilder::background`], in a group of lights.
    ///
    /// # Errors
    /// [`SceneError::NotFinite`], [`SceneError::UnknownLightGroup`].
    pub fn background_in(&mut self, group: LightGroup, background: Background) -> Result<(), SceneError> {
        check_finite(background.is_finite(), "Background")?;
        self.check_group(group)?;
        self.surround(group, background);
        Ok(())
    }

    pub(crate) fn surround(&mut self, group: LightGroup, background: Background) {
        (self.background, self.background_group) = (background, group);
    }

    /// Light from everywhere, of the classic integrator; black unless it is set, and white in a scene without lights.
    pub fn ambient(&mut self, radiance: Spectrum) {
        self.ambient = radiance;
    }

    /// What fills the air, for the classic integrator.
    pub fn fog(&mut self, fog: Fog) {
        self.fog = Some(fog);
    }

    pub(super) fn check_group(&self, group: LightGroup) -> Result<(), SceneError> {
        self.light_groups.contains(group).then_some(()).ok_or(SceneError::UnknownLightGroup(group))
    }
}
