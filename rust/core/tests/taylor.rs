//! Taylor series: what a motion conserves, closed forms, the other method, and the same bits however motions are run.

use crate::motions::{aligned, apart, asymmetric, gradient, kept_by_a_top, loads, skew, turned};
use crate::settings::take_turn;
use crate::strategies::{any_body, vector};
use crate::watch::go_on;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use polhode::RigidBody;
use polhode::motion::integrate::taylor::{solve_many, solve_one};
use polhode::motion::loads::{Analytic, Damping, Frame, Term};
use polhode::motion::simulate::{
    End, Method, NoEvents, Phase, Run, TIGHTEST, Task, Tolerance, simulate,
};
use polhode::parallel::{Level, level, set_level, set_thread_limit};
use proptest::prelude::*;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;

fn tightest() -> Tolerance {
    Tolerance::new(TIGHTEST, 0.0).expect("a tolerance")
}

fn run(task: &Task<'_>, terms: &[Term]) -> Run<polhode::Error> {
    let run = solve_one(task, terms, &mut go_on);
    assert_eq!(run.end, End::Complete);
    run
}

#[test]
fn every_term_agrees_with_runge_and_kutta() {
    let times = [0.0, 1.0, 4.5, 7.7, 10.0];
    let tolerance = Tolerance::new(1e-13, 0.0).expect("a tolerance");
    let body = asymmetric();
    let mut cases = loads();
    cases.push(("gravity gradient", vec![gradient()]));
    for (name, terms) in &cases {
        for (pivoted, omega) in [
            (false, Vector3::new(0.7, -0.9, 1.1)),
            (false, Vector3::zeros()),
            (true, Vector3::new(0.7, -0.9, 1.1)),
        ] {
            if pivoted && *name == "gravity gradient" {
                continue;
            }
            let mut initial = turned(skew(), omega);
            if !pivoted {
                initial.velocity = Vector3::new(0.1, 0.2, 0.3);
            }
            let of = if pivoted { Task::pivoted } else { Task::free };
            let task = of(&body, initial, &times, Method::Dop853, tolerance);
            let mut load = Analytic::new(terms, task.body_at_point);
            let other = simulate(&task, &mut load, &mut NoEvents::new(), &mut go_on);
            for (a, b) in run(&task, terms).samples.iter().zip(&other.samples) {
                let error = apart(a, b);
                // Runge and Kutta step over the flips of a feedback.
                let allowed = if terms.iter().any(|term| matches!(term, Term::Feedback(_))) {
                    1e-9
                } else {
                    3e-12
                };
                assert!(error < allowed, "{name} {pivoted} {omega:?}: {error:e}");
            }
        }
    }
}

#[test]
fn backward_in_time_is_the_way_back() {
    let body = asymmetric();
    for (name, terms) in loads() {
        let damped = |term: &Term| {
            use Term::{Damping, Feedback, Slug, Wheel};
            matches!(term, Damping(_) | Feedback(_) | Slug(_) | Wheel(_))
        };
        if terms.iter().any(damped) {
            continue;
        }
        let (forth, back) = ([0.0, 8.0], [8.0, 0.0]);
        let initial = turned(skew(), Vector3::new(0.7, -0.9, 1.1));
        let there = run(
            &Task::free(&body, initial.clone(), &forth, Method::Taylor, tightest()),
            &terms,
        );
        let task = Task::free(&body, there.phase, &back, Method::Taylor, tightest());
        let error = apart(&run(&task, &terms).phase, &initial);
        assert!(error < 2e-13, "{name}: {error:e}");
    }
}

#[test]
fn energy_and_angular_momentum_stay_for_ten_thousand_turns() {
    let turns = 1e4 * 2.0 * std::f64::consts::PI;
    let body = asymmetric();
    let omega = Vector3::new(0.3, 0.4, 1.1);
    let times = [0.0, turns / omega.norm()];
    let free = Task::free(
        &body,
        turned(skew(), omega),
        &times,
        Method::Taylor,
        tightest(),
    );
    let energy = |w: &Vector3<f64>| 0.5 * w.dot(&(body.inertia() * w));
    let end = run(&free, &[]).phase;
    let drift = energy(&end.omega) / energy(&omega) - 1.0;
    assert!(drift.abs() < 1e-13, "{drift:e}");
    let momentum = |phase: &Phase| phase.attitude * (body.inertia() * phase.omega);
    let (before, after) = (momentum(&free.initial), momentum(&end));
    // The direction feels what rounding adds up to: it is not conserved to the last digit.
    assert!((after - before).norm() < 2e-12 * before.norm());
    assert!((after.norm() / before.norm() - 1.0).abs() < 1e-13);

    let gravity = Vector3::new(0.0, 0.0, -1.0);
    let terms = [Term::uniform_gravity(&gravity).expect("finite")];
    let omega = Vector3::new(0.2, 0.1, 5.0);
    let times = [0.0, turns / omega.norm()];
    let top = Task::pivoted(
        &body,
        turned(skew(), omega),
        &times,
        Method::Taylor,
        tightest(),
    );
    let end = run(&top, &terms).phase;
    let [before, after] = [top.initial, end].map(|phase| kept_by_a_top(&body, &gravity, &phase));
    for (after, before) in after.iter().zip(before) {
        let drift = after / before - 1.0;
        assert!(drift.abs() < 1e-13, "{drift:e}");
    }
}

