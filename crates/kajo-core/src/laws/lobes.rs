//! Lobes, from the list of their own tests.

use crate::bsdf::tests::list::{ROUGHNESSES, deep, directions, families, mirrors};
use crate::bsdf::{Bsdf, Transport};
use kajo_math::Vec3;

use super::{Census, Draw, Furnace, Who, kinds};

kinds!(Bsdf: Lambert, OrenNayar, BumpedDiffuse, Conductor, Dielectric, ThinDielectric, Phong, Principled, Subsurface, Btf, Measured, Deflector, Null);

fn who(kind: &'static str, name: String) -> Who {
    Who { family: "lobe", kind, name }
}

pub(super) fn census() -> Census {
    Census { family: "lobe", kinds: KINDS.to_vec(), pointlike: &["Deflector", "Null"], unpowered: &[] }
}

/// Every `step`th roughness of every family from `n` directions, with the tolerance of its energy.
fn entries(step: usize, n: u32) -> impl Iterator<Item = (Who, Bsdf<'static>, Vec3, [f64; 2])> {
    families().into_iter().flat_map(move |family| {
        let least = if family.lossless { 1.0 - family.tolerance } else { 0.0 };
        let expected = [least, 1.0 + family.tolerance];
        ROUGHNESSES.into_iter().step_by(step).flat_map(move |roughness| {
            let lobe = (family.lobe)(roughness);
            directions(n).map(move |wo| {
                let name = format!("{} {roughness} from {wo}", family.name);
                (who(kind(&lobe), name), lobe, wo, expected)
            })
        })
    })
}

pub(super) fn draws() -> Vec<Draw> {
    let (step, n) = if deep() { (1, 10) } else { (4, 3) };
    let draw = |(who, lobe, wo, _): (Who, Bsdf<'static>, Vec3, _)| Draw {
        who,
        draw: Box::new(move |u, uc| {
            let sample = lobe.sample(wo, u, uc, Transport::Radiance)?;
            (!sample.kind.delta).then_some(sample.wi)
        }),
        pdf: Box::new(move |wi| lobe.pdf(wo, wi)),
    };
    entries(step, n).map(draw).collect()
}

/// Light arrives from everywhere alike. Power is counted, so that the squeezing of radiance is left out.
pub(super) fn furnaces() -> Vec<Furnace> {
    let (step, n) = if deep() { (1, 10) } else { (3, 4) };
    let single = mirrors().into_iter().flat_map(|(name, lobe)| {
        directions(n).map(move |wo| (who(kind(&lobe), format!("{name} from {wo}")), lobe, wo, [1.0; 2]))
    });
    let furnace = |(who, lobe, wo, expected): (Who, Bsdf<'static>, Vec3, _)| Furnace {
        who,
        energy: Box::new(move |u, uc| {
            let sample = lobe.sample(wo, u, uc, Transport::Radiance);
            sample.map_or(0.0, |sample| f64::from(sample.weight.max_lane() * sample.eta * sample.eta))
        }),
        expected,
    };
    entries(step, n).chain(single).map(furnace).collect()
}
