//! The series of one motion in doubles, its components in the lanes.

use std::hint::black_box;

use super::batch::Batch;
use super::directions::{PairSums, ROOTS, axis, from_squares};
use super::series::{COUNT, Coefficient, Coefficients, Series};
use crate::numerics::lane::Lane;
use crate::numerics::number::Number;

/// `W` numbers in the lanes.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Components<L, const W: usize>([L; W]);

impl<L: Lane, const W: usize> Components<L, W> {
    const ZERO: Self = Self([<L as Lane>::ZERO; W]);

    /// Compute `self + one · other` for each number.
    #[inline(always)]
    fn plus_products(mut self, one: &Self, other: &Self) -> Self {
        for i in 0..W {
            self.0[i] = one.0[i].mul_add(other.0[i], self.0[i]);
        }
        self
    }

    /// Compute `self · factor + other` for each number.
    #[inline(always)]
    fn times_plus(mut self, factor: L, other: &Self) -> Self {
        for i in 0..W {
            self.0[i] = self.0[i].mul_add(factor, other.0[i]);
        }
        self
    }

    #[inline(always)]
    fn times(mut self, factor: L) -> Self {
        for i in 0..W {
            self.0[i] = self.0[i] * factor;
        }
        self
    }
}

impl<L: Lane> Components<L, 4> {
    /// Compute the sums of pairs, with the signs from [`Signs`].
    #[inline(always)]
    fn sum_pairs(&self, pairs: &PairSums, signs: &Components<L, 8>) -> Components<L, 8> {
        let mut row = Components::ZERO;
        for i in 0..8 {
            row.0[i] = signs.0[i].mul_add(self.0[pairs.second[i]], self.0[pairs.first[i]]);
        }
        row
    }
}

/// (Re α + Im α) twice, (Re β + Im β) twice, then (z, w, x, y): of (x, y, z, w).
const LEFT: PairSums = PairSums {
    first: [3, 3, 0, 0, 2, 3, 0, 1],
    second: [2, 2, 1, 1, 2, 3, 0, 1],
    signs: [1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0],
};
/// The other factors: ω₁ four times, then (ω₁ + ω₂, ω₂ − ω₁) twice.
const RIGHT: PairSums = PairSums {
    first: [0, 0, 0, 0, 0, 1, 0, 1],
    second: [0, 0, 0, 0, 1, 0, 1, 0],
    signs: [0.0, 0.0, 0.0, 0.0, 1.0, -1.0, 1.0, -1.0],
};
/// The signs of these products, and of those of (y, x, w, z) with ω₃, in q∘ω.
const TURNED: [[f64; 4]; 3] = [
    [1.0, 1.0, -1.0, -1.0],
    [-1.0, 1.0, 1.0, -1.0],
    [1.0, -1.0, 1.0, -1.0],
];

/// The signs of every [`PairSums`], and [`TURNED`].
#[derive(Clone, Copy, Debug)]
struct Signs<L, const B: usize> {
    turned: [Components<L, 4>; 3],
    left: Components<L, 8>,
    right: Components<L, 8>,
    roots: [Components<L, 8>; B],
}

impl<L: Lane, const B: usize> Signs<L, B> {
    #[inline(always)]
    fn new() -> Self {
        let mut signs = Self {
            turned: [Components::ZERO; 3],
            left: Components::ZERO,
            right: Components::ZERO,
            roots: [Components::ZERO; B],
        };
        for i in 0..8 {
            signs.left.0[i] = L::new(LEFT.signs[i]);
            signs.right.0[i] = L::new(RIGHT.signs[i]);
            for b in 0..B {
                signs.roots[b].0[i] = L::new(ROOTS[axis::<B>(b)].signs[i]);
            }
        }
        for n in 0..3 {
            for i in 0..4 {
                signs.turned[n].0[i] = L::new(TURNED[n][i]);
            }
        }
        // Hidden from the compiler: it would split a register of eight numbers into pieces and store the pieces, and the next
        // load of the whole register would have to wait.
        black_box(signs)
    }
}

