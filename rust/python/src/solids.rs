//! Homogeneous solids.

use polhode::Error;
use polhode::mass::inertial_parameters::Size;
use polhode::mass::{Amount, solids};
use polhode::uncertainty::Shape;
use pyo3::prelude::*;

use crate::arrays::read;
use crate::body::PyRigidBody;
use crate::figure::figures_of_lengths;
use crate::shapes::{Amounts, Optional, shape_function};
use crate::stack::{Broadcast, Stack};
use crate::uncertain::{Quantity, propagate_rows, quantity};

// Solids with flat faces.

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
    mass: Optional<'_, '_>,
    density: Optional<'_, '_>,
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
    let uncertainties = propagate_rows(py, &grid, is_uncertain, |[n, r, h, a]| {
        amounts.uncertainty(
            a,
            [radius.row(r), height.row(h)].concat(),
            &Prism(whole(sides[n])?),
        )
    })?;
    let figures = figures_of_lengths("solids::prism", grid.len(), |row| {
        let [n, r, h, _] = grid.operands(row);
        vec![sides[n], radius.values[r], height.values[h]]
    });
    Ok(PyRigidBody::with_uncertainty(bodies, uncertainties).with_shapes(figures))
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

// Balls and ellipsoids, whole, hollow and halved.

shape_function! {
    /// Ball: I = ⅖ m R².
    ///
    /// Parameters
    /// ----------
    /// radius : array_like, shape (...)
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
    /// >>> solids.sphere(1.0, mass=5.0).principal_moments
    /// array([2., 2., 2.])
    sphere(radius) = solids::sphere
}

shape_function! {
    /// Ellipsoid with its axes along x, y, z: I_x = m (b² + c²)/5.
    ///
    /// Parameters
    /// ----------
    /// semi_axes : array_like, shape (..., 3)
    ///     a, b, c: half the lengths along x, y, z.
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
    /// >>> solids.ellipsoid((1, 2, 3), mass=5.0).principal_moments
    /// array([ 5., 10., 13.])
    ellipsoid([semi_axes; 3]) = solids::ellipsoid
}

shape_function! {
    /// Ball with a concentric cavity: I = ⅖ m (R⁵ − r⁵)/(R³ − r³). With equal radii a thin shell, I = ⅔ m R².
    ///
    /// Parameters
    /// ----------
    /// inner_radius, outer_radius : array_like, shape (...)
    ///     r and R, r ≤ R.
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
    /// >>> solids.hollow_sphere(inner_radius=3.0, outer_radius=3.0, mass=1.0).principal_moments
    /// array([6., 6., 6.])
    hollow_sphere(inner_radius, outer_radius) = solids::hollow_sphere
}

shape_function! {
    /// Half of a ball, its dome toward +z, its flat face at −3R/8 from the centre of mass: I_z = ⅖ m R².
    ///
    /// Parameters
    /// ----------
    /// radius : array_like, shape (...)
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
    /// >>> solids.hemisphere(4.0, mass=20.0).inertia.diagonal()
    /// array([ 83.,  83., 128.])
    hemisphere(radius) = solids::hemisphere
}

// Solids of revolution about z with straight sides or rounded ends, and the torus.

shape_function! {
    /// Cylinder along z: I_z = ½ m R², I_x = m (3R² + h²)/12. A flat one is a disk, a thin one a rod.
    ///
    /// Parameters
    /// ----------
    /// radius, height : array_like, shape (...)
    ///     R and the full height h.
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
    /// >>> solids.cylinder(radius=2.0, height=6.0, mass=1.0).principal_moments
    /// array([2., 4., 4.])
    cylinder(radius, height) = solids::cylinder
}

shape_function! {
    /// Cone along z with its apex toward +z, at 3h/4 from the centre of mass: I_z = (3/10) m R², I_x = (3/20) m (R² + h²/4).
    ///
    /// Parameters
    /// ----------
    /// radius, height : array_like, shape (...)
    ///     R of the base and the full height h.
    /// mass, density : array_like, shape (...)
    ///     Exactly one of the two.
    ///
    /// Returns
    /// -------
    /// RigidBody
    ///
    /// Examples
    /// --------
    /// About its apex:
    ///
    /// >>> from polhode import solids
    /// >>> solids.cone(radius=2.0, height=4.0, mass=10.0).inertia_about((0, 0, 3)).diagonal().round(12)
    /// array([102., 102.,  12.])
    cone(radius, height) = solids::cone
}

shape_function! {
    /// Tube along z between two radii: I_z = ½ m (R² + r²). With equal radii a thin shell.
    ///
    /// Parameters
    /// ----------
    /// inner_radius, outer_radius : array_like, shape (...)
    ///     r and R, r ≤ R.
    /// height : array_like, shape (...)
    ///     Full height h.
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
    /// >>> solids.tube(inner_radius=1.0, outer_radius=2.0, height=6.0, mass=4.0).inertia.diagonal()
    /// array([17., 17., 10.])
    tube(inner_radius, outer_radius, height) = solids::tube
}

shape_function! {
    /// Cone cut off parallel to its base: I_z = (3/10) m (R⁵ − r⁵)/(R³ − r³).
    ///
    /// Its lower end, of radius R, is at −h (R² + 2Rr + 3r²)/(4 (R² + Rr + r²)) from the centre of mass. With equal
    /// radii a cylinder, with r = 0 a cone.
    ///
    /// Parameters
    /// ----------
    /// bottom_radius, top_radius : array_like, shape (...)
    ///     R of the end toward −z and r of the end toward +z, not both zero.
    /// height : array_like, shape (...)
    ///     Full height h.
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
    /// >>> solids.frustum(bottom_radius=2.0, top_radius=1.0, height=3.0, mass=70.0).moment_about((0, 0, 1))
    /// 93.0
    frustum(bottom_radius, top_radius, height) = solids::frustum
}

shape_function! {
    /// Cylinder along z with a half ball on each end. Without length a ball, without radius a rod.
    ///
    /// Parameters
    /// ----------
    /// radius : array_like, shape (...)
    /// length : array_like, shape (...)
    ///     Length of the cylinder, between the centres of the half balls; the whole is 2 × radius longer.
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
    /// >>> bool(solids.capsule(radius=2.0, length=0.0, mass=5.0) == solids.sphere(2.0, mass=5.0))
    /// True
    capsule(radius, length) = solids::capsule
}

shape_function! {
    /// Torus about z: I_z = m (R² + ¾ r²). Without minor radius a ring.
    ///
    /// Parameters
    /// ----------
    /// major_radius : array_like, shape (...)
    ///     R, from the axis to the middle of the tube.
    /// minor_radius : array_like, shape (...)
    ///     r of the tube, r ≤ R.
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
    /// >>> solids.torus(major_radius=4.0, minor_radius=2.0, mass=2.0).principal_moments
    /// array([21., 21., 38.])
    torus(major_radius, minor_radius) = solids::torus
}
