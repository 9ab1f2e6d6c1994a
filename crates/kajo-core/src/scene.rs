//! The compiled scene: everything rays meet, immutable and shared by all threads.

mod accel;
mod differential;
mod event;
mod extent;
mod fitted;
mod geometry;
mod immersion;
mod rays;
mod relativity;

use crate::texture::{TexelFilter, TextureContext, TextureFootprint};
use std::sync::{Arc, OnceLock};

use kajo_color::Spectrum;
use kajo_math::{Affine3, Ray, Vec3};

use crate::animation::{AnimatedModel, Animation};
use crate::background::Background;
use crate::bsdf::Phong;
use crate::camera::{Camera, NamedCamera};
use crate::emission::VariedEmission;
use crate::ids::ObjectId;
use crate::interaction::{Hit, SurfacePoint, SurfaceUv};
use crate::light::{LightId, LightSampler, Lights};
use crate::material::{Appearance, MaterialId};
use crate::medium::{EmissiveVolumes, Fog, MediumId};
use crate::motion::MovingTransform;
use crate::nested::Leaf;
use crate::settings::{IntegratorName, Rules, Settings};
use crate::shape::ShapeId;

pub use event::{Interaction, RayEvent};
pub use extent::Extent;
pub use fitted::{Fitted, FittedCamera};
pub use geometry::{Geometry, Primitive};
pub use immersion::Immersion;
pub use relativity::{CameraMotion, LightRay, MAX_GAMMA, Relativity, RestFrame};

/// A scene ready to be rendered.
#[derive(Debug)]
pub struct Scene {
    /// Shapes and where they stand.
    pub geometry: Geometry,
    /// What their surfaces look like.
    pub appearance: Appearance,
    /// What gives light.
    pub lighting: Lighting,
    /// From where and how it is to be seen.
    pub output: Output,
    /// The frames of what moves at speeds that light is not much faster than, and the observer's; `None` where all is at rest.
    pub relativity: Option<Box<Relativity>>,
}

/// Everything that gives light, and the air that it goes through.
#[derive(Debug)]
pub struct Lighting {
    /// Lights.
    pub lights: Lights,
    /// The lights in the order of the file, and then the patches of emissive objects.
    pub list: Vec<LightId>,
    /// Names of the groups of lights; the first is that of lights without one.
    pub groups: Arc<[String]>,
    /// Everything that gives light, ready to be chosen from.
    pub sampler: LightSampler,
    /// Light of surfaces that differs from place to place; see [`crate::light::AreaLight::varied`].
    pub varied_emissions: Vec<VariedEmission>,
    /// What escaping rays see.
    pub background: Arc<Background>,
    /// Light that comes from everywhere, for the classic integrator.
    pub ambient: Spectrum,
    /// Fog everywhere, if any.
    pub fog: Option<Fog>,
    /// The medium around everything, if any.
    pub air: Option<MediumId>,
    /// Bodies of media that emit, made at the first question for them; see [`Scene::emissive_volumes`].
    pub volumes: OnceLock<EmissiveVolumes>,
}

/// The cameras, and what the file says about the picture.
#[derive(Debug)]
pub struct Output {
    /// The camera.
    pub camera: Camera,
    /// What the camera fits into its picture; see [`Scene::camera_for`].
    pub fitted: Option<FittedCamera>,
    /// All cameras there are to choose from: those of the file in their order, then those of its models.
    pub cameras: Vec<NamedCamera>,
    /// In which share of the shutter's time its rows open one after the other, from the top; 0 where all open at once.
    pub readout: f32,
    /// What the file itself says about how to render it.
    pub settings: Settings,
    /// The conventions of the file's dialect.
    pub rules: Rules,
    /// How pictures are filtered that do not say it themselves.
    pub texture_filter: TexelFilter,
    /// Whether the file has a group of objects at all; without one the reference shows the uv picture.
    pub has_group: bool,
    /// Which frame of how many this is, for a scene that has any.
    pub animation: Option<Animation>,
    /// Models that follow the frames by animations of their files.
    pub animated_models: Vec<AnimatedModel>,
    /// Which integrator suits the scene, and why: worked out at the first question for it.
    pub suited: OnceLock<(IntegratorName, &'static str)>,
}

impl Scene {
    /// Whether what a ray finds depends on its time.
    pub fn moves(&self) -> bool {
        self.output.camera.moves() || self.has_moving_things()
    }

    /// Whether anything but the camera moves.
    pub fn has_moving_things(&self) -> bool {
        self.appearance.has_moving_media || self.geometry.motions.iter().any(MovingTransform::moves)
    }

    /// Whether anything asks what a sample covers, so that paths carry differentials.
    #[inline]
    pub fn wants_differentials(&self) -> bool {
        self.appearance.has_filters || self.lighting.background.wants_footprint()
    }

    /// Whether there is any medium that light may be scattered or absorbed in, so that paths have to ask.
    pub fn has_media(&self) -> bool {
        self.appearance.has_media || self.lighting.air.is_some()
    }

