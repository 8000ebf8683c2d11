//! Taylor coefficients of ω, of the attitude and of directions fixed in space, and the products of series that their
//! equations are made of.
//!
//! With `a_k = a⁽ᵏ⁾/k!` the product of two series has the coefficients `(a b)_k = Σ_j a_j b_{k−j}`, and the equations
//!
//! ```text
//! ω̇ = κ ω ω + …,   q̇ = ½ q∘ω
//! ```
//!
//! give the coefficients of order k + 1 from those up to k. Nearly all work is in these sums. There are two ways through
//! them in doubles: [`Alone`] puts the components of one motion in the lanes, [`Abreast`] the same component of several. They
//! add the same products in the same order, so a motion has the same bits either way. In numbers of twice the precision
//! there is [`Twin`](super::twin::Twin).
//!
//! That order takes the newest coefficients, on which the processor may still be busy, last: the products j = 2, 3, … up
//! to k − 1 (for odd k up to k − 2), then j = 1, (k − 1), 0, k.
//!
//! A direction `e_n` of space as seen from the body would obey `γ̇ = γ × ω`, six products of series. With |q| = 1 it is made
//! of squares, and the sum for a square is only half as long: see [`ROOTS`].

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
/// space as seen from the principal axes: the vertical `e_3` of three, or all of them.
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
    /// The coefficient of order `k`; the directions are there once the sums of that order are.
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

/// The sums of products of [`Abreast`]: those of ω's components, and of each of them with q.
pub(super) struct Sums<T> {
    w: [T; 3],
    q: [[T; 4]; 3],
}

impl<L: Lane, const R: usize> Sums<Pack<L, R>> {
    #[inline(always)]
    fn new() -> Self {
        let zero = Pack::new(0.0);
        Self {
            w: [zero; 3],
            q: [[zero; 4]; 3],
        }
    }

    /// Adds the products of order `a` of all with order `b` of ω.
    #[inline(always)]
    fn add<const B: usize>(
        &mut self,
        a: &Coefficient<Pack<L, R>, B>,
        b: &Coefficient<Pack<L, R>, B>,
    ) {
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

    type Sums = Sums<Pack<L, R>>;

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
        if k > 0 {
            for b in 0..B {
                self.orders[k].g[b] = self.direction(k, b);
            }
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
        let [x, y, z] = *acceleration;
        let next = &mut self.orders[k + 1];
        next.w = [x * reciprocal, y * reciprocal, z * reciprocal];
        next.q = [
            (a[3] - b[2] + c[1]) * half,
            (a[2] + b[3] - c[0]) * half,
            (-a[1] + b[0] + c[3]) * half,
            (-a[0] - b[1] - c[2]) * half,
        ];
    }
}

impl<L: Lane, const B: usize, const R: usize> Abreast<L, B, R> {
    /// The coefficient of order `k` > 0 of direction `b`.
    #[inline(always)]
    fn direction(&self, k: usize, b: usize) -> [Pack<L, R>; 3] {
        let n = axis::<B>(b);
        let roots = |j: usize| roots(n, &self.orders[j].q);
        let mut squares = [Pack::new(0.0); 6];
        let middle = k / 2;
        if k.is_multiple_of(2) {
            let root = roots(middle);
            squares = add_squares(squares, &halved(&root), &root);
        }
        for j in (1..k - middle).rev() {
            squares = add_squares(squares, &roots(j), &roots(k - j));
        }
        let [a, b, c, d, e, f] = add_squares(squares, &roots(0), &roots(k));
        from_squares(n, [a + b, c + d, e + f])
    }
}

#[inline(always)]
fn add_squares<L: Lane, const R: usize>(
    sums: [Pack<L, R>; 6],
    one: &[Pack<L, R>; 6],
    other: &[Pack<L, R>; 6],
) -> [Pack<L, R>; 6] {
    [
        one[0].mul_add(other[0], sums[0]),
        one[1].mul_add(other[1], sums[1]),
        one[2].mul_add(other[2], sums[2]),
        one[3].mul_add(other[3], sums[3]),
        one[4].mul_add(other[4], sums[4]),
        one[5].mul_add(other[5], sums[5]),
    ]
}

#[inline(always)]
fn halved<L: Lane, const R: usize>(roots: &[Pack<L, R>; 6]) -> [Pack<L, R>; 6] {
    let half = Pack::new(0.5);
    let [a, b, c, d, e, f] = *roots;
    [a * half, b * half, c * half, d * half, e * half, f * half]
}

/// The axis of space that is direction `b` of `B`.
const fn axis<const B: usize>(b: usize) -> usize {
    if B == 1 { 2 } else { b }
}

/// The numbers whose squares make the directions of space as seen from the body. With n, a, b = 1, 2, 3 and cyclic, `e_n` has
/// the components
///
/// ```text
/// n: 1 − 2 (q_a² + q_b²),   a: (q_n + q_a)² + (w − q_b)² − 1,   b: (q_n + q_b)² + (w + q_a)² − 1
/// ```
///
/// where |q| = 1. The coefficient of order k of a square is twice the sum of `u_j u_{k−j}` over j < k/2, and u² in the middle.
/// For each n the six numbers are `q[first] + sign q[second]`.
const ROOTS: [Roots; 3] = [roots_of(0), roots_of(1), roots_of(2)];

struct Roots {
    first: [usize; 8],
    second: [usize; 8],
    signs: [f64; 8],
}

const fn roots_of(n: usize) -> Roots {
    let (a, b, w) = ((n + 1) % 3, (n + 2) % 3, 3);
    Roots {
        first: [a, b, n, w, n, w, n, n],
        second: [n, n, a, b, b, a, n, n],
        signs: [0.0, 0.0, 1.0, -1.0, 1.0, 1.0, 0.0, 0.0],
    }
}

/// The numbers of [`ROOTS`].
#[inline(always)]
fn roots<L: Lane, const R: usize>(n: usize, q: &[Pack<L, R>; 4]) -> [Pack<L, R>; 6] {
    let (a, b, n, w) = (q[(n + 1) % 3], q[(n + 2) % 3], q[n], q[3]);
    [a, b, n + a, w - b, n + b, w + a]
}

/// A direction from half of each of the three sums of squares, of an order above zero.
#[inline(always)]
fn from_squares<L: Lane, const R: usize>(n: usize, halves: [Pack<L, R>; 3]) -> [Pack<L, R>; 3] {
    let (two, four) = (Pack::new(2.0), Pack::new(-4.0));
    let [along, a, b] = halves;
    let mut direction = [along * four; 3];
    direction[(n + 1) % 3] = a * two;
    direction[(n + 2) % 3] = b * two;
    direction
}

/// `W` numbers in the lanes.
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

