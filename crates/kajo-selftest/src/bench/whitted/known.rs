//! What the pictures must be.
//!
//! The values are those of the first pictures that were compared with other programs' by eye. A change
//! that moves them on purpose brings new ones.

use kajo_render::RayCounters;

use super::{AntiAliasing, WhittedScene};
use crate::bench::picture::Timed;

/// How far each mean colour may be off.
pub const MEAN_TOLERANCE: f64 = 1e-4;

/// How far each count of rays may be off, as a share of it.
pub const COUNT_TOLERANCE: f64 = 5e-4;

struct Known {
    mean: [f64; 3],
    rays: RayCounters,
}

fn known(scene: WhittedScene, aa: AntiAliasing) -> Known {
    let (mean, [camera, shadow, reflected, refracted]) = match (scene, aa) {
        (WhittedScene::Flake, AntiAliasing::None) => {
            ([0.518896, 0.494707, 0.450895], [786_432, 3_077_280, 737_548, 0])
        }
        (WhittedScene::Flake, AntiAliasing::Grid) => {
            ([0.518901, 0.494724, 0.450928], [3_932_160, 15_385_053, 3_686_638, 0])
        }
        (WhittedScene::Marbles, AntiAliasing::None) => {
            ([0.332105, 0.366165, 0.425894], [786_432, 2_317_756, 832_657, 832_979])
        }
        (WhittedScene::Marbles, AntiAliasing::Grid) => {
            ([0.332204, 0.366257, 0.425976], [3_932_160, 11_590_056, 4_164_093, 4_164_694])
        }
    };
    Known { mean, rays: RayCounters { camera, shadow, reflected, refracted, ..RayCounters::default() } }
}

/// Compares a picture with what is known of it; the text says what differs.
pub(super) fn check(scene: WhittedScene, aa: AntiAliasing, timed: &Timed) -> Result<(), String> {
    let known = known(scene, aa);
    let mean = timed.mean();
    // Written so that what is not a number is wrong.
    let same_mean = (0..3).all(|i| (mean[i] - known.mean[i]).abs() <= MEAN_TOLERANCE);
    let close =
        |found: u64, expected: u64| found.abs_diff(expected) as f64 <= COUNT_TOLERANCE * expected as f64;
    let same_rays = close(timed.rays.camera, known.rays.camera)
        && close(timed.rays.shadow, known.rays.shadow)
        && close(timed.rays.reflected, known.rays.reflected)
        && close(timed.rays.refracted, known.rays.refracted);
    if same_mean && same_rays {
        return Ok(());
    }
    Err(format!(
        "its mean colour is {mean:.6?} and its rays are {:?}; known are {:?} within {MEAN_TOLERANCE} and {:?} within {COUNT_TOLERANCE} of that",
        timed.rays, known.mean, known.rays
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::time::Seconds;
    use kajo_image::Image;

    /// A picture of one colour with these rays.
    fn timed(mean: [f64; 3], rays: RayCounters) -> Timed {
        let image = Image::filled(2, 2, &mean.map(|v| v as f32)).unwrap();
        Timed { image, rays, seconds: Seconds::default() }
    }

    #[test]
    fn every_kind_of_difference_is_found() {
        let (scene, aa) = (WhittedScene::Marbles, AntiAliasing::None);
        let right = known(scene, aa);
        assert_eq!(check(scene, aa, &timed(right.mean, right.rays)), Ok(()));
        for i in 0..3 {
            let mut mean = right.mean;
            mean[i] += 2.0 * MEAN_TOLERANCE;
            assert!(check(scene, aa, &timed(mean, right.rays)).is_err(), "colour {i}");
        }
        let more = |n: u64| n + (n as f64 * 2.0 * COUNT_TOLERANCE) as u64;
        let changed = [
            RayCounters { camera: more(right.rays.camera), ..right.rays },
            RayCounters { shadow: more(right.rays.shadow), ..right.rays },
            RayCounters { reflected: more(right.rays.reflected), ..right.rays },
            RayCounters { refracted: more(right.rays.refracted), ..right.rays },
        ];
        for rays in changed {
            assert!(check(scene, aa, &timed(right.mean, rays)).is_err(), "{rays:?}");
        }
        assert!(check(scene, aa, &timed([f64::NAN; 3], right.rays)).is_err());
    }
}
