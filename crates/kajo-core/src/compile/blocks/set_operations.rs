//! `Union`, `Intersection`, `Difference` and `Merge`: solids made of others.

use kajo_scene::Params;

use super::group::OBJECT_COUNT;
use crate::compile::fields::{Keys, Sources, keys};
use crate::compile::material_draft::{Reference, named_material};
use crate::compile::member::{Member, ObjectMember};
use crate::schema::{Block, FieldSpec, Kind};
use crate::shape::SetOperation;

keys! {
    SetKeys<'t> {
        material: Option<Reference<'t>> = named_material("material")
            .unlike("those of its operands", "", "material of all its faces"),
    }
}

/// A group: where it is an operand, what is in any of its objects.
pub const UNION: ObjectMember = Member {
    block: block(
        "Union",
        "objects together; as an operand, what is in any of them",
        &[SetKeys::FIELDS, &[OBJECT_COUNT]],
    ),
    read: |compiler, item, ctm, state| compiler.union(item, read, ctm, state),
};

pub const INTERSECTION: ObjectMember = Member {
    block: block("Intersection", "what is in all of several solids", &[SetKeys::FIELDS]),
    read: |compiler, item, ctm, state| {
        compiler.set_operation(item, SetOperation::Intersection, read, ctm, state);
    },
};

pub const DIFFERENCE: ObjectMember = Member {
    block: block("Difference", "what is in the first solid and in none of the others", &[SetKeys::FIELDS]),
    read: |compiler, item, ctm, state| {
        compiler.set_operation(item, SetOperation::Difference, read, ctm, state);
    },
};

pub const MERGE: ObjectMember = Member {
    block: block(
        "Merge",
        "what is in any of several solids, without the surfaces inside",
        &[SetKeys::FIELDS],
    ),
    read: |compiler, item, ctm, state| {
        compiler.set_operation(item, SetOperation::Union, read, ctm, state);
    },
};

const fn block(keyword: &'static str, about: &'static str, groups: &'static [&'static [FieldSpec]]) -> Block {
    Block { keyword, kind: Kind::Group, about, groups, parts: &[] }
}

/// The material of all faces, if the block says one; `None` when a mistake was reported.
fn read<'t>(params: &mut Params<'t, '_>, sources: &mut Sources<'_>) -> Option<Option<Reference<'t>>> {
    SetKeys::read(params, sources).map(|SetKeys { material }| material)
}
