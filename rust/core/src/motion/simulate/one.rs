//! One motion.

use std::ops::ControlFlow;
use std::slice;

use super::events::Events;
use super::plan::Plan;
use super::{closed_form_run, taylor_run_with_events};
use crate::motion::integrate::taylor;
use crate::motion::loads::Load;
use crate::motion::problem::{End, Method, Run, Task};

/// The motion of `task` under `load`: `q̇ = ½ q∘ω`, `I_P ω̇ + ω×I_P ω = N_P`, and for a free body `m v̇ = F`.
///
/// Steps end where the load is not smooth; samples and events between the ends of steps come from the dense output. `watch`
/// is called with the fraction done after each step and may stop the run.
///
/// What is wrong with the times, the state at the start or the method ends the run before its first step: see [`Run::end`], or
/// [`Run::into_result`] for who wants all states or none.
pub fn simulate<L: Load>(
    task: &Task<'_>,
    load: &mut L,
    events: &mut dyn Events<Error = L::Error>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Run<L::Error> {
    if let Err(error) = task.check_start() {
        return Run::at_start(task, End::Failed(error.into()));
    }
    let plan = Plan::new(
        slice::from_ref(task.body),
        task.body_at_point.pivoted,
        task.times,
        task.method,
        task.tolerance,
        load.analytic(),
        &|_| ControlFlow::Continue(()),
    );
    match plan {
        Ok(plan) => {
            let task = Task {
                method: plan.method(),
                ..task.clone()
            };
            by_method(&task, load, events, watch)
        }
        Err(refusal) => Run::at_start(task, End::Failed(refusal.error.into())),
    }
}

/// The motion of `task` by its method, which is known to serve.
pub(super) fn by_method<L: Load>(
    task: &Task<'_>,
    load: &mut L,
    events: &mut dyn Events<Error = L::Error>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Run<L::Error> {
    let task = &match task.clone().carrying(load.carried().into_iter()) {
        Ok(task) => task,
        Err(error) => return Run::at_start(task, End::Failed(error.into())),
    };
    let has_events = !events.rules().is_empty();
    if let (Method::Taylor, Some(terms)) = (task.method, load.analytic()) {
        return if has_events {
            taylor_run_with_events::solve(task, terms, events, watch)
        } else {
            taylor::solve_one(task, terms, watch).with_error(L::Error::from)
        };
    }
    let mut run = Run::at_start(task, End::Complete);
    let end = match (task.method, load.analytic()) {
        (Method::Exact, Some(terms)) if !has_events => {
            closed_form_run::solve(task, terms, &mut run, watch)
        }
        (method, _) => run.through(method, task, load, events, watch),
    };
    run.end = end.unwrap_or_else(End::Failed);
    run
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mass::RigidBody;
    use crate::motion::loads::{Analytic, Frame, Term};
    use crate::motion::problem::Tolerance;
    use crate::motion::simulate::NoEvents;
    use crate::motion::state::{Phase, State};
    use nalgebra::{Matrix3, UnitQuaternion, Vector3};

    fn watch(_: f64) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn run(
        moments: [f64; 3],
        omega: Vector3<f64>,
        times: &[f64],
        load: &[Term],
        rtol: f64,
    ) -> Vec<Phase> {
        let body =
            RigidBody::from_principal(1.0, &moments, &Matrix3::identity(), &Vector3::zeros(), 0.0);
        let initial = Phase::in_place(&State {
            attitude: UnitQuaternion::identity(),
            omega,
        });
        let tolerance = Tolerance::new(rtol, 0.0).expect("tolerance");
        let body = body.expect("body");
        let task = Task::free(&body, initial, times, Method::Dop853, tolerance);
        let mut load = Analytic::new(load, task.body_at_point);
        let run = simulate(&task, &mut load, &mut NoEvents::new(), &mut watch);
        assert_eq!(run.end, End::Complete);
        run.samples
    }

    #[test]
    fn nasa_check_case_2() {
        // NASA/TM-2015-218675, case 2: slug ft² and deg/s; the exact rates at 30 s by a series in 25 digits.
        let moments = [0.001_894_220, 0.006_211_019, 0.007_194_665];
        let exact = Vector3::new(
            12.618_390_775_914_22,
            -17.397_474_761_611_39,
            31.119_588_886_944_34,
        );
        for (rtol, allowed) in [(1e-13, 1e-11), (1e-10, 1e-8)] {
            let omega = Vector3::new(10.0, 20.0, 30.0).map(f64::to_radians);
            let end = run(moments, omega, &[0.0, 30.0], &[], rtol)[1]
                .omega
                .map(f64::to_degrees);
            assert!((end - exact).norm() < allowed, "{:e}", (end - exact).norm());
        }
    }

    #[test]
    fn symmetric_top_precesses_as_the_closed_form_says() {
        // I₁ = I₂ = I_t: ω_t turns with Ω = (I_s − I_t) ω_s / I_t in the body.
        let times: Vec<f64> = (0..=100).map(|k| 0.37 * f64::from(k)).collect();
        let (w_t, w_s) = (0.5, 2.0);
        for (t, state) in times.iter().zip(run(
            [1.0, 1.0, 1.6],
            Vector3::new(w_t, 0.0, w_s),
            &times,
            &[],
            1e-13,
        )) {
            let angle = 0.6 * w_s * t;
            let exact = Vector3::new(w_t * angle.cos(), w_t * angle.sin(), w_s);
            assert!(
                (state.omega - exact).norm() < 1e-11,
                "{t} {:e}",
                (state.omega - exact).norm()
            );
        }
    }

    #[test]
    fn constant_space_torque_about_a_principal_axis_spins_up() {
        let load =
            [Term::constant_torque(&Vector3::new(0.0, 0.0, 3.0), Frame::Space).expect("finite")];
        let end = &run([1.0, 2.0, 2.5], Vector3::zeros(), &[0.0, 4.0], &load, 1e-12)[1];
        assert!((end.omega - Vector3::new(0.0, 0.0, 4.8)).norm() < 1e-11);
        assert!(
            end.attitude
                .angle_to(&UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 9.6))
                < 1e-10
        );
    }
}
