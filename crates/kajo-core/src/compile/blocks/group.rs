//! `Group`, `Transform` and `Instance`: what holds objects, moves them or places them again.

use super::member_count;
use crate::compile::member::{Member, ObjectMember};
use crate::compile::{motion, operations};
use crate::schema::{Block, FieldSpec, Kind};

/// How many objects a group says it holds.
pub const OBJECT_COUNT: FieldSpec = member_count("numObjects");

pub const GROUP: ObjectMember = Member {
    block: Block {
        keyword: "Group",
        kind: Kind::Group,
        about: "objects together",
        groups: &[&[OBJECT_COUNT]],
        parts: &[],
    },
    read: |compiler, item, ctm, state| compiler.group(item, ctm, state),
};

pub const INSTANCE: ObjectMember = Member {
    block: Block {
        keyword: "Instance",
        kind: Kind::Instance,
        about: "what was defined, put into its place",
        groups: &[operations::FIELDS],
        parts: motion::BLOCKS,
    },
    read: |compiler, item, ctm, state| compiler.instance(item, ctm, state),
};

pub const TRANSFORM: ObjectMember = Member {
    block: Block {
        keyword: "Transform",
        kind: Kind::Transform,
        about: "moves, turns and scales an object or a group",
        groups: &[operations::FIELDS],
        parts: motion::BLOCKS,
    },
    read: |compiler, item, ctm, state| compiler.transform(item, ctm, state),
};

pub const DEFINE: Block = Block {
    keyword: "Define",
    kind: Kind::Define,
    about: "objects that are placed elsewhere",
    groups: &[],
    parts: &[],
};
