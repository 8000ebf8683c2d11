//! The series of the torque by a gravity gradient.

use std::marker::PhantomData;

use nalgebra::{Matrix3, Vector3};

use super::batch::{Batch, CacheAligned, plus};
use super::equations::LinearTerms;
use super::equations::quaternion_of_matrix;
use super::orbit_series::OrbitSeries;
use super::series::{MAX_COUNT, Series};
use crate::motion::loads::OrbitState;
use crate::numerics::dispatch::{Kernel, dispatch_within};
use crate::numerics::lane::Lane;
use crate::numerics::number::{Number, Real};
use crate::numerics::quaternion::{normalized, product};

/// The gravity gradient on a Kepler orbit. Take the attitude relative to the frame of the orbit at the start of the step, turn it
/// back by the half turn of the orbit since then, and scale it (see [`OrbitSeries`]): a quaternion `Q = c̄ q` of length `r^{−3/4}`.
/// The first row of its matrix is `m = r^{−3/2} n`, with n from the attractor to C in body axes, and
///
/// ```text
/// I⁻¹ (3μ/r³) n×I n = −3μ κ (m₂m₃, m₃m₁, m₁m₂)
/// ```
///
/// with κ of the body with its wheels locked. [`LinearTerms::off_diagonal_torque`] adds the terms of elements off the diagonal of its
/// tensor.
#[derive(Clone, Debug)]
#[repr(align(64))] // see Batch
pub(super) struct GravityGradientSeries<T> {
    orbit: OrbitSeries<T>,
    /// The rotation from the frame of the orbit at the start of the step to N.
    frame: [T; 4],
    /// The attitude relative to that frame, if the series are in N, and Q.
    attitude: [[T; 4]; MAX_COUNT],
    turned: [[T; 4]; MAX_COUNT],
    /// m.
    pointing: [[T; 3]; MAX_COUNT],
    strength: T,
    /// −3μκ of the step.
    on_products: [T; 3],
    /// The coefficient of the angular acceleration that was computed last.
    coefficient: [T; 3],
    /// Whether the tensor has elements off the diagonal.
    has_off_diagonal: bool,
}

/// The slowest orbit, in units of rates, whose normal is computed: the square of this number does not underflow.
const SLOWEST: f64 = 1e-140;

/// Count of [`GravityGradientSeries::initial_numbers`].
pub(super) const INITIAL_NUMBERS: usize = 8;

impl<L: Number, const R: usize> GravityGradientSeries<Batch<L, R>> {
    const ZERO: Self = Self {
        orbit: OrbitSeries::ZERO,
        frame: [Batch::ZERO; 4],
        attitude: [[Batch::ZERO; 4]; MAX_COUNT],
        turned: [[Batch::ZERO; 4]; MAX_COUNT],
        pointing: [[Batch::ZERO; 3]; MAX_COUNT],
        strength: Batch::ZERO,
        on_products: [Batch::ZERO; 3],
        coefficient: [Batch::ZERO; 3],
        has_off_diagonal: false,
    };

    pub(super) fn new() -> Self {
        let mut gradient = Self::ZERO;
        gradient.orbit = OrbitSeries::new();
        gradient
    }

    /// Set the state of the orbit of one row at the start of a step.
    pub(super) fn set(&mut self, row: usize, at: &OrbitState<L::Real>) {
        let (n, v) = (at.position, at.velocity);
        let swept = n.cross(&v);
        let around = swept.dot(&swept).root();
        // If the term is off, or the orbit has no angular momentum, the orbit normal is undefined; take any perpendicular.
        let pole = if around.rounded() > SLOWEST {
            swept / around
        } else {
            let perpendicular = n.cross(&Vector3::ith(
                n.map(|x| x.rounded().abs()).imin(),
                1.0.into(),
            ));
            perpendicular / perpendicular.dot(&perpendicular).root()
        };
        let frame = quaternion_of_matrix(&Matrix3::from_columns(&[n, pole.cross(&n), pole]));
        self.put(row, frame, [n.dot(&v), around, at.pull], at.strength);
    }

    fn put(&mut self, row: usize, frame: [L::Real; 4], rates: [L::Real; 3], strength: L::Real) {
        for i in 0..4 {
            self.frame[i].put(row, frame[i]);
        }
        self.orbit.set(row, rates);
        self.strength.put(row, strength);
    }

