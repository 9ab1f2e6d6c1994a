//! Any bytes as a picture of every format.

#![no_main]

use kajo_image::{DecodeLimits, Format, decode};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let limits = DecodeLimits { max_side: 4096, max_bytes: 1 << 20 };
    for format in Format::ALL {
        if let Ok(decoded) = decode(data, Some(format), &limits) {
            assert!(decoded.image.width() <= limits.max_side && decoded.image.height() <= limits.max_side);
        }
    }
});
