//! Distributions, Fresnel terms and panes against closed forms and tables computed elsewhere.

use std::f64::consts::{PI, TAU};

use kajo_color::Spectrum;
use kajo_math::{Vec2, Vec3, fmath, rng::Stream};
use kajo_testkit::sphere;

use super::super::conductor::complex_polarised;
use super::super::microfacet::NormalDistribution;
use super::super::*;

const SHAPES: [NormalDistribution; 2] = [NormalDistribution::Ggx, NormalDistribution::Beckmann];

fn at(cos: f32) -> Vec3 {
    Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos)
}

/// `∫ D(m) g(m) dm` over slopes: rings of equal share of a distribution, which are circles once unstretched.
fn integrate(facets: Microfacets, g: impl Fn(Vec3) -> f64) -> f64 {
    let (rings, sectors) = (2000, 64);
    let mut sum = 0.0;
    for i in 0..rings {
        let u = (f64::from(i) + 0.5) / f64::from(rings);
        // r² and its derivative by u.
        let (r2, slope) = match facets.shape {
            NormalDistribution::Ggx => (u / (1.0 - u), 1.0 / (1.0 - u).powi(2)),
            NormalDistribution::Beckmann => (-(1.0 - u).ln(), 1.0 / (1.0 - u)),
        };
        for k in 0..sectors {
            let (s, c) = (TAU * (f64::from(k) + 0.5) / f64::from(sectors)).sin_cos();
            let (ax, ay) = (f64::from(facets.alpha_x), f64::from(facets.alpha_y));
            let (x, y) = (ax * r2.sqrt() * c, ay * r2.sqrt() * s);
            let cos = 1.0 / (1.0 + x * x + y * y).sqrt();
            let m = Vec3::new((x * cos) as f32, (y * cos) as f32, cos as f32);
            // dm = cos³ dx dy, and dx dy = αx αy/2 d(r²) dφ.
            let area = cos.powi(3) * ax * ay * 0.5 * slope;
            sum += f64::from(facets.d(m)) * g(m) * area;
        }
    }
    sum * TAU / f64::from(rings * sectors)
}

#[test]
fn facets_cover_the_surface_once() {
    for shape in SHAPES {
        for (alpha_x, alpha_y) in [(0.05, 0.05), (0.3, 0.3), (0.8, 0.8), (0.1, 0.5), (1.0, 0.2)] {
            let facets = Microfacets { shape, alpha_x, alpha_y };
            let covered = integrate(facets, |m| f64::from(m.z));
            assert!((covered - 1.0).abs() < 1e-6, "{facets:?}: {covered}");
            let top = f64::from(facets.d(Vec3::Z)) * PI * f64::from(alpha_x) * f64::from(alpha_y);
            assert!((top - 1.0).abs() < 1e-6, "{facets:?}: {top}");
        }
    }
}

/// What `w` sees of the facets that face it has the area of the surface as seen from there.
#[test]
fn smiths_function_conserves_the_visible_area() {
    for shape in SHAPES {
        for (alpha_x, alpha_y) in [(0.1, 0.1), (0.5, 0.5), (1.0, 1.0), (0.2, 0.7)] {
            let facets = Microfacets { shape, alpha_x, alpha_y };
            for w in [at(0.9), at(0.5), at(0.2), Vec3::new(0.48, 0.64, 0.6)] {
                let facing = integrate(facets, |m| f64::from(w.dot(m)).max(0.0));
                let visible = facing * f64::from(facets.g1(w));
                assert!(
                    (visible - f64::from(w.z)).abs() < 0.01 * f64::from(w.z),
                    "{facets:?} {w}: {visible}"
                );
            }
        }
    }
}