    /// Return the numbers of the orbit of one row at the start of a step, as [`Self::set`] has computed them.
    pub(super) fn initial_numbers(&self, row: usize) -> [L::Real; INITIAL_NUMBERS] {
        let [x, y, z, w] = [0, 1, 2, 3].map(|i| self.frame[i].real(row));
        let [radial, around, pull] = self.orbit.rates(row);
        [x, y, z, w, radial, around, pull, self.strength.real(row)]
    }

    /// Set these numbers of one row.
    pub(super) fn restore(&mut self, row: usize, known: [L::Real; INITIAL_NUMBERS]) {
        let [x, y, z, w, radial, around, pull, strength] = known;
        self.put(row, [x, y, z, w], [radial, around, pull], strength);
    }

    /// Set these numbers of each row, and the coefficients of the half turn from order 1 on, which follow them. They were computed in
    /// a unit of rates that is `ratio` of that of the row.
    #[inline(always)]
    pub(super) fn restore_all(&mut self, known: &[&[f64]; R], ratio: Batch<L, R>) {
        let mut initial_numbers = [Batch::new(0.0); INITIAL_NUMBERS];
        for (i, number) in initial_numbers.iter_mut().enumerate() {
            for row in 0..R {
                number.set(row, known[row][i]);
            }
        }
        let ([x, y, z, w, radial, around, pull, strength], twice) =
            (initial_numbers, ratio * ratio);
        self.frame = [x, y, z, w];
        (self.orbit).set_all([radial * ratio, around * ratio, pull * twice]);
        self.strength = strength * twice;
        self.orbit.put_half_turns(known, INITIAL_NUMBERS, ratio);
    }

    #[inline(always)]
    pub(super) fn orbit(&mut self) -> &mut OrbitSeries<Batch<L, R>> {
        &mut self.orbit
    }

    /// Prepare a step.
    #[inline(always)]
    pub(super) fn start<const B: usize>(&mut self, linear_terms: &LinearTerms<Batch<L, R>, B>) {
        self.has_off_diagonal = linear_terms.pull_has_off_diagonal();
        let ([a, b, c], pull) = (linear_terms.pull.0, -self.strength);
        self.on_products = [pull * a, pull * b, pull * c];
    }

    /// Compute the series of the orbit.
    #[inline(always)]
    pub(super) fn expand(&mut self, order: usize) {
        // A separate function, as in `look_ahead`.
        dispatch_within::<L, _>(Expand {
            orbit: &mut self.orbit,
            order,
        });
    }

    /// Continue the orbit by its own series to the end of a step of length `h`.
    #[inline(always)]
    pub(super) fn advance(&mut self, order: usize, h: Batch<L, R>) {
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

    /// Transform an attitude in N to the frame of the orbit at the start of the step.
    #[inline(always)]
    pub(super) fn to_orbit_frame(&self, [x, y, z, w]: [Batch<L, R>; 4]) -> [Batch<L, R>; 4] {
        let [a, b, c, d] = self.frame;
        [
            d.mul_add(x, c * y) - b.mul_add(z, a * w),
            d.mul_add(y, a * z) - c.mul_add(x, b * w),
            d.mul_add(z, b * x) - a.mul_add(y, c * w),
            d.mul_add(w, a * x) + b.mul_add(y, c * z),
        ]
    }

    /// Transform an attitude relative to that frame to N.
    #[inline(always)]
    pub(super) fn to_space(&self, attitude: [Batch<L, R>; 4]) -> [Batch<L, R>; 4] {
        dispatch_within::<L, _>(ToSpace(self.frame, attitude)).0
    }

    /// Compute the coefficient of order `k` of the angular acceleration from that of the attitude, relative to the frame of the orbit
    /// or to N.
    #[inline(always)]
    pub(super) fn look_ahead<S: Series<Batch<L, R>, B>, const B: usize>(
        &mut self,
        k: usize,
        series: &S,
        linear_terms: &LinearTerms<Batch<L, R>, B>,
        in_orbit_frame: bool,
    ) {
        if !in_orbit_frame {
            // Stored in cache lines: see Batch.
            self.attitude[k] = self.to_orbit_frame(series.get(k).q);
        }
        // A separate function: within a larger one the sums are not kept in registers, and the caller for numbers with derivatives
        // is not compiled for the widest lanes.
        dispatch_within::<L, _>(Next {
            gradient: self,
            k,
            series: in_orbit_frame.then_some(series),
            linear_terms,
        });
    }

    /// Return the coefficient that [`Self::look_ahead`] has computed.
    #[inline(always)]
    pub(super) fn coefficient(&self) -> [Batch<L, R>; 3] {
        self.coefficient
    }

    /// Change the unit of rates in one row; `ratio` is the old unit over the new one.
    pub(super) fn rescale(&mut self, row: usize, ratio: f64) {
        let (once, twice) = (L::Real::from(ratio), L::Real::from(ratio * ratio));
        let [radial, around, pull] = self.orbit.rates(row);
        (self.orbit).set(row, [radial * once, around * once, pull * twice]);
        (self.strength).put(row, self.strength.real(row) * twice);
    }
}

/// Computes the part of a coefficient that elements off the diagonal of the tensor make, from the coefficients of m up to its order
/// and of the products of m.
struct OffDiagonalTorque<'a, T, const B: usize> {
    pointing: &'a [[T; 3]],
    products: [T; 3],
    linear_terms: &'a LinearTerms<T, B>,
    strength: T,
}

