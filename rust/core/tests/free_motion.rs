//! What must hold for every free motion: any finite body and state, any scale, any time.

use crate::strategies::{any_body, rotation, vector};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use polhode::RigidBody;
use polhode::motion::free::FreeMotion;
use proptest::prelude::*;

/// Sizes of the parts of a second moment: of one size, of many, equal, nearly equal, and none.
fn spread() -> impl Strategy<Value = [f64; 3]> {
    let gap = prop_oneof![Just(0.0), Just(2.3e-16), -16.0..0.0_f64];
    (
        [-12.0..0.0_f64, -12.0..0.0_f64, -12.0..0.0_f64],
        gap,
        0..6_u8,
    )
        .prop_map(|(s, gap, kind)| {
            let [a, b, c] = s.map(|exponent| 10.0_f64.powf(exponent));
            let near = |x: f64| x * (1.0 + if gap < 0.0 { 10.0_f64.powf(gap) } else { gap });
            match kind {
                0 => [a, near(a), b],
                1 => [a, near(a), near(near(a))],
                2 => [a, b, 0.0],
                3 => [a, 0.0, 0.0],
                _ => [a, b, c],
            }
        })
}

/// Angular velocities along any axis, near any axis, and none; the largest component is one.
fn rates() -> impl Strategy<Value = Vector3<f64>> {
    let sizes = [-300.0..0.0_f64, -20.0..0.0_f64, -1.0..0.0_f64];
    (sizes, vector(1.0), 0..8_u8, 0..3_usize).prop_map(|(sizes, signs, zeros, first)| {
        let rate = |k: usize| {
            let size = 10.0_f64.powf(sizes[(k + first) % 3]);
            if zeros >> k & 1 == 1 {
                0.0
            } else {
                size.copysign(signs[k])
            }
        };
        let rates = Vector3::new(rate(0), rate(1), rate(2));
        let largest = rates.amax();
        if largest > 0.0 {
            rates / largest
        } else {
            rates
        }
    })
}

/// Relative changes of energy and of angular momentum in space, of moments and rates that are near one; nothing where
/// these are too small for their squares to be numbers.
fn drift(moments: &Vector3<f64>, motion: &FreeMotion, pace: f64, t: f64) -> Option<(f64, f64)> {
    let start = motion.initial;
    let end = motion.at(t);
    let momentum = |state: &polhode::motion::simulate::State| {
        state.attitude.to_rotation_matrix() * (state.omega / pace).component_mul(moments)
    };
    let energy = |state: &polhode::motion::simulate::State| {
        let rates = state.omega / pace;
        rates.component_mul(moments).dot(&rates)
    };
    let (before, after) = (momentum(&start), momentum(&end));
    let change = (after - before).norm() / before.norm();
    (energy(&start) > 1e-280).then(|| (energy(&end) / energy(&start) - 1.0, change))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100_000))]

    #[test]
    fn energy_and_momentum_are_kept_at_any_scale_and_time(
        parts in spread(), rates in rates(), size in -150.0..150.0_f64, pace in -150.0..150.0_f64, exponent in -3.0..15.0_f64,
    ) {
        let [a, b, c] = parts;
        let moments = Vector3::new(b + c, a + c, a + b);
        let (size, pace) = (10.0_f64.powf(size), 10.0_f64.powf(pace));
        let scaled: [f64; 3] = (moments * size).into();
        let body = RigidBody::from_principal(1.0, &scaled, &Matrix3::identity(), &Vector3::zeros(), 0.0).expect("a body");
        let moments = moments / moments.max();
        let attitude = UnitQuaternion::from_euler_angles(0.3, -0.8, 2.0);
        let omega = rates * pace;
        let motion = FreeMotion::of(&body, &omega, &attitude).expect("finite");
        let speed = omega.amax();
        let t = if speed > 0.0 { 10.0_f64.powf(exponent) / speed } else { 1.0 };
        let state = motion.at(t);
        prop_assert!(state.omega.iter().all(|x| x.is_finite()));
        prop_assert!((state.attitude.norm() - 1.0).abs() < 1e-15);
        if let Some((energy, momentum)) = drift(&moments, &motion, speed, t) {
            prop_assert!(energy.abs() <= 1e-14, "energy {energy:e} {:?}", motion.mode);
            prop_assert!(momentum <= 1e-14, "momentum {momentum:e} {:?}", motion.mode);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn a_motion_goes_on_from_any_of_its_states(
        body in any_body(), omega in vector(1.0), turn in rotation(), s in -20.0..20.0_f64, t in -20.0..20.0_f64,
    ) {
        let attitude = polhode::motion::attitude::from_axes(&turn);
        let motion = FreeMotion::of(&body, &omega, &attitude).expect("finite");
        let midway = motion.at(s);
        let again = FreeMotion::of(&body, &midway.omega, &midway.attitude).expect("finite");
        let (once, twice) = (motion.at(s + t), again.at(t));
        let [i1, _, i3] = body.principal().moments;
        // The state in between is rounded, and what it rounds is carried on.
        let allowed = 1e-13 * (1.0 + t.abs()) * (i3 / i1);
        prop_assert!((once.omega - twice.omega).norm() <= allowed * omega.norm().max(1e-3));
        prop_assert!(once.attitude.angle_to(&twice.attitude) <= allowed);
    }
}
