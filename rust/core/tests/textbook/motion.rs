//! Kinematics, energy, angular momentum, Euler's angles and equations.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use polhode::RigidBody;
use polhode::mass::{Amount, solids};
use polhode::motion::angular_momentum::angular_momentum;
use polhode::motion::euler_angles::Sequence;
use polhode::motion::euler_equations::EulerEquations;
use polhode::motion::kinematics::{Frame, point_acceleration, point_velocity, transport};
use polhode::motion::kinetic_energy::kinetic_energy;
use polhode::motion::pivot_reaction::pivot_reaction;
use proptest::collection::vec;
use proptest::prelude::*;

use super::{body, close, close_vectors, sets};
use crate::strategies::{any_body, rotation, vector};

fn zxz() -> Sequence {
    "ZXZ".parse().expect("valid")
}

/// φ, θ, ψ away from the poles.
fn angles() -> impl Strategy<Value = [f64; 3]> {
    (-3.0..3.0_f64, 0.2..2.9_f64, -3.0..3.0_f64).prop_map(Into::into)
}

/// The size that errors of a torque or of an angular momentum's rate are relative to.
fn torque_size(
    whole: &RigidBody,
    about: &Vector3<f64>,
    omega: &Vector3<f64>,
    rate: &Vector3<f64>,
) -> f64 {
    whole.inertia_about(about).trace() * (omega.norm_squared() + rate.norm())
}

