//! Solids bounded by a closed triangle mesh.
//!
//! The divergence theorem turns the volume integrals into sums over triangles: each triangle (a, b, c) spans a signed
//! tetrahedron with a reference point, of volume `det(a, b, c)/6`. The sums are those of the solid only when the mesh is
//! closed and consistently wound; an open mesh would give numbers that depend on where it stands, so it is refused.

use nalgebra::{Matrix3, Vector3};
use thiserror::Error as ThisError;

use super::body::RigidBody;
use super::error_bound::{ErrorBound, UNIT};
use super::second_moment::SecondMoment;
use super::solids::Amount;
use crate::error::Error;
use crate::numerics::reduce::{depth, sum_terms};

/// Why a mesh does not bound a solid.
#[derive(Clone, Debug, PartialEq, ThisError)]
#[non_exhaustive]
pub enum MeshFault {
    /// No faces.
    #[error("the mesh has no faces")]
    NoFaces,
    /// A face names a vertex that does not exist.
    #[error(
        "faces[{face}] names vertex {index}, but there are {vertices} vertices, numbered from 0; \
         if the faces count from 1 subtract 1"
    )]
    IndexOutOfRange {
        /// The face.
        face: usize,
        /// The index it holds.
        index: i64,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertices[{vertex}] is not finite: {value:?}")]
    NonFiniteVertex {
        /// The vertex.
        vertex: usize,
        /// The coordinate.
        value: f64,
    },
    /// An edge with a face on one side only.
    #[error(
        "the mesh is not closed: the edge from vertex {from} to vertex {to} of faces[{face}] has no face on its other \
         side ({count} such edges in all); close the mesh, or model a thin shell instead"
    )]
    Open {
        /// Start of the edge.
        from: usize,
        /// End of the edge.
        to: usize,
        /// The face that has it.
        face: usize,
        /// How many open edges.
        count: usize,
    },
    /// Two faces run along an edge in the same direction.
    #[error(
        "the mesh is not consistently wound: faces[{first}] and faces[{second}] both run from vertex {from} to vertex \
         {to} ({count} such edges in all); reverse the order of the vertices of one of them"
    )]
    InconsistentWinding {
        /// Start of the edge.
        from: usize,
        /// End of the edge.
        to: usize,
        /// One face.
        first: usize,
        /// The other face.
        second: usize,
        /// How many edges are run along in one direction only.
        count: usize,
    },
    /// The extent is beyond the largest float.
    #[error("the mesh is too large: its extent is {size:?}; choose a larger unit of length")]
    TooLarge {
        /// The largest extent.
        size: f64,
    },
    /// The normals point inward.
    #[error(
        "the mesh is inverted: its signed volume is {volume:?}, so the normals point inward; \
         pass orient=True to turn them all"
    )]
    Inverted {
        /// The signed volume.
        volume: f64,
    },
    /// The mesh encloses nothing.
    #[error(
        "the mesh encloses no volume: {volume:?} with edges up to {size:?}; model a sheet as a thin shell instead"
    )]
    NoVolume {
        /// The signed volume.
        volume: f64,
        /// The largest extent.
        size: f64,
    },
}

/// A solid of uniform density bounded by a closed, consistently wound triangle mesh.
///
/// `faces` count vertices from zero, counter-clockwise seen from outside. Vertices with the same coordinates are one
/// vertex. With `orient` an inverted mesh is turned, else it is an error. Several components and cavities (inner
/// surfaces wound inward) are counted as they are.
///
/// # Errors
/// [`MeshFault`] names the face, edge or vertex that keeps the mesh from bounding a solid.
pub fn polyhedron(
    vertices: &[[f64; 3]],
    faces: &[[usize; 3]],
    amount: Amount,
    orient: bool,
) -> Result<RigidBody, Error> {
    check_mesh(vertices, faces)?;
    let (reference, size) = middle(vertices, faces);
    if !size.is_finite() {
        return Err(MeshFault::TooLarge { size }.into());
    }
    // In units of the size, a power of two so that nothing is rounded: lengths of 1e±150 have fifth powers too.
    let unit = power_of_two(size);
    let sums = signed_sums(vertices, faces, &reference, unit);
    let volume = sums.volume * unit * unit * unit;
    // What rounding may have left: a closed sheet has no other volume.
    if sums.volume.abs() <= 8.0 * f64::EPSILON * sums.magnitude {
        return Err(MeshFault::NoVolume { volume, size }.into());
    }
    if sums.volume < 0.0 && !orient {
        return Err(MeshFault::Inverted { volume }.into());
    }
    let mass = amount.mass(volume.abs())?;
    let density = mass / sums.volume;
    let mut matter = SecondMoment::about_reference(
        &reference,
        mass,
        &(sums.first * density * unit),
        &(sums.second * density * unit * unit),
        ErrorBound::default(),
    );
    matter.error_bound = bound(&sums, faces.len(), amount, &matter, unit);
    RigidBody::from_second_moment(&matter)
}

