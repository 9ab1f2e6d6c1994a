//! How much memory there is.

use std::fs;

/// Assumed where the system does not tell, in bytes.
const FALLBACK: u64 = 8 << 30;

/// Bytes that can be had without disturbing other programs or exceeding the process's own limit.
///
/// Asked of the system on Linux; 8 GiB elsewhere.
pub fn available() -> u64 {
    let read = |path| fs::read_to_string(path).unwrap_or_default();
    let free = available_in(&read("/proc/meminfo")).unwrap_or(FALLBACK);
    let limit = address_space_in(&read("/proc/self/limits")).unwrap_or(u64::MAX);
    let used = pages_in(&read("/proc/self/statm")).unwrap_or(0).saturating_mul(4096);
    free.min(limit.saturating_sub(used))
}

/// The bound on a process's address space in bytes, if there is one.
fn address_space_in(limits: &str) -> Option<u64> {
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    line.split_whitespace().next()?.parse().ok()
}

/// Pages of address space in use.
fn pages_in(statm: &str) -> Option<u64> {
    statm.split_whitespace().next()?.parse().ok()
}

fn available_in(meminfo: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kibibytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_of_the_kernel_is_read() {
        let text = "MemTotal:       32768 kB\nMemFree:  1 kB\nMemAvailable:    2048 kB\n";
        assert_eq!(available_in(text), Some(2048 * 1024));
        assert_eq!(available_in("MemTotal: 1 kB\n"), None);
        assert_eq!(available_in("MemAvailable: many kB\n"), None);
        assert!(available() > 1 << 20);
        let limits =
            "Max processes  1  1  processes\nMax address space         307200000  unlimited  bytes\n";
        assert_eq!(address_space_in(limits), Some(307_200_000));
        assert_eq!(address_space_in("Max address space  unlimited  unlimited  bytes"), None);
        assert_eq!(pages_in("1234 56 7"), Some(1234));
    }
}
