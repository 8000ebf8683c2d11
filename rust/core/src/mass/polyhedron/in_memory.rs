//! The solid inside the triangles of a mesh in memory.

use std::ops::ControlFlow;

use super::faces::Faces;
use super::solid::{Options, solid};
use super::view::Index;
use crate::error::Error;
use crate::mass::amount::Amount;
use crate::mass::body::RigidBody;
use crate::numerics::threads::{Halt, Watch};

/// A solid of uniform density bounded by a closed, consistently wound triangle mesh.
///
/// `faces` count vertices from zero, counter-clockwise seen from outside. Vertices with the same coordinates are one
/// vertex. With `orient` an inverted mesh is turned, and so is a component that is wound like a cavity but lies in no other;
/// else it is an error. Several components and cavities (inner surfaces wound inward) are counted as they are.
///
/// # Examples
///
/// ```
/// use polhode::mass::Amount;
/// use polhode::mass::polyhedron::polyhedron;
///
/// let vertices = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let faces = [[0_usize, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
/// let corner = polyhedron(&vertices, &faces, Amount::Density(6.0), false)?;
/// assert!((corner.mass() - 1.0).abs() < 1e-15); // the volume is 1/6
/// // Without a face it has no inside.
/// let open = polyhedron(&vertices, &faces[..3], Amount::Density(6.0), false);
/// assert!(open.unwrap_err().to_string().contains("closed"));
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// [`MeshFault`](crate::error::MeshFault) names the face, edge or vertex that keeps the mesh from bounding a solid.
pub fn polyhedron<I: Index>(
    vertices: &[[f64; 3]],
    faces: &[[I; 3]],
    amount: Amount,
    orient: bool,
) -> Result<RigidBody, Error> {
    let options = Options {
        orient,
        ..Options::default()
    };
    let go_on = &mut |_| ControlFlow::Continue(());
    Ok(polyhedron_watched(vertices, faces, amount, options, go_on)?)
}

/// The same on several threads when the mesh is large, with `watch` asked about every 20 ms whether to go on.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::mass::polyhedron::{Index, Options, polyhedron_watched};
/// use polhode::mass::{Amount, RigidBody};
///
/// /// A solid whose faces count vertices by integers of any type, wound either way.
/// fn solid<I: Index>(vertices: &[[f64; 3]], faces: &[[I; 3]]) -> Result<RigidBody, polhode::Error> {
///     let options = Options { orient: true, ..Options::default() };
///     let watch = &mut |done: f64| {
///         println!("{:.0} %", 100.0 * done);
///         ControlFlow::Continue(())
///     };
///     Ok(polyhedron_watched(vertices, faces, Amount::Density(6.0), options, watch)?)
/// }
///
/// let vertices = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let inverted = [[0_i32, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
/// assert!((solid(&vertices, &inverted)?.mass() - 1.0).abs() < 1e-15);
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// As [`polyhedron`], and [`Halt::Stopped`] where `watch` said so.
pub fn polyhedron_watched<I: Index>(
    vertices: &[[f64; 3]],
    faces: &[[I; 3]],
    amount: Amount,
    options: Options,
    watch: &mut Watch<'_>,
) -> Result<RigidBody, Halt<Error>> {
    solid_of_faces(vertices, faces, amount, options, watch).map(|(body, _)| body)
}

/// The faces of a closed mesh, wound as they count where `orient` is asked for: counter-clockwise seen from outside.
///
/// # Examples
///
/// ```
/// use polhode::mass::polyhedron::outward;
///
/// let vertices = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let inverted = [[0_u32, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
/// assert_eq!(outward(&vertices, &inverted)[0], [0, 2, 1]);
/// ```
#[must_use]
pub fn outward<I: Index>(vertices: &[[f64; 3]], faces: &[[I; 3]]) -> Vec<[I; 3]> {
    let go_on = &mut |_| ControlFlow::Continue(());
    let options = Options {
        orient: true,
        ..Options::default()
    };
    let mut mesh = Faces::new(vertices, faces, go_on);
    // What is wrong with the mesh is not asked here.
    let _outcome = solid(&mut mesh, Amount::Density(1.0), options);
    let faces = match mesh.inside_out {
        Some(found) => found.turned(faces),
        None => faces.to_vec(),
    };
    let is_outward = polyhedron_watched(
        vertices,
        &faces,
        Amount::Density(1.0),
        Options::default(),
        go_on,
    )
    .is_ok();
    if is_outward {
        faces
    } else {
        faces.iter().map(|&[a, b, c]| [a, c, b]).collect()
    }
}

