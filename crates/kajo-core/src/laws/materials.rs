//! Materials: one of each kind, white where it can be, for each part of a mixture.

use std::sync::{Arc, OnceLock};

use kajo_color::{Emission, Reflectance, Spectrum, Wavelengths, dispersion::Dispersion, named};
use kajo_image::Image;
use kajo_math::{Affine3, Vec2, Vec3};

use super::{Census, Draw, Furnace, Who};
use crate::Pooled;
use crate::bsdf::tests::list::directions;
use crate::bsdf::{Bsdf, Phong, Transport, microfacet::NormalDistribution};
use crate::emission::SurfaceEmission;
use crate::light::Sides;
use crate::material::{
    Appearance, Blend, BtfMaterial, BtfSettings, Embossed, Glass, GlassSettings, Grain, LayeredMaterial,
    Layers, MaterialId, Materials, Matte, MeasuredMaterial, Metal, NullInterface, Perforated, PhongMaterial,
    Relief, ShadingPoint, SpecularLayer, Substance, SubsurfaceBody,
};
use crate::measured::btf::tests::cloth_texture;
use crate::measured::{MeasuredBrdf, merl};
use crate::medium::{Coefficients, HomogeneousMedium, Phase};
use crate::texture::{
    Channel, Checker, ColorTexture, Encoding, FloatTexture, Noise, Picture, PictureChannel, PictureMap,
    SurfaceUv, TextureContext, TextureFootprint, Textures,
};

/// How far off the energy of a material without losses may be.
const TOLERANCE: f64 = 3e-3;

/// Where materials are asked.
const PLACE: TextureContext = TextureContext {
    p: Vec3::new(0.3, 0.2, 0.1),
    uv: SurfaceUv { first: Vec2::new(0.6, 0.3), second: Vec2::new(0.6, 0.3) },
    tint: None,
    n: Vec3::Z,
    time: 0.0,
    footprint: TextureFootprint::POINT,
    object_from_world: Affine3::IDENTITY,
};

/// Numbers that choose among the parts of a mixture.
const CHOICES: u32 = 16;

/// Materials with their patterns, and who is in the list.
struct Samples {
    appearance: Appearance,
    /// Each with its name and whether all light leaves it again.
    list: Vec<(MaterialId, &'static str, bool)>,
}

impl Samples {
    fn add(
        &mut self,
        name: &'static str,
        lossless: bool,
        material: impl Pooled<Materials, Handle = MaterialId>,
    ) -> MaterialId {
        let id = material.store(&mut self.appearance.materials).expect("there is room");
        self.list.push((id, name, lossless));
        id
    }

    fn at<'a>(&self, wavelengths: &'a Wavelengths, u: f32) -> ShadingPoint<'a> {
        ShadingPoint { context: &PLACE, wavelengths, eta_outside: 1.0, u }
    }

    fn bsdf(&self, id: MaterialId, wavelengths: &Wavelengths, u: f32) -> Bsdf<'_> {
        self.appearance.bsdf(id, &self.at(wavelengths, u))
    }
}

fn glass(roughness: f32, pane: Option<f32>) -> Glass {
    Glass::from(GlassSettings {
        index: Dispersion::Constant(1.5),
        shape: NormalDistribution::Ggx,
        roughness: roughness.into(),
        grain: Grain::default(),
        absorption: [0.0; 3],
        pane: pane.map(FloatTexture::Constant),
        priority: 0,
        medium: None,
    })
}

fn white_layers() -> Layers {
    let white = ColorTexture::from(Reflectance::constant(1.0));
    Layers {
        color: white.clone(),
        specular: SpecularLayer::Factor(white.clone()),
        metalness: 0.3.into(),
        transmission: 0.4.into(),
        absorption: [0.0; 3],
        thin: false,
        roughness: 0.6.into(),
        grain: Grain::default(),
        diffuse_roughness: 0.3.into(),
        eta: 1.5.into(),
        dispersion: None,
        coat: 0.5.into(),
        coat_color: white.clone(),
        coat_roughness: 0.4.into(),
        coat_eta: 1.6.into(),
        fuzz: 0.3.into(),
        fuzz_color: white,
        fuzz_roughness: 0.5.into(),
        priority: 0,
        medium: None,
        subsurface: None,
    }
}

fn samples() -> &'static Samples {
    static ALL: OnceLock<Samples> = OnceLock::new();
    ALL.get_or_init(made)
}

