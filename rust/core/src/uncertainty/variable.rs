//! Sources, and the independent standard normal variables that they draw.

use std::collections::hash_map::RandomState;
use std::hash::{BuildHasher, Hasher};
use std::sync::Mutex;

/// A draw: where a doubt comes from. What comes from one source stays one source, in pickles and files too.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Source(u128);

/// Bits of a variable that count the components of its source.
const INDEX: u32 = 32;

impl Source {
    /// A source that nothing else is.
    #[must_use]
    pub fn fresh() -> Self {
        /// The process, its random origin, and how many sources it has made.
        static MADE: Mutex<(u32, u64, u32)> = Mutex::new((0, 0, 0));
        let mut made = MADE
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        let process = std::process::id();
        // A process that was split off another would make the sources of that one once more.
        if made.0 != process || made.2 == u32::MAX {
            *made = (process, random(), 0);
        }
        made.2 += 1;
        Self(u128::from(made.1) << 64 | u128::from(made.2) << INDEX)
    }

    /// The source of this name: the same wherever it is named.
    #[must_use]
    pub fn named(name: &str) -> Self {
        // FNV-1a of 128 bits; its upper 96 are kept.
        let hash = name.bytes().fold(
            0x6c62_272e_07bb_0142_62b8_2175_6295_c58d_u128,
            |hash, byte| {
                (hash ^ u128::from(byte)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013b)
            },
        );
        Self(hash >> INDEX << INDEX)
    }

    /// Component `index` of the draw.
    #[must_use]
    pub fn variable(self, index: u32) -> Variable {
        Variable(self.0 | u128::from(index))
    }
}

/// A random number of the operating system's, by way of the seeds of the standard library's hashes.
fn random() -> u64 {
    RandomState::new().build_hasher().finish()
}

/// A standard normal variable, independent of all others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Variable(u128);

/// How many directions in the space of all variables are probed to second order.
pub const PROBES: usize = 8;
/// The steps that each variable takes along the probes, in a place and with a sign of its own: their mean square is 1 and
/// their mean fourth power 3, as of a normal variable.
const STEPS: [f64; 2] = [1.8572802003960462, 0.4283729905961323];

impl Variable {
    /// The step of the variable along each of the probes.
    #[must_use]
    pub fn steps(self) -> [f64; PROBES] {
        // Without the random part, so that the same program finds the same.
        let bits = mixed(self.0 as u64);
        let first = (bits & 7) as usize;
        let second = (first + 1 + (bits >> 3 & 0xffff) as usize % 7) % PROBES;
        std::array::from_fn(|probe| {
            let size = STEPS[usize::from(probe != first && probe != second)];
            if bits >> (32 + probe) & 1 == 0 {
                size
            } else {
                -size
            }
        })
    }

    /// The two halves of its number.
    #[must_use]
    pub fn to_words(self) -> [u64; 2] {
        [(self.0 >> 64) as u64, self.0 as u64]
    }

    /// From the two halves.
    #[must_use]
    pub fn from_words([high, low]: [u64; 2]) -> Self {
        Self(u128::from(high) << 64 | u128::from(low))
    }
}

/// All bits of a number spread over all (Stafford's 13th mix of `splitmix64`).
fn mixed(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ x >> 31
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_are_told_apart_and_names_are_kept() {
        assert_ne!(Source::fresh(), Source::fresh());
        assert_eq!(Source::named("scale"), Source::named("scale"));
        assert_ne!(Source::named("scale"), Source::named("Scale"));
        let variable = Source::fresh().variable(7);
        assert_eq!(Variable::from_words(variable.to_words()), variable);
        assert_ne!(variable, Source::named("scale").variable(7));
    }

    #[test]
    fn probes_have_the_moments_of_normal_variables() {
        let source = Source::named("probes");
        let mut cross = 0.0;
        for index in 0..2000 {
            let steps = source.variable(index).steps();
            let mean = |power: i32| steps.iter().map(|s| s.powi(power)).sum::<f64>() / 8.0;
            assert!((mean(2) - 1.0).abs() < 1e-15 && (mean(4) - 3.0).abs() < 1e-14);
            let next = source.variable(index + 1).steps();
            cross += steps.iter().zip(next).map(|(a, b)| a * b).sum::<f64>() / 8.0;
        }
        assert!((cross / 2000.0).abs() < 0.05, "{cross}");
    }
}