    /// `self + one · other`, each number by itself.
    #[inline(always)]
    fn plus_products(mut self, one: &Self, other: &Self) -> Self {
        for i in 0..W {
            self.0[i] = one.0[i].mul_add(other.0[i], self.0[i]);
        }
        self
    }

    #[inline(always)]
    fn halved(mut self) -> Self {
        for i in 0..W {
            self.0[i] = self.0[i] * L::new(0.5);
        }
        self
    }
}

impl<L: Lane> Components<L, 4> {
    /// `other`, its lanes put in another order and given signs, added to `self`.
    #[inline(always)]
    fn plus_turned(mut self, turn: &Turn, other: &Self) -> Self {
        for i in 0..4 {
            let factor = L::new(turn.signs[i]);
            self.0[i] = factor.mul_add(other.0[turn.from[i]], self.0[i]);
        }
        self
    }

    /// The numbers of [`ROOTS`], then two that are not used.
    #[inline(always)]
    fn roots(&self, n: usize) -> Components<L, 8> {
        let Roots {
            first,
            second,
            signs,
        } = &ROOTS[n];
        let mut roots = Components::new();
        for i in 0..8 {
            roots.0[i] = L::new(signs[i]).mul_add(self.0[second[i]], self.0[first[i]]);
        }
        roots
    }
}

/// What a component of ω makes of q in q∘ω: which of its components, with which sign, goes where.
#[derive(Clone, Copy)]
struct Turn {
    from: [usize; 4],
    signs: [f64; 4],
}

/// The turns by the three components of ω. Since they only change places and signs, they can be done on sums of products
/// instead of on each factor.
const TURNS: [Turn; 3] = [
    Turn {
        from: [3, 2, 1, 0],
        signs: [1.0, 1.0, -1.0, -1.0],
    },
    Turn {
        from: [2, 3, 0, 1],
        signs: [-1.0, 1.0, 1.0, -1.0],
    },
    Turn {
        from: [1, 0, 3, 2],
        signs: [1.0, -1.0, 1.0, -1.0],
    },
];

/// One order of [`Alone`].
#[derive(Clone, Copy, Debug)]
struct Order<L, const B: usize> {
    q: Components<L, 4>,
    roots: [Components<L, 8>; B],
    g: [[L; 3]; B],
    w: [L; 4],
    /// (ω₂, ω₃, ω₁) and (ω₃, ω₁, ω₂).
    next_w: [L; 4],
    last_w: [L; 4],
}

impl<L: Lane, const B: usize> Order<L, B> {
    #[inline(always)]
    fn new([w0, w1, w2]: [L; 3], q: Components<L, 4>) -> Self {
        let zero = L::new(0.0);
        let mut roots = [Components::new(); B];
        for b in 0..B {
            roots[b] = q.roots(axis::<B>(b));
        }
        Self {
            q,
            roots,
            g: [[zero; 3]; B],
            w: [w0, w1, w2, zero],
            next_w: [w1, w2, w0, zero],
            last_w: [w2, w0, w1, zero],
        }
    }
}

