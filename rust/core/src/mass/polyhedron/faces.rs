//! The triangles of a mesh in memory, in blocks shared among threads.

use std::convert::Infallible;

use super::boundary::{Boundary, Replay, Triangle};
use super::duplicates::{Marks, repeated};
use super::nesting::{InsideOut, find_inside_out};
use super::solid::{Checked, Triangles};
use super::view::{Index, View};
use crate::error::{Corner, Error, MeshFault};
use crate::mass::provenance::Checks;
use crate::mass::simplex::{
    Corners, LocalFrame, Partial, Shell, Solid, Sums, block_sum, merge, sums,
};
use crate::numerics::reduce::BLOCK;
use crate::numerics::threads::{Halt, Watch, fill_blocks};

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

    fn repeated(&mut self, marks: &mut [u64]) -> Result<Vec<u64>, Halt<Error>> {
        repeated(marks, self.watch).map_err(|_| Halt::Stopped)
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
    ) -> Result<(Sums, Option<Checked>), Halt<Error>> {
        let mesh = self.mesh;
        if !check {
            let sums = sums::<_, Solid, 3>(&mesh, frame, self.watch);
            return sums.map(|sums| (sums, None)).ok_or(Halt::Stopped);
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
        let checked = Checked {
            boundary,
            marks: Marks::all(marks),
        };
        let sums = Sums::new::<Solid, 3>(&merge(&partials), count, frame);
        Ok((sums, Some(checked)))
    }

    fn shell_sums(&mut self, frame: &LocalFrame) -> Result<Sums, Halt<Error>> {
        sums::<_, Shell, 3>(&self.mesh, frame, self.watch).ok_or(Halt::Stopped)
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
