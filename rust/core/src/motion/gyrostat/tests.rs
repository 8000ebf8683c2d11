use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::{GyrostatMotion, InternalMomentum, Mode};
use crate::mass::refined::RefinedPrincipal;
use crate::motion::free::FreeMotion;
use crate::numerics::double_double::DoubleDouble;

fn motion(moments: [f64; 3], rotor: [f64; 3], omega: [f64; 3]) -> GyrostatMotion {
    let principal = RefinedPrincipal::from_principal(&moments, &Matrix3::identity());
    let attitude = UnitQuaternion::from_euler_angles(0.3, -1.0, 2.0);
    let rotor = rotor.map(DoubleDouble::from);
    GyrostatMotion::of(&principal, &rotor, &Vector3::from(omega), &attitude).expect("a motion")
}

/// Moments, h, ω at the start and the mode.
type Case = ([f64; 3], [f64; 3], [f64; 3], Mode);

const CASES: [Case; 12] = [
    (
        [1.0, 2.0, 2.5],
        [0.1, 0.2, 0.3],
        [1.0, 0.2, 0.3],
        Mode::Single,
    ),
    (
        [1.0, 2.0, 2.5],
        [0.01, 0.02, 0.03],
        [0.02, 1.0, 0.03],
        Mode::Paired,
    ),
    (
        [1.0, 2.0, 2.5],
        [0.01, 0.02, 0.03],
        [1.0, 0.2, 0.3],
        Mode::Paired,
    ),
    (
        [1.0, 2.0, 2.5],
        [0.0, 0.3, 0.0],
        [1e-20, 1.0, 0.0],
        Mode::Single,
    ),
    (
        [1.0, 2.0, 2.5],
        [0.0, 8.0, 0.0],
        [0.1, 0.2, 0.3],
        Mode::Single,
    ),
    (
        [1.0, 2.0, 2.0],
        [0.3, 0.0, 0.0],
        [1.0, 0.2, 0.3],
        Mode::Circular,
    ),
    (
        [1.0, 1.0, 1.5],
        [0.3, 0.1, 0.0],
        [1.0, 0.2, 0.3],
        Mode::Paired,
    ),
    (
        [1.2, 1.2, 1.2],
        [0.3, 0.1, 0.2],
        [1.0, 0.2, 0.3],
        Mode::Circular,
    ),
    (
        [1.0, 2.0, 2.5],
        [0.0, 0.3, 0.0],
        [0.0, 1.0, 0.0],
        Mode::Steady,
    ),
    (
        [2.0, 3.0, 4.0],
        [4.0, 1.0, 4.0],
        [-6.0, -3.0, 3.0],
        Mode::Separatrix,
    ),
    (
        [2.0, 3.0, 4.0],
        [1.0, 0.0, 2.0],
        [-2.5, 0.0, 0.5],
        Mode::Separatrix,
    ),
    (
        [1.0, 2.0, 2.5],
        [1e-300, 0.0, 1e-300],
        [0.3, 0.2, 1.1],
        Mode::Paired,
    ),
];

#[test]
fn modes_and_starts_and_what_is_kept() {
    for (moments, h, omega, mode) in CASES {
        let motion = motion(moments, h, omega);
        assert_eq!(motion.mode, mode, "{moments:?} {h:?} {omega:?}");
        let start = motion.at(0.0);
        let rest = (start.omega - motion.initial.omega).norm();
        assert!(rest < 2e-14, "{moments:?} {h:?} {omega:?} {rest:e}");
        assert!(start.attitude.angle_to(&motion.initial.attitude) < 2e-14);
        let (tensor, h) = (Matrix3::from_diagonal(&moments.into()), Vector3::from(h));
        for t in [0.7, 13.0, -200.0, 1e5, 1e12] {
            let state = motion.at(t);
            let momentum = state.attitude * (tensor * state.omega + h);
            let kept = motion.angular_momentum;
            assert!((momentum - kept).norm() < 2e-14 * kept.norm().max(h.norm()));
            let energy = 0.5 * state.omega.dot(&(tensor * state.omega));
            assert!((energy - motion.kinetic_energy).abs() < 1e-13 * (energy + h.norm()));
        }
    }
}

#[test]
fn the_equations_of_motion_hold() {
    let step = 1e-4;
    for (moments, h, omega, _) in CASES {
        let motion = motion(moments, h, omega);
        let (tensor, h) = (Matrix3::from_diagonal(&moments.into()), Vector3::from(h));
        for t in [0.3, 4.0, 31.0] {
            let [before, now, after] = [t - step, t, t + step].map(|t| motion.at(t));
            let rate = (after.omega - before.omega) / (2.0 * step);
            let torque = tensor * rate + now.omega.cross(&(tensor * now.omega + h));
            let size = omega.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
            assert!(
                torque.norm() < 1e-5 * size.powi(3),
                "{moments:?} {h:?} {torque}"
            );
            let turned = (before.attitude.inverse() * after.attitude).scaled_axis() / (2.0 * step);
            let rest = (turned - now.omega).norm();
            assert!(rest < 1e-5 * size.powi(3), "{moments:?} {h:?} {rest:e}");
        }
    }
}

#[test]
fn many_states_have_the_bits_of_one() {
    let times: Vec<f64> = (0..50).map(|k| f64::from(k) * 7.3 - 100.0).collect();
    for (moments, h, omega, _) in CASES {
        let motion = motion(moments, h, omega);
        let mut attitudes = vec![[0.0; 4]; times.len()];
        let mut omegas = vec![[0.0; 3]; times.len()];
        motion.sample(&times, &mut attitudes, &mut omegas);
        for ((&t, attitude), omega) in times.iter().zip(attitudes).zip(omegas) {
            let state = motion.at(t);
            assert_eq!(<[f64; 3]>::from(state.omega), omega);
            assert_eq!(state.attitude.i, attitude[0]);
        }
    }
}

#[test]
fn without_momentum_it_is_free_motion() {
    let principal = RefinedPrincipal::from_principal(&[1.0, 2.0, 2.5], &Matrix3::identity());
    let (omega, attitude) = (Vector3::new(0.3, 0.2, 1.1), UnitQuaternion::identity());
    let rotor = InternalMomentum::default().rotor(&omega);
    let motion = GyrostatMotion::of(&principal, &rotor, &omega, &attitude).expect("a motion");
    let free = FreeMotion::from_refined(&principal, &omega, &attitude).expect("a motion");
    assert_eq!(motion.at(1e6), free.at(1e6));
    assert_eq!(motion.as_free(), Some(&free));
}

#[test]
fn periods_bring_omega_back() {
    for (moments, h, omega, mode) in CASES {
        let motion = motion(moments, h, omega);
        if matches!(mode, Mode::Steady | Mode::Separatrix) {
            assert_eq!(motion.period.high.is_nan(), mode == Mode::Steady);
            assert_eq!(motion.period.high.is_infinite(), mode == Mode::Separatrix);
            continue;
        }
        let rest = motion.at(motion.period.high).omega - motion.initial.omega;
        assert!(rest.norm() < 1e-13, "{moments:?} {h:?} {rest}");
    }
}
