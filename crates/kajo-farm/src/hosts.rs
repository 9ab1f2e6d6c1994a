//! Which host brought how much.

/// What a host has brought so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HostShare {
    /// Units.
    pub units: u64,
    /// Samples.
    pub samples: u64,
    /// Seconds that it rendered.
    pub seconds: f64,
}
