//! `LuneburgLens`: a ball that makes points of parallel light.

use kajo_math::Vec3;

use super::gradient_index::{AbbeKeys, CurveKeys};
use crate::compile::fields::{Keys, keys, point, positive};
use crate::compile::member::{MediumMember, Member};
use crate::medium::gradient_index::Profile;
use crate::schema::{Block, Kind};

keys! {
    LuneburgKeys {
        center: Vec3 = point("center").or([0.0; 3], "middle of the ball"),
        radius: f32 = positive("radius").unit("length").or(1.0, "where its index is 1"),
    }
}

pub const MEMBER: MediumMember = Member {
    block: Block {
        keyword: "LuneburgLens",
        kind: Kind::Medium,
        about: "a ball of the index sqrt(2 - (r/R)^2): parallel light meets on its far side",
        groups: &[LuneburgKeys::FIELDS, AbbeKeys::FIELDS, CurveKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item| {
        compiler.medium(item, |params, sources| {
            let LuneburgKeys { center, radius } = LuneburgKeys::read(params, sources)?;
            let colors = AbbeKeys::read(params, sources)?;
            let curves = CurveKeys::read(params, sources)?;
            let profile = Profile::Luneburg { center: center.as_dvec3(), radius: radius.into() };
            Some(curves.medium(profile, colors.dispersing()))
        })
    },
};