    /// Whether light from infinitely far away comes to surfaces without end: paths from such lights meet these around all that has an end, and
    /// not beyond.
    pub fn lights_endless_surfaces(&self) -> bool {
        self.geometry.has_unbounded() && self.lighting.sampler.has_infinite()
    }

    /// Whether light may pass through any part of an object.
    pub(crate) fn may_transmit(&self, object: ObjectId) -> bool {
        match self.geometry.primitives.get(object.index()) {
            Some(primitive) => primitive.transmits,
            None => rarely(|| self.geometry.leaf(object).is_some_and(|leaf| self.leaf_transmits(&leaf))),
        }
    }

    fn leaf_transmits(&self, leaf: &Leaf) -> bool {
        let transmits = |material| self.appearance.may_transmit(material);
        leaf.brings_materials || leaf.material.is_some_and(transmits)
    }

    /// Where materials are evaluated for an interaction.
    #[inline]
    pub fn texture_context(&self, at: &Interaction) -> TextureContext {
        match self.appearance.has_filters {
            true => rarely(|| {
                let needs_uv = self.needs_uv(at);
                let footprint = self.texture_footprint(at, needs_uv);
                TextureContext { footprint, ..self.point_context(at, needs_uv) }
            }),
            false => self.point_context(at, self.needs_uv(at)),
        }
    }

    #[inline(always)]
    fn needs_uv(&self, at: &Interaction) -> bool {
        self.appearance.has_pictures && self.appearance.needs_uv(at.material)
    }

    /// The same with the footprint of a point.
    #[inline(always)]
    fn point_context(&self, at: &Interaction, needs_uv: bool) -> TextureContext {
        let uv = if needs_uv { rarely(|| self.geometry.surface_uv(at)) } else { SurfaceUv::default() };
        let p = self.geometry.pattern_point(at);
        let n = self.geometry.pattern_normal(at);
        let object_from_world = self.pattern_frame(at);
        let (tint, footprint) = (self.geometry.tint(at), TextureFootprint::POINT);
        TextureContext { p, uv, tint, n, time: at.time, object_from_world, footprint }
    }

    /// [`TextureContext::object_from_world`] at an interaction.
    #[inline]
    pub(crate) fn pattern_frame(&self, at: &Interaction) -> Affine3 {
        match self.appearance.textures.wants_object_space() {
            true => rarely(|| self.geometry.pattern_frame(at)),
            false => Affine3::IDENTITY,
        }
    }

    /// The classic reflection model of a material, where it is the same at every point whatever has the material.
    #[inline]
    pub fn constant(&self, material: MaterialId) -> Option<&Phong> {
        if self.geometry.has_vertex_colors { None } else { self.appearance.materials.constant(material) }
    }

    /// A point of the surface of an object at the moment 0 of the shutter, as a ray that meets it there would tell of it; `None` where
    /// there is no such object. Its errors are 0, as no ray was rounded.
    ///
    /// * `part`: of the shape, as in [`Hit::part`]
    /// * `p`: in the space of the shape, on its surface, or close to it, as points of a [`crate::shape::Tessellation`] are
    /// * `n`: unit normal there, in the same space
    pub fn surface_point(&self, object: ObjectId, part: u32, p: Vec3, n: Vec3) -> Option<Interaction> {
        let (shape, own, map) = match self.geometry.primitives.get(object.index()) {
            Some(placed) => (placed.shape, placed.material, self.geometry.transform_of(placed, 0.0)),
            None => self
                .geometry
                .leaf(object)
                .map(|leaf| (leaf.shape, leaf.material.unwrap_or_default(), leaf.world_from_object()))?,
        };
        let hit = self.geometry.shapes.hit_at(shape, part, p);
        let point = SurfacePoint::flat(map.point(p), Vec3::ZERO, map.normal(n));
        let material = self.material_at(shape, own, &hit);
        Some(Interaction { point, hit, object, material, ..Interaction::default() })
    }

    /// The colour that light is multiplied by when it passes a crossing straight through.
    #[inline]
    pub fn transparency(&self, ray: &Ray, object: ObjectId, hit: Hit) -> Spectrum {
        let material = match self.geometry.primitives.get(object.index()) {
            Some(placed) => self.material_at(placed.shape, placed.material, &hit),
            None => self.interaction(ray, object, hit).material,
        };
        if let Some(phong) = self.constant(material) {
            return phong.transparent;
        }
        let place = self.texture_context(&self.interaction(ray, object, hit));
        self.appearance.phong(material, &place).transparent
    }

    #[inline]
    fn material_at(&self, shape: ShapeId, own: MaterialId, hit: &Hit) -> MaterialId {
        let slot = self.geometry.shapes.material_slot(shape, hit.part);
        slot.map_or(own, |slot| self.appearance.slots[slot.index()])
    }
}

/// `f` of nothing, out of line: for cases that are rare.
#[cold]
#[inline(never)]
pub(crate) fn rarely<T>(f: impl FnOnce() -> T) -> T {
    f()
}
