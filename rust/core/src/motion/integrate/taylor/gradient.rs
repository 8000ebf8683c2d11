//! The recurrence of the gravity gradient.

use nalgebra::{Matrix3, Vector3};

use super::circuit::Circuit;
use super::field::Field;
use super::frame::of_matrix;
use super::pack::{Pack, plus};
use super::series::Series;
use super::terms::Analytic;
use super::twin::COUNT;
use crate::motion::loads::OnOrbit;
use crate::numerics::dispatch::{Kernel, dispatch};
use crate::numerics::lane::Lane;
use crate::numerics::number::{Number, Real};
use crate::numerics::quaternion::{normalized, product};

/// The gravity gradient on a Kepler orbit. The attitude as seen from the frame that the orbit has at the start of the step, turned
/// back by the orbit's half turn since then and scaled (see [`Circuit`]), is a quaternion `Q = c̄ q` of length `r^{−3/4}`: the first row
/// of its matrix is `m = r^{−3/2} n`, n from the attractor to C as seen from the body, and
///
/// ```text
/// I⁻¹ (3μ/r³) n×I n = −3μ κ (m₂m₃, m₃m₁, m₁m₂)
/// ```
///
/// with κ of the body, its wheels locked; what is off the diagonal of that tensor is added by [`Field::tilt`].
#[derive(Clone, Debug)]
#[repr(align(64))] // see Pack
pub(super) struct Gradient<T> {
    orbit: Circuit<T>,
    /// The rotation from the orbit's frame at the start of the step to N.
    frame: [T; 4],
    /// The attitude from that frame, and with the half turn.
    attitude: [[T; 4]; COUNT],
    turned: [[T; 4]; COUNT],
    /// m.
    pointing: [[T; 3]; COUNT],
    strength: T,
    /// Whether the tensor that is pulled has elements off the diagonal.
    is_aside: bool,
}

/// The slowest orbit, in units of rates, of which the pole is found: the square of this is still a number.
const SLOWEST: f64 = 1e-140;

/// How many numbers [`Gradient::at_start`] has.
pub(super) const AT_START: usize = 8;

impl<L: Number, const R: usize> Gradient<Pack<L, R>> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        let zero = Pack::new(0.0);
        Self {
            orbit: Circuit::new(),
            frame: [zero; 4],
            attitude: [[zero; 4]; COUNT],
            turned: [[zero; 4]; COUNT],
            pointing: [[zero; 3]; COUNT],
            strength: zero,
            is_aside: false,
        }
    }

    /// The orbit's state of one row at the start of a step.
    pub(super) fn set(&mut self, row: usize, at: &OnOrbit<L::Real>) {
        let (n, v) = (at.position, at.velocity);
        let swept = n.cross(&v);
        let around = swept.dot(&swept).root();
        // A term that does not act, or an orbit that stands still beside the body: any pole will do.
        let pole = if around.rounded() > SLOWEST {
            swept / around
        } else {
            let aside = n.cross(&Vector3::ith(
                n.map(|x| x.rounded().abs()).imin(),
                1.0.into(),
            ));
            aside / aside.dot(&aside).root()
        };
        let frame = of_matrix(&Matrix3::from_columns(&[n, pole.cross(&n), pole]));
        self.put(row, frame, [n.dot(&v), around, at.pull], at.strength);
    }

    fn put(&mut self, row: usize, frame: [L::Real; 4], rates: [L::Real; 3], strength: L::Real) {
        for i in 0..4 {
            self.frame[i].put(row, frame[i]);
        }
        self.orbit.set(row, rates);
        self.strength.put(row, strength);
    }

    /// What [`Self::set`] has made of the orbit in one row.
    pub(super) fn at_start(&self, row: usize) -> [L::Real; AT_START] {
        let [x, y, z, w] = [0, 1, 2, 3].map(|i| self.frame[i].real(row));
        let [radial, around, pull] = self.orbit.rates(row);
        [x, y, z, w, radial, around, pull, self.strength.real(row)]
    }

    /// Takes that of another step for one row.
    pub(super) fn start_at(&mut self, row: usize, known: [L::Real; AT_START]) {
        let [x, y, z, w, radial, around, pull, strength] = known;
        self.put(row, [x, y, z, w], [radial, around, pull], strength);
    }

    #[inline(always)]
    pub(super) fn orbit(&mut self) -> &mut Circuit<Pack<L, R>> {
        &mut self.orbit
    }

    /// At the start of a step.
    #[inline(always)]
    pub(super) fn start<const B: usize>(&mut self, field: &Field<Pack<L, R>, B>) {
        self.is_aside = field.is_pulled_aside();
    }

    /// The orbit's series.
    #[inline(always)]
    pub(super) fn expand(&mut self, order: usize) {
        // As in `coefficient`.
        dispatch(Expand {
            orbit: &mut self.orbit,
            order,
        });
    }

    /// Goes on to the end of a step of length `h`, where the orbit has come by its own series.
    #[inline(always)]
    pub(super) fn advance(&mut self, order: usize, h: Pack<L, R>) {
        let after = self.orbit.after(order, h);
        for row in 0..R {
            let [radial, around, pull, a, b] = [0, 1, 2, 3, 4].map(|i| after[i].real(row));
            let frame = [0, 1, 2, 3].map(|i| self.frame[i].real(row));
            let zero = L::Real::default();
            let [_, _, before] = self.orbit.rates(row);
            let mut strength = self.strength.real(row);
            if before != zero {
                strength *= pull / before;
            }
            let frame = normalized(product(frame, [zero, zero, b, a]));
            self.put(row, frame, [radial, around, pull], strength);
        }
    }

    /// Comes to another unit of rates in one row: `ratio` of the old one to the new one.
    pub(super) fn rescale(&mut self, row: usize, ratio: f64) {
        let (once, twice) = (L::Real::from(ratio), L::Real::from(ratio * ratio));
        let [radial, around, pull] = self.orbit.rates(row);
        (self.orbit).set(row, [radial * once, around * once, pull * twice]);
        (self.strength).put(row, self.strength.real(row) * twice);
    }

    /// What the elements off the diagonal of the tensor add to the coefficient of order `k`.
    #[inline(never)]
    fn tilt<const B: usize>(
        &self,
        k: usize,
        field: &Field<Pack<L, R>, B>,
        products: &[Pack<L, R>; 3],
    ) -> [Pack<L, R>; 3] {
        let mut squares = [Pack::new(0.0); 3];
        let pointing = &self.pointing[..=k];
        for (a, b) in pointing.iter().zip(pointing.iter().rev()) {
            squares = [0, 1, 2].map(|i| a[i].mul_add(b[i], squares[i]));
        }
        (field.tilt(&field.pull.1, products, &squares)).map(|x| -(self.strength * x))
    }
}

