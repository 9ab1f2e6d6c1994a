//! A scene without a text: things are pushed and named by typed ids, and [`SceneBuilder::finish`] makes the scene of them.
//!
//! The compiler of scene texts makes its scenes in the same way, so that there is one way to make one: both give the same
//! pictures, bit for bit.

mod area_lights;
mod assemblies;
mod emission_density;
mod error;
mod frames;
mod lights;
mod materials;
mod media;
mod objects;
#[cfg(test)]
mod tests;

use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

use kajo_color::Spectrum;
use kajo_math::Motion;
use kajo_scene::Limits;

use crate::background::Background;
use crate::camera::{Camera, NamedCamera};
use crate::emission::SurfaceEmission;
use crate::ids::LightGroup;
use crate::light::{LightGroups, LightId, Lights};
use crate::material::{Appearance, MaterialId};
use crate::medium::{Fog, MediumId};
use crate::motion::{MovingTransform, Shutter};
use crate::nested::Nested;
use crate::scene::{Geometry, Lighting, Output, Scene};
use crate::settings::Settings;
use crate::shape::ShapeId;

pub use assemblies::AssemblyPart;
pub use error::SceneError;
pub use frames::Rest;

pub use crate::nested::PartContent;
pub use kajo_bvh::BuildSettings;

/// Makes a [`Scene`] piece by piece.
///
/// Lengths are in the scene's own unit, angles in radians, colours in linear RGB. What is pushed is checked at once: numbers have to be
/// finite, and ids those that this builder has given. Ranges, such as that of a roughness, are for the types to state.
///
/// ```
/// use kajo_color::{Emission, Reflectance};
/// use kajo_core::builder::{SceneBuilder, SceneError};
/// use kajo_core::camera::{CameraFrame, PerspectiveCamera};
/// use kajo_core::emission::SurfaceEmission;
/// use kajo_core::ids::PoseId;
/// use kajo_core::material::Matte;
/// use kajo_core::settings::Settings;
/// use kajo_core::shape::{Plane, Sphere};
/// use kajo_math::{DAffine3, DVec3, Vec3};
///
/// let mut scene = SceneBuilder::default();
/// let grey = scene.material(Matte::new(Reflectance::constant(0.5), 0.0))?;
/// let light = SurfaceEmission::from(Emission::from_rgb([4.0, 3.0, 2.0]));
/// let warm = scene.emissive_material(Matte::new(Reflectance::constant(0.0), 0.0), light)?;
///
/// let ball = scene.shape(Sphere::new(Vec3::ZERO, 1.0))?;
/// let floor = scene.shape(Plane::new(DVec3::Y, -1.0))?;
/// scene.object(floor, grey, PoseId::IDENTITY)?;
/// scene.object(ball, grey, PoseId::IDENTITY)?;
/// let above = scene.transform(&DAffine3::from_translation(DVec3::new(0.0, 4.0, 0.0)))?;
/// scene.object(ball, warm, above)?;
///
/// let frame = CameraFrame::new(DVec3::new(0.0, 2.0, 9.0), DVec3::new(0.0, -0.1, -1.0), DVec3::Y);
/// scene.camera(PerspectiveCamera::new(frame, 0.6))?;
/// let scene = scene.finish(Settings { size: Some([64, 48]), ..Settings::default() })?;
/// assert_eq!(scene.geometry.primitives.len(), 3);
/// # Ok::<(), SceneError>(())
/// ```
#[derive(Debug, Default)]
pub struct SceneBuilder {
    geometry: Geometry,
    /// Of the objects that move, until the shutter is known.
    motions: Vec<Motion>,
    nested: Nested,
    /// Whether light may pass through any nested object.
    nested_transmits: bool,
    /// Of meshes with materials of their own.
    own_materials: HashMap<ShapeId, OwnMaterials>,
    appearance: Appearance,
    emissions: HashMap<MaterialId, SurfaceEmission>,
    see_through: HashMap<MaterialId, MaterialId>,
    lights: Lights,
    light_list: Vec<(LightId, LightGroup)>,
    light_groups: LightGroups,
    background: Background,
    background_group: LightGroup,
    ambient: Spectrum,
    fog: Option<Fog>,
    air: Option<MediumId>,
    cameras: Vec<NamedCamera>,
    frames: frames::Frames,
    shutter: Shutter,
    readout: f32,
    limits: Limits,
    trees: BuildSettings,
}

/// What is known of the materials that a mesh has of its own.
#[derive(Clone, Copy, Debug, Default)]
struct OwnMaterials {
    /// Whether light may pass any of them.
    transmit: bool,
    /// Whether any of them gives light.
    emit: bool,
}

impl SceneBuilder {
    /// An empty scene.
    ///
    /// * `limits`: how many objects there may be, and memory for the lights that emissive objects are
    /// * `trees`: how to build the trees over its objects
    pub fn new(limits: Limits, trees: BuildSettings) -> SceneBuilder {
        SceneBuilder { limits, trees, ..SceneBuilder::default() }
    }