fn made() -> Samples {
    let mut all = Samples { appearance: Appearance::default(), list: Vec::new() };
    let white = || Reflectance::constant(1.0);
    let grey = Spectrum::grey;
    let plaster = all.add("plaster", true, Matte::new(white(), 0.0));
    let clay = all.add("clay", false, Matte::new(Reflectance::from_rgb([0.7, 0.4, 0.3]), 0.8));
    let silver =
        all.add("silver", true, Metal::new(Substance::Color(white().into()), NormalDistribution::Ggx, 0.6));
    let gold = named::metal("gold").expect("a known metal");
    all.add("gold", false, Metal::new(Substance::Measured(gold.clone()), NormalDistribution::Beckmann, 0.5));
    all.add("frosted glass", true, glass(0.5, None));
    let brushed = Grain { anisotropy: 0.7.into(), rotation: 0.1.into() };
    let tray = Metal::new(Substance::Measured(gold), NormalDistribution::Ggx, 0.5).brushed(brushed);
    all.add("tray", false, tray);
    all.add("knife", false, LayeredMaterial::from(Layers { grain: brushed, ..white_layers() }));
    all.add("pane", true, glass(0.0, Some(0.1)));
    all.add("frosted pane", true, glass(0.5, Some(0.0)));
    all.add("layers", true, LayeredMaterial::from(white_layers()));
    let milk = Coefficients::subsurface(&white(), [0.1; 3], Phase::Isotropic).expect("a medium");
    let milk = HomogeneousMedium { coefficients: milk };
    let medium = milk.store(&mut all.appearance.media).expect("there is room");
    let body = SubsurfaceBody { share: 0.8.into(), medium, is_tinted: false };
    let wax = || Layers { subsurface: Some(body), ..white_layers() };
    all.add("wax below layers", true, LayeredMaterial::from(wax()));
    let painted = SubsurfaceBody { is_tinted: true, ..body };
    all.add("painted wax", true, LayeredMaterial::from(Layers { subsurface: Some(painted), ..wax() }));
    let thin = || Layers { thin: true, ..white_layers() };
    all.add("layers with a frosted pane", true, LayeredMaterial::from(thin()));
    let polished = Layers { roughness: 0.1.into(), ..thin() };
    all.add("layers with a pane", true, LayeredMaterial::from(polished));
    let rims = SpecularLayer::F0 { factor: white().into(), scale: 3.0, weight: 1.0.into() };
    all.add("bright gloss", true, LayeredMaterial::from(Layers { specular: rims, ..white_layers() }));
    let rims = SpecularLayer::F0 {
        factor: Reflectance::from_rgb([1.0, 0.2, 0.0]).into(),
        scale: 1.0,
        weight: 0.7.into(),
    };
    all.add("coloured gloss", false, LayeredMaterial::from(Layers { specular: rims, ..white_layers() }));
    let red = Reflectance::from_rgb([0.8, 0.1, 0.1]);
    all.add("paint", false, LayeredMaterial::from(Layers { color: red.into(), ..white_layers() }));
    let classic = Phong { diffuse: grey(0.3), specular: grey(0.4), exponent: 20.0, ..Phong::BLACK };
    all.add("Phong", false, PhongMaterial::from(classic));
    let open = Phong { reflective: grey(0.2), transparent: grey(0.3), eta: 1.3, ..classic };
    all.add("Phong, clear", false, PhongMaterial::from(open));
    let cloth = Arc::new(cloth_texture());
    let settings = BtfSettings { repeat: Vec2::new(3.0, 2.0), is_filtered: true, ..BtfSettings::default() };
    all.add("cloth", false, BtfMaterial::new(cloth, settings));
    let paint = Arc::new(MeasuredBrdf::from_bytes(&merl::tests::gloss()).expect("a table"));
    all.add("measured paint", false, MeasuredMaterial::new(paint, 1.0, 0.0));
    all.add("gauze", true, Perforated { material: plaster, opacity: 0.6.into() });
    let spots = Image::from_fn(3, 3, |x, y| [0.4, 0.1 * x as f32, 0.3 * y as f32]).expect("a small picture");
    let map = PictureMap::new(Arc::new(Picture::new(&spots, Encoding::Linear).0));
    let textures = &mut all.appearance.textures;
    let node = PictureChannel { map: map.clone(), channel: Channel::Red };
    let (share, color) = (textures.float(node).unwrap(), textures.color(map.clone()).unwrap());
    let (checks, clouds) = (textures.float(Checker).unwrap(), textures.float(Noise { octaves: 2 }).unwrap());
    all.add("painted", false, Matte::new(color.clone(), share));
    all.add("tarnished", true, Metal::new(Substance::Color(white().into()), NormalDistribution::Ggx, share));
    all.add("net", true, Perforated { material: plaster, opacity: share });
    let layers = Layers { roughness: share, metalness: share, coat: share, ..white_layers() };
    all.add("worn", true, LayeredMaterial::from(layers));
    let layers = Layers { roughness: clouds, metalness: checks, fuzz: clouds, ..white_layers() };
    all.add("cloudy", false, LayeredMaterial::from(layers));
    let relief = Relief::Normals { normals: color.clone(), scale: 0.5.into() };
    all.add("hammered silver", true, Embossed { material: silver, relief });
    let relief = Relief::Heights { heights: clouds, height: 0.1 };
    all.add("dented silver", true, Embossed { material: silver, relief });
    all.add("Phong, painted", false, PhongMaterial::from(classic).with_picture(Some(color)));
    all.add("plaster and silver", true, Blend { amount: 0.3.into(), materials: [plaster, silver] });
    all.add("checks", false, Blend { amount: checks, materials: [silver, clay] });
    all
}

