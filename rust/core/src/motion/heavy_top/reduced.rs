//! A heavy top in its own units and axes: what is left when sizes, directions and the choice of the body's frame are taken away.
//!
//! Seen from a frame relative to which the body turns about its symmetry axis with `σ = (1 − I_s/I_t) ω_s`, every symmetric top
//! moves as a spherical one with `b = I_s ω_s/I_t` in place of its spin (F. Klein and A. Sommerfeld, Über die Theorie des
//! Kreisels, chapter IV). In that frame, with the third axis along the symmetry axis, and in a space whose third axis points
//! up, `α = q_w + i q_z`, `β = q_x + i q_y` and `W = ω₁ + i ω₂` obey
//!
//! ```text
//! α̇ = ½ (i b α − β W*)    β̇ = ½ (α W − i b β)    Ẇ = −i κ G    κ = m g l/I_t    G = γ₁ + i γ₂ = 2i α*β
//! ```
//!
//! with γ the upward vertical in the body. All numbers are in double-double: over a million turns the last bit of a double
//! is 1e-9 rad.

use nalgebra::{Quaternion, UnitQuaternion, Vector3, Vector4};

use super::top_data::TopData;
use super::top_data::{near_one, sum_of_squares, times};
use crate::motion::attitude::components;
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::elliptic::MultiPrecision;
use crate::numerics::power_of_two::{exponent, times_power_of_two};
use crate::numerics::quad_double::QuadDouble;

/// A quaternion (x, y, z, w).
type Components<T> = [T; 4];

/// The state of a top at the start, in units of the rate `2^exponent`.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReducedTop<T = DoubleDouble> {
    /// The unit of all rates is 2 to this power.
    pub(super) exponent: i32,
    /// `κ = m g l/I_t`.
    pub(super) kappa: T,
    /// `b = I_s ω_s/I_t`.
    pub(super) spin: T,
    /// `ω_s`, the component of ω along the axis.
    pub(super) axial: T,
    /// `h = |W|²`.
    pub(super) square: T,
    /// `d = a − b u₀ = Re(G* W)`; the angular momentum about the vertical is `I_t a`.
    pub(super) lift: T,
    /// `u̇ = Im(G* W)`.
    pub(super) rate: T,
    /// `1 + u₀ = 2 |α|²`.
    pub(super) bottom: T,
    /// `1 − u₀ = 2 |β|²`.
    pub(super) top: T,
    /// α, β and W.
    pub(super) start: [[f64; 2]; 3],
    /// Takes the third axis of space to the upward vertical.
    pub(super) upward: Quaternion<f64>,
    /// Takes the symmetry axis to the third axis of the body.
    pub(super) aligning: Quaternion<f64>,
    /// Whether neither of the two rounds anything.
    is_aligned: bool,
}

/// A few units in the last place of what has twice the precision.
const ROUNDING: f64 = 4.9e-32; // 2⁻¹⁰⁴

/// The same of what has four times the precision, with room for the turns of the frames.
const FINER_ROUNDING: f64 = 6.2e-61; // 2⁻²⁰⁰

/// Squares of leans and rates below this part of what they are squares of are none: their products would be lost.
const LEAST: f64 = 1e-280;

impl ReducedTop<QuadDouble> {
    /// Upright, hanging or without a rate across the axis where no more of it is left than what turning the frames rounds: so a
    /// top that stands upright along any axis stays there.
    pub(super) fn without_rounding(self) -> Self {
        if self.is_aligned {
            return self;
        }
        self.without(FINER_ROUNDING * FINER_ROUNDING)
    }
}

