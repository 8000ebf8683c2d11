//! Part II: tops, free and heavy.

use crate::watch::go_on;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use polhode::RigidBody;
use polhode::motion::angular_momentum::angular_momentum;
use polhode::motion::euler_angles::Sequence;
use polhode::motion::euler_equations::EulerEquations;
use polhode::motion::free_precession::free_precession;
use polhode::motion::heavy_top::PivotedTop;
use polhode::motion::kinematics::{Frame, transport};
use polhode::motion::loads::Analytic;
use polhode::motion::simulate::{Method, NoEvents, Phase, State, Task, Tolerance, simulate};
use polhode::motion::stability::stability;
use polhode::principal::{SymmetricTop, TOP_RTOL};
use proptest::prelude::*;

use super::{body, close, close_vectors, sets};
use crate::strategies::{any_body, rotation, vector};

/// `I_s`, `I_t` of a symmetric top, from disks to needles, and never quite spherical.
fn symmetric() -> impl Strategy<Value = (f64, f64)> {
    (prop_oneof![0.05..0.9_f64, 1.1..2.0_f64], 0.3..3.0_f64)
        .prop_map(|(ratio, across)| (ratio * across, across))
}

fn top(axial: f64, across: f64, axes: &Matrix3<f64>) -> RigidBody {
    let moments = [across, across, axial];
    body(RigidBody::from_principal(
        1.0,
        &moments,
        axes,
        &Vector3::zeros(),
        0.0,
    ))
}

