//! The `Textures` block: textures that have names.
//!
//! ```text
//! Textures {
//!     Clouds veil { size 2  octaves 5 }
//!     Ramp sky { texture veil  stop 0 0.1 0.2 0.6  stop 1 1 1 1 }
//! }
//! Materials { Matte { color sky  roughness veil } }
//! ```
//!
//! A texture may be made of others that stand before or after it. One that leads back to itself is refused with the names on the way, and
//! so is a graph that would take more than [`MAX_PARTS`] evaluations at a point.

use std::collections::HashMap;

use kajo_scene::{Diagnostic, Item, Params};

use super::Compiler;
use super::blocks::{TEXTURE_LIST, TEXTURES as MEMBERS};
use super::member::keywords;
use super::misplaced::misplaced;
use super::named_texture::NamedTexture;

pub(super) const KEYWORDS: [&str; MEMBERS.len()] = keywords(&MEMBERS);

/// The most textures that one point may have to evaluate.
const MAX_PARTS: u32 = 1024;

/// The most textures one within the other.
const MAX_DEPTH: u32 = 64;

/// How far the reading of a texture has come.
#[derive(Clone, Copy, PartialEq)]
enum State {
    Untouched,
    /// Its parts are being read.
    Open,
    /// Done, with the number of textures that a point evaluates, and how deep they go.
    Done(u32, u32),
}

/// The named textures of a block and what they are made of.
struct Graph<'t> {
    items: Vec<Item<'t>>,
    names: Vec<String>,
    /// Numbers of the textures that each names, as often as it does.
    parts: Vec<Vec<usize>>,
}

impl Compiler<'_> {
    /// Reads all textures, each after those that it is made of.
    pub(super) fn textures(&mut self, item: Item<'_>) {
        let mut params = Params::new(item, self.diagnostics);
        let items = params.take(&KEYWORDS);
        params.elsewhere(|item| misplaced(item, Some(TEXTURE_LIST.keyword)));
        params.finish();
        let graph = self.texture_graph(items);
        let mut states = vec![State::Untouched; graph.items.len()];
        for i in 0..graph.items.len() {
            self.read_texture(i, &graph, &mut states);
            if !self.has_memory_for_materials(item.head_span()) {
                return;
            }
        }
    }

    fn texture_graph<'t>(&mut self, items: Vec<Item<'t>>) -> Graph<'t> {
        let mut graph = Graph { items: Vec::new(), names: Vec::new(), parts: Vec::new() };
        let mut numbers = HashMap::new();
        for item in items {
            let Some(name) = item.word().map(|word| word.text().into_owned()) else {
                let error = Diagnostic::error(format!("`{}` has no name", item.keyword()));
                let error = error.label(item.head_span(), "nothing can be covered with it");
                self.diagnostics.push(error.help(format!("write `{} bark {{ }}`", item.keyword())));
                continue;
            };
            if name.contains('.') || name == "spectrum" {
                let error = Diagnostic::error(format!("`{name}` is no name of a texture"));
                let error = error.label(item.head_span(), "would be read as a file or a spectrum");
                self.diagnostics.push(error.help("choose a name without a dot"));
                continue;
            }
            if numbers.insert(name.clone(), graph.items.len()).is_some() {
                let error = Diagnostic::error(format!("there are two textures named `{name}`"));
                self.diagnostics.push(error.label(item.head_span(), "the second one"));
            }
            graph.items.push(item);
            graph.names.push(name);
        }
        for item in &graph.items {
            let block = MEMBERS.iter().find(|member| member.block.keyword == item.keyword());
            let is_texture = |key: &str| {
                block.is_some_and(|member| {
                    member.block.field(key).is_some_and(|field| field.texture.is_some())
                })
            };
            let named = item.children().filter(|child| is_texture(child.keyword()));
            let numbers = named.filter_map(|child| numbers.get(&*child.word()?.text()).copied());
            graph.parts.push(numbers.collect());
        }
        graph
    }

    /// Reads a texture after its parts; those on the way are in a list, since a thread's stack may be too small for them.
    fn read_texture(&mut self, i: usize, graph: &Graph<'_>, states: &mut [State]) {
        let mut opened = vec![(i, 0)];
        while let Some((i, seen)) = opened.last_mut() {
            let i = *i;
            if states[i] != State::Untouched && *seen == 0 {
                opened.pop();
                continue;
            }
            states[i] = State::Open;
            let Some(&part) = graph.parts[i].get(*seen) else {
                let parts = graph.parts[i].iter().map(|&part| states[part]);
                let (cost, depth) = parts.fold((1u32, 1u32), |(cost, depth), part| match part {
                    State::Done(of_part, its) => (cost.saturating_add(of_part), depth.max(its + 1)),
                    State::Untouched | State::Open => (cost, depth),
                });
                states[i] = State::Done(cost, depth);
                let texture =
                    self.within_limits(graph.items[i], cost, depth).then(|| self.texture(graph.items[i]));
                self.texture_names.insert(graph.names[i].clone(), texture.flatten());
                opened.pop();
                continue;
            };
            *seen += 1;
            if states[part] == State::Open {
                self.report_cycle(part, &opened, graph);
                self.texture_names.insert(graph.names[part].clone(), None);
            } else if states[part] == State::Untouched {
                opened.push((part, 0));
            }
        }
    }

    fn within_limits(&mut self, item: Item<'_>, cost: u32, depth: u32) -> bool {
        if cost <= MAX_PARTS && depth <= MAX_DEPTH {
            return true;
        }
        let message = if cost > MAX_PARTS {
            format!("this texture is made of more than {MAX_PARTS} others")
        } else {
            format!("this texture has more than {MAX_DEPTH} others one within the other")
        };
        self.diagnostics.push(Diagnostic::error(message).label(item.head_span(), "too large a graph"));
        false
    }

    /// Reports a texture that leads back to itself.
    fn report_cycle(&mut self, start: usize, opened: &[(usize, usize)], graph: &Graph<'_>) {
        let way = opened.iter().map(|&(i, _)| i).skip_while(|&i| i != start).chain([start]);
        let names: Vec<&str> = way.map(|i| &*graph.names[i]).collect();
        let error = Diagnostic::error(format!("a texture is made of itself: {}", names.join(" -> ")));
        self.diagnostics.push(error.label(graph.items[start].head_span(), "leads back here"));
    }

    fn texture(&mut self, item: Item<'_>) -> Option<NamedTexture> {
        let member = MEMBERS.iter().find(|member| member.block.keyword == item.keyword())?;
        self.read_keys(item, |params, sources| {
            params.name();
            (member.read)(params, sources)
        })
    }
}
