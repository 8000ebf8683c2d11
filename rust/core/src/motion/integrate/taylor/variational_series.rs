//! The series of one motion in numbers with derivatives.
//!
//! Series of such numbers obey the same recurrences as those of plain ones, and what comes out are the series of the motion and
//! of the linearised equations, with all that depends on the varied numbers. Steps are as long as the series of both allow.

use super::batch::Batch;
use super::pace::ConvergenceRadius;
use super::row::VariedCoefficients;
use super::series::{Coefficient, Series};
use super::step::increment;
use crate::motion::loads::variables::{Varied, WIDTH};
use crate::numerics::dispatch::{Kernel, dispatch};
use crate::numerics::lane::Lane;

type One = Batch<Varied, 1>;

/// One motion with its derivatives: the rows of ω, of (x, y, z, w), of each direction.
pub(super) struct VariationalSeries<const B: usize> {
    w: [VariedCoefficients; 3],
    q: [VariedCoefficients; 4],
    g: [[VariedCoefficients; 3]; B],
    /// Of ω, and of the attitude.
    radii: [ConvergenceRadius; 2],
}

/// The sums of products: ω₂ω₃, ω₃ω₁, ω₁ω₂; q∘ω and γ×ω.
pub(super) struct Products<const B: usize> {
    spins: [Varied; 3],
    turned: [Varied; 4],
    crossed: [[Varied; 3]; B],
}

impl<const B: usize> Series<One, B> for VariationalSeries<B> {
    fn new() -> Self {
        let row = |_| VariedCoefficients::new();
        Self {
            w: std::array::from_fn(row),
            q: std::array::from_fn(row),
            g: std::array::from_fn(|_| std::array::from_fn(row)),
            radii: [ConvergenceRadius::default(); 2],
        }
    }

    fn start(&mut self, state: &Coefficient<One, B>) {
        let rows = (self.w.iter_mut()).chain(&mut self.q);
        let rows = rows.chain(self.g.as_flattened_mut());
        let numbers = state.w.iter().chain(&state.q);
        for (row, Batch([number])) in rows.zip(numbers.chain(state.g.as_flattened())) {
            row.set(0, number, 1.0);
        }
    }

    fn limit(&mut self, steps: &mut [f64]) {
        let [of_omega, of_attitude] = &mut self.radii;
        let longest = [
            of_omega.longest_step(&self.w),
            of_attitude.longest_step(&self.q),
        ];
        for h in steps {
            for most in longest {
                // Not a number wherever one of them is not.
                *h = if most >= *h { *h } else { most };
            }
        }
    }

    fn rescale(&mut self, ratio: f64) {
        self.radii[0].rescale(ratio);
    }

    #[inline(always)]
    fn get(&self, k: usize) -> Coefficient<One, B> {
        let ([a, b, c], [x, y, z, s]) = (&self.w, &self.q);
        let at = |row: &VariedCoefficients| Batch([row.get(k)]);
        let mut g = [[Batch::new(0.0); 3]; B];
        for (g, [a, b, c]) in g.iter_mut().zip(&self.g) {
            *g = [at(a), at(b), at(c)];
        }
        Coefficient {
            w: [at(a), at(b), at(c)],
            q: [at(x), at(y), at(z), at(s)],
            g,
        }
    }

    fn increment(&self, order: usize, h: One) -> [One; 7] {
        increment(self, order, h)
    }

    type Sums = Products<B>;

    fn sums(&mut self, k: usize) -> Products<B> {
        dispatch(SumsOfProducts { series: self, k })
    }

    #[inline(always)]
    fn spins(sums: &Products<B>) -> [One; 3] {
        let [x, y, z] = sums.spins;
        [Batch([x]), Batch([y]), Batch([z])]
    }

    #[inline(always)]
    fn extend(&mut self, k: usize, sums: &Products<B>, acceleration: &[One; 3]) {
        let (next, half) = (1.0 / (k + 1) as f64, 0.5 / (k + 1) as f64);
        for (row, Batch([x])) in self.w.iter_mut().zip(acceleration) {
            row.set(k + 1, x, next);
        }
        for (row, x) in self.q.iter_mut().zip(&sums.turned) {
            row.set(k + 1, x, half);
        }
        let crossed = sums.crossed.as_flattened();
        for (row, x) in self.g.as_flattened_mut().iter_mut().zip(crossed) {
            row.set(k + 1, x, next);
        }
    }
}

/// The sums of products of order `k`.
struct SumsOfProducts<'a, const B: usize> {
    series: &'a VariationalSeries<B>,
    k: usize,
}

impl<const B: usize> Kernel for SumsOfProducts<'_, B> {
    type Output = Products<B>;

    #[inline(always)]
    fn run<L: Lane>(self) -> Products<B> {
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
            crossed: [[Varied::constant(0.0); 3]; B],
        };
        for b in 0..B {
            let [i, j, l] = &g[b];
            sums.crossed[b] = [
                product::<L, 2>(k, [(1.0, j, r), (-1.0, l, q)]),
                product::<L, 2>(k, [(1.0, l, p), (-1.0, i, r)]),
                product::<L, 2>(k, [(1.0, i, q), (-1.0, j, p)]),
            ];
        }
        sums
    }
}

/// The coefficient of order `k` of a sum of products of two rows, each with a sign.
#[inline(always)]
fn product<L: Lane, const N: usize>(
    k: usize,
    products: [(f64, &VariedCoefficients, &VariedCoefficients); N],
) -> Varied {
    let mut sum = Varied::constant(0.0);
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
