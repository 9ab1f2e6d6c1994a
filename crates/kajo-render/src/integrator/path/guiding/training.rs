//! The training of a guide.
//!
//! Photons come first: where they arrive, of light that connections with a light do not find, is where paths should look. Then paths are
//! followed in passes, pass `k` with `2^k` times as many as the first, spread over the whole picture. The first goes by scattering, and
//! records how much light surfaces send back; each other one is guided by the records of all before it. Between passes
//! squares and cells are divided where much was found.
//!
//! Along a path the mixture's densities over those of scattering multiply to the *gain* `g`. Its logarithm, weighed by the light that is found,
//!
//! ```text
//! sum of L ln g / sum of L
//! ```
//!
//! is how much closer, by the Kullback-Leibler divergence, the paths' density is to the light that they carry than that of paths by
//! scattering [Müller 2019, 10.1]. It is known well long before the variance is, which rare paths decide. Where it is small after the second guided
//! pass or after the last, the guide is not worth the time that it takes.

use kajo_core::light::LightVisibility;
use kajo_core::sampler::{Sampler, SamplerKind};
use kajo_math::rng::mix;
use kajo_math::{Vec2, Vec3};

use super::collector::{Collector, divide};
use super::field::Field;
use super::{Guide, Records, quadtree, sum_of};
use crate::integrator::path::Path;
use crate::integrator::photon::emission::{PhotonEmission, PhotonRequest, Wanted};
use crate::integrator::photon_map::Photon;
use crate::trail::Counting;
use crate::{RayCounters, SampleContext, Setup, SetupError};

/// Sets the numbers of these paths apart from all others.
const SALT: u64 = 0x6775_6964_6573;

/// Passes: the last one has `2^(PASSES - 1)` times the paths of the first.
pub const PASSES: u32 = 6;

/// The pass after which a guide is judged, as it is after the last one.
const JUDGED: u32 = 2;

/// Paths of the first pass without which nothing can be learned.
const FEWEST: u64 = 1 << 8;

/// Paths of one task.
const PATHS_OF_TASK: u64 = 1 << 12;

/// Paths by which the size of records is found.
const PROBES: u64 = 1 << 12;

/// Paths of photons for each path of the first pass, and how many there are at most.
const PHOTON_PATHS: u64 = 2;
const MOST_PHOTON_PATHS: u64 = 1 << 20;

/// Memory that the photons of a path may take.
const BYTES_OF_PHOTON_PATH: u64 = 1 << 10;

/// Photons that a cell may have.
const PHOTONS_OF_CELL: f32 = 400.0;

/// How often cells are divided by their photons.
const ROUNDS: u32 = 6;

/// Effective records of the first pass after which a cell is divided; in others so many times the root of the number of their paths over that of
/// the first.
const MOST_EFFECTIVE: f32 = 50.0;

/// What the mean logarithm of the gain has to be after the second guided pass, and after the last.
pub const LEAST_GAIN: f64 = 0.1;

/// What the training has made.
pub struct TrainingOutcome {
    /// None where it is of no use.
    pub field: Option<Field>,
    /// Rays that it took.
    pub rays: RayCounters,
    /// Notes for the user.
    pub notes: Vec<String>,
}

/// The training passes before a render.
pub struct Training<'t, 'a> {
    path: &'t Path<'a>,
    /// Which lights arrive, where lights are chosen by that.
    visibility: Option<&'t LightVisibility>,
    /// Paths of the first pass.
    first: u64,
    setup: &'t Setup<'t>,
}

/// Which paths a pass follows.
struct TrainingPass {
    /// Sets the random numbers of passes apart.
    k: u32,
    /// How many at least.
    paths: u64,
}

/// Sums over all paths of a pass, or of a task of it.
#[derive(Clone, Copy, Default)]
struct PassTotals {
    rays: RayCounters,
    /// All light, and that times the logarithm of the gain.
    light: f64,
    nats: f64,
    /// The sum of `x` of all records with any light, and their number.
    x: f64,
    records: u64,
}

