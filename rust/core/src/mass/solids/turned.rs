//! Solids of revolution about z with straight sides or rounded ends, and the torus.

use std::f64::consts::PI;

use super::super::amount::{Amount, Measure, Unit, diagonal, length, ordered};
use super::super::body::RigidBody;
use crate::error::Error;

/// Cylinder of radius R and height h along z: `I_z = ½ m R²`, `I_x = m (3R² + h²)/12` (mex252).
///
/// # Errors
/// When a length is negative or not finite, or the amount is not positive.
pub fn cylinder(radius: f64, height: f64, amount: Amount) -> Result<RigidBody, Error> {
    length("radius", radius)?;
    length("height", height)?;
    let (unit, [radius, height]) = Unit::of([radius, height]);
    let across = radius * radius / 4.0;
    diagonal(
        unit,
        Measure::Volume(PI * radius * radius * height),
        amount,
        [across, across, height * height / 12.0],
    )
}

/// Tube along z between the radii r and R: `I_z = ½ m (R² + r²)`, `s_z = m h²/12`; for r = R the thin shell.
///
/// # Errors
/// When a length is negative or not finite, the inner radius is the larger, or the amount is not positive.
pub fn tube(
    inner_radius: f64,
    outer_radius: f64,
    height: f64,
    amount: Amount,
) -> Result<RigidBody, Error> {
    ordered(
        ("inner_radius", inner_radius),
        ("outer_radius", outer_radius),
    )?;
    length("height", height)?;
    let (unit, [r, R, height]) = Unit::of([inner_radius, outer_radius, height]);
    let across = (R * R + r * r) / 4.0;
    diagonal(
        unit,
        Measure::Volume(PI * (R - r) * (R + r) * height),
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
    let (unit, [radius, height]) = Unit::of([radius, height]);
    let across = 3.0 * radius * radius / 20.0;
    diagonal(
        unit,
        Measure::Volume(PI * radius * radius * height / 3.0),
        amount,
        [across, across, 3.0 * height * height / 80.0],
    )
}

/// Cone cut off parallel to its base: radius R at its lower end, r at its upper one (toward +z), height h.
///
/// With `Q = R² + R r + r²`: `V = π h Q/3`, the lower end at `−h (R² + 2Rr + 3r²)/(4Q)` from C,
/// `s_x = (3/20) m (R⁴ + R³r + R²r² + Rr³ + r⁴)/Q`, `s_z = (3/80) m h² (R⁴ + 4R³r + 10R²r² + 4Rr³ + r⁴)/Q²`.
///
/// # Errors
/// When a length is negative or not finite, both radii are zero, or the amount is not positive.
pub fn frustum(
    bottom_radius: f64,
    top_radius: f64,
    height: f64,
    amount: Amount,
) -> Result<RigidBody, Error> {
    length("bottom_radius", bottom_radius)?;
    length("top_radius", top_radius)?;
    length("height", height)?;
    let wide = bottom_radius.max(top_radius);
    if wide == 0.0 {
        return Err(Error::OutOfDomain {
            what: "bottom_radius or top_radius",
            law: "positive (without width the mass along the height depends on the ratio of the two: a thin uniform one is \
                  a rod)",
            value: wide,
        });
    }
    // The formulas are symmetric in the two radii.
    let (unit, [narrow, wide, height]) = Unit::of([bottom_radius.min(top_radius), wide, height]);
    let t = narrow / wide;
    let quadratic = 1.0 + t * (1.0 + t);
    let quartic = 1.0 + t * (1.0 + t * quadratic);
    let along = 1.0 + t * (4.0 + t * (10.0 + t * (4.0 + t)));
    let across = 3.0 / 20.0 * wide * wide * (quartic / quadratic);
    diagonal(
        unit,
        Measure::Volume(PI / 3.0 * height * (wide * wide * quadratic)),
        amount,
        [
            across,
            across,
            3.0 / 80.0 * height * height * (along / (quadratic * quadratic)),
        ],
    )
}

/// Cylinder of radius R and length L along z with a half ball on each end.
///
/// With the shares of the mass `w = L/(L + 4R/3)` in the cylinder and `1 − w` in the half balls:
/// `s_x = m R² (w/4 + (1 − w)/5)`, `s_z = m (w L²/12 + (1 − w) (R²/5 + 3 R L/8 + L²/4))`. Without length a ball, without
/// radius a rod.
///
/// # Errors
/// When a length is negative or not finite, or the amount is not positive.
pub fn capsule(radius: f64, length: f64, amount: Amount) -> Result<RigidBody, Error> {
    self::length("radius", radius)?;
    self::length("length", length)?;
    let (unit, [R, L]) = Unit::of([radius, length]);
    let caps = 4.0 / 3.0 * R;
    let whole = L + caps;
    let (w, v) = if whole == 0.0 {
        (0.0, 1.0)
    } else {
        (L / whole, caps / whole)
    };
    let across = R * R * (w / 4.0 + v / 5.0);
    let along = w * (L * L / 12.0) + v * (R * R / 5.0 + 0.375 * R * L + L * L / 4.0);
    diagonal(
        unit,
        Measure::Volume(PI * R * R * whole),
        amount,
        [across, across, along],
    )
}

/// Torus about z: a disk of radius r led along a circle of radius R ≥ r. `I_z = m (R² + ¾ r²)`,
/// `I_x = m (½ R² + ⅝ r²)`; for r = 0 a ring.
///
/// # Errors
/// When a radius is negative or not finite, the minor one is the larger, or the amount is not positive.
pub fn torus(major_radius: f64, minor_radius: f64, amount: Amount) -> Result<RigidBody, Error> {
    ordered(
        ("minor_radius", minor_radius),
        ("major_radius", major_radius),
    )?;
    let (unit, [R, r]) = Unit::of([major_radius, minor_radius]);
    let across = R * R / 2.0 + 0.375 * r * r;
    diagonal(
        unit,
        Measure::Volume(2.0 * PI * PI * R * r * r),
        amount,
        [across, across, r * r / 4.0],
    )
}

#[cfg(test)]
mod tests {
    use super::*;
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
