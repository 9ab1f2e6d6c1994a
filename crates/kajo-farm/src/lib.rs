//! A render by many workers, on one machine or on many, to the bits of one.
//!
//! A [`Plan`] says what is rendered and how it is cut into *units*: a tile and a range of samples. A unit's result is a
//! [`Part`], the exact sums of its samples. Parts are published in the folder of a [`Job`]: the first copy wins, and a
//! second one must be equal. So a coordinator may lose, repeat or double any unit, and may itself be
//! killed: what is finished is in that folder and nowhere else.
//!
//! | in the folder | what |
//! |---|---|
//! | `plan.json` | the [`Plan`]; never changes |
//! | `parts/` | results of units |
//! | `sums/` | for each tile the sum of results that were put together, so that space is bounded by the picture |
//! | `stages/` | where each stage but the first begins, see [`kajo::SplitRender`] |
//! | `damaged/` | what was found damaged and is rendered again |
//! | `logs/` | what was said about each try of a unit that failed |
//!
//! [`coordinate`] hands units to workers, which are processes of this machine or anything else behind the trait
//! [`Worker`]; an [`Engine`] is another program that has machines, and is handed units as they have room for them.
//! [`protocol`] is how worker processes and engines are talked to.

mod bundle;
mod coordinator;
mod engine;
mod error;
mod files;
mod hosts;
mod job;
mod layout;
mod part;
mod plan;
mod process;
pub mod protocol;
mod sums;

pub use bundle::{Bundle, Recording};
pub use coordinator::{Loss, Reply, Start, Task, Watch, Worker, coordinate};
pub use engine::{Engine, LossKind, News, Order};
pub use error::{FailedUnit, FarmError};
pub use hosts::HostShare;
pub use job::{Job, Merged, Published};
pub use layout::Layout;
pub use part::{Part, PartError};
pub use plan::{Plan, PlannedFile, plan_hash};
pub use process::ProcessWorkers;

/// The name of this machine and the number of this process, for messages.
pub fn host() -> String {
    let name = std::fs::read_to_string("/proc/sys/kernel/hostname").ok();
    let name = name.or_else(|| std::env::var("HOSTNAME").ok()).or_else(|| std::env::var("COMPUTERNAME").ok());
    let name = name.map(|name| name.trim().chars().take(200).collect::<String>());
    format!("{} (process {})", name.as_deref().unwrap_or("this machine"), std::process::id())
}
