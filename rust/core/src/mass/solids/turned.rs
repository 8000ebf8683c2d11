//! Solids of revolution about z with straight sides or rounded ends, and the torus.

use std::f64::consts::PI;

use super::super::amount::{Amount, Measure, check_order, length};
use super::super::inertial_parameters::{Size, diagonal};
use crate::error::Error;

/// Cylinder of radius R and height h along z: `I_z = ½ m R²`, `I_x = m (3R² + h²)/12` (mex252).
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
///
/// let body = solids::cylinder(2.0, 6.0, Amount::Mass(1.0))?;
/// let expected = [2.0, 4.0, 4.0]; // m r²/2, m (3 r² + h²)/12
/// for (moment, expected) in body.principal().moments.iter().zip(expected) {
///     assert!((moment - expected).abs() < 1e-14);
/// }
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When a length is negative or not finite, or the amount is not positive.
pub fn cylinder<X: Size>(radius: X, height: X, amount: Amount) -> Result<X::Body, Error> {
    length("radius", radius)?;
    length("height", height)?;
    let (unit, [radius, height]) = X::in_unit([radius, height]);
    let across = radius * radius / 4.0;
    diagonal(
        unit,
        Measure::Volume(radius * PI * radius * height),
        amount,
        [across, across, height * height / 12.0],
    )
}

/// Tube along z between the radii r and R: `I_z = ½ m (R² + r²)`, `s_z = m h²/12`; for r = R the thin shell.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
///
/// let body = solids::tube(1.0, 1.0, 6.0, Amount::Mass(2.0))?;
/// let expected = [2.0, 7.0, 7.0]; // a thin one: m r², m (6 r² + h²)/12
/// for (moment, expected) in body.principal().moments.iter().zip(expected) {
///     assert!((moment - expected).abs() < 1e-14);
/// }
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When a length is negative or not finite, the inner radius is the larger, or the amount is not positive.
pub fn tube<X: Size>(
    inner_radius: X,
    outer_radius: X,
    height: X,
    amount: Amount,
) -> Result<X::Body, Error> {
    check_order(
        ("inner_radius", inner_radius),
        ("outer_radius", outer_radius),
    )?;
    length("height", height)?;
    let (unit, [r, R, height]) = X::in_unit([inner_radius, outer_radius, height]);
    let across = (R * R + r * r) / 4.0;
    diagonal(
        unit,
        Measure::Volume((R - r) * PI * (R + r) * height),
        amount,
        [across, across, height * height / 12.0],
    )
}

/// Cone of base radius R and height h along z, apex toward +z at 3h/4 from C:
/// `I_z = (3/10) m R²`, `I_x = (3/20) m (R² + h²/4)` (mex71).
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
///
/// let body = solids::cone(2.0, 4.0, Amount::Mass(10.0))?;
/// let expected = [12.0, 12.0, 12.0]; // 3/10 m r², 3/80 m (4 r² + h²)
/// for (moment, expected) in body.principal().moments.iter().zip(expected) {
///     assert!((moment - expected).abs() < 1e-14);
/// }
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When a length is negative or not finite, or the amount is not positive.
pub fn cone<X: Size>(radius: X, height: X, amount: Amount) -> Result<X::Body, Error> {
    length("radius", radius)?;
    length("height", height)?;
    let (unit, [radius, height]) = X::in_unit([radius, height]);
    let across = radius * 3.0 * radius / 20.0;
    diagonal(
        unit,
        Measure::Volume(radius * PI * radius * height / 3.0),
        amount,
        [across, across, height * 3.0 * height / 80.0],
    )
}

