//! Lights: as places to start from, and as places to look at.

use std::sync::Arc;

use kajo_color::Wavelengths;
use kajo_math::{Vec2, Vec3, rng::Stream};

use super::{Census, Draw, Furnace, Who};
use crate::background::Background;
use crate::daylight::{Sky, SkySettings};
use crate::family::Pooled;
use crate::light::tests::densities::KnownSurface;
use crate::light::tests::emission::{KnownLight, WORLD, every_light};
use crate::light::tests::{AFTERNOON, MeanEmission};
use crate::light::{
    LeNumbers, LightId, LightLeSample, LightLiSample, LightPoint, Lights, Receiver, SkyLight,
};

/// How far off the power is that lights are chosen by, of those in the list.
const TOLERANCE: f64 = 3e-3;

fn who(kind: &'static str, name: String) -> Who {
    Who { family: "light", kind, name }
}

pub(super) fn census() -> Census {
    Census { family: "light", kinds: Lights::KINDS.to_vec(), pointlike: &[], unpowered: &[] }
}

pub(super) fn draws() -> Vec<Draw> {
    let (mut lights, mut list) = every_light();
    // Without its sun, which is too small for the cells of the test.
    let sky = Sky::new(&SkySettings { sun: false, ..AFTERNOON });
    let clear = SkyLight::new(Arc::new(Background::Sky(Box::new(sky)))).store(&mut lights);
    list.extend(clear.map(|id| KnownLight { id, power: 0.0, surface: None }));
    let lights = Arc::new(lights);
    let entries = |(i, light): (usize, &KnownLight)| {
        let towards = [false, true].map(|is_beside| towards(&lights, light, i, is_beside));
        [leaving(&lights, light.id, i)].into_iter().chain(towards)
    };
    list.iter().enumerate().flat_map(entries).flatten().collect()
}

/// Directions in which light leaves one point of a light.
fn leaving(lights: &Arc<Lights>, id: LightId, number: usize) -> Option<Draw> {
    let position = Vec2::new(0.37, 0.61);
    let leave = move |lights: &Lights, direction: Vec2| -> Option<LightLeSample> {
        let numbers = LeNumbers { position, direction };
        lights.sample_le(id, 0.0, numbers, &Wavelengths::RGB, &WORLD, &MeanEmission)
    };
    let tries = (0..10).map(|i| Vec2::new(0.2, 0.05 + 0.1 * i as f32));
    let first = tries.filter_map(|u| leave(lights, u)).next()?;
    if first.is_delta && first.at.is_infinite() {
        return None;
    }
    let at = match first.at {
        LightPoint::Infinite { .. } => LightPoint::Infinite { through: WORLD.center },
        near => near,
    };
    let (drawn, dense) = (Arc::clone(lights), Arc::clone(lights));
    Some(Draw {
        who: who(Lights::kind(id), format!("number {number}, leaving")),
        draw: Box::new(move |u, _| leave(&drawn, u).map(|leaving| leaving.d)),
        pdf: Box::new(move |d| dense.pdf_le(id, 0.0, &at, d, &WORLD).direction),
    })
}

/// Directions from a receiver to a light that has an extent.
///
/// * `is_beside`: for paths that find the light by scattering too, which only skies tell apart
fn towards(lights: &Arc<Lights>, light: &KnownLight, number: usize, is_beside: bool) -> Option<Draw> {
    let KnownLight { id, surface, .. } = *light;
    if is_beside && !lights.is_background(id) {
        return None;
    }
    let to = receiver_of(surface.as_ref());
    let (drawn, dense) = (Arc::clone(lights), Arc::clone(lights));
    let sample = move |u: Vec2| match is_beside {
        true => drawn.sample_li_beside_scattering(id, &to, u, &Wavelengths::RGB, &MeanEmission),
        false => drawn.sample_li(id, &to, u, &Wavelengths::RGB, &MeanEmission),
    };
    if sample(Vec2::splat(0.4)).is_none_or(|sample| sample.is_delta) {
        return None;
    }
    Some(Draw {
        who: who(
            Lights::kind(id),
            format!(
                "number {number}, towards a receiver{}",
                if is_beside { " beside scattering" } else { "" }
            ),
        ),
        draw: Box::new(move |u, _| Some(sample(u)?.wi)),
        pdf: Box::new(move |wi| {
            let at_infinity = || vec![LightPoint::Infinite { through: to.p }];
            let points = surface.map_or_else(at_infinity, |surface| surface.points(wi));
            let pdf = |at| match is_beside {
                true => dense.pdf_li_beside_scattering(id, &to, at, wi),
                false => dense.pdf_li(id, &to, at, wi),
            };
            points.iter().map(pdf).sum()
        }),
    })
}

