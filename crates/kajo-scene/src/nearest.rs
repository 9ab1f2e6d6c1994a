//! The word somebody probably meant.

/// Cost of one inserted, deleted, swapped or changed letter.
const EDIT: usize = 4;
/// Cost of a letter that differs in case only.
const CASE: usize = 1;
/// Longer words are not compared: nobody misspells them by accident.
const LONGEST: usize = 64;

/// The candidate closest to `word`, if it is close enough to be a slip of the pen.
///
/// Closeness is the Damerau-Levenshtein distance (optimal string alignment),
/// in which a change of case costs a quarter. One slip is allowed for every
/// three letters, and always one. Of equals the first in the alphabet wins.
///
/// ```
/// let keys = ["radius", "center"];
/// assert_eq!(kajo_scene::nearest("raduis", keys.into_iter()), Some("radius"));
/// assert_eq!(kajo_scene::nearest("direction", keys.into_iter()), None);
/// ```
pub fn nearest<'a>(word: &str, mut candidates: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    nearest_of(word, &mut candidates)
}

fn nearest_of<'a>(word: &str, candidates: &mut dyn Iterator<Item = &'a str>) -> Option<&'a str> {
    let word: Vec<char> = word.chars().take(LONGEST + 1).collect();
    if word.is_empty() || word.len() > LONGEST {
        return None;
    }
    let allowed = (word.len() / 3).max(1) * EDIT;
    candidates
        .map(|candidate| {
            (distance(&word, &candidate.chars().take(LONGEST + 1).collect::<Vec<_>>()), candidate)
        })
        .filter(|&(cost, candidate)| cost <= allowed && cost < candidate.chars().count() * EDIT)
        .min()
        .map(|(_, candidate)| candidate)
}

fn distance(a: &[char], b: &[char]) -> usize {
    let mut before_last: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=b.len()).map(|j| j * EDIT).collect();
    for i in 1..=a.len() {
        let mut row = vec![i * EDIT; b.len() + 1];
        for j in 1..=b.len() {
            let (x, y) = (a[i - 1], b[j - 1]);
            let mut cost = (last[j - 1] + change(x, y)).min(last[j] + EDIT).min(row[j - 1] + EDIT);
            if i > 1 && j > 1 && same_letter(x, b[j - 2]) && same_letter(a[i - 2], y) {
                cost = cost.min(before_last[j - 2] + EDIT);
            }
            row[j] = cost;
        }
        before_last = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}

fn change(x: char, y: char) -> usize {
    match x == y {
        true => 0,
        false if same_letter(x, y) => CASE,
        false => EDIT,
    }
}

fn same_letter(x: char, y: char) -> bool {
    x.eq_ignore_ascii_case(&y)
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEYS: [&str; 8] =
        ["Sphere", "Plane", "PhongMaterial", "diffuseColor", "specularColor", "up", "size", "exponent"];

    #[test]
    fn slips_are_recognised() {
        for (word, meant) in [
            ("Shpere", "Sphere"),
            ("sphere", "Sphere"),
            ("SPHERE", "Sphere"),
            ("Spher", "Sphere"),
            ("Sphere1", "Sphere"),
            ("diffusecolor", "diffuseColor"),
            ("diffuse_color", "diffuseColor"),
            ("diffuseColour", "diffuseColor"),
            ("phongmaterial", "PhongMaterial"),
            ("Up", "up"),
            ("exponet", "exponent"),
        ] {
            assert_eq!(nearest(word, KEYS.into_iter()), Some(meant), "{word}");
        }
    }

    #[test]
    fn other_words_are_left_alone() {
        for word in ["", "Torus", "xy", "a", "color", "materials", &"Sphere".repeat(100)] {
            assert_eq!(nearest(word, KEYS.into_iter()), None, "{word}");
        }
        assert_eq!(nearest("Sphere", std::iter::empty()), None);
    }

    #[test]
    fn distances_by_hand() {
        let cost =
            |a: &str, b: &str| distance(&a.chars().collect::<Vec<_>>(), &b.chars().collect::<Vec<_>>());
        assert_eq!(cost("abc", "abc"), 0);
        assert_eq!(cost("abc", "aBc"), CASE);
        assert_eq!(cost("abc", "acb"), EDIT);
        assert_eq!(cost("abc", "ac"), EDIT);
        assert_eq!(cost("ca", "abc"), 3 * EDIT, "optimal string alignment edits no letter twice");
        assert_eq!(cost("", "abc"), 3 * EDIT);
    }
}
