//! Symmetric tops: free precession, and what a heavy one may do steadily.

use nalgebra::Vector3;
use numpy::PyArrayDyn;
use polhode::Error;
use polhode::motion::free_precession::{FreePrecession, free_precession as free_precession_of};
use polhode::motion::heavy_top::PivotedTop;
use polhode::motion::nutation_damping::nutation_damping as nutation_damping_of;
use polhode::principal::{SymmetricTop, TOP_RTOL};
use pyo3::prelude::*;

use crate::about::points;
use crate::arrays::{
    Argument, read, read_or, read_scalar, write, write_numbers, write_numbers_of, write_of,
};
use crate::body::PyRigidBody;
use crate::stack::{Broadcast, Stack};

/// Torque-free precession of a symmetric top: body cone, space cone and the two rates.
///
/// The symmetry axis n, the angular velocity ω and the angular momentum L lie in one plane, which turns
/// about L. In the body ω circles about n on the body cone with the rate ``(I_s − I_t) ω_s/I_t``; in space n
/// and ω circle about L with the rate ``L/I_t``, ω on the space cone. The body cone rolls on the space cone.
///
/// Parameters
/// ----------
/// body : RigidBody
///     A body with two principal moments that are equal within `rtol`; their mean is used.
/// omega : array_like, shape (..., 3)
///     Angular velocity relative to space, components in the body frame.
/// about : {"center_of_mass", "origin"} or array_like, shape (..., 3), optional
///     The centre of mass of a body that moves freely, or a point fixed in space, without torque.
/// rtol : float, optional
///     Moments that differ by less than `rtol` times the largest count as equal.
///
/// Returns
/// -------
/// FreePrecession
///
/// Raises
/// ------
/// PolhodeError
///     For a body that is no symmetric top, with the gap between its moments.
///
/// Examples
/// --------
/// A plate that wobbles a little: the wobble goes round twice while the plate spins once:
///
/// >>> from polhode import solids, tops
/// >>> plate = solids.cylinder(radius=0.1, height=0.0, mass=0.2)
/// >>> wobble = tops.free_precession(plate, omega=(0.01, 0, 3))
/// >>> round(wobble.space_rate, 3), round(wobble.body_rate, 3)
/// (6.0, 3.0)
#[pyfunction]
#[pyo3(
    signature = (body, omega, about=Argument::default(), *, rtol=TOP_RTOL),
    text_signature = "(body, omega, about='center_of_mass', *, rtol=1e-06)"
)]
pub(crate) fn free_precession<'py>(
    py: Python<'py>,
    body: &Bound<'py, PyRigidBody>,
    omega: &Bound<'py, PyAny>,
    about: Argument<'py>,
    #[pyo3(from_py_with = read_scalar)] rtol: f64,
) -> PyResult<Bound<'py, PyAny>> {
    let bodies = &body.get().bodies;
    let omega: Stack<Vector3<f64>> = read(omega, "omega")?;
    let about = points(py, bodies, about.value(), "about")?;
    let shapes = [&bodies.shape[..], &omega.shape, &about.shape];
    let grid = Broadcast::of(["body", "omega", "about"], shapes)?;
    let found = grid.try_map(py, |[b, w, p]| {
        bodies[b].check_about(&about[p])?;
        let top = SymmetricTop::of(&bodies[b].principal_about(&about[p]), rtol)?;
        free_precession_of(&top, &omega[w])
    })?;
    let number = |part: fn(&FreePrecession) -> f64| write_numbers_of(py, &found, part);
    let parts = (
        write_of(py, &found, |motion| motion.axis)?,
        number(|motion| motion.body_rate)?,
        number(|motion| motion.space_rate)?,
        number(|motion| motion.body_cone)?,
        number(|motion| motion.space_cone)?,
        number(|motion| motion.nutation)?,
    );
    py.import("polhode.results")?
        .getattr("FreePrecession")?
        .call1(parts)
}

