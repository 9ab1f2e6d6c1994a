//! Measured spectra: values at wavelengths, joined by straight lines.
//!
//! As text, one pair on a line: the wavelength in nm, then the value, separated by blanks, a comma, a
//! semicolon or a colon. Empty lines and what follows `#` do not count.

/// What a table is beyond its ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Outside {
    /// Zero: right for lights.
    Zero,
    /// The value at the nearest end: right for reflectances and indices.
    #[default]
    Clamp,
}

/// Values at increasing wavelengths.
#[derive(Clone, Debug, PartialEq)]
pub struct Tabulated {
    /// At least one, strictly increasing, finite.
    nm: Vec<f32>,
    /// As many, finite.
    value: Vec<f32>,
    outside: Outside,
    /// One over the distance of neighbours, where it is the same for all.
    per_step: Option<f32>,
}

/// Why pairs or text are not a spectrum.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TabulatedError {
    /// There is no pair at all.
    #[error("a spectrum needs at least one pair of wavelength and value")]
    Empty,
    /// A wavelength is not a positive number or a value is not finite.
    #[error("pair {0}: a wavelength is a positive number of nanometres, a value a finite number")]
    NotANumber(usize),
    /// A wavelength is not greater than the one before.
    #[error("pair {0}: wavelengths must increase")]
    Order(usize),
    /// A line of text is not two numbers.
    #[error("line {line}: expected a wavelength in nm and a value, found `{found}`")]
    Line {
        /// Counted from 1.
        line: usize,
        /// The line, or its beginning.
        found: String,
    },
    /// A line of text holds a pair that cannot stand there.
    #[error("line {line}: {problem}")]
    Pair {
        /// Counted from 1.
        line: usize,
        /// What is wrong with it.
        problem: &'static str,
    },
}

impl Tabulated {
    /// The spectrum through `(nm, value)` pairs of increasing wavelength. Pairs are counted from 1 in errors.
    pub fn new(
        pairs: impl IntoIterator<Item = (f32, f32)>,
        outside: Outside,
    ) -> Result<Tabulated, TabulatedError> {
        let (nm, value): (Vec<f32>, Vec<f32>) = pairs.into_iter().unzip();
        if nm.is_empty() {
            return Err(TabulatedError::Empty);
        }
        for i in 0..nm.len() {
            if !(nm[i] > 0.0 && nm[i].is_finite() && value[i].is_finite()) {
                return Err(TabulatedError::NotANumber(i + 1));
            }
            if i > 0 && nm[i] <= nm[i - 1] {
                return Err(TabulatedError::Order(i + 1));
            }
        }
        let per_step = regular(&nm);
        Ok(Tabulated { nm, value, outside, per_step })
    }

    /// Values at `first`, `first + step` and so on, all in nm. The caller's table is known to be good.
    pub(crate) fn regular(first: f64, step: f64, values: &[f64], outside: Outside) -> Tabulated {
        let nm: Vec<f32> = (0..values.len()).map(|i| (first + step * i as f64) as f32).collect();
        let value = values.iter().map(|v| *v as f32).collect();
        let per_step = regular(&nm);
        Tabulated { nm, value, outside, per_step }
    }

    /// Reads text of two columns.
    pub fn parse(text: &str, outside: Outside) -> Result<Tabulated, TabulatedError> {
        let (mut pairs, mut lines) = (Vec::new(), Vec::new());
        for (i, line) in text.lines().enumerate() {
            let content = line.split('#').next().unwrap_or("").trim();
            if !content.is_empty() {
                let found = || content.chars().take(40).collect();
                pairs
                    .push(pair(content).ok_or_else(|| TabulatedError::Line { line: i + 1, found: found() })?);
                lines.push(i + 1);
            }
        }
        let at_line = |pair: usize, problem| TabulatedError::Pair { line: lines[pair - 1], problem };
        Tabulated::new(pairs, outside).map_err(|error| match error {
            TabulatedError::NotANumber(pair) => {
                at_line(pair, "a wavelength is a positive number of nanometres, a value a finite number")
            }
            TabulatedError::Order(pair) => at_line(pair, "wavelengths must increase"),
            other => other,
        })
    }

