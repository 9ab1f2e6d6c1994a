//! Which functions are too long to be held in one's head.

/// Lines of a function, from its name to its closing brace, that are too many.
const TOO_LONG: usize = 60;

/// Functions of a source that are too long: line, name and length. Tests, which are often lists, may be.
///
/// A function ends at the first line that is its indentation and a brace; `rustfmt` makes sure of that.
pub fn find(text: &str) -> Vec<(usize, &str, usize)> {
    let lines: Vec<&str> = text.lines().collect();
    let end = lines.windows(2).position(is_test_module).unwrap_or(lines.len());
    let functions = lines[..end].iter().enumerate().filter_map(|(i, line)| Some((i, function(line)?)));
    let measured = functions.filter_map(|(i, (indent, name))| {
        let is_end = |line: &&str| line.strip_prefix(indent).is_some_and(|rest| rest == "}");
        let has_body =
            lines[i..].iter().position(|line| line.ends_with('{') || line.ends_with(['}', ';']))?;
        if !lines[i + has_body].ends_with('{') {
            return None;
        }
        let length = lines[i..].iter().position(is_end)? + 1;
        (length >= TOO_LONG).then_some((i + 1, name, length))
    });
    measured.collect()
}

fn is_test_module(pair: &[&str]) -> bool {
    matches!(pair, [attribute, module] if *attribute == "#[cfg(test)]" && module.starts_with("mod ") && module.ends_with('{'))
}

/// The indentation and the name of a function that begins on a line.
fn function(line: &str) -> Option<(&str, &str)> {
    let code = line.trim_start();
    let indent = &line[..line.len() - code.len()];
    let (before, rest) = code.split_once("fn ")?;
    let is_prefix =
        |word: &str| matches!(word, "const" | "async" | "unsafe" | "extern" | "\"C\"" | "default");
    let is_definition = before.split_whitespace().all(|word| {
        is_prefix(word) || word.starts_with("pub") || word.starts_with("crate::") || word.ends_with(')')
    });
    let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
    (is_definition && end > 0).then_some((indent, &rest[..end]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_functions_are_found() {
        let of = |lines: usize| {
            format!(
                "impl A {{\n    pub(super) fn long(&self) {{\n{}    }}\n}}\n",
                "        x();\n".repeat(lines)
            )
        };
        assert_eq!(find(&of(58)), [(2, "long", 60)]);
        assert_eq!(find(&of(57)), []);
        let of_tests = format!("#[cfg(test)]\nmod tests {{\n{}}}\n", of(100));
        assert_eq!(find(&of_tests), []);
        let blocks =
            format!("fn short() -> u8 {{\n    1\n}}\n\nfn next() {{\n{}}}\n", "    {\n    }\n".repeat(40));
        assert_eq!(find(&blocks), [(5, "next", 82)]);
    }

    #[test]
    fn declarations_have_no_length() {
        let text =
            format!("trait A {{\n    fn a(&self);\n    fn b(&self) {{}}\n{}}}\n", "    // \n".repeat(70));
        assert_eq!(find(&text), []);
    }
}