/// Damping of the nutation of a free symmetric top by a small slug: the energy-sink model and the major-axis
/// rule.
///
/// The angle θ between the symmetry axis and L follows ``tan θ = tan θ0 exp(rate t)``, to first order in the moment of the slug.
///
/// Parameters
/// ----------
/// body : RigidBody
///     A body with two principal moments that are equal within `rtol`; their mean is used.
/// momentum : array_like, shape (...)
///     The length of L.
/// inertia, damping : array_like, shape (...)
///     Moment J of the slug and coefficient k, as for :func:`polhode.loads.slug`.
/// rtol : float, optional
///     Moments that differ by less than `rtol` times the largest count as equal.
///
/// Returns
/// -------
/// NutationDamping
///
/// Raises
/// ------
/// PolhodeError
///     For a body that is no symmetric top, and for numbers that are not positive.
///
/// Examples
/// --------
/// A rod that spins about its axis goes over into a flat spin; the nutation of a disk is damped:
///
/// >>> from polhode import RigidBody, tops
/// >>> for moments in [(0.5, 1.0, 1.0), (1.0, 1.0, 1.8)]:
/// ...     fate = tops.nutation_damping(RigidBody.from_principal(1.0, moments), 2.0, inertia=1e-3, damping=2e-3)
/// ...     print(fate.verdict, round(fate.time_constant, 1))
/// flat spin 1000.0
/// damps 2250.0
#[pyfunction]
#[pyo3(
    signature = (body, momentum, *, inertia, damping, rtol=TOP_RTOL),
    text_signature = "(body, momentum, *, inertia, damping, rtol=1e-06)"
)]
pub(crate) fn nutation_damping<'py>(
    py: Python<'py>,
    body: &Bound<'py, PyRigidBody>,
    momentum: &Bound<'py, PyAny>,
    inertia: &Bound<'py, PyAny>,
    damping: &Bound<'py, PyAny>,
    #[pyo3(from_py_with = read_scalar)] rtol: f64,
) -> PyResult<Bound<'py, PyAny>> {
    let bodies = &body.get().bodies;
    let momentum: Stack<f64> = read(momentum, "momentum")?;
    let (inertia, damping): (Stack<f64>, Stack<f64>) =
        (read(inertia, "inertia")?, read(damping, "damping")?);
    let shapes = [
        &bodies.shape[..],
        &momentum.shape,
        &inertia.shape,
        &damping.shape,
    ];
    let grid = Broadcast::of(["body", "momentum", "inertia", "damping"], shapes)?;
    let found = grid.try_map(py, |[b, h, j, k]| {
        let top = SymmetricTop::of(&bodies[b].principal(), rtol)?;
        nutation_damping_of(&top, momentum[h], inertia[j], damping[k])
    })?;
    let rate = write_numbers_of(py, &found, |fate| fate.rate)?;
    py.import("polhode.results")?
        .getattr("NutationDamping")?
        .call1((rate,))
}

/// Least spin with which a heavy symmetric top precesses steadily: ``2 √(I_t m g l cos θ)/I_s``.
///
/// For the upright top (inclination zero, the default) it is the limit of the sleeping top: the top is stable
/// if ``I_s² ω_s² ≥ 4 I_t m g l``. For an axis below the horizontal any spin is possible, and the result is
/// zero.
///
/// Parameters
/// ----------
/// body : RigidBody
///     A symmetric top whose axis passes through the origin of the body frame, the pivot.
/// gravity : array_like, shape (..., 3)
///     Gravitational acceleration; only its magnitude matters.
/// inclination : array_like, shape (...), optional
///     Angle θ between the upward vertical and the axis, which points from the pivot to the centre of mass,
///     in radians unless `degrees`.
/// rtol : float, optional
///     Moments that differ by less than `rtol` times the largest count as equal. The pivot counts as lying on
///     the axis if its distance from the axis is less than `rtol` times the radius of gyration.
/// degrees : bool, optional
///     The inclination is in degrees.
///
/// Returns
/// -------
/// float or numpy.ndarray, shape (...)
///     ω_s, the component of ω along the axis, in radians per unit of time; infinite for a body without
///     moment about the axis.
///
/// Raises
/// ------
/// PolhodeError
///     For a body that is no symmetric top, or a pivot that is not on its axis.
///
/// Examples
/// --------
/// A cone of radius 2 cm and height 5 cm on its apex:
///
/// >>> from polhode import solids, tops
/// >>> cone = solids.cone(radius=0.02, height=0.05, mass=0.1).rotated((1, 0, 0, 0)).translated((0, 0, 0.0375))
/// >>> round(tops.least_spin(cone, gravity=(0, 0, -9.81)), 3)
/// 399.265
#[pyfunction]
#[pyo3(
    signature = (body, gravity, inclination=Argument::default(), *, rtol=TOP_RTOL, degrees=false),
    text_signature = "(body, gravity, inclination=0.0, *, rtol=1e-06, degrees=False)"
)]
pub(crate) fn least_spin<'py>(
    py: Python<'py>,
    body: &Bound<'py, PyRigidBody>,
    gravity: &Bound<'py, PyAny>,
    inclination: Argument<'py>,
    #[pyo3(from_py_with = read_scalar)] rtol: f64,
    degrees: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let bodies = &body.get().bodies;
    let gravity: Stack<Vector3<f64>> = read(gravity, "gravity")?;
    let inclination = in_radians(read_or(&inclination, "inclination", 0.0)?, degrees);
    let shapes = [&bodies.shape[..], &gravity.shape, &inclination.shape];
    let grid = Broadcast::of(["body", "gravity", "inclination"], shapes)?;
    let spins = grid.try_map(py, |[b, g, i]| {
        let top = PivotedTop::of(&bodies[b], rtol)?;
        Ok::<_, Error>(top.least_spin(inclination[i], &gravity[g]))
    })?;
    write_numbers(py, &spins)
}

