use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use super::invariants::Invariants;
use super::{FreeMotion, Mode};
use crate::mass::RigidBody;
use crate::motion::attitude::components;
use crate::motion::closed_form::ClosedForm;
use crate::motion::euler_equations::EulerEquations;

fn body(moments: [f64; 3], axes: &Matrix3<f64>) -> RigidBody {
    RigidBody::from_principal(1.0, &moments, axes, &Vector3::zeros(), 0.0).expect("a body")
}

fn turned_axes() -> (Matrix3<f64>, UnitQuaternion<f64>) {
    let axes = *nalgebra::Rotation3::from_euler_angles(0.3, -1.0, 2.0).matrix();
    (axes, UnitQuaternion::from_euler_angles(-0.4, 0.8, 1.9))
}

/// Bodies and starts of every mode, near each other and far apart.
fn cases() -> Vec<(Mode, [f64; 3], [f64; 3])> {
    vec![
        (Mode::Spherical, [2.0, 2.0, 2.0], [0.3, -0.4, 1.0]),
        (Mode::Symmetric, [1.0, 1.0, 1.6], [0.5, 0.3, -2.0]),
        (Mode::Symmetric, [0.4, 1.5, 1.5], [-0.5, 0.3, 1.0]),
        (Mode::Symmetric, [0.0, 1.5, 1.5], [-0.5, 0.3, 1.0]),
        (Mode::Steady, [1.0, 2.0, 2.5], [0.0, 1.3, 0.0]),
        (Mode::Separatrix, [1.5, 3.0, 4.0], [4.0, 1.0, 3.0]),
        (Mode::Separatrix, [1.5, 3.0, 4.0], [-0.5, 1.0, 0.375]),
        (Mode::ShortAxis, [1.0, 2.0, 2.5], [0.3, 0.2, 1.1]),
        (Mode::ShortAxis, [1.0, 2.0, 2.5], [-0.3, 0.2, -1.1]),
        (Mode::ShortAxis, [1.0, 2.0, 2.5], [1e-5, 1.0, -1e-3]),
        (Mode::ShortAxis, [1.0, 2.0, 2.5], [1e-200, 1.0, 1e-199]),
        (Mode::ShortAxis, [1.0, 1.0 + 1e-13, 2.0], [0.3, 0.4, 1.0]),
        (Mode::ShortAxis, [1.0, 2.0, 3.0], [0.2, 0.4, 1.0]),
        (Mode::ShortAxis, [1.0, 2.0, 2.5], [-1e-9, 1e-9, 1.0]),
        (Mode::LongAxis, [1.0, 2.0, 2.5], [1.1, 0.2, 0.3]),
        (Mode::LongAxis, [1.0, 2.0, 2.5], [-1.1, -0.2, 0.3]),
        (Mode::LongAxis, [1.0, 2.0, 2.5], [-1e-3, 1.0, -1e-5]),
        (Mode::LongAxis, [1e-3, 1.0, 1.0005], [1.0, 0.5, -0.3]),
        (Mode::LongAxis, [1.0, 2.0, 2.0 + 1e-13], [1.0, 0.5, -0.3]),
        (Mode::LongAxis, [1.0, 2.0, 2.5], [1.0, 1e-150, -1e-150]),
    ]
}

#[test]
fn the_state_at_zero_is_the_start() {
    let (axes, attitude) = turned_axes();
    for (mode, moments, omega) in cases() {
        let omega = axes * Vector3::from(omega);
        let motion = FreeMotion::of(&body(moments, &axes), &omega, &attitude).expect("finite");
        let start = motion.at(0.0);
        if motion.mode == mode {
            let error = (start.omega - omega).norm() / omega.norm();
            assert!(error < 2e-15, "{mode} {moments:?} {error:e}");
            assert!(start.attitude.angle_to(&attitude) < 2e-15, "{mode}");
        } else {
            // Turned by rounding, what was steady or on the separatrix is only near it.
            assert!(
                matches!(mode, Mode::Steady | Mode::Separatrix),
                "{mode} {moments:?} {}",
                motion.mode
            );
        }
    }
}

#[test]
fn modes() {
    for (mode, moments, omega) in cases() {
        let body = body(moments, &Matrix3::identity());
        let motion = FreeMotion::of(&body, &omega.into(), &UnitQuaternion::identity());
        assert_eq!(motion.expect("finite").mode, mode, "{moments:?} {omega:?}");
    }
}

#[test]
fn the_equations_of_motion_hold_at_all_times() {
    let (_, attitude) = turned_axes();
    let axes = Matrix3::identity();
    for (mode, moments, omega) in cases() {
        let body = body(moments, &axes);
        let motion = FreeMotion::of(&body, &omega.into(), &attitude).expect("finite");
        let equations = EulerEquations::about(&body, &Vector3::zeros());
        let h = 1e-4;
        let period = motion.secular.half_period.high;
        let step = if period < 1e6 { 0.037 * period } else { 0.37 };
        for k in -60..60 {
            let t = step * f64::from(k);
            let [before, now, after] = [t - h, t, t + h].map(|t| motion.at(t));
            let rate = (after.omega - before.omega) / (2.0 * h);
            let acceleration = equations
                .angular_acceleration(&now.omega, &Vector3::zeros())
                .expect("no torque");
            let size = now.omega.norm();
            let error = (rate - acceleration).norm() / size;
            assert!(
                error < 1e-6,
                "{mode} {moments:?} {omega:?} at {t}: {error:e}"
            );
            let change: Quaternion<f64> =
                (after.attitude.into_inner() - before.attitude.into_inner()) / (2.0 * h);
            let exact = now.attitude.into_inner() * Quaternion::from_imag(now.omega * 0.5);
            let error = (change - exact).norm();
            assert!(
                error < 1e-6,
                "{mode} {moments:?} {omega:?} at {t}: {error:e}"
            );
        }
    }
}

