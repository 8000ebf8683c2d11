use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::Splitting;
use crate::mass::RigidBody;
use crate::motion::euler_equations::EulerEquations;
use crate::motion::loads::{Analytic, BodyAtPoint, Term};
use crate::motion::state::{Phase, State};

fn top(moments: [f64; 3]) -> RigidBody {
    let center = Vector3::new(0.0, 0.0, 0.6);
    RigidBody::from_principal(1.3, &moments, &Matrix3::identity(), &center, 0.0).expect("body")
}

fn energy(body: &RigidBody, phase: &Phase) -> f64 {
    let tensor = body.inertia_about(&Vector3::zeros());
    let height = (phase.attitude * body.center_of_mass()).z;
    0.5 * phase.omega.dot(&(tensor * phase.omega)) + body.mass() * 9.81 * height
}

#[test]
fn energy_and_vertical_momentum_of_a_heavy_body_do_not_drift() {
    for moments in [[0.9, 0.9, 0.5], [0.7, 0.9, 0.5]] {
        let body = top(moments);
        let euler = EulerEquations::about(&body, &Vector3::zeros());
        let phase = Phase::in_place(&State {
            attitude: UnitQuaternion::from_euler_angles(0.8, 0.2, 0.1),
            omega: Vector3::new(0.3, 0.1, 12.0),
        });
        let gravity = [Term::uniform_gravity(&Vector3::new(0.0, 0.0, -9.81)).expect("finite")];
        let mut load = Analytic::new(&gravity, BodyAtPoint::pivoted(&body, 0.0));
        let times = [0.0, 200.0];
        let mut run =
            Splitting::new(&euler, None, times, &phase, &mut load, 1e-8, None).expect("smooth");
        let vertical = |phase: &Phase| {
            let tensor = body.inertia_about(&Vector3::zeros());
            (phase.attitude * (tensor * phase.omega)).z
        };
        let (e, l) = (energy(&body, &phase), vertical(&phase));
        let (mut first, mut second): (f64, f64) = (0.0, 0.0);
        while run.elapsed() < 200.0 {
            run.advance(&mut load).expect("smooth");
            let change = (energy(&body, &run.phase()) / e - 1.0).abs();
            if run.elapsed() <= 100.0 {
                first = first.max(change);
            } else {
                second = second.max(change);
            }
            assert!((vertical(&run.phase()) / l - 1.0).abs() < 1e-13);
        }
        assert!(second <= 1.5 * first + 1e-13, "{first:e} {second:e}");
        assert!(first < 1e-6, "{first:e}");
    }
}

#[test]
fn between_steps_and_backward() {
    let body = top([0.7, 0.9, 0.5]);
    let euler = EulerEquations::about(&body, &Vector3::zeros());
    let phase = Phase::in_place(&State {
        attitude: UnitQuaternion::from_euler_angles(0.8, 0.2, 0.1),
        omega: Vector3::new(0.3, 0.1, 3.0),
    });
    let gravity = [Term::uniform_gravity(&Vector3::new(0.0, 0.0, -9.81)).expect("finite")];
    let mut load = Analytic::new(&gravity, BodyAtPoint::pivoted(&body, 0.0));
    let mut go = |times: [f64; 2], phase: &Phase| {
        let mut run =
            Splitting::new(&euler, None, times, phase, &mut load, 1e-12, None).expect("smooth");
        let mut between = phase.clone();
        while run.elapsed() != times[1] - times[0] {
            let from = run.elapsed();
            run.advance(&mut load).expect("smooth");
            let middle = 0.5 * (times[1] - times[0]);
            if (from - middle) * (run.elapsed() - middle) <= 0.0 {
                between = run.within(middle, &mut load).expect("smooth");
            }
        }
        (between, run.phase())
    };
    let (middle, end) = go([1.0, 3.0], &phase);
    let (_, again) = go([2.0, 3.0], &middle);
    let (_, back) = go([3.0, 1.0], &end);
    assert!(end.attitude.angle_to(&again.attitude) < 1e-10);
    assert!(back.attitude.angle_to(&phase.attitude) < 1e-10);
    assert!((back.omega - phase.omega).norm() < 1e-9);
}
