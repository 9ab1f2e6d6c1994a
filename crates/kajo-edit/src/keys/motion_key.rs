//! New keys of a `Motion`, as operations that lead to where things are at that moment.

use kajo_core::compile::operations_matrix;
use kajo_math::{DAffine3, Keyframes};

use super::KEY;
use crate::tree::Tree;
use crate::{EditRefused, Node};

impl Tree {
    /// The text of a key at a moment of a `Motion`, at which nothing moves otherwise for it.
    ///
    /// * `frame`: the moment
    pub(super) fn motion_key_text(&self, node: &Node, frame: f64) -> Result<String, EditRefused> {
        let time = self.time_text(frame);
        let by_rows = self.matrix_by_rows();
        let key = |item: kajo_scene::Item<'_>| {
            Some((item.numbers().next()?.0, operations_matrix(item.children(), by_rows)))
        };
        let keys: Vec<(f64, DAffine3)> = self.motion_keys(node).filter_map(key).collect();
        let motion = Keyframes::new(&keys).map_err(|_| {
            EditRefused::new("there is a mistake in the keys of this `Motion`: correct it in the text")
        })?;
        let seconds = time.parse().map_err(|_| EditRefused::new("this frame has no time"))?;
        let operations = self.operations_of(&motion.at(seconds));
        let space = if operations.is_empty() { "" } else { " " };
        Ok(format!("{KEY} {time} {{{space}{operations} }}"))
    }
}
