//! Wheels, rotors and slugs: every method solves the same motion, and keeps what the motion keeps.

use crate::watch::go_on;

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use polhode::RigidBody;
use polhode::motion::loads::{
    Analytic, Drive, Feedback, PiecewiseSignal, Rotor, Slug, Term, Wheel,
};
use polhode::motion::simulate::{End, Method, NoEvents, Run, Task, Tolerance, simulate};
use polhode::motion::state::{Phase, State};

fn body() -> RigidBody {
    let axes = *Rotation3::from_euler_angles(0.3, -1.0, 2.0).matrix();
    RigidBody::from_principal(3.0, &[1.0, 2.0, 2.5], &axes, &Vector3::zeros(), 0.0).expect("a body")
}

fn start() -> Phase {
    Phase::in_place(&State {
        attitude: UnitQuaternion::from_euler_angles(0.3, -0.4, 1.1),
        omega: Vector3::new(0.7, -0.9, 1.1),
    })
}

fn run(terms: &[Term], times: &[f64], method: Method, rtol: f64) -> Run<polhode::Error> {
    let body = body();
    let tolerance = Tolerance::new(rtol, 0.0).expect("a tolerance");
    let task = Task::free(&body, start(), times, method, tolerance);
    let mut load = Analytic::new(terms, task.body_at_point);
    let run = simulate(&task, &mut load, &mut NoEvents::new(), &mut go_on);
    assert_eq!(run.end, End::Complete, "{method:?}");
    run
}

/// The angular momentum in N, and the energy.
fn kept(terms: &[Term], phase: &Phase) -> (Vector3<f64>, f64) {
    let momentum = body().inertia() * phase.omega;
    let (mut sum, mut energy) = (momentum, 0.5 * momentum.dot(&phase.omega));
    let mut own = &phase.internal_state[..];
    for carried in terms.iter().filter_map(Term::carried) {
        let (mine, others) = own.split_at(carried.count());
        own = others;
        sum += carried.momentum(mine, &phase.omega);
        energy += carried.energy(mine, &phase.omega);
    }
    (phase.attitude * sum, energy)
}

fn wheel(axis: [f64; 3], friction: f64, drive: Drive) -> Term {
    Wheel::new(&Vector3::from(axis), 0.2, 3.0, friction, drive)
        .expect("a wheel")
        .into()
}

fn torque(times: &[f64], values: &[f64]) -> Drive {
    Drive::Torque(PiecewiseSignal::table("torque", times, values).expect("a table"))
}

fn free() -> Drive {
    Drive::Torque(PiecewiseSignal::constant("torque", 0.0).expect("finite"))
}

fn speeds() -> Drive {
    Drive::Speed(
        PiecewiseSignal::table("speed", &[0.0, 4.0, 20.0], &[3.0, -2.0, 0.0]).expect("a table"),
    )
}

fn feedback() -> Drive {
    let gain = Matrix3::identity();
    let target = UnitQuaternion::from_euler_angles(-0.8, 0.2, 2.9);
    Drive::Feedback(Feedback::new(&(gain * 2.0), &gain, &target).expect("finite"))
}

fn loads() -> Vec<Vec<Term>> {
    let rotor = || {
        Rotor::new(&Vector3::new(0.4, -0.2, 0.9))
            .expect("finite")
            .into()
    };
    let slug = || Slug::new(0.3, 0.4).expect("a slug").into();
    vec![
        vec![rotor()],
        vec![wheel([1.0, 2.0, -2.0], 0.0, free())],
        vec![
            wheel([1.0, 2.0, -2.0], 0.3, free()),
            wheel([0.0, 0.0, 3.0], 0.0, speeds()),
        ],
        vec![slug()],
        vec![
            wheel(
                [-1.0, 0.3, 0.0],
                0.1,
                torque(&[0.0, 2.5, 7.0], &[0.3, -0.7, 0.1]),
            ),
            slug(),
            rotor(),
            wheel([0.0, 1.0, 1.0], 0.2, feedback()),
        ],
    ]
}

const TIMES: [f64; 4] = [0.0, 1.7, 6.0, 20.0];

#[test]
fn methods_agree_and_momentum_is_kept() {
    for terms in loads() {
        let series = run(&terms, &TIMES, Method::Taylor, 2.3e-15);
        let exact = run(&terms, &TIMES, Method::Taylor, 1e-26);
        let stepped = run(&terms, &TIMES, Method::Dop853, 1e-13);
        let implicit = run(&terms, &TIMES, Method::Radau, 1e-10);
        let (momentum, _) = kept(&terms, &series.samples[0]);
        for k in 0..TIMES.len() {
            let truth = &exact.samples[k];
            assert_eq!(
                truth.internal_state.len(),
                terms.iter().map(Term::internal_states).sum::<usize>()
            );
            for (run, allowed) in [(&series, 3e-14), (&stepped, 1e-10), (&implicit, 1e-7)] {
                let phase = &run.samples[k];
                let turned = (phase.attitude.coords - truth.attitude.coords).norm();
                let spin = (phase.omega - truth.omega).norm();
                let own = phase
                    .internal_state
                    .iter()
                    .zip(&truth.internal_state)
                    .map(|(a, b)| (a - b).abs());
                let own = own.fold(0.0, f64::max);
                let worst = turned.max(spin).max(own);
                assert!(worst < allowed, "{terms:?} {k}: {worst:e}");
                let (now, _) = kept(&terms, phase);
                let drift = (now - momentum).norm() / momentum.norm();
                assert!(drift < allowed, "{terms:?} {k}: momentum {drift:e}");
            }
            let (now, _) = kept(&terms, truth);
            assert!((now - momentum).norm() / momentum.norm() < 2e-15);
        }
    }
}

#[test]
fn energy_is_kept_without_friction_and_falls_with_a_slug() {
    for (terms, keeps) in [
        (&loads()[0], true),
        (&loads()[1], true),
        (&loads()[3], false),
    ] {
        let run = run(terms, &TIMES, Method::Taylor, 2.3e-15);
        let energies: Vec<f64> = run
            .samples
            .iter()
            .map(|phase| kept(terms, phase).1)
            .collect();
        let drift = (energies[3] - energies[0]) / energies[0];
        if keeps {
            assert!(drift.abs() < 1e-14, "{drift:e}");
        } else {
            assert!(energies.windows(2).all(|pair| pair[1] < pair[0]));
        }
    }
}