impl<T: MultiPrecision> ReducedTop<T> {
    /// Of a top with the angular velocity `omega` in B, the attitude `R_NB` and `gravity` in N, all finite.
    pub(super) fn of(
        top: &TopData<T>,
        omega: &Vector3<f64>,
        attitude: &UnitQuaternion<f64>,
        gravity: &Vector3<f64>,
    ) -> Self {
        let size = top.sizes();
        let (weight, weight_exponent) = norm::<T>(gravity);
        let (arm, arm_exponent) = size.arm;
        let kappa = weight * arm / size.transverse;
        let kappa_exponent = weight_exponent + arm_exponent - size.exponent;
        let fastest = exponent(omega.amax());
        let exponent = if kappa.rounded() == 0.0 {
            fastest
        } else {
            fastest.max((kappa_exponent + 1).div_euclid(2))
        };
        let kappa = times(kappa, kappa_exponent - 2 * exponent);
        let scaled = omega.map(|x| times_power_of_two(x, -exponent));

        let aligning = to_third_axis(&top.direction);
        let upward = conjugate(&to_third_axis(
            &[-gravity.x, -gravity.y, -gravity.z].map(T::from),
        ));
        let [w1, w2, w3, _] = rotate_vector(&aligning, &scaled);
        let given = components(attitude).map(T::from);
        let relative = product(&product(&conjugate(&upward), &given), &conjugate(&aligning));
        let norm2 = sum_of_squares(&relative);
        let [x, y, z, w] = relative;
        let bottom = (w * w + z * z).scaled(2.0) / norm2;
        let below_top = (x * x + y * y).scaled(2.0) / norm2;
        // G = 2i α*β.
        let g1 = (y * w - z * x).scaled(-2.0) / norm2;
        let g2 = (w * x + z * y).scaled(2.0) / norm2;
        let norm = norm2.sqrt();
        let unit = |x: T| (x / norm).rounded();
        Self {
            exponent,
            kappa,
            spin: w3 * size.axial / size.transverse,
            axial: w3,
            square: w1 * w1 + w2 * w2,
            lift: g1 * w1 + g2 * w2,
            rate: g1 * w2 - g2 * w1,
            bottom,
            top: below_top,
            start: [
                [unit(w), unit(z)],
                [unit(x), unit(y)],
                [w1.rounded(), w2.rounded()],
            ],
            upward: rounded(&upward),
            aligning: rounded(&aligning),
            is_aligned: [aligning, upward].as_flattened().iter().all(|x| {
                let x = x.rounded().abs();
                x == 0.0 || x == 1.0
            }),
        }
        .without(LEAST)
    }

    /// Exactly upright, hanging or without a rate across the axis, where the squares of lean or rate are below `least`.
    fn without(mut self, least: f64) -> Self {
        let nothing = T::from(0.0);
        let fastest = self.square.rounded() + self.axial.rounded() * self.axial.rounded();
        let mut parts = [
            (&mut self.bottom, 1.0),
            (&mut self.top, 1.0),
            (&mut self.square, fastest),
        ];
        for ((part, whole), start) in parts.iter_mut().zip(&mut self.start) {
            if part.rounded() <= least * *whole {
                (**part, *start) = (nothing, [0.0; 2]);
                (self.lift, self.rate) = (nothing, nothing);
            }
        }
        self
    }

    /// The same to twice the precision.
    pub(super) fn twofold(&self) -> ReducedTop {
        ReducedTop {
            exponent: self.exponent,
            kappa: self.kappa.twofold(),
            spin: self.spin.twofold(),
            axial: self.axial.twofold(),
            square: self.square.twofold(),
            lift: self.lift.twofold(),
            rate: self.rate.twofold(),
            bottom: self.bottom.twofold(),
            top: self.top.twofold(),
            start: self.start,
            upward: self.upward,
            aligning: self.aligning,
            is_aligned: self.is_aligned,
        }
    }