proptest! {
    #![proptest_config(sets())]

    #[test]
    fn free_top_moves_on_its_cones(
        (axial, across) in symmetric(), axes in rotation(), omega in vector(3.0),
    ) {
        let whole = top(axial, across, &axes);
        let found = free_precession(&SymmetricTop::of(&whole.principal(), TOP_RTOL).expect("symmetric"), &omega)
            .expect("a body");
        let (n, zero) = (found.axis, Vector3::zeros());
        let momentum = angular_momentum(&whole, &omega, &zero, &zero, &zero).total();
        let spin = omega.dot(&n);
        prop_assert!(spin >= 0.0);
        close(found.body_rate, (axial - across) * spin / across, omega.norm());
        close(found.space_rate, momentum.norm() / across, omega.norm());
        for (angle, u, v) in [
            (found.body_cone, n, omega), (found.space_cone, momentum, omega), (found.nutation, n, momentum),
        ] {
            close(u.cross(&v).norm(), angle.sin() * u.norm() * v.norm(), u.norm() * v.norm());
            close(u.dot(&v), angle.cos() * u.norm() * v.norm(), u.norm() * v.norm());
        }
        // In the body ω circles about n with Ω, in space n circles about L with L/I_t.
        let circling = transport(&zero, &omega, &(n * found.body_rate));
        let rate = EulerEquations::about(&whole, &zero).angular_acceleration(&omega, &zero).expect("solid");
        close_vectors(&rate, &circling, omega.norm_squared());
        let precessing = momentum.cross(&n) / across;
        close_vectors(&omega.cross(&n), &precessing, omega.norm());
    }

    #[test]
    fn mln27_both_steps_for_the_free_top(
        (axial, across) in symmetric(), start in [-3.0..3.0_f64, 0.2..1.4, -3.0..3.0], momentum in 0.5..4.0_f64,
        turned in 0.1..40.0_f64,
    ) {
        // With L along Z: ω(t) in the body by the first step; θ = const, φ̇ = L/I_t, ψ̇ = −Ω by the second.
        let [phi, theta, psi] = start;
        let spin = momentum * theta.cos() / axial;
        let (precession, circling) = (momentum / across, (axial - across) * spin / across);
        let at = |t: f64| [phi + precession * t, theta, psi - circling * t];
        let omega = |t: f64| {
            let [_, _, psi] = at(t);
            let transverse = momentum * theta.sin() / across;
            Vector3::new(transverse * psi.sin(), transverse * psi.cos(), spin)
        };
        let zxz: Sequence = "ZXZ".parse().expect("valid");
        let t = turned / omega(0.0).norm();
        let rates = zxz.rates(&at(t), &omega(t), Frame::Body).expect("regular");
        let size = omega(t).norm() / theta.sin();
        close_vectors(&Vector3::from(rates), &Vector3::new(precession, 0.0, -circling), size);
        // The quaternion's road.
        let whole = top(axial, across, &Matrix3::identity());
        let attitude = zxz.to_quaternion(&start).expect("finite");
        let initial = Phase::in_place(&State { attitude, omega: omega(0.0) });
        let tolerance = Tolerance::new(1e-12, 0.0).expect("tolerance");
        let times = [0.0, t];
        let task = Task::free(&whole, initial, &times, Method::Dop853, tolerance);
        let mut load = Analytic::new(&[], task.body_at_point);
        let run = simulate(&task, &mut load, &mut NoEvents::new(), &mut go_on);
        let samples = run.samples;
        let end = at(t);
        prop_assert!((samples[1].omega - omega(t)).norm() < 1e-9 * omega(t).norm());
        let expected: UnitQuaternion<f64> = zxz.to_quaternion(&end).expect("finite");
        prop_assert!(samples[1].attitude.angle_to(&expected) < 1e-9);
        let found = zxz.from_quaternion(&samples[1].attitude).expect("regular");
        prop_assert!((found[1] - theta).abs() < 1e-9);
    }

    #[test]
    fn steady_spins_are_the_eigenvalues_of_the_linearized_equations(whole in any_body(), rate in 0.1..9.0_f64) {
        // About axis k: ẋ_i = a x_j, ẋ_j = b x_i, so that the squared frequency is −a b.
        let moments = whole.principal().moments;
        let squares = stability(&moments, rate);
        for (k, (i, j)) in [(1, 2), (2, 0), (0, 1)].into_iter().enumerate() {
            let a = (moments[j] - moments[k]) * rate / moments[i];
            let b = (moments[k] - moments[i]) * rate / moments[j];
            close(squares[k], -a * b, (a * b).abs() + f64::MIN_POSITIVE);
        }
        prop_assert!(squares[0] >= 0.0 && squares[1] <= 0.0 && squares[2] >= 0.0);
    }

    #[test]
    fn heavy_top_precesses_steadily_and_sleeps(
        (axial, across) in symmetric(), axes in rotation(), l in 0.1..2.0_f64, theta in 0.1..3.0_f64,
        factor in 1.0..20.0_f64, sense in prop_oneof![Just(1.0_f64), Just(-1.0)],
    ) {
        let g = 9.81;
        let gravity = Vector3::new(0.0, 0.0, -g);
        let free = top(axial, across, &axes);
        let whole = body(free.translated(&(axes.column(2) * l)));
        let found = PivotedTop::of(&whole, TOP_RTOL).expect("a top");
        let about_pivot = across + l * l;
        close_vectors(&found.axis, &axes.column(2).into_owned(), 1.0);
        close(found.axial, axial, axial);
        close(found.transverse, about_pivot, about_pivot);
        close(found.mass_moment, l, l);
        let sleeping = found.least_spin(0.0, &gravity);
        close((axial * sleeping).powi(2), 4.0 * about_pivot * g * l, 4.0 * about_pivot * g * l);
        let spin = sense * (factor * found.least_spin(theta, &gravity).max(1.0));
        let rates = found.steady_precession(spin, theta, &gravity).expect("fast enough");
        // In a frame that precesses with the top, L stands still: the torque of the weight is φ̇ Z×L, about the line of
        // nodes (x), with the axis n = (0, −sin θ, cos θ).
        let n = Vector3::new(0.0, -theta.sin(), theta.cos());
        for rate in rates {
            let precession = Vector3::z() * rate;
            let across_axis = precession - n * precession.dot(&n);
            let momentum = n * (axial * spin) + across_axis * about_pivot;
            let torque = transport(&Vector3::zeros(), &momentum, &precession);
            let weight = (n * l).cross(&gravity);
            let size = momentum.norm() * rate.abs() + weight.norm();
            close_vectors(&torque, &weight, size);
        }
    }
}
