//! Threads for large stacks: scoped, so that nothing outlives the call, and without a global pool, which
//! would not survive `fork`.
//!
//! The work is cut into blocks that never depend on the number of threads, so neither do the bits of the
//! results. The calling thread starts on the blocks by itself; only a job that is not over after a
//! millisecond is shared with others, and from then on the calling thread serves `watch`: progress and Ctrl-C.

use std::convert::Infallible;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use std::{fmt, thread};

use crate::error::Error;

// How a job is watched, and why it ends early.

/// Asked now and then, with the fraction done, whether to go on.
pub type Watch<'a> = dyn FnMut(f64) -> ControlFlow<()> + 'a;

/// Why a job ended early.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Halt<E> {
    /// `watch` asked for it.
    Stopped,
    /// A block failed; of all failing blocks, the one that comes first.
    Failed(E),
}

impl<E: fmt::Display> fmt::Display for Halt<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stopped => Error::Stopped.fmt(f),
            Self::Failed(error) => error.fmt(f),
        }
    }
}

impl<E: std::error::Error + 'static> std::error::Error for Halt<E> {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Stopped => None,
            Self::Failed(error) => Some(error),
        }
    }
}

impl From<Halt<Infallible>> for Error {
    fn from(halt: Halt<Infallible>) -> Self {
        match halt {
            Halt::Stopped => Self::Stopped,
            Halt::Failed(never) => match never {},
        }
    }
}

impl From<Error> for Halt<Error> {
    fn from(error: Error) -> Self {
        match error {
            Error::Stopped => Self::Stopped,
            error => Self::Failed(error),
        }
    }
}

impl From<Halt<Self>> for Error {
    fn from(halt: Halt<Self>) -> Self {
        match halt {
            Halt::Stopped => Self::Stopped,
            Halt::Failed(error) => error,
        }
    }
}

// What a process sets for all its jobs: how many threads, and how often they are watched.

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
fn watch_interval() -> Duration {
    Duration::from_nanos(INTERVAL.load(Ordering::Relaxed))
}

// Threads that take turns at the blocks of one job.

/// Work shorter than this is not worth the start of a thread.
const ALONE: Duration = Duration::from_millis(1);

/// What came of a turn: the next block, done.
enum Turn {
    /// It had so many elements.
    Done(usize),
    /// No block is left, or it failed: no further one is to be begun.
    Over,
}

/// Takes turns until `count` blocks are done, with others once it is worth while. No word of this depends on what the
/// blocks hold, so that it is compiled once.
fn take_turns(
    turn: &(dyn Fn() -> Turn + Sync),
    count: usize,
    total: usize,
    watch: &mut Watch<'_>,
) -> ControlFlow<()> {
    let mut done = 0;
    let mut left = count;
    let (start, interval) = (Instant::now(), watch_interval());
    let mut looked_up = start;
    let mut may_share = true;
    loop {
        let now = Instant::now();
        if may_share && left > 1 && now - start >= ALONE {
            // Asked only now, since to ask takes longer than a small job.
            if thread_count() > 1 {
                break;
            }
            may_share = false;
        }
        if now - looked_up >= interval {
            looked_up = now;
            watch(fraction(done, total))?;
        }
        let Turn::Done(elements) = turn() else {
            return ControlFlow::Continue(());
        };
        done += elements;
        left -= 1;
    }

    let helpers = thread_count().min(left);
    let crew = Crew::of(helpers);
    let finished = AtomicUsize::new(done);
    thread::scope(|scope| {
        for _ in 0..helpers {
            scope.spawn(|| {
                let _leaving = Leaving(&crew);
                while !crew.is_over.load(Ordering::Relaxed) {
                    match turn() {
                        Turn::Done(elements) => finished.fetch_add(elements, Ordering::Relaxed),
                        Turn::Over => return crew.is_over.store(true, Ordering::Relaxed),
                    };
                }
            });
        }
        crew.serve(|| watch(fraction(finished.load(Ordering::Relaxed), total)))
    })
}

