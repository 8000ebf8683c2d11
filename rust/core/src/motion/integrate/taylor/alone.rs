//! One motion, the lanes over its components.

use std::hint::black_box;

use super::directions::{ROOTS, Roots, axis, from_squares};
use super::pack::Pack;
use super::series::{COUNT, Coefficient, RECIPROCALS, Series};
use crate::numerics::lane::Lane;

/// `W` numbers in the lanes.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Components<L, const W: usize>([L; W]);

impl<L: Lane, const W: usize> Components<L, W> {
    #[inline(always)]
    fn new() -> Self {
        Self([L::new(0.0); W])
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
    fn plus_turned(mut self, turn: &Turn, other: &[L]) -> Self {
        for i in 0..4 {
            let factor = L::new(turn.signs[i]);
            self.0[i] = factor.mul_add(other[turn.from[i]], self.0[i]);
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

/// One order of [`Alone`]: two rows of factors, so that products of two orders are a row of one by the other of the other:
/// q by each component of ω, then (ω₂, ω₃, ω₁) by (ω₃, ω₁, ω₂), then a square that is not used.
#[derive(Clone, Copy, Debug)]
struct Order<L, const B: usize> {
    left: Components<L, 16>,
    right: Components<L, 16>,
    roots: [Components<L, 8>; B],
    g: [[L; 3]; B],
}

impl<L: Lane, const B: usize> Order<L, B> {
    #[inline(always)]
    fn new([w0, w1, w2]: [L; 3], q: Components<L, 4>) -> Self {
        let [x, y, z, w] = q.0;
        let mut roots = [Components::new(); B];
        for b in 0..B {
            roots[b] = q.roots(axis::<B>(b));
        }
        Self {
            left: Components([x, y, z, w, x, y, z, w, x, y, z, w, w1, w2, w0, w0]),
            right: Components([
                w0, w0, w0, w0, w1, w1, w1, w1, w2, w2, w2, w2, w2, w0, w1, w0,
            ]),
            roots,
            g: [[L::new(0.0); 3]; B],
        }
    }
}

/// One motion, the lanes over its components.
#[derive(Clone, Debug)]
pub(super) struct Alone<L, const B: usize> {
    orders: [Order<L, B>; COUNT],
    /// The sums of an even order and of the odd one after it, as far as they go before its forerunner is known.
    begun: [LaneSums<L, B>; 2],
}

/// The sums of products of [`Alone`]: of ω with itself, of each component of ω with q, and of the [`ROOTS`].
#[derive(Clone, Copy, Debug)]
pub(super) struct LaneSums<L, const B: usize> {
    products: Components<L, 16>,
    squares: [Components<L, 8>; B],
}

impl<L: Lane, const B: usize> LaneSums<L, B> {
    #[inline(always)]
    fn new() -> Self {
        Self {
            products: Components::new(),
            squares: [Components::new(); B],
        }
    }

    #[inline(always)]
    fn add(&mut self, a: &Order<L, B>, b: &Order<L, B>) {
        self.products = self.products.plus_products(&a.left, &b.right);
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
            begun: [LaneSums::new(); 2],
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
        let Order { left, right, g, .. } = &self.orders[k];
        let w = &right.0;
        let mut at = Coefficient {
            w: [Pack([w[0]]), Pack([w[4]]), Pack([w[8]])],
            q: [Pack::new(0.0); 4],
            g: [[Pack::new(0.0); 3]; B],
        };
        for i in 0..4 {
            at.q[i] = Pack([left.0[i]]);
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
        if k.is_multiple_of(2) {
            let mut sums = LaneSums::new();
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
            self.begun = [sums, ahead];
        }
        // The compiler is not to know which: it would take apart the sums, which are whole registers.
        let mut sums = self.begun[black_box(k % 2)];
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
        let [.., w0, w1, w2, _] = sums.products.0;
        [Pack([w0]), Pack([w1]), Pack([w2])]
    }

    #[inline(always)]
    fn extend(&mut self, k: usize, sums: &Self::Sums, acceleration: &[Pack<L, 1>; 3]) {
        let reciprocal = L::new(RECIPROCALS[k + 1]);
        let half = L::new(0.5 * RECIPROCALS[k + 1]);
        let mut q = Components::new();
        for (n, turn) in TURNS.iter().enumerate() {
            q = q.plus_turned(turn, &sums.products.0[4 * n..]);
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