/// The solid inside triangles in memory, components turned where that is asked for, and its volume.
pub(super) fn solid_of_faces<I: Index>(
    vertices: &[[f64; 3]],
    faces: &[[I; 3]],
    amount: Amount,
    options: Options,
    watch: &mut Watch<'_>,
) -> Result<(RigidBody, f64), Halt<Error>> {
    let mut mesh = Faces::new(vertices, faces, watch);
    let outcome = solid(&mut mesh, amount, options);
    match mesh.inside_out {
        Some(found) if options.orient => {
            let faces = found.turned(faces);
            solid(&mut Faces::new(vertices, &faces, watch), amount, options)
        }
        _ => outcome,
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::error::{Count, MeshFault};

    const TETRAHEDRON: ([[f64; 3]; 4], [[usize; 3]; 4]) = (
        [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
        ],
        [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
    );

    #[test]
    fn unit_tetrahedron() {
        let (vertices, faces) = TETRAHEDRON;
        let body = polyhedron(&vertices, &faces, Amount::Density(6.0), false).expect("closed");
        assert!((body.mass() - 1.0).abs() < 1e-15);
        assert!((body.center_of_mass() - Vector3::repeat(0.25)).norm() < 1e-15);
        // ∫x² = 1/10 and ∫xy = 1/20 of the mass about the corner.
        let corner = body.inertia_about(&Vector3::zeros());
        assert!((corner[(0, 0)] - 0.2).abs() < 1e-15);
        assert!((corner[(0, 1)] + 0.05).abs() < 1e-15);
    }

    #[test]
    fn faults_are_told_apart() {
        let (vertices, faces) = TETRAHEDRON;
        let fault =
            |faces: &[[usize; 3]]| match polyhedron(&vertices, faces, Amount::Mass(1.0), false) {
                Err(Error::Mesh(fault)) => fault,
                other => panic!("expected a mesh fault, got {other:?}"),
            };
        assert!(matches!(
            fault(&faces[..3]),
            MeshFault::Open {
                count: Count { seen: 3, .. },
                ..
            }
        ));
        let mut flipped = faces;
        flipped[3].swap(0, 1);
        assert!(matches!(
            fault(&flipped),
            MeshFault::InconsistentWinding {
                count: Count { seen: 3, .. },
                ..
            }
        ));
        let inverted = faces.map(|[a, b, c]| [b, a, c]);
        assert!(matches!(fault(&inverted), MeshFault::Inverted { .. }));
        assert!(polyhedron(&vertices, &inverted, Amount::Mass(1.0), true).is_ok());
        assert!(matches!(
            fault(&[[0, 1, 4]]),
            MeshFault::IndexOutOfRange {
                face: 0,
                index: 4,
                ..
            }
        ));
        assert!(matches!(
            fault(&[[0, 1, 2], [0, 2, 1]]),
            MeshFault::NoVolume { .. }
        ));
    }

    #[test]
    fn triangle_soup_is_welded_by_equal_coordinates() {
        let (vertices, faces) = TETRAHEDRON;
        let soup: Vec<[f64; 3]> = faces.iter().flatten().map(|&k| vertices[k]).collect();
        let corners: Vec<[usize; 3]> = (0..4).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let body = polyhedron(&soup, &corners, Amount::Density(6.0), false).expect("closed");
        assert!((body.mass() - 1.0).abs() < 1e-15);
    }
}
