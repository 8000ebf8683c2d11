//! A job in blocks: each element is filled once, whoever does it.

use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};

use super::crew::{Turn, fraction, locked, take_turns};
use super::halt::{Halt, Watch};

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
        let Some((index, slice)) = locked(&blocks).next() else {
            return Turn::Over;
        };
        match work(index * block, slice) {
            Ok(()) => Turn::Done(slice.len()),
            Err(error) => {
                let mut first = locked(&failure);
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
    use std::num::NonZeroUsize;
    use std::thread;
    use std::time::{Duration, Instant};

    use super::super::set_thread_limit;
    use super::{ControlFlow, Halt, each_watched, fill_blocks};

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
