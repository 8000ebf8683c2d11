//! The data of a top as its body has them, and its sizes in a unit of their own; numbers of any precision and powers of two.

use nalgebra::Vector3;

use crate::numerics::double_double::DoubleDouble;
use crate::numerics::elliptic::MultiPrecision;
use crate::numerics::power_of_two::{exponent, times_power_of_two};

/// The data of a top as the body has them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TopData<T = DoubleDouble> {
    pub(super) mass: f64,
    /// A vector along the axis toward C, of any length.
    pub(super) direction: [T; 3],
    pub(super) center_of_mass: Vector3<f64>,
    pub(super) axial: T,
    /// The two moments across the axis, about C.
    pub(super) lateral: [T; 2],
}

/// A top in units of its own mass and of a length `2^(exponent/2)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sizes<T> {
    /// `I_t`.
    pub(super) transverse: T,
    /// `I_s`.
    pub(super) axial: T,
    /// l over a power of two, and that power; not negative.
    pub(super) arm: (T, i32),
    /// The moments are to be multiplied by the mass and by 2 to this power.
    pub(super) exponent: i32,
}

impl<T: MultiPrecision> TopData<T> {
    /// The moments and the arm to twice the precision, in units of the top itself.
    pub(super) fn sizes(&self) -> Sizes<T> {
        let TopData {
            mass,
            direction,
            center_of_mass: c,
            axial,
            lateral,
        } = *self;
        let mass_exponent = exponent(mass);
        let mass = T::from(times_power_of_two(mass, -mass_exponent));
        let n = near_one(&direction);
        let length = sum_of_squares(&n).sqrt();
        let size = exponent(c.amax());
        let c = c.map(|x| times_power_of_two(x, -size));
        let along =
            (n.iter().zip(c.iter())).fold(T::from(0.0), |sum, (&a, &b)| sum + a * T::from(b));
        let arm = not_negative(along / length);
        // The larger of arm and radii of gyration is of the order of one.
        let [i1, i2] = lateral;
        let largest = exponent(axial.rounded().max(i1.rounded()).max(i2.rounded())) - mass_exponent;
        let exponent = largest.max(if arm.rounded() == 0.0 {
            largest
        } else {
            2 * size
        });
        let moment = |i: T| times(i, -mass_exponent - exponent) / mass;
        let squared = times(arm * arm, 2 * size - exponent);
        Sizes {
            transverse: (moment(i1) + moment(i2)).scaled(0.5) + squared,
            axial: moment(axial),
            arm: (arm, size),
            exponent,
        }
    }
}

fn not_negative<T: MultiPrecision>(x: T) -> T {
    if x.rounded() > 0.0 { x } else { T::from(0.0) }
}

/// `x 2^e`.
pub(super) fn times<T: MultiPrecision>(x: T, e: i32) -> T {
    let (mut x, mut rest) = (x, e);
    while rest != 0 && x.rounded() != 0.0 {
        let stride = rest.clamp(-1000, 1000);
        x = x.scaled(2.0_f64.powi(stride));
        rest -= stride;
    }
    x
}

/// The vector times a power of two that makes its largest component one or somewhat more.
pub(super) fn near_one<T: MultiPrecision>(vector: &[T; 3]) -> [T; 3] {
    let largest = (vector.iter()).fold(0.0_f64, |most, x| most.max(x.rounded().abs()));
    vector.map(|x| times(x, -exponent(largest)))
}

pub(super) fn sum_of_squares<T: MultiPrecision>(numbers: &[T]) -> T {
    (numbers.iter()).fold(T::from(0.0), |sum, &x| sum + x * x)
}