fn receiver_of(surface: Option<&KnownSurface>) -> Receiver {
    Receiver { p: surface.map_or(Vec3::ZERO, |surface| surface.receiver), ..Receiver::default() }
}

/// What lights send out, over the power that is known of them.
pub(super) fn furnaces() -> Vec<Furnace> {
    let (lights, list) = every_light();
    let lights = Arc::new(lights);
    let furnace = |(number, KnownLight { id, power, .. }): (usize, KnownLight)| {
        let lights = Arc::clone(&lights);
        Furnace {
            who: who(Lights::kind(id), format!("number {number}")),
            energy: Box::new(move |u, uc| {
                let numbers = LeNumbers { position: u, direction: Vec2::new(uc, (uc * 977.0).fract()) };
                let leaving = lights.sample_le(id, 0.0, numbers, &Wavelengths::RGB, &WORLD, &MeanEmission);
                // Rays along the surface are none; the scene leaves them out too.
                let usable = leaving.filter(|leaving| leaving.pdf.position * leaving.pdf.direction > 0.0);
                usable.map_or(0.0, |leaving| f64::from(leaving.power()[0])) / power
            }),
            expected: [1.0 - TOLERANCE, 1.0 + TOLERANCE],
        }
    };
    list.into_iter().enumerate().map(furnace).collect()
}

/// Points of a light's surface have the density that they are drawn with. A light that is
/// a point, or has no position, has none.
#[test]
fn points_of_surfaces_are_drawn_with_their_density() {
    let (lights, list) = every_light();
    let mut drawn = 0;
    for (i, &KnownLight { id, .. }) in list.iter().enumerate() {
        let is_surface = lights.is_surface(id);
        assert!(!is_surface || lights.apex(id).is_none(), "light {i}");
        for k in 0..100 {
            let s = Stream::new(62, [k, i as u32], 0);
            let Some((at, pdf)) = lights.sample_area(id, Vec2::new(s.uniform(0), s.uniform(1)), 0.3) else {
                continue;
            };
            drawn += 1;
            assert!(is_surface && matches!(at, LightPoint::Surface { .. }), "light {i}");
            assert!(pdf > 0.0 && lights.pdf_area(id, at.p(), 0.3) == pdf, "light {i}");
            let bounds = lights.bounds(id).unwrap().bounds;
            assert!(
                (bounds.center() - at.p()).abs().cmple(0.501 * bounds.extent() + 1e-4).all(),
                "light {i}"
            );
        }
        assert!(is_surface || lights.pdf_area(id, Vec3::ZERO, 0.3) == 0.0, "light {i}");
    }
    assert!(drawn > 300, "{drawn}");
}

/// What a sample says of its own density is what is said when asked for it, by every light for any receiver.
#[test]
fn samples_and_densities_for_a_receiver_agree() {
    let (lights, list) = every_light();
    let mut kinds = std::collections::BTreeSet::new();
    for (i, &KnownLight { id, .. }) in list.iter().enumerate() {
        for k in 0..500 {
            let s = Stream::new(61, [k, i as u32], 0);
            let p = 6.0 * Vec3::new(s.uniform(0), s.uniform(1), s.uniform(2)) - 3.0;
            let to = Receiver { p, ..Receiver::default() };
            let u = Vec2::new(s.uniform(3), s.uniform(4));
            let Some(sample) = lights.sample_li(id, &to, u, &Wavelengths::RGB, &MeanEmission) else {
                continue;
            };
            kinds.insert(Lights::kind(id));
            assert!((sample.wi.length() - 1.0).abs() < 1e-5);
            assert_eq!(sample.at.is_infinite(), lights.bounds(id).is_none());
            if !sample.at.is_infinite() {
                let way = (sample.at.p() - p).normalize();
                assert!(way.distance(sample.wi) < 1e-5, "light {i}: {way} {}", sample.wi);
            }
            let again = lights.pdf_li(id, &to, &sample.at, sample.wi);
            // On the very rim of a disc rounding decides.
            let rim = sample.at.is_infinite() && again == 0.0;
            let same = (again / sample.pdf - 1.0).abs() < 2e-3;
            assert!(same || rim, "light {i} from {p}: {again} for {}", sample.pdf);
            let beside = lights.sample_li_beside_scattering(id, &to, u, &Wavelengths::RGB, &MeanEmission);
            let Some(beside) = beside else {
                // Skies of one colour are not drawn.
                assert!(lights.is_background(id) && lights.unevenness(id) == 0.0, "light {i}");
                assert_eq!(lights.pdf_li_beside_scattering(id, &to, &sample.at, sample.wi), 0.0);
                continue;
            };
            let again_beside = lights.pdf_li_beside_scattering(id, &to, &beside.at, beside.wi);
            let same = (again_beside / beside.pdf - 1.0).abs() < 2e-3;
            assert!(same || rim, "light {i} from {p}: {again_beside} for {}", beside.pdf);
            assert!(!sample.is_delta || (again, sample.pdf) == (1.0, 1.0), "light {i}");
            let is_point = sample.is_delta && !sample.at.is_infinite();
            assert_eq!(lights.apex(id), is_point.then(|| sample.at.p()), "light {i}");
        }
    }
    assert_eq!(kinds.len(), Lights::KINDS.len(), "{kinds:?}");
}