/// What threads that take turns have to tell each other.
struct Crew {
    /// Whether no further block is to be begun.
    is_over: AtomicBool,
    running: Mutex<usize>,
    someone_left: Condvar,
}

impl Crew {
    fn of(running: usize) -> Self {
        Self {
            is_over: AtomicBool::new(false),
            running: Mutex::new(running),
            someone_left: Condvar::new(),
        }
    }

    /// Calls `watch` at every interval until all threads have left.
    fn serve(&self, mut watch: impl FnMut() -> ControlFlow<()>) -> ControlFlow<()> {
        let mut flow = ControlFlow::Continue(());
        let mut running = lock(&self.running);
        while *running > 0 {
            let (woken, timeout) = self
                .someone_left
                .wait_timeout(running, watch_interval())
                .unwrap_or_else(PoisonError::into_inner);
            running = woken;
            if timeout.timed_out() && *running > 0 && flow.is_continue() {
                drop(running);
                flow = watch();
                running = lock(&self.running);
                if flow.is_break() {
                    self.is_over.store(true, Ordering::Relaxed);
                }
            }
        }
        flow
    }
}

/// What is behind a lock. It stays valid between any two statements, so a panic elsewhere does not spoil it.
pub(crate) fn lock<T>(behind: &Mutex<T>) -> MutexGuard<'_, T> {
    behind.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Signs a thread off when it ends, also by a panic.
struct Leaving<'a>(&'a Crew);

impl Drop for Leaving<'_> {
    fn drop(&mut self) {
        *lock(&self.0.running) -= 1;
        self.0.someone_left.notify_one();
    }
}

/// How much of a job is done, as `watch` gets it.
fn fraction(done: usize, total: usize) -> f64 {
    done as f64 / total as f64
}

// A job in blocks: each element is filled once, whoever does it.

/// Fills `out` block by block: `work` gets the index of a block's first element and the block.
///
/// Blocks are `block` elements long, the last one perhaps shorter. About every 20 ms `watch` gets the
/// fraction done; [`ControlFlow::Break`] stops the job as soon as the blocks under way are finished.
/// A job that is over within 20 ms never calls it.
///
/// # Errors
/// [`Halt::Stopped`] if `watch` said so, else [`Halt::Failed`] with the error of the first block that failed.
/// The contents of `out` are then unspecified.
///
/// # Panics
/// If `block` is zero, or if `work` panics.
pub fn fill_blocks<T: Send, E: Send>(
    out: &mut [T],
    block: usize,
    watch: &mut Watch<'_>,
    work: impl Fn(usize, &mut [T]) -> Result<(), E> + Sync,
) -> Result<(), Halt<E>> {
    in_blocks(out, block, watch, &work)
}

/// What is done with a block, from the index of its first element.
type Work<'a, T, E> = dyn Fn(usize, &mut [T]) -> Result<(), E> + Sync + 'a;

/// Compiled once for all work on the same elements.
fn in_blocks<T: Send, E: Send>(
    out: &mut [T],
    block: usize,
    watch: &mut Watch<'_>,
    work: &Work<'_, T, E>,
) -> Result<(), Halt<E>> {
    let total = out.len();
    let blocks = out.chunks_mut(block).enumerate();
    let count = blocks.len();
    let blocks = Mutex::new(blocks);
    // The failing block with the lowest index so far. Blocks are started in order, so when one fails all lower ones have
    // been started too, and each of them has its say before the job returns.
    let failure = Mutex::new(None);
    let turn = || {
        let Some((index, slice)) = lock(&blocks).next() else {
            return Turn::Over;
        };
        match work(index * block, slice) {
            Ok(()) => Turn::Done(slice.len()),
            Err(error) => {
                let mut first = lock(&failure);
                if (first.as_ref()).is_none_or(|&(lowest, _)| index < lowest) {
                    *first = Some((index, error));
                }
                Turn::Over
            }
        }
    };
    let flow = take_turns(&turn, count, total, watch);
    let failure = failure.into_inner().unwrap_or_else(PoisonError::into_inner);
    match (flow, failure) {
        (ControlFlow::Break(()), _) => Err(Halt::Stopped),
        (_, Some((_, error))) => Err(Halt::Failed(error)),
        (_, None) => Ok(()),
    }
}

