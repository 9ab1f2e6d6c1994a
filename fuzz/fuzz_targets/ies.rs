//! Any bytes as the intensities of a luminaire.

#![no_main]

use kajo_scene::read_ies;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    if let Ok(file) = read_ies(data) {
        assert_eq!(file.candela.len(), file.vertical_deg.len() * file.horizontal_deg.len());
        assert!(file.candela.iter().all(|v| *v >= 0.0 && v.is_finite()));
    }
});
