//! Solids from streams of triangles larger than memory: the same sums and the same checks, block by block.

use std::ops::ControlFlow;

use nalgebra::Vector3;

use super::boundary::{Boundary, Marks, ROOM, Replay, Triangle, find_repeats};
use super::in_memory::polyhedron_watched;
use super::nesting::{InsideOut, find_inside_out};
use super::solid::{MarkedBoundary, Options, Triangles, solid};
use super::stream::{StreamError, TriangleStream};
use super::view::{View, widen};
use crate::error::{Corner, MeshFault};
use crate::mass::body::RigidBody;
use crate::mass::provenance::Checks;
use crate::mass::simplex::{
    Corners, Kind, LocalFrame, Partial, Shell, Solid, Sums, block_sum, merge,
};
use crate::mass::solids::Amount;
use crate::numerics::threads::{Halt, Watch};

/// So many triangles are kept, to be looked at as a mesh in memory.
pub(crate) const KEPT: usize = 1 << 18;

/// A solid from a stream, and what only going through the triangles can tell.
#[derive(Clone, Copy, Debug)]
pub struct StreamedSolid {
    /// The solid.
    pub body: RigidBody,
    /// How many triangles.
    pub triangles: usize,
    /// The volume they enclose.
    pub volume: f64,
    /// Their area.
    pub area: f64,
}

/// The solid of uniform density bounded by the triangles of a stream, whose coordinates are multiplied by `scale`.
///
/// Once through the file for an ordinary body, again for a thin one or to find what is wrong, and once more for every eight
/// million triangles or so, to look for faces that stand twice. Corners with the same coordinates are one vertex. That
/// components wound inward lie in others is checked of 262 144 triangles and fewer; of more the provenance does not list it.
///
/// # Errors
/// As [`polyhedron`](super::polyhedron), and when the file cannot be read.
pub fn stream_solid(
    stream: &mut dyn TriangleStream,
    scale: f64,
    amount: Amount,
    options: Options,
    watch: &mut Watch<'_>,
) -> Result<StreamedSolid, StreamError> {
    let mut source = Stream {
        passes: Passes::new(stream, scale, watch),
        seen: None,
        kept: None,
        is_inside_out: false,
    };
    let outcome = solid(&mut source, amount, options);
    let (body, volume) = if source.is_inside_out && options.orient {
        source.orient(amount)?
    } else {
        outcome?
    };
    let (triangles, area) = source.seen.map_or((0, 0.0), |seen| (seen.count, seen.area));
    Ok(StreamedSolid {
        body,
        triangles,
        volume: volume.abs(),
        area,
    })
}

/// A stream with what the first time through has shown.
struct Stream<'a> {
    passes: Passes<'a>,
    seen: Option<StreamSummary>,
    /// The corners of all triangles, where they are few.
    kept: Option<Vec<[f64; 3]>>,
    /// Whether a component is wound the wrong way.
    is_inside_out: bool,
}

#[derive(Clone, Copy)]
struct StreamSummary {
    count: usize,
    area: f64,
    frame: LocalFrame,
}

/// What one time through came to.
#[derive(Default)]
struct Pass {
    count: usize,
    solid: Vec<Partial>,
    shell: Vec<Partial>,
    boundary: Boundary,
}

/// Triangles that share no vertex.
fn apart(corners: &[[f64; 3]]) -> Vec<[usize; 3]> {
    (0..corners.len() / 3)
        .map(|face| [0, 1, 2].map(|k| 3 * face + k))
        .collect()
}

impl Stream<'_> {
    /// The solid of the triangles that were kept, each component wound as it should be.
    fn orient(&mut self, amount: Amount) -> Result<(RigidBody, f64), StreamError> {
        let corners = self.kept.take().unwrap_or_default();
        let options = Options {
            orient: true,
            check: true,
        };
        let watch = &mut |_| self.passes.ask();
        match polyhedron_watched(&corners, &apart(&corners), amount, options, watch) {
            Ok(solid) => Ok((solid.body, solid.volume)),
            Err(Halt::Stopped) => Err(StreamError::Stopped),
            Err(Halt::Failed(error)) => Err(error.into()),
        }
    }
}

impl Replay for Stream<'_> {
    type Error = StreamError;

    fn each(&mut self, visit: &mut dyn FnMut(usize, &Triangle)) -> Result<(), StreamError> {
        let mut face = 0;
        self.passes.blocks(&mut |block| {
            for triangle in block {
                visit(face, triangle);
                face += 1;
            }
            ControlFlow::Continue(())
        })
    }

    fn find_repeats(&mut self, marks: &mut [u64]) -> Result<Vec<u64>, StreamError> {
        find_repeats(marks, &mut |_| self.passes.ask()).map_err(|_| StreamError::Stopped)
    }
}

