//! The allocation of a torque to a set of wheels.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use crate::error::{Error, all_finite};

/// An eigenvalue of A Aᵀ that small, relative to the largest, is that of no axis.
const NO_AXIS: f64 = 1e-12;

/// Compute the pseudo-inverse M of the axes of wheels, the rows m of `τ = −M N`: of all torques τ of the motors with the sum `−Σ a τ = N`, those with
/// the least `Σ τ²`.
///
/// `M = Aᵀ (A Aᵀ)⁺` with the axes a, of unit length, as the columns of A. Where the axes do not span space, the motors exert the part of N that
/// lies within their span.
///
/// Source: Markley and Crassidis, Fundamentals of Spacecraft Attitude Determination and Control, §7.3.4.
///
/// # Errors
/// For an axis without direction.
///
/// # Examples
///
/// ```
/// use polhode::motion::loads::allocation;
/// use polhode::nalgebra::Vector3;
///
/// // A pyramid of four wheels.
/// let axes = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)].map(|(x, y)| Vector3::new(x, y, 1.0));
/// let rows = allocation(&axes)?;
/// let torque = Vector3::new(0.1, -0.2, 0.3);
/// let exerted: Vector3<f64> = axes.iter().zip(rows).map(|(a, m)| a.normalize() * m.dot(&torque)).sum();
/// assert!((exerted - torque).norm() < 1e-15);
/// # Ok::<(), polhode::Error>(())
/// ```
pub fn allocation(axes: &[Vector3<f64>]) -> Result<Vec<Vector3<f64>>, Error> {
    let mut units = Vec::with_capacity(axes.len());
    for axis in axes {
        all_finite("axes", axis)?;
        units.push(unit(axis).ok_or(Error::NoDirection { what: "axes" })?);
    }
    let sum: Matrix3<f64> = units.iter().map(|a| a * a.transpose()).sum();
    let SymmetricEigen {
        eigenvectors,
        eigenvalues,
    } = sum.symmetric_eigen();
    let least = NO_AXIS * eigenvalues.max();
    let inverse = eigenvalues.map(|value| if value > least { value.recip() } else { 0.0 });
    let inverse = eigenvectors * Matrix3::from_diagonal(&inverse) * eigenvectors.transpose();
    Ok(units.iter().map(|a| inverse * a).collect())
}

/// The direction of an axis of any length, if it has one.
fn unit(axis: &Vector3<f64>) -> Option<Vector3<f64>> {
    let unit = (axis / axis.amax()).try_normalize(0.0);
    unit.filter(|_| axis.amax() > 0.0)
}

/// Compute by how much the largest component of `A M A − A` is off, for rows m of an allocation: zero where the wheels exert the torque that is
/// asked for, or its part within the span of their axes.
///
/// # Examples
///
/// ```
/// use polhode::motion::loads::{allocation, allocation_error};
/// use polhode::nalgebra::Vector3;
///
/// let axes = [Vector3::x(), Vector3::y(), Vector3::z(), Vector3::repeat(1.0)];
/// assert!(allocation_error(&axes, &allocation(&axes)?) < 1e-15);
/// // Each wheel takes the component along its own axis: together too much.
/// assert!(allocation_error(&axes, &axes.map(|axis| axis.normalize())) > 0.5);
/// # Ok::<(), polhode::Error>(())
/// ```
#[must_use]
pub fn allocation_error(axes: &[Vector3<f64>], rows: &[Vector3<f64>]) -> f64 {
    let units: Vec<_> = axes.iter().filter_map(unit).collect();
    let exerted: Matrix3<f64> = units.iter().zip(rows).map(|(a, m)| a * m.transpose()).sum();
    let off = units.iter().map(|a| (exerted * a - a).amax());
    off.fold(
        0.0,
        |most: f64, off| if off.is_nan() { off } else { most.max(off) },
    )
}
