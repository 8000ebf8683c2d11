//! Against closed forms without elliptic functions.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::{HeavyTop, Mode, PivotedTop};
use crate::mass::RigidBody;

fn top(across: f64, along: f64, length: f64) -> PivotedTop {
    let center = Vector3::new(0.0, 0.0, length);
    let moments = [across, across, along];
    RigidBody::from_principal(1.0, &moments, &Matrix3::identity(), &center, 0.0)
        .and_then(|body| PivotedTop::of(&body, 1e-6))
        .expect("top")
}

fn lean(theta: f64) -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(&Vector3::x_axis(), theta)
}

#[test]
fn steady_precession_turns_steadily() {
    let (top, g) = (top(0.3, 0.5, 0.7), Vector3::new(0.0, 0.0, -9.81));
    for theta in [0.3_f64, 1.3, 2.7] {
        let [slow, fast] = top.steady_precession(30.0, theta, &g).expect("fast");
        for rate in [slow, fast] {
            let (spin, up) = (30.0 - rate * theta.cos(), Vector3::z());
            let omega = lean(theta).inverse_transform_vector(&(rate * up)) + spin * up;
            let motion = HeavyTop::of(&top, &omega, &lean(theta), &g).expect("motion");
            assert!((motion.nutation().precession - rate).abs() < 1e-9 * rate.abs());
            for t in [0.0, 0.1, -3.0, 20.0] {
                let exact = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), rate * t)
                    * lean(theta)
                    * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), spin * t);
                let error = motion.at(t).attitude.angle_to(&exact);
                assert!(error < 1e-12, "{theta} {rate} {t} {error:e}");
            }
        }
    }
}

#[test]
fn separatrix_of_the_pendulum() {
    // From the lowest point with just the energy of the highest: sin of half the swing is tanh √(g/l) t.
    let (bob, g) = (top(0.0, 0.0, 1.0), Vector3::new(0.0, 0.0, -1.0));
    let hanging = lean(std::f64::consts::PI);
    let hanging =
        UnitQuaternion::new_normalize(nalgebra::Quaternion::new(0.0, hanging.i, 0.0, 0.0));
    let motion = HeavyTop::of(&bob, &Vector3::new(2.0, 0.0, 0.0), &hanging, &g).expect("motion");
    assert_eq!(motion.nutation().mode, Mode::Asymptotic);
    for t in [0.0_f64, 0.3, -1.1, 5.0, 40.0, 1e9] {
        let state = motion.at(t);
        let height = (state.attitude * Vector3::z()).z;
        let swing = t.tanh();
        assert!((height - (2.0 * swing * swing - 1.0)).abs() < 1e-15, "{t}");
        assert!((state.omega.x - 2.0 / t.cosh()).abs() < 2e-15, "{t}");
    }
}

#[test]
fn without_weight_it_precesses_about_its_momentum() {
    let top = top(0.8, 0.5, 0.0);
    let (omega, start) = (Vector3::new(0.3, -0.4, 1.7), lean(0.9));
    let motion = HeavyTop::of(&top, &omega, &start, &Vector3::zeros()).expect("motion");
    let momentum = start * Vector3::new(0.8 * omega.x, 0.8 * omega.y, 0.5 * omega.z);
    let drift = (1.0 - 0.5 / 0.8) * omega.z;
    for t in [0.0, 1.0, -7.0, 30.0] {
        let exact = UnitQuaternion::from_scaled_axis(momentum * (t / 0.8))
            * start
            * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), drift * t);
        assert!(motion.at(t).attitude.angle_to(&exact) < 1e-13, "{t}");
        let back = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -drift * t);
        assert!((motion.at(t).omega - back * omega).norm() < 1e-14, "{t}");
    }
}

