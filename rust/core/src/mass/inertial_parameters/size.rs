//! The lengths of a shape: numbers, or numbers that carry derivatives.

use std::ops::{Div, Mul};

use nalgebra::{Matrix3, Vector3};

use super::numbers::{ELEMENTS, Ten};
use crate::error::Error;
use crate::mass::amount::{Amount, Measure, Unit, body_of_shape};
use crate::mass::body::RigidBody;
use crate::numerics::jet::Jet;
use crate::numerics::number::Real;
use crate::numerics::parabola::Parabola;

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
            type Body = Ten<Self>;

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
            ) -> Result<Ten<Self>, Error> {
                let mass = match amount {
                    Amount::Mass(mass) => Self::from(mass),
                    Amount::Density(density) => measure.value() * density,
                };
                let trace = per_mass[(0, 0)] + per_mass[(1, 1)] + per_mass[(2, 2)];
                Ok(Ten {
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
    [] Parabola, |x: Parabola| {
        let (sin, cos) = x.value.sin_cos();
        x.through([sin, cos, -sin])
    };
);
