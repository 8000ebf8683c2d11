//! The principal axes of what a load acts on, in numbers of any precision.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::body_at_point::BodyAtPoint;
use super::variables::{Block, CENTER, Fixed, MASS, ParameterColumns, Variables, VariationJet};
use crate::motion::attitude::components;
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::number::Real;
use crate::numerics::quaternion::normalized;

/// A number in which laws can be stated.
pub(crate) trait LawNumber: Real {
    /// What tells which of the numbers of a problem are varied.
    type Variables: Variables<Self>;

    /// (x, y, z, w) of a rotation, whose direction alone counts.
    fn quaternion(rotation: &UnitQuaternion<f64>) -> [Self; 4];

    /// Correction to the derivatives when a motion crosses a switching surface (saltation): neighbouring motions cross it at another
    /// time. `switch` is the switching function, `rate` its time derivative. Zero for numbers without derivatives.
    #[must_use]
    fn saltation(self, switch: Self, rate: f64) -> Self;
}

impl LawNumber for f64 {
    type Variables = Fixed;

    fn quaternion(rotation: &UnitQuaternion<f64>) -> [Self; 4] {
        components(rotation)
    }

    fn saltation(self, _: Self, _: f64) -> Self {
        0.0
    }
}

impl LawNumber for DoubleDouble {
    type Variables = Fixed;

    fn quaternion(rotation: &UnitQuaternion<f64>) -> [Self; 4] {
        normalized(components(rotation).map(Self::from))
    }

    fn saltation(self, _: Self, _: f64) -> Self {
        Self::default()
    }
}

impl LawNumber for VariationJet {
    type Variables = Block;

    fn quaternion(rotation: &UnitQuaternion<f64>) -> [Self; 4] {
        components(rotation).map(Self::constant)
    }

    fn saltation(self, switch: Self, rate: f64) -> Self {
        Self {
            value: 0.0,
            slopes: switch.slopes.map(|slope| -slope / rate * self.value),
        }
    }
}

/// The principal axes of what a load acts on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PrincipalFrame<'s, X: LawNumber> {
    /// What it acts on.
    pub body: &'s BodyAtPoint,
    /// Columns, in B.
    pub columns: &'s Matrix3<X>,
    /// (x, y, z, w) of the rotation from principal axes to B.
    pub q_bp: &'s [X; 4],
    /// Which numbers are varied.
    pub variables: X::Variables,
    /// The columns of the numbers of the term that is asked, and its index in the load.
    pub parameters: &'s ParameterColumns,
    pub term: usize,
    /// A time within the span under way, which has no breaks.
    pub middle: f64,
}

impl<X: LawNumber> PrincipalFrame<'_, X> {
    /// A vector of B, components in principal axes.
    pub(crate) fn principal(&self, vector: &Vector3<X>) -> Vector3<X> {
        self.columns.tr_mul(vector)
    }

    /// A tensor of B, components in principal axes.
    pub(super) fn tensor(&self, matrix: &Matrix3<X>) -> Matrix3<X> {
        self.columns.tr_mul(matrix) * self.columns
    }

    /// Numbers of the term of this name: a number, a vector, a matrix.
    pub(super) fn number(&self, value: f64, name: &str) -> X {
        self.element(value, name, 0)
    }

    pub(super) fn vector(&self, value: &Vector3<f64>, name: &str) -> Vector3<X> {
        self.variables.vector(value, self.parameters.of(name).start)
    }

    pub(super) fn matrix(&self, value: &Matrix3<f64>, name: &str) -> Matrix3<X> {
        self.variables.matrix(value, self.parameters.of(name).start)
    }

    /// One of the numbers of this name.
    pub(super) fn element(&self, value: f64, name: &str, index: usize) -> X {
        let column = self.parameters.of(name).start + index;
        self.variables.number(value, column)
    }

    /// The number minus its value: numerically zero, but it carries the derivative.
    pub(super) fn variation(&self, value: f64, name: &str, index: usize) -> X {
        self.element(value, name, index) - X::from(value)
    }

    /// Whether one of the numbers of this name is varied.
    pub(super) fn varies(&self, name: &str) -> bool {
        self.variables.varies(self.parameters.of(name))
    }

    /// m.
    pub(super) fn mass(&self) -> X {
        self.variables.number(self.body.mass, MASS)
    }

    /// P from the origin of B: C where the body is free.
    pub(super) fn point(&self) -> Vector3<X> {
        if self.body.pivoted {
            exact(&self.body.point)
        } else {
            self.variables.vector(&self.body.point, CENTER)
        }
    }

    /// C from P.
    pub(super) fn center(&self) -> Vector3<X> {
        if self.body.pivoted {
            self.variables.vector(&self.body.center, CENTER)
        } else {
            exact(&self.body.center)
        }
    }
}

/// A vector in numbers of another precision.
pub(super) fn exact<X: Real>(vector: &Vector3<f64>) -> Vector3<X> {
    vector.map(X::from)
}
