//! Solids with flat faces.

use polhode::Error;
use polhode::mass::ten::Size;
use polhode::mass::{Amount, solids};
use polhode::uncertainty::Shape;
use pyo3::prelude::*;

use crate::arrays::read;
use crate::body::PyRigidBody;
use crate::figure::figures_of_lengths;
use crate::shapes::{Amounts, Given, shape_function};
use crate::stack::{Broadcast, Stack};
use crate::uncertain::{Quantity, carried, quantity};

shape_function! {
    /// Box with its faces normal to the axes: I_x = m (y² + z²)/12.
    ///
    /// Parameters
    /// ----------
    /// size : array_like, shape (..., 3)
    ///     Full edge lengths along x, y, z.
    /// mass, density : array_like, shape (...)
    ///     Exactly one of the two.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Examples
    /// --------
    /// >>> from polhode import solids
    /// >>> solids.box((1, 2, 3), mass=12.0).principal_moments
    /// array([ 5., 10., 13.])
    #[pyo3(name = "box")]
    cuboid([size; 3]) = solids::cuboid
}

shape_function! {
    /// Cube with its faces normal to the axes: I = m a²/6.
    ///
    /// Parameters
    /// ----------
    /// side : array_like, shape (...)
    ///     Full edge length.
    /// mass, density : array_like, shape (...)
    ///     Exactly one of the two.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Examples
    /// --------
    /// >>> from polhode import solids
    /// >>> solids.cube(2.0, density=1.0).mass
    /// 8.0
    cube(side) = solids::cube
}

shape_function! {
    /// Wedge: half of a box, cut along a diagonal of its x-z faces, the right angle at −x, −z.
    ///
    /// With the box's edges x, y, z the corners are (−x/3, ±y/2, −z/3), (2x/3, ±y/2, −z/3) and (−x/3, ±y/2, 2z/3).
    /// The second moments are m x²/18, m y²/12, m z²/18, and ∫ x z dm = −m x z/36.
    ///
    /// Parameters
    /// ----------
    /// size : array_like, shape (..., 3)
    ///     Edge lengths of the box along x, y, z.
    /// mass, density : array_like, shape (...)
    ///     Exactly one of the two.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Examples
    /// --------
    /// >>> from polhode import solids
    /// >>> solids.wedge((6, 2, 6), mass=36.0).inertia
    /// array([[ 84.,   0.,  36.],
    ///        [  0., 144.,   0.],
    ///        [ 36.,   0.,  84.]])
    wedge([size; 3]) = solids::wedge
}

/// Upright prism over a regular polygon: I_z = m R² (2 + cos 2π/n)/6. One corner is toward +x.
///
/// Parameters
/// ----------
/// sides : array_like of int, shape (...)
///     n, three or more.
/// radius : array_like, shape (...)
///     R, from the axis to the corners; an edge has the length 2 R sin(π/n).
/// height : array_like, shape (...)
///     Full height.
/// mass, density : array_like, shape (...)
///     Exactly one of the two.
///
/// Returns
/// -------
/// RigidBody
///
/// Examples
/// --------
/// A square one is a box:
///
/// >>> from polhode import solids
/// >>> box = solids.box((1, 1, 3), density=2.0)
/// >>> bool(solids.prism(sides=4, radius=0.5**0.5, height=3, density=2.0).isclose(box))
/// True
#[pyfunction]
#[pyo3(signature = (sides, radius, height, *, mass=None, density=None))]
pub(crate) fn prism(
    sides: &Bound<'_, PyAny>,
    radius: &Bound<'_, PyAny>,
    height: &Bound<'_, PyAny>,
    mass: Given<'_, '_>,
    density: Given<'_, '_>,
) -> PyResult<PyRigidBody> {
    let py = sides.py();
    let sides: Stack<f64> = read(sides, "sides")?;
    let (radius, height): (Quantity<f64>, Quantity<f64>) =
        (quantity(radius, "radius")?, quantity(height, "height")?);
    let amounts = Amounts::read((mass, density))?;
    let grid = Broadcast::of(
        ["sides", "radius", "height", "mass or density"],
        [
            &sides.shape,
            &radius.values.shape,
            &height.values.shape,
            &amounts.values.shape,
        ],
    )?;
    let bodies = grid.try_map(py, |[n, r, h, a]| {
        Prism(whole(sides[n])?).of(&[radius.values[r], height.values[h]], amounts.values[a])
    })?;
    let is_uncertain =
        radius.is_uncertain() || height.is_uncertain() || amounts.given.is_uncertain();
    let doubts = carried(py, &grid, is_uncertain, |[n, r, h, a]| {
        amounts.doubt(
            a,
            [radius.row(r), height.row(h)].concat(),
            &Prism(whole(sides[n])?),
        )
    })?;
    let figures = figures_of_lengths("solids::prism", grid.len(), |row| {
        let [n, r, h, _] = grid.operands(row);
        vec![sides[n], radius.values[r], height.values[h]]
    });
    Ok(PyRigidBody::doubtful(bodies, doubts).looking(figures))
}

/// A prism with so many sides, by its radius and height.
struct Prism(u32);

impl Shape<2> for Prism {
    fn of<X: Size>(&self, &[radius, height]: &[X; 2], amount: Amount) -> Result<X::Body, Error> {
        solids::prism(self.0, radius, height, amount)
    }
}

/// A number of sides as an integer.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "checked to be a whole number of that size"
)]
fn whole(value: f64) -> Result<u32, Error> {
    if value >= 0.0 && value <= f64::from(u32::MAX) && value.fract() == 0.0 {
        return Ok(value as u32);
    }
    let (what, law) = ("sides", "a whole number of 3 or more");
    Err(Error::OutOfDomain { what, law, value })
}

shape_function! {
    /// Pyramid over a rectangle, its apex toward +z, at 3z/4 from the centre of mass: I_z = m (x² + y²)/20.
    ///
    /// Parameters
    /// ----------
    /// size : array_like, shape (..., 3)
    ///     x and y of the base, and the height z.
    /// mass, density : array_like, shape (...)
    ///     Exactly one of the two.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Examples
    /// --------
    /// >>> from polhode import solids
    /// >>> solids.pyramid((2, 4, 4), mass=20.0).inertia.diagonal().round(12)
    /// array([28., 16., 20.])
    pyramid([size; 3]) = solids::pyramid
}

shape_function! {
    /// Regular tetrahedron, its apex toward +z: I = m a²/20 about every axis through the centre of mass.
    ///
    /// The corners are (0, 0, a√6/4), (a/√3, 0, −a/√24) and (−a/√12, ±a/2, −a/√24). For any other tetrahedron
    /// see :meth:`polhode.RigidBody.from_tetrahedra`.
    ///
    /// Parameters
    /// ----------
    /// side : array_like, shape (...)
    ///     Length of an edge.
    /// mass, density : array_like, shape (...)
    ///     Exactly one of the two.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Examples
    /// --------
    /// >>> from polhode import solids
    /// >>> solids.tetrahedron(2.0, mass=5.0).principal_moments
    /// array([1., 1., 1.])
    tetrahedron(side) = solids::tetrahedron
}
