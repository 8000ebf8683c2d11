//! The products of the two theta functions as series of their own.
//!
//! Where Z moves in a circle, with `Z₀ = |Z₀| e^{iφ}`, `w = e^{i(θ + φ)}` and `p = |y|²`, y and `Θₒ/Z₀` as in `spinor.rs`:
//!
//! ```text
//! |Θₑ|²           = T A + (Q/|y|) U B         A = Σ Q^{2m²} w^{4m}         T = Σ Q^{2j²} p^{−j}
//! |Θₒ/Z₀|²        = U A + |y| T B             B = Σ Q^{2m²+2m} w^{4m+2}    U = Σ Q^{2j²+2j} p^{−j}
//! e^{iφ} Θ̄ₑΘₒ/Z₀  = (V + W) C + i (V − W) S   E = Σ Q^{2m²+m} w^{4m+1}     V = Σ Q^{2j²+j} p^{−j}   W = |y| Σ Q^{2j²+j} p^j
//! ```
//!
//! with real and imaginary part of the powers of E in C and S. Where `Z = e^{θ + iφ}` goes as the exponential of the time:
//!
//! ```text
//! |Θₑ|² = T A + Q U B    A = Σ Q^{2m²} e^{4mθ}         T = Σ Q^{2j²} cos 4jφ
//! |Θₒ|² = U A + T B      B = Σ Q^{2m²+2m} e^{(4m+2)θ}  U = Σ Q^{2j²+2j} cos (4j+2)φ
//! Θ̄ₑΘₒ  = V C + i W S    E = Σ Q^{2m²+m} e^{(4m+1)θ}   V = Σ Q^{2j²+j} cos (4j+1)φ    W = Σ Q^{2j²+j} sin (4j+1)φ
//! ```
//!
//! with `C = E(θ) + E(−θ)`, `S = E(θ) − E(−θ)`. What is a sum of A, B, C, S has no much larger coefficients than it becomes large
//! itself. As a sum of products of `Θₑ` and `Θₒ` it may be far smaller than its terms: a slender body turns fast about its axis
//! while L is nearly across it, and each rounding of the terms counts as many times as its moments are apart.

use nalgebra::UnitQuaternion;

use super::spinor::Spinor;
use super::start::Start;
use super::theta_series::{CircularProducts, HyperbolicProducts};
use crate::mass::refined::{RefinedPrincipal, Vector};
use crate::numerics::complex::Complex;
use crate::numerics::double_double::DoubleDouble;

type Number = Complex<DoubleDouble>;

/// Below this |y| its powers are beyond twice the precision, and so are those of `Q/|y|`.
const NO_RATIO: f64 = 1e-40;
/// Series of their own are for products that lose so many times as many digits.
const GAIN: f64 = 8.0;
/// Terms below this part are left out.
const SMALL: f64 = 1e-33;
/// The most terms on each side.
const TERMS: usize = 6;

/// What stands before the series, and where they begin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ratios {
    nome: f64,
    /// `e^{iφ}`.
    turn: Number,
    /// Whether the product of both functions has it more.
    is_turned: bool,
    /// Of T and U before A.
    first: [DoubleDouble; 2],
    /// Of U and T before B.
    second: [DoubleDouble; 2],
    /// Before C and S.
    mixed: [DoubleDouble; 2],
    /// What A, B, C, S and the two squares and the parts of the product are made of, in the middle of the passage, where D is
    /// least, or at the start.
    sizes: [f64; 4],
    sizes_of_products: [f64; 4],
}