/// One motion, the lanes over its components.
#[derive(Clone, Debug)]
pub(super) struct Alone<L, const B: usize> {
    orders: [Order<L, B>; COUNT],
    /// The sums of an odd order as far as they go before its forerunner is known.
    ahead: LaneSums<L, B>,
}

/// The sums of products of [`Alone`]: of ω with itself, of each component of ω with q, and of the [`ROOTS`].
#[derive(Clone, Copy, Debug)]
pub(super) struct LaneSums<L, const B: usize> {
    w: [L; 4],
    q: [Components<L, 4>; 3],
    squares: [Components<L, 8>; B],
}

impl<L: Lane, const B: usize> LaneSums<L, B> {
    #[inline(always)]
    fn new() -> Self {
        Self {
            w: [L::new(0.0); 4],
            q: [Components::new(); 3],
            squares: [Components::new(); B],
        }
    }

    #[inline(always)]
    fn add(&mut self, a: &Order<L, B>, b: &Order<L, B>) {
        self.q = [
            self.q[0].plus_product(b.w[0], &a.q),
            self.q[1].plus_product(b.w[1], &a.q),
            self.q[2].plus_product(b.w[2], &a.q),
        ];
        for i in 0..4 {
            self.w[i] = a.next_w[i].mul_add(b.last_w[i], self.w[i]);
        }
    }

    #[inline(always)]
    fn add_squares(&mut self, one: &Order<L, B>, other: &Order<L, B>) {
        for b in 0..B {
            self.squares[b] = self.squares[b].plus_products(&one.roots[b], &other.roots[b]);
        }
    }

    #[inline(always)]
    fn add_middle(&mut self, middle: &Order<L, B>) {
        for b in 0..B {
            let root = &middle.roots[b];
            self.squares[b] = self.squares[b].plus_products(&root.halved(), root);
        }
    }
}

impl<L: Lane, const B: usize> Series<Pack<L, 1>, B> for Alone<L, B> {
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
        let mut q = Components::new();
        for i in 0..4 {
            q.0[i] = state.q[i].0[0];
        }
        let [w0, w1, w2] = &state.w;
        self.orders[0] = Order::new([w0.0[0], w1.0[0], w2.0[0]], q);
        for b in 0..B {
            for i in 0..3 {
                self.orders[0].g[b][i] = state.g[b][i].0[0];
            }
        }
    }

    #[inline(always)]
    fn get(&self, k: usize) -> Coefficient<Pack<L, 1>, B> {
        let Order { w, q, g, .. } = &self.orders[k];
        let mut at = Coefficient {
            w: [Pack([w[0]]), Pack([w[1]]), Pack([w[2]])],
            q: [Pack::new(0.0); 4],
            g: [[Pack::new(0.0); 3]; B],
        };
        for i in 0..4 {
            at.q[i] = Pack([q.0[i]]);
        }
        for b in 0..B {
            for i in 0..3 {
                at.g[b][i] = Pack([g[b][i]]);
            }
        }
        at
    }

    type Sums = LaneSums<L, B>;

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
                let middle = k / 2;
                sums.add_middle(&orders[middle]);
                ahead.add_squares(&orders[middle], &orders[middle + 1]);
                let farther = orders[middle + 1..k].iter().zip(&orders[middle + 2..]);
                for (a, (near, far)) in orders[1..middle].iter().rev().zip(farther) {
                    sums.add_squares(a, near);
                    ahead.add_squares(a, far);
                }
                sums.add(&orders[1], &orders[k - 1]);
                ahead.add(&orders[1], &orders[k]);
                ahead.add(&orders[k], &orders[1]);
            }
            self.ahead = ahead;
        }
        sums.add(&orders[0], &orders[k]);
        if k > 0 {
            sums.add(&orders[k], &orders[0]);
            sums.add_squares(&orders[0], &orders[k]);
            for b in 0..B {
                let [s0, s1, s2, s3, s4, s5, ..] = sums.squares[b].0;
                let halves = [Pack([s0 + s1]), Pack([s2 + s3]), Pack([s4 + s5])];
                let [x, y, z] = from_squares(axis::<B>(b), halves);
                self.orders[k].g[b] = [x.0[0], y.0[0], z.0[0]];
            }
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
        let half = L::new(0.5 * RECIPROCALS[k + 1]);
        let mut q = Components::new();
        for (turn, sum) in TURNS.iter().zip(&sums.q) {
            q = q.plus_turned(turn, sum);
        }
        for i in 0..4 {
            q.0[i] = q.0[i] * half;
        }
        let [w0, w1, w2] = acceleration;
        let w = [
            w0.0[0] * reciprocal,
            w1.0[0] * reciprocal,
            w2.0[0] * reciprocal,
        ];
        self.orders[k + 1] = Order::new(w, q);
    }
}