impl<'t, 'a> Training<'t, 'a> {
    /// * `path`: of a picture without layers
    /// * `samples`: of each pixel, for all passes together
    pub fn new(
        path: &'t Path<'a>,
        visibility: Option<&'t LightVisibility>,
        samples: u32,
        setup: &'t Setup<'t>,
    ) -> Training<'t, 'a> {
        let [width, height] = path.view.size;
        let pixels = u64::from(width) * u64::from(height);
        let first = pixels * u64::from(samples) / ((1 << PASSES) - 1);
        Training { path, visibility, first, setup }
    }

    /// Takes all passes, or those after which it is clear that they are of no use.
    ///
    /// * `least_gain`: [`LEAST_GAIN`]
    ///
    /// # Errors
    /// [`SetupError`]
    pub fn learn(&self, least_gain: f64) -> Result<TrainingOutcome, SetupError> {
        let mut outcome = TrainingOutcome { field: None, rays: RayCounters::default(), notes: Vec::new() };
        if self.first < FEWEST {
            outcome.notes.push(
                "too few samples for a guide to learn from: directions are drawn by scattering".to_owned(),
            );
            return Ok(outcome);
        }
        let mut field = Field::new(self.path.view.scene.geometry.bounds());
        let probe = TrainingPass { k: PASSES, paths: PROBES.min(self.first) };
        let probe = self.pass(&field, None, probe)?;
        outcome.rays += probe.rays;
        let unit = probe.x / probe.records as f64;
        if !(unit.is_finite() && unit > 0.0) {
            outcome.notes.push("no path has found any light that a guide could learn from".to_owned());
            return Ok(outcome);
        }
        let (photons, rays) = self.ask_photons(&mut field, unit)?;
        outcome.rays += rays;
        // The first pass goes by scattering alone, whatever photons have recorded.
        field.cells.iter_mut().for_each(|cell| cell.share = 1.0);
        let mut effective = Vec::new();
        for k in 0..PASSES {
            let most = MOST_EFFECTIVE * ((1u32 << k) as f32).sqrt();
            if !effective.is_empty() {
                divide(&mut field, &effective, most, self.setup.memory);
            }
            let collector = Collector::new(&field, unit);
            let found = self.pass(&field, Some(&collector), TrainingPass { k, paths: self.first << k })?;
            outcome.rays += found.rays;
            let is_judged = k == JUDGED || k + 1 == PASSES;
            if is_judged && (found.gain() < least_gain || found.gain().is_nan()) {
                outcome.notes.push(
                    "a guide would not make this picture less noisy: directions are drawn by scattering"
                        .to_owned(),
                );
                return Ok(outcome);
            }
            let photons = photons.as_ref().map(|photons| photons.sort(&field));
            collector.update_field(&mut field, photons.as_ref());
            effective.clear();
            effective.extend(field.cells.iter().map(|cell| cell.known.effective()));
        }
        outcome.field = Some(field);
        Ok(outcome)
    }

    /// Lets photons tell where light comes from that connections do not find; returns them and the rays that they took.
    fn ask_photons(
        &self,
        field: &mut Field,
        unit: f64,
    ) -> Result<(Option<Photons>, RayCounters), SetupError> {
        let (view, settings, memory) = (&self.path.view, &self.path.settings, self.setup.memory);
        let paths = (PHOTON_PATHS * self.first).min(MOST_PHOTON_PATHS).min(memory / BYTES_OF_PHOTON_PATH);
        let emission = PhotonEmission::new(view.scene, paths as u32, settings.bounces, settings.roulette);
        if paths == 0 || !emission.has_light() {
            return Ok((None, RayCounters::default()));
        }
        let setup = Setup { seed: mix(self.setup.seed ^ SALT), ..*self.setup };
        let wanted = PhotonRequest { map: Wanted::Indirect, caustics: false, in_media: None, beams: None };
        let batch = emission.emit(0, &view.wavelengths_at(0.5), wanted, &setup)?;
        let sum: f64 = batch.photons.iter().map(|photon| sum_of(photon.power())).sum();
        let photons = Photons { unit: sum / batch.photons.len() as f64, photons: batch.photons };
        if !(photons.unit.is_finite() && photons.unit > 0.0) {
            return Ok((None, batch.rays));
        }
        for _ in 0..ROUNDS {
            let mut counts = vec![0.0; field.cells.len()];
            photons.photons.iter().for_each(|photon| counts[cell_of(field, photon) as usize] += 1.0);
            divide(field, &counts, PHOTONS_OF_CELL, memory);
        }
        // Trees as fine as what they hold asks for.
        for _ in 0..2 {
            let sorted = photons.sort(field);
            Collector::new(field, unit).update_field(field, Some(&sorted));
        }
        Ok((Some(photons), batch.rays))
    }

