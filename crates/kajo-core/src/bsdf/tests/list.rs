//! The lobes under test.

use std::f32::consts::TAU;
use std::sync::OnceLock;

use kajo_color::{RgbBasis, Spectrum, Wavelengths};

use super::super::*;
use crate::measured::btf::{Btf, tests::cloth_texture};
use crate::measured::{MeasuredBrdf, merl, rgl};
use microfacet::NormalDistribution;

/// Roughness from a sharp gloss to the end of the range.
pub const ROUGHNESSES: [f32; 10] = [0.03, 0.06, 0.1, 0.15, 0.25, 0.35, 0.5, 0.65, 0.8, 1.0];

/// A family of lobes that differ by roughness.
pub struct Family {
    pub name: &'static str,
    pub lobe: fn(f32) -> Bsdf<'static>,
    /// Whether all light comes out again.
    pub lossless: bool,
    /// How far off the energy may be.
    pub tolerance: f64,
}

pub fn gold() -> MetalFresnel {
    MetalFresnel::Complex {
        eta: Spectrum::from([0.143, 0.375, 1.442, 0.2]),
        k: Spectrum::from([3.983, 2.386, 1.603, 3.0]),
    }
}

fn anisotropic(shape: NormalDistribution, alpha: f32) -> Microfacets {
    Microfacets { shape, alpha_x: alpha, alpha_y: (0.3 * alpha).max(0.03) }
}

fn conductor(fresnel: MetalFresnel, microfacets: Microfacets) -> Bsdf<'static> {
    Bsdf::Conductor(Conductor { fresnel, microfacets })
}

fn glass(eta: f32, microfacets: Microfacets) -> Bsdf<'static> {
    Bsdf::Dielectric(Dielectric::new(eta, microfacets))
}

fn pane(eta: f32, optical_depth: Spectrum, microfacets: Microfacets) -> Bsdf<'static> {
    Bsdf::ThinDielectric(ThinDielectric { eta, optical_depth, microfacets })
}

/// The classic model, its highlight as wide as a roughness of `alpha`.
pub fn phong(diffuse: f32, specular: f32, reflective: f32, transparent: f32, alpha: f32) -> Bsdf<'static> {
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

/// White layers.
fn layered(base: Base, alpha: f32, coat: f32, fuzz: f32) -> Bsdf<'static> {
    let (color, alpha, coat_alpha) = (Spectrum::WHITE, Vec2::splat(alpha), (0.3 * alpha).max(0.05));
    Bsdf::Principled(Principled { base, color, alpha, coat, coat_alpha, fuzz, ..Principled::default() })
}

/// White layers over a body.
fn skin(share: f32, alpha: f32, coat: f32, fuzz: f32) -> Subsurface {
    let (color, alpha, coat_alpha) = (Spectrum::WHITE, Vec2::splat(alpha), (0.3 * alpha).max(0.05));
    Subsurface { color, share, alpha, coat, coat_alpha, fuzz, ..Subsurface::default() }
}

/// A white diffuse base below a gloss whose facets reflect a factor of what they do at normal incidence.
fn glossy(alpha: f32, eta: f32, factor: f32, weight: f32) -> Bsdf<'static> {
    let specular = Specular::F0 { factor: Spectrum::grey(factor), largest: factor, weight };
    let (color, alpha) = (Spectrum::WHITE, Vec2::splat(alpha));
    Bsdf::Principled(Principled { color, alpha, eta, specular, ..Principled::default() })
}

/// The same with its diffuse light scattered about a normal that leans by half a right angle from that of the frame.
fn bumped(lobe: Bsdf<'static>) -> Bsdf<'static> {
    lobe.with_diffuse_normal(Vec3::new(0.5, -0.5, 0.5f32.sqrt()), Vec3::Z).expect("a diffuse part")
}

/// A family without promises.
const PLAIN: Family = Family { name: "", lobe: |_| Bsdf::Null, lossless: false, tolerance: 0.003 };

/// Texels of a texture with highlights that turn from row to row, known at directions 18 degrees apart.
fn cloth(texel: i64) -> Bsdf<'static> {
    static CLOTH: OnceLock<Btf> = OnceLock::new();
    let btf = CLOTH.get_or_init(cloth_texture);
    let basis = RgbBasis::new(&Wavelengths::RGB);
    Bsdf::Btf(BtfLobe { btf, texel: btf.texel(0, texel, texel), scale: 1.0, basis })
}

