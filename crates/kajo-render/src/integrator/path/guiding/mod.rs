//! Path guiding: directions drawn by where light has come from [Müller, Gross and Novák 2017], [Müller 2019].
//!
//! Before the picture is taken, photons and training paths are followed, which do not contribute to the picture. The
//! light that they find is recorded for the places and directions that it came from, in passes each of which is twice
//! as long as the one before, and is guided by what was learned by then. The picture's own paths go on, at surfaces
//! that reflect light into more than single directions, by a mixture of scattering and what is known of the place; its
//! share is that by which the paths of the last pass would have been the closest to the light. A light is drawn at
//! every vertex as ever.
//!
//! At a vertex the reflected light is the integral of `f |cos| Li` over directions. One direction estimates it, drawn
//! with the density per solid angle
//!
//! ```text
//! p(w) = a p_s(w) + (1 - a) p_g(w),        beta <- beta f |cos| / p(w)
//! ```
//!
//! of scattering, `p_s`, and of the guide of the cell that the vertex is in, `p_g`: piecewise constant on a tree of
//! squares, which map to the sphere by equal areas. The share `a` is chosen for each cell; see `collector.rs`. In MIS
//! weights against the draw of a light `p` stands in the place of `p_s`.
//!
//! What was learned is a function of the scene, the seed and the settings: records are summed in whole numbers, and trees change between
//! passes only. The paths of the picture are independent of the training paths, so that each of their samples is unbiased by itself.
//!
//! Where a guide is of no use the picture is taken without, and then it has the same bits as if none had been asked for.

mod collector;
mod field;
mod quadtree;
mod training;

use kajo_color::Spectrum;
use kajo_core::camera::Camera;
use kajo_core::light::LightVisibility;
use kajo_core::scene::Scene;
use kajo_math::{Vec2, Vec3, fmath};

use super::{GuidedDirection, IndirectLight, Path, PathSettings, Sampled, Worth, learned};
use crate::integrator::Integrator;
use crate::trail::PathObserver;
use crate::{LayerSet, PixelSample, RayCounters, SampleContext};
use crate::{SamplesPerState, Setup, SetupError, WithState};
use collector::{GuideRecord, LEAST_RECORDS};
use field::{Cell, Field};
use training::{LEAST_GAIN, Training};

/// Between which multiples of what a sample is expected to be a path is followed as it is.
const WINDOW: [f32; 2] = [1.0 / 3.0, 3.0];

/// The smallest chance to go on.
const LEAST_SURVIVAL: f32 = 0.1;

/// Branches of one split, of all splits of a sample, and splits that are open at a time.
const MOST_OF_SPLIT: u32 = 8;
const MOST_BRANCHES: u32 = 32;
const MOST_SPLITS: usize = 32;

/// The largest factor by which paths that a guide sends carry less than others.
const MOST_GAIN: f32 = 1e6;

/// A path tracer that is to be guided, before it has learned anything: it goes by scattering.
pub struct GuidedPath<'a> {
    path: Path<'a>,
    /// The same without layers.
    plain: Path<'a>,
    /// The gain of a guide that is of use, [`LEAST_GAIN`].
    least_gain: f64,
}

impl<'a> GuidedPath<'a> {
    /// The integrator for a picture of `size` pixels with these `layers`.
    pub fn through(
        camera: &'a Camera,
        scene: &'a Scene,
        settings: PathSettings,
        size: [u32; 2],
        layers: LayerSet,
    ) -> GuidedPath<'a> {
        let none = LayerSet::of(&[]);
        GuidedPath {
            path: Path::through(camera, scene, settings, size, layers),
            plain: Path::through(camera, scene, settings, size, none),
            least_gain: LEAST_GAIN,
        }
    }
}

impl Integrator for GuidedPath<'_> {
    /// A path as it goes by scattering: this is what debug rays show.
    fn observe<O: PathObserver>(
        &self,
        ctx: &mut SampleContext<'_>,
        pixel: [u32; 2],
        raster: Vec2,
        observer: &mut O,
    ) -> PixelSample {
        self.path.observe(ctx, pixel, raster, observer)
    }

    fn samples_per_state(&self) -> Option<SamplesPerState> {
        Some(SamplesPerState::All)
    }

    /// What is learned changes no mean.
    fn noise_is_known(&self) -> bool {
        true
    }

    fn with_state<'a>(&'a self, _k: u32, setup: &Setup<'_>) -> Result<WithState<'a>, SetupError> {
        let mut rays = RayCounters::default();
        let visibility = match self.path.learns_lights() {
            true => {
                let (visibility, cast) = learned::learn(&self.path, setup)?;
                rays += cast;
                Some(visibility)
            }
            false => None,
        };
        let outcome = Training::new(&self.plain, visibility.as_ref(), self.path.settings.training, setup)
            .learn(self.least_gain)?;
        rays += outcome.rays;
        let integrator = Box::new(TrainedPath { path: &self.path, visibility, field: outcome.field });
        Ok(WithState { integrator, rays, notes: outcome.notes })
    }
}

