//! What a process sets for all its jobs: how many threads, and how often they are watched.

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

/// The number of threads a job may use; 0 stands for as many as the machine offers.
static LIMIT: AtomicUsize = AtomicUsize::new(0);

/// Limits every later job of this process to `count` threads; `None` lifts the limit.
pub fn set_thread_limit(count: Option<NonZeroUsize>) {
    LIMIT.store(count.map_or(0, NonZeroUsize::get), Ordering::Relaxed);
}

/// The number of threads a large job uses.
#[must_use]
pub fn thread_count() -> usize {
    match LIMIT.load(Ordering::Relaxed) {
        0 => thread::available_parallelism().map_or(1, NonZeroUsize::get),
        limit => limit,
    }
}

/// How often the calling thread looks up from its work, in nanoseconds: every 20 ms.
static INTERVAL: AtomicU64 = AtomicU64::new(20_000_000);

/// Every later job of this process asks its `watch` this often; before the first call of this, every 20 ms.
///
/// With an interval of zero a job on one thread asks before each block, so that a test of what happens then does not
/// depend on how fast the machine is.
pub fn set_watch_interval(interval: Duration) {
    let nanoseconds = u64::try_from(interval.as_nanos()).unwrap_or(u64::MAX);
    INTERVAL.store(nanoseconds, Ordering::Relaxed);
}

/// How often every job of this process asks its `watch`.
pub(super) fn watch_interval() -> Duration {
    Duration::from_nanos(INTERVAL.load(Ordering::Relaxed))
}
