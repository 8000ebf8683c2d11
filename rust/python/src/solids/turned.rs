//! Solids of revolution about z with straight sides or rounded ends, and the torus.

use polhode::mass::solids;
use pyo3::prelude::*;

use crate::shapes::shape_function;

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
