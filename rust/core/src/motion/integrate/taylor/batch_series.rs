//! The series of several motions in doubles, one motion in each lane.

use super::batch::{Batch, CacheAligned};
use super::directions::{add_squares, axis, from_squares, halve, roots};
use super::series::{AnyNumber, COUNT, Coefficient, Coefficients};
use crate::numerics::dispatch::{Kernel, dispatch_within};
use crate::numerics::lane::{AVX512, Lane};

/// The series of `R` motions, one in each lane.
#[derive(Clone, Debug)]
#[repr(align(64))] // see Batch
pub(super) struct BatchSeries<L, const B: usize, const R: usize> {
    orders: [Order<Batch<L, R>>; COUNT],
    directions: [[[Batch<L, R>; 3]; B]; COUNT],
    /// Index of the component of ω that is constant in all motions, or [`NONE`].
    constant: usize,
}

/// No component of ω is constant in all motions.
const NONE: usize = 3;

/// The sums of products of [`BatchSeries`]: ω₂ω₃, ω₃ω₁, ω₁ω₂ and q∘ω.
pub(super) struct BatchSums<T> {
    spins: [T; 3],
    turned: [T; 4],
}

/// Sums of real products, from which [`BatchSums`] are computed: components of ω; α and β with ω₁ + iω₂; q with ω₃. See
/// [`series`](super::series).
struct Products<T> {
    spins: [T; 3],
    alpha: [T; 3],
    beta: [T; 3],
    third: [T; 4],
}

/// The coefficients of one order.
#[derive(Clone, Copy, Debug)]
struct Order<T> {
    w: [T; 3],
    q: [T; 4],
}

impl<L: Lane, const R: usize> BatchSums<Batch<L, R>> {
    #[inline(always)]
    fn new() -> Self {
        let zero = Batch::new(0.0);
        Self {
            spins: [zero; 3],
            turned: [zero; 4],
        }
    }

    /// Set the sums of `H` rows from row `FIRST` on.
    #[inline(always)]
    fn put<const FIRST: usize, const H: usize>(&mut self, rows: &BatchSums<Batch<L, H>>) {
        for i in 0..3 {
            self.spins[i].put_rows::<FIRST, H>(rows.spins[i]);
        }
        for i in 0..4 {
            self.turned[i].put_rows::<FIRST, H>(rows.turned[i]);
        }
    }
}

impl<L: Lane, const R: usize> Order<Batch<L, R>> {
    /// Return `H` rows from row `FIRST` on.
    #[inline(always)]
    fn rows<const FIRST: usize, const H: usize>(&self) -> Order<Batch<L, H>> {
        let ([w0, w1, w2], [x, y, z, w]) = (self.w, self.q);
        Order {
            w: [
                w0.rows::<FIRST, H>(),
                w1.rows::<FIRST, H>(),
                w2.rows::<FIRST, H>(),
            ],
            q: [
                x.rows::<FIRST, H>(),
                y.rows::<FIRST, H>(),
                z.rows::<FIRST, H>(),
                w.rows::<FIRST, H>(),
            ],
        }
    }
}

impl<L: Lane, const R: usize> Products<Batch<L, R>> {
    #[inline(always)]
    fn new() -> Self {
        let zero = Batch::new(0.0);
        Self {
            spins: [zero; 3],
            alpha: [zero; 3],
            beta: [zero; 3],
            third: [zero; 4],
        }
    }

