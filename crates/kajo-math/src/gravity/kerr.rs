//! The metric of a rotating black hole, and light in it.
//!
//! In Kerr-Schild coordinates `(t, x, y, z)` a hole of mass `M` and angular momentum `a M` about the z axis has the metric
//!
//! ```text
//! g_mn = eta_mn + f k_m k_n,    g^mn = eta^mn - f k^m k^n
//! f = 2 M r³ / (r⁴ + a² z²)
//! k_m = (1, (r x + a y)/(r² + a²), (r y - a x)/(r² + a²), z/r),    k^m = (-1, k_x, k_y, k_z)
//! r⁴ - (x² + y² + z² - a²) r² - a² z² = 0
//! ```
//!
//! with `eta = diag(-1, 1, 1, 1)` [Kerr and Schild 1965], [Visser 2007, eqs. 33 to 36]. The vector `k` is null and points
//! inwards along light that falls in. There is no pole, and nothing happens at the horizon `r = M + sqrt(M² - a²)` when it is
//! crossed inwards. What rests in these coordinates far away rests with respect to the stars.
//!
//! Light follows the equations of Hamilton of `H = g^mn p_m p_n / 2 = 0`. With `E = -p_t` and `s = k^m p_m = E + k·p`:
//!
//! ```text
//! dx/dλ = p - f s k
//! dp/dλ = s² ∇f / 2 + f s p_j ∇k_j
//! ```
//!
//! **Light is followed backwards.** A camera asks where light has come from. Followed into the past it piles up on the horizon of these
//! coordinates, which are smooth for what falls in. So time is turned around: the movie of light, run backwards, is light that leaves the
//! camera into the future, around a hole that spins the other way. For light from the past, callers hand in the opposite spin and the opposite
//! velocity of everything that moves.

use crate::DVec3;

/// A black hole at the origin that spins about the z axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kerr {
    mass: f64,
    spin: f64,
}

/// What the metric is at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KerrMetric {
    /// The radial coordinate of Boyer and Lindquist, constant on oblate spheroids.
    pub r: f64,
    /// By how much the metric departs from that of flat spacetime.
    pub f: f64,
    /// The spatial part of the null vector, a unit vector in the coordinates.
    pub k: DVec3,
}

/// What stays the same along a ray of light [Carter 1968].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conserved {
    /// Energy at infinity.
    pub energy: f64,
    /// Angular momentum about the axis.
    pub momentum: f64,
    /// Carter's constant, zero for light in the equatorial plane.
    pub carter: f64,
}

impl Kerr {
    /// A hole of this mass, in units of length.
    ///
    /// * `spin`: angular momentum over the square of the mass, in [-1, 1]; the right-handed sense about the z axis is positive
    pub fn new(mass: f64, spin: f64) -> Kerr {
        debug_assert!(mass >= 0.0 && spin.abs() <= 1.0);
        Kerr { mass, spin: spin * mass }
    }

    /// The mass, a length.
    #[inline]
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// Angular momentum over mass, a length of at most the mass.
    #[inline]
    pub fn spin(&self) -> f64 {
        self.spin
    }

    /// The radial coordinate of the outer horizon.
    #[inline]
    pub fn horizon(&self) -> f64 {
        self.mass + (self.mass * self.mass - self.spin * self.spin).max(0.0).sqrt()
    }

    /// The radial coordinate of a place, at least 0.
    #[inline]
    pub fn radius(&self, x: DVec3) -> f64 {
        let a2 = self.spin * self.spin;
        let half = 0.5 * (x.length_squared() - a2);
        let root = (half * half + a2 * x.z * x.z).sqrt();
        // The sum does not cancel; inside of the ring's sphere it is found by the product of the roots.
        let r2 = if half >= 0.0 { half + root } else { a2 * x.z * x.z / (root - half) };
        r2.max(0.0).sqrt()
    }

    /// What the metric is at a place.
    ///
    /// Near the ring `x² + y² = a², z = 0`, where it has no value, the radius is held to a millionth of the mass.
    #[inline]
    pub fn metric(&self, x: DVec3) -> KerrMetric {
        let r = self.radius(x).max(1e-6 * self.mass);
        self.metric_at(x, r)
    }

    #[inline]
    fn metric_at(&self, x: DVec3, r: f64) -> KerrMetric {
        let a = self.spin;
        let (r2, q) = (r * r, r * r + a * a);
        let f = if r > 0.0 { 2.0 * self.mass * r * r2 / (r2 * r2 + a * a * x.z * x.z) } else { 0.0 };
        let kz = if r > 0.0 { x.z / r } else { 0.0 };
        let k = if q > 0.0 {
            DVec3::new((r * x.x + a * x.y) / q, (r * x.y - a * x.x) / q, kz)
        } else {
            DVec3::ZERO
        };
        KerrMetric { r, f, k }
    }

    /// The right-hand sides of Hamilton's equations: how place and momentum change.
    ///
    /// * `x`: the place
    /// * `p`: the spatial part of the momentum, a covector
    /// * `energy`: `-p_t`, which stays the same; negative for light that is followed into the past
    #[inline]
    pub fn flow(&self, x: DVec3, p: DVec3, energy: f64) -> (DVec3, DVec3) {
        self.flow_at(&self.metric(x), x, p, energy)
    }

