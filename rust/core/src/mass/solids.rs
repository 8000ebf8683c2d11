//! Homogeneous solids: centre of mass at the origin, symmetry axis z (mex252, 253, 254, 71).
//!
//! Each is its second moment in closed form; zero lengths are the degenerate limits (a flat cylinder is a disk).

use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;

use super::body::RigidBody;
use super::error_bound::ErrorBound;
use super::second_moment::SecondMoment;
use crate::error::{Error, finite};

/// How much matter: exactly one of the two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// Total mass.
    Mass(f64),
    /// Mass per volume.
    Density(f64),
}

impl Amount {
    /// The mass in `volume`.
    ///
    /// # Errors
    /// When mass or density is not positive and finite.
    pub fn mass(self, volume: f64) -> Result<f64, Error> {
        let (what, value) = match self {
            Self::Mass(mass) => ("mass", mass),
            Self::Density(density) => ("density", density),
        };
        finite(what, value)?;
        if value <= 0.0 {
            return Err(Error::OutOfDomain {
                what,
                law: "positive",
                value,
            });
        }
        Ok(match self {
            Self::Mass(mass) => mass,
            Self::Density(density) => density * volume,
        })
    }
}

/// Box with full edge lengths (x, y, z): `s_x = m x²/12`.
///
/// # Errors
/// When a length is negative or not finite, or the amount is not positive.
pub fn cuboid(size: &[f64; 3], amount: Amount) -> Result<RigidBody, Error> {
    for &edge in size {
        length("size", edge)?;
    }
    solid(
        size[0] * size[1] * size[2],
        amount,
        size.map(|edge| edge * edge / 12.0),
    )
}

/// Cube with full edge length a: `I = m a²/6`.
///
/// # Errors
/// When the length is negative or not finite, or the amount is not positive.
pub fn cube(side: f64, amount: Amount) -> Result<RigidBody, Error> {
    length("side", side)?;
    cuboid(&[side; 3], amount)
}

/// Ellipsoid with semi-axes (a, b, c): `s_x = m a²/5`, so `I_x = m (b² + c²)/5` (mex254).
///
/// # Errors
/// When a length is negative or not finite, or the amount is not positive.
pub fn ellipsoid(semi_axes: &[f64; 3], amount: Amount) -> Result<RigidBody, Error> {
    for &semi_axis in semi_axes {
        length("semi_axes", semi_axis)?;
    }
    let [a, b, c] = *semi_axes;
    solid(
        4.0 / 3.0 * PI * a * b * c,
        amount,
        semi_axes.map(|semi_axis| semi_axis * semi_axis / 5.0),
    )
}

/// Ball of radius R: `I = ⅖ m R²` (mex253).
///
/// # Errors
/// When the radius is negative or not finite, or the amount is not positive.
pub fn sphere(radius: f64, amount: Amount) -> Result<RigidBody, Error> {
    length("radius", radius)?;
    ellipsoid(&[radius; 3], amount)
}

/// Cylinder of radius R and height h along z: `I_z = ½ m R²`, `I_x = m (3R² + h²)/12` (mex252).
///
/// # Errors
/// When a length is negative or not finite, or the amount is not positive.
pub fn cylinder(radius: f64, height: f64, amount: Amount) -> Result<RigidBody, Error> {
    length("radius", radius)?;
    length("height", height)?;
    let across = radius * radius / 4.0;
    solid(
        PI * radius * radius * height,
        amount,
        [across, across, height * height / 12.0],
    )
}

/// Cone of base radius R and height h along z, apex toward +z at 3h/4 from C:
/// `I_z = (3/10) m R²`, `I_x = (3/20) m (R² + h²/4)` (mex71).
///
/// # Errors
/// When a length is negative or not finite, or the amount is not positive.
pub fn cone(radius: f64, height: f64, amount: Amount) -> Result<RigidBody, Error> {
    length("radius", radius)?;
    length("height", height)?;
    let across = 3.0 * radius * radius / 20.0;
    solid(
        PI * radius * radius * height / 3.0,
        amount,
        [across, across, 3.0 * height * height / 80.0],
    )
}

/// A length is finite and not negative.
fn length(what: &'static str, value: f64) -> Result<(), Error> {
    finite(what, value)?;
    if value < 0.0 {
        return Err(Error::OutOfDomain {
            what,
            law: "zero or more",
            value,
        });
    }
    Ok(())
}

/// The body whose second moment per unit mass is diagonal in the body axes.
fn solid(volume: f64, amount: Amount, per_mass: [f64; 3]) -> Result<RigidBody, Error> {
    let mass = amount.mass(volume)?;
    if mass == 0.0 {
        return Err(Error::OutOfDomain {
            what: "volume",
            law: "positive when density= is given (a degenerate solid takes mass=)",
            value: volume,
        });
    }
    RigidBody::from_second_moment(&SecondMoment {
        mass,
        center_of_mass: Vector3::zeros(),
        central: Matrix3::from_diagonal(&Vector3::from(per_mass.map(|s| mass * s))),
        axes: Matrix3::identity(),
        error_bound: ErrorBound::of_closed_form(mass, 2.0 * mass * per_mass.iter().sum::<f64>()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flat_cylinder_is_a_disk_and_thin_cylinder_is_a_rod() {
        let disk = cylinder(2.0, 0.0, Amount::Mass(3.0))
            .expect("disk")
            .principal()
            .moments;
        assert_eq!(disk, [3.0, 3.0, 6.0]);
        let rod = cylinder(0.0, 2.0, Amount::Mass(3.0))
            .expect("rod")
            .principal()
            .moments;
        assert_eq!(rod, [0.0, 1.0, 1.0]);
        assert!(cylinder(2.0, 0.0, Amount::Density(1.0)).is_err());
    }

    #[test]
    fn cone_about_its_apex() {
        let (m, r, h) = (2.0, 0.5, 1.5);
        let cone = cone(r, h, Amount::Mass(m)).expect("cone");
        let about_apex = cone.inertia_about(&Vector3::new(0.0, 0.0, 0.75 * h));
        assert!((about_apex[(2, 2)] - 0.3 * m * r * r).abs() < 1e-15);
        assert!((about_apex[(0, 0)] - 0.6 * m * (h * h + r * r / 4.0)).abs() < 1e-14);
    }
}
