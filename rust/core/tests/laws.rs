//! What must hold for every body, at every scale.

use crate::strategies::{any_body, rotation, vector};
use crate::watch::go_on;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use polhode::RigidBody;
use polhode::mass::equimomental::equimomental_particles;
use polhode::mass::particles::particles;
use polhode::mass::realizable::nearest_valid;
use polhode::motion::angular_momentum::angular_momentum;
use polhode::motion::euler_equations::EulerEquations;
use polhode::motion::kinetic_energy::kinetic_energy;
use polhode::motion::loads::Analytic;
use polhode::motion::simulate::{Method, NoEvents, Phase, State, Task, Tolerance, simulate};
use proptest::prelude::*;

/// The size that errors of a tensor are relative to.
fn size(inertia: &Matrix3<f64>) -> f64 {
    inertia.trace()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn moments_obey_the_triangle_inequality_and_sum_to_the_trace(body in any_body()) {
        let [i1, i2, i3] = body.principal().moments;
        prop_assert!(0.0 <= i1 && i1 <= i2 && i2 <= i3);
        prop_assert!(i3 - i2 - i1 <= 1e-15 * i3);
        prop_assert!((i1 + i2 + i3 - body.inertia().trace()).abs() <= 1e-14 * i3);
    }

    #[test]
    fn axes_diagonalize_the_tensor_and_are_right_handed(body in any_body()) {
        let principal = body.principal();
        let v = principal.axes;
        let diagonal = v.transpose() * body.inertia() * v;
        let expected = Matrix3::from_diagonal(&Vector3::from(principal.moments));
        prop_assert!((diagonal - expected).abs().max() <= 1e-14 * size(&body.inertia()));
        prop_assert!((v.determinant() - 1.0).abs() < 1e-14);
    }

    #[test]
    fn moments_are_the_roots_of_the_characteristic_polynomial(body in any_body()) {
        // λ³ − tr λ² + ½(tr² − tr I²) λ − det, coefficient by coefficient.
        let ([a, b, c], tensor) = (body.principal().moments, body.inertia());
        let trace = tensor.trace();
        let second = 0.5 * (trace * trace - (tensor * tensor).trace());
        prop_assert!((a + b + c - trace).abs() <= 1e-14 * trace);
        prop_assert!((a * b + b * c + c * a - second).abs() <= 1e-14 * trace * trace);
        prop_assert!((a * b * c - tensor.determinant()).abs() <= 1e-14 * trace * trace * trace);
    }

    #[test]
    fn perpendicular_axes_of_a_lamina(
        points in proptest::collection::vec(vector(1.0), 3..12), r in rotation(), d in vector(3.0),
    ) {
        // The moment about the normal through a point of the plane is the sum of those about two axes in it.
        let masses: Vec<f64> = points.iter().map(|p| 0.1 + p.z.abs()).collect();
        let flat: Vec<[f64; 3]> = points.iter().map(|p| [p.x, p.y, 0.0]).collect();
        let lamina = particles(&masses, &flat).and_then(|lamina| lamina.rotated(&r)).expect("lamina");
        let point = r * Vector3::new(d.x, d.y, 0.0);
        let about = |axis: Vector3<f64>| lamina.moment_about(&(r * axis), &point).expect("an axis");
        let normal = about(Vector3::z());
        let turned = Vector3::new(d.z.cos(), d.z.sin(), 0.0);
        let sum = about(turned) + about(Vector3::z().cross(&turned));
        prop_assert!((normal - sum).abs() <= 1e-14 * normal);
        let [i1, i2, i3] = lamina.principal().moments;
        prop_assert!((i1 + i2 - i3).abs() <= 1e-15 * 4.0 * i3);
        prop_assert!(equimomental_particles(&lamina).expect("possible").masses.len() <= 3);
    }

    #[test]
    fn equimomental_particles_are_the_body(body in any_body()) {
        let found = equimomental_particles(&body).expect("possible");
        prop_assert_eq!(found.masses.len(), 4);
        let again = particles(&found.masses, &found.positions).expect("particles");
        let gyration = (size(&body.inertia()) / body.mass()).sqrt();
        let reach = gyration + body.center_of_mass().norm();
        prop_assert!((again.mass() - body.mass()).abs() <= 1e-15 * body.mass());
        prop_assert!((again.center_of_mass() - body.center_of_mass()).norm() <= 4e-16 * reach * 2.0);
        // The coordinates are rounded to their distance from the origin.
        let rounding = 1e-15 * 4.0 * body.mass() * gyration * reach;
        prop_assert!((again.inertia() - body.inertia()).abs().max() <= rounding);
    }

    #[test]
    fn moving_a_body_changes_nothing_about_its_center_of_mass(body in any_body(), d in vector(1e8)) {
        let moved = body.translated(&d).expect("finite");
        prop_assert_eq!(moved.inertia(), body.inertia());
        prop_assert_eq!(moved.center_of_mass(), body.center_of_mass() + d);
    }

    #[test]
    fn turning_a_body_turns_its_tensor(body in any_body(), r in rotation()) {
        let turned = body.rotated(&r).expect("rotation");
        prop_assert_eq!(turned.principal().moments, body.principal().moments);
        let expected = r * body.inertia() * r.transpose();
        prop_assert!((turned.inertia() - expected).abs().max() <= 1e-14 * size(&expected));
        prop_assert!((turned.center_of_mass() - r * body.center_of_mass()).norm() <= 1e-14 * 10.0);
    }

    #[test]
    fn bodies_add_about_any_point(a in any_body(), b in any_body(), p in vector(5.0)) {
        let sum = a.combined(&b).expect("finite");
        let expected = a.inertia_about(&p) + b.inertia_about(&p);
        prop_assert!((sum.inertia_about(&p) - expected).abs().max() <= 1e-13 * size(&expected));
        let reverse = b.combined(&a).expect("finite");
        prop_assert!((sum.inertia() - reverse.inertia()).abs().max() <= 1e-14 * size(&sum.inertia()));
    }

    #[test]
    fn taking_out_undoes_putting_in(a in any_body(), b in any_body()) {
        let sum = a.combined(&b).expect("finite");
        // Where one body is lost in the other's rounding there is nothing left to take out.
        if let Ok(rest) = sum.without(&b) {
            let scale = size(&sum.inertia()) * (1.0 + sum.mass() / a.mass());
            prop_assert!((rest.inertia() - a.inertia()).abs().max() <= 1e-13 * scale);
            prop_assert!((rest.mass() - a.mass()).abs() <= 1e-15 * sum.mass());
        } else {
            let scale = 1e-13 * size(&sum.inertia()) * (1.0 + sum.mass() / a.mass());
            prop_assert!(a.mass() <= 1e-15 * sum.mass() || size(&a.inertia()) <= scale);
        }
    }

    #[test]
    fn any_ten_numbers_are_a_body(parameters in proptest::array::uniform10(-3.0..3.0_f64)) {
        let body = RigidBody::from_log_cholesky(&parameters).expect("possible");
        let [i1, i2, i3] = body.principal().moments;
        prop_assert!(i1 >= 0.0 && i1 + i2 >= i3 * (1.0 - 1e-15));
        let same = RigidBody::from_parameters(&body.parameters(), 1e-9).expect("possible");
        prop_assert!(same.is_close(&body, 1e-8, 0.0));
    }

    #[test]
    fn the_nearest_tensor_is_possible_and_its_own_nearest(
        moments in proptest::array::uniform3(-1.0..1.0_f64), axes in rotation(), scale in -40.0..40.0_f64,
    ) {
        let diagonal = Matrix3::from_diagonal(&Vector3::from(moments));
        let given = axes * diagonal * axes.transpose() * 10.0_f64.powf(scale);
        let (nearest, distance) = nearest_valid(&given).expect("symmetric");
        prop_assert!(((nearest - given).norm() - distance).abs() <= 1e-14 * given.norm());
        prop_assert_eq!(nearest_valid(&nearest), Ok((nearest, 0.0)));
        prop_assert!(RigidBody::new(1.0, &nearest, &Vector3::zeros(), 0.0).is_ok());
    }

    #[test]
    fn a_body_comes_back_from_its_numbers(body in any_body()) {
        prop_assert_eq!(RigidBody::from_array(&body.to_array()), Ok(body));
    }

    #[test]
    fn energy_and_momentum_do_not_depend_on_the_point(
        body in any_body(), omega in vector(3.0), v in vector(3.0), r in vector(3.0), p in vector(5.0),
    ) {
        // The same motion told of C and of P: v_P = v + ω×(P − C), R_P = R + P − C.
        let c = body.center_of_mass();
        let v_p = v + omega.cross(&(p - c));
        let (of_c, of_p) = (kinetic_energy(&body, &omega, &v, &c), kinetic_energy(&body, &omega, &v_p, &p));
        let largest = of_p.translational + of_p.mixed.abs() + of_p.rotational;
        prop_assert_eq!(of_c.mixed, 0.0);
        prop_assert!((of_c.total() - of_p.total()).abs() <= 1e-13 * largest);
        let l_c = angular_momentum(&body, &omega, &v, &r, &c);
        let l_p = angular_momentum(&body, &omega, &v_p, &(r + p - c), &p);
        let largest = l_p.orbital.norm() + l_p.mixed.norm() + l_p.spin.norm() + body.mass() * 300.0;
        prop_assert!((l_c.total() - l_p.total()).norm() <= 1e-13 * largest);
    }

    #[test]
    fn euler_equations_forward_undo_inverse(body in any_body(), omega in vector(3.0), a in vector(3.0), p in vector(5.0)) {
        let equations = EulerEquations::about(&body, &p);
        let torque = equations.torque(&omega, &a);
        let [i1, _, i3] = equations.moments();
        let back = equations.angular_acceleration(&omega, &torque).expect("solid");
        prop_assert!((back - a).norm() <= 1e-14 * (i3 / i1) * 30.0);
    }

    #[test]
    fn particles_do_not_mind_where_they_are(
        offsets in proptest::collection::vec(vector(1.0), 4..40), d in prop_oneof![vector(10.0), vector(1e8)],
    ) {
        let masses: Vec<f64> = offsets.iter().map(|r| 0.1 + r.norm()).collect();
        // The stored coordinates are the data, so the body at home is made of what is stored far away.
        let far: Vec<[f64; 3]> = offsets.iter().map(|r| (r + d).into()).collect();
        let home: Vec<[f64; 3]> = far.iter().map(|r| (Vector3::from(*r) - d).into()).collect();
        let (far, home) = (particles(&masses, &far), particles(&masses, &home));
        let (far, home) = (far.expect("particles"), home.expect("particles"));
        prop_assert!((far.inertia() - home.inertia()).abs().max() <= 4e-15 * size(&home.inertia()));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn free_motion_conserves_energy_and_angular_momentum(
        body in any_body(), direction in vector(1.0), attitude in rotation(),
    ) {
        let center = body.center_of_mass();
        let omega = direction.try_normalize(1e-3).unwrap_or_else(Vector3::x);
        let initial = Phase::in_place(&State { attitude: UnitQuaternion::from_matrix(&attitude), omega });
        let times: Vec<f64> = (0..20).map(|k| 0.9 * f64::from(k)).collect();
        let tolerance = Tolerance::new(1e-12, 0.0).expect("tolerance");
        let task = Task::free(&body, initial, &times, Method::Dop853, tolerance);
        let mut load = Analytic::new(&[], task.body_at_point);
        let samples =
            simulate(&task, &mut load, &mut NoEvents::new(), &mut go_on).samples;
        let zero = Vector3::zeros();
        let energy = |state: &Phase| kinetic_energy(&body, &state.omega, &zero, &center).total();
        let momentum = |state: &Phase| {
            state.attitude * angular_momentum(&body, &state.omega, &zero, &zero, &center).total()
        };
        for state in &samples {
            prop_assert!((energy(state) - energy(&samples[0])).abs() <= 1e-9 * body.principal().moments[2]);
            prop_assert!((momentum(state) - momentum(&samples[0])).norm() <= 1e-9 * body.principal().moments[2]);
            prop_assert!((state.attitude.norm() - 1.0).abs() < 1e-15);
        }
    }
}
