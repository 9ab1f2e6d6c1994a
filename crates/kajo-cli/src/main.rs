//! The `kajo` command line.
fn main() {}
