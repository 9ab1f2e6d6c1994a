//! Which lines differ between two texts: the fewest to be taken out of the one and put into the other
//! [Myers 1986, "An O(ND) difference algorithm and its variations"].

use std::ops::Range;

/// Texts that differ by more lines are taken to differ everywhere between their common beginning and end.
const MOST_STEPS: usize = 1000;

/// Neighbouring lines of one text that others stand for in another.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hunk {
    /// Lines of the old text, from 0.
    pub old: Range<usize>,
    /// Lines of the new text, from 0.
    pub new: Range<usize>,
}

/// Where two texts differ, from top to bottom. A line is compared with its end.
pub fn hunks(old: &str, new: &str) -> Vec<Hunk> {
    let [old, new] = [old, new].map(lines);
    hunks_of(&old, &new)
}

/// The lines of a text, each with its end.
pub(super) fn lines(text: &str) -> Vec<&str> {
    text.split_inclusive('\n').collect()
}

pub(super) fn hunks_of(old: &[&str], new: &[&str]) -> Vec<Hunk> {
    let start = old.iter().zip(new).take_while(|(a, b)| a == b).count();
    let rest = [&old[start..], &new[start..]];
    let end = rest[0].iter().rev().zip(rest[1].iter().rev()).take_while(|(a, b)| a == b).count();
    let [a, b] = rest.map(|lines| &lines[..lines.len() - end]);
    let mut gone = vec![false; a.len()];
    let mut come = vec![false; b.len()];
    match furthest(a, b) {
        Some(trace) => mark(&trace, &mut gone, &mut come),
        None => {
            gone.fill(true);
            come.fill(true);
        }
    }
    let mut hunks = Vec::new();
    let (mut i, mut j) = (0, 0);
    while i < a.len() || j < b.len() {
        let from = (i, j);
        i += gone[i..].iter().take_while(|gone| **gone).count();
        j += come[j..].iter().take_while(|come| **come).count();
        if (i, j) == from {
            (i, j) = (i + 1, j + 1);
        } else {
            hunks.push(Hunk { old: start + from.0..start + i, new: start + from.1..start + j });
        }
    }
    hunks
}

/// For each number of steps the line of `a` that can be reached on each diagonal `k`, which is a line of `a` less one
/// of `b`; diagonals from `-steps` to `steps`. `None` when the texts are too different.
fn furthest(a: &[&str], b: &[&str]) -> Option<Vec<Vec<usize>>> {
    let mut trace: Vec<Vec<usize>> = Vec::new();
    for steps in 0..=MOST_STEPS.min(a.len() + b.len()) {
        let before = trace.last();
        let mut reached = vec![0; 2 * steps + 1];
        for index in (0..=2 * steps).step_by(2) {
            let mut x = before.map_or(0, |before| {
                let (is_down, from) = came_from(before, index);
                from + usize::from(!is_down)
            });
            // With k = index - steps the line of `b` is x - k.
            let mut y = (x + steps).wrapping_sub(index);
            while x < a.len() && y < b.len() && a[x] == b[y] {
                (x, y) = (x + 1, y + 1);
            }
            reached[index] = x;
            if (x, y) == (a.len(), b.len()) {
                trace.push(reached);
                return Some(trace);
            }
        }
        trace.push(reached);
    }
    None
}

/// Whether the last step to a diagonal put a line in, rather than take one out, and the line of `a` it was made from.
///
/// * `before`: what can be reached with a step less
/// * `index`: of the diagonal, among those that can be reached with that step
fn came_from(before: &[usize], index: usize) -> (bool, usize) {
    // With a step less there is one diagonal less on both sides.
    let above = index.checked_sub(2).and_then(|below| before.get(below)).copied();
    let left = before.get(index).copied();
    match (above, left) {
        (Some(above), Some(left)) if above < left => (true, left),
        (Some(above), _) => (false, above),
        (None, left) => (true, left.unwrap_or(0)),
    }
}

/// Follows the shortest way back from the ends of both texts.
fn mark(trace: &[Vec<usize>], gone: &mut [bool], come: &mut [bool]) {
    let (mut x, mut y) = (gone.len(), come.len());
    for (steps, before) in (1..trace.len()).zip(trace).rev() {
        let (is_down, from) = came_from(before, x + steps - y);
        // Back over what is equal, and over the step before that.
        let k = x as isize - y as isize;
        x = from;
        if is_down {
            y = (x as isize - k - 1) as usize;
            come[y] = true;
        } else {
            y = (x as isize + 1 - k) as usize;
            gone[x] = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_lines_that_differ_are_found() {
        let hunk = |old, new| Hunk { old, new };
        assert_eq!(hunks("a\nb\nc\n", "a\nx\nc\n"), [hunk(1..2, 1..2)]);
        assert_eq!(
            hunks("a\nb\nc\nd\n", "b\nc\ny\nd\nz\n"),
            [hunk(0..1, 0..0), hunk(3..3, 2..3), hunk(4..4, 4..5)]
        );
        assert_eq!(hunks("a\n", "a"), [hunk(0..1, 0..1)], "the end of a line belongs to it");
        assert_eq!(hunks("", "a\nb"), [hunk(0..0, 0..2)]);
        assert!(hunks("a\nb", "a\nb").is_empty());
        let long = |word: &str| (0..1500).map(|i| format!("{word} {i}\n")).collect::<String>();
        assert_eq!(hunks(&long("a"), &long("b")), [hunk(0..1500, 0..1500)]);
    }

    /// Number of lines that two texts have in common, by the plain method.
    fn in_common(a: &[&str], b: &[&str]) -> usize {
        let mut table = vec![vec![0; b.len() + 1]; a.len() + 1];
        for (i, line) in a.iter().enumerate() {
            for (j, other) in b.iter().enumerate() {
                table[i + 1][j + 1] =
                    if line == other { table[i][j] + 1 } else { table[i][j + 1].max(table[i + 1][j]) };
            }
        }
        table[a.len()][b.len()]
    }

    proptest! {
        #[test]
        fn hunks_lead_from_one_text_to_the_other_and_are_as_small_as_can_be(
            old in "([abc]\n){0,12}", new in "([abc]\n){0,12}"
        ) {
            let [a, b] = [&old, &new].map(|text| lines(text));
            let found = hunks(&old, &new);
            let mut made = Vec::new();
            let mut at = 0;
            for hunk in &found {
                made.extend_from_slice(&a[at..hunk.old.start]);
                made.extend_from_slice(&b[hunk.new.clone()]);
                at = hunk.old.end;
            }
            made.extend_from_slice(&a[at..]);
            prop_assert_eq!(made, b.clone());
            let changed: usize = found.iter().map(|hunk| hunk.old.len() + hunk.new.len()).sum();
            prop_assert_eq!(changed, a.len() + b.len() - 2 * in_common(&a, &b));
        }
    }
}
