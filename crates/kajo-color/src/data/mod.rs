//! Published numbers, each file with its source. They are facts; nothing here is computed.

pub(crate) mod daylight;
pub(crate) mod light_sources;
pub(crate) mod metals;
pub(crate) mod observer;
pub(crate) mod primaries;