/// Albedo of perfect GGX mirrors that reflect once: straight on, at 60 degrees, and averaged.
#[test]
fn single_scattering_loses_what_is_known() {
    let table = [
        (0.1, [0.988, 0.969, 0.972]),
        (0.25, [0.916, 0.857, 0.882]),
        (0.5, [0.688, 0.698, 0.700]),
        (0.75, [0.464, 0.565, 0.536]),
        (1.0, [0.307, 0.451, 0.409]),
    ];
    for (alpha, expected) in table {
        let facets = Microfacets::new(NormalDistribution::Ggx, alpha);
        let albedo = |cos: f32| {
            sphere::stratified_mean(128, 1, |u, _| {
                let wi = fresnel::reflect(-at(cos), facets.sample(at(cos), u));
                if wi.z > 0.0 { f64::from(facets.g2_over_g1(at(cos), wi)) } else { 0.0 }
            })
        };
        // ∫ E 2μ dμ is a sum over equal steps of μ².
        let average = (0..50).map(|i| albedo(((i as f32 + 0.5) / 50.0).sqrt())).sum::<f64>() / 50.0;
        for (found, expected) in [albedo(1.0), albedo(0.5), average].into_iter().zip(expected) {
            assert!((found - expected).abs() < 2e-3, "{alpha}: {found} {expected}");
        }
    }
}

/// The table of a metal with n = 0.2, k = 3.
#[test]
fn fresnel_table_of_a_conductor() {
    let (eta, k) = (Spectrum::grey(0.2), Spectrum::grey(3.0));
    let table = [
        (0.0f64, 0.923_372, 0.923_372),
        (45.0, 0.946_596, 0.896_043),
        (60.0, 0.962_413, 0.874_409),
        (80.0, 0.986_927, 0.890_190),
    ];
    for (deg, across, along) in table {
        let (rs, rp) = complex_polarised(deg.to_radians().cos() as f32, eta, k);
        assert!(
            (f64::from(rs[0]) - across).abs() < 2e-6 && (f64::from(rp[0]) - along).abs() < 2e-6,
            "{deg} {rs:?} {rp:?}"
        );
    }
}

/// The same equations in double precision, as they are printed [Born and Wolf 1999, sec. 14.2].
#[test]
fn reflectance_of_metals_is_as_exact_as_it_says() {
    let exact = |cos: f64, eta: f64, k: f64| {
        let (cos2, sin2) = (cos * cos, 1.0 - cos * cos);
        let t = eta * eta - k * k - sin2;
        let sum = (t * t + 4.0 * (eta * k).powi(2)).sqrt();
        let a = (0.5 * (sum + t)).max(0.0).sqrt();
        let rs = (sum + cos2 - 2.0 * a * cos) / (sum + cos2 + 2.0 * a * cos);
        let [even, odd] = [cos2 * sum + sin2 * sin2, 2.0 * a * cos * sin2];
        0.5 * rs * (1.0 + (even - odd) / (even + odd))
    };
    for i in 0..1 << 19 {
        let number = Stream::new(15, [i, 0], 0);
        let (eta, k) = (0.03 + 5.0 * number.uniform(0).powi(2), 0.5 + 8.0 * number.uniform(1).powi(2));
        let cos = number.uniform(2).powi(if i & 1 == 0 { 1 } else { 4 });
        let found = conductor::complex(cos, Spectrum::grey(eta), Spectrum::grey(k))[0];
        let off = (f64::from(found) - exact(cos.into(), eta.into(), k.into())).abs();
        assert!(off < 5e-7, "cosine {cos}, index {eta} + {k} i: {off}");
    }
}

/// Without extinction a conductor is a dielectric.
#[test]
fn a_conductor_that_does_not_conduct_is_glass() {
    for i in 0..=50 {
        let cos = i as f32 / 50.0;
        let glass = fresnel::dielectric(cos, 1.5);
        let metal = conductor::complex(cos, Spectrum::grey(1.5), Spectrum::BLACK);
        assert!((metal[1] - glass).abs() < 2e-5, "{cos}: {metal:?} {glass}");
    }
}

