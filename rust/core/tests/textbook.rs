//! Worked numbers of the theory, each with its label, against the closed form on paper.

// The helpers are part of the tests.
#![allow(clippy::expect_used)]

use nalgebra::{Matrix3, Vector3};
use polhode::RigidBody;
use polhode::mass::parallel_axis::{from_center_of_mass, to_center_of_mass};
use polhode::mass::particles::particles;
use polhode::mass::{Amount, solids};
use polhode::motion::euler_equations::EulerEquations;
use polhode::motion::kinetic_energy::kinetic_energy;
use polhode::principal::{TOP_RTOL, Top, classify};

const M: f64 = 1.7;

fn close(value: f64, expected: f64, size: f64) {
    assert!(
        (value - expected).abs() <= 1e-13 * size,
        "{value} instead of {expected}"
    );
}

fn body(shape: Result<RigidBody, polhode::Error>) -> RigidBody {
    shape.expect("a possible body")
}

#[test]
fn mex67_kinetic_energy_of_particles_is_that_of_their_tensor() {
    let masses = [1.0, 2.0, 0.5, 3.0];
    let positions = [
        [1.0, 0.2, -0.3],
        [-0.4, 1.1, 0.8],
        [0.0, -2.0, 0.6],
        [0.7, 0.7, -1.5],
    ];
    let omega = Vector3::new(0.3, -1.2, 2.1);
    let by_particles: f64 = masses
        .iter()
        .zip(positions)
        .map(|(m, r)| 0.5 * m * omega.cross(&Vector3::from(r)).norm_squared())
        .sum();
    let whole = body(particles(&masses, &positions));
    let origin = Vector3::zeros();
    close(
        kinetic_energy(&whole, &omega, &origin, &origin).total(),
        by_particles,
        by_particles,
    );
    let by_tensor = 0.5 * omega.dot(&(whole.inertia_about(&origin) * omega));
    close(by_tensor, by_particles, by_particles);
}

#[test]
fn mex68_cube_about_its_corner() {
    let side = 2.3;
    let unit = M * side * side;
    let cube = body(solids::cube(side, Amount::Mass(M)));
    let corner = Vector3::repeat(side / 2.0);
    let inertia = cube.inertia_about(&corner);
    close(inertia[(0, 0)], unit * 2.0 / 3.0, unit);
    close(inertia[(0, 1)], -unit / 4.0, unit);
    let principal = cube.principal_about(&corner);
    close(principal.moments[0], unit / 6.0, unit);
    close(principal.moments[1], unit * 11.0 / 12.0, unit);
    close(principal.moments[2], unit * 11.0 / 12.0, unit);
    close(
        principal
            .axes
            .column(0)
            .dot(&Vector3::repeat(1.0 / 3.0_f64.sqrt())),
        1.0,
        1.0,
    );
}

#[test]
fn mex69_parallel_axis_theorem_there_and_back() {
    let about_center = Matrix3::new(2.0, 0.1, -0.2, 0.1, 2.5, 0.3, -0.2, 0.3, 3.0);
    let d = Vector3::new(0.4, -1.0, 0.7);
    let about_point = from_center_of_mass(&about_center, M, &d);
    close(about_point[(0, 0)], 2.0 + M * (1.0 + 0.49), 4.0);
    close(about_point[(0, 1)], 0.1 + M * 0.4, 4.0);
    assert!(
        (to_center_of_mass(&about_point, M, &d) - about_center)
            .abs()
            .max()
            < 1e-15
    );
}

#[test]
fn mex71_cone() {
    let (radius, height) = (1.1, 2.7);
    let unit = M * (radius * radius + height * height);
    let cone = body(solids::cone(radius, height, Amount::Mass(M)));
    let apex = cone.inertia_about(&Vector3::new(0.0, 0.0, 0.75 * height));
    close(apex[(2, 2)], 0.3 * M * radius * radius, unit);
    close(
        apex[(0, 0)],
        0.6 * M * (height * height + radius * radius / 4.0),
        unit,
    );
    close(
        cone.inertia()[(0, 0)],
        3.0 / 20.0 * M * (radius * radius + height * height / 4.0),
        unit,
    );
}

#[test]
fn mex73_coin_about_its_rim() {
    let radius = 0.9;
    let unit = M * radius * radius;
    let coin = body(solids::cylinder(radius, 0.0, Amount::Mass(M)));
    let moments = coin
        .principal_about(&Vector3::new(radius, 0.0, 0.0))
        .moments;
    for (moment, expected) in moments.iter().zip([0.25, 1.25, 1.5]) {
        close(*moment, expected * unit, unit);
    }
}

#[test]
fn mex252_to_254_cylinder_sphere_ellipsoid() {
    let (radius, height) = (1.1, 2.7);
    let unit = M * (radius * radius + height * height);
    let cylinder = body(solids::cylinder(radius, height, Amount::Mass(M))).inertia();
    close(cylinder[(2, 2)], 0.5 * M * radius * radius, unit);
    close(
        cylinder[(0, 0)],
        M * (3.0 * radius * radius + height * height) / 12.0,
        unit,
    );
    let sphere = body(solids::sphere(radius, Amount::Mass(M))).inertia();
    close(sphere[(1, 1)], 0.4 * M * radius * radius, unit);
    let (a, b, c) = (0.5, 1.5, 2.5);
    let ellipsoid = body(solids::ellipsoid(&[a, b, c], Amount::Mass(M))).inertia();
    close(ellipsoid[(0, 0)], M * (b * b + c * c) / 5.0, 10.0 * M);
    close(ellipsoid[(2, 2)], M * (a * a + b * b) / 5.0, 10.0 * M);
}

#[test]
fn mex255_four_equal_atoms_on_a_regular_tetrahedron_are_a_spherical_top() {
    let a = 1.3;
    let h = a * (2.0_f64 / 3.0).sqrt();
    let r = a / 3.0_f64.sqrt();
    let corner = |k: f64| {
        let angle = k * std::f64::consts::TAU / 3.0;
        [r * angle.cos(), r * angle.sin(), 0.0]
    };
    let molecule = body(particles(
        &[M; 4],
        &[corner(0.0), corner(1.0), corner(2.0), [0.0, 0.0, h]],
    ));
    for moment in molecule.principal().moments {
        close(moment, M * a * a, M * a * a);
    }
    assert_eq!(
        classify(&molecule.principal().moments, TOP_RTOL),
        Top::Spherical
    );
}

#[test]
fn mln27_steady_rotation_needs_the_torque_omega_cross_l() {
    let brick = body(solids::cuboid(&[1.0, 2.0, 3.0], Amount::Mass(M)));
    let equations = EulerEquations::about(&brick, &Vector3::zeros());
    let omega = Vector3::new(0.4, -0.7, 1.9);
    let torque = equations.torque(&omega, &Vector3::zeros());
    let expected = omega.cross(&(brick.inertia() * omega));
    assert!((torque - expected).norm() < 1e-14 * expected.norm());
    let held = equations
        .angular_acceleration(&omega, &torque)
        .expect("a solid body");
    assert!(held.norm() < 1e-14);
}
