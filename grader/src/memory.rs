//! How much memory grading may use, and who has how much of it at the moment.
//!
//! A system that has none left ends whatever process it likes, and that may be the grader. So
//! compilers and machines take their memory from here before they start, and wait for it.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Condvar, Mutex, PoisonError};

/// Megabytes that the grader itself needs.
const GRADER: u64 = 300;
/// Megabytes with which no compiler gets far.
const LEAST: u64 = 550;
/// Megabytes that help no answer any more.
const MOST: u64 = 1_500;
/// Megabytes where no system says what there is.
const UNKNOWN: u64 = 4_000;

/// The memory of a batch, in megabytes.
#[derive(Debug)]
pub struct Memory {
    all: u64,
    free: Mutex<u64>,
    freed: Condvar,
}

/// A part of the memory, until it is dropped.
#[derive(Debug)]
pub struct Part<'a> {
    memory: &'a Memory,
    megabytes: u64,
}

impl Memory {
    /// What was asked for, or what the container and the machine have.
    ///
    /// # Errors
    ///
    /// A sentence when that is too little for a compiler.
    pub fn of(asked: Option<u64>) -> Result<Self, String> {
        let all = asked.or_else(allowed).unwrap_or(UNKNOWN);
        let Some(rest) = all.checked_sub(GRADER).filter(|rest| *rest >= LEAST) else {
            return Err(format!(
                "there are {all} MB of memory, and the grader with one compiler needs {}; give the container more, \
                 or say with --memory how many megabytes there are",
                GRADER + LEAST
            ));
        };
        Ok(Self { all: rest, free: Mutex::new(rest), freed: Condvar::new() })
    }

    /// What one compiler may have: as much as there is, as long as it helps, and where there is
    /// enough, not so much that nothing else can go on.
    pub fn of_compiler(&self) -> u64 {
        (self.all * 2 / 3).clamp(LEAST, MOST)
    }

    /// Waits until there are as many megabytes, and takes them. Who wants more than there are in
    /// all gets all.
    pub fn take(&self, megabytes: u64) -> Part<'_> {
        let megabytes = megabytes.min(self.all);
        let free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        let enough = self.freed.wait_while(free, |free| *free < megabytes);
        *enough.unwrap_or_else(PoisonError::into_inner) -= megabytes;
        Part { memory: self, megabytes }
    }
}

impl Drop for Part<'_> {
    fn drop(&mut self) {
        *self.memory.free.lock().unwrap_or_else(PoisonError::into_inner) += self.megabytes;
        self.memory.freed.notify_all();
    }
}

/// Megabytes that the machine has free and the container allows, where the system says so.
fn allowed() -> Option<u64> {
    let groups = fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    let limits = limits(&groups).into_iter().filter_map(|path| fs::read_to_string(path).ok());
    let bytes = limits.filter_map(|limit| limit.trim().parse::<u64>().ok());
    let machine = fs::read_to_string("/proc/meminfo").ok();
    let machine = machine.as_deref().and_then(available);
    bytes.map(|bytes| bytes / 1_000_000).chain(machine).min()
}

/// The files that may hold a limit of this process: those of its groups and of all above them, in
/// both versions of control groups.
fn limits(groups: &str) -> Vec<PathBuf> {
    const ROOT: &str = "/sys/fs/cgroup";
    let mut files = Vec::new();
    for line in groups.lines() {
        let mut parts = line.splitn(3, ':').skip(1);
        let (Some(kinds), Some(group)) = (parts.next(), parts.next()) else { continue };
        let (root, name) = match kinds {
            "" => (PathBuf::from(ROOT), "memory.max"),
            _ if kinds.split(',').any(|kind| kind == "memory") => {
                (Path::new(ROOT).join("memory"), "memory.limit_in_bytes")
            }
            _ => continue,
        };
        let group = Path::new(group.trim_start_matches('/'));
        files.extend(group.ancestors().map(|group| root.join(group).join(name)));
    }
    files
}

/// Megabytes that the machine has without taking them from others.
fn available(meminfo: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kilobytes: u64 = line.trim().trim_end_matches("kB").trim().parse().ok()?;
    Some(kilobytes / 1_000)
}
