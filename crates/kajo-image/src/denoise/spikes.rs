//! Holding down pixels that a few samples made far too bright.
//!
//! A path that finds a tiny bright emitter by chance leaves one pixel with hundreds of times the light of those around it.
//! Spread over the window of a denoiser that is a bright square. Such a pixel is known by its variance: of `n` samples of
//! which `k` brought all its light, the variance of the mean is about `c²/k`. Where
//!
//! ```text
//! V > c² / 4     and     c > 18 mean of the light around it, on surfaces that look the same
//! ```
//!
//! `c` is scaled down to that limit, and `V` with its square. Light that comes so rarely that fewer than one pixel in 18
//! has any is lost in part; what is more even, or known better, stays as it is. Fireflies are often side by side, so this
//! is done twice.

/// Surroundings reach this far to each side.
const REACH: i32 = 5;

/// How many times as bright as its surroundings a pixel may be that few samples made bright.
const LIMIT: f32 = 18.0;

/// Samples that count as few.
const FEW: f32 = 4.0;

/// Pixels that surroundings need, or nothing is known of them.
const ENOUGH: u32 = 8;

/// Holds down what is too bright.
///
/// * `light`, `variance`: a pixel's mean and the variance of that, row by row
/// * `features`: of the surface, in units of what counts as different
pub fn hold_down(width: usize, light: &mut [[f32; 3]], variance: &mut [[f32; 3]], features: &[[f32; 6]]) {
    for _ in 0..2 {
        let before: Vec<f32> = light.iter().map(sum).collect();
        for i in 0..before.len() {
            let c = before[i];
            if FEW * sum(&variance[i]) <= sum(&light[i].map(|v| v * v)) {
                continue;
            }
            let limit = LIMIT * surroundings(i, width, &before, features).unwrap_or(f32::INFINITY);
            if c > limit && limit > 0.0 {
                let factor = limit / c;
                light[i] = light[i].map(|v| v * factor);
                variance[i] = variance[i].map(|v| v * factor * factor);
            }
        }
    }
}

fn sum(v: &[f32; 3]) -> f32 {
    v[0] + v[1] + v[2]
}

/// The mean around pixel `i`, without it, where the surface is alike; `None` where there is too little of it.
fn surroundings(i: usize, width: usize, light: &[f32], features: &[[f32; 6]]) -> Option<f32> {
    let (width, height) = (width as i32, (light.len() / width) as i32);
    let (x, y) = (i as i32 % width, i as i32 / width);
    let (mut total, mut count) = (0.0, 0);
    for row in (y - REACH).max(0)..=(y + REACH).min(height - 1) {
        for column in (x - REACH).max(0)..=(x + REACH).min(width - 1) {
            let j = (row * width + column) as usize;
            let differences = features[i].iter().zip(&features[j]).map(|(a, b)| (a - b) * (a - b));
            if j != i && differences.sum::<f32>() < 1.0 {
                total += light[j];
                count += 1;
            }
        }
    }
    (count >= ENOUGH).then(|| total / count as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: usize = 40;

    type Layer<const N: usize> = Vec<[f32; N]>;

    /// Grey light of 1 with little variance on one surface.
    fn even() -> (Layer<3>, Layer<3>, Layer<6>) {
        (vec![[1.0; 3]; SIDE * SIDE], vec![[0.01; 3]; SIDE * SIDE], vec![[0.0; 6]; SIDE * SIDE])
    }

    #[test]
    fn fireflies_are_held_down_and_keep_their_colour() {
        let (mut light, mut variance, features) = even();
        // Alone, two side by side, and in a corner.
        let places = [20 * SIDE + 20, 30 * SIDE + 8, 30 * SIDE + 9, 0];
        for i in places {
            light[i] = [1000.0, 500.0, 0.0];
            variance[i] = light[i].map(|v| v * v);
        }
        hold_down(SIDE, &mut light, &mut variance, &features);
        for i in places {
            let [r, g, b] = light[i];
            // The limit is 18 times a sum of three.
            assert!(
                (40.0..100.0).contains(&(r + g)) && (r / g - 2.0).abs() < 1e-5 && b == 0.0,
                "{:?}",
                light[i]
            );
            assert!((variance[i][0] / (r * r) - 1.0).abs() < 1e-5);
        }
        assert!((0..light.len()).all(|i| places.contains(&i) || light[i] == [1.0; 3]));
    }

    #[test]
    fn what_is_known_well_or_seen_often_stays() {
        // A small emitter that is seen by all samples, and light that finds one pixel in ten.
        let (mut light, mut variance, features) = even();
        light[210] = [1000.0; 3];
        let before = light.clone();
        hold_down(SIDE, &mut light, &mut variance, &features);
        assert!(light == before);
        let rare = |i: usize| if i % 10 == (i / SIDE) % 10 { [10.0; 3] } else { [0.0; 3] };
        let mut light: Vec<_> = (0..SIDE * SIDE).map(rare).collect();
        let mut variance: Vec<_> = light.iter().map(|v| v.map(|v| v * v)).collect();
        let before = light.clone();
        hold_down(SIDE, &mut light, &mut variance, &features);
        assert!(light == before);
    }

    #[test]
    fn other_surfaces_are_no_measure() {
        // A firefly on a floor beside a light that fills half of the surroundings.
        let (mut light, mut variance, mut features) = even();
        for i in (0..SIDE * SIDE).filter(|i| i % SIDE < 20) {
            (light[i], features[i]) = ([500.0; 3], [9.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        }
        let i = 20 * SIDE + 20;
        (light[i], variance[i]) = ([1000.0; 3], [1e6; 3]);
        hold_down(SIDE, &mut light, &mut variance, &features);
        assert!((light[i][0] - 18.0).abs() < 0.1, "{:?}", light[i]);
    }
}
