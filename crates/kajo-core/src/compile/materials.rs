//! The `Materials` block.
//!
//! Materials are numbered from 0 in the order of the text and may have names. Blends refer to
//! others by number or name, earlier or later ones; a blend that leads back to itself is refused,
//! and so is a tower of blends that would take more than [`MAX_PARTS`] evaluations a hit.

use std::collections::HashMap;

use kajo_math::Affine3A;
use kajo_scene::{Args, Diagnostic, Item, Params, Span};

use super::blocks::{MATERIAL_COUNT, MATERIAL_LIST, MATERIALS as MEMBERS};
use super::extras::Extras;
use super::fields::Sources;
use super::material_draft::{BlendDraft, Draft, PART, Reference};
use super::member::keywords;
use super::misplaced::misplaced;
use super::{Compiler, transform};
use crate::emission::SurfaceEmission;
use crate::material::{AnyMaterial, Blend, Embossed, MaterialId, Perforated};
use crate::texture::{FloatTexture, Placed};

pub(super) const KEYWORDS: [&str; MEMBERS.len()] = keywords(&MEMBERS);

/// The most materials that one hit may have to evaluate.
const MAX_PARTS: u32 = 1024;

/// A blend whose parts are being resolved.
struct Opened<'d, 't> {
    /// The number of its draft.
    number: usize,
    draft: &'d BlendDraft<'t>,
    /// The drafts of its parts, `None` for one that there is none for.
    parts: [Option<usize>; 2],
    /// How many of them have been looked at.
    seen: usize,
}

/// How far the resolution of a draft has come.
#[derive(Clone, Copy)]
enum State {
    Untouched,
    /// Its parts are being resolved.
    Open,
    /// Done, with the number of materials that a hit evaluates.
    Done(MaterialId, u32),
    /// Failed, which has been reported.
    Failed,
}

