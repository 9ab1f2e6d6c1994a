//! `Lorentz`: objects that move at a speed not much below that of light.

use crate::compile::lorentz::LorentzKeys;
use crate::compile::member::{Member, ObjectMember};
use crate::compile::{motion, operations};
use crate::schema::{Block, Kind};

pub const MEMBER: ObjectMember = Member {
    block: Block {
        keyword: "Lorentz",
        kind: Kind::Transform,
        about: "objects that move nearly as fast as light, and look it",
        groups: &[LorentzKeys::FIELDS, operations::FIELDS],
        parts: motion::BLOCKS,
    },
    read: |compiler, item, ctm, state| compiler.lorentz(item, ctm, state),
};
