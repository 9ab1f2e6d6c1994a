//! What the answers must be.

use kajo_bvh::bench::Figures;

/// How an answer was judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gate {
    /// It agrees with the known one.
    Passed,
    /// Nothing is known about this mesh.
    Unknown,
}

/// Answers of Embree 4.4.0 at medium quality.
struct Known {
    mesh: &'static str,
    triangles: usize,
    /// Primary, bounce, shadow.
    hits: [usize; 3],
    /// Primary, bounce.
    sum_t: [f64; 2],
}

const fn known(mesh: &'static str, triangles: usize, hits: [usize; 3], sum_t: [f64; 2]) -> Known {
    Known { mesh, triangles, hits, sum_t }
}

const KNOWN: [Known; 8] = [
    known("bunny", 56_172, [488_324, 40_343, 61_238], [900324.985, 5106.97404]),
    known("sponza", 66_450, [1_041_012, 994_955, 372_083], [11966670.7, 7123699.99]),
    known("kitchen", 56_939, [952_125, 939_971, 53_471], [3285928.62, 1839365.48]),
    known("stadium", 102_906, [1_048_576, 1_048_576, 15_383], [249593800.0, 861727073.0]),
    known("dragon", 871_414, [406_939, 83_625, 46_580], [127646.603, 1984.15396]),
    known("sphere", 1_310_720, [724_452, 40_549, 92_220], [1517049.4, 2717.07027]),
    known("grass", 2_000_002, [641_849, 437_289, 400_056], [3165244.52, 129538.937]),
    known("terrain", 8_380_418, [690_531, 256_911, 268_411], [911004.455, 25712.5709]),
];

const HIT_TOLERANCE: [f64; 3] = [1e-4, 1e-3, 1e-3];
const SUM_TOLERANCE: [f64; 2] = [1e-4, 1e-2];

/// Judges the answers on a mesh of known name and size.
///
/// * `sum_t`: distances of primary and of bounce hits
///
/// # Errors
/// What differs by more than allowed.
pub fn check(mesh: &str, triangles: usize, hits: &Figures<usize>, sum_t: [f64; 2]) -> Result<Gate, String> {
    let same = |known: &&Known| known.mesh == mesh && known.triangles == triangles;
    let Some(known) = KNOWN.iter().find(same) else { return Ok(Gate::Unknown) };
    let kinds = ["primary", "bounce", "shadow"];
    let hits = [hits.primary, hits.bounce, hits.shadow];
    for i in 0..3 {
        agree(&format!("{} hits", kinds[i]), hits[i] as f64, known.hits[i] as f64, HIT_TOLERANCE[i])?;
    }
    for i in 0..2 {
        let what = format!("sum of the distances of {} hits", kinds[i]);
        agree(&what, sum_t[i], known.sum_t[i], SUM_TOLERANCE[i])?;
    }
    Ok(Gate::Passed)
}

fn agree(what: &str, found: f64, expected: f64, tolerance: f64) -> Result<(), String> {
    // Not a number agrees with nothing.
    if (found - expected).abs() <= tolerance * expected {
        return Ok(());
    }
    Err(format!("{what}: {found}, not {expected} within {} %", tolerance * 100.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    const HITS: [usize; 3] = [488_324, 40_343, 61_238];
    const SUM_T: [f64; 2] = [900324.985, 5106.97404];

    fn bunny([primary, bounce, shadow]: [usize; 3], sum_t: [f64; 2]) -> Result<Gate, String> {
        check("bunny", 56_172, &Figures { primary, bounce, shadow }, sum_t)
    }

    #[test]
    fn the_known_answer_passes_and_others_fail() {
        assert_eq!(bunny(HITS, SUM_T), Ok(Gate::Passed));
        assert_eq!(bunny([HITS[0] + 48, HITS[1], HITS[2]], SUM_T), Ok(Gate::Passed));
        assert!(bunny([HITS[0] + 49, HITS[1], HITS[2]], SUM_T).is_err());
        assert!(bunny([HITS[0], HITS[1] - 41, HITS[2]], SUM_T).is_err());
        assert!(bunny([HITS[0], HITS[1], HITS[2] + 62], SUM_T).is_err());
        assert!(bunny(HITS, [SUM_T[0] * 1.00011, SUM_T[1]]).is_err());
        assert!(bunny(HITS, [SUM_T[0], SUM_T[1] * 0.98]).is_err());
        assert!(bunny(HITS, [SUM_T[0], f64::NAN]).is_err());
    }

    #[test]
    fn other_meshes_are_unknown() {
        let nothing = Figures::default();
        assert_eq!(check("bunny", 3, &nothing, [0.0; 2]), Ok(Gate::Unknown));
        assert_eq!(check("rabbit", 56_172, &nothing, [0.0; 2]), Ok(Gate::Unknown));
    }
}
