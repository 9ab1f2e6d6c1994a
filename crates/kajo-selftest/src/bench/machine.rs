//! What a figure was taken on.

use std::fs;
use std::thread;

/// The machine at hand, as far as it tells.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Machine {
    /// The processor's own name.
    pub processor: String,
    /// Cores that this program may use.
    pub cores: usize,
    /// The widest instructions that the ray tracer uses here.
    pub simd: &'static str,
}

impl Machine {
    /// Asks the machine.
    pub fn here() -> Machine {
        let cpuinfo = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        Machine {
            processor: model(&cpuinfo).unwrap_or_else(|| std::env::consts::ARCH.to_owned()),
            cores: thread::available_parallelism().map_or(1, |n| n.get()),
            simd: kajo_bvh::instructions(),
        }
    }
}

fn model(cpuinfo: &str) -> Option<String> {
    let line = cpuinfo.lines().find(|line| line.starts_with("model name"))?;
    let name = line.split_once(':')?.1.trim();
    (!name.is_empty()).then(|| name.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_of_the_processor_is_read() {
        assert_eq!(model("processor\t: 0\nmodel name\t: Fast 3000\n").as_deref(), Some("Fast 3000"));
        assert_eq!(model("processor\t: 0\nmodel name\t:\n"), None);
        assert!(Machine::here().cores >= 1);
    }
}
