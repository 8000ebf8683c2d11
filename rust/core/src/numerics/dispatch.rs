//! Run-time dispatch: one binary, the widest lanes the machine at hand has.
//!
//! A [`Kernel`] is a piece of work generic over [`Lane`]. [`dispatch`] runs it compiled for the best [`Level`] of this
//! machine. The levels with fused multiply-add give the same bits as each other; [`Level::Baseline`], which every machine
//! has, rounds products and sums apart and agrees to the accuracy each kernel states. This is the only file of the crate
//! with `unsafe` in it: calling a function compiled for an instruction set asserts that the machine has it.
//!
//! With `--cfg baseline_alone` there is no other level: kernels compile in a third of the time, for measuring coverage. Nor
//! is there in the unit tests of this crate; those in `tests`, and of the package, run the levels of the machine. With the feature
//! `native-levels` the level AVX-512 is there only if the machine that compiles has it.

use std::fmt;
use std::sync::atomic::{AtomicU8, Ordering};

use super::lane::{AVX2, AVX512, BASELINE, Double, Lane, NEON};
use super::number::Number;

/// Work that is compiled for every level, or for those up to AVX2, and runs at the one [`dispatch`] picks.
pub trait Kernel {
    /// What the work returns.
    type Output;
    /// Whether more than four lanes make it faster. Otherwise it is not compiled for AVX-512: with that a single motion takes up to 1.4
    /// times as long, since registers of eight doubles are filled by parts.
    const IS_WIDE: bool = true;
    /// Does the work. Mark the implementation, and every helper it calls, `#[inline(always)]`: what is
    /// not inlined is compiled for the baseline.
    fn run<L: Lane>(self) -> Self::Output;
}

/// An instruction set that kernels are compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Level {
    /// What every processor of the architecture has, products and sums rounded apart.
    Baseline = BASELINE,
    /// 64-bit ARM: two doubles to a register, fused multiply-add.
    Neon = NEON,
    /// x86-64 with four doubles to a register and fused multiply-add.
    Avx2 = AVX2,
    /// x86-64 with eight doubles to a register.
    Avx512 = AVX512,
}

impl Level {
    /// All levels, narrowest first.
    pub const ALL: [Self; 4] = [Self::Baseline, Self::Neon, Self::Avx2, Self::Avx512];

    /// Whether this machine can run the level.
    #[must_use]
    pub fn is_available(self) -> bool {
        match self {
            Self::Baseline => true,
            Self::Neon => cfg!(all(target_arch = "aarch64", not(any(baseline_alone, test)))),
            #[cfg(all(target_arch = "x86_64", not(any(baseline_alone, test))))]
            Self::Avx2 => {
                is_x86_feature_detected!("avx2")
                    && is_x86_feature_detected!("fma")
                    && is_x86_feature_detected!("bmi1")
                    && is_x86_feature_detected!("bmi2")
                    && is_x86_feature_detected!("lzcnt")
            }
            #[cfg(all(target_arch = "x86_64", not(any(baseline_alone, without_avx512, test))))]
            Self::Avx512 => {
                Self::Avx2.is_available()
                    && is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512bw")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
            }
            #[cfg(not(all(target_arch = "x86_64", not(any(baseline_alone, test)))))]
            Self::Avx2 => false,
            #[cfg(not(all(
                target_arch = "x86_64",
                not(any(baseline_alone, without_avx512, test))
            )))]
            Self::Avx512 => false,
        }
    }

    /// The widest level this machine has.
    #[must_use]
    pub fn best() -> Self {
        Self::ALL
            .into_iter()
            .rev()
            .find(|level| level.is_available())
            .unwrap_or(Self::Baseline)
    }
}

impl fmt::Display for Level {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Baseline => "baseline",
            Self::Neon => "neon",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        })
    }
}

/// The level in use; 0 until the first call has looked.
static LEVEL: AtomicU8 = AtomicU8::new(0);

/// The level that [`dispatch`] uses.
#[inline]
pub fn level() -> Level {
    match LEVEL.load(Ordering::Relaxed) {
        AVX512 => Level::Avx512,
        AVX2 => Level::Avx2,
        NEON => Level::Neon,
        BASELINE => Level::Baseline,
        _ => {
            let best = Level::best();
            LEVEL.store(best as u8, Ordering::Relaxed);
            best
        }
    }
}

/// Makes the whole process use `level`, for tests and benchmarks; returns whether the machine has it
/// (where it has not, nothing changes).
pub fn set_level(level: Level) -> bool {
    let available = level.is_available();
    if available {
        LEVEL.store(level as u8, Ordering::Relaxed);
    }
    available
}