impl<N: Number, const R: usize, const B: usize> Kernel for OffDiagonalTorque<'_, Batch<N, R>, B> {
    type Output = CacheAligned<[Batch<N, R>; 3]>;

    #[inline(always)]
    fn run<L: Lane>(self) -> Self::Output {
        let mut squares = [Batch::new(0.0); 3];
        for (a, b) in self.pointing.iter().zip(self.pointing.iter().rev()) {
            for i in 0..3 {
                squares[i] = a[i].mul_add(b[i], squares[i]);
            }
        }
        let [x, y, z] = (self.linear_terms).off_diagonal_torque(
            &self.linear_terms.pull.1,
            &self.products,
            &squares,
        );
        let pull = -self.strength;
        CacheAligned([pull * x, pull * y, pull * z])
    }
}

/// Transforms an attitude relative to a frame; the frame is the first field.
struct ToSpace<T>([T; 4], [T; 4]);

impl<N: Number, const R: usize> Kernel for ToSpace<Batch<N, R>> {
    type Output = CacheAligned<[Batch<N, R>; 4]>;

    #[inline(always)]
    fn run<L: Lane>(self) -> Self::Output {
        let Self([a, b, c, d], [x, y, z, w]) = self;
        CacheAligned([
            d.mul_add(x, a * w) + b.mul_add(z, (-c) * y),
            d.mul_add(y, b * w) + c.mul_add(x, (-a) * z),
            d.mul_add(z, c * w) + a.mul_add(y, (-b) * x),
            d.mul_add(w, (-a) * x) - b.mul_add(y, c * z),
        ])
    }
}

/// Computes the series of an orbit.
struct Expand<'a, T> {
    orbit: &'a mut OrbitSeries<T>,
    order: usize,
}

impl<N: Number, const R: usize> Kernel for Expand<'_, Batch<N, R>> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lane>(self) {
        self.orbit.expand(self.order);
    }
}

/// Computes the next coefficient of a gravity gradient. Without `series` the attitude is that of the gradient itself.
struct Next<'a, L, S, const R: usize, const B: usize> {
    gradient: &'a mut GravityGradientSeries<Batch<L, R>>,
    k: usize,
    series: Option<&'a S>,
    linear_terms: &'a LinearTerms<Batch<L, R>, B>,
}

