//! Builds the records in rounds, so that the cache is a function of the scene and the seed.
//!
//! Grids of pixels from coarse to fine cover the whole picture. From each pixel of a grid a path goes to the first surface that is no
//! mirror; where that reflects evenly and the records do not cover it yet, the pixel proposes a record. Proposals are sorted by
//! (priority, pixel), the priority being a hash, so that those that follow each other are far apart. Then, round by round,
//!
//! ```text
//! the first proposals that are still uncovered       one thread
//! their records, by rays into the hemisphere         all threads, which read nothing of the cache
//! accepted in their order, if still uncovered        one thread
//! ```
//!
//! The result depends neither on the number of threads nor on how the picture is split.

use kajo_color::{Spectrum, Wavelengths};
use kajo_core::RayOffset;
use kajo_core::bsdf::Transport;
use kajo_core::light::{BoundingSphere, LightId};
use kajo_core::sampler::{SampleStream, Sampler, SamplerKind};
use kajo_core::settings::Gradients;
use kajo_math::rng::mix;
use kajo_math::{Frame, Ray, Vec2, Vec3};

use super::hemisphere::{Derivatives, Hemisphere, RayResult, Strata};
use super::mesh::eigenvalues;
use super::octree::Octree;
use super::record::{GatheredRecord, IrradianceQuery, Record};
use super::record_bvh::RecordBvh;
use super::{Cache, IrradianceSettings};
use crate::integrator::camera_view::CameraView;
use crate::integrator::path::{
    CameraPath, DiffuseVertex, Indirect, IndirectLight, Path, PathSettings, PathTracer,
};
use crate::integrator::transport::{LaneMis, MediumStack, PathState, SurfaceInteraction};
use crate::trail::{Counting, PathObserver};
use crate::{RayCounters, SampleContext, Setup, SetupError};

/// Sets the numbers of proposals and of records apart from those of samples.
const SALTS: [u64; 2] = [0x7072_6F62_6573, 0x7265_636F_7264];

/// Pixels from one proposal to the next, grid by grid.
const SPACINGS: [u32; 4] = [16, 8, 4, 2];

/// Records of one round.
const ROUND: usize = 128;

/// The weight of all records that cover a position together, so that there are mostly several, and none ends in sight.
const COVERED: f32 = 0.3;

/// The least and the largest radius, in pixels.
const RADII: [f32; 2] = [1.5, 20.0];

/// `1 - cos` of the angle of normals beyond which a record is not used, whatever the accuracy.
const LARGEST_TURN: f32 = 0.25;

/// The side of the square over which the error of a record is counted, as a share of the height of the picture.
const SQUARE: f32 = 0.1;

/// Makes records.
pub struct Builder<'b, 'a> {
    view: &'b CameraView<'a>,
    /// Paths to the surfaces that are seen.
    paths: &'b Path<'a>,
    settings: IrradianceSettings,
    /// The background, where its light is kept too.
    even_sky: Option<LightId>,
    /// How light comes to a record.
    path_settings: PathSettings,
    strata: Strata,
    setup: &'b Setup<'b>,
}

/// The records so far.
struct GrowingCache {
    tree: Octree,
    /// As for [`Cache`].
    turn: f32,
    /// As for [`Cache`].
    is_needed: bool,
}

impl GrowingCache {
    /// Whether no more records are needed for a position.
    fn covers(&self, at: &IrradianceQuery) -> bool {
        self.tree.weight(at, self.turn) >= COVERED
    }
}

/// A pixel that asks for a record.
#[derive(Clone, Copy)]
struct Proposal {
    priority: u32,
    pixel: [u32; 2],
    at: IrradianceQuery,
}

/// A record with its place and the size of a pixel there.
type MadeRecord = (IrradianceQuery, GatheredRecord, f32);

/// What a proposal sees.
struct ProposalVertex {
    surface: SurfaceInteraction,
    media: MediumStack,
    time: f32,
    at: IrradianceQuery,
    /// Size of a pixel there, in units of the world.
    pixel_size: f32,
}

