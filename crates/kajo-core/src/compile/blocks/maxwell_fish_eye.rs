//! `MaxwellFishEye`: matter in which rays are circles.

use kajo_math::Vec3;

use super::gradient_index::{AbbeKeys, CurveKeys};
use crate::compile::fields::{Keys, keys, point, positive};
use crate::compile::member::{MediumMember, Member};
use crate::medium::gradient_index::Profile;
use crate::schema::{Block, Kind};

keys! {
    FishEyeKeys {
        center: Vec3 = point("center").or([0.0; 3], "its middle"),
        radius: f32 = positive("radius").unit("length").or(1.0, "where its index is half of that in the middle"),
        index: f32 = positive("index").or(2.0, "index of refraction in the middle"),
    }
}

pub const MEMBER: MediumMember = Member {
    block: Block {
        keyword: "MaxwellFishEye",
        kind: Kind::Medium,
        about: "matter of the index n0 / (1 + (r/a)^2), in which rays are circles",
        groups: &[FishEyeKeys::FIELDS, AbbeKeys::FIELDS, CurveKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item| {
        compiler.medium(item, |params, sources| {
            let FishEyeKeys { center, radius, index } = FishEyeKeys::read(params, sources)?;
            let colors = AbbeKeys::read(params, sources)?;
            let curves = CurveKeys::read(params, sources)?;
            let (center, radius) = (center.as_dvec3(), radius.into());
            let profile = Profile::FishEye { center, radius, index: index.into() };
            Some(curves.medium(profile, colors.dispersing()))
        })
    },
};
