//! The words that one argument of an ensemble draws.

use std::ops::ControlFlow;

use super::laws::rotation;
use super::philox::philox;
use crate::numerics::threads::{Halt, fill_blocks};

/// Words of a counter.
const WORDS: usize = 4;
/// Members that a thread does at a time.
const SHARE: usize = 1024;

/// All words of one argument: a member and a place within its words name each of them.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::random::{Stream, laws};
///
/// let stream = Stream::new(7, 0); // a seed, and the number of an argument
/// let mut numbers = [0.0; 4];
/// stream.fill(100, 1, &mut numbers, &mut |_| ControlFlow::Continue(()), laws::normal).unwrap();
/// assert_eq!(numbers[3], laws::normal(stream.words(103, 0)[0])); // a member has its numbers wherever one begins
/// let mut turns = [[0.0; 4]; 2];
/// stream.fill_rotations(0, &mut turns, &mut |_| ControlFlow::Continue(())).unwrap();
/// assert!((turns[1].iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stream {
    key: [u64; 2],
}

impl Stream {
    /// That of an argument, named by a number, under a seed.
    #[must_use]
    pub fn new(seed: u64, argument: u64) -> Self {
        Self {
            key: [seed, argument],
        }
    }

    /// The words of `member` from number `4 block` on. The second word of the counter is left for longer counts, the fourth for
    /// generators of others under the same key.
    #[must_use]
    #[inline]
    pub fn words(&self, member: u64, block: u64) -> [u64; WORDS] {
        philox([block, 0, member, 0], self.key)
    }

    /// Fills rows of `width` numbers, those of the members from `first` on, each by `law` from a word of its own.
    ///
    /// # Errors
    /// [`Halt::Stopped`] when `watch` said so.
    pub fn fill<T: Send>(
        &self,
        first: u64,
        width: usize,
        out: &mut [T],
        watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
        law: impl Fn(u64) -> T + Sync,
    ) -> Result<(), Halt<std::convert::Infallible>> {
        if width == 0 {
            return Ok(());
        }
        fill_blocks(out, width * SHARE, watch, |start, share| {
            let members = first + (start / width) as u64..;
            for (row, member) in share.chunks_mut(width).zip(members) {
                for (four, block) in row.chunks_mut(WORDS).zip(0..) {
                    for (place, word) in four.iter_mut().zip(self.words(member, block)) {
                        *place = law(word);
                    }
                }
            }
            Ok(())
        })
    }

    /// Fills `out` with unit quaternions of rotations drawn uniformly, one for each member from `first` on.
    ///
    /// # Errors
    /// [`Halt::Stopped`] when `watch` said so.
    pub fn fill_rotations(
        &self,
        first: u64,
        out: &mut [[f64; 4]],
        watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<(), Halt<std::convert::Infallible>> {
        fill_blocks(out, SHARE, watch, |start, share| {
            for (place, member) in share.iter_mut().zip(first + start as u64..) {
                *place = rotation(self.words(member, 0));
            }
            Ok(())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_member_has_its_words_wherever_the_stack_begins() {
        let stream = Stream::new(7, 11);
        let go_on = &mut |_| ControlFlow::Continue(());
        let mut all = vec![0_u64; 6 * 3000];
        stream
            .fill(5, 6, &mut all, go_on, |word| word)
            .expect("done");
        for (row, member) in all.chunks(6).zip(5..) {
            let words = [stream.words(member, 0), stream.words(member, 1)].concat();
            assert_eq!(row, &words[..6]);
        }
        let mut one = [0_u64; 6];
        stream
            .fill(2104, 6, &mut one, go_on, |word| word)
            .expect("done");
        assert_eq!(one, all[6 * 2099..6 * 2100]);
        assert_eq!(stream.fill(0, 0, &mut one, go_on, |word| word), Ok(()));
    }

    #[test]
    fn rotations_are_of_unit_length() {
        let mut out = vec![[0.0; 4]; 2500];
        Stream::new(1, 2)
            .fill_rotations(3, &mut out, &mut |_| ControlFlow::Continue(()))
            .expect("done");
        for q in &out {
            assert!((q.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-15);
        }
    }
}
