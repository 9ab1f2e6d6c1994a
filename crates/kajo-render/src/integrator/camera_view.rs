//! The camera's part of an integrator: rays through positions of the picture, and what layers record of the first
//! surface.

use kajo_color::{RgbBasis, Spectrum, WavelengthChoice, Wavelengths, sensor};
use kajo_core::camera::{Camera, Connection, Raster};
use kajo_core::differential::{RayDifferential, sample_side};
use kajo_core::light::MAX_LIGHT_GROUPS;
use kajo_core::sampler::SampleStream;
use kajo_core::scene::{Immersion, Interaction, Scene};
use kajo_core::settings::Rules;
use kajo_math::rng::Stream;
use kajo_math::{Ray, Vec2, Vec3};

use super::transport::MediumStack;
use crate::context::Auxiliary;
use crate::{FirstHit, Layer, LayerSet};

/// A scene as a camera sees it in a picture of some size.
#[derive(Clone)]
pub(super) struct CameraView<'a> {
    pub scene: &'a Scene,
    pub camera: &'a Camera,
    /// Columns and rows of the picture.
    pub size: [u32; 2],
    /// How positions of the picture are counted.
    film: Raster,
    layers: LayerSet,
    /// Whether rays need a time.
    moves: bool,
    /// The moment of all rays, where they have one in common.
    moment: Option<f32>,
    /// Whether camera rays may start inside a medium, so that each has to ask.
    is_immersed: bool,
    /// How wavelengths are drawn, where light is followed by wavelength.
    spectral: Option<WavelengthChoice>,
}

/// How far the rays of neighbouring pixels are apart; by default not at all.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RayFootprint {
    /// Where they start, in world units.
    pub origin: f32,
    /// For each unit of length along them.
    pub direction: f32,
}

impl RayFootprint {
    /// Side of a pixel on a surface that faces the rays, in world units.
    ///
    /// * `length`: of the path from the camera
    pub fn at(self, length: f32) -> f32 {
        self.origin + length * self.direction
    }
}

/// The golden ratio less 1, the step of wavelengths.
pub(super) const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// A number in [0, 1) that all paths of pass `k` have in common: a multiple of `step`, without its whole part. Where no fraction is close to `step`, those of any
/// number of passes are spread evenly [Niederreiter 1992, 3.1].
///
/// * `seed`: of these numbers alone
/// * `step`: from pass to pass; another for each kind of number, so that they do not go together
pub(super) fn number_of_pass(seed: u64, k: u32, step: f64) -> f32 {
    let start = f64::from(Stream::new(seed, [0, 0], 0).uniform(0));
    let u = (start + f64::from(k) * step).fract();
    (u as f32).min(1.0 - f32::EPSILON)
}

