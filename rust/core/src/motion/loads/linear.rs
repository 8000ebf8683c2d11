//! What acts between two breaks, as far as it is linear in what varies: what the laws of a load add up to in a series.

use nalgebra::{Matrix3, Matrix3x4, Vector3};

use super::axes::Exact;
use super::forcing::Timed;

/// Torques about the reference point in principal axes, linear in what varies, and what is not linear besides.
#[derive(Clone, Debug)]
pub struct Linear<'a, X: Exact> {
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
    /// What depends on the time, each with the column of its first number.
    pub timed: Vec<(usize, &'a dyn Timed<X>)>,
}

impl<X: Exact> Default for Linear<'_, X> {
    fn default() -> Self {
        Self {
            constant: Vector3::zeros(),
            on_omega: Matrix3::zeros(),
            on_attitude: Matrix3x4::zeros(),
            quadratic: Matrix3::zeros(),
            on_space: Vec::new(),
            force: Vector3::zeros(),
            thrust: Vector3::zeros(),
            timed: Vec::new(),
        }
    }
}
