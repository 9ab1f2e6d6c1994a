//! How many start samples each class of paths has, by a pilot.
//!
//! With `n_k` samples of class `k`, whose importance has the standard deviation `sigma_k`, the brightness `b` has the
//! variance `sum of sigma_k^2 / n_k`. Of all ways to share out `N` samples the least has
//!
//! ```text
//! n_k = N sigma_k / sum of sigma_j,    Var b = (sum of sigma_k)^2 / N            [Neyman 1934]
//! ```
//!
//! so that `N = (sum of sigma_k / (e b))^2` make the standard error the share `e` of `b`. `sigma_k` and `b` are those
//! of a pilot, samples of their own: some of each class first, and then as many more as it takes to have an eighth of
//! `N`, shared out in the same way. Light that a pilot has missed is looked for all the same, as an eighth of the
//! samples is shared out evenly.
//!
//! The samples of a pilot tell how many others there are, and nothing else. So the numbers `n_k` do not depend on the
//! samples whose means are taken, and these have no bias; a rule that stops by looking at the samples it averages has
//! one, since few bright samples make both the mean and its error look small.

/// Samples of each class that a pilot begins with.
const PILOT: u32 = 64;

/// The share of all samples that a pilot has, and of samples that are shared out evenly.
const SHARE: f64 = 0.125;

/// The standard error of the brightness that is aimed at, as a share of it: a quarter of a percent.
const TARGET: f64 = super::UNSURE / 8.0;

/// Number, sum and sum of squares of the importances of a class.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    pub n: u32,
    sum: f64,
    squares: f64,
}

impl Moments {
    /// Takes one more importance in.
    pub fn add(&mut self, importance: f64) {
        self.n += 1;
        self.sum += importance;
        self.squares += importance * importance;
    }

    /// The mean; 0 of nothing.
    pub fn mean(&self) -> f64 {
        self.sum / f64::from(self.n.max(1))
    }

    /// The variance of a sample.
    pub fn variance(&self) -> f64 {
        let mean = self.mean();
        (self.squares / f64::from(self.n.max(1)) - mean * mean).max(0.0)
    }

    /// The variance of the mean.
    pub fn variance_of_mean(&self) -> f64 {
        self.variance() / f64::from(self.n.max(1))
    }
}

/// Samples of all classes together that are needed, by what a pilot has found: between `fewest` and `most`, and `most` where it has found no light.
fn needed(pilot: &[Moments], [fewest, most]: [u32; 2]) -> u32 {
    let b = pilot.iter().map(Moments::mean).sum::<f64>();
    let sigma = pilot.iter().map(|class| class.variance().sqrt()).sum::<f64>();
    let needed = if b > 0.0 { (sigma / (TARGET * b)).powi(2) } else { f64::INFINITY };
    (needed.min(f64::from(most)) as u32).max(fewest)
}

/// `n` samples, and up to one more of each class, shared out by the spread of each.
fn allotted(n: u32, pilot: &[Moments]) -> Vec<u32> {
    let sigma = |class: &Moments| class.variance().sqrt();
    let all = pilot.iter().map(sigma).sum::<f64>();
    let even = 1.0 / pilot.len() as f64;
    let share = |class: &Moments| match all > 0.0 {
        true => SHARE * even + (1.0 - SHARE) * sigma(class) / all,
        false => even,
    };
    pilot.iter().map(|class| (f64::from(n) * share(class)).ceil() as u32).collect()
}

/// How many samples each of `classes` is to have.
///
/// * `limits`: the fewest and the most samples of all classes together, but for the roundings
/// * `more`: takes so many samples of each class, for a pilot, and adds them to its moments
///
/// # Errors
/// Those of `more`.
pub fn numbers<E>(
    classes: usize,
    limits: [u32; 2],
    mut more: impl FnMut(&[u32], &mut [Moments]) -> Result<(), E>,
) -> Result<Vec<u32>, E> {
    let mut pilot = vec![Moments::default(); classes];
    more(&vec![PILOT; classes], &mut pilot)?;
    loop {
        let needed = needed(&pilot, limits);
        let taken = pilot.iter().map(|class| class.n).sum::<u32>();
        let wanted = (SHARE * f64::from(needed)) as u32;
        if taken >= wanted {
            return Ok(allotted(needed, &pilot));
        }
        // At least twice as many, so that there are few rounds.
        more(&allotted((wanted - taken).max(taken), &pilot), &mut pilot)?;
    }
}