/// A path tracer with its guide.
struct TrainedPath<'a> {
    path: &'a Path<'a>,
    /// Which lights arrive, where lights are chosen by that.
    visibility: Option<LightVisibility>,
    /// None where that is of no use.
    field: Option<Field>,
}

impl Integrator for TrainedPath<'_> {
    fn observe<O: PathObserver>(
        &self,
        ctx: &mut SampleContext<'_>,
        _pixel: [u32; 2],
        raster: Vec2,
        observer: &mut O,
    ) -> PixelSample {
        let lights = self.path.lights_by(self.visibility.as_ref());
        match &self.field {
            None => self.path.observe_choosing(ctx, raster, observer, Sampled, lights).0,
            Some(field) => self.path.observe_choosing(ctx, raster, observer, Guide::new(field), lights).0,
        }
    }
}

/// The guide of one path: densities by where light has come from.
struct Guide<'f> {
    field: &'f Field,
    /// Where the path is, if it is guided there.
    at: Option<(u32, Cell)>,
    gain: f32,
    /// What the first place that is guided sends to the camera, as far as it is known.
    reference: Option<f32>,
    /// What is to be done with the path where it is.
    worth: Worth,
    /// Where it has split.
    forks: [Split; MOST_SPLITS],
    splits: usize,
    /// Branches that it may still split into.
    spare: u32,
    /// What is written down of the path.
    records: Option<Records>,
}

/// What is known of a path that is to be split.
#[derive(Clone, Copy, Default)]
struct Split {
    cell: u32,
    gain: f32,
}

/// What a training path records of the light that came to it.
#[derive(Default)]
struct Records {
    vertices: Vec<Vertex>,
    /// All light that the path has found, as the sum of its lanes.
    found: f64,
    /// Whether light that was scattered before is taken from the cells, and not from what the path finds.
    from_cells: bool,
    /// The sum of `found` times the logarithm of the gain at that time.
    nats: f64,
    /// What had been found when the path came to where it is.
    before: f64,
}

/// A direction that a path has taken.
struct Vertex {
    record: GuideRecord,
    /// What the path carried there, as the sum of its lanes.
    beta: f64,
    /// What it had found when it came there, by then, and when it came to the next vertex.
    before: f64,
    found: f64,
    until: Option<f64>,
    /// What the cell of the next vertex sends back.
    beyond: f64,
}

impl<'f> Guide<'f> {
    fn new(field: &'f Field) -> Guide<'f> {
        Guide {
            field,
            at: None,
            gain: 1.0,
            reference: None,
            worth: Worth::Unknown,
            forks: [Split::default(); MOST_SPLITS],
            splits: 0,
            spare: MOST_BRANCHES,
            records: None,
        }
    }

    /// What is to be done with a path, by what it is expected to add beside what the whole sample is [Vorba and Křivánek 2016].
    ///
    /// * `beta`: what it carries, as the sum of its lanes
    fn worth_of(&mut self, beta: f32, known: &Cell) -> Worth {
        if known.guide.is_none() || known.known.effective() < LEAST_RECORDS {
            return Worth::Unknown;
        }
        let reference = *self.reference.get_or_insert(beta * (known.light + known.direct));
        let ratio = beta * known.light / reference;
        if ratio < WINDOW[0] {
            return Worth::Survives((ratio / WINDOW[0]).max(LEAST_SURVIVAL));
        }
        if ratio > WINDOW[1] && self.splits < MOST_SPLITS {
            let n = (ratio as u32).min(self.spare + 1).min(MOST_OF_SPLIT);
            self.spare -= n.max(1) - 1;
            return Worth::Splits(n.max(1));
        }
        if ratio.is_nan() { Worth::Unknown } else { Worth::Splits(1) }
    }
}

impl Records {
    fn new(from_cells: bool) -> Records {
        Records { from_cells, ..Records::default() }
    }

    fn push(&mut self, record: GuideRecord, beta: Spectrum) {
        let found = self.found;
        if let Some(last) = self.vertices.last_mut().filter(|_| self.from_cells) {
            last.until = Some(found);
        }
        let before = self.before;
        self.vertices.push(Vertex { record, beta: sum_of(beta), before, found, until: None, beyond: 0.0 });
    }

