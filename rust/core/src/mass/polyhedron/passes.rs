//! Going through a stream again and again, with its coordinates scaled and a watch asked on the way.

use std::ops::ControlFlow;

use super::boundary::Triangle;
use super::stream::{StreamError, TriangleStream};
use crate::mass::simplex::{Corners, Kind, LocalFrame, Sums, block_sum, merge};
use crate::numerics::threads::Watch;

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
