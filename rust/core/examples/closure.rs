//! A load that only the caller knows: a thruster that fires for a second, as a closure with its breaks.

use std::ops::ControlFlow;

use polhode::Error;
use polhode::mass::{Amount, solids};
use polhode::motion::loads::Callback;
use polhode::motion::simulate::{Method, NoEvents, Phase, State, Task, Tolerance, simulate};
use polhode::nalgebra::{UnitQuaternion, Vector3};

fn main() -> Result<(), Error> {
    let body = solids::cylinder(0.2, 0.5, Amount::Mass(10.0))?;
    let still = Phase::in_place(&State {
        attitude: UnitQuaternion::identity(),
        omega: Vector3::zeros(),
    });
    let fires = |t: f64, _: &Phase| Ok::<_, Error>(Vector3::z() * if t < 1.0 { 0.3 } else { 0.0 });
    let mut thruster = Callback::torque(fires).with_breaks(&[1.0]);
    let task = Task::free(
        &body,
        still,
        &[0.0, 0.5, 1.0, 4.0],
        Method::Auto,
        Tolerance::new(1e-10, 0.0)?,
    );
    let go_on = &mut |_| ControlFlow::Continue(());
    let run = simulate(&task, &mut thruster, &mut NoEvents::new(), go_on).into_result()?;
    for (t, phase) in task.times.iter().zip(&run.samples) {
        println!("t = {t} s: ω = {:.6} rad/s", phase.omega.z);
    }
    // What fails is an error, not a panic: times run one way.
    let task = Task {
        times: &[0.0, 2.0, 1.0],
        ..task
    };
    let run = simulate(&task, &mut thruster, &mut NoEvents::new(), go_on);
    println!(
        "{}",
        run.into_result()
            .map_or_else(|error| error.to_string(), |_| "a run".to_owned())
    );
    Ok(())
}
