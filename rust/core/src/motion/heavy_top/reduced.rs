//! A heavy top in its own units and axes: what is left when sizes, directions and the choice of the body's frame are taken away.
//!
//! Seen from a frame that turns about the symmetry axis with `σ = (1 − I_s/I_t) ω_s` relative to the body, every symmetric top
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

use super::pivoted_top::PivotedTop;
use crate::motion::attitude::components;
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::power_of_two::{exponent, times_power_of_two};

/// A quaternion (x, y, z, w).
type Quaternion2 = [DoubleDouble; 4];

/// The state of a top at the start, in units of the rate `2^exponent`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reduced {
    /// The unit of all rates is 2 to this power.
    pub(super) exponent: i32,
    /// `κ = m g l/I_t`.
    pub(super) kappa: DoubleDouble,
    /// `b = I_s ω_s/I_t`.
    pub(super) spin: DoubleDouble,
    /// `ω_s`, the component of ω along the axis.
    pub(super) axial: DoubleDouble,
    /// `h = |W|²`.
    pub(super) square: DoubleDouble,
    /// `d = a − b u₀ = Re(G* W)`; the angular momentum about the vertical is `I_t a`.
    pub(super) lift: DoubleDouble,
    /// `u̇ = Im(G* W)`.
    pub(super) rate: DoubleDouble,
    /// `1 + u₀ = 2 |α|²`.
    pub(super) bottom: DoubleDouble,
    /// `1 − u₀ = 2 |β|²`.
    pub(super) top: DoubleDouble,
    /// α, β and W.
    pub(super) start: [[f64; 2]; 3],
    /// Takes the third axis of space to the upward vertical.
    pub(super) upward: Quaternion<f64>,
    /// Takes the symmetry axis to the third axis of the body.
    pub(super) aligning: Quaternion<f64>,
}

impl Reduced {
    /// Of a top with the angular velocity `omega` in B, the attitude `R_NB` and `gravity` in N, all finite.
    pub(super) fn of(
        top: &PivotedTop,
        omega: &Vector3<f64>,
        attitude: &UnitQuaternion<f64>,
        gravity: &Vector3<f64>,
    ) -> Self {
        let size = top.sizes();
        let (weight, weight_exponent) = norm(gravity);
        let (arm, arm_exponent) = size.arm;
        let kappa = weight * arm / size.transverse;
        let kappa_exponent = weight_exponent + arm_exponent - size.exponent;
        let fastest = exponent(omega.amax());
        let exponent = if kappa.high == 0.0 {
            fastest
        } else {
            fastest.max((kappa_exponent + 1).div_euclid(2))
        };
        let kappa = times(kappa, kappa_exponent - 2 * exponent);
        let scaled = omega.map(|x| times_power_of_two(x, -exponent));

        let aligning = to_third_axis(&top.direction());
        let upward = conjugate(&to_third_axis(
            &[-gravity.x, -gravity.y, -gravity.z].map(DoubleDouble::from),
        ));
        let [w1, w2, w3, _] = turned(&aligning, &scaled);
        let given = components(attitude).map(DoubleDouble::from);
        let relative = product(&product(&conjugate(&upward), &given), &conjugate(&aligning));
        let norm2 = sum_of_squares(&relative);
        let [x, y, z, w] = relative;
        let bottom = (w * w + z * z).scaled(2.0) / norm2;
        let below_top = (x * x + y * y).scaled(2.0) / norm2;
        // G = 2i α*β.
        let g1 = (y * w - z * x).scaled(-2.0) / norm2;
        let g2 = (w * x + z * y).scaled(2.0) / norm2;
        let norm = norm2.sqrt();
        let unit = |x: DoubleDouble| (x / norm).rounded();
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
        }
    }

    /// `a + b`.
    pub(super) fn sum(&self) -> DoubleDouble {
        self.lift + self.spin * self.bottom
    }

    /// `a − b`.
    pub(super) fn difference(&self) -> DoubleDouble {
        self.lift - self.spin * self.top
    }

    /// `h − 2κ (1 − u₀)`: the square that |W| would have at the top; negative where the energy does not reach it.
    pub(super) fn excess(&self) -> DoubleDouble {
        self.square - (self.kappa * self.top).scaled(2.0)
    }

    /// `2κ (a − b u_e)`, where `2κ (u_e − 1)` is the excess.
    pub(super) fn rest(&self) -> DoubleDouble {
        (self.kappa * self.difference()).scaled(2.0) - self.spin * self.excess()
    }

    /// Whether the axis rests: nothing turns it, and no torque sets it going.
    pub(super) fn is_steady(&self) -> bool {
        self.square.high == 0.0
            && (self.kappa.high == 0.0 || self.bottom.high == 0.0 || self.top.high == 0.0)
    }
}