impl Ratios {
    /// Where Z moves in a circle.
    pub(super) fn by_sines(spinor: &Spinor) -> Self {
        let (zero, one) = (DoubleDouble::default(), DoubleDouble::from(1.0));
        let q = spinor.nome;
        if spinor.start.taxicab() < NO_RATIO {
            return Self {
                nome: q.high,
                turn: Complex::one(),
                is_turned: false,
                first: [one, one],
                second: [zero, zero],
                mixed: [one, one],
                sizes: IN_A_CIRCLE,
                sizes_of_products: [1.0; 4],
            };
        }
        let size = spinor.start.norm_squared().sqrt();
        let over = one / size;
        let (p, next) = (size * size, q * over);
        let (far, q2) = (next * over, q * q);
        let (step, less) = (q2 * q2, q * far);
        let t = sum(less, q2 * p, step);
        let u = sum(less * q2, p, step);
        let v = sum(less * q, q * p, step);
        let w = sum(q2 * q * p, far, step) * size;
        Self {
            nome: q.high,
            turn: spinor.argument.times(size.sqrt()),
            is_turned: true,
            first: [t, u],
            second: [next * u, size * t],
            mixed: [v + w, v - w],
            sizes: IN_A_CIRCLE,
            sizes_of_products: products_of(1.0 + size.high),
        }
    }

    /// Where Z goes as the exponential of the time.
    pub(super) fn by_exponentials(spinor: &Spinor) -> Self {
        let q = spinor.nome;
        let z = spinor.argument;
        let turn = z.times(DoubleDouble::from(1.0) / z.norm_squared().sqrt());
        let square = turn.square();
        let (mut power, mut weight, mut step) = (turn, DoubleDouble::from(1.0), q);
        // Of `cos nφ`, n even, `cos nφ` and `sin nφ`, n odd: `Q^{(n² − 1)/8}` is before the latter, n = 1, 3, ….
        let (mut v, mut w) = (DoubleDouble::default(), DoubleDouble::default());
        let mut sign = 1.0;
        for _ in 0..TERMS {
            v += power.re * weight;
            w += power.im * weight.scaled(sign);
            if weight.high.abs() < SMALL {
                break;
            }
            weight *= step;
            step *= q;
            power = power * square;
            sign = -sign;
        }
        // n = 4, 8, … of T and n = 2, 6, … of U: from one to the next in both the weight grows by `Q^{2n}`.
        let (q2, fourth) = (q * q, square.square());
        let step = q2 * q2;
        let series = |mut sum: DoubleDouble,
                      mut power: Number,
                      mut weight: DoubleDouble,
                      mut ratio: DoubleDouble| {
            for _ in 0..TERMS {
                sum += (power.re * weight).scaled(2.0);
                if weight.high.abs() < SMALL {
                    break;
                }
                weight *= ratio;
                ratio *= step;
                power = power * fourth;
            }
            sum
        };
        let t = series(1.0.into(), fourth, q2, q2 * step);
        let u = series(0.0.into(), square, 1.0.into(), step);
        Self {
            nome: q.high,
            turn,
            is_turned: false,
            first: [t, u],
            second: [q * u, t],
            mixed: [v, w],
            sizes: [1.0, 2.0, 2.0, 1.0],
            sizes_of_products: products_of(2.0 * turn.re.high.abs()),
        }
    }

    /// From what stands before the squares of both functions and before twice their product, of which the real part counts, to
    /// what stands before A, B, C, S.
    pub(super) fn before(
        &self,
        [even, odd]: [DoubleDouble; 2],
        mixed: Number,
    ) -> [DoubleDouble; 4] {
        let ([t, u], [next_u, size_t]) = (self.first, self.second);
        let [cosines, sines] = self.mixed;
        let mixed = if self.is_turned {
            mixed * self.turn.conjugate()
        } else {
            mixed
        };
        [
            even * t + odd * u,
            even * next_u + odd * size_t,
            (mixed.re * cosines).scaled(2.0),
            -(mixed.im * sines).scaled(2.0),
        ]
    }

    /// Whether far fewer digits are lost where ω is summed by A, B, C, S than by the squares and the product of both functions.
    pub(super) fn are_better(&self, apart: &[[f64; 3]; 4], plain: &[[f64; 3]; 4]) -> bool {
        let largest = |rows: &[[f64; 3]; 4], sizes: &[f64; 4]| {
            let terms = |i: usize| (0..4).map(|k| rows[k][i].abs() * sizes[k]).sum();
            [0, 1, 2].map(terms).into_iter().fold(0.0, f64::max)
        };
        GAIN * largest(apart, &self.sizes) < largest(plain, &self.sizes_of_products)
    }

