//! Multiple importance sampling.

/// Weight of an estimate of density `p` against another of density `q`, `p^2 / (p^2 + q^2)` [Veach 1997, eq. 9.15].
#[inline]
pub fn power_heuristic(p: f32, q: f32) -> f32 {
    // By their ratio, since the squares may overflow.
    if p > q { 1.0 / (1.0 + (q / p) * (q / p)) } else { (p / q) * (p / q) / (1.0 + (p / q) * (p / q)) }
}
