//! The pencil of energy and momentum: a quartic with real coefficients on the curve of the motion.
//!
//! L is where the quadrics of constant energy and of constant |L| meet. The determinant of the pencil that they span is a
//! quartic of one real number x, and has the invariants of the curve. For every point L where they meet it is
//! `−rᵀ I adj(1 − x I) r` with `r = x L − ω`: a sum of small terms where L is nearly parallel to ω. Here x is counted from
//! where r is across L: `x = (ω_n + y)/|L|`.
//!
//! Next to a separatrix one number decides: the discriminant, in four times the precision. There two zeros of the pencil nearly meet, and all but their difference is known well enough. Between them the pencil is
//! extreme, so that its value there depends little on the place. It is computed from what defines the body: moments, or a
//! tensor whose axes then need not be known.

use nalgebra::Vector3;

use super::start::Start;
use crate::mass::refined::{RefinedPrincipal, Vector};
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::quad_double::QuadDouble;

/// `y⁴ + b₃y³ + b₂y² + b₁y + b₀`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pencil {
    /// `b₀`, `b₁`, `b₂`, `b₃`.
    b: [DoubleDouble; 4],
    /// The sizes of the terms that each is the sum of.
    sizes: [f64; 4],
}

/// The invariants of the motion, with what decides how it looks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Invariants {
    /// `G₂`.
    pub(super) second: DoubleDouble,
    /// `G₃`.
    pub(super) third: DoubleDouble,
    /// `(G₂³ − 27 G₃²)/16`, the discriminant of the pencil.
    pub(super) discriminant: DoubleDouble,
    /// The sizes of the terms that the discriminant is the sum of.
    pub(super) terms: f64,
    /// Whether all three roots are equal: `G₂` and `G₃` are nothing beside their terms.
    pub(super) is_cusp: bool,
}

/// The value of the pencil where it is extreme between two zeros that are about to meet.
#[derive(Clone, Copy, Debug)]
pub(super) struct PencilValue {
    pub(super) value: DoubleDouble,
    /// The sizes of the terms that it is the sum of.
    pub(super) terms: f64,
}

/// What inputs that are rounded make of invariants that are zero, and less; of coefficients too, as ρ is near one where they vanish.
const CUSP: f64 = 1e-18;
/// A remnant is zero if it is below this part of its terms.
const NOTHING: f64 = 1e-58;
/// A slope that is zero to twice the precision is below this part of its terms.
const FLAT: f64 = 1e-30;
/// Steps of Newton's method: each doubles the digits.
const STEPS: usize = 3;

fn number(x: f64) -> DoubleDouble {
    x.into()
}

impl Pencil {
    pub(super) fn of(start: &Start) -> Self {
        let [b11, b12, b13, b22, b23, b33] = start.matrix;
        let rho = start.across;
        let (m11, m13) = (b22 * b33 - b23 * b23, b12 * b23 - b13 * b22);
        let m33 = b11 * b22 - b12 * b12;
        let [s11, s12, s13, s22, s23, s33] = start.matrix.map(|x| x.high.abs());
        let s = rho.high;
        Self {
            b: [
                rho * rho * m11,
                -(rho * (m13.scaled(2.0) + rho * (b22 + b33))),
                m33 - rho * (b13.scaled(2.0) - rho),
                -(b11 + b22),
            ],
            sizes: [
                s * s * (s22 * s33 + s23 * s23),
                s * (2.0 * (s12 * s23 + s13 * s22) + s * (s22 + s33)),
                s11 * s22 + s12 * s12 + s * (2.0 * s13 + s),
                s11 + s22,
            ],
        }
    }

