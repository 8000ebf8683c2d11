//! Against closed forms; against the law of composition.

use std::ops::ControlFlow;

use nalgebra::{Matrix3, Matrix6, Quaternion, UnitQuaternion, Vector3};

use super::{Variation, variations};
use crate::error::MotionFault;
use crate::mass::RigidBody;
use crate::motion::free::FreeMotion;
use crate::motion::loads::{Feedback, Frame, GravityGradient, Term};
use crate::motion::problem::{Method, Task, Tolerance};
use crate::motion::state::{Phase, State};

fn body(moments: [f64; 3]) -> RigidBody {
    let body =
        RigidBody::from_principal(2.0, &moments, &Matrix3::identity(), &Vector3::zeros(), 0.0);
    body.expect("body")
}

fn attitude() -> UnitQuaternion<f64> {
    UnitQuaternion::new_normalize(Quaternion::new(0.7, 0.3, -0.2, 0.4))
}

fn varied(body: &RigidBody, start: &State, times: &[f64], terms: &[Term]) -> Vec<Variation> {
    let tolerance = Tolerance::new(1e-10, 0.0).expect("tolerance");
    let task = Task::free(
        body,
        Phase::in_place(start),
        times,
        Method::Taylor,
        tolerance,
    );
    variations(&task, terms, &[], &mut |_| ControlFlow::Continue(())).expect("goes on")
}

#[test]
fn a_free_body() {
    let start = State {
        attitude: attitude(),
        omega: Vector3::new(0.3, 0.2, 1.1),
    };
    for moments in [[1.0, 2.0, 2.5], [2.0, 2.0, 2.5], [2.0, 2.0, 2.0]] {
        let body = body(moments);
        let motion = FreeMotion::of(&body, &start.omega, &start.attitude).expect("motion");
        for t in [60.0, -7.0] {
            let (found, exact) = (
                &varied(&body, &start, &[0.0, t], &[])[1],
                motion.sensitivity(t),
            );
            let size = exact.state.norm();
            assert!(
                (found.state - exact.state).norm() < 1e-13 * size,
                "{moments:?} {t}"
            );
            assert!((found.moments - exact.moments).norm() < 1e-13 * exact.moments.norm());
            assert_eq!(found.mass.norm(), 0.0);
        }
    }
}

#[test]
fn two_spans_make_one() {
    let gradient = GravityGradient::new(
        1.0,
        &Vector3::new(1.0, 0.25, 0.125),
        &Vector3::new(-0.125, 1.125, 0.25),
        Some(-0.5),
    );
    let feedback = Feedback::new(
        &Matrix3::from_diagonal_element(0.3),
        &Matrix3::from_diagonal_element(0.01),
        &UnitQuaternion::identity(),
    );
    let terms = [
        Term::GravityGradient(gradient.expect("orbit")),
        Term::Feedback(feedback.expect("finite")),
        Term::constant_torque(&Vector3::new(0.05, 0.0, 0.1), Frame::Space).expect("finite"),
    ];
    let start = State {
        attitude: attitude(),
        omega: Vector3::new(0.3, 0.2, 1.1),
    };
    let body = body([1.0, 2.0, 2.5]);
    let tolerance = Tolerance::new(1e-14, 0.0).expect("tolerance");
    let task = Task::free(
        &body,
        Phase::in_place(&start),
        &[0.0, 4.0],
        Method::Taylor,
        tolerance,
    );
    let mut watch = |_: f64| ControlFlow::Continue(());
    let run = crate::motion::integrate::taylor::solve_one(&task, &terms, &mut watch);
    let middle = run.phase.state();
    let whole = varied(&body, &start, &[0.0, 4.0, 20.0], &terms);
    let late = &varied(&body, &middle, &[4.0, 20.0], &terms)[1];
    let size = late.state.norm() * whole[1].state.norm();
    assert!((late.state * whole[1].state - whole[2].state).norm() < 1e-12 * size);
    for k in 0..whole[1].load.len() {
        let together = late.state * whole[1].load[k] + late.load[k];
        let error = (together - whole[2].load[k]).norm();
        assert!(
            error < 1e-12 * (size + late.load[k].norm()),
            "{k} {error:e}"
        );
    }
    assert_eq!(whole[0].state, Matrix6::identity());
}

#[test]
fn an_orbit_known_many_revolutions_ago() {
    // The epoch moved along the orbit by one revolution: the same motion, and derivatives that differ by the change of the period.
    let orbit = |epoch: f64| {
        let (r, v) = (Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, 1.0, 0.0));
        Term::GravityGradient(GravityGradient::new(1.0, &r, &v, Some(epoch)).expect("orbit"))
    };
    let start = State {
        attitude: attitude(),
        omega: Vector3::new(0.3, 0.2, 1.1),
    };
    let body = body([1.0, 2.0, 2.5]);
    let slopes = |epoch: f64| {
        varied(&body, &start, &[0.0, 3.0], &[orbit(epoch)])[1]
            .load
            .clone()
    };
    let turn = std::f64::consts::TAU;
    let (near, once, often) = (
        slopes(-0.3),
        slopes(-0.3 - turn),
        slopes(-0.3 - 1000.0 * turn),
    );
    for k in 0..near.len() {
        let (one, many) = (once[k] - near[k], often[k] - near[k]);
        assert!(
            (many - one * 1000.0).norm() < 1e-10 * (1.0 + many.norm()),
            "{k}"
        );
    }
    // A circle of unit radius and speed: T = 2π μ/(2μ − 1)^{3/2} by μ is −4π; later phases have the derivative of a shifted
    // epoch, found from the speeds along the orbit.
    let by_phase = near[2] * 1.0 - near[4] * 1.0;
    let expected = by_phase * (2.0 * turn);
    assert!((once[0] - near[0] - expected).norm() < 1e-11 * (1.0 + expected.norm()));
}

#[test]
fn derivatives_beyond_all_numbers_are_refused() {
    // Backward in time damping drives: ∂ω(t)/∂ω(0) = exp(−2 t/I).
    let body = body([1.0, 1.0, 1.0]);
    let damping = crate::motion::loads::Damping {
        linear: Matrix3::identity() * 2.0,
        quadratic: Matrix3::zeros(),
    };
    let start = State {
        attitude: attitude(),
        omega: Vector3::zeros(),
    };
    let terms = [Term::Damping(damping)];
    let there = &varied(&body, &start, &[0.0, -350.0], &terms)[1];
    assert!((there.state[(3, 3)] / 700.0_f64.exp() - 1.0).abs() < 1e-11);
    let tolerance = Tolerance::new(1e-10, 0.0).expect("tolerance");
    let times = [0.0, -350.0, -360.0];
    let task = Task::free(
        &body,
        Phase::in_place(&start),
        &times,
        Method::Taylor,
        tolerance,
    );
    let beyond = variations(&task, &terms, &[], &mut |_| ControlFlow::Continue(()));
    assert_eq!(
        beyond,
        Err(MotionFault::NotFiniteDerivative { time: -360.0 }.into())
    );
}