proptest! {
    #![proptest_config(sets())]

    #[test]
    fn mln24_force_moves_the_centre_and_torque_turns(
        swarm in vec((0.1..3.0_f64, vector(2.0)), 1..9), omega in vector(3.0), rate in vector(3.0), a in vector(3.0),
        attitude in rotation(), about in vector(1.0), gravity in vector(9.0), push in vector(5.0),
    ) {
        // Newton's second law for each particle of a body of which P is accelerated with a: ṗ = F, L̇ = N.
        let (masses, places): (Vec<f64>, Vec<[f64; 3]>) = swarm.iter().map(|&(m, r)| (m, <[f64; 3]>::from(r))).unzip();
        let whole = body(polhode::mass::particles::particles(&masses, &places));
        let (m, c) = (whole.mass(), whole.center_of_mass());
        let of = |r: &Vector3<f64>| point_acceleration(&(r - about), &omega, &rate, &a);
        let (mut force, mut torque) = (Vector3::zeros(), Vector3::zeros());
        for (m, r) in &swarm {
            force += of(r) * *m;
            torque += (r - c).cross(&(of(r) * *m));
        }
        let size = m * (a.norm() + 20.0 * (omega.norm_squared() + rate.norm()));
        close_vectors(&(of(&c) * m), &force, size);
        let equations = EulerEquations::about(&whole, &c);
        close_vectors(&equations.torque(&omega, &rate), &torque, 10.0 * size);
        // P fixed: what gravity and the push do not supply is the pivot's.
        let at_rest = Vector3::zeros();
        let attitude = UnitQuaternion::from_matrix(&attitude);
        let held: Vector3<f64> = (swarm.iter())
            .map(|(m, r)| attitude * point_acceleration(&(r - about), &omega, &rate, &at_rest) * *m - gravity * *m)
            .sum();
        let reaction = pivot_reaction(&whole, &attitude, &omega, &rate, &gravity, &push, &about);
        close_vectors(&reaction, &(held - push), size + m * gravity.norm() + push.norm());
    }

    #[test]
    fn mln24_velocities_of_two_points_differ_by_a_rotation(
        r in vector(3.0), s in vector(3.0), omega in vector(2.0), rate in vector(2.0), v in vector(2.0), a in vector(2.0),
    ) {
        // From P to r at once, and by way of s; the distance of r and s stays.
        let at_s = point_velocity(&s, &omega, &v);
        let size = v.norm() + omega.norm() * (r.norm() + s.norm()) + 1e-9;
        close_vectors(&point_velocity(&(r - s), &omega, &at_s), &point_velocity(&r, &omega, &v), size);
        let stretching = (point_velocity(&r, &omega, &v) - at_s).dot(&(r - s));
        close(stretching, 0.0, size * 10.0);
        let a_s = point_acceleration(&s, &omega, &rate, &a);
        let through = point_acceleration(&(r - s), &omega, &rate, &a_s);
        let directly = point_acceleration(&r, &omega, &rate, &a);
        close_vectors(&through, &directly, a.norm() + (rate.norm() + omega.norm_squared()) * 12.0);
    }

    #[test]
    fn mln25_mixed_part_vanishes_for_the_centre_of_mass(
        whole in any_body(), omega in vector(3.0), v in vector(3.0), p in vector(3.0),
    ) {
        let c = whole.center_of_mass();
        let about_c = kinetic_energy(&whole, &omega, &v, &c);
        prop_assert_eq!(about_c.mixed, 0.0);
        let v_p = point_velocity(&(p - c), &omega, &v);
        let about_p = kinetic_energy(&whole, &omega, &v_p, &p);
        let size = about_p.translational + about_p.mixed.abs() + about_p.rotational;
        close(about_p.mixed, whole.mass() * v_p.dot(&omega.cross(&(c - p))), size);
        close(about_p.total(), about_c.total(), size);
    }

    #[test]
    fn mex173_rolling_cylinder_from_three_points(m in 0.1..9.0_f64, radius in 0.1..4.0_f64, v in 0.1..9.0_f64) {
        // Along x on the ground y = −R: the axis, the top of the rim, the line of contact.
        let cylinder = body(solids::cylinder(radius, 1.0, Amount::Mass(m)));
        let (omega, of_axis) = (Vector3::new(0.0, 0.0, -v / radius), Vector3::new(v, 0.0, 0.0));
        let unit = m * v * v;
        for (y, speed, expected) in [
            (0.0, v, [0.5, 0.0, 0.25]),
            (radius, 2.0 * v, [2.0, -2.0, 0.75]),
            (-radius, 0.0, [0.0, 0.0, 0.75]),
        ] {
            let p = Vector3::new(0.0, y, 0.0);
            let of_p = point_velocity(&p, &omega, &of_axis);
            close_vectors(&of_p, &Vector3::new(speed, 0.0, 0.0), v);
            let parts = kinetic_energy(&cylinder, &omega, &of_p, &p);
            close(parts.translational, expected[0] * unit, 2.0 * unit);
            close(parts.mixed, expected[1] * unit, 2.0 * unit);
            close(parts.rotational, expected[2] * unit, 2.0 * unit);
        }
    }

    #[test]
    fn angular_momentum_of_a_body(
        whole in any_body(), omega in vector(3.0), v in vector(3.0), r in vector(3.0), p in vector(3.0),
    ) {
        let (c, zero) = (whole.center_of_mass(), Vector3::zeros());
        let about_c = angular_momentum(&whole, &omega, &v, &r, &c);
        prop_assert_eq!(about_c.mixed, zero);
        let inertia = whole.inertia();
        close_vectors(&about_c.spin, &(inertia * omega), inertia.trace() * omega.norm());
        close_vectors(&about_c.orbital, &(r.cross(&v) * whole.mass()), whole.mass() * r.norm() * v.norm());
        // P fixed at the inertial origin: L = I_P ω alone, and T = ½ ω·L.
        let pivoted = angular_momentum(&whole, &omega, &zero, &zero, &p);
        let about_p = whole.inertia_about(&p);
        prop_assert_eq!(pivoted.total(), pivoted.spin);
        close_vectors(&pivoted.spin, &(about_p * omega), about_p.trace() * omega.norm());
        let energy = kinetic_energy(&whole, &omega, &zero, &p).total();
        close(energy, 0.5 * omega.dot(&pivoted.total()), about_p.trace() * omega.norm_squared());
        // ω constant needs the torque ω×L.
        let torque = EulerEquations::about(&whole, &p).torque(&omega, &zero);
        let size = torque_size(&whole, &p, &omega, &zero);
        close_vectors(&torque, &omega.cross(&pivoted.total()), size);
    }

    #[test]
    fn msl25_matrix_of_euler_angles([phi, theta, psi] in angles()) {
        let q = zxz().to_quaternion(&[phi, theta, psi]).expect("finite");
        let ((sf, cf), (st, ct), (sp, cp)) = (phi.sin_cos(), theta.sin_cos(), psi.sin_cos());
        let expected = Matrix3::new(
            cf * cp - sf * ct * sp, -cf * sp - sf * ct * cp, sf * st,
            sf * cp + cf * ct * sp, -sf * sp + cf * ct * cp, -cf * st,
            st * sp, st * cp, ct,
        );
        let matrix: Rotation3<f64> = q.to_rotation_matrix();
        prop_assert!((matrix.into_inner() - expected).abs().max() <= 1e-15 * 2.0);
    }

    #[test]
    fn msl26_angular_velocity_from_rates_and_back(angles in angles(), rates in vector(3.0)) {
        let [phi, theta, psi] = angles;
        let rates: [f64; 3] = rates.into();
        let [df, dt, dp] = rates;
        let size = df.abs() + dt.abs() + dp.abs();
        let in_body = zxz().angular_velocity(&angles, &rates, Frame::Body);
        let printed = Vector3::new(
            df * theta.sin() * psi.sin() + dt * psi.cos(),
            df * theta.sin() * psi.cos() - dt * psi.sin(),
            df * theta.cos() + dp,
        );
        close_vectors(&in_body, &printed, size);
        let in_space = zxz().angular_velocity(&angles, &rates, Frame::Space);
        let printed = Vector3::new(
            dt * phi.cos() + dp * theta.sin() * phi.sin(),
            dt * phi.sin() - dp * theta.sin() * phi.cos(),
            df + dp * theta.cos(),
        );
        close_vectors(&in_space, &printed, size);
        let square = df * df + dt * dt + dp * dp + 2.0 * df * dp * theta.cos();
        close(in_body.norm_squared(), square, size * size);
        for (frame, omega) in [(Frame::Body, in_body), (Frame::Space, in_space)] {
            let back = zxz().rates(&angles, &omega, frame).expect("regular");
            close_vectors(&Vector3::from(back), &Vector3::from(rates), size / theta.sin());
        }
    }

    #[test]
    fn mex174_box_in_a_turning_frame(
        size in [0.2..3.0_f64, 0.2..3.0, 0.2..3.0], m in 0.1..9.0_f64, a in -3.0..3.0_f64, da in -4.0..4.0_f64,
        b in -3.0..3.0_f64, db in -4.0..4.0_f64,
    ) {
        // Turned by α about its own y, which turns by β about the Z of space: R_NB = Rz(β) Ry(α).
        let sequence: Sequence = "ZYX".parse().expect("valid");
        let omega = sequence.angular_velocity(&[b, a, 0.0], &[db, da, 0.0], Frame::Body);
        let whole = body(solids::cuboid(&size, Amount::Mass(m)));
        let energy = kinetic_energy(&whole, &omega, &Vector3::zeros(), &Vector3::zeros()).total();
        let [x, y, z] = size.map(|edge| edge * edge);
        let [i1, i2, i3] = [m * (y + z) / 12.0, m * (z + x) / 12.0, m * (x + y) / 12.0];
        let expected = 0.5 * (i1 * (db * a.sin()).powi(2) + i2 * da * da + i3 * (db * a.cos()).powi(2));
        close(energy, expected, (i1 + i2 + i3) * (da * da + db * db));
    }

    #[test]
    fn mln27_euler_equations_are_the_transport_of_the_angular_momentum(
        whole in any_body(), omega in vector(3.0), rate in vector(3.0), p in vector(3.0),
    ) {
        // N = (dL/dt)_N = (dL/dt)_B + ω×L with L = I_P ω and (dL/dt)_B = I_P ω̇, by the full tensor.
        let inertia = whole.inertia_about(&p);
        let expected = transport(&(inertia * rate), &(inertia * omega), &omega);
        let equations = EulerEquations::about(&whole, &p);
        let torque = equations.torque(&omega, &rate);
        let size = torque_size(&whole, &p, &omega, &rate);
        close_vectors(&torque, &expected, size);
        // In principal axes, as Euler wrote them.
        let [i1, i2, i3] = equations.moments();
        let (w, dw, n) = (
            equations.axes().tr_mul(&omega),
            equations.axes().tr_mul(&rate),
            equations.axes().tr_mul(&torque),
        );
        close(n.x, i1 * dw.x - (i2 - i3) * w.y * w.z, size);
        close(n.y, i2 * dw.y - (i3 - i1) * w.z * w.x, size);
        close(n.z, i3 * dw.z - (i1 - i2) * w.x * w.y, size);
        let forward = equations.angular_acceleration(&omega, &torque).expect("solid");
        close_vectors(&(inertia * (forward - rate)), &Vector3::zeros(), size);
    }

    #[test]
    fn mex175_edge_mill(m in 1.0..900.0_f64, radius in 0.1..2.0_f64, axle in 0.2..4.0_f64, turning in 0.1..9.0_f64) {
        // The wheel's axis z points outward from the vertical axis, which it meets at the origin; x is up for the moment.
        let (up, zero, g) = (Vector3::x(), Vector3::zeros(), 9.81);
        let wheel = body(solids::cylinder(radius, 0.1, Amount::Mass(m)));
        let wheel = body(wheel.translated(&Vector3::new(0.0, 0.0, axle)));
        let (c, frame) = (wheel.center_of_mass(), up * turning);
        let omega = frame - Vector3::z() * (turning * axle / radius);
        let contact = c - up * radius;
        close_vectors(&point_velocity(&contact, &omega, &zero), &zero, turning * axle);
        // In the inertial frame: ω stands still in the turning frame, so that its rate is Ω×ω.
        let rate = transport(&zero, &omega, &frame);
        let inertial = EulerEquations::about(&wheel, &zero).torque(&omega, &rate);
        // In the frame that turns with the vertical axis: L stands still.
        let momentum = angular_momentum(&wheel, &omega, &zero, &zero, &zero).total();
        let turned = transport(&zero, &momentum, &frame);
        let size = torque_size(&wheel, &zero, &omega, &rate);
        close_vectors(&inertial, &turned, size);
        // The ground's force F_N at the point of contact and the weight: (F_N − m g) l about y.
        let expected = m * g + 0.5 * m * radius * turning * turning;
        for torque in [inertial, turned] {
            close(torque.y / axle + m * g, expected, expected + size / axle);
        }
    }
}
