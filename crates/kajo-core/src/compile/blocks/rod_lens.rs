//! `RodLens`: a rod that light winds through like a wave.

use kajo_math::Vec3;

use super::gradient_index::{AbbeKeys, CurveKeys};
use crate::compile::fields::{Direction, Keys, at_least, direction, keys, point, positive};
use crate::compile::member::{MediumMember, Member};
use crate::medium::gradient_index::Profile;
use crate::schema::{Block, Constant, Kind};

keys! {
    RodKeys {
        origin: Vec3 = point("origin").or([0.0; 3], "a point of its axis"),
        axis: Direction = direction("axis").otherwise(Constant::Triple([0.0, 0.0, 1.0]), "along it"),
        index: f32 = positive("index").or(1.5, "index of refraction on the axis"),
        gradient: f32 = at_least("gradient", 0.0).unit("1/length").or(0.5, "g; light winds once in about 2 pi / g"),
    }
}

pub const MEMBER: MediumMember = Member {
    block: Block {
        keyword: "RodLens",
        kind: Kind::Medium,
        about: "a rod of the index n0 sqrt(1 - (g r)^2), that light winds through like a wave",
        groups: &[RodKeys::FIELDS, AbbeKeys::FIELDS, CurveKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item| {
        compiler.medium(item, |params, sources| {
            let RodKeys { origin, axis: Direction(axis), index, gradient } = RodKeys::read(params, sources)?;
            let colors = AbbeKeys::read(params, sources)?;
            let curves = CurveKeys::read(params, sources)?;
            let profile = Profile::Rod {
                origin: origin.as_dvec3(),
                axis: axis.as_dvec3().normalize(),
                index: index.into(),
                gradient: gradient.into(),
            };
            Some(curves.medium(profile, colors.dispersing()))
        })
    },
};