fn who(kind: &'static str, name: String) -> Who {
    Who { family: "material", kind, name }
}

pub(super) fn census() -> Census {
    // Gas scatters nothing, and lenses turn light. Where nothing is but the end of a medium, light goes straight on.
    let nothing = &["accretion_disks", "gravitational_lenses", "null_interfaces"];
    Census { family: "material", kinds: Materials::KINDS.to_vec(), pointlike: nothing, unpowered: nothing }
}

pub(super) fn draws() -> Vec<Draw> {
    let all = samples();
    let mut draws = Vec::new();
    for &(id, name, _) in &all.list {
        for choice in [0.1, 0.5, 0.9] {
            let bsdf = all.bsdf(id, &Wavelengths::RGB, choice);
            for wo in directions(2) {
                draws.extend(
                    (!bsdf.is_delta()).then(|| draw(id, format!("{name}, part {choice}, {wo}"), bsdf, wo)),
                );
            }
        }
    }
    draws
}

fn draw(id: MaterialId, name: String, bsdf: Bsdf<'static>, wo: Vec3) -> Draw {
    Draw {
        who: who(Materials::kind(id), name),
        draw: Box::new(move |u, uc| {
            let sample = bsdf.sample(wo, u, uc, Transport::Radiance)?;
            (!sample.kind.delta).then_some(sample.wi)
        }),
        pdf: Box::new(move |wi| bsdf.pdf(wo, wi)),
    }
}

/// Power that leaves a material in a furnace, in RGB and at four wavelengths.
pub(super) fn furnaces() -> Vec<Furnace> {
    let all = samples();
    let mut furnaces = Vec::new();
    for &(id, name, lossless) in &all.list {
        for wavelengths in [Wavelengths::RGB, Wavelengths::sample(0.4)] {
            for wo in directions(3) {
                let energy = move |u: Vec2, uc: f32| {
                    let choice = ((f64::from(uc) * 977.0).fract() * f64::from(CHOICES)) as u32;
                    let choice = (choice as f32 + 0.5) / CHOICES as f32;
                    let sample = all.bsdf(id, &wavelengths, choice).sample(wo, u, uc, Transport::Radiance);
                    sample.map_or(0.0, |sample| f64::from(sample.weight.max_lane() * sample.eta * sample.eta))
                };
                furnaces.push(Furnace {
                    who: who(Materials::kind(id), format!("{name} from {wo}")),
                    energy: Box::new(energy),
                    expected: [if lossless { 1.0 - TOLERANCE } else { 0.0 }, 1.0 + TOLERANCE],
                });
            }
        }
    }
    furnaces
}