    /// With `I = 12b₀ − 3b₁b₃ + b₂²` and `J = 72b₀b₂ + 9b₁b₂b₃ − 27(b₁² + b₀b₃²) − 2b₂³`: `G₂ = 4I/3`, `G₃ = 4J/27`.
    pub(super) fn invariants(&self) -> Invariants {
        let [b0, b1, b2, b3] = self.b;
        let (twice, square) = (b0.scaled(2.0), b2 * b2);
        let cross = b1 * b3;
        let (slope, bend) = (b1 * b1, b0 * (b3 * b3));
        let second = number(3.0) * (twice.scaled(2.0) - cross) + square;
        let third = number(9.0) * (b2 * (twice.scaled(4.0) + cross) - number(3.0) * (slope + bend))
            - (b2 * square).scaled(2.0);
        let [s0, s1, s2, s3] = self.b.map(|x| x.high.abs());
        let second_terms = 12.0 * s0 + 3.0 * s1 * s3 + s2 * s2;
        let third_terms = 72.0 * s0 * s2
            + 9.0 * s1 * s2 * s3
            + 27.0 * (s1 * s1 + s0 * s3 * s3)
            + 2.0 * s2.powi(3);
        let (discriminant, terms) = self.discriminant();
        Invariants {
            is_cusp: s0.max(s1).max(s2) <= CUSP
                || second.high.abs() <= CUSP * second_terms
                    && third.high.abs() <= CUSP * third_terms,
            second: second.scaled(4.0) / number(3.0),
            third: third.scaled(4.0) / number(27.0),
            discriminant,
            terms,
        }
    }

    /// The discriminant and the sizes of its terms, of which none is one of `b₂` and `b₃` alone: where ρ is tiny it keeps its
    /// digits.
    fn discriminant(&self) -> (DoubleDouble, f64) {
        let [b0, b1, b2, b3] = self.b;
        let (square, slope, bend) = (b2 * b2, b1 * b1, b0 * (b3 * b3));
        let (product, cross) = (b0 * b2, b1 * b3);
        let p = b0.scaled(4.0) - cross;
        let r = product.scaled(8.0) + cross * b2 - number(3.0) * (slope + bend);
        let lowest = product.scaled(4.0) - slope - bend;
        let sum = p * p * (p + square) + square * b2 * lowest;
        let [s0, s1, s2, s3] = self.sizes;
        let sp = 4.0 * s0 + s1 * s3;
        let s_slope = s1 * s1 + s0 * s3 * s3;
        let sr = 8.0 * s0 * s2 + s1 * s2 * s3 + 3.0 * s_slope;
        let s_sum = sp * sp * (sp + s2 * s2) + s2.powi(3) * (4.0 * s0 * s2 + s_slope);
        (
            sum.scaled(4.0) - number(3.0) * (r * r),
            4.0 * s_sum + 3.0 * sr * sr,
        )
    }

    /// Where it is extreme between the two zeros that are about to meet; `root` is the root that stands apart of
    /// `4E³ − G₂E + G₃ = 0`.
    ///
    /// With `y = z − ¼b₃` the quartic is `z⁴ + pz² + qz + …`, and the double zero is `z = q/(2θ)`, `θ = −½E − ⅔p`.
    pub(super) fn meeting_point(&self, root: f64) -> DoubleDouble {
        let [_, b1, b2, b3] = self.b;
        let [c1, c2, c3] = [b1, b2, b3].map(DoubleDouble::rounded);
        let p = c2 - 0.375 * c3 * c3;
        let q = c1 - 0.5 * c3 * (c2 - 0.25 * c3 * c3);
        let mut y = number(-q / (root + 4.0 / 3.0 * p) - 0.25 * c3);
        for _ in 0..STEPS {
            let slope = b1 + y * (b2.scaled(2.0) + y * (number(3.0) * b3 + y.scaled(4.0)));
            let bend = 2.0 * c2 + y.high * (6.0 * c3 + 12.0 * y.high);
            y -= number(slope.high / bend);
        }
        y
    }

