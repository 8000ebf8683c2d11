//! Taylor coefficients of ω, of the attitude and of directions fixed in space, and the products of series that their
//! equations are made of.
//!
//! With `a_k = a⁽ᵏ⁾/k!` the product of two series has the coefficients `(a b)_k = Σ_j a_j b_{k−j}`, and the equations
//!
//! ```text
//! ω̇ = κ ω ω + …,   q̇ = ½ q∘ω,   γ̇ = γ × ω
//! ```
//!
//! give the coefficients of order k + 1 from those up to k. Nearly all work is in these sums. There are two ways through
//! them: [`Alone`] puts the components of one motion in the lanes, [`Abreast`] the same component of several. They add the
//! same products in the same order, so a motion has the same bits either way.
//!
//! That order takes the newest coefficients, on which the processor may still be busy, last: the products j = 2, 3, … up
//! to k − 1 (for odd k up to k − 2), then j = 1, (k − 1), 0, k.

use super::pack::Pack;
use crate::numerics::lane::Lane;

/// The highest order of a series, and the number of its coefficients. Even, since [`Alone`] sums two orders at a time.
pub(super) const HIGHEST_ORDER: usize = 24;
pub(super) const COUNT: usize = HIGHEST_ORDER + 1;

/// 1/k.
const RECIPROCALS: [f64; COUNT + 1] = {
    let mut reciprocals = [0.0; COUNT + 1];
    let mut k = 1;
    while k <= COUNT {
        reciprocals[k] = 1.0 / k as f64;
        k += 1;
    }
    reciprocals
};

/// The coefficients of one order: ω in principal axes, (x, y, z, w) of the attitude, and `B` directions that are fixed in
/// space as seen from the principal axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coefficient<T, const B: usize> {
    pub(super) w: [T; 3],
    pub(super) q: [T; 4],
    pub(super) g: [[T; 3]; B],
}

/// The series of a motion, or of several.
pub(super) trait Series<T, const B: usize> {
    /// All zero.
    fn new() -> Self;
    /// Sets the coefficient of order zero.
    fn start(&mut self, state: &Coefficient<T, B>);
    /// The coefficient of order `k`.
    fn get(&self, k: usize) -> Coefficient<T, B>;
    /// The sums of products of order `k`.
    type Sums;
    /// Those of order `k`, when the coefficients up to k are set; asked for in order.
    fn sums(&mut self, k: usize) -> Self::Sums;
    /// Those of ω₂ω₃, ω₃ω₁ and ω₁ω₂.
    fn spins(sums: &Self::Sums) -> [T; 3];
    /// Sets the coefficients of order k + 1 from the sums and ω̇'s coefficient of order `k`.
    fn extend(&mut self, k: usize, sums: &Self::Sums, acceleration: &[T; 3]);
}

/// `R` motions, the lanes over the motions.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct Abreast<L, const B: usize, const R: usize> {
    orders: [Coefficient<Pack<L, R>, B>; COUNT],
}

/// The sums of products of [`Abreast`]: those with each component of ω apart, as in [`Alone`].
pub(super) struct Sums<T, const B: usize> {
    w: [T; 3],
    q: [[T; 4]; 3],
    g: [[[T; 2]; 3]; B],
}

impl<L: Lane, const B: usize, const R: usize> Sums<Pack<L, R>, B> {
    #[inline(always)]
    fn new() -> Self {
        let zero = Pack::new(0.0);
        Self {
            w: [zero; 3],
            q: [[zero; 4]; 3],
            g: [[[zero; 2]; 3]; B],
        }
    }

    /// Adds the products of order `a` of all with order `b` of ω.
    #[inline(always)]
    fn add(&mut self, a: &Coefficient<Pack<L, R>, B>, b: &Coefficient<Pack<L, R>, B>) {
        let [w0, w1, w2] = b.w;
        self.w[0] = a.w[1].mul_add(w2, self.w[0]);
        self.w[1] = a.w[2].mul_add(w0, self.w[1]);
        self.w[2] = a.w[0].mul_add(w1, self.w[2]);
        // Written out, since a loop would keep the sums in memory.
        let [x, y, z, w] = a.q;
        self.q = [
            add_products(&self.q[0], w0, &[w, z, -y, -x]),
            add_products(&self.q[1], w1, &[-z, w, x, -y]),
            add_products(&self.q[2], w2, &[y, -x, w, -z]),
        ];
        for (sum, g) in self.g.iter_mut().zip(&a.g) {
            sum[0] = [w1.mul_add(-g[2], sum[0][0]), w2.mul_add(g[1], sum[0][1])];
            sum[1] = [w0.mul_add(g[2], sum[1][0]), w2.mul_add(-g[0], sum[1][1])];
            sum[2] = [w0.mul_add(-g[1], sum[2][0]), w1.mul_add(g[0], sum[2][1])];
        }
    }
}

