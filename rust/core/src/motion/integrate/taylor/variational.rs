//! The series of one motion in numbers with derivatives.
//!
//! Numbers with derivatives obey the same recursion as plain ones. The result is the series of the motion together with the series
//! of the variational equations. Steps are as long as both allow.

use super::batch::Batch;
use super::series::{AnyNumber, Coefficient, Coefficients, is_unused};
use crate::motion::loads::variables::{VariationJet, WIDTH};
use crate::numerics::dispatch::{Kernel, dispatch};
use crate::numerics::lane::Lane;

/// The highest order of series with derivatives.
pub(super) const ORDER: usize = 24;

/// The derivatives of one coefficient: a register of the widest machines.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Slopes(pub(super) [f64; WIDTH]);

/// The coefficients of one number of the motion.
#[derive(Clone, Debug)]
pub(super) struct JetCoefficients {
    pub(super) values: [f64; ORDER + 1],
    pub(super) slopes: [Slopes; ORDER + 1],
}

impl JetCoefficients {
    /// Coefficients that are all zero.
    pub(super) const ZERO: Self = Self {
        values: [0.0; ORDER + 1],
        slopes: [Slopes([0.0; WIDTH]); ORDER + 1],
    };

    /// Set the coefficient of order `k`.
    #[inline(always)]
    pub(super) fn set(&mut self, k: usize, number: &VariationJet) {
        self.values[k] = number.value;
        self.slopes[k].0 = number.slopes;
    }

    /// Return the coefficient of order `k`.
    #[inline(always)]
    pub(super) fn get(&self, k: usize) -> VariationJet {
        VariationJet {
            value: self.values[k],
            slopes: self.slopes[k].0,
        }
    }
}

type One = Batch<VariationJet, 1>;

/// The number of directions for which there is room. Those that no torque needs are zero, and their products are left out.
const AXES: usize = 3;

/// The series of one motion with derivatives: of ω, of (x, y, z, w), and of each direction.
pub(super) struct VariationalSeries {
    w: [JetCoefficients; 3],
    q: [JetCoefficients; 4],
    g: [[JetCoefficients; 3]; AXES],
    /// Of ω, and of the attitude.
    radii: [ConvergenceRadius; 2],
}

/// The sums of products: ω₂ω₃, ω₃ω₁, ω₁ω₂; q∘ω and γ×ω.
pub(super) struct Products {
    spins: [VariationJet; 3],
    turned: [VariationJet; 4],
    crossed: [[VariationJet; 3]; AXES],
}

impl Coefficients<One, AXES> for VariationalSeries {
    fn new() -> Self {
        const VECTOR: [JetCoefficients; 3] = [JetCoefficients::ZERO; 3];
        const ZERO: VariationalSeries = VariationalSeries {
            w: VECTOR,
            q: [JetCoefficients::ZERO; 4],
            g: [VECTOR; AXES],
            radii: [ConvergenceRadius::ZERO; 2],
        };
        ZERO
    }

    fn limit(&mut self, steps: &mut [f64]) {
        let [of_omega, of_attitude] = &mut self.radii;
        let longest = [
            of_omega.longest_step(&self.w),
            of_attitude.longest_step(&self.q),
        ];
        for h in steps {
            for most in longest {
                // NaN if one of the two is NaN.
                *h = if most >= *h { *h } else { most };
            }
        }
    }

    fn rescale(&mut self, ratio: f64) {
        self.radii[0].rescale(ratio);
    }

    #[inline(always)]
    fn get(&self, k: usize) -> Coefficient<One, AXES> {
        let ([a, b, c], [x, y, z, s]) = (&self.w, &self.q);
        let at = |row: &JetCoefficients| Batch([row.get(k)]);
        let mut g = [[Batch::new(0.0); 3]; AXES];
        for (g, [a, b, c]) in g.iter_mut().zip(&self.g) {
            *g = [at(a), at(b), at(c)];
        }
        Coefficient {
            w: [at(a), at(b), at(c)],
            q: [at(x), at(y), at(z), at(s)],
            g,
        }
    }

    type Sums = Products;

    fn sums(&mut self, k: usize) -> Products {
        dispatch(SumsOfProducts { series: self, k })
    }

    #[inline(always)]
    fn spins(sums: &Products) -> [One; 3] {
        let [x, y, z] = sums.spins;
        [Batch([x]), Batch([y]), Batch([z])]
    }
}

impl AnyNumber<One, AXES> for VariationalSeries {
    #[inline(always)]
    fn put_omega(&mut self, k: usize, i: usize, Batch([x]): One) {
        self.w[i].set(k, &x);
    }

    #[inline(always)]
    fn put_attitude(&mut self, k: usize, i: usize, Batch([x]): One) {
        self.q[i].set(k, &x);
    }

    #[inline(always)]
    fn put_direction(&mut self, k: usize, b: usize, i: usize, Batch([x]): One) {
        self.g[b][i].set(k, &x);
    }

    #[inline(always)]
    fn attitude_sum(sums: &Products, i: usize) -> One {
        Batch([sums.turned[i]])
    }

    #[inline(always)]
    fn direction_sum(sums: &Products, b: usize, i: usize) -> Option<One> {
        Some(Batch([sums.crossed[b][i]]))
    }
}

/// The sums of products of order `k`.
struct SumsOfProducts<'a> {
    series: &'a VariationalSeries,
    k: usize,
}