/// The series of an orbit.
struct Expand<'a, T> {
    orbit: &'a mut Circuit<T>,
    order: usize,
}

impl<N: Number, const R: usize> Kernel for Expand<'_, Pack<N, R>> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lane>(self) {
        self.orbit.expand(self.order);
    }
}

// The components are written out, since a loop would keep the sums in memory.

/// `sums` and the coefficients of `c̄ q`: Re and Im of `(a − ib)(x + iy)`, then of `(a − ib)(w + iz)` as (z, w), each as what is
/// added and what is taken away.
#[inline(always)]
fn turn_terms<L: Number, const R: usize>(
    [a, b]: &[Pack<L, R>; 2],
    [x, y, z, w]: &[Pack<L, R>; 4],
    [plus, cross]: [[Pack<L, R>; 4]; 2],
) -> [[Pack<L, R>; 4]; 2] {
    [
        [
            a.mul_add(*x, plus[0]),
            a.mul_add(*y, plus[1]),
            a.mul_add(*z, plus[2]),
            a.mul_add(*w, plus[3]),
        ],
        [
            b.mul_add(*y, cross[0]),
            b.mul_add(*x, cross[1]),
            b.mul_add(*w, cross[2]),
            b.mul_add(*z, cross[3]),
        ],
    ]
}

/// The sums of the products that make m: x², w², y², z²; xy twice and zw twice; xz twice and yw twice.
type Squares<T> = [[T; 4]; 3];

/// `sums` and the products of two orders, each once.
#[inline(always)]
fn square_terms<L: Number, const R: usize>(
    [x, y, z, w]: &[Pack<L, R>; 4],
    [p, q, r, s]: &[Pack<L, R>; 4],
    [along, second, third]: Squares<Pack<L, R>>,
) -> Squares<Pack<L, R>> {
    [
        [
            x.mul_add(*p, along[0]),
            w.mul_add(*s, along[1]),
            y.mul_add(*q, along[2]),
            z.mul_add(*r, along[3]),
        ],
        [
            x.mul_add(*q, second[0]),
            y.mul_add(*p, second[1]),
            z.mul_add(*s, second[2]),
            w.mul_add(*r, second[3]),
        ],
        [
            x.mul_add(*r, third[0]),
            z.mul_add(*p, third[1]),
            y.mul_add(*s, third[2]),
            w.mul_add(*q, third[3]),
        ],
    ]
}

impl<L: Number, const R: usize, const B: usize> Analytic<Pack<L, R>, B> for Gradient<Pack<L, R>> {
    #[inline(always)]
    fn coefficient(
        &mut self,
        k: usize,
        series: &impl Series<Pack<L, R>, B>,
        field: &Field<Pack<L, R>, B>,
    ) -> [Pack<L, R>; 3] {
        // A function of its own: within a larger one the sums are not kept in registers, and the caller of numbers with
        // derivatives is not compiled for the widest lanes.
        dispatch(Next {
            gradient: self,
            k,
            q: series.get(k).q,
            field,
        })
    }
}