    /// [`Kerr::flow`] where the metric is known.
    #[inline]
    pub fn flow_at(&self, metric: &KerrMetric, x: DVec3, p: DVec3, energy: f64) -> (DVec3, DVec3) {
        if self.mass == 0.0 {
            return (p, DVec3::ZERO);
        }
        let a = self.spin;
        let &KerrMetric { r, f, k } = metric;
        let (r2, a2z2) = (r * r, a * a * x.z * x.z);
        let r4 = r2 * r2;
        let d = r4 + a2z2;
        let q = r2 + a * a;
        let s = energy + k.dot(p);
        let dr = DVec3::new(x.x * r2, x.y * r2, x.z * q) * (r / d);
        // ∇f, then p_j ∇k_j.
        let mut df = (3.0 * a2z2 - r4) * dr;
        df.z -= 2.0 * a * a * x.z * r;
        let df = df * (2.0 * self.mass * r2 / (d * d));
        let along_r = (x.x * p.x + x.y * p.y - 2.0 * r * (k.x * p.x + k.y * p.y)) / q - p.z * x.z / r2;
        let turned = DVec3::new((r * p.x - a * p.y) / q, (r * p.y + a * p.x) / q, p.z / r);
        let fs = f * s;
        (p - fs * k, 0.5 * s * s * df + fs * (along_r * dr + turned))
    }

    /// The rate at which the coordinate time passes along a ray, `dt/dλ`.
    #[inline]
    pub fn time_rate(&self, x: DVec3, p: DVec3, energy: f64) -> f64 {
        let KerrMetric { f, k, .. } = self.metric(x);
        energy + f * (energy + k.dot(p))
    }

    /// `g^mn p_m p_n`, zero for light.
    #[inline]
    pub fn norm(&self, x: DVec3, p: DVec3, energy: f64) -> f64 {
        let KerrMetric { f, k, .. } = self.metric(x);
        let s = energy + k.dot(p);
        p.length_squared() - energy * energy - f * s * s
    }

    /// The momentum of light that is nearest to `p` among its multiples; `p` where there is none, as may be inside of a horizon.
    ///
    /// Removes what rounding and the errors of steps add to the norm.
    #[inline]
    pub fn null_projected(&self, x: DVec3, p: DVec3, energy: f64) -> DVec3 {
        let KerrMetric { f, k, .. } = self.metric(x);
        let kp = k.dot(p);
        let (a, h) = (p.length_squared() - f * kp * kp, -f * energy * kp);
        let c = -energy * energy * (1.0 + f);
        // One step of Newton's method from 1, which the root is near.
        let slope = 2.0 * (a + h);
        let change = (a + 2.0 * h + c) / slope;
        if change.abs() < 1e-3 { p * (1.0 - change) } else { p }
    }

    /// What stays the same along the ray.
    pub fn conserved(&self, x: DVec3, p: DVec3, energy: f64) -> Conserved {
        let r = self.radius(x);
        let q = r * r + self.spin * self.spin;
        let rho2 = x.x * x.x + x.y * x.y;
        let momentum = x.x * p.y - x.y * p.x;
        let (sin2, cos) = (rho2 / q, x.z / r);
        // The momentum along the meridian times sin θ.
        let polar = (x.x * p.x + x.y * p.y) * cos - p.z * r * sin2;
        let spin_term = self.spin * energy * cos;
        let carter = if sin2 > 0.0 {
            (polar * polar + cos * cos * momentum * momentum) / sin2 - spin_term * spin_term
        } else {
            let across = p.x * p.x + p.y * p.y;
            across * q * cos * cos - spin_term * spin_term
        };
        Conserved { energy, momentum, carter }
    }

    /// Angular velocity of a circular orbit in the equatorial plane, `±sqrt(M) / (r^(3/2) ± a sqrt(M))` [Bardeen et al. 1972,
    /// eq. 2.16].
    ///
    /// * `r`: radial coordinate
    /// * `along`: whether the orbit goes in the right-handed sense about the z axis
    #[inline]
    pub fn angular_velocity(&self, r: f64, along: bool) -> f64 {
        let sign = if along { 1.0 } else { -1.0 };
        let root = self.mass.sqrt();
        sign * root / (r * r.sqrt() + sign * self.spin * root)
    }
}

impl KerrMetric {
    /// The energy at infinity of light with a momentum: the root of `g^mn p_m p_n = 0` that goes towards the future, or the other one.
    ///
    /// * `p`: the spatial part of the momentum, a covector
    #[inline]
    pub fn energy(&self, p: DVec3, into_future: bool) -> f64 {
        let KerrMetric { f, k, .. } = *self;
        let kp = k.dot(p);
        let root = (p.length_squared() * (1.0 + f) - f * kp * kp).max(0.0).sqrt();
        let root = if into_future { root } else { -root };
        (root - f * kp) / (1.0 + f)
    }

    /// The frequency of that light for the observer whose velocity is normal to the slice of constant time.
    #[inline]
    pub fn normal_frequency(&self, p: DVec3) -> f64 {
        let KerrMetric { f, k, .. } = *self;
        let kp = k.dot(p);
        (p.length_squared() - f / (1.0 + f) * kp * kp).max(0.0).sqrt()
    }

    /// The product `g_mn u^m v^n` of two vectors of time and space.
    #[inline]
    pub fn product(&self, u: (f64, DVec3), v: (f64, DVec3)) -> f64 {
        let [ku, kv] = [u, v].map(|(t, x)| t + self.k.dot(x));
        u.1.dot(v.1) - u.0 * v.0 + self.f * ku * kv
    }

    /// The covector `g_mn u^n`.
    #[inline]
    pub fn lowered(&self, (t, x): (f64, DVec3)) -> (f64, DVec3) {
        let k = self.f * (t + self.k.dot(x));
        (-t + k, x + k * self.k)
    }

    /// The vector `g^mn p_n`.
    #[inline]
    pub fn raised(&self, (t, p): (f64, DVec3)) -> (f64, DVec3) {
        let k = self.f * (-t + self.k.dot(p));
        (-t + k, p - k * self.k)
    }
}

#[cfg(test)]
mod tests;
