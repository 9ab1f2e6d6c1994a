//! Statistics and comparisons for the tests of kajo.
//!
//! Seeds are fixed, so each of these tests passes or fails and never flickers; what they guard against is a
//! change that makes a result wrong, and a number that is right by chance only.

pub mod animated_model;
pub mod anova;
pub mod cases;
pub mod chi_square;
pub mod corpus;
pub mod delta_e;
pub mod image;
pub mod mean;
pub mod nano_vdb;
mod special;
pub mod spectrum;
pub mod sphere;
pub mod vdb;

pub use animated_model::write_walker;
pub use anova::p_of_equal_means;
pub use cases::{every, is_deep};
pub use chi_square::ChiSquare;
pub use corpus::corpus;
pub use delta_e::{delta_e_2000, lab};
pub use image::share_off_by;
pub use mean::Estimate;