/// Rates φ̇ of the two steady precessions of a heavy symmetric top, the roots of ``I_t φ̇² cos θ − I_s ω_s φ̇
/// + m g l = 0``.
///
/// Parameters
/// ----------
/// body : RigidBody
///     A symmetric top whose axis passes through the origin of the body frame, the pivot.
/// spin : array_like, shape (...)
///     ω_s, the component of ω along the axis, from the pivot to the centre of mass.
/// inclination : array_like, shape (...)
///     Angle θ between the axis and the upward vertical, in radians unless `degrees`.
/// gravity : array_like, shape (..., 3)
///     Gravitational acceleration; only its magnitude matters.
/// rtol : float, optional
///     As in `least_spin`.
/// degrees : bool, optional
///     The inclination is in degrees.
///
/// Returns
/// -------
/// numpy.ndarray, shape (..., 2)
///     Slow and fast rate φ̇ about the upward vertical, in radians per unit of time.
///
/// Raises
/// ------
/// PolhodeError
///     For a spin below `least_spin`, a body that is no symmetric top, a pivot that is not on its axis.
///
/// Examples
/// --------
/// >>> from polhode import RigidBody, tops
/// >>> top = RigidBody.from_principal(0.5, moments=(2e-4, 2e-4, 3e-4), center_of_mass=(0, 0, 0.04))
/// >>> tops.steady_precession(top, spin=200.0, inclination=0.5, gravity=(0, 0, -9.81)).round(3)
/// array([ 3.443, 64.926])
#[pyfunction]
#[pyo3(
    signature = (body, spin, inclination, gravity, *, rtol=TOP_RTOL, degrees=false),
    text_signature = "(body, spin, inclination, gravity, *, rtol=1e-06, degrees=False)"
)]
pub(crate) fn steady_precession<'py>(
    py: Python<'py>,
    body: &Bound<'py, PyRigidBody>,
    spin: &Bound<'py, PyAny>,
    inclination: &Bound<'py, PyAny>,
    gravity: &Bound<'py, PyAny>,
    #[pyo3(from_py_with = read_scalar)] rtol: f64,
    degrees: bool,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let bodies = &body.get().bodies;
    let spin: Stack<f64> = read(spin, "spin")?;
    let inclination = in_radians(read(inclination, "inclination")?, degrees);
    let gravity: Stack<Vector3<f64>> = read(gravity, "gravity")?;
    let shapes = [
        &bodies.shape[..],
        &spin.shape,
        &inclination.shape,
        &gravity.shape,
    ];
    let grid = Broadcast::of(["body", "spin", "inclination", "gravity"], shapes)?;
    let rates = grid.try_map(py, |[b, s, i, g]| {
        PivotedTop::of(&bodies[b], rtol)?.steady_precession(spin[s], inclination[i], &gravity[g])
    })?;
    write(py, &rates)
}

/// Inclinations in radians, of which a caller may have given degrees.
pub(crate) fn in_radians(mut inclination: Stack<f64>, degrees: bool) -> Stack<f64> {
    if degrees {
        for angle in &mut inclination.rows {
            *angle = angle.to_radians();
        }
    }
    inclination
}