#[test]
fn many_times_have_the_bits_of_one() {
    let (axes, attitude) = turned_axes();
    for (_, moments, omega) in cases() {
        let motion =
            FreeMotion::of(&body(moments, &axes), &omega.into(), &attitude).expect("finite");
        let mut times: Vec<f64> = (0..77).map(|k| 3.1_f64.powi(k - 20)).collect();
        times.extend([0.0, -1.5, f64::NAN, f64::INFINITY]);
        let mut attitudes = vec![[0.0; 4]; times.len()];
        let mut omegas = vec![[0.0; 3]; times.len()];
        motion.sample(&times, &mut attitudes, &mut omegas);
        for ((t, attitude), omega) in times.iter().zip(&attitudes).zip(&omegas) {
            let state = motion.at(*t);
            // Beyond 2⁸⁸ turns there is no phase.
            let is_known = !components(&state.attitude)[0].is_nan();
            if is_known {
                assert_eq!(components(&state.attitude), *attitude, "{t}");
                assert_eq!(state.omega, Vector3::from(*omega));
                assert!((Quaternion::from(*attitude).norm() - 1.0).abs() < 1e-15);
            } else {
                assert!(attitude.iter().all(|x| x.is_nan()), "{t} {attitude:?}");
            }
            assert!(is_known || !t.is_finite() || *t > 1e25, "{t}");
            assert!(!is_known || t.is_finite(), "{t}");
        }
    }
}

/// A phase is known up to the reach, this time included, and beyond it to nobody.
#[test]
fn the_reach_is_the_last_time_with_a_state() {
    for (mode, moments, omega) in cases() {
        let body = body(moments, &Matrix3::identity());
        let attitude = UnitQuaternion::identity();
        let motion = FreeMotion::of(&body, &omega.into(), &attitude).expect("finite");
        let reach = motion.reach();
        for (t, is_known) in [(reach, true), (reach.next_up(), false)] {
            for t in [t, -t] {
                let state = motion.at(t);
                let numbers = state.omega.iter().chain(state.attitude.coords.iter());
                assert!(
                    numbers.clone().all(|x| x.is_nan() != is_known),
                    "{mode} {t:e}"
                );
                // Near the separatrix errors grow without bound long before.
                let is_bounded = motion.error_bar(0.9 * t, 1e-16).omega.is_finite();
                assert_eq!(
                    motion.error_bar(t, 1e-16).omega.is_finite(),
                    is_known && is_bounded,
                    "{mode} {t:e}"
                );
            }
        }
    }
}

/// However small it is beside the others, a component keeps its digits.
#[test]
fn a_tiny_component_of_the_start_keeps_its_digits() {
    let body = body([1.0, 2.0, 2.5], &Matrix3::identity());
    for omega in [[0.3, 1e-30, 1.0], [0.3, -1e-200, 1.0], [1.0, 1e-30, 0.1]] {
        let motion = FreeMotion::of(&body, &omega.into(), &UnitQuaternion::identity());
        let start = motion.expect("finite").at(0.0);
        for (found, given) in start.omega.iter().zip(omega) {
            assert!(
                (found / given - 1.0).abs() < 4e-15,
                "{omega:?} {}",
                start.omega
            );
        }
    }
}

/// One by one, with the energy of the start.
#[test]
fn the_points_of_a_polhode_go_around_it_once() {
    let moments = [1.0, 2.0, 2.5];
    let body = body(moments, &Matrix3::identity());
    for omega in [[0.3, 0.2, 1.1], [-0.3, 0.2, -1.1], [1.1, 0.2, 0.3]] {
        let motion = FreeMotion::of(&body, &omega.into(), &UnitQuaternion::identity());
        let points = motion.expect("finite").polhode(11);
        let apart = |k: usize| (points[k] - points[0]).norm();
        assert!(
            apart(10) < 1e-15 && (1..10).all(|k| apart(k) > 0.1),
            "{omega:?}"
        );
        let energy = |w: &Vector3<f64>| w.dot(&w.component_mul(&Vector3::from(moments)));
        let drift = |w: &Vector3<f64>| (energy(w) / energy(&points[0]) - 1.0).abs();
        assert!(points.iter().all(|point| drift(point) < 4e-15), "{omega:?}");
    }
}

#[test]
fn the_angular_momentum_in_any_unit_of_time() {
    let body = body([1.0, 2.0, 2.5], &Matrix3::identity());
    for unit in [1e-30, 1e-3, 1.0, 7e5, 1e40] {
        let omega = Vector3::new(0.3, 0.2, 1.1) * unit;
        let motion = FreeMotion::of(&body, &omega, &UnitQuaternion::identity()).expect("finite");
        let found = Invariants::of_motion(&motion).angular_momentum();
        let exact = Vector3::new(0.3_f64, 0.4, 2.75).norm() * unit;
        assert!((found / exact - 1.0).abs() < 1e-15, "{unit:e}");
    }
}