impl<'b, 'a> Builder<'b, 'a> {
    /// * `paths`: of a picture without layers
    /// * `even_sky`: the background, where its light is kept too
    pub fn new(
        view: &'b CameraView<'a>,
        paths: &'b Path<'a>,
        settings: IrradianceSettings,
        even_sky: Option<LightId>,
        setup: &'b Setup<'b>,
    ) -> Builder<'b, 'a> {
        let path_settings = PathSettings { free_mirrors: 0, ..settings.paths() };
        Builder { view, paths, settings, even_sky, path_settings, strata: Strata::of(settings.rays), setup }
    }

    /// The cache, and the rays that it took.
    ///
    /// * `kept`: records to start from, which those that are made are added to
    pub fn build(
        &self,
        mut kept: Option<&mut Vec<GatheredRecord>>,
    ) -> Result<(Cache, RayCounters), SetupError> {
        let world = BoundingSphere::around(&self.view.scene.geometry.bounds());
        let tree = Octree::new(world.center, world.radius);
        let turn = self.settings.accuracy.clamp(1e-4, LARGEST_TURN);
        let mut growing = GrowingCache { tree, turn, is_needed: false };
        let mut rays = RayCounters::default();
        if let Some(kept) = &mut kept {
            self.start_from(kept, &mut growing);
        }
        for spacing in SPACINGS {
            let (mut proposals, cast) = self.proposals(spacing, &mut growing)?;
            rays += cast;
            proposals.sort_unstable_by_key(|proposal| (proposal.priority, proposal.pixel));
            let mut rest = proposals.into_iter();
            loop {
                let uncovered = rest.by_ref().filter(|proposal| !growing.covers(&proposal.at));
                let round: Vec<Proposal> = uncovered.take(ROUND).collect();
                if round.is_empty() {
                    break;
                }
                for (record, cast) in
                    self.setup.tasks(round.len() as u32, |i| self.record(&round[i as usize]))?
                {
                    rays += cast;
                    if let Some((at, gathered, pixel_size)) = record
                        && !growing.covers(&at)
                    {
                        growing.tree.insert_clamped(self.fitted(&gathered, pixel_size));
                        if let Some(kept) = &mut kept {
                            kept.push(gathered);
                        }
                    }
                }
                self.check_memory(&growing)?;
            }
        }
        let GrowingCache { tree, turn, is_needed } = growing;
        Ok((Cache { records: RecordBvh::new(tree.into_records()), turn, is_needed }, rays))
    }

    /// Adds records that another camera has needed; too many are forgotten.
    fn start_from(&self, kept: &mut Vec<GatheredRecord>, growing: &mut GrowingCache) {
        let room = self.setup.memory / 4;
        let pixel_sizes = self.pixel_sizes().filter(|_| size_of_val(&**kept) as u64 <= room);
        let Some(pixel_size) = pixel_sizes else { return kept.clear() };
        for gathered in kept {
            let size = pixel_size(gathered.record.p);
            if size > 0.0 {
                growing.tree.insert_clamped(self.fitted(gathered, size));
            }
        }
    }

    fn check_memory(&self, growing: &GrowingCache) -> Result<(), SetupError> {
        // The arrays grow by doubling.
        if 2 * growing.tree.bytes() <= self.setup.memory {
            return Ok(());
        }
        let (records, memory) = (growing.tree.records().len(), self.setup.memory >> 20);
        Err(SetupError::Refused(format!(
            "more than {records} records of irradiance are needed, and there are {memory} MB for them; ask for a larger `accuracy`"
        )))
    }

