//! The ten numbers of a body, in numbers of any kind: so that what a body depends on can be followed through.
//!
//! # Examples
//!
//! ```
//! use polhode::mass::inertial_parameters::{ELEMENTS, Size, InertialParameters, place};
//! use polhode::mass::{Amount, solids};
//!
//! /// The volume of a cone, of lengths that may carry derivatives.
//! fn volume<X: Size>(radius: X, height: X) -> X {
//!     radius * radius * height * (std::f64::consts::PI / 3.0)
//! }
//! assert!((volume(1.0, 3.0) - std::f64::consts::PI).abs() < 1e-15);
//!
//! let ball = InertialParameters::of(&solids::sphere(1.0, Amount::Mass(5.0))?);
//! let moved = ball.translated([3.0, 0.0, 0.0]);
//! assert_eq!(moved.center_vector().x, 3.0);
//! // About the origin m d² more, of which the elements are xx, yy, zz, xy, xz, yz.
//! assert_eq!(moved.about([0.0; 3])[place(1, 1)], 2.0 + 45.0);
//! assert_eq!(ELEMENTS[place(0, 2)], (0, 2));
//! // Two of them, 6 m apart, about their common centre.
//! let both = InertialParameters::together([(1.0, &moved), (1.0, &ball.translated([-3.0, 0.0, 0.0]))].into_iter());
//! assert_eq!((both.mass, both.tensor()[(2, 2)]), (10.0, 2.0 * 47.0));
//! # Ok::<(), polhode::Error>(())
//! ```

use std::ops::{Div, Mul};

use nalgebra::{Matrix3, Vector3};

use super::amount::{Amount, Measure, Unit, body_of_shape};
use super::body::RigidBody;
use crate::error::Error;
use crate::numerics::jet::Jet;
use crate::numerics::number::Real;
use crate::numerics::second_order_dual::SecondOrderDual;

// Mass, centre of mass and tensor about it, as ten numbers.

/// The elements of a symmetric tensor in their order: xx, yy, zz, xy, xz, yz.
pub const ELEMENTS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

/// Where element (i, j) stands among the [`ELEMENTS`].
#[must_use]
pub const fn place(i: usize, j: usize) -> usize {
    if i == j { i } else { i + j + 2 }
}

/// m, C and the elements of `I_C` (off the diagonal *minus* the products), in the axes of the body frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InertialParameters<X> {
    /// Mass.
    pub mass: X,
    /// Centre of mass, from the origin of the body frame.
    pub center: [X; 3],
    /// The [`ELEMENTS`] of the tensor about it.
    pub inertia: [X; 6],
}

impl<X: Copy> InertialParameters<X> {
    /// In the order m, C, `I_C`.
    #[must_use]
    pub fn to_array(&self) -> [X; 10] {
        std::array::from_fn(|k| match k {
            0 => self.mass,
            1..4 => self.center[k - 1],
            _ => self.inertia[k - 4],
        })
    }

    /// From that order.
    #[must_use]
    pub fn from_array(numbers: &[X; 10]) -> Self {
        Self {
            mass: numbers[0],
            center: std::array::from_fn(|k| numbers[1 + k]),
            inertia: std::array::from_fn(|k| numbers[4 + k]),
        }
    }

    /// Each of the numbers turned into another.
    #[must_use]
    pub fn map<Y: Copy>(&self, f: impl FnMut(X) -> Y) -> InertialParameters<Y> {
        InertialParameters::from_array(&self.to_array().map(f))
    }
}

impl InertialParameters<f64> {
    /// Those of a body.
    #[must_use]
    pub fn of(body: &RigidBody) -> Self {
        let tensor = body.inertia();
        Self {
            mass: body.mass(),
            center: body.center_of_mass().into(),
            inertia: ELEMENTS.map(|place| tensor[place]),
        }
    }

    /// C as a vector.
    #[must_use]
    pub fn center_vector(&self) -> Vector3<f64> {
        self.center.into()
    }

    /// The tensor as a matrix.
    #[must_use]
    pub fn tensor(&self) -> Matrix3<f64> {
        Matrix3::from_fn(|i, j| self.inertia[place(i, j)])
    }
}

/// `d² 1 − d dᵀ`, by [`ELEMENTS`].
fn lever<X: Real>(d: [X; 3]) -> [X; 6] {
    let [x, y, z] = d;
    let (xx, yy, zz) = (x * x, y * y, z * z);
    [yy + zz, xx + zz, xx + yy, -(x * y), -(x * z), -(y * z)]
}

impl<X: Real> InertialParameters<X> {
    /// The body moved by `d`.
    #[must_use]
    pub fn translated(&self, d: [X; 3]) -> Self {
        Self {
            center: std::array::from_fn(|k| self.center[k] + d[k]),
            ..*self
        }
    }