impl Triangles for Stream<'_> {
    /// The box of the first block.
    fn first_frame(&mut self) -> Result<LocalFrame, StreamError> {
        let (mut low, mut high) = ([0.0; 3], [0.0; 3]);
        self.passes.blocks(&mut |block| {
            (low, high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
            for corner in block.iter().flatten() {
                widen(&mut low, &mut high, corner);
            }
            ControlFlow::Break(())
        })?;
        Ok(LocalFrame::of_box(
            &Vector3::from(low),
            &Vector3::from(high),
        ))
    }

    fn box_frame(&mut self) -> Result<LocalFrame, StreamError> {
        if let Some(seen) = self.seen {
            return Ok(seen.frame);
        }
        self.first_frame()
    }

    fn solid_sums(
        &mut self,
        frame: &LocalFrame,
        check: bool,
    ) -> Result<(Sums, Option<MarkedBoundary>), StreamError> {
        if self.seen.is_some() {
            return Ok((self.passes.sums::<Solid>(frame)?, None));
        }
        let mut pass = Pass::default();
        let mut marks = Marks::beyond(0, ROOM);
        self.kept = None;
        let mut kept = check.then(Vec::new);
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        self.passes.blocks(&mut |block| {
            let size = block.len();
            let corners = Block(block);
            for corner in block.iter().flatten() {
                widen(&mut low, &mut high, corner);
            }
            pass.solid
                .push(block_sum::<_, Solid, 3>(&corners, 0, size, frame));
            pass.shell
                .push(block_sum::<_, Shell, 3>(&corners, 0, size, frame));
            pass.count += size;
            if pass.count > KEPT {
                kept = None;
            }
            if let Some(corners) = &mut kept {
                corners.extend_from_slice(block.as_flattened());
            }
            if check {
                let boundary = Boundary::of(block.iter().copied(), |mark| marks.push(mark));
                pass.boundary = pass.boundary.and(boundary);
            }
            ControlFlow::Continue(())
        })?;
        self.kept = kept;
        let shell = Sums::new::<Shell, 3>(&merge(&pass.shell), pass.count, frame);
        self.seen = Some(StreamSummary {
            count: pass.count,
            area: shell.content * frame.unit * frame.unit,
            frame: LocalFrame::of_box(&Vector3::from(low), &Vector3::from(high)),
        });
        let checked = check.then_some(MarkedBoundary {
            boundary: pass.boundary,
            marks,
        });
        let sums = Sums::new::<Solid, 3>(&merge(&pass.solid), pass.count, frame);
        Ok((sums, checked))
    }

    fn shell_sums(&mut self, frame: &LocalFrame) -> Result<Sums, StreamError> {
        self.passes.sums::<Shell>(frame)
    }

    fn find_unusable(&mut self) -> Result<Option<MeshFault>, StreamError> {
        let mut found = None;
        self.each(&mut |face, triangle| {
            let corner = triangle.iter().find(|r| r.iter().any(|x| !x.is_finite()));
            if let (None, Some(&corner)) = (&found, corner) {
                found = Some(MeshFault::NonFiniteCorner {
                    face,
                    corner: Corner::At(corner),
                });
            }
        })?;
        Ok(found)
    }

    fn find_inside_out(&mut self, sign: f64) -> Result<(Option<MeshFault>, Checks), StreamError> {
        let Some(corners) = &self.kept else {
            return Ok((None, Checks::default()));
        };
        let faces = apart(corners);
        let mesh = View {
            vertices: corners,
            faces: &faces,
        };
        let found = find_inside_out(&mesh, sign, &mut |_| self.passes.ask());
        let found = found.map_err(|_| StreamError::Stopped)?;
        self.is_inside_out = found.is_some();
        let fault = found.as_ref().and_then(InsideOut::fault);
        Ok((fault, Checks::CAVITIES))
    }

    fn corner(&self, _: usize, position: &[f64; 3]) -> Corner {
        Corner::At(position.map(|x| x / self.passes.scale))
    }
}

// Going through a stream again and again, with its coordinates scaled and a watch asked on the way.

/// The triangles of a block.
pub(super) struct Block<'a>(pub(super) &'a [Triangle]);

impl Corners<3> for Block<'_> {
    fn count(&self) -> usize {
        self.0.len()
    }

    #[inline(always)]
    fn corners(&self, index: usize) -> Triangle {
        self.0[index]
    }
}

/// A stream that may be gone through as often as needed.
pub(super) struct Passes<'a> {
    file: &'a mut dyn TriangleStream,
    /// What coordinates are multiplied by.
    pub(super) scale: f64,
    watch: &'a mut Watch<'a>,
    /// The largest fraction that was told to `watch`.
    farthest: f64,
}

impl<'a> Passes<'a> {
    pub(super) fn new(
        file: &'a mut dyn TriangleStream,
        scale: f64,
        watch: &'a mut Watch<'a>,
    ) -> Self {
        Self {
            file,
            scale,
            watch,
            farthest: 0.0,
        }
    }

    /// Whether to go on, where no more of the file is read.
    pub(super) fn ask(&mut self) -> ControlFlow<()> {
        (self.watch)(self.farthest)
    }