#[inline(always)]
fn add_products<L: Lane, const R: usize>(
    sums: &[Pack<L, R>; 4],
    factor: Pack<L, R>,
    others: &[Pack<L, R>; 4],
) -> [Pack<L, R>; 4] {
    [
        factor.mul_add(others[0], sums[0]),
        factor.mul_add(others[1], sums[1]),
        factor.mul_add(others[2], sums[2]),
        factor.mul_add(others[3], sums[3]),
    ]
}

impl<L: Lane, const B: usize, const R: usize> Series<Pack<L, R>, B> for Abreast<L, B, R> {
    #[inline(always)]
    fn new() -> Self {
        let zero = Pack::new(0.0);
        let none = Coefficient {
            w: [zero; 3],
            q: [zero; 4],
            g: [[zero; 3]; B],
        };
        Self {
            orders: [none; COUNT],
        }
    }

    #[inline(always)]
    fn start(&mut self, state: &Coefficient<Pack<L, R>, B>) {
        self.orders[0] = *state;
    }

    #[inline(always)]
    fn get(&self, k: usize) -> Coefficient<Pack<L, R>, B> {
        self.orders[k]
    }

    type Sums = Sums<Pack<L, R>, B>;

    #[inline(always)]
    fn sums(&mut self, k: usize) -> Self::Sums {
        let mut sums = Sums::new();
        let orders = &self.orders;
        let last = k - k % 2;
        if last > 2 {
            let first = k + 1 - last;
            for (a, b) in orders[2..last].iter().zip(orders[first..k - 1].iter().rev()) {
                sums.add(a, b);
            }
        }
        let newest = [1, k.wrapping_sub(1), 0, k];
        let newest = match k {
            0 => &newest[3..],
            1 => &newest[2..],
            _ if k % 2 == 1 => &newest[..],
            _ => &[1, 0, k][..],
        };
        for &j in newest {
            sums.add(&orders[j], &orders[k - j]);
        }
        sums
    }

    #[inline(always)]
    fn spins(sums: &Self::Sums) -> [Pack<L, R>; 3] {
        sums.w
    }

    #[inline(always)]
    fn extend(&mut self, k: usize, sums: &Self::Sums, acceleration: &[Pack<L, R>; 3]) {
        let reciprocal = Pack::new(RECIPROCALS[k + 1]);
        let half = Pack::new(0.5 * RECIPROCALS[k + 1]);
        let mut next = Coefficient {
            w: *acceleration,
            q: sums.q[0],
            g: [[reciprocal; 3]; B],
        };
        for w in &mut next.w {
            *w = *w * reciprocal;
        }
        for i in 0..4 {
            next.q[i] = (sums.q[0][i] + sums.q[1][i] + sums.q[2][i]) * half;
        }
        for (g, sum) in next.g.iter_mut().zip(&sums.g) {
            for i in 0..3 {
                g[i] = (sum[i][0] + sum[i][1]) * reciprocal;
            }
        }
        self.orders[k + 1] = next;
    }
}

/// `W` numbers in the lanes: (x, y, z, w) of the attitude, then the directions.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
struct Components<L, const W: usize>([L; W]);

impl<L: Lane, const W: usize> Components<L, W> {
    #[inline(always)]
    fn new() -> Self {
        Self([L::new(0.0); W])
    }

    /// `self + factor · other`.
    #[inline(always)]
    fn plus_product(mut self, factor: L, other: &Self) -> Self {
        for i in 0..W {
            self.0[i] = factor.mul_add(other.0[i], self.0[i]);
        }
        self
    }
}

/// One order of [`Alone`].
#[derive(Clone, Copy, Debug)]
struct Order<L, const W: usize> {
    /// What each component of ω multiplies.
    turned: [Components<L, W>; 3],
    /// (ω₂, ω₃, ω₁) and (ω₃, ω₁, ω₂).
    next_w: [L; 4],
    last_w: [L; 4],
    w: [L; 3],
    numbers: Components<L, W>,
}

/// One motion, the lanes over its `W` ≥ 4 + 3 `B` components.
#[derive(Clone, Debug)]
pub(super) struct Alone<L, const B: usize, const W: usize> {
    orders: [Order<L, W>; COUNT],
    /// The sums of an odd order as far as they go before its forerunner is known.
    ahead: LaneSums<L, W>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct LaneSums<L, const W: usize> {
    w: [L; 4],
    turned: [Components<L, W>; 3],
}

impl<L: Lane, const W: usize> LaneSums<L, W> {
    #[inline(always)]
    fn new() -> Self {
        Self {
            w: [L::new(0.0); 4],
            turned: [Components::new(); 3],
        }
    }

