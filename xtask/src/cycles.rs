//! Cycles between the files of a crate.
//!
//! A file depends on another where it names an item that the other one defines. A name that a module only hands
//! on (`pub use`) belongs to the file that defines it, and handing it on is no dependency. A module and those below it
//! count as one, since a family's trait and its list of members stand in the module above its members. Tests are left out.
//! The sources are read as tokens, which finds what paths and `use` name; methods of a type are not looked up.

use std::collections::{BTreeMap, BTreeSet};

/// A source file: where it stands below `src`, with `/` between folders, and its text.
pub type Source = (String, String);

/// Files that depend on each other in a circle, sorted, with what ties them: `a.rs -> b.rs: Name, other`.
#[derive(Debug, PartialEq, Eq)]
pub struct Cycle {
    pub files: Vec<String>,
    pub ties: Vec<String>,
}

/// Finds every set of files of one crate that depend on each other in a circle.
pub fn find(sources: &[Source]) -> Vec<Cycle> {
    let modules = Modules::read(sources);
    let edges = modules.dependencies();
    let reach: BTreeMap<&Path, BTreeSet<&Path>> =
        modules.0.keys().map(|module| (module, reached(&edges, module))).collect();
    let mut cycles: Vec<BTreeSet<&Path>> = Vec::new();
    for (module, far) in &reach {
        let circle: BTreeSet<&Path> =
            far.iter().copied().filter(|other| reach[other].contains(module)).collect();
        if circle.len() > 1 && !cycles.contains(&circle) {
            cycles.push(circle);
        }
    }
    cycles.iter().map(|circle| modules.cycle(circle, &edges)).collect()
}

/// The names of a module from the crate's root; the root's own is empty.
type Path = Vec<String>;

/// Which names each module takes from which other one.
type Edges = BTreeMap<Path, BTreeMap<Path, BTreeSet<String>>>;

struct Module {
    file: String,
    tokens: Vec<String>,
    /// What `use` binds here: the name, the path it stands for as written, and whether it is handed on.
    imports: Vec<Import>,
}

struct Import {
    name: String,
    path: Path,
    handed_on: bool,
}

struct Modules(BTreeMap<Path, Module>);

impl Modules {
    fn read(sources: &[Source]) -> Self {
        let mut modules = BTreeMap::new();
        let mut tests: Vec<Path> = Vec::new();
        for (file, text) in sources {
            let path = module_path(file);
            let (tokens, test_modules) = without_tests(tokens(text));
            tests.extend(test_modules.into_iter().map(|name| [path.clone(), vec![name]].concat()));
            let (tokens, imports) = split_imports(&tokens);
            modules.insert(path, Module { file: file.clone(), tokens, imports });
        }
        modules.retain(|path, _| !tests.iter().any(|test| path.starts_with(test)));
        Self(modules)
    }

    fn dependencies(&self) -> Edges {
        let mut edges = Edges::new();
        for (here, module) in &self.0 {
            let mut depend = |owner: Option<Path>, name: &str| {
                let is_apart = |owner: &Path| !owner.starts_with(here) && !here.starts_with(owner);
                if let Some(owner) = owner.filter(is_apart) {
                    edges.entry(here.clone()).or_default().entry(owner).or_default().insert(name.to_owned());
                }
            };
            for import in &module.imports {
                let used = !import.handed_on || module.tokens.contains(&import.name);
                if used && self.module(here, &import.path).is_none() {
                    depend(self.owner(here, &import.path, 0), &import.name);
                }
            }
            for path in paths(&module.tokens) {
                let name = path.last().cloned().unwrap_or_default();
                depend(self.owner(here, &path, 0), &name);
            }
        }
        edges
    }

    /// The module that a path written in `here` names, where it names one and no item of it.
    fn module(&self, here: &Path, path: &[String]) -> Option<Path> {
        let path = self.absolute(here, path, 0)?;
        self.0.contains_key(&path).then_some(path)
    }

