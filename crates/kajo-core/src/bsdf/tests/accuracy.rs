//! Lobes in single precision, against the same formulas in double.

use std::f64::consts::PI;

use kajo_color::Spectrum;
use kajo_math::{DVec3, Vec2, Vec3, rng::Stream};

use crate::bsdf::microfacet::NormalDistribution;
use crate::bsdf::{Microfacets, OrenNayar};

/// A unit vector above the surface; every fourth one is near the horizon, or near the normal.
fn direction(s: &Stream, first: u32) -> Vec3 {
    let (u, phi) = (s.uniform(first), std::f32::consts::TAU * s.uniform(first + 1));
    let z = match (4.0 * s.uniform(first + 2)) as u32 {
        0 => 1e-3 * u,
        1 => 1.0 - 1e-4 * u,
        _ => u,
    };
    let r = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(r * phi.cos(), r * phi.sin(), z)
}

#[test]
fn ggx_is_as_exact_as_it_says() {
    for i in 0..100_000 {
        let s = Stream::new(71, [i, 0], 0);
        let [alpha_x, alpha_y] = [0, 1].map(|k| 1e-3f32.powf(s.uniform(k)));
        let facets = Microfacets { shape: NormalDistribution::Ggx, alpha_x, alpha_y };
        let [ax, ay] = [alpha_x, alpha_y].map(f64::from);
        let (w, m) = (direction(&s, 2), direction(&s, 5));
        let near = Vec3::new(3.0 * alpha_x * m.x, 3.0 * alpha_y * m.y, 1.0).normalize();
        for m in [m, near].into_iter().filter(|m| m.z > 1e-7) {
            let m64 = m.as_dvec3();
            let t = (m64.x / ax).powi(2) + (m64.y / ay).powi(2) + m64.z * m64.z;
            let exact = 1.0 / (PI * ax * ay * t * t);
            assert!((f64::from(facets.d(m)) / exact - 1.0).abs() < 1e-6, "D of {m}: {exact}");
        }
        if w.z < 1e-7 {
            continue;
        }
        let w64 = w.as_dvec3();
        let a2 = ((ax * w64.x).powi(2) + (ay * w64.y).powi(2)) / (w64.z * w64.z);
        let exact = 1.0 / (1.0 + 0.5 * a2 / (1.0 + (1.0 + a2).sqrt()));
        assert!((f64::from(facets.g1(w)) / exact - 1.0).abs() < 4e-7, "G1 of {w}: {exact}");
        let u = Vec2::new(s.uniform(8), s.uniform(9));
        let stretched = DVec3::new(ax * w64.x, ay * w64.y, w64.z).normalize();
        let z = (1.0 - f64::from(u.y)) * (1.0 + stretched.z) - stretched.z;
        let (r, phi) = ((1.0 - z * z).max(0.0).sqrt(), 2.0 * PI * f64::from(u.x));
        let n = DVec3::new(r * phi.cos(), r * phi.sin(), z) + stretched;
        let exact = DVec3::new(ax * n.x, ay * n.y, n.z.max(0.0)).normalize();
        let off = facets.sample(w, u).as_dvec3().distance(exact);
        assert!(off < 1e-3, "normal seen from {w} by {u}: {off}");
    }
}

#[test]
fn oren_nayar_is_as_exact_as_it_says() {
    for i in 0..100_000 {
        let s = Stream::new(72, [i, 0], 0);
        let (roughness, rho) = (s.uniform(0), s.uniform(1));
        let (wo, wi) = (direction(&s, 2), direction(&s, 5));
        if wo.z == 0.0 || wi.z == 0.0 || roughness < 1e-4 {
            continue;
        }
        let lobe = OrenNayar { reflectance: Spectrum::rgb(rho, rho, rho), roughness };
        let (r, rho) = (f64::from(roughness), f64::from(rho));
        let (o, d) = (wo.as_dvec3(), wi.as_dvec3());
        let a = 1.0 / (1.0 + (0.5 - 2.0 / (3.0 * PI)) * r);
        let average = a * (1.0 + (2.0 / 3.0 - 28.0 / (15.0 * PI)) * r);
        let along = o.x * d.x + o.y * d.y;
        let along = if along > 0.0 { along / o.z.max(d.z) } else { along };
        let once = rho * a * (1.0 + r * along);
        let lost = |cos: f64| {
            let sin = (1.0 - cos * cos).max(0.0).sqrt();
            let tip = sin / cos * (1.0 - sin.powi(3)) - sin;
            1.0 - a * (1.0 + r / PI * (sin * (cos.acos() - sin * cos) + 2.0 / 3.0 * tip))
        };
        let again = rho * rho * average / (1.0 - rho * (1.0 - average)) / (1.0 - average);
        let exact = (once + again * lost(o.z) * lost(d.z)) * d.z / PI;
        let found = f64::from(lobe.eval(wo, wi)[0]);
        assert!((found - exact).abs() < 1e-6, "{roughness} {wo} {wi}: {found} for {exact}");
    }
}
