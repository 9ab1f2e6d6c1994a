//! The phase function of [Draine 2003, eq. 4], Henyey and Greenstein's times `1 + alpha cos²`:
//!
//! ```text
//! p(cos) = (1 - g²) / (4π (1 + g² - 2 g cos)^(3/2)) · (1 + alpha cos²) / (1 + alpha (1 + 2g²)/3)
//! ```
//!
//! With `s = sqrt(1 + g² - 2 g cos)`, `A = 1 + g²` and `k = alpha / 4g²` the share of directions below a cosine is
//!
//! ```text
//! C (F(1 + g) - F(s)),     F(s) = k s³/3 - 2kA s - (1 + kA²) / s,     C = (1 - g²) / (2g (1 + alpha (1 + 2g²)/3))
//! ```
//!
//! `F` increases, so one `s` belongs to each share. It is a root of a polynomial of the fourth degree, whose closed form
//! [Jendersie and d'Eon 2023] cancels in places; Newton's method finds the same root to the last digits.

use super::HenyeyGreenstein;

/// Steps after which the bracket of the root is as narrow as numbers are, by halving alone.
const MOST_STEPS: u32 = 60;

/// A lobe forwards with a weaker one backwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draine {
    lobe: HenyeyGreenstein,
    alpha: f32,
}

impl Draine {
    /// The function of both parameters; `None` unless `g` is from 0.01 to 0.99 and `alpha` from 0 to 1000.
    pub fn new(g: f32, alpha: f32) -> Option<Draine> {
        let is_one = (0.01..=0.99).contains(&g) && (0.0..=1000.0).contains(&alpha);
        let lobe = HenyeyGreenstein::new(g).filter(|_| is_one)?;
        Some(Draine { lobe, alpha })
    }

    /// `1 + alpha (1 + 2g²)/3`.
    fn norm(&self) -> f32 {
        let g = self.lobe.g();
        1.0 + self.alpha * (1.0 + 2.0 * g * g) * (1.0 / 3.0)
    }

    /// The mean cosine.
    pub fn mean_cosine(&self) -> f32 {
        let g = self.lobe.g();
        g * (1.0 + self.alpha * (3.0 + 2.0 * g * g) * 0.2) / self.norm()
    }

    /// The value for the cosine of the angle by which light is turned.
    #[inline]
    pub fn at(&self, cos: f32) -> f32 {
        self.lobe.at(cos) * (1.0 + self.alpha * cos * cos) / self.norm()
    }

    /// A cosine for `u` in [0, 1), which grows with it.
    pub fn sample(&self, u: f32) -> f32 {
        let (g, alpha) = (f64::from(self.lobe.g()), f64::from(self.alpha));
        let (a, k) = (1.0 + g * g, alpha / (4.0 * g * g));
        let f = |s: f64| k * s * (s * s * (1.0 / 3.0) - 2.0 * a) - (1.0 + k * a * a) / s;
        let cos_of = |s: f64| (a - s * s) / (2.0 * g);
        let scale = (1.0 - g * g) / (2.0 * g * (1.0 + alpha * (1.0 + 2.0 * g * g) / 3.0));
        let (mut low, mut high) = (1.0 - g, 1.0 + g);
        let wanted = f(high) - f64::from(u) / scale;
        let mut s = (a - 2.0 * g * f64::from(self.lobe.sample(u))).max(0.0).sqrt().clamp(low, high);
        for _ in 0..MOST_STEPS {
            let above = f(s) - wanted;
            if above > 0.0 {
                high = s;
            } else {
                low = s;
            }
            let cos = cos_of(s);
            let newton = s - above * s * s / (1.0 + alpha * cos * cos);
            let next = if (low..=high).contains(&newton) { newton } else { 0.5 * (low + high) };
            let step = (next - s).abs();
            s = next;
            if step < 1e-9 {
                break;
            }
        }
        cos_of(s) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is drawn with `u` has the share `u` of all directions before it.
    #[test]
    fn cosines_are_drawn_by_the_inverse_of_their_distribution() {
        for (g, alpha) in [(0.01, 0.0), (0.5, 17.0), (0.62, 32.0), (0.3, 1000.0), (0.95, 2.0)] {
            let phase = Draine::new(g, alpha).unwrap();
            let n = 100_000;
            for u in [0.0f32, 0.001, 0.2, 0.5, 0.77, 0.999] {
                let cos = f64::from(phase.sample(u));
                let h = (cos + 1.0) / f64::from(n);
                let at = |k: i32| f64::from(phase.at((-1.0 + h * (f64::from(k) + 0.5)) as f32));
                let below = std::f64::consts::TAU * h * (0..n).map(at).sum::<f64>();
                assert!((below - f64::from(u)).abs() < 1e-5, "{g} {alpha} {u}: {below}");
            }
        }
    }

    #[test]
    fn without_its_second_factor_it_is_henyey_and_greensteins() {
        let (draine, lobe) = (Draine::new(0.7, 0.0).unwrap(), HenyeyGreenstein::new(0.7).unwrap());
        for i in 0..100 {
            let u = i as f32 / 100.0;
            assert!((draine.sample(u) - lobe.sample(u)).abs() < 1e-5, "{u}");
            assert_eq!(draine.at(2.0 * u - 1.0), lobe.at(2.0 * u - 1.0));
        }
        assert_eq!(draine.mean_cosine(), 0.7);
    }

    #[test]
    fn parameters_out_of_range_are_none() {
        for (g, alpha) in [(0.0, 1.0), (1.0, 1.0), (-0.5, 1.0), (f32::NAN, 1.0), (0.5, -1.0), (0.5, f32::NAN)]
        {
            assert_eq!(Draine::new(g, alpha), None, "{g} {alpha}");
        }
    }
}