    /// Follows paths.
    ///
    /// * `collector`: where records go
    fn pass(
        &self,
        field: &Field,
        collector: Option<&Collector>,
        TrainingPass { k, paths: n }: TrainingPass,
    ) -> Result<PassTotals, SetupError> {
        let [width, height] = self.path.view.size.map(u64::from);
        let pixels = width * height;
        let rounds = n.div_ceil(pixels);
        let of_round = n.div_ceil(rounds);
        let sampler = Sampler::new(SamplerKind::Sobol, rounds as u32);
        let seed = mix(self.setup.seed ^ SALT ^ u64::from(k));
        let paths = rounds * of_round;
        let tasks = self.setup.tasks(paths.div_ceil(PATHS_OF_TASK) as u32, |task| {
            let mut ctx = SampleContext::new(&sampler, seed);
            let mut found = PassTotals::default();
            let mut records = Records::new((2..PASSES).contains(&k));
            let begin = u64::from(task) * PATHS_OF_TASK;
            for i in begin..(begin + PATHS_OF_TASK).min(paths) {
                // Those of a round are spread evenly over the pixels.
                let at = (2 * (i % of_round) + 1) * pixels / (2 * of_round);
                let pixel = [(at % width) as u32, (at / width) as u32];
                let place = ctx.begin(pixel, (i / of_round) as u32);
                let raster = Vec2::new(pixel[0] as f32, pixel[1] as f32) + place;
                let mut counting = Counting::new(&ctx);
                let guide = Guide { records: Some(records), ..Guide::new(field) };
                let lights = self.path.lights_by(self.visibility);
                let (_, guide) = self.path.observe_choosing(&mut ctx, raster, &mut counting, guide, lights);
                ctx.rays = counting.rays;
                records = guide.records.unwrap_or_default();
                found.light += records.found;
                found.nats += records.nats;
                for record in records.take() {
                    if record.x > 0.0 {
                        found.x += f64::from(record.x);
                        found.records += 1;
                    }
                    if let Some(collector) = collector {
                        collector.add(&record);
                    }
                }
            }
            Ok(PassTotals { rays: ctx.rays, ..found })
        })?;
        let mut all = PassTotals::default();
        for task in tasks {
            all.rays += task.rays;
            all.light += task.light;
            all.nats += task.nats;
            all.x += task.x;
            all.records += task.records;
        }
        Ok(all)
    }
}

impl PassTotals {
    /// The mean logarithm of the gain; not a number without any light.
    fn gain(&self) -> f64 {
        self.nats / self.light
    }
}

/// Photons that tell of light.
struct Photons {
    photons: Vec<Photon>,
    /// Their mean power, as the sum of its lanes.
    unit: f64,
}

impl Photons {
    /// What they say of the cells of a field.
    fn sort(&self, field: &Field) -> Collector {
        let collector = Collector::new(field, self.unit);
        for photon in &self.photons {
            let position = quadtree::to_square(photon.wi());
            collector.add_photon(cell_of(field, photon), position, sum_of(photon.power()) as f32);
        }
        collector
    }
}

fn cell_of(field: &Field, photon: &Photon) -> u32 {
    field.cell(photon.p(), lit_side(photon))
}

/// The normal of the surface on the side that a photon came to.
fn lit_side(photon: &Photon) -> Vec3 {
    let n = photon.n();
    if n.dot(photon.wi()) < 0.0 { -n } else { n }
}
