//! Force and torque.

use std::iter::Sum;
use std::ops::{Add, AddAssign};

use nalgebra::{UnitQuaternion, Vector3};

use crate::error::{Error, all_finite};
use crate::motion::kinematics::Frame;

/// A force through the reference point together with a torque about it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// Components in N.
    pub force: Vector3<f64>,
    /// Components in B.
    pub torque: Vector3<f64>,
}

impl Wrench {
    /// A torque alone.
    #[must_use]
    #[inline]
    pub fn couple(torque: Vector3<f64>) -> Self {
        Self {
            force: Vector3::zeros(),
            torque,
        }
    }
}

impl Add for Wrench {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self {
            force: self.force + other.force,
            torque: self.torque + other.torque,
        }
    }
}

impl AddAssign for Wrench {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sum for Wrench {
    #[inline]
    fn sum<I: Iterator<Item = Self>>(wrenches: I) -> Self {
        wrenches.fold(Self::default(), Add::add)
    }
}

/// A vector constant in `frame`, components in B.
#[inline]
pub(super) fn in_body(
    vector: &Vector3<f64>,
    frame: Frame,
    attitude: &UnitQuaternion<f64>,
) -> Vector3<f64> {
    match frame {
        Frame::Body => *vector,
        Frame::Space => attitude.inverse_transform_vector(vector),
    }
}

/// `factor` times the vector of a load.
#[inline]
pub(super) fn times(vector: &Vector3<f64>, factor: f64) -> Result<Vector3<f64>, Error> {
    let product = vector * factor;
    all_finite("the load times its factor", &product).map(|()| product)
}
