//! Threads that take turns at the blocks of one job.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use super::halt::Watch;
use super::settings::{thread_count, watch_interval};

/// Work shorter than this is not worth the start of a thread.
const ALONE: Duration = Duration::from_millis(1);

/// What came of a turn: the next block, done.
pub(super) enum Turn {
    /// It had so many elements.
    Done(usize),
    /// No block is left, or it failed: no further one is to be begun.
    Over,
}

/// Takes turns until `count` blocks are done, with others once it is worth while. No word of this depends on what the
/// blocks hold, so that it is compiled once.
pub(super) fn take_turns(
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
        let mut running = locked(&self.running);
        while *running > 0 {
            let (woken, timeout) = self
                .someone_left
                .wait_timeout(running, watch_interval())
                .unwrap_or_else(PoisonError::into_inner);
            running = woken;
            if timeout.timed_out() && *running > 0 && flow.is_continue() {
                drop(running);
                flow = watch();
                running = locked(&self.running);
                if flow.is_break() {
                    self.is_over.store(true, Ordering::Relaxed);
                }
            }
        }
        flow
    }
}

/// What is behind a lock. It stays valid between any two statements, so a panic elsewhere does not spoil it.
pub(crate) fn locked<T>(behind: &Mutex<T>) -> MutexGuard<'_, T> {
    behind.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Signs a thread off when it ends, also by a panic.
struct Leaving<'a>(&'a Crew);

impl Drop for Leaving<'_> {
    fn drop(&mut self) {
        *locked(&self.0.running) -= 1;
        self.0.someone_left.notify_one();
    }
}

/// How much of a job is done, as `watch` gets it.
pub(super) fn fraction(done: usize, total: usize) -> f64 {
    done as f64 / total as f64
}
