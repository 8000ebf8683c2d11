//! Time of an evaluation of the equations of motion, all that DOP853 does about it included.

#![allow(missing_docs, clippy::expect_used, reason = "a program that measures")]

use std::hint::black_box;
use std::ops::ControlFlow;
use std::time::Instant;

use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use polhode::RigidBody;
use polhode::motion::loads::{Analytic, Term};
use polhode::motion::simulate::{Method, NoEvents, Phase, State, Task, Tolerance, simulate};

fn main() {
    let moments = [1.0, 2.0, 2.5];
    let body =
        RigidBody::from_principal(1.0, &moments, &Matrix3::identity(), &Vector3::zeros(), 0.0)
            .expect("body");
    let initial = Phase::in_place(&State {
        attitude: UnitQuaternion::identity(),
        omega: Vector3::new(1.0, 0.1, 1.0),
    });
    let times = [0.0, 2000.0];
    let tolerance = Tolerance::new(1e-11, 0.0).expect("tolerance");
    let weight = Term::uniform_gravity(&Vector3::new(0.0, 0.0, -1.0)).expect("finite");
    for (name, terms) in [("free", vec![]), ("falling", vec![weight])] {
        let mut best = f64::INFINITY;
        for _ in 0..5 {
            let initial = initial.clone();
            let task = Task::free(&body, initial, &times, Method::Dop853, tolerance);
            let mut load = Analytic::new(&terms, task.body_at_point);
            let start = Instant::now();
            let run = simulate(&task, &mut load, &mut NoEvents::new(), &mut |_| {
                ControlFlow::Continue(())
            });
            let spent = start.elapsed().as_secs_f64();
            best = best.min(spent / run.effort.evaluations as f64);
            black_box(run);
        }
        println!("{name:10} {:6.1} ns an evaluation", best * 1e9);
    }
}
