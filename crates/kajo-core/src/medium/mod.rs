//! What fills the space between surfaces.

mod fog;

pub use fog::Fog;
