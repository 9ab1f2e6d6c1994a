//! What one types, copies and pastes: edits of the text like any others.

use kajo::{TokenKind, tokens};
use kajo_edit::{Edit, FileId, Node};

use super::Studio;

impl Studio {
    /// Makes this the text of a file. What is typed in one go is one step.
    pub(super) fn type_text(&mut self, file: FileId, text: String) {
        if self.typing != Some(file) {
            self.end_drag();
            let Some(document) = &mut self.document else { return };
            document.begin_gesture("type");
            self.typing = Some(file);
        }
        self.edit(&Edit::Rewrite { file, text });
    }

    /// Makes one step of what was typed.
    pub(super) fn end_typing(&mut self) {
        if self.typing.is_some() {
            self.end_drag();
        }
    }

    /// The text of the selected blocks, in their order; `None` where nothing is selected.
    pub fn selected_text(&self) -> Option<String> {
        let document = self.document.as_ref()?;
        let mut nodes: Vec<&Node> =
            self.selection.nodes().iter().filter_map(|&id| document.node(id)).collect();
        nodes.sort_by_key(|node| (node.file, node.span.start));
        let is_within = |inner: &Node, outer: &Node| {
            inner.id != outer.id && inner.file == outer.file && outer.span.contains(&inner.span.start)
        };
        let whole = nodes.iter().filter(|node| !nodes.iter().any(|outer| is_within(node, outer)));
        let texts = whole.filter_map(|node| {
            let (_, file) = document.files().find(|(id, _)| *id == node.file)?;
            file.text.get(node.span.clone())
        });
        let texts: Vec<&str> = texts.collect();
        (!texts.is_empty()).then(|| texts.join("\n") + "\n")
    }

    /// Adds the blocks of a text, each where such blocks stand; objects to the group that is selected, if one is.
    pub(super) fn paste(&mut self, text: &str) {
        let blocks = blocks(text);
        if self.document.is_none() || blocks.is_empty() {
            self.say("There are no blocks of a scene to paste.", false);
            return;
        }
        self.end_drag();
        let into = self.group_of_selection();
        let mut created = Vec::new();
        for block in &blocks {
            let Some(node) = self.edit(&Edit::Add { into, block: (*block).to_owned() }) else { return };
            created.push(node);
        }
        let n = created.len();
        if let Some(document) = &self.document {
            self.selection.set(created, document);
        }
        self.say(&if n == 1 { "Pasted a block.".to_owned() } else { format!("Pasted {n} blocks.") }, false);
    }
}

/// The blocks that stand in no other, from keyword to closing brace; what is left over comes last.
fn blocks(text: &str) -> Vec<&str> {
    let mut blocks = Vec::new();
    let mut start = None;
    let mut depth = 0_usize;
    for token in tokens(text).filter(|token| !token.kind.is_trivia()) {
        let from = *start.get_or_insert(token.range().start);
        match token.kind {
            TokenKind::OpenBrace => depth += 1,
            TokenKind::CloseBrace if depth <= 1 => {
                blocks.push(&text[from..token.range().end]);
                (start, depth) = (None, 0);
            }
            TokenKind::CloseBrace => depth -= 1,
            _ => {}
        }
    }
    blocks.extend(start.map(|from| text[from..].trim_end()));
    blocks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_cut_into_its_blocks() {
        let text = " Sphere a { radius 1 } // }\nGroup { Box { } Box { } }  Material m{}";
        assert_eq!(blocks(text), ["Sphere a { radius 1 }", "Group { Box { } Box { } }", "Material m{}"]);
        assert_eq!(blocks("Box { min"), ["Box { min"]);
        assert_eq!(blocks("Box { } } radius 1"), ["Box { }", "}", "radius 1"]);
        assert!(blocks(" // nothing\n").is_empty());
    }
}
