//! What acts between two breaks, as far as it is linear in what varies: what the laws of a load add up to in a series.

use nalgebra::{Matrix3, Matrix3x4, Vector3, Vector4};

use super::axes::Exact;
use super::forcing::Timed;
use super::formula::Formula;

/// Torques about the reference point in principal axes, linear in what varies, and what is not linear besides.
#[derive(Clone, Debug)]
pub(crate) struct Linear<'a, X: Exact> {
    /// Constant in the body.
    pub constant: Vector3<X>,
    /// Times ω.
    pub on_omega: Matrix3<X>,
    /// Times the attitude (x, y, z, w) of the principal axes.
    pub on_attitude: Matrix3x4<X>,
    /// Torques that are not linear in ω.
    pub formulas: Vec<Formula<X>>,
    /// Torques `M R_PN v` of vectors v fixed in space.
    pub on_space: Vec<(Vector3<X>, Matrix3<X>)>,
    /// Force in N.
    pub force: Vector3<X>,
    /// Force constant in the body, in principal axes.
    pub thrust: Vector3<X>,
    /// What depends on the time, each with the column of its first number.
    pub timed: Vec<(usize, &'a dyn Timed<X>)>,
    /// The states that the load has of its own.
    pub own: Vec<Own<X>>,
    /// Σ J a aᵀ of the wheels that turn freely, which is not part of the tensor of the equations, but is pulled by gravity.
    pub turning: Matrix3<X>,
}

impl<X: Exact> Default for Linear<'_, X> {
    fn default() -> Self {
        Self {
            constant: Vector3::zeros(),
            on_omega: Matrix3::zeros(),
            on_attitude: Matrix3x4::zeros(),
            formulas: Vec::new(),
            on_space: Vec::new(),
            force: Vector3::zeros(),
            thrust: Vector3::zeros(),
            timed: Vec::new(),
            own: Vec::new(),
            turning: Matrix3::zeros(),
        }
    }
}

/// A state z of the load's own: what it does to the body, and what becomes of it. Vectors in principal axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Own<X: Exact> {
    /// The torque `z p` about the reference point.
    pub torque: Vector3<X>,
    /// The momentum `z g` that turns with the body: a torque `−ω × z g`.
    pub momentum: Vector3<X>,
    /// Its rate: constant, times itself, times ω, times the attitude (x, y, z, w).
    pub constant: X,
    /// Times itself.
    pub on_itself: X,
    /// Times ω.
    pub on_omega: Vector3<X>,
    /// Times the attitude (x, y, z, w).
    pub on_attitude: Vector4<X>,
    /// Of a component of a vector s that has the rate `−ω × s` besides: the number of the state that is its first, and which
    /// component it is.
    pub turned: Option<(usize, usize)>,
    /// What counts as large is that times the largest |ω|, or what it has come to.
    pub size: f64,
    /// What is reported of it is the state itself and that times ω.
    pub reported_on_omega: Vector3<X>,
}

impl<X: Exact> Default for Own<X> {
    fn default() -> Self {
        Self {
            torque: Vector3::zeros(),
            momentum: Vector3::zeros(),
            constant: X::zero(),
            on_itself: X::zero(),
            on_omega: Vector3::zeros(),
            on_attitude: Vector4::zeros(),
            turned: None,
            size: 1.0,
            reported_on_omega: Vector3::zeros(),
        }
    }
}