/// No density is left for directions in which no light comes, nor for points that no light of this kind has.
#[test]
fn densities_for_a_receiver_are_zero_where_no_light_comes_from() {
    let (lights, list) = every_light();
    for (i, &KnownLight { id, surface, .. }) in list.iter().enumerate() {
        let to = receiver_of(surface.as_ref());
        let is_infinite = lights.bounds(id).is_none();
        let strange = match (is_infinite, surface) {
            (true, _) => LightPoint::Position(Vec3::X),
            (false, Some(_)) => LightPoint::Infinite { through: to.p },
            (false, None) => LightPoint::Surface { p: Vec3::X, p_error: Vec3::ZERO, n: Vec3::X },
        };
        assert_eq!(lights.pdf_li(id, &to, &strange, Vec3::Y), 0.0, "light {i}");
        check_elsewhere(&lights, id);
        let mut dark = 0;
        for k in 0..300 {
            let s = Stream::new(62, [k, i as u32], 0);
            let p = 6.0 * Vec3::new(s.uniform(0), s.uniform(1), s.uniform(2)) - 3.0;
            let to = Receiver { p, ..Receiver::default() };
            let (at, wi) = match lights.bounds(id) {
                None => (LightPoint::Infinite { through: p }, Vec3::NEG_Y),
                Some(near) => {
                    let position = near.bounds.center();
                    (LightPoint::Position(position), (position - p).normalize())
                }
            };
            let none =
                lights.sample_li(id, &to, Vec2::splat(0.5), &Wavelengths::RGB, &MeanEmission).is_none();
            if none {
                dark += 1;
                assert_eq!(lights.pdf_li(id, &to, &at, wi), 0.0, "light {i} from {p}");
            }
        }
        assert!(dark > 0 || Lights::kind(id) != "spots", "receivers outside the cone");
    }
}

/// A light that is one point or one direction has no density at another one, for a receiver or for light that leaves.
fn check_elsewhere(lights: &Lights, id: LightId) {
    let to = Receiver { p: Vec3::new(0.3, -1.4, 0.2), ..Receiver::default() };
    let Some(sample) = lights.sample_li(id, &to, Vec2::splat(0.5), &Wavelengths::RGB, &MeanEmission) else {
        return;
    };
    if !sample.is_delta {
        return;
    }
    let pdf_le = |at, d| lights.pdf_le(id, 0.0, &at, d, &WORLD).direction;
    let LightLiSample { at, wi, .. } = sample;
    assert!(lights.pdf_li(id, &to, &at, wi) == 1.0 && pdf_le(at, -wi) > 0.0);
    let (other_at, other_wi) = match at {
        LightPoint::Position(p) => (LightPoint::Position(p + 0.25 * wi), wi),
        LightPoint::Infinite { .. } => (at, (wi + 0.01 * wi.any_orthonormal_vector()).normalize()),
        LightPoint::Surface { .. } => panic!("a surface has an extent"),
    };
    assert_eq!(lights.pdf_li(id, &to, &other_at, other_wi), 0.0);
    assert_eq!(pdf_le(other_at, -other_wi), 0.0);
}
