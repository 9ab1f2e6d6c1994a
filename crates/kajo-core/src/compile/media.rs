//! The `Media` block: what bodies and the air are filled with.

use kajo_scene::{Diagnostic, Item, Params};

use super::Compiler;
use super::blocks::{EXTERIOR, MEDIA as MEMBERS, MEDIUM_LIST};
use super::fields::{Sources, named_medium};
use super::member::keywords;
use super::misplaced::misplaced;
use crate::family::Pooled;
use crate::medium::{AnyMedium, BlackHole, MediumId};

pub(super) const KEYWORDS: [&str; MEMBERS.len()] = keywords(&MEMBERS);

impl Compiler<'_> {
    /// Reads all media, before the materials that name them.
    pub(super) fn media(&mut self, item: Item<'_>) {
        let mut params = Params::new(item, self.diagnostics);
        let exterior = params.block(EXTERIOR.key);
        let items = params.take(&KEYWORDS);
        params.elsewhere(|item| misplaced(item, Some(MEDIUM_LIST.keyword)));
        params.finish();
        for item in items {
            let Some(member) = MEMBERS.iter().find(|member| member.block.keyword == item.keyword()) else {
                continue;
            };
            let made = (member.read)(self, item);
            let Some(name) = item.word().map(|word| word.text().into_owned()) else {
                let error = Diagnostic::error(format!("`{}` has no name", item.keyword()));
                let error = error.label(item.head_span(), "nothing can be filled with it");
                self.diagnostics.push(error.help(format!("write `{} smoke {{ }}`", item.keyword())));
                continue;
            };
            if self.medium_names.insert(name.clone(), made).is_some() {
                let error = Diagnostic::error(format!("there are two media named `{name}`"));
                self.diagnostics.push(error.label(item.head_span(), "the second one"));
            }
        }
        let air = exterior.and_then(|item| named_medium(item, self.diagnostics, &self.medium_names));
        if let (Some(item), Some(air)) = (exterior, air) {
            let set = self.scene.air(air);
            self.accepted(set, item.head_span());
        }
    }

    /// All black holes among the media so far.
    pub(super) fn black_holes(&self) -> Vec<(MediumId, BlackHole)> {
        let media = self.scene.media();
        let ids = self.medium_names.values().flatten().copied();
        ids.filter_map(|id| BlackHole::find(media, id).map(|hole| (id, hole.clone()))).collect()
    }

    /// Adds the medium that `read` makes of an item.
    pub(super) fn medium<'t, M: Into<AnyMedium>>(
        &mut self,
        item: Item<'t>,
        read: impl FnOnce(&mut Params<'t, '_>, &mut Sources<'_>) -> Option<M>,
    ) -> Option<MediumId> {
        let medium = self.read_keys(item, |params, sources| {
            params.name();
            read(params, sources)
        })?;
        let stored = self.scene.medium(medium);
        self.accepted(stored, item.head_span())
    }
}