#[test]
fn what_rests_stays() {
    let (top, g) = (top(0.3, 0.5, 0.7), Vector3::new(0.0, 0.0, -9.81));
    for upright in [
        UnitQuaternion::identity(),
        UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(0.0, 1.0, 0.0, 0.0)),
    ] {
        let spin = Vector3::new(0.0, 0.0, 3.0);
        let motion = HeavyTop::of(&top, &spin, &upright, &g).expect("motion");
        assert_eq!(motion.nutation().mode, Mode::Steady);
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 30.0);
        assert!(motion.at(10.0).attitude.angle_to(&(upright * turn)) < 1e-15 * 30.0);
        assert_eq!(motion.at(10.0).omega, spin);
    }
    let resting = HeavyTop::of(&top, &Vector3::zeros(), &lean(0.4), &Vector3::zeros());
    let state = resting.expect("motion").at(1e300);
    assert!(state.attitude.angle_to(&lean(0.4)) < 1e-15 && state.omega == Vector3::zeros());
}

#[test]
fn what_is_not_finite_is_refused() {
    let top = top(0.3, 0.5, 0.7);
    let (nan, q) = (Vector3::repeat(f64::NAN), UnitQuaternion::identity());
    assert!(HeavyTop::of(&top, &nan, &q, &Vector3::z()).is_err());
    assert!(HeavyTop::of(&top, &Vector3::z(), &q, &nan).is_err());
}

#[test]
fn a_top_upright_along_any_axis_of_body_and_space_stays_so() {
    let axes = [
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, -4.0, 8.0],
    ]
    .map(Vector3::from);
    let turns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vector3::from);
    for axis in axes.into_iter().flat_map(|axis| [axis, -axis]) {
        // A ball is a top about any axis, here with its own to all digits.
        let body =
            RigidBody::from_principal(4.0, &[8.0; 3], &Matrix3::identity(), &(axis * 2.5e-5), 0.0);
        let top = PivotedTop::of(&body.expect("body"), 1e-6).expect("top");
        for turn in turns {
            let attitude = UnitQuaternion::new_unchecked(nalgebra::Quaternion::from_imag(turn));
            // Half a turn takes the axis to an exact multiple of this.
            let up = turn * (2.0 * turn.dot(&axis)) - axis * turn.dot(&turn);
            for (spin, weight) in [
                (0.0, 7.0),
                (3.0, 7.0),
                (0.001, -7.0),
                (0.0, 0.0),
                (0.1, 1e-30),
            ] {
                let motion =
                    HeavyTop::of(&top, &(axis * spin), &attitude, &(up * -weight)).expect("motion");
                let state = motion.at(3.0);
                assert!(
                    (state.omega - axis * spin).amax() <= 4e-15 * spin,
                    "{axis:?} {turn:?} {spin} {weight}: {state:?}"
                );
                let turned = UnitQuaternion::from_scaled_axis(up * (spin * 3.0)) * attitude;
                assert!(
                    state.attitude.angle_to(&turned) < 1e-14,
                    "{axis:?} {turn:?} {spin} {weight}: {state:?}"
                );
            }
        }
    }
}

#[test]
fn however_little_a_top_leans_it_moves() {
    let top = top(8.0, 8.0, 2.5e-5);
    for power in [-8, -50, -100, -200, -300, -400, -510, -600, -1000] {
        let lean = 2.0_f64.powi(power);
        let attitude =
            UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(1.0, lean, 0.0, 0.0));
        for spin in [0.0, 0.001, 3.0] {
            for rate in [0.0, lean] {
                for weight in [7.0, -7.0] {
                    let omega = Vector3::new(rate, 0.0, spin);
                    let motion =
                        HeavyTop::of(&top, &omega, &attitude, &Vector3::new(0.0, 0.0, -weight))
                            .expect("motion");
                    for t in [-4.0, 0.0, 5.0] {
                        let state = motion.at(t);
                        let finite = state
                            .omega
                            .iter()
                            .chain(state.attitude.coords.iter())
                            .all(|x| x.is_finite());
                        assert!(
                            finite,
                            "2^{power} {spin} {rate} {weight} {t}: {:?} {state:?}",
                            motion.nutation()
                        );
                    }
                }
            }
        }
    }
}
