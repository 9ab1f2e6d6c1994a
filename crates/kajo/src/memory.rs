//! How much memory there is.

use std::fs;
use std::path::Path;
use std::thread;

/// Assumed where the system does not tell, in bytes.
const FALLBACK: u64 = 8 << 30;

/// Bytes that can be had without disturbing other programs or exceeding the limits of the process: that on its address
/// space, and those of the control groups that it is in, as containers and batch systems set them.
///
/// Asked of the system on Linux; 8 GiB elsewhere.
pub fn available() -> u64 {
    let free = available_in(&read("/proc/meminfo")).unwrap_or(FALLBACK);
    let of_groups = left_in_groups(&read("/proc/self/cgroup"), Path::new("/sys/fs/cgroup"));
    free.min(address_space_left().unwrap_or(u64::MAX)).min(of_groups)
}

/// How many threads to use of those that are asked for: fewer where they would take the address space that `needed` bytes are
/// to lie in, and at least one.
///
/// * `asked`: 0 for one on each core; returned as it is where there is no bound
pub fn threads_beside(needed: u64, asked: usize) -> usize {
    match address_space_left() {
        Some(left) => threads_within(left.saturating_sub(needed), asked),
        None => asked,
    }
}

fn threads_within(left: u64, asked: usize) -> usize {
    /// A stack, and the 64 MiB that glibc reserves for what a thread allocates.
    const EACH: u64 = 72 << 20;
    let wanted = if asked == 0 { thread::available_parallelism().map_or(1, usize::from) } else { asked };
    usize::try_from(left / EACH).unwrap_or(usize::MAX).clamp(1, wanted)
}

/// Bytes of address space that the process may still take; `None` where there is no bound.
fn address_space_left() -> Option<u64> {
    let limit = address_space_in(&read("/proc/self/limits"))?;
    let used = pages_in(&read("/proc/self/statm")).unwrap_or(0).saturating_mul(4096);
    Some(limit.saturating_sub(used))
}

/// The text of a file of the system; empty where there is none.
fn read(path: impl AsRef<Path>) -> String {
    fs::read_to_string(path).unwrap_or_default()
}

/// Where a version of control groups keeps what, [Linux, `cgroup-v2.rst` and `cgroup-v1/memory.rst`].
struct GroupFiles {
    limit: &'static str,
    usage: &'static str,
    /// Lines of `memory.stat` about copies of files, which the system drops when memory is wanted.
    caches: [&'static str; 2],
}

const VERSION_1: GroupFiles = GroupFiles {
    limit: "memory.limit_in_bytes",
    usage: "memory.usage_in_bytes",
    caches: ["total_active_file ", "total_inactive_file "],
};

const VERSION_2: GroupFiles =
    GroupFiles { limit: "memory.max", usage: "memory.current", caches: ["active_file ", "inactive_file "] };

/// What the control groups of a process leave it, in bytes; `u64::MAX` without a limit.
///
/// * `groups`: `/proc/self/cgroup`, a line `number:controllers:path` for each hierarchy
/// * `root`: where the hierarchies are mounted
fn left_in_groups(groups: &str, root: &Path) -> u64 {
    let of_line = |line: &str| {
        let mut parts = line.splitn(3, ':').skip(1);
        let (controllers, path) = (parts.next()?, parts.next()?.trim_start_matches('/'));
        let (folder, files) = match controllers {
            "" => (root.to_path_buf(), &VERSION_2),
            names if names.split(',').any(|name| name == "memory") => (root.join("memory"), &VERSION_1),
            _ => return None,
        };
        // A group has no more than those around it. In a container the path may be that of the outer system; then
        // the root is the container's own group.
        Path::new(path).ancestors().filter_map(|path| files.left(&folder.join(path))).min()
    };
    groups.lines().filter_map(of_line).min().unwrap_or(u64::MAX)
}

impl GroupFiles {
    /// What one group leaves; `None` where it has no limit.
    fn left(&self, folder: &Path) -> Option<u64> {
        let number = |text: &str| text.trim().parse::<u64>().ok();
        let limit = number(&read(folder.join(self.limit)))?;
        let usage = number(&read(folder.join(self.usage)))?;
        let stat = read(folder.join("memory.stat"));
        let cached =
            |name| stat.lines().find_map(|line| line.strip_prefix(name)).and_then(number).unwrap_or(0);
        let cached: u64 = self.caches.map(cached).iter().sum();
        Some(limit.saturating_sub(usage.saturating_sub(cached)))
    }
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

    #[test]
    fn threads_leave_room_for_the_rest() {
        assert_eq!(threads_within(1 << 30, 4), 4);
        assert_eq!(threads_within(200 << 20, 4), 2);
        assert_eq!(threads_within(0, 4), 1, "the render must go on");
        assert_eq!(threads_within(0, 0), 1);
        assert!(threads_within(u64::MAX, 0) >= 1);
    }

    #[test]
    fn control_groups_leave_what_they_have() {
        let root = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = root.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        };
        let left = |groups: &str| left_in_groups(groups, root.path());
        assert_eq!(left("0::/a/b\n"), u64::MAX, "there are no files");
        write("a/b/memory.max", "max\n");
        write("a/b/memory.current", "70\n");
        assert_eq!(left("0::/a/b\n"), u64::MAX);
        write("a/memory.max", "1000\n");
        write("a/memory.current", "900\n");
        assert_eq!(left("0::/a/b\n"), 100, "of the group around");
        write("a/memory.stat", "anon 300\nactive_file 500\ninactive_file 50\n");
        assert_eq!(left("0::/a/b\n"), 650, "copies of files can go");
        write("a/b/memory.max", "600\n");
        assert_eq!(left("0::/a/b\n"), 530);
        write("a/b/memory.current", "601\n");
        assert_eq!(left("0::/a/b\n"), 0);

        write("memory/memory.limit_in_bytes", "4000\n");
        write("memory/memory.usage_in_bytes", "1000\n");
        let outer = "5:cpu,cpuacct:/docker/12\n4:memory:/docker/12\n1:name=systemd:/docker/12\n";
        assert_eq!(left(outer), 3000);
    }
}