    /// A, B, C, S by sines and cosines.
    pub(super) fn sines(&self) -> CircularProducts {
        let q = self.nome;
        let turn = Complex::new(self.turn.re.high, self.turn.im.high);
        let mut powers = [Complex::<f64>::one(); 10];
        for n in 1..powers.len() {
            powers[n] = powers[n - 1] * turn;
        }
        // Of cos nθ and sin nθ in cos n(θ + φ) and in sin n(θ + φ).
        let cosine = |n: usize, weight: f64| [powers[n].re * weight, -powers[n].im * weight];
        let sine = |n: usize, weight: f64| [powers[n].im * weight, powers[n].re * weight];
        let weights = [1.0, q, q.powi(3), q.powi(6), q.powi(10)];
        CircularProducts {
            first: [cosine(4, 2.0 * q.powi(2)), cosine(8, 2.0 * q.powi(8))],
            second: [cosine(2, 2.0), cosine(6, 2.0 * q.powi(4))],
            cosines: std::array::from_fn(|k| cosine(2 * k + 1, weights[k])),
            sines: std::array::from_fn(|k| sine(2 * k + 1, sign(k) * weights[k])),
        }
    }

    /// A, B, C, S by exponentials; whether Q is negative is known even where it is zero.
    pub(super) fn exponentials(&self, is_alternating: bool) -> HyperbolicProducts {
        let q = self.nome.abs();
        let odd = |k: usize| {
            let n = k * (k + 1) / 2;
            let weight = [1.0, 1.0, q, q.powi(3), q.powi(6), q.powi(10)][k];
            let weight = if is_alternating {
                sign(n) * weight
            } else {
                weight
            };
            [weight, sign(k) * weight]
        };
        HyperbolicProducts {
            even: [1.0, 1.0, q.powi(2), q.powi(4), q.powi(8)],
            odd: std::array::from_fn(odd),
        }
    }
}

/// Of A, B, C, S where Z moves in a circle.
const IN_A_CIRCLE: [f64; 4] = [1.0, 2.0, 1.0, 1.0];

/// The sizes of what the squares and the product are made of, where `Θₑ` is one and `Θₒ` as large as that.
fn products_of(odd: f64) -> [f64; 4] {
    [1.0, odd * odd, odd, odd]
}

/// `(−1)^n`.
fn sign(n: usize) -> f64 {
    if n.is_multiple_of(2) { 1.0 } else { -1.0 }
}

/// `Σ t_j` over all integers, `t₀ = 1`: `up = t₁/t₀` and `down = t₋₁/t₀` are the first ratios, and from one to the next they
/// grow by `step`.
fn sum(up: DoubleDouble, down: DoubleDouble, step: DoubleDouble) -> DoubleDouble {
    let mut sum = DoubleDouble::from(1.0);
    for mut ratio in [up, down] {
        let mut term = ratio;
        for _ in 0..TERMS {
            sum += term;
            if term.high.abs() < SMALL {
                break;
            }
            ratio *= step;
            term *= ratio;
        }
    }
    sum
}

/// What a motion is made from, in the units of the start.
pub(super) struct GyrostatStart<'a> {
    /// Principal moments.
    pub(super) moments: &'a Vector,
    /// h along the principal axes.
    pub(super) rotor: &'a Vector,
    pub(super) principal: &'a RefinedPrincipal,
    pub(super) attitude: &'a UnitQuaternion<f64>,
}

/// Moments that are further apart than that are those of a slender body.
const SLENDER: f64 = 16.0;

impl GyrostatStart<'_> {
    /// Whether roundings of the products may count for more than others: as many times as the moments are apart.
    pub(super) fn is_slender(&self) -> bool {
        SLENDER * self.moments[0].high < self.moments[2].high
    }
}