    #[inline(always)]
    fn add(&mut self, a: &Order<L, W>, b: &Order<L, W>) {
        self.turned = [
            self.turned[0].plus_product(b.w[0], &a.turned[0]),
            self.turned[1].plus_product(b.w[1], &a.turned[1]),
            self.turned[2].plus_product(b.w[2], &a.turned[2]),
        ];
        for i in 0..4 {
            self.w[i] = a.next_w[i].mul_add(b.last_w[i], self.w[i]);
        }
    }
}

impl<L: Lane, const W: usize> Order<L, W> {
    #[inline(always)]
    fn new<const B: usize>(w: [L; 3], numbers: Components<L, W>) -> Self {
        let zero = L::new(0.0);
        let mut turned = [Components::new(); 3];
        let half = L::new(0.5);
        let (x, y) = (numbers.0[0] * half, numbers.0[1] * half);
        let (z, s) = (numbers.0[2] * half, numbers.0[3] * half);
        let quaternion = [[s, z, -y, -x], [-z, s, x, -y], [y, -x, s, -z]];
        for n in 0..3 {
            for i in 0..4 {
                turned[n].0[i] = quaternion[n][i];
            }
        }
        for b in 0..B {
            let at = 4 + 3 * b;
            let (x, y, z) = (numbers.0[at], numbers.0[at + 1], numbers.0[at + 2]);
            let direction = [[zero, z, -y], [-z, zero, x], [y, -x, zero]];
            for n in 0..3 {
                for i in 0..3 {
                    turned[n].0[at + i] = direction[n][i];
                }
            }
        }
        let [w0, w1, w2] = w;
        Self {
            turned,
            next_w: [w1, w2, w0, zero],
            last_w: [w2, w0, w1, zero],
            w,
            numbers,
        }
    }
}

impl<L: Lane, const B: usize, const W: usize> Series<Pack<L, 1>, B> for Alone<L, B, W> {
    #[inline(always)]
    fn new() -> Self {
        let zero = L::new(0.0);
        Self {
            orders: [Order::new::<0>([zero; 3], Components::new()); COUNT],
            ahead: LaneSums::new(),
        }
    }

    #[inline(always)]
    fn start(&mut self, state: &Coefficient<Pack<L, 1>, B>) {
        let mut numbers = Components::new();
        for i in 0..4 {
            numbers.0[i] = state.q[i].0[0];
        }
        for b in 0..B {
            for i in 0..3 {
                numbers.0[4 + 3 * b + i] = state.g[b][i].0[0];
            }
        }
        let [w0, w1, w2] = &state.w;
        self.orders[0] = Order::new::<B>([w0.0[0], w1.0[0], w2.0[0]], numbers);
    }

    #[inline(always)]
    fn get(&self, k: usize) -> Coefficient<Pack<L, 1>, B> {
        let Order { w, numbers, .. } = &self.orders[k];
        let mut at = Coefficient {
            w: [Pack([w[0]]), Pack([w[1]]), Pack([w[2]])],
            q: [Pack::new(0.0); 4],
            g: [[Pack::new(0.0); 3]; B],
        };
        for i in 0..4 {
            at.q[i] = Pack([numbers.0[i]]);
        }
        for b in 0..B {
            for i in 0..3 {
                at.g[b][i] = Pack([numbers.0[4 + 3 * b + i]]);
            }
        }
        at
    }

    type Sums = LaneSums<L, W>;

    #[inline(always)]
    fn sums(&mut self, k: usize) -> Self::Sums {
        let orders = &self.orders;
        let mut sums = self.ahead;
        if k % 2 == 0 {
            sums = LaneSums::new();
            let mut ahead = LaneSums::new();
            if k > 2 {
                let partners = orders[2..k].iter().rev().zip(orders[1..k - 1].iter().rev());
                for (a, (far, near)) in orders[2..k].iter().zip(partners) {
                    sums.add(a, near);
                    ahead.add(a, far);
                }
            }
            if k > 0 {
                sums.add(&orders[1], &orders[k - 1]);
                ahead.add(&orders[1], &orders[k]);
                ahead.add(&orders[k], &orders[1]);
            }
            self.ahead = ahead;
        }
        sums.add(&orders[0], &orders[k]);
        if k > 0 {
            sums.add(&orders[k], &orders[0]);
        }
        sums
    }

    #[inline(always)]
    fn spins(sums: &Self::Sums) -> [Pack<L, 1>; 3] {
        let [w0, w1, w2, _] = sums.w;
        [Pack([w0]), Pack([w1]), Pack([w2])]
    }

    #[inline(always)]
    fn extend(&mut self, k: usize, sums: &Self::Sums, acceleration: &[Pack<L, 1>; 3]) {
        let reciprocal = L::new(RECIPROCALS[k + 1]);
        let mut numbers = Components::new();
        for i in 0..W {
            let [a, b, c] = &sums.turned;
            numbers.0[i] = (a.0[i] + b.0[i] + c.0[i]) * reciprocal;
        }
        let [w0, w1, w2] = acceleration;
        let w = [w0.0[0] * reciprocal, w1.0[0] * reciprocal, w2.0[0] * reciprocal];
        self.orders[k + 1] = Order::new::<B>(w, numbers);
    }
}