impl<N: Number, S: Series<Batch<N, R>, B>, const R: usize, const B: usize> Kernel
    for Next<'_, N, S, R, B>
{
    type Output = ();

    /// Sums of coefficients that are known before `q` come first. The terms with the newest order, which are linear in it, come last:
    /// so the processor, which may still be computing `q`, does not wait.
    #[inline(always)]
    fn run<L: Lane>(self) {
        let Self {
            gradient: it,
            k,
            series,
            linear_terms,
        } = self;
        let pointing = it.pointing[..k].get(1..).unwrap_or(&[]);
        let turned = it.turned[..k].get(1..).unwrap_or(&[]);
        let CacheAligned([first, second, third, along, aside, above]) =
            dispatch_within::<N, _>(PairedSums { pointing, turned });
        let half_turn = &it.orbit.half_turn()[1..=k];
        let (CacheAligned([e, f, g, h]), attitude) = match series {
            Some(series) => (
                dispatch_within::<N, _>(HalfTurnProduct(
                    half_turn,
                    SeriesAttitudes::<_, _, B>::new(series),
                )),
                series.get(k).q,
            ),
            None => (
                dispatch_within::<N, _>(HalfTurnProduct(half_turn, &it.attitude)),
                it.attitude[k],
            ),
        };
        // Written out: a closure of `map` would be compiled without the instructions of the level.
        let [x, y, z, w] = attitude;
        let turned = if k > 0 {
            [e + x, f + y, g + z, h + w]
        } else {
            attitude
        };
        it.turned[k] = turned;
        let [x, y, z, w] = turned;
        let (pointing, products) = if k == 0 {
            let pointing =
                pointing_from_squares(square_terms(&turned, &turned, [Batch::new(0.0); 8]));
            let [a, b, c] = pointing;
            (pointing, [b * c, c * a, a * b])
        } else {
            // m is twice the products of two orders.
            let [p, q, r, s] = it.turned[0];
            let [p, q, r, s] = [p + p, q + q, r + r, s + s];
            let a = x.mul_add(p, w.mul_add(s, along)) - y.mul_add(q, z * r);
            let b = x.mul_add(q, y.mul_add(p, aside)) - z.mul_add(s, w * r);
            let c = x.mul_add(r, z.mul_add(p, above)) + y.mul_add(s, w * q);
            let [p, q, r] = it.pointing[0];
            let products = [
                b.mul_add(r, c.mul_add(q, first)),
                c.mul_add(p, a.mul_add(r, second)),
                a.mul_add(q, b.mul_add(p, third)),
            ];
            ([a, b, c], products)
        };
        it.pointing[k] = pointing;
        let ([a, b, c], [p, q, r]) = (it.on_products, products);
        it.coefficient = [a * p, b * q, c * r];
        if it.has_off_diagonal {
            let CacheAligned(off_diagonal) = dispatch_within::<N, _>(OffDiagonalTorque {
                pointing: &it.pointing[..=k],
                products,
                linear_terms,
                strength: it.strength,
            });
            it.coefficient = plus(it.coefficient, off_diagonal);
        }
    }
}

// Sums of products for the torque.

// The components are written out: a loop would keep the sums in memory.

/// Add the products for a coefficient of `c̄ q`, that is `(a − ib)(x + iy)` and `(a − ib)(w + iz)`, to `sums`: three real products
/// each, as in [`series`](super::series). They are `a (x + y)`, `(a + b) x` and `(a − b) y`; Re is the first minus the third, Im the
/// first minus the second.
#[inline(always)]
fn turn_terms<L: Number, const R: usize>(
    [a, b]: &[Batch<L, R>; 2],
    [x, y, z, w]: &[Batch<L, R>; 4],
    [beta, alpha]: [[Batch<L, R>; 3]; 2],
) -> [[Batch<L, R>; 3]; 2] {
    let (sum, difference) = (*a + *b, *a - *b);
    [
        [
            a.mul_add(*x + *y, beta[0]),
            sum.mul_add(*x, beta[1]),
            difference.mul_add(*y, beta[2]),
        ],
        [
            a.mul_add(*w + *z, alpha[0]),
            sum.mul_add(*w, alpha[1]),
            difference.mul_add(*z, alpha[2]),
        ],
    ]
}

/// Sums of squares for m: of x, y, z, w, then of x + y, z + w, x + z, y + w.
type Squares<T> = [T; 8];

/// Add the products of two orders, each once, to `sums`.
#[inline(always)]
fn square_terms<L: Number, const R: usize>(
    [x, y, z, w]: &[Batch<L, R>; 4],
    [p, q, r, s]: &[Batch<L, R>; 4],
    sums: Squares<Batch<L, R>>,
) -> Squares<Batch<L, R>> {
    [
        x.mul_add(*p, sums[0]),
        y.mul_add(*q, sums[1]),
        z.mul_add(*r, sums[2]),
        w.mul_add(*s, sums[3]),
        (*x + *y).mul_add(*p + *q, sums[4]),
        (*z + *w).mul_add(*r + *s, sums[5]),
        (*x + *z).mul_add(*p + *r, sums[6]),
        (*y + *w).mul_add(*q + *s, sums[7]),
    ]
}

/// Add the products of two orders of m, each once, to the sums.
#[inline(always)]
fn crossed_terms<L: Number, const R: usize>(
    [a, b, c]: &[Batch<L, R>; 3],
    [p, q, r]: &[Batch<L, R>; 3],
    [first, second, third]: [[Batch<L, R>; 2]; 3],
) -> [[Batch<L, R>; 2]; 3] {
    [
        [b.mul_add(*r, first[0]), c.mul_add(*q, first[1])],
        [c.mul_add(*p, second[0]), a.mul_add(*r, second[1])],
        [a.mul_add(*q, third[0]), b.mul_add(*p, third[1])],
    ]
}

