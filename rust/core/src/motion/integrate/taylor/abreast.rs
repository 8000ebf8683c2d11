//! Several motions, the lanes over the motions.

use super::directions::{add_squares, axis, from_squares, halved, roots};
use super::pack::Pack;
use super::series::{COUNT, Coefficient, RECIPROCALS, Series};
use crate::numerics::lane::Lane;

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
