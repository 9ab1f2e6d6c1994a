//! What can be done to a document.

use super::texts::Change;
use super::tree::Tree;
use super::{
    EditRefused, FieldValue, FileId, Interpolation, KeyOwner, Movement, Node, NodeId, Outside, TextEdit,
    expressions,
};
use kajo::CameraPose;

/// One thing to do.
#[derive(Clone, Debug)]
pub enum Edit {
    /// Sets a value of a block; an absent one is inserted.
    Set {
        /// The block.
        node: NodeId,
        /// The word of the value.
        key: String,
        /// Which of several with this word; `None` for the one that counts.
        nth: Option<usize>,
        /// What it shall be.
        value: FieldValue,
    },
    /// Sets some of the numbers of a value that is there.
    SetSome {
        /// The block.
        node: NodeId,
        /// The word of the value.
        key: String,
        /// What each number shall be; `None` for those that stay.
        numbers: Vec<Option<f64>>,
    },
    /// Makes these all the values of a key that any number may have, such as the stops of a ramp.
    SetList {
        /// The block.
        node: NodeId,
        /// The word of the values.
        key: String,
        /// What they shall be, in order.
        values: Vec<FieldValue>,
    },
    /// Moves an object, light or camera in the world.
    Move {
        /// The node.
        node: NodeId,
        /// How it is moved, in world space.
        movement: Movement,
    },
    /// Makes the scene's camera stand and look as this one.
    Look(Box<CameraPose>),
    /// Takes a value of a block out, so that its default holds.
    Unset {
        /// The block.
        node: NodeId,
        /// The word of the value.
        key: String,
        /// Which of several with this word; `None` for the one that counts.
        nth: Option<usize>,
    },
    /// Gives an object another material.
    Paint {
        /// The object or group.
        node: NodeId,
        /// The material's block.
        material: NodeId,
    },
    /// Gives a node another name, or none. References to it follow.
    Rename {
        /// The node.
        node: NodeId,
        /// Its new name.
        name: Option<String>,
    },
    /// Adds a block, such as [`super::template`] makes.
    Add {
        /// The group, definition or transform it shall stand in; where such blocks stand, for `None`.
        into: Option<NodeId>,
        /// The text of one block.
        block: String,
    },
    /// Puts a copy of a block after it.
    Duplicate(NodeId),
    /// Takes a block out.
    Delete(NodeId),
    /// Moves an object to the end of a group, definition or transform. It keeps its material.
    MoveInto {
        /// The object.
        node: NodeId,
        /// Where it shall stand.
        into: NodeId,
    },
    /// Makes this the text of a file. What is the same at its beginning and end stays untouched, so that blocks there
    /// remain what they are.
    Rewrite {
        /// The file.
        file: FileId,
        /// Its new text.
        text: String,
    },
    /// Sets keys at the frame on show for all numbers of a value, which may have none yet. (To set a value that has keys
    /// sets a key as well, for those of its numbers that change.)
    SetKey {
        /// The block.
        node: NodeId,
        /// The word of the value.
        key: String,
        /// Which of several with this word; `None` for the one that counts.
        nth: Option<usize>,
        /// What it shall be there; `None` for what it is.
        value: Option<FieldValue>,
    },
    /// Sets a key at the frame on show that changes nothing there, of a value or of a `Motion`.
    InsertKey(KeyOwner),
    /// Moves keys by some frames, onto whole frames. Keys that are there already give way.
    MoveKeys {
        /// The keys, by their places in their rows.
        keys: Vec<(KeyOwner, usize)>,
        /// How far.
        frames: f64,
    },
    /// Takes keys out. A value that loses all of them is from then on what it is at the frame on show.
    DeleteKeys(Vec<(KeyOwner, usize)>),
    /// Says how values go from key to key, and what holds outside of the keys.
    SetKeyModes {
        /// The keys.
        owner: KeyOwner,
        /// `None` for what it is.
        interpolation: Option<Interpolation>,
        /// `None` for what it is.
        outside: Option<Outside>,
    },
    /// Several edits as one, none of which changes what another one reads.
    Together(Vec<Edit>),
}

impl Edit {
    /// Sets the value that counts.
    pub fn set(node: NodeId, key: impl Into<String>, value: FieldValue) -> Edit {
        Edit::Set { node, key: key.into(), nth: None, value }
    }

