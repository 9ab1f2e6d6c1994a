//! `LinearIndex`: matter in which rays are parabolas.

use kajo_math::Vec3;

use super::gradient_index::{AbbeKeys, CurveKeys};
use crate::compile::fields::{Keys, keys, point, positive, vector};
use crate::compile::member::{MediumMember, Member};
use crate::medium::gradient_index::Profile;
use crate::schema::{Block, Kind};

keys! {
    LinearKeys {
        origin: Vec3 = point("origin").or([0.0; 3], "where the index is `index`"),
        index: f32 = positive("index").or(1.5, "index of refraction there"),
        gradient: Vec3 = vector("gradient").unit("1/length").or([0.0, 0.1, 0.0], "half the gradient of the square of the index"),
    }
}

pub const MEMBER: MediumMember = Member {
    block: Block {
        keyword: "LinearIndex",
        kind: Kind::Medium,
        about: "matter whose index has a square that grows evenly, in which rays are parabolas",
        groups: &[LinearKeys::FIELDS, AbbeKeys::FIELDS, CurveKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item| {
        compiler.medium(item, |params, sources| {
            let LinearKeys { origin, index, gradient } = LinearKeys::read(params, sources)?;
            let colors = AbbeKeys::read(params, sources)?;
            let curves = CurveKeys::read(params, sources)?;
            let (origin, gradient) = (origin.as_dvec3(), gradient.as_dvec3());
            let profile = Profile::Linear { origin, index: index.into(), gradient };
            Some(curves.medium(profile, colors.dispersing()))
        })
    },
};
