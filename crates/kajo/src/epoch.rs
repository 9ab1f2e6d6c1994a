//! Which programs make the same pictures, bit for bit.
//!
//! A checkpoint, or the work of a farm, is put together by several runs, perhaps of several programs on several machines.
//! All of them must round alike. What decides that is not the file of the program, which differs from one compiler
//! and processor to the next, but what it was made of: nothing that decides a pixel depends on the platform (see
//! `kajo_math::fmath`). So an identity is three things, in words that people can compare:
//!
//! * the version of kajo
//! * the *determinism epoch*, raised by hand when something outside of the sources changes pictures: a library that
//!   decodes files or computes elementary functions, or a compiler found to round otherwise
//! * a digest of the sources of all crates that decide bits, which tells builds between two versions apart

/// Raised whenever pictures change for a reason that is not in the sources of these crates.
pub const EPOCH: u32 = 1;

/// What decides the bits of this program's pictures: `kajo 0.1.0, determinism epoch 1, sources 0123456789abcdef`.
///
/// Programs of equal identity can share a render; others are told apart by this text.
pub fn build_identity() -> String {
    identity(env!("CARGO_PKG_VERSION"), EPOCH, env!("KAJO_SOURCES"))
}

fn identity(version: &str, epoch: u32, sources: &str) -> String {
    format!("kajo {version}, determinism epoch {epoch}, sources {sources}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_identity_says_version_epoch_and_sources() {
        let mine = build_identity();
        assert!(
            mine.starts_with(&format!("kajo {}, determinism epoch ", env!("CARGO_PKG_VERSION"))),
            "{mine}"
        );
        let (_, sources) = mine.rsplit_once(' ').unwrap();
        assert!(sources.len() == 16 && sources.bytes().all(|b| b.is_ascii_hexdigit()), "{mine}");
        assert_ne!(sources, "cbf29ce484222325", "no source was found");
        assert_ne!(identity("1", 1, sources), identity("1", 2, sources));
        assert_eq!(mine, build_identity());
    }
}
