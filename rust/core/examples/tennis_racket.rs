//! The tennis racket: a spin about the axis of the intermediate moment turns over, at times that a closed form gives.

use polhode::motion::free::FreeMotion;
use polhode::nalgebra::{Matrix3, UnitQuaternion, Vector3};
use polhode::{Error, RigidBody};

fn main() -> Result<(), Error> {
    let moments = [1.0, 2.0, 3.0];
    let body =
        RigidBody::from_principal(1.0, &moments, &Matrix3::identity(), &Vector3::zeros(), 0.0)?;
    let motion = FreeMotion::of(
        &body,
        &Vector3::new(1e-3, 1.0, 0.0),
        &UnitQuaternion::identity(),
    )?;
    let periods = motion.periods();
    println!(
        "{:?}, from one flip to the next {:.6} s",
        motion.mode, periods.flip
    );
    for k in 0..4 {
        let t = f64::from(k) * periods.flip;
        println!("t = {t:10.6}  ω₂ = {:+.6}", motion.at(t).omega.y);
    }
    // A billion turns later the state is as good as now.
    println!("{:+.6}", motion.at(1e9 * periods.rotation).omega.y);
    Ok(())
}
