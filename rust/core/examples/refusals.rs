//! What is no body is no value: errors state the law, the numbers and the way out, and are plain data to match on.

use polhode::RigidBody;
use polhode::error::{Error, Kind, MeshFault};
use polhode::mass::Amount;
use polhode::mass::polyhedron::polyhedron;
use polhode::nalgebra::{Matrix3, Vector3};

fn main() {
    let tensor = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 5.0));
    if let Err(error) = RigidBody::new(1.0, &tensor, &Vector3::zeros(), 0.0) {
        assert_eq!(error.kind(), Kind::Inertia);
        println!("{error}");
    }
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let open = [[0_usize, 2, 1], [0, 1, 3], [0, 3, 2]];
    match polyhedron(&corners, &open, Amount::Mass(1.0), false) {
        Err(Error::Mesh(fault @ MeshFault::Open { .. })) => println!("{fault}"),
        other => println!("{other:?}"),
    }
}
