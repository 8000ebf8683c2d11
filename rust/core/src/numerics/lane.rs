//! Lanes: one formula, written once, for one number or for several side by side.
//!
//! A hot formula is generic over [`Lane`]. Its instances are [`Lanes<1, FMA>`](Lanes), the scalar
//! twin, and wider arrays that the compiler turns into vector instructions wherever the calling
//! function enables them ([`dispatch`](super::dispatch)). Every operation acts on each lane by itself and
//! rounds as IEEE 754 says, so a lane's bits depend on its own numbers only: not on its neighbours, and
//! not on the width. Whether a product and a sum round once or twice is part of the type (`FMA`), so
//! machines with fused multiply-add agree with each other to the last bit.
//!
//! Plain arrays and plain loops: no intrinsics, nothing unsafe. The loops are written out because
//! closures and `array::from_fn` are not always inlined, and one call left in a kernel costs a third of its
//! speed.

use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// A number, or several numbers side by side, on which arithmetic acts lane by lane.
pub trait Lane:
    Copy
    + Debug
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// How many numbers stand side by side.
    const WIDTH: usize;
    /// The one-number twin: the same operations with the same rounding, hence the same bits.
    type Scalar: Lane<Scalar = Self::Scalar>;
    /// The outcome of a comparison, lane by lane.
    type Mask: LaneMask;

    /// The same number in every lane.
    fn splat(x: f64) -> Self;
    /// Lane i is `source[i]`.
    fn load(source: &[f64]) -> Self;
    /// Lane i is `source[stride * i + offset]`: one component out of consecutive records.
    fn gather(source: &[f64], stride: usize, offset: usize) -> Self;
    /// Writes lane i to `target[i]`.
    fn store(self, target: &mut [f64]);
    /// Writes lane i to `target[stride * i + offset]`.
    fn scatter(self, target: &mut [f64], stride: usize, offset: usize);
    /// The number in lane i.
    fn get(self, i: usize) -> f64;

    /// `self * b + c`: rounded once where the target multiplies and adds in one instruction, twice
    /// elsewhere. Never the software routine, which is fifty times slower.
    #[must_use]
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// Square root, correctly rounded.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Magnitude.
    #[must_use]
    fn abs(self) -> Self;
    /// The magnitude of `self` with the sign bit of `sign`.
    #[must_use]
    fn copysign(self, sign: Self) -> Self;
    /// The larger; `other` where either is not a number.
    #[must_use]
    fn max(self, other: Self) -> Self;
    /// The smaller; `other` where either is not a number.
    #[must_use]
    fn min(self, other: Self) -> Self;
    /// The powers of two (s, 1/s) for which s·|x| lies in [1, 2), both kept within the normal numbers: a
    /// denormal or zero x gets the largest s, an x of 2^1023 or more, or one that is not finite, the smallest.
    fn power_of_two_scale(self) -> (Self, Self);

    /// `self < other`.
    fn lt(self, other: Self) -> Self::Mask;
    /// `self <= other`.
    fn le(self, other: Self) -> Self::Mask;
    /// `a` where the mask holds, `b` elsewhere.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;
}

/// Truth values side by side.
pub trait LaneMask:
    Copy + Debug + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self>
{
    /// Whether any lane holds.
    fn any(self) -> bool;
    /// Bit i is lane i.
    fn bits(self) -> u32;
}

/// `N` doubles side by side; `FMA` says that `mul_add` is one instruction on the target.
///
/// Build values of a fused type only inside [`dispatch`](super::dispatch::dispatch), which has checked
/// the machine: elsewhere the answers are the same, but slow.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Lanes<const N: usize, const FMA: bool>(pub [f64; N]);

/// `N` truth values side by side.
#[derive(Clone, Copy, Debug)]
pub struct Mask<const N: usize>(pub [bool; N]);

/// An array of `N` elements of which element `$i` is `$value`.
macro_rules! each {
    ($i:ident: $zero:expr => $value:expr) => {{
        let mut out = [$zero; N];
        let mut $i = 0;
        while $i < N {
            out[$i] = $value;
            $i += 1;
        }
        out
    }};
}

macro_rules! lanewise {
    ($operator:ident, $method:ident, $symbol:tt) => {
        impl<const N: usize, const FMA: bool> $operator for Lanes<N, FMA> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(each!(i: 0.0 => self.0[i] $symbol other.0[i]))
            }
        }
    };
}
lanewise!(Add, add, +);
lanewise!(Sub, sub, -);
lanewise!(Mul, mul, *);
lanewise!(Div, div, /);