    /// The module that defines what a path written in `here` names; `None` for what is not of this crate.
    fn owner(&self, here: &Path, path: &[String], depth: usize) -> Option<Path> {
        let absolute = self.absolute(here, path, depth)?;
        let inside = (0..=absolute.len()).rev().find(|&n| self.0.contains_key(&absolute[..n]))?;
        let module = absolute[..inside].to_vec();
        let Some(item) = absolute.get(inside) else { return Some(module) };
        let handed_on = self.0[&module].imports.iter().find(|import| import.name == *item);
        match handed_on {
            Some(import) if depth < 8 => {
                let further = [&import.path[..], &absolute[inside + 1..]].concat();
                self.owner(&module, &further, depth + 1)
            }
            _ => Some(module),
        }
    }

    /// A path from the crate's root. Its first name may be a module below `here` or one that `use` brought in.
    fn absolute(&self, here: &Path, path: &[String], depth: usize) -> Option<Path> {
        let (first, rest) = path.split_first()?;
        let base = match first.as_str() {
            "crate" => Vec::new(),
            "self" => here.clone(),
            "super" => here[..here.len().checked_sub(1)?].to_vec(),
            name => {
                let child = [&here[..], &[name.to_owned()]].concat();
                if self.0.contains_key(&child) {
                    child
                } else {
                    let import = self.0[here].imports.iter().find(|import| import.name == name)?;
                    if depth > 8 || import.path == path {
                        return None;
                    }
                    self.absolute(here, &import.path, depth + 1)?
                }
            }
        };
        match rest.first().map(String::as_str) {
            Some("super" | "self") => self.absolute(&base, rest, depth),
            _ => Some([&base[..], rest].concat()),
        }
    }

    fn cycle(&self, circle: &BTreeSet<&Path>, edges: &Edges) -> Cycle {
        let file = |module: &Path| self.0[module].file.clone();
        let mut ties = Vec::new();
        for &from in circle {
            for (to, names) in edges.get(from).into_iter().flatten().filter(|(to, _)| circle.contains(to)) {
                let names: Vec<&str> = names.iter().map(String::as_str).collect();
                ties.push(format!("{} -> {}: {}", file(from), file(to), names.join(", ")));
            }
        }
        Cycle { files: circle.iter().map(|&module| file(module)).collect(), ties }
    }
}

fn reached<'a>(edges: &'a Edges, from: &'a Path) -> BTreeSet<&'a Path> {
    let mut found = BTreeSet::new();
    let mut open = vec![from];
    while let Some(module) = open.pop() {
        for next in edges.get(module).into_iter().flat_map(BTreeMap::keys) {
            if found.insert(next) {
                open.push(next);
            }
        }
    }
    found
}

/// `light/mod.rs` and `light.rs` are `light`; `lib.rs` and `main.rs` are the root.
fn module_path(file: &str) -> Path {
    let stem = file.trim_end_matches(".rs");
    let stem = stem.strip_suffix("/mod").unwrap_or(stem);
    if stem == "lib" || stem == "main" { Vec::new() } else { stem.split('/').map(str::to_owned).collect() }
}

/// Words, `::` and single signs; without comments, texts and lifetimes.
fn tokens(text: &str) -> Vec<String> {
    let mut tokens = Vec::new();
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |end| end + 2)
        } else if let Some(length) = literal(rest) {
            length
        } else if c.is_alphanumeric() || c == '_' {
            let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
            tokens.push(rest[..end].to_owned());
            end
        } else if rest.starts_with("::") {
            tokens.push("::".to_owned());
            2
        } else {
            if !c.is_whitespace() {
                tokens.push(c.to_string());
            }
            c.len_utf8()
        };
        rest = &rest[length..];
    }
    tokens
}

/// How long the text, character or lifetime is that `rest` begins with.
fn literal(rest: &str) -> Option<usize> {
    let raw = rest.strip_prefix('r').map(|tail| tail.trim_start_matches('#'));
    if let Some(tail) = raw.filter(|tail| tail.starts_with('"')) {
        let hashes = rest.len() - tail.len() - 1;
        let end = format!("\"{}", "#".repeat(hashes));
        return Some(hashes + 2 + tail[1..].find(&end).map_or(tail.len() - 1, |at| at + end.len()));
    }
    if let Some(inside) = rest.strip_prefix('"') {
        let mut escaped = false;
        let end = inside.find(|c| {
            let ends = c == '"' && !escaped;
            escaped = c == '\\' && !escaped;
            ends
        });
        return Some(end.map_or(rest.len(), |end| end + 2));
    }
    let quoted = rest.strip_prefix('\'')?;
    if quoted.starts_with('\\') {
        return Some(quoted[2..].find('\'').map_or(rest.len(), |end| end + 4));
    }
    let c = quoted.chars().next()?;
    // A lifetime has no second quote.
    Some(if quoted[c.len_utf8()..].starts_with('\'') { c.len_utf8() + 2 } else { 1 })
}