    /// What rounding to twice the precision may have taken from the value of f at the top and from its slope there, the two
    /// numbers that tell how near the motion is to its separatrix: a part of their terms, and of what a small component of a
    /// turned vector is a difference of.
    pub(super) fn rounding_loss(&self) -> f64 {
        let [kappa, b, h, lift, top] =
            [self.kappa, self.spin, self.square, self.lift, self.top].map(|x| x.rounded().abs());
        let terms = h + 2.0 * kappa * top + b * (lift + b * top);
        if self.is_aligned {
            return ROUNDING * terms;
        }
        let (across, lean) = (h.sqrt(), top.sqrt());
        let fastest = across.hypot(self.axial.rounded());
        let turned = across * fastest + lean * kappa + b * (across + lean * (fastest + b));
        ROUNDING * (terms + turned)
    }

    /// `a + b`.
    pub(super) fn sum(&self) -> T {
        self.lift + self.spin * self.bottom
    }

    /// `a − b`.
    pub(super) fn difference(&self) -> T {
        self.lift - self.spin * self.top
    }

    /// `h − 2κ (1 − u₀)`: the square that |W| would have at the top; negative where the energy does not reach it.
    pub(super) fn excess(&self) -> T {
        self.square - (self.kappa * self.top).scaled(2.0)
    }

    /// `2κ (a − b u_e)`, where `2κ (u_e − 1)` is the excess.
    pub(super) fn rest(&self) -> T {
        (self.kappa * self.difference()).scaled(2.0) - self.spin * self.excess()
    }

    /// Whether the axis rests: nothing turns it, and no torque sets it going.
    pub(super) fn is_steady(&self) -> bool {
        self.square.rounded() == 0.0
            && (self.kappa.rounded() == 0.0
                || self.bottom.rounded() == 0.0
                || self.top.rounded() == 0.0)
    }
}

/// Length of a vector, as a number of the order of one and a power of two.
fn norm<T: MultiPrecision>(vector: &Vector3<f64>) -> (T, i32) {
    let scaled = near_one(&[vector.x, vector.y, vector.z].map(T::from));
    (sum_of_squares(&scaled).sqrt(), exponent(vector.amax()))
}

/// The shortest rotation from `direction` to the third axis; from below the horizontal after half a turn about the first axis.
fn to_third_axis<T: MultiPrecision>(direction: &[T; 3]) -> Components<T> {
    let (zero, one) = (T::from(0.0), T::from(1.0));
    let identity = [zero, zero, zero, one];
    let flipped = [one, zero, zero, zero];
    let [x, mut y, mut z] = near_one(direction);
    let is_below = z.rounded() < 0.0;
    if is_below {
        (y, z) = (-y, -z);
    }
    let first = if is_below { flipped } else { identity };
    if x.rounded() == 0.0 && y.rounded() == 0.0 {
        return first;
    }
    let length = sum_of_squares(&[x, y, z]).sqrt();
    let arc = [y, -x, zero, length + z];
    let norm = sum_of_squares(&arc).sqrt();
    product(&arc.map(|x| x / norm), &first)
}

/// The vector turned by the unit quaternion.
fn rotate_vector<T: MultiPrecision>(q: &Components<T>, vector: &Vector3<f64>) -> Components<T> {
    let v = [vector.x, vector.y, vector.z, 0.0].map(T::from);
    product(&product(q, &v), &conjugate(q))
}

/// `p∘q`.
fn product<T: MultiPrecision>(p: &Components<T>, q: &Components<T>) -> Components<T> {
    let ([a, b, c, d], [x, y, z, w]) = (*p, *q);
    [
        d * x + a * w + (b * z - c * y),
        d * y + b * w + (c * x - a * z),
        d * z + c * w + (a * y - b * x),
        d * w - a * x - (b * y + c * z),
    ]
}

fn rounded<T: MultiPrecision>(q: &Components<T>) -> Quaternion<f64> {
    Quaternion::from(Vector4::from(q.map(T::rounded)))
}

fn conjugate<T: MultiPrecision>(q: &Components<T>) -> Components<T> {
    [-q[0], -q[1], -q[2], q[3]]
}
