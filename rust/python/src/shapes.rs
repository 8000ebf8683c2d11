//! What all homogeneous shapes share: mass or density, lengths that broadcast.

use polhode::Error;
use polhode::mass::{Amount, RigidBody};
use polhode::uncertainty::{Inputs, LinearUncertainty, OfPolygon, OfShape, Shape, propagate};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::arrays::Item;
use crate::body::PyRigidBody;
use crate::figure::figures_of_lengths;
use crate::stack::{Broadcast, Stack};
use crate::uncertain::{Number, Quantity, factor, propagate_rows, quantity};

/// An optional argument of any array-like kind.
pub(crate) type Optional<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// Exactly one of mass and density.
pub(crate) fn amount(mass: Option<f64>, density: Option<f64>) -> PyResult<Amount> {
    match (mass, density) {
        (Some(mass), None) => Ok(Amount::Mass(mass)),
        (None, Some(density)) => Ok(Amount::Density(density)),
        _ => Err(PyTypeError::new_err(
            "give exactly one of mass= and density=",
        )),
    }
}

/// A shape under the name of what makes it.
pub(crate) type Named<'a, const N: usize> = (&'static str, &'a dyn AnyShape<N>);

/// The shape that an expression of the core makes of its lengths, for plain numbers and for numbers with derivatives.
macro_rules! shape {
    ($name:expr, |$lengths:pat_param| $n:expr, $function:path, $($argument:expr),+) => {{
        struct Shape;
        impl polhode::uncertainty::Shape<{ $n }> for Shape {
            fn of<X: polhode::mass::inertial_parameters::Size>(
                &self,
                $lengths: &[X; $n],
                amount: polhode::mass::Amount,
            ) -> Result<X::Body, polhode::Error> {
                $function($($argument,)+ amount)
            }
        }
        ($name, &Shape as &dyn $crate::shapes::AnyShape<{ $n }>)
    }};
}
pub(crate) use shape;

