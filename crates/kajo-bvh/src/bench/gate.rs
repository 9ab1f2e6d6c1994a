//! The protocol's right answers, to tell fast from wrong.

use super::{Figures, Report};

/// Mesh; hits of primary, bounce and shadow rays; sums of distances of the first two.
/// Embree 4.4.0; other ray casters agree with it within the tolerances below.
const ANSWERS: [(&str, [f64; 3], [f64; 2]); 8] = [
    ("bunny", [488_324.0, 40_343.0, 61_238.0], [900_324.985, 5_106.973_94]),
    ("sponza", [1_041_012.0, 994_955.0, 372_083.0], [11_966_670.7, 7_123_699.99]),
    ("kitchen", [952_125.0, 939_971.0, 53_471.0], [3_285_928.62, 1_839_365.48]),
    ("stadium", [1_048_576.0, 1_048_576.0, 15_383.0], [249_593_800.0, 861_727_073.0]),
    ("dragon", [406_939.0, 83_625.0, 46_580.0], [127_646.603, 1_984.153_96]),
    ("sphere", [724_452.0, 40_549.0, 92_220.0], [1_517_049.4, 2_717.070_27]),
    ("grass", [641_849.0, 437_289.0, 400_056.0], [3_165_244.52, 129_538.937]),
    ("terrain", [690_531.0, 256_911.0, 268_411.0], [911_004.455, 25_712.570_9]),
];

/// Whether `a` and `b` differ by at most the share `tolerance` of `b`.
fn near(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance * b
}

impl Report {
    /// Whether hits and sums are right; `None` for meshes that are not of the protocol.
    ///
    /// Counts of primary hits may be off by 0.01 %, of others by 0.1 %; sums by 0.01 % and 1 %.
    pub fn is_right(&self) -> Option<bool> {
        let (_, hits, sums) = ANSWERS.iter().find(|(name, ..)| *name == self.mesh)?;
        let Figures { primary, bounce, shadow } = self.hits;
        Some(
            near(primary as f64, hits[0], 1e-4)
                && near(bounce as f64, hits[1], 1e-3)
                && near(shadow as f64, hits[2], 1e-3)
                && near(self.sum_t[0], sums[0], 1e-4)
                && near(self.sum_t[1], sums[1], 1e-2),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_count_does_not_pass() {
        let rates = crate::bench::Rates::default();
        let mut report = Report {
            mesh: "bunny".into(),
            triangles: 56_172,
            threads: 1,
            build_wall_s: 0.0,
            build_cpu_s: 0.0,
            bytes: 0,
            mrays_wall: rates,
            mrays_cpu: rates,
            hits: Figures { primary: 488_325, bounce: 40_341, shadow: 61_237 },
            sum_t: [900_324.7, 5_106.2],
        };
        assert_eq!(report.is_right(), Some(true));
        report.hits.bounce = 40_450;
        assert_eq!(report.is_right(), Some(false));
        report.hits.bounce = 40_341;
        report.sum_t[0] += 100.0;
        assert_eq!(report.is_right(), Some(false));
        report.mesh = "teapot".into();
        assert_eq!(report.is_right(), None);
    }
}
