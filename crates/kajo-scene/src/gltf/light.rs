//! Lights of glTF: the extension `KHR_lights_punctual`.
//!
//! A light stands where its node does and shines along the negative z axis of it. Scales of nodes change neither what it
//! gives nor how far its cone opens. Its `range`, beyond which programs that have to save time may leave it out, is not read.

use kajo_math::{DAffine3, DVec3};
use serde::Deserialize;
use std::f32::consts::FRAC_PI_4;
use std::sync::Arc;

/// A light at its place.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelLight {
    /// The name of the node, or else of the light.
    pub name: Option<Arc<str>>,
    /// Red, green and blue, linear: for a light with a place in candela, for one infinitely far away in lux.
    pub intensity: [f32; 3],
    /// How it shines.
    pub kind: ModelLightKind,
    /// In the model's space; of no effect for a light infinitely far away.
    pub position: DVec3,
    /// Unit direction in which the light travels, in the model's space; of no effect for one that shines all around.
    pub direction: DVec3,
}

/// How a light shines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ModelLightKind {
    /// From infinitely far away.
    Directional,
    /// All around.
    Point,
    /// Into a cone, whose half angles are in radians, the inner one not above the outer one.
    Spot {
        /// Within this the light is full.
        inner: f32,
        /// Beyond this there is none.
        outer: f32,
    },
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Light {
    name: Option<Arc<str>>,
    color: Option<[f32; 3]>,
    intensity: Option<f32>,
    r#type: String,
    spot: Cone,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct Cone {
    inner_cone_angle: f32,
    outer_cone_angle: f32,
}

impl Default for Cone {
    fn default() -> Cone {
        Cone { inner_cone_angle: 0.0, outer_cone_angle: FRAC_PI_4 }
    }
}

impl Light {
    /// The light at its place; `None` where that is nowhere.
    ///
    /// * `node_name`: the name of its node, which goes before its own
    /// * `transform`: from the node's space to the model's
    ///
    /// # Errors
    /// When there is no such type of light.
    pub(super) fn placed(
        &self,
        node_name: Option<&Arc<str>>,
        transform: &DAffine3,
    ) -> Result<Option<ModelLight>, String> {
        let Cone { inner_cone_angle, outer_cone_angle } = self.spot;
        let outer = outer_cone_angle.clamp(0.0, std::f32::consts::FRAC_PI_2);
        let kind = match self.r#type.as_str() {
            "directional" => ModelLightKind::Directional,
            "point" => ModelLightKind::Point,
            "spot" => ModelLightKind::Spot { inner: inner_cone_angle.clamp(0.0, outer), outer },
            other => return Err(format!("there is no type of light `{other}`")),
        };
        let amount = |factor: f32| Some((factor * self.intensity.unwrap_or(1.0)).max(0.0));
        let finite = |x: &f32| x.is_finite();
        let intensity = self.color.unwrap_or([1.0; 3]).map(|c| amount(c).filter(finite).unwrap_or(0.0));
        if !transform.translation.as_vec3().is_finite() {
            return Ok(None);
        }
        let name = node_name.or(self.name.as_ref()).filter(|name| !name.is_empty());
        Ok(Some(ModelLight {
            name: name.cloned(),
            intensity,
            kind,
            position: transform.translation,
            direction: transform.transform_vector3(DVec3::NEG_Z).normalize_or(DVec3::NEG_Z),
        }))
    }
}