/// What rounding can have done: each sum is off by a few units of rounding of the same sum with every product counted as
/// positive, in which coordinates are at most one.
fn bound(
    sums: &Sums,
    faces: usize,
    amount: Amount,
    matter: &SecondMoment,
    unit: f64,
) -> ErrorBound {
    let relative = 2.0 * UNIT * (depth(faces) + 24.0);
    // Of the volume: det(a, b, c)/6. First moments have the factor (a + b + c)/4 ≤ ¾, second ones 12/20 at most.
    let volume = relative * sums.magnitude / sums.volume.abs();
    let mass = match amount {
        Amount::Mass(_) => 0.0,
        Amount::Density(_) => matter.mass * (volume + 8.0 * UNIT),
    };
    ErrorBound {
        mass,
        center_of_mass: 2.0 * volume * unit + 2.0 * UNIT * matter.center_of_mass.amax(),
        inertia: 4.0 * volume * matter.mass * unit * unit,
    }
}

/// Area of a triangle mesh, open or closed.
///
/// # Errors
/// When a face names no vertex or a coordinate is not finite.
pub fn surface_area(vertices: &[[f64; 3]], faces: &[[usize; 3]]) -> Result<f64, Error> {
    check_indices(vertices, faces)?;
    let [area] = sum_terms(faces.len(), |i| {
        let [a, b, c] = faces[i].map(|k| Vector3::from(vertices[k]));
        [(b - a).cross(&(c - a)).norm() / 2.0]
    });
    Ok(area)
}

/// `∫ dV`, `∫ d dV` and `∫ d dᵀ dV` over the inside of the mesh, `d = (r − reference)/unit`.
struct Sums {
    volume: f64,
    /// `∫ dV` with every product counted as positive: its rounding errors are a few ε of this.
    magnitude: f64,
    first: Vector3<f64>,
    second: Matrix3<f64>,
}

/// Sums over the signed tetrahedra (0, a, b, c): with `D = det(a, b, c)` and `s = a + b + c`,
/// `∫dV = D/6`, `∫d dV = D s/24`, `∫d dᵀ dV = D (a aᵀ + b bᵀ + c cᵀ + s sᵀ)/120`.
fn signed_sums(
    vertices: &[[f64; 3]],
    faces: &[[usize; 3]],
    reference: &Vector3<f64>,
    unit: f64,
) -> Sums {
    let [v, p, x, y, z, xx, xy, xz, yy, yz, zz] = sum_terms(faces.len(), |i| {
        let [a, b, c] = faces[i].map(|k| (Vector3::from(vertices[k]) - reference) / unit);
        let d = a.dot(&b.cross(&c));
        let s = a + b + c;
        let product =
            |i: usize, j: usize| d * (a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + s[i] * s[j]);
        [
            d,
            permanent(&a.abs(), &b.abs(), &c.abs()),
            d * s.x,
            d * s.y,
            d * s.z,
            product(0, 0),
            product(0, 1),
            product(0, 2),
            product(1, 1),
            product(1, 2),
            product(2, 2),
        ]
    });
    Sums {
        volume: v / 6.0,
        magnitude: p / 6.0,
        first: Vector3::new(x, y, z) / 24.0,
        second: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz) / 120.0,
    }
}

/// `a·(b×c)` with plus for minus.
fn permanent(a: &Vector3<f64>, b: &Vector3<f64>, c: &Vector3<f64>) -> f64 {
    a.x * (b.y * c.z + b.z * c.y) + a.y * (b.z * c.x + b.x * c.z) + a.z * (b.x * c.y + b.y * c.x)
}

/// The largest power of two that is not larger than a positive number; 1 where that is not a normal number.
fn power_of_two(size: f64) -> f64 {
    let power = f64::from_bits(size.to_bits() & 0x7ff0_0000_0000_0000);
    if power.is_normal() { power } else { 1.0 }
}

