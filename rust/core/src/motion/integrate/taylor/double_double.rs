//! The series of one motion in double-double, its components in the lanes.

use super::batch::Batch;
use super::series::{AnyNumber, Coefficient, Coefficients, MAX_COUNT};
use crate::numerics::double_double::two_sum;
use crate::numerics::lane::Lane;
use crate::numerics::number::Number;
use crate::numerics::twofold::Twofold;

type Double<L> = Batch<Twofold<L>, 1>;

/// `W` double-double numbers: high and low parts.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
struct Components<L, const W: usize> {
    high: [L; W],
    low: [L; W],
}

impl<L: Lane, const W: usize> Components<L, W> {
    const ZERO: Self = Self {
        high: [<L as Lane>::ZERO; W],
        low: [<L as Lane>::ZERO; W],
    };

    #[inline(always)]
    fn set(&mut self, i: usize, x: Double<L>) {
        (self.high[i], self.low[i]) = (x.0[0].high, x.0[0].low);
    }

    /// Return one of them. Sums of products are renormalized here.
    #[inline(always)]
    fn get(&self, i: usize) -> Double<L> {
        Batch([Twofold::renormalized(self.high[i], self.low[i])])
    }

    /// Compute `self + a b`; the low parts are added up separately.
    #[inline(always)]
    fn plus_products(mut self, a: &Self, b: &Self) -> Self {
        for i in 0..W {
            let (p, e) = a.high[i].two_product(b.high[i]);
            let e = a.high[i].mul_add(b.low[i], a.low[i].mul_add(b.high[i], e));
            let (s, r) = two_sum(self.high[i], p);
            self.high[i] = s;
            self.low[i] = self.low[i] + (r + e);
        }
        self
    }

    /// Compute `self + a · b` for one number a.
    #[inline(always)]
    fn plus_multiple(self, a: Twofold<L>, b: &Self) -> Self {
        let a = Self {
            high: [a.high; W],
            low: [a.low; W],
        };
        self.plus_products(&a, b)
    }
}

/// One order: `q∘e_n` and `γ×e_n`, the factors of each component of ω in the rates of attitude and directions; and ω.
#[derive(Clone, Copy, Debug)]
struct Order<L, const W: usize> {
    turned: [Components<L, W>; 3],
    w: [Twofold<L>; 3],
    /// (ω₂, ω₃, ω₁) and (ω₃, ω₁, ω₂).
    next_w: Components<L, 4>,
    last_w: Components<L, 4>,
}

impl<L: Lane, const W: usize> Order<L, W> {
    #[inline(always)]
    fn new<const B: usize>(at: &Coefficient<Double<L>, B>) -> Self {
        let zero = Components::ZERO;
        let mut order = Self {
            turned: [zero; 3],
            w: [at.w[0].0[0], at.w[1].0[0], at.w[2].0[0]],
            next_w: Components::ZERO,
            last_w: Components::ZERO,
        };
        let [x, y, z, w] = at.q;
        let turned = [[w, z, -y, -x], [-z, w, x, -y], [y, -x, w, -z]];
        for n in 0..3 {
            let (next, last) = ((n + 1) % 3, (n + 2) % 3);
            for i in 0..4 {
                order.turned[n].set(i, turned[n][i]);
            }
            for (b, g) in at.g.iter().enumerate() {
                order.turned[n].set(4 + 3 * b + next, g[last]);
                order.turned[n].set(4 + 3 * b + last, -g[next]);
            }
            order.next_w.set(n, at.w[next]);
            order.last_w.set(n, at.w[last]);
        }
        order
    }
}

/// The series of one motion; `W` ≥ 4 + 3 `B`.
#[derive(Clone, Debug)]
pub(super) struct DoubleDoubleSeries<L, const B: usize, const W: usize> {
    orders: [Order<L, W>; MAX_COUNT],
    plain: [Coefficient<Double<L>, B>; MAX_COUNT],
}

/// The sums of products of [`DoubleDoubleSeries`]: ω₂ω₃, ω₃ω₁, ω₁ω₂; q∘ω and γ×ω.
pub(super) struct DoubleDoubleSums<L, const W: usize> {
    spins: Components<L, 4>,
    turned: Components<L, W>,
}

impl<L: Lane, const B: usize, const W: usize> DoubleDoubleSeries<L, B, W> {
    const NO_ORDERS: [Order<L, W>; MAX_COUNT] = [Order {
        turned: [Components::ZERO; 3],
        w: [Twofold::ZERO; 3],
        next_w: Components::ZERO,
        last_w: Components::ZERO,
    }; MAX_COUNT];
    const NO_COEFFICIENTS: [Coefficient<Double<L>, B>; MAX_COUNT] = [Coefficient {
        w: [Batch::ZERO; 3],
        q: [Batch::ZERO; 4],
        g: [[Batch::ZERO; 3]; B],
    }; MAX_COUNT];
}

impl<L: Lane, const B: usize, const W: usize> Coefficients<Double<L>, B>
    for DoubleDoubleSeries<L, B, W>
{
    #[inline(always)]
    fn new() -> Self {
        Self {
            orders: Self::NO_ORDERS,
            plain: Self::NO_COEFFICIENTS,
        }
    }

    #[inline(always)]
    fn get(&self, k: usize) -> Coefficient<Double<L>, B> {
        self.plain[k]
    }

    type Sums = DoubleDoubleSums<L, W>;

    #[inline(always)]
    fn sums(&mut self, k: usize) -> Self::Sums {
        let mut spins = Components::ZERO;
        let mut turned = Components::ZERO;
        let partners = self.orders[..=k].iter().rev();
        for (a, b) in self.orders[..=k].iter().zip(partners) {
            spins = spins.plus_products(&a.next_w, &b.last_w);
            for n in 0..3 {
                turned = turned.plus_multiple(b.w[n], &a.turned[n]);
            }
        }
        DoubleDoubleSums { spins, turned }
    }

    #[inline(always)]
    fn spins(sums: &Self::Sums) -> [Double<L>; 3] {
        [sums.spins.get(0), sums.spins.get(1), sums.spins.get(2)]
    }
}

impl<L: Lane, const B: usize, const W: usize> AnyNumber<Double<L>, B>
    for DoubleDoubleSeries<L, B, W>
{
    #[inline(always)]
    fn put_omega(&mut self, k: usize, i: usize, x: Double<L>) {
        self.plain[k].w[i] = x;
    }

    #[inline(always)]
    fn put_attitude(&mut self, k: usize, i: usize, x: Double<L>) {
        self.plain[k].q[i] = x;
    }

    #[inline(always)]
    fn put_direction(&mut self, k: usize, b: usize, i: usize, x: Double<L>) {
        self.plain[k].g[b][i] = x;
    }

    #[inline(always)]
    fn complete(&mut self, k: usize) {
        self.orders[k] = Order::new(&self.plain[k]);
    }

    #[inline(always)]
    fn attitude_sum(sums: &Self::Sums, i: usize) -> Double<L> {
        sums.turned.get(i)
    }

    #[inline(always)]
    fn direction_sum(sums: &Self::Sums, b: usize, i: usize) -> Option<Double<L>> {
        Some(sums.turned.get(4 + 3 * b + i))
    }
}