    /// What it does, in a few words.
    pub fn label(&self) -> String {
        match self {
            Edit::Set { key, .. } => format!("set {key}"),
            Edit::SetSome { key, .. } | Edit::SetList { key, .. } => format!("set {key}"),
            Edit::Move { movement: Movement::Rotate { .. }, .. } => "rotate".to_owned(),
            Edit::Move { movement: Movement::Scale { .. }, .. } => "scale".to_owned(),
            Edit::Move { .. } => "move".to_owned(),
            Edit::Look(_) => "move the camera".to_owned(),
            Edit::Unset { key, .. } => format!("remove {key}"),
            Edit::Paint { .. } => "change material".to_owned(),
            Edit::Rename { .. } => "rename".to_owned(),
            Edit::Add { block, .. } => format!("add {}", block.split([' ', '{']).next().unwrap_or_default()),
            Edit::Duplicate(_) => "duplicate".to_owned(),
            Edit::Delete(_) => "delete".to_owned(),
            Edit::MoveInto { .. } => "move to a group".to_owned(),
            Edit::Rewrite { .. } => "edit text".to_owned(),
            Edit::SetKey { key, .. } => format!("set a key of {key}"),
            Edit::InsertKey(_) => "set a key".to_owned(),
            Edit::MoveKeys { keys, .. } if keys.len() == 1 => "move a key".to_owned(),
            Edit::MoveKeys { keys, .. } => format!("move {} keys", keys.len()),
            Edit::DeleteKeys(keys) if keys.len() == 1 => "delete a key".to_owned(),
            Edit::DeleteKeys(keys) => format!("delete {} keys", keys.len()),
            Edit::SetKeyModes { interpolation: Some(_), .. } => {
                "change how values go from key to key".to_owned()
            }
            Edit::SetKeyModes { .. } => "change what holds outside of keys".to_owned(),
            Edit::Together(edits) => edits.first().map_or_else(String::new, Edit::label),
        }
    }

    /// The node whose identity goes over to the one that the edit makes.
    pub(super) fn moves(&self) -> Option<NodeId> {
        match self {
            Edit::MoveInto { node, .. } => Some(*node),
            _ => None,
        }
    }

    /// The pieces of text to replace.
    pub(super) fn plan(&self, tree: &Tree) -> Result<Vec<TextEdit>, EditRefused> {
        if let Edit::Rewrite { file, text } = self {
            return Ok(Change::between(*file, tree.text(*file), text).edits().collect());
        }
        if !tree.whole {
            return Err(EditRefused::new(
                "the text has blocks that are not closed or files that cannot be read",
            ));
        }
        let edits = self.text_edits(tree)?;
        // Keys take the place of expressions, and hold them.
        if self.is_of_keys() { Ok(edits) } else { expressions::kept(tree, edits) }
    }

    /// Whether it is about keys and nothing else.
    fn is_of_keys(&self) -> bool {
        match self {
            Edit::SetKey { .. }
            | Edit::InsertKey(_)
            | Edit::MoveKeys { .. }
            | Edit::DeleteKeys(_)
            | Edit::SetKeyModes { .. } => true,
            Edit::Together(edits) => edits.iter().all(Edit::is_of_keys),
            _ => false,
        }
    }

    fn text_edits(&self, tree: &Tree) -> Result<Vec<TextEdit>, EditRefused> {
        match self {
            Edit::Set { node, key, nth, value } => tree.set_field(tree.node(*node)?, key, *nth, Some(value)),
            Edit::Unset { node, key, nth } => tree.set_field(tree.node(*node)?, key, *nth, None),
            Edit::SetSome { node, key, numbers } => tree.set_some(tree.node(*node)?, key, numbers),
            Edit::SetList { node, key, values } => tree.set_list(tree.node(*node)?, key, values),
            Edit::Move { node, movement } => tree.displace(tree.node(*node)?, movement),
            Edit::Look(pose) => tree.look(pose),
            Edit::Paint { node, material } => tree.paint(tree.node(*node)?, tree.node(*material)?),
            Edit::Rename { node, name } => tree.rename(tree.node(*node)?, name.as_deref()),
            Edit::Add { into, block } => tree.add(into.map(|id| tree.node(id)).transpose()?, block),
            Edit::Duplicate(node) => tree.duplicate(tree.node(*node)?),
            Edit::Delete(node) => tree.delete(tree.node(*node)?),
            Edit::MoveInto { node, into } => tree.move_into(tree.node(*node)?, tree.node(*into)?),
            Edit::Rewrite { .. } => Ok(Vec::new()),
            Edit::SetKey { node, key, nth, value } => {
                tree.key_field(tree.node(*node)?, key, *nth, value.as_ref())
            }
            Edit::InsertKey(owner) => tree.insert_key(owner),
            Edit::MoveKeys { keys, frames } => tree.move_keys(keys, *frames),
            Edit::DeleteKeys(keys) => tree.delete_keys(keys),
            Edit::SetKeyModes { owner, interpolation, outside } => {
                tree.set_key_modes(owner, *interpolation, *outside)
            }
            Edit::Together(edits) => {
                let plans = edits.iter().map(|edit| edit.text_edits(tree)).collect::<Result<Vec<_>, _>>();
                Ok(plans?.concat())
            }
        }
    }
}

impl Tree {
    fn node(&self, id: NodeId) -> Result<&Node, EditRefused> {
        self.outline.get(id).ok_or_else(|| EditRefused::new("what was to be edited is no longer there"))
    }
}

/// What an edit came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Applied {
    /// Whether any byte changed.
    pub changed: bool,
    /// The block that the edit made, if it made one.
    pub created: Option<NodeId>,
}