/// The next coefficient of a gradient.
struct Next<'a, L, const R: usize, const B: usize> {
    gradient: &'a mut Gradient<Pack<L, R>>,
    k: usize,
    q: [Pack<L, R>; 4],
    field: &'a Field<Pack<L, R>, B>,
}

impl<N: Number, const R: usize, const B: usize> Kernel for Next<'_, N, R, B> {
    type Output = [Pack<N, R>; 3];

    #[inline(always)]
    fn run<L: Lane>(self) -> [Pack<N, R>; 3] {
        self.coefficient()
    }
}

impl<L: Number, const R: usize, const B: usize> Next<'_, L, R, B> {
    #[inline(always)]
    fn coefficient(self) -> [Pack<L, R>; 3] {
        let Self {
            gradient: it,
            k,
            q: [x, y, z, w],
            field,
        } = self;
        let zero = Pack::new(0.0);
        let [a, b, c, d] = it.frame;
        it.attitude[k] = [
            d.mul_add(x, c.mul_add(y, -b.mul_add(z, a * w))),
            d.mul_add(y, a.mul_add(z, -c.mul_add(x, b * w))),
            d.mul_add(z, b.mul_add(x, -a.mul_add(y, c * w))),
            d.mul_add(w, a.mul_add(x, b.mul_add(y, c * z))),
        ];
        let mut sums = [[zero; 4]; 2];
        let half_turn = it.orbit.half_turn()[..=k].iter().rev();
        for (half, q) in half_turn.zip(&it.attitude[..=k]) {
            sums = turn_terms(half, q, sums);
        }
        let [p, s] = sums;
        it.turned[k] = [p[0] + s[0], p[1] - s[1], p[2] - s[2], p[3] + s[3]];

        let mut squares = [[zero; 4]; 3];
        let turned = &it.turned[..=k];
        for (early, late) in turned[..k.div_ceil(2)].iter().zip(turned.iter().rev()) {
            squares = square_terms(early, late, squares);
        }
        let [a, b, c] = squares;
        let along = (a[0] + a[1]) - (a[2] + a[3]);
        let mut along = along + along;
        let mut across = [(b[0] + b[1]) - (b[2] + b[3]), (c[0] + c[1]) + (c[2] + c[3])];
        if k.is_multiple_of(2) {
            let [x, y, z, w] = turned[k / 2];
            along = along + (x.mul_add(x, w * w) - y.mul_add(y, z * z));
            across = [across[0] + (x * y - z * w), across[1] + x.mul_add(z, y * w)];
        }
        it.pointing[k] = [along, across[0] + across[0], across[1] + across[1]];

        let products = dispatch(Products(&it.pointing[..=k]));
        let ([a, b, c], [p, q, r]) = (field.pull.0, products);
        let pull = -it.strength;
        let torque = [pull * a * p, pull * b * q, pull * c * r];
        if it.is_aside {
            return plus(torque, it.tilt(k, field, &products));
        }
        torque
    }
}

/// The coefficient of (m₂m₃, m₃m₁, m₁m₂) from those of m up to its order. Another function of its own.
struct Products<'a, T>(&'a [[T; 3]]);

impl<N: Number, const R: usize> Kernel for Products<'_, Pack<N, R>> {
    type Output = [Pack<N, R>; 3];

    #[inline(always)]
    fn run<L: Lane>(self) -> [Pack<N, R>; 3] {
        let half = self.0.len() / 2;
        let mut sums = [[Pack::new(0.0); 2]; 3];
        for (early, late) in self.0[..half].iter().zip(self.0.iter().rev()) {
            sums = crossed_terms(early, late, sums);
        }
        let [first, second, third] = sums;
        let (x, y) = (first[0] + first[1], second[0] + second[1]);
        let z = third[0] + third[1];
        if self.0.len().is_multiple_of(2) {
            return [x, y, z];
        }
        let [a, b, c] = self.0[half];
        [b.mul_add(c, x), c.mul_add(a, y), a.mul_add(b, z)]
    }
}

/// `sums` and the products of two orders, each once.
#[inline(always)]
fn crossed_terms<L: Number, const R: usize>(
    [a, b, c]: &[Pack<L, R>; 3],
    [p, q, r]: &[Pack<L, R>; 3],
    [first, second, third]: [[Pack<L, R>; 2]; 3],
) -> [[Pack<L, R>; 2]; 3] {
    [
        [b.mul_add(*r, first[0]), c.mul_add(*q, first[1])],
        [c.mul_add(*p, second[0]), a.mul_add(*r, second[1])],
        [a.mul_add(*q, third[0]), b.mul_add(*p, third[1])],
    ]
}
