//! `Union`, `Intersection`, `Difference` and `Merge`: solids made of others.

use crate::compile::member::{Member, ObjectMember};
use crate::schema::{Block, Kind};
use crate::shape::SetOperation;

/// A group: where it is an operand, what is in any of its objects.
pub const UNION: ObjectMember = Member {
    block: block("Union", "objects together; as an operand, what is in any of them"),
    read: |compiler, item, ctm, state| compiler.group(item, ctm, state),
};

pub const INTERSECTION: ObjectMember = Member {
    block: block("Intersection", "what is in all of several solids"),
    read: |compiler, item, ctm, state| compiler.set_operation(item, SetOperation::Intersection, ctm, state),
};

pub const DIFFERENCE: ObjectMember = Member {
    block: block("Difference", "what is in the first solid and in none of the others"),
    read: |compiler, item, ctm, state| compiler.set_operation(item, SetOperation::Difference, ctm, state),
};

pub const MERGE: ObjectMember = Member {
    block: block("Merge", "what is in any of several solids, without the surfaces inside"),
    read: |compiler, item, ctm, state| compiler.set_operation(item, SetOperation::Union, ctm, state),
};

const fn block(keyword: &'static str, about: &'static str) -> Block {
    Block { keyword, kind: Kind::Group, about, groups: &[] }
}