/// Does `work` on each item, in order and on this thread. Every few thousand items `watch` gets the fraction done and may end
/// it.
///
/// # Errors
/// [`Halt::Stopped`] if `watch` said so, else [`Halt::Failed`] with the error of the first item that failed.
#[inline]
pub(crate) fn each_watched<T, E>(
    items: impl ExactSizeIterator<Item = T>,
    watch: &mut Watch<'_>,
    mut work: impl FnMut(T) -> Result<(), E>,
) -> Result<(), Halt<E>> {
    /// Items between two looks.
    const STRETCH: usize = 4096;
    let total = items.len();
    for (index, item) in items.enumerate() {
        if index % STRETCH == STRETCH - 1 && watch(fraction(index, total)).is_break() {
            return Err(Halt::Stopped);
        }
        work(item).map_err(Halt::Failed)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::num::NonZeroUsize;
    use std::thread;
    use std::time::{Duration, Instant};

    fn go_on(_: f64) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    #[expect(clippy::unnecessary_wraps, reason = "the signature of work")]
    fn slow(start: usize, slice: &mut [usize]) -> Result<(), usize> {
        thread::sleep(Duration::from_micros(500));
        for (i, x) in slice.iter_mut().enumerate() {
            *x = start + i;
        }
        Ok(())
    }

    #[test]
    fn every_element_is_filled_once_by_any_number_of_threads() {
        for count in [1, 2, 5] {
            set_thread_limit(NonZeroUsize::new(count));
            for length in [0, 1, 7, 64, 1001] {
                let mut out = vec![usize::MAX; length];
                assert_eq!(fill_blocks(&mut out, 8, &mut go_on, slow), Ok(()));
                assert!(out.iter().enumerate().all(|(i, &x)| i == x));
            }
        }
        set_thread_limit(None);
    }

    #[test]
    fn the_first_failing_block_wins() {
        let mut out = [0usize; 400];
        let outcome = fill_blocks(&mut out, 4, &mut go_on, |start, slice| {
            slow(start, slice)?;
            // Later failures are quicker to report.
            thread::sleep(Duration::from_micros(if start == 40 { 3000 } else { 0 }));
            if start >= 40 { Err(start) } else { Ok(()) }
        });
        assert_eq!(outcome, Err(Halt::Failed(40)));
    }

    #[test]
    fn watch_sees_progress_and_stops_the_job_soon() {
        let mut out = vec![0usize; 1_000_000];
        let mut seen = Vec::new();
        let start = Instant::now();
        let outcome = fill_blocks(
            &mut out,
            1,
            &mut |done| {
                seen.push(done);
                if seen.len() == 3 {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            },
            slow,
        );
        assert_eq!(outcome, Err(Halt::Stopped));
        assert!(seen.is_sorted() && seen[0] > 0.0 && seen[2] < 1.0);
        assert!(start.elapsed() < Duration::from_secs(2));
    }

    #[test]
    fn a_pass_is_watched_and_ends_at_the_first_that_fails() {
        let mut sum = 0;
        let mut looks = 0;
        let all = each_watched(
            0..10_000_usize,
            &mut |_| {
                looks += 1;
                go_on(0.0)
            },
            |k| {
                sum += k;
                Ok::<(), usize>(())
            },
        );
        assert_eq!((all, sum, looks), (Ok(()), 49_995_000, 2));
        let failed = each_watched(0..10, &mut go_on, |k| if k < 3 { Ok(()) } else { Err(k) });
        assert_eq!(failed, Err(Halt::Failed(3)));
        let stop = &mut |_| ControlFlow::Break(());
        let mut done = 0;
        let stopped = each_watched(0..10_000, stop, |_| {
            done += 1;
            Ok::<(), usize>(())
        });
        assert_eq!((stopped, done), (Err(Halt::Stopped), 4095));
    }
}