/// Runs the kernel on the widest lanes of this machine.
#[inline]
pub fn dispatch<K: Kernel>(kernel: K) -> K::Output {
    match level() {
        #[cfg(all(target_arch = "x86_64", not(any(baseline_alone, without_avx512, test))))]
        #[expect(
            unsafe_code,
            reason = "`level` is only ever a level whose instructions were detected"
        )]
        Level::Avx512 if K::IS_WIDE => unsafe { avx512(kernel) },
        #[cfg(all(target_arch = "x86_64", not(any(baseline_alone, test))))]
        #[expect(
            unsafe_code,
            reason = "`level` is only ever a level whose instructions were detected; AVX-512 comes with AVX2"
        )]
        Level::Avx2 | Level::Avx512 => unsafe { avx2(kernel) },
        #[cfg(all(target_arch = "aarch64", not(any(baseline_alone, test))))]
        Level::Neon => kernel.run::<Double<NEON>>(),
        _ => baseline(kernel),
    }
}

/// Runs a kernel that another one calls, at the level of that kernel's numbers `N`: it is compiled for no other. Numbers that are
/// computed outside of kernels have no level: then it runs as [`dispatch`] does.
///
/// # Panics
/// If this machine does not have the level.
#[inline]
pub(crate) fn dispatch_within<N: Number, K: Kernel>(kernel: K) -> K::Output {
    match N::LEVEL {
        #[cfg(all(target_arch = "x86_64", not(any(baseline_alone, without_avx512, test))))]
        AVX512 => {
            assert_available(AVX512);
            #[expect(unsafe_code, reason = "the machine has the instructions")]
            unsafe {
                avx512(kernel)
            }
        }
        #[cfg(all(target_arch = "x86_64", not(any(baseline_alone, test))))]
        AVX2 => {
            assert_available(AVX2);
            #[expect(unsafe_code, reason = "the machine has the instructions")]
            unsafe {
                avx2(kernel)
            }
        }
        BASELINE => baseline(kernel),
        _ => dispatch(kernel),
    }
}

/// The widest level of this machine; 0 until a call has looked. Unlike [`LEVEL`] it does not change while a kernel runs.
#[cfg(all(target_arch = "x86_64", not(any(baseline_alone, test))))]
static BEST: AtomicU8 = AtomicU8::new(0);

/// Checks that this machine has a level.
///
/// # Panics
/// If it has not.
#[cfg(all(target_arch = "x86_64", not(any(baseline_alone, test))))]
#[inline(always)]
fn assert_available(level: u8) {
    if level > BEST.load(Ordering::Relaxed) {
        look_for(level);
    }
}

#[cfg(all(target_arch = "x86_64", not(any(baseline_alone, test))))]
#[cold]
#[inline(never)]
fn look_for(level: u8) {
    let best = Level::best() as u8;
    BEST.store(best, Ordering::Relaxed);
    assert!(
        level <= best,
        "numbers of the level {level} on a machine of the level {best}"
    );
}

/// Runs the kernel as [`dispatch`] does. At the baseline of x86-64 it returns the kernel, which is not compiled for it: with two
/// doubles to a register, many rows side by side take about as long as one after the other.
///
/// # Errors
/// The kernel, at that level.
#[cfg_attr(
    not(all(target_arch = "x86_64", not(any(baseline_alone, test)))),
    expect(
        clippy::unnecessary_wraps,
        reason = "the baseline is compiled where it may be the best level"
    )
)]
#[inline]
pub(crate) fn dispatch_fused<K: Kernel>(kernel: K) -> Result<K::Output, K> {
    match level() {
        #[cfg(all(target_arch = "x86_64", not(any(baseline_alone, without_avx512, test))))]
        #[expect(
            unsafe_code,
            reason = "`level` is only ever a level whose instructions were detected"
        )]
        Level::Avx512 => Ok(unsafe { avx512(kernel) }),
        #[cfg(all(target_arch = "x86_64", not(any(baseline_alone, test))))]
        #[expect(
            unsafe_code,
            reason = "`level` is only ever a level whose instructions were detected"
        )]
        Level::Avx2 => Ok(unsafe { avx2(kernel) }),
        #[cfg(all(target_arch = "x86_64", not(any(baseline_alone, test))))]
        _ => Err(kernel),
        #[cfg(not(all(target_arch = "x86_64", not(any(baseline_alone, test)))))]
        _ => Ok(dispatch(kernel)),
    }
}

// Out of line: the kernel would be compiled again wherever a caller of `dispatch` is, and within another kernel its sums would not be
// kept in registers.

#[inline(never)]
fn baseline<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<Double<BASELINE>>()
}

#[cfg(all(target_arch = "x86_64", not(any(baseline_alone, test))))]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt")]
#[inline(never)]
fn avx2<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<Double<AVX2>>()
}

#[cfg(all(target_arch = "x86_64", not(any(baseline_alone, without_avx512, test))))]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx512bw,avx2,fma,bmi1,bmi2,lzcnt")]
#[inline(never)]
fn avx512<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<Double<AVX512>>()
}