    /// Add the products of `a` with ω of `b`. Component `IN_A` of ω in `a` is zero, and component `IN_B` in `b`, unless these are [`NONE`]:
    /// products with it are left out. So is the product that drives this component, which is constant. Sums of two coefficients are
    /// computed here each time: additions run beside multiplications, and a stored sum would have to be loaded.
    #[inline(always)]
    fn add<const IN_A: usize, const IN_B: usize, const GROUPS: u8>(
        &mut self,
        a: &Order<Batch<L, R>>,
        b: &Order<Batch<L, R>>,
    ) {
        // Written out, since a loop would keep the sums in memory.
        let ([_, a1, a2], [x, y, z, w]) = (a.w, a.q);
        let [b0, b1, b2] = b.w;
        if GROUPS & SPINS != 0 {
            let is_zero = |in_a: usize, in_b: usize| IN_A == in_a || IN_B == in_b;
            let is_constant = |component: usize| is_zero(component, component);
            if !is_constant(0) && !is_zero(1, 2) {
                self.spins[0] = a1.mul_add(b2, self.spins[0]);
            }
            if !is_zero(2, 0) {
                self.spins[1] = a2.mul_add(b0, self.spins[1]);
            }
            if !is_constant(2) && !is_zero(1, 0) {
                self.spins[2] = a1.mul_add(b0, self.spins[2]);
            }
        }
        if GROUPS & COMPLEX != 0 {
            let (mut sum, mut difference) = (b1, b1);
            if IN_B != 0 {
                (sum, difference) = (b0 + b1, b1 - b0);
                self.alpha[0] = (w + z).mul_add(b0, self.alpha[0]);
                self.beta[0] = (x + y).mul_add(b0, self.beta[0]);
            }
            self.alpha[1] = w.mul_add(difference, self.alpha[1]);
            self.alpha[2] = z.mul_add(sum, self.alpha[2]);
            self.beta[1] = x.mul_add(sum, self.beta[1]);
            self.beta[2] = y.mul_add(difference, self.beta[2]);
        }
        if IN_B != 2 && GROUPS & THIRD != 0 {
            self.third[0] = x.mul_add(b2, self.third[0]);
            self.third[1] = y.mul_add(b2, self.third[1]);
            self.third[2] = z.mul_add(b2, self.third[2]);
            self.third[3] = w.mul_add(b2, self.third[3]);
        }
    }

    #[inline(always)]
    fn sums(self) -> BatchSums<Batch<L, R>> {
        let ([a0, a1, a2], [b0, b1, b2]) = (self.alpha, self.beta);
        let [x, y, z, w] = self.third;
        BatchSums {
            spins: self.spins,
            turned: [a0 - a2 + y, a0 + a1 - x, b1 - b0 + w, -b0 - b2 - z],
        }
    }
}

impl<L: Lane, const B: usize> Coefficients<Batch<L, ROWS>, B> for BatchSeries<L, B, ROWS> {
    #[inline(always)]
    fn new() -> Self {
        Self {
            orders: Self::NO_ORDERS,
            directions: Self::NO_DIRECTIONS,
            constant: NONE,
        }
    }

    fn set_constant_component(&mut self, constant: Option<usize>) {
        self.constant = constant.unwrap_or(NONE);
    }

    #[inline(always)]
    fn get(&self, k: usize) -> Coefficient<Batch<L, ROWS>, B> {
        let Order { w, q } = self.orders[k];
        Coefficient {
            w,
            q,
            g: self.directions[k],
        }
    }

    type Sums = BatchSums<Batch<L, ROWS>>;

    #[inline(always)]
    fn sums(&mut self, k: usize) -> Self::Sums {
        match self.constant {
            0 => dispatch_within::<L, _>(Sum::<_, B, 0>(self, k)).0,
            2 => dispatch_within::<L, _>(Sum::<_, B, 2>(self, k)).0,
            _ => dispatch_within::<L, _>(Sum::<_, B, NONE>(self, k)).0,
        }
    }

    #[inline(always)]
    fn spins(sums: &Self::Sums) -> [Batch<L, ROWS>; 3] {
        sums.spins
    }
}

impl<L: Lane, const B: usize> AnyNumber<Batch<L, ROWS>, B> for BatchSeries<L, B, ROWS> {
    #[inline(always)]
    fn put_omega(&mut self, k: usize, i: usize, x: Batch<L, ROWS>) {
        self.orders[k].w[i] = x;
    }

    #[inline(always)]
    fn put_attitude(&mut self, k: usize, i: usize, x: Batch<L, ROWS>) {
        self.orders[k].q[i] = x;
    }

    #[inline(always)]
    fn put_direction(&mut self, k: usize, b: usize, i: usize, x: Batch<L, ROWS>) {
        self.directions[k][b][i] = x;
    }

    #[inline(always)]
    fn attitude_sum(sums: &Self::Sums, i: usize) -> Batch<L, ROWS> {
        sums.turned[i]
    }