#[test]
fn spin_up_and_spin_down_about_a_principal_axis() {
    let body = aligned([1.0, 2.0, 2.5]);
    let times = [0.0, 1e3, 4e3];
    let task = |omega| {
        Task::free(
            &body,
            turned(UnitQuaternion::identity(), omega),
            &times,
            Method::Taylor,
            tightest(),
        )
    };
    // ω = N t/I.
    let torque = Term::constant_torque(&Vector3::new(0.0, 0.0, 5e-2), Frame::Body).expect("finite");
    let up = run(&task(Vector3::zeros()), &[torque]);
    assert!((up.samples[1].omega.z / 20.0 - 1.0).abs() < 1e-14);
    assert!((up.samples[2].omega.z / 80.0 - 1.0).abs() < 1e-14);
    // ω = ω₀ exp(−D t/I) and ω₀/(1 + E ω₀ t/I).
    let damping = |linear: f64, quadratic: f64| {
        let (d, e) = (
            Matrix3::identity() * linear,
            Matrix3::identity() * quadratic,
        );
        [Term::Damping(Damping::new(&d, &e).expect("finite"))]
    };
    let down = run(&task(Vector3::z() * 3.0), &damping(0.01, 0.0));
    assert!((down.samples[1].omega.z / (3.0 * (-4.0_f64).exp()) - 1.0).abs() < 1e-13);
    assert!(down.samples[2].omega.z.abs() < 1e-6);
    let down = run(&task(Vector3::z() * 3.0), &damping(0.0, 0.01));
    assert!((down.samples[1].omega.z / (3.0 / 13.0) - 1.0).abs() < 1e-13);
    assert!((down.samples[2].omega.z / (3.0 / 49.0) - 1.0).abs() < 1e-12);
}

#[test]
fn quadratic_damping_and_a_torque_reach_the_terminal_spin_from_either_side() {
    // ω̇ = (N − E |ω| ω)/I: ω = √(N/E) tanh(t √(N E)/I) from rest, and through zero from the other side.
    let body = aligned([2.0; 3]);
    let load = [
        Term::constant_torque(&Vector3::new(0.0, 0.0, 0.5), Frame::Body).expect("finite"),
        Term::Damping(
            Damping::new(&Matrix3::zeros(), &Matrix3::from_diagonal_element(0.02)).expect("finite"),
        ),
    ];
    let times = [0.0, 5.0, 40.0];
    let solve = |omega: f64| {
        let initial = turned(UnitQuaternion::identity(), Vector3::z() * omega);
        run(
            &Task::free(&body, initial, &times, Method::Taylor, tightest()),
            &load,
        )
        .samples
    };
    let exact = |t: f64| 5.0 * (t * 0.05).tanh();
    for (t, phase) in times.iter().zip(solve(0.0)) {
        assert!((phase.omega.z - exact(*t)).abs() < 1e-13, "{t}");
    }
    // From below: tan until it stands still, tanh from then on.
    for start in (10..=490).map(|hundredths| f64::from(hundredths) * -0.01) {
        let still = (start / -5.0).atan() / 0.05;
        for (t, phase) in times.iter().zip(solve(start)) {
            let since = t - still;
            let omega = if since < 0.0 {
                5.0 * (since * 0.05).tan()
            } else {
                exact(since)
            };
            let error = phase.omega.z - omega;
            assert!(error.abs() < 1e-13, "from {start}, at {t}: {error:e}");
        }
    }
}

#[test]
fn a_rod_is_not_twisted() {
    let rod = RigidBody::from_principal(
        1.0,
        &[0.0, 2.0, 2.0],
        &Matrix3::identity(),
        &Vector3::zeros(),
        0.0,
    )
    .expect("a rod");
    let times = [0.0, 10.0];
    let initial = turned(UnitQuaternion::identity(), Vector3::new(3.0, 0.5, 0.0));
    let task = Task::free(&rod, initial.clone(), &times, Method::Taylor, tightest());
    let end = run(&task, &[]).phase;
    assert_eq!(end.omega.x, 3.0);
    assert!((end.omega.norm() - initial.omega.norm()).abs() < 1e-14);
    let twist = Term::constant_torque(&Vector3::x(), Frame::Body).expect("finite");
    let refused = solve_one(&task, &[twist], &mut go_on).end;
    assert!(matches!(
        refused,
        End::Failed(polhode::Error::Motion(
            polhode::error::MotionFault::TorqueAlongMasslessAxis { .. }
        ))
    ));
}

