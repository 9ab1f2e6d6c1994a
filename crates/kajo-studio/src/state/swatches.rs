//! Small pictures of the textures and materials that the panel of the selection shows, drawn by another thread.

use std::collections::HashMap;
use std::sync::Arc;

use kajo::Scene;
use kajo_edit::{Document, Field, FieldKind, NodeId, Swatch, SwatchOf};

use super::tracer::Wake;
use super::worker::Worker;
use super::{Studio, Version};

type Drawn = HashMap<SwatchOf, Arc<Swatch>>;

/// The pictures on show and those to come.
pub(super) struct Swatches {
    worker: Worker<(Arc<Scene>, Vec<SwatchOf>), Drawn>,
    /// What they were ordered for last: a scene, and what is selected in it.
    ordered: Option<(Version, Option<NodeId>)>,
    drawn: Drawn,
}

impl Swatches {
    pub fn new(wake: Wake) -> Swatches {
        let draw = |(scene, wanted): (Arc<Scene>, Vec<SwatchOf>)| {
            let draw = |of: SwatchOf| Some((Swatch::new(&scene, &of)?, of));
            wanted.into_iter().filter_map(draw).map(|(swatch, of)| (of, Arc::new(swatch))).collect()
        };
        Swatches { worker: Worker::new(wake, draw), ordered: None, drawn: Drawn::new() }
    }
}

impl Studio {
    /// The picture of a node of the panel; `None` where there is none, or none yet. It may be one of a moment ago.
    pub fn swatch_of(&self, node: NodeId) -> Option<&Arc<Swatch>> {
        self.swatches.drawn.get(&self.document.as_ref()?.swatch_of(node)?)
    }

    /// The picture of the texture that a field of the panel names, as [`Studio::swatch_of`].
    pub fn swatch_in(&self, field: &Field) -> Option<&Arc<Swatch>> {
        self.swatches.drawn.get(&named_in(self.document.as_ref()?, field)?)
    }

    /// Whether pictures are still to come.
    pub fn is_drawing_swatches(&self) -> bool {
        self.swatches.worker.is_busy()
            || self.swatches.ordered != Some((self.version(), self.selection.main()))
    }

    /// Takes in pictures that were drawn, and has others drawn for another scene or another selection.
    pub(super) fn draw_swatches(&mut self) {
        if let Some(drawn) = self.swatches.worker.take_latest() {
            self.swatches.drawn = drawn;
        }
        let shown = (self.version(), self.selection.main());
        if self.swatches.ordered == Some(shown) {
            return;
        }
        self.swatches.ordered = Some(shown);
        let (Some(document), Some(scene)) = (&self.document, self.scene().cloned()) else { return };
        let wanted = wanted(document, shown.1);
        if !wanted.is_empty() {
            self.swatches.worker.order((scene, wanted));
        }
    }
}

/// What the panel shows pictures of: the node that is selected and its material, and textures that their fields name.
fn wanted(document: &Document, selected: Option<NodeId>) -> Vec<SwatchOf> {
    let Some(selected) = selected else { return Vec::new() };
    let mut wanted = Vec::new();
    for node in [Some(selected), document.material_of(selected)].into_iter().flatten() {
        let fields = document.fields(node);
        let in_fields = fields.iter().filter_map(|field| named_in(document, field));
        for of in document.swatch_of(node).into_iter().chain(in_fields) {
            if !wanted.contains(&of) {
                wanted.push(of);
            }
        }
    }
    wanted
}

/// The texture that a field names, where it is one that may name any.
fn named_in(document: &Document, field: &Field) -> Option<SwatchOf> {
    let may_name_one = matches!(
        field.kind,
        FieldKind::Number { .. }
            | FieldKind::Color(_)
            | FieldKind::Reflectance
            | FieldKind::Emission
            | FieldKind::Picture
            | FieldKind::Text
    );
    let word = field.value.as_ref()?.word.as_deref().filter(|_| may_name_one)?;
    document.swatch_named(word)
}