    #[inline(always)]
    fn direction_sum(_: &Self::Sums, _: usize, _: usize) -> Option<Batch<L, ROWS>> {
        None
    }
}

/// The number of motions side by side: a register of the widest machines.
pub(super) const ROWS: usize = 8;
/// How many of them have their sums computed at a time: all of them in the 32 registers of AVX-512. Other machines have fewer or narrower
/// registers, so that sums would go to the stack and back: there half of the motions, and one group of sums after the other.
const HALF: usize = ROWS / 2;

/// Groups of sums: of the spins; of the products with ω₃; of α and β; of the squares.
const SPINS: u8 = 1;
const THIRD: u8 = 2;
const COMPLEX: u8 = 4;
const SQUARES: u8 = 8;
const ALL: u8 = SPINS | THIRD | COMPLEX | SQUARES;

impl<L: Lane, const B: usize, const R: usize> BatchSeries<L, B, R> {
    const NO_ORDERS: [Order<Batch<L, R>>; COUNT] = [Order {
        w: [Batch::ZERO; 3],
        q: [Batch::ZERO; 4],
    }; COUNT];
    const NO_DIRECTIONS: [[[Batch<L, R>; 3]; B]; COUNT] = [[[Batch::ZERO; 3]; B]; COUNT];

    /// Compute the sums of order `k` of `H` rows from row `FIRST` on into `sums`. Component `CONSTANT` of ω is constant: its coefficients
    /// of orders above zero are zero, and their products are left out.
    #[inline(always)]
    fn add_products<const CONSTANT: usize, const FIRST: usize, const H: usize>(
        &mut self,
        k: usize,
        sums: &mut BatchSums<Batch<L, R>>,
    ) {
        let mut products = Products::<Batch<L, H>>::new();
        let mut squares = Squares::<Batch<L, H>, B>::new();
        let orders = &self.orders[..=k];
        let into = (&mut products, &mut squares);
        if H == ROWS && (CONSTANT != NONE || B == 0) {
            add_groups::<L, B, R, CONSTANT, FIRST, H, ALL>(orders, into);
        } else if H == ROWS {
            // The registers have no room for all.
            add_groups::<L, B, R, CONSTANT, FIRST, H, COMPLEX>(orders, (into.0, into.1));
            add_groups::<L, B, R, CONSTANT, FIRST, H, { ALL - COMPLEX }>(orders, into);
        } else {
            add_groups::<L, B, R, CONSTANT, FIRST, H, { SPINS | THIRD }>(orders, (into.0, into.1));
            add_groups::<L, B, R, CONSTANT, FIRST, H, COMPLEX>(orders, (into.0, into.1));
            add_groups::<L, B, R, CONSTANT, FIRST, H, SQUARES>(orders, into);
        }
        if k > 0 {
            let found = squares.directions();
            for b in 0..B {
                for i in 0..3 {
                    self.directions[k][b][i].put_rows::<FIRST, H>(found[b][i]);
                }
            }
        }
        sums.put::<FIRST, H>(&products.sums());
    }
}

/// Add the products of these orders, from the middle outward, to the sums of the `GROUPS`.
#[inline(always)]
fn add_groups<
    L: Lane,
    const B: usize,
    const R: usize,
    const CONSTANT: usize,
    const FIRST: usize,
    const H: usize,
    const GROUPS: u8,
>(
    orders: &[Order<Batch<L, R>>],
    (products, squares): (&mut Products<Batch<L, H>>, &mut Squares<Batch<L, H>, B>),
) {
    let k = orders.len() - 1;
    let rows = |order: &Order<Batch<L, R>>| order.rows::<FIRST, H>();
    if k == 0 {
        let first = rows(&orders[0]);
        return products.add::<NONE, NONE, GROUPS>(&first, &first);
    }
    if k.is_multiple_of(2) {
        let middle = rows(&orders[k / 2]);
        products.add::<CONSTANT, CONSTANT, GROUPS>(&middle, &middle);
        squares.add_middle::<GROUPS>(&middle);
    }
    let inner = usize::from(CONSTANT != NONE);
    let early = orders[inner..k.div_ceil(2)].iter().rev();
    for (early, late) in early.zip(&orders[k / 2 + 1..=k - inner]) {
        let (early, late) = (rows(early), rows(late));
        products.add::<CONSTANT, CONSTANT, GROUPS>(&early, &late);
        products.add::<CONSTANT, CONSTANT, GROUPS>(&late, &early);
        squares.add::<GROUPS>(&early, &late);
    }
    if CONSTANT != NONE {
        let (first, last) = (rows(&orders[0]), rows(&orders[k]));
        products.add::<NONE, CONSTANT, GROUPS>(&first, &last);
        products.add::<CONSTANT, NONE, GROUPS>(&last, &first);
        squares.add::<GROUPS>(&first, &last);
    }
}