    /// The pixels of a grid whose surfaces the cache does not cover.
    fn proposals(
        &self,
        spacing: u32,
        growing: &mut GrowingCache,
    ) -> Result<(Vec<Proposal>, RayCounters), SetupError> {
        let [columns, rows] = self.view.size;
        let first = (spacing / 2).min(columns.min(rows) / 2);
        let known: &GrowingCache = growing;
        let found = self.setup.tasks(rows.saturating_sub(first).div_ceil(spacing), |row| {
            let sampler = Sampler::new(SamplerKind::Sobol, 1);
            let mut ctx = SampleContext::new(&sampler, mix(self.setup.seed ^ SALTS[0]));
            let (mut proposals, mut is_needed) = (Vec::new(), false);
            let y = first + row * spacing;
            for x in (first..columns).step_by(spacing as usize) {
                let Some(seen) = self.look(&mut ctx, [x, y]) else { continue };
                is_needed = true;
                if !known.covers(&seen.at) {
                    let priority = mix(u64::from(x) << 32 | u64::from(y)) as u32;
                    proposals.push(Proposal { priority, pixel: [x, y], at: seen.at });
                }
            }
            Ok((proposals, is_needed, ctx.rays))
        })?;
        let (mut all, mut rays) = (Vec::new(), RayCounters::default());
        for (proposals, is_needed, cast) in found {
            all.extend(proposals);
            growing.is_needed |= is_needed;
            rays += cast;
        }
        Ok((all, rays))
    }

    /// The surface that a pixel sees, by way of mirrors and glass, where its light is to be known.
    fn look(&self, ctx: &mut SampleContext<'_>, pixel: [u32; 2]) -> Option<ProposalVertex> {
        let place = ctx.begin(pixel, 0);
        let raster = Vec2::new(pixel[0] as f32, pixel[1] as f32) + place;
        let mut draws = ctx.draws;
        let ray = self.view.ray(raster, &mut draws)?;
        let footprint = self.view.footprint(&ray, raster, ctx.draws).unwrap_or_default();
        let mut counting = Counting::new(ctx);
        let look =
            FirstDiffuseVisitor { last: Some(ray.o), ..FirstDiffuseVisitor::from_camera(self.even_sky) };
        let (_, look) = self.paths.observe_with(ctx, raster, &mut counting, look);
        ctx.rays = counting.rays;
        let mut seen = look.seen?;
        seen.pixel_size = footprint.at(look.length);
        (seen.pixel_size > 0.0 && seen.at.p.is_finite()).then_some(seen)
    }

    /// The record of a proposal, with its place and the size of a pixel there, and the rays that it took; none where it is of no use.
    fn record(&self, proposal: &Proposal) -> Result<(Option<MadeRecord>, RayCounters), SetupError> {
        let sampler = Sampler::new(SamplerKind::Sobol, 1);
        let mut ctx = SampleContext::new(&sampler, mix(self.setup.seed ^ SALTS[0]));
        let seen = self.look(&mut ctx, proposal.pixel);
        let Some(seen) = seen else { return Ok((None, ctx.rays)) };
        let mut counting = Counting::new(&ctx);
        let hemisphere = self.gather(&seen, proposal.pixel, &mut counting);
        let gathered = self.summary(&seen, &hemisphere);
        Ok((Some((seen.at, gathered, seen.pixel_size)), counting.rays))
    }

    /// Sends a ray into each stratum.
    fn gather(&self, seen: &ProposalVertex, pixel: [u32; 2], counting: &mut Counting<'_>) -> Hemisphere {
        let strata = self.strata;
        let sampler = Sampler::new(SamplerKind::Sobol, strata.len() as u32);
        let seed = mix(self.setup.seed ^ SALTS[1]);
        let frame = Frame::from_normal(seen.at.n);
        let rays = (0..strata.len()).map(|i| {
            let mut draws = SampleStream::new(&sampler, seed, pixel, i as u32);
            let d = strata.direction(i, draws.next_2d().as_dvec2().to_array());
            let (radiance, inverse_distance) =
                self.trace_incident(seen, frame.to_world(d.as_vec3()), draws, counting);
            RayResult { d, radiance: radiance.map(f64::from), inverse_distance: inverse_distance.into() }
        });
        Hemisphere { strata, rays: rays.collect() }
    }

