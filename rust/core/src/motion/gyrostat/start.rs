//! The start in the frame that L and ω make, and the quartic of the motion there.
//!
//! With `L = I ω + h` (components in the body, |L| constant) the axes are `n = L/|L|`, `e₂` along `L × ω = I ω̇`, and
//! `e₁ = e₂ × n`, along what ω has across L: `ω = ρ e₁ + ω_n n`, ρ ≥ 0, which is zero only in a steady spin. All else is in
//! the symmetric matrix `B = |L| I⁻¹ − ω_n 1` in these axes, in which a body without differences of its moments and without
//! h has no part.
//!
//! The spinor `(1, x)` of n obeys `ẋ² = f(x)`, f of degree four: the energy is of degree two in x and in its conjugate, and
//! the discriminant of the one is f of the other. Its coefficients are complex; its invariants are those of the pencil.
//! Derivation: the page on the gyrostat.

use crate::mass::refined::Vector;
use crate::numerics::complex::Complex;
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::power_of_two::power_below;

/// The start, in units in which nothing is far from one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start {
    /// `e₁`, `e₂`, n; components along the principal axes.
    pub(super) frame: [Vector; 3],
    /// |L|.
    pub(super) momentum: DoubleDouble,
    /// ρ, over `unit`.
    pub(super) across: DoubleDouble,
    /// `B₁₁, B₁₂, B₁₃, B₂₂, B₂₃, B₃₃`, over `unit`.
    pub(super) matrix: [DoubleDouble; 6],
    /// `ω·n`, in units of the rates.
    pub(super) along: DoubleDouble,
    /// `|L| e₂·I⁻¹e₂`, in units of the rates.
    pub(super) transverse: DoubleDouble,
    /// A power of two near the largest of `matrix` and `across`.
    pub(super) unit: f64,
}

/// A component of L × ω this small beside its terms is zero.
const NOISE: f64 = 1e-30;

pub(super) fn cross(a: &Vector, b: &Vector) -> Vector {
    [[1, 2], [2, 0], [0, 1]].map(|[j, k]| a[j] * b[k] - a[k] * b[j])
}

pub(super) fn dot(a: &Vector, b: &Vector) -> DoubleDouble {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn largest(v: &[DoubleDouble]) -> f64 {
    v.iter()
        .fold(0.0, |most: f64, x| most.max(x.rounded().abs()))
}

/// The unit vector along v, and its length as a number near one and a power of two; `None` of zero.
pub(super) fn direction(v: &Vector) -> Option<(Vector, DoubleDouble, f64)> {
    let size = largest(v);
    if size == 0.0 {
        return None;
    }
    // Twice: what was denormal is near one only then.
    let unit = power_below(size);
    let v = v.map(|x| x.scaled(1.0 / unit));
    let again = power_below(largest(&v));
    let v = v.map(|x| x.scaled(1.0 / again));
    let length = dot(&v, &v).sqrt();
    let inverse = DoubleDouble::from(1.0) / length;
    Some((v.map(|x| x * inverse), length.scaled(again), unit))
}

impl Start {
    /// Of positive moments, ω and h along the principal axes; `None` where ω is constant.
    pub(super) fn of(moments: &Vector, omega: &Vector, rotor: &Vector) -> Option<Self> {
        let [i1, i2, i3] = *moments;
        let momentum: Vector = std::array::from_fn(|k| moments[k] * omega[k] + rotor[k]);
        // L × ω, whose terms keep their digits where ω or h is along an axis.
        let torque: Vector = std::array::from_fn(|k| {
            let (a, b) = ((k + 1) % 3, (k + 2) % 3);
            let terms = [
                (moments[a] - moments[b]) * (omega[a] * omega[b]),
                rotor[a] * omega[b],
                -(rotor[b] * omega[a]),
            ];
            let sum = terms[0] + terms[1] + terms[2];
            if sum.rounded().abs() <= NOISE * largest(&terms) {
                DoubleDouble::from(0.0)
            } else {
                sum
            }
        });
        let (n, length, unit) = direction(&momentum)?;
        let length = length.scaled(unit);
        let (e2, turning, turning_unit) = direction(&torque)?;
        // Across n to the last digit.
        let along = dot(&e2, &n);
        let (e2, ..) = direction(&std::array::from_fn(|k| e2[k] - along * n[k]))?;
        let frame = [cross(&e2, &n), e2, n];
        let over = moments.map(|moment| DoubleDouble::from(1.0) / moment);
        // The inverse moments less the middle one.
        let excess = [(i2 - i1) * over[0] * over[1], (i2 - i3) * over[2] * over[1]];
        let element = |i: usize, j: usize| {
            let (a, b): (Vector, Vector) = (frame[i], frame[j]);
            length * (excess[0] * (a[0] * b[0]) + excess[1] * (a[2] * b[2]))
        };
        let third = element(2, 2);
        let inner: Vector = std::array::from_fn(|k| rotor[k] * over[k]);
        let shift = dot(&frame[2], &inner) - third;
        let second = element(1, 1);
        let matrix = [
            element(0, 0) + shift,
            element(0, 1),
            element(0, 2),
            second + shift,
            element(1, 2),
            third + shift,
        ];
        // ρ = |L × ω|/|L|, a length and its unit apart.
        let across = turning / length;
        let unit = power_below(largest(&matrix).max(across.rounded() * turning_unit));
        Some(Self {
            frame,
            momentum: length,
            across: across.scaled(turning_unit).scaled(1.0 / unit),
            matrix: matrix.map(|x| x.scaled(1.0 / unit)),
            along: dot(&frame[2], omega),
            transverse: length * over[1] + second,
            unit,
        })
    }

    /// The quartic `ẋ² = −¼(1 + 4a₁x + 6a₂x² + 4a₃x³ + a₄x⁴)` of the spinor of n, x = 0 at the start, whose x is in units
    /// of ρ.
    pub(super) fn quartic(&self) -> Quartic {
        Quartic::of(&self.matrix, self.across)
    }
}

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
        let value = a2 - a1.square();
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
        let middle = twice.square() - a4;
        let last = (a1 * middle + first).over(twice);
        let spread = (middle.square() + (first * last).scaled(4.0)).sqrt();
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
            let (first, middle) = (a4 * a1 - twice * a3, twice.square() - a4);
            let last = (a1 * middle + first).over(twice);
            let rest = first + middle * far - last * far.square();
            assert!(rest.size() < 1e-28, "{root} {rest:?}");
            // The product of both is −first/last.
            assert!(far.square().size() <= first.over(last).size(), "{root}");
        }
    }
}
