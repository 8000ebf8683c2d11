//! The words that one argument of an ensemble draws.

use std::ops::ControlFlow;

use super::distributions::rotation;
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
/// use polhode::random::{Stream, distributions};
///
/// let stream = Stream::new(7, 0); // a seed, and the number of an argument
/// let mut numbers = [0.0; 4];
/// stream.fill(100, 1, &mut numbers, &mut |_| ControlFlow::Continue(()), distributions::normal).unwrap();
/// assert_eq!(numbers[3], distributions::normal(stream.words(103, 0)[0])); // a member has its numbers wherever one begins
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

// Philox4x64-10: a counter enciphered so that its bits pass for random.
//
// Source: J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw, Parallel random numbers: as easy as 1, 2, 3, SC '11.

const ROUNDS: usize = 10;

const MULTIPLIERS: [u64; 2] = [0xD2E7_470E_E14C_6C93, 0xCA5A_8263_9512_1157];

/// What the key grows by from round to round: the golden ratio, and √3 − 1.
const STEPS: [u64; 2] = [0x9E37_79B9_7F4A_7C15, 0xBB67_AE85_84CA_A73B];

/// The four words that belong to a counter under a key.
///
/// # Examples
///
/// ```
/// use polhode::random::philox;
///
/// assert_eq!(philox([0; 4], [0; 2])[0], 0x1655_4d9e_ca36_314c); // as Random123 publishes
/// ```
#[must_use]
#[inline]
pub fn philox(counter: [u64; 4], key: [u64; 2]) -> [u64; 4] {
    let ([mut a, mut b, mut c, mut d], [mut k, mut l]) = (counter, key);
    for _ in 0..ROUNDS {
        let ((high_a, low_a), (high_c, low_c)) =
            (product(MULTIPLIERS[0], a), product(MULTIPLIERS[1], c));
        [a, b, c, d] = [high_c ^ b ^ k, low_c, high_a ^ d ^ l, low_a];
        k = k.wrapping_add(STEPS[0]);
        l = l.wrapping_add(STEPS[1]);
    }
    [a, b, c, d]
}

/// The upper and the lower word of a product.
#[inline]
fn product(x: u64, y: u64) -> (u64, u64) {
    let both = u128::from(x) * u128::from(y);
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the lower word is what is left"
    )]
    let words = ((both >> 64) as u64, both as u64);
    words
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

    /// Counter, key and words: the known answers that are published with Random123 (file `kat_vectors`).
    const KNOWN: [([u64; 4], [u64; 2], [u64; 4]); 3] = [
        (
            [0; 4],
            [0; 2],
            [
                0x1655_4d9e_ca36_314c,
                0xdb20_fe9d_672d_0fdc,
                0xd7e7_72ce_e186_176b,
                0x7e68_b68a_ec7b_a23b,
            ],
        ),
        (
            [u64::MAX; 4],
            [u64::MAX; 2],
            [
                0x87b0_92c3_013f_e90b,
                0x438c_3c67_be8d_0224,
                0x9cc7_d7c6_9cd7_77b6,
                0xa09c_aebf_594f_0ba0,
            ],
        ),
        (
            [
                0x243f_6a88_85a3_08d3,
                0x1319_8a2e_0370_7344,
                0xa409_3822_299f_31d0,
                0x082e_fa98_ec4e_6c89,
            ],
            [0x4528_21e6_38d0_1377, 0xbe54_66cf_34e9_0c6c],
            [
                0xa528_f454_03e6_1d95,
                0x38c7_2dbd_566e_9788,
                0xa5a1_610e_72fd_18b5,
                0x57bd_43b5_e52b_7fe6,
            ],
        ),
    ];

    #[test]
    fn words_are_those_that_are_published() {
        for (counter, key, words) in KNOWN {
            assert_eq!(philox(counter, key), words);
        }
    }
}
