//! Taylor series in numbers of twice the precision: the laws of those in doubles, to more digits.

use crate::motions::{aligned, apart, asymmetric, gradient, kept_by_a_top, loads, skew, turned};
use crate::settings::take_turn;
use crate::watch::go_on;
use nalgebra::{Matrix3, Vector3};
use polhode::RigidBody;
use polhode::motion::integrate::taylor::{solve_many, solve_one};
use polhode::motion::loads::{Damping, Frame, Term};
use polhode::motion::simulate::{End, Method, Phase, Run, TIGHTEST, Task, Tolerance};
use polhode::parallel::{Level, level, set_level, set_thread_limit};
use std::num::NonZeroUsize;

fn tolerance(relative: f64) -> Tolerance {
    Tolerance::new(relative, 0.0).expect("a tolerance")
}

fn run(task: &Task<'_>, terms: &[Term]) -> Run<polhode::Error> {
    let run = solve_one(task, terms, &mut go_on);
    assert_eq!(run.end, End::Complete);
    run
}

fn free<'a>(body: &'a RigidBody, initial: Phase, times: &'a [f64], relative: f64) -> Task<'a> {
    Task::free(body, initial, times, Method::Taylor, tolerance(relative))
}

#[test]
fn every_term_agrees_with_doubles_and_does_not_depend_on_the_tolerance() {
    let (body, times) = (asymmetric(), [0.0, 1.0, 4.5, 7.7, 10.0]);
    let mut cases = loads();
    cases.push(("gravity gradient", vec![gradient()]));
    for (name, terms) in &cases {
        for omega in [Vector3::new(0.7, -0.9, 1.1), Vector3::zeros()] {
            let mut initial = turned(skew(), omega);
            initial.velocity = Vector3::new(0.1, 0.2, 0.3);
            let at = |relative| run(&free(&body, initial.clone(), &times, relative), terms).samples;
            let (doubles, close, closest) = (at(TIGHTEST), at(1e-22), at(1e-28));
            for ((a, b), c) in doubles.iter().zip(&close).zip(&closest) {
                let far = c.position.norm().max(1.0);
                assert!(
                    apart(a, c) < 2e-13 * far,
                    "{name} {omega:?}: {:e}",
                    apart(a, c)
                );
                // Damping that is left out near a standstill is left out of other steps.
                let allowed = if name.contains("quadratic") || *name == "all" {
                    1e-15
                } else {
                    4e-16
                };
                assert!(
                    apart(b, c) <= allowed,
                    "{name} {omega:?}: {:e}",
                    apart(b, c)
                );
            }
        }
    }
}

#[test]
fn backward_in_time_is_the_way_back_of_unstable_motions_too() {
    // Spin about the intermediate axis: what is lost grows by e^(0.5·2·…) a second, to 1e7 on the way.
    let body = aligned([1.0, 2.0, 3.0]);
    let initial = turned(skew(), Vector3::new(0.0, 1.0, 1e-8));
    let there = run(&free(&body, initial, &[0.0, 60.0], 1e-28), &[]);
    let back = run(&free(&body, there.phase.clone(), &[60.0, 0.0], 1e-28), &[]);
    let neighbour = run(&free(&body, there.phase, &[60.0, 0.0], 1e-26), &[]);
    let error = apart(&back.phase, &neighbour.phase);
    assert!(error < 4e-16, "{error:e}");
}

#[test]
fn energy_and_angular_momentum_stay_for_ten_thousand_turns() {
    let body = asymmetric();
    let omega = Vector3::new(0.2, 0.1, 5.0);
    let times = [0.0, 1e4 * std::f64::consts::TAU / omega.norm()];
    let gravity = Vector3::new(0.0, 0.0, -1.0);
    let terms = [Term::uniform_gravity(&gravity).expect("finite")];
    let initial = turned(skew(), omega);
    let top = Task::pivoted(
        &body,
        initial.clone(),
        &times,
        Method::Taylor,
        tolerance(1e-25),
    );
    let end = run(&top, &terms).phase;
    let [before, after] = [initial, end].map(|phase| kept_by_a_top(&body, &gravity, &phase));
    for (after, before) in after.iter().zip(before) {
        let drift = after / before - 1.0;
        assert!(drift.abs() < 5e-15, "{drift:e}");
    }
}

