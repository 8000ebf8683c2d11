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
//! them in doubles: [`Alone`] puts the components of one motion in the lanes, [`Abreast`] the same component of several. They
//! add the same products in the same order, so a motion has the same bits either way. In numbers of twice the precision
//! there is [`Twin`](super::twin::Twin).
//!
//! That order takes the newest coefficients, on which the processor may still be busy, last: the products j = 2, 3, … up
//! to k − 1 (for odd k up to k − 2), then j = 1, (k − 1), 0, k.

use super::pack::Pack;
use crate::numerics::lane::Lane;

/// The highest order of a series in doubles, and the number of its coefficients. Even, since [`Alone`] sums two orders at a
/// time.
pub(super) const HIGHEST_ORDER: usize = 24;
const COUNT: usize = HIGHEST_ORDER + 1;

/// 1/k.
const RECIPROCALS: [f64; COUNT] = {
    let mut reciprocals = [0.0; COUNT];
    let mut k = 1;
    while k < COUNT {
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

/// The sums of products of [`Abreast`]: those of each component of ω with q, and with the two components of a direction that
/// it turns.
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
        // Written out, since a loop would keep the sums in memory.
        let [w0, w1, w2] = b.w;
        self.w = [
            a.w[1].mul_add(w2, self.w[0]),
            a.w[2].mul_add(w0, self.w[1]),
            a.w[0].mul_add(w1, self.w[2]),
        ];
        self.q = [
            add_products(&self.q[0], w0, &a.q),
            add_products(&self.q[1], w1, &a.q),
            add_products(&self.q[2], w2, &a.q),
        ];
        for (sum, g) in self.g.iter_mut().zip(&a.g) {
            *sum = [
                [w0.mul_add(g[1], sum[0][0]), w0.mul_add(g[2], sum[0][1])],
                [w1.mul_add(g[0], sum[1][0]), w1.mul_add(g[2], sum[1][1])],
                [w2.mul_add(g[0], sum[2][0]), w2.mul_add(g[1], sum[2][1])],
            ];
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
            for (a, b) in orders[2..last]
                .iter()
                .zip(orders[first..k - 1].iter().rev())
            {
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
        let [a, b, c] = &sums.q;
        let mut next = Coefficient {
            w: *acceleration,
            q: [
                a[3] - b[2] + c[1],
                a[2] + b[3] - c[0],
                -a[1] + b[0] + c[3],
                -a[0] - b[1] - c[2],
            ],
            g: [[reciprocal; 3]; B],
        };
        for w in &mut next.w {
            *w = *w * reciprocal;
        }
        for q in &mut next.q {
            *q = *q * half;
        }
        // The zeros stand where Alone has one, for the signs of zeros.
        let zero = Pack::new(0.0);
        for (g, [a, b, c]) in next.g.iter_mut().zip(&sums.g) {
            *g = [
                (zero - b[1] + c[1]) * reciprocal,
                (a[1] + zero - c[0]) * reciprocal,
                (-a[0] + b[0] + zero) * reciprocal,
            ];
        }
        self.orders[k + 1] = next;
    }
}

/// `W` numbers in the lanes: (x, y, z, w) of the attitude, then the directions, then zeros.
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

    /// `other`, its lanes put in another order and given signs, added to `self`.
    #[inline(always)]
    fn plus_turned(mut self, turn: &Turn<W>, other: &Self) -> Self {
        for i in 0..W {
            let factor = L::new(turn.signs[i]);
            self.0[i] = factor.mul_add(other.0[turn.from[i]], self.0[i]);
        }
        self
    }
}

/// What a component of ω makes of attitude and directions: which of their components, with which sign, goes where.
#[derive(Clone, Copy)]
struct Turn<const W: usize> {
    from: [usize; W],
    signs: [f64; W],
}

/// The turns by the three components of ω: of q by q∘ω, of γ by γ×ω. Since they only change places and signs, they can be
/// done on sums of products instead of on each factor.
const fn turns<const B: usize, const W: usize>() -> [Turn<W>; 3] {
    let nothing = W - 1;
    let mut turns = [Turn {
        from: [nothing; W],
        signs: [1.0; W],
    }; 3];
    let from = [[3, 2, 1, 0], [2, 3, 0, 1], [1, 0, 3, 2]];
    let signs = [
        [1.0, 1.0, -1.0, -1.0],
        [-1.0, 1.0, 1.0, -1.0],
        [1.0, -1.0, 1.0, -1.0],
    ];
    let mut n = 0;
    while n < 3 {
        let mut i = 0;
        while i < 4 {
            turns[n].from[i] = from[n][i];
            turns[n].signs[i] = signs[n][i];
            i += 1;
        }
        let mut b = 0;
        while b < B {
            let at = 4 + 3 * b;
            let (next, last) = ((n + 1) % 3, (n + 2) % 3);
            // (γ×e_n): component n + 1 is γ of n + 2, component n + 2 is −γ of n + 1.
            turns[n].from[at + next] = at + last;
            turns[n].from[at + last] = at + next;
            turns[n].signs[at + last] = -1.0;
            b += 1;
        }
        n += 1;
    }
    turns
}

/// One order of [`Alone`].
#[derive(Clone, Copy, Debug)]
struct Order<L, const W: usize> {
    numbers: Components<L, W>,
    w: [L; 4],
    /// (ω₂, ω₃, ω₁) and (ω₃, ω₁, ω₂).
    next_w: [L; 4],
    last_w: [L; 4],
}

impl<L: Lane, const W: usize> Order<L, W> {
    #[inline(always)]
    fn new([w0, w1, w2]: [L; 3], numbers: Components<L, W>) -> Self {
        let zero = L::new(0.0);
        Self {
            numbers,
            w: [w0, w1, w2, zero],
            next_w: [w1, w2, w0, zero],
            last_w: [w2, w0, w1, zero],
        }
    }
}

/// One motion, the lanes over its components: `W` > 4 + 3 `B`, or four without directions.
#[derive(Clone, Debug)]
pub(super) struct Alone<L, const B: usize, const W: usize> {
    orders: [Order<L, W>; COUNT],
    /// The sums of an odd order as far as they go before its forerunner is known.
    ahead: LaneSums<L, W>,
}

/// The sums of products of [`Alone`]: of ω with itself, and of each component of ω with all other numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct LaneSums<L, const W: usize> {
    w: [L; 4],
    numbers: [Components<L, W>; 3],
}

