//! How different two colours look: CIEDE2000.
//!
//! Distances in CIELAB, weighted by lightness, chroma and hue, with a term that turns blues. A difference of
//! 1 is about what can just be seen side by side.
//! [CIE 142-2001], [Sharma, Wu and Dalal 2005]

/// CIELAB of XYZ under a white of the same scale.
pub fn lab(xyz: [f64; 3], white: [f64; 3]) -> [f64; 3] {
    let f = |i: usize| {
        let t = xyz[i] / white[i];
        if t > 216.0 / 24389.0 { t.cbrt() } else { (24389.0 / 27.0 * t + 16.0) / 116.0 }
    };
    [116.0 * f(1) - 16.0, 500.0 * (f(0) - f(1)), 200.0 * (f(1) - f(2))]
}

/// The difference of two colours in CIELAB.
pub fn delta_e_2000(one: [f64; 3], two: [f64; 3]) -> f64 {
    let seventh = |c: f64| (c.powi(7) / (c.powi(7) + 25f64.powi(7))).sqrt();
    let mean_c = 0.5 * (one[1].hypot(one[2]) + two[1].hypot(two[2]));
    let g = 0.5 * (1.0 - seventh(mean_c));
    let chroma_and_hue = |lab: [f64; 3]| {
        let a = (1.0 + g) * lab[1];
        (a.hypot(lab[2]), lab[2].atan2(a).to_degrees().rem_euclid(360.0))
    };
    let ((c1, h1), (c2, h2)) = (chroma_and_hue(one), chroma_and_hue(two));

    let grey = c1 * c2 == 0.0;
    let turn = if grey { 0.0 } else { (h2 - h1 + 180.0).rem_euclid(360.0) - 180.0 };
    let dl = two[0] - one[0];
    let dc = c2 - c1;
    let dh = 2.0 * (c1 * c2).sqrt() * (0.5 * turn).to_radians().sin();

    let (l, c) = (0.5 * (one[0] + two[0]), 0.5 * (c1 + c2));
    let h = if grey { h1 + h2 } else { h1 + 0.5 * turn };
    let cos = |degrees: f64| degrees.to_radians().cos();
    let t = 1.0 - 0.17 * cos(h - 30.0) + 0.24 * cos(2.0 * h) + 0.32 * cos(3.0 * h + 6.0)
        - 0.20 * cos(4.0 * h - 63.0);
    let around = (h.rem_euclid(360.0) - 275.0) / 25.0;
    let turned = -(60.0 * (-around * around).exp()).to_radians().sin() * 2.0 * seventh(c);
    let l50 = (l - 50.0) * (l - 50.0);
    let (sl, sc, sh) = (1.0 + 0.015 * l50 / (20.0 + l50).sqrt(), 1.0 + 0.045 * c, 1.0 + 0.015 * c * t);
    let (l, c, h) = (dl / sl, dc / sc, dh / sh);
    (l * l + c * c + h * h + turned * c * h).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_those_of_the_published_test_pairs() {
        // [Sharma, Wu and Dalal 2005, table 1]
        let pairs = [
            ([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485], 2.0425),
            ([50.0, -1.3802, -84.2814], [50.0, 0.0, -82.7485], 1.0),
            ([50.0, 0.0, 0.0], [50.0, -1.0, 2.0], 2.3669),
            ([50.0, 2.49, -0.001], [50.0, -2.49, 0.0009], 7.1792),
            ([50.0, 2.49, -0.001], [50.0, -2.49, 0.0011], 7.2195),
            ([50.0, 2.5, 0.0], [73.0, 25.0, -18.0], 27.1492),
            ([50.0, 2.5, 0.0], [56.0, -27.0, -3.0], 31.9030),
            ([60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387], 1.2644),
            ([22.7233, 20.0904, -46.6940], [23.0331, 14.9730, -42.5619], 2.0373),
            ([90.8027, -2.0831, 1.4410], [91.1528, -1.6435, 0.0447], 1.4441),
            ([2.0776, 0.0795, -1.1350], [0.9033, -0.0636, -0.5514], 0.9082),
        ];
        for (one, two, expected) in pairs {
            for found in [delta_e_2000(one, two), delta_e_2000(two, one)] {
                assert!((found - expected).abs() < 1e-4, "{one:?} {two:?}: {found}");
            }
        }
    }

    #[test]
    fn white_has_lightness_a_hundred_and_no_colour() {
        let white = [0.9505, 1.0, 1.089];
        assert_eq!(lab(white, white), [100.0, 0.0, 0.0]);
        assert!((lab([0.0, 0.18418651851244416, 0.0], [1.0; 3])[0] - 50.0).abs() < 1e-9);
        assert_eq!(lab([0.0; 3], white)[0], 0.0);
    }
}