/// `x 2^e`.
pub(super) fn times(x: DoubleDouble, e: i32) -> DoubleDouble {
    DoubleDouble {
        high: times_power_of_two(x.high, e),
        low: times_power_of_two(x.low, e),
    }
}

/// Length of a vector, as a number of the order of one and a power of two.
fn norm(vector: &Vector3<f64>) -> (DoubleDouble, i32) {
    let scaled = near_one(&[vector.x, vector.y, vector.z].map(DoubleDouble::from));
    (sum_of_squares(&scaled).sqrt(), exponent(vector.amax()))
}

/// The vector times a power of two that makes its largest component one or somewhat more.
pub(super) fn near_one(vector: &[DoubleDouble; 3]) -> [DoubleDouble; 3] {
    let largest = (vector.iter()).fold(0.0_f64, |most, x| most.max(x.high.abs()));
    vector.map(|x| times(x, -exponent(largest)))
}

/// The shortest rotation from `direction` to the third axis; from below the horizontal after half a turn about the first axis.
fn to_third_axis(direction: &[DoubleDouble; 3]) -> Quaternion2 {
    let (zero, one) = (DoubleDouble::default(), DoubleDouble::from(1.0));
    let identity = [zero, zero, zero, one];
    let flipped = [one, zero, zero, zero];
    let [x, mut y, mut z] = near_one(direction);
    let is_below = z.high < 0.0;
    if is_below {
        (y, z) = (-y, -z);
    }
    let first = if is_below { flipped } else { identity };
    if x.high == 0.0 && y.high == 0.0 {
        return first;
    }
    let length = sum_of_squares(&[x, y, z]).sqrt();
    let arc = [y, -x, zero, length + z];
    let norm = sum_of_squares(&arc).sqrt();
    product(&arc.map(|x| x / norm), &first)
}

/// The vector turned by the unit quaternion.
fn turned(q: &Quaternion2, vector: &Vector3<f64>) -> Quaternion2 {
    let v = [vector.x, vector.y, vector.z, 0.0].map(DoubleDouble::from);
    product(&product(q, &v), &conjugate(q))
}

/// `p∘q`.
fn product(p: &Quaternion2, q: &Quaternion2) -> Quaternion2 {
    let ([a, b, c, d], [x, y, z, w]) = (*p, *q);
    [
        d * x + a * w + (b * z - c * y),
        d * y + b * w + (c * x - a * z),
        d * z + c * w + (a * y - b * x),
        d * w - a * x - (b * y + c * z),
    ]
}

fn rounded(q: &Quaternion2) -> Quaternion<f64> {
    Quaternion::from(Vector4::from(q.map(DoubleDouble::rounded)))
}

fn conjugate(q: &Quaternion2) -> Quaternion2 {
    [-q[0], -q[1], -q[2], q[3]]
}

pub(super) fn sum_of_squares(numbers: &[DoubleDouble]) -> DoubleDouble {
    (numbers.iter()).fold(DoubleDouble::default(), |sum, &x| sum + x * x)
}
