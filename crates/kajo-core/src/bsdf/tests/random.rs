//! Laws of the layered lobe for any parameters.

use kajo_color::Spectrum;
use kajo_math::{Vec2, Vec3, warp};
use proptest::prelude::*;

use super::super::*;

fn color() -> impl Strategy<Value = Spectrum> {
    prop_oneof![
        Just(Spectrum::WHITE),
        Just(Spectrum::BLACK),
        (0f32..=1.0, 0f32..=1.0, 0f32..=1.0).prop_map(|(r, g, b)| Spectrum::rgb(r, g, b)),
    ]
}

fn share() -> impl Strategy<Value = f32> {
    prop_oneof![Just(0.0f32), Just(1.0), 0f32..=1.0]
}

fn specular() -> impl Strategy<Value = Specular> {
    let ends = |(color, scale, weight): (Spectrum, f32, f32)| {
        let factor = color * scale;
        Specular::F0 { factor, largest: factor.max_lane(), weight }
    };
    prop_oneof![color().prop_map(Specular::Factor), (color(), 0f32..20.0, share()).prop_map(ends)]
}

fn layers() -> impl Strategy<Value = Principled> {
    let base = prop_oneof![Just(Base::Diffuse), Just(Base::Metal), Just(Base::Glass)];
    let surface = (base, color(), specular(), share(), share(), share(), 1f32..3.0);
    let above = (share(), color(), share(), 1f32..3.0, share(), color(), share());
    (surface, above).prop_map(|(surface, above)| {
        let (base, color, specular, diffuse_roughness, alpha_x, alpha_y, eta) = surface;
        let (coat, coat_color, coat_alpha, coat_eta, fuzz, fuzz_color, fuzz_roughness) = above;
        Principled {
            base,
            color,
            specular,
            diffuse_roughness,
            alpha: Vec2::new(alpha_x, alpha_y),
            eta,
            coat,
            coat_color,
            coat_alpha,
            coat_eta,
            fuzz,
            fuzz_color,
            fuzz_roughness,
            ..Principled::default()
        }
    })
}

fn body() -> impl Strategy<Value = Subsurface> {
    (layers(), color(), share(), any::<bool>()).prop_map(|(layers, specular, share, is_tinted)| Subsurface {
        color: layers.color,
        share,
        is_tinted,
        specular,
        alpha: layers.alpha,
        eta: layers.eta,
        coat: layers.coat,
        coat_color: layers.coat_color,
        coat_alpha: layers.coat_alpha,
        coat_eta: layers.coat_eta,
        fuzz: layers.fuzz,
        fuzz_color: layers.fuzz_color,
        fuzz_roughness: layers.fuzz_roughness,
        ..Subsurface::default()
    })
}

fn direction() -> impl Strategy<Value = Vec3> {
    (0f32..1.0, 0f32..1.0).prop_map(|(x, y)| warp::uniform_sphere(Vec2::new(x, y)))
}

proptest! {
    #[test]
    fn layers_of_any_kind_give_numbers_and_fair_weights(
        layers in layers(),
        (wo, wi) in (direction(), direction()),
        (u, v, uc) in (0f32..1.0, 0f32..1.0, 0f32..1.0),
    ) {
        check(&Bsdf::Principled(layers), (wo, wi), (Vec2::new(u, v), uc))?;
    }

    #[test]
    fn bodies_below_layers_give_numbers_and_fair_weights(
        body in body(),
        (wo, wi) in (direction(), direction()),
        (u, v, uc) in (0f32..1.0, 0f32..1.0, 0f32..1.0),
    ) {
        check(&Bsdf::Subsurface(body), (wo, wi), (Vec2::new(u, v), uc))?;
    }
}

/// Along the surface from opposite sides, where the half vector is the small difference of two unit vectors.
#[test]
fn grazing_light_is_alike_both_ways() {
    let layers = Principled {
        color: Spectrum::WHITE,
        specular: Specular::Factor(Spectrum::rgb(0.0, 0.0, 0.1649199)),
        alpha: Vec2::new(1.0, 0.0),
        eta: 1.5672308,
        ..Principled::default()
    };
    let wo = Vec3::new(-0.010407319, -0.9990829, 0.041534066);
    let wi = Vec3::new(-0.04641022, 0.998842, 0.012673676);
    let glass = Principled { base: Base::Glass, ..layers };
    for layers in [glass, layers] {
        check(&Bsdf::Principled(layers), (wo, wi), (Vec2::ZERO, 0.0)).expect("the same both ways");
    }
}

fn check(lobe: &Bsdf<'_>, (wo, wi): (Vec3, Vec3), (u, uc): (Vec2, f32)) -> Result<(), TestCaseError> {
    for mode in [Transport::Radiance, Transport::Importance] {
        let f = lobe.eval(wo, wi, mode);
        prop_assert!(f.is_finite() && f.to_rgb().iter().all(|&v| v >= 0.0), "{f:?}");
        let Some(sample) = lobe.sample(wo, u, uc, mode) else { continue };
        prop_assert!((sample.wi.length() - 1.0).abs() < 1e-4);
        prop_assert!(sample.weight.is_finite() && sample.pdf > 0.0);
        if sample.kind.delta {
            continue;
        }
        let pdf = lobe.pdf(wo, sample.wi);
        prop_assert!((pdf / sample.pdf - 1.0).abs() < 1e-2, "{pdf} {}", sample.pdf);
        let weight = lobe.eval(wo, sample.wi, mode) * (1.0 / pdf);
        prop_assert!((weight - sample.weight).map(f32::abs).max_lane() < 1e-2 * weight.max_lane().max(1.0));
    }
    let albedo = lobe.albedo(wo);
    prop_assert!(albedo.to_rgb().iter().all(|v| (0.0..=1.001).contains(v)), "{albedo:?}");
    let pdf = lobe.pdf(wo, wi);
    prop_assert!(pdf.is_finite() && pdf >= 0.0);
    // What leaves to the camera from a light is what leaves to the light from the camera.
    let (there, back) = (lobe.eval(wo, wi, Transport::Radiance), lobe.eval(wi, wo, Transport::Importance));
    let (there, back) = (there * wo.z.abs(), back * wi.z.abs());
    let off = (there - back).map(f32::abs).max_lane();
    prop_assert!(off <= 1e-5 * there.max_lane().max(1e-3), "{there:?} {back:?}");
    Ok(())
}
