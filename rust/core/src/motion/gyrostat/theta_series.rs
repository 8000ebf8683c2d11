//! The two theta functions of a motion and their products, in lanes.

use crate::numerics::lane::Lane;
use crate::numerics::theta::circular;
use crate::numerics::turns::{exp_minus, exp_minus_and_rest, sin_cos_turns};

/// The theta functions of a motion at one argument, but for a common factor.
pub(super) struct Values<L> {
    /// Θₑ and Θₒ, real and imaginary part of each.
    pub(super) functions: [(L, L); 2],
    /// `|Θₑ|²`, `|Θₒ|²`, real and imaginary part of `Θ̄ₑΘₒ`; of [`WithProducts`] the four series that these are
    /// made of: see `products.rs`.
    pub(super) products: [L; 4],
}

impl<L: Lane> Values<L> {
    /// Of two functions by themselves.
    #[inline(always)]
    fn of(even: (L, L), odd: (L, L)) -> Self {
        Self {
            functions: [even, odd],
            products: [
                even.0 * even.0 + even.1 * even.1,
                odd.0 * odd.0 + odd.1 * odd.1,
                even.0 * odd.0 + even.1 * odd.1,
                even.0 * odd.1 - even.1 * odd.0,
            ],
        }
    }
}

/// The two theta functions and their products at the argument x; `rest` is what rounding has left out of x, where x is not taken
/// off whole turns, and `sign` that of Θₒ.
pub(super) trait ThetaSeries {
    fn values<L: Lane>(&self, x: L, rest: L, sign: L) -> Values<L>;
}

/// By sines and cosines of multiples of x turns: coefficients of `cos 2jx`, `sin 2jx`, and of `cos (2j+1)x`, `sin (2j+1)x`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Circular {
    /// Real and imaginary part, before the cosine and before the sine.
    pub(super) even: [[f64; 4]; 3],
    pub(super) odd: [[f64; 4]; 4],
}

/// Functions with products that are series of their own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WithProducts<F, P> {
    pub(super) functions: F,
    pub(super) products: P,
}

/// The series A, B, C, S that the products of both are made of: what stands before the cosine and before the sine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CircularProducts {
    /// Of 4x and 8x, beside one.
    pub(super) first: [[f64; 2]; 2],
    /// Of 2x and 6x.
    pub(super) second: [[f64; 2]; 2],
    /// Of x, 3x, 5x, 7x, 9x.
    pub(super) cosines: [[f64; 2]; 5],
    pub(super) sines: [[f64; 2]; 5],
}

impl CircularProducts {
    #[inline(always)]
    fn values<L: Lane>(&self, z: &circular::Argument<L>) -> [L; 4] {
        let plus = |[a, b]: [f64; 2], n: usize, sum: L| {
            L::new(a).mul_add(z.cos[n], L::new(b).mul_add(z.sin[n], sum))
        };
        let (zero, one) = (L::new(0.0), L::new(1.0));
        let first = plus(self.first[0], 4, plus(self.first[1], 8, one));
        let second = plus(self.second[0], 2, plus(self.second[1], 6, zero));
        let [mut cosines, mut sines] = [zero; 2];
        let mut k = 5;
        while k > 0 {
            k -= 1;
            cosines = plus(self.cosines[k], 2 * k + 1, cosines);
            sines = plus(self.sines[k], 2 * k + 1, sines);
        }
        [first, second, cosines, sines]
    }
}

impl Circular {
    #[inline(always)]
    fn functions<L: Lane>(&self, z: &circular::Argument<L>) -> [(L, L); 2] {
        let (mut even, mut odd) = ((L::new(0.0), L::new(0.0)), (L::new(0.0), L::new(0.0)));
        let mut k = 4;
        while k > 0 {
            k -= 1;
            let n = 2 * k + 1;
            odd = add(odd, &self.odd[k], z.cos[n], z.sin[n]);
            if k > 0 {
                even = add(even, &self.even[k - 1], z.cos[2 * k], z.sin[2 * k]);
            }
        }
        [(L::new(1.0) + even.0, even.1), odd]
    }
}

impl ThetaSeries for Circular {
    #[inline(always)]
    fn values<L: Lane>(&self, x: L, _: L, _: L) -> Values<L> {
        let (sine, cosine) = sin_cos_turns(x);
        let [even, odd] = self.functions(&circular::Argument::new(sine, cosine));
        Values::of(even, odd)
    }
}

impl ThetaSeries for WithProducts<Circular, CircularProducts> {
    #[inline(always)]
    fn values<L: Lane>(&self, x: L, _: L, _: L) -> Values<L> {
        let (sine, cosine) = sin_cos_turns(x);
        let z = circular::Argument::new(sine, cosine);
        Values {
            functions: self.functions.functions(&z),
            products: self.products.values(&z),
        }
    }
}

#[inline(always)]
fn add<L: Lane>((re, im): (L, L), coefficients: &[f64; 4], cosine: L, sine: L) -> (L, L) {
    let [a, b, c, d] = coefficients.map(L::new);
    (
        a.mul_add(cosine, c.mul_add(sine, re)),
        b.mul_add(cosine, d.mul_add(sine, im)),
    )
}

/// By exponentials: with `g = e^{−|θ|}` and `Y = e^{−(end − |θ|)}`, both series over `e^{|θ|}`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hyperbolic {
    /// `sgn(Q)^j |Q|^{j²−j} (cos 2jφ, sin 2jφ)`, j from one.
    pub(super) even: [[f64; 2]; 3],
    /// `|Q|^{j²} (cos (2j+1)φ, sin (2j+1)φ)`, j from zero.
    pub(super) odd: [[f64; 2]; 4],
    /// θ for x = 1.
    pub(super) unit: f64,
    /// θ for x = ½.
    pub(super) end: f64,
}

