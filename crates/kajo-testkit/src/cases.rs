//! Tests that take long are run in part, and in full where `KAJO_DEEP` is set.

/// Whether tests that take long are run in full: `KAJO_DEEP` is set.
pub fn is_deep() -> bool {
    std::env::var_os("KAJO_DEEP").is_some()
}

/// Cases of a test that takes long: every `step`-th of them, from the first on, and all of them where tests are run in full.
pub fn every<T>(step: usize, cases: impl IntoIterator<Item = T>) -> impl Iterator<Item = T> {
    cases.into_iter().step_by(if is_deep() { 1 } else { step })
}
