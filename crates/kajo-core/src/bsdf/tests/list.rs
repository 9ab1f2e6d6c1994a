//! The lobes under test.

use kajo_color::Spectrum;

use super::super::*;
use microfacet::Shape;

/// Roughness from a sharp gloss to the end of the range.
pub const ROUGHNESSES: [f32; 10] = [0.03, 0.06, 0.1, 0.15, 0.25, 0.35, 0.5, 0.65, 0.8, 1.0];

/// A family of lobes that differ by roughness.
pub struct Family {
    pub name: &'static str,
    pub lobe: fn(f32) -> Bsdf,
    /// Whether all light comes out again.
    pub lossless: bool,
    /// Whether `f(wo, wi)` of radiance is `f(wi, wo)` of importance by itself.
    pub reciprocal: bool,
}

pub fn gold() -> MetalFresnel {
    MetalFresnel::Complex { eta: Spectrum::rgb(0.143, 0.375, 1.442), k: Spectrum::rgb(3.983, 2.386, 1.603) }
}

fn anisotropic(shape: Shape, alpha: f32) -> Microfacets {
    Microfacets { shape, alpha_x: alpha, alpha_y: (0.3 * alpha).max(0.03) }
}

fn conductor(fresnel: MetalFresnel, microfacets: Microfacets) -> Bsdf {
    Bsdf::Conductor(Conductor { fresnel, microfacets })
}

fn glass(eta: f32, microfacets: Microfacets) -> Bsdf {
    Bsdf::Dielectric(Dielectric::new(eta, microfacets))
}

fn phong(diffuse: f32, specular: f32, reflective: f32, transparent: f32, alpha: f32) -> Bsdf {
    let grey = Spectrum::grey;
    let classic = Phong {
        ambient: Spectrum::WHITE,
        diffuse: grey(diffuse),
        specular: grey(specular),
        exponent: 2.0 / (alpha * alpha) - 2.0,
        reflective: grey(reflective),
        transparent: grey(transparent),
        absorption: Spectrum::BLACK,
        eta: 1.3,
    };
    Bsdf::Phong(PhongLobes::from(&classic))
}

/// A family without promises.
const PLAIN: Family = Family { name: "", lobe: |_| Bsdf::Null, lossless: false, reciprocal: true };

pub fn families() -> Vec<Family> {
    const WHITE: MetalFresnel = MetalFresnel::Constant(Spectrum::WHITE);
    vec![
        Family {
            name: "lambert",
            lobe: |_| Bsdf::Lambert(Lambert::new(Spectrum::WHITE)),
            lossless: true,
            ..PLAIN
        },
        Family {
            name: "leaf",
            lobe: |r| {
                let (reflectance, transmittance) = (Spectrum::grey(1.0 - r), Spectrum::grey(r));
                Bsdf::Lambert(Lambert { reflectance, transmittance })
            },
            lossless: true,
            ..PLAIN
        },
        Family {
            name: "clay",
            lobe: |r| Bsdf::OrenNayar(OrenNayar { reflectance: Spectrum::WHITE, roughness: r }),
            lossless: true,
            ..PLAIN
        },
        Family {
            name: "red clay",
            lobe: |r| Bsdf::OrenNayar(OrenNayar { reflectance: Spectrum::rgb(0.7, 0.2, 0.1), roughness: r }),
            ..PLAIN
        },
        Family { name: "white metal", lobe: |a| conductor(WHITE, Microfacets::new(Shape::Ggx, a)), ..PLAIN },
        Family {
            name: "white metal, Beckmann",
            lobe: |a| conductor(WHITE, Microfacets::new(Shape::Beckmann, a)),
            ..PLAIN
        },
        Family { name: "gold", lobe: |a| conductor(gold(), Microfacets::new(Shape::Ggx, a)), ..PLAIN },
        Family { name: "brushed gold", lobe: |a| conductor(gold(), anisotropic(Shape::Ggx, a)), ..PLAIN },
        Family {
            name: "brushed gold, Beckmann",
            lobe: |a| conductor(gold(), anisotropic(Shape::Beckmann, a)),
            ..PLAIN
        },
        Family { name: "glass", lobe: |a| glass(1.5, Microfacets::new(Shape::Ggx, a)), ..PLAIN },
        Family { name: "diamond", lobe: |a| glass(2.417, Microfacets::new(Shape::Ggx, a)), ..PLAIN },
        Family { name: "bubble", lobe: |a| glass(1.0 / 1.33, Microfacets::new(Shape::Ggx, a)), ..PLAIN },
        Family {
            name: "glass, Beckmann",
            lobe: |a| glass(1.5, Microfacets::new(Shape::Beckmann, a)),
            ..PLAIN
        },
        Family { name: "scratched glass", lobe: |a| glass(1.5, anisotropic(Shape::Ggx, a)), ..PLAIN },
        Family { name: "Phong", lobe: |a| phong(0.3, 0.5, 0.0, 0.0, a), ..PLAIN },
        Family { name: "Phong with a mirror and a window", lobe: |a| phong(0.2, 0.3, 0.2, 0.3, a), ..PLAIN },
    ]
}

/// Lobes that scatter into single directions.
pub fn mirrors() -> Vec<(&'static str, Bsdf)> {
    let smooth = Microfacets::new(Shape::Ggx, 0.0);
    let pane = ThinDielectric { eta: 1.5, optical_depth: Spectrum::BLACK };
    vec![
        ("mirror", conductor(MetalFresnel::Constant(Spectrum::WHITE), smooth)),
        ("smooth glass", glass(1.5, smooth)),
        ("smooth bubble", glass(1.0 / 1.33, smooth)),
        ("pane", Bsdf::ThinDielectric(pane)),
        ("nothing", Bsdf::Null),
        ("mirrors of Phong", phong(0.0, 0.0, 0.4, 0.6, 0.5)),
    ]
}

/// Seeds of tests that take long are a quarter as many, unless `KAJO_DEEP` is set.
pub fn deep() -> bool {
    std::env::var_os("KAJO_DEEP").is_some()
}
