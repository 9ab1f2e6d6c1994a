//! A colour at a place makes the base colour another one, and nothing else.

use kajo_color::{Reflectance, Spectrum, Wavelengths};
use kajo_math::{Vec2, Vec3};

use super::*;
use crate::bsdf::{Phong, Transport, microfacet::NormalDistribution};
use crate::family::Pooled;

const TINT: Vec3 = Vec3::new(0.5, 0.25, 1.0);

/// What a material of a colour, each times `by`, scatters where there is such a tint.
fn materials(by: Vec3) -> [(&'static str, Appearance, MaterialId); 5] {
    let color = |rgb: Vec3| Reflectance::from_rgb((rgb * by).to_array());
    let grey = color(Vec3::new(0.6, 0.8, 0.4));
    let spectrum = |rgb: Vec3| Spectrum::from(rgb * by);
    let phong = Phong {
        ambient: spectrum(Vec3::splat(0.5)),
        diffuse: spectrum(Vec3::new(0.2, 0.6, 0.8)),
        specular: Spectrum::rgb(0.3, 0.2, 0.1),
        exponent: 5.0,
        ..Phong::BLACK
    };
    let layers =
        Layers { color: grey.clone().into(), coat: 0.5.into(), metalness: 0.25.into(), ..Layers::default() };
    let mut pools: [Appearance; 5] = Default::default();
    let ids = [
        Matte::new(grey.clone(), 0.3).store(&mut pools[0].materials),
        Matte::new(grey.clone(), 0.0).store(&mut pools[1].materials),
        Metal::new(Substance::Color(grey.into()), NormalDistribution::Ggx, 0.4)
            .store(&mut pools[2].materials),
        PhongMaterial::from(phong).store(&mut pools[3].materials),
        LayeredMaterial::from(layers).store(&mut pools[4].materials),
    ];
    let mut ids = ids.into_iter().flatten();
    let names = ["rough", "matt", "metal", "phong", "layers"];
    let mut names = names.into_iter();
    pools.map(|pool| (names.next().unwrap(), pool, ids.next().unwrap()))
}

#[test]
fn a_tint_is_a_factor_of_the_base_colour() {
    let tinted = TextureContext { tint: Some(TINT.extend(1.0)), ..TextureContext::default() };
    let wo = Vec3::new(0.3, 0.1, 0.9).normalize();
    let wi = Vec3::new(-0.4, 0.2, 0.8).normalize();
    for ((name, plain, id), (_, other, own)) in std::iter::zip(materials(Vec3::ONE), materials(TINT)) {
        let near = |a: Spectrum, b: Spectrum| {
            let (a, b) = (Vec3::from(a.to_rgb()), Vec3::from(b.to_rgb()));
            assert!((a - b).abs().max_element() <= 1e-5 * (1.0 + b.abs().max_element()), "{name}: {a} {b}");
        };
        let [a, b] = [plain.phong(id, &tinted), other.phong(own, &TextureContext::default())];
        near(a.diffuse, b.diffuse);
        near(a.ambient, b.ambient);
        near(a.specular, b.specular);
        near(a.reflective, b.reflective);
        for u in [0.1, 0.6] {
            let at = |context| ShadingPoint { context, wavelengths: &Wavelengths::RGB, eta_outside: 1.0, u };
            let a = plain.bsdf(id, &at(&tinted)).eval(wo, wi, Transport::Radiance);
            let b = other.bsdf(own, &at(&TextureContext::default()));
            near(a, b.eval(wo, wi, Transport::Radiance));
        }
        let untinted = TextureContext { uv: Vec2::ONE.into(), ..TextureContext::default() };
        assert_eq!(plain.materials.constant(id), Some(&plain.phong(id, &untinted)), "{name}");
    }
}