/// What a material says of itself is so.
#[test]
fn materials_are_what_they_say() {
    let all = samples();
    let appearance = &all.appearance;
    let u = [0.05, 0.25, 0.45, 0.65, 0.85, 0.95];
    for &(id, name, _) in &all.list {
        let parts: Vec<Bsdf> =
            (0..1000).map(|i| all.bsdf(id, &Wavelengths::RGB, (i as f32 + 0.5) / 1000.0)).collect();
        let differs = |bsdf: &Bsdf| format!("{bsdf:?}") != format!("{:?}", parts[0]);
        assert!(appearance.materials.is_mixture(id) || !parts.iter().any(differs), "{name} has parts");
        let cos = 0.4;
        let passed = |bsdf: &Bsdf| match bsdf {
            Bsdf::Null => Spectrum::WHITE,
            Bsdf::ThinDielectric(pane) => pane.passage(cos),
            _ => Spectrum::BLACK,
        };
        let mean = parts.iter().map(passed).fold(Spectrum::BLACK, |sum, share| sum + share) * 1e-3;
        let passage = appearance.passage(id, &all.at(&Wavelengths::RGB, 0.5), cos);
        let off = (passage - mean).to_rgb().map(f32::abs);
        assert!(
            off.iter().all(|&off| off < 2e-3),
            "{name} lets {passage:?} pass straight on, its parts {mean:?}"
        );
        assert_eq!(!mean.is_black(), appearance.has_passages(id), "{name}");
        let crosses = parts.iter().any(|bsdf| {
            let samples = u
                .iter()
                .flat_map(|&uc| u.map(|v| bsdf.sample(Vec3::Z, Vec2::new(v, uc), uc, Transport::Radiance)));
            samples.flatten().any(|sample| sample.kind.transmission)
        });
        assert_eq!(crosses, appearance.may_transmit(id), "{name}");
        if let Some(constant) = appearance.materials.constant(id) {
            assert_eq!(*constant, appearance.phong(id, &PLACE), "{name}");
        }
        let enters = u.map(|u| appearance.interior(id, &all.at(&Wavelengths::RGB, u)));
        assert!(crosses || enters.iter().all(Option::is_none), "{name} has no inside that light can reach");
    }
}

/// A blend of a material with itself, a relief without heights and a surface without holes answer all questions as the material does; but
/// holes, which there might be, let light in without a boundary.
#[test]
fn wrappers_answer_as_what_they_wrap() {
    let Samples { mut appearance, .. } = made();
    let checks = appearance.textures.float(Checker).expect("there is room");
    let boundary = NullInterface { medium: appearance.media.ids().next(), priority: 3 };
    boundary.store(&mut appearance.materials).expect("there is room");
    let ids: Vec<MaterialId> = appearance.materials.ids().collect();
    for part in ids {
        let pool = &mut appearance.materials;
        let blend = Blend { amount: 0.0.into(), materials: [part; 2] }.store(pool);
        let relief = Relief::Heights { heights: 0.5.into(), height: 0.0 };
        let flat = Embossed { material: part, relief }.store(pool);
        let whole = Perforated { material: part, opacity: 1.0.into() }.store(pool);
        let [blend, flat, whole] = [blend, flat, whole].map(|id| id.expect("there is room"));
        let all = &appearance;
        // The light of the parts is what the builder says it is: here in a pattern, from one side.
        let light = SurfaceEmission::from(Emission::from_rgb([1.0, 2.0, 3.0])).on(Sides::Front).times(checks);
        let of_part = |id| if id == part { light.clone() } else { SurfaceEmission::default() };
        for wrapped in [blend, flat, whole] {
            let shines = all.materials.emission(wrapped, &of_part, &mut Textures::default());
            assert_eq!(format!("{shines:?}"), format!("{:?}", Some(&light)), "{}", Materials::kind(wrapped));
        }
        let context = TextureContext { uv: Vec2::new(0.3, 0.6).into(), ..TextureContext::default() };
        for u in [0.1, 0.7] {
            let at = ShadingPoint { context: &context, wavelengths: &Wavelengths::RGB, eta_outside: 1.0, u };
            let scattered = |id| {
                let flags = [all.needs_uv(id), all.has_medium(id), all.bends_light(id)];
                let passage = all.passage(id, &at, 0.7);
                format!("{:?} {passage:?} {:?} {flags:?}", all.bsdf(id, &at), all.phong(id, &context))
            };
            for wrapped in [blend, flat, whole] {
                assert_eq!(scattered(wrapped), scattered(part), "{}", Materials::kind(wrapped));
            }
            let inside = |id| {
                let flags = [all.may_transmit(id), all.has_passages(id)];
                format!("{:?} {flags:?}", all.interior(id, &at))
            };
            assert_eq!([inside(blend), inside(flat)], [inside(part), inside(part)]);
            assert!(all.interior(whole, &at).is_none() && all.may_transmit(whole) && all.has_passages(whole));
            let turn = |id| (all.orientation(id, &at).turn, all.is_oriented(id));
            assert_eq!([turn(blend), turn(whole)], [turn(part), turn(part)]);
            assert_eq!((all.orientation(flat, &at).turn, all.is_oriented(flat)), (turn(part).0, true));
        }
    }
}