/// One order of [`SingleMotionSeries`]: two rows of factors. The products of two orders are the left row of one times the right
/// row of the other, each product at its place in q∘ω; then follow one that is not used, and ω₂ω₃, ω₃ω₁ and ω₁ω₂. Numbers that are
/// loaded together are also stored together: a register across two separate stores would have to wait until both are in the cache.
#[derive(Clone, Copy, Debug)]
struct Order<L, const B: usize> {
    /// (x, y, z, w) of the attitude, ω, and zero.
    state: Components<L, 8>,
    left: Components<L, 16>,
    right: Components<L, 16>,
    roots: [Components<L, 8>; B],
    g: [[L; 3]; B],
}

impl<L: Lane, const B: usize> Order<L, B> {
    const ZERO: Self = Self {
        state: Components::ZERO,
        left: Components::ZERO,
        right: Components::ZERO,
        roots: [Components::ZERO; B],
        g: [[<L as Lane>::ZERO; 3]; B],
    };

    #[inline(always)]
    fn new(w: [L; 3], q: Components<L, 4>, signs: &Signs<L, B>) -> Self {
        let [w0, w1, w2] = w;
        let [l0, l1, l2, l3, l4, l5, l6, l7] = q.sum_pairs(&LEFT, &signs.left).0;
        let [r0, r1, r2, r3, r4, r5, r6, r7] = Components([w0, w1, w2, w2])
            .sum_pairs(&RIGHT, &signs.right)
            .0;
        let [x, y, z, s] = q.0;
        let mut order = Self {
            state: Components([x, y, z, s, w0, w1, w2, L::new(0.0)]),
            left: Components([l0, l1, l2, l3, l4, l5, l6, l7, y, x, s, z, w2, w1, w2, w1]),
            right: Components([
                r0, r1, r2, r3, r4, r5, r6, r7, w2, w2, w2, w2, w2, w2, w0, w0,
            ]),
            ..Self::ZERO
        };
        for b in 0..B {
            order.roots[b] = q.sum_pairs(&ROOTS[axis::<B>(b)], &signs.roots[b]);
        }
        order
    }
}

/// The series of one motion, its components in the lanes.
#[derive(Clone, Debug)]
pub(super) struct SingleMotionSeries<L, const B: usize> {
    orders: [Order<L, B>; COUNT],
    /// The sums of an even order and of the odd one after it, without the products that need the newest coefficient.
    partial: [SingleMotionSums<L, B>; 2],
    signs: Signs<L, B>,
}

/// The sums of products of [`SingleMotionSeries`]: of the rows of each [`Order`], and of the [`ROOTS`].
#[derive(Clone, Copy, Debug)]
pub(super) struct SingleMotionSums<L, const B: usize> {
    products: Components<L, 16>,
    squares: [Components<L, 8>; B],
}

impl<L: Lane, const B: usize> SingleMotionSums<L, B> {
    #[inline(always)]
    fn new() -> Self {
        Self {
            products: Components::ZERO,
            squares: [Components::ZERO; B],
        }
    }

    #[inline(always)]
    fn add(&mut self, a: &Order<L, B>, b: &Order<L, B>) {
        self.products = self.products.plus_products(&a.left, &b.right);
    }

    #[inline(always)]
    fn add_pair(&mut self, one: &Order<L, B>, other: &Order<L, B>) {
        self.add(one, other);
        self.add(other, one);
        for b in 0..B {
            self.squares[b] = self.squares[b].plus_products(&one.roots[b], &other.roots[b]);
        }
    }

    #[inline(always)]
    fn add_middle(&mut self, middle: &Order<L, B>) {
        self.add(middle, middle);
        for b in 0..B {
            let root = &middle.roots[b];
            self.squares[b] = self.squares[b].plus_products(&root.times(L::new(0.5)), root);
        }
    }
}

impl<L: Lane, const B: usize> SingleMotionSeries<L, B> {
    const NO_ORDERS: [Order<L, B>; COUNT] = [Order::ZERO; COUNT];
}

impl<L: Lane, const B: usize> Coefficients<Batch<L, 1>, B> for SingleMotionSeries<L, B> {
    #[inline(always)]
    fn new() -> Self {
        Self {
            orders: Self::NO_ORDERS,
            signs: Signs::new(),
            partial: [SingleMotionSums::new(); 2],
        }
    }