/// Facets in the form of RGL, and a gloss in that of MERL.
fn measured(is_merl: bool) -> Bsdf<'static> {
    static TABLES: OnceLock<[MeasuredBrdf; 2]> = OnceLock::new();
    let [rgl, merl] = TABLES.get_or_init(|| {
        let files = [rgl::tests::file(rgl::tests::Facets(0.4, 0.25), false), merl::tests::gloss()];
        files.map(|file| MeasuredBrdf::from_bytes(&file).expect("a table"))
    });
    let brdf = if is_merl { merl } else { rgl };
    Bsdf::Measured(MeasuredLobe { brdf, scale: 1.0, lanes: brdf.lanes(&Wavelengths::RGB) })
}

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
        Family { name: "cloth", lobe: |r| cloth((7.0 * r) as i64), ..PLAIN },
        Family { name: "table of RGL", lobe: |_| measured(false), tolerance: 0.02, ..PLAIN },
        Family { name: "table of MERL", lobe: |_| measured(true), tolerance: 0.02, ..PLAIN },
        Family {
            name: "white metal",
            lobe: |a| conductor(WHITE, Microfacets::new(NormalDistribution::Ggx, a)),
            ..PLAIN
        },
        Family {
            name: "white metal, Beckmann",
            lobe: |a| conductor(WHITE, Microfacets::new(NormalDistribution::Beckmann, a)),
            lossless: true,
            ..PLAIN
        },
        Family {
            name: "gold",
            lobe: |a| conductor(gold(), Microfacets::new(NormalDistribution::Ggx, a)),
            ..PLAIN
        },
        Family {
            name: "brushed white metal",
            lobe: |a| conductor(WHITE, anisotropic(NormalDistribution::Ggx, a)),
            lossless: true,
            tolerance: 0.01,
        },
        Family {
            name: "grooved white metal",
            lobe: |a| conductor(WHITE, Microfacets::brushed(NormalDistribution::Ggx, a, 0.95)),
            lossless: true,
            tolerance: 0.01,
        },
        Family {
            name: "brushed white metal, Beckmann",
            lobe: |a| conductor(WHITE, anisotropic(NormalDistribution::Beckmann, a)),
            lossless: true,
            tolerance: 0.02,
        },
        Family {
            name: "brushed gold",
            lobe: |a| conductor(gold(), anisotropic(NormalDistribution::Ggx, a)),
            ..PLAIN
        },
        Family {
            name: "brushed gold, Beckmann",
            lobe: |a| conductor(gold(), anisotropic(NormalDistribution::Beckmann, a)),
            ..PLAIN
        },
        Family {
            name: "glass",
            lobe: |a| glass(1.5, Microfacets::new(NormalDistribution::Ggx, a)),
            lossless: true,
            ..PLAIN
        },
        Family {
            name: "diamond",
            lobe: |a| glass(2.417, Microfacets::new(NormalDistribution::Ggx, a)),
            lossless: true,
            ..PLAIN
        },
        Family {
            name: "bubble",
            lobe: |a| glass(1.0 / 1.33, Microfacets::new(NormalDistribution::Ggx, a)),
            lossless: true,
            ..PLAIN
        },
        Family {
            name: "glass, Beckmann",
            lobe: |a| glass(1.5, Microfacets::new(NormalDistribution::Beckmann, a)),
            lossless: true,
            ..PLAIN
        },
        Family {
            name: "scratched glass",
            lobe: |a| glass(1.5, anisotropic(NormalDistribution::Ggx, a)),
            lossless: true,
            tolerance: 0.007,
        },
        Family {
            name: "scratched glass, Beckmann",
            lobe: |a| glass(1.5, anisotropic(NormalDistribution::Beckmann, a)),
            lossless: true,
            tolerance: 0.007,
        },
        Family {
            name: "grooved diamond",
            lobe: |a| glass(2.417, Microfacets::brushed(NormalDistribution::Ggx, a, 0.9)),
            lossless: true,
            tolerance: 0.01,
        },
        Family {
            name: "brushed bubble",
            lobe: |a| glass(1.0 / 1.33, Microfacets::brushed(NormalDistribution::Ggx, a, 0.5)),
            lossless: true,
            tolerance: 0.007,
        },
        Family {
            name: "brushed plastic",
            lobe: |a| {
                let Microfacets { alpha_x, alpha_y, .. } =
                    Microfacets::brushed(NormalDistribution::Ggx, a, 0.8);
                let alpha = Vec2::new(alpha_x, alpha_y);
                Bsdf::Principled(Principled { color: Spectrum::WHITE, alpha, ..Principled::default() })
            },
            lossless: true,
            tolerance: 0.005,
        },
        Family {
            name: "frosted pane",
            lobe: |a| pane(1.5, Spectrum::BLACK, Microfacets::new(NormalDistribution::Ggx, a)),
            lossless: true,
            ..PLAIN
        },
        Family {
            name: "frosted pane, Beckmann",
            lobe: |a| pane(2.0, Spectrum::BLACK, Microfacets::new(NormalDistribution::Beckmann, a)),
            lossless: true,
            ..PLAIN
        },
        Family {
            name: "brushed green pane",
            lobe: |a| pane(1.5, Spectrum::rgb(0.8, 0.1, 1.2), anisotropic(NormalDistribution::Ggx, a)),
            tolerance: 0.01,
            ..PLAIN
        },
        Family { name: "plastic", lobe: |a| layered(Base::Diffuse, a, 0.0, 0.0), lossless: true, ..PLAIN },
        Family {
            name: "plastic of a bright gloss",
            lobe: |a| glossy(a, 1.5, 5.0, 1.0),
            lossless: true,
            ..PLAIN
        },
        Family {
            name: "plastic of a dim gloss",
            lobe: |a| glossy(a, 1.5, 0.3, 1.0),
            lossless: true,
            ..PLAIN
        },
        Family { name: "plastic of rims only", lobe: |a| glossy(a, 1.5, 0.0, 0.8), lossless: true, ..PLAIN },
        Family { name: "lacquer of rims only", lobe: |a| glossy(a, 2.5, 0.0, 1.0), lossless: true, ..PLAIN },
        Family { name: "car paint", lobe: |a| layered(Base::Metal, a, 0.8, 0.0), lossless: true, ..PLAIN },
        Family { name: "peach", lobe: |a| layered(Base::Diffuse, a, 0.0, 0.9), lossless: true, ..PLAIN },
        Family { name: "dusty coat", lobe: |a| layered(Base::Diffuse, a, 1.0, 0.5), lossless: true, ..PLAIN },
        Family { name: "coated glass", lobe: |a| layered(Base::Glass, a, 0.5, 0.3), lossless: true, ..PLAIN },
        Family { name: "jade", lobe: |a| Bsdf::Subsurface(skin(1.0, a, 0.0, 0.0)), lossless: true, ..PLAIN },
        Family {
            name: "half of wax under a coat",
            lobe: |a| Bsdf::Subsurface(skin(0.5, a, 0.7, 0.0)),
            lossless: true,
            ..PLAIN
        },
        Family { name: "skin", lobe: |a| Bsdf::Subsurface(skin(0.9, a, 0.4, 0.6)), lossless: true, ..PLAIN },
        Family {
            name: "body below tinted layers",
            lobe: |a| {
                Bsdf::Subsurface(Subsurface {
                    color: Spectrum::rgb(0.2, 0.5, 0.9),
                    is_tinted: true,
                    specular: Spectrum::rgb(1.0, 0.8, 0.6),
                    coat_color: Spectrum::rgb(0.9, 0.5, 0.3),
                    fuzz_color: Spectrum::rgb(0.9, 0.3, 0.3),
                    ..skin(0.7, a, 0.6, 0.4)
                })
            },
            ..PLAIN
        },
        Family {
            name: "body with a relief",
            lobe: |a| bumped(Bsdf::Subsurface(skin(0.7, a, 0.5, 0.4))),
            tolerance: 0.1,
            ..PLAIN
        },
        Family {
            name: "tinted layers",
            lobe: |a| {
                Bsdf::Principled(Principled {
                    color: Spectrum::rgb(0.2, 0.5, 0.9),
                    specular: Specular::Factor(Spectrum::rgb(1.0, 0.8, 0.6)),
                    diffuse_roughness: a,
                    alpha: Vec2::new(a, 0.5 * a),
                    coat: 0.7,
                    coat_color: Spectrum::rgb(0.9, 0.5, 0.3),
                    coat_alpha: 0.1,
                    fuzz: 0.4,
                    fuzz_color: Spectrum::rgb(0.9, 0.3, 0.3),
                    fuzz_roughness: a,
                    ..Principled::default()
                })
            },
            ..PLAIN
        },
        Family {
            name: "leaf with a relief",
            lobe: |r| {
                let (reflectance, transmittance) = (Spectrum::grey(1.0 - r), Spectrum::grey(r));
                bumped(Bsdf::Lambert(Lambert { reflectance, transmittance }))
            },
            ..PLAIN
        },
        Family {
            name: "clay with a relief",
            lobe: |r| bumped(Bsdf::OrenNayar(OrenNayar { reflectance: Spectrum::WHITE, roughness: r })),
            ..PLAIN
        },
        Family {
            name: "peach with a relief",
            lobe: |a| bumped(layered(Base::Diffuse, a, 0.5, 0.9)),
            tolerance: 0.1,
            ..PLAIN
        },
        Family { name: "Phong with a relief", lobe: |a| bumped(phong(0.3, 0.5, 0.0, 0.0, a)), ..PLAIN },
        Family { name: "Phong", lobe: |a| phong(0.3, 0.5, 0.0, 0.0, a), ..PLAIN },
        Family { name: "Phong with a mirror and a window", lobe: |a| phong(0.2, 0.3, 0.2, 0.3, a), ..PLAIN },
    ]
}