    /// Follows a ray from a record: the light that comes along it but for direct light and caustics of all lights but an
    /// even sky, and one over the distance of what it comes from.
    fn trace_incident(
        &self,
        seen: &ProposalVertex,
        wi: Vec3,
        mut draws: SampleStream<'_>,
        counting: &mut Counting<'_>,
    ) -> ([f32; 3], f32) {
        let scene = self.view.scene;
        let point = &seen.surface.at.point;
        if wi.dot(point.ng) * seen.surface.wo.dot(point.ng) <= 0.0 {
            return ([0.0; 3], 0.0);
        }
        let ray: Ray = point.ray_towards(wi, f32::INFINITY, seen.time, RayOffset::Auto);
        let wavelengths = Wavelengths::RGB;
        let u = draws.number_if(scene.has_media());
        let mut state =
            PathState::new(ray, wavelengths, Spectrum::WHITE, Transport::Radiance, seen.media, draws);
        (state.scatterings, state.connectable) = (1, true);
        if scene.has_media() {
            state.carries_media = true;
            state.lanes = LaneMis::new(&wavelengths, u);
        }
        counting.counters().reflected += 1;
        let from = FromRecord { p: point.p, even_sky: self.even_sky, inverse_distance: 0.0, is_clear: true };
        let mut tracer = PathTracer::new(self.view, &self.path_settings, counting, from, Vec::new());
        let mut path = CameraPath::from_surface(state);
        path.ends_at_lights = self.settings.bounces == 0;
        let (radiance, _) = tracer.run(path);
        let (_, from) = tracer.into_parts();
        let is_finite = radiance.iter().all(|v| v.is_finite());
        (if is_finite { radiance } else { [0.0; 3] }, from.inverse_distance)
    }

    /// What is kept of a hemisphere.
    fn summary(&self, seen: &ProposalVertex, hemisphere: &Hemisphere) -> GatheredRecord {
        let derivatives = match self.settings.gradients {
            Gradients::Off => Derivatives::default(),
            Gradients::Strata => {
                Derivatives { gradient: hemisphere.gradient_of_strata(), ..Derivatives::default() }
            }
            Gradients::Occlusion => hemisphere.derivatives(),
        };
        let by_normal = match self.settings.gradients {
            Gradients::Off => [Vec2::ZERO; 3],
            _ => hemisphere.rotational_gradient().map(|gradient| gradient.as_vec2()),
        };
        let bends = self.settings.gradients == Gradients::Occlusion;
        let (values, axis) = if bends { eigenvalues(derivatives.hessian) } else { ([0.0; 2], 1.0) };
        let record = Record {
            p: seen.at.p,
            n: seen.at.n,
            irradiance: hemisphere.irradiance().map(|e| e as f32),
            by_normal,
            by_position: derivatives.gradient.map(|gradient| gradient.as_vec2()),
            radii: [0.0; 2],
            axis: axis as f32,
        };
        let [short, long] = values.map(|value| value.abs() as f32);
        let mean_distance = hemisphere.mean_distance() as f32;
        GatheredRecord { record, curvatures: bends.then_some([long, short]), mean_distance }
    }

    /// A record with its radii for this camera.
    ///
    /// * `pixel_size`: of a pixel there, in units of the world
    fn fitted(&self, gathered: &GatheredRecord, pixel_size: f32) -> Record {
        let mut record = gathered.record;
        let radii = self.radii(gathered, pixel_size);
        let [least, most] = RADII.map(|radius| radius * pixel_size);
        // Further away than this, light would be negative.
        let mean = (record.by_position[0] + record.by_position[1] + record.by_position[2]) / 3.0;
        let positive = record.mean() / mean.length();
        let positive = if positive.is_finite() { positive } else { f32::INFINITY };
        // Where a record has to hold further than it is good for, it is at least no further off than where it is.
        let held = radii[1].min(positive) / least;
        if held < 1.0 {
            record.by_position = record.by_position.map(|gradient| gradient * held);
        }
        record.radii = radii.map(|radius| radius.min(positive).clamp(least, most));
        record
    }

