//! The solid inside the triangles of a mesh in memory.

use std::convert::Infallible;
use std::ops::ControlFlow;

use super::boundary::{Boundary, Marks, Replay, Triangle, find_repeats};
use super::nesting::{InsideOut, find_inside_out};
use super::solid::{MarkedBoundary, Options, Triangles, solid};
use super::view::{Index, View};
use crate::error::{Corner, Error, MeshFault};
use crate::mass::amount::Amount;
use crate::mass::body::RigidBody;
use crate::mass::provenance::Checks;
use crate::mass::simplex::{
    Corners, LocalFrame, Partial, Shell, Solid, Sums, block_sum, merge, sums,
};
use crate::numerics::threads::{Halt, Watch, fill_blocks};
use crate::numerics::tree_sum::BLOCK;

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
    Ok(polyhedron_watched(vertices, faces, amount, options, go_on)?.body)
}

/// The same with its volume, on several threads when the mesh is large; `watch` is asked about every 20 ms whether to go on.
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
///     Ok(polyhedron_watched(vertices, faces, Amount::Density(6.0), options, watch)?.body)
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
) -> Result<MeshSolid, Halt<Error>> {
    let mut mesh = Faces::new(vertices, faces, watch);
    let mut outcome = solid(&mut mesh, amount, options);
    let inside_out = mesh.inside_out.filter(|_| options.orient);
    if let Some(found) = &inside_out {
        let faces = found.orient_faces(faces);
        outcome = solid(&mut Faces::new(vertices, &faces, watch), amount, options);
    }
    outcome.map(|(body, volume)| MeshSolid {
        body,
        volume: volume.abs(),
        is_inverted: volume.is_sign_negative(),
        inside_out,
    })
}

/// A solid from a mesh in memory, and what else its sums have shown.
#[derive(Clone, Debug)]
pub struct MeshSolid {
    /// The solid.
    pub body: RigidBody,
    /// The volume that the faces enclose.
    pub volume: f64,
    /// Whether the whole mesh was turned.
    is_inverted: bool,
    /// The components that were turned before.
    inside_out: Option<InsideOut>,
}

impl MeshSolid {
    /// The faces that were summed, wound as they count: counter-clockwise seen from outside.
    ///
    /// # Examples
    ///
    /// ```
    /// use std::ops::ControlFlow;
    /// use polhode::mass::Amount;
    /// use polhode::mass::polyhedron::{MeshSolid, Options, polyhedron_watched};
    ///
    /// let vertices = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    /// let inverted = [[0_u32, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
    /// let options = Options { orient: true, ..Options::default() };
    /// let go_on = &mut |_| ControlFlow::Continue(());
    /// let solid: MeshSolid = polyhedron_watched(&vertices, &inverted, Amount::Mass(2.0), options, go_on)?;
    /// assert_eq!(solid.outward(&inverted)[0], [0, 2, 1]);
    /// assert!((solid.volume - 1.0 / 6.0).abs() < 1e-15);
    /// # Ok::<(), polhode::parallel::Halt<polhode::Error>>(())
    /// ```
    #[must_use]
    pub fn outward<I: Index>(&self, faces: &[[I; 3]]) -> Vec<[I; 3]> {
        let mut faces = match &self.inside_out {
            Some(found) => found.orient_faces(faces),
            None => faces.to_vec(),
        };
        if self.is_inverted {
            for face in &mut faces {
                face.swap(1, 2);
            }
        }
        faces
    }
}

// The triangles of a mesh in memory, in blocks shared among threads.

/// Faces and the vertices they count.
pub(super) struct Faces<'a, I> {
    mesh: View<'a, I>,
    watch: &'a mut Watch<'a>,
    /// The components that were found to be wound the wrong way.
    pub(super) inside_out: Option<InsideOut>,
}

impl<'a, I: Index> Faces<'a, I> {
    pub(super) fn new(
        vertices: &'a [[f64; 3]],
        faces: &'a [[I; 3]],
        watch: &'a mut Watch<'a>,
    ) -> Self {
        Self {
            mesh: View { vertices, faces },
            watch,
            inside_out: None,
        }
    }
}

impl<I: Index> Replay for Faces<'_, I> {
    type Error = Halt<Error>;

    fn each(&mut self, visit: &mut dyn FnMut(usize, &Triangle)) -> Result<(), Halt<Error>> {
        let count = self.mesh.count();
        for face in 0..count {
            if face % BLOCK == 0 && (self.watch)(face as f64 / count as f64).is_break() {
                return Err(Halt::Stopped);
            }
            visit(face, &self.mesh.corners(face));
        }
        Ok(())
    }

    fn find_repeats(&mut self, marks: &mut [u64]) -> Result<Vec<u64>, Halt<Error>> {
        find_repeats(marks, self.watch).map_err(|_| Halt::Stopped)
    }
}

