//! The text of a file as an editor shows it, with `\n` at the end of each line, and the way back to the file's bytes.

/// The text with each `\r\n` as `\n`.
pub fn shown(file: &str) -> String {
    file.replace("\r\n", "\n")
}

/// The byte of the file that a byte of [`shown`] stands for: the first of two at the end of a line.
pub fn in_file(file: &str, at: usize) -> usize {
    let mut left = at;
    for (i, byte) in file.bytes().enumerate() {
        let is_hidden = byte == b'\r' && file.as_bytes().get(i + 1) == Some(&b'\n');
        if left == 0 {
            return i;
        }
        left -= usize::from(!is_hidden);
    }
    file.len()
}

/// The byte of [`shown`] that a byte of the file is shown as.
pub fn in_shown(file: &str, at: usize) -> usize {
    at - file.get(..at).map_or(0, |before| before.matches("\r\n").count())
}

/// The text of the file once what is shown of it has been edited to be `edited`.
///
/// What the edit left alone keeps its bytes, and new lines end as the file's first line does.
pub fn edited(file: &str, edited: &str) -> String {
    let before = shown(file);
    let start = common(before.chars(), edited.chars());
    let end = common(before[start..].chars().rev(), edited[start..].chars().rev());
    let kept = [in_file(file, start), in_file(file, before.len() - end)];
    let new = shown(&edited[start..edited.len() - end]);
    let new = if ends_lines_with_two(file) { new.replace('\n', "\r\n") } else { new };
    [&file[..kept[0]], &new, &file[kept[1]..]].concat()
}

/// Bytes of the characters that two texts begin with.
fn common(a: impl Iterator<Item = char>, b: impl Iterator<Item = char>) -> usize {
    a.zip(b).take_while(|(a, b)| a == b).map(|(a, _)| a.len_utf8()).sum()
}

/// Whether the first line ends with `\r\n`.
fn ends_lines_with_two(file: &str) -> bool {
    file.find('\n').is_some_and(|end| file[..end].ends_with('\r'))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Replaces the first `from` of what is shown.
    fn replaced(file: &str, from: &str, to: &str) -> String {
        edited(file, &shown(file).replacen(from, to, 1))
    }

    #[test]
    fn what_is_left_alone_keeps_its_bytes() {
        let file = "a\r\nb\nc\r\n\r\nd";
        assert_eq!(edited(file, &shown(file)), file);
        assert_eq!(replaced(file, "b", "\u{e9}"), "a\r\n\u{e9}\nc\r\n\r\nd");
        assert_eq!(replaced(file, "c\n", "c"), "a\r\nb\nc\r\nd", "a line end goes as a whole");
        assert_eq!(replaced(file, "d", ""), "a\r\nb\nc\r\n\r\n");
        assert_eq!(replaced(file, "a", "<\n>"), "<\r\n>\r\nb\nc\r\n\r\nd", "as the first line ends");
        assert_eq!(replaced("a\nb\r\n", "b", "1\n2"), "a\n1\n2\r\n");
        assert_eq!(edited("", "x\r\ny"), "x\ny");
    }

    #[test]
    fn every_edit_of_one_place_shows_as_it_was_made() {
        let texts = ["", "a", "\u{20ac}", "aa", "\n", "a\nb", "\n\n", "b\na\n"];
        for before in texts {
            for between in texts {
                for after in texts {
                    for new in texts {
                        let file = [before, between, after].concat().replace('\n', "\r\n");
                        let wanted = [before, new, after].concat();
                        let result = edited(&file, &wanted);
                        assert_eq!(shown(&result), wanted, "{file:?}");
                        assert!(result.starts_with(&before.replace('\n', "\r\n")), "{file:?} {result:?}");
                        assert!(result.ends_with(&after.replace('\n', "\r\n")), "{file:?} {result:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn places_go_there_and_back() {
        let file = "a\r\n\u{20ac}\nb\r\n";
        for (at, _) in shown(file).char_indices() {
            assert_eq!(in_shown(file, in_file(file, at)), at);
        }
        assert_eq!(in_file(file, 1), 1, "before the line end, not within it");
        assert_eq!(in_file(file, 99), file.len());
    }
}
