//! A satellite in the gradient of gravity: analytic loads, so that `Method::Auto` takes Taylor series.

use std::ops::ControlFlow;

use polhode::motion::loads::{Analytic, GravityGradient};
use polhode::motion::simulate::{Method, NoEvents, Phase, State, Task, Tolerance, simulate};
use polhode::nalgebra::{Matrix3, UnitQuaternion, Vector3};
use polhode::{Error, RigidBody};

fn main() -> Result<(), Error> {
    let (mu, radius) = (3.986_004_418e14_f64, 7.0e6_f64);
    let rate = (mu / radius.powi(3)).sqrt();
    // The axis of the least moment points down: stable, so that a tilt about the normal of the orbit swings to and fro.
    let moments = [60.0, 100.0, 120.0];
    let body =
        RigidBody::from_principal(80.0, &moments, &Matrix3::identity(), &Vector3::zeros(), 0.0)?;
    let start = Phase::in_place(&State {
        attitude: UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.05),
        omega: Vector3::new(0.0, 0.0, rate),
    });
    let (position, velocity) = (Vector3::x() * radius, Vector3::y() * (rate * radius));
    let terms = [GravityGradient::new(mu, &position, &velocity, None)?.into()];
    let times: Vec<f64> = (0..=8).map(|k| 600.0 * f64::from(k)).collect();
    let task = Task::free(
        &body,
        start,
        &times,
        Method::Auto,
        Tolerance::new(1e-12, 0.0)?,
    );
    let mut load = Analytic::new(&terms, task.body_at_point);
    let go_on = &mut |_| ControlFlow::Continue(());
    let run = simulate(&task, &mut load, &mut NoEvents::new(), go_on).into_result()?;
    for (t, phase) in times.iter().zip(&run.samples) {
        let along = phase.attitude * Vector3::x();
        let tilt = (along.y.atan2(along.x) - rate * t).rem_euclid(std::f64::consts::TAU);
        let tilt = if tilt > std::f64::consts::PI {
            tilt - std::f64::consts::TAU
        } else {
            tilt
        };
        println!("t = {t:6.0} s: tilted by {tilt:+.4} rad");
    }
    println!("{} steps", run.effort.steps);
    Ok(())
}