impl Compiler<'_> {
    pub(super) fn materials(&mut self, item: Item<'_>) {
        let mut params = Params::new(item, self.diagnostics);
        let count = params.block(MATERIAL_COUNT.key);
        let items = params.take(&KEYWORDS);
        params.elsewhere(|item| misplaced(item, Some(MATERIAL_LIST.keyword)));
        params.finish();
        // A misspelt material was meant to be one.
        let n_blocks = item.children().filter(Item::has_block).count();
        let misspelt = item.children().filter(|item| item.has_block() && !KEYWORDS.contains(&item.keyword()));
        self.failed_materials.extend(misspelt.map(|item| item.word().map(|word| word.text().into_owned())));
        self.check_count(count, n_blocks, "material");

        let mut names = HashMap::new();
        let bytes = items.len().saturating_mul(size_of::<(Option<Draft<'_>>, Option<String>)>());
        let _drafts = match self.options.limits.memory.share(bytes as u64) {
            Ok(share) => share,
            Err(over) => return self.report_memory("materials", over, item.head_span()),
        };
        let mut drafts = Vec::with_capacity(items.len());
        for (i, &item) in items.iter().enumerate() {
            let name = item.word().map(|word| word.text().into_owned());
            if let Some(name) = &name
                && names.insert(name.clone(), i).is_some()
            {
                let error = Diagnostic::error(format!("there are two materials named `{name}`"));
                self.diagnostics.push(error.label(item.head_span(), "the second one"));
            }
            drafts.push((self.draft(item), name));
            if !self.has_memory_for_materials(item.head_span()) {
                return;
            }
        }
        let mut states = vec![State::Untouched; drafts.len()];
        for i in 0..drafts.len() {
            if let State::Done(id, _) = self.resolve(i, &drafts, &names, &mut states) {
                let name = drafts[i].1.clone();
                self.material_names.extend(name.clone().map(|name| (name, id)));
                self.scene.list_material(id, name);
            } else {
                self.failed_materials.insert(drafts[i].1.clone());
            }
            if !self.has_memory_for_materials(items[i].head_span()) {
                return;
            }
        }
    }

    /// The material that a `MaterialIndex` means; an unknown one is reported.
    pub(super) fn material(&mut self, reference: &Reference<'_>) -> Option<MaterialId> {
        match reference {
            Reference::Number(i, span) => {
                let found = self.scene.appearance().list.get(*i).map(|&(id, _)| id);
                self.report_missing(found, reference, self.scene.appearance().list.len(), *span, None)
            }
            Reference::Name(name, span) => {
                let found = self.material_names.get(&**name).copied();
                // On success there is nothing to be sought.
                let near = found
                    .is_none()
                    .then(|| self.diagnostics.nearest(name, self.material_names.keys().map(String::as_str)));
                let near = near.flatten().map(str::to_owned);
                self.report_missing(found, reference, self.scene.appearance().list.len(), *span, near)
            }
        }
    }

    fn draft<'t>(&mut self, item: Item<'t>) -> Option<Draft<'t>> {
        let member = MEMBERS.iter().find(|member| member.block.keyword == item.keyword())?;
        (member.read)(self, item)
    }

    /// A material that refers to no other.
    pub(super) fn pooled<'t, M: Into<AnyMaterial>>(
        &mut self,
        item: Item<'t>,
        read: impl FnOnce(&mut Params<'t, '_>, &mut Sources<'_>) -> Option<M>,
    ) -> Option<Draft<'t>> {
        let (material, extras) = self.read_keys(item, |params, sources| {
            params.name();
            let material = read(params, sources);
            let extras = Extras::read(params, sources);
            Some((material?, extras?))
        })?;
        let span = item.head_span();
        Some(Draft::Stored(self.store_material(material, span), extras, span))
    }

    /// As [`Compiler::pooled`] of a material that `make` makes of what was read, with files.
    pub(super) fn pooled_from<'t, K, M: Into<AnyMaterial>>(
        &mut self,
        item: Item<'t>,
        read: impl FnOnce(&mut Params<'t, '_>, &mut Sources<'_>) -> Option<K>,
        make: impl FnOnce(&mut Self, K) -> Option<M>,
    ) -> Option<Draft<'t>> {
        let (keys, extras) = self.read_keys(item, |params, sources| {
            params.name();
            let keys = read(params, sources);
            let extras = Extras::read(params, sources);
            Some((keys?, extras?))
        })?;
        let material = make(self, keys)?;
        let span = item.head_span();
        Some(Draft::Stored(self.store_material(material, span), extras, span))
    }

    /// Two materials that a pattern mixes.
    ///
    /// * `read`: reads the share of the second one in the pattern's own space
    pub(super) fn blend<'t>(
        &mut self,
        item: Item<'t>,
        read: impl FnOnce(&mut Params<'t, '_>, &mut Sources<'_>) -> Option<FloatTexture>,
    ) -> Option<Draft<'t>> {
        let by_rows = self.rules.matrix_by_rows;
        let (transform, parts, amount) = self.read_keys(item, |params, sources| {
            params.name();
            let transform = params.block(transform::PLACEMENT.keyword);
            let parts = params.take(&[PART.key]);
            Some((transform, parts, read(params, sources)))
        })?;
        let parts: Vec<_> = parts
            .into_iter()
            .filter_map(|part| Args::read(part, self.diagnostics, Reference::read))
            .collect();
        let texture_from_world = transform
            .and_then(|item| transform::read_alone(item, by_rows, self.diagnostics))
            .unwrap_or(Affine3A::IDENTITY);
        let Ok(parts) = <[Reference<'t>; 2]>::try_from(parts) else {
            let error = Diagnostic::error(format!("`{}` needs two `materialIndex`", item.keyword()));
            self.diagnostics.push(error.label(item.keyword_span(), "mixes two materials"));
            return None;
        };
        let span = item.head_span();
        let amount = match amount? {
            texture @ FloatTexture::Node(_) => {
                let placed = self.scene.float_texture(Placed { texture, texture_from_world });
                self.accepted(placed, span)?
            }
            even => even,
        };
        Some(Draft::Blend(BlendDraft { amount, parts, span }))
    }

    /// Puts draft `i` and everything it refers to into the pools.
    ///
    /// The blends on the way are in a list, since a thread's stack may be too small for them.
    fn resolve(
        &mut self,
        i: usize,
        drafts: &[(Option<Draft<'_>>, Option<String>)],
        names: &HashMap<String, usize>,
        states: &mut [State],
    ) -> State {
        let mut opened = Vec::new();
        self.begin(i, drafts, states, &mut opened);
        while let Some(blend) = opened.last_mut() {
            if let Some(part) = blend.draft.parts.get(blend.seen) {
                let j = self.draft_number(part, drafts.len(), names);
                blend.parts[blend.seen] = j;
                blend.seen += 1;
                if let Some(j) = j {
                    self.begin(j, drafts, states, &mut opened);
                }
                continue;
            }
            states[blend.number] = self.blended(blend, states);
            opened.pop();
        }
        states[i]
    }

    /// Resolves a draft that has no parts, and adds one that has to the list of those being resolved.
    fn begin<'d, 't>(
        &mut self,
        i: usize,
        drafts: &'d [(Option<Draft<'t>>, Option<String>)],
        states: &mut [State],
        opened: &mut Vec<Opened<'d, 't>>,
    ) {
        if let State::Done(..) | State::Failed = states[i] {
            return;
        }
        states[i] = match &drafts[i].0 {
            None => State::Failed,
            Some(Draft::Stored(id, extras, span)) => self.with_extras(*id, extras, *span),
            Some(Draft::Blend(draft)) if matches!(states[i], State::Open) => {
                let error = Diagnostic::error("this material is made of itself");
                self.diagnostics.push(error.label(draft.span, "leads back here"));
                State::Open
            }
            Some(Draft::Blend(draft)) => {
                if let Some(deepest) = opened.last().filter(|_| opened.len() >= MAX_PARTS as usize) {
                    return self.report_too_many_parts(deepest.draft.span);
                }
                opened.push(Opened { number: i, draft, parts: [None; 2], seen: 0 });
                State::Open
            }
        };
    }

    /// Puts a blend whose parts have been resolved into the pools; one of whose parts there is nothing fails.
    fn blended(&mut self, blend: &Opened<'_, '_>, states: &[State]) -> State {
        let resolved = blend.parts.map(|part| match states[part?] {
            State::Done(id, cost) => Some((id, cost)),
            State::Untouched | State::Open | State::Failed => None,
        });
        let [Some((a, cost_a)), Some((b, cost_b))] = resolved else { return State::Failed };
        let cost = cost_a.saturating_add(cost_b).saturating_add(1);
        let (materials, span) = ([a, b], blend.draft.span);
        if cost > MAX_PARTS {
            self.report_too_many_parts(span);
            return State::Failed;
        }
        self.warn_of_unlike_emissions(materials, span);
        let blend = Blend { amount: blend.draft.amount, materials };
        self.store_material(blend, span).map_or(State::Failed, |id| State::Done(id, cost))
    }

    fn warn_of_unlike_emissions(&mut self, parts: [MaterialId; 2], span: Span) {
        if let [Some(first), Some(second)] = parts.map(|part| self.scene.emission(part))
            && !first.agrees_with(second)
        {
            let message = "the parts of a mixture shine from the same sides and in the same group";
            let warning = Diagnostic::warning(message).label(span, "its two parts differ");
            self.diagnostics.push(warning.help("`emits` and `group` of the first one count"));
        }
    }

    /// A material with its relief, its light and its holes.
    fn with_extras(&mut self, id: Option<MaterialId>, extras: &Extras, span: Span) -> State {
        let made = id.and_then(|id| self.finished(id, extras, span));
        made.map_or(State::Failed, |id| State::Done(id, 1))
    }

    fn finished(&mut self, inner: MaterialId, extras: &Extras, span: Span) -> Option<MaterialId> {
        let mut id = inner;
        if let Some(relief) = extras.relief.clone() {
            id = self.store_material(Embossed { material: inner, relief }, span)?;
        }
        let holes = extras.opacity.as_ref().filter(|(opacity, _)| opacity.share_range()[0] < 1.0);
        if let Some((_, span)) = holes
            && self.scene.appearance().may_transmit(inner)
        {
            let error = Diagnostic::error("light passes this material anyway, so that it can have no holes");
            self.diagnostics.push(error.label(*span, "`opacity` is for opaque materials"));
            return None;
        }
        let opacity = holes.map(|(opacity, _)| *opacity);
        self.lit_and_cut(id, extras.emission.clone(), opacity, span)
    }

    /// A material with its light and its holes.
    ///
    /// * `opacity`: of a material that lets no light through, where it has holes
    pub(super) fn lit_and_cut(
        &mut self,
        id: MaterialId,
        emission: SurfaceEmission,
        opacity: Option<FloatTexture>,
        span: Span,
    ) -> Option<MaterialId> {
        self.scene.set_emission(id, emission);
        match opacity {
            Some(opacity) => self.store_material(Perforated { material: id, opacity }, span),
            None => Some(id),
        }
    }

    /// Stores a material that is described at `span`.
    pub(super) fn store_material(
        &mut self,
        material: impl Into<AnyMaterial>,
        span: Span,
    ) -> Option<MaterialId> {
        let stored = self.scene.store_material(material);
        self.accepted(stored, span)
    }

    fn report_too_many_parts(&mut self, span: Span) {
        let message = format!("this material is made of more than {MAX_PARTS} others");
        self.diagnostics.push(Diagnostic::error(message).label(span, "too many levels of mixtures"));
    }

    /// The draft that a blend's part means; an unknown one is reported.
    fn draft_number(
        &mut self,
        part: &Reference<'_>,
        n: usize,
        names: &HashMap<String, usize>,
    ) -> Option<usize> {
        match part {
            Reference::Number(i, span) => self.report_missing((*i < n).then_some(*i), part, n, *span, None),
            Reference::Name(name, span) => {
                let found = names.get(&**name).copied();
                let near =
                    found.is_none().then(|| self.diagnostics.nearest(name, names.keys().map(String::as_str)));
                let near = near.flatten().map(str::to_owned);
                self.report_missing(found, part, n, *span, near)
            }
        }
    }

    fn report_missing<T>(
        &mut self,
        found: Option<T>,
        reference: &Reference<'_>,
        n: usize,
        span: Span,
        near: Option<String>,
    ) -> Option<T> {
        let failed = &self.failed_materials;
        let is_news = found.is_none()
            && match reference {
                Reference::Number(..) => failed.is_empty(),
                Reference::Name(name, _) => !failed.contains(&Some(name.to_string())),
            };
        if is_news {
            let message = match reference {
                Reference::Number(i, _) => format!("there is no material number {i}"),
                Reference::Name(name, _) => format!("there is no material named `{name}`"),
            };
            let help = match (near, n) {
                (Some(near), _) => format!("did you mean `{near}`?"),
                (None, 0) => "the scene has no materials: add a `Materials` block".to_owned(),
                (None, n) => format!("the scene has {n} materials, numbered from 0 to {}", n - 1),
            };
            self.diagnostics.push(Diagnostic::error(message).label(span, "asked for here").help(help));
        }
        found
    }
}
