//! Mass and principal axes.

use nalgebra::{Matrix3, Vector3};
use polhode::RigidBody;
use polhode::mass::equimomental::stick;
use polhode::mass::parallel_axis::{from_center_of_mass, to_center_of_mass};
use polhode::mass::particles::particles;
use polhode::mass::{Amount, solids};
use polhode::motion::kinetic_energy::kinetic_energy;
use polhode::principal::{TOP_RTOL, Top, classify, principal_axes};
use proptest::collection::vec;
use proptest::prelude::*;

use super::{body, close, sets};
use crate::strategies::{any_body, rotation, vector};

/// Masses and places of some particles.
fn swarm() -> impl Strategy<Value = (Vec<f64>, Vec<[f64; 3]>)> {
    vec((0.1..3.0, vector(2.0)), 1..9).prop_map(|rows| {
        rows.into_iter()
            .map(|(m, r)| (m, <[f64; 3]>::from(r)))
            .unzip()
    })
}

fn trace(tensor: &Matrix3<f64>) -> f64 {
    tensor.trace()
}

proptest! {
    #![proptest_config(sets())]

    #[test]
    fn mex67_kinetic_energy_of_particles_is_that_of_their_tensor(
        (masses, positions) in swarm(), omega in vector(3.0),
    ) {
        let speeds = positions.iter().map(|r| omega.cross(&Vector3::from(*r)).norm_squared());
        let by_particles: f64 = masses.iter().zip(speeds).map(|(m, v2)| 0.5 * m * v2).sum();
        let whole = body(particles(&masses, &positions));
        let origin = Vector3::zeros();
        let inertia = whole.inertia_about(&origin);
        let size = trace(&inertia) * omega.norm_squared();
        close(kinetic_energy(&whole, &omega, &origin, &origin).total(), by_particles, size);
        close(0.5 * omega.dot(&(inertia * omega)), by_particles, size);
    }

    #[test]
    fn inertia_tensor_is_the_sum_over_the_particles_and_gives_the_moment_about_any_axis(
        (masses, positions) in swarm(), point in vector(3.0), axis in vector(1.0),
    ) {
        prop_assume!(axis.norm() > 1e-3);
        let whole = body(particles(&masses, &positions));
        let mut sum = Matrix3::zeros();
        let mut moment = 0.0;
        for (m, r) in masses.iter().zip(&positions) {
            let r = Vector3::from(*r) - point;
            sum += (Matrix3::identity() * r.dot(&r) - r * r.transpose()) * *m;
            moment += m * r.cross(&axis.normalize()).norm_squared();
        }
        let inertia = whole.inertia_about(&point);
        prop_assert!((inertia - sum).abs().max() <= 1e-13 * trace(&sum));
        prop_assert_eq!(inertia, inertia.transpose());
        let about = whole.moment_about(&axis, &point).expect("an axis");
        close(about, moment, trace(&sum));
        let n = axis.normalize();
        close(about, n.dot(&(inertia * n)), trace(&sum));
    }

    #[test]
    fn mln80_principal_axes(whole in any_body()) {
        // I Ω = Ω Ī with Ωᵀ Ω = 1, right-handed, found from the bare tensor.
        let inertia = whole.inertia();
        let found = principal_axes(&inertia);
        let bar = Matrix3::from_diagonal(&Vector3::from(found.moments));
        let residual = inertia * found.axes - found.axes * bar;
        prop_assert!(residual.abs().max() <= 1e-14 * trace(&inertia));
        prop_assert!((found.axes.tr_mul(&found.axes) - Matrix3::identity()).abs().max() <= 1e-14);
        close(found.axes.determinant(), 1.0, 1.0);
    }

    #[test]
    fn mln80_degenerate_tops(i in 0.6..1.9_f64, axes in rotation()) {
        let top = |moments: [f64; 3]| {
            let made = body(RigidBody::from_principal(1.0, &moments, &axes, &Vector3::zeros(), 0.0));
            let found = principal_axes(&made.inertia());
            let bar = Matrix3::from_diagonal(&Vector3::from(found.moments));
            let back = found.axes * bar * found.axes.transpose();
            let residual = (back - made.inertia()).abs().max();
            assert!(residual <= 1e-14 * 3.0, "{residual:e}");
            classify(&found.moments, TOP_RTOL)
        };
        assert_eq!(top([i, i, i]), Top::Spherical);
        assert_eq!(top([0.5, 0.5, 0.9]), Top::Oblate);
        assert_eq!(top([0.5, i, i]), Top::Prolate);
        assert_eq!(top([0.0, i, i]), Top::Linear);
    }

    #[test]
    fn mex69_parallel_axis_theorem(whole in any_body(), d in vector(3.0), axis in vector(1.0)) {
        prop_assume!(axis.norm() > 1e-3);
        let (m, inertia) = (whole.mass(), whole.inertia());
        let expected = Matrix3::from_fn(|i, j| {
            inertia[(i, j)] + m * (f64::from(u8::from(i == j)) * d.dot(&d) - d[i] * d[j])
        });
        let size = trace(&expected);
        let about = from_center_of_mass(&inertia, m, &d);
        prop_assert!((about - expected).abs().max() <= 1e-14 * size);
        prop_assert!((from_center_of_mass(&inertia, m, &-d) - about).abs().max() == 0.0);
        prop_assert!((to_center_of_mass(&about, m, &d) - inertia).abs().max() <= 1e-14 * size);
        let point = whole.center_of_mass() + d;
        let rounding = 1e-13 * size + 1e-14 * m * d.norm() * whole.center_of_mass().norm();
        prop_assert!((whole.inertia_about(&point) - expected).abs().max() <= rounding);
        // About parallel axes: I = I_C + m × (distance of the axes)².
        let center = whole.center_of_mass();
        let about_center = whole.moment_about(&axis, &center).expect("an axis");
        let about_point = whole.moment_about(&axis, &point).expect("an axis");
        let distance = d.cross(&axis.normalize()).norm();
        prop_assert!((about_point - about_center - m * distance * distance).abs() <= rounding);
    }

    #[test]
    fn mex73_coin_about_its_rim(m in 0.1..10.0_f64, radius in 0.1..5.0_f64, angle in 0.0..6.3_f64) {
        let unit = m * radius * radius;
        let coin = body(solids::cylinder(radius, 0.0, Amount::Mass(m)));
        let rim = Vector3::new(radius * angle.cos(), radius * angle.sin(), 0.0);
        let moments = coin.principal_about(&rim).moments;
        for (moment, expected) in moments.iter().zip([0.25, 1.25, 1.5]) {
            close(*moment, expected * unit, unit);
        }
        close(moments[0] + moments[1], moments[2], unit);
    }

    #[test]
    fn mex68_cube_about_its_corner(m in 0.1..10.0_f64, side in 0.1..5.0_f64) {
        let unit = m * side * side;
        let cube = body(solids::cube(side, Amount::Mass(m)));
        let corner = Vector3::repeat(side / 2.0);
        let inertia = cube.inertia_about(&corner);
        close(inertia[(0, 0)], unit * 2.0 / 3.0, unit);
        close(inertia[(0, 1)], -unit / 4.0, unit);
        let principal = cube.principal_about(&corner);
        close(principal.moments[0], unit / 6.0, unit);
        close(principal.moments[1], unit * 11.0 / 12.0, unit);
        close(principal.moments[2], unit * 11.0 / 12.0, unit);
        let diagonal = Vector3::repeat(1.0 / 3.0_f64.sqrt());
        close(principal.axes.column(0).dot(&diagonal), 1.0, 1.0);
    }

    #[test]
    fn mex252_to_254_cylinder_sphere_ellipsoid(m in 0.1..10.0_f64, size in [0.1..5.0_f64, 0.1..5.0, 0.1..5.0]) {
        let [a, b, c] = size;
        let unit = m * (a * a + b * b + c * c);
        let cylinder = body(solids::cylinder(a, b, Amount::Mass(m))).inertia();
        close(cylinder[(2, 2)], 0.5 * m * a * a, unit);
        close(cylinder[(0, 0)], m * (3.0 * a * a + b * b) / 12.0, unit);
        let sphere = body(solids::sphere(a, Amount::Mass(m))).inertia();
        close(sphere[(1, 1)], 0.4 * m * a * a, unit);
        let ellipsoid = body(solids::ellipsoid(&size, Amount::Mass(m))).inertia();
        close(ellipsoid[(0, 0)], m * (b * b + c * c) / 5.0, unit);
        close(ellipsoid[(1, 1)], m * (c * c + a * a) / 5.0, unit);
        close(ellipsoid[(2, 2)], m * (a * a + b * b) / 5.0, unit);
    }

    #[test]
    fn mex255_four_atomic_molecule(
        m1 in 0.5..20.0_f64, m2 in 0.5..20.0_f64, a in 0.5..3.0_f64, height in 0.1..3.0_f64, turn in rotation(),
    ) {
        // Three m₁ on a triangle of side a, m₂ at the height h above its middle.
        let molecule = |m2: f64, h: f64| {
            let r = a / 3.0_f64.sqrt();
            let places: [Vector3<f64>; 4] = std::array::from_fn(|k| {
                let angle = k as f64 * std::f64::consts::TAU / 3.0;
                if k == 3 { Vector3::new(0.0, 0.0, h) } else { Vector3::new(r * angle.cos(), r * angle.sin(), 0.0) }
            });
            let places = places.map(|place| (turn * place).into());
            body(particles(&[m1, m1, m1, m2], &places))
        };
        let along = turn * Vector3::z();
        let (axial, reduced) = (m1 * a * a, 3.0 * m1 * m2 / (3.0 * m1 + m2));
        let transverse = 0.5 * m1 * a * a + reduced * height * height;
        let found = molecule(m2, height);
        let moment = |axis: Vector3<f64>| found.moment_about(&axis, &found.center_of_mass()).expect("an axis");
        close(moment(along), axial, axial + transverse);
        close(moment(turn * Vector3::x()), transverse, axial + transverse);
        close(moment(turn * Vector3::y()), transverse, axial + transverse);
        // Regular, of equal masses: a spherical top.
        let regular = molecule(m1, a * (2.0_f64 / 3.0).sqrt()).principal().moments;
        for moment in regular {
            close(moment, m1 * a * a, m1 * a * a);
        }
        prop_assert_eq!(classify(&regular, TOP_RTOL), Top::Spherical);
    }

    #[test]
    fn mex71_cone(m in 0.1..10.0_f64, radius in 0.1..5.0_f64, height in 0.1..5.0_f64) {
        let unit = m * (radius * radius + height * height);
        let cone = body(solids::cone(radius, height, Amount::Mass(m)));
        let apex = cone.inertia_about(&Vector3::new(0.0, 0.0, 0.75 * height));
        close(apex[(2, 2)], 0.3 * m * radius * radius, unit);
        close(apex[(0, 0)], 0.6 * m * (height * height + radius * radius / 4.0), unit);
        let across = 3.0 / 20.0 * m * (radius * radius + height * height / 4.0);
        close(cone.inertia()[(0, 0)], across, unit);
    }

    #[test]
    fn mex143_stick_as_three_particles(
        m in 0.1..10.0_f64, k2 in 0.1..2.0_f64, a in 0.2..4.0_f64, slack in 1.0..3.0_f64, x in -5.0..5.0_f64,
    ) {
        let inertia = m * k2;
        let b = slack * k2 / a;
        let found = stick(m, inertia, a, b).expect("a b ≥ k²");
        prop_assert!(found.masses.iter().all(|&mass| mass >= 0.0));
        let [m1, m2, m0]: [f64; 3] = found.masses.clone().try_into().expect("three");
        close(m1, inertia / (a * (a + b)), m);
        close(m2, inertia / (b * (a + b)), m);
        close(m0, m - inertia / (a * b), m);
        close(m1 + m2 + m0, m, m);
        close(m1 * a, m2 * b, m1 * a);
        // The moment about the parallel axis at x.
        let moment: f64 = (found.masses.iter().zip(&found.positions))
            .map(|(mass, place)| mass * (place[2] - x).powi(2))
            .sum();
        let largest = m1 * (a - x).powi(2) + m2 * (b + x).powi(2) + m * x * x;
        close(moment, inertia + m * x * x, largest);
        prop_assert!(stick(m, inertia, a, 0.99 * k2 / a).is_err());
    }
}
