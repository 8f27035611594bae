//! What one submission may take in all, whatever is in it: the processor's time, of the compiler
//! and of the machine.
//!
//! Each of its answers has a share that no other one can take, and all draw on what is left over, so
//! that an answer without an end costs itself and not the others.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Time of the compiler for all answers at once. The reference answers take two seconds.
const TOGETHER: Duration = Duration::from_secs(9);
/// Time for all that are compiled alone, because they do not compile together. Beside other work a
/// reference answer takes twice as long as on a quiet machine.
const ALONE: Duration = Duration::from_secs(36);
/// The most of it that one answer gets. The longest reference answer takes one second.
const LONGEST: Duration = Duration::from_secs(6);
/// Time of the machine that every answer has for itself, in all its checks.
const SHARE: Duration = Duration::from_millis(1_000);
/// Time of the machine that all answers of a submission have besides.
const POOL: Duration = Duration::from_secs(5);

/// Time for the compiler.
#[derive(Debug)]
pub struct Compiling {
    left: Duration,
}

impl Compiling {
    /// That of a submission.
    pub fn new() -> Self {
        Self { left: ALONE }
    }

    /// What all answers get together.
    pub fn together(&self) -> Duration {
        TOGETHER
    }

    /// What the next of the answers gets when as many are still to be compiled: the same as each
    /// after it, at least.
    pub fn alone(&self, to_come: usize) -> Duration {
        (self.left / to_come.max(1) as u32).min(LONGEST)
    }

    /// Takes what it took.
    pub fn took(&mut self, time: Duration) {
        self.left = self.left.saturating_sub(time);
    }
}

impl Default for Compiling {
    fn default() -> Self {
        Self::new()
    }
}

/// Time for the machine, of one submission.
#[derive(Debug, Clone)]
pub struct Running(Arc<AtomicU64>);

impl Running {
    /// That of a submission.
    pub fn new() -> Self {
        Self(Arc::new(AtomicU64::new(nanoseconds(POOL))))
    }

    /// What one of its answers has.
    pub fn of_answer(&self) -> Purse {
        let own = Arc::new(AtomicU64::new(nanoseconds(SHARE)));
        Purse { own, pool: Arc::clone(&self.0) }
    }
}

impl Default for Running {
    fn default() -> Self {
        Self::new()
    }
}

/// The time of one answer, in all its checks: first its own, then that of all.
#[derive(Debug, Clone)]
pub struct Purse {
    own: Arc<AtomicU64>,
    pool: Arc<AtomicU64>,
}

impl Purse {
    /// Takes time away, and says whether there was as much.
    pub fn pay(&self, time: Duration) -> bool {
        let rest = taken(&self.own, nanoseconds(time));
        taken(&self.pool, rest) == 0
    }

    /// Whether nothing is left.
    pub fn is_empty(&self) -> bool {
        [&self.own, &self.pool].iter().all(|left| left.load(Ordering::Relaxed) == 0)
    }
}

/// Takes as much as there is, and gives what is still to be paid.
fn taken(left: &AtomicU64, wanted: u64) -> u64 {
    let less = |left: u64| Some(left.saturating_sub(wanted));
    let before = left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, less);
    wanted.saturating_sub(before.unwrap_or_default())
}

fn nanoseconds(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}

/// Processor time that this thread has taken. Where the system does not tell, the clock does.
pub fn processor_time() -> Duration {
    #[cfg(unix)]
    {
        let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
        Duration::new(time.tv_sec.unsigned_abs(), time.tv_nsec as u32)
    }
    #[cfg(not(unix))]
    {
        static BEGUN: std::sync::LazyLock<std::time::Instant> =
            std::sync::LazyLock::new(std::time::Instant::now);
        BEGUN.elapsed()
    }
}