    /// When the shutter is open; from 0 to 1 unless it is set.
    ///
    /// # Errors
    /// [`SceneError::NotFinite`], [`SceneError::Shutter`].
    pub fn shutter(&mut self, shutter: Shutter) -> Result<(), SceneError> {
        check_finite(shutter.open.is_finite() && shutter.close.is_finite(), "Shutter")?;
        if shutter.close < shutter.open {
            return Err(SceneError::Shutter);
        }
        self.expose(shutter, self.readout);
        Ok(())
    }

    /// When the shutter is open, and in which share of that time its rows open one after the other.
    pub(crate) fn expose(&mut self, shutter: Shutter, readout: f32) {
        (self.shutter, self.readout) = (shutter, readout);
    }

    /// In which share of the shutter's time its rows open one after the other, from the top.
    pub(crate) fn readout(&self) -> f32 {
        self.readout
    }

    /// Adds a camera. The last one takes the picture, unless programs ask for another.
    ///
    /// # Errors
    /// [`SceneError::NotFinite`].
    pub fn camera(&mut self, camera: impl Into<Camera>) -> Result<(), SceneError> {
        self.add_camera(None, camera.into())
    }

    /// Adds a camera that is chosen by its name.
    ///
    /// # Errors
    /// [`SceneError::NotFinite`].
    pub fn named_camera(&mut self, name: &str, camera: impl Into<Camera>) -> Result<(), SceneError> {
        self.add_camera(Some(name.to_owned()), camera.into())
    }

    fn add_camera(&mut self, name: Option<String>, camera: Camera) -> Result<(), SceneError> {
        check_finite(camera.is_finite(), "Camera")?;
        self.cameras.push(NamedCamera { name, camera });
        Ok(())
    }

    /// Makes the scene: emissive objects become lights, and trees are built over all objects and all lights.
    ///
    /// * `settings`: what the scene itself says about its picture
    ///
    /// # Errors
    /// [`SceneError::NoCamera`], [`SceneError::EmptyPicture`], [`SceneError::NotFinite`], [`SceneError::LightMemory`],
    /// [`SceneError::FastMedium`].
    pub fn finish(mut self, settings: Settings) -> Result<Scene, SceneError> {
        let cameras = std::mem::take(&mut self.cameras);
        let camera = cameras.last().ok_or(SceneError::NoCamera)?.camera.clone();
        if let Some([width, height]) = settings.size
            && (width == 0 || height == 0)
        {
            return Err(SceneError::EmptyPicture(width, height));
        }
        check_finite(settings.is_finite(), "Settings")?;
        let rules = settings.dialect.unwrap_or_default().rules();
        let texture_filter = settings.texture_filter.unwrap_or_default();
        let output = Output {
            camera,
            fitted: None,
            cameras,
            readout: self.readout,
            settings,
            rules,
            texture_filter,
            has_group: true,
            animation: None,
            animated_models: Vec::new(),
            suited: OnceLock::new(),
        };
        self.finish_with(output)
    }

    /// Makes the scene with an output that may lack its cameras yet.
    ///
    /// # Errors
    /// [`SceneError::LightMemory`], [`SceneError::FastMedium`].
    pub(crate) fn finish_with(mut self, output: Output) -> Result<Scene, SceneError> {
        let shutter = self.shutter;
        let motions = std::mem::take(&mut self.motions);
        self.geometry.motions =
            motions.into_iter().map(|motion| MovingTransform::new(motion, shutter)).collect();
        self.expose_moving_parts()?;
        let varied_emissions = self.area_lights().map_err(SceneError::LightMemory)?;
        // The classic rule: a scene without lights is fully lit by ambient light.
        let ambient = if self.light_list.is_empty() { Spectrum::WHITE } else { self.ambient };
        let background = Arc::new(std::mem::take(&mut self.background));
        let frames = std::mem::take(&mut self.frames);
        let mut samplers = self.light_samplers(&background, &frames);
        let sampler = samplers.remove(0);
        self.finish_geometry(&frames);
        self.finish_appearance();
        let relativity = frames.finish(&self.geometry, samplers, &self.trees);
        let lighting = Lighting {
            lights: self.lights,
            list: self.light_list.into_iter().map(|(id, _)| id).collect(),
            groups: self.light_groups.into_names(),
            sampler,
            varied_emissions,
            background,
            ambient,
            fog: self.fog,
            air: self.air,
            volumes: OnceLock::new(),
        };
        Ok(Scene { geometry: self.geometry, appearance: self.appearance, lighting, output, relativity })
    }
}

/// Refuses what has numbers that are infinite or none.
fn check_finite(is_finite: bool, what: &'static str) -> Result<(), SceneError> {
    is_finite.then_some(()).ok_or(SceneError::NotFinite(what))
}
