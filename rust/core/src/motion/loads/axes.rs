//! The principal axes of what a load acts on, in numbers of any precision.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::subject::Subject;
use crate::motion::attitude::components;
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::number::Real;
use crate::numerics::quaternion::normalized;

/// A number in which laws can be stated.
pub trait Exact: Real {
    /// (x, y, z, w) of a rotation, whose direction alone counts.
    fn quaternion(rotation: &UnitQuaternion<f64>) -> [Self; 4];
}

impl Exact for f64 {
    fn quaternion(rotation: &UnitQuaternion<f64>) -> [Self; 4] {
        components(rotation)
    }
}

impl Exact for DoubleDouble {
    fn quaternion(rotation: &UnitQuaternion<f64>) -> [Self; 4] {
        normalized(components(rotation).map(Self::from))
    }
}

/// The principal axes of what a load acts on.
#[derive(Clone, Copy, Debug)]
pub struct Axes<'s, X> {
    /// What it acts on.
    pub subject: &'s Subject,
    /// Columns, in B.
    pub columns: &'s Matrix3<X>,
    /// (x, y, z, w) of the rotation from principal axes to B.
    pub q_bp: &'s [X; 4],
}

impl<X: Exact> Axes<'_, X> {
    /// A vector of B, components in principal axes.
    pub(super) fn principal(&self, vector: &Vector3<X>) -> Vector3<X> {
        self.columns.tr_mul(vector)
    }

    /// A tensor of B, components in principal axes.
    pub(super) fn tensor(&self, matrix: &Matrix3<f64>) -> Matrix3<X> {
        self.columns.tr_mul(&matrix.map(X::from)) * self.columns
    }
}

/// A vector in numbers of another precision.
pub(super) fn exact<X: Real>(vector: &Vector3<f64>) -> Vector3<X> {
    vector.map(X::from)
}
