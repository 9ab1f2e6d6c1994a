//! The scenes and the formulas for their light.

mod bodies;
mod camera;
mod caustic;
mod curved;
mod drop;
mod flat;
mod glass;
mod gravity;
mod half_space;
mod lights;
mod materials;
mod media;
mod motion;
mod polygon;
mod quadrature;
mod rainbow;
mod relativity;
mod rooms;
mod solids;
mod surfaces;
mod tables;
mod textures;
mod weak_lenses;

use kajo_math::DVec3;

use super::estimate::Estimate;
use super::method::{MLT, MMLT, Method, SHARED};
use super::parameters::Parameters;

/// The least standard error of a mean of pictures by chains for each length, as a share of it: each picture begins with many samples of each length.
const STARTS: f64 = 2.5e-3;

/// A scene whose light has a closed form.
#[derive(Clone, Debug)]
pub struct Form {
    /// What is shown, with the numbers that were drawn.
    pub name: String,
    /// The scene file without its settings.
    pub scene: String,
    /// Files that it names.
    pub files: Vec<(String, String)>,
    /// How often light may be scattered between surfaces; as often as it likes where absent.
    pub bounces: Option<u32>,
    /// Other lines of its `Settings` that all methods share.
    pub settings: String,
    /// The pattern of samples.
    pub pattern: &'static str,
    /// Columns and rows of the picture.
    pub size: [u32; 2],
    /// The mean of the picture.
    pub expected: f64,
    /// Error that single precision alone may make, as a share of the value.
    pub rounding: f64,
    /// The least standard error that is asked for, as a share of the value: where each batch is uncertain by itself, whatever samples it has.
    pub least_noise: f64,
    /// Who can solve it.
    pub methods: &'static [Method],
}

impl Form {
    /// A scene that is seen through one pixel.
    pub fn new(name: impl Into<String>, scene: String, expected: f64, methods: &'static [Method]) -> Form {
        Form {
            name: name.into(),
            scene,
            files: Vec::new(),
            bounces: None,
            settings: String::new(),
            pattern: "sobol",
            size: [1, 1],
            expected,
            rounding: 2e-5,
            least_noise: 0.0,
            methods,
        }
    }

    /// With light that is scattered at most so often between surfaces.
    pub fn bounces(self, n: u32) -> Form {
        Form { bounces: Some(n), ..self }
    }

    /// With more settings.
    pub fn settings(self, settings: &str) -> Form {
        Form { settings: format!("{} {settings}", self.settings), ..self }
    }

    /// With samples of another pattern.
    pub fn pattern(self, pattern: &'static str) -> Form {
        Form { pattern, ..self }
    }

    /// With another error of single precision.
    pub fn rounding(self, rounding: f64) -> Form {
        Form { rounding, ..self }
    }

    /// With no smaller standard error than that.
    pub fn least_noise(self, least_noise: f64) -> Form {
        Form { least_noise, ..self }
    }

    /// With a picture of so many pixels.
    pub fn size(self, size: [u32; 2]) -> Form {
        Form { size, ..self }
    }

    /// The same by what keeps photons, vertices or records for a whole picture, which is to have some pixels for that.
    pub fn shared(&self) -> Form {
        self.by("photons and records", SHARED)
    }

    /// The same by Markov chains, each of which needs some pixels.
    pub fn chained(&self) -> Form {
        self.by("chains", &[MLT])
    }

    /// The same by chains for each length, which are to be few: light that is scattered `bounces` times is all that there is.
    pub fn chained_by_length(&self, bounces: u32) -> Form {
        let bounces = self.bounces.map_or(bounces, |own| own.min(bounces));
        Form { bounces: Some(bounces), settings: String::new(), ..self.clone() }
            .by("chains of lengths", &[MMLT])
            .least_noise(STARTS)
    }

    /// The same by these methods.
    fn by(&self, what: &str, methods: &'static [Method]) -> Form {
        Form { name: format!("{}, by {what}", self.name), methods, size: [32, 32], ..self.clone() }
    }

    /// With a file.
    pub fn file(mut self, name: &str, content: String) -> Form {
        self.files.push((name.to_owned(), content));
        self
    }
}

/// A number that the program knows from a table or a formula of its own.
#[derive(Clone, Debug)]
pub struct Number {
    /// What it is.
    pub name: String,
    /// What others publish.
    pub expected: f64,
    /// What the program says.
    pub measured: f64,
    /// How far they may be apart: half of the last digit that is published.
    pub tolerance: f64,
}

impl Number {
    /// The value as an estimate without noise.
    pub fn estimate(&self) -> Estimate {
        Estimate { mean: self.measured, standard_error: 0.0, samples: 0, is_sharp: true }
    }

    /// Whether `value` is what was expected.
    pub fn agrees(&self, value: f64) -> bool {
        (value - self.expected).abs() <= self.tolerance
    }
}

/// The scenes with the numbers that `seed` gives.
pub fn pictures(seed: u64) -> Vec<Form> {
    type Maker = fn(&mut Parameters) -> Vec<Form>;
    let makers: [(&str, Maker); 21] = [
        ("rooms", rooms::forms),
        ("lights", lights::forms),
        ("bodies", bodies::forms),
        ("polygons", polygon::forms),
        ("glass", glass::forms),
        ("caustics", caustic::forms),
        ("rainbow", rainbow::forms),
        ("drop", drop::forms),
        ("surfaces", surfaces::forms),
        ("flat", flat::forms),
        ("materials", materials::forms),
        ("media", media::forms),
        ("half space", half_space::forms),
        ("curved", curved::forms),
        ("gravity", gravity::forms),
        ("camera", camera::forms),
        ("motion", motion::forms),
        ("solids", solids::forms),
        ("relativity", relativity::forms),
        ("weak lenses", weak_lenses::forms),
        ("textures", textures::forms),
    ];
    makers.into_iter().flat_map(|(name, make)| make(&mut Parameters::new(seed, name))).collect()
}

/// The numbers of tables, and of formulas that no picture is needed for.
pub fn numbers() -> Vec<Number> {
    let mut numbers = tables::numbers();
    numbers.extend(relativity::numbers());
    numbers
}

/// A vector as the scene language writes it.
fn text(v: DVec3) -> String {
    let [x, y, z] = v.to_array().map(|x| x as f32);
    format!("{x} {y} {z}")
}

/// A black world seen through one pixel no wider than a hair, from `from` to `to`.
fn spot_meter(from: DVec3, to: DVec3) -> String {
    let d = to - from;
    let up = d.any_orthogonal_vector();
    format!(
        "PerspectiveCamera {{ center {}  direction {}  up {}  angle 0.001 }}\nBackground {{ color 0 0 0 }}\n",
        text(from),
        text(d),
        text(up)
    )
}

/// Materials of a matt surface of albedo `floor` and of a light of radiance `le`.
fn floor_and_light(floor: f64, le: f64) -> String {
    format!(
        "Materials {{\n  Material floor {{ diffuseColor {floor} {floor} {floor} }}\n  \
         Material black {{ diffuseColor 0 0 0 }}\n  \
         Material emitter {{ diffuseColor 0 0 0  emission {le} {le} {le} }}\n}}\n"
    )
}

/// A small round floor at the origin that faces along `n`.
fn floor(n: DVec3) -> String {
    format!("MaterialIndex floor Disk {{ center 0 0 0  normal {}  radius 0.01 }}", text(n))
}

/// A triangle.
fn triangle([a, b, c]: [DVec3; 3]) -> String {
    format!("Triangle {{ vertex0 {}  vertex1 {}  vertex2 {} }}", text(a), text(b), text(c))
}
