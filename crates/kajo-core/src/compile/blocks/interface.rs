//! `Interface`: the boundary of a medium that light does not notice.

use super::glass::{MEDIUM, PRIORITY};
use crate::compile::extras::ExtraKeys;
use crate::compile::fields::{Inside, Keys, keys};
use crate::compile::member::{MaterialMember, Member};
use crate::material::NullInterface;
use crate::schema::{Block, Kind};

keys! {
    InterfaceKeys {
        medium: Option<Inside> = MEDIUM,
        priority: i32 = PRIORITY,
    }
}

pub const MEMBER: MaterialMember = Member {
    block: Block {
        keyword: "Interface",
        kind: Kind::Material,
        about: "the end of smoke or haze, where light goes straight on",
        groups: &[InterfaceKeys::FIELDS, ExtraKeys::FIELDS],
        parts: &[],
    },
    read: |compiler, item| {
        compiler.pooled(item, |params, sources| {
            let InterfaceKeys { medium, priority } = InterfaceKeys::read(params, sources)?;
            Some(NullInterface { medium: medium.map(|Inside(medium)| medium), priority })
        })
    },
};