/// Cone cut off parallel to its base: radius R at its lower end, r at its upper one (toward +z), height h.
///
/// With `Q = R² + R r + r²`: `V = π h Q/3`, the lower end at `−h (R² + 2Rr + 3r²)/(4Q)` from C,
/// `s_x = (3/20) m (R⁴ + R³r + R²r² + Rr³ + r⁴)/Q`, `s_z = (3/80) m h² (R⁴ + 4R³r + 10R²r² + 4Rr³ + r⁴)/Q²`.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
///
/// // With equal radii it is a cylinder, with none on top a cone.
/// let same = solids::frustum(2.0, 2.0, 6.0, Amount::Mass(1.0))?;
/// assert!(same.is_close(&solids::cylinder(2.0, 6.0, Amount::Mass(1.0))?, 1e-14, 0.0));
/// let pointed = solids::frustum(2.0, 0.0, 4.0, Amount::Mass(1.0))?;
/// assert!(pointed.is_close(&solids::cone(2.0, 4.0, Amount::Mass(1.0))?, 1e-14, 1e-14));
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When a length is negative or not finite, both radii are zero, or the amount is not positive.
pub fn frustum<X: Size>(
    bottom_radius: X,
    top_radius: X,
    height: X,
    amount: Amount,
) -> Result<X::Body, Error> {
    length("bottom_radius", bottom_radius)?;
    length("top_radius", top_radius)?;
    length("height", height)?;
    let [narrow, wide] = if bottom_radius.rounded() <= top_radius.rounded() {
        [bottom_radius, top_radius]
    } else {
        [top_radius, bottom_radius]
    };
    if wide.rounded() == 0.0 {
        return Err(Error::OutOfDomain {
            what: "bottom_radius or top_radius",
            law: "positive (without width the mass along the height depends on the ratio of the two: a thin uniform one is \
                  a rod)",
            value: 0.0,
        });
    }
    // The formulas are symmetric in the two radii.
    let (unit, [narrow, wide, height]) = X::in_unit([narrow, wide, height]);
    let t = narrow / wide;
    let [one, four, ten] = [1.0, 4.0, 10.0].map(X::from);
    let quadratic = one + t * (one + t);
    let quartic = one + t * (one + t * quadratic);
    let along = one + t * (four + t * (ten + t * (four + t)));
    let across = wide * (3.0 / 20.0) * wide * (quartic / quadratic);
    diagonal(
        unit,
        Measure::Volume(height * (PI / 3.0) * (wide * wide * quadratic)),
        amount,
        [
            across,
            across,
            height * (3.0 / 80.0) * height * (along / (quadratic * quadratic)),
        ],
    )
}

/// Cylinder of radius R and length L along z with a half ball on each end.
///
/// With the shares of the mass `w = L/(L + 4R/3)` in the cylinder and `1 − w` in the half balls:
/// `s_x = m R² (w/4 + (1 − w)/5)`, `s_z = m (w L²/12 + (1 − w) (R²/5 + 3 R L/8 + L²/4))`. Without length a ball, without
/// radius a rod.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
///
/// // Without its cylinder it is a ball.
/// let capsule = solids::capsule(1.0, 0.0, Amount::Mass(5.0))?;
/// assert!((capsule.principal().moments[0] - 2.0).abs() < 1e-14);
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When a length is negative or not finite, or the amount is not positive.
pub fn capsule<X: Size>(radius: X, length: X, amount: Amount) -> Result<X::Body, Error> {
    self::length("radius", radius)?;
    self::length("length", length)?;
    let (unit, [R, L]) = X::in_unit([radius, length]);
    let caps = R * (4.0 / 3.0);
    let whole = L + caps;
    let (w, v) = if whole.rounded() == 0.0 {
        (X::zero(), X::one())
    } else {
        (L / whole, caps / whole)
    };
    let across = R * R * (w / 4.0 + v / 5.0);
    let along = w * (L * L / 12.0) + v * (R * R / 5.0 + R * 0.375 * L + L * L / 4.0);
    diagonal(
        unit,
        Measure::Volume(R * PI * R * whole),
        amount,
        [across, across, along],
    )
}

/// Torus about z: a disk of radius r led along a circle of radius R ≥ r. `I_z = m (R² + ¾ r²)`,
/// `I_x = m (½ R² + ⅝ r²)`; for r = 0 a ring.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
///
/// let ring = solids::torus(2.0, 1.0, Amount::Mass(4.0))?;
/// assert!((ring.principal().moments[2] - 4.0 * (4.0 + 0.75)).abs() < 1e-13); // m (R² + 3/4 r²)
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When a radius is negative or not finite, the minor one is the larger, or the amount is not positive.
pub fn torus<X: Size>(major_radius: X, minor_radius: X, amount: Amount) -> Result<X::Body, Error> {
    check_order(
        ("minor_radius", minor_radius),
        ("major_radius", major_radius),
    )?;
    let (unit, [R, r]) = X::in_unit([major_radius, minor_radius]);
    let across = R * R / 2.0 + r * 0.375 * r;
    diagonal(
        unit,
        Measure::Volume(R * (2.0 * PI * PI) * r * r),
        amount,
        [across, across, r * r / 4.0],
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RigidBody;
    use nalgebra::Vector3;

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

    #[test]
    fn frustum_is_a_cylinder_or_a_cone_at_its_ends() {
        let amount = Amount::Density(2.0);
        let close = |a: RigidBody, b: RigidBody| assert!(a.is_close(&b, 1e-15, 0.0), "{a:?} {b:?}");
        close(
            frustum(0.5, 0.5, 1.5, amount).expect("frustum"),
            cylinder(0.5, 1.5, amount).expect("cylinder"),
        );
        close(
            frustum(0.5, 0.0, 1.5, amount).expect("frustum"),
            cone(0.5, 1.5, amount).expect("cone"),
        );
        assert!(frustum(0.0, 0.0, 1.5, Amount::Mass(1.0)).is_err());
    }
}