    /// The discriminant from what is left of the quartic at the place y where two zeros meet.
    pub(super) fn discriminant_of(&self, y: DoubleDouble, left: PencilValue) -> DoubleDouble {
        let [_, b1, b2, b3] = self.b;
        let six = number(6.0) * y;
        let steep = y * (b2.scaled(2.0) + y * (number(3.0) * b3 + y.scaled(4.0)));
        let there = Self {
            b: [
                left.value,
                b1 + steep,
                b2 + y * (number(3.0) * b3 + six),
                b3 + y.scaled(4.0),
            ],
            ..*self
        };
        let [b0, b1, b2, _] = there.b.map(DoubleDouble::rounded);
        let flat = FLAT * (self.b[1].high.abs() + steep.high.abs());
        if (4.0 * b0 * b2 - b1 * b1).abs() <= 4.0 * NOTHING * left.terms * b2.abs() + flat * flat {
            return DoubleDouble::default();
        }
        there.discriminant().0
    }
}

type QuadVector = [QuadDouble; 3];

/// Moments, or the rows of a tensor.
enum Inertia {
    Moments(QuadVector),
    Tensor([QuadVector; 3]),
}

/// The pencil of a body, ω and h (in B) at y, in the units of the start; `unit` is that of the moments.
pub(super) fn value_near_separatrix(
    principal: &RefinedPrincipal,
    unit: f64,
    omega: &Vector3<f64>,
    rotor: &Vector,
    start: &Start,
    y: DoubleDouble,
) -> PencilValue {
    let omega = [omega.x, omega.y, omega.z].map(QuadDouble::from);
    let rotor = rotor.map(QuadDouble::from);
    let (inertia, omega, rotor) = if let Some(rows) = principal.tensor() {
        let rows = rows.map(|row| row.map(|x| x.scaled(unit)));
        (Inertia::Tensor(rows), omega, rotor)
    } else {
        let finest = principal.finest();
        (
            Inertia::Moments(finest.moments.map(|moment| moment.scaled(unit))),
            finest.components(&omega),
            finest.components(&rotor),
        )
    };
    let turned = inertia.times(&omega);
    let momentum: QuadVector = std::array::from_fn(|k| turned[k] + rotor[k]);
    let length = start.momentum;
    // x from that place whose r is across L, which is known to twice the precision alone.
    let mut x = QuadDouble::from(start.along / length);
    let across: QuadVector = std::array::from_fn(|k| x * momentum[k] - omega[k]);
    let beside = dot(&momentum, &across).twofold() / length;
    let step = QuadDouble::from((y.scaled(start.unit) - beside) / length);
    x = x + step;
    let r: QuadVector = std::array::from_fn(|k| across[k] + step * momentum[k]);
    let (value, terms) = inertia.form(x, &r);
    let [i1, i2, i3] = principal.moments.map(|moment| moment.scaled(unit));
    // The pencil of the start has the determinant of 1/I in it, and a unit for each zero.
    let scale = length * length / (i1 * i2 * i3);
    let power = start.unit.powi(-4);
    PencilValue {
        value: (value.twofold() * scale).scaled(power),
        terms: terms * scale.high * power,
    }
}

impl Inertia {
    /// `I v`.
    fn times(&self, v: &QuadVector) -> QuadVector {
        match self {
            Self::Moments(moments) => std::array::from_fn(|k| moments[k] * v[k]),
            Self::Tensor(rows) => rows.map(|row| dot(&row, v)),
        }
    }

    /// `rᵀ I adj(1 − x I) r`, and the sizes of its terms.
    fn form(&self, x: QuadDouble, r: &QuadVector) -> (QuadDouble, f64) {
        let one = QuadDouble::from(1.0);
        let image = self.times(r);
        match self {
            Self::Moments(moments) => {
                let u = moments.map(|moment| one - x * moment);
                let parts: QuadVector =
                    std::array::from_fn(|k| image[k] * r[k] * (u[(k + 1) % 3] * u[(k + 2) % 3]));
                (parts[0] + parts[1] + parts[2], sizes(&parts))
            }
            Self::Tensor(rows) => {
                let element = |i: usize, j: usize| {
                    let part = x * rows[i][j];
                    if i == j { one - part } else { -part }
                };
                let [u11, u22, u33] = [0, 1, 2].map(|k| element(k, k));
                let [u12, u23, u13] = [(0, 1), (1, 2), (0, 2)].map(|(i, j)| element(i, j));
                let [c12, c13, c23] = [
                    u13 * u23 - u12 * u33,
                    u12 * u23 - u13 * u22,
                    u12 * u13 - u11 * u23,
                ];
                let adjugate = [
                    [u22 * u33 - u23 * u23, c12, c13],
                    [c12, u11 * u33 - u13 * u13, c23],
                    [c13, c23, u11 * u22 - u12 * u12],
                ];
                let largest = sizes(&[u11, u22, u33]).max(sizes(&[u12, u23, u13]));
                (
                    dot(&image, &adjugate.map(|row| dot(&row, r))),
                    sizes(&image) * sizes(r) * largest * largest,
                )
            }
        }
    }
}

