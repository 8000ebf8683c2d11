//! The variables of a motion: the numbers of its start, its body and its load, of which some may be varied.
//!
//! A law states its equations in numbers of any kind. Where these carry derivatives, its own numbers are asked for here, so
//! that each comes with the derivative by itself.

use std::fmt::Debug;
use std::ops::Range;

use nalgebra::{Matrix3, Vector3};

use super::kepler::Orbit;
use crate::numerics::jet::Jet;
use crate::numerics::number::Real;
use crate::numerics::quaternion::product;

/// The columns of a small rotation at the start, and of ω at the start.
pub(in crate::motion) const ATTITUDE: usize = 0;
pub(in crate::motion) const RATES: usize = 3;
/// Of the principal moments, ascending, and of the elements 23, 31, 12 of the tensor in principal axes.
pub(in crate::motion) const MOMENTS: usize = 6;
pub(in crate::motion) const PRODUCTS: usize = 9;
/// Of the centre of mass and of the mass.
pub(in crate::motion) const CENTER: usize = 12;
pub(in crate::motion) const MASS: usize = 15;
/// Of the numbers of the load, term by term.
pub(in crate::motion) const LOAD: usize = 16;

/// How many variables are varied at a time.
pub(in crate::motion) const WIDTH: usize = 8;

/// A number with its derivatives by the variables of a [`Block`].
pub(in crate::motion) type VariationJet = Jet<WIDTH>;

/// Which variables are varied.
pub(crate) trait Variables<X: Real>: Copy + Debug + Send + Sync {
    /// The variable of a column, at its value.
    fn number(self, value: f64, column: usize) -> X;

    /// The attitude `q∘exp(δ)` (x, y, z, w), the components of the small rotation δ being the variables from `column` on.
    fn vary_attitude(self, q: [X; 4], column: usize) -> [X; 4];

    /// Whether one of these columns is varied.
    fn varies(self, columns: Range<usize>) -> bool;

    /// The columns of terms that have these numbers, one after the other; none where nothing is varied.
    fn columns(self, terms: &mut dyn Iterator<Item = Vec<Parameter>>) -> Vec<ParameterColumns>;

    /// Position and velocity on an orbit. μ, and position and velocity at its epoch, are the variables from these columns on.
    fn on_orbit(self, orbit: &Orbit, elapsed: f64, columns: [usize; 3])
    -> (Vector3<X>, Vector3<X>);

    /// A vector whose components are variables.
    fn vector(self, value: &Vector3<f64>, first: usize) -> Vector3<X> {
        Vector3::from_fn(|i, _| self.number(value[i], first + i))
    }

    /// A matrix whose elements are variables, row by row.
    fn matrix(self, value: &Matrix3<f64>, first: usize) -> Matrix3<X> {
        Matrix3::from_fn(|i, j| self.number(value[(i, j)], first + 3 * i + j))
    }
}

/// None of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fixed;

impl<X: Real> Variables<X> for Fixed {
    #[inline(always)]
    fn number(self, value: f64, _: usize) -> X {
        X::from(value)
    }

    fn vary_attitude(self, q: [X; 4], _: usize) -> [X; 4] {
        q
    }

    fn varies(self, _: Range<usize>) -> bool {
        false
    }

    fn columns(self, _: &mut dyn Iterator<Item = Vec<Parameter>>) -> Vec<ParameterColumns> {
        Vec::new()
    }

    fn on_orbit(self, orbit: &Orbit, elapsed: f64, _: [usize; 3]) -> (Vector3<X>, Vector3<X>) {
        let (r, v) = orbit.at(elapsed);
        (r.map(X::from), v.map(X::from))
    }
}

/// Those whose columns begin with `first`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Block {
    /// The first column.
    pub first: usize,
}

impl Variables<VariationJet> for Block {
    fn number(self, value: f64, column: usize) -> VariationJet {
        match column.checked_sub(self.first) {
            Some(index) if index < WIDTH => VariationJet::variable(value, index),
            _ => VariationJet::constant(value),
        }
    }

    fn vary_attitude(self, q: [VariationJet; 4], column: usize) -> [VariationJet; 4] {
        let half = VariationJet::constant(0.5);
        let [x, y, z] = [0, 1, 2].map(|i| self.number(0.0, column + i) * half);
        product(q, [x, y, z, VariationJet::constant(1.0)])
    }

    fn varies(self, columns: Range<usize>) -> bool {
        columns.start < self.first + WIDTH && self.first < columns.end
    }

    fn columns(self, terms: &mut dyn Iterator<Item = Vec<Parameter>>) -> Vec<ParameterColumns> {
        let columns = terms.scan(LOAD, |next, parameters| {
            let first = *next;
            *next += parameters.iter().map(Parameter::count).sum::<usize>();
            Some(ParameterColumns::new(first, parameters))
        });
        columns.collect()
    }

    fn on_orbit(
        self,
        orbit: &Orbit,
        elapsed: f64,
        [mu, position, velocity]: [usize; 3],
    ) -> (Vector3<VariationJet>, Vector3<VariationJet>) {
        let number = |value, n| {
            let column = match n {
                0 => mu,
                1..4 => position + n - 1,
                _ => velocity + n - 4,
            };
            self.number(value, column)
        };
        orbit.at_with_derivatives(elapsed, number)
    }
}

/// Numbers of a term of a load, under the name and with the shape that they have where the term is made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parameter {
    /// The name.
    pub name: &'static str,
    /// How many in each direction; in C order.
    pub shape: Vec<usize>,
}

impl Parameter {
    /// Of this name and shape.
    pub(super) fn new(name: &'static str, shape: &[usize]) -> Self {
        Self {
            name,
            shape: shape.to_vec(),
        }
    }

    /// How many numbers they are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.shape.iter().product()
    }
}

/// The columns of the numbers of a term among the variables of a motion, by their names. Without names where nothing is varied.
#[derive(Clone, Debug, Default)]
pub(crate) struct ParameterColumns {
    first: usize,
    parameters: Vec<Parameter>,
}

impl ParameterColumns {
    /// Where nothing is varied.
    pub(crate) const NONE: &'static Self = &Self {
        first: 0,
        parameters: Vec::new(),
    };

    /// Of a term whose first number has the column `first`.
    pub(crate) fn new(first: usize, parameters: Vec<Parameter>) -> Self {
        Self { first, parameters }
    }

    /// The first of them.
    pub(crate) fn first(&self) -> usize {
        self.first
    }

    /// How many there are.
    pub(super) fn count(&self) -> usize {
        self.parameters.iter().map(Parameter::count).sum()
    }

    /// Those of the numbers of this name.
    pub(super) fn of(&self, name: &str) -> Range<usize> {
        let mut start = self.first;
        for parameter in &self.parameters {
            let end = start + parameter.count();
            if parameter.name == name {
                return start..end;
            }
            start = end;
        }
        debug_assert!(self.parameters.is_empty(), "no number {name}");
        start..start
    }
}