    /// The value at a wavelength in nm.
    pub fn at(&self, nm: f32) -> f32 {
        let last = self.nm.len() - 1;
        if !(nm >= self.nm[0] && nm <= self.nm[last]) {
            return match self.outside {
                Outside::Zero => 0.0,
                Outside::Clamp => self.value[if nm > self.nm[last] { last } else { 0 }],
            };
        }
        if last == 0 {
            return self.value[0];
        }
        let i = match self.per_step {
            Some(per_step) => (((nm - self.nm[0]) * per_step) as usize).min(last - 1),
            None => self.nm.partition_point(|node| *node <= nm).clamp(1, last) - 1,
        };
        let t = ((nm - self.nm[i]) / (self.nm[i + 1] - self.nm[i])).clamp(0.0, 1.0);
        // In double precision the difference of two large values does not overflow.
        let (a, b) = (f64::from(self.value[i]), f64::from(self.value[i + 1]));
        (a + f64::from(t) * (b - a)) as f32
    }

    /// The wavelengths of the nodes in nm.
    pub fn nm(&self) -> &[f32] {
        &self.nm
    }

    /// The values at the nodes.
    pub fn values(&self) -> &[f32] {
        &self.value
    }

    /// The same wavelengths with `f` of each value; what is not finite then becomes zero.
    pub fn map(&self, f: impl Fn(f32) -> f32) -> Tabulated {
        let value = self.value.iter().map(|v| Some(f(*v)).filter(|v| v.is_finite()).unwrap_or(0.0)).collect();
        Tabulated { value, ..self.clone() }
    }
}

/// One over the step of evenly spaced nodes.
fn regular(nm: &[f32]) -> Option<f32> {
    let last = nm.len() - 1;
    let step = (nm[last] - nm[0]) / last as f32;
    let even = |i: usize| (nm[0] + step * i as f32 - nm[i]).abs() <= 1e-3 * step;
    (last > 0 && (0..=last).all(even)).then_some(1.0 / step)
}

