//! Lanes: each hot formula written once, for one number, and run on several side by side.
//!
//! A formula generic over [`Lane`] reads like scalar arithmetic. Called once it is scalar arithmetic; called in a loop
//! over [`StructureOfArrays`](super::structure_of_arrays::StructureOfArrays) inside a [`Kernel`](super::dispatch::Kernel) it becomes vector instructions as
//! wide as the machine has, one lane for each row. Every operation rounds as IEEE 754 says, so a row's bits depend on its
//! own numbers only: not on its neighbours, and not on the width. Whether a product and a sum round once or twice is part
//! of the type, so all machines with fused multiply-add agree to the last bit.
//!
//! No intrinsics, nothing unsafe. A formula that is to be vectorised has no loop with a data-dependent end, takes both
//! sides of every `if`, and is `#[inline(always)]` down to the last helper.

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::double_double::two_product;

/// A double with a known way of multiplying and adding: one lane of a vectorised loop.
pub trait Lane:
    Copy
    + Debug
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The [`Level`](super::dispatch::Level) that it is computed at, as a number.
    const LEVEL: u8;
    /// Zero.
    const ZERO: Self;
    /// The number `x`.
    fn new(x: f64) -> Self;
    /// The number as a plain double.
    fn get(self) -> f64;

    /// `self * b + c`: rounded once where the machine multiplies and adds in one instruction, twice elsewhere. Never the
    /// software routine, which is fifty times slower.
    #[must_use]
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// `self * b = p + e` exactly, p the rounded product, for factors below 2⁹⁹⁶ and products above 2⁻⁹⁶⁸.
    #[must_use]
    fn two_product(self, b: Self) -> (Self, Self);
    /// Square root, correctly rounded.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Magnitude.
    #[must_use]
    fn abs(self) -> Self;
    /// The magnitude of `self` with the sign bit of `sign`.
    #[must_use]
    fn copysign(self, sign: Self) -> Self;
    /// Round to the nearest integer, ties to even. Numbers above 2⁵² are integers already and are returned unchanged.
    #[must_use]
    fn round(self) -> Self;
    /// 2 to the power of `self`, an integer from −1022 to 1023.
    #[must_use]
    fn power_of_two(self) -> Self;
    /// The larger; `other` where either is not a number.
    #[must_use]
    fn max(self, other: Self) -> Self;
    /// The smaller; `other` where either is not a number.
    #[must_use]
    fn min(self, other: Self) -> Self;
    /// The powers of two (s, 1/s) for which s·|x| lies in [1, 2), both kept within the normal numbers: zero or a denormal
    /// gets the largest s, 2¹⁰²³ or more and what is not finite the smallest.
    fn power_of_two_scale(self) -> (Self, Self);
}

/// A double that is computed at a [`Level`](super::dispatch::Level): at all levels but the baseline `mul_add` is one instruction.
///
/// Only [`dispatch`](super::dispatch::dispatch) should choose another level than the baseline, since it has looked at the machine:
/// elsewhere the answers are the same, but slow.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
#[repr(transparent)]
pub struct Double<const LEVEL: u8>(f64);

// The levels as numbers, for types.
pub(crate) const BASELINE: u8 = 1;
pub(crate) const NEON: u8 = 2;
pub(crate) const AVX2: u8 = 3;
pub(crate) const AVX512: u8 = 4;

macro_rules! forward {
    ($operator:ident, $method:ident, $symbol:tt) => {
        impl<const LEVEL: u8> $operator for Double<LEVEL> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0 $symbol other.0)
            }
        }
    };
}
forward!(Add, add, +);
forward!(Sub, sub, -);
forward!(Mul, mul, *);
forward!(Div, div, /);

impl<const LEVEL: u8> Neg for Double<LEVEL> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

const MANTISSA_WIDTH: u32 = 52;
const EXPONENT_FIELD: u64 = 0x7ff;
/// 1.5·2⁵²: from here to 2⁵³ the doubles are the integers.
const INTEGERS: f64 = 6_755_399_441_055_744.0;
/// The bits of 1.0.
const ONE_BITS: u64 = 0x3ff0_0000_0000_0000;
/// The exponent fields of s and 1/s add up to this.
const RECIPROCAL_FIELDS: u64 = 2046;

