use std::path::Path;

use kajo::LoadOptions;
use kajo_math::keyed::{Interpolation, Outside};

use super::*;

const TEXT: &str = "Animation { fps 10  frames 1 30 }
let wide = keys { 0: 1  1: 2 } // of the ball
PerspectiveCamera { center keys cubic { 0: 0 1 9  1: 2 1 9 }  direction 0 0 -1  up 0 1 0  angle 30
  Motion { key 0 { }  key 1 { Translate 1 0 0 } } }
Materials { Matte red { color 0.8 0.1 0.1 } }
Group {
  MaterialIndex red
  Transform {
    Translate 0 keys loop { 0: 0  # low
      0.25: 1 /* high */  0.5: 0 } 0
    YRotate keys step { 0: 0  2: 90 }  YRotate 10
    Sphere ball { center 0 0 0  radius wide }
  }
  repeat i 3 { Disk { center i 0 0  normal 0 1 0  radius keys { 0: 1  1: i } } }
}
";

fn document(text: &str) -> Document {
    let mut document = Document::untitled(Path::new("."), text, LoadOptions::default()).unwrap();
    document.compile();
    assert!(document.is_current(), "{}", document.report(false));
    document
}

fn named<'a>(rows: &'a [KeyRow], name: &str) -> &'a KeyRow {
    let all = || rows.iter().map(|row| &row.name).collect::<Vec<_>>();
    rows.iter().find(|row| row.name == name).unwrap_or_else(|| panic!("no {name} in {:?}", all()))
}

#[test]
fn every_block_of_keys_is_a_row() {
    let document = document(TEXT);
    let rows = document.key_rows();
    let names: Vec<&str> = rows.iter().map(|row| &*row.name).collect();
    assert_eq!(
        names,
        [
            "let wide",
            "PerspectiveCamera center",
            "PerspectiveCamera motion",
            "Transform Translate y",
            "Transform YRotate",
            "Disk radius"
        ]
    );
    let low = named(&rows, "Transform Translate y");
    assert_eq!((low.interpolation, low.outside), (Interpolation::Linear, Outside::Loop));
    let times: Vec<(f64, f64, f64)> = low.keys.iter().map(|k| (k.frame, k.seconds, k.values[0])).collect();
    assert_eq!(times, [(1.0, 0.0, 0.0), (3.5, 0.25, 1.0), (6.0, 0.5, 0.0)]);
    assert!(matches!(&low.owner, KeyOwner::Field { key, first: 1, nth: 0, .. } if key == "Translate"));
    assert_eq!((low.key_at(6.0), low.key_at(5.0)), (Some(2), None));
    let eye = named(&rows, "PerspectiveCamera center");
    assert_eq!((eye.interpolation, &eye.keys[1].values[..]), (Interpolation::Cubic, &[2.0, 1.0, 9.0][..]));
    assert_eq!(named(&rows, "PerspectiveCamera motion").keys[1].frame, 11.0);
    assert!(named(&rows, "Disk radius").is_repeated && !eye.is_repeated);
    assert_eq!(&TEXT[eye.span.1.clone()], "keys cubic { 0: 0 1 9  1: 2 1 9 }");
}

#[test]
fn rows_are_known_again_at_another_frame() {
    let mut document = document(TEXT);
    let before = document.key_rows();
    document.show_frame(12);
    assert_eq!(document.key_rows(), before);
}