/// Compute half of the coefficient of m = (x² + w² − y² − z², 2 (xy − zw), 2 (xz + yw)) from the products of two orders, each once; or
/// the whole coefficient from those of one order with itself.
#[inline(always)]
fn pointing_from_squares<L: Number, const R: usize>(
    [x, y, z, w, xy, zw, xz, yw]: Squares<Batch<L, R>>,
) -> [Batch<L, R>; 3] {
    let (first, last) = (x + y, z + w);
    [
        (x - y) + (w - z),
        (xy - first) - (zw - last),
        (xz + yw) - (first + last),
    ]
}

// Each of these sums is a separate function: within a larger one they are not kept in registers.

/// Sums the products of coefficients of m and of Q, the first with the last and so on: their parts of a coefficient of
/// (m₂m₃, m₃m₁, m₁m₂), and of one of m.
struct PairedSums<'a, T> {
    pointing: &'a [[T; 3]],
    /// As many as of m.
    turned: &'a [[T; 4]],
}

impl<N: Number, const R: usize> Kernel for PairedSums<'_, Batch<N, R>> {
    type Output = CacheAligned<[Batch<N, R>; 6]>;

    #[inline(always)]
    fn run<L: Lane>(self) -> Self::Output {
        let Self { pointing, turned } = self;
        let count = pointing.len();
        let half = count / 2;
        let mut crossed = [[Batch::new(0.0); 2]; 3];
        let mut squared = [Batch::new(0.0); 8];
        let early = pointing[..half].iter().zip(&turned[..half]).rev();
        let late = pointing[count - half..].iter().zip(&turned[count - half..]);
        for ((m, q), (n, p)) in early.zip(late) {
            crossed = crossed_terms(m, n, crossed);
            squared = square_terms(q, p, squared);
        }
        let [first, second, third] = crossed;
        let (x, y) = (first[0] + first[1], second[0] + second[1]);
        let z = third[0] + third[1];
        let [s, t, u] = pointing_from_squares(squared);
        let [s, t, u] = [s + s, t + t, u + u];
        if count.is_multiple_of(2) {
            return CacheAligned([x, y, z, s, t, u]);
        }
        let ([a, b, c], middle) = (pointing[half], &turned[half]);
        let [d, e, f] = pointing_from_squares(square_terms(middle, middle, [Batch::new(0.0); 8]));
        CacheAligned([
            b.mul_add(c, x),
            c.mul_add(a, y),
            a.mul_add(b, z),
            s + d,
            t + e,
            u + f,
        ])
    }
}

/// Coefficients of an attitude, by their orders.
trait AttitudeCoefficients<T> {
    fn at(&self, order: usize) -> [T; 4];
}

impl<T: Copy, const COUNT: usize> AttitudeCoefficients<T> for &[[T; 4]; COUNT] {
    #[inline(always)]
    fn at(&self, order: usize) -> [T; 4] {
        self[order]
    }
}

/// Coefficients of the attitude in the series of a motion.
struct SeriesAttitudes<'a, S, T, const B: usize>(&'a S, PhantomData<T>);

impl<'a, S, T, const B: usize> SeriesAttitudes<'a, S, T, B> {
    #[inline(always)]
    fn new(series: &'a S) -> Self {
        Self(series, PhantomData)
    }
}

impl<T: Copy, S: Series<T, B>, const B: usize> AttitudeCoefficients<T>
    for SeriesAttitudes<'_, S, T, B>
{
    #[inline(always)]
    fn at(&self, order: usize) -> [T; 4] {
        self.0.get(order).q
    }
}

/// Sums the products of the slice, backward, with the coefficients from order 0 on: their part of a coefficient of `c̄ q`.
struct HalfTurnProduct<'a, T, Q>(&'a [[T; 2]], Q);

impl<N: Number, Q: AttitudeCoefficients<Batch<N, R>>, const R: usize> Kernel
    for HalfTurnProduct<'_, Batch<N, R>, Q>
{
    type Output = CacheAligned<[Batch<N, R>; 4]>;

    #[inline(always)]
    fn run<L: Lane>(self) -> Self::Output {
        let mut sums = [[Batch::new(0.0); 3]; 2];
        for (order, half) in self.0.iter().rev().enumerate() {
            sums = turn_terms(half, &self.1.at(order), sums);
        }
        let [[p, q, r], [s, t, u]] = sums;
        CacheAligned([p - r, p - q, s - t, s - u])
    }
}
