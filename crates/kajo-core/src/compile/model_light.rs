//! Lights and cameras of models.
//!
//! A candela counts as a watt per steradian and a lux as a watt per square metre, as for luminaires: what a model's light
//! makes of a white surface is its illuminance over π.

use kajo_color::Emission;
use kajo_math::DAffine3;
use kajo_scene::{Diagnostic, Item, ModelCamera, ModelLight, ModelLightKind, ModelView};

use super::Compiler;
use super::graphics_state::CurrentTransform;
use crate::camera::{Camera, CameraFrame, NamedCamera, OrthographicCamera, PerspectiveCamera};
use crate::ids::LightGroup;
use crate::light::{DirectionalLight, PointLight, SpotCone, SpotLight};

impl Compiler<'_> {
    /// Adds the lights of a model that stands at `ctm`.
    ///
    /// * `scale`: factor of their intensities
    /// * `group`: of the light groups
    pub(super) fn model_lights(
        &mut self,
        lights: &[ModelLight],
        (scale, group): (f32, LightGroup),
        ctm: &CurrentTransform,
        item: Item<'_>,
    ) {
        if lights.is_empty() || ctm.is_flat() || scale == 0.0 {
            return;
        }
        if ctm.world.constant().is_none() {
            let warning = Diagnostic::warning("the lights of a model that moves stay where it begins");
            self.diagnostics.push(warning.label(item.keyword_span(), "holds lights"));
        }
        let (map, at) = (ctm.world.at(0.0), item.head_span());
        for light in lights {
            let emission = Emission::from_rgb(light.intensity).scaled(scale);
            let direction = map.transform_vector3(light.direction).normalize_or_zero().as_vec3();
            let position = map.transform_point3(light.position).as_vec3();
            let point = PointLight::new(position, emission);
            match light.kind {
                ModelLightKind::Point => self.add_light(point, group, at),
                ModelLightKind::Directional => {
                    let PointLight { intensity, emission, .. } = point;
                    let light = DirectionalLight { to_light: -direction, height: 0.0, intensity, emission };
                    self.add_light(light, group, at);
                }
                ModelLightKind::Spot { inner, outer } => {
                    let cone = SpotCone::new(inner, outer);
                    self.add_light(SpotLight { point, axis: direction, cone }, group, at);
                }
            }
        }
    }

    /// Lists the cameras of a model that stands at `ctm`, as it stands when the shutter opens.
    pub(super) fn list_model_cameras(&mut self, cameras: &[ModelCamera], ctm: &CurrentTransform) {
        if ctm.is_flat() {
            return;
        }
        let map = ctm.world.at(0.0);
        let placed = cameras.iter().map(|camera| NamedCamera {
            name: camera.name.as_deref().map(str::to_owned),
            camera: placed(camera, &map),
        });
        self.model_cameras.extend(placed);
    }
}

/// A camera as its model stands.
fn placed(camera: &ModelCamera, map: &DAffine3) -> Camera {
    let up = map.transform_vector3(camera.up);
    let direction = map.transform_vector3(camera.direction);
    let frame = CameraFrame::new(map.transform_point3(camera.center), direction, up);
    match camera.view {
        ModelView::Perspective { angle } => Camera::Perspective(PerspectiveCamera::new(frame, angle)),
        ModelView::Orthographic { height } => {
            Camera::Orthographic(OrthographicCamera { frame, size: height * up.length(), lens: None })
        }
    }
}