impl<'a> CameraView<'a> {
    /// * `camera`: the scene's, or another one
    pub fn new(scene: &'a Scene, camera: &'a Camera, size: [u32; 2], layers: LayerSet) -> CameraView<'a> {
        let moves = scene.moves() || camera.moves();
        let film = raster(scene, camera, size);
        let (moment, is_immersed, spectral) = (None, false, None);
        CameraView { scene, camera, size, film, layers, moves, moment, is_immersed, spectral }.immersed()
    }

    /// The same with light that is followed by wavelength, or in red, green and blue.
    pub fn spectral(self, is_spectral: bool) -> CameraView<'a> {
        CameraView { spectral: is_spectral.then(|| self.scene.wavelength_choice()), ..self }
    }

    /// The same with rays that are all of one moment, in [0, 1] while the shutter is open, if any is given.
    pub fn at_moment(self, moment: Option<f32>) -> CameraView<'a> {
        CameraView { moment, ..self }
    }

    /// What a path carries.
    ///
    /// Takes a dimension where light is followed by wavelength.
    pub fn wavelengths(&self, draws: &mut SampleStream<'_>) -> Wavelengths {
        let u = draws.number_if(self.spectral.is_some());
        self.spectral.as_ref().map_or(Wavelengths::RGB, |choice| choice.sample(u))
    }

    /// What a path carries for a uniform `u` in [0, 1).
    pub fn wavelengths_at(&self, u: f32) -> Wavelengths {
        self.spectral.as_ref().map_or(Wavelengths::RGB, |choice| choice.sample(u))
    }

    /// What all paths of pass `k` carry whose vertices are joined with each other: one set of wavelengths, since paths of different ones cannot be.
    ///
    /// * `seed`: of these numbers alone
    pub fn wavelengths_of_pass(&self, seed: u64, k: u32) -> Wavelengths {
        self.wavelengths_at(number_of_pass(seed, k, GOLDEN))
    }

    /// How the ray of [`CameraView::ray`] and that of the next pixel in the row part; `None` where there is no such ray.
    ///
    /// * `draws`: as for the ray
    pub fn footprint(&self, ray: &Ray, raster: Vec2, mut draws: SampleStream<'_>) -> Option<RayFootprint> {
        let next = self.ray(raster + Vec2::X, &mut draws)?;
        Some(RayFootprint { origin: next.o.distance(ray.o), direction: next.d.distance(ray.d) })
    }

    /// The same, aware of whether camera rays may start in a medium.
    ///
    /// Where all start at one point, still as what is around it, one of them answers for all. Elsewhere each ray asks, but
    /// only if the box around all origins touches that of anything that light passes.
    fn immersed(self) -> CameraView<'a> {
        let film = &self.film;
        let size = Vec2::from(self.size.map(|n| n as f32));
        // Patterns of samples may hang over by a pixel.
        let corners = [Vec2::NEG_ONE, size + 1.0].map(|place| film.picture(place));
        let Some(origins) = self.camera.origins(corners, film.aspect()) else { return self };
        let is_immersed = match self.scene.geometry.immersion(&origins) {
            Immersion::Moving => true,
            _ if origins.min == origins.max && !self.camera.moves() => self.is_middle_immersed(),
            immersion => immersion == Immersion::Still,
        };
        CameraView { is_immersed, ..self }
    }

    /// Whether the ray through the middle of the picture starts in a medium.
    fn is_middle_immersed(&self) -> bool {
        let film = &self.film;
        let middle = Vec2::from(self.size.map(|n| 0.5 * n as f32));
        let ray = self.camera.ray(film.picture(middle), film.aspect(), Vec2::splat(0.5), 0.0);
        ray.is_some_and(|ray| !MediumStack::around(self.scene, &ray, &Wavelengths::RGB).is_empty())
    }

    /// The media around the start of a camera ray.
    #[inline]
    pub fn media_around(&self, ray: &Ray, wavelengths: &Wavelengths) -> MediumStack {
        if self.is_immersed {
            MediumStack::around(self.scene, ray, wavelengths)
        } else {
            MediumStack::air(self.scene)
        }
    }

    /// The camera ray through a position of the picture, in pixels from its top left corner; none where the camera
    /// shows nothing.
    ///
    /// Takes the dimensions of the lens and the time.
    pub fn ray(&self, raster: Vec2, draws: &mut SampleStream<'_>) -> Option<Ray> {
        let lens = draws.pair_if(self.camera.has_lens());
        let time = draws.number_if(self.moves);
        let film = &self.film;
        let at = film.picture(raster);
        self.camera.ray(at, film.aspect(), lens, self.time_at(at.y / film.scale(), time))
    }

    /// Where the camera is: the origin of the ray through the middle of the picture and of its lens.
    pub fn pivot(&self, time: f32) -> Option<Vec3> {
        let middle = Vec2::from(self.size.map(|n| 0.5 * n as f32));
        let ray = self.camera.ray(self.film.picture(middle), self.film.aspect(), Vec2::splat(0.5), time);
        ray.map(|ray| ray.o)
    }

    /// How the ray of [`CameraView::ray`] differs from those of neighbouring samples, [`sample_side`] of a pixel apart; `None` where nothing asks.
    ///
    /// * `draws`: as for the ray
    /// * `samples`: of a pixel
    #[inline]
    pub fn differential(
        &self,
        raster: Vec2,
        draws: SampleStream<'_>,
        samples: u32,
    ) -> Option<RayDifferential> {
        if !self.scene.wants_differentials() {
            return None;
        }
        Some(self.differences(raster, draws, sample_side(samples)))
    }

    /// Differences of rays half a footprint to both sides, which are the ends of it.
    ///
    /// * `side`: of a footprint, in pixels
    #[inline(never)]
    fn differences(&self, raster: Vec2, mut draws: SampleStream<'_>, side: f32) -> RayDifferential {
        let lens = draws.pair_if(self.camera.has_lens());
        let time = draws.number_if(self.moves);
        let film = &self.film;
        let time = self.time_at(film.picture(raster).y / film.scale(), time);
        let ray = |raster: Vec2| self.camera.ray(film.picture(raster), film.aspect(), lens, time);
        let Some(middle) = ray(raster) else { return RayDifferential::default() };
        let mut differential = RayDifferential::default();
        for (i, axis) in [Vec2::X, Vec2::NEG_Y].into_iter().enumerate() {
            let halves = [0.5, -0.5].map(|half| {
                let beside = ray(raster + half * side * axis)?;
                Some((half.signum() * (beside.o - middle.o), half.signum() * (beside.d - middle.d)))
            });
            // Beyond the edge of one of several pictures in one a ray is quite another.
            let (dp, dd) = match halves {
                [Some((o1, d1)), Some((o0, d0))] => match (d1.length(), d0.length()) {
                    (ahead, behind) if ahead > 2.0 * behind => (2.0 * o0, 2.0 * d0),
                    (ahead, behind) if behind > 2.0 * ahead => (2.0 * o1, 2.0 * d1),
                    _ => (o1 + o0, d1 + d0),
                },
                [Some((o, d)), None] | [None, Some((o, d))] => (2.0 * o, 2.0 * d),
                [None, None] => (Vec3::ZERO, Vec3::ZERO),
            };
            (differential.dp[i], differential.dd[i]) = (dp, dd);
        }
        differential
    }

    /// The moment of a ray within the shutter's interval. Rows open one after the other in the share `readout` of it, and
    /// each is open for the rest.
    ///
    /// * `y`: of picture coordinates, 1 at the top
    /// * `u`: uniform in [0, 1)
    #[inline]
    fn time_at(&self, y: f32, u: f32) -> f32 {
        if let Some(moment) = self.moment {
            return moment;
        }
        let readout = self.scene.output.readout;
        if readout == 0.0 {
            return u;
        }
        let row = (0.5 - 0.5 * y).clamp(0.0, 1.0);
        readout * row + (1.0 - readout) * u
    }

    /// A way from the world-space point `p` to the camera, and where in the picture it is seen; `None` where the camera
    /// cannot be connected with.
    ///
    /// * `lens`: uniform in [0, 1)²
    pub fn connect(&self, p: Vec3, lens: Vec2, time: f32) -> Option<(Connection, Vec2)> {
        let film = &self.film;
        let way = self.camera.connect(p, lens, film.aspect(), time).filter(|_| self.is_joined())?;
        Some((way, film.film_position(way.at.as_dvec2()).as_vec2()))
    }

    /// A point from which camera rays start; `None` for cameras without a lens, or where points cannot be
    /// connected with the camera.
    ///
    /// * `u`: uniform in [0, 1)²
    pub fn sample_origin(&self, u: Vec2, time: f32) -> Option<Vec3> {
        self.camera.sample_origin(u, self.film.aspect(), time).filter(|_| self.is_joined())
    }

    /// Density with which the camera casts the ray from `o` in direction `d`, over that with which [`CameraView::sample_origin`]
    /// draws `o`, which is one per solid angle, and where in the picture the ray is seen; `None` where it casts no such ray.
    pub fn pdf_from_origin(&self, o: Vec3, d: Vec3, time: f32) -> Option<(f32, Vec2)> {
        let film = &self.film;
        let seen = self.camera.importance(o, d, film.aspect(), time)?;
        let pdf = seen.pdf_area * seen.pdf_direction / seen.pdf_origin;
        Some((pdf, film.film_position(seen.at.as_dvec2()).as_vec2()))
    }

    /// Density per area across a camera ray with which [`CameraView::connect`] could have found it from `p`.
    pub fn pdf_across(&self, ray: &Ray, p: Vec3) -> Option<f32> {
        let film = &self.film;
        let pdf = self.camera.pdf_across(ray, p.distance(ray.o), film.aspect());
        pdf.filter(|pdf| pdf.is_finite() && *pdf > 0.0 && self.is_joined())
    }

    /// Whether points can be connected with the camera, as far as that is not up to the camera.
    fn is_joined(&self) -> bool {
        // Samples that lie on the picture's corners cover more than the film, as do picture coordinates of other scales.
        // Where rows open one after the other, a position seen at the moment of a path is not open then.
        let rolls = self.moves && self.scene.output.readout > 0.0;
        !self.film.corner_samples && self.film.scale() == 1.0 && !rolls
    }

    /// Whether the layers record albedos.
    pub fn wants_albedo(&self) -> bool {
        self.layers.has(Layer::Albedo)
    }

    /// Whether the layers tell the light of groups of lights apart.
    pub fn wants_light_groups(&self) -> bool {
        (0..MAX_LIGHT_GROUPS as u8).any(|group| self.layers.has(Layer::Light(group)))
    }

    /// What the layers record of the first surface; its motion goes to `aux`.
    pub fn first_hit(&self, at: &Interaction, aux: &mut Auxiliary) -> FirstHit {
        if self.moves && self.layers.has(Layer::Motion) {
            aux.motion = self.motion(at).unwrap_or_default().to_array();
        }
        let uv = if self.layers.has(Layer::Uv) { self.scene.geometry.uv(at) } else { Vec2::ZERO };
        let numbered = self.layers.has(Layer::MaterialId);
        let material = if numbered { self.scene.appearance.number(at.material) } else { 0 };
        FirstHit { t: at.hit.t, n: self.scene.shading(at, 0.5).n, uv, object: at.object.number(), material }
    }

    /// How far a point moves in the picture from the opening of the shutter to its closing, in pixels; none where
    /// the camera does not see it all the time.
    fn motion(&self, at: &Interaction) -> Option<Vec2> {
        let film = &self.film;
        let place = |time: f32| {
            let p = self.scene.geometry.point_at(at, time).as_dvec3();
            self.camera.project(p, film.aspect().into(), time).map(|at| film.film_position(at))
        };
        Some((place(1.0)? - place(0.0)?).as_vec2())
    }
}

/// How a camera counts the positions of a picture of this size.
fn raster(scene: &Scene, camera: &Camera, size: [u32; 2]) -> Raster {
    let Rules { corner_samples, spans_width, .. } = scene.output.rules;
    Raster { size, corner_samples, spans_width: spans_width && camera.has_extent() }
}

/// What the sensor has of white light that was weakened, in linear RGB; one in each channel for no weakening.
pub(super) fn in_white_light(factor: Spectrum, wavelengths: &Wavelengths) -> [f32; 3] {
    sensor::to_rgb(factor * RgbBasis::new(wavelengths).emission([1.0; 3]), wavelengths)
}