/// Middle of the bounding box of the vertices that faces use, and its largest extent.
fn middle(vertices: &[[f64; 3]], faces: &[[usize; 3]]) -> (Vector3<f64>, f64) {
    let (mut low, mut high) = (
        Vector3::repeat(f64::INFINITY),
        Vector3::repeat(f64::NEG_INFINITY),
    );
    for vertex in faces.iter().flatten().map(|&k| Vector3::from(vertices[k])) {
        low = low.inf(&vertex);
        high = high.sup(&vertex);
    }
    (low * 0.5 + high * 0.5, (high - low).max())
}

/// Indices in range, coordinates finite, every edge run along once each way.
fn check_mesh(vertices: &[[f64; 3]], faces: &[[usize; 3]]) -> Result<(), MeshFault> {
    check_indices(vertices, faces)?;
    // Closed by index is closed; else the same corner may be stored several times (texture seams, triangle soup).
    if check_closed(faces).is_ok() {
        return Ok(());
    }
    let same = representatives(vertices);
    let welded: Vec<[usize; 3]> = faces.iter().map(|face| face.map(|k| same[k])).collect();
    check_closed(&welded)
}

fn check_indices(vertices: &[[f64; 3]], faces: &[[usize; 3]]) -> Result<(), MeshFault> {
    if faces.is_empty() {
        return Err(MeshFault::NoFaces);
    }
    for (face, corners) in faces.iter().enumerate() {
        if let Some(&index) = corners.iter().find(|&&k| k >= vertices.len()) {
            let index = i64::try_from(index).unwrap_or(i64::MAX);
            return Err(MeshFault::IndexOutOfRange {
                face,
                index,
                vertices: vertices.len(),
            });
        }
    }
    for (vertex, coordinates) in vertices.iter().enumerate() {
        if let Some(&value) = coordinates.iter().find(|x| !x.is_finite()) {
            return Err(MeshFault::NonFiniteVertex { vertex, value });
        }
    }
    Ok(())
}

/// For each vertex the first one with the same coordinates (−0 equals +0).
fn representatives(vertices: &[[f64; 3]]) -> Vec<usize> {
    let key = |k: usize| vertices[k].map(|x| (x + 0.0).to_bits());
    let mut order: Vec<usize> = (0..vertices.len()).collect();
    order.sort_unstable_by_key(|&k| (key(k), k));
    let mut same: Vec<usize> = (0..vertices.len()).collect();
    for pair in order.windows(2) {
        if key(pair[0]) == key(pair[1]) {
            same[pair[1]] = same[pair[0]];
        }
    }
    same
}

/// One run along an edge: its lower and higher vertex, whether upward, and the face.
type Run = (usize, usize, bool, usize);

/// Whether every edge is run along as often one way as the other: the mesh has no boundary.
fn check_closed(faces: &[[usize; 3]]) -> Result<(), MeshFault> {
    let mut runs: Vec<Run> = Vec::with_capacity(3 * faces.len());
    for (face, &[a, b, c]) in faces.iter().enumerate() {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            if from != to {
                runs.push((from.min(to), from.max(to), from < to, face));
            }
        }
    }
    runs.sort_unstable();
    let unbalanced = |group: &&[Run]| 2 * group.iter().filter(|run| run.2).count() != group.len();
    let mut faulty = runs
        .chunk_by(|p, q| (p.0, p.1) == (q.0, q.1))
        .filter(unbalanced);
    let Some(first) = faulty.next() else {
        return Ok(());
    };
    // A wrongly wound face shows as two runs the same way, an open mesh as one run alone; the open edge is told first.
    let mut faulty: Vec<&[Run]> = std::iter::once(first).chain(faulty).collect();
    let count = faulty.len();
    faulty.sort_by_key(|group| group.len().is_multiple_of(2));
    let group = faulty[0];
    let upward = 2 * group.iter().filter(|run| run.2).count() > group.len();
    let mut same_way = group.iter().filter(|run| run.2 == upward).map(|run| run.3);
    let (low, high, ..) = group[0];
    let (from, to) = if upward { (low, high) } else { (high, low) };
    let first = same_way.next().unwrap_or(group[0].3);
    Err(match same_way.next() {
        Some(second) if group.len().is_multiple_of(2) => MeshFault::InconsistentWinding {
            from,
            to,
            first,
            second,
            count,
        },
        _ => MeshFault::Open {
            from,
            to,
            face: first,
            count,
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

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
            MeshFault::Open { count: 3, .. }
        ));
        let mut flipped = faces;
        flipped[3].swap(0, 1);
        assert!(matches!(
            fault(&flipped),
            MeshFault::InconsistentWinding { count: 3, .. }
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