impl<const N: usize, const FMA: bool> Neg for Lanes<N, FMA> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(each!(i: 0.0 => -self.0[i]))
    }
}

const EXPONENT_BITS: u64 = 0x7ff;
const MANTISSA_WIDTH: u32 = 52;
/// Exponent fields of s and 1/s add up to this.
const RECIPROCAL_EXPONENTS: u64 = 2046;

/// The exponent field of x, kept where it and its reciprocal are both normal.
#[inline(always)]
fn scale_exponent(x: f64) -> u64 {
    ((x.to_bits() >> MANTISSA_WIDTH) & EXPONENT_BITS).clamp(1, RECIPROCAL_EXPONENTS - 1)
}

impl<const N: usize, const FMA: bool> Lane for Lanes<N, FMA> {
    const WIDTH: usize = N;
    type Scalar = Lanes<1, FMA>;
    type Mask = Mask<N>;

    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self([x; N])
    }

    #[inline(always)]
    fn load(source: &[f64]) -> Self {
        let source = &source[..N];
        Self(each!(i: 0.0 => source[i]))
    }

    #[inline(always)]
    fn gather(source: &[f64], stride: usize, offset: usize) -> Self {
        let source = &source[..stride * N];
        Self(each!(i: 0.0 => source[stride * i + offset]))
    }

    #[inline(always)]
    fn store(self, target: &mut [f64]) {
        let target = &mut target[..N];
        let mut i = 0;
        while i < N {
            target[i] = self.0[i];
            i += 1;
        }
    }

    #[inline(always)]
    fn scatter(self, target: &mut [f64], stride: usize, offset: usize) {
        let target = &mut target[..stride * N];
        let mut i = 0;
        while i < N {
            target[stride * i + offset] = self.0[i];
            i += 1;
        }
    }

    #[inline(always)]
    fn get(self, i: usize) -> f64 {
        self.0[i]
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        if FMA {
            Self(each!(i: 0.0 => self.0[i].mul_add(b.0[i], c.0[i])))
        } else {
            self * b + c
        }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(each!(i: 0.0 => self.0[i].sqrt()))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(each!(i: 0.0 => self.0[i].abs()))
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        Self(each!(i: 0.0 => self.0[i].copysign(sign.0[i])))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(each!(i: 0.0 => if self.0[i] > other.0[i] { self.0[i] } else { other.0[i] }))
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(each!(i: 0.0 => if self.0[i] < other.0[i] { self.0[i] } else { other.0[i] }))
    }

    #[inline(always)]
    fn power_of_two_scale(self) -> (Self, Self) {
        let scale = each!(i: 0.0 => {
            f64::from_bits((RECIPROCAL_EXPONENTS - scale_exponent(self.0[i])) << MANTISSA_WIDTH)
        });
        let inverse = each!(i: 0.0 => f64::from_bits(scale_exponent(self.0[i]) << MANTISSA_WIDTH));
        (Self(scale), Self(inverse))
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Mask<N> {
        Mask(each!(i: false => self.0[i] < other.0[i]))
    }

    #[inline(always)]
    fn le(self, other: Self) -> Mask<N> {
        Mask(each!(i: false => self.0[i] <= other.0[i]))
    }

    #[inline(always)]
    fn select(mask: Mask<N>, a: Self, b: Self) -> Self {
        Self(each!(i: 0.0 => if mask.0[i] { a.0[i] } else { b.0[i] }))
    }
}

impl<const N: usize> BitAnd for Mask<N> {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(each!(i: false => self.0[i] & other.0[i]))
    }
}

impl<const N: usize> BitOr for Mask<N> {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(each!(i: false => self.0[i] | other.0[i]))
    }
}

impl<const N: usize> Not for Mask<N> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(each!(i: false => !self.0[i]))
    }
}

impl<const N: usize> LaneMask for Mask<N> {
    #[inline(always)]
    fn any(self) -> bool {
        let mut any = false;
        let mut i = 0;
        while i < N {
            any |= self.0[i];
            i += 1;
        }
        any
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        let mut bits = 0;
        let mut i = 0;
        while i < N {
            bits |= u32::from(self.0[i]) << i;
            i += 1;
        }
        bits
    }
}