impl<L: Lane, const W: usize> LaneSums<L, W> {
    #[inline(always)]
    fn new() -> Self {
        Self {
            w: [L::new(0.0); 4],
            numbers: [Components::new(); 3],
        }
    }

    #[inline(always)]
    fn add(&mut self, a: &Order<L, W>, b: &Order<L, W>) {
        self.numbers = [
            self.numbers[0].plus_product(b.w[0], &a.numbers),
            self.numbers[1].plus_product(b.w[1], &a.numbers),
            self.numbers[2].plus_product(b.w[2], &a.numbers),
        ];
        for i in 0..4 {
            self.w[i] = a.next_w[i].mul_add(b.last_w[i], self.w[i]);
        }
    }
}

impl<L: Lane, const B: usize, const W: usize> Alone<L, B, W> {
    const TURNS: [Turn<W>; 3] = turns::<B, W>();
}

impl<L: Lane, const B: usize, const W: usize> Series<Pack<L, 1>, B> for Alone<L, B, W> {
    #[inline(always)]
    fn new() -> Self {
        let zero = L::new(0.0);
        Self {
            orders: [Order::new([zero; 3], Components::new()); COUNT],
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
        self.orders[0] = Order::new([w0.0[0], w1.0[0], w2.0[0]], numbers);
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
        if k.is_multiple_of(2) {
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
        for (turn, sum) in Self::TURNS.iter().zip(&sums.numbers) {
            numbers = numbers.plus_turned(turn, sum);
        }
        for i in 0..W {
            let half = if i < 4 { 0.5 } else { 1.0 };
            numbers.0[i] = numbers.0[i] * L::new(half * RECIPROCALS[k + 1]);
        }
        let [w0, w1, w2] = acceleration;
        let w = [
            w0.0[0] * reciprocal,
            w1.0[0] * reciprocal,
            w2.0[0] * reciprocal,
        ];
        self.orders[k + 1] = Order::new(w, numbers);
    }
}