impl Kernel for SumsOfProducts<'_> {
    type Output = Products;

    #[inline(always)]
    fn run<L: Lane>(self) -> Products {
        let VariationalSeries {
            w: [p, q, r],
            q: [x, y, z, s],
            g,
            ..
        } = self.series;
        let k = self.k;
        let mut sums = Products {
            spins: [
                product::<L, 1>(k, [(1.0, q, r)]),
                product::<L, 1>(k, [(1.0, r, p)]),
                product::<L, 1>(k, [(1.0, p, q)]),
            ],
            turned: [
                product::<L, 3>(k, [(1.0, s, p), (1.0, y, r), (-1.0, z, q)]),
                product::<L, 3>(k, [(1.0, s, q), (1.0, z, p), (-1.0, x, r)]),
                product::<L, 3>(k, [(1.0, s, r), (1.0, x, q), (-1.0, y, p)]),
                product::<L, 3>(k, [(-1.0, x, p), (-1.0, y, q), (-1.0, z, r)]),
            ],
            crossed: [[VariationJet::constant(0.0); 3]; AXES],
        };
        for b in 0..AXES {
            let [i, j, l] = &g[b];
            if is_unused(&[i.get(0), j.get(0), l.get(0)].map(|x| Batch([x]))) {
                continue;
            }
            sums.crossed[b] = [
                product::<L, 2>(k, [(1.0, j, r), (-1.0, l, q)]),
                product::<L, 2>(k, [(1.0, l, p), (-1.0, i, r)]),
                product::<L, 2>(k, [(1.0, i, q), (-1.0, j, p)]),
            ];
        }
        sums
    }
}

/// Compute the coefficient of order `k` of a sum of products of two series, each with a sign.
#[inline(always)]
fn product<L: Lane, const N: usize>(
    k: usize,
    products: [(f64, &JetCoefficients, &JetCoefficients); N],
) -> VariationJet {
    let mut sum = VariationJet::constant(0.0);
    for (sign, a, b) in products {
        let mut value = L::new(0.0);
        let mut slopes = [L::new(0.0); WIDTH];
        for j in 0..=k {
            let (x, y) = (L::new(a.values[j]), L::new(b.values[k - j]));
            let (by_x, by_y) = (&a.slopes[j].0, &b.slopes[k - j].0);
            value = x.mul_add(y, value);
            for n in 0..WIDTH {
                let more = L::new(by_x[n]).mul_add(y, slopes[n]);
                slopes[n] = x.mul_add(L::new(by_y[n]), more);
            }
        }
        sum.value += sign * value.get();
        for n in 0..WIDTH {
            sum.slopes[n] += sign * slopes[n].get();
        }
    }
    sum
}

/// Size of the last terms of a series, relative to the largest value of the series so far.
const LAST_TERM: f64 = 1e-17;
/// Number of first coefficients from which the size of a derivative within the step is estimated: at the start it may be zero.
const FIRST: usize = 5;
/// Iterations for the step: each reduces the error by a factor of five or more.
const ROUNDS: usize = 4;

/// The largest sizes so far of some numbers and of their derivatives by each variable, which the last terms of their series are
/// compared with.
#[derive(Clone, Copy, Debug)]
pub(super) struct ConvergenceRadius {
    sizes: [f64; WIDTH + 1],
}

impl ConvergenceRadius {
    /// Nothing is known yet.
    pub(super) const ZERO: Self = Self {
        sizes: [0.0; WIDTH + 1],
    };

    /// Change the unit; `ratio` is the old unit over the new one.
    pub(super) fn rescale(&mut self, ratio: f64) {
        self.sizes = self.sizes.map(|size| size * ratio);
    }

    /// Compute the longest step for which the last two terms of the series are small enough. It is infinite if they are zero, and
    /// NaN if one of them is not finite. It is rounded to a few bits, so that it is the same on every machine.
    ///
    /// Terms are compared with the largest size so far or within the step. The latter depends on the step, hence the iteration.
    /// Source: Jorba & Zou, Experimental Mathematics 14 (2005) 99.
    pub(super) fn longest_step(&mut self, rows: &[JetCoefficients]) -> f64 {
        self.longest_step_of(&|k| sizes(rows, k))
    }

    /// Compute [`Self::longest_step`] from the sums of magnitudes of the coefficients of each order.
    pub(super) fn longest_step_of(&mut self, sizes: &dyn Fn(usize) -> [f64; WIDTH + 1]) -> f64 {
        let first: [_; FIRST] = std::array::from_fn(sizes);
        for (most, size) in self.sizes.iter_mut().zip(first[0]) {
            *most = most.max(size);
        }
        let last = [ORDER - 1, ORDER].map(|k| (k, sizes(k)));
        if last
            .iter()
            .any(|(_, sizes)| sizes.iter().any(|size| !size.is_finite()))
        {
            return f64::NAN;
        }
        let mut h = 1.0_f64;
        for _ in 0..ROUNDS {
            let mut exponent = f64::INFINITY;
            for (number, most) in self.sizes.iter().enumerate() {
                let within = first
                    .iter()
                    .rev()
                    .fold(0.0, |sum, sizes| sum * h + sizes[number]);
                for (k, sizes) in &last {
                    let ratio = LAST_TERM * (most.max(within) / sizes[number]);
                    if sizes[number] > 0.0 {
                        exponent = exponent.min(ratio.log2() / *k as f64);
                    }
                }
            }
            h = exponent.exp2();
            if h.is_infinite() {
                break;
            }
        }
        f64::from_bits(h.to_bits() & 0xffff_0000_0000_0000)
    }
}

/// Compute the sums of magnitudes of the coefficients of order `k`: of the values, and of each derivative.
fn sizes(rows: &[JetCoefficients], k: usize) -> [f64; WIDTH + 1] {
    let mut sizes = [0.0; WIDTH + 1];
    for number in rows.iter().map(|row| row.get(k)) {
        let (values, slopes) = sizes.split_at_mut(1);
        values[0] += number.value.abs();
        for (size, slope) in slopes.iter_mut().zip(&number.slopes) {
            *size += slope.abs();
        }
    }
    sizes
}
