//! Events: when ω₁ of a tumbling body passes through zero, found along the steps and not at samples.

use std::ops::ControlFlow;

use polhode::motion::loads::Analytic;
use polhode::motion::simulate::{
    Direction, EventTrigger, Events, Method, Phase, Rule, State, Task, Tolerance, simulate,
};
use polhode::nalgebra::{Matrix3, UnitQuaternion, Vector3};
use polhode::{Error, RigidBody};

/// ω₁ passes through zero; the fourth time ends the run.
struct Passages;

impl Events for Passages {
    type Error = Error;

    fn rules(&self) -> &[Rule] {
        &[Rule {
            direction: Direction::Any,
            last: 4,
            trigger: EventTrigger::Function,
            has_passed: false,
        }]
    }

    fn value(&mut self, _: usize, _: f64, phase: &Phase) -> Result<f64, Error> {
        Ok(phase.omega.x)
    }
}

fn main() -> Result<(), Error> {
    let moments = [1.0, 2.0, 3.0];
    let body =
        RigidBody::from_principal(1.0, &moments, &Matrix3::identity(), &Vector3::zeros(), 0.0)?;
    let start = Phase::in_place(&State {
        attitude: UnitQuaternion::identity(),
        omega: Vector3::new(0.2, 0.0, 1.0),
    });
    let tolerance = Tolerance::new(1e-12, 0.0)?;
    let task = Task::free(&body, start, &[0.0, 1000.0], Method::Taylor, tolerance);
    let mut load = Analytic::new(&[], task.body_at_point);
    let go_on = &mut |_| ControlFlow::Continue(());
    let run = simulate(&task, &mut load, &mut Passages, go_on).into_result()?;
    for crossing in &run.crossings {
        println!("t = {:.9} s", crossing.time);
    }
    println!("the run ended at {:.9} s", run.time);
    Ok(())
}