/// Leaves out what stands under `#[cfg(test)]`; names the modules of other files among it.
fn without_tests(tokens: Vec<String>) -> (Vec<String>, Vec<String>) {
    const ONLY_TESTS: [&str; 7] = ["#", "[", "cfg", "(", "test", ")", "]"];
    let mut kept = Vec::new();
    let mut files = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        if !tokens[i..].iter().take(7).eq(ONLY_TESTS.iter()) {
            kept.push(tokens[i].clone());
            i += 1;
            continue;
        }
        let item = i + 7;
        let end = item_end(&tokens, item);
        if let Some(name) =
            tokens[item..end].iter().position(|token| token == "mod").map(|at| &tokens[item + at + 1])
        {
            files.push(name.clone());
        }
        i = end;
    }
    (kept, files)
}

/// Behind the item that begins at `start`: its `;`, or the brace that closes it.
fn item_end(tokens: &[String], start: usize) -> usize {
    let mut depth = 0_usize;
    for (i, token) in tokens.iter().enumerate().skip(start) {
        match token.as_str() {
            "{" | "(" | "[" => depth += 1,
            "}" | ")" | "]" => {
                depth = depth.saturating_sub(1);
                if depth == 0 && token == "}" {
                    return i + 1;
                }
            }
            ";" if depth == 0 => return i + 1,
            _ => {}
        }
    }
    tokens.len()
}

/// The tokens without their `use` declarations, and what those bind.
fn split_imports(tokens: &[String]) -> (Vec<String>, Vec<Import>) {
    let mut rest: Vec<String> = Vec::new();
    let mut imports = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let begins = rest.last().is_none_or(|last| ["}", ";", "]", "{", ")", "pub"].contains(&last.as_str()));
        if tokens[i] != "use" || !begins {
            rest.push(tokens[i].clone());
            i += 1;
            continue;
        }
        // `pub use` and `pub(crate) use` hand the name on; `#[attribute] use` does not.
        let handed_on = match rest.last().map(String::as_str) {
            Some("pub") => true,
            Some(")") => rest.iter().rev().take(4).any(|token| token == "pub"),
            _ => false,
        };
        let end = end_of_use(tokens, i);
        read_tree(&tokens[i + 1..end], &mut Vec::new(), handed_on, &mut imports);
        i = end + 1;
    }
    (rest, imports)
}

fn end_of_use(tokens: &[String], start: usize) -> usize {
    tokens[start..].iter().position(|token| token == ";").map_or(tokens.len(), |at| start + at)
}

/// Reads a tree of `use`, `a::{b, c::D as E, self}`, and returns how many tokens it took.
fn read_tree(tokens: &[String], path: &mut Path, handed_on: bool, imports: &mut Vec<Import>) -> usize {
    let depth = path.len();
    let mut i = 0;
    while let Some(token) = tokens.get(i) {
        match token.as_str() {
            "{" => {
                i += 1;
                while tokens.get(i).is_some_and(|token| token != "}") {
                    i += read_tree(&tokens[i..], path, handed_on, imports);
                    i += usize::from(tokens.get(i).is_some_and(|token| token == ","));
                }
                path.truncate(depth);
                return i + 1;
            }
            "::" => i += 1,
            "as" | "," | "}" => break,
            name => {
                path.push(name.to_owned());
                i += 1;
            }
        }
    }
    let mut name = path.last().cloned().unwrap_or_default();
    if name == "self" && path.len() > 1 {
        path.pop();
        name = path.last().cloned().unwrap_or_default();
    }
    if tokens.get(i).is_some_and(|token| token == "as") {
        name = tokens.get(i + 1).cloned().unwrap_or_default();
        i += 2;
    }
    imports.push(Import { name, path: path.clone(), handed_on });
    path.truncate(depth);
    i
}