    /// The records of a path that has ended; none are left.
    fn take(&mut self) -> impl Iterator<Item = GuideRecord> {
        let found = std::mem::take(&mut self.found);
        (self.nats, self.before) = (0.0, 0.0);
        let share = |light: f64, beta: f64| {
            let share = (light / beta).max(0.0) as f32;
            if share.is_finite() { share } else { 0.0 }
        };
        self.vertices.drain(..).map(move |v| GuideRecord {
            x: share(v.until.unwrap_or(found) - v.found + v.beyond, v.beta),
            direct: share(v.found - v.before, v.beta),
            ..v.record
        })
    }
}

fn sum_of(light: Spectrum) -> f64 {
    [0, 1, 2, 3].into_iter().map(|lane| f64::from(light[lane])).sum()
}

impl IndirectLight for Guide<'_> {
    const IS_ASKED: bool = false;

    const GUIDES: bool = true;

    #[inline]
    fn comes_to(&mut self, p: Vec3, n: Vec3, beta: Spectrum) {
        let cell = self.field.cell(p, n);
        let known = self.field.cells[cell as usize];
        self.at = Some((cell, known));
        let beta = sum_of(beta);
        match &mut self.records {
            Some(records) => {
                records.before = records.found;
                if records.from_cells
                    && let Some(last) = records.vertices.last_mut()
                {
                    last.beyond = beta * f64::from(known.light);
                }
            }
            None => self.worth = self.worth_of(beta as f32, &known),
        }
    }

    #[inline]
    fn comes_to_unguided(&mut self) {
        self.at = None;
        self.worth = Worth::Unknown;
    }

    #[inline]
    fn share_of_scattering(&self) -> Option<f32> {
        self.at.map(|(_, cell)| cell.share)
    }

    #[inline]
    fn mixed(&self, w: Vec3, by_scattering: f32) -> (f32, f32) {
        let Some((_, Cell { guide: Some(guide), share, .. })) = self.at else { return (by_scattering, 0.0) };
        if share >= 1.0 && self.records.is_none() {
            return (by_scattering, 0.0);
        }
        let by_guide = quadtree::density(&self.field.nodes, guide, quadtree::to_square(w));
        (share * by_scattering + (1.0 - share) * by_guide, by_guide)
    }

    #[inline]
    fn draw(&self, u: Vec2) -> (Vec3, f32) {
        let Some((_, Cell { guide: Some(guide), .. })) = self.at else { return (Vec3::Z, 0.0) };
        let (position, density) = quadtree::sample(&self.field.nodes, guide, u);
        (quadtree::from_square(position), density)
    }

    fn leaves(&mut self, by: &GuidedDirection) {
        let &GuidedDirection { w, p, p_scattering, p_guide, beta } = by;
        let ratio = p / p_scattering;
        self.gain = (self.gain * if ratio.is_nan() { 1.0 } else { ratio }).min(MOST_GAIN);
        if let (Some(records), Some((cell, _))) = (&mut self.records, self.at) {
            let position = w.map(quadtree::to_square);
            records.push(GuideRecord { cell, position, p, p_scattering, p_guide, x: 0.0, direct: 0.0 }, beta);
        }
    }

    fn fails(&mut self, beta: Spectrum) {
        if let (Some(records), Some((cell, _))) = (&mut self.records, self.at) {
            let (position, p, p_scattering, p_guide) = (None, 1.0, 1.0, 1.0);
            records.push(GuideRecord { cell, position, p, p_scattering, p_guide, x: 0.0, direct: 0.0 }, beta);
        }
    }

    fn gain(&self) -> f32 {
        self.gain
    }

    #[inline]
    fn worth(&self) -> Worth {
        self.worth
    }

    fn forks(&mut self) {
        if let Some((cell, _)) = self.at {
            self.forks[self.splits] = Split { cell, gain: self.gain };
        }
        self.splits += 1;
    }

    fn takes_branch(&mut self, is_last: bool) {
        let Split { cell, gain } = self.forks[self.splits - 1];
        self.at = Some((cell, self.field.cells[cell as usize]));
        self.gain = gain;
        // The branches together are worth what the path was, whatever the last one came to.
        self.worth = Worth::Splits(1);
        if is_last {
            self.splits -= 1;
        }
    }

    fn finds(&mut self, light: Spectrum) {
        if let Some(records) = &mut self.records {
            let light = sum_of(light);
            records.found += light;
            records.nats += light * f64::from(fmath::ln(self.gain));
        }
    }
}

#[cfg(test)]
mod tests;