/// The series A, B, C, S of the products, but for powers of g and Y: what stands before `1 ± g^{2n}`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HyperbolicProducts {
    /// n = 2, 6, 10 of B, and between them n = 4, 8 of A.
    pub(super) even: [f64; 5],
    /// n = 1, 3, … 11 of C and of S.
    pub(super) odd: [[f64; 2]; 6],
}

impl HyperbolicProducts {
    /// A, B, C, S over `e^{2|θ|}` but for the sign of S, from g and Y².
    #[inline(always)]
    fn values<L: Lane>(&self, g: L, y2: L) -> [L; 4] {
        let (zero, one) = (L::new(0.0), L::new(1.0));
        let g2 = g * g;
        let (mut first, mut second, mut cosines, mut sines) = (one, zero, zero, zero);
        let (mut decay, mut power) = (one, g2);
        let mut k = 0;
        while k < 6 {
            let [c, s] = self.odd[k].map(L::new);
            cosines = (c * decay).mul_add(one + power, cosines);
            sines = (s * decay).mul_add(one - power, sines);
            power = power * g2;
            let next = decay * y2;
            if k < 5 {
                let weight = L::new(self.even[k]);
                if k % 2 == 0 {
                    second = (weight * decay).mul_add(one + power, second);
                } else {
                    first = (weight * next).mul_add(one + power, first);
                }
            }
            (decay, power) = (next, power * g2);
            k += 1;
        }
        [g2 * first, second, g * cosines, g * sines]
    }
}

impl Hyperbolic {
    /// Both functions; g, Y² and the sign of θ.
    #[inline(always)]
    fn functions<L: Lane>(&self, x: L, turned: L) -> ([(L, L); 2], [L; 3]) {
        let (zero, one) = (L::new(0.0), L::new(1.0));
        let theta = x * L::new(self.unit);
        let size = theta.abs();
        let sign = one.copysign(theta);
        let g = exp_minus(size);
        let end = exp_minus((L::new(self.end) - size).max(zero));
        let (y2, g2) = (end * end, g * g);
        let mut even = (one, zero);
        let mut odd = (zero, zero);
        let (mut decay, mut power) = (one, g2);
        let mut j = 0;
        while j < 4 {
            let [c, s] = self.odd[j];
            odd.0 = (L::new(c) * decay).mul_add(one + power, odd.0);
            odd.1 = (L::new(s) * decay).mul_add(one - power, odd.1);
            decay = decay * y2;
            power = power * g2;
            if j < 3 {
                let [c, s] = self.even[j];
                even.0 = (L::new(c) * decay).mul_add(one + power, even.0);
                even.1 = (L::new(s) * decay).mul_add(one - power, even.1);
            }
            power = power * g2;
            j += 1;
        }
        let even = (g * even.0, g * sign * even.1);
        let odd = (turned * odd.0, turned * (sign * odd.1));
        ([even, odd], [g, y2, sign])
    }
}

impl ThetaSeries for Hyperbolic {
    #[inline(always)]
    fn values<L: Lane>(&self, x: L, _: L, turned: L) -> Values<L> {
        let ([even, odd], _) = self.functions(x, turned);
        Values::of(even, odd)
    }
}

impl ThetaSeries for WithProducts<Hyperbolic, HyperbolicProducts> {
    #[inline(always)]
    fn values<L: Lane>(&self, x: L, _: L, turned: L) -> Values<L> {
        let (functions, [g, y2, sign]) = self.functions.functions(x, turned);
        let [first, second, cosines, sines] = self.products.values(g, y2);
        Values {
            functions,
            products: [first, second, turned * cosines, turned * (sign * sines)],
        }
    }
}

/// One and `2 cosh (x + iφ) − 2 cos φ`, what the second function has more than where x is zero; both over `e^{|x|}`.
///
/// With φ small the second function itself is nearly a constant there, and the spinor a difference of far larger ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Passing {
    /// cos φ, sin φ.
    pub(super) wave: [f64; 2],
    /// The least x: zero where a motion leads from one equilibrium to another, of which no `e^{−x}` is a part, else minus
    /// infinity.
    pub(super) least: f64,
}

impl ThetaSeries for Passing {
    #[inline(always)]
    fn values<L: Lane>(&self, x: L, rest: L, _: L) -> Values<L> {
        let [cosine, sine] = self.wave.map(L::new);
        let one = L::new(1.0);
        let x = L::new(self.least).max(x); // in this order NaN stays NaN
        let sign = one.copysign(x);
        let (g, lack) = exp_minus_and_rest(x.abs());
        let change = g * (sign * rest);
        let (g, lack) = (g - change, lack + change);
        let odd = (cosine * lack * lack, sign * sine * lack * (one + g));
        Values::of((g, L::new(0.0)), odd)
    }
}

/// One and `x + k x²`, both over 1 + x².
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rational {
    /// Real and imaginary part of k.
    pub(super) curvature: [f64; 2],
}

impl ThetaSeries for Rational {
    #[inline(always)]
    fn values<L: Lane>(&self, x: L, _: L, _: L) -> Values<L> {
        let [re, im] = self.curvature.map(L::new);
        let square = x * x;
        let over = L::new(1.0) / (L::new(1.0) + square);
        let odd = (re.mul_add(square, x) * over, im * square * over);
        Values::of((over, L::new(0.0)), odd)
    }
}