/// Every path of two names or more.
fn paths(tokens: &[String]) -> Vec<Path> {
    let is_name =
        |i: usize| tokens.get(i).is_some_and(|token| token.chars().all(|c| c.is_alphanumeric() || c == '_'));
    let mut paths = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let mut path = vec![tokens[i].clone()];
        let start = i;
        while is_name(i) && tokens.get(i + 1).is_some_and(|token| token == "::") && is_name(i + 2) {
            path.push(tokens[i + 2].clone());
            i += 2;
        }
        let follows =
            start > 0 && [":", "::", "."].contains(&tokens[start - 1].as_str()) && tokens[start - 1] != ":";
        if path.len() > 1 && !follows {
            paths.push(path);
        }
        i += 1;
    }
    paths
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(files: &[(&str, &str)]) -> Vec<Vec<String>> {
        let sources: Vec<Source> =
            files.iter().map(|(file, text)| ((*file).to_owned(), (*text).to_owned())).collect();
        find(&sources).into_iter().map(|cycle| cycle.files).collect()
    }

    #[test]
    fn two_files_that_name_each_other_are_a_cycle() {
        let a = ("a.rs", "use crate::b::{self, B};\npub struct A(B);\nfn f() { b::g() }");
        let b = ("b.rs", "pub struct B; pub fn g() { let _ = crate::a::A; }");
        let lib = ("lib.rs", "mod a; mod b;");
        assert_eq!(found(&[lib, a, b]), [["a.rs", "b.rs"]]);
        let apart = ("b.rs", "//! See `crate::a::A`.\npub struct B; pub fn g() { let _ = \"crate::a::A\"; }");
        assert!(found(&[lib, a, apart]).is_empty(), "comments and texts name nothing");
        let cycle = &find(&[lib, a, b].map(|(file, text)| (file.to_owned(), text.to_owned())))[0];
        assert_eq!(cycle.ties, ["a.rs -> b.rs: B, g", "b.rs -> a.rs: A"]);
    }

    #[test]
    fn names_belong_to_the_file_that_defines_them() {
        let lib = ("lib.rs", "mod a; mod b; mod c; pub use a::A; pub(crate) use b::*;");
        let a = ("a.rs", "use crate::c::C; pub struct A(C);");
        let b = ("b.rs", "pub struct B;");
        let c = ("c.rs", "use crate::A as Other; pub struct C; fn f(_: Other) {}");
        assert_eq!(found(&[lib, a, b, c]), [["a.rs", "c.rs"]], "through the root, under another name");
        let c = ("c.rs", "pub struct C;");
        assert!(found(&[lib, a, b, c]).is_empty());
    }

    #[test]
    fn longer_circles_and_paths_by_super_are_found() {
        let lib = ("lib.rs", "mod m;");
        let m = ("m/mod.rs", "mod a; mod b; mod c;");
        let a = ("m/a.rs", "pub fn f() { super::b::f() }");
        let b = ("m/b.rs", "use super::c::f as g; pub fn f() { g() }");
        let c = ("m/c.rs", "use super::super::m::a; pub fn f() { a::f() }");
        assert_eq!(found(&[lib, m, a, b, c]), [["m/a.rs", "m/b.rs", "m/c.rs"]]);
    }

    #[test]
    fn a_module_and_those_below_it_count_as_one_and_tests_do_not_count() {
        let lib = ("lib.rs", "mod m;");
        let m = ("m.rs", "mod a; mod b; pub trait T {} pub use a::A; fn f(_: A) {}");
        let a = (
            "m/a.rs",
            "pub struct A; impl super::T for A {} #[cfg(test)] mod tests { use super::super::b::B; fn g(_: B) {} }",
        );
        let b = ("m/b.rs", "use super::A; pub struct B(A); #[cfg(test)] mod tests;");
        let tests = ("m/b/tests.rs", "use crate::m::A;");
        assert!(found(&[lib, m, a, b, tests]).is_empty());
    }

    #[test]
    fn sources_are_cut_into_words() {
        let text =
            "let c = '\\''; let s = r#\"crate::a\"#; x::<'a>() // crate::b\n/* crate::c */ \"\\\"crate::d\"";
        assert_eq!(tokens(text).join(" "), "let c = ; let s = ; x :: < a > ( )");
    }
}
