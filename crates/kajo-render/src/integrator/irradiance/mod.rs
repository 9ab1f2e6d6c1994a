//! Irradiance caching [Ward, Rubinstein and Clear 1988], with gradients [Ward and Heckbert 1992] and radii by what is hidden
//! [Schwarzhaupt, Jensen and Jarosz 2012].
//!
//! A surface that reflects evenly sends back `R/π E` in every direction, and the part of the irradiance `E` that was scattered before
//! changes slowly from place to place, as does that from a sky of one colour. It is worked out for few points, by many rays
//! each, and in between it is interpolated:
//!
//! ```text
//! L(x, wo) = direct light + caustics + R/π E(x, n) + glossy light,     E = sum of w_i E_i(x, n) / sum of w_i
//! ```
//!
//! Direct light, caustics, and what a surface scatters unevenly, is sampled as by path tracing; so is all light where
//! no record reaches, so that a position without records is noisy, but right. Bounces are counted from the surface that
//! the cache lights.

mod builder;
mod hemisphere;
mod mesh;
mod octree;
mod record;
mod record_bvh;
mod settings;

use kajo_color::Spectrum;
use kajo_core::camera::Camera;
use kajo_core::light::{LightId, LightSelection};
use kajo_core::scene::{Lighting, Scene};
use kajo_math::{Vec2, Vec3};

use super::Integrator;
use super::camera_view::CameraView;
use super::path::{DiffuseVertex, Indirect, IndirectLight, Path};
use crate::trail::PathObserver;
use crate::{KeptState, SamplesPerState, Setup, SetupError, WithState};
use crate::{Layer, LayerSet, PixelSample, SampleContext};
use builder::{Builder, FirstDiffuseVisitor};
use record::{GatheredRecord, IrradianceQuery};
use record_bvh::RecordBvh;
pub use settings::{IRRADIANCE, IrradianceSettings};

/// An irradiance cache over one scene and one picture size, before it has records: it follows paths.
pub struct IrradianceCaching<'a> {
    view: CameraView<'a>,
    settings: IrradianceSettings,
    /// As the picture is taken.
    paths: Path<'a>,
    /// The same without layers.
    plain: Path<'a>,
    /// The background, where its light is kept too.
    even_sky: Option<LightId>,
    /// Whether any other light is met by rays.
    has_other_lights: bool,
    /// Whether the picture has the layer of records.
    wants_records: bool,
    /// What it starts from and adds to.
    kept: Option<KeptState>,
}

/// The records.
struct Cache {
    records: RecordBvh,
    /// How far normals may be apart, as `1 - cos`.
    turn: f32,
    /// Whether any light was asked for.
    is_needed: bool,
}

/// Records for a render through another camera.
///
/// What a record knows of its surroundings holds for any camera. How far it is used does not: radii are bounded by pixels, and the error
/// allowed grows with the picture. So records are kept as they were gathered, and their radii are worked out anew for each camera, by the
/// size that a pixel has at their distance from it.
struct KeptRecords {
    /// How they were made.
    settings: IrradianceSettings,
    /// In the order in which they came.
    records: Vec<GatheredRecord>,
}

impl KeptRecords {
    /// Whether they are what these settings make.
    fn suit(&self, settings: &IrradianceSettings) -> bool {
        let of = |settings: &IrradianceSettings| IrradianceSettings { shows_records: false, ..*settings };
        of(&self.settings) == of(settings)
    }
}

/// How far the point is seen that stands for a record, as a share of its smaller radius.
const POINT: f32 = 0.1;

/// The colour of points that stand for records: that of no light.
const POINT_COLOR: [f32; 3] = [1.0, 0.0, 0.0];

impl Cache {
    /// The picture of the cache itself: what a white surface would send back of the indirect light, and points where records are.
    fn shown(&self, at: &IrradianceQuery) -> [f32; 3] {
        if self.is_record(at) {
            return POINT_COLOR;
        }
        let e = self.records.irradiance(at, self.turn).unwrap_or_default();
        e.map(|e| e * std::f32::consts::FRAC_1_PI)
    }

    /// Whether a position lies in the dot that stands for a record.
    fn is_record(&self, at: &IrradianceQuery) -> bool {
        self.records.is_record(at, self.turn, POINT)
    }
}

/// An irradiance cache with its records.
pub struct Cached<'a> {
    caching: &'a IrradianceCaching<'a>,
    cache: Cache,
}

/// The background, where it is of one colour and scattering alone finds it.
///
/// Not where there are groups of lights: their layers have no light that is kept.
fn even_sky(scene: &Scene, settings: &IrradianceSettings) -> Option<LightId> {
    let Lighting { lights, groups, .. } = &scene.lighting;
    let by_scattering =
        LightSelection::from(settings.light_choice).is_beside_scattering() && groups.len() <= 1;
    let is_even = |id: &LightId| lights.is_background(*id) && lights.unevenness(*id) == 0.0;
    lights.ids().find(|id| by_scattering && is_even(id))
}

