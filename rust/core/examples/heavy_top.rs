//! Lagrange's top: the two steady precessions, the least spin that sleeps, and the exact motion in between.

use polhode::motion::heavy_top::{HeavyTop, PivotedTop};
use polhode::nalgebra::{Matrix3, UnitQuaternion, Vector3};
use polhode::{Error, RigidBody};

fn main() -> Result<(), Error> {
    let (centre, gravity) = (Vector3::new(0.0, 0.0, 0.04), Vector3::new(0.0, 0.0, -9.81));
    let moments = [2e-4, 2e-4, 3e-4];
    let body = RigidBody::from_principal(0.5, &moments, &Matrix3::identity(), &centre, 0.0)?;
    let top = PivotedTop::of(&body, 1e-9)?;
    let (spin, lean) = (150.0, 0.6);
    println!(
        "sleeps upright from {:.2} rad/s on",
        top.least_spin(0.0, &gravity)
    );
    println!(
        "steady at {:.3?} rad/s",
        top.steady_precession(spin, lean, &gravity)?
    );
    let attitude = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), lean);
    let motion = HeavyTop::of(&top, &Vector3::new(0.0, 0.0, spin), &attitude, &gravity)?;
    for k in 0..=5 {
        let t = 0.02 * f64::from(k);
        let axis = motion.at(t).attitude * Vector3::z();
        println!("t = {t:.2} s: leans by {:.4} rad", axis.z.acos());
    }
    Ok(())
}