/// Lobes that scatter into single directions.
pub fn mirrors() -> Vec<(&'static str, Bsdf<'static>)> {
    let smooth = Microfacets::new(NormalDistribution::Ggx, 0.0);
    vec![
        ("mirror", conductor(MetalFresnel::Constant(Spectrum::WHITE), smooth)),
        ("smooth glass", glass(1.5, smooth)),
        ("smooth bubble", glass(1.0 / 1.33, smooth)),
        ("pane", pane(1.5, Spectrum::BLACK, smooth)),
        ("nothing", Bsdf::Null),
        ("weak lens", Bsdf::Deflector(Deflector { shift: Vec2::new(3e-4, -4e-4) })),
        ("mirrors of Phong", phong(0.0, 0.0, 0.4, 0.6, 0.5)),
    ]
}

/// Directions from straight above to nearly along the surface, on both sides.
pub fn directions(n: u32) -> impl Iterator<Item = Vec3> {
    (0..n).map(move |i| {
        let z = 1.0 - 0.95 * i as f32 / (n - 1) as f32;
        let (s, c) = (TAU * 0.618_034 * i as f32).sin_cos();
        let r = (1.0 - z * z).max(0.0).sqrt();
        Vec3::new(r * c, r * s, if i % 2 == 1 { -z } else { z })
    })
}

/// Whether tests that take long are to be run in full: `KAJO_DEEP` is set.
pub fn deep() -> bool {
    kajo_testkit::is_deep()
}