    /// Once through, as far as `visit` goes on.
    pub(super) fn blocks(
        &mut self,
        visit: &mut dyn FnMut(&[Triangle]) -> ControlFlow<()>,
    ) -> Result<(), StreamError> {
        let (scale, farthest, watch) = (self.scale, &mut self.farthest, &mut self.watch);
        let mut is_stopped = false;
        let mut scaled = Vec::new();
        self.file.blocks(&mut |block, fraction| {
            *farthest = farthest.max(fraction);
            if watch(*farthest).is_break() {
                is_stopped = true;
                return ControlFlow::Break(());
            }
            if scale == 1.0 {
                return visit(block);
            }
            scaled.clear();
            let triangles = block.iter();
            scaled.extend(triangles.map(|triangle| triangle.map(|r| r.map(|x| x * scale))));
            visit(&scaled)
        })?;
        if is_stopped {
            return Err(StreamError::Stopped);
        }
        Ok(())
    }

    /// The sums over all triangles in a frame.
    pub(super) fn sums<K: Kind<3>>(&mut self, frame: &LocalFrame) -> Result<Sums, StreamError> {
        let (mut partials, mut count) = (Vec::new(), 0);
        self.blocks(&mut |block| {
            partials.push(block_sum::<_, K, 3>(&Block(block), 0, block.len(), frame));
            count += block.len();
            ControlFlow::Continue(())
        })?;
        Ok(Sums::new::<K, 3>(&merge(&partials), count, frame))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;
    use crate::mass::polyhedron::polyhedron;

    /// Triangles in memory, a few at a time.
    struct List(Vec<Triangle>);

    impl TriangleStream for List {
        fn blocks(
            &mut self,
            visit: &mut dyn FnMut(&[Triangle], f64) -> ControlFlow<()>,
        ) -> Result<(), StreamError> {
            for block in self.0.chunks(crate::mass::polyhedron::stream::BLOCK) {
                if visit(block, 0.5).is_break() {
                    break;
                }
            }
            Ok(())
        }
    }

    /// A ball of 2 n² triangles.
    fn ball(n: usize) -> Vec<Triangle> {
        let point = |i: usize, j: usize| {
            let (theta, phi) = (
                std::f64::consts::PI * i as f64 / n as f64,
                std::f64::consts::TAU * (j % n) as f64 / n as f64,
            );
            match i {
                0 => [0.0, 0.0, 1.0],
                _ if i == n => [0.0, 0.0, -1.0],
                _ => [
                    theta.sin() * phi.cos(),
                    theta.sin() * phi.sin(),
                    theta.cos(),
                ],
            }
        };
        (0..n * n)
            .flat_map(|k| {
                let (i, j) = (k / n, k % n);
                let (a, b, c, d) = (
                    point(i, j),
                    point(i, j + 1),
                    point(i + 1, j),
                    point(i + 1, j + 1),
                );
                [[a, c, d], [a, d, b]]
            })
            .filter(|[a, b, c]| a != b && b != c && c != a)
            .collect()
    }

    fn solid_of(list: &[Triangle], scale: f64) -> Result<StreamedSolid, StreamError> {
        let go_on = &mut |_| ControlFlow::Continue(());
        let amount = Amount::Density(2.0);
        stream_solid(
            &mut List(list.to_vec()),
            scale,
            amount,
            Options::default(),
            go_on,
        )
    }

    #[test]
    fn a_stream_gives_the_body_of_the_mesh() {
        let list = ball(70);
        let found = solid_of(&list, 3.0).expect("closed");
        let vertices: Vec<[f64; 3]> = list.iter().flatten().map(|r| r.map(|x| 3.0 * x)).collect();
        let faces: Vec<[usize; 3]> = (0..list.len())
            .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
            .collect();
        let whole = polyhedron(&vertices, &faces, Amount::Density(2.0), false).expect("closed");
        assert!(found.body.is_close(&whole, 1e-14, 0.0));
        assert_eq!(found.triangles, list.len());
        assert!((found.volume * 2.0 / whole.mass() - 1.0).abs() < 1e-14);
        assert!((found.area / (36.0 * std::f64::consts::PI) - 1.0).abs() < 1e-2);
    }

    #[test]
    fn a_hole_far_down_the_stream_is_found() {
        let mut list = ball(70);
        let [a, b, _] = list.remove(9000);
        match solid_of(&list, 1.0) {
            Err(StreamError::Failed(Error::Mesh(MeshFault::Open {
                from, to, count, ..
            }))) => {
                assert_eq!(count.seen, 3);
                assert_ne!(from, to);
            }
            other => panic!("expected an open mesh, got {other:?}"),
        }
        list.push([[0.0, 0.0, f64::NAN], a, b]);
        assert!(matches!(
            solid_of(&list, 1.0),
            Err(StreamError::Failed(Error::Mesh(
                MeshFault::NonFiniteCorner { .. }
            )))
        ));
    }

    #[test]
    fn whoever_watches_can_stop_it() {
        let stop = &mut |_| ControlFlow::Break(());
        let amount = Amount::Mass(1.0);
        let outcome = stream_solid(&mut List(ball(10)), 1.0, amount, Options::default(), stop);
        assert!(matches!(outcome, Err(StreamError::Stopped)));
    }
}
