//! A render in units of work that several programs do, on one machine or on many.
//!
//! A unit is a rectangle of pixels and a range of samples. Each is rendered into a film of its own; films add up to
//! that of the whole picture exactly, however it was cut. Some renders have several stages, between which the whole
//! picture decides on what follows; see [`Position::stage`].

use std::io::{self, Read, Write};
use std::ops::Range;

use kajo_render::schedule::Unit;
use kajo_render::{Film, FilmSpec, Goal, Position, Progress, Rect, RenderStats};

use crate::SceneDigest;
use crate::checkpoint::Identity;
use crate::render::{self, failed};
use crate::{Picture, RenderError, RenderRequest};

/// Some pixels and some of their samples.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WorkUnit {
    /// Pixels.
    pub tile: Rect,
    /// Samples in the order in which they are taken.
    pub samples: Range<u32>,
}

/// A render that is cut into units of work.
#[derive(Debug)]
pub struct SplitRender<'a> {
    request: RenderRequest<'a>,
    goal: Goal,
    spec: FilmSpec,
    identity: Identity,
}

impl<'a> SplitRender<'a> {
    /// What is to be rendered, until the goal is reached.
    ///
    /// * `goal`: its time and its interval are left aside: they are of one machine's clock
    /// * `scene`: what the scene was read from
    ///
    /// # Errors
    /// As [`render_passes`](crate::render_passes).
    pub fn new(
        request: &RenderRequest<'a>,
        goal: &Goal,
        scene: SceneDigest,
    ) -> Result<SplitRender<'a>, RenderError> {
        let goal = Goal { time: None, interval: None, ..*goal };
        let spec = request.spec_of_passes(&goal)?;
        request.check_memory(&spec)?;
        let identity =
            Identity::new(scene, (request.scene, request.camera()), request.settings, &spec, &goal);
        Ok(SplitRender { request: *request, goal, spec, identity })
    }

    /// Everything that decides a bit of the picture, in lines, of which the first names the program.
    pub fn identity(&self) -> String {
        let Goal { noise, .. } = self.goal;
        let number = self.request.settings.samples.1;
        format!("{}\nsamples {number}\nnoise {noise:?}", self.identity.whole_text())
    }

    /// The first line in which the identity of another render differs: its line, and that of this one.
    pub fn difference(&self, other: &str) -> Option<(String, String)> {
        let mine = self.identity();
        let (build, rest) = mine.split_once('\n').unwrap_or((&mine, ""));
        let (other_build, other_rest) = other.split_once('\n').unwrap_or((other, ""));
        if build != other_build {
            return Some((other_build.to_owned(), build.to_owned()));
        }
        Identity::of_text(rest).difference(other_rest)
    }

    /// The pixels that samples are taken of.
    pub fn sampled(&self) -> Rect {
        self.spec.sampled(&self.request.settings.sampler())
    }

    /// Whether samples bring light to pixels anywhere in the picture, so that units are best whole pictures of few
    /// samples.
    pub fn splats(&self) -> bool {
        self.request.settings.integrator.splats
    }

    /// About how many bytes a full film takes.
    pub fn bytes(&self) -> u128 {
        self.spec.bytes()
    }

    /// A film without samples.
    ///
    /// # Errors
    /// When there is no memory for it.
    pub fn new_film(&self) -> Result<Film, RenderError> {
        render::new_film(self.spec)
    }

    /// Reads a film that [`Film::save`] wrote.
    ///
    /// # Errors
    /// Those of `input`; `InvalidData` when it is no film of this render.
    pub fn restore_film(&self, input: &mut dyn Read) -> io::Result<Film> {
        Film::restore(self.spec, u64::MAX, input)
    }

    /// The samples of the stage that begins at `position`; `None` when there is nothing left to do.
    pub fn stage(&self, position: &Position) -> Option<Range<u32>> {
        position.stage(&self.schedule(), &self.goal)
    }

    /// Goes on to the next stage once a film has all of this one. Returns whether the render is complete.
    pub fn end_stage(&self, position: &mut Position, film: &Film) -> bool {
        position.end_stage(film, &self.schedule(), &self.goal)
    }

    /// Writes where a stage begins.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn save_position(&self, position: &Position, out: &mut dyn Write) -> io::Result<()> {
        position.save(out)
    }

    /// Reads what [`SplitRender::save_position`] wrote.
    ///
    /// # Errors
    /// Those of `input`; `InvalidData` when it holds something else.
    pub fn restore_position(&self, input: &mut dyn Read) -> io::Result<Position> {
        let film = Film::new(self.spec, u64::MAX).map_err(|error| io::Error::other(error.to_string()))?;
        Position::restore(&film, &self.schedule(), input)
    }

    /// Renders a unit of the stage that begins at `position` into a film of its own.
    ///
    /// # Errors
    /// As [`render`](crate::render()); nothing is kept of a unit that was not finished.
    pub fn render(
        &self,
        position: &Position,
        unit: &WorkUnit,
        progress: &dyn Progress,
    ) -> Result<(Film, RenderStats), RenderError> {
        let film = self.new_film()?;
        let integrator = self.request.integrator(self.spec.layers);
        let unit = Unit { tile: unit.tile, samples: unit.samples.clone(), limits: Unit::UNLIMITED };
        let result =
            kajo_render::render_work_unit(&*integrator, &film, &self.schedule(), position, &unit, progress);
        match result {
            Ok(stats) => Ok((film, stats)),
            Err(error) => Err(failed(error, |stats| self.picture(film, stats))),
        }
    }

    /// The picture that a film holds.
    pub fn picture(&self, film: Film, stats: RenderStats) -> Picture {
        let stats = RenderStats { non_finite: film.non_finite(), ..stats };
        self.request.picture(film, None, stats)
    }

    fn schedule(&self) -> kajo_render::RenderSettings {
        self.request.schedule(&self.spec)
    }
}