impl<'a> IrradianceCaching<'a> {
    /// The integrator for a picture of `size` pixels with these `layers`.
    pub fn new(
        scene: &'a Scene,
        settings: IrradianceSettings,
        size: [u32; 2],
        layers: LayerSet,
    ) -> IrradianceCaching<'a> {
        IrradianceCaching::through(&scene.output.camera, scene, settings, size, layers)
    }

    /// The same through another camera than the scene's.
    pub fn through(
        camera: &'a Camera,
        scene: &'a Scene,
        settings: IrradianceSettings,
        size: [u32; 2],
        layers: LayerSet,
    ) -> IrradianceCaching<'a> {
        let none = LayerSet::of(&[]);
        let (lights, even_sky) = (&scene.lighting.lights, even_sky(scene, &settings));
        let is_met = |id: LightId| lights.object(id).is_some() || lights.is_seen_at_infinity(id);
        IrradianceCaching {
            view: CameraView::new(scene, camera, size, none),
            settings,
            even_sky,
            has_other_lights: scene.has_media() || lights.ids().any(|id| Some(id) != even_sky && is_met(id)),
            paths: Path::through(camera, scene, settings.paths(), size, layers),
            plain: Path::through(camera, scene, settings.paths(), size, none),
            wants_records: layers.has(Layer::CacheRecords),
            kept: None,
        }
    }

    fn builder<'b>(&'b self, setup: &'b Setup<'b>) -> Builder<'b, 'a> {
        Builder::new(&self.view, &self.plain, self.settings, self.even_sky, setup)
    }
}

impl Integrator for IrradianceCaching<'_> {
    /// A path without records, as path tracing follows it.
    fn observe<O: PathObserver>(
        &self,
        ctx: &mut SampleContext<'_>,
        pixel: [u32; 2],
        raster: Vec2,
        observer: &mut O,
    ) -> PixelSample {
        self.paths.observe(ctx, pixel, raster, observer)
    }

    fn keep_state(&mut self, kept: &KeptState) -> bool {
        self.kept = Some(kept.clone());
        true
    }

    fn samples_per_state(&self) -> Option<SamplesPerState> {
        Some(SamplesPerState::All)
    }

    fn with_state<'a>(&'a self, _k: u32, setup: &Setup<'_>) -> Result<WithState<'a>, SetupError> {
        let mut kept = self.kept.as_ref().map(|kept| {
            let before = kept.take().filter(|before: &KeptRecords| before.suit(&self.settings));
            before.map_or_else(Vec::new, |before| before.records)
        });
        let before = kept.as_ref().map_or(0, Vec::len);
        let built = self.builder(setup).build(kept.as_mut());
        // What there is when somebody stops it is as good.
        if let Some((slot, records)) = self.kept.as_ref().zip(kept) {
            slot.put(KeptRecords { settings: self.settings, records });
        }
        let (cache, rays) = built?;
        let mut notes = Vec::new();
        if before > 0 {
            notes.push(format!("it starts from {before} records of irradiance of the pictures before"));
        }
        if !cache.is_needed {
            let note = "no surface that is seen reflects indirect light evenly, so there is nothing to be cached; \
                        `integrator path` finds the same picture";
            notes.push(note.to_owned());
        }
        let integrator = Box::new(Cached { caching: self, cache });
        Ok(WithState { integrator, rays, notes })
    }
}

impl Integrator for Cached<'_> {
    fn observe<O: PathObserver>(
        &self,
        ctx: &mut SampleContext<'_>,
        _pixel: [u32; 2],
        raster: Vec2,
        observer: &mut O,
    ) -> PixelSample {
        let caching = self.caching;
        if !caching.settings.shows_records {
            let lookup = Lookup { caching, cache: &self.cache, bounces: 0, seen: None };
            let (sample, lookup) = caching.paths.observe_with(ctx, raster, observer, lookup);
            if caching.wants_records {
                ctx.aux.record =
                    if lookup.seen.is_some_and(|at| self.cache.is_record(&at)) { 1.0 } else { 0.0 };
            }
            return sample;
        }
        let (sample, look) = caching.paths.observe_with(
            ctx,
            raster,
            observer,
            FirstDiffuseVisitor::from_camera(caching.even_sky),
        );
        let radiance = look.query().map_or([0.0; 3], |at| self.cache.shown(&at));
        observer.shown_instead(|| radiance);
        PixelSample { radiance, ..sample }
    }
}

/// Looks light up.
struct Lookup<'c, 'a> {
    caching: &'c IrradianceCaching<'a>,
    cache: &'c Cache,
    /// Of the path so far.
    bounces: u32,
    /// Where light was looked up that goes to the camera.
    seen: Option<IrradianceQuery>,
}

impl IndirectLight for Lookup<'_, '_> {
    const IS_ASKED: bool = true;

    fn irradiance(&mut self, vertex: &DiffuseVertex<'_, '_>) -> Indirect {
        let &DiffuseVertex { surface, n, relief, .. } = vertex;
        let at = IrradianceQuery { p: surface.at.point.p, n, relief };
        if self.bounces == 0 {
            self.seen.get_or_insert(at);
        }
        match self.cache.records.irradiance(&at, self.cache.turn) {
            Some([r, g, b]) => Indirect::Irradiance(Spectrum::rgb(r, g, b)),
            None => Indirect::Unknown,
        }
    }

    fn hit(&mut self, bounces: u32, _p: Option<Vec3>) {
        self.bounces = bounces;
    }

    fn even_sky(&self) -> Option<LightId> {
        self.caching.even_sky
    }

    fn scattering_finds_lights(&self) -> bool {
        self.caching.has_other_lights
    }
}

#[cfg(test)]
mod tests;
