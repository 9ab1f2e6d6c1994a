use super::functions::random;
use super::*;
use proptest::prelude::*;

fn value_of(name: &str, _: Range<usize>) -> Option<f64> {
    match name {
        "r" => Some(0.5),
        "i" => Some(3.0),
        _ => None,
    }
}

/// The value of all of `text`, or the message and the piece it is about.
fn value(text: &str) -> Result<f64, (String, &str)> {
    match evaluate(text, 0, Around::List, &value_of) {
        Ok(found) => {
            assert_eq!(found.end, text.len(), "{text}");
            Ok(found.value)
        }
        Err(error) => Err((error.message, &text[error.at])),
    }
}

#[test]
fn operators_bind_as_in_mathematics() {
    for (text, expected) in [
        ("2 * r + 1", 2.0),
        ("1 + 2 * 3", 7.0),
        ("(1 + 2) * 3", 9.0),
        ("2 ^ 3 ^ 2", 512.0),
        ("-2 ^ 2", -4.0),
        ("2 ^ -1", 0.5),
        ("8 / 4 / 2", 1.0),
        ("7 - 3 - 2", 2.0),
        ("-7 % 3", 2.0),
        ("--2", 2.0),
        ("(1-2)", -1.0),
        ("(1 -2)", -1.0),
        ("2*r", 1.0),
        (".5e1", 5.0),
        ("(2e)", f64::NAN),
        ("max(1, i, 2)", 3.0),
        ("( 4\n)", 4.0),
    ] {
        match value(text) {
            Ok(found) => assert_eq!(found, expected, "{text}"),
            Err(_) => assert!(expected.is_nan(), "{text}"),
        }
    }
}

#[test]
fn functions_have_their_values() {
    for (text, expected) in [
        ("sin(30 deg)", 0.5),
        ("cos(pi)", -1.0),
        ("atan2(1, -1)", 0.75 * PI),
        ("acos(0)", 0.5 * PI),
        ("sqrt(2) ^ 2", 2.0),
        ("ln(exp(3))", 3.0),
        ("mix(2, 4, 0.25)", 2.5),
        ("clamp(7, 0, 1)", 1.0),
        ("smoothstep(0, 2, 1)", 0.5),
        ("sign(-3) + step(1, 2) + fract(-0.25) + hypot(3, 4)", 5.75),
    ] {
        let found = value(text).unwrap();
        assert!((found - expected).abs() < 1e-15 * expected.abs().max(1.0), "{text}: {found}");
    }
    for function in &FUNCTIONS {
        assert!(function.usage.starts_with(&format!("{}(", function.name)));
        assert!(is_reserved(function.name));
    }
}

#[test]
fn random_numbers_fill_their_range_evenly() {
    let n = 4096;
    let drawn: Vec<f64> = (0..n).map(|i| random(f64::from(i))).collect();
    let mean = drawn.iter().sum::<f64>() / f64::from(n);
    // The standard deviation of the mean is 0.0045.
    assert!((mean - 0.5).abs() < 0.018, "{mean}");
    let mut bins = [0_u32; 16];
    drawn.iter().for_each(|x| bins[(x * 16.0) as usize] += 1);
    let chi_square: f64 = bins.iter().map(|&n| (f64::from(n) - 256.0).powi(2) / 256.0).sum();
    // One in ten thousand lies above 44.3 with 15 degrees of freedom.
    assert!(chi_square < 44.3, "{chi_square}");
    let neighbours: f64 = drawn.windows(2).map(|pair| (pair[0] - 0.5) * (pair[1] - 0.5)).sum();
    assert!((neighbours * 12.0 / f64::from(n)).abs() < 4.0 / f64::from(n).sqrt());
    assert_eq!(value("random(0, 2, 3)"), value("random(-0, 2, 3)"));
    assert!((2.0..3.0).contains(&value("random(7, 2, 3)").unwrap()));
}

#[test]
fn an_expression_ends_where_a_list_goes_on() {
    for (text, end) in [("1 -2", 1), ("r -r", 1), ("1 - 2 3", 5), ("r 4", 1), ("2 // c", 1), ("3 deg", 1)] {
        assert_eq!(evaluate(text, 0, Around::List, &value_of).unwrap().end, end, "{text}");
    }
    for (text, end) in [("1 -2 3", 4), ("2 * 3 deg c", 9), ("1-2", 3)] {
        assert_eq!(evaluate(text, 0, Around::Nothing, &value_of).unwrap().end, end, "{text}");
    }
    let names =
        ["r", "r + 1", "(r)", "2"].map(|text| evaluate(text, 0, Around::List, &value_of).unwrap().is_name);
    assert_eq!(names, [true, false, false, false]);
}

#[test]
fn mistakes_have_a_place() {
    for (text, message, place) in [
        ("1 / (i - 3)", "division by zero", "(i - 3)"),
        ("4 % 0", "division by zero", "0"),
        ("2 * q", "there is no value named `q`", "q"),
        ("sqrt(0 - 1)", "`sqrt` has no finite value at -1", "sqrt(0 - 1)"),
        ("1 + ln(0)", "`ln` has no finite value at 0", "ln(0)"),
        ("(1 + 2", "this `(` is not closed", "("),
        ("(1 2)", "this `(` is not closed", "("),
        ("sin(1, 2)", "`sin` takes no 2 arguments", "sin(1, 2)"),
        ("sin * 2", "the function `sin` has no arguments", "sin"),
        ("(2 * )", "expected a number, a name or `(`, found `)`", ")"),
        ("2 *", "expected a number, a name or `(` at the end of this", ""),
        ("1e300 * 1e300", "this has no finite value", "1e300 * 1e300"),
        ("sine(1)", "there is no function named `sine`", "sine"),
        ("0 ^ -1", "this has no finite value", "0 ^ -1"),
    ] {
        assert_eq!(value(text), Err((message.to_owned(), place)), "{text}");
    }
    let deep = "(".repeat(100) + "1" + &")".repeat(100);
    assert!(value(&deep).unwrap_err().0.contains("more than 64 deep"));
    assert!(value(&("-".repeat(1_000_000) + "1")).is_err(), "no stack overflow");
}

proptest! {
    #[test]
    fn sums_and_products_are_those_of_rust(a in -1e3..1e3f64, b in -1e3..1e3f64, c in 1e-3..1e3f64) {
        let text = format!("{a:?} * {b:?} - {b:?} / {c:?}");
        prop_assert_eq!(value(&text), Ok(a * b - b / c));
    }

    #[test]
    fn any_text_ends_in_a_value_or_a_message(text in "[-+*/%^() ,.0-9a-zé]{0,30}") {
        match evaluate(&text, 0, Around::List, &value_of) {
            Ok(found) => prop_assert!(found.value.is_finite() && text.is_char_boundary(found.end)),
            Err(error) => prop_assert!(text.get(error.at).is_some()),
        }
    }
}