/// Declares the function of Python that makes a body of some lengths, or of one list of them, by a function of the core:
/// `cone(radius, height) = solids::cone`, `wedge([size; 3]) = solids::wedge`. Mass or density, stacks, sigmas and what pictures
/// need come by themselves.
macro_rules! shape_function {
    ($(#[$attribute:meta])* $name:ident($($length:ident),+) = $function:path) => {
        #[pyfunction]
        $(#[$attribute])*
        #[pyo3(signature = ($($length,)+ *, mass=None, density=None))]
        pub(crate) fn $name(
            $($length: &pyo3::Bound<'_, pyo3::PyAny>,)+
            mass: $crate::shapes::Optional<'_, '_>,
            density: $crate::shapes::Optional<'_, '_>,
        ) -> pyo3::PyResult<$crate::body::PyRigidBody> {
            const NAMES: &[&str] = &[$(stringify!($length)),+];
            $crate::shapes::lengths(
                [$(stringify!($length)),+],
                [$($length),+],
                (mass, density),
                $crate::shapes::shape!(
                    stringify!($function),
                    |&[$($length),+]| NAMES.len(),
                    $function,
                    $($length),+
                ),
            )
        }
    };
    ($(#[$attribute:meta])* $name:ident([$size:ident; $n:literal]) = $function:path) => {
        #[pyfunction]
        $(#[$attribute])*
        #[pyo3(signature = ($size, *, mass=None, density=None))]
        pub(crate) fn $name(
            $size: &pyo3::Bound<'_, pyo3::PyAny>,
            mass: $crate::shapes::Optional<'_, '_>,
            density: $crate::shapes::Optional<'_, '_>,
        ) -> pyo3::PyResult<$crate::body::PyRigidBody> {
            $crate::shapes::one(
                $size,
                stringify!($size),
                (mass, density),
                $crate::shapes::shape!(stringify!($function), |lengths| $n, $function, lengths),
            )
        }
    };
}
pub(crate) use shape_function;

/// A [`Shape`], whichever it is: what is done with its lengths is compiled once for each number of them.
pub(crate) trait AnyShape<const N: usize>: Sync {
    fn body(&self, lengths: &[f64; N], amount: Amount) -> Result<RigidBody, Error>;

    fn uncertainty(&self, amount: Amount, from: Inputs<'_>) -> Result<LinearUncertainty, Error>;
}

impl<const N: usize, S: Shape<N> + Sync> AnyShape<N> for S {
    fn body(&self, lengths: &[f64; N], amount: Amount) -> Result<RigidBody, Error> {
        self.of(lengths, amount)
    }

    fn uncertainty(&self, amount: Amount, from: Inputs<'_>) -> Result<LinearUncertainty, Error> {
        propagate(&OfShape(self, amount), from)
    }
}

/// A shape with one list of N lengths.
pub(crate) fn one<const N: usize>(
    size: &Bound<'_, PyAny>,
    name: &str,
    amounts: (Optional<'_, '_>, Optional<'_, '_>),
    (kind, shape): Named<'_, N>,
) -> PyResult<PyRigidBody>
where
    [f64; N]: Item + Sync,
{
    let sizes: Quantity<[f64; N]> = quantity(size, name)?;
    let amounts = Amounts::read(amounts)?;
    let grid = Broadcast::of(
        [name, "mass or density"],
        [&sizes.values.shape, &amounts.values.shape],
    )?;
    let bodies = grid.try_map(size.py(), |[s, a]| {
        shape.body(&sizes.values[s], amounts.values[a])
    })?;
    let is_uncertain = sizes.is_uncertain() || amounts.given.is_uncertain();
    let uncertainties = propagate_rows(size.py(), &grid, is_uncertain, |[s, a]| {
        amounts.uncertainty(a, sizes.row(s), shape)
    })?;
    let figures = figures_of_lengths(kind, grid.len(), |row| {
        sizes.values[grid.operands(row)[0]].to_vec()
    });
    Ok(PyRigidBody::with_uncertainty(bodies, uncertainties).with_shapes(figures))
}

/// A shape with several lengths.
pub(crate) fn lengths<const N: usize>(
    names: [&str; N],
    lengths: [&Bound<'_, PyAny>; N],
    amounts: (Optional<'_, '_>, Optional<'_, '_>),
    (kind, shape): Named<'_, N>,
) -> PyResult<PyRigidBody> {
    let py = lengths[0].py();
    let mut read_in: Vec<Quantity<f64>> = Vec::with_capacity(N);
    for (length, name) in lengths.iter().zip(names) {
        read_in.push(quantity(length, name)?);
    }
    let shapes = std::array::from_fn(|k| &read_in[k].values.shape[..]);
    let together: Stack<[usize; N]> = Broadcast::of(names, shapes)?.try_map(py, Ok)?;
    let of_row =
        |rows: &[usize; N]| -> [f64; N] { std::array::from_fn(|k| read_in[k].values[rows[k]]) };
    let amounts = Amounts::read(amounts)?;
    let all = names.join(", ");
    let grid = Broadcast::of(
        [&all, "mass or density"],
        [&together.shape, &amounts.values.shape],
    )?;
    let bodies = grid.try_map(py, |[l, a]| {
        shape.body(&of_row(&together[l]), amounts.values[a])
    })?;
    let is_uncertain = amounts.given.is_uncertain() || read_in.iter().any(Quantity::is_uncertain);
    let uncertainties = propagate_rows(py, &grid, is_uncertain, |[l, a]| {
        let numbers = (0..N)
            .flat_map(|k| read_in[k].row(together[l][k]))
            .collect();
        amounts.uncertainty(a, numbers, shape)
    })?;
    let figures = figures_of_lengths(kind, grid.len(), |row| {
        of_row(&together[grid.operands(row)[0]]).to_vec()
    });
    Ok(PyRigidBody::with_uncertainty(bodies, uncertainties).with_shapes(figures))
}

/// Masses or densities, which may be uncertain.
pub(crate) struct Amounts {
    pub(crate) values: Stack<Amount>,
    pub(crate) given: Quantity<f64>,
}

impl Amounts {
    /// Exactly one of masses and densities.
    pub(crate) fn read((mass, density): (Optional<'_, '_>, Optional<'_, '_>)) -> PyResult<Self> {
        let (of, given, name): (fn(f64) -> Amount, _, _) = match (mass, density) {
            (Some(mass), None) => (Amount::Mass, mass, "mass"),
            (None, Some(density)) => (Amount::Density, density, "density"),
            _ => {
                return Err(PyTypeError::new_err(
                    "give exactly one of mass= and density=",
                ));
            }
        };
        let numbers: Quantity<f64> = quantity(given, name)?;
        Ok(Self {
            values: numbers.values.map(given.py(), |&number| of(number))?,
            given: numbers,
        })
    }

    /// The uncertainties of a polygon with these coordinates of its corners and the amount of a row.
    pub(crate) fn doubt_of_polygon(
        &self,
        row: usize,
        corners: Vec<Number<'_>>,
    ) -> Result<LinearUncertainty, Error> {
        let relative = factor(&self.given.row(row));
        let mut numbers = corners;
        numbers.push((1.0, &relative));
        let from = Inputs {
            bodies: &[],
            numbers: &numbers,
        };
        propagate(&OfPolygon(self.values[row]), from)
    }

    /// The uncertainties of the body that a shape makes of these lengths and the amount of a row.
    pub(crate) fn uncertainty<const N: usize>(
        &self,
        row: usize,
        lengths: Vec<Number<'_>>,
        shape: &dyn AnyShape<N>,
    ) -> Result<LinearUncertainty, Error> {
        let relative = factor(&self.given.row(row));
        let mut numbers = lengths;
        numbers.push((1.0, &relative));
        let from = Inputs {
            bodies: &[],
            numbers: &numbers,
        };
        shape.uncertainty(self.values[row], from)
    }
}
