//! What definitions are made of.

use kajo_math::Motion;

use crate::material::MaterialId;
use crate::nested::PartContent;
use crate::objects::Label;

/// An object of a definition, or an assembly of many.
#[derive(Clone)]
pub(super) struct Part {
    pub content: PartContent,
    /// From its own space to the definition's.
    pub map: Motion,
    /// Its own material; without one it takes what is in force where the definition is placed.
    pub material: Option<MaterialId>,
    pub label: Label,
}

/// Memory of an object: as a part of a definition, or as one of the scene's with its words and its share of a tree.
pub(super) const BYTES_PER_OBJECT: usize = size_of::<Part>() + 96;

/// What one thing is made of that can be placed many times.
pub(super) type Parts = std::rc::Rc<[Part]>;
