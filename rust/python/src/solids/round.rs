//! Balls and ellipsoids, whole, hollow and halved.

use polhode::mass::solids;
use pyo3::prelude::*;

use crate::shapes::shape_function;

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
