//! What `kajo selftest` does: scenes whose light is known in closed form, rendered and compared.
//!
//! Every row is a scene, written as text as a user would, whose radiance follows from a formula. Its free
//! numbers (places, albedos, indices, polygons) are drawn from a seed; the expected value is computed here, from the
//! formula, by code that shares nothing with the renderer. The scene is then read, compiled and rendered like any
//! other, by every integrator that can solve it. Of [`BATCHES`] independent renders with mean `m` and standard error
//! `s` a row demands for the expected value `mu`
//!
//! ```text
//! |m - mu| < 4 s    and    s < noise mu
//! ```
//!
//! since an estimate too noisy to be wrong proves nothing. Where a method may be off by itself, as tables of energies are, an eighth of that is
//! noise enough. With the full [`Effort`] the noise is 0.05 %, so that an
//! error of a quarter of a per cent is seen. Rows that fail are measured once more, with other random numbers and
//! half the noise, and the second answer counts: one right row in six thousand is off by 4 s by chance, but none is
//! off twice.
//!
//! Rows about tabulated numbers (indices of glasses, chromaticities) compare with published tables.
//!
//! How fast kajo is stands beside that, in [`mod@bench`].

pub mod bench;
mod estimate;
mod forms;
mod method;
mod parameters;

use estimate::{Estimate, Exposure, Target};
use forms::{Form, Number};

pub use estimate::BATCHES;

/// How precisely the rows are measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Largest standard error as a share of the expected value.
    pub noise: f64,
    /// Samples after which a row is given up as too noisy.
    pub most_samples: u64,
}

impl Effort {
    /// To half a per cent: ten minutes of one core.
    pub const QUICK: Effort = Effort { noise: 5e-3, most_samples: 1 << 24 };

    /// To a twentieth of a per cent: twelve hours of one core.
    pub const FULL: Effort = Effort { noise: 5e-4, most_samples: 1 << 30 };
}

/// How much noise a row may have for the error that its method is allowed: what is sharper than that shows nothing more.
const SHARE_OF_ROUNDING: f64 = 0.125;

/// A row that is still to be measured.
#[derive(Clone, Debug)]
pub struct Trial {
    /// What is shown, with the numbers that were drawn.
    pub name: String,
    /// The integrator and how it is set; `table` for numbers that no integrator makes.
    pub method: &'static str,
    kind: Kind,
}

#[derive(Clone, Debug)]
enum Kind {
    Picture { exposure: Box<Exposure>, expected: f64, rounding: f64, least_noise: f64 },
    Number(Number),
}

/// A row: what was expected, what came out, and what to think of it.
#[derive(Clone, Debug)]
pub struct Row {
    /// What was shown.
    pub name: String,
    /// The integrator and how it was set.
    pub method: &'static str,
    /// The value of the formula or the table.
    pub expected: f64,
    /// What the program says.
    pub measured: f64,
    /// Standard error of the measured value; 0 where nothing is random.
    pub sigma: f64,
    /// Camera rays it took.
    pub samples: u64,
    /// Whether they agree.
    pub verdict: Verdict,
}

/// What to think of a row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Expected and measured agree, and the measurement is sharp enough to mean something.
    Pass,
    /// They differ.
    Wrong,
    /// The measurement stayed too noisy within the samples allowed.
    Noisy,
    /// There is no picture, for this reason.
    Broken(String),
}

/// All rows, in the order in which they are shown; the same for the same seed.
pub fn trials(seed: u64) -> Vec<Trial> {
    let pictures = forms::pictures(seed).into_iter().flat_map(of_form);
    let numbers = forms::numbers().into_iter().map(|number| Trial {
        name: number.name.clone(),
        method: "table",
        kind: Kind::Number(number),
    });
    pictures.chain(numbers).collect()
}

/// The rows of one scene: one for each method that solves it.
fn of_form(form: Form) -> Vec<Trial> {
    let trial = |method: &method::Method| {
        let Form {
            name,
            scene,
            files,
            bounces,
            settings,
            pattern,
            size,
            expected,
            rounding,
            least_noise,
            ..
        } = form.clone();
        let bounces = bounces.map_or_else(String::new, |n| format!("bounces {n}"));
        let settings = format!("Settings {{ samples {pattern} 1 {bounces} {settings} {} }}", method.settings);
        let exposure = Exposure { text: format!("{scene}\n{settings}\n"), files, size };
        let kind = Kind::Picture { exposure: Box::new(exposure), expected, rounding, least_noise };
        Trial { name, method: method.name, kind }
    };
    form.methods.iter().map(trial).collect()
}

impl Trial {
    /// The scene that is rendered, as text; `None` for a number from a table.
    pub fn scene(&self) -> Option<&str> {
        match &self.kind {
            Kind::Picture { exposure, .. } => Some(&exposure.text),
            Kind::Number(_) => None,
        }
    }

    /// Measures the row.
    ///
    /// * `seed`: of the random numbers of the renders
    /// * `threads`: 0 for one on each core
    pub fn run(&self, seed: u64, effort: Effort, threads: usize) -> Row {
        match &self.kind {
            Kind::Number(number) => {
                self.row(number.expected, Ok(number.estimate()), |estimate| number.agrees(estimate.mean))
            }
            Kind::Picture { exposure, expected, rounding, least_noise } => {
                let target = |noise: f64| Target {
                    mu: *expected,
                    rounding: *rounding,
                    sigma: noise.max(SHARE_OF_ROUNDING * rounding).max(*least_noise) * expected.abs(),
                    most_samples: effort.most_samples,
                };
                let measure = |seed: u64, noise: f64| exposure.measure(seed, &target(noise), threads);
                let first = measure(seed, effort.noise);
                let agrees = |estimate: &Estimate| estimate.agrees(&target(effort.noise));
                let doubtful = first.as_ref().is_ok_and(|first| !agrees(first));
                let last = if doubtful { measure(!seed, 0.5 * effort.noise) } else { first };
                self.row(*expected, last, agrees)
            }
        }
    }

    fn row(&self, expected: f64, found: Result<Estimate, String>, agrees: impl Fn(&Estimate) -> bool) -> Row {
        let verdict = match &found {
            Err(reason) => Verdict::Broken(reason.clone()),
            Ok(estimate) if !agrees(estimate) => Verdict::Wrong,
            Ok(estimate) if !estimate.is_sharp => Verdict::Noisy,
            Ok(_) => Verdict::Pass,
        };
        let nothing = Estimate { mean: f64::NAN, standard_error: f64::NAN, samples: 0, is_sharp: false };
        let Estimate { mean, standard_error, samples, .. } = found.unwrap_or(nothing);
        Row {
            name: self.name.clone(),
            method: self.method,
            expected,
            measured: mean,
            sigma: standard_error,
            samples,
            verdict,
        }
    }
}

#[cfg(test)]
mod tests;