    /// The body turned about the origin: `C → R C`, `I → R I Rᵀ`, with R by rows.
    #[must_use]
    pub fn rotated(&self, R: &[[X; 3]; 3]) -> Self {
        let dot = |a: [X; 3], b: [X; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let tensor: [[X; 3]; 3] =
            std::array::from_fn(|i| std::array::from_fn(|j| self.inertia[place(i, j)]));
        let half: [[X; 3]; 3] = R.map(|row| tensor.map(|column| dot(row, column)));
        Self {
            mass: self.mass,
            center: R.map(|row| dot(row, self.center)),
            inertia: ELEMENTS.map(|(i, j)| dot(half[i], R[j])),
        }
    }

    /// The same shape `length` times as large and `mass` times as heavy.
    #[must_use]
    pub fn scaled(&self, length: X, mass: X) -> Self {
        let factor = mass * length * length;
        Self {
            mass: self.mass * mass,
            center: self.center.map(|c| c * length),
            inertia: self.inertia.map(|i| i * factor),
        }
    }

    /// Bodies put together, each with a sign: `I = Σ ± (I_k + m_k (d_k² 1 − d_k d_kᵀ))`, `d_k = C_k − C`.
    #[must_use]
    pub fn together<'a>(parts: impl Iterator<Item = (f64, &'a Self)> + Clone) -> Self {
        let (mut mass, mut first) = (X::zero(), [X::zero(); 3]);
        // About the first one, so that bodies far from the origin lose nothing.
        let reference =
            (parts.clone().next()).map_or([0.0; 3], |(_, part)| part.center.map(X::rounded));
        let from = |center: &[X; 3]| -> [X; 3] {
            std::array::from_fn(|k| center[k] - X::from(reference[k]))
        };
        for (sign, part) in parts.clone() {
            let m = part.mass * X::from(sign);
            mass += m;
            let d = from(&part.center);
            for k in 0..3 {
                first[k] += m * d[k];
            }
        }
        let mean = first.map(|sum| sum / mass);
        let mut inertia = [X::zero(); 6];
        for (sign, part) in parts {
            let sign = X::from(sign);
            let d = from(&part.center);
            let arm = lever(std::array::from_fn(|k| d[k] - mean[k]));
            for k in 0..6 {
                inertia[k] += sign * (part.inertia[k] + part.mass * arm[k]);
            }
        }
        Self {
            mass,
            center: std::array::from_fn(|k| mean[k] + X::from(reference[k])),
            inertia,
        }
    }

    /// The tensor about a point of the body frame.
    #[must_use]
    pub fn about(&self, point: [X; 3]) -> [X; 6] {
        let arm = lever(std::array::from_fn(|k| self.center[k] - point[k]));
        std::array::from_fn(|k| self.inertia[k] + self.mass * arm[k])
    }
}

// The lengths of a shape: numbers, or numbers that carry derivatives.

/// A length or an angle of a shape. What a shape of plain numbers becomes is a body; of numbers with derivatives, the ten
/// numbers of one.
pub trait Size: Real + Mul<f64, Output = Self> + Div<f64, Output = Self> {
    /// What a shape becomes.
    type Body;

    /// Its sine.
    #[must_use]
    fn sine(self) -> Self;

    /// The unit in which a shape with these lengths is counted, and the lengths in it.
    #[doc(hidden)]
    fn in_unit<const N: usize>(lengths: [Self; N]) -> (Unit, [Self; N]);

    /// What has its centre at the origin and this second moment per unit mass.
    ///
    /// # Errors
    /// When the amount of it is not positive, or a number leaves the range of float64.
    #[doc(hidden)]
    fn shape(
        unit: Unit,
        measure: Measure<Self>,
        amount: Amount,
        per_mass: &Matrix3<Self>,
    ) -> Result<Self::Body, Error>;
}

/// The body with C at the origin whose second moment per unit mass is diagonal in the body axes.
pub(in crate::mass) fn diagonal<X: Size>(
    unit: Unit,
    measure: Measure<X>,
    amount: Amount,
    per_mass: [X; 3],
) -> Result<X::Body, Error> {
    X::shape(
        unit,
        measure,
        amount,
        &Matrix3::from_diagonal(&Vector3::from(per_mass)),
    )
}

impl Size for f64 {
    type Body = RigidBody;

    fn sine(self) -> Self {
        self.sin()
    }

    #[inline]
    fn in_unit<const N: usize>(lengths: [Self; N]) -> (Unit, [Self; N]) {
        Unit::of(lengths)
    }

    fn shape(
        unit: Unit,
        measure: Measure<Self>,
        amount: Amount,
        per_mass: &Matrix3<Self>,
    ) -> Result<RigidBody, Error> {
        body_of_shape(unit, measure, amount, per_mass)
    }
}

/// Numbers with derivatives have no unit of their own: what they are derivatives of has passed through the float64 form.
macro_rules! with_derivatives {
    ($([$($generics:tt)*] $number:ty, $sine:expr;)+) => {$(
        impl<$($generics)*> Size for $number {
            type Body = InertialParameters<Self>;

            fn sine(self) -> Self {
                $sine(self)
            }

            fn in_unit<const K: usize>(lengths: [Self; K]) -> (Unit, [Self; K]) {
                (Unit::ONE, lengths)
            }

            fn shape(
                _: Unit,
                measure: Measure<Self>,
                amount: Amount,
                per_mass: &Matrix3<Self>,
            ) -> Result<InertialParameters<Self>, Error> {
                let mass = match amount {
                    Amount::Mass(mass) => Self::from(mass),
                    Amount::Density(density) => measure.value() * density,
                };
                let trace = per_mass[(0, 0)] + per_mass[(1, 1)] + per_mass[(2, 2)];
                Ok(InertialParameters {
                    mass,
                    center: [Self::from(0.0); 3],
                    inertia: ELEMENTS.map(|(i, j)| {
                        let own = per_mass[(i, j)];
                        mass * if i == j { trace - own } else { -own }
                    }),
                })
            }
        }
    )+};
}

with_derivatives!(
    [const N: usize] Jet<N>, |x: Jet<N>| {
        let zero = Jet::constant(0.0);
        Jet::chain(x.value.sin(), [(x.value.cos(), &x), (0.0, &zero)])
    };
    [] SecondOrderDual, |x: SecondOrderDual| {
        let (sin, cos) = x.value.sin_cos();
        x.through([sin, cos, -sin])
    };
);