/// Computes the sums of one order. A separate function: within a larger one the sums are not kept in registers.
struct Sum<'a, L, const B: usize, const CONSTANT: usize>(&'a mut BatchSeries<L, B, ROWS>, usize);

impl<N: Lane, const B: usize, const CONSTANT: usize> Kernel for Sum<'_, N, B, CONSTANT> {
    type Output = CacheAligned<BatchSums<Batch<N, ROWS>>>;

    #[inline(always)]
    fn run<L: Lane>(self) -> Self::Output {
        let Self(series, k) = self;
        let mut sums = BatchSums::new();
        if <N as Lane>::LEVEL == AVX512 {
            series.add_products::<CONSTANT, 0, ROWS>(k, &mut sums);
        } else {
            series.add_products::<CONSTANT, 0, HALF>(k, &mut sums);
            series.add_products::<CONSTANT, HALF, HALF>(k, &mut sums);
        }
        CacheAligned(sums)
    }
}

/// Sums of squares for the directions: see [`series`](super::series).
struct Squares<T, const B: usize>([[T; 6]; B]);

impl<L: Lane, const R: usize, const B: usize> Squares<Batch<L, R>, B> {
    #[inline(always)]
    fn new() -> Self {
        Self([[Batch::new(0.0); 6]; B])
    }

    // One axis after the other, written out: a loop would keep the sums in memory.

    #[inline(always)]
    fn add<const GROUPS: u8>(&mut self, one: &Order<Batch<L, R>>, other: &Order<Batch<L, R>>) {
        if GROUPS & SQUARES == 0 {
            return;
        }
        self.add_along(0, one, other);
        self.add_along(1, one, other);
        self.add_along(2, one, other);
    }

    #[inline(always)]
    fn add_along(&mut self, b: usize, one: &Order<Batch<L, R>>, other: &Order<Batch<L, R>>) {
        if let Some(sums) = self.0.get_mut(b) {
            let n = axis::<B>(b);
            *sums = add_squares(*sums, &roots(n, &one.q), &roots(n, &other.q));
        }
    }

    #[inline(always)]
    fn add_middle<const GROUPS: u8>(&mut self, middle: &Order<Batch<L, R>>) {
        if GROUPS & SQUARES == 0 {
            return;
        }
        self.add_middle_along(0, middle);
        self.add_middle_along(1, middle);
        self.add_middle_along(2, middle);
    }

    #[inline(always)]
    fn add_middle_along(&mut self, b: usize, middle: &Order<Batch<L, R>>) {
        if let Some(sums) = self.0.get_mut(b) {
            let roots = roots(axis::<B>(b), &middle.q);
            *sums = add_squares(*sums, &halve(&roots), &roots);
        }
    }

    #[inline(always)]
    fn directions(&self) -> [[Batch<L, R>; 3]; B] {
        let mut directions = [[Batch::new(0.0); 3]; B];
        self.put_direction(0, &mut directions);
        self.put_direction(1, &mut directions);
        self.put_direction(2, &mut directions);
        directions
    }

    #[inline(always)]
    fn put_direction(&self, b: usize, directions: &mut [[Batch<L, R>; 3]; B]) {
        if let (Some(&[s, t, u, v, w, x]), Some(direction)) = (self.0.get(b), directions.get_mut(b))
        {
            *direction = from_squares(axis::<B>(b), [s + t, u + v, w + x]);
        }
    }
}
