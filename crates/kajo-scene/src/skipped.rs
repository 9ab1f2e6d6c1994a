//! Statements of a file that are not read, to be told of.

/// Kinds of statements that are told apart.
const MOST: usize = 32;

/// Statements that are not read: each kind of them with the line of the first.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Skipped {
    kinds: Vec<Kind>,
    /// Statements of further kinds.
    others: usize,
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct Kind {
    what: String,
    /// Line of the first, from 1.
    line: usize,
    count: usize,
}

impl Skipped {
    /// Counts a statement that begins with `word`.
    pub(crate) fn word(&mut self, word: &[u8], line: usize) {
        const LONGEST: usize = 40;
        let word = &word[..word.len().min(4 * LONGEST)];
        let shown: String = String::from_utf8_lossy(word).chars().take(LONGEST).collect();
        self.add(&format!("`{shown}`"), line);
    }

    /// Counts something that is not read.
    pub(crate) fn add(&mut self, what: &str, line: usize) {
        if let Some(kind) = self.kinds.iter_mut().find(|kind| kind.what == what) {
            kind.count += 1;
        } else if self.kinds.len() < MOST {
            self.kinds.push(Kind { what: what.to_owned(), line, count: 1 });
        } else {
            self.others += 1;
        }
    }

    /// How many statements there are.
    pub fn count(&self) -> usize {
        self.kinds.iter().map(|kind| kind.count).sum::<usize>() + self.others
    }

    /// A sentence about each kind.
    pub fn sentences(&self) -> Vec<String> {
        let sentence = |kind: &Kind| {
            let more = if kind.count == 1 { String::new() } else { format!(" and {} more", kind.count - 1) };
            format!("{} is not read (line {}{more})", kind.what, kind.line)
        };
        let others = (self.others > 0).then(|| format!("{} other statements are not read", self.others));
        self.kinds.iter().map(sentence).chain(others).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_is_named_once_with_its_first_line() {
        let mut skipped = Skipped::default();
        for (word, line) in [("l", 4), ("curv", 6), ("l", 9), ("l", 10)] {
            skipped.word(word.as_bytes(), line);
        }
        assert_eq!(
            skipped.sentences(),
            ["`l` is not read (line 4 and 2 more)", "`curv` is not read (line 6)"]
        );
        for i in 0..1000 {
            skipped.word(format!("x{i}").as_bytes(), i);
        }
        skipped.word(&[b'y'; 100_000], 1);
        let sentences = skipped.sentences();
        assert_eq!((sentences.len(), skipped.count()), (MOST + 1, 1005));
        assert_eq!(sentences[MOST], "971 other statements are not read");
    }
}