#[test]
fn damped_spins_have_their_closed_forms() {
    let body = aligned([1.0, 2.0, 2.5]);
    let times = [0.0, 1e3, 4e3];
    let initial = turned(skew(), Vector3::z() * 3.0);
    let spins = |linear: f64, quadratic: f64| {
        let [d, e] = [linear, quadratic].map(Matrix3::from_diagonal_element);
        let load = [Term::Damping(Damping::new(&d, &e).expect("finite"))];
        let samples = run(&free(&body, initial.clone(), &times, 1e-26), &load).samples;
        [samples[1].omega.z, samples[2].omega.z]
    };
    // ω₀ exp(−D t/I), of dyadic numbers, and ω₀/(1 + E ω₀ t/I).
    let spin = spins(2.5 / 256.0, 0.0)[0];
    assert!((spin / (3.0 * (-1000.0_f64 / 256.0).exp()) - 1.0).abs() < 1e-15);
    let [soon, late] = spins(0.0, 2.5 / 256.0);
    assert!((soon / (3.0 / (1.0 + 3000.0 / 256.0)) - 1.0).abs() < 3e-16);
    assert!((late / (3.0 / (1.0 + 12000.0 / 256.0)) - 1.0).abs() < 3e-16);
}

#[test]
fn a_long_symmetric_rotation_keeps_its_phase() {
    // Steps of more than half a turn, for 163 turns: the length of the quaternion must not feed on itself.
    let body = aligned([1.0, 1.0, 1.5]);
    let times = [0.0, 1024.0];
    let initial = turned(nalgebra::UnitQuaternion::identity(), Vector3::z());
    let task = free(&body, initial, &times, 1e-25);
    let run = run(&task, &[]);
    assert!(run.effort.steps < 300);
    let (sine, cosine) = 512.0_f64.sin_cos();
    let q = run.phase.attitude;
    let sign = if q.w * cosine < 0.0 { -1.0 } else { 1.0 };
    assert!((q.k - sign * sine).abs() < 2e-16 && (q.w - sign * cosine).abs() < 2e-16);
}

/// In one test, since level and threads are the whole process's.
#[test]
fn a_motion_has_the_same_bits_alone_in_a_stack_on_any_threads_and_at_any_level() {
    let _turn = take_turn();
    let (body, times) = (asymmetric(), [0.0, 1.0, 4.5]);
    let best = level();
    for (name, terms) in &loads() {
        let task = |row: usize| {
            let omega = Vector3::new(0.7, -0.9, 1.1) * (0.3 + 0.1 * row as f64);
            free(&body, turned(skew(), omega), &times, 1e-25)
        };
        let alone: Vec<_> = (0..6).map(|row| run(&task(row), terms)).collect();
        for level in Level::ALL.into_iter().filter(|level| level.is_available()) {
            for threads in [1, 2] {
                assert!(set_level(level));
                set_thread_limit(NonZeroUsize::new(threads));
                let mut runs = vec![None; alone.len()];
                solve_many(&task, &|_| &terms[..], &mut runs, &go_on);
                for (row, (run, alone)) in runs.iter().zip(&alone).enumerate() {
                    let run = run.as_ref().expect("begun");
                    if level == Level::Baseline {
                        assert!(apart(&run.phase, &alone.phase) < 1e-15, "{name} {row}");
                    } else {
                        assert_eq!(run, alone, "{name} {row} {level}");
                    }
                }
            }
        }
        set_level(best);
        set_thread_limit(None);
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
    let initial = turned(skew(), Vector3::new(3.0, 0.5, 0.0));
    let task = free(&rod, initial, &[0.0, 10.0], 1e-25);
    assert_eq!(run(&task, &[]).phase.omega.x, 3.0);
    let twist = Term::constant_torque(&Vector3::x(), Frame::Body).expect("finite");
    let refused = solve_one(&task, &[twist], &mut go_on).end;
    assert!(matches!(
        refused,
        End::Failed(polhode::Error::Motion(
            polhode::error::MotionFault::TorqueAlongMasslessAxis { .. }
        ))
    ));
}
