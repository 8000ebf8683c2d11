//! The quartic of the motion, and where the start is on its curve.
//!
//! The spinor `(1, x)` of n obeys `ẋ² = f(x)`, f of degree four: the energy is of degree two in x and in its conjugate, and
//! the discriminant of the one is f of the other. Its coefficients are complex; its invariants are those of the pencil.
//! Derivation: the page on the gyrostat.

use crate::numerics::complex::Complex;
use crate::numerics::double_double::DoubleDouble;

type Number = Complex<DoubleDouble>;

/// `1 + 4a₁x + 6a₂x² + 4a₃x³ + a₄x⁴`, which is −4f.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quartic {
    /// `a₁`, `a₂`, `a₃`, `a₄`.
    a: [Number; 4],
}

impl Quartic {
    /// From `B₁₁, B₁₂, B₁₃, B₂₂, B₂₃, B₃₃` and ρ.
    pub(super) fn of(matrix: &[DoubleDouble; 6], rho: DoubleDouble) -> Self {
        let [b11, b12, b13, b22, b23, b33] = *matrix;
        let twice = |x: DoubleDouble| x.scaled(2.0);
        let third = DoubleDouble::from(1.0) / DoubleDouble::from(3.0);
        let a1 = Complex::new(-b22, b12);
        let a2 = Complex::new(
            b11 * b22 - b12 * b12 + rho * (b13 - rho.scaled(0.5)),
            DoubleDouble::from(3.0) * (rho * b23),
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
                (a4.scaled(4.0) + Complex::new(square, DoubleDouble::from(0.0))).times(square),
            ],
        }
    }

    /// Weierstrass' function P and minus its derivative, `P′² = 4P³ − G₂P + G₃`, of twice the way from where the spinor turns back
    /// to the start: `P = a₂ − a₁²`, `P′ = i(a₃ − 3a₁a₂ + 2a₁³)`.
    pub(super) fn place(&self) -> [Number; 2] {
        let [a1, a2, a3, _] = self.a;
        let value = a2 - a1.squared();
        let slope = a3 - a1 * (value + a2.scaled(0.5)).scaled(2.0);
        [value, slope.times_i()]
    }

    /// `i a₁`, the rate of `log ẋ` at the start but for its sign.
    pub(super) fn turning(&self) -> Number {
        self.a[0].times_i()
    }

    /// `1/x` of the farther of the two spinors that half a period exchanges with themselves, for a start near an equilibrium:
    /// the zeros of `v_m x² + v_n x − v_m̄`, v the eigenvector of the matrix whose traces the invariants are, to `root`.
    pub(super) fn far(&self, root: DoubleDouble) -> Number {
        let [a1, a2, a3, a4] = self.a;
        let shift = a2.scaled(0.5) + Complex::new(root, DoubleDouble::from(0.0));
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

    /// A zero of `first + middle y − last y²`, as the comment at `far` has it with y = 1/x, and the one that is nearer to zero.
    #[test]
    fn the_far_spinor_is_a_zero_of_its_quadratic() {
        let number = |re: f64, im: f64| Number::new(re.into(), im.into());
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