/// What one block of faces comes to.
struct Part<'a> {
    partial: Partial,
    boundary: Boundary,
    marks: &'a mut [u64],
}

impl<I: Index> Triangles for Faces<'_, I> {
    fn first_frame(&mut self) -> Result<LocalFrame, Halt<Error>> {
        Ok(self.mesh.frame())
    }

    fn box_frame(&mut self) -> Result<LocalFrame, Halt<Error>> {
        Ok(self.mesh.used_frame())
    }

    fn solid_sums(
        &mut self,
        frame: &LocalFrame,
        check: bool,
    ) -> Result<(Sums, Option<MarkedBoundary>), Halt<Error>> {
        let mesh = self.mesh;
        if !check {
            return Ok((sums::<_, Solid, 3>(&mesh, frame, self.watch)?, None));
        }
        let count = mesh.count();
        let mut marks = vec![0; count];
        let mut parts: Vec<Part<'_>> = marks
            .chunks_mut(BLOCK)
            .map(|marks| Part {
                partial: Partial::default(),
                boundary: Boundary::default(),
                marks,
            })
            .collect();
        fill_blocks(&mut parts, 1, self.watch, |block, parts| {
            let part = &mut parts[0];
            let (from, to) = (block * BLOCK, count.min((block + 1) * BLOCK));
            part.partial = block_sum::<_, Solid, 3>(&mesh, from, to, frame);
            let mut next = part.marks.iter_mut();
            let triangles = (from..to).map(|face| mesh.corners(face));
            part.boundary = Boundary::of(triangles, |mark| {
                if let Some(place) = next.next() {
                    *place = mark;
                }
            });
            Ok::<(), Infallible>(())
        })
        .map_err(|_| Halt::Stopped)?;
        let partials: Vec<Partial> = parts.iter().map(|part| part.partial).collect();
        let boundary = parts
            .iter()
            .fold(Boundary::default(), |sum, part| sum.and(part.boundary));
        drop(parts);
        let checked = MarkedBoundary {
            boundary,
            marks: Marks::all(marks),
        };
        let sums = Sums::new::<Solid, 3>(&merge(&partials), count, frame);
        Ok((sums, Some(checked)))
    }

    fn shell_sums(&mut self, frame: &LocalFrame) -> Result<Sums, Halt<Error>> {
        Ok(sums::<_, Shell, 3>(&self.mesh, frame, self.watch)?)
    }

    fn find_unusable(&mut self) -> Result<Option<MeshFault>, Halt<Error>> {
        Ok(self.mesh.find_unusable())
    }

    fn find_inside_out(&mut self, sign: f64) -> Result<(Option<MeshFault>, Checks), Halt<Error>> {
        let found = find_inside_out(&self.mesh, sign, self.watch).map_err(|_| Halt::Stopped)?;
        self.inside_out = found;
        let fault = self.inside_out.as_ref().and_then(InsideOut::fault);
        Ok((fault, Checks::CAVITIES))
    }

    fn corner(&self, face: usize, position: &[f64; 3]) -> Corner {
        let number = self.mesh.faces[face]
            .map(Index::position)
            .into_iter()
            .find(|&k| self.mesh.vertices.get(k) == Some(position));
        number.map_or(Corner::At(*position), Corner::Vertex)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

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

    /// A tetrahedron in a larger one, each with a sense of its own: outward is the larger one, inward its cavity.
    #[test]
    fn the_faces_that_were_summed_are_outward() {
        let (corners, outside) = TETRAHEDRON;
        let within = corners.map(|r| r.map(|x| 0.2 + 0.2 * x));
        let vertices = [corners, within].concat();
        let turn = |faces: [[usize; 3]; 4]| faces.map(|[a, b, c]| [a, c, b]);
        let inside = outside.map(|face| face.map(|k| k + 4));
        let go_on = &mut |_| ControlFlow::Continue(());
        let options = Options {
            orient: true,
            ..Options::default()
        };
        for faces in [
            [outside, turn(inside)],
            [turn(outside), turn(inside)],
            [turn(outside), inside],
        ] {
            let faces = faces.concat();
            let solid = polyhedron_watched(&vertices, &faces, Amount::Mass(3.0), options, go_on)
                .expect("solid");
            let found = solid.outward(&faces);
            let again =
                polyhedron(&vertices, &found, Amount::Density(1.0), false).expect("outward");
            assert_eq!(again.mass(), solid.volume);
            assert_eq!(found[0], outside[0]);
        }
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
