//! Lights: as places to start from, and as places to look at.

use std::sync::Arc;

use kajo_color::{Emission, Wavelengths};
use kajo_math::{DVec3, Vec2, Vec3};

use super::{Census, Draw, Furnace, Who};
use crate::background::Background;
use crate::daylight::{Sky, SkySettings};
use crate::light::tests::AFTERNOON;
use crate::light::tests::emission::{WORLD, emitters};
use crate::light::{AreaLight, Emitter, LightId, Lights, Sides, SkyLight, Target};
use crate::shape::Patch;

/// How far off the power is that lights are chosen by, of those in the list.
const TOLERANCE: f64 = 3e-3;

fn who(kind: &'static str, name: String) -> Who {
    Who { family: "light", kind, name }
}

pub(super) fn census() -> Census {
    Census { family: "light", kinds: Lights::KINDS.to_vec(), pointlike: &[], unpowered: &[] }
}

pub(super) fn draws() -> Vec<Draw> {
    let (lights, list) = emitters();
    let lights = Arc::new(lights);
    let leaving = list.into_iter().enumerate().filter_map(|(i, (id, _))| leaving(&lights, id, i));
    leaving.chain([towards_a_square(), towards_a_sky()]).collect()
}

/// Directions in which light leaves one place of an emitter.
fn leaving(lights: &Arc<Lights>, id: LightId, number: usize) -> Option<Draw> {
    let place = Vec2::new(0.37, 0.61);
    let emit = move |lights: &Lights, u: Vec2| lights.emit(id, 0.0, [place, u], &Wavelengths::RGB, &WORLD);
    let tries = (0..10).map(|i| Vec2::new(0.2, 0.05 + 0.1 * i as f32));
    let first = tries.filter_map(|u| emit(lights, u)).next()?;
    if first.is_delta && first.is_infinite() {
        return None;
    }
    let at = match first.origin {
        Target::Surface { p, n, .. } => [p, n],
        Target::Point(p) => [p, Vec3::ZERO],
        Target::Infinity => [WORLD.center, Vec3::ZERO],
    };
    let (drawn, dense) = (Arc::clone(lights), Arc::clone(lights));
    Some(Draw {
        who: who(Lights::kind(id), format!("number {number}, leaving")),
        draw: Box::new(move |u, _| emit(&drawn, u).map(|emitted| emitted.d)),
        pdf: Box::new(move |d| dense.emission_pdf(id, 0.0, at, d, &WORLD).direction),
    })
}

/// Directions from a receiver to a square above it.
fn towards_a_square() -> Draw {
    let patch = Patch::parallelogram(DVec3::new(-0.5, 1.0, -0.5), [DVec3::X, DVec3::Z]);
    let emission = Emission::from_rgb([2.0; 3]);
    let light =
        AreaLight { patch, drift: None, varied: None, emission, sides: Sides::Front, primitive: 0, part: 0 };
    let from = Vec3::new(0.3, 0.2, -0.7);
    let same = light.clone();
    Draw {
        who: who("areas", "a square seen from below".to_owned()),
        draw: Box::new(move |u, _| Some(light.sample(from, 0.0, u, &Wavelengths::RGB)?.wi)),
        pdf: Box::new(move |wi| {
            let p = from + wi * ((1.0 - from.y) / wi.y);
            let hit = wi.y > 0.0 && p.x.abs().max(p.z.abs()) <= 0.5;
            if hit { same.pdf(from, p, Vec3::NEG_Y, 0.0) } else { 0.0 }
        }),
    }
}

/// Directions to a clear sky without its sun, which is too small for the cells of the test.
fn towards_a_sky() -> Draw {
    let sky = Sky::new(&SkySettings { sun: false, ..AFTERNOON });
    let sky = Arc::new(SkyLight::new(Arc::new(Background::Sky(Box::new(sky)))));
    let same = Arc::clone(&sky);
    Draw {
        who: who("skies", "a clear sky".to_owned()),
        draw: Box::new(move |u, _| Some(sky.sample(Vec3::ZERO, 0.0, u, &Wavelengths::RGB)?.wi)),
        pdf: Box::new(move |wi| same.pdf(wi)),
    }
}

/// What lights send out, over the power that is known of them.
pub(super) fn furnaces() -> Vec<Furnace> {
    let (lights, list) = emitters();
    let lights = Arc::new(lights);
    let furnace = |(number, (id, power)): (usize, (LightId, f64))| {
        let lights = Arc::clone(&lights);
        Furnace {
            who: who(Lights::kind(id), format!("number {number}")),
            energy: Box::new(move |u, uc| {
                let ways = [u, Vec2::new(uc, (uc * 977.0).fract())];
                let emitted = lights.emit(id, 0.0, ways, &Wavelengths::RGB, &WORLD);
                // Rays along the surface are none; the scene leaves them out too.
                let usable = emitted.filter(|emitted| emitted.pdf.place * emitted.pdf.direction > 0.0);
                usable.map_or(0.0, |emitted| f64::from(emitted.power()[0])) / power
            }),
            expected: [1.0 - TOLERANCE, 1.0 + TOLERANCE],
        }
    };
    list.into_iter().enumerate().map(furnace).collect()
}