fn dot(a: &QuadVector, b: &QuadVector) -> QuadDouble {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn sizes(v: &QuadVector) -> f64 {
    v.iter().map(|x| x.rounded().abs()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `(y − y₁)(y − y₂)(y − y₃)(y − y₄)`.
    fn with_zeros(y: [f64; 4]) -> Pencil {
        let [p, q, r, s] = y.map(DoubleDouble::from);
        let (sum, product, other, both) = (p + q, p * q, r + s, r * s);
        let b = [
            product * both,
            -(product * other + sum * both),
            product + both + sum * other,
            -(sum + other),
        ];
        let sizes = b.map(|x| x.high.abs());
        Pencil { b, sizes }
    }

    #[test]
    fn invariants_are_those_of_differences_of_zeros() {
        for zeros in [
            [0.3, -1.2, 2.5, 0.7],
            [1.0, 1.0, 3.0, -0.5],
            [0.0, 1e-9, 2e-9, 1.0],
        ] {
            let found = with_zeros(zeros).invariants();
            let [p, q, r, s] = zeros;
            // E′ − E″ = (p − q)(r − s), and so on.
            let [a, b, c] = [(p - q) * (r - s), (p - r) * (s - q), (p - s) * (q - r)];
            let second = 2.0 / 3.0 * (a * a + b * b + c * c);
            let third = 4.0 / 27.0 * (a - b) * (b - c) * (c - a);
            let discriminant = (a * b * c).powi(2);
            assert!(
                (found.second.high - second).abs() <= 1e-14 * second,
                "{zeros:?}"
            );
            assert!(
                (found.third.high - third).abs() <= 1e-13 * second.powf(1.5),
                "{zeros:?}"
            );
            let rest = (found.discriminant.high - discriminant).abs();
            assert!(
                rest <= 1e-13 * discriminant + 1e-30 * found.terms,
                "{zeros:?} {rest:e}"
            );
        }
    }

    #[test]
    fn zeros_that_meet_are_found_and_their_discriminant() {
        for gap in [1e-9, 1e-14, 1e-20] {
            let pencil = with_zeros([0.4, 0.4, 1.5, -2.25]);
            let invariants = pencil.invariants();
            // Of a double root E and E of 4E³ − G₂E + G₃ the third one is −2E.
            let apart = (invariants.second.high / 3.0).sqrt() * -invariants.third.high.signum();
            let y = pencil.meeting_point(apart);
            assert!((y - 0.4.into()).rounded().abs() < 1e-30, "{y:?}");
            // Zeros at 0.4 ± ½ gap.
            let others = -(1.1 * 2.65);
            let left = PencilValue {
                value: number(-0.25 * gap * gap * others),
                terms: 1.0,
            };
            let exact = (gap * 1.1 * 1.1 * 2.65 * 2.65 * 3.75).powi(2);
            let found = pencil.discriminant_of(y, left).rounded();
            assert!(
                (found / exact - 1.0).abs() < 1e-8,
                "{gap} {found:e} {exact:e}"
            );
        }
        let pencil = with_zeros([0.4, 0.4, 1.5, -2.25]);
        let left = PencilValue {
            value: number(1e-59),
            terms: 1.0,
        };
        assert_eq!(
            pencil.discriminant_of(0.4.into(), left),
            DoubleDouble::default()
        );
    }
}