/// A body whose centre is on its third axis, about which the reference point is its pivot.
fn spindle(moments: &[f64; 3]) -> RigidBody {
    let center = Vector3::new(0.0, 0.0, 0.5);
    RigidBody::from_principal(1.0, moments, &Matrix3::identity(), &center, 0.0).expect("a body")
}

/// In one test, since level and threads are the whole process's.
#[test]
fn a_motion_has_the_same_bits_alone_in_a_stack_on_any_threads_and_at_any_level() {
    let _turn = take_turn();
    let (free, pivoted) = (false, true);
    let bodies = [
        (asymmetric(), free),
        (spindle(&[1.0, 1.0, 0.3]), pivoted),
        (spindle(&[1.0, 1.0, 1.9]), pivoted),
        (spindle(&[1.0, 1.0, 1.0]), free),
    ];
    let times = [0.0, 1.0, 4.5, 7.7, 10.0];
    let best = level();
    let mut cases = loads();
    cases.push(("gravity gradient", vec![gradient()]));
    for (name, terms) in &cases {
        // Stacks of one of these bodies, and of the last two in turn.
        for kind in 0..=bodies.len() {
            let task = |row: usize| {
                let omega = Vector3::new(0.7, -0.9, 1.1) * (0.3 + 0.1 * row as f64);
                let omega = if row == 5 { Vector3::zeros() } else { omega };
                let (body, pivoted) = match bodies.get(kind) {
                    Some((body, pivoted)) => (body, *pivoted),
                    None => (&bodies[2 + row % 2].0, free),
                };
                let of = if pivoted { Task::pivoted } else { Task::free };
                let initial = turned(skew(), omega);
                of(body, initial, &times, Method::Taylor, tightest())
            };
            // A body on a pivot has no orbit.
            let is_pivoted = bodies.get(kind).is_some_and(|(_, pivoted)| *pivoted);
            if is_pivoted && *name == "gravity gradient" {
                continue;
            }
            let alone: Vec<_> = (0..21).map(|row| run(&task(row), terms)).collect();
            for level in Level::ALL.into_iter().filter(|level| level.is_available()) {
                for threads in [1, 2] {
                    assert!(set_level(level));
                    set_thread_limit(NonZeroUsize::new(threads));
                    for count in [2, 21] {
                        let mut runs = vec![None; count];
                        solve_many(&task, &|_| &terms[..], &mut runs, &go_on);
                        for (row, (run, alone)) in runs.iter().zip(&alone).enumerate() {
                            let run = run.as_ref().expect("begun");
                            assert_eq!(run.end, End::Complete);
                            if level == Level::Baseline {
                                let error = apart(&run.phase, &alone.phase);
                                assert!(error < 1e-12, "{name} {kind} {row}: {error:e}");
                            } else {
                                assert_eq!(run, alone, "{name} {kind} {row} {level}");
                            }
                        }
                    }
                }
                set_level(best);
                set_thread_limit(None);
            }
        }
    }
}

#[test]
fn runs_stop_when_told() {
    let body = asymmetric();
    let times = [0.0, 1e12];
    let initial = turned(skew(), Vector3::new(0.7, -0.9, 1.1));
    let task = Task::free(&body, initial, &times, Method::Taylor, tightest());
    let mut asked = 0;
    let stopped = solve_one(&task, &[], &mut |done| {
        assert!((0.0..1.0).contains(&done));
        asked += 1;
        if asked == 3 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    });
    assert_eq!(stopped.end, End::Stopped);
    assert!(stopped.time > 0.0 && stopped.effort.steps == 192);
    let mut runs: Vec<Option<Run<polhode::Error>>> = vec![None; 300];
    solve_many(&|_| task.clone(), &|_| &[], &mut runs, &|_| {
        ControlFlow::Break(())
    });
    let ends: Vec<_> = runs.iter().flatten().map(|run| &run.end).collect();
    assert!(!ends.is_empty() && ends.iter().all(|end| **end == End::Stopped));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn free_bodies_of_every_scale_keep_energy_and_angular_momentum(
        body in any_body(), omega in vector(1.0), speed in -15.0..15.0_f64,
    ) {
        let omega = omega * 10.0_f64.powf(speed);
        prop_assume!(omega.norm() > 0.0);
        let times = [0.0, 30.0 / omega.norm()];
        let task = Task::free(&body, turned(skew(), omega), &times, Method::Taylor, tightest());
        let run = solve_one(&task, &[], &mut go_on);
        prop_assert_eq!(&run.end, &End::Complete);
        let axes = body.principal().axes;
        let moments = Vector3::from(body.principal().moments);
        let (before, after) = (axes.tr_mul(&omega), axes.tr_mul(&run.phase.omega));
        let energy = |w: &Vector3<f64>| w.dot(&moments.component_mul(w));
        let momentum = |w: &Vector3<f64>| moments.component_mul(w).norm();
        prop_assert!((energy(&after) / energy(&before) - 1.0).abs() < 1e-12);
        prop_assert!((momentum(&after) / momentum(&before) - 1.0).abs() < 1e-12);
    }
}
