//! The tensor of a body from a log of its motion.

use std::ops::ControlFlow;

use polhode::motion::identification::{Bias, Tumble, fit_tumble, information};
use polhode::nalgebra::{Matrix3, Vector3};

/// `I ω̇ = N − ω × I ω` by Runge and Kutta's rule; a torque in B that is known tells the scale of the tensor.
#[test]
fn a_known_torque_tells_the_scale_of_a_tumble() {
    let inertia = Matrix3::new(2.0, 0.1, -0.2, 0.1, 3.5, 0.3, -0.2, 0.3, 4.5);
    let inverse = inertia.try_inverse().expect("a tensor");
    let torque = Vector3::new(0.5, -0.3, 0.8);
    let rate = |omega: Vector3<f64>| inverse * (torque - omega.cross(&(inertia * omega)));
    let (h, every) = (1e-4, 200);
    let (mut omega, mut rows, mut t) = (Vector3::new(1.0, 2.0, 0.5), Vec::new(), Vec::new());
    for step in 0..=80_000 {
        if step % every == 0 {
            rows.push(omega.into());
            t.push(h * f64::from(step));
        }
        let one = rate(omega);
        let two = rate(omega + one * (0.5 * h));
        let three = rate(omega + two * (0.5 * h));
        let four = rate(omega + three * h);
        omega += (one + (two + three) * 2.0 + four) * (h / 6.0);
    }
    let tumble = Tumble {
        t: &t,
        omega: &rows,
        sigma: Some([1e-3; 3]),
        bias: Bias::Zero,
        momentum: [0.0; 3],
        torque: torque.into(),
        prior: None,
        attitude: None,
        specific_force: None,
        gyro_scale: false,
        student: false,
        starts: 2,
    };
    let found = fit_tumble(&tumble, &mut |_| ControlFlow::Continue(())).expect("a fit");
    let exact = [2.0, 3.5, 4.5, 0.1, -0.2, 0.3];
    for (x, y) in found[0].inertia.iter().zip(exact) {
        assert!((x - y).abs() < 1e-8, "{:?}", found[0].inertia);
    }
    // With another scale the same log has another torque.
    let doubled = Tumble {
        torque: (torque * 2.0).into(),
        ..tumble
    };
    let found = fit_tumble(&doubled, &mut |_| ControlFlow::Continue(())).expect("a fit");
    assert!((found[0].inertia[0] - 4.0).abs() < 1e-8);
}

/// Some 100 radians from row to row are followed, and 1e9 are not.
#[test]
fn a_motion_that_turns_too_far_has_no_information() {
    let information_at = |rate: f64| {
        let t: Vec<f64> = (0..20).map(f64::from).collect();
        let still = vec![[0.0; 3]; t.len()];
        let tumble = Tumble {
            t: &t,
            omega: &still,
            sigma: Some([1e-3; 3]),
            bias: Bias::Zero,
            momentum: [0.0; 3],
            torque: [0.0; 3],
            prior: None,
            attitude: None,
            specific_force: None,
            gyro_scale: false,
            student: false,
            starts: 0,
        };
        let start = (
            [rate, 2.0 * rate, 0.5 * rate],
            [0.2, 0.35, 0.45, 0.0, 0.0, 0.0],
            [0.0; 3],
        );
        information(&tumble, start, &mut |_| ControlFlow::Continue(())).expect("no stop")
    };
    assert!(information_at(40.0).is_some());
    assert!(information_at(5e8).is_none());
}