    #[inline(always)]
    fn get(&self, k: usize) -> Coefficient<Batch<L, 1>, B> {
        let Order { state, g, .. } = &self.orders[k];
        let mut at = Coefficient {
            w: [Batch::new(0.0); 3],
            q: [Batch::new(0.0); 4],
            g: [[Batch::new(0.0); 3]; B],
        };
        for i in 0..4 {
            at.q[i] = Batch([state.0[i]]);
        }
        for i in 0..3 {
            at.w[i] = Batch([state.0[4 + i]]);
        }
        for b in 0..B {
            for i in 0..3 {
                at.g[b][i] = Batch([g[b][i]]);
            }
        }
        at
    }

    type Sums = SingleMotionSums<L, B>;

    #[inline(always)]
    fn sums(&mut self, k: usize) -> Self::Sums {
        let orders = &self.orders;
        if k.is_multiple_of(2) {
            let mut sums = SingleMotionSums::new();
            let mut ahead = SingleMotionSums::new();
            if k > 0 {
                let middle = k / 2;
                sums.add_middle(&orders[middle]);
                ahead.add_pair(&orders[middle], &orders[middle + 1]);
                let farther = orders[middle + 1..k].iter().zip(&orders[middle + 2..]);
                for (a, (near, far)) in orders[1..middle].iter().rev().zip(farther) {
                    sums.add_pair(a, near);
                    ahead.add_pair(a, far);
                }
            }
            self.partial = [sums, ahead];
        }
        // Hidden from the compiler: it would split the sums, which are whole registers.
        let mut sums = self.partial[black_box(k % 2)];
        if k == 0 {
            sums.add(&orders[0], &orders[0]);
        } else {
            sums.add_pair(&orders[0], &orders[k]);
            for b in 0..B {
                let [s0, s1, s2, s3, s4, s5, ..] = sums.squares[b].0;
                let halves = [Batch([s0 + s1]), Batch([s2 + s3]), Batch([s4 + s5])];
                let [x, y, z] = from_squares(axis::<B>(b), halves);
                self.orders[k].g[b] = [x.0[0], y.0[0], z.0[0]];
            }
        }
        sums
    }

    #[inline(always)]
    fn spins(sums: &Self::Sums) -> [Batch<L, 1>; 3] {
        let [.., w0, w1, w2] = sums.products.0;
        [Batch([w0]), Batch([w1]), Batch([w2])]
    }
}

impl<L: Lane, const B: usize> Series<Batch<L, 1>, B> for SingleMotionSeries<L, B> {
    #[inline(always)]
    fn start(&mut self, state: &Coefficient<Batch<L, 1>, B>) {
        let mut q = Components::ZERO;
        for i in 0..4 {
            q.0[i] = state.q[i].0[0];
        }
        let [w0, w1, w2] = &state.w;
        self.orders[0] = Order::new([w0.0[0], w1.0[0], w2.0[0]], q, &self.signs);
        for b in 0..B {
            for i in 0..3 {
                self.orders[0].g[b][i] = state.g[b][i].0[0];
            }
        }
    }

    #[inline(always)]
    fn increment(&self, order: usize, h: Batch<L, 1>) -> [Batch<L, 1>; 7] {
        let [h] = h.0;
        let square = h * h;
        let (mut odd, mut even) = (Components::ZERO, Components::ZERO);
        for pair in self.orders[1..=order].chunks_exact(2).rev() {
            odd = odd.times_plus(square, &pair[0].state);
            even = even.times_plus(square, &pair[1].state);
        }
        let [x, y, z, w, w0, w1, w2, _] = even.times_plus(h, &odd).times(h).0;
        [
            Batch([w0]),
            Batch([w1]),
            Batch([w2]),
            Batch([x]),
            Batch([y]),
            Batch([z]),
            Batch([w]),
        ]
    }

    #[inline(always)]
    fn extend(&mut self, k: usize, sums: &Self::Sums, acceleration: &[Batch<L, 1>; 3]) {
        let reciprocal: L = Number::over(k + 1);
        let half: L = Number::over(2 * (k + 1));
        let products = &sums.products.0;
        let [first, second, third] = &self.signs.turned;
        let mut q = Components::ZERO;
        for i in 0..4 {
            q.0[i] = first.0[i] * products[i];
        }
        for i in 0..4 {
            q.0[i] = second.0[i].mul_add(products[4 + i], q.0[i]);
        }
        for i in 0..4 {
            q.0[i] = third.0[i].mul_add(products[8 + i], q.0[i]);
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
        self.orders[k + 1] = Order::new(w, q, &self.signs);
    }
}
