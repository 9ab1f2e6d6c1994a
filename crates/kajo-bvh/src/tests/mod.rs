//! Both trees against plain loops over everything, and against geometry.

mod boxes;
mod brute;
mod hostile;
pub(crate) mod meshes;
mod moving;
mod refit;
mod steps;
mod threads;
mod watertight;