#[test]
fn a_tinted_metal_meets_its_two_colours() {
    let (f0, f82) = (Spectrum::rgb(0.9, 0.6, 0.2), Spectrum::rgb(1.0, 0.7, 0.5));
    let metal = MetalFresnel::Tinted { f0, f82 };
    let schlick = MetalFresnel::Tinted { f0, f82: Spectrum::WHITE };
    for lane in 0..3 {
        assert!((metal.at(1.0)[lane] - f0[lane]).abs() < 1e-6);
        let expected = schlick.at(1.0 / 7.0)[lane] * f82[lane];
        assert!((metal.at(1.0 / 7.0)[lane] - expected).abs() < 1e-6);
        assert!((metal.at(0.0)[lane] - 1.0).abs() < 1e-6);
    }
}

/// A share `1/x` of the light leaves at each bounce, and each bounce costs `1 - F`.
#[test]
fn repeated_reflection_is_a_geometric_series() {
    for (f, x) in [(0.9f32, 3.2f32), (0.5, 1.5), (0.04, 2.0), (1.0, 3.0), (0.7, 1.0)] {
        let series: f32 = (0..200).map(|n| f * (f * (1.0 - 1.0 / x)).powi(n)).sum();
        // The first term has left already: relative to it.
        assert!((energy::saturate(f, x) - series / f).abs() < 1e-4, "{f} {x}");
    }
}

#[test]
fn a_pane_adds_up_its_echoes() {
    let microfacets = Microfacets::new(NormalDistribution::Ggx, 0.0);
    let clear = ThinDielectric { eta: 1.5, optical_depth: Spectrum::BLACK, microfacets };
    let (r, t) = clear.shares(1.0);
    assert!((r[0] - 0.076_923_1).abs() < 1e-6 && (t[0] - 0.923_076_9).abs() < 1e-6);
    let tinted = ThinDielectric { optical_depth: Spectrum::rgb(0.1, 0.5, 2.0), ..clear };
    for cos in [1.0f32, 0.7, 0.2] {
        let face = f64::from(fresnel::dielectric(cos, 1.5));
        let cos_t = (1.0 - (1.0 - f64::from(cos).powi(2)) / 2.25).sqrt();
        let (r, t) = tinted.shares(cos);
        for (lane, depth) in [0.1f64, 0.5, 2.0].into_iter().enumerate() {
            let a = (-depth / cos_t).exp();
            // Echo by echo.
            let (mut light, mut back, mut through) = ((1.0 - face) * a, face, 0.0);
            for bounce in 0..100 {
                let leaves = light * (1.0 - face);
                if bounce % 2 == 0 {
                    through += leaves
                } else {
                    back += leaves
                }
                light *= face * a;
            }
            assert!((f64::from(r[lane]) - back).abs() < 1e-5 && (f64::from(t[lane]) - through).abs() < 1e-5);
        }
    }
}

/// The mean of what samples find for one direction: all of it, and what is beyond the surface.
fn reflected_and_passed(lobe: &Bsdf<'_>, wo: Vec3) -> [Spectrum; 2] {
    let n = 100_000;
    let mut sums = [Spectrum::BLACK; 2];
    for i in 0..n {
        let s = Stream::new(3, [i, 0], 0);
        let u = Vec2::new(s.uniform(0), s.uniform(1));
        if let Some(sample) = lobe.sample(wo, u, s.uniform(2), Transport::Radiance) {
            sums[usize::from(sample.wi.z * wo.z < 0.0)] += sample.weight;
        }
    }
    sums.map(|sum| sum * (1.0 / n as f32))
}

fn towards(cos: f32) -> Vec3 {
    Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos)
}

