//! What acts between two breaks, as far as it is linear in what varies: what the laws of a load add up to in a series.

use nalgebra::{Matrix3, Matrix3x4, UnitQuaternion, Vector3};

use super::gravity_gradient::GravityGradient;
use super::sampled::Sampled;
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

/// Torques about the reference point in principal axes, linear in what varies, and what is not linear besides.
#[derive(Clone, Debug)]
pub struct Linear<'a, X> {
    /// Constant in the body.
    pub constant: Vector3<X>,
    /// Times ω.
    pub on_omega: Matrix3<X>,
    /// Times the attitude (x, y, z, w) of the principal axes.
    pub on_attitude: Matrix3x4<X>,
    /// E of a torque `−E |ω| ω`.
    pub quadratic: Matrix3<X>,
    /// Torques `M R_PN v` of vectors v fixed in space.
    pub on_space: Vec<(Vector3<X>, Matrix3<X>)>,
    /// Force in N.
    pub force: Vector3<X>,
    /// Force constant in the body, in principal axes.
    pub thrust: Vector3<X>,
    /// Torques sampled in time.
    pub sampled: Vec<&'a Sampled>,
    /// Gravity gradients.
    pub gradients: Vec<&'a GravityGradient>,
}

impl<X: Real> Default for Linear<'_, X> {
    fn default() -> Self {
        Self {
            constant: Vector3::zeros(),
            on_omega: Matrix3::zeros(),
            on_attitude: Matrix3x4::zeros(),
            quadratic: Matrix3::zeros(),
            on_space: Vec::new(),
            force: Vector3::zeros(),
            thrust: Vector3::zeros(),
            sampled: Vec::new(),
            gradients: Vec::new(),
        }
    }
}

/// A vector in numbers of another precision.
pub(super) fn exact<X: Real>(vector: &Vector3<f64>) -> Vector3<X> {
    vector.map(X::from)
}