impl<const LEVEL: u8> Lane for Double<LEVEL> {
    const LEVEL: u8 = LEVEL;
    const ZERO: Self = Self(0.0);

    #[inline(always)]
    fn new(x: f64) -> Self {
        Self(x)
    }

    #[inline(always)]
    fn get(self) -> f64 {
        self.0
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        if LEVEL > BASELINE {
            Self(self.0.mul_add(b.0, c.0))
        } else {
            Self(self.0 * b.0 + c.0)
        }
    }

    #[inline(always)]
    fn two_product(self, b: Self) -> (Self, Self) {
        if LEVEL > BASELINE {
            let p = self.0 * b.0;
            (Self(p), Self(self.0.mul_add(b.0, -p)))
        } else {
            let (p, e) = two_product(self.0, b.0);
            (Self(p), Self(e))
        }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs())
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        Self(self.0.copysign(sign.0))
    }

    #[inline(always)]
    fn round(self) -> Self {
        Self(self.0.round_ties_even())
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        // The sum has the integer in its lowest bits, in two's complement: they become the exponent.
        let bits = (self.0 + INTEGERS).to_bits();
        Self(f64::from_bits(
            (bits << MANTISSA_WIDTH).wrapping_add(ONE_BITS),
        ))
    }

    // The comparisons as the processor has them: `f64::max` would treat NaN with more care, in three instructions.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self.0 > other.0 { self } else { other }
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self.0 < other.0 { self } else { other }
    }

    #[inline(always)]
    fn power_of_two_scale(self) -> (Self, Self) {
        let field = (self.0.to_bits() >> MANTISSA_WIDTH) & EXPONENT_FIELD;
        let kept = field.clamp(1, RECIPROCAL_FIELDS - 1);
        let power = |field: u64| Self(f64::from_bits(field << MANTISSA_WIDTH));
        (power(RECIPROCAL_FIELDS - kept), power(kept))
    }
}

#[cfg(test)]
mod tests {
    use super::{AVX2, BASELINE, Double, Lane};

    #[test]
    fn scales_are_powers_of_two_and_bring_magnitudes_to_one() {
        for x in [1.0, -1.5, 1.999, 3e-308, -8e307, 6.6e-34, 5.97e24] {
            let (s, inverse) = Double::<BASELINE>(x).power_of_two_scale();
            assert_eq!(s.0 * inverse.0, 1.0);
            assert!((1.0..2.0).contains(&(x * s.0).abs()), "{x}");
        }
        for x in [0.0, 5e-324, 1e308, f64::INFINITY, f64::NAN] {
            let (s, inverse) = Double::<BASELINE>(x).power_of_two_scale();
            assert!(s.0.is_normal() && s.0 * inverse.0 == 1.0);
        }
    }

    #[test]
    fn integers_and_their_powers_of_two() {
        let round = |x: f64| Double::<AVX2>(x).round().get();
        assert_eq!((round(2.5), round(-3.5), round(1e300)), (2.0, -4.0, 1e300));
        for n in [-1022, -53, -1, 0, 1, 52, 1023] {
            let power = Double::<AVX2>(f64::from(n)).power_of_two().get();
            assert_eq!(power, 2.0_f64.powi(n));
        }
    }

    #[test]
    fn rests_of_products_are_exact_in_either_type() {
        let (a, b) = (1.0 + f64::EPSILON, 1.0 - f64::EPSILON);
        let exact = (1.0, -f64::EPSILON * f64::EPSILON);
        let (p, e) = Double::<AVX2>(a).two_product(Double(b));
        assert_eq!((p.get(), e.get()), exact);
        let (p, e) = Double::<BASELINE>(a).two_product(Double(b));
        assert_eq!((p.get(), e.get()), exact);
    }

    #[test]
    fn products_and_sums_round_as_the_type_says() {
        let (a, b) = (1.0 + f64::EPSILON, 1.0 - f64::EPSILON);
        let (once, twice) = (Double::<AVX2>(a), Double::<BASELINE>(a));
        assert_eq!(
            once.mul_add(Double(b), Double(-1.0)).get(),
            -f64::EPSILON * f64::EPSILON
        );
        assert_eq!(twice.mul_add(Double(b), Double(-1.0)).get(), 0.0);
    }
}
