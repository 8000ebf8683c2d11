//! The quartic of the motion: its invariants, and where the start is on its curve.
//!
//! The spinor `(1, x)` of n obeys `ẋ² = f(x)`, f of degree four: the energy is of degree two in x and in its conjugate, and
//! the discriminant of the one is f of the other. Its coefficients are complex, its invariants real. Derivation: the page
//! on the gyrostat.

use crate::numerics::complex::Complex;
use crate::numerics::elliptic::Real;

/// `1 + 4a₁x + 6a₂x² + 4a₃x³ + a₄x⁴`, which is −4f.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quartic<T> {
    /// `a₁`, `a₂`, `a₃`, `a₄`.
    a: [Complex<T>; 4],
}

/// The invariants of a quartic, with what decides how the motion looks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Invariants<T> {
    /// `G₂ = a₄ − 4a₁a₃ + 3a₂²`.
    pub(super) second: T,
    /// `G₃ = a₂a₄ + 2a₁a₂a₃ − a₂³ − a₃² − a₁²a₄`.
    pub(super) third: T,
    /// `G₂³ − 27 G₃²`.
    pub(super) discriminant: T,
    /// The sizes of the terms that the discriminant is the sum of.
    pub(super) terms: f64,
    /// Whether all three roots are equal: `G₂` and `G₃` are nothing beside their terms.
    pub(super) is_cusp: bool,
}

/// What inputs that are rounded make of invariants that are zero, and less; of coefficients too, as ρ is near one where they vanish.
const CUSP: f64 = 1e-18;

impl<T: Real> Quartic<T> {
    /// From `B₁₁, B₁₂, B₁₃, B₂₂, B₂₃, B₃₃` and ρ.
    pub(super) fn of(matrix: &[T; 6], rho: T) -> Self {
        let [b11, b12, b13, b22, b23, b33] = *matrix;
        let twice = |x: T| x.scaled(2.0);
        let third = T::from(1.0) / T::from(3.0);
        let a1 = Complex::new(-b22, b12);
        let a2 = Complex::new(
            b11 * b22 - b12 * b12 + rho * (b13 - rho.scaled(0.5)),
            T::from(3.0) * (rho * b23),
        );
        let a3 = Complex::new(
            rho * (b22 - twice(b33)) + twice(b23 * b12 - b13 * b22),
            rho * b12 + twice(b23 * b11 - b13 * b12),
        );
        let product = Complex::new(b13 - rho, -b23) * Complex::new(b13, -b23);
        let a4 = product + Complex::new(b33 * (b22 - b11), twice(b33 * b12));
        let square = rho * rho;
        Self {
            a: [
                a1,
                a2.times(twice(third)),
                a3.times(-rho),
                (a4.scaled(4.0) + Complex::new(square, T::from(0.0))).times(square),
            ],
        }
    }

    /// `G₂`, `G₃` and their discriminant, of which no term is one of G₂³: where ρ is tiny it keeps its digits.
    pub(super) fn invariants(&self) -> Invariants<T> {
        let [a1, a2, a3, a4] = self.a;
        let (square, three) = (a2.squared(), T::from(3.0));
        let cube = square * a2;
        let (a11, a33) = (a1.squared(), a3.squared());
        let p = a4 - (a1 * a3).scaled(4.0);
        let r = a2 * a4 + (a1 * a2 * a3).scaled(2.0) - a33 - a11 * a4;
        let lowest = (a2 * a4).times(three) - (a33 + a11 * a4).scaled(2.0);
        let p2 = p.squared();
        let sum = (cube * lowest - r.squared()).times(27.0.into())
            + (p2 * square).times(9.0.into())
            + p2 * p;
        let [s1, s2, s3, s4] = self.a.map(Complex::size);
        let sp = s4 + 4.0 * s1 * s3;
        let sr = s2 * s4 + 2.0 * s1 * s2 * s3 + s3 * s3 + s1 * s1 * s4;
        let s_lowest = 3.0 * s2 * s4 + 2.0 * (s3 * s3 + s1 * s1 * s4);
        let (second, third) = ((p + square.times(three)).re, (r - cube).re);
        Invariants {
            is_cusp: s2.max(s3).max(s4) <= CUSP
                || second.rounded().abs() <= CUSP * (sp + 3.0 * s2 * s2)
                    && third.rounded().abs() <= CUSP * (sr + s2.powi(3)),
            second,
            third,
            discriminant: sum.re,
            terms: 27.0 * (s2.powi(3) * s_lowest + sr * sr) + 9.0 * sp * sp * s2 * s2 + sp.powi(3),
        }
    }

    /// Weierstrass' function P and minus its derivative, `P′² = 4P³ − G₂P + G₃`, of twice the way from where the spinor turns back
    /// to the start: `P = a₂ − a₁²`, `P′ = i(a₃ − 3a₁a₂ + 2a₁³)`.
    pub(super) fn place(&self) -> [Complex<T>; 2] {
        let [a1, a2, a3, _] = self.a;
        let value = a2 - a1.squared();
        let slope = a3 - a1 * (value + a2.scaled(0.5)).scaled(2.0);
        [value, slope.times_i()]
    }

    /// `i a₁`, the rate of `log ẋ` at the start but for its sign.
    pub(super) fn turning(&self) -> Complex<T> {
        self.a[0].times_i()
    }

    /// `1/x` of the farther of the two spinors that half a period exchanges with themselves, for a start near an equilibrium:
    /// the zeros of `v_m x² + v_n x − v_m̄`, v the eigenvector of the matrix whose traces the invariants are, to `root`.
    pub(super) fn far(&self, root: T) -> Complex<T> {
        let [a1, a2, a3, a4] = self.a;
        let shift = a2.scaled(0.5) + Complex::new(root, T::from(0.0));
        let twice = shift.scaled(2.0);
        let first = a4 * a1 - twice * a3;
        let middle = twice.squared() - a4;
        let last = (a1 * middle + first).over(twice);
        let spread = (middle.squared() + (first * last).scaled(4.0)).sqrt();
        let spread = if spread.is_opposite_to(middle) {
            -spread
        } else {
            spread
        };
        -first.scaled(2.0).over(middle + spread)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::double_double::DoubleDouble;

    /// A zero of `first + middle y − last y²`, as the comment at `far` has it with y = 1/x, and the one that is nearer to zero.
    #[test]
    fn the_far_spinor_is_a_zero_of_its_quadratic() {
        let number = |re: f64, im: f64| Complex::<DoubleDouble>::new(re.into(), im.into());
        let (a1, a2) = (number(0.3, -0.7), number(0.9, 0.4));
        let (a3, a4) = (number(-0.2, 0.5), number(0.6, 0.1));
        for root in [0.25, -1.5] {
            let far = Quartic {
                a: [a1, a2, a3, a4],
            }
            .far(root.into());
            let twice = a2 + number(2.0 * root, 0.0);
            let (first, middle) = (a4 * a1 - twice * a3, twice.squared() - a4);
            let last = (a1 * middle + first).over(twice);
            let rest = first + middle * far - last * far.squared();
            assert!(rest.size() < 1e-28, "{root} {rest:?}");
            // The product of both is −first/last.
            assert!(far.squared().size() <= first.over(last).size(), "{root}");
        }
    }
}