    /// How far a record is good for, the larger radius first.
    ///
    /// By the Hessian's eigenvalues `l`, with the irradiance `E` and the accuracy `a`,
    ///
    /// ```text
    /// R = (4 a E A / (pi |l|))^(1/4)                                      [Schwarzhaupt, Jensen and Jarosz 2012]
    /// ```
    ///
    /// so that the error of second order, `l x^2 / 2`, summed over the disk is that of `a E` over the area `A`: here a square of a tenth of the
    /// picture's height. Without a Hessian `a` times the harmonic mean of the distances around [Ward, Rubinstein and Clear 1988].
    fn radii(&self, gathered: &GatheredRecord, pixel_size: f32) -> [f32; 2] {
        let accuracy = self.settings.accuracy;
        let Some(curvatures) = gathered.curvatures else { return [accuracy * gathered.mean_distance; 2] };
        let side = SQUARE * self.view.size[1] as f32 * pixel_size;
        let allowed = 4.0 * std::f32::consts::FRAC_1_PI * accuracy * gathered.record.mean() * side * side;
        curvatures.map(|curvature| {
            let ratio = allowed / curvature;
            if ratio.is_finite() { ratio.sqrt().sqrt() } else { f32::INFINITY }
        })
    }

    /// How large a pixel is at a point, in units of the world, as for one in the middle of the picture; `None` where no ray goes through
    /// that.
    fn pixel_sizes(&self) -> Option<impl Fn(Vec3) -> f32> {
        let middle = self.view.size.map(|n| n / 2);
        let sampler = Sampler::new(SamplerKind::Sobol, 1);
        let mut ctx = SampleContext::new(&sampler, mix(self.setup.seed ^ SALTS[0]));
        let raster = Vec2::new(middle[0] as f32, middle[1] as f32) + ctx.begin(middle, 0);
        let mut draws = ctx.draws;
        let ray = self.view.ray(raster, &mut draws)?;
        let footprint = self.view.footprint(&ray, raster, ctx.draws)?;
        Some(move |p: Vec3| footprint.at(p.distance(ray.o)))
    }
}

/// Follows a path to the surface whose light is to be known.
pub struct FirstDiffuseVisitor {
    even_sky: Option<LightId>,
    /// Where the path has been last.
    last: Option<Vec3>,
    length: f32,
    seen: Option<ProposalVertex>,
}

impl FirstDiffuseVisitor {
    /// That of a path that begins.
    pub fn from_camera(even_sky: Option<LightId>) -> FirstDiffuseVisitor {
        FirstDiffuseVisitor { even_sky, last: None, length: 0.0, seen: None }
    }

    /// The position whose light was to be known.
    pub fn query(&self) -> Option<IrradianceQuery> {
        self.seen.as_ref().map(|seen| seen.at)
    }
}

impl IndirectLight for FirstDiffuseVisitor {
    const IS_ASKED: bool = true;

    fn irradiance(&mut self, vertex: &DiffuseVertex<'_, '_>) -> Indirect {
        let &DiffuseVertex { state, surface, n, relief } = vertex;
        let at = IrradianceQuery { p: surface.at.point.p, n, relief };
        self.seen = Some(ProposalVertex {
            surface: *surface,
            media: state.media,
            time: state.ray.time,
            at,
            pixel_size: 0.0,
        });
        Indirect::Unwanted
    }

    fn hit(&mut self, bounces: u32, p: Option<Vec3>) {
        if let Some(p) = p.filter(|_| bounces == 0) {
            self.length += self.last.map_or(0.0, |last| p.distance(last));
            self.last = Some(p);
        }
    }

    fn even_sky(&self) -> Option<LightId> {
        self.even_sky
    }
}

/// Watches a path that begins at a record.
struct FromRecord {
    p: Vec3,
    even_sky: Option<LightId>,
    inverse_distance: f32,
    /// Whether nothing but mirrors and glass was met.
    is_clear: bool,
}

impl IndirectLight for FromRecord {
    const IS_ASKED: bool = true;

    fn hit(&mut self, bounces: u32, p: Option<Vec3>) {
        if bounces == 1 {
            let inverse = p.map_or(0.0, |p| p.distance(self.p).recip());
            self.inverse_distance = if inverse.is_finite() { inverse } else { 0.0 };
        }
    }

    fn scatters(&mut self) {
        self.is_clear = false;
    }

    /// What comes straight from a light, or by way of mirrors and glass, is no indirect light.
    fn counts_lights(&self) -> bool {
        !self.is_clear
    }

    fn even_sky(&self) -> Option<LightId> {
        self.even_sky
    }
}