/// A gloss that is nearly polished, above black: Fresnel's term between its factor at normal incidence and 1.
#[test]
fn a_factor_at_normal_incidence_fades_at_grazing_angles() {
    let factor = Spectrum::rgb(4.0, 0.5, 0.0);
    let specular = Specular::F0 { factor, largest: 4.0, weight: 0.75 };
    let (color, alpha) = (Spectrum::BLACK, Vec2::splat(0.005));
    let lobe = Bsdf::Principled(Principled { color, specular, alpha, ..Principled::default() });
    for cos in [1.0, 0.6, 0.3, 0.12] {
        let [found, _] = reflected_and_passed(&lobe, towards(cos));
        for (lane, factor) in [4.0, 0.5, 0.0].into_iter().enumerate() {
            let (f0, f) = (0.04 * factor, f64::from(fresnel::dielectric(cos, 1.5)));
            let expected = 0.75 * (f0 + (1.0 - f0) * (f - 0.04) / 0.96);
            let found = f64::from(found[lane]);
            assert!((found - expected).abs() < 0.004 + 0.01 * expected, "{cos} {lane}: {found} {expected}");
        }
    }
    // Metals have it from their colour alone.
    let metal = |specular| Principled { base: Base::Metal, specular, ..Principled::default() };
    let [with, without] = [specular, Specular::Factor(Spectrum::WHITE)]
        .map(|specular| Bsdf::Principled(metal(specular)).albedo(towards(0.2)));
    assert_eq!(with, without);
}

/// A frosted pane reflects as much as a polished one and lets as much through, into directions of its own.
#[test]
fn a_frosted_pane_divides_light_as_a_polished_one() {
    let optical_depth = Spectrum::rgb(0.0, 0.3, 1.0);
    let pane = |alpha| ThinDielectric {
        eta: 1.5,
        optical_depth,
        microfacets: Microfacets::new(NormalDistribution::Ggx, alpha),
    };
    assert!(pane(POLISHED).is_polished() && !pane(0.02).is_polished());
    for cos in [1.0, 0.6, 0.3] {
        let (r, t) = pane(0.0).shares(cos);
        for side in [1.0, -1.0] {
            let found = reflected_and_passed(&Bsdf::ThinDielectric(pane(0.02)), side * towards(cos));
            for (found, expected) in found.into_iter().zip([r, t]) {
                let off = (found - expected).map(f32::abs).max_lane();
                assert!(off < 0.006, "{cos}: {found:?} {expected:?}");
            }
        }
    }
}

/// The share of what is seen below the slope that stands for `u` is `u`, for 2^19 pairs of a direction and a number, many of
/// them next to the ends of their ranges.
#[test]
fn slopes_of_beckmann_have_their_share_below_them() {
    let facets = Microfacets::new(NormalDistribution::Beckmann, 1.0);
    let (mut worst, mut sum, n) = (0.0f64, 0.0, 1 << 19);
    for i in 0..n {
        let numbers = Stream::new(12, [i, 0], 0);
        let towards_ends = |v: f32, which| match which {
            0 => v,
            1 => v.powi(4),
            _ => (1.0 - v.powi(4)).min(1.0 - 0.5 * f32::EPSILON),
        };
        let w = at(towards_ends(numbers.uniform(0), i % 3).max(1e-4));
        let u = towards_ends(numbers.uniform(1), i / 3 % 3);
        // Half of the slopes across are below 0, and `m` is `(-slope, 1)` normalised where `w` is in the plane of x and z.
        let m = facets.sample(w, Vec2::new(u, 0.5));
        let slope = f64::from(m.x) / f64::from(m.z);
        let (sin, cos) = (f64::from(w.x), f64::from(w.z));
        let primitive = |s: f64| 0.5 * (cos * fmath::erf64(s) - sin * (-s * s).exp() / PI.sqrt());
        let (bottom, top) = (primitive(-(cos / sin.max(1e-9)).min(6.0)), primitive(6.0));
        let off = ((primitive(slope) - bottom) / (top - bottom) - f64::from(u)).abs();
        worst = worst.max(off);
        sum += off;
    }
    let mean = sum / f64::from(n);
    assert!(worst < 1.3e-6 && mean < 1e-7, "worst {worst}, mean {mean}");
}
