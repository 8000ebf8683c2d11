//! Sources, and the independent standard normal variables that they draw.

use std::collections::hash_map::RandomState;
use std::hash::{BuildHasher, Hasher};
use std::sync::Mutex;

/// A draw: where a uncertainty comes from. What comes from one source stays one source, in pickles and files too.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Source {
    /// Of the process that made it, or of its name.
    origin: u64,
    /// Which of that process, or more of the name.
    number: u32,
}

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
        Self {
            origin: made.1,
            number: made.2,
        }
    }

    /// The source of this name: the same wherever it is named.
    #[must_use]
    pub fn named(name: &str) -> Self {
        // FNV-1a of 64 bits, of the name and of the name once more: 96 bits tell names apart.
        let hash = |start: u64| {
            name.bytes().fold(start, |hash, byte| {
                (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
            })
        };
        let origin = hash(0xcbf2_9ce4_8422_2325);
        let [.., a, b, c, d] = mix(hash(mix(origin))).to_be_bytes();
        Self {
            origin,
            number: u32::from_be_bytes([a, b, c, d]),
        }
    }

    /// Component `index` of the draw.
    #[must_use]
    pub fn variable(self, index: u32) -> Variable {
        Variable {
            origin: self.origin,
            place: u64::from(self.number) << 32 | u64::from(index),
        }
    }
}

/// A random number of the operating system's, by way of the seeds of the standard library's hashes.
fn random() -> u64 {
    RandomState::new().build_hasher().finish()
}

/// A standard normal variable, independent of all others.
///
/// # Examples
///
/// ```
/// use polhode::uncertainty::{PROBES, Source, Variable};
///
/// let scales = Source::named("scales");
/// assert_ne!(scales.variable(0), scales.variable(1));
/// assert_eq!(scales, Source::named("scales")); // a name is one source wherever it is said
/// assert_ne!(Source::fresh(), Source::fresh());
/// // To a file and back.
/// let variable = scales.variable(7);
/// assert_eq!(Variable::from_words(variable.to_words()), variable);
/// // Along the probes it takes steps with a mean square of 1.
/// let square: f64 = variable.steps().iter().map(|step| step * step).sum();
/// assert!((square - PROBES as f64).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Variable {
    origin: u64,
    /// The number of its source, and its own in that.
    place: u64,
}

/// How many directions in the space of all variables are probed to second order.
pub const PROBES: usize = 16;
/// Of each eight probes a variable takes two by a long step.
const EIGHT: usize = 8;
/// The steps that each variable takes along the probes, in a place and with a sign of its own: their mean square is 1 and
/// their mean fourth power 3, as of a normal variable.
const STEPS: [f64; 2] = [1.857_280_200_396_046_2, 0.428_372_990_596_132_3];

impl Variable {
    /// The step of the variable along each of the probes.
    #[must_use]
    pub fn steps(self) -> [f64; PROBES] {
        let (mut bits, mut first, mut second) = (0, 0, 0);
        std::array::from_fn(|probe| {
            let place = probe % EIGHT;
            if place == 0 {
                // Without the random part, so that the same program finds the same.
                bits = mix(self.place ^ mix((probe / EIGHT) as u64));
                first = (bits & 7) as usize;
                second = (first + 1 + (bits >> 3 & 0xffff) as usize % 7) % EIGHT;
            }
            let size = STEPS[usize::from(place != first && place != second)];
            if bits >> (32 + place) & 1 == 0 {
                size
            } else {
                -size
            }
        })
    }

    /// The two halves of its number.
    #[must_use]
    pub fn to_words(self) -> [u64; 2] {
        [self.origin, self.place]
    }

    /// From the two halves.
    #[must_use]
    pub fn from_words([origin, place]: [u64; 2]) -> Self {
        Self { origin, place }
    }
}

/// All bits of a number spread over all (Stafford's 13th mix of `splitmix64`).
fn mix(x: u64) -> u64 {
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
            let mean =
                |power: i32| steps.iter().map(|s| s.powi(power)).sum::<f64>() / PROBES as f64;
            assert!((mean(2) - 1.0).abs() < 1e-15 && (mean(4) - 3.0).abs() < 1e-14);
            let next = source.variable(index + 1).steps();
            cross += steps.iter().zip(next).map(|(a, b)| a * b).sum::<f64>() / PROBES as f64;
        }
        assert!((cross / 2000.0).abs() < 0.05, "{cross}");
    }
}