/// `u†σu`, `v†σv`, `u†σv` of both columns, with `u†u` and so on as the fourth of each.
pub(super) struct Squares {
    even: [Number; 4],
    odd: [Number; 4],
    mixed: [Number; 4],
}

pub(super) fn squares([u, v]: &[[Number; 2]; 2]) -> Squares {
    let product = |u: &[Number; 2], v: &[Number; 2]| {
        let [a, b] = u.map(Complex::conjugate);
        let (ab, ba) = (a * v[1], b * v[0]);
        let (aa, bb) = (a * v[0], b * v[1]);
        [ab + ba, (ba - ab).times_i(), aa - bb, aa + bb]
    };
    Squares {
        even: product(u, u),
        odd: product(v, v),
        mixed: product(u, v),
    }
}

/// From the products of the two theta functions to D ω: `ω_i = (|L| n_i − h_i)/I_i` along the principal axes, `D n = χ†σχ`. The
/// products are the four series of `ratios` where they are given.
pub(super) fn omega(
    given: &GyrostatStart<'_>,
    start: &Start,
    squares: &Squares,
    ratios: Option<&Ratios>,
) -> [[f64; 3]; 4] {
    // 2 Re (Θ̄ₑΘₒ u†σv).
    let parts: [[DoubleDouble; 4]; 4] = std::array::from_fn(|k| {
        let (both, mixed) = ([squares.even[k].re, squares.odd[k].re], squares.mixed[k]);
        match ratios {
            Some(ratios) => ratios.before(both, mixed),
            None => [
                both[0],
                both[1],
                mixed.re.scaled(2.0),
                -mixed.im.scaled(2.0),
            ],
        }
    });
    std::array::from_fn(|row| {
        let [x, y, z, square] = parts.map(|part| part[row]);
        let along: Vector = std::array::from_fn(|i| {
            let [e1, e2, n] = start.frame.map(|axis| axis[i]);
            let sum = start.momentum * (x * e1 + y * e2 + z * n) - given.rotor[i] * square;
            sum / given.moments[i]
        });
        given.principal.in_body(&along).map(DoubleDouble::rounded)
    })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::motion::gyrostat::spinor::Regime;
    use crate::motion::gyrostat::theta_series::{Circular, Hyperbolic, ThetaSeries, WithProducts};
    use crate::numerics::lane::{BASELINE, Double, Lane};

    /// A spinor that has nothing but a nome and a start.
    fn spinor(nome: f64, size: f64, angle: f64) -> Spinor {
        let number = |re: f64, im: f64| Number::new(re.into(), im.into());
        let (sine, cosine) = angle.sin_cos();
        let argument =
            number(cosine, sine).times(DoubleDouble::from(1.0) / DoubleDouble::from(size).sqrt());
        Spinor {
            regime: Regime::Circular,
            nome: nome.into(),
            is_alternating: nome < 0.0,
            rate: 1.0.into(),
            sense: 1.0,
            start: Complex::<DoubleDouble>::one().over(argument.square()),
            argument,
            columns: [[Complex::zero(); 2]; 2],
            phase: 0.0.into(),
            in_time: None,
        }
    }

    fn rounded(z: Number) -> Complex<f64> {
        Complex::new(z.re.high, z.im.high)
    }

    /// Both theta functions term by term, `Z/Z₀` given.
    fn thetas(spinor: &Spinor, moved: Complex<f64>) -> [Complex<f64>; 2] {
        let q = spinor.nome.high;
        let power = |z: Complex<f64>, n: i32| {
            let z = if n < 0 { Complex::one().over(z) } else { z };
            (0..n.abs()).fold(Complex::one(), |product, _| product * z)
        };
        let z = rounded(spinor.argument) * moved;
        let (mut even, mut odd) = (Complex::zero(), Complex::zero());
        for j in -5..=5 {
            even = even + power(z, 2 * j).times(q.powi(j * j));
            odd = odd + power(z, 2 * j + 1).times(q.powi(j * j + j));
        }
        [even, odd]
    }

    /// That the four products are what both functions, one by one, give.
    fn check(what: &str, ratios: &Ratios, series: [f64; 4], functions: [Complex<f64>; 2]) {
        let [even, odd] = functions;
        let mixed = even.conjugate() * odd;
        let of = |even: f64, odd: f64, mixed: [f64; 2]| {
            let mixed = Number::new(mixed[0].into(), mixed[1].into());
            let before = ratios.before([even.into(), odd.into()], mixed);
            (before.iter().zip(series)).fold(0.0, |sum, (x, y)| sum + x.high * y)
        };
        let pairs = [
            (of(1.0, 0.0, [0.0; 2]), even.norm_squared()),
            (of(0.0, 1.0, [0.0; 2]), odd.norm_squared()),
            (of(0.0, 0.0, [0.5, 0.0]), mixed.re),
            (of(0.0, 0.0, [0.0, -0.5]), mixed.im),
        ];
        let large = even.norm_squared() + odd.norm_squared();
        for (found, expected) in pairs {
            assert!(
                (found - expected).abs() < 4e-15 * large,
                "{what}: {found} {expected}"
            );
        }
    }

    #[test]
    fn products_where_z_moves_in_a_circle() {
        // The largest nome of either sign, a small one, none; the least start of each and larger ones; a start beyond all digits.
        for (nome, size) in [
            (-0.0432, 0.208),
            (-0.0432, 1.0),
            (0.0018, 0.0425),
            (0.0018, 0.7),
            (1e-20, 1e-10),
            (1e-20, 0.3),
            (0.0, 0.2),
            (0.0, 1e-39),
            (0.0, 1e-41),
        ] {
            let spinor = spinor(nome, size, 0.7);
            let ratios = Ratios::by_sines(&spinor);
            let series = WithProducts {
                functions: Circular {
                    even: [[0.0; 4]; 3],
                    odd: [[0.0; 4]; 4],
                },
                products: ratios.sines(),
            };
            for theta in [0.0, 0.4, 1.9, -2.5] {
                let x = [theta / TAU, 0.0, 1.0].map(Double::<BASELINE>::new);
                let products = series.values(x[0], x[1], x[2]).products.map(Lane::get);
                let (sine, cosine) = f64::sin_cos(theta);
                let [even, odd] = thetas(&spinor, Complex::new(cosine, sine));
                let z = rounded(spinor.argument);
                let what = format!("{nome} {size} {theta}");
                check(&what, &ratios, products, [even, odd.over(z)]);
            }
        }
    }

    #[test]
    fn products_where_z_goes_as_an_exponential() {
        for nome in [-0.0432, 0.0018, -1e-6, 1e-12] {
            let spinor = spinor(nome, 1.0, 0.7);
            let ratios = Ratios::by_exponentials(&spinor);
            let end = -0.5 * nome.abs().ln();
            let series = WithProducts {
                functions: Hyperbolic {
                    even: [[0.0; 2]; 3],
                    odd: [[0.0; 2]; 4],
                    unit: 2.0 * end,
                    end,
                },
                products: ratios.exponentials(nome < 0.0),
            };
            for x in [0.0, 0.1, 0.3, 0.5, -0.25, -0.5] {
                for turned in [1.0, -1.0] {
                    let numbers = [x, 0.0, turned].map(Double::<BASELINE>::new);
                    let values = series.values(numbers[0], numbers[1], numbers[2]);
                    let products = values.products.map(Lane::get);
                    // Over e^{|θ|}.
                    let (theta, size) = (2.0 * end * x, (-(2.0 * end * x).abs()).exp());
                    let functions = thetas(&spinor, Complex::new(theta.exp(), 0.0));
                    let functions = [functions[0].times(size), functions[1].times(size * turned)];
                    check(&format!("{nome} {x}"), &ratios, products, functions);
                }
            }
        }
    }
}