/// The two numbers of a line.
fn pair(content: &str) -> Option<(f32, f32)> {
    let separator = |c: char| c.is_whitespace() || matches!(c, ',' | ';' | ':');
    let mut words = content.split(separator).filter(|word| !word.is_empty());
    let pair = (words.next()?.parse().ok()?, words.next()?.parse().ok()?);
    words.next().is_none().then_some(pair)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Pairs of increasing wavelength, evenly spaced or not.
    fn pairs() -> impl Strategy<Value = Vec<(f32, f32)>> {
        let uneven = prop::collection::btree_set(1u32..100_000, 1..40)
            .prop_map(|nm| nm.into_iter().map(|nm| nm as f32 * 0.01).collect::<Vec<_>>());
        let even = (1u32..900, 1u32..200, 1usize..40).prop_map(|(first, step, n)| {
            (0..n).map(|i| first as f32 + 0.1 * step as f32 * i as f32).collect()
        });
        let values = prop::collection::vec(-3e38f32..3e38, 40);
        (prop_oneof![uneven, even], values).prop_map(|(nm, values)| nm.into_iter().zip(values).collect())
    }

    proptest! {
        #[test]
        fn values_lie_between_those_of_the_neighbours(pairs in pairs(), at in 0.0f32..1.0) {
            let table = Tabulated::new(pairs.iter().copied(), Outside::Clamp).unwrap();
            for (nm, value) in &pairs {
                prop_assert!((table.at(*nm) - value).abs() <= 1e-2 * value.abs().max(3e36), "{nm}");
            }
            for pair in pairs.windows(2) {
                let ((nm, a), (next, b)) = (pair[0], pair[1]);
                let between = table.at((nm + at * (next - nm)).min(next));
                prop_assert!(between >= a.min(b) && between <= a.max(b), "{nm}: {a} {b} {between}");
            }
        }

        #[test]
        fn text_gives_back_what_was_written(pairs in pairs()) {
            let text: String = pairs.iter().map(|(nm, value)| format!("{nm}, {value} # note\n")).collect();
            let expected = Tabulated::new(pairs, Outside::Zero);
            prop_assert_eq!(Tabulated::parse(&text, Outside::Zero), expected);
        }

        #[test]
        fn any_text_is_a_spectrum_or_a_mistake(text in "([0-9 .,eE#:;+-]|nan|inf|\\PC|\n){0,60}") {
            if let Ok(table) = Tabulated::parse(&text, Outside::Zero) {
                prop_assert!(table.at(555.0).is_finite());
            }
        }
    }

    #[test]
    fn nodes_are_met_and_joined_by_lines() {
        for pairs in
            [vec![(400.0, 1.0), (500.0, 3.0), (600.0, 2.0)], vec![(400.0, 1.0), (500.0, 3.0), (700.0, 1.0)]]
        {
            let t = Tabulated::new(pairs, Outside::Zero).unwrap();
            assert_eq!([t.at(400.0), t.at(450.0), t.at(500.0), t.at(600.0)], [1.0, 2.0, 3.0, 2.0]);
            assert_eq!([t.at(399.9), t.at(700.1), t.at(f32::NAN)], [0.0; 3]);
        }
        let t = Tabulated::new([(400.0, 1.0), (410.0, 3.0)], Outside::Clamp).unwrap();
        assert_eq!([t.at(1.0), t.at(900.0), t.at(f32::INFINITY)], [1.0, 3.0, 3.0]);
        assert_eq!(Tabulated::new([(589.0, 2.0)], Outside::Clamp).unwrap().at(400.0), 2.0);
        assert_eq!(t.map(|v| 1.0 / (v - 1.0)).values(), [0.0, 0.5]);
    }

    #[test]
    fn even_and_uneven_tables_agree() {
        let value = |i: usize| ((i * 37) % 11) as f32;
        let even =
            Tabulated::new((0..50).map(|i| (360.0 + 9.4 * i as f32, value(i))), Outside::Zero).unwrap();
        assert!(even.per_step.is_some());
        let uneven = Tabulated { per_step: None, ..even.clone() };
        for i in 0..1000 {
            let nm = 355.0 + 0.5 * i as f32;
            assert!((even.at(nm) - uneven.at(nm)).abs() < 1e-3, "{nm}");
        }
    }

    #[test]
    fn nearly_even_is_not_even() {
        let table = Tabulated::new([(100.0, 0.0), (109.8, 1.0), (120.0, 0.0)], Outside::Zero).unwrap();
        assert!((table.at(109.9) - (1.0 - 0.1 / 10.2)).abs() < 1e-5, "{}", table.at(109.9));
    }

    #[test]
    fn text_is_read() {
        let t =
            Tabulated::parse("# a paint\n400 0.5\n\n 450,0.6 # here\n500\t0.7\n600; 0.9\r\n", Outside::Clamp)
                .unwrap();
        assert_eq!(t.nm(), [400.0, 450.0, 500.0, 600.0]);
        assert_eq!(t.values(), [0.5, 0.6, 0.7, 0.9]);
    }

    #[test]
    fn mistakes_are_named_with_their_line() {
        let message = |text: &str| Tabulated::parse(text, Outside::Clamp).unwrap_err().to_string();
        assert_eq!(message("# nothing\n"), "a spectrum needs at least one pair of wavelength and value");
        assert_eq!(
            message("400 1\nnm value\n"),
            "line 2: expected a wavelength in nm and a value, found `nm value`"
        );
        assert_eq!(message("400 1 2"), "line 1: expected a wavelength in nm and a value, found `400 1 2`");
        assert_eq!(message("400"), "line 1: expected a wavelength in nm and a value, found `400`");
        assert_eq!(message("400 1\n#\n400 2\n"), "line 3: wavelengths must increase");
        let not_a_number = "a wavelength is a positive number of nanometres, a value a finite number";
        for text in ["400 nan", "-3 1", "inf 1", "400 1e99"] {
            assert_eq!(message(text), format!("line 1: {not_a_number}"));
        }
        let two = Tabulated::new([(400.0, 1.0), (300.0, 1.0)], Outside::Zero);
        assert_eq!(two, Err(TabulatedError::Order(2)));
    }
}
