//! `kajo render --farm local:N`: workers that are processes of this machine.

use std::process::Command;
use std::thread;

use kajo::SplitRender;
use kajo_farm::{FarmError, Job as Folder, ProcessWorkers, Watch, coordinate};

use super::pool::WorkerPool;

/// Processes of this machine.
pub struct Local {
    workers: u16,
    /// Threads of each.
    each: usize,
}

impl Local {
    /// * `threads`: of all together; 0 for one on each core
    pub fn new(workers: u16, threads: usize) -> Local {
        let cores = match threads {
            0 => thread::available_parallelism().map_or(1, |n| n.get()),
            threads => threads,
        };
        Local { workers, each: cores.div_ceil(workers.into()).max(1) }
    }
}

impl WorkerPool for Local {
    fn stage(&self, folder: &Folder, split: &SplitRender<'_>, watch: &dyn Watch) -> Result<(), FarmError> {
        let program = std::env::current_exe().map_err(|error| FarmError::Input(error.to_string()))?;
        let threads = self.each.to_string();
        let command = |_| {
            let mut command = Command::new(&program);
            command.args(["worker", "--stdio", "--threads", &threads]);
            command
        };
        let start = ProcessWorkers { plan: folder.text().to_owned(), command };
        coordinate(folder, split, self.workers.into(), &start, watch)
    }

    fn threads(&self) -> usize {
        self.each * usize::from(self.workers)
    }
}
